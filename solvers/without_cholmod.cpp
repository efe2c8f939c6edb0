// Ceres as Debian builds it can solve sparse systems by CHOLMOD, parts of which are under the GNU GPL. The license of
// Ipopt is none that the GPL allows beside it, so a program with both could not be given to others. Poise lets Ceres
// use Eigen (least_squares.cpp), and its programs are linked with these functions in the place of CHOLMOD's. Nothing
// calls them.

#include <cstdio>
#include <cstdlib>

namespace {

[[noreturn]] void end_for(const char* function) {
  std::fprintf(stderr, "poise: fatal: Ceres called %s, which is left out; expected EIGEN_SPARSE\n", function);
  std::abort();
}

}  // namespace

// The callers pass arguments, which a function that does not return has no use for.
#define POISE_LEAVE_OUT(function) \
  extern "C" void function() { end_for(#function); }

POISE_LEAVE_OUT(cholmod_amd)
POISE_LEAVE_OUT(cholmod_analyze)
POISE_LEAVE_OUT(cholmod_analyze_p)
POISE_LEAVE_OUT(cholmod_camd)
POISE_LEAVE_OUT(cholmod_factorize)
POISE_LEAVE_OUT(cholmod_finish)
POISE_LEAVE_OUT(cholmod_free_dense)
POISE_LEAVE_OUT(cholmod_free_factor)
POISE_LEAVE_OUT(cholmod_free_sparse)
POISE_LEAVE_OUT(cholmod_print_common)
POISE_LEAVE_OUT(cholmod_solve)
POISE_LEAVE_OUT(cholmod_start)
POISE_LEAVE_OUT(cholmod_triplet_to_sparse)
POISE_LEAVE_OUT(cholmod_zeros)
