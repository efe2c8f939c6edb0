#include "solvers/nlopt_status.hpp"

#include <nlopt.h>

namespace poise::solvers {

std::string nlopt_in_words(int status) {
  switch (status) {
    case NLOPT_SUCCESS:
      return "success";
    case NLOPT_STOPVAL_REACHED:
      return "good enough";
    case NLOPT_FTOL_REACHED:
    case NLOPT_XTOL_REACHED:
      return "no further improvement";
    case NLOPT_MAXEVAL_REACHED:
      return "evaluation limit";
    case NLOPT_FORCED_STOP:
      return "interrupted";
    case NLOPT_ROUNDOFF_LIMITED:
      return "limited by rounding";
    case NLOPT_OUT_OF_MEMORY:
      return "out of memory";
    default:
      return "failed (" + std::to_string(status) + ")";
  }
}

}  // namespace poise::solvers
