#include "app/commands/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/terminal/interrupt.hpp"
#include "identification/fit/fit.hpp"
#include "model/input_error.hpp"
#include "model/named_number.hpp"
#include "model/nearest_name.hpp"
#include "model/quantity.hpp"
#include "model/value_range.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> ways_to_seek = {"settle", "any", "stable"};

template <class Whole>
void read_whole_number(const std::string& option, const std::string& word, Whole& value) {
  const char* const end = word.data() + word.size();
  const auto [stopped, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc() && stopped == end) return;
  // Written with a point or exponent; a double represents every whole number up to 2^53.
  const double most = std::min(9007199254740992.0, static_cast<double>(std::numeric_limits<Whole>::max()));
  const double number = read_number(word).value_or(-1.0);
  if (!(number >= 0.0 && number <= most && number == std::floor(number))) {
    throw InputError(fmt::format("{}: expected a whole number from 0 to {}, found \"{}\"", option,
                                 std::numeric_limits<Whole>::max(), word));
  }
  value = static_cast<Whole>(number);
}

constexpr double tightest = 1e-20, loosest = 1.0;

double read_tolerance(std::string_view text) {
  const std::optional<double> value = read_number(text);
  const std::string expected = "expected numbers as in 1e-2..1e-14 or 1e-3,1e-6";
  // A point in front: there were three points between two numbers.
  if (!value || text.starts_with('.')) {
    throw InputError(fmt::format("--tolerances: \"{}\" is not a number; {}", text, expected));
  }
  if (!(*value >= tightest && *value < loosest)) {
    throw InputError(
        fmt::format("--tolerances: expected numbers from {:g} to less than {:g}, found {}", tightest, loosest, text));
  }
  return *value;
}

std::vector<double> decades(std::string_view from, std::string_view to) {
  const double first = read_tolerance(from), last = read_tolerance(to);
  if (first < last) {
    throw InputError(
        fmt::format("--tolerances: {}..{} rises; expected the loosest first, say {}..{}", from, to, to, from));
  }
  constexpr double rounding = 1e-9;
  std::vector<double> out;
  for (double value = first; value >= last * (1 - rounding); value /= 10) {
    // Read back from 12 digits, so that 1e-5 is the number 1e-5.
    out.push_back(std::stod(fmt::format("{:.12g}", value)));
  }
  return out;
}

}  // namespace

const std::atomic<bool>& Request::interrupt() const {
  return caller != nullptr ? caller->interrupt : watch_for_interrupt();
}

std::function<void(const std::string&)> Request::listener() const {
  if (caller == nullptr) return {};
  return [caller = caller](const std::string& doing) {
    if (caller->listener) caller->listener(doing);
  };
}

void add_scene_options(Command& command, Request& request) {
  command.add({"SCENE", &request.scene, "", "Scene file (TOML)", Presence::required}).reads("toml");
  add_settings(command, request);
}

void add_settings(Command& command, Request& request) {
  command.add({"--set", &request.settings, "PATH=NUMBER",
               "Change a number of the scene, in its own units: load.P=40,\n"
               "body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;\n"
               "can be given several times"});
}

void add_output_options(Command& command, Request& request, const FileHelp& help) {
  request.command = command.name;
  command.request = &request;
  command.add({"--json", &request.json, "FILE", "Write the result to FILE as JSON (keys: docs/json.md)"})
      .writes("json");
  if (!help.csv.empty()) command.add({"--csv", &request.csv, "FILE", help.csv}).writes("csv");
  command.add({"--markdown", &request.markdown, "FILE", "Write the result to FILE as Markdown"}).writes("md");
  if (!help.svg.empty()) command.add({"--svg", &request.svg, "FILE", help.svg}).writes("svg");
  command.add({"--html", &request.html, "FILE", "Write a page for the browser to FILE: one file, no network needed"})
      .writes("html");
  command.add({"--quiet", &request.quiet, "", "Print the verdict and warnings only"}).use = Use::output;
  command.add({"--verbose", &request.verbose, "", "Print all details"}).use = Use::output;
}

void add_seek_option(Command& command, std::string& seek) {
  command
      .add({"--seek", &seek, "WHAT",
            "settle: the equilibrium that the mechanism reaches from its start\nwhen released with heavy damping (the "
            "default); any: any\nequilibrium near the start (minimising methods find minima only);\nstable: minima "
            "only"})
      .choices = ways_to_seek;
}

void add_with_option(Command& command, Request& request) {
  command
      .add({"--with", &request.with, "FILE",
            "Result of poise identify --json FILE: the scene takes its estimates, and\nevery result gets an interval "
            "from their errors (docs/predictions.md)"})
      .reads("json");
}

void add_quantities_option(Command& command, std::vector<std::string>& names) {
  command.add({"--of", &names, "NAMES",
               "What to look at, with commas between: angle.BODY, travel.JOINT,\nx.BODY.POINT, length.ELEMENT, "
               "force.ELEMENT, reaction.JOINT or its\n.x, .y, .moment, .axial; stop.NAME; energy; d(A)/d(B); "
               "fold.load.LOAD, the\nload at which the mechanism snaps (docs/quantities.md)",
               Presence::required});
}

std::vector<std::string> comma_separated(const std::string& text) {
  // A comma at the end leaves an empty word behind it, which getline would not give.
  std::istringstream list(text + (text.empty() || text.back() == ',' ? "," : ""));
  std::vector<std::string> words;
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

void add_show_option(Command& command, std::vector<std::string>& names) {
  command.add({"--show", &names, "NAMES",
               "Quantities to show, with commas between: angle.BODY, x.BODY.POINT,\nlength.ELEMENT, force.ELEMENT, "
               "reaction.JOINT, push.BODY.POINT.x,\nd(A)/d(B), energy, ..., and expressions of them "
               "(docs/quantities.md)"});
}

std::vector<SoughtQuantity> read_quantities(const std::string& option, const std::vector<std::string>& names,
                                            const Scene& scene, AskedOf asked_of) {
  std::vector<SoughtQuantity> out;
  for (const std::string& list : names) {
    for (const std::string& name : comma_separated(list)) {
      if (name.empty())
        throw InputError(fmt::format("{} \"{}\": expected a name before and after each comma", option, list));
      SoughtQuantity found;
      try {
        found = find_quantity(scene, name, asked_of);
      } catch (const InputError& error) {
        const bool is_of_file = std::string_view(error.what()).starts_with(scene.file + ":");
        throw InputError(is_of_file ? error.what() : option + " " + error.what());
      }
      if (std::any_of(out.begin(), out.end(), [&](const SoughtQuantity& one) { return one.name == found.name; }))
        continue;
      out.push_back(std::move(found));
    }
  }
  return out;
}

std::vector<SoughtQuantity> read_of_position(const std::string& option, const std::vector<std::string>& names,
                                             const Scene& scene) {
  std::vector<SoughtQuantity> out = read_quantities(option, names, scene);
  for (const SoughtQuantity& one : out) {
    if (!one.is_over_path()) continue;
    throw InputError(
        fmt::format("{} {}: it belongs to a path, not to a position; expected another quantity, or poise "
                    "path --show",
                    option, one.name));
  }
  return out;
}

Shown read_shown(const std::string& option, const std::vector<std::string>& names, const Scene& scene) {
  Shown out;
  const auto add = [&](const SoughtQuantity& one) {
    std::vector<SoughtQuantity>& to = one.is_over_path() ? out.over_path : out.of_position;
    if (std::none_of(to.begin(), to.end(), [&](const SoughtQuantity& other) { return other.name == one.name; })) {
      to.push_back(one);
    }
  };
  // A load at a fold takes a path of its own.
  for (const SoughtQuantity& one : outputs_of(scene)) {
    if (!one.has(SoughtQuantity::Kind::load_at_fold)) add(one);
  }
  for (const SoughtQuantity& one : read_quantities(option, names, scene)) {
    if (one.has(SoughtQuantity::Kind::load_at_fold)) {
      throw InputError(
          fmt::format("{} {}: a load at a fold belongs to a path, not to a position; expected another "
                      "quantity, or poise sensitivity --of {}",
                      option, one.name, one.name));
    }
    add(one);
  }
  return out;
}

std::vector<SoughtQuantity> read_shown_in_position(const std::vector<std::string>& names, const Scene& scene) {
  read_of_position("--show", names, scene);
  return read_shown("--show", names, scene).of_position;
}

void add_proof_option(Command& command, std::optional<double>& seconds) {
  command.add({"--proof-seconds", &seconds, "S",
               "Time allowed for the proof of an answer, after which that is\n\"checked, not proved\" (a number of "
               "operations, about 10 s)"});
}

CertificateOptions read_proof(const std::optional<double>& seconds) {
  CertificateOptions out;
  out.seconds = seconds;
  if (seconds) expect_number("--proof-seconds", *seconds, *seconds >= 0, "a number >= 0");
  return out;
}

void add_lagrangian_options(Command& command, LagrangianWords& words) {
  command.add({"--scaling", &words.scaling, "K",
               "Of the augmented Lagrangian V + k lambda c + p/2 c^2: k > 0 (1),\nwhich changes rounding alone"});
  command.add(
      {"--penalty", &words.penalty, "P",
       "Of the augmented Lagrangian: p >= 0, in units in which forces and\nlengths of the mechanism are about 1 "
       "(10)"});
}

LagrangianWeights read_lagrangian(const LagrangianWords& words, const std::vector<Method>& methods) {
  LagrangianWeights out;
  for (const auto& [option, value] : {std::pair("--scaling", words.scaling), std::pair("--penalty", words.penalty)}) {
    if (!value || std::any_of(methods.begin(), methods.end(), has_weights)) continue;
    throw InputError(std::string(option) +
                     ": is of the augmented Lagrangian alone; expected the method augmented-lagrangian or "
                     "augmented-lagrangian-modified with it");
  }
  if (words.scaling) expect_number("--scaling", *words.scaling, *words.scaling > 0, "a number > 0");
  if (words.penalty) expect_number("--penalty", *words.penalty, *words.penalty >= 0, "a number >= 0");
  out.scaling = words.scaling.value_or(out.scaling);
  out.penalty = words.penalty.value_or(out.penalty);
  return out;
}

void add_jobs_option(Command& command, int& jobs, const std::string& help) {
  command.add({"--jobs", &jobs, "N", help});
}

int read_jobs(int jobs) {
  expect_number("--jobs", jobs, jobs >= 0 && jobs <= 1024, "a number from 0 (all cores) to 1024");
  return jobs;
}

Seek read_seek(const std::string& word) {
  constexpr Seek meanings[] = {Seek::settle, Seek::any, Seek::stable};
  return meanings[chosen("--seek", word, ways_to_seek)];
}

void read_word(const std::string& option, const std::string& word, double& value) {
  const std::optional<double> number = read_number(word);
  if (!number) throw InputError(fmt::format("{}: expected a number, found \"{}\"", option, word));
  value = *number;
}

void read_word(const std::string& option, const std::string& word, int& value) {
  read_whole_number(option, word, value);
}

void read_word(const std::string& option, const std::string& word, std::uint64_t& value) {
  read_whole_number(option, word, value);
}

void read_word(const std::string& option, const std::string& word, std::string& value) {
  if (word.empty()) {
    throw InputError(option + ": expected a word that is not empty" +
                     (option.starts_with('-') ? "; leave the option out" : ""));
  }
  value = word;
}

namespace {

struct OptionReader {
  const std::string& name;
  const std::string& word;

  void operator()(bool* flag) const { *flag = true; }
  void operator()(std::vector<std::string>* list) const { read_word(name, word, list->emplace_back()); }
  template <class Value>
  void operator()(std::optional<Value>* value) const {
    read_word(name, word, value->emplace());
  }
  void operator()(auto* value) const { read_word(name, word, *value); }
};

}  // namespace

void read_option(const Option& option, const std::string& word) {
  std::visit(OptionReader{option.name, word}, option.target);
}

void expect_number(const std::string& option, double value, bool fits, const std::string& expected) {
  if (fits && contains(Range::finite, value)) return;
  const bool too_large = fits && std::isfinite(value);
  throw InputError(
      fmt::format("{}: expected {}{}, found {}", option, expected, too_large ? ", within 1e50" : "", value));
}

void expect_between(const std::string& option, int value, int least, int most) {
  expect_number(option, value, value >= least && value <= most, fmt::format("a number from {} to {}", least, most));
}

void check_sweep(int steps, const std::optional<double>& rate) {
  expect_between("--steps", steps, 1, 1'000'000);
  if (rate) expect_number("--rate", *rate, *rate > 0, "a number > 0");
}

std::size_t chosen(const std::string& option, const std::string& word, const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  throw InputError(
      fmt::format("{}: expected {}, found \"{}\"{}", option, listed(words, "or"), word, did_you_mean(word, words)));
}

std::vector<std::string> start_words() { return {"auto", "given"}; }

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodTraits& method : all_methods()) names.emplace_back(method.name);
  return names;
}

std::vector<std::string> method_list_words() {
  std::vector<std::string> words = method_names();
  words.emplace_back("all");
  return words;
}

std::string method_help() {
  std::string text;
  for (const MethodTraits& method : all_methods()) {
    text += (text.empty() ? "" : "\n") + std::string(method.name) + ": " + method.what;
  }
  return text;
}

Method read_method(const std::string& option, const std::string& name) {
  return all_methods()[chosen(option, name, method_names())].method;
}

std::vector<Method> read_methods(const std::string& option, const std::string& names) {
  std::vector<Method> methods;
  if (names == "all") {
    for (const MethodTraits& method : all_methods()) methods.push_back(method.method);
    return methods;
  }
  const std::vector<std::string> known = method_list_words();
  for (const std::string& name : comma_separated(names)) {
    const std::size_t place = chosen(option, name, known);
    if (place + 1 == known.size()) return read_methods(option, "all");
    const Method method = all_methods()[place].method;
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
  }
  return methods;
}

std::vector<double> read_tolerances(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots != std::string::npos) {
    const std::string_view all = text;
    return decades(all.substr(0, dots), all.substr(dots + 2));
  }
  std::vector<double> out;
  for (const std::string& value : comma_separated(text)) out.push_back(read_tolerance(value));
  std::sort(out.begin(), out.end(), std::greater<>());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

NamedRange read_named_range(const std::string& option, const std::string& text, const std::string& expected) {
  const NamedText given = read_named_text(option, text, expected);
  const std::string_view range = given.text;
  const std::size_t dots = range.find("..");
  const bool is_ellipsis = range.find("...") != std::string_view::npos;
  const std::optional<double> from = read_number(range.substr(0, dots));
  const std::optional<double> to = dots == std::string_view::npos ? from : read_number(range.substr(dots + 2));
  if (is_ellipsis || !from || !to || !std::isfinite(*from) || !std::isfinite(*to)) {
    throw InputError(fmt::format("{} {}: \"{}\" is no range of numbers; expected {}", option, text, range, expected));
  }
  return {given.name, *from, *to};
}

std::vector<double> read_numbers(const std::string& option, const std::string& text) {
  std::vector<double> out;
  for (const std::string& word : comma_separated(text)) {
    const std::optional<double> value = read_number(word);
    if (!value || !std::isfinite(*value)) {
      throw InputError(
          fmt::format("{} {}: \"{}\" is not a number; expected numbers as in 1,2.5,5", option, text, word));
    }
    out.push_back(*value);
  }
  return out;
}

DriveRange read_drive(const std::string& text, const Scene& scene, const std::string& expected) {
  const NamedRange given = read_named_range("--drive", text, expected);
  const Measure& on = find_drive(scene, given.name).on;
  const double unit = unit_value(quantity_of(on), scene.units);
  // Every turn is followed; beyond this nobody waits for it.
  constexpr double most_turns = 1000.0;
  const double farthest = std::max(std::abs(given.from), std::abs(given.to)) * unit;
  if (on.is_angle() && farthest > most_turns * 2 * M_PI) {
    throw InputError(fmt::format("--drive {}: that is {:.3g} turns; expected angles within {} turns", text,
                                 farthest / (2 * M_PI), most_turns));
  }
  return {given.name, given.from * unit, given.to * unit};
}

void add_experiment_options(Command& command, ExperimentRequest& request, std::vector<std::string>* several) {
  request.common.kind = "experiment";
  if (several != nullptr) {
    command
        .add({"EXPERIMENT", several, "",
              "Experiment file (TOML); of several, models of the same readings are\ncompared", Presence::required})
        .reads("toml");
  } else {
    command.add({"EXPERIMENT", &request.common.scene, "", "Experiment file (TOML)", Presence::required}).reads("toml");
  }
  command
      .add({"--data", &request.data, "FILE",
            "Read this CSV file in place of the one that the experiment's\nruns name (all the same)"})
      .reads("csv");
  add_settings(command, request.common);
}

Experiment load_experiment(const ExperimentRequest& request) {
  quiet_ceres();
  const Caller* const caller = request.common.caller;
  Experiment experiment = read_experiment(request.common.scene, {.data = request.data,
                                                                 .settings = request.common.settings,
                                                                 .scene = caller != nullptr ? caller->scene : nullptr});
  if (experiment.unknowns.empty()) {
    throw InputError(experiment.file +
                     ":1: unknown: expected at least one [[unknown]]; add one with path = \"body.arm.mass\", say");
  }
  return experiment;
}

std::vector<std::string> files_read(const Experiment& experiment) {
  std::vector<std::string> files = {experiment.scene.file};
  const auto add = [&](const std::filesystem::path& file) {
    if (std::find(files.begin(), files.end(), file.string()) == files.end()) files.push_back(file.string());
  };
  for (const ExperimentPart& part : experiment.parts) {
    add(part.file);
    add(part.scene.file);
  }
  for (const Run& run : experiment.runs) {
    for (const std::filesystem::path& data : run.data) add(data);
    for (const RunInput& input : run.inputs) add(input.file);
  }
  return files;
}

}  // namespace poise::app
