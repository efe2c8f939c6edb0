#include "identification/experiment/motion_import.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "motion/motion_record.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::motion_import_test {
namespace {

std::filesystem::path written(const std::string& text) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "poise_motion_import.csv";
  std::ofstream(file) << text;
  return file;
}

TEST(MotionImport, ReadsNamedColumnsInTheUnitsOfTheScene) {
  Scene scene = read_scene(test::dataset("four_bar_gravity.toml"));
  scene.units.angle_name = "deg";
  scene.units.angle = M_PI / 180;
  const MotionModel model(scene);
  const Channel crank = channel_named("test", "crank", channels_of(model));
  const ImportedMotion motion =
      import_motion(model, written("time,other,crank,crank.rate\n0,1,30,90\n0.1,2,39,90\n0.2,3,48,90\n"));
  EXPECT_EQ(motion.time, (std::vector<double>{0, 0.1, 0.2}));
  ASSERT_EQ(motion.coordinates.size(), 1U);
  EXPECT_EQ(motion.coordinates[0].coordinate, crank.coordinate);
  EXPECT_NEAR(motion.coordinates[0].value[1] + crank.offset, 39 * M_PI / 180, 1e-15);
  EXPECT_NEAR(motion.coordinates[0].rate[2], M_PI / 2, 1e-15);
}

TEST(MotionImport, NamesWhatIsWrong) {
  const MotionModel model(read_scene(test::dataset("four_bar_gravity.toml")));
  const auto complaint = [&](const std::filesystem::path& file) -> std::string {
    try {
      import_motion(model, file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no complaint";
  };
  EXPECT_EQ(complaint("nowhere.csv"), "nowhere.csv: cannot be read: No such file or directory; check the path");
  EXPECT_EQ(complaint("/dev/zero"), "/dev/zero: expected a file, found a device or a pipe; check the path");
  EXPECT_NE(complaint(written("tim,crank\n0,1\n")).find("did you mean \"tim\"?"), std::string::npos);
  EXPECT_NE(complaint(written("time,crank\n0,1\n0,2\n1,2\n")).find(":3: "), std::string::npos);
}

}  // namespace
}  // namespace poise::motion_import_test
