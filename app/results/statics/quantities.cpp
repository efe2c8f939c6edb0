#include "app/results/statics/quantities.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "model/input_error.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/loads_in_motion.hpp"
#include "motion/modes.hpp"
#include "statics/equilibrium/link_loads.hpp"

namespace poise::app {
namespace {

QuantityValue none(std::string why) { return {std::numeric_limits<double>::quiet_NaN(), std::move(why)}; }

QuantityValue load_in_link_at(const SoughtQuantity& of, const StaticModel& model, const std::vector<double>& x,
                              const std::vector<int>& active) {
  std::vector<BodyPose<double>> poses = model.poses(x);
  poses.resize(model.scene().bodies.size());
  return load_in_link(of, model.scene(), link_loads(model.scene(), poses, check(model, x, {}, &active)));
}

QuantityValue mode_of(const SoughtQuantity& of, const StaticModel& statics, const std::vector<double>& x) {
  try {
    const MotionModel motion(statics.scene());
    const Modes modes = modes_of(motion, motion_coordinates(motion, statics, x));
    if (!modes.known) return none(modes.why);
    if (of.item >= static_cast<int>(modes.vibrations.size())) {
      return none("the mechanism has " + count(static_cast<int>(modes.vibrations.size()), "mode", "modes"));
    }
    const Vibration& one = modes.vibrations[static_cast<std::size_t>(of.item)];
    return {of.kind == SoughtQuantity::Kind::frequency ? one.frequency : one.damping_ratio, ""};
  } catch (const InputError& error) {
    return none(error.what());
  }
}

}  // namespace

void add_quantities(Group& group, const std::vector<SoughtQuantity>& of, const std::vector<QuantityValue>& values,
                    const Units& units) {
  if (of.empty()) return;
  constexpr int digits = 6;
  std::vector<std::string> names, in_words, of_units, why;
  std::vector<double> in_units;
  for (std::size_t k = 0; k < of.size(); ++k) {
    names.push_back(of[k].name);
    in_units.push_back(values[k].value / of[k].dimension.unit(units));
    in_words.push_back(significant(in_units.back(), digits));
    of_units.push_back(of[k].dimension.unit_name(units));
    why.push_back(values[k].why);
  }
  Table& table = group.table("quantities", "Quantities", Rows::list);
  table.shown = Table::Shown::all;
  table.words("name", "quantity", names);
  table.words("", "value", in_words);
  table.data("value", in_units);
  table.words("unit", "unit", of_units);
  table.words("why", "", why).kind = Column::Kind::word_or_null;
}

void add_quantity_columns(Table& table, const std::vector<SoughtQuantity>& of,
                          const std::vector<std::vector<QuantityValue>>& rows, const Units& units, bool key,
                          bool shown) {
  constexpr int digits = 8;
  for (std::size_t k = 0; k < of.size(); ++k) {
    const double unit = of[k].dimension.unit(units);
    std::vector<double> values = each(rows, [&](const std::vector<QuantityValue>& row) { return row[k].value / unit; });
    // An output may have the name of a column.
    const bool is_taken = std::any_of(table.columns.begin(), table.columns.end(),
                                      [&](const Column& column) { return column.key == of[k].name; });
    Column& column = table.numbers(!key       ? ""
                                   : is_taken ? "outputs." + of[k].name
                                              : of[k].name,
                                   of[k].name, of[k].dimension.unit_name(units), std::move(values), {.digits = digits});
    constexpr double rounding = 1e-13;  // of the largest
    double largest = 0.0;
    for (const double value : column.numbers) largest = std::max(largest, std::isnan(value) ? 0.0 : std::abs(value));
    column.format.zero_below = rounding * largest;
    column.shown = shown;
  }
}

QuantityValue other_quantity(const SoughtQuantity& of, const StaticModel& model, const std::vector<double>& x,
                             const std::vector<int>& active) {
  return of.is_in_link() ? load_in_link_at(of, model, x, active) : mode_of(of, model, x);
}

}  // namespace poise::app
