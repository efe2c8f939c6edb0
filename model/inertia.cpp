#include "model/inertia.hpp"

#include "model/inertia_impl.hpp"

namespace poise {

template class Inertia<double>;

}  // namespace poise
