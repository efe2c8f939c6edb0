#include "app/results/exchange.hpp"

#include <fmt/format.h>

#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {

Result import_result(const FileFormat& format, const Imported& imported, const ScaledModel& model,
                     const Mobility& mobility) {
  Result out = scene_result(model.scene(), {});
  const std::string parts =
      count(mobility.bodies, "moving body", "moving bodies") + ", " + count(mobility.joints, "joint", "joints");
  out.verdict = mobility.assembled
                    ? good(fmt::format("Read: {}, {}.", parts,
                                       count(mobility.freedoms, "degree of freedom", "degrees of freedom")))
                    : doubtful(fmt::format("Read: {}, which cannot be assembled: {}.", parts, mobility.gap));
  out.content.data("format", std::string(format.name));
  out.content.data("moving_bodies", mobility.bodies);
  out.content.data("moving_joints", mobility.joints);
  out.content.data("assembled", mobility.assembled);
  out.content.data("degrees_of_freedom", mobility.freedoms);
  out.content.list("notes", "What was decided or left out", imported.notes);
  return out;
}

Result export_result(const Scene& scene, const std::vector<std::string>& settings, const std::string& pose,
                     std::size_t positions, const std::vector<ExportedFormat>& exported) {
  Result out = scene_result(scene, settings);
  out.verdict = good(fmt::format("The mechanism {}.", positions > 1     ? fmt::format("in {} positions", positions)
                                                      : pose == "start" ? "as it is assembled from its start"
                                                      : pose == "equilibrium" ? "in its equilibrium"
                                                                              : "in a position of its path"));
  out.content.data("pose", pose);
  std::vector<std::string> notes;
  for (const ExportedFormat& one : exported) {
    for (const std::string& note : one.notes) notes.push_back(fmt::format("{}: {}", one.format->name, note));
  }
  out.content.data("formats", each(exported, [](const ExportedFormat& one) { return std::string(one.format->name); }));
  out.content.list("notes", "What the files do not have", notes);
  return out;
}

}  // namespace poise::app
