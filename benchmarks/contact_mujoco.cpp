// MuJoCo 2.2: fixed steps; contacts and closures are soft constraints.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "benchmarks/contact_work.hpp"
#include "benchmarks/mujoco_model.hpp"

namespace poise::benchmarks {
namespace {

struct MujocoSetting {
  int steps_per_second = 500;
  bool runge_kutta = false;
  double contact_steps = 5.0;  // in which a rebound is made: stiffness follows from it
};

// The damping ratio of a spring that only pushes, for which a mass leaves it with this part of its speed (T. Schwager,
// T. Poeschel, Granular Matter 9, 2007).
double damping_ratio(double restitution) {
  double low = 0.0, high = 0.7;
  for (int k = 0; k < 60; ++k) {
    const double z = (low + high) / 2, w = std::sqrt(1 - z * z);
    const double left = std::exp(-z / w * (std::numbers::pi - std::atan2(2 * z * w, 1 - 2 * z * z)));
    (left > restitution ? low : high) = z;
  }
  return (low + high) / 2;
}

class MujocoMotion : public ContactMotion {
 public:
  MujocoMotion(const ContactProblem& problem, const MujocoSetting& setting) : problem_(problem), setting_(setting) {
    model_ = mujoco_model(text());
    data_ = mj_makeData(model_);
  }
  ~MujocoMotion() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void begin() override {
    mj_resetData(model_, data_);
    const std::vector<double> q = start();
    std::copy(q.begin(), q.end(), data_->qpos);
  }

  std::vector<ContactState> move() override {
    std::vector<ContactState> out;
    long made = 0;
    for (double time : problem_.times) {
      for (const long end = std::lround(time * setting_.steps_per_second); made < end; ++made) mj_step(model_, data_);
      const int read = problem_.scene == ContactScene::block ? 2 : 0;
      out.push_back({data_->qpos[read], data_->qvel[read]});
    }
    return out;
  }

 private:
  double step() const { return 1.0 / setting_.steps_per_second; }

  std::string text() const {
    return fmt::format(
        "<mujoco><compiler angle=\"radian\"/>"
        "<option gravity=\"0 0 {}\" timestep=\"{}\" integrator=\"{}\" cone=\"elliptic\" impratio=\"10\"/>"
        "<worldbody>{}</worldbody>{}</mujoco>",
        -gravity, step(), setting_.runge_kutta ? "RK4" : "Euler",
        problem_.scene == ContactScene::ball    ? ball()
        : problem_.scene == ContactScene::block ? block()
                                                : toggle(),
        problem_.scene == ContactScene::toggle ? closure() : "");
  }

  static std::string impedance() { return fmt::format("{0} {0} 0.001 0.5 2", stiffest_impedance); }
  // Gone within some steps, without rebound.
  std::string without_rebound() const { return fmt::format("{} 1", 2 * step()); }
  std::string with_rebound(double restitution) const {
    const double z = damping_ratio(restitution);
    const double w = std::numbers::pi / (setting_.contact_steps * step() * std::sqrt(1 - z * z));
    return fmt::format("{} {}", -w * w, -2 * z * w);
  }
  std::string limit(double from, double restitution) const {
    return fmt::format("limited=\"true\" range=\"{} 100\" solreflimit=\"{}\" solimplimit=\"{}\"", from,
                       with_rebound(restitution), impedance());
  }

  // A limit of a joint costs less than a geometry on a plane.
  std::string ball() const {
    return fmt::format(
        "<body><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"
        "<joint type=\"slide\" axis=\"0 0 1\" {}/></body>",
        limit(0.0, BallSizes().restitution));
  }
  std::string block() const {
    const BlockSizes sizes;
    const std::string soft = fmt::format("friction=\"{} 0 0\" condim=\"3\" solref=\"{}\" solimp=\"{}\"", sizes.friction,
                                         without_rebound(), impedance());
    return fmt::format(
        "<geom type=\"plane\" size=\"9 9 1\" {0}/>"
        "<body><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"{1} {1} {1}\"/><joint type=\"slide\" axis=\"1 0 0\"/>"
        "<joint type=\"slide\" axis=\"0 0 1\"/><joint type=\"hinge\" axis=\"0 -1 0\"/>"
        "<geom type=\"box\" size=\"{2} {2} {3}\" {0}/></body>",
        soft, sizes.inertia(), sizes.half_width, sizes.half_height);
  }
  std::string toggle() const {
    const ToggleSizes sizes;
    const std::string mass =
        fmt::format("<inertial pos=\"0.5 0 0\" mass=\"1\" diaginertia=\"{0} {0} {0}\"/>", sizes.inertia());
    return fmt::format(
        "<body name=\"crank\">{0}<joint type=\"hinge\" axis=\"0 -1 0\" {1}/>"
        "<body name=\"rod\" pos=\"1 0 0\">{0}<joint type=\"hinge\" axis=\"0 -1 0\"/></body></body>"
        "<body name=\"ram\" pos=\"2 0 0\"><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"
        "<joint type=\"slide\" axis=\"1 0 0\"/></body>",
        mass, limit(sizes.stop, sizes.restitution));
  }
  std::string closure() const {
    return fmt::format(
        "<equality><connect body1=\"rod\" body2=\"ram\" anchor=\"1 0 0\" solref=\"{}\" solimp=\"{}\"/>"
        "</equality>",
        without_rebound(), impedance());
  }

  std::vector<double> start() const {
    if (problem_.scene == ContactScene::ball) return {BallSizes().height};
    if (problem_.scene == ContactScene::toggle) {
      const double from = ToggleSizes().from;
      return {from, -2 * from, 2 * std::cos(from) - 2};
    }
    const BlockSizes sizes;
    return {sizes.x(), sizes.y(), sizes.angle()};
  }

  ContactProblem problem_;
  MujocoSetting setting_;
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

}  // namespace

std::vector<ContactSetting> mujoco_settings(const ContactProblem& problem) {
  std::vector<ContactSetting> out;
  constexpr int coarsest = 100, finest = coarsest << 9;
  // A rebound has errors in proportion to a step over its duration, and in proportion to its duration: both are swept.
  // The block does not rebound.
  const std::vector<double> durations =
      problem.scene == ContactScene::block ? std::vector<double>{1.0} : std::vector<double>{5.0, 20.0};
  for (const bool runge_kutta : {false, true}) {
    for (double contact_steps : durations) {
      std::string name = runge_kutta ? "MuJoCo, RK4" : "MuJoCo, Euler";
      if (durations.size() > 1) name += fmt::format(", {} steps", contact_steps);
      for (int rate = coarsest; rate <= (runge_kutta ? finest / 4 : finest); rate *= 2) {
        const MujocoSetting setting{rate, runge_kutta, contact_steps};
        out.push_back(
            {name, fmt::format("{} Hz", rate), [=] { return std::make_unique<MujocoMotion>(problem, setting); }});
      }
    }
  }
  return out;
}

}  // namespace poise::benchmarks
