// A thousand starts all over the circle: a stable equilibrium is found from every one of them, and nothing that the
// solver claims is refuted by the check.

#include <cmath>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

namespace poise::robustness_test {
namespace {

constexpr int starts = 1000;
constexpr int starts_by_energy = 100;  // Ipopt takes some 10 ms each

struct Tally {
  std::map<std::string, int> ends;      // status and stability
  std::map<std::string, int> energies;  // of what was found, to six digits
  std::string first_failure;
  int confirmed = 0, stable = 0, not_confirmed = 0;
  double iterations = 0.0;
};

Tally run(const StaticModel& model, const SolveOptions& options, int count = starts) {
  std::mt19937 random(static_cast<unsigned>(test::seed(20220531)));
  std::uniform_real_distribution<double> uniform(-M_PI, M_PI);
  Tally out;
  for (int k = 0; k < count; ++k) {
    std::vector<double> x(model.mechanism().coordinates());
    for (double& v : x) v = uniform(random);
    const Equilibrium found = solve(model, x, options);
    ++out.ends[to_string(found.status) + ", " + to_string(found.certificate.stability)];
    out.confirmed += found.found();
    out.stable += found.found() && found.certificate.stability == Stability::stable;
    out.not_confirmed += found.status == Status::not_confirmed;
    out.iterations += static_cast<double>(found.iterations) / count;
    if (found.found()) {
      char energy[32];
      std::snprintf(energy, sizeof energy, "%.6g J", found.energy.value());
      ++out.energies[energy];
    } else if (out.first_failure.empty()) {
      out.first_failure = "start " + std::to_string(k) + ": " + found.why;
    }
  }
  return out;
}

void print(const std::string& what, const Tally& tally) {
  std::cout << "  " << what << ", " << tally.iterations << " iterations on average:";
  for (const auto& [end, count] : tally.ends) std::cout << "  " << count << " " << end << ";";
  for (const auto& [energy, count] : tally.energies) std::cout << "  " << count << " at " << energy;
  std::cout << '\n';
}

class RandomStarts : public testing::TestWithParam<const char*> {};

TEST_P(RandomStarts, LeadToAStableEquilibriumWithoutFail) {
  const StaticModel model(read_scene(test::dataset(GetParam())));
  const Tally tally = run(model, test::by(Method::virtual_work, Seek::stable));
  print(std::string(GetParam()) + ", stable", tally);
  EXPECT_EQ(tally.confirmed, starts) << tally.first_failure;
  EXPECT_EQ(tally.stable, starts);
  EXPECT_EQ(tally.not_confirmed, 0);
  // Each of these scenes has exactly one.
  EXPECT_EQ(tally.energies.size(), 1u);
}

TEST_P(RandomStarts, NeverEndInAClaimThatTheCheckRefutes) {
  const StaticModel model(read_scene(test::dataset(GetParam())));
  const Tally nearest = run(model, test::by(Method::virtual_work, Seek::any));
  print(std::string(GetParam()) + ", nearest", nearest);
  EXPECT_EQ(nearest.not_confirmed, 0);
  EXPECT_GE(nearest.confirmed, starts * 99 / 100) << nearest.first_failure;
  // Energies only: two poses may share one by symmetry.
  EXPECT_LE(nearest.energies.size(), 6u);
}

TEST_P(RandomStarts, ByEnergyAreJudgedByTheCheckAlone) {
  const StaticModel model(read_scene(test::dataset(GetParam())));
  const Tally energy = run(model, test::by(Method::energy), starts_by_energy);
  print(std::string(GetParam()) + ", energy", energy);
  EXPECT_EQ(energy.not_confirmed, 0);
  EXPECT_GE(energy.confirmed, starts_by_energy * 95 / 100) << energy.first_failure;
}

INSTANTIATE_TEST_SUITE_P(Thesis, RandomStarts,
                         testing::Values("thesis_four_bar.toml", "thesis_four_bar_reversed.toml", "thesis_chain.toml"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Nearest, IsTheUnstableEquilibriumNextToThePrintedPose) {
  const StaticModel model(read_scene(test::dataset("thesis_four_bar_reversed.toml")));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  EXPECT_LE(
      test::error_of(
          model, found.x,
          {{"link4", 1.1809809798627751078}, {"link6", 0.31112579393843271624}, {"link7", 5.3708134990460867023}}),
      1e-12);
  EXPECT_EQ(to_string(found.certificate.stability), "unstable");
  EXPECT_EQ(found.certificate.unstable_directions, 1);
  const Equilibrium equilibrium = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_EQ(equilibrium.status, Status::confirmed) << equilibrium.why;
  EXPECT_EQ(to_string(equilibrium.certificate.stability), "stable");
  EXPECT_LT(equilibrium.energy.value(), found.energy.value());
}

}  // namespace
}  // namespace poise::robustness_test
