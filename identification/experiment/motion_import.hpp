#pragma once

#include <filesystem>
#include <vector>

#include "motion/given_motion.hpp"

namespace poise {

/// Coordinates that were sampled, at the same times, s.
struct ImportedMotion {
  std::vector<double> time;
  std::vector<SampledCoordinate> coordinates;
};

/// Reads a motion from a CSV file as `poise motion --csv` writes it: the column time, columns named as channels_of() in
/// the scene's units, one at least for each coordinate that the loops do not give, and their rates "NAME.rate" where
/// they are there. Other columns are left alone; of several names of one coordinate the first counts. Throws InputError
/// as read_csv() and check_times().
ImportedMotion import_motion(const MotionModel& model, const std::filesystem::path& file);

}  // namespace poise
