#pragma once

#include <string>
#include <vector>

#include "model/scene.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::test {

struct NamedMeasure {
  std::string name;
  Measure measure;
};

/// Measures of every kind that the scene has, sums and sums of sums among them, of bodies and points drawn at random.
/// Each body gets a point "probe" for it. `with_couplings`: also components along axes of bodies, ropes, and sums with
/// profiles.
std::vector<NamedMeasure> measures_of(Scene& scene, Random& random, bool with_couplings = false);

/// Adds a force element upon each of such measures: springs of both kinds and ways, constant forces, dampers and
/// friction, all of order one.
void add_elements_upon_every_measure(Scene& scene, Random& random, bool with_couplings = false);

}  // namespace poise::test
