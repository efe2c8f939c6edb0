// Force laws upon a measure: their forces against their energies, and derivatives against differences in 50 digits.

#include "model/laws/laws.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/real50.hpp"

namespace poise::laws_test {
namespace {

using Real = Real50;

// Every law there is but controllers, which are no functions of one measure: its numbers between 0.75 and 3.5; of laws
// with several shapes, all of them.
std::vector<Law> every_law() {
  std::vector<Law> laws;
  const auto add = [&]<std::size_t... I>(std::index_sequence<I...>) {
    (laws.emplace_back(std::variant_alternative_t<I, Law>{}), ...);
  };
  add(std::make_index_sequence<std::variant_size_v<Law>>{});
  std::erase_if(laws, [](const Law& law) { return controller_of(law) != nullptr; });
  using Falls = DryFriction::Falls;
  for (const Falls falls : {Falls::exponential, Falls::hyperbolic}) {
    laws.emplace_back(DryFriction{.static_force = 10.0, .falls = falls});
  }
  laws.emplace_back(GasStrut{.damps = true});
  laws.emplace_back(CompliantStop{.has_min = true, .has_max = false});
  laws.emplace_back(CurveDamper({-1.0, -0.25, 0.5, 2.0}, {-1.5, -1.0, 0.5, 2.0}, false));
  for (Law& law : laws) {
    double value = 0.75;
    for (const Number& number : numbers_of(law)) {
      std::visit([&](auto& l) { number.set(&l, value); }, law);
      value += 0.375;
    }
  }
  return laws;
}

// T(g, w) and its derivatives.
template <class S>
LawForce<S> whole_force(const Law& law, const S& g, const S& w) {
  const LawForce<S> rest = force_at_rest(law, g);
  const LawForce<S> motion = force_of_motion(law, g, w);
  return {rest.value + motion.value, rest.by_measure + motion.by_measure, rest.by_rate + motion.by_rate};
}

// On both sides of the free length, at rest and moving both ways.
struct Sample {
  Real g, w;
};
const std::vector<Sample> samples{{Real(-2.5), Real(0)},   {Real(0.25), Real(-3)}, {Real(0.9), Real(0.125)},
                                  {Real(1.75), Real(0.5)}, {Real(4), Real(-0.25)}, {Real(7.5), Real(2)}};

void expect_same(const Real& found, const Real& expected, const std::string& what) {
  EXPECT_LT(static_cast<double>(abs(found - expected)), 1e-14 * (1 + static_cast<double>(abs(expected)))) << what;
}

void expect_derivatives(const Law& law, const Sample& at) {
  const Real h = Real(1e-18);
  const auto value = [&](const Real& g, const Real& w) -> Real { return whole_force(law, g, w).value; };
  const LawForce<Real> force = whole_force(law, at.g, at.w);
  expect_same((energy(law, Real(at.g + h)) - energy(law, Real(at.g - h))) / (2 * h), force_at_rest(law, at.g).value,
              "dV/dg");
  expect_same((value(at.g + h, at.w) - value(at.g - h, at.w)) / (2 * h), force.by_measure, "dT/dg");
  expect_same((value(at.g, at.w + h) - value(at.g, at.w - h)) / (2 * h), force.by_rate, "dT/dw");
  for (int k = 0; k < static_cast<int>(numbers_of(law).size()); ++k) {
    const Number& number = numbers_of(law)[k];
    // Exact in double, so that only the third derivative counts.
    const double step = 0x1p-26;
    const auto changed = [&](double by) -> Real {
      Law other = law;
      std::visit([&](auto& l) { number.set(&l, number.get(&l).value() + by); }, other);
      return whole_force(other, at.g, at.w).value;
    };
    expect_same((changed(step) - changed(-step)) / Real(2 * step), force_by_number(law, k, at.g, at.w),
                "dT/d" + std::string(number.key));
  }
}

TEST(Laws, KnowTheirDerivatives) {
  for (const Law& law : every_law()) {
    SCOPED_TRACE(law.index());
    ASSERT_FALSE(numbers_of(law).empty());
    for (const Sample& at : samples) expect_derivatives(law, at);
  }
}

TEST(Laws, ActAtRestOrResistMotion) {
  for (const Law& law : every_law()) {
    SCOPED_TRACE(law.index());
    EXPECT_TRUE(stores_energy(law) || resists_motion(law));
    EXPECT_EQ(left_out_of_statics(law).empty(), stores_energy(law));
    EXPECT_EQ(idle(law), "") << "its numbers are not zero";
    for (const Sample& at : samples) {
      EXPECT_EQ(force_at_rest(law, at.g).by_rate, 0);
      if (is_motor(law)) {
        EXPECT_LT(force_of_motion(law, at.g, Real(0)).value, 0) << "drives";
      } else {
        EXPECT_EQ(force_of_motion(law, at.g, Real(0)).value, 0);
        EXPECT_GE(force_of_motion(law, at.g, at.w).value * at.w, 0) << "takes power";
      }
      if (!stores_energy(law)) {
        EXPECT_EQ(energy(law, at.g), 0);
        EXPECT_EQ(force_at_rest(law, at.g).value, 0);
      }
    }
  }
}

// A controller with all numbers that may be together, or with a transfer function; with a curve or without.
Controller whole_controller(int order, double max, bool has_curve) {
  Controller controller;
  controller.order = order;
  controller.given = (1U << Controller::numerator) - 1;
  if (order > 0) controller.given = ((1U << Controller::count) - 1) & ~(1U << Controller::filter);
  if (order == 1) controller.given &= ~(1U << (Controller::numerator + 2) | 1U << (Controller::denominator + 2));
  controller.unit = 0.25;
  controller.effort_unit = 8.0;
  double value = 0.75;
  for (double& one : controller.values) one = value += 0.375;
  controller.values[Controller::dead_band] = 0.125;
  controller.values[Controller::min] = -40;
  controller.values[Controller::max] = max;
  if (has_curve) {
    controller.curve =
        std::make_shared<const ForceCurve>(std::vector{-1.0, 0.0, 2.5, 4.0}, std::vector{-3.0, 0.5, 2.0, 2.25});
    controller.numbered_points = true;
  }
  controller.declare(dimension::angle, true, dimension::torque);
  return controller;
}

// What it does, with a period by what it holds, and what it decides.
TEST(Laws, ControllersKnowTheirDerivatives) {
  const Real h = Real(1e-18);
  using Signals = ControlSignals<Real>;
  const auto all = [](const ControlOutputs<Real>& of) {
    return std::array<Real, 5>{of.effort, of.integral, of.filtered, of.unlimited, of.input};
  };
  const Signals at{Real(-0.7), Real(0.3),  Real(0.25), Real(0.4), Real(1.3),
                   Real(-0.2), Real(-1.1), Real(0.6),  Real(0.9)};
  const Signals change{Real(0.5), Real(-0.4), Real(0.2), Real(0.9), Real(0.3),
                       Real(0.7), Real(-0.8), Real(1.1), Real(0.15)};
  for (const int variant : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) {
    const Controller controller = whole_controller(variant % 3, variant % 2 == 0 ? 1.0 : 1e3, variant >= 6);
    for (const bool decides : {false, true}) {
      const auto does = [&](const Controller& law, const Signals& in) {
        return all(decides ? law.decide(in) : law.respond(in));
      };
      const auto moved = [&](const Real& by) {
        return does(controller, at.each<Real>([&](auto member) { return Real(at.*member + by * change.*member); }));
      };
      const auto up = moved(h), down = moved(-h),
                 along = all(decides ? controller.decide_along(at, change) : controller.respond_along(at, change));
      for (std::size_t k = 0; k < along.size(); ++k) expect_same((up[k] - down[k]) / (2 * h), along[k], "along");
      const std::span<const Number> numbers = controller.all_numbers();
      for (std::size_t n = 0; n < numbers.size(); ++n) {
        const double step = 0x1p-26;
        const auto changed = [&](double by) {
          Controller other = controller;
          numbers[n].set(&other, numbers[n].get(&other).value() + by);
          return does(other, at);
        };
        const auto number = static_cast<int>(n);
        const auto above = changed(step), below = changed(-step),
                   by = all(decides ? controller.decide_by(number, at) : controller.respond_by(number, at));
        for (std::size_t k = 0; k < by.size(); ++k) {
          expect_same((above[k] - below[k]) / Real(2 * step), by[k], "by " + std::string(numbers[n].key));
        }
      }
    }
  }
}

TEST(Laws, AreTheFormulasOfTheirDocumentation) {
  const LinearSpring spring{3.0, 0.5};
  EXPECT_EQ(energy(spring, 2.5), 6.0);
  EXPECT_EQ(force_at_rest(spring, 2.5).value, 6.0);
  EXPECT_EQ(force_at_rest(spring, 0.0).value, -1.5);
  EXPECT_EQ(force_at_rest(spring, 0.0).by_measure, 3.0);
  const ConstantForce weight{4.0};
  EXPECT_EQ(energy(weight, -2.0), -8.0);
  EXPECT_EQ(force_at_rest(weight, -2.0).value, 4.0);
  EXPECT_EQ(force_of_motion(weight, 1.0, 1.0).value, 0.0);
  EXPECT_EQ(force_of_motion(Damper{0.5}, 1.0, -3.0).value, -1.5);
  const DryFriction friction{2.0, 0.25};
  EXPECT_DOUBLE_EQ(force_of_motion(friction, 0.0, 0.1).value, 2.0 * std::tanh(0.4));
  // Far beyond the width, where 1 - tanh^2 is rounding.
  EXPECT_DOUBLE_EQ(force_of_motion(friction, 0.0, 5.0).by_rate, 2.0 / 0.25 * std::pow(std::cosh(20.0), -2));
  EXPECT_EQ(force_of_motion(friction, 0.0, 100.0).value, 2.0);
  EXPECT_EQ(force_of_motion(friction, 0.0, 0.0).by_rate, 2.0 / 0.25);
}

TEST(Laws, OfMotorsAreTheFormulasOfTheirDocumentation) {
  const DcMotor dc{3.2, 120.0};
  EXPECT_EQ(force_of_motion(dc, 0.0, 0.0).value, -3.2);
  EXPECT_EQ(force_of_motion(dc, 0.0, 60.0).value, -1.6);
  EXPECT_EQ(force_of_motion(dc, 0.0, 120.0).value, 0.0);
  EXPECT_DOUBLE_EQ(force_of_motion(dc, 0.0, 240.0).value, 3.2);
  // ../shared/benchmarks.md 4.4: the torque at rest, and at a slip of 0.03.
  const InductionMotor induction{40.0, 0.2, 50.0};
  EXPECT_NEAR(-force_of_motion(induction, 0.0, 0.0).value, 15.3846153846, 1e-10);
  EXPECT_NEAR(-force_of_motion(induction, 0.0, 0.97 * 50.0).value, 11.7359413203, 1e-10);
  EXPECT_NEAR(-force_of_motion(induction, 0.0, 0.8 * 50.0).value, 40.0, 1e-12);
  EXPECT_EQ(force_of_motion(induction, 0.0, 50.0).value, 0.0);
}

TEST(Laws, OfResistanceAreTheFormulasOfTheirDocumentation) {
  using Acts = SpringActs;
  EXPECT_EQ(force_of_motion(DragDamper{2.0, 0.5}, 0.0, -4.0).value, -16.0);
  EXPECT_EQ(force_of_motion(DragDamper{2.0, 0.5}, 0.0, -4.0).by_rate, 6.0);
  for (const double w : {-4.0, -0.5, 0.0, 0.5, 4.0}) {
    EXPECT_EQ(force_of_motion(Damper{2.0, Acts::tension}, 0.0, w).value, w > 0 ? 2 * w : 0.0);
    EXPECT_EQ(force_of_motion(Damper{2.0, Acts::compression}, 0.0, w).value, w < 0 ? 2 * w : 0.0);
    EXPECT_EQ(force_of_motion(DragDamper{0.0, 2.0, Acts::tension}, 0.0, w).value, w > 0 ? 2 * w * w : 0.0);
  }
  // Through (0, 0) and its points; odd where all rates are positive, and a line where the points are on one.
  const CurveDamper odd({1.0, 2.0}, {3.0, 4.0}, true), both({-2.0, -1.0, 0.5}, {-3.0, -1.0, 2.0}, true);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(force_of_motion(odd, 0.0, side).value, 3 * side);
    EXPECT_DOUBLE_EQ(force_of_motion(odd, 0.0, 2 * side).value, 4 * side);
  }
  EXPECT_EQ(force_of_motion(both, 0.0, -1.0).value, -1.0);
  EXPECT_EQ(force_of_motion(both, 0.0, 0.5).value, 2.0);
  EXPECT_EQ(force_of_motion(both, 0.0, 0.0).value, 0.0);
  DryFriction friction{2.0, 0.0, 3.0, 0.5, 2.0, DryFriction::Falls::exponential};
  EXPECT_EQ(friction.bound(), 3.0);
  EXPECT_DOUBLE_EQ(force_of_motion(friction, 0.0, -1.0).value, -2.0 - std::exp(-4.0));
  EXPECT_EQ(friction.sliding(2, -1.0).value, 3.0);
  friction.falls = DryFriction::Falls::hyperbolic;
  EXPECT_DOUBLE_EQ(force_of_motion(friction, 0.0, 1.0).value, 2.0 + 1.0 / 3.0);
  friction.falls = DryFriction::Falls::drop;
  EXPECT_EQ(force_of_motion(friction, 0.0, 1e-9).value, 2.0);
  const GasStrut strut{0.0, 0.5, 0.2, 1.4, 1.0, true, 3.0, 40.0, 0.05};
  EXPECT_EQ(force_of_motion(strut, 0.44, 2.0).value, 6.0);
  EXPECT_NEAR(force_of_motion(strut, 0.475, 2.0).value, 6.0 + 40.0, 1e-12);
  EXPECT_EQ(force_of_motion(strut, 0.51, 2.0).value, 6.0 + 80.0);
  const CompliantStop stop{0.0, 1.0, 4.0, 0.5, 1.5, true, true};
  EXPECT_TRUE(stop.slack(0.5));
  EXPECT_DOUBLE_EQ(force_at_rest(stop, 5.0).value, 32.0);
  EXPECT_DOUBLE_EQ(force_at_rest(stop, -4.0).value, -32.0);
  EXPECT_DOUBLE_EQ(force_of_motion(stop, 5.0, 1.0).value, 16.0);
  EXPECT_DOUBLE_EQ(force_of_motion(stop, 5.0, -3.0).value, -32.0) << "it never pulls";
}

TEST(Laws, OneWaySpringsAreSlackOnTheOtherSide) {
  using Acts = LinearSpring::Acts;
  const LinearSpring both{3.0, 0.5, Acts::both};
  for (const double g : {-1.0, 0.0, 0.25, 0.5, 0.75, 2.0}) {
    SCOPED_TRACE(g);
    for (const Acts acts : {Acts::tension, Acts::compression}) {
      const LinearSpring spring{3.0, 0.5, acts};
      const bool slack = acts == Acts::tension ? g <= 0.5 : g >= 0.5;
      EXPECT_EQ(spring.slack(g), slack);
      EXPECT_EQ(energy(spring, g), slack ? 0.0 : energy(both, g));
      EXPECT_EQ(force_at_rest(spring, g).value, slack ? 0.0 : force_at_rest(both, g).value);
      EXPECT_EQ(force_at_rest(spring, g).by_measure, slack ? 0.0 : 3.0);
      for (const int number : {0, 1}) {
        EXPECT_EQ(force_by_number(spring, number, g, 1.0), slack ? 0.0 : force_by_number(both, number, g, 1.0));
      }
      if (g == 0.5) continue;
      expect_derivatives(spring, {Real(g), Real(1)});
    }
    EXPECT_FALSE(both.slack(g));
  }
}

TEST(Laws, SayWhyTheyNeverAct) {
  EXPECT_EQ(idle(LinearSpring{0.0, 1.0}), "its stiffness is zero");
  EXPECT_EQ(idle(ConstantForce{0.0}), "it is zero");
  EXPECT_EQ(left_out_of_statics(Damper{1.0}), "nothing moves in statics");
  EXPECT_TRUE(left_out_of_statics(DryFriction{1.0}).starts_with("nothing moves in statics"));
  EXPECT_EQ(left_out_of_statics(LinearSpring{1.0, 1.0}), "");
}

}  // namespace
}  // namespace poise::laws_test
