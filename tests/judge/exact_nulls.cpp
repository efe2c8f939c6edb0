#include "tests/judge/exact_nulls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "comparison/random.hpp"
#include "identification/identifiability/private/structural_nulls.hpp"
#include "model/inertia_impl.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion_impl.hpp"
#include "motion/simulate.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/real50.hpp"
#include "tests/support/random_experiment.hpp"

namespace poise::judge {
namespace {

using Real = Real50;
using Matrix = solvers::DenseMatrix<Real>;

/// A scene compiled in T, SI.
template <class T>
struct Compiled {
  explicit Compiled(const Scene& scene)
      : mechanism(scene, Purpose::dynamics), inertia(scene, mechanism), motion(scene, mechanism, inertia) {}

  Mechanism<T> mechanism;
  Inertia<T> inertia;
  ReducedMotion<T> motion;
};

/// d alpha/d(number). The inertia of a body about its origin is (m, m c, J + m c.c), in doubles only rounded.
std::vector<Real> alpha_by(ReducedMotion<Real>& motion, const Scene& scene, const SceneParameter& number) {
  std::vector<Real> out(static_cast<std::size_t>(motion.freedoms()), Real(0));
  const auto add = [&](const Real& share, const Influence& influence) {
    std::vector<Real> alpha(out);
    motion.influence(influence, alpha.data());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += share * alpha[k];
  };
  if (!number.is_inertial()) {
    add(Real(1), number.influence(scene, Scales{}));
    return out;
  }
  const Body& body = scene.bodies[static_cast<std::size_t>(number.place().item)];
  const Real m = body.mass, x = body.center.x, y = body.center.y;
  Influence mass, along_x, along_y, moment;
  mass.body = along_x.body = along_y.body = moment.body = number.place().item;
  mass.mass = along_x.first.x = along_y.first.y = moment.moment = 1.0;
  const std::string_view key = Body::numbers[static_cast<std::size_t>(number.place().number)].key;
  if (key == "mass") {
    add(Real(1), mass);
    add(x, along_x);
    add(y, along_y);
    add(x * x + y * y, moment);
  } else if (key == "inertia") {
    add(Real(1), moment);
  } else if (key == "center.x") {
    add(m, along_x);
    add(2 * m * x, moment);
  } else {
    add(m, along_y);
    add(2 * m * y, moment);
  }
  return out;
}

/// Rows of one run, appended.
void add_rows(const RunModel& run, const std::vector<Sensor>& sensors, const std::vector<int>& used,
              comparison::Random& random, std::vector<std::vector<Real>>& rows, std::size_t unknowns) {
  using Status = ReducedMotion<Real>::Status;
  const Scene& scene = run.scene();
  const MotionModel model(scene);
  const std::vector<double> q = start_motion(model, {}).q;
  Compiled<Real> m(scene);
  const std::vector<Real> q0(q.begin(), q.end());
  m.motion.choose(Real(0), q0.data(), false);
  const int f = m.motion.freedoms();
  std::vector<Real> z(static_cast<std::size_t>(f)), w(z);
  std::vector<SceneParameter> numbers = run.numbers();
  double reach = 0.5;
  // Many, since some of the elements act at few of them: a rope that is slack at most.
  const int states = 60 + 2 * static_cast<int>(numbers.size()) / f;
  const std::size_t before = rows.size();
  for (int s = 0, tries = 0; s < states && tries < 30 * states; ++tries) {
    for (int k = 0; k < f; ++k) {
      const auto at = static_cast<std::size_t>(k);
      z[at] = q0[static_cast<std::size_t>(m.motion.independent()[at])] + random.uniform(-reach, reach);
      w[at] = random.uniform(-5.0, 5.0);
    }
    m.motion.expect(q0.data());
    if (m.motion.place(Real(0), z.data()) != Status::ok || (m.motion.rank() > 0 && m.motion.pivot() < 0.01)) {
      reach = std::max(0.02, 0.9 * reach);
      continue;
    }
    m.motion.move(w.data());
    if (m.motion.accelerate() != Status::ok) continue;
    const std::size_t first = rows.size();
    rows.resize(first + static_cast<std::size_t>(f) + sensors.size(), std::vector<Real>(unknowns, Real(0)));
    for (std::size_t p = 0; p < numbers.size(); ++p) {
      const std::vector<Real> by = alpha_by(m.motion, scene, numbers[p]);
      for (std::size_t k = 0; k < by.size(); ++k) rows[first + k][static_cast<std::size_t>(used[p])] = by[k];
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        const ParameterPlace& place = numbers[p].place();
        if (!sensors[k].reads_force() || place.owner != Owner::element || place.item != sensors[k].element) continue;
        const Law& law = scene.elements[static_cast<std::size_t>(place.item)].law;
        const CompiledMeasure<Real> on(scene, m.mechanism.layout(), m.mechanism.phasors(), sensors[k].on);
        std::vector<Planar<Real>> pose(static_cast<std::size_t>(m.mechanism.pose_size() + on.scratch_size()));
        m.mechanism.place(m.motion.q(), pose.data());
        const Real length = on.value({m.mechanism.phasors(), pose.data(), pose.data() + m.mechanism.pose_size()});
        rows[first + static_cast<std::size_t>(f) + k][static_cast<std::size_t>(used[p])] =
            std::get<LinearSpring>(law).force_by(place.number, length, Real(0));
      }
    }
    ++s;
  }
  // Fewer rows than numbers would make nulls of what is only not seen.
  if (rows.size() - before < numbers.size()) throw std::runtime_error("too few poses without a dead point to judge");
}

}  // namespace

ExactNulls exact_nulls(const Experiment& experiment) {
  const FitProblem problem(experiment);
  const std::size_t n = problem.parameters().size();
  comparison::Random random(17);
  std::vector<std::vector<Real>> rows;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    add_rows(problem.run(r), experiment.sensors, problem.parameters_of(r), random, rows, n);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!problem.unknown_of(i).prior) continue;
    rows.emplace_back(n, Real(0));
    rows.back()[i] = 1;
  }
  const auto columns = static_cast<Eigen::Index>(n);
  Matrix a(static_cast<Eigen::Index>(rows.size()), columns);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      a(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  ExactNulls out;
  // Columns of length one. What is rounding of the scene's doubles, or its square, is neither zero nor an effect.
  constexpr double zero = 1e-40;
  for (Eigen::Index j = 0; j < columns; ++j) {
    const Real length = a.col(j).norm();
    out.clear = out.clear && (length <= zero || length > 1e-12);
    if (length > zero)
      a.col(j) /= length;
    else
      a.col(j).setZero();
  }
  const Matrix nulls = solvers::null_space<Real>(a, zero);
  out.dimension = static_cast<int>(nulls.cols());
  for (Eigen::Index i = 0; i < columns; ++i) out.moved.push_back(nulls.cols() > 0 && nulls.row(i).norm() > 1e-12);
  out.clear = out.clear && solvers::rank<Real>(a, 1e-13) == columns - nulls.cols();
  return out;
}

JudgedNulls judge_nulls(std::uint64_t seed) {
  const Experiment experiment = test::random_experiment(seed);
  const ExactNulls exact = exact_nulls(experiment);
  const FitProblem problem(experiment);
  std::vector<std::vector<double>> nuisances;
  for (std::size_t r = 0; r < problem.runs(); ++r) nuisances.push_back(problem.run(r).released());
  const NullSpace found = structural_nulls(problem, problem.truths(), nuisances);
  JudgedNulls out;
  out.unknowns = static_cast<int>(exact.moved.size());
  out.nulls = exact.dimension;
  out.clear = exact.clear;
  out.unclear = found.unclear > 0;
  for (std::size_t i = 0; i < exact.moved.size(); ++i) {
    const bool moved = found.touches(static_cast<Eigen::Index>(i));
    out.moved += exact.moved[i];
    out.false_claims += exact.moved[i] && !moved;
    out.withheld_wrongly += moved && !exact.moved[i];
    if (moved != exact.moved[i]) out.words += (out.words.empty() ? "" : ", ") + problem.parameters()[i].name;
  }
  out.words = fmt::format(
      "{} bodies, {} runs, {} unknowns, {} nulls (found {}, gap {:.1e}{}) {} claimed wrongly, {} withheld wrongly: {}",
      experiment.scene.bodies.size() - 1, problem.runs(), out.unknowns, out.nulls, found.dimension(), found.gap,
      found.unclear > 0 ? ", unclear" : "", out.false_claims, out.withheld_wrongly, out.words);
  return out;
}

}  // namespace poise::judge
