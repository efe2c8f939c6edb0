#include "app/view/view_session.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/commands.hpp"
#include "app/draw/figure_json.hpp"
#include "app/present/document.hpp"
#include "app/present/html.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/solve.hpp"
#include "app/terminal/output_file.hpp"
#include "app/view/drawing_tools.hpp"
#include "app/view/exchanged.hpp"
#include "app/view/link_mass.hpp"
#include "app/view/parked_items.hpp"
#include "app/view/part_file.hpp"
#include "app/view/requested_motion.hpp"
#include "app/view/templates.hpp"
#include "model/dependent_number.hpp"
#include "model/named_files.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/parameter_values.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/text_file.hpp"
#include "model/toml_text.hpp"

namespace poise::app {
namespace {

using nlohmann::json;

constexpr std::size_t most_steps_back = 200;

constexpr const char* solve_differs =
    "what is shown would not stay there: poise solve lets the mechanism of this text move to another equilibrium";
constexpr const char* stable_in_page = "the panel \"Other equilibria\" shows where it stays";

constexpr std::string_view empty_sheet =
    "title = \"New mechanism\"\ngravity = [0, -9810]\n\n[units]\nlength = \"mm\"\nangle = \"deg\"\n";

/// The place of the first "FILE:LINE:" in a message.
std::optional<int> line_in(const std::string& message, const std::string& file) {
  const std::size_t at = message.find(file + ":");
  if (at == std::string::npos) return std::nullopt;
  const char* const begin = message.data() + at + file.size() + 1;
  int line = 0;
  const auto [end, error] = std::from_chars(begin, message.data() + message.size(), line);
  if (error != std::errc() || end == begin || *end != ':') return std::nullopt;
  return line;
}

/// Whether undo takes a request back: dragging about with the hand changes no number.
bool changes_scene(const std::string& what) {
  constexpr std::array<std::string_view, 17> changing = {"ground", "load", "set",   "switch",  "text",   "import",
                                                         "reload", "draw", "place", "remove",  "rename", "keys",
                                                         "copy",   "move", "group", "ungroup", "go"};
  return std::find(changing.begin(), changing.end(), what) != changing.end();
}

Vec2 px_of(const json& request) {
  const json& px = request.at("px");
  return {px.at(0).get<double>(), px.at(1).get<double>()};
}

const char* group_of(const ParameterRow& row, const Scene& scene) {
  switch (row.place.owner) {
    case Owner::force:
    case Owner::torque:
      return "loads";
    case Owner::number:
      return "numbers";
    case Owner::scene:
      return "gravity";
    case Owner::element:
      return stores_energy(scene.elements[static_cast<std::size_t>(row.place.item)].law) ? "springs" : "dampers";
    case Owner::stop:
      return "stops";
    case Owner::coupling:
      return "couplings";
    case Owner::point:
    case Owner::joint:
      return "dimensions";
    case Owner::body:
      return "masses";
    default:
      return "others";
  }
}

/// The range of a slider: from nothing to twice the number, or as far to both sides as the number is large.
std::pair<double, double> slider(const ParameterRow& row, double value, double size) {
  const bool signed_number = row.range == Range::finite;
  if (row.place.owner == Owner::point) {
    const double reach = std::max(0.5 * size, std::abs(value));
    return {value - 0.5 * reach, value + 0.5 * reach};
  }
  const double reach = value == 0.0 ? 1.0 : std::abs(value);
  if (!signed_number) return {0.0, 2.0 * reach};
  return {value - reach, value + reach};
}

/// Keys with values as TOML: numbers, pairs of numbers and texts, all that the page sends.
std::map<std::string, std::string> toml_values(const json& values) {
  std::map<std::string, std::string> out;
  for (const auto& [key, value] : values.items()) {
    if (value.is_number())
      out[key] = value.dump();
    else if (value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number())
      out[key] = fmt::format("[{}, {}]", value[0].dump(), value[1].dump());
    else
      out[key] = toml_string(value.get<std::string>());
  }
  return out;
}

/// A state with its drawing, which is text already.
std::string with_drawing(const json& state, const std::string& drawing) {
  std::string out = state.dump(-1, ' ', false, json::error_handler_t::replace);
  if (!drawing.empty()) out.insert(out.size() - 1, ",\"drawing\":" + drawing);
  return out;
}

/// Whether the mechanism is at one of the equilibria, full turns aside.
bool same_position(const OtherEquilibria::Found& found, std::size_t k, const BodyPoses& now) {
  constexpr double near = 1e-6;
  const BodyPoses& there = found.poses[k];
  for (std::size_t i = 1; i < std::min(now.size(), there.size()); ++i) {
    if (std::abs(std::remainder(now[i].angle - there[i].angle, 2 * M_PI)) > near) return false;
    if (norm(now[i].origin - there[i].origin) > near * found.length) return false;
  }
  return true;
}

/// The points of the ground that joints and force elements use.
std::vector<PointRef> used_of_ground(const Scene& scene) {
  std::set<int> used;
  const auto use = [&](PointRef point) {
    if (point.body == 0) used.insert(point.point);
  };
  for (const Joint& joint : scene.joints) {
    use(joint.a);
    use(joint.b);
  }
  for (const Element& element : scene.elements) {
    if (element.on.kind == Measure::Kind::distance) {
      use(element.on.a);
      use(element.on.b);
    }
  }
  std::vector<PointRef> out;
  for (const int point : used) out.push_back({0, point});
  return out;
}

/// The stops of the hand as a scene file has them: with them at its end the scene has the position shown as one of its
/// equilibria.
std::string toml_of_hand(const TrackedEquilibrium& tracked) {
  const Scene& scene = tracked.scene_with_hand();
  const std::string point = toml_string(scene.name_of(*tracked.hand()));
  std::string out;
  for (std::size_t k = scene.stops.size() - tracked.hand_stops(); k < scene.stops.size(); ++k) {
    const Stop& stop = scene.stops[k];
    const std::string at = toml_number(stop.min / scene.units.length);
    out += fmt::format("\n[[stop]]\nname = {}\nmin = {}\nmax = {}\n", toml_string(stop.name), at, at);
    if (stop.on.kind == Measure::Kind::sum) {
      out += fmt::format("sum = [{{ factor = {}, x = {} }}, {{ factor = {}, y = {} }}]\n",
                         toml_number(stop.on.terms[0].factor), point, toml_number(stop.on.terms[1].factor), point);
    } else {
      out += fmt::format("{} = {}\n", stop.on.kind == Measure::Kind::x ? "x" : "y", point);
    }
  }
  return out;
}

/// The start of a scene as a person would write it, without digits that a guess does not need: to a ten-thousandth of
/// a degree, and to a millionth of the size of the mechanism, m, or `finer` digits better. What is written already
/// stays where it says the same, and what a body has anyway is not written. `layout`: of a mechanism that rests.
Start written_start(const Scene& scene, const Start& written, double size, const Layout* layout, int finer) {
  const auto take = [finer](std::optional<double>& value, const std::optional<double>& before, double unit,
                            int digits) {
    if (!value) return;
    const double scale = std::pow(10.0, digits + finer);
    // Multiplied in the unit of the file, so that it reads there as it was rounded; without the sign of a zero.
    const double rounded = std::round(*value / unit * scale) / scale * unit + 0.0;
    value = before && std::abs(*before - rounded) < 2.5 * unit / scale ? *before : rounded;
  };
  const int angle_digits = scene.units.angle == 1.0 ? 6 : 4;
  const double length = scene.units.length;
  const int length_digits = 6 - static_cast<int>(std::floor(std::log10(std::max(size, 1e-30) / length)));
  Start out = scene.start;
  const auto has_anyway = [&](std::size_t b) {
    if (written.angle[b] || layout == nullptr) return false;
    const Link& link = layout->links[b];
    return link.frame < 0 || (link.turn == 0 && out.angle[b] == 0.0);
  };
  for (std::size_t b = 0; b < out.angle.size(); ++b) {
    take(out.angle[b], written.angle[b], scene.units.angle, angle_digits);
    if (has_anyway(b)) out.angle[b].reset();
  }
  for (std::size_t j = 0; j < out.travel.size(); ++j) take(out.travel[j], written.travel[j], length, length_digits);
  for (std::size_t b = 0; b < out.position.size(); ++b) {
    if (!out.position[b]) continue;
    std::optional<double> x = out.position[b]->x, y = out.position[b]->y, x_before, y_before;
    if (written.position[b]) {
      x_before = written.position[b]->x;
      y_before = written.position[b]->y;
    }
    take(x, x_before, length, length_digits);
    take(y, y_before, length, length_digits);
    out.position[b] = Vec2{*x, *y};
  }
  return out;
}

/// Whether the start of a scene, as far as it gives one, is that of another.
bool starts_alike(const Scene& given, const Scene& other) {
  constexpr double rounding = 1e-12;
  if (given.bodies.size() != other.bodies.size() || given.joints.size() != other.joints.size()) return false;
  const auto alike = [](const auto& a, const auto& b, auto&& apart) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i] && b[i] && apart(*a[i], *b[i]) > rounding) return false;
    }
    return true;
  };
  const auto numbers = [](double a, double b) { return std::abs(a - b) / std::max(1.0, std::abs(b)); };
  const auto places = [](Vec2 a, Vec2 b) { return norm(a - b) / std::max(1e-3, norm(b)); };
  return alike(given.start.angle, other.start.angle, numbers) &&
         alike(given.start.travel, other.start.travel, numbers) &&
         alike(given.start.position, other.start.position, places);
}

}  // namespace

ViewSession::ViewSession(std::filesystem::path file, const std::atomic<bool>* interrupt)
    : file_(std::move(file)),
      interrupt_(interrupt),
      now_(opened(text_on_disk().value_or(std::string(empty_sheet)), std::nullopt)) {
  now_.on_disk = text_on_disk();
  draft_.emplace(file_);
  begin();
}

SceneInMemory new_scene() {
  const std::string name = "mechanism.toml";
  return {parse_sketch(empty_sheet, name), std::string(empty_sheet), name};
}

ViewSession::ViewSession(SceneInMemory scene, const std::atomic<bool>* interrupt)
    : file_(std::move(scene.name)),
      has_file_(false),
      interrupt_(interrupt),
      now_(opened(scene.text, std::move(scene.scene))) {
  begin();
}

void ViewSession::begin() {
  sync();
  now_.saved_text = present_text();
  take_draft();
  look_for_others();
}

/// Shows what was drawn when the program ended without saving it, as a change of the file that can be undone.
void ViewSession::take_draft() {
  if (!draft_) return;
  std::error_code unknown;
  for (const std::filesystem::path& file : draft_->left_behind()) {
    const State before = now_;
    try {
      const std::string text = read_text_file(file);
      if (text.empty() || text == now_.saved_text) continue;
      remember(snapshot());
      do_text(text);
      draft_->take_over(file, text);
      // A file that others have changed since is not saved over without a question.
      if (std::filesystem::last_write_time(file_, unknown) > std::filesystem::last_write_time(file, unknown))
        now_.on_disk = "";
      return;
    } catch (const InputError&) {
      now_ = before;  // no scene: it stays as it is
    }
  }
}

/// The scene, or where there is none that which the text gives, at rest.
ViewSession::State ViewSession::opened(const std::string& text, std::optional<Scene> scene) {
  allow_files_of(text);
  if (!scene) scene = read(text);
  TrackedOptions options;
  options.interrupt = interrupt_;
  ShownMechanism shown(*scene, options);
  auto screen = std::make_shared<Screen>(shown);
  return {.on_disk = text,
          .text = text,
          .scene = std::move(*scene),
          .shown = std::move(shown),
          .screen = std::move(screen)};
}

/// Throws InputError for a scene that is none.
void ViewSession::expect_file() const {
  if (!has_file_) throw InputError("the scene is no file; save its text as one");
}

/// The command line that shows the scene; empty where there is none.
std::string ViewSession::line() const { return has_file_ ? "poise view " + file_.string() : ""; }

/// The command line that finds what is shown in the file, or shows it where none does.
std::string ViewSession::solving_line() const {
  if (!has_file_ || now_.shown.hand()) return line();
  std::vector<std::string> words{"solve", file_.string()};
  if (!rests_stably() && solve_finds_another()) words.insert(words.end(), {"--seek", "any"});
  return line_of(words);
}

bool ViewSession::rests_stably() const {
  return now_.shown.found() && !now_.shown.hand() &&
         now_.shown.at_rest().equilibrium().certificate.stability != Stability::unstable;
}

/// Whether the text leads elsewhere: from an unstable equilibrium, say, it falls where its place is rounded.
bool ViewSession::solve_finds_another() const {
  constexpr double same = 1e-3;  // rad: more than what the text leaves out
  if (!now_.shown.found() || now_.shown.hand()) return false;
  SolveOptions options;
  options.prove = false;
  options.interrupt = interrupt_;
  const StaticModel model(read(present_text()));
  const BodyPoses found = model.poses(solve(model, options).x), shown = now_.shown.poses();
  for (std::size_t b = 1; b < model.scene().bodies.size(); ++b) {
    if (std::abs(std::remainder(found[b].angle - shown[b].angle, 2 * M_PI)) > same) return true;
    if (norm(found[b].origin - shown[b].origin) > same * model.scales().length) return true;
  }
  return false;
}

/// Throws InputError for what is no file: it is looked at again and again, and a pipe would wait for a writer.
/// Nothing where there is no file yet.
std::optional<std::string> ViewSession::text_on_disk() const {
  std::error_code unknown;
  const auto status = std::filesystem::status(file_, unknown);
  const std::filesystem::path folder = std::filesystem::absolute(file_).parent_path();
  if (status.type() == std::filesystem::file_type::not_found && std::filesystem::is_directory(folder, unknown))
    return std::nullopt;
  expect_regular_file(file_);
  return read_text_file(file_);
}

/// Whoever wrote the scene's file may have it read any other.
void ViewSession::allow_files_of(const std::string& text) {
  for (NamedFile& one : named_files(text, file_.string())) allowed_files_.insert(std::move(one.name));
}

/// Reads a text that came from the page, which may name those files that the scene on disk names, or in memory named
/// when it was opened. Where it is on disk, others of its folder may be named too.
Scene ViewSession::read(const std::string& text) const {
  namespace fs = std::filesystem;
  const fs::path folder = fs::weakly_canonical(fs::absolute(file_).parent_path());
  for (const NamedFile& one : named_files(text, file_.string())) {
    if (allowed_files_.contains(one.name)) continue;
    std::error_code failed;
    const fs::path path = fs::weakly_canonical(folder / one.name, failed);
    const bool is_within = has_file_ && !failed &&
                           std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
    if (!is_within && !has_file_) {
      throw InputError(fmt::format("{}:{}: file: expected a file that the scene named when it was opened, found \"{}\"",
                                   file_.string(), one.line, one_line(one.name)));
    }
    if (!is_within) {
      throw InputError(
          fmt::format("{}:{}: file: expected a file in the folder of the scene, found \"{}\"; write others "
                      "into the scene's file on disk",
                      file_.string(), one.line, one_line(one.name)));
    }
  }
  return parse_sketch(text, file_.string());
}

/// A request that was made for another state than the present one would change what whoever sent it has not seen.
void ViewSession::expect_present(const json& request) const {
  const auto revision = request.find("revision");
  if (revision == request.end()) {
    throw InputError(
        fmt::format("revision: expected that of the state which the request is for, now {}", now_.revision));
  }
  if (!revision->is_number_integer() || *revision != now_.revision) {
    throw InputError("the mechanism was changed elsewhere meanwhile, in another window perhaps; nothing was done");
  }
}

std::shared_ptr<const ViewSession::Snapshot> ViewSession::snapshot() const {
  return std::make_shared<const Snapshot>(Snapshot{now_.text, now_.scene, now_.off, now_.shown.poses()});
}

/// Without the items that are switched off.
Scene ViewSession::effective(Scene scene) const { return without_items(std::move(scene), now_.off); }

/// Takes the present position over into the scene with all items.
void ViewSession::sync() { write_start(0); }

void ViewSession::write_start(int finer) {
  const TrackedEquilibrium* const tracked = now_.shown.tracked();
  const Layout* const layout = tracked != nullptr ? &tracked->model().layout() : nullptr;
  now_.scene.start = written_start(now_.shown.scene(), now_.scene.start, size_of_mechanism(), layout, finer);
}

void ViewSession::look_for_others() {
  if (now_.shown.tracked() == nullptr || now_.shown.hand() || searched_ == now_.revision) return;
  searched_ = now_.revision;
  others_.look_for(now_.shown.scene(), now_.revision);
}

std::string ViewSession::present_text() const {
  const std::string text = rewritten_scene(now_.text, file_.string(), now_.scene);
  // Numbers that were added move lines.
  return now_.off.empty() ? text : parked(text, read(text), now_.off);
}

/// Throws InputError where the text cannot leave out what is switched off.
void ViewSession::expect_parked() const {
  const auto count = [](const Scene& scene) {
    return scene.elements.size() + scene.stops.size() + scene.forces.size() + scene.torques.size();
  };
  try {
    if (count(read(present_text())) == count(effective(now_.scene))) return;
  } catch (const InputError&) {
  }
  throw InputError("it has no table on lines of its own in the scene file; take it out of the text");
}

void ViewSession::remember(std::shared_ptr<const Snapshot> before) {
  now_.redo.clear();
  now_.undo.push_back(std::move(before));
  if (now_.undo.size() > most_steps_back) now_.undo.erase(now_.undo.begin());
}

/// From the last of `from` to which `to` then leads back.
void ViewSession::go_back(const std::string& what, Snapshots& from, Snapshots& to) {
  if (from.empty()) throw InputError(fmt::format("there is nothing to {}", what));
  const std::shared_ptr<const Snapshot> last = from.back();
  from.pop_back();
  to.push_back(snapshot());
  now_.text = last->text;
  now_.scene = last->scene;
  now_.off = last->off;
  return_to(last->poses);
}

/// Takes over a scene with all items, whose numbers or items may have changed.
Transition ViewSession::take(Scene scene) {
  Transition out = now_.shown.change(effective(scene));
  now_.scene = std::move(scene);
  sync();
  return out;
}

/// Takes over a scene in which points are elsewhere. The masses that the drawing tools have spread over links follow.
Transition ViewSession::take_shaped(Scene scene, std::optional<double> grain) {
  const double finest =
      std::pow(10.0, std::floor(std::log10(std::max(size_of_mechanism(), 1e-30) / scene.units.length)) - 4);
  const std::vector<std::pair<std::string, TomlKeys>> masses =
      masses_that_follow(now_.scene, scene, grain.value_or(finest * scene.units.length));
  if (masses.empty()) return take(std::move(scene));
  SceneText text(rewritten_scene(now_.text, file_.string(), scene), file_.string());
  for (const std::pair<std::string, TomlKeys>& one : masses) {
    // A body of a part has its table in another file.
    const auto is_body = [&](const SceneItem& item) { return item.name == one.first; };
    if (std::any_of(text.items().begin(), text.items().end(), is_body)) text.set(one.first, one.second);
  }
  return take_edited(text);
}

PointRef ViewSession::point_called(const std::string& name) const {
  std::vector<std::string> names;
  const Scene& scene = now_.shown.scene();
  for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b) {
    const Body& body = scene.bodies[static_cast<std::size_t>(b)];
    for (int p = 0; p < static_cast<int>(body.points.size()); ++p) {
      names.push_back(scene.name_of({b, p}));
      if (names.back() == name) return {b, p};
    }
  }
  throw InputError("point: expected one of the scene" + did_you_mean_or_list(name, names));
}

Transition ViewSession::do_drag(const json& request) {
  const PointRef point = point_called(request.at("point").get<std::string>());
  if (point.body == 0) throw InputError("a point of the ground cannot be dragged along");
  Transition out = now_.shown.drag(point, now_.screen->world(px_of(request)));
  sync();
  return out;
}

void ViewSession::expect_free(const ParameterPlace& place) const {
  for (const ParameterRow& row : parameter_table(now_.scene)) {
    if (row.place == place) check_is_free(now_.scene, row);
  }
}

Transition ViewSession::do_ground(const json& request) {
  const PointRef point = point_called("ground." + request.at("point").get<std::string>());
  Scene wanted = now_.scene;
  for (const int component : {0, 1}) expect_free({Owner::point, 0, point.point, component});
  wanted.bodies[0].points[static_cast<std::size_t>(point.point)].at = now_.screen->world(px_of(request));
  return take(std::move(wanted));
}

Transition ViewSession::do_load(const json& request) {
  const std::string name = request.at("name").get<std::string>();
  Scene wanted = now_.scene;
  const auto load =
      std::find_if(wanted.forces.begin(), wanted.forces.end(), [&](const Force& force) { return force.name == name; });
  if (load == wanted.forces.end()) throw InputError(fmt::format("load: expected one of the scene, found \"{}\"", name));
  expect_free({Owner::force, static_cast<int>(load - wanted.forces.begin())});
  load->vector = now_.screen->pulled(name, px_of(request));
  if (load->follows >= 0) {
    load->vector = load->vector * conj(unit(now_.shown.poses()[static_cast<std::size_t>(load->follows)].angle));
  }
  if (load->has_direction_of_its_own() && !(load->vector == Vec2{})) load->along = direction<double>(load->vector);
  return take(std::move(wanted));
}

Transition ViewSession::do_set(const json& request) {
  Scene wanted = now_.scene;
  set_value(wanted, request.at("path").get<std::string>(), request.at("value").get<double>());
  return take_shaped(std::move(wanted));
}

Transition ViewSession::do_switch(const json& request) {
  const std::string item = request.at("item").get<std::string>();
  const std::vector<SwitchedItem> known = items_of(now_.scene);
  if (std::none_of(known.begin(), known.end(), [&](const SwitchedItem& one) { return one.item == item; })) {
    throw InputError(fmt::format("item: expected one of the scene, found \"{}\"", item));
  }
  if (request.at("on").get<bool>())
    now_.off.erase(item);
  else
    now_.off.insert(item);
  expect_parked();
  return take(now_.scene);
}

Transition ViewSession::do_text(const std::string& text) {
  Scene scene = read(text);
  Transition out;
  if (starts_alike(scene, now_.scene)) {
    out = now_.shown.change(scene);
  } else {
    now_.shown.restore(scene);
    out.kind = Transition::Kind::settled;
    out.why = "released from the start that the scene gives";
  }
  now_.text = text;
  now_.scene = std::move(scene);
  now_.off.clear();
  sync();
  return out;
}

/// Takes over a text whose items were changed here. What stands already stays where it is.
/// What is copied from what is off is off too.
Transition ViewSession::take_edited(const SceneText& edited, const std::vector<ItemCopy>& copies) {
  Scene scene = edited.scene();
  const Scene& before = now_.scene;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const auto known = std::find_if(before.bodies.begin() + 1, before.bodies.end(),
                                    [&](const Body& body) { return body.name == scene.bodies[b].name; });
    if (known == before.bodies.end()) continue;
    const auto at = static_cast<std::size_t>(known - before.bodies.begin());
    scene.start.angle[b] = before.start.angle[at];
    scene.start.position[b] = before.start.position[at];
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const auto known = std::find_if(before.joints.begin(), before.joints.end(),
                                    [&](const Joint& joint) { return joint.name == scene.joints[j].name; });
    if (known != before.joints.end())
      scene.start.travel[j] = before.start.travel[static_cast<std::size_t>(known - before.joints.begin())];
  }
  std::set<std::string> left;
  for (const SwitchedItem& item : items_of(scene)) {
    if (now_.off.contains(item.item)) left.insert(item.item);
  }
  for (const ItemCopy& one : copies) {
    if (now_.off.contains(switched_item(before, one.owner, one.original)))
      left.insert(switched_item(scene, one.owner, one.copy));
  }
  now_.off = std::move(left);
  now_.text = edited.text();
  Transition out = take(std::move(scene));
  if (!copies.empty() && !now_.off.empty()) expect_parked();
  return out;
}

/// Takes over a text in which an item has another name: all stays where it is.
Transition ViewSession::take_renamed(const SceneText& renamed) {
  Scene scene = renamed.scene();
  scene.start = now_.scene.start;
  std::set<std::string> off;
  const std::vector<SwitchedItem> before = items_of(now_.scene), after = items_of(scene);
  for (std::size_t k = 0; k < std::min(before.size(), after.size()); ++k) {
    if (now_.off.contains(before[k].item)) off.insert(after[k].item);
  }
  now_.off = std::move(off);
  now_.text = renamed.text();
  const BodyPoses poses = now_.shown.poses();
  now_.scene = std::move(scene);
  return_to(poses);
  return {};
}

/// Takes over a text in which items are elsewhere, with the guesses of where they are.
Transition ViewSession::take_moved(const SceneText& moved) {
  now_.text = moved.text();
  now_.scene = moved.scene();
  now_.shown.restore(effective(now_.scene));
  sync();
  return {};
}

/// Takes over a text in which items have become a part, or those of a part the scene's own: all stays where it is.
Transition ViewSession::take_regrouped(const SceneText& regrouped, const std::string& part) {
  std::set<std::string> known;
  for (const SwitchedItem& item : items_of(regrouped.scene())) known.insert(item.item);
  for (const std::string& off : now_.off) {
    if (!known.contains(off)) throw InputError(off + ": expected what is switched on in a part; switch it on first");
  }
  const std::vector<Body>& before = now_.scene.bodies;
  const BodyPoses there = now_.shown.poses();
  BodyPoses poses(regrouped.scene().bodies.size());
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const std::string& name = regrouped.scene().bodies[b].name;
    const auto known_as = std::find_if(before.begin(), before.end(), [&](const Body& body) {
      return body.name == name || body.name == fmt::format("{}.{}", part, name) ||
             name == fmt::format("{}.{}", part, body.name);
    });
    if (known_as != before.end()) poses[b] = there[static_cast<std::size_t>(known_as - before.begin())];
  }
  now_.text = regrouped.text();
  now_.scene = regrouped.scene();
  return_to(poses);
  return {};
}

/// Takes the mechanism of the scene to where it stood, stable or not.
void ViewSession::return_to(const BodyPoses& poses) {
  now_.shown.restore(effective(now_.scene));
  if (now_.shown.poses().size() == poses.size()) {
    try {
      now_.shown.stay_at(poses);
    } catch (const InputError&) {
      // It rested nowhere there either.
    }
  }
  sync();
}

/// The text with all items, also those that are switched off.
SceneText ViewSession::whole_text() const {
  return {rewritten_scene(now_.text, file_.string(), now_.scene), file_.string()};
}

Transition ViewSession::do_draw(const json& request) {
  const double unit = now_.scene.units.length;
  Drawn drawn;
  drawn.tool = request.at("tool").get<std::string>();
  const auto places = [&](const json& list) {
    std::vector<Vec2> out;
    for (const json& place : list) out.push_back(unit * Vec2{place.at(0).get<double>(), place.at(1).get<double>()});
    return out;
  };
  drawn.places = places(request.at("at"));
  drawn.pressed = request.contains("pressed") ? places(request.at("pressed")) : drawn.places;
  if (drawn.pressed.size() != drawn.places.size()) throw InputError("pressed: expected as many places as in \"at\"");
  drawn.is_typed.assign(drawn.places.size(), false);
  for (const json& typed : request.value("typed", json::array())) {
    const auto at = typed.get<std::size_t>();
    if (at < drawn.is_typed.size()) drawn.is_typed[at] = true;
  }
  drawn.within = unit * request.at("within").get<double>();
  drawn.grain = unit * request.at("grain").get<double>();
  if (!(drawn.within >= 0.0)) throw InputError("within: expected a length of 0 or more");
  if (!(drawn.grain > 0.0)) throw InputError("grain: expected a length above 0");
  if (request.contains("values")) drawn.values = toml_values(request.at("values"));
  SceneText text = whole_text();
  draw(text, now_.shown.poses(), drawn);
  return take_edited(text);
}

Transition ViewSession::do_items(const std::string& what, const json& request) {
  SceneText text = whole_text();
  if (what == "remove") {
    text.remove(request.at("items").get<std::vector<std::string>>());
  } else if (what == "rename") {
    text.rename(request.at("item").get<std::string>(), request.at("name").get<std::string>());
    return take_renamed(text);
  } else if (what == "copy") {
    const std::vector<ItemCopy> copies =
        text.copy(request.at("items").get<std::vector<std::string>>(),
                  requested_motion(request, now_.scene.units.angle), request.value("times", 1));
    return take_edited(text, copies);
  } else if (what == "move") {
    text.move(request.at("items").get<std::vector<std::string>>(), requested_motion(request, now_.scene.units.angle));
    return take_moved(text);
  } else if (what == "ungroup") {
    const std::string part = request.at("part").get<std::string>();
    return take_regrouped({text.ungrouped(part), file_.string()}, part);
  } else {
    const std::map<std::string, std::string> values = toml_values(request.at("values"));
    text.set(request.at("item").get<std::string>(), {values.begin(), values.end()});
  }
  return take_edited(text);
}

Transition ViewSession::do_group(const json& request) {
  expect_file();
  const SceneText text = whole_text();
  PartFile part(file_, request.value("name", ""), text.parts());
  const GroupedText grouped =
      text.grouped(request.at("items").get<std::vector<std::string>>(), part.name(), part.file());
  part.write(grouped.part);
  try {
    return take_regrouped({grouped.scene, file_.string()}, part.name());
  } catch (...) {
    part.remove();
    throw;
  }
}

/// Moves a point, with all that joints keep at its place, within the bodies that have them.
Transition ViewSession::do_place(const json& request) {
  const double unit = now_.scene.units.length;
  const PointRef point = point_called(request.at("point").get<std::string>());
  const json& at = request.at("at");
  const Vec2 place = unit * Vec2{at.at(0).get<double>(), at.at(1).get<double>()};
  std::vector<PointRef> together{point};
  for (std::size_t k = 0; k < together.size(); ++k) {
    for (const Joint& joint : now_.scene.joints) {
      if (joint.has_travel() || joint.keeps_length()) continue;
      for (const auto& [one, other] : {std::pair(joint.a, joint.b), std::pair(joint.b, joint.a)}) {
        if (one == together[k] && std::find(together.begin(), together.end(), other) == together.end())
          together.push_back(other);
      }
    }
  }
  std::optional<double> grain;
  if (request.contains("grain")) grain = unit * request.at("grain").get<double>();
  const BodyPoses poses = now_.shown.poses();
  Scene wanted = now_.scene;
  for (const PointRef& one : together) {
    for (const int component : {0, 1}) expect_free({Owner::point, one.body, one.point, component});
    const BodyPose<double>& pose = poses[static_cast<std::size_t>(one.body)];
    Vec2 local = (place - pose.origin) * conj(pose.direction());
    if (grain) local = {std::round(local.x / *grain) * *grain, std::round(local.y / *grain) * *grain};
    wanted.bodies[static_cast<std::size_t>(one.body)].points[static_cast<std::size_t>(one.point)].at = local;
  }
  return take_shaped(std::move(wanted), grain);
}

Transition ViewSession::do_go(const json& request) {
  const std::optional<OtherEquilibria::Found> found = others_.found();
  const json& number = request.at("number");
  if (!number.is_number_unsigned()) throw InputError("number: expected that of an equilibrium, 0, 1, ...");
  const auto at = number.get<std::size_t>();
  if (!found || at >= found->poses.size()) throw InputError("that equilibrium is not known any more");
  now_.shown.stay_at(found->poses[at]);
  sync();
  Transition out;
  out.kind = Transition::Kind::settled;
  out.why = "taken there";
  return out;
}

Transition ViewSession::do_save(const json& request) {
  const bool anyway = request.value("anyway", false);
  expect_file();
  expect_regular_file(file_);
  const std::optional<std::string> there = text_on_disk();
  if (!anyway && there && there != now_.on_disk) {
    throw InputError("changed on disk: the file is no longer as it was read; reload it, or save all the same");
  }
  // A place next to a border between two equilibria needs more digits than a person would write.
  for (const int finer : {3, 6, 9}) {
    if (!rests_stably() || !solve_finds_another()) break;
    write_start(finer);
  }
  const std::string text = present_text();
  now_.on_disk = now_.text = text;
  now_.scene = read(text);
  now_.off.clear();
  return_to(now_.shown.poses());
  now_.saved_text = present_text();
  Transition way;
  if (!rests_stably() && solve_finds_another()) way.why = solve_differs;
  OutputFile out(file_, "save");
  out.prepare(text);
  out.commit();
  return way;
}

Transition ViewSession::carry_out(const std::string& what, const json& request) {
  if (what == "drag") return do_drag(request);
  if (what == "ground") return do_ground(request);
  if (what == "load") return do_load(request);
  if (what == "set") return do_set(request);
  if (what == "switch") return do_switch(request);
  if (what == "text") {
    Transition out = do_text(request.at("text").get<std::string>());
    if (request.value("fit", false)) now_.screen = std::make_shared<Screen>(now_.shown);
    return out;
  }
  if (what == "import") return do_text(imported_text(request));
  if (what == "go") return do_go(request);
  if (what == "draw") return do_draw(request);
  if (what == "place") return do_place(request);
  if (what == "group") return do_group(request);
  if (what == "remove" || what == "rename" || what == "keys" || what == "copy" || what == "move" || what == "ungroup")
    return do_items(what, request);
  Transition out;
  if (what == "release") {
    out = now_.shown.release();
    sync();
  } else if (what == "reload") {
    expect_file();
    const std::string text = text_on_disk().value_or(now_.text);
    allow_files_of(text);
    out = do_text(text);
    now_.on_disk = text;
    now_.saved_text = present_text();
  } else if (what == "undo") {
    go_back(what, now_.undo, now_.redo);
  } else if (what == "redo") {
    go_back(what, now_.redo, now_.undo);
  } else if (what == "save") {
    return do_save(request);
  } else if (what != "look") {
    throw InputError(fmt::format("unknown request \"{}\"", one_line(what)));
  }
  return out;
}

/// The answer to a request that leaves the mechanism alone, in JSON; empty where it is none of these.
std::string ViewSession::answer_beside(const json& request, const std::string& what) {
  if (what == "templates" || what == "export") {
    json out = what == "templates" ? answer_templates(request)
                                   : exported_json(request, now_.shown.scene(), now_.shown.poses());
    out["revision"] = now_.revision;
    return out.dump(-1, ' ', false, json::error_handler_t::replace);
  }
  if (!PageCommands::takes(what)) return "";
  ShownScene shown{.text = {}, .file = file_, .has_file = has_file_, .is_saved = true, .revision = now_.revision};
  if (what == "run") {
    expect_present(request);
    shown.text = present_text();
    shown.is_saved = has_file_ && shown.text == now_.saved_text && text_on_disk() == now_.on_disk;
    read(shown.text);  // names no file that the page may not read
  }
  return commands_.answer(request, shown);
}

/// The state in JSON; returns its drawing.
std::string ViewSession::answered(const std::string& what, const json& request, json& out) {
  if (what != "look") expect_present(request);
  // What a slider or an arrow does in one go is one step for undo.
  const std::string gesture = what == "set"      ? "set " + request.value("path", "")
                              : what == "load"   ? "load " + request.value("name", "")
                              : what == "ground" ? "ground " + request.value("point", "")
                              : what == "place"  ? "place " + request.value("point", "")
                                                 : what;
  const bool goes_on = request.value("goes_on", false);
  const Parts parts = goes_on || what == "drag" ? Parts::moving : Parts::all;
  const std::vector<std::optional<double>> values_before =
      parts == Parts::moving && what != "drag" ? parameter_values(now_.scene) : std::vector<std::optional<double>>();
  const bool is_step = changes_scene(what) && !(now_.in_gesture && gesture == now_.gesture);
  const std::shared_ptr<const Snapshot> before = is_step ? snapshot() : nullptr;
  const Transition transition = carry_out(what, request);
  if (before) remember(before);
  if (what != "look") {
    now_.gesture = gesture;
    now_.in_gesture = goes_on;
    ++now_.revision;
  }
  out = shown(transition, parts);
  if (!values_before.empty()) out["changed"] = changed_from(values_before);
  std::string drawing = drawing_json(now_.screen->drawing(now_.shown, transition, what == "load"));
  out["handles"] = handles();
  if (parts == Parts::all)
    look_for_others();
  else
    others_.give_up();
  return drawing;
}

std::string ViewSession::act(const json& request) {
  const auto begin = std::chrono::steady_clock::now();
  const State before = now_;
  const auto go_back_to_before = [&] {
    now_ = before;
    // Places that the page sends next are those of the drawing that it has.
    now_.screen->drawing(now_.shown, {}, now_.in_gesture);
  };
  json out;
  std::string drawing, what;
  const auto refuse = [&](const std::string& why, const std::optional<int>& line) {
    go_back_to_before();
    out = {{"error", {{"text", why}, {"of", what}, {"line", line ? json(*line) : json(nullptr)}}},
           {"revision", now_.revision}};
  };
  try {
    what = request.value("do", "");
    if (std::string beside = answer_beside(request, what); !beside.empty()) return beside;
    drawing = answered(what, request, out);
  } catch (const InputError& error) {
    refuse(error.what(), line_in(error.what(), file_.string()));
  } catch (const json::exception&) {
    refuse("the request lacks something, or has it in another form", std::nullopt);
  } catch (...) {
    go_back_to_before();
    throw;
  }
  // Where a mechanism was only moved nothing would be lost.
  if (draft_ && out.contains("text")) {
    if (out["saved"] || now_.undo.empty())
      draft_->remove();
    else
      draft_->keep(out["text"]);
  }
  out["server_ms"] = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return with_drawing(out, drawing);
}

std::string ViewSession::title() const {
  return now_.scene.title.empty() ? file_.filename().string() : now_.scene.title;
}

double ViewSession::size_of_mechanism() const {
  const TrackedEquilibrium* const tracked = now_.shown.tracked();
  return tracked != nullptr ? tracked->model().scales().length : now_.screen->size();
}

json ViewSession::page() {
  Result nothing;
  nothing.title = title();
  nothing.source = now_.scene.source;
  json out = page_document(nothing, {.command = "view", .line = line()}, {});
  out["result"] = nullptr;
  json tools = json::array();
  for (const DrawingTool& tool : drawing_tools()) {
    tools.push_back({{"name", tool.name},
                     {"title", tool.title},
                     {"group", tool.group},
                     {"picks", tool.picks.size()},
                     {"more", tool.more},
                     {"direction", tool.picks.back() == Pick::direction},
                     {"hint", tool.hint}});
  }
  json& view = out["view"] = shown({}, Parts::all);
  view["tools"] = std::move(tools);
  view["exchange"] = exchange_json();
  view["drawing"] = json::parse(drawing_json(now_.screen->drawing(now_.shown, {}, false)));
  view["handles"] = handles();
  return out;
}

/// What is found of the mechanism; of a sketch what is missing.
json ViewSession::verdict_json() const {
  const TrackedEquilibrium* const tracked = now_.shown.tracked();
  if (tracked == nullptr) {
    Result sketch;
    sketch.title = title();
    sketch.verdict = {"", "A sketch: " + now_.shown.missing() + ".", Tone::plain};
    return report_json(sketch);
  }
  Answer answer;
  answer.equilibrium = tracked->equilibrium();
  answer.readings = read_off(tracked->model(), answer.equilibrium.x);
  return report_json(solve_result(tracked->model(), answer, {}, nullptr, {}, stable_in_page));
}

json ViewSession::shown(const Transition& transition, Parts parts) {
  if (parts == Parts::all && !now_.shown.hand() && !now_.screen->shows(now_.shown))
    now_.screen = std::make_shared<Screen>(now_.shown);
  json out = verdict_json();
  out["revision"] = now_.revision;
  out["transition"] = {{"kind", to_string(transition.kind)},
                       {"why", transition.why},
                       {"passed", transition.passed},
                       {"unfinished", transition.unfinished}};
  out["hand"] = hand();
  out["undo"] = now_.undo.size();
  out["redo"] = now_.redo.size();
  if (parts == Parts::moving) return out;
  out["numbers"] = numbers();
  out["switches"] = switches();
  out["items"] = items();
  out["sheet"] = sheet();
  out["position"] = position();
  out["missing"] = now_.shown.missing();
  out["title"] = title();
  out["source"] = now_.scene.source;
  out["text"] = present_text();
  out["file"] = file_.filename().string();
  out["has_file"] = has_file_;
  out["draft"] = draft_ && draft_->is_taken_over();
  out["saved"] = out["text"] == now_.saved_text;
  return out;
}

json ViewSession::numbers() const {
  static const std::vector<std::string> order = {"numbers", "loads",      "gravity", "springs", "dampers",
                                                 "stops",   "dimensions", "masses",  "others"};
  const double size = size_of_mechanism();
  std::map<std::string, std::vector<json>> groups;
  const std::vector<ParameterRow> rows = parameter_table(now_.scene);
  const std::vector<std::optional<double>> values = parameter_values(now_.scene);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterRow& row = rows[i];
    const std::optional<double>& si = values[i];
    if (!counts_in_statics(row.place.owner)) continue;
    // What follows from a named number moves with its slider.
    if (!si || !std::isfinite(*si) || dependent_number(now_.scene, row.place) != nullptr) continue;
    const double unit = row.dimension.unit(now_.scene.units);
    const auto [low, high] = slider(row, *si, size);
    const std::string path = row.path.text();
    groups[group_of(row, now_.scene)].push_back({{"path", path},
                                                 {"group", group_of(row, now_.scene)},
                                                 {"name", path.substr(path.find('.') + 1)},
                                                 {"value", *si / unit},
                                                 {"unit", row.dimension.unit_name(now_.scene.units)},
                                                 {"low", low / unit},
                                                 {"high", high / unit}});
  }
  json out = json::array();
  for (const std::string& group : order) {
    for (json& number : groups[group]) out.push_back(std::move(number));
  }
  return out;
}

/// The numbers that a gesture has changed, so that their fields follow it.
json ViewSession::changed_from(const std::vector<std::optional<double>>& before) const {
  json out = json::array();
  const std::vector<std::optional<double>> now = parameter_values(now_.scene);
  if (now == before || now.size() != before.size()) return out;
  const std::vector<ParameterRow> rows = parameter_table(now_.scene);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!now[i] || now[i] == before[i] || !counts_in_statics(rows[i].place.owner)) continue;
    out.push_back({{"path", rows[i].path.text()}, {"value", *now[i] / rows[i].dimension.unit(now_.scene.units)}});
  }
  return out;
}

json ViewSession::switches() const {
  json out = json::array();
  for (const SwitchedItem& one : items_of(now_.scene)) {
    out.push_back({{"item", one.item}, {"group", one.group}, {"name", one.name}, {"on", !now_.off.contains(one.item)}});
  }
  return out;
}

/// What can be renamed and taken away, by the names that the picture has.
json ViewSession::items() {
  json out = json::array();
  if (!now_.parsed || now_.parsed->text() != now_.text)
    now_.parsed = std::make_shared<const SceneText>(now_.text, file_.string());
  for (const SceneItem& item : now_.parsed->items()) {
    if (item.owner == Owner::body && item.index == 0) continue;
    const bool is_point = item.owner == Owner::point;
    out.push_back({{"item", item.name}, {"name", item.own_name}, {"point", is_point}, {"part", false}});
  }
  for (const std::string& part : now_.parsed->parts())
    out.push_back({{"item", "part " + part}, {"name", part}, {"point", false}, {"part", true}});
  return out;
}

/// Angles of bodies and travels of joints as they are shown, in the units of the scene: the text has them rounded.
json ViewSession::position() const {
  const Scene& scene = now_.shown.scene();
  json out = json::object();
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    if (scene.start.angle[b]) out[scene.bodies[b].name] = *scene.start.angle[b] / scene.units.angle;
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.start.travel[j]) out[scene.joints[j].name] = *scene.start.travel[j] / scene.units.length;
  }
  return out;
}

/// Where the plane of the scene is on the page, and all points in it.
json ViewSession::sheet() const {
  const double unit = now_.scene.units.length;
  const Vec2 origin = now_.screen->px({}), one = now_.screen->px({unit, 0.0});
  json points = json::array();
  const Scene& scene = now_.shown.scene();
  const BodyPoses poses = now_.shown.poses();
  const std::vector<PointRef> used = used_of_ground(scene);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    for (const NamedPoint& point : scene.bodies[b].points) {
      const Vec2 at = poses[b].world(point.at);
      const PointRef ref{static_cast<int>(b), static_cast<int>(&point - scene.bodies[b].points.data())};
      const bool is_loose = b == 0 && std::find(used.begin(), used.end(), ref) == used.end();
      points.push_back(
          {{"name", scene.bodies[b].name + "." + point.name}, {"at", {at.x / unit, at.y / unit}}, {"loose", is_loose}});
    }
  }
  return {{"origin", {origin.x, origin.y}},
          {"scale", one.x - origin.x},
          {"unit", now_.scene.units.length_name},
          {"angle", now_.scene.units.angle_name},
          {"points", points}};
}

json ViewSession::handles() const {
  const Scene& scene = now_.shown.scene();
  const BodyPoses poses = now_.shown.poses();
  json out = json::array();
  std::vector<Vec2> taken;
  const auto add = [&](const char* kind, const std::string& name, PointRef point) {
    const Vec2 px = now_.screen->px(poses[static_cast<std::size_t>(point.body)].world(scene.local(point)));
    // One handle for points that a joint keeps together.
    constexpr double same = 0.5;
    if (std::any_of(taken.begin(), taken.end(), [&](Vec2 other) { return norm(other - px) < same; })) return;
    taken.push_back(px);
    out.push_back({{"kind", kind}, {"name", name}, {"px", {px.x, px.y}}});
  };
  if (now_.shown.hand()) add("point", scene.name_of(*now_.shown.hand()), *now_.shown.hand());
  // Of the ground those points on which something rests or pulls.
  for (const PointRef& point : used_of_ground(scene))
    add("ground", scene.bodies[0].points[static_cast<std::size_t>(point.point)].name, point);
  for (int b = 1; now_.shown.can_be_dragged() && b < static_cast<int>(scene.bodies.size()); ++b) {
    for (int p = 0; p < static_cast<int>(scene.bodies[static_cast<std::size_t>(b)].points.size()); ++p) {
      add("point", scene.name_of({b, p}), {b, p});
    }
  }
  for (const Screen::LoadArrow& load : now_.screen->loads()) {
    out.push_back(
        {{"kind", "load"}, {"name", load.name}, {"px", {load.far.x, load.far.y}}, {"tail", {load.at.x, load.at.y}}});
  }
  return out;
}

json ViewSession::hand() const {
  if (!now_.shown.hand()) return nullptr;
  const TrackedEquilibrium& tracked = now_.shown.at_rest();
  const std::string name = tracked.scene().name_of(*tracked.hand());
  const double radius =
      resultant_of_stops(tracked.equilibrium().check.reactions, tracked.scene().stops.size(), tracked.hand_stops())
          .radius;
  const std::string text = with_unit(tracked.model(), norm(tracked.force_of_hand()), Quantity::force, 4, radius);
  return {{"point", name},
          {"force", text},
          {"text", fmt::format("held at {} with {}", name, text)},
          {"stops", toml_of_hand(tracked)}};
}

json ViewSession::others_json(const OtherEquilibria::Found& found) const {
  json out = {{"revision", found.revision},
              {"claim", to_string(found.set.claim)},
              {"statement", found.set.statement + "."},
              {"drawing", json::parse(drawing_json(now_.screen->others(found)))},
              {"equilibria", json::array()}};
  const BodyPoses now = now_.shown.poses();
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const Equilibrium& one = found.set.equilibria[k];
    const Stability stability = one.certificate.stability;
    const std::string caption = fmt::format("{}: {}", k + 1, stability_and_energy(now_.shown.at_rest().model(), one));
    out["equilibria"].push_back({{"caption", caption},
                                 {"tone", stability == Stability::stable ? "good" : "bad"},
                                 {"stable", stability == Stability::stable},
                                 {"here", same_position(found, k, now)}});
  }
  return out;
}

json ViewSession::poll(long revision) {
  json out = {{"revision", now_.revision},
              {"others", nullptr},
              {"file", "same"},
              {"company", draft_ && draft_->has_company()},
              {"searching", others_.searching()}};
  try {
    const std::optional<std::string> there = has_file_ ? text_on_disk() : now_.on_disk;
    if (there != now_.on_disk) out["file"] = there ? "changed" : "gone";
  } catch (const InputError&) {
    out["file"] = "gone";
  }
  const std::optional<OtherEquilibria::Found> found = others_.found();
  if (found && found->revision > revision && now_.shown.tracked() != nullptr) out["others"] = others_json(*found);
  return out;
}

std::string ViewSession::report() const {
  const TrackedEquilibrium& tracked = now_.shown.at_rest();
  Answer answer = measure(tracked.model(), tracked.equilibrium());
  const Result result = solve_result(tracked.model(), answer, {});
  return html_page(page_document(result, {.command = "solve", .line = solving_line()}, {Screen::figure(now_.shown)}));
}

}  // namespace poise::app
