#include "app/results/motion/equations.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/motion/motion.hpp"
#include "model/named_number.hpp"
#include "motion/equation_code.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> equation_positions = {"equilibrium", "start"};

struct EquationsRequest {
  Request common;
  std::vector<std::string> at, rates;
  std::optional<double> time;
  std::string from;
  std::string seek = "settle";
  std::string coordinates;
};

// Places in Request::exported.
enum Language : std::size_t { in_c, in_python, languages };

void check(const EquationsRequest& request) {
  if (request.time) expect_number("--time", *request.time, *request.time >= 0, "seconds >= 0");
  if (!request.from.empty()) chosen("--from", request.from, equation_positions);
}

std::vector<std::string> names_between_commas(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

std::vector<AskedValue> read_asked_values(const std::string& option, const std::vector<std::string>& texts,
                                          const MotionModel& model) {
  const std::vector<Channel> channels = channels_of(model);
  const bool is_rate = option == "--rate";
  std::vector<AskedValue> out;
  for (const std::string& text : texts) {
    const NamedNumber given = read_named_number(option, text, "NAME=NUMBER, say crank=30");
    const std::string asked = fmt::format("{} {}", option, text);
    expect_number(asked, given.value, true, "a finite number");
    const Channel& channel = channel_named(asked, given.name, channels);
    const double si = given.value * unit_value(channel.quantity, model.scene().units);
    out.push_back({channel, is_rate ? si : si - channel.offset});
  }
  return out;
}

/// Where the mechanism is, in words.
std::string position_in_words(const EquationsRequest& request, const MotionOrigin& origin, double t) {
  std::string words = origin.stability ? "equilibrium" : "as assembled";
  if (!request.at.empty()) words += fmt::format(", moved to {}", fmt::join(request.at, ", "));
  if (t != 0.0) words += fmt::format(", at t = {} s", t);
  if (!request.rates.empty()) words += fmt::format(", with the rates {} per second", fmt::join(request.rates, ", "));
  return words;
}

int run_equations(const EquationsRequest& request, const Palette& palette) {
  const Request& common = request.common;
  check(request);
  Progress progress(common.listener());
  progress.now("reading the scene");
  const MotionModel model(load_moving_scene(common));
  const std::vector<AskedValue> at = read_asked_values("--at", request.at, model);
  const std::vector<AskedValue> rates = read_asked_values("--rate", request.rates, model);
  OutputFiles files(common);
  progress.now("looking for the equilibrium");
  const bool assembled = request.from == "start" || (request.from.empty() && !model.scene().drives.empty());
  const MotionOrigin origin =
      assembled ? MotionOrigin{} : equilibrium_origin(model, read_seek(request.seek), &common.interrupt());
  if (!origin.found()) {
    const Result none = no_origin_result(model, origin.why, common.settings);
    return finish(common, none, nullptr, {}, false, progress, palette);
  }
  const double t = request.time.value_or(0.0);
  EquationsAnswer answer;
  answer.position = position_in_words(request, origin, t);
  answer.state = equation_state(model, origin, at, rates, t);
  answer.equations = equations_of_motion(model, origin, answer.state, names_between_commas(request.coordinates));
  answer.numbers = numbers_at(answer.equations, answer.state);
  const Result result = equations_result(answer, common.settings);
  progress.now("writing the result");
  std::vector<std::string> texts(languages);
  if (!common.exported[in_c].second.empty()) texts[in_c] = c_code(answer.equations);
  if (!common.exported[in_python].second.empty()) texts[in_python] = python_code(answer.equations);
  const std::string written = files.write(result, {}, "", texts);
  progress.done();
  print(common, result, written, palette);
  return answer.numbers.status == ReducedMotion<double>::Status::ok ? solved : not_solved;
}

}  // namespace

Command equations_command() {
  const auto request = std::make_shared<EquationsRequest>();
  Command command{"equations", "Hand out the equation of motion: as numbers, as C and as Python"};
  add_scene_options(command, request->common);
  const auto add_list = [&](const std::string& name, std::vector<std::string>& list, const std::string& text) {
    command.add({name, &list, "NAME=NUMBER", text});
  };
  add_list("--at", request->at,
           "Where this body or joint is: its angle in the world or its travel,\nin the scene's units; several times");
  add_list("--rate", request->rates, "Its speed, per second; several times");
  command.add({"--time", &request->time, "S", "Time at which loads and drives are taken, s (0)"});
  command
      .add({"--from", &request->from, "WHAT",
            "Where everything else is. equilibrium: in the one near the start (the\ndefault without drives); start: as "
            "it is assembled (the default with\ndrives)"})
      .choices = equation_positions;
  add_seek_option(command, request->seek);
  command.add({"--coordinates", &request->coordinates, "NAMES",
               "The coordinates z of the equation, with commas between; those that are\nmissing, or all, are chosen"});
  auto& exported = request->common.exported;
  exported.resize(languages);  // options point into it
  exported[in_c].first = "--code";
  exported[in_python].first = "--python";
  command.add({"--code", &exported[in_c].second, "FILE", "Write functions in C99 to FILE"}).writes("c");
  command.add({"--python", &exported[in_python].second, "FILE", "Write the same in Python to FILE"}).writes("py");
  add_output_options(command, request->common, {.csv = "Write the equation, one line for each coordinate, to FILE"});
  command.run = [request](const Palette& palette) { return run_equations(*request, palette); };
  return command;
}

}  // namespace poise::app
