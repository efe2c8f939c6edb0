// Sparse solution of the Newton system
//
//   [ K + shift I    J^T  ]
//   [ J             -e I  ]
//
// in two stages, both analysed once. Variables whose row of K is nothing but its diagonal (the angles of a mechanism
// without springs) are eliminated first, each on its own:
//
//   S = [ K_cc + shift I   J_c^T ]  -  sum over simple k of  j_k j_k^T / (K_kk + shift),   j_k = column k of J,
//       [ J_c              -e I  ]
//
// and what remains, the coupled variables c and the multipliers, is factored as LDL^T (SuiteSparse AMD and LDL). For a
// hanging chain S is 2 x 2, for a ladder of loops it is banded. Rows switched off keep their place in the pattern with
// zero entries and the diagonal -1. The tiny e keeps pivots from vanishing where constraints repeat each other; the
// callers solve for corrections, so what it costs vanishes with them. By Sylvester's law K + shift I is positive
// definite on the null space of J exactly when as many pivots are negative as there are constraint rows.

extern "C" {
#include <amd.h>
#include <ldl.h>
}

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "solvers/kkt.hpp"

namespace poise::solvers {
namespace {

constexpr double relaxation = 1e-13;
constexpr double tiniest_pivot = 1e-13;  // of the largest diagonal entry of K
constexpr double refine_beyond = 1e7;    // ratio of the largest to the smallest pivot that calls for refinement
constexpr int refinements = 4;

class SparseKkt final : public Kkt {
 public:
  explicit SparseKkt(const Problem& problem)
      : n_(problem.variables()),
        m_(problem.constraints()),
        tangent_pattern_(problem.tangent_pattern()),
        jacobian_pattern_(problem.jacobian_pattern()) {
    split_variables();
    analyse();
    active_.assign(m_, 1);
    jacobian_.assign(jacobian_pattern_.size(), 0.0);
    tangent_.assign(tangent_pattern_.size(), 0.0);
    pivot_.assign(simple_.size(), 1.0);
    for (auto* v : {&rhs_, &residual_, &solution_, &correction_}) v->assign(n_ + m_, 0.0);
  }

  void set_jacobian(const Evaluation& at, const std::vector<char>& active) override {
    active_ = active;
    jacobian_ = at.jacobian;
    if (std::find(active_.begin(), active_.end(), 0) == active_.end()) return;
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      if (!active_[jacobian_pattern_.row[e]]) jacobian_[e] = 0.0;
    }
  }

  bool redundant() const override { return false; }

  bool multipliers(const double*, double*) override { return false; }

  void least_squares_multipliers(const double* field, double* y) override {
    set_identity();
    factor(0.0);
    solve(field, nullptr, unused_step_.data(), y);
  }

  void set_tangent(const double* values) override { std::copy(values, values + tangent_.size(), tangent_.begin()); }

  void set_identity() override {
    std::fill(tangent_.begin(), tangent_.end(), 0.0);
    std::fill(tangent_.begin(), tangent_.begin() + n_, 1.0);
  }

  Factors factor(double shift) override {
    shift_ = shift;
    double largest = 0.0;
    for (int i = 0; i < n_; ++i) largest = std::max(largest, std::abs(tangent_[i] + shift));
    const double floor = tiniest_pivot * std::max(largest, 1e-300);
    std::fill(value_.begin(), value_.end(), 0.0);
    for (const Copy& c : coupled_tangent_) value_[c.target] += tangent_[c.source];
    for (const Copy& c : coupled_jacobian_) value_[c.target] += jacobian_[c.source];
    for (int target : coupled_diagonal_) value_[target] += shift;
    for (int r = 0; r < m_; ++r) value_[row_diagonal_[r]] += active_[r] ? -relaxation : -1.0;
    double smallest = std::numeric_limits<double>::infinity();
    negative_ = 0;
    for (std::size_t s = 0; s < simple_.size(); ++s) {
      double h = tangent_[simple_[s]] + shift;
      if (std::abs(h) < floor) h = h < 0 ? -floor : floor;
      smallest = std::min(smallest, std::abs(h));
      negative_ += h < 0;
      const double inverse = 1.0 / h;
      pivot_[s] = inverse;
      const int* target = pair_target_.data() + pair_first_[s];
      for (int a = column_first_[s]; a < column_first_[s + 1]; ++a) {
        const double weighted = jacobian_[column_entry_[a]] * inverse;
        for (int b = column_first_[s]; b <= a; ++b) value_[*target++] -= weighted * jacobian_[column_entry_[b]];
      }
    }
    const int done = ldl_numeric(reduced_, first_.data(), index_.data(), value_.data(), l_first_.data(), parent_.data(),
                                 l_count_.data(), l_index_.data(), l_value_.data(), d_.data(), work_.data(),
                                 stack_.data(), flag_.data(), nullptr, nullptr);
    if (done != reduced_) return Factors::singular;
    for (double d : d_) {
      if (!std::isfinite(d)) return Factors::singular;
      negative_ += d < 0;
    }
    refine_ = largest > refine_beyond * smallest || !coupled_diagonal_.empty();
    return negative_ == m_ ? Factors::positive : Factors::indefinite;
  }

  // Negative eigenvalues of K + shift I on the null space of J, after factor().
  int negative_directions() const { return negative_ - m_; }

  void solve(const double* field, const double* c, double* d, double* y) override {
    for (int i = 0; i < n_; ++i) rhs_[i] = field != nullptr ? -field[i] : 0.0;
    for (int r = 0; r < m_; ++r) rhs_[n_ + r] = c != nullptr && active_[r] ? -c[r] : 0.0;
    back_substitute(rhs_, solution_);
    if (refine_) refine();
    std::copy(solution_.begin(), solution_.begin() + n_, d);
    if (y != nullptr) std::copy(solution_.begin() + n_, solution_.end(), y);
  }

  void restore(const double* c, double* d) override { solve(nullptr, c, d, nullptr); }

 private:
  struct Copy {
    int source, target;
  };

  // Simple variables have no off-diagonal entry in K.
  void split_variables() {
    std::vector<char> coupled(n_, 0);
    for (std::size_t e = n_; e < tangent_pattern_.size(); ++e) {
      if (tangent_pattern_.row[e] == tangent_pattern_.column[e]) continue;
      coupled[tangent_pattern_.row[e]] = coupled[tangent_pattern_.column[e]] = 1;
    }
    place_.assign(n_, -1);  // in the reduced system
    for (int i = 0; i < n_; ++i) {
      if (coupled[i]) {
        place_[i] = static_cast<int>(coupled_.size());
        coupled_.push_back(i);
      } else {
        simple_.push_back(i);
      }
    }
    reduced_ = static_cast<int>(coupled_.size()) + m_;
  }

  int place_of_row(int r) const { return static_cast<int>(coupled_.size()) + r; }

  // Columns of J by simple variable, pattern of S, its ordering, and where every contribution goes.
  void analyse() {
    std::vector<std::vector<int>> column(n_);
    for (std::size_t e = 0; e < jacobian_pattern_.size(); ++e) {
      column[jacobian_pattern_.column[e]].push_back(static_cast<int>(e));
    }
    std::vector<std::pair<int, int>> entries;  // (row, column) of S, unordered places
    column_first_.push_back(0);
    for (int k : simple_) {
      pair_first_.push_back(static_cast<int>(entries.size()));
      for (std::size_t a = 0; a < column[k].size(); ++a) {
        column_entry_.push_back(column[k][a]);
        column_row_.push_back(jacobian_pattern_.row[column[k][a]]);
        for (std::size_t b = 0; b <= a; ++b) {
          entries.emplace_back(place_of_row(jacobian_pattern_.row[column[k][a]]),
                               place_of_row(jacobian_pattern_.row[column[k][b]]));
        }
      }
      column_first_.push_back(static_cast<int>(column_entry_.size()));
    }
    const std::size_t pairs = entries.size();
    for (std::size_t e = 0; e < tangent_pattern_.size(); ++e) {
      const int i = place_[tangent_pattern_.row[e]];
      const int j = place_[tangent_pattern_.column[e]];
      if (i < 0) continue;
      coupled_tangent_.push_back({static_cast<int>(e), static_cast<int>(entries.size())});
      entries.emplace_back(i, j);
    }
    for (std::size_t e = 0; e < jacobian_pattern_.size(); ++e) {
      const int j = place_[jacobian_pattern_.column[e]];
      if (j < 0) continue;
      coupled_jacobian_.push_back({static_cast<int>(e), static_cast<int>(entries.size())});
      entries.emplace_back(place_of_row(jacobian_pattern_.row[e]), j);
    }
    for (int i : coupled_) {
      coupled_diagonal_.push_back(static_cast<int>(entries.size()));
      entries.emplace_back(place_[i], place_[i]);
    }
    for (int r = 0; r < m_; ++r) {
      row_diagonal_.push_back(static_cast<int>(entries.size()));
      entries.emplace_back(place_of_row(r), place_of_row(r));
    }
    const std::vector<int> target = order_and_compress(entries);
    pair_target_.assign(target.begin(), target.begin() + static_cast<std::ptrdiff_t>(pairs));
    for (Copy& c : coupled_tangent_) c.target = target[c.target];
    for (Copy& c : coupled_jacobian_) c.target = target[c.target];
    for (int& t : coupled_diagonal_) t = target[t];
    for (int& t : row_diagonal_) t = target[t];

    l_first_.resize(reduced_ + 1);
    for (auto* v : {&parent_, &l_count_, &stack_, &flag_}) v->resize(reduced_);
    ldl_symbolic(reduced_, first_.data(), index_.data(), l_first_.data(), parent_.data(), l_count_.data(), flag_.data(),
                 nullptr, nullptr);
    l_index_.resize(std::max(l_first_[reduced_], 1));
    l_value_.resize(l_index_.size());
    for (auto* v : {&d_, &work_, &reduced_rhs_}) v->resize(reduced_);
    unused_step_.resize(n_);
  }

  // Merges entries, orders S by AMD, stores its permuted upper triangle by columns. Returns for every entry its place
  // among the values.
  std::vector<int> order_and_compress(const std::vector<std::pair<int, int>>& entries) {
    std::vector<std::uint64_t> key;
    key.reserve(entries.size());
    const auto pack = [](int i, int j) {
      return static_cast<std::uint64_t>(std::max(i, j)) << 32 | static_cast<std::uint32_t>(std::min(i, j));
    };
    for (const auto& [i, j] : entries) key.push_back(pack(i, j));
    std::vector<std::uint64_t> unique = key;
    std::sort(unique.begin(), unique.end());
    unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
    const auto row = [](std::uint64_t k) { return static_cast<int>(k >> 32); };
    const auto col = [](std::uint64_t k) { return static_cast<int>(k & 0xffffffffU); };

    const auto by_columns = [&](const std::vector<int>& place, std::vector<int>& first, std::vector<int>& index,
                                std::vector<int>& where) {
      first.assign(reduced_ + 1, 0);
      const auto last = [&](std::uint64_t k) { return std::max(place[row(k)], place[col(k)]); };
      for (std::uint64_t k : unique) ++first[last(k) + 1];
      for (int i = 0; i < reduced_; ++i) first[i + 1] += first[i];
      std::vector<int> next(first.begin(), first.end() - 1);
      index.resize(unique.size());
      where.resize(unique.size());
      for (std::size_t u = 0; u < unique.size(); ++u) {
        where[u] = next[last(unique[u])]++;
        index[where[u]] = std::min(place[row(unique[u])], place[col(unique[u])]);
      }
    };
    std::vector<int> place(reduced_), where, first, index;
    for (int i = 0; i < reduced_; ++i) place[i] = i;
    by_columns(place, first, index, where);
    order_.resize(reduced_);
    std::vector<double> control(AMD_CONTROL), info(AMD_INFO);
    amd_defaults(control.data());
    amd_order(reduced_, first.data(), index.data(), order_.data(), control.data(), info.data());
    for (int k = 0; k < reduced_; ++k) place[order_[k]] = k;
    by_columns(place, first_, index_, where);
    value_.assign(unique.size(), 0.0);
    std::vector<int> target;
    target.reserve(entries.size());
    for (std::uint64_t k : key) {
      target.push_back(where[std::lower_bound(unique.begin(), unique.end(), k) - unique.begin()]);
    }
    return target;
  }

  void back_substitute(const std::vector<double>& right, std::vector<double>& x) {
    const int coupled = static_cast<int>(coupled_.size());
    // work_ holds the right side of S, later its solution, in unpermuted order.
    for (int i = 0; i < coupled; ++i) work_[i] = right[coupled_[i]];
    std::copy(right.begin() + n_, right.end(), work_.begin() + coupled);
    for (std::size_t s = 0; s < simple_.size(); ++s) {
      const double weighted = pivot_[s] * right[simple_[s]];
      for (int a = column_first_[s]; a < column_first_[s + 1]; ++a) {
        work_[coupled + column_row_[a]] -= jacobian_[column_entry_[a]] * weighted;
      }
    }
    for (int k = 0; k < reduced_; ++k) reduced_rhs_[k] = work_[order_[k]];
    ldl_lsolve(reduced_, reduced_rhs_.data(), l_first_.data(), l_index_.data(), l_value_.data());
    ldl_dsolve(reduced_, reduced_rhs_.data(), d_.data());
    ldl_ltsolve(reduced_, reduced_rhs_.data(), l_first_.data(), l_index_.data(), l_value_.data());
    for (int k = 0; k < reduced_; ++k) work_[order_[k]] = reduced_rhs_[k];
    for (int i = 0; i < coupled; ++i) x[coupled_[i]] = work_[i];
    for (int r = 0; r < m_; ++r) x[n_ + r] = work_[coupled + r];
    for (std::size_t s = 0; s < simple_.size(); ++s) {
      double sum = right[simple_[s]];
      for (int a = column_first_[s]; a < column_first_[s + 1]; ++a) {
        sum -= jacobian_[column_entry_[a]] * work_[coupled + column_row_[a]];
      }
      x[simple_[s]] = pivot_[s] * sum;
    }
    std::fill(work_.begin(), work_.end(), 0.0);  // as ldl_numeric expects it
  }

  void refine() {
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < refinements; ++k) {
      const double error = residual();
      if (error < 1e-15 || !(error < 0.5 * last)) break;
      last = error;
      back_substitute(residual_, correction_);
      for (int i = 0; i < n_ + m_; ++i) solution_[i] += correction_[i];
    }
  }

  // residual_ = rhs - system solution, with e = 0; its largest entry.
  double residual() {
    residual_ = rhs_;
    for (std::size_t e = 0; e < tangent_.size(); ++e) {
      const int i = tangent_pattern_.row[e];
      const int j = tangent_pattern_.column[e];
      residual_[i] -= tangent_[e] * solution_[j];
      if (i != j) residual_[j] -= tangent_[e] * solution_[i];
    }
    for (int i = 0; i < n_; ++i) residual_[i] -= shift_ * solution_[i];
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      const int r = n_ + jacobian_pattern_.row[e];
      const int j = jacobian_pattern_.column[e];
      residual_[r] -= jacobian_[e] * solution_[j];
      residual_[j] -= jacobian_[e] * solution_[r];
    }
    double worst = 0.0;
    for (int r = 0; r < m_; ++r) {
      if (!active_[r]) residual_[n_ + r] = 0.0;
    }
    for (double r : residual_) worst = std::max(worst, std::abs(r));
    return worst;
  }

  int n_, m_;
  int reduced_ = 0;  // size of S
  const Pattern& tangent_pattern_;
  const Pattern& jacobian_pattern_;
  double shift_ = 0.0;
  int negative_ = 0;
  bool refine_ = false;
  std::vector<char> active_;
  std::vector<double> jacobian_, tangent_;
  std::vector<int> simple_, coupled_, place_;
  std::vector<int> column_first_, column_entry_, column_row_, pair_first_, pair_target_;
  std::vector<Copy> coupled_tangent_, coupled_jacobian_;
  std::vector<int> coupled_diagonal_, row_diagonal_;
  std::vector<double> pivot_;  // inverse pivots of the simple variables
  std::vector<int> order_, first_, index_;
  std::vector<int> l_first_, parent_, l_count_, l_index_, stack_, flag_;
  std::vector<double> value_, l_value_, d_, work_, reduced_rhs_;
  std::vector<double> rhs_, residual_, solution_, correction_, unused_step_;
};

}  // namespace

std::unique_ptr<Kkt> make_sparse_kkt(const Problem& problem) { return std::make_unique<SparseKkt>(problem); }

Inertia inertia_at(const Problem& problem, const std::vector<double>& x, const std::vector<char>& active) {
  SparseKkt kkt(problem);
  Evaluation at = problem.make_evaluation();
  at.x = x;
  problem.evaluate(at);
  std::vector<double> multipliers(problem.constraints()), tangent(problem.tangent_pattern().size());
  kkt.set_jacobian(at, active);
  kkt.least_squares_multipliers(at.gradient.data(), multipliers.data());
  problem.tangent(at, multipliers.data(), tangent.data());
  kkt.set_tangent(tangent.data());
  Inertia inertia;
  inertia.known = kkt.factor(0.0) != Kkt::Factors::singular;
  inertia.negative = kkt.negative_directions();
  return inertia;
}

}  // namespace poise::solvers
