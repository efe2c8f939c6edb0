#include "model/read_couplings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "model/cam_geometry.hpp"
#include "model/couplings.hpp"
#include "model/curved_slots.hpp"
#include "model/measures/rope.hpp"
#include "model/mechanism.hpp"
#include "model/meshing.hpp"
#include "model/outline_parts.hpp"
#include "model/profile.hpp"
#include "model/read_elements.hpp"
#include "model/read_measure.hpp"
#include "model/rolling_profile.hpp"

namespace poise {
namespace {

constexpr double not_given = std::numeric_limits<double>::quiet_NaN();
constexpr double full_turn = 2 * M_PI;

using Keys = std::vector<std::string_view>;

class CouplingReader {
 public:
  CouplingReader(const SceneNames& names, Scene& scene) : names_(names), measures_(names), scene_(scene) {}

  /// The stops of a coupling, one per row. `rider`: of a curve; `line`: of centres of a circle.
  std::vector<Stop> read(const CouplingKind& kind, const TomlTable& table, int rider, int line) const {
    if (kind.table == "curved_slot") return read_track(table, rider);
    if (kind.table == "rolling_on_circle") return read_rolling_on_circle(kind, table, line);
    if (kind.table == "rolling") return read_rolling(kind, table);
    if (kind.table == "rolling_profile") return read_rolling_profile(kind, table, rider);
    if (kind.table == "rolling_profile_on_circle") return read_profile_on_circle(kind, table, rider, line);
    if (kind.table == "circular_slot" && line >= 0) return read_arc(kind, table, line);
    if (kind.table == "chain") return read_chain(kind, table, line);
    if (kind.table == "contact") return read_contact(kind, table);
    if (kind.table == "curve_contact") return read_curve_contact(kind, table, rider, line);
    if (kind.table == "loose_pin" || kind.table == "loose_slot") return {read_loose(kind, table)};
    return {read_row(kind, table)};
  }

 private:
  Stop read_row(const CouplingKind& kind, const TomlTable& table) const {
    Stop stop;
    stop.table = kind.table;
    stop.min = stop.max = not_given;
    if (kind.table == "gear" || kind.table == "belt")
      read_wheels(table, stop);
    else if (kind.table == "rack")
      read_rack(table, stop);
    else if (kind.table == "geneva")
      read_geneva(table, stop);
    else if (kind.table == "cam")
      read_cam(table, stop);
    else if (kind.table == "rope")
      read_rope(table, stop);
    else if (kind.table == "circular_slot")
      read_circle(table, stop);
    else
      read_sum(table, stop);
    read_numbers(table, stop.numbers(), &stop, &stop.on);
    check_meshing(table, stop);
    if (stop.table == "rope") stop.min = -std::numeric_limits<double>::infinity();
    if (stop.table == "cam" && !table.flag("guided", false)) stop.max = std::numeric_limits<double>::infinity();
    if (stop.table == "cam" || stop.table == "rope") {
      read_numbers(table, std::span(Stop::limits).subspan(2, stop.table == "cam" ? 2 : 1), &stop, &stop.on);
      check_rubbing(table, stop);
      read_impact(table, stop);
    }
    return stop;
  }

 public:
  Element read_stretching_rope(const TomlTable& table) const {
    table.allow_keys({"name", "over", "stiffness", "free_length"});
    Element rope;
    rope.table = "rope";
    rope.on = Measure::rope_over(measures_.contacts(table, "over"));
    LinearSpring law;
    read_numbers(table, LinearSpring::numbers, &law, &rope.on);
    law.acts = LinearSpring::Acts::tension;
    rope.law = law;
    return rope;
  }

 private:
  struct WheelsOnCarrier {
    int a, b, carrier;
  };
  WheelsOnCarrier wheels_on_carrier(const TomlTable& table) const {
    const auto [a, b] = names_.two_bodies(table);
    const int carrier = carrier_of(table);
    for (const int wheel : {a, b}) {
      if (wheel == carrier) {
        table.place_of("carrier").fail("expected a body that carries both wheels, found one of them");
      }
    }
    return {a, b, carrier};
  }

  // angle(carrier -> wheel) + 2 pi / slots P(angle(carrier -> crank)).
  void read_geneva(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "bodies", "carrier", "slots", "phase", "offset"});
    const auto [crank, wheel, carrier] = wheels_on_carrier(table);
    if (!table.has("slots"))
      table.place().fail("expected the key slots, the number of slots of the wheel; add slots = 4");
    constexpr long long least_slots = 3, most_slots = 360;
    const long long slots = table.whole_number("slots", least_slots, least_slots);
    if (slots > most_slots) {
      table.place_of("slots").fail(
          fmt::format("expected a whole number from {} to {}, found {}", least_slots, most_slots, slots));
    }
    const int count = static_cast<int>(slots);
    stop.on = Measure::sum_of({{1.0, Measure::angle_between(carrier, wheel)},
                               {full_turn / count, Measure::angle_between(carrier, crank),
                                std::make_shared<const Profile>(Profile::geneva(count)), 0.0, full_turn}});
  }

  // angle(carrier -> b) -+ ratio angle(carrier -> a).
  void read_wheels(const TomlTable& table, Stop& stop) const {
    const bool is_gear = stop.table == "gear";
    const std::string_view other_way = is_gear ? "internal" : "crossed";
    std::vector<std::string_view> keys{"name", "bodies", "carrier", "ratio", other_way, "phase"};
    if (is_gear) keys.insert(keys.end(), {"pressure_angle", "backlash"});
    table.allow_keys(keys);
    const auto [a, b, carrier] = wheels_on_carrier(table);
    // Wheels that mesh outside and crossed belts turn in opposite ways.
    const bool opposite = is_gear != table.flag(other_way, false);
    stop.sense = opposite ? 1.0 : -1.0;
    stop.on =
        Measure::sum_of({{1.0, Measure::angle_between(carrier, b)}, {stop.sense, Measure::angle_between(carrier, a)}});
  }

  // travel - radius angle(carrier -> pinion).
  void read_rack(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "slide", "pinion", "carrier", "radius", "offset", "pressure_angle", "backlash"});
    const int rack = names_.travelling_joint(table.text("slide"));
    const TomlText pinion = table.text("pinion");
    const int body = names_.movable_body(pinion);
    const int carrier = table.has("carrier") ? carrier_of(table) : scene_.joints[static_cast<std::size_t>(rack)].a.body;
    if (body == carrier) pinion.place.fail("expected a pinion that turns on its carrier, found the carrier itself");
    stop.sense = -1.0;
    stop.on = Measure::sum_of({{1.0, Measure::travel_of(rack)}, {stop.sense, Measure::angle_between(carrier, body)}});
  }

  // A force of teeth acts on bearings where they mesh.
  void check_meshing(const TomlTable& table, const Stop& stop) const {
    if (stop.pressure_tangent && table.has("backlash")) {
      table.place_of("backlash").fail("expected teeth without pressure_angle beside it; leave one of the two keys out");
    }
    if (!stop.pressure_tangent || meshing(scene_, stop)) return;
    table.place_of("pressure_angle")
        .fail(stop.table == "gear"
                  ? "expected wheels that turn about pins on their carrier, with axes apart and, where one is inside "
                    "the other, of other sizes: there their teeth mesh; pin them to it, or leave the key out"
                  : "expected a pinion that turns about a pin on its carrier, and a [[slide]] that joins the carrier "
                    "with the rack: there its teeth mesh; give these, or leave the key out");
  }

  void read_sum(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "sum", "value"});
    if (!table.has("sum"))
      table.place().fail("expected the key sum; add sum = [{ factor = NUMBER, bodies = [...] }, ...]");
    std::vector<Measure::Term> terms = measures_.terms(table);
    const Measure sum = Measure::sum_of(terms);
    // A factor of an angle in a sum of lengths is a length per radian.
    for (Measure::Term& term : terms) {
      term.factor *= table.unit(sum.dimension()) / table.unit(term.measure.dimension());
    }
    stop.on = Measure::sum_of(std::move(terms));
  }

  void read_rope(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "over", "length", "restitution", "law"});
    stop.on = Measure::rope_over(measures_.contacts(table, "over", true));
    if (rubbing_rims(stop.on).size() > most_rubbing_rims) {
      table.place_of("over").fail(fmt::format("expected at most {} pulleys with friction", most_rubbing_rims));
    }
  }

  // A point of the pin's body and one of another, under these keys.
  std::pair<PointRef, PointRef> points_of(const TomlTable& table, std::string_view key, std::string_view other) const {
    const TomlText name = table.text(key);
    const std::pair<PointRef, PointRef> points{names_.point(name), names_.point(table.text(other))};
    if (points.first.body == points.second.body) {
      name.place.fail("expected a point of another body than that of the key " + std::string(other));
    }
    return points;
  }

  void read_circle(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "pin", "center", "radius"});
    const auto [pin, center] = points_of(table, "pin", "center");
    stop.on = Measure::distance_between(center, pin);
  }

  // In the frame of the line of centres, which turns with the pin: along it, across it, and its angle.
  std::vector<Stop> read_arc(const CouplingKind& kind, const TomlTable& table, int line) const {
    table.allow_keys({"name", "pin", "center", "radius", "from", "to"});
    const auto [pin, center] = points_of(table, "pin", "center");
    const PointRef origin{line, 0};
    std::vector<Stop> rows(3);
    rows[0].table = kind.table;
    rows[0].on = Measure::component_along(origin, pin, {1, 0});
    rows[0].min = rows[0].max = not_given;
    rows[1].table = "circular_slot_line";
    rows[1].on = Measure::component_along(origin, pin, {0, 1});
    rows[1].min = rows[1].max = 0.0;
    rows[2].table = "circular_slot_ends";
    rows[2].on = Measure::angle_between(center.body, line);
    rows[2].min = table.number("from", table.unit(dimension::angle), Range::finite);
    rows[2].max = table.number("to", table.unit(dimension::angle), Range::finite);
    if (!(rows[2].min < rows[2].max && rows[2].max - rows[2].min < full_turn)) {
      table.place_of("to").fail("expected an arc from a smaller angle to a larger one, of less than a full turn");
    }
    read_numbers(table, kind.numbers.first(1), rows.data(), &rows[0].on);
    return rows;
  }

  // In the frame of the strand, which begins at the centre of sprocket a: along it and over the rims, across it, and
  // its straight length.
  std::vector<Stop> read_chain(const CouplingKind& kind, const TomlTable& table, int strand) const {
    table.allow_keys(
        {"name", "a", "b", "radius_a", "radius_b", "turn", "crossed", "length", "slack", "restitution", "law"});
    const auto [b, a] = points_of(table, "b", "a");
    const bool is_crossed = table.flag("crossed", false);
    const std::optional<TomlText> turn = table.find_text("turn");
    const double sense = turn && choose(*turn, {"counterclockwise", "clockwise"}) == 1 ? -1.0 : 1.0;
    const PointRef origin{strand, 0};
    const Measure straight = Measure::component_along(origin, b, {1, 0});
    std::vector<Stop> rows(3);
    for (Stop& row : rows) row.sense = sense;
    rows[0].table = kind.table;
    // Signed radii: those of sprocket b have the other sign where the strand crosses the line of centres.
    rows[0].on = Measure::sum_of(
        {{1.0, straight},
         {-sense, Measure::angle_between(strand, a.body)},
         {sense, is_crossed ? Measure::angle_between(b.body, strand) : Measure::angle_between(strand, b.body)}});
    rows[0].min = rows[0].max = not_given;
    rows[1].table = is_crossed ? "chain_crossed_line" : "chain_line";
    rows[1].on = Measure::component_along(origin, b, {0, 1});
    rows[1].min = rows[1].max = 0.0;
    rows[2].table = "chain_straight";
    rows[2].on = straight;
    rows[2].min = 0.0;
    read_numbers(table, kind.numbers, rows.data(), &rows[0].on);
    if (table.flag("slack", false)) rows[0].min = -std::numeric_limits<double>::infinity();
    read_impact(table, rows[0]);
    return rows;
  }

  // from <= s <= to;  pin - at - (X(s), Y(s)) = 0 in the frame of the slot's body.
  std::vector<Stop> read_track(const TomlTable& table, int rider) const {
    table.allow_keys({"name", "pin", "at", "curve", "closed", "from", "to"});
    const auto [pin, at] = points_of(table, "pin", "at");
    const bool is_closed = table.flag("closed", false);
    std::vector<Stop> rows(3);
    rows[0].table = "curved_slot";
    rows[0].on = Measure::travel_of(rider);
    rows[0].curve = track_points(table, is_closed);
    rows[0].closed = is_closed;
    const auto make_row = [&, pin = pin, at = at](Stop& row, std::string_view axis, Vec2 direction) {
      row.table = "curved_slot_" + std::string(axis);
      row.on = Measure::sum_of({{1.0, Measure::component_along(at, pin, direction)},
                                {-1.0, Measure::travel_of(rider), std::shared_ptr<const Profile>(), 0.0, 1.0}});
      row.min = row.max = 0.0;
    };
    make_row(rows[1], "x", {1, 0});
    make_row(rows[2], "y", {0, 1});
    read_ends(table, rows[0]);
    try {
      check_curve(rows.data());
    } catch (const InputError&) {
      table.place_of("to").fail("expected an end behind the key from");
    }
    follow_curve(rows.data());
    return rows;
  }

  // The points of the curve of that key, m.
  std::vector<Vec2> track_points(const TomlTable& table, bool is_closed, std::string_view key = "curve") const {
    std::vector<Vec2> points;
    for (const TomlTable::Pair& pair : table.pairs(key, table.unit(dimension::length), table.unit(dimension::length))) {
      if (!points.empty() && points.back() == pair.value) {
        pair.place.fail("expected another point than the one before");
      }
      points.push_back(pair.value);
    }
    if (points.size() < 3) table.place_of(key).fail("expected three points [X, Y] or more");
    if (is_closed && points.front() == points.back()) {
      table.place_of(key).fail("expected another last point than the first, to which a closed curve returns anyway");
    }
    return points;
  }

  void read_ends(const TomlTable& table, Stop& ends) const {
    const auto find = [&](std::string_view key, double otherwise) {
      return table.find_number(key, table.unit(dimension::length), Range::finite).value_or(otherwise);
    };
    constexpr double unlimited = std::numeric_limits<double>::infinity();
    ends.min = find("from", ends.closed ? -unlimited : 0.0);
    ends.max = find("to", unlimited);
    ends.to_end = !ends.closed && !table.has("to");
  }

  // The direction of a line.
  static Vec2 axis_of(const TomlTable& table) {
    const Vec2 axis = table.vector("axis", 1.0);
    if (axis == Vec2{}) table.place_of("axis").fail("expected a direction, found [0, 0]; give for example [1, 0]");
    return axis;
  }

  // The pin stays as near to the middle of its hole as their radii differ, or to the line of its slot.
  Stop read_loose(const CouplingKind& kind, const TomlTable& table) const {
    const bool is_pin = kind.table == "loose_pin";
    if (is_pin)
      table.allow_keys({"name", "points", "clearance", "restitution", "law"});
    else
      table.allow_keys({"name", "points", "axis", "clearance", "restitution", "law"});
    const auto [a, b] = names_.two_points(table);
    Stop stop;
    stop.table = kind.table;
    if (is_pin) {
      stop.on = Measure::distance_between(a, b);
      stop.max = not_given;
    } else {
      stop.on = Measure::component_along(a, b, quarter_turn(axis_of(table)));
      stop.min = stop.max = 0.0;
    }
    read_numbers(table, kind.numbers, &stop, &stop.on);
    read_impact(table, stop);
    return stop;
  }

  // A stop for each convex part of the outline.
  // A point and a convex body that it stays outside of.
  struct Touching {
    PointRef point;
    Outline outline;
  };

  std::vector<Stop> read_contact(const CouplingKind& kind, const TomlTable& table) const {
    const bool is_between_outlines = table.has("against");
    if (is_between_outlines) {
      table.allow_keys(
          {"name", "outline", "closed", "against", "against_closed", "radius", "restitution", "law", "friction"});
    } else {
      table.allow_keys(
          {"name", "point", "radius", "segment", "arc", "outline", "closed", "restitution", "law", "friction"});
    }
    const std::vector<Touching> touching = is_between_outlines ? corners_of_outlines(table) : parts_at_point(table);
    std::vector<Stop> rows(touching.size());
    for (std::size_t part = 0; part < rows.size(); ++part) {
      rows[part].table = part == 0 ? std::string(kind.table) : fmt::format("contact_part.{}", part);
      rows[part].on = Measure::clearance_of(touching[part].point, touching[part].outline);
      rows[part].min = 0.0;
    }
    rows.front().parts = static_cast<int>(rows.size());
    read_numbers(table, kind.numbers, rows.data(), &rows[0].on);
    read_impact(table, rows.front());
    for (Stop& row : rows) row.impact_law = rows.front().impact_law;
    return rows;
  }

  std::vector<Touching> parts_at_point(const TomlTable& table) const {
    const PointRef point = names_.point(table.text("point"));
    std::vector<Touching> out;
    for (const Outline& part : outlines_of(table, point)) out.push_back({point, part});
    return out;
  }

  // The distance of two outlines is that of a corner of one of them from the other.
  std::vector<Touching> corners_of_outlines(const TomlTable& table) const {
    const bool first_is_closed = table.flag("closed", false), second_is_closed = table.flag("against_closed", false);
    const std::vector<OutlinePoint> first = way_of(table, "outline", first_is_closed, std::nullopt, "");
    const std::vector<OutlinePoint> second = way_of(table, "against", second_is_closed, first.front().point, "outline");
    std::vector<Touching> out;
    const auto add = [&](const std::vector<OutlinePoint>& corners, bool closed, const std::vector<OutlinePoint>& way,
                         bool way_is_closed, std::string_view key) {
      const std::vector<Outline> parts =
          located(table.place_of(key), [&] { return parts_of_outline(way, way_is_closed); });
      for (const PointRef& corner : corners_that_stand_out(corners, closed)) {
        for (const Outline& part : parts) out.push_back({corner, part});
      }
    };
    add(first, first_is_closed, second, second_is_closed, "against");
    add(second, second_is_closed, first, first_is_closed, "outline");
    if (out.empty()) {
      table.place_of("against").fail(
          "expected a corner of one of the outlines that the other can touch, found two holes; let one go clockwise");
    }
    if (out.size() > most_contact_parts + 1) {
      table.place_of("against").fail(
          fmt::format("expected outlines with at most {} pairs of a corner and a convex part, found {}; give some of "
                      "them as contacts of their own",
                      most_contact_parts + 1, out.size()));
    }
    return out;
  }

  // Ends, and corners where a way turns to the right: in others nothing fits that has not touched an edge before.
  static std::vector<PointRef> corners_that_stand_out(const std::vector<OutlinePoint>& way, bool closed) {
    std::vector<PointRef> out;
    const std::size_t n = way.size();
    for (std::size_t k = 0; k < n; ++k) {
      const bool is_end = !closed && (k == 0 || k + 1 == n);
      const Vec2 here = way[k].at;
      if (is_end || cross(here - way[(k + n - 1) % n].at, way[(k + 1) % n].at - here) < 0.0)
        out.push_back(way[k].point);
    }
    return out;
  }

  std::vector<Outline> outlines_of(const TomlTable& table, PointRef point) const {
    const int given = (table.has("segment") ? 1 : 0) + (table.has("arc") ? 1 : 0) + (table.has("outline") ? 1 : 0);
    if (given != 1) {
      table.place().fail(
          "expected one of the keys segment, arc and outline, for example segment = [\"wheel.A\", \"wheel.B\"]; the "
          "point touches it on the left of the way from A to B");
    }
    if (table.has("closed") && !table.has("outline")) {
      table.place_of("closed").fail("expected the key outline beside closed; leave closed out");
    }
    if (const std::optional<TomlTable> arc = table.find_table("arc")) return {arc_of(*arc, point)};
    const std::string_view key = table.has("segment") ? "segment" : "outline";
    const bool closed = table.flag("closed", false);
    const std::vector<OutlinePoint> way = way_of(table, key, closed, point, "point");
    std::vector<Outline> out = located(table.place_of(key), [&] { return parts_of_outline(way, closed); });
    if (out.size() > most_contact_parts + 1) {
      table.place_of(key).fail(
          fmt::format("expected an outline of at most {} convex parts, found {}; give some of it "
                      "as a contact of its own",
                      most_contact_parts + 1, out.size()));
    }
    return out;
  }

  // Through points of another body than that of what touches it, if given, under the key `other`.
  std::vector<OutlinePoint> way_of(const TomlTable& table, std::string_view key, bool closed,
                                   const std::optional<PointRef>& touching, std::string_view other) const {
    std::vector<OutlinePoint> way;
    for (const TomlText& name : table.texts(key)) way.push_back(outline_point(name, way, touching, other));
    if (key == "segment" ? way.size() != 2 : way.size() < (closed ? 3U : 2U)) {
      table.place_of(key).fail(key == "segment" ? "expected two points; several edges are an outline"
                               : closed         ? "expected three points or more of a closed outline"
                                                : "expected two points or more");
    }
    if (closed && way.front().at == way.back().at) {
      table.place_of(key).fail("expected another last point than the first, to which a closed outline returns anyway");
    }
    return way;
  }

  // A point of another body than that of the point that touches it, and of the same as those before.
  OutlinePoint outline_point(const TomlText& name, const std::vector<OutlinePoint>& before,
                             const std::optional<PointRef>& touching, std::string_view other) const {
    const PointRef at = names_.point(name);
    if (touching && at.body == touching->body) {
      name.place.fail(fmt::format("expected a point of another body than that of the key {}", other));
    }
    if (!before.empty()) {
      if (at.body != before.front().point.body) {
        name.place.fail("expected a point of the same body as the first, " + scene_.name_of(before.front().point));
      }
      if (scene_.local(at) == before.back().at) name.place.fail("expected another place than that of the point before");
    }
    return {at, scene_.local(at)};
  }

  Outline arc_of(const TomlTable& arc, PointRef point) const {
    arc.allow_keys({"center", "from", "to", "hollow"});
    std::vector<OutlinePoint> way;
    Outline out{arc.flag("hollow", false) ? Outline::Form::hollow_arc : Outline::Form::arc, {}, false};
    for (const std::string_view key : {"center", "from", "to"}) {
      way.push_back(
          outline_point(arc.text(key), key == "to" ? std::vector<OutlinePoint>{way.front()} : way, point, "point"));
      out.points.push_back(way.back().point);
    }
    const double radius = norm(way[1].at - way[0].at), other = norm(way[2].at - way[0].at);
    constexpr double rounding = 1e-6;
    if (std::abs(other - radius) > rounding * radius) {
      const double unit = arc.unit(dimension::length);
      arc.place_of("to").fail(
          fmt::format("expected a point as far from the center as that of the key from, {:.9g}, "
                      "found {:.9g}",
                      radius / unit, other / unit));
    }
    return out;
  }

  // Across the line, and along it: component + radius (angle of the wheel from the line's body).
  std::vector<Stop> read_rolling(const CouplingKind& kind, const TomlTable& table) const {
    table.allow_keys({"name", "wheel", "line", "axis", "radius", "offset"});
    const auto [wheel, line] = points_of(table, "wheel", "line");
    const Vec2 axis = axis_of(table);
    std::vector<Stop> rows(2);
    rows[0].table = kind.table;
    rows[0].on = Measure::component_along(line, wheel, quarter_turn(axis));
    rows[1].table = "rolling_friction";
    rows[1].on = Measure::sum_of(
        {{1.0, Measure::component_along(line, wheel, axis)}, {1.0, Measure::angle_between(line.body, wheel.body)}});
    rows[1].min = rows[1].max = 0.0;
    read_numbers(table, kind.numbers, rows.data(), &rows[0].on);
    return rows;
  }

  // In the frame of the line of centres, at an angle a: along it, its arcs, and across it.
  std::vector<Stop> read_rolling_on_circle(const CouplingKind& kind, const TomlTable& table, int line) const {
    table.allow_keys({"name", "wheel", "center", "radius", "circle_radius", "inside", "offset"});
    const auto [wheel, center] = points_of(table, "wheel", "center");
    const bool is_inside = table.flag("inside", false);
    const PointRef origin{line, 0};
    std::vector<Stop> rows(3);
    for (Stop& row : rows) row.sense = is_inside ? -1.0 : 1.0;
    rows[0].table = kind.table;
    rows[0].on = Measure::component_along(origin, wheel, {1, 0});
    const Measure across = Measure::component_along(origin, wheel, {0, 1});
    rows[1].table = "rolling_on_circle_friction";
    // The component across makes the force of this row the friction at the contact; it is zero.
    rows[1].on = Measure::sum_of({{-rows[1].sense, across},
                                  {1.0, Measure::angle_between(line, wheel.body)},
                                  {-rows[1].sense, Measure::angle_between(center.body, line)}});
    rows[1].min = rows[1].max = 0.0;
    rows[2].table = "rolling_on_circle_line";
    rows[2].on = across;
    rows[2].min = rows[2].max = 0.0;
    read_numbers(table, kind.numbers, rows.data(), &rows[0].on);
    if (!(rows[0].max > 0.0)) {
      table.place_of("radius").fail("expected a smaller wheel than the circle that it rolls in");
    }
    return rows;
  }

  // The functions of the curve that rolls, as terms of its travel. Somewhere its curvature, 1/m, to the left positive,
  // is more than `least`, that of what it rolls on.
  struct Curve {
    Measure::Term angle, length, along, across;
    std::vector<Vec2> points;
    bool is_closed;
  };
  Curve read_curve(const TomlTable& table, int rider, double least) const {
    return read_curve(table, "curve", table.flag("closed", false), rider, least);
  }
  Curve read_curve(const TomlTable& table, std::string_view key, bool is_closed, int rider, double least) const {
    std::vector<Vec2> points = track_points(table, is_closed, key);
    const RollingProfile found =
        located(table.place_of(key), [&] { return rolling_profile_on(least, points, is_closed); });
    const auto term = [&](double factor, const std::shared_ptr<const Profile>& profile) {
      return Measure::Term{factor, Measure::travel_of(rider), profile, 0.0, found.chords};
    };
    return {term(1.0, found.angle),  term(-1.0, found.length), term(1.0, found.along),
            term(1.0, found.across), std::move(points),        is_closed};
  }

  static void keep_points(const Curve& curve, Stop& first) {
    first.curve = curve.points;
    first.closed = curve.is_closed;
  }

  // Angle of the body from the other one + angle of the tangent = `axis`, with the body's angle where the first point
  // touches in (-pi, pi].
  static Stop tangent_row(const CouplingKind& kind, int other, int body, const Measure::Term& angle, double axis) {
    Stop row;
    row.table = std::string(kind.table) + "_tangent";
    row.on = Measure::sum_of({{1.0, Measure::angle_between(other, body)}, angle});
    const double first = angle.profile->at(0.0).value;
    double turned = std::remainder(axis - first, full_turn);
    constexpr double rounding = 1e-9;
    if (turned < rounding - M_PI) turned += full_turn;
    row.min = row.max = first + turned;
    return row;
  }

  // Where an open curve ends.
  void add_ends(const CouplingKind& kind, const TomlTable& table, const Curve& curve, std::vector<Stop>& rows) const {
    if (curve.is_closed) return;
    Stop& ends = rows.emplace_back();
    ends.table = std::string(kind.table) + "_ends";
    ends.on = curve.angle.measure;
    read_ends(table, ends);
    if (ends.to_end) ends.max = curve.angle.span;
    if (!(ends.min < ends.max)) table.place_of("to").fail("expected an end behind the key from");
    for (const auto& [key, at] : {std::pair("from", ends.min), std::pair("to", ends.max)}) {
      if (!(at >= 0.0 && at <= curve.angle.span)) {
        table.place_of(key).fail(fmt::format("expected a place on the curve, from 0 to {:.6g}",
                                             curve.angle.span / table.unit(dimension::length)));
      }
    }
  }

  // Across the line, and along it; the arc of the curve is as long as the contact's way on the line.
  std::vector<Stop> read_rolling_profile(const CouplingKind& kind, const TomlTable& table, int rider) const {
    allow_profile(table, {"line", "axis"});
    const auto [at, line] = points_of(table, "at", "line");
    const Vec2 axis = axis_of(table);
    const Curve curve = read_curve(table, rider, 0.0);
    std::vector<Stop> rows(2);
    rows[0].table = kind.table;
    rows[0].on = Measure::sum_of({{1.0, Measure::component_along(line, at, quarter_turn(axis))}, curve.across});
    rows[1].table = "rolling_profile_friction";
    rows[1].on = Measure::sum_of({{1.0, Measure::component_along(line, at, axis)}, curve.along, curve.length});
    for (Stop& row : rows) row.min = row.max = 0.0;
    keep_points(curve, rows[0]);
    rows.push_back(tangent_row(kind, line.body, at.body, curve.angle, std::atan2(axis.y, axis.x)));
    add_ends(kind, table, curve, rows);
    read_numbers(table, kind.numbers.first(1), rows.data(), &rows[0].on);
    return rows;
  }

  // In the frame of the radius to the contact, at an angle a: along it, across it with the arcs, and across it.
  std::vector<Stop> read_profile_on_circle(const CouplingKind& kind, const TomlTable& table, int rider,
                                           int line) const {
    allow_profile(table, {"center", "circle_radius", "inside"});
    const auto [at, center] = points_of(table, "at", "center");
    const double sense = table.flag("inside", false) ? -1.0 : 1.0;
    const double radius = table.number("circle_radius", table.unit(dimension::length), Range::positive);
    Curve curve = read_curve(table, rider, -sense / radius);
    curve.across.factor = sense;
    const PointRef origin{line, 0};
    const Measure::Term across{-sense, Measure::component_along(origin, at, {0, 1})};
    std::vector<Stop> rows(2);
    rows[0].table = kind.table;
    rows[0].on = Measure::sum_of({{1.0, Measure::component_along(origin, at, {1, 0})}, curve.across});
    rows[0].min = rows[0].max = not_given;
    keep_points(curve, rows[0]);
    rows[1].table = "rolling_profile_on_circle_friction";
    // The component across makes the force of this row the friction at the contact, as that of a wheel.
    rows[1].on = Measure::sum_of(
        {across, curve.along, curve.length, {-sense * radius, Measure::angle_between(center.body, line)}});
    rows[1].min = rows[1].max = 0.0;
    rows.push_back(tangent_row(kind, line, at.body, curve.angle, -sense * M_PI / 2));
    Stop& aside = rows.emplace_back();
    aside.table = "rolling_profile_on_circle_line";
    aside.on = Measure::sum_of({across, curve.along});
    aside.min = aside.max = 0.0;
    add_ends(kind, table, curve, rows);
    for (Stop& row : rows) row.sense = sense;
    read_numbers(table, kind.numbers.first(2), rows.data(), &rows[0].on);
    return rows;
  }

  // A closed curve that bends to its left everywhere.
  Curve read_convex_curve(const TomlTable& table, std::string_view key, int rider) const {
    Curve curve = read_curve(table, key, true, rider, 0.0);
    if (!is_convex(*curve.angle.profile)) {
      table.place_of(key).fail(
          "expected a convex curve, found one that bends to its right in places; give a contact for each convex part, "
          "or more points where it should be convex");
    }
    return curve;
  }

  // In the frame of the tangent that both curves share, at an angle a: how far they are apart, and none along it.
  std::vector<Stop> read_curve_contact(const CouplingKind& kind, const TomlTable& table, int rider, int line) const {
    table.allow_keys({"name", "at", "curve", "against", "against_curve", "radius", "restitution", "law"});
    const auto [at, against] = points_of(table, "at", "against");
    const Curve first = read_convex_curve(table, "curve", rider);
    const Curve second = read_convex_curve(table, "against_curve", rider + 1);
    const PointRef origin{line, 0};
    const auto negative = [](Measure::Term term) {
      term.factor = -term.factor;
      return term;
    };
    std::vector<Stop> rows(2);
    rows[0].table = kind.table;
    rows[0].on =
        Measure::sum_of({{1.0, Measure::component_along(origin, against, {0, -1})}, first.across, second.across});
    rows[0].min = 0.0;
    rows[0].parts = 1;
    rows[1].table = "curve_contact_along";
    rows[1].on = Measure::sum_of(
        {{1.0, Measure::component_along(origin, against, {1, 0})}, negative(first.along), negative(second.along)});
    rows[1].min = rows[1].max = 0.0;
    keep_points(first, rows[0]);
    keep_points(second, rows[1]);
    rows.push_back(tangent_row(kind, line, at.body, first.angle, 0.0));
    rows.push_back(tangent_row(kind, line, against.body, second.angle, M_PI));
    rows.back().table = "curve_contact_against_tangent";
    read_numbers(table, kind.numbers, rows.data(), &rows[0].on);
    read_impact(table, rows.front());
    return rows;
  }

  static void allow_profile(const TomlTable& table, Keys keys) {
    keys.insert(keys.end(), {"name", "at", "curve", "closed", "offset"});
    if (!table.flag("closed", false)) keys.insert(keys.end(), {"from", "to"});
    table.allow_keys(keys);
  }

  // follower - lift P((angle - phase) / turn).
  void read_cam(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "bodies", "follower", "law", "curve", "lift", "phase", "base", "guided", "roller",
                      "restitution", "friction"});
    const auto [a, b] = names_.two_bodies(table);
    const std::optional<TomlTable> follower = table.find_table("follower");
    if (!follower)
      table.place().fail("expected the key follower; add follower = { slide = \"...\" }, or another measure");
    if (table.has("law") == table.has("curve")) {
      table.place().fail(
          "expected one of the keys law (parts with \"to\", \"lift\" and \"law\") and curve (points [ANGLE, LIFT])");
    }
    stop.sense = -1.0;
    stop.on = Measure::sum_of({{1.0, measures_.read(*follower, all_measures(), {})},
                               {stop.sense, Measure::angle_between(a, b), std::shared_ptr<const Profile>()}});
    if (table.has("curve")) {
      stop.curve = curve_of(table);
      follow_curve(&stop);
    } else {
      stop.on.terms[1].profile = std::make_shared<const Profile>(parts_of(table));
    }
    if (stop.on.terms[0].measure.kind == Measure::Kind::sum) {
      follower->place_of("sum").fail("expected a single measure");
    }
    if (const std::optional<TomlText> roller = table.find_text("roller")) read_roller(*roller, stop);
  }

  // Friction acts along the curve on which the follower's edge is, which only a cam with a roller tells.
  static void check_rubbing(const TomlTable& table, const Stop& cam) {
    if (!cam.friction) return;
    if (cam.holds()) {
      table.place_of("friction")
          .fail("expected no friction of a guided cam, whose roller rolls in its groove; leave it out");
    }
    if (!cam.roller) {
      table.place_of("friction")
          .fail(
              "expected the key roller beside it, the edge of the follower that rubs on the cam; add roller = "
              "\"BODY.POINT\"");
    }
  }

  void read_roller(const TomlText& roller, Stop& stop) const {
    stop.roller = names_.point(roller);
    if (stop.roller->body > 0 && cam_geometry(scene_, stop)) return;
    roller.place.fail(
        "expected the centre of the roller on a follower that slides on, or turns about a pin of, the body in which "
        "the cam is pinned; give such a point, or leave the key out");
  }

  /// Turns per unit of an angle of the file.
  static double turns(const TomlTable& table) { return table.unit(dimension::angle) / full_turn; }

  /// From curve = [[ANGLE, LIFT], ...], as Stop::curve.
  std::vector<Vec2> curve_of(const TomlTable& table) const {
    std::vector<Vec2> curve;
    for (const TomlItem& point : table.items("curve")) {
      const Vec2 at = point.vector();
      if (!curve.empty() && !(curve.back().x < at.x * turns(table))) {
        point.place().fail("expected a greater angle than before");
      }
      curve.push_back({at.x * turns(table), at.y});
    }
    if (curve.size() < 4) {
      table.place_of("curve").fail("expected four points [ANGLE, LIFT] or more, over a full turn");
    }
    expect_full_turn(curve.front().x, curve.back().x, table.place_of("curve"));
    expect_closed(curve.front().y, curve.back().y, table.place_of("curve"));
    curve.front().x = 0.0;
    curve.back().x = 1.0;
    return curve;
  }

  /// From law = [{ to, lift, law }, ...]: each part ends at its angle and at its share of the lift, or at that of the
  /// part before. The first begins where the last ends.
  Profile parts_of(const TomlTable& table) const {
    const std::vector<TomlTable> parts = table.tables("law");
    if (parts.empty())
      table.place_of("law").fail("expected a part or more, for example { to = 120, lift = 1, law = \"harmonic\" }");
    const std::vector<std::string> laws(Profile::laws.begin(), Profile::laws.end());
    const double begin = parts.back().find_number("lift", 1.0, Range::finite).value_or(0.0);
    double angle = 0.0, lift = begin;
    std::vector<Profile::Piece> pieces;
    for (const TomlTable& part : parts) {
      part.allow_keys({"to", "lift", "law"});
      double to = part.number("to", turns(table), Range::finite);
      if (&part == &parts.back()) {
        expect_full_turn(0.0, to, part.place_of("to"));
        to = 1.0;
      }
      if (!(to > angle)) part.place_of("to").fail("expected a greater angle than that of the part before");
      const std::string_view law = Profile::laws[choose(part.text("law"), laws)];
      const double end = part.find_number("lift", 1.0, Range::finite).value_or(lift);
      if (law == "dwell" && end != lift) part.place_of("lift").fail("expected the lift of the part before in a dwell");
      pieces.push_back(Profile::standard(law, angle, to, lift, end));
      angle = to;
      lift = end;
    }
    expect_closed(begin, lift, parts.back().place());
    return {std::move(pieces), true};
  }

  static void expect_full_turn(double from, double to, const TomlPlace& place) {
    if (std::abs(from) > 1e-12 || std::abs(to - 1.0) > 1e-12) {
      place.fail("expected a profile of one full turn, from angle 0 to 360 deg (2 pi rad)");
    }
  }
  static void expect_closed(double first, double last, const TomlPlace& place) {
    if (first != last) place.fail("expected the same lift at the end of the turn as at its beginning");
  }

  int carrier_of(const TomlTable& table) const {
    const std::optional<TomlText> carrier = table.find_text("carrier");
    return carrier ? names_.body(*carrier) : 0;
  }

  const SceneNames& names_;
  MeasureReader measures_;
  Scene& scene_;
};

/// A rope that stretches is a spring that acts in tension.
bool stretches(const CouplingKind& kind, const TomlTable& table) {
  return kind.table == "rope" && (table.has("stiffness") || table.has("free_length"));
}

/// A circular slot that has ends.
bool has_ends(const TomlTable& table) { return table.has("from") || table.has("to"); }

/// Couplings with riders, in the order in which they are read: their keys of the points at which these begin.
struct Ridden {
  std::string_view table;
  std::vector<std::string_view> at;
};
const std::vector<Ridden>& ridden() {
  static const std::vector<Ridden> all{{"curved_slot", {"at"}},
                                       {"rolling_profile", {"at"}},
                                       {"rolling_profile_on_circle", {"at"}},
                                       {"curve_contact", {"at", "against"}}};
  return all;
}

/// How many riders a coupling of this table has.
std::size_t riders_of(std::string_view table) {
  const auto found =
      std::find_if(ridden().begin(), ridden().end(), [&](const Ridden& one) { return one.table == table; });
  return found == ridden().end() ? 0 : found->at.size();
}

/// What is behind the name of a coupling in those of its rows.
std::string name_of_row(const std::string& name, const Stop& row) {
  if (row.table == "curved_slot_x") return name + " x";
  if (row.table == "curved_slot_y") return name + " y";
  if (row.table.starts_with("contact_part.")) return name + " part " + row.table.substr(row.table.find('.') + 1);
  if (row.table.ends_with("_line")) return name + " line";
  if (row.table.ends_with("_ends")) return name + " ends";
  if (row.table.ends_with("_straight")) return name + " straight";
  if (row.table.ends_with("_along")) return name + " along";
  if (row.table.ends_with("_against_tangent")) return name + " against tangent";
  if (row.table.ends_with("_tangent")) return name + " tangent";
  return row.table.ends_with("_friction") ? name + " friction" : name;
}

/// The guess of a body's angle. Without one of its own, that of a body, or the ground, to which slides and welds keep
/// it at an angle; else 0.
double guessed_angle(const Scene& scene, int body) {
  std::vector<std::pair<int, double>> reached{{body, 0.0}};  // bodies, and by how much `body` is turned from them
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const auto [at, turn] = reached[k];
    const std::optional<double>& guess = scene.start.angle[static_cast<std::size_t>(at)];
    if (guess) return *guess + turn;
    if (at == 0) return turn;
    for (const Joint& joint : scene.joints) {
      if (!joint.keeps_angle() || (joint.a.body != at && joint.b.body != at)) continue;
      const bool is_second = joint.b.body == at;
      const int other = is_second ? joint.a.body : joint.b.body;
      const bool is_known =
          std::any_of(reached.begin(), reached.end(), [&](const auto& one) { return one.first == other; });
      if (!is_known) reached.emplace_back(other, turn + (is_second ? joint.angle : -joint.angle));
    }
  }
  return 0.0;
}

/// Of a profile that rolls, without a guess of its place: where the tangent has the angle that the contact has at the
/// guesses of the bodies' angles. Before, that of an open one begins with the whole turns that bring its middle there.
void guess_place(Stop& tangent, Scene& scene) {
  const Measure::Term& turned = tangent.on.terms[0];
  const Measure::Term& curve = tangent.on.terms[1];
  const double body = guessed_angle(scene, turned.measure.body_b) - guessed_angle(scene, turned.measure.body_a);
  const auto tangent_at = [&](double u) { return curve.profile->at(u).value; };
  double turns = 0.0;
  if (curve.profile->periodic()) {
    turns = std::floor((tangent.min - body - tangent_at(0.0)) / full_turn);
  } else {
    tangent.min += full_turn * std::round((tangent_at(0.5) + body - tangent.min) / full_turn);
    tangent.max = tangent.min;
  }
  std::optional<double>& guess = scene.start.travel[static_cast<std::size_t>(curve.measure.joint)];
  if (guess) return;
  constexpr int samples = 1000;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= samples; ++k) {
    const double u = static_cast<double>(k) / samples;
    const double off = std::abs(body + full_turn * turns + tangent_at(u) - tangent.min);
    if (off >= nearest) continue;
    nearest = off;
    guess = (turns + u) * curve.span;
  }
}

/// The value of a measure of angles and travels at the guesses of the scene; nothing of others.
std::optional<double> guessed(const Scene& scene, const Measure& measure) {
  switch (measure.kind) {
    case Measure::Kind::angle:
      return guessed_angle(scene, measure.body_b) - guessed_angle(scene, measure.body_a);
    case Measure::Kind::travel:
      return scene.start.travel[static_cast<std::size_t>(measure.joint)].value_or(0.0);
    case Measure::Kind::sum: {
      double sum = 0.0;
      for (const Measure::Term& term : measure.terms) {
        const std::optional<double> g = guessed(scene, term.measure);
        if (!g) return std::nullopt;
        sum += term.factor * (term.profile ? term.profile->at((*g - term.shift) / term.span).value : *g);
      }
      return sum;
    }
    default:
      return std::nullopt;
  }
}

/// Where the tangent of a closed convex curve has this angle from the x axis of its body, as a share of the curve.
double place_of_tangent(const Profile& angle, double wanted) {
  const double first = angle.at(0.0).value;
  const double turned = wanted - first - full_turn * std::floor((wanted - first) / full_turn);
  double low = 0.0, high = 1.0;
  constexpr int halvings = 53;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (angle.at(middle).value - first < turned ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Of a contact of curves, whose first stop this is: gives the tangent that they share and the places of the contact
/// where the guesses of the scene put the bodies, as far as the scene has no guesses for them. The component of their
/// way apart along the tangent falls as the tangent turns, within a right angle of where it is square to the way
/// between their origins.
void guess_contact(const Stop* rows, Scene& scene) {
  const Measure& apart = rows[0].on.terms[0].measure;
  const Mechanism<double> mechanism(scene);
  const std::vector<BodyPose<double>> poses = mechanism.poses(mechanism.start().data());
  const auto pose_of = [&](int body) { return poses[static_cast<std::size_t>(body)]; };
  const Vec2 way =
      pose_of(apart.b.body).world(scene.local(apart.b)) - pose_of(apart.a.body).world(scene.local(apart.a));
  const auto place = [&](int row, double angle) {
    const Measure::Term& turned = rows[row].on.terms[0];
    const double of_line = row == 2 ? angle : angle + M_PI;
    return place_of_tangent(*rows[row].on.terms[1].profile, of_line - pose_of(turned.measure.body_b).angle);
  };
  const auto along = [&](double angle) {
    double out = dot(unit(angle), way);
    for (const int curve : {1, 2}) out -= rows[1].on.terms[curve].profile->at(place(1 + curve, angle)).value;
    return out;
  };
  const double square = std::atan2(way.x, -way.y);
  double low = square - M_PI / 2, high = square + M_PI / 2;
  if (way == Vec2{} || !(along(low) > 0.0) || !(along(high) < 0.0)) low = high = square;
  constexpr int halvings = 53;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (along(middle) > 0.0 ? low : high) = middle;
  }
  std::optional<double>& line = scene.start.angle[static_cast<std::size_t>(apart.a.body)];
  if (!line) line = 0.5 * (low + high);
  for (const int row : {2, 3}) {
    const Measure::Term& curve = rows[row].on.terms[1];
    std::optional<double>& guess = scene.start.travel[static_cast<std::size_t>(curve.measure.joint)];
    if (guess) continue;
    const double u = place(row, *line);
    const double body = pose_of(rows[row].on.terms[0].measure.body_b).angle - *line;
    const double turns = std::round((rows[row].min - body - curve.profile->at(u).value) / full_turn);
    guess = (turns + u) * curve.span;
  }
}

/// Of a chain, whose first stop this is, where the guesses of the scene put its sprockets: gives the angle of its
/// strand, and the length that is not given. Throws InputError where the sprockets have no strand there.
void fit_chain(Stop* rows, const TomlTable& table, Scene& scene) {
  const Mechanism<double> mechanism(scene);
  const std::vector<BodyPose<double>> poses = mechanism.poses(mechanism.start().data());
  const Measure& straight = rows[0].on.terms[0].measure;
  const PointRef a = straight.a, b = straight.b;
  const Vec2 d = poses[static_cast<std::size_t>(b.body)].world(scene.local(b)) -
                 poses[static_cast<std::size_t>(a.body)].world(scene.local(a));
  const double offset = rows[1].min, apart = norm(d);
  if (!(apart > std::abs(offset))) {
    table.place_of("b").fail(fmt::format(
        "expected centres that are further apart than the {} of the radii, {:.6g}, found {:.6g} where [start] puts "
        "the bodies; move the centres apart, give other radii, or guesses in [start] that part them",
        rows[1].table == "chain_crossed_line" ? "sum" : "difference", std::abs(offset) / scene.units.length,
        apart / scene.units.length));
  }
  const RopeSpan<double> span(d, offset);
  std::optional<double>& guess = scene.start.angle[static_cast<std::size_t>(a.body)];
  double angle = std::atan2(span.along.y, span.along.x);
  if (guess)
    angle += full_turn * std::round((*guess - angle) / full_turn);
  else
    guess = angle;
  if (!std::isnan(rows[0].max)) return;
  const auto angle_of = [&](int body) { return body == a.body ? angle : poses[static_cast<std::size_t>(body)].angle; };
  double length = span.length;
  for (const Measure::Term& term : std::span(rows[0].on.terms).subspan(1)) {
    length += term.factor * (angle_of(term.measure.body_b) - angle_of(term.measure.body_a));
  }
  rows[0].max = length;
  if (std::isnan(rows[0].min)) rows[0].min = length;
}

}  // namespace

std::vector<int> add_riders(const TomlTable& root, const SceneNames& names, Scene& scene) {
  std::vector<int> riders;
  for (const auto& [kind, keys] : ridden()) {
    const std::vector<TomlTable> tables = root.tables(kind);
    // The travel has the name of the table, by which [start] gives its guess.
    NameLines taken;
    for (const Body& body : scene.bodies) taken.emplace(body.name, body.line);
    for (const Joint& joint : scene.joints) taken.emplace(joint.name, joint.line);
    const std::vector<std::string> own = names_of(tables, numbered(kind, tables.size()), std::move(taken));
    for (std::size_t i = 0; i < tables.size(); ++i) {
      const int line = tables[i].place().line_in_document();
      for (const std::string_view key : keys) {
        const std::string travel = key == keys.front() ? own[i] : own[i] + " " + std::string(key);
        const std::string name = travel + " rider";
        if (const int body = names.index_of_body(name); body >= 0) {
          fail_taken(tables[i].place(), name, scene.bodies[static_cast<std::size_t>(body)].line);
        }
        const PointRef at = names.point(tables[i].text(key));
        const int rider = scene.add_body(name);
        scene.bodies.back().line = line;
        const PointRef origin = scene.add_point(rider, "O", {});
        riders.push_back(
            scene.add_joint({.kind = Joint::Kind::slide, .name = travel, .a = at, .b = origin, .line = line}));
      }
    }
  }
  return riders;
}

std::vector<int> add_lines_of_centres(const TomlTable& root, const SceneNames& names, const std::vector<int>& riders,
                                      Scene& scene) {
  std::vector<int> lines;
  for (const auto& [kind, pinned_at] : lines_of_centres) {
    const std::vector<TomlTable> tables = root.tables(kind);
    NameLines taken;
    for (const Body& body : scene.bodies) taken.emplace(body.name, body.line);
    for (const Joint& joint : scene.joints) taken.emplace(joint.name, joint.line);
    std::vector<std::string> own;
    if (const std::size_t count = riders_of(kind); count > 0) {
      std::size_t first = 0;  // of their riders
      for (const Ridden& before : ridden()) {
        if (before.table == kind) break;
        first += before.at.size() * root.tables(before.table).size();
      }
      for (std::size_t i = 0; i < tables.size(); ++i) {
        own.push_back(scene.joints[static_cast<std::size_t>(riders[first + count * i])].name +
                      (kind == "curve_contact" ? " line" : " radius"));
        if (const auto other = taken.find(own.back()); other != taken.end())
          fail_taken(tables[i].place(), own.back(), other->second);
      }
    } else {
      own = names_of(tables, numbered(kind, tables.size()), std::move(taken));
    }
    for (std::size_t i = 0; i < tables.size(); ++i) {
      lines.push_back(-1);
      if (kind == "circular_slot" && !has_ends(tables[i])) continue;
      const PointRef center = names.point(tables[i].text(pinned_at));
      lines.back() = scene.add_body(own[i]);
      scene.bodies.back().line = tables[i].place().line_in_document();
      const PointRef origin = scene.add_point(lines.back(), "O", {});
      scene.add_joint({.kind = Joint::Kind::pin,
                       .name = own[i] + " center",
                       .a = center,
                       .b = origin,
                       .line = tables[i].place().line_in_document()});
    }
  }
  return lines;
}

void read_couplings(const TomlTable& root, const SceneNames& names, const std::vector<int>& riders,
                    const std::vector<int>& lines, Scene& scene) {
  const CouplingReader reader(names, scene);
  std::size_t next_line = 0, next_rider = 0;
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.row > 0) continue;
    const std::vector<TomlTable> tables = root.tables(kind.table);
    // Forces of stops, couplings and joints are told by their names.
    NameLines taken;
    const std::size_t own_riders = riders_of(kind.table);
    const bool is_track = own_riders > 0;
    const bool is_circle = std::any_of(lines_of_centres.begin(), lines_of_centres.end(),
                                       [&](const LineOfCentres& one) { return one.table == kind.table; });
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      // A track has the name of its own travel.
      const bool is_own = is_track && std::count(riders.begin(), riders.end(), static_cast<int>(j)) > 0;
      if (!is_own) taken.emplace(scene.joints[j].name, scene.joints[j].line);
    }
    for (const Stop& stop : scene.stops) taken.emplace(stop.name, stop.line);
    const std::vector<std::string> item_names = names_of(tables, numbered(kind.table, tables.size()), std::move(taken));
    for (std::size_t i = 0; i < tables.size(); ++i) {
      if (stretches(kind, tables[i])) {
        Element rope = reader.read_stretching_rope(tables[i]);
        rope.name = item_names[i];
        rope.line = tables[i].place().line_in_document();
        scene.elements.push_back(std::move(rope));
        continue;
      }
      const int line = is_circle ? lines[next_line++] : -1;
      const int rider = is_track ? riders[next_rider] : -1;
      next_rider += own_riders;
      for (Stop& row : reader.read(kind, tables[i], rider, line)) {
        row.name = name_of_row(is_track    ? scene.joints[static_cast<std::size_t>(rider)].name
                               : line >= 0 ? scene.bodies[static_cast<std::size_t>(line)].name
                                           : item_names[i],
                               row);
        row.line = tables[i].place().line_in_document();
        for (const Stop& other : scene.stops) {
          if (other.name == row.name) fail_taken(tables[i].place(), row.name, other.line);
        }
        scene.stops.push_back(std::move(row));
      }
    }
  }
}

void set_values_from_start(const TomlTable& root, Scene& scene) {
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.row > 0) continue;
    const std::vector<TomlTable> tables = root.tables(kind.table);
    std::vector<const TomlTable*> given;
    for (const TomlTable& table : tables) {
      if (!stretches(kind, table)) given.push_back(&table);
    }
    std::size_t next = 0;
    for (Stop& stop : scene.stops) {
      if (stop.table != kind.table) continue;
      const TomlTable& table = *given.at(next++);
      if (kind.table == "chain") fit_chain(&stop, table, scene);
      if (!std::isnan(stop.min)) continue;
      if (kind.table == "cam") {
        table.place().fail("expected the key base, the follower's measure where the lift is zero; add base = NUMBER");
      }
      const std::optional<double> value = guessed(scene, stop.on);
      if (!value) {
        table.place().fail(
            "expected the key value, which follows from [start] only for angles and travels; add value = NUMBER");
      }
      stop.min = stop.max = *value;
      if (table.has("backlash")) read_numbers(table, stop.numbers().last(1), &stop, &stop.on);
    }
  }
  // The line of a slot with ends begins in the middle of its arc.
  for (Stop& stop : scene.stops) {
    if (stop.table == "curve_contact") guess_contact(&stop, scene);
    if (stop.table.ends_with("_tangent")) guess_place(stop, scene);
    if (stop.table != "circular_slot_ends") continue;
    std::optional<double>& guess = scene.start.angle[static_cast<std::size_t>(stop.on.body_b)];
    const double body = guessed_angle(scene, stop.on.body_a);
    if (!guess) guess = body + 0.5 * (stop.min + stop.max);
  }
}

}  // namespace poise
