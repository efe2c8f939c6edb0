#pragma once

#include <array>
#include <utility>
#include <vector>

#include "model/measures/configuration.hpp"

namespace poise {

/// A measure that is linear in the coordinates,  g = constant + sum_i factor_i q_i:  angles and travels.
template <class T>
class LinearMeasure {
 public:
  LinearMeasure() = default;
  /// With the constant  turn b - turn a,  indices into Layout::turns.
  LinearMeasure(const Phasors<T>& phasors, int turn_a, int turn_b)
      : constant_(phasors.turn(turn_b) - phasors.turn(turn_a)) {
    if (phasors.turn_varies(turn_a) || phasors.turn_varies(turn_b)) turns_ = {turn_a, turn_b};
  }

  void set_numbers(const Phasors<T>& phasors) {
    if (turns_[0] >= 0) constant_ = phasors.turn(turns_[1]) - phasors.turn(turns_[0]) + dropped_;
  }

  /// g += factor q_coordinate; a dropped coordinate counts with its start value, none (-1) with zero.
  void add(const Phasors<T>& phasors, int coordinate, const T& factor) {
    if (coordinate < 0) return;
    if (phasors.dropped(coordinate)) {
      const T part = factor * phasors.start(coordinate);
      constant_ += part;
      dropped_ += part;
      return;
    }
    std::size_t at = 0;
    while (at < support_.size() && support_[at] < coordinate) ++at;
    if (at < support_.size() && support_[at] == coordinate) {
      factor_[at] += factor;
      if (any(factor_[at] != 0)) return;
      support_.erase(support_.begin() + static_cast<std::ptrdiff_t>(at));
      factor_.erase(factor_.begin() + static_cast<std::ptrdiff_t>(at));
      return;
    }
    support_.insert(support_.begin() + static_cast<std::ptrdiff_t>(at), coordinate);
    factor_.insert(factor_.begin() + static_cast<std::ptrdiff_t>(at), factor);
  }

  const std::vector<int>& support() const { return support_; }
  int scratch_size() const { return 0; }

  T value(const Configuration<T>& at) const {
    T g = constant_;
    for (std::size_t i = 0; i < support_.size(); ++i) g += factor_[i] * at.value(support_[i]);
    return g;
  }

  template <class Use>
  void gradient(const Configuration<T>&, Use use) const {
    for (std::size_t i = 0; i < support_.size(); ++i) use(static_cast<int>(i), factor_[i]);
  }

  template <class Add>
  void curvature(const Configuration<T>&, const T&, const T& slope, Add add) const {
    for (std::size_t i = 0; i < support_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        add(static_cast<int>(i), static_cast<int>(j), slope * factor_[i] * factor_[j]);
      }
    }
  }

  T second(const Configuration<T>&, const T*, const T*) const { return T(0); }
  T third(const Configuration<T>&, const T*, const T*, const T*) const { return T(0); }
  template <class Use>
  void bend(const Configuration<T>&, const T*, Use) const {}

 private:
  std::vector<int> support_;
  std::vector<T> factor_;
  T constant_{};
  T dropped_{};                       // part of it, of dropped coordinates
  std::array<int, 2> turns_{-1, -1};  // where some turn varies
};

}  // namespace poise
