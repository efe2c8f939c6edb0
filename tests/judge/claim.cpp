#include "tests/judge/claim.hpp"

#include <algorithm>
#include <stdexcept>

namespace poise::judge {
namespace {

using Of = ClaimedCoordinate::Of;

// What coordinate t of the model is in the scene.
ClaimedCoordinate meaning_of(const Layout& layout, int t) {
  for (const Link& link : layout.links) {
    if (t < layout.angles && link.frame == t && layout.turns[link.turn].to<double>() == 0.0) {
      return {link.body >= 0 ? Of::angle : Of::bar, link.body >= 0 ? link.body : link.joint};
    }
    if (t < layout.angles || link.parent != 0 || link.body < 0) continue;
    for (const Arm& arm : link.arms) {
      const bool along_axis = arm.arm == Vec2{1, 0} || arm.arm == Vec2{0, 1};
      const bool is_place = std::find(layout.travel.begin(), layout.travel.end(), t) == layout.travel.end();
      if (arm.coordinate == t && along_axis && is_place) return {arm.arm.x == 1 ? Of::x : Of::y, link.body};
    }
  }
  for (std::size_t j = 0; j < layout.travel.size(); ++j) {
    if (layout.travel[j] == t) return {Of::travel, static_cast<int>(j)};
  }
  throw std::logic_error("a coordinate means nothing in the scene");
}

Kind kind_of(Stability stability) {
  switch (stability) {
    case Stability::stable:
      return Kind::stable;
    case Stability::unstable:
      return Kind::unstable;
    case Stability::neutral:
      return Kind::neutral;
    case Stability::unknown:
      break;
  }
  return Kind::unknown;
}

// Coordinates that are arbitrary, by name, are not compared.
Claim pose_claim(const StaticModel& model, const std::vector<double>& x, const std::vector<std::string>& arbitrary) {
  Claim claim;
  const auto poses = model.poses(x);
  for (std::size_t b = 0; b < model.scene().bodies.size(); ++b) {
    claim.origins.push_back(poses[b].origin);
    claim.angles.push_back(poses[b].angle);
  }
  const std::vector<double> q = model.to_si(x);
  for (int t = 0; t < model.layout().kept; ++t) {
    if (std::find(arbitrary.begin(), arbitrary.end(), model.layout().coordinates[t].name) != arbitrary.end()) continue;
    claim.coordinates.push_back(meaning_of(model.layout(), t));
    claim.coordinates.back().value = q[t];
    claim.coordinates.back().origin = model.scales().length * model.layout().coordinates[t].origin;
  }
  return claim;
}

}  // namespace

Claim claim_of(const StaticModel& model, const Equilibrium& answer) {
  Claim claim = pose_claim(model, answer.x, answer.certificate.neutral_coordinates);
  claim.confirmed = answer.found();
  claim.kind = kind_of(answer.certificate.stability);
  claim.neutral = answer.certificate.outcome == Outcome::neutral;
  claim.radius = answer.certificate.radius;
  claim.minimum_sought = answer.seek == Seek::stable || traits(answer.method).minimises;
  return claim;
}

Claim claim_at(const StaticModel& model, const std::vector<double>& x, Kind kind, double radius) {
  Claim claim = pose_claim(model, x, {});
  claim.confirmed = true;
  claim.kind = kind;
  claim.radius = radius;
  return claim;
}

}  // namespace poise::judge
