#include "motion/singular_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "motion/driven_coordinates.hpp"
#include "motion/driven_path.hpp"
#include "motion/motion_record.hpp"
#include "motion/simulate.hpp"
#include "motion/singular_words.hpp"
#include "motion/trajectory.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// The places of the drives in a SplitClosure; empty where two drives move one coordinate.
std::vector<int> places_of_drives(const MotionModel& model) {
  std::vector<int> out;
  try {
    for (const DrivenCoordinate& one : driven_coordinates(model)) out.push_back(one.coordinate);
  } catch (const InputError&) {
    return {};
  }
  return out;
}

}  // namespace

SingularState singular_state(const MotionModel& model, const std::vector<double>& x, int rank) {
  const Scene& scene = model.scene();
  const std::vector<int> driven = places_of_drives(model);
  if (driven.size() != scene.drives.size()) return {};
  const std::vector<int> measured = measured_drives(scene);
  const SplitClosure closure(model, driven, measured);
  PathPose pose;
  pose.x = closure.with_measures(Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())));
  // A drive of a coordinate takes one column and its row of the whole Jacobian.
  const Eigen::Index regular = rank - static_cast<Eigen::Index>(driven.size() - measured.size());
  if (closure.free().empty() || regular < 1) return {};
  const solvers::SingularValues svd =
      solvers::singular_value_decomposition(closure.free_columns(closure.jacobian(pose.x)));
  if (regular > svd.values.size()) return {};
  SingularState out;
  out.closeness = svd.values[regular - 1] / std::max(svd.values[0], closure.least_scale());
  pose.left = svd.left.col(regular - 1);
  pose.right = svd.right.col(regular - 1);
  out.text = describe_singularity(closure, pose);
  constexpr double takes_part_in_it = 0.02;
  std::vector<Eigen::Index> order(closure.free().size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index i, Eigen::Index k) { return std::abs(pose.right[i]) > std::abs(pose.right[k]); });
  for (const Eigen::Index i : order) {
    if (std::abs(pose.right[i]) < takes_part_in_it * std::abs(pose.right[order.front()])) break;
    out.movers.push_back(closure.free()[static_cast<std::size_t>(i)]);
  }
  return out;
}

std::optional<SingularPlace> dead_centre_beyond(const MotionModel& model, const LastState& last, double longest) {
  using Eigen::VectorXd;
  constexpr int most_steps = 2000;
  constexpr double first = 1e-6, growth = 8.0, singular_end = 1e-4;
  const std::vector<int> driven = places_of_drives(model);
  if (driven.empty() || driven.size() != model.scene().drives.size()) return std::nullopt;
  const SplitClosure closure(model, driven, measured_drives(model.scene()));
  const auto map = [](const std::vector<double>& values) {
    return VectorXd(Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  const VectorXd x = closure.with_measures(map(last.x));
  // Rates and second derivatives of what is driven.
  const auto of_measures = [&](const VectorXd& of_coordinates) {
    VectorXd out = VectorXd::Zero(x.size());
    out.head(of_coordinates.size()) = of_coordinates;
    const VectorXd open = closure.jacobian(x) * out;
    const Eigen::Index measures = x.size() - of_coordinates.size();
    out.tail(measures) = open.tail(measures);
    return out;
  };
  const VectorXd rate = of_measures(map(last.v));
  VectorXd bend = of_measures(map(last.a));
  const Eigen::Index measures = x.size() - static_cast<Eigen::Index>(last.x.size());
  bend.tail(measures) += closure.curvature(x, rate).tail(measures);
  VectorXd direction(static_cast<Eigen::Index>(driven.size()));
  for (double ahead = first * longest; ahead <= longest; ahead *= growth) {
    for (std::size_t k = 0; k < driven.size(); ++k) {
      direction[static_cast<Eigen::Index>(k)] = ahead * (rate[driven[k]] + ahead / 2 * bend[driven[k]]);
    }
    const DrivenPath path(closure, direction);
    const PathPose begin = path.differentiated(0.0, x);
    if (begin.closeness < DrivenPath::singular_below) return std::nullopt;
    const std::optional<PathEnd> end =
        path.follow(begin, {1.0}, {[](const PathPose&) {}, [](const PathPose&) {}}, most_steps, [] { return false; });
    if (!end) continue;
    if (end->stop >= 0 || end->out_of_steps || end->pose.closeness > singular_end) return std::nullopt;
    // The drive that goes farthest says when: d = rate t + bend t^2 / 2.
    Eigen::Index most = 0;
    direction.cwiseAbs().maxCoeff(&most);
    const int place = driven[static_cast<std::size_t>(most)];
    const double way = end->pose.at * direction[most];
    double t = end->pose.at * ahead;
    for (int k = 0; k < 4; ++k) {
      const double slope = rate[place] + t * bend[place];
      if (slope != 0.0) t -= (t * (rate[place] + t / 2 * bend[place]) - way) / slope;
    }
    return SingularPlace{last.time + t,
                         "dead centre" + describe_singularity(closure, end->pose),
                         position_in_words(model, closure.coordinates(end->pose.x)),
                         {}};
  }
  return std::nullopt;
}

std::string position_in_words(const MotionModel& model, const std::vector<double>& x) {
  constexpr std::size_t most_words = 8;
  constexpr double digits = 1e5;
  const Units& units = model.scene().units;
  const std::vector<double> q = model.to_si(x);
  std::vector<std::string> out;
  for (const Channel& channel : channels_of(model)) {
    if (out.size() == most_words) break;
    const double value =
        in_unit(q[static_cast<std::size_t>(channel.coordinate)] + channel.offset, channel.quantity, units);
    // A position that is reached to the square root of rounding only has no more digits.
    out.push_back(fmt::format("{} = {:.6g} {}", channel.name, std::round(value * digits) / digits + 0.0,
                              unit_name(channel.quantity, units)));
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

namespace {

/// A singular pose near a time at which one is passed, and its rates.
class Passage {
 public:
  Passage(const MotionModel& model, const Motion& motion)
      : model_(model), path_(motion.trajectory), rank_(path_.coordinates - motion.freedoms), reader_(path_, all()) {}

  /// Times of singular poses of a motion in which everything is driven, whose steps may be long.
  std::vector<double> looked_for() {
    constexpr int parts = 8;
    constexpr double passed_below = 1e-6;
    std::vector<double> times, sizes, out;
    for (std::size_t k = 0; k + 1 < path_.t.size(); ++k) {
      for (int i = 0; i < parts; ++i) {
        const double t = path_.t[k] + (path_.t[k + 1] - path_.t[k]) * i / parts;
        if (!times.empty() && !(t > times.back())) continue;
        times.push_back(t);
        sizes.push_back(singular_state(model_, read(t), rank_).closeness);
      }
    }
    for (std::size_t k = 1; k + 1 < times.size(); ++k) {
      if (sizes[k] > sizes[k - 1] || sizes[k] >= sizes[k + 1]) continue;
      const double t = nearest(times[k - 1], times[k + 1]);
      if (singular_state(model_, read(t), rank_).closeness < passed_below) out.push_back(t);
    }
    return out;
  }

  /// The one near a time at which the integrator passed it.
  SingularPlace near(double time) {
    const auto after = std::upper_bound(path_.t.begin(), path_.t.end(), time);
    const double from = after == path_.t.begin() ? time : *(after - 1), to = after == path_.t.end() ? time : *after;
    return at(nearest(std::max(time - (to - from), path_.t.front()), std::min(time + (to - from), path_.t.back())));
  }

  SingularPlace at(double t) {
    const SingularState there = singular_state(model_, read(t), rank_);
    SingularPlace out{t, "change point" + there.text, position_in_words(model_, read(t)), {}};
    const Units& units = model_.scene().units;
    std::vector<std::string> going;
    double fastest = 0.0;
    for (int i = 0; i < path_.coordinates; ++i) {
      fastest = std::max(fastest, std::abs(reader_.v(static_cast<std::size_t>(i))));
    }
    constexpr double rounding = 1e-9;
    for (const int mover : there.movers) {
      const double rate = reader_.v(static_cast<std::size_t>(mover));
      for (const Channel& channel : channels_of(model_)) {
        if (channel.coordinate != mover) continue;
        going.push_back(fmt::format("{} at {:.6g} {}/s", channel.name,
                                    std::abs(rate) <= rounding * fastest ? 0.0 : in_unit(rate, channel.quantity, units),
                                    unit_name(channel.quantity, units)));
        break;
      }
    }
    out.branch = fmt::format("{}", fmt::join(going, ", "));
    return out;
  }

 private:
  std::vector<int> all() const {
    std::vector<int> out(static_cast<std::size_t>(path_.coordinates));
    std::iota(out.begin(), out.end(), 0);
    return out;
  }

  std::vector<double> read(double t) {
    reader_.at(t);
    std::vector<double> q;
    for (std::size_t i = 0; i < static_cast<std::size_t>(path_.coordinates); ++i) q.push_back(reader_.q(i));
    return model_.from_si(std::move(q));
  }

  /// Where the closures are nearest to singular, by golden sections.
  double nearest(double from, double to) {
    constexpr double golden = 0.381966011250105;
    constexpr int sections = 40;
    const auto closeness = [&](double t) { return singular_state(model_, read(t), rank_).closeness; };
    double x = from + golden * (to - from), y = to - golden * (to - from);
    double at_x = closeness(x), at_y = closeness(y);
    for (int k = 0; k < sections; ++k) {
      if (at_x <= at_y) {
        to = std::exchange(y, x);
        at_y = at_x;
        x = from + golden * (to - from);
        at_x = closeness(x);
      } else {
        from = std::exchange(x, y);
        at_x = at_y;
        y = to - golden * (to - from);
        at_y = closeness(y);
      }
    }
    return (from + to) / 2;
  }

  const MotionModel& model_;
  const Trajectory& path_;
  int rank_;
  TrajectoryReader reader_;
};

}  // namespace

std::vector<SingularPlace> singular_places(const MotionModel& model, const Motion& motion, std::size_t most) {
  /// So many steps are looked through for what the integrator did not notice.
  constexpr std::size_t most_looked_through = 500;
  std::vector<SingularPlace> out;
  const std::size_t nodes = motion.trajectory.nodes();
  if (nodes < 2 || motion.trajectory.coordinates == motion.freedoms) return out;
  Passage passage(model, motion);
  for (const double t : motion.singular) {
    if (out.size() < most) out.push_back(passage.near(t));
  }
  if (!motion.singular.empty() || motion.freedoms > 0 || nodes > most_looked_through) return out;
  for (const double t : passage.looked_for()) {
    if (out.size() < most) out.push_back(passage.at(t));
  }
  return out;
}

}  // namespace poise
