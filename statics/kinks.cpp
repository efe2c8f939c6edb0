#include "statics/kinks.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra.hpp"
#include "statics/body_measures.hpp"
#include "statics/curvature.hpp"

namespace poise {
namespace {

constexpr double at_kink = 1e-9;  // of the mechanism's size
constexpr double beyond = 1e-8;   // change of free lengths that makes springs act, or not
constexpr double aside = 1e-5;    // rad or sizes: displacement at which a side is evaluated

double value_at(const StaticModel& model, const Element& element, const std::vector<double>& x) {
  return value_of(model.scene(), element.on, model.poses(x));
}

LinearSpring& spring_of(Element& element) { return std::get<LinearSpring>(element.law); }
const LinearSpring& spring_of(const Element& element) { return std::get<LinearSpring>(element.law); }

double unit_of(const StaticModel& model, const Element& element) {
  return element.on.is_angle() ? 1.0 : model.scales().length;
}

ReducedHessian<double> reduced_with(const StaticModel& model, const std::vector<double>& x,
                                    const std::vector<int>& rows, const std::vector<int>& springs,
                                    const std::vector<char>& act) {
  Scene scene = model.scene();
  for (std::size_t k = 0; k < springs.size(); ++k) {
    Element& element = scene.elements[springs[k]];
    LinearSpring& spring = spring_of(element);
    const bool longer = (spring.acts == LinearSpring::Acts::tension) != (act[k] != 0);
    spring.free_length += (longer ? beyond : -beyond) * unit_of(model, element);
  }
  const StaticModel changed(scene, model.scales());
  return {changed.mechanism(), x, rows};
}

// Sign of the smallest eigenvalue, -1, 0 or 1.
int sign_of_least(const ReducedHessian<double>& reduced, double zero) {
  const double least = solvers::symmetric_eigenvalues(reduced.matrix)[0];
  return least > zero ? 1 : least < -zero ? -1 : 0;
}

}  // namespace

std::vector<int> springs_at_kinks(const StaticModel& model, const std::vector<double>& x) {
  std::vector<int> out;
  const std::vector<Element>& elements = model.scene().elements;
  for (std::size_t s = 0; s < elements.size(); ++s) {
    const auto* const spring = std::get_if<LinearSpring>(&elements[s].law);
    if (spring == nullptr || spring->acts == LinearSpring::Acts::both || spring->stiffness == 0.0) continue;
    if (elements[s].on.kind == Measure::Kind::distance && spring->free_length == 0.0) continue;
    const double over = value_at(model, elements[s], x) - spring->free_length;
    if (std::abs(over) <= at_kink * unit_of(model, elements[s])) out.push_back(static_cast<int>(s));
  }
  return out;
}

Stability stability_at_kinks(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& rows,
                             const std::vector<int>& springs, double zero) {
  const ReducedHessian<double> none = reduced_with(model, x, rows, springs, std::vector<char>(springs.size(), 0));
  if (sign_of_least(none, zero) > 0) return Stability::stable;
  if (sign_of_least(reduced_with(model, x, rows, springs, std::vector<char>(springs.size(), 1)), zero) < 0) {
    return Stability::unstable;
  }
  if (none.matrix.rows() != 1) return Stability::unknown;
  int least = 1;
  for (const double side : {-aside, aside}) {
    std::vector<double> moved = x;
    for (std::size_t i = 0; i < x.size(); ++i) moved[i] += side * none.basis(static_cast<Eigen::Index>(i), 0);
    std::vector<char> act;
    for (int s : springs) {
      const Element& element = model.scene().elements[s];
      const bool longer = value_at(model, element, moved) > value_at(model, element, x);
      act.push_back(longer == (spring_of(element).acts == LinearSpring::Acts::tension));
    }
    least = std::min(least, sign_of_least(reduced_with(model, x, rows, springs, act), zero));
  }
  return least > 0 ? Stability::stable : least < 0 ? Stability::unstable : Stability::neutral;
}

}  // namespace poise
