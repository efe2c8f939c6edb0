#pragma once

// URDF, the files of robots of ROS: a tree of links, whose joints turn about or slide along an axis. There is no
// gravity in it, which is taken to be 9.81 m/s^2 along -z. Besides, <loop_joint>, by which some close loops, and
// <springStiffness> and <springReference> of <gazebo> are read.

#include "exchange/formats.hpp"

namespace poise {

Imported import_urdf(std::string_view text, const std::string& file, const ImportOptions& options);

/// The x axis of the scene is x of the file, y is z. Throws InputError naming what a tree of links does not have.
Exported export_urdf(const Scene& scene, const std::vector<BodyPose<double>>& poses);

}  // namespace poise
