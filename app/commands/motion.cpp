#include "app/results/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/chart/quantity_charts.hpp"
#include "app/draw/mechanism.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/present/csv.hpp"
#include "app/results/motion/contact_events.hpp"
#include "app/results/predictions.hpp"
#include "model/controllers.hpp"
#include "model/joint_friction.hpp"
#include "model/named_number.hpp"
#include "motion/forces_in_time.hpp"
#include "motion/release.hpp"
#include "statics/sensitivity/differences.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> motion_starts = {"equilibrium", "start"};

struct MotionRequest {
  Request common;
  double duration = 0.0;
  double rate = 1000.0;
  std::vector<std::string> release, release_rate;
  std::string from;
  std::string seek = "settle";
  double noise = 0.0;
  std::uint64_t seed = 1;
  double accuracy = 1e-10;
  std::vector<std::string> show;
  bool forces = false;
  std::vector<std::string> motors;

  bool wants_forces() const { return forces || !motors.empty(); }
};

// Numbers of a record, all columns together; a larger file is taken for a mistake in --rate or --duration.
constexpr double most_numbers = 2e8;
// Forces on bodies, joints, elements and stops at all times; they take some hundred bytes each.
constexpr double most_forces = 4e6;

void check(const MotionRequest& request) {
  expect_number("--duration", request.duration, request.duration > 0, "seconds > 0");
  expect_number("--rate", request.rate, request.rate > 0, "samples per second > 0");
  expect_number("--accuracy", request.accuracy, request.accuracy >= 1e-13 && request.accuracy <= 1e-2,
                "a number from 1e-13 to 1e-2");
  expect_number("--noise", request.noise, request.noise >= 0, "a standard deviation >= 0");
  if (request.noise > 0 && request.common.csv.empty() && request.common.caller == nullptr) {
    throw InputError("--noise: there is no record to add it to; expected --csv FILE too");
  }
  if (request.noise > 0 && !request.show.empty()) {
    throw InputError("--noise: it is added to the record of all angles and travels; expected no --show with it");
  }
  if (request.wants_forces() && !request.show.empty()) {
    throw InputError("--show: with --forces all forces are shown and written; expected one of the two");
  }
  if (!request.from.empty()) chosen("--from", request.from, motion_starts);
}

void expect_record_of_a_size(const MotionRequest& request, const MotionModel& model) {
  const std::size_t columns = 3 * channels_of(model).size() + 6 * points_of(model.scene()).size() + 3;
  const double numbers = request.duration * request.rate * static_cast<double>(columns);
  const Scene& scene = model.scene();
  const double forces =
      request.duration * request.rate *
      static_cast<double>(scene.bodies.size() + scene.joints.size() + scene.elements.size() + scene.stops.size());
  if (request.wants_forces() && forces > most_forces) {
    throw InputError(fmt::format("--rate: {} samples per second for {} s make {:.2g} forces; expected {:.2g} at most",
                                 request.rate, request.duration, forces, most_forces));
  }
  if (numbers <= most_numbers) return;
  throw InputError(fmt::format("--rate: {} samples per second for {} s make {:.2g} numbers; expected {:.2g} at most",
                               request.rate, request.duration, numbers, most_numbers));
}

/// The motors that are named, with commas between.
std::vector<Drive> read_motors(const MotionRequest& request, const Scene& scene) {
  std::vector<Drive> out;
  if (request.motors.empty()) return out;
  if (scene.drives.empty()) {
    throw InputError(
        "--motors: the scene prescribes no motion for motors to make; expected a [[drive]] for each condition");
  }
  for (const std::string& list : request.motors) {
    for (const std::string& name : comma_separated(list)) {
      const std::string where = "--motors " + name;
      if (std::any_of(out.begin(), out.end(), [&](const Drive& one) { return one.name == name; })) {
        throw InputError(where + ": it is named twice; expected each motor once");
      }
      out.push_back(find_motor(where, scene, name));
    }
  }
  return out;
}

MotionOrigin find_origin(const MotionRequest& request, const MotionModel& model, const std::atomic<bool>& interrupt) {
  const bool assembled =
      request.from == "start" ||
      (request.from.empty() && (!model.scene().drives.empty() || !controllers_of(model.scene()).empty()));
  return assembled ? MotionOrigin{} : equilibrium_origin(model, read_seek(request.seek), &interrupt);
}

/// How the motion starts, in words, before any displacement.
std::string words_of(const MotionOrigin& origin) {
  if (origin.stability) return fmt::format("equilibrium ({})", to_string(*origin.stability));
  return origin.kind == MotionOrigin::Kind::unloaded ? "as assembled, which nothing loads" : "as assembled";
}

std::vector<Displacement> read_displacements(const MotionRequest& request, const MotionModel& model,
                                             std::string& words) {
  const Units& units = model.scene().units;
  const std::vector<Channel> channels = channels_of(model);
  std::vector<Displacement> out;
  const auto read = [&](const std::string& option, const std::string& text, bool is_rate) {
    const NamedNumber given = read_named_number(option, text, "NAME=NUMBER, say boom=0.5");
    expect_number(option + " " + text, given.value, true, "a finite number");
    const Channel& channel = channel_named(option + " " + text, given.name, channels);
    out.push_back({channel, is_rate, given.value * unit_value(channel.quantity, units)});
    const std::string unit = unit_name(channel.quantity, units);
    words += is_rate ? fmt::format(", {} started at {} {}/s", given.name, given.value, unit)
                     : fmt::format(", {} displaced by {} {} and released", given.name, given.value, unit);
  };
  for (const std::string& text : request.release) read("--release", text, false);
  for (const std::string& text : request.release_rate) read("--release-rate", text, true);
  return out;
}

/// Why a quantity has no meaning in motion; empty where it has one.
std::string why_refused(const Scene& scene, const SoughtQuantity& of) {
  try {
    refuse_at_rest_only(scene, of);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// The outputs of the scene that have a meaning in motion, with what is said of the others.
std::vector<SoughtQuantity> outputs_in_motion(const Scene& scene, std::vector<std::string>& left_out) {
  std::vector<SoughtQuantity> out;
  for (SoughtQuantity& one : outputs_of(scene, AskedOf::motion)) {
    if (std::string why = why_refused(scene, one); !why.empty())
      left_out.push_back(std::move(why));
    else
      out.push_back(std::move(one));
  }
  return out;
}

/// What --show asks for of a scene that is not yet resisted_by_joints().
std::vector<SoughtQuantity> read_asked(const MotionRequest& request, const Scene& scene) {
  std::vector<SoughtQuantity> out = read_quantities("--show", request.show, scene, AskedOf::motion);
  for (const SoughtQuantity& one : out) {
    if (const std::string why = why_refused(scene, one); !why.empty()) throw InputError("--show " + why);
  }
  return out;
}

/// Charts of quantities, then those of the record.
std::vector<Panel> with_record(std::vector<Panel> panels, const Scene& scene, const MotionAnswer& answer) {
  for (Panel& panel : motion_panels(scene, answer.record, answer.found.motion.events))
    panels.push_back(std::move(panel));
  return panels;
}

/// Shows how far a motion has come.
std::function<void(double)> progress_of(Progress& progress, const std::string& doing, double duration) {
  return [&progress, doing, duration](double t) {
    progress.now_and_then([&] { return fmt::format("{}: {:.4g} s of {:.4g} s", doing, t, duration); });
  };
}

/// What a fit says of a motion: of the least, the greatest and the mean value of each quantity that is shown, or of
/// where the coordinates end.
class PredictedMotion {
 public:
  PredictedMotion(const MotionRequest& request, const std::vector<SoughtQuantity>& shown, const MotionOptions& options)
      : request_(request), shown_(shown), options_(options) {
    options_.progress = nullptr;
  }

  /// `found` is the motion of the scene; its numbers are those of the fit. Returns whether all have an interval.
  bool add(Result& result, const FittedNumbers& numbers, const Scene& scene, const MotionModel& model,
           const ConfirmedMotion& found) {
    std::vector<ComputedResult> results = results_of(scene, model, found.motion);
    constexpr double rounding = 1e-9;
    for (ComputedResult& one : results) one.error = std::max(rounding, found.error.value_or(1.0)) * std::abs(one.error);
    const auto at = [&](const Scene& other) -> std::optional<std::vector<double>> {
      try {
        const MotionModel moved(resisted_by_joints(other));
        const MotionOrigin origin = find_origin(request_, moved, request_.common.interrupt());
        if (!origin.found()) return std::nullopt;
        std::string words;
        const Motion motion =
            simulate(moved, release(moved, origin, read_displacements(request_, moved, words)), options_);
        if (!motion.completed()) return std::nullopt;
        return each(results_of(other, moved, motion), [](const ComputedResult& one) { return one.value; });
      } catch (const InputError&) {  // the mechanism cannot be assembled so
        return std::nullopt;
      }
    };
    return add_predictions(result, numbers, predict_by_differences(numbers, scene, results, at), scene.units);
  }

 private:
  /// In `error` the size to which an error is relative.
  std::vector<ComputedResult> results_of(const Scene& scene, const MotionModel& model, const Motion& motion) const {
    std::vector<ComputedResult> out;
    if (shown_.empty()) {
      const MotionRecord rec = record(model, motion, request_.rate, false);
      for (std::size_t c = 0; c < rec.channels.size(); ++c) {
        const auto [least, greatest] = std::minmax_element(rec.value[c].begin(), rec.value[c].end());
        const Dimension dimension = rec.channels[c].quantity == Quantity::angle ? dimension::angle : dimension::length;
        out.push_back({rec.channels[c].name + " at the end", dimension, rec.value[c].back(),
                       std::max(std::abs(*least), std::abs(*greatest))});
      }
      return out;
    }
    QuantitiesAlong along(scene, model, motion);
    const QuantitiesInTime found = quantities_in_time(shown_, {0.0, request_.duration}, request_.duration, along);
    for (const QuantitiesInTime::Once& one : found.once) {
      out.push_back({one.of.name, one.of.dimension, one.value, one.value});
    }
    for (std::size_t q = 0; q < found.of.size(); ++q) {
      const QuantityRange& range = found.range[q];
      const double size = std::max(std::abs(range.least.value), std::abs(range.greatest.value));
      const auto& [name, dimension] = std::tie(found.of[q].name, found.of[q].dimension);
      out.push_back({"least " + name, dimension, range.least.value, size});
      out.push_back({"greatest " + name, dimension, range.greatest.value, size});
      out.push_back({"mean " + name, dimension, range.mean, size});
    }
    return out;
  }

  const MotionRequest& request_;
  const std::vector<SoughtQuantity>& shown_;
  MotionOptions options_;
};

int run_motion(const MotionRequest& request, const Palette& palette) {
  check(request);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const Scene scene = load_moving_scene(request.common);
  std::vector<std::string> left_out;
  const bool asked = !request.show.empty();
  const std::vector<SoughtQuantity> shown = asked ? read_asked(request, scene) : outputs_in_motion(scene, left_out);
  const std::vector<Drive> motors = read_motors(request, scene);
  const MotionModel model(resisted_by_joints(scene));
  refuse_rubbing_ropes(model.scene(), "motion");
  expect_record_of_a_size(request, model);
  OutputFiles files(request.common);
  const std::atomic<bool>& interrupt = request.common.interrupt();

  progress.now("looking for the equilibrium");
  const MotionOrigin origin = find_origin(request, model, interrupt);
  if (!origin.found()) {
    const Result result = no_origin_result(model, origin.why, request.common.settings);
    return finish(request.common, result, nullptr, {}, false, progress, palette);
  }
  MotionAnswer answer;
  answer.start = words_of(origin);
  const std::vector<Displacement> displaced = read_displacements(request, model, answer.start);
  if (displaced.empty() && origin.q && model.scene().drives.empty() && model.scene().time_functions.empty())
    answer.start += "; already at equilibrium, use --release to displace it";
  answer.duration = request.duration;
  answer.accuracy = request.accuracy;
  MotionOptions options;
  options.duration = request.duration;
  options.accuracy = request.accuracy;
  options.interrupt = &interrupt;
  options.progress = progress_of(progress, "moving", request.duration);
  answer.found = simulate_and_confirm(model, release(model, origin, displaced), options,
                                      progress_of(progress, "estimating the error", request.duration));

  progress.now("writing the result");
  answer.record =
      record(model, answer.found.motion, request.rate, (files.wants_csv() || request.wants_forces()) && !asked);
  const bool moved = answer.found.motion.trajectory.nodes() > 1;
  if (request.wants_forces() && moved) {
    progress.now("finding the forces");
    answer.forces = forces_in_time(scene, model, answer.found.motion, answer.record,
                                   {.motors = motors,
                                    .accuracy = request.accuracy,
                                    .interrupt = &interrupt,
                                    .progress = progress_of(progress, "finding the forces", request.duration)});
  }
  if (!shown.empty() && moved) {
    QuantitiesAlong along(scene, model, answer.found.motion);
    answer.shown = quantities_in_time(shown, answer.record.time, answer.found.motion.trajectory.t.back(), along);
    answer.shown.are_all = asked;
    answer.shown.left_out = left_out;
  }
  MotionRecord measured;
  if ((files.wants_csv() || answer.forces) && !asked) measured = answer.record;
  if (request.noise > 0) add_noise(measured, model.scene().units, request.noise, request.seed);
  Result result = motion_result(model, answer, measured, request.common.settings);
  bool all_predicted = true;
  if (const std::optional<FittedNumbers> fit = load_fit(request.common, scene);
      fit && answer.found.motion.completed()) {
    progress.now("moving with other numbers of the fit");
    all_predicted = PredictedMotion(request, shown, options).add(result, *fit, scene, model, answer.found);
  }
  std::vector<Panel> panels =
      quantity_panels(answer.shown.of, answer.shown.value, scene.units, answer.shown.time, "time (s)");
  if (answer.forces) {
    for (Panel& panel : forces_in_time_panels(scene, *answer.forces)) panels.push_back(std::move(panel));
  }
  Pictures pictures;
  if (files.wants_svg() && answer.found.motion.trajectory.nodes() > 0) {
    pictures.svg = stacked(motion_picture(model, answer.found.motion, result.verdict.text, answer.found.confirmed()),
                           draw_plot(asked && !panels.empty() ? panels : with_record(panels, scene, answer)));
  }
  if (files.wants_html() && answer.found.motion.trajectory.nodes() > 0) {
    pictures.figures = {motion_figure(scene, model, answer.found.motion, answer.record,
                                      with_record(panels, scene, answer), answer.found.confirmed())};
  }
  const std::string events = csv_text(table_of_contact_events(model, answer.found.motion));
  return finish(request.common, result, &files, pictures, answer.is_good() && all_predicted, progress, palette, "",
                {events});
}

}  // namespace

Command motion_command() {
  const auto request = std::make_shared<MotionRequest>();
  Command command{"motion", "Simulate free or driven motion, from equilibrium or from a displaced position"};
  add_scene_options(command, request->common);
  add_with_option(command, request->common);
  command.add({"--duration", &request->duration, "S", "Duration of the motion, s", Presence::required});
  command.add({"--rate", &request->rate, "HZ", "Samples per second of the record (1000)"});
  const auto add_list = [&](const std::string& name, std::vector<std::string>& list, const std::string& text) {
    command.add({name, &list, "NAME=NUMBER", text});
  };
  add_list("--release", request->release,
           "Start with this body turned, or joint moved, by so much from the\npose of --from, in the scene's units; "
           "several times");
  add_list("--release-rate", request->release_rate, "The same with a speed, per second");
  command
      .add({"--from", &request->from, "WHAT",
            "equilibrium: the one near the start (the default without drives and\ncontrollers);\nstart: as it is "
            "assembled (the default with them)"})
      .choices = motion_starts;
  add_seek_option(command, request->seek);
  command.add({"--noise", &request->noise, "SIGMA",
               "Standard deviation of Gaussian noise added to the angles and\ntravels of --csv, in the scene's units"});
  command.add({"--seed", &request->seed, "N", "Of the noise (1)"});
  command.add({"--accuracy", &request->accuracy, "NUMBER", "Relative accuracy of the motion (1e-10)"});
  add_show_option(command, request->show);
  command.add(
      {"--forces", &request->forces, "",
       "At every instant of the record the forces of drives with their power\nand work, of joints and elements, "
       "of inertia, and internal loads of\nlinks: columns of --csv, largest values, charts"});
  command.add(
      {"--motors", &request->motors, "NAMES",
       "Torques of pins or forces along slides, with commas between, that make\nthe motion in place of the drives, "
       "which say what it is to be;\nimplies --forces"});
  request->common.exported = {{"--events", ""}};  // the option points into it
  command
      .add({"--events", &request->common.exported.front().second, "FILE",
            "Write the events at stops, contacts and ropes to FILE as CSV, one line\neach: impact, rest, lift-off, "
            "stick, slide"})
      .writes("csv");
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism at the start, in the middle and at the end, and\nangles, travels and "
                             "energies over time, or what --show names,\ninto FILE",
                      .csv = "Write the record, one line for each sample, or time and what\n--show names, to FILE"});
  command.run = [request](const Palette& palette) { return run_motion(*request, palette); };
  return command;
}

}  // namespace poise::app
