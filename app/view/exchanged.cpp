#include "app/view/exchanged.hpp"

#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "exchange/formats.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"

namespace poise::app {

using nlohmann::json;

std::string imported_text(const json& request) {
  const std::string name = one_line(std::filesystem::path(request.at("name").get<std::string>()).filename().string());
  const std::string text = request.at("text");
  if (text.find('\0') != std::string::npos) throw InputError(name + ": expected a text, found a NUL byte");
  std::string out = text_with_notes(readable_format(name, "").read(text, name, {}));
  parse_scene(out, "the scene of " + name);
  return out;
}

json exported_json(const json& request, const Scene& scene, const std::vector<BodyPose<double>>& poses) {
  const std::string wanted = request.at("format");
  std::vector<std::string> known;
  for (const FileFormat& format : formats()) {
    if (format.write == nullptr) continue;
    known.emplace_back(format.name);
    if (format.name != wanted) continue;
    const Exported exported = format.write(scene, poses);
    return {{"exported", {{"text", exported.text}, {"notes", exported.notes}}}};
  }
  throw InputError(
      fmt::format("expected a format, found \"{}\"{}", one_line(wanted), did_you_mean_or_list(wanted, known)));
}

json exchange_json() {
  json out = {{"read", json::array()}, {"write", json::array()}};
  for (const FileFormat& format : formats()) {
    if (format.read != nullptr) out["read"].push_back(std::string(format.ending));
    if (format.write == nullptr) continue;
    out["write"].push_back({{"name", format.name}, {"ending", format.ending}, {"what", format.what}});
  }
  return out;
}

}  // namespace poise::app
