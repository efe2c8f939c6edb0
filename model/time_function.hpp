#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "model/indexed_key.hpp"
#include "model/number.hpp"
#include "model/way.hpp"

namespace poise {

class Expression;
class RunningIntegrals;

/// c(t) = offset + amplitude sin(2 pi frequency t + phase).
struct SineInTime {
  double amplitude = 1.0;
  double frequency = 0.0;  ///< Hz
  double phase = 0.0;      ///< rad
  double offset = 0.0;

  static constexpr std::string_view key = "sine";
  static const std::array<Number, 4> numbers;
};

/// c(t) from `from` at the time start to `to` at the time end, constant before and after, between them
/// from + (to - from) P(s) with s = (t - start) / (end - start).
struct RampInTime {
  double from = 0.0, to = 1.0;
  double start = 0.0;                                    ///< s
  double end = std::numeric_limits<double>::infinity();  ///< s, after start
  Way way = Way::linear;                                 ///< P

  static constexpr std::string_view key = "ramp";
  static const std::array<Number, 4> numbers;
};

/// c(t) = from for t < at, to from then on.
struct StepInTime {
  double at = 0.0;  ///< s
  double from = 0.0, to = 1.0;

  static constexpr std::string_view key = "step";
  static const std::array<Number, 3> numbers;
};

/// Points (t, c), two or more of ascending t, and what lies between them.
struct TimeTable {
  enum class Between {
    linear,
    monotone,  ///< ForceCurve: continuous slopes, monotone wherever the points are
    spline,    ///< the natural cubic spline: continuous second derivatives
    way        ///< from point to point by `way`, so that it rests at each
  };
  std::vector<double> t, value;
  Between between = Between::linear;
  Way way = Way::linear;
  std::vector<std::array<double, 4>> pieces;  ///< from point k to the next: sum of pieces[k][j] (t - t[k])^j
};

/// A table, constant before its first point and after its last; a spline goes on along its tangents there, so that its
/// second derivative, zero at its ends, is continuous. The values and times of a list in the scene are numbers, those
/// of a file are not. Where a secant of a monotone table is zero its slopes have no derivatives by the values of the
/// two ends: the one of the side on which it stays zero is taken (ForceCurve).
struct TableInTime {
  /// As many points have numbers of their own.
  static constexpr std::size_t most_points = 64;

  std::shared_ptr<const TimeTable> table;
  /// Its derivatives at fixed times by its numbers, but by times where it goes by a way; null where it has none.
  std::shared_ptr<const std::vector<TimeTable>> by{};
  std::string file{};  ///< that it was read from, as written; empty of a list in the scene

  static constexpr std::string_view key = "table";
  /// "table.1", "table.1.t", ...: the value and the time of each point, of all that there may be.
  static const std::array<Number, 2 * most_points> numbers;
  std::span<const Number> all_numbers() const { return std::span(numbers).first(by ? by->size() : 0); }

  /// `numbered`: its values and times are numbers, if there are not more than most_points. Where times do not ascend
  /// it has no value yet (TimeFunction::set_among_others).
  static TableInTime through(std::vector<double> t, std::vector<double> value, TimeTable::Between between,
                             bool numbered, Way way = Way::linear);
  /// Sets a number: the value of a point, or its time. Throws InputError, and changes nothing, unless times ascend.
  void set(std::size_t number, double to);
  void set_among_others(std::size_t number, double to);
  /// Throws InputError unless times ascend.
  void check() const;
  /// Whether the value at the time t has a derivative by a number.
  bool has_derivative_at(std::size_t number, double t) const;
};

/// c(t) = unit f(t, n_1, n_2, ...), an expression of the time in seconds and of named numbers of the scene. The numbers
/// n_k are those of the function, each of which follows from the named one (DependentNumber).
struct FormulaInTime {
  /// As many named numbers one formula may use.
  static constexpr std::size_t most_names = 16;
  /// What the time is called in it.
  static constexpr std::string_view time_name = "t";

  std::shared_ptr<const Expression> expression;    ///< of t and `names`
  std::vector<std::string> names;                  ///< of the numbers
  std::vector<double> values;                      ///< theirs
  double unit = 1.0;                               ///< SI value of its unit
  std::shared_ptr<const std::vector<Number>> all;  ///< its numbers

  static constexpr std::string_view key = "function";
  std::span<const Number> all_numbers() const { return *all; }

  /// Throws InputError where the text is no expression of t and these names, of which those that it does not use are
  /// left out.
  static FormulaInTime of(const std::string& text, const std::vector<std::string>& names,
                          const std::vector<double>& values, double unit);
  int smoothness() const;  ///< as of TimeLaw
};

struct TimeLaw;

/// A jump of a function of time, by so much.
struct JumpInTime {
  double at = 0.0;  ///< s
  double by = 0.0;
};

/// A function made of others:
///   sum        f_1(t) + f_2(t) + ...
///   product    f_1(t) f_2(t) ..., of which the first has the dimension of the value
///   piecewise  f_k(t) from the end of the one before until its own end
///   integral   start + int_0^t f(s) ds, or start + rate t + int_0^t (t - s) f(s) ds: of a rate or an acceleration
struct ComposedInTime {
  enum class How { sum, product, piecewise, integral };
  /// As many numbers it may have, with those of its parts.
  static constexpr std::size_t most_numbers = 256;

  How how = How::sum;
  int order = 0;              ///< of an integral: 1 or 2
  std::vector<double> own{};  ///< times of the ends of pieces but the last, or start and rate
  std::vector<TimeLaw> parts;
  std::shared_ptr<const std::vector<Number>> all{};  ///< its own numbers, then those of the parts
  std::shared_ptr<const RunningIntegrals> integrals{};

  static constexpr std::string_view key = "composed";
  std::span<const Number> all_numbers() const { return *all; }

  /// Throws InputError where there are more than most_numbers.
  static ComposedInTime of(How how, std::vector<double> own, std::vector<TimeLaw> parts, int order = 0);
  /// "sum", "product", "piecewise"; of an integral that of what is integrated.
  std::string_view kind() const;
  /// Finds the part that has a number, or -1 where it is one of `own`, and its place there.
  std::pair<int, std::size_t> place_of(std::size_t number) const;
  double value(std::size_t number) const;
  /// Sets a number where others change with it, as TimeLaw::set_among_others(); set_alone() checks them.
  void set(std::size_t number, double to);
  void set_alone(std::size_t number, double to);
  void multiply(std::size_t number, double factor);
  /// These are as those of TimeLaw.
  int smoothness() const;
  std::vector<double> breaks() const;
  bool moves_break(std::size_t number) const;
  std::optional<JumpInTime> jump_by(std::size_t number) const;
  bool has_derivative_at(std::size_t number, double t) const;
  void check() const;
  void scale_tables(double factor);

 private:
  void restart();  // integrals, after a change
};

/// What a function of time is, and how it is evaluated; `near` as of TimeFunction.
struct TimeLaw : std::variant<SineInTime, RampInTime, StepInTime, TableInTime, FormulaInTime, ComposedInTime> {
  using variant::variant;

  /// How a number changes along a path of them: its index, and its first and second derivative along that.
  struct Change {
    int number = 0;
    double slope = 0.0, bend = 0.0;
  };
  std::span<const Number> numbers() const;
  std::string_view kind() const;
  double at(double t, int derivative, double near) const;
  double by(int number, double t, int derivative, double near) const;
  double bend(double t, std::span<const Change> changes) const;
  /// -1 where the value may jump, 0 where its rate may, 1 where its second derivative may, else 2.
  int smoothness() const;
  /// The jump of which the number is the time, if it is one.
  std::optional<JumpInTime> jump_by(int number) const;
  /// Whether the number is a time at which formulas meet.
  bool moves_break(int number) const;
  bool has_derivative_at(int number, double t) const;
  void set_among_others(int number, double value);
  void check() const;
  std::vector<double> breaks() const;
  void scale_table(double factor);
  /// The largest frequency of a sine in it, Hz; 0 without one.
  double frequency() const;
};

/// A function of time c(t) of one item of a scene: the factor by which it multiplies a load or a number of a spring, or
/// the value of the measure of a drive, rad or m.
///
/// Functions may be broken: at a break a formula of one side and one of the other meet, and perhaps the value jumps.
/// `near` is a time that says which formula to take, the one that holds there.
struct TimeFunction {
  /// What it is of: element, the number `part` of a spring, by which that is multiplied; frame, the acceleration of the
  /// frame of the scene along x or y, which is subtracted from gravity.
  enum class Of { force, torque, drive, element, frame };
  Of of = Of::force;
  int item = 0;  ///< index into Scene::forces, torques, drives or elements; of a frame 0
  TimeLaw law;
  int line = 0;
  int part = 0;   ///< of an element index into the numbers of its law; of a frame 0 for x, 1 for y
  int order = 0;  ///< of a frame: which derivative of the law is the acceleration

  std::span<const Number> numbers() const { return law.numbers(); }
  /// "sine", "ramp", "step", "table", "function", "sum", "product", "piecewise".
  std::string_view kind() const { return law.kind(); }
  /// The value (derivative = 0), or its first or second derivative by time; not a number where a formula has none.
  double at(double t, int derivative, double near) const { return law.at(t, derivative, near); }
  double at(double t, int derivative) const { return at(t, derivative, t); }
  double at(double t) const { return at(t, 0, t); }
  /// The derivative of at(t, derivative, near) by numbers()[number]; of is_smooth_in() numbers.
  double by(int number, double t, int derivative, double near) const {
    if (number == whole) return derivative == 0 ? 1.0 : 0.0;
    return law.by(number, t, derivative, near);
  }
  /// Stands for the value itself where the number of a function is asked for.
  static constexpr int whole = 1 << 20;
  using Change = TimeLaw::Change;
  /// The second derivative of the value at the time t along such a path of the numbers that change; not a number where
  /// it has none, also at the time t of an inner point of a monotone table that is moved.
  double bend(double t, std::span<const Change> changes) const { return law.bend(t, changes); }
  /// Whether motions have a derivative by the number: not by the time at which a load jumps, or the acceleration of a
  /// drive, where their rates have one that jumps too. Elsewhere the value has one at all times but single ones.
  bool is_smooth_in(int number) const;
  /// Whether the value at the time t has one, so that by() is it: not by the time t of a kink.
  bool has_derivative_at(int number, double t) const { return law.has_derivative_at(number, t); }
  /// Sets a number where others of the function change with it, so that they may contradict each other until all are
  /// set; check() throws InputError if they do then, or if a drive would jump.
  void set_among_others(int number, double value) { law.set_among_others(number, value); }
  void check() const;
  /// Times at which formulas meet, ascending.
  std::vector<double> breaks() const { return law.breaks(); }
  /// Whether the value, or of a frame the acceleration, may jump at its breaks.
  bool jumps() const { return law.smoothness() < order; }
  /// Multiplies the values by a factor, exactly for a power of two, with the derivatives by times; numbers of other
  /// functions are not touched.
  void scale_table(double factor) { law.scale_table(factor); }
};

inline constexpr std::array<Number, 4> SineInTime::numbers = [] {
  const auto of_value = [](Number number) {
    number.measure_power = 1;
    return number;
  };
  std::array all{of_value(plain_number<&SineInTime::amplitude>("amplitude", {})),
                 plain_number<&SineInTime::frequency>("frequency", dimension::time.power(-1), Range::not_negative),
                 plain_number<&SineInTime::phase>("phase", dimension::angle),
                 of_value(plain_number<&SineInTime::offset>("offset", {}))};
  all[0].needed = all[1].needed = Number::Needed::always;
  return all;
}();

namespace detail {

/// Sets one end of the time that a ramp takes. Throws InputError unless it starts before it ends.
void set_ramp_time(RampInTime& ramp, double RampInTime::*time, double value);

}  // namespace detail

inline constexpr std::array<Number, 4> RampInTime::numbers = [] {
  std::array all{plain_number<&RampInTime::from>("from", {}), plain_number<&RampInTime::to>("to", {}),
                 plain_number<&RampInTime::start>("start", dimension::time),
                 plain_number<&RampInTime::end>("end", dimension::time)};
  all[0].measure_power = all[1].measure_power = 1;
  all[1].needed = all[3].needed = Number::Needed::always;
  all[2].set = [](void* item, double value) {
    detail::set_ramp_time(*static_cast<RampInTime*>(item), &RampInTime::start, value);
  };
  all[3].set = [](void* item, double value) {
    detail::set_ramp_time(*static_cast<RampInTime*>(item), &RampInTime::end, value);
  };
  return all;
}();

inline constexpr std::array<Number, 3> StepInTime::numbers = [] {
  std::array all{plain_number<&StepInTime::at>("at", dimension::time), plain_number<&StepInTime::from>("from", {}),
                 plain_number<&StepInTime::to>("to", {})};
  all[1].measure_power = all[2].measure_power = 1;
  all[2].needed = Number::Needed::always;
  return all;
}();

namespace detail {

inline constexpr auto table_keys = indexed_keys<TableInTime::most_points>("table");

inline constexpr auto table_time_keys = indexed_keys<TableInTime::most_points>("table", "t");

template <std::size_t Index>
constexpr Number number_of_table() {
  constexpr std::size_t point = Index / 2;
  constexpr bool is_time = Index % 2 == 1;
  Number number{is_time ? table_time_keys[point].view() : table_keys[point].view(),
                is_time ? dimension::time : dimension::none, Range::finite};
  number.measure_power = is_time ? 0 : 1;
  number.get = [](const void* item) {
    const TimeTable& table = *static_cast<const TableInTime*>(item)->table;
    return std::optional<double>(is_time ? table.t[point] : table.value[point]);
  };
  number.set = [](void* item, double to) { static_cast<TableInTime*>(item)->set(Index, to); };
  number.scale = [](void*, double) {};  // by TimeFunction::scale_table, with the whole table
  return number;
}

template <std::size_t... Index>
constexpr std::array<Number, sizeof...(Index)> numbers_of_table(std::index_sequence<Index...>) {
  return {number_of_table<Index>()...};
}

}  // namespace detail

inline constexpr std::array<Number, 2 * TableInTime::most_points> TableInTime::numbers =
    detail::numbers_of_table(std::make_index_sequence<2 * TableInTime::most_points>());

/// A text that stays, for keys of numbers, which are views.
std::string_view lasting_text(std::string text);

/// A load, or a number of a spring, whose function of time was replaced by its value at one time.
struct HeldLoad {
  std::string name;
  std::string_view kind;  ///< TimeFunction::kind()
  double time = 0.0;      ///< s
  double factor = 1.0;    ///< c(time), by which the load was multiplied
};

struct Scene;

/// The scene at a time t, s: loads and numbers of springs times c(t) in place of functions of time, which it lists as
/// held; gravity less the acceleration of the frame; drives with the value, rate and acceleration of theirs. Loads
/// still follow named numbers, also by those of c(t) (HeldFactor).
Scene at_time(Scene scene, double t);

/// The same of drives alone, whose functions stay.
void start_drives_at(Scene& scene, double t);

/// Leaves functions to loads only, where others take the place of the scene's drives.
void forget_functions_of_drives(Scene& scene);

/// The name of the load, drive or spring that a function of the scene is of; of a frame "x" or "y".
std::string_view name_of(const Scene& scene, const TimeFunction& function);

}  // namespace poise
