// Time from an event of the pointer in a live page (`poise view`) to the frame of the browser that shows its
// equilibrium: points are dragged, and sliders of numbers moved. The browser measures; a frame is painted at most
// every 16.7 ms, so that an answer without delay takes 8 ms on average.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/view/background_view.hpp"
#include "model/scene_text.hpp"
#include "model/text_file.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/hanging_chain.hpp"

namespace {

using nlohmann::json;
using poise::test::Browser;
using poise::test::hanging_chain;

constexpr int moves = 40;               // of a drag, and of a slider
constexpr std::size_t most_points = 8;  // that are dragged, of one mechanism

/// Fifty levers, each with its pin, spring and load.
std::string fifty_levers() {
  constexpr int levers = 50;
  std::string points, items, start = "[start]\n";
  for (int k = 0; k < levers; ++k) {
    points += fmt::format("A{} = [{}, 0]\nG{} = [{}, -150]\n", k, 60 * k, k, 60 * k + 30);
    items += fmt::format(
        "[body.l{0}]\npoints = {{ a = [0, 0], b = [100, 0] }}\nmass = 1\ncenter = [50, 0]\n"
        "[[pin]]\npoints = [\"ground.A{0}\", \"l{0}.a\"]\n"
        "[[spring]]\nname = \"s{0}\"\npoints = [\"ground.G{0}\", \"l{0}.b\"]\nstiffness = 0.5\nfree_length = 30\n"
        "[[force]]\nname = \"f{0}\"\nat = \"l{0}.b\"\nvector = [2, -1]\n",
        k);
    start += fmt::format("l{} = -80\n", k);
  }
  return "title = \"Fifty levers\"\ngravity = [0, -9810]\n[units]\nlength = \"mm\"\nangle = "
         "\"deg\"\n[ground.points]\n" +
         points + items + start;
}

/// No file, beside which a draft would be written.
poise::app::ViewedScene in_memory(const std::string& text) {
  const std::string name = "scene.toml";
  return poise::app::SceneInMemory{poise::parse_sketch(text, name), text, name};
}

void print(const std::string& name, const char* what, const json& times) {
  for (const char* const part : {"total", "server"}) {
    std::vector<double> sorted;
    for (const json& time : times) sorted.push_back(time[part]);
    if (sorted.empty()) return;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    std::printf("%-16s %-10s %-22s %5zu %8.1f %8.1f %8.1f\n", name.c_str(), what,
                part == std::string("total") ? "event to frame" : "of it the program", n, sorted[n / 2],
                sorted[static_cast<std::size_t>(0.99 * static_cast<double>(n - 1))], sorted.back());
  }
}

json times_of(Browser& browser) {
  browser.wait_for("!document.querySelector('.stage.moving')");
  return browser.run("return new Promise(done => setTimeout(() => done(window.poiseTimes.splice(0)), 300))");
}

void drag_points(Browser& browser) {
  const json points = browser.run(
      "return [...document.querySelectorAll('[data-handle=point]')].map(one => { const box = "
      "one.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2] })");
  for (std::size_t p = 0; p < std::min(points.size(), most_points); ++p) {
    const double x = points[p][0], y = points[p][1];
    browser.press(x, y);
    // To the side and back in a circle, so that it ends where it began.
    for (int k = 1; k <= moves; ++k) {
      const double turn = 2 * M_PI * k / moves;
      browser.move(x + 40 * std::sin(turn), y + 40 * (1 - std::cos(turn)));
    }
    browser.let_go();
    browser.wait_for("!document.querySelector('.stage.moving')");
  }
}

void move_sliders(Browser& browser) {
  browser.run(
      "const moves = arguments[0]; const sliders = [...document.querySelectorAll('.panel input[type=range]')];"
      "const pause = () => new Promise(done => setTimeout(done, 30));"
      "return (async () => { for (const one of sliders.slice(0, 12)) { const begin = Number(one.value);"
      "  const far = 0.05 * (Number(one.max) - Number(one.min));"
      "  for (let k = 1; k <= moves; ++k) { one.value = begin + far * Math.sin(2 * Math.PI * k / moves);"
      "    one.dispatchEvent(new Event('input', {bubbles: true})); await pause(); }"
      "  one.dispatchEvent(new Event('change', {bubbles: true})); await pause(); } })()",
      {moves});
}

/// The least that any page can reach here: an empty sheet over the page moves a box as soon as the pointer moves.
void print_least(Browser& browser) {
  browser.run(
      "window.leastTimes = []; const sheet = document.createElement('div'); sheet.id = 'empty-sheet';"
      "sheet.style = 'position: fixed; inset: 0; z-index: 9999; background: white';"
      "const box = document.createElement('div'); box.textContent = '+'; sheet.append(box);"
      "document.body.append(sheet); sheet.addEventListener('pointerrawupdate', (event) => {"
      "  box.style.transform = `translate(${event.clientX}px, ${event.clientY}px)`;"
      "  requestAnimationFrame(() => { const channel = new MessageChannel();"
      "    channel.port1.onmessage = () => leastTimes.push(performance.now() - event.timeStamp);"
      "    channel.port2.postMessage(null); }); });");
  for (int k = 1; k <= 8 * moves; ++k) {
    const double turn = 2 * M_PI * k / moves;
    browser.move(200 + 40 * std::sin(turn), 200 + 40 * (1 - std::cos(turn)));
  }
  json times = json::array();
  for (const json& time : browser.run("return leastTimes")) times.push_back({{"total", time}, {"server", 0.0}});
  browser.run("document.getElementById('empty-sheet').remove()");
  print("an empty page", "moves", times);
}

}  // namespace

int main() {
  if (const std::string why = Browser::missing(); !why.empty()) {
    std::printf("not measured: %s\n", why.c_str());
    return 0;
  }
  const std::filesystem::path datasets = std::filesystem::path(POISE_SOURCE_DIR) / "datasets";
  std::vector<std::pair<std::string, poise::app::ViewedScene>> scenes;
  for (const char* const name : {"toggle_clamp", "excavator", "lift"})
    scenes.emplace_back(name, in_memory(poise::read_text_file(datasets / (std::string(name) + ".toml"))));
  scenes.emplace_back("chain of 20", in_memory(hanging_chain(20)));
  scenes.emplace_back("200 parts", in_memory(fifty_levers()));
  Browser browser;
  std::printf("%-16s %-10s %-22s %5s %8s %8s %8s\n", "ms", "", "", "n", "median", "99 %", "largest");
  for (auto& [name, scene] : scenes) {
    poise::app::BackgroundView view(std::move(scene));
    browser.open(view.address());
    browser.wait_for("document.body.dataset.revision !== undefined");
    times_of(browser);
    if (&name == &scenes.front().first) print_least(browser);
    drag_points(browser);
    print(name, "drags", times_of(browser));
    move_sliders(browser);
    print(name, "numbers", times_of(browser));
    browser.open("about:blank");
  }
}
