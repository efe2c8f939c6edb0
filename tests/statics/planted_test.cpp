// Random mechanisms whose equilibrium is known: the two methods against the truth, and so against each other.

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "solvers/newton.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/check.hpp"
#include "statics/model/reference.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/seed.hpp"

namespace poise::planted_test {
namespace {

using test::PlantedMechanism;
using test::Wish;

constexpr double virtual_work_accuracy = 1e-12;
constexpr double energy_accuracy = 1e-9;

// A planted mechanism, compiled, with what is known of it in the solvers' coordinates.
struct Sample {
  Sample(std::uint64_t seed, Wish wish)
      : planted(test::plant_mechanism(seed, wish)),
        model(planted.scene),
        equilibrium(model.from_si(planted.equilibrium)),
        name(fmt::format("loops {}, seed {}: {} coordinates, {} freedoms, {} redundant, {} stops pressing", wish.loops,
                         seed, model.mechanism().coordinates(), planted.freedoms, planted.redundant,
                         planted.pressing.size())) {}

  Equilibrium solved(Method method, Seek seek) const {
    const SolveOptions options = {.method = method, .seek = seek};
    if (!planted.hangs_on_bars) return solve(model, options);
    // The scene's own start does not say how bars point: what solve() does with it is done here with ours.
    const std::vector<double> start = model.from_si(planted.start);
    if (method == Method::virtual_work) return solve(model, start, options);
    solvers::Newton newton(model.problem());
    return solve(model, newton.close(start).x, options);
  }

  // Largest difference from the planted equilibrium: rad, or lengths over the size of the mechanism. Bars, whose guess
  // is an angle between -pi and pi, may differ by a turn.
  double error(std::vector<double> x) const {
    for (const Link& link : model.layout().links) {
      if (link.body >= 0 || link.frame < 0 || link.frame >= model.layout().kept) continue;
      x[link.frame] = equilibrium[link.frame] + std::remainder(x[link.frame] - equilibrium[link.frame], 2 * M_PI);
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - equilibrium[i]));
    return worst;
  }

  Stability stability() const { return planted.falling() > 0 ? Stability::unstable : Stability::stable; }

  PlantedMechanism planted;
  StaticModel model;
  std::vector<double> equilibrium;
  std::string name;
};

// `seeds` mechanisms of each number of loops from 1 to 6.
void for_samples(int seeds, Wish wish, const std::function<void(const Sample&)>& expect) {
  for (wish.loops = 1; wish.loops <= 6; ++wish.loops) {
    for (int k = 0; k < seeds; ++k) {
      const Sample sample(static_cast<std::uint64_t>(1000 * wish.loops + k), wish);
      SCOPED_TRACE(sample.name);
      expect(sample);
    }
  }
}

// What a test saw of a method, for a person and for the report.
struct Tally {
  std::string method;
  int mechanisms = 0;
  double worst = 0.0;

  void add(double error) {
    ++mechanisms;
    worst = std::max(worst, error);
  }
  ~Tally() {
    testing::Test::RecordProperty(method + "_mechanisms", mechanisms);
    testing::Test::RecordProperty(method + "_worst_error", fmt::format("{:.3g}", worst));
    std::cout << fmt::format("{}: {} mechanisms, worst error {:.3g}\n", method, mechanisms, worst);
  }
};

void expect_judged(const Sample& sample, const Certificate& certificate, const Check& check) {
  EXPECT_TRUE(check.is_equilibrium()) << check.objection;
  EXPECT_EQ(to_string(certificate.outcome), "proved") << certificate.statement;
  EXPECT_EQ(certificate.stability, sample.stability());
  EXPECT_EQ(certificate.unstable_directions, sample.planted.falling());
}

void expect_judged(const Sample& sample, const Equilibrium& answer) {
  expect_judged(sample, answer.certificate, answer.check);
}

void expect_judged(const Sample& sample, const std::vector<double>& x) {
  expect_judged(sample, certify(sample.model, x), check(sample.model, x));
}

// Of stable equilibria, from the disturbed start.
void expect_descent_by_both_methods(int seeds, const Wish& wish) {
  Tally work{"virtual_work"};
  Tally energy{"energy"};
  for_samples(seeds, wish, [&](const Sample& sample) {
    if (sample.stability() != Stability::stable) return;
    const Equilibrium descended = sample.solved(Method::virtual_work, Seek::stable);
    work.add(sample.error(descended.x));
    EXPECT_LE(sample.error(descended.x), virtual_work_accuracy) << descended.why;
    expect_judged(sample, descended);
    const Equilibrium minimised = sample.solved(Method::energy, Seek::stable);
    energy.add(sample.error(minimised.x));
    EXPECT_LE(sample.error(minimised.x), energy_accuracy) << minimised.why;
    expect_judged(sample, minimised);
  });
}

TEST(Planted, SampleIsMixed) {
  int kinds[5] = {}, acts[3] = {}, freedoms[4] = {};
  int unstable = 0, redundant = 0, torsion = 0;
  for_samples(60, {}, [&](const Sample& sample) {
    const Scene& scene = sample.model.scene();
    bool seen[5] = {}, pulled[3] = {};
    for (const Joint& joint : scene.joints) seen[static_cast<int>(joint.kind)] = true;
    for (int k = 0; k < test::count_of(scene, "spring"); ++k) {
      pulled[static_cast<int>(test::law<LinearSpring>(scene, "spring", k).acts)] = true;
    }
    for (int k = 0; k < 5; ++k) kinds[k] += seen[k];
    for (int k = 0; k < 3; ++k) acts[k] += pulled[k];
    ASSERT_EQ(sample.model.mechanism().closures(), sample.planted.loops);
    ASSERT_GE(sample.planted.freedoms, 1);
    ASSERT_LE(sample.planted.freedoms, 3);
    ++freedoms[sample.planted.freedoms];
    unstable += sample.planted.falling() > 0;
    redundant += sample.planted.redundant > 0;
    torsion += test::count_of(scene, "torsion_spring") > 0;
  });
  for (const int count : kinds) EXPECT_GT(count, 40);
  for (const int count : acts) EXPECT_GT(count, 40);
  for (int f = 1; f <= 3; ++f) EXPECT_GT(freedoms[f], 40);
  EXPECT_GT(unstable, 100);
  EXPECT_LT(unstable, 260);
  EXPECT_GT(redundant, 40);
  EXPECT_GT(torsion, 100);
}

TEST(Planted, TheEquilibriumAndItsStabilityAreProved) {
  for_samples(60, {}, [](const Sample& sample) { expect_judged(sample, sample.equilibrium); });
}

TEST(Planted, NothingIsProvedThatOnlyReactionsAgainstEachOtherBalance) {
  // Redundant closures are dependent only where they hold. A gap of 1e-9 leaves the closure Jacobian a singular value
  // of that order, and reactions of 1e9 loads, against one another, then balance anything.
  test::Random random(3);
  for_samples(test::cases(24, 60), {}, [&](const Sample& sample) {
    if (sample.planted.redundant == 0) return;
    solvers::Newton newton(sample.model.problem());
    const std::vector<double> closed = newton.close(sample.model.from_si(sample.planted.start)).x;
    for (const double gap : {0.0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8}) {
      std::vector<double> x = closed;
      for (double& coordinate : x) coordinate += random.uniform(-gap, gap);
      const Certificate proof = certify(sample.model, x);
      EXPECT_TRUE(!proof.confirmed() || proof.moved > 1e-7) << gap << ": " << proof.statement;
    }
  });
}

TEST(Planted, VirtualWorkRecoversTheEquilibrium) {
  Tally tally{"virtual_work"};
  for_samples(60, {}, [&](const Sample& sample) {
    const Equilibrium answer = sample.solved(Method::virtual_work, Seek::any);
    tally.add(sample.error(answer.x));
    EXPECT_LE(sample.error(answer.x), virtual_work_accuracy) << answer.why;
    EXPECT_EQ(answer.status, Status::confirmed) << answer.why;
    expect_judged(sample, answer);
  });
}

TEST(Planted, EnergyAgreesWhereTheEquilibriumIsStable) {
  Tally tally{"energy"};
  for_samples(60, {}, [&](const Sample& sample) {
    if (sample.stability() != Stability::stable) return;
    const Equilibrium answer = sample.solved(Method::energy, Seek::any);
    tally.add(sample.error(answer.x));
    EXPECT_LE(sample.error(answer.x), energy_accuracy) << answer.why;
    EXPECT_EQ(answer.status, Status::confirmed) << answer.why;
    expect_judged(sample, answer);
  });
}

TEST(Planted, FiftyDigitsSettleOnTheEquilibrium) {
  Tally tally{"fifty_digits"};
  for_samples(4, {}, [&](const Sample& sample) {
    const Reference reference = refine(sample.model, sample.equilibrium);
    ASSERT_TRUE(reference.refined) << reference.why;
    tally.add(reference.error);
    EXPECT_LE(reference.error, virtual_work_accuracy);
    EXPECT_GE(reference.digits, 40);
  });
}

// Springs of other laws: curves, at and between their points, gas struts, preloaded springs, bump stops.
TEST(PlantedLaws, VirtualWorkRecoversTheEquilibrium) {
  Tally tally{"virtual_work"};
  for_samples(90, {.other_laws = true, .disturbance = 0.005}, [&](const Sample& sample) {
    expect_judged(sample, sample.equilibrium);
    const Equilibrium answer = sample.solved(Method::virtual_work, Seek::any);
    tally.add(sample.error(answer.x));
    EXPECT_LE(sample.error(answer.x), virtual_work_accuracy) << answer.why;
    EXPECT_EQ(answer.status, Status::confirmed) << answer.why;
    expect_judged(sample, answer);
  });
}

TEST(PlantedLaws, EnergyAgreesWhereTheEquilibriumIsStable) {
  Tally tally{"energy"};
  for_samples(30, {.other_laws = true, .disturbance = 0.005}, [&](const Sample& sample) {
    if (sample.stability() != Stability::stable) return;
    const Equilibrium answer = sample.solved(Method::energy, Seek::any);
    tally.add(sample.error(answer.x));
    EXPECT_LE(sample.error(answer.x), energy_accuracy) << answer.why;
    EXPECT_EQ(answer.status, Status::confirmed) << answer.why;
  });
}

TEST(PlantedLaws, FiftyDigitsSettleOnTheEquilibrium) {
  Tally tally{"fifty_digits"};
  for_samples(4, {.other_laws = true, .disturbance = 0.005}, [&](const Sample& sample) {
    const Reference reference = refine(sample.model, sample.equilibrium);
    ASSERT_TRUE(reference.refined) << reference.why;
    tally.add(reference.error);
    EXPECT_LE(reference.error, virtual_work_accuracy);
  });
}

// Gears, belts, racks, couplings, cams and ropes, mixed with stops, other laws and springs upon their measures.
constexpr Wish everything{.stops = true, .other_laws = true, .couplings = true, .disturbance = 0.002};

TEST(PlantedCouplings, SampleIsMixed) {
  std::map<std::string, int> tables;
  int pulleys = 0, one_sided = 0;
  for_samples(90, everything, [&](const Sample& sample) {
    for (const Stop& stop : sample.model.scene().stops) {
      ++tables[stop.table];
      one_sided += stop.table != "stop" && !stop.holds();
      for (const RopeContact& contact : stop.on.contacts) pulleys += contact.radius > 0.0;
    }
    for (const Element& element : sample.model.scene().elements) tables["stretching " + element.table] += 1;
  });
  for (const char* table : {"gear", "belt", "rack", "coupling", "cam", "rope", "stretching rope"}) {
    EXPECT_GT(tables[table], 30) << table;
  }
  EXPECT_GT(one_sided, 100);
  EXPECT_GT(pulleys, 50);
}

TEST(PlantedCouplings, TheEquilibriumAndItsStabilityAreProved) {
  for_samples(90, everything, [](const Sample& sample) { expect_judged(sample, sample.equilibrium); });
}

TEST(PlantedCouplings, BothMethodsDescendOntoThem) { expect_descent_by_both_methods(test::cases(45, 90), everything); }

TEST(PlantedCouplings, FiftyDigitsSettleOnTheEquilibrium) {
  Tally tally{"fifty_digits"};
  for_samples(8, everything, [&](const Sample& sample) {
    const Reference reference = refine(sample.model, sample.equilibrium);
    ASSERT_TRUE(reference.refined) << reference.why;
    tally.add(reference.error);
    EXPECT_LE(reference.error, virtual_work_accuracy);
    EXPECT_GE(reference.digits, 40);
  });
}

TEST(PlantedFollowers, VirtualWorkRecoversTheEquilibrium) {
  Tally tally{"virtual_work"};
  for_samples(20, {.followers = true}, [&](const Sample& sample) {
    const Equilibrium answer = sample.solved(Method::virtual_work, Seek::any);
    tally.add(sample.error(answer.x));
    EXPECT_LE(sample.error(answer.x), virtual_work_accuracy) << answer.why;
    EXPECT_EQ(answer.status, Status::confirmed) << answer.why;
    // Of an unsymmetric stiffness only the sign of its determinant does not depend on the scale of coordinates.
    EXPECT_EQ(answer.certificate.unstable_directions % 2, sample.planted.falling() % 2);
    if (sample.planted.freedoms == 1) expect_judged(sample, answer);
  });
}

TEST(PlantedFollowers, EnergyDoesNotApplyAndNamesTheLoad) {
  for_samples(5, {.followers = true}, [](const Sample& sample) {
    const Equilibrium answer = sample.solved(Method::energy, Seek::any);
    EXPECT_EQ(answer.status, Status::not_applicable);
    EXPECT_NE(answer.why.find("\"follower0\""), std::string::npos) << answer.why;
  });
}

TEST(PlantedStops, TheEquilibriumAndItsStabilityAreProved) {
  int pressing = 0;
  int no_freedom_left = 0;
  for_samples(60, {.stops = true}, [&](const Sample& sample) {
    expect_judged(sample, sample.equilibrium);
    pressing += !sample.planted.pressing.empty();
    no_freedom_left += sample.planted.curvature.empty();
  });
  EXPECT_GT(pressing, 100);
  EXPECT_GT(no_freedom_left, 20);
}

TEST(PlantedStops, BothMethodsDescendOntoThem) { expect_descent_by_both_methods(60, {.stops = true}); }

TEST(PlantedStops, NearestStaysWhereItIsAtRest) {
  Tally tally{"virtual_work"};
  for_samples(test::cases(24, 60), {.stops = true}, [&](const Sample& sample) {
    const Equilibrium answer = solve(sample.model, sample.equilibrium, {});
    tally.add(sample.error(answer.x));
    EXPECT_LE(sample.error(answer.x), virtual_work_accuracy) << answer.why;
    expect_judged(sample, answer);
  });
}

TEST(PlantedStops, NearestNeverClaimsWhatTheCheckRefutes) {
  // Near an active stop, Newton's method may find a nearer equilibrium away from it.
  int found = 0;
  for_samples(60, {.stops = true}, [&](const Sample& sample) {
    const Equilibrium answer = sample.solved(Method::virtual_work, Seek::any);
    EXPECT_NE(answer.status, Status::not_confirmed) << answer.why;
    found += answer.found();
  });
  EXPECT_GT(found, 340);
}

}  // namespace
}  // namespace poise::planted_test
