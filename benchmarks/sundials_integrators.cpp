#include <algorithm>
#include <memory>

#include <arkode/arkode_erkstep.h>
#include <cvodes/cvodes.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "benchmarks/integrators.hpp"

namespace poise::benchmarks {
namespace {

using State = std::vector<double>;

int rates(realtype t, N_Vector y, N_Vector dydt, void* system) {
  const bool done =
      static_cast<solvers::OdeSystem*>(system)->rates(t, NV_DATA_S(y), NV_DATA_S(dydt));  // NOLINT: SUNDIALS' macro
  return done ? 0 : 1;
}

// What both solvers need, freed at the end.
class Session {
 public:
  explicit Session(State& y) {
    SUNContext_Create(nullptr, &context_);
    y_ = N_VMake_Serial(static_cast<sunindextype>(y.size()), y.data(), context_);
  }
  ~Session() {
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  SUNContext context() const { return context_; }
  N_Vector y() const { return y_; }

 private:
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
};

constexpr long most_steps = 10'000'000;

State adams(solvers::OdeSystem& system, State y, double end, double tolerance) {
  Session session(y);
  void* solver = CVodeCreate(CV_ADAMS, session.context());
  CVodeInit(solver, rates, 0.0, session.y());
  CVodeSStolerances(solver, 0.0, tolerance);
  CVodeSetUserData(solver, &system);
  CVodeSetMaxNumSteps(solver, most_steps);
  CVodeSetErrFile(solver, nullptr);
  SUNNonlinearSolver fixed_point = SUNNonlinSol_FixedPoint(session.y(), 0, session.context());
  CVodeSetNonlinearSolver(solver, fixed_point);
  CVodeSetStopTime(solver, end);
  realtype t = 0.0;
  const int flag = CVode(solver, end, session.y(), &t, CV_NORMAL);
  CVodeFree(&solver);
  SUNNonlinSolFree(fixed_point);
  return flag < 0 ? State{} : y;
}

int residual(realtype t, N_Vector y, N_Vector dydt, N_Vector r, void* system) {
  const bool done = static_cast<DaeSystem*>(system)->residual(t, NV_DATA_S(y), NV_DATA_S(dydt),  // NOLINT: as above
                                                              NV_DATA_S(r));
  return done ? 0 : 1;
}

/// y' - f(t, y).
class Explicit : public DaeSystem {
 public:
  explicit Explicit(solvers::OdeSystem& system) : system_(system) {}
  int size() const override { return system_.size(); }
  bool has_rate(int) const override { return true; }
  bool residual(double t, const double* y, const double* dydt, double* r) override {
    if (!system_.rates(t, y, r)) return false;
    for (int k = 0; k < size(); ++k) r[k] = dydt[k] - r[k];
    return true;
  }

 private:
  solvers::OdeSystem& system_;
};

State ida_of_rates(solvers::OdeSystem& system, const State& y, double end, double tolerance) {
  State dydt(y.size());
  if (!system.rates(0.0, y.data(), dydt.data())) return {};
  Explicit as_dae(system);
  return sundials_ida(as_dae, y, dydt, end, tolerance);
}

State explicit_runge_kutta(ARKODE_ERKTableID table, solvers::OdeSystem& system, State y, double end, double tolerance) {
  Session session(y);
  void* solver = ERKStepCreate(rates, 0.0, session.y(), session.context());
  ERKStepSetTableNum(solver, table);
  ERKStepSStolerances(solver, 0.0, tolerance);
  ERKStepSetUserData(solver, &system);
  ERKStepSetMaxNumSteps(solver, most_steps);
  ERKStepSetErrFile(solver, nullptr);
  ERKStepSetStopTime(solver, end);
  realtype t = 0.0;
  const int flag = ERKStepEvolve(solver, end, session.y(), &t, ARK_NORMAL);
  ERKStepFree(&solver);
  return flag < 0 ? State{} : y;
}

Integrator runge_kutta(const std::string& name, ARKODE_ERKTableID table) {
  return {name, false, [table](solvers::OdeSystem& system, State y, double end, double tolerance) {
            return explicit_runge_kutta(table, system, std::move(y), end, tolerance);
          }};
}

}  // namespace

State sundials_ida(DaeSystem& system, const State& from, const State& rates_there, double end, double tolerance) {
  State y = from, dydt = rates_there;
  const auto n = static_cast<sunindextype>(y.size());
  Session state(y);
  const SUNContext context = state.context();
  N_Vector rate = N_VMake_Serial(n, dydt.data(), context);
  N_Vector id = N_VNew_Serial(n, context), tolerances = N_VNew_Serial(n, context);
  for (int k = 0; k < system.size(); ++k) {
    NV_Ith_S(id, k) = system.has_rate(k) ? 1.0 : 0.0;                // NOLINT: SUNDIALS' macros
    NV_Ith_S(tolerances, k) = system.has_rate(k) ? tolerance : 1.0;  // NOLINT
  }
  void* solver = IDACreate(context);
  IDAInit(solver, residual, 0.0, state.y(), rate);
  IDASVtolerances(solver, 0.0, tolerances);
  IDASetUserData(solver, &system);
  IDASetId(solver, id);
  IDASetSuppressAlg(solver, SUNTRUE);
  IDASetMaxNumSteps(solver, most_steps);
  IDASetErrFile(solver, nullptr);
  SUNMatrix matrix = SUNDenseMatrix(n, n, context);
  SUNLinearSolver dense = SUNLinSol_Dense(state.y(), matrix, context);
  IDASetLinearSolver(solver, dense, matrix);
  IDASetStopTime(solver, end);
  realtype t = 0.0;
  const int flag = IDASolve(solver, end, &t, state.y(), rate, IDA_NORMAL);
  IDAFree(&solver);
  SUNLinSolFree(dense);
  SUNMatDestroy(matrix);
  for (N_Vector each : {rate, id, tolerances}) N_VDestroy(each);
  return flag < 0 ? State{} : y;
}

std::vector<Integrator> sundials_integrators() {
  return {{"CVODES, Adams", false, adams},
          {"IDA", false, ida_of_rates},
          runge_kutta("ARKODE, Verner 8(5,6)", ARKODE_VERNER_8_5_6),
          runge_kutta("ARKODE, Fehlberg 13(7,8)", ARKODE_FEHLBERG_13_7_8)};
}

}  // namespace poise::benchmarks
