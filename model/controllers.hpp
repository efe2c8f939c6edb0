#pragma once

// Controllers of a scene: elements that act by what they read (model/laws/controller.hpp).

#include <set>
#include <string_view>
#include <vector>

#include "model/layout.hpp"
#include "model/scene.hpp"

namespace poise {

/// Indices of the elements that are controllers.
std::vector<int> controllers_of(const Scene& scene);

/// The same, so that each comes behind those on which what it decides depends at once.
std::vector<int> in_order_of_decisions(const Scene& scene);

/// Controllers of which each depends at once on what the next one gives, and the last on the first; empty where there
/// are none.
std::vector<int> circle_of_decisions(const Scene& scene);

/// The controller that sets a number of an element, or -1.
int controller_that_sets(const Scene& scene, int element);

/// The controller that sets the acceleration of a drive, or -1.
int controller_of_drive(const Scene& scene, int drive);

/// The bodies that are states of controllers (Feedback), as a set that is empty in most scenes.
std::set<int> bodies_of_states(const Scene& scene);

/// The coordinates of a layout for motion that are states of controllers.
std::vector<int> states_of_controllers(const Scene& scene, const Layout& layout);

/// Throws InputError for a scene with controllers, which `what` leaves out: "frequency responses".
void refuse_controllers(const Scene& scene, std::string_view what);
/// The same for those with states alone.
void refuse_states_of_controllers(const Scene& scene, std::string_view what);

}  // namespace poise
