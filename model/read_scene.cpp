#include "model/read_scene.hpp"

#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/flexible_link.hpp"
#include "model/nearest_name.hpp"
#include "model/parts.hpp"
#include "model/read_couplings.hpp"
#include "model/read_elements.hpp"
#include "model/read_section.hpp"
#include "model/read_time_function.hpp"
#include "model/scene.hpp"
#include "model/scene_expressions.hpp"
#include "model/scene_names.hpp"
#include "model/scene_text.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise {
namespace {

struct Unit {
  std::string_view name;
  double si;
};

constexpr Unit length_units[] = {{"m", 1.0}, {"mm", 1e-3}, {"in", 0.0254}, {"ft", 0.3048}};
constexpr Unit force_units[] = {{"N", 1.0}, {"kN", 1e3}, {"lbf", 4.4482216152605}};
constexpr Unit mass_units[] = {{"kg", 1.0}, {"g", 1e-3}, {"lb", 0.45359237}};
constexpr Unit angle_units[] = {{"rad", 1.0}, {"deg", std::numbers::pi / 180.0}};

template <class List>
void read_unit(const TomlTable& table, std::string_view key, const List& list, std::string& name, double& si) {
  const std::optional<TomlText> text = table.find_text(key);
  if (!text) return;
  std::vector<std::string> names;
  for (const Unit& unit : list) names.emplace_back(unit.name);
  const Unit& unit = std::begin(list)[choose(*text, names)];
  name = unit.name;
  si = unit.si;
}

/// Reads the parts of a scene in the order in which they refer to each other.
class SceneReader {
 public:
  SceneReader(toml::table document, const TomlPlace& place, const ReadingOptions& options)
      : options_(options),
        parts_(std::move(document), place),
        expressions_(parts_),
        root_(parts_.document(), place, &expressions_, &parts_.files()),
        names_(scene_, options.uses) {
    scene_.file = place.file;
  }

  Scene read() {
    if (root_.has("scene") && !root_.has("body")) {
      root_.place_of("scene").fail(
          "expected a scene, found a file that names one: an experiment or a design; give it to poise identify or "
          "design, or give the scene that it names");
    }
    std::vector<std::string_view> keys{"title", "source", "gravity", "units", "numbers", "part", "ground", "body"};
    for (const JointTraits& kind : Joint::kinds) keys.push_back(kind.key);
    for (const std::string_view key : element_tables()) keys.push_back(key);
    for (const CouplingKind& kind : coupling_kinds()) {
      if (kind.row == 0) keys.push_back(kind.table);
    }
    keys.insert(keys.end(),
                {"drive", "force", "distributed_load", "torque", "stop", "blade", "start", "outputs", "frame"});
    root_.allow_keys(keys);
    if (const auto units = root_.find_table("units")) scene_.units = read_units(*units);
    parts_.units() = scene_.units;
    expressions_.read_named(root_, scene_);
    parts_.find_scales([&](const std::string& text) { return expressions_.scale(text); });
    read_header();
    read_bodies();
    read_joints();
    const std::vector<int> riders = add_riders(root_, names_, scene_);
    for (const int rider : riders) names_.learn_joint(rider);
    const std::vector<int> lines = add_lines_of_centres(root_, names_, riders, scene_);
    for (const int line : lines) {
      if (line >= 0) names_.learn_body(line);
    }
    read_elements(root_, names_, scene_);
    read_frame(root_, scene_);
    read_couplings(root_, names_, riders, lines, scene_);
    expect_one_impact_law();
    add_chains();
    read_start();
    read_outputs();
    expressions_.find_dependents(scene_);
    set_values_from_start(root_, scene_);
    return std::move(scene_);
  }

 private:
  /// An impact may be at several stops at once.
  void expect_one_impact_law() const {
    const Stop* first = nullptr;
    for (const Stop& stop : scene_.stops) {
      if (!stop.impact_law) continue;
      if (first == nullptr) first = &stop;
      if (*stop.impact_law == *first->impact_law) continue;
      throw InputError(
          fmt::format("{}:{}: {} \"{}\".law: expected the law of {} \"{}\" (line {}), because both may be hit "
                      "at once; give all stops the same",
                      scene_.file, stop.line, stop.family(), stop.name, first->family(), first->name, first->line));
    }
  }

  void read_header() {
    if (const auto title = root_.find_text("title")) scene_.title = title->value;
    if (const auto source = root_.find_text("source")) scene_.source = source->value;
    scene_.gravity = root_.find_vector("gravity", root_.unit(dimension::length)).value_or(Vec2{});
  }

  void read_bodies() {
    if (const auto ground = root_.find_table("ground")) {
      ground->allow_keys({"points"});
      scene_.bodies[0].line = ground->place().line_in_document();
      read_points(*ground, 0);
    }
    names_.learn_body(0);
    const std::optional<TomlTable> bodies = root_.find_table("body");
    if (!bodies || bodies->keys().empty()) {
      if (options_.may_lack_bodies) return;
      root_.place().fail("body: expected at least one body; add [body.NAME]");
    }
    for (const std::string& name : bodies->keys()) {
      check_name(name, bodies->place_of(name));
      if (name == scene_.bodies[0].name) {
        bodies->place_of(name).fail("expected another name, this is the fixed frame; give its points in [ground]");
      }
      const TomlTable body = *bodies->find_table(name);
      const int index = read_body(body, name);
      const auto section = body.find_table("section");
      if (section && section->flag("flexible", false))
        make_chain(*bodies, body, *section, index);
      else
        names_.learn_body(index);
    }
  }

  int read_body(const TomlTable& table, const std::string& name) {
    table.allow_keys({"points", "mass", "center", "inertia", "section"});
    const int index = scene_.add_body(name);
    Body& body = scene_.bodies[index];
    body.line = table.place().line_in_document();
    read_numbers(table, std::span(Body::numbers).first<2>(), &body, nullptr);
    body.center = table.find_vector("center", table.unit(dimension::length)).value_or(Vec2{});
    read_points(table, index);
    if (const auto section = table.find_table("section")) body.section = read_section(*section, body);
    return index;
  }

  /// Puts a flexible link in the place of a body. Its name stands for the first body of the chain.
  void make_chain(const TomlTable& bodies, const TomlTable& table, const TomlTable& section, int index) {
    constexpr long long most = 10'000;
    const long long elements = section.whole_number("elements", 1, 8);
    if (elements > most) section.place_of("elements").fail("expected at most " + std::to_string(most) + " elements");
    const Body& body = scene_.bodies[index];
    const std::string name = body.name;
    if (table.has("inertia")) {
      table.place_of("inertia").fail("expected none: it follows from the mass, which is spread along the line");
    }
    if (table.has("center") && !is_middle_of_line(body)) {
      table.place_of("center").fail("expected none, or the middle of the line along which the mass is spread");
    }
    std::vector<std::string> points;
    for (std::size_t p = 0; p < body.points.size(); ++p) {
      points.push_back(body.points[p].name);
      if (std::count(body.section->line.begin(), body.section->line.end(), static_cast<int>(p)) == 1) continue;
      section.place().fail("expected every point of a flexible link on its line; add \"" + points.back() +
                           "\" to line, or make it a point of a body that is welded to the link");
    }
    FlexibleChain chain = make_flexible(scene_, index, static_cast<int>(elements));
    for (const int one : chain.link.bodies) {
      const std::string& taken = scene_.bodies[one].name;
      if (bodies.has(taken)) fail_taken(bodies.place_of(taken), taken, table.place().line_in_document());
      names_.learn_body(one);
    }
    names_.learn_chain(name, index);
    for (std::size_t p = 0; p < points.size(); ++p) names_.learn_point(name + "." + points[p], chain.points[p]);
    scene_.flexible_links.push_back(chain.link);
    chains_.push_back(std::move(chain));
  }

  static bool is_middle_of_line(const Body& body) {
    constexpr double rounding = 1e-9;
    const std::vector<int>& line = body.section->line;
    Vec2 moment{};
    double length = 0.0;
    for (std::size_t j = 0; j + 1 < line.size(); ++j) {
      const Vec2 a = body.points[line[j]].at, b = body.points[line[j + 1]].at;
      moment += (0.5 * norm(b - a)) * (a + b);
      length += norm(b - a);
    }
    return norm((1 / length) * moment - body.center) <= rounding * length;
  }

  /// Joints and springs of flexible links, behind those of the file.
  void add_chains() {
    const auto expect_free = [&](const auto& items, const auto& item, const std::string& kind) {
      for (const auto& other : items) {
        if (other.name == item.name) fail_taken({scene_.file, other.line, kind}, other.name, item.line);
      }
    };
    for (FlexibleChain& chain : chains_) {
      for (Joint& joint : chain.joints) {
        joint.name = scene_.name_of(joint.a) + "-" + scene_.name_of(joint.b);
        expect_free(scene_.joints, joint, "joint");
      }
      for (const Element& spring : chain.springs) expect_free(scene_.elements, spring, "force element");
    }
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      for (Joint& joint : chains_[k].joints) names_.learn_joint(scene_.add_joint(std::move(joint)));
      for (Element& spring : chains_[k].springs) {
        scene_.flexible_links[k].springs.push_back(static_cast<int>(scene_.elements.size()));
        scene_.elements.push_back(std::move(spring));
      }
    }
  }

  void read_points(const TomlTable& owner, int body) {
    const std::optional<TomlTable> points = owner.find_table("points");
    if (!points) return;
    for (const std::string& name : points->keys()) {
      check_name(name, points->place_of(name));
      // "BODY.POINT" is split at its last dot.
      if (name.find('.') != std::string::npos) points->place_of(name).fail("expected a name without dots");
      // Where a part is placed is a point of a body that another file may have.
      const TomlPart* const part = points->place_of(name).part;
      const double unit = part != nullptr ? part->unit(dimension::length) : root_.unit(dimension::length);
      scene_.add_point(body, name, points->vector(name, unit));
    }
  }

  void read_joints() {
    std::vector<std::pair<TomlTable, Joint::Kind>> tables;
    for (std::size_t kind = 0; kind < Joint::kinds.size(); ++kind) {
      for (TomlTable& table : root_.tables(Joint::kinds[kind].key)) {
        tables.emplace_back(std::move(table), static_cast<Joint::Kind>(kind));
      }
    }
    // Joints of all kinds stay in the order of the file.
    std::stable_sort(tables.begin(), tables.end(),
                     [](const auto& a, const auto& b) { return a.first.position() < b.first.position(); });
    std::vector<Joint> joints;
    std::vector<TomlTable> items;
    std::vector<std::string> defaults;
    for (const auto& [table, kind] : tables) {
      joints.push_back(read_joint(table, kind));
      items.push_back(table);
      defaults.push_back(scene_.name_of(joints.back().a) + "-" + scene_.name_of(joints.back().b));
    }
    // [start] refers to bodies and joints by name, so no joint may have the name of a body.
    NameLines taken;
    for (const Body& body : scene_.bodies) taken.emplace(body.name, body.line);
    const std::vector<std::string> names = names_of(items, defaults, std::move(taken));
    for (std::size_t i = 0; i < joints.size(); ++i) {
      joints[i].name = names[i];
      names_.learn_joint(scene_.add_joint(std::move(joints[i])));
    }
  }

  Joint read_joint(const TomlTable& table, Joint::Kind kind) const {
    Joint joint;
    joint.kind = kind;
    joint.line = table.place().line_in_document();
    std::vector<std::string_view> keys{"name", "points"};
    if (joint.has_travel()) keys.emplace_back("axis");
    for (const Number& number : joint.numbers()) keys.push_back(number.key);
    if (joint.can_rub()) keys.emplace_back("friction");
    if (table.has("clearance")) {
      table.place_of("clearance")
          .fail(
              "expected a joint without clearance, which takes freedom from its bodies; make it a [[loose_pin]] or a "
              "[[loose_slot]]");
    }
    table.allow_keys(keys);
    read_numbers(table, joint.numbers(), &joint, nullptr);
    if (joint.can_rub()) read_friction(table, joint);
    std::tie(joint.a, joint.b) = names_.two_points(table);
    if (joint.has_travel()) {
      joint.axis = table.vector("axis", 1.0);
      if (joint.axis == Vec2{})
        table.place_of("axis").fail("expected a direction, found [0, 0]; give for example [1, 0]");
    }
    return joint;
  }

  void read_friction(const TomlTable& joint_table, Joint& joint) const {
    const std::optional<TomlTable> table = joint_table.find_table("friction");
    if (!table) return;
    joint.friction.emplace();
    std::vector<Number> numbers(joint.friction_numbers().begin(), joint.friction_numbers().end());
    std::vector<std::string_view> keys;
    for (Number& number : numbers) {
      number.key.remove_prefix(std::string_view("friction.").size());
      keys.push_back(number.key);
    }
    table->allow_keys(keys);
    read_numbers(*table, numbers, &joint, nullptr);
    if (joint.has_travel() || joint.friction->coefficient == 0.0 || table->has("radius")) return;
    table->place().fail("expected the key radius beside coefficient, of the surface on which the pin turns; add it");
  }

  void read_start() {
    const std::optional<TomlTable> table = root_.find_table("start");
    if (!table) return;
    for (const std::string& name : table->keys()) {
      const int body = names_.index_of_body(name);
      const int joint = names_.index_of_joint(name);
      const bool turns = body > 0;
      const bool travels = joint >= 0 && scene_.joints[joint].has_travel();
      const bool is_table = table->holds_table(name);
      if (name == "position" && (is_table || !(turns || travels))) {
        read_positions(*table->find_table(name));
      } else if (is_table) {
        table->place_of(name).fail("expected a number; put a name that holds dots in quotes");
      } else if (turns) {
        const double angle = table->number(name, table->unit(dimension::angle), Range::finite);
        scene_.start.angle[body] = angle;
        for (const FlexibleLink& link : scene_.flexible_links) {
          if (link.name != name) continue;
          for (const int one : link.bodies) scene_.start.angle[one] = angle;
        }
      } else if (travels) {
        scene_.start.travel[joint] = table->number(name, table->unit(dimension::length), Range::finite);
      } else {
        std::vector<std::string> valid = names_.movable_body_names();
        for (std::string& other : names_.travelling_joint_names()) valid.push_back(std::move(other));
        valid.emplace_back("position");
        table->place_of(name).fail("expected the name of a body, slide or pin_in_slot, or a table \"position\"" +
                                   did_you_mean_or_list(name, valid));
      }
    }
  }

  // What they are is found where they are used: statics knows the quantities.
  void read_outputs() {
    const std::optional<TomlTable> table = root_.find_table("outputs");
    if (!table) return;
    constexpr std::size_t most = 100;
    if (table->keys().size() > most) {
      table->place().fail("expected at most 100 outputs, found " + std::to_string(table->keys().size()));
    }
    for (const std::string& name : table->keys()) {
      const TomlPlace place = table->place_of(name);
      if (!Expression::is_name(name)) {
        place.fail(
            "expected a name of letters, digits and underscores that does not begin with a digit and is neither pi nor "
            "a function");
      }
      scene_.outputs.push_back({name, table->text(name).value, place.line});
    }
  }

  void read_positions(const TomlTable& table) {
    for (const std::string& name : table.keys()) {
      const int body = names_.movable_body({name, table.place_of(name)});
      scene_.start.position[body] = table.vector(name, table.unit(dimension::length));
    }
  }

  const ReadingOptions options_;
  PartedDocument parts_;
  SceneExpressions expressions_;
  TomlTable root_;
  Scene scene_;
  SceneNames names_;
  std::vector<FlexibleChain> chains_;
};

}  // namespace

Units read_units(const TomlTable& table) {
  Units units;
  table.allow_keys({"length", "force", "mass", "angle"});
  read_unit(table, "length", length_units, units.length_name, units.length);
  read_unit(table, "force", force_units, units.force_name, units.force);
  read_unit(table, "mass", mass_units, units.mass_name, units.mass);
  read_unit(table, "angle", angle_units, units.angle_name, units.angle);
  return units;
}

Scene read_document(toml::table document, const TomlPlace& place, const ReadingOptions& options) {
  return SceneReader(std::move(document), place, options).read();
}

toml::table table_of(const UnitNames& names) {
  return toml::table{{"length", names.length}, {"force", names.force}, {"mass", names.mass}, {"angle", names.angle}};
}

Units units_of(const UnitNames& names) {
  const toml::table table = table_of(names);
  return read_units(TomlTable(table, {"", 0, "units"}));
}

Scene parse_scene(std::string_view text, const std::string& name) {
  return read_document(parse_toml(text, name), {name, 1, ""});
}

Scene parse_sketch(std::string_view text, const std::string& name) {
  return read_document(parse_toml(text, name), {name, 1, ""}, {.may_lack_bodies = true});
}

Scene read_scene(const std::filesystem::path& file) { return parse_scene(read_text_file(file), file.string()); }

}  // namespace poise
