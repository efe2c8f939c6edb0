#include "model/couplings.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "model/curved_slots.hpp"
#include "model/indexed_key.hpp"
#include "model/one_line.hpp"
#include "model/rolling_profile.hpp"

namespace poise {
namespace {

using Of = CouplingPart::Of;

// The half of what a stop leaves between two finite limits, as the backlash of a gear; 0 where it holds its measure, or
// its limits are not known yet.
double half_play(const Stop& stop) {
  return std::isfinite(stop.min) && stop.max > stop.min && std::isfinite(stop.max) ? 0.5 * (stop.max - stop.min) : 0.0;
}

// The limit that is given, or both, or what is in the middle of them.
constexpr Number value_number(std::string_view key) {
  Number number{key, {}, Range::finite};
  number.measure_power = 1;
  number.range_of_measure = true;
  number.get = [](const void* item) {
    const Stop& stop = *static_cast<const Stop*>(item);
    return std::optional<double>(std::isfinite(stop.min) ? stop.min + half_play(stop) : stop.max);
  };
  number.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    const double half = half_play(stop);
    // Not a number where it is not known yet.
    if (!std::isinf(stop.max)) stop.max = value + half;
    if (!std::isinf(stop.min)) stop.min = value - half;
  };
  number.scale = [](void* item, double factor) {
    Stop& stop = *static_cast<Stop*>(item);
    stop.min *= factor;
    stop.max *= factor;
  };
  return number;
}

// A scene file must give it.
constexpr Number needed(Number number) {
  number.needed = Number::Needed::always;
  return number;
}

// Factors and shifts are scaled with their measures (scale() of a scene).
constexpr Number with_measure(Number number) {
  number.scale = [](void*, double) {};
  return number;
}

template <int Term>
constexpr Number factor_number(std::string_view key, Dimension dimension, Range range) {
  Number number{key, dimension, range};
  number.get = [](const void* item) {
    const Stop& stop = *static_cast<const Stop*>(item);
    return std::optional<double>(stop.sense * stop.on.terms[Term].factor);
  };
  number.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    stop.on.terms[Term].factor = stop.sense * value;
  };
  return with_measure(number);
}

template <int Term>
constexpr Number shift_number(std::string_view key, Dimension dimension) {
  Number number{key, dimension, Range::finite};
  number.get = [](const void* item) {
    return std::optional<double>(static_cast<const Stop*>(item)->on.terms[Term].shift);
  };
  number.set = [](void* item, double value) { static_cast<Stop*>(item)->on.terms[Term].shift = value; };
  return with_measure(number);
}

// Of teeth whose contact force the scene gives the direction of.
constexpr Number pressure_number() {
  Number number{"pressure_angle", dimension::angle, Range::not_negative};
  number.get = [](const void* item) -> std::optional<double> {
    const std::optional<double>& tangent = static_cast<const Stop*>(item)->pressure_tangent;
    if (!tangent) return std::nullopt;
    return std::atan(*tangent);
  };
  number.set = [](void* item, double value) {
    if (value >= M_PI / 4) throw InputError("expected a pressure angle of less than 45 degrees, of most gears 20");
    static_cast<Stop*>(item)->pressure_tangent = std::tan(value);
  };
  number.scale = [](void*, double) {};
  return number;
}

// What teeth, or a pin in its slot, have room for: between limits on both sides of a value.
constexpr Number play_number(std::string_view key) {
  Number number{key, {}, Range::positive};
  number.measure_power = 1;
  number.get = [](const void* item) {
    const Stop& stop = *static_cast<const Stop*>(item);
    return stop.holds() ? std::nullopt : std::optional<double>(2.0 * half_play(stop));
  };
  number.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    const double middle = stop.min + half_play(stop);
    stop.min = middle - 0.5 * value;
    stop.max = middle + 0.5 * value;
  };
  number.scale = [](void*, double) {};  // the value in the middle scales both limits
  return number;
}

constexpr std::array<Number, 2> belt_numbers{needed(factor_number<1>("ratio", dimension::none, Range::positive)),
                                             value_number("phase")};
constexpr std::array<Number, 4> gear_numbers{belt_numbers[0], belt_numbers[1], pressure_number(),
                                             play_number("backlash")};
constexpr std::array<Number, 4> rack_numbers{needed(factor_number<1>("radius", dimension::length, Range::finite)),
                                             value_number("offset"), pressure_number(), play_number("backlash")};
constexpr std::array<CouplingPart, 4> factor_and_backlash{
    CouplingPart{Of::factor, 1, 0, 1.0, true}, CouplingPart{Of::value, 0, 1}, CouplingPart{Of::lower, 0, 3, -0.5},
    CouplingPart{Of::upper, 0, 3, 0.5}};
constexpr std::array<CouplingPart, 2> factor_and_value{CouplingPart{Of::factor, 1, 0, 1.0, true},
                                                       CouplingPart{Of::value, 0, 1}};

constexpr auto share_keys = indexed_keys<most_curve_points>("curve");
constexpr auto x_keys = indexed_keys<most_curve_points>("curve", "x");
constexpr auto y_keys = indexed_keys<most_curve_points>("curve", "y");

// A component of a point of a cam's curve, or of that of a slot or a profile that rolls.
template <std::size_t Point, bool is_cam, bool is_y>
constexpr Number point_number() {
  Number number{(is_cam ? share_keys
                 : is_y ? y_keys
                        : x_keys)[Point]
                    .view(),
                is_cam ? dimension::none : dimension::length, Range::finite};
  number.get = [](const void* item) {
    const Vec2& point = static_cast<const Stop*>(item)->curve[Point];
    return std::optional<double>(is_y ? point.y : point.x);
  };
  number.set = [](void* item, double value) {
    Stop* const rows = static_cast<Stop*>(item);
    (is_y ? rows->curve[Point].y : rows->curve[Point].x) = value;
    if (is_cam && Point == 0) rows->curve.back().y = value;
    follow_curve(rows);
  };
  number.scale = [](void* item, double factor) {
    if (is_cam) return;
    Vec2& point = static_cast<Stop*>(item)->curve[Point];
    (is_y ? point.y : point.x) *= factor;  // profiles have their measures scaled
  };
  return number;
}

constexpr int cam_numbers_before = 5;
constexpr auto cam_numbers = []<std::size_t... Point>(std::index_sequence<Point...>) {
  Number lift = needed(factor_number<1>("lift", {}, Range::finite));
  lift.measure_power = 1;
  return std::array<Number, cam_numbers_before + most_curve_points>{lift,
                                                                    shift_number<1>("phase", dimension::angle),
                                                                    value_number("base"),
                                                                    Stop::restitution_number(),
                                                                    Stop::friction_number(),
                                                                    point_number<Point, true, true>()...};
}
(std::make_index_sequence<most_curve_points>());
constexpr std::array<CouplingPart, 3> cam_parts{CouplingPart{Of::factor, 1, 0, 1.0, true},
                                                CouplingPart{Of::shift, 1, 1}, CouplingPart{Of::value, 0, 2}};

constexpr std::array<Number, 2> geneva_numbers{shift_number<1>("phase", dimension::angle), value_number("offset")};
constexpr std::array<CouplingPart, 2> geneva_parts{CouplingPart{Of::shift, 1, 0}, CouplingPart{Of::value, 0, 1}};

constexpr std::array<Number, 1> coupling_numbers{value_number("value")};
constexpr Number positive_value(std::string_view key) {
  Number length = needed(value_number(key));
  length.range = Range::positive;
  length.range_of_measure = false;
  return length;
}
constexpr std::array<Number, 2> rope_numbers{positive_value("length"), Stop::restitution_number()};

// Of the three stops of a chain. The radii are factors of the first; in the second, what its measure is held at.
// A scene whose numbers are scaled has that value scaled once, with the first of them.
template <int Term>
constexpr Number radius_number(std::string_view key) {
  Number radius = needed(factor_number<Term>(key, dimension::length, Range::positive));
  radius.get = [](const void* item) {
    return std::optional<double>(std::abs(static_cast<const Stop*>(item)->on.terms[Term].factor));
  };
  radius.set = [](void* item, double value) {
    Stop* const rows = static_cast<Stop*>(item);
    double& factor = rows[0].on.terms[Term].factor;
    factor = std::copysign(value, factor);
    const double a = rows[0].sense * std::abs(rows[0].on.terms[1].factor);
    const double b = rows[0].sense * std::abs(rows[0].on.terms[2].factor);
    rows[1].min = rows[1].max = (rows[1].table == "chain_crossed_line" ? -b : b) - a;
  };
  if (Term == 1) {
    radius.scale = [](void* item, double factor) {
      Stop& line = static_cast<Stop*>(item)[1];
      line.min *= factor;
      line.max *= factor;
    };
  }
  return radius;
}
constexpr std::array<Number, 4> chain_numbers{radius_number<1>("radius_a"), radius_number<2>("radius_b"),
                                              value_number("length"), Stop::restitution_number()};
constexpr std::array<CouplingPart, 3> chain_parts{CouplingPart{Of::factor, 1, 0, -1.0, true},
                                                  CouplingPart{Of::factor, 2, 1, 1.0, true},
                                                  CouplingPart{Of::value, 0, 2}};
constexpr std::array<CouplingPart, 2> strand_parts{CouplingPart{Of::value, 0, 1, 1.0, true},
                                                   CouplingPart{Of::value, 0, 0, -1.0, true}};
constexpr std::array<CouplingPart, 2> crossed_strand_parts{CouplingPart{Of::value, 0, 1, -1.0, true},
                                                           CouplingPart{Of::value, 0, 0, -1.0, true}};

// "friction.1" ...
constexpr std::array<std::string_view, most_rubbing_rims> rim_keys{
    "friction.1",  "friction.2",  "friction.3",  "friction.4",  "friction.5",  "friction.6",
    "friction.7",  "friction.8",  "friction.9",  "friction.10", "friction.11", "friction.12",
    "friction.13", "friction.14", "friction.15", "friction.16"};

template <std::size_t Rim>
constexpr Number rim_number() {
  Number number{rim_keys[Rim], dimension::none, Range::not_negative};
  number.get = [](const void* item) -> std::optional<double> {
    const Stop& stop = *static_cast<const Stop*>(item);
    return stop.on.contacts[static_cast<std::size_t>(rubbing_rims(stop.on)[Rim])].friction;
  };
  number.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    stop.on.contacts[static_cast<std::size_t>(rubbing_rims(stop.on)[Rim])].friction = value;
  };
  number.scale = [](void*, double) {};  // it has no dimension
  return number;
}

// A rope has behind its own numbers those of friction on its pulleys.
constexpr std::size_t rope_numbers_before = 2;
constexpr auto rubbing_rope_numbers = []<std::size_t... Rim>(std::index_sequence<Rim...>) {
  return std::array<Number, rope_numbers_before + most_rubbing_rims>{positive_value("length"),
                                                                     Stop::restitution_number(), rim_number<Rim>()...};
}
(std::make_index_sequence<most_rubbing_rims>());

constexpr std::array<CouplingPart, 1> value_only{CouplingPart{Of::value}};

template <bool is_end>
constexpr Number end_number(std::string_view key) {
  Number number = Stop::limits[is_end ? 1 : 0];
  number.key = key;
  number.get = [](const void* item) {
    const Stop& stop = *static_cast<const Stop*>(item);
    const double at = is_end ? stop.max : stop.min;
    return std::isfinite(at) ? std::optional<double>(at) : std::nullopt;
  };
  return number;
}
constexpr int track_numbers_before = 2;
constexpr auto track_numbers = []<std::size_t... Index>(std::index_sequence<Index...>) {
  Number to = end_number<true>("to");
  to.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    Stop::limits[1].set(&stop, value);
    stop.to_end = false;
  };
  return std::array<Number, track_numbers_before + 2 * most_curve_points>{
      end_number<false>("from"), to, point_number<Index / 2, false, Index % 2 == 1>()...};
}
(std::make_index_sequence<2 * most_curve_points>());
constexpr std::array<CouplingPart, 2> track_parts{CouplingPart{Of::lower, 0, 0}, CouplingPart{Of::upper, 0, 1}};

// Of a circular slot with ends: the limits of its third stop.
template <bool is_end>
constexpr Number end_of_arc(std::string_view key) {
  Number number = Stop::limits[is_end ? 1 : 0];
  number.key = key;
  number.dimension = dimension::angle;
  number.measure_power = 0;
  number.range_of_measure = false;
  number.get = [](const void* item) {
    const Stop& ends = static_cast<const Stop*>(item)[2];
    return std::optional<double>(is_end ? ends.max : ends.min);
  };
  number.set = [](void* item, double value) {
    Stop& ends = static_cast<Stop*>(item)[2];
    const double from = is_end ? ends.min : value, to = is_end ? value : ends.max;
    if (!(from < to && to - from < 2 * M_PI)) {
      throw InputError("expected an arc from a smaller angle to a larger one, of less than a full turn");
    }
    ends.min = from;
    ends.max = to;
  };
  number.scale = [](void*, double) {};
  return number;
}
constexpr std::array<Number, 3> circle_numbers{positive_value("radius"), end_of_arc<false>("from"),
                                               end_of_arc<true>("to")};
constexpr std::array<CouplingPart, 2> arc_ends{CouplingPart{Of::lower, 0, 1}, CouplingPart{Of::upper, 0, 2}};

// Of the two stops of a rolling wheel, of which the second stands behind the first.
constexpr std::array<Number, 2> rolling_numbers{[] {
                                                  Number radius = positive_value("radius");
                                                  radius.set = [](void* item, double value) {
                                                    Stop* const rows = static_cast<Stop*>(item);
                                                    rows[0].min = rows[0].max = value;
                                                    rows[1].on.terms[1].factor = value;
                                                  };
                                                  return radius;
                                                }(),
                                                [] {
                                                  Number offset = value_number("offset");
                                                  offset.get = [](const void* item) {
                                                    return std::optional<double>(static_cast<const Stop*>(item)[1].min);
                                                  };
                                                  offset.set = [](void* item, double value) {
                                                    Stop& friction = static_cast<Stop*>(item)[1];
                                                    friction.min = friction.max = value;
                                                  };
                                                  offset.scale = [](void* item, double factor) {
                                                    Stop& friction = static_cast<Stop*>(item)[1];
                                                    friction.min *= factor;
                                                    friction.max *= factor;
                                                  };
                                                  return offset;
                                                }()};
constexpr std::array<CouplingPart, 2> friction_parts{CouplingPart{Of::factor, 1, 0}, CouplingPart{Of::value, 0, 1}};

// Of the three stops of a wheel on a circle. The radius of the wheel is the factor of its angle, what the first row's
// value is more or less than it is that of the circle.
constexpr std::array<Number, 3> circle_rolling_numbers{
    [] {
      Number radius = positive_value("radius");
      radius.get = [](const void* item) {
        return std::optional<double>(static_cast<const Stop*>(item)[1].on.terms[1].factor);
      };
      radius.set = [](void* item, double value) {
        Stop* const rows = static_cast<Stop*>(item);
        rows[1].on.terms[1].factor = value;
        rows[0].min = rows[0].max = rows[0].sense * (value - rows[1].on.terms[2].factor);
      };
      return radius;
    }(),
    [] {
      Number circle = positive_value("circle_radius");
      circle.get = [](const void* item) {
        const Stop* const rows = static_cast<const Stop*>(item);
        return std::optional<double>(-rows[0].sense * rows[1].on.terms[2].factor);
      };
      circle.set = [](void* item, double value) {
        Stop* const rows = static_cast<Stop*>(item);
        rows[1].on.terms[2].factor = -rows[0].sense * value;
        rows[0].min = rows[0].max = rows[0].sense * rows[1].on.terms[1].factor + value;
      };
      return with_measure(circle);
    }(),
    rolling_numbers[1]};
constexpr std::array<CouplingPart, 2> distance_parts{CouplingPart{Of::value, 0, 0, 1.0, true},
                                                     CouplingPart{Of::value, 0, 1}};
constexpr std::array<CouplingPart, 3> arc_parts{
    CouplingPart{Of::factor, 1, 0}, CouplingPart{Of::factor, 2, 1, -1.0, true}, CouplingPart{Of::value, 0, 2}};

// Of a profile that rolls: the limits of the stop at this place behind its first, on the travel along its curve.
template <int Row, bool is_end>
constexpr Number end_of_profile(std::string_view key) {
  Number number = Stop::limits[is_end ? 1 : 0];
  number.key = key;
  number.dimension = dimension::length;
  number.measure_power = 0;
  number.range_of_measure = false;
  number.get = [](const void* item) {
    const Stop& ends = static_cast<const Stop*>(item)[Row];
    return std::optional<double>(is_end ? ends.max : ends.min);
  };
  number.set = [](void* item, double value) {
    Stop& ends = static_cast<Stop*>(item)[Row];
    (is_end ? ends.max : ends.min) = value;  // check_curve() refuses what is not on the curve
    if (is_end) ends.to_end = false;
  };
  number.scale = [](void* item, double factor) {
    Stop& ends = static_cast<Stop*>(item)[Row];
    (is_end ? ends.max : ends.min) *= factor;
  };
  return number;
}
// With the points of the curve behind them. A closed one has no ends.
template <class... Before>
constexpr auto with_points(const Before&... before) {
  return [&]<std::size_t... Index>(std::index_sequence<Index...>) {
    return std::array<Number, sizeof...(Before) + 2 * most_curve_points>{
        before..., point_number<Index / 2, false, Index % 2 == 1>()...};
  }
  (std::make_index_sequence<2 * most_curve_points>());
}
constexpr auto closed_profile_numbers = with_points(rolling_numbers[1]);
constexpr auto profile_numbers =
    with_points(rolling_numbers[1], end_of_profile<3, false>("from"), end_of_profile<3, true>("to"));
constexpr std::array<CouplingPart, 1> profile_friction{CouplingPart{Of::value, 0, 0}};
constexpr std::array<CouplingPart, 2> profile_ends{CouplingPart{Of::lower, 0, 1}, CouplingPart{Of::upper, 0, 2}};

// On a circle, whose radius is also the factor of the angle of its contact.
constexpr Number circle_of_profile = [] {
  Number circle = positive_value("circle_radius");
  circle.set = [](void* item, double value) {
    Stop* const rows = static_cast<Stop*>(item);
    rows[0].min = rows[0].max = value;
    rows[1].on.terms[3].factor = -rows[1].sense * value;
  };
  return circle;
}();
constexpr auto closed_circle_profile_numbers = with_points(circle_of_profile, rolling_numbers[1]);
constexpr auto circle_profile_numbers =
    with_points(circle_of_profile, rolling_numbers[1], end_of_profile<4, false>("from"), end_of_profile<4, true>("to"));
constexpr std::array<CouplingPart, 2> circle_profile_friction{CouplingPart{Of::factor, 3, 0, -1.0, true},
                                                              CouplingPart{Of::value, 0, 1}};
constexpr std::array<CouplingPart, 2> circle_profile_ends{CouplingPart{Of::lower, 0, 2}, CouplingPart{Of::upper, 0, 3}};

// The stops of a contact share it.
constexpr Number contact_radius = [] {
  Number radius{"radius", dimension::length, Range::not_negative};
  radius.get = [](const void* item) { return std::optional<double>(static_cast<const Stop*>(item)->min); };
  radius.set = [](void* item, double value) {
    Stop* const rows = static_cast<Stop*>(item);
    for (int part = 0; part < rows->parts; ++part) rows[part].min = value;
  };
  radius.scale = [](void* item, double factor) {
    Stop* const rows = static_cast<Stop*>(item);
    for (int part = 0; part < rows->parts; ++part) rows[part].min *= factor;
  };
  return radius;
}();
// A number that all parts have.
template <auto Member>
constexpr Number of_all_parts(Number number) {
  number.set = [](void* item, double value) {
    Stop* const rows = static_cast<Stop*>(item);
    if (Member == &Stop::restitution) Stop::restitution_number().set(rows, value);
    for (int part = 0; part < rows->parts; ++part) rows[part].*Member = value;
  };
  return number;
}
constexpr std::array<Number, 3> contact_numbers{contact_radius,
                                                of_all_parts<&Stop::restitution>(Stop::restitution_number()),
                                                of_all_parts<&Stop::friction>(Stop::limits[3])};
constexpr std::array<CouplingPart, 1> contact_limit{CouplingPart{Of::lower}};

// A pin in a hole that is wider, and one in a slot.
constexpr std::array<Number, 2> loose_pin_numbers{positive_value("clearance"), Stop::restitution_number()};
constexpr std::array<Number, 2> loose_slot_numbers{[] {
                                                     Number clearance = needed(play_number("clearance"));
                                                     clearance.scale = value_number("clearance").scale;
                                                     return clearance;
                                                   }(),
                                                   Stop::restitution_number()};
constexpr std::array<CouplingPart, 2> play_parts{CouplingPart{Of::lower, 0, 0, -0.5},
                                                 CouplingPart{Of::upper, 0, 0, 0.5}};

constexpr auto contact_part_tables = indexed_keys<most_contact_parts>("contact_part");

// Of two curves, which have no parts.
constexpr std::array<Number, 2> curve_contact_numbers{contact_radius, Stop::restitution_number()};

constexpr std::array<CouplingKind, 35> kinds_without_parts{
    {{"gear", gear_numbers, factor_and_backlash},
     {"belt", belt_numbers, factor_and_value},
     {"rack", rack_numbers, factor_and_backlash},
     {"cam", cam_numbers, cam_parts},
     {"geneva", geneva_numbers, geneva_parts},
     {"coupling", coupling_numbers, value_only},
     {"rope", rope_numbers, value_only},
     {"chain", chain_numbers, chain_parts},
     {"chain_line", {}, strand_parts, 1},
     {"chain_crossed_line", {}, crossed_strand_parts, 1},
     {"chain_straight", {}, {}, 2},
     {"circular_slot", circle_numbers, value_only},
     {"circular_slot_line", {}, {}, 1},
     {"circular_slot_ends", {}, arc_ends, 2},
     {"curved_slot", track_numbers, track_parts},
     {"curved_slot_x", {}, {}, 1},
     {"curved_slot_y", {}, {}, 2},
     {"rolling", rolling_numbers, value_only},
     {"rolling_friction", {}, friction_parts, 1},
     {"rolling_on_circle", circle_rolling_numbers, distance_parts},
     {"rolling_on_circle_friction", {}, arc_parts, 1},
     {"rolling_on_circle_line", {}, {}, 2},
     {"rolling_profile", profile_numbers, {}},
     {"rolling_profile_friction", {}, profile_friction, 1},
     {"rolling_profile_tangent", {}, {}, 2},
     {"rolling_profile_ends", {}, profile_ends, 3},
     {"rolling_profile_on_circle", circle_profile_numbers, value_only},
     {"rolling_profile_on_circle_friction", {}, circle_profile_friction, 1},
     {"rolling_profile_on_circle_tangent", {}, {}, 2},
     {"rolling_profile_on_circle_line", {}, {}, 3},
     {"rolling_profile_on_circle_ends", {}, circle_profile_ends, 4},
     {"curve_contact", curve_contact_numbers, contact_limit},
     {"curve_contact_along", {}, {}, 1},
     {"curve_contact_tangent", {}, {}, 2},
     {"curve_contact_against_tangent", {}, {}, 3}}};
constexpr auto kinds = [] {
  std::array<CouplingKind, kinds_without_parts.size() + 3 + most_contact_parts> out{};
  std::copy(kinds_without_parts.begin(), kinds_without_parts.end(), out.begin());
  auto* next = out.data() + kinds_without_parts.size();
  *next++ = {"loose_pin", loose_pin_numbers, value_only};
  *next++ = {"loose_slot", loose_slot_numbers, play_parts};
  *next++ = {"contact", contact_numbers, contact_limit};
  for (std::size_t part = 0; part < most_contact_parts; ++part) {
    *next++ = {contact_part_tables[part].view(), {}, contact_limit, static_cast<int>(part) + 1};
  }
  return out;
}();

}  // namespace

std::span<const CouplingKind> coupling_kinds() { return kinds; }

const CouplingKind* coupling_kind(const Stop& stop) {
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const CouplingKind& kind) { return kind.table == stop.table; });
  return found == kinds.end() ? nullptr : &*found;
}

int slots_of(const Stop& geneva) { return static_cast<int>(std::lround(2 * M_PI / geneva.on.terms[1].factor)); }

bool is_contact(const Stop& stop) { return stop.table.starts_with("contact"); }

std::vector<int> rubbing_rims(const Measure& rope) {
  std::vector<int> out;
  for (std::size_t k = 0; k < rope.contacts.size(); ++k) {
    if (rope.contacts[k].friction) out.push_back(static_cast<int>(k));
  }
  return out;
}

bool is_rolling_profile(const Stop& stop) {
  return stop.table == "rolling_profile" || stop.table == "rolling_profile_on_circle";
}

namespace {

bool is_on_circle(const Stop& profile) { return profile.table == "rolling_profile_on_circle"; }

/// Of a profile that rolls: the stops before that of its ends, which a closed one has not.
int rows_before_ends(const Stop& profile) { return is_on_circle(profile) ? 4 : 3; }

/// The profiles of the curve of a profile that rolls, or InputError. Those of a scene that is scaled() have its
/// factors.
RollingProfile profiles_of(const Stop* rows) {
  const double unit = std::abs(rows[0].on.terms[1].factor);
  std::vector<Vec2> points = rows[0].curve;
  for (Vec2& point : points) point = (1 / unit) * point;
  const double least = is_on_circle(rows[0]) ? -rows[0].sense / (rows[0].min / unit) : 0.0;
  const double before = rows[2].on.terms[1].profile->at(0.0).value;
  RollingProfile out = rolling_profile_on(least, points, rows[0].closed, before);
  out.chords *= unit;
  return out;
}

void check_ends(double from, double to, double chords) {
  constexpr double rounding = 1e-12;
  if (!(from < to)) throw InputError("expected an end behind the key from; set the other one first");
  if (!(from >= 0.0 && to <= chords * (1 + rounding))) throw InputError("expected a place on the curve");
}

}  // namespace

CurveNumbers curve_numbers_of(const Stop& stop) {
  const auto points = static_cast<int>(stop.curve.size());
  CurveNumbers out;
  if (stop.table == "cam")
    out = {cam_numbers_before, std::max(points - 1, 0), 1};
  else if (stop.table == "curved_slot")
    out = {track_numbers_before, points, 2};
  else if (is_rolling_profile(stop))
    out = {(is_on_circle(stop) ? 2 : 1) + (stop.closed ? 0 : 2), points, 2};
  if (out.points > static_cast<int>(most_curve_points)) out.points = 0;
  return out;
}

void check_curve(const Stop* rows) {
  const Stop& stop = rows[0];
  const bool rolls = is_rolling_profile(stop);
  if ((stop.table != "curved_slot" && !rolls) || stop.curve.empty()) return;
  const std::vector<double> along = sums_of_chords(stop.curve, stop.closed);
  for (std::size_t k = 1; k < along.size(); ++k) {
    if (along[k] > along[k - 1]) continue;
    throw InputError(
        fmt::format("expected points that differ from those before, found points {} and {} of the curve in one place",
                    k, k == stop.curve.size() ? 1 : k + 1));
  }
  if (rolls) {
    const double chords = profiles_of(rows).chords;
    if (stop.closed) return;
    const Stop& ends = rows[rows_before_ends(stop)];
    check_ends(ends.min, ends.to_end ? chords : ends.max, chords);
    return;
  }
  if (!(stop.min < (stop.to_end ? along.back() : stop.max))) {
    throw InputError("expected a curve that ends behind where the slot begins, at its number from");
  }
}

void follow_curve(Stop* rows) {
  Stop& first = rows[0];
  if (first.table == "cam") {
    std::vector<double> u, share;
    for (const Vec2& point : first.curve) {
      u.push_back(point.x);
      share.push_back(point.y);
    }
    first.on.terms[1].profile = std::make_shared<const Profile>(Profile::spline(u, share, true));
    return;
  }
  try {
    check_curve(rows);
  } catch (const InputError&) {
    return;
  }
  if (is_rolling_profile(first)) {
    const RollingProfile now = profiles_of(rows);
    for (int row = 0; row < rows_before_ends(first); ++row) {
      for (Measure::Term& term : rows[row].on.terms) {
        if (!term.profile) continue;
        term.profile = now.of(term.profile->pieces().front().law);
        term.span = now.chords;
      }
    }
    if (first.closed) return;
    Stop& ends = rows[rows_before_ends(first)];
    if (ends.to_end) ends.max = now.chords;
    return;
  }
  std::vector<double> along = sums_of_chords(first.curve, first.closed);
  const double length = along.back();
  for (double& u : along) u /= length;
  along.back() = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    Measure::Term& term = rows[1 + axis].on.terms[1];
    std::vector<double> component;
    for (std::size_t k = 0; k < along.size(); ++k) {
      const Vec2& point = first.curve[k % first.curve.size()];
      component.push_back((axis == 0 ? point.x : point.y) / -term.factor);
    }
    term.profile = std::make_shared<const Profile>(Profile::spline(along, component, first.closed));
    term.span = length;
  }
  if (first.to_end) first.max = length;
}

namespace {

std::span<const Number> all_numbers_of(const Stop& stop) {
  if (stop.table == "cam" || stop.table == "curved_slot" || is_rolling_profile(stop)) {
    const CurveNumbers points = curve_numbers_of(stop);
    std::span<const Number> all = coupling_kind(stop)->numbers;
    if (stop.closed && stop.table != "curved_slot") {
      all = is_on_circle(stop) ? std::span<const Number>(closed_circle_profile_numbers) : closed_profile_numbers;
    }
    return all.first(static_cast<std::size_t>(points.first + points.points * points.components));
  }
  if (stop.table == "rope") {
    return std::span(rubbing_rope_numbers).first(rope_numbers_before + rubbing_rims(stop.on).size());
  }
  const CouplingKind* const kind = coupling_kind(stop);
  if (kind == nullptr) return Stop::limits;
  const bool is_full_circle = kind->table == "circular_slot" && line_of_centres(stop) < 0;
  return is_full_circle ? kind->numbers.first(1) : kind->numbers;
}

}  // namespace

// Numbers of impacts that the scene does not give are none where they stand behind all others.
std::span<const Number> Stop::numbers() const {
  std::span<const Number> out = all_numbers_of(*this);
  while (!out.empty() && (out.back().key == "restitution" || out.back().key == "friction") && !out.back().get(this)) {
    out = out.first(out.size() - 1);
  }
  return out;
}

std::optional<Measure> Stop::tangent() const {
  if (on.kind == Measure::Kind::x) return Measure::y_of(on.b);
  if (on.kind == Measure::Kind::y) return Measure::x_of(on.b);
  if (on.kind == Measure::Kind::clearance) return Measure::slip_on(on, min);
  return std::nullopt;
}

std::string Stop::family() const { return is_contact(*this) ? "contact" : words_of_key(table); }

std::string Stop::title() const { return fmt::format("{} \"{}\"", family(), name); }

}  // namespace poise
