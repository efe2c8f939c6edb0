#include "model/rolling_profile.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "model/couplings.hpp"
#include "model/input_error.hpp"

namespace poise {
namespace {

/// Of the curve in these parts.
RollingProfile functions_of(const RollingCurve<double>& curve, const std::vector<RollingCurve<double>::Part>& parts,
                            double near) {
  const auto of = [&](ProfileLaw law) { return std::make_shared<const Profile>(curve.function(law, parts, near)); };
  return {curve.chords(), of(ProfileLaw::tangent_angle), of(ProfileLaw::arc_length), of(ProfileLaw::along_tangent),
          of(ProfileLaw::across_tangent)};
}

}  // namespace

const std::shared_ptr<const Profile>& RollingProfile::of(ProfileLaw law) const {
  switch (law) {
    case ProfileLaw::tangent_angle:
      return angle;
    case ProfileLaw::arc_length:
      return length;
    case ProfileLaw::along_tangent:
      return along;
    default:
      return across;
  }
}

std::optional<RollingProfile> rolling_profile(const std::vector<Vec2>& points, bool is_closed, double near) {
  const RollingCurve<double> curve(points, is_closed);
  const auto parts = curve.parts();
  if (!parts) return std::nullopt;
  return functions_of(curve, *parts, near);
}

RollingProfile rolling_profile_on(double least, const std::vector<Vec2>& points, bool is_closed, double near) {
  std::optional<RollingProfile> found = rolling_profile(points, is_closed, near);
  if (!found) throw InputError("expected a smooth curve, found one with a cusp; give it more points, or other ones");
  constexpr double full_turn = 2 * M_PI;
  const double turn = is_closed ? found->angle->at(1.0).value - found->angle->at(0.0).value : full_turn;
  if (turn < 0.0) {
    throw InputError("expected points counter-clockwise, the body on the left; reverse their order");
  }
  if (std::abs(turn - full_turn) > 1.0) {
    throw InputError("expected a curve that goes round once, found one that crosses itself");
  }
  double most_curved = -std::numeric_limits<double>::infinity();
  constexpr int samples = 1000;
  for (int k = 0; k <= samples; ++k) {
    const double u = static_cast<double>(k) / samples;
    most_curved = std::max(most_curved, found->angle->at(u).first / found->length->at(u).first);
  }
  if (!(most_curved > least)) {
    throw InputError(
        "expected a curve with its body on the left that bends away from what it rolls on, found none such place; "
        "reverse the order of its points, or give others");
  }
  return *std::move(found);
}

bool is_convex(const Profile& angle) {
  return std::all_of(angle.pieces().begin(), angle.pieces().end(), [](const Profile::Piece& piece) {
    const auto c = [&](std::size_t k) { return Vec2{piece.c[1 + k], piece.c[5 + k]}; };
    const double constant = 2 * cross(c(1), c(2)), slope = 6 * cross(c(1), c(3)), bend = 6 * cross(c(2), c(3));
    const auto at = [&](double t) { return constant + t * (slope + t * bend); };
    const double turn = bend > 0.0 ? std::clamp(-slope / (2 * bend), -0.5, 0.5) : 0.5;
    return std::min({at(-0.5), at(0.5), at(turn)}) > 0.0;
  });
}

Vec2 point_of_profile(const Stop* rows, double u, bool is_against) {
  const auto value = [&](int row, std::size_t term) {
    const Measure::Term& of = rows[row].on.terms[term];
    return std::abs(of.factor) * of.profile->at(u).value;
  };
  const std::size_t term = is_against ? 2 : 1;
  return Vec2{value(1, term), value(0, term)} * unit(value(is_against ? 3 : 2, 1));
}

std::pair<double, double> range_of_profile(const Scene& scene, std::size_t first) {
  const double span = scene.stops[first].on.terms[1].span;
  for (std::size_t s = first + 1; s < scene.stops.size(); ++s) {
    const Stop& row = scene.stops[s];
    const CouplingKind* const kind = coupling_kind(row);
    if (kind == nullptr || kind->row == 0) break;
    if (row.table.ends_with("_ends")) return {row.min / span, row.max / span};
  }
  return {0.0, 1.0};
}

}  // namespace poise
