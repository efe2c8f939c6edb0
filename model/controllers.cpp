#include "model/controllers.hpp"

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
    for (const int body : {feedback.integral, feedback.filter}) {
      if (body >= 0) use(body);
    }
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
    if (element.feedback->integral >= 0 || element.feedback->filter >= 0) {
      refuse(scene, element, " that have states of their own", what);
    }
  }
}

}  // namespace poise
