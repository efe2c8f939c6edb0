// Units of a mechanism's own size and load: they round nothing and change nothing.

#include "statics/model/scaling.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::scaling_test {
namespace {

using test::dataset;

constexpr const char* names[] = {"thesis_four_bar.toml", "toggle_clamp.toml",      "lift.toml",
                                 "car_hood.toml",        "hencky_cantilever.toml", "vertical_slider_crank.toml"};

void expect_power_of_two(double value) {
  int exponent = 0;
  EXPECT_EQ(std::frexp(value, &exponent), 0.5) << value;
}

TEST(Scales, ArePowersOfTwo) {
  for (const char* name : names) {
    const StaticModel model(read_scene(dataset(name)));
    expect_power_of_two(model.scales().length);
    expect_power_of_two(model.scales().force);
    // The compiled layout is that of the scaled scene.
    EXPECT_LE(model.layout().size, std::sqrt(2.0) * (1 + 1e-15));
    EXPECT_GE(model.layout().size, std::sqrt(0.5) * (1 - 1e-15));
  }
}

TEST(Scales, AreAboutTheReachAndTheSumOfAllLoads) {
  Scene scene = test::chain(2, 1.5, 10.0);
  scene.gravity = {0.0, -10.0};
  test::add_force(scene, "2.b", {3.0, 4.0}, "F");
  Torque torque;
  torque.body = 1;
  torque.value = -200.0;
  scene.torques.push_back(torque);
  // Reach 3 m rounds to 4 (in logarithms); 200 N of weight, 5 N, and 200 N m over 4 m.
  const Scales scales = choose_scales(scene, 3.0);
  EXPECT_EQ(scales.length, 4.0);
  EXPECT_EQ(scales.force, 256.0);
  EXPECT_EQ(scales.energy(), 1024.0);
}

TEST(Scales, OfALoadlessSceneComeFromItsSprings) {
  Scene scene = test::chain(1, 1.0, 1.0);
  test::add_torsion_spring(scene, 0, 1, 30.0, 0.3);
  EXPECT_EQ(choose_scales(scene, 2.0).force, 16.0);
  scene.elements.push_back(
      test::line_spring("", test::point(scene, "ground.O"), test::point(scene, "1.b"), 1000.0, 0.0));
  EXPECT_EQ(choose_scales(scene, 2.0).force, 2048.0);
}

TEST(Scales, OfASceneOfNothingAreOne) {
  const Scales scales = choose_scales(Scene(), 0.0);
  EXPECT_EQ(scales.length, 1.0);
  EXPECT_EQ(scales.force, 1.0);
}

TEST(Scales, StayFiniteWhereLoadsDoNot) {
  Scene scene = test::chain(1, 1.0, 1.0);
  test::add_force(scene, "1.b", {1.7e308, 1.7e308}, "F");
  test::add_force(scene, "1.b", {1.7e308, 1.7e308}, "G");
  const Scales scales = choose_scales(scene, 1.0);
  EXPECT_TRUE(std::isfinite(scales.force));
  EXPECT_GT(scales.force, 0.0);
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.gravity, b.gravity);
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    EXPECT_EQ(a.bodies[i].mass, b.bodies[i].mass);
    EXPECT_EQ(a.bodies[i].inertia, b.bodies[i].inertia);
    EXPECT_EQ(a.bodies[i].center, b.bodies[i].center);
    for (std::size_t p = 0; p < a.bodies[i].points.size(); ++p) {
      EXPECT_EQ(a.bodies[i].points[p].at, b.bodies[i].points[p].at);
    }
  }
  for (std::size_t k = 0; k < a.joints.size(); ++k) {
    EXPECT_EQ(a.joints[k].length, b.joints[k].length);
    EXPECT_EQ(a.joints[k].angle, b.joints[k].angle);
    EXPECT_EQ(a.joints[k].axis, b.joints[k].axis);
  }
  for (std::size_t k = 0; k < a.elements.size(); ++k) {
    const auto* spring = std::get_if<LinearSpring>(&a.elements[k].law);
    if (spring == nullptr) continue;
    EXPECT_EQ(spring->stiffness, std::get<LinearSpring>(b.elements[k].law).stiffness);
    EXPECT_EQ(spring->free_length, std::get<LinearSpring>(b.elements[k].law).free_length);
  }
  for (std::size_t k = 0; k < a.forces.size(); ++k) EXPECT_EQ(a.forces[k].vector, b.forces[k].vector);
  for (std::size_t k = 0; k < a.torques.size(); ++k) EXPECT_EQ(a.torques[k].value, b.torques[k].value);
  for (std::size_t k = 0; k < a.stops.size(); ++k) {
    EXPECT_EQ(a.stops[k].min, b.stops[k].min);
    EXPECT_EQ(a.stops[k].max, b.stops[k].max);
  }
  EXPECT_EQ(a.start.angle, b.start.angle);
  EXPECT_EQ(a.start.travel, b.start.travel);
  EXPECT_EQ(a.start.position, b.start.position);
}

TEST(Scaled, ThereAndBackIsTheSameToTheLastBit) {
  for (const char* name : names) {
    SCOPED_TRACE(name);
    const Scene scene = read_scene(dataset(name));
    const Scales scales{0.125, 4096.0};
    expect_same(scaled(scaled(scene, scales), {8.0, 1.0 / 4096.0}), scene);
    expect_same(scaled(scene, {}), scene);
  }
}

TEST(Scaled, HasWeightsInUnitsOfForce) {
  Scene scene = test::chain(1, 2.0, 3.0);
  scene.gravity = {0.0, -10.0};
  const Scene small = scaled(scene, {4.0, 16.0});
  EXPECT_EQ(small.bodies[1].mass * norm(small.gravity), 30.0 / 16.0);
  EXPECT_EQ(small.bodies[1].center.x, 0.25);
}

TEST(Scaled, LeavesAnglesAndAbsentLimitsAlone) {
  Scene scene = test::chain(1, 2.0, 3.0);
  Stop stop;
  stop.on = Measure::angle_between(0, 1);
  stop.max = 0.75;
  scene.stops.push_back(stop);
  stop.on = Measure::distance_between({}, {});
  scene.stops.push_back(stop);
  scene.start.angle[1] = 0.3;
  const Scene small = scaled(scene, {4.0, 16.0});
  EXPECT_EQ(small.stops[0].max, 0.75);
  EXPECT_EQ(small.stops[1].max, 0.1875);
  for (const Stop& s : small.stops) EXPECT_EQ(s.min, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(small.start.angle[1], 0.3);
}

// SI value of one unit of a scaled scene's coordinates and constraint rows.
struct ScaledUnits {
  ScaledUnits(const Scene& scene, const Mechanism<double>& mechanism, const Scales& scales) {
    for (int t = 0; t < mechanism.coordinates(); ++t) {
      coordinate.push_back(t < mechanism.layout().angles ? 1.0 : scales.length);
    }
    row.assign(mechanism.equalities(), scales.length);
    for (const Stop& stop : scene.stops) row.push_back(stop.on.is_angle() ? 1.0 : scales.length);
  }
  std::vector<double> coordinate, row;
};

// Everything that the mechanism of a scene measured in `scales` says at q (given in SI), in SI, stops and follower
// loads included.
std::vector<double> all_values(const Scene& scene, Purpose purpose, const Scales& scales, std::vector<double> q) {
  const Scene measured = scaled(scene, scales);
  const Mechanism<double> mechanism(measured, lay_out(measured, purpose), purpose);
  const ScaledUnits units(scene, mechanism, scales);
  const auto n = static_cast<std::size_t>(mechanism.coordinates());
  const auto rows = static_cast<std::size_t>(mechanism.constraints());
  for (std::size_t i = 0; i < n; ++i) q[i] /= units.coordinate[i];
  std::vector<Planar<double>> pose(mechanism.pose_size());
  mechanism.place(q.data(), pose.data());
  std::vector<double> out = {mechanism.energy(q.data(), pose.data()) * scales.energy(),
                             mechanism.layout().size * scales.length};
  // The values that fill() writes, value k times unit(k).
  const auto add = [&](std::size_t count, const auto& fill, const auto& unit) {
    std::vector<double> values(count, 0.0);
    fill(values.data());
    for (std::size_t k = 0; k < count; ++k) out.push_back(values[k] * unit(k));
  };
  const auto force_unit = [&](std::size_t i) { return scales.energy() / units.coordinate[i]; };
  add(
      n, [&](double* g) { mechanism.negative_force(q.data(), pose.data(), g); }, force_unit);
  add(
      rows, [&](double* c) { mechanism.constraint(q.data(), pose.data(), c); },
      [&](std::size_t r) { return units.row[r]; });
  add(
      mechanism.jacobian_row().size(), [&](double* values) { mechanism.jacobian(pose.data(), values); },
      [&](std::size_t e) {
        return units.row[mechanism.jacobian_row()[e]] / units.coordinate[mechanism.jacobian_column()[e]];
      });
  std::vector<double> multipliers(rows);
  for (std::size_t r = 0; r < rows; ++r) multipliers[r] = 0.7 * units.row[r] / scales.energy();
  add(
      mechanism.tangent_row().size(),
      [&](double* values) { mechanism.tangent(pose.data(), multipliers.data(), values); },
      [&](std::size_t e) {
        return scales.energy() /
               (units.coordinate[mechanism.tangent_row()[e]] * units.coordinate[mechanism.tangent_column()[e]]);
      });
  std::vector<double> resistances(mechanism.resistances_size());
  mechanism.resist(pose.data(), q.data(), nullptr, resistances.data());
  add(
      n, [&](double* g) { mechanism.add_resistance(resistances.data(), g); }, force_unit);
  for (const auto* limits : {&mechanism.lower(), &mechanism.upper()}) {
    for (std::size_t s = 0; s < limits->size(); ++s) out.push_back((*limits)[s] * units.row[mechanism.stop_row(s)]);
  }
  for (const BodyPose<double>& place : mechanism.poses(q.data())) {
    out.insert(out.end(), {place.origin.x * scales.length, place.origin.y * scales.length, place.angle});
  }
  return out;
}

TEST(Scaled, AMechanismSaysTheSameToTheLastBit) {
  std::vector<Scene> scenes;
  for (const char* name : names) scenes.push_back(read_scene(dataset(name)));
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    scenes.push_back(test::plant_mechanism(seed, {.loops = 2, .followers = true, .stops = true}).scene);
  }
  const Scales scales{0.0625, 1024.0};
  for (const Scene& scene : scenes) {
    for (const Purpose purpose : {Purpose::statics, Purpose::dynamics}) {
      SCOPED_TRACE(scene.file);
      const std::vector<double> start = Mechanism<double>(scene, purpose).start();
      const Mechanism<double> small(scaled(scene, scales), purpose);
      const ScaledUnits units(scene, small, scales);
      std::vector<double> same = small.start();
      for (std::size_t i = 0; i < same.size(); ++i) same[i] *= units.coordinate[i];
      EXPECT_EQ(same, start);
      EXPECT_EQ(all_values(scene, purpose, scales, start), all_values(scene, purpose, {}, start));
    }
  }
}

TEST(Scaled, KeepsTheEquilibriumAndDividesItsForces) {
  for (const char* name : names) {
    SCOPED_TRACE(name);
    const Scene scene = read_scene(dataset(name));
    const StaticModel model(scene);
    const Equilibrium found = solve(model, test::by(Method::virtual_work));
    ASSERT_TRUE(found.found()) << found.why;
    const Scales scales{0.0625, 1024.0};
    const StaticModel other(scaled(scene, scales));
    const Equilibrium same = solve(other, test::by(Method::virtual_work));
    ASSERT_TRUE(same.found()) << same.why;
    EXPECT_EQ(to_string(same.certificate.stability), to_string(found.certificate.stability));
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      EXPECT_NEAR(test::angle_of(other, same.x, scene.bodies[i].name),
                  test::angle_of(model, found.x, scene.bodies[i].name), 1e-13);
    }
    EXPECT_NEAR(same.energy.value() * scales.energy(), found.energy.value(), 1e-11 * model.scales().energy());
    ASSERT_EQ(same.check.reactions.size(), found.check.reactions.size());
    for (std::size_t k = 0; k < same.check.reactions.size(); ++k) {
      const Vec2 difference = scales.force * same.check.reactions[k].force - found.check.reactions[k].force;
      EXPECT_LE(norm(difference), 1e-10 * found.check.largest_force) << same.check.reactions[k].name;
    }
  }
}

TEST(StaticModel, CoordinatesGoToSiAndBack) {
  const StaticModel model(read_scene(dataset("vertical_slider_crank.toml")));
  const std::vector<double> x = model.start();
  EXPECT_EQ(model.from_si(model.to_si(x)), x);
  const std::vector<double> q = model.to_si(x);
  for (int i = 0; i < model.layout().kept; ++i) {
    EXPECT_EQ(q[i], i < model.layout().angles ? x[i] : x[i] * model.scales().length);
  }
}

}  // namespace
}  // namespace poise::scaling_test
