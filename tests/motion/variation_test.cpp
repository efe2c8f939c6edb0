// Derivatives of motion by numbers that move its geometry, against differences of scenes compiled anew.

#include "motion/variation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/parameters.hpp"
#include "motion/reduced_motion.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::motion_variation_test {
namespace {

using Motion = ReducedMotion<double>;
using test::Random;

// A state of a scene in motion: the time, a closed pose near by, independent coordinates and their rates, scaled.
struct State {
  double t = 0.0;
  std::vector<double> q, z, w;
  std::vector<int> independent;
};

// What motion makes of a state: all coordinates, rates and accelerations.
using Answer = std::vector<double>;

std::optional<Answer> answer(const MotionModel& model, const State& state, Motion& motion) {
  motion.start_drives(state.q.data());
  motion.choose(state.t, state.q.data(), false, &state.independent);
  motion.expect(state.q.data());
  if (motion.place(state.t, state.z.data()) != Motion::Status::ok) return std::nullopt;
  motion.move(state.w.data());
  if (motion.accelerate() != Motion::Status::ok) return std::nullopt;
  Answer out;
  for (const double* values : {motion.q(), motion.v(), motion.a()}) {
    out.insert(out.end(), values, values + model.mechanism().coordinates());
  }
  return out;
}

std::optional<Answer> answer_of(const Scene& scene, const Scales& scales, const VaryingNumbers& varying,
                                const State& state) {
  const MotionModel model(scene, scales, varying);
  Motion motion(model.scaled_scene(), model.mechanism(), model.inertia());
  return answer(model, state, motion);
}

// Moves a closed pose by some tenths of rad and lengths; none where the mechanism cannot be moved so.
std::optional<State> random_state(const MotionModel& model, Random& random) {
  State state;
  try {
    state.q = close_loops(model);
  } catch (const InputError&) {
    return std::nullopt;
  }
  Motion motion(model.scaled_scene(), model.mechanism(), model.inertia());
  motion.start_drives(state.q.data());
  if (motion.choose(0.0, state.q.data(), false) != Motion::Status::ok) return std::nullopt;
  state.independent = motion.independent();
  const std::vector<double> q = state.q;
  for (double reach = 0.3; reach > 0.01; reach *= 0.8) {
    state.z.clear();
    state.w.clear();
    for (const int i : state.independent) {
      state.z.push_back(q[static_cast<std::size_t>(i)] + random.uniform(-reach, reach));
      state.w.push_back(random.uniform(-2.0, 2.0));
    }
    if (!answer(model, state, motion) || (motion.rank() > 0 && motion.pivot() < 0.05)) continue;
    state.q.assign(motion.q(), motion.q() + q.size());
    return state;
  }
  return std::nullopt;
}

// Drives without a start begin where the pose q has their measures.
void give_starts(Scene& scene, const MotionModel& model, const std::vector<double>& q) {
  const Mechanism<double>& m = model.mechanism();
  for (std::size_t k = 0; k < scene.drives.size(); ++k) {
    Drive& drive = scene.drives[k];
    if (drive.start) continue;
    const CompiledMeasure<double> on(model.scaled_scene(), model.layout(), m.phasors(),
                                     model.scaled_scene().drives[k].on);
    std::vector<Planar<double>> pose(static_cast<std::size_t>(m.pose_size() + on.scratch_size()));
    m.place(q.data(), pose.data());
    const double value = on.value({m.phasors(), pose.data(), pose.data() + m.phasors().pose_size()});
    drive.start = drive.on.is_angle() ? value : value * model.scales().length;
  }
}

struct Compared {
  int scenes = 0, numbers = 0, left_out = 0;
};

// Central differences over two steps agree with each other to `spread`; the derivative must be as near to the finer.
void compare(const Scene& scene, const ParameterRow& row, const std::shared_ptr<const MotionModel>& model,
             const State& state, double value, Compared& compared) {
  const Scales& scales = model->scales();
  const VaryingNumbers& varying = model->layout().varying;
  Motion motion(model->scaled_scene(), model->mechanism(), model->inertia());
  const std::optional<Answer> here = answer(*model, state, motion);
  if (!here) return;
  motion.set_variations({Variation(model, row.place)});
  motion.linearize();
  const int n = motion.coordinates();
  std::vector<double> alpha(static_cast<std::size_t>(motion.freedoms()));
  motion.influence({.variation = 0}, alpha.data());
  Answer by;
  for (const double* values : {motion.q_p(), motion.v_p(), motion.a_p()}) by.insert(by.end(), values, values + n);
  const auto difference = [&](double step) -> std::optional<Answer> {
    const auto at = [&](double steps) -> std::optional<Answer> {
      Scene other = scene;
      set_value_at(other, row.place, value + steps * step);
      let_friction_follow(other);
      return answer_of(other, scales, varying, state);
    };
    std::optional<Answer> out = at(1);
    const std::optional<Answer> down = at(-1), far = at(2), far_down = at(-2);
    if (!out || !down || !far || !far_down) return std::nullopt;
    for (std::size_t i = 0; i < out->size(); ++i) {
      (*out)[i] = (8 * ((*out)[i] - (*down)[i]) - ((*far)[i] - (*far_down)[i])) / (12 * step);
    }
    return out;
  };
  const double size = std::max(std::abs(value), 0.1 * (row.dimension.length == 1 ? scales.length : 1.0));
  std::optional<Answer> coarse, fine;
  try {
    coarse = difference(1e-3 * size);
    fine = difference(2.5e-4 * size);
  } catch (const InputError&) {
    ++compared.left_out;  // values that the number cannot have
    return;
  }
  if (!coarse || !fine) {
    ++compared.left_out;
    return;
  }
  ++compared.numbers;
  double scale = 0.0;
  for (std::size_t i = 0; i < by.size(); ++i) {
    scale = std::max(scale, std::abs(by[i]));
    if (i % static_cast<std::size_t>(n) == 0) scale = std::max(scale, std::abs((*here)[i]) * 1e-3 / size);
  }
  for (std::size_t i = 0; i < by.size(); ++i) {
    const double spread = std::abs((*fine)[i] - (*coarse)[i]);
    EXPECT_NEAR(by[i], (*fine)[i], spread + 1e-7 * scale + 1e-9 * std::abs((*here)[i]) / size)
        << scene.title << " " << row.path.text() << ", entry " << i << " of " << by.size();
  }
}

void compare_all(Scene scene, Random& random, Compared& compared) {
  scene = resisted_by_joints(std::move(scene));
  std::vector<ParameterRow> rows;
  std::vector<ParameterPlace> places;
  for (const ParameterRow& row : parameter_table(scene)) {
    const Owner owner = row.place.owner;
    if (owner == Owner::start || owner == Owner::drive || owner == Owner::time || owner == Owner::section) continue;
    const std::optional<double> value = value_at(scene, row.place);
    if (!value || !std::isfinite(*value)) continue;
    if (owner == Owner::force && *value == 0.0) continue;  // without direction
    if (dependent_number(scene, row.place) != nullptr) continue;
    rows.push_back(row);
    places.push_back(row.place);
  }
  const VaryingNumbers varying(scene, places);
  const Scales scales = MotionModel(scene).scales();
  auto model = std::make_shared<const MotionModel>(scene, scales, varying);
  const std::optional<State> state = random_state(*model, random);
  if (!state) return;
  give_starts(scene, *model, state->q);
  model = std::make_shared<const MotionModel>(scene, scales, varying);
  ++compared.scenes;
  for (const ParameterRow& row : rows) compare(scene, row, model, *state, *value_at(scene, row.place), compared);
}

/// A plate with a blade on the ground, and another on it.
Scene on_blades() {
  return parse_scene(R"(
gravity = [0.4, -0.9]
[body.plate]
points = { A = [0.1, -0.2], B = [0.5, 0.3] }
mass = 2
center = [0.2, 0.1]
inertia = 0.3
[body.skate]
points = { P = [-0.1, 0.05] }
mass = 0.7
center = [0.15, -0.04]
inertia = 0.05
[[blade]]
name = "under"
at = "plate.A"
angle = 0.3
[[blade]]
name = "above"
at = "skate.P"
angle = -0.4
on = "plate"
[[spring]]
points = ["plate.B", "skate.P"]
stiffness = 3
free_length = 0.2
)",
                     "blades.toml");
}

TEST(Variations, KnowConditionsOfBlades) {
  Random random(20261129);
  Compared compared;
  for (int round = 0; round < 3; ++round) {
    compare_all(on_blades(), random, compared);
    compare_all(read_scene(test::dataset("machines/castor.toml")), random, compared);
  }
  EXPECT_EQ(compared.scenes, 6);
  EXPECT_GE(compared.numbers, 100);
}

TEST(Variations, AreDerivativesOfScenesCompiledAnew) {
  Random random(20261128);
  Compared compared;
  for (const Scene& scene : {test::four_bar_with_everything(), test::four_bar_with_follower(), test::quick_return(),
                             test::quick_return_with_every_measure(), test::driven_five_bar(), test::rubbing_planet(),
                             test::rubbing_rack(), test::rubbing_rollers()}) {
    compare_all(scene, random, compared);
  }
  for (const std::string& name : test::scene_names()) {
    const Scene scene = read_scene(test::dataset(name));
    if (scene.bodies.size() > 20) continue;
    compare_all(scene, random, compared);
  }
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 4 == 0,
                          .other_laws = seed % 3 == 0,
                          .couplings = seed > 8};
    Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    scene.title = "seed " + std::to_string(seed);
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
      Body& body = scene.bodies[b];
      if (body.mass == 0.0) body.mass = 1.0;
      if (body.inertia == 0.0) body.inertia = 0.1;
    }
    compare_all(scene, random, compared);
  }
  RecordProperty("scenes", compared.scenes);
  RecordProperty("numbers", compared.numbers);
  EXPECT_GE(compared.scenes, 45);
  EXPECT_GE(compared.numbers, 2500);
}

}  // namespace
}  // namespace poise::motion_variation_test
