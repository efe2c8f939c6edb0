#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise identify EXPERIMENT`: the parameters that explain its records, with how sure they are. Exit code solved where
/// a fit converged, also where its residuals are larger than the noise (the report warns, deviations are enlarged).
Command identify_command();

}  // namespace poise::app
