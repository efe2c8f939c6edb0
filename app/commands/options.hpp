#pragma once

// What was asked for on the command line, and the options that several commands share.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/caller.hpp"
#include "app/commands/command.hpp"
#include "identification/prediction/fit_problem.hpp"
#include "motion/kinematics.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/equilibrium/method.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise::app {

/// What was asked for on the command line.
struct Request {
  std::string command{}, line{};               ///< its name; the whole command line, as a shell would read it
  std::string scene;                           ///< file
  std::string kind = "scene";                  ///< what that file is
  std::vector<std::string> settings;           ///< "load.P=40"
  std::string with;                            ///< result of identify whose estimates the scene takes; empty: none
  std::string json, svg, html, csv, markdown;  ///< files to write, empty for none
  std::string written_scene;                   ///< the same: the scene that was designed or fitted
  std::string experiment;                      ///< the same: the experiment that plan made
  std::vector<std::pair<std::string, std::string>> exported;  ///< the same by their options, of other programs
  bool quiet = false, verbose = false;  ///< what text shows: verdict and warnings alone; everything
  Caller* caller = nullptr;             ///< the program that asks in place of a person at a terminal

  /// Raised where the work is to stop: by Ctrl-C, from here on, or by the caller.
  const std::atomic<bool>& interrupt() const;
  /// Who is told what is being done; nobody but the terminal where there is no caller.
  std::function<void(const std::string&)> listener() const;
};

/// Exit codes of the command line.
enum ExitCode : int {
  solved = 0,      ///< found and confirmed
  not_solved = 1,  ///< not found, or not confirmed
  bad_input = 2    ///< the scene, the command line or a file to write
};

/// What every command that reads a scene takes: SCENE and --set. `request` must outlive the command.
void add_scene_options(Command& command, Request& request);
/// --with, the fit whose estimates a scene takes.
void add_with_option(Command& command, Request& request);
/// --set alone, for commands that read a scene through another file.
void add_settings(Command& command, Request& request);

/// What every command that has a result takes: --json, --csv and --svg where a text says what they hold, --markdown,
/// --html, --quiet and --verbose.
struct FileHelp {
  std::string svg{}, csv{};  ///< empty: the command has none
};
void add_output_options(Command& command, Request& request, const FileHelp& help);

/// --seek; its word goes to `seek`, which must outlive the command.
void add_seek_option(Command& command, std::string& seek);
/// --proof-seconds; its number goes to `seconds`, which must outlive the command.
void add_proof_option(Command& command, std::optional<double>& seconds);
/// The options of certificates with that time. Throws InputError unless it is a number >= 0.
CertificateOptions read_proof(const std::optional<double>& seconds);
/// --scaling and --penalty of the augmented Lagrangian; the numbers go to `words`, which must outlive the command.
struct LagrangianWords {
  std::optional<double> scaling, penalty;
};
void add_lagrangian_options(Command& command, LagrangianWords& words);
/// Throws InputError where they are out of range, or none of the methods has them.
LagrangianWeights read_lagrangian(const LagrangianWords& words, const std::vector<Method>& methods);
/// --jobs; its number goes to `jobs`, which must outlive the command.
void add_jobs_option(Command& command, int& jobs, const std::string& help);
/// Throws InputError unless that is a number of threads, or 0 for all cores.
int read_jobs(int jobs);
/// settle, any or stable. Throws InputError.
Seek read_seek(const std::string& word);

/// --of, required; its words go to `names`, which must outlive the command.
void add_quantities_option(Command& command, std::vector<std::string>& names);
/// The words of a list with commas between, empty ones too.
std::vector<std::string> comma_separated(const std::string& text);

/// Adds --show NAMES, quantities that are shown at each position.
void add_show_option(Command& command, std::vector<std::string>& names);
/// The quantities of names with commas between them, each kept once. Throws InputError naming `option`.
std::vector<SoughtQuantity> read_quantities(const std::string& option, const std::vector<std::string>& names,
                                            const Scene& scene, AskedOf asked_of = AskedOf::rest);
/// The same, and throws for quantities over a path, such as extremes.
std::vector<SoughtQuantity> read_of_position(const std::string& option, const std::vector<std::string>& names,
                                             const Scene& scene);

/// The outputs of a scene but for loads at folds, and behind them what an option asks for.
struct Shown {
  std::vector<SoughtQuantity> of_position, over_path;
};
/// Throws InputError for a load at a fold, which belongs to no position.
Shown read_shown(const std::string& option, const std::vector<std::string>& names, const Scene& scene);
/// The same of --show where there is no path.
std::vector<SoughtQuantity> read_shown_in_position(const std::vector<std::string>& names, const Scene& scene);

/// Reads the word given to an option. Throws InputError "OPTION: expected ..., found WORD" unless it is a number, or a
/// whole number that the type can represent ("1e3" is one), or a text that is not empty.
void read_word(const std::string& option, const std::string& word, double& value);
void read_word(const std::string& option, const std::string& word, int& value);
void read_word(const std::string& option, const std::string& word, std::uint64_t& value);
void read_word(const std::string& option, const std::string& word, std::string& value);

/// Throws InputError "OPTION: expected EXPECTED, found VALUE" unless `fits` and the value is within 1e50.
void expect_number(const std::string& option, double value, bool fits, const std::string& expected);
void expect_between(const std::string& option, int value, int least, int most);

/// Throws InputError unless a range can have so many --steps and be driven at a --rate.
void check_sweep(int steps, const std::optional<double>& rate);

/// The place of a word among those that an option knows. Throws InputError naming them, with the nearest.
std::size_t chosen(const std::string& option, const std::string& word, const std::vector<std::string>& words);

/// The words of --start: where a fit starts from.
std::vector<std::string> start_words();

/// The names of all methods, and one line for each, "NAME: what it does", for the help of an option.
std::vector<std::string> method_names();
std::string method_help();
/// What an option with a list of methods knows: their names, and all.
std::vector<std::string> method_list_words();

/// The method of a name. Throws InputError naming the option and all methods.
Method read_method(const std::string& option, const std::string& name);

/// "all", or names with commas between them, each kept once. Throws InputError.
std::vector<Method> read_methods(const std::string& option, const std::string& names);

/// "1e-2..1e-14": from the first by decades as far as the second; or a list "1e-3,1e-6", which is put in falling order,
/// each value once. Throws InputError where that is no range of falling numbers within 1e-20 <= tolerance < 1.
std::vector<double> read_tolerances(const std::string& text);

/// "NAME=FROM..TO", or "NAME=VALUE" with both ends the same.
struct NamedRange {
  std::string name;
  double from = 0.0, to = 0.0;
};
/// Reads such a text. Throws InputError naming `option` and what it expects unless both ends are finite numbers.
NamedRange read_named_range(const std::string& option, const std::string& text, const std::string& expected);

/// Reads "1,2.5,5". Throws InputError naming `option` unless all are finite numbers.
std::vector<double> read_numbers(const std::string& option, const std::string& text);

/// Reads "crank=0..360", or "crank=30" for one place, in the scene's units. Throws InputError naming --drive.
DriveRange read_drive(const std::string& text, const Scene& scene,
                      const std::string& expected = "NAME=FROM..TO, say crank=0..360");

/// What was asked of an experiment.
struct ExperimentRequest {
  Request common;    ///< its `scene` is the experiment's file
  std::string data;  ///< file that takes the place of the runs' own
};

/// What every command that reads an experiment takes: EXPERIMENT, --data and --set. `request` must outlive the command.
/// With `several` the command takes one file or more, into it and not into the request.
void add_experiment_options(Command& command, ExperimentRequest& request, std::vector<std::string>* several = nullptr);

/// Throws InputError, also where the experiment has no unknowns.
Experiment load_experiment(const ExperimentRequest& request);

/// All files that an experiment was read from.
std::vector<std::string> files_read(const Experiment& experiment);

}  // namespace poise::app
