#include "app/view/drawing_tools.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "app/draw/symbols.hpp"
#include "app/view/link_mass.hpp"
#include "app/view/rounded.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/toml_text.hpp"

namespace poise::app {
namespace {

using Poses = std::vector<BodyPose<double>>;

/// A number of one digit, 1, 2 or 5, that is near.
std::string plain(double value) {
  if (!(value > 0.0)) return "1";
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double lead = value / power;
  const double near = (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0) * power;
  return rounded(near, std::min(1.0, std::pow(10.0, std::floor(std::log10(near) + 1e-9))));
}

/// Coordinates in the body's frame.
Vec2 local_of(const BodyPose<double>& pose, Vec2 place) { return (place - pose.origin) * conj(pose.direction()); }

Vec2 nearest_on_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 way = b - a;
  const double length = dot(way, way);
  const double share = length > 0.0 ? std::clamp(dot(p - a, way) / length, 0.0, 1.0) : 0.0;
  return a + share * way;
}

class Sketcher {
 public:
  Sketcher(SceneText& text, const Poses& poses, const Drawn& drawn, const DrawingTool& tool)
      : text_(text), poses_(poses), drawn_(drawn), tool_(tool) {
    Vec2 low{}, high{};
    for (std::size_t b = 0; b < scene().bodies.size(); ++b) {
      for (const NamedPoint& point : scene().bodies[b].points) {
        names_.insert(point.name);
        const Vec2 at = poses_[b].world(point.at);
        low = {std::min(low.x, at.x), std::min(low.y, at.y)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      }
    }
    size_ = std::max({norm(high - low), 1e3 * drawn.grain});
  }

  std::string run() {
    if (tool_.name == "ground_point") return ground_point();
    if (tool_.name == "link") return link();
    if (tool_.name == "point") return scene().name_of(point_at(0, Pick::moving, {}));
    if (tool_.name == "mass") return mass();
    if (tool_.name == "plate") return plate();
    if (tool_.name == "pin" || tool_.name == "weld" || tool_.name == "loose_pin") return joint_at_place();
    return item();
  }

 private:
  const Scene& scene() const { return text_.scene(); }
  double unit() const { return scene().units.length; }
  std::string length(double si) const { return rounded(si / unit(), drawn_.grain / unit()); }
  std::string pair(Vec2 si) const { return fmt::format("[{}, {}]", length(si.x), length(si.y)); }
  std::string angle(double si) const {
    const double in_unit = si / scene().units.angle;
    // As fine as places are far from the middle of the mechanism.
    const double finest = std::min(1e-2, drawn_.grain / size_);
    return rounded(in_unit, std::pow(10.0, std::floor(std::log10(finest / scene().units.angle))));
  }
  Vec2 world(PointRef p) const { return poses_[static_cast<std::size_t>(p.body)].world(scene().local(p)); }
  std::string quoted(PointRef p) const { return toml_string(scene().name_of(p)); }
  const std::string& body_name(int b) const { return scene().bodies[static_cast<std::size_t>(b)].name; }

  bool has_point(int body, const std::string& name) const {
    const std::vector<NamedPoint>& points = scene().bodies[static_cast<std::size_t>(body)].points;
    return std::any_of(points.begin(), points.end(), [&](const NamedPoint& one) { return one.name == name; });
  }

  double within(std::size_t k) const { return drawn_.is_typed[k] ? 0.5 * drawn_.grain : drawn_.within; }

  /// The points that are meant by the k-th place: near where the hand was, or exactly where the grid took it.
  std::vector<PointRef> points_of(std::size_t k) const {
    std::vector<PointRef> out = points_at(drawn_.pressed[k], within(k));
    return out.empty() ? points_at(drawn_.places[k], 0.5 * drawn_.grain) : out;
  }

  /// The points at a place, one of each body: those of the nearest place that has any.
  std::vector<PointRef> points_at(Vec2 place, double far) const {
    double nearest = far;
    Vec2 there = place;
    const auto each = [&](auto visit) {
      for (int b = 0; b < static_cast<int>(text_.scene().bodies.size()); ++b) {
        if (!is_drawn(b)) continue;
        const int count = static_cast<int>(text_.scene().bodies[static_cast<std::size_t>(b)].points.size());
        for (int p = 0; p < count; ++p) visit(PointRef{b, p});
      }
    };
    each([&](PointRef p) {
      if (norm(world(p) - place) > nearest) return;
      nearest = norm(world(p) - place);
      there = world(p);
    });
    std::vector<PointRef> out;
    each([&](PointRef p) {
      const bool is_new = out.empty() || out.back().body != p.body;
      if (is_new && norm(world(p) - there) <= std::min(0.1 * drawn_.within, far)) out.push_back(p);
    });
    if (norm(there - place) > far) out.clear();
    return out;
  }

  /// Whether the text has it: not what comes with slots and flexible links.
  bool is_drawn(int body) const {
    return std::any_of(text_.items().begin(), text_.items().end(), [&](const SceneItem& item) {
      return item.owner == Owner::body && item.index == body && item.name == body_name(body);
    });
  }

  /// The moving body whose drawing is at a place; 0 where there is none.
  int body_at(Vec2 place, const std::set<int>& but, double far) const {
    double nearest = far;
    int out = 0;
    for (int b = 1; b < static_cast<int>(scene().bodies.size()); ++b) {
      if (but.contains(b) || !is_drawn(b)) continue;
      const std::vector<NamedPoint>& points = scene().bodies[static_cast<std::size_t>(b)].points;
      const auto at = [&](std::size_t p) { return poses_[static_cast<std::size_t>(b)].world(points[p].at); };
      for (std::size_t p = 0; p < points.size(); ++p) {
        const double distance = norm(place - nearest_on_segment(place, at(p), at((p + 1) % points.size())));
        if (distance >= nearest) continue;
        nearest = distance;
        out = b;
      }
    }
    return out;
  }

  /// A new point of a body there, with a name that others there have.
  PointRef new_point(int body, Vec2 place, const std::string& wanted = "") {
    const std::string name = !wanted.empty() && !has_point(body, wanted) ? wanted : free_letter(names_);
    text_.add_point(body_name(body), name, pair(local_of(poses_[static_cast<std::size_t>(body)], place)));
    return {body, static_cast<int>(scene().bodies[static_cast<std::size_t>(body)].points.size()) - 1};
  }

  /// Whether a pin or weld keeps two of these points together.
  bool is_joined_at_place(const std::vector<PointRef>& there, PointRef one) const {
    return std::any_of(scene().joints.begin(), scene().joints.end(), [&](const Joint& joint) {
      if (joint.has_travel() || joint.keeps_length()) return false;
      const auto is_there = [&](PointRef p) { return std::find(there.begin(), there.end(), p) != there.end(); };
      return (joint.a == one && is_there(joint.b)) || (joint.b == one && is_there(joint.a));
    });
  }

  PointRef point_at(std::size_t k, Pick kind, const std::set<int>& but) {
    const Vec2 place = drawn_.pressed[k];
    const std::vector<PointRef> there = points_of(k);
    // Where a pin keeps points together each of them does; otherwise one that moves is rather meant.
    std::optional<PointRef> found;
    for (const PointRef& one : there) {
      if (but.contains(one.body) || (kind == Pick::moving && one.body == 0)) continue;
      const bool replaces_ground = found && found->body == 0 && !is_joined_at_place(there, *found);
      if (!found || replaces_ground) found = one;
    }
    if (found) return *found;
    const int body = body_at(there.empty() ? place : world(there[0]), but, within(k));
    if (body == 0 && (kind == Pick::moving || but.contains(0)))
      throw InputError(fmt::format("place {}: expected one on {} body", k + 1,
                                   but.contains(0) || but.empty() ? "a moving" : "another"));
    const std::string name = there.empty() ? ""
                                           : text_.scene()
                                                 .bodies[static_cast<std::size_t>(there[0].body)]
                                                 .points[static_cast<std::size_t>(there[0].point)]
                                                 .name;
    return new_point(body, there.empty() ? new_place(body, k) : world(there[0]), name);
  }

  /// Where a new point comes: of a body on the line of its drawing, of the ground where the page says.
  Vec2 new_place(int body, std::size_t k) const {
    if (body == 0) return drawn_.places[k];
    const std::vector<NamedPoint>& points = scene().bodies[static_cast<std::size_t>(body)].points;
    const auto at = [&](std::size_t p) {
      return poses_[static_cast<std::size_t>(body)].world(points[p % points.size()].at);
    };
    Vec2 out = drawn_.pressed[k];
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec2 there = nearest_on_segment(drawn_.pressed[k], at(p), at(p + 1));
      if (norm(there - drawn_.pressed[k]) >= nearest) continue;
      nearest = norm(there - drawn_.pressed[k]);
      out = there;
    }
    return out;
  }

  std::string ground_point() {
    for (const PointRef& there : points_of(0)) {
      if (there.body == 0) throw InputError("the ground has point \"" + scene().name_of(there) + "\" there already");
    }
    const std::string name = given_name(free_letter(names_));
    text_.add_point(scene().bodies[0].name, name, pair(drawn_.places[0]));
    return scene().bodies[0].name + "." + name;
  }

  /// The name that was given, or another; without quotes.
  std::string given_name(const std::string& otherwise) const {
    const auto given = drawn_.values.find("name");
    if (given == drawn_.values.end()) return otherwise;
    const std::string& text = given->second;
    return text.size() > 1 && text.front() == '"' ? text.substr(1, text.size() - 2) : text;
  }

  /// A link through places: pinned where points are already. Its frame begins at the first, with x towards the second.
  std::string link() {
    std::vector<Vec2> places;
    std::vector<std::optional<PointRef>> joined;
    for (std::size_t k = 0; k < drawn_.places.size(); ++k) {
      const std::vector<PointRef> there = points_of(k);
      std::optional<PointRef> at;
      if (!there.empty())
        at = there.front();
      else if (const int body = body_at(drawn_.pressed[k], {}, within(k)); body > 0)
        at = new_point(body, new_place(body, k));
      const Vec2 exact = at ? world(*at) : drawn_.places[k];
      if (!places.empty() && norm(exact - places.back()) < drawn_.grain) continue;  // a double click
      places.push_back(exact);
      joined.push_back(at);
    }
    if (places.size() < 2) throw InputError("expected two places at least that are not the same");
    std::string name = given_name("");
    for (int k = 1; name.empty(); ++k) {
      const std::string wanted = "link_" + std::to_string(k);
      const auto is_taken = [&](const auto& item) { return item.name == wanted; };
      if (std::none_of(scene().bodies.begin(), scene().bodies.end(), is_taken)) name = wanted;
    }
    const double direction = std::atan2((places[1] - places[0]).y, (places[1] - places[0]).x);
    std::vector<std::string> own;
    std::string points;
    for (std::size_t k = 0; k < places.size(); ++k) {
      std::string letter;
      if (joined[k])
        letter = scene()
                     .bodies[static_cast<std::size_t>(joined[k]->body)]
                     .points[static_cast<std::size_t>(joined[k]->point)]
                     .name;
      if (letter.empty() || std::find(own.begin(), own.end(), letter) != own.end()) letter = free_letter(names_);
      own.push_back(letter);
      const Vec2 local = (places[k] - places[0]) * conj(poise::unit(direction));
      points += fmt::format("{}{} = {}", k > 0 ? ", " : "", toml_key(letter), pair(local));
    }
    TomlKeys keys{{"points", "{ " + points + " }"}};
    for (const char* const key : {"mass", "center", "inertia"}) {
      if (const auto given = drawn_.values.find(key); given != drawn_.values.end()) keys.push_back(*given);
    }
    text_.add_body(name, keys);
    bool is_held = false;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!joined[k]) continue;
      is_held = true;
      add_joint("pin", *joined[k], name + "." + own[k], {});
    }
    text_.set_start(name, angle(direction));
    if (!is_held) text_.set_start_position(name, pair(places[0]));
    return name;
  }

  /// A joint that is named as the point, where no other is.
  void add_joint(const std::string& table, PointRef a, const std::string& b, const TomlKeys& more) {
    const std::string letter =
        scene().bodies[static_cast<std::size_t>(a.body)].points[static_cast<std::size_t>(a.point)].name;
    TomlKeys keys;
    if (is_free_for_a_joint(letter)) keys.emplace_back("name", toml_string(letter));
    keys.emplace_back("points", fmt::format("[{}, {}]", quoted(a), toml_string(b)));
    keys.insert(keys.end(), more.begin(), more.end());
    text_.add_item(table, keys);
  }

  bool is_free_for_a_joint(const std::string& name) const {
    const auto is_taken = [&](const auto& item) { return item.name == name; };
    return std::none_of(scene().joints.begin(), scene().joints.end(), is_taken) &&
           std::none_of(scene().bodies.begin(), scene().bodies.end(), is_taken) &&
           std::none_of(scene().stops.begin(), scene().stops.end(), is_taken);
  }

  /// None where nothing joins the bodies.
  const Joint* joint_between(int a, int b) const {
    const auto found = std::find_if(scene().joints.begin(), scene().joints.end(), [&](const Joint& joint) {
      return (joint.a.body == a && joint.b.body == b) || (joint.a.body == b && joint.b.body == a);
    });
    return found == scene().joints.end() ? nullptr : &*found;
  }

  static bool are_same_ends(PointRef a, PointRef b, PointRef c, PointRef d) {
    return (a == c && b == d) || (a == d && b == c);
  }

  static bool is_same_measure(const Measure& one, const Measure& other) {
    if (one.kind != other.kind) return false;
    if (one.kind == Measure::Kind::distance) return are_same_ends(one.a, one.b, other.a, other.b);
    return one.kind == Measure::Kind::angle &&
           std::minmax(one.body_a, one.body_b) == std::minmax(other.body_a, other.body_b);
  }

  /// Whether two items of the tool's table do the same between the same points or bodies.
  bool does_the_same(const SceneItem& one, const SceneItem& other) const {
    const auto i = static_cast<std::size_t>(one.index), k = static_cast<std::size_t>(other.index);
    if (one.owner == Owner::joint) {
      const Joint &a = scene().joints[i], &b = scene().joints[k];
      return are_same_ends(a.a, a.b, b.a, b.b);
    }
    if (one.owner == Owner::element) {
      const Element &a = scene().elements[i], &b = scene().elements[k];
      return a.law.index() == b.law.index() && is_same_measure(a.on, b.on);
    }
    return one.owner == Owner::stop && is_same_measure(scene().stops[i].on, scene().stops[k].on);
  }

  /// The name of the new item, the last of the tool's table. Throws InputError where it is there already.
  std::string added_item() const {
    for (auto one = text_.items().rbegin(); one != text_.items().rend(); ++one) {
      if (one->owner == Owner::body || one->owner == Owner::point || !is_of_table(*one)) continue;
      expect_unlike_others(*one);
      return one->name;
    }
    return "";
  }

  /// Throws InputError where the new item is there already.
  void expect_unlike_others(const SceneItem& added) const {
    for (const SceneItem& other : text_.items()) {
      const bool is_like = other.owner == added.owner && other.index != added.index && other.point == added.point &&
                           is_of_table(other) && does_the_same(other, added);
      if (is_like) throw InputError(fmt::format("{} is there already, between the same two", other.name));
    }
  }

  /// Throws InputError where what has two ends has both at one place.
  void expect_apart(const std::vector<PointRef>& points) const {
    const bool has_ends = tool_.picks.front() == Pick::point || tool_.name == "distributed_load";
    for (std::size_t k = 0; has_ends && k + 1 < points.size(); ++k) {
      if (norm(world(points[k + 1]) - world(points[k])) < 0.5 * drawn_.grain)
        throw InputError(
            fmt::format("place {}: expected another one; both ends are at {}", k + 2, scene().name_of(points[k])));
    }
  }

  /// A pin, with clearance or without, or weld of two bodies where both are, or of one and the ground.
  std::string joint_at_place() {
    std::vector<PointRef> there = points_of(0);
    const int first = body_at(drawn_.pressed[0], {}, within(0));
    const Vec2 exact = there.empty() ? new_place(first, 0) : world(there[0]);
    const std::string letter = there.empty() ? free_letter(names_)
                                             : scene()
                                                   .bodies[static_cast<std::size_t>(there[0].body)]
                                                   .points[static_cast<std::size_t>(there[0].point)]
                                                   .name;
    std::set<int> bodies;
    for (const PointRef& one : there) bodies.insert(one.body);
    for (int body = body_at(exact, bodies, within(0)); body > 0; body = body_at(exact, bodies, within(0))) {
      bodies.insert(body);
      there.push_back(new_point(body, exact, letter));
    }
    if (bodies.size() == 1 && !bodies.contains(0)) there.insert(there.begin(), new_point(0, exact, letter));
    std::string joined_by;
    for (std::size_t j = 1; j < there.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        if (const Joint* const joint = joint_between(there[i].body, there[j].body)) {
          joined_by += fmt::format("{}{} {}", joined_by.empty() ? "" : ", ", joint->traits().key, joint->name);
          continue;
        }
        TomlKeys more;
        if (tool_.name == "weld") more = {{"angle", angle(turned(there[i].body, there[j].body))}};
        if (tool_.name == "loose_pin") more = {{"clearance", given("clearance", play())}};
        add_joint(std::string(tool_.name), there[i], scene().name_of(there[j]), more);
        return added_item();
      }
    }
    throw InputError(there.empty() ? "expected a place where two bodies meet, or one body"
                                   : "the bodies there are joined already; see " + joined_by);
  }

  double turned(int a, int b) const {
    return poses_[static_cast<std::size_t>(b)].angle - poses_[static_cast<std::size_t>(a)].angle;
  }

  int pressed_link() const {
    const int body = body_at(drawn_.pressed[0], {}, within(0));
    if (body == 0) throw InputError("expected a place on a moving body");
    return body;
  }

  /// What was given under a key, as TOML.
  std::string given(const char* key, const std::string& otherwise) const {
    const auto found = drawn_.values.find(key);
    return found != drawn_.values.end() ? found->second : otherwise;
  }

  std::string mass() {
    const int body = pressed_link();
    const Body& link = scene().bodies[static_cast<std::size_t>(body)];
    text_.set(link.name, spread_mass(link, given("mass", "1"), scene().units, drawn_.grain));
    return body_name(body);
  }

  std::string plate() {
    const int body = pressed_link();
    const Body& link = scene().bodies[static_cast<std::size_t>(body)];
    const PlateWords words{given("thickness", "5"), given("density", "7850"), given("holes", "\"\"")};
    text_.set(link.name, mass_of_plate(link, words, scene().units, drawn_.grain));
    return body_name(body);
  }

  /// All moving bodies at a place, with a point or their drawing.
  std::set<int> bodies_at(std::size_t k) const {
    std::set<int> out;
    for (const PointRef& one : points_of(k)) out.insert(one.body);
    const auto next = [&] { return body_at(drawn_.pressed[k], out, within(k)); };
    for (int body = next(); body > 0; body = next()) out.insert(body);
    out.erase(0);
    return out;
  }

  /// The moving body at both places.
  int common_body() const {
    const std::set<int> first = bodies_at(0), second = bodies_at(1);
    for (const int body : first) {
      if (second.contains(body)) return body;
    }
    throw InputError("expected two places on one link");
  }

  std::set<int> all_bodies_but(int one) const {
    std::set<int> out;
    for (int body = 0; body < static_cast<int>(scene().bodies.size()); ++body) {
      if (body != one) out.insert(body);
    }
    return out;
  }

  /// The largest power of ten that is not longer than the mechanism.
  double decade() const { return std::pow(10.0, std::floor(std::log10(size_ / unit()))) * unit(); }

  /// A clearance that can be seen.
  std::string play() const { return length(0.02 * decade()); }

  /// The travel whose joint is nearest.
  std::string slide_at(Vec2 place) const {
    double nearest = std::numeric_limits<double>::infinity();
    std::string out;
    for (const Joint& joint : scene().joints) {
      if (!joint.has_travel()) continue;
      const double distance = std::min(norm(world(joint.a) - place), norm(world(joint.b) - place));
      if (distance >= nearest) continue;
      nearest = distance;
      out = joint.name;
    }
    if (out.empty()) throw InputError("expected a slide or a pin in a slot; draw one first");
    return out;
  }

  /// An item of a table: picks give what it acts on, and what stands in braces its first numbers.
  std::string item() {
    std::vector<PointRef> points;
    std::vector<int> bodies;
    std::set<int> used;
    Vec2 direction{1.0, 0.0};
    int direction_of = 0;
    std::string slide;
    const bool is_contact = tool_.name == "contact";
    std::set<int> not_there;
    if (tool_.name == "distributed_load") not_there = all_bodies_but(common_body());
    for (std::size_t k = 0; k < drawn_.places.size(); ++k) {
      const Pick kind = tool_.picks[std::min(k, tool_.picks.size() - 1)];
      const Vec2 place = drawn_.pressed[k];
      switch (kind) {
        case Pick::point:
        case Pick::moving: {
          // Ends of one spring are on two bodies, those of a distributed load on one, and a rope may come back. An
          // outline is on one body, another than that of the point that touches it.
          const bool apart = is_contact ? k == 1 : !tool_.more && tool_.name != "distributed_load";
          points.push_back(point_at(k, kind, apart ? used : not_there));
          used.insert(points.back().body);
          if (is_contact && k == 1) not_there = all_bodies_but(points.back().body);
          break;
        }
        case Pick::body:
        case Pick::link: {
          const int body = body_at(place, used, within(k));
          if (kind == Pick::link && body == 0) throw InputError("expected a place on a moving body");
          bodies.push_back(body);
          used.insert(body);
          break;
        }
        case Pick::direction: {
          direction = drawn_.places[k] - drawn_.places[k - 1];
          if (norm(direction) < drawn_.grain) throw InputError("expected another place, which gives the direction");
          direction = (1.0 / norm(direction)) * direction;
          direction_of = body_at(place, used, within(k));
          break;
        }
        case Pick::slide:
          slide = slide_at(place);
          break;
        case Pick::place:
          break;
      }
    }
    expect_apart(points);
    // A slide runs along a line of the body behind it; so do a pin in a slot and what rolls on a line.
    if (tool_.picks.back() == Pick::direction) {
      const PointRef on = points.front();
      const Vec2 at = world(on);
      const std::vector<PointRef> there = points_at(at, drawn_.within);
      const auto other = std::find_if(there.begin(), there.end(), [&](PointRef p) { return p.body == direction_of; });
      const PointRef base = other != there.end() ? *other : new_point(direction_of, at);
      points = {base, on};
    }
    if (bodies.size() == 2 && bodies[0] == bodies[1])
      throw InputError("expected two different bodies, found \"" + body_name(bodies[0]) + "\" twice");
    // The ground comes first, so that an angle is that of the body.
    if (bodies.size() == 2 && bodies[1] == 0) std::swap(bodies[0], bodies[1]);
    TomlKeys keys;
    const std::string name = given_name("");
    if (!name.empty()) keys.emplace_back("name", toml_string(name));
    std::string_view lines = tool_.keys;
    while (!lines.empty()) {
      const std::size_t end = std::min(lines.find('\n'), lines.size());
      const std::string_view line = lines.substr(0, end);
      lines.remove_prefix(std::min(end + 1, lines.size()));
      const std::size_t equals = line.find(" = ");
      const std::string key(line.substr(0, equals));
      keys.emplace_back(key,
                        filled(std::string(line.substr(equals + 3)), points, bodies, slide, direction, direction_of));
    }
    for (auto& [key, value] : keys) {
      if (const auto given = drawn_.values.find(key); given != drawn_.values.end() && key != "name")
        value = given->second;
    }
    text_.add_item(std::string(tool_.table), keys);
    return added_item();
  }

  /// Whether it is of the tool's table.
  bool is_of_table(const SceneItem& item) const {
    const auto at = static_cast<std::size_t>(item.index);
    switch (item.owner) {
      case Owner::joint:
        return scene().joints[at].traits().key == tool_.table;
      case Owner::element:
        return scene().elements[at].table == tool_.table;
      case Owner::stop:
        return scene().stops[at].table == tool_.table;
      case Owner::force:
        return tool_.table == (scene().forces[at].to ? "distributed_load" : "force");
      case Owner::torque:
        return tool_.table == "torque";
      case Owner::drive:
        return tool_.table == "drive";
      case Owner::blade:
        return tool_.table == "blade";
      default:
        return false;
    }
  }

  std::string filled(std::string value, const std::vector<PointRef>& points, const std::vector<int>& bodies,
                     const std::string& slide, Vec2 direction, int direction_of) const {
    const auto with = [&](const std::string& name, const auto& text) {
      const std::string mark = "{" + name + "}";
      for (std::size_t at = value.find(mark); at != std::string::npos; at = value.find(mark, at))
        value.replace(at, mark.size(), text());
    };
    const double force = 100.0 / scene().units.force;
    const double size = size_ / unit();
    for (std::size_t k = 0; k < points.size(); ++k) {
      with("point" + std::to_string(k + 1), [&] { return quoted(points[k]); });
    }
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      with("body" + std::to_string(k + 1), [&] { return toml_string(body_name(bodies[k])); });
    }
    const auto listed = [&](std::size_t first) {
      std::string out;
      for (std::size_t k = first; k < points.size(); ++k) out += (out.empty() ? "" : ", ") + quoted(points[k]);
      return "[" + out + "]";
    };
    with("points", [&] { return listed(0); });
    with("outline", [&] { return listed(1); });
    with("bodies", [&] {
      std::string out;
      for (const int one : bodies) out += (out.empty() ? "" : ", ") + toml_string(body_name(one));
      return "[" + out + "]";
    });
    with("slide", [&] { return toml_string(slide); });
    with("distance", [&] {
      double sum = 0.0;
      for (std::size_t k = 0; k + 1 < points.size(); ++k) sum += norm(world(points[k + 1]) - world(points[k]));
      return length(std::max(sum, drawn_.grain));
    });
    with("near", [&] { return length(0.25 * norm(world(points[1]) - world(points[0]))); });
    with("turn", [&] {
      if (points.size() == 2) return angle(turned(points[0].body, points[1].body));
      return angle(turned(bodies[0], bodies[1]));
    });
    with("half_turn", [&] { return angle(std::numbers::pi); });
    with("whole_turn", [&] { return angle(2.0 * std::numbers::pi); });
    with("quarter_more", [&] { return angle(turned(bodies[0], bodies[1]) + 0.25 * std::numbers::pi); });
    with("quarter_less", [&] { return angle(turned(bodies[0], bodies[1]) - 0.25 * std::numbers::pi); });
    with("axis", [&] {
      const Vec2 local = direction * conj(poise::unit(poses_[static_cast<std::size_t>(direction_of)].angle));
      return fmt::format("[{}, {}]", rounded(local.x, 1e-6), rounded(local.y, 1e-6));
    });
    with("down", [&] { return "[0, -" + plain(force) + "]"; });
    with("down_spread", [&] { return "[0, -" + plain(force / size) + "]"; });
    with("force", [&] { return plain(force); });
    with("torque", [&] { return plain(force * size / 5.0); });
    with("stiffness", [&] { return plain(5.0 * force / size); });
    with("turning_stiffness", [&] { return plain(force * size / 5.0 * scene().units.angle); });
    with("damping", [&] { return plain(0.5 * force / size); });
    with("turning_damping", [&] { return plain(0.05 * force * size * scene().units.angle); });
    with("cubic", [&] { return plain(50.0 * force / size / size / size); });
    with("quarter", [&] { return length(0.25 * decade()); });
    with("half", [&] { return length(0.5 * decade()); });
    with("play", [&] { return play(); });
    return value;
  }

  SceneText& text_;
  const Poses& poses_;
  const Drawn& drawn_;
  const DrawingTool& tool_;
  std::set<std::string> names_;  // of all points
  double size_ = 0.0;            // m
};

}  // namespace

std::span<const DrawingTool> drawing_tools() {
  using enum Pick;
  static const std::vector<DrawingTool> tools = {
      {"ground_point", "Ground point", "Bodies", "", {place}, false, "", "Click where the ground holds something."},
      {"link",
       "Link",
       "Bodies",
       "",
       {place, place},
       true,
       "",
       "Click its points; on a point or a link it is pinned. Enter or a double click ends it."},
      {"point", "Point on a link", "Bodies", "", {place}, false, "", "Click on a link."},
      {"mass", "Mass", "Bodies", "", {place}, false, "", "Click a link: its mass is spread over it."},
      {"plate",
       "Mass of a plate",
       "Bodies",
       "",
       {place},
       false,
       "",
       "Click a link: its mass is that of a plate with the outline of its points."},
      {"pin", "Pin", "Joints", "pin", {place}, false, "", "Click where two links meet, or one on the ground."},
      {"slide",
       "Slide",
       "Joints",
       "slide",
       {moving, direction},
       false,
       "points = {points}\naxis = {axis}\nangle = {turn}",
       "Click a point of what slides, then along its line. It keeps its angle; a pin that slides is a pin in a slot."},
      {"pin_in_slot",
       "Pin in a slot",
       "Joints",
       "pin_in_slot",
       {moving, direction},
       false,
       "points = {points}\naxis = {axis}",
       "Click the pin, then along the slot."},
      {"weld", "Weld", "Joints", "weld", {place}, false, "", "Click where two links meet, or one on the ground."},
      {"bar",
       "Bar",
       "Joints",
       "bar",
       {point, point},
       false,
       "points = {points}\nlength = {distance}",
       "Click two points: a rod without mass keeps their distance."},
      {"spring",
       "Spring",
       "Springs",
       "spring",
       {point, point},
       false,
       "points = {points}\nstiffness = {stiffness}\nfree_length = {distance}",
       "Click its two ends."},
      {"torsion_spring",
       "Torsion spring",
       "Springs",
       "torsion_spring",
       {body, body},
       false,
       "bodies = {bodies}\nstiffness = {turning_stiffness}\nfree_angle = {turn}",
       "Click two links, or one and the ground."},
      {"gas_strut",
       "Gas strut",
       "Springs",
       "spring",
       {point, point},
       false,
       "points = {points}\ngas = { preload = {force}, length = {distance}, stroke = {near}, ratio = 1.3 }",
       "Click its two ends where it is out."},
      {"constant_force",
       "Constant force",
       "Springs",
       "constant_force",
       {point, point},
       false,
       "points = {points}\nforce = {force}",
       "Click its two ends."},
      {"cubic_spring",
       "Hardening spring",
       "Springs",
       "cubic_spring",
       {point, point},
       false,
       "points = {points}\nstiffness = {stiffness}\ncubic = {cubic}\nfree_length = {distance}",
       "Click its two ends."},
      {"bump_stop",
       "Bump stop",
       "Springs",
       "bump_stop",
       {point, point},
       false,
       "points = {points}\nforce = {force}\nfree_length = {near}\ndepth = {near}\nexponent = 2",
       "Click two points that come near each other."},
      {"damper",
       "Damper",
       "Springs",
       "damper",
       {point, point},
       false,
       "points = {points}\ncoefficient = {damping}",
       "Click its two ends."},
      {"torsion_damper",
       "Torsion damper",
       "Springs",
       "torsion_damper",
       {body, body},
       false,
       "bodies = {bodies}\ncoefficient = {turning_damping}",
       "Click two links, or one and the ground."},
      {"motor",
       "Motor",
       "Springs",
       "motor",
       {body, body},
       false,
       "bodies = {bodies}\nstall_torque = {torque}\nno_load_rate = {whole_turn}",
       "Click two links, or the ground and one, which it turns counter-clockwise."},
      {"controller",
       "Controller",
       "Springs",
       "controller",
       {body, body},
       false,
       "bodies = {bodies}\nproportional = {turning_stiffness}\nderivative = {turning_damping}\nreference = {turn}",
       "Click two links, or the ground and one, whose angle it keeps where it is in motion."},
      {"friction",
       "Friction",
       "Springs",
       "friction",
       {body, body},
       false,
       "bodies = {bodies}\ntorque = {torque}",
       "Click two links, or one and the ground."},
      {"force",
       "Load",
       "Loads",
       "force",
       {moving},
       false,
       "at = {point1}\nvector = {down}",
       "Click where it acts; then pull its arrow."},
      {"distributed_load",
       "Spread load",
       "Loads",
       "distributed_load",
       {moving, moving},
       false,
       "points = {points}\nvector = {down_spread}",
       "Click two points of one link."},
      {"torque", "Torque", "Loads", "torque", {link}, false, "on = {body1}\nvalue = {torque}", "Click a link."},
      {"drive",
       "Drive",
       "Loads",
       "drive",
       {body, body},
       false,
       "bodies = {bodies}\nrate = 1",
       "Click the link that turns, and what it turns on."},
      {"stop",
       "Stop",
       "Limits",
       "stop",
       {body, body},
       false,
       "bodies = {bodies}\nmin = {quarter_less}\nmax = {quarter_more}",
       "Click two links, or one and the ground: the angle between them gets limits."},
      {"blade",
       "Blade",
       "Limits",
       "blade",
       {moving},
       false,
       "at = {point1}\nangle = 0",
       "Click a point of a link: it then moves along an edge that is fixed in the link, never across it."},
      {"rope",
       "Rope",
       "Limits",
       "rope",
       {point, point},
       true,
       "over = {points}\nlength = {distance}",
       "Click the points that it passes. Enter or a double click ends it."},
      {"contact",
       "Contact",
       "Limits",
       "contact",
       {moving, point, point},
       true,
       "point = {point1}\nradius = {play}\noutline = {outline}",
       "Click a point, then along an outline of another body, on the left of which it is. Enter or a double click ends "
       "it."},
      {"loose_pin",
       "Pin with clearance",
       "Limits",
       "loose_pin",
       {place},
       false,
       "",
       "Click where two links meet, or one on the ground."},
      {"loose_slot",
       "Slot with clearance",
       "Limits",
       "loose_slot",
       {moving, direction},
       false,
       "points = {points}\naxis = {axis}\nclearance = {play}",
       "Click the pin, then along the slot."},
      {"gear", "Gear pair", "Gears", "gear", {body, body}, false, "bodies = {bodies}\nratio = 1", "Click two wheels."},
      {"rack",
       "Rack",
       "Gears",
       "rack",
       {link, slide},
       false,
       "slide = {slide}\npinion = {body1}\nradius = {quarter}",
       "Click the pinion, then the slide that it moves."},
      {"cam",
       "Cam",
       "Gears",
       "cam",
       {link, slide},
       false,
       "bodies = [\"ground\", {body1}]\nfollower = { slide = {slide} }\nlaw = [{ to = {half_turn}, lift = 1, law = "
       "\"cycloidal\" }, { to = {whole_turn}, lift = 0, law = \"cycloidal\" }]\nlift = {quarter}\nbase = {half}",
       "Click the cam, then the slide of its follower."},
      {"geneva",
       "Geneva drive",
       "Gears",
       "geneva",
       {link, link},
       false,
       "bodies = {bodies}\nslots = 4",
       "Click the crank, then the wheel that it turns step by step."},
      {"belt", "Belt", "Gears", "belt", {body, body}, false, "bodies = {bodies}\nratio = 1", "Click two pulleys."},
      {"coupling",
       "Coupling",
       "Gears",
       "coupling",
       {body, link, body, link},
       false,
       "sum = [{ factor = 1, bodies = [{body1}, {body2}] }, { factor = -1, bodies = [{body1}, {body4}] }]",
       "Click the ground and a link, then the ground and another: their angles go together."},
      {"chain",
       "Chain",
       "Gears",
       "chain",
       {point, point},
       false,
       "a = {point1}\nb = {point2}\nradius_a = {quarter}\nradius_b = {quarter}",
       "Click the centres of two sprockets."},
      {"circular_slot",
       "Circular slot",
       "Slots",
       "circular_slot",
       {moving, point},
       false,
       "pin = {point1}\ncenter = {point2}\nradius = {distance}",
       "Click the pin, then the centre of its slot."},
      {"curved_slot",
       "Curved slot",
       "Slots",
       "curved_slot",
       {moving, point},
       false,
       "pin = {point1}\nat = {point2}\ncurve = [[-{half}, 0], [0, {quarter}], [{half}, 0]]",
       "Click the pin, then where its slot begins on another body."},
      {"rolling_profile",
       "Foot on a line",
       "Slots",
       "rolling_profile",
       {moving, direction},
       false,
       "at = {point2}\nline = {point1}\naxis = {axis}\ncurve = [[-{half}, {quarter}], [0, 0], [{half}, {quarter}]]",
       "Click a point of the body that rolls, then along the line."},
      {"rolling_profile_on_circle",
       "Foot on a circle",
       "Slots",
       "rolling_profile_on_circle",
       {moving, point},
       false,
       "at = {point1}\ncenter = {point2}\ncircle_radius = {distance}\ncurve = [[-{half}, {quarter}], [0, 0], [{half}, "
       "{quarter}]]",
       "Click a point of the body that rolls, then the centre of the circle."},
      {"curve_contact",
       "Curve on a curve",
       "Slots",
       "curve_contact",
       {moving, point},
       false,
       "at = {point1}\nagainst = {point2}\ncurve = [[{quarter}, 0], [0, {quarter}], [-{quarter}, 0], [0, "
       "-{quarter}]]\nagainst_curve = [[{quarter}, 0], [0, {quarter}], [-{quarter}, 0], [0, -{quarter}]]",
       "Click a point of a body, then one of the body that it touches."},
      {"rolling",
       "Wheel on a line",
       "Slots",
       "rolling",
       {moving, direction},
       false,
       "wheel = {point2}\nline = {point1}\naxis = {axis}\nradius = {quarter}",
       "Click the centre of the wheel, then along the line."},
      {"rolling_on_circle",
       "Wheel on a circle",
       "Slots",
       "rolling_on_circle",
       {moving, point},
       false,
       "wheel = {point1}\ncenter = {point2}\nradius = {quarter}\ncircle_radius = {distance}",
       "Click the centre of the wheel, then that of the circle."},
  };
  return tools;
}

std::string draw(SceneText& text, const Poses& poses, const Drawn& drawn) {
  std::vector<std::string> names;
  for (const DrawingTool& tool : drawing_tools()) {
    names.emplace_back(tool.name);
    if (tool.name != drawn.tool) continue;
    const std::size_t count = tool.picks.size();
    if (drawn.places.size() < count || (drawn.places.size() > count && !tool.more))
      throw InputError(fmt::format("{}: expected {} places, found {}", tool.name, count, drawn.places.size()));
    SceneText changed = text;
    std::string item = Sketcher(changed, poses, drawn, tool).run();
    text = std::move(changed);
    return item;
  }
  throw InputError("tool: expected a tool" + did_you_mean_or_list(drawn.tool, names));
}

}  // namespace poise::app
