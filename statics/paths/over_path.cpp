#include "statics/paths/over_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "statics/bodies/body_measures.hpp"
#include "statics/paths/private/path_pieces.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;

constexpr double accuracy = 1e-9;

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

/// A branch as a curve: points, and those between neighbours.
class BranchCurve {
 public:
  BranchCurve(const VariedScene& varied, const PathBranch& branch, const OtherQuantities& others)
      : varied_(varied), branch_(branch), reader_(varied, others), pieces_(varied) {}

  std::size_t size() const { return branch_.points.size(); }
  /// Size of the varied number's range, and what a quantity of the mechanism is measured in, SI.
  double range() const { return std::abs(varied_.to() - varied_.from()); }
  double scale_of(const SoughtQuantity& of) const { return 1.0 / of.dimension.per_scale(varied_.scales()); }
  const PathPoint& operator[](std::size_t k) const { return branch_.points[k]; }

  /// At the part t of the way from a point to the next one; empty where the curve cannot be followed there.
  std::optional<PathPoint> between(std::size_t k, double t) {
    const PathPoint &a = branch_.points[k], &b = branch_.points[k + 1];
    if (t == 0.0) return a;
    if (t == 1.0) return b;
    if (k != prepared_) prepare(k);
    for (const std::optional<PathSpot>& spot : spots_) {
      std::optional<PathPoint> point = spot ? between(*spot, k, t) : std::nullopt;
      if (point && is_consistent(*point)) return point;
    }
    return std::nullopt;
  }

  /// Values of several quantities there, why the first has none in `why`.
  std::vector<double> values(const std::vector<SoughtQuantity>& of, const PathPoint& point, std::string& why) {
    std::vector<double> out;
    for (const QuantityValue& one : reader_.values(of, point)) {
      out.push_back(one.value);
      if (why.empty() && !one.why.empty()) {
        why = fmt::format("it is undefined at {} = {:.6g} {}: {}", varied_.name(), point.parameter / varied_.unit(),
                          varied_.unit_name(), one.why);
      }
    }
    return out;
  }

 private:
  std::optional<PathPoint> between(PathSpot spot, std::size_t k, double t) {
    const PathPoint &a = branch_.points[k], &b = branch_.points[k + 1];
    solvers::Curve& curve = pieces_.curve(spot.piece);
    Eigen::VectorXd chord = Eigen::VectorXd::Zero(spot.point.z.size());
    const Eigen::Index n = curve.variables();
    const Eigen::VectorXd from = Eigen::VectorXd::Map(a.x.data(), n), to = Eigen::VectorXd::Map(b.x.data(), n);
    const double p_from = varied_.part_at(a.parameter), p_to = varied_.part_at(b.parameter);
    chord.head(n) = to - from;
    chord[chord.size() - 1] = p_to - p_from;
    if (chord.isZero()) return std::nullopt;
    spot.point.z.head(n) = (1 - t) * from + t * to;
    spot.point.z[chord.size() - 1] = (1 - t) * p_from + t * p_to;
    if (!curve.correct(spot.point.z, chord / chord.norm()).converged) return std::nullopt;
    return pieces_.report(spot);
  }

  // Springs act and stops hold there as the piece of curve says: at an event one end is of another piece.
  bool is_consistent(const PathPoint& point) {
    constexpr double rounding = 1e-9;
    const Scene scene = varied_.scene_at(point.parameter);
    const StaticModel& model = reader_.model(point);
    std::vector<BodyPose<double>> poses = model.poses(point.x);
    poses.resize(scene.bodies.size());
    const auto nothing = [&](const Measure& on) { return rounding / on.dimension().per_scale(varied_.scales()); };
    for (std::size_t e = 0; e < scene.elements.size(); ++e) {
      const auto* spring = std::get_if<LinearSpring>(&scene.elements[e].law);
      if (spring == nullptr || spring->acts == LinearSpring::Acts::both) continue;
      const double stretch = value_of(scene, scene.elements[e].on, poses) - spring->free_length;
      const bool acts = (spring->acts == LinearSpring::Acts::tension) == (stretch > 0.0);
      const bool is_slack = std::find(point.slack_springs.begin(), point.slack_springs.end(), static_cast<int>(e)) !=
                            point.slack_springs.end();
      if (acts == is_slack && std::abs(stretch) > nothing(scene.elements[e].on)) return false;
    }
    for (const Stop& stop : scene.stops) {
      const double g = value_of(scene, stop.on, poses), aside = nothing(stop.on);
      if (g < stop.min - aside || g > stop.max + aside) return false;
    }
    return true;
  }

  // The multipliers of both ends, from which those between are found: where the piece changes at one end, the stops of
  // the other hold between.
  void prepare(std::size_t k) {
    prepared_ = k;
    const PathPoint &a = branch_.points[k], &b = branch_.points[k + 1];
    const std::vector<int>& active = (a.active_stops.size() <= b.active_stops.size() ? a : b).active_stops;
    spots_ = {pieces_.spot(a.x, varied_.part_at(a.parameter), active, 1.0),
              pieces_.spot(b.x, varied_.part_at(b.parameter), active, 1.0)};
  }

  const VariedScene& varied_;
  const PathBranch& branch_;
  PathReader reader_;
  PathPieces pieces_;
  std::size_t prepared_ = static_cast<std::size_t>(-1);
  std::array<std::optional<PathSpot>, 2> spots_;
};

OverPathValue none(std::string why) { return {std::numeric_limits<double>::quiet_NaN(), std::move(why), {}, false}; }

/// Extremes of one quantity on a branch.
class Extremes {
 public:
  Extremes(BranchCurve& curve, const SoughtQuantity& of) : curve_(curve), of_{of} {
    for (std::size_t k = 0; k < curve_.size() && why_.empty(); ++k) {
      samples_.push_back(curve_.values(of_, curve_[k], why_).front());
      size_ = std::max(size_, std::abs(samples_.back()));
    }
  }

  OverPathValue find(double sense) {
    if (!why_.empty()) return none(why_);
    const auto [least, most] = std::minmax_element(samples_.begin(), samples_.end());
    if (*most - *least <= accuracy * size_) return {samples_.front(), "", {curve_[0].parameter}, false};
    struct Found {
      double value, at;
    };
    std::vector<Found> found;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const bool rises = k == 0 || sense * samples_[k] >= sense * samples_[k - 1];
      const bool falls = k + 1 == samples_.size() || sense * samples_[k] >= sense * samples_[k + 1];
      if (!rises || !falls) continue;
      Found one{samples_[k], curve_[k].parameter};
      for (const std::size_t piece : {k - 1, k}) {
        if (piece >= samples_.size() - 1) continue;  // also that before the first, the largest number
        refine(piece, sense, one.value, one.at);
      }
      found.push_back(one);
    }
    const auto best = std::max_element(
        found.begin(), found.end(), [&](const Found& a, const Found& b) { return sense * a.value < sense * b.value; });
    constexpr double unbounded = 1e3;
    if (std::abs(best->value) > unbounded * std::max(size_, std::numeric_limits<double>::min())) {
      return none("it grows without bound");
    }
    OverPathValue out{best->value, "", {}, false};
    for (const Found& one : found) {
      if (std::abs(one.value - best->value) > accuracy * size_) continue;
      // Where an extreme is flat, its place is known to the root of rounding.
      constexpr double same_place = 1e-5;
      const bool is_new = std::none_of(out.at.begin(), out.at.end(),
                                       [&](double at) { return std::abs(at - one.at) <= same_place * curve_.range(); });
      if (is_new) out.at.push_back(one.at);
    }
    out.is_attained_twice = out.at.size() > 1;
    return out;
  }

 private:
  // The largest sense Q between a point and the next, by golden sections to rounding of the value.
  void refine(std::size_t k, double sense, double& value, double& at) {
    constexpr double golden = 0.3819660112501051;
    constexpr int most = 60;
    double from = 0.0, to = 1.0, t = golden, u = 1.0 - golden;
    const auto q = [&](double part) {
      const std::optional<PathPoint> point = curve_.between(k, part);
      if (!point) return std::numeric_limits<double>::quiet_NaN();
      std::string why;
      const double one = curve_.values(of_, *point, why).front();
      if (!why.empty()) return std::numeric_limits<double>::quiet_NaN();
      if (sense * one > sense * value) {
        value = one;
        at = point->parameter;
      }
      return sense * one;
    };
    double at_t = q(t), at_u = q(u);
    for (int step = 0; step < most && !std::isnan(at_t) && !std::isnan(at_u) && to - from > 1e-7; ++step) {
      if (at_t > at_u) {
        to = u;
        u = t;
        at_u = at_t;
        t = from + golden * (to - from);
        at_t = q(t);
      } else {
        from = t;
        t = u;
        at_t = at_u;
        u = to - golden * (to - from);
        at_u = q(u);
      }
    }
  }

  BranchCurve& curve_;
  std::vector<SoughtQuantity> of_;
  std::vector<double> samples_;
  double size_ = 0.0;
  std::string why_;
};

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
    if (deepest == 0 || std::abs(change) <= std::max(15 * 0.01 * accuracy * size, nothing_))
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

OverPathValue extreme_of(BranchCurve& curve, const SoughtQuantity& of) {
  Extremes extremes(curve, of.of.front());
  if (of.kind != Kind::span) return extremes.find(of.kind == Kind::maximum ? 1.0 : -1.0);
  OverPathValue most = extremes.find(1.0);
  OverPathValue least = extremes.find(-1.0);
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
      return extreme_of(curve, of);
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
