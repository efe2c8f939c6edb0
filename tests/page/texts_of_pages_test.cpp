// No text of a page may lie over another or go on beyond its picture: reports of all commands and live pages, on a
// wide window and on a telephone. `make test` looks at a few of them, another few in each round of
// `make campaign TESTS=TextsOfPages`, which come to all of them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/view/background_view.hpp"
#include "app/view/view_session.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/page_document.hpp"
#include "tests/support/seed.hpp"

namespace poise::page_tests::texts_of_pages_test {
namespace {

namespace fs = std::filesystem;
using app_tests::contents;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;
using test::Browser;

const fs::path source(POISE_SOURCE_DIR);

/// The words of a command line, in which quotation marks keep blanks.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string word; in >> std::ws && !in.eof();) {
    if (in.peek() == '\'')
      in >> std::quoted(word, '\'');
    else
      in >> word;
    out.push_back(word);
  }
  return out;
}

/// The command lines by which the site shows the datasets, without those that read what another has written, and those
/// of commands that it does not show.
std::vector<std::string> reports() {
  std::vector<std::string> out = {
      "check datasets/toggle_clamp.toml",
      "check datasets/friction/wedge.toml",
      "solve datasets/toggle_clamp.toml",
      "solve datasets/excavator.toml",
      "solve datasets/planetary_gear.toml",
      "compare datasets/toggle_clamp.toml",
      "find datasets/toggle_clamp.toml --vary spring.rubber.stiffness=200..800 --for force.rubber=-700",
      "sensitivity datasets/toggle_clamp.toml --of force.rubber",
      "forces datasets/lift.toml --drive stroke=0.5..0.79",
      "loads datasets/structures/three_hinged_portal.toml",
      "validate datasets/lift_experiment.toml",
      "identifiability datasets/lift_experiment_empty.toml",
      "montecarlo datasets/lift_experiment.toml --trials 4",
      "stress zeeman-cusp --starts 2",
  };
  const std::string gallery = contents(source / "docs" / "site" / "gallery.toml"), begin = "\"poise ";
  for (std::size_t at = gallery.find(begin); at != std::string::npos; at = gallery.find(begin, at + 1)) {
    const std::size_t first = at + begin.size();
    const std::string line = gallery.substr(first, gallery.find('"', first) - first);
    const bool is_alone = line.find("--scene ") == std::string::npos && words_of(line).at(1).starts_with("datasets/");
    if (is_alone) out.push_back(line);
  }
  return out;
}

/// The scenes of datasets/ and two of its folders.
std::vector<fs::path> scenes() {
  std::vector<fs::path> out;
  for (const char* const folder : {"", "friction", "structures", "assemblies"}) {
    for (const auto& entry : fs::directory_iterator(source / "datasets" / folder)) {
      const std::string name = entry.path().filename().string();
      const auto is_of = [&](const char* kind) { return name.find(kind) != std::string::npos; };
      if (entry.path().extension() != ".toml" || is_of("_design") || is_of("_experiment") || is_of("_tolerances") ||
          is_of("_plan"))
        continue;
      out.push_back(entry.path());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Some of a list: its next ones in every round, in an order that a seed has shuffled.
template <class T>
std::vector<T> of_this_round(std::vector<T> all, int sample, int of_round) {
  std::shuffle(all.begin(), all.end(), std::mt19937_64(20261129));
  const auto count = static_cast<std::size_t>(test::cases(sample, of_round));
  std::vector<T> out;
  for (std::size_t k = 0; k < std::min(count, all.size()); ++k)
    out.push_back(all[(test::campaign_round() * count + k) % all.size()]);
  return out;
}

void expect_legible(const std::string& what) {
  for (const auto& complaint : Browser::shared().run(contents(source / "tests" / "page" / "overlapping_texts.js")))
    ADD_FAILURE() << what << ": " << complaint.get<std::string>();
}

constexpr test::Screen wide{}, telephone{.width = 400, .height = 800};

class TextsOfPages : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
  }
  void TearDown() override {
    if (!Browser::missing().empty()) return;
    Browser::shared().emulate({});
    Browser::shared().open("about:blank");
    Browser::shared().console();
  }
};

TEST_F(TextsOfPages, OfReportsStandApart) {
  const TempFolder folder;
  const std::string file = folder.path("report.html").string();
  for (const std::string& line : of_this_round(reports(), 4, 12)) {
    std::vector<std::string> command = words_of(line);
    for (std::string& word : command) {
      if (word.starts_with("datasets/")) word = (source / word).string();
    }
    command.insert(command.end(), {"--quiet", "--html", file});
    fs::remove(file);
    const app_tests::ProgramRun ran = run_poise(command);
    if (!fs::exists(file)) {
      ADD_FAILURE() << line << ": " << ran.err;
      continue;
    }
    for (const test::Screen& screen : {wide, telephone}) {
      Browser::shared().emulate(screen);
      Browser::shared().open("file://" + file);
      ASSERT_TRUE(Browser::shared().wait_for("document.querySelector('h1') && document.readyState === 'complete'"));
      expect_legible("poise " + line + " at " + std::to_string(screen.width) + " px");
    }
  }
}

TEST_F(TextsOfPages, OfLivePagesStandApart) {
  for (const fs::path& scene : of_this_round(scenes(), 3, 8)) {
    const std::string text = contents(scene);
    app::BackgroundView view(app::SceneInMemory{read_scene(scene.string()), text, scene.string()});
    for (const test::Screen& screen : {wide, telephone}) {
      Browser::shared().emulate(screen);
      Browser::shared().open(view.address());
      ASSERT_TRUE(Browser::shared().wait_for("document.body.dataset.revision !== undefined"));
      ASSERT_TRUE(Browser::shared().wait_for("!document.querySelector('.stage.moving')"));
      expect_legible("poise view " + scene.filename().string() + " at " + std::to_string(screen.width) + " px");
    }
    Browser::shared().open("about:blank");
  }
}

/// The lowest place of a shape of a drawing's JSON, px downwards; texts are left out.
double bottom_of(const json& shape) {
  const std::string& kind = shape[0].get_ref<const std::string&>();
  double out = -INFINITY;
  if (kind == "line") out = std::max(shape[3].get<double>(), shape[5].get<double>());
  if (kind == "circle" || kind == "arc") out = shape[3].get<double>() + shape[4].get<double>();
  if (kind == "polyline" || kind == "polygon") {
    for (std::size_t k = 1; k < shape[2].size(); k += 2) out = std::max(out, shape[2][k].get<double>());
  }
  return out;
}

// The normal force of the portal's links is the same along each straight part, and steps where its right link has its
// corner: what is drawn are rectangles beside the parts, without a slanted step between them.
TEST(LoadsPage, DiagramsFollowTheShapeOfALink) {
  const TempFolder folder;
  const std::string file = folder.path("portal.html").string();
  const std::string scene = (source / "datasets" / "structures" / "three_hinged_portal.toml").string();
  ASSERT_EQ(run_poise({"loads", scene, "--quiet", "--html", file}).exit_code, 0);
  const json page = json::parse(document_in(contents(file)));
  const json& drawing = page["figures"][0]["drawing"];
  int parts = 0;
  for (std::size_t k = 0; k < drawing["slots"].size(); ++k) {
    const int number = drawing["frames"][0][k];
    if (drawing["slots"][k][0] != "diagrams" || number < 0) continue;
    const json& shape = drawing["shapes"][static_cast<std::size_t>(number)];
    if (shape[0] != "polygon") continue;
    const auto at = shape[2].get<std::vector<double>>();
    ASSERT_EQ(at.size(), 8U);
    for (std::size_t i = 0; i < 8; i += 2) {
      const double across = at[i] - at[(i + 2) % 8], down = at[i + 1] - at[(i + 3) % 8];
      EXPECT_LT(std::min(std::abs(across), std::abs(down)), 0.2) << shape;
    }
    EXPECT_NE(drawing["slots"][k][1].get<std::string>().find(" kN"), std::string::npos)
        << "its value beside the pointer";
    ++parts;
  }
  EXPECT_GT(parts, 4 * 20);
}

// The circles of a planetary gear did, which belong to no point of a body.
TEST(LivePages, NothingIsDrawnUnderTheLegend) {
  for (const fs::path& scene : scenes()) {
    app::ViewSession session(app::SceneInMemory{read_scene(scene.string()), contents(scene), scene.string()});
    const json drawing = session.page()["view"]["drawing"];
    double legend = INFINITY, lowest = -INFINITY;
    // Rows of a frame are as many as there are slots; those that are empty have -1.
    for (std::size_t k = 0; k < drawing["slots"].size(); ++k) {
      const std::string layer = drawing["slots"][k][0];
      const int number = drawing["frames"][0][k];
      if (number < 0) continue;
      const json& shape = drawing["shapes"][static_cast<std::size_t>(number)];
      if (layer == "legend") {
        if (shape[0] == "line" && shape[2] != shape[4]) legend = std::min(legend, shape[3].get<double>());
      } else if (layer != "scale" && layer != "gravity") {
        lowest = std::max(lowest, bottom_of(shape));
      }
    }
    EXPECT_LT(lowest, legend) << scene.filename();
  }
}

}  // namespace
}  // namespace poise::page_tests::texts_of_pages_test
