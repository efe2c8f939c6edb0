#include "solvers/sparse_ldl.hpp"

extern "C" {
#include <amd.h>
#include <ldl.h>
}

#include <algorithm>
#include <cmath>
#include <numeric>

namespace poise::solvers {
namespace {

// Frees the memory too.
template <class T>
void discard(std::vector<T>& v) {
  std::vector<T>().swap(v);
}

// Turns counts behind their place, count[i + 1], into where each begins.
void add_up(std::vector<int>& count) { std::partial_sum(count.begin(), count.end(), count.begin()); }

}  // namespace

void SparseLdl::analyse(int size, std::vector<int>& row, std::vector<int>& column) {
  size_ = size;
  // Entries sorted into columns of the upper triangle, still as often as they were given.
  std::vector<int> first(size + 1, 0);
  for (std::size_t e = 0; e < row.size(); ++e) {
    if (row[e] > column[e]) std::swap(row[e], column[e]);
    ++first[column[e] + 1];
  }
  add_up(first);
  std::vector<int> bucket(row.size());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (std::size_t e = 0; e < row.size(); ++e) {
    const int place = next[column[e]]++;
    bucket[place] = row[e];
    row[e] = place;
  }
  discard(column);
  // Duplicates get one place.
  std::vector<int> index;
  std::vector<int> seen(size, -1);  // per row: its place in the current column, or an earlier one
  int begin = 0;
  for (int j = 0; j < size; ++j) {
    const int end = first[j + 1];
    first[j] = static_cast<int>(index.size());
    for (int place = begin; place < end; ++place) {
      int& at = seen[bucket[place]];
      if (at < first[j]) {
        at = static_cast<int>(index.size());
        index.push_back(bucket[place]);
      }
      bucket[place] = at;
    }
    begin = end;
  }
  first[size] = static_cast<int>(index.size());
  for (int& e : row) e = bucket[e];
  discard(bucket);
  discard(seen);
  discard(next);
  order(first, index);
  const std::vector<int> where = permute(first, index);
  for (int& e : row) e = where[e];
  find_fill();
}

void SparseLdl::order(const std::vector<int>& first, std::vector<int>& index) {
  order_.resize(size_);
  double control[AMD_CONTROL], info[AMD_INFO];
  amd_defaults(control);
  // Columns need not be sorted: AMD reports that in its return value and continues.
  amd_order(size_, first.data(), index.data(), order_.data(), control, info);
}

// Stores the permuted upper triangle by columns; returns where each entry has gone.
std::vector<int> SparseLdl::permute(const std::vector<int>& first, const std::vector<int>& index) {
  std::vector<int> place(size_);
  for (int k = 0; k < size_; ++k) place[order_[k]] = k;
  first_.assign(size_ + 1, 0);
  for (int j = 0; j < size_; ++j) {
    for (int u = first[j]; u < first[j + 1]; ++u) ++first_[std::max(place[index[u]], place[j]) + 1];
  }
  add_up(first_);
  std::vector<int> next(first_.begin(), first_.end() - 1);
  std::vector<int> where(index.size());
  index_.resize(index.size());
  for (int j = 0; j < size_; ++j) {
    for (int u = first[j]; u < first[j + 1]; ++u) {
      where[u] = next[std::max(place[index[u]], place[j])]++;
      index_[where[u]] = std::min(place[index[u]], place[j]);
    }
  }
  value_.assign(index.size(), 0.0);
  return where;
}

void SparseLdl::find_fill() {
  l_first_.resize(size_ + 1);
  for (auto* v : {&parent_, &l_count_, &stack_, &flag_}) v->resize(size_);
  ldl_symbolic(size_, first_.data(), index_.data(), l_first_.data(), parent_.data(), l_count_.data(), flag_.data(),
               nullptr, nullptr);
  l_index_.resize(std::max(l_first_[size_], 1));
  l_value_.resize(l_index_.size());
  d_.resize(size_);
  work_.resize(size_);
}

bool SparseLdl::factor() {
  std::fill(work_.begin(), work_.end(), 0.0);  // as ldl_numeric expects it
  const int done = ldl_numeric(size_, first_.data(), index_.data(), value_.data(), l_first_.data(), parent_.data(),
                               l_count_.data(), l_index_.data(), l_value_.data(), d_.data(), work_.data(),
                               stack_.data(), flag_.data(), nullptr, nullptr);
  negative_ = static_cast<int>(std::count_if(d_.begin(), d_.end(), [](double d) { return d < 0; }));
  const auto [least, most] =
      std::minmax_element(d_.begin(), d_.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  spread_ = d_.empty() ? 1.0 : std::abs(*most) / std::abs(*least);
  return done == size_ && std::all_of(d_.begin(), d_.end(), [](double d) { return std::isfinite(d); });
}

void SparseLdl::solve(std::vector<double>& x) {
  for (int k = 0; k < size_; ++k) work_[k] = x[order_[k]];
  ldl_lsolve(size_, work_.data(), l_first_.data(), l_index_.data(), l_value_.data());
  ldl_dsolve(size_, work_.data(), d_.data());
  ldl_ltsolve(size_, work_.data(), l_first_.data(), l_index_.data(), l_value_.data());
  for (int k = 0; k < size_; ++k) x[order_[k]] = work_[k];
}

}  // namespace poise::solvers
