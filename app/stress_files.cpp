#include "app/stress_files.hpp"

#include <array>
#include <vector>

#include "app/csv_file.hpp"
#include "app/json_parts.hpp"
#include "app/quantity.hpp"

namespace poise::app {
namespace {

using comparison::CaseResult;
using comparison::HardCase;
using comparison::StressOutcome;

std::string expected(const HardCase& hard) {
  switch (hard.expect) {
    case comparison::Expect::locked:
      return "locked";
    case comparison::Expect::none:
      return "none";
    case comparison::Expect::equilibrium:
      break;
  }
  return "equilibrium";
}

Json json_cell(const comparison::Cell& cell, const std::string& method) {
  return {{"method", method},
          {"refused", cell.refused},
          {"starts", cell.starts},
          {"arrived", cell.arrived},
          {"inexact", cell.inexact},
          {"wrong", cell.wrong},
          {"denied", cell.denied},
          {"iterations", json_number(cell.iterations)},
          {"microseconds", json_number(cell.microseconds)},
          {"error", json_number(cell.error)},
          {"allowed", json_number(cell.allowed)},
          {"why", cell.why}};
}

}  // namespace

std::string stress_csv(const StressOutcome& outcome) {
  const std::vector<std::string> header = {"case",    "kind",       "expect",       "method",  "why",
                                           "refused", "starts",     "arrived",      "inexact", "wrong",
                                           "denied",  "iterations", "microseconds", "error",   "allowed"};
  std::vector<std::vector<std::string>> words(5);
  std::vector<std::vector<double>> columns(10);
  for (const CaseResult& result : outcome.results) {
    for (std::size_t k = 0; k < result.cells.size(); ++k) {
      const comparison::Cell& cell = result.cells[k];
      const std::array<std::string, 5> text = {result.hard.name, result.hard.kind, expected(result.hard),
                                               outcome.methods[k], cell.why};
      const std::array<double, 10> numbers = {static_cast<double>(cell.refused),
                                              static_cast<double>(cell.starts),
                                              static_cast<double>(cell.arrived),
                                              static_cast<double>(cell.inexact),
                                              static_cast<double>(cell.wrong),
                                              static_cast<double>(cell.denied),
                                              or_gap(cell.iterations),
                                              or_gap(cell.microseconds),
                                              or_gap(cell.error),
                                              or_gap(cell.allowed)};
      for (std::size_t c = 0; c < text.size(); ++c) words[c].push_back(text[c]);
      for (std::size_t c = 0; c < numbers.size(); ++c) columns[c].push_back(numbers[c]);
    }
  }
  return csv_text(header, columns, words);
}

std::string stress_json(const StressOutcome& outcome, const std::string& command) {
  Json out = {{"poise", POISE_VERSION}, {"command", command}, {"interrupted", outcome.interrupted}};
  out["cases"] = Json::array();
  for (const CaseResult& result : outcome.results) {
    const HardCase& hard = result.hard;
    Json entry = {{"name", hard.name},
                  {"kind", hard.kind},
                  {"title", hard.title},
                  {"source", hard.source},
                  {"seek", hard.seek == Seek::stable ? "stable" : "nearest"},
                  {"expect", expected(hard)},
                  {"why", hard.why},
                  {"methods", Json::array()}};
    for (std::size_t k = 0; k < result.cells.size(); ++k) {
      entry["methods"].push_back(json_cell(result.cells[k], outcome.methods[k]));
    }
    out["cases"].push_back(entry);
  }
  return json_text(out, Scene());
}

}  // namespace poise::app
