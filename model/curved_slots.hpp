#pragma once

#include <algorithm>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// Whether a body is the massless rider whose travel is the coordinate along the track of a curved slot (add_riders()):
/// it has no place of its own that a picture could show.
inline bool is_rider(const Scene& scene, int body) {
  return std::any_of(scene.stops.begin(), scene.stops.end(), [&](const Stop& stop) {
    return stop.table == "curved_slot" && scene.joints[static_cast<std::size_t>(stop.on.joint)].b.body == body;
  });
}

/// Whether a body is the massless arm along the line of centres of a circle and the wheel that rolls on it.
inline bool is_line_of_centres(const Scene& scene, int body) {
  return std::any_of(scene.stops.begin(), scene.stops.end(),
                     [&](const Stop& stop) { return stop.table == "rolling_on_circle" && stop.on.a.body == body; });
}

/// These bodies, whose numbers are no numbers of the scene file.
inline std::vector<int> bodies_of_tracks(const Scene& scene) {
  std::vector<int> out;
  for (const Stop& stop : scene.stops) {
    if (stop.table == "curved_slot") out.push_back(scene.joints[static_cast<std::size_t>(stop.on.joint)].b.body);
    if (stop.table == "rolling_on_circle") out.push_back(stop.on.a.body);
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
