#pragma once

#include <string>

#include "identification/assessment/validation.hpp"

namespace poise::app {

/// Reads what `poise identify --json FILE` wrote. Throws InputError where the file is no such result, or where its fit
/// did not converge.
FittedModel read_fit(const std::string& file);

}  // namespace poise::app
