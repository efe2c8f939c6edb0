#include "identification/identifiability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// Sensitivities are accurate to about 1e-8 of the largest; smaller singular values below a gap count as zero.
constexpr double zero_below = 1e-7;
constexpr double least_gap = 1e-3;
/// Parts of a direction below this, relative to its largest, are neglected.
constexpr double smallest_part = 0.03;

std::string in_words(const FitProblem& problem, const Identifiability::Direction& direction) {
  std::string words;
  for (std::size_t i = 0; i < direction.part.size(); ++i) {
    if (std::abs(direction.part[i]) < smallest_part) continue;
    words +=
        fmt::format("{}{} {:+.0f} %", words.empty() ? "" : ", ", problem.parameters()[i].name, 100 * direction.part[i]);
  }
  return words;
}

void explain(const FitProblem& problem, Identifiability::Direction& direction) {
  int alike = 0;
  int parts = 0;
  bool all_scale = true;
  bool inertial = false;
  for (std::size_t i = 0; i < direction.part.size(); ++i) {
    if (std::abs(direction.part[i]) < smallest_part) continue;
    ++parts;
    alike += direction.part[i] > 0 ? 1 : -1;
    const SceneParameter& number = problem.number(static_cast<int>(i));
    all_scale = all_scale && number.scales_with_force();
    inertial = inertial || number.is_inertial();
  }
  direction.scale = parts > 1 && std::abs(alike) == parts && all_scale && inertial;
  const std::string changes = in_words(problem, direction);
  if (direction.scale) {
    direction.words = "the overall scale of masses, inertias, stiffnesses and damping: " + changes + " together ";
    direction.remedy = "add a run with a known payload, weigh one of them, or give one a prior";
  } else if (parts == 1) {
    direction.words = changes + " ";
    direction.remedy = "add a run or a sensor in which it matters, or give it a prior";
  } else {
    direction.words = changes + " together ";
    direction.remedy = "fix one of them, give one a prior, or add runs from other poses or with another payload";
  }
  direction.words += direction.exact
                         ? "change no reading"
                         : fmt::format("change all readings by only {:.2g} standard deviations of the noise",
                                       direction.singular_value);
}

}  // namespace

Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances) {
  std::vector<Eigen::MatrixXd> triangles;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    triangles.push_back(problem.triangle(r, parameters, nuisances[r], nullptr, INFINITY,
                                         std::min(1e-8, problem.accuracy(r)), problem.weighting()));
  }
  return assess(problem, parameters, triangles);
}

Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<Eigen::MatrixXd>& triangles) {
  Identifiability out;
  const auto count = static_cast<Eigen::Index>(problem.parameters().size());
  if (count == 0) {
    out.why = "the experiment has no unknowns";
    return out;
  }
  Eigen::Index rows = count;
  for (std::size_t r = 0; r < problem.runs(); ++r) rows += problem.run(r).unknowns();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, count);
  std::vector<double> scale;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(i)];
    const Unknown& unknown = problem.unknown_of(static_cast<std::size_t>(i));
    const double shown = parameters[static_cast<std::size_t>(i)] + unknown.includes;
    scale.push_back(shown != 0 ? std::abs(shown) : p.scale);
    if (unknown.prior) A(i, i) = scale.back() / unknown.prior_deviation;
  }
  Eigen::Index row = count;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    if (triangles[r].size() == 0) {
      out.why = fmt::format("the motion of run \"{}\" could not be computed", problem.run(r).run().name);
      return out;
    }
    const Eigen::Index nuisances = problem.run(r).nuisances();
    const Eigen::Index unknowns = problem.run(r).unknowns();
    for (Eigen::Index c = 0; c < unknowns; ++c) {
      const int p = problem.parameters_of(r)[static_cast<std::size_t>(c)];
      A.block(row, p, unknowns, 1) =
          scale[static_cast<std::size_t>(p)] * triangles[r].block(nuisances, nuisances + c, unknowns, 1);
    }
    row += unknowns;
  }
  const solvers::SingularValues svd = solvers::singular_value_decomposition(A);
  const Eigen::VectorXd& s = svd.values;
  out.singular_values.assign(s.data(), s.data() + s.size());
  out.rank = static_cast<int>(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const bool is_zero = s[i] == 0 || (s[i] < zero_below * s[0] && (i == 0 || s[i] < least_gap * s[i - 1]));
    if (!is_zero) continue;
    out.rank = static_cast<int>(i);
    out.gap = i > 0 && s[i] > 0 ? s[i - 1] / s[i] : std::numeric_limits<double>::infinity();
    break;
  }
  out.identifiable.assign(static_cast<std::size_t>(count), true);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  std::vector<bool> infinite(static_cast<std::size_t>(count), false);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd v = svd.right.col(k);
    const bool exact = k >= out.rank;
    if (!exact) covariance += v * v.transpose() / (s[k] * s[k]);
    if (!exact && s[k] >= identifiable_from) continue;
    Identifiability::Direction direction;
    direction.singular_value = s[k];
    direction.exact = exact;
    Eigen::Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    for (Eigen::Index i = 0; i < count; ++i) {
      direction.part.push_back(v[i] / v[largest]);
      if (std::abs(direction.part.back()) < smallest_part) continue;
      if (exact) infinite[static_cast<std::size_t>(i)] = true;
      // Of a weak direction only the parameters that it makes uncertain are withheld.
      if (exact || std::abs(v[i]) / s[k] > 1.0 / identifiable_from)
        out.identifiable[static_cast<std::size_t>(i)] = false;
    }
    explain(problem, direction);
    out.null_directions.push_back(std::move(direction));
  }
  const Eigen::Map<const Eigen::VectorXd> scales(scale.data(), count);
  out.covariance = scales.asDiagonal() * covariance * scales.asDiagonal();
  out.correlation.assign(infinite.size(), std::vector<std::optional<double>>(infinite.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    out.standard_error.push_back(infinite[at] ? std::numeric_limits<double>::infinity()
                                              : scale[at] * std::sqrt(covariance(i, i)));
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto other = static_cast<std::size_t>(j);
      if (infinite[at] || infinite[other]) continue;
      out.correlation[at][other] = covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
    }
  }
  out.ok = true;
  return out;
}

}  // namespace poise
