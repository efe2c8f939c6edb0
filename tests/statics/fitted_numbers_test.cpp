// Results with the errors of a fit: FittedNumbers, predict().

#include "statics/sensitivity/fitted_numbers.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/toggle_rig.hpp"

namespace poise::fitted_numbers_test {
namespace {

constexpr double normal = 1.959963984540054;  // at 97.5 %

FittedNumbers two_numbers(double a, double sigma_a, double b, double sigma_b, double correlation) {
  FittedNumbers out;
  out.numbers = {{.name = "a", .path = "a", .value = a}, {.name = "b", .path = "b", .value = b}};
  out.covariance.resize(2, 2);
  out.covariance << sigma_a * sigma_a, correlation * sigma_a * sigma_b, correlation * sigma_a * sigma_b,
      sigma_b * sigma_b;
  out.degrees_by_runs = {NAN, NAN};
  return out;
}

/// A result f(a, b) at the numbers and where second order needs it.
template <class F>
PredictedResult predicted(const FittedNumbers& numbers, F f) {
  const auto at = [&](const Eigen::VectorXd& moved) {
    Eigen::Vector2d p{numbers.numbers[0].value, numbers.numbers[1].value};
    if (moved.size() > 0) p += moved;
    return f(p[0], p[1]);
  };
  std::vector<ResultGradient> moved;
  for (const Eigen::VectorXd& by : numbers.moves()) moved.push_back(at(by));
  return predict(numbers, "f", {}, at({}), moved);
}

ResultGradient result_of(double value, double by_a, double by_b) {
  return {.value = value, .why = "", .by = Eigen::Vector2d(by_a, by_b), .rounding = Eigen::VectorXd::Zero(2)};
}

TEST(FittedNumbers, GiveALinearResultItsNormalInterval) {
  const FittedNumbers numbers = two_numbers(3.0, 0.2, 5.0, 0.4, -0.5);
  const PredictedResult found = predicted(numbers, [](double a, double b) { return result_of(2 * a + b, 2.0, 1.0); });
  const double sigma = std::sqrt(4 * 0.04 + 0.16 - 2 * 2 * 0.5 * 0.08);
  EXPECT_NEAR(found.sigma, sigma, 1e-14);
  EXPECT_NEAR(found.low, 11 - normal * sigma, 1e-5);
  EXPECT_NEAR(found.high, 11 + normal * sigma, 1e-5);
  EXPECT_TRUE(found.has_second);
  EXPECT_TRUE(found.is_linear);
  ASSERT_EQ(found.shares.size(), 2u);
  EXPECT_NEAR(found.shares[0].share + found.shares[1].share, 1.0, 1e-14);
}

// Few degrees of freedom: Student's t of 5 at 97.5 % is 2.570582.
TEST(FittedNumbers, CountDegreesOfFreedom) {
  FittedNumbers numbers = two_numbers(1.0, 0.1, 1.0, 0.1, 0.0);
  numbers.degrees = 5;
  const PredictedResult found = predicted(numbers, [](double a, double) { return result_of(a, 1.0, 0.0); });
  EXPECT_NEAR(found.high - found.value, 2.570582 * 0.1, 1e-6);
}

// exp(a) of a normal a: its 95 % interval has the ends exp(a -+ 1.96 sigma). Second order comes near them, first order
// does not; the mean is exp(a + sigma^2 / 2).
TEST(FittedNumbers, BendTheIntervalOfACurvedResult) {
  const double sigma = 0.2;
  const PredictedResult found = predicted(two_numbers(0.0, sigma, 1.0, 0.1, 0.3),
                                          [](double a, double) { return result_of(std::exp(a), std::exp(a), 0.0); });
  EXPECT_FALSE(found.is_linear);
  EXPECT_NEAR(found.value + found.shift, std::exp(sigma * sigma / 2), 1e-3);
  const double low = std::exp(-normal * sigma), high = std::exp(normal * sigma);
  EXPECT_LT(std::abs(found.low - low), 0.2 * std::abs(found.first_low - low));
  EXPECT_LT(std::abs(found.high - high), 0.2 * std::abs(found.first_high - high));
}

// a b with independent errors: the variance of second order is a^2 sb^2 + b^2 sa^2 + sa^2 sb^2, which is exact.
TEST(FittedNumbers, KnowTheSpreadOfAProduct) {
  const PredictedResult found =
      predicted(two_numbers(1.0, 0.3, 2.0, 0.5, 0.0), [](double a, double b) { return result_of(a * b, b, a); });
  EXPECT_NEAR(found.second_sigma, std::sqrt(0.25 + 4 * 0.09 + 0.09 * 0.25), 1e-9);
  EXPECT_NEAR(found.shift, 0.0, 1e-9);
}

// A common factor of both is not known: their ratio is, and neither of them.
TEST(FittedNumbers, GiveNoIntervalToWhatAnOpenDirectionMoves) {
  FittedNumbers numbers = two_numbers(3.0, 0.2, 5.0, 0.4, 0.5);
  numbers.unknown = {{Eigen::Vector2d(3.0, 5.0), Eigen::Vector2d(1e-12, 1e-12), "a and b by one factor"}};
  const PredictedResult ratio =
      predicted(numbers, [](double a, double b) { return result_of(a / b, 1 / b, -a / (b * b)); });
  EXPECT_TRUE(ratio.is_known()) << ratio.undetermined;
  const PredictedResult sum = predicted(numbers, [](double a, double b) { return result_of(a + b, 1.0, 1.0); });
  EXPECT_EQ(sum.undetermined, "a and b by one factor");
  // It is moved by a millionth of what it would be moved by alone.
  const PredictedResult nearly =
      predicted(numbers, [](double a, double b) { return result_of(a / b, (1 + 1e-6) / b, -a / (b * b)); });
  EXPECT_FALSE(nearly.is_known());
}

// a lies at its lower bound or above: a result that grows with it may be larger, and is no smaller.
TEST(FittedNumbers, WidenTheIntervalOnOneSideForABound) {
  FittedNumbers numbers = two_numbers(0.0, 0.3, 5.0, 0.4, 0.0);
  numbers.numbers[0].bound = FittedNumbers::Number::Bound::least;
  const auto grows = [](double a, double b) { return result_of(a + b, 1.0, 1.0); };
  const PredictedResult found = predicted(numbers, grows);
  EXPECT_TRUE(found.is_one_sided);
  EXPECT_NEAR(found.value - found.low, normal * 0.4, 1e-5) << "as if a were known";
  EXPECT_NEAR(found.high - found.value, normal * 0.5, 1e-5) << "as if a were free";
  numbers.numbers[0].bound = FittedNumbers::Number::Bound::most;
  const PredictedResult other = predicted(numbers, grows);
  EXPECT_NEAR(other.value - other.low, normal * 0.5, 1e-5);
  const PredictedResult alone = predicted(numbers, [](double, double b) { return result_of(b, 0.0, 1.0); });
  EXPECT_FALSE(alone.is_one_sided);
  // With b following a, what depends on b alone is moved too.
  numbers.covariance(0, 1) = numbers.covariance(1, 0) = 0.06;
  EXPECT_TRUE(predicted(numbers, [](double, double b) { return result_of(b, 0.0, 1.0); }).is_one_sided);
}

// Errors by runs count where they are larger, with their own degrees of freedom.
TEST(FittedNumbers, TakeTheLargerOfErrorsByReadingsAndByRuns) {
  FittedNumbers numbers = two_numbers(1.0, 0.1, 1.0, 0.1, 0.0);
  numbers.by_runs = Eigen::Vector2d(0.04, 0.0025).asDiagonal();
  numbers.degrees_by_runs = {5.0, 1e6};
  const PredictedResult a = predicted(numbers, [](double a_, double) { return result_of(a_, 1.0, 0.0); });
  EXPECT_NEAR(a.high - a.value, 2.570582 * 0.2, 1e-6);
  const PredictedResult b = predicted(numbers, [](double, double b_) { return result_of(b_, 0.0, 1.0); });
  EXPECT_NEAR(b.high - b.value, normal * 0.1, 1e-5);
  const Eigen::MatrixXd both = numbers.root() * numbers.root().transpose();
  EXPECT_NEAR(both(0, 0), 0.04, 1e-12);
  EXPECT_NEAR(both(1, 1), 0.01, 1e-12);
}

TEST(FittedNumbers, LeaveOutWhatTheSceneHasNot) {
  const Scene rig = parse_scene(test::rig_scene(), "rig.toml");
  FittedNumbers numbers = two_numbers(0.1, 0.01, 1.0, 0.1, 0.0);
  numbers.file = "fit.json";
  numbers.numbers[0].path = "sensor.left.zero";
  numbers.numbers[0].origin = FittedNumbers::Number::Origin::sensor;
  numbers.numbers[1].path = "spring.rubber.stiffness";
  const FittedNumbers left = numbers.of(rig);
  ASSERT_EQ(left.numbers.size(), 1u);
  EXPECT_EQ(left.covariance.rows(), 1);
  numbers.numbers[1].path = "spring.ruber.stiffness";
  const std::string error = test::message_of([&] { numbers.of(rig); });
  EXPECT_NE(error.find("fit.json: rig.toml has no number for its estimate b"), std::string::npos) << error;
}

/// The stiffness of the rig's spring and its free length, the first with 2 %, the second with 0.2 mm.
FittedNumbers rig_numbers(const Scene& rig) {
  FittedNumbers out = two_numbers(10000.0, 200.0, 0.412, 2e-4, 0.6);
  out.numbers[0].path = "spring.rubber.stiffness";
  out.numbers[1].path = "spring.rubber.free_length";
  return out.of(rig);
}

// P = 2 k (l0 - 1 + 0.6 cos a) tan a is largest at a with cos^3 a = (1 - l0) / 0.6: dP/dk = P / k, dP/dl0 = 2 k tan a,
// d2P/dl0 dk = 2 tan a, d2P/dl0^2 = 2 k (da/dl0) / cos^2 a with da/dl0 = 1 / (1.8 cos^2 a sin a).
TEST(FittedNumbers, ReachTheFoldOfAToggle) {
  const Scene rig = parse_scene(test::rig_scene(), "rig.toml");
  const FittedNumbers numbers = rig_numbers(rig);
  const StaticModel model(rig);
  const PredictedResult found = predict(numbers, model, solve(model), {find_quantity(rig, "fold.load.P")}).front();
  ASSERT_TRUE(found.is_known()) << found.why << found.undetermined;
  const double k = 10000.0, cosine = std::cos(test::rig_fold_angle()), a = test::rig_fold_angle();
  EXPECT_NEAR(found.value, test::rig_snap_load(), 1e-9 * found.value);
  const double by_k = found.value / k, by_l0 = 2 * k * std::tan(a);
  const double by_l0_twice = 2 * k / (cosine * cosine) / (1.8 * cosine * cosine * std::sin(a));
  const double kk = 4e4, ll = 4e-8, kl = 0.6 * 200 * 2e-4;
  EXPECT_NEAR(found.sigma, std::sqrt(by_k * by_k * kk + by_l0 * by_l0 * ll + 2 * by_k * by_l0 * kl),
              1e-7 * found.sigma);
  ASSERT_TRUE(found.has_second);
  EXPECT_NEAR(found.shift, 0.5 * (by_l0_twice * ll + 2 * (2 * std::tan(a)) * kl), 1e-3 * std::abs(found.shift));
  // The load itself is no unknown of its own fold.
  FittedNumbers with_load = numbers;
  with_load.numbers[0].path = "load.P";
  const PredictedResult other = predict(with_load, model, solve(model), {find_quantity(rig, "fold.load.P")}).front();
  EXPECT_NEAR(other.sigma, std::abs(by_l0) * 2e-4, 1e-7 * other.sigma);
}

// In equilibrium the spring's force on the block is P / (2 tan a), whatever its stiffness: the angle moves.
TEST(FittedNumbers, ReachTheQuantitiesOfAnEquilibrium) {
  const Scene rig = parse_scene(test::rig_scene(), "rig.toml");
  const FittedNumbers numbers = rig_numbers(rig);
  const StaticModel model(rig);
  const Equilibrium rests = solve(model);
  const std::vector<SoughtQuantity> of = {find_quantity(rig, "angle.left"), find_quantity(rig, "force.rubber"),
                                          find_quantity(rig, "angle.left + angle.right")};
  const std::vector<PredictedResult> found = predict(numbers, model, rests, of);
  const double a = found[0].value;
  EXPECT_NEAR(found[1].value, -8.0 / (2 * std::tan(a)), 1e-9 * std::abs(found[1].value));
  // dF/da = 4 / sin^2 a.
  EXPECT_NEAR(found[1].sigma, found[0].sigma * 4 / std::pow(std::sin(a), 2), 1e-7 * found[1].sigma);
  EXPECT_LT(found[2].sigma, 1e-12) << "both bars turn alike";
  // First order against two positions one standard deviation apart.
  const auto angle_at = [&](double stiffness) {
    Scene other = rig;
    FittedNumbers moved = numbers;
    moved.numbers[0].value = stiffness;
    moved.put_into(other);
    const StaticModel there(other);
    return predict(moved, there, solve(there), {of[0]}).front().value;
  };
  for (const PredictedResult::Share& share : found[0].shares) {
    if (share.number != 0) continue;
    EXPECT_NEAR(share.slope, (angle_at(10001.0) - angle_at(9999.0)) / 2, 1e-5 * std::abs(share.slope));
  }
}

}  // namespace
}  // namespace poise::fitted_numbers_test
