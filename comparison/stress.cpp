#include "comparison/stress.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "comparison/case_check.hpp"
#include "comparison/random.hpp"
#include "comparison/tally.hpp"
#include "solvers/parallel.hpp"

namespace poise::comparison {
namespace {

struct MethodVariant {
  Method method{};
  Variant variant{};

  // The method that must solve the catalogue; the others are compared with it.
  bool never_stops() const {
    const solvers::Safeguards& on = variant.safeguards;
    return method == Method::virtual_work && variant.scaling && on.inertia_correction && on.line_search &&
           on.rank_revealing && on.restarts && on.load_stepping;
  }
  std::string name() const { return to_string(method) + (variant.name.empty() ? "" : ", " + variant.name); }
};

// FNV-1a.
std::uint64_t seed_of(const std::string& name) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

/// The starts of a case, one after the other.
class Starts {
 public:
  Starts(const HardCase& hard, const StaticModel& model)
      : random_(seed_of(hard.name)), reach_(hard.reach), from_(model.start()) {}

  std::vector<double> next() {
    std::vector<double> x = from_;
    for (double& v : x) v += reach_ * random_.uniform(-1.0, 1.0);
    return x;
  }

 private:
  Random random_;
  double reach_;
  std::vector<double> from_;
};

bool interrupted(const StressOptions& options) { return options.interrupt != nullptr && *options.interrupt; }

Cell run(const HardCase& hard, const StaticModel& model, const CaseCheck& case_check, const MethodVariant& by,
         const StressOptions& options) {
  SolveOptions settings;
  settings.method = by.method;
  settings.seek = hard.seek;
  settings.safeguards = by.variant.safeguards;
  settings.scaling = by.variant.scaling;
  settings.interrupt = options.interrupt;
  const int coordinates = model.mechanism().coordinates();
  const double of_evaluation = work_of_an_evaluation(by.method, coordinates);
  const double of_start = StressOptions::work_of_a_start * work_of_an_evaluation(Method::virtual_work, coordinates);
  if (!by.never_stops()) {
    constexpr double any = std::numeric_limits<int>::max();
    settings.iterations =
        static_cast<int>(std::clamp(StressOptions::patience * options.work / of_evaluation, 1.0, any));
  }
  Tally tally(by.method);
  Starts starts(hard, model);
  const int wanted = options.starts > 0 ? options.starts : hard.starts;
  double work = 0.0;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const auto is_within = [&] {
    if (!options.seconds) return work < options.work;
    return std::chrono::duration<double>(Clock::now() - begin).count() < *options.seconds;
  };
  const auto may_go_on = [&] { return tally.starts() == 0 || by.never_stops() || is_within(); };
  while (tally.starts() < wanted && may_go_on()) {
    const Equilibrium equilibrium = solve(model, starts.next(), settings);
    if (interrupted(options)) break;
    if (equilibrium.status == Status::not_applicable) {
      tally.does_not_apply(equilibrium.why);
      break;
    }
    work += of_start + of_evaluation * equilibrium.evaluations;
    tally.add(equilibrium, case_check.verdict_on(equilibrium));
  }
  return tally.cell();
}

std::vector<CaseResult> run_all(const std::vector<HardCase>& cases, const std::vector<MethodVariant>& variants,
                                const StressOptions& options) {
  std::vector<CaseResult> results;
  for (const HardCase& hard : cases) results.push_back({hard, {}});
  std::mutex reporting;
  const auto run_case = [&](std::size_t place) {
    const HardCase& hard = cases[place];
    const StaticModel model(scene_of(hard));
    const CaseCheck case_check(hard, model);
    for (const MethodVariant& by : variants) {
      if (options.progress) {
        const std::scoped_lock lock(reporting);
        options.progress(fmt::format("{} ({} of {}) by {}", hard.name, place + 1, cases.size(), by.name()));
      }
      const Cell cell = run(hard, model, case_check, by, options);
      if (interrupted(options) && cell.starts == 0) break;
      results[place].cells.push_back(cell);
    }
  };
  solvers::parallel_for(cases.size(), {.jobs = options.jobs, .interrupt = options.interrupt}, run_case);
  std::erase_if(results, [](const CaseResult& result) { return result.cells.empty(); });
  return results;
}

}  // namespace

std::vector<CaseResult> stress(const std::vector<HardCase>& cases, const StressOptions& options) {
  std::vector<MethodVariant> variants;
  for (const Method method : options.methods) variants.push_back({method, {}});
  if (variants.empty()) {
    for (const MethodTraits& known : all_methods()) variants.push_back({known.method, {}});
  }
  return run_all(cases, variants, options);
}

const std::vector<Variant>& safeguard_variants() {
  static const std::vector<Variant> variants = {
      {.name = "all on"},
      {.name = "scaling", .scaling = false},
      {.name = "inertia correction", .safeguards = {.inertia_correction = false}},
      {.name = "line search", .safeguards = {.line_search = false}},
      {.name = "rank-revealing factors", .safeguards = {.rank_revealing = false}},
      {.name = "restarts", .safeguards = {.restarts = false}},
      {.name = "load stepping", .safeguards = {.load_stepping = false}},
  };
  return variants;
}

std::vector<CaseResult> stress_safeguards(const std::vector<HardCase>& cases, const StressOptions& options) {
  std::vector<MethodVariant> variants;
  for (const Variant& variant : safeguard_variants()) variants.push_back({Method::virtual_work, variant});
  return run_all(cases, variants, options);
}

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

bool solved(const Cell& cell) { return cell.starts > 0 && cell.converged >= enough * cell.starts; }

}  // namespace poise::comparison
