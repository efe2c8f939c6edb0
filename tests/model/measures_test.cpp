// Every kind of measure against the places of the bodies, and its derivatives against differences in 50 digits.

#include "model/measures/measures.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/mechanism.hpp"
#include "solvers/real50.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::measures_test {
namespace {

using test::measures_of;
using test::NamedMeasure;
using test::Random;

enum class Of { itself, half_its_square };

// A measure, or half the square of a distance, compiled in T, in a configuration of its own.
template <class T>
class Placed {
 public:
  Placed(const Scene& scene, const Layout& layout, const Measure& measure, Of of = Of::itself)
      : phasors_(layout, true),
        g_(of == Of::itself ? CompiledMeasure<T>(scene, layout, phasors_, measure)
                            : CompiledMeasure<T>::half_square(scene, layout, phasors_, measure)),
        pose_(phasors_.pose_size()),
        scratch_(g_.scratch_size() + 1) {}

  // The last of the scratch is not the measure's to write on.
  ~Placed() { EXPECT_EQ(scratch_.back(), Planar<T>{}); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

  int coordinates() const { return phasors_.coordinates(); }
  const CompiledMeasure<T>& g() const { return g_; }
  Configuration<T> at(const std::vector<T>& q) {
    phasors_.place(q.data(), pose_.data());
    return {phasors_, pose_.data(), scratch_.data()};
  }

  T value(const std::vector<T>& q) { return g_.value(at(q)); }
  T first(const std::vector<T>& q, const std::vector<T>& u) { return g_.along(at(q), u.data()); }
  T second(const std::vector<T>& q, const std::vector<T>& u, const std::vector<T>& v) {
    return g_.second(at(q), u.data(), v.data());
  }
  T third(const std::vector<T>& q, const std::vector<T>& u, const std::vector<T>& v, const std::vector<T>& w) {
    return g_.third(at(q), u.data(), v.data(), w.data());
  }
  // D2g[u, .] by bend().
  std::vector<T> bend(const std::vector<T>& q, const std::vector<T>& u) {
    std::vector<T> out(q.size(), T(0));
    g_.add_bend(at(q), u.data(), T(1), out.data());
    return out;
  }
  // u^T (force D2g + slope Dg Dg^T) v by curvature().
  T curvature(const std::vector<T>& q, const T& force, const T& slope, const std::vector<T>& u,
              const std::vector<T>& v) {
    T sum(0);
    g_.curvature(at(q), force, slope, [&](int i, int j, const T& value) {
      ASSERT_GE(i, j);
      const int a = g_.support()[i];
      const int b = g_.support()[j];
      sum += value * (a == b ? T(u[a] * v[a]) : T(u[a] * v[b] + u[b] * v[a]));
    });
    return sum;
  }

 private:
  Phasors<T> phasors_;
  CompiledMeasure<T> g_;
  std::vector<Planar<T>> pose_, scratch_;
};

// Of random mechanisms, every other one with all of its coordinates: statics leaves some at their start values.
void for_measures(const std::function<void(const Scene&, const Layout&, const Measure&, const std::vector<double>& q,
                                           Random&)>& expect) {
  constexpr int all = static_cast<int>(Measure::Kind::sum) + 1;
  int kinds[all] = {};
  for (int loops = 1; loops <= 4; ++loops) {
    for (int k = 0; k < 4; ++k) {
      const auto seed = static_cast<std::uint64_t>(100 * loops + k);
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      Scene scene = test::plant_mechanism(seed, {.loops = loops}).in_equilibrium;
      const std::vector<NamedMeasure> measures = measures_of(scene, random, true);
      const Purpose purpose = k % 2 == 0 ? Purpose::statics : Purpose::dynamics;
      const Mechanism<double> mechanism(scene, purpose);
      std::vector<double> q = mechanism.start();
      for (double& value : q) value += random.uniform(-1.0, 1.0);
      for (const auto& [name, measure] : measures) {
        SCOPED_TRACE(name);
        ++kinds[static_cast<int>(measure.kind)];
        expect(scene, mechanism.layout(), measure, q, random);
      }
    }
  }
  for (int kind = 0; kind < all; ++kind) {
    // The slip on a cam needs a cam that is touched: RubbingCam has its derivatives.
    if (kind == static_cast<int>(Measure::Kind::slip_on_cam)) continue;
    EXPECT_GT(kinds[kind], 8) << kind;
  }
}

bool has_travel(const Measure& measure) {
  return measure.kind == Measure::Kind::travel ||
         std::any_of(measure.terms.begin(), measure.terms.end(),
                     [](const Measure::Term& term) { return has_travel(term.measure); });
}

TEST(Measures, AreWhatThePlacesOfTheBodiesSay) {
  for_measures([](const Scene& scene, const Layout& layout, const Measure& measure, const std::vector<double>& q,
                  Random&) {
    // Travels of joints that close a loop are theirs only where the loop closes.
    if (has_travel(measure) && !layout.closures.empty()) return;
    const Mechanism<double> mechanism(scene, layout, Purpose::dynamics);
    Placed<double> placed(scene, layout, measure);
    EXPECT_NEAR(placed.value(q), test::measured(scene, measure, mechanism.poses(q.data())), 1e-12 * (1 + layout.size));
  });
}

TEST(Measures, AreWhatThePlacesOfTheBodiesSayWhereLoopsClose) {
  for (int loops = 0; loops <= 4; ++loops) {
    for (int k = 0; k < 8; ++k) {
      const auto seed = static_cast<std::uint64_t>(200 * (loops + 1) + k);
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(seed);
      const test::PlantedMechanism planted = test::plant_mechanism(seed, {.loops = loops});
      Scene scene = planted.in_equilibrium;
      const std::vector<NamedMeasure> measures = measures_of(scene, random, true);
      const Mechanism<double> mechanism(scene);
      ASSERT_EQ(mechanism.coordinates(), static_cast<int>(planted.equilibrium.size()));
      for (const auto& [name, measure] : measures) {
        SCOPED_TRACE(name);
        Placed<double> placed(scene, mechanism.layout(), measure);
        EXPECT_NEAR(placed.value(planted.equilibrium),
                    test::measured(scene, measure, mechanism.poses(planted.equilibrium.data())),
                    1e-12 * (1 + mechanism.layout().size));
      }
    }
  }
}

using Real = Real50;
using Values = std::vector<Real>;

Values in_50_digits(const std::vector<double>& values) { return {values.begin(), values.end()}; }

Values direction(std::size_t n, Random& random) {
  Values u(n);
  for (Real& value : u) value = random.uniform(-1.0, 1.0);
  return u;
}

Values moved(const Values& q, const Real& by, const Values& u) {
  Values out = q;
  for (std::size_t i = 0; i < q.size(); ++i) out[i] += by * u[i];
  return out;
}

Real dot(const Values& a, const Values& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// All derivatives by central differences of the value alone, of second order in steps of 1e-10: along u, along u and v,
// and along u, v and w.
struct Differences {
  Real first, second, third;

  Differences(Placed<Real>& g, const Values& q, const Values& u, const Values& v, const Values& w) {
    const Real h = Real(1e-10);
    const auto up_down = [&](const Values& along, const auto& f) {
      return [&, f](const Values& at) -> Real { return (f(moved(at, h, along)) - f(moved(at, -h, along))) / (2 * h); };
    };
    const auto value = [&](const Values& at) -> Real { return g.value(at); };
    const auto by_u = up_down(u, value);
    const auto by_u_v = up_down(v, by_u);
    const auto by_u_v_w = up_down(w, by_u_v);
    first = by_u(q);
    second = by_u_v(q);
    third = by_u_v_w(q);
  }
};

void expect_same(const Real& found, const Real& expected, const char* what, double tolerance = 1e-15) {
  EXPECT_LT(static_cast<double>(abs(found - expected)), tolerance * (1 + static_cast<double>(abs(expected)))) << what;
}

void expect_derivatives(const Scene& scene, const Layout& layout, const Measure& measure, const Values& q,
                        Random& random, Of of = Of::itself) {
  Placed<Real> g(scene, layout, measure, of);
  ASSERT_EQ(static_cast<std::size_t>(g.coordinates()), q.size());
  const Values u = direction(q.size(), random);
  const Values v = direction(q.size(), random);
  const Values w = direction(q.size(), random);
  const Differences known(g, q, u, v, w);
  expect_same(g.first(q, u), known.first, "gradient");
  expect_same(g.second(q, u, v), known.second, "second");
  expect_same(g.second(q, v, u), known.second, "second, exchanged");
  expect_same(g.third(q, u, v, w), known.third, "third");
  expect_same(g.third(q, w, u, v), known.third, "third, exchanged");
  expect_same(dot(g.bend(q, u), v), known.second, "bend");
  Values gradient(q.size(), Real(0));
  g.g().add_gradient(g.at(q), Real(-2), gradient.data());
  expect_same(dot(gradient, u), -2 * known.first, "add_gradient");
  const Real by_v = g.first(q, v);
  for (const Real& force : {Real(0), Real(1.5)}) {
    for (const Real& slope : {Real(0), Real(-0.75)}) {
      expect_same(g.curvature(q, force, slope, u, v), force * known.second + slope * known.first * by_v, "curvature");
    }
  }
}

TEST(Measures, KnowTheirDerivatives) {
  for_measures([](const Scene& scene, const Layout& layout, const Measure& measure, const std::vector<double>& q,
                  Random& random) { expect_derivatives(scene, layout, measure, in_50_digits(q), random); });
}

TEST(Measures, KnowTheirDerivativesOnARailThatTurns) {
  Random random(5);
  Scene scene = test::quick_return();
  const std::vector<NamedMeasure> measures = measures_of(scene, random, true);
  const Layout layout = lay_out(scene, Purpose::dynamics);
  const Coordinate& rail = layout.coordinates[layout.travel[3]];
  ASSERT_EQ(rail.kind, Coordinate::Kind::length);
  ASSERT_GE(rail.frame, 0) << "the rail turns with a body";
  const Values q = direction(layout.kept, random);
  for (const auto& [name, measure] : measures) {
    SCOPED_TRACE(name);
    expect_derivatives(scene, layout, measure, q, random);
  }
}

TEST(Measures, HalfTheSquareOfADistanceKnowsItsDerivatives) {
  for_measures([](const Scene& scene, const Layout& layout, const Measure& measure, const std::vector<double>& q,
                  Random& random) {
    if (measure.kind != Measure::Kind::distance) return;
    const Values p = in_50_digits(q);
    Placed<Real> distance(scene, layout, measure);
    Placed<Real> half_square(scene, layout, measure, Of::half_its_square);
    const Real l = distance.value(p);
    expect_same(half_square.value(p), l * l / 2, "value", 1e-45);
    expect_derivatives(scene, layout, measure, p, random, Of::half_its_square);
  });
}

// d = 0: a distance has no derivatives there, half its square has D2 = Dd.Dd.
TEST(Measures, HalfTheSquareOfADistanceIsSmoothWherePointsCoincide) {
  Scene scene = test::chain(2, 1.0, 1.0);
  const Measure ends = Measure::distance_between(test::point(scene, "ground.O"), test::point(scene, "2.b"));
  const Layout layout = lay_out(scene, Purpose::dynamics);
  Random random(3);
  // Folded upon itself: the free end is at the first pin. d = u(q1) + u(q2), so Dd along v is (v1 - v2) u'(q1).
  const Values q{Real(0.5), Real(0.5) + boost::math::constants::pi<Real>()};
  Placed<Real> g(scene, layout, ends, Of::half_its_square);
  const Values u = direction(2, random);
  const Values v = direction(2, random);
  expect_same(g.value(q), Real(0), "value", 1e-45);
  expect_same(g.first(q, u), Real(0), "gradient", 1e-45);
  expect_same(g.second(q, u, v), (u[0] - u[1]) * (v[0] - v[1]), "second", 1e-45);
  expect_derivatives(scene, layout, ends, q, random, Of::half_its_square);
}

TEST(Measures, AreTheSameInDouble) {
  for_measures([](const Scene& scene, const Layout& layout, const Measure& measure, const std::vector<double>& q,
                  Random& random) {
    const auto in_double = [](const Values& values) {
      std::vector<double> out;
      for (const Real& value : values) out.push_back(static_cast<double>(value));
      return out;
    };
    Placed<double> rough(scene, layout, measure);
    Placed<Real> fine(scene, layout, measure);
    const Values p = in_50_digits(q);
    const Values u = direction(q.size(), random);
    const Values v = direction(q.size(), random);
    const Values w = direction(q.size(), random);
    const std::vector<double> a = in_double(u);
    const std::vector<double> b = in_double(v);
    const std::vector<double> c = in_double(w);
    expect_same(rough.value(q), fine.value(p), "value", 1e-13);
    expect_same(rough.first(q, a), fine.first(p, u), "gradient", 1e-12);
    expect_same(rough.second(q, a, b), fine.second(p, u, v), "second", 1e-11);
    expect_same(rough.third(q, a, b, c), fine.third(p, u, v, w), "third", 1e-10);
    expect_same(rough.curvature(q, 1.5, -0.75, a, b), fine.curvature(p, Real(1.5), Real(-0.75), u, v), "curvature",
                1e-11);
  });
}

TEST(Measures, HaveTheSupportThatMovesThem) {
  // Two links in series and a block on a fixed rail.
  Scene scene = test::chain(2, 1.0, 1.0);
  const int block = scene.add_body("block");
  scene.add_point(block, "c", {0, 0});
  scene.bodies[block].mass = 1.0;
  const int rail = test::add_slide(scene, "ground.O", "block.c", {1, 0}, "rail");
  const Layout layout = lay_out(scene, Purpose::dynamics);
  const Phasors<double> phasors(layout, true);
  const auto support = [&](const Measure& measure) {
    return CompiledMeasure<double>(scene, layout, phasors, measure).support();
  };
  const int first = layout.links[1].frame;
  const int second = layout.links[2].frame;
  const int travel = layout.travel[rail];
  const auto sorted = [](std::vector<int> all) {
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(support(Measure::angle_between(0, 1)), std::vector<int>{first});
  EXPECT_EQ(support(Measure::angle_between(1, 2)), sorted({first, second}));
  EXPECT_EQ(support(Measure::travel_of(rail)), std::vector<int>{travel});
  EXPECT_EQ(support(Measure::x_of(test::point(scene, "1.b"))), std::vector<int>{first});
  EXPECT_EQ(support(Measure::y_of(test::point(scene, "2.b"))), sorted({first, second}));
  EXPECT_EQ(support(Measure::distance_between(test::point(scene, "block.c"), test::point(scene, "1.b"))),
            sorted({first, travel}));
  EXPECT_EQ(
      support(Measure::sum_of({{2.0, Measure::travel_of(rail)}, {1.0, Measure::x_of(test::point(scene, "1.b"))}})),
      sorted({first, travel}));
}

TEST(Measures, DistancesOfPointsThatMeetActLikeSpringsWithoutLength) {
  Scene scene = test::chain(1, 1.0, 1.0);
  const PointRef wall = scene.add_point(0, "wall", {1, 0});
  const Measure measure = Measure::distance_between(wall, test::point(scene, "1.b"));
  Placed<double> g(scene, lay_out(scene, Purpose::dynamics), measure);
  const std::vector<double> q{0.0}, u{1.0};
  EXPECT_EQ(g.value(q), 0.0);
  EXPECT_EQ(g.first(q, u), 0.0);
  EXPECT_EQ(g.second(q, u, u), 0.0);
  EXPECT_EQ(g.third(q, u, u, u), 0.0);
  EXPECT_EQ(g.bend(q, u), std::vector<double>{0.0});
  EXPECT_EQ(g.curvature(q, -1.0, 3.0, u, u), 3.0);
}

}  // namespace
}  // namespace poise::measures_test
