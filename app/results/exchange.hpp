#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "exchange/formats.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise::app {

/// What `poise import` shows: the mechanism that a file is, and what was decided or left out.
Result import_result(const FileFormat& format, const Imported& imported, const ScaledModel& model,
                     const Mobility& mobility);

/// What a scene loses in a format.
struct ExportedFormat {
  const FileFormat* format = nullptr;
  std::vector<std::string> notes;
};

/// What `poise export` shows of files in so many positions: of `pose`, the words of its option.
Result export_result(const Scene& scene, const std::vector<std::string>& settings, const std::string& pose,
                     std::size_t positions, const std::vector<ExportedFormat>& exported);

}  // namespace poise::app
