#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "model/layout.hpp"
#include "model/planar.hpp"
#include "model/scene.hpp"

namespace poise {

/// The part of a scene's energy that is a sum of products of phasors: weights, dead forces and springs of free length
/// zero,
///   V = Re sum_p w_p s_a(p) s_b(p) exp(i (theta_g(p) - theta_f(p))),
/// s lengths or 1, theta angles of frames or 0 of the ground. What multiplies the same phasors is added up, so that
/// loads which cancel in every pose leave the rounding of one coefficient; as terms of their own they cancel in small
/// boxes of poses only.
template <class T>
struct MergedEnergy {
  /// Coordinates of the angles f <= g and of the lengths a, along a line fixed in f, and b, in g; -1: the ground, or 1
  /// in place of a length.
  struct Product {
    int f = -1, g = -1, a = -1, b = -1;
    Planar<T> w{};
  };
  std::vector<Product> products;

  /// Adds a product, of which those that do not change the force are left out.
  void add(Product p) {
    if (p.f > p.g) {
      std::swap(p.f, p.g);
      std::swap(p.a, p.b);
      p.w = conj(p.w);
    }
    if (p.f == p.g) {
      if (p.a > p.b) std::swap(p.a, p.b);
      if (p.b < 0) return;  // constant
      p.w.y = T(0);
    }
    for (Product& known : products) {
      if (known.f != p.f || known.g != p.g || known.a != p.a || known.b != p.b) continue;
      known.w += p.w;
      return;
    }
    products.push_back(std::move(p));
  }
};

/// coefficient s exp(i theta_frame): a term of the place of a point, s the coordinate `length`, or 1 where it is -1.
template <class T>
struct PlaceTerm {
  int frame, length;
  Planar<T> coefficient;
};

/// The spring of free length zero that a force element is; null of others.
inline const LinearSpring* spring_without_free_length(const Element& element) {
  const auto* spring = std::get_if<LinearSpring>(&element.law);
  const bool is_one = spring != nullptr && element.on.kind == Measure::Kind::distance && spring->free_length == 0.0 &&
                      spring->acts != LinearSpring::Acts::compression;
  return is_one ? spring : nullptr;
}

/// The energy of a scene and its layout, which are measured in the same units. `numbers` turns numbers of the scene
/// into T, by functions length(), force(), force_per_length(), mass() and acceleration() of a double, and
/// turned(index into Layout::turns), direction(Vec2) and share_at_points(Scene, Force), which are null where T cannot
/// hold them: then so is the sum.
template <class T, class Numbers>
class EnergyMerger {
 public:
  EnergyMerger(const Scene& scene, const Layout& layout, const Numbers& numbers)
      : scene_(scene), layout_(layout), numbers_(numbers) {}

  std::optional<MergedEnergy<T>> run() {
    const Planar<T> gravity{numbers_.acceleration(scene_.gravity.x), numbers_.acceleration(scene_.gravity.y)};
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      if (body.mass != 0) add_load(static_cast<int>(i), body.center, numbers_.mass(body.mass) * gravity);
    }
    for (const Force& force : scene_.forces) {
      if (force.follows >= 0) continue;
      const std::optional<T> share = numbers_.share_at_points(scene_, force);
      if (!share) return std::nullopt;
      const Planar<T> at_point{*share * numbers_.force(force.vector.x), *share * numbers_.force(force.vector.y)};
      force.for_each_point([&](PointRef point) { add_load(point.body, scene_.local(point), at_point); });
    }
    for (const Element& element : scene_.elements) {
      if (const LinearSpring* spring = spring_without_free_length(element)) {
        add_spring(element.on, numbers_.force_per_length(spring->stiffness));
      }
    }
    if (!is_held_) return std::nullopt;
    return std::move(out_);
  }

  /// The gap p_b - p_a of a loop that a joint without travel closes; null as the sum.
  std::optional<std::vector<PlaceTerm<T>>> gap(const Closure& closure) {
    const Joint& joint = scene_.joints[static_cast<std::size_t>(closure.joint)];
    const bool from_body = !joint.keeps_length() || closure.link_a == joint.a.body;
    const bool to_body = !joint.keeps_length() || !from_body;
    const Vec2 a = from_body ? scene_.local(joint.a) : Vec2{joint.length, 0};
    add_between(closure.link_a, a, closure.link_b, to_body ? scene_.local(joint.b) : Vec2{});
    if (!is_held_) return std::nullopt;
    return terms_;
  }

 private:
  using Term = PlaceTerm<T>;

  void add_arm(const Arm& arm, bool negative) {
    const int at = arm.coordinate;
    if (at >= layout_.kept) return;  // it changes no energy
    const bool is_length = layout_.is_length(at);
    std::optional<Planar<T>> c;
    if (is_length)
      c = numbers_.direction(arm.arm);
    else
      c = Planar<T>{numbers_.length(arm.arm.x), numbers_.length(arm.arm.y)};
    const std::optional<Planar<T>> turn = numbers_.turned(arm.turn);
    if (!c || !turn) {
      is_held_ = false;
      return;
    }
    const int frame = is_length ? layout_.coordinates[static_cast<std::size_t>(at)].frame : at;
    const Planar<T> coefficient = (negative ? -*c : *c) * *turn;
    for (Term& term : terms_) {
      if (term.frame != frame || term.length != (is_length ? at : -1)) continue;
      term.coefficient += coefficient;
      return;
    }
    terms_.push_back({frame, is_length ? at : -1, coefficient});
  }

  void add_point(int link, Vec2 at, bool negative) {
    const Link& of = layout_.links[static_cast<std::size_t>(link)];
    if (at.x != 0 || at.y != 0) add_arm({of.frame, at, of.turn}, negative);
  }
  void add_link(int link, bool negative) {
    for (const Arm& arm : layout_.links[static_cast<std::size_t>(link)].arms) add_arm(arm, negative);
  }
  int parent(int link) const { return layout_.links[static_cast<std::size_t>(link)].parent; }
  int depth(int link) const { return layout_.links[static_cast<std::size_t>(link)].depth; }

  // V = -F . p.
  void add_load(int body, Vec2 at, const Planar<T>& force) {
    terms_.clear();
    add_point(body, at, false);
    for (int link = body; parent(link) >= 0; link = parent(link)) add_link(link, false);
    for (const Term& term : terms_) out_.add({-1, term.frame, -1, term.length, -(conj(force) * term.coefficient)});
  }

  void add_between(int a, Vec2 at_a, int b, Vec2 at_b) {
    terms_.clear();
    add_point(a, at_a, true);
    add_point(b, at_b, false);
    while (a != b) {
      const bool from_a = depth(a) > depth(b);
      int& link = from_a ? a : b;
      add_link(link, from_a);
      link = parent(link);
    }
  }

  // V = k/2 |p_b - p_a|^2.
  void add_spring(const Measure& on, const T& stiffness) {
    add_between(on.a.body, scene_.local(on.a), on.b.body, scene_.local(on.b));
    for (std::size_t j = 0; j < terms_.size(); ++j) {
      const Term& s = terms_[j];
      out_.add({s.frame, s.frame, s.length, s.length, {stiffness * dot(s.coefficient, s.coefficient) / T(2), T(0)}});
      for (std::size_t l = j + 1; l < terms_.size(); ++l) {
        const Term& t = terms_[l];
        out_.add({s.frame, t.frame, s.length, t.length, stiffness * (conj(s.coefficient) * t.coefficient)});
      }
    }
  }

  const Scene& scene_;
  const Layout& layout_;
  const Numbers& numbers_;
  std::vector<Term> terms_;
  bool is_held_ = true;
  MergedEnergy<T> out_;
};

}  // namespace poise
