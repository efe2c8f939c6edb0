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
#include "model/nearest_name.hpp"
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
  if (row.place.owner == Owner::force || !signed_number) return {0.0, 2.0 * reach};
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
  const Scene& scene = tracked.held_scene();
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

ViewSession::ViewSession(std::filesystem::path file) : file_(std::move(file)) {
  on_disk_ = text_ = read_text_file(file_);
  scene_ = parse_scene(text_, file_.string());
  tracked_ = std::make_unique<TrackedEquilibrium>(scene_);
  screen_ = std::make_unique<Screen>(*tracked_);
  sync();
  saved_text_ = present_text();
  look_for_others();
}

/// Without the items that are switched off.
Scene ViewSession::effective(Scene scene) const { return without_items(std::move(scene), off_); }

/// Takes the present position over into the scene with all items.
void ViewSession::sync() { scene_.start = tracked_->scene().start; }

void ViewSession::look_for_others() {
  if (tracked_->hand() || searched_ == revision_) return;
  searched_ = revision_;
  others_.look_for(tracked_->scene(), revision_);
}

std::string ViewSession::present_text() const {
  const std::string text = rewritten_scene(text_, file_.string(), scene_);
  // Numbers that were added move lines.
  return off_.empty() ? text : parked(text, parse_scene(text, file_.string()), off_);
}

/// Throws InputError where the text cannot leave out what is switched off.
void ViewSession::expect_parked() const {
  const auto count = [](const Scene& scene) {
    return scene.elements.size() + scene.stops.size() + scene.forces.size() + scene.torques.size();
  };
  try {
    if (count(parse_scene(present_text(), file_.string())) == count(effective(scene_))) return;
  } catch (const InputError&) {
  }
  throw InputError("it has no table on lines of its own in the scene file; take it out of the text");
}

void ViewSession::remember(Snapshot before) {
  redo_.clear();
  undo_.push_back(std::move(before));
  if (undo_.size() > most_steps_back) undo_.erase(undo_.begin());
}

/// From the last of `from` to which `to` then leads back.
void ViewSession::go_back(const std::string& what, std::vector<Snapshot>& from, std::vector<Snapshot>& to) {
  if (from.empty()) throw InputError(fmt::format("there is nothing to {}", what));
  tracked_->restore(without_items(from.back().scene, from.back().off));
  to.push_back(snapshot());
  text_ = std::move(from.back().text);
  scene_ = std::move(from.back().scene);
  off_ = std::move(from.back().off);
  from.pop_back();
  sync();
}

/// Takes over a scene with all items, whose numbers or items may have changed.
Transition ViewSession::take(Scene scene) {
  Transition out = tracked_->change(effective(scene));
  scene_ = std::move(scene);
  sync();
  return out;
}

PointRef ViewSession::point_called(const std::string& name) const {
  std::vector<std::string> names;
  const Scene& scene = tracked_->scene();
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
  Transition out = tracked_->drag(point, screen_->world(px_of(request)));
  sync();
  return out;
}

void ViewSession::expect_free(const ParameterPlace& place) const {
  for (const ParameterRow& row : parameter_table(scene_)) {
    if (row.place == place) check_is_free(scene_, row);
  }
}

Transition ViewSession::do_ground(const json& request) {
  const PointRef point = point_called("ground." + request.at("point").get<std::string>());
  Scene wanted = scene_;
  for (const int component : {0, 1}) expect_free({Owner::point, 0, point.point, component});
  wanted.bodies[0].points[static_cast<std::size_t>(point.point)].at = screen_->world(px_of(request));
  return take(std::move(wanted));
}

Transition ViewSession::do_load(const json& request) {
  const std::string name = request.at("name").get<std::string>();
  Scene wanted = scene_;
  const auto load =
      std::find_if(wanted.forces.begin(), wanted.forces.end(), [&](const Force& force) { return force.name == name; });
  if (load == wanted.forces.end()) throw InputError(fmt::format("load: expected one of the scene, found \"{}\"", name));
  expect_free({Owner::force, static_cast<int>(load - wanted.forces.begin())});
  load->vector = screen_->pulled(name, px_of(request));
  if (load->follows >= 0) {
    load->vector = load->vector * conj(unit(tracked_->poses()[static_cast<std::size_t>(load->follows)].angle));
  }
  return take(std::move(wanted));
}

Transition ViewSession::do_set(const json& request) {
  Scene wanted = scene_;
  set_value(wanted, request.at("path").get<std::string>(), request.at("value").get<double>());
  return take(std::move(wanted));
}

Transition ViewSession::do_switch(const json& request) {
  const std::string item = request.at("item").get<std::string>();
  const std::vector<SwitchedItem> known = items_of(scene_);
  if (std::none_of(known.begin(), known.end(), [&](const SwitchedItem& one) { return one.item == item; })) {
    throw InputError(fmt::format("item: expected one of the scene, found \"{}\"", item));
  }
  std::set<std::string> off = off_;
  if (request.at("on").get<bool>())
    off.erase(item);
  else
    off.insert(item);
  std::swap(off_, off);
  try {
    expect_parked();
    return take(scene_);
  } catch (...) {
    std::swap(off_, off);
    throw;
  }
}

Transition ViewSession::do_text(const std::string& text) {
  Scene scene = parse_scene(text, file_.string());
  Transition out;
  if (starts_alike(scene, scene_)) {
    out = tracked_->change(scene);
  } else {
    tracked_->restore(scene);
    out.kind = Transition::Kind::settled;
    out.why = "released from the start that the scene gives";
  }
  text_ = text;
  scene_ = std::move(scene);
  off_.clear();
  sync();
  return out;
}

Transition ViewSession::do_go(const json& request) {
  const std::optional<OtherEquilibria::Found> found = others_.found();
  const auto number = request.at("number").get<std::size_t>();
  if (!found || number >= found->poses.size()) throw InputError("that equilibrium is not known any more");
  tracked_->stay_at(found->poses[number]);
  sync();
  Transition out;
  out.kind = Transition::Kind::settled;
  out.why = "taken there";
  return out;
}

void ViewSession::do_save(const json& request) {
  const bool anyway = request.value("anyway", false);
  std::error_code unknown;
  if (!anyway && std::filesystem::exists(file_, unknown) && read_text_file(file_) != on_disk_) {
    throw InputError("changed on disk: the file is no longer as it was read; reload it, or save all the same");
  }
  const std::string text = present_text();
  OutputFile out(file_, "save");
  out.prepare(text);
  out.commit();
  on_disk_ = text_ = text;
  scene_ = parse_scene(text_, file_.string());
  off_.clear();
  tracked_->restore(scene_);
  sync();
  saved_text_ = present_text();
}

std::string ViewSession::act(const json& request) {
  const auto begin = std::chrono::steady_clock::now();
  json out;
  std::string drawing, what;
  try {
    what = request.value("do", "");
    Transition transition;
    // What a slider or an arrow does in one go is one step for undo.
    const std::string gesture = what == "set"      ? "set " + request.value("path", "")
                                : what == "load"   ? "load " + request.value("name", "")
                                : what == "ground" ? "ground " + request.value("point", "")
                                                   : what;
    const bool goes_on = request.value("goes_on", false);
    const Parts parts = goes_on || what == "drag" ? Parts::moving : Parts::all;
    const bool is_step = changes_scene(what) && !(in_gesture_ && gesture == gesture_);
    const std::optional<Snapshot> before = is_step ? std::optional(snapshot()) : std::nullopt;
    if (what == "drag") {
      transition = do_drag(request);
    } else if (what == "release") {
      transition = tracked_->release();
      sync();
    } else if (what == "ground") {
      transition = do_ground(request);
    } else if (what == "load") {
      transition = do_load(request);
    } else if (what == "set") {
      transition = do_set(request);
    } else if (what == "switch") {
      transition = do_switch(request);
    } else if (what == "text") {
      transition = do_text(request.at("text").get<std::string>());
    } else if (what == "reload") {
      const std::string text = read_text_file(file_);
      transition = do_text(text);
      on_disk_ = text;
      saved_text_ = present_text();
    } else if (what == "go") {
      transition = do_go(request);
    } else if (what == "undo") {
      go_back(what, undo_, redo_);
    } else if (what == "redo") {
      go_back(what, redo_, undo_);
    } else if (what == "save") {
      do_save(request);
    } else if (what != "look") {
      throw InputError(fmt::format("unknown request \"{}\"", what));
    }
    if (before) remember(*before);
    if (what != "look") {
      gesture_ = gesture;
      in_gesture_ = goes_on;
      ++revision_;
    }
    out = shown(transition, parts);
    drawing = drawing_json(screen_->drawing(*tracked_, transition, what == "load"));
    out["handles"] = handles();
    if (parts == Parts::all) look_for_others();
  } catch (const InputError& error) {
    const std::string message = error.what();
    const std::optional<int> line = line_in(message, file_.string());
    out = {{"error", {{"text", message}, {"of", what}, {"line", line ? json(*line) : json(nullptr)}}},
           {"revision", revision_}};
  } catch (const json::exception&) {
    out = {{"error",
            {{"text", "the request lacks something, or has it in another form"}, {"of", what}, {"line", nullptr}}},
           {"revision", revision_}};
  }
  out["server_ms"] = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return with_drawing(out, drawing);
}

json ViewSession::page() {
  Result nothing;
  nothing.title = scene_.title.empty() ? file_.filename().string() : scene_.title;
  nothing.source = scene_.source;
  json out = page_document(nothing, {.command = "view", .line = "poise view " + file_.string()}, {});
  out["result"] = nullptr;
  json& view = out["view"] = shown({}, Parts::all);
  view["drawing"] = json::parse(drawing_json(screen_->drawing(*tracked_, {}, false)));
  view["handles"] = handles();
  return out;
}

json ViewSession::shown(const Transition& transition, Parts parts) {
  if (parts == Parts::all && !tracked_->hand() && !screen_->shows(*tracked_))
    screen_ = std::make_unique<Screen>(*tracked_);
  Answer answer;
  answer.equilibrium = tracked_->equilibrium();
  answer.readings = read_off(tracked_->model(), answer.equilibrium.x);
  json out = report_json(solve_result(tracked_->model(), answer, {}));
  out["revision"] = revision_;
  out["transition"] = {{"kind", to_string(transition.kind)}, {"why", transition.why}, {"passed", transition.passed}};
  out["hand"] = hand();
  out["undo"] = undo_.size();
  out["redo"] = redo_.size();
  if (parts == Parts::moving) return out;
  out["numbers"] = numbers();
  out["switches"] = switches();
  out["text"] = present_text();
  out["file"] = file_.filename().string();
  out["saved"] = out["text"] == saved_text_;
  return out;
}

json ViewSession::numbers() const {
  static const std::vector<std::string> order = {"numbers", "loads",      "gravity", "springs", "dampers",
                                                 "stops",   "dimensions", "masses",  "others"};
  const double size = tracked_->model().scales().length;
  std::map<std::string, std::vector<json>> groups;
  for (const ParameterRow& row : parameter_table(scene_)) {
    if (!counts_in_statics(row.place.owner)) continue;
    const std::optional<double> si = value_at(scene_, row.place);
    // What follows from a named number moves with its slider.
    if (!si || !std::isfinite(*si) || dependent_number(scene_, row.place) != nullptr) continue;
    const double unit = row.dimension.unit(scene_.units);
    const auto [low, high] = slider(row, *si, size);
    const std::string path = row.path.text();
    groups[group_of(row, scene_)].push_back({{"path", path},
                                             {"group", group_of(row, scene_)},
                                             {"name", path.substr(path.find('.') + 1)},
                                             {"value", *si / unit},
                                             {"unit", row.dimension.unit_name(scene_.units)},
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
  for (const SwitchedItem& one : items_of(scene_)) {
    out.push_back({{"item", one.item}, {"group", one.group}, {"name", one.name}, {"on", !off_.contains(one.item)}});
  }
  return out;
}

json ViewSession::handles() const {
  const Scene& scene = tracked_->scene();
  const BodyPoses poses = tracked_->poses();
  json out = json::array();
  std::vector<Vec2> taken;
  const auto add = [&](const char* kind, const std::string& name, PointRef point) {
    const Vec2 px = screen_->px(poses[static_cast<std::size_t>(point.body)].world(scene.local(point)));
    // One handle for points that a joint keeps together.
    constexpr double same = 0.5;
    if (std::any_of(taken.begin(), taken.end(), [&](Vec2 other) { return norm(other - px) < same; })) return;
    taken.push_back(px);
    out.push_back({{"kind", kind}, {"name", name}, {"px", {px.x, px.y}}});
  };
  if (tracked_->hand()) add("point", scene.name_of(*tracked_->hand()), *tracked_->hand());
  // Of the ground those points on which something rests or pulls.
  for (const PointRef& point : used_of_ground(scene))
    add("ground", scene.bodies[0].points[static_cast<std::size_t>(point.point)].name, point);
  for (int b = 1; b < static_cast<int>(scene.bodies.size()); ++b) {
    for (int p = 0; p < static_cast<int>(scene.bodies[static_cast<std::size_t>(b)].points.size()); ++p) {
      add("point", scene.name_of({b, p}), {b, p});
    }
  }
  for (const Screen::LoadArrow& load : screen_->loads()) {
    out.push_back(
        {{"kind", "load"}, {"name", load.name}, {"px", {load.far.x, load.far.y}}, {"tail", {load.at.x, load.at.y}}});
  }
  return out;
}

json ViewSession::hand() const {
  if (!tracked_->hand()) return nullptr;
  const std::string name = tracked_->scene().name_of(*tracked_->hand());
  const std::string text = with_unit(tracked_->model(), norm(tracked_->force_of_hand()), Quantity::force, 4);
  return {{"point", name},
          {"force", text},
          {"text", fmt::format("held at {} with {}", name, text)},
          {"stops", toml_of_hand(*tracked_)}};
}

json ViewSession::others_json(const OtherEquilibria::Found& found) const {
  json out = {{"revision", found.revision},
              {"claim", to_string(found.set.claim)},
              {"statement", found.set.statement + "."},
              {"drawing", json::parse(drawing_json(screen_->others(found)))},
              {"equilibria", json::array()}};
  const BodyPoses now = tracked_->poses();
  for (std::size_t k = 0; k < found.poses.size(); ++k) {
    const Equilibrium& one = found.set.equilibria[k];
    const Stability stability = one.certificate.stability;
    const std::string caption = fmt::format("{}: {}", k + 1, stability_and_energy(tracked_->model(), one));
    out["equilibria"].push_back({{"caption", caption},
                                 {"tone", stability == Stability::stable ? "good" : "bad"},
                                 {"stable", stability == Stability::stable},
                                 {"here", same_position(found, k, now)}});
  }
  return out;
}

json ViewSession::poll(long revision) {
  json out = {{"revision", revision_}, {"others", nullptr}, {"file", "same"}, {"searching", others_.searching()}};
  try {
    if (read_text_file(file_) != on_disk_) out["file"] = "changed";
  } catch (const InputError&) {
    out["file"] = "gone";
  }
  const std::optional<OtherEquilibria::Found> found = others_.found();
  if (found && found->revision > revision) out["others"] = others_json(*found);
  return out;
}

std::string ViewSession::report() const {
  Answer answer = measure(tracked_->model(), tracked_->equilibrium());
  const Result result = solve_result(tracked_->model(), answer, {});
  return html_page(
      page_document(result, {.command = "solve", .line = "poise view " + file_.string()}, {Screen::figure(*tracked_)}));
}

}  // namespace poise::app
