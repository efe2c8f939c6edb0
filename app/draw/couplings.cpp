#include "model/couplings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"
#include "model/cam_geometry.hpp"
#include "statics/bodies/body_forces.hpp"

namespace poise::app {
namespace {

/// Pitch circles on the page, px.
struct Wheels {
  Vec2 a, b;
  double radius_a, radius_b;
};

// Of wheels on one axis the radii are not known: circles of a size that can be seen.
Wheels wheels_of(const Stage& stage, const Stop& stop) {
  constexpr double at_one_place = 4.0, unknown_radius = 14.0;
  const PitchCircles circles = pitch_circles(stage.scene, stage.now, stop);
  const Vec2 a = stage.page(circles.centre_a), b = stage.page(circles.centre_b);
  if (norm(b - a) < at_one_place) return {a, b, unknown_radius, unknown_radius};
  return {a, b, stage.scale * circles.radius_a, stage.scale * circles.radius_b};
}

constexpr double line_width = 1.3;
constexpr std::string_view pitch_line = "7 2 2 2";  // the dash of pitch circles in engineering drawings

/// The pitch circle of a wheel, with a radius that turns with it; the ground's does not.
void draw_wheel(Stage& stage, Vec2 centre, double radius, int body) {
  stage.canvas.circle(centre, radius, {.stroke = ink::free_stop, .width = line_width, .dash = pitch_line});
  if (body == 0) return;
  const double angle = stage.now.poses[static_cast<std::size_t>(body)].angle;
  stage.canvas.line(centre, centre + radius * Stage::page_direction(unit(angle)),
                    {.stroke = ink::free_stop, .width = line_width});
}

void draw_wheels(Stage& stage, const Stop& stop) {
  const Wheels wheels = wheels_of(stage, stop);
  draw_wheel(stage, wheels.a, wheels.radius_a, stop.on.terms[1].measure.body_b);
  draw_wheel(stage, wheels.b, wheels.radius_b, stop.on.terms[0].measure.body_b);
  const Vec2 line = wheels.b - wheels.a;
  const double apart = norm(line);
  if (stop.table != "belt" || apart < 4.0) return;
  const Vec2 along = (1 / apart) * line;
  const bool crossed = stop.sense > 0.0;
  for (const double side : {1.0, -1.0}) {
    const double offset = side * ((crossed ? -1.0 : 1.0) * wheels.radius_b - wheels.radius_a) / apart;
    const Vec2 out = side * (Vec2{-offset * side, std::sqrt(std::max(0.0, 1.0 - offset * offset))} * along);
    stage.canvas.line(wheels.a + wheels.radius_a * out, wheels.b + (crossed ? -wheels.radius_b : wheels.radius_b) * out,
                      {.stroke = ink::free_stop, .width = line_width});
  }
}

void draw_rack(Stage& stage, const Stop& stop) {
  const Joint& slide = stage.scene.joints[static_cast<std::size_t>(stop.on.terms[0].measure.joint)];
  const Measure& pinion = stop.on.terms[1].measure;
  const Vec2 pivot = stage.pivot(pinion.body_a, pinion.body_b);
  const double radius = stage.scale * std::abs(stop.on.terms[1].factor);
  const Vec2 along = stage.page_axis(slide);
  // The rack meets the rim on the side of its slide.
  const Vec2 beside = quarter_turn(along);
  const double side = dot(stage.page(slide.b) - pivot, beside) < 0.0 ? -1.0 : 1.0;
  const Vec2 contact = pivot + (side * radius) * beside;
  draw_wheel(stage, pivot, radius, pinion.body_b);
  stage.canvas.line(contact - (1.5 * radius + 8.0) * along, contact + (1.5 * radius + 8.0) * along,
                    {.stroke = ink::free_stop, .width = line_width, .dash = pitch_line});
}

void draw_geneva(Stage& stage, const Stop& stop) {
  const Measure& wheel = stop.on.terms[0].measure;
  const Measure::Term& crank = stop.on.terms[1];
  const Readings& now = stage.now;
  const Vec2 on_crank = pivot_of(stage.scene, now, crank.measure.body_a, crank.measure.body_b);
  const Vec2 on_wheel = pivot_of(stage.scene, now, wheel.body_a, wheel.body_b);
  const Vec2 line = on_wheel - on_crank;
  if (stage.scale * norm(line) < 4.0) return;
  const int slots = slots_of(stop);
  const double turned = value_of(stage.scene, crank.measure, now.poses) - crank.shift;
  const double advanced = -crank.factor * crank.profile->at(turned / crank.span).value;
  const auto draw = [&](std::vector<Vec2> outline, Vec2 axis, Vec2 along, double angle) {
    for (Vec2& point : outline) point = stage.page(axis + point * (along * unit(angle)));
    stage.canvas.polygon(std::move(outline), {.stroke = ink::free_stop, .width = line_width});
  };
  draw(geneva_wheel(slots), on_wheel, -line, advanced);
  draw(geneva_disc(slots), on_crank, line, turned);
  const Vec2 pin = on_crank + std::sin(M_PI / slots) * (line * unit(turned));
  stage.canvas.line(stage.page(on_crank), stage.page(pin), {.stroke = ink::free_stop, .width = line_width});
  stage.canvas.circle(stage.page(pin), stage.scale * norm(line) * geneva_pin_radius(slots),
                      {.stroke = ink::free_stop, .width = line_width});
}

constexpr int sides_of_cam = 120;

/// Of a cam whose shape the scene does not say: what is drawn turns with it and stands out where the lift is large.
std::vector<Vec2> lifts_of_cam(const Stage& stage, const Stop& stop) {
  const Measure::Term& term = stop.on.terms[1];
  const Vec2 pivot = stage.pivot(term.measure.body_a, term.measure.body_b);
  double least = INFINITY, most = -INFINITY;
  std::vector<double> lift;
  for (int k = 0; k < sides_of_cam; ++k) {
    lift.push_back(term.profile->at(static_cast<double>(k) / sides_of_cam).value);
    least = std::min(least, lift.back());
    most = std::max(most, lift.back());
  }
  constexpr double base = 12.0, height = 14.0;
  std::vector<Vec2> outline;
  const double turned = stage.now.poses[static_cast<std::size_t>(term.measure.body_b)].angle;
  for (int k = 0; k < sides_of_cam; ++k) {
    // The lift at the angle of the cam is that of the point that has turned back by it.
    const double angle = turned - (term.shift + 2 * M_PI * k / sides_of_cam);
    const double share = most > least ? (lift[static_cast<std::size_t>(k)] - least) / (most - least) : 0.0;
    outline.push_back(pivot + (base + height * share) * Stage::page_direction(unit(angle)));
  }
  return outline;
}

void draw_cam(Stage& stage, const Stop& stop, bool in_contact) {
  std::vector<Vec2> outline = pitch_curve(stage.scene, stage.now, stop);
  for (Vec2& point : outline) point = stage.page(point);
  stage.canvas.polygon(outline.empty() ? lifts_of_cam(stage, stop) : std::move(outline),
                       {.stroke = in_contact ? ink::stop : ink::free_stop, .width = 1.6});
}

}  // namespace

PitchCircles pitch_circles(const Scene& scene, const Readings& readings, const Stop& stop) {
  const Measure& of_b = stop.on.terms[0].measure;
  const Measure& of_a = stop.on.terms[1].measure;
  PitchCircles out{pivot_of(scene, readings, of_a.body_a, of_a.body_b),
                   pivot_of(scene, readings, of_b.body_a, of_b.body_b)};
  const double apart = norm(out.centre_b - out.centre_a);
  const double ratio = std::abs(stop.on.terms[1].factor);
  if (stop.table == "belt" || stop.sense > 0.0) {
    const double both = stop.table == "belt" ? 0.5 * apart : apart;
    out.radius_a = both * ratio / (1.0 + ratio);
    out.radius_b = both / (1.0 + ratio);
  } else if (ratio != 1.0) {
    out.radius_a = apart * ratio / std::abs(1.0 - ratio);
    out.radius_b = apart / std::abs(1.0 - ratio);
  }
  return out;
}

std::vector<Vec2> pitch_curve(const Scene& scene, const Readings& readings, const Stop& stop) {
  const std::optional<CamGeometry> known = cam_geometry(scene, stop);
  if (!known) return {};
  const CamGeometry& cam = *known;
  const auto at = [&](PointRef point) { return world(scene, readings, point); };
  const Measure::Term& follower = stop.on.terms[0];
  const Measure::Term& turn = stop.on.terms[1];
  const double now = value_of(scene, turn.measure, readings.poses);
  const double lifted = value_of(scene, follower.measure, readings.poses);
  const double base = std::isfinite(stop.min) ? stop.min : stop.max;
  const Vec2 axis = at(cam.axis), roller = at(cam.roller);
  std::vector<Vec2> out;
  for (int k = 0; k < sides_of_cam; ++k) {
    const double u = static_cast<double>(k) / sides_of_cam;
    const double by = (base - turn.factor * turn.profile->at(u).value) / follower.factor - lifted;
    Vec2 there;
    if (cam.slide >= 0) {
      const Joint& slide = scene.joints[static_cast<std::size_t>(cam.slide)];
      there = roller + by * (slide.direction() * unit(readings.poses[static_cast<std::size_t>(slide.a.body)].angle));
    } else {
      const Vec2 pivot = at(cam.pivot);
      there = pivot + (roller - pivot) * unit(cam.turn_sense * by);
    }
    out.push_back(axis + (there - axis) * unit(cam.sense * (now - turn.shift - 2 * M_PI * u)));
  }
  return out;
}

void draw_rope_line(Stage& stage, const Measure& rope, const Paint& paint) {
  const std::vector<BodyPose<double>>& poses = stage.now.poses;
  Vec2 before{};
  for (std::size_t k = 0; k + 1 < rope.contacts.size(); ++k) {
    const RopePart<double> part = BodyForces(stage.scene, poses).rope_part(rope, k);
    stage.canvas.line(stage.page(part.from), stage.page(part.to), paint);
    const RopeContact& contact = rope.contacts[k];
    if (k > 0 && contact.radius > 0.0) {
      const Vec2 centre = world(stage.scene, stage.now, contact.at);
      const Vec2 page = stage.page(centre);
      const double radius = stage.scale * contact.radius;
      stage.canvas.circle(page, radius, {.stroke = ink::free_stop, .width = 1.0});
      const auto angle = [&](Vec2 at) { return std::atan2(at.y - centre.y, at.x - centre.x); };
      const double wrap = rope_wrap(before, part.along, contact.turn);
      const double begin = angle(centre - (contact.turn * contact.radius) * quarter_turn(before));
      if (wrap > 0.0) stage.canvas.arc(page, radius, begin, begin + contact.turn * wrap, paint);
    }
    before = part.along;
  }
}

void draw_rope(Stage& stage, const Stop& stop, bool taut) {
  draw_rope_line(stage, stop.on,
                 {.stroke = taut ? ink::stop : ink::free_stop, .width = taut ? 2.0 : 1.2, .dash = taut ? "" : "2 4"});
  stage.signs.insert(Sign::rope);
}

void draw_coupling(Stage& stage, const Stop& stop, bool in_contact) {
  if (stop.table == "gear" || stop.table == "belt") {
    draw_wheels(stage, stop);
    stage.signs.insert(Sign::wheels);
  } else if (stop.table == "rack") {
    draw_rack(stage, stop);
    stage.signs.insert(Sign::wheels);
  } else if (stop.table == "geneva") {
    draw_geneva(stage, stop);
    stage.signs.insert(Sign::geneva);
  } else if (stop.table == "cam") {
    draw_cam(stage, stop, in_contact);
    stage.signs.insert(Sign::cam);
  }
}

}  // namespace poise::app
