#include "statics/quantities/quantity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
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

/// Quantities of a scene by their names, and what else they may be called.
class Catalogue {
 public:
  explicit Catalogue(const Scene& scene) : scene_(scene) {
    add_measures();
    add_forces();
    add_pushes();
    add_energy();
    add_folds();
  }

  /// In their order.
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

  std::vector<std::string> known() const {
    std::vector<std::string> out;
    for (const SoughtQuantity& one : all_) out.push_back(one.name);
    for (const auto& [name, index] : by_name_) {
      if (name != all_[index].name) out.push_back(name);
    }
    return out;
  }

  /// Names that two elements have.
  const std::map<std::string, std::vector<std::string>>& shared() const { return shared_; }
  const Scene& scene() const { return scene_; }

 private:
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

  void add_forces() {
    const std::vector<ElementName> names = names_of_elements(scene_);
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      const Element& of = scene_.elements[e];
      if (!stores_energy(of.law)) continue;
      const auto& [own, whole] = names[e];
      add({.name = "force." + (own.empty() ? whole : own),
           .kind = Kind::element_force,
           .item = static_cast<int>(e),
           .dimension = of.on.effort_dimension()},
          {"force." + whole});
    }
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) add_reaction(static_cast<int>(j));
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      add({.name = "stop." + scene_.stops[s].name,
           .kind = Kind::stop_reaction,
           .item = static_cast<int>(s),
           .dimension = scene_.stops[s].on.effort_dimension()});
    }
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
    if (!follows) add({.name = "energy", .kind = Kind::energy, .dimension = dimension::torque});
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
  std::vector<SoughtQuantity> all_;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, std::vector<std::string>> shared_;
};

/// What a name begins with, and what follows.
struct Family {
  std::string_view prefix, item;
};
constexpr std::array<Family, 5> families{{{"force.", "a force element"},
                                          {"reaction.", "a joint"},
                                          {"stop.", "a stop"},
                                          {"fold.load.", "a load"},
                                          {"load_at_fold.", "a load"}}};

/// Reads a quantity, or an expression of several, from a text. A name may have spaces, hyphens and points in it, so
/// that the longest name of the scene is taken; where none is, the longest word is what the error is about.
class Reader {
 public:
  Reader(const Catalogue& catalogue, const std::string& text) : catalogue_(catalogue), text_(text), rest_(text) {}

  SoughtQuantity read() {
    SoughtQuantity out = sum();
    skip_spaces();
    if (!rest_.empty()) fail(fmt::format("expected + - * / or the end, found \"{}\"", rest_));
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
    const bool is_sum = operand.kind == Kind::sum || operand.kind == Kind::difference;
    const bool is_product = operand.kind == Kind::product || operand.kind == Kind::quotient;
    const bool binds = kind == Kind::product || kind == Kind::quotient;
    const bool needed = (is_sum && (binds || (is_second && kind == Kind::difference))) ||
                        (is_product && is_second && kind == Kind::quotient) ||
                        (is_second && operand.kind == Kind::number && operand.constant < 0.0);
    return needed ? "(" + operand.name + ")" : operand.name;
  }

  SoughtQuantity factor() {
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
    if (rest_.starts_with("d(")) return ratio();
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
    if (const std::string why = why_no_measure(scene, whole); !why.empty()) fail(why);
    for (const auto& [prefix, item] : families) {
      if (!whole.starts_with(prefix)) continue;
      std::vector<std::string> known;
      for (const std::string& one : catalogue_.known()) {
        if (one.starts_with(prefix)) known.push_back(one.substr(prefix.size()));
      }
      fail(fmt::format("expected the name of {}{}", item, did_you_mean_or_list(whole.substr(prefix.size()), known)));
    }
    throw InputError(fmt::format(
        "{}: expected the name of a quantity{}; or angle.BODY, angle.BODY.OTHER, travel.JOINT, x.BODY.POINT, "
        "y.BODY.POINT, along.BODY.POINT.DEGREES, length.ELEMENT, force.ELEMENT, reaction.JOINT, stop.NAME, "
        "push.BODY.POINT.x, energy, "
        "fold.load.LOAD, d(A)/d(B)",
        text_, did_you_mean_or_list(whole, catalogue_.known())));
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
      if (name != "force." + element.name && name != "force." + element.table + "." + element.name) continue;
      return fmt::format("a {} has no force at rest; expected a spring or constant force", element.family());
    }
    return "";
  }

  std::optional<SoughtQuantity> name() {
    std::size_t length = 0;
    std::optional<SoughtQuantity> found = catalogue_.longest(rest_, length);
    std::optional<SoughtQuantity> along = push(length);
    if (along) return along;
    if (!found) return std::nullopt;
    const bool ends = length == rest_.size() || separators.find(rest_[length]) != std::string_view::npos;
    if (!ends) return std::nullopt;
    rest_.remove_prefix(length);
    return found;
  }

  /// push.BODY.POINT. and an angle in degrees, where that is longer than the name found.
  std::optional<SoughtQuantity> push(std::size_t found) {
    for (const SoughtQuantity& one : catalogue_.all()) {
      if (one.kind != Kind::push || one.direction.x != 1.0) continue;
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

  SoughtQuantity ratio() {
    const auto part = [&]() -> SoughtQuantity {
      if (!take("d(")) fail("expected d(A)/d(B)");
      skip_spaces();
      std::size_t length = 0;
      const std::optional<SoughtQuantity> found = catalogue_.longest(rest_, length);
      const std::size_t end = rest_.find(')');
      if (!found) refuse(std::string(rest_.substr(0, end)));
      if (found->kind != Kind::measure) {
        fail(fmt::format("expected angles, travels, places or lengths in d(A)/d(B), found {}", found->name));
      }
      rest_.remove_prefix(length);
      if (!take(")")) fail("expected a closing parenthesis in d(A)/d(B)");
      return *found;
    };
    SoughtQuantity a = part();
    if (!take("/")) fail("expected d(A)/d(B)");
    SoughtQuantity b = part();
    SoughtQuantity out{.name = fmt::format("d({})/d({})", a.name, b.name),
                       .kind = Kind::ratio,
                       .dimension = a.dimension * b.dimension.power(-1)};
    out.of = {std::move(a), std::move(b)};
    return out;
  }

  const Catalogue& catalogue_;
  const std::string& text_;
  std::string_view rest_;
};

}  // namespace

bool SoughtQuantity::has(Kind wanted) const {
  return kind == wanted ||
         std::any_of(of.begin(), of.end(), [&](const SoughtQuantity& one) { return one.has(wanted); });
}

SoughtQuantity find_quantity(const Scene& scene, const std::string& name) {
  const Catalogue catalogue(scene);
  return Reader(catalogue, name).read();
}

std::vector<std::string> quantity_names(const Scene& scene) {
  std::vector<std::string> out;
  const Catalogue catalogue(scene);
  for (const SoughtQuantity& one : catalogue.all()) out.push_back(one.name);
  return out;
}

}  // namespace poise
