#include <fmt/format.h>

#include "model/toml_text.hpp"
#include "motion/design.hpp"

namespace poise {
namespace {

std::string vector(Vec2 v) { return fmt::format("[{}, {}]", toml_number(v.x), toml_number(v.y)); }

std::string points(const Body& body, double unit) {
  std::string out;
  for (const NamedPoint& p : body.points) {
    out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", toml_key(p.name), vector((1.0 / unit) * p.at));
  }
  return "points = { " + out + " }\n";
}

std::string joint_text(const Scene& scene, const Joint& joint) {
  std::string out = fmt::format("\n[[{}]]\nname = {}\npoints = [{}, {}]\n", joint.traits().key, toml_string(joint.name),
                                toml_string(scene.name_of(joint.a)), toml_string(scene.name_of(joint.b)));
  if (joint.has_travel()) out += "axis = " + vector(joint.axis) + "\n";
  if (joint.keeps_angle() && joint.angle != 0.0)
    out += "angle = " + toml_number(joint.angle / scene.units.angle) + "\n";
  if (joint.keeps_length()) out += "length = " + toml_number(joint.length / scene.units.length) + "\n";
  return out;
}

}  // namespace

std::string geometry_text(const Scene& scene) {
  const Units& u = scene.units;
  std::string out = fmt::format("title = {}\nsource = {}\n\n[units]\nlength = {}\nforce = {}\nmass = {}\nangle = {}\n",
                                toml_string(scene.title), toml_string(scene.source), toml_string(u.length_name),
                                toml_string(u.force_name), toml_string(u.mass_name), toml_string(u.angle_name));
  out += "\n[ground]\n" + points(scene.bodies.front(), u.length);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    out += fmt::format("\n[body.{}]\n{}", toml_key(scene.bodies[i].name), points(scene.bodies[i], u.length));
  }
  for (const Joint& joint : scene.joints) out += joint_text(scene, joint);
  out += "\n[start]\n";
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const auto& angle = scene.start.angle[i];
    if (angle) out += toml_key(scene.bodies[i].name) + " = " + toml_number(*angle / u.angle) + "\n";
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const auto& travel = scene.start.travel[j];
    if (travel) out += toml_key(scene.joints[j].name) + " = " + toml_number(*travel / u.length) + "\n";
  }
  return out;
}

}  // namespace poise
