#include "motion/singular_words.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace poise {
namespace {

constexpr double takes_part = 0.02;  // relative to the largest component of a singular vector
constexpr double parallel = 1e-4;    // sine of the angle between

std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return names.empty() ? "" : names.front();
  const std::vector<std::string> head(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", fmt::join(head, ", "), names.back());
}

}  // namespace

std::string describe_singularity(const SplitClosure& closure, const PathPose& pose) {
  const Layout& layout = closure.model().layout();
  if (pose.left.size() == 0) return "";
  const std::size_t closures = layout.closures.size();
  std::vector<double> share(closures);
  for (std::size_t l = 0; l < closures; ++l) {
    share[l] = pose.left.segment<2>(2 * static_cast<Eigen::Index>(l)).norm();
  }
  for (std::size_t k = 0; k < closure.couplings().size(); ++k) {
    share.push_back(std::abs(pose.left[static_cast<Eigen::Index>(2 * closures + k)]));
  }
  const double most = *std::max_element(share.begin(), share.end());
  // What moves while the drives are fixed, and whether all of it acts on all those loops along one line.
  const double fastest = pose.right.cwiseAbs().maxCoeff();
  const Eigen::MatrixXd jacobian = closure.jacobian(pose.x);
  std::vector<std::string> loops, movers;
  std::vector<Vec2> pushes;
  bool in_line = true;
  for (std::size_t i = 0; i < closure.free().size(); ++i) {
    if (std::abs(pose.right[static_cast<Eigen::Index>(i)]) <= takes_part * fastest) continue;
    const Coordinate& mover = layout.coordinates[closure.free()[i]];
    movers.push_back(mover.name);
    in_line = in_line && mover.kind == Coordinate::Kind::angle;
    for (std::size_t l = 0; l < closures; ++l) {
      const Eigen::Vector2d push = jacobian.col(closure.free()[i]).segment<2>(2 * static_cast<Eigen::Index>(l));
      if (share[l] > takes_part * most && !push.isZero(0.0)) pushes.push_back({push.x(), push.y()});
    }
  }
  for (std::size_t l = 0; l < share.size(); ++l) {
    if (!(share[l] > takes_part * most)) continue;
    const bool is_loop = l < closures;
    in_line = in_line && is_loop;
    loops.push_back(fmt::format(
        "\"{}\"",
        is_loop ? layout.closures[l].name
                : closure.model().scene().stops[static_cast<std::size_t>(closure.couplings()[l - closures])].name));
  }
  in_line = in_line && movers.size() > 1 && !pushes.empty();
  for (const Vec2& push : pushes) {
    in_line = in_line && std::abs(cross(pushes.front(), push)) < parallel * norm(pushes.front()) * norm(push);
  }
  return fmt::format(" of the {} closed by {}: {} {}", loops.size() == 1 ? "loop" : "loops", listed(loops),
                     listed(movers), in_line ? "are in line" : "can move while the drives are fixed");
}

}  // namespace poise
