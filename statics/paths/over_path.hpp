#pragma once

#include <string>
#include <vector>

#include "statics/paths/path_measures.hpp"

namespace poise {

/// A quantity over one branch of a path.
struct OverPathValue {
  double value = 0.0;      ///< SI; not a number where it has none
  std::string why;         ///< it has none, in one sentence
  std::vector<double> at;  ///< values of the varied number, SI, at which the extremes that it is made of are attained
  bool is_attained_twice = false;  ///< an extreme is attained at several places: its derivatives are one-sided there
};

/// With p the varied number and Q(p) the quantity along the branch, whose curve is followed between its points too:
///
///   max(Q), min(Q)   the extremes, to 1e-9 of the largest size of Q on the branch
///   span(Q)          their difference
///   mean(Q)          integral of Q |dp| over that of |dp|
///   work(Q)          integral of Q dm, m the place along its direction of the point that a push acts on, the length or
///                    angle of an element, what a drive drives; positive where the push, or the drive, does work and
///                    where an element takes it up
///
/// Integrals are those of curves of third order through the points and the places between them, halved until they no
/// longer change by 1e-9. `of` is over a path (SoughtQuantity::is_over_path()). Nothing where Q is undefined at a point
/// of the branch, or grows without bound.
OverPathValue over_path(const VariedScene& varied, const PathBranch& branch, const SoughtQuantity& of,
                        const OtherQuantities& others = {});

}  // namespace poise
