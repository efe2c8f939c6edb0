#pragma once

#include <algorithm>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// The joint whose travel is the coordinate along the curve of a curved slot or of a profile that rolls, whose row of
/// its tangent tells it (add_riders()); -1 of other stops.
inline int travel_along_curve(const Stop& stop) {
  if (stop.table == "curved_slot") return stop.on.joint;
  return stop.table.ends_with("_tangent") ? stop.on.terms[1].measure.joint : -1;
}

/// Whether a body is the massless rider of such a joint: it has no place of its own that a picture could show.
inline bool is_rider(const Scene& scene, int body) {
  return std::any_of(scene.stops.begin(), scene.stops.end(), [&](const Stop& stop) {
    const int joint = travel_along_curve(stop);
    return joint >= 0 && scene.joints[static_cast<std::size_t>(joint)].b.body == body;
  });
}

/// The massless body that turns with the line of centres of a stop's circle: of a wheel that rolls on a circle, and of
/// a circular slot with ends, whose pin it guides; with the contact, of a profile that rolls on a circle; with its
/// strand, of a chain (add_lines_of_centres()). -1 of other stops.
inline int line_of_centres(const Stop& stop) {
  if (stop.table == "rolling_profile_on_circle" || stop.table == "chain") return stop.on.terms[0].measure.a.body;
  const bool is_slot = stop.table == "circular_slot" && stop.on.kind == Measure::Kind::component;
  return is_slot || stop.table == "rolling_on_circle" ? stop.on.a.body : -1;
}

/// Whether a body is such a line.
inline bool is_line_of_centres(const Scene& scene, int body) {
  return std::any_of(scene.stops.begin(), scene.stops.end(),
                     [&](const Stop& stop) { return line_of_centres(stop) == body; });
}

/// Riders and lines, whose numbers are no numbers of the scene file.
inline std::vector<int> bodies_of_tracks(const Scene& scene) {
  std::vector<int> out;
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
