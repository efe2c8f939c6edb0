#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "model/measures/angle.hpp"
#include "model/measures/distance.hpp"
#include "model/measures/half_square.hpp"
#include "model/measures/position.hpp"
#include "model/measures/sum.hpp"
#include "model/measures/travel.hpp"
#include "model/scene.hpp"

namespace poise {

/// A measure compiled for a layout of its scene, with derivatives; see model/measures/configuration.hpp.
template <class T>
class CompiledMeasure {
 public:
  CompiledMeasure() = default;
  CompiledMeasure(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, const Measure& measure)
      : form_(compile(scene, layout, phasors, measure)) {}
  /// Half the square of a distance.
  static CompiledMeasure half_square(const Scene& scene, const Layout& layout, const Phasors<T>& phasors,
                                     const Measure& measure) {
    CompiledMeasure out;
    out.form_ = HalfSquareMeasure<T>(between(scene, layout, phasors, measure.a, measure.b));
    return out;
  }

  const std::vector<int>& support() const {
    return std::visit([](const auto& g) -> const std::vector<int>& { return g.support(); }, form_);
  }
  /// Linear in the coordinates: it needs no phasors.
  bool is_linear() const { return std::holds_alternative<LinearMeasure<T>>(form_); }
  int scratch_size() const {
    return std::visit([](const auto& g) { return g.scratch_size(); }, form_);
  }

  T value(const Configuration<T>& at) const {
    return std::visit([&](const auto& g) { return g.value(at); }, form_);
  }
  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    std::visit([&](const auto& g) { g.gradient(at, use); }, form_);
  }
  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    std::visit([&](const auto& g) { g.curvature(at, force, slope, add); }, form_);
  }
  T second(const Configuration<T>& at, const T* u, const T* v) const {
    return std::visit([&](const auto& g) { return g.second(at, u, v); }, form_);
  }
  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    return std::visit([&](const auto& g) { return g.third(at, u, v, w); }, form_);
  }

  /// Dg[u].
  T along(const Configuration<T>& at, const T* u) const {
    T sum(0);
    gradient(at, [&](int i, const T& by) { sum += by * u[support()[i]]; });
    return sum;
  }
  /// out += factor Dg.
  void add_gradient(const Configuration<T>& at, const T& factor, T* out) const {
    gradient(at, [&](int i, const T& by) { out[support()[i]] += factor * by; });
  }
  /// out += factor D2g[u, .].
  void add_bend(const Configuration<T>& at, const T* u, const T& factor, T* out) const {
    std::visit([&](const auto& g) { g.bend(at, u, [&](int i, const T& by) { out[g.support()[i]] += factor * by; }); },
               form_);
  }

 private:
  using Form =
      std::variant<LinearMeasure<T>, DistanceMeasure<T>, PositionMeasure<T>, SumMeasure<T>, HalfSquareMeasure<T>>;

  static Form compile(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, const Measure& measure) {
    switch (measure.kind) {
      case Measure::Kind::angle:
        return compile_angle(layout, phasors, measure);
      case Measure::Kind::travel:
        return compile_travel(layout, phasors, measure);
      case Measure::Kind::distance:
        return DistanceMeasure<T>(between(scene, layout, phasors, measure.a, measure.b));
      case Measure::Kind::x:
        return PositionMeasure<T>(place_of(scene, layout, phasors, measure.b), {T(1), T(0)});
      case Measure::Kind::y:
        return PositionMeasure<T>(place_of(scene, layout, phasors, measure.b), {T(0), T(1)});
      case Measure::Kind::sum:
        break;
    }
    SumMeasure<T> sum;
    add_terms(scene, layout, phasors, measure, T(1), sum);
    return sum;
  }

  // A sum within a sum is expanded.
  static void add_terms(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, const Measure& measure,
                        const T& factor, SumMeasure<T>& sum) {
    for (const Measure::Term& term : measure.terms) {
      const T whole = factor * static_cast<T>(term.factor);
      if (term.measure.kind == Measure::Kind::sum) {
        add_terms(scene, layout, phasors, term.measure, whole, sum);
        continue;
      }
      std::visit(
          [&]<class G>(G g) {
            if constexpr (!std::is_same_v<G, SumMeasure<T>> && !std::is_same_v<G, HalfSquareMeasure<T>>) {
              sum.add(whole, std::move(g));
            }
          },
          compile(scene, layout, phasors, term.measure));
    }
  }

  static PhasorSum<T> between(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, PointRef a,
                              PointRef b) {
    return {phasors, layout.path(a.body, scene.local(a), b.body, scene.local(b))};
  }
  static PhasorSum<T> place_of(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, PointRef p) {
    return {phasors, layout.path(0, {0, 0}, p.body, scene.local(p))};
  }

  Form form_;
};

}  // namespace poise
