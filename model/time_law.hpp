#pragma once

// How functions of time are evaluated. Private to model/.

#include <span>
#include <string>

#include "model/second_dual.hpp"
#include "model/time_function.hpp"

namespace poise {

/// The value of a law where its numbers are these, which may carry derivatives.
SecondDual value_with(const TimeLaw& law, std::span<const SecondDual> numbers, double t, double near);

/// They have the meaning of those of the other laws in time_function.cpp.
double value_of(const FormulaInTime& formula, double t, int derivative, double near);
double value_by(const FormulaInTime& formula, int number, double t, int derivative, double near);
double value_of(const ComposedInTime& composed, double t, int derivative, double near);
double value_by(const ComposedInTime& composed, int number, double t, int derivative, double near);

SecondDual value_with(const FormulaInTime& formula, std::span<const SecondDual> numbers, double t, double near);
SecondDual value_with(const ComposedInTime& composed, std::span<const SecondDual> numbers, double t, double near);

/// Throws InputError unless the law has a value, rate and acceleration at t = 0 and its rate never jumps: a drive whose
/// rate jumped would take infinite forces.
void expect_drivable(const TimeLaw& law);

}  // namespace poise
