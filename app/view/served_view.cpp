#include "app/view/served_view.hpp"

#include <charconv>
#include <utility>

#include <nlohmann/json.hpp>

#include "app/present/html.hpp"

namespace poise::app {
namespace {

/// What the page sends is text of any kind: what is no JSON is answered like a request without a meaning.
std::string answer(ViewSession& session, const std::string& body) {
  const nlohmann::json request = nlohmann::json::parse(body, nullptr, false);
  const nlohmann::json known = request.is_object() ? request : nlohmann::json::object();
  return session.act(known);
}

std::string answer_poll(ViewSession& session, const std::string& revision) {
  long number = 0;
  std::from_chars(revision.data(), revision.data() + revision.size(), number);
  return session.poll(number).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

ViewSession opened_session(ViewedScene scene, const std::atomic<bool>& interrupt) {
  if (auto* const file = std::get_if<std::filesystem::path>(&scene)) return ViewSession(std::move(*file), &interrupt);
  return ViewSession(std::move(std::get<SceneInMemory>(scene)), &interrupt);
}

}  // namespace

ServedView::ServedView(ViewedScene scene, const Listening& listening, const std::atomic<bool>& interrupt)
    : interrupt_(interrupt),
      server_({.page = [this] { return html_page(session_.page()); },
               .act = [this](const std::string& body) { return answer(session_, body); },
               .poll = [this](const std::string& revision) { return answer_poll(session_, revision); },
               .shared = [this] { return session_.report(); }},
              listening),
      session_(opened_session(std::move(scene), interrupt)) {}

void ServedView::run() { server_.run(interrupt_); }

}  // namespace poise::app
