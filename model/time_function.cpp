#include "model/time_function.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <type_traits>
#include <utility>

#include <ceres/jet.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/laws/force_curve.hpp"
#include "model/scene.hpp"
#include "model/second_dual.hpp"
#include "model/spline.hpp"
#include "model/time_law.hpp"

namespace poise {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

double sine_derivative(double turn, int derivative) {
  return derivative == 0 ? std::sin(turn) : derivative == 1 ? std::cos(turn) : -std::sin(turn);
}

/// c(t) where the numbers of the law, in their order, are these: scalars S, which may carry derivatives.
template <class S>
S value_with(const SineInTime&, std::span<const S> numbers, double t, double) {
  using std::sin;
  return numbers[3] + numbers[0] * sin(S(two_pi) * numbers[1] * S(t) + numbers[2]);
}

double value_of(const SineInTime& sine, double t, int derivative, double near) {
  if (derivative == 0) {
    return value_with<double>(sine, std::array{sine.amplitude, sine.frequency, sine.phase, sine.offset}, t, near);
  }
  const double omega = two_pi * sine.frequency;
  return sine.amplitude * std::pow(omega, derivative) * sine_derivative(omega * t + sine.phase, derivative);
}

double value_by(const SineInTime& sine, int number, double t, int derivative, double) {
  const double omega = two_pi * sine.frequency;
  const double turn = omega * t + sine.phase;
  const double by_turn = sine_derivative(turn + std::numbers::pi / 2, derivative);
  const double power = std::pow(omega, derivative);
  switch (number) {
    case 0:
      return power * sine_derivative(turn, derivative);
    case 1: {
      const double by_power =
          derivative == 0 ? 0.0 : derivative * std::pow(omega, derivative - 1) * sine_derivative(turn, derivative);
      return two_pi * sine.amplitude * (by_power + power * t * by_turn);
    }
    case 2:
      return sine.amplitude * power * by_turn;
    default:
      return derivative == 0 ? 1.0 : 0.0;
  }
}

template <class S>
S value_with(const RampInTime& ramp, std::span<const S> numbers, double t, double near) {
  const S &from = numbers[0], &to = numbers[1], &start = numbers[2], &end = numbers[3];
  if (near < ramp.start) return from;
  if (near >= ramp.end) return to;
  const S s = (S(t) - start) / (end - start);
  return from + (to - from) * along_way(ramp.way, s, 0, (near - ramp.start) / (ramp.end - ramp.start));
}

double value_of(const RampInTime& ramp, double t, int derivative, double near) {
  if (derivative == 0) return value_with<double>(ramp, std::array{ramp.from, ramp.to, ramp.start, ramp.end}, t, near);
  if (near < ramp.start || near >= ramp.end) return 0.0;
  const double takes = ramp.end - ramp.start;
  const double s = (t - ramp.start) / takes;
  return (ramp.to - ramp.from) * along_way(ramp.way, s, derivative, (near - ramp.start) / takes) /
         std::pow(takes, derivative);
}

/// The derivative of  from + (to - from) P(s)  by a number of the ramp, in the order of RampInTime.
double value_by(const RampInTime& ramp, int number, double t, int derivative, double near) {
  const bool before = near < ramp.start, after = near >= ramp.end;
  const double held = derivative == 0 ? 1.0 : 0.0;
  if (before || after) return number == (before ? 0 : 1) ? held : 0.0;
  const double takes = ramp.end - ramp.start;
  const double s = (t - ramp.start) / takes, s_near = (near - ramp.start) / takes;
  const double power = std::pow(takes, -derivative);
  const double way_here = along_way(ramp.way, s, derivative, s_near) * power;
  if (number == 0) return held - way_here;
  if (number == 1) return way_here;
  // s = (t - start)/(end - start) and the power of end - start change.
  const double by_takes = number == 2 ? -1.0 : 1.0;
  const double s_by = number == 2 ? (s - 1) / takes : -s / takes;
  return (ramp.to - ramp.from) *
         (along_way(ramp.way, s, derivative + 1, s_near) * s_by * power - derivative * by_takes * way_here / takes);
}

template <class S>
S value_with(const StepInTime& step, std::span<const S> numbers, double, double near) {
  return numbers[near < step.at ? 1 : 2];
}

double value_of(const StepInTime& step, double t, int derivative, double near) {
  return derivative > 0 ? 0.0 : value_with<double>(step, std::array{step.at, step.from, step.to}, t, near);
}

double value_by(const StepInTime& step, int number, double, int derivative, double near) {
  if (derivative > 0 || number == 0) return 0.0;
  return (number == 1) == (near < step.at) ? 1.0 : 0.0;
}

/// Whether a table stays at the value of its first point, or of its last one.
bool is_held(const TimeTable& table, double near) {
  return table.between != TimeTable::Between::spline && (near < table.t.front() || near >= table.t.back());
}

/// From the point k to the next.
RampInTime ramp_from(const TimeTable& table, std::size_t k) {
  return {table.value[k], table.value[k + 1], table.t[k], table.t[k + 1], table.way};
}

/// The point of a table before `near`; of a time after the last one the last but one.
std::size_t point_before(const TimeTable& table, double near) {
  const auto next = std::upper_bound(table.t.begin() + 1, table.t.end() - 1, near);
  return static_cast<std::size_t>(next - table.t.begin()) - 1;
}

/// A place in a table: u behind the beginning of a piece, and from there on along the tangent.
template <class S>
struct TablePlace {
  std::size_t piece;
  S u, beyond;
};

/// The place of the time t where the points have the times `times`.
template <class S>
TablePlace<S> place_in(const TimeTable& table, const std::vector<S>& times, double t, double near) {
  const std::size_t k = point_before(table, near);
  if (near < table.t.front()) return {k, S(0), S(t) - times[k]};
  if (near >= table.t.back()) return {k, times.back() - times[k], S(t) - times.back()};
  return {k, S(t) - times[k], S(0)};
}

template <class S>
S slope_in(const std::array<S, 4>& c, const S& u) {
  return c[1] + u * (S(2) * c[2] + u * S(3) * c[3]);
}

template <class S>
S value_in(const std::array<S, 4>& c, const TablePlace<S>& at) {
  return c[0] + at.u * (c[1] + at.u * (c[2] + at.u * c[3])) + slope_in(c, at.u) * at.beyond;
}

double value_of(const TimeTable& table, double t, int derivative, double near) {
  const bool before = near < table.t.front(), after = near >= table.t.back();
  if (is_held(table, near)) return derivative > 0 ? 0.0 : before ? table.value.front() : table.value.back();
  if (table.between == TimeTable::Between::way) {
    return value_of(ramp_from(table, point_before(table, near)), t, derivative, near);
  }
  const TablePlace<double> place = place_in(table, table.t, t, near);
  const std::array<double, 4>& c = table.pieces[place.piece];
  if (derivative == 0) return value_in(c, place);
  if (derivative == 1) return slope_in(c, place.u);
  return before || after ? 0.0 : 2 * c[2] + 6 * c[3] * place.u;
}

double value_of(const TableInTime& of, double t, int derivative, double near) {
  return value_of(*of.table, t, derivative, near);
}

double value_by(const TableInTime& of, int number, double t, int derivative, double near) {
  const TimeTable& table = *of.table;
  if (table.between == TimeTable::Between::way && number % 2 == 1) {
    if (is_held(table, near)) return 0.0;
    const auto point = static_cast<std::size_t>(number / 2), k = point_before(table, near);
    if (point != k && point != k + 1) return 0.0;
    return value_by(ramp_from(table, k), point == k ? 2 : 3, t, derivative, near);
  }
  return value_of((*of.by)[static_cast<std::size_t>(number)], t, derivative, near);
}

std::vector<double> breaks_of(const SineInTime&) { return {}; }
std::vector<double> breaks_of(const RampInTime& ramp) {
  std::vector<double> out{ramp.start};
  for (const double s : meetings_of(ramp.way)) out.push_back(ramp.start + s * (ramp.end - ramp.start));
  out.push_back(ramp.end);
  return out;
}
std::vector<double> breaks_of(const StepInTime& step) { return {step.at}; }
std::vector<double> breaks_of(const TableInTime& of) {
  const TimeTable& table = *of.table;
  if (table.between != TimeTable::Between::way) return table.t;
  std::vector<double> out{table.t.front()};
  for (std::size_t k = 0; k + 1 < table.t.size(); ++k) {
    const std::vector<double> of_ramp = breaks_of(ramp_from(table, k));
    out.insert(out.end(), of_ramp.begin() + 1, of_ramp.end());
  }
  return out;
}
std::vector<double> breaks_of(const FormulaInTime&) { return {}; }
std::vector<double> breaks_of(const ComposedInTime& of) { return of.breaks(); }

bool ascends(const std::vector<double>& t) {
  return std::adjacent_find(t.begin(), t.end(), [](double a, double b) { return !(a < b); }) == t.end();
}

bool is_linear(const TimeTable& table) { return table.between == TimeTable::Between::linear || table.t.size() == 2; }

/// The slopes at the points, of which a cubic on each piece follows; none of lines.
template <class T>
std::vector<T> slopes_of(const TimeTable& table, const std::vector<T>& t, const std::vector<T>& value) {
  std::vector<T> slopes;
  if (is_linear(table)) return slopes;
  if (table.between == TimeTable::Between::monotone) {
    const CurveThrough<T, T> curve(t, value.data());
    for (std::size_t k = 0; k < t.size(); ++k) slopes.push_back(curve.template slope_at<T>(k));
  } else {
    const Spline<T> curve(t, value, false);
    for (const T& one : t) slopes.push_back(curve.at(one).first);
  }
  return slopes;
}

/// The cubic of the piece between the points k and k + 1, with the slopes there, if any: of a line.
template <class T>
std::array<T, 4> piece_of(std::size_t k, const std::vector<T>& t, const std::vector<T>& value,
                          const std::vector<T>& slopes) {
  const T h = t[k + 1] - t[k];
  const T secant = T(value[k + 1] - value[k]) / h;
  if (slopes.empty()) return {value[k], secant, T(0), T(0)};
  const T &a = slopes[k], &b = slopes[k + 1];
  return {value[k], a, T((T(3) * secant - T(2) * a - b) / h), T((a + b - T(2) * secant) / (h * h))};
}

void make_pieces(TimeTable& table) {
  if (table.between == TimeTable::Between::way) return;
  const std::vector<double> slopes = slopes_of(table, table.t, table.value);
  for (std::size_t k = 0; k + 1 < table.t.size(); ++k) {
    table.pieces.push_back(piece_of(k, table.t, table.value, slopes));
  }
}

template <class S>
S value_with(const TableInTime& of, std::span<const S> numbers, double t, double near) {
  const TimeTable& table = *of.table;
  std::vector<S> times, values;
  for (std::size_t k = 0; k < table.t.size(); ++k) {
    values.push_back(numbers[2 * k]);
    times.push_back(numbers[2 * k + 1]);
  }
  if (is_held(table, near)) return near < table.t.front() ? values.front() : values.back();
  if (table.between == TimeTable::Between::way) {
    const std::size_t k = point_before(table, near);
    return value_with<S>(ramp_from(table, k), std::array{values[k], values[k + 1], times[k], times[k + 1]}, t, near);
  }
  const TablePlace<S> place = place_in(table, times, t, near);
  return value_in(piece_of(place.piece, times, values, slopes_of(table, times, values)), place);
}

/// The derivative by the value of one point, which a linear table and a spline have as the table of 1 there and 0 at
/// all others.
TimeTable derivative_by(const TimeTable& table, std::size_t point) {
  TimeTable out{table.t, std::vector<double>(table.t.size(), 0.0), table.between, table.way, {}};
  out.value[point] = 1.0;
  if (table.between != TimeTable::Between::monotone || table.t.size() == 2) {
    make_pieces(out);
    return out;
  }
  const ForceCurve curve(table.t, table.value);
  for (std::size_t k = 0; k + 1 < table.t.size(); ++k) out.pieces.push_back(curve.cubic_by(k, point));
  return out;
}

/// The derivative by the time of one point. In a piece from t_k on, with u = t - t_k,
///   d/dp sum_j c_j u^j = sum_j (dc_j/dp) u^j - (dt_k/dp) sum_j j c_j u^(j - 1).
TimeTable derivative_by_time(const TimeTable& table, std::size_t point) {
  using Dual = ceres::Jet<double, 1>;
  std::vector<Dual> t(table.t.begin(), table.t.end());
  const std::vector<Dual> value(table.value.begin(), table.value.end());
  t[point].v[0] = 1.0;
  const std::vector<Dual> slopes = slopes_of(table, t, value);
  TimeTable out{table.t, std::vector<double>(table.t.size(), 0.0), table.between, table.way, {}};
  if (table.between == TimeTable::Between::way) return out;
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    const std::array<Dual, 4> c = piece_of(k, t, value, slopes);
    std::array<double, 4>& by = out.pieces.emplace_back();
    for (std::size_t j = 0; j < 4; ++j) {
      by[j] = c[j].v[0] - (k == point && j < 3 ? static_cast<double>(j + 1) * c[j + 1].a : 0.0);
    }
  }
  return out;
}

/// Whether the second derivative by a number jumps at t: by a time at which formulas meet of which only the first
/// derivatives agree.
bool bends_at_time_of(const TimeLaw& law, int number, double t) {
  if (!law.moves_break(number) || law.smoothness() > 1) return false;
  if (const auto* const of = std::get_if<TableInTime>(&law)) {
    const TimeTable& table = *of->table;
    const auto point = static_cast<std::size_t>(number / 2);
    if (table.between == TimeTable::Between::monotone) return t == table.t[point];
    if (table.between != TimeTable::Between::way) return false;
  } else if (!std::holds_alternative<RampInTime>(law) && !std::holds_alternative<ComposedInTime>(law)) {
    return false;
  }
  const std::vector<double> breaks = law.breaks();
  return std::find(breaks.begin(), breaks.end(), t) != breaks.end();
}

void expect_time(const RampInTime& ramp) {
  if (!(ramp.start < ramp.end)) {
    throw InputError("expected a ramp that starts before it ends; change start or end");
  }
}

}  // namespace

void detail::set_ramp_time(RampInTime& ramp, double RampInTime::*time, double value) {
  RampInTime changed = ramp;
  changed.*time = value;
  expect_time(changed);
  ramp = changed;
}

TableInTime TableInTime::through(std::vector<double> t, std::vector<double> value, TimeTable::Between between,
                                 bool numbered, Way way) {
  TimeTable table{std::move(t), std::move(value), between, way, {}};
  const bool is_known = ascends(table.t);
  if (is_known) make_pieces(table);
  TableInTime out{std::make_shared<const TimeTable>(std::move(table))};
  if (!numbered || out.table->t.size() > most_points) return out;
  std::vector<TimeTable> by(is_known ? 0 : 2 * out.table->t.size());
  for (std::size_t k = 0; is_known && k < out.table->t.size(); ++k) {
    by.push_back(derivative_by(*out.table, k));
    by.push_back(derivative_by_time(*out.table, k));
  }
  out.by = std::make_shared<const std::vector<TimeTable>>(std::move(by));
  return out;
}

void TableInTime::set(std::size_t number, double to) {
  TableInTime changed = *this;
  changed.set_among_others(number, to);
  changed.check();
  *this = std::move(changed);
}

void TableInTime::set_among_others(std::size_t number, double to) {
  std::vector<double> t = table->t, value = table->value;
  double& own = (number % 2 == 1 ? t : value)[number / 2];
  if (own == to) return;
  own = to;
  TableInTime other = through(std::move(t), std::move(value), table->between, by != nullptr, table->way);
  other.file = std::move(file);
  *this = std::move(other);
}

void TableInTime::check() const {
  if (!ascends(table->t)) {
    throw InputError("expected times of points that ascend; keep each between those beside it");
  }
}

bool TableInTime::has_derivative_at(std::size_t number, double t) const {
  const std::size_t point = number / 2, last = table->t.size() - 1;
  if (number % 2 == 0) {
    return table->between != TimeTable::Between::monotone ||
           ForceCurve(table->t, table->value).has_derivatives_by(point);
  }
  if (t != table->t[point] || table->between == TimeTable::Between::spline) return true;
  if (table->between == TimeTable::Between::way) return true;
  // Slopes of monotone tables are continuous, but at the ends.
  if (table->between == TimeTable::Between::monotone && point > 0 && point < last) return true;
  const double before = std::nextafter(t, -std::numeric_limits<double>::infinity());
  return value_of(*table, t, 1, before) == value_of(*table, t, 1, t);
}

std::span<const Number> TimeLaw::numbers() const {
  return std::visit(
      []<class L>(const L& l) {
        if constexpr (requires { l.all_numbers(); })
          return l.all_numbers();
        else
          return std::span<const Number>(L::numbers);
      },
      *this);
}

void TimeLaw::set_among_others(int number, double value) {
  if (auto* const ramp = std::get_if<RampInTime>(this); ramp != nullptr && number >= 2) {
    (number == 2 ? ramp->start : ramp->end) = value;
    return;
  }
  if (auto* const table = std::get_if<TableInTime>(this)) {
    table->set_among_others(static_cast<std::size_t>(number), value);
    return;
  }
  if (auto* const composed = std::get_if<ComposedInTime>(this)) {
    composed->set(static_cast<std::size_t>(number), value);
    return;
  }
  std::visit([&](auto& l) { numbers()[static_cast<std::size_t>(number)].set(&l, value); }, *this);
}

void TimeLaw::check() const {
  if (const auto* const ramp = std::get_if<RampInTime>(this)) expect_time(*ramp);
  if (const auto* const table = std::get_if<TableInTime>(this)) table->check();
  if (const auto* const composed = std::get_if<ComposedInTime>(this)) composed->check();
}

std::string_view TimeLaw::kind() const {
  if (const auto* const composed = std::get_if<ComposedInTime>(this)) return composed->kind();
  return std::visit([]<class L>(const L&) { return L::key; }, *this);
}

double TimeLaw::at(double t, int derivative, double near) const {
  return std::visit([&](const auto& l) { return value_of(l, t, derivative, near); }, *this);
}

double TimeLaw::by(int number, double t, int derivative, double near) const {
  return std::visit([&](const auto& l) { return value_by(l, number, t, derivative, near); }, *this);
}

SecondDual value_with(const TimeLaw& law, std::span<const SecondDual> numbers, double t, double near) {
  return std::visit(
      [&]<class L>(const L& l) {
        if constexpr (std::is_same_v<L, FormulaInTime> || std::is_same_v<L, ComposedInTime>)
          return value_with(l, numbers, t, near);
        else
          return value_with<SecondDual>(l, numbers, t, near);
      },
      law);
}

double TimeLaw::bend(double t, std::span<const Change> changes) const {
  std::vector<SecondDual> all;
  std::visit(
      [&](const auto& l) {
        for (const Number& number : numbers()) all.emplace_back(number.get(&l).value());
      },
      *this);
  for (const Change& change : changes) {
    const bool changes_time = change.slope != 0.0 && bends_at_time_of(*this, change.number, t);
    if (changes_time || !has_derivative_at(change.number, t)) return std::numeric_limits<double>::quiet_NaN();
    SecondDual& own = all[static_cast<std::size_t>(change.number)];
    own = second_dual(own.derivative(0, 0), change.slope, change.slope, change.bend);
  }
  // Both variables are the same path, by which c is differentiated twice.
  return value_with(*this, all, t, t).derivative(1, 1);
}

int TimeLaw::smoothness() const {
  return std::visit(
      []<class L>(const L& l) {
        if constexpr (std::is_same_v<L, RampInTime>) return smoothness_of(l.way);
        if constexpr (std::is_same_v<L, StepInTime>) return -1;
        if constexpr (std::is_same_v<L, TableInTime>) {
          switch (l.table->between) {
            case TimeTable::Between::linear:
            case TimeTable::Between::monotone:  // of which the ends are kinks
              return 0;
            case TimeTable::Between::spline:
              return 2;
            case TimeTable::Between::way:
              return smoothness_of(l.table->way);
          }
        }
        if constexpr (requires { l.smoothness(); }) return l.smoothness();
        return 2;
      },
      *this);
}

bool TimeLaw::moves_break(int number) const {
  if (std::holds_alternative<RampInTime>(*this)) return number >= 2;
  if (std::holds_alternative<StepInTime>(*this)) return number == 0;
  if (std::holds_alternative<TableInTime>(*this)) return number % 2 == 1;
  const auto* const composed = std::get_if<ComposedInTime>(this);
  return composed != nullptr && composed->moves_break(static_cast<std::size_t>(number));
}

std::optional<JumpInTime> TimeLaw::jump_by(int number) const {
  if (const auto* const step = std::get_if<StepInTime>(this)) {
    return number == 0 ? std::optional<JumpInTime>({step->at, step->to - step->from}) : std::nullopt;
  }
  const auto* const composed = std::get_if<ComposedInTime>(this);
  return composed != nullptr ? composed->jump_by(static_cast<std::size_t>(number)) : std::nullopt;
}

bool TimeLaw::has_derivative_at(int number, double t) const {
  if (const auto* const ramp = std::get_if<RampInTime>(this); ramp != nullptr && number >= 2) {
    return ramp->way != Way::linear || t != (number == 2 ? ramp->start : ramp->end) || ramp->from == ramp->to;
  }
  if (const auto* const table = std::get_if<TableInTime>(this)) {
    return table->has_derivative_at(static_cast<std::size_t>(number), t);
  }
  if (const auto* const composed = std::get_if<ComposedInTime>(this)) {
    return composed->has_derivative_at(static_cast<std::size_t>(number), t);
  }
  return !jump_by(number);
}

std::vector<double> TimeLaw::breaks() const {
  return std::visit([](const auto& l) { return breaks_of(l); }, *this);
}

double TimeLaw::frequency() const {
  if (const auto* const sine = std::get_if<SineInTime>(this)) return sine->frequency;
  double out = 0.0;
  if (const auto* const composed = std::get_if<ComposedInTime>(this)) {
    for (const TimeLaw& part : composed->parts) out = std::max(out, part.frequency());
  }
  return out;
}

bool TimeFunction::is_smooth_in(int number) const {
  if (of == Of::drive) return law.smoothness() > 1 || !law.moves_break(number);
  if (order > 0) return law.smoothness() >= order || !law.moves_break(number);
  return !law.jump_by(number);
}

void TimeFunction::check() const {
  law.check();
  if (of == Of::drive) expect_drivable(law);
  if (of == Of::frame && law.smoothness() < order - 1) {
    throw InputError(
        "expected a place or velocity of the frame that does not jump, which would take infinite forces; "
        "write a smooth function, or its acceleration");
  }
}

void TimeLaw::scale_table(double factor) {
  if (auto* const formula = std::get_if<FormulaInTime>(this)) formula->unit *= factor;
  if (auto* const composed = std::get_if<ComposedInTime>(this)) composed->scale_tables(factor);
  auto* const own = std::get_if<TableInTime>(this);
  if (own == nullptr || factor == 1.0) return;
  const auto scaled = [factor](TimeTable table) {
    for (double& value : table.value) value *= factor;
    for (std::array<double, 4>& piece : table.pieces) {
      for (double& c : piece) c *= factor;
    }
    return table;
  };
  own->table = std::make_shared<const TimeTable>(scaled(*own->table));
  if (own->by == nullptr) return;
  std::vector<TimeTable> by = *own->by;
  for (std::size_t number = 1; number < by.size(); number += 2) by[number] = scaled(std::move(by[number]));
  own->by = std::make_shared<const std::vector<TimeTable>>(std::move(by));
}

std::string_view name_of(const Scene& scene, const TimeFunction& function) {
  const auto item = static_cast<std::size_t>(function.item);
  if (function.of == TimeFunction::Of::frame) return function.part == 0 ? "x" : "y";
  if (function.of == TimeFunction::Of::element) return scene.elements[item].name;
  if (function.of == TimeFunction::Of::force) return scene.forces[item].name;
  if (function.of == TimeFunction::Of::torque) return scene.torques[item].name;
  return scene.drives[item].name;
}

void start_drives_at(Scene& scene, double t) {
  for (const TimeFunction& function : scene.time_functions) {
    if (function.of != TimeFunction::Of::drive) continue;
    Drive& drive = scene.drives[static_cast<std::size_t>(function.item)];
    drive.start = function.at(t);
    drive.rate = function.at(t, 1);
    drive.acceleration = function.at(t, 2);
  }
}

void forget_functions_of_drives(Scene& scene) {
  const auto is_of_drive = [](const TimeFunction& one) { return one.of == TimeFunction::Of::drive; };
  if (scene.dependents) {
    std::vector<DependentNumber> all, left_out;
    for (DependentNumber one : *scene.dependents) {
      if (one.at.place.owner == Owner::time && one.at.of == DependentPlace::Of::row) {
        const auto function = scene.time_functions.begin() + one.at.place.item;
        if (is_of_drive(*function)) {
          one.at.of = DependentPlace::Of::left_out;
          left_out.push_back(std::move(one));
          continue;
        }
        one.at.place.item -= static_cast<int>(std::count_if(scene.time_functions.begin(), function, is_of_drive));
      }
      all.push_back(std::move(one));
    }
    std::move(left_out.begin(), left_out.end(), std::back_inserter(all));
    scene.dependents = std::make_shared<const std::vector<DependentNumber>>(std::move(all));
  }
  std::erase_if(scene.time_functions, is_of_drive);
}

Scene at_time(Scene scene, double t) {
  start_drives_at(scene, t);
  hold_dependents(scene, t);
  for (const TimeFunction& function : scene.time_functions) {
    const auto item = static_cast<std::size_t>(function.item);
    const double factor = function.at(t, function.order);
    if (function.of == TimeFunction::Of::drive) continue;
    if (function.of == TimeFunction::Of::frame) {
      (function.part == 0 ? scene.gravity.x : scene.gravity.y) -= factor;
      continue;
    }
    if (function.of == TimeFunction::Of::element) {
      Element& element = scene.elements[item];
      std::visit(
          [&](auto& law) {
            const Number& number = numbers_of_law(law)[static_cast<std::size_t>(function.part)];
            number.set(&law, factor * number.get(&law).value());
          },
          element.law);
      scene.held_loads.push_back({element.name, function.kind(), t, factor});
      continue;
    }
    if (function.of == TimeFunction::Of::force) {
      scene.forces[item].vector = factor * scene.forces[item].vector;
      scene.held_loads.push_back({scene.forces[item].name, function.kind(), t, factor});
    } else {
      scene.torques[item].value *= factor;
      scene.held_loads.push_back({scene.torques[item].name, function.kind(), t, factor});
    }
  }
  scene.time_functions.clear();
  return scene;
}

}  // namespace poise
