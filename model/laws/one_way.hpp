#pragma once

#include <array>
#include <cstddef>

#include "model/laws/law_force.hpp"
#include "model/set_valued.hpp"

namespace poise {

/// On which side of its free length a spring acts, or while its measure grows (tension) or shrinks a damper.
enum class SpringActs { both, tension, compression };

/// The key `acts` of a law with such a member.
template <class L>
constexpr LawChoice acts_choice() {
  return {"acts", {"both", "tension", "compression"}, [](void* law, std::size_t word) {
            constexpr SpringActs meanings[] = {SpringActs::both, SpringActs::tension, SpringActs::compression};
            static_cast<L*>(law)->acts = meanings[word];
          }};
}

/// force(rate) in the direction in which a damper acts, zero of its kind in the other.
template <class S, class Force>
auto while_it_acts(SpringActs acts, const S& rate, Force force) {
  if (acts == SpringActs::both) return force(rate);
  return by_pieces(rate, std::array{0.0}, [&](std::size_t grows, const S& part) {
    return (grows != 0) == (acts == SpringActs::tension) ? force(part) : decltype(force(part)){};
  });
}

}  // namespace poise
