#include "statics/model/ball_mechanism.hpp"

#include "statics/model/private/closure_rounding.hpp"

namespace poise {
namespace {

Mechanism<Ball> compiled(const StaticModel& model, const Layout& layout, bool rounding) {
  const Ball::InputRounding guard(rounding);
  return {model.scaled_scene(), layout, Purpose::statics};
}

}  // namespace

BallMechanism::BallMechanism(const StaticModel& model, const Layout& layout)
    : exact(compiled(model, layout, false)),
      rounded(compiled(model, layout, true)),
      plain(model.mechanism()),
      row_rounding(poise::row_rounding(model)) {}

}  // namespace poise
