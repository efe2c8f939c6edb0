#include "statics/neutral_motions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <boost/multiprecision/cpp_int.hpp>
#include <fmt/format.h>

#include "statics/merged_mechanism.hpp"

namespace poise {
namespace {

using Rational = boost::multiprecision::cpp_rational;

Rational power_of_ten(int exponent) {
  const Rational power(boost::multiprecision::pow(boost::multiprecision::cpp_int(10), std::abs(exponent)));
  return exponent < 0 ? Rational(1 / power) : power;
}

// The number that fmt writes as "-1.25e-03".
Rational rational_of(const std::string& text) {
  const std::size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  const std::size_t point = digits.find('.');
  const int decimals = point == std::string::npos ? 0 : static_cast<int>(digits.size() - point - 1);
  if (point != std::string::npos) digits.erase(point, 1);
  const bool negative = digits.front() == '-';
  if (negative) digits.erase(0, 1);
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));  // a leading zero makes an octal number
  const Rational size =
      Rational(boost::multiprecision::cpp_int(digits)) * power_of_ten(std::stoi(text.substr(e + 1)) - decimals);
  return negative ? Rational(-size) : size;
}

// The shortest decimal that reads as x where it counts in a unit.
Rational shortest_decimal(double x, double unit) {
  constexpr int most_digits = 17;
  for (int digits = 1; digits <= most_digits; ++digits) {
    const std::string text = fmt::format("{:.{}e}", x / unit, digits - 1);
    if (std::strtod(text.c_str(), nullptr) * unit == x) return rational_of(text);
  }
  return Rational(x) / Rational(unit);
}

// Numbers of a scaled scene as they are written.
class WrittenNumbers {
 public:
  explicit WrittenNumbers(const StaticModel& model)
      : layout_(model.layout()), scales_(model.scales()), units_(model.scene().units) {}

  Rational length(double x) const { return written(x, dimension::length); }
  Rational force(double x) const { return written(x, dimension::force); }
  Rational force_per_length(double x) const { return written(x, dimension::force * dimension::length.power(-1)); }
  Rational mass(double x) const { return written(x, dimension::mass); }
  Rational acceleration(double x) const { return written(x, dimension::acceleration); }
  static std::optional<Rational> share_at_points(const Scene& /*scene*/, const Force& on) {
    return on.to ? std::nullopt : std::optional<Rational>(1);
  }
  std::optional<Planar<Rational>> turned(int turn) const {
    if (!layout_.turns[static_cast<std::size_t>(turn)].angle.parts().empty()) return std::nullopt;
    return Planar<Rational>{1, 0};
  }
  std::optional<Planar<Rational>> direction(const Vec2& along) const {
    if (along.x != 0.0 && along.y != 0.0) return std::nullopt;
    const auto sign = [](double x) { return x > 0.0 ? 1 : x < 0.0 ? -1 : 0; };
    return Planar<Rational>{sign(along.x), sign(along.y)};
  }

 private:
  // In SI.
  Rational written(double x, const Dimension& of) const {
    const auto raised = [](const Rational& base, int exponent) {
      Rational out = 1;
      for (int k = 0; k < std::abs(exponent); ++k) out *= base;
      return exponent < 0 ? Rational(1 / out) : out;
    };
    const Rational unit = raised(shortest_decimal(units_.length, 1.0), of.length) *
                          raised(shortest_decimal(units_.force, 1.0), of.force) *
                          raised(shortest_decimal(units_.mass, 1.0), of.mass);
    return shortest_decimal(x / of.per_scale(scales_), of.unit(units_)) * unit;
  }

  const Layout& layout_;
  const Scales& scales_;
  const Units& units_;
};

bool may_vanish(const Planar<Interval>& w) { return !w.x.excludes_zero() && !w.y.excludes_zero(); }
bool is_nothing(const Planar<Interval>& w) { return w.x == Interval(0) && w.y == Interval(0); }

// Coordinates, and the ground behind them, in groups that forces tie together.
class Ties {
 public:
  explicit Ties(int coordinates) : first_(static_cast<std::size_t>(coordinates) + 1) {
    std::iota(first_.begin(), first_.end(), 0);
  }
  int ground() const { return static_cast<int>(first_.size()) - 1; }
  int group(int i) const {
    while (first_[static_cast<std::size_t>(i)] != i) i = first_[static_cast<std::size_t>(i)];
    return i;
  }
  void tie(int i, int j) { first_[static_cast<std::size_t>(group(i))] = group(j); }
  bool is_tied(int i) const { return group(i) == group(ground()); }

 private:
  std::vector<int> first_;
};

// What holds a coordinate; none where no measure is it.
std::optional<Measure> measure_of(const StaticModel& model, int coordinate) {
  const Layout& layout = model.layout();
  for (std::size_t j = 0; j < layout.travel.size(); ++j) {
    if (layout.travel[j] == coordinate) return Measure::travel_of(static_cast<int>(j));
  }
  for (std::size_t b = 1; b < model.scene().bodies.size(); ++b) {
    if (layout.links[b].frame == coordinate && layout.links[b].turn == 0)
      return Measure::angle_between(0, static_cast<int>(b));
  }
  return std::nullopt;
}

class NeutralSearch {
 public:
  NeutralSearch(const StaticModel& model, const std::vector<double>& start)
      : model_(model), start_(start), n_(model.mechanism().coordinates()), ties_(n_) {}

  NeutralMotions run() {
    NeutralMotions out;
    if (model_.mechanism().has_follower_loads() || n_ == 0) return out;
    const std::optional<MergedEnergy<Rational>> exact = energy_as_written();
    {
      const solvers::RoundingUp up;
      if (!find_products()) return out;
      for (std::size_t p = 0; p < products_.size(); ++p) {
        const bool is_zero = exact && exact->products[p].w == Planar<Rational>{0, 0};
        vanishes_.push_back(vanishes(products_[p], is_zero));
        is_exact_.push_back(is_zero);
      }
    }
    tie_products();
    tie_everything_else();
    for (int i = 0; i < n_; ++i) {
      if (ties_.is_tied(i) || ties_.group(i) != i) continue;
      if (std::optional<NeutralMotions::Motion> motion = motion_of(i)) out.motions.push_back(std::move(*motion));
    }
    return out;
  }

 private:
  // Expressions are not known as rational numbers.
  std::optional<MergedEnergy<Rational>> energy_as_written() const {
    if (model_.scene().dependents != nullptr) return std::nullopt;
    const WrittenNumbers numbers(model_);
    return EnergyMerger<Rational, WrittenNumbers>(model_.scaled_scene(), model_.layout(), numbers).run();
  }

  bool find_products() {
    // A number of a file rounds once when it is read, its unit and their product in others than SI; expressions round
    // in every operation.
    const Units& units = model_.scene().units;
    const bool is_si = units.length == 1.0 && units.force == 1.0 && units.mass == 1.0;
    const double roundings = model_.scene().dependents ? 16.0 : is_si ? 1.0 : 4.0;
    const IntervalNumbers numbers{model_.layout(), roundings * half_unit};
    auto merged = EnergyMerger<Interval, IntervalNumbers>(model_.scaled_scene(), model_.layout(), numbers).run();
    if (!merged) return false;
    products_ = std::move(merged->products);
    return true;
  }

  // Lengths have no bounds, so that of their factors a rounding is no zero.
  static bool vanishes(const MergedEnergy<Interval>::Product& p, bool is_zero) {
    return is_nothing(p.w) || (may_vanish(p.w) && (is_zero || (p.a < 0 && p.b < 0)));
  }

  void tie_products() {
    const auto node = [&](int frame) { return frame < 0 ? ties_.ground() : frame; };
    for (std::size_t k = 0; k < products_.size(); ++k) {
      const auto& p = products_[k];
      if (vanishes_[k]) continue;
      ties_.tie(node(p.f), node(p.g));
      for (const int length : {p.a, p.b}) {
        if (length >= 0) ties_.tie(length, ties_.ground());
      }
    }
  }

  // Closures, stops, torques and the other force elements hold what they act on.
  void tie_everything_else() {
    const Mechanism<double>& m = model_.mechanism();
    const Scene& scene = model_.scene();
    std::vector<int> support_size(static_cast<std::size_t>(m.constraints()));
    for (const int row : m.jacobian_row()) ++support_size[static_cast<std::size_t>(row)];
    for (std::size_t e = 0; e < m.jacobian_row().size(); ++e) {
      const int row = m.jacobian_row()[e];
      const int stop = row - m.equalities();
      const bool limits_one_angle = stop >= 0 && support_size[static_cast<std::size_t>(row)] == 1 &&
                                    scene.stops[static_cast<std::size_t>(stop)].on.kind == Measure::Kind::angle &&
                                    is_inside(stop);
      if (!limits_one_angle) ties_.tie(m.jacobian_column()[e], ties_.ground());
    }
    for (const Torque& torque : scene.torques) {
      const int frame = model_.layout().links[static_cast<std::size_t>(torque.body)].frame;
      if (torque.value != 0.0 && frame >= 0 && frame < n_) ties_.tie(frame, ties_.ground());
    }
    const Scene scaled = model_.scaled_scene();
    for (const Element& element : scaled.elements) {
      if (!stores_energy(element.law) || !idle(element.law).empty()) continue;
      if (spring_without_free_length(element) != nullptr) continue;
      const CompiledMeasure<double> on(scaled, model_.layout(), m.phasors(), element.on);
      for (const int i : on.support()) ties_.tie(i, ties_.ground());
    }
  }

  bool is_inside(int stop) const {
    const Mechanism<double>& m = model_.mechanism();
    std::vector<Planar<double>> pose(static_cast<std::size_t>(m.pose_size()));
    std::vector<double> constraint(static_cast<std::size_t>(m.constraints()));
    m.place(start_.data(), pose.data());
    m.constraint(start_.data(), pose.data(), constraint.data());
    const double value = constraint[static_cast<std::size_t>(m.stop_row(stop))];
    return value > m.lower()[static_cast<std::size_t>(stop)] && value < m.upper()[static_cast<std::size_t>(stop)];
  }

  // Of the group whose first is i.
  std::optional<NeutralMotions::Motion> motion_of(int first) const {
    NeutralMotions::Motion out;
    for (int i = 0; i < n_; ++i) {
      if (ties_.group(i) == first) out.coordinates.push_back(i);
    }
    const auto can_hold = std::find_if(out.coordinates.begin(), out.coordinates.end(),
                                       [&](int i) { return measure_of(model_, i).has_value(); });
    if (can_hold == out.coordinates.end()) return std::nullopt;
    std::iter_swap(out.coordinates.begin(), can_hold);
    out.held = out.coordinates.front();
    out.exact = true;
    const solvers::RoundingUp up;
    Interval effort(0);
    for (std::size_t k = 0; k < products_.size(); ++k) {
      const auto& p = products_[k];
      const auto is_in = [&](int i) { return i >= 0 && ties_.group(i) == first; };
      if (is_in(p.f) == is_in(p.g) && !is_in(p.a) && !is_in(p.b)) continue;
      if (is_nothing(p.w) || is_exact_[k]) continue;
      out.exact = false;
      effort += Interval(norm(p.w).upper());
    }
    const double unit = model_.layout().is_length(out.held) ? model_.scales().force : model_.scales().energy();
    out.effort = effort.upper() * unit;
    return out;
  }

 private:
  const StaticModel& model_;
  const std::vector<double>& start_;
  const int n_;
  Ties ties_;
  std::vector<MergedEnergy<Interval>::Product> products_;
  std::vector<char> vanishes_, is_exact_;
};

// Stops that limit one angle, which is free to be anywhere between.
bool limits_alone(const Layout& layout, const Stop& stop, int coordinate) {
  if (stop.on.kind != Measure::Kind::angle || !(stop.min < stop.max)) return false;
  const auto frame = [&](int body) { return layout.links[static_cast<std::size_t>(body)].frame; };
  return frame(stop.on.body_a) == coordinate || frame(stop.on.body_b) == coordinate;
}

}  // namespace

std::vector<double> NeutralMotions::moved_to(const std::vector<double>& at, std::vector<double> x) const {
  for (const Motion& motion : motions) {
    const auto held = static_cast<std::size_t>(motion.held);
    const double by = at[held] - x[held];
    for (const int i : motion.coordinates) x[static_cast<std::size_t>(i)] += by;
    x[held] = at[held];
  }
  return x;
}

NeutralMotions neutral_motions(const StaticModel& model, const std::vector<double>& start) {
  return NeutralSearch(model, start).run();
}

Scene with_motions_held(const StaticModel& model, const NeutralMotions& neutral, const std::vector<double>& x) {
  Scene scene = model.scene();
  const std::vector<double> q = model.to_si(x);
  for (const NeutralMotions::Motion& motion : neutral.motions) {
    std::erase_if(scene.stops, [&](const Stop& stop) {
      return std::any_of(motion.coordinates.begin(), motion.coordinates.end(),
                         [&](int i) { return limits_alone(model.layout(), stop, i); });
    });
    Stop& hold = scene.stops.emplace_back();
    hold.name = model.layout().coordinates[static_cast<std::size_t>(motion.held)].name;
    hold.on = *measure_of(model, motion.held);
    hold.min = hold.max = q[static_cast<std::size_t>(motion.held)];
  }
  return scene;
}

}  // namespace poise
