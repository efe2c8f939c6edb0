#pragma once

// What tests of other programs' formats compare: where points are, and how many freedoms there are.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "exchange/formats.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise::exchange_tests {

inline const FileFormat& format_named(const std::string& name) { return readable_format("", name); }

inline Imported imported(const std::string& format, const std::string& text, const ImportOptions& options = {}) {
  return format_named(format).read(text, "it." + format, options);
}

inline Scene scene_of(const std::string& format, const std::string& text, const ImportOptions& options = {}) {
  return parse_scene(imported(format, text, options).text, "imported.toml");
}

inline bool has_note(const std::vector<std::string>& notes, const std::string& part) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

/// A mechanism where it is: the places, m, of points that joints hold together, and of all points.
struct Placed {
  std::vector<Vec2> joined, all;
  int freedoms = 0;
  bool assembled = false;
};

inline Placed placed(const ScaledModel& model, const std::vector<double>& x) {
  const Scene& scene = model.scene();
  const std::vector<BodyPose<double>> poses = model.poses(x);
  const auto at = [&](PointRef point) { return poses[static_cast<std::size_t>(point.body)].world(scene.local(point)); };
  Placed out;
  for (const Joint& joint : scene.joints) {
    if (!joint.has_travel()) out.joined.push_back(at(joint.a));  // of others a says where a line is
    out.joined.push_back(at(joint.b));
  }
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    for (std::size_t p = 0; p < scene.bodies[body].points.size(); ++p) {
      out.all.push_back(at({static_cast<int>(body), static_cast<int>(p)}));
    }
  }
  return out;
}

/// With what carries no load.
inline Placed placed(const Scene& scene) {
  const ScaledModel model(with_masses(scene), Purpose::dynamics);
  const Mobility mobility = analyse_mobility(model);
  Placed out = placed(model, mobility.x);
  out.freedoms = mobility.freedoms;
  out.assembled = mobility.assembled;
  return out;
}

/// Every place is one of the mechanism's, to within 1e-9 m.
inline void expect_places(const std::vector<Vec2>& places, const Placed& among) {
  for (const Vec2& place : places) {
    double nearest = 1e9;
    for (const Vec2& other : among.all) nearest = std::min(nearest, norm(other - place));
    EXPECT_LT(nearest, 1e-9) << place.x << ", " << place.y;
  }
}

/// The text of a format for a scene in a position, with its notes.
inline Exported exported(const std::string& format, const ScaledModel& model, const std::vector<double>& x) {
  return format_named(format).write(model.scene(), model.poses(x));
}

/// The scene comes back with its places and freedoms.
inline Scene expect_round_trip(const std::string& format, const Scene& scene) {
  const ScaledModel model(scene, Purpose::dynamics);
  const Scene back = scene_of(format, exported(format, model, close_loops(model)).text);
  const Placed before = placed(scene), after = placed(back);
  EXPECT_TRUE(after.assembled);
  EXPECT_EQ(after.freedoms, before.freedoms);
  expect_places(before.joined, after);
  return back;
}

}  // namespace poise::exchange_tests
