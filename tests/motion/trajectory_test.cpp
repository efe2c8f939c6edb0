#include "motion/trajectory.hpp"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace poise::trajectory_test {
namespace {

using Function = std::function<double(double)>;

// One coordinate with one sensitivity, k times the coordinate.
Trajectory trajectory(const std::vector<double>& t, const Function& q, const Function& v, const Function& a, double k) {
  Trajectory out;
  out.coordinates = 1;
  out.columns = 1;
  out.t = t;
  for (double at : t) {
    out.q.push_back(q(at));
    out.v.push_back(v(at));
    out.a.push_back(a(at));
    out.q_p.push_back(k * q(at));
    out.v_p.push_back(k * v(at));
    out.a_p.push_back(k * a(at));
  }
  return out;
}

double power(double t, int n) { return std::pow(1 - t / 3, n); }

// Twelve conditions fix a polynomial of degree 11; six at a motion of one step one of degree 5.
TEST(TrajectoryReader, ReadsPolynomialsExactly) {
  for (const auto& [n, t] :
       {std::pair<int, std::vector<double>>{11, {0.0, 0.2, 0.5, 0.9, 1.6, 2.0}},
        std::pair<int, std::vector<double>>{8, {0.0, 0.8, 1.5}}, std::pair<int, std::vector<double>>{5, {0.0, 1.5}}}) {
    const int degree = n;
    const Trajectory path = trajectory(
        t, [=](double at) { return power(at, degree); }, [=](double at) { return -degree * power(at, degree - 1) / 3; },
        [=](double at) { return degree * (degree - 1) * power(at, degree - 2) / 9; }, 3.0);
    TrajectoryReader reader(path, {0});
    for (double at = 0.0; at <= t.back(); at += 0.013) {
      reader.at(at);
      const double rate = -degree * power(at, degree - 1) / 3;
      EXPECT_NEAR(reader.q(0), power(at, degree), 1e-13) << degree << " at " << at;
      EXPECT_NEAR(reader.v(0), rate, 1e-11) << degree << " at " << at;
      EXPECT_NEAR(reader.q_p(0)[0], 3 * power(at, degree), 1e-12);
      EXPECT_NEAR(reader.v_p(0)[0], 3 * rate, 1e-10);
    }
  }
}

// v = -tanh((t - 2) / w) turns over within w: long intervals beside that are not to be read across it.
TEST(TrajectoryReader, DoesNotReadAcrossACorner) {
  constexpr double w = 0.02;
  const auto tanh_of = [=](double t) { return std::tanh((t - 2) / w); };
  std::vector<double> t{0.0, 0.4, 0.8, 1.2, 1.6, 1.75};
  for (double s = 1.82; s < 2.18; s += 0.006) t.push_back(s);
  for (double s : {2.25, 2.4, 2.8, 3.2, 3.6, 4.0}) t.push_back(s);
  const Trajectory path = trajectory(
      t, [=](double at) { return -w * std::log(2 * std::cosh((at - 2) / w)); }, [=](double at) { return -tanh_of(at); },
      [=](double at) { return (tanh_of(at) * tanh_of(at) - 1) / w; }, 1.0);
  TrajectoryReader reader(path, {0});
  for (double at = 0.0; at <= 4.0; at += 0.007) {
    reader.at(at);
    EXPECT_NEAR(reader.q(0), -w * std::log(2 * std::cosh((at - 2) / w)), 1e-9) << at;
    EXPECT_NEAR(reader.v(0), -tanh_of(at), 1e-6) << at;
  }
}

TEST(TrajectoryReader, GoesBackInTime) {
  const Trajectory path = trajectory(
      {0, 0.3, 0.6, 0.9, 1.2, 1.5}, [](double t) { return std::sin(t); }, [](double t) { return std::cos(t); },
      [](double t) { return -std::sin(t); }, 1.0);
  TrajectoryReader reader(path, {0});
  for (double at : {1.4, 0.1, 0.7, 1.5, 0.0, 0.3}) {
    reader.at(at);
    EXPECT_NEAR(reader.q(0), std::sin(at), 1e-13);
    EXPECT_NEAR(reader.v(0), std::cos(at), 1e-11);
  }
}

TEST(ReadingError, IsWhatTheLastTwoConditionsAdd) {
  // Two nodes of t^5: it is 3 t^3 (t - 1) + t^3 (t - 1)^2 and what four conditions see, t^3.
  const NodeValues nodes[] = {{0.0, 0.0, 0.0, 0.0}, {1.0, 1.0, 5.0, 20.0}};
  for (double t : {0.25, 0.5}) {
    EXPECT_NEAR(reading_error({nodes, 2}, t), t * t * t * (2 * (1 - t) + (1 - t) * (1 - t)), 1e-15);
  }
}

}  // namespace
}  // namespace poise::trajectory_test
