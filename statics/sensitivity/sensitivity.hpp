#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/dimension.hpp"
#include "model/measure.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/paths/path.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {

/// How one number of the scene moves a quantity.
struct Sensitivity {
  std::string number;       ///< its path
  Dimension dimension{};    ///< of the number
  double value = 0.0;       ///< of the number, SI
  double derivative = 0.0;  ///< d quantity / d number, SI
  double rounding = 0.0;    ///< the derivative is known to within so much, SI
  std::string why;          ///< one sentence; there is no derivative by this number
};

/// All of them for one quantity.
struct QuantitySensitivity {
  SoughtQuantity of;
  double value = 0.0;  ///< SI
  std::string why;     ///< one sentence; there is no derivative at all
  std::vector<Sensitivity> by;
};

struct SensitivityOptions {
  SolveOptions solve{};
  std::optional<std::vector<double>> start{};  ///< scaled coordinates from which it settles; the scene's if not given
  OtherQuantities others{};                    ///< stresses and modes have values, but no derivatives
};

struct Sensitivities {
  Equilibrium equilibrium;
  std::string why;    ///< one sentence; there are no derivatives, because there is no regular equilibrium
  double size = 0.0;  ///< of the mechanism, m
  std::vector<QuantitySensitivity> of;
  int without = 0;  ///< numbers that statics does not use: guesses, drives, inertias, dampers and friction
};

/// Derivatives of quantities by every number of the scene, at its settled equilibrium. With z the places of the bodies
/// and the joint forces, R(z, p) = 0 the equations of equilibrium (statics/quantities/numbered_equations.hpp)
/// with the stops that act, and m(z, p) the quantity,
///
///   dm/dp = dm/dp|_z - mu^T dR/dp,   (dR/dz)^T mu = dm/dz|_p
///
/// (implicit function theorem; all derivatives by dual numbers). Where dR/dz loses rank, a quantity that moves along
/// its null space is undetermined, and a number for which a left null vector w has w . dR/dp != 0 cannot change alone.
///
/// At a fold, with w the left null vector there:  dP/dp = -(w . dR/dp) / (w . dR/dP). Where the curve turns because a
/// stop or one-way spring comes on or off, with h the force of that stop or the stretch of that spring:
/// dP/dp = -(dh/dp) / (dh/dP).
///
/// Throws InputError as solve() does, and for more than `most_unknowns`.
Sensitivities sensitivities(const StaticModel& model, const std::vector<SoughtQuantity>& of,
                            const SensitivityOptions& options = {});
/// The same at an equilibrium of the model that is known, with its certificate.
Sensitivities sensitivities(const StaticModel& model, Equilibrium equilibrium, const std::vector<SoughtQuantity>& of,
                            const SensitivityOptions& options = {});

/// The same at scaled coordinates x of a model that are in equilibrium with the stops `active` acting, a point of a
/// path say; or, with `moved`, in the equilibrium to which Newton's method leads from there in that scene, whose
/// numbers differ a little. Nothing is proved. None of loads at folds, stresses and modes.
std::vector<QuantitySensitivity> sensitivities_near(const StaticModel& model, const std::vector<double>& x,
                                                    const std::vector<int>& active,
                                                    const std::vector<SoughtQuantity>& of,
                                                    const Scene* moved = nullptr);

/// Derivatives of the varied number where a path folds, `event` of Path::events, by all other numbers: dP/dp as above.
/// The quantity has the name of the varied number.
QuantitySensitivity sensitivity_of_fold(const VariedScene& varied, const Path& found, std::size_t event);
/// The first fold on the path on which a load grows from the scene's own value, with the path that found it.
struct FirstFold {
  std::unique_ptr<VariedScene> varied;
  Path path;
  std::size_t event = 0;
  std::string why;  ///< one sentence; there is none
};
FirstFold first_fold(const StaticModel& model, const std::string& load, const std::atomic<bool>* interrupt = nullptr);

}  // namespace poise
