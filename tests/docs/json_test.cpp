// docs/json.md against the JSON and CSV files and the pages that the commands write: every key is documented with its
// type, and every documented key is written by one of the commands below.
#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/view/view_session.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/docs/page.hpp"
#include "tests/support/page_document.hpp"
#include "tests/support/toggle_rig.hpp"

namespace poise::docs_tests::json_test {
namespace {

using app_tests::contents;
using app_tests::run_poise;
using app_tests::TempFolder;
using Json = nlohmann::ordered_json;
using Path = std::vector<std::string>;  ///< members and "[]"

struct Key {
  Path path;  ///< "*" stands for any name
  std::string type;
  bool written = false;
  bool shared = false;  ///< of another section
};

/// A section of docs/json.md.
struct Section {
  std::vector<Key> json;
  std::vector<Key> csv;  ///< columns: paths of one name, in which "*" stands for anything
};

std::string text_of(const Path& path) {
  std::string out;
  for (const std::string& part : path) out += (out.empty() || part == "[]" ? "" : ".") + part;
  return out;
}

/// "reactions[].force[]" -> reactions, [], force, [].
Path path_of(const std::string& text) {
  static const std::regex part(R"([^.\[\]]+|\[\])");
  Path out;
  for (std::sregex_iterator it(text.begin(), text.end(), part); it != std::sregex_iterator(); ++it) {
    out.push_back(it->str());
  }
  return out;
}

bool matches(const Path& pattern, const Path& path) {
  return pattern.size() >= path.size() &&
         std::equal(path.begin(), path.end(), pattern.begin(),
                    [](const auto& a, const auto& b) { return a == b || (b == "*" && a != "[]"); });
}

bool column_matches(const std::string& pattern, const std::string& column) {
  std::string expression;
  for (const char c : pattern)
    expression += c == '*'                                           ? std::string("(.+)")
                  : std::isalnum(static_cast<unsigned char>(c)) != 0 ? std::string(1, c)
                                                                     : std::string("\\") + c;
  return std::regex_match(column, std::regex(expression));
}

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> out;
  std::size_t at = 1;
  for (std::size_t end = row.find(" |", at); end != std::string::npos; end = row.find(" |", at)) {
    out.push_back(row.substr(at + 1, end - at - 1));
    at = end + 2;
  }
  return out;
}

/// The sections by their headings; a row of the type "keys of [NAME](#name)" has the keys of that section below its
/// own.
std::map<std::string, Section> read_sections() {
  static const std::regex keys_of(R"(keys of \[([^\]]+)\].*)");
  std::map<std::string, Section> out;
  std::vector<Key>* list = nullptr;
  std::string name;
  for (const std::string& line : read_page(std::filesystem::path(POISE_SOURCE_DIR) / "docs" / "json.md").lines) {
    if (line.starts_with("## ")) name = line.substr(3);
    if (line.starts_with("| key |")) list = &out[name].json;
    if (line.starts_with("| column |")) list = &out[name].csv;
    if (!line.starts_with('|')) list = nullptr;
    if (list == nullptr || !line.starts_with("| `")) continue;
    const std::vector<std::string> cells = cells_of(line);
    const std::string key = cells.at(0).substr(1, cells[0].size() - 2);
    std::smatch match;
    if (list == &out[name].csv) {
      list->push_back({{key}, ""});
    } else if (std::regex_match(cells.at(1), match, keys_of)) {
      for (const Key& below : std::as_const(out[match[1].str()]).json) {
        Key grafted = below;
        grafted.shared = true;
        const Path before = key == "*" ? Path{} : path_of(key);
        grafted.path.insert(grafted.path.begin(), before.begin(), before.end());
        list->push_back(grafted);
      }
    } else {
      list->push_back({path_of(key), cells.at(1)});
    }
  }
  return out;
}

std::string type_of(const Json& value) {
  if (value.is_null()) return "null";
  if (value.is_boolean()) return "true or false";
  if (value.is_number_integer()) return "whole number";
  if (value.is_number()) return "number";
  return "text";
}

bool allows(const std::string& documented, const std::string& type) {
  if (type == "whole number" && documented.find("number") != std::string::npos) return true;
  if (type == "number" && documented.find("whole number") != std::string::npos) return false;
  return documented.find(type) != std::string::npos;
}

class Checker {
 public:
  explicit Checker(std::vector<Key>& keys) : keys_(keys) {}

  void check(const Json& value, const Path& path) {
    if (value.is_structured() && !value.empty()) {
      for (const auto& item : value.items()) {
        Path below = path;
        below.push_back(value.is_array() ? "[]" : item.key());
        check(item.value(), below);
      }
      return;
    }
    bool documented = false;
    for (Key& key : keys_) {
      if (!matches(key.path, path)) continue;
      // An empty list or object stands for all that could be in it.
      const bool leaf = key.path.size() == path.size() && !value.is_structured();
      if (leaf && !allows(key.type, type_of(value))) continue;
      documented = documented || leaf || value.is_structured() || (value.is_null() && key.path.size() > path.size());
      key.written = key.written || leaf;
    }
    EXPECT_TRUE(documented) << text_of(path) << ": " << type_of(value) << " is not documented";
  }

 private:
  std::vector<Key>& keys_;
};

/// Keys that sections share are looked for where they have them all.
enum class Shared { some, all };

void expect_all_written(const std::vector<Key>& keys, Shared shared) {
  for (const Key& key : keys) {
    if (shared == Shared::some && key.shared) continue;
    EXPECT_TRUE(key.written) << text_of(key.path) << " is documented and never written";
  }
}

/// The items of a report, those of each section behind it.
std::vector<Json> all_items(const Json& items) {
  std::vector<Json> out;
  for (const Json& item : items) {
    Json& one = out.emplace_back(item);
    if (item.at("kind") != "section") continue;
    one.erase("items");
    for (Json& below : all_items(item.at("items"))) out.push_back(std::move(below));
  }
  return out;
}

/// Checks a page against its section and the file of --json that was written beside it.
void check_page(std::vector<Key>& keys, const std::string& page, const Json& result) {
  Json document = Json::parse(page_tests::document_in(page));
  EXPECT_TRUE(page_tests::are_data_of(document["result"], result));
  document["result"] = nullptr;
  document["report"] = all_items(document["report"]);
  Checker(keys).check(document, {});
}

struct Run {
  std::vector<std::string> arguments;
  bool csv = false;
};
constexpr bool with_csv = true;

std::string scene(const std::string& name) { return app_tests::dataset(name); }

/// What writes the keys of a section.
void check_section(const std::string& name, const std::vector<Run>& runs, Shared shared = Shared::some) {
  std::map<std::string, Section> sections = read_sections();
  Section& section = sections[name];
  ASSERT_FALSE(section.json.empty()) << "docs/json.md has no section " << name;
  const TempFolder folder;
  for (const Run& run : runs) {
    std::vector<std::string> arguments = run.arguments;
    arguments.insert(arguments.end(),
                     {"--json", folder.path("out.json").string(), "--html", folder.path("out.html").string()});
    if (run.csv) arguments.insert(arguments.end(), {"--csv", folder.path("out.csv").string()});
    SCOPED_TRACE(testing::PrintToString(run.arguments));
    const app_tests::ProgramRun outcome = run_poise(arguments);
    ASSERT_LT(outcome.exit_code, 2) << outcome.err;
    const Json result = Json::parse(contents(folder.path("out.json")));
    Checker(section.json).check(result, {});
    check_page(sections["The page"].json, contents(folder.path("out.html")), result);
    if (!run.csv) continue;
    std::istringstream header(split_lines(contents(folder.path("out.csv"))).at(0));
    for (std::string column; std::getline(header, column, ',');) {
      // "*.rate" rather than "*".
      Key* best = nullptr;
      for (Key& key : section.csv) {
        const bool better = best == nullptr || key.path.front().size() > best->path.front().size();
        if (better && column_matches(key.path.front(), column)) best = &key;
      }
      EXPECT_NE(best, nullptr) << "column " << column << " is not documented";
      if (best != nullptr) best->written = true;
    }
  }
  expect_all_written(section.json, shared);
  expect_all_written(section.csv, shared);
}

/// A pendulum on a driven crank; it passes its stop.
constexpr const char* driven = R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], P = [1, 0] }
[body.bob]
points = { P = [0, 0] }
mass = 1
center = [1, 0]
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.P", "bob.P"]
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
rate = 1
[[stop]]
bodies = ["ground", "bob"]
min = -0.5
)";

/// A lid with outputs.
constexpr const char* lid = R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.lid]
points = { O = [0, 0], grip = [1, 0] }
mass = 1
center = [0, -1]
[[pin]]
points = ["ground.O", "lid.O"]
[outputs]
hand = "push.lid.grip.y * 1.1"
lost = "energy / push.lid.grip.x"
)";

TEST(JsonDocs, Check) {
  const TempFolder folder;
  check_section("check", {{{"check", scene("redundant_parallelogram")}},
                          {{"check", folder.write("driven.toml", driven)}},
                          {{"check", scene("balanced_arm")}},
                          {{"check", scene("shaken_pendulum")}},
                          {{"check", scene("planetary_gear")}},
                          {{"check", folder.write("lid.toml", lid)}},
                          {{"check", scene("machines/castor")}},
                          {{"check", scene("toggle_clamp"), "--set", "load.P=30"}}});
}

/// A plate on a pin with clearance, which dry friction may hold.
constexpr const char* plate = R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.plate]
points = { hole = [0, 0] }
mass = 1
center = [0, -1]
[[stop]]
points = ["ground.O", "plate.hole"]
max = 0.1
[[friction]]
bodies = ["ground", "plate"]
torque = 1
[start]
plate = 0.1
position = { plate = [0, -0.05] }
)";

// Its start is unstable, and stops hold what falls from it.
constexpr const char* rocker = R"(
ground.points = { O = [0, 0], H = [-1, 0] }
body.lever.points = { O = [0, 0], B = [2, 0] }
pin = [{ name = "O", points = ["ground.O", "lever.O"] }]
spring = [{ name = "s", points = ["ground.H", "lever.B"], stiffness = 2, free_length = 2.5 }]
stop = [{ name = "travel", bodies = ["ground", "lever"], min = -0.3, max = 0.3 }]
)";

/// A fit of the toggle rig, which is in the folder.
std::string fitted_rig(const TempFolder& folder) {
  folder.write("rig.toml", test::rig_scene());
  const std::string file = folder.path("fit.json").string();
  const app_tests::ProgramRun run =
      run_poise({"identify", folder.write("swing.toml", test::rig_experiment(1)), "--json", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return file;
}

TEST(JsonDocs, Solve) {
  const TempFolder folder;
  const std::string fit = fitted_rig(folder);
  check_section("solve",
                {{{"solve", scene("toggle_clamp"), "--set", "load.P=30"}},
                 {{"solve", scene("toggle_clamp"), "--show", "force.rubber,d(angle.arm)/d(angle.handle)"}},
                 {{"solve", folder.write("lid.toml", lid)}},
                 {{"solve", scene("thesis_four_bar_reversed")}},
                 {{"solve", scene("forced_machine"), "--time", "0.05"}},
                 {{"solve", scene("four_bar_torsion")}},
                 {{"solve", scene("hard/follower_four_bar"), "--method", "energy"}},
                 {{"solve", scene("lift")}},
                 {{"solve", scene("cam_follower")}},
                 {{"solve", scene("hard/balanced_lamp")}},
                 {{"solve", scene("hard/taut")}},
                 {{"solve", scene("friction/drawer")}},
                 {{"solve", folder.write("plate.toml", plate)}},
                 {{"solve", folder.path("rig.toml").string(), "--with", fit}},
                 {{"solve", folder.write("rocker.toml", rocker)}}},
                Shared::all);
}

/// A block on two springs, which nothing else holds: it snaps through between them.
constexpr const char* free_toggle = R"(
[ground]
points = { L = [-1, 0], R = [1, 0] }
[body.block]
points = { C = [0, 0] }
[[spring]]
name = "left"
points = ["ground.L", "block.C"]
stiffness = 1000
free_length = 1.118
[[spring]]
name = "right"
points = ["ground.R", "block.C"]
stiffness = 1000
free_length = 1.118
[[force]]
name = "load"
at = "block.C"
vector = [0, -20]
[[friction]]
bodies = ["ground", "block"]
torque = 1
[start]
position = { block = [0, 0.45] }
)";

TEST(JsonDocs, Hold) {
  check_section("hold", {{{"hold", scene("friction/toggle"), "--vary", "load.P"}},
                         {{"hold", scene("friction/wedge"), "--vary", "load.P"}},
                         {{"hold", scene("friction/screw"), "--vary", "load.H"}},
                         {{"hold", scene("friction/ladder"), "--vary", "slide.floor.friction.coefficient=0..0.1"}}});
}

TEST(JsonDocs, Find) {
  const std::string stiffness = "spring.rubber.stiffness=200..800";
  check_section("find",
                {{{"find", scene("toggle_clamp"), "--vary", stiffness, "--for", "force.rubber = -700"}, with_csv},
                 {{"find", scene("knee_press"), "--vary", "load.P=5.5..6", "--for", "angle.upper = -10"}},
                 {{"find", scene("knee_press"), "--vary", "angle.upper=20..80", "--for", "angle.upper = 30", "--show",
                   "transmission.lower.wrist"}},
                 {{"find", scene("toggle_clamp"), "--vary", "load.P=10..25", "--for", "stop.over_centre = 1", "--all"}},
                 {{"find", scene("toggle_clamp"), "--vary", stiffness, "--for", "fold.load.P = 40"}}});
}

TEST(JsonDocs, Equilibria) {
  check_section("equilibria",
                {{{"equilibria", scene("von_mises_toggle"), "--starts", "100", "--show",
                   "energy,force.left,d(x.apex.C)/d(x.apex.C)"},
                  with_csv},
                 {{"equilibria", scene("hard/balanced_arm"), "--starts", "20"}},
                 {{"equilibria", scene("hard/counterweight"), "--starts", "20"}},
                 {{"equilibria", scene("hard/kink"), "--starts", "20"}},
                 {{"equilibria", scene("hard/rhombus")}},
                 {{"equilibria", scene("hard/flat_sprung_parallelogram")}},
                 {{"equilibria", scene("four_bar_gravity"), "--assemblies", "--drive", "crank=1", "--starts", "20"}}});
}

TEST(JsonDocs, Path) {
  const TempFolder folder;
  const std::string fit = fitted_rig(folder);
  check_section("path",
                {{{"path", scene("von_mises_toggle"), "--vary", "load.P=0..60", "--at", "30"}, with_csv},
                 {{"path", scene("von_mises_toggle"), "--vary", "load.P=0..60", "--follow", "jump"}},
                 {{"path", scene("toggle_clamp"), "--vary", "load.P=0..40", "--at", "10"}},
                 {{"path", scene("toggle_clamp"), "--vary", "load.P=0..40", "--follow", "jump", "--snap", "dynamic"}},
                 {{"path", scene("toggle_press"), "--vary", "angle.crank=120..160", "--show",
                   "force.crank,max(travel.gib),mean(energy)"},
                  with_csv},
                 {{"path", folder.write("toggle.toml", free_toggle), "--vary", "load.load=0..60", "--at", "10", "--set",
                   "spring.left.stiffness=1000"}},
                 {{"path", scene("hard/follower_four_bar"), "--vary", "loads=0.5..1"}},
                 {{"path", folder.path("rig.toml").string(), "--vary", "load.P=0..40", "--with", fit}},
                 {{"path", scene("forced_machine"), "--vary", "body.machine.mass=20..30"}}},
                Shared::all);
}

TEST(JsonDocs, PathBeside) {
  check_section("path --beside",
                {{{"path", scene("toggle_clamp"), "--vary", "load.P=0..40", "--at", "10,39", "--show", "y.arm.T",
                   "--variant", "soft: spring.rubber.stiffness=200", "--variant", "stiff: spring.rubber.stiffness=900"},
                  with_csv},
                 {{"path", scene("toggle_press"), "--vary", "angle.crank=120..150", "--at", "130", "--beside",
                   scene("toggle_press")},
                  with_csv}});
}

constexpr const char* hung_by_a_bar = R"([ground]
points = { O = [0, 0], A = [2, 1] }
[body.arm]
points = { O = [0, 0], B = [1, 0] }
[body.weight]
points = { at = [0, 0] }
[[pin]]
points = ["ground.O", "arm.O"]
[[bar]]
points = ["arm.B", "weight.at"]
length = 1
[[spring]]
points = ["ground.A", "arm.B"]
stiffness = 50
free_length = 1
[[force]]
name = "W"
at = "weight.at"
direction = [0, -1]
size = 0
[start.position]
weight = [1, -1]
)";

TEST(JsonDocs, LoadsOverARange) {
  const TempFolder folder;
  check_section("loads --vary",
                {{{"loads", scene("structures/three_hinged_portal"), "--vary", "load.wind=0..20"}, with_csv},
                 {{"loads", scene("toggle_press"), "--vary", "angle.crank=110..150"}, with_csv},
                 {{"loads", folder.write("hung.toml", hung_by_a_bar), "--vary", "load.W=1..20"}, with_csv},
                 {{"loads", scene("redundant_parallelogram"), "--vary", "load.W=1..2"}}});
}

TEST(JsonDocs, PathCurveOfFolds) {
  check_section("path --curve fold",
                {{{"path", scene("hard/imperfect_pendulum"), "--vary", "torsion_spring.spring.stiffness=0.9..1.1",
                   "--vary", "torsion_spring.spring.free_angle=1.55..1.59", "--curve", "fold"},
                  with_csv},
                 {{"path", scene("von_mises_toggle"), "--vary", "load.P=0..60", "--vary",
                   "spring.left.stiffness=900..1100", "--curve", "fold", "--set", "spring.right.stiffness=900"}}});
}

TEST(JsonDocs, Sensitivity) {
  check_section("sensitivity",
                {{{"sensitivity", scene("toggle_clamp"), "--of", "handle,stop.open,load_at_fold.P"}, with_csv},
                 {{"sensitivity", scene("redundant_parallelogram"), "--of", "energy,reaction.A1"}}});
}

TEST(JsonDocs, Tolerance) {
  const TempFolder folder;
  const std::string tolerances = scene("toggle_clamp_tolerances");
  check_section("tolerance", {{{"tolerance", scene("toggle_clamp"), "--tolerances", tolerances, "--of",
                                "force.rubber,load_at_fold.P,reaction.B", "--samples", "300"},
                               with_csv},
                              {{"tolerance", scene("redundant_parallelogram"), "--tolerances",
                                folder.write("t.toml", "tolerances = { \"load.*\" = 0.1 }"), "--of", "energy"}}});
}

TEST(JsonDocs, Compare) {
  check_section("compare", {{{"compare", scene("toggle_clamp")}}, {{"compare", scene("hard/follower_four_bar")}}});
}

TEST(JsonDocs, CompareTolerances) {
  check_section("compare --tolerances",
                {{{"compare", scene("toggle_clamp"), "--tolerances", "1e-2,1e-8", "--repeat", "1"}, with_csv},
                 {{"compare", scene("hard/follower_four_bar"), "--tolerances", "1e-2,1e-8", "--repeat", "1"}}});
}

TEST(JsonDocs, Modes) {
  check_section("modes", {{{"modes", scene("lift")}},
                          {{"modes", scene("double_pendulum")}},
                          {{"modes", scene("toggle_clamp")}},
                          {{"modes", scene("machines/deadbeat_table")}},
                          {{"modes", scene("machines/late_pendulum")}},
                          {{"modes", scene("machines/sled_across_slope")}},
                          {{"modes", scene("machines/cart_pole")}, with_csv}});
}

TEST(JsonDocs, Equations) {
  check_section("equations", {{{"equations", scene("lift")}, with_csv}, {{"equations", scene("slider_crank")}}});
}

/// Two leaves of a table that swing against each other in a mode of which the table tells nothing, and a peg that is
/// pressed on its stop.
constexpr const char* two_leaves = R"(
[ground]
points = { O = [0, 0] }
[body.table]
points = { P = [0, 0] }
mass = 3
[body.left]
points = { P = [0, 0] }
mass = 1
[body.right]
points = { P = [0, 0] }
mass = 1
[[slide]]
name = "guide"
points = ["ground.O", "table.P"]
axis = [0, 1]
[[slide]]
name = "one"
points = ["table.P", "left.P"]
axis = [0, 1]
[[slide]]
name = "two"
points = ["table.P", "right.P"]
axis = [0, 1]
[[spring]]
name = "mount"
slide = "guide"
stiffness = 50
free_length = 0
[[spring]]
name = "first leaf"
slide = "one"
stiffness = 9
free_length = 0
[[spring]]
name = "second leaf"
slide = "two"
stiffness = 9
free_length = 0
[body.peg]
points = { P = [0, 0] }
mass = 1
[[slide]]
name = "hole"
points = ["ground.O", "peg.P"]
axis = [1, 0]
[[stop]]
name = "bottom"
slide = "hole"
min = 0
max = 1
[[force]]
name = "press"
at = "peg.P"
vector = [-1, 0]
)";

TEST(JsonDocs, Response) {
  const TempFolder folder;
  check_section("response",
                {{{"response", scene("lift"), "--excite", "spring.oil.free_length", "--of", "angle.fa"}, with_csv},
                 {{"response", scene("duffing"), "--excite", "load.F", "--of", "x.mass.C", "--amplitude", "0.2", "--to",
                   "0.3", "--at", "0.207"},
                  with_csv},
                 {{"response", scene("forced_machine"), "--excite", "load.F", "--of", "y.machine.C"}},
                 {{"response", folder.write("leaves.toml", two_leaves), "--excite", "spring.mount.free_length", "--of",
                   "y.table.P"}}});
}

TEST(JsonDocs, Running) {
  check_section("running", {{{"running", scene("machines/motor_slider_crank"), "--show", "energy.kinetic"}, with_csv}});
}

TEST(JsonDocs, Kinematics) {
  check_section(
      "kinematics",
      {{{"kinematics", scene("lift"), "--drive", "stroke=0.5..0.79", "--steps", "3", "--show", "force.stroke,energy"},
        with_csv},
       {{"kinematics", scene("car_hood"), "--drive", "hood=0..1.2", "--steps", "3"}},
       {{"kinematics", scene("redundant_parallelogram"), "--drive", "crank1=1..4", "--steps", "3"}},
       {{"kinematics", scene("offset_cam"), "--drive", "cam=0..90", "--steps", "3"}, with_csv}});
}

/// Two drives of one arm that part.
constexpr const char* torn = R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
inertia = 1
[[pin]]
points = ["ground.O", "arm.O"]
[[drive]]
bodies = ["ground", "arm"]
rate = 1
[[drive]]
bodies = ["ground", "arm"]
rate = 1
acceleration = 0.5
)";

/// A slider-crank with a section, a spring and a damper, driven at its block past the dead centre, and a
/// parallelogram that is driven through its change point. A torque enters one of its links nobody knows where.
constexpr const char* driven_press = R"(
[ground]
points = { O = [0, 0], P = [0, 2], Q = [0.4, 2] }
[body.crank]
points = { O = [0, 0], A = [0.1, 0] }
mass = 2
inertia = 0.05
[body.rod]
points = { A = [0, 0], B = [0.3, 0] }
mass = 1
center = [0.15, 0]
inertia = 0.01
[body.rod.section]
area = 1e-4
second_moment = 1e-9
modulus = 2e11
height = 0.01
line = ["A", "B"]
[body.block]
points = { B = [0, 0] }
mass = 0.5
[body.one]
points = { P = [0, 0], A = [0.2, 0] }
mass = 1
[body.coupler]
points = { A = [0, 0], B = [0.4, 0] }
mass = 1
[body.two]
points = { Q = [0, 0], B = [0.2, 0] }
mass = 1
[body.two.section]
area = 1e-4
second_moment = 1e-9
modulus = 2e11
height = 0.01
line = ["Q", "B"]
[[torque]]
on = "two"
value = 1
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "B"
points = ["rod.B", "block.B"]
[[pin]]
name = "P"
points = ["ground.P", "one.P"]
[[pin]]
name = "Q"
points = ["ground.Q", "two.Q"]
[[pin]]
name = "S"
points = ["one.A", "coupler.A"]
[[pin]]
name = "T"
points = ["two.B", "coupler.B"]
[[slide]]
name = "ram"
points = ["ground.O", "block.B"]
axis = [1, 0]
[[spring]]
name = "S1"
points = ["ground.O", "block.B"]
stiffness = 10
free_length = 0.1
[[damper]]
name = "D1"
points = ["ground.O", "block.B"]
coefficient = 10
[[drive]]
name = "winch"
slide = "ram"
start = 0.35
rate = 0.05
[[drive]]
name = "turn"
bodies = ["ground", "one"]
start = -1
rate = 2
[start]
crank = 0.9
rod = -0.26
ram = 0.35
one = -1
two = -1
)";

TEST(JsonDocs, Motion) {
  const TempFolder folder;
  check_section(
      "motion",
      {{{"motion", scene("lift"), "--duration", "0.1", "--release", "obd=0.005"}, with_csv},
       {{"motion", scene("nfb2"), "--from", "start", "--release-rate", "post0=-1", "--duration", "2"}},
       {{"motion", folder.write("driven.toml", driven), "--duration", "1"}},
       {{"motion", scene("lift"), "--duration", "0.1", "--release", "obd=0.005", "--show", "force.oil,max(force.oil)"}},
       {{"motion", scene("landing_gear_drop"), "--from", "start", "--duration", "1.2"}},
       {{"motion", scene("machines/castor"), "--release", "castor=0.01", "--duration", "0.1"}},
       {{"motion", folder.write("torn.toml", torn), "--duration", "1"}, with_csv},
       {{"motion", folder.write("press.toml", driven_press), "--duration", "2", "--rate", "20", "--forces"}, with_csv},
       {{"motion", scene("three_motor_robot"), "--duration", "0.1", "--rate", "50", "--motors", "shoulder,elbow"}}});
}

/// A slider-crank, driven at its block past the dead point.
constexpr const char* slider_crank = R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [1, 0] }
[body.rod]
points = { B = [0, 0], C = [3, 0] }
[body.block]
points = { C = [0, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin]]
points = ["rod.C", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[torque]]
on = "crank"
value = 20
[start]
crank = 1
rail = 3.4
)";

/// A follower that a cam at 3000 turns a minute loses, and that rubs along a wall.
constexpr const char* valve = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.cam]
points = { O = [0, 0] }
[body.follower]
points = { P = [0, 0] }
mass = 0.35
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.O", "follower.P"]
axis = [0, 1]
[[cam]]
name = "valve"
bodies = ["ground", "cam"]
follower = { slide = "guide" }
law = [{ to = 2, lift = 1, law = "cycloidal" }, { to = 4, lift = 0, law = "cycloidal" }, { to = 6.283185307179586, law = "dwell" }]
lift = 0.01
base = 0
[[spring]]
slide = "guide"
stiffness = 12000
free_length = -0.0125
[[stop]]
name = "wall"
x = "follower.P"
max = 0.1
friction = 0.1
[start]
cam = 0
)";

TEST(JsonDocs, Forces) {
  const TempFolder folder;
  check_section(
      "forces",
      {{{"forces", scene("toggle_clamp"), "--drive", "handle=30..60", "--steps", "2", "--show",
         "force.handle,d(angle.arm)/d(angle.handle)"},
        with_csv},
       {{"forces", scene("toggle_clamp"), "--drive", "handle=60", "--show", "shaking.x,d(angle.arm)/d(x.handle.C)"}},
       {{"forces", scene("car_hood"), "--drive", "hood=0..1.2", "--steps", "3"}},
       {{"forces", scene("lift"), "--drive", "stroke=0.6", "--rate", "0.1"}, with_csv},
       {{"forces", scene("redundant_parallelogram"), "--drive", "crank1=1"}},
       {{"forces", scene("offset_cam"), "--drive", "cam=0..90", "--steps", "3"}, with_csv},
       {{"forces", scene("offset_cam"), "--drive", "cam=30"}},
       {{"forces", scene("machines/castor")}, with_csv},
       {{"forces", scene("friction/crank_press"), "--drive", "crank=0..90", "--rate", "1", "--steps", "2"}, with_csv},
       {{"forces", folder.write("crank.toml", slider_crank), "--drive", "rail=3.5..1.5"}},
       {{"forces", folder.write("valve.toml", valve), "--drive", "cam=0..6.28", "--rate", "314", "--steps", "9",
         "--lift-off", "valve"},
        with_csv},
       {{"forces", scene("toggle_press"), "--drive", "crank=0..360", "--rate", "360", "--flywheel", "0.02"}}});
}

TEST(JsonDocs, Loads) {
  const TempFolder folder;
  constexpr const char* clamped_twice = R"(
[ground]
points = { A = [0, 0], B = [1, 0] }
[body.beam]
points = { A = [0, 0], B = [1, 0] }
[body.beam.section]
profile = "IPE 80"
modulus = 2.1e11
[body.strut]
points = { A = [0, 0], B = [1, 0] }
[body.strut.section]
profile = "IPE 80"
modulus = 2.1e11
[[weld]]
points = ["ground.A", "beam.A"]
[[weld]]
points = ["ground.B", "beam.B"]
[[pin]]
points = ["ground.A", "strut.A"]
[[pin_in_slot]]
points = ["ground.B", "strut.B"]
axis = [1, 0]
[[force]]
at = "strut.B"
vector = [-3, 0]
)";
  check_section("loads",
                {{{"loads", scene("structures/three_hinged_portal"), "--show", "energy,shaking.moment"}, with_csv},
                 {{"loads", scene("structures/elastica")}},
                 {{"loads", scene("structures/falling_chimney"), "--time", "0.5"}},
                 {{"loads", folder.write("clamped.toml", clamped_twice)}}});
}

/// A lamp whose springs have a free length, and one whose springs are too soft.
constexpr const char* lamp_springs = R"(scene = "SCENE"
[balance]
of = "weights"
springs = { "spring.lower.stiffness" = [0, 1000], "spring.upper.stiffness" = [0, GREATEST] }
)";

TEST(JsonDocs, Balance) {
  const TempFolder folder;
  const std::string lamp = contents(scene("desk_lamp"));
  const auto replace = [](std::string text, const std::string& old, const std::string& by) {
    for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at + by.size())) {
      text.replace(at, old.size(), by);
    }
    return text;
  };
  folder.write("lamp.toml", replace(lamp, "free_length = 0", "free_length = 0.02"));
  folder.write("soft.toml", replace(replace(lamp_springs, "SCENE", scene("desk_lamp")), "GREATEST", "200"));
  folder.write("real.toml", replace(replace(lamp_springs, "SCENE", "lamp.toml"), "GREATEST", "1000") +
                                "over = { \"angle.lower\" = [-60, 60], \"angle.upper\" = [-60, 60] }\n");
  check_section("design of a balance", {{{"design", scene("desk_lamp_design")}},
                                        {{"design", folder.path("soft.toml").string()}},
                                        {{"design", folder.path("real.toml").string()}},
                                        {{"design", scene("four_bar_shaking_design")}}});
}

TEST(JsonDocs, Design) { check_section("design", {{{"design", scene("lift_design")}}}); }

TEST(JsonDocs, DesignOfFourBars) {
  const TempFolder folder;
  // The origin of the body travels along a line.
  const std::string slide = folder.write("slide_design.toml", R"(
[synthesis]
kind = "poses"
poses = [[0, 0, 0], [0, 1, 10], [0, 2.5, -20], [0, 3, 35], [0, -1, 15]]
)");
  check_section("design of four-bars", {{{"design", scene("five_poses_design")}},
                                        {{"design", scene("four_poses_design")}},
                                        {{"design", scene("three_poses_design")}},
                                        {{"design", scene("function_design")}},
                                        {{"design", scene("free_start_design")}},
                                        {{"design", slide}}});
}

TEST(JsonDocs, DesignOfPaths) {
  const TempFolder folder;
  const std::string slider = folder.write("slider_design.toml", R"(
[synthesis]
kind = "path"
linkage = "slider-crank"
points = [[0, 0], [1, 0.5], [2, 0.4], [2.5, 0]]
)");
  check_section("design of paths", {{{"design", scene("nine_points_design")}},
                                    {{"design", scene("eighteen_points_design")}},
                                    {{"design", scene("foot_path_design"), "--starts", "20"}},
                                    {{"design", slider, "--starts", "20"}}});
}

/// A hand that pushes evenly and a weak spring: two aims, and goals that no bed meets together.
constexpr const char* even_bed = R"(
[variables]
"spring.balance.stiffness" = [5000, 30000]
"spring.balance.free_length" = [0.2, 0.4]
[[goal]]
of = "force.drive / 2"
along = "angle.bed"
over = [0, 90]
least = -60
most = 60
)";
constexpr const char* two_aims = R"(
[[goal]]
of = "force.drive / 2"
along = "angle.bed"
over = [0, 90]
aim = "flat"
[[goal]]
of = "force.balance"
along = "angle.bed"
at = 0
aim = "least"
)";
constexpr const char* too_much = R"(
[[goal]]
of = "force.drive / 2"
along = "angle.bed"
at = 45
least = 70
)";

TEST(JsonDocs, DesignForGoals) {
  const TempFolder folder;
  const std::string bed = "scene = \"" + scene("wall_bed") + "\"\n" + even_bed;
  check_section("design for goals", {{{"design", scene("wall_bed_robust_design")}},
                                     {{"design", scene("tailgate_design")}},
                                     {{"design", scene("knee_press_design")}},
                                     {{"design", scene("constant_force_design")}},
                                     {{"design", folder.write("aims.toml", bed + two_aims), "--trade-off", "3"}},
                                     {{"design", folder.write("conflict.toml", bed + too_much), "--starts", "5"}}});
}

/// A measured run beside simulated ones.
constexpr const char* measured = R"(
scene = "SCENE"
set = { "gravity.y" = -9.81 }
[[sensor]]
angle = "obd"
name = "obd"
noise = 1e-4
[[unknown]]
path = "spring.oil.stiffness"
[[known]]
path = "body.platform.mass"
deviation = 0.1
[[run]]
data = "measured.csv"
)";

// Only ratios of mass, stiffness and damping matter: there are combinations.
constexpr const char* oscillator = R"([ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
inertia = 2
[[pin]]
points = ["ground.O", "wheel.O"]
[[torsion_spring]]
name = "S"
bodies = ["ground", "wheel"]
stiffness = 80
)";
constexpr const char* ratios = R"(scene = "oscillator.toml"
[[sensor]]
name = "turn"
angle = "wheel"
noise = 1e-4
[[unknown]]
path = "body.wheel.inertia"
[[unknown]]
path = "torsion_spring.S.stiffness"
[[run]]
release = { wheel = 0.1 }
duration = 2
rate = 100
seed = 1
)";

// A wheel moves by the square of its centre's distance from the pin: the cost is no parabola.
constexpr const char* curved = R"(scene = "oscillator.toml"
set = { "body.wheel.inertia" = 0.5, "torsion_spring.S.stiffness" = 20, "body.wheel.mass" = 1, "body.wheel.center.x" = 0.1 }
[[sensor]]
name = "turn"
angle = "wheel"
noise = 1.4e-3
[[unknown]]
path = "body.wheel.center.x"
scale = 1
[[run]]
release = { wheel = 0.3 }
duration = 0.5
rate = 100
seed = 1
)";

TEST(JsonDocs, Identify) {
  const TempFolder folder;
  run_poise({"motion", scene("lift"), "--duration", "1", "--release", "obd=0.005", "--noise", "1e-4", "--csv",
             folder.path("measured.csv").string()});
  // One reading is an outlier.
  std::string data = contents(folder.path("measured.csv"));
  const std::size_t row = data.find("\n0.5,");
  ASSERT_NE(row, std::string::npos);
  data.replace(row + 5, 4, "0.38");
  folder.write("measured.csv", data);
  folder.write("oscillator.toml", oscillator);
  std::string experiment = measured;
  experiment.replace(experiment.find("SCENE"), 5, scene("lift"));
  // An oscillator of 1.007 Hz, read 1.7 times a second.
  std::string aliased = ratios;
  const std::string inertia = "[[unknown]]\npath = \"body.wheel.inertia\"\n";
  aliased.erase(aliased.find(inertia), inertia.size());
  aliased.replace(aliased.find("duration = 2\nrate = 100"), 23, "duration = 20\nrate = 1.7");
  folder.write("again.toml", ratios);
  // Only sums of mass, place of the centre and inertia are identifiable.
  std::string open = curved;
  open.insert(open.find("[[run]]"), "[[unknown]]\npath = \"body.wheel.mass\"\n" + inertia);
  open.replace(open.find("noise = 1.4e-3"), 14, "noise = 1e-4");
  // Five wheels that differ: the runs scatter.
  std::string scattered = ratios;
  scattered.erase(scattered.find(inertia), inertia.size());
  scattered.replace(scattered.find("angle = \"wheel\""), 15, "angle = \"wheel\"\ncolumn = \"wheel\"");
  scattered.erase(scattered.find("[[run]]"));
  for (const char* const wheel : {"1.98", "1.99", "2.01", "2.02", "2.03"}) {
    run_poise({"motion", folder.path("oscillator.toml").string(), "--set", std::string("body.wheel.inertia=") + wheel,
               "--duration", "2", "--release", "wheel=0.1", "--noise", "1e-4", "--csv",
               folder.path(std::string(wheel) + ".csv").string()});
    scattered +=
        std::string("[[run]]\nname = \"") + wheel + "\"\ndata = \"" + wheel + ".csv\"\nrelease = { wheel = 0.1 }\n";
  }
  // Read with a zero that is off: a gross misfit with its cause.
  std::string shifted = scattered.substr(0, scattered.find("[[run]]\nname = \"1.99\""));
  shifted.replace(shifted.find("column = \"wheel\""), 16, "column = \"wheel\"\nzero = 0.05");
  check_section(
      "identify",
      {{{"identify", scene("lift_experiment_four_runs"), "--set", "damper.oil film.coefficient=4100"}, with_csv},
       {{"identify", scene("lift_experiment_empty"), "--quick"}},
       {{"identify", folder.write("measured.toml", experiment), "--profile", "spring.oil.stiffness", "--bootstrap",
         "20"}},
       {{"identify", folder.write("aliased.toml", aliased)}},
       {{"identify", folder.write("curved.toml", curved)}},
       {{"identify", folder.write("open.toml", open)}},
       {{"identify", folder.write("ratios.toml", ratios)}},
       {{"identify", folder.write("scattered.toml", scattered)}},
       {{"identify", folder.write("shifted.toml", shifted)}},
       {{"identify", folder.write("joint.toml", "experiments = [\"ratios.toml\", \"again.toml\"]\n")}}},
      Shared::all);
}

TEST(JsonDocs, IdentifyWithSeveralExperiments) {
  const TempFolder folder;
  for (const auto& [release, file] : {std::pair("obd=0.005", "measured.csv"), std::pair("obd=0.004", "again.csv")}) {
    run_poise({"motion", scene("lift"), "--duration", "0.5", "--release", release, "--noise", "1e-4", "--csv",
               folder.path(file).string()});
  }
  std::string experiment = measured;
  experiment.replace(experiment.find("SCENE"), 5, scene("lift"));
  const std::string known =
      experiment.substr(experiment.find("[[known]]"), experiment.find("[[run]]") - experiment.find("[[known]]"));
  experiment.replace(experiment.find(known), known.size(), "");
  experiment += "[[run]]\nname = \"again\"\ndata = \"again.csv\"\n";
  std::string fuller = experiment;
  fuller.insert(fuller.find("[[run]]"), "[[unknown]]\npath = \"damper.oil film.coefficient\"\n");
  check_section("identify with several experiments",
                {{{"identify", folder.write("one.toml", experiment), folder.write("two.toml", fuller)}},
                 {{"identify", folder.path("one.toml").string(), folder.write("same.toml", experiment)}}});
}

TEST(JsonDocs, Validate) {
  const TempFolder folder;
  const std::string fit = folder.path("fit.json").string();
  run_poise({"identify", scene("lift_experiment_four_runs"), "--json", fit});
  check_section("validate",
                {{{"validate", scene("lift_experiment"), "--with", fit, "--set", "gravity.y=-9.8"}, with_csv},
                 {{"validate", scene("lift_experiment"), "--with", fit, "--starts", "measured"}}});
}

TEST(JsonDocs, Identifiability) {
  check_section("identifiability", {{{"identifiability", scene("lift_experiment")}},
                                    {{"identifiability", scene("lift_experiment_empty")}}});
}

TEST(JsonDocs, Plan) {
  const TempFolder folder;
  std::string text = contents(scene("lift_plan"));
  text.replace(text.find("\"lift.toml\""), 11, '"' + scene("lift") + '"');
  text.replace(text.find("[0, 200]"), 8, "[0]");  // no payload: nothing gives the scale
  text.replace(text.find("runs = 6"), 8, "runs = 2\ntime = 4\ncandidates = 8");
  check_section("plan", {{{"plan", folder.write("plan.toml", text)}}});
}

TEST(JsonDocs, MonteCarlo) {
  const TempFolder folder;
  folder.write("oscillator.toml", oscillator);
  check_section("montecarlo", {{{"montecarlo", scene("lift_experiment_four_runs"), "--trials", "3"}},
                               {{"montecarlo", folder.write("ratios.toml", ratios), "--trials", "3"}}});
}

TEST(JsonDocs, ImportAndExport) {
  const TempFolder folder;
  const std::string four_bar = std::string(POISE_SOURCE_DIR) + "/datasets/exchange/four_bar.txt";
  check_section("import", {{{"import", four_bar, "--scene", folder.path("four_bar.toml")}}});
  check_section("export", {{{"export", scene("toggle_clamp"), "--dxf", folder.path("clamp.dxf")}}});
}

TEST(JsonDocs, Stress) {
  check_section("stress", {{{"stress", "toggle-1e-6", "dead-centre-crank-0", "--starts", "2"}, with_csv},
                           {{"stress", "toggle-1e-6", "--safeguards", "--starts", "2"}},
                           {{"stress", "drawer-below-1e-9", "--starts", "2"}}});
}

// Between them these have everything that a page can have.
/// What the session of `poise view` writes, without its server.
TEST(JsonDocs, View) {
  std::vector<Key> keys = read_sections()["View"].json;
  const auto check = [&](Json state) {
    state["report"] = all_items(state["report"]);
    Checker(keys).check(state, {});
  };
  const TempFolder folder;
  check(Json::parse(app::ViewSession(folder.write("plate.toml", plate)).page().dump())["view"]);
  app::ViewSession session(folder.write("clamp.toml", contents(scene("toggle_clamp"))));
  Json state = Json::parse(session.page().dump())["view"];
  check(state);
  for (const char* request : {R"({"do": "set", "path": "load.P", "value": 40, "goes_on": true})", R"({"do": "look"})",
                              R"({"do": "drag", "point": "handle.grip", "px": [300, 300]})"}) {
    nlohmann::json asked = nlohmann::json::parse(request);
    asked["revision"] = state["revision"].get<long>();
    state = Json::parse(session.act(asked));
    check(state);
  }
  const auto answer = [&](nlohmann::json asked) {
    asked["revision"] = state["revision"].get<long>();
    Json out = Json::parse(session.act(asked));
    Json shown = out;
    if (shown["run"].is_object() && shown["run"].contains("page")) shown["run"]["page"] = nullptr;  // as in ThePage
    Checker(keys).check(shown, {});
    return out;
  };
  answer({{"do", "commands"}});
  answer({{"do", "templates"}});
  answer({{"do", "templates"}, {"name", "latch"}});
  const auto sought = nlohmann::json::array({{"--method", "energy"}});
  Json run = answer({{"do", "run"}, {"command", "solve"}, {"options", sought}});
  while (run["run"]["state"] == "running") run = answer({{"do", "result"}});
  answer({{"do", "result"}, {"html", true}});
  Checker(keys).check(Json::parse(session.act({{"do", "export"}, {"format", "dxf"}})), {});
  expect_all_written(keys, Shared::some);
}

TEST(JsonDocs, ThePage) {
  std::vector<Key> keys = read_sections()["The page"].json;
  const TempFolder folder;
  const std::string clamp = scene("toggle_clamp"), toggle = scene("von_mises_toggle");
  for (std::vector<std::string> arguments :
       std::vector<std::vector<std::string>>{{"solve", clamp, "--set", "load.P=30"},
                                             {"equilibria", toggle, "--starts", "20"},
                                             {"path", toggle, "--vary", "load.P=0..60", "--follow", "jump"},
                                             {"motion", scene("lift"), "--duration", "0.1", "--release", "obd=0.005"},
                                             {"tolerance", clamp, "--tolerances", scene("toggle_clamp_tolerances"),
                                              "--of", "force.rubber", "--samples", "300"},
                                             {"identify", scene("lift_experiment_four_runs")}}) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    arguments.insert(arguments.end(),
                     {"--json", folder.path("out.json").string(), "--html", folder.path("out.html").string()});
    const app_tests::ProgramRun outcome = run_poise(arguments);
    ASSERT_LT(outcome.exit_code, 2) << outcome.err;
    check_page(keys, contents(folder.path("out.html")), Json::parse(contents(folder.path("out.json"))));
  }
  expect_all_written(keys, Shared::all);
}

}  // namespace
}  // namespace poise::docs_tests::json_test
