#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/terminal/interrupt.hpp"
#include "app/view/served_view.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

struct ViewRequest {
  std::optional<std::string> scene;
  int port = 0;
  std::optional<std::string> frame_origin;
  bool no_browser = false;
};

int run_view(const ViewRequest& request, const Palette&) {
  const std::atomic<bool>& interrupt = watch_for_interrupt();
  const ViewedScene scene =
      request.scene ? ViewedScene(std::filesystem::path(*request.scene)) : ViewedScene(new_scene());
  std::error_code unknown;
  const bool is_new = !request.scene || !std::filesystem::exists(*request.scene, unknown);
  ServedView view(scene, {.port = request.port, .frame_origin = request.frame_origin}, interrupt);
  const bool opened = !request.no_browser && open_in_browser(view.address());
  print(fmt::format(
      "{} is shown at\n  {}\n{}Ctrl-C ends it.\n",
      request.scene ? one_line(*request.scene) + (is_new ? ", an empty sheet as there is no such file," : "")
                    : "An empty sheet",
      view.address(),
      opened || request.no_browser ? "" : "No program to open it with was found; open it in a browser.\n"));
  view.run();
  return solved;
}

}  // namespace

Command view_command() {
  const auto request = std::make_shared<ViewRequest>();
  Command command{"view", "Show a scene in the browser: drag joints and loads, and see every equilibrium"};
  command
      .add(
          {"SCENE", &request->scene, "", "Scene file (TOML); one that is not there yet, or none, opens an empty sheet"})
      .reads("toml");
  command.add({"--port", &request->port, "N", "Port of 127.0.0.1 to listen on (0, the default: any that is free)"});
  command.add({"--frame-origin", &request->frame_origin, "ORIGIN",
               "Let pages of this origin, \"http://localhost:8888\", say, show the scene in a frame\n"
               "(without it no page can)"});
  command.add({"--no-browser", &request->no_browser, "", "Print the address, but do not open it"});
  command.run = [request](const Palette& palette) { return run_view(*request, palette); };
  return command;
}

}  // namespace poise::app
