#include "solvers/newton.hpp"

#include <algorithm>

#include "solvers/descent.hpp"
#include "solvers/load_stepping.hpp"
#include "solvers/loop_closing.hpp"
#include "solvers/newton_system.hpp"
#include "solvers/restarts.hpp"
#include "solvers/stationary_search.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {

std::string describe(NewtonEnd end) {
  switch (end) {
    case NewtonEnd::not_solved:
      return "nothing has been tried";
    case NewtonEnd::converged:
      return "converged";
    case NewtonEnd::not_closed:
      return "the loops could not be closed from this start";
    case NewtonEnd::stalled:
      return "no step makes further progress";
    case NewtonEnd::singular:
      return "the joints lock: no finite joint forces balance the loads here";
    case NewtonEnd::unbounded:
      return "the energy decreases without bound: the mechanism runs away";
    case NewtonEnd::iteration_limit:
      return "the iteration limit was reached";
    case NewtonEnd::interrupted:
      return "interrupted";
  }
  return "unknown";
}

class Newton::Solver {
 public:
  Solver(const Problem& problem, const NewtonOptions& given)
      : options(given),
        at_(problem, options, result),
        closing_(at_),
        stationary_(at_, closing_),
        descent_(at_, closing_),
        restarts_(at_, closing_, stationary_, descent_),
        load_stepping_(at_, closing_, stationary_, descent_) {
    result.x.resize(problem.variables());
    result.multipliers.resize(problem.constraints());
    result.active.resize(problem.constraints());
  }

  void solve(std::span<const double> x) {
    begin(x);
    if (at_.seeks_minimum()) {
      at_.note(descent_.run());
    } else {
      const bool open = is_open();
      at_.note(stationary_.run());
      if (at_.gave_up() && open) close_first();
      if (at_.gave_up() && at_.problem.has_objective()) descend_instead();
    }
    if (at_.gave_up() && options.safeguards.restarts) restarts_.run(at_.seeks_minimum() || result.descended);
    if (at_.gave_up() && options.safeguards.load_stepping) load_stepping_.run();
    finish();
  }

  void close(std::span<const double> x) {
    begin(x);
    at_.note(closing_.run() ? NewtonEnd::converged : NewtonEnd::not_closed);
    finish();
  }

  NewtonOptions options;
  NewtonResult result;

 private:
  void begin(std::span<const double> x) {
    at_.random.seed(random_seed);
    std::copy(x.begin(), x.end(), at_.start.begin());
    result.end = NewtonEnd::not_solved;
    result.iterations = result.evaluations = 0;
    result.constraint_error = 0.0;
    result.descended = result.restarted = result.load_stepped = result.met_singular = false;
    at_.begin_at(at_.start);
  }

  bool is_open() {
    at_.find_gap();
    return largest(at_.gap) > options.active_set.touching;
  }

  // At an open start redundant constraints cannot be distinguished from independent ones.
  void close_first() {
    at_.begin_at(at_.start);
    if (closing_.run()) at_.note(stationary_.run());
  }

  void descend_instead() {
    at_.begin_at(at_.start);
    result.descended = true;
    at_.note(descent_.run());
  }

  void finish() {
    result.x = at_.now->x;
    result.multipliers = at_.y;
    result.active = at_.active.flags();
    at_.find_gap();
    result.constraint_error = largest(at_.gap);
  }

  static constexpr unsigned random_seed = 20220531;

  NewtonSystem at_;
  LoopClosing closing_;
  StationarySearch stationary_;
  Descent descent_;
  Restarts restarts_;
  LoadStepping load_stepping_;
};

Newton::Newton(const Problem& problem, const NewtonOptions& options)
    : solver_(std::make_unique<Solver>(problem, options)) {}
Newton::~Newton() = default;

const NewtonResult& Newton::solve(std::span<const double> x) {
  solver_->solve(x);
  return solver_->result;
}

const NewtonResult& Newton::close(std::span<const double> x) {
  solver_->close(x);
  return solver_->result;
}

}  // namespace poise::solvers
