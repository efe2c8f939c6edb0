#include "identification/identifiability/identifiability.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "identification/identifiability/private/null_words.hpp"
#include "identification/identifiability/private/structural_nulls.hpp"
#include "model/controllers.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Singular values of A relative to the largest that errors of its computation may have made of zero.
constexpr double may_be_null = 1e-6;
/// Accuracies of the two motions that tell nulls of these runs from errors.
constexpr double finest_tolerance = 1e-12, less_fine = 1e-10;

std::vector<MatrixXd> triangles_of(const FitProblem& problem, const std::vector<double>& parameters,
                                   const std::vector<std::vector<double>>& nuisances, const Weighting& weighting,
                                   double accuracy) {
  std::vector<MatrixXd> out;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    out.push_back(problem.triangle(r, parameters, nuisances[r], nullptr, infinity,
                                   std::min(accuracy, problem.accuracy(r)), weighting));
  }
  return out;
}

/// A as a square triangle, its columns multiplied by `scale`.
MatrixXd whole_triangle(const FitProblem& problem, const std::vector<MatrixXd>& triangles, const VectorXd& scale) {
  const Index n = scale.size();
  Index rows = n;
  for (std::size_t r = 0; r < problem.runs(); ++r) rows += problem.run(r).unknowns();
  MatrixXd A = MatrixXd::Zero(rows, n);
  for (Index i = 0; i < n; ++i) {
    const Unknown& unknown = problem.unknown_of(static_cast<std::size_t>(i));
    if (unknown.prior) A(i, i) = scale[i] / unknown.prior_deviation;
  }
  Index row = n;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const Index nuisances = problem.run(r).nuisances();
    const Index unknowns = problem.run(r).unknowns();
    for (Index c = 0; c < unknowns; ++c) {
      const int p = problem.parameters_of(r)[static_cast<std::size_t>(c)];
      A.block(row, p, unknowns, 1) = scale[p] * triangles[r].block(nuisances, nuisances + c, unknowns, 1);
    }
    row += unknowns;
  }
  return solvers::triangular_factor(A);
}

/// Q of  min |A - Q B|,  Q orthogonal, times B: triangles of nearly equal matrices may differ in the signs of rows.
MatrixXd turned_to(const MatrixXd& a, const MatrixXd& b) {
  const solvers::SingularValues svd = solvers::singular_value_decomposition(a * b.transpose());
  return svd.left * svd.right.transpose() * b;
}

/// The nulls of the runs beyond the structural ones, and A as accurately as it was needed. Columns in scales.
NullSpace other_nulls(const FitProblem& problem, const std::vector<double>& parameters,
                      const std::vector<std::vector<double>>& nuisances, const VectorXd& scale, bool scales_known,
                      const NullSpace& structural, const Weighting& weighting, MatrixXd& A) {
  NullSpace none;
  none.basis.resize(scale.size(), 0);
  none.error = VectorXd::Zero(scale.size());
  const MatrixXd rest = complement(structural.basis);
  if (rest.cols() == 0) return none;
  const VectorXd s = solvers::singular_value_decomposition(A * rest).values;
  // A change of every reading by standard deviations of the noise is no error of integration.
  if (scales_known && s.tail(1)[0] > std::max(identifiable_from, may_be_null * s[0])) return none;
  const auto triangle = [&](double accuracy) {
    const std::vector<MatrixXd> runs = triangles_of(problem, parameters, nuisances, weighting, accuracy);
    const bool all = std::all_of(runs.begin(), runs.end(), [](const MatrixXd& run) { return run.size() > 0; });
    return all ? whole_triangle(problem, runs, scale) : MatrixXd();
  };
  const MatrixXd again = triangle(less_fine);
  if (again.size() == 0) return null_space(A, A, structural);
  const MatrixXd finer = triangle(finest_tolerance);
  if (finer.size() == 0) return null_space(again, turned_to(again, A), structural);
  A = finer;
  return null_space(A, turned_to(A, again), structural);
}

/// Directions of a null space in which one number each changes by 1 and the `free` ones but that do not.
struct NullDirections {
  std::vector<Index> free;
  MatrixXd directions;  ///< row by row of the parameters, one column per free one
  MatrixXd errors;      ///< of these
};

NullDirections by_free_numbers(const NullSpace& nulls) {
  NullDirections out;
  const Index d = nulls.dimension();
  out.directions = nulls.basis;
  out.errors = MatrixXd::Zero(nulls.basis.rows(), d);
  if (d == 0) return out;
  const std::vector<int> order =
      solvers::pivot_order<double>(nulls.basis.transpose(), solvers::known_to::rounding).columns;
  MatrixXd own(d, d);
  for (Index k = 0; k < d; ++k) {
    out.free.push_back(order[static_cast<std::size_t>(k)]);
    own.row(k) = nulls.basis.row(out.free.back());
  }
  const MatrixXd inverse = solvers::FullyPivotedLu(own).solve(MatrixXd(MatrixXd::Identity(d, d)));
  out.directions = nulls.basis * inverse;
  // Errors of the rows, of the free ones' too, become errors of the parts.
  VectorXd of_free(d);
  for (Index k = 0; k < d; ++k) of_free[k] = nulls.error[out.free[static_cast<std::size_t>(k)]];
  for (Index i = 0; i < out.directions.rows(); ++i) {
    const double error = nulls.error[i] + out.directions.row(i).cwiseAbs() * of_free;
    for (Index k = 0; k < d; ++k) {
      double& part = out.directions(i, k);
      out.errors(i, k) = error * inverse.col(k).norm();
      if (std::abs(part) <= out.errors(i, k)) part = 0.0;
    }
  }
  for (Index k = 0; k < d; ++k) {
    out.directions.row(out.free[static_cast<std::size_t>(k)]).setZero();
    out.errors.row(out.free[static_cast<std::size_t>(k)]).setZero();
    out.directions(out.free[static_cast<std::size_t>(k)], k) = 1.0;
  }
  return out;
}

/// The part of a null space in which number i does not move.
NullSpace without(const NullSpace& nulls, Index i) {
  NullSpace out = nulls;
  const double length = nulls.basis.row(i).norm();
  const VectorXd own = nulls.basis.row(i).transpose() / length;
  out.basis = nulls.basis * complement(own);
  out.error += (nulls.basis * own).cwiseAbs() * (nulls.error[i] / length);
  for (Index k = 0; k < out.basis.rows(); ++k) {
    if (k == i || out.basis.row(k).norm() <= out.error[k]) out.basis.row(k).setZero();
  }
  return out;
}

/// A direction of the parameters, relative to their scales, with bounds of its errors.
struct ScaledDirection {
  VectorXd part, error;
};

/// If one of the nulls multiplies all numbers of forces and inertias by one factor: the changes of these. What is left
/// of the nulls then is the part in which one of these numbers does not move, the one that leaves most others unmoved.
std::optional<ScaledDirection> take_out_scale(const FitProblem& problem, const std::vector<double>& parameters,
                                              const VectorXd& scale, NullSpace& nulls) {
  VectorXd factor = VectorXd::Zero(scale.size());
  for (Index i = 0; i < scale.size(); ++i) {
    if (problem.scales_with_force(static_cast<int>(i))) factor[i] = parameters[static_cast<std::size_t>(i)] / scale[i];
  }
  const NullDirections all = by_free_numbers(nulls);
  VectorXd left = factor;
  VectorXd error = VectorXd::Zero(scale.size());
  for (std::size_t k = 0; k < all.free.size(); ++k) {
    left -= factor[all.free[k]] * all.directions.col(static_cast<Index>(k));
    error += std::abs(factor[all.free[k]]) * all.errors.col(static_cast<Index>(k));
  }
  if (factor.isZero(0.0) || left.norm() > 1e-6 * factor.norm()) return std::nullopt;
  std::optional<NullSpace> rest;
  Index fewest = 0;
  for (Index i = 0; i < scale.size(); ++i) {
    if (factor[i] == 0 || !nulls.touches(i)) continue;
    NullSpace one = without(nulls, i);
    Index moved = 0;
    for (Index k = 0; k < scale.size(); ++k) moved += one.touches(k) ? 1 : 0;
    if (rest && moved >= fewest) continue;
    fewest = moved;
    rest = std::move(one);
  }
  if (!rest) return std::nullopt;
  nulls = std::move(*rest);
  return ScaledDirection{factor, error};
}

class Assessment {
 public:
  Assessment(const FitProblem& problem, const std::vector<double>& parameters)
      : problem_(problem), parameters_(parameters), n_(static_cast<Index>(parameters.size())), scale_(n_) {
    for (Index i = 0; i < n_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const FitProblem::Scale scale = problem.scale_of(at, parameters[at] + problem.unknown_of(at).includes);
      known_scale_.push_back(scale.size > 0);
      own_size_.push_back(scale.is_own_size);
      scale_[i] = scale.size_or(problem.unknown_of(at).unit);
    }
  }

  Identifiability run(const std::vector<std::vector<double>>& nuisances, const std::vector<MatrixXd>& triangles,
                      const Weighting& weighting) {
    A_ = whole_triangle(problem_, triangles, scale_);
    NullSpace structural = structural_nulls(problem_, parameters_, nuisances);
    // With controllers numbers that change nothing at all are nulls by themselves, however well the others are known.
    const bool is_controlled = !controllers_of(problem_.experiment().scene).empty();
    for (Index i = 0; is_controlled && i < n_; ++i) {
      if (A_.col(i).cwiseAbs().maxCoeff() != 0.0) continue;
      structural.basis.conservativeResize(n_, structural.basis.cols() + 1);
      structural.basis.rightCols(1) = VectorXd::Unit(n_, i);
    }
    structural.basis = scale_.cwiseInverse().asDiagonal() * structural.basis;
    structural.error = scale_.cwiseInverse().asDiagonal() * structural.error;
    const bool scales_known = std::find(known_scale_.begin(), known_scale_.end(), false) == known_scale_.end();
    const NullSpace other =
        other_nulls(problem_, parameters_, nuisances, scale_, scales_known, structural, weighting, A_);
    NullSpace all = structural;
    all.basis.conservativeResize(n_, structural.dimension() + other.dimension());
    all.basis.rightCols(other.dimension()) = other.basis;
    all.error = structural.error.cwiseMax(other.error);
    out_.unclear = structural.unclear + other.unclear;
    out_.structural_nulls = static_cast<int>(structural.dimension()) - structural.unclear;
    out_.other_nulls = static_cast<int>(other.dimension()) - other.unclear;
    out_.rank = static_cast<int>(n_) - out_.structural_nulls - out_.other_nulls;
    for (const NullSpace* nulls : std::initializer_list<const NullSpace*>{&structural, &other}) {
      if (nulls->dimension() > 0 && nulls->unclear == 0 && (out_.gap == 0 || nulls->gap < out_.gap))
        out_.gap = nulls->gap;
    }
    const VectorXd s = solvers::singular_value_decomposition(A_ * complement(structural.basis)).values;
    out_.singular_values.assign(s.data(), s.data() + s.size());
    out_.singular_values.resize(static_cast<std::size_t>(n_), 0.0);
    find_errors(all);
    add_nulls(structural, true);
    add_nulls(other, false);
    add_combinations(all);
    add_weak_directions();
    out_.ok = true;
    return std::move(out_);
  }

 private:
  /// Errors and correlations on the complement of the nulls.
  void find_errors(const NullSpace& all) {
    const MatrixXd rest = complement(all.basis);
    const solvers::SingularValues svd = solvers::singular_value_decomposition(A_ * rest);
    singular_ = svd.values;
    directions_ = rest * svd.right;
    weighted_ = directions_ * singular_.cwiseInverse().asDiagonal();
    const MatrixXd covariance = weighted_ * weighted_.transpose();
    out_.covariance = scale_.asDiagonal() * covariance * scale_.asDiagonal();
    const auto count = static_cast<std::size_t>(n_);
    out_.correlation.assign(count, std::vector<std::optional<double>>(count));
    for (Index i = 0; i < n_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const bool free = all.touches(i);
      const double error = free ? infinity : std::sqrt(covariance(i, i));
      out_.standard_error.push_back(scale_[i] * error);
      const bool large = known_scale_[at] && error > 1.0 / identifiable_from;
      out_.identifiable.push_back(!free && !(large && own_size_[at]));
      out_.poorly_determined.push_back(out_.identifiable[at] && large);
      for (Index j = 0; j < n_ && !free; ++j) {
        if (all.touches(j)) continue;
        out_.correlation[at][static_cast<std::size_t>(j)] =
            covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
      }
    }
  }

  void add_nulls(NullSpace nulls, bool structural) {
    Identifiability::Direction direction;
    direction.exact = nulls.unclear == 0;
    direction.structural = structural;
    if (const std::optional<ScaledDirection> factor = take_out_scale(problem_, parameters_, scale_, nulls)) {
      Identifiability::Direction common = direction;
      common.scale = true;
      add(common, factor->part, factor->error);
    }
    const NullDirections found = by_free_numbers(nulls);
    for (Index k = 0; k < found.directions.cols(); ++k) {
      Identifiability::Direction one = direction;
      add(one, found.directions.col(k), found.errors.col(k));
    }
  }

  /// Of every parameter with too large an error the direction that contributes most to it.
  void add_weak_directions() {
    std::vector<bool> weak(static_cast<std::size_t>(singular_.size()), false);
    for (Index i = 0; i < n_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (std::isinf(out_.standard_error[at]) || (out_.identifiable[at] && !out_.poorly_determined[at])) continue;
      Index largest = 0;
      weighted_.row(i).cwiseAbs().maxCoeff(&largest);
      weak[static_cast<std::size_t>(largest)] = true;
    }
    for (Index k = 0; k < singular_.size(); ++k) {
      if (!weak[static_cast<std::size_t>(k)]) continue;
      Identifiability::Direction direction;
      direction.singular_value = singular_[k];
      add(direction, directions_.col(k));
    }
  }

  /// `errors` of a null; of another direction none.
  void add(Identifiability::Direction& direction, const VectorXd& parts, const VectorXd& errors = {}) {
    Index largest = 0;
    parts.cwiseAbs().maxCoeff(&largest);
    for (Index i = 0; i < n_; ++i) direction.part.push_back(parts[i] / parts[largest]);
    for (Index i = 0; i < errors.size(); ++i) direction.error.push_back(errors[i] / std::abs(parts[largest]));
    explain(problem_, parameters_, scale_, direction);
    out_.null_directions.push_back(std::move(direction));
  }

  // c = e_i - sum of the parts of i in the nulls' directions, so that c^T N = 0.
  void add_combinations(const NullSpace& all) {
    const NullDirections nulls = by_free_numbers(all);
    const std::vector<bool> straight = straight_numbers(nulls);
    for (Index i = 0; i < n_; ++i) {
      if (!all.touches(i) || std::find(nulls.free.begin(), nulls.free.end(), i) != nulls.free.end()) continue;
      if (!straight[static_cast<std::size_t>(i)]) continue;
      VectorXd c = VectorXd::Zero(n_);
      c[i] = 1.0;
      for (std::size_t k = 0; k < nulls.free.size(); ++k) {
        c[nulls.free[k]] = -nulls.directions(i, static_cast<Index>(k));
      }
      out_.combinations.push_back(combination(i, c));
    }
  }

  /// Which numbers keep their part in the nulls along them. Those that forces, moments and inertias are proportional to
  /// do, and those that readings or times shift by; the nulls of lengths curve, and take the numbers beside them along.
  std::vector<bool> straight_numbers(const NullDirections& nulls) const {
    std::vector<bool> out;
    for (Index i = 0; i < n_; ++i) out.push_back(problem_.scales_with_force(static_cast<int>(i)) || is_shift(i));
    std::vector<bool> curved(nulls.free.size(), false);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t k = 0; k < nulls.free.size(); ++k) {
        for (Index i = 0; i < n_; ++i) {
          if (nulls.directions(i, static_cast<Index>(k)) == 0) continue;
          const auto at = static_cast<std::size_t>(i);
          if (curved[k] == !out[at]) continue;
          curved[k] = true;
          out[at] = false;
          changed = true;
        }
      }
    }
    return out;
  }

  bool is_shift(Index i) const {
    const Unknown& unknown = problem_.unknown_of(static_cast<std::size_t>(i));
    return unknown.of_sensor && unknown.of_sensor->of != SensorNumber::Of::factor;
  }

  Identifiability::Combination combination(Index of, const VectorXd& c) const {
    Identifiability::Combination out;
    out.unit_of = static_cast<int>(of);
    out.standard_error = scale_[of] * (weighted_.transpose() * c).norm();
    bool all_shift = true;  // a null adds to them
    double largest = 0.0;
    double sum = 0.0;
    Index divisor = -1;
    bool plain = true;
    std::vector<double> shown;
    for (Index i = 0; i < n_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Unknown& unknown = problem_.unknown_of(at);
      const double by_si = c[i] * scale_[of] / scale_[i];
      out.coefficient.push_back(by_si);
      shown.push_back(parameters_[at] + unknown.includes);
      if (c[i] == 0) continue;
      all_shift = all_shift && is_shift(i);
      plain = plain && unknown.includes == 0;
      const double term = by_si * parameters_[at];
      sum += term;
      if (i == of || std::abs(term) <= largest) continue;
      divisor = i;
      largest = std::abs(term);
    }
    if (divisor >= 0 && plain && !all_shift && std::abs(sum) <= 1e-6 * largest) {
      const auto at = static_cast<std::size_t>(divisor);
      out.over = static_cast<int>(divisor);
      out.standard_error /= std::abs(parameters_[at]);
      out.coefficient[at] = 0.0;
    }
    out.value = out.at(shown);
    out.words = in_words(problem_, out);
    return out;
  }

  const FitProblem& problem_;
  const std::vector<double>& parameters_;
  Index n_;
  VectorXd scale_;
  std::vector<bool> known_scale_, own_size_;
  MatrixXd A_;  // columns in scales
  VectorXd singular_;
  MatrixXd directions_, weighted_;  // right singular vectors; the same over the singular values
  Identifiability out_;
};

}  // namespace

double Identifiability::Combination::at(const std::vector<double>& shown) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < coefficient.size(); ++i) sum += coefficient[i] * shown[i];
  return over < 0 ? sum : sum / shown[static_cast<std::size_t>(over)];
}

Eigen::VectorXd Identifiability::Combination::gradient(const std::vector<double>& shown) const {
  VectorXd out = Eigen::Map<const VectorXd>(coefficient.data(), static_cast<Index>(coefficient.size()));
  if (over < 0) return out;
  out[over] = -at(shown);
  return out / shown[static_cast<std::size_t>(over)];
}

Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances) {
  Weighting weighting = problem.weighting();
  weighting.inputs = problem.input_errors(parameters, nuisances, 0);
  return assess(problem, parameters, nuisances, triangles_of(problem, parameters, nuisances, weighting, 1e-8),
                weighting);
}

Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances, const std::vector<MatrixXd>& triangles,
                       const Weighting& weighting) {
  Identifiability out;
  if (parameters.empty()) {
    out.why = "the experiment has no unknowns";
    return out;
  }
  const auto fails = [](const MatrixXd& triangle) { return triangle.size() == 0; };
  if (std::any_of(triangles.begin(), triangles.end(), fails)) {
    out.why = problem.why_no_motion(parameters, nuisances);
    if (out.why.empty()) out.why = "some derivatives of a motion are no finite numbers";
    return out;
  }
  return Assessment(problem, parameters).run(nuisances, triangles, weighting);
}

}  // namespace poise
