#include "statics/curvature_impl.hpp"

namespace poise {

template struct DensePoint<double>;
template struct ReducedHessian<double>;

}  // namespace poise
