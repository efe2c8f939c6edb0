#include "identification/identifiability/private/structural_nulls.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/identifiability/private/structural_nulls_50.hpp"
#include "model/controllers.hpp"

namespace poise {
namespace {

/// Rows of one kind - accelerations or a sensor's readings in a run - whose units do not compare with those of others.
struct Block {
  Eigen::MatrixXd rows, again, error;
};

/// Sets the columns of a block to zero that are no larger than their errors: a factor may not make an effect of them.
/// Marks those that were not zero.
void drop_rounding(Block& block, std::vector<bool>& dropped) {
  for (Eigen::Index i = 0; i < block.rows.cols(); ++i) {
    const double size = block.rows.col(i).norm();
    if (size > block.error.col(i).norm() && !is_rounding(block.rows.col(i), block.again.col(i))) continue;
    if (size > 0) dropped[static_cast<std::size_t>(i)] = true;
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

/// Adds rows below others.
template <class Matrix>
void append(const Matrix& more, Matrix& to) {
  const Eigen::Index before = to.rows();
  to.conservativeResize(before + more.rows(), more.cols());
  to.bottomRows(more.rows()) = more;
}

/// Takes out of each column its part along `rate`, by which the start of a run can make up for it.
void take_out(const Eigen::VectorXd& rate, Eigen::MatrixXd& rows) {
  constexpr double rounding = 1e-13;
  const double square = rate.squaredNorm();
  if (square == 0) return;
  for (Eigen::Index i = 0; i < rows.cols(); ++i) {
    const double before = rows.col(i).norm();
    rows.col(i) -= rate.dot(rows.col(i)) / square * rate;
    if (rows.col(i).norm() <= rounding * before) rows.col(i).setZero();
  }
}

}  // namespace

NullSpace structural_nulls(const FitProblem& problem, const std::vector<double>& parameters,
                           const std::vector<std::vector<double>>& nuisances) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  if (!controllers_of(problem.experiment().scene).empty()) {
    NullSpace none;
    none.basis.resize(n, 0);
    none.error = Eigen::VectorXd::Zero(n);
    return none;
  }
  std::vector<Block> blocks;
  std::vector<bool> dropped(parameters.size(), false);
  std::vector<RunModel::Actions> of_runs;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    const std::vector<int>& used = problem.parameters_of(r);
    const std::vector<double> unknowns = problem.unknowns_of(r, parameters);
    const int states = 20 + 3 * run.unknowns() / std::max(1, run.freedoms());
    of_runs.push_back(run.actions(unknowns.data(), nuisances[r].data(), states));
    const RunModel::Actions& actions = of_runs.back();
    const Eigen::Index count = actions.rows.rows() / std::max(1, actions.rows_per_state);
    const bool shifts = actions.rate.size() > 0;
    Block of_sensors;  // all of them, relative to their rates, where these count
    Eigen::VectorXd rate(0), rate_again(0);
    for (int kind = 0; kind < actions.rows_per_state; ++kind) {
      Block block;
      block.rows = block.again = block.error = Eigen::MatrixXd::Zero(count, n);
      for (std::size_t c = 0; c < used.size(); ++c) {
        for (Eigen::Index s = 0; s < count; ++s) {
          const Eigen::Index row = s * actions.rows_per_state + kind;
          block.rows(s, used[c]) = actions.rows(row, static_cast<Eigen::Index>(c));
          block.again(s, used[c]) = actions.again(row, static_cast<Eigen::Index>(c));
          block.error(s, used[c]) = actions.error(row, static_cast<Eigen::Index>(c));
        }
      }
      drop_rounding(block, dropped);
      if (!shifts || kind < run.freedoms()) {
        blocks.push_back(std::move(block));
        continue;
      }
      Eigen::VectorXd own(count), own_again(count);
      for (Eigen::Index s = 0; s < count; ++s) {
        own[s] = actions.rate[s * actions.rows_per_state + kind];
        own_again[s] = actions.rate_again[s * actions.rows_per_state + kind];
      }
      const double size = own.norm() > 0 ? own.norm() : block.rows.norm() > 0 ? block.rows.norm() : 1.0;
      append<Eigen::MatrixXd>(block.rows / size, of_sensors.rows);
      append<Eigen::MatrixXd>(block.again / size, of_sensors.again);
      append<Eigen::VectorXd>(own / size, rate);
      append<Eigen::VectorXd>(own_again / size, rate_again);
    }
    if (!shifts) continue;
    take_out(rate, of_sensors.rows);
    take_out(rate_again, of_sensors.again);
    blocks.push_back(std::move(of_sensors));
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
  NullSpace out = null_space(all, again, {});
  bool doubtful = out.doubtful;
  for (Eigen::Index i = 0; i < n; ++i) doubtful = doubtful || (dropped[static_cast<std::size_t>(i)] && out.touches(i));
  if (!doubtful) return out;
  return structural_nulls_50(problem, of_runs).value_or(std::move(out));
}

}  // namespace poise
