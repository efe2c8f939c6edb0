#include "motion/motor_efforts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/input_error.hpp"
#include "model/named_measures.hpp"
#include "model/nearest_name.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/held_rows.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The motions that joints and couplings allow at x: one column for each freedom, in which one coordinate has the rate
/// 1 and the other ones of `chosen` none.
struct FreeMotions {
  MatrixXd basis;
  std::vector<int> chosen;
};

FreeMotions free_motions(const MotionModel& model, const std::vector<double>& x) {
  const Mechanism<double>& m = model.mechanism();
  const MatrixXd jacobian = DensePoint<double>(m, x, permanent_rows(m)).jacobian;
  FreeMotions out;
  out.basis = jacobian.rows() > 0 ? MatrixXd(solvers::null_space<double>(jacobian, solvers::known_to::closed_point))
                                  : MatrixXd(MatrixXd::Identity(jacobian.cols(), jacobian.cols()));
  if (out.basis.cols() == 0) return out;
  const solvers::PivotOrder order =
      solvers::pivot_order<double>(out.basis.transpose(), solvers::known_to::closed_point);
  const Index freedoms = out.basis.cols();
  MatrixXd of_chosen(freedoms, freedoms);
  for (Index k = 0; k < freedoms; ++k) {
    out.chosen.push_back(order.columns[static_cast<std::size_t>(k)]);
    of_chosen.row(k) = out.basis.row(out.chosen.back());
  }
  const solvers::LeastSquares<double> inverse(of_chosen.transpose());
  MatrixXd basis(out.basis.rows(), freedoms);
  for (Index i = 0; i < basis.rows(); ++i) basis.row(i) = inverse.solve(out.basis.row(i).transpose()).transpose();
  out.basis = std::move(basis);
  return out;
}

/// A motor in a pin is a torque, one in what slides a force along the travel.
std::optional<Measure> effort_in_joint(const Scene& scene, const std::string& name) {
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    if (joint.name != name || joint.keeps_length()) continue;
    if (joint.has_travel()) return Measure::travel_of(static_cast<int>(j));
    if (!joint.keeps_angle()) return Measure::angle_between(joint.a.body, joint.b.body);
  }
  return std::nullopt;
}

}  // namespace

Drive find_motor(const std::string& where, const Scene& scene, const std::string& name) {
  Drive out;
  out.name = name;
  if (const std::optional<Measure> in_joint = effort_in_joint(scene, name)) {
    out.on = *in_joint;
    return out;
  }
  if (const std::optional<NamedMeasure> measure = find_measure(scene, name)) {
    out.on = measure->on;
    return out;
  }
  std::vector<std::string> names;
  for (const Joint& joint : scene.joints) {
    if (effort_in_joint(scene, joint.name)) names.push_back(joint.name);
  }
  throw InputError(
      fmt::format("{}: there is no joint or measure \"{}\" for a motor; expected a pin, a slide or a measure{}", where,
                  name, did_you_mean_or_list(name, names)));
}

MotorEfforts::MotorEfforts(const MotionModel& model, std::vector<Drive> motors)
    : model_(model), motors_(std::move(motors)) {
  refuse_states_of_controllers(model.scene(), "motors that make a motion");
  names_.resize(static_cast<std::size_t>(model.mechanism().coordinates()));
  for (std::size_t i = 0; i < names_.size(); ++i) names_[i] = model.layout().coordinates[i].name;
}

int MotorEfforts::freedoms(const MovingState& state) const {
  return static_cast<int>(free_motions(model_, state.x).chosen.size());
}

MotorsFound MotorEfforts::at(const MovingState& state, const Forces& forces) const {
  const Scene& scene = model_.scene();
  const double size = model_.scales().length;
  const FreeMotions free = free_motions(model_, state.x);
  const Index freedoms = free.basis.cols(), number = static_cast<Index>(motors_.size());
  const std::vector<double> none(state.x.size(), 0.0);
  MatrixXd work(freedoms, number);
  VectorXd needed = VectorXd::Zero(freedoms);
  const auto unit_of = [&](const Measure& on) { return on.is_angle() ? size : 1.0; };  // N to N m or N
  MotorsFound out;
  for (Index k = 0; k < freedoms; ++k) {
    const auto direction = free.basis.col(k);
    const std::vector<BodyMotion> motions = body_motions(model_, state.x, {direction.begin(), direction.end()}, none);
    for (Index j = 0; j < number; ++j) {
      const Measure& on = motors_[static_cast<std::size_t>(j)].on;
      work(k, j) = unit_of(on) * rate_of(scene, motions, on) / size;
    }
    for (std::size_t d = 0; d < scene.drives.size(); ++d) {
      const double of_drive = forces.drives[d].value * rate_of(scene, motions, scene.drives[d].on) / size;
      needed[k] += of_drive;
      out.needed = std::max(out.needed, std::abs(of_drive));
    }
  }
  VectorXd efforts = VectorXd::Zero(number);
  if (work.size() > 0) efforts = solvers::minimum_norm_solution<double>(work, needed, solvers::known_to::closed_point);
  const VectorXd left = needed - work * efforts;
  for (Index j = 0; j < number; ++j) {
    out.efforts.push_back(unit_of(motors_[static_cast<std::size_t>(j)].on) * efforts[j]);
  }
  for (Index k = 0; k < freedoms; ++k) {
    const int coordinate = free.chosen[static_cast<std::size_t>(k)];
    const bool is_angle = coordinate < model_.layout().angles;
    out.unbalanced.push_back(
        {names_[static_cast<std::size_t>(coordinate)], is_angle, left[k] * (is_angle ? size : 1.0)});
    out.left = std::max(out.left, std::abs(left[k]));
  }
  return out;
}

namespace {

/// Chebyshev's points on -1..1, and the coefficients of the powers of 1 + s, s in -1..1, of the polynomial through
/// values there: sum_k c_k (1 + s)^k.
constexpr std::size_t points_of_step = 12;

double point_of_step(std::size_t k) {
  return std::cos((static_cast<double>(k) + 0.5) * std::numbers::pi / points_of_step);
}

std::array<double, points_of_step> powers_through(const std::array<double, points_of_step>& values) {
  constexpr std::size_t n = points_of_step;
  // T_j(s) in powers of u = 1 + s:  T_{j+1} = 2 (u - 1) T_j - T_{j-1}.
  std::array<double, n> before{}, now{}, out{};
  for (std::size_t j = 0; j < n; ++j) {
    std::array<double, n> next{};
    if (j == 0) {
      next[0] = 1.0;
    } else {
      const double factor = j == 1 ? 1.0 : 2.0;
      for (std::size_t k = 0; k < n; ++k) {
        next[k] = -factor * now[k] - (j == 1 ? 0.0 : before[k]) + (k > 0 ? factor * now[k - 1] : 0.0);
      }
    }
    double c = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      c += (j == 0 ? 1.0 : 2.0) / n * values[k] *
           std::cos(static_cast<double>(j) * (static_cast<double>(k) + 0.5) * std::numbers::pi / n);
    }
    for (std::size_t k = 0; k < n; ++k) out[k] += c * next[k];
    before = now;
    now = next;
  }
  return out;
}

/// The scene without its drives, with loads in place of motors.
struct FreedScene {
  Scene scene;
  struct Load {
    MotionInput::Of of;
    int item;
    std::size_t motor;
    double sign;
  };
  std::vector<Load> loads;
};

std::optional<FreedScene> freed(const Scene& driven, const std::vector<Drive>& motors) {
  FreedScene out{driven, {}};
  Scene& scene = out.scene;
  scene.drives.clear();
  forget_functions_of_drives(scene);
  const auto add_torque = [&](int body, std::size_t motor, double sign) {
    if (body == 0) return;
    Torque torque;
    torque.name = fmt::format("motor {} of {}", motor, body);
    torque.body = body;
    torque.value = 1.0;
    out.loads.push_back({MotionInput::Of::torque, static_cast<int>(scene.torques.size()), motor, sign});
    scene.torques.push_back(std::move(torque));
  };
  const auto add_force = [&](const PointRef& at, int follows, const Vec2& axis, std::size_t motor, double sign) {
    if (at.body == 0) return;
    Force force;
    force.name = fmt::format("motor {} of {}", motor, at.body);
    force.at = at;
    force.vector = force.along = axis;
    force.follows = follows == 0 ? -1 : follows;
    out.loads.push_back({MotionInput::Of::force, static_cast<int>(scene.forces.size()), motor, sign});
    scene.forces.push_back(std::move(force));
  };
  for (std::size_t k = 0; k < motors.size(); ++k) {
    const Measure& on = motors[k].on;
    if (on.kind == Measure::Kind::angle) {
      add_torque(on.body_b, k, 1.0);
      add_torque(on.body_a, k, -1.0);
    } else if (on.kind == Measure::Kind::travel) {
      const Joint& joint = scene.joints[static_cast<std::size_t>(on.joint)];
      const Vec2 axis = (1 / norm(joint.axis)) * joint.axis;
      add_force(joint.b, joint.a.body, axis, k, 1.0);
      add_force(joint.a, joint.a.body, axis, k, -1.0);
    } else {
      return std::nullopt;
    }
  }
  return out;
}

}  // namespace

std::optional<double> fed_back(const MotionModel& model, const Motion& motion, const std::vector<Drive>& motors,
                               const std::function<std::vector<double>(double)>& efforts_at, double accuracy,
                               const std::atomic<bool>* interrupt) {
  constexpr std::size_t n = points_of_step;
  std::optional<FreedScene> freed_scene = freed(model.scene(), motors);
  if (!freed_scene) return std::nullopt;
  const MotionModel free(std::move(freed_scene->scene));
  const auto same_coordinates = [&] {
    const auto &one = free.layout().coordinates, &other = model.layout().coordinates;
    return free.layout().kept == model.layout().kept &&
           std::equal(one.begin(), one.end(), other.begin(), other.end(),
                      [](const Coordinate& a, const Coordinate& b) { return a.name == b.name && a.kind == b.kind; });
  };
  if (!same_coordinates()) return std::nullopt;
  const Trajectory& path = motion.trajectory;
  std::vector<double> breaks = {path.t.front()};
  std::vector<std::vector<double>> coefficients(motors.size());
  for (std::size_t k = 0; k + 1 < path.nodes(); ++k) {
    const double half = (path.t[k + 1] - path.t[k]) / 2;
    if (half == 0.0) continue;
    std::vector<std::array<double, n>> values(motors.size());
    for (std::size_t i = n; i-- > 0;) {
      const std::vector<double> efforts = efforts_at(path.t[k] + half * (1 + point_of_step(i)));
      for (std::size_t j = 0; j < motors.size(); ++j) values[j][i] = efforts[j];
    }
    for (std::size_t j = 0; j < motors.size(); ++j) {
      double scale = 1.0;
      for (const double power : powers_through(values[j])) {
        coefficients[j].push_back(power * scale);
        scale /= half;
      }
    }
    breaks.push_back(path.t[k + 1]);
  }
  MotionOptions options;
  options.duration = path.t.back();
  options.accuracy = accuracy;
  options.interrupt = interrupt;
  for (const FreedScene::Load& load : freed_scene->loads) {
    MotionInput input;
    input.of = load.of;
    input.item = load.item;
    input.curve = std::make_shared<TimeCurve>(breaks, coefficients[load.motor]);
    input.unit = load.sign;
    options.inputs.push_back(std::move(input));
  }
  const auto n_q = static_cast<std::ptrdiff_t>(path.coordinates);
  const MotionState start{{path.q.begin(), path.q.begin() + n_q}, {path.v.begin(), path.v.begin() + n_q}};
  const Motion followed = simulate(free, start, options);
  if (!followed.completed()) return std::nullopt;
  return difference(motion, followed, 1.0);
}

}  // namespace poise
