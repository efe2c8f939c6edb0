#include "benchmarks/bare_ipopt.hpp"

#include <algorithm>
#include <cmath>

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>

#include "comparison/series.hpp"

namespace poise::benchmarks {
namespace {

using Ipopt::Index;
using Ipopt::Number;

// Both problems are   min sum_k a_k cos t_k + b_k sin t_k,   sum_k l_k cos t_k = span,   sum_k l_k sin t_k = 0.
class BareProgram final : public Ipopt::TNLP {
 public:
  std::vector<double> a, b, length, start;
  double span = 0.0;
  BareIpoptResult result;

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = size();
    m = 2;
    jacobian = 2 * n;
    hessian = n;
    style = C_STYLE;
    cos_.resize(n);
    sin_.resize(n);
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index, Number* g_l, Number* g_u) override {
    for (Index k = 0; k < n; ++k) {
      x_l[k] = -2e19;
      x_u[k] = 2e19;
    }
    g_l[0] = g_u[0] = g_l[1] = g_u[1] = 0.0;
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    std::copy(start.begin(), start.begin() + n, x);
    return true;
  }

  bool eval_f(Index n, const Number* x, bool fresh, Number& value) override {
    place(x, fresh);
    value = 0.0;
    for (Index k = 0; k < n; ++k) value += a[k] * cos_[k] + b[k] * sin_[k];
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool fresh, Number* gradient) override {
    place(x, fresh);
    for (Index k = 0; k < n; ++k) gradient[k] = b[k] * cos_[k] - a[k] * sin_[k];
    return true;
  }

  bool eval_g(Index n, const Number* x, bool fresh, Index, Number* g) override {
    place(x, fresh);
    g[0] = -span;
    g[1] = 0.0;
    for (Index k = 0; k < n; ++k) {
      g[0] += length[k] * cos_[k];
      g[1] += length[k] * sin_[k];
    }
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool fresh, Index, Index, Index* row, Index* column,
                  Number* values) override {
    if (values != nullptr) place(x, fresh);
    for (Index k = 0; k < n; ++k) {
      if (values == nullptr) {
        row[2 * k] = 0;
        row[2 * k + 1] = 1;
        column[2 * k] = column[2 * k + 1] = k;
      } else {
        values[2 * k] = -length[k] * sin_[k];
        values[2 * k + 1] = length[k] * cos_[k];
      }
    }
    return true;
  }

  bool eval_h(Index n, const Number* x, bool fresh, Number factor, Index, const Number* lambda, bool, Index, Index* row,
              Index* column, Number* values) override {
    if (values != nullptr) place(x, fresh);
    for (Index k = 0; k < n; ++k) {
      if (values == nullptr) {
        row[k] = column[k] = k;
      } else {
        values[k] =
            -(factor * a[k] + lambda[0] * length[k]) * cos_[k] - (factor * b[k] + lambda[1] * length[k]) * sin_[k];
      }
    }
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number, Number, Number, Number, Number, Number,
                             Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    result.iterations = iteration;
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn, Index n, const Number* x, const Number*, const Number*, Index,
                         const Number*, const Number*, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    result.angles.assign(x, x + n);
  }

 private:
  Index size() const { return static_cast<Index>(length.size()); }

  void place(const Number* x, bool fresh) {
    if (!fresh && placed_) return;
    placed_ = true;
    for (Index k = 0; k < size(); ++k) {
      cos_[k] = std::cos(x[k]);
      sin_[k] = std::sin(x[k]);
    }
  }

  bool placed_ = false;
  std::vector<double> cos_, sin_;
};

BareIpoptResult run(const Ipopt::SmartPtr<BareProgram>& program) {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  const auto options = application->Options();
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("sb", "yes");
  options->SetNumericValue("tol", 1e-14);
  options->SetNumericValue("constr_viol_tol", 1e-14);
  options->SetNumericValue("dual_inf_tol", 1e-14);
  options->SetNumericValue("compl_inf_tol", 1e-14);
  options->SetNumericValue("bound_relax_factor", 0.0);
  options->SetIntegerValue("acceptable_iter", 0);
  options->SetIntegerValue("max_iter", 1000);
  options->SetStringValue("nlp_scaling_method", "none");
  options->SetIntegerValue("mumps_pivot_order", 6);
  if (application->Initialize() != Ipopt::Solve_Succeeded) return {};
  program->result.solved = application->OptimizeTNLP(GetRawPtr(program)) == Ipopt::Solve_Succeeded;
  return program->result;
}

}  // namespace

BareIpoptResult bare_ipopt_four_bar(const std::array<double, 3>& start, const BareUnits& units) {
  const double per_length = 1.0 / units.length;
  const double per_energy = 1.0 / (units.length * units.force);
  Ipopt::SmartPtr<BareProgram> program = new BareProgram;
  program->start.assign(start.begin(), start.end());
  program->length = {4.0 * per_length, 6.0 * per_length, 7.0 * per_length};
  program->span = 11.515108 * per_length;
  program->a = {0.5 * 13.29 * 4.0 * per_energy, 0.0, 0.5 * 10.0 * 7.0 * per_energy};
  program->b = {-50.0 * 4.0 * per_energy, -0.5 * 50.0 * 6.0 * per_energy, 0.0};
  return run(program);
}

BareIpoptResult bare_ipopt_chain(const std::vector<double>& start, const BareUnits& units) {
  const int n = static_cast<int>(start.size());
  Ipopt::SmartPtr<BareProgram> program = new BareProgram;
  program->start = start;
  program->length.assign(n, 1.0 / (n * units.length));
  program->span = comparison::chain_span / units.length;
  program->a.assign(n, 0.0);
  const int left = (n + 1) / 2;  // links that hang from the left end
  for (int i = 0; i < n; ++i) program->b.push_back((left - i - 0.5) / n / (n * units.length * units.force));
  return run(program);
}

}  // namespace poise::benchmarks
