#include "tests/support/motion_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/varying_numbers.hpp"
#include "tests/support/motions.hpp"

namespace poise::test {

void expect_derivatives(const Scene& scene, const MotionState& start, const std::vector<std::string>& paths,
                        const std::vector<std::string>& coordinates, double duration, double within) {
  const auto varying = [&](const std::string& path) {
    const Owner owner = parameter(scene, path).place.owner;
    const bool is_of_load = owner == Owner::force || owner == Owner::torque;
    return owner != Owner::drive && owner != Owner::element && !is_of_load;
  };
  std::vector<ParameterPlace> rows;
  for (const std::string& path : paths) {
    if (varying(path)) rows.push_back(parameter(scene, path).place);
  }
  const auto shared =
      std::make_shared<const MotionModel>(scene, MotionModel(scene).scales(), VaryingNumbers(scene, rows));
  const MotionModel& model = *shared;
  MotionOptions options{.duration = duration, .accuracy = 1e-12, .sensitivities = true};
  for (const std::string& path : paths) {
    const ParameterRow row = parameter(scene, path);
    Influence influence;
    influence.by = row.dimension.per_scale(model.scales());
    if (varying(path)) {
      influence = {.variation = static_cast<int>(options.variations.size())};
      options.variations.emplace_back(shared, row.place);
    } else if (row.place.owner == Owner::drive) {
      influence.drive = row.place.item;
      influence.drive_number = row.place.number;
    } else {
      const auto of = row.place.owner == Owner::force    ? ForceNumber::Of::force
                      : row.place.owner == Owner::torque ? ForceNumber::Of::torque
                                                         : ForceNumber::Of::element;
      influence.force = {of, row.place.item, row.place.number};
    }
    options.influences.push_back(influence);
  }
  const Motion motion = simulate(model, start, options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  std::vector<int> places;
  for (const std::string& name : coordinates) places.push_back(coordinate_of(model, name));
  TrajectoryReader reader(motion.trajectory, places);
  reader.at(duration);
  const auto f = static_cast<std::size_t>(motion.freedoms);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const double value = value_at(scene, parameter(scene, paths[p]).place).value();
    const double h = 1e-4 * std::max(std::abs(value), 0.1);
    const auto at = [&](double by) {
      Scene other = scene;
      set_value_at(other, parameter(other, paths[p]).place, value + by);
      const MotionModel changed(other, model.scales());
      return read_at(moved(changed, start, duration, 1e-13), {duration})[0];
    };
    const Reading up = at(h), down = at(-h), far_up = at(2 * h), far_down = at(-2 * h);
    for (std::size_t c = 0; c < places.size(); ++c) {
      const auto by_differences = [&](auto part) {
        const auto value_of = [&](const Reading& reading) {
          return (reading.*part)[static_cast<std::size_t>(places[c])];
        };
        return (8 * (value_of(up) - value_of(down)) - (value_of(far_up) - value_of(far_down))) / (12 * h);
      };
      const double q = by_differences(&Reading::q), v = by_differences(&Reading::v);
      const int own = static_cast<int>(c);
      EXPECT_NEAR(reader.q_p(own)[2 * f + p], q, within * (1 + std::abs(q))) << paths[p] << ": " << coordinates[c];
      EXPECT_NEAR(reader.v_p(own)[2 * f + p], v, within * (1 + std::abs(v))) << paths[p] << ": " << coordinates[c];
    }
  }
}

}  // namespace poise::test
