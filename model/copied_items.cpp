#include "model/copied_items.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "model/read_elements.hpp"
#include "model/toml_text.hpp"

namespace poise {
namespace {

using moved::Amount;
using moved::list_in;
using moved::tables_in;
using moved::text_in;

/// A number without the digits that rounding brings, beside others of this size.
std::string without_rounding(double value, double size) {
  constexpr int digits = 15;
  const int decimals = size > 0.0 ? digits - 1 - static_cast<int>(std::floor(std::log10(size))) : 0;
  const double near = decimals < 0 ? value : std::stod(fmt::format("{:.{}f}", value, decimals));
  return fmt::format("{}", near == 0.0 ? 0.0 : near);
}

bool is_same(const toml::node& a, const toml::node& b) {
  if (a.type() != b.type()) return false;
  if (const toml::table* const table = a.as_table()) {
    const toml::table& other = *b.as_table();
    return table->size() == other.size() && std::all_of(table->begin(), table->end(), [&](const auto& entry) {
             const toml::node* const twin = other.get(entry.first.str());
             return twin != nullptr && is_same(entry.second, *twin);
           });
  }
  if (const toml::array* const list = a.as_array()) {
    const toml::array& other = *b.as_array();
    return std::equal(list->begin(), list->end(), other.begin(), other.end(), is_same);
  }
  if (const auto* const text = a.as_string()) return text->get() == b.as_string()->get();
  return a.value<double>() == b.value<double>() && a.value<bool>() == b.value<bool>();
}

/// Begins a name that numbers follow: "link_" of "link_12".
std::string stem_of(const std::string& name) {
  std::size_t end = name.size();
  while (end > 0 && std::isdigit(static_cast<unsigned char>(name[end - 1])) != 0) --end;
  if (end < name.size() && end > 0) return name.substr(0, end);
  return name + (name.find(' ') != std::string::npos ? " " : "_");
}

bool is_letter(const std::string& name) {
  return !name.empty() && name[0] >= 'A' && name[0] <= 'Z' &&
         std::all_of(name.begin() + 1, name.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::string numbered_beside(const std::string& like, std::set<std::string>& taken) {
  const std::string stem = stem_of(like);
  for (int k = 2;; ++k) {
    std::string name = stem + std::to_string(k);
    if (taken.insert(name).second) return name;
  }
}

constexpr std::string_view of_ground = "ground.";

bool is_of_ground(const toml::array* points, std::size_t k) {
  const auto* const point = points != nullptr ? points->get_as<std::string>(k) : nullptr;
  return point != nullptr && point->get().starts_with(of_ground);
}

}  // namespace

FreeNames::FreeNames(const Scene& scene) {
  const auto learn = [&](const auto& list) {
    for (const auto& one : list) items_.insert(one.name);
  };
  learn(scene.bodies);
  learn(scene.joints);
  learn(scene.elements);
  learn(scene.drives);
  learn(scene.forces);
  learn(scene.torques);
  learn(scene.stops);
  learn(scene.blades);
  learn(scene.flexible_links);
  for (const Body& body : scene.bodies) {
    for (const NamedPoint& one : body.points) points_.insert(one.name);
  }
}

std::string FreeNames::item(const std::string& like) { return numbered_beside(like, items_); }

std::string FreeNames::joint(const std::string& like) {
  if (!is_letter(like)) return item(like);
  std::set<std::string> taken = items_;
  taken.insert(points_.begin(), points_.end());
  std::string name = free_letter(taken);
  items_.insert(name);
  return name;
}

std::string FreeNames::point(const std::string& like) {
  return is_letter(like) ? free_letter(points_) : numbered_beside(like, points_);
}

CopiedItems::CopiedItems(toml::table document, const toml::table& original, const TomlEdits& text,
                         const std::string& file, const Scene& scene, const CopiedSelection& selection,
                         const PlaneMotion& motion, FreeNames& names, bool in_place)
    : document_(std::move(document)),
      original_(original),
      text_(text),
      scene_(scene),
      selection_(selection),
      names_(names),
      in_place_(in_place),
      at_{{motion.at.x}, {motion.at.y}},
      ground_(scene.bodies[0].name) {
  constexpr double half_turn = M_PI;
  // As near to 0 as it can be said: a whole turn is none.
  const double turn = 2.0 * half_turn / scene.units.angle;
  double angle = std::remainder(motion.angle, turn);
  if (std::abs(angle) < 1e-12 * turn) angle = 0.0;
  mirrored_ = motion.mirrored;
  angle_ = {angle};
  constexpr double digits = 1e15;
  const auto clean = [&](double value) { return std::round(value * digits) / digits; };
  direction_ = {{clean(std::cos(angle * scene.units.angle))}, {clean(std::sin(angle * scene.units.angle))}};
  for (const std::string& body : selection.bodies) body_names_[body] = in_place ? body : names_.item(body);
  for (const FlexibleLink& link : scene.flexible_links) {
    if (!selection.bodies.contains(link.name)) continue;
    for (const int b : link.bodies) {
      const std::string& name = scene.bodies[static_cast<std::size_t>(b)].name;
      body_names_[name] = body_names_[link.name] + name.substr(link.name.size());
    }
  }
  for (const std::string& point : selection.ground_points) ground_point(point);
  const TomlTable root(document_, {file, 1, ""});
  std::map<std::string, std::vector<TomlTable>> places;
  for (const CopiedSelection::Item& item : selection.items) {
    if (!places.contains(item.table)) places[item.table] = root.tables(item.table);
  }
  const auto table_of = [&](const CopiedSelection::Item& item) -> toml::table& {
    return *tables_in(document_, item.table)[item.index];
  };
  // Joints and slots come first: others refer to them by their names.
  const auto pass_of = [](const CopiedSelection::Item& item) {
    return item.owner == Owner::joint ? 0 : !item.derived.empty() ? 1 : 2;
  };
  for (const int pass : {0, 1, 2}) {
    for (const CopiedSelection::Item& item : selection.items) {
      if (pass_of(item) == pass) copy_item(item, table_of(item), places[item.table][item.index]);
    }
  }
  if (toml::table* const all = moved::table_in(document_, "body")) {
    const TomlTable all_places = *root.find_table("body");
    for (const std::string& name : all_places.keys()) {
      if (!selection.bodies.contains(name)) continue;
      toml::table& body = *moved::table_in(*all, name);
      transform_body(body, *all_places.find_table(name));
      if (!in_place) bodies.emplace_back(body_names_[name], keys_of(body, *original_["body"][name].as_table()));
    }
  }
  write_start(selection);
  write_frame();
}

void CopiedItems::copy_item(const CopiedSelection::Item& item, toml::table& table, const TomlTable& place) {
  uses_frame_ = is_turned() && counts_from_ground(item.table, table);
  const bool has_name = table.contains("name");
  const std::string first_point = [&] {
    const toml::array* const points = list_in(table, "points");
    const auto* const point = points != nullptr ? points->get_as<std::string>(0) : nullptr;
    return point != nullptr ? point->get() : std::string();
  }();
  transform(item.table, table, place);
  if (is_turned() && !uses_frame_) {
    if (item.owner == Owner::joint)
      turn_joint(item.table, table);
    else
      turn_limits(item.table, table);
  }
  std::string name = item.name;
  if (item.owner == Owner::joint && !has_name) {
    name = name_of_default(item, table);
  } else if (in_place_) {
    // It keeps its name.
  } else if (has_name) {
    // A pin that is called as the point of the ground where it is goes on so.
    const auto point = first_point == ground_ + "." + item.name ? point_names_.find(item.name) : point_names_.end();
    const bool follows = point != point_names_.end() && point->second != item.name && names_.take_item(point->second);
    name = follows ? point->second : item.owner == Owner::joint ? names_.joint(item.name) : names_.item(item.name);
  } else if (!item.derived.empty()) {
    name = names_.item(item.name);
  }
  if (!in_place_ && (has_name || !item.derived.empty()))
    table.insert_or_assign(toml::key("name", key_source(table, "name")), name);
  if (item.owner == Owner::joint) joint_names_[item.name] = name;
  if (item.owner == Owner::element) element_names_[item.name] = name;
  for (const std::string& derived : item.derived) {
    const std::string whole = name + derived.substr(item.name.size());
    body_names_[derived] = joint_names_[derived] = whole;
  }
  if (in_place_) return;
  TomlKeys keys = keys_of(table, *original_[item.table][item.index].as_table());
  // A name stands first.
  std::stable_partition(keys.begin(), keys.end(), [&](const auto& key) { return !has_name && key.first == "name"; });
  items.emplace_back(item.table, std::move(keys));
}

/// "ground.F-crank_2.A" of "ground.A-crank.A", with what tells it from others of the same points.
std::string CopiedItems::name_of_default(const CopiedSelection::Item& item, const toml::table& table) {
  const toml::array& points = *table.get_as<toml::array>("points");
  const toml::array& before = *original_[item.table][item.index]["points"].as_array();
  const auto joined = [](const toml::array& list) {
    return list.get_as<std::string>(0)->get() + "-" + list.get_as<std::string>(1)->get();
  };
  const std::string own = joined(before);
  return joined(points) + (item.name.starts_with(own) ? item.name.substr(own.size()) : "");
}

void CopiedItems::name_body(std::string& name) {
  if (name != ground_) {
    name = body_names_.at(name);
  } else if (uses_frame_) {
    name = frame();
  }
}

void CopiedItems::name_point(std::string& name) {
  const std::size_t dot = name.rfind('.');
  const std::string body = name.substr(0, dot), point = name.substr(dot + 1);
  if (body != ground_)
    name = body_names_.at(body) + "." + point;
  else
    name = uses_frame_ ? frame() + "." + point : ground_ + "." + ground_point(point);
}

// A name of something that is not copied stays as it is.
void CopiedItems::name_joint(std::string& name) {
  const auto known = joint_names_.find(name);
  if (known != joint_names_.end()) name = known->second;
}
void CopiedItems::name_element(std::string& name) {
  const auto known = element_names_.find(name);
  if (known != element_names_.end()) name = known->second;
}

std::string CopiedItems::origin_of_places() {
  if (uses_frame_) return frame() + "." + frame_origin_;
  if (origin_.empty()) {
    origin_ = names_.point("A");
    ground_points.emplace_back(origin_, text_of(moved::array_of(at_), nullptr));
  }
  return ground_ + "." + origin_;
}

std::string CopiedItems::carrier_of_gears() { return uses_frame_ ? frame() : ""; }

moved::Place CopiedItems::placed(const toml::node& at) const {
  const moved::Place own{Amount::component(&at, 0), Amount{mirrored_ ? -1.0 : 1.0} * Amount::component(&at, 1)};
  const moved::Place turned = direction_.turned(own);
  return {at_.x + turned.x, at_.y + turned.y};
}

/// The point of the ground that stands for one in the copy: itself where the motion leaves it in its place.
std::string CopiedItems::ground_point(const std::string& name) {
  const auto known = point_names_.find(name);
  if (known != point_names_.end()) return known->second;
  const toml::node* const written = original_[ground_]["points"][name].node();
  if (written == nullptr)
    throw InputError("expected items of this text; \"" + ground_ + "." + name + "\" is the place of a part");
  const toml::node& at = *written;
  const moved::Place to = placed(at);
  const auto found = std::find_if(scene_.bodies[0].points.begin(), scene_.bodies[0].points.end(),
                                  [&](const NamedPoint& one) { return one.name == name; });
  const Vec2 before = (1.0 / scene_.units.length) * found->at;
  const Vec2 own{before.x, mirrored_ ? -before.y : before.y};
  const Vec2 after = Vec2{at_.x.value, at_.y.value} + Vec2{direction_.cos.value * own.x - direction_.sin.value * own.y,
                                                           direction_.sin.value * own.x + direction_.cos.value * own.y};
  const bool stays = norm(after - before) <= 1e-12 * (norm(before) + norm(Vec2{at_.x.value, at_.y.value}));
  const bool is_taken_along = in_place_ && !selection_.shared_points.contains(name);
  std::string out = stays || is_taken_along ? name : names_.point(name);
  point_names_[name] = out;
  if (!stays) (is_taken_along ? placed_points : ground_points).emplace_back(out, text_of(moved::array_of(to), nullptr));
  return out;
}

/// A body that is welded to the ground, turned as the copy.
const std::string& CopiedItems::frame() {
  if (!frame_.empty()) return frame_;
  frame_ = names_.take_item("frame") ? "frame" : names_.item("frame");
  frame_point_ = names_.point("A");
  frame_origin_ = "origin";
  const auto has = [&](const NamedPoint& one) { return one.name == frame_origin_; };
  while (std::any_of(scene_.bodies[0].points.begin(), scene_.bodies[0].points.end(), has)) frame_origin_ += "_";
  return frame_;
}

void CopiedItems::write_frame() {
  if (frame_.empty()) return;
  toml::table points;
  if (toml::table* const own = moved::table_in(document_, ground_)) {
    transform_points(*own);
    points = std::move(*moved::table_in(*own, "points"));
  }
  points.insert_or_assign(frame_origin_, toml::array{0, 0});
  bodies.insert(bodies.begin(), {frame_, {{"points", text_of(points, nullptr)}}});
  ground_points.emplace_back(frame_point_, text_of(moved::array_of(at_), nullptr));
  toml::table weld;
  weld.insert_or_assign("points", toml::array{ground_ + "." + frame_point_, frame_ + "." + frame_origin_});
  weld.insert_or_assign("angle", angle_.value);
  items.insert(
      items.begin(),
      {"weld", {{"points", text_of(*weld.get("points"), nullptr)}, {"angle", text_of(*weld.get("angle"), nullptr)}}});
}

void CopiedItems::change(TomlEdits& edits) const {
  for (const CopiedSelection::Item& item : selection_.items)
    change(edits, *document_[item.table][item.index].as_table(), *original_[item.table][item.index].as_table(), "");
  for (const std::string& body : selection_.bodies)
    change(edits, *document_["body"][body].as_table(), *original_["body"][body].as_table(), "body." + toml_key(body));
}

void CopiedItems::change(TomlEdits& edits, const toml::table& table, const toml::table& before,
                         const std::string& header) const {
  TomlKeys added;
  for (const auto& [key, text] : keys_of(table, before)) {
    const toml::node& node = *table.get(key);
    const toml::node* const twin = before.get(key);
    if (twin == nullptr) {
      added.emplace_back(key, text);
    } else if (is_same(node, *twin)) {
      continue;
    } else if (twin->is_table() && !twin->as_table()->is_inline()) {
      change(edits, *node.as_table(), *twin->as_table(), header + "." + toml_key(key));
    } else if (twin->is_array() && edits.is_header(*twin)) {
      for (std::size_t k = 0; k < twin->as_array()->size(); ++k)
        change(edits, *node.as_array()->get(k)->as_table(), *twin->as_array()->get(k)->as_table(), "");
    } else {
      edits.replace(*twin, text);
    }
  }
  // What takes the place of a key stands where that was.
  for (auto&& [key, node] : before) {
    if (table.contains(key.str()) || added.empty()) continue;
    edits.replace_key(key, added.front().first);
    edits.replace(node, added.front().second);
    added.erase(added.begin());
  }
  if (!added.empty()) edits.add(&before, header, added);
}

/// Whether more of the ground than the places of its points is in an item, and not only in numbers that can be turned.
bool CopiedItems::counts_from_ground(std::string_view table, const toml::table& item) const {
  for (const JointTraits& kind : Joint::kinds) {
    if (kind.key == table) return false;
  }
  const std::vector<std::string_view> elements = element_tables();
  const bool is_measured = table == "stop" || std::find(elements.begin(), elements.end(), table) != elements.end();
  if (!is_measured) return true;
  return !(item.contains("bodies") || (item.contains("points") && !item.contains("axis")));
}

void CopiedItems::add_amount(toml::table& table, std::string_view key, const Amount& more) {
  const toml::key at(std::string(key), key_source(table, key));
  (Amount::of(table.get(key)) + more).put([&](const auto& value) { table.insert_or_assign(at, value); });
}

void CopiedItems::turn_joint(std::string_view kind, toml::table& joint) const {
  const toml::array* const points = list_in(joint, "points");
  const bool a = is_of_ground(points, 0), b = is_of_ground(points, 1);
  if (a) {
    if (const toml::array* const axis = list_in(joint, "axis")) {
      toml::array turned = moved::array_of(direction_.turned({Amount::component(axis, 0), Amount::component(axis, 1)}));
      *list_in(joint, "axis") = std::move(turned);
    }
  }
  if ((kind == "slide" || kind == "weld") && (a || b)) add_amount(joint, "angle", {a ? angle_.value : -angle_.value});
}

/// Angles from the ground, or from a body to the ground, are others behind a turn.
void CopiedItems::turn_limits(std::string_view table, toml::table& item) const {
  const toml::array* const pair = list_in(item, "bodies");
  if (pair == nullptr || pair->size() != 2) return;
  const auto is_ground = [&](std::size_t k) {
    const auto* const name = pair->get_as<std::string>(k);
    return name != nullptr && name->get() == ground_;
  };
  if (!is_ground(0) && !is_ground(1)) return;
  const Amount more{is_ground(0) ? angle_.value : -angle_.value};
  if (table == "stop") {
    for (const std::string_view key : {"min", "max"}) {
      if (item.contains(key)) add_amount(item, key, more);
    }
  } else if (item.contains("preload")) {
    add_amount(item, "angle", more);
  } else if (item.contains("stiffness") || table == "bump_stop") {
    add_amount(item, "free_angle", more);
  } else if (moved::table_in(item, "torque") != nullptr && !table.ends_with("damper")) {
    add_amount(item, "shift", more);
  }
}

void CopiedItems::write_start(const CopiedSelection& selection) {
  const toml::table* const written = original_["start"].as_table();
  const auto travels = [&](const std::string& name) {
    return std::any_of(scene_.joints.begin(), scene_.joints.end(),
                       [&](const Joint& joint) { return joint.name == name && joint.has_travel(); });
  };
  std::set<std::string> rolling;
  for (const CopiedSelection::Item& item : selection.items) {
    if (item.table == "rolling") rolling.insert(item.derived.begin(), item.derived.end());
  }
  std::set<std::string> guessed;
  const auto guess = [&](const std::string& name, const toml::node& node) {
    const auto joint = joint_names_.find(name), body = body_names_.find(name);
    const bool is_travel = joint != joint_names_.end() && travels(name);
    if (!is_travel && body == body_names_.end()) return;
    const double sense = mirrored_ && (!is_travel || rolling.contains(name)) ? -1.0 : 1.0;
    const Amount value = Amount{sense} * Amount::of(&node) + (is_travel ? Amount{} : angle_);
    if (!is_travel) guessed.insert(name);
    const bool is_kept = sense > 0.0 && (is_travel || !is_turned());
    std::string text = is_kept ? text_of(node, &node) : "";
    if (!is_kept) value.put([&](const auto& one) { text = text_of(toml::value(one), nullptr); });
    start.emplace_back(is_travel ? joint->second : body->second, text);
  };
  if (written != nullptr) {
    for (auto&& [key, node] : *written) {
      if (!node.is_table()) guess(std::string(key.str()), node);
    }
  }
  // A body without a guess begins at 0, unless a slide or weld says how it stands.
  for (const Joint& joint : scene_.joints) {
    if (!joint_names_.contains(joint.name) || !joint.keeps_angle()) continue;
    guessed.insert(scene_.bodies[static_cast<std::size_t>(joint.a.body)].name);
    guessed.insert(scene_.bodies[static_cast<std::size_t>(joint.b.body)].name);
  }
  const auto turn_with_others = [&](const std::string& body) {
    const auto copied = body_names_.find(body);
    if (copied == body_names_.end() || !is_turned() || guessed.contains(body)) return;
    start.emplace_back(copied->second, text_of(toml::value(angle_.value), nullptr));
  };
  for (const std::string& body : selection.bodies) turn_with_others(body);
  for (const CopiedSelection::Item& item : selection.items) {
    for (const std::string& derived : item.derived) {
      const auto is_it = [&](const Body& body) { return body.name == derived; };
      if (std::any_of(scene_.bodies.begin(), scene_.bodies.end(), is_it)) turn_with_others(derived);
    }
  }
  const toml::table* const places = written != nullptr ? (*written)["position"].as_table() : nullptr;
  if (places == nullptr) return;
  for (auto&& [key, node] : *places) {
    const auto body = body_names_.find(std::string(key.str()));
    if (body != body_names_.end())
      positions.emplace_back(body->second, text_of(moved::array_of(placed(node)), nullptr));
  }
}

/// A value as TOML: where it is as it was, with the words of the text.
std::string CopiedItems::text_of(const toml::node& node, const toml::node* before) const {
  const bool stands_alone = before != nullptr && (!before->is_table() || before->as_table()->is_inline()) &&
                            !(before->is_array() && text_.is_header(*before));
  if (stands_alone && is_same(node, *before)) return std::string(text_.source(*before));
  if (const toml::table* const table = node.as_table()) {
    static const toml::table none;
    const toml::table* const twin = before != nullptr ? before->as_table() : nullptr;
    return "{ " + listed(keys_of(*table, twin != nullptr ? *twin : none), "", ", ") + " }";
  }
  if (const toml::array* const list = node.as_array()) {
    double size = 0.0;
    for (const toml::node& one : *list) size = std::max(size, std::abs(one.value<double>().value_or(0.0)));
    const toml::array* const twin = before != nullptr ? before->as_array() : nullptr;
    std::string out;
    for (std::size_t k = 0; k < list->size(); ++k) {
      const toml::node& one = *list->get(k);
      const toml::node* const one_before = twin != nullptr && k < twin->size() ? twin->get(k) : nullptr;
      const bool is_changed = one_before == nullptr || !is_same(one, *one_before);
      out += (k > 0 ? ", " : "") + (one.is_floating_point() && is_changed ? without_rounding(*one.value<double>(), size)
                                                                          : text_of(one, one_before));
    }
    return "[" + out + "]";
  }
  if (const auto* const text = node.as_string()) return toml_string(text->get());
  if (const auto* const flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* const whole = node.as_integer()) return std::to_string(whole->get());
  const double value = node.value<double>().value_or(0.0);
  return without_rounding(value, std::abs(value));
}

/// In the order of the text; what is new stands behind.
TomlKeys CopiedItems::keys_of(const toml::table& table, const toml::table& before) const {
  std::vector<std::pair<const toml::key*, const toml::node*>> entries;
  for (auto&& [key, node] : table) entries.emplace_back(&key, &node);
  const auto is_earlier = [](const auto& a, const auto& b) {
    const toml::source_position one = a.first->source().begin, other = b.first->source().begin;
    return one && (!other || one < other);
  };
  std::stable_sort(entries.begin(), entries.end(), is_earlier);
  TomlKeys out;
  for (const auto& [key, node] : entries)
    out.emplace_back(std::string(key->str()), text_of(*node, before.get(key->str())));
  return out;
}

}  // namespace poise
