#include "solvers/nlopt_program.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include <nlopt.h>

#include "solvers/nlopt_status.hpp"
#include "solvers/optimality.hpp"
#include "solvers/rescaled_problem.hpp"

namespace poise::solvers {
namespace {

using Handle = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;

constexpr double cobyla_first_step = 0.1;
constexpr double cobyla_reach = 1e3;  // bound on every variable
// The first step of L-BFGS is the whole gradient, which may lead past the nearest minimum, the more so the stiffer a
// spring: gradients are scaled down, the more the better up to this, measured on the project's scenes.
constexpr double lbfgs_scale = 0.003;
constexpr int lbfgs_memory = 10;       // the default uses megabytes, which cost more than the search
constexpr double finest_step = 1e-12;  // of a search from far, where rounding of values hides finer ones
constexpr double close_enough = 1e-5;  // errors from which the problem is rescaled
constexpr double smallest_unit = 1e-14;
constexpr double gain_wanted = 1e-6;  // of one rescaled search
constexpr int restarts = 10;

Handle create(nlopt_algorithm algorithm, std::size_t n) {
  return {nlopt_create(algorithm, static_cast<unsigned>(n)), nlopt_destroy};
}

std::string name_of(NloptAlgorithm algorithm) {
  switch (algorithm) {
    case NloptAlgorithm::slsqp:
      return "NLopt SLSQP: ";
    case NloptAlgorithm::auglag_lbfgs:
      return "NLopt AUGLAG with L-BFGS: ";
    case NloptAlgorithm::cobyla:
      return "NLopt COBYLA: ";
  }
  return "NLopt: ";
}

bool succeeded(int status) { return status > 0 && status != NLOPT_MAXEVAL_REACHED; }

bool is_finite(const std::vector<double>& v) {
  return std::all_of(v.begin(), v.end(), [](double e) { return std::isfinite(e); });
}

std::vector<int> all_where_empty(const Problem& problem, std::vector<int> rows) {
  if (!rows.empty()) return rows;
  rows.resize(problem.constraints());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

// One search of NLopt from the start, and then more from its end, each rescaled to the remaining error.
class Program {
 public:
  Program(NloptAlgorithm algorithm, const Problem& problem, const SearchOptions& options, const std::vector<int>& rows)
      : algorithm_(algorithm),
        problem_(problem),
        options_(options),
        kept_(all_where_empty(problem, rows)),
        rescaled_(problem, kept_),
        checked_(problem.make_evaluation()) {}

  SearchResult run(const std::vector<double>& start) {
    result_.x = start;
    best_ = optimality_of(start);
    // From a solution L-BFGS may well step away; the others leave it where the energy is no minimum.
    const bool stays = algorithm_ == NloptAlgorithm::auglag_lbfgs && best_.error <= options_.tolerance;
    int word = stays ? static_cast<int>(NLOPT_SUCCESS) : search(from_far());
    while (refine() && left_to_do()) {
      const double before = best_.error;
      const int status = search(before < close_enough ? from_near() : from_far());
      if (succeeded(status) || !succeeded(word)) word = status;
      if (!(best_.error < 0.5 * before)) break;
    }
    result_.multipliers = best_.multipliers;
    result_.claims_success = succeeded(word) && !result_.interrupted;
    result_.status = name_of(algorithm_) + nlopt_in_words(result_.interrupted ? NLOPT_FORCED_STOP : word);
    result_.evaluations = std::max(1, rescaled_.evaluations());
    result_.iterations = result_.evaluations;
    return result_;
  }

 private:
  // COBYLA uses no gradients, from which a rescaled problem takes its differences.
  bool refine() { return algorithm_ != NloptAlgorithm::cobyla && searches_ <= restarts; }

  bool left_to_do() const {
    return best_.error > options_.tolerance && !result_.interrupted && rescaled_.evaluations() < options_.iterations;
  }

  RescaledProblem::Frame from_far() {
    steps_ = algorithm_ == NloptAlgorithm::cobyla ? options_.tolerance : std::max(options_.tolerance, finest_step);
    gaps_ = options_.tolerance;
    // SLSQP and COBYLA do better at first with the unscaled energy.
    const bool plain = algorithm_ == NloptAlgorithm::cobyla || (algorithm_ == NloptAlgorithm::slsqp && searches_ == 0);
    return {result_.x, plain ? std::vector<double>{} : best_.multipliers, 1.0, scale(), false};
  }

  RescaledProblem::Frame from_near() {
    steps_ = gain_wanted;
    gaps_ = gain_wanted;
    return {result_.x, best_.multipliers, std::max(best_.error, smallest_unit), scale(), true};
  }

  double scale() const { return algorithm_ == NloptAlgorithm::auglag_lbfgs ? lbfgs_scale : 1.0; }

  Optimality optimality_of(const std::vector<double>& x) {
    checked_.x = x;
    problem_.evaluate(checked_);
    return optimality_at(problem_, checked_, kept_);
  }

  int search(RescaledProblem::Frame frame) {
    const bool first = searches_++ == 0;
    rescaled_.set_frame(std::move(frame));
    const Handle handle = make();
    handle_ = handle.get();
    if (!constrain()) return NLOPT_INVALID_ARGS;
    std::vector<double> u(result_.x.size(), 0.0);
    double value = 0.0;
    const int status = nlopt_optimize(handle_, u.data(), &value);
    const std::vector<double> last = rescaled_.last();
    take(rescaled_.place(u), first);
    // NLopt returns the point of least value among those within the tolerance of the constraints. Near the solution
    // that choice is decided by rounding and gaps, and the last point is the better one.
    if (algorithm_ != NloptAlgorithm::cobyla) take(last, false);
    return status;
  }

  void take(const std::vector<double>& x, bool whatever) {
    if (!is_finite(x)) return;
    Optimality there = optimality_of(x);
    if (!whatever && !(there.error < best_.error)) return;
    result_.x = x;
    best_ = std::move(there);
  }

  Handle make() const {
    const std::size_t n = result_.x.size();
    switch (algorithm_) {
      case NloptAlgorithm::slsqp:
        return limited(create(NLOPT_LD_SLSQP, n), steps_);
      case NloptAlgorithm::auglag_lbfgs: {
        const Handle local = limited(create(NLOPT_LD_LBFGS, n), steps_);
        nlopt_set_vector_storage(local.get(), lbfgs_memory);
        Handle outer = limited(create(NLOPT_AUGLAG, n), steps_);
        nlopt_set_local_optimizer(outer.get(), local.get());
        return outer;
      }
      case NloptAlgorithm::cobyla:
        break;
    }
    Handle cobyla = limited(create(NLOPT_LN_COBYLA, n), steps_);
    nlopt_set_initial_step1(cobyla.get(), cobyla_first_step);
    // Without bounds COBYLA would not end if the objective decreases without bound.
    nlopt_set_lower_bounds1(cobyla.get(), -cobyla_reach);
    nlopt_set_upper_bounds1(cobyla.get(), cobyla_reach);
    return cobyla;
  }

  Handle limited(Handle handle, double steps) const {
    nlopt_set_xtol_rel(handle.get(), steps);
    nlopt_set_xtol_abs1(handle.get(), steps);
    nlopt_set_maxeval(handle.get(), std::max(1, options_.iterations - rescaled_.evaluations()));
    return handle;
  }

  bool constrain() {
    nlopt_set_min_objective(handle_, objective, this);
    const std::vector<double> equal(rescaled_.equalities().rows.size(), gaps_);
    const std::vector<double> bounded(rescaled_.inequalities().rows.size(), gaps_);
    return (equal.empty() || nlopt_add_equality_mconstraint(handle_, static_cast<unsigned>(equal.size()), equalities,
                                                            &rescaled_, equal.data()) > 0) &&
           (bounded.empty() || nlopt_add_inequality_mconstraint(handle_, static_cast<unsigned>(bounded.size()),
                                                                inequalities, &rescaled_, bounded.data()) > 0);
  }

  static double objective(unsigned n, const double* u, double* gradient, void* data) {
    auto& program = *static_cast<Program*>(data);
    const std::atomic<bool>* interrupt = program.options_.interrupt;
    if (interrupt != nullptr && interrupt->load()) {
      program.result_.interrupted = true;
      nlopt_force_stop(program.handle_);
    }
    return program.rescaled_.objective({u, n}, {gradient, gradient == nullptr ? 0 : n});
  }

  static void equalities(unsigned m, double* values, unsigned n, const double* u, double* jacobian, void* data) {
    auto& rescaled = *static_cast<RescaledProblem*>(data);
    rescaled.constraints(rescaled.equalities(), {u, n}, {values, m}, {jacobian, jacobian == nullptr ? 0UL : m * n});
  }

  static void inequalities(unsigned m, double* values, unsigned n, const double* u, double* jacobian, void* data) {
    auto& rescaled = *static_cast<RescaledProblem*>(data);
    rescaled.constraints(rescaled.inequalities(), {u, n}, {values, m}, {jacobian, jacobian == nullptr ? 0UL : m * n});
  }

  NloptAlgorithm algorithm_;
  const Problem& problem_;
  const SearchOptions& options_;
  std::vector<int> kept_;
  RescaledProblem rescaled_;
  Evaluation checked_;
  Optimality best_;  // of result_.x
  double steps_ = 0.0, gaps_ = 0.0;
  int searches_ = 0;
  nlopt_opt handle_ = nullptr;
  SearchResult result_;
};

}  // namespace

SearchResult solve_with_nlopt(NloptAlgorithm algorithm, const Problem& problem, const std::vector<double>& start,
                              const SearchOptions& options, const std::vector<int>& rows) {
  return Program(algorithm, problem, options, rows).run(start);
}

}  // namespace poise::solvers
