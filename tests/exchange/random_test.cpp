// Random linkages and chains come back from files with the same equilibria, and damaged files are read or refused.

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/one_line.hpp"
#include "model/text_file.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/app/mutate.hpp"
#include "tests/exchange/placed.hpp"
#include "tests/support/seed.hpp"

namespace poise::exchange_tests::random_test {
namespace {

/// A chain that hangs from one pivot, or from two; its places and masses have three decimals, which every format
/// keeps.
std::string random_chain(std::mt19937_64& engine, int links, bool is_closed) {
  const auto number = [&](int low, int high) {
    return low / 1000.0 + static_cast<double>(engine() % static_cast<unsigned>(high - low)) / 1000.0;
  };
  std::vector<Vec2> places = {{0, 0}};
  for (int i = 0; i < links; ++i) {
    places.push_back({places.back().x + number(200, 900), places.back().y + number(-700, 700)});
  }
  std::string out = "gravity = [0, -9.81]\n[ground]\npoints = { P0 = [0, 0]";
  if (is_closed) out += fmt::format(", P{} = [{}, {}]", links, places.back().x, places.back().y);
  out += " }\n";
  std::string joints = "[[pin]]\npoints = [\"ground.P0\", \"link1.P0\"]\n";
  for (int i = 1; i <= links; ++i) {
    const Vec2 a = places[static_cast<std::size_t>(i) - 1], b = places[static_cast<std::size_t>(i)];
    out += fmt::format("[body.link{}]\npoints = {{ P{} = [{}, {}], P{} = [{}, {}] }}\nmass = {}\ncenter = [{}, {}]\n",
                       i, i - 1, a.x, a.y, i, b.x, b.y, number(100, 3000), a.x, b.y);
    if (i > 1) joints += fmt::format("[[pin]]\npoints = [\"link{0}.P{0}\", \"link{1}.P{0}\"]\n", i - 1, i);
  }
  if (is_closed) joints += fmt::format("[[pin]]\npoints = [\"link{0}.P{0}\", \"ground.P{0}\"]\n", links);
  return out + joints;
}

std::vector<double> equilibrium_of(const StaticModel& model) {
  SolveOptions options;
  options.prove = false;
  return solve(model, options).x;
}

TEST(RandomExchange, LinkagesComeBackWithTheirEquilibria) {
  const int cases = test::cases(24, 200);
  for (int k = 0; k < cases; ++k) {
    const std::uint64_t seed = test::seed(81000) + static_cast<std::uint64_t>(k);
    SCOPED_TRACE(seed);
    std::mt19937_64 engine(seed);
    const bool is_closed = k % 2 == 1;
    const int links = is_closed ? 3 + k / 2 % 2 : 2 + k / 2 % 3;  // closed: a four-bar, or five bars
    const Scene scene = parse_scene(random_chain(engine, links, is_closed), "chain.toml");
    const StaticModel model(scene);
    expect_round_trip("dxf", scene);
    const Scene back = expect_round_trip("pmks", scene);
    const std::vector<double> x = equilibrium_of(model);
    const Placed before = placed(model, x);
    const StaticModel again(back);
    expect_places(before.joined, placed(again, equilibrium_of(again)));
    // A drawing has no masses: it has the equilibrium itself.
    const Scene drawn = scene_of("dxf", exported("dxf", model, x).text);
    expect_places(before.joined, placed(drawn));
  }
}

/// One file of each format that can be read.
std::vector<std::pair<std::string, std::string>> files() {
  const ScaledModel model(parse_scene(R"(
[ground]
points = { O = [0, 0], D = [5, 0] }
[body.crank]
points = { O = [0, 0], B = [1, 2] }
mass = 1
[body.rod]
points = { B = [1, 2], C = [4, 3] }
[body.lever]
points = { C = [4, 3], D = [5, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin]]
points = ["rod.C", "lever.C"]
[[pin_in_slot]]
points = ["ground.D", "lever.D"]
axis = [1, 0]
[[force]]
name = "P"
at = "rod.C"
vector = [0, -3]
)",
                                      "files.toml"),
                          Purpose::dynamics);
  const std::vector<double> x = close_loops(model);
  std::vector<std::pair<std::string, std::string>> out;
  for (const FileFormat& format : formats()) {
    const bool is_of_robots = format.name == "urdf" || format.name == "mjcf";  // which have neither loads nor all loops
    if (format.read != nullptr && format.write != nullptr && !is_of_robots) {
      out.emplace_back(format.name, format.write(model.scene(), model.poses(x)).text);
    }
  }
  for (const auto& [format, file] : {std::pair("urdf", "arm.urdf"), std::pair("mjcf", "four_bar.xml")}) {
    out.emplace_back(format, read_text_file(std::string(POISE_SOURCE_DIR) + "/datasets/exchange/" + file));
  }
  out.emplace_back("pmks-text",
                   "ground, crank, R, 0, 0\ncrank, rod, R, 10, 20\nrod, block, R, 40, 0\n"
                   "block, ground, P, 40, 0, 30\nground rod, RP, 20, 10, 45\n");
  out.emplace_back("linkage2", R"(<linkage2><program units="Inches" scalefactor="1"/>
<connector id="0" x="0" y="0" anchor="true" input="true" rpm="15"/><connector id="1" x="0" y="96"/>
<connector id="2" x="288" y="0" slider="true"><slidelimit id="4"/><slidelimit id="5"/></connector>
<connector id="4" x="96" y="0" anchor="true"/><connector id="5" x="480" y="0" anchor="true"/>
<Link id="0"><connector id="0"/><connector id="1"/></Link><Link id="1"><connector id="1"/><connector id="2"/></Link>
</linkage2>)");
  return out;
}

TEST(RandomExchange, DamagedFilesAreReadOrRefusedInOneLine) {
  const int cases = test::cases(400, 20000);
  for (const auto& [format, text] : files()) {
    for (int k = 0; k < cases; ++k) {
      app_tests::Random random(static_cast<unsigned>(test::seed(82000)) + static_cast<unsigned>(k));
      std::string how;
      const std::string damaged = app_tests::mutated(text, random, how);
      SCOPED_TRACE(fmt::format("{}, case {}: {}", format, k, how));
      Imported read;
      try {
        read = imported(format, damaged);
      } catch (const InputError& error) {
        const std::string line = error.what();
        EXPECT_TRUE(line.starts_with("it." + format + ":")) << line;
        EXPECT_NE(line.find("expected"), std::string::npos) << line;
        EXPECT_EQ(line, one_line(line));
        continue;
      }
      for (const std::string& note : read.notes) EXPECT_EQ(note, one_line(note));
      EXPECT_NO_THROW(parse_scene(read.text, "read.toml")) << read.text;
    }
  }
}

}  // namespace
}  // namespace poise::exchange_tests::random_test
