#include "app/report/experiment_parts.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

// More parameters than this have no table of correlations that anyone could read.
constexpr int most_in_table = 12;
constexpr double close = 0.9;

std::string close_pairs(const FitProblem& problem, const Identifiability& known, const std::vector<std::size_t>& told) {
  std::string out;
  for (const std::size_t i : told) {
    for (const std::size_t j : told) {
      if (j >= i) continue;
      const double r = known.correlation[i][j].value();
      if (!(std::abs(r) > close)) continue;
      out += fmt::format("  {:+.3f}  {}, {}\n", r, problem.parameters()[j].name, problem.parameters()[i].name);
    }
  }
  return out.empty() ? fmt::format("  none beyond {}\n", close) : out;
}

}  // namespace

std::string heading(const Experiment& experiment, const Palette& palette) {
  return heading(experiment.title.empty() ? experiment.file : experiment.title, experiment.source, palette);
}

std::string what_is_asked(const FitProblem& problem) {
  bool rests = false;
  bool starts = false;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    rests = rests || problem.run(r).equilibrium_is_unknown();
    starts = starts || problem.run(r).start_is_unknown();
  }
  std::string text = count(static_cast<int>(problem.parameters().size()), "parameter", "parameters");
  if (!rests && !starts) return text;
  return text + fmt::format(", and {}: where the runs {}", count(problem.nuisances(), "nuisance", "nuisances"),
                            rests && starts ? "rest and start"
                            : rests         ? "rest"
                                            : "start");
}

std::string what_is_read(const FitProblem& problem) {
  const Experiment& experiment = problem.experiment();
  const auto measured =
      std::count_if(experiment.runs.begin(), experiment.runs.end(), [](const Run& run) { return !run.is_simulated(); });
  const int runs = static_cast<int>(experiment.runs.size());
  std::string what = fmt::format("{} run{}", measured == 0 ? "simulated" : "measured", runs == 1 ? "" : "s");
  if (measured > 0 && measured < runs) what = fmt::format("runs, {} of them measured", measured);
  return fmt::format("{} {}; {} readings of {}", runs, what, problem.readings(),
                     count(static_cast<int>(experiment.sensors.size()), "sensor", "sensors"));
}

std::vector<std::string> parameter_units(const FitProblem& problem) {
  std::vector<std::string> units;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    units.push_back(problem.number(static_cast<int>(i)).dimension().unit_name(problem.experiment().scene.units));
  }
  return units;
}

std::string with_deviation(double value, double deviation) {
  if (!(deviation > 0) || !std::isfinite(deviation) || !std::isfinite(value)) return significant(value, 6);
  const int order = static_cast<int>(std::floor(std::log10(deviation)));
  const double size = std::max(std::abs(value), deviation);
  const int digits = static_cast<int>(std::floor(std::log10(size))) - order + 1;
  const bool plain = size >= 1e-4 && size < 1e7 && digits < 16;
  return plain ? fmt::format("{:.{}f}", value, std::max(0, 1 - order))
               : fmt::format("{:.{}e}", value, std::clamp(digits, 0, 15));
}

std::string per_cent(double deviation, double value) {
  if (value == 0 || !std::isfinite(deviation)) return "-";
  return significant(100 * deviation / std::abs(value), 2);
}

std::string correlation_section(const FitProblem& problem, const Identifiability& known, const Palette& palette) {
  if (!known.ok) return "";
  std::vector<std::size_t> told;
  for (std::size_t i = 0; i < known.identifiable.size(); ++i) {
    if (known.identifiable[i]) told.push_back(i);
  }
  if (told.size() < 2) return "";
  const std::string title = "Correlations of what is told";
  if (told.size() > most_in_table) return section(title, close_pairs(problem, known, told), palette);
  Table table;
  std::vector<std::string> names;
  for (const std::size_t i : told) names.push_back(problem.parameters()[i].name);
  table.add_text_column("", names);
  // Its columns are numbered by their rows: names would make it too wide.
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < told.size(); ++i) numbers.push_back(fmt::format("{}", i + 1));
  table.add_number_column("", numbers);
  for (std::size_t j = 0; j + 1 < told.size(); ++j) {
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < told.size(); ++i) {
      const double r = known.correlation[told[i]][told[j]].value();
      cells.push_back(i > j ? Cell{fmt::format("{:+.3f}", r), std::abs(r) > close ? Tone::doubtful : Tone::plain}
                            : Cell{"", Tone::plain});
    }
    table.add_text_column(numbers[j], cells);
  }
  return section(title, table.print(palette), palette);
}

std::string untold_section(const Identifiability& known, const Palette& palette) {
  std::string body;
  for (const Identifiability::Direction& direction : known.null_directions) {
    body += "  " + palette.paint(Tone::bad, direction.words) + "\n";
    body += "    " + palette.paint(Tone::faint, "remedy: ") + direction.remedy + "\n";
  }
  return section("What cannot be known", body, palette);
}

}  // namespace poise::app
