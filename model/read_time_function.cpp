#include "model/read_time_function.hpp"

#include <string>
#include <utility>
#include <vector>

#include "model/read_curve.hpp"
#include "model/read_elements.hpp"
#include "model/time_law.hpp"

namespace poise {
namespace {

constexpr PointWords time_words{"time", "value", "a time", "[t, VALUE]"};

/// Words of the key `as`: of what the function is, the measure or one of its derivatives.
const std::vector<std::string> kinds_of_motion{"position", "velocity", "acceleration"};

/// Reads a table that holds one function: that of the key `time`, or one of those of which it is made.
class TimeReader {
 public:
  /// `on`: the measure of a drive, null of a load; `unit`: SI value of the unit of a value. `keys`: others of the
  /// table.
  TimeReader(const TomlTable& time, const Measure* on, double unit, std::vector<std::string_view> keys)
      : time_(time), on_(on), unit_(unit), keys_(std::move(keys)) {}

  TimeLaw read() const {
    std::vector<std::string> found;
    for (const std::string_view kind : kinds) {
      if (time_.has(kind)) found.emplace_back(kind);
    }
    if (found.size() != 1) {
      allow({kinds.begin(), kinds.end()}, "interpolation");
      time_.place().fail("expected one of sine, ramp, step, table, file, function, sum, product and piecewise, found " +
                         (found.empty() ? std::string("none; add sine = { amplitude = 1, frequency = 2 }")
                                        : found[0] + " and " + found[1] + "; leave one out, or write sum = [...]"));
    }
    const std::string& kind = found[0];
    if (kind == "sine") return numbered<SineInTime>({});
    if (kind == "ramp") return ramp();
    if (kind == "step") return numbered<StepInTime>({});
    if (kind == "function") return formula();
    if (kind == "table" || kind == "file") return table(kind);
    return composed(kind);
  }

 private:
  static constexpr std::array<std::string_view, 9> kinds{"sine",     "ramp", "step",    "table",    "file",
                                                         "function", "sum",  "product", "piecewise"};

  void allow(std::vector<std::string_view> keys, std::string_view more = {}) const {
    keys.insert(keys.end(), keys_.begin(), keys_.end());
    if (!more.empty()) keys.push_back(more);
    time_.allow_keys(keys);
  }

  template <class Law>
  Law numbered(std::vector<std::string_view> keys) const {
    allow({Law::key});
    if (!time_.holds_table(Law::key)) {
      time_.place_of(Law::key).fail("expected a table, say " + std::string(Law::key) + " = { " +
                                    std::string(Law::numbers[1].key) + " = NUMBER }");
    }
    const TomlTable table = *time_.find_table(Law::key);
    for (const Number& number : Law::numbers) keys.push_back(number.key);
    table.allow_keys(keys);
    Law law;
    read_numbers(table, Law::numbers, &law, on_);
    return law;
  }

  RampInTime ramp() const {
    RampInTime law = numbered<RampInTime>({"law"});
    law.way = on_ != nullptr ? Way::polynomial_345 : Way::linear;
    if (const auto word = time_.find_table("ramp")->find_text("law")) {
      law.way = static_cast<Way>(choose(*word, {way_words.begin(), way_words.end()}));
    }
    return law;
  }

  TimeLaw table(const std::string& key) const {
    allow({key}, "interpolation");
    // Ways behind the other words; that of lines is the first.
    std::vector<std::string> words{"linear", "monotone", "spline"};
    words.insert(words.end(), way_words.begin() + 1, way_words.end());
    TimeTable::Between between = on_ != nullptr ? TimeTable::Between::spline : TimeTable::Between::linear;
    Way way = Way::linear;
    if (const auto word = time_.find_text("interpolation")) {
      const std::size_t chosen = choose(*word, words);
      between = static_cast<TimeTable::Between>(std::min<std::size_t>(chosen, 3));
      if (chosen >= 3) way = static_cast<Way>(chosen - 2);
    }
    CurvePoints points = key == "table" ? read_listed_points(time_, key, 1.0, unit_, time_words)
                                        : read_points_of_file(time_.text(key), 1.0, unit_, time_words);
    TableInTime out = TableInTime::through(std::move(points.x), std::move(points.y), between, key == "table", way);
    if (key == "file") out.file = time_.text(key).value;
    return out;
  }

  FormulaInTime formula() const {
    allow({FormulaInTime::key});
    const TomlText text = time_.text(FormulaInTime::key);
    const ExpressionReader* const expressions = time_.expressions();
    const std::vector<std::string> names = expressions != nullptr ? expressions->names() : std::vector<std::string>{};
    if (std::find(names.begin(), names.end(), FormulaInTime::time_name) != names.end()) {
      text.place.fail(
          "expected no number that is called \"t\" in [numbers], which is the time here; give it another "
          "name");
    }
    return located(text.place, [&] {
      return FormulaInTime::of(text.value, names,
                               expressions != nullptr ? expressions->values() : std::vector<double>{}, unit_);
    });
  }

  ComposedInTime composed(const std::string& kind) const {
    allow({kind});
    const bool has_pieces = kind == "piecewise";
    if (!time_.holds_list(kind) || time_.tables(kind).empty()) {
      time_.place_of(kind).fail("expected a list of functions, say " + kind + " = [{ " +
                                (has_pieces ? "until = 1, " : "") + "function = \"2*t\" }, { function = \"2\" }]");
    }
    const std::vector<TomlTable> tables = time_.tables(kind);
    std::vector<double> ends;
    std::vector<TimeLaw> parts;
    for (std::size_t k = 0; k < tables.size(); ++k) {
      const bool ends_before = has_pieces && k + 1 < tables.size();
      if (ends_before) ends.push_back(tables[k].number("until", 1.0, Range::finite));
      const bool has_unit = kind != "product" || k == 0;
      std::vector<std::string_view> keys;
      if (ends_before) keys.emplace_back("until");
      parts.push_back(TimeReader(tables[k], has_unit ? on_ : nullptr, has_unit ? unit_ : 1.0, keys).read());
    }
    return located(time_.place_of(kind), [&] {
      const auto how = kind == "sum"       ? ComposedInTime::How::sum
                       : kind == "product" ? ComposedInTime::How::product
                                           : ComposedInTime::How::piecewise;
      ComposedInTime out = ComposedInTime::of(how, std::move(ends), std::move(parts));
      out.check();
      return out;
    });
  }

  const TomlTable& time_;
  const Measure* on_;
  double unit_;
  std::vector<std::string_view> keys_;
};

TomlTable table_of_function(const TomlTable& item, std::string_view key) {
  if (!item.holds_table(key)) {
    item.place_of(key).fail("expected a table, say " + std::string(key) +
                            " = { sine = { amplitude = 1, frequency = 2 } }");
  }
  return *item.find_table(key);
}

/// Which derivative of the place the function is.
int order_of(const TomlTable& time) {
  const auto word = time.find_text("as");
  return word ? static_cast<int>(choose(*word, kinds_of_motion)) : 0;
}

}  // namespace

std::optional<TimeLaw> read_time_law(const TomlTable& item, std::string_view key, const Measure* on) {
  if (!item.has(key)) return std::nullopt;
  const TomlTable time = table_of_function(item, key);
  if (on == nullptr) return TimeReader(time, nullptr, 1.0, {}).read();
  const double unit = time.unit(on->dimension());
  std::vector<std::string_view> keys{"as"};
  const int order = order_of(time);
  if (order > 0) keys.emplace_back("start");
  if (order > 1) keys.emplace_back("rate");
  TimeLaw law = TimeReader(time, on, unit, keys).read();
  if (order > 0) {
    std::vector<double> own{time.number("start", unit, on->range())};
    if (order > 1) own.push_back(time.find_number("rate", unit, Range::finite).value_or(0.0));
    law = located(time.place(), [&] {
      return ComposedInTime::of(ComposedInTime::How::integral, std::move(own), {std::move(law)}, order);
    });
  }
  located(time.place(), [&] { expect_drivable(law); });
  return law;
}

void read_frame(const TomlTable& root, Scene& scene) {
  const std::optional<TomlTable> frame = root.find_table("frame");
  if (!frame) return;
  frame->allow_keys({"x", "y"});
  static const Measure place = Measure::x_of({});
  for (const std::string_view axis : {"x", "y"}) {
    if (!frame->has(axis)) continue;
    const TomlTable time = table_of_function(*frame, axis);
    TimeFunction function{TimeFunction::Of::frame, 0,
                          TimeReader(time, &place, time.unit(dimension::length), {"as"}).read(),
                          frame->place_of(axis).line};
    function.part = axis == "x" ? 0 : 1;
    function.order = 2 - order_of(time);
    located(time.place(), [&] { function.check(); });
    scene.time_functions.push_back(std::move(function));
  }
}

}  // namespace poise
