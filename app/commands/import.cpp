#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/exchange.hpp"
#include "model/one_line.hpp"
#include "model/text_file.hpp"
#include "statics/model/mobility.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_bytes = std::size_t{16} << 20U;
const std::vector<std::string> length_units = {"m", "mm", "in", "ft"};

struct ImportRequest {
  Request common;
  std::string format;
  std::optional<std::string> units;
  std::optional<double> tolerance;
};

std::vector<std::string> readable_names() {
  std::vector<std::string> out;
  for (const FileFormat& format : formats()) {
    if (format.read != nullptr) out.emplace_back(format.name);
  }
  return out;
}

std::string readable_endings() {
  std::string out;
  for (const FileFormat& format : formats()) {
    if (format.read != nullptr) out += (out.empty() ? "" : " ") + std::string(format.ending);
  }
  return out;
}

std::string readable_help() {
  std::string out = "What the file is; without it its ending says so";
  for (const FileFormat& format : formats()) {
    if (format.read != nullptr) out += fmt::format("\n{} (.{}): {}", format.name, format.ending, format.what);
  }
  return out;
}

int run_import(const ImportRequest& request, const Palette& palette) {
  const Request& common = request.common;
  ImportOptions options;
  if (request.units) options.length = length_units[chosen("--units", *request.units, length_units)];
  if (request.tolerance) expect_number("--tolerance", *request.tolerance, *request.tolerance > 0, "a number > 0");
  options.tolerance = request.tolerance;
  Progress progress(common.listener());
  progress.now("reading the file");
  const FileFormat& format = readable_format(common.scene, request.format);
  const Imported imported = format.read(read_text_file(common.scene, most_bytes), common.scene, options);
  const std::string text = text_with_notes(imported);
  OutputFiles files(common);
  progress.now("analysing its mobility");
  Scene scene = parse_scene(text, "the scene of " + one_line(common.scene));
  scene.file = common.scene;
  const ScaledModel model(with_masses(std::move(scene)), Purpose::dynamics);
  const Result result = import_result(format, imported, model, analyse_mobility(model));
  progress.now("writing the result");
  const std::string written = files.write(result, {}, text);
  progress.done();
  // A scene that goes to no file is what was asked for: it is printed as it is, so that it can be redirected to one.
  const bool is_printed = common.caller == nullptr && common.written_scene.empty() && !common.quiet;
  if (is_printed) {
    print(text);
  } else {
    print(common, result, written, palette);
  }
  return solved;
}

}  // namespace

Command import_command() {
  const auto request = std::make_shared<ImportRequest>();
  request->common.kind = "file";
  Command command{"import", "Read a file of another program as a scene"};
  command.add({"FILE", &request->common.scene, "", "File of another program (docs/exchange.md)", Presence::required})
      .reads(readable_endings());
  command.add({"--format", &request->format, "NAME", readable_help()}).choices = readable_names();
  command
      .add({"--units", &request->units, "UNIT",
            "Unit of its lengths where the file names none: m, mm, in or ft\n(docs/exchange.md has the default of each "
            "format)"})
      .choices = length_units;
  command.add({"--tolerance", &request->tolerance, "L",
               "Distance at which two points of a drawing are one, in its unit (a\nmillionth of its size)"});
  command
      .add({"--scene", &request->common.written_scene, "FILE",
            "Write the scene to FILE; without it the scene is printed"})
      .writes("toml");
  add_output_options(command, request->common, {});
  command.run = [request](const Palette& palette) { return run_import(*request, palette); };
  return command;
}

}  // namespace poise::app
