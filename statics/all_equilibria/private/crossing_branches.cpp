#include "statics/all_equilibria/private/crossing_branches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/all_equilibria/private/interval_matrix.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/singular_configuration.hpp"

namespace poise {

namespace {

constexpr double lost_pivot = 1e-6;              // at the change point
constexpr int most_open = 4;                     // coordinates p
constexpr int most_cells_of_directions = 20000;  // for one range of distances
constexpr double least_cell = 1.0 / 512.0;
constexpr double least_ratio = 1.3;     // of distances that are looked at together
constexpr double more_than_core = 4.0;  // times its size, that a region reaches at least
// Sizes of boxes that are tried, and of core_sizes: what rounding leaves open of closures is small beyond these.
constexpr double box_sizes[] = {0.2, 0.05, 0.01, 1e-3, 1e-4, 1e-5};
constexpr double core_sizes[] = {2e-8, 5e-8, 1e-7, 1e-6, 1e-5, 1e-4};

// X with A X = B for all of both; false if A may be singular.
bool solve_enclosed(const IntervalMatrix& a, const IntervalMatrix& b, IntervalMatrix& x) {
  const std::size_t m = a.rows;
  Eigen::MatrixXd middle(m, m);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) middle(i, j) = a(i, j).middle();
  }
  IntervalMatrix inverse(m, m);
  if (m > 0) {
    const Eigen::MatrixXd near = middle.partialPivLu().inverse();
    if (!near.allFinite()) return false;
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < m; ++j) inverse(i, j) = Interval(near(i, j));
    }
  }
  IntervalMatrix left = product(inverse, a);
  x = product(inverse, b);
  for (std::size_t k = 0; k < m; ++k) {
    if (!left(k, k).excludes_zero()) return false;
    for (std::size_t i = k + 1; i < m; ++i) {
      const Interval factor = left(i, k) / left(k, k);
      for (std::size_t j = k + 1; j < m; ++j) left(i, j) -= factor * left(k, j);
      for (std::size_t j = 0; j < x.columns; ++j) x(i, j) -= factor * x(k, j);
    }
  }
  for (std::size_t k = m; k-- > 0;) {
    for (std::size_t j = 0; j < x.columns; ++j) {
      for (std::size_t i = k + 1; i < m; ++i) x(k, j) -= left(k, i) * x(i, j);
      x(k, j) = x(k, j) / left(k, k);
    }
  }
  return true;
}

}  // namespace

// The numbers of the expansion in a box around x*, by the coordinates p.
struct CrossingBranches::Expansion {
  std::vector<Interval> around{};
  IntervalMatrix follows{0, 0};                // Z and r, by coordinate
  std::vector<IntervalMatrix> bend{};          // K_k
  std::vector<std::vector<Interval>> slope{};  // g_k
  std::vector<Interval> open{};                // 2 l_k
  IntervalMatrix stiffness{0, 0};              // E
  std::vector<Interval> force{};               // e_0

  // Whether no equilibrium is at x* + rho u, u of the cell, rho from `least` to `most`.
  bool excludes(const std::vector<Interval>& u, double least, double most) const;
  bool excludes_all(double least, double most) const;
  // |y| in equilibria where |h| is at most so much.
  double joint_force(double most) const;
};

bool CrossingBranches::Expansion::excludes(const std::vector<Interval>& u, double least, double most) const {
  const std::size_t d = u.size();
  const Interval rho(least, most);
  const Interval over = Interval(1) / rho;
  for (std::size_t k = 0; k < bend.size(); ++k) {
    Interval sum = open[k] * square(over);
    for (std::size_t i = 0; i < d; ++i) {
      sum += bend[k](i, i) * square(u[i]) + Interval(2) * slope[k][i] * u[i] * over;
      for (std::size_t j = 0; j < i; ++j) sum += (bend[k](i, j) + bend[k](j, i)) * u[i] * u[j];
    }
    if (sum.excludes_zero()) return true;
  }
  const std::size_t c = bend.size();
  IntervalMatrix columns(d, c + 2);
  for (std::size_t i = 0; i < d; ++i) {
    for (std::size_t k = 0; k < c; ++k) columns(i, k) = slope[k][i] * over;
    for (std::size_t j = 0; j < d; ++j) {
      for (std::size_t k = 0; k < c; ++k) columns(i, k) += bend[k](i, j) * u[j];
      columns(i, c) += stiffness(i, j) * u[j];
    }
    // The force, and the force by rho.
    columns(i, c + 1) = columns(i, c) + force[i] * over;
    columns(i, c) = columns(i, c) * rho + force[i];
  }
  std::vector<char> done;
  if (!eliminate(columns, c, done)) return false;
  for (std::size_t i = 0; i < d; ++i) {
    if (done[i] == 0 && (columns(i, c).excludes_zero() || columns(i, c + 1).excludes_zero())) return true;
  }
  return false;
}

bool CrossingBranches::Expansion::excludes_all(double least, double most) const {
  const std::size_t d = force.size();
  std::vector<std::vector<Interval>> cells;
  for (std::size_t face = 0; face < d; ++face) {
    for (const double side : {-1.0, 1.0}) {
      cells.emplace_back(d, Interval(-1, 1));
      cells.back()[face] = Interval(side);
    }
  }
  for (int count = 0; !cells.empty(); ++count) {
    std::vector<Interval> cell = std::move(cells.back());
    cells.pop_back();
    if (excludes(cell, least, most)) continue;
    std::size_t wide = 0;
    for (std::size_t i = 1; i < d; ++i) {
      if (cell[i].width() > cell[wide].width()) wide = i;
    }
    if (cell[wide].width() < least_cell || count > most_cells_of_directions) return false;
    std::vector<Interval> other = cell;
    const double middle = cell[wide].middle();
    cell[wide] = Interval(cell[wide].lower(), middle);
    other[wide] = Interval(middle, other[wide].upper());
    cells.push_back(std::move(cell));
    cells.push_back(std::move(other));
  }
  return true;
}

double CrossingBranches::Expansion::joint_force(double most) const {
  const std::size_t d = force.size();
  const Interval any(-most, most);
  double out = 0.0;
  for (std::size_t i = 0; i < d; ++i) {
    Interval own = force[i];
    for (std::size_t j = 0; j < d; ++j) own += stiffness(i, j) * any;
    Interval levers(0);
    for (std::size_t k = 0; k < bend.size(); ++k) {
      Interval lever = slope[k][i];
      for (std::size_t j = 0; j < d; ++j) lever += bend[k](i, j) * any;
      levers += Interval(lever.magnitude());
    }
    if (own.excludes_zero()) out = std::max(out, (Interval(own.mignitude()) / levers).lower());
  }
  return out;
}

bool CrossingBranches::Region::contains(const std::vector<Interval>& box) const {
  for (std::size_t i = 0; i < box.size(); ++i) {
    if (box[i].lower() < around[i].lower() || box[i].upper() > around[i].upper()) return false;
  }
  return std::all_of(across.begin(), across.end(), [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    return abs(box[k] - Interval(at[k])) <= Interval(reach);
  });
}

CrossingBranches::CrossingBranches(const StaticModel& model, MergedMechanism& mechanism, std::vector<int> rows)
    : plain_(model.mechanism()),
      mechanism_(mechanism),
      positions_([&] {
        const solvers::RoundingUp up;
        return Mechanism<Interval>(positions_alone(model.scaled_scene()), model.layout(), Purpose::statics);
      }()),
      rows_(std::move(rows)) {}

// Elimination with full pivoting finds R and D: rows and columns with a pivot.
bool CrossingBranches::choose_parts(const std::vector<double>& at) {
  const DensePoint<double> point(plain_, at, rows_);
  Eigen::MatrixXd left = point.jacobian;
  regular_.clear();
  dependent_.clear();
  std::vector<char> row_done(rows_.size(), 0);
  std::vector<char> column_done(static_cast<std::size_t>(left.cols()), 0);
  for (;;) {
    Eigen::Index row = -1;
    Eigen::Index column = -1;
    double most = lost_pivot;
    for (Eigen::Index k = 0; k < left.rows(); ++k) {
      for (Eigen::Index i = 0; i < left.cols() && row_done[static_cast<std::size_t>(k)] == 0; ++i) {
        if (column_done[static_cast<std::size_t>(i)] != 0 || !(std::abs(left(k, i)) > most)) continue;
        most = std::abs(left(k, i));
        row = k;
        column = i;
      }
    }
    if (row < 0) break;
    row_done[static_cast<std::size_t>(row)] = column_done[static_cast<std::size_t>(column)] = 1;
    regular_.push_back(rows_[static_cast<std::size_t>(row)]);
    dependent_.push_back(static_cast<int>(column));
    for (Eigen::Index k = 0; k < left.rows(); ++k) {
      if (row_done[static_cast<std::size_t>(k)] == 0)
        left.row(k) -= left(k, column) / left(row, column) * left.row(row);
    }
  }
  lost_.clear();
  across_.clear();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    if (row_done[k] == 0) lost_.push_back(rows_[k]);
  }
  for (std::size_t i = 0; i < column_done.size(); ++i) {
    if (column_done[i] == 0) across_.push_back(static_cast<int>(i));
  }
  return !lost_.empty() && across_.size() > lost_.size() && across_.size() <= most_open;
}

// The steps of the expansion in a box of some width around x*.
class CrossingBranches::Expander {
 public:
  Expander(CrossingBranches& of, const std::vector<double>& at, double width, Expansion& out)
      : plain_(of.plain_),
        mechanism_(of.mechanism_),
        positions_(of.positions_),
        regular_(of.regular_),
        lost_(of.lost_),
        dependent_(of.dependent_),
        across_(of.across_),
        out_(out),
        n_(static_cast<std::size_t>(plain_.coordinates())),
        rows_(static_cast<std::size_t>(plain_.constraints())),
        pose_(static_cast<std::size_t>(std::max(mechanism_.pose_size(), positions_.pose_size()))),
        jacobian_(plain_.jacobian_row().size()),
        constraint_(rows_),
        force_(n_) {
    out_ = {};
    for (const double x : at) {
      thin_.emplace_back(x);
      out_.around.push_back(Interval(x) + Interval(-width, width));
    }
  }

  // False where nothing is known in the box.
  bool run() {
    evaluate_at_point();
    if (!find_followers()) return false;
    factor_regular();
    positions_.place(out_.around.data(), pose_.data());
    for (const int row : lost_) expand_row(static_cast<std::size_t>(row));
    expand_force();
    return std::all_of(out_.stiffness.entries.begin(), out_.stiffness.entries.end(),
                       [](const Interval& entry) { return entry.bounded(); });
  }

 private:
  // The Jacobian of all rows over a box.
  IntervalMatrix dense_jacobian(const std::vector<Interval>& box) {
    IntervalMatrix out(rows_, n_);
    mechanism_.place(box.data(), pose_.data());
    mechanism_.jacobian(pose_.data(), jacobian_.data());
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      const auto row = static_cast<std::size_t>(plain_.jacobian_row()[e]);
      out(row, static_cast<std::size_t>(plain_.jacobian_column()[e])) += jacobian_[e];
    }
    return out;
  }

  // A matrix of second derivatives from its entries, of which the lower triangle may be left out.
  IntervalMatrix dense_tangent(const std::vector<int>& row, const std::vector<int>& column,
                               const std::vector<Interval>& values, bool is_full) const {
    IntervalMatrix out(n_, n_);
    for (std::size_t e = 0; e < values.size(); ++e) {
      const auto i = static_cast<std::size_t>(row[e]);
      const auto j = static_cast<std::size_t>(column[e]);
      out(i, j) += values[e];
      if (i != j && !is_full) out(j, i) += values[e];
    }
    return out;
  }

  void evaluate_at_point() {
    here_ = dense_jacobian(thin_);
    mechanism_.place(thin_.data(), pose_.data());
    mechanism_.constraint(thin_.data(), pose_.data(), constraint_.data());
    mechanism_.negative_force(thin_.data(), pose_.data(), force_.data());
  }

  // Finds Z and r, by which the dependent coordinates follow. False if they may not.
  bool find_followers() {
    const std::size_t m = regular_.size();
    const std::size_t d = across_.size();
    const IntervalMatrix wide = dense_jacobian(out_.around);
    IntervalMatrix left(m, m);
    IntervalMatrix right(m, d + 1);
    for (std::size_t k = 0; k < m; ++k) {
      const auto row = static_cast<std::size_t>(regular_[k]);
      for (std::size_t i = 0; i < m; ++i) left(k, i) = wide(row, static_cast<std::size_t>(dependent_[i]));
      for (std::size_t p = 0; p < d; ++p) right(k, p) = -wide(row, static_cast<std::size_t>(across_[p]));
      right(k, d) = -constraint_[row];
    }
    IntervalMatrix found(m, d + 1);
    if (!solve_enclosed(left, right, found)) return false;
    z_ = IntervalMatrix(n_, d);
    r_ = IntervalMatrix(n_, 1);
    for (std::size_t k = 0; k < m; ++k) {
      const auto i = static_cast<std::size_t>(dependent_[k]);
      for (std::size_t p = 0; p < d; ++p) z_(i, p) = found(k, p);
      r_(i, 0) = found(k, d);
    }
    for (std::size_t p = 0; p < d; ++p) z_(static_cast<std::size_t>(across_[p]), p) = Interval(1);
    zt_ = transposed(z_);
    out_.follows = IntervalMatrix(n_, d + 1);
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t p = 0; p < d; ++p) out_.follows(i, p) = z_(i, p);
      out_.follows(i, d) = r_(i, 0);
    }
    return true;
  }

  // Factors what regular rows have by dependent coordinates at x*.
  void factor_regular() {
    const std::size_t m = regular_.size();
    Eigen::MatrixXd regular(m, m);
    for (std::size_t k = 0; k < m; ++k) {
      for (std::size_t i = 0; i < m; ++i) {
        regular(k, i) = here_(static_cast<std::size_t>(regular_[k]), static_cast<std::size_t>(dependent_[i])).middle();
      }
    }
    solver_.compute(regular.transpose());
  }

  // Multipliers of the regular rows that cancel at x* what a gradient has by dependent coordinates.
  std::vector<Interval> multipliers_against(const std::vector<Interval>& gradient) const {
    const std::size_t m = regular_.size();
    std::vector<Interval> out(rows_, Interval(0));
    if (m == 0) return out;
    Eigen::VectorXd to(m);
    for (std::size_t i = 0; i < m; ++i) {
      to[static_cast<Eigen::Index>(i)] = -gradient[static_cast<std::size_t>(dependent_[i])].middle();
    }
    const Eigen::VectorXd y = solver_.solve(to);
    for (std::size_t k = 0; k < m; ++k) {
      out[static_cast<std::size_t>(regular_[k])] = Interval(y[static_cast<Eigen::Index>(k)]);
    }
    return out;
  }

  // The derivatives of sum y c at x*, added to a gradient.
  IntervalMatrix gradient_with(const std::vector<Interval>& y, const std::vector<Interval>& gradient) const {
    IntervalMatrix sum(n_, 1);
    for (std::size_t i = 0; i < n_; ++i) {
      sum(i, 0) = gradient[i];
      for (std::size_t k = 0; k < rows_; ++k) sum(i, 0) += y[k] * here_(k, i);
    }
    return sum;
  }

  // Finds K, g and 2 l of a lost row, with positions placed in the box.
  void expand_row(std::size_t row) {
    std::vector<Interval> own(n_);
    for (std::size_t i = 0; i < n_; ++i) own[i] = here_(row, i);
    std::vector<Interval> y = multipliers_against(own);
    y[row] = Interval(1);
    std::vector<Interval> curved(positions_.tangent_row().size());
    positions_.tangent(pose_.data(), y.data(), curved.data());
    const IntervalMatrix second =
        dense_tangent(positions_.tangent_row(), positions_.tangent_column(), curved, positions_.has_follower_loads());
    const IntervalMatrix first = gradient_with(y, std::vector<Interval>(n_, Interval(0)));
    IntervalMatrix turned = product(second, r_);
    Interval open(0);
    for (std::size_t k = 0; k < rows_; ++k) open += Interval(2) * y[k] * constraint_[k];
    for (std::size_t i = 0; i < n_; ++i) {
      open += Interval(2) * first(i, 0) * r_(i, 0) + r_(i, 0) * turned(i, 0);
      turned(i, 0) += first(i, 0);
    }
    out_.bend.push_back(product(zt_, product(second, z_)));
    out_.slope.push_back(product(zt_, turned).entries);
    out_.open.push_back(open);
  }

  // Finds E and e_0.
  void expand_force() {
    const std::vector<Interval> mu = multipliers_against(force_);
    const IntervalMatrix total = gradient_with(mu, force_);
    std::vector<Interval> tangent(plain_.tangent_row().size());
    mechanism_.place(out_.around.data(), pose_.data());
    mechanism_.tangent(pose_.data(), mu.data(), tangent.data());
    const IntervalMatrix second =
        dense_tangent(plain_.tangent_row(), plain_.tangent_column(), tangent, plain_.has_follower_loads());
    out_.stiffness = product(zt_, product(second, z_));
    IntervalMatrix turned = product(second, r_);
    for (std::size_t i = 0; i < n_; ++i) turned(i, 0) += total(i, 0);
    out_.force = product(zt_, turned).entries;
  }

  const Mechanism<double>& plain_;
  MergedMechanism& mechanism_;
  const Mechanism<Interval>& positions_;
  const std::vector<int>& regular_;
  const std::vector<int>& lost_;
  const std::vector<int>& dependent_;
  const std::vector<int>& across_;
  Expansion& out_;
  std::size_t n_, rows_;
  std::vector<Planar<Interval>> pose_;
  std::vector<Interval> jacobian_, constraint_, force_;  // the latter two at x*
  std::vector<Interval> thin_;                           // x*
  IntervalMatrix here_{0, 0};                            // Jacobian at x*
  IntervalMatrix z_{0, 0}, zt_{0, 0}, r_{0, 0};
  Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

bool CrossingBranches::expand(const std::vector<double>& at, double width, Expansion& out) {
  return Expander(*this, at, width, out).run();
}

// The distance up to which there are no equilibria from `least` on.
double CrossingBranches::clear_from(const Expansion& of, double least, double most) const {
  if (of.excludes_all(least, most)) return most;
  if (most < least_ratio * least) return least;
  const double middle = std::sqrt(least) * std::sqrt(most);
  const double first = clear_from(of, least, middle);
  return first < middle ? first : clear_from(of, middle, most);
}

std::optional<CrossingBranches::Region> CrossingBranches::around(const std::vector<double>& x) {
  const std::optional<std::vector<double>> at = nearest_singular_point(plain_, x, rows_);
  if (!at || !choose_parts(*at)) return std::nullopt;
  std::optional<Region> out;
  for (const double width : box_sizes) {
    if (out && out->reach >= 0.5 * width) break;
    Expansion of;
    if (!expand(*at, width, of)) continue;
    for (const double core : core_sizes) {
      const double reach = clear_from(of, core, width);
      if (!(reach > more_than_core * core)) continue;
      if (out && out->reach >= reach) break;
      Region& region = out.emplace();
      region.at = *at;
      region.around = of.around;
      region.across = across_;
      region.reach = reach;
      region.joint_force = of.joint_force(core);
      for (std::size_t i = 0; i < at->size(); ++i) {
        Interval own = Interval((*at)[i]) + of.follows(i, across_.size());
        for (std::size_t p = 0; p < across_.size(); ++p) own += of.follows(i, p) * Interval(-core, core);
        region.core.push_back(own);
      }
      break;
    }
  }
  return out;
}

}  // namespace poise
