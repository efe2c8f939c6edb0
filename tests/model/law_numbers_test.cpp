// Force laws with their numbers as variables: as they are, in dual numbers, and in balls and intervals.

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "model/laws/laws.hpp"
#include "solvers/ball.hpp"
#include "solvers/interval.hpp"
#include "solvers/real50.hpp"

namespace poise::law_numbers_test {
namespace {

using solvers::Ball;
using solvers::Interval;

constexpr int most_numbers = 8;
using Dual = ceres::Jet<double, most_numbers>;

struct Case {
  std::string name;
  Law law;
  std::vector<double> at;  // measures
};

// Of every law; on both sides of what makes it act, and in all its pieces.
std::vector<Case> cases() {
  std::vector<Case> out;
  for (const SpringActs acts : {SpringActs::both, SpringActs::tension, SpringActs::compression}) {
    out.push_back({"linear", LinearSpring{3.0, 0.5, acts}, {0.25, 0.75, -1.0}});
    out.push_back({"bump", BumpStop{80.0, 0.3, 0.02, 3.0, acts}, {0.27, 0.29, 0.31, 0.34}});
  }
  out.push_back({"cubic", CubicSpring{2.0, 5.0, 0.5}, {0.25, 0.75, -1.0}});
  out.push_back({"constant", ConstantForce{4.0}, {0.25, -1.0}});
  out.push_back({"preloaded", PreloadedSpring{40.0, 12.0, 1.5}, {1.0, 2.0}});
  for (const double n : {1.0, 1.0 + 1e-9, 1.25, 3.0}) {
    out.push_back({"gas", GasStrut{500.0, 0.5, 0.2, 1.4, n}, {0.25, 0.31, 0.35, 0.45, 0.55}});
  }
  for (const bool numbered : {true, false}) {
    out.push_back({"curve",
                   CurveSpring({-1.0, -0.25, 0.5, 1.0, 2.0}, {-3.0, -0.5, 1.0, 4.0, 3.5}, numbered),
                   {-2.0, -0.5, 0.25, 0.7, 1.5, 2.5}});
  }
  out.push_back({"damped gas", GasStrut{500.0, 0.5, 0.2, 1.4, 1.25, true, 3.0, 40.0, 0.05}, {0.25, 0.31, 0.47, 0.55}});
  for (const double n : {1.0, 1.5}) {
    out.push_back({"stop", CompliantStop{-0.25, 1.0, 4.0, 0.5, n, true, true}, {-2.0, -0.5, 0.25, 1.5}});
    out.push_back({"upper stop", CompliantStop{0.0, 1.0, 4.0, 0.5, n}, {-2.0, 0.25, 1.5}});
  }
  for (const SpringActs acts : {SpringActs::both, SpringActs::tension, SpringActs::compression}) {
    out.push_back({"damper", Damper{0.5, acts}, {0.25}});
    out.push_back({"drag", DragDamper{0.5, 2.0, acts}, {0.25}});
  }
  for (const bool numbered : {true, false}) {
    out.push_back({"odd curve of a damper", CurveDamper({0.1, 0.5, 1.0}, {0.5, 0.75, 2.0}, numbered), {0.25}});
    out.push_back({"curve of a damper", CurveDamper({-1.0, -0.1, 0.5}, {-0.5, -0.25, 2.0}, numbered), {0.25}});
  }
  using Falls = DryFriction::Falls;
  for (const Falls falls : {Falls::exponential, Falls::hyperbolic, Falls::drop}) {
    out.push_back({"falling friction", DryFriction{2.0, 0.25, 3.0, 0.5, 1.5, falls}, {0.25}});
  }
  out.push_back({"friction", DryFriction{2.0, 0.25}, {0.25}});
  out.push_back({"DC motor", DcMotor{3.0, 20.0}, {0.25}});
  out.push_back({"induction motor", InductionMotor{40.0, 0.2, 150.0}, {0.25}});
  return out;
}

std::vector<double> numbers_in(const Law& law) {
  std::vector<double> out;
  std::visit(
      [&](const auto& l) {
        for (const Number& n : numbers_of_law(l)) out.push_back(n.get(&l).value());
      },
      law);
  return out;
}

// Energy, static force and its slope.
template <class T>
using AtRest = std::array<T, 3>;

template <class T>
AtRest<T> at_rest(const Law& law, const std::vector<T>& p, const T& g) {
  return std::visit(
      [&]<class L>(const L& l) -> AtRest<T> {
        if constexpr (StoresEnergy<L>) {
          const auto with = l.with(p.data());
          const LawForce<T> force = with.at_rest(g);
          return {with.energy(g), force.value, force.by_measure};
        } else {
          return {T(0), T(0), T(0)};
        }
      },
      law);
}

// The force at a rate.
template <class T>
T in_motion(const Law& law, const std::vector<T>& p, const T& g, const T& rate) {
  return std::visit(
      [&]<class L>(const L& l) -> T {
        if constexpr (ResistsMotion<L>)
          return l.with(p.data()).resisting(g, rate).value;
        else
          return T(0);
      },
      law);
}

TEST(LawNumbers, AsTheyAreLeaveTheLawAsItIs) {
  constexpr double rate = -0.125;
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const std::vector<double> p = numbers_in(one.law);
    for (const double g : one.at) {
      const LawForce<double> force = force_at_rest(one.law, g);
      EXPECT_EQ(at_rest(one.law, p, g), (AtRest<double>{energy(one.law, g), force.value, force.by_measure})) << g;
      EXPECT_EQ(in_motion(one.law, p, g, rate), force_of_motion(one.law, g, rate).value) << g;
    }
  }
}

// Others in double, too: a curve through other points is that curve.
TEST(LawNumbers, OfDoublesAreThoseOfTheLawSetToThem) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    std::vector<double> p = numbers_in(one.law);
    Law other = one.law;
    for (std::size_t k = 0; k < p.size(); ++k) {
      p[k] *= 1.0 + 0x1p-6 * static_cast<double>(k + 1);
      std::visit([&](auto& l) { numbers_of_law(l)[k].set(&l, p[k]); }, other);
    }
    for (const double g : one.at) {
      const LawForce<double> force = force_at_rest(other, g);
      EXPECT_EQ(at_rest(one.law, p, g), (AtRest<double>{energy(other, g), force.value, force.by_measure})) << g;
    }
  }
}

TEST(LawNumbers, AsDualNumbersGiveDerivatives) {
  const Real50 h("1e-18");
  constexpr double rate = -0.125;
  for (const Case& one : cases()) {
    const std::vector<double> p = numbers_in(one.law);
    ASSERT_LE(p.size(), static_cast<std::size_t>(most_numbers));
    std::vector<Dual> dual;
    for (std::size_t k = 0; k < p.size(); ++k) dual.emplace_back(p[k], static_cast<int>(k));
    for (const double g : one.at) {
      const AtRest<Dual> found = at_rest(one.law, dual, Dual(g));
      const Dual moving = in_motion(one.law, dual, Dual(g), Dual(rate));
      for (std::size_t k = 0; k < p.size(); ++k) {
        const auto with = [&](const Real50& change) {
          std::vector<Real50> out(p.begin(), p.end());
          out[k] += change;
          return out;
        };
        const auto more = with(h), less = with(-h);
        const auto slope = [&](const Real50& a, const Real50& b) { return static_cast<double>((a - b) / (2 * h)); };
        const AtRest<Real50> a = at_rest(one.law, more, Real50(g)), b = at_rest(one.law, less, Real50(g));
        const std::string what = one.name + " at " + std::to_string(g) + " by " + std::to_string(k);
        for (std::size_t i = 0; i < found.size(); ++i) {
          const double by = slope(a[i], b[i]);
          EXPECT_NEAR(found[i].v[static_cast<int>(k)], by, 1e-11 * (1 + std::abs(by))) << what << ", " << i;
        }
        const double by_motion =
            slope(in_motion(one.law, more, Real50(g), Real50(rate)), in_motion(one.law, less, Real50(g), Real50(rate)));
        EXPECT_NEAR(moving.v[static_cast<int>(k)], by_motion, 1e-13) << what;
        const double by_hand = force_by_number(one.law, static_cast<int>(k), g, rate);
        const double whole = found[1].v[static_cast<int>(k)] + moving.v[static_cast<int>(k)];
        EXPECT_NEAR(by_hand, whole, 1e-11 * (1 + std::abs(whole))) << what;
      }
    }
  }
}

// A number in 50 digits as a ball, to 32 digits.
Ball ball_of(const Real50& x) {
  const auto high = static_cast<double>(x);
  return Ball(high) + Ball(static_cast<double>(x - high));
}

// Corners and the middle of what the numbers and the measure may be.
std::vector<double> within(const std::vector<double>& middle, double share, int corner) {
  std::vector<double> out = middle;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const int side = corner < 0 ? 0 : ((corner >> (k % 5)) & 1) != 0 ? 1 : -1;
    out[k] += 0.99 * side * share * std::abs(middle[k]);
  }
  return out;
}

TEST(LawNumbers, AsBallsEncloseAllTheirForces) {
  constexpr double share = 1e-3;
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const std::vector<double> p = numbers_in(one.law);
    std::vector<Ball> balls;
    for (const double number : p) balls.push_back(Ball(number).widened(share * std::abs(number)));
    for (const double g : one.at) {
      const AtRest<Ball> found = at_rest(one.law, balls, Ball(g).widened(share * std::abs(g)));
      for (int corner = -1; corner < 32; ++corner) {
        const std::vector<double> numbers = within(p, share, corner), measure = within({g}, share, corner);
        const AtRest<Real50> exact =
            at_rest(one.law, std::vector<Real50>(numbers.begin(), numbers.end()), Real50(measure[0]));
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_TRUE(found[i].is_finite()) << g << ", " << i;
          EXPECT_TRUE(found[i].contains(ball_of(exact[i]))) << g << ", " << i << ", corner " << corner;
        }
      }
    }
  }
}

AtRest<Interval> enclosed(const Law& law, const std::vector<Interval>& p, const Interval& g) {
  const solvers::RoundingUp upwards;
  return at_rest(law, p, g);
}

TEST(LawNumbers, AsIntervalsEncloseAllTheirForces) {
  constexpr double share = 1e-3;
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const std::vector<double> p = numbers_in(one.law);
    const auto around = [&](double x) { return Interval(x - share * std::abs(x), x + share * std::abs(x)); };
    std::vector<Interval> intervals;
    for (const double number : p) intervals.push_back(around(number));
    for (const double g : one.at) {
      const AtRest<Interval> found = enclosed(one.law, intervals, around(g));
      for (int corner = -1; corner < 32; ++corner) {
        const std::vector<double> numbers = within(p, share, corner), measure = within({g}, share, corner);
        const AtRest<Real50> exact =
            at_rest(one.law, std::vector<Real50>(numbers.begin(), numbers.end()), Real50(measure[0]));
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_TRUE(found[i].bounded()) << g << ", " << i;
          EXPECT_TRUE(Real50(found[i].lower()) <= exact[i] && exact[i] <= Real50(found[i].upper()))
              << g << ", " << i << ", corner " << corner;
        }
      }
    }
  }
}

}  // namespace
}  // namespace poise::law_numbers_test
