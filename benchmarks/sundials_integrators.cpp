#include <algorithm>
#include <memory>

#include <arkode/arkode_erkstep.h>
#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
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

std::vector<Integrator> sundials_integrators() {
  return {{"CVODES, Adams", false, adams},
          runge_kutta("ARKODE, Verner 8(5,6)", ARKODE_VERNER_8_5_6),
          runge_kutta("ARKODE, Fehlberg 13(7,8)", ARKODE_FEHLBERG_13_7_8)};
}

}  // namespace poise::benchmarks
