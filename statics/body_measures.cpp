#include "statics/body_measures.hpp"

#include "statics/body_measures_impl.hpp"

namespace poise {

template double value_of(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);
template std::vector<UnitEffort> unit_efforts(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);

}  // namespace poise
