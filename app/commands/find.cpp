#include "app/results/statics/find.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/commands/vary.hpp"
#include "app/results/statics/quantities.hpp"
#include "model/named_number.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {
namespace {

struct FindRequest {
  Request common;
  std::vector<std::string> vary, wanted, show;
  std::string from = "settle";
  bool all = false;
  std::optional<double> proof_seconds;
};

/// A part of it is no number.
bool depends_on_something(const SoughtQuantity& of) {
  if (of.of.empty()) return of.kind != SoughtQuantity::Kind::number;
  return std::any_of(of.of.begin(), of.of.end(), depends_on_something);
}

/// "QUANTITY = VALUE", the value in the quantity's unit.
WantedValue read_wanted(const std::string& text, const Scene& scene) {
  const std::size_t sign = text.rfind('=');
  const auto trimmed = [](const std::string& word) {
    const std::size_t first = word.find_first_not_of(' '), last = word.find_last_not_of(' ');
    return first == std::string::npos ? std::string() : word.substr(first, last - first + 1);
  };
  const std::string name = trimmed(text.substr(0, sign));
  const std::string word = sign == std::string::npos ? "" : trimmed(text.substr(sign + 1));
  const std::optional<double> value = read_number(word);
  if (name.empty() || !value || !std::isfinite(*value)) {
    throw InputError(fmt::format("--for: expected \"QUANTITY = VALUE\", say \"angle.arm = 60\", found \"{}\"", text));
  }
  const std::vector<SoughtQuantity> of = read_quantities("--for", {name}, scene);
  if (of.size() != 1) throw InputError(fmt::format("--for {}: expected one quantity, found {}", text, of.size()));
  if (of[0].kind != SoughtQuantity::Kind::load_at_fold && !depends_on_something(of[0])) {
    throw InputError(fmt::format("--for {}: expected a quantity of the mechanism, found a number", text));
  }
  if (of[0].is_over_path() && of[0].kind != SoughtQuantity::Kind::load_at_fold) {
    throw InputError(fmt::format("--for {}: it belongs to a path, not to a position; expected another quantity", text));
  }
  if (of[0].has(SoughtQuantity::Kind::load_at_fold) && of[0].kind != SoughtQuantity::Kind::load_at_fold) {
    throw InputError(fmt::format("--for {}: expected a load at a fold alone, not in an expression", text));
  }
  return {of[0], *value * of[0].dimension.unit(scene.units)};
}

void refuse_fold(const WantedValue& wanted, bool is_refused, const std::string& where) {
  if (!is_refused || wanted.of.kind != SoughtQuantity::Kind::load_at_fold) return;
  throw InputError(fmt::format("--for {}: a load at a fold is not sought {}; expected one number of the scene",
                               wanted.of.name, where));
}

FindOptions read_find_options(const FindRequest& request) {
  FindOptions options;
  options.path.from = read_from(request.from);
  options.path.certificate = read_proof(request.proof_seconds);
  options.path.interrupt = &request.common.interrupt();
  options.all = request.all;
  options.others = other_quantity;
  return options;
}

int finish_find(const FindRequest& request, const FindView& view, const FoundSet& found, OutputFiles& files,
                Progress& progress, const Palette& palette) {
  const Result result = find_result(view, found, request.common.settings);
  Pictures pictures;
  const std::vector<Panel> panels = find_panels(view, found);
  if (!panels.empty() && files.wants_svg()) pictures.svg = draw_plot(panels);
  if (!panels.empty() && files.wants_html()) pictures.figures = chart_figures("What was sought", panels);
  return finish(request.common, result, &files, pictures, is_settled(found), progress, palette);
}

int run_find(const FindRequest& request, const Palette& palette) {
  FindOptions options = read_find_options(request);
  const std::size_t count = request.vary.size();
  if (count > 2 || count != request.wanted.size()) {
    throw InputError(fmt::format(
        "expected as many --for as --vary, one or two, found {} of --vary and {} of --for; each condition determines "
        "one number",
        count, request.wanted.size()));
  }
  if (count == 2 && request.all) throw InputError("--all: expected one --vary, found two");
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const Scene scene = load_scene(request.common);
  const NamedRange first = read_vary_range(request.vary[0]);
  FindView view{.all = request.all};
  const auto read_conditions = [&](const Scene& varied) {
    view.shown = read_shown_in_position(request.show, varied);
    for (const std::string& text : request.wanted) view.wanted.push_back(read_wanted(text, varied));
    std::erase_if(view.shown, [&](const SoughtQuantity& one) {
      return std::any_of(view.wanted.begin(), view.wanted.end(),
                         [&](const WantedValue& wanted) { return wanted.of.name == one.name; });
    });
    if (count == 2 && view.wanted[0].of.name == view.wanted[1].of.name) {
      throw InputError(fmt::format("--for {}: given twice; expected two quantities", view.wanted[0].of.name));
    }
    for (const WantedValue& one : view.wanted) {
      if (one.of.kind == SoughtQuantity::Kind::load_at_fold && one.of.load == first.name) {
        throw InputError(fmt::format("--for {}: it is a value of {} itself; expected another number for --vary",
                                     one.of.name, first.name));
      }
      refuse_fold(one, count == 2, "with two numbers");
    }
  };
  if (count == 1) {
    const VariedScene varied = naming_vary([&] { return VariedScene(scene, first.name, first.from, first.to); });
    read_conditions(named_scene(varied));
    refuse_fold(view.wanted[0], varied.is_driven(), "of a driven measure");
    view.numbers = {&varied};
    OutputFiles files(request.common);
    options.path.progress = progress_of(progress, varied);
    progress.now("following the curve of equilibria");
    const FoundSet found = naming_vary([&] { return find_numbers(varied, view.wanted[0], options); });
    return finish_find(request, view, found, files, progress, palette);
  }
  const NamedRange second = read_vary_range(request.vary[1]);
  const VariedPair pair = naming_vary([&] {
    return VariedPair(scene, {first.name, first.from, first.to}, {second.name, second.from, second.to});
  });
  read_conditions(named_scene(pair.first()));
  view.numbers = {&pair.first(), &pair.second()};
  OutputFiles files(request.common);
  options.path.progress = progress_of(progress, pair.first());
  progress.now("following curves of equilibria");
  return finish_find(request, view, find_numbers(pair, view.wanted, options), files, progress, palette);
}

}  // namespace

Command find_command() {
  const auto request = std::make_shared<FindRequest>();
  Command command{"find", "Find the number for which a quantity has a value in equilibrium, and prove it"};
  add_scene_options(command, request->common);
  command.add({"--vary", &request->vary, "NAME=FROM..TO",
               "The number that is sought and its range, in its own units: a number of\nthe scene, loads, or a measure "
               "that is driven, angle.BODY or\nlength.ELEMENT; twice with two --for",
               Presence::required});
  command.add({"--for", &request->wanted, "\"Q = VALUE\"",
               "The quantity and the value that it is to have, in its unit\n(docs/quantities.md): \"force.rubber = "
               "-700\"",
               Presence::required});
  command.add({"--all", &request->all, "",
               "Also on the curves through all equilibria at both ends of the range\nand in its middle"});
  command
      .add({"--from", &request->from, "WHAT",
            "settle: where the mechanism comes to rest when released from its\nstart (the default); equilibrium: the "
            "one nearest to the start"})
      .choices = from_words();
  add_show_option(command, request->show);
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the quantity over the number, with the values found, into FILE",
                      .csv = "Write the values, one line each, to FILE"});
  command.run = [request](const Palette& palette) { return run_find(*request, palette); };
  return command;
}

}  // namespace poise::app
