#include "statics/quantities/quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/named_measures.hpp"
#include "model/named_number.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;
using Part = SoughtQuantity::Part;

constexpr std::string_view separators = " +-*/()";

SoughtQuantity measured(std::string name, const Measure& on) {
  return {.name = std::move(name), .on = on, .dimension = on.dimension()};
}

SoughtQuantity center_of(const Scene& scene, int body, int other, Part part) {
  const auto name = [&](int i) -> const std::string& { return scene.bodies[static_cast<std::size_t>(i)].name; };
  return {.name = fmt::format("center.{}.{}.{}", name(body), name(other), part == Part::x ? "x" : "y"),
          .kind = Kind::center,
          .part = part,
          .item = body,
          .other = other,
          .dimension = dimension::length};
}

SoughtQuantity mode(int number, Kind kind) {
  const bool is_frequency = kind == Kind::frequency;
  return {.name = fmt::format("mode.{}.{}", number, is_frequency ? "frequency" : "damping"),
          .kind = kind,
          .item = number - 1,
          .dimension = is_frequency ? dimension::time.power(-1) : dimension::none};
}

/// Quantities of a scene by their names, and what else they may be called.
class Catalogue {
 public:
  Catalogue(const Scene& scene, AskedOf asked_of) : scene_(scene), asked_of_(asked_of) {
    add_quantities();
    add_outputs();
  }

  /// In their order, outputs last.
  const std::vector<SoughtQuantity>& all() const { return all_; }

  /// The quantity whose name begins the text, the longest; none without one.
  std::optional<SoughtQuantity> longest(std::string_view text, std::size_t& length) const {
    const SoughtQuantity* found = nullptr;
    for (const auto& [name, index] : by_name_) {
      if (!text.starts_with(name) || (found != nullptr && name.size() <= length)) continue;
      found = &all_[index];
      length = name.size();
    }
    const std::optional<NamedMeasure> composed = composed_measure(scene_, text, separators);
    if (composed && (found == nullptr || composed->name.size() > length)) {
      length = composed->name.size();
      return measured(composed->name, composed->on);
    }
    return found == nullptr ? std::nullopt : std::optional(*found);
  }

  /// What quantities may be called, and their names.
  const std::map<std::string, std::size_t>& by_name() const { return by_name_; }

  /// Names that two elements have.
  const std::map<std::string, std::vector<std::string>>& shared() const { return shared_; }
  const Scene& scene() const { return scene_; }
  AskedOf asked_of() const { return asked_of_; }

 private:
  void add_outputs();

  void add_quantities() {
    add_measures();
    add_element_forces();
    add_drive_forces();
    if (asked_of_ == AskedOf::motion) add_blade_forces();
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) add_reaction(static_cast<int>(j));
    add_stops();
    add_shaking();
    add_pushes();
    add_energy();
    add_centers();
    add_transmissions();
    add_stresses();
    add_modes();
    add_folds();
  }

  void add(SoughtQuantity one, const std::vector<std::string>& also = {}) {
    const std::size_t index = all_.size();
    by_name_.emplace(one.name, index);
    for (const std::string& other : also) by_name_.emplace(other, index);
    all_.push_back(std::move(one));
  }

  void add_measures() {
    for (const NamedMeasure& one : named_measures(scene_)) add(measured(one.name, one.on), one.also);
    const std::vector<ElementName> names = names_of_elements(scene_);
    for (std::size_t e = 0; e < names.size(); ++e) {
      const auto& [own, whole] = names[e];
      if (own.empty()) shared_[scene_.elements[e].name].push_back(whole);
    }
  }

  void add_element_forces() {
    const std::vector<ElementName> names = names_of_elements(scene_);
    const auto add_of_springs = [&](const std::string& prefix, Kind kind, auto&& dimension) {
      for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
        const Element& of = scene_.elements[e];
        const bool resists = asked_of_ == AskedOf::motion && kind == Kind::element_force;
        if (!stores_energy(of.law) && !resists) continue;
        const auto& [own, whole] = names[e];
        add({.name = prefix + (own.empty() ? whole : own),
             .kind = kind,
             .item = static_cast<int>(e),
             .dimension = of.feedback ? of.feedback->output : dimension(of.on)},
            {prefix + whole});
      }
    };
    add_of_springs("force.", Kind::element_force, [](const Measure& on) { return on.effort_dimension(); });
    add_of_springs("rate.", Kind::element_rate,
                   [](const Measure& on) { return on.effort_dimension() * on.dimension().power(-1); });
  }

  // An element that has the name of a drive has it here.
  void add_drive_forces() {
    const bool is_one = std::all_of(scene_.drives.begin(), scene_.drives.end(),
                                    [&](const Drive& drive) { return is_same(drive.on, scene_.drives.front().on); });
    for (const Drive& drive : scene_.drives) {
      const bool is_taken = by_name_.contains("force." + drive.name);
      std::vector<std::string> also{"force.drive." + drive.name};
      if (is_one) also.emplace_back("force.drive");
      add({.name = (is_taken ? "force.drive." : "force.") + drive.name,
           .kind = Kind::drive_force,
           .on = drive.on,
           .dimension = drive.on.effort_dimension()},
          also);
    }
  }

  // An element or a drive that has the name of a blade has it here.
  void add_blade_forces() {
    for (std::size_t b = 0; b < scene_.blades.size(); ++b) {
      const std::string& name = scene_.blades[b].name;
      const bool is_taken = by_name_.contains("force." + name);
      add({.name = (is_taken ? "force.blade." : "force.") + name,
           .kind = Kind::blade_force,
           .item = static_cast<int>(b),
           .dimension = dimension::force},
          {"force.blade." + name});
    }
  }

  void add_stops() {
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      add({.name = "stop." + scene_.stops[s].name,
           .kind = Kind::stop_reaction,
           .item = static_cast<int>(s),
           .dimension = scene_.stops[s].on.effort_dimension()});
    }
  }

  void add_shaking() {
    const auto part = [&](const char* name, Part which, const Dimension& dimension) {
      add({.name = name, .kind = Kind::shaking, .part = which, .dimension = dimension});
    };
    part("shaking.x", Part::x, dimension::force);
    part("shaking.y", Part::y, dimension::force);
    part("shaking.size", Part::size, dimension::force);
    part("shaking.moment", Part::moment, dimension::torque);
  }

  void add_reaction(int joint) {
    const Joint& of = scene_.joints[static_cast<std::size_t>(joint)];
    const std::string name = "reaction." + of.name;
    const auto part = [&](const std::string& called, Part which, const Dimension& dimension,
                          const std::vector<std::string>& also = {}) {
      add({.name = called, .kind = Kind::reaction, .part = which, .item = joint, .dimension = dimension}, also);
    };
    if (of.keeps_length()) {
      part(name, Part::axial, dimension::force, {name + ".axial"});
      part(name + ".size", Part::size, dimension::force);
    } else {
      part(name, Part::size, dimension::force, {name + ".size"});
    }
    part(name + ".x", Part::x, dimension::force);
    part(name + ".y", Part::y, dimension::force);
    if (of.keeps_angle()) part(name + ".moment", Part::moment, dimension::torque);
  }

  void add_pushes() {
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      for (std::size_t p = 0; p < scene_.bodies[i].points.size(); ++p) {
        const PointRef point{static_cast<int>(i), static_cast<int>(p)};
        const std::string name = "push." + scene_.name_of(point);
        for (const bool along_y : {false, true}) {
          add({.name = name + (along_y ? ".y" : ".x"),
               .kind = Kind::push,
               .point = point,
               .direction = along_y ? Vec2{0.0, 1.0} : Vec2{1.0, 0.0},
               .dimension = dimension::force});
        }
      }
    }
  }

  // A force that follows a body has no potential.
  void add_energy() {
    const bool follows =
        std::any_of(scene_.forces.begin(), scene_.forces.end(), [](const Force& force) { return force.follows >= 0; });
    const std::vector<std::string> also =
        asked_of_ == AskedOf::motion ? std::vector<std::string>{"energy.potential"} : std::vector<std::string>{};
    if (!follows) add({.name = "energy", .kind = Kind::energy, .dimension = dimension::torque}, also);
    if (asked_of_ == AskedOf::rest) return;
    add({.name = "energy.kinetic", .kind = Kind::kinetic_energy, .dimension = dimension::torque});
  }

  // Those relative to the ground; Reader reads the names of all pairs.
  void add_centers() {
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      for (const Part part : {Part::x, Part::y}) add(center_of(scene_, static_cast<int>(i), 0, part));
    }
  }

  void add_transmission(const std::string& name, PointRef from, PointRef to, int body) {
    if (body == 0) return;
    add({.name = "transmission." + name,
         .kind = Kind::transmission,
         .on = Measure::distance_between(from, to),
         .item = body,
         .dimension = dimension::angle});
  }

  void add_transmissions() {
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const int link = static_cast<int>(i);
      std::vector<const Joint*> joints;
      for (const Joint& joint : scene_.joints) {
        if (joint.a.body == link || joint.b.body == link) joints.push_back(&joint);
      }
      if (joints.size() != 2) continue;
      const auto point = [&](const Joint& of) { return of.keeps_length() && of.a.body == link ? of.a : of.b; };
      for (const std::size_t near : {0U, 1U}) {
        const Joint& at = *joints[near];
        // The end of a bar moves with the link.
        const int other = at.keeps_length() ? link : at.a.body == link ? at.b.body : at.a.body;
        add_transmission(scene_.bodies[i].name + "." + at.name, point(*joints[1 - near]), point(at), other);
      }
    }
    for (const Joint& bar : scene_.joints) {
      if (!bar.keeps_length()) continue;
      add_transmission(bar.name + "." + scene_.bodies[static_cast<std::size_t>(bar.a.body)].name, bar.b, bar.a,
                       bar.a.body);
      add_transmission(bar.name + "." + scene_.bodies[static_cast<std::size_t>(bar.b.body)].name, bar.a, bar.b,
                       bar.b.body);
    }
  }

  void add_stresses() {
    const auto add_stress = [&](const std::string& link, int item, int other) {
      add({.name = "stress." + link,
           .kind = Kind::stress,
           .item = item,
           .other = other,
           .dimension = dimension::force * dimension::length.power(-2)});
    };
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      if (!scene_.bodies[i].section) continue;
      add_stress(scene_.bodies[i].name, static_cast<int>(i), -1);
      add_link_loads(static_cast<int>(i));
    }
    for (std::size_t k = 0; k < scene_.flexible_links.size(); ++k) {
      add_stress(scene_.flexible_links[k].name, static_cast<int>(k), 0);
    }
  }

  void add_link_loads(int body) {
    const Body& link = scene_.bodies[static_cast<std::size_t>(body)];
    for (std::size_t p = 0; p < link.points.size(); ++p) {
      const auto add_part = [&](const char* load, Part part, Dimension dimension) {
        add({.name = fmt::format("{}.{}.{}", load, link.name, link.points[p].name),
             .kind = Kind::link_load,
             .part = part,
             .item = body,
             .point = {body, static_cast<int>(p)},
             .dimension = dimension});
      };
      add_part("normal", Part::axial, dimension::force);
      add_part("shear", Part::shear, dimension::force);
      add_part("moment", Part::moment, dimension::torque);
    }
  }

  // The first; Reader reads the names of all.
  void add_modes() {
    const auto has_inertia = [](const Body& body) { return body.mass > 0.0 || body.inertia > 0.0; };
    if (std::none_of(scene_.bodies.begin(), scene_.bodies.end(), has_inertia)) return;
    add(mode(1, Kind::frequency));
    add(mode(1, Kind::damping));
  }

  void add_folds() {
    for (const ParameterRow& row : parameter_table(scene_)) {
      if ((row.place.owner != Owner::force && row.place.owner != Owner::torque) || row.place.number != 0) continue;
      const std::string name(row.path.parts[1]);
      add({.name = "fold.load." + name,
           .kind = Kind::load_at_fold,
           .load = row.path.text(),
           .dimension = row.dimension},
          {"load_at_fold." + name});
    }
  }

  const Scene& scene_;
  AskedOf asked_of_;
  std::vector<SoughtQuantity> all_;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, std::vector<std::string>> shared_;
};

/// What a name begins with, and what follows.
struct Family {
  std::string_view prefix, item;
};
constexpr std::array<Family, 12> families{{{"force.", "a force element or drive"},
                                           {"rate.", "a force element"},
                                           {"reaction.", "a joint"},
                                           {"stop.", "a stop"},
                                           {"center.", "a body and another, BODY.BODY.x,"},
                                           {"stress.", "a link with a section"},
                                           {"normal.", "a link with a section and of a point of it"},
                                           {"shear.", "a link with a section and of a point of it"},
                                           {"moment.", "a link with a section and of a point of it"},
                                           {"transmission.", "a link with two joints and one of these"},
                                           {"fold.load.", "a load"},
                                           {"load_at_fold.", "a load"}}};

/// The tail of a message that names the three quantities nearest to a word, or to all that follows, for a name may have
/// spaces: `; did you mean "a", "b" or "c"?`. Of those only that may be called something with this prefix.
std::string nearest_three(const Catalogue& catalogue, std::string_view prefix, std::string_view word,
                          std::string_view whole) {
  constexpr std::size_t most = 3, longest_compared = 200;
  const auto distance = [&](std::string_view name, const std::string& candidate) {
    const bool is_long = std::max(name.size(), candidate.size()) > longest_compared;
    return is_long ? std::numeric_limits<int>::max() : edit_distance(name, candidate);
  };
  std::vector<std::pair<int, std::size_t>> order;
  for (const auto& [called, index] : catalogue.by_name()) {
    if (called.starts_with(prefix)) {
      order.emplace_back(std::min(distance(word, called), distance(whole, called)), index);
    }
  }
  std::sort(order.begin(), order.end());
  std::vector<std::string> names;
  for (const auto& [edits, index] : order) {
    const std::string name = "\"" + catalogue.all()[index].name + "\"";
    if (names.size() < most && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  if (names.empty()) return "; there is none here";
  std::string text = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 == names.size() ? " or " : ", ") + names[i];
  return "; did you mean " + text + "?";
}

/// Reads a quantity, or an expression of several, from a text. A name may have spaces, hyphens and points in it, so
/// that the longest name of the scene is taken; where none is, the longest word is what the error is about.
class Reader {
 public:
  Reader(const Catalogue& catalogue, const std::string& text) : catalogue_(catalogue), text_(text), rest_(text) {}

  SoughtQuantity read() {
    if (text_.size() > longest) {
      throw InputError(fmt::format("{}...: expected an expression of at most {} characters, found {}",
                                   text_.substr(0, 20), longest, text_.size()));
    }
    SoughtQuantity out = sum();
    skip_spaces();
    if (!rest_.empty()) fail(fmt::format("expected + - * / or the end, found \"{}\"", rest_));
    if (out.is_over_path() && has_position(out)) {
      fail("expected quantities over a path, or of a position, not both in one expression");
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw InputError(text_ + ": " + why); }

  void skip_spaces() { rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size())); }
  bool take(std::string_view sign) {
    skip_spaces();
    if (!rest_.starts_with(sign)) return false;
    rest_.remove_prefix(sign.size());
    return true;
  }

  /// Whether some part beside those over a path belongs to a position.
  static bool has_position(const SoughtQuantity& of) {
    switch (of.kind) {
      case Kind::sum:
      case Kind::difference:
      case Kind::product:
      case Kind::quotient:
        return std::any_of(of.of.begin(), of.of.end(), has_position);
      default:
        return of.kind != Kind::number && !of.is_over_path();
    }
  }

  SoughtQuantity sum() {
    SoughtQuantity out = product();
    while (true) {
      const bool adds = take("+");
      if (!adds && !take("-")) return out;
      SoughtQuantity other = product();
      if (!(out.dimension == other.dimension)) {
        fail(fmt::format("expected quantities of one unit on both sides of {}, found {} and {}", adds ? "+" : "-",
                         out.name, other.name));
      }
      out = made_of(adds ? Kind::sum : Kind::difference, adds ? " + " : " - ", std::move(out), std::move(other));
    }
  }

  SoughtQuantity product() {
    SoughtQuantity out = factor();
    while (true) {
      const bool multiplies = take("*");
      if (!multiplies && !take("/")) return out;
      SoughtQuantity other = factor();
      const Dimension dimension = out.dimension * other.dimension.power(multiplies ? 1 : -1);
      out = made_of(multiplies ? Kind::product : Kind::quotient, multiplies ? " * " : " / ", std::move(out),
                    std::move(other));
      out.dimension = dimension;
    }
  }

  static SoughtQuantity made_of(Kind kind, const std::string& sign, SoughtQuantity a, SoughtQuantity b) {
    SoughtQuantity out{.name = in_parentheses(a, kind, false) + sign + in_parentheses(b, kind, true),
                       .kind = kind,
                       .dimension = a.dimension};
    out.of = {std::move(a), std::move(b)};
    return out;
  }

  /// The name of an operand, in parentheses where the operation binds more than it.
  static std::string in_parentheses(const SoughtQuantity& operand, Kind kind, bool is_second) {
    if (operand.is_output) return operand.name;
    const bool is_sum = operand.kind == Kind::sum || operand.kind == Kind::difference;
    const bool is_product = operand.kind == Kind::product || operand.kind == Kind::quotient;
    const bool binds = kind == Kind::product || kind == Kind::quotient;
    const bool needed = (is_sum && (binds || (is_second && kind == Kind::difference))) ||
                        (is_product && is_second && kind == Kind::quotient) ||
                        (is_second && operand.kind == Kind::number && operand.constant < 0.0);
    return needed ? "(" + operand.name + ")" : operand.name;
  }

  SoughtQuantity factor() {
    if (++depth_ > deepest) fail(fmt::format("expected at most {} brackets and signs inside each other", deepest));
    SoughtQuantity out = factor_inside();
    --depth_;
    return out;
  }

  SoughtQuantity factor_inside() {
    if (take("-")) {
      SoughtQuantity minus_one = number(-1.0);
      SoughtQuantity of = factor();
      if (of.kind == Kind::number) return number(-of.constant);
      const Dimension dimension = of.dimension;
      SoughtQuantity out = made_of(Kind::product, " * ", std::move(minus_one), std::move(of));
      out.dimension = dimension;
      return out;
    }
    if (take("(")) {
      SoughtQuantity out = sum();
      if (!take(")")) fail("expected a closing parenthesis");
      return out;
    }
    skip_spaces();
    if (rest_.starts_with("d(")) return derivative();
    if (std::optional<SoughtQuantity> over = over_path()) return *std::move(over);
    if (const std::optional<SoughtQuantity> named = name()) return *named;
    return constant();
  }

  static SoughtQuantity number(double value) {
    return {.name = fmt::format("{}", value), .kind = Kind::number, .dimension = dimension::none, .constant = value};
  }

  SoughtQuantity constant() {
    std::size_t end = 0;
    while (end < rest_.size()) {
      const bool is_exponent_sign =
          end > 0 && (rest_[end] == '-' || rest_[end] == '+') && (rest_[end - 1] == 'e' || rest_[end - 1] == 'E');
      if (separators.find(rest_[end]) != std::string_view::npos && !is_exponent_sign) break;
      ++end;
    }
    const std::string word(rest_.substr(0, end));
    const std::optional<double> value = read_number(word);
    if (!value || !std::isfinite(*value)) refuse(word);
    rest_.remove_prefix(end);
    return number(*value);
  }

  /// Throws InputError for a word that is no name of the scene.
  [[noreturn]] void refuse(const std::string& word) const {
    if (word.empty()) fail("expected a quantity, found nothing");
    if (const auto shared = catalogue_.shared().find(word); shared != catalogue_.shared().end()) {
      fail(fmt::format("expected one element, found {} and {}; give one of these", shared->second[0],
                       shared->second[1]));
    }
    const Scene& scene = catalogue_.scene();
    for (const Force& force : scene.forces) {
      if (word == "energy" && force.follows >= 0) {
        fail(fmt::format("force \"{}\" follows a body and has no potential; expected another quantity", force.name));
      }
    }
    // The whole rest may be a name with spaces that is misspelt.
    const std::string whole(rest_);
    if (const std::string why = why_not(scene, whole); !why.empty()) fail(why);
    for (const auto& [prefix, item] : measure_families) {
      if (!whole.starts_with(prefix)) continue;
      fail(fmt::format("expected the name of {}{}", item, nearest_three(catalogue_, prefix, word, whole)));
    }
    for (const auto& [prefix, item] : families) {
      if (!whole.starts_with(prefix)) continue;
      fail(fmt::format("expected the name of {}{}", item, nearest_three(catalogue_, prefix, word, whole)));
    }
    fail("expected the name of a quantity" + nearest_three(catalogue_, "", word, whole));
  }

  /// Why a name is none although the scene has its item; empty where it has not.
  static std::string why_not(const Scene& scene, const std::string& name) {
    if (name == "angle." + scene.bodies.front().name) return "the ground does not turn; expected another body";
    for (const Joint& joint : scene.joints) {
      const std::string of = "reaction." + joint.name + ".";
      if (name == "travel." + joint.name) {
        return fmt::format("expected a slide or pin in a slot, {} is a {}", joint.name, joint.traits().key);
      }
      if (!name.starts_with(of)) continue;
      const std::string part = name.substr(of.size());
      if (part == "moment") {
        return fmt::format("a {} transmits no moment; of slides and welds only", joint.traits().key);
      }
      if (part == "axial") return fmt::format("a {} has no axial force; of bars only", joint.traits().key);
      return fmt::format("expected size, x, y, moment or axial after the joint, found {}", part);
    }
    for (const Element& element : scene.elements) {
      if (stores_energy(element.law)) continue;
      for (const std::string& called : {element.name, element.table + "." + element.name}) {
        if (name != "force." + called && name != "rate." + called) continue;
        return fmt::format("a {} has no force at rest; expected a spring or constant force", element.family());
      }
    }
    return "";
  }

  std::optional<SoughtQuantity> name() {
    std::size_t length = 0;
    std::optional<SoughtQuantity> found = catalogue_.longest(rest_, length);
    if (std::optional<SoughtQuantity> along = push(length)) return along;
    if (std::optional<SoughtQuantity> of_two = center(length)) return of_two;
    if (std::optional<SoughtQuantity> of_mode = mode_of_vibration()) return of_mode;
    if (!found) return std::nullopt;
    const bool ends = length == rest_.size() || separators.find(rest_[length]) != std::string_view::npos;
    if (!ends) return std::nullopt;
    rest_.remove_prefix(length);
    return found;
  }

  /// push.BODY.POINT. and an angle in degrees, where that is longer than the name found.
  std::optional<SoughtQuantity> push(std::size_t found) {
    for (const SoughtQuantity& one : catalogue_.all()) {
      if (one.kind != Kind::push || one.is_output || one.direction.x != 1.0) continue;
      const std::string stem = one.name.substr(0, one.name.size() - 1);
      if (!rest_.starts_with(stem)) continue;
      std::size_t end = stem.size();
      if (end < rest_.size() && rest_[end] == '-') ++end;
      while (end < rest_.size() && separators.find(rest_[end]) == std::string_view::npos) ++end;
      const std::string word(rest_.substr(stem.size(), end - stem.size()));
      const std::optional<double> degrees = read_number(word);
      if (!degrees || !std::isfinite(*degrees) || end <= found) continue;
      SoughtQuantity out = one;
      out.name = stem + word;
      const double angle = *degrees * std::numbers::pi / 180.0;
      out.direction = {std::cos(angle), std::sin(angle)};
      rest_.remove_prefix(end);
      return out;
    }
    return std::nullopt;
  }

  /// center.BODY.BODY.x or .y, where that is longer than the name found.
  std::optional<SoughtQuantity> center(std::size_t found) {
    constexpr std::string_view prefix = "center.";
    if (!rest_.starts_with(prefix)) return std::nullopt;
    const std::vector<Body>& bodies = catalogue_.scene().bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!rest_.substr(prefix.size()).starts_with(bodies[i].name + ".")) continue;
      const std::size_t first = prefix.size() + bodies[i].name.size() + 1;
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        for (const Part part : {Part::x, Part::y}) {
          const std::string second = bodies[k].name + (part == Part::x ? ".x" : ".y");
          const std::size_t end = first + second.size();
          if (i == k || end <= found || !rest_.substr(first).starts_with(second)) continue;
          if (end < rest_.size() && separators.find(rest_[end]) == std::string_view::npos) continue;
          rest_.remove_prefix(end);
          return center_of(catalogue_.scene(), static_cast<int>(i), static_cast<int>(k), part);
        }
      }
    }
    return std::nullopt;
  }

  std::optional<SoughtQuantity> mode_of_vibration() {
    constexpr std::string_view prefix = "mode.";
    if (!rest_.starts_with(prefix)) return std::nullopt;
    const std::string_view tail = rest_.substr(prefix.size());
    int number = 0;
    const auto [end, error] = std::from_chars(tail.data(), tail.data() + tail.size(), number);
    const int most = 3 * static_cast<int>(catalogue_.scene().bodies.size());
    if (error != std::errc() || number < 1 || number > most) return std::nullopt;
    for (const Kind kind : {Kind::frequency, Kind::damping}) {
      SoughtQuantity one = mode(number, kind);
      if (!rest_.starts_with(one.name)) continue;
      rest_.remove_prefix(one.name.size());
      return one;
    }
    return std::nullopt;
  }

  struct OverPath {
    std::string_view name;
    Kind kind;
  };
  static constexpr std::array<OverPath, 5> over_paths{{{"max(", Kind::maximum},
                                                       {"min(", Kind::minimum},
                                                       {"mean(", Kind::mean},
                                                       {"span(", Kind::span},
                                                       {"work(", Kind::work}}};

  std::optional<SoughtQuantity> over_path() {
    const auto* const found = std::find_if(over_paths.begin(), over_paths.end(),
                                           [&](const OverPath& one) { return rest_.starts_with(one.name); });
    if (found == over_paths.end()) return std::nullopt;
    rest_.remove_prefix(found->name.size());
    SoughtQuantity of = sum();
    if (!take(")")) fail(fmt::format("expected a closing parenthesis after {}", found->name));
    if (of.is_over_path())
      fail(fmt::format("expected a quantity of a position in {}...), found {}", found->name, of.name));
    SoughtQuantity out{
        .name = std::string(found->name) + of.name + ")", .kind = found->kind, .dimension = of.dimension};
    if (out.kind == Kind::work) {
      if (forces_in(of) != 1) {
        fail(
            fmt::format("expected the force of a push, an element or a drive in work(...), perhaps times a number, "
                        "found {}",
                        of.name));
      }
      out.dimension = of.dimension * dimension::length;
      // A torque times an angle, which has no unit in SI, is a torque.
      if (of.dimension.length > 0) out.dimension = of.dimension;
    }
    out.of = {std::move(of)};
    return out;
  }

  /// How many forces with a path of their own it is made of; more than any where it has other parts than these and
  /// numbers.
  static int forces_in(const SoughtQuantity& of) {
    switch (of.kind) {
      case Kind::push:
      case Kind::element_force:
      case Kind::drive_force:
        return 1;
      case Kind::number:
        return 0;
      case Kind::product:
      case Kind::quotient:
        return forces_in(of.of[0]) + (of.kind == Kind::quotient ? 2 : 1) * forces_in(of.of[1]);
      default:
        return 2;
    }
  }

  /// Whether it changes with the pose alone, and not with what holds it.
  bool has_rate(const SoughtQuantity& of) const {
    switch (of.kind) {
      case Kind::measure:
      case Kind::energy:
      case Kind::number:
        return true;
      case Kind::element_force:
        return stores_energy(catalogue_.scene().elements[static_cast<std::size_t>(of.item)].law);
      case Kind::sum:
      case Kind::difference:
      case Kind::product:
      case Kind::quotient:
        return std::all_of(of.of.begin(), of.of.end(), [this](const SoughtQuantity& one) { return has_rate(one); });
      default:
        return false;
    }
  }

  /// d(A)/d(B), or d(A)/dt of a motion.
  SoughtQuantity derivative() {
    const auto part = [&]() -> SoughtQuantity {
      if (!take("d(")) fail("expected d(A)/d(B)");
      SoughtQuantity out = sum();
      if (!take(")")) fail("expected a closing parenthesis in d(A)/d(B)");
      return out;
    };
    SoughtQuantity a = part();
    if (!take("/")) fail("expected d(A)/d(B)");
    skip_spaces();
    if (rest_.starts_with("dt")) return by_time(std::move(a));
    SoughtQuantity b = part();
    for (const SoughtQuantity* one : {&a, &b}) {
      if (has_rate(*one)) continue;
      fail(fmt::format("expected angles, travels, places, lengths, energy or forces of elements in d(A)/d(B), found {}",
                       one->name));
    }
    SoughtQuantity out{.name = fmt::format("d({})/d({})", a.name, b.name),
                       .kind = Kind::ratio,
                       .dimension = a.dimension * b.dimension.power(-1)};
    out.of = {std::move(a), std::move(b)};
    return out;
  }

  SoughtQuantity by_time(SoughtQuantity a) {
    rest_.remove_prefix(2);
    const std::string name = fmt::format("d({})/dt", a.name);
    if (catalogue_.asked_of() == AskedOf::rest) {
      fail("nothing changes with time at rest; expected d(A)/d(B), or poise motion --show");
    }
    SoughtQuantity out{.name = name, .kind = Kind::by_time, .dimension = a.dimension * dimension::time.power(-1)};
    out.of = {std::move(a)};
    return out;
  }
  // What is read by recursion is bounded.
  static constexpr std::size_t longest = 2000;
  static constexpr int deepest = 50;

  const Catalogue& catalogue_;
  const std::string& text_;
  std::string_view rest_;
  int depth_ = 0;
};

void Catalogue::add_outputs() {
  if (asked_of_ == AskedOf::rest) {
    // One that belongs to a motion is undefined at rest.
    for (SoughtQuantity& one : outputs_of(scene_, AskedOf::motion)) add(std::move(one));
    return;
  }
  for (const SceneOutput& output : scene_.outputs) {
    const std::string where =
        (output.line > 0 ? fmt::format("{}:{}", scene_.file, output.line) : scene_.file) + ": outputs." + output.name;
    if (const auto taken = by_name_.find(output.name); taken != by_name_.end()) {
      throw InputError(fmt::format("{}: expected a name that is not a quantity yet; \"{}\" is {}", where, output.name,
                                   all_[taken->second].name));
    }
    try {
      SoughtQuantity one = Reader(*this, output.text).read();
      one.name = output.name;
      one.is_output = true;
      add(std::move(one));
    } catch (const InputError& error) {
      throw InputError(where + ": " + error.what());
    }
  }
}

}  // namespace

bool SoughtQuantity::has(Kind wanted) const {
  return kind == wanted ||
         std::any_of(of.begin(), of.end(), [&](const SoughtQuantity& one) { return one.has(wanted); });
}

bool SoughtQuantity::is_over_path() const {
  return has(Kind::maximum) || has(Kind::minimum) || has(Kind::mean) || has(Kind::span) || has(Kind::work);
}

bool is_same(const Measure& a, const Measure& b) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case Measure::Kind::angle:
      return a.body_a == b.body_a && a.body_b == b.body_b;
    case Measure::Kind::travel:
      return a.joint == b.joint;
    case Measure::Kind::x:
    case Measure::Kind::y:
      return a.b == b.b;
    case Measure::Kind::distance:
    case Measure::Kind::component:
      return a.a == b.a && a.b == b.b;
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
      return a.outline == b.outline && a.b == b.b;
    case Measure::Kind::slip_on_cam:
      return a.stop == b.stop;
    case Measure::Kind::rope:
      return std::equal(a.contacts.begin(), a.contacts.end(), b.contacts.begin(), b.contacts.end(),
                        [](const RopeContact& one, const RopeContact& other) { return one.at == other.at; });
    case Measure::Kind::sum:
      break;
  }
  return std::equal(
      a.terms.begin(), a.terms.end(), b.terms.begin(), b.terms.end(),
      [](const Measure::Term& one, const Measure::Term& other) { return is_same(one.measure, other.measure); });
}

Scene naming_drives(Scene scene, const std::vector<Drive>& drives) {
  std::erase_if(scene.drives, [&](const Drive& own) {
    return std::any_of(drives.begin(), drives.end(), [&](const Drive& drive) { return drive.name == own.name; });
  });
  scene.drives.insert(scene.drives.begin(), drives.begin(), drives.end());
  return scene;
}

SoughtQuantity find_quantity(const Scene& scene, const std::string& name, AskedOf asked_of) {
  const Catalogue catalogue(scene, asked_of);
  return Reader(catalogue, name).read();
}

std::vector<SoughtQuantity> outputs_of(const Scene& scene, AskedOf asked_of) {
  if (scene.outputs.empty()) return {};
  const Catalogue catalogue(scene, asked_of);
  return {catalogue.all().end() - static_cast<std::ptrdiff_t>(scene.outputs.size()), catalogue.all().end()};
}

std::vector<SoughtQuantity> all_quantities(const Scene& scene, AskedOf asked_of) {
  return Catalogue(scene, asked_of).all();
}

std::vector<std::string> quantity_names(const Scene& scene, AskedOf asked_of) {
  std::vector<std::string> out;
  for (const SoughtQuantity& one : all_quantities(scene, asked_of)) out.push_back(one.name);
  return out;
}

}  // namespace poise
