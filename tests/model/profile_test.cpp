// Cam laws against their closed forms, their derivatives against differences, and their enclosures against samples.

#include "model/profile.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "model/mechanism_impl.hpp"
#include "solvers/interval.hpp"
#include "statics/model/ball_mechanism.hpp"
#include "statics/model/interval_mechanism.hpp"

namespace poise::model_profile_test {
namespace {

using std::numbers::pi;

Profile rise_and_return(std::string_view law) {
  return {{Profile::standard(law, 0.0, 0.35, 0.0, 1.0), Profile::standard("dwell", 0.35, 0.5, 1.0, 1.0),
           Profile::standard(law, 0.5, 0.9, 1.0, 0.0), Profile::standard("dwell", 0.9, 1.0, 0.0, 0.0)},
          true};
}

const std::vector<std::string_view> rises{"harmonic", "cycloidal", "polynomial_345"};

// R. L. Norton, "Cam Design and Manufacturing Handbook", 2009, table 2-3: peaks over h / beta and h / beta^2.
TEST(Profiles, HaveTheKnownPeaksOfVelocityAndAcceleration) {
  struct Peaks {
    std::string_view law;
    double velocity, acceleration;
  };
  for (const Peaks& known : {Peaks{"harmonic", pi / 2, pi * pi / 2}, Peaks{"cycloidal", 2.0, 2 * pi},
                             Peaks{"polynomial_345", 1.875, 10 / std::sqrt(3.0)}}) {
    SCOPED_TRACE(known.law);
    const Profile profile({Profile::standard(known.law, 0.0, 1.0, 0.0, 1.0)}, false);
    double velocity = 0.0, acceleration = 0.0;
    for (int k = 0; k <= 100000; ++k) {
      const ProfileValue<double> p = profile.at(k / 100000.0);
      velocity = std::max(velocity, std::abs(p.first));
      acceleration = std::max(acceleration, std::abs(p.second));
    }
    EXPECT_NEAR(velocity, known.velocity, 1e-8);
    EXPECT_NEAR(acceleration, known.acceleration, 1e-8);
  }
}

TEST(Profiles, AreAsSmoothAsTheirLawsSay) {
  for (const std::string_view law : rises) {
    SCOPED_TRACE(law);
    const Profile profile = rise_and_return(law);
    for (const double end : {0.0, 0.35, 0.5, 0.9, 1.0}) {
      const ProfileValue<double> before = profile.at(end - 1e-12), after = profile.at(end + 1e-12);
      EXPECT_NEAR(before.value, after.value, 1e-11);
      EXPECT_NEAR(before.first, after.first, 1e-9);
      if (law != "harmonic") {
        EXPECT_NEAR(before.second, after.second, 1e-8);
      }
    }
  }
}

TEST(Profiles, KnowTheirDerivatives) {
  std::vector<Profile> all;
  for (const std::string_view law : rises) all.push_back(rise_and_return(law));
  all.push_back(Profile::spline({0.0, 0.2, 0.45, 0.7, 1.0}, {0.1, 1.0, 0.4, -0.3, 0.1}, true));
  all.push_back(Profile::spline({-1.0, 0.2, 0.45, 2.0}, {0.1, 1.0, 0.4, -0.3}, false));
  all.push_back(Profile::geneva(5));
  for (const Profile& profile : all) {
    for (const double u : {-0.77, 0.11, 0.31, 0.61, 0.83, 1.29, 7.64}) {
      SCOPED_TRACE(u);
      constexpr double h = 1e-4;
      const ProfileValue<double> p = profile.at(u);
      const auto central = [&](auto part) {
        return (part(profile.at(u - 2 * h)) - 8 * part(profile.at(u - h)) + 8 * part(profile.at(u + h)) -
                part(profile.at(u + 2 * h))) /
               (12 * h);
      };
      EXPECT_NEAR(p.first, central([](const auto& at) { return at.value; }), 1e-8);
      EXPECT_NEAR(p.second, central([](const auto& at) { return at.first; }), 1e-7);
      EXPECT_NEAR(p.third, central([](const auto& at) { return at.second; }), 1e-6);
    }
  }
}

// The periodic spline through points of a sine approaches it with the fourth power of their distance.
TEST(Profiles, SplinesApproachASineWithTheFourthPower) {
  const auto error = [](int points) {
    std::vector<double> u, p;
    for (int k = 0; k <= points; ++k) {
      u.push_back(static_cast<double>(k) / points);
      p.push_back(std::sin(2 * pi * k / points));
    }
    p.back() = p.front();
    const Profile profile = Profile::spline(u, p, true);
    double worst = 0.0;
    for (int k = 0; k < 1000; ++k) {
      worst = std::max(worst, std::abs(profile.at(k / 1000.0).value - std::sin(2 * pi * k / 1000.0)));
    }
    return worst;
  };
  EXPECT_NEAR(std::log2(error(20) / error(40)), 4.0, 0.1);
  EXPECT_LT(error(40), 2e-6);
}

TEST(Profiles, GoOnAlongTheirTangentsBeyondTheirEnds) {
  const Profile profile = Profile::spline({0.0, 0.3, 1.0}, {0.0, 1.0, 0.5}, false);
  const ProfileValue<double> end = profile.at(1.0), beyond = profile.at(3.0), begin = profile.at(0.0);
  EXPECT_NEAR(beyond.value, end.value + 2 * end.first, 1e-13);
  EXPECT_NEAR(beyond.first, end.first, 1e-13);
  EXPECT_NEAR(profile.at(-2.0).value, begin.value - 2 * begin.first, 1e-13);
}

TEST(Profiles, AreNoNumberOfWhatIsNone) {
  for (const bool periodic : {true, false}) {
    const Profile profile({Profile::standard("cycloidal", 0.0, 1.0, 0.0, 0.0)}, periodic);
    EXPECT_TRUE(std::isnan(profile.at(std::numeric_limits<double>::quiet_NaN()).value));
  }
}

// All values and derivatives of sampled arguments are in the enclosures, in intervals and balls, across the ends of
// pieces and of turns.
TEST(Profiles, AreEnclosed) {
  std::vector<Profile> all;
  for (const std::string_view law : rises) all.push_back(rise_and_return(law));
  all.push_back(Profile::spline({-1.0, 0.2, 0.45, 2.0}, {0.1, 1.0, 0.4, -0.3}, false));
  all.push_back(Profile::geneva(3));
  for (const Profile& profile : all) {
    for (const double middle : {-1.02, -0.3, 0.0, 0.2, 0.35, 0.97, 1.01, 4.4, 123.9}) {
      for (const double radius : {0.0, 1e-9, 1e-3, 0.04, 0.3, 0.9, 5.0}) {
        SCOPED_TRACE(testing::Message() << middle << " +- " << radius);
        const Ball ball = profile.at(Ball(middle).widened(radius)).value;
        ProfileValue<solvers::Interval> in;
        {
          const solvers::RoundingUp up;
          in = profile.at(solvers::Interval(middle - radius, middle + radius));
        }
        for (int k = 0; k <= 40; ++k) {
          const ProfileValue<double> p = profile.at(middle + radius * (k / 20.0 - 1.0));
          const auto expect_in = [](double x, const solvers::Interval& set) {
            const double rounding = 1e-11 * (1 + std::abs(x));
            EXPECT_GE(x, set.lower() - rounding);
            EXPECT_LE(x, set.upper() + rounding);
          };
          expect_in(p.value, in.value);
          expect_in(p.first, in.first);
          EXPECT_LE(std::abs(p.value - ball.middle()), ball.radius() + 1e-11);
        }
        if (radius == 0.0) {
          EXPECT_LT(in.value.width(), 1e-12);
        }
      }
    }
  }
}

}  // namespace
}  // namespace poise::model_profile_test
