#pragma once

// A small experiment that the commands of identification are tried on.

#include <chrono>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests {

/// A wheel of 3 kg m2 on a torsion spring of 48 N m/rad with a damper of 0.6 N m s/rad, in degrees: w0 = 4 rad/s.
inline constexpr const char* wheel = R"([units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
mass = 1
inertia = 3
[[pin]]
points = ["ground.O", "wheel.O"]
[[torsion_spring]]
name = "S"
bodies = ["ground", "wheel"]
stiffness = 0.8377580409572781
[[torsion_damper]]
name = "D"
bodies = ["ground", "wheel"]
coefficient = 0.010471975511965976
)";

inline constexpr const char* wheel_unknowns = R"(title = "Wheel"
scene = "wheel.toml"
[[sensor]]
name = "turn"
angle = "wheel"
noise = 0.02
[[unknown]]
path = "torsion_spring.S.stiffness"
name = "k"
start = 0.6
[[unknown]]
path = "torsion_damper.D.coefficient"
name = "c"
)";

inline constexpr const char* one_run = R"([[run]]
name = "only"
release = { wheel = 20 }
duration = 6
rate = 200
seed = 3
)";

/// Writes the wheel and an experiment on it into the folder; returns the experiment's path.
std::string experiment(const TempFolder& folder, const std::string& text);

/// Runs poise with --json, expects the exit code and returns the result.
nlohmann::json run_json(const TempFolder& folder, std::vector<std::string> words, int exit_code);

bool has(const std::string& text, const std::string& part);

/// Starts poise with its report in the file `out`, interrupts it a while after it has begun to watch for that, and
/// returns its exit code.
int interrupt_poise(const std::vector<std::string>& arguments, const std::string& out, std::chrono::milliseconds after);

}  // namespace poise::app_tests
