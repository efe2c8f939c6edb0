#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/view/view_session.hpp"

namespace poise::app_tests {

/// A crank, a rod and a block that slides along x, on which every tool has something to draw.
inline constexpr const char* slider_crank = R"([units]
length = "mm"
angle = "deg"
[ground]
points = { A = [0, 0], D = [300, 0], S = [0, 200] }
[body.crank]
points = { A = [0, 0], B = [100, 0] }
[body.rod]
points = { B = [0, 0], C = [200, 0], G = [100, 50] }
[body.block]
points = { C = [0, 0], E = [40, 0] }
mass = 2
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin]]
points = ["rod.C", "block.C"]
[[slide]]
name = "guide"
points = ["ground.A", "block.C"]
axis = [1, 0]
[start]
crank = 60
rod = -25.66
guide = 230.28
)";

/// A hand that draws on a sheet, in the units of the scene.
class Hand {
 public:
  explicit Hand(const std::string& file) : session(file) {}

  /// Asks as a page does that has seen the present state.
  nlohmann::json ask(nlohmann::json request) {
    request["revision"] = session.poll(0)["revision"];
    return nlohmann::json::parse(session.act(request));
  }
  nlohmann::json draw(const std::string& tool, const std::vector<std::vector<double>>& at,
                      const nlohmann::json& values = nlohmann::json::object()) {
    ++gestures;
    return ask({{"do", "draw"}, {"tool", tool}, {"at", at}, {"within", 8.0}, {"grain", 0.001}, {"values", values}});
  }
  nlohmann::json look() { return ask({{"do", "look"}}); }
  std::string text() { return look()["text"]; }

  app::ViewSession session;
  int gestures = 0;
};

inline std::string error_of(const nlohmann::json& answer) {
  return answer.contains("error") ? answer["error"]["text"] : "";
}

}  // namespace poise::app_tests
