#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/view/view_session.hpp"

namespace poise::app_tests {

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
