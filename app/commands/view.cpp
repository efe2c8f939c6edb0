#include <charconv>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/present/html.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/view/server.hpp"
#include "app/view/view_session.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

struct ViewRequest {
  std::string scene;
  int port = 0;
  bool no_browser = false;
};

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

int run_view(const ViewRequest& request, const Palette&) {
  expect_between("--port", request.port, 0, 65535);
  const std::atomic<bool>& interrupt = watch_for_interrupt();
  ViewSession session(request.scene, &interrupt);
  LocalServer server({.page = [&] { return html_page(session.page()); },
                      .act = [&](const std::string& body) { return answer(session, body); },
                      .poll = [&](const std::string& revision) { return answer_poll(session, revision); },
                      .shared = [&] { return session.report(); }},
                     request.port);
  const bool opened = !request.no_browser && open_in_browser(server.address());
  print(
      fmt::format("{} is shown at\n  {}\n{}Ctrl-C ends it.\n", one_line(request.scene), server.address(),
                  opened || request.no_browser ? "" : "No program to open it with was found; open it in a browser.\n"));
  server.run(interrupt);
  return solved;
}

}  // namespace

Command view_command() {
  const auto request = std::make_shared<ViewRequest>();
  Command command{"view", "Show a scene in the browser: drag joints and loads, and see every equilibrium"};
  command.add({"SCENE", &request->scene, "", "Scene file (TOML)", Presence::required});
  command.add({"--port", &request->port, "N", "Port of 127.0.0.1 to listen on (0, the default: any that is free)"});
  command.add({"--no-browser", &request->no_browser, "", "Print the address, but do not open it"});
  command.run = [request](const Palette& palette) { return run_view(*request, palette); };
  return command;
}

}  // namespace poise::app
