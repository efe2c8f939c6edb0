#include "motion/reduced_motion_impl.hpp"

namespace poise {

template class ReducedMotion<double>;

}  // namespace poise
