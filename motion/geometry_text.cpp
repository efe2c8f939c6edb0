#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "motion/design.hpp"

namespace poise {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

/// A key of TOML, in quotes if necessary.
std::string key(const std::string& name) {
  const bool bare = std::all_of(name.begin(), name.end(),
                                [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  return bare && !name.empty() ? name : quoted(name);
}

/// A float of TOML with all its digits: never written as an integer, which is limited to 64 bits.
std::string number(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string vector(Vec2 v) { return fmt::format("[{}, {}]", number(v.x), number(v.y)); }

std::string points(const Body& body, double unit) {
  std::string out;
  for (const NamedPoint& p : body.points) {
    out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", key(p.name), vector((1.0 / unit) * p.at));
  }
  return "points = { " + out + " }\n";
}

std::string joint_text(const Scene& scene, const Joint& joint) {
  static constexpr const char* kinds[] = {"pin", "slide", "pin_in_slot", "weld", "bar"};
  std::string out = fmt::format("\n[[{}]]\nname = {}\npoints = [{}, {}]\n", kinds[static_cast<int>(joint.kind)],
                                quoted(joint.name), quoted(scene.name_of(joint.a)), quoted(scene.name_of(joint.b)));
  if (joint.has_travel()) out += "axis = " + vector(joint.axis) + "\n";
  if (joint.keeps_angle() && joint.angle != 0.0) out += "angle = " + number(joint.angle / scene.units.angle) + "\n";
  if (joint.keeps_length()) out += "length = " + number(joint.length / scene.units.length) + "\n";
  return out;
}

}  // namespace

std::string geometry_text(const Scene& scene) {
  const Units& u = scene.units;
  std::string out = fmt::format("title = {}\nsource = {}\n\n[units]\nlength = {}\nforce = {}\nmass = {}\nangle = {}\n",
                                quoted(scene.title), quoted(scene.source), quoted(u.length_name), quoted(u.force_name),
                                quoted(u.mass_name), quoted(u.angle_name));
  out += "\n[ground]\n" + points(scene.bodies.front(), u.length);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    out += fmt::format("\n[body.{}]\n{}", key(scene.bodies[i].name), points(scene.bodies[i], u.length));
  }
  for (const Joint& joint : scene.joints) out += joint_text(scene, joint);
  out += "\n[start]\n";
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const auto& angle = scene.start.angle[i];
    if (angle) out += key(scene.bodies[i].name) + " = " + number(*angle / u.angle) + "\n";
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const auto& travel = scene.start.travel[j];
    if (travel) out += key(scene.joints[j].name) + " = " + number(*travel / u.length) + "\n";
  }
  return out;
}

}  // namespace poise
