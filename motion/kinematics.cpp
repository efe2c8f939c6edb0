#include "motion/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/meshing.hpp"
#include "model/named_measures.hpp"
#include "model/nearest_name.hpp"
#include "motion/driven_coordinates.hpp"
#include "motion/driven_path.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/singular_words.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string where(const Scene& scene) { return scene.file.empty() ? "" : scene.file + ": "; }

// The scene with the drives in it, so that the compiled model keeps the coordinates that they move.
Scene driven_scene(Scene scene, const std::vector<DriveRange>& ranges) {
  if (ranges.empty()) throw InputError(where(scene) + "drive: expected at least one, say crank=0..360");
  refuse_states_of_controllers(scene, "forces of a given motion");
  scene.drives.clear();
  forget_functions_of_drives(scene);
  for (const DriveRange& range : ranges) {
    if (!range.on) {
      scene.drives.push_back(find_drive(scene, range.name));
      continue;
    }
    Drive& drive = scene.drives.emplace_back();
    drive.name = range.name;
    drive.on = *range.on;
  }
  return scene;
}

VectorXd assembled(const MotionModel& model) {
  const StaticModel statics(model.scene());
  const Mobility mobility = analyse_mobility(statics);
  if (!mobility.assembled) assemble(statics);  // says why
  const std::vector<double> x = motion_coordinates(model, statics, mobility.x);
  return Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

Eigen::Index rank_of(const SplitClosure& closure, const MatrixXd& matrix) {
  if (matrix.size() == 0) return 0;
  const VectorXd values = solvers::singular_value_decomposition(matrix).values;
  const double largest = std::max(values[0], closure.least_scale());
  return (values.array() >= DrivenPath::singular_below * largest && values.array() > 0.0).count();
}

// Whether columns of the closures, `of` their Jacobian, have a higher rank in a pose close by than at x.
template <class Of>
bool gains_rank_beside(const SplitClosure& closure, const VectorXd& x, Of of) {
  const EquilibriumProblem problem(closure.model().mechanism());
  solvers::Newton newton(problem);
  const Eigen::Index rank = rank_of(closure, of(closure.jacobian(x)));
  for (int k = 1; k <= 4; ++k) {
    VectorXd beside = x;
    for (Eigen::Index i = 0; i < x.size(); ++i) beside[i] += 0.03 * std::sin(k + 2.0 * k * static_cast<double>(i));
    const std::vector<double> q = closure.coordinates(beside);
    const solvers::NewtonResult& closed = newton.close(q);
    if (closed.end != solvers::NewtonEnd::converged) continue;
    const Eigen::Map<const VectorXd> pose(closed.x.data(), static_cast<Eigen::Index>(closed.x.size()));
    if (rank_of(closure, of(closure.jacobian(closure.with_measures(pose)))) > rank) return true;
  }
  return false;
}

// Throws unless the drives determine the motion without redundancy.
void expect_driven(const SplitClosure& closure, const std::vector<DrivenCoordinate>& driven, const VectorXd& x) {
  const Scene& scene = closure.model().scene();
  const MatrixXd jacobian = closure.jacobian(x);
  const MatrixXd of_free = closure.free_columns(jacobian);
  const Eigen::Index freedoms = x.size() - rank_of(closure, jacobian);
  const Eigen::Index drives = static_cast<Eigen::Index>(closure.driven().size());
  const Eigen::Index left = of_free.cols() - rank_of(closure, of_free);
  const auto name_of = [&](int coordinate) { return closure.model().layout().coordinates[coordinate].name; };
  if (left == 0) {
    if (drives <= freedoms) return;
    throw InputError(
        fmt::format("{}drive: expected {} of them, as many as the mechanism has degrees of freedom, found {}; leave "
                    "out the others",
                    where(scene), freedoms, drives));
  }
  const auto all_columns = [](const MatrixXd& of_all) { return of_all; };
  const auto free_columns = [&](const MatrixXd& of_all) { return closure.free_columns(of_all); };
  if (freedoms <= drives && !closure.measured().empty() && !gains_rank_beside(closure, x, free_columns)) {
    throw InputError(fmt::format(
        "{}drive \"{}\": expected a measure that changes as the mechanism moves, in every position near it stays "
        "the same, or follows from other drives; drive another",
        where(scene), scene.drives[static_cast<std::size_t>(closure.measured().front())].name));
  }
  if (freedoms <= drives || gains_rank_beside(closure, x, all_columns)) {
    const std::string& start = driven.front().start;
    throw InputError(fmt::format(
        "{}drive \"{}\": the start is a singular position, where it does not determine the motion; expected a regular "
        "one; "
        "change [start]{}",
        where(scene), scene.drives.front().name, start.empty() ? "" : fmt::format(", say --set start.{}=...", start)));
  }
  MatrixXd moves = MatrixXd::Identity(of_free.cols(), of_free.cols());
  if (of_free.rows() > 0) {
    moves = solvers::singular_value_decomposition(of_free).right.rightCols(left);
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < closure.free().size(); ++i) {
    if (moves.row(static_cast<Eigen::Index>(i)).norm() > 1e-6) names.push_back(name_of(closure.free()[i]));
  }
  const Stop* const cam = cam_that_may_lift(scene);
  throw InputError(fmt::format(
      "{}drive: {} {} undriven; expected as many drives as degrees of freedom; drive {} more, of {}{}", where(scene),
      left, left == 1 ? "degree of freedom is" : "degrees of freedom are", left, fmt::join(names, ", "),
      cam == nullptr ? "" : fmt::format("; or give cam \"{}\", which may lift off, guided = true", cam->name)));
}

class Sweep {
 public:
  Sweep(const MotionModel& model, const std::vector<DriveRange>& ranges, const SweepOptions& options)
      : model_(model),
        ranges_(ranges),
        options_(options),
        driven_(driven_coordinates(model)),
        closure_(model, columns(), measured_drives(model.scene())) {
    for (int i = 0; i < model.mechanism().coordinates(); ++i) {
      result_.coordinates.push_back(model.layout().coordinates[i].name);
      result_.is_angle.push_back(i < model.layout().angles);
    }
    for (std::size_t i = 0; i < model.scene().bodies.size(); ++i) {
      const int frame = model.layout().links[i].frame;
      result_.turns.push_back(frame >= 0 && frame < model.layout().kept);
    }
  }

  KinematicsResult run() {
    expect_values();
    const VectorXd start = closure_.with_measures(assembled(model_));
    expect_driven(closure_, driven_, start);
    const std::optional<PathPose> begin = approach(start);
    if (begin) traverse(*begin);
    return std::move(result_);
  }

 private:
  std::vector<int> columns() const {
    std::vector<int> out;
    for (const DrivenCoordinate& d : driven_) out.push_back(d.coordinate);
    return out;
  }

  bool stopped() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

  std::vector<double> drive_values(const VectorXd& x) const {
    std::vector<double> out;
    for (const DrivenCoordinate& d : driven_) out.push_back(d.value(x[d.coordinate]));
    return out;
  }

  std::vector<double> in_si(const VectorXd& x) const { return model_.to_si(closure_.coordinates(x)); }

  // Throws for a measure that is the same in every pose, or a value that it cannot have.
  void expect_values() const {
    const Scene& scene = model_.scene();
    if (const int k = closure_.constant_measure(); k >= 0) {
      throw InputError(
          fmt::format("{}drive \"{}\": expected a measure that changes as the mechanism moves, this one is "
                      "the same in every position; drive another",
                      where(scene), scene.drives[closure_.measured()[k]].name));
    }
    for (std::size_t k = 0; k < ranges_.size(); ++k) {
      const Range range = scene.drives[k].on.range();
      const double unit = scene.drives[k].on.dimension().unit(scene.units);
      for (const double end : {ranges_[k].from, ranges_[k].to}) {
        if (contains(range, end)) continue;
        throw InputError(
            fmt::format("{}drive \"{}\": {}", where(scene), ranges_[k].name, out_of_range(range, end / unit)));
      }
    }
  }

  // From the assembled start to the beginning of the range. Derivatives are per unit of the path that follows.
  std::optional<PathPose> approach(const VectorXd& start) {
    const Eigen::Index drives = static_cast<Eigen::Index>(driven_.size());
    VectorXd ahead(drives), along(drives);
    for (Eigen::Index k = 0; k < drives; ++k) {
      const DrivenCoordinate& d = driven_[k];
      ahead[k] = d.scaled(ranges_[k].from) - start[d.coordinate];
      along[k] = (ranges_[k].to - ranges_[k].from) / d.unit;
    }
    expect_within_reach(ahead, "from the start to its range");
    expect_within_reach(along, "over its range");
    standing_ = along.isZero(0.0);
    if (standing_) along[0] = 1.0 / driven_[0].unit;
    direction_ = along;
    const DrivenPath path(closure_, ahead);
    std::optional<PathPose> begin = path.differentiated(0.0, start);
    if (!ahead.isZero(1e-15)) {
      const PathPose from = *begin;
      begin.reset();
      const std::optional<PathEnd> last = path.follow(
          from, {1.0}, {[&](const PathPose& pose) { begin = pose; }, [&](const PathPose& p) { note(p, true); }},
          options_.most_steps, [&] { return stopped(); });
      if (last && last->stop >= 0) {
        throw InputError(fmt::format("{}drive \"{}\": {}, on the way from the start; expected a value within the stops",
                                     where(model_.scene()), ranges_.front().name, words(*last)));
      }
      if (!begin) {
        give_up(*last, true);
        return std::nullopt;
      }
    }
    if (begin->closeness >= DrivenPath::singular_below)
      return DrivenPath(closure_, along).differentiated(0.0, begin->x);
    if (drives > 1) {
      result_.why = "the range begins in a singular position, where several drives do not determine the motion";
      return std::nullopt;
    }
    // The motion continues, or reverses, along the same path.
    const double turn = along[0] / ahead[0];
    begin->at = 0.0;
    begin->v *= turn;
    begin->a *= turn * turn;
    return begin;
  }

  // A way that would take more steps than are tried is refused before the first.
  void expect_within_reach(const VectorXd& way, const char* which) const {
    const double farthest = options_.most_steps * DrivenPath::longest_move;
    for (std::size_t k = 0; k < driven_.size(); ++k) {
      const double far = std::abs(way[static_cast<Eigen::Index>(k)]);
      if (far < farthest) continue;
      const bool is_angle = driven_[k].is_angle;
      throw InputError(
          fmt::format("{}drive \"{}\": expected to be driven by less than {} {}, found {}; change [start] or "
                      "the range",
                      where(model_.scene()), ranges_[k].name, in_units(farthest * driven_[k].unit, is_angle), which,
                      in_units(far * driven_[k].unit, is_angle)));
    }
  }

  void traverse(const PathPose& begin) {
    const DrivenPath path(closure_, direction_);
    if (standing_) {
      add_sample(begin);
      result_.complete = true;
      return;
    }
    std::vector<double> samples = options_.at;
    for (int k = 0; k <= options_.steps && options_.at.empty(); ++k) {
      samples.push_back(static_cast<double>(k) / options_.steps);
    }
    const std::optional<PathEnd> last = path.follow(
        begin, samples, {[&](const PathPose& p) { add_sample(p); }, [&](const PathPose& p) { note(p, false); }},
        options_.most_steps, [&] { return stopped(); });
    result_.complete = !last.has_value();
    if (!last) return;
    if (last->stop < 0) {
      give_up(*last, false);
      return;
    }
    const auto beyond = std::upper_bound(samples.begin(), samples.end(), last->pose.at);
    if (beyond == samples.begin() || last->pose.at - *(beyond - 1) > 1e-12) add_sample(last->pose);
    result_.stop = MetStop{static_cast<std::size_t>(last->stop), last->at_max};
    result_.why = words(*last);
  }

  // `the stop "cowl" is reached at hood = 1.2 rad (its max, 1.2 rad)`.
  std::string words(const PathEnd& end) const {
    const Stop& stop = model_.scene().stops[static_cast<std::size_t>(end.stop)];
    return fmt::format("the stop \"{}\" is reached at {} (its {}, {})", stop.name, drive_words(end.pose.x),
                       end.at_max ? "max" : "min", in_units(end.at_max ? stop.max : stop.min, stop.on.is_angle()));
  }

  std::string in_units(double value, bool is_angle) const {
    const Units& units = model_.scene().units;
    return fmt::format("{:.10g} {}", value / (is_angle ? units.angle : units.length),
                       is_angle ? units.angle_name : units.length_name);
  }

  // "crank = 30 deg, ram = 2 mm".
  std::string drive_words(const VectorXd& x) const {
    std::string out;
    for (std::size_t k = 0; k < driven_.size(); ++k) {
      out += fmt::format("{}{} = {}", k == 0 ? "" : ", ", ranges_[k].name,
                         in_units(driven_[k].value(x[driven_[k].coordinate]), driven_[k].is_angle));
    }
    return out;
  }

  void add_sample(const PathPose& pose) {
    // The first drive that moves determines the time scale.
    const std::size_t k = standing_ ? 0 : first_moving(ranges_);
    const double per_second = options_.rate / std::abs(direction_[static_cast<Eigen::Index>(k)] * driven_[k].unit);
    const VectorXd v = per_second * pose.v, a = per_second * per_second * pose.a;
    KinematicSample sample;
    sample.drive = drive_values(pose.x);
    for (const DrivenCoordinate& d : driven_) sample.drive_rate.push_back(d.unit * v[d.coordinate]);
    sample.q = in_si(pose.x);
    sample.rate = in_si(v);
    sample.acceleration = in_si(a);
    const auto list = [&](const VectorXd& x) { return closure_.coordinates(x); };
    sample.bodies = body_motions(model_, list(pose.x), list(v), list(a));
    sample.bodies.resize(model_.scene().bodies.size());
    sample.closeness_to_singular = pose.closeness;
    result_.samples.push_back(std::move(sample));
  }

  SingularPose singular(const PathPose& pose, SingularPose::Kind kind, bool before_range) const {
    SingularPose out;
    out.kind = kind;
    out.before_range = before_range;
    out.drive = drive_values(pose.x);
    out.q = in_si(pose.x);
    out.text = (kind == SingularPose::Kind::change_point ? "change point" : "dead centre") +
               describe_singularity(closure_, pose);
    return out;
  }

  void note(const PathPose& pose, bool before_range) {
    SingularPose found = singular(pose, SingularPose::Kind::change_point, before_range);
    // One exactly at the beginning of the range is found by both parts of the path.
    auto& list = result_.singular;
    if (!list.empty() && std::abs(list.back().drive[0] - found.drive[0]) < 1e-7) list.pop_back();
    list.push_back(std::move(found));
  }

  void give_up(const PathEnd& end, bool before_range) {
    const PathPose& last = end.pose;
    if (stopped()) {
      result_.why = "interrupted";
      return;
    }
    if (end.out_of_steps) {
      result_.why = fmt::format("after {} steps it is at {}", options_.most_steps, drive_words(last.x));
      return;
    }
    result_.why =
        fmt::format("{} cannot be driven beyond {}",
                    before_range ? "on the way to its range the mechanism" : "the mechanism", drive_words(last.x));
    if (last.closeness > end_is_singular_below) return;
    result_.singular.push_back(singular(last, SingularPose::Kind::dead_centre, before_range));
    result_.why += ": " + result_.singular.back().text;
  }

  static constexpr double end_is_singular_below = 1e-4;

  const MotionModel& model_;
  const std::vector<DriveRange>& ranges_;
  const SweepOptions& options_;
  std::vector<DrivenCoordinate> driven_;
  SplitClosure closure_;
  VectorXd direction_;  // of the range, scaled
  bool standing_ = false;
  KinematicsResult result_;
};

NamedMeasure driven_measure_of(const Scene& scene, const std::string& name) {
  if (std::optional<NamedMeasure> found = find_measure(scene, name)) return *found;
  std::string why = why_no_measure(scene, name);
  if (why.empty()) {
    std::vector<std::string> names;
    for (const NamedMeasure& one : named_measures(scene)) {
      const bool has_short_name = one.name.starts_with("angle.") || one.name.starts_with("travel.");
      names.push_back(has_short_name ? one.also.front() : one.name);
    }
    why = fmt::format(
        "expected the name of a body, a slide or a pin in a slot, or angle.BODY.OTHER, length.ELEMENT, x.BODY.POINT, "
        "y.BODY.POINT, along.BODY.POINT.DEGREES{}",
        did_you_mean_or_list(name, names));
  }
  throw InputError(fmt::format("{}drive \"{}\": {}", where(scene), name, why));
}

}  // namespace

Drive find_drive(const Scene& scene, const std::string& name) {
  Drive out;
  out.name = name;
  out.on = driven_measure_of(scene, name).on;
  return out;
}

std::string drive_in_words(const Scene& scene, const std::string& name) { return driven_measure_of(scene, name).words; }

std::size_t first_moving(const std::vector<DriveRange>& ranges) {
  std::size_t k = 0;
  while (k + 1 < ranges.size() && ranges[k].from == ranges[k].to) ++k;
  return k;
}

KinematicsResult sweep(const Scene& scene, const std::vector<DriveRange>& drives, const SweepOptions& options) {
  refuse_blades(scene, "driven positions");
  const MotionModel model(driven_scene(scene, drives));
  return Sweep(model, drives, options).run();
}

}  // namespace poise
