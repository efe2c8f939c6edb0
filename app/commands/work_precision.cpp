#include "app/commands/work_precision.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "app/commands/session.hpp"
#include "app/interrupt.hpp"
#include "app/report/work_precision_report.hpp"
#include "app/work_precision_files.hpp"
#include "model/named_number.hpp"

namespace poise::app {
namespace {

constexpr double tightest = 1e-20, loosest = 1.0;

double read_tolerance(std::string_view text) {
  const std::optional<double> value = read_number(text);
  const std::string expected = "expected numbers as in 1e-2..1e-14 or 1e-3,1e-6";
  // A point in front is what is left of three between two numbers.
  if (!value || text.starts_with('.')) {
    throw InputError(fmt::format("--tolerances: \"{}\" is not a number; {}", text, expected));
  }
  if (!(*value >= tightest && *value < loosest)) {
    throw InputError(
        fmt::format("--tolerances: expected numbers from {:g} to less than {:g}, found {}", tightest, loosest, text));
  }
  return *value;
}

std::vector<double> decades(std::string_view from, std::string_view to) {
  const double first = read_tolerance(from), last = read_tolerance(to);
  if (first < last) {
    throw InputError(
        fmt::format("--tolerances: {}..{} rises; expected the loosest first, say {}..{}", from, to, to, from));
  }
  constexpr double rounding = 1e-9;
  std::vector<double> out;
  for (double value = first; value >= last * (1 - rounding); value /= 10) {
    // Read back from 12 digits, so that 1e-5 is the number 1e-5.
    out.push_back(std::stod(fmt::format("{:.12g}", value)));
  }
  return out;
}

}  // namespace

std::vector<double> read_tolerances(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots != std::string::npos) {
    const std::string_view all = text;
    return decades(all.substr(0, dots), all.substr(dots + 2));
  }
  std::vector<double> out;
  // A comma at the end leaves an empty value behind it, which getline would not give.
  std::istringstream list(text + (text.empty() || text.back() == ',' ? "," : ""));
  for (std::string value; std::getline(list, value, ',');) out.push_back(read_tolerance(value));
  std::sort(out.begin(), out.end(), std::greater<>());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

int run_work_precision(const Request& request, comparison::WorkPrecisionOptions options, const Palette& palette) {
  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  OutputFiles files(request);
  if (files.wants_svg()) expect_plotter();
  options.interrupt = &watch_for_interrupt();
  options.progress = [&progress](const std::string& doing) { progress.now(doing); };
  const comparison::WorkPrecision result = comparison::work_precision(model, options);

  std::string written;
  if (!result.interrupted) {
    progress.now("writing the result");
    written = files.write(files.wants_json() ? work_precision_json(model, result, request.settings) : "",
                          files.wants_svg() ? draw_plot(work_precision_panels(model, result)) : "",
                          files.wants_csv() ? work_precision_csv(result) : "");
  }
  progress.done();
  print(work_precision_report(model, result, options, palette) + (written.empty() ? "" : "\n" + written));
  const bool any = std::any_of(result.rows.begin(), result.rows.end(),
                               [](const comparison::WorkPrecisionRow& row) { return status_of(row) == "confirmed"; });
  return any && !result.interrupted ? solved : not_solved;
}

}  // namespace poise::app
