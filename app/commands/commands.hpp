#pragma once

// The commands of poise, in the order of --help.

#include <string>
#include <vector>

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise check SCENE`: what the scene is: bodies, joints, mobility, what the model keeps. bad_input where it cannot be
/// assembled.
Command check_command();

/// `poise solve SCENE`: an equilibrium, by one method.
Command solve_command();

/// `poise equilibria SCENE`: all equilibria, or with --assemblies all ways to close the loops, and what is known of the
/// set; exit code solved where it is proved to be complete, or where some were found and no proof was asked for
/// (--seconds 0). Ctrl-C keeps what was found.
Command equilibria_command();

/// `poise hold SCENE --vary load.P`: whether friction holds a pose, and for which values of a number; exit code solved
/// where both answers to the first are proved, held or not, and the second was found.
Command hold_command();

/// `poise view SCENE`: a page in the browser in which joints, loads and numbers are changed, each answered with the
/// equilibrium. Ctrl-C ends it, with exit code solved.
Command view_command();

/// `poise path SCENE --vary load.P=0..5`: the curve of equilibria as one number of the scene changes, with its folds,
/// branch points, stops and snaps; exit code solved where the curve was followed to its ends and every point is proved.
/// Ctrl-C keeps the curve followed so far.
Command path_command();

/// `poise find SCENE --vary load.P=0..5 --for "force.rubber = 700"`: the values of a number for which a quantity has a
/// value in equilibrium, or of two for two; exit code solved where some were found and all of these are proved. Ctrl-C
/// keeps those found so far.
Command find_command();

/// `poise sensitivity SCENE --of reaction.A`: derivatives of quantities by every number of the scene; exit code solved
/// where all quantities have them.
Command sensitivity_command();

/// `poise tolerance SCENE --tolerances FILE --of reaction.A`: bands of quantities; exit code solved where all of them
/// have one and all samples were drawn. Ctrl-C keeps the samples drawn so far.
Command tolerance_command();

/// `poise loads SCENE`: normal force, shear force, bending moment, stress and deflection along links that have a
/// section, at rest. Exit code solved where every body is in balance and every such link has them.
Command loads_command();

/// `poise compare SCENE`: an equilibrium, by virtual work and by energy side by side; exit code solved where every
/// method that applies is confirmed. With --methods by any of them; exit code solved where one is confirmed.
/// With --tolerances: what accuracy costs each method; exit code solved where some run is confirmed.
Command compare_command();

/// `poise kinematics SCENE --drive crank=0..360`: positions, velocities and accelerations over a driven range, and the
/// singular poses in it. Exit code solved where the whole range could be driven.
Command kinematics_command();

/// `poise motion SCENE --duration S`: the free or driven motion of a scene, with its energy balance and estimated
/// error. Exit code solved where the motion is complete and both confirm it; Ctrl-C keeps the part computed so far.
Command motion_command();

/// `poise modes SCENE`: natural frequencies, shapes and damping of the small motions about an equilibrium. Exit code
/// solved where the equilibrium is confirmed and its motions are known.
Command modes_command();

/// `poise response SCENE --excite load.P --of y.table.P`: amplitude and phase over the frequency about an equilibrium;
/// with --amplitude its periodic motions, through folds. Exit code solved where the equilibrium is stable and the whole
/// range was followed. Ctrl-C keeps what was followed so far.
Command response_command();

/// `poise running SCENE`: how a machine with motors runs steadily, by shooting, with forces over a turn and the
/// stability of its orbit. Exit code solved where a stable running was found and confirmed.
Command running_command();

/// `poise forces SCENE`: efforts of drives and forces of joints in a pose, over a driven range, or along a recorded
/// motion. Exit code solved where every body is in balance everywhere.
Command forces_command();

/// `poise equations SCENE`: the equation of motion in a position, and as functions in C and Python. Exit code solved
/// where accelerations follow from it.
Command equations_command();

/// `poise design FILE`: dimensions that meet the goals of a design file, found from random starts and checked by the
/// general kinematics. Exit code solved where all goals are met and the check confirms them.
Command design_command();

/// `poise identify EXPERIMENT`: parameters fitted to its records, with standard errors. Exit code solved where a fit
/// converged, also where its residuals are larger than the noise (with a warning and enlarged standard errors).
Command identify_command();

/// `poise validate EXPERIMENT --with FIT.json`: other records predicted with the parameters of a fit. Exit code solved
/// where they could be predicted, also where the residuals are larger than the noise.
Command validate_command();

/// `poise identifiability EXPERIMENT`: which parameters it determines, before any data. Exit code solved where
/// that could be computed.
Command identifiability_command();

/// `poise plan EXPERIMENT`: the runs within the limits of its [plan] that determine its parameters best. Ctrl-C keeps
/// the best plan so far. Exit code solved where a plan was found.
Command plan_command();

/// `poise montecarlo EXPERIMENT`: simulate and fit many times, each with new noise and a new start. Ctrl-C keeps the
/// trials that have ended. Exit code solved where all trials ended and fits converged.
Command montecarlo_command();

/// `poise stress [CASE...]`: all methods on the hard catalogue, from many seeded starts. Exit code solved without
/// false claims and with virtual work converged from at least 99.9 % of the starts of every case that has an answer.
Command stress_command();

/// `poise import FILE`: a file of another program as a scene, printed or written, with what was decided. Exit code
/// solved where the file could be read.
Command import_command();

/// `poise export SCENE --dxf FILE`: a scene in its start, or in its equilibrium, as files of other programs. Exit code
/// solved where all were written.
Command export_command();

/// Whether a person can run a command in the page of `poise view`: of the scene that is shown, or of an experiment
/// beside its file.
enum class InPage { undecided, of_scene, of_experiment, no };

/// A command with what its help ends with: a line to try, from the folder of Poise.
struct CommandEntry {
  Command command;
  std::string example;
  InPage in_page = InPage::undecided;
};

/// All of them, in the order of --help, each time with options that nothing has been read into.
std::vector<CommandEntry> all_commands();

/// "expected a command: check, solve, ... or stress".
std::string expected_commands(const std::vector<CommandEntry>& commands);
/// Throws InputError naming all commands, with the nearest, where none has this name.
const Command& command_named(const std::vector<CommandEntry>& commands, const std::string& name);
/// The option of a command. Throws InputError with the nearest where it has none of this name.
const Option& option_named(const Command& command, const std::string& name);
/// What to say of an option that a command does not have; `options` are those it has.
std::string no_such_option(const std::string& command, const std::string& option,
                           const std::vector<std::string>& options);

/// "poise" and these words, in quotes where a shell needs them.
std::string line_of(const std::vector<std::string>& words);

}  // namespace poise::app
