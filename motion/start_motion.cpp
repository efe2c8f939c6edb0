#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "motion/blades.hpp"
#include "motion/contacts.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/simulate.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// How the flexible links of a scene bend: the measures of their springs, each times the root of its stiffness, so that
/// the sum of squares is twice the energy of bending.
class Bending {
 public:
  explicit Bending(const MotionModel& model)
      : mechanism_(model.mechanism()), pose_(static_cast<std::size_t>(mechanism_.pose_size())) {
    for (const FlexibleLink& link : model.scaled_scene().flexible_links) {
      for (const int spring : link.springs) {
        const auto& law = model.scaled_scene().elements[static_cast<std::size_t>(spring)].law;
        springs_.push_back({spring, std::sqrt(std::get<LinearSpring>(law).stiffness)});
      }
    }
  }

  bool acts() const { return !springs_.empty(); }
  Eigen::VectorXd at(const double* q) {
    mechanism_.place(q, pose_.data());
    return of_each([&](int spring) { return mechanism_.measure_of(spring, pose_.data()); });
  }
  /// How it changes along rates at the pose of the last at().
  Eigen::VectorXd along(const double* v) {
    return of_each([&](int spring) { return mechanism_.rate_of(spring, pose_.data(), v); });
  }
  /// Its derivatives by the independent coordinates, there.
  Eigen::MatrixXd by_independent(const Reduced& reduced) {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(springs_.size()), reduced.freedoms());
    for (int k = 0; k < reduced.freedoms(); ++k) out.col(k) = along(reduced.B(k));
    return out;
  }

 private:
  struct Spring {
    int element;
    double root;
  };
  template <class Of>
  Eigen::VectorXd of_each(const Of& of) const {
    Eigen::VectorXd out(static_cast<Eigen::Index>(springs_.size()));
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      out[static_cast<Eigen::Index>(s)] = springs_[s].root * of(springs_[s].element);
    }
    return out;
  }

  const Mechanism<double>& mechanism_;
  std::vector<Planar<double>> pose_;
  std::vector<Spring> springs_;
};

/// How the wanted coordinates change with the independent ones.
Eigen::MatrixXd rows_of(const Reduced& reduced, const std::vector<StartValue>& wanted) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(wanted.size()), reduced.freedoms());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (int k = 0; k < reduced.freedoms(); ++k)
      out(static_cast<Eigen::Index>(i), k) = reduced.B(k)[wanted[i].coordinate];
  }
  return out;
}

/// Changes of the independent coordinates by which these rows of them change by `change`: of least norm, or, where
/// links bend, those that bring this bending nearest to zero, and of these the ones of least norm.
Eigen::VectorXd least_change(const Reduced& reduced, const Eigen::MatrixXd& rows, const Eigen::VectorXd& change,
                             Bending* links, const Eigen::VectorXd& bending) {
  if (links == nullptr) return solvers::minimum_norm_solution<double>(rows, change);
  const Eigen::MatrixXd by = links->by_independent(reduced);
  if (change.size() == 0) return solvers::minimum_norm_solution<double>(by, -bending, solvers::known_to::closed_point);
  const solvers::LeastSquares<double> reached(rows);
  Eigen::VectorXd first = reached.solve(change);
  const Eigen::MatrixXd open = reached.null_space();
  if (open.cols() == 0) return first;
  return first + open * solvers::minimum_norm_solution<double>(by * open, -(bending + by * first),
                                                               solvers::known_to::closed_point);
}

[[noreturn]] void fail(const MotionModel& model, int freedoms, const std::vector<StartValue>& wanted,
                       const std::string& what) {
  std::string names;
  for (const StartValue& s : wanted) {
    names += (names.empty() ? "" : ", ") + model.layout().coordinates[static_cast<std::size_t>(s.coordinate)].name;
  }
  if (freedoms == 0) {
    throw InputError(fmt::format(
        "{}the start of the motion: no degree of freedom is left to release; leave out the release of {}, or a drive",
        where(model), names));
  }
  throw InputError(
      fmt::format("{}the start of the motion: expected {} of {} that the mechanism can have at once; ask for "
                  "less, or for fewer coordinates",
                  where(model), what, names));
}

[[noreturn]] void fail_to_drive(const MotionModel& model) {
  throw InputError(
      fmt::format("{}cannot reach the start values of its drives and couplings; expected a [start] near them, or "
                  "leave the drives' start out",
                  where(model)));
}

/// Throws InputError where the start that the scene gives closes all loops, but is inside a stop by more than a guess
/// may be: it is not moved out of it without a word.
void refuse_start_inside_stops(const MotionModel& model) {
  constexpr double closed = 1e-9, much = 1e-3;  // sizes of the mechanism, rad
  const std::vector<double> written = model.start();
  if (largest_gap(model, written) <= closed) Contacts(model, {}).refuse_start(written.data(), much);
}

/// The pose in which the scene is assembled, whichever joints the friction in them cuts.
std::vector<double> assembled_pose(const MotionModel& model) {
  if (!has_cuts(model.layout())) {
    refuse_start_inside_stops(model);
    return close_loops(model);
  }
  Scene whole = model.scene();
  for (Joint& joint : whole.joints) joint.friction.reset();
  const ScaledModel uncut(std::move(whole), Purpose::dynamics);
  return coordinates_in(model, uncut, close_loops(uncut));
}

/// Rates of the independent coordinates with the wanted ones among all rates, and none across blades: the least, or,
/// where links bend, those of the least bending. Where the mechanism can have the wanted ones, but not with its blades,
/// throws InputError.
Eigen::VectorXd start_rates(const MotionModel& model, Reduced& reduced, const std::vector<StartValue>& rates,
                            Bending* links) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(reduced.freedoms());
  if (rates.empty() && links == nullptr && reduced.blades() == 0) return w;
  reduced.move(w.data());
  const auto wanted = static_cast<Eigen::Index>(rates.size());
  Eigen::VectorXd miss(wanted + reduced.blades());
  Eigen::MatrixXd rows(miss.size(), reduced.freedoms());
  for (Eigen::Index i = 0; i < wanted; ++i) {
    const StartValue& rate = rates[static_cast<std::size_t>(i)];
    miss[i] = rate.value - reduced.v()[rate.coordinate];
  }
  rows.topRows(wanted) = rows_of(reduced, rates);
  for (int b = 0; b < reduced.blades(); ++b) miss[wanted + b] = -reduced.blade_rate(b);
  rows.bottomRows(reduced.blades()) = blade_conditions(reduced);
  Eigen::VectorXd bending;
  if (links != nullptr) {
    links->at(reduced.q());
    bending = links->along(reduced.v());
  }
  constexpr double close = 1e-9;
  const auto reached = [&](Eigen::Index first) {
    if (first == 0 && links == nullptr) return true;
    w = least_change(reduced, rows.topRows(first), miss.head(first), links, bending);
    return w.size() == 0 || first == 0 ||
           (rows.topRows(first) * w - miss.head(first)).lpNorm<Eigen::Infinity>() <=
               close * (1 + miss.head(first).lpNorm<Eigen::Infinity>());
  };
  // Rates that the mechanism cannot have without blades are refused as such.
  if (!reached(wanted)) return w;
  for (int b = 0; b < reduced.blades(); ++b) {
    if (reached(wanted + b + 1)) continue;
    const Blade& blade = model.scene().blades[static_cast<std::size_t>(b)];
    throw InputError(fmt::format(
        "{}:{}: blade \"{}\": the rates of the start would take {} across its edge; expected rates along it, ask for "
        "fewer or for others",
        model.scene().file, blade.line, blade.name, model.scene().name_of(blade.at)));
  }
  return w;
}

/// Moves a closed pose, by its drives alone, to the values that they start with: in steps, so that the mechanism stays
/// in the branch of assembly of the pose given.
void reach_starts_of_drives(const MotionModel& model, Reduced& reduced, std::vector<double>& x) {
  constexpr double longest = 0.1;  // rad, lengths of the scaled scene
  reduced.start_drives(x.data());
  const double farthest = reduced.farthest_drive(0.0);
  if (!(farthest > longest)) return;
  const std::vector<double> begin = x;
  const int steps = static_cast<int>(std::min(std::ceil(farthest / longest), 1e5));
  for (int step = 1; step <= steps; ++step) {
    reduced.start_drives(begin.data(), static_cast<double>(step) / steps);
    reduced.choose(0.0, x.data(), false);
    std::vector<double> z;
    for (const int i : reduced.independent()) z.push_back(x[static_cast<std::size_t>(i)]);
    reduced.expect(x.data());
    if (reduced.place(0.0, z.data()) != Reduced::Status::ok) fail_to_drive(model);
    x.assign(reduced.q(), reduced.q() + x.size());
  }
}

}  // namespace

MotionState start_motion(const MotionModel& model, const std::vector<StartValue>& wanted, const std::vector<double>* q,
                         const std::vector<int>* chosen) {
  std::vector<double> x = q != nullptr ? model.from_si(*q) : assembled_pose(model);
  Reduced reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  reach_starts_of_drives(model, reduced, x);
  reduced.choose(0.0, x.data(), false, chosen);
  const auto unit = [&](int i) { return i < model.layout().angles ? 1.0 : model.scales().length; };
  std::vector<StartValue> places, rates;
  for (StartValue s : wanted) {
    s.value /= unit(s.coordinate);
    (s.rate ? rates : places).push_back(s);
  }
  const int f = reduced.freedoms();
  const auto independent = [&](const double* full) {
    std::vector<double> z(static_cast<std::size_t>(f));
    for (int k = 0; k < f; ++k) z[static_cast<std::size_t>(k)] = full[reduced.independent()[k]];
    return z;
  };
  std::vector<double> z = independent(x.data());
  reduced.expect(x.data());
  if (reduced.place(0.0, z.data()) != Reduced::Status::ok) fail_to_drive(model);
  // Links that bend begin as in the pose given, or straight, as far as all else lets them.
  Bending links(model);
  const bool bend = links.acts() && chosen == nullptr && f > 0;
  Eigen::VectorXd begin;
  if (bend && q != nullptr) begin = links.at(model.from_si(*q).data());
  const auto bending = [&] {
    if (!bend) return Eigen::VectorXd();
    Eigen::VectorXd out = links.at(reduced.q());
    if (begin.size() > 0) out -= begin;
    return out;
  };
  // Newton's method on the wanted coordinates, in steps short enough for the loops to close.
  constexpr double longest_step = 0.1, longest_turn = 0.3;
  int most = 200;
  for (int iteration = 0;; ++iteration) {
    Eigen::VectorXd miss(static_cast<Eigen::Index>(places.size()));
    for (std::size_t i = 0; i < places.size(); ++i) {
      miss[static_cast<Eigen::Index>(i)] = places[i].value - reduced.q()[places[i].coordinate];
    }
    const double largest = places.empty() ? 0.0 : miss.lpNorm<Eigen::Infinity>();
    const bool reached = largest < 1e-14 || (largest < 1e-12 && iteration > 20);
    if (reached && (!bend || iteration == most)) break;
    if (iteration == 0) most += static_cast<int>(std::min(largest / longest_step, 1e5));
    if (f == 0 || iteration == most) fail(model, f, places, "places");
    Eigen::VectorXd dz = least_change(reduced, rows_of(reduced, places),
                                      largest > longest_step ? Eigen::VectorXd(miss * (longest_step / largest)) : miss,
                                      bend ? &links : nullptr, bending());
    if (reached && dz.lpNorm<Eigen::Infinity>() < 1e-11) break;
    if (!dz.allFinite() || (!bend && dz.lpNorm<Eigen::Infinity>() > 1.0)) fail(model, f, places, "places");
    if (bend) dz *= std::min(1.0, longest_turn / dz.lpNorm<Eigen::Infinity>());
    for (int k = 0; k < f; ++k) z[static_cast<std::size_t>(k)] += dz[k];
    if (reduced.place(0.0, z.data()) != Reduced::Status::ok) fail(model, f, places, "places");
  }
  MotionState state;
  x.assign(reduced.q(), reduced.q() + x.size());
  refuse_idle_blades(model, reduced);
  const Eigen::VectorXd w = start_rates(model, reduced, rates, bend ? &links : nullptr);
  reduced.move(w.data());
  for (const StartValue& s : rates) {
    if (std::abs(reduced.v()[s.coordinate] - s.value) > 1e-9 * (1 + std::abs(s.value))) fail(model, f, rates, "rates");
  }
  state.q = model.to_si(x);
  state.v = model.to_si({reduced.v(), reduced.v() + x.size()});
  return state;
}

}  // namespace poise
