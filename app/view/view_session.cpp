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

#include "app/draw/figure_json.hpp"
#include "app/present/document.hpp"
#include "app/present/html.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/solve.hpp"
#include "app/terminal/output_file.hpp"
#include "app/view/parked_items.hpp"
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
  constexpr std::array<std::string_view, 6> changing = {"ground", "load", "set", "switch", "text", "reload"};
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
    : file_(std::move(file)), interrupt_(interrupt), now_(opened(text_on_disk(), std::nullopt)) {
  begin();
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
  look_for_others();
}

/// The scene, or where there is none that which the text gives, at rest.
ViewSession::State ViewSession::opened(const std::string& text, std::optional<Scene> scene) {
  allow_files_of(text);
  if (!scene) scene = read(text);
  TrackedOptions options;
  options.interrupt = interrupt_;
  TrackedEquilibrium tracked(*scene, options);
  auto screen = std::make_shared<Screen>(tracked);
  return {.on_disk = text,
          .text = text,
          .scene = std::move(*scene),
          .tracked = std::move(tracked),
          .screen = std::move(screen)};
}

/// Throws InputError for a scene that is none.
void ViewSession::expect_file() const {
  if (!has_file_) throw InputError("the scene is no file; save its text as one");
}

/// The command line that shows the scene; empty where there is none.
std::string ViewSession::line() const { return has_file_ ? "poise view " + file_.string() : ""; }

/// Throws InputError for what is no file: it is looked at again and again, and a pipe would wait for a writer.
std::string ViewSession::text_on_disk() const {
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
  return parse_scene(text, file_.string());
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
  return std::make_shared<const Snapshot>(Snapshot{now_.text, now_.scene, now_.off});
}

/// Without the items that are switched off.
Scene ViewSession::effective(Scene scene) const { return without_items(std::move(scene), now_.off); }

/// Takes the present position over into the scene with all items.
void ViewSession::sync() { now_.scene.start = now_.tracked.scene().start; }

void ViewSession::look_for_others() {
  if (now_.tracked.hand() || searched_ == now_.revision) return;
  searched_ = now_.revision;
  others_.look_for(now_.tracked.scene(), now_.revision);
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
  now_.tracked.restore(without_items(last->scene, last->off));
  now_.text = last->text;
  now_.scene = last->scene;
  now_.off = last->off;
  sync();
}

/// Takes over a scene with all items, whose numbers or items may have changed.
Transition ViewSession::take(Scene scene) {
  Transition out = now_.tracked.change(effective(scene));
  now_.scene = std::move(scene);
  sync();
  return out;
}

PointRef ViewSession::point_called(const std::string& name) const {
  std::vector<std::string> names;
  const Scene& scene = now_.tracked.scene();
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
  Transition out = now_.tracked.drag(point, now_.screen->world(px_of(request)));
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
    load->vector = load->vector * conj(unit(now_.tracked.poses()[static_cast<std::size_t>(load->follows)].angle));
  }
  if (load->has_direction_of_its_own() && !(load->vector == Vec2{})) load->along = direction<double>(load->vector);
  return take(std::move(wanted));
}

Transition ViewSession::do_set(const json& request) {
  Scene wanted = now_.scene;
  set_value(wanted, request.at("path").get<std::string>(), request.at("value").get<double>());
  return take(std::move(wanted));
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
    out = now_.tracked.change(scene);
  } else {
    now_.tracked.restore(scene);
    out.kind = Transition::Kind::settled;
    out.why = "released from the start that the scene gives";
  }
  now_.text = text;
  now_.scene = std::move(scene);
  now_.off.clear();
  sync();
  return out;
}

Transition ViewSession::do_go(const json& request) {
  const std::optional<OtherEquilibria::Found> found = others_.found();
  const json& number = request.at("number");
  if (!number.is_number_unsigned()) throw InputError("number: expected that of an equilibrium, 0, 1, ...");
  const auto at = number.get<std::size_t>();
  if (!found || at >= found->poses.size()) throw InputError("that equilibrium is not known any more");
  now_.tracked.stay_at(found->poses[at]);
  sync();
  Transition out;
  out.kind = Transition::Kind::settled;
  out.why = "taken there";
  return out;
}

void ViewSession::do_save(const json& request) {
  const bool anyway = request.value("anyway", false);
  expect_file();
  expect_regular_file(file_);
  std::error_code unknown;
  if (!anyway && std::filesystem::exists(file_, unknown) && text_on_disk() != now_.on_disk) {
    throw InputError("changed on disk: the file is no longer as it was read; reload it, or save all the same");
  }
  const std::string text = present_text();
  now_.on_disk = now_.text = text;
  now_.scene = read(text);
  now_.off.clear();
  now_.tracked.restore(now_.scene);
  sync();
  now_.saved_text = present_text();
  OutputFile out(file_, "save");
  out.prepare(text);
  out.commit();
}

Transition ViewSession::carry_out(const std::string& what, const json& request) {
  if (what == "drag") return do_drag(request);
  if (what == "ground") return do_ground(request);
  if (what == "load") return do_load(request);
  if (what == "set") return do_set(request);
  if (what == "switch") return do_switch(request);
  if (what == "text") return do_text(request.at("text").get<std::string>());
  if (what == "go") return do_go(request);
  Transition out;
  if (what == "release") {
    out = now_.tracked.release();
    sync();
  } else if (what == "reload") {
    expect_file();
    const std::string text = text_on_disk();
    allow_files_of(text);
    out = do_text(text);
    now_.on_disk = text;
    now_.saved_text = present_text();
  } else if (what == "undo") {
    go_back(what, now_.undo, now_.redo);
  } else if (what == "redo") {
    go_back(what, now_.redo, now_.undo);
  } else if (what == "save") {
    do_save(request);
  } else if (what != "look") {
    throw InputError(fmt::format("unknown request \"{}\"", one_line(what)));
  }
  return out;
}

/// The state in JSON with its drawing.
std::string ViewSession::answered(const std::string& what, const json& request, json& out) {
  if (what != "look") expect_present(request);
  // What a slider or an arrow does in one go is one step for undo.
  const std::string gesture = what == "set"      ? "set " + request.value("path", "")
                              : what == "load"   ? "load " + request.value("name", "")
                              : what == "ground" ? "ground " + request.value("point", "")
                                                 : what;
  const bool goes_on = request.value("goes_on", false);
  const Parts parts = goes_on || what == "drag" ? Parts::moving : Parts::all;
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
  std::string drawing = drawing_json(now_.screen->drawing(now_.tracked, transition, what == "load"));
  out["handles"] = handles();
  if (parts == Parts::all) look_for_others();
  return drawing;
}

std::string ViewSession::act(const json& request) {
  const auto begin = std::chrono::steady_clock::now();
  const State before = now_;
  const auto go_back_to_before = [&] {
    now_ = before;
    // Places that the page sends next are those of the drawing that it has.
    now_.screen->drawing(now_.tracked, {}, now_.in_gesture);
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
    drawing = answered(what, request, out);
  } catch (const InputError& error) {
    refuse(error.what(), line_in(error.what(), file_.string()));
  } catch (const json::exception&) {
    refuse("the request lacks something, or has it in another form", std::nullopt);
  } catch (...) {
    go_back_to_before();
    throw;
  }
  out["server_ms"] = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return with_drawing(out, drawing);
}

json ViewSession::page() {
  Result nothing;
  nothing.title = now_.scene.title.empty() ? file_.filename().string() : now_.scene.title;
  nothing.source = now_.scene.source;
  json out = page_document(nothing, {.command = "view", .line = line()}, {});
  out["result"] = nullptr;
  json& view = out["view"] = shown({}, Parts::all);
  view["drawing"] = json::parse(drawing_json(now_.screen->drawing(now_.tracked, {}, false)));
  view["handles"] = handles();
  return out;
}

json ViewSession::shown(const Transition& transition, Parts parts) {
  if (parts == Parts::all && !now_.tracked.hand() && !now_.screen->shows(now_.tracked))
    now_.screen = std::make_shared<Screen>(now_.tracked);
  Answer answer;
  answer.equilibrium = now_.tracked.equilibrium();
  answer.readings = read_off(now_.tracked.model(), answer.equilibrium.x);
  json out = report_json(solve_result(now_.tracked.model(), answer, {}));
  out["revision"] = now_.revision;
  out["transition"] = {{"kind", to_string(transition.kind)}, {"why", transition.why}, {"passed", transition.passed}};
  out["hand"] = hand();
  out["undo"] = now_.undo.size();
  out["redo"] = now_.redo.size();
  if (parts == Parts::moving) return out;
  out["numbers"] = numbers();
  out["switches"] = switches();
  out["text"] = present_text();
  out["file"] = file_.filename().string();
  out["has_file"] = has_file_;
  out["saved"] = out["text"] == now_.saved_text;
  return out;
}

json ViewSession::numbers() const {
  static const std::vector<std::string> order = {"numbers", "loads",      "gravity", "springs", "dampers",
                                                 "stops",   "dimensions", "masses",  "others"};
  const double size = now_.tracked.model().scales().length;
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

json ViewSession::switches() const {
  json out = json::array();
  for (const SwitchedItem& one : items_of(now_.scene)) {
    out.push_back({{"item", one.item}, {"group", one.group}, {"name", one.name}, {"on", !now_.off.contains(one.item)}});
  }
  return out;
}

json ViewSession::handles() const {
  const Scene& scene = now_.tracked.scene();
  const BodyPoses poses = now_.tracked.poses();
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
  if (now_.tracked.hand()) add("point", scene.name_of(*now_.tracked.hand()), *now_.tracked.hand());
  // Of the ground those points on which something rests or pulls.
  for (const PointRef& point : used_of_ground(scene))
    add("ground", scene.bodies[0].points[static_cast<std::size_t>(point.point)].name, point);
  for (int b = 1; b < static_cast<int>(scene.bodies.size()); ++b) {
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
  if (!now_.tracked.hand()) return nullptr;
  const std::string name = now_.tracked.scene().name_of(*now_.tracked.hand());
  const double radius = resultant_of_stops(now_.tracked.equilibrium().check.reactions,
                                           now_.tracked.scene().stops.size(), now_.tracked.hand_stops())
                            .radius;
  const std::string text =
      with_unit(now_.tracked.model(), norm(now_.tracked.force_of_hand()), Quantity::force, 4, radius);
  return {{"point", name},
          {"force", text},
          {"text", fmt::format("held at {} with {}", name, text)},
          {"stops", toml_of_hand(now_.tracked)}};
}

json ViewSession::others_json(const OtherEquilibria::Found& found) const {
  json out = {{"revision", found.revision},
              {"claim", to_string(found.set.claim)},
              {"statement", found.set.statement + "."},
              {"drawing", json::parse(drawing_json(now_.screen->others(found)))},
              {"equilibria", json::array()}};
  const BodyPoses now = now_.tracked.poses();
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const Equilibrium& one = found.set.equilibria[k];
    const Stability stability = one.certificate.stability;
    const std::string caption = fmt::format("{}: {}", k + 1, stability_and_energy(now_.tracked.model(), one));
    out["equilibria"].push_back({{"caption", caption},
                                 {"tone", stability == Stability::stable ? "good" : "bad"},
                                 {"stable", stability == Stability::stable},
                                 {"here", same_position(found, k, now)}});
  }
  return out;
}

json ViewSession::poll(long revision) {
  json out = {{"revision", now_.revision}, {"others", nullptr}, {"file", "same"}, {"searching", others_.searching()}};
  try {
    if (has_file_ && text_on_disk() != now_.on_disk) out["file"] = "changed";
  } catch (const InputError&) {
    out["file"] = "gone";
  }
  const std::optional<OtherEquilibria::Found> found = others_.found();
  if (found && found->revision > revision) out["others"] = others_json(*found);
  return out;
}

std::string ViewSession::report() const {
  Answer answer = measure(now_.tracked.model(), now_.tracked.equilibrium());
  const Result result = solve_result(now_.tracked.model(), answer, {});
  return html_page(page_document(result, {.command = "solve", .line = line()}, {Screen::figure(now_.tracked)}));
}

}  // namespace poise::app
