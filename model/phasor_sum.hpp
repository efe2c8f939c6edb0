#pragma once

#include <algorithm>
#include <vector>

#include "model/phasors.hpp"

namespace poise {

/// Places of the coordinates of one sorted list in another one that has all of them.
inline std::vector<int> slots_in(const std::vector<int>& all, const std::vector<int>& some) {
  std::vector<int> slots;
  slots.reserve(some.size());
  for (const int t : some) slots.push_back(static_cast<int>(std::lower_bound(all.begin(), all.end(), t) - all.begin()));
  return slots;
}

/// A plane vector  p(q) = c0 + sum_e coefficient_e phi_{coordinate_e},  with the coordinates that change it.
template <class T>
class PhasorSum {
 public:
  struct Term {
    int coordinate;
    int own_slot;    // place of the coordinate in the support
    int frame_slot;  // place of its line's frame angle in the support, or -1
    Planar<T> coefficient;
  };

  PhasorSum() = default;
  /// Arms of one coordinate must be consecutive. Dropped coordinates have their start value.
  PhasorSum(const Phasors<T>& phasors, const std::vector<Arm>& arms);

  /// Takes its coefficients again from phasors whose numbers have been set. Its support stays.
  void set_numbers(const Phasors<T>& phasors);
  bool varies() const { return !arms_.empty(); }

  const std::vector<Term>& terms() const { return terms_; }
  const Planar<T>& constant() const { return constant_; }
  /// Coordinates that change it, sorted.
  const std::vector<int>& support() const { return support_; }
  int size() const { return static_cast<int>(support_.size()); }

  /// p.
  Planar<T> at(const Planar<T>* pose) const {
    Planar<T> p = constant_;
    for (const Term& term : terms_) p += term.coefficient * pose[term.coordinate];
    return p;
  }

  /// d p / d q over the support:  i c phi  for an angle;  c exp(i theta_f)  for a length, and  i c phi  for its frame.
  void derivative(const Phasors<T>& phasors, const Planar<T>* pose, Planar<T>* d) const {
    std::fill(d, d + support_.size(), Planar<T>{});
    for (const Term& term : terms_) {
      const int t = term.coordinate;
      const Planar<T> turned = quarter_turn(term.coefficient * pose[t]);
      if (t < phasors.angles()) {
        d[term.own_slot] += turned;
        continue;
      }
      d[term.own_slot] += term.coefficient * phasors.line_direction(pose, t);
      if (term.frame_slot >= 0) d[term.frame_slot] += turned;
    }
  }

  /// add(i, j, d2 p / d q_i d q_j) by slots i >= j of the support, each pair once; mixed derivatives by two angles are
  /// zero.
  template <class Add>
  void second_derivative(const Phasors<T>& phasors, const Planar<T>* pose, Add add) const {
    for (const Term& term : terms_) {
      const int t = term.coordinate;
      const int own = term.own_slot;
      const int f = term.frame_slot;
      if (t < phasors.angles()) {
        add(own, own, -(term.coefficient * pose[t]));
      } else if (f >= 0) {
        add(f, f, -(term.coefficient * pose[t]));
        add(std::max(own, f), std::min(own, f), quarter_turn(term.coefficient * phasors.line_direction(pose, t)));
      }
    }
  }

  /// use(i, m . D2 p[e_i, u]) by slots i of the support, of a slot perhaps several times: how the gradient of m . p
  /// changes along u, with part(v) = m . v for a vector m that stays.
  template <class Part, class Use>
  void bend(const Phasors<T>& phasors, const Planar<T>* pose, const T* u, Part part, Use use) const {
    second_derivative(phasors, pose, [&](int i, int j, const Planar<T>& d_ij) {
      const T along = part(d_ij);
      use(i, T(along * u[support_[j]]));
      if (i != j) use(j, T(along * u[support_[i]]));
    });
  }

  /// D p[u], from the derivatives d_i over the support; u has a value per coordinate.
  Planar<T> along(const Planar<T>* d_i, const T* u) const {
    Planar<T> sum{};
    for (std::size_t i = 0; i < support_.size(); ++i) sum += u[support_[i]] * d_i[i];
    return sum;
  }

  /// D2 p[u, v].
  Planar<T> along(const Phasors<T>& phasors, const Planar<T>* pose, const T* u, const T* v) const {
    Planar<T> sum{};
    second_derivative(phasors, pose, [&](int i, int j, const Planar<T>& d_ij) {
      const int a = support_[i];
      const int b = support_[j];
      sum += (i == j ? T(u[a] * v[a]) : T(u[a] * v[b] + u[b] * v[a])) * d_ij;
    });
    return sum;
  }

  /// D3 p[u, v, w].
  Planar<T> along(const Phasors<T>& phasors, const Planar<T>* pose, const T* u, const T* v, const T* w) const {
    Planar<T> sum{};
    for (const Term& term : terms_) {
      const int t = term.coordinate;
      if (t < phasors.angles()) {
        sum -= (u[t] * v[t] * w[t]) * quarter_turn(term.coefficient * pose[t]);
        continue;
      }
      const int f = phasors.frame(t);
      if (f < 0) continue;
      sum -= (u[t] * v[f] * w[f] + u[f] * v[t] * w[f] + u[f] * v[f] * w[t]) *
             (term.coefficient * phasors.line_direction(pose, t));
      sum -= (u[f] * v[f] * w[f]) * quarter_turn(term.coefficient * pose[t]);
    }
    return sum;
  }

 private:
  // add(coordinate, coefficient), of a constant -1, for every arm.
  template <class Add>
  static void for_each_arm(const Phasors<T>& phasors, const std::vector<Arm>& arms, Add add);

  std::vector<Term> terms_;
  Planar<T> constant_{};
  std::vector<int> support_;
  std::vector<Arm> arms_;  // where some vary
};

template <class T>
template <class Add>
void PhasorSum<T>::for_each_arm(const Phasors<T>& phasors, const std::vector<Arm>& arms, Add add) {
  for (const Arm& arm : arms) {
    Planar<T> c = phasors.coefficient(arm);
    int t = arm.coordinate;
    // A dropped coordinate keeps its start value: a length turns with its frame, an angle is a constant.
    if (t >= 0 && phasors.dropped(t) && !phasors.is_angle(t)) {
      c = phasors.start(t) * c;
      t = phasors.any_frame(t);
    }
    if (t >= 0 && phasors.dropped(t)) {
      c = c * unit(phasors.start(t));
      t = -1;
    }
    add(t, c);
  }
}

template <class T>
PhasorSum<T>::PhasorSum(const Phasors<T>& phasors, const std::vector<Arm>& arms) {
  terms_.reserve(arms.size());
  for_each_arm(phasors, arms, [&](int coordinate, const Planar<T>& c) {
    if (coordinate < 0) {
      constant_ += c;
    } else if (!terms_.empty() && terms_.back().coordinate == coordinate) {
      terms_.back().coefficient += c;
    } else {
      terms_.push_back({coordinate, -1, -1, c});
    }
  });
  if (std::any_of(arms.begin(), arms.end(), [&](const Arm& arm) { return phasors.varies(arm); })) arms_ = arms;
  support_.reserve(terms_.size());
  for (const Term& term : terms_) {
    support_.push_back(term.coordinate);
    if (phasors.frame(term.coordinate) >= 0) support_.push_back(phasors.frame(term.coordinate));
  }
  std::sort(support_.begin(), support_.end());
  support_.erase(std::unique(support_.begin(), support_.end()), support_.end());
  const auto slot = [&](int t) {
    return static_cast<int>(std::lower_bound(support_.begin(), support_.end(), t) - support_.begin());
  };
  for (Term& term : terms_) {
    term.own_slot = slot(term.coordinate);
    if (phasors.frame(term.coordinate) >= 0) term.frame_slot = slot(phasors.frame(term.coordinate));
  }
}

template <class T>
void PhasorSum<T>::set_numbers(const Phasors<T>& phasors) {
  if (arms_.empty()) return;
  constant_ = {};
  for (Term& term : terms_) term.coefficient = {};
  std::size_t known = 0;  // terms so far, which come in the order in which they were made
  for_each_arm(phasors, arms_, [&](int coordinate, const Planar<T>& c) {
    if (coordinate < 0) {
      constant_ += c;
      return;
    }
    if (known == 0 || terms_[known - 1].coordinate != coordinate) ++known;
    terms_[known - 1].coefficient += c;
  });
}

}  // namespace poise
