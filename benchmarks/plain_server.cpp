#include "benchmarks/plain_server.hpp"

#include <iostream>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "benchmarks/baseline_scenes.hpp"
#include "benchmarks/plain_scene.hpp"
#include "statics/model/static_model.hpp"

namespace poise::benchmarks {
namespace {

// One scene, in its scaled units.
struct Baseline {
  Baseline(const std::string& scene, const MakePlainSolver& make)
      : model(baseline_scene(scene)), solver(make(plain(model.scaled_scene()))) {}

  std::string solve(int method, double accuracy, int times) {
    const PlainSolver::Result result = solver->solve(method, accuracy, times);
    return fmt::format("{} {} {} {}", result.seconds, result.evaluations, result.claimed ? 1 : 0,
                       fmt::join(coordinates(model, result.pose), " "));
  }

  StaticModel model;
  std::unique_ptr<PlainSolver> solver;
};

std::string answer(std::unique_ptr<Baseline>& baseline, const std::string& methods, const MakePlainSolver& make,
                   const std::string& line) {
  std::istringstream words(line);
  std::string request;
  words >> request >> std::ws;
  if (request == "methods") return methods;
  if (request == "scene") {
    std::string name;
    std::getline(words, name);
    baseline = std::make_unique<Baseline>(name, make);
    return "";
  }
  if (request == "start") {
    std::vector<double> x;
    for (double value = 0.0; words >> value;) x.push_back(value);
    baseline->solver->start_from(plain_pose(baseline->model, x));
    return "";
  }
  int method = 0, times = 0;
  double accuracy = 0.0;
  if (request != "solve" || !(words >> method >> accuracy >> times)) throw std::runtime_error("unknown: " + line);
  return baseline->solve(method, accuracy, times);
}

}  // namespace

void serve_plain(std::FILE* out, const std::string& methods, const MakePlainSolver& make) {
  std::unique_ptr<Baseline> baseline;
  for (std::string line; std::getline(std::cin, line);) {
    std::string said;
    try {
      said = "ok " + answer(baseline, methods, make, line);
    } catch (const std::exception& error) {
      said = std::string("no ") + error.what();
      for (char& c : said) c = c == '\n' ? ' ' : c;
    }
    fmt::print(out, "{}\n", said);
    std::fflush(out);
  }
}

}  // namespace poise::benchmarks
