// Flexible links against the elastica, Euler's columns and beam theory.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/modes.hpp"
#include "statics/equilibrium/link_loads.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "statics/sensitivity/tolerance.hpp"

namespace poise::flexible_link_test {
namespace {

/// A cantilever of length 1 and E I = 1 with a force on its tip.
std::string cantilever(int elements, Vec2 tip, double mass = 0.0, const std::string& more = "") {
  return fmt::format(R"(
gravity = [0, -1]
[ground]
points = {{ A = [0, 0] }}
[body.beam]
points = {{ A = [0, 0], B = [1, 0] }}
mass = {}
[body.beam.section]
area = 1
second_moment = 1
modulus = 1
height = 1
flexible = true
elements = {}
[[weld]]
points = ["ground.A", "beam.A"]
[[force]]
name = "P"
at = "beam.B"
vector = [{:.17g}, {:.17g}]
)",
                     mass, elements, tip.x, tip.y) +
         more;
}

struct Tip {
  Vec2 at;
  Equilibrium equilibrium;
};

Tip tip_of(const std::string& text, const SolveOptions& options = {}) {
  const StaticModel model(parse_scene(text, "beam.toml"));
  Tip out{{}, solve(model, options)};
  const std::vector<BodyPose<double>> poses = model.poses(out.equilibrium.x);
  const Scene& scene = model.scene();
  const int last = scene.flexible_links.at(0).bodies.back();
  const Body& body = scene.bodies[static_cast<std::size_t>(last)];
  for (const NamedPoint& point : body.points) {
    if (point.name == "B") out.at = poses[static_cast<std::size_t>(last)].world(point.at);
  }
  return out;
}

/// The tip of a cantilever of length 1, E I = 1, under a force `load` that stays across its clamp. With
/// p = sin of half the angle between the tip's tangent and the line of the force, sin phi_1 = 1 / (p sqrt 2):
///   sqrt load = K(p) - F(p, phi_1),  y = 1 - 2 (E(p) - E(p, phi_1)) / sqrt load,  x = 2 p cos phi_1 / sqrt load
/// (Bisshopp and Drucker, Large deflection of cantilever beams, Quart. Appl. Math. 3 (1945)).
Vec2 elastica(double load) {
  const auto root_of_load = [](double p) {
    return std::comp_ellint_1(p) - std::ellint_1(p, std::asin(1 / (p * std::sqrt(2.0))));
  };
  double low = std::sqrt(0.5), high = 1.0 - 1e-15;
  for (int k = 0; k < 200; ++k) {
    const double p = 0.5 * (low + high);
    (root_of_load(p) < std::sqrt(load) ? low : high) = p;
  }
  const double p = 0.5 * (low + high), phi = std::asin(std::min(1.0, 1 / (p * std::sqrt(2.0))));
  const double root = std::sqrt(load);
  return {2 * p * std::cos(phi) / root, 1 - 2 * (std::comp_ellint_2(p) - std::ellint_2(p, phi)) / root};
}

TEST(FlexibleLink, ElasticaUnderATipLoad) {
  for (const double load : {1.0, 2.0, 5.0, 10.0}) {
    const Tip found = tip_of(cantilever(64, {0, -load}));
    ASSERT_TRUE(found.equilibrium.found()) << found.equilibrium.why;
    EXPECT_EQ(found.equilibrium.certificate.stability, Stability::stable);
    const Vec2 exact = elastica(load);
    EXPECT_NEAR(found.at.x, exact.x, 1e-8) << load;
    EXPECT_NEAR(found.at.y, -exact.y, 1e-8) << load;
  }
}

TEST(FlexibleLink, ConvergesAsTheSixthPower) {
  const Vec2 exact = elastica(4.0);
  double before = 0.0;
  for (const int elements : {2, 4, 8}) {
    const Tip found = tip_of(cantilever(elements, {0, -4}));
    ASSERT_TRUE(found.equilibrium.found()) << found.equilibrium.why;
    const double error = norm(found.at - Vec2{exact.x, -exact.y});
    RecordProperty(fmt::format("error_{}", elements), fmt::format("{:.3g}", error));
    if (before > 0.0) {
      EXPECT_GT(std::log2(before / error), 5.5) << elements << ": " << before << " " << error;
    }
    before = error;
  }
  EXPECT_LT(before, 1e-7);
}

TEST(FlexibleLink, AllMethodsAgreeAndAProofIsFound) {
  const Tip proved = tip_of(cantilever(8, {-0.5, -3}));
  ASSERT_TRUE(proved.equilibrium.found()) << proved.equilibrium.why;
  EXPECT_EQ(proved.equilibrium.certificate.stability, Stability::stable);
  const Tip energy = tip_of(cantilever(8, {-0.5, -3}), {.method = Method::energy});
  ASSERT_TRUE(energy.equilibrium.found()) << energy.equilibrium.why;
  EXPECT_NEAR(norm(energy.at - proved.at), 0.0, 1e-9);
}

TEST(FlexibleLink, SmallDeflectionsAreThoseOfBeamTheory) {
  constexpr double small = 1e-4;
  // The weight of the mass and a tip load.
  const Tip found = tip_of(cantilever(4, {0, -small}, small));
  ASSERT_TRUE(found.equilibrium.found()) << found.equilibrium.why;
  EXPECT_NEAR(found.at.y, -(small / 3 + small / 8), 1e-11);
}

TEST(FlexibleLink, WeightConvergesToo) {
  // Against itself with many elements: a heavy beam without any other load.
  const Vec2 fine = tip_of(cantilever(24, {0, -1e-9}, 8.0)).at;
  const double coarse = norm(tip_of(cantilever(3, {0, -1e-9}, 8.0)).at - fine);
  const double finer = norm(tip_of(cantilever(6, {0, -1e-9}, 8.0)).at - fine);
  EXPECT_LT(finer, 1e-6);
  EXPECT_GT(std::log2(coarse / finer), 5.0) << coarse << " " << finer;
}

/// Whether the straight column under a force along it is a stable equilibrium.
bool stands(const std::string& text) {
  SolveOptions options;
  options.seek = Seek::any;
  const StaticModel model(parse_scene(text, "column.toml"));
  const Equilibrium straight = solve(model, options);
  EXPECT_TRUE(straight.found()) << straight.why;
  for (const double angle : straight.x) EXPECT_NEAR(std::remainder(angle, M_PI), 0.0, 1e-6);
  return straight.certificate.stability == Stability::stable;
}

// E I = mass = length = 1: 2 pi f = b^2 with cos b cosh b = -1.
TEST(FlexibleLink, FrequenciesConvergeAsTheFourthPower) {
  const auto errors = [](const std::string& text, const std::vector<double>& roots) {
    Scene scene = parse_scene(text, "beam.toml");
    scene.gravity = {};
    const StaticModel statics(scene);
    const Equilibrium rest = solve(statics);
    const MotionModel motion(statics.scene());
    const Modes modes = modes_of(motion, motion_coordinates(motion, statics, rest.x));
    std::vector<double> out;
    for (std::size_t k = 0; k < roots.size(); ++k) {
      out.push_back(modes.vibrations.at(k).frequency / (roots[k] * roots[k] / (2 * M_PI)) - 1);
    }
    return out;
  };
  const std::vector<double> clamped{1.8751040687119611, 4.694091132974175, 7.854757438237613};
  const std::vector<double> coarse = errors(cantilever(8, {0, 0}, 1.0), clamped);
  const std::vector<double> fine = errors(cantilever(16, {0, 0}, 1.0), clamped);
  for (std::size_t k = 0; k < clamped.size(); ++k) {
    EXPECT_LT(std::abs(coarse[k]), 5e-5) << k;
    EXPECT_LT(std::abs(fine[k]), std::abs(coarse[k]) / 12) << k;
  }
}

TEST(FlexibleLink, EulersColumns) {
  const double free_tip = M_PI * M_PI / 4;
  EXPECT_TRUE(stands(cantilever(8, {-free_tip * 0.99999, 0})));
  EXPECT_FALSE(stands(cantilever(8, {-free_tip * 1.00001, 0})));
  const std::string pinned = R"(
[ground]
points = { A = [0, 0], B = [1, 0] }
[body.column]
points = { A = [0, 0], B = [1, 0] }
[body.column.section]
area = 1
second_moment = 1
modulus = 1
height = 1
flexible = true
[[pin]]
points = ["ground.A", "column.A"]
[[pin_in_slot]]
name = "guide"
points = ["ground.B", "column.B"]
axis = [1, 0]
[[force]]
name = "P"
at = "column.B"
)";
  const double euler = M_PI * M_PI;
  EXPECT_TRUE(stands(pinned + fmt::format("vector = [{:.17g}, 0]\n", -euler * 0.99999)));
  EXPECT_FALSE(stands(pinned + fmt::format("vector = [{:.17g}, 0]\n", -euler * 1.00001)));
}

/// Beyond Euler's load a column with a free tip stands beside its line: sqrt P = K(p), y = 2 p / sqrt P,
/// x = 2 E(p) / sqrt P - 1, where sin of half the angle of the tip is p (the elastica).
TEST(FlexibleLink, BuckledColumnsFromNearTheLoadOn) {
  for (const double part : {1.0001, 1.01, 1.3, 2.5}) {
    const double load = part * M_PI * M_PI / 4;
    double low = 0.0, high = 1.0 - 1e-15;
    for (int k = 0; k < 200; ++k) {
      const double p = 0.5 * (low + high);
      (std::comp_ellint_1(p) < std::sqrt(load) ? low : high) = p;
    }
    const double p = 0.5 * (low + high);
    const Tip found = tip_of(cantilever(32, {-load, 0}, 0.0, "[start]\nbeam = 0.2\n"));
    ASSERT_TRUE(found.equilibrium.found()) << part << ": " << found.equilibrium.why;
    EXPECT_EQ(found.equilibrium.certificate.stability, Stability::stable) << part;
    EXPECT_NEAR(std::abs(found.at.y), 2 * p / std::sqrt(load), 1e-8) << part;
    EXPECT_NEAR(found.at.x, 2 * std::comp_ellint_2(p) / std::sqrt(load) - 1, 1e-8) << part;
  }
}

TEST(FlexibleLink, SectionActsOnAllSprings) {
  Scene scene = parse_scene(cantilever(4, {0, -2}), "beam.toml");
  set_value(scene, "body.beam.section.modulus", 2.0);
  EXPECT_EQ(get_value(scene, "body.beam.section.modulus"), 2.0);
  const Scene stiff = parse_scene(cantilever(4, {0, -2}), "beam.toml");
  for (const int spring : scene.flexible_links[0].springs) {
    const auto at = static_cast<std::size_t>(spring);
    EXPECT_EQ(std::get<LinearSpring>(scene.elements[at].law).stiffness,
              2.0 * std::get<LinearSpring>(stiff.elements[at].law).stiffness);
  }
}

// Without weight the shape depends on P / (E I) alone, forces in the link on P at a given shape.
TEST(FlexibleLink, DerivativesBySectionAreThoseOfAllSprings) {
  const Scene scene = parse_scene(cantilever(6, {0, -3}), "beam.toml");
  const StaticModel model(scene);
  const std::string tip = scene.bodies[static_cast<std::size_t>(scene.flexible_links[0].bodies.back())].name;
  const Sensitivities found =
      sensitivities(model, {find_quantity(scene, tip + ".B.y"), find_quantity(scene, "energy")});
  ASSERT_EQ(found.why, "");
  const auto by = [&](std::size_t of, const std::string& number) {
    for (const Sensitivity& one : found.of[of].by) {
      if (one.number == number) return one.derivative;
    }
    ADD_FAILURE() << number;
    return 0.0;
  };
  const double by_load = by(0, "load.P");
  EXPECT_LT(by_load, -0.05);
  EXPECT_NEAR(by(0, "body.beam.section.modulus"), -3 * by_load, 1e-10);
  EXPECT_NEAR(by(0, "body.beam.section.second_moment"), -3 * by_load, 1e-10);
  double of_springs = 0.0;
  for (const int spring : scene.flexible_links[0].springs) {
    const Element& element = scene.elements[static_cast<std::size_t>(spring)];
    of_springs += std::get<LinearSpring>(element.law).stiffness * by(0, "spring." + element.name + ".stiffness");
  }
  EXPECT_NEAR(of_springs, -3 * by_load, 1e-10);
  // V is homogeneous of degree 1 in P and E I together.
  EXPECT_NEAR(by(1, "body.beam.section.modulus") + 3 * by(1, "load.P"), found.of[1].value, 1e-10);
}

TEST(FlexibleLink, TolerancesOfTheModulusReachAllSprings) {
  const Scene scene = parse_scene(cantilever(4, {0, -2}), "beam.toml");
  const StaticModel model(scene);
  const std::string tip = scene.bodies[static_cast<std::size_t>(scene.flexible_links[0].bodies.back())].name;
  const std::vector<SoughtQuantity> of{find_quantity(scene, tip + ".B.y")};
  const auto tolerances = [&](const std::string& text) { return parse_tolerances(text, "tolerances", scene); };
  const ToleranceOptions options{.samples = 2000};
  const ToleranceStudy study =
      tolerance_study(model, tolerances("[tolerances]\n\"body.beam.section.modulus\" = 0.2\n"), of, options);
  ASSERT_EQ(study.why, "");
  const ToleranceBand& band = study.of.at(0);
  const auto tip_at = [&](double modulus) {
    Scene other = scene;
    set_value(other, "body.beam.section.modulus", modulus);
    const StaticModel changed(other);
    const Equilibrium rest = solve(changed);
    EXPECT_TRUE(rest.found()) << rest.why;
    const auto last = static_cast<std::size_t>(scene.flexible_links[0].bodies.back());
    return changed.poses(rest.x)[last].world(other.bodies[last].points.back().at).y;
  };
  ASSERT_TRUE(band.at_least && band.at_most && band.has_second);
  EXPECT_NEAR(*band.at_least, tip_at(0.8), 1e-9);
  EXPECT_NEAR(*band.at_most, tip_at(1.2), 1e-9);
  EXPECT_NEAR(band.sigma, 0.2 / std::sqrt(3.0) * (tip_at(1.001) - tip_at(0.999)) / 0.002, 1e-6);
  EXPECT_NEAR(band.all.mean, band.nominal + band.shift, 5 * band.sigma / std::sqrt(2000.0));
  EXPECT_EQ(study.continued, 2000U);
}

TEST(FlexibleLink, BentLineKeepsItsCorner) {
  // An L of two legs of length 1: the horizontal leg bends the vertical one by a moment of 1 times the load.
  const std::string text = R"(
[ground]
points = { A = [0, 0] }
[body.hook]
points = { A = [0, 0], K = [0, 1], B = [1, 1] }
[body.hook.section]
area = 1
second_moment = 1
modulus = 1
height = 1
line = ["A", "K", "B"]
flexible = true
elements = 4
[[weld]]
points = ["ground.A", "hook.A"]
[[force]]
at = "hook.B"
vector = [0, -1e-5]
)";
  const Tip found = tip_of(text);
  ASSERT_TRUE(found.equilibrium.found()) << found.equilibrium.why;
  EXPECT_NEAR(found.at.y, 1 - 1e-5 * (1.0 / 3 + 1.0), 1e-9);
  EXPECT_NEAR(found.at.x, 1 + 1e-5 * 0.5, 1e-9);
}

TEST(FlexibleLink, InternalLoadsAreThoseOfTheBentBeam) {
  const double load = 3.0, mass = 2.0;
  const StaticModel model(parse_scene(cantilever(12, {0, -load}, mass), "beam.toml"));
  const Equilibrium found = solve_or_hold(model);
  ASSERT_TRUE(found.found()) << found.why;
  const std::vector<LinkLoads> links = link_loads(model.scene(), model.poses(found.x), found.check);
  ASSERT_EQ(links.size(), 1U);
  const LinkLoads& link = links[0];
  ASSERT_EQ(link.why, "");
  EXPECT_NEAR(link.length, 1.0, 1e-14);
  const LinkSample& clamp = link.samples.front();
  const LinkSample& tip = link.samples.back();
  EXPECT_EQ(norm(clamp.state.at), 0.0);
  EXPECT_NEAR(tip.state.moment, 0.0, 1e-6);
  EXPECT_NEAR(clamp.state.shear, load + mass, 1e-9);
  // Every moment is that of the load on the tip, and of the weight beyond, by a sum along the bent line.
  for (std::size_t k = 0; k + 1 < link.samples.size(); k += 7) {
    const LinkSample& sample = link.samples[k];
    double moment = -load * (tip.state.at.x - sample.state.at.x);
    for (std::size_t j = k; j + 1 < link.samples.size(); ++j) {
      // Places are near each other: the trapezium is enough.
      const LinkSample& a = link.samples[j];
      const LinkSample& b = link.samples[j + 1];
      moment -= mass * (b.s - a.s) * (0.5 * (a.state.at.x + b.state.at.x) - sample.state.at.x);
    }
    EXPECT_NEAR(sample.state.moment, moment, 5e-4) << sample.s;
    EXPECT_NEAR(std::hypot(sample.state.normal, sample.state.shear), load + mass * (1 - sample.s), 1e-9);
  }
  // Without weight the sum is exact, and the moments of the springs converge to it as the fourth power.
  const auto worst = [&](int elements) {
    const StaticModel light(parse_scene(cantilever(elements, {0, -load}), "beam.toml"));
    const Equilibrium bent = solve_or_hold(light);
    const LinkLoads exact = link_loads(light.scene(), light.poses(bent.x), bent.check).at(0);
    double error = 0.0;
    for (const LinkSample& sample : exact.samples) {
      const double arm = exact.samples.back().state.at.x - sample.state.at.x;
      error = std::max(error, std::abs(sample.state.moment + load * arm));
    }
    return error;
  };
  const double coarse = worst(8), fine = worst(16);
  EXPECT_LT(fine, 3e-7);
  EXPECT_GT(std::log2(coarse / fine), 3.5) << coarse << " " << fine;
}

TEST(FlexibleLink, RefusesWhatItCannotBe) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      parse_scene(text, "beam.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  std::string text = cantilever(4, {0, -1});
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return message(other);
  };
  EXPECT_NE(changed("mass = 0", "mass = 1\ninertia = 2").find("inertia: expected none"), std::string::npos);
  EXPECT_NE(changed("mass = 0", "mass = 1\ncenter = [0.4, 0]").find("center: expected none, or the middle"),
            std::string::npos);
  EXPECT_EQ(changed("mass = 0", "mass = 1\ncenter = [0.5, 0]"), "");
  EXPECT_NE(changed("B = [1, 0] }", "B = [1, 0], C = [2, 1] }").find("expected the key line"), std::string::npos);
  EXPECT_NE(changed("elements = 4", "elements = 4\nline = [\"A\", \"B\"]").size(), 1U);
  EXPECT_NE(changed("elements = 4", "elements = 200000").find("expected at most"), std::string::npos);
  EXPECT_NE(
      message(text + "[[distributed_load]]\npoints = [\"beam.A\", \"beam.B\"]\nvector = [0, 1]\n").find("flexible"),
      std::string::npos);
}

}  // namespace
}  // namespace poise::flexible_link_test
