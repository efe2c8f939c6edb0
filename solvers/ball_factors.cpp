#include "solvers/ball_factors.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "solvers/work_limit.hpp"

namespace poise::solvers {
namespace {

// Size up to which places are found in a table instead of a hash map.
constexpr int table_limit = 200;
// A pivot of one row is taken if it is at least this part of the largest entry of its row, so that entries grow little.
// It only decides how narrow the balls remain.
constexpr double large_enough = 0.01;
// A partner for a pivot of two rows may have an entry smaller than the largest by this factor if it causes less fill.
constexpr double worth_less_fill = 0.1;

// Products to eliminate a row with so many neighbours, in those of 128 bits.
double products_of(std::size_t neighbours) {
  const auto count = static_cast<double>(neighbours);
  return count * count * static_cast<double>(Ball::bits()) / 128.0;
}

}  // namespace

BallFactors::BallFactors(int size, bool symmetric, const std::vector<Entry>& entries)
    : size_(size), symmetric_(symmetric), diagonal_(size), around_(size), left_(size, 1) {
  if (size <= table_limit) table_.assign(static_cast<std::size_t>(size) * size, -1);
  places_.reserve(2 * entries.size());
  pivots_.reserve(size);
  for (const Entry& entry : entries) add(entry);
  regular_ = eliminate_all();
}

int BallFactors::find(int i, int j) const {
  if (i < j) std::swap(i, j);
  if (!table_.empty()) return table_[static_cast<std::size_t>(i) * size_ + j];
  const auto found = known_.find(static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j));
  return found == known_.end() ? -1 : found->second;
}

BallFactors::Place& BallFactors::place(int i, int j) {
  const int known = find(i, j);
  if (known >= 0) return places_[known];
  const int fresh = static_cast<int>(places_.size());
  if (i < j) std::swap(i, j);
  if (!table_.empty())
    table_[static_cast<std::size_t>(i) * size_ + j] = fresh;
  else
    known_.emplace(static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j), fresh);
  around_[i].push_back(j);
  around_[j].push_back(i);
  places_.push_back({i, j, {}, {}});
  return places_.back();
}

void BallFactors::add(const Entry& entry) {
  if (entry.row == entry.column) {
    diagonal_[entry.row] += entry.value;
    return;
  }
  Place& at = place(entry.row, entry.column);
  (symmetric_ || entry.row > entry.column ? at.below : at.above) += entry.value;
}

const Ball& BallFactors::at(int i, int j) const {
  if (i == j) return diagonal_[i];
  const int known = find(i, j);
  if (known < 0) return zero_;
  return symmetric_ || i > j ? places_[known].below : places_[known].above;
}

std::vector<int> BallFactors::neighbours(int k, int except) {
  std::vector<int>& all = around_[k];
  std::erase_if(all, [&](int i) { return left_[i] == 0; });
  std::vector<int> out = all;
  std::erase(out, except);
  return out;
}

bool BallFactors::is_large_enough(int k, const std::vector<int>& around) const {
  if (diagonal_[k].contains_zero()) return false;
  const double least = std::abs(diagonal_[k].middle()) / large_enough;
  return std::all_of(around.begin(), around.end(), [&](int i) {
    return std::abs(at(i, k).middle()) <= least && (symmetric_ || std::abs(at(k, i).middle()) <= least);
  });
}

int BallFactors::best_partner(int k, const std::vector<int>& around) {
  double largest = 0.0;
  for (const int i : around) largest = std::max(largest, std::abs(at(i, k).middle()));
  int best = -1;
  for (const int i : around) {
    if (std::abs(at(i, k).middle()) < worth_less_fill * largest) continue;
    if (best < 0 || around_[i].size() < around_[best].size()) best = i;
  }
  return best;
}

bool BallFactors::eliminate(int k) {
  const std::vector<int> around = neighbours(k, -1);
  if (is_large_enough(k, around)) return eliminate_with(k, -1, around);
  const int partner = best_partner(k, around);
  if (partner >= 0 && eliminate_with(k, partner, around)) return true;
  return !diagonal_[k].contains_zero() && eliminate_with(k, -1, around);
}

bool BallFactors::eliminate_with(int k, int partner, const std::vector<int>& around) {
  Pivot pivot{{k, partner}, partner < 0 ? 1 : 2, {}, {}};
  std::vector<int> rows = around;
  if (partner < 0) {
    if (!diagonal_[k].is_finite()) return false;
    pivot.inverse[0][0] = Ball(1) / diagonal_[k];
    if (diagonal_[k] < Ball(0)) {
      ++negative_;
      sign_ = -sign_;
    }
  } else {
    const Ball& a = diagonal_[k];
    const Ball& d = diagonal_[partner];
    const Ball& b = at(k, partner);
    const Ball& c = at(partner, k);
    const Ball determinant = a * d - b * c;
    if (determinant.contains_zero() || !determinant.is_finite()) return false;
    // A positive determinant leaves the signs of two eigenvalues to the diagonal.
    if (symmetric_ && determinant > Ball(0) && a.contains_zero() && d.contains_zero()) return false;
    pivot.inverse[0][0] = d / determinant;
    pivot.inverse[0][1] = -b / determinant;
    pivot.inverse[1][0] = -c / determinant;
    pivot.inverse[1][1] = a / determinant;
    if (determinant < Ball(0)) {
      ++negative_;
      sign_ = -sign_;
    } else if (a < Ball(0) || d < Ball(0)) {
      negative_ += 2;
    }
    rows = neighbours(partner, k);
    rows.insert(rows.end(), around.begin(), around.end());
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    std::erase(rows, partner);
  }
  left_[k] = 0;
  if (partner >= 0) left_[partner] = 0;
  pivot.others.resize(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Multiplier& m = pivot.others[r];
    m.row = rows[r];
    for (int p = 0; p < pivot.count; ++p) {
      for (int s = 0; s < pivot.count; ++s) {
        m.left.of[p] += at(m.row, pivot.rows[s]) * pivot.inverse[s][p];
        if (!symmetric_) m.right.of[p] += pivot.inverse[p][s] * at(pivot.rows[s], m.row);
      }
    }
  }
  update(pivot);
  pivots_.push_back(std::move(pivot));
  return true;
}

// A_ij -= A_ip D^-1 A_pj.
void BallFactors::update(const Pivot& pivot) {
  const std::vector<Multiplier>& others = pivot.others;
  std::vector<Pair> across(others.size());  // A_pj
  for (std::size_t j = 0; j < others.size(); ++j) {
    for (int p = 0; p < pivot.count; ++p) across[j].of[p] = at(pivot.rows[p], others[j].row);
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    for (int p = 0; p < pivot.count; ++p) {
      diagonal_[others[i].row].subtract_product(others[i].left.of[p], across[i].of[p]);
    }
    for (std::size_t j = 0; j < i; ++j) {
      Place& at_ij = place(others[i].row, others[j].row);
      const bool below = others[i].row > others[j].row;
      for (int p = 0; p < pivot.count; ++p) {
        (symmetric_ || below ? at_ij.below : at_ij.above).subtract_product(others[i].left.of[p], across[j].of[p]);
        if (!symmetric_) (below ? at_ij.above : at_ij.below).subtract_product(others[j].left.of[p], across[i].of[p]);
      }
    }
  }
}

bool BallFactors::eliminate_all() {
  using Candidate = std::pair<std::size_t, int>;  // number of neighbours, at least when it was entered, and row
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  for (int k = 0; k < size_; ++k) queue.emplace(around_[k].size(), k);
  std::vector<int> waiting;  // rows without a pivot until others are eliminated
  while (!queue.empty()) {
    const auto [degree, k] = queue.top();
    queue.pop();
    if (left_[k] == 0) continue;
    const std::size_t now = neighbours(k, -1).size();
    if (now > degree) {
      queue.emplace(now, k);
      continue;
    }
    if (now > 0 && !WorkLimit::allows(products_of(now))) return false;
    if (!eliminate(k)) {
      waiting.push_back(k);
      continue;
    }
    for (const int w : waiting) queue.emplace(around_[w].size(), w);
    waiting.clear();
  }
  return waiting.empty();
}

void BallFactors::solve(std::vector<Ball>& b) const {
  for (const Pivot& pivot : pivots_) {
    for (const Multiplier& m : pivot.others) {
      for (int p = 0; p < pivot.count; ++p) b[m.row].subtract_product(m.left.of[p], b[pivot.rows[p]]);
    }
  }
  for (auto pivot = pivots_.rbegin(); pivot != pivots_.rend(); ++pivot) {
    Ball x[2];
    for (int p = 0; p < pivot->count; ++p) {
      for (int s = 0; s < pivot->count; ++s) x[p] += pivot->inverse[p][s] * b[pivot->rows[s]];
    }
    for (const Multiplier& m : pivot->others) {
      const Pair& by = symmetric_ ? m.left : m.right;
      for (int p = 0; p < pivot->count; ++p) x[p].subtract_product(by.of[p], b[m.row]);
    }
    for (int p = 0; p < pivot->count; ++p) b[pivot->rows[p]] = x[p];
  }
}

}  // namespace poise::solvers
