#include "app/results/statics/stress.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/terminal/poise_folder.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {
namespace {
namespace fs = std::filesystem;

struct StressRequest {
  Request common;
  std::vector<std::string> cases;
  std::string catalogue;
  std::optional<std::string> methods;
  std::optional<int> starts;
  double work = comparison::StressOptions{}.work;
  std::optional<double> seconds;
  int jobs = 1;
  bool safeguards = false;
  bool list = false;
};

void check(const StressRequest& request) {
  if (request.starts) expect_between("--starts", *request.starts, 1, 1'000'000);
  expect_number("--work", request.work, request.work > 0, "a finite number > 0");
  if (request.seconds) expect_number("--seconds", *request.seconds, *request.seconds > 0, "a finite number > 0");
  if (request.safeguards && request.methods) {
    throw InputError("--methods: expected none with --safeguards, which are those of virtual-work; leave one out");
  }
}

/// The folder of the catalogue: the one named, else that of the working folder, else Poise's own.
fs::path find_catalogue(const std::string& named) {
  if (!named.empty()) return named;
  std::error_code unknown;
  std::vector<std::string> places;
  for (const fs::path& folder : {fs::path(), poise_folder().value_or(fs::path())}) {
    places.push_back((folder / "datasets" / "hard").string());
    if (fs::is_regular_file(fs::path(places.back()) / "catalogue.toml", unknown)) return places.back();
  }
  throw InputError(fmt::format("--catalogue: there is no catalogue.toml in {}; expected a folder that has one",
                               fmt::join(places, " or ")));
}

/// The catalogue, or the cases of it that are named.
struct Cases {
  std::vector<comparison::HardCase> hard;
  std::vector<comparison::FrictionCase> friction;
};

template <class Case>
bool choose(const std::vector<Case>& all, const std::string& name, std::vector<Case>& chosen) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Case& one) { return one.name == name; });
  if (found != all.end()) chosen.push_back(*found);
  return found != all.end();
}

Cases chosen_cases(Cases all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  Cases chosen;
  for (const std::string& name : names) {
    if (choose(all.hard, name, chosen.hard) || choose(all.friction, name, chosen.friction)) continue;
    std::vector<std::string> valid = each(all.hard, &comparison::HardCase::name);
    for (const comparison::FrictionCase& one : all.friction) valid.push_back(one.name);
    throw InputError(fmt::format("CASE: the catalogue has none that is called \"{}\"{}; poise stress --list shows all",
                                 name, did_you_mean(name, valid)));
  }
  return chosen;
}

/// Those of friction; none where methods, or safeguards, are compared that have nothing to do with it.
std::vector<comparison::FrictionResult> run_friction(const StressRequest& request,
                                                     const std::vector<comparison::FrictionCase>& cases,
                                                     Progress& progress) {
  std::vector<comparison::FrictionResult> out;
  if (request.safeguards || request.methods) return out;
  for (const comparison::FrictionCase& known : cases) {
    if (request.common.interrupt()) break;
    progress.now(known.name);
    out.push_back(comparison::run_friction_case(known));
  }
  return out;
}

std::string command_of(const StressRequest& request) {
  std::string text = "poise stress";
  for (const std::string& name : request.cases) text += " " + name;
  if (!request.catalogue.empty()) text += " --catalogue " + request.catalogue;
  if (request.methods) text += " --methods " + *request.methods;
  if (request.safeguards) text += " --safeguards";
  if (request.starts) text += fmt::format(" --starts {}", *request.starts);
  if (request.work != StressRequest().work) text += fmt::format(" --work {}", request.work);
  if (request.seconds) text += fmt::format(" --seconds {}", *request.seconds);
  if (request.jobs != StressRequest().jobs) text += fmt::format(" --jobs {}", request.jobs);
  return text;
}

comparison::StressOutcome run_cases(const StressRequest& request, const std::vector<comparison::HardCase>& cases,
                                    Progress& progress) {
  comparison::StressOptions options;
  options.methods = read_methods("--methods", request.methods.value_or("all"));
  options.starts = request.starts.value_or(options.starts);
  options.work = request.work;
  options.seconds = request.seconds;
  options.jobs = read_jobs(request.jobs);
  options.interrupt = &request.common.interrupt();
  options.progress = [&progress](const std::string& doing) { progress.now(doing); };

  comparison::StressOutcome outcome;
  outcome.safeguards = request.safeguards;
  outcome.work = request.work;
  outcome.seconds = request.seconds;
  outcome.asked = cases.size();
  if (request.safeguards) {
    for (const comparison::Variant& variant : comparison::safeguard_variants()) {
      outcome.methods.push_back(outcome.methods.empty() ? variant.name : "without " + variant.name);
    }
    outcome.results = comparison::stress_safeguards(cases, options);
  } else {
    for (const Method method : options.methods) outcome.methods.push_back(to_string(method));
    outcome.results = comparison::stress(cases, options);
  }
  outcome.interrupted = *options.interrupt;
  return outcome;
}

int run_stress(const StressRequest& request, const Palette& palette) {
  check(request);
  Progress progress(request.common.listener());
  progress.now("reading the catalogue");
  const fs::path catalogue = find_catalogue(request.catalogue);
  const Cases cases =
      chosen_cases({comparison::read_catalogue(catalogue), comparison::read_friction_cases(catalogue)}, request.cases);
  if (request.list) {
    return finish(request.common, stress_list_result(cases.hard, cases.friction), nullptr, {}, true, progress, palette);
  }
  OutputFiles files(request.common);
  const comparison::StressOutcome outcome = run_cases(request, cases.hard, progress);
  const std::vector<comparison::FrictionResult> friction = run_friction(request, cases.friction, progress);
  const Result result = stress_result(outcome, friction, command_of(request), !request.cases.empty());
  const comparison::StressFailures failures = comparison::failures_of(outcome);
  return finish(
      request.common, result, &files, {},
      failures.false_claims == 0 && failures.unsolved.empty() && !outcome.interrupted &&
          std::all_of(friction.begin(), friction.end(), [](const comparison::FrictionResult& r) { return r.agrees; }),
      progress, palette);
}

}  // namespace

Command stress_command() {
  const auto request = std::make_shared<StressRequest>();
  Command command{"stress", "Run all methods on the hard catalogue, from many starts"};
  command.add({"CASE", &request->cases, "", "Cases to try and to show in detail (all, on one sheet)"});
  command.add({"--list", &request->list, "", "Only list the cases"});
  command
      .add({"--catalogue", &request->catalogue, "DIR",
            "Folder of the catalogue (datasets/hard, or Poise's own); its\nformat: docs/hard-cases.md"})
      .reads("/");
  command
      .add({"--methods", &request->methods, "NAMES",
            "all (the default), or names with commas between\n" + method_help()})
      .choices = method_list_words();
  command.add({"--starts", &request->starts, "N", "Starts per case (its own number)"});
  command.add({"--work", &request->work, "N",
               "Methods other than virtual-work try no further starts of a\ncase after N evaluations of a small "
               "mechanism (200000)"});
  command.add({"--seconds", &request->seconds, "S",
               "The same after S seconds in place of --work: the number of\nstarts depends on the machine then"});
  add_jobs_option(command, request->jobs,
                  "Threads, which take the cases (1, since times are measured; 0\nfor all cores)");
  command.add({"--safeguards", &request->safeguards, "",
               "Virtual work alone: with all its safeguards, and with each\nswitched off in turn"});
  add_output_options(command, request->common, {.csv = "Write one row for each case and method to FILE as CSV"});
  command.run = [request](const Palette& palette) { return run_stress(*request, palette); };
  return command;
}

}  // namespace poise::app
