// Sparse solution of the Newton system
//
//   [ K + shift I    J^T  ]
//   [ J             -e I  ]
//
// in two stages, both analysed once. Variables whose row of K has only its diagonal entry (the angles of a mechanism
// without springs) are eliminated first, each separately:
//
//   S = [ K_cc + shift I   J_c^T ]  -  sum over simple k of  j_k j_k^T / (K_kk + shift),   j_k = column k of J,
//       [ J_c              -e I  ]
//
// and what remains, the coupled variables c and the multipliers, is factored as LDL^T (solvers/sparse_ldl.hpp). For a
// hanging chain S is 2 x 2, for a ladder of loops it is banded. Inactive rows keep their place in the pattern with zero
// entries and the diagonal -1. The tiny e keeps pivots from vanishing where constraints are dependent; the callers
// solve for corrections, so its error vanishes with them. By Sylvester's law K + shift I is positive definite on the
// null space of J exactly when as many pivots are negative as there are constraint rows.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/kkt.hpp"
#include "solvers/sparse_ldl.hpp"

namespace poise::solvers {
namespace {

constexpr double relaxation = 1e-13;
constexpr double tiniest_pivot = 1e-13;  // relative to the largest diagonal entry of K
constexpr double refine_beyond = 1e7;    // ratio of the largest to the smallest pivot that calls for refinement
constexpr int step_refinements = 4;

class SparseKkt final : public Kkt {
 public:
  explicit SparseKkt(const Problem& problem)
      : n_(problem.variables()),
        m_(problem.constraints()),
        tangent_pattern_(problem.tangent_pattern()),
        jacobian_pattern_(problem.jacobian_pattern()) {
    const std::vector<int> simple = split_variables();
    sort_jacobian(simple);
    analyse(simple);
    active_.assign(m_, 1);
    jacobian_.assign(jacobian_pattern_.size(), 0.0);
    tangent_.assign(tangent_pattern_.size(), 0.0);
    pivot_.assign(n_ - coupled_.size(), 1.0);
    reduced_rhs_.assign(reduced_, 0.0);
    for (auto* v : {&rhs_, &residual_, &solution_}) v->assign(n_ + m_, 0.0);
  }

  bool set_jacobian(const Evaluation& at, const std::vector<char>& active) override {
    active_ = active;
    if (in_order_)
      std::copy(at.jacobian.begin(), at.jacobian.end(), jacobian_.begin());
    else
      for (int a = 0; a < jacobian_pattern_.size(); ++a) jacobian_[a] = at.jacobian[source_[a]];
    if (std::find(active_.begin(), active_.end(), 0) == active_.end()) return true;
    for (int a = 0; a < jacobian_pattern_.size(); ++a) {
      if (!active_[row_of(a)]) jacobian_[a] = 0.0;
    }
    return true;
  }

  bool redundant() const override { return false; }

  bool determines_multipliers() const override { return false; }

  void multipliers(std::span<const double> field, std::span<double> y) override {
    factor_identity();
    solve(field, {});
    solved_multipliers(field, y);
  }

  void balance(std::span<const double> field, std::span<double> y, std::span<double> residual) override {
    multipliers(field, y);
    unbalanced(field, y, residual);
  }

  void unbalanced(std::span<const double> field, std::span<const double> y, std::span<double> out) const override {
    std::copy(field.begin(), field.end(), out.begin());
    for (int a = 0; a < jacobian_pattern_.size(); ++a) out[column_of(a)] += jacobian_[a] * y[row_of(a)];
  }

  Factors factor_tangent(std::span<const double> values) override {
    std::copy(values.begin(), values.end(), tangent_.begin());
    return factor_shifted(0.0);
  }

  Factors factor_identity() override {
    std::fill(tangent_.begin(), tangent_.end(), 0.0);
    std::fill(tangent_.begin(), tangent_.begin() + n_, 1.0);
    return factor_shifted(0.0);
  }

  Factors factor_shifted(double shift) override {
    shift_ = shift;
    double largest = 0.0;
    for (int i = 0; i < n_; ++i) largest = std::max(largest, std::abs(tangent_[i] + shift));
    const double floor = tiniest_pivot * std::max(largest, 1e-300);
    std::vector<double>& value = factors_.values();
    std::fill(value.begin(), value.end(), 0.0);
    for (const Copy& c : coupled_tangent_) value[c.target] += tangent_[c.source];
    for (int a = first_coupled_; a < jacobian_pattern_.size(); ++a)
      value[coupled_jacobian_[a - first_coupled_]] += jacobian_[a];
    for (int target : coupled_diagonal_) value[target] += shift;
    for (int r = 0; r < m_; ++r) value[row_diagonal_[r]] += active_[r] ? -relaxation : -1.0;
    double smallest = std::numeric_limits<double>::infinity();
    negative_ = 0;
    const double* column = jacobian_.data();
    double* pivot = pivot_.data();
    for (const ColumnGroup& group : groups_) {
      for (int i = group.variable; i < group.variable + group.count; ++i, column += group.size) {
        double h = tangent_[i] + shift;
        if (std::abs(h) < floor) h = h < 0 ? -floor : floor;
        smallest = std::min(smallest, std::abs(h));
        negative_ += h < 0;
        const double inverse = 1.0 / h;
        *pivot++ = inverse;
        const int* target = pair_target_.data() + group.pairs;
        for (int k = 0; k < group.size; ++k) {
          const double weighted = column[k] * inverse;
          for (int l = 0; l <= k; ++l) value[*target++] -= weighted * column[l];
        }
      }
    }
    if (!factors_.factor()) return Factors::singular;
    negative_ += factors_.negative();
    refine_ = largest > refine_beyond * smallest || factors_.spread() > refine_beyond;
    return negative_ == m_ ? Factors::positive : Factors::indefinite;
  }

  // Negative eigenvalues of K + shift I on the null space of J, after it was factored.
  int negative_directions() const { return negative_ - m_; }

  void solve(std::span<const double> field, std::span<const double> c, std::span<double> d) override {
    solve(field, c);
    std::copy(solution_.begin(), solution_.begin() + n_, d.begin());
  }

  void solved_multipliers(std::span<const double>, std::span<double> y) override {
    std::copy(solution_.begin() + n_, solution_.end(), y.begin());
  }

  void restore(std::span<const double> c, std::span<double> d) override { solve({}, c, d); }

 private:
  struct Copy {
    int source, target;
  };

  // Consecutive simple variables whose columns of J have `size` entries each, all in the same rows: where those rows,
  // and the targets of the products of a column's entries, begin.
  struct ColumnGroup {
    int variable, count, size, rows, pairs;
  };

  // Coupled variables have an off-diagonal entry in K; returns the others, the simple ones.
  std::vector<int> split_variables() {
    std::vector<char> coupled(n_, 0);
    for (int e = n_; e < tangent_pattern_.size(); ++e) {
      if (tangent_pattern_.row[e] == tangent_pattern_.column[e]) continue;
      coupled[tangent_pattern_.row[e]] = coupled[tangent_pattern_.column[e]] = 1;
    }
    const auto number = std::count(coupled.begin(), coupled.end(), 1);
    std::vector<int> simple;
    simple.reserve(n_ - number);
    coupled_.reserve(number);
    for (int i = 0; i < n_; ++i) (coupled[i] ? coupled_ : simple).push_back(i);
    reduced_ = static_cast<int>(coupled_.size()) + m_;
    return simple;
  }

  // Entries of J by columns, those of the simple variables first.
  void sort_jacobian(const std::vector<int>& simple) {
    std::vector<int> next(n_, 0);
    for (int j : jacobian_pattern_.column) ++next[j];
    int first = 0;
    for (int j : simple) first += std::exchange(next[j], first);
    first_coupled_ = first;
    for (int j : coupled_) first += std::exchange(next[j], first);
    source_.resize(jacobian_pattern_.size());
    for (int e = 0; e < jacobian_pattern_.size(); ++e) {
      source_[next[jacobian_pattern_.column[e]]++] = e;
    }
    in_order_ = std::is_sorted(source_.begin(), source_.end());
  }

  int row_of(int a) const { return jacobian_pattern_.row[source_[a]]; }
  int column_of(int a) const { return jacobian_pattern_.column[source_[a]]; }
  int place_of_row(int r) const { return reduced_ - m_ + r; }

  // The rows of every simple column, the pattern of S, its ordering, and where every contribution goes.
  void analyse(const std::vector<int>& simple) {
    std::vector<int> row, column;  // entries of S, in either triangle
    const auto add = [&](int i, int j) {
      row.push_back(i);
      column.push_back(j);
      return static_cast<int>(row.size()) - 1;
    };
    list_groups(simple, add);
    const auto pairs = static_cast<std::ptrdiff_t>(row.size());
    std::vector<int> place(n_, -1);  // of the coupled variables in S
    for (int k = 0; k < reduced_ - m_; ++k) place[coupled_[k]] = k;
    for (int e = 0; e < tangent_pattern_.size(); ++e) {
      const int i = place[tangent_pattern_.row[e]];
      if (i >= 0) coupled_tangent_.push_back({e, add(i, place[tangent_pattern_.column[e]])});
    }
    for (int a = first_coupled_; a < jacobian_pattern_.size(); ++a) {
      coupled_jacobian_.push_back(add(place_of_row(row_of(a)), place[column_of(a)]));
    }
    for (int i : coupled_) coupled_diagonal_.push_back(add(place[i], place[i]));
    for (int r = 0; r < m_; ++r) row_diagonal_.push_back(add(place_of_row(r), place_of_row(r)));

    factors_.analyse(reduced_, row, column);
    pair_target_.assign(row.begin(), row.begin() + pairs);
    for (Copy& c : coupled_tangent_) c.target = row[c.target];
    for (auto* targets : {&coupled_jacobian_, &coupled_diagonal_, &row_diagonal_}) {
      for (int& t : *targets) t = row[t];
    }
  }

  template <class Add>
  void list_groups(const std::vector<int>& simple, Add add) {
    int begin = 0;
    for (int i : simple) {
      int end = begin;
      while (end < jacobian_pattern_.size() && column_of(end) == i) ++end;
      const int size = end - begin;
      if (!has_rows_of_last_group(begin, size)) {
        groups_.push_back({i, 0, size, static_cast<int>(row_.size()), 0});
        add_products(begin, end, add);
      } else if (i != groups_.back().variable + groups_.back().count) {
        const ColumnGroup& last = groups_.back();
        groups_.push_back({i, 0, size, last.rows, last.pairs});
      }
      ++groups_.back().count;
      begin = end;
    }
  }

  bool has_rows_of_last_group(int begin, int size) const {
    if (groups_.empty() || groups_.back().size != size) return false;
    for (int k = 0; k < size; ++k) {
      if (row_[groups_.back().rows + k] != row_of(begin + k)) return false;
    }
    return true;
  }

  // The rows of a new group and, of each of its columns, the products of all pairs of entries.
  template <class Add>
  void add_products(int begin, int end, Add add) {
    for (int a = begin; a < end; ++a) {
      row_.push_back(row_of(a));
      for (int b = begin; b <= a; ++b) {
        const int number = add(place_of_row(row_of(a)), place_of_row(row_of(b)));
        if (a == begin) groups_.back().pairs = number;
      }
    }
  }

  void solve(std::span<const double> field, std::span<const double> c) {
    for (int i = 0; i < n_; ++i) rhs_[i] = !field.empty() ? -field[i] : 0.0;
    for (int r = 0; r < m_; ++r) rhs_[n_ + r] = !c.empty() && active_[r] ? -c[r] : 0.0;
    back_substitute(rhs_, solution_);
    if (refine_) refine();
  }

  // Solves with the last factors; x may be the right-hand side itself.
  void back_substitute(const std::vector<double>& right, std::vector<double>& x) {
    const int coupled = static_cast<int>(coupled_.size());
    for (int i = 0; i < coupled; ++i) reduced_rhs_[i] = right[coupled_[i]];
    std::copy(right.begin() + n_, right.end(), reduced_rhs_.begin() + coupled);
    double* rows = reduced_rhs_.data() + coupled;
    const double* column = jacobian_.data();
    const double* pivot = pivot_.data();
    for (const ColumnGroup& group : groups_) {
      const int* row = row_.data() + group.rows;
      for (int i = group.variable; i < group.variable + group.count; ++i, column += group.size) {
        const double weighted = *pivot++ * right[i];
        for (int k = 0; k < group.size; ++k) rows[row[k]] -= column[k] * weighted;
      }
    }
    factors_.solve(reduced_rhs_);
    for (int i = 0; i < coupled; ++i) x[coupled_[i]] = reduced_rhs_[i];
    column = jacobian_.data();
    pivot = pivot_.data();
    for (const ColumnGroup& group : groups_) {
      const int* row = row_.data() + group.rows;
      for (int i = group.variable; i < group.variable + group.count; ++i, column += group.size) {
        double sum = right[i];
        for (int k = 0; k < group.size; ++k) sum -= column[k] * rows[row[k]];
        x[i] = *pivot++ * sum;
      }
    }
    std::copy(rows, rows + m_, x.begin() + n_);
  }

  void refine() {
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < step_refinements; ++k) {
      const double error = residual();
      if (error < 1e-15 || !(error < 0.5 * last)) break;
      last = error;
      back_substitute(residual_, residual_);
      for (int i = 0; i < n_ + m_; ++i) solution_[i] += residual_[i];
    }
  }

  // residual_ = rhs - system solution, with e = 0; its largest entry.
  double residual() {
    residual_ = rhs_;
    for (int i = 0; i < n_; ++i) residual_[i] -= (tangent_[i] + shift_) * solution_[i];
    for (int e = n_; e < tangent_pattern_.size(); ++e) {
      const int i = tangent_pattern_.row[e];
      const int j = tangent_pattern_.column[e];
      residual_[i] -= tangent_[e] * solution_[j];
      residual_[j] -= tangent_[e] * solution_[i];
    }
    for (int a = 0; a < jacobian_pattern_.size(); ++a) {
      const int r = n_ + row_of(a);
      const int j = column_of(a);
      residual_[r] -= jacobian_[a] * solution_[j];
      residual_[j] -= jacobian_[a] * solution_[r];
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
  std::vector<int> coupled_;
  std::vector<int> source_;       // entries of J by columns, the simple variables' first: where the problem has them
  std::vector<double> jacobian_;  // in that order
  std::vector<double> tangent_;
  int first_coupled_ = 0;  // entry of a coupled variable
  bool in_order_ = false;  // source_[a] = a
  std::vector<ColumnGroup> groups_;
  std::vector<int> row_, pair_target_;
  std::vector<Copy> coupled_tangent_;
  std::vector<int> coupled_jacobian_, coupled_diagonal_, row_diagonal_;
  std::vector<double> pivot_;  // inverse pivots of the simple variables
  SparseLdl factors_;
  std::vector<double> rhs_, residual_, solution_, reduced_rhs_;
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
  kkt.multipliers(at.gradient, multipliers);
  problem.tangent(at, multipliers, tangent);

  Inertia inertia;
  inertia.known = kkt.factor_tangent(tangent) != Kkt::Factors::singular;
  inertia.negative = kkt.negative_directions();
  return inertia;
}

}  // namespace poise::solvers
