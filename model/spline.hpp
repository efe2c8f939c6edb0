#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "model/select.hpp"

namespace poise {

/// P(u) with its first three derivatives.
template <class S>
struct ProfileValue {
  S value{}, first{}, second{}, third{};
};

/// Of scalars in lanes.
template <int N, class S>
ProfileValue<S> select(const Mask<N>& condition, const ProfileValue<S>& a, const ProfileValue<S>& b) {
  return {select(condition, a.value, b.value), select(condition, a.first, b.first),
          select(condition, a.second, b.second), select(condition, a.third, b.third)};
}

/// The cubic spline with continuous second derivatives through the points (u_k, P_k), u ascending: periodic, with the
/// last point one period after the first and P equal there, or natural, without curvature at its ends, or with ends as
/// curved as what is behind them: the first two pieces are one cubic, and the last two ("not-a-knot"; of two pieces
/// both are one parabola). Beyond its ends it goes on along its tangents (C. de Boor, "A Practical Guide to Splines",
/// 2001, chapter IV). The second derivatives M_k at the points follow from the continuity of the first ones,
///   h_k M_k + 2 (h_k + h_k+1) M_k+1 + h_k+1 M_k+2 = 6 (d_k+1 - d_k),   d_k = (P_k+1 - P_k) / h_k,
/// solved without pivots, because the middle one outweighs the others of its row, also with the M of the ends put in.
/// In dual numbers T it has exact derivatives by its points.
template <class T>
class Spline {
 public:
  Spline(std::vector<T> u, const std::vector<T>& p, bool periodic, bool has_curved_ends = false)
      : u_(std::move(u)), periodic_(periodic) {
    const std::size_t pieces = u_.size() - 1;
    const auto h = [&](std::size_t k) { return T(u_[k + 1] - u_[k]); };
    const std::vector<T> m = periodic ? in_turns(p) : between_ends(p, has_curved_ends);
    for (std::size_t k = 0; k < pieces; ++k) {
      const T square = h(k) * h(k);
      c_.push_back({p[k], T(p[k + 1] - p[k] - square * (T(2) * m[k] + m[k + 1]) / T(6)), T(square * m[k] / T(2)),
                    T(square * (m[k + 1] - m[k]) / T(6))});
    }
  }

  /// Of each piece: P = sum_k c_k s^k,  s = (u - u_k) / h_k.
  const std::vector<std::array<T, 4>>& coefficients() const { return c_; }

  ProfileValue<T> at(const T& u) const {
    T in_turn = u;
    if (periodic_) {
      using std::floor;
      const T period = u_.back() - u_.front();
      in_turn = u - period * T(floor(T((u - u_.front()) / period)));
    }
    // Of those between the points; before and behind them others.
    const std::size_t before = c_.size(), behind = before + 1;
    const auto piece_of = [&](const auto& of) -> std::size_t {
      if (!periodic_ && of(u) < of(u_.front())) return before;
      if (!periodic_ && of(u) > of(u_.back())) return behind;
      const auto next = std::upper_bound(u_.begin() + 1, u_.end() - 1, in_turn,
                                         [&](const T& value, const T& point) { return of(value) < of(point); });
      return static_cast<std::size_t>(next - u_.begin()) - 1;
    };
    return in_piece<T>(piece_of, [&](std::size_t k) {
      if (k == before) return along_end(0, T(0), T(u - u_.front()));
      if (k == behind) return along_end(c_.size() - 1, T(1), T(u - u_.back()));
      return on(k, T((in_turn - u_[k]) / (u_[k + 1] - u_[k])));
    });
  }

 private:
  ProfileValue<T> on(std::size_t k, const T& s) const {
    const std::array<T, 4>& c = c_[k];
    const T h = u_[k + 1] - u_[k];
    return {T(c[0] + s * (c[1] + s * (c[2] + s * c[3]))), T((c[1] + s * (T(2) * c[2] + s * T(3) * c[3])) / h),
            T((T(2) * c[2] + T(6) * s * c[3]) / (h * h)), T(T(6) * c[3] / (h * h * h))};
  }
  ProfileValue<T> along_end(std::size_t k, const T& s, const T& beyond) const {
    const ProfileValue<T> end = on(k, s);
    return {T(end.value + end.first * beyond), end.first, T(0), T(0)};
  }

  T jump_of_slope(const std::vector<T>& p, std::size_t before, std::size_t after) const {
    const auto slope = [&](std::size_t k) { return T((p[k + 1] - p[k]) / (u_[k + 1] - u_[k])); };
    return T(T(6) * (slope(after) - slope(before)));
  }

  // A matrix of three diagonals: entry k of `above` is in row k, that of `below` in row k + 1.
  static std::vector<T> solve(const std::vector<T>& diagonal, const std::vector<T>& above, const std::vector<T>& below,
                              std::vector<T> x) {
    std::vector<T> pivot = diagonal;
    for (std::size_t k = 1; k < x.size(); ++k) {
      const T factor = below[k - 1] / pivot[k - 1];
      pivot[k] = pivot[k] - factor * above[k - 1];
      x[k] = x[k] - factor * x[k - 1];
    }
    for (std::size_t k = x.size(); k-- > 0;) {
      if (k + 1 < x.size()) x[k] = x[k] - above[k] * x[k + 1];
      x[k] = x[k] / pivot[k];
    }
    return x;
  }

  // M_1 to M_n-1; M_0 and M_n are zero, or M_0 = (1 + r) M_1 - r M_2 with r = h_0 / h_1, of the other end likewise.
  std::vector<T> between_ends(const std::vector<T>& p, bool has_curved_ends) const {
    const std::size_t pieces = u_.size() - 1;
    const auto h = [&](std::size_t k) { return T(u_[k + 1] - u_[k]); };
    std::vector<T> diagonal, above, below, right;
    for (std::size_t k = 1; k < pieces; ++k) {
      diagonal.push_back(T(T(2) * (h(k - 1) + h(k))));
      above.push_back(h(k));
      below.push_back(h(k));
      right.push_back(jump_of_slope(p, k - 1, k));
    }
    const bool has_cubic_ends = has_curved_ends && pieces > 2;
    const T first = has_cubic_ends ? T(h(0) / h(1)) : T(0);
    const T last = has_cubic_ends ? T(h(pieces - 1) / h(pieces - 2)) : T(0);
    if (has_curved_ends && pieces > 1) {
      diagonal.front() = diagonal.front() + h(0) * (T(1) + first);
      diagonal.back() = diagonal.back() + h(pieces - 1) * (T(1) + last);
    }
    if (has_cubic_ends) {
      above.front() = above.front() - h(0) * first;
      below[pieces - 3] = below[pieces - 3] - h(pieces - 1) * last;
    }
    const std::vector<T> inside = solve(diagonal, above, below, std::move(right));
    std::vector<T> m{T(0)};
    m.insert(m.end(), inside.begin(), inside.end());
    m.push_back(T(0));
    if (!has_curved_ends || pieces < 2) return m;
    m.front() = has_cubic_ends ? T((T(1) + first) * m[1] - first * m[2]) : m[1];
    m.back() = has_cubic_ends ? T((T(1) + last) * m[pieces - 1] - last * m[pieces - 2]) : m[pieces - 1];
    return m;
  }

  // M_1 to M_n, with M_0 = M_n. The last one, which stands in the first row too, is found behind the others.
  std::vector<T> in_turns(const std::vector<T>& p) const {
    const std::size_t pieces = u_.size() - 1;
    std::vector<T> diagonal, beside, right, last(pieces - 1, T(0));
    for (std::size_t k = 0; k < pieces; ++k) {
      const std::size_t after = (k + 1) % pieces;
      diagonal.push_back(T(T(2) * (u_[k + 1] - u_[k] + u_[after + 1] - u_[after])));
      beside.push_back(T(u_[after + 1] - u_[after]));
      right.push_back(jump_of_slope(p, k, after));
    }
    const T own = diagonal.back(), own_right = right.back();
    diagonal.pop_back();
    right.pop_back();
    std::vector<T> m = right;
    T above = own_right, below = own;
    if (pieces == 1) {
      below = below + T(2) * beside[0];
    } else {
      last.front() = last.front() + beside[pieces - 1];
      last.back() = last.back() + beside[pieces - 2];
      m = solve(diagonal, beside, beside, std::move(right));
      const std::vector<T> by_last = solve(diagonal, beside, beside, last);
      for (std::size_t k = 0; k + 1 < pieces; ++k) {
        above = above - last[k] * m[k];
        below = below - last[k] * by_last[k];
      }
      for (std::size_t k = 0; k + 1 < pieces; ++k) m[k] = m[k] - by_last[k] * (above / below);
    }
    m.push_back(T(above / below));
    m.insert(m.begin(), m.back());
    return m;
  }

  std::vector<T> u_;
  std::vector<std::array<T, 4>> c_;
  bool periodic_;
};

}  // namespace poise
