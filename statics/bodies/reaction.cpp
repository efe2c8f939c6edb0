#include "statics/bodies/reaction.hpp"

#include <algorithm>

namespace poise {

const Reaction* reaction_of_stop(const std::vector<Reaction>& reactions, std::size_t stop) {
  const auto found = std::find_if(reactions.begin(), reactions.end(),
                                  [&](const Reaction& r) { return r.stop == static_cast<int>(stop); });
  return found == reactions.end() ? nullptr : &*found;
}

Resultant resultant_of_stops(const std::vector<Reaction>& reactions, std::size_t first, std::size_t count) {
  Vec2 sum{};
  Resultant out;
  for (std::size_t s = first; s < first + count; ++s) {
    const Reaction* const one = reaction_of_stop(reactions, s);
    if (one == nullptr) continue;
    sum += one->force;
    out.radius += one->radius;
  }
  out.force = norm(sum);
  return out;
}

}  // namespace poise
