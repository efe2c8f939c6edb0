#include "identification/prediction/random_states.hpp"

#include <algorithm>

#include "solvers/random_stream.hpp"

namespace poise {

void visit_random_states(ReducedMotion<double>& reduced, const std::vector<double>& x, int states, double duration,
                         const std::function<void(const RandomState&)>& visit) {
  reduced.expect(x.data());
  const int f = reduced.freedoms();
  solvers::RandomStream random(7);
  std::vector<double> z0;
  for (const int i : reduced.independent()) z0.push_back(x[static_cast<std::size_t>(i)]);
  RandomState state;
  for (auto* values : {&state.z, &state.w, &state.alpha}) values->resize(static_cast<std::size_t>(f));
  constexpr double first_reach = 0.5;
  double reach = first_reach;
  for (int s = 0, tries = 0; s < states && tries < 20 * states; ++tries) {
    for (int k = 0; k < f; ++k) {
      const auto at = static_cast<std::size_t>(k);
      state.z[at] = z0[at] + reach * random.uniform(-1.0, 1.0);
      state.w[at] = random.uniform(-1.0, 1.0);
      state.alpha[at] = random.uniform(-1.0, 1.0);
    }
    if (duration > 0) state.t = duration * reach / first_reach * random.uniform(0.0, 1.0);
    if (reduced.place(state.t, state.z.data()) != ReducedMotion<double>::Status::ok || reduced.pivot() < 1e-3) {
      reduced.expect(x.data());
      reach = std::max(0.02, 0.9 * reach);
      continue;
    }
    visit(state);
    ++s;
  }
}

Scene disturbed(Scene scene) {
  solvers::RandomStream random(3);
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.place.owner == Owner::start || row.place.owner == Owner::stop) continue;
    const double value = value_at(scene, row.place).value_or(0.0);
    if (value != 0) set_value_at(scene, row.place, value * (1 + random.uniform(-disturbance, disturbance)));
  }
  for (Joint& joint : scene.joints)
    joint.axis = joint.axis + random.uniform(-disturbance, disturbance) * quarter_turn(joint.axis);
  return scene;
}

}  // namespace poise
