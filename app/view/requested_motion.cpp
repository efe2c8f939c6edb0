#include "app/view/requested_motion.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "model/input_error.hpp"

namespace poise::app {
namespace {

Vec2 place_in(const nlohmann::json& request) { return {request.at(0).get<double>(), request.at(1).get<double>()}; }

/// A motion that leaves a place where it is.
PlaneMotion about(Vec2 place, bool mirrored, double angle, double angle_unit) {
  const PlaneMotion at_origin{mirrored, angle, {}};
  return {mirrored, angle, place - at_origin.after({false, 0.0, place}, angle_unit).at};
}

}  // namespace

PlaneMotion requested_motion(const nlohmann::json& request, double angle_unit) {
  PlaneMotion out;
  if (request.contains("mirror")) {
    const Vec2 from = place_in(request.at("mirror").at(0)), to = place_in(request.at("mirror").at(1));
    if (!(norm(to - from) > 0.0)) throw InputError("mirror: expected two different points of a line");
    const double direction = std::atan2((to - from).y, (to - from).x);
    out = about(from, true, 2.0 * direction / angle_unit, angle_unit);
  }
  if (request.contains("turn")) {
    const Vec2 centre = request.contains("about") ? place_in(request.at("about")) : Vec2{};
    out = about(centre, false, request.at("turn").get<double>(), angle_unit).after(out, angle_unit);
  }
  if (request.contains("move")) out.at = out.at + place_in(request.at("move"));
  if (!std::isfinite(out.angle) || !std::isfinite(out.at.x) || !std::isfinite(out.at.y))
    throw InputError("expected a motion by finite numbers");
  return out;
}

}  // namespace poise::app
