// Random functions of time, against values that are computed apart from Poise, and motions of random mechanisms under
// them, body by body. `make campaign TESTS=RandomFunctions` draws others.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/simulate.hpp"
#include "statics/model/static_model.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/seed.hpp"

namespace poise::random_functions_of_time_test {
namespace {

using test::Random;

/// A function as a scene file has it, and its value by other formulas.
struct Drawn {
  std::string text;
  std::function<double(double t)> value;
};

/// The way of a law at s, by integrating its jerk over stretches of constant jerk that begin with these accelerations.
double way_at(const std::string& law, double s) {
  if (law == "linear") return s;
  if (law == "polynomial_345") return s * s * s * (10 - 15 * s + 6 * s * s);
  struct Stretch {
    double length, acceleration, jerk;
  };
  std::vector<Stretch> stretches;
  if (law == "cubic") stretches = {{1, 1, -2}};
  if (law == "trapezoidal") stretches = {{1.0 / 3, 1, 0}, {1.0 / 3, 0, 0}, {1.0 / 3, -1, 0}};
  if (law == "s_curve") {
    stretches = {{1.0 / 6, 0, 6}, {1.0 / 6, 1, -6}, {1.0 / 3, 0, 0}, {1.0 / 6, 0, -6}, {1.0 / 6, -1, 6}};
  }
  const auto place = [&](double end) {
    double x = 0, v = 0;
    for (const Stretch& one : stretches) {
      const double h = std::min(one.length, end);
      x += h * (v + h * (one.acceleration / 2 + h * one.jerk / 6));
      v += h * (one.acceleration + h * one.jerk / 2);
      end -= h;
    }
    return x;
  };
  return place(s) / place(1.0);
}

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : random_(seed) {}

  /// The numbers that formulas use, in [numbers].
  static constexpr const char* named = "[numbers]\na = 0.7\nb = 1.9\n";

  Drawn draw(int depth) {
    const int kind = integer(0, depth > 0 ? 7 : 4);
    switch (kind) {
      case 0:
        return sine();
      case 1:
        return ramp();
      case 2:
        return table();
      case 3:
        return formula();
      case 4:
        return step();
      case 5:
        return pieces(depth);
      default:
        return several(kind == 6, depth);
    }
  }

 private:
  double between(double a, double b) { return random_.uniform(a, b); }
  int integer(int least, int most) { return least + random_.index(static_cast<std::size_t>(most - least + 1)); }

  Drawn sine() {
    const double a = between(-2, 2), f = between(0.1, 2), p = between(-3, 3), o = between(-1, 1);
    return {fmt::format("{{ sine = {{ amplitude = {}, frequency = {}, phase = {}, offset = {} }} }}", a, f, p, o),
            [=](double t) { return o + a * std::sin(2 * std::numbers::pi * f * t + p); }};
  }

  std::string law() {
    static const std::vector<std::string> laws{"linear", "cubic", "trapezoidal", "s_curve", "polynomial_345"};
    return laws[static_cast<std::size_t>(integer(0, 4))];
  }

  Drawn ramp() {
    const double from = between(-2, 2), to = between(-2, 2), start = between(-0.5, 1), end = start + between(0.2, 1.5);
    const std::string way = law();
    return {fmt::format("{{ ramp = {{ from = {}, to = {}, start = {}, end = {}, law = \"{}\" }} }}", from, to, start,
                        end, way),
            [=](double t) {
              return t < start ? from : t >= end ? to : from + (to - from) * way_at(way, (t - start) / (end - start));
            }};
  }

  Drawn table() {
    std::vector<double> t{between(-0.3, 0.3)}, c{between(-2, 2)};
    std::vector<std::string> points{fmt::format("[{}, {}]", t[0], c[0])};
    for (int k = integer(1, 4); k > 0; --k) {
      t.push_back(t.back() + between(0.2, 0.8));
      c.push_back(between(-2, 2));
      points.push_back(fmt::format("[{}, {}]", t.back(), c.back()));
    }
    const std::string way = law();
    return {fmt::format("{{ table = [{}], interpolation = \"{}\" }}", fmt::join(points, ", "), way), [=](double at) {
              if (at < t.front()) return c.front();
              if (at >= t.back()) return c.back();
              const auto next = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), at) - t.begin());
              const double s = (at - t[next - 1]) / (t[next] - t[next - 1]);
              return c[next - 1] + (c[next] - c[next - 1]) * way_at(way, s);
            }};
  }

  Drawn formula() {
    constexpr double a = 0.7, b = 1.9;
    const double k = between(-1.5, 1.5);
    switch (integer(0, 3)) {
      case 0:
        return {fmt::format("{{ function = \"{}*(1 - cos(2*pi*t/b))*exp(-a*t)\" }}", k),
                [=](double t) { return k * (1 - std::cos(2 * std::numbers::pi * t / b)) * std::exp(-a * t); }};
      case 1:
        return {fmt::format("{{ function = \"a*t^2 - {}*t + sqrt(b + t)\" }}", k),
                [=](double t) { return a * t * t - k * t + std::sqrt(b + t); }};
      case 2:
        return {fmt::format("{{ function = \"{}*atan(b*(t - a)) + hypot(t, b)\" }}", k),
                [=](double t) { return k * std::atan(b * (t - a)) + std::hypot(t, b); }};
      default:
        return {fmt::format("{{ function = \"(1 + t)^b/(a + {})\" }}", std::abs(k)),
                [=](double t) { return std::pow(1 + t, b) / (a + std::abs(k)); }};
    }
  }

  Drawn step() {
    const double at = between(0.1, 1.5), from = between(-1, 1), to = between(-1, 1);
    return {fmt::format("{{ step = {{ at = {}, from = {}, to = {} }} }}", at, from, to),
            [=](double t) { return t < at ? from : to; }};
  }

  Drawn pieces(int depth) {
    std::vector<Drawn> parts;
    std::vector<double> until;
    std::string text;
    const int count = integer(2, 4);
    for (int k = 0; k < count; ++k) {
      parts.push_back(draw(depth - 1));
      const bool is_last = k + 1 == count;
      if (!is_last) until.push_back((until.empty() ? 0.0 : until.back()) + between(0.15, 0.7));
      text +=
          (k > 0 ? ", " : "") +
          (is_last ? parts.back().text : fmt::format("{{ until = {},{}", until.back(), parts.back().text.substr(1)));
    }
    return {"{ piecewise = [" + text + "] }", [=](double t) {
              std::size_t k = 0;
              while (k < until.size() && t >= until[k]) ++k;
              return parts[k].value(t);
            }};
  }

  Drawn several(bool is_sum, int depth) {
    std::vector<Drawn> parts;
    std::string text;
    for (int k = integer(2, 3); k > 0; --k) {
      parts.push_back(draw(depth - 1));
      text += (text.empty() ? "" : ", ") + parts.back().text;
    }
    return {std::string(is_sum ? "{ sum = [" : "{ product = [") + text + "] }", [=](double t) {
              double out = is_sum ? 0.0 : 1.0;
              for (const Drawn& one : parts) out = is_sum ? out + one.value(t) : out * one.value(t);
              return out;
            }};
  }

  Random random_;
};

Scene scene_of(const std::string& time) {
  return parse_scene(std::string(Generator::named) + R"(
[ground.points]
O = [0, 0]
[body.block]
mass = 2
[body.block.points]
c = [0, 0]
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[force]]
name = "F"
at = "block.c"
vector = [3, 0]
time = )" + time + "\n",
                     "random.toml");
}

/// Whether a formula meets another within h of t.
bool is_near_break(const TimeFunction& f, double t, double h) {
  const std::vector<double> breaks = f.breaks();
  return std::any_of(breaks.begin(), breaks.end(), [&](double at) { return std::abs(at - t) < h; });
}

TEST(RandomFunctions, HaveTheValuesAndDerivativesOfTheirText) {
  constexpr double h = 1e-3, finer = 2e-4;
  int derived = 0;
  const int cases = test::cases(150, 2000);
  for (int i = 0; i < cases; ++i) {
    Generator generator(test::seed(static_cast<std::uint64_t>(1 + i)));
    const Drawn drawn = generator.draw(3);
    SCOPED_TRACE(drawn.text);
    Scene scene = scene_of(drawn.text);
    const TimeFunction& f = scene.time_functions.at(0);
    Random random(static_cast<std::uint64_t>(i));
    for (int k = 0; k < 6; ++k) {
      const double t = random.uniform(0.0, 2.0);
      const double value = drawn.value(t);
      EXPECT_NEAR(f.at(t), value, 1e-12 * (1 + std::abs(value))) << t;
      if (is_near_break(f, t, 3 * h)) continue;
      const auto at = [&](int steps) { return drawn.value(t + steps * h); };
      const double slope = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
      const double bend = (16 * (at(1) + at(-1)) - (at(2) + at(-2)) - 30 * value) / (12 * h * h);
      EXPECT_NEAR(f.at(t, 1), slope, 1e-7 * (1 + std::abs(slope) + std::abs(bend))) << t;
      EXPECT_NEAR(f.at(t, 2), bend, 1e-5 * (1 + std::abs(value) + std::abs(slope) + std::abs(bend))) << t;
      for (const ParameterRow& row : parameter_table(scene)) {
        if (row.place.owner != Owner::time) continue;
        const int number = row.place.number;
        const auto moved = [&](double by, int derivative) {
          TimeFunction other = f;
          other.set_among_others(number, value_at(scene, row.place).value() + by);
          return other.at(t, derivative, t);
        };
        for (int d = 0; d <= 2; ++d) {
          const double by =
              (8 * (moved(finer, d) - moved(-finer, d)) - (moved(2 * finer, d) - moved(-2 * finer, d))) / (12 * finer);
          EXPECT_NEAR(f.by(number, t, d, t), by, 1e-6 * (1 + std::abs(by)) * (d == 2 ? 100 : 1))
              << row.path.text() << " " << t << " " << d;
          ++derived;
        }
      }
    }
    // Continuous as far as it says, at all its breaks.
    for (const double t : f.breaks()) {
      for (int d = 0; d <= f.law.smoothness(); ++d) {
        const double before = f.at(t, d, std::nextafter(t, -10.0)), after = f.at(t, d, t);
        EXPECT_NEAR(before, after, 1e-8 * (1 + std::abs(before))) << t << " " << d;
      }
    }
  }
  EXPECT_GT(derived, 10 * cases);
}

// Each body is in balance under what acts at the time, with its inertia: vector mechanics without the equations of
// motion. Loads, springs and the frame follow functions.
TEST(RandomFunctions, MoveRandomMechanismsInBalance) {
  int moved = 0, checked = 0;
  const int cases = test::cases(24, 300);
  for (int i = 0; i < cases; ++i) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(7000 + i));
    SCOPED_TRACE(seed);
    test::Wish wish;
    wish.loops = static_cast<int>(seed % 3);
    wish.followers = seed % 5 == 0;
    Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
      scene.bodies[b].mass += 0.5;
      scene.bodies[b].inertia += 0.1;
    }
    Generator generator(seed);
    const auto add = [&](TimeFunction::Of of, std::size_t item, int part, int order) {
      TimeFunction function = scene_of(generator.draw(2).text).time_functions.at(0);
      if (of == TimeFunction::Of::frame && function.law.smoothness() < order) return;
      function.of = of;
      function.item = static_cast<int>(item);
      function.part = part;
      function.order = order;
      scene.time_functions.push_back(std::move(function));
    };
    for (std::size_t f = 0; f < scene.forces.size(); ++f) add(TimeFunction::Of::force, f, 0, 0);
    for (std::size_t t = 0; t < scene.torques.size(); ++t) add(TimeFunction::Of::torque, t, 0, 0);
    for (std::size_t e = 0; e < scene.elements.size(); ++e) {
      if (std::holds_alternative<LinearSpring>(scene.elements[e].law)) add(TimeFunction::Of::element, e, 0, 0);
    }
    for (const int axis : {0, 1}) add(TimeFunction::Of::frame, 0, axis, static_cast<int>(seed % 3));
    const MotionModel model(scene);
    MotionOptions options;
    options.accuracy = 1e-10;
    options.most_steps = 20000;
    const Motion motion = simulate(model, test::released(model, {}), options);
    if (!motion.completed()) continue;
    ++moved;
    // A spring that is made to push apart lets go without bound, until all is rounding.
    const double largest = *std::max_element(motion.kinetic.begin(), motion.kinetic.end());
    if (largest > 1e6) continue;
    EXPECT_LT(motion.energy_error, 1e-5);
    for (std::size_t node = 0; node < motion.trajectory.nodes(); node += 7) {
      const double t = motion.trajectory.t[node];
      const bool is_at_break = std::any_of(scene.time_functions.begin(), scene.time_functions.end(),
                                           [&](const TimeFunction& one) { return is_near_break(one, t, 1e-9); });
      if (is_at_break) continue;
      const MotionModel then(at_time(scene, t), model.scales(), loads_in_time(scene));
      const auto n = static_cast<std::ptrdiff_t>(motion.trajectory.coordinates);
      const auto at = [&](const std::vector<double>& all) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(node) * n;
        return then.from_si({first, first + n});
      };
      const Forces forces =
          forces_of(then, at(motion.trajectory.q), at(motion.trajectory.v), at(motion.trajectory.a), {});
      EXPECT_TRUE(forces.balanced) << t << ": " << forces.worst_body << " by " << forces.imbalance << " of "
                                   << forces.largest_force;
      EXPECT_LT(forces.work_error, 1e-9) << t;
      ++checked;
    }
  }
  EXPECT_GT(moved, cases * 3 / 4);
  EXPECT_GT(checked, 10 * cases / 4);
}

}  // namespace
}  // namespace poise::random_functions_of_time_test
