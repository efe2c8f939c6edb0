#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// The joint whose travel is the coordinate along the curve of a curved slot, of a profile that rolls or of a contact
/// of curves, whose row of its tangent tells it (add_riders()); -1 of other stops.
inline int travel_along_curve(const Stop& stop) {
  if (stop.table == "curved_slot") return stop.on.joint;
  return stop.table.ends_with("_tangent") ? stop.on.terms[1].measure.joint : -1;
}

/// Whether a body is a state of a controller (Feedback).
inline bool is_state_of_controller(const Scene& scene, int body) {
  return body > 0 && std::any_of(scene.elements.begin(), scene.elements.end(), [&](const Element& element) {
           if (!element.feedback) return false;
           const std::vector<int> states = element.feedback->states();
           return std::find(states.begin(), states.end(), body) != states.end();
         });
}

/// Whether a body is the massless rider of such a joint, or a state: it has no place of its own that a picture could
/// show.
inline bool is_rider(const Scene& scene, int body) {
  return is_state_of_controller(scene, body) ||
         std::any_of(scene.stops.begin(), scene.stops.end(), [&](const Stop& stop) {
           const int joint = travel_along_curve(stop);
           return joint >= 0 && scene.joints[static_cast<std::size_t>(joint)].b.body == body;
         });
}

/// A table of couplings that have, or may have, a massless body that turns with a line of centres.
struct LineOfCentres {
  std::string_view table;
  std::string_view pinned_at;  ///< its key for the point at which the line begins, to which that body is pinned
};
/// All of them, in the order of coupling_kinds(): chains, whose body turns with the strand; circular slots with ends,
/// whose pin it guides; wheels on a circle; profiles that roll on one, whose contact it turns with; contacts of curves,
/// with whose tangent it turns.
inline constexpr std::array<LineOfCentres, 5> lines_of_centres{{{"chain", "a"},
                                                                {"circular_slot", "center"},
                                                                {"rolling_on_circle", "center"},
                                                                {"rolling_profile_on_circle", "center"},
                                                                {"curve_contact", "at"}}};

/// That body of the first stop of such a coupling (add_lines_of_centres()), in whose frame it, or the first term of its
/// sum, is a component; -1 of other stops.
inline int line_of_centres(const Stop& stop) {
  const bool is_one = std::any_of(lines_of_centres.begin(), lines_of_centres.end(),
                                  [&](const LineOfCentres& one) { return one.table == stop.table; });
  if (!is_one) return -1;
  const Measure& along = stop.on.kind == Measure::Kind::sum ? stop.on.terms.front().measure : stop.on;
  return along.kind == Measure::Kind::component ? along.a.body : -1;
}

/// Whether a body is such a line.
inline bool is_line_of_centres(const Scene& scene, int body) {
  return std::any_of(scene.stops.begin(), scene.stops.end(),
                     [&](const Stop& stop) { return line_of_centres(stop) == body; });
}

/// Riders, lines and states of controllers, whose numbers are no numbers of the scene file.
inline std::vector<int> bodies_of_tracks(const Scene& scene) {
  std::vector<int> out;
  for (const Element& element : scene.elements) {
    if (!element.feedback) continue;
    for (const int body : element.feedback->states()) out.push_back(body);
  }
  for (const Stop& stop : scene.stops) {
    if (const int joint = travel_along_curve(stop); joint >= 0)
      out.push_back(scene.joints[static_cast<std::size_t>(joint)].b.body);
    if (const int line = line_of_centres(stop); line >= 0) out.push_back(line);
  }
  return out;
}

/// Whether a body is one of these.
inline bool is_of_track(const Scene& scene, int body) {
  return is_rider(scene, body) || is_line_of_centres(scene, body);
}

/// Whether a joint comes with such a body, whose joint it is.
inline bool is_of_track(const Scene& scene, const Joint& joint) { return is_of_track(scene, joint.b.body); }

}  // namespace poise
