#include "solvers/ipopt.hpp"

#include <algorithm>
#include <limits>
#include <mutex>
#include <numeric>

#include <IpIpoptApplication.hpp>
#include <IpIpoptData.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>

namespace poise::solvers {
namespace {

constexpr double small_step = 1e-6;        // rad or sizes
constexpr int most_without_progress = 10;  // iterations with such steps that do not halve the error

std::string in_words(Ipopt::ApplicationReturnStatus status) {
  switch (status) {
    case Ipopt::Solve_Succeeded:
      return "Ipopt: optimal";
    case Ipopt::Solved_To_Acceptable_Level:
      return "Ipopt: acceptable";
    case Ipopt::Infeasible_Problem_Detected:
      return "Ipopt: locally infeasible";
    case Ipopt::Search_Direction_Becomes_Too_Small:
      return "Ipopt: search direction became too small";
    case Ipopt::Diverging_Iterates:
      return "Ipopt: iterates diverge, the energy may be unbounded";
    case Ipopt::User_Requested_Stop:
      return "Ipopt: interrupted";
    case Ipopt::Feasible_Point_Found:
      return "Ipopt: feasible point";
    case Ipopt::Maximum_Iterations_Exceeded:
      return "Ipopt: iteration limit";
    case Ipopt::Restoration_Failed:
      return "Ipopt: restoration failed";
    case Ipopt::Error_In_Step_Computation:
      return "Ipopt: no step could be computed";
    case Ipopt::Not_Enough_Degrees_Of_Freedom:
      return "Ipopt: more equations than variables";
    case Ipopt::Invalid_Number_Detected:
      return "Ipopt: a value was not finite";
    default:
      return "Ipopt: internal error " + std::to_string(static_cast<int>(status));
  }
}

// Ipopt's callbacks for a Problem. Every new point is evaluated once, completely.
class Adapter final : public Ipopt::TNLP {
 public:
  using Index = Ipopt::Index;
  using Number = Ipopt::Number;

  Adapter(const Problem& problem, const std::vector<double>& start, const SearchOptions& options,
          const std::vector<int>& rows, SearchResult& result)
      : problem_(problem),
        start_(start),
        options_(options),
        rows_(rows),
        result_(result),
        at_(problem.make_evaluation()),
        multipliers_(problem.constraints(), 0.0) {
    if (rows_.empty()) {
      rows_.resize(problem.constraints());
      std::iota(rows_.begin(), rows_.end(), 0);
    }
    std::vector<int> place(problem.constraints(), -1);
    for (int k = 0; k < static_cast<int>(rows_.size()); ++k) place[rows_[k]] = k;
    const Pattern& pattern = problem.jacobian_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      if (place[pattern.row[e]] < 0) continue;
      entry_.push_back(e);
      row_.push_back(place[pattern.row[e]]);
      column_.push_back(pattern.column[e]);
    }
  }

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = problem_.variables();
    m = static_cast<Index>(rows_.size());
    jacobian = static_cast<Index>(entry_.size());
    hessian = problem_.tangent_pattern().size();
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l, Number* g_u) override {
    constexpr double infinity = 2e19;  // values beyond it are no bound for Ipopt
    std::fill(x_l, x_l + n, -infinity);
    std::fill(x_u, x_u + n, infinity);
    for (Index k = 0; k < m; ++k) {
      const int inequality = rows_[k] - problem_.equalities();
      g_l[k] = inequality < 0 ? 0.0 : std::max(problem_.lower()[inequality], -infinity);
      g_u[k] = inequality < 0 ? 0.0 : std::min(problem_.upper()[inequality], infinity);
    }
    return true;
  }

  bool get_starting_point(Index, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    std::copy(start_.begin(), start_.end(), x);
    return true;
  }

  bool eval_f(Index, const Number* x, bool fresh, Number& value) override {
    at(x, fresh);
    value = problem_.objective(at_);
    return true;
  }

  bool eval_grad_f(Index, const Number* x, bool fresh, Number* gradient) override {
    const Evaluation& e = at(x, fresh);
    std::copy(e.gradient.begin(), e.gradient.end(), gradient);
    return true;
  }

  bool eval_g(Index, const Number* x, bool fresh, Index m, Number* g) override {
    const Evaluation& e = at(x, fresh);
    for (Index k = 0; k < m; ++k) g[k] = e.constraint[rows_[k]];
    return true;
  }

  bool eval_jac_g(Index, const Number* x, bool fresh, Index, Index count, Index* row, Index* column,
                  Number* values) override {
    if (values == nullptr) {
      std::copy(row_.begin(), row_.end(), row);
      std::copy(column_.begin(), column_.end(), column);
      return true;
    }
    const Evaluation& e = at(x, fresh);
    for (Index k = 0; k < count; ++k) values[k] = e.jacobian[entry_[k]];
    return true;
  }

  bool eval_h(Index, const Number* x, bool fresh, Number factor, Index m, const Number* lambda, bool, Index count,
              Index* row, Index* column, Number* values) override {
    const Pattern& pattern = problem_.tangent_pattern();
    if (values == nullptr) {
      std::copy(pattern.row.begin(), pattern.row.end(), row);
      std::copy(pattern.column.begin(), pattern.column.end(), column);
      return true;
    }
    at(x, fresh);
    // The tangent has the weight one of the objective. Ipopt uses another weight only in its restoration phase, zero;
    // the difference of two tangents is then the constraints' part.
    for (Index k = 0; k < m; ++k) multipliers_[rows_[k]] = factor == 0.0 ? lambda[k] : lambda[k] / factor;
    problem_.tangent(at_, multipliers_, {values, static_cast<std::size_t>(count)});
    if (factor == 0.0) {
      objective_part_.resize(count);
      std::fill(multipliers_.begin(), multipliers_.end(), 0.0);
      problem_.tangent(at_, multipliers_, objective_part_);
      for (Index e = 0; e < count; ++e) values[e] -= objective_part_[e];
    } else if (factor != 1.0) {
      for (Index e = 0; e < count; ++e) values[e] *= factor;
    }
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode mode, Index iteration, Number, Number infeasible, Number unbalanced,
                             Number, Number step, Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    result_.iterations = iteration;
    // Where stiff springs cancel, rounding keeps the error above the tolerance, and Ipopt would go on for ever.
    const double error = infeasible + unbalanced;
    if (error < 0.5 * least_error_ || mode != Ipopt::RegularMode || step > small_step) {
      least_error_ = std::min(error, least_error_);
      without_progress_ = 0;
    } else {
      settled_ = ++without_progress_ >= most_without_progress;
    }
    return !settled_ && (options_.interrupt == nullptr || !options_.interrupt->load());
  }
  /// It was stopped because its steps were small and the error no longer fell.
  bool settled() const { return settled_; }

  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*, const Number*, Index m,
                         const Number*, const Number* lambda, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    result_.x.assign(x, x + n);
    result_.multipliers.assign(problem_.constraints(), 0.0);
    for (Index k = 0; k < m; ++k) result_.multipliers[rows_[k]] = lambda[k];
  }

 private:
  const Evaluation& at(const Number* x, bool fresh) {
    if (fresh || result_.evaluations == 0) {
      std::copy(x, x + problem_.variables(), at_.x.begin());
      problem_.evaluate(at_);
      ++result_.evaluations;
    }
    return at_;
  }

  const Problem& problem_;
  const std::vector<double>& start_;
  const SearchOptions& options_;
  std::vector<int> rows_;
  SearchResult& result_;
  Evaluation at_;
  std::vector<double> multipliers_, objective_part_;
  std::vector<int> entry_, row_, column_;
  double least_error_ = std::numeric_limits<double>::infinity();
  int without_progress_ = 0;
  bool settled_ = false;
};

}  // namespace

SearchResult solve_with_ipopt(const Problem& problem, const std::vector<double>& start, const SearchOptions& options,
                              const std::vector<int>& rows) {
  SearchResult result;
  result.x = start;
  // MUMPS, which Ipopt solves its linear systems with, keeps state that all threads share.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  auto settings = application->Options();
  settings->SetIntegerValue("print_level", 0);
  settings->SetStringValue("sb", "yes");
  settings->SetNumericValue("tol", options.tolerance);
  settings->SetNumericValue("constr_viol_tol", options.tolerance);
  settings->SetNumericValue("dual_inf_tol", options.tolerance);
  settings->SetNumericValue("compl_inf_tol", options.tolerance);
  settings->SetNumericValue("bound_relax_factor", 0.0);
  settings->SetIntegerValue("acceptable_iter", 0);
  settings->SetIntegerValue("max_iter", options.iterations);
  // Stay near the start: a large initial barrier parameter would push a mechanism off an active stop, and past a dead
  // centre.
  settings->SetNumericValue("mu_init", 1e-5);
  for (const char* push : {"bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac"}) {
    settings->SetNumericValue(push, 1e-6);
  }
  // The problem is already scaled to order one, by powers of two.
  settings->SetStringValue("nlp_scaling_method", "none");
  // MUMPS' default ordering can give a long chain one dense front.
  settings->SetIntegerValue("mumps_pivot_order", 6);
  if (application->Initialize() != Ipopt::Solve_Succeeded) {
    result.status = "Ipopt: could not be initialised";
    return result;
  }
  Ipopt::SmartPtr<Adapter> adapter = new Adapter(problem, start, options, rows, result);
  const Ipopt::ApplicationReturnStatus status = application->OptimizeTNLP(adapter);
  result.claims_success = status == Ipopt::Solve_Succeeded || adapter->settled();
  result.interrupted = status == Ipopt::User_Requested_Stop && !adapter->settled();
  result.status = adapter->settled() ? "Ipopt: as near as rounding allows" : in_words(status);
  return result;
}

}  // namespace poise::solvers
