#include "app/commands/forces.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/drive_option.hpp"
#include "app/commands/scene_options.hpp"
#include "app/commands/session.hpp"
#include "app/interrupt.hpp"
#include "app/motion_record.hpp"
#include "app/report/forces_report.hpp"
#include "identification/record.hpp"
#include "motion/given_motion.hpp"
#include "motion/simulate.hpp"

namespace poise::app {
namespace {

struct ForcesRequest {
  Request common;
  std::vector<std::string> drives;
  std::string motion;
  int steps = 72;
  std::optional<double> rate;
};

constexpr int most_steps = 1000000;
// A recorded motion is differentiated, so bodies balance only as well as its samples tell.
constexpr double balanced_by_samples = 1e-6;

bool has_range(const std::string& drive) { return drive.find('=') != std::string::npos; }

void check(const ForcesRequest& request) {
  std::size_t ranges = 0;
  for (const std::string& drive : request.drives) ranges += has_range(drive);
  if (ranges != 0 && ranges != request.drives.size()) {
    throw InputError("--drive: expected a range for every drive, or for none; say crank=0..360");
  }
  if (ranges != 0 && !request.motion.empty()) {
    throw InputError("--motion: it says how everything moves; expected --drive NAME without a range, or no --motion");
  }
  if (request.rate && ranges == 0) throw InputError("--rate: nothing is driven; expected --drive NAME=FROM..TO too");
  if (request.rate && !(*request.rate > 0.0 && std::isfinite(*request.rate))) {
    throw InputError(fmt::format("--rate: expected a number > 0, found {}", *request.rate));
  }
  if (request.steps < 1 || request.steps > most_steps) {
    throw InputError(fmt::format("--steps: expected a number from 1 to {}, found {}", most_steps, request.steps));
  }
}

/// The scene with the drives asked for in the place of its own.
Scene with_drives(Scene scene, const std::vector<std::string>& drives) {
  if (drives.empty()) return scene;
  std::vector<Drive> wanted;
  for (const std::string& text : drives) wanted.push_back(find_drive(scene, text.substr(0, text.rfind('='))));
  scene.drives = std::move(wanted);
  return scene;
}

/// Throws InputError where the drives begin in a pose that a stop bars.
void expect_within_stops(const Scene& scene, const Forces& forces) {
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (forces.overrun[s] == 0.0) continue;
    const Quantity quantity = quantity_of(scene.stops[s].on);
    throw InputError(
        fmt::format("{}: drive: the pose in which the drives begin is beyond the stop \"{}\" by {} {}; "
                    "expected one within the stops; change a drive's start, or say --drive NAME=VALUE",
                    scene.file, scene.stops[s].name, significant(in_unit(forces.overrun[s], quantity, scene.units), 6),
                    unit_name(quantity, scene.units)));
  }
}

ForcesAnswer in_place(const MotionModel& model) {
  ForcesAnswer answer;
  answer.how = "standing still where the scene's start puts it";
  const std::vector<double> x = model.from_si(start_motion(model, {}).q);
  const std::vector<double> still(x.size(), 0.0);
  answer.poses.push_back(forces_of(model, x, still, still, model.scene().drives));
  expect_within_stops(model.scene(), answer.poses.front());
  return answer;
}

ForcesAnswer over_range(const MotionModel& model, const ForcesRequest& request, Progress& progress) {
  const Scene& scene = model.scene();
  std::vector<DriveRange> ranges;
  for (const std::string& text : request.drives) ranges.push_back(read_drive(text, scene));
  std::size_t moving = 0;
  while (moving + 1 < ranges.size() && ranges[moving].from == ranges[moving].to) ++moving;
  const Quantity quantity = quantity_of(scene.drives[moving].on);
  SweepOptions options;
  options.steps = request.steps;
  options.interrupt = &watch_for_interrupt();
  if (request.rate) options.rate = *request.rate * unit_value(quantity, scene.units);
  progress.now("driving the mechanism");
  const KinematicsResult path = sweep(scene, ranges, options);

  ForcesAnswer answer;
  answer.complete = path.complete;
  answer.why = path.why;
  answer.stop = path.stop;
  answer.how = request.rate ? fmt::format("driven, {} at {} {}/s", ranges[moving].name, *request.rate,
                                          unit_name(quantity, scene.units))
                            : "standing still in every pose";
  const bool single = path.samples.size() == 1;
  if (!single) {
    answer.along = ranges[moving].name;
    answer.measure = quantity;
  }
  progress.now("balancing the bodies");
  for (const KinematicSample& at : path.samples) {
    const std::vector<double> still(at.q.size(), 0.0);
    if (!single) answer.at.push_back(at.drive[moving]);
    answer.poses.push_back(forces_of(model, model.from_si(at.q), request.rate ? model.from_si(at.rate) : still,
                                     request.rate ? model.from_si(at.acceleration) : still, scene.drives));
  }
  return answer;
}

/// The names in the first line of a table of numbers.
std::vector<std::string> header_of(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    throw InputError(fmt::format("--motion: cannot read \"{}\"; expected a CSV file with a header", file));
  }
  std::vector<std::string> names(1);
  for (const char c : line) {
    if (c == ',' || c == ';' || c == '\t')
      names.emplace_back();
    else if (c != '"' && c != '\r')
      names.back() += c;
  }
  return names;
}

/// The columns of a record that are coordinates of the model: one of several names of a coordinate, and its rates
/// where they are there.
std::vector<SampledCoordinate> sampled(const MotionModel& model, const std::string& file, std::vector<double>& time) {
  const std::vector<std::string> header = header_of(file);
  const auto has = [&](const std::string& name) {
    return std::find(header.begin(), header.end(), name) != header.end();
  };
  std::vector<Channel> channels;
  std::vector<std::string> columns = {"time"};
  for (const Channel& channel : channels_of(model)) {
    const bool known = std::any_of(channels.begin(), channels.end(),
                                   [&](const Channel& c) { return c.coordinate == channel.coordinate; });
    if (known || !has(channel.name)) continue;
    channels.push_back(channel);
    columns.push_back(channel.name);
    if (has(channel.name + ".rate")) columns.push_back(channel.name + ".rate");
  }
  const CsvTable table = read_csv(file, columns);
  time = table.column("time");
  check_times(table, "time", 0, time.size());
  std::vector<SampledCoordinate> out;
  for (const Channel& channel : channels) {
    const double unit = unit_value(channel.quantity, model.scene().units);
    SampledCoordinate sample{channel.coordinate, table.column(channel.name), {}};
    for (double& v : sample.value) v = v * unit - channel.offset;
    if (has(channel.name + ".rate")) sample.rate = table.column(channel.name + ".rate");
    for (double& v : sample.rate) v *= unit;
    out.push_back(std::move(sample));
  }
  return out;
}

ForcesAnswer along_motion(const MotionModel& model, const std::string& file, Progress& progress) {
  ForcesAnswer answer;
  answer.along = "time";
  answer.tolerance = balanced_by_samples;
  progress.now("reading the motion");
  const std::vector<SampledCoordinate> samples = sampled(model, file, answer.at);
  const GivenMotion motion = complete_motion(model, answer.at, samples);
  answer.how = fmt::format("{} of {}, from {}; closing its loops moved it by {} (rad or mechanism sizes)",
                           count(static_cast<int>(samples.size()), "coordinate", "coordinates"), model.layout().kept,
                           file, small_number(motion.closing));
  progress.now("balancing the bodies");
  for (std::size_t k = 0; k < answer.at.size(); ++k) {
    answer.poses.push_back(forces_of(model, motion.x[k], motion.v[k], motion.a[k], model.scene().drives));
  }
  return answer;
}

int run_forces(const ForcesRequest& request, const Palette& palette) {
  check(request);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress;
  progress.now("reading the scene");
  const MotionModel model(with_drives(load_scene(request.common), request.drives));
  const Scene& scene = model.scene();
  OutputFiles files(request.common);
  const bool driven = !request.drives.empty() && has_range(request.drives.front());
  const ForcesAnswer answer = driven                   ? over_range(model, request, progress)
                              : request.motion.empty() ? in_place(model)
                                                       : along_motion(model, request.motion, progress);
  if (!request.common.svg.empty() && answer.at.empty()) {
    throw InputError("--svg: there is one pose only; expected a range, say --drive crank=0..360, or --motion");
  }
  progress.now("writing the result");
  const bool any = !answer.poses.empty();
  const std::string written = files.write(files.wants_json() ? forces_json(model, answer, request.common.settings) : "",
                                          files.wants_svg() && any ? draw_plot(forces_panels(scene, answer)) : "",
                                          files.wants_csv() && any ? forces_csv(scene, answer) : "");
  progress.done();
  print(forces_report(model, answer, palette) + (written.empty() ? "" : "\n" + written));
  return (answer.complete || answer.stop) && any && answer.balanced() ? solved : not_solved;
}

}  // namespace

Command forces_command() {
  const auto request = std::make_shared<ForcesRequest>();
  Command command{"forces", "What drives must give and joints carry, in a pose or along a motion"};
  add_scene_options(command, request->common);
  command.add({"--drive", &request->drives, "NAME[=RANGE]",
               "crank: drives the angle of a body, or the travel of a joint,\nfrom where it stands; crank=30: put "
               "there; crank=0..360: over\na range, as far as stops allow. Takes the place of the scene's\ndrives; "
               "several times"});
  command.add({"--rate", &request->rate, "NUMBER",
               "Move at this speed, scene's units per second, with all inertia\n(without it: standing still in every "
               "pose)"});
  command.add({"--steps", &request->steps, "N", "Equal parts of the range (72)"});
  command.add({"--motion", &request->motion, "FILE",
               "Take the motion from FILE, a CSV with the columns time, NAME\nand perhaps NAME.rate, as poise motion "
               "writes it"});
  command.add({"--csv", &request->common.csv, "FILE", "Write all forces, one line for each pose, to FILE"});
  command.add({"--json", &request->common.json, "FILE", "Write the result to FILE as JSON"});
  command.add({"--svg", &request->common.svg, "FILE", "Draw efforts and reactions over the range into FILE"});
  command.run = [request](const Palette& palette) { return run_forces(*request, palette); };
  return command;
}

}  // namespace poise::app
