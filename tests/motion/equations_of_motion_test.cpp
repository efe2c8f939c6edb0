// The equation of motion, as numbers and as code, against closed forms, published numbers and the equations by which
// motions are simulated.

#include "motion/equations_of_motion.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/equation_code.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/motion/compiled_motion.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/seed.hpp"

namespace poise::equations_of_motion_test {
namespace {

using app_tests::TempFolder;
using test::dataset;
using test::Random;
using Reached = ReducedMotion<double>::Status;

constexpr double same = 1e-10;  // of the largest number of a kind

// A scene with its equation as it is assembled.
struct Stated {
  explicit Stated(const Scene& scene, const std::vector<std::string>& coordinates = {},
                  const std::vector<AskedValue>& at = {}, double t = 0.0)
      : model(scene),
        state(equation_state(model, {}, at, {}, t)),
        equations(equations_of_motion(model, {}, state, coordinates)) {}

  MotionModel model;
  EquationState state;
  EquationsOfMotion equations;

  std::vector<double> of_z(const std::vector<double>& full) const {
    std::vector<double> out;
    for (const int i : equations.independent) out.push_back(full[static_cast<std::size_t>(i)]);
    return out;
  }
};

AskedValue asked(const Scene& scene, const std::string& name, double si) {
  const MotionModel model(scene);
  return {channel_named("test", name, channels_of(model)), si};
}

// Near singular positions accelerations are as uncertain as the closure of loops over the cube of the pivot.
bool is_far_from_singular(const EquationsOfMotion& equations, const EquationNumbers& at) {
  const auto size = static_cast<Eigen::Index>(equations.rows.size());
  if (size == 0) return true;
  Eigen::MatrixXd J(size, size);
  Eigen::Index column = 0;
  const int n = equations.coordinates();
  for (int i = 0; i < n; ++i) {
    if (std::binary_search(equations.independent.begin(), equations.independent.end(), i)) continue;
    const double unit = equations.is_length(i) ? equations.scales.length : 1.0;
    for (Eigen::Index r = 0; r < size; ++r) {
      J(r, column) = unit * at.J[static_cast<std::size_t>(equations.rows[static_cast<std::size_t>(r)] * n + i)];
    }
    ++column;
  }
  for (Eigen::Index r = 0; r < size; ++r) J.row(r).normalize();
  return J.jacobiSvd().singularValues().minCoeff() > 0.02;
}

// A state in which each coordinate of the equation is off by at most `reach`, rad or sizes, with a position near it to
// start from; nothing where it cannot be assembled, or is nearly singular.
struct Met {
  EquationState state;
  EquationNumbers numbers;
};
std::optional<Met> met_at_random(const Stated& of, double reach, Random& random) {
  Met out{of.state, {}};
  out.state.t = random.uniform(0.0, 2.0);
  if (of.model.scene().drives.empty() == false) out.state.t *= 0.05;
  for (const int i : of.equations.independent) {
    const double unit = of.equations.is_length(i) ? of.equations.scales.length : 1.0;
    out.state.q[static_cast<std::size_t>(i)] += unit * random.uniform(-reach, reach);
    out.state.v[static_cast<std::size_t>(i)] = unit * random.uniform(-2.0, 2.0);
  }
  out.numbers = numbers_at(of.equations, out.state);
  if (out.numbers.q.empty()) return std::nullopt;
  if (!is_far_from_singular(of.equations, out.numbers)) return std::nullopt;
  return out;
}
Met a_random_state(const Stated& of, Random& random) {
  for (double reach = 0.4; reach > 1e-6; reach *= 0.8) {
    if (std::optional<Met> met = met_at_random(of, reach, random)) return *met;
  }
  ADD_FAILURE() << "no state";
  return {};
}

// The functions of a C file that Poise wrote, compiled by the C compiler of the system and loaded.
class CompiledC {
 public:
  CompiledC(const EquationsOfMotion& equations, const TempFolder& folder) {
    static int number = 0;
    const std::string name = fmt::format("equations{}", ++number);
    const std::string source = folder.write(name + ".c", c_code(equations));
    const std::string library = folder.path(name + ".so");
    const std::string log = folder.path(name + ".log");
    const std::string line = fmt::format(
        "cc -std=c99 -Wall -Wextra -Werror -pedantic -O1 -ffp-contract=off -shared -fPIC -o {} {} -lm > {} 2>&1",
        library, source, log);
    if (std::system(line.c_str()) != 0) {
      ADD_FAILURE() << app_tests::contents(log).substr(0, 2000);
      return;
    }
    handle_ = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) {
      ADD_FAILURE() << dlerror();
      return;
    }
    const std::string prefix = name_in_code(equations.scene.file);
    const auto find = [&](auto& function, const char* of) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle_, (prefix + of).c_str()));
      EXPECT_NE(function, nullptr) << of;
    };
    find(close, "_close");
    find(rates, "_rates");
    find(terms, "_terms");
    find(accelerations, "_accelerations");
    find(constraints, "_constraints");
    find(start, "_start");
  }
  ~CompiledC() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  CompiledC(const CompiledC&) = delete;
  CompiledC& operator=(const CompiledC&) = delete;

  bool is_loaded() const { return accelerations != nullptr; }

  int (*close)(double, const double*, double*) = nullptr;
  int (*rates)(double, const double*, const double*, double*, double*) = nullptr;
  int (*terms)(double, const double*, const double*, double*, double*, double*, double*, double*) = nullptr;
  int (*accelerations)(double, const double*, const double*, double*, double*) = nullptr;
  void (*constraints)(double, const double*, double*, double*) = nullptr;
  const double* start = nullptr;

 private:
  void* handle_ = nullptr;
};

// What code answers in a state, starting from a position.
struct Answered {
  int status = -1, of_accelerations = -1;
  std::vector<double> q, D, h, c, Q, alpha;
};

Answered answer_in_c(const CompiledC& code, const Stated& of, const EquationState& state,
                     const std::vector<double>& from) {
  const std::vector<double> z = of.of_z(state.q), w = of.of_z(state.v);
  const std::size_t f = z.size();
  Answered out;
  out.q = from;
  for (auto* each : {&out.h, &out.c, &out.Q, &out.alpha}) each->assign(f, 0.0);
  out.D.assign(f * f, 0.0);
  out.status =
      code.terms(state.t, z.data(), w.data(), out.q.data(), out.D.data(), out.h.data(), out.c.data(), out.Q.data());
  std::vector<double> q = from;
  out.of_accelerations = code.accelerations(state.t, z.data(), w.data(), q.data(), out.alpha.data());
  return out;
}

const char* const python = "/usr/bin/python3";

bool has_numpy() {
  static const bool has = std::system(fmt::format("{} -c 'import numpy' > /dev/null 2>&1", python).c_str()) == 0;
  return has;
}

const char* const driver = R"(
import importlib.util, sys
import numpy as np
with open(sys.argv[1]) as cases:
    for line in cases:
        file, *numbers = line.split()
        if file != getattr(sys.modules.get("m"), "__file__", ""):
            spec = importlib.util.spec_from_file_location("m", file)
            m = importlib.util.module_from_spec(spec)
            sys.modules["m"] = m
            spec.loader.exec_module(m)
        numbers = np.array([float(one) for one in numbers])
        f = m.FREEDOMS
        t, z, w, q = numbers[0], numbers[1:1 + f], numbers[1 + f:1 + 2 * f], numbers[1 + 2 * f:]
        status, closed, D, h, c, Q = m.terms(t, z, w, q)
        second, _, alpha = m.accelerations(t, z, w, q)
        none = np.full(f, np.nan)
        parts = [closed] + ([np.full(f * f, np.nan), none, none, none] if D is None else [D.ravel(), h, c, Q])
        parts.append(none if alpha is None else alpha)
        print(status, second, *[repr(float(one)) for one in np.concatenate(parts)])
)";

// The answers of Python to several questions, in one process.
class AskedPython {
 public:
  explicit AskedPython(const TempFolder& folder) : folder_(folder) {}
  /// Where the module of an equation is.
  std::string write(const EquationsOfMotion& equations) {
    return folder_.write(fmt::format("equations{}.py", ++number_), python_code(equations));
  }
  void ask(const std::string& module, const Stated& of, const EquationState& state, const std::vector<double>& from) {
    lines_ += module;
    const auto add = [&](const std::vector<double>& numbers) {
      for (const double one : numbers) lines_ += fmt::format(" {}", one);
    };
    add({state.t});
    add(of.of_z(state.q));
    add(of.of_z(state.v));
    add(from);
    lines_ += '\n';
    sizes_.emplace_back(of.equations.coordinates(), of.equations.freedoms());
  }
  std::vector<Answered> answers() {
    const std::string cases = folder_.write("cases.txt", lines_), program = folder_.write("driver.py", driver);
    const std::string out = folder_.path("answers.txt"), log = folder_.path("python.log");
    if (std::system(fmt::format("{} {} {} > {} 2> {}", python, program, cases, out, log).c_str()) != 0) {
      ADD_FAILURE() << app_tests::contents(log);
      return {};
    }
    EXPECT_EQ(app_tests::contents(log), "");
    std::ifstream text(out);
    std::vector<Answered> found;
    for (const auto& [n, f] : sizes_) {
      std::string line;
      std::getline(text, line);
      std::istringstream words(line);
      Answered one;
      words >> one.status >> one.of_accelerations;
      const auto read = [&](std::vector<double>& to, int count) {
        for (int i = 0; i < count; ++i) {
          std::string word;
          words >> word;
          to.push_back(std::strtod(word.c_str(), nullptr));
        }
      };
      read(one.q, n);
      read(one.D, f * f);
      for (auto* each : {&one.h, &one.c, &one.Q, &one.alpha}) read(*each, f);
      found.push_back(std::move(one));
    }
    return found;
  }

 private:
  const TempFolder& folder_;
  std::string lines_;
  std::vector<std::pair<int, int>> sizes_;
  int number_ = 0;
};

double largest_of(const std::vector<double>& values) {
  double out = 0.0;
  for (const double value : values) out = std::max(out, std::abs(value));
  return out;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected, double size, const char* what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], same * size) << what << " " << i;
}

// Coordinates of different units are compared each with its own kind: reduced numbers of a mechanism of ordinary size
// are of one order.
void expect_same(const Answered& found, const EquationNumbers& expected, double size) {
  ASSERT_EQ(found.status, 0);
  expect_near(found.q, expected.q, std::max(1.0, size), "q");
  expect_near(found.D, expected.D, largest_of(expected.D), "D");
  // Coordinates that move much faster than z have forces of inertia as large, of which h and alpha are differences.
  const double steep = std::max(1.0, largest_of(expected.B));
  const double forces = steep * std::max({largest_of(expected.h), largest_of(expected.c), largest_of(expected.Q),
                                          largest_of(expected.D)});
  expect_near(found.h, expected.h, forces, "h");
  expect_near(found.c, expected.c, forces, "c");
  expect_near(found.Q, expected.Q, forces, "Q");
  if (expected.status == Reached::no_inertia) {
    EXPECT_EQ(found.of_accelerations, 3);
    return;
  }
  ASSERT_EQ(found.of_accelerations, 0);
  expect_near(found.alpha, expected.alpha, steep * std::max(1.0, largest_of(expected.alpha)), "alpha");
}

TEST(EquationsOfMotion, OfAPendulum) {
  const Scene scene = parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0] }
mass = 2.0
center = [0.3, 0.4]
inertia = 0.07
[[pin]]
name = "O"
points = ["ground.O", "rod.O"]
[start]
rod = -1.2
)",
                                  "scene.toml");
  Stated of(scene);
  of.state.v = {1.7};
  const EquationNumbers at = numbers_at(of.equations, of.state);
  ASSERT_EQ(at.status, Reached::ok);
  const double angle = -1.2 + std::atan2(0.4, 0.3);
  EXPECT_NEAR(at.D[0], 0.07 + 2.0 * 0.25, 1e-15);
  EXPECT_NEAR(at.h[0], 0.0, 1e-15);
  EXPECT_NEAR(at.c[0], 2.0 * 9.81 * 0.5 * std::cos(angle), 1e-14);
  EXPECT_NEAR(at.Q[0], 0.0, 1e-15);
  EXPECT_NEAR(at.alpha[0], -at.c[0] / at.D[0], 1e-13);
}

TEST(EquationsOfMotion, OfTheDoublePendulum) {
  const Scene scene = read_scene(dataset("double_pendulum.toml"));
  Stated of(scene);
  of.state.q = {-1.0, 0.4};
  of.state.v = {1.3, -2.1};
  const EquationNumbers at = numbers_at(of.equations, of.state);
  ASSERT_EQ(at.status, Reached::ok);
  const double m1 = 0.0938440, c1 = 0.108565, I1 = 4.37529e-4, l = 0.172719;
  const double m2 = 0.137596, c2 = 0.116779, I2 = 1.26883e-3, g = 9.80858;
  const double coupled = m2 * l * c2;
  EXPECT_NEAR(at.D[0], I1 + m1 * c1 * c1 + m2 * l * l, 1e-16);
  EXPECT_NEAR(at.D[1], coupled * std::cos(1.4), 1e-16);
  EXPECT_NEAR(at.D[2], coupled * std::cos(1.4), 1e-16);
  EXPECT_NEAR(at.D[3], I2 + m2 * c2 * c2, 1e-16);
  EXPECT_NEAR(at.h[0], coupled * std::sin(-1.4) * 2.1 * 2.1, 1e-16);
  EXPECT_NEAR(at.h[1], -coupled * std::sin(-1.4) * 1.3 * 1.3, 1e-16);
  EXPECT_NEAR(at.c[0], (m1 * c1 + m2 * l) * g * std::cos(-1.0), 1e-15);
  EXPECT_NEAR(at.c[1], m2 * c2 * g * std::cos(0.4), 1e-15);
  const double between = 1e-5 * (-2.1 - 1.3);
  EXPECT_NEAR(at.Q[0], -2.37143e-4 * 1.3 + between, 1e-16);
  EXPECT_NEAR(at.Q[1], -between, 1e-16);
}

// The inertia of crank and rotor with that of the rod, uniform, and of the slider, at 0 and 90 degrees.
TEST(EquationsOfMotion, OfASliderCrankAtItsEndsAndBetween) {
  const Scene scene = parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [0.05, 0] }
inertia = 0.002
[body.rod]
points = { B = [0, 0], C = [0.2, 0] }
mass = 0.3
center = [0.1, 0]
inertia = 0.001
[body.piston]
points = { C = [0, 0] }
mass = 0.5
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "B"
points = ["crank.B", "rod.B"]
[[pin]]
name = "C"
points = ["rod.C", "piston.C"]
[[slide]]
name = "guide"
points = ["ground.O", "piston.C"]
axis = [1, 0]
[[damper]]
name = "piston"
points = ["ground.O", "piston.C"]
coefficient = 30
[start]
crank = 0.3
guide = 0.24
)",
                                  "scene.toml");
  for (const auto& [angle, inertia] : {std::pair(0.0, 0.00225), std::pair(std::acos(-1.0) / 2, 0.004)}) {
    Stated of(scene, {"crank"}, {asked(scene, "crank", angle)});
    of.state.v[static_cast<std::size_t>(of.equations.independent[0])] = 10.0;
    const EquationNumbers at = numbers_at(of.equations, of.state);
    ASSERT_EQ(at.status, Reached::ok);
    EXPECT_NEAR(at.D[0], inertia, 1e-15);
    // The slider has 0 and 0.05 w there.
    EXPECT_NEAR(at.Q[0], angle == 0.0 ? 0.0 : -30 * 0.05 * 0.05 * 10, 1e-13);
  }
}

// Its reduced inertia in positions of the stroke, computed apart from Poise.
TEST(EquationsOfMotion, OfTheLift) {
  const nlohmann::json answers = test::read_json(dataset("lift_dynamics.json"));
  Scene scene = read_scene(dataset("lift.toml"));
  int compared = 0;
  for (const nlohmann::json& entry : answers.at("entries")) {
    set_value(scene, "body.payload.mass", entry.at("payload"));
    const Stated of(scene, {"obd"}, {asked(scene, "obd", entry.at("q").get<double>())});
    const EquationNumbers at = numbers_at(of.equations, of.state);
    ASSERT_EQ(at.D.size(), 1U);
    EXPECT_NEAR(at.D[0] / entry.at("M").get<double>(), 1.0, 5e-11);
    ++compared;
  }
  EXPECT_EQ(compared, 15);
}

struct Case {
  std::string name;
  std::function<Scene()> scene;
};

std::vector<Case> cases() {
  const auto of_dataset = [](const std::string& name) {
    return Case{name, [name] { return read_scene(dataset(name + ".toml")); }};
  };
  return {{"everything", test::four_bar_with_everything},
          {"follower", test::four_bar_with_follower},
          {"quick_return", test::quick_return},
          {"every_measure", test::quick_return_with_every_measure},
          {"driven", test::driven_five_bar},
          of_dataset("double_pendulum"),
          of_dataset("lift"),
          of_dataset("andrews"),
          of_dataset("cam_follower"),
          of_dataset("bike_suspension"),
          of_dataset("gas_lid"),
          of_dataset("planetary_gear"),
          of_dataset("block_and_tackle"),
          of_dataset("curved_slot"),
          of_dataset("rolling_wheel"),
          of_dataset("forced_machine"),
          of_dataset("pumped_spring"),
          of_dataset("shaken_pendulum")};
}

// What only masses that are given would tell: the bodies of scenes for statics have none.
Scene with_inertia(Scene scene, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    if (body.mass == 0.0) body.mass = random.uniform(0.5, 2.0);
    if (body.inertia == 0.0) body.inertia = random.uniform(0.01, 0.1);
  }
  return scene;
}

/// A formula, pieces, a sum or a product of all that there is in formulas.
TimeLaw composed_law(Random& random) {
  const FormulaInTime formula = FormulaInTime::of(
      "a*sin(3*t)*exp(-t/b) + sqrt(1 + t^2) - hypot(t, a)/log(3 + t) + atan2(t, b)^2 + min(t, b) + abs(t - 1)*tan(t/4)",
      {"a", "b"}, {random.uniform(0.5, 1.5), 0.8}, 1.0);
  const RampInTime ramp{0.2, 1.5, 0.5, 1.5, static_cast<Way>(random.index(5))};
  const auto table =
      TableInTime::through({0.2, 0.7, 1.1, 1.6}, {1.0, -0.3, 0.8, 0.1}, TimeTable::Between::way, false, Way::s_curve);
  using How = ComposedInTime::How;
  switch (random.index(3)) {
    case 0:
      return ComposedInTime::of(How::sum, {}, {formula, ramp, SineInTime{0.3, 0.9, 0.1, 0.2}});
    case 1:
      return ComposedInTime::of(How::product, {}, {formula, ramp, table});
    default:
      return ComposedInTime::of(How::piecewise, {0.4, 1.2}, {ramp, formula, table});
  }
}

/// Numbers of springs and the frame follow functions of time.
void let_springs_follow_time(Scene& scene, Random& random) {
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    if (!std::holds_alternative<LinearSpring>(scene.elements[e].law)) continue;
    for (const int part : {0, 1}) {
      TimeFunction function{.of = TimeFunction::Of::element, .item = static_cast<int>(e), .law = composed_law(random)};
      function.part = part;
      scene.time_functions.push_back(std::move(function));
    }
  }
  for (const int part : {0, 1}) {
    TimeFunction function{.of = TimeFunction::Of::frame, .law = SineInTime{0.2, 0.6, 0.3, 0.0}};
    function.part = part;
    function.order = random.index(3);
    scene.time_functions.push_back(std::move(function));
  }
}

// A force and a torque of the scene follow functions of time of every kind.
void let_loads_follow_time(Scene& scene, Random& random) {
  for (std::size_t i = 0; i < scene.forces.size(); ++i) {
    TimeFunction function{.of = TimeFunction::Of::force, .item = static_cast<int>(i), .law = {}};
    switch (i % 5) {
      case 0:
        function.law = SineInTime{.amplitude = 0.5, .frequency = 0.7, .phase = random.uniform(0.0, 6.0), .offset = 1.0};
        break;
      case 1:
        function.law =
            RampInTime{.from = 0.2, .to = 1.5, .start = 0.5, .end = 1.5, .way = static_cast<Way>(random.index(5))};
        break;
      case 2:
        function.law = composed_law(random);
        break;
      case 3:
        function.law = StepInTime{.at = 1.0, .from = 0.5, .to = 2.0};
        break;
      default: {
        const auto between = random.uniform(0, 1) > 0.5 ? TimeTable::Between::spline : TimeTable::Between::monotone;
        function.law = TableInTime::through({0.2, 0.7, 1.1, 1.6}, {1.0, -0.3, 0.8, 0.1}, between, false);
      }
    }
    scene.time_functions.push_back(std::move(function));
  }
}

class EquationsAsCode : public testing::Test {
 protected:
  // States of the scene by C and Python against numbers.
  void compare(const std::string& name, const Scene& scene, Random& random, int states) {
    SCOPED_TRACE(name);
    const Stated of(scene);
    const CompiledC code(of.equations, folder_);
    ASSERT_TRUE(code.is_loaded());
    const std::string module = has_numpy() ? python_.write(of.equations) : "";
    for (int k = 0; k < states; ++k) {
      const Met met = a_random_state(of, random);
      if (met.numbers.q.empty()) return;
      std::vector<double> near = met.numbers.q;
      for (double& one : near) one += 1e-4 * random.uniform(-1.0, 1.0);
      expect_same(answer_in_c(code, of, met.state, near), met.numbers, of.equations.scales.length);
      // Twice the same is the same.
      const Answered once = answer_in_c(code, of, met.state, near), again = answer_in_c(code, of, met.state, near);
      EXPECT_EQ(once.alpha, again.alpha);
      // J at the position, and D alpha + h + c = Q.
      std::vector<double> gaps(of.equations.row_names.size()), J(met.numbers.J.size());
      code.constraints(met.state.t, met.numbers.q.data(), gaps.data(), J.data());
      expect_near(J, met.numbers.J, std::max(1.0, largest_of(met.numbers.J)), "J");
      if (met.numbers.status == Reached::ok) {
        const std::size_t f = met.numbers.z.size();
        for (std::size_t i = 0; i < f; ++i) {
          double sum = met.numbers.h[i] + met.numbers.c[i] - met.numbers.Q[i], terms = std::abs(met.numbers.c[i]);
          for (std::size_t j = 0; j < f; ++j) {
            sum += met.numbers.D[i * f + j] * met.numbers.alpha[j];
            terms += std::abs(met.numbers.D[i * f + j] * met.numbers.alpha[j]);
          }
          terms += std::abs(met.numbers.h[i]) + std::abs(met.numbers.Q[i]);
          EXPECT_NEAR(sum, 0.0, same * terms);
        }
      }
      if (module.empty()) continue;
      python_.ask(module, of, met.state, near);
      expected_.push_back({name, met.numbers, of.equations.scales.length});
    }
  }
  void compare_python() {
    if (expected_.empty()) return;
    const std::vector<Answered> found = python_.answers();
    ASSERT_EQ(found.size(), expected_.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      SCOPED_TRACE("Python, " + expected_[i].name);
      expect_same(found[i], expected_[i].numbers, expected_[i].size);
    }
  }

  TempFolder folder_;
  AskedPython python_{folder_};
  struct Expected {
    std::string name;
    EquationNumbers numbers;
    double size;
  };
  std::vector<Expected> expected_;
};

TEST_F(EquationsAsCode, IsTheEquationOfEveryKindOfScene) {
  Random random(11);
  for (const Case& one : cases()) compare(one.name, one.scene(), random, 3);
  compare_python();
}

TEST_F(EquationsAsCode, IsTheEquationOfRandomMechanisms) {
  const int mechanisms = test::cases(6, 40);
  for (int k = 0; k < mechanisms; ++k) {
    const std::uint64_t seed = test::seed(5000) + static_cast<std::uint64_t>(k);
    Random random(seed);
    const test::PlantedMechanism planted = test::plant_mechanism(
        seed,
        {.loops = k % 3, .followers = k % 4 == 1, .stops = k % 2 == 0, .other_laws = true, .couplings = k % 3 != 1});
    Scene scene = with_inertia(planted.in_equilibrium, seed);
    let_loads_follow_time(scene, random);
    let_springs_follow_time(scene, random);
    compare(fmt::format("seed {}", seed), scene, random, 3);
    if (HasFatalFailure()) return;
  }
  compare_python();
}

// A block of 1 kg on a rail, upon laws of every kind that has pieces, and a lever on it that a cam lifts.
Scene block_upon_pieces() {
  Scene scene = parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 1
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[force]]
name = "sine"
at = "block.C"
vector = [3, 0]
[[force]]
name = "ramp"
at = "block.C"
vector = [2, 0]
[[force]]
name = "step"
at = "block.C"
vector = [5, 0]
[[force]]
name = "line"
at = "block.C"
vector = [4, 0]
[[force]]
name = "spline"
at = "block.C"
vector = [1, 0]
)",
                            "block.toml");
  const Measure travel = Measure::travel_of(0);
  const auto add = [&](const std::string& name, const Law& law) {
    scene.elements.push_back({"spring", name, travel, law});
  };
  add("curve", CurveSpring({-0.4, -0.1, 0.2, 0.7}, {-3.0, -1.0, 0.5, 6.0}, true));
  add("tension", LinearSpring{.stiffness = 7.0, .free_length = 0.1, .acts = SpringActs::tension});
  add("compression", LinearSpring{.stiffness = 5.0, .free_length = -0.2, .acts = SpringActs::compression});
  add("bump", BumpStop{.force = 8.0, .free_length = -0.6, .depth = 0.1, .exponent = 2.5});
  add("friction", DryFriction{.force = 0.7, .width = 0.05});
  const auto follow = [&](int item, TimeLaw law) {
    scene.time_functions.push_back({.of = TimeFunction::Of::force, .item = item, .law = std::move(law)});
  };
  follow(0, SineInTime{.amplitude = 0.5, .frequency = 0.7, .phase = 0.3, .offset = 1.0});
  follow(1, RampInTime{.from = 0.2, .to = 1.5, .start = 0.5, .end = 1.5, .way = Way::polynomial_345});
  follow(2, StepInTime{.at = 1.0, .from = 0.5, .to = 2.0});
  const std::vector<double> t = {0.25, 0.75, 1.25, 1.5}, value = {1.0, -0.3, 0.8, 0.1};
  follow(3, TableInTime::through(t, value, TimeTable::Between::linear, false));
  follow(4, TableInTime::through(t, value, TimeTable::Between::spline, false));
  return scene;
}

// Accelerations are those of ReducedMotion, which has neither these pieces nor these functions of time.
TEST_F(EquationsAsCode, HasAllPiecesOfLawsAndFunctionsOfTime) {
  const Stated of(block_upon_pieces());
  const CompiledC code(of.equations, folder_);
  ASSERT_TRUE(code.is_loaded());
  const std::string module = has_numpy() ? python_.write(of.equations) : "";
  std::vector<EquationNumbers> expected;
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (int k = 0; k <= 40; ++k) {
    EquationState state = of.state;
    state.t = 0.05 * k;  // among them, exactly, times of breaks
    if (k % 5 == 0) state.t = 0.25 * (k / 5);
    state.q[0] = -1.0 + 0.05 * ((7 * k) % 41);
    state.v[0] = 0.02 * (k % 11 - 5);
    const EquationNumbers at = numbers_at(of.equations, state);
    ASSERT_EQ(at.status, Reached::ok);
    EXPECT_NEAR(at.D[0] * at.alpha[0] + at.h[0] + at.c[0], at.Q[0], 1e-11);
    const Answered found = answer_in_c(code, of, state, state.q);
    expect_same(found, at, 1.0);
    least = std::min(least, at.c[0]);
    greatest = std::max(greatest, at.c[0]);
    if (module.empty()) continue;
    python_.ask(module, of, state, state.q);
    expected_.push_back({"pieces", at, 1.0});
  }
  EXPECT_LT(least, -5.0);
  EXPECT_GT(greatest, 5.0);
  compare_python();
}

// A cart that follows each function of time, with a pendulum on it: its rates and what its acceleration does are those
// of ReducedMotion.
TEST_F(EquationsAsCode, HasRatesAndAccelerationsOfDrives) {
  const std::vector<double> t = {0.25, 0.75, 1.25, 1.5}, value = {1.0, -0.3, 0.8, 0.1};
  const std::vector<TimeLaw> laws = {
      SineInTime{.amplitude = 0.5, .frequency = 0.7, .phase = 0.3, .offset = 1.0},
      RampInTime{.from = 0.2, .to = 1.5, .start = 0.5, .end = 1.5, .way = Way::polynomial_345},
      RampInTime{.from = 0.2, .to = 1.5, .start = 0.5, .end = 1.5, .way = Way::linear},
      TableInTime::through(t, value, TimeTable::Between::monotone, false),
      TableInTime::through(t, value, TimeTable::Between::spline, false),
      TableInTime::through(t, value, TimeTable::Between::way, false, Way::trapezoidal),
      FormulaInTime::of("exp(-t)*cos(3*t)/(1 + t^2)", {}, {}, 1.0)};
  for (const TimeLaw& law : laws) {
    Scene scene = parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.cart]
points = { C = [0, 0] }
mass = 1
[body.rod]
points = { C = [0, 0] }
mass = 2
center = [0, -0.5]
inertia = 0.1
[[slide]]
name = "rail"
points = ["ground.O", "cart.C"]
axis = [1, 0]
[[pin]]
name = "C"
points = ["cart.C", "rod.C"]
[[drive]]
name = "push"
slide = "rail"
)",
                              "cart.toml");
    scene.time_functions.push_back({.of = TimeFunction::Of::drive, .item = 0, .law = law});
    const Stated of(scene);
    const CompiledC code(of.equations, folder_);
    ASSERT_TRUE(code.is_loaded());
    for (int k = 0; k <= 16; ++k) {
      EquationState state = equation_state(of.model, {}, {}, {}, 0.125 * k);
      const auto z = static_cast<std::size_t>(of.equations.independent[0]);
      state.q[z] = 0.3;
      state.v[z] = 2.0;
      const EquationNumbers at = numbers_at(of.equations, state);
      ASSERT_EQ(at.status, Reached::ok) << state.t;
      expect_same(answer_in_c(code, of, state, of.state.q), at, 2.0);
      std::vector<double> q = of.state.q, v(q.size());
      EXPECT_EQ(code.rates(state.t, &at.z[0], &at.w[0], q.data(), v.data()), 0);
      expect_near(v, at.v, 1.0, "v");
      EXPECT_NEAR(at.D[0] * at.alpha[0] + at.h[0] + at.c[0], at.Q[0], 1e-11);
    }
  }
}

// Where the crank is longer than the rod it turns to 30 degrees at most.
Scene short_rod() {
  return parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [0.2, 0] }
inertia = 0.002
[body.rod]
points = { B = [0, 0], C = [0.1, 0] }
[body.piston]
points = { C = [0, 0] }
mass = 0.5
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "B"
points = ["crank.B", "rod.B"]
[[pin]]
name = "C"
points = ["rod.C", "piston.C"]
[[slide]]
name = "guide"
points = ["ground.O", "piston.C"]
axis = [1, 0]
[start]
crank = 0.1
guide = 0.3
)",
                     "scene.toml");
}

TEST_F(EquationsAsCode, SaysWhatCannotBeAssembled) {
  const Scene scene = short_rod();
  Stated of(scene, {"crank"});
  const CompiledC code(of.equations, folder_);
  ASSERT_TRUE(code.is_loaded());
  const auto crank = static_cast<std::size_t>(of.equations.independent[0]);
  const std::vector<double> start = of.state.q;
  const std::string module = has_numpy() ? python_.write(of.equations) : "";
  for (const auto& [angle, status] : {std::pair(0.5, 0), std::pair(0.53, 1), std::pair(1.5, 1), std::pair(-0.52, 0)}) {
    of.state.q[crank] = angle;
    EXPECT_EQ(answer_in_c(code, of, of.state, start).status, status) << angle;
    EXPECT_EQ(answer_in_c(code, of, of.state, start).of_accelerations, status) << angle;
    if (status != 0) {
      EXPECT_EQ(answer_in_c(code, of, of.state, start).q, start);
    }
    if (!module.empty()) python_.ask(module, of, of.state, start);
  }
  if (!module.empty()) {
    const std::vector<Answered> found = python_.answers();
    ASSERT_EQ(found.size(), 4U);
    EXPECT_EQ(found[0].status, 0);
    EXPECT_EQ(found[1].status, 1);
    EXPECT_EQ(found[2].status, 1);
    EXPECT_EQ(found[3].status, 0);
  }
  EXPECT_NE(test::message_of([&] { Stated there(scene, {"crank"}, {asked(scene, "crank", 1.5)}); }), "");
}

// From one end of its range to the other the piston stays on its side, and the rod bends the way it did.
TEST_F(EquationsAsCode, StaysOnTheWayOfAssemblyOfTheGuess) {
  const Scene scene = short_rod();
  Stated of(scene, {"crank"}, {asked(scene, "crank", 0.5)});
  const CompiledC code(of.equations, folder_);
  ASSERT_TRUE(code.is_loaded());
  const auto crank = static_cast<std::size_t>(of.equations.independent[0]);
  const EquationState begin = of.state;
  for (const double angle : {0.3, 0.0, -0.4, -0.52}) {
    of.state.q[crank] = angle;
    const Answered found = answer_in_c(code, of, of.state, begin.q);
    ASSERT_EQ(found.status, 0);
    // x = 0.2 cos a + sqrt(0.01 - 0.04 sin^2 a) of the side on which it began.
    const double x = 0.2 * std::cos(angle) + std::sqrt(0.01 - 0.04 * std::sin(angle) * std::sin(angle));
    bool is_there = false;
    for (int i = 0; i < of.equations.coordinates(); ++i) {
      if (of.equations.is_length(i)) is_there = std::abs(found.q[static_cast<std::size_t>(i)] - x) < 1e-12;
    }
    EXPECT_TRUE(is_there) << angle;
  }
}

TEST(EquationsOfMotion, AreRefusedWhereForcesAreNoFunctionOfPositionAndRate) {
  Scene sticking = read_scene(dataset("double_pendulum.toml"));
  for (Element& element : sticking.elements) {
    if (auto* friction = std::get_if<DryFriction>(&element.law)) friction->width = 0.0;
  }
  const std::string sticks = test::message_of([&] { Stated of(sticking); });
  EXPECT_NE(sticks.find("friction \"shoulder dry\""), std::string::npos) << sticks;
  EXPECT_NE(sticks.find("expected a width above 0"), std::string::npos) << sticks;

  Scene rubbing = read_scene(dataset("double_pendulum.toml"));
  rubbing.joints[0].friction = JointFriction{.coefficient = 0.1, .radius = 0.01};
  const std::string rubs = test::message_of([&] { Stated of(rubbing); });
  EXPECT_NE(rubs.find("pin \"shoulder\".friction"), std::string::npos) << rubs;
}

TEST(EquationsOfMotion, HaveNamesThatCTakes) {
  EXPECT_EQ(name_in_code("datasets/double_pendulum.toml"), "double_pendulum");
  EXPECT_EQ(name_in_code("4-bar linkage.toml"), "m_4_bar_linkage");
  EXPECT_EQ(name_in_code(""), "m_");
}

}  // namespace
}  // namespace poise::equations_of_motion_test
