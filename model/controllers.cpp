#include "model/controllers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "model/input_error.hpp"

namespace poise {
namespace {

[[noreturn]] void refuse(const Scene& scene, const Element& controller, std::string_view with, std::string_view what) {
  throw InputError(
      fmt::format("{}:{}: controller \"{}\": {} are not known here with controllers{}; expected a scene "
                  "without it",
                  scene.file, controller.line, controller.name, what, with));
}

/// Calls use(body) for each body that is a state of a controller.
template <class Use>
void for_each_state(const Scene& scene, Use use) {
  for (const int e : controllers_of(scene)) {
    const Feedback& feedback = *scene.elements[static_cast<std::size_t>(e)].feedback;
    for (const int body : feedback.states()) use(body);
  }
}

/// Calls use(controller) for those on which what this one decides depends at once.
template <class Use>
void for_each_before(const Scene& scene, const Element& controller, Use use) {
  if (!controller_of(controller.law)->decides_at_once()) return;
  const Feedback& feedback = *controller.feedback;
  const int setting = feedback.reads_force < 0 ? -1 : controller_that_sets(scene, feedback.reads_force);
  for (const int before : {feedback.follows, feedback.reads_from, setting}) {
    if (before >= 0) use(before);
  }
}

}  // namespace

std::vector<int> controllers_of(const Scene& scene) {
  std::vector<int> out;
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    if (scene.elements[e].feedback) out.push_back(static_cast<int>(e));
  }
  return out;
}

int controller_that_sets(const Scene& scene, int element) {
  for (const int e : controllers_of(scene)) {
    if (scene.elements[static_cast<std::size_t>(e)].feedback->sets_number_of(element)) return e;
  }
  return -1;
}

int controller_of_drive(const Scene& scene, int drive) {
  for (const int e : controllers_of(scene)) {
    if (scene.elements[static_cast<std::size_t>(e)].feedback->sets_drive(drive)) return e;
  }
  return -1;
}

std::vector<int> in_order_of_decisions(const Scene& scene) {
  std::vector<int> out;
  const auto add = [&](int e, const auto& self) -> void {
    if (std::find(out.begin(), out.end(), e) != out.end()) return;
    const Element& element = scene.elements[static_cast<std::size_t>(e)];
    for_each_before(scene, element, [&](int before) { self(before, self); });
    out.push_back(e);
  };
  for (const int e : controllers_of(scene)) add(e, add);
  return out;
}

std::vector<int> circle_of_decisions(const Scene& scene) {
  std::vector<int> done, path, circle;
  const auto visit = [&](int e, const auto& self) -> void {
    if (!circle.empty() || std::find(done.begin(), done.end(), e) != done.end()) return;
    const auto begin = std::find(path.begin(), path.end(), e);
    if (begin != path.end()) {
      circle.assign(begin, path.end());
      return;
    }
    path.push_back(e);
    const Element& element = scene.elements[static_cast<std::size_t>(e)];
    for_each_before(scene, element, [&](int next) { self(next, self); });
    path.pop_back();
    done.push_back(e);
  };
  for (const int e : controllers_of(scene)) visit(e, visit);
  return circle;
}

std::set<int> bodies_of_states(const Scene& scene) {
  std::set<int> out;
  for_each_state(scene, [&](int body) { out.insert(body); });
  return out;
}

std::vector<int> states_of_controllers(const Scene& scene, const Layout& layout) {
  std::vector<int> out;
  for_each_state(scene, [&](int body) { out.push_back(layout.links[static_cast<std::size_t>(body)].frame); });
  return out;
}

void refuse_controllers(const Scene& scene, std::string_view what) {
  for (const int e : controllers_of(scene)) refuse(scene, scene.elements[static_cast<std::size_t>(e)], "", what);
}

void refuse_states_of_controllers(const Scene& scene, std::string_view what) {
  for (const int e : controllers_of(scene)) {
    const Element& element = scene.elements[static_cast<std::size_t>(e)];
    if (!element.feedback->states().empty()) {
      refuse(scene, element, " that have states of their own", what);
    }
  }
}

}  // namespace poise
