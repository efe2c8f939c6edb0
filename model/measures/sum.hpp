#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "model/measure.hpp"
#include "model/measures/component.hpp"
#include "model/measures/distance.hpp"
#include "model/measures/linear.hpp"
#include "model/measures/outline_measure.hpp"
#include "model/measures/position.hpp"
#include "model/measures/rope.hpp"
#include "model/profile.hpp"
#include "model/set_valued.hpp"
#include "model/spline.hpp"

namespace poise {

/// A profile of a measure g:  factor P((g - shift) / span).
template <class T>
struct ProfileOf {
  std::shared_ptr<const Profile> profile;
  T shift{}, span{1};
  /// In place of the profile, where the points that it goes through are numbers: over the measure less the shift; of
  /// one that rolls over its share of the chords, whose sum is the span.
  std::shared_ptr<const Spline<T>> curve{};
  std::shared_ptr<const ProfileIn<T>> rolling{};

  /// P and its derivatives by g.
  ProfileValue<T> at(const T& g) const {
    if constexpr (!may_enclose_set<T>) {
      if (curve) return curve->at(T(g - shift));
      if (rolling) {
        ProfileValue<T> p = rolling->at(T(g / span));
        p.first = p.first / span;
        p.second = p.second / (span * span);
        p.third = p.third / (span * span * span);
        return p;
      }
    }
    ProfileValue<T> p = profile->at(T((g - shift) / span));
    p.first = p.first / span;
    p.second = p.second / (span * span);
    p.third = p.third / (span * span * span);
    return p;
  }
};

template <class T>
ProfileOf<T> profile_of(const Measure::Term& term) {
  return {term.profile, static_cast<T>(term.shift),
          term.measure.is_angle() ? T(2) * pi_of<T>() : static_cast<T>(term.span)};
}

/// g = sum_i factor_i g_i of other measures, or factor_i P_i(g_i) of profiles of them. Of a profile with the
/// derivatives P1, P2, P3 by its measure g, along directions,
///   P_u   = P1 g_u
///   P_uv  = P1 g_uv + P2 g_u g_v
///   P_uvw = P1 g_uvw + P2 (g_uv g_w + g_uw g_v + g_vw g_u) + P3 g_u g_v g_w.
template <class T>
class SumMeasure {
 public:
  using Part = std::variant<LinearMeasure<T>, DistanceMeasure<T>, PositionMeasure<T>, ComponentMeasure<T>,
                            RopeMeasure<T>, OutlineMeasure<T>>;

  void add(const T& factor, Part part, ProfileOf<T> of = {}) {
    std::visit(
        [&](const auto& g) {
          support_.insert(support_.end(), g.support().begin(), g.support().end());
          scratch_of_parts_ = std::max(scratch_of_parts_, g.scratch_size());
        },
        part);
    std::sort(support_.begin(), support_.end());
    support_.erase(std::unique(support_.begin(), support_.end()), support_.end());
    terms_.push_back({factor, std::move(part), std::move(of), {}});
    for (Term& term : terms_) {
      term.slots = std::visit([&](const auto& g) { return slots_in(support_, g.support()); }, term.part);
    }
  }

  void set_numbers(const Phasors<T>& phasors) {
    for (Term& term : terms_) std::visit([&](auto& g) { g.set_numbers(phasors); }, term.part);
  }
  /// Gives the term that was added as number k this factor and profile.
  void set_term(std::size_t k, const T& factor, ProfileOf<T> of) {
    terms_[k].factor = factor;
    terms_[k].of = std::move(of);
  }

  const std::vector<int>& support() const { return support_; }
  int scratch_size() const { return scratch_of_parts_ + static_cast<int>(support_.size()); }

  T value(const Configuration<T>& at) const {
    return sum([&](const Term& term, const auto& g) -> T {
      return term.of.profile ? term.of.at(g.value(at)).value : g.value(at);
    });
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
      const T share = force * term.factor;
      std::visit(
          [&](const auto& g) {
            if (!term.of.profile) return g.curvature(at, share, T(0), add_mapped);
            const ProfileValue<T> p = term.of.at(g.value(at));
            g.curvature(at, T(share * p.first), T(share * p.second), add_mapped);
          },
          term.part);
    }
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    return sum([&](const Term& term, const auto& g) -> T {
      if (!term.of.profile) return g.second(at, u, v);
      const ProfileValue<T> p = term.of.at(g.value(at));
      return p.first * g.second(at, u, v) + p.second * along(g, at, u) * along(g, at, v);
    });
  }
  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    return sum([&](const Term& term, const auto& g) -> T {
      if (!term.of.profile) return g.third(at, u, v, w);
      const ProfileValue<T> p = term.of.at(g.value(at));
      const T g_u = along(g, at, u), g_v = along(g, at, v), g_w = along(g, at, w);
      return p.first * g.third(at, u, v, w) +
             p.second * (g.second(at, u, v) * g_w + g.second(at, u, w) * g_v + g.second(at, v, w) * g_u) +
             p.third * g_u * g_v * g_w;
    });
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    for (const Term& term : terms_) {
      std::visit(
          [&](const auto& g) {
            if (!term.of.profile) {
              g.bend(at, u, [&](int i, const T& value) { use(term.slots[i], T(term.factor * value)); });
              return;
            }
            const ProfileValue<T> p = term.of.at(g.value(at));
            const T first = term.factor * p.first;
            const T second = term.factor * p.second * along(g, at, u);
            g.bend(at, u, [&](int i, const T& value) { use(term.slots[i], T(first * value)); });
            g.gradient(at, [&](int i, const T& value) { use(term.slots[i], T(second * value)); });
          },
          term.part);
    }
  }

 private:
  struct Term {
    T factor;
    Part part;
    ProfileOf<T> of;
    std::vector<int> slots;  // of the part's support in support_
  };

  template <class G>
  static T along(const G& g, const Configuration<T>& at, const T* u) {
    T sum(0);
    g.gradient(at, [&](int i, const T& by) { sum += by * u[g.support()[static_cast<std::size_t>(i)]]; });
    return sum;
  }

  template <class Of>
  T sum(Of of) const {
    T g(0);
    for (const Term& term : terms_) {
      g += term.factor * std::visit([&](const auto& part) -> T { return of(term, part); }, term.part);
    }
    return g;
  }

  // In the scratch behind that of the parts.
  const Planar<T>* whole_gradient(const Configuration<T>& at) const {
    Planar<T>* total = at.scratch + scratch_of_parts_;
    std::fill(total, total + support_.size(), Planar<T>{});
    for (const Term& term : terms_) {
      std::visit(
          [&](const auto& g) {
            const T factor = term.of.profile ? T(term.factor * term.of.at(g.value(at)).first) : term.factor;
            g.gradient(at, [&](int i, const T& value) { total[term.slots[i]].x += factor * value; });
          },
          term.part);
    }
    return total;
  }

  std::vector<Term> terms_;
  std::vector<int> support_;
  int scratch_of_parts_ = 0;
};

}  // namespace poise
