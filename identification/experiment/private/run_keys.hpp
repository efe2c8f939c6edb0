#pragma once

// Keys that the tables [[run]] and [[static]] share.

#include <initializer_list>

#include "identification/experiment/experiment.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Fails for each of these keys, which belong elsewhere: "expected duration of a simulated run only, ...".
void expect_none(const TomlTable& table, std::initializer_list<const char*> keys, const char* belong);

/// Fills in the sensors that are read in a run, at rest or in motion: those that the key `sensors` names, else all that
/// have readings there; but other quantities than measures, of an experiment that has readings at rest too, are taken
/// to be of these. Fails for one that has no readings there.
void read_sensors(const TomlTable& table, const Experiment& experiment, bool rests_too, Run& run);

void read_labels(const TomlTable& table, Run& run);

}  // namespace poise
