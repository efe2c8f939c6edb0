// Dimension synthesis: the closed-form dyads against the general kinematics, and designs found from random starts.

#include "motion/design.hpp"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "motion/kinematics.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::design_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

DesignProblem lift_design() { return read_design(test::dataset("lift_design.toml")); }

// The dimensions of datasets/lift.toml and its range, as values of a design.
std::vector<double> lift_values(const DesignProblem& problem) {
  std::vector<double> values;
  for (const DesignVariable& v : problem.variables) {
    const Vec2 at = problem.scene.local(v.point);
    values.push_back(v.is_y ? at.y : at.x);
  }
  values.insert(values.end(), {-0.1201, 0.994});
  return values;
}

// In the order in which the dyads are found: F, C, L.
const std::vector<int> lift_signs = {-1, -1, 1};

TEST(DyadChain, AgreesWithTheGeneralKinematics) {
  const DesignProblem problem = lift_design();
  const DesignModel model(problem);
  const DyadChain& chain = model.chain();
  ASSERT_EQ(chain.dyads().size(), 3u);
  std::vector<Vec2> points(chain.slots());
  for (std::size_t i = 0; i < problem.scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < problem.scene.bodies[i].points.size(); ++p) {
      points[chain.slot({static_cast<int>(i), static_cast<int>(p)})] = problem.scene.bodies[i].points[p].at;
    }
  }
  std::vector<DyadChain::Pose> poses(problem.scene.bodies.size());
  std::vector<double> cosines(3);
  for (const KinematicSample& at : sweep(problem.scene, {{"obd", -0.12, 0.87}}).samples) {
    EXPECT_EQ(chain.place(points, at.drive[0], lift_signs, poses, cosines), 0.0);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!chain.places(static_cast<int>(i))) continue;
      EXPECT_NEAR(norm(poses[i].origin - at.bodies[i].pose.origin), 0.0, 1e-12);
      EXPECT_NEAR(norm(poses[i].direction - unit(at.bodies[i].pose.angle)), 0.0, 1e-12);
    }
  }
}

TEST(DyadChain, SaysByHowMuchItFailsToClose) {
  Scene scene;
  scene.add_point(0, "O", {0, 0});
  scene.add_point(0, "C", {5, 0});
  for (const char* name : {"crank", "coupler", "rocker"}) test::add_link(scene, name, 1.0);
  test::add_pin(scene, "ground.O", "crank.a");
  test::add_pin(scene, "crank.b", "coupler.a");
  test::add_pin(scene, "coupler.b", "rocker.b");
  test::add_pin(scene, "ground.C", "rocker.a");
  const DyadChain chain(scene, 1, {2});
  std::vector<Vec2> points;
  for (const Body& body : scene.bodies) {
    for (const NamedPoint& p : body.points) points.push_back(p.at);
  }
  std::vector<DyadChain::Pose> poses(4);
  const std::vector<int> signs{1};
  std::vector<double> cosines(1);
  // The crank's end is 4 from C, the two bars reach 2: half their sum is missing on either side.
  EXPECT_NEAR(chain.place(points, 0.0, signs, poses, cosines), 1.0, 1e-15);
  EXPECT_NEAR(norm(poses[2].direction - Vec2{1, 0}), 0.0, 1e-15);
  EXPECT_NEAR(norm(poses[3].direction - Vec2{-1, 0}), 0.0, 1e-15);
}

TEST(DyadChain, RefusesBodiesThatNoDyadReaches) {
  const Scene scene = test::chain(3, 1.0, 1.0);
  EXPECT_THROW(DyadChain(scene, 1, {3}), InputError);
  EXPECT_THROW(DyadChain(scene, 2, {}), InputError);
}

TEST(Design, JudgesTheLiftByItsFacts) {
  const DesignProblem problem = lift_design();
  const DesignModel model(problem);
  const DesignFacts facts = model.facts(lift_values(problem), lift_signs, 121);
  const auto known = test::read_json(test::dataset("lift_facts.json"));
  EXPECT_EQ(facts.gap, 0.0);
  EXPECT_NEAR(facts.scale, 1.5 / known["travel_Q"].get<double>(), 1e-5);
  EXPECT_NEAR(facts.turned, 0.0, 1e-3);
  EXPECT_NEAR(facts.inclination / degree,
              0.5 * (known["inclination_deg"][1].get<double>() - known["inclination_deg"][0].get<double>()), 1e-6);
  const char* pins[] = {"F", "C", "L"};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(model.chain().dyads()[i].joint, pins[i]);
    EXPECT_NEAR(facts.transmission[i] / degree, known["least_transmission_deg"][pins[i]].get<double>(), 1e-6);
  }
  EXPECT_NEAR(facts.strokes[0].shortest / facts.scale, known["cylinder"][0].get<double>(), 1e-9);
  EXPECT_NEAR(facts.strokes[0].longest / facts.scale, known["cylinder"][1].get<double>(), 1e-9);
  EXPECT_NEAR(facts.strokes[0].least_lever / facts.scale, known["lever_arm"][0].get<double>(), 1e-3);
  EXPECT_EQ(model.misfit(facts), 0.0);
}

// Scaling, turning and shifting a mechanism changes nothing that a design is judged by.
TEST(Design, ItsSceneIsTheSameMechanismUprightAndInTrueSize) {
  DesignProblem problem = lift_design();
  std::vector<double> values = lift_values(problem);
  const DesignModel model(problem);
  const DesignFacts facts = model.facts(values, lift_signs, 101);
  DesignProblem again = problem;
  again.scene = model.scene_of(values, lift_signs, facts);
  const DesignModel upright(again);
  std::vector<double> true_size = lift_values(again);
  true_size[true_size.size() - 2] = values[values.size() - 2] + facts.turned;
  const DesignFacts same = upright.facts(true_size, lift_signs, 101);
  EXPECT_NEAR(same.scale, 1.0, 1e-12);
  EXPECT_NEAR(same.turned, 0.0, 1e-12);
  EXPECT_NEAR(same.drift, facts.drift, 1e-12);
  EXPECT_NEAR(same.inclination, facts.inclination, 1e-12);
  EXPECT_NEAR(same.longest, facts.longest, 1e-12);
}

class FromSeed : public testing::TestWithParam<int> {};

TEST_P(FromSeed, FindsALiftFromRandomStarts) {
  const DesignProblem problem = lift_design();
  DesignOptions options;
  options.seed = static_cast<std::uint64_t>(GetParam());
  const DesignResult found = design(problem, options);
  ASSERT_TRUE(found.met) << "misfit " << found.misfit << " after " << found.starts << " starts";
  const DesignCheck check = check_design(problem, found);
  EXPECT_TRUE(check.met) << check.why;
  EXPECT_NEAR(check.facts.travel, 1.5, 1e-6);
  EXPECT_LT(check.facts.drift, 0.005);
  EXPECT_LT(check.facts.inclination, 1 * degree);
  for (const double transmission : check.facts.transmission) EXPECT_GT(transmission, 30 * degree);
  EXPECT_GT(check.closeness, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FromSeed, testing::Range(1, 4));

TEST(Design, SaysSoWhereGoalsCannotBeMet) {
  DesignProblem problem = lift_design();
  problem.drift = 1e-9;
  DesignOptions options;
  options.starts = 1;
  options.evaluations = 500;
  const DesignResult found = design(problem, options);
  EXPECT_FALSE(found.met);
  EXPECT_GT(found.misfit, 0.0);
  EXPECT_EQ(found.starts, 1);
  EXPECT_FALSE(check_design(problem, found).met);
}

TEST(Design, CanBeInterrupted) {
  const std::atomic<bool> interrupt = true;
  DesignOptions options;
  options.interrupt = &interrupt;
  const DesignResult found = design(lift_design(), options);
  EXPECT_FALSE(found.met);
  EXPECT_EQ(found.starts, 0);
}

TEST(Design, WritesAGeometryThatReadsBackTheSame) {
  const Scene scene = read_scene(test::dataset("lift.toml"));
  const Scene back = parse_scene(geometry_text(scene), "back.toml");
  ASSERT_EQ(back.bodies.size(), scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    ASSERT_EQ(back.bodies[i].points.size(), scene.bodies[i].points.size());
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      EXPECT_EQ(back.bodies[i].points[p].at, scene.bodies[i].points[p].at);
    }
  }
  ASSERT_EQ(back.joints.size(), scene.joints.size());
  EXPECT_EQ(back.start.angle, scene.start.angle);
  EXPECT_EQ(back.start.travel, scene.start.travel);
}

TEST(ReadDesign, NamesTheLineAndTheLikelyMeaning) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("poise_design_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(test::dataset("lift.toml"), folder / "lift.toml",
                             std::filesystem::copy_options::overwrite_existing);
  std::ifstream original(test::dataset("lift_design.toml"));
  const std::string good((std::istreambuf_iterator<char>(original)), {});
  const auto said = [&](const std::string& from, const std::string& to) -> std::string {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    std::ofstream(folder / "design.toml") << text;
    try {
      read_design(folder / "design.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said("1.8", "1.8"), "");
  EXPECT_NE(said("\"point.gl.L.x\"", "\"point.gl.LL.x\"").find("did you mean \"point.gl.L.x\"?"), std::string::npos);
  EXPECT_NE(said("[0.3, 1.5]", "[1.5, 0.3]").find("swap them"), std::string::npos);
  EXPECT_NE(said("turn = [40, 75]", "turn = [-40, 75]").find("design.toml:15: drive.turn"), std::string::npos)
      << said("turn = [40, 75]", "turn = [-40, 75]");
  EXPECT_NE(said("drift = ", "drif = ").find("did you mean \"drift\"?"), std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace poise::design_test
