#pragma once

#include <cstddef>
#include <variant>

#include "model/measures/sum.hpp"
#include "model/plain_value.hpp"
#include "model/scene.hpp"

namespace poise {

/// The numbers of a scene as they are, in the scalar T, with the functions of Numbers: for one that does not vary them.
/// Refers to the scene.
template <class T>
class SceneNumbers {
 public:
  using Scalar = T;

  explicit SceneNumbers(const Scene& scene) : scene_(&scene) {}

  const Scene& scene() const { return *scene_; }

  Planar<T> point(PointRef point) const { return planar_cast<T>(scene_->local(point)); }
  T mass(int body) const { return T(body_of(body).mass); }
  T inertia(int body) const { return T(body_of(body).inertia); }
  Planar<T> center(int body) const { return planar_cast<T>(body_of(body).center); }
  Planar<T> gravity() const { return planar_cast<T>(scene_->gravity); }
  Planar<T> force(int force) const { return planar_cast<T>(scene_->forces[static_cast<std::size_t>(force)].vector); }
  Planar<T> along_force(int force) const {
    const Vec2& along = scene_->forces[static_cast<std::size_t>(force)].line_of_action();
    return along == Vec2{} ? Planar<T>{T(0), T(0)} : planar_cast<T>(direction<PlainOf<T>>(along));
  }
  T torque(int torque) const { return T(scene_->torques[static_cast<std::size_t>(torque)].value); }

  T kept_by(int joint) const {
    const Joint& of = scene_->joints[static_cast<std::size_t>(joint)];
    return T(of.keeps_length() ? of.length : of.angle);
  }
  Planar<T> axis(int joint) const {
    return planar_cast<T>(direction<PlainOf<T>>(scene_->joints[static_cast<std::size_t>(joint)].axis));
  }

  T blade_angle(int blade) const { return T(scene_->blades[static_cast<std::size_t>(blade)].angle); }

  T friction(int joint, int number) const {
    const Joint& of = scene_->joints[static_cast<std::size_t>(joint)];
    return T(of.friction_numbers()[static_cast<std::size_t>(number)].get(&of).value());
  }

  template <class Use>
  auto with_law(int element, Use use) const {
    return std::visit(use, scene_->elements[static_cast<std::size_t>(element)].law);
  }

  T limit(int stop, bool upper) const {
    const Stop& of = scene_->stops[static_cast<std::size_t>(stop)];
    return T(upper ? of.max : of.min);
  }
  T pressure_tangent(int stop) const { return T(*scene_->stops[static_cast<std::size_t>(stop)].pressure_tangent); }

  struct Term {
    T factor;
    const Measure::Term& given;

    bool has_profile() const { return given.profile != nullptr; }
    ProfileOf<T> profile() const { return profile_of<T>(given); }
    ProfileValue<T> at(const T& g) const { return profile_of<T>(given).at(g); }
  };
  Term term(const Measure& sum, std::size_t k, int /*stop*/) const { return {T(sum.terms[k].factor), sum.terms[k]}; }

 private:
  const Body& body_of(int body) const { return scene_->bodies[static_cast<std::size_t>(body)]; }

  const Scene* scene_;
};

/// What acts at each of the points of Force::for_each_point(), over Force::vector: 1, or half the length of the line.
template <class NumbersOfScene, class T = typename NumbersOfScene::Scalar>
T share_at_points(const NumbersOfScene& numbers, int force) {
  const Force& of = numbers.scene().forces[static_cast<std::size_t>(force)];
  return of.to ? T(norm(numbers.point(*of.to) - numbers.point(of.at)) / T(2)) : T(1);
}

}  // namespace poise
