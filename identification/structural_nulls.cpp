#include "identification/structural_nulls.hpp"

#include <algorithm>
#include <cmath>

namespace poise {
namespace {

/// Rows of one kind - accelerations or a sensor's readings in a run - whose units do not compare with those of others.
struct Block {
  Eigen::MatrixXd rows, again;
};

/// Sets the columns of a block to zero that are no larger than their errors: a factor may not make an effect of them.
void drop_rounding(Block& block) {
  for (Eigen::Index i = 0; i < block.rows.cols(); ++i) {
    if (!is_rounding(block.rows.col(i), block.again.col(i))) continue;
    block.rows.col(i).setZero();
    block.again.col(i).setZero();
  }
}

/// Multiplies every block by a factor such that its largest column, relative to the column of all, is 1.
void balance(std::vector<Block>& blocks, Eigen::Index columns) {
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(columns);
    for (const Block& block : blocks) squares += block.rows.colwise().squaredNorm().transpose();
    for (Block& block : blocks) {
      double largest = 0.0;
      for (Eigen::Index i = 0; i < columns; ++i) {
        if (squares[i] > 0) largest = std::max(largest, block.rows.col(i).squaredNorm() / squares[i]);
      }
      if (largest == 0) continue;
      block.rows /= std::sqrt(largest);
      block.again /= std::sqrt(largest);
    }
  }
}

}  // namespace

NullSpace structural_nulls(const FitProblem& problem, const std::vector<double>& parameters,
                           const std::vector<std::vector<double>>& nuisances) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  std::vector<Block> blocks;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    const std::vector<int>& used = problem.parameters_of(r);
    const std::vector<double> unknowns = problem.unknowns_of(r, parameters);
    const int states = 20 + 3 * run.unknowns() / std::max(1, run.freedoms());
    const RunModel::Actions actions = run.actions(unknowns.data(), nuisances[r].data(), states);
    for (int kind = 0; kind < actions.rows_per_state; ++kind) {
      Block block;
      const Eigen::Index count = actions.rows.rows() / actions.rows_per_state;
      block.rows = block.again = Eigen::MatrixXd::Zero(count, n);
      for (std::size_t c = 0; c < used.size(); ++c) {
        for (Eigen::Index s = 0; s < count; ++s) {
          const Eigen::Index row = s * actions.rows_per_state + kind;
          block.rows(s, used[c]) = actions.rows(row, static_cast<Eigen::Index>(c));
          block.again(s, used[c]) = actions.again(row, static_cast<Eigen::Index>(c));
        }
      }
      drop_rounding(block);
      blocks.push_back(std::move(block));
    }
  }
  balance(blocks, n);
  Eigen::Index rows = n;
  for (const Block& block : blocks) rows += block.rows.rows();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, n);
  Eigen::MatrixXd again = all;
  Eigen::Index row = n;
  for (const Block& block : blocks) {
    all.middleRows(row, block.rows.rows()) = block.rows;
    again.middleRows(row, block.rows.rows()) = block.again;
    row += block.rows.rows();
  }
  // Of a prior a null direction has no part.
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!problem.unknown_of(static_cast<std::size_t>(i)).prior) continue;
    all.col(i).setZero();
    again.col(i).setZero();
    all(i, i) = again(i, i) = 1.0;
  }
  return null_space(all, again, {});
}

}  // namespace poise
