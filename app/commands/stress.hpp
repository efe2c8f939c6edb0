#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise stress [CASE...]`: all methods on the hard catalogue, from many seeded starts. Exit code solved where no
/// claim was wrong and virtual work arrived in at least 99.9 % of the starts of every case that has an answer.
Command stress_command();

}  // namespace poise::app
