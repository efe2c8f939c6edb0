// Which combinations of inertial parameters motion depends on: counts and closed forms of known mechanisms, and the
// physics behind them.

#include "identification/identifiability/base_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "motion/simulate.hpp"
#include "solvers/linear_algebra.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::base_parameters_test {
namespace {

// "bpc.m y + 1.5 platform.m - 2 lump.m" as a row over all parameters "body.part".
Eigen::VectorXd row_of(const std::string& combination, const std::vector<std::string>& names) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(names.size()));
  const auto add = [&](const std::string& name, double share) {
    const auto at = std::find(names.begin(), names.end(), name);
    ASSERT_NE(at, names.end()) << "\"" << name << "\" in " << combination;
    row[at - names.begin()] += share;
  };
  std::size_t begin = 0;
  double share = 1.0;
  for (;;) {
    const std::size_t end = std::min(combination.find(" + ", begin), combination.find(" - ", begin));
    add(combination.substr(begin, end == std::string::npos ? end : end - begin), share);
    if (end == std::string::npos) return row;
    const double sign = combination[end + 1] == '+' ? 1.0 : -1.0;
    char* rest = nullptr;
    share = sign * std::strtod(&combination[end + 3], &rest);
    begin = static_cast<std::size_t>(rest - combination.data()) + 1;
  }
}

std::vector<std::string> names_of(const Scene& scene, const std::vector<std::string>& bodies) {
  std::vector<std::string> names;
  for (const std::string& body : bodies) {
    for (const char* part : {".m", ".m x", ".m y", ".J"}) names.push_back(body + part);
  }
  EXPECT_GT(scene.bodies.size(), bodies.size());
  return names;
}

Eigen::MatrixXd rows_of(const BaseParameters& base, const std::vector<std::string>& names) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(base.sums.size()), static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < base.sums.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = row_of(base.sums[i].words, names).transpose();
  }
  return rows;
}

// Two sets of combinations span the same space.
void expect_same_space(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  ASSERT_EQ(a.cols(), b.cols());
  Eigen::MatrixXd both(a.rows() + b.rows(), a.cols());
  both << a, b;
  const auto rank = [](const Eigen::MatrixXd& m) {
    return solvers::rank<double>(m.transpose(), 1e-5);  // shares are written with six digits
  };
  EXPECT_EQ(rank(a), rank(b));
  EXPECT_EQ(rank(both), rank(b));
}

// Uniform unit rods a to b in series under gravity.
Scene double_pendulum(double length_of_first) {
  Scene scene;
  scene.gravity = {0, -9.81};
  scene.bodies[0].points.push_back({"O", {0, 0}});
  for (const auto& [name, length] : {std::pair{"one", length_of_first}, std::pair{"two", 0.8}}) {
    const auto link = static_cast<std::size_t>(test::add_link(scene, name, length, 1.3));
    scene.bodies[link].center = {0.4, 0.05};
    scene.bodies[link].inertia = 0.11;
    scene.start.angle[link] = -1.2;
  }
  test::add_pin(scene, "ground.O", "one.a");
  test::add_pin(scene, "one.b", "two.a");
  return scene;
}

// J1 + L^2 m2, m1 x1 + L m2, m1 y1, J2, m2 x2, m2 y2.
TEST(BaseParameters, DoublePendulumHasSix) {
  const double L = 1.7;
  const Scene scene = double_pendulum(L);
  const BaseParameters found = base_parameters(scene);
  EXPECT_EQ(found.parameters, 8);
  EXPECT_EQ(found.rank, 6);
  EXPECT_GT(found.gap, 1e6);
  ASSERT_EQ(found.sums.size(), 6U);
  EXPECT_EQ(found.without, (std::vector<std::string>{"one.m"}));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6, 8);
  expected(0, 3) = 1;
  expected(0, 4) = L * L;
  expected(1, 1) = 1;
  expected(1, 4) = L;
  expected(2, 2) = 1;
  expected(3, 7) = 1;
  expected(4, 5) = 1;
  expected(5, 6) = 1;
  expect_same_space(rows_of(found, names_of(scene, {"one", "two"})), expected);
}

// Without gravity the first rod's centre does not matter: J1 + L^2 m2, J2, m2 x2, m2 y2.
TEST(BaseParameters, DoublePendulumOnALevelTableHasFour) {
  const double L = 1.7;
  Scene scene = double_pendulum(L);
  scene.gravity = {};
  const BaseParameters found = base_parameters(scene);
  EXPECT_EQ(found.rank, 4);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(4, 8);
  expected(0, 3) = 1;
  expected(0, 4) = L * L;
  expected(1, 7) = 1;
  expected(2, 5) = 1;
  expected(3, 6) = 1;
  expect_same_space(rows_of(found, names_of(scene, {"one", "two"})), expected);
}

// A point mass moved through one of the four pins to the other body changes no motion: 12 - 4.
TEST(BaseParameters, FourBarHasEight) {
  const Scene scene = test::four_bar_with_everything();
  const BaseParameters found = base_parameters(scene);
  EXPECT_EQ(found.parameters, 12);
  EXPECT_EQ(found.rank, 8);
  // A unit mass at a pin is (1, x, y, x^2 + y^2) of the one body, and less of the other: no base parameter changes.
  const Eigen::MatrixXd rows = rows_of(found, names_of(scene, {"crank", "coupler", "rocker"}));
  const auto at = [](int body, Vec2 p) {
    Eigen::VectorXd lump = Eigen::VectorXd::Zero(12);
    lump.segment(4 * body, 4) << 1, p.x, p.y, dot(p, p);
    return lump;
  };
  for (const Eigen::VectorXd& moved : {at(0, {0, 0}), Eigen::VectorXd(at(0, {0.4, 0}) - at(1, {0, 0})),
                                       Eigen::VectorXd(at(1, {1, 0}) - at(2, {0.8, 0})), at(2, {0, 0})}) {
    EXPECT_LT((rows * moved).cwiseAbs().maxCoeff(), 1e-4) << moved.transpose();
  }
}

// Its coupler only shifts, its cranks turn as one: J1 + J3 + L^2 m2, m1 x1 + m3 x3 + L m2, m1 y1 + m3 y3.
TEST(BaseParameters, ParallelogramHasThree) {
  Scene scene;
  scene.gravity = {0, -9.81};
  scene.bodies[0].points = {{"A", {0, 0}}, {"D", {2, 0}}};
  for (const auto& [name, length] : {std::pair{"left", 0.7}, std::pair{"top", 2.0}, std::pair{"right", 0.7}}) {
    const auto link = static_cast<std::size_t>(test::add_link(scene, name, length, 1.0));
    scene.bodies[link].center = {length / 3, 0.02};
    scene.bodies[link].inertia = 0.05;
  }
  test::add_pin(scene, "ground.A", "left.a");
  test::add_pin(scene, "left.b", "top.a");
  test::add_pin(scene, "top.b", "right.b");
  test::add_pin(scene, "ground.D", "right.a");
  scene.start.angle[1] = 1.1;
  scene.start.angle[2] = 0.0;
  scene.start.angle[3] = 1.1;
  const BaseParameters found = base_parameters(scene);
  EXPECT_EQ(found.rank, 3);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 12);
  expected(0, 3) = expected(0, 11) = 1;
  expected(0, 4) = 0.49;
  expected(1, 1) = expected(1, 9) = 1;
  expected(1, 4) = 0.7;
  expected(2, 2) = expected(2, 10) = 1;
  expect_same_space(rows_of(found, names_of(scene, {"left", "top", "right"})), expected);
}

// Nine bodies; each of 12 pins hides one direction and the slide another.
TEST(BaseParameters, LiftHas23Of36) {
  Scene scene = read_scene(test::dataset("lift.toml"));
  set_value(scene, "body.payload.mass", 0);
  const BaseParameters found = base_parameters(scene);
  EXPECT_EQ(found.parameters, 36);
  EXPECT_EQ(found.rank, 23);
  EXPECT_GT(found.gap, 1e3);
  EXPECT_EQ(found.sums.size(), 23U);
  const Eigen::MatrixXd rows =
      rows_of(found, names_of(scene, {"obd", "def", "fa", "cylinder", "rod", "bpc", "ecg", "gl", "platform"}));
  // The slide keeps cylinder and rod parallel: only the sum of their inertias matters.
  const double largest = rows.cwiseAbs().maxCoeff();
  EXPECT_LT((rows.col(4 * 3 + 3) - rows.col(4 * 4 + 3)).cwiseAbs().maxCoeff(), 1e-5 * largest);
}

TEST(BaseParameters, NoneWhereNothingHasInertia) {
  Scene scene = test::chain(1, 1.0, 0.0);
  const BaseParameters found = base_parameters(scene);
  EXPECT_EQ(found.parameters, 0);
  EXPECT_EQ(found.rank, 0);
  EXPECT_TRUE(found.sums.empty());
}

// Adds the point mass m at p to a body.
void add_lump(Body& body, double m, Vec2 p) {
  const Vec2 first = body.mass * body.center + m * p;
  const double about_origin = body.inertia + body.mass * dot(body.center, body.center) + m * dot(p, p);
  body.mass += m;
  body.center = (1 / body.mass) * first;
  body.inertia = about_origin - body.mass * dot(body.center, body.center);
}

// The assumption behind the counts: a point mass moved through a pin changes no motion, moved to elsewhere it does.
TEST(BaseParameters, AMassMovedThroughAPinChangesNoMotion) {
  const auto after = [](const Scene& scene) {
    const MotionModel model(scene);
    MotionOptions options;
    options.duration = 2.0;
    const Motion motion = simulate(model, start_motion(model, {}), options);
    EXPECT_TRUE(motion.completed()) << motion.why;
    return std::vector<double>(motion.trajectory.q.end() - motion.trajectory.coordinates, motion.trajectory.q.end());
  };
  const Scene scene = test::four_bar_with_everything();
  const std::vector<double> before = after(scene);
  const auto change = [&](Vec2 from, Vec2 to) {
    Scene other = scene;
    add_lump(other.bodies[2], -0.4, from);
    add_lump(other.bodies[3], 0.4, to);
    const std::vector<double> q = after(other);
    double worst = 0.0;
    for (std::size_t i = 0; i < q.size(); ++i) worst = std::max(worst, std::abs(q[i] - before[i]));
    return worst;
  };
  EXPECT_LT(change({1, 0}, {0.8, 0}), 1e-8);  // pin C
  EXPECT_GT(change({1, 0}, {0.75, 0}), 1e-4);
}

}  // namespace
}  // namespace poise::base_parameters_test
