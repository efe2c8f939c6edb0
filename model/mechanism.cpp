#include "model/mechanism.hpp"

#include "model/mechanism_impl.hpp"

namespace poise {

template class Mechanism<double>;

}  // namespace poise
