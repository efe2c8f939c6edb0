// Paths of many variants of a scene, on threads.

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "app/commands/options.hpp"
#include "app/commands/vary.hpp"
#include "model/input_error.hpp"
#include "motion/dynamic_stability.hpp"
#include "python/module/arrays.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"
#include "python/module/interrupt_scope.hpp"
#include "python/module/listener.hpp"
#include "python/module/lock.hpp"
#include "python/module/many_numbers.hpp"
#include "python/module/scene_object.hpp"
#include "solvers/parallel.hpp"
#include "statics/model/mobility.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::python {
namespace {

/// What is kept of an event: names and numbers in the scene's units.
struct EventOf {
  PathEvent::Kind kind = PathEvent::Kind::fold;
  double value = 0.0;
  double error = std::numeric_limits<double>::infinity();
  double landing = std::numeric_limits<double>::quiet_NaN();
  std::string item;
  bool on = false;
  std::optional<Stability> before, after;
};

/// What is kept of a path.
struct PathOf {
  Path::Status status = Path::Status::not_started;
  std::string why = "an interrupt came before its turn";
  int points = 0, unproved = 0;
  std::vector<EventOf> events{};
};

std::string item_of(const VariedScene& varied, const PathEvent& event) {
  const auto item = static_cast<std::size_t>(event.item);
  if (event.kind == PathEvent::Kind::slack) return varied.scene().elements[item].name;
  if (event.kind == PathEvent::Kind::stop) {
    return item < varied.scene().stops.size() ? varied.scene().stops[item].name : varied.name();
  }
  return "";
}

PathOf summary_of(const VariedScene& varied, const Path& found) {
  PathOf out{.status = found.status, .why = found.why, .unproved = found.unproved()};
  for (const PathBranch& branch : found.branches) out.points += static_cast<int>(branch.points.size());
  const double range = varied.to() - varied.from();
  for (std::size_t e = 0; e < found.events.size(); ++e) {
    const PathEvent& event = found.events[e];
    const EventPlace place = place_of(found, static_cast<int>(e), range);
    EventOf& one = out.events.emplace_back();
    one.kind = event.kind;
    one.value = event.at.parameter / varied.unit();
    one.error = event.error;
    if (event.landing) one.landing = event.landing->parameter / varied.unit();
    if (event.item >= 0) one.item = item_of(varied, event);
    one.on = event.on;
    one.before = place.before;
    one.after = place.after;
  }
  return out;
}

struct ManyPaths {
  std::shared_ptr<const SceneObject> scene;
  std::vector<std::pair<std::string, std::span<const double>>> numbers;
  std::vector<std::string> varied_paths;  ///< these and `vary`
  std::string vary;
  double from = 0.0, to = 0.0;
  PathOptions options;

  PathOf path_of(std::size_t variant) const {
    try {
      Scene scene_of = scene->without(varied_paths);
      for (const auto& [name, values] : numbers) set_value(scene_of, name, values[values.size() == 1 ? 0 : variant]);
      const VariedScene varied(std::move(scene_of), vary, from, to);
      return summary_of(varied, path(varied, options));
    } catch (const AssemblyError& error) {
      return {.status = Path::Status::no_start, .why = error.what()};
    } catch (const InputError& error) {
      throw InputError(fmt::format("variant {}: {}", variant, error.what()));
    }
  }
};

py::object word_of(const std::optional<Stability>& stability) {
  return stability ? py::object(py::str(to_string(*stability))) : py::none();
}

/// One entry per variant, and of "events" one per event, those of a variant together and in the order of its path.
py::dict columns_of(const std::vector<PathOf>& paths) {
  py::list status, why, points, unproved;
  py::list variant, kind, value, error, landing, item, on, before, after;
  for (std::size_t v = 0; v < paths.size(); ++v) {
    const PathOf& path = paths[v];
    status.append(to_string(path.status));
    why.append(text_of(path.why));
    points.append(path.points);
    unproved.append(path.unproved);
    for (const EventOf& event : path.events) {
      variant.append(v);
      kind.append(to_string(event.kind));
      value.append(event.value);
      error.append(event.error);
      landing.append(event.landing);
      item.append(text_of(event.item));
      on.append(event.on);
      before.append(word_of(event.before));
      after.append(word_of(event.after));
    }
  }
  py::dict events(py::arg("variant") = variant, py::arg("kind") = kind, py::arg("value") = value,
                  py::arg("error") = error, py::arg("landing") = landing, py::arg("item") = item, py::arg("on") = on,
                  py::arg("before") = before, py::arg("after") = after);
  return py::dict(py::arg("status") = status, py::arg("why") = why, py::arg("points") = points,
                  py::arg("unproved") = unproved, py::arg("events") = events);
}

PathOptions::Follow follow_of(const std::string& word) {
  if (word == "unstable") return PathOptions::Follow::unstable;
  if (word == "jump") return PathOptions::Follow::jump;
  throw InputError(fmt::format("follow: expected unstable or jump, found {}", word));
}

py::dict path_many(const std::shared_ptr<const SceneObject>& scene, const ManyNumbers& numbers, std::size_t variants,
                   const std::string& vary, double from, double to, const py::dict& options, int jobs,
                   const py::object& progress) {
  ManyPaths work{
      .scene = scene, .numbers = {}, .varied_paths = {vary}, .vary = vary, .from = from, .to = to, .options = {}};
  for (const auto& [name, values] : numbers) {
    work.varied_paths.push_back(name);
    work.numbers.emplace_back(name, std::span(values.data(), static_cast<std::size_t>(values.size())));
  }
  std::atomic<bool> interrupt = false;
  work.options.from = app::read_from(utf8(options["from_"]));
  work.options.follow = follow_of(utf8(options["follow"]));
  work.options.branches = py::cast<bool>(options["branches"]);
  work.options.certify = py::cast<bool>(options["proof"]);
  work.options.certificate = app::read_proof(py::cast<std::optional<double>>(options["proof_seconds"]));
  work.options.dynamic_stability = dynamic_stability;
  work.options.interrupt = &interrupt;
  // What is wrong with the range is wrong in all of them.
  const std::string unit = VariedScene(scene->without(work.varied_paths), vary, from, to).unit_name();
  std::vector<PathOf> paths(variants);
  Listener listener(progress, interrupt);
  const InterruptScope scope(interrupt);
  {
    const WithoutLock others;
    solvers::ParallelOptions parallel{.jobs = app::read_jobs(jobs), .interrupt = &interrupt};
    if (listener.is_wanted()) {
      parallel.progress = [&](std::size_t done) { listener(variants_done(done, variants)); };
    }
    solvers::parallel_for(variants, parallel, [&](std::size_t v) { paths[v] = work.path_of(v); });
  }
  scope.hand_back_unless(std::any_of(paths.begin(), paths.end(), [](const PathOf& one) {
    return one.status == Path::Status::interrupted || one.status == Path::Status::not_started;
  }));
  listener.rethrow();
  py::dict out = columns_of(paths);
  out["unit"] = text_of(unit);
  return out;
}

}  // namespace

std::string variants_done(std::size_t done, std::size_t all) { return fmt::format("{} of {} variants", done, all); }

void bind_path_many(py::module_& m) {
  m.def("path_many", path_many, py::arg("scene"), py::arg("numbers"), py::arg("variants"), py::arg("vary"),
        py::arg("from_"), py::arg("to"), py::arg("options"), py::arg("jobs"), py::arg("progress"));
  m.def("real_array", [](const py::object& given, const std::string& name) { return real_array(given, name.c_str()); });
}

}  // namespace poise::python
