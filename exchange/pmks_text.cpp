#include "exchange/pmks_text.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "exchange/private/drawn_scene.hpp"
#include "exchange/private/reading.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

struct JointLine {
  std::vector<std::string> links;
  std::string kind;  // "r", "p", "rp"
  Vec2 at{};
  double degrees = 0.0;  // of the slide
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  constexpr std::string_view separators = ", \t";
  while (!(line = line.substr(std::min(line.find_first_not_of(separators), line.size()))).empty()) {
    out.push_back(line.substr(0, line.find_first_of(separators)));
    line.remove_prefix(out.back().size());
  }
  return out;
}

bool is_kind(std::string_view word) {
  const std::string kind = in_small_letters(word);
  return kind == "r" || kind == "p" || kind == "rp" || kind == "g";
}

JointLine read_joint_line(std::string_view text, const std::string& file, int line) {
  const std::string expected = "expected names of links, R, P or RP, and x, y: \"ground, crank, R, 0, 0\"";
  const std::vector<std::string_view> words = words_of(text);
  const auto kind = std::find_if(words.begin(), words.end(), is_kind);
  if (kind == words.end()) fail_at(file, line, "joint", expected + fmt::format(", found \"{}\"", one_line(text)));
  JointLine out;
  for (auto word = words.begin(); word != kind; ++word) {
    std::string name = one_line(*word);
    if (in_small_letters(name) == "ground") name = "ground";
    if (std::find(out.links.begin(), out.links.end(), name) != out.links.end()) {
      fail_at(file, line, "joint", fmt::format("expected links that differ, found \"{}\" twice", name));
    }
    out.links.push_back(std::move(name));
  }
  out.kind = in_small_letters(*kind);
  if (out.kind == "g") fail_at(file, line, "joint", "expected R, P or RP, found G: gears of PMKS are not taken");
  const bool slides = out.kind != "r";
  if (out.links.size() < 2 || (slides && out.links.size() > 2)) {
    fail_at(file, line, "joint",
            fmt::format("expected two links before {}{}, found {}", one_line(*kind), slides ? "" : " or more",
                        out.links.size()));
  }
  const std::size_t numbers = slides ? 3 : 2;
  if (static_cast<std::size_t>(words.end() - kind) < 1 + numbers) {
    fail_at(file, line, "joint", expected + (slides ? ", and the angle of the slide" : ""));
  }
  out.at = {number_at(kind[1], file, line, "x"), number_at(kind[2], file, line, "y")};
  if (slides) out.degrees = number_at(kind[3], file, line, "angle of the slide");
  return out;
}

}  // namespace

Imported import_pmks_text(std::string_view text, const std::string& file, const ImportOptions& options) {
  DrawnScene scene(file, options);
  const std::vector<std::string_view> lines = lines_of(text);
  int joints = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (line.empty()) continue;
    const JointLine joint = read_joint_line(line, file, static_cast<int>(i) + 1);
    if (++joints > static_cast<int>(most_items)) {
      fail_at(file, static_cast<int>(i) + 1, "joint", fmt::format("expected at most {} joints", most_items));
    }
    const std::string point = point_name(static_cast<std::size_t>(joints) - 1);
    for (const std::string& link : joint.links) scene.add_point(link, point, joint.at);
    const double angle = joint.degrees * std::numbers::pi / 180;
    for (std::size_t k = 1; k < joint.links.size(); ++k) {
      const Joint::Kind kind = joint.kind == "r"   ? Joint::Kind::pin
                               : joint.kind == "p" ? Joint::Kind::slide
                                                   : Joint::Kind::pin_in_slot;
      scene.add_joint(kind, joint.links[0], joint.links[k], point, {std::cos(angle), std::sin(angle)});
    }
  }
  if (joints == 0) fail_at(file, 1, "joint", "expected a line for each joint, found none");
  return scene.finish();
}

}  // namespace poise
