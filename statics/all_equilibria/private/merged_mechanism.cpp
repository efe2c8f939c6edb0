#include "statics/all_equilibria/private/merged_mechanism.hpp"

#include <algorithm>

namespace poise {
namespace {

// Springs keep their place, so that poses have the same layout.
Scene without_merged(Scene scene) {
  scene.gravity = {};
  std::erase_if(scene.forces, [](const Force& force) { return force.follows < 0; });
  for (Element& element : scene.elements) {
    if (spring_without_free_length(element) != nullptr) std::get<LinearSpring>(element.law).stiffness = 0.0;
  }
  return scene;
}

}  // namespace

std::optional<Planar<Interval>> IntervalNumbers::turned(int turn) const {
  const Turn& of = layout.turns[static_cast<std::size_t>(turn)];
  if (of.angle.parts().empty()) return Planar<Interval>{Interval(1), Interval(0)};
  return unit(wide(of.to<Interval>()));
}

std::optional<Planar<Interval>> IntervalNumbers::direction(const Vec2& along) const {
  const auto exact = poise::direction<Interval>(along);
  return Planar<Interval>{wide(exact.x), wide(exact.y)};
}

MergedMechanism::MergedMechanism(const StaticModel& model)
    : all_([&] {
        const solvers::RoundingUp up;
        return Mechanism<Interval>(model.scaled_scene(), model.layout(), Purpose::statics);
      }()) {
  const Scene scene = model.scaled_scene();
  const bool any = std::any_of(scene.elements.begin(), scene.elements.end(),
                               [](const Element& e) { return spring_without_free_length(e) != nullptr; });
  if (!any) return;
  const solvers::RoundingUp up;
  const IntervalNumbers numbers{model.layout()};
  const auto merged = EnergyMerger<Interval, IntervalNumbers>(scene, model.layout(), numbers).run();
  if (!merged) return;
  products_ = merged->products;
  rest_.emplace(without_merged(scene), model.layout(), Purpose::statics);
  const auto n = static_cast<std::size_t>(all_.coordinates());
  entry_.assign(n * n, -1);
  const auto place = [&](int i, int j) -> int& {
    return entry_[static_cast<std::size_t>(i) * n + static_cast<std::size_t>(j)];
  };
  for (std::size_t e = 0; e < all_.tangent_row().size(); ++e) {
    place(all_.tangent_row()[e], all_.tangent_column()[e]) = static_cast<int>(e);
  }
  for (std::size_t e = 0; e < rest_->tangent_row().size(); ++e) {
    rest_entry_.push_back(place(rest_->tangent_row()[e], rest_->tangent_column()[e]));
  }
  rest_tangent_.resize(rest_entry_.size());
}

Interval MergedMechanism::length(const Planar<Interval>* pose, int coordinate) const {
  return coordinate < 0 ? Interval(1) : all_.phasors().value(pose, coordinate);
}

// w exp(i (theta_g - theta_f)).
Planar<Interval> MergedMechanism::turning(const Planar<Interval>* pose, const Product& p) const {
  if (p.f == p.g) return p.w;
  if (p.f < 0) return p.w * pose[p.g];
  return p.w * unit(all_.phasors().value(pose, p.g) - all_.phasors().value(pose, p.f));
}

void MergedMechanism::negative_force(const Interval* q, Planar<Interval>* pose, Interval* g) {
  if (!rest_) return all_.negative_force(q, pose, g);
  rest_->negative_force(q, pose, g);
  for (const Product& p : products_) {
    const Planar<Interval> w = turning(pose, p);
    const Interval a = length(pose, p.a);
    const Interval b = length(pose, p.b);
    if (p.f != p.g) {
      const Interval moment = a * b * w.y;
      g[p.g] -= moment;
      if (p.f >= 0) g[p.f] += moment;
    }
    if (p.a >= 0) g[p.a] += b * w.x;
    if (p.b >= 0) g[p.b] += a * w.x;
  }
}

void MergedMechanism::tangent(Planar<Interval>* pose, const Interval* multiplier, Interval* values) {
  if (!rest_) return all_.tangent(pose, multiplier, values);
  rest_->tangent(pose, multiplier, rest_tangent_.data());
  std::fill(values, values + all_.tangent_row().size(), Interval(0));
  for (std::size_t e = 0; e < rest_entry_.size(); ++e) values[rest_entry_[e]] += rest_tangent_[e];
  const int n = all_.coordinates();
  // A pair without an entry has an arm of zero, of which rounding may leave something.
  const auto add = [&](int i, int j, const Interval& by) {
    if (i < 0 || j < 0) return;
    const int places[] = {std::max(i, j) * n + std::min(i, j), std::min(i, j) * n + std::max(i, j)};
    for (int k = 0; k < (i != j && all_.has_follower_loads() ? 2 : 1); ++k) {
      const int entry = entry_[static_cast<std::size_t>(places[k])];
      if (entry >= 0) values[entry] += by;
    }
  };
  for (const Product& p : products_) {
    const Planar<Interval> w = turning(pose, p);
    const Interval a = length(pose, p.a);
    const Interval b = length(pose, p.b);
    if (p.f == p.g) {
      add(p.a, p.b, p.a == p.b ? Interval(2) * w.x : w.x);
      continue;
    }
    const Interval bending = a * b * w.x;
    add(p.g, p.g, -bending);
    add(p.f, p.f, -bending);
    add(p.f, p.g, bending);
    add(p.g, p.a, -(b * w.y));
    add(p.f, p.a, b * w.y);
    add(p.g, p.b, -(a * w.y));
    add(p.f, p.b, a * w.y);
    add(p.a, p.b, w.x);
  }
}

}  // namespace poise
