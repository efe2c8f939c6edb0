#include "solvers/linear_program.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::solvers::linear_program_test {
namespace {

using Status = LinearProgramResult::Status;

LinearProgram program(const Eigen::MatrixXd& rows, const Eigen::VectorXd& bounds, const Eigen::VectorXd& objective) {
  return {rows, bounds, objective};
}

TEST(LinearProgram, CornerOfATriangle) {
  const LinearProgramResult found = solve(program((Eigen::MatrixXd(3, 2) << 1, 1, -1, 0, 0, -1).finished(),
                                                  Eigen::Vector3d(2, 1, 1), Eigen::Vector2d(1, 2)));
  ASSERT_EQ(found.status, Status::optimal);
  EXPECT_NEAR(found.x[0], -1.0, 1e-14);
  EXPECT_NEAR(found.x[1], 3.0, 1e-14);
  EXPECT_NEAR(found.multipliers.dot(Eigen::Vector3d(2, 1, 1)), 5.0, 1e-14);
}

TEST(LinearProgram, UnboundedAlongItsRay) {
  const LinearProgramResult found =
      solve(program((Eigen::MatrixXd(1, 2) << -1, 1).finished(), Eigen::VectorXd::Ones(1), Eigen::Vector2d(1, 1)));
  ASSERT_EQ(found.status, Status::unbounded);
  EXPECT_LE(-found.ray[0] + found.ray[1], 1e-14);
  EXPECT_GT(found.ray.sum(), 0.0);
}

TEST(LinearProgram, NoRowsForAVariable) {
  EXPECT_EQ(solve(program(Eigen::MatrixXd::Zero(0, 2), Eigen::VectorXd::Zero(0), Eigen::Vector2d(0, 0))).status,
            Status::optimal);
  EXPECT_EQ(solve(program(Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1))).status,
            Status::unbounded);
}

// Weak duality makes each answer prove itself.
TEST(LinearProgram, RandomProgramsProveTheirAnswers) {
  std::mt19937 random(static_cast<unsigned>(test::seed(1)));
  std::normal_distribution<double> normal;
  int count[3] = {0, 0, 0};
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Index n = 1 + trial % 5, m = 1 + trial % 13;
    const auto any = [&] { return trial % 3 == 0 ? std::round(normal(random)) : normal(random); };
    const LinearProgram p{Eigen::MatrixXd::NullaryExpr(m, n, any),
                          Eigen::VectorXd::NullaryExpr(m, [&] { return any() + (trial % 2); }),
                          Eigen::VectorXd::NullaryExpr(n, any)};
    const LinearProgramResult found = solve(p);
    ASSERT_NE(found.status, Status::not_solved) << trial;
    ++count[static_cast<int>(found.status)];
    const double rounding = 1e-9 * (1 + (found.x.size() > 0 ? found.x.norm() : 0.0));
    if (found.status != Status::infeasible) {
      EXPECT_LE((p.rows * found.x - p.bounds).maxCoeff(), rounding) << trial;
    }
    if (found.status == Status::unbounded) {
      EXPECT_LE((p.rows * found.ray).maxCoeff(), 1e-9 * found.ray.norm()) << trial;
      EXPECT_GT(p.objective.dot(found.ray), 0.0) << trial;
      continue;
    }
    const Eigen::VectorXd& z = found.multipliers;
    EXPECT_GE(z.minCoeff(), 0.0) << trial;
    if (found.status == Status::optimal) {
      EXPECT_LE((p.rows.transpose() * z - p.objective).norm(), 1e-9 * (1 + z.norm())) << trial;
      EXPECT_NEAR(p.bounds.dot(z), p.objective.dot(found.x), rounding * (1 + z.norm())) << trial;
    } else {
      EXPECT_LE((p.rows.transpose() * z).norm(), 1e-9 * z.norm()) << trial;
      EXPECT_LT(p.bounds.dot(z), 0.0) << trial;
    }
  }
  for (const int one : count) EXPECT_GT(one, 100);
}

}  // namespace
}  // namespace poise::solvers::linear_program_test
