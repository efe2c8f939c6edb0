#include "model/read_time_function.hpp"

#include <string>
#include <utility>
#include <vector>

#include "model/read_curve.hpp"
#include "model/read_elements.hpp"

namespace poise {
namespace {

constexpr PointWords time_words{"time", "value", "a time", "[t, VALUE]"};

/// A drive moves masses: where its rate or acceleration jumped, forces would be infinite or undefined.
[[noreturn]] void fail_rough(const TomlPlace& place, const std::string& found, const std::string& fix) {
  place.fail("expected a function with continuous accelerations, which a drive needs, found " + found + "; " + fix);
}

class TimeReader {
 public:
  TimeReader(const TomlTable& time, const Measure* on)
      : time_(time), on_(on), unit_(on != nullptr ? time.unit(on->dimension()) : 1.0) {}

  TimeLaw read() const {
    std::vector<std::string> found;
    for (const std::string_view kind : {"sine", "ramp", "step", "table", "file"}) {
      if (time_.has(kind)) found.emplace_back(kind);
    }
    if (found.size() != 1) {
      time_.allow_keys({"sine", "ramp", "step", "table", "file", "interpolation"});
      time_.place().fail("expected one of sine, ramp, step, table and file, found " +
                         (found.empty() ? std::string("none; add sine = { amplitude = 1, frequency = 2 }")
                                        : found[0] + " and " + found[1] + "; leave one out"));
    }
    if (found[0] == "sine") return numbered<SineInTime>({});
    if (found[0] == "ramp") return ramp();
    if (found[0] == "step") return step();
    return table(found[0]);
  }

 private:
  template <class Law>
  Law numbered(std::vector<std::string_view> keys) const {
    time_.allow_keys({Law::key});
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
    law.smooth = on_ != nullptr;
    const TomlTable table = *time_.find_table("ramp");
    if (const auto word = table.find_text("law")) {
      law.smooth = choose(*word, {"linear", "polynomial_345"}) == 1;
      if (on_ != nullptr && !law.smooth) {
        fail_rough(word->place, "a linear ramp", "write law = \"polynomial_345\" or leave it out");
      }
    }
    return law;
  }

  StepInTime step() const {
    if (on_ != nullptr) {
      fail_rough(time_.place_of("step"), "a step",
                 "write ramp = { from = A, to = B, start = T, end = T }, which is smooth");
    }
    return numbered<StepInTime>({});
  }

  TableInTime table(const std::string& key) const {
    time_.allow_keys({key, "interpolation"});
    const std::vector<std::string> words{"linear", "monotone", "spline"};
    TimeTable::Between between = on_ != nullptr ? TimeTable::Between::spline : TimeTable::Between::linear;
    if (const auto word = time_.find_text("interpolation")) {
      between = static_cast<TimeTable::Between>(choose(*word, words));
      if (on_ != nullptr && between != TimeTable::Between::spline) {
        fail_rough(word->place, "a table with interpolation = \"" + word->value + "\"",
                   "write interpolation = \"spline\" or leave it out");
      }
    }
    CurvePoints points = key == "table" ? read_listed_points(time_, key, 1.0, unit_, time_words)
                                        : read_points_of_file(time_.text(key), 1.0, unit_, time_words);
    TableInTime out = TableInTime::through(std::move(points.x), std::move(points.y), between, key == "table");
    if (key == "file") out.file = time_.text(key).value;
    return out;
  }

  const TomlTable& time_;
  const Measure* on_;
  double unit_;  // of a value
};

}  // namespace

std::optional<TimeLaw> read_time_law(const TomlTable& item, const Measure* on) {
  if (!item.has("time")) return std::nullopt;
  if (!item.holds_table("time")) {
    item.place_of("time").fail("expected a table, say time = { sine = { amplitude = 1, frequency = 2 } }");
  }
  const TomlTable time = *item.find_table("time");
  return TimeReader(time, on).read();
}

}  // namespace poise
