#include "comparison/work_precision.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "comparison/difference.hpp"
#include "statics/model/reference.hpp"

namespace poise::comparison {
namespace {

constexpr double near_enough = 1e-6;  // rad, or mechanism sizes, between a confirmed result and the proved equilibrium
constexpr double far_away = 0.5;  // rad, or mechanism sizes: largest distance at which a run belongs to an equilibrium
constexpr double same_equilibrium_within = 1e-9;  // 50-digit refinements closer than this are the same equilibrium
constexpr double patience = 3.0;                  // s: no further runs of a row after this time
constexpr double sample_time = 1e-3;              // s per repeat: short runs are repeated until then
constexpr int most_per_repeat = 100;              // runs

bool all_finite(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Study {
 public:
  Study(const StaticModel& model, const WorkPrecisionOptions& options)
      : model_(model), options_(options), start_(assemble(model)), methods_(options.methods) {
    if (methods_.empty()) {
      for (const MethodTraits& method : all_methods()) methods_.push_back(method.method);
    }
  }

  WorkPrecision run() {
    run_defaults();
    for (const Method method : methods_) {
      if (!does_not_apply(method)) run_rows(method);
    }
    for (const WorkPrecisionRow& row : out_.rows) {
      if (row.confirmed && nearest_equilibrium(row.x).index < 0) keep(certify(model_, row.x), nullptr);
    }
    for (WorkPrecisionRow& row : out_.rows) set_error(row);
    return std::move(out_);
  }

 private:
  SolveOptions settings_of(Method method) const {
    SolveOptions settings;
    settings.lagrangian = options_.lagrangian;
    settings.method = method;
    settings.seek = options_.seek;
    settings.interrupt = options_.interrupt;
    return settings;
  }

  void tell(const std::string& doing) const {
    if (options_.progress) options_.progress(doing);
  }

  bool does_not_apply(Method method) const {
    return std::any_of(out_.not_applicable.begin(), out_.not_applicable.end(),
                       [method](const NotApplicable& of) { return of.method == method; });
  }

  /// Runs the methods that may find an equilibrium, keeps what is confirmed, and notes which do not apply.
  void run_defaults() {
    std::vector<Method> witnesses = methods_;
    for (const Method independent : {Method::virtual_work, Method::energy}) {
      if (std::find(witnesses.begin(), witnesses.end(), independent) == witnesses.end())
        witnesses.push_back(independent);
    }
    for (std::size_t k = 0; k < witnesses.size() && !out_.interrupted; ++k) {
      tell("searching equilibria by " + to_string(witnesses[k]));
      const Equilibrium found = solve(model_, start_, settings_of(witnesses[k]));
      out_.interrupted = found.status == Status::interrupted;
      if (found.status == Status::not_applicable && k < methods_.size())
        out_.not_applicable.push_back({found.method, found.why});
      if (found.found()) keep(found.certificate, &found.method);
    }
  }

  /// Adds the 50-digit refinement of a confirmed answer to the known equilibria, or its method to its finders.
  void keep(const Certificate& proved, const Method* finder) {
    tell("refining an equilibrium in 50 digits");
    const Reference reference = refine(model_, proved.x);
    if (!reference.refined) return;
    const bool neutral = proved.neutral_directions > 0;
    // Of a continuum one is enough: which one a method finds is arbitrary.
    auto known = std::find_if(out_.equilibria.begin(), out_.equilibria.end(), [&](const ReferenceEquilibrium& other) {
      return (neutral && other.neutral) ||
             largest_difference(model_, other.x, reference.x).size < same_equilibrium_within;
    });
    if (known == out_.equilibria.end()) {
      out_.equilibria.push_back({reference.x, reference.digits, proved.stability, neutral, proved.rounding_effect, {}});
      known = std::prev(out_.equilibria.end());
    }
    if (finder != nullptr) known->found_by.push_back(*finder);
  }

  void run_rows(Method method) {
    for (std::size_t k = 0; k < options_.tolerances.size() && !out_.interrupted; ++k) {
      tell(fmt::format("{} at {:g}", to_string(method), options_.tolerances[k]));
      run_row(method, options_.tolerances[k]);
    }
  }

  void run_row(Method method, double tolerance) {
    SolveOptions settings = settings_of(method);
    settings.tolerance = tolerance;
    WorkPrecisionRow row;
    row.method = method;
    row.tolerance = tolerance;
    std::vector<double> times;
    const auto begin = std::chrono::steady_clock::now();
    do {
      Equilibrium found = solve(model_, start_, settings);
      out_.interrupted = found.status == Status::interrupted;
      if (out_.interrupted) return;
      times.push_back(found.microseconds);
      if (times.size() > 1) continue;
      row.claimed = found.claimed;
      row.confirmed = found.found() && found.certificate.moved <= near_enough;
      row.iterations = found.iterations;
      row.evaluations = found.evaluations;
      row.x = std::move(found.reached);
      row.why = std::move(found.why);
    } while (wants_more(times.size(), begin));
    row.repeats = static_cast<int>(times.size());
    row.microseconds = upper_median(std::move(times));
    out_.rows.push_back(std::move(row));
  }

  bool wants_more(std::size_t runs, std::chrono::steady_clock::time_point since) const {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
    const auto repeats = static_cast<std::size_t>(std::max(1, options_.repeats));
    if (runs < repeats) return seconds < patience;
    return seconds < sample_time * static_cast<double>(repeats) && runs < repeats * most_per_repeat;
  }

  struct Nearest {
    int index = -1;
    std::optional<double> error{};
  };

  Nearest nearest_equilibrium(const std::vector<double>& x) const {
    if (!all_finite(x)) return {};
    Nearest nearest{-1, far_away};
    Nearest neutral;
    for (std::size_t k = 0; k < out_.equilibria.size(); ++k) {
      const ReferenceEquilibrium& known = out_.equilibria[k];
      if (known.neutral) neutral.index = static_cast<int>(k);
      const double distance = known.neutral ? far_away : largest_difference(model_, known.x, x).size;
      if (distance < *nearest.error) nearest = {static_cast<int>(k), distance};
    }
    if (nearest.index >= 0) return nearest;
    if (neutral.index < 0) return {};
    const Reference own = refine(model_, x);
    if (!own.refined) return {};
    neutral.error = own.error;
    return neutral;
  }

  void set_error(WorkPrecisionRow& row) const {
    const Nearest nearest = nearest_equilibrium(row.x);
    row.equilibrium = nearest.index;
    row.error = nearest.error;
    if (!row.claimed)
      row.ending = Ending::not_converged;
    else
      row.ending = row.equilibrium >= 0 ? Ending::converged : Ending::elsewhere;
  }

  const StaticModel& model_;
  const WorkPrecisionOptions& options_;
  std::vector<double> start_;
  std::vector<Method> methods_;
  WorkPrecision out_;
};

}  // namespace

WorkPrecision work_precision(const StaticModel& model, const WorkPrecisionOptions& options) {
  return Study(model, options).run();
}

}  // namespace poise::comparison
