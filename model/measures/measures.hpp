#pragma once

#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "model/measures/angle.hpp"
#include "model/measures/cam_slip.hpp"
#include "model/measures/component.hpp"
#include "model/measures/distance.hpp"
#include "model/measures/half_square.hpp"
#include "model/measures/outline_measure.hpp"
#include "model/measures/position.hpp"
#include "model/measures/rope.hpp"
#include "model/measures/sum.hpp"
#include "model/measures/travel.hpp"
#include "model/scene.hpp"
#include "model/scene_numbers.hpp"

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

  /// Takes what varies again from phasors whose numbers have been set.
  void set_numbers(const Phasors<T>& phasors) {
    std::visit([&](auto& g) { g.set_numbers(phasors); }, form_);
  }
  /// Takes the factors and profiles of a sum from these numbers: of the measure that this is compiled from, in the
  /// scene of the numbers; `stop` as of Numbers::term(). Others have none.
  template <class NumbersOfScene>
  void set_terms(const NumbersOfScene& numbers, const Measure& measure, int stop) {
    if (auto* const slip = std::get_if<CamSlipMeasure<T>>(&form_)) slip->set_shape(numbers);
    auto* const sum = std::get_if<SumMeasure<T>>(&form_);
    if (sum == nullptr) return;
    std::size_t next = 0;
    set_terms(numbers, measure, T(1), stop, *sum, next);
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

  /// The vector between the points of a distance, or the place of a point in the frame of an outline; others have none.
  /// A distance, and a clearance outside of the outline, change by no more than this moves.
  std::optional<Planar<T>> place(const Configuration<T>& at) const {
    return std::visit(
        [&]<class G>(const G& g) -> std::optional<Planar<T>> {
          if constexpr (requires { g.place(at); })
            return g.place(at);
          else
            return std::nullopt;
        },
        form_);
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
  using Form = std::variant<LinearMeasure<T>, DistanceMeasure<T>, PositionMeasure<T>, ComponentMeasure<T>,
                            RopeMeasure<T>, OutlineMeasure<T>, CamSlipMeasure<T>, SumMeasure<T>, HalfSquareMeasure<T>>;

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
      case Measure::Kind::component:
        return std::visit([](auto g) -> Form { return g; }, component(scene, layout, phasors, measure, measure.axis));
      case Measure::Kind::rope:
        return rope(scene, layout, phasors, measure);
      case Measure::Kind::clearance:
      case Measure::Kind::along_outline:
        return on_outline(scene, layout, phasors, measure);
      case Measure::Kind::slip_on_cam:
        return on_cam(scene, layout, phasors, measure);
      case Measure::Kind::sum:
        break;
    }
    SumMeasure<T> sum;
    add_terms(scene, layout, phasors, measure, T(1), sum);
    return sum;
  }

  // In the order of add_terms(). Numbers of couplings are those of the outermost sum.
  template <class NumbersOfScene>
  static void set_terms(const NumbersOfScene& numbers, const Measure& measure, const T& factor, int stop,
                        SumMeasure<T>& sum, std::size_t& next) {
    for (std::size_t k = 0; k < measure.terms.size(); ++k) {
      const auto term = numbers.term(measure, k, stop);
      const T whole = factor * term.factor;
      if (!term.has_profile() && measure.terms[k].measure.kind == Measure::Kind::sum) {
        set_terms(numbers, measure.terms[k].measure, whole, -1, sum, next);
        continue;
      }
      sum.set_term(next++, whole, term.has_profile() ? term.profile() : ProfileOf<T>{});
    }
  }

  // Along an axis of the ground, or of a body that does not turn, the component of a point moves as a position does.
  static std::variant<PositionMeasure<T>, ComponentMeasure<T>> component(const Scene& scene, const Layout& layout,
                                                                         const Phasors<T>& phasors,
                                                                         const Measure& measure, const Vec2& along) {
    const Link& carrier = layout.links[measure.a.body];
    Planar<T> axis = direction<T>(along);
    PhasorSum<T> d = between(scene, layout, phasors, measure.a, measure.b);
    if (carrier.frame >= 0 && !phasors.dropped(carrier.frame)) {
      return ComponentMeasure<T>(phasors, std::move(d), axis, carrier.turn, carrier.frame);
    }
    if (carrier.frame >= 0) axis = axis * unit(phasors.start(carrier.frame));
    return PositionMeasure<T>(phasors, std::move(d), axis, carrier.turn);
  }

  static RopeMeasure<T> rope(const Scene& scene, const Layout& layout, const Phasors<T>& phasors,
                             const Measure& measure) {
    std::vector<typename RopeMeasure<T>::Contact> contacts;
    std::vector<PhasorSum<T>> parts;
    for (std::size_t k = 0; k < measure.contacts.size(); ++k) {
      const RopeContact& contact = measure.contacts[k];
      contacts.push_back({static_cast<T>(contact.radius), contact.turn});
      if (k > 0) parts.push_back(between(scene, layout, phasors, measure.contacts[k - 1].at, contact.at));
    }
    return {std::move(contacts), std::move(parts)};
  }

  static OutlineMeasure<T> on_outline(const Scene& scene, const Layout& layout, const Phasors<T>& phasors,
                                      const Measure& measure) {
    const std::vector<PointRef>& points = measure.outline.points;
    std::vector<std::vector<Arm>> places;
    for (const PointRef& point : points) places.push_back(layout.path(scene, points.front(), point));
    OutlineIn<T> outline(measure.outline, [&](PointRef point) { return scene.local(point); });
    return {phasors,
            component(scene, layout, phasors, measure, {1, 0}),
            component(scene, layout, phasors, measure, {0, 1}),
            std::move(outline),
            std::move(places),
            measure.kind == Measure::Kind::along_outline,
            static_cast<T>(measure.radius)};
  }

  static CamSlipMeasure<T> on_cam(const Scene& scene, const Layout& layout, const Phasors<T>& phasors,
                                  const Measure& measure) {
    const Stop& stop = scene.stops[static_cast<std::size_t>(measure.stop)];
    CamSlipMeasure<T> out(
        component(scene, layout, phasors, measure, {1, 0}), component(scene, layout, phasors, measure, {0, 1}),
        compile_angle(layout, phasors, stop.on.terms[1].measure), *cam_geometry(scene, stop), measure.stop);
    out.set_shape(SceneNumbers<T>(scene));
    return out;
  }

  // A sum within a sum is expanded; profiles are of single measures.
  static void add_terms(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, const Measure& measure,
                        const T& factor, SumMeasure<T>& sum) {
    for (const Measure::Term& term : measure.terms) {
      const T whole = factor * static_cast<T>(term.factor);
      ProfileOf<T> of;
      if (term.profile) {
        of = profile_of<T>(term);
      } else if (term.measure.kind == Measure::Kind::sum) {
        add_terms(scene, layout, phasors, term.measure, whole, sum);
        continue;
      }
      std::visit(
          [&]<class G>(G g) {
            if constexpr (!std::is_same_v<G, SumMeasure<T>> && !std::is_same_v<G, HalfSquareMeasure<T>> &&
                          !std::is_same_v<G, CamSlipMeasure<T>>) {
              sum.add(whole, std::move(g), std::move(of));
            }
          },
          compile(scene, layout, phasors, term.measure));
    }
  }

  static PhasorSum<T> between(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, PointRef a,
                              PointRef b) {
    return {phasors, layout.path(scene, a, b)};
  }
  static PhasorSum<T> place_of(const Scene& scene, const Layout& layout, const Phasors<T>& phasors, PointRef p) {
    return {phasors, layout.path_to(scene, p)};
  }

  Form form_;
};

}  // namespace poise
