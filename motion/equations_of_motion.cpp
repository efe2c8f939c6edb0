#include "motion/equations_of_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/joint_friction.hpp"
#include "motion/private/motion_terms.hpp"
#include "motion/simulation_words.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

using Reached = ReducedMotion<double>::Status;

/// What makes forces depend on more than z, w and t.
void refuse_what_sticks(const Scene& scene) {
  const auto refuse = [&](int line, const std::string& item, const std::string& why) {
    throw InputError(fmt::format("{}{}: {}: {}", scene.file, line > 0 ? fmt::format(":{}", line) : "", item, why));
  };
  refuse_rubbing_ropes(scene, "the equation of motion");
  refuse_blades(scene, "equations of motion in independent coordinates");
  refuse_controllers(scene, "equations of motion");
  for (const Joint& joint : scene.joints) {
    if (!joint.friction) continue;
    refuse(
        joint.line, fmt::format("{} \"{}\".friction", joint.traits().key, joint.name),
        "the equation of motion is no function of positions and rates where joints stick; expected no friction there, "
        "or a table [[friction]] with a width");
  }
  for (const Element& element : scene.elements) {
    if (!sticks(element.law)) continue;
    refuse(
        element.line, fmt::format("{} \"{}\".width", element.family(), element.name),
        "the equation of motion is no function of positions and rates where friction sticks; expected a width above 0");
  }
}

double unit_of(const MotionModel& model, int coordinate) {
  return model.layout().is_length(coordinate) ? model.scales().length : 1.0;
}

/// A mechanism in motion, in the units of the model; drives begin as assembled at `begin`, SI.
struct Moving {
  Moving(const MotionModel& model, const std::vector<double>& begin)
      : reduced(model.scaled_scene(), model.mechanism(), model.inertia()) {
    reduced.set_inputs(model.scaled_scene(), scaled(inputs_of(model.scene()), model.scene(), model.scales()));
    reduced.start_drives(model.from_si(begin).data());
  }

  /// Places at x, scaled, where coordinates are chosen.
  Reached place(double t, const std::vector<double>& x, const std::vector<int>* fixed) {
    reduced.choose(t, x.data(), false, fixed);
    reduced.expect(x.data());
    return reduced.place(t, independent_of(x).data());
  }
  std::vector<double> independent_of(const std::vector<double>& x) const {
    std::vector<double> z;
    for (const int i : reduced.independent()) z.push_back(x[static_cast<std::size_t>(i)]);
    return z;
  }
  std::vector<double> x() const { return {reduced.q(), reduced.q() + reduced.coordinates()}; }

  ReducedMotion<double> reduced;
};

std::vector<double> begin_of(const MotionModel& model, const MotionOrigin& origin) {
  return start_motion(model, {}, origin.q ? &*origin.q : nullptr).q;
}

[[noreturn]] void fail_to_reach(const MotionModel& model, double t) {
  throw InputError(
      fmt::format("{}cannot be assembled at t = {} s: its drives lead to where it opens; expected an earlier "
                  "time",
                  where(model), t));
}

/// Lets the drives go on from t = 0 to t while the independent coordinates stay: in steps that are halved where the
/// loops would open.
void let_drives_go(const MotionModel& model, Moving& moving, double t, std::vector<double>& x,
                   const std::vector<int>& kept) {
  constexpr double longest = 0.1;  // rad, lengths of the scaled scene
  constexpr double least = 1e-6;   // of the whole time
  double at = 0.0, step = t;
  while (at < t) {
    if (step < least * t) fail_to_reach(model, t);
    const double next = std::min(at + step, t);
    Reached status = moving.place(at, x, &kept);
    const std::vector<double> before = moving.x();
    if (status == Reached::ok) status = moving.reduced.place(next, moving.independent_of(before).data());
    double moved = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) moved = std::max(moved, std::abs(moving.reduced.q()[i] - before[i]));
    if (status != Reached::ok || moved > 10 * longest) {
      step /= 2;
      continue;
    }
    x = moving.x();
    at = next;
    if (moved < longest) step *= 2;
  }
}

}  // namespace

EquationState equation_state(const MotionModel& model, const MotionOrigin& origin,
                             const std::vector<AskedValue>& places, const std::vector<AskedValue>& rates, double t) {
  const std::vector<double> begin = begin_of(model, origin);
  std::vector<StartValue> wanted;
  std::vector<int> kept;
  for (const AskedValue& asked : places) {
    wanted.push_back({asked.channel.coordinate, false, asked.value});
    if (std::find(kept.begin(), kept.end(), asked.channel.coordinate) == kept.end())
      kept.push_back(asked.channel.coordinate);
  }
  std::vector<double> x = model.from_si(start_motion(model, wanted, &begin).q);
  Moving moving(model, begin);
  if (t > 0.0 && !model.scene().drives.empty()) let_drives_go(model, moving, t, x, kept);
  if (moving.place(t, x, nullptr) != Reached::ok) fail_to_reach(model, t);
  ReducedMotion<double>& reduced = moving.reduced;
  const int f = reduced.freedoms();
  std::vector<double> w(static_cast<std::size_t>(f), 0.0);
  reduced.move(w.data());
  if (!rates.empty()) {
    Eigen::VectorXd miss(static_cast<Eigen::Index>(rates.size()));
    Eigen::MatrixXd B(miss.size(), f);
    for (Eigen::Index row = 0; row < miss.size(); ++row) {
      const AskedValue& asked = rates[static_cast<std::size_t>(row)];
      const int i = asked.channel.coordinate;
      miss[row] = asked.value / unit_of(model, i) - reduced.v()[i];
      for (int k = 0; k < f; ++k) B(row, k) = reduced.B(k)[i];
    }
    const Eigen::VectorXd least = f == 0 ? Eigen::VectorXd() : solvers::minimum_norm_solution(B, miss);
    for (int k = 0; k < f; ++k) w[static_cast<std::size_t>(k)] = least[k];
    reduced.move(w.data());
    for (const AskedValue& asked : rates) {
      const int i = asked.channel.coordinate;
      const double wanted_rate = asked.value / unit_of(model, i);
      if (std::abs(reduced.v()[i] - wanted_rate) <= 1e-9 * (1 + std::abs(wanted_rate))) continue;
      throw InputError(fmt::format(
          "{}--rate {}: expected rates that the mechanism can have at once; ask for less, or for fewer coordinates",
          where(model), asked.channel.name));
    }
  }
  return {t, model.to_si(moving.x()), model.to_si({reduced.v(), reduced.v() + x.size()})};
}

EquationsOfMotion equations_of_motion(const MotionModel& model, const MotionOrigin& origin, const EquationState& state,
                                      const std::vector<std::string>& wanted) {
  refuse_what_sticks(model.scene());
  EquationsOfMotion out{model.scene(), model.layout(), begin_of(model, origin), {}, {}, model.scales(), {}, {}};
  // The layout of the scaled scene, in SI.
  out.layout.scale_lengths(model.scales().length);
  for (int i = 0; i < out.coordinates(); ++i) {
    out.coordinate_names.push_back(out.layout.coordinates[static_cast<std::size_t>(i)].name);
  }
  std::vector<int> fixed;
  for (const std::string& name : wanted) {
    const int i = channel_named("--coordinates " + name, name, channels_of(model)).coordinate;
    if (std::find(fixed.begin(), fixed.end(), i) == fixed.end()) fixed.push_back(i);
  }
  Moving moving(model, out.begin);
  const std::vector<double> x = model.from_si(state.q);
  moving.reduced.choose(state.t, x.data(), false);
  const int freedoms = moving.reduced.freedoms();
  if (freedoms == 0) {
    throw InputError(fmt::format(
        "{}nothing is free to move, so that there is no equation of motion; expected a degree of freedom: leave out a "
        "drive, a weld or a coupling",
        where(model)));
  }
  if (!fixed.empty()) {
    Moving chosen(model, out.begin);
    chosen.reduced.choose(state.t, x.data(), false, &fixed);
    if (chosen.reduced.freedoms() != freedoms) {
      throw InputError(
          fmt::format("--coordinates {}: expected coordinates that move independently of each other, {} at "
                      "most; leave some out",
                      fmt::join(wanted, ","), freedoms));
    }
    out.independent = chosen.reduced.independent();
    out.rows = chosen.reduced.used_rows();
  } else {
    out.independent = moving.reduced.independent();
    out.rows = moving.reduced.used_rows();
  }
  const int rows = model.mechanism().equalities() + moving.reduced.drives();
  for (int row = 0; row < rows; ++row) {
    const bool is_loop = row < model.mechanism().equalities();
    out.row_names.push_back(name_of_row(model, row) + (is_loop ? row % 2 == 0 ? ", x" : ", y" : ""));
  }
  return out;
}

EquationNumbers numbers_at(const EquationsOfMotion& equations, const EquationState& state) {
  const MotionModel model(equations.scene);
  Moving moving(model, equations.begin);
  ReducedMotion<double>& reduced = moving.reduced;
  EquationNumbers out;
  out.status = moving.place(state.t, model.from_si(state.q), &equations.independent);
  // Rows that repeat others are known as such where the loops are closed.
  if (out.status == Reached::ok) out.status = moving.place(state.t, moving.x(), &equations.independent);
  if (out.status != Reached::ok) return out;
  const int n = equations.coordinates(), f = equations.freedoms();
  const auto unit = [&](int i) { return unit_of(model, i); };
  std::vector<double> w, nothing(static_cast<std::size_t>(f), 0.0);
  for (const int i : equations.independent) {
    out.z.push_back(reduced.q()[i] * unit(i));
    out.w.push_back(state.v[static_cast<std::size_t>(i)]);
    w.push_back(out.w.back() / unit(i));
  }
  reduced.move(w.data());
  reduced.accelerate_as(nothing.data());
  const std::vector<double> unforced = model.to_si({reduced.a(), reduced.a() + n});
  out.q = model.to_si(moving.x());
  out.v = model.to_si({reduced.v(), reduced.v() + n});
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < f; ++k) out.B.push_back(reduced.B(k)[i] * unit(i) / unit(equations.independent[k]));
  }

  MotionTerms<double> terms(equations.scene, equations.layout, equations.begin);
  terms.place(state.t, out.q.data());
  const auto all = static_cast<std::size_t>(n), rows = static_cast<std::size_t>(terms.rows());
  std::vector<double> gap(rows), moved(rows), bend(rows), mass(all * all), velocity(all), potential(all), load(all);
  out.J.resize(rows * all);
  terms.close(gap.data(), moved.data(), out.J.data());
  terms.forces(out.v.data(), mass.data(), velocity.data(), potential.data(), load.data(), bend.data());
  const auto reduce = [&](const std::vector<double>& full) {
    std::vector<double> of(static_cast<std::size_t>(f), 0.0);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < f; ++k)
        of[static_cast<std::size_t>(k)] +=
            out.B[static_cast<std::size_t>(i * f + k)] * full[static_cast<std::size_t>(i)];
    }
    return of;
  };
  const auto weighed = [&](auto of) {
    std::vector<double> full(all, 0.0);
    for (std::size_t i = 0; i < all; ++i) {
      for (std::size_t j = 0; j < all; ++j) full[i] += mass[i * all + j] * of(j);
    }
    return full;
  };
  out.D.resize(static_cast<std::size_t>(f) * f);
  for (int k = 0; k < f; ++k) {
    const std::vector<double> column = reduce(
        weighed([&](std::size_t j) { return out.B[j * static_cast<std::size_t>(f) + static_cast<std::size_t>(k)]; }));
    for (int i = 0; i < f; ++i) out.D[static_cast<std::size_t>(i * f + k)] = column[static_cast<std::size_t>(i)];
  }
  std::vector<double> inertial = weighed([&](std::size_t j) { return unforced[j]; });
  for (std::size_t i = 0; i < all; ++i) inertial[i] += velocity[i];
  out.h = reduce(inertial);
  out.c = reduce(potential);
  out.Q = reduce(load);

  out.alpha.assign(static_cast<std::size_t>(f), std::numeric_limits<double>::quiet_NaN());
  out.a.assign(all, std::numeric_limits<double>::quiet_NaN());
  out.status = reduced.accelerate();
  if (out.status != Reached::ok) return out;
  for (int k = 0; k < f; ++k) {
    out.alpha[static_cast<std::size_t>(k)] =
        reduced.alpha()[k] * unit(equations.independent[static_cast<std::size_t>(k)]);
  }
  out.a = model.to_si({reduced.a(), reduced.a() + n});
  return out;
}

}  // namespace poise
