#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "benchmarks/contact_work.hpp"
#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "motion/simulate.hpp"

namespace poise::benchmarks {
namespace {

std::string ball_text() {
  const BallSizes sizes;
  return fmt::format(R"(
gravity = [0, {}]
[ground]
points = {{ O = [0, 0] }}
[body.ball]
points = {{ C = [0, 0] }}
mass = 1
[[slide]]
name = "height"
points = ["ground.O", "ball.C"]
axis = [0, 1]
[[stop]]
name = "floor"
slide = "height"
min = 0
restitution = {}
[start]
height = {}
)",
                     -gravity, sizes.restitution, sizes.height);
}

std::string block_text() {
  const BlockSizes sizes;
  return fmt::format(R"(
gravity = [0, {0}]
[ground]
points = {{ O = [0, 0] }}
[body.block]
points = {{ L = [{1}, {3}], R = [{2}, {3}] }}
mass = 1
inertia = {4}
[[stop]]
name = "left"
y = "block.L"
min = 0
friction = {5}
[[stop]]
name = "right"
y = "block.R"
min = 0
friction = {5}
[start]
position = {{ block = [{6}, {7}] }}
block = {8}
)",
                     -gravity, -sizes.half_width, sizes.half_width, -sizes.half_height, sizes.inertia(), sizes.friction,
                     sizes.x(), sizes.y(), sizes.angle());
}

std::string toggle_text() {
  const ToggleSizes sizes;
  return fmt::format(R"(
gravity = [0, {}]
[ground]
points = {{ O = [0, 0] }}
[body.crank]
points = {{ O = [0, 0], E = [1, 0] }}
mass = 1
inertia = {}
center = [0.5, 0]
[body.rod]
points = {{ E = [0, 0], B = [1, 0] }}
mass = 1
inertia = {}
center = [0.5, 0]
[body.ram]
points = {{ B = [0, 0] }}
mass = 1
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.E", "rod.E"]
[[pin]]
points = ["rod.B", "ram.B"]
[[slide]]
name = "rail"
points = ["ground.O", "ram.B"]
axis = [1, 0]
[[stop]]
name = "stop"
bodies = ["ground", "crank"]
min = {}
restitution = {}
[start]
crank = {}
rod = {}
rail = {}
)",
                     -gravity, sizes.inertia(), sizes.inertia(), sizes.stop, sizes.restitution, sizes.from, -sizes.from,
                     2 * std::cos(sizes.from));
}

std::string text_of(ContactScene scene) {
  return scene == ContactScene::ball ? ball_text() : scene == ContactScene::block ? block_text() : toggle_text();
}

class PoiseMotion : public ContactMotion {
 public:
  PoiseMotion(const ContactProblem& problem, double accuracy)
      : model_(resisted_by_joints(parse_scene(text_of(problem.scene), "scene.toml"))),
        times_(problem.times),
        read_(problem.scene == ContactScene::ball ? model_.layout().travel[0] : model_.layout().links[1].frame) {
    options_.duration = times_.back();
    options_.accuracy = accuracy;
  }

  void begin() override { start_ = start_motion(model_, {}); }
  std::vector<ContactState> move() override {
    const Motion motion = simulate(model_, start_, options_);
    if (!motion.completed()) throw std::runtime_error(motion.why);
    steps_ = motion.steps;
    impacts_ = std::count_if(motion.events.begin(), motion.events.end(),
                             [](const ContactEvent& event) { return event.kind == ContactEvent::Kind::impact; });
    TrajectoryReader reader(motion.trajectory, {read_});
    std::vector<ContactState> out;
    for (double time : times_) {
      reader.at(time);
      out.push_back({reader.q(0), reader.v(0)});
    }
    return out;
  }
  std::string note() const override {
    return fmt::format("{} steps, {} impacts: {:.1f} each", steps_, impacts_,
                       static_cast<double>(steps_) / static_cast<double>(std::max<long>(impacts_, 1)));
  }

 private:
  MotionModel model_;
  std::vector<double> times_;
  int read_;
  MotionOptions options_;
  MotionState start_;
  int steps_ = 0;
  long impacts_ = 0;
};

}  // namespace

std::vector<ContactSetting> poise_settings(const ContactProblem& problem) {
  std::vector<ContactSetting> out;
  for (int digit = 2; digit <= 13; ++digit) {
    const double accuracy = std::pow(10.0, -digit);
    out.push_back({"Poise", fmt::format("accuracy {:.0e}", accuracy),
                   [=] { return std::make_unique<PoiseMotion>(problem, accuracy); }});
  }
  return out;
}

}  // namespace poise::benchmarks
