#pragma once

#include <string>
#include <vector>

#include "statics/answer.hpp"

namespace poise::app {

/// A result as a JSON object:
///   poise, scene {file, title, source, set}, units {length, force, mass, angle, moment, energy: names}
///   left_out [what of the scene statics left out, and why: "friction \"hinge\": nothing moves in statics, ..."]
///   method, seek, status, why, iterations, evaluations, microseconds
///   energy (springs in full, loads without the part that no motion changes: energy_note says so), stability,
///   stability_note, descent_directions, neutral_directions, modes [{curvature, moves {name: part}}] points {body:
///   {point: [x, y]}} in world coordinates, angles {body: absolute and unwrapped}, slides {joint: travel}, places {body
///   that no chain of joints ties to the ground: [x, y]} of its origin in the world springs {name: {length, force,
///   slack}}, torsion_springs {name: {moment}}, stops {name: {value, min, max, presses}} reactions [{name, kind, at,
///   force, moment, axial, determined}] on the joint's second body, redundancy residuals {closure_error, worst_joint,
///   imbalance, worst_body, largest_force, stop_violation, worst_stop, objection} error, in rad or length over size;
///   reference {refined, digits, why, coordinates [{name, unit, value: 40 digits}]}
/// Values are in the scene's units, unless the reference says otherwise; what is not known, or not a finite number, is
/// null. `settings` are the --set options as given.
std::string solve_json(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings);

/// The same for several methods: poise, scene, units, left_out, methods [all else], agreement {same,
/// largest_difference} of the confirmed ones, null where there are fewer than two.
std::string compare_json(const StaticModel& model, const std::vector<Answer>& answers,
                         const std::vector<std::string>& settings);

}  // namespace poise::app
