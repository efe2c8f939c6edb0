// Dense null-space solution of the Newton system by coordinate partitioning.
//
// A rank-revealing QR of J picks `rank` ordinary columns o and as many independent rows; the other columns p are
// primary. With J = [Jo Jp], B = Jo^-1 Jp, N = [-B; I] and v = [-Jo^-1 c; 0]:
//   multipliers   y = -Jo^-T F_o,  so that F + J^T y vanishes in the ordinary entries and equals N^T F in the primary
//   step          d = N z + v,     (N^T K N + shift N^T N) z = -N^T (F + K v)
// (Paul 1979; thesis eqs. 53-55.) The partition is kept from step to step while B stays small, so that a step costs
// one inversion of Jo. J and K are kept with ordinary columns first, primary last.
//
// Hand-written loops: at these sizes (a few to a few dozen) a library call costs more than its arithmetic, and dynamic
// decompositions allocate. Loops are called through with_sizes(), which makes the sizes of the commonest mechanisms
// compile-time constants.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <Eigen/QR>

#include "solvers/kkt.hpp"

namespace poise::solvers {
namespace {

// |B| above which the partition is chosen anew: QR makes it about one, so growth means that the pose has changed.
constexpr double dependence_limit = 20.0;
// Columns whose remaining part is below this fraction of the largest are dependent.
constexpr double rank_tolerance = 1e-10;
// Constraints that are dependent where they hold differ by about their gaps where they do not hold yet: with a gap the
// tolerance is so many times the gap, up to a limit.
constexpr double rank_tolerance_per_gap = 10.0;
constexpr double rank_tolerance_limit = 1e-3;
// Smallest pivot of Jo, whose entries are of order one.
constexpr double smallest_pivot = 1e-12;
// Pivots of the reduced tangent below this fraction of the largest entry of K count as zero.
constexpr double singular_below = 1e-15;

// n - r and a b, compile-time constants where both are.
template <int n, int r>
constexpr std::integral_constant<int, n - r> difference(std::integral_constant<int, n>,
                                                        std::integral_constant<int, r>) {
  return {};
}
constexpr int difference(int n, int r) { return n - r; }

template <int a, int b>
constexpr std::integral_constant<int, a * b> times(std::integral_constant<int, a>, std::integral_constant<int, b>) {
  return {};
}
constexpr int times(int a, int b) { return a * b; }

// A buffer of n numbers: in registers where n is a compile-time constant.
template <int n>
std::array<double, n> buffer(std::vector<double>&, std::integral_constant<int, n>) {
  return {};
}
double* buffer(std::vector<double>& kept, int) { return kept.data(); }

class NullSpace final : public Kkt {
 public:
  NullSpace(const Problem& problem, bool rank_revealing)
      : rank_revealing_(rank_revealing),
        n_(problem.variables()),
        m_(problem.constraints()),
        equalities_(problem.equalities()),
        symmetric_(problem.has_objective()),
        jacobian_pattern_(problem.jacobian_pattern()),
        tangent_pattern_(problem.tangent_pattern()),
        qr_columns_(std::max(m_, 1), n_),
        qr_rows_(n_, std::max(m_, 1)),
        qr_matrix_(std::max(m_, 1), n_),
        qr_transposed_(n_, std::max(m_, 1)) {
    const auto n = static_cast<std::size_t>(n_);
    const auto m = static_cast<std::size_t>(m_);
    for (auto* v : {&jacobian_, &dependence_}) v->resize(m * n);
    for (auto* v : {&tangent_, &product_, &reduced_, &metric_, &factors_}) v->resize(n * n);
    for (auto* v : {&normal_, &right_, &primary_, &step_}) v->resize(n);
    inverse_.resize(std::min(m, n) * std::min(m, n));  // of rank x rank at most
    for (auto* v : {&order_, &place_, &permutation_}) v->resize(n);
    for (auto* v : {&rows_, &pivot_}) v->resize(m);
    used_.reserve(jacobian_pattern_.size());
    tangent_target_.resize(tangent_pattern_.size());
    last_active_.resize(m);
  }

  bool set_jacobian(const Evaluation& at, const std::vector<char>& active) override {
    for (bool anew = !all_rows_used_ || !same_rows(active);; anew = true) {
      if (anew) {
        last_active_ = active;
        choose_partition(at);
      }
      for (const Used& entry : used_) jacobian_[entry.target] = at.jacobian[entry.source];
      const double growth = invert();
      // Without rank detection a singular Jo means no solution.
      if (anew) return std::isfinite(growth) || rank_revealing_;
      if (growth <= dependence_limit) return true;
    }
  }

  bool redundant() const override { return !all_rows_used_; }

  bool determines_multipliers() const override { return true; }

  void multipliers(std::span<const double> field, std::span<double> y) override {
    with_sizes([&](auto, auto r) {
      auto right = buffer(right_, r);
      for (int i = 0; i < r; ++i) right[i] = field[order_[i]];
      ordinary_multipliers(right, y, r);
    });
  }

  void balance(std::span<const double> field, std::span<double> y, std::span<double> residual) override {
    with_sizes([&](auto n, auto r) {
      auto right = buffer(right_, n);
      for (int i = 0; i < n; ++i) right[i] = field[order_[i]];
      ordinary_multipliers(right, y, r);
      for (int i = 0; i < n; ++i) {
        double sum = right[i];
        for (int k = 0; k < r; ++k) sum += jacobian_[k * n + i] * y[rows_[k]];
        residual[order_[i]] = sum;
      }
    });
  }

  void unbalanced(std::span<const double> field, std::span<const double> y, std::span<double> out) const override {
    with_sizes([&](auto n, auto r) {
      for (int i = 0; i < n; ++i) {
        double sum = field[order_[i]];
        for (int k = 0; k < r; ++k) sum += jacobian_[k * n + i] * y[rows_[k]];
        out[order_[i]] = sum;
      }
    });
  }

  Factors factor_tangent(std::span<const double> values) override {
    double largest = 0.0;
    for (int e = 0; e < static_cast<int>(values.size()); ++e) {
      const double value = values[e];
      tangent_[tangent_target_[e].first] = tangent_[tangent_target_[e].second] = value;
      largest = std::max(largest, std::abs(value));
    }
    largest_tangent_ = largest;
    return with_sizes([&](auto n, auto r) {
      reduce(n, r);
      return factor_reduced(0.0, difference(n, r));
    });
  }

  Factors factor_identity() override {
    std::fill(tangent_.begin(), tangent_.end(), 0.0);
    for (int i = 0; i < n_; ++i) tangent_[i * n_ + i] = 1.0;
    largest_tangent_ = 1.0;
    reduce(n_, rank_);
    return factor_reduced(0.0, n_ - rank_);
  }

  Factors factor_shifted(double shift) override {
    measure(n_ - rank_, rank_);
    return factor_reduced(shift, n_ - rank_);
  }

  void solve(std::span<const double> field, std::span<const double> c, std::span<double> d) override {
    with_sizes([&](auto n, auto r) {
      const auto p = difference(n, r);
      auto normal = buffer(normal_, r);
      auto right = buffer(right_, n);
      auto primary = buffer(primary_, p);
      normal_step(c, normal, r);
      // right = F + K v, then its reduction N^T (.)
      for (int i = 0; i < n; ++i) {
        double sum = !field.empty() ? field[order_[i]] : 0.0;
        for (int k = 0; k < r; ++k) sum += tangent_[i * n + k] * normal[k];
        right[i] = sum;
      }
      for (int k = 0; k < p; ++k) {
        double sum = right[r + k];
        for (int i = 0; i < r; ++i) sum -= dependence_[i * p + k] * right[i];
        primary[k] = -sum;
      }
      back_substitute(primary, p);
      for (int i = 0; i < r; ++i) {
        double sum = normal[i];
        for (int k = 0; k < p; ++k) sum -= dependence_[i * p + k] * primary[k];
        step_[i] = d[order_[i]] = sum;
      }
      for (int k = 0; k < p; ++k) step_[r + k] = d[order_[r + k]] = primary[k];
    });
  }

  // y = -Jo^-T (F + K d)_o
  void solved_multipliers(std::span<const double> field, std::span<double> y) override {
    with_sizes([&](auto n, auto r) {
      auto right = buffer(right_, r);
      for (int i = 0; i < r; ++i) {
        double sum = !field.empty() ? field[order_[i]] : 0.0;
        for (int k = 0; k < n; ++k) sum += tangent_[i * n + k] * step_[k];
        right[i] = sum;
      }
      ordinary_multipliers(right, y, r);
    });
  }

  void restore(std::span<const double> c, std::span<double> d) override {
    normal_step(c, normal_, rank_);
    for (int i = 0; i < rank_; ++i) d[order_[i]] = normal_[i];
    for (int i = rank_; i < n_; ++i) d[order_[i]] = 0.0;
  }

 private:
  // An entry of J in the rows used, and its place in jacobian_.
  struct Used {
    int source, target;
  };

  // Calls f(n, rank) with both as compile-time constants for one and two closed loops with one degree of freedom.
  template <class F>
  auto with_sizes(F f) const -> decltype(f(0, 0)) {
    if (n_ == 3 && rank_ == 2) return f(std::integral_constant<int, 3>{}, std::integral_constant<int, 2>{});
    if (n_ == 5 && rank_ == 4) return f(std::integral_constant<int, 5>{}, std::integral_constant<int, 4>{});
    return f(n_, rank_);
  }

  bool same_rows(const std::vector<char>& active) const {
    for (int row = 0; row < m_; ++row) {
      if (active[row] != last_active_[row]) return false;
    }
    return true;
  }

  // y = -Jo^-T right for the rows used, 0 for all others.
  template <class Right, class R>
  void ordinary_multipliers(const Right& right, std::span<double> y, R r) const {
    if (r < m_) std::fill(y.begin(), y.end(), 0.0);
    for (int j = 0; j < r; ++j) {
      double sum = 0.0;
      for (int i = 0; i < r; ++i) sum -= inverse_[i * r + j] * right[i];
      y[rows_[j]] = sum;
    }
  }

  // normal = -Jo^-1 c, in the ordinary entries.
  template <class Normal, class R>
  void normal_step(std::span<const double> c, Normal& normal, R r) const {
    for (int i = 0; i < r; ++i) {
      double sum = 0.0;
      if (!c.empty()) {
        for (int j = 0; j < r; ++j) sum -= inverse_[i * r + j] * c[rows_[j]];
      }
      normal[i] = sum;
    }
  }

  // Rank-revealing QR of J selects the ordinary columns, and QR of the transpose of those columns the rows.
  void choose_partition(const Evaluation& at) {
    qr_matrix_.setZero();
    for (int e = 0; e < jacobian_pattern_.size(); ++e) {
      const int row = jacobian_pattern_.row[e];
      if (last_active_[row]) qr_matrix_(row, jacobian_pattern_.column[e]) = at.jacobian[e];
    }
    const auto active_rows =
        static_cast<int>(std::count_if(last_active_.begin(), last_active_.end(), [](char a) { return a != 0; }));
    rank_ = 0;
    const bool has_entries = active_rows > 0 && n_ > 0;  // Eigen decomposes no empty matrix
    if (has_entries) {
      double gap = 0.0;
      for (int row = 0; row < equalities_; ++row) gap = std::max(gap, std::abs(at.constraint[row]));
      qr_columns_.setThreshold(std::clamp(rank_tolerance_per_gap * gap, rank_tolerance, rank_tolerance_limit));
      qr_columns_.compute(qr_matrix_);
      rank_ = rank_revealing_ ? static_cast<int>(qr_columns_.rank()) : std::min(active_rows, n_);
      // A Jacobian that is rounding only has no rank, however its pivots compare with each other.
      while (rank_revealing_ && rank_ > 0 &&
             !(std::abs(qr_columns_.matrixQR()(rank_ - 1, rank_ - 1)) >= smallest_pivot)) {
        --rank_;
      }
    }
    for (int k = 0; k < n_; ++k) {
      order_[k] = has_entries ? static_cast<int>(qr_columns_.colsPermutation().indices()[k]) : k;
      place_[order_[k]] = k;
    }
    all_rows_used_ = rank_ == active_rows;
    if (all_rows_used_) {
      for (int r = 0, k = 0; r < m_; ++r) {
        if (last_active_[r]) rows_[k++] = r;
      }
    } else if (n_ > 0) {
      qr_transposed_.setZero();
      for (int k = 0; k < rank_; ++k) qr_transposed_.row(k) = qr_matrix_.col(order_[k]).transpose();
      qr_rows_.compute(qr_transposed_);
      for (int k = 0; k < rank_; ++k) rows_[k] = static_cast<int>(qr_rows_.colsPermutation().indices()[k]);
    }
    aim_entries();
  }

  // Where pattern entries go in the permuted matrices; entries outside the pattern stay zero.
  void aim_entries() {
    used_.clear();
    for (int e = 0; e < jacobian_pattern_.size(); ++e) {
      const auto end = rows_.begin() + rank_;
      const auto row = std::find(rows_.begin(), end, jacobian_pattern_.row[e]);
      if (row == end) continue;
      used_.push_back({e, static_cast<int>(row - rows_.begin()) * n_ + place_[jacobian_pattern_.column[e]]});
    }
    for (int e = 0; e < tangent_pattern_.size(); ++e) {
      const int i = place_[tangent_pattern_.row[e]];
      const int j = place_[tangent_pattern_.column[e]];
      tangent_target_[e] = {i * n_ + j, symmetric_ ? j * n_ + i : i * n_ + j};
    }
    std::fill(jacobian_.begin(), jacobian_.end(), 0.0);
    std::fill(tangent_.begin(), tangent_.end(), 0.0);
  }

  // inverse_ = Jo^-1, dependence_ = B. Returns the largest |B|, infinite where a pivot vanishes.
  double invert() {
    return with_sizes([&](auto n, auto r) {
      const auto p = difference(n, r);
      if (!(r == 2 ? invert_two() : invert_by_elimination(r))) return std::numeric_limits<double>::infinity();
      double worst = 0.0;
      for (int i = 0; i < r; ++i) {
        for (int k = 0; k < p; ++k) {
          double sum = 0.0;
          for (int c = 0; c < r; ++c) sum += inverse_[i * r + c] * jacobian_[c * n + r + k];
          dependence_[i * p + k] = sum;
          worst = std::max(worst, std::abs(sum));
        }
      }
      return worst;
    });
  }

  // One closed loop: Cramer's rule. The pivots are those of elimination.
  bool invert_two() {
    const double a = jacobian_[0], b = jacobian_[1], c = jacobian_[n_], d = jacobian_[n_ + 1];
    const double determinant = a * d - b * c;
    const double pivot = std::max(std::abs(a), std::abs(c));
    if (!(pivot >= smallest_pivot && std::abs(determinant) >= smallest_pivot * pivot)) return false;
    const double scale = 1.0 / determinant;
    inverse_[0] = scale * d;
    inverse_[1] = -scale * b;
    inverse_[2] = -scale * c;
    inverse_[3] = scale * a;
    return true;
  }

  // Gauss-Jordan with row pivoting.
  template <class R>
  bool invert_by_elimination(R r) {
    double* a = inverse_.data();
    for (int i = 0; i < r; ++i) {
      for (int k = 0; k < r; ++k) a[i * r + k] = jacobian_[i * n_ + k];
    }
    for (int k = 0; k < r; ++k) {
      int best = k;
      for (int i = k + 1; i < r; ++i) {
        if (std::abs(a[i * r + k]) > std::abs(a[best * r + k])) best = i;
      }
      pivot_[k] = best;
      if (!(std::abs(a[best * r + k]) >= smallest_pivot)) return false;
      if (best != k) {
        for (int c = 0; c < r; ++c) std::swap(a[k * r + c], a[best * r + c]);
      }
      const double scale = 1.0 / a[k * r + k];
      a[k * r + k] = 1.0;
      for (int c = 0; c < r; ++c) a[k * r + c] *= scale;
      for (int i = 0; i < r; ++i) {
        if (i == k) continue;
        const double factor = a[i * r + k];
        a[i * r + k] = 0.0;
        for (int c = 0; c < r; ++c) a[i * r + c] -= factor * a[k * r + c];
      }
    }
    for (int k = r - 1; k >= 0; --k) {
      if (pivot_[k] == k) continue;
      for (int i = 0; i < r; ++i) std::swap(a[i * r + k], a[i * r + pivot_[k]]);
    }
    return true;
  }

  // reduced_ = N^T K N.
  template <class N, class R>
  void reduce(N n, R r) {
    const auto p = difference(n, r);
    auto product = buffer(product_, times(n, p));
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < p; ++k) {
        double sum = tangent_[i * n + r + k];
        for (int c = 0; c < r; ++c) sum -= tangent_[i * n + c] * dependence_[c * p + k];
        product[i * p + k] = sum;
      }
    }
    for (int a = 0; a < p; ++a) {
      for (int b = 0; b < p; ++b) {
        double sum = product[(r + a) * p + b];
        for (int c = 0; c < r; ++c) sum -= dependence_[c * p + a] * product[c * p + b];
        reduced_[a * p + b] = sum;
      }
    }
  }

  // Of reduced_ + shift metric_, p x p.
  template <class P>
  Factors factor_reduced(double shift, P p) {
    double largest = largest_tangent_;
    const auto load = [&] {
      for (int i = 0; i < p * p; ++i) {
        factors_[i] = shift > 0 ? reduced_[i] + shift * metric_[i] : reduced_[i];
        largest = std::max(largest, std::abs(factors_[i]));
      }
    };
    load();
    positive_definite_ = symmetric_ && factor_positive_definite(largest, p);
    if (positive_definite_) return Factors::positive;
    if (symmetric_) load();
    return eliminate(largest, p) ? Factors::indefinite : Factors::singular;
  }

  // metric_ = N^T N = I + B^T B.
  template <class P, class R>
  void measure(P p, R r) {
    for (int a = 0; a < p; ++a) {
      for (int b = 0; b < p; ++b) {
        double square = a == b ? 1.0 : 0.0;
        for (int c = 0; c < r; ++c) square += dependence_[c * p + a] * dependence_[c * p + b];
        metric_[a * p + b] = square;
      }
    }
  }

  // L D L^T without pivoting; false where the matrix is not positive definite.
  template <class P>
  bool factor_positive_definite(double largest, P p) {
    for (int k = 0; k < p; ++k) {
      double pivot = factors_[k * p + k];
      for (int c = 0; c < k; ++c) pivot -= factors_[k * p + c] * factors_[k * p + c] * factors_[c * p + c];
      if (!(pivot > singular_below * largest)) return false;
      factors_[k * p + k] = pivot;
      for (int i = k + 1; i < p; ++i) {
        double sum = factors_[i * p + k];
        for (int c = 0; c < k; ++c) sum -= factors_[i * p + c] * factors_[k * p + c] * factors_[c * p + c];
        factors_[i * p + k] = sum / pivot;
      }
    }
    return true;
  }

  // LU with row pivoting for a matrix that is not positive definite.
  template <class P>
  bool eliminate(double largest, P p) {
    bool regular = true;
    for (int k = 0; k < p; ++k) {
      int best = k;
      for (int i = k + 1; i < p; ++i) {
        if (std::abs(factors_[i * p + k]) > std::abs(factors_[best * p + k])) best = i;
      }
      permutation_[k] = best;
      if (best != k) std::swap_ranges(&factors_[k * p], &factors_[k * p] + p, &factors_[best * p]);
      double& pivot = factors_[k * p + k];
      if (!(std::abs(pivot) > singular_below * largest)) {
        regular = false;
        pivot = std::max(singular_below * largest, 1e-300);
      }
      for (int i = k + 1; i < p; ++i) {
        const double factor = factors_[i * p + k] /= pivot;
        for (int c = k + 1; c < p; ++c) factors_[i * p + c] -= factor * factors_[k * p + c];
      }
    }
    return regular;
  }

  template <class Z, class P>
  void back_substitute(Z& z, P p) const {
    if (positive_definite_) {
      for (int i = 0; i < p; ++i) {
        for (int c = 0; c < i; ++c) z[i] -= factors_[i * p + c] * z[c];
      }
      for (int i = p - 1; i >= 0; --i) {
        z[i] /= factors_[i * p + i];
        for (int c = i + 1; c < p; ++c) z[i] -= factors_[c * p + i] * z[c];
      }
      return;
    }
    for (int i = 0; i < p; ++i) std::swap(z[i], z[permutation_[i]]);
    for (int i = 0; i < p; ++i) {
      for (int c = 0; c < i; ++c) z[i] -= factors_[i * p + c] * z[c];
    }
    for (int i = p - 1; i >= 0; --i) {
      for (int c = i + 1; c < p; ++c) z[i] -= factors_[i * p + c] * z[c];
      z[i] /= factors_[i * p + i];
    }
  }

  bool rank_revealing_;
  int n_, m_, equalities_;
  bool symmetric_;
  const Pattern& jacobian_pattern_;
  const Pattern& tangent_pattern_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_columns_, qr_rows_;
  Eigen::MatrixXd qr_matrix_, qr_transposed_;
  std::vector<char> last_active_;
  std::vector<Used> used_;
  bool all_rows_used_ = false;
  bool positive_definite_ = false;  // factors_ hold L D L^T, else L U
  int rank_ = 0;
  double largest_tangent_ = 0.0;
  std::vector<int> order_;  // variables, ordinary first
  std::vector<int> place_;  // position of a variable in order_
  std::vector<int> rows_;   // independent constraint rows
  std::vector<int> pivot_, permutation_;
  std::vector<std::pair<int, int>> tangent_target_;  // of each entry of K, and of its mirror image
  std::vector<double> jacobian_, tangent_, inverse_, dependence_, product_, reduced_, metric_, factors_, normal_,
      right_, primary_, step_;
};

}  // namespace

std::unique_ptr<Kkt> make_null_space(const Problem& problem, bool rank_revealing) {
  return std::make_unique<NullSpace>(problem, rank_revealing);
}

}  // namespace poise::solvers
