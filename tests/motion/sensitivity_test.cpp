// Sensitivities of whole motions against differences of simulations.

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "motion/simulate.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::motion_sensitivity_test {
namespace {

// A number of the scene, SI, and what the equations of motion depend on where it grows by one unit.
struct Number {
  std::string name;
  std::function<double&(Scene&)> in;
  std::function<Influence(const Scales&)> influence;
};

Number force_number(const std::string& name, const ForceNumber& number, std::function<double&(Scene&)> in,
                    std::function<double(const Scales&)> by) {
  return {name, std::move(in), [=](const Scales& scales) {
            Influence influence;
            influence.force = number;
            influence.by = by(scales);
            return influence;
          }};
}

// Of the law of the table's one element its number k, the member `in`.
template <class L>
Number element_number(const std::string& name, const Scene& scene, const char* table, double L::*in, int k,
                      std::function<double(const Scales&)> by) {
  return force_number(
      name, {ForceNumber::Of::element, static_cast<int>(test::index_of(scene, table)), k},
      [=](Scene& s) -> double& { return test::law<L>(s, table).*in; }, std::move(by));
}

double stiffness_unit(const Scales& s) { return s.length / s.force; }
double length_unit(const Scales& s) { return 1 / s.length; }
double torque_unit(const Scales& s) { return 1 / s.energy(); }

// Of a body: its mass at a fixed centre r, which is (1, r, |r|^2) in (m, m r, J), and its inertia.
std::vector<Number> body_numbers(int of, Vec2 center) {
  const auto body = [of](const Scales& s, double mass, Vec2 first, double moment) {
    Influence influence;
    influence.body = of;
    influence.mass = mass * s.length / s.force;
    influence.first = (1 / s.force) * first;
    influence.moment = moment / s.energy();
    return influence;
  };
  return {{"mass", [of](Scene& s) -> double& { return s.bodies[of].mass; },
           [=](const Scales& s) { return body(s, 1, center, dot(center, center)); }},
          {"inertia", [of](Scene& s) -> double& { return s.bodies[of].inertia; },
           [=](const Scales& s) {
             return body(s, 0, {0, 0}, 1);
           }}};
}

struct Case {
  std::string name;
  std::function<Scene()> scene;
  test::Release release;
  std::vector<Number> numbers;
  double duration;
  int body;  // whose inertia is asked about
};

std::vector<Number> line_numbers(const Scene& s) {
  return {element_number("stiffness", s, "spring", &LinearSpring::stiffness, 0, stiffness_unit),
          element_number("free length", s, "spring", &LinearSpring::free_length, 1, length_unit),
          element_number("damping", s, "damper", &Damper::coefficient, 0, stiffness_unit)};
}

std::vector<Number> four_bar_numbers(const Scene& s) {
  std::vector<Number> numbers = line_numbers(s);
  numbers.push_back(element_number("torsion", s, "torsion_spring", &LinearSpring::stiffness, 0, torque_unit));
  numbers.push_back(element_number("friction", s, "friction", &DryFriction::force, 0, torque_unit));
  numbers.push_back(force_number(
      "torque", {ForceNumber::Of::torque, 0, 0}, [](Scene& scene) -> double& { return scene.torques[0].value; },
      torque_unit));
  return numbers;
}

Scene lift() { return read_scene(test::dataset("lift.toml")); }

std::vector<Case> cases() {
  return {{"FourBar",
           test::four_bar_with_everything,
           {{}, {{"crank", 3.0}}},
           four_bar_numbers(test::four_bar_with_everything()),
           1.0,
           2},
          {"Follower", test::four_bar_with_follower, {}, four_bar_numbers(test::four_bar_with_follower()), 1.5, 3},
          {"QuickReturn", test::quick_return, {{}, {{"crank", 4.0}}}, line_numbers(test::quick_return()), 0.6, 2},
          {"Driven", test::driven_five_bar, {}, line_numbers(test::driven_five_bar()), 0.6, 3},
          {"Lift", lift, {{{"obd", 0.39}}, {}}, line_numbers(lift()), 1.0, 6}};
}

class Sensitivities : public testing::TestWithParam<Case> {
 protected:
  // By a central difference of fourth order:  (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12 h.
  using Readings = std::vector<test::Reading>;
  static Readings derivative(const std::function<Readings(double)>& at, double h) {
    const Readings far_down = at(-2 * h), down = at(-h), up = at(h), far_up = at(2 * h);
    Readings out = up;
    const auto combine = [&](auto part) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        for (std::size_t c = 0; c < (out[i].*part).size(); ++c) {
          (out[i].*part)[c] =
              (8 * ((up[i].*part)[c] - (down[i].*part)[c]) - ((far_up[i].*part)[c] - (far_down[i].*part)[c])) /
              (12 * h);
        }
      }
    };
    combine(&test::Reading::q);
    combine(&test::Reading::v);
    return out;
  }

  static std::vector<double> random_times(double end) {
    test::Random random(17);
    std::vector<double> t;
    for (int k = 0; k < 40; ++k) t.push_back(random.uniform(0.0, end));
    std::sort(t.begin(), t.end());
    return t;
  }

  // How far column c of a motion with sensitivities is from differences, over the largest of them.
  static double apart(const Motion& motion, const std::vector<double>& t, std::size_t column,
                      const Readings& differences) {
    const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
    std::vector<int> all;
    for (std::size_t i = 0; i < n; ++i) all.push_back(static_cast<int>(i));
    TrajectoryReader reader(motion.trajectory, all);
    double q_size = 0.0, v_size = 0.0, q_apart = 0.0, v_apart = 0.0;
    for (std::size_t k = 0; k < t.size(); ++k) {
      reader.at(t[k]);
      for (std::size_t i = 0; i < n; ++i) {
        q_size = std::max(q_size, std::abs(differences[k].q[i]));
        v_size = std::max(v_size, std::abs(differences[k].v[i]));
        q_apart = std::max(q_apart, std::abs(reader.q_p(i)[column] - differences[k].q[i]));
        v_apart = std::max(v_apart, std::abs(reader.v_p(i)[column] - differences[k].v[i]));
      }
    }
    return q_size > 0 ? std::max(q_apart / q_size, v_apart / v_size) : 1.0;
  }

  // Of the steps tried, some are too long for how crooked the motion is, and some drown in its rounding.
  static void expect_column(const Motion& motion, const std::vector<double>& t, std::size_t column,
                            const std::function<Readings(double)>& at, double size) {
    double least = 1.0;
    for (double step : {1e-2, 1e-3, 1e-4, 2e-5}) {
      least = std::min(least, apart(motion, t, column, derivative(at, step * size)));
    }
    EXPECT_LT(least, 1e-7);
  }
};

INSTANTIATE_TEST_SUITE_P(Each, Sensitivities, testing::ValuesIn(cases()),
                         [](const auto& mechanism) { return mechanism.param.name; });

TEST_P(Sensitivities, AreThoseOfDifferences) {
  const Scene scene = GetParam().scene();
  std::vector<Number> numbers = GetParam().numbers;
  for (Number& number : body_numbers(GetParam().body, scene.bodies[GetParam().body].center))
    numbers.push_back(std::move(number));
  const double end = GetParam().duration;
  const MotionModel model(scene);
  const MotionState start = test::released(model, GetParam().release);
  MotionOptions options;
  options.duration = end;
  options.sensitivities = true;
  for (const Number& number : numbers) options.influences.push_back(number.influence(model.scales()));
  const Motion motion = simulate(model, start, options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const auto f = static_cast<std::size_t>(motion.freedoms);
  ASSERT_EQ(motion.trajectory.columns, static_cast<int>(2 * f + options.influences.size()));
  const std::vector<double> t = random_times(end);
  // The initial independent coordinates and rates.
  for (std::size_t k = 0; k < 2 * f; ++k) {
    SCOPED_TRACE(k < f ? "initial coordinate" : "initial rate");
    const int moved = motion.independent[k % f];
    const auto at = [&](double by) {
      std::vector<StartValue> wanted;
      for (int i : motion.independent) {
        wanted.push_back({i, false, start.q[static_cast<std::size_t>(i)]});
        wanted.push_back({i, true, start.v[static_cast<std::size_t>(i)]});
      }
      for (StartValue& value : wanted) {
        if (value.coordinate == moved && value.rate == (k >= f)) value.value += by;
      }
      return test::read_at(test::moved(model, start_motion(model, wanted, &start.q), end, 1e-13), t);
    };
    expect_column(motion, t, k, at, 1.0);
  }
  for (std::size_t p = 0; p < options.influences.size(); ++p) {
    const Number& number = numbers[p];
    SCOPED_TRACE(number.name);
    Scene given = scene;
    const double value = number.in(given);
    const auto at = [&](double by) {
      Scene other = scene;
      number.in(other) += by;
      const MotionModel changed(other, model.scales());
      return test::read_at(test::moved(changed, start, end, 1e-13), t);
    };
    expect_column(motion, t, 2 * f + p, at, std::abs(value));
  }
}

}  // namespace
}  // namespace poise::motion_sensitivity_test
