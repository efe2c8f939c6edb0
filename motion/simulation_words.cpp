#include "motion/simulation_words.hpp"

#include <vector>

#include <fmt/format.h>

#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

/// Rates that contradict each other from the start differ by more than this share of their terms: more than what the
/// choice of coordinates takes for zero. What differs by less opens later, if at all.
constexpr double contradiction = 1e-6;

constexpr const char* locked_words =
    "friction locks: friction of joints or contacts grows with the forces that it makes, so that these may be several, "
    "or "
    "none (P. Painleve); give less friction";

}  // namespace

std::string name_of_row(const MotionModel& model, int row, const std::vector<Touch>& touching) {
  const Scene& scene = model.scene();
  for (const ConstraintBlock& block : model.mechanism().blocks()) {
    if (row < block.first_row || row >= block.first_row + block.rows) continue;
    const Joint& joint = scene.joints[static_cast<std::size_t>(model.layout().closures[block.closure].joint)];
    return fmt::format("{} \"{}\"", joint.traits().key, joint.name);
  }
  auto drive = static_cast<std::size_t>(row - model.mechanism().equalities());
  if (drive < scene.drives.size()) return fmt::format("drive \"{}\"", scene.drives[drive].name);
  drive -= scene.drives.size();
  for (const Stop& stop : scene.stops) {
    if (stop.holds() && drive-- == 0) return stop.title();
  }
  if (drive < touching.size()) return scene.stops[static_cast<std::size_t>(touching[drive].stop)].title();
  return "friction that holds";
}

std::string gaining_impact(const std::string& stop) {
  return fmt::format(
      "the impact at {} would add energy: with several impulses at a time the restitutions of this law contradict each "
      "other; give law = \"energetic\"",
      stop);
}

std::string pushing_drive(const std::string& stop, bool is_driven) {
  return fmt::format(
      "{} against {}, which no freedom of the mechanism can yield to",
      is_driven ? "drives push" : "the impact finds no impulses with this friction, or other stops press,", stop);
}

std::string words_of(StickSlip::Choice choice, bool rubs) {
  if (!rubs) {
    return choice == StickSlip::Choice::none
               ? "no forces at its stops that only push keep it from passing them"
               : "more stops are touched at once than can be told apart, or in a singular position";
  }
  switch (choice) {
    case StickSlip::Choice::locked:
      return locked_words;
    case StickSlip::Choice::several:
      return "friction of joints or contacts may hold or let go, or let go in several ways: more than one motion "
             "agrees with its "
             "laws; give less friction";
    case StickSlip::Choice::none:
      return "friction leaves no motion that agrees with its laws (P. Painleve); give less of it";
    default:
      return fmt::format(
          "friction that sticks acts on more than {} places without rate, or in a singular position; give some of it a "
          "width",
          StickSlip::most_at_once);
  }
}

void refuse_contradicting_drives(const MotionModel& model, ReducedMotion<double>& reduced) {
  const Scene& scene = model.scene();
  const ReducedMotion<double>::Opening opening = reduced.fastest_opening();
  if (scene.drives.empty() || opening.row < 0 || !(opening.size > contradiction * opening.terms)) return;
  std::vector<std::string> moving;
  for (const Drive& drive : scene.drives) moving.push_back(fmt::format("\"{}\"", drive.name));
  throw InputError(fmt::format(
      "{}:{}: drive: the mechanism cannot move at the rates of its {} {}: {} would {}; expected drives that agree with "
      "the joints and with each other, no more than there are degrees of freedom; leave one out",
      scene.file, scene.drives.back().line, moving.size() == 1 ? "drive" : "drives", fmt::join(moving, ", "),
      name_of_row(model, opening.row), opening.row < model.mechanism().equalities() ? "open" : "not be followed"));
}

void refuse_undetermined_joint(const Scene& scene, int joint) {
  const Joint& of = scene.joints[static_cast<std::size_t>(joint)];
  for (const Element& one : scene.elements) {
    if (!one.feedback || one.feedback->reads_joint != joint) continue;
    throw InputError(fmt::format(
        "{}:{}: controller \"{}\".reads: the mechanism is statically indeterminate, so that the force in {} \"{}\" "
        "cannot be known; expected joints of which none repeats others",
        scene.file, one.line, one.name, of.traits().key, of.name));
  }
  throw InputError(fmt::format(
      "{}:{}: {} \"{}\".friction: the mechanism is statically indeterminate, so that the force in this joint, on "
      "which its friction depends, cannot be known; expected joints of which none repeats others, or friction of a "
      "constant torque or force",
      scene.file, of.line, of.traits().key, of.name));
}

MotionEnd end_of_motion(const MotionModel& model, ReducedMotion<double>::Status status, double t,
                        const std::vector<double>& q) {
  using Evaluated = ReducedMotion<double>::Status;
  if (status == Evaluated::locked) return {MotionStatus::stuck, fmt::format("at t = {:.9g} s {}", t, locked_words)};
  // Without a length of a rope nothing that it moves is a number.
  if (status != Evaluated::singular && status != Evaluated::open) {
    if (const std::string rope = rope_without_length(model.scene(), model.poses(q), 1e-3); !rope.empty()) {
      return {MotionStatus::stuck, fmt::format("at t = {:.9g} s {}", t, rope)};
    }
  }
  if (status == Evaluated::no_inertia) {
    return {MotionStatus::no_inertia,
            "a degree of freedom has no inertia, so its motion is not determined; give the bodies that it moves mass "
            "or moment of inertia, or drive it"};
  }
  const char* what = status == Evaluated::singular ? "a singular position"
                     : status == Evaluated::open   ? "a position in which its loops open"
                     : status == Evaluated::blades ? "a position in which a blade holds what others, joints or stops "
                                                     "hold, so that its force is not determined"
                                                   : "a point where no step is short enough";
  return {MotionStatus::stuck, fmt::format("at t = {:.9g} s it reached {}", t, what)};
}

}  // namespace poise
