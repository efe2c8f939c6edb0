#include "statics/many/private/step_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace poise {
namespace {

constexpr double least_part_of_pivot = 1e-3;  // of that at the answer of the scene as it is
constexpr double least_rank_pivot = 1e-9;     // of the first pivot, below which rows repeat others
constexpr double candidate_part = 0.1;        // of the largest entry, from which on a pivot may be chosen
constexpr double still_closed = 1e-8;         // gap of rows that repeat others, before a last step of 1e-9
constexpr double least_part_of_pressing = 1e-3;
constexpr double clear_of_stops = 1e-8;   // rad or sizes
constexpr double touching = 1e-9;         // as of ActiveSetOptions
constexpr double least_curvature = 1e-9;  // of the largest entry of the reduced tangent

bool is_nothing(const Recorded& a) { return a.is_known() && a.value() == 0.0; }

Recorded dot(const std::vector<Recorded>& a, const std::vector<Recorded>& b) {
  Recorded sum;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void StepEquations::list_rows() {
  for (int r = 0; r < mechanism_.equalities(); ++r) rows_.push_back({r});
  for (const HeldStop& held : held_) rows_.push_back({mechanism_.stop_row(held.stop), true, held.upper, held.stop});
}

// J and c of the rows that act in work_, F and the places of phasors.
void StepEquations::evaluate(const std::vector<Recorded>& x) {
  const auto n = x.size();
  pose_.assign(static_cast<std::size_t>(mechanism_.pose_size()), {});
  mechanism_.place(x.data(), pose_.data());
  constraint_.assign(static_cast<std::size_t>(mechanism_.constraints()), {});
  mechanism_.constraint(x.data(), pose_.data(), constraint_.data());
  force_.assign(n, {});
  mechanism_.negative_force(x.data(), pose_.data(), force_.data());
  std::vector<Recorded> jacobian(mechanism_.jacobian_row().size());
  mechanism_.jacobian(pose_.data(), jacobian.data());
  work_.assign(rows_.size(), std::vector<Recorded>(n + 1));
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    for (std::size_t e = 0; e < jacobian.size(); ++e) {
      if (mechanism_.jacobian_row()[e] == row.row) {
        work_[r][static_cast<std::size_t>(mechanism_.jacobian_column()[e])] = jacobian[e];
      }
    }
    const Recorded& value = constraint_[static_cast<std::size_t>(row.row)];
    const auto stop = static_cast<std::size_t>(row.is_bound ? row.stop : 0);
    work_[r][n] = !row.is_bound ? value : value - (row.upper ? mechanism_.upper() : mechanism_.lower())[stop];
  }
}

// Of entries that are no small part of the largest one, the pivot is the one that leads to the fewest new entries.
void StepEquations::choose_pivot(const std::vector<char>& row_used, const std::vector<char>& column_used,
                                 double least) {
  const std::size_t n = column_used.size();
  double largest = 0.0;
  std::vector<int> in_row(rows_.size(), 0), in_column(n, 0);
  const auto for_each = [&](auto use) {
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      for (std::size_t i = 0; i < n; ++i) {
        if (row_used[r] == 0 && column_used[i] == 0 && !is_nothing(work_[r][i])) {
          use(r, i, std::abs(work_[r][i].value()));
        }
      }
    }
  };
  for_each([&](std::size_t r, std::size_t i, double size) {
    largest = std::max(largest, size);
    ++in_row[r];
    ++in_column[i];
  });
  if (!(largest > least)) return;
  int best_row = -1, best_column = -1, fewest = std::numeric_limits<int>::max();
  double best = 0.0;
  for_each([&](std::size_t r, std::size_t i, double size) {
    if (size < candidate_part * largest) return;
    const int fill = (in_row[r] - 1) * (in_column[i] - 1);
    if (fill > fewest || (fill == fewest && size <= best)) return;
    fewest = fill;
    best = size;
    best_row = static_cast<int>(r);
    best_column = static_cast<int>(i);
  });
  pivot_row_.push_back(best_row);
  pivot_column_.push_back(best_column);
}

void StepEquations::add_pivot(const Recorded& pivot, bool is_positive) {
  if (!is_chosen_) nominal_.push_back(pivot.value());
  const double nominal = nominal_[next_nominal_++];
  const Recorded least(least_part_of_pivot * std::abs(nominal));
  good_ = good_ && (is_positive || nominal > 0.0 ? pivot >= least : -pivot >= least);
}

void StepEquations::eliminate() {
  const std::size_t n = force_.size();
  std::vector<char> row_used(rows_.size(), 0), column_used(n, 0);
  lower_.assign(rows_.size(), {});
  inverse_.clear();
  double least = 0.0;
  for (std::size_t k = 0; is_chosen_ ? k < pivot_row_.size() : k < rows_.size(); ++k) {
    if (!is_chosen_) choose_pivot(row_used, column_used, least);
    if (pivot_row_.size() == k) break;  // the other rows repeat these
    const auto row = static_cast<std::size_t>(pivot_row_[k]), column = static_cast<std::size_t>(pivot_column_[k]);
    const std::vector<Recorded>& pivots = work_[row];
    if (k == 0) least = least_rank_pivot * std::abs(pivots[column].value());
    row_used[row] = column_used[column] = 1;
    add_pivot(pivots[column], false);
    inverse_.push_back(Recorded(1.0) / pivots[column]);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (row_used[r] != 0) continue;
      const Recorded part = is_nothing(work_[r][column]) ? Recorded() : work_[r][column] * inverse_.back();
      lower_[r].push_back(part);
      if (is_nothing(part)) continue;
      for (std::size_t i = 0; i <= n; ++i) {
        if (i < n && column_used[i] != 0) continue;
        work_[r][i] -= part * pivots[i];
      }
    }
  }
  if (!is_chosen_) {
    for (std::size_t i = 0; i < n; ++i) {
      if (column_used[i] == 0) independent_.push_back(static_cast<int>(i));
    }
  }
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (row_used[r] == 0) good_ = good_ && abs(work_[r][n]) <= Recorded(still_closed);
  }
  // Back: the dependent coordinates of each motion, and of the step that closes.
  const std::size_t pivots = pivot_row_.size();
  motion_.assign(n, std::vector<Recorded>(independent_.size()));
  close_.assign(n, {});
  for (std::size_t j = 0; j < independent_.size(); ++j) motion_[static_cast<std::size_t>(independent_[j])][j] = 1.0;
  for (std::size_t k = pivots; k-- > 0;) {
    const std::vector<Recorded>& row = work_[static_cast<std::size_t>(pivot_row_[k])];
    const auto column = static_cast<std::size_t>(pivot_column_[k]);
    const auto solved = [&](Recorded sum, auto of) {
      for (std::size_t l = k + 1; l < pivots; ++l) {
        const auto other = static_cast<std::size_t>(pivot_column_[l]);
        sum += row[other] * of(other);
      }
      return -(sum * inverse_[k]);
    };
    close_[column] = solved(row[n], [&](std::size_t i) { return close_[i]; });
    for (std::size_t j = 0; j < independent_.size(); ++j) {
      motion_[column][j] =
          solved(row[static_cast<std::size_t>(independent_[j])], [&](std::size_t i) { return motion_[i][j]; });
    }
  }
}

// y = -J_u^-T F_u, by U^T z = -F_u and L^T y = z.
void StepEquations::find_multipliers() {
  const std::size_t pivots = pivot_row_.size();
  std::vector<Recorded> z(pivots);
  for (std::size_t k = 0; k < pivots; ++k) {
    const auto column = static_cast<std::size_t>(pivot_column_[k]);
    Recorded sum = force_[column];
    for (std::size_t l = 0; l < k; ++l) sum += work_[static_cast<std::size_t>(pivot_row_[l])][column] * z[l];
    z[k] = -(sum * inverse_[k]);
  }
  for (std::size_t k = pivots; k-- > 0;) {
    for (std::size_t l = k + 1; l < pivots; ++l) {
      z[k] -= lower_[static_cast<std::size_t>(pivot_row_[l])][k] * z[l];
    }
  }
  multiplier_.assign(constraint_.size(), {});
  for (std::size_t k = 0; k < pivots; ++k) {
    multiplier_[static_cast<std::size_t>(rows_[static_cast<std::size_t>(pivot_row_[k])].row)] = z[k];
  }
}

// N^T K N and -(N^T F + N^T K p).
void StepEquations::reduce() {
  const std::size_t n = force_.size(), f = independent_.size();
  std::vector<Recorded> tangent(mechanism_.tangent_row().size());
  mechanism_.tangent(pose_.data(), multiplier_.data(), tangent.data());
  Matrix bent(n, std::vector<Recorded>(f));  // K N
  std::vector<Recorded> bent_close(n);       // K p
  const bool is_symmetric = !mechanism_.has_follower_loads();
  const auto add = [&](std::size_t i, std::size_t j, const Recorded& value) {
    if (is_nothing(value)) return;
    for (std::size_t k = 0; k < f; ++k) bent[i][k] += value * motion_[j][k];
    if (!is_symmetric) bent_close[i] += value * close_[j];
  };
  for (std::size_t e = 0; e < tangent.size(); ++e) {
    const auto i = static_cast<std::size_t>(mechanism_.tangent_row()[e]),
               j = static_cast<std::size_t>(mechanism_.tangent_column()[e]);
    add(i, j, tangent[e]);
    if (is_symmetric && i != j) add(j, i, tangent[e]);
  }
  reduced_.assign(f, std::vector<Recorded>(f));
  reduced_force_.assign(f, {});
  for (std::size_t a = 0; a < f; ++a) {
    Recorded force;
    for (std::size_t i = 0; i < n; ++i) {
      force += motion_[i][a] * force_[i];
      force += is_symmetric ? bent[i][a] * close_[i] : motion_[i][a] * bent_close[i];
      for (std::size_t b = 0; b < f; ++b) {
        if (is_symmetric && b > a) continue;
        reduced_[a][b] += motion_[i][a] * bent[i][b];
      }
    }
    reduced_force_[a] = -force;
  }
  if (!is_symmetric) return;
  for (std::size_t a = 0; a < f; ++a) {
    for (std::size_t b = a + 1; b < f; ++b) reduced_[a][b] = reduced_[b][a];
  }
}

// Without exchanges: all pivots are positive where the equilibrium is stable. Of a tangent that is not symmetric its
// symmetric part has to be so, from which that follows for the motion.
std::vector<Recorded> StepEquations::solve_reduced() {
  const std::size_t f = independent_.size();
  double largest = 0.0;
  for (const auto& row : reduced_) {
    for (const Recorded& one : row) largest = std::max(largest, std::abs(one.value()));
  }
  const auto eliminated = [&](Matrix matrix, std::vector<Recorded> right, bool are_positive) {
    std::vector<Recorded> inverse;
    for (std::size_t k = 0; k < f; ++k) {
      if (!is_chosen_ && !(are_positive ? matrix[k][k].value() > least_curvature * largest
                                        : std::abs(matrix[k][k].value()) > least_curvature * largest)) {
        why_not_ = "the equilibrium of the scene as it is is not stable to second order";
      }
      add_pivot(matrix[k][k], are_positive);
      inverse.push_back(Recorded(1.0) / matrix[k][k]);
      for (std::size_t r = k + 1; r < f; ++r) {
        if (is_nothing(matrix[r][k])) continue;
        const Recorded part = matrix[r][k] * inverse[k];
        for (std::size_t c = k + 1; c < f; ++c) matrix[r][c] -= part * matrix[k][c];
        right[r] -= part * right[k];
      }
    }
    for (std::size_t k = f; k-- > 0;) {
      for (std::size_t c = k + 1; c < f; ++c) right[k] -= matrix[k][c] * right[c];
      right[k] *= inverse[k];
    }
    return right;
  };
  if (!mechanism_.has_follower_loads()) return eliminated(reduced_, reduced_force_, true);
  Matrix symmetric = reduced_;
  for (std::size_t a = 0; a < f; ++a) {
    for (std::size_t b = 0; b < f; ++b) symmetric[a][b] = Recorded(0.5) * (reduced_[a][b] + reduced_[b][a]);
  }
  eliminated(symmetric, reduced_force_, true);
  return eliminated(reduced_, reduced_force_, false);
}

void StepEquations::check_stops(RecordedStep& out) {
  for (std::size_t h = 0; h < held_.size(); ++h) {
    const auto [stop, upper] = held_[h];
    const auto s = static_cast<std::size_t>(stop);
    const Recorded& g = constraint_[static_cast<std::size_t>(mechanism_.stop_row(stop))];
    const Recorded& lower = mechanism_.lower()[s];
    const Recorded& upper_limit = mechanism_.upper()[s];
    const bool presses_either_way = lower.value() == upper_limit.value();
    if (presses_either_way) {
      if (!is_chosen_) pressing_.push_back(0.0);
      continue;
    }
    const Recorded& effort = multiplier_[static_cast<std::size_t>(mechanism_.stop_row(stop))];
    const Recorded push = upper ? effort : -effort;
    if (!is_chosen_) pressing_.push_back(push.value());
    const double nominal = pressing_[h];
    if (!(nominal > 0.0)) why_not_ = "a stop of the scene as it is does not press";
    good_ = good_ && push >= Recorded(least_part_of_pressing * nominal) && lower <= upper_limit;
    out.is_touched =
        out.is_touched && (upper ? g >= upper_limit - Recorded(touching) : g <= lower + Recorded(touching));
  }
  for (int s = 0; s < mechanism_.stops(); ++s) {
    if (std::any_of(held_.begin(), held_.end(), [&](const HeldStop& held) { return held.stop == s; })) continue;
    const Recorded& g = constraint_[static_cast<std::size_t>(mechanism_.stop_row(s))];
    const Recorded &lower = mechanism_.lower()[static_cast<std::size_t>(s)],
                   &upper = mechanism_.upper()[static_cast<std::size_t>(s)];
    if (!lower.is_known() || std::isfinite(lower.value())) good_ = good_ && g >= lower + Recorded(clear_of_stops);
    if (!upper.is_known() || std::isfinite(upper.value())) good_ = good_ && g <= upper - Recorded(clear_of_stops);
  }
}

RecordedStep StepEquations::at(const std::vector<Recorded>& x) {
  if (!is_chosen_) list_rows();
  next_nominal_ = 0;
  good_ = RecordedMask(true);
  RecordedStep out;
  evaluate(x);
  eliminate();
  find_multipliers();
  out.step = close_;
  if (!independent_.empty()) {
    reduce();
    const std::vector<Recorded> moves = solve_reduced();
    for (std::size_t i = 0; i < x.size(); ++i) out.step[i] += dot(motion_[i], moves);
  }
  check_stops(out);
  out.is_good = good_;
  is_chosen_ = true;
  return out;
}

}  // namespace poise
