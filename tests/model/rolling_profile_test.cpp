// The functions of a curve that rolls against closed forms, differences, 50 digits and their enclosures.

#include "model/rolling_profile.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "model/mechanism_impl.hpp"
#include "solvers/interval.hpp"
#include "solvers/real50.hpp"
#include "statics/model/ball_mechanism.hpp"
#include "statics/model/interval_mechanism.hpp"

namespace poise::model_rolling_profile_test {
namespace {

using std::numbers::pi;

/// Part of an ellipse from its vertex on the right, counter-clockwise.
std::vector<Vec2> ellipse(double a, double b, int points, double turn = 2 * pi) {
  const bool is_closed = turn == 2 * pi;
  std::vector<Vec2> out;
  for (int k = 0; k < points + (is_closed ? 0 : 1); ++k) {
    const Vec2 at = unit(turn * k / points);
    out.push_back({a * at.x, b * at.y});
  }
  return out;
}

std::array<const Profile*, 4> all_of(const RollingProfile& profile) {
  return {profile.angle.get(), profile.length.get(), profile.along.get(), profile.across.get()};
}

/// Open and closed ones, of few points and of many.
std::vector<RollingProfile> some_profiles() {
  std::vector<RollingProfile> out;
  for (const int points : {8, 12, 48}) {
    out.push_back(rolling_profile(ellipse(0.5, 0.2, points), true).value());
    out.push_back(rolling_profile(ellipse(0.5, 0.2, points, 3.0), false).value());
  }
  out.push_back(rolling_profile({{0.0, 0.3}, {0.2, 0.0}, {0.7, 0.1}}, false).value());
  return out;
}

// Perimeter 4 a E(e); the tangent turns once; the tangent at a vertex is as far from the centre as the vertex is.
TEST(RollingProfiles, OfAnEllipseApproachItsPerimeterWithTheFourthPower) {
  const double a = 0.5, b = 0.2, perimeter = 4 * a * boost::math::ellint_2(std::sqrt(1 - b * b / (a * a)));
  std::vector<double> off;
  for (const int points : {40, 80, 160}) {
    const RollingProfile of = rolling_profile(ellipse(a, b, points), true).value();
    off.push_back(std::abs(of.length->at(1.0).value - perimeter));
    EXPECT_DOUBLE_EQ(of.angle->at(2.0).value - of.angle->at(-1.0).value, 6 * pi);
    EXPECT_NEAR(of.length->at(2.0).value, 2 * of.length->at(1.0).value, 1e-14);
    EXPECT_NEAR(of.across->at(0.25).value, -b, 1e-12);
    EXPECT_NEAR(of.along->at(0.25).value, 0.0, 1e-12);
    const double curvature = of.angle->at(0.25).first / of.length->at(0.25).first;
    EXPECT_NEAR(curvature, b / (a * a), 300.0 / (points * points));
  }
  EXPECT_GT(std::log2(off[0] / off[1]), 3.8);
  EXPECT_GT(std::log2(off[1] / off[2]), 3.8);
}

// The ends of an open curve are as accurate as its middle: curved.
TEST(RollingProfiles, HaveCurvedEnds) {
  std::vector<double> off;
  for (const int points : {20, 40, 80}) {
    const RollingProfile of = rolling_profile(ellipse(0.3, 0.3, points, 2.0), false).value();
    off.push_back(std::abs(of.angle->at(0.0).first / of.length->at(0.0).first - 1 / 0.3));
  }
  EXPECT_LT(off[1], off[0] / 3.5);
  EXPECT_LT(off[2], off[1] / 3.5);
  EXPECT_LT(off[2], 1e-2);
}

TEST(RollingProfiles, KnowTheirDerivatives) {
  comparison::Random random(20261125);
  for (const RollingProfile& of : some_profiles()) {
    for (const Profile* const profile : all_of(of)) {
      for (int k = 0; k < 300; ++k) {
        const double u = profile->periodic() ? random.uniform(-2.0, 3.0) : random.uniform(0.01, 0.99);
        constexpr double h = 1e-5;
        // Third derivatives of a cubic spline jump where its pieces meet.
        bool is_near_border = false;
        for (const Profile::Piece& piece : profile->pieces()) {
          is_near_border = is_near_border || std::abs(u - std::floor(u) - piece.from) < 3 * h;
          is_near_border = is_near_border || std::abs(u - std::floor(u) - piece.to) < 3 * h;
        }
        if (is_near_border) continue;
        const ProfileValue<double> p = profile->at(u);
        const auto central = [&](auto part) {
          return (part(profile->at(u - 2 * h)) - 8 * part(profile->at(u - h)) + 8 * part(profile->at(u + h)) -
                  part(profile->at(u + 2 * h))) /
                 (12 * h);
        };
        EXPECT_NEAR(p.first, central([](const auto& at) { return at.value; }), 2e-9);
        EXPECT_NEAR(p.second, central([](const auto& at) { return at.first; }), 2e-9 * (1 + std::abs(p.second)));
        EXPECT_NEAR(p.third, central([](const auto& at) { return at.second; }), 2e-9 * (1 + std::abs(p.third)));
      }
    }
  }
}

// In double to rounding of 50 digits, there to rounding of a quadrature.
TEST(RollingProfiles, AreExactToRoundingOfEachScalar) {
  comparison::Random random(4);
  for (const RollingProfile& of : some_profiles()) {
    for (const Profile* const profile : all_of(of)) {
      for (int k = 0; k < 100; ++k) {
        const double u = profile->periodic() ? random.uniform(-2.0, 3.0) : random.uniform(0.0, 1.0);
        EXPECT_NEAR(profile->at(u).value, static_cast<double>(profile->at(Real50(u)).value), 5e-15);
      }
    }
    for (const Profile::Piece& piece : of.length->pieces()) {
      EXPECT_TRUE(Profile::is_short(piece));
      const auto speed = [&](const Real50& t) {
        const Real50 x = piece.c[2] + t * (2 * Real50(piece.c[3]) + 3 * t * Real50(piece.c[4]));
        const Real50 y = piece.c[6] + t * (2 * Real50(piece.c[7]) + 3 * t * Real50(piece.c[8]));
        return Real50(sqrt(Real50(x * x + y * y)));
      };
      const Real50 integral =
          boost::math::quadrature::gauss_kronrod<Real50, 61>::integrate(speed, Real50(-0.5), Real50(0.5), 10, 1e-45);
      const Profile alone({piece}, false);
      const Real50 length = alone.at(Real50(piece.to)).value - alone.at(Real50(piece.from)).value;
      EXPECT_LT(abs(length - integral), Real50(1e-48));
    }
  }
}

// Values and derivatives at numbers of random sets are in the enclosures, across the ends of pieces and of turns; those
// of small sets are narrow.
TEST(RollingProfiles, AreEnclosed) {
  comparison::Random random(7);
  for (const RollingProfile& of : some_profiles()) {
    for (const Profile* const profile : all_of(of)) {
      for (int k = 0; k < 120; ++k) {
        const double middle = profile->periodic() ? random.uniform(-2.0, 3.0) : random.uniform(-0.1, 1.1);
        const double radius = std::pow(10.0, random.uniform(-13.0, 0.5));
        const ProfileValue<Ball> ball = profile->at(Ball(middle).widened(radius));
        ProfileValue<solvers::Interval> in;
        {
          const solvers::RoundingUp up;
          in = profile->at(solvers::Interval(middle - radius, middle + radius));
        }
        for (const double part : {-0.9, -0.3, 0.0, 0.6, 0.95}) {
          const ProfileValue<Real50> p = profile->at(Real50(middle + part * radius));
          const auto expect_in = [&](const Real50& x, const solvers::Interval& set, const Ball& other) {
            EXPECT_FALSE(x < set.lower() || x > set.upper()) << middle << " +- " << radius;
            // The midpoint is rounded to double.
            const double rounding = 1e-15 * std::abs(other.middle());
            EXPECT_FALSE(other.is_finite() && abs(x - other.middle()) > other.radius() + rounding)
                << middle << " +- " << radius;
          };
          expect_in(p.value, in.value, ball.value);
          expect_in(p.first, in.first, ball.first);
          expect_in(p.second, in.second, ball.second);
          expect_in(p.third, in.third, ball.third);
        }
        if (radius < 1e-8) {
          EXPECT_LT(in.value.width(), 300 * radius + 1e-13);
          EXPECT_LT(ball.value.radius(), 150 * radius);
        }
      }
    }
  }
}

TEST(RollingProfiles, RefuseCusps) {
  // Down a line and back on it.
  EXPECT_FALSE(rolling_profile({{0, 0}, {1, 0}, {2, 0}, {1, 0}, {0, 0}}, false));
}

}  // namespace
}  // namespace poise::model_rolling_profile_test
