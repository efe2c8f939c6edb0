// What must be proved and what must not, for the hard catalogue: every equilibrium listed in it, with its stability,
// from the list and not from a search; and nothing where there is none.

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "comparison/catalogue.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/proof/certificate.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::certificate_cases_test {
namespace {

using comparison::HardCase;
using comparison::KnownEquilibrium;
using test::dataset;

// Files of the catalogue whose mechanisms have no equilibrium beside those that are listed.
const std::set<std::string> kinds = {"Shallow folds",
                                     "Bands that never act",
                                     "Long columns under follower loads",
                                     "One of many bodies",
                                     "Far from the origin",
                                     "Stops that pull, share or block",
                                     "Change points in equilibrium",
                                     "Soft mechanisms and cusps"};

std::vector<HardCase> cases() {
  std::vector<HardCase> all = comparison::read_catalogue(dataset("hard"));
  std::erase_if(all, [](const HardCase& hard) { return !kinds.contains(hard.kind); });
  return all;
}

// The scaled coordinates of a listed equilibrium; none where the list leaves a coordinate out.
std::optional<std::vector<double>> pose_of(const StaticModel& model, const KnownEquilibrium& known) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  std::vector<double> q = model.to_si(model.start());
  std::vector<char> given(q.size(), 0);
  const auto set = [&](int coordinate, double value) {
    if (coordinate < 0 || coordinate >= layout.kept) return;
    q[static_cast<std::size_t>(coordinate)] = value;
    given[static_cast<std::size_t>(coordinate)] = 1;
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto angle = known.angles.find(scene.bodies[i].name);
    const Link& link = layout.links[i];
    if (angle == known.angles.end()) continue;
    set(link.frame, angle->second - layout.turns[static_cast<std::size_t>(link.turn)].to<double>());
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const auto travel = known.travels.find(scene.joints[j].name);
    if (travel != known.travels.end()) set(layout.travel[j], travel->second);
  }
  if (std::count(given.begin(), given.end(), 0) > 0) return std::nullopt;
  return model.from_si(q);
}

TEST(CertificateCases, EveryListedEquilibriumIsProvedWithItsStability) {
  int proved = 0;
  for (const HardCase& hard : cases()) {
    const StaticModel model(comparison::scene_of(hard));
    for (const KnownEquilibrium& known : hard.known) {
      const std::optional<std::vector<double>> x = pose_of(model, known);
      if (!x) continue;
      SCOPED_TRACE(hard.name);
      const Certificate certificate = certify(model, *x);
      EXPECT_TRUE(certificate.confirmed()) << certificate.statement;
      EXPECT_EQ(to_string(certificate.stability), to_string(known.stability)) << certificate.statement;
      ASSERT_EQ(certificate.x.size(), x->size());
      for (std::size_t i = 0; i < x->size(); ++i) {
        EXPECT_NEAR(certificate.x[i], (*x)[i], certificate.radius + 4 * certificate.rounding_effect + 1e-15) << i;
      }
      ++proved;
    }
  }
  EXPECT_GT(proved, 60);
}

// Wherever a search of a method ends, or begins, and nothing is listed within reach, nothing is confirmed.
TEST(CertificateCases, NothingIsConfirmedElsewhere) {
  for (const HardCase& hard : cases()) {
    if (hard.answer == comparison::KnownAnswer::equilibrium && !hard.complete) continue;
    SCOPED_TRACE(hard.name);
    const StaticModel model(comparison::scene_of(hard));
    std::vector<std::vector<double>> listed;
    for (const KnownEquilibrium& known : hard.known) {
      if (const auto x = pose_of(model, known)) listed.push_back(*x);
    }
    if (listed.size() != hard.known.size()) continue;
    const std::vector<double> start = model.start();
    for (const double beside : {0.0, 1e-9, -1e-9, 1e-6, -1e-6, 1e-3}) {
      std::vector<double> x = start;
      for (double& v : x) v += beside;
      const Certificate certificate = certify(model, x);
      if (!certificate.confirmed()) continue;
      double nearest = INFINITY;
      for (const std::vector<double>& known : listed) {
        double apart = 0.0;
        for (std::size_t i = 0; i < known.size(); ++i) {
          double d = certificate.x[i] - known[i];
          if (static_cast<int>(i) < model.layout().angles && !hard.turns_count) d = std::remainder(d, 2 * M_PI);
          apart = std::max(apart, std::abs(d));
        }
        nearest = std::min(nearest, apart);
      }
      EXPECT_LE(nearest, certificate.radius + 4 * certificate.rounding_effect + 1e-15) << certificate.statement;
    }
  }
}

TEST(CertificateCases, DigitsDoNotDependOnWhereTheMechanismIs) {
  const StaticModel far(read_scene(dataset("hard/far_four_bar.toml")));
  const StaticModel near(read_scene(dataset("hard/unused_point.toml")));
  const Equilibrium a = solve(far, test::by(Method::virtual_work));
  const Equilibrium b = solve(near, test::by(Method::virtual_work));
  ASSERT_TRUE(a.found()) << a.why;
  ASSERT_TRUE(b.found()) << b.why;
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.certificate.radius, b.certificate.radius);
  EXPECT_EQ(a.certificate.stability, b.certificate.stability);
}

TEST(CertificateCases, NumbersThatLeaveAMechanismOpenAreReported) {
  // 1e14 m away doubles are 1/64 m apart, and the base is 4 m: the proof is of the doubles, and says what the decimal
  // numbers leave open.
  const Equilibrium lost = solve(StaticModel(read_scene(dataset("hard/lost_four_bar.toml"))));
  if (lost.found()) {
    EXPECT_GT(lost.certificate.rounding_effect, 1e-4);
  } else {
    EXPECT_NE(lost.why.find("numbers"), std::string::npos) << lost.why;
  }
}

}  // namespace
}  // namespace poise::certificate_cases_test
