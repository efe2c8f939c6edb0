// Many variants at once: closed forms, each set of instructions beside one by one, what is marked, and bad input.

#include "statics/many/solve_many.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "model/read_scene.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::solve_many_test {
namespace {

using comparison::Random;

std::vector<Simd> all_there_are() {
  std::vector<Simd> out;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512}) {
    if (has_simd(simd)) out.push_back(simd);
  }
  return out;
}

ManyOptions by(Simd simd) {
  ManyOptions out;
  out.simd = simd;
  return out;
}

// A lever of length 2 m and mass 3 kg hangs from a pin, with a torsion spring of 40 N m/rad that is free at 0, and a
// force F across its end, along x:  k angle = -m g cos(angle) - F 2 sin(angle).
const char* const lever = R"(
gravity = [0, -10]
[body.lever]
points = { A = [0, 0], B = [2, 0] }
mass = 3
center = [1, 0]
[ground]
points = { A = [0, 0] }
[[pin]]
name = "A"
points = ["ground.A", "lever.A"]
[[torsion_spring]]
name = "k"
bodies = ["ground", "lever"]
stiffness = 400
free_angle = 0
[[force]]
name = "F"
at = "lever.B"
vector = [5, 0]
[start]
lever = -0.05
)";

// The angle at which the torque is zero, by bisection.
double lever_angle(double stiffness, double force) {
  double low = -1.0, high = 1.0;
  for (int k = 0; k < 200; ++k) {
    const double a = 0.5 * (low + high);
    const double torque = -stiffness * a - 30.0 * std::cos(a) - force * 2.0 * std::sin(a);
    (torque > 0.0 ? low : high) = a;
  }
  return 0.5 * (low + high);
}

TEST(SolveMany, LeversAreWhereTheirTorqueVanishes) {
  const Scene scene = test::model_of(lever).scene();
  std::vector<double> stiffness, force;
  for (int k = 0; k < 1000; ++k) {
    stiffness.push_back(350.0 + 0.1 * k);
    force.push_back(20.0 * std::sin(1.0 * k) + 21.0);
  }
  for (const Simd simd : all_there_are()) {
    ManyOptions options = by(simd);
    options.quantities = {"angle.lever", "reaction.A.y", "energy"};
    options.poses = true;
    const ManySolutions found =
        solve_many(scene, {{"torsion_spring.k.stiffness", stiffness}, {"load.F", force}}, options);
    ASSERT_EQ(found.why_no_lanes, "");
    EXPECT_EQ(found.in_lanes, 1000U) << to_string(simd);
    EXPECT_EQ(found.simd, simd);
    ASSERT_EQ(found.coordinates, std::vector<std::string>{"lever"});
    for (std::size_t v = 0; v < 1000; ++v) {
      const double angle = lever_angle(stiffness[v], force[v]);
      ASSERT_NEAR(found.q[v], angle, 1e-13) << to_string(simd);
      ASSERT_NEAR(found.values[3 * v], angle, 1e-13);
      ASSERT_NEAR(found.values[3 * v + 1], 30.0, 1e-10);
      ASSERT_NEAR(found.poses[3 * v + 2], angle, 1e-13);
      ASSERT_EQ(found.proofs[v], ProofOf::not_asked);
    }
  }
}

TEST(SolveMany, OneValueMayBeForAllVariants) {
  const Scene scene = test::model_of(lever).scene();
  const std::vector<double> one{380.0}, many{5.0, 6.0, 7.0};
  const ManySolutions found = solve_many(scene, {{"torsion_spring.k.stiffness", one}, {"load.F", many}});
  ASSERT_EQ(found.variants, 3U);
  for (std::size_t v = 0; v < 3; ++v) EXPECT_NEAR(found.q[v], lever_angle(380.0, many[v]), 1e-13);
  EXPECT_EQ(solve_many(scene, {{"load.F", one}}).variants, 1U);
  EXPECT_EQ(solve_many(scene, {}).variants, 1U);
}

// Numbers of the scene that equilibrium depends on, drawn within a part of their values.
struct Drawn {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;

  std::vector<ManyValues> varied() const {
    std::vector<ManyValues> out;
    for (std::size_t k = 0; k < names.size(); ++k) out.push_back({names[k], values[k]});
    return out;
  }
  Scene of(Scene scene, std::size_t variant) const {
    for (std::size_t k = 0; k < names.size(); ++k) set_value(scene, names[k], values[k][variant]);
    return scene;
  }
};

Drawn drawn(const Scene& scene, Random& random, std::size_t variants, double part) {
  std::vector<ParameterRow> rows;
  for (const ParameterRow& row : parameter_table(scene)) {
    if (!acts_in_statics(scene, row.place) || row.place.owner == Owner::coupling) continue;
    const double value = value_at(scene, row.place).value_or(0.0);
    if (value != 0.0 && std::isfinite(value) && dependent_number(scene, row.place) == nullptr) rows.push_back(row);
  }
  Drawn out;
  for (int k = 0; k < 4 && !rows.empty(); ++k) {
    const auto at = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(rows.size()) - 1e-9));
    const double value = get_value(scene, rows[at].path.text());
    out.names.push_back(rows[at].path.text());
    out.values.emplace_back();
    for (std::size_t v = 0; v < variants; ++v) {
      out.values.back().push_back(value * (1.0 + random.uniform(-part, part)));
    }
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return out;
}

struct Compared {
  std::size_t scenes = 0, in_lanes = 0, by_search = 0, wrong = 0;
};

// Those solved in lanes are what solve() finds of them alone.
void compare(const Scene& scene, const Drawn& numbers, Compared& compared) {
  std::vector<ManySolutions> found;
  for (const Simd simd : all_there_are()) {
    try {
      found.push_back(solve_many(scene, numbers.varied(), by(simd)));
    } catch (const InputError& error) {
      if (simd == Simd::plain) return;  // a value that some number cannot have
      FAIL() << error.what();
    }
  }
  ++compared.scenes;
  const std::size_t width = found[0].coordinates.size();
  for (std::size_t v = 0; v < found[0].variants; ++v) {
    if (found[0].solved_by[v] != SolvedBy::lanes) {
      ++compared.by_search;
      continue;
    }
    ++compared.in_lanes;
    const Scene one = numbers.of(scene, v);
    const StaticModel model(one);
    const Equilibrium alone = solve(model);
    const auto say = [&] {
      std::string text = scene.title + ", variant " + std::to_string(v) + ": " + alone.why;
      for (std::size_t k = 0; k < numbers.names.size(); ++k) {
        text += fmt::format(" --set {}={}", numbers.names[k], numbers.values[k][v]);
      }
      return text;
    };
    if (!alone.found()) {
      ++compared.wrong;
      ADD_FAILURE() << say();
      continue;
    }
    // A scene whose numbers all differ from zero may have coordinates that it has not with a zero among them.
    std::vector<double> q = model.to_si(alone.x);
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (model.layout().is_length(static_cast<int>(i))) {
        q[i] += model.layout().coordinates[i].origin * model.scales().length;
      }
    }
    if (q.size() != width) continue;
    for (std::size_t path = 0; path < found.size(); ++path) {
      if (found[path].solved_by[v] != SolvedBy::lanes) continue;  // a decision on the edge
      for (std::size_t i = 0; i < width; ++i) {
        const double far = std::abs(found[path].q[v * width + i] - q[i]);
        const double within = 1e-12 * std::max(1.0, std::abs(q[i]));
        if (far <= within + 10 * alone.certificate.rounding_effect) continue;
        ++compared.wrong;
        ADD_FAILURE() << say() << "; " << far << " off in coordinate " << found[0].coordinates[i];
        break;
      }
    }
  }
}

std::vector<std::pair<std::string, Scene>> dataset_scenes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::dataset(""))) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::pair<std::string, Scene>> out;
  for (const std::filesystem::path& file : files) {
    try {
      Scene scene = read_scene(file);
      scene.title = file.filename();
      if (scene.bodies.size() <= 14) out.emplace_back(file.filename(), std::move(scene));
    } catch (const InputError&) {
      // an experiment, say
    }
  }
  return out;
}

TEST(SolveMany, VariantsOfDatasetsAreWhatSolveFinds) {
  const char* const more = std::getenv("POISE_MANY_VARIANTS");
  const std::size_t variants = more != nullptr ? static_cast<std::size_t>(std::atoi(more)) : 6;
  Random random(20261128);
  Compared compared;
  for (const auto& [name, scene] : dataset_scenes()) {
    for (const double part : {0.02, 0.3}) {
      const Compared before = compared;
      compare(scene, drawn(scene, random, variants, part), compared);
      if (more != nullptr) {
        fmt::print("{:<36}{:>6}{:>8} in lanes{:>8} by search  {}\n", name, part, compared.in_lanes - before.in_lanes,
                   compared.by_search - before.by_search, solve_many(scene, {}).why_no_lanes);
      }
    }
  }
  EXPECT_GE(compared.scenes, 60U);
  EXPECT_GE(compared.in_lanes, 20 * variants);
}

// An arm whose spring overcomes its weight falls the other way: what lanes must not solve is marked, and right.
TEST(SolveMany, WhatLanesLeaveIsSearchedForAndMarked) {
  const Scene scene = read_scene(test::dataset("toggle_clamp.toml"));
  std::vector<double> pull;
  for (int k = 0; k < 64; ++k) pull.push_back(25.0 + 0.25 * k);  // opens at 37.09 N
  for (const Simd simd : all_there_are()) {
    ManyOptions options = by(simd);
    options.quantities = {"angle.handle", "force.rubber", "reaction.B"};
    options.prove = ManyOptions::Prove::all;
    const ManySolutions found = solve_many(scene, {{"load.P", pull}}, options);
    ASSERT_EQ(found.why_no_lanes, "");
    EXPECT_EQ(found.in_lanes, 49U);
    EXPECT_EQ(found.by_search, 15U);
    EXPECT_EQ(found.proved, 64U);
    for (std::size_t v = 0; v < pull.size(); ++v) {
      const bool is_open = pull[v] > 37.093431951696662419;
      EXPECT_EQ(found.solved_by[v], is_open ? SolvedBy::search : SolvedBy::lanes) << pull[v];
      EXPECT_LT(found.radius[v], 1e-12);
      Scene one = scene;
      set_value(one, "load.P", pull[v]);
      const StaticModel model(one);
      const Equilibrium alone = solve(model);
      const std::vector<double> values =
          quantities_at(model, alone.x, alone.certificate.active_stops, found.quantities);
      for (std::size_t k = 0; k < values.size(); ++k) {
        EXPECT_NEAR(found.values[v * values.size() + k], values[k], 1e-9 * (1.0 + std::abs(values[k]))) << pull[v];
      }
    }
  }
}

TEST(SolveMany, ProofsAreOfASampleSpreadEvenly) {
  const Scene scene = test::model_of(lever).scene();
  const std::vector<double> force(100, 5.0);
  ManyOptions options;
  options.prove = ManyOptions::Prove::sample;
  options.sample = 4;
  const ManySolutions found = solve_many(scene, {{"load.F", force}}, options);
  std::vector<std::size_t> proved;
  for (std::size_t v = 0; v < 100; ++v) {
    if (found.proofs[v] == ProofOf::proved) proved.push_back(v);
    EXPECT_EQ(std::isfinite(found.radius[v]), found.proofs[v] == ProofOf::proved);
  }
  EXPECT_EQ(proved, (std::vector<std::size_t>{12, 37, 62, 87}));
}

// Two springs of random mechanisms, whose equilibria are known.
TEST(SolveMany, VariantsOfRandomMechanismsAreWhatSolveFinds) {
  Random random(7);
  Compared compared;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 4 == 0,
                          .stops = seed % 2 == 0,
                          .other_laws = seed % 3 != 1,
                          .couplings = seed % 5 > 2};
    const Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    compare(scene, drawn(scene, random, 8, 0.02), compared);
  }
  EXPECT_GE(compared.in_lanes, 60U);
}

TEST(SolveMany, HasTheSameBytesOnAnyNumberOfThreadsAndInAnyCompany) {
  const Scene scene = read_scene(test::dataset("toggle_clamp.toml"));
  Random random(3);
  Drawn numbers = drawn(scene, random, 1001, 0.02);
  numbers.names.push_back("load.P");
  numbers.values.emplace_back();
  for (int k = 0; k < 1001; ++k) numbers.values.back().push_back(random.uniform(20.0, 30.0));
  const auto position = std::find(numbers.names.begin(), numbers.names.end() - 1, "load.P");
  if (position != numbers.names.end() - 1) {
    numbers.values.erase(numbers.values.begin() + (position - numbers.names.begin()));
    numbers.names.erase(position);
  }
  for (const Simd simd : all_there_are()) {
    ManyOptions one = by(simd), two = by(simd);
    one.jobs = 1;
    two.jobs = 2;
    const ManySolutions a = solve_many(scene, numbers.varied(), one), b = solve_many(scene, numbers.varied(), two);
    EXPECT_EQ(a.q, b.q);
    EXPECT_EQ(a.solved_by, b.solved_by);
    // Without the first three all are at other places of their packs.
    Drawn later = numbers;
    for (std::vector<double>& values : later.values) values.erase(values.begin(), values.begin() + 3);
    const ManySolutions c = solve_many(scene, later.varied(), one);
    EXPECT_TRUE(
        std::equal(c.q.begin(), c.q.end(), a.q.begin() + 3 * static_cast<std::ptrdiff_t>(a.coordinates.size())));
  }
}

TEST(SolveMany, BadInputIsOneLine) {
  const Scene scene = test::model_of(lever).scene();
  const std::vector<double> three{1.0, 2.0, 3.0}, two{1.0, 2.0}, none, bad{1.0, 2.0, -1.0},
      unknown{1.0, std::nan(""), 2.0};
  const auto message = [&](const std::vector<ManyValues>& numbers, const ManyOptions& options = {}) {
    try {
      solve_many(scene, numbers, options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(message({{"load.G", three}}).find("load.F"), std::string::npos);
  EXPECT_EQ(message({{"load.F", three}, {"body.lever.mass", two}}),
            "body.lever.mass: expected 3 values, as load.F has, or one for all; found 2");
  EXPECT_EQ(message({{"load.F", none}}), "load.F: expected at least one value, found none");
  EXPECT_EQ(message({{"load.F", three}, {"load.F", three}}), "load.F: expected it once, found twice");
  EXPECT_EQ(message({{"body.lever.mass", bad}}), "body.lever.mass: variant 2: expected a finite number >= 0, found -1");
  EXPECT_NE(message({{"load.F", unknown}}).find("load.F: variant 1: expected a finite number"), std::string::npos);
  ManyOptions options;
  options.quantities = {"angle.lewer"};
  EXPECT_NE(message({{"load.F", three}}, options).find("angle.lever"), std::string::npos);
  options.quantities = {"fold.load.F"};
  EXPECT_NE(message({{"load.F", three}}, options).find("belongs to a path"), std::string::npos);
}

TEST(SolveMany, TheEnvironmentNamesTheInstructions) {
  const char* const before = std::getenv("POISE_SIMD");
  const std::string kept = before != nullptr ? before : "";
  ASSERT_EQ(setenv("POISE_SIMD", "plain", 1), 0);
  EXPECT_EQ(simd_to_use(), Simd::plain);
  ASSERT_EQ(setenv("POISE_SIMD", "sse", 1), 0);
  EXPECT_EQ(test::message_of([] { simd_to_use(); }), "POISE_SIMD=sse: expected plain, avx2 or avx512");
  ASSERT_EQ(before != nullptr ? setenv("POISE_SIMD", kept.c_str(), 1) : unsetenv("POISE_SIMD"), 0);
}

TEST(SolveMany, AnInterruptLeavesWhatIsDone) {
  const Scene scene = test::model_of(lever).scene();
  const std::vector<double> force(10'000, 5.0);
  std::atomic<bool> interrupt = true;
  ManyOptions options;
  options.solve.interrupt = &interrupt;
  const ManySolutions found = solve_many(scene, {{"load.F", force}}, options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_EQ(found.in_lanes + found.by_search + found.not_found, 0U);
  EXPECT_TRUE(std::isnan(found.q[0]));
}

}  // namespace
}  // namespace poise::solve_many_test
