#include "app/results/motion/forces.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/motion/kinematics.hpp"
#include "identification/experiment/motion_import.hpp"

namespace poise::app {
namespace {

struct ForcesRequest {
  Request common;
  std::vector<std::string> drives;
  std::string motion;
  int steps = 72;
  std::optional<double> rate, flywheel;
  std::vector<std::string> show;
};

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
  check_sweep(request.steps, request.rate);
  if (!request.flywheel) return;
  if (!request.rate) throw InputError("--flywheel: its size depends on the speed; expected --rate NUMBER too");
  expect_number("--flywheel", *request.flywheel, *request.flywheel > 0 && *request.flywheel < 1,
                "a coefficient of fluctuation between 0 and 1, (largest - least speed) / mean");
}

/// The scene with these drives in place of its own.
Scene with_drives(Scene scene, const std::vector<std::string>& drives) {
  if (drives.empty()) return scene;
  std::vector<Drive> wanted;
  for (const std::string& text : drives) wanted.push_back(find_drive(scene, text.substr(0, text.rfind('='))));
  scene.drives = std::move(wanted);
  forget_functions_of_drives(scene);
  return scene;
}

ForcesAnswer over_range(const MotionModel& model, const ForcesRequest& request) {
  const Scene& scene = model.scene();
  std::vector<DriveRange> ranges;
  for (const std::string& text : request.drives) ranges.push_back(read_drive(text, scene));
  const std::size_t moving = first_moving(ranges);
  const Quantity quantity = quantity_of(scene.drives[moving].on);
  SweepOptions options;
  options.steps = request.steps;
  options.interrupt = &request.common.interrupt();
  if (request.rate) options.rate = *request.rate * unit_value(quantity, scene.units);
  ForcesAnswer out{request.rate ? fmt::format("driven, {} at {} {}/s", ranges[moving].name, *request.rate,
                                              unit_name(quantity, scene.units))
                                : "held still in every position",
                   forces_over(model, ranges, options, request.rate.has_value())};
  if (!request.flywheel) return out;
  try {
    out.fluctuation = fluctuation_over(model, ranges.front(), options);
  } catch (const InputError& error) {
    throw InputError(std::string("--flywheel: ") + error.what());
  }
  out.coefficient = *request.flywheel;
  return out;
}

ForcesAnswer along_motion(const MotionModel& model, const std::string& file) {
  const ImportedMotion samples = import_motion(model, file);
  const GivenMotion motion = complete_motion(model, samples.time, samples.coordinates);
  return {fmt::format("{} of {}, from {}; closing its loops moved it by {} (rad or mechanism sizes)",
                      count(static_cast<int>(samples.coordinates.size()), "coordinate", "coordinates"),
                      model.layout().kept, file, small_number(motion.closing)),
          forces_along(model, samples.time, motion)};
}

/// No pose has friction of which it is not known what it does.
bool is_decided(const ForcesAlong& found) {
  using State = SlidingFriction::State;
  return std::none_of(found.poses.begin(), found.poses.end(), [](const Forces& forces) {
    return forces.friction.state == State::several || forces.friction.state == State::undetermined;
  });
}

/// How the pose of the scene's start is taken.
std::string in_place(const Scene& scene) {
  const std::string pose = "held still as the scene's start assembles it";
  return scene.time_functions.empty() ? pose : pose + ", at t = 0 s";
}

int run_forces(const ForcesRequest& request, const Palette& palette) {
  check(request);
  const bool has_chart =
      !request.motion.empty() || std::any_of(request.drives.begin(), request.drives.end(),
                                             [](const std::string& d) { return d.find("..") != std::string::npos; });
  if (!request.common.svg.empty() && has_chart) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const Scene given = load_moving_scene(request.common);
  const MotionModel model(with_drives(given, request.drives));
  const Scene& scene = model.scene();
  const std::vector<SoughtQuantity> show = read_shown_in_position(request.show, naming_drives(given, scene.drives));
  OutputFiles files(request.common);
  const bool driven = !request.drives.empty() && has_range(request.drives.front());
  progress.now("balancing the bodies");
  ForcesAnswer answer = driven                   ? over_range(model, request)
                        : request.motion.empty() ? ForcesAnswer{in_place(scene), forces_in_place(model)}
                                                 : along_motion(model, request.motion);
  if (!request.drives.empty()) answer.drives = drives_in_words(scene, each(scene.drives, &Drive::name));
  const ForcesAlong& found = answer.found;
  const Result result = forces_result(model, answer, show, request.common.settings);
  const bool any = !found.poses.empty();
  Pictures pictures;
  if (files.wants_svg() && any) {
    pictures.svg = found.at.empty() ? forces_picture(scene, found.poses.front(), result.verdict.text, found.balanced())
                                    : draw_plot(forces_panels(scene, found));
  }
  if (files.wants_html() && any) pictures.figures = {forces_figure(scene, found, found.balanced())};
  return finish(request.common, result, &files, pictures,
                (found.complete || found.stop) && any && found.balanced() && is_decided(found), progress, palette);
}

}  // namespace

Command forces_command() {
  const auto request = std::make_shared<ForcesRequest>();
  Command command{"forces", "Find the forces of drives and joints, in a position or along a motion"};
  add_scene_options(command, request->common);
  command.add({"--drive", &request->drives, "NAME[=RANGE]",
               "crank: drives the angle of a body in the world, the travel of a\njoint or a measure (length.SPRING, "
               "x.BODY.POINT,\nangle.BODY.OTHER) from where it stands; crank=30: put there;\ncrank=0..360: over a "
               "range, as far as stops allow. Takes the\nplace of the scene's drives; several times"});
  command.add({"--rate", &request->rate, "NUMBER",
               "Move at this speed, scene's units per second, with all inertia\n(without it: standing still in every "
               "position)"});
  command.add({"--flywheel", &request->flywheel, "NUMBER",
               "Over whole turns at --rate: the fluctuation of the torque of the\ndrive, and the flywheel that holds "
               "(largest - least speed) / mean\nto this number, say 0.02"});
  command.add({"--steps", &request->steps, "N", "Equal parts of the range (72)"});
  command
      .add({"--motion", &request->motion, "FILE",
            "Take the motion from FILE, a CSV with the columns time, NAME\nand perhaps NAME.rate, as poise motion "
            "writes it"})
      .reads("csv");
  add_show_option(command, request->show);
  add_output_options(
      command, request->common,
      {.svg = "Draw the mechanism with its forces in one position, or those of drives\nand joints over the range, "
              "into FILE",
       .csv = "Write all forces, one line for each position, to FILE"});
  command.run = [request](const Palette& palette) { return run_forces(*request, palette); };
  return command;
}

}  // namespace poise::app
