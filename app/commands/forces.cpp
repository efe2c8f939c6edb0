#include "app/results/motion/forces.hpp"

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
#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/motion/kinematics.hpp"
#include "app/results/predictions.hpp"
#include "identification/experiment/motion_import.hpp"
#include "model/nearest_name.hpp"
#include "statics/sensitivity/differences.hpp"

namespace poise::app {
namespace {

struct ForcesRequest {
  Request common;
  std::vector<std::string> drives;
  std::string motion;
  int steps = 72;
  std::optional<double> rate, flywheel;
  std::vector<std::string> lift_off;
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
  if (!request.lift_off.empty() && ranges == 0) {
    throw InputError("--lift-off: nothing is driven; expected --drive NAME=FROM..TO too");
  }
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

/// The contact of this name, of those that may change sides.
Contact find_contact(const Scene& scene, const std::string& name, const std::vector<Contact>& contacts) {
  std::vector<std::string> names;
  for (const Contact& one : contacts) {
    names.push_back(scene.stops[one.stop].name);
    if (names.back() == name) return one;
  }
  const std::string those =
      names.empty() ? std::string("; this scene has no cam, and no rope or chain that keeps the drives company")
                    : did_you_mean_or_list(name, names);
  throw InputError(
      fmt::format("--lift-off {}: expected the name of a cam, or of a rope or chain whose load is driven by it alone{}",
                  name, those));
}

ForcesAnswer over_range(const MotionModel& model, const ForcesRequest& request, const std::vector<Contact>& contacts) {
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
  out.contacts = contact_courses(model, ranges, options, request.rate.has_value(), contacts, out.found);
  std::vector<Contact> lifting;
  for (const std::string& name : request.lift_off) lifting.push_back(find_contact(scene, name, contacts));
  if (!lifting.empty() && out.found.at.empty()) {
    throw InputError("--lift-off: nothing moves; expected a range, say --drive NAME=0..360");
  }
  if (!lifting.empty()) out.lift_offs = lift_offs(model, ranges, options, lifting);
  if (!request.flywheel) return out;
  try {
    out.fluctuation = fluctuation_over(model, ranges.front(), options);
  } catch (const InputError& error) {
    throw InputError(std::string("--flywheel: ") + error.what());
  }
  out.coefficient = *request.flywheel;
  return out;
}

/// How the pose of the scene's start is taken.
std::string in_place(const Scene& scene) {
  const std::string pose = "held still as the scene's start assembles it";
  return scene.time_functions.empty() ? pose : pose + ", at t = 0 s";
}

ForcesAnswer along_motion(const MotionModel& model, const std::string& file, const std::vector<Contact>& contacts) {
  const ImportedMotion samples = import_motion(model, file);
  const GivenMotion motion = complete_motion(model, samples.time, samples.coordinates);
  ForcesAnswer out{fmt::format("{} of {}, from {}; closing its loops moved it by {} (rad or mechanism sizes)",
                               count(static_cast<int>(samples.coordinates.size()), "coordinate", "coordinates"),
                               model.layout().kept, file, small_number(motion.closing)),
                   forces_along(model, samples.time, motion)};
  out.contacts = contact_courses(model.scene(), contacts, out.found);
  return out;
}

ForcesAnswer in_one_place(const MotionModel& model, const std::vector<Contact>& contacts) {
  ForcesAnswer out{in_place(model.scene()), forces_in_place(model)};
  out.contacts = contact_courses(model.scene(), contacts, out.found);
  return out;
}

/// No pose has friction of which it is not known what it does.
bool is_decided(const ForcesAlong& found) {
  using State = SlidingFriction::State;
  return std::none_of(found.poses.begin(), found.poses.end(), [](const Forces& forces) {
    return forces.friction.state == State::several || forces.friction.state == State::undetermined;
  });
}

/// Some contact would have to pull that can only press.
bool pulls(const ForcesAnswer& answer) {
  return std::any_of(answer.contacts.begin(), answer.contacts.end(),
                     [](const ContactCourse& one) { return one.pulls && !one.contact.guided; });
}

/// A scene with the drives that are asked for, held in contact where they move it, and the contacts to look at.
struct ModelInContact {
  std::vector<Contact> contacts;
  MotionModel model;
};

ModelInContact model_in_contact(const ForcesRequest& request, const Scene& given, bool driven) {
  const Scene apart = with_drives(given, request.drives);
  const std::vector<Contact> held = driven ? contacts_to_hold(apart) : std::vector<Contact>{};
  return {contacts_along(apart, held), MotionModel(held_in_contact(apart, held))};
}

ForcesAnswer find_forces(const ForcesRequest& request, const ModelInContact& of, bool driven) {
  const auto& [contacts, model] = of;
  if (driven) return over_range(model, request, contacts);
  return request.motion.empty() ? in_one_place(model, contacts) : along_motion(model, request.motion, contacts);
}

/// The effort of each drive, its least and greatest one over a range, and the largest force in each joint, where they
/// are determined.
std::vector<ComputedResult> results_of(const ForcesAlong& found) {
  std::vector<ComputedResult> out;
  if (found.poses.empty()) return out;
  constexpr double rounding = 1e-9;
  const Forces& first = found.poses.front();
  const auto add = [&](const std::string& name, const Dimension& dimension, double value, double size) {
    out.push_back({name, dimension, value, rounding * size});
  };
  for (std::size_t d = 0; d < first.drives.size(); ++d) {
    const auto each_effort = [&](const Forces& forces) { return forces.drives[d].value; };
    const bool is_known = std::all_of(found.poses.begin(), found.poses.end(),
                                      [&](const Forces& forces) { return forces.drives[d].determined; });
    if (!is_known) continue;
    const std::vector<double> efforts = each(found.poses, each_effort);
    const auto [least, greatest] = std::minmax_element(efforts.begin(), efforts.end());
    const double size = std::max(std::abs(*least), std::abs(*greatest));
    const Dimension dimension = first.drives[d].is_angle ? dimension::torque : dimension::force;
    const std::string name = "effort of " + first.drives[d].name;
    if (efforts.size() > 1) add("least " + name, dimension, *least, size);
    add((efforts.size() > 1 ? "greatest " : "") + name, dimension, *greatest, size);
  }
  for (std::size_t r = 0; r < first.reactions.size(); ++r) {
    if (first.reactions[r].joint < 0) continue;
    double largest = 0.0;
    bool is_known = true;
    for (const Forces& forces : found.poses) {
      is_known = is_known && r < forces.reactions.size() && forces.reactions[r].determined;
      if (is_known) largest = std::max(largest, norm(forces.reactions[r].force));
    }
    const std::string words = found.poses.size() > 1 ? "largest force in " : "force in ";
    if (is_known) add(words + first.reactions[r].name, dimension::force, largest, first.largest_force);
  }
  return out;
}

/// Adds intervals of these. Returns whether all have one.
bool add_force_predictions(Result& result, const FittedNumbers& fit, const ForcesRequest& request, const Scene& given,
                           bool driven, const ForcesAlong& found) {
  const std::vector<ComputedResult> results = results_of(found);
  const auto at = [&](const Scene& other) -> std::optional<std::vector<double>> {
    try {
      const ForcesAlong moved = find_forces(request, model_in_contact(request, other, driven), driven).found;
      const std::vector<ComputedResult> there = results_of(moved);
      if (!moved.balanced() || there.size() != results.size()) return std::nullopt;
      return each(there, [](const ComputedResult& one) { return one.value; });
    } catch (const InputError&) {  // the mechanism cannot be assembled so
      return std::nullopt;
    }
  };
  return add_predictions(result, fit, predict_by_differences(fit, given, results, at), given.units);
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
  const bool driven = !request.drives.empty() && has_range(request.drives.front());
  const ModelInContact in_contact = model_in_contact(request, given, driven);
  const MotionModel& model = in_contact.model;
  const Scene& scene = model.scene();
  const std::vector<SoughtQuantity> show = read_shown_in_position(request.show, naming_drives(given, scene.drives));
  OutputFiles files(request.common);
  progress.now("balancing the bodies");
  ForcesAnswer answer = find_forces(request, in_contact, driven);
  if (!request.drives.empty()) answer.drives = drives_in_words(scene, each(scene.drives, &Drive::name));
  const ForcesAlong& found = answer.found;
  Result result = forces_result(model, answer, show, request.common.settings);
  const bool any = !found.poses.empty();
  bool all_predicted = true;
  if (const std::optional<FittedNumbers> fit = load_fit(request.common, given); fit && found.balanced()) {
    progress.now("balancing with other numbers of the fit");
    all_predicted = add_force_predictions(result, *fit, request, given, driven, found);
  }
  Pictures pictures;
  if (files.wants_svg() && any) {
    pictures.svg = found.at.empty() ? forces_picture(scene, found.poses.front(), result.verdict.text, found.balanced())
                                    : draw_plot(forces_panels(scene, found));
  }
  if (files.wants_html() && any) pictures.figures = {forces_figure(scene, found, found.balanced())};
  return finish(
      request.common, result, &files, pictures,
      (found.complete || found.stop) && any && found.balanced() && !pulls(answer) && is_decided(found) && all_predicted,
      progress, palette);
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
  command.add({"--lift-off", &request->lift_off, "NAME",
               "Over a range: the smallest rate of the drive at which this cam,\nrope or chain would have to pull, and "
               "where; of a guided cam that\nat which it changes sides; several times"});
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
  add_with_option(command, request->common);
  add_output_options(
      command, request->common,
      {.svg = "Draw the mechanism with its forces in one position, or those of drives\nand joints over the range, "
              "into FILE",
       .csv = "Write all forces, one line for each position, to FILE"});
  command.run = [request](const Palette& palette) { return run_forces(*request, palette); };
  return command;
}

}  // namespace poise::app
