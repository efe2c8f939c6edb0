// The reference answers made for this project, ../shared/references: closed forms and certified sets, far beyond
// double precision. Each equilibrium is sought from starts near it and has to be met to 1e-12 by virtual work, and to
// 1e-9 by minimum energy where it is stable, with its stability.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/reference.hpp"
#include "statics/proof/principal_directions.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::references_test {
namespace {

using nlohmann::json;
using test::dataset;
using test::number;
using Pose = std::map<std::string, double>;

constexpr double virtual_work_tolerance = 1e-12;  // rad, or lengths over the mechanism's size
constexpr double energy_tolerance = 1e-9;
constexpr double gravity = 9.81;

std::filesystem::path references() {
  return std::filesystem::path(POISE_SOURCE_DIR).parent_path() / "shared" / "references" / "references.json";
}

class References : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(references())) GTEST_SKIP() << references() << " is not there";
  }

  const json& at(const std::string& key) {
    static const json all = test::read_json(references());
    return all.at(key);
  }
};

struct Search {
  double reach = 0.02;     ///< starts are this far from the known pose, rad and m
  bool near_fold = false;  ///< allow what rounding does to equilibria that nearly coincide
  int falling = -1;        ///< expected number of unstable directions if known
};

// Guesses shifted by up to reach.
Pose shifted(const Pose& pose, double reach, unsigned seed) {
  std::vector<double> values;
  for (const auto& [name, value] : pose) values.push_back(value);
  values = test::perturbed(values, reach, seed);
  Pose out = pose;
  std::size_t k = 0;
  for (auto& [name, value] : out) value = values[k++];
  return out;
}

void expect_at(const StaticModel& model, const Equilibrium& found, const Pose& known, Stability stability,
               double tolerance, const Search& search) {
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  const double rounding = search.near_fold ? found.certificate.radius + found.certificate.rounding_effect : 0.0;
  ASSERT_LE(test::error_of(model, found.x, known), std::max(tolerance, rounding));
  EXPECT_EQ(to_string(found.certificate.stability), to_string(stability));
  if (search.falling >= 0) {
    EXPECT_EQ(found.certificate.unstable_directions, search.falling);
  }
}

std::string in_words(const Pose& pose) { return json(pose).dump(); }

// Solves from starts near the known pose by virtual work and, where it is stable, by energy.
void expect_met(const Scene& scene, const Pose& known, Stability stability, const Search& search = {}) {
  SCOPED_TRACE(in_words(known));
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("start " + std::to_string(seed));
    const StaticModel model(test::started_at(scene, shifted(known, search.reach, seed)));
    expect_at(model, solve(model, test::by(Method::virtual_work)), known, stability, virtual_work_tolerance, search);
    if (stability == Stability::stable) {
      SCOPED_TRACE("by energy");
      expect_at(model, solve(model, test::by(Method::energy)), known, stability, energy_tolerance, search);
    }
  }
}

Stability stability_of(bool stable) { return stable ? Stability::stable : Stability::unstable; }

void expect_distinct(const std::vector<Pose>& poses, std::size_t count) {
  EXPECT_EQ(poses.size(), count);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(poses[i], poses[j]);
  }
}

double potential_difference(const Scene& scene, const Pose& a, const Pose& b) {
  const StaticModel model(test::started_at(scene, a));
  const StaticModel other(test::started_at(scene, b));
  return solve(model, test::by(Method::virtual_work)).energy.value() -
         solve(other, test::by(Method::virtual_work)).energy.value();
}

// --- four-bars
// --------------------------------------------------------------------------------------------------------

TEST_F(References, CrankRocker) {
  const json& reference = at("static.fourbar.crankrocker");
  const Scene scene = read_scene(dataset("four_bar_gravity.toml"));
  std::vector<Pose> poses;
  for (const json& e : reference.at("equilibria")) {
    const double crank = number(e.at("crank"));
    const double rocker = number(e.at("rocker"));
    const Vec2 b = 2.0 * unit(crank);
    const Vec2 c = Vec2{4.0, 1.0} + 3.0 * unit(rocker);
    poses.push_back({{"crank", crank}, {"rocker", rocker}, {"coupler", std::atan2(c.y - b.y, c.x - b.x)}});
    expect_met(scene, poses.back(), stability_of(e.at("stable")), {.falling = e.at("stable") ? 0 : 1});
    const double rise = number(e.at("V")) - number(reference.at("equilibria").at(0).at("V"));
    EXPECT_NEAR(potential_difference(scene, poses.back(), poses.front()), rise, 1e-11);
  }
  expect_distinct(poses, reference.at("count"));
}

TEST_F(References, FourBarOnTorsionSprings) {
  const json& reference = at("static.fourbar_torsion.k1_2_1.5_0.5");
  const Scene scene = read_scene(dataset("four_bar_torsion.toml"));
  std::vector<Pose> poses;
  for (const json& e : reference.at("equilibria")) {
    poses.push_back(
        {{"crank", number(e.at("crank"))}, {"coupler", number(e.at("coupler"))}, {"rocker", number(e.at("rocker"))}});
    expect_met(scene, poses.back(), stability_of(e.at("stable")), {.falling = e.at("stable") ? 0 : 1});
    const StaticModel model(test::started_at(scene, poses.back()));
    EXPECT_NEAR(solve(model, test::by(Method::virtual_work)).energy.value(), number(e.at("V")), 1e-12);
  }
  expect_distinct(poses, reference.at("count"));
}

TEST_F(References, HeatonTimme) {
  const json& reference = at("static.heaton_timme.default");
  const Scene scene = read_scene(dataset("heaton_timme.toml"));
  std::vector<Pose> poses;
  for (const json& e : reference.at("equilibria")) {
    const Vec2 c{number(e.at("C")[0]), number(e.at("C")[1])};
    const Vec2 d{number(e.at("D")[0]), number(e.at("D")[1])};
    poses.push_back({{"left", number(e.at("alpha"))},
                     {"right", number(e.at("beta"))},
                     {"coupler", std::atan2(c.y - d.y, c.x - d.x)}});
    expect_met(scene, poses.back(), stability_of(e.at("stable")), {.falling = e.at("stable") ? 0 : 1});
    const StaticModel model(test::started_at(scene, poses.back()));
    const Equilibrium found = solve(model, test::by(Method::virtual_work));
    EXPECT_LE(norm(test::place_of(model, found.x, "coupler.C") - c), 1e-12);
    EXPECT_LE(norm(test::place_of(model, found.x, "coupler.D") - d), 1e-12);
    EXPECT_NEAR(found.energy.value(), number(e.at("V")), 1e-12 * 200);
    EXPECT_NEAR(norm(c - Vec2{4, 3}), number(e.at("cable_lengths")[0]), 1e-12);
    EXPECT_NEAR(norm(d - Vec2{-6, 2}), number(e.at("cable_lengths")[1]), 1e-12);
  }
  expect_distinct(poses, reference.at("count"));
}

// --- one freedom
// ------------------------------------------------------------------------------------------------------

Scene zeeman(const json& reference) {
  Scene scene = read_scene(dataset("zeeman.toml"));
  scene.bodies[0].points[test::point(scene, "ground.fixed").point].at = {number(reference.at("p1")[0]),
                                                                         number(reference.at("p1")[1])};
  scene.bodies[0].points[test::point(scene, "ground.hand").point].at = {number(reference.at("p2")[0]),
                                                                        number(reference.at("p2")[1])};
  return scene;
}

// V'' of the only freedom, J/rad^2.
double curvature_at(const Scene& scene, const Pose& pose) {
  const StaticModel model(test::started_at(scene, pose));
  return principal_directions(model, solve(model, test::by(Method::virtual_work)).certificate).at(0).curvature;
}

TEST_F(References, ZeemansMachine) {
  const json& reference = at("static.zeeman.demo");
  const Scene scene = zeeman(reference);
  for (const json& e : reference.at("equilibria")) {
    const Pose pose{{"disc", number(e.at("theta"))}};
    const double d2v = number(e.at("d2V"));
    expect_met(scene, pose, stability_of(d2v > 0), {.falling = d2v > 0 ? 0 : 1});
    EXPECT_NEAR(curvature_at(scene, pose), d2v, 1e-12);
  }
}

// Three of the four equilibria lie within 0.0022 rad of pi, between curvatures of 1e-6: a unit in the last place of a
// spring force moves them by 1e-10 rad.
TEST_F(References, ZeemansMachineNextToItsCusp) {
  const json& reference = at("static.zeeman.sym-249999/1000000");
  const Scene scene = zeeman(reference);
  std::vector<Pose> poses;
  for (const json& e : reference.at("equilibria")) {
    poses.push_back({{"disc", number(e.at("theta"))}});
    const double d2v = number(e.at("d2V"));
    expect_met(scene, poses.back(), stability_of(d2v > 0),
               {.reach = 2e-4, .near_fold = true, .falling = d2v > 0 ? 0 : 1});
    const StaticModel model(test::started_at(scene, poses.back()));
    const Reference refined = refine(model, solve(model, test::by(Method::virtual_work)).x);
    ASSERT_TRUE(refined.refined) << refined.why;
    EXPECT_NEAR(refined.x.at(0), poses.back().at("disc"), virtual_work_tolerance) << "in 50 digits";
    EXPECT_NEAR(curvature_at(scene, poses.back()), d2v, 1e-9 * std::abs(d2v));
  }
  expect_distinct(poses, reference.at("count"));
}

TEST_F(References, VonMisesToggle) {
  const json& reference = at("static.vonmises.k1000_b1_h05");
  for (const auto& [ratio, heights] : reference.at("eqs").items()) {
    SCOPED_TRACE("P / P_limit = " + ratio);
    Scene scene = read_scene(dataset("von_mises_toggle.toml"));
    set_value(scene, "load.P", std::stod(ratio) * number(reference.at("P_limit")));
    const double apart = number(heights.at("stable_upper")) - number(heights.at("unstable"));
    const Search search{.reach = std::min(0.02, 0.1 * apart), .near_fold = ratio == "0.9999999999", .falling = 0};
    expect_met(scene, {{"guide", number(heights.at("stable_upper"))}}, Stability::stable, search);
    expect_met(scene, {{"guide", number(heights.at("stable_lower"))}}, Stability::stable, {.falling = 0});
    Search unstable = search;
    unstable.falling = 1;
    expect_met(scene, {{"guide", number(heights.at("unstable"))}}, Stability::unstable, unstable);
  }
}

Pose toggle_pose(double alpha) { return {{"left", alpha}, {"right", -alpha}, {"rail", 0.6 * std::cos(alpha)}}; }

// At P_max (1 - eps) two equilibria are sqrt(eps) apart and their curvature falls as sqrt(eps). The spring is shorter
// by only 8 mm of 412, so rounding its free length to double changes its force by 7e-15 of itself: for eps = 1e-14 that
// alone moves the pair by a good part of its 2e-8 rad. What double can say then is which is which.
TEST_F(References, ToggleNextToSnapping) {
  const json& reference = at("static.toggle");
  const double alpha_c = number(reference.at("alpha_c"));
  for (const auto& [eps, pair] : reference.at("near").items()) {
    SCOPED_TRACE("P / P_max = 1 - " + eps);
    Scene scene = read_scene(dataset("toggle.toml"));
    set_value(scene, "load.P", number(reference.at("P_max")) * (1.0 - std::stod(eps)));
    for (const bool stable : {true, false}) {
      const double alpha = number(pair[stable ? 0 : 1]);
      const double from_fold = std::abs(alpha - alpha_c);
      const double data_rounding = from_fold * 7e-15 / std::stod(eps);
      const StaticModel model(test::started_at(scene, toggle_pose(alpha + 0.1 * (alpha - alpha_c))));
      const Equilibrium found = solve(model, test::by(Method::virtual_work));
      ASSERT_EQ(found.status, Status::confirmed) << found.why;
      EXPECT_EQ(to_string(found.certificate.stability), to_string(stability_of(stable)));
      const double left = test::angle_of(model, found.x, "left");
      EXPECT_NEAR(left, alpha, std::max(virtual_work_tolerance, data_rounding));
      EXPECT_EQ(left > alpha_c, stable);
      const Reference refined = refine(model, found.x);
      EXPECT_TRUE(refined.refined) << refined.why;
      if (!stable) continue;
      const Equilibrium least = solve(model, test::by(Method::energy));
      ASSERT_EQ(least.status, Status::confirmed) << least.why;
      EXPECT_EQ(to_string(least.certificate.stability), "stable");
      EXPECT_NEAR(test::angle_of(model, least.x, "left"), alpha, std::max(energy_tolerance, data_rounding));
    }
  }
}

// 1 N on the knee balances 1 / (2 tan alpha) N on the slider.
TEST_F(References, MechanicalAdvantageOfAToggle) {
  for (const auto& [text, ratio] : at("static.toggle_MA").items()) {
    Scene scene = read_scene(dataset("toggle.toml"));
    test::erase_elements(scene, "spring");
    set_value(scene, "load.P", 1.0);
    test::add_force(scene, "block.C", {-number(ratio), 0.0}, "R");
    const double alpha = std::stod(text);
    expect_met(scene, toggle_pose(alpha), Stability::unstable, {.reach = std::min(0.02, 0.1 * alpha), .falling = 1});
    const StaticModel model(test::started_at(scene, toggle_pose(1.1 * alpha)));
    EXPECT_NEAR(test::angle_of(model, solve(model, test::by(Method::virtual_work)).x, "left"), alpha, 1e-12 * alpha)
        << "relative";
  }
}

// theta = offset + lambda sin(theta), theta from the upright.
Scene inverted_pendulum(double lambda, double offset = 0.0) {
  Scene scene;
  scene.gravity = {0.0, -1.0};
  scene.add_point(0, "O", {0.0, 0.0});
  const int rod = scene.add_body("rod");
  scene.add_point(rod, "O", {0.0, 0.0});
  scene.bodies[rod].center = {0.0, 1.0};
  scene.bodies[rod].mass = lambda;
  test::add_pin(scene, "ground.O", "rod.O");
  test::add_torsion_spring(scene, 0, rod, 1.0, offset);
  return scene;
}

TEST_F(References, InvertedPendulumOnATorsionSpring) {
  for (const auto& [lambda, entry] : at("static.inverted_pendulum_torsion").items()) {
    if (!entry.contains("positive_roots")) continue;
    SCOPED_TRACE("lambda = " + lambda);
    const Scene scene = inverted_pendulum(std::stod(lambda));
    const bool nearly_flat = std::abs(std::stod(lambda) - 1.0) < 1e-3;
    std::vector<Pose> poses{{{"rod", 0.0}}};
    if (lambda == "1") {
      // A minimum of fourth order, V = theta^2/2 + cos(theta) = 1 + theta^4/24 - ..., proved by the signs of the force
      // on both sides.
      const StaticModel model(scene);
      const Equilibrium found = solve(model, test::by(Method::virtual_work));
      ASSERT_EQ(found.status, Status::confirmed) << found.why;
      EXPECT_LE(std::abs(found.x.at(0)), found.certificate.radius);
      EXPECT_LE(found.certificate.radius, 1e-15);
      EXPECT_EQ(found.certificate.outcome, Outcome::degenerate);
      EXPECT_EQ(to_string(found.certificate.stability), "stable");
      EXPECT_EQ(found.certificate.neutral_directions, 0);
    } else {
      expect_met(scene, poses[0], stability_of(entry.at("zero_stable")), {.reach = nearly_flat ? 2e-4 : 0.02});
    }
    for (std::size_t k = 0; k < entry.at("positive_roots").size(); ++k) {
      const double root = number(entry.at("positive_roots")[k]);
      for (const double sign : {1.0, -1.0}) {
        poses.push_back({{"rod", sign * root}});
        expect_met(scene, poses.back(), stability_of(entry.at("stable")[k]), {.reach = nearly_flat ? 2e-4 : 0.02});
      }
    }
    expect_distinct(poses, entry.at("count"));
  }
}

// A root of theta - offset - lambda sin(theta) next to `guess`, in extended precision.
double root_of_imperfect(long double lambda, long double offset, long double guess) {
  for (int k = 0; k < 60; ++k) {
    guess -= (guess - offset - lambda * std::sin(guess)) / (1.0L - lambda * std::cos(guess));
  }
  return static_cast<double>(guess);
}

// The second pair of roots of the perfect pendulum, and the one of the imperfect one, are born in a fold: none before,
// two after, one of them stable.
TEST_F(References, FoldsOfThePendulum) {
  struct Fold {
    double lambda, theta, offset;
  };
  std::vector<Fold> folds;
  for (const char* name : {"second_pair_born", "third_pair_born"}) {
    const json& born = at("static.inverted_pendulum_torsion").at(name);
    folds.push_back({number(born.at("lam")), number(born.at("theta")), 0.0});
  }
  for (const auto& [offset, fold] : at("static.inverted_pendulum_imperfect").items()) {
    folds.push_back({number(fold.at("lam_fold")), number(fold.at("theta_fold")), std::stod(offset)});
  }
  for (const Fold& fold : folds) {
    SCOPED_TRACE("lambda = " + std::to_string(fold.lambda) + ", theta = " + std::to_string(fold.theta));
    // V = (theta - offset)^2 / 2 + lambda cos(theta), so V''' = lambda sin(theta) at the fold: the half distance of the
    // pair for a small change of lambda.
    const double change = 1e-4 * std::min(1.0, std::abs(fold.theta));
    const double half = std::sqrt(2.0 * change);
    const double reach = 0.02 * half;
    const Scene after = inverted_pendulum(fold.lambda * (1.0 + change), fold.offset);
    for (const double side : {1.0, -1.0}) {
      const long double lambda = fold.lambda * (1.0 + change);
      const double root = root_of_imperfect(lambda, fold.offset, fold.theta + side * half);
      EXPECT_EQ(root > fold.theta, side > 0);
      const bool stable = std::abs(root) > std::abs(fold.theta);
      expect_met(after, {{"rod", root}}, stability_of(stable), {.reach = reach});
    }
    const StaticModel before(
        test::started_at(inverted_pendulum(fold.lambda * (1.0 - change), fold.offset), {{"rod", fold.theta}}));
    for (const Method method : {Method::virtual_work, Method::energy}) {
      const Equilibrium found = solve(before, test::by(method));
      EXPECT_NE(found.status, Status::not_confirmed) << found.why;
      if (found.found()) {
        EXPECT_GT(std::abs(found.x.at(0) - fold.theta), half) << to_string(method);
      }
    }
    const StaticModel upon(test::started_at(inverted_pendulum(fold.lambda, fold.offset), {{"rod", fold.theta}}));
    const Certificate at_fold = certify(upon, upon.start());
    // Rounded to a double, lambda lies on one side of the fold or the other: there are two equilibria some 1e-8 apart,
    // or none.
    if (at_fold.confirmed()) {
      EXPECT_LE(std::abs(principal_directions(upon, at_fold).at(0).curvature), 1e-6);
      EXPECT_GE(at_fold.rounding_effect, 1e-9);
      EXPECT_TRUE(refine(upon, at_fold.x).refined);
    } else {
      EXPECT_FALSE(refine(upon, upon.start()).refined) << at_fold.statement;
    }
  }
}

// --- chains
// -----------------------------------------------------------------------------------------------------------

// Bit i of `turned` turns link i round, which is again an equilibrium with one more unstable direction.
Pose tip_force_pose(int links, double force, double mass, unsigned turned) {
  Pose pose;
  for (int i = 1; i <= links; ++i) {
    const double from_vertical = std::atan2(force, (links - i + 0.5) * mass * gravity);
    const bool round = i <= 32 && (turned >> (i - 1) & 1u) != 0;
    pose[std::to_string(i)] = from_vertical - 0.5 * M_PI + (round ? M_PI : 0.0);
  }
  return pose;
}

Scene tip_force_chain(int links, double force, double length, double mass) {
  Scene scene = test::chain(links, length, mass);
  scene.gravity = {0.0, -gravity};
  test::add_force(scene, std::to_string(links) + ".b", {force, 0.0}, "F");
  return scene;
}

void expect_tip_and_support(const Scene& scene, const json& reference, int links) {
  const StaticModel model(scene);
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  EXPECT_EQ(to_string(found.certificate.stability), "stable");
  const Vec2 tip{number(reference.at("tip")[0]), number(reference.at("tip")[1])};
  EXPECT_LE(norm(test::place_of(model, found.x, std::to_string(links) + ".b") - tip), 1e-12 * model.scales().length);
  const Vec2 support{number(reference.at("support_reaction")[0]), number(reference.at("support_reaction")[1])};
  const Reaction& reaction = test::reaction_of(found.check, "joint1");
  // Links far shorter than the chain balance moments far smaller than forces.
  EXPECT_LE(norm(reaction.force - support), 1e-14 * std::max(100, links) * norm(support));
}

TEST_F(References, ChainPulledAtItsTip) {
  for (const auto& [links, force] : std::map<int, double>{{2, 10.0}, {5, 10.0}, {10, 1.0}}) {
    SCOPED_TRACE(std::to_string(links) + " links");
    const std::string key = "n" + std::to_string(links) + "_F" + std::to_string(static_cast<int>(force));
    const json& reference = at("static.nlink_tipforce").at(key);
    const Scene scene = tip_force_chain(links, force, 1.0, 1.0);
    const Pose hanging = tip_force_pose(links, force, 1.0, 0);
    for (int i = 1; i <= links; ++i) {
      const double known = number(reference.at("angles_from_vertical")[i - 1]) - 0.5 * M_PI;
      EXPECT_NEAR(hanging.at(std::to_string(i)), known, 1e-15);
    }
    EXPECT_EQ(reference.at("equilibria_total"), "2^" + std::to_string(links));
    for (unsigned turned = 0; turned < 1u << links; ++turned) {
      const Pose pose = tip_force_pose(links, force, 1.0, turned);
      const StaticModel model(test::started_at(scene, shifted(pose, 0.02, turned)));
      const int falling = __builtin_popcount(turned);
      expect_at(model, solve(model, test::by(Method::virtual_work)), pose, stability_of(falling == 0),
                virtual_work_tolerance, {.falling = falling});
    }
    expect_met(scene, hanging, Stability::stable, {.reach = 0.05, .falling = 0});
    expect_tip_and_support(test::started_at(scene, shifted(hanging, 0.05, 4)), reference, links);
  }
}

TEST_F(References, LongChainsPulledAtTheirTip) {
  struct Case {
    const char* key;
    int links;
    double force;
  };
  for (const Case& c : {Case{"n100_F25", 100, 25.0}, Case{"n100000_F1000", 100000, 1000.0}}) {
    SCOPED_TRACE(c.key);
    const json& reference = at("static.nlink_tipforce").at(c.key);
    const double mass = number(reference.at("link_mass"));
    Scene scene = tip_force_chain(c.links, c.force, number(reference.at("link_length")), mass);
    Pose known = tip_force_pose(c.links, c.force, mass, 0);
    Pose start = shifted(known, 0.02, 1);
    for (int i = 1; i <= c.links; ++i) scene.start.angle[i] = start.at(std::to_string(i));
    expect_tip_and_support(scene, reference, c.links);
  }
}

// Horizontal pull from the reaction of the end pin, and sag at the middle.
TEST_F(References, HangingChains) {
  const json& reference = at("static.hanging_chain_span06");
  for (const int links : {3, 4, 10, 100, 1000, 10000}) {
    SCOPED_TRACE(std::to_string(links) + " links");
    const json& known = reference.at("n" + std::to_string(links));
    const StaticModel model(test::hanging_chain(links, 1.0, 1.0, 0.6));
    for (const Method method : {Method::virtual_work, Method::energy}) {
      SCOPED_TRACE(to_string(method));
      const Equilibrium found = solve(model, test::by(method));
      ASSERT_EQ(found.status, Status::confirmed) << found.why;
      EXPECT_EQ(to_string(found.certificate.stability), "stable");
      const double tolerance = method == Method::energy ? energy_tolerance : virtual_work_tolerance;
      const double sag = -test::place_of(model, found.x, std::to_string(links / 2) + ".b").y;
      EXPECT_NEAR(sag, number(known.at("sag")), tolerance);
      const Reaction& end = test::reaction_of(found.check, "end");
      EXPECT_NEAR(end.force.x, -number(known.at("H")), tolerance);
      EXPECT_NEAR(std::abs(end.force.y), 0.5, tolerance);
    }
  }
}

// --- buckling
// ---------------------------------------------------------------------------------------------------------

// n rigid links of 1 m from a clamped base along +x, a torsion spring of 1 N m/rad at every joint, a dead load of
// kappa N back along -x at the tip.
Scene cantilever(int links, double kappa) {
  Scene scene = test::chain(links, 1.0, 0.0);
  for (int i = 1; i <= links; ++i) test::add_torsion_spring(scene, i - 1, i, 1.0);
  test::add_force(scene, std::to_string(links) + ".b", {-kappa, 0.0}, "P");
  return scene;
}

TEST_F(References, BuckledCantilevers) {
  int sets = 0;
  for (const auto& [key, set] : at("static.hencky_cantilever").items()) {
    const std::size_t cut = key.find("_kappa");
    if (cut == std::string::npos) continue;
    SCOPED_TRACE(key);
    ++sets;
    const int links = std::stoi(key.substr(1, cut - 1));
    const Scene scene = cantilever(links, std::stod(key.substr(cut + 6)));
    std::vector<Pose> poses;
    std::map<std::string, int> by_index;
    for (const json& angles : set.at("equilibria")) {
      Pose pose;
      for (int i = 1; i <= links; ++i) pose[std::to_string(i)] = number(angles[i - 1]);
      poses.push_back(pose);
      const StaticModel model(test::started_at(scene, pose));
      const int falling = solve(model, test::by(Method::virtual_work)).certificate.unstable_directions;
      ++by_index[std::to_string(falling)];
      expect_met(scene, pose, stability_of(falling == 0), {.falling = falling});
    }
    expect_distinct(poses, set.at("count"));
    EXPECT_EQ(json(by_index), set.at("by_index"));
  }
  EXPECT_EQ(sets, 8);
}

// The straight column loses one more direction at each critical load.
TEST_F(References, CriticalLoadsOfCantilevers) {
  for (const int links : {1, 2, 3}) {
    const json& critical = at("static.hencky_cantilever").at("kcr_n" + std::to_string(links));
    for (std::size_t k = 0; k < critical.size(); ++k) {
      for (const double side : {-1e-9, 1e-9}) {
        const StaticModel model(cantilever(links, number(critical[k]) * (1.0 + side)));
        const Check straight = check(model, model.start());
        EXPECT_TRUE(straight.is_equilibrium()) << straight.objection;
        const Certificate proof = certify(model, model.start());
        EXPECT_EQ(to_string(proof.outcome), "proved") << proof.statement;
        EXPECT_EQ(proof.unstable_directions, static_cast<int>(k) + (side > 0 ? 1 : 0)) << links << " links";
      }
    }
  }
}

// --- redundant and singular mechanisms
// --------------------------------------------------------------------------------

TEST_F(References, ScissorLifts) {
  for (const auto& [key, force] : at("static.scissor_lift").at("values").items()) {
    SCOPED_TRACE(key);
    const std::size_t cut = key.find("_theta");
    const int stages = std::stoi(key.substr(1, cut - 1));
    const double theta = std::stod(key.substr(cut + 6));
    Scene scene = test::scissor(stages, 50.0, 1000.0, theta);
    test::add_force(scene, "fall1.a", {-number(force), 0.0}, "F");
    Pose known{{"base", std::cos(theta)}, {"top", std::cos(theta)}};
    for (int s = 1; s <= stages; ++s) {
      known["rise" + std::to_string(s)] = theta;
      known["fall" + std::to_string(s)] = M_PI - theta;
    }
    // Almost flat, closure tells angles only through their cosine: eps / theta is left of them.
    const bool flat = theta < 1e-3;
    const StaticModel model(test::started_at(scene, shifted(known, std::min(0.01, 0.02 * theta), 1)));
    const Equilibrium found = solve(model, test::by(Method::virtual_work));
    ASSERT_EQ(found.status, Status::confirmed) << found.why;
    EXPECT_LE(test::error_of(model, found.x, known), flat ? 1e-15 / theta : virtual_work_tolerance);
    EXPECT_EQ(to_string(found.certificate.stability), "unstable");
    const Reference refined = refine(model, found.x);
    ASSERT_TRUE(refined.refined) << refined.why;
    EXPECT_LE(test::error_of(model, refined.x, known), 1e-14) << "in 50 digits";
  }
}

// A stop in place of the force: its reaction is the force.
TEST_F(References, ScissorLiftsHeldByAStop) {
  for (const auto& [key, force] : at("static.scissor_lift").at("values").items()) {
    SCOPED_TRACE(key);
    const std::size_t cut = key.find("_theta");
    const double theta = std::stod(key.substr(cut + 6));
    if (theta < 1e-3) continue;  // cos(theta) determines theta too poorly in double
    Scene scene = test::scissor(std::stoi(key.substr(1, cut - 1)), 50.0, 1000.0, theta);
    Stop stop;
    stop.name = "buffer";
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      if (scene.joints[j].name == "base") stop.on = Measure::travel_of(static_cast<int>(j));
    }
    stop.max = std::cos(theta);
    scene.stops.push_back(stop);
    const StaticModel model(scene);
    for (const Method method : {Method::virtual_work, Method::energy}) {
      const Equilibrium found = solve(model, test::by(method, Seek::stable));
      ASSERT_EQ(found.status, Status::confirmed) << found.why;
      EXPECT_EQ(to_string(found.certificate.stability), "stable");
      EXPECT_NEAR(test::reaction_of(found.check, "buffer").force.x, -number(force), 1e-9 * number(force))
          << to_string(method);
    }
  }
}

// The cranks as weightless bars, so that statics has their three axial forces and nothing else to share out. The
// holding torque on the first crank acts on the coupler across that crank.
TEST_F(References, ParallelogramWithThreeCranks) {
  for (const auto& [text, known] : at("static.redundant_parallelogram").at("values").items()) {
    SCOPED_TRACE("theta = " + text);
    const double theta = std::stod(text);
    Scene scene;
    const int coupler = scene.add_body("coupler");
    for (int i = 0; i < 3; ++i) {
      const std::string number = std::to_string(i + 1);
      scene.add_point(0, "A" + number, {static_cast<double>(i), 0.0});
      scene.add_point(coupler, "B" + number, {static_cast<double>(i), 0.0});
      test::add_bar(scene, "ground.A" + number, "coupler.B" + number, 1.0, "crank" + number);
    }
    test::add_force(scene, "coupler.B2", {0.0, -100.0}, "W");
    test::add_force(scene, "coupler.B1", number(known.at("T")) * quarter_turn(unit(theta)), "T");
    const StaticModel model(scene);
    std::vector<double> start = model.start();
    for (std::size_t i = 0; i < start.size(); ++i) {
      if (model.layout().coordinates[i].name != "coupler") start[i] = 1.01 * theta;
    }
    const Equilibrium found = solve(model, start, test::by(Method::virtual_work));
    ASSERT_EQ(found.status, Status::confirmed) << found.why;
    EXPECT_LE(norm(test::place_of(model, found.x, "coupler.B1") - unit(theta)), 1e-12);
    EXPECT_EQ(found.check.redundancy, 1);
    EXPECT_EQ(to_string(found.certificate.stability), "unstable");
    for (int i = 0; i < 3; ++i) {
      const Reaction& crank = test::reaction_of(found.check, "crank" + std::to_string(i + 1));
      const double force = number(known.at("f")[i]);
      // Nearly flat the forces grow as 100 N / theta: what 1e-12 rad leave of them.
      EXPECT_NEAR(crank.axial, -force, 1e-12 * 100.0 / (theta * theta));
      EXPECT_FALSE(crank.determined);
    }
  }
}

Pose posts_and_beams(std::vector<double> posts, std::vector<double> beams) {
  Pose pose;
  for (std::size_t i = 0; i < posts.size(); ++i) pose["post" + std::to_string(i)] = posts[i];
  for (std::size_t i = 0; i < beams.size(); ++i) pose["beam" + std::to_string(i + 1)] = beams[i];
  return pose;
}

double height_of_weights(const StaticModel& model, const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t i = 1; i < model.scene().bodies.size(); ++i) {
    sum += test::place_of(model, x, model.scene().bodies[i].name + ".m").y;
  }
  return sum;
}

// One window of four unit bars: parallelogram, or folded onto the ground with the other two bars together.
TEST_F(References, OneRhombus) {
  const json& reference = at("static.rhombus_change_point").at("N1");
  const Scene scene = test::windows(1);
  std::vector<Pose> poses;
  std::vector<double> heights;
  for (const double up : {-0.5 * M_PI, 0.5 * M_PI}) {
    for (const Pose& pose : {posts_and_beams({up, up}, {0.0}), posts_and_beams({0.0, up}, {up}),
                             posts_and_beams({up, M_PI}, {up + M_PI})}) {
      poses.push_back(pose);
      expect_met(scene, pose, stability_of(up < 0), {.falling = up < 0 ? 0 : 1});
      const StaticModel model(test::started_at(scene, pose));
      heights.push_back(std::round(height_of_weights(model, solve(model, test::by(Method::virtual_work)).x) * 1e12) *
                        1e-12);
    }
  }
  expect_distinct(poses, reference.at("count_KKT"));
  std::vector<double> known = reference.at("V");
  std::sort(heights.begin(), heights.end());
  std::sort(known.begin(), known.end());
  for (std::size_t k = 0; k < known.size(); ++k) EXPECT_NEAR(heights.at(k), known[k], 1e-12);
}

struct Component {
  const char* name;
  Pose (*pose)(double up);
};

const std::vector<Component>& two_window_components() {
  static const std::vector<Component> all{{"PP",
                                           [](double up) {
                                             return posts_and_beams({up, up, up}, {0.0, 0.0});
                                           }},
                                          {"P,M2",
                                           [](double up) {
                                             return posts_and_beams({up, up, M_PI}, {0.0, up + M_PI});
                                           }},
                                          {"3: C1=D2,C2 free",
                                           [](double up) {
                                             return posts_and_beams({0.0, 0.0, up}, {0.0, up});
                                           }},
                                          {"4: C1=A,C2=D1,B1 free",
                                           [](double up) {
                                             return posts_and_beams({up, M_PI, M_PI}, {up + M_PI, 0.0});
                                           }},
                                          {"M3,P",
                                           [](double up) {
                                             return posts_and_beams({0.0, up, up}, {up, 0.0});
                                           }},
                                          {"M3,M2", [](double up) {
                                             return posts_and_beams({0.0, up, M_PI}, {up, up + M_PI});
                                           }}};
  return all;
}

// Two windows: on two of the six branches the other window is stretched out flat, where the closure loses rank and no
// finite reactions hold the weights. Nothing may call that an equilibrium.
TEST_F(References, TwoRhombiAndTheirLockedBranches) {
  const Scene scene = test::windows(2);
  int regular = 0;
  int locked = 0;
  for (const json& entry : at("static.rhombus_change_point").at("N2")) {
    const std::string name = entry.at("component");
    SCOPED_TRACE(name);
    const auto& all = two_window_components();
    const auto component = std::find_if(all.begin(), all.end(), [&](const Component& c) { return name == c.name; });
    ASSERT_NE(component, all.end());
    // The sign is that of the height.
    const double up = entry.at("sign") > 0 ? 0.5 * M_PI : -0.5 * M_PI;
    const Pose pose = component->pose(up);
    const StaticModel exact(test::started_at(scene, pose));
    // The reference counts 5 lengths of bars where the phasor model has 4 closure equations.
    EXPECT_EQ(analyse_mobility(exact).rank, entry.at("rank").get<int>() - 1);
    const Check judged = check(exact, exact.start());
    EXPECT_TRUE(judged.closed);
    EXPECT_EQ(judged.is_equilibrium(), entry.at("is_KKT").get<bool>()) << judged.objection;
    const Certificate proof = certify(exact, exact.start());
    EXPECT_EQ(proof.confirmed(), entry.at("is_KKT").get<bool>()) << proof.statement;
    if (entry.at("is_KKT")) {
      ++regular;
      expect_met(scene, pose, stability_of(up < 0), {.falling = up < 0 ? 0 : 1});
      continue;
    }
    ++locked;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      for (const Seek seek : {Seek::any, Seek::stable}) {
        const StaticModel model(test::started_at(scene, shifted(pose, seed <= 10 ? 0.02 : 1e-7, seed)));
        const Equilibrium found = solve(model, test::by(Method::virtual_work, seek));
        EXPECT_NE(found.status, Status::not_confirmed) << found.why;
        if (found.found()) {
          EXPECT_GT(test::error_of(model, found.x, pose), 0.01) << found.why;
        }
      }
    }
  }
  EXPECT_EQ(regular, 8);
  EXPECT_EQ(locked, 4);
}

}  // namespace
}  // namespace poise::references_test
