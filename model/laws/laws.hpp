#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "model/laws/bump_stop.hpp"
#include "model/laws/compliant_stop.hpp"
#include "model/laws/constant_force.hpp"
#include "model/laws/controller.hpp"
#include "model/laws/cubic_spring.hpp"
#include "model/laws/curve_damper.hpp"
#include "model/laws/curve_spring.hpp"
#include "model/laws/damper.hpp"
#include "model/laws/dc_motor.hpp"
#include "model/laws/drag_damper.hpp"
#include "model/laws/dry_friction.hpp"
#include "model/laws/gas_strut.hpp"
#include "model/laws/induction_motor.hpp"
#include "model/laws/linear_spring.hpp"
#include "model/laws/preloaded_spring.hpp"
#include "model/plain_value.hpp"
#include "model/select.hpp"

namespace poise {

/// All force laws, with numbers of the scalar N. A new one needs its own file in this folder and its name here.
template <class N>
using LawOf = std::variant<LinearSpringOf<N>, CubicSpringOf<N>, ConstantForceOf<N>, DamperOf<N>, DryFrictionOf<N>,
                           PreloadedSpringOf<N>, CurveSpringOf<N>, GasStrutOf<N>, BumpStopOf<N>, DragDamperOf<N>,
                           CurveDamperOf<N>, CompliantStopOf<N>, DcMotorOf<N>, InductionMotorOf<N>, ControllerOf<N>>;
using Law = LawOf<double>;

/// The scalar of the numbers of laws on measures in the scalar T: dual numbers vary by them too, and lanes have their
/// own.
template <class T>
using NumberOfLaw = std::conditional_t<has_derivatives<T> || has_lanes<T>, T, double>;
template <class T>
using LawIn = LawOf<NumberOfLaw<T>>;

/// A law that stores energy, and so acts in statics.
template <class L>
concept StoresEnergy = requires(const L& law, double g) {
  law.energy(g);
  law.at_rest(g);
};

/// A law whose force depends on the rate: it resists motion, without force at rate zero, or is a motor.
template <class L>
concept ResistsMotion = requires(const L& law, double g) {
  law.resisting(g, g);
};

template <class N>
bool stores_energy(const LawOf<N>& law) {
  return std::visit([]<class L>(const L&) { return StoresEnergy<L>; }, law);
}

template <class N>
bool resists_motion(const LawOf<N>& law) {
  return std::visit([]<class L>(const L&) { return ResistsMotion<L>; }, law);
}

/// True if the force is proportional to small rates, so that it damps small oscillations.
inline bool damps_small_motion(const Law& law) {
  return std::visit(
      []<class L>(const L& l) {
        if constexpr (ResistsMotion<L>)
          return l.damps_small_motion();
        else
          return false;
      },
      law);
}

/// True of a law that drives its measure.
template <class N>
bool is_motor(const LawOf<N>& law) {
  return std::holds_alternative<DcMotorOf<N>>(law) || std::holds_alternative<InductionMotorOf<N>>(law);
}

/// The controller that a law is, or null.
template <class N>
const ControllerOf<N>* controller_of(const LawOf<N>& law) {
  return std::get_if<ControllerOf<N>>(&law);
}

/// True of friction that sticks at rate zero, see DryFriction.
template <class N>
bool sticks(const LawOf<N>& law) {
  const auto* friction = std::get_if<DryFrictionOf<N>>(&law);
  return friction != nullptr && friction->sticks();
}

template <class L>
std::span<const Number> numbers_of_law(const L& law) {
  if constexpr (requires { law.all_numbers(); })
    return law.all_numbers();
  else
    return L::numbers;
}

inline std::span<const Number> numbers_of(const Law& law) {
  return std::visit([](const auto& l) { return numbers_of_law(l); }, law);
}

/// Whether the static force is an affine function of this number.
inline bool is_affine_in(const Law& law, int number) {
  return std::visit(
      [&]<class L>(const L&) {
        if constexpr (requires { L::affine_numbers; })
          return number < L::affine_numbers;
        else
          return true;
      },
      law);
}

/// Whether the law acts on one side only, and not where the measure is g.
inline bool is_slack(const Law& law, double g) {
  return std::visit(
      [&]<class L>(const L& l) {
        if constexpr (requires { l.slack(g); })
          return l.slack(g);
        else
          return false;
      },
      law);
}

/// Why the law never acts with its present numbers; empty if it does.
inline std::string_view idle(const Law& law) {
  return std::visit([](const auto& l) { return l.idle(); }, law);
}

/// Why statics leaves the law out; empty if it acts in statics.
inline std::string_view left_out_of_statics(const Law& law) {
  return std::visit(
      []<class L>(const L&) -> std::string_view {
        if constexpr (StoresEnergy<L>)
          return {};
        else
          return L::left_out;
      },
      law);
}

/// Size of the static force for a change `change` of the measure; 0 for laws that store no energy.
inline double force_scale(const Law& law, double change) {
  return std::visit(
      [&]<class L>(const L& l) {
        if constexpr (StoresEnergy<L>)
          return l.force_scale(change);
        else
          return 0.0;
      },
      law);
}

/// V(g), 0 for laws that store none.
template <class S>
S energy(const LawIn<S>& law, const S& g) {
  return std::visit(
      [&]<class L>(const L& l) {
        if constexpr (StoresEnergy<L>)
          return l.energy(g);
        else
          return S(0);
      },
      law);
}

/// Static force of the law, 0 for laws that store no energy.
template <class S>
LawForce<S> force_at_rest(const LawIn<S>& law, const S& g) {
  return std::visit(
      [&]<class L>(const L& l) {
        if constexpr (StoresEnergy<L>)
          return l.at_rest(g);
        else
          return LawForce<S>{};
      },
      law);
}

/// Additional force of the law at the rate w.
template <class S>
LawForce<S> force_of_motion(const LawIn<S>& law, const S& g, const S& w) {
  return std::visit(
      [&]<class L>(const L& l) {
        if constexpr (ResistsMotion<L>)
          return l.resisting(g, w);
        else
          return LawForce<S>{};
      },
      law);
}

/// Whether a number of the law may vary during a motion: then in_motion names all that the law has.
template <class L>
concept VariesInMotion = requires {
  L::in_motion;
};
inline bool varies_in_motion(const Law& law) {
  return std::visit([]<class L>(const L&) { return VariesInMotion<L>; }, law);
}

/// Calls use(the law with `more` added to its numbers_of()[number], in the scalar of that): of one that varies in
/// motion.
template <class S, class N, class Use>
auto with_more(const LawOf<N>& law, int number, const S& more, Use use) -> decltype(use(LinearSpringOf<S>())) {
  return std::visit(
      [&]<class L>(const L& l) -> decltype(use(LinearSpringOf<S>())) {
        if constexpr (VariesInMotion<L>) {
          std::array<S, L::in_motion.size()> numbers;
          for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = S(l.*L::in_motion[k]);
          numbers[static_cast<std::size_t>(number)] += more;
          return use(l.with(numbers.data()));
        } else {
          return {};
        }
      },
      law);
}

/// The whole force of a law, of one kind, at the rate w.
template <class L, class S>
LawForce<S> whole_force(const L& law, const S& g, const S& w) {
  LawForce<S> out;
  if constexpr (StoresEnergy<L>) out = law.at_rest(g);
  if constexpr (ResistsMotion<L>) {
    const LawForce<S> more = law.resisting(g, w);
    out = {out.value + more.value, out.by_measure + more.by_measure, out.by_rate + more.by_rate};
  }
  return out;
}

/// The law with its numbers in the scalar of laws on measures in T, as they are.
template <class T>
LawIn<T> law_in(const Law& law) {
  if constexpr (has_derivatives<T> || has_lanes<T>) {
    return std::visit(
        [](const auto& l) -> LawIn<T> {
          std::vector<T> numbers;
          for (const Number& number : numbers_of_law(l)) numbers.push_back(T(number.get(&l).value_or(0.0)));
          return l.with(numbers.data());
        },
        law);
  } else {
    return law;
  }
}

/// Force of friction that sticks, which slides in this direction: see DryFriction::sliding(). And its derivative.
template <class S>
LawForce<S> force_of_sliding(const LawIn<S>& law, int direction, const S& w) {
  return std::get<DryFrictionOf<NumberOfLaw<S>>>(law).sliding(direction, w);
}
template <class S>
S force_of_sliding_by_number(const LawIn<S>& law, int number, int direction, const S& w) {
  return std::get<DryFrictionOf<NumberOfLaw<S>>>(law).sliding_by(number, direction, w);
}

/// Where derivatives of the force by the measure, or by its rate, jump.
template <class N>
std::vector<N> borders_of(const LawOf<N>& law, bool of_rate) {
  return std::visit(
      [&]<class L>(const L& l) -> std::vector<N> {
        if constexpr (requires { l.rate_borders(); }) {
          if (of_rate) return l.rate_borders();
        }
        if constexpr (requires { l.measure_borders(); }) {
          if (!of_rate) return l.measure_borders();
        }
        return {};
      },
      law);
}

/// dT / d numbers_of(law)[number].
template <class S>
S force_by_number(const LawIn<S>& law, int number, const S& g, const S& w) {
  return std::visit([&](const auto& l) { return l.force_by(number, g, w); }, law);
}

}  // namespace poise
