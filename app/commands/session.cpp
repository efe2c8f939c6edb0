#include "app/commands/session.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/draw/mechanism.hpp"
#include "app/present/csv.hpp"
#include "app/present/html.hpp"
#include "app/present/json.hpp"
#include "app/present/markdown.hpp"
#include "app/present/text.hpp"
#include "app/results/identification/fitted_numbers.hpp"
#include "model/named_files.hpp"
#include "model/one_line.hpp"
#include "model/set_parameter.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise::app {
namespace fs = std::filesystem;
namespace {

void expect_different(const std::string& a, const std::string& name_a, const std::string& b,
                      const std::string& name_b) {
  if (a.empty() || b.empty() || !same_file(a, b)) return;
  throw InputError(fmt::format("{}: \"{}\" is {} too; expected another file", name_a, a, name_b));
}

}  // namespace

std::vector<Figure> chart_figures(std::string title, std::vector<Panel> panels) {
  if (panels.empty()) return {};
  return {{.title = std::move(title), .charts = {.panels = std::move(panels)}}};
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  return fs::equivalent(a, b, unknown) || fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

Scene load_scene(const Request& request) { return at_time(load_moving_scene(request), 0.0); }

Scene load_moving_scene(const Request& request) {
  const bool is_given = request.caller != nullptr && request.caller->scene != nullptr;
  Scene scene = is_given ? *request.caller->scene : read_scene(request.scene);
  if (const std::optional<FittedNumbers> fit = load_fit(request, scene)) {
    for (const std::string& setting : request.settings) {
      for (const FittedNumbers::Number& number : fit->numbers) {
        // A number that the fit took as known may have another value here; it is none of the fit's then.
        if (number.origin != FittedNumbers::Number::Origin::estimated) continue;
        if (!setting.starts_with(number.path + "=")) continue;
        throw InputError(
            fmt::format("--set {}: --with {} has {} too; leave one of them out", setting, request.with, number.path));
      }
    }
    fit->put_into(scene);
  }
  for (const std::string& setting : request.settings) set_parameter(scene, setting);
  return scene;
}

std::optional<FittedNumbers> load_fit(const Request& request, const Scene& scene, const std::string& varied) {
  if (request.with.empty()) return std::nullopt;
  FittedNumbers out = read_fitted_numbers(request.with, scene);
  for (std::size_t i = out.numbers.size(); i-- > 0;) {
    if (out.numbers[i].path == varied) out.leave_out(i);
  }
  return out;
}

OutputFiles::OutputFiles(const Request& request, const std::vector<std::string>& read)
    : origin_{request.command, request.line}, caller_(request.caller) {
  if (request.quiet && request.verbose) throw InputError("--quiet: expected no --verbose beside it; leave one out");
  const auto add = [&](const std::string& option, const std::string& path) { outputs_.push_back({option, path, {}}); };
  add("--json", request.json);
  add("--svg", request.svg);
  add("--html", request.html);
  add("--csv", request.csv);
  add("--markdown", request.markdown);
  add("--scene", request.written_scene);
  add("--experiment", request.experiment);
  for (const auto& [option, path] : request.exported) add(option, path);
  std::vector<std::string> all_read = read;
  if (!request.with.empty()) all_read.push_back(request.with);
  const bool writes =
      std::any_of(outputs_.begin(), outputs_.end(), [](const Output& one) { return !one.path.empty(); });
  if (writes) {
    for (const std::string& file : files_named_from(request.scene)) all_read.push_back(file);
    for (const std::string& one : read) {
      for (const std::string& file : files_named_from(one)) all_read.push_back(file);
    }
  }
  for (const Output& output : outputs_) {
    expect_different(output.path, output.option, request.scene, "the " + request.kind);
    for (const std::string& other : all_read)
      expect_different(output.path, output.option, other, "a file that is read");
  }
  for (auto output = outputs_.begin(); output != outputs_.end(); ++output) {
    for (auto earlier = outputs_.begin(); earlier != output; ++earlier) {
      expect_different(output->path, output->option, earlier->path, "the " + earlier->option + " file");
    }
  }
  for (Output& output : outputs_) {
    if (!output.path.empty()) output.file.emplace(output.path, output.option);
  }
}

bool OutputFiles::wants_svg() const {
  return outputs_[Form::svg].file.has_value() ||
         (caller_ != nullptr && caller_->wants_pictures && caller_->wants_svg && has_plotter());
}

bool OutputFiles::wants_html() const {
  return outputs_[Form::html].file.has_value() || (caller_ != nullptr && caller_->wants_pictures);
}

bool OutputFiles::wants_csv() const { return outputs_[Form::csv].file.has_value() || caller_ != nullptr; }

std::string OutputFiles::write(const Result& result, const Pictures& pictures, const std::string& found,
                               const std::vector<std::string>& exported) {
  if (caller_ != nullptr) {
    caller_->outcome.pictures = pictures;
    caller_->outcome.written = found;
  }
  std::vector<OutputFile*> prepared;
  const auto prepare = [&](std::size_t form, auto&& text_of) {
    std::optional<OutputFile>& file = outputs_[form].file;
    const std::string text = file ? text_of() : std::string();
    if (text.empty()) return;
    file->prepare(text);
    prepared.push_back(&*file);
  };
  prepare(Form::json, [&] { return json_text(result); });
  prepare(Form::svg, [&] { return pictures.svg; });
  prepare(Form::html, [&] { return html_page(page_document(result, origin_, pictures.figures)); });
  prepare(Form::csv, [&] { return result.csv() != nullptr ? csv_text(*result.csv()) : ""; });
  prepare(Form::markdown, [&] { return markdown_text(result); });
  prepare(Form::scene, [&] { return found; });
  prepare(Form::experiment, [&] { return found; });
  for (std::size_t i = 0; i < exported.size(); ++i) prepare(Form::count + i, [&] { return exported[i]; });
  std::string lines;
  for (OutputFile* file : prepared) {
    file->commit();
    lines += "wrote " + one_line(file->path().string()) + "\n";
  }
  return lines;
}

void print(const Request& request, const Result& result, const std::string& written, const Palette& palette) {
  if (request.caller != nullptr) {
    request.caller->outcome.result = result;
    return;
  }
  if (request.quiet) return print(plain_text(result, palette, Verbosity::quiet));
  const Verbosity level = request.verbose ? Verbosity::verbose : Verbosity::normal;
  print(plain_text(result, palette, level) + (written.empty() ? "" : "\n" + written));
}

int finish(const Request& request, const Result& result, OutputFiles* files, const Pictures& pictures, bool is_solved,
           Progress& progress, const Palette& palette, const std::string& scene,
           const std::vector<std::string>& exported) {
  progress.now("writing the result");
  const std::string written = files != nullptr ? files->write(result, pictures, scene, exported) : "";
  progress.done();
  print(request, result, written, palette);
  return is_solved ? solved : not_solved;
}

Answer search(const StaticModel& model, const SolveOptions& options, Progress& progress) {
  progress.now("searching by " + to_string(options.method));
  Equilibrium equilibrium = solve(model, options);
  if (equilibrium.found()) progress.now("refining the answer of " + to_string(options.method) + " in 50 digits");
  return measure(model, std::move(equilibrium));
}

std::string picture(const StaticModel& model, const Answer& answer, const std::vector<SoughtQuantity>& shown) {
  const Equilibrium& equilibrium = answer.equilibrium;
  MechanismPicture out = picture_of(model, equilibrium, assemble(model));
  const RestingPlace place = resting_place(model, equilibrium.x, equilibrium.certificate.active_stops);
  for (const SoughtQuantity& one : shown) {
    if (one.kind != SoughtQuantity::Kind::center) continue;
    SoughtQuantity x = one, y = one;
    x.part = SoughtQuantity::Part::x;
    y.part = SoughtQuantity::Part::y;
    const std::vector<QuantityValue> at = quantity_values(place, {x, y});
    const std::vector<Body>& bodies = model.scene().bodies;
    const std::string name = "centre " + bodies[static_cast<std::size_t>(one.item)].name + ", " +
                             bodies[static_cast<std::size_t>(one.other)].name;
    const bool is_new =
        std::none_of(out.crosses.begin(), out.crosses.end(), [&](const auto& other) { return other.second == name; });
    if (is_new && at[0].why.empty() && at[1].why.empty())
      out.crosses.emplace_back(Vec2{at[0].value, at[1].value}, name);
  }
  return draw_mechanism(model.scene(), out);
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw InputError("cannot write to standard output; expected a place that takes the report");
  }
}

}  // namespace poise::app
