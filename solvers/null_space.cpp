// Dense null-space solution of the Newton system by coordinate partitioning.
//
// A rank-revealing QR of J picks `rank` ordinary columns o and as many independent rows; the other columns p are
// primary. With J = [Jo Jp], B = Jo^-1 Jp, N = [-B; I] and v = [-Jo^-1 c; 0]:
//   multipliers   y = -Jo^-T F_o,  so that F + J^T y vanishes in the ordinary places and equals N^T F in the primary
//   step          d = N z + v,     (N^T K N + shift N^T N) z = -N^T (F + K v)
// (Paul 1979; thesis eqs. 53-55.) The partition is kept from step to step while B stays small, so that a step costs
// one Gauss-Jordan inversion of Jo. Hand-written loops: at these sizes (a few to a few dozen) a library call costs
// more than its arithmetic, and dynamic decompositions allocate.

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "solvers/kkt.hpp"

namespace poise::solvers {
namespace {

// |B| above which the partition is chosen anew: QR keeps it near one, so growth means the pose has moved on.
constexpr double dependence_limit = 20.0;
// Columns whose remaining part is below this fraction of the largest are dependent.
constexpr double rank_tolerance = 1e-10;

class NullSpace final : public Kkt {
 public:
  explicit NullSpace(const Problem& problem)
      : n_(problem.variables()),
        m_(problem.constraints()),
        symmetric_(problem.has_objective()),
        jacobian_pattern_(problem.jacobian_pattern()),
        tangent_pattern_(problem.tangent_pattern()),
        qr_columns_(std::max(m_, 1), n_),
        qr_rows_(n_, std::max(m_, 1)),
        qr_matrix_(std::max(m_, 1), n_),
        qr_transposed_(n_, std::max(m_, 1)) {
    jacobian_.resize(static_cast<std::size_t>(m_) * n_);
    tangent_.resize(static_cast<std::size_t>(n_) * n_);
    inverse_.resize(static_cast<std::size_t>(m_) * m_);
    pivot_.resize(m_);
    dependence_.resize(static_cast<std::size_t>(m_) * n_);
    product_.resize(static_cast<std::size_t>(n_) * (n_ + 1));
    reduced_.resize(static_cast<std::size_t>(n_) * n_);
    metric_.resize(static_cast<std::size_t>(n_) * n_);
    factors_.resize(static_cast<std::size_t>(n_) * n_);
    permutation_.resize(n_);
    normal_.resize(n_);
    right_.resize(n_);
    ordinary_.resize(n_);
    primary_.resize(n_);
    rows_.resize(m_);
    last_active_.assign(m_, 2);
  }

  void set_jacobian(const Evaluation& at, const std::vector<char>& active) override {
    std::fill(jacobian_.begin(), jacobian_.end(), 0.0);
    for (std::size_t e = 0; e < jacobian_pattern_.size(); ++e) {
      const int row = jacobian_pattern_.row[e];
      if (active[row]) jacobian_[static_cast<std::size_t>(row) * n_ + jacobian_pattern_.column[e]] += at.jacobian[e];
    }
    const bool same_rows = std::equal(active.begin(), active.end(), last_active_.begin());
    if (!same_rows || !all_rows_used_ || !invert() || worst_dependence() > dependence_limit) {
      last_active_ = active;
      choose_partition();
    }
  }

  bool multipliers(const double* field, double* y) override {
    std::fill(y, y + m_, 0.0);
    for (int j = 0; j < rank_; ++j) {
      double sum = 0.0;
      for (int i = 0; i < rank_; ++i) sum -= inverse_[i * rank_ + j] * field[ordinary_[i]];
      y[rows_[j]] = sum;
    }
    return true;
  }

  void least_squares_multipliers(const double* field, double* y) override { multipliers(field, y); }

  void set_tangent(const double* values) override {
    std::fill(tangent_.begin(), tangent_.end(), 0.0);
    for (std::size_t e = 0; e < tangent_pattern_.size(); ++e) {
      const int i = tangent_pattern_.row[e];
      const int j = tangent_pattern_.column[e];
      tangent_[i * n_ + j] += values[e];
      if (symmetric_ && i != j) tangent_[j * n_ + i] += values[e];
    }
    reduce();
  }

  void set_identity() override {
    std::fill(tangent_.begin(), tangent_.end(), 0.0);
    for (int i = 0; i < n_; ++i) tangent_[i * n_ + i] = 1.0;
    reduce();
  }

  Factors factor(double shift) override {
    const int p = n_ - rank_;
    double largest = largest_tangent_;
    for (int i = 0; i < p * p; ++i) {
      factors_[i] = reduced_[i] + (shift > 0 ? shift * metric_[i] : 0.0);
      largest = std::max(largest, std::abs(factors_[i]));
    }
    cholesky_ = symmetric_ && cholesky(largest);
    if (cholesky_) return Factors::positive;
    if (symmetric_) {
      for (int i = 0; i < p * p; ++i) factors_[i] = reduced_[i] + (shift > 0 ? shift * metric_[i] : 0.0);
    }
    return eliminate(largest) ? Factors::indefinite : Factors::singular;
  }

  void solve(const double* field, const double* c, double* d, double* y) override {
    const int p = n_ - rank_;
    std::fill(normal_.begin(), normal_.end(), 0.0);
    if (c != nullptr) {
      for (int i = 0; i < rank_; ++i) {
        double sum = 0.0;
        for (int j = 0; j < rank_; ++j) sum -= inverse_[i * rank_ + j] * c[rows_[j]];
        normal_[ordinary_[i]] = sum;
      }
    }
    // right = F + K v, then its reduction N^T (.)
    for (int i = 0; i < n_; ++i) {
      double sum = field != nullptr ? field[i] : 0.0;
      if (c != nullptr) {
        for (int j = 0; j < rank_; ++j) sum += tangent_[i * n_ + ordinary_[j]] * normal_[ordinary_[j]];
      }
      right_[i] = sum;
    }
    for (int k = 0; k < p; ++k) {
      double sum = right_[primary_[k]];
      for (int j = 0; j < rank_; ++j) sum -= dependence_[j * p + k] * right_[ordinary_[j]];
      product_[k] = -sum;
    }
    back_substitute(product_.data());
    for (int k = 0; k < p; ++k) d[primary_[k]] = product_[k];
    for (int i = 0; i < rank_; ++i) {
      double sum = normal_[ordinary_[i]];
      for (int k = 0; k < p; ++k) sum -= dependence_[i * p + k] * product_[k];
      d[ordinary_[i]] = sum;
    }
    if (y == nullptr) return;
    for (int i = 0; i < rank_; ++i) {
      double sum = field != nullptr ? field[ordinary_[i]] : 0.0;
      for (int j = 0; j < n_; ++j) sum += tangent_[ordinary_[i] * n_ + j] * d[j];
      right_[ordinary_[i]] = sum;
    }
    multipliers(right_.data(), y);
  }

  void restore(const double* c, double* d) override {
    std::fill(d, d + n_, 0.0);
    for (int i = 0; i < rank_; ++i) {
      double sum = 0.0;
      for (int j = 0; j < rank_; ++j) sum -= inverse_[i * rank_ + j] * c[rows_[j]];
      d[ordinary_[i]] = sum;
    }
  }

 private:
  const double& j(int row, int column) const { return jacobian_[static_cast<std::size_t>(row) * n_ + column]; }

  // Rank-revealing QR of J picks the ordinary columns, and one of those columns' transpose the rows.
  void choose_partition() {
    rank_ = 0;
    int active_rows = 0;
    for (int r = 0; r < m_; ++r) active_rows += last_active_[r] != 0;
    if (active_rows > 0) {
      for (int r = 0; r < m_; ++r) {
        for (int k = 0; k < n_; ++k) qr_matrix_(r, k) = j(r, k);
      }
      qr_columns_.setThreshold(rank_tolerance);
      qr_columns_.compute(qr_matrix_);
      rank_ = static_cast<int>(qr_columns_.rank());
    }
    const auto& columns = qr_columns_.colsPermutation().indices();
    for (int k = 0; k < n_; ++k) {
      const int column = active_rows > 0 ? static_cast<int>(columns[k]) : k;
      if (k < rank_)
        ordinary_[k] = column;
      else
        primary_[k - rank_] = column;
    }
    all_rows_used_ = rank_ == active_rows;
    if (all_rows_used_) {
      for (int r = 0, k = 0; r < m_; ++r) {
        if (last_active_[r]) rows_[k++] = r;
      }
    } else {
      qr_transposed_.setZero();
      for (int r = 0; r < m_; ++r) {
        for (int k = 0; k < rank_; ++k) qr_transposed_(k, r) = j(r, ordinary_[k]);
      }
      qr_rows_.compute(qr_transposed_);
      for (int k = 0; k < rank_; ++k) rows_[k] = static_cast<int>(qr_rows_.colsPermutation().indices()[k]);
    }
    invert();
  }

  // inverse_ = Jo^-1 by Gauss-Jordan with row pivoting, dependence_ = B. False where a pivot vanishes.
  bool invert() {
    const int r = rank_;
    for (int i = 0; i < r; ++i) {
      for (int k = 0; k < r; ++k) inverse_[i * r + k] = j(rows_[i], ordinary_[k]);
    }
    for (int k = 0; k < r; ++k) {
      int best = k;
      for (int i = k + 1; i < r; ++i) {
        if (std::abs(inverse_[i * r + k]) > std::abs(inverse_[best * r + k])) best = i;
      }
      pivot_[k] = best;
      if (std::abs(inverse_[best * r + k]) < 1e-12) return false;
      if (best != k) std::swap_ranges(&inverse_[k * r], &inverse_[k * r] + r, &inverse_[best * r]);
      const double scale = 1.0 / inverse_[k * r + k];
      inverse_[k * r + k] = 1.0;
      for (int c = 0; c < r; ++c) inverse_[k * r + c] *= scale;
      for (int i = 0; i < r; ++i) {
        if (i == k) continue;
        const double factor = inverse_[i * r + k];
        inverse_[i * r + k] = 0.0;
        for (int c = 0; c < r; ++c) inverse_[i * r + c] -= factor * inverse_[k * r + c];
      }
    }
    for (int k = r - 1; k >= 0; --k) {
      if (pivot_[k] == k) continue;
      for (int i = 0; i < r; ++i) std::swap(inverse_[i * r + k], inverse_[i * r + pivot_[k]]);
    }
    const int p = n_ - r;
    for (int i = 0; i < r; ++i) {
      for (int k = 0; k < p; ++k) {
        double sum = 0.0;
        for (int c = 0; c < r; ++c) sum += inverse_[i * r + c] * j(rows_[c], primary_[k]);
        dependence_[i * p + k] = sum;
      }
    }
    return true;
  }

  double worst_dependence() const {
    double worst = 0.0;
    for (int i = 0; i < rank_ * (n_ - rank_); ++i) worst = std::max(worst, std::abs(dependence_[i]));
    return worst;
  }

  // reduced_ = N^T K N, metric_ = N^T N = I + B^T B.
  void reduce() {
    const int p = n_ - rank_;
    largest_tangent_ = 0.0;
    for (double k : tangent_) largest_tangent_ = std::max(largest_tangent_, std::abs(k));
    for (int i = 0; i < n_; ++i) {
      for (int k = 0; k < p; ++k) {
        double sum = tangent_[i * n_ + primary_[k]];
        for (int c = 0; c < rank_; ++c) sum -= tangent_[i * n_ + ordinary_[c]] * dependence_[c * p + k];
        product_[i * p + k] = sum;
      }
    }
    for (int a = 0; a < p; ++a) {
      for (int b = 0; b < p; ++b) {
        double sum = product_[primary_[a] * p + b];
        double square = a == b ? 1.0 : 0.0;
        for (int c = 0; c < rank_; ++c) {
          sum -= dependence_[c * p + a] * product_[ordinary_[c] * p + b];
          square += dependence_[c * p + a] * dependence_[c * p + b];
        }
        reduced_[a * p + b] = sum;
        metric_[a * p + b] = square;
      }
    }
  }

  bool cholesky(double largest) {
    const int p = n_ - rank_;
    for (int k = 0; k < p; ++k) {
      double pivot = factors_[k * p + k];
      for (int c = 0; c < k; ++c) pivot -= factors_[k * p + c] * factors_[k * p + c];
      if (!(pivot > 1e-15 * largest)) return false;
      pivot = std::sqrt(pivot);
      factors_[k * p + k] = pivot;
      for (int i = k + 1; i < p; ++i) {
        double sum = factors_[i * p + k];
        for (int c = 0; c < k; ++c) sum -= factors_[i * p + c] * factors_[k * p + c];
        factors_[i * p + k] = sum / pivot;
      }
    }
    return true;
  }

  // LU with row pivoting for what is not positive definite.
  bool eliminate(double largest) {
    const int p = n_ - rank_;
    bool regular = true;
    for (int k = 0; k < p; ++k) {
      int best = k;
      for (int i = k + 1; i < p; ++i) {
        if (std::abs(factors_[i * p + k]) > std::abs(factors_[best * p + k])) best = i;
      }
      permutation_[k] = best;
      if (best != k) std::swap_ranges(&factors_[k * p], &factors_[k * p] + p, &factors_[best * p]);
      double& pivot = factors_[k * p + k];
      if (!(std::abs(pivot) > 1e-15 * largest)) {
        regular = false;
        pivot = std::max(1e-15 * largest, 1e-300);
      }
      for (int i = k + 1; i < p; ++i) {
        const double factor = factors_[i * p + k] /= pivot;
        for (int c = k + 1; c < p; ++c) factors_[i * p + c] -= factor * factors_[k * p + c];
      }
    }
    return regular;
  }

  void back_substitute(double* z) const {
    const int p = n_ - rank_;
    if (cholesky_) {
      for (int i = 0; i < p; ++i) {
        for (int c = 0; c < i; ++c) z[i] -= factors_[i * p + c] * z[c];
        z[i] /= factors_[i * p + i];
      }
      for (int i = p - 1; i >= 0; --i) {
        for (int c = i + 1; c < p; ++c) z[i] -= factors_[c * p + i] * z[c];
        z[i] /= factors_[i * p + i];
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

  int n_, m_;
  bool symmetric_;
  const Pattern& jacobian_pattern_;
  const Pattern& tangent_pattern_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_columns_, qr_rows_;
  Eigen::MatrixXd qr_matrix_, qr_transposed_;
  std::vector<char> last_active_;
  bool all_rows_used_ = false;
  bool cholesky_ = false;
  int rank_ = 0;
  double largest_tangent_ = 0.0;
  std::vector<int> ordinary_, primary_, rows_, pivot_, permutation_;
  std::vector<double> jacobian_, tangent_, inverse_, dependence_, product_, reduced_, metric_, factors_, normal_,
      right_;
};

}  // namespace

std::unique_ptr<Kkt> make_null_space(const Problem& problem) { return std::make_unique<NullSpace>(problem); }

}  // namespace poise::solvers
