#pragma once

#include "identification/experiment/record.hpp"

namespace poise {

/// Whether two runs have one record: as many readings of as many sensors, equal in every value, at times that differ by
/// less than a thousandth of the mean spacing, which is more than what rounding leaves of clocks that begin elsewhere.
/// Not where no reading changes: of what stands still, records may be alike.
bool same_record(const Record& a, const Record& b);

}  // namespace poise
