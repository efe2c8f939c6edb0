#include "identification/identifiability/private/structural_nulls_50.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "model/inertia_impl.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/reduced_motion_impl.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/random_stream.hpp"
#include "solvers/real50.hpp"

namespace poise {
namespace {

using Reduced50 = ReducedMotion<Real50>;
using Matrix50 = solvers::DenseMatrix<Real50>;
using Vector50 = solvers::DenseVector<Real50>;

/// Of columns of length one, what rounding of 50 digits may make of zero.
constexpr double zero = 1e-40;
/// The same of the null space, whose errors are larger by the condition of the other directions.
constexpr double zero_part = 1e-20;
/// Change of numbers relative to their scale that shows what their rounding may do.
constexpr double displacement = 4 * std::numeric_limits<double>::epsilon();
/// Largest relative change by that which leaves an effect certain.
constexpr double least_certain = 1e-3;

/// Every length, angle and vector changed at random by a `displacement` at most of the size of all lengths, 1, and its
/// norm: the cosine of a right angle, which should be zero, so changes by more than its size.
Scene displaced(Scene scene) {
  solvers::RandomStream random(5);
  const auto some = [&](double size) { return size * random.uniform(-displacement, displacement); };
  double size = 0.0;
  for (const Body& body : scene.bodies) {
    size = std::max(size, norm(body.center));
    for (const NamedPoint& point : body.points) size = std::max(size, norm(point.at));
  }
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.place.owner == Owner::start || row.place.owner == Owner::stop) continue;
    const std::optional<double> value = value_at(scene, row.place);
    if (!value) continue;
    const Dimension& of = row.dimension;
    const bool is_geometric = of.mass == 0 && of.force == 0 && of.time == 0;
    const double least = !is_geometric ? 0.0 : of.length == 1 ? size : of.angle == 1 ? 1.0 : 0.0;
    const double scale = std::max(least, std::abs(*value));
    if (scale > 0) set_value_at(scene, row.place, *value + some(scale));
  }
  const auto turn = [&](Vec2& vector) { vector = vector + some(1.0) * quarter_turn(vector); };
  turn(scene.gravity);
  for (Force& force : scene.forces) {
    if (!force.has_direction_of_its_own()) {
      turn(force.vector);
      continue;
    }
    const double size_along = force.size();
    turn(force.along);
    force.along = direction<double>(force.along);
    force.vector = size_along * force.along;
  }
  for (Joint& joint : scene.joints) turn(joint.axis);
  return scene;
}

/// The scene of a run, SI.
class ActingIn50Digits {
 public:
  ActingIn50Digits(const Scene& scene, const RunModel& run)
      : scene_(scene),
        run_(run),
        mechanism_(scene, Purpose::dynamics),
        inertia_(scene, mechanism_),
        motion_(scene, mechanism_, inertia_) {}

  int freedoms() const { return motion_.freedoms(); }

  bool place(const RunModel::State& state) {
    if (static_cast<std::size_t>(motion_.coordinates()) != state.q.size()) return false;
    const std::vector<Real50> q(state.q.begin(), state.q.end());
    if (!chosen_) motion_.choose(Real50(0), q.data(), false, &run_.independent());
    chosen_ = true;
    std::vector<Real50> z, w;
    for (const int i : motion_.independent()) {
      z.emplace_back(state.q[static_cast<std::size_t>(i)]);
      w.emplace_back(state.v[static_cast<std::size_t>(i)]);
    }
    motion_.expect(q.data());
    return motion_.evaluate(Real50(0), z.data(), w.data()) == Reduced50::Status::ok;
  }

  /// d alpha/d(number). The inertia of a body about its origin is (m, m c, J + m c.c), in doubles only rounded.
  Vector50 alpha_by(const SceneParameter& number) {
    if (!number.is_inertial()) return effect(number.influence(scene_, Scales{}));
    const Body& body = scene_.bodies[static_cast<std::size_t>(number.place().item)];
    const Real50 m = body.mass;
    const Real50 x = body.center.x;
    const Real50 y = body.center.y;
    Influence mass, along_x, along_y, moment;
    for (Influence* part : {&mass, &along_x, &along_y, &moment}) part->body = number.place().item;
    mass.mass = along_x.first.x = along_y.first.y = moment.moment = 1.0;
    switch (number.place().number) {
      case 0:
        return effect(mass) + x * effect(along_x) + y * effect(along_y) + (x * x + y * y) * effect(moment);
      case 1:
        return effect(moment);
      case 2:
        return m * effect(along_x) + 2 * m * x * effect(moment);
      default:
        return m * effect(along_y) + 2 * m * y * effect(moment);
    }
  }

  /// d(reading)/d(number) of a sensor of force.
  Real50 force_by(const Sensor& sensor, const SceneParameter& number) const {
    const ParameterPlace& place = number.place();
    if (place.owner != Owner::element || place.item != sensor.element) return 0;
    const CompiledMeasure<Real50> on(scene_, mechanism_.layout(), mechanism_.phasors(), sensor.on);
    std::vector<Planar<Real50>> pose(static_cast<std::size_t>(mechanism_.pose_size() + on.scratch_size()));
    mechanism_.place(motion_.q(), pose.data());
    const Real50 g = on.value({mechanism_.phasors(), pose.data(), pose.data() + mechanism_.pose_size()});
    return force_by_number(scene_.elements[static_cast<std::size_t>(place.item)].law, place.number, g, Real50(0));
  }

 private:
  Vector50 effect(const Influence& influence) {
    Vector50 alpha(freedoms());
    motion_.influence(influence, alpha.data());
    return alpha;
  }

  const Scene& scene_;
  const RunModel& run_;
  Mechanism<Real50> mechanism_;
  Inertia<Real50> inertia_;
  Reduced50 motion_;
  bool chosen_ = false;
};

bool has_50_digits(const RunModel& run, const std::vector<Sensor>& sensors, const Scene& scene) {
  if (run.is_at_rest() || run.has_equilibrium() || run.has_inputs() || !scene.drives.empty()) return false;
  for (std::size_t k = 0; k < run.times().size(); ++k) {
    if (!run.times()[k].empty() && sensors[k].quantity) return false;
  }
  return run.sensor_numbers().empty() &&
         std::none_of(run.numbers().begin(), run.numbers().end(),
                      [](const SceneParameter& number) { return number.is_geometric(); });
}

/// Rows of d alpha/dp and of the readings' direct derivatives.
std::optional<Matrix50> rows_of(const FitProblem& problem, std::size_t r, const Scene& scene,
                                const std::vector<RunModel::State>& states) {
  const RunModel& run = problem.run(r);
  const std::vector<int>& used = problem.parameters_of(r);
  std::vector<Sensor> sensors;
  for (std::size_t k = 0; k < run.times().size(); ++k) {
    const Sensor& sensor = problem.experiment().sensors[k];
    if (!run.times()[k].empty() && sensor.reads_force()) sensors.push_back(sensor);
  }
  ActingIn50Digits acting(scene, run);
  const Eigen::Index f = run.freedoms();
  const auto own = f + static_cast<Eigen::Index>(sensors.size());
  const auto n = static_cast<Eigen::Index>(problem.parameters().size());
  Matrix50 out = Matrix50::Zero(static_cast<Eigen::Index>(states.size()) * own, n);
  Eigen::Index row = 0;
  for (const RunModel::State& state : states) {
    if (!acting.place(state)) return std::nullopt;
    for (std::size_t c = 0; c < used.size(); ++c) {
      const SceneParameter& number = run.numbers()[c];
      out.block(row, used[c], f, 1) = acting.alpha_by(number);
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        out(row + f + static_cast<Eigen::Index>(k), used[c]) = acting.force_by(sensors[k], number);
      }
    }
    row += own;
  }
  return out;
}

/// Those of all runs; with `disturb` of the disturbed scenes.
std::optional<Matrix50> all_rows(const FitProblem& problem, const std::vector<RunModel::Actions>& actions,
                                 bool disturb) {
  const auto n = static_cast<Eigen::Index>(problem.parameters().size());
  Matrix50 out = Matrix50::Zero(n, n);
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel::Actions& of = actions[r];
    if (of.states.empty() && !problem.run(r).is_at_rest()) continue;
    if (of.has_impacts || !has_50_digits(problem.run(r), problem.experiment().sensors, of.scene)) return std::nullopt;
    const std::optional<Matrix50> rows = rows_of(problem, r, disturb ? displaced(of.scene) : of.scene, of.states);
    if (!rows) return std::nullopt;
    const Eigen::Index before = out.rows();
    out.conservativeResize(before + rows->rows(), Eigen::NoChange);
    out.bottomRows(rows->rows()) = *rows;
  }
  // Of a prior a null direction has no part.
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!problem.unknown_of(static_cast<std::size_t>(i)).prior) continue;
    out.col(i).setZero();
    out(i, i) = 1;
  }
  return out;
}

/// |R_kk| of A P = Q R, with these columns in this order.
Vector50 pivots(const Matrix50& a, const std::vector<int>& columns) {
  Matrix50 q(a.rows(), static_cast<Eigen::Index>(columns.size()));
  Vector50 out(q.cols());
  for (Eigen::Index k = 0; k < q.cols(); ++k) {
    Vector50 rest = a.col(columns[static_cast<std::size_t>(k)]);
    for (Eigen::Index j = 0; j < k; ++j) rest -= q.col(j).dot(rest) * q.col(j);
    out[k] = rest.norm();
    q.col(k) = out[k] > 0 ? Vector50(rest / out[k]) : Vector50(Vector50::Zero(rest.size()));
  }
  return out;
}

}  // namespace

std::optional<NullSpace> structural_nulls_50(const FitProblem& problem, const std::vector<RunModel::Actions>& actions) {
  const auto n = static_cast<Eigen::Index>(problem.parameters().size());
  std::optional<Matrix50> a = all_rows(problem, actions, false);
  if (!a) return std::nullopt;
  std::optional<Matrix50> again = all_rows(problem, actions, true);
  if (!again) return std::nullopt;
  Vector50 length = Vector50::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Real50 size = a->col(i).norm();
    if (size <= zero) {
      a->col(i).setZero();
      again->col(i).setZero();
      continue;
    }
    length[i] = size;
    a->col(i) /= size;
    again->col(i) /= size;
  }
  const solvers::PivotOrder order = solvers::pivot_order<Real50>(*a, zero);
  const Vector50 own = pivots(*a, order.columns);
  const Vector50 other = pivots(*again, order.columns);
  for (Eigen::Index k = 0; k < order.rank; ++k) {
    if (abs(other[k] - own[k]) > least_certain * own[k]) return std::nullopt;
  }
  NullSpace out;
  Matrix50 nulls = solvers::null_space<Real50>(*a, zero);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (nulls.cols() > 0 && nulls.row(i).norm() <= zero_part) nulls.row(i).setZero();
    nulls.row(i) /= length[i];
  }
  out.basis = nulls.cast<double>();
  out.error = length.cwiseInverse().cast<double>() * 10 * std::numeric_limits<double>::epsilon();
  if (nulls.cols() == 0) return out;
  out.gap = order.rank > 0 ? static_cast<double>(own[order.rank - 1]) / zero : std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace poise
