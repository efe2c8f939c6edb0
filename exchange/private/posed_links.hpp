#pragma once

#include <string>
#include <utility>
#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise {

/// The links of a scene where they are in one position, as formats have them that know no frames: bodies that are
/// welded are one link, and a bar is a link too. Lengths are in the unit of the scene.
class PosedLinks {
 public:
  /// The poses are those of Mechanism::poses().
  PosedLinks(const Scene& scene, const std::vector<BodyPose<double>>& poses);

  struct Link {
    std::string name;
    std::vector<PointRef> points;  ///< in the order of the scene; none of a bar
    std::vector<Vec2> places;      ///< in the world; of a bar its two ends
  };
  /// Points that stay together: those that coincide by pins and welds, and ends of bars with what they are pinned to.
  struct Node {
    Vec2 at{};
    std::vector<std::size_t> links{};  ///< once each
    bool has(std::size_t link) const;
  };
  /// The first is the ground.
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  std::size_t node_of(PointRef point) const { return node_of_[index(point)]; }
  std::size_t link_of(int body) const { return link_of_[static_cast<std::size_t>(body)]; }
  /// In the world.
  Vec2 place(PointRef point) const;
  Vec2 place(int body, Vec2 local) const;
  /// A direction that is fixed in a body, in the world: a unit vector.
  Vec2 direction_in_world(int body, Vec2 local) const;

  /// Notes on all that these formats do not have: springs, dampers, stops, couplings, ...
  std::vector<std::string> left_out() const;
  /// A note on welds, where there are some.
  std::vector<std::string> welds() const;

 private:
  std::size_t index(PointRef point) const {
    return first_[static_cast<std::size_t>(point.body)] + static_cast<std::size_t>(point.point);
  }
  void find_links();
  void find_nodes();

  const Scene& scene_;
  const std::vector<BodyPose<double>>& poses_;
  std::vector<Link> links_;
  std::vector<std::size_t> link_of_, bars_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> first_, node_of_;  // of points: those of a body follow its first one
  double rounding_ = 0.0;                     // m: what is less is 0
};

}  // namespace poise
