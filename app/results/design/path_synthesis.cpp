#include "app/results/design/path_synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "design/synthesis/four_bar.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_links = 7;
constexpr int digits_of_path_errors = 4;
constexpr std::size_t shown_linkages = 10;
constexpr double rounding_of_links = 1e-9;  // of the size of the points, as here below
constexpr double rounding_of_path = 1e-11;
constexpr double degree_of_path = std::numbers::pi / 180;

bool is_four_bar(const PathProblem& problem) { return problem.linkage == PathLinkage::four_bar; }

std::string error_in_words(const PathProblem& problem, double si) {
  return significant(in_unit(si, Quantity::length, problem.units), digits_of_path_errors) + " " +
         problem.units.length_name;
}

double error_of(const PathProblem& problem, const PathSolution& of) {
  return problem.curve ? of.curve_largest : of.largest;
}

std::string target_of(const PathProblem& problem) {
  if (problem.curve) return "the curve";
  return fmt::format("the {} points", problem.points.size());
}

std::string linkages_in_words(const PathProblem& problem, int number) {
  return is_four_bar(problem) ? count(number, "four-bar", "four-bars") : count(number, "slider-crank", "slider-cranks");
}

Line verdict_of_path(const PathProblem& problem, const PathAnswer& answer) {
  const std::string kind = is_four_bar(problem) ? "four-bar" : "slider-crank";
  if (answer.solutions.empty()) return bad(fmt::format("No {} that keeps the limits was found.", kind));
  const PathSolution* const best = path_to_build(answer);
  const double error = error_of(problem, best != nullptr ? *best : answer.solutions.front());
  if (answer.within > 0) {
    const std::string found = fmt::format("Found {} through {}, to {}", linkages_in_words(problem, answer.within),
                                          target_of(problem), error_in_words(problem, problem.tolerance));
    if (best == nullptr) return bad(found + ", all with a defect; others are not excluded.");
    if (best->largest <= problem.tolerance) return good(found + "; others are not excluded.");
    return bad(found + ", all with a defect; one without misses them by " + error_in_words(problem, error) + ".");
  }
  if (best == nullptr) {
    return bad(fmt::format("No {} without a defect was found; the best with one misses {} by {}.", kind,
                           target_of(problem), error_in_words(problem, error)));
  }
  const std::string near = fmt::format("misses {} by {} at most", target_of(problem), error_in_words(problem, error));
  if (problem.exact()) {
    return bad(fmt::format("No {} through {} was found; the nearest {}. Others are not excluded.", kind,
                           target_of(problem), near));
  }
  if (problem.within_error && error > *problem.within_error) {
    return bad(fmt::format("The best {} found {}, more than {}; better ones are not excluded.", kind, near,
                           error_in_words(problem, *problem.within_error)));
  }
  if (!best->converged) return bad(fmt::format("The best {} found {}, and its fit has not ended.", kind, near));
  return good(fmt::format("The best {} found {}; better ones are not excluded.", kind, near));
}

void add_dimensions_of_linkages(Group& group, const PathProblem& problem, const std::vector<PathSolution>& shown) {
  const auto length = [&](double si) { return in_unit(si, Quantity::length, problem.units); };
  const auto at = [&](int j) { return each(shown, [&](const PathSolution& s) { return length(s.x[j]); }); };
  const auto link = [&](int j) { return each(shown, [&](const PathSolution& s) { return length(std::exp(s.x[j])); }); };
  Format format{Format::Style::significant, digits_of_links};
  format.zero_below = length(rounding_of_links * problem.size);
  Table& table = group.table("", fmt::format("Linkages ({})", problem.units.length_name), Rows::list);
  std::vector<double> number;
  for (std::size_t k = 0; k < shown.size(); ++k) number.push_back(static_cast<double>(k + 1));
  table.counts("", "no.", std::move(number));
  table.numbers("", "A x", "", at(at_a), format);
  table.numbers("", "A y", "", at(at_a + 1), format);
  if (is_four_bar(problem)) {
    table.numbers("", "B x", "", at(at_b), format);
    table.numbers("", "B y", "", at(at_b + 1), format);
  } else {
    table.numbers("", "line (deg)", "", each(shown, [](const PathSolution& s) { return s.x[at_b] / degree_of_path; }),
                  format);
    table.numbers("", "its distance", "", at(at_b + 1), format);
  }
  table.numbers("", "crank", "", link(at_crank), format);
  table.numbers("", "coupler", "", link(at_coupler), format);
  if (is_four_bar(problem)) table.numbers("", "output", "", link(at_output), format);
  table.numbers("", "P x", "", at(at_point), format);
  table.numbers("", "P y", "", at(at_point + 1), format);
  table.footnotes.emplace_back(
      is_four_bar(problem) ? "A: pivot of the crank, B: of the output link; P: in the frame of the coupler, whose "
                             "x axis goes from the crank's pin to the other"
                           : "A: pivot of the crank; the slider's line by its direction and its distance from A, "
                             "positive to the left; P: in the frame of the coupler, x from crank to slider");
}

void add_motions_of_linkages(Group& group, const PathProblem& problem, const std::vector<PathSolution>& shown) {
  const auto length = [&](double si) { return in_unit(si, Quantity::length, problem.units); };
  Format format{Format::Style::significant, digits_of_path_errors};
  format.zero_below = length(rounding_of_path * problem.size);
  Table& table = group.table("", "How they move", Rows::list);
  std::vector<double> number;
  for (std::size_t k = 0; k < shown.size(); ++k) number.push_back(static_cast<double>(k + 1));
  table.counts("", "no.", std::move(number));
  table.numbers("", "largest error", problem.units.length_name,
                each(shown, [&](const PathSolution& s) { return length(error_of(problem, s)); }), format);
  table.numbers("", "rms", problem.units.length_name,
                each(shown, [&](const PathSolution& s) { return length(problem.curve ? s.curve_rms : s.rms); }),
                format);
  table.numbers("", "transmission", "deg",
                each(shown, [](const PathSolution& s) { return s.transmission / degree_of_path; }),
                {Format::Style::significant, 3});
  table.words("", "crank", each(shown, [](const PathSolution& s) -> std::string {
                return s.range.full() ? "turns fully" : "swings";
              }));
  if (is_four_bar(problem)) {
    table.words("", "kind",
                each(shown, [](const PathSolution& s) { return to_string(grashof_kind(four_bar_of(s.x))); }));
  }
  table.words("", "defect", each(shown, [](const PathSolution& s) { return to_string(s.defects); })).tones =
      each(shown, [](const PathSolution& s) { return s.defects.any() ? Tone::bad : Tone::good; });
}

void add_four_bar_data(Group& group, const FourBar& linkage, const PathProblem& problem) {
  const auto length = [&](double si) { return in_unit(si, Quantity::length, problem.units); };
  const auto place = [&](const Vec2& at) { return std::vector<double>{length(at.x), length(at.y)}; };
  group.data("input_pivot", place(linkage.a));
  group.data("output_pivot", place(linkage.b));
  group.data("input", length(linkage.input));
  group.data("coupler", length(linkage.coupler));
  group.data("output", length(linkage.output));
  group.data("point", place(linkage.point));
}

void add_linkage_data(Group& group, const PathProblem& problem, const PathSolution& solution) {
  const auto length = [&](double si) { return in_unit(si, Quantity::length, problem.units); };
  const PathVector& x = solution.x;
  if (is_four_bar(problem)) {
    const FourBar linkage = four_bar_of(x);
    add_four_bar_data(group, linkage, problem);
    group.data("grashof", to_string(grashof_kind(linkage)));
    Branch& cognates = group.array("cognates");
    for (const FourBar& cognate : roberts_cognates(linkage)) {
      Group& one = cognates.parts.emplace_back();
      add_four_bar_data(one, cognate, problem);
      one.data("grashof", to_string(grashof_kind(cognate)));
    }
  } else {
    group.data("input_pivot", std::vector<double>{length(x[at_a]), length(x[at_a + 1])});
    group.data("line", x[at_b] / degree_of_path);
    group.data("line_distance", length(x[at_b + 1]));
    group.data("input", length(std::exp(x[at_crank])));
    group.data("coupler", length(std::exp(x[at_coupler])));
    group.data("point", std::vector<double>{length(x[at_point]), length(x[at_point + 1])});
  }
  std::vector<double> angles;
  std::vector<std::int64_t> closures;
  for (const PathVisit& visit : solution.visits) {
    angles.push_back(visit.angle / degree_of_path);
    closures.push_back(visit.closure);
  }
  group.data("input_angles", std::move(angles));
  group.data("closures", std::move(closures));
  group.data("largest_error", length(solution.largest));
  group.data("rms_error", length(solution.rms));
  if (problem.curve) {
    group.data("largest_curve_error", length(solution.curve_largest));
    group.data("rms_curve_error", length(solution.curve_rms));
  }
  group.data("converged", solution.converged);
  group.data("transmission", solution.transmission / degree_of_path);
  group.data("full_turn", solution.range.full());
  group.data("defect", solution.defects.any() ? Value(to_string(solution.defects)) : Value());
}

}  // namespace

const PathSolution* path_to_build(const PathAnswer& answer) {
  if (answer.solutions.empty() || answer.solutions.front().defects.any()) return nullptr;
  return &answer.solutions.front();
}

bool path_is_met(const PathProblem& problem, const PathAnswer& answer) {
  const PathSolution* const best = path_to_build(answer);
  if (best == nullptr) return false;
  if (best->largest <= problem.tolerance) return true;
  return !problem.exact() && best->converged &&
         (!problem.within_error || error_of(problem, *best) <= *problem.within_error);
}

Result path_synthesis_result(const PathProblem& problem, const PathAnswer& answer, const PathSearchOptions& options,
                             double microseconds) {
  Result out;
  out.title = problem.title.empty() ? problem.file : problem.title;
  out.source = problem.source;
  out.verdict = verdict_of_path(problem, answer);
  if (answer.interrupted) {
    out.warnings.push_back(
        doubtful(fmt::format("Interrupted: {} of {} starts were searched.", answer.starts, options.starts)));
  }
  Group& content = out.content;
  Group& design = content.group("design", "", Verbosity::data);
  design.data("file", problem.file);
  design.data("title", problem.title);
  design.data("source", problem.source);
  add_units(content, problem.units);
  content.data("kind", "path");
  content.data("linkage", is_four_bar(problem) ? "four-bar" : "slider-crank");
  content.data("met", path_is_met(problem, answer));
  content.data("exact", problem.exact());
  content.data("tolerance", in_unit(problem.tolerance, Quantity::length, problem.units));
  content.data("through_all", answer.within);
  content.data("starts", answer.starts);
  content.data("converged", answer.converged);
  content.data("interrupted", answer.interrupted);
  content.data("seed", options.seed);
  Branch& linkages = content.array("linkages");
  for (const PathSolution& solution : answer.solutions) {
    add_linkage_data(linkages.parts.emplace_back(), problem, solution);
  }
  const std::vector<PathSolution> shown(
      answer.solutions.begin(),
      answer.solutions.begin() + static_cast<std::ptrdiff_t>(std::min(shown_linkages, answer.solutions.size())));
  add_dimensions_of_linkages(content, problem, shown);
  add_motions_of_linkages(content, problem, shown);
  if (answer.within > 0 && problem.freedom() > 0) {
    content.note(fmt::format("A {} can pass more points: infinitely many pass these, of which some are found.",
                             is_four_bar(problem) ? "four-bar" : "slider-crank"));
  }
  if (answer.solutions.size() > shown.size()) {
    content.note(fmt::format("{} more are in the data (--json).", answer.solutions.size() - shown.size()));
  }
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("search", fmt::format("{}, {} at a linkage that keeps the limits, {}",
                                      count(answer.starts, "random start", "random starts"),
                                      count(answer.converged, "fit ended", "fits ended"), duration(microseconds)));
  return out;
}

}  // namespace poise::app
