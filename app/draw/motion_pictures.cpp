#include "app/draw/motion_pictures.hpp"

#include <algorithm>

#include "app/draw/mechanism.hpp"

namespace poise::app {
namespace {

PointPath path_of(const Scene& scene, const KinematicsResult& found, const std::string& name) {
  PointPath path{name, {}};
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (const NamedPoint& p : scene.bodies[i].points) {
      if (scene.bodies[i].name + "." + p.name != name) continue;
      for (const KinematicSample& sample : found.samples) path.points.push_back(sample.bodies[i].pose.world(p.at));
    }
  }
  return path;
}

}  // namespace

std::string kinematics_picture(const Scene& scene, const KinematicsResult& found,
                               const std::vector<std::string>& points, const std::string& heading, bool confirmed) {
  MechanismPicture picture{
      .poses = poses_of(found.samples.front().bodies), .heading = heading, .confirmed = confirmed, .loads = false};
  if (found.samples.size() > 2) {
    picture.others.push_back({"middle of the range", poses_of(found.samples[found.samples.size() / 2].bodies)});
  }
  if (found.samples.size() > 1) picture.others.push_back({"end of the range", poses_of(found.samples.back().bodies)});
  for (const std::string& point : points) picture.paths.push_back(path_of(scene, found, point));
  return draw_mechanism(scene, picture);
}

std::string motion_picture(const MotionModel& model, const Motion& motion, const std::string& heading, bool confirmed) {
  const Trajectory& path = motion.trajectory;
  const auto poses_at = [&](std::size_t node) {
    const auto first = path.q.begin() + static_cast<std::ptrdiff_t>(node) * path.coordinates;
    return model.poses(model.from_si({first, first + path.coordinates}));
  };
  MechanismPicture picture{.poses = poses_at(0), .heading = heading, .confirmed = confirmed, .loads = false};
  const auto middle = std::lower_bound(path.t.begin(), path.t.end(), path.t.back() / 2);
  picture.others.push_back({"at half of the time", poses_at(static_cast<std::size_t>(middle - path.t.begin()))});
  picture.others.push_back({"at the end", poses_at(path.nodes() - 1)});
  return draw_mechanism(model.scene(), picture);
}

std::string forces_picture(const Scene& scene, const Forces& forces, const std::string& heading, bool confirmed) {
  MechanismPicture picture{.poses = poses_of(forces.motions), .heading = heading, .confirmed = confirmed};
  if (!forces.friction.has_no_forces()) {
    picture.reactions = forces.reactions;
    picture.drives = forces.drives;
  }
  return draw_mechanism(scene, picture);
}

}  // namespace poise::app
