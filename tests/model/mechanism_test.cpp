#include "model/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/static_model.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::mechanism_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::PlantedMechanism;
using test::Random;

// --- values of a mechanism as functions of q ------------------------------------------------------------------------

std::vector<int> all_rows(const Mechanism<double>& mechanism) {
  std::vector<int> rows(mechanism.constraints());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

DensePoint<double> at(const Mechanism<double>& mechanism, const VectorXd& q) {
  return {mechanism, std::vector<double>(q.begin(), q.end()), all_rows(mechanism)};
}

VectorXd energy(const Mechanism<double>& mechanism, const VectorXd& q) {
  std::vector<Planar<double>> pose(mechanism.pose_size());
  mechanism.place(q.data(), pose.data());
  return VectorXd::Constant(1, mechanism.energy(q.data(), pose.data()));
}

VectorXd constraint(const Mechanism<double>& mechanism, const VectorXd& q) {
  const std::vector<double> c = at(mechanism, q).constraint;
  return Eigen::Map<const VectorXd>(c.data(), static_cast<Eigen::Index>(c.size()));
}

// -Q + J^T y
VectorXd residual(const Mechanism<double>& mechanism, const VectorXd& q, const VectorXd& y) {
  const DensePoint<double> point = at(mechanism, q);
  return point.force + point.jacobian.transpose() * y;
}

// Largest error of d f / d q against central differences of fourth order, relative to 1 + the largest derivative: the
// best over steps of nine decades, the same step for all entries.
double error_against_differences(const std::function<VectorXd(const VectorXd&)>& f, const VectorXd& q,
                                 const MatrixXd& derivative) {
  double best = std::numeric_limits<double>::infinity();
  for (double h = 0.1; h > 1e-10; h *= 0.1) {
    double worst = 0.0;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const auto shifted = [&](double by) {
        VectorXd moved = q;
        moved[i] += by * h;
        return f(moved);
      };
      const VectorXd difference = (8 * (shifted(1) - shifted(-1)) - (shifted(2) - shifted(-2))) / (12 * h);
      if (difference.size() > 0) worst = std::max(worst, (difference - derivative.col(i)).cwiseAbs().maxCoeff());
    }
    best = std::min(best, worst);
  }
  return best / (1.0 + (derivative.size() > 0 ? derivative.cwiseAbs().maxCoeff() : 0.0));
}

// Gradient, Jacobian and tangent at q, which need not close any loop.
void expect_derivatives(const Mechanism<double>& mechanism, const VectorXd& q, Random& random,
                        double accuracy = 1e-10) {
  DensePoint<double> point = at(mechanism, q);
  if (!mechanism.has_follower_loads()) {
    const auto potential = [&](const VectorXd& p) { return energy(mechanism, p); };
    EXPECT_LT(error_against_differences(potential, q, point.force.transpose()), accuracy) << "gradient";
  }
  const auto rows = [&](const VectorXd& p) { return constraint(mechanism, p); };
  EXPECT_LT(error_against_differences(rows, q, point.jacobian), accuracy) << "Jacobian";
  VectorXd y(mechanism.constraints());
  for (double& multiplier : y) multiplier = random.uniform(-1.0, 1.0);
  const auto forces = [&](const VectorXd& p) { return residual(mechanism, p, y); };
  EXPECT_LT(error_against_differences(forces, q, point.tangent(y)), accuracy) << "tangent";
}

VectorXd shaken(const std::vector<double>& q, double by, Random& random) {
  VectorXd out(static_cast<Eigen::Index>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) out[static_cast<Eigen::Index>(i)] = q[i] + random.uniform(-by, by);
  return out;
}

// --- random mechanisms and the scenes of the data sets --------------------------------------------------------------

// A few of each number of loops; every other one with loads that follow bodies, every third with couplings, all with
// stops.
void for_random_mechanisms(int of_each, const std::function<void(const PlantedMechanism&, Random&)>& expect) {
  for (int loops = 1; loops <= 6; ++loops) {
    for (int k = 0; k < of_each; ++k) {
      const auto seed = static_cast<std::uint64_t>(100 * loops + k);
      SCOPED_TRACE("loops " + std::to_string(loops) + ", seed " + std::to_string(seed));
      Random random(seed);
      const test::Wish wish{.loops = loops, .followers = k % 2 == 1, .stops = true, .couplings = k % 3 == 2};
      expect(test::plant_mechanism(seed, wish), random);
    }
  }
}

void for_data_sets(const std::function<void(const Scene&, Random&)>& expect) {
  int count = 0;
  for (const std::string& name : test::scene_names()) {
    SCOPED_TRACE(name);
    Random random(7);
    expect(read_scene(test::dataset(name)), random);
    ++count;
  }
  EXPECT_GT(count, 10);
}

TEST(MechanismDerivatives, OfRandomMechanismsMatchDifferences) {
  for_random_mechanisms(6, [](const PlantedMechanism& planted, Random& random) {
    const StaticModel model(planted.scene);
    for (const double by : {0.01, 1.0}) {
      expect_derivatives(model.mechanism(), shaken(model.from_si(planted.equilibrium), by, random), random);
    }
  });
}

TEST(MechanismDerivatives, OfDataSetsMatchDifferences) {
  for_data_sets([](const Scene& scene, Random& random) {
    const StaticModel model(scene);
    for (const double by : {0.0, 0.5}) expect_derivatives(model.mechanism(), shaken(model.start(), by, random), random);
  });
}

// The same with elements, and stops, upon every kind of measure.
void for_every_measure(const std::function<void(const Scene&, Random&)>& expect) {
  for_random_mechanisms(3, [&](const PlantedMechanism& planted, Random& random) {
    Scene scene = planted.in_equilibrium;
    test::add_elements_upon_every_measure(scene, random);
    for (const auto& [name, measure] : test::measures_of(scene, random)) {
      Stop& stop = scene.stops.emplace_back();
      stop.name = name;
      stop.on = measure;
    }
    expect(scene, random);
  });
}

TEST(MechanismDerivatives, UponEveryMeasureMatchDifferences) {
  for_every_measure([](const Scene& scene, Random& random) {
    const StaticModel model(scene);
    expect_derivatives(model.mechanism(), shaken(model.start(), 0.5, random), random);
  });
}

TEST(Mechanism, ClosuresAreTheGapsOfJoints) {
  const auto expect_gaps = [](const Scene& scene, Random& random) {
    const Mechanism<double> mechanism(scene);
    const Layout& layout = mechanism.layout();
    const VectorXd q = shaken(mechanism.start(), 1.0, random);
    const VectorXd c = constraint(mechanism, q);
    const test::Poses poses = mechanism.poses(q.data());
    for (int l = 0; l < mechanism.closures(); ++l) {
      const int joint = layout.closures[l].joint;
      const double travel = layout.travel[joint] >= 0 ? q[layout.travel[joint]] : 0.0;
      const Vec2 gap = test::gap(scene, joint, travel, poses);
      EXPECT_NEAR(c[2 * l], gap.x, 1e-13 * layout.size) << layout.closures[l].name;
      EXPECT_NEAR(c[2 * l + 1], gap.y, 1e-13 * layout.size) << layout.closures[l].name;
    }
  };
  for_random_mechanisms(6,
                        [&](const PlantedMechanism& planted, Random& random) { expect_gaps(planted.scene, random); });
  for_data_sets(expect_gaps);
}

TEST(Mechanism, KeepsJointsOfTheTreeClosed) {
  for_random_mechanisms(6, [](const PlantedMechanism& planted, Random& random) {
    const Scene& scene = planted.scene;
    const Mechanism<double> mechanism(scene);
    const Layout& layout = mechanism.layout();
    const VectorXd q = shaken(mechanism.start(), 1.0, random);
    const test::Poses poses = mechanism.poses(q.data());
    for (int j = 0; j < static_cast<int>(scene.joints.size()); ++j) {
      const Joint& joint = scene.joints[j];
      if (joint.keeps_angle()) {
        EXPECT_NEAR(std::remainder(poses[joint.b.body].angle - poses[joint.a.body].angle - joint.angle, 2 * M_PI), 0.0,
                    1e-12)
            << joint.name;
      }
      const bool closes_loop = std::any_of(layout.closures.begin(), layout.closures.end(),
                                           [&](const Closure& closure) { return closure.joint == j; });
      const int t = layout.travel[j];
      const double travel = t < 0 ? 0.0 : t < mechanism.coordinates() ? q[t] : layout.coordinates[t].start;
      if (closes_loop) continue;
      EXPECT_LT(norm(test::gap(scene, j, travel, poses)), 1e-13 * layout.size) << joint.name;
    }
  });
}

bool depends_on_travel(const Measure& measure) {
  return measure.kind == Measure::Kind::travel ||
         std::any_of(measure.terms.begin(), measure.terms.end(),
                     [](const Measure::Term& term) { return depends_on_travel(term.measure); });
}

TEST(Mechanism, StopsAreMeasuredBetweenThePlacesOfBodies) {
  for_random_mechanisms(6, [](const PlantedMechanism& planted, Random& random) {
    const Mechanism<double> mechanism(planted.scene);
    // Travels of joints that close a loop are theirs only where the loop closes.
    VectorXd q = shaken(planted.equilibrium, 0.0, random);
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd c = constraint(mechanism, q);
      const test::Poses poses = mechanism.poses(q.data());
      for (int s = 0; s < mechanism.stops(); ++s) {
        const Stop& stop = planted.scene.stops[s];
        if (pass == 1 && depends_on_travel(stop.on)) continue;
        EXPECT_NEAR(c[mechanism.stop_row(s)], test::measured(planted.scene, stop.on, poses),
                    1e-12 * (1.0 + mechanism.layout().size))
            << stop.name;
        EXPECT_EQ(mechanism.lower()[s], stop.min);
        EXPECT_EQ(mechanism.upper()[s], stop.max);
      }
      q = shaken(planted.equilibrium, 1.0, random);
    }
  });
}

void expect_energy(const Scene& scene, Random& random) {
  const Mechanism<double> mechanism(scene);
  const VectorXd p = shaken(mechanism.start(), 1.0, random);
  const VectorXd q = shaken(mechanism.start(), 1.0, random);
  const double from = test::potential_energy(scene, mechanism.poses(p.data()));
  const double to = test::potential_energy(scene, mechanism.poses(q.data()));
  EXPECT_NEAR(energy(mechanism, q)[0] - energy(mechanism, p)[0], to - from,
              1e-12 * (std::abs(from) + std::abs(to) + std::abs(energy(mechanism, q)[0])));
}

TEST(Mechanism, EnergyDiffersByWhatLoadsAndSpringsDo) {
  for_random_mechanisms(6,
                        [&](const PlantedMechanism& planted, Random& random) { expect_energy(planted.scene, random); });
  for_data_sets(expect_energy);
}

// Open chains with elements upon every kind of measure: all travels are theirs in any pose.
void for_open_chains(const std::function<void(const Scene&, Random&)>& expect) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Scene scene = test::plant_mechanism(seed, {.loops = 0}).in_equilibrium;
    test::add_elements_upon_every_measure(scene, random);
    expect(scene, random);
  }
}

TEST(Mechanism, EnergyUponEveryMeasureIsThatOfThePlacesOfBodies) { for_open_chains(expect_energy); }

TEST(Mechanism, ResistanceTakesThePowerSeenInThePlacesOfBodies) {
  for_open_chains([](const Scene& scene, Random& random) {
    const Mechanism<double> mechanism(scene, Purpose::dynamics);
    const VectorXd q = shaken(mechanism.start(), 1.0, random);
    const VectorXd v = shaken(std::vector<double>(q.size(), 0.0), 2.0, random);
    // sum T(dg/dt) g, with the forces as they are here and now: its gradient is what resists.
    const auto places = [&](const VectorXd& p) { return mechanism.poses(p.data()); };
    std::vector<double> resistance;
    for (const Element& element : scene.elements) {
      constexpr double h = 1e-3;
      const auto g = [&](double t) { return test::measured(scene, element.on, places(q + t * v)); };
      const double rate = (8 * (g(h) - g(-h)) - (g(2 * h) - g(-2 * h))) / (12 * h);
      resistance.push_back(force_of_motion(element.law, g(0), rate).value);
    }
    const auto frozen = [&](const VectorXd& p) -> VectorXd {
      double sum = 0.0;
      const test::Poses poses = places(p);
      for (std::size_t e = 0; e < scene.elements.size(); ++e) {
        sum += resistance[e] * test::measured(scene, scene.elements[e].on, poses);
      }
      return VectorXd::Constant(1, sum);
    };
    std::vector<Planar<double>> pose(mechanism.pose_size());
    mechanism.place(q.data(), pose.data());
    VectorXd force = VectorXd::Zero(q.size());
    std::vector<double> resistances(mechanism.resistances_size());
    mechanism.resist(pose.data(), v.data(), nullptr, resistances.data());
    mechanism.add_resistance(resistances.data(), force.data());
    EXPECT_LT(error_against_differences(frozen, q, force.transpose()), 1e-9);
  });
}

TEST(Mechanism, FollowerForcesDoTheWorkSeenInThePlacesOfBodies) {
  for_random_mechanisms(4, [](const PlantedMechanism& planted, Random& random) {
    // What remains of -Q without the gradient of the potential is - sum F . dp/dq.
    const StaticModel model(planted.scene);
    const Mechanism<double>& mechanism = model.mechanism();
    const Scene& scene = model.scaled_scene();
    const VectorXd q = shaken(mechanism.start(), 1.0, random);
    const test::Poses here = mechanism.poses(q.data());
    const auto potential_and_frozen_followers = [&](const VectorXd& p) -> VectorXd {
      const test::Poses poses = mechanism.poses(p.data());
      double v = test::potential_energy(scene, poses);
      for (const Force& force : scene.forces) {
        if (force.follows < 0) continue;
        v -= dot(force.vector * unit(here[force.follows].angle), test::world(scene, force.at, poses));
      }
      return VectorXd::Constant(1, v);
    };
    const MatrixXd derivative = at(mechanism, q).force.transpose();
    EXPECT_LT(error_against_differences(potential_and_frozen_followers, q, derivative), 1e-10);
  });
}

// --- scenes built for one property ----------------------------------------------------------------------------------

// A scene of one's own, in a few words.
struct Sketch {
  Scene scene;

  Sketch() { scene.file = "sketch.toml"; }

  int body(const std::string& name, double angle = 0.0) {
    const int b = scene.add_body(name);
    scene.start.angle[b] = angle;
    return b;
  }
  PointRef point(int body, Vec2 place) {
    return scene.add_point(body, "p" + std::to_string(scene.bodies[body].points.size()), place);
  }
  Joint& join(Joint::Kind kind, int a, Vec2 at_a, int b, Vec2 at_b) {
    Joint joint;
    joint.kind = kind;
    joint.a = point(a, at_a);
    joint.b = point(b, at_b);
    return scene.joints[scene.add_joint(joint)];
  }
  void pin(int a, Vec2 at_a, int b, Vec2 at_b) { join(Joint::Kind::pin, a, at_a, b, at_b); }
  void bar(int a, Vec2 at_a, int b, Vec2 at_b, double length) {
    join(Joint::Kind::bar, a, at_a, b, at_b).length = length;
  }
  void weigh(int body, double mass, Vec2 center) {
    scene.bodies[body].mass = mass;
    scene.bodies[body].center = center;
  }
  Force& push(int body, Vec2 place, Vec2 vector) {
    Force force;
    force.name = "f" + std::to_string(scene.forces.size());
    force.at = point(body, place);
    force.vector = vector;
    return scene.forces.emplace_back(force);
  }
  void spring(int a, Vec2 at_a, int b, Vec2 at_b, double stiffness, double free_length, LinearSpring::Acts acts) {
    const std::string name = "s" + std::to_string(test::count_of(scene, "spring"));
    const PointRef from = point(a, at_a);
    const PointRef to = point(b, at_b);
    scene.elements.push_back(test::line_spring(name, from, to, stiffness, free_length, acts));
  }
};

// Links of length 1 end to end from the ground, the first at angles[0].
Sketch chain(const std::vector<double>& angles) {
  Sketch sketch;
  int last = 0;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const int link = sketch.body("link" + std::to_string(k + 1), angles[k]);
    sketch.pin(last, {k == 0 ? 0.0 : 1.0, 0.0}, link, {0, 0});
    last = link;
  }
  return sketch;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return all;
}

TEST(MechanismDerivatives, HoldNextToDeadCentres) {
  // A four-bar stretched flat: the closure Jacobian loses rank at gap 0.
  for (const double bent : {0.0, 1e-12, 1e-8, 1e-4, 1e-2}) {
    SCOPED_TRACE(bent);
    Sketch sketch = chain({bent, -bent, 0.5 * bent});
    sketch.pin(3, {1, 0}, 0, {3, 0});
    sketch.push(2, {0.3, 0.1}, {0.2, -1.0});
    Random random(1);
    const Mechanism<double> mechanism(sketch.scene);
    ASSERT_EQ(mechanism.closures(), 1);
    expect_derivatives(mechanism, shaken(mechanism.start(), 0.0, random), random);
  }
}

TEST(MechanismDerivatives, HoldForSpringsAndStopsOfVanishingLength) {
  for (const double apart : {1e-1, 1e-3, 1e-5, 1e-7}) {
    SCOPED_TRACE(apart);
    Sketch sketch = chain({0.3, 0.3 + M_PI + apart});
    sketch.spring(0, {0, 0}, 2, {1, 0}, 2.0, 0.5, LinearSpring::Acts::both);
    Stop stop;
    const PointRef from = sketch.point(0, {0, 0});
    const PointRef to = sketch.point(2, {1, 0});
    stop.on = Measure::distance_between(from, to);
    sketch.scene.stops.push_back(stop);
    Random random(2);
    const Mechanism<double> mechanism(sketch.scene);
    // Points of order one leave 16 digits less those of their distance.
    expect_derivatives(mechanism, shaken(mechanism.start(), 0.0, random), random, 1e-10 + 1e-15 / apart);
  }
}

TEST(Mechanism, IsFiniteWhereSpringEndsMeet) {
  Sketch sketch = chain({0.0});
  sketch.spring(0, {1, 0}, 1, {1, 0}, 2.0, 0.5, LinearSpring::Acts::both);
  const Mechanism<double> mechanism(sketch.scene);
  DensePoint<double> point = at(mechanism, VectorXd::Zero(1));
  EXPECT_DOUBLE_EQ(energy(mechanism, VectorXd::Zero(1))[0], 0.25);
  EXPECT_EQ(point.force[0], 0.0);
  EXPECT_TRUE(std::isfinite(point.tangent(VectorXd())(0, 0)));
}

TEST(Mechanism, WeighsBodies) {
  // V = m g l sin q, with the centre turned by 0.4 rad in the body.
  Sketch sketch = chain({0.7});
  sketch.scene.gravity = {0, -9.81};
  sketch.weigh(1, 2.0, 0.5 * unit(0.4));
  const Mechanism<double> mechanism(sketch.scene);
  const VectorXd q = VectorXd::Constant(1, 0.7);
  DensePoint<double> point = at(mechanism, q);
  EXPECT_NEAR(energy(mechanism, q)[0], 2.0 * 9.81 * 0.5 * std::sin(1.1), 1e-14);
  EXPECT_NEAR(point.force[0], 2.0 * 9.81 * 0.5 * std::cos(1.1), 1e-14);
  EXPECT_NEAR(point.tangent(VectorXd())(0, 0), -2.0 * 9.81 * 0.5 * std::sin(1.1), 1e-14);
}

TEST(Mechanism, CountsTurnsOfTorsionSprings) {
  Sketch sketch = chain({0.7});
  sketch.scene.elements.push_back(test::torsion_spring("t", 0, 1, 3.0, 2 * M_PI));
  const Mechanism<double> mechanism(sketch.scene);
  EXPECT_NEAR(at(mechanism, VectorXd::Constant(1, 0.7)).force[0], 3.0 * (0.7 - 2 * M_PI), 1e-14);
  EXPECT_NEAR(at(mechanism, VectorXd::Constant(1, 0.7 + 2 * M_PI)).force[0], 3.0 * 0.7, 1e-14);
}

TEST(Mechanism, SlackSpringsHaveNeitherEnergyNorForce) {
  // The end of the link is 0.5 from (1.5, 0): a free length of 1 leaves it short, one of 0.25 stretched.
  struct Case {
    LinearSpring::Acts acts;
    double free_length;
    bool slack;
  };
  for (const Case& c :
       {Case{LinearSpring::Acts::tension, 1.0, true}, Case{LinearSpring::Acts::tension, 0.25, false},
        Case{LinearSpring::Acts::compression, 1.0, false}, Case{LinearSpring::Acts::compression, 0.25, true},
        Case{LinearSpring::Acts::both, 1.0, false}, Case{LinearSpring::Acts::both, 0.25, false}}) {
    SCOPED_TRACE(c.free_length);
    Sketch sketch = chain({0.3});
    const Vec2 end = unit(0.3);
    sketch.spring(0, end + Vec2{0.3, 0.4}, 1, {1, 0}, 2.0, c.free_length, c.acts);
    const Mechanism<double> mechanism(sketch.scene);
    const VectorXd q = VectorXd::Constant(1, 0.3);
    DensePoint<double> point = at(mechanism, q);
    const double stretch = 0.5 - c.free_length;
    EXPECT_NEAR(energy(mechanism, q)[0], c.slack ? 0.0 : stretch * stretch, 1e-14);
    // The spring pulls the end of the link along (0.6, 0.8) by k stretch.
    const double moment = cross(end, 2.0 * stretch * Vec2{0.6, 0.8});
    EXPECT_NEAR(point.force[0], c.slack ? 0.0 : -moment, 1e-14);
    EXPECT_EQ(point.tangent(VectorXd())(0, 0) == 0.0, c.slack);
  }
}

TEST(Mechanism, FollowerLoadsMakeTheTangentUnsymmetric) {
  // Ziegler's column: two links of length 1 with torsion springs k, and P at the tip, along the second link towards the
  // joint: -Q1 = k (2 q1 - q2) + P sin(q2 - q1), -Q2 = k (q2 - q1), and so K = [2k - P, -k + P; -k, k] upright.
  constexpr double k = 2.0;
  constexpr double p = 0.7;
  Sketch sketch = chain({0.0, 0.0});
  sketch.scene.elements.push_back(test::torsion_spring("t1", 0, 1, k, 0.0));
  sketch.scene.elements.push_back(test::torsion_spring("t2", 1, 2, k, 0.0));
  Force& force = sketch.push(2, {1, 0}, {-p, 0});
  force.follows = 2;
  const Mechanism<double> mechanism(sketch.scene);
  ASSERT_TRUE(mechanism.has_follower_loads());
  EXPECT_EQ(mechanism.follower_names(), std::vector<std::string>{"f0"});
  const MatrixXd tangent = at(mechanism, VectorXd::Zero(2)).tangent(VectorXd());
  MatrixXd expected(2, 2);
  expected << 2 * k - p, -k + p, -k, k;
  EXPECT_LT((tangent - expected).cwiseAbs().maxCoeff(), 1e-14) << tangent;
  EXPECT_NE(tangent(0, 1), tangent(1, 0));
}

TEST(Mechanism, DropsWhatNothingAsksFor) {
  // The second link hangs on the first without a load of its own.
  Sketch sketch = chain({0.3, 0.4});
  sketch.push(1, {1, 0}, {0, -1});
  const Mechanism<double> mechanism(sketch.scene);
  const Layout& layout = mechanism.layout();
  ASSERT_EQ(layout.coordinates.size(), 2u);
  EXPECT_EQ(layout.kept, 1);
  EXPECT_EQ(layout.coordinates[0].name, "link1");
  EXPECT_PRED2(contains, layout.coordinates[0].why(), "carries a load");
  EXPECT_EQ(layout.coordinates[1].name, "link2");
  EXPECT_PRED2(contains, layout.coordinates[1].why(), "carries no load");
  // It keeps its guess, carried along by the first link.
  const double q = 1.0;
  const BodyPose<double> hanging = mechanism.poses(&q)[2];
  EXPECT_EQ(hanging.angle, 0.4);
  EXPECT_LT(norm(hanging.origin - unit(1.0)), 1e-15);
}

TEST(Mechanism, DropsMassesWithoutGravityAndInertias) {
  Sketch sketch = chain({0.3, 0.4});
  sketch.weigh(1, 1.0, {0.5, 0});
  sketch.weigh(2, 1.0, {0.5, 0});
  sketch.scene.bodies[1].inertia = 0.1;
  sketch.push(1, {1, 0}, {0, -1});
  const Layout layout = lay_out(sketch.scene, Purpose::statics);
  EXPECT_EQ(layout.kept, 1);
  EXPECT_PRED2(contains, joined(layout.dropped), "mass of 2 bodies");
  EXPECT_PRED2(contains, joined(layout.dropped), "moment of inertia of 1 body");
  // Gravity asks for them, and so does motion.
  EXPECT_EQ(lay_out(sketch.scene, Purpose::dynamics).kept, 2);
  sketch.scene.gravity = {0, -9.81};
  EXPECT_EQ(lay_out(sketch.scene, Purpose::statics).kept, 2);
}

TEST(Mechanism, NamesLoadsWithoutEffect) {
  Sketch sketch = chain({0.3});
  sketch.push(1, {1, 0}, {0, -1});
  sketch.push(1, {1, 0}, {0, 0});
  sketch.spring(0, {1, 1}, 1, {1, 0}, 0.0, 0.5, LinearSpring::Acts::both);
  const int block = sketch.body("block");
  sketch.join(Joint::Kind::slide, 0, {0, 0}, block, {0, 0});
  sketch.scene.torques.push_back({"twist", block, 1.0});
  const Layout layout = lay_out(sketch.scene, Purpose::statics);
  EXPECT_EQ(layout.kept, 1);
  EXPECT_PRED2(contains, joined(layout.dropped), "force \"f1\"");
  EXPECT_PRED2(contains, joined(layout.dropped), "spring \"s0\"");
  EXPECT_PRED2(contains, joined(layout.dropped), "torque \"twist\"");
}

TEST(Mechanism, NamesTorquesAndTorsionSpringsWithoutEffect) {
  Sketch sketch = chain({0.3});
  sketch.push(1, {1, 0}, {0, -1});
  sketch.scene.torques.push_back({"idle", 1, 0.0});
  sketch.scene.elements.push_back(test::torsion_spring("soft", 0, 1, 0.0));
  const std::string dropped = joined(lay_out(sketch.scene, Purpose::statics).dropped);
  EXPECT_PRED2(contains, dropped, "torque \"idle\": it is zero");
  EXPECT_PRED2(contains, dropped, "torsion spring \"soft\": its stiffness is zero");
}

TEST(Mechanism, NamesItemsThatOnlyActInMotion) {
  Sketch sketch = chain({0.3});
  sketch.push(1, {1, 0}, {0, -1});
  Scene& scene = sketch.scene;
  const PointRef far = scene.add_point(0, "far", {1, 1});
  const PointRef near = scene.add_point(1, "near", {1, 0});
  scene.elements.push_back(test::line_damper("oil", far, near, 1.0));
  scene.elements.push_back(test::torsion_damper("grease", 0, 1, 1.0));
  scene.elements.push_back(test::friction("dry", 0, 1, 1.0));
  Drive motor;
  motor.name = "motor";
  motor.on = Measure::angle_between(0, 1);
  scene.drives.push_back(motor);
  const std::string dropped = joined(lay_out(scene, Purpose::statics).dropped);
  EXPECT_PRED2(contains, dropped, "damper \"oil\": nothing moves in statics");
  EXPECT_PRED2(contains, dropped, "torsion damper \"grease\": nothing moves in statics");
  EXPECT_PRED2(contains, dropped, "friction \"dry\": nothing moves in statics");
  EXPECT_PRED2(contains, dropped, "drive \"motor\": statics leaves drives out, its coordinate is free");
  EXPECT_TRUE(lay_out(scene, Purpose::dynamics).dropped.empty());
}

TEST(Mechanism, WeldedBodiesShareAFrame) {
  Sketch sketch = chain({0.3});
  const int arm = sketch.body("arm", 0.3 + 0.5);
  sketch.join(Joint::Kind::weld, 1, {1, 0}, arm, {0.2, 0}).angle = 0.5;
  sketch.push(arm, {1, 0}, {0, -1});
  const Mechanism<double> mechanism(sketch.scene);
  ASSERT_EQ(mechanism.coordinates(), 1);
  EXPECT_EQ(mechanism.layout().links[1].frame, mechanism.layout().links[arm].frame);
  EXPECT_NEAR(mechanism.start()[0], 0.3, 1e-15);
  const double q = 1.0;
  const BodyPose<double> pose = mechanism.poses(&q)[arm];
  EXPECT_NEAR(pose.angle, 1.5, 1e-15);
  EXPECT_LT(norm(pose.world({0.2, 0}) - unit(1.0)), 1e-15);
}

TEST(Mechanism, RejectsContradictoryWelds) {
  Sketch sketch = chain({0.3});
  const int arm = sketch.body("arm");
  sketch.join(Joint::Kind::weld, 1, {1, 0}, arm, {0, 0}).angle = 0.5;
  Joint& second = sketch.join(Joint::Kind::weld, arm, {1, 0}, 1, {2, 0});
  second.name = "brace";
  second.angle = -0.4;
  second.line = 12;
  try {
    const Mechanism<double> mechanism(sketch.scene);
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("sketch.toml:12: weld \"brace\": ", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  // The same angle again, a turn further, is redundant and no contradiction.
  sketch.scene.joints[2].angle = -0.5 + 2 * M_PI;
  EXPECT_EQ(lay_out(sketch.scene, Purpose::statics).redundant_angle, std::vector<int>{2});
}

TEST(Mechanism, BarsPointFromEndToEnd) {
  Sketch sketch = chain({M_PI / 2});
  sketch.bar(0, {2, 0}, 1, {1, 0}, 2.5);
  const Mechanism<double> mechanism(sketch.scene);
  ASSERT_EQ(mechanism.coordinates(), 2);
  EXPECT_NEAR(mechanism.start()[1], std::atan2(1.0, -2.0), 1e-15);
  ASSERT_EQ(mechanism.closures(), 1);
  // What is left open along the bar: its length less the distance.
  const VectorXd c = constraint(mechanism, Eigen::Map<const VectorXd>(mechanism.start().data(), 2));
  EXPECT_NEAR(c.norm(), 2.5 - std::sqrt(5.0), 1e-14);
}

TEST(Mechanism, FreeBodiesGetTheirWorldCoordinates) {
  Sketch sketch;
  const int raft = sketch.body("raft", 0.2);
  sketch.scene.start.position[raft] = Vec2{1.0, 2.0};
  sketch.spring(0, {0, 0}, raft, {0.5, 0}, 1.0, 0.1, LinearSpring::Acts::both);
  const Mechanism<double> mechanism(sketch.scene);
  const Layout& layout = mechanism.layout();
  ASSERT_EQ(layout.kept, 3);
  EXPECT_EQ(layout.coordinates[0].name, "raft");
  EXPECT_EQ(layout.coordinates[1].name, "raft.x");
  EXPECT_EQ(layout.coordinates[2].name, "raft.y");
  EXPECT_EQ(mechanism.start(), (std::vector<double>{0.2, 1.0, 2.0}));
  const std::vector<double> q = {0.3, -1.0, 0.5};
  EXPECT_EQ(mechanism.poses(q.data())[raft].origin, (Vec2{-1.0, 0.5}));
}

TEST(Mechanism, SlidesCarryTheirLineAlong) {
  Sketch sketch = chain({0.3});
  const int block = sketch.body("block");
  Joint& slide = sketch.join(Joint::Kind::slide, 1, {0.5, 0}, block, {0, 0.1});
  slide.axis = {0, 1};
  slide.angle = 0.2;
  sketch.push(block, {1, 0}, {0, -1});
  const Mechanism<double> mechanism(sketch.scene);
  ASSERT_EQ(mechanism.coordinates(), 2);
  EXPECT_EQ(mechanism.layout().coordinates[1].frame, 0);
  const std::vector<double> q = {0.3, 0.7};
  const BodyPose<double> pose = mechanism.poses(q.data())[block];
  EXPECT_NEAR(pose.angle, 0.5, 1e-15);
  EXPECT_LT(norm(pose.world({0, 0.1}) - Vec2{0.5, 0.7} * unit(0.3)), 1e-15);
}

}  // namespace
}  // namespace poise::mechanism_test
