#include "exchange/pmks_text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "exchange/private/drawn_scene.hpp"
#include "exchange/private/reading.hpp"
#include "model/named_number.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

constexpr std::size_t longest_name = 100;

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

/// The place of R, P, RP or G: the first that a number stands behind, for links may have such names too.
std::size_t place_of_kind(const std::vector<std::string_view>& words) {
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    const std::string kind = in_small_letters(words[k]);
    if ((kind == "r" || kind == "p" || kind == "rp" || kind == "g") && read_number(words[k + 1])) return k;
  }
  return words.size();
}

JointLine read_joint_line(std::string_view text, const std::string& file, int line) {
  const std::string expected = "expected names of links, R, P or RP, and x, y: \"ground, crank, R, 0, 0\"";
  const std::vector<std::string_view> words = words_of(text);
  const std::size_t kind = place_of_kind(words);
  if (kind == words.size()) fail_at(file, line, "joint", expected + fmt::format(", found \"{}\"", one_line(text)));
  JointLine out;
  for (std::size_t k = 0; k < kind; ++k) {
    std::string name = one_line(words[k]);
    if (name.size() > longest_name) {
      fail_at(file, line, "joint", fmt::format("expected names of at most {} letters", longest_name));
    }
    if (in_small_letters(name) == "ground") name = "ground";
    if (std::find(out.links.begin(), out.links.end(), name) != out.links.end()) {
      fail_at(file, line, "joint", fmt::format("expected links that differ, found \"{}\" twice", name));
    }
    out.links.push_back(std::move(name));
  }
  out.kind = in_small_letters(words[kind]);
  if (out.kind == "g") {
    fail_at(file, line, "joint", "expected R, P or RP, found G: gears of PMKS name no ratio that could be taken");
  }
  const bool slides = out.kind != "r";
  if (out.links.empty() || (slides && out.links.size() != 2)) {
    fail_at(file, line, "joint",
            fmt::format("expected {} in front of {}, found {}", slides ? "two links" : "a link", one_line(words[kind]),
                        out.links.size()));
  }
  if (words.size() - kind - 1 < (slides ? 3 : 2)) {
    fail_at(file, line, "joint", expected + (slides ? ", and the angle of the slide" : ""));
  }
  out.at = {number_at(words[kind + 1], file, line, "x"), number_at(words[kind + 2], file, line, "y")};
  if (slides) out.degrees = number_at(words[kind + 3], file, line, "angle of the slide");
  return out;
}

Joint::Kind kind_of(const std::string& word) {
  return word == "r" ? Joint::Kind::pin : word == "p" ? Joint::Kind::slide : Joint::Kind::pin_in_slot;
}

}  // namespace

Imported import_pmks_text(std::string_view text, const std::string& file, const ImportOptions& options) {
  std::vector<std::string> notes;
  DrawnScene scene(file, {.length = length_unit(options, "mm", notes)});
  for (std::string& note : notes) scene.add_note(std::move(note));
  const std::vector<std::string_view> lines = lines_of(text);
  std::size_t joints = 0;
  bool has_input = false, slides = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const int line = static_cast<int>(i) + 1;
    const JointLine joint = read_joint_line(trimmed(lines[i]), file, line);
    if (++joints > most_items) fail_at(file, line, "joint", fmt::format("expected at most {} joints", most_items));
    const std::string point = point_name(joints - 1);
    for (const std::string& link : joint.links) {
      scene.add_point(link, point, joint.at);
      has_input = has_input || link == "input";
    }
    slides = slides || joint.kind != "r";
    for (std::size_t k = 1; k < joint.links.size(); ++k) {
      scene.add_joint({kind_of(joint.kind), {joint.links[0], point}, {joint.links[k], point}, axis_at(joint.degrees)});
    }
  }
  if (joints == 0) fail_at(file, 1, "joint", "expected a line for each joint, found none");
  if (slides) scene.add_note("A slot belongs to the first link of its line, and its angle is in degrees.");
  if (has_input) scene.add_note("The link input is driven in PMKS: here it is free, until an option --drive names it.");
  scene.add_note("Points are named by the order of their lines, and no link has a mass.");
  return scene.finish();
}

}  // namespace poise
