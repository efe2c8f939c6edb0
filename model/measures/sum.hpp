#pragma once

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "model/measures/distance.hpp"
#include "model/measures/linear.hpp"
#include "model/measures/position.hpp"

namespace poise {

/// g = sum_i factor_i g_i of other measures.
template <class T>
class SumMeasure {
 public:
  using Part = std::variant<LinearMeasure<T>, DistanceMeasure<T>, PositionMeasure<T>>;

  void add(const T& factor, Part part) {
    std::visit(
        [&](const auto& g) {
          support_.insert(support_.end(), g.support().begin(), g.support().end());
          scratch_of_parts_ = std::max(scratch_of_parts_, g.scratch_size());
        },
        part);
    std::sort(support_.begin(), support_.end());
    support_.erase(std::unique(support_.begin(), support_.end()), support_.end());
    terms_.push_back({factor, std::move(part), {}});
    for (Term& term : terms_) term.slots = slots_of(term.part);
  }

  const std::vector<int>& support() const { return support_; }
  int scratch_size() const { return scratch_of_parts_ + static_cast<int>(support_.size()); }

  T value(const Configuration<T>& at) const {
    return sum([&](const auto& g) { return g.value(at); });
  }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const Planar<T>* total = whole_gradient(at);
    for (std::size_t i = 0; i < support_.size(); ++i) use(static_cast<int>(i), total[i].x);
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const Planar<T>* total = whole_gradient(at);
    for (std::size_t i = 0; i < support_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j)
        add(static_cast<int>(i), static_cast<int>(j), slope * total[i].x * total[j].x);
    }
    for (const Term& term : terms_) {
      const auto add_mapped = [&](int i, int j, const T& value) {
        add(std::max(term.slots[i], term.slots[j]), std::min(term.slots[i], term.slots[j]), value);
      };
      std::visit([&](const auto& g) { g.curvature(at, T(force * term.factor), T(0), add_mapped); }, term.part);
    }
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    return sum([&](const auto& g) { return g.second(at, u, v); });
  }
  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    return sum([&](const auto& g) { return g.third(at, u, v, w); });
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    for (const Term& term : terms_) {
      const auto use_mapped = [&](int i, const T& value) { use(term.slots[i], T(term.factor * value)); };
      std::visit([&](const auto& g) { g.bend(at, u, use_mapped); }, term.part);
    }
  }

 private:
  struct Term {
    T factor;
    Part part;
    std::vector<int> slots;  // of the part's support in support_
  };

  template <class Of>
  T sum(Of of) const {
    T g(0);
    for (const Term& term : terms_) g += term.factor * std::visit(of, term.part);
    return g;
  }

  // In the scratch behind that of the parts.
  const Planar<T>* whole_gradient(const Configuration<T>& at) const {
    Planar<T>* total = at.scratch + scratch_of_parts_;
    std::fill(total, total + support_.size(), Planar<T>{});
    for (const Term& term : terms_) {
      const auto add = [&](int i, const T& value) { total[term.slots[i]].x += term.factor * value; };
      std::visit([&](const auto& g) { g.gradient(at, add); }, term.part);
    }
    return total;
  }

  std::vector<int> slots_of(const Part& part) const {
    std::vector<int> slots;
    std::visit(
        [&](const auto& g) {
          for (const int t : g.support()) {
            slots.push_back(static_cast<int>(std::lower_bound(support_.begin(), support_.end(), t) - support_.begin()));
          }
        },
        part);
    return slots;
  }

  std::vector<Term> terms_;
  std::vector<int> support_;
  int scratch_of_parts_ = 0;
};

}  // namespace poise
