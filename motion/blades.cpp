#include "motion/blades.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Reduced = ReducedMotion<double>;

/// Parts of a condition below this part of its terms are rounding.
constexpr double rounding_of_conditions = 1e-9;

std::string title_of(const MotionModel& model, int blade) {
  const Blade& of = model.scene().blades[static_cast<std::size_t>(blade)];
  return fmt::format("{}:{}: blade \"{}\"", model.scene().file, of.line, of.name);
}

/// A of one blade, by all coordinates.
std::vector<double> row_of(const Reduced& motion, int blade) {
  std::vector<double> out(static_cast<std::size_t>(motion.coordinates()), 0.0);
  motion.add_blade(blade, out.data());
  return out;
}

void refuse_friction_with_blades(const Scene& scene) {
  const auto refuse = [&](int line, const std::string& item) {
    throw InputError(fmt::format(
        "{}:{}: {}: friction that sticks is not treated beside blades (\"{}\"), which may hold what it holds; expected "
        "a table [[friction]] with some width",
        scene.file, line, item, scene.blades.front().name));
  };
  for (const Joint& joint : scene.joints) {
    if (joint.friction) refuse(joint.line, fmt::format("{} \"{}\".friction", joint.traits().key, joint.name));
  }
  for (const Stop& stop : scene.stops) {
    if (stop.friction) refuse(stop.line, fmt::format("{} \"{}\".friction", stop.family(), stop.name));
  }
  for (const Element& element : scene.elements) {
    if (sticks(element.law)) refuse(element.line, fmt::format("{} \"{}\"", element.family(), element.name));
  }
}

}  // namespace

Eigen::MatrixXd blade_conditions(const Reduced& motion) {
  Eigen::MatrixXd out(motion.blades(), motion.freedoms());
  for (int b = 0; b < motion.blades(); ++b) {
    const std::vector<double> row = row_of(motion, b);
    const Eigen::Map<const Eigen::VectorXd> A(row.data(), static_cast<Index>(row.size()));
    for (int k = 0; k < motion.freedoms(); ++k) {
      out(b, k) = A.dot(Eigen::Map<const Eigen::VectorXd>(motion.B(k), A.size()));
    }
  }
  return out;
}

Eigen::VectorXd left_by(const Eigen::MatrixXd& conditions, Eigen::VectorXd row) {
  Eigen::MatrixXd basis = conditions.transpose();
  // Twice, so that what is left of a row that nearly follows from others has no part along them.
  for (Index k = 0; k < basis.cols(); ++k) {
    const double whole = basis.col(k).norm();
    for (int round = 0; round < 2; ++round) {
      for (Index j = 0; j < k; ++j) basis.col(k) -= basis.col(j).dot(basis.col(k)) * basis.col(j);
    }
    const double left = basis.col(k).norm();
    if (left > rounding_of_conditions * whole)
      basis.col(k) /= left;
    else
      basis.col(k).setZero();
  }
  for (int round = 0; round < 2; ++round) {
    for (Index j = 0; j < basis.cols(); ++j) row -= basis.col(j).dot(row) * basis.col(j);
  }
  return row;
}

void refuse_idle_blades(const MotionModel& model, const Reduced& motion) {
  if (motion.blades() == 0) return;
  refuse_friction_with_blades(model.scene());
  const Eigen::MatrixXd conditions = blade_conditions(motion);
  for (int b = 0; b < motion.blades(); ++b) {
    const Blade& blade = model.scene().blades[static_cast<std::size_t>(b)];
    double terms = 0.0;
    for (int k = 0; k < motion.freedoms(); ++k) terms += motion.blade_terms(b, motion.B(k));
    const Eigen::VectorXd own = conditions.row(b).transpose();
    if (!(own.norm() > rounding_of_conditions * terms)) {
      throw InputError(fmt::format(
          "{}.at: expected a point that can move across the edge of the blade, found {}, which the joints, drives and "
          "stops keep from it; the blade holds nothing, leave it out or give it another point",
          title_of(model, b), model.scene().name_of(blade.at)));
    }
    if (!(left_by(conditions.topRows(b), own).norm() > rounding_of_conditions * terms)) {
      throw InputError(fmt::format(
          "{}: its condition repeats those of {}, so that the forces of these blades are not known; expected blades "
          "of which none follows from others, leave one out",
          title_of(model, b),
          b == 1 ? fmt::format("blade \"{}\"", model.scene().blades.front().name)
                 : std::string("the blades before it")));
    }
  }
}

void refuse_rates_across_blades(const MotionModel& model, const Reduced& motion) {
  for (int b = 0; b < motion.blades(); ++b) {
    if (std::abs(motion.blade_rate(b)) <= rounding_of_conditions * motion.blade_terms(b, motion.v())) continue;
    throw InputError(fmt::format(
        "{}: the motion would begin with {} at {:.3g} m/s across its edge; expected a start along it, give other rates",
        title_of(model, b), model.scene().name_of(model.scene().blades[static_cast<std::size_t>(b)].at),
        std::abs(motion.blade_rate(b)) * model.scales().length));
  }
}

double blade_force(const Scene& scene, std::size_t blade, const Forces& forces) {
  const Blade& of = scene.blades[blade];
  const auto reaction = std::find_if(forces.reactions.begin(), forces.reactions.end(),
                                     [&](const Reaction& one) { return one.kind == "blade" && one.name == of.name; });
  const bool is_known = reaction != forces.reactions.end() && reaction->determined && !forces.friction.has_no_forces();
  if (!is_known) return std::numeric_limits<double>::quiet_NaN();
  return cross(unit(forces.motions[static_cast<std::size_t>(of.at.body)].pose.angle + of.angle), reaction->force);
}

}  // namespace poise
