#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "comparison/catalogue.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::test {

/// A rod that a weight turns but little: its centre of mass lies 2 mm from the pin, its other end 2 m. Rests at -pi/2
/// (stable) and pi/2 (unstable) with a curvature of about a thousandth of its load times its size.
inline constexpr const char* soft_pendulum = R"(gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], tip = [2, 0] }
mass = 0.5
center = [0.002, 0]
[[pin]]
points = ["ground.O", "rod.O"]
)";

/// Equal loads on both ends of a beam pinned in its middle: in equilibrium everywhere, neutral.
inline constexpr const char* balanced_beam = R"([ground]
points = { O = [0, 0] }
[body.beam]
points = { O = [0, 0], left = [-1, 0], right = [1, 0] }
[[pin]]
points = ["ground.O", "beam.O"]
[[force]]
at = "beam.left"
vector = [0, -1]
[[force]]
at = "beam.right"
vector = [0, -1]
)";

/// Two bars of 1 m between pins 2 m apart, loaded across: no finite pull holds the load.
inline constexpr const char* taut_bars = R"([ground]
points = { A = [0, 0], D = [2, 0] }
[body.left]
points = { A = [0, 0], B = [1, 0] }
[body.right]
points = { B = [0, 0], D = [1, 0] }
[[pin]]
points = ["ground.A", "left.A"]
[[pin]]
points = ["left.B", "right.B"]
[[pin]]
points = ["right.D", "ground.D"]
[[force]]
name = "across"
at = "left.B"
vector = [0, -1]
)";

/// A catalogue in a folder of its own: "toy.cases.toml" of the kind "Toys" with these cases, and scenes beside it.
class ToyCatalogue {
 public:
  explicit ToyCatalogue(const std::string& cases) {
    folder_.write("catalogue.toml", "files = [\"toy.cases.toml\"]\n");
    folder_.write("toy.cases.toml", "kind = \"Toys\"\n" + cases);
    folder_.write("pendulum.toml", app_tests::pendulum);
    folder_.write("soft_pendulum.toml", soft_pendulum);
    folder_.write("balanced_beam.toml", balanced_beam);
    folder_.write("taut_bars.toml", taut_bars);
    folder_.write("runaway.toml", app_tests::runaway);
    folder_.write("follower.toml", app_tests::follower);
    folder_.write("against_the_stop.toml", app_tests::against_the_stop);
  }

  const app_tests::TempFolder& folder() const { return folder_; }
  std::filesystem::path path() const { return folder_.path(""); }
  std::vector<comparison::HardCase> read() const { return comparison::read_catalogue(path()); }

 private:
  app_tests::TempFolder folder_;
};

/// [[case]] with what every case has, and then `rest`.
inline std::string toy_case(const std::string& name, const std::string& scene, const std::string& more = "") {
  return "[[case]]\nname = \"" + name + "\"\ntitle = \"Toy\"\nsource = \"ours\"\nscene = \"" + scene + ".toml\"\n" +
         more + "\n";
}

/// A known equilibrium of that body.
inline std::string toy_equilibrium(const std::string& body, const std::string& angle, const std::string& stability) {
  return "[[case.equilibrium]]\nangles = { " + body + " = " + angle + " }\nstability = \"" + stability + "\"\n";
}

inline constexpr const char* hanging_down = "-1.5707963267948966192";
inline constexpr const char* standing_up = "1.5707963267948966192";

/// Both equilibria of a pendulum.
inline std::string both_equilibria() {
  return toy_equilibrium("rod", hanging_down, "stable") + toy_equilibrium("rod", standing_up, "unstable");
}

}  // namespace poise::test
