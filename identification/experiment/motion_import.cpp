#include "identification/experiment/motion_import.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "identification/experiment/record.hpp"
#include "motion/motion_record.hpp"

namespace poise {

ImportedMotion import_motion(const MotionModel& model, const std::filesystem::path& file) {
  const std::vector<std::string> header = read_csv_header(file);
  const auto has = [&](const std::string& name) {
    return std::find(header.begin(), header.end(), name) != header.end();
  };
  std::vector<Channel> channels;
  std::vector<std::string> columns = {"time"};
  for (const Channel& channel : channels_of(model)) {
    const bool known = std::any_of(channels.begin(), channels.end(),
                                   [&](const Channel& c) { return c.coordinate == channel.coordinate; });
    if (known || !has(channel.name)) continue;
    channels.push_back(channel);
    columns.push_back(channel.name);
    if (has(channel.name + ".rate")) columns.push_back(channel.name + ".rate");
  }
  const CsvTable table = read_csv(file, columns);
  ImportedMotion out;
  out.time = table.column("time");
  check_times(table, "time", 0, out.time.size());
  for (const Channel& channel : channels) {
    const double unit = unit_value(channel.quantity, model.scene().units);
    SampledCoordinate sample{channel.coordinate, table.column(channel.name), {}};
    for (double& v : sample.value) v = v * unit - channel.offset;
    if (has(channel.name + ".rate")) sample.rate = table.column(channel.name + ".rate");
    for (double& v : sample.rate) v *= unit;
    out.coordinates.push_back(std::move(sample));
  }
  return out;
}

}  // namespace poise
