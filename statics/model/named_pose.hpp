#pragma once

#include <memory>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "statics/model/readings.hpp"

namespace poise {

/// Where the bodies of a scene stand, read by the names of the scene. Values are in SI, or in other units after in()
/// and in_scene_units(). Whatever takes a name throws InputError with the nearest name where there is none so called.
class NamedPose {
 public:
  /// The bodies of the scene at `poses`, SI: ScaledModel::poses(x), or poses_of(KinematicSample::bodies).
  NamedPose(Scene scene, std::vector<BodyPose<double>> poses);

  const Scene& scene() const { return *scene_; }
  const Units& units() const { return units_; }

  /// Absolute angle of a body from the world's x axis, counter-clockwise positive, not wrapped; rad.
  double angle(const std::string& body) const;
  /// World coordinates of a point "BODY.POINT"; m.
  Vec2 point(const std::string& name) const;
  /// Travel of a slide or pin in a slot: signed distance from its point a to its point b along its axis; m.
  double travel(const std::string& joint) const;
  /// The measure that a force element acts on: the length of a spring between points (m), the relative angle of a
  /// torsion spring (rad). `element` is "NAME", or "TABLE.NAME" ("spring.return") where elements of several tables have
  /// the name.
  double measure(const std::string& element) const;

  /// The same in units named, or in those of the scene.
  NamedPose in(const UnitNames& names) const { return in(units_of(names)); }
  NamedPose in(const Units& units) const;
  NamedPose in_scene_units() const { return in(scene().units); }

 protected:
  const Element& find_element(const std::string& name) const;
  const Joint& find_joint(const std::string& name) const;
  const Stop& find_stop(const std::string& name) const;
  const ElementReading& reading_of(const Element& element) const;  ///< SI
  /// SI value -> number in units().
  double shown(double si, const Dimension& dimension) const { return si / dimension.unit(units_); }
  Vec2 shown(Vec2 si, const Dimension& dimension) const { return {shown(si.x, dimension), shown(si.y, dimension)}; }
  void set_units(const Units& units) { units_ = units; }

 private:
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Readings> readings_;
  Units units_{};
};

}  // namespace poise
