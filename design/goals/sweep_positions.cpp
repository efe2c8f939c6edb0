#include "design/goals/sweep_positions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <ceres/jet.h>
#include <fmt/format.h>

#include "model/input_error.hpp"
#include "motion/small_lu.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/paths/path.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

constexpr int lanes_of_design = 8;
using DesignDual = ceres::Jet<double, lanes_of_design>;
constexpr double converged_step = 1e-12, weakest_end = 1e-9;
constexpr double farthest_step = 1.0;  // rad or mechanism sizes; of a position that is another one
constexpr double weakest_pivot = 1e-12;
constexpr int most_steps_of_newton = 12;
constexpr double touching = 1e-9;

/// Factors of R_z; of joints that repeat each other those of least squares.
class UnknownsFactors {
 public:
  UnknownsFactors(const NumberedEquations& equations, const std::vector<double>& p, const std::vector<double>& z)
      : at_(differentiate(equations, p, z, false)) {
    const auto n = static_cast<int>(z.size());
    lu_.resize(n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) lu_.matrix()[i * n + j] = at_.by_unknowns(i, j);
    }
    if (!at_.by_unknowns.allFinite() || !at_.residual.allFinite()) {
      is_finite_ = false;
    } else if (!(lu_.factor() > weakest_pivot)) {
      wide_.emplace(at_.by_unknowns, solvers::known_to::solution);
    }
  }

  bool is_finite() const { return is_finite_; }
  const Eigen::VectorXd& residual() const { return at_.residual; }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const {
    if (wide_) return wide_->solve(b);
    Eigen::VectorXd out = b;
    lu_.solve(out.data());
    return out;
  }

 private:
  ResidualDerivatives at_;
  SmallLu<double> lu_;
  std::optional<solvers::LeastSquares<double>> wide_;
  bool is_finite_ = true;
};

/// Calls at(first, count, p) with `count` variables from `first` on as those by which is derived.
template <class At>
void for_each_lane(const std::vector<double>& p, const DesignNumbers::Slopes& slopes, At at) {
  std::vector<DesignDual> dual(p.begin(), p.end());
  const int variables = static_cast<int>(slopes.size());
  for (int first = 0; first < variables; first += lanes_of_design) {
    const int count = std::min(lanes_of_design, variables - first);
    for (int l = 0; l < count; ++l) {
      for (const auto& [place, slope] : slopes[static_cast<std::size_t>(first + l)]) {
        dual[static_cast<std::size_t>(place)].v[l] += slope;
      }
    }
    at(first, count, dual.data());
    for (int l = 0; l < count; ++l) {
      for (const auto& [place, slope] : slopes[static_cast<std::size_t>(first + l)]) {
        dual[static_cast<std::size_t>(place)].v[l] = 0.0;
      }
    }
  }
}

}  // namespace

SweepPositions::SweepPositions(const GoalProblem& problem, int sweep, std::vector<SoughtQuantity> of)
    : problem_(&problem),
      sweep_(&problem.sweeps[static_cast<std::size_t>(sweep)]),
      of_(std::move(of)),
      at_(sweep_->at) {
  if (is_at_rest()) {
    scales_ = StaticModel(problem.scene).scales();
    numbers_.emplace(problem, problem.scene, scales_);
    return;
  }
  varied_.emplace(varied_in(problem.scene));
  scales_ = varied_->scales();
  numbers_.emplace(problem, varied_->reference_scene(), scales_);
  if (sweep_->along != "loads") return;
  const NumberList& list = *numbers_->list();
  for (std::size_t f = 0; f < problem.scene.forces.size(); ++f) {
    const NumberList::Components vector = list.vector_of(static_cast<int>(f));
    for (const int row : {list.force(static_cast<int>(f)), vector.x, vector.y}) {
      if (row >= 0) loads_.push_back(row);
    }
  }
  for (std::size_t t = 0; t < problem.scene.torques.size(); ++t) loads_.push_back(list.torque(static_cast<int>(t)));
}

/// A single position is the end of a range of any length.
VariedScene SweepPositions::varied_in(Scene scene) const {
  const double last = sweep_->last == sweep_->first ? sweep_->first_shown() + 0.01 * sweep_->natural / sweep_->unit
                                                    : sweep_->last_shown();
  return {std::move(scene), sweep_->along, sweep_->first_shown(), last};
}

std::vector<double> SweepPositions::numbers_at(const DesignPoint& point, double at) const {
  std::vector<double> p = numbers_->at(point);
  const NumberList& list = *numbers_->list();
  if (varied_ && loads_.empty()) {
    const double part = varied_->part_at(at);
    for (const VariedScene::Course& course : varied_->courses()) {
      const int row = list.row(course.place);
      p[static_cast<std::size_t>(row)] =
          course.at(part) * list.rows()[static_cast<std::size_t>(row)].dimension.per_scale(scales_);
    }
  }
  list.follow(p);
  // A factor is of the loads that are chosen, not of those of the scene as given.
  for (const int row : loads_) p[static_cast<std::size_t>(row)] *= at;
  return p;
}

DesignNumbers::Slopes SweepPositions::slopes_at(const DesignPoint& point, double at,
                                                const std::vector<double>& p) const {
  DesignNumbers::Slopes out = numbers_->slopes(point, p);
  if (loads_.empty()) return out;
  for (auto& of_variable : out) {
    for (auto& [row, slope] : of_variable) {
      if (std::find(loads_.begin(), loads_.end(), row) != loads_.end()) slope *= at;
    }
  }
  return out;
}

void SweepPositions::place(const StaticModel& model, const std::vector<double>& x, std::vector<int> active,
                           const std::vector<double>& p) {
  std::vector<double> z = poses_of(model, x);
  std::sort(active.begin(), active.end());
  NumberedEquations equations(numbers_->list(), acting_at(model.scaled_scene(), z, active));
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (i % 3 != 2) z[i] *= model.scales().length / scales_.length;
  }
  z.resize(static_cast<std::size_t>(equations.unknowns()), 0.0);
  equations.count_turns(z.data());
  const Eigen::Index bodies = equations.poses(), n = equations.unknowns();
  const ResidualDerivatives at = differentiate(equations, p, z, false);
  const Eigen::VectorXd efforts = solvers::minimum_norm_solution<double>(
      at.by_unknowns.block(0, bodies, bodies, n - bodies), -at.residual.head(bodies), solvers::known_to::solution);
  std::copy(efforts.begin(), efforts.end(), z.begin() + bodies);
  spots_.push_back({std::move(equations), std::move(z), {}});
}

bool SweepPositions::follow_rest(const DesignPoint& point, std::string& why) {
  const StaticModel model(scene_at(*problem_, point));
  SolveOptions options;
  options.interrupt = interrupt_;
  const Equilibrium found = solve(model, options);
  if (!found.found()) {
    why = "no equilibrium is found in which it comes to rest: " + found.why;
    return false;
  }
  place(model, found.x, found.certificate.active_stops, numbers_at(point, 0.0));
  return true;
}

std::string SweepPositions::where_it_ends(const Path& found, std::size_t missing) const {
  const auto shown = [&](double si) {
    return fmt::format("{:.6g}{}{}", si / sweep_->unit, sweep_->unit_name.empty() ? "" : " ", sweep_->unit_name);
  };
  const PathBranch& branch = found.branches.front();
  const bool has_points = !branch.points.empty();
  return fmt::format("along {} the path from {} does not reach {}{}{}", sweep_->along, shown(at_.front()),
                     shown(at_[missing]), has_points ? ": it ends at " + shown(branch.points.back().parameter) : "",
                     branch.why.empty() ? "" : ", " + branch.why);
}

/// Places the spots anew, only some of them where it fails.
bool SweepPositions::follow_path(const DesignPoint& point, std::string& why) {
  ++counts_.paths;
  spots_.clear();
  try {
    if (is_at_rest()) return follow_rest(point, why);
    const VariedScene varied = varied_in(scene_at(*problem_, point));
    PathOptions options;
    options.certify = false;
    options.spacing = options.longest_step;
    options.at = at_;
    options.interrupt = interrupt_;
    const Path found = path(varied, options);
    if (found.status == Path::Status::no_start) {
      why = found.why;
      return false;
    }
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const PathPoint* reached = nullptr;
      if (found.wanted.size() > k && !found.wanted[k].empty()) {
        reached = &found.wanted[k].front();
      } else if (!found.branches.empty() && !found.branches.front().points.empty()) {
        // A range that ends at a stop of the scene ends there but for rounding.
        const PathPoint& last = found.branches.front().points.back();
        if (std::abs(last.parameter - at_[k]) <= touching * sweep_->natural) reached = &last;
      }
      if (reached == nullptr) {
        why = where_it_ends(found, k);
        return false;
      }
      const PathPoint& there = *reached;
      const auto model = varied.model_at(at_[k]);
      std::vector<int> active = there.active_stops;
      std::erase_if(active, [&](int stop) { return is_on_drive(stop); });
      if (varied.is_driven()) active.push_back(static_cast<int>(varied.scene().stops.size()) - 1);
      if (k == 0) {
        const int driven = varied.is_driven() ? active.back() : -1;
        const auto values = quantity_values(resting_place(*model, there.x, active, driven), of_);
        for (std::size_t q = 0; q < of_.size(); ++q) {
          if (std::isfinite(values[q].value)) continue;
          why = of_[q].name + ": " + values[q].why;
          return false;
        }
      }
      place(*model, there.x, std::move(active), numbers_at(point, at_[k]));
    }
  } catch (const InputError& error) {
    why = error.what();
    return false;
  }
  return true;
}

bool SweepPositions::improve(Spot& spot, const std::vector<double>& p) const {
  const int bodies = spot.equations.poses();
  double before = std::numeric_limits<double>::infinity(), moved = 0.0;
  for (int step = 0; step < most_steps_of_newton; ++step) {
    const UnknownsFactors factors(spot.equations, p, spot.z);
    if (!factors.is_finite()) return false;
    const Eigen::VectorXd dz = factors.solve(-factors.residual());
    if (!dz.allFinite()) return false;
    double change = 0.0;
    for (std::size_t i = 0; i < spot.z.size(); ++i) {
      const double d = dz[static_cast<Eigen::Index>(i)];
      spot.z[i] += d;
      const double size = static_cast<int>(i) < bodies ? 1.0 : std::max(1.0, std::abs(spot.z[i]));
      change = std::max(change, std::abs(d) / size);
    }
    moved += change;
    if (moved > farthest_step && step > 0 && change > before) return false;
    if (change < converged_step) return true;
    if (change < weakest_end && change >= before) return true;
    before = change;
  }
  return before < weakest_end;
}

int SweepPositions::changed_stop(const Spot& spot, const std::vector<double>& p) const {
  std::vector<NumberedEquations::Placed<double>> placed;
  spot.equations.place(spot.z.data(), placed);
  const NumberedEquations::Bodies<double> bodies = spot.equations.bodies(p.data(), placed);
  const Scene& scene = spot.equations.scene();
  const std::vector<ActingStop>& acting = spot.equations.acting();
  const int count = static_cast<int>(scene.stops.size());
  const int driven = varied_ && varied_->is_driven() ? count - 1 : -1;
  for (int s = 0; s < count; ++s) {
    if (s == driven) continue;
    const bool is_held = is_on_drive(s);
    const Stop& stop = scene.stops[static_cast<std::size_t>(s)];
    const auto own = std::find_if(acting.begin(), acting.end(), [&](const ActingStop& one) { return one.stop == s; });
    if (own == acting.end() || is_held) {
      if (std::isfinite(stop.min) && bodies.overrun(s, false) < -touching) return s;
      if (std::isfinite(stop.max) && bodies.overrun(s, true) > touching) return s;
      continue;
    }
    if (stop.min == stop.max) continue;  // a coupling holds on both sides
    const double effort =
        spot.z[static_cast<std::size_t>(spot.equations.multiplier_of_stop(static_cast<int>(own - acting.begin())))];
    if ((own->upper ? -effort : effort) < -touching) return s;
  }
  return -1;
}

bool SweepPositions::is_on_drive(int stop) const {
  if (!varied_ || !varied_->is_driven()) return false;
  const std::vector<Stop>& stops = varied_->scene().stops;
  return is_same(stops[static_cast<std::size_t>(stop)].on, stops.back().on);
}

/// The drive alone decides the pose: it acts alone, and without it there is one motion.
bool SweepPositions::is_determined(const Spot& spot) const {
  if (!varied_ || !varied_->is_driven() || spot.equations.acting().size() != 1) return false;
  return QuantityPlace<double>(spot.equations, spot.equations.numbers().data(), spot.z.data(), 0).freedoms() == 1;
}

void SweepPositions::derive(Spot& spot, const std::vector<double>& p, const DesignNumbers::Slopes& slopes) const {
  const int n = spot.equations.unknowns();
  const UnknownsFactors factors(spot.equations, p, spot.z);
  spot.z_by.resize(n, static_cast<Eigen::Index>(slopes.size()));
  const std::vector<DesignDual> z(spot.z.begin(), spot.z.end());
  std::vector<DesignDual> r(static_cast<std::size_t>(n));
  std::vector<NumberedEquations::Placed<DesignDual>> placed;
  for_each_lane(p, slopes, [&](int first, int count, const DesignDual* dual) {
    spot.equations.residual(dual, z.data(), r.data(), placed);
    for (int l = 0; l < count; ++l) {
      Eigen::VectorXd b(n);
      for (int i = 0; i < n; ++i) b[i] = -r[static_cast<std::size_t>(i)].v[l];
      spot.z_by.col(first + l) = factors.solve(b);
    }
  });
}

void SweepPositions::read(const Spot& spot, const std::vector<double>& p, const DesignNumbers::Slopes& slopes,
                          bool with_derivatives, std::size_t k, SweepValues& out) const {
  const int driven = varied_ && varied_->is_driven() ? static_cast<int>(spot.equations.acting().size()) - 1 : -1;
  const auto row = static_cast<Eigen::Index>(k);
  const auto unit_of = [&](std::size_t q) { return 1.0 / of_[q].dimension.per_scale(scales_); };
  if (!with_derivatives || slopes.empty()) {
    QuantityPlace<double> place(spot.equations, p.data(), spot.z.data(), driven);
    for (std::size_t q = 0; q < of_.size(); ++q) {
      out.value(row, static_cast<Eigen::Index>(q)) = unit_of(q) * place.value(of_[q]);
    }
    return;
  }
  std::vector<DesignDual> z(spot.z.begin(), spot.z.end());
  for_each_lane(p, slopes, [&](int first, int count, const DesignDual* dual) {
    for (std::size_t i = 0; i < z.size(); ++i) {
      for (int l = 0; l < lanes_of_design; ++l) {
        z[i].v[l] = l < count ? spot.z_by(static_cast<Eigen::Index>(i), first + l) : 0.0;
      }
    }
    QuantityPlace<DesignDual> place(spot.equations, dual, z.data(), driven);
    for (std::size_t q = 0; q < of_.size(); ++q) {
      const DesignDual value = place.value(of_[q]);
      out.value(row, static_cast<Eigen::Index>(q)) = unit_of(q) * value.a;
      for (int l = 0; l < count; ++l) {
        out.by[k](static_cast<Eigen::Index>(q), first + l) = unit_of(q) * value.v[l];
      }
    }
  });
}

bool SweepPositions::find_positions(const DesignPoint& point, const std::vector<std::vector<double>>& numbers,
                                    bool anew, std::string& why) {
  blocking_ = -1;
  std::vector<Spot> before;
  if (anew) before = std::move(spots_);
  if (anew && !follow_path(point, why)) {
    spots_ = std::move(before);
    return false;
  }
  std::vector<std::vector<double>> kept;
  for (const Spot& spot : spots_) kept.push_back(spot.z);
  const bool is_near = !anew && last_rows_ == point.rows;
  for (std::size_t k = 0; k < spots_.size(); ++k) {
    Spot& spot = spots_[k];
    if (is_near && spot.z_by.size() > 0) {
      const Eigen::VectorXd change = spot.z_by * (point.parts - last_parts_);
      for (std::size_t i = 0; i < spot.z.size(); ++i) spot.z[i] += change[static_cast<Eigen::Index>(i)];
    }
    const bool is_found = improve(spot, numbers[k]);
    const int stop = is_found ? changed_stop(spot, numbers[k]) : -1;
    if (is_found && stop < 0) continue;
    why = fmt::format("along {} an equilibrium is not found to full accuracy", sweep_->along);
    if (is_found && is_determined(spot)) {
      const Stop& blocking = spot.equations.scene().stops[static_cast<std::size_t>(stop)];
      blocking_ = stop;
      why = fmt::format("{} \"{}\" blocks the path along {}", blocking.table, blocking.name, sweep_->along);
    }
    // The next choice of numbers begins where the last one that was found did.
    if (anew) {
      spots_ = std::move(before);
    } else {
      for (std::size_t j = 0; j < kept.size(); ++j) spots_[j].z = std::move(kept[j]);
    }
    return false;
  }
  return true;
}

bool SweepPositions::evaluate(const DesignPoint& point, bool with_derivatives, SweepValues& out, std::string& why) {
  ++counts_.evaluations;
  const auto quantities = static_cast<Eigen::Index>(of_.size());
  out.value.resize(static_cast<Eigen::Index>(at_.size()), quantities);
  out.by.assign(with_derivatives ? at_.size() : 0, Eigen::MatrixXd(quantities, point.parts.size()));
  std::vector<std::vector<double>> numbers;
  try {
    for (const double at : at_) numbers.push_back(numbers_at(point, at));
  } catch (const InputError& error) {
    why = error.what();
    return false;
  }
  // Positions far away may be others: the change of numbers is small enough where Newton's method stays near.
  bool has_all = !spots_.empty() && find_positions(point, numbers, false, why);
  if (has_all) ++counts_.followed;
  if (!has_all && blocking_ >= 0) return false;
  if (!has_all && !find_positions(point, numbers, true, why)) return false;
  last_parts_ = point.parts;
  last_rows_ = point.rows;
  for (std::size_t k = 0; k < spots_.size(); ++k) {
    const DesignNumbers::Slopes slopes =
        with_derivatives ? slopes_at(point, at_[k], numbers[k]) : DesignNumbers::Slopes{};
    if (with_derivatives) {
      derive(spots_[k], numbers[k], slopes);
    } else {
      spots_[k].z_by.resize(0, 0);
    }
    read(spots_[k], numbers[k], slopes, with_derivatives, k, out);
  }
  return true;
}

}  // namespace poise
