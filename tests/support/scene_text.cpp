#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "tests/support/random_scenes.hpp"

namespace poise::test {
namespace {

std::string pair(Vec2 v) { return fmt::format("[{}, {}]", v.x, v.y); }

std::string quoted(const Scene& scene, PointRef p) { return "\"" + scene.name_of(p) + "\""; }

std::string contacts_of(const Scene& scene, const Measure& rope) {
  std::string out;
  for (const RopeContact& contact : rope.contacts) {
    out += out.empty() ? "" : ", ";
    out += contact.radius == 0.0
               ? quoted(scene, contact.at)
               : fmt::format("{{ pulley = {}, radius = {}, turn = \"{}\" }}", quoted(scene, contact.at), contact.radius,
                             contact.turn > 0 ? "counterclockwise" : "clockwise");
  }
  return "[" + out + "]";
}

std::string key_of(const Scene& scene, const Measure& m) {
  switch (m.kind) {
    case Measure::Kind::angle:
      return fmt::format("bodies = [\"{}\", \"{}\"]", scene.bodies[m.body_a].name, scene.bodies[m.body_b].name);
    case Measure::Kind::distance:
      return fmt::format("points = [{}, {}]", quoted(scene, m.a), quoted(scene, m.b));
    case Measure::Kind::travel:
      return fmt::format("slide = \"{}\"", scene.joints[m.joint].name);
    case Measure::Kind::x:
      return "x = " + quoted(scene, m.b);
    case Measure::Kind::y:
      return "y = " + quoted(scene, m.b);
    case Measure::Kind::component:
      return fmt::format("points = [{}, {}]\naxis = {}", quoted(scene, m.a), quoted(scene, m.b), pair(m.axis));
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
    case Measure::Kind::slip_on_cam:
      throw std::invalid_argument("a text has outlines in contacts only");
    case Measure::Kind::rope:
      return "rope = " + contacts_of(scene, m);
    case Measure::Kind::sum:
      break;
  }
  std::string terms;
  for (const Measure::Term& term : m.terms) {
    if (term.profile) throw std::invalid_argument("a text has profiles of cams only");
    std::string measure = key_of(scene, term.measure);
    if (const std::size_t line = measure.find('\n'); line != std::string::npos) measure.replace(line, 1, ", ");
    terms += fmt::format("{}{{ factor = {}, {} }}", terms.empty() ? "" : ", ", term.factor, measure);
  }
  return "sum = [" + terms + "]";
}

std::string points_of(const Body& body) {
  std::string out;
  for (const NamedPoint& p : body.points) {
    out += fmt::format("{}\"{}\" = {}", out.empty() ? "" : ", ", p.name, pair(p.at));
  }
  return "points = { " + out + " }\n";
}

std::string text_of(const Scene& scene, const Joint& joint) {
  std::string out = fmt::format("\n[[{}]]\nname = \"{}\"\npoints = [{}, {}]\n", joint.traits().key, joint.name,
                                quoted(scene, joint.a), quoted(scene, joint.b));
  if (joint.has_travel()) out += fmt::format("axis = {}\n", pair(joint.axis));
  for (const Number& number : joint.numbers()) {
    out += fmt::format("{} = {}\n", number.key, number.get(&joint).value_or(0.0));
  }
  return out;
}

std::string text_of(const Scene& scene, const Element& element) {
  const bool is_rope = element.table == "rope";
  const std::string on = is_rope ? "over = " + contacts_of(scene, element.on) : key_of(scene, element.on);
  std::string out = fmt::format("\n[[{}]]\nname = \"{}\"\n{}\n", element.table, element.name, on);
  const void* law = std::visit([](const auto& l) -> const void* { return &l; }, element.law);
  const auto* curve = std::get_if<CurveSpring>(&element.law);
  if (curve != nullptr) {
    std::string points;
    for (std::size_t k = 0; k < curve->curve().points(); ++k) {
      points += (k == 0 ? "" : ", ") + pair({curve->curve().x()[k], curve->curve().forces()[k]});
    }
    out += fmt::format("{} = {{ curve = [{}] }}\n", element.on.is_angle() ? "torque" : "force", points);
  }
  for (const Number& number :
       curve != nullptr ? std::span<const Number>(CurveSpring::numbers) : numbers_of(element.law)) {
    const std::string_view key = element.on.is_angle() && !number.angle_key.empty() ? number.angle_key : number.key;
    if (const std::optional<double> value = number.get(law)) out += fmt::format("{} = {}\n", key, *value);
  }
  if (const auto* spring = std::get_if<LinearSpring>(&element.law); spring != nullptr && !is_rope) {
    static constexpr const char* words[] = {"both", "tension", "compression"};
    out += fmt::format("acts = \"{}\"\n", words[static_cast<int>(spring->acts)]);
  }
  return out;
}

// The points of a spline, or the parts of standard laws, of which that one is a polynomial of the fifth degree.
std::string text_of(const Profile& profile) {
  const std::vector<Profile::Piece>& pieces = profile.pieces();
  const auto is_standard = [](const Profile::Piece& piece) {
    return piece.law != Profile::Law::polynomial || piece.c[5] != 0.0;
  };
  const bool by_law = std::any_of(pieces.begin(), pieces.end(), is_standard);
  std::string out;
  if (!by_law) out = pair({0.0, pieces.front().c[0]});
  for (const Profile::Piece& piece : pieces) {
    // The end of the turn is exactly its beginning.
    const bool is_last = &piece == &pieces.back();
    const double to = 2 * M_PI * piece.to, end = is_last ? pieces.front().c[0] : Profile::on(piece, piece.to).value;
    if (!out.empty()) out += ", ";
    if (!by_law) {
      out += pair({to, end});
      continue;
    }
    const std::string law = piece.law == Profile::Law::harmonic    ? "harmonic"
                            : piece.law == Profile::Law::cycloidal ? "cycloidal"
                                                                   : "polynomial_345";
    out += fmt::format("{{ to = {}, lift = {}, law = \"{}\" }}", to, end, law);
  }
  return fmt::format("{} = [{}]", by_law ? "law" : "curve", out);
}

std::string text_of_cam(const Scene& scene, const Stop& stop) {
  const Measure::Term& turned = stop.on.terms[1];
  std::string follower = key_of(scene, stop.on.terms[0].measure);
  if (const std::size_t line = follower.find('\n'); line != std::string::npos) follower.replace(line, 1, ", ");
  return fmt::format(
      "\n[[cam]]\nname = \"{}\"\n{}\nfollower = {{ {} }}\n{}\nlift = {}\nbase = {}\nphase = {}\nguided = {}\n",
      stop.name, key_of(scene, turned.measure), follower, text_of(*turned.profile), -turned.factor, stop.min,
      turned.shift, stop.couples());
}

// Gears, belts and racks as the couplings that they are.
std::string text_of(const Scene& scene, const Stop& stop) {
  if (stop.table == "cam") return text_of_cam(scene, stop);
  const std::string table = stop.couples() ? "coupling" : "stop";
  std::string out = fmt::format("\n[[{}]]\nname = \"{}\"\n{}\n", table, stop.name, key_of(scene, stop.on));
  if (stop.couples()) return out + fmt::format("value = {}\n", stop.min);
  if (std::isfinite(stop.min)) out += fmt::format("min = {}\n", stop.min);
  if (std::isfinite(stop.max)) out += fmt::format("max = {}\n", stop.max);
  return out;
}

std::string start_of(const Scene& scene) {
  std::string out = "\n[start]\n";
  std::string places;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const std::string& name = scene.bodies[b].name;
    if (scene.start.angle[b]) out += fmt::format("\"{}\" = {}\n", name, *scene.start.angle[b]);
    if (!scene.start.position[b]) continue;
    places += fmt::format("{}\"{}\" = {}", places.empty() ? "" : ", ", name, pair(*scene.start.position[b]));
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.start.travel[j]) out += fmt::format("\"{}\" = {}\n", scene.joints[j].name, *scene.start.travel[j]);
  }
  return places.empty() ? out : out + "position = { " + places + " }\n";
}

}  // namespace

std::string scene_text(const Scene& scene) {
  std::string out = fmt::format("title = \"{}\"\n", scene.title);
  if (!(scene.gravity == Vec2{})) out += fmt::format("gravity = {}\n", pair(scene.gravity));
  out += "\n[ground]\n" + points_of(scene.bodies[0]);
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    out += fmt::format("\n[body.\"{}\"]\n{}mass = {}\ncenter = {}\ninertia = {}\n", body.name, points_of(body),
                       body.mass, pair(body.center), body.inertia);
  }
  for (const Joint& joint : scene.joints) out += text_of(scene, joint);
  for (const Element& element : scene.elements) out += text_of(scene, element);
  for (const Force& force : scene.forces) {
    out += fmt::format("\n[[force]]\nname = \"{}\"\nat = {}\nvector = {}\n", force.name, quoted(scene, force.at),
                       pair(force.vector));
    if (force.follows >= 0) out += fmt::format("follows = \"{}\"\n", scene.bodies[force.follows].name);
  }
  for (const Torque& torque : scene.torques) {
    out += fmt::format("\n[[torque]]\nname = \"{}\"\non = \"{}\"\nvalue = {}\n", torque.name,
                       scene.bodies[torque.body].name, torque.value);
  }
  for (const Stop& stop : scene.stops) out += text_of(scene, stop);
  return out + start_of(scene);
}

}  // namespace poise::test
