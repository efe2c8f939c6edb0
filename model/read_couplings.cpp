#include "model/read_couplings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/couplings.hpp"
#include "model/profile.hpp"
#include "model/read_elements.hpp"
#include "model/read_measure.hpp"

namespace poise {
namespace {

constexpr double not_given = std::numeric_limits<double>::quiet_NaN();
constexpr double full_turn = 2 * M_PI;

using Keys = std::vector<std::string_view>;

class CouplingReader {
 public:
  CouplingReader(const SceneNames& names, Scene& scene) : names_(names), measures_(names, scene.units), scene_(scene) {}

  Stop read(const CouplingKind& kind, const TomlTable& table) const {
    Stop stop;
    stop.table = kind.table;
    stop.min = stop.max = not_given;
    if (kind.table == "gear" || kind.table == "belt")
      read_wheels(table, stop);
    else if (kind.table == "rack")
      read_rack(table, stop);
    else if (kind.table == "cam")
      read_cam(table, stop);
    else if (kind.table == "rope")
      read_rope(table, stop);
    else
      read_sum(table, stop);
    read_numbers(table, kind.numbers, &stop, &stop.on, scene_.units);
    if (stop.table == "rope") stop.min = -std::numeric_limits<double>::infinity();
    if (stop.table == "cam" && !table.flag("guided", false)) stop.max = std::numeric_limits<double>::infinity();
    return stop;
  }

  Element read_stretching_rope(const TomlTable& table) const {
    table.allow_keys({"name", "over", "stiffness", "free_length"});
    Element rope;
    rope.table = "rope";
    rope.on = Measure::rope_over(measures_.contacts(table, "over"));
    LinearSpring law;
    read_numbers(table, LinearSpring::numbers, &law, &rope.on, scene_.units);
    law.acts = LinearSpring::Acts::tension;
    rope.law = law;
    return rope;
  }

 private:
  // angle(carrier -> b) -+ ratio angle(carrier -> a).
  void read_wheels(const TomlTable& table, Stop& stop) const {
    const bool is_gear = stop.table == "gear";
    const std::string_view other_way = is_gear ? "internal" : "crossed";
    table.allow_keys({"name", "bodies", "carrier", "ratio", other_way, "phase"});
    const auto [a, b] = names_.two_bodies(table);
    const int carrier = carrier_of(table);
    for (const int wheel : {a, b}) {
      if (wheel == carrier) {
        table.place_of("carrier").fail("expected a body that carries both wheels, found one of them");
      }
    }
    // Wheels that mesh outside and crossed belts turn in opposite ways.
    const bool opposite = is_gear != table.flag(other_way, false);
    stop.sense = opposite ? 1.0 : -1.0;
    stop.on =
        Measure::sum_of({{1.0, Measure::angle_between(carrier, b)}, {stop.sense, Measure::angle_between(carrier, a)}});
  }

  // travel - radius angle(carrier -> pinion).
  void read_rack(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "slide", "pinion", "carrier", "radius", "offset"});
    const int rack = names_.travelling_joint(table.text("slide"));
    const TomlText pinion = table.text("pinion");
    const int body = names_.movable_body(pinion);
    const int carrier = table.has("carrier") ? carrier_of(table) : scene_.joints[static_cast<std::size_t>(rack)].a.body;
    if (body == carrier) pinion.place.fail("expected a pinion that turns on its carrier, found the carrier itself");
    stop.sense = -1.0;
    stop.on = Measure::sum_of({{1.0, Measure::travel_of(rack)}, {stop.sense, Measure::angle_between(carrier, body)}});
  }

  void read_sum(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "sum", "value"});
    if (!table.has("sum"))
      table.place().fail("expected the key sum; add sum = [{ factor = NUMBER, bodies = [...] }, ...]");
    std::vector<Measure::Term> terms = measures_.terms(table);
    const Measure sum = Measure::sum_of(terms);
    // A factor of an angle in a sum of lengths is a length per radian.
    for (Measure::Term& term : terms) {
      term.factor *= sum.dimension().unit(scene_.units) / term.measure.dimension().unit(scene_.units);
    }
    stop.on = Measure::sum_of(std::move(terms));
  }

  void read_rope(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "over", "length"});
    stop.on = Measure::rope_over(measures_.contacts(table, "over"));
  }

  // follower - lift P((angle - phase) / turn).
  void read_cam(const TomlTable& table, Stop& stop) const {
    table.allow_keys({"name", "bodies", "follower", "law", "curve", "lift", "phase", "base", "guided"});
    const auto [a, b] = names_.two_bodies(table);
    const std::optional<TomlTable> follower = table.find_table("follower");
    if (!follower)
      table.place().fail("expected the key follower; add follower = { slide = \"...\" }, or another measure");
    const auto profile = std::make_shared<const Profile>(profile_of(table));
    stop.sense = -1.0;
    stop.on = Measure::sum_of(
        {{1.0, measures_.read(*follower, all_measures(), {})}, {stop.sense, Measure::angle_between(a, b), profile}});
    if (stop.on.terms[0].measure.kind == Measure::Kind::sum) {
      follower->place_of("sum").fail("expected a single measure");
    }
  }

  /// P of a cam.
  Profile profile_of(const TomlTable& table) const {
    if (table.has("law") == table.has("curve")) {
      table.place().fail(
          "expected one of the keys law (parts with \"to\", \"lift\" and \"law\") and curve (points [ANGLE, LIFT])");
    }
    return table.has("curve") ? curve_of(table) : parts_of(table);
  }

  /// Turns per unit of an angle of the file.
  double turns() const { return scene_.units.angle / full_turn; }

  /// From curve = [[ANGLE, LIFT], ...].
  Profile curve_of(const TomlTable& table) const {
    std::vector<double> u, lift;
    for (const TomlItem& point : table.items("curve")) {
      const Vec2 at = point.vector();
      u.push_back(at.x * turns());
      lift.push_back(at.y);
      if (u.size() > 1 && !(u[u.size() - 2] < u.back())) point.place().fail("expected a greater angle than before");
    }
    if (u.size() < 4) table.place_of("curve").fail("expected four points [ANGLE, LIFT] or more, over a full turn");
    expect_full_turn(u.front(), u.back(), table.place_of("curve"));
    expect_closed(lift.front(), lift.back(), table.place_of("curve"));
    u.front() = 0.0;
    u.back() = 1.0;
    return Profile::spline(u, lift, true);
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
      double to = part.number("to", turns(), Range::finite);
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

/// The value of a measure of angles and travels at the guesses of the scene; nothing of others.
std::optional<double> guessed(const Scene& scene, const Measure& measure) {
  const auto angle = [&](int body) { return scene.start.angle[static_cast<std::size_t>(body)].value_or(0.0); };
  switch (measure.kind) {
    case Measure::Kind::angle:
      return angle(measure.body_b) - angle(measure.body_a);
    case Measure::Kind::travel:
      return scene.start.travel[static_cast<std::size_t>(measure.joint)].value_or(0.0);
    case Measure::Kind::sum: {
      double sum = 0.0;
      for (const Measure::Term& term : measure.terms) {
        const std::optional<double> g = guessed(scene, term.measure);
        if (!g || term.profile) return std::nullopt;
        sum += term.factor * *g;
      }
      return sum;
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

void read_couplings(const TomlTable& root, const SceneNames& names, Scene& scene) {
  const CouplingReader reader(names, scene);
  for (const CouplingKind& kind : coupling_kinds()) {
    const std::vector<TomlTable> tables = root.tables(kind.table);
    // Forces of stops, couplings and joints are told by their names.
    NameLines taken;
    for (const Joint& joint : scene.joints) taken.emplace(joint.name, joint.line);
    for (const Stop& stop : scene.stops) taken.emplace(stop.name, stop.line);
    const std::vector<std::string> item_names = names_of(tables, numbered(kind.table, tables.size()), std::move(taken));
    for (std::size_t i = 0; i < tables.size(); ++i) {
      if (stretches(kind, tables[i])) {
        Element rope = reader.read_stretching_rope(tables[i]);
        rope.name = item_names[i];
        rope.line = tables[i].place().line;
        scene.elements.push_back(std::move(rope));
        continue;
      }
      Stop stop = reader.read(kind, tables[i]);
      stop.name = item_names[i];
      stop.line = tables[i].place().line;
      scene.stops.push_back(std::move(stop));
    }
  }
}

void set_values_from_start(const TomlTable& root, Scene& scene) {
  for (const CouplingKind& kind : coupling_kinds()) {
    const std::vector<TomlTable> tables = root.tables(kind.table);
    std::vector<const TomlTable*> given;
    for (const TomlTable& table : tables) {
      if (!stretches(kind, table)) given.push_back(&table);
    }
    std::size_t next = 0;
    for (Stop& stop : scene.stops) {
      if (stop.table != kind.table) continue;
      const TomlTable& table = *given.at(next++);
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
    }
  }
}

}  // namespace poise
