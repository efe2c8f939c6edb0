#include "model/scene_names.hpp"

#include <algorithm>

#include "model/nearest_name.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

int index_in(const std::unordered_map<std::string, int>& names, const std::string& name) {
  const auto entry = names.find(name);
  return entry == names.end() ? -1 : entry->second;
}

}  // namespace

void SceneNames::learn_body(int body) {
  bodies_.emplace(scene_.bodies[body].name, body);
  for (int i = 0; i < static_cast<int>(scene_.bodies[body].points.size()); ++i) {
    points_.emplace(scene_.name_of({body, i}), PointRef{body, i});
  }
}

void SceneNames::learn_joint(int joint) { joints_.emplace(scene_.joints[joint].name, joint); }

int SceneNames::index_of_body(const std::string& name) const { return index_in(bodies_, name); }

int SceneNames::index_of_joint(const std::string& name) const { return index_in(joints_, name); }

std::vector<std::string> SceneNames::movable_body_names() const {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < scene_.bodies.size(); ++i) names.push_back(scene_.bodies[i].name);
  return names;
}

std::vector<std::string> SceneNames::travelling_joint_names() const {
  std::vector<std::string> names;
  for (const Joint& joint : scene_.joints) {
    if (joint.has_travel()) names.push_back(joint.name);
  }
  return names;
}

void SceneNames::note(NameUse::Of of, const TomlText& name) const {
  if (uses_ != nullptr && name.node != nullptr) uses_->push_back({of, name.value, name.node->source()});
}

int SceneNames::find_body(const TomlText& name, int first) const {
  const int body = index_of_body(name.value);
  if (body >= first) {
    note(NameUse::Of::body, name);
    return body;
  }
  std::vector<std::string> candidates = movable_body_names();
  if (first == 0) candidates.insert(candidates.begin(), scene_.bodies[0].name);
  const std::string expected =
      first == 0 ? "expected the name of a body, found \"" : "expected the name of a body other than ground, found \"";
  name.place.fail(expected + name.value + "\"" + did_you_mean_or_list(name.value, candidates));
}

PointRef SceneNames::point(const TomlText& name) const {
  const auto known = points_.find(name.value);
  if (known != points_.end()) {
    note(NameUse::Of::point, name);
    return known->second;
  }
  const std::size_t dot = name.value.rfind('.');
  const int body = dot == std::string::npos ? -1 : index_of_body(name.value.substr(0, dot));
  const std::string found = ", found \"" + name.value + "\"";
  std::vector<std::string> candidates;
  if (body >= 0) {
    const Body& owner = scene_.bodies[body];
    if (owner.points.empty()) {
      name.place.fail("expected a point of \"" + owner.name + "\", which has none" + found +
                      "; add points = { NAME = [X, Y] } to it");
    }
    for (const NamedPoint& point : owner.points) candidates.push_back(owner.name + "." + point.name);
    name.place.fail("expected a point of \"" + owner.name + "\"" + found +
                    did_you_mean_or_list(name.value, candidates));
  }
  for (const auto& [candidate, ref] : points_) candidates.push_back(candidate);
  // Sorted, so that the nearest of several does not depend on the hash.
  std::sort(candidates.begin(), candidates.end());
  name.place.fail("expected a point \"BODY.POINT\"" + found + did_you_mean_or_list(name.value, candidates));
}

int SceneNames::travelling_joint(const TomlText& name) const {
  const int joint = index_of_joint(name.value);
  if (joint >= 0 && scene_.joints[joint].has_travel()) {
    note(NameUse::Of::joint, name);
    return joint;
  }
  name.place.fail("expected the name of a slide or pin_in_slot, found \"" + name.value + "\"" +
                  did_you_mean_or_list(name.value, travelling_joint_names()));
}

std::pair<PointRef, PointRef> SceneNames::two_points(const TomlTable& table) const {
  const std::array<TomlText, 2> names = table.two_texts("points");
  const std::pair<PointRef, PointRef> points{point(names[0]), point(names[1])};
  if (points.first.body == points.second.body) {
    names[1].place.fail("expected points of two different bodies, found two of \"" +
                        scene_.bodies[points.first.body].name + "\"");
  }
  return points;
}

std::pair<int, int> SceneNames::two_bodies(const TomlTable& table) const {
  const std::array<TomlText, 2> names = table.two_texts("bodies");
  const std::pair<int, int> bodies{body(names[0]), body(names[1])};
  if (bodies.first == bodies.second) {
    names[1].place.fail("expected two different bodies, found \"" + names[1].value + "\" twice");
  }
  return bodies;
}

void fail_taken(const TomlPlace& place, const std::string& name, int line) {
  const std::string where = line > 0 ? " in line " + std::to_string(line) : "";
  place.fail("expected a name of its own; \"" + name + "\" is taken" + where);
}

void check_name(const std::string& name, const TomlPlace& place) {
  if (name.empty()) place.fail("expected a name that is not empty");
  constexpr std::size_t longest = 1000;
  if (name.size() > longest) {
    place.fail("expected a name of at most " + std::to_string(longest) + " bytes, found " +
               std::to_string(name.size()));
  }
  if (one_line(name) != name) {
    place.fail("expected a name without control characters");
  }
}

std::vector<std::string> names_of(const std::vector<TomlTable>& items, const std::vector<std::string>& defaults,
                                  NameLines taken) {
  // Given names come first, so that no default can take one of them.
  std::vector<std::string> names(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::optional<TomlText> name = items[i].find_text("name");
    if (!name) continue;
    check_name(name->value, name->place);
    const auto [other, is_new] = taken.emplace(name->value, name->place.line_in_document());
    if (!is_new) fail_taken(name->place, name->value, other->second);
    names[i] = name->value;
  }
  // Count of each default, so that many parallel joints are numbered without trying every number.
  std::unordered_map<std::string, int> count;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!names[i].empty()) continue;
    do {
      const int nth = ++count[defaults[i]];
      names[i] = nth == 1 ? defaults[i] : defaults[i] + " (" + std::to_string(nth) + ")";
    } while (!taken.emplace(names[i], items[i].place().line_in_document()).second);
  }
  return names;
}

}  // namespace poise
