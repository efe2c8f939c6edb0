#include "app/view/page_commands.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/commands.hpp"
#include "app/present/document.hpp"
#include "app/present/html.hpp"
#include "model/input_error.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/scene.hpp"
#include "model/text_file.hpp"

namespace poise::app {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t most_files = 200;
constexpr std::uintmax_t largest_experiment = 1 << 20U;  // bytes

std::string as_text(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

/// Whether a line says scene = "NAME" of a scene in the same folder.
bool names_scene(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    if (line.starts_with(fmt::format("scene=\"{}\"", name)) || line.starts_with(fmt::format("scene='{}'", name))) {
      return true;
    }
  }
  return false;
}

/// The files that a word may name: those in the folder of the scene with an ending, written as the scene's own name is.
std::vector<std::string> files_beside(const ShownScene& shown, const Option& option) {
  std::vector<std::string> out;
  if (!shown.has_file) return out;
  const fs::path folder = shown.file.parent_path();
  std::error_code unknown;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, unknown)) {
    const fs::path& path = entry.path();
    if (out.size() == most_files) break;
    if (path.extension() != "." + option.ending || !entry.is_regular_file(unknown)) continue;
    if (path.filename() == shown.file.filename()) continue;
    if (option.name == "EXPERIMENT") {
      if (entry.file_size(unknown) > largest_experiment) continue;
      try {
        if (!names_scene(read_text_file(path), shown.file.filename().string())) continue;
      } catch (const InputError&) {
        continue;
      }
    }
    out.push_back((folder / path.filename()).string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool is_offered(const Option& option) { return option.use != Use::output && option.name != "SCENE"; }

/// The option as a part of a form.
json form_of(const Option& option, const ShownScene& shown) {
  json out = {{"name", option.name},
              {"kind", kind_of(option)},
              {"value", option.value},
              {"help", option.help},
              {"required", option.presence == Presence::required},
              {"choices", option.choices},
              {"is_file", option.use == Use::file_read}};
  if (option.use == Use::file_read) out["choices"] = files_beside(shown, option);
  return out;
}

json forms(const ShownScene& shown) {
  json out = json::array();
  for (const CommandEntry& entry : all_commands()) {
    if (entry.in_page != InPage::of_scene && entry.in_page != InPage::of_experiment) continue;
    json options = json::array();
    bool has_files = true;
    for (const Option& option : entry.command.options) {
      if (!is_offered(option)) continue;
      options.push_back(form_of(option, shown));
      const json& form = options.back();
      has_files = has_files && !(form["is_file"] && form["required"] && form["choices"].empty());
    }
    if (!has_files) continue;
    out.push_back({{"name", entry.command.name},
                   {"help", entry.command.help},
                   {"example", entry.example},
                   {"options", std::move(options)}});
  }
  return out;
}

/// Throws InputError for an option that the page does not offer, or a file that is not beside the scene.
void check_option(const Command& command, const GivenOption& given, const ShownScene& shown) {
  const Option& option = option_named(command, given.first);
  if (!is_offered(option)) {
    throw InputError(
        fmt::format("poise: {}: expected an option that the page offers; use it on the command line", given.first));
  }
  if (option.use != Use::file_read) return;
  const std::vector<std::string> known = files_beside(shown, option);
  if (std::find(known.begin(), known.end(), given.second) != known.end()) return;
  throw InputError(fmt::format("poise: {}: expected a file .{} in the folder of the scene, found \"{}\"{}", given.first,
                               option.ending, one_line(given.second), did_you_mean(given.second, known)));
}

}  // namespace

PageCommands::~PageCommands() {
  if (run_) run_->caller.interrupt = true;
  if (thread_.joinable()) thread_.join();
}

bool PageCommands::takes(const std::string& request) {
  constexpr std::array<std::string_view, 4> known = {"commands", "run", "result", "stop"};
  return std::find(known.begin(), known.end(), request) != known.end();
}

std::string PageCommands::answer(const json& request, const ShownScene& shown) {
  const std::string what = request.at("do").get<std::string>();
  if (what == "run") start(request, shown);
  std::string more;
  if (what == "commands") more = fmt::format(",\"commands\":{}", as_text(forms(shown)));
  if (what == "stop" && run_) {
    const std::lock_guard<std::mutex> lock(mutex_);
    run_->stopped = run_->stopped || !run_->ended;
    run_->caller.interrupt = true;
  }
  if (what == "result" && request.value("html", false)) more = fmt::format(",\"html\":{}", as_text(json(html())));
  return fmt::format("{{\"revision\":{},\"run\":{}{}}}", shown.revision, present(), more);
}

void PageCommands::start(const json& request, const ShownScene& shown) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (run_ && !run_->ended)
      throw InputError(fmt::format("poise {} is still running; stop it first, or wait", run_->command));
  }
  const std::string name = request.at("command").get<std::string>();
  const std::vector<CommandEntry> commands = all_commands();
  const Command& command = command_named(commands, name);
  const auto entry =
      std::find_if(commands.begin(), commands.end(), [&](const auto& one) { return one.command.name == name; });
  if (entry->in_page != InPage::of_scene && entry->in_page != InPage::of_experiment)
    throw InputError(fmt::format("poise: {}: expected a command that the page offers; use the command line", name));
  auto run = std::make_unique<Run>();
  run->shown = shown;
  run->command = name;
  if (entry->in_page == InPage::of_scene) run->options.emplace_back("SCENE", shown.file.string());
  for (const json& one : request.value("options", json::array())) {
    GivenOption given{one.at(0).get<std::string>(), one.size() > 1 ? one.at(1).get<std::string>() : ""};
    check_option(command, given, shown);
    run->options.push_back(std::move(given));
  }
  run->line = line_of(name, run->options);
  run->caller.wants_pictures = true;
  run->caller.wants_svg = false;
  if (thread_.joinable()) thread_.join();
  run_ = std::move(run);
  run_->caller.listener = [this](const std::string& doing) {
    const std::lock_guard<std::mutex> lock(mutex_);
    run_->doing = doing;
  };
  thread_ = std::thread([this] { work(*run_); });
}

void PageCommands::work(Run& run) {
  std::string error, document;
  try {
    run.caller.scene = std::make_shared<const Scene>(parse_scene(run.shown.text, run.shown.file.string()));
    call(run.command, run.options, run.caller);
    const Outcome& outcome = run.caller.outcome;
    document = as_text(page_document(outcome.result, outcome.origin, outcome.pictures.figures));
  } catch (const InputError& failed) {
    error = one_line(failed.what());
  } catch (const std::exception& failed) {
    error = one_line(std::string("poise: failed: ") + failed.what());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  run.error = std::move(error);
  run.document = std::move(document);
  run.ended = true;
}

/// What is run, or was run last, with the document of its page where there is one; null where nothing was.
std::string PageCommands::present() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!run_) return "null";
  const char* const state = !run_->ended ? "running" : !run_->error.empty() ? "failed" : "done";
  json options = json::array();
  for (const auto& [name, word] : run_->options) {
    if (name != "SCENE") options.push_back(word.empty() ? json::array({name}) : json::array({name, word}));
  }
  const json out = {
      {"command", run_->command}, {"options", std::move(options)}, {"line", run_->line}, {"of", run_->shown.revision},
      {"text", run_->shown.text}, {"saved", run_->shown.is_saved}, {"state", state},     {"stopped", run_->stopped},
      {"doing", run_->doing},     {"error", run_->error}};
  std::string text = as_text(out);
  if (!run_->document.empty()) text.insert(text.size() - 1, ",\"page\":" + run_->document);
  return text;
}

/// The page that --html writes. Throws InputError where there is no result.
std::string PageCommands::html() const {
  std::string document;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (run_) document = run_->document;
  }
  if (document.empty()) throw InputError("there is no result; expected one of a command that has ended");
  return html_page(json::parse(document));
}

}  // namespace poise::app
