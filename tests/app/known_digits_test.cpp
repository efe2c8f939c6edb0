// No command prints digits of an equilibrium beyond what its certificate leaves.

#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::known_digits_test {
namespace {

// The balanced arm of hard/soft_arm.toml: its torsion spring of 1e-9 N m/rad holds it at 0.3 rad, which is proved to
// 1e-5 rad only. It is a beam between pin and spring, with 2.95520 N along it and 9.55336 N across.
constexpr const char* soft_arm = R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0], hook = [0, 0.5] }
[body.arm]
points = { O = [0, 0], eye = [0.25, 0], end = [1, 0] }
mass = 1
center = [0.5, 0]
[body.arm.section]
area = 1e-4
second_moment = 1e-9
height = 0.01
modulus = 2e11
line = ["O", "end"]
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
friction = { coefficient = 0.1, radius = 0.01 }
[[spring]]
name = "balance"
points = ["ground.hook", "arm.eye"]
stiffness = 40
free_length = 0
[[torsion_spring]]
name = "soft"
bodies = ["ground", "arm"]
stiffness = 1e-9
free_angle = 0.3
[[stop]]
name = "roof"
y = "arm.end"
max = 5
[start]
arm = 0.3
)";

std::string text_of(const std::vector<std::string>& command) {
  const ProgramRun ran = run_poise(command);
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  return ran.out;
}

TEST(KnownDigits, AreAllThatIsShownOfAPose) {
  const TempFolder folder;
  const std::string scene = folder.write("scene.toml", soft_arm);
  const std::regex known("\\b0\\.3000\\b"), beyond("\\b0\\.(3000|2999)[0-9]{2,}");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"solve", scene}, {"compare", scene}, {"hold", scene, "--at-rest"}}) {
    SCOPED_TRACE(command.front());
    const std::string text = text_of(command);
    EXPECT_TRUE(std::regex_search(text, known)) << text;
    EXPECT_FALSE(std::regex_search(text, beyond)) << text;
  }
}

// The height of its end, sin(0.3) = 0.2955202 m, to 1e-5 m.
TEST(KnownDigits, AreAllThatIsShownOfAStop) {
  const TempFolder folder;
  const std::string text = text_of({"solve", folder.write("scene.toml", soft_arm)});
  EXPECT_TRUE(std::regex_search(text, std::regex("roof +0\\.2955 m"))) << text;
}

TEST(KnownDigits, AreAllThatIsShownOfInternalLoads) {
  const TempFolder folder;
  const std::string text = text_of({"loads", folder.write("scene.toml", soft_arm)});
  EXPECT_FALSE(std::regex_search(text, std::regex("7\\.044[0-9]|9\\.553[0-9]|19\\.10[0-9]|2\\.955[0-9]"))) << text;
  EXPECT_TRUE(std::regex_search(text, std::regex("7\\.0|19\\.1"))) << text;
}

// At 0 the energy 4.5 cos x + 2.25 x^2 of this pendulum is flat to the third order, so that its angle is known to about
// 1e-7, and the moment of its spring, 0 there, to 1e-6 N m: no digit of "14 nN m" is known.
TEST(KnownDigits, AreNoneOfAMomentWithinItsRadius) {
  const TempFolder folder;
  const std::string scene = folder.write("cusp.toml", R"(
gravity = [-10, 0]
[ground]
points = { O = [0, 0] }
[body.bar]
points = { a = [0, 0] }
mass = 0.9
center = [0.5, 0]
[[pin]]
points = ["ground.O", "bar.a"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "bar"]
stiffness = 4.5
[start]
bar = 0.0014414466077284592
)");
  const std::string text = text_of({"solve", scene, "--seek", "any"});
  EXPECT_TRUE(std::regex_search(text, std::regex("moment \\(N m\\)\n +coil +bar +0\n"))) << text;
}

}  // namespace
}  // namespace poise::app_tests::known_digits_test
