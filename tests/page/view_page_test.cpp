// `poise view` in a real browser: the program runs, the page is dragged, and what it shows is compared with the command
// line.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/view/view_session.hpp"
#include "model/input_error.hpp"
#include "model/scene.hpp"
#include "model/scene_text.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/page/hand.hpp"
#include "tests/page/recordings.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/seed.hpp"

extern char** environ;  // NOLINT(readability-identifier-naming): of POSIX

namespace poise::page_tests::view_page_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::ProgramRun;
using app_tests::run_poise;
using app_tests::TempFolder;
using nlohmann::json;
using test::Browser;

Browser& browser() { return Browser::shared(); }

/// `poise view` of a copy of a dataset, and its page in the browser.
class ViewPage : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = Browser::missing(); !why.empty()) GTEST_SKIP() << why;
    browser().emulate({});
  }

  void TearDown() override {
    if (!Browser::missing().empty()) return;
    // Otherwise the page would write to the console that the program has gone.
    browser().open("about:blank");
    end();
    browser().console();
  }

  void show(const std::string& name) {
    // Scenes of parts name files of this folder.
    const std::filesystem::path parts = std::filesystem::path(dataset(name)).parent_path() / "parts";
    if (!std::filesystem::exists(folder_.path("parts"))) std::filesystem::copy(parts, folder_.path("parts"));
    show_file(folder_.write(name + ".toml", contents(dataset(name))));
  }

  /// A file that is not there shows an empty sheet.
  void show_file(const std::string& file) {
    file_ = file;
    int ends[2];
    ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<std::string> words = {POISE_EXECUTABLE, "view", file_, "--no-browser"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ASSERT_EQ(::posix_spawn(&process_, POISE_EXECUTABLE, &actions, nullptr, arguments.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    std::string printed;
    char piece[256];
    while (printed.find("ends it") == std::string::npos) {
      const ssize_t got = ::read(ends[0], piece, sizeof piece);
      ASSERT_GT(got, 0) << printed;
      printed.append(piece, static_cast<std::size_t>(got));
    }
    ::close(ends[0]);
    const std::size_t at = printed.find("http://");
    address_ = printed.substr(at, printed.find('\n', at) - at);
    browser().open(address_);
    ASSERT_TRUE(browser().wait_for("document.body.dataset.revision !== undefined"));
    browser().console();
  }

  void end() {
    if (process_ == 0) return;
    ::kill(process_, SIGINT);
    int status = 0;
    ::waitpid(process_, &status, 0);
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    process_ = 0;
  }

  json ask(const json& request) {
    return json::parse(browser()
                           .run("const request = new XMLHttpRequest(); request.open('POST', 'do', false);"
                                "request.send(arguments[0]); return request.responseText",
                                {request.dump()})
                           .get<std::string>());
  }

  /// Where a place of the scene, in its unit, is in the window, px.
  std::pair<double, double> window_of(double x, double y) {
    const json place = browser().run(
        "const svg = document.querySelector('.live-picture svg.picture'), box = svg.getBoundingClientRect();"
        "const view = svg.viewBox.baseVal, scale = Math.min(box.width / view.width, box.height / view.height);"
        "const {origin, scale: unit} = arguments[0];"
        "const px = origin[0] + unit * arguments[1], py = origin[1] - unit * arguments[2];"
        "return [box.x + (box.width - scale * view.width) / 2 + scale * (px - view.x),"
        "        box.y + (box.height - scale * view.height) / 2 + scale * (py - view.y)]",
        {ask({{"do", "look"}})["sheet"], x, y});
    return {place[0], place[1]};
  }

  /// Clicks on a button of the toolbar, in the menu of its group.
  void choose(const std::string& tool) {
    browser().run("document.querySelector(`[data-tool='${arguments[0]}']`).click()", {tool});
    ++gestures_;
  }

  /// Clicks on a place of the scene.
  void click(double x, double y) {
    const auto [left, top] = window_of(x, y);
    browser().move(left, top);
    browser().press(left, top);
    browser().let_go();
    ++gestures_;
  }

  void key(const std::string& name) {
    browser().type({name});
    ++gestures_;
  }

  /// The button with these words.
  void press_button(const std::string& words) {
    EXPECT_TRUE(browser()
                    .run("const found = [...document.querySelectorAll('button')].find((one) => one.textContent.trim() "
                         "=== arguments[0]); found?.click(); return found !== undefined",
                         {words})
                    .get<bool>())
        << words;
  }

  /// A box that is dragged from one place of the scene to another.
  void drag_box(std::pair<double, double> from, std::pair<double, double> to) {
    const auto [left, top] = window_of(from.first, from.second);
    const auto [right, bottom] = window_of(to.first, to.second);
    browser().press(left, top);
    browser().move(0.5 * (left + right), 0.5 * (top + bottom));
    browser().move(right, bottom);
    browser().let_go();
  }

  std::string shown_text() { return ask({{"do", "look"}})["text"]; }

  std::vector<std::string> chosen() {
    return browser().run("return [...document.querySelectorAll('.item-row.marked')].map((row) => row.dataset.item)");
  }

  /// Types a place into the field for exact ones.
  void exactly(const std::string& text) {
    browser().run("document.querySelector('.draw-typed').focus()");
    std::vector<std::string> keys;
    for (const char letter : text) keys.emplace_back(1, letter);
    keys.emplace_back("Enter");
    browser().type(keys);
    ++gestures_;
  }

  /// Waits until a change is shown that was asked for after the one before.
  void drawn(int line = __builtin_LINE()) {
    EXPECT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(revision_), 20.0))
        << "line " << line << ": " << browser().run("return document.querySelector('.status').textContent");
    EXPECT_TRUE(browser().wait_for("!document.querySelector('.stage.moving')"));
    revision_ = revision();
  }

  /// Where a handle is in the window, px.
  std::pair<double, double> place_of(const std::string& kind, const std::string& name) {
    const json place = browser().run(
        "const one = document.querySelector(`[data-handle=\"${arguments[0]}\"][data-name=\"${arguments[1]}\"]`);"
        "const box = one.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]",
        {kind, name});
    return {place[0].get<double>(), place[1].get<double>()};
  }

  long revision() { return std::stol(browser().run("return document.body.dataset.revision").get<std::string>()); }

  void expect_silence() {
    for (const std::string& line : browser().console()) ADD_FAILURE() << line;
  }

  /// The equilibrium that the command line finds in a text.
  json found_by_command_line(const std::string& text, const std::vector<std::string>& options) {
    std::vector<std::string> command = {"solve", folder_.write("shown.toml", text), "--json",
                                        folder_.path("shown.json").string()};
    command.insert(command.end(), options.begin(), options.end());
    const ProgramRun ran = run_poise(command);
    EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
    return json::parse(contents(folder_.path("shown.json")));
  }

  TempFolder folder_;
  std::string file_, address_;
  int gestures_ = 0;
  long revision_ = 1;
  pid_t process_ = 0;
  int exit_code_ = -1;
};

/// The angles of bodies and travels of joints that a state shows.
std::map<std::string, double> shown_in(const json& state) { return state["position"]; }

/// The largest difference of a start and angles that the command line finds, in the scene's unit.
double farthest(const std::map<std::string, double>& start, const json& angles) {
  double out = 0.0;
  for (const auto& [name, angle] : start) {
    if (angles.contains(name)) out = std::max(out, std::abs(angles[name].get<double>() - angle));
  }
  return out;
}

TEST_F(ViewPage, JointDraggedAlongACircleIsWhereTheCommandLineFindsIt) {
  show("four_bar_gravity");
  const auto [x, y] = place_of("point", "crank.B");
  const auto [ax, ay] = place_of("ground", "A");
  browser().press(x, y);
  for (int k = 1; k <= 25; ++k) {
    const double turn = 0.03 * k;
    const long before = revision();
    browser().move(ax + (x - ax) * std::cos(turn) - (y - ay) * std::sin(turn),
                   ay + (x - ax) * std::sin(turn) + (y - ay) * std::cos(turn));
    ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(before)));
    EXPECT_EQ(browser().run("return document.body.dataset.confirmed"), "true");
    const json whole = ask({{"do", "look"}});
    const std::string text = whole["text"];
    const json found =
        found_by_command_line(text + whole["hand"]["stops"].get<std::string>(), {"--seek", "any"})["angles"];
    for (const auto& [body, angle] : shown_in(whole)) {
      EXPECT_NEAR(found[body].get<double>(), angle, 1e-9) << body;
    }
  }
  const long held = revision();
  browser().let_go();
  ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(held)));
  EXPECT_EQ(browser().run("return document.body.dataset.kind"), "settled");
  const json whole = ask({{"do", "look"}});
  const json found = found_by_command_line(whole["text"], {})["angles"];
  for (const auto& [body, angle] : shown_in(whole)) EXPECT_NEAR(found[body].get<double>(), angle, 1e-9) << body;
  expect_silence();
  const json times = browser().run("return window.poiseTimes");
  std::vector<double> total, server;
  for (const json& time : times) {
    total.push_back(time["total"]);
    server.push_back(time["server"]);
  }
  std::sort(total.begin(), total.end());
  std::sort(server.begin(), server.end());
  ASSERT_FALSE(total.empty());
  std::printf("drag event to picture: median %.1f ms, program %.2f ms\n", total[total.size() / 2],
              server[server.size() / 2]);
}

/// Whatever is dragged anywhere: every request is answered, and the page shows the answer.
class RandomDrags : public ViewPage, public testing::WithParamInterface<std::string> {};

/// Names of the datasets that are scenes.
std::vector<std::string> scenes() {
  std::vector<std::string> out;
  for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(dataset("zeeman")).parent_path())) {
    if (file.path().extension() != ".toml") continue;
    try {
      read_scene(file.path());
      out.push_back(file.path().stem().string());
    } catch (const InputError&) {
      // An experiment, a design or tolerances.
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Has the page write down what the program answers and what it shows then, unless the next answer is there already.
const char* const recorder =
    "window.sent = window.answered = 0; window.seen = []; const send = XMLHttpRequest.prototype.send;"
    "const shown = (answer) => ({revision: document.body.dataset.revision === String(answer.revision),"
    "  confirmed: document.body.dataset.confirmed === String(answer.drawing.confirmed?.at(-1) ?? true),"
    "  verdict: document.querySelector('.live-verdict').innerText.includes(answer.verdict.text),"
    "  hand: document.querySelector('.hand').textContent === (answer.hand?.text ?? '')});"
    "XMLHttpRequest.prototype.send = function (body) { ++window.sent;"
    "  this.addEventListener('load', () => { const number = ++window.answered; setTimeout(() => {"
    "    const answer = JSON.parse(this.responseText), compares = !answer.error && number === window.answered;"
    "    window.seen.push({error: answer.error?.text ?? '', is: compares ? shown(answer) : {}, request: body}); }); });"
    "  return send.call(this, body); }";
/// Waits until nothing has been sent for a while that is not answered, and returns what was written down since.
const char* const recorded =
    "return new Promise(done => { const end = performance.now() + 25000; let calm = 0, last = -1;"
    "const look = () => { calm = window.sent === last && window.seen.length === last ? calm + 1 : 0; last = "
    "window.sent;"
    "  if (calm < 4 && performance.now() < end) { setTimeout(look, 5); return; }"
    "  done({sent: window.sent, seen: window.seen}); window.sent = 0; window.seen = []; }; look(); })";

TEST_P(RandomDrags, AreAnsweredAndShown) {
  constexpr int moves = 10, drags_between_solutions = 2;
  const int drags = test::cases(2, 20);
  // Without motions, for which the next move would have to wait.
  browser().emulate({.width = 700, .height = 600, .less_motion = true});
  show(GetParam());
  browser().run(recorder);
  const std::vector<double> area = browser().run(
      "const box = document.querySelector('.stage').getBoundingClientRect();"
      "return [box.x, box.y, box.x + box.width, Math.min(innerHeight, box.y + box.height)]");
  std::mt19937_64 random(test::seed(std::hash<std::string>{}(GetParam())));
  const auto within = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11U) / 9007199254740992.0);
  };
  int answers = 0, compared = 0;
  for (int drag = 1; drag <= drags; ++drag) {
    // Those that a press there takes hold of.
    const std::vector<std::string> points = browser().run(
        "return [...document.querySelectorAll('[data-handle=point]')].filter(one => {"
        "  const box = one.getBoundingClientRect();"
        "  return document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2) === one;"
        "}).map(one => one.dataset.name)");
    ASSERT_FALSE(points.empty()) << "drag " << drag;
    const std::string& point = points[random() % points.size()];
    auto [x, y] = place_of("point", point);
    browser().press(x, y);
    for (int move = 0; move < moves; ++move) {
      const auto [from_x, from_y] = std::pair(x, y);
      do {
        const double turn = within(0.0, 6.28), far = within(5.0, 60.0);
        x = from_x + far * std::cos(turn);
        y = from_y + far * std::sin(turn);
      } while (x < area[0] || y < area[1] || x > area[2] || y > area[3]);
      browser().move(x, y);
    }
    // The spring leaves the rocker of this four-bar in a dead centre, where it cannot be turned.
    const std::string standing = GetParam() == "torque_profile" ? point + " cannot move" : "";
    const auto expect_shown = [&](const json& record) {
      EXPECT_GT(record["sent"], 0) << "drag " << drag << " of " << point;
      EXPECT_EQ(record["sent"], record["seen"].size()) << "drag " << drag << " of " << point << " is not answered";
      for (const json& answer : record["seen"]) {
        EXPECT_TRUE(answer["error"] == "" || answer["error"] == standing)
            << answer["error"] << " in drag " << drag << ": " << answer["request"];
        for (const auto& [what, is] : answer["is"].items()) {
          EXPECT_EQ(is, true) << what << " after drag " << drag << ": " << answer["request"];
        }
        ++answers;
      }
    };
    expect_shown(browser().run(recorded));
    if (drag % drags_between_solutions == 0 && browser().run("return document.body.dataset.confirmed") == "true") {
      const json whole = ask({{"do", "look"}});
      const std::string text = whole["text"];
      // Nothing holds what cannot move.
      if (!standing.empty() && whole["hand"].is_null()) {
        browser().let_go();
        continue;
      }
      const std::string held = text + whole["hand"]["stops"].get<std::string>();
      const std::map<std::string, double> start = shown_in(whole);
      // Next to a dead centre Newton's method may go elsewhere from rounding: released there it stays.
      const json found = found_by_command_line(held, {"--seek", "any"});
      // Where the hand has pulled a chain straight, rounding of its place moves angles by far more.
      const json& rounding = found["certificate"]["rounding_effect"];
      // Where joints repeat each other at the place alone, the closures tell it to the root of rounding.
      const double closed_to = found["certificate"]["outcome"] == "degenerate" ? 1e-6 : 1e-9;
      const double within_rounding = std::max(closed_to, rounding.is_number() ? rounding.get<double>() : 0.0);
      const double nearest = farthest(start, found["angles"]);
      const double off = nearest < within_rounding
                             ? nearest
                             : std::min(nearest, farthest(start, found_by_command_line(held, {})["angles"]));
      EXPECT_LT(off, within_rounding) << "drag " << drag << " of " << point << ": " << held;
      ++compared;
      browser().run(recorded);
    }
    browser().let_go();
    expect_shown(browser().run(recorded));
  }
  expect_silence();
  std::printf("%-28s %d moves, %d answers, %d equilibria compared with the command line\n", GetParam().c_str(),
              drags * moves, answers, compared);
}

/// All of them in a round of a campaign, in `make test` some that the seed chooses: a page takes a second to load.
std::vector<std::string> dragged_scenes() {
  std::vector<std::string> out = scenes();
  const auto count = static_cast<std::size_t>(test::cases(14, static_cast<int>(out.size())));
  std::shuffle(out.begin(), out.end(), std::mt19937_64(test::seed(47)));
  out.resize(std::min(count, out.size()));
  return out;
}

INSTANTIATE_TEST_SUITE_P(Datasets, RandomDrags, testing::ValuesIn(dragged_scenes()),
                         [](const auto& of) { return of.param; });

TEST_F(ViewPage, FitsATelephoneAndTheKeyboard) {
  browser().emulate({.width = 400, .height = 800, .dark = true});
  show("toggle_clamp");
  EXPECT_EQ(browser().run("return document.documentElement.dataset.theme"), "dark");
  EXPECT_LE(browser().run("return document.documentElement.scrollWidth - innerWidth"), 0) << "wider than the window";
  for (const char* panel : {"switches", "items", "forces", "others", "run", "text", "numbers"}) {
    if (std::string(panel) == "text") browser().wait_for("document.querySelector('.run form')");
    browser().run("document.querySelector('[role=tab][aria-selected=true]').focus()");
    browser().type({"ArrowRight"});
    EXPECT_EQ(browser().run("return document.activeElement.id"), std::string("tab-") + panel);
    EXPECT_LE(browser().run("return document.documentElement.scrollWidth - innerWidth"), 0) << panel;
    EXPECT_EQ(browser().missed_by_tab(), std::vector<std::string>()) << panel;
  }
  // Arrow keys drag a point, and Enter lets it go.
  browser().run("document.querySelector('[data-handle=point][data-name=\"handle.grip\"]').focus()");
  browser().type({"ArrowUp", "ArrowUp", "ArrowLeft"});
  EXPECT_TRUE(browser().wait_for("document.querySelector('.hand').textContent.startsWith('held at handle.grip with')"));
  EXPECT_EQ(browser().run("return document.body.dataset.confirmed"), "true");
  browser().type({"Enter"});
  EXPECT_TRUE(browser().wait_for("document.querySelector('.hand').textContent === ''"));
  expect_silence();
}

TEST_F(ViewPage, SheetAndSlidersAreSeenTogetherOnATelephone) {
  browser().emulate({.width = 400, .height = 800});
  show("toggle_clamp");
  const json seen = browser().run(
      "document.querySelectorAll('.number')[2].scrollIntoView({block: 'end'});"
      "const stage = document.querySelector('.live-picture .stage').getBoundingClientRect();"
      "const rows = [...document.querySelectorAll('.number input[type=range]')].map((one) => "
      "one.getBoundingClientRect());"
      "return {top: stage.top, bottom: stage.bottom,"
      "        sliders: rows.filter((box) => box.top > stage.bottom && box.bottom <= innerHeight).length}");
  EXPECT_GE(seen["top"], -1.0);
  EXPECT_LT(seen["bottom"], 400.0);
  EXPECT_GE(seen["sliders"], 3);
}

TEST_F(ViewPage, SnapAtAFoldIsPlayed) {
  show("toggle_clamp");
  // Pictures that are shown on the way carry their caption.
  browser().run(
      "window.captions = []; new MutationObserver(() => window.captions.push(document.body.innerText.match(/moving: "
      ".*/)?.[0]))"
      ".observe(document.body, {subtree: true, childList: true, characterData: true});");
  browser().run(
      "const field = document.querySelector('[data-number=\"load.P\"] input[type=number]');"
      "field.value = 40; field.dispatchEvent(new Event('input', {bubbles: true}));"
      "field.dispatchEvent(new Event('change', {bubbles: true}));");
  ASSERT_TRUE(browser().wait_for("document.body.dataset.kind === 'snapped'"));
  ASSERT_TRUE(browser().wait_for("document.body.dataset.confirmed === 'true'"));
  EXPECT_TRUE(browser().run("return window.captions.some(text => text !== undefined)").get<bool>());
  expect_silence();
}

// The four-bar of README.md by mouse, from an empty sheet: forty gestures are three minutes for a beginner.
// Its fixed point is dragged: the field shows where it is before it is let go, and undo is told once.
TEST_F(ViewPage, FieldsFollowAndUndoIsToldOnce) {
  show("toggle_clamp");
  const std::string field = "document.querySelector('[data-number=\"point.ground.W.x\"] input[type=number]').value";
  const json at = browser().run(
      "const box = document.querySelector('[data-handle=ground][data-name=W]').getBoundingClientRect();"
      "return [box.x + box.width / 2, box.y + box.height / 2]");
  ASSERT_EQ(browser().run("return " + field), "86");
  browser().press(at[0], at[1]);
  for (int k = 1; k <= 6; ++k) browser().move(at[0].get<double>() + 2.0 * k, at[1]);
  EXPECT_TRUE(browser().wait_for("Number(" + field + ") > 86.5", 5.0)) << browser().run("return " + field);
  browser().let_go();
  ASSERT_TRUE(
      browser().wait_for("[...document.querySelectorAll('button')].some("
                         "(one) => one.textContent === 'Undo' && !one.disabled)"));
  browser().run("[...document.querySelectorAll('button')].find((one) => one.textContent === 'Undo').click()");
  ASSERT_TRUE(browser().wait_for("document.querySelector('.status').textContent.includes('Undone')"));
  EXPECT_EQ(browser().run("return document.querySelector('.status').textContent.match(/Undone/g).length"), 1);
  EXPECT_TRUE(browser().wait_for(field + " === '86'"));
  expect_silence();
}

TEST_F(ViewPage, TheFourBarOfTheReadmeIsDrawnByMouse) {
  show_file(folder_.path("drawn.toml"));
  EXPECT_TRUE(browser().wait_for("document.body.innerText.includes('no link is drawn yet')"));
  choose("ground_point");
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{{0, 0}, {300, 0}}) {
    click(x, y);
    drawn();
  }
  exactly("0, 250");
  drawn();
  choose("link");
  click(0, 0);
  exactly("100 < 60");
  key("Enter");
  drawn();
  click(50, 86.6);
  click(300, 200);
  key("Enter");
  drawn();
  click(300, 0);
  click(300, 200);
  key("Enter");
  drawn();
  choose("spring");
  click(0, 250);
  click(50, 86.6);
  drawn();
  choose("force");
  const auto place = [&](const std::string& name) {
    const json sheet = ask({{"do", "look"}})["sheet"];
    for (const json& one : sheet["points"]) {
      if (one["name"] == name) return std::pair<double, double>(one["at"][0], one["at"][1]);
    }
    throw std::runtime_error("no point " + name);
  };
  const auto click_on_coupler = [&](double share) {
    const auto [from_x, from_y] = place("link_2.D");
    const auto [to_x, to_y] = place("link_2.E");
    click(from_x + share * (to_x - from_x), from_y + share * (to_y - from_y));
    drawn();
  };
  click_on_coupler(0.5);
  choose("mass");
  click_on_coupler(0.7);
  key("Escape");
  // Lengths, the place of the load and the spring are typed: one gesture each. The centre of the mass follows the
  // points.
  for (const auto& [path, value] : std::vector<std::pair<std::string, double>>{{"point.link_2.E.x", 280},
                                                                               {"point.link_3.E.x", 220},
                                                                               {"point.link_2.F.x", 140},
                                                                               {"point.link_2.F.y", 60},
                                                                               {"spring.spring 1.stiffness", 5},
                                                                               {"spring.spring 1.free_length", 100},
                                                                               {"load.force 1", 200},
                                                                               {"body.link_2.mass", 1.2}}) {
    browser().run(
        "const field = document.querySelector(`[data-number='${arguments[0]}'] input[type=number]`);"
        "field.value = arguments[1]; field.dispatchEvent(new Event('change', {bubbles: true}));",
        {path, value});
    ++gestures_;
    SCOPED_TRACE(path);
    drawn();
  }
  EXPECT_LE(gestures_, 40);
  const json state = ask({{"do", "look"}});
  EXPECT_EQ(state["verdict"]["text"], "In equilibrium, proved: stable.");
  const std::string readme = contents(std::string(POISE_SOURCE_DIR) + "/README.md");
  const std::size_t begin = readme.find("title = \"My four-bar\"");
  const json drawn_found = found_by_command_line(state["text"], {});
  const json readme_found = found_by_command_line(readme.substr(begin, readme.find("```", begin) - begin), {});
  const std::map<std::string, std::string> names{{"crank", "link_1"}, {"coupler", "link_2"}, {"rocker", "link_3"}};
  for (const auto& [theirs, ours] : names) {
    EXPECT_NEAR(drawn_found["angles"][ours].get<double>(), readme_found["angles"][theirs].get<double>(), 1e-9)
        << theirs;
  }
  std::printf("%d gestures\n", gestures_);
  expect_silence();
}

// Where each tool of the toolbar is clicked on the slider-crank; after the last place of some Enter is pressed.
TEST_F(ViewPage, EveryToolDrawsByMouse) {
  using Places = std::vector<std::pair<double, double>>;
  const std::pair<double, double> on_crank{25, 43.3}, on_rod{95, 64.95}, knee{50, 86.6}, fixed{0, 200},
      nowhere{40, 150}, block{270.28, 0}, pivot{300, 0}, slide{230.28, 0};
  const Places point_to_point{fixed, knee}, two_links{on_crank, on_rod}, along{block, pivot};
  const std::map<std::string, Places> clicks = {{"ground_point", {{60, 180}}},
                                                {"link", {{60, 150}, {120, 150}}},
                                                {"point", {on_crank}},
                                                {"mass", {on_crank}},
                                                {"plate", {on_rod}},
                                                {"pin", {on_rod}},
                                                {"slide", along},
                                                {"pin_in_slot", along},
                                                {"weld", {on_rod}},
                                                {"bar", point_to_point},
                                                {"spring", point_to_point},
                                                {"torsion_spring", two_links},
                                                {"gas_strut", point_to_point},
                                                {"constant_force", point_to_point},
                                                {"cubic_spring", point_to_point},
                                                {"bump_stop", point_to_point},
                                                {"damper", point_to_point},
                                                {"torsion_damper", two_links},
                                                {"motor", {nowhere, on_crank}},
                                                {"controller", {nowhere, on_crank}},
                                                {"friction", two_links},
                                                {"force", {block}},
                                                {"distributed_load", {knee, {185, 22}}},
                                                {"torque", {on_crank}},
                                                {"drive", {on_crank, nowhere}},
                                                {"stop", {on_crank, nowhere}},
                                                {"blade", {block}},
                                                {"rope", point_to_point},
                                                {"contact", {block, {260, 60}, {300, 60}}},
                                                {"loose_pin", {on_rod}},
                                                {"loose_slot", along},
                                                {"gear", two_links},
                                                {"geneva", two_links},
                                                {"rack", {on_crank, slide}},
                                                {"cam", {on_crank, slide}},
                                                {"belt", two_links},
                                                {"coupling", {nowhere, on_crank, nowhere, on_rod}},
                                                {"chain", {fixed, knee}},
                                                {"circular_slot", {block, pivot}},
                                                {"curved_slot", {block, pivot}},
                                                {"rolling_profile", along},
                                                {"rolling_profile_on_circle", {block, pivot}},
                                                {"curve_contact", {block, pivot}},
                                                {"rolling", along},
                                                {"rolling_on_circle", {block, pivot}}};
  const std::set<std::string> of_the_page{"", "select", "move_point"};
  show_file(folder_.write("slider_crank.toml", app_tests::slider_crank));
  const std::string before = shown_text();
  const std::vector<std::string> tools =
      browser().run("return [...document.querySelectorAll('[data-tool]')].map((one) => one.dataset.tool)");
  EXPECT_GE(tools.size(), clicks.size());
  for (const std::string& tool : tools) {
    if (of_the_page.contains(tool)) continue;
    SCOPED_TRACE(tool);
    const auto row = clicks.find(tool);
    ASSERT_NE(row, clicks.end()) << "has no row in the table of this test";
    choose(tool);
    for (const auto& [x, y] : row->second) click(x, y);
    if (tool == "link" || tool == "rope" || tool == "contact") key("Enter");
    drawn();
    EXPECT_FALSE(browser().run("return document.querySelector('.draw-hint').classList.contains('refused')").get<bool>())
        << browser().run("return document.querySelector('.draw-hint').textContent");
    const json state = ask({{"do", "look"}});
    const std::string text = state["text"];
    EXPECT_NE(text, before);
    EXPECT_EQ(browser().run("return document.querySelector('textarea').value"), text);
    // The page lists the items that the text has, and has their points at the same places.
    const SceneText written(text, "drawn.toml");
    std::vector<std::string> items;
    for (const SceneItem& item : written.items()) {
      if (item.owner != Owner::body || item.index > 0) items.push_back(item.name);
    }
    EXPECT_EQ(browser()
                  .run("return [...document.querySelectorAll('.item-row')].map((row) => row.dataset.item)")
                  .get<std::vector<std::string>>(),
              items);
    std::set<std::string> shown, points;
    for (const json& point : state["sheet"]["points"]) shown.insert(point["name"].get<std::string>());
    for (const Body& body : written.scene().bodies) {
      for (const NamedPoint& point : body.points) points.insert(body.name + "." + point.name);
    }
    EXPECT_EQ(shown, points);
    key("Escape");
    browser().chord("Control", "z");
    drawn();
    EXPECT_EQ(shown_text(), before);
    expect_silence();
  }
}

// A box is dragged over all links; they are copied to a place, mirrored, repeated, grouped, moved and taken away.
TEST_F(ViewPage, ChosenItemsAreCopiedByMouse) {
  show_file(folder_.write("slider_crank.toml", app_tests::slider_crank));
  const std::string before = shown_text();
  const auto undo = [&] {
    browser().chord("Control", "z");
    drawn();
    EXPECT_EQ(shown_text(), before);
  };
  const auto choose_all = [&] {
    choose("select");
    drag_box({-12, -12}, {296, 110});
  };
  choose_all();
  EXPECT_EQ(chosen(), (std::vector<std::string>{"ground.A", "crank", "rod", "block"}));
  press_button("Copy");
  click(100, 150);
  drawn();
  EXPECT_NE(shown_text().find("[body.crank_2]"), std::string::npos);
  const std::vector<std::string> made = chosen();
  EXPECT_TRUE(std::find(made.begin(), made.end(), "rod_2") != made.end());
  EXPECT_EQ(std::find(made.begin(), made.end(), "rod"), made.end());
  undo();
  // Ctrl+C and Ctrl+V, and a typed place.
  choose_all();
  browser().chord("Control", "c");
  browser().chord("Control", "v");
  exactly("0, 150");
  drawn();
  EXPECT_NE(shown_text().find("[body.block_2]"), std::string::npos);
  undo();
  choose_all();
  press_button("About a vertical line");
  exactly("150, 50");
  drawn();
  const json mirrored = ask({{"do", "look"}});
  for (const json& point : mirrored["sheet"]["points"]) {
    if (point["name"] != "block_2.C") continue;
    EXPECT_NEAR(point["at"][0].get<double>(), 300 - 230.28, 0.01);
    EXPECT_NEAR(point["at"][1].get<double>(), 0.0, 0.01);
  }
  EXPECT_NE(mirrored["text"].get<std::string>().find("[body.block_2]"), std::string::npos);
  undo();
  choose_all();
  browser().run(
      "const fields = document.querySelectorAll('.draw-selection input');"
      "fields[0].value = 3; fields[1].value = 400;");
  press_button("Make");
  drawn();
  EXPECT_NE(shown_text().find("[body.crank_4]"), std::string::npos);
  undo();
  choose_all();
  press_button("Move items");
  exactly("20, 30");
  drawn();
  EXPECT_NE(shown_text().find("A = [20, 30]"), std::string::npos) << shown_text();
  undo();
  // A group is a part of its own file, and chosen as a whole.
  choose("select");
  click(25, 43.3);
  EXPECT_EQ(chosen(), std::vector<std::string>{"crank"});
  browser().run("document.querySelector('.draw-selection input[placeholder=\"part_1\"]').value = 'arm';");
  press_button("Make a part");
  drawn();
  EXPECT_NE(shown_text().find("file = \"arm.toml\""), std::string::npos) << shown_text();
  EXPECT_NE(contents(folder_.path("arm.toml")).find("[body."), std::string::npos);
  EXPECT_EQ(chosen(), std::vector<std::string>{"part arm"});
  press_button("None");
  click(25, 43.3);
  EXPECT_EQ(chosen(), std::vector<std::string>{"part arm"});
  press_button("Ungroup");
  drawn();
  EXPECT_NE(shown_text().find("[body.crank]"), std::string::npos) << shown_text();
  EXPECT_EQ(shown_text().find("[[part]]"), std::string::npos) << shown_text();
  browser().chord("Control", "z");
  drawn();
  undo();
  choose_all();
  key("Delete");
  drawn();
  EXPECT_EQ(shown_text().find("[body."), std::string::npos);
  undo();
  expect_silence();
}

// Files of what is shown: the page hands them to the browser as blobs.
TEST_F(ViewPage, PicturesAndFilms) {
  show("toggle_clamp");
  keep_files(browser());
  press_button("Picture (PNG)");
  wait_for_file(browser(), 1);
  expect_png(browser(), ".live-picture svg.picture");
  press_button("Picture (SVG)");
  const std::string svg = browser().run("return window.blobs[1].text()");
  EXPECT_TRUE(svg.starts_with("<svg")) << svg.substr(0, 100);
  EXPECT_EQ(svg.find("var("), std::string::npos) << "a file has no variables of the page";
  press_button("Record");
  ASSERT_TRUE(browser().wait_for("document.querySelector('.recording') !== null"));
  const auto [x, y] = place_of("point", "handle.grip");
  browser().press(x, y);
  for (int k = 1; k <= 10; ++k) browser().move(x + 6.0 * k, y - 8.0 * k);
  browser().let_go();
  press_button("Stop recording");
  wait_for_file(browser(), 3);
  expect_film(browser());
  expect_silence();
}

// A session of another program holds the file as this one does, for as long as it runs.
TEST_F(ViewPage, AnotherProgramWithTheFileIsToldOf) {
  show("toggle_clamp");
  const std::string bar =
      "[...document.querySelectorAll('.bar-over p')].some((p) => p.textContent.includes("
      "'Another poise view shows this file'))";
  EXPECT_FALSE(browser().run("return " + bar));
  {
    const app::ViewSession other(file_);
    EXPECT_TRUE(browser().wait_for(bar, 20));
  }
  EXPECT_TRUE(browser().wait_for("!" + bar, 20)) << "it has gone";
  const app::ViewSession again(file_);
  EXPECT_TRUE(browser().wait_for(bar, 20));
  press_button("Close");
  EXPECT_FALSE(browser().run("return " + bar));
  // The mechanism can be used all the while.
  ASSERT_FALSE(ask({{"do", "set"}, {"path", "load.P"}, {"value", 10}, {"revision", revision()}}).contains("error"));
  expect_silence();
}

// All tabs of the panels are on one row; on a telephone it scrolls, to the tab that is chosen too.
TEST_F(ViewPage, TabsAreOneRow) {
  const std::string boxes =
      "const list = document.querySelector('.tabs'), whole = list.getBoundingClientRect();"
      "return {left: whole.left, right: whole.right, scrolls: list.scrollWidth - list.clientWidth,"
      "  wide: document.documentElement.scrollWidth - innerWidth,"
      "  tabs: [...list.children].map((tab) => { const box = tab.getBoundingClientRect();"
      "    return {name: tab.id, top: box.top, left: box.left, right: box.right, height: box.height}; })}";
  for (const int width : {1280, 400}) {
    SCOPED_TRACE(width);
    browser().emulate({.width = width, .height = 900});
    show("toggle_clamp");
    // With the number of other equilibria, as it is once they are known.
    ASSERT_TRUE(browser().wait_for("/\\d/.test(document.querySelector('#tab-others').textContent)", 20));
    json seen = browser().run(boxes);
    ASSERT_EQ(seen["tabs"].size(), 7U);
    for (const json& tab : seen["tabs"]) {
      EXPECT_EQ(tab["top"], seen["tabs"][0]["top"]) << tab;
      EXPECT_LT(tab["height"].get<double>(), 48.0) << "its words are on one line: " << tab;
      if (width == 1280) {
        EXPECT_LE(tab["right"].get<double>(), seen["right"].get<double>()) << tab;
      }
    }
    EXPECT_LE(seen["wide"], 0);
    for (const char* const name : {"text", "numbers"}) {
      browser().run("document.querySelector('#tab-' + arguments[0]).click()", {name});
      seen = browser().run(boxes);
      for (const json& tab : seen["tabs"]) {
        if (tab["name"] != std::string("tab-") + name) continue;
        EXPECT_GE(tab["left"].get<double>(), seen["left"].get<double>()) << tab;
        EXPECT_LE(tab["right"].get<double>(), seen["right"].get<double>() + 0.5) << tab;
      }
    }
    expect_silence();
    browser().open("about:blank");
    end();
    browser().console();
  }
}

TEST_F(ViewPage, BadTextShowsItsError) {
  show("toggle_clamp");
  const std::string bad = contents(dataset("toggle_clamp")) + "\n[[sprin]]\nname = \"x\"\n";
  browser().run(
      "const area = document.querySelector('textarea'); area.value = arguments[0];"
      "area.dispatchEvent(new Event('input', {bubbles: true}));",
      {bad});
  const auto line = std::count(bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(bad.find("[[sprin]]")), '\n') + 1;
  EXPECT_TRUE(browser().wait_for("document.body.innerText.includes('toggle_clamp.toml:" + std::to_string(line) + "')"));
  expect_silence();
}

// Each example, chosen in the menu or dropped onto the picture, becomes the scene that poise import makes of it, and
// one undo takes it back.
TEST_F(ViewPage, FilesOfOtherProgramsAreImportedAndExported) {
  show("toggle_clamp");
  const std::string before = ask({{"do", "look"}})["text"];
  const std::filesystem::path examples = std::filesystem::path(dataset("toggle_clamp")).parent_path() / "exchange";
  const auto take = [&](const std::string& name, const std::string& text, bool is_dropped) {
    browser().run(
        "const files = new DataTransfer(); files.items.add(new File([arguments[1]], arguments[0]));"
        "const input = document.querySelector('.import-file'), stage = document.querySelector('.live-picture .stage');"
        "if (arguments[2]) stage.dispatchEvent(new DragEvent('drop', {dataTransfer: files, bubbles: true, cancelable: "
        "true}));"
        "else { input.files = files.files; input.dispatchEvent(new Event('change')); }",
        {name, text, is_dropped});
  };
  bool is_dropped = false;
  for (const char* const name :
       {"four_bar.dxf", "four_bar.url", "four_bar.txt", "crank_slider.linkage2", "arm.urdf", "four_bar.xml"}) {
    SCOPED_TRACE(name);
    const long last = revision();
    take(name, contents(examples / name), is_dropped);
    is_dropped = !is_dropped;
    ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(last), 20.0))
        << browser().run("return document.querySelector('.status').textContent");
    const json state = ask({{"do", "look"}});
    const std::string file = folder_.path("taken.toml");
    ASSERT_EQ(run_poise({"import", (examples / name).string(), "--scene", file}).exit_code, 0);
    // The text shown has the position as its start besides.
    const std::string text = state["text"], made = contents(file);
    EXPECT_EQ(browser().run("return document.querySelector('[data-number=\"gravity.y\"] .unit').textContent"),
              text.find("length = \"mm\"") != std::string::npos   ? "mm/s²"
              : text.find("length = \"in\"") != std::string::npos ? "in/s²"
                                                                  : "m/s²");
    const std::string head = text.substr(0, text.find("\n[start]"));
    EXPECT_EQ(head, made.substr(0, head.size()));
    EXPECT_TRUE(made.size() == head.size() || made.substr(head.size()).starts_with("\n[start]")) << made;
    const std::string said = browser().run("return document.querySelector('.status').textContent").get<std::string>();
    EXPECT_TRUE(said.find("Imported. ") != std::string::npos) << said;
    EXPECT_TRUE(browser().wait_for("!document.querySelector('.stage.moving')"));
    const long imported = revision();
    browser().run("[...document.querySelectorAll('button')].find((one) => one.textContent === 'Undo').click()");
    ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(imported), 20.0));
    EXPECT_TRUE(browser().wait_for("!document.querySelector('.stage.moving')"));
    EXPECT_EQ(ask({{"do", "look"}})["text"], before);
  }
  const long last = revision();
  take("broken.dxf", "0\nSECTION\n2\nENTITIES\n0\nSPLINE\n8\narm\n0\nENDSEC\n0\nEOF\n", false);
  EXPECT_TRUE(
      browser().wait_for("document.querySelector('.status').textContent.includes('broken.dxf:6: SPLINE')", 20.0));
  EXPECT_EQ(revision(), last);
  EXPECT_EQ(ask({{"do", "look"}})["text"], before);
  const auto write = [&](const std::string& format) {
    browser().run("document.querySelector(`[data-format='${arguments[0]}']`).click()", {format});
  };
  browser().run(
      "window.taken = null; URL.createObjectURL = (blob) => { blob.text().then((text) => { window.taken = text; });"
      "return 'blob:none'; }; HTMLAnchorElement.prototype.click = () => {};");
  write("dxf");
  ASSERT_TRUE(browser().wait_for("window.taken !== null", 20.0));
  const std::string drawing = folder_.write("out.dxf", browser().run("return window.taken").get<std::string>());
  const ProgramRun back = run_poise({"import", drawing, "--scene", folder_.path("back.toml")});
  EXPECT_TRUE(back.out.find("Read: 3 moving bodies, 4 joints, 1 degree of freedom.") != std::string::npos)
      << back.out << back.err;
  write("pmks");
  EXPECT_TRUE(browser().wait_for("document.body.innerText.includes('The mechanism is an address of PMKS+.')", 20.0));
  write("mjcf");
  EXPECT_TRUE(browser().wait_for(
      "document.querySelector('.status').textContent.startsWith('Not exported: toggle_clamp.toml:')", 20.0));
  expect_silence();
}

TEST_F(ViewPage, FewOtherEquilibriaAreShownAtOnce) {
  show("thesis_chain");
  browser().run("document.getElementById('tab-others').click()");
  ASSERT_TRUE(browser().wait_for("document.querySelectorAll('.others .card').length === 6"));
  const std::string ghosts =
      "return [...document.querySelectorAll('.ghost')].filter((one) => getComputedStyle(one).display !== "
      "'none').length";
  EXPECT_EQ(browser().run(ghosts), 3);
  EXPECT_TRUE(browser().run("return document.querySelector('.others').innerText.includes('3 of 5 are shown')"));
  browser().run(
      "[...document.querySelectorAll('.others label')].find((one) => one.textContent === 'Show all 5').click()");
  EXPECT_EQ(browser().run(ghosts), 5);
  expect_silence();
}

TEST_F(ViewPage, EditsOnDiskAreShown) {
  show("four_bar_gravity");
  std::string text = contents(file_);
  const long before = revision();
  text.replace(text.find("gravity = [0, -"), 15, "gravity = [0, -2");
  std::ofstream(file_) << text;
  EXPECT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(before)));
  expect_silence();
}

/// The picture of README.md, with POISE_PICTURE=FILE; without it the page is looked at for what it shows.
TEST_F(ViewPage, Picture) {
  show("toggle_clamp");
  ASSERT_TRUE(browser().wait_for("document.body.textContent.includes('3 equilibria, complete, proved')"));
  const auto [x, y] = place_of("point", "handle.grip");
  browser().press(x, y);
  const long before = revision();
  for (int k = 1; k <= 10; ++k) browser().move(x + 6.0 * k, y - 8.0 * k);
  ASSERT_TRUE(browser().wait_for("Number(document.body.dataset.revision) > " + std::to_string(before)));
  EXPECT_TRUE(browser().wait_for("document.body.innerText.includes('held at handle.grip with')"));
  if (const char* file = std::getenv("POISE_PICTURE")) browser().picture(file);
  browser().let_go();
  expect_silence();
}

TEST_F(ViewPage, SaysThatTheProgramHasEnded) {
  show("four_bar_gravity");
  end();
  EXPECT_EQ(exit_code_, 0);
  EXPECT_TRUE(browser().wait_for("/program has ended/i.test(document.body.innerText)"));
}

/// Numbers of the page's result and of a file of --json at places in both.
void expect_equal_at(const json& page, const json& file, const std::vector<std::string>& places) {
  for (const std::string& place : places) {
    const json::json_pointer at(place);
    const double value = file.at(at);
    // A page has nine digits.
    EXPECT_NEAR(page.at(at).get<double>(), value, 1e-8 * std::abs(value)) << place;
  }
}

TEST_F(ViewPage, CommandsRunBesideTheDrawing) {
  show("toggle_clamp");
  browser().run("document.querySelector('#tab-run').click()");
  ASSERT_TRUE(browser().wait_for("document.querySelector('#run-command').value === 'path'"));
  const auto ran = [&](const std::string& command) {
    EXPECT_TRUE(browser().wait_for("document.querySelector('.run-result h3')?.textContent === 'Result of " + command +
                                   "' && document.querySelector('.run').dataset.state === 'done'"));
    return ask({{"do", "result"}})["run"];
  };
  // Filled in by the page: the load of the scene over a range about its value.
  EXPECT_EQ(browser().run("return document.querySelector('[data-option=\"--vary\"] input').value"), "load.P=0..50");
  browser().run("document.querySelector('[data-option=\"--vary\"] input').value = 'load.P=0..60'");
  browser().run("document.querySelector('.run-start').click()");
  const json path = ran("path");
  EXPECT_EQ(path["line"], "poise path " + file_ + " --vary load.P=0..60");
  const std::string out = folder_.path("out.json").string();
  EXPECT_EQ(run_poise({"path", file_, "--vary", "load.P=0..60", "--json", out}).exit_code,
            path["page"]["verdict"]["tone"] == "good" ? 0 : 1);
  const json of_path = json::parse(contents(out));
  ASSERT_EQ(path["page"]["result"]["points"].size(), of_path["points"].size());
  std::vector<std::string> places;
  for (std::size_t k = 0; k < of_path["points"].size(); ++k)
    places.push_back("/points/" + std::to_string(k) + "/angles/handle");
  for (std::size_t k = 0; k < of_path["events"].size(); ++k)
    places.push_back("/events/" + std::to_string(k) + "/parameter");
  expect_equal_at(path["page"]["result"], of_path, places);
  EXPECT_EQ(browser().run("return document.querySelector('.run-result .verdict > span:last-child').textContent"),
            path["page"]["verdict"]["text"]);
  EXPECT_EQ(browser().run("return document.querySelectorAll('.run-result .chart').length > 0"), true);

  browser().run(
      "const choice = document.querySelector('#run-command'); choice.value = 'equilibria';"
      "choice.dispatchEvent(new Event('change')); document.querySelector('.run-start').click()");
  const json set = ran("equilibria");
  run_poise({"equilibria", file_, "--json", out});
  const json of_set = json::parse(contents(out));
  ASSERT_EQ(set["page"]["result"]["equilibria"].size(), 3U);
  expect_equal_at(set["page"]["result"], of_set,
                  {"/equilibria/0/angles/handle", "/equilibria/1/angles/handle", "/equilibria/2/angles/handle",
                   "/equilibria/0/energy", "/equilibria/1/energy", "/equilibria/2/energy"});

  EXPECT_EQ(browser().run("return document.querySelector('.run-stale').hidden"), true);
  browser().run(
      "const field = document.querySelector('[data-number=\"load.P\"] input[type=number]');"
      "field.value = 30; field.dispatchEvent(new Event('change', {bubbles: true}));");
  EXPECT_TRUE(browser().wait_for("!document.querySelector('.run-stale').hidden"));
  browser().run("document.querySelector('.run-stale button').click()");
  EXPECT_TRUE(browser().wait_for("document.querySelector('.run-stale').hidden"));
  EXPECT_EQ(ran("equilibria")["text"], ask({{"do", "look"}})["text"]);

  // What is wrong is said in one line, and nothing else is lost.
  browser().run(
      "const choice = document.querySelector('#run-command'); choice.value = 'path';"
      "choice.dispatchEvent(new Event('change'));"
      "document.querySelector('[data-option=\"--vary\"] input').value = 'load.Q=0..60';"
      "document.querySelector('.run-start').click()");
  EXPECT_TRUE(browser().wait_for("!document.querySelector('.run > .text-error').hidden"));
  EXPECT_EQ(browser().run("return document.querySelector('.run > .text-error').textContent").get<std::string>() + "\n",
            run_poise({"path", file_, "--vary", "load.Q=0..60"}).err);
  expect_silence();
}

TEST_F(ViewPage, EveryTemplateOpensWhereTheCommandLineFindsIt) {
  // Narrow, so that texts are enlarged and those that overlap left out, of one drawing after the other.
  browser().emulate({.width = 400, .height = 800, .less_motion = true});
  show_file(folder_.path("drawn.toml"));
  // An empty sheet offers them.
  browser().run("document.querySelector('.begin button').click()");
  ASSERT_TRUE(browser().wait_for("document.querySelectorAll('.templates [data-template] svg').length >= 14"));
  const std::vector<std::string> names =
      browser().run("return [...document.querySelectorAll('[data-template]')].map(one => one.dataset.template)");
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    browser().run("document.querySelector(`[data-template='${arguments[0]}']`).click()", {name});
    drawn();
    EXPECT_EQ(browser().run("return document.querySelector('.templates').open"), false);
    const json whole = ask({{"do", "look"}});
    EXPECT_EQ(browser().run("return document.querySelector('h1').textContent"), whole["title"]);
    EXPECT_EQ(browser().run("return document.body.dataset.confirmed"), "true");
    const json found =
        found_by_command_line(browser().run("const request = new XMLHttpRequest(); request.open('POST', 'do', false);"
                                            "request.send(JSON.stringify({do: 'templates', name: arguments[0]}));"
                                            "return JSON.parse(request.responseText).text",
                                            {name}),
                              {});
    EXPECT_LT(farthest(shown_in(whole), found["angles"]), 1e-9);
    EXPECT_LT(farthest(shown_in(whole), found["slides"]), 1e-9);
    expect_silence();
  }
  browser().run("document.querySelector('.page-buttons button').click()");
  drawn();
  EXPECT_NE(ask({{"do", "look"}})["title"], "Landing gear, down and locked") << "undo takes a template back";
}

}  // namespace
}  // namespace poise::page_tests::view_page_test
