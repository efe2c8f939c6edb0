#include "design/synthesis/passage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace poise {
namespace {

constexpr double half_turn_of_input = std::numbers::pi;
/// Of sines and cosines: nearer to a limit than this nothing is decided.
constexpr double near_limit = 1e-9;

/// The angles of the input from the ground line at which a four-bar closes, by their cosines.
struct Reach {
  double least = 0.0, most = 0.0;  ///< cosines; below -1 and above 1 where there is no limit
  double ground_angle = 0.0;

  bool from_folded() const { return most < 1.0; }  ///< there is a limit near the angle 0
  bool to_stretched() const { return least > -1.0; }
  bool decided() const { return std::abs(most - 1.0) > near_limit && std::abs(least + 1.0) > near_limit; }
};

Reach reach_of(const FourBar& linkage) {
  const Vec2 ground = linkage.b - linkage.a;
  const double g = norm(ground), a = linkage.input;
  const double difference = linkage.coupler - linkage.output, sum = linkage.coupler + linkage.output;
  return {(a * a + g * g - sum * sum) / (2 * a * g), (a * a + g * g - difference * difference) / (2 * a * g),
          std::atan2(ground.y, ground.x)};
}

/// The angle within [from, from + 360 deg).
double wrapped_from(double angle, double from) {
  return angle - 2 * half_turn_of_input * std::floor((angle - from) / (2 * half_turn_of_input));
}

/// The sine of the angle between coupler and output, 0 at a dead point of the input.
double openness(const FourBar& linkage, double cosine) {
  const double g = norm(linkage.b - linkage.a);
  const double square = linkage.input * linkage.input + g * g - 2 * linkage.input * g * cosine;
  const double c = (linkage.coupler * linkage.coupler + linkage.output * linkage.output - square) /
                   (2 * linkage.coupler * linkage.output);
  return std::sqrt(std::max(0.0, 1 - c * c));
}

/// The least of openness() between two angles from the ground line: at an end, or where the input is in line with the
/// ground between them.
double least_openness(const FourBar& linkage, double from, double to) {
  double least = std::min(openness(linkage, std::cos(from)), openness(linkage, std::cos(to)));
  const double low = std::min(from, to), high = std::max(from, to);
  for (double k = std::ceil(low / half_turn_of_input); k * half_turn_of_input <= high; k += 1) {
    least = std::min(least, openness(linkage, std::fmod(k, 2.0) == 0.0 ? 1.0 : -1.0));
  }
  return least;
}

/// Angles that a turning input passes one after the other, not wrapped; empty where that is no single turn one way.
std::vector<double> cyclic_order(const std::vector<double>& angles, int way) {
  std::vector<double> out{angles.front()};
  for (std::size_t k = 1; k < angles.size(); ++k) {
    const double step = wrapped_from(way * (angles[k] - angles[k - 1]), 0.0);
    out.push_back(out.back() + way * step);
  }
  const bool one_turn = std::abs(out.back() - out.front()) < 2 * half_turn_of_input;
  return one_turn ? out : std::vector<double>{};
}

bool is_monotone(const std::vector<double>& angles, int way) {
  for (std::size_t k = 1; k < angles.size(); ++k) {
    if (way * (angles[k] - angles[k - 1]) <= 0.0) return false;
  }
  return true;
}

}  // namespace

std::string to_string(Defect defect) {
  switch (defect) {
    case Defect::none:
      return "none";
    case Defect::circuit:
      return "circuit";
    case Defect::branch:
      return "branch";
    case Defect::order:
      return "order";
    case Defect::undecided:
      return "undecided";
  }
  return {};
}

Passage passage_of(const FourBar& linkage, std::span<const InputPosition> positions) {
  Passage out;
  const Reach reach = reach_of(linkage);
  std::vector<double> angles;
  bool decided = reach.decided(), one_closure = true, one_side = true;
  const double first_side = std::sin(positions.front().angle - reach.ground_angle);
  for (const InputPosition& p : positions) {
    const double angle = p.angle - reach.ground_angle;
    // Without a limit at 180 degrees the angles are counted across it.
    angles.push_back(wrapped_from(angle, reach.from_folded() && !reach.to_stretched() ? 0.0 : -half_turn_of_input));
    decided = decided && openness(linkage, std::cos(angle)) > near_limit;
    one_closure = one_closure && p.closure == positions.front().closure;
    one_side = one_side && (std::sin(angle) > 0.0) == (first_side > 0.0);
  }
  const bool turns = !reach.from_folded() && !reach.to_stretched();
  const bool two_sides = reach.from_folded() && reach.to_stretched();
  out.defect = Defect::undecided;
  if (!decided) return out;
  out.defect = Defect::circuit;
  if ((turns && !one_closure) || (two_sides && !one_side)) return out;
  out.defect = Defect::branch;
  if (!one_closure) return out;
  out.defect = Defect::order;
  for (const int way : {1, -1}) {
    const std::vector<double> order = turns ? cyclic_order(angles, way) : angles;
    if (order.empty() || !is_monotone(order, way)) continue;
    out.defect = Defect::none;
    out.turn = way;
    out.from = std::remainder(order.front() + reach.ground_angle, 2 * half_turn_of_input);
    out.to = out.from + order.back() - order.front();
    out.transmission = std::asin(least_openness(linkage, order.front(), order.back()));
    break;
  }
  return out;
}

Passage passage_over(const FourBar& linkage, double from, double to, int closure) {
  Passage out;
  const Reach reach = reach_of(linkage);
  const double first = from - reach.ground_angle, last = to - reach.ground_angle;
  const auto closes = [&](double cosine) { return cosine < reach.most && cosine > reach.least; };
  bool all = closes(std::cos(first)) && closes(std::cos(last));
  const double low = std::min(first, last), high = std::max(first, last);
  for (double k = std::ceil(low / half_turn_of_input); k * half_turn_of_input <= high; k += 1) {
    all = all && closes(std::fmod(k, 2.0) == 0.0 ? 1.0 : -1.0);
  }
  const double least = least_openness(linkage, first, last);
  out.defect = !all ? Defect::branch : least > near_limit && closure != 0 ? Defect::none : Defect::undecided;
  if (out.defect != Defect::none) return out;
  out.turn = to > from ? 1 : -1;
  out.from = from;
  out.to = to;
  out.transmission = std::asin(least);
  return out;
}

FourBar four_bar_of(const GuidingDyad& input, const GuidingDyad& output) {
  const Vec2 line = output.moving - input.moving;
  const double coupler = norm(line);
  return {input.fixed, output.fixed,  input.length,
          coupler,     output.length, (1 / coupler) * (-input.moving * conj(line))};
}

InputPosition input_position(const GuidingDyad& input, const GuidingDyad& output, const BodyPosition& position) {
  const Vec2 pin = world_of(position, input.moving), far_pin = world_of(position, output.moving);
  const Vec2 link = pin - input.fixed;
  return {std::atan2(link.y, link.x), cross(output.fixed - pin, far_pin - pin) < 0.0 ? -1 : 1};
}

}  // namespace poise
