#include "identification/fit/standard_errors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "identification/fit/private/robust_scale.hpp"
#include "solvers/autoregression.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

constexpr int most_coefficients = 40;
/// Iterations between the autocorrelation and what the fit takes of readings with it; they end where that changes by
/// less than this part of the readings.
constexpr int most_refits = 20;
constexpr double settled_within = 1e-2;
/// Independent residuals per run that a model of their correlation needs.
constexpr double enough_residuals = 20.0;
/// By how much the median size of normal noise scatters more than its root mean square: sqrt(2) / (4 m f(m)), m its
/// median and f the density of normal noise.
constexpr double median_deviation = 1.6494;
/// Readings are evenly spaced where a step is within this part of the shortest.
constexpr double uneven = 0.01;
/// What is left of a sum of residuals below this part of its variance is the error at which a fit ends.
constexpr double unseen = 0.01;
/// A run that alone determines a combination of the parameters cannot show how much that scatters.
constexpr double alone = 1e-6;

/// Half the width of a 95 % interval, in standard errors.
double reach_of(double degrees) {
  if (!(degrees >= 1.0)) return boost::math::quantile(boost::math::students_t(1.0), 0.975);
  return boost::math::quantile(boost::math::students_t(std::min(degrees, 1e6)), 0.975);
}

/// [first, last) of the readings that follow each other in even steps.
std::vector<std::pair<std::size_t, std::size_t>> even_pieces(const std::vector<double>& time) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  double step = INFINITY;
  for (std::size_t i = 1; i < time.size(); ++i) step = std::min(step, time[i] - time[i - 1]);
  std::size_t first = 0;
  for (std::size_t i = 1; i <= time.size(); ++i) {
    if (i < time.size() && time[i] - time[i - 1] <= (1 + uneven) * step) continue;
    out.emplace_back(first, i);
    first = i;
  }
  return out;
}

/// Of the readings of sensor k in a run, within which noise may be correlated: those at rest are independent.
std::vector<std::pair<std::size_t, std::size_t>> pieces_of(const RunModel& run, std::size_t k) {
  const std::vector<double>& times = run.times()[k];
  if (!run.is_at_rest()) return even_pieces(times);
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t i = 0; i < times.size(); ++i) out.emplace_back(i, i + 1);
  return out;
}

class Analysis {
 public:
  Analysis(const FitProblem& problem, const Eigen::MatrixXd& covariance, const std::vector<LinearRun>& runs,
           const Weighting& weighting)
      : problem_(problem), V_(covariance), weighting_(weighting), sensors_(weighting.noise.size()) {
    for (std::size_t r = 0; r < runs.size(); ++r) eliminate_nuisances(r, runs[r]);
  }

  StandardErrors run() {
    find_correlations();
    test_noise();
    add_independent();
    add_clustered();
    lead();
    correlate_leading();
    compare_runs();
    return std::move(out_);
  }

 private:
  struct Scores {
    Eigen::MatrixXd a;                    // readings x all parameters of the run
    Eigen::VectorXd e;                    // residuals
    Eigen::VectorXd u;                    // the same; of a robust loss psi(e) over the mean slope of psi
    std::vector<Eigen::Index> first;      // as of LinearRun
    Eigen::MatrixXd nuisances;            // orthonormal basis of what the run's own values explain
    std::vector<Eigen::MatrixXd> series;  // per sensor: A_r^T R A_r of its readings, R their autocorrelation
    std::vector<double> leverage;         // per sensor: tr H R of its readings
    std::vector<double> sum_error;        // per sensor: standard deviation of sum e at unit noise
  };

  void eliminate_nuisances(std::size_t r, const LinearRun& run) {
    const Eigen::Index nuisances = problem_.run(r).nuisances();
    const Eigen::Index unknowns = problem_.run(r).unknowns();
    const Eigen::Index last = run.rows.cols() - 1;
    Scores scores;
    scores.first = run.first;
    scores.a = run.rows.middleCols(nuisances, unknowns);
    scores.e = scores.u = run.rows.col(last);
    Eigen::MatrixXd& basis = scores.nuisances;
    if (nuisances > 0) {
      basis = solvers::orthonormal_columns(run.rows.leftCols(nuisances));
      scores.a -= basis * (basis.transpose() * scores.a);
    }
    if (weighting_.loss != Loss::squares) {
      double slope = 0.0;
      for (double& e : scores.u) {
        slope += weighting_.psi_slope(e * e) / static_cast<double>(scores.u.size());
        e *= weighting_.weight(e * e);
      }
      scores.u /= std::max(slope, 0.05);
    }
    if (nuisances > 0) scores.u -= basis * (basis.transpose() * scores.u);
    runs_.push_back(std::move(scores));
  }

  // The part of V that belongs to the parameters of run r.
  Eigen::MatrixXd own(std::size_t r) const {
    const std::vector<int>& used = problem_.parameters_of(r);
    return V_(used, used);
  }

  // Columns b of sensor k in run r:  sum b b^T = H, what the fit takes of its readings.
  Eigen::MatrixXd taken(std::size_t r, std::size_t k) const {
    const Scores& run = runs_[r];
    const Eigen::Index count = run.first[k + 1] - run.first[k];
    const Eigen::MatrixXd V = own(r);
    const Eigen::VectorXd error = V.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Eigen::VectorXd scale = error.unaryExpr([](double x) { return x > 0 ? 1 / x : 0.0; });
    const solvers::SymmetricEigen scaled = solvers::symmetric_eigen(scale.asDiagonal() * V * scale.asDiagonal());
    const Eigen::MatrixXd root =
        error.asDiagonal() * scaled.vectors * scaled.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
    Eigen::MatrixXd out(count, run.nuisances.cols() + root.cols());
    out.rightCols(root.cols()) = run.a.middleRows(run.first[k], count) * root;
    if (run.nuisances.size() > 0) out.leftCols(run.nuisances.cols()) = run.nuisances.middleRows(run.first[k], count);
    return out;
  }

  // Residuals lack what the fit takes: (1 - H) R (1 - H) in place of R, which alone correlates neighbours by about -p /
  // n where p smooth columns are fitted to n white readings, and takes most of them where R is large for these columns.
  // Added to the residuals' products, at their size, are  b b^T (b^T R b) / (b^T b): 1 - (1 - H)^2 for white readings,
  // in general to the accuracy to which R b is b (b^T R b) / (b^T b), with R itself by iteration.
  void find_correlations() {
    for (std::size_t k = 0; k < sensors_; ++k) {
      std::vector<std::vector<double>> pieces;
      std::vector<Eigen::MatrixXd> columns;  // per piece
      double readings = 0.0;
      double squares = 0.0;
      double in_motion = 0.0, pieces_in_motion = 0.0;
      for (std::size_t r = 0; r < runs_.size(); ++r) {
        const Scores& run = runs_[r];
        const Eigen::MatrixXd b = taken(r, k);
        for (const auto& [first, last] : pieces_of(problem_.run(r), k)) {
          const double* const u = run.u.data() + run.first[k];
          pieces.emplace_back(u + first, u + last);
          const auto at = static_cast<Eigen::Index>(first);
          columns.emplace_back(b.middleRows(at, static_cast<Eigen::Index>(last) - at));
          readings += static_cast<double>(last - first);
          if (problem_.run(r).is_at_rest()) continue;
          in_motion += static_cast<double>(last - first);
          pieces_in_motion += 1.0;
        }
        squares += run.u.segment(run.first[k], run.first[k + 1] - run.first[k]).squaredNorm();
      }
      series_.push_back(corrected(pieces, columns, readings, squares));
      spread_.push_back(series_.back().spread());
      even_ = even_ && (pieces_in_motion == 0.0 || in_motion > 8 * pieces_in_motion);
    }
  }

  static solvers::Autoregression corrected(const std::vector<std::vector<double>>& pieces,
                                           const std::vector<Eigen::MatrixXd>& columns, double readings,
                                           double squares) {
    solvers::Autoregression series = solvers::fit_autoregression(pieces, most_coefficients);
    std::vector<solvers::TakenColumns> taken(columns.size());
    for (std::size_t p = 0; p < columns.size(); ++p) {
      taken[p].products = solvers::lag_products(columns[p], most_coefficients);
    }
    double before = INFINITY;
    for (int iteration = 0; iteration < most_refits; ++iteration) {
      double leverage = 0.0;
      for (std::size_t p = 0; p < columns.size(); ++p) {
        const Eigen::VectorXd own = taken[p].products.lagged.row(0);
        taken[p].weight = series.weighted_square(columns[p]).diagonal();
        taken[p].weight = (own.array() > 0).select(taken[p].weight.array() / own.array(), 0.0);
        leverage += taken[p].weight.dot(own);
      }
      if (!(readings > leverage) || std::abs(leverage - before) < settled_within * readings) break;
      before = leverage;
      for (solvers::TakenColumns& of_piece : taken) of_piece.weight *= squares / (readings - leverage);
      series = solvers::fit_autoregression(pieces, most_coefficients, taken);
      if (series.is_white()) break;
    }
    return series;
  }

  // A_r^T R A_r and tr H R of sensor k in run r, and the standard deviation of its sum of residuals, M = 1 - H:
  // sqrt(1^T M R M 1), at least that of white ones: few readings seem to be correlated by chance. Infinite where the
  // estimates, an unknown zero say, take the sum.
  void find_leverage(std::size_t r, std::size_t k) {
    Scores& run = runs_[r];
    const Eigen::MatrixXd V = own(r);
    const Eigen::Index count = run.first[k + 1] - run.first[k];
    const auto a = run.a.middleRows(run.first[k], count);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(count);
    Eigen::VectorXd left = ones - a * (V * (a.transpose() * ones));
    if (run.nuisances.size() > 0) {
      const auto basis = run.nuisances.middleRows(run.first[k], count);
      left -= basis * (basis.transpose() * ones);
    }
    const Eigen::Index nuisances = run.nuisances.cols();
    Eigen::MatrixXd all(count, nuisances + a.cols() + 1);
    if (nuisances > 0) all.leftCols(nuisances) = run.nuisances.middleRows(run.first[k], count);
    all.middleCols(nuisances, a.cols()) = a;
    all.rightCols(1) = left;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(all.cols(), all.cols());
    for (const auto& [first, last] : pieces_of(problem_.run(r), k)) {
      sum += series_[k].weighted_square(
          all.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last - first)));
    }
    Eigen::MatrixXd series = sum.block(nuisances, nuisances, a.cols(), a.cols());
    const double leverage = sum.topLeftCorner(nuisances, nuisances).trace();
    const double square = sum.bottomRightCorner(1, 1).value();
    run.leverage.push_back(leverage + V.cwiseProduct(series).sum());
    run.series.push_back(std::move(series));
    // 1^T M M 1 = 1^T M 1: what is not of these readings comes from all others.
    const double others = left.sum() - left.squaredNorm();
    const bool is_seen = left.sum() > unseen * static_cast<double>(count);
    run.sum_error.push_back(is_seen ? std::sqrt(std::max(square, left.squaredNorm()) + others) : INFINITY);
  }

  void test_noise() {
    out_.runs_noise.assign(runs_.size(), {});
    for (std::size_t k = 0; k < sensors_; ++k) {
      Eigen::VectorXd all;
      double squares = 0.0;
      double leverage = 0.0;
      for (std::size_t r = 0; r < runs_.size(); ++r) {
        find_leverage(r, k);
        const Scores& run = runs_[r];
        const Eigen::Index count = run.first[k + 1] - run.first[k];
        const Eigen::VectorXd e = run.e.segment(run.first[k], count);
        out_.runs_noise[r].push_back(test(e, run.leverage[k], k));
        all.conservativeResize(all.size() + count);
        all.tail(count) = e;
        squares += run.u.segment(run.first[k], count).squaredNorm();
        leverage += run.leverage[k];
      }
      out_.sensors.push_back(test(all, leverage, k));
      const double left = static_cast<double>(all.size()) - leverage;
      size_.push_back(left > 0 ? std::sqrt(squares / left) : 1.0);
      for (std::size_t r = 0; r < runs_.size(); ++r) {
        const Scores& run = runs_[r];
        const double sum = run.u.segment(run.first[k], run.first[k + 1] - run.first[k]).sum();
        out_.runs_noise[r][k].offset = sum / (size_[k] * run.sum_error[k]);
      }
    }
  }

  // In least squares the root mean square; of a robust fit the median size, which outliers leave as it is.
  NoiseTest test(const Eigen::VectorXd& e, double leverage, std::size_t k) const {
    const auto readings = static_cast<double>(e.size());
    if (!(readings > leverage)) return {not_a_number, not_a_number, not_a_number, not_a_number};
    const double correction = std::sqrt(readings / (readings - leverage));
    const double degrees = (readings - leverage) / spread_[k];
    const bool squares = weighting_.loss == Loss::squares;
    const double size = squares ? e.norm() / std::sqrt(readings) : robust_scale({e.begin(), e.end()});
    return {correction * size, squares ? degrees : degrees / (median_deviation * median_deviation), 0.0, size};
  }

  // The mean square of sensor k's residuals that errors are computed with: at least that of the noise where it is
  // stated.
  double excess(std::size_t k, double mean_square) const {
    const bool stated = problem_.experiment().sensors[k].noise_known && weighting_.loss == Loss::squares;
    return stated ? std::max(1.0, mean_square) : mean_square;
  }

  void add_independent() {
    const Eigen::Index count = V_.rows();
    Eigen::MatrixXd white = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Unknown& unknown = problem_.unknown_of(static_cast<std::size_t>(i));
      if (unknown.prior) white(i, i) = 1.0 / (unknown.prior_deviation * unknown.prior_deviation);
    }
    Eigen::MatrixXd serial = white;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Scores& run = runs_[r];
      const std::vector<int>& used = problem_.parameters_of(r);
      for (std::size_t k = 0; k < sensors_; ++k) {
        const double size = excess(k, size_[k] * size_[k]);
        const auto rows = run.a.middleRows(run.first[k], run.first[k + 1] - run.first[k]);
        white(used, used) += size * rows.transpose() * rows;
        serial(used, used) += size * run.series[k];
      }
    }
    white_ = V_ * white * V_;
    serial_ = V_ * serial * V_;
    out_.white = errors_of(white_);
    out_.serial = errors_of(serial_);
  }

  static std::vector<double> errors_of(const Eigen::MatrixXd& covariance) {
    std::vector<double> out;
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) out.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
    return out;
  }

  // All that matters of a run are its rows' triangle R and Q^T u.
  void add_clustered() {
    const Eigen::Index count = V_.rows();
    const std::size_t runs = runs_.size();
    std::vector<Eigen::MatrixXd> weight(runs), root(runs);          // M_r R_r V, with M = (1 - R V R^T)^(-1/2), and R_r
    Eigen::MatrixXd moved(count, static_cast<Eigen::Index>(runs));  // V R^T M Q^T u of every run
    std::vector<bool> lone(static_cast<std::size_t>(count), false);
    for (std::size_t r = 0; r < runs; ++r) {
      const std::vector<int>& used = problem_.parameters_of(r);
      const auto own_count = static_cast<Eigen::Index>(used.size());
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::max(runs_[r].a.rows(), own_count + 1), own_count + 1);
      rows.topRows(runs_[r].a.rows()) << runs_[r].a, runs_[r].u;
      const Eigen::MatrixXd triangle = solvers::triangular_factor(rows);
      const Eigen::MatrixXd R = triangle.topLeftCorner(own_count, own_count);
      const Eigen::VectorXd q = triangle.col(own_count).head(own_count);
      root[r] = Eigen::MatrixXd::Zero(own_count, count);
      root[r](Eigen::all, used) = R;
      const Eigen::MatrixXd reduced = root[r] * V_;
      const solvers::SymmetricEigen left =
          solvers::symmetric_eigen(Eigen::MatrixXd::Identity(own_count, own_count) - R * own(r) * R.transpose());
      Eigen::VectorXd inverse_root(own_count);
      for (Eigen::Index i = 0; i < own_count; ++i) {
        const bool is_alone = left.values[i] < alone;
        inverse_root[i] = is_alone ? 0.0 : 1.0 / std::sqrt(left.values[i]);
        if (!is_alone) continue;
        const Eigen::VectorXd on = reduced.transpose() * left.vectors.col(i);
        for (Eigen::Index p = 0; p < count; ++p) {
          if (std::abs(on[p]) > 1e-3 * std::sqrt(V_(p, p))) lone[static_cast<std::size_t>(p)] = true;
        }
      }
      weight[r] = left.vectors * inverse_root.asDiagonal() * left.vectors.transpose() * reduced;
      moved.col(static_cast<Eigen::Index>(r)) = weight[r].transpose() * q;
      // Without the run:  V R^T (1 - R V R^T)^-1 q,  of the variance V R^T (1 - R V R^T)^-1 R V  if all runs agree.
      const Eigen::VectorXd change =
          weight[r].transpose() * (left.vectors * inverse_root.asDiagonal() * (left.vectors.transpose() * q));
      out_.without_run.emplace_back(change.begin(), change.end());
      const Eigen::VectorXd variance = weight[r].colwise().squaredNorm();
      own_change_.emplace_back(variance.begin(), variance.end());
    }
    for (Eigen::Index p = 0; p < count; ++p) {
      const bool none = lone[static_cast<std::size_t>(p)] || runs < 2;
      out_.runs.push_back(none ? not_a_number : moved.row(p).norm());
      out_.runs_degrees.push_back(none ? 0.0 : degrees(p, weight, root));
      for (std::vector<double>& change : out_.without_run) {
        if (none) change[static_cast<std::size_t>(p)] = not_a_number;
      }
    }
    out_.by_runs = std::move(moved);
  }

  void correlate_leading() {
    const bool white = out_.leading == StandardErrors::Kind::white;
    out_.covariance = out_.by_readings = white ? white_ : serial_;
    const std::vector<double>& errors = white ? out_.white : out_.serial;
    for (std::size_t p = 0; p < errors.size(); ++p) {
      const auto at = static_cast<Eigen::Index>(p);
      const double larger = errors[p] > 0 ? out_.error[p] / errors[p] : 0.0;
      out_.covariance.row(at) *= larger;
      out_.covariance.col(at) *= larger;
    }
  }

  // The changes over what they scatter by where runs agree, with errors as large as the leading ones.
  void compare_runs() {
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      double largest = 0.0;
      for (std::size_t p = 0; p < out_.error.size(); ++p) {
        const auto at = static_cast<Eigen::Index>(p);
        const double expected = std::sqrt(own_change_[r][p] / V_(at, at)) * out_.error[p];
        const double change = std::abs(out_.without_run[r][p]);
        if (expected > 0 && change > largest * expected) largest = change / expected;
      }
      out_.disagreement.push_back(largest);
    }
  }

  // Satterthwaite's (trace Omega)^2 / trace Omega^2 for  Omega_rs = l_r^T (delta_rs - R_r V R_s^T) l_s,  l_r = M_r R_r
  // V_p: of the variance estimate if the residuals were white.
  double degrees(Eigen::Index p, const std::vector<Eigen::MatrixXd>& weight,
                 const std::vector<Eigen::MatrixXd>& root) const {
    const auto runs = static_cast<Eigen::Index>(weight.size());
    Eigen::MatrixXd through(V_.rows(), runs);  // R_r^T l_r
    Eigen::VectorXd squares(runs);
    for (Eigen::Index r = 0; r < runs; ++r) {
      const auto at = static_cast<std::size_t>(r);
      const Eigen::VectorXd l = weight[at].col(p);
      squares[r] = l.squaredNorm();
      through.col(r) = root[at].transpose() * l;
    }
    const Eigen::MatrixXd omega = Eigen::MatrixXd(squares.asDiagonal()) - through.transpose() * V_ * through;
    const double trace = omega.trace();
    return trace > 0 ? trace * trace / omega.squaredNorm() : 0.0;
  }

  // Whether the scatter from run to run is larger, by any estimate, than chance makes of the other errors once in a
  // thousand fits: its square over theirs is chi squared over its degrees of freedom where the residuals are as
  // assumed.
  bool scatters_from_run_to_run(bool white) const {
    constexpr double chance = 1e-3;
    const std::vector<double>& errors = white ? out_.white : out_.serial;
    double least = 1.0;
    double tests = 0.0;
    for (std::size_t p = 0; p < errors.size(); ++p) {
      const double degrees = out_.runs_degrees[p];
      if (!(degrees >= 1.0) || !(errors[p] > 0) || !std::isfinite(out_.runs[p])) continue;
      const double ratio = std::pow(out_.runs[p] / errors[p], 2);
      const boost::math::chi_squared by_chance(degrees);
      least = std::min(least, boost::math::cdf(boost::math::complement(by_chance, degrees * ratio)));
      tests += 1.0;
    }
    return tests > 0 && least * tests < chance;
  }

  void lead() {
    using Kind = StandardErrors::Kind;
    const bool white = std::all_of(series_.begin(), series_.end(), [](const auto& s) { return s.is_white(); });
    double fewest = INFINITY;  // independent residuals in a series of one run
    for (const auto& run : runs_) {
      for (std::size_t k = 0; k < sensors_; ++k) {
        const Eigen::Index readings = run.first[k + 1] - run.first[k];
        if (readings > 0) fewest = std::min(fewest, static_cast<double>(readings) / spread_[k]);
      }
    }
    out_.independent = fewest;
    const std::string correlation =
        even_ ? fmt::format("correlated over so long that a run holds as much as {:.2g} independent ones", fewest)
              : "correlated, and not of even spacing";
    out_.runs_scatter = scatters_from_run_to_run(white);
    if (out_.runs_scatter) {
      out_.leading = Kind::runs;
      out_.why =
          "the runs differ by more than their residuals explain, as where the model is incomplete; the larger of "
          "series "
          "and runs is taken";
    } else if (white) {
      out_.leading = Kind::white;
      out_.why = "the residuals show no correlation from one reading to the next";
    } else if (fewest >= enough_residuals && even_) {
      out_.leading = Kind::serial;
      out_.why = fmt::format(
          "the residuals are correlated from one reading to the next; a run holds as much as {:.0f} independent ones",
          fewest);
    } else if (runs_.size() > 1) {
      out_.leading = Kind::runs;
      out_.why = "the residuals are " + correlation + "; the larger of series and runs is taken";
    } else {
      out_.leading = Kind::serial;
      out_.why = "the residuals are " + correlation + "; that is too few, and one run shows no more: add runs";
    }
    double& readings = out_.readings_degrees;
    for (const auto& run : runs_) {
      for (std::size_t k = 0; k < sensors_; ++k) {
        readings += (static_cast<double>(run.first[k + 1] - run.first[k]) - run.leverage[k]) / spread_[k];
      }
    }
    for (std::size_t p = 0; p < out_.white.size(); ++p) {
      const bool by_runs = out_.leading == Kind::runs && out_.runs[p] > out_.serial[p] && out_.runs_degrees[p] > 0;
      const bool by_both = out_.leading == Kind::runs && !std::isnan(out_.runs[p]);
      out_.error.push_back(out_.leading == Kind::white ? out_.white[p] : by_runs ? out_.runs[p] : out_.serial[p]);
      out_.reach.push_back(out_.error.back() * reach_of(by_both ? out_.runs_degrees[p] : readings));
    }
  }

  const FitProblem& problem_;
  const Eigen::MatrixXd& V_;
  const Weighting& weighting_;
  std::size_t sensors_;
  Eigen::MatrixXd white_, serial_;  // covariances
  std::vector<Scores> runs_;
  std::vector<solvers::Autoregression> series_;  // per sensor
  std::vector<double> spread_;                   // of these
  std::vector<std::vector<double>> own_change_;  // variances of without_run for noise of unit standard deviation
  std::vector<double> size_;                     // per sensor: root mean square of u
  bool even_ = true;
  StandardErrors out_;
};

}  // namespace

double NoiseTest::reach() const { return boost::math::quantile(boost::math::normal(), 0.975) / std::sqrt(2 * degrees); }

double NoiseTest::chance() const {
  if (std::isnan(ratio)) return 1.0;
  const boost::math::chi_squared by_chance(degrees);
  const double square = ratio * ratio * degrees;
  return 2 * std::min({0.5, cdf(by_chance, square), cdf(complement(by_chance, square))});
}

double StandardErrors::of(const Eigen::VectorXd& gradient) const {
  double square = gradient.dot(by_readings * gradient);
  bool by_both = leading == Kind::runs;
  for (std::size_t p = 0; p < runs.size(); ++p) {
    if (gradient[static_cast<Eigen::Index>(p)] != 0 && std::isnan(runs[p])) by_both = false;
  }
  if (by_both) square = std::max(square, (by_runs.transpose() * gradient).squaredNorm());
  return std::sqrt(std::max(0.0, square));
}

std::string to_string(StandardErrors::Kind kind) {
  switch (kind) {
    case StandardErrors::Kind::white:
      return "white";
    case StandardErrors::Kind::serial:
      return "serial";
    case StandardErrors::Kind::runs:
      return "runs";
  }
  return "";
}

StandardErrors standard_errors(const FitProblem& problem, const Eigen::MatrixXd& covariance,
                               const std::vector<LinearRun>& runs, const Weighting& weighting) {
  return Analysis(problem, covariance, runs, weighting).run();
}

}  // namespace poise
