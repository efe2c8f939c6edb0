#include "design/balance/near_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "design/balance/pose_torques.hpp"
#include "design/balance/weight_balance.hpp"
#include "model/input_error.hpp"
#include "solvers/linear_program.hpp"

namespace poise {
namespace {

struct RangedForm {
  TorqueForm form;
  std::vector<double> from, to;
  std::vector<double> shift;  // coordinate = measure of the range - shift
};

[[noreturn]] void refuse_range(const BalanceProblem& problem, const std::string& why) {
  throw InputError(fmt::format("{}:{}: balance.over: {}", problem.file, problem.line, why));
}

void add_ranges(const BalanceProblem& problem, const PoseForm& form, RangedForm& out) {
  for (const BalancedRange& range : problem.over) {
    const Measure& on = range.of.on;
    AngleForm angle{on.kind == Measure::Kind::travel ? form.travel(on.joint) : -1, 0.0};
    if (on.kind == Measure::Kind::angle) angle = form.angle(on.body_b);
    if (angle.coordinate < 0) refuse_range(problem, range.of.name + " does not move by itself; leave it out");
    for (const int known : out.form.coordinates) {
      if (known == angle.coordinate)
        refuse_range(problem, range.of.name + " moves with another of these; leave one out");
    }
    out.form.coordinates.push_back(angle.coordinate);
    out.form.is_length.push_back(form.is_length(angle.coordinate) ? 1 : 0);
    out.from.push_back(range.min - angle.constant);
    out.to.push_back(range.max - angle.constant);
    out.shift.push_back(angle.constant);
  }
}

bool depends_on(const PhasorTerms& terms, int coordinate, double size) {
  for (const auto& [phasor, coefficient] : terms) {
    if ((phasor.length == coordinate || phasor.angle == coordinate) && norm(coefficient) > 1e-12 * size) return true;
  }
  return false;
}

TorqueForm::Spring spring_of(const PoseForm& form, const Element& element, const TorqueForm& in) {
  TorqueForm::Spring out;
  if (const auto* linear = std::get_if<LinearSpring>(&element.law)) {
    if (linear->acts != SpringActs::both && !has_no_free_length(element)) {
      throw InputError(fmt::format("{}:{}: {} \"{}\": expected a spring that acts on both sides; leave out acts",
                                   form.scene().file, element.line, element.family(), element.name));
    }
    out.stiffness = linear->stiffness;
    out.length = linear->free_length;
  } else if (const auto* preloaded = std::get_if<PreloadedSpring>(&element.law)) {
    out.stiffness = preloaded->stiffness;
    out.length = preloaded->length;
    out.force = preloaded->preload;
  } else {
    throw InputError(fmt::format("{}:{}: {} \"{}\": balancing knows linear springs; leave it out", form.scene().file,
                                 element.line, element.family(), element.name));
  }
  if (element.on.kind == Measure::Kind::distance) {
    out.d = sum(form.place(element.on.b), form.place(element.on.a), -1.0);
    return out;
  }
  if (element.on.kind != Measure::Kind::angle) {
    throw InputError(fmt::format("{}:{}: {} \"{}\": balancing knows springs between points or on angles; leave it out",
                                 form.scene().file, element.line, element.family(), element.name));
  }
  out.is_angle = true;
  out.factors.assign(in.coordinates.size(), 0.0);
  for (const auto& [body, sign] : {std::pair{element.on.body_b, 1.0}, {element.on.body_a, -1.0}}) {
    const AngleForm angle = form.angle(body);
    out.constant += sign * angle.constant;
    for (std::size_t k = 0; k < in.coordinates.size(); ++k) {
      if (in.coordinates[k] == angle.coordinate) out.factors[k] += sign;
    }
  }
  return out;
}

RangedForm ranged_form(const BalanceProblem& problem, const PoseForm& form) {
  const Scene& scene = form.scene();
  if (!form.closures().empty()) {
    refuse_range(problem, "loops other than parallelograms tie the angles, which this does not know; leave it out");
  }
  if (!problem.coordinates.empty()) {
    refuse_range(problem, "points are chosen for springs of free length zero only; leave out points");
  }
  RangedForm out;
  add_ranges(problem, form, out);
  std::vector<PhasorTerms> vectors;
  for (PlacedLoad& load : placed_loads(form)) {
    vectors.push_back(load.place);
    out.form.loads.push_back({std::move(load.place), load.force});
  }
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    int sought = -1;
    for (std::size_t k = 0; k < problem.stiffnesses.size(); ++k) {
      if (problem.stiffnesses[k].place.item == static_cast<int>(i)) sought = static_cast<int>(k);
    }
    if (sought < 0 && (!stores_energy(element.law) || !idle(element.law).empty())) continue;
    out.form.springs.push_back(spring_of(form, element, out.form));
    out.form.springs.back().sought = sought;
    vectors.push_back(out.form.springs.back().d);
    if (!out.form.springs.back().is_angle) continue;
    // A turn by itself of the angles that such a spring is on needs ranges for them.
    for (const int body : {element.on.body_a, element.on.body_b}) {
      const AngleForm angle = form.angle(body);
      if (angle.coordinate >= 0) vectors.push_back({{Phasor{-1, angle.coordinate}, Vec2{form.size(), 0.0}}});
    }
  }
  for (const int t : form.coordinates()) {
    const bool has_range =
        std::find(out.form.coordinates.begin(), out.form.coordinates.end(), t) != out.form.coordinates.end();
    const bool matters = std::any_of(vectors.begin(), vectors.end(),
                                     [&](const PhasorTerms& v) { return depends_on(v, t, form.size()); });
    if (matters && !has_range) refuse_range(problem, "expected a range of \"" + form.name(t) + "\" too; add it");
  }
  for (const char is_length : out.form.is_length) {
    if (is_length != out.form.is_length.front()) {
      refuse_range(problem, "torques and forces do not compare: expected ranges of angles only, or of travels only");
    }
  }
  out.form.constant.assign(out.form.coordinates.size(), 0.0);
  return out;
}

PlacedCoordinates<double> placed_at(const TorqueForm& form, const std::vector<double>& q) {
  PlacedCoordinates<double> out{q, {}};
  for (std::size_t k = 0; k < q.size(); ++k) out.unit.push_back(form.is_length[k] != 0 ? Vec2{} : unit(q[k]));
  return out;
}

// The program over the poses so far, with all its torques: stiffnesses in parts of their greatest, and t.
struct PoseProgram {
  const TorqueForm& form;
  std::vector<double> least, greatest;
  std::vector<WeighedTorque> rows;  // each with the weights 1 and -1
  std::vector<Eigen::VectorXd> slopes;
  std::vector<double> constants;

  void add(const std::vector<double>& q) {
    const PlacedCoordinates<double> at = placed_at(form, q);
    std::vector<double> k(least.size(), 0.0);
    const Torques<double> none = torques_at(form, k, at);
    std::vector<Eigen::VectorXd> by(q.size(), Eigen::VectorXd::Zero(static_cast<Eigen::Index>(k.size())));
    for (std::size_t i = 0; i < k.size(); ++i) {
      k[i] = greatest[i];
      const Torques<double> one = torques_at(form, k, at);
      for (std::size_t j = 0; j < q.size(); ++j) by[j][static_cast<Eigen::Index>(i)] = one.value[j] - none.value[j];
      k[i] = 0.0;
    }
    for (std::size_t j = 0; j < q.size(); ++j) {
      rows.push_back({q, j, 0.0});
      slopes.push_back(by[j]);
      constants.push_back(none.value[j]);
    }
  }

  // False where the program is not solved.
  bool solve(std::vector<double>& k, std::vector<WeighedTorque>& weighed) const {
    const auto n = static_cast<Eigen::Index>(least.size());
    const auto m = static_cast<Eigen::Index>(rows.size());
    double size = 0.0;
    for (const double c : constants) size = std::max(size, std::abs(c));
    if (size == 0.0) size = 1.0;
    solvers::LinearProgram program;
    program.rows = Eigen::MatrixXd::Zero(2 * m + 2 * n, n + 1);
    program.bounds = Eigen::VectorXd::Zero(2 * m + 2 * n);
    program.objective = Eigen::VectorXd::Zero(n + 1);
    program.objective[n] = -1.0;
    for (Eigen::Index r = 0; r < m; ++r) {
      const auto at = static_cast<std::size_t>(r);
      for (const int side : {0, 1}) {
        const double sign = side == 0 ? 1.0 : -1.0;
        program.rows.row(2 * r + side).head(n) = sign * slopes[at].transpose() / size;
        program.rows(2 * r + side, n) = -1.0;
        program.bounds[2 * r + side] = -sign * constants[at] / size;
      }
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      program.rows(2 * m + 2 * i, i) = 1.0;
      program.bounds[2 * m + 2 * i] = 1.0;
      program.rows(2 * m + 2 * i + 1, i) = -1.0;
      program.bounds[2 * m + 2 * i + 1] = greatest[at] > 0.0 ? -least[at] / greatest[at] : 0.0;
    }
    const solvers::LinearProgramResult best = solvers::solve(program);
    if (best.status != solvers::LinearProgramResult::Status::optimal) return false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      k[at] = std::clamp(best.x[i] * greatest[at], least[at], greatest[at]);
    }
    weighed.clear();
    for (Eigen::Index r = 0; r < m; ++r) {
      WeighedTorque one = rows[static_cast<std::size_t>(r)];
      one.weight = std::max(best.multipliers[2 * r], 0.0) - std::max(best.multipliers[2 * r + 1], 0.0);
      if (one.weight != 0.0) weighed.push_back(std::move(one));
    }
    return true;
  }
};

// Poses spread over the range.
void add_grid(const RangedForm& ranged, PoseProgram& program) {
  const std::size_t n = ranged.from.size();
  const int each = n == 1 ? 9 : n == 2 ? 5 : 3;
  std::vector<int> index(n, 0);
  while (true) {
    std::vector<double> q;
    for (std::size_t k = 0; k < n; ++k) {
      q.push_back(ranged.from[k] + (ranged.to[k] - ranged.from[k]) * index[k] / (each - 1));
    }
    program.add(q);
    std::size_t k = 0;
    while (k < n && ++index[k] == each) index[k++] = 0;
    if (k == n) return;
  }
}

}  // namespace

NearBalance balance_nearly(const BalanceProblem& problem, const std::atomic<bool>* interrupt) {
  constexpr int most_exchanges = 80, most_boxes = 200'000, most_in_all = 2'000'000;
  constexpr double gap = 1e-8, enough = 1e-7;
  NearBalance out;
  out.scene = problem.scene;
  const PoseForm form(problem.scene);
  const RangedForm ranged = ranged_form(problem, form);
  out.is_force = ranged.form.is_length.front() != 0;
  PoseProgram program{ranged.form, {}, {}, {}, {}, {}};
  for (const FreeNumber& number : problem.stiffnesses) {
    program.least.push_back(number.min);
    program.greatest.push_back(number.max);
  }
  add_grid(ranged, program);
  TorqueForm weights = ranged.form;
  weights.springs.clear();
  out.without = largest_torque(weights, {}, ranged.from, ranged.to, enough, 0.0, most_boxes).upper;
  const double rounding = 1e-13 * out.without;
  out.upper = std::numeric_limits<double>::infinity();
  std::vector<double> k = program.least;
  std::vector<WeighedTorque> weighed;
  for (; out.exchanges < most_exchanges; ++out.exchanges) {
    if (interrupt != nullptr && *interrupt) break;
    if (!program.solve(k, weighed)) break;
    out.lower = std::max(out.lower, least_largest_torque(ranged.form, weighed, program.least, program.greatest));
    // Bounds of what is far from the end need not be close.
    const double apart = std::isfinite(out.upper) ? (out.upper - out.lower) / out.upper : 1.0;
    const LargestTorque worst =
        largest_torque(ranged.form, k, ranged.from, ranged.to, std::clamp(0.1 * apart, gap, 0.1), rounding, most_boxes);
    out.boxes += worst.boxes;
    if (worst.upper < out.upper) {
      out.upper = worst.upper;
      out.found = k;
      out.reached = worst.reached;
      out.at = worst.at;
      out.solved = true;
    }
    if (out.upper - out.lower <= std::max(enough * out.upper, rounding)) break;
    if (out.boxes > most_in_all) break;
    program.add(worst.at);
  }
  out.poses = static_cast<int>(program.rows.size() / std::max<std::size_t>(1, ranged.form.coordinates.size()));
  for (std::size_t c = 0; c < out.at.size(); ++c) out.at[c] += ranged.shift[c];
  if (!out.solved) return out;
  for (std::size_t i = 0; i < problem.stiffnesses.size(); ++i) {
    set_value_at(out.scene, problem.stiffnesses[i].place, out.found[i]);
  }
  return out;
}

}  // namespace poise
