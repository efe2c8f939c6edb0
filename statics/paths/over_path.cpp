#include "statics/paths/over_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "statics/paths/private/branch_curve.hpp"
#include "statics/paths/private/extremes.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;

/// The force in a work whose path it is: its own part that has one.
const SoughtQuantity& force_in(const SoughtQuantity& of) {
  for (const SoughtQuantity& part : of.of) {
    if (part.kind != Kind::number) return force_in(part);
  }
  return of;
}

/// Over what a force does its work: one measure, or two of which each counts by a factor.
struct WorkPath {
  std::vector<SoughtQuantity> measures;
  std::vector<double> factors;
};

WorkPath work_path(const Scene& scene, const SoughtQuantity& work) {
  const SoughtQuantity& force = force_in(work.of.front());
  const auto measured = [](const Measure& on) {
    return SoughtQuantity{.name = "", .on = on, .dimension = on.dimension()};
  };
  if (force.kind == Kind::push) {
    return {{measured(Measure::x_of(force.point)), measured(Measure::y_of(force.point))},
            {force.direction.x, force.direction.y}};
  }
  if (force.kind == Kind::element_force) {
    return {{measured(scene.elements[static_cast<std::size_t>(force.item)].on)}, {1.0}};
  }
  return {{measured(force.on)}, {1.0}};
}

OverPathValue none(std::string why) { return {std::numeric_limits<double>::quiet_NaN(), std::move(why), {}, false}; }

/// A value of a quantity at a point of a branch.
struct QuantitySample {
  double value = 0.0, at = 0.0;
};

OverPathValue extreme_of(BranchCurve& curve, const SoughtQuantity& quantity, double sense) {
  const std::vector<SoughtQuantity> of{quantity};
  std::vector<QuantitySample> samples;
  std::string why;
  for (std::size_t k = 0; k < curve.size() && why.empty(); ++k) {
    samples.push_back({curve.values(of, curve[k], why).front(), curve[k].parameter});
  }
  if (!why.empty()) return none(why);
  const Extremes<QuantitySample> extremes(std::move(samples), curve.range(),
                                          [&](std::size_t k, double t) -> std::optional<QuantitySample> {
                                            const std::optional<PathPoint> point = curve.between(k, t);
                                            if (!point) return std::nullopt;
                                            std::string undefined;
                                            const double value = curve.values(of, *point, undefined).front();
                                            if (!undefined.empty()) return std::nullopt;
                                            return QuantitySample{value, point->parameter};
                                          });
  const std::vector<QuantitySample> found = extremes.find(sense);
  if (extremes.is_unbounded(found.front())) return none("it grows without bound");
  OverPathValue out{found.front().value, "", {}, found.size() > 1};
  for (const QuantitySample& one : found) out.at.push_back(one.at);
  return out;
}

/// The integral of Q dm over a branch.
class Integral {
 public:
  /// `path`: m; the varied number where it has no measures, and then over |dm|.
  Integral(BranchCurve& curve, const SoughtQuantity& of, const WorkPath& path) : curve_(curve), path_(path), of_{of} {
    of_.insert(of_.end(), path.measures.begin(), path.measures.end());
    constexpr double rounding = 1e-13;
    const double length = path.measures.empty() ? curve.range() : curve.scale_of(path.measures.front());
    nothing_ = rounding * curve.scale_of(of) * length;
  }

  struct Sum {
    double integral = 0.0, length = 0.0;
  };
  std::optional<Sum> find() {
    Sum out;
    for (std::size_t k = 0; k + 1 < curve_.size(); ++k) {
      const Node a = node(curve_[k]), b = node(curve_[k + 1]);
      const std::optional<Node> middle = node_at(k, 0.5);
      if (!why_.empty()) return std::nullopt;
      constexpr int deepest = 8;
      const double part = middle ? halved(k, 0.0, 1.0, a, *middle, b, deepest) : 0.5 * (a.q + b.q) * (b.m - a.m);
      if (!why_.empty()) return std::nullopt;
      const bool backwards = path_.measures.empty() && b.m < a.m;
      out.integral += backwards ? -part : part;
      out.length += std::abs(b.m - a.m);
      largest_ = std::max(largest_, std::abs(out.integral));
    }
    return out;
  }
  const std::string& why() const { return why_; }

 private:
  struct Node {
    double q = 0.0, m = 0.0;
  };

  Node node(const PathPoint& point) {
    const std::vector<double> values = curve_.values(of_, point, why_);
    Node out{values.front(), path_.measures.empty() ? point.parameter : 0.0};
    for (std::size_t i = 0; i < path_.measures.size(); ++i) out.m += path_.factors[i] * values[1 + i];
    return out;
  }
  std::optional<Node> node_at(std::size_t k, double t) {
    const std::optional<PathPoint> point = curve_.between(k, t);
    if (!point) return std::nullopt;
    return node(*point);
  }

  // Integrates Q dm/dt of parabolas in t through three nodes each by Simpson's rule, which is exact for them.
  static double of_parabolas(const Node& a, const Node& c, const Node& b) {
    const double at_a = -3 * a.m + 4 * c.m - b.m, at_c = b.m - a.m, at_b = a.m - 4 * c.m + 3 * b.m;
    return (a.q * at_a + 4 * c.q * at_c + b.q * at_b) / 6;
  }

  double halved(std::size_t k, double from, double to, const Node& a, const Node& c, const Node& b, int deepest) {
    const double whole = of_parabolas(a, c, b), middle = 0.5 * (from + to);
    const std::optional<Node> d = node_at(k, 0.5 * (from + middle)), e = node_at(k, 0.5 * (middle + to));
    if (!d || !e || !why_.empty()) return whole;
    const double left = of_parabolas(a, *d, c), right = of_parabolas(c, *e, b);
    const double change = left + right - whole;
    const double size = std::max({largest_, std::abs(left) + std::abs(right), std::numeric_limits<double>::min()});
    // The rule is of the order 4: what is left is a fifteenth of the change.
    if (deepest == 0 || std::abs(change) <= std::max(15 * 0.01 * extreme_accuracy * size, nothing_))
      return left + right + change / 15;
    return halved(k, from, middle, a, *d, c, deepest - 1) + halved(k, middle, to, c, *e, b, deepest - 1);
  }

  BranchCurve& curve_;
  const WorkPath& path_;
  std::vector<SoughtQuantity> of_;
  std::string why_;
  double largest_ = 0.0;
  double nothing_ = 0.0;  // rounding of an integral
};

OverPathValue integral_of(BranchCurve& curve, const Scene& scene, const SoughtQuantity& of) {
  const WorkPath path = of.kind == Kind::work ? work_path(scene, of) : WorkPath{};
  Integral integral(curve, of.of.front(), path);
  const std::optional<Integral::Sum> sum = integral.find();
  if (!sum) return none(integral.why());
  if (of.kind == Kind::work) return {sum->integral, "", {}, false};
  if (sum->length == 0.0) return none("the branch is a point");
  return {sum->integral / sum->length, "", {}, false};
}

OverPathValue extreme_or_span(BranchCurve& curve, const SoughtQuantity& of) {
  const SoughtQuantity& quantity = of.of.front();
  if (of.kind != Kind::span) return extreme_of(curve, quantity, of.kind == Kind::maximum ? 1.0 : -1.0);
  OverPathValue most = extreme_of(curve, quantity, 1.0);
  OverPathValue least = extreme_of(curve, quantity, -1.0);
  if (!least.why.empty()) return least;
  most.value -= least.value;
  most.at.insert(most.at.end(), least.at.begin(), least.at.end());
  most.is_attained_twice = most.is_attained_twice || least.is_attained_twice;
  return most;
}

OverPathValue value_over(BranchCurve& curve, const Scene& scene, const SoughtQuantity& of) {
  switch (of.kind) {
    case Kind::maximum:
    case Kind::minimum:
    case Kind::span:
      return extreme_or_span(curve, of);
    case Kind::mean:
    case Kind::work:
      return integral_of(curve, scene, of);
    case Kind::number:
      return {of.constant, "", {}, false};
    default:
      break;
  }
  OverPathValue a = value_over(curve, scene, of.of[0]);
  OverPathValue b = value_over(curve, scene, of.of[1]);
  if (!a.why.empty()) return a;
  if (!b.why.empty()) return b;
  a.value = of.kind == Kind::sum          ? a.value + b.value
            : of.kind == Kind::difference ? a.value - b.value
            : of.kind == Kind::product    ? a.value * b.value
                                          : a.value / b.value;
  a.at.insert(a.at.end(), b.at.begin(), b.at.end());
  a.is_attained_twice = a.is_attained_twice || b.is_attained_twice;
  return std::isfinite(a.value) ? a : none("it is divided by zero");
}

}  // namespace

OverPathValue over_path(const VariedScene& varied, const PathBranch& branch, const SoughtQuantity& of,
                        const OtherQuantities& others) {
  if (branch.points.empty()) return none("the branch has no points");
  BranchCurve curve(varied, branch, others);
  return value_over(curve, varied.scene(), of);
}

}  // namespace poise
