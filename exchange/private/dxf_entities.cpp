#include "exchange/private/dxf_entities.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

struct Group {
  int code = 0;
  std::string_view value;
  int line = 0;  // of the value
};

/// What begins with a group 0, and the groups behind that.
struct Entity {
  std::string_view kind;
  int line = 0;
  std::vector<Group> groups{};
};

constexpr std::array<std::string_view, 12> label_kinds = {"TEXT",     "MTEXT",  "DIMENSION", "HATCH",
                                                          "LEADER",   "ATTDEF", "TOLERANCE", "MULTILEADER",
                                                          "VIEWPORT", "SOLID",  "IMAGE",     "WIPEOUT"};

class DxfReader {
 public:
  DxfReader(std::string_view text, const std::string& file) : rest_(text), file_(file) {}

  DxfDrawing drawing() {
    bool has_entities = false, has_end = false;
    while (const std::optional<Group> group = next()) {
      if (group->code == 999) continue;  // a comment
      if (group->code != 0) fail(*group, "expected SECTION or EOF");
      if (group->value == "EOF") {
        has_end = true;
        break;
      }
      if (group->value != "SECTION") fail(*group, "expected SECTION or EOF");
      const std::optional<Group> name = next();
      if (!name || name->code != 2) fail(*group, "expected the name of a section, group 2");
      if (name->value == "HEADER") {
        read_header();
      } else if (name->value == "ENTITIES") {
        has_entities = true;
        read_entities();
      } else {
        skip_section();
      }
    }
    if (!has_end) fail_at(file_, line_, "EOF", "expected the end of the drawing, EOF; the file is cut short");
    if (!has_entities) fail_at(file_, line_, "ENTITIES", "expected a section ENTITIES, found none");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const Group& group, const std::string& message) const {
    fail_at(file_, group.line, fmt::format("group {}", group.code),
            fmt::format("{}, found \"{}\"", message, one_line(group.value)));
  }
  [[noreturn]] void fail(const Entity& entity, const std::string& message) const {
    fail_at(file_, entity.line, one_line(entity.kind), message);
  }

  std::optional<std::string_view> next_line() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find('\n');
    const std::string_view line = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_;
    return line;
  }

  std::optional<Group> next() {
    if (pushed_back_) return std::exchange(pushed_back_, std::nullopt);
    const std::optional<std::string_view> code = next_line();
    if (!code || (code->empty() && trimmed(rest_).empty())) return std::nullopt;
    int number = 0;
    const auto [stopped, error] = std::from_chars(code->data(), code->data() + code->size(), number);
    if (error != std::errc() || stopped != code->data() + code->size()) {
      fail_at(file_, line_, "group",
              fmt::format("expected a group code of DXF, found \"{}\"; binary DXF is not taken",
                          one_line(code->substr(0, 60))));
    }
    const std::optional<std::string_view> value = next_line();
    if (!value) fail_at(file_, line_, fmt::format("group {}", number), "expected its value, found the end of the file");
    return Group{number, *value, line_};
  }

  /// The next group unless the section ends.
  std::optional<Group> next_in_section() {
    const std::optional<Group> group = next();
    if (!group) fail_at(file_, line_, "ENDSEC", "expected the end of the section; the file is cut short");
    if (group->code == 0 && group->value == "ENDSEC") return std::nullopt;
    return group;
  }

  void skip_section() {
    while (next_in_section()) {
    }
  }

  void read_header() {
    bool is_units = false;
    while (const std::optional<Group> group = next_in_section()) {
      if (group->code == 9) {
        is_units = group->value == "$INSUNITS";
      } else if (is_units && group->code == 70) {
        const double units = number_at(group->value, file_, group->line, "$INSUNITS");
        if (!(units >= 0 && units <= 100 && units == std::floor(units))) fail(*group, "expected a whole number");
        if (units > 0) out_.units = static_cast<int>(units);
      }
    }
  }

  /// The next entity of the section, or none at its end.
  std::optional<Entity> next_entity() {
    const std::optional<Group> first = next_in_section();
    if (!first) return std::nullopt;
    if (first->code != 0) fail(*first, "expected an entity, group 0");
    Entity out{first->value, first->line};
    while (const std::optional<Group> group = next()) {
      if (group->code == 0) {
        pushed_back_ = group;
        return out;
      }
      out.groups.push_back(*group);
    }
    fail(out, "expected the end of the section; the file is cut short");
  }

  void read_entities() {
    while (const std::optional<Entity> entity = next_entity()) {
      if (integer(*entity, 67) == 1) {
        ++out_.on_paper;
        continue;
      }
      if (std::find(label_kinds.begin(), label_kinds.end(), entity->kind) != label_kinds.end()) {
        ++out_.labels;
        continue;
      }
      read_entity(*entity);
    }
  }

  void read_entity(const Entity& entity) {
    const bool is_known = entity.kind == "LINE" || entity.kind == "CIRCLE" || entity.kind == "POINT" ||
                          entity.kind == "ARC" || entity.kind == "LWPOLYLINE" || entity.kind == "POLYLINE";
    if (!is_known) {
      const char* const remedy =
          entity.kind == "INSERT" ? "blocks are not taken; take them apart (explode) first" : "it is not taken";
      fail(entity, fmt::format("expected LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE or POINT: {}", remedy));
    }
    expect_plane(entity);
    if (entity.kind == "LINE") {
      add(entity, point(entity, 10));
      add(entity, point(entity, 11));
    } else if (entity.kind == "ARC") {
      const Vec2 centre = point(entity, 10);
      const double radius = positive(entity, 40);
      for (const int code : {50, 51}) {
        const double angle = required(entity, code) * std::numbers::pi / 180;
        add(entity, centre + radius * Vec2{std::cos(angle), std::sin(angle)});
      }
    } else if (entity.kind == "LWPOLYLINE") {
      add_vertices(entity);
    } else if (entity.kind == "POLYLINE") {
      read_polyline(entity);
    } else {
      if (entity.kind == "CIRCLE") positive(entity, 40);
      add(entity, point(entity, 10));
    }
  }

  void add_vertices(const Entity& entity) {
    double x = 0.0;
    bool has_x = false;
    std::size_t vertices = 0;
    for (const Group& group : entity.groups) {
      if (group.code == 10) {
        x = number_at(group.value, file_, group.line, "x of a vertex");
        has_x = true;
      }
      if (group.code != 20 || !has_x) continue;
      add(entity, {x, number_at(group.value, file_, group.line, "y of a vertex")});
      has_x = false;
      ++vertices;
    }
    if (vertices < 2) fail(entity, fmt::format("expected two vertices or more, found {}", vertices));
  }

  /// Of an older file: its vertices are entities behind it.
  void read_polyline(const Entity& polyline) {
    constexpr int in_space = 8 + 16 + 64;  // a curve in space, a mesh, faces
    if ((integer(polyline, 70) & in_space) != 0) fail(polyline, "expected a polyline in the plane");
    std::size_t vertices = 0;
    while (const std::optional<Entity> entity = next_entity()) {
      if (entity->kind == "SEQEND") {
        if (vertices < 2) fail(polyline, fmt::format("expected two vertices or more, found {}", vertices));
        return;
      }
      if (entity->kind != "VERTEX") fail(*entity, "expected VERTEX or SEQEND");
      expect_plane(*entity);
      add(polyline, point(*entity, 10));
      ++vertices;
    }
    fail(polyline, "expected SEQEND behind its vertices");
  }

  const Group* find(const Entity& entity, int code) const {
    const auto found =
        std::find_if(entity.groups.begin(), entity.groups.end(), [&](const Group& one) { return one.code == code; });
    return found == entity.groups.end() ? nullptr : &*found;
  }
  std::optional<double> number(const Entity& entity, int code) const {
    const Group* const group = find(entity, code);
    if (group == nullptr) return std::nullopt;
    return number_at(group->value, file_, group->line, fmt::format("{}, group {}", one_line(entity.kind), code));
  }
  int integer(const Entity& entity, int code) const {
    const double value = number(entity, code).value_or(0.0);
    if (value != std::floor(value) || std::abs(value) > 1e6) {
      fail(entity, fmt::format("expected a whole number in group {}", code));
    }
    return static_cast<int>(value);
  }
  double required(const Entity& entity, int code) const {
    const std::optional<double> value = number(entity, code);
    if (!value) fail(entity, fmt::format("expected group {}, found none", code));
    return *value;
  }
  double positive(const Entity& entity, int code) const {
    const double value = required(entity, code);
    if (!(value > 0.0)) fail(entity, fmt::format("expected a radius > 0 in group {}, found {}", code, value));
    return value;
  }
  Vec2 point(const Entity& entity, int code) const { return {required(entity, code), required(entity, code + 10)}; }

  void expect_plane(const Entity& entity) const {
    constexpr double rounding = 1e-9;
    for (const int code : {30, 31, 38}) {
      const double z = number(entity, code).value_or(0.0);
      if (std::abs(z) > rounding) fail(entity, fmt::format("expected a drawing in the plane z = 0, found z = {}", z));
    }
    const double x = number(entity, 210).value_or(0.0), y = number(entity, 220).value_or(0.0);
    const double z = number(entity, 230).value_or(1.0);
    if (std::abs(x) > rounding || std::abs(y) > rounding || std::abs(z - 1) > rounding) {
      fail(entity, "expected a drawing seen along z, found another direction of extrusion (group 210)");
    }
  }

  void add(const Entity& entity, Vec2 at) {
    if (out_.points.size() >= most_items) fail(entity, fmt::format("expected at most {} points", most_items));
    const Group* const layer = find(entity, 8);
    out_.points.push_back({std::string(layer == nullptr ? "0" : layer->value), at, entity.line});
  }

  std::string_view rest_;
  const std::string& file_;
  int line_ = 0;
  std::optional<Group> pushed_back_;
  DxfDrawing out_;
};

}  // namespace

DxfDrawing read_dxf(std::string_view text, const std::string& file) { return DxfReader(text, file).drawing(); }

}  // namespace poise
