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

/// Whether pins join the frames of these coordinates to one chain, each at least to one other.
bool are_pinned_together(const Layout& layout, const Scene& scene, std::vector<int> frames) {
  std::vector<int> reached;
  const auto reach = [&](int frame) {
    const auto at = std::find(frames.begin(), frames.end(), frame);
    if (at == frames.end()) return false;
    reached.push_back(frame);
    frames.erase(at);
    return true;
  };
  const auto join = [&](int a, int b) {
    const auto known = [&](int frame) { return std::find(reached.begin(), reached.end(), frame) != reached.end(); };
    return (known(a) && reach(b)) || (known(b) && reach(a));
  };
  reach(frames.front());
  for (bool more = true; more && !frames.empty();) {
    more = false;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      const int a = layout.links[static_cast<std::size_t>(joint.a.body)].frame;
      const int b = layout.links[static_cast<std::size_t>(joint.b.body)].frame;
      if (joint.kind == Joint::Kind::pin) more = join(a, b) || more;
      if (joint.kind != Joint::Kind::bar) continue;
      for (const Link& bar : layout.links) {
        if (bar.joint == static_cast<int>(j)) more = join(a, bar.frame) || join(bar.frame, b) || more;
      }
    }
  }
  return frames.empty();
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
  const std::size_t others = closure.couplings().size() + closure.measured().size();
  for (std::size_t k = 0; k < others; ++k) {
    share.push_back(std::abs(pose.left[static_cast<Eigen::Index>(2 * closures + k)]));
  }
  const double most = *std::max_element(share.begin(), share.end());
  // What moves while the drives are fixed, and whether all of it acts on all those loops along one line.
  const double fastest = pose.right.cwiseAbs().maxCoeff();
  const Eigen::MatrixXd jacobian = closure.jacobian(pose.x);
  std::vector<std::string> loops, drives, movers, pushing;
  std::vector<int> pushing_frames;
  std::vector<Vec2> pushes;
  bool in_line = true;
  for (std::size_t i = 0; i < closure.free().size(); ++i) {
    if (std::abs(pose.right[static_cast<Eigen::Index>(i)]) <= takes_part * fastest) continue;
    const Coordinate& mover = layout.coordinates[closure.free()[i]];
    movers.push_back(mover.name);
    const std::size_t before = pushes.size();
    for (std::size_t l = 0; l < closures; ++l) {
      const Eigen::Vector2d push = jacobian.col(closure.free()[i]).segment<2>(2 * static_cast<Eigen::Index>(l));
      if (share[l] > takes_part * most && !push.isZero(0.0)) pushes.push_back({push.x(), push.y()});
    }
    // Others move along, in loops that stay regular.
    if (pushes.size() == before) continue;
    in_line = in_line && mover.kind == Coordinate::Kind::angle;
    pushing.push_back(mover.name);
    pushing_frames.push_back(closure.free()[i]);
  }
  const Scene& scene = closure.model().scene();
  for (std::size_t l = 0; l < share.size(); ++l) {
    if (!(share[l] > takes_part * most)) continue;
    const bool is_loop = l < closures;
    in_line = in_line && is_loop;
    if (l >= closures + closure.couplings().size()) {
      const int drive = closure.measured()[l - closures - closure.couplings().size()];
      drives.push_back(fmt::format("\"{}\"", scene.drives[static_cast<std::size_t>(drive)].name));
      continue;
    }
    loops.push_back(
        fmt::format("\"{}\"", is_loop ? layout.closures[l].name
                                      : scene.stops[static_cast<std::size_t>(closure.couplings()[l - closures])].name));
  }
  in_line = in_line && pushing.size() > 1 && are_pinned_together(layout, scene, pushing_frames);
  for (const Vec2& push : pushes) {
    in_line = in_line && std::abs(cross(pushes.front(), push)) < parallel * norm(pushes.front()) * norm(push);
  }
  const std::string of_loops =
      loops.empty() ? "" : fmt::format(" of the {} closed by {}", loops.size() == 1 ? "loop" : "loops", listed(loops));
  const std::string of_drives =
      drives.empty() ? "" : fmt::format("{} of {}", loops.empty() ? "" : " and", listed(drives));
  return fmt::format("{}{}: {} {}", of_loops, of_drives, listed(in_line ? pushing : movers),
                     in_line                    ? "are in line"
                     : closure.driven().empty() ? "can move in several ways"
                                                : "can move while the drives are fixed");
}

}  // namespace poise
