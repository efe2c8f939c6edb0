#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/draw/figure_json.hpp"
#include "app/draw/frames.hpp"
#include "app/view/shown_mechanism.hpp"
#include "app/view/templates.hpp"
#include "model/input_error.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

using nlohmann::json;

json card_drawing(const SceneTemplate& one) {
  const ShownMechanism shown(parse_scene(one.text, std::string(one.file)), {});
  const Scene& scene = shown.scene();
  const MechanismPicture picture{.poses = shown.poses(), .loads = false};
  return json::parse(drawing_json(draw_frames({{.scene = &scene, .picture = picture}}, std::string(one.title), false)));
}

}  // namespace

json answer_templates(const json& request) {
  const std::vector<SceneTemplate>& all = scene_templates();
  json list = json::array();
  std::vector<std::string> names;
  for (const SceneTemplate& one : all) {
    list.push_back({{"name", one.name}, {"title", one.title}});
    names.emplace_back(one.name);
  }
  if (!request.contains("name")) return {{"templates", std::move(list)}};
  const std::string name = request.at("name").get<std::string>();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError(fmt::format("name: expected that of a template, found \"{}\"{}", one_line(name),
                                 did_you_mean_or_list(name, names)));
  }
  const SceneTemplate& one = all[static_cast<std::size_t>(found - names.begin())];
  return {{"text", one.text}, {"drawing", card_drawing(one)}};
}

}  // namespace poise::app
