// Mechanisms with more bars than they need, near a pose in which they lie flat: closed forms in 50 digits judge what is
// said of them.

#include "tests/support/near_flat.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/read_scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"
#include "tests/support/seed.hpp"

namespace poise::near_flat_test {
namespace {

using test::NearFlat;

// Three cranks of 0.4 m, one more than needed, 0.0116 rad from flat, and a spring of 10 N/m and 0.2 m that ends 0.6 m
// ahead of the tip of the first: 4 N.
const char* const smallest = R"(
[ground]
points = { A1 = [0, 0], A2 = [0.01, 0], A3 = [1.3, 0], S = [-0.9999328059438939, 0.011592393936158275] }
[body.crank1]
points = { A = [0, 0], B = [0.4, 0] }
[body.crank2]
points = { A = [0, 0], B = [0.4, 0] }
[body.crank3]
points = { A = [0, 0], B = [0.4, 0] }
[body.platform]
points = { B1 = [0, 0], B2 = [0.01, 0], B3 = [1.3, 0] }
[[pin]]
points = ["ground.A1", "crank1.A"]
[[pin]]
points = ["ground.A2", "crank2.A"]
[[pin]]
points = ["ground.A3", "crank3.A"]
[[pin]]
points = ["crank1.B", "platform.B1"]
[[pin]]
points = ["crank2.B", "platform.B2"]
[[pin]]
points = ["crank3.B", "platform.B3"]
[[spring]]
name = "spring"
points = ["ground.S", "platform.B1"]
stiffness = 10
free_length = 0.2
[start]
crank1 = 3.129
crank2 = 3.129
crank3 = 3.129
)";

TEST(NearFlat, TheSpringOfThreeCranksHasFourNewtons) {
  for (const Seek seek : {Seek::any, Seek::settle, Seek::stable}) {
    SCOPED_TRACE(to_string(seek));
    const StaticModel model(parse_scene(smallest, "smallest.toml"));
    const Equilibrium answer = solve(model, {.seek = seek});
    EXPECT_EQ(answer.status, Status::confirmed) << answer.why;
    EXPECT_EQ(to_string(answer.certificate.outcome), "proved") << answer.certificate.statement;
    EXPECT_EQ(to_string(answer.certificate.stability), "stable");
    EXPECT_EQ(answer.certificate.redundant, 1);
    EXPECT_FALSE(answer.certificate.singular);
    EXPECT_LE(answer.certificate.radius, 1e-14);
    const ElementForce& force = answer.check.element_forces.at(0);
    EXPECT_NEAR(force.value, 4.0, 1e-14);
    EXPECT_LE(force.radius, 1e-13);
    for (const double angle : model.to_si(answer.x)) {
      EXPECT_NEAR(angle, std::abs(angle) > 1.0 ? 3.13 : 0.0, 1e-14) << "no turn is added";
    }
  }
}

// What is wrong with a confirmed answer; empty if nothing is.
std::string fault(const NearFlat& made, const StaticModel& model, const Equilibrium& answer) {
  const Certificate& proof = answer.certificate;
  const auto bodies = model.poses(answer.x);
  std::vector<Real50> t;
  for (const int body : made.cranks) t.emplace_back(bodies[static_cast<std::size_t>(body)].angle);
  const std::vector<Real50> said = t;
  NearFlat::Derivatives at = made.derivatives(t);
  for (int step = 0; step < 60; ++step) {
    const auto by = at.second.fullPivLu().solve(at.first).eval();
    for (std::size_t i = 0; i < t.size(); ++i) t[i] -= by[static_cast<Eigen::Index>(i)];
    at = made.derivatives(t);
    if (by.cwiseAbs().maxCoeff() < Real50(1e-40)) break;
  }
  double away = 0.0;
  double nearest_flat = 1.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    away = std::max(away, static_cast<double>(abs(t[i] - said[i])));
    nearest_flat = std::min(nearest_flat, std::abs(std::sin(static_cast<double>(t[i]) - made.flat)));
  }
  const double rounding = 4 * proof.rounding_effect + 1e-15;
  if (away > proof.radius + rounding) return fmt::format("{:.3g} away, said {:.3g}", away, proof.radius);
  // Only a flat pose is singular, and only there a radius contains more than rounding.
  if (proof.singular && nearest_flat > proof.radius + rounding) return fmt::format("flat {:.3g} away", nearest_flat);
  if (!proof.singular && proof.radius > 1e-9 + 1e3 * proof.rounding_effect) {
    return fmt::format("a radius of {:.3g}", proof.radius);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> curvature(at.second.cast<double>());
  const Eigen::VectorXd& values = curvature.eigenvalues();
  if (values.cwiseAbs().minCoeff() > 1e-9 * values.cwiseAbs().maxCoeff()) {
    const auto falling = static_cast<int>((values.array() < 0.0).count());
    if (!proof.singular && proof.unstable_directions != falling) {
      return fmt::format("{} unstable directions, not {}", proof.unstable_directions, falling);
    }
    if ((proof.stability == Stability::unstable) != (falling > 0)) return "the stability";
  }
  for (std::size_t s = 0; s < made.springs.size(); ++s) {
    const ElementForce& force = answer.check.element_forces[s];
    const auto& law = std::get<LinearSpring>(made.scene.elements[s].law);
    const double allowed = law.stiffness * made.size * 10 * rounding + 1e-14 * std::abs(force.value);
    const Real50 exact = made.tension(static_cast<int>(s), t);
    const auto off = static_cast<double>(abs(exact - force.value));
    if (!(force.radius < law.stiffness * made.size)) return "a force without radius";
    if (off > force.radius + allowed) {
      return fmt::format("spring {}: {:.17g}, right {:.17g}, radius {:.3g}", s, force.value, static_cast<double>(exact),
                         force.radius);
    }
  }
  return "";
}

// Torques may turn cranks for ever, or through a flat pose in which they might cross: then no equilibrium is claimed.
TEST(RandomNearFlat, AreJudgedInFiftyDigits) {
  int confirmed = 0, denied = 0, not_found = 0, wrong = 0;
  const int count = test::cases(25, 5000);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(k) + 1);
    const NearFlat made = test::near_flat(seed);
    const StaticModel model(made.scene);
    for (const Seek seek : {Seek::any, Seek::settle}) {
      const Equilibrium answer = solve(model, {.seek = seek});
      const std::string name = fmt::format("{} {}, seek {}", made.kind, seed, to_string(seek));
      if (answer.found()) {
        ++confirmed;
        const std::string what = fault(made, model, answer);
        EXPECT_EQ(what, "") << name << ": " << answer.certificate.statement;
        if (!what.empty()) ++wrong;
      } else if (answer.status == Status::not_confirmed) {
        ++denied;
        std::cout << name << ": " << answer.why << std::endl;
      } else {
        ++not_found;
      }
    }
  }
  std::cout << fmt::format("{} mechanisms: {} answers confirmed, {} of them wrong, {} denied, {} not found\n", count,
                           confirmed, wrong, denied, not_found);
  EXPECT_GE(confirmed, count);
  EXPECT_LE(denied, 1 + count / 20);
}

}  // namespace
}  // namespace poise::near_flat_test
