#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <set>
#include <utility>

#include <boost/math/differentiation/autodiff.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <fmt/format.h>

#include "model/expression.hpp"
#include "model/expression_value.hpp"
#include "model/input_error.hpp"
#include "model/time_law.hpp"

namespace poise {
namespace {

struct Accessors {
  std::optional<double> (*get)(const void*);
  void (*set)(void*, double);
  void (*scale)(void*, double);
};

template <std::size_t... K>
constexpr std::array<Accessors, sizeof...(K)> formula_accessors(std::index_sequence<K...>) {
  return {Accessors{
      [](const void* item) { return std::optional<double>(static_cast<const FormulaInTime*>(item)->values[K]); },
      [](void* item, double to) { static_cast<FormulaInTime*>(item)->values[K] = to; },
      [](void*, double) {}}...};  // the unit alone is scaled
}

template <std::size_t... K>
constexpr std::array<Accessors, sizeof...(K)> composed_accessors(std::index_sequence<K...>) {
  return {Accessors{
      [](const void* item) { return std::optional<double>(static_cast<const ComposedInTime*>(item)->value(K)); },
      [](void* item, double to) { static_cast<ComposedInTime*>(item)->set_alone(K, to); },
      [](void* item, double factor) { static_cast<ComposedInTime*>(item)->multiply(K, factor); }}...};
}

Number with_accessors(Number number, const std::string& key, const Accessors& accessors) {
  number.key = lasting_text(key);
  number.angle_key = {};
  number.needed = Number::Needed::no;
  number.get = accessors.get;
  number.set = accessors.set;
  number.scale = accessors.scale;
  return number;
}

Number number_of_formula(std::size_t k, const std::string& name) {
  static constexpr auto accessors = formula_accessors(std::make_index_sequence<FormulaInTime::most_names>());
  return with_accessors({}, std::string(FormulaInTime::key) + "." + name, accessors[k]);
}

Number number_of_composed(std::size_t k, const std::string& key, const Number& like) {
  static constexpr auto accessors = composed_accessors(std::make_index_sequence<ComposedInTime::most_numbers>());
  if (k >= accessors.size()) {
    throw InputError(fmt::format("expected at most {} numbers in a function of time; write points into a file",
                                 ComposedInTime::most_numbers));
  }
  return with_accessors(like, key, accessors[k]);
}

/// Functions of expressions that have kinks, or jump, where their arguments pass certain values.
int smoothness_of_formula(const Expression& expression) {
  int out = 2;
  for (const std::string_view function : expression.functions_of(0)) {
    if (function == "atan2") return -1;
    if (function == "abs" || function == "min" || function == "max") out = 0;
  }
  return out;
}

}  // namespace

std::string_view lasting_text(std::string text) {
  static std::mutex busy;
  static std::set<std::string> all;
  const std::scoped_lock lock(busy);
  return *all.insert(std::move(text)).first;
}

// --- formulas --------------------------------------------------------------------------------------------------------

FormulaInTime FormulaInTime::of(const std::string& text, const std::vector<std::string>& names,
                                const std::vector<double>& values, double unit) {
  std::vector<std::string> known{std::string(time_name)};
  known.insert(known.end(), names.begin(), names.end());
  const Expression with_all(text, known);
  FormulaInTime out;
  out.unit = unit;
  for (const int used : with_all.uses()) {
    if (used == 0) continue;
    out.names.push_back(known[static_cast<std::size_t>(used)]);
    out.values.push_back(values[static_cast<std::size_t>(used) - 1]);
  }
  if (out.names.size() > most_names) {
    throw InputError(
        fmt::format("expected at most {} names in a function of time, found {}; give parts of it names "
                    "in [numbers]",
                    most_names, out.names.size()));
  }
  std::vector<std::string> used{known[0]};
  used.insert(used.end(), out.names.begin(), out.names.end());
  out.expression = std::make_shared<const Expression>(text, used);
  std::vector<Number> all;
  for (std::size_t k = 0; k < out.names.size(); ++k) all.push_back(number_of_formula(k, out.names[k]));
  out.all = std::make_shared<const std::vector<Number>>(std::move(all));
  return out;
}

int FormulaInTime::smoothness() const { return smoothness_of_formula(*expression); }

double value_of(const FormulaInTime& formula, double t, int derivative, double) {
  std::array<double, FormulaInTime::most_names + 1> all{t}, slopes{1.0};
  const std::array<double, FormulaInTime::most_names + 1> bends{};
  std::copy(formula.values.begin(), formula.values.end(), all.begin() + 1);
  const std::size_t count = formula.values.size() + 1;
  const Expression& f = *formula.expression;
  const std::span<const double> numbers(all.data(), count), along(slopes.data(), count), none(bends.data(), count);
  return formula.unit * (derivative == 0   ? f.value(numbers)
                         : derivative == 1 ? f.slope(numbers, along)
                                           : f.bend(numbers, along, none));
}

double value_by(const FormulaInTime& formula, int number, double t, int derivative, double) {
  using boost::math::differentiation::make_fvar;
  using Mixed = boost::math::differentiation::autodiff_fvar<double, 2, 1>;
  std::vector<Mixed> all{make_fvar<double, 2>(t) + Mixed(0.0)};
  for (std::size_t k = 0; k < formula.values.size(); ++k) {
    const double value = formula.values[k];
    all.push_back(k == static_cast<std::size_t>(number) ? make_fvar<double, 0, 1>(value) + Mixed(0.0) : Mixed(value));
  }
  return formula.unit * formula.expression->value_in<Mixed>(all).derivative(static_cast<std::size_t>(derivative), 1);
}

SecondDual value_with(const FormulaInTime& formula, std::span<const SecondDual> numbers, double t, double) {
  std::vector<SecondDual> all{SecondDual(t)};
  all.insert(all.end(), numbers.begin(), numbers.end());
  return SecondDual(formula.unit) * formula.expression->value_in<SecondDual>(all);
}

// --- integrals -------------------------------------------------------------------------------------------------------

namespace {

/// int_0^t f and int_0^t int_0^s f of a function between whose breaks it is smooth. The time is cut into panels in
/// which Gauss' rule is exact but for rounding, one after the other and for good, so that values depend on t alone.
template <class T>
class RunningIntegral {
 public:
  using Function = std::function<T(double t, double near)>;
  struct Value {
    T once{0.0}, twice{0.0};
  };

  RunningIntegral(Function f, std::vector<double> breaks) : f_(std::move(f)), breaks_(std::move(breaks)) {
    std::sort(breaks_.begin(), breaks_.end());
  }

  Value at(double t) const {
    if (t < 0.0) return from(0.0, t, {});
    const std::scoped_lock lock(busy_);
    while (ends_.back() < t) add_panel();
    const auto next = std::upper_bound(ends_.begin(), ends_.end(), t);
    const auto k = static_cast<std::size_t>(next - ends_.begin()) - 1;
    return from(ends_[k], t, values_[k]);
  }

 private:
  using Rule = boost::math::quadrature::gauss<double, 15>;
  static constexpr double rounding = 8e-16;

  static double plain(const double& x) { return x; }
  static double plain(const SecondDual& x) {
    return std::abs(x.derivative(0, 0)) + std::abs(x.derivative(1, 0)) + std::abs(x.derivative(1, 1));
  }

  /// On from the values at a.
  Value from(double a, double b, const Value& at_a) const {
    const double half = 0.5 * (b - a), middle = 0.5 * (a + b);
    T once(0.0), twice(0.0);
    const auto add = [&](double place, double weight) {
      const double s = middle + half * place;
      const T f = f_(s, middle);
      once = T(once + T(weight * half) * f);
      twice = T(twice + T(weight * half * (b - s)) * f);
    };
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
      const double place = Rule::abscissa()[i], weight = Rule::weights()[i];
      add(place, weight);
      if (place != 0.0) add(-place, weight);
    }
    return {T(at_a.once + once), T(at_a.twice + T(b - a) * at_a.once + twice)};
  }

  void add_panel() const {
    const double a = ends_.back();
    constexpr double shortest = 1e-9;
    const auto next = std::upper_bound(breaks_.begin(), breaks_.end(), a + shortest);
    double h = step_;
    for (;;) {
      const double limit = next == breaks_.end() ? std::numeric_limits<double>::infinity() : *next;
      const double b = std::min(a + h, limit);
      const Value whole = from(a, b, values_.back());
      const Value halves = from((a + b) / 2, b, from(a, (a + b) / 2, values_.back()));
      const double error = std::abs(plain(T(whole.once - halves.once)));
      largest_ =
          std::max({largest_, std::abs(plain(halves.once)), (b - a) * std::abs(plain(f_((a + b) / 2, (a + b) / 2)))});
      const bool is_exact = !(error > rounding * largest_);  // also of what is no number
      if (is_exact || h < shortest) {
        ends_.push_back(b);
        values_.push_back(halves);
        step_ = is_exact ? 2.0 * h : h;
        return;
      }
      h = 0.5 * (b - a);
    }
  }

  Function f_;
  std::vector<double> breaks_;
  mutable std::mutex busy_;
  mutable double step_ = 1.0 / 64, largest_ = 0.0;
  mutable std::vector<double> ends_{0.0};
  mutable std::vector<Value> values_{Value{}};
};

}  // namespace

/// The integrals of a law, and of its derivatives by each of its numbers.
class RunningIntegrals {
 public:
  explicit RunningIntegrals(const TimeLaw& law) {
    // The last one is of the law itself.
    const int count = static_cast<int>(law.numbers().size());
    for (int number = 0; number <= count; ++number) {
      all_.push_back(std::make_unique<const RunningIntegral<double>>(
          [law, number, count](double t, double near) {
            return number == count ? law.at(t, 0, near) : law.by(number, t, 0, near);
          },
          law.breaks()));
    }
  }
  double value(int order, double t) const { return of(*all_.back(), order, t); }
  double by(int number, int order, double t) const { return of(*all_[static_cast<std::size_t>(number)], order, t); }

 private:
  static double of(const RunningIntegral<double>& one, int order, double t) {
    const auto value = one.at(t);
    return order == 1 ? value.once : value.twice;
  }

  std::vector<std::unique_ptr<const RunningIntegral<double>>> all_;
};

// --- functions made of others ----------------------------------------------------------------------------------------

namespace {

using How = ComposedInTime::How;

std::string_view word_of(How how) {
  return how == How::sum ? "sum" : how == How::product ? "product" : how == How::piecewise ? "piecewise" : "integral";
}

std::vector<Number> numbers_of(const ComposedInTime& of) {
  std::vector<Number> out;
  const auto add = [&](const std::string& key, const Number& like) {
    out.push_back(number_of_composed(out.size(), key, like));
  };
  if (of.how == How::piecewise) {
    for (std::size_t k = 0; k < of.own.size(); ++k) {
      add(fmt::format("piecewise.{}.until", k + 1), Number{{}, dimension::time});
    }
  }
  if (of.how == How::integral) {
    Number start{{}, dimension::none};
    start.measure_power = 1;
    add("start", start);
    start.dimension = dimension::time.power(-1);
    if (of.order == 2) add("rate", start);
  }
  for (std::size_t k = 0; k < of.parts.size(); ++k) {
    for (Number number : of.parts[k].numbers()) {
      const bool has_unit = of.how != How::product || k == 0;
      if (!has_unit) number.measure_power = 0;
      if (of.how == How::integral && number.measure_power == 1) {
        number.dimension = number.dimension * dimension::time.power(-of.order);
      }
      const std::string key(number.key);
      add(of.how == How::integral ? key : fmt::format("{}.{}.{}", word_of(of.how), k + 1, key), number);
    }
  }
  return out;
}

/// The piece that holds at `near`.
std::size_t piece_at(const ComposedInTime& of, double near) {
  return static_cast<std::size_t>(std::upper_bound(of.own.begin(), of.own.end(), near) - of.own.begin());
}

/// d^n/dt^n of a product of factors f, each with derivatives f(k, order), of the factors from `first` on.
template <class F>
double product_of(std::size_t first, std::size_t count, int derivative, const F& f) {
  if (first + 1 == count) return f(first, derivative);
  constexpr std::array<std::array<double, 3>, 3> binomial{{{1, 0, 0}, {1, 1, 0}, {1, 2, 1}}};
  double out = 0.0;
  for (int k = 0; k <= derivative; ++k) {
    out += binomial[static_cast<std::size_t>(derivative)][static_cast<std::size_t>(k)] * f(first, k) *
           product_of(first + 1, count, derivative - k, f);
  }
  return out;
}

/// The least order, 0 to 2, in which two pieces do not meet at t; 3 where they do in all.
int gap_between(const TimeLaw& before, const TimeLaw& after, double t) {
  constexpr double rounding = 1e-9;  // of formulas whose values are read as decimals
  const double h = 1e-3 * (1.0 + std::abs(t));
  for (int order = 0; order <= 2; ++order) {
    const double a = before.at(t, order, t), b = after.at(t, order, t);
    double size = std::abs(a) + std::abs(b);
    // Values that vanish at t itself are compared with those beside it.
    for (const double near : {t - h, t + h})
      size += std::abs(before.at(near, order, t)) + std::abs(after.at(near, order, t));
    if (!(std::abs(a - b) <= rounding * size)) return order;
  }
  return 3;
}

}  // namespace

ComposedInTime ComposedInTime::of(How how, std::vector<double> own, std::vector<TimeLaw> parts, int order) {
  ComposedInTime out;
  out.how = how;
  out.order = order;
  out.own = std::move(own);
  out.parts = std::move(parts);
  out.all = std::make_shared<const std::vector<Number>>(numbers_of(out));
  out.restart();
  return out;
}

void ComposedInTime::restart() {
  if (how == How::integral) integrals = std::make_shared<const RunningIntegrals>(parts[0]);
}

std::string_view ComposedInTime::kind() const { return how == How::integral ? parts[0].kind() : word_of(how); }

std::pair<int, std::size_t> ComposedInTime::place_of(std::size_t number) const {
  if (number < own.size()) return {-1, number};
  number -= own.size();
  for (std::size_t k = 0;; ++k) {
    const std::size_t count = parts[k].numbers().size();
    if (number < count) return {static_cast<int>(k), number};
    number -= count;
  }
}

double ComposedInTime::value(std::size_t number) const {
  const auto [k, place] = place_of(number);
  if (k < 0) return own[place];
  const TimeLaw& part = parts[static_cast<std::size_t>(k)];
  const Number& of = part.numbers()[place];
  return std::visit([&of](const auto& law) { return of.get(&law).value(); },
                    static_cast<const TimeLaw::variant&>(part));
}

void ComposedInTime::set(std::size_t number, double to) {
  const auto [k, place] = place_of(number);
  if (k < 0)
    own[place] = to;
  else
    parts[static_cast<std::size_t>(k)].set_among_others(static_cast<int>(place), to);
  restart();
}

void ComposedInTime::set_alone(std::size_t number, double to) {
  ComposedInTime changed = *this;
  changed.set(number, to);
  changed.check();
  *this = std::move(changed);
}

void ComposedInTime::multiply(std::size_t number, double factor) {
  const auto [k, place] = place_of(number);
  if (k < 0) {
    own[place] *= factor;
    return;
  }
  TimeLaw& part = parts[static_cast<std::size_t>(k)];
  const Number& of = part.numbers()[place];
  std::visit([&of, factor](auto& law) { of.scale(&law, factor); }, static_cast<TimeLaw::variant&>(part));
  restart();
}

void ComposedInTime::scale_tables(double factor) {
  for (std::size_t k = 0; k < (how == How::product ? 1 : parts.size()); ++k) parts[k].scale_table(factor);
  restart();
}

void ComposedInTime::check() const {
  for (const TimeLaw& part : parts) part.check();
  if (how != How::piecewise) return;
  if (std::adjacent_find(own.begin(), own.end(), [](double a, double b) { return !(a < b); }) != own.end()) {
    throw InputError("expected pieces whose times until ascend; keep each between those beside it");
  }
}

int ComposedInTime::smoothness() const {
  int out = 2;
  for (const TimeLaw& part : parts) out = std::min(out, part.smoothness());
  if (how == How::integral) return std::min(2, out + order);
  if (how != How::piecewise) return out;
  for (std::size_t k = 0; k < own.size(); ++k) {
    out = std::min(out, gap_between(parts[k], parts[k + 1], own[k]) - 1);
  }
  return out;
}

std::vector<double> ComposedInTime::breaks() const {
  std::vector<double> out;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (const double t : parts[k].breaks()) {
      const bool is_in = how != How::piecewise || ((k == 0 || t > own[k - 1]) && (k == own.size() || t < own[k]));
      if (is_in) out.push_back(t);
    }
  }
  if (how == How::piecewise) out.insert(out.end(), own.begin(), own.end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

bool ComposedInTime::moves_break(std::size_t number) const {
  const auto [k, place] = place_of(number);
  if (k < 0) return how == How::piecewise;
  return parts[static_cast<std::size_t>(k)].moves_break(static_cast<int>(place));
}

std::optional<JumpInTime> ComposedInTime::jump_by(std::size_t number) const {
  if (how == How::integral) return std::nullopt;
  const auto [k, place] = place_of(number);
  double t = 0.0;
  if (k >= 0) {
    const std::optional<JumpInTime> of_part = parts[static_cast<std::size_t>(k)].jump_by(static_cast<int>(place));
    if (!of_part) return std::nullopt;
    t = of_part->at;
    if (how == How::piecewise && piece_at(*this, t) != static_cast<std::size_t>(k)) return JumpInTime{t, 0.0};
    if (how != How::product) return of_part;
    double factor = of_part->by;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (i != static_cast<std::size_t>(k)) factor *= parts[i].at(t, 0, t);
    }
    return JumpInTime{t, factor};
  }
  t = own[place];
  if (gap_between(parts[place], parts[place + 1], t) > 0) return std::nullopt;
  return JumpInTime{t, parts[place + 1].at(t, 0, t) - parts[place].at(t, 0, t)};
}

bool ComposedInTime::has_derivative_at(std::size_t number, double t) const {
  const auto [k, place] = place_of(number);
  if (k < 0) return how == How::integral || t != own[place];
  return how == How::integral || parts[static_cast<std::size_t>(k)].has_derivative_at(static_cast<int>(place), t);
}

double value_of(const ComposedInTime& of, double t, int derivative, double near) {
  switch (of.how) {
    case How::sum: {
      double out = 0.0;
      for (const TimeLaw& part : of.parts) out += part.at(t, derivative, near);
      return out;
    }
    case How::product:
      return product_of(0, of.parts.size(), derivative,
                        [&](std::size_t k, int order) { return of.parts[k].at(t, order, near); });
    case How::piecewise:
      return of.parts[piece_at(of, near)].at(t, derivative, near);
    case How::integral:
      break;
  }
  if (derivative >= of.order) return of.parts[0].at(t, derivative - of.order, near);
  const double integral = of.integrals->value(of.order - derivative, t);
  if (derivative == 1) return of.own[1] + integral;
  return of.own[0] + (of.order == 2 ? of.own[1] * t : 0.0) + integral;
}

double value_by(const ComposedInTime& of, int number, double t, int derivative, double near) {
  const auto [k, place] = of.place_of(static_cast<std::size_t>(number));
  const int in_part = static_cast<int>(place);
  if (k < 0) {
    if (of.how == How::piecewise) return 0.0;
    if (place == 0) return derivative == 0 ? 1.0 : 0.0;
    return derivative == 0 ? t : derivative == 1 ? 1.0 : 0.0;
  }
  const auto changed = static_cast<std::size_t>(k);
  const TimeLaw& part = of.parts[changed];
  switch (of.how) {
    case How::sum:
      return part.by(in_part, t, derivative, near);
    case How::product:
      return product_of(0, of.parts.size(), derivative,
                        [&of, &part, changed, in_part, t, near](std::size_t i, int order) {
                          return i == changed ? part.by(in_part, t, order, near) : of.parts[i].at(t, order, near);
                        });
    case How::piecewise:
      return piece_at(of, near) == changed ? part.by(in_part, t, derivative, near) : 0.0;
    case How::integral:
      break;
  }
  if (derivative >= of.order) return part.by(in_part, t, derivative - of.order, near);
  double out = of.integrals->by(in_part, of.order - derivative, t);
  // Where a jump comes later, what is before it lasts longer.
  const std::optional<JumpInTime> jump = part.jump_by(in_part);
  if (jump && near >= jump->at) out -= jump->by * (of.order - derivative == 1 ? 1.0 : t - jump->at);
  return out;
}

SecondDual value_with(const ComposedInTime& of, std::span<const SecondDual> numbers, double t, double near) {
  std::size_t first = of.own.size();
  const auto numbers_of_next = [&](const TimeLaw& part) {
    const std::size_t count = part.numbers().size();
    first += count;
    return numbers.subspan(first - count, count);
  };
  switch (of.how) {
    case How::sum:
    case How::product: {
      SecondDual out(of.how == How::sum ? 0.0 : 1.0);
      for (const TimeLaw& part : of.parts) {
        const SecondDual value = value_with(part, numbers_of_next(part), t, near);
        out = of.how == How::sum ? SecondDual(out + value) : SecondDual(out * value);
      }
      return out;
    }
    case How::piecewise: {
      const std::size_t piece = piece_at(of, near);
      for (std::size_t k = 0; k < piece; ++k) numbers_of_next(of.parts[k]);
      return value_with(of.parts[piece], numbers_of_next(of.parts[piece]), t, near);
    }
    case How::integral:
      break;
  }
  const std::span<const SecondDual> of_part = numbers_of_next(of.parts[0]);
  const RunningIntegral<SecondDual> integral(
      [&](double s, double near_s) { return value_with(of.parts[0], of_part, s, near_s); }, of.parts[0].breaks());
  const auto value = integral.at(t);
  if (of.order == 1) return numbers[0] + value.once;
  return numbers[0] + numbers[1] * SecondDual(t) + value.twice;
}

void expect_drivable(const TimeLaw& law) {
  const int smoothness = law.smoothness();
  if (smoothness < 1) {
    throw InputError(fmt::format(
        "expected a function of which the rate never jumps, which would take infinite forces, found {} {} may jump; "
        "write a smooth one, say ramp = {{ from = A, to = B, start = T, end = T }}",
        law.kind(), smoothness < 0 ? "whose value" : "whose rate"));
  }
  for (int derivative = 0; derivative <= 2; ++derivative) {
    if (!std::isfinite(law.at(0.0, derivative, 0.0))) {
      throw InputError(
          fmt::format("expected a function with a value, rate and acceleration at t = 0 s, found none; "
                      "begin it where it is smooth"));
    }
  }
}

}  // namespace poise
