// Four variants of a scene at once, one in each lane of a scalar: each lane has what double has of it alone.

#include "model/pack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "model/input_error.hpp"
#include "model/laws/laws.hpp"
#include "model/mechanism_impl.hpp"
#include "model/number_list.hpp"
#include "model/numbers.hpp"
#include "model/profile.hpp"
#include "model/spline.hpp"
#include "statics/bodies/body_forces.hpp"
#include "statics/bodies/free_body_equations.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::pack_test {
namespace {

using comparison::Random;

constexpr int lanes = 4;
using Four = Pack<double, lanes>;
using Lanes = std::array<double, lanes>;

Four pack(const Lanes& of) {
  return Four::of_each([&](int l) { return of[l]; });
}

Four drawn(Random& random, double low, double high) {
  return Four::of_each([&](int) { return random.uniform(low, high); });
}

std::vector<double> lane_of_all(const std::vector<Four>& from, int lane) {
  std::vector<double> out;
  for (const Four& one : from) out.push_back(one[lane]);
  return out;
}

std::vector<std::vector<double>> lane_of_all(const std::vector<std::vector<Four>>& from, int lane) {
  std::vector<std::vector<double>> out;
  for (const std::vector<Four>& one : from) out.push_back(lane_of_all(one, lane));
  return out;
}

// To rounding of the largest of what is compared.
constexpr double rounding = 1e-13;

bool agree(double a, double b, double largest) {
  return a == b || (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= rounding * largest;
}

void expect_lanes(const Four& found, const Lanes& expected, const std::string& what) {
  for (int l = 0; l < lanes; ++l) {
    EXPECT_TRUE(agree(found[l], expected[l], std::abs(expected[l])))
        << what << " in lane " << l << ": " << found[l] << ", not " << expected[l];
  }
}

// f of scalars of both kinds: the same in each lane, to the last bit.
template <class F>
void expect_same(F f, const Four& a, const Four& b, const std::string& what) {
  const Four found = f(a, b);
  for (int l = 0; l < lanes; ++l) EXPECT_EQ(found[l], f(a[l], b[l])) << what << " of " << a[l] << ", " << b[l];
}

TEST(Pack, CalculatesLaneByLane) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Four a = drawn(random, 0.1, 3.0), b = drawn(random, -3.0, 3.0);
    expect_same([](const auto& x, const auto& y) { return x + y * x - x / y; }, a, b, "+ - * /");
    expect_same([](const auto& x, const auto& y) { return -y * 2 + 3.0 * x; }, a, b, "numbers");
    expect_same(
        [](auto x, const auto& y) {
          x += y;
          x *= y;
          x -= 2;
          x /= y;
          return x;
        },
        a, b, "+= -= *= /=");
    using namespace std;  // NOLINT: functions of double and of packs by one name
    expect_same([](const auto& x, const auto& y) { return atan2(y, x) + atan(y); }, a, b, "atan2, atan");
    expect_same([](const auto& x, const auto& y) { return sin(y) + cos(y) * tan(x); }, a, b, "sin, cos, tan");
    expect_same([](const auto& x, const auto& y) { return sqrt(x) * abs(y) + floor(y); }, a, b, "sqrt, abs, floor");
    expect_same([](const auto& x, const auto& y) { return exp(y) + log(x) + pow(x, y); }, a, b, "exp, log, pow");
    expect_same([](const auto& x, const auto& y) { return expm1(y) + log1p(x); }, a, b, "expm1, log1p");
    expect_same([](const auto& x, const auto& y) { return sinh(x) + cosh(y) + tanh(y); }, a, b, "sinh, cosh, tanh");
    expect_same([](const auto& x, const auto& y) { return min(x, y) - max(y, x) * x; }, a, b, "min, max");
  }
  EXPECT_TRUE(is_just(Four(2.0), 2.0));
  EXPECT_FALSE(is_just(pack({2.0, 2.0, 2.0, 3.0}), 2.0));
  EXPECT_TRUE(all(Four() == 0.0));
  static_assert(!may_enclose_set<Four> && has_lanes<Four> && !has_lanes<double>);
  static_assert(!std::is_convertible_v<Mask<lanes>, bool> && !std::is_constructible_v<bool, Mask<lanes>>);
}

TEST(Pack, ChoosesLaneByLane) {
  const Four a = pack({-1.0, 2.0, -3.0, 4.0});
  const auto is_below = a < 0.0;
  EXPECT_TRUE(any(is_below) && !all(is_below) && all(is_below || a >= 0.0) && !any(is_below && !(a <= 0.0)));
  expect_lanes(select(is_below, Four(5.0), a), {5.0, 2.0, 5.0, 4.0}, "select");
  expect_lanes(zero_where(is_below, sqrt(a)), {0.0, std::sqrt(2.0), 0.0, 2.0}, "zero_where");
  EXPECT_EQ(select(true, 1.0, 2.0), 1.0);
  EXPECT_EQ(select(false, 1.0, 2.0), 2.0);
  // Only what some lane needs is evaluated.
  int first = 0, second = 0;
  const auto chosen = [&](const auto& condition) {
    return choose(
        condition,
        [&] {
          ++first;
          return Four(1.0);
        },
        [&] {
          ++second;
          return Four(2.0);
        });
  };
  expect_lanes(chosen(is_below), {1.0, 2.0, 1.0, 2.0}, "choose");
  chosen(a < 10.0);
  chosen(true);
  EXPECT_EQ(first, 3);
  EXPECT_EQ(second, 1);
  chosen(a > 10.0);
  EXPECT_EQ(first, 3);
  EXPECT_EQ(second, 2);
  // And each piece once.
  std::vector<std::size_t> pieces;
  const Four out = by_pieces(a, std::array{-2.0, 0.0, 3.0, 9.0}, [&](std::size_t k, const Four& x) {
    pieces.push_back(k);
    return Four(x * static_cast<double>(k));
  });
  expect_lanes(out, {-1.0, 4.0, 0.0, 12.0}, "by_pieces");
  std::sort(pieces.begin(), pieces.end());
  EXPECT_EQ(pieces, (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST(Pack, TakesAnglesAndLengthsLaneByLane) {
  Random random(2);
  for (int k = 0; k < 100; ++k) {
    Planar<Four> v{drawn(random, -1.0, 1.0), drawn(random, -1.0, 1.0)};
    v.x[1] = v.y[1] = 0.0;
    const Four angle = full_angle_of(v), length = length_of(v);
    const Planar<Four> along = unit_or_zero(v);
    for (int l = 0; l < lanes; ++l) {
      const Vec2 one{v.x[l], v.y[l]};
      EXPECT_EQ(angle[l], full_angle_of(one));
      EXPECT_EQ(length[l], length_of(one));
      EXPECT_EQ((Vec2{along.x[l], along.y[l]}), unit_or_zero(one));
    }
  }
}

// --- laws and profiles ----------------------------------------------------------------------------------------------

struct Case {
  Law law;
  Lanes at;  // measures, in different pieces
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (const SpringActs acts : {SpringActs::both, SpringActs::tension, SpringActs::compression}) {
    out.push_back({LinearSpring{3.0, 0.5, acts}, {0.25, 0.75, -1.0, 0.5}});
    out.push_back({BumpStop{80.0, 0.3, 0.02, 3.0, acts}, {0.27, 0.3, 0.31, 0.34}});
  }
  out.push_back({CubicSpring{2.0, 5.0, 0.5}, {0.25, 0.75, -1.0, 0.5}});
  out.push_back({ConstantForce{4.0}, {0.25, -1.0, 0.0, 3.0}});
  out.push_back({PreloadedSpring{40.0, 12.0, 1.5}, {1.0, 2.0, 1.5, 0.0}});
  for (const double n : {1.0, 1.0 + 1e-9, 1.25, 3.0, 9.0}) {
    out.push_back({GasStrut{500.0, 0.5, 0.2, 1.4, n}, {0.25, 0.31, 0.35, 0.55}});
    out.push_back({GasStrut{500.0, 0.5, 0.2, 2.8, n}, {0.45, -0.5, 0.302, 0.55}});
  }
  for (const bool numbered : {true, false}) {
    out.push_back(
        {CurveSpring({-1.0, -0.25, 0.5, 1.0, 2.0}, {-3.0, -0.5, 1.0, 4.0, 3.5}, numbered), {-2.0, 0.25, 1.5, 2.5}});
  }
  out.push_back({Damper{0.5}, {0.25, 0.0, 1.0, -1.0}});
  out.push_back({DryFriction{2.0, 0.25}, {0.25, 0.0, 1.0, -1.0}});
  for (const SpringActs acts : {SpringActs::both, SpringActs::tension, SpringActs::compression}) {
    out.push_back({Damper{0.5, acts}, {0.25, 0.0, 1.0, -1.0}});
    out.push_back({DragDamper{0.5, 2.0, acts}, {0.25, 0.0, 1.0, -1.0}});
  }
  out.push_back({DcMotor{3.0, 20.0}, {0.25, 0.0, 1.0, -1.0}});
  out.push_back({InductionMotor{40.0, 0.2, 150.0}, {0.25, 0.0, 1.0, -1.0}});
  out.push_back({CurveDamper({-1.0, -0.1, 0.5}, {-0.5, -0.25, 2.0}, true), {0.25, 0.0, 1.0, -1.0}});
  for (const auto falls : {DryFriction::Falls::exponential, DryFriction::Falls::hyperbolic}) {
    out.push_back({DryFriction{2.0, 0.25, 3.0, 0.5, 1.5, falls}, {0.25, 0.0, 1.0, -1.0}});
  }
  for (const double n : {1.0, 1.5}) {
    out.push_back({CompliantStop{-0.25, 1.0, 4.0, 0.5, n, true, true}, {-2.0, 0.25, 1.5, 1.0}});
  }
  return out;
}

// All that a law says at a measure and a rate.
template <class S, class L>
std::vector<S> answers(const L& law, const S& g, const S& rate) {
  std::vector<S> out;
  if constexpr (StoresEnergy<L>) {
    const LawForce<S> force = law.at_rest(g);
    out = {law.energy(g), force.value, force.by_measure};
  } else if constexpr (requires { law.respond(ControlSignals<S>{}); }) {
    const ControlOutputs<S> said = law.respond(ControlSignals<S>{g, rate, rate, g, rate});
    out = {said.effort, said.integral, said.filtered, said.unlimited};
  } else {
    const LawForce<S> force = law.resisting(g, rate);
    out = {force.value, force.by_measure, force.by_rate};
  }
  return out;
}

void expect_laws_agree(const Law& law, const std::vector<Lanes>& numbers, const Four& g, const Four& rate) {
  std::visit(
      [&]<class L>(const L& l) {
        std::vector<Four> p;
        for (const Lanes& one : numbers) p.push_back(pack(one));
        const std::vector<Four> found = answers(l.with(p.data()), g, rate);
        for (int lane = 0; lane < lanes; ++lane) {
          std::vector<double> own;
          for (const Lanes& one : numbers) own.push_back(one[lane]);
          const std::vector<double> expected = answers(l.with(own.data()), g[lane], rate[lane]);
          for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_TRUE(agree(found[k][lane], expected[k], std::abs(expected[k])))
                << L::tables[0].key << " " << k << " in lane " << lane << ": " << found[k][lane] << ", not "
                << expected[k];
          }
        }
      },
      law);
}

std::vector<Lanes> varied_numbers_of(const Law& law, Random& random, double by) {
  std::vector<Lanes> out;
  std::visit(
      [&](const auto& l) {
        for (const Number& n : numbers_of_law(l)) {
          const double value = n.get(&l).value();
          out.push_back({});
          for (double& one : out.back()) one = value * (1.0 + by * random.uniform(0.0, 1.0));
        }
      },
      law);
  return out;
}

TEST(Pack, LawsActInEachLaneByItsNumbers) {
  Random random(3);
  for (const Case& one : cases()) {
    for (const double by : {0.0, 0.01, 0.2}) {
      const Four rate = drawn(random, -1.0, 1.0);
      expect_laws_agree(one.law, varied_numbers_of(one.law, random, by), pack(one.at), rate);
    }
  }
  // A curve that rises in some lanes and falls in others; friction that sticks in some.
  const CurveSpring curve({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0, 4.0}, true);
  for (int k = 0; k < 20; ++k) {
    std::vector<Lanes> numbers = varied_numbers_of(curve, random, 0.1);
    for (double& force : numbers[4]) force = random.uniform(-3.0, 6.0);
    expect_laws_agree(curve, numbers, drawn(random, -1.0, 4.0), Four(0.0));
  }
  const std::vector<Lanes> friction{{2.0, 3.0, 0.0, 2.0}, {0.25, 0.0, 0.1, 0.0}};
  expect_laws_agree(DryFriction{2.0, 0.25}, friction, Four(0.0), pack({0.1, -0.2, 0.3, 0.0}));
}

// Value and derivatives of a profile.
template <class S>
std::array<S, 4> parts_of(const ProfileValue<S>& p) {
  return {p.value, p.first, p.second, p.third};
}

TEST(Pack, ProfilesAreFoundInThePieceOfEachLane) {
  Random random(4);
  const std::vector<Profile> profiles{
      Profile(
          {Profile::standard("dwell", 0.0, 0.2, 1.0, 1.0), Profile::standard("harmonic", 0.2, 0.5, 1.0, 2.0),
           Profile::standard("cycloidal", 0.5, 0.8, 2.0, 0.5), Profile::standard("polynomial_345", 0.8, 1.0, 0.5, 3.0)},
          true, 2.0),
      Profile::spline({0.0, 0.3, 0.7, 1.0}, {1.0, 2.0, 0.5, 1.5}, false)};
  for (const Profile& profile : profiles) {
    for (int k = 0; k < 200; ++k) {
      const Four u = drawn(random, -2.5, 2.5);
      const auto found = parts_of(profile.at(u));
      for (int l = 0; l < lanes; ++l) {
        const auto expected = parts_of(profile.at(u[l]));
        for (std::size_t d = 0; d < 4; ++d) EXPECT_TRUE(agree(found[d][l], expected[d], std::abs(expected[d]))) << u[l];
      }
    }
  }
}

// Points and values are other ones in each lane.
TEST(Pack, SplinesAreThoseThroughThePointsOfEachLane) {
  Random random(5);
  for (const bool periodic : {false, true}) {
    std::vector<Four> u{Four(0.0)}, p;
    for (int k = 0; k < 6; ++k) {
      u.push_back(u.back() + drawn(random, 0.5, 1.5));
      p.push_back(drawn(random, -1.0, 1.0));
    }
    p.push_back(periodic ? p.front() : drawn(random, -1.0, 1.0));
    const Spline<Four> all_lanes(u, p, periodic);
    for (int k = 0; k < 200; ++k) {
      const Four at = drawn(random, -3.0, 11.0);
      const auto found = parts_of(all_lanes.at(at));
      for (int l = 0; l < lanes; ++l) {
        const Spline<double> own(lane_of_all(u, l), lane_of_all(p, l), periodic);
        const auto expected = parts_of(own.at(at[l]));
        for (std::size_t d = 0; d < 4; ++d)
          EXPECT_TRUE(agree(found[d][l], expected[d], std::abs(expected[d]))) << at[l];
      }
    }
  }
}

// --- scenes ---------------------------------------------------------------------------------------------------------

// Four variants of a scene, of one structure.
struct Variants {
  NumberList list;
  Layout layout;
  std::array<std::vector<double>, lanes> numbers;
  std::vector<Four> packed;
};

// Every number that statics depends on, by up to a fifth, where its item allows that.
Variants variants_of(const Scene& scene, Random& random) {
  std::vector<Scene> variant(lanes, scene);
  std::vector<ParameterPlace> varying;
  for (const ParameterRow& row : parameter_table(scene)) {
    const std::optional<double> value = value_at(scene, row.place);
    if (!counts_in_statics(row.place.owner) || !value || !std::isfinite(*value) || *value == 0.0) continue;
    varying.push_back(row.place);
    for (Scene& one : variant) {
      const double other = *value * random.uniform(0.8, 1.2);
      if (!contains(row.range, other)) continue;
      try {
        set_value_at(one, row.place, other);
      } catch (const InputError&) {
        continue;  // It contradicts another number of its item.
      }
    }
  }
  Variants out{NumberList(scene), lay_out(scene, Purpose::statics, VaryingNumbers(scene, varying)), {}, {}};
  for (int l = 0; l < lanes; ++l) out.numbers[l] = NumberList(variant[l]).values();
  for (std::size_t k = 0; k < out.list.values().size(); ++k) {
    out.packed.push_back(Four::of_each([&](int l) { return out.numbers[l][k]; }));
  }
  return out;
}

// What a mechanism says in one pose.
template <class T>
struct Said {
  std::vector<T> energy, force, constraint, jacobian, tangent, lower, upper;

  auto parts() const {
    return std::array{std::pair{"energy", &energy},         std::pair{"force", &force},
                      std::pair{"constraint", &constraint}, std::pair{"Jacobian", &jacobian},
                      std::pair{"tangent", &tangent},       std::pair{"lower limits", &lower},
                      std::pair{"upper limits", &upper}};
  }
};

template <class T>
Said<T> said_by(const Mechanism<T>& m, const std::vector<T>& x, const std::vector<T>& y, std::vector<Planar<T>>& pose) {
  Said<T> out;
  pose.resize(m.pose_size());
  m.place(x.data(), pose.data());
  out.energy = {m.energy(x.data(), pose.data())};
  out.force.resize(m.coordinates());
  m.negative_force(x.data(), pose.data(), out.force.data());
  out.constraint.resize(m.constraints());
  m.constraint(x.data(), pose.data(), out.constraint.data());
  out.jacobian.resize(m.jacobian_row().size());
  m.jacobian(pose.data(), out.jacobian.data());
  out.tangent.resize(m.tangent_row().size());
  m.tangent(pose.data(), y.data(), out.tangent.data());
  out.lower = m.lower();
  out.upper = m.upper();
  return out;
}

void expect_lane(const std::vector<Four>& found, int lane, const std::vector<double>& expected,
                 const std::string& what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  double largest = 0.0;
  for (const double one : expected) {
    if (std::isfinite(one)) largest = std::max(largest, std::abs(one));
  }
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_TRUE(agree(found[k][lane], expected[k], largest))
        << what << " " << k << " in lane " << lane << ": " << found[k][lane] << ", not " << expected[k];
  }
}

// The piece of a law that a measure is in.
std::size_t piece_of(const Law& law, double g) {
  if (const auto* strut = std::get_if<GasStrut>(&law)) {
    const double y = (strut->length - g) / strut->stroke;
    return y <= 0.0 ? 0 : y <= 1.0 ? 1 : 2;
  }
  if (const auto* spring = std::get_if<CurveSpring>(&law)) {
    const auto x = spring->curve().x();
    return static_cast<std::size_t>(std::lower_bound(x.begin(), x.end(), g - spring->shift) - x.begin());
  }
  return is_slack(law, g) ? 1 : 0;
}

struct Compared {
  int scenes = 0;
  int split_laws = 0;                   // of which lanes are in different pieces
  int values = 0, finite = 0, own = 0;  // own: unlike that of the first lane
};

void count(const std::vector<Four>& found, int lane, const std::vector<double>& expected, Compared& compared) {
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ++compared.values;
    compared.finite += std::isfinite(expected[k]) ? 1 : 0;
    compared.own += found[k][lane] != found[k][0] ? 1 : 0;
  }
}

// What bodies cut free say: loads and elements summed up on each body, unit efforts of joints and stops, measures.
template <class T>
std::vector<std::vector<T>> said_by_bodies(const Numbers<T>& numbers, const std::vector<BodyPose<T>>& poses) {
  const Scene& scene = numbers.scene();
  const BodyForces<BodyPose<T>, Numbers<T>> bodies(numbers, poses);
  FreeBodyEquations<BodyPose<T>, Numbers<T>> equations(bodies, poses, 1.0);
  std::vector<T> loads(static_cast<std::size_t>(equations.rows()), T(0)), measures;
  const auto push = [&](int body, const Planar<T>& at, const Planar<T>& force, const T& moment) {
    if (body == 0) return;
    const std::size_t row = 3 * (static_cast<std::size_t>(body) - 1);
    loads[row] += force.x;
    loads[row + 1] += force.y;
    loads[row + 2] += equations.turning(body, at, force, moment);
  };
  equations.push_loads(push);
  std::vector<T> forces = equations.push_elements(push);
  equations.add_joints();
  for (int s = 0; s < static_cast<int>(scene.stops.size()); ++s) {
    equations.add_stop(s, 2, T(1));
    measures.push_back(bodies.value(scene.stops[s].on, s));
    measures.push_back(bodies.overrun(s, true));
  }
  for (const Element& element : scene.elements) measures.push_back(bodies.value(element.on));
  std::vector<std::vector<T>> out{loads, forces, measures, {bodies.energy()}};
  // Of each item the columns of its unknowns: a distance of zero has none.
  constexpr std::size_t most_unknowns = 3;
  const std::size_t first = out.size();
  out.resize(first + most_unknowns * equations.items().size(), std::vector<T>(loads.size(), T(0)));
  std::vector<std::size_t> known(equations.items().size(), 0);
  for (const auto& unknown : equations.unknowns()) {
    const auto item = static_cast<std::size_t>(unknown.item);
    std::vector<T>& column = out[first + most_unknowns * item + known[item]++];
    equations.for_each_entry(unknown, [&](int row, const T& value) { column[row] += value; });
  }
  return out;
}

// A scene compiled in lanes, and each lane by itself.
struct Compiled {
  Compiled(const Scene& of, Variants variants_of_it)
      : scene(of),
        variants(std::move(variants_of_it)),
        four(scene, variants.layout, Purpose::statics),
        numbers(variants.list, variants.packed.data()),
        own(lanes, Mechanism<double>(scene, variants.layout, Purpose::statics)) {
    four.set_numbers(numbers);
    for (int l = 0; l < lanes; ++l) {
      own_numbers.emplace_back(variants.list, variants.numbers[l].data());
      own[l].set_numbers(own_numbers[l]);
    }
  }
  Compiled(const Compiled&) = delete;
  Compiled& operator=(const Compiled&) = delete;

  Scene scene;
  Variants variants;
  Mechanism<Four> four;
  Numbers<Four> numbers;
  std::vector<Mechanism<double>> own;
  std::vector<Numbers<double>> own_numbers;
};

void compare_at(const Compiled& compiled, const std::vector<Four>& x, Random& random, Compared& compared) {
  const Mechanism<Four>& four = compiled.four;
  const std::string& title = compiled.scene.title;
  std::vector<Four> y;
  for (int r = 0; r < four.constraints(); ++r) y.push_back(drawn(random, -1.0, 1.0));
  std::vector<Planar<Four>> pose;
  const Said<Four> found = said_by(four, x, y, pose);
  const auto found_parts = found.parts();
  const std::vector<std::vector<Four>> by_bodies = said_by_bodies(compiled.numbers, four.poses(x.data()));
  std::vector<std::vector<std::size_t>> pieces(lanes);
  for (int l = 0; l < lanes; ++l) {
    const Mechanism<double>& own = compiled.own[l];
    const std::vector<double> own_x = lane_of_all(x, l), own_y = lane_of_all(y, l);
    std::vector<Vec2> own_pose;
    const Said<double> expected = said_by(own, own_x, own_y, own_pose);
    const auto expected_parts = expected.parts();
    for (std::size_t k = 0; k < expected_parts.size(); ++k) {
      const std::vector<double>& values = *expected_parts[k].second;
      expect_lane(*found_parts[k].second, l, values, title + ": " + expected_parts[k].first);
      if (testing::Test::HasFatalFailure()) return;
      count(*found_parts[k].second, l, values, compared);
    }
    for (int e = 0; e < own.elements(); ++e) {
      pieces[l].push_back(piece_of(own.law_of(e), own.measure_of(e, own_pose.data())));
    }
    const auto own_bodies = said_by_bodies(compiled.own_numbers[l], own.poses(own_x.data()));
    ASSERT_EQ(by_bodies.size(), own_bodies.size()) << title;
    for (std::size_t k = 0; k < own_bodies.size(); ++k) {
      expect_lane(by_bodies[k], l, own_bodies[k], title + ": bodies, part " + std::to_string(k));
      if (testing::Test::HasFatalFailure()) return;
      count(by_bodies[k], l, own_bodies[k], compared);
    }
  }
  for (std::size_t e = 0; e < pieces[0].size(); ++e) {
    const bool is_split =
        std::any_of(pieces.begin(), pieces.end(), [&](const auto& of_lane) { return of_lane[e] != pieces[0][e]; });
    compared.split_laws += is_split ? 1 : 0;
  }
}

void compare(const Scene& scene, Random& random, Compared& compared) {
  const Compiled compiled(scene, variants_of(scene, random));
  const Layout& layout = compiled.variants.layout;
  ++compared.scenes;
  for (const double reach : {0.02, 0.2, 1.0}) {
    std::vector<Four> x = compiled.four.start();
    for (std::size_t t = 0; t < x.size(); ++t) {
      x[t] += (layout.is_length(static_cast<int>(t)) ? layout.size : 1.0) * drawn(random, -reach, reach);
    }
    compare_at(compiled, x, random, compared);
    if (testing::Test::HasFatalFailure()) return;
  }
}

// Most numbers are finite, and not the same in all lanes.
void expect_lanes_of_their_own(const Compared& compared) {
  EXPECT_GE(compared.finite, 0.95 * compared.values);
  EXPECT_GE(compared.own, 0.05 * compared.values);
}

TEST(Pack, ScenesOfDatasetsAreEvaluatedInLanes) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::dataset(""))) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  Random random(20261129);
  Compared compared;
  for (const std::filesystem::path& file : files) {
    std::optional<Scene> scene;
    try {
      scene = at_time(read_scene(file), 0.0);
    } catch (const InputError&) {
      continue;  // an experiment, say
    }
    if (scene->bodies.size() > 30) continue;
    compare(*scene, random, compared);
    if (HasFatalFailure()) FAIL() << file;
  }
  EXPECT_GE(compared.scenes, 40);
  EXPECT_GE(compared.split_laws, 10);
  expect_lanes_of_their_own(compared);
}

TEST(Pack, RandomMechanismsAreEvaluatedInLanes) {
  Random random(20261130);
  Compared compared;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 4 == 0,
                          .stops = seed % 2 == 0,
                          .other_laws = seed % 3 != 1,
                          .couplings = seed % 5 > 2};
    compare(test::plant_mechanism(seed, wish).in_equilibrium, random, compared);
    if (HasFatalFailure()) FAIL() << seed;
  }
  EXPECT_GE(compared.split_laws, 300);
  expect_lanes_of_their_own(compared);
}

// A measure with all derivatives that motion takes of it: at q[0] along q[1], q[2] and q[3].
template <class T>
std::vector<T> derivatives(const Scene& scene, const Layout& layout, const Measure& measure,
                           const std::vector<std::vector<T>>& q) {
  const Phasors<T> phasors(layout, true);
  const CompiledMeasure<T> g(scene, layout, phasors, measure);
  std::vector<Planar<T>> pose(phasors.pose_size()), scratch(g.scratch_size());
  phasors.place(q[0].data(), pose.data());
  const Configuration<T> at{phasors, pose.data(), scratch.data()};
  const T *u = q[1].data(), *v = q[2].data(), *w = q[3].data();
  std::vector<T> out{g.value(at), g.along(at, u), g.second(at, u, v), g.third(at, u, v, w)}, bend(q[0].size(), T(0));
  g.add_bend(at, u, T(2), bend.data());
  out.insert(out.end(), bend.begin(), bend.end());
  return out;
}

// In one lane a point lies on another, so that their distance, and a part of a rope, have no direction there.
TEST(Pack, PointsMayCoincideInSomeLanes) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.gravity = {0.0, -9.81};
  const PointRef eye = scene.add_point(0, "E", {1.0, 0.0}), first = test::point(scene, "1.b"),
                 second = test::point(scene, "2.b");
  const Measure distance = Measure::distance_between(eye, first);
  const Measure rope = Measure::rope_over({{eye}, {first}, {second}});
  scene.elements = {{"spring", "s", distance, LinearSpring{3.0, 0.25}},
                    {"spring", "t", distance, LinearSpring{3.0, 0.25, SpringActs::tension}},
                    {"constant_force", "f", distance, ConstantForce{2.0}},
                    {"spring", "r", rope, LinearSpring{5.0, 0.5}}};
  test::add_stop(scene, "stop", distance, 0.0, 0.5);
  test::add_stop(scene, "rope", rope, 0.0, 1.5);
  Random random(6);
  Compared compared;
  const Compiled compiled(scene, variants_of(scene, random));
  for (const Four& angle : {pack({0.0, 0.25, -0.5, 0.0}), Four(0.0), pack({0.01, 0.0, 1.5, 3.0})}) {
    Variants alike{NumberList(scene), compiled.variants.layout, {}, {}};
    for (auto& of_lane : alike.numbers) of_lane = alike.list.values();
    alike.packed.assign(alike.list.values().begin(), alike.list.values().end());
    compare_at(Compiled(scene, std::move(alike)), {angle, drawn(random, -1.0, 1.0)}, random, compared);
    compare_at(compiled, {angle, drawn(random, -1.0, 1.0)}, random, compared);
    for (const Measure& measure : {distance, rope}) {
      std::vector<std::vector<Four>> q{{angle, drawn(random, -1.0, 1.0)}};
      for (int k = 0; k < 3; ++k) q.push_back({drawn(random, -1.0, 1.0), drawn(random, -1.0, 1.0)});
      const Layout layout = lay_out(scene, Purpose::statics);
      const std::vector<Four> found = derivatives(scene, layout, measure, q);
      for (int l = 0; l < lanes; ++l) {
        expect_lane(found, l, derivatives(scene, layout, measure, lane_of_all(q, l)), "derivatives");
      }
    }
    if (HasFatalFailure()) return;
  }
}

TEST(Pack, MeasuresHaveTheirDerivativesInLanes) {
  int measures = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Scene scene = test::plant_mechanism(seed, {.loops = static_cast<int>(seed % 3)}).in_equilibrium;
    const std::vector<test::NamedMeasure> named = test::measures_of(scene, random, true);
    const Layout layout = lay_out(scene, Purpose::dynamics);
    const auto n = static_cast<std::size_t>(layout.kept);
    for (const auto& [name, measure] : named) {
      std::vector<std::vector<Four>> q(4);
      for (std::size_t t = 0; t < n; ++t) {
        q[0].push_back(layout.coordinates[t].start + drawn(random, -0.5, 0.5));
        for (std::size_t k = 1; k < q.size(); ++k) q[k].push_back(drawn(random, -1.0, 1.0));
      }
      const std::vector<Four> found = derivatives(scene, layout, measure, q);
      for (int l = 0; l < lanes; ++l) {
        expect_lane(found, l, derivatives(scene, layout, measure, lane_of_all(q, l)), name);
        if (HasFatalFailure()) return;
      }
      ++measures;
    }
  }
  EXPECT_GE(measures, 150);
}

}  // namespace
}  // namespace poise::pack_test
