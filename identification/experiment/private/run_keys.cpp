#include "identification/experiment/private/run_keys.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "model/nearest_name.hpp"
#include "model/scene_names.hpp"

namespace poise {

void expect_none(const TomlTable& table, std::initializer_list<const char*> keys, const char* belong) {
  for (const char* const key : keys) {
    if (table.has(key)) table.place_of(key).fail(fmt::format("expected {} {}", key, belong));
  }
}

void read_sensors(const TomlTable& table, const Experiment& experiment, bool rests_too, Run& run) {
  const std::vector<Sensor>& sensors = experiment.sensors;
  const auto is_read = [&](const Sensor& sensor) {
    return run.is_at_rest() ? sensor.is_of_rest() : sensor.is_of_motion();
  };
  const std::vector<TomlText> names = table.texts("sensors");
  if (table.has("sensors") && names.empty()) {
    table.place_of("sensors").fail("expected the name of a sensor; leave the key out for all");
  }
  const auto is_read_by_default = [&](const Sensor& sensor) {
    return is_read(sensor) && (run.is_at_rest() || !sensor.quantity || !rests_too);
  };
  if (names.empty() && !std::all_of(sensors.begin(), sensors.end(), is_read_by_default)) {
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      if (is_read_by_default(sensors[k])) run.sensors.push_back(k);
    }
    if (run.sensors.empty()) {
      table.place().fail(run.is_at_rest()
                             ? "expected a sensor that reads at rest, all read what only motions have; add one"
                             : "expected a sensor that reads motions, all read what only a mechanism at "
                               "rest has; add one, or make it [[static]]");
    }
  }
  std::vector<std::string> valid;
  for (const Sensor& sensor : sensors) valid.push_back(sensor.name);
  for (const TomlText& name : names) {
    const auto at = std::find(valid.begin(), valid.end(), name.value);
    if (at == valid.end()) {
      name.place.fail("expected the name of a sensor, found \"" + name.value + "\"" +
                      did_you_mean_or_list(name.value, valid));
    }
    const auto k = static_cast<std::size_t>(at - valid.begin());
    if (!is_read(sensors[k])) {
      name.place.fail(run.is_at_rest()
                          ? "expected a sensor that reads at rest, \"" + name.value +
                                "\" reads what only motions have; leave it out"
                          : "expected a sensor that reads motions, \"" + name.value + "\" reads " +
                                sensors[k].quantity->name + ", which a run at rest alone has; leave it out");
    }
    run.sensors.push_back(k);
  }
  std::sort(run.sensors.begin(), run.sensors.end());
  if (std::adjacent_find(run.sensors.begin(), run.sensors.end()) != run.sensors.end()) {
    table.place_of("sensors").fail("expected each sensor once; take one of the two out");
  }
}

void read_labels(const TomlTable& table, Run& run) {
  const auto labels = table.find_table("labels");
  if (!labels) return;
  for (const std::string& key : labels->keys()) {
    check_name(key, labels->place_of(key));
    if (key == "run") labels->place_of(key).fail("expected another label; per = \"run\" means each run by itself");
    const TomlText value = labels->text(key);
    check_name(value.value, value.place);
    run.labels.emplace_back(key, value.value);
  }
}

}  // namespace poise
