#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "motion/contacts.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/simulate.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// Changes of the independent coordinates, of least norm, for which the wanted ones change by `change`.
Eigen::VectorXd least_change(const Reduced& reduced, const std::vector<StartValue>& wanted,
                             const Eigen::VectorXd& change) {
  Eigen::MatrixXd B(change.size(), reduced.freedoms());
  for (Eigen::Index row = 0; row < change.size(); ++row) {
    for (int k = 0; k < reduced.freedoms(); ++k)
      B(row, k) = reduced.B(k)[wanted[static_cast<std::size_t>(row)].coordinate];
  }
  return solvers::minimum_norm_solution(B, change);
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
  // Newton's method on the wanted coordinates, in steps short enough for the loops to close.
  constexpr double longest_step = 0.1;
  int most = 200;
  for (int iteration = 0;; ++iteration) {
    Eigen::VectorXd miss(static_cast<Eigen::Index>(places.size()));
    for (std::size_t i = 0; i < places.size(); ++i) {
      miss[static_cast<Eigen::Index>(i)] = places[i].value - reduced.q()[places[i].coordinate];
    }
    if (places.empty() || miss.lpNorm<Eigen::Infinity>() < 1e-14) break;
    const bool settled = miss.lpNorm<Eigen::Infinity>() < 1e-12 && iteration > 20;
    if (settled) break;
    const double largest = miss.lpNorm<Eigen::Infinity>();
    if (iteration == 0) most += static_cast<int>(std::min(largest / longest_step, 1e5));
    if (f == 0 || iteration == most) fail(model, f, places, "places");
    Eigen::VectorXd dz =
        least_change(reduced, places, largest > longest_step ? Eigen::VectorXd(miss * (longest_step / largest)) : miss);
    if (!dz.allFinite() || dz.lpNorm<Eigen::Infinity>() > 1.0) fail(model, f, places, "places");
    for (int k = 0; k < f; ++k) z[static_cast<std::size_t>(k)] += dz[k];
    if (reduced.place(0.0, z.data()) != Reduced::Status::ok) fail(model, f, places, "places");
  }
  MotionState state;
  x.assign(reduced.q(), reduced.q() + x.size());
  Eigen::VectorXd w = Eigen::VectorXd::Zero(f);
  if (!rates.empty()) {
    reduced.move(w.data());
    Eigen::VectorXd miss(static_cast<Eigen::Index>(rates.size()));
    for (std::size_t i = 0; i < rates.size(); ++i) {
      miss[static_cast<Eigen::Index>(i)] = rates[i].value - reduced.v()[rates[i].coordinate];
    }
    w = least_change(reduced, rates, miss);
  }
  reduced.move(w.data());
  for (const StartValue& s : rates) {
    if (std::abs(reduced.v()[s.coordinate] - s.value) > 1e-9 * (1 + std::abs(s.value))) fail(model, f, rates, "rates");
  }
  state.q = model.to_si(x);
  state.v = model.to_si({reduced.v(), reduced.v() + x.size()});
  return state;
}

}  // namespace poise
