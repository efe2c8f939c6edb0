#include "model/meshing.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace poise {
namespace {

/// The point of `carrier` about which a wheel turns on it; nothing where pins and welds keep no point of both together.
std::optional<PointRef> axis_on(const Scene& scene, int carrier, int wheel) {
  for (const Joint& joint : scene.joints) {
    if (joint.kind != Joint::Kind::pin && joint.kind != Joint::Kind::weld) continue;
    if (joint.a.body != wheel && joint.b.body != wheel) continue;
    for (const PointRef& point : coincident_points(scene, joint.a.body == wheel ? joint.a : joint.b)) {
      if (point.body == carrier) return point;
    }
  }
  return std::nullopt;
}

std::optional<Meshing> meshing_of_wheels(const Scene& scene, const Stop& gear) {
  const Measure& b = gear.on.terms[0].measure;
  const Measure& a = gear.on.terms[1].measure;
  const std::optional<PointRef> axis_a = axis_on(scene, a.body_a, a.body_b),
                                axis_b = axis_on(scene, b.body_a, b.body_b);
  if (!axis_a || !axis_b || scene.local(*axis_a) == scene.local(*axis_b)) return std::nullopt;
  if (gear.on.terms[1].factor == -1.0) return std::nullopt;
  return Meshing{*axis_a, *axis_b, a.body_b, b.body_b, -1};
}

std::optional<Meshing> meshing_of_rack(const Scene& scene, const Stop& rack) {
  const int slide = rack.on.terms[0].measure.joint;
  const Joint& joint = scene.joints[static_cast<std::size_t>(slide)];
  const Measure& pinion = rack.on.terms[1].measure;
  const bool is_first = joint.a.body == pinion.body_a;
  if (!joint.keeps_angle() || (!is_first && joint.b.body != pinion.body_a)) return std::nullopt;
  const std::optional<PointRef> axis = axis_on(scene, pinion.body_a, pinion.body_b);
  if (!axis) return std::nullopt;
  return Meshing{*axis, {}, pinion.body_b, is_first ? joint.b.body : joint.a.body, slide, is_first};
}

}  // namespace

std::vector<PointRef> coincident_points(const Scene& scene, PointRef p) {
  const auto same = [&](const PointRef& a, const PointRef& b) {
    return a.body == b.body && scene.local(a) == scene.local(b);
  };
  std::vector<PointRef> reached = {p};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    for (const Joint& joint : scene.joints) {
      if (joint.kind != Joint::Kind::pin && joint.kind != Joint::Kind::weld) continue;
      for (const auto& [from, to] : {std::pair(joint.a, joint.b), std::pair(joint.b, joint.a)}) {
        const bool known =
            std::any_of(reached.begin(), reached.end(), [&, to = to](const PointRef& r) { return same(r, to); });
        if (!known && same(from, reached[k])) reached.push_back(to);
      }
    }
  }
  return reached;
}

std::optional<Meshing> meshing(const Scene& scene, const Stop& stop) {
  if (stop.table == "gear") return meshing_of_wheels(scene, stop);
  if (stop.table == "rack") return meshing_of_rack(scene, stop);
  return std::nullopt;
}

bool loads_bearings(const Stop& stop) { return stop.roller || stop.pressure_tangent; }

ContactPlace contact_place(const Scene& scene, const Stop& stop) {
  ContactPlace out{meshing(scene, stop), cam_geometry(scene, stop)};
  if (out.mesh || out.cam) return out;
  throw InputError(fmt::format("{} \"{}\": its numbers leave no place for the contact", stop.family(), stop.name));
}

std::vector<int> loaded_joints(const Scene& scene, const Stop& stop) {
  std::vector<PointRef> axes;
  std::vector<int> out;
  if (const std::optional<Meshing> mesh = meshing(scene, stop)) {
    axes = {mesh->axis_a, mesh->slide < 0 ? mesh->axis_b : mesh->axis_a};
    if (mesh->slide >= 0) out.push_back(mesh->slide);
  } else if (const std::optional<CamGeometry> cam = cam_geometry(scene, stop)) {
    axes = {cam->axis, cam->slide < 0 ? cam->pivot : cam->axis};
    if (cam->slide >= 0) out.push_back(cam->slide);
  }
  for (const PointRef& axis : axes) {
    const std::vector<PointRef> points = coincident_points(scene, axis);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      if (joint.kind != Joint::Kind::pin && joint.kind != Joint::Kind::weld) continue;
      const bool is_there = std::any_of(points.begin(), points.end(), [&](const PointRef& p) {
        return p.body == joint.a.body && scene.local(p) == scene.local(joint.a);
      });
      if (is_there) out.push_back(static_cast<int>(j));
    }
  }
  return out;
}

bool separates(const Stop& stop) { return stop.pressure_tangent.value_or(0.0) != 0.0; }

const Stop* cam_that_may_lift(const Scene& scene) {
  const auto found = std::find_if(scene.stops.begin(), scene.stops.end(),
                                  [](const Stop& stop) { return stop.table == "cam" && !stop.holds(); });
  return found == scene.stops.end() ? nullptr : &*found;
}

bool transmits(const Stop& stop) {
  static const std::set<std::string_view> tables{"gear", "belt", "rack", "geneva", "coupling", "cam"};
  return tables.contains(stop.table);
}

}  // namespace poise
