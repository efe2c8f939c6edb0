#pragma once

#include "motion/simulate.hpp"

namespace poise {

/// Largest |T + V - work - (T + V at start)| of a motion's nodes over the largest energy exchanged.
double energy_error(const Motion& motion);

}  // namespace poise
