#include "statics/all_equilibria/private/assembly_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "solvers/linear_algebra.hpp"
#include "statics/all_equilibria/private/box_prover.hpp"
#include "statics/model/held_rows.hpp"

namespace poise {
namespace {

constexpr double smallest_width = 1e-3;  // width of boxes in which loops only nearly close
constexpr double least_rigid = 1e-5;     // width of boxes in which no rigid pose is told from poses that move
constexpr double same_assembly = 1e-9;
constexpr int most_boxes = 50000;
constexpr double half_turn_and_more = 3.1416;  // a little more

CoordinateBox all_poses(const StaticModel& model) {
  CoordinateBox out;
  for (std::size_t i = 0; i < model.start().size(); ++i) {
    const bool is_length = model.layout().is_length(static_cast<int>(i));
    const double reach = is_length ? LoopTurns::far_away : half_turn_and_more;
    out.emplace_back(model.start()[i] - reach, model.start()[i] + reach);
  }
  return out;
}

// Halves boxes of closed poses until `is_decided` says of each that it needs no more. False: there were too many.
template <class IsDecided>
bool search_closed_poses(const StaticModel& model, int repeated, const std::function<bool()>& stopped,
                         const IsDecided& is_decided) {
  BoxProver prover(model, std::vector<StopState>(model.mechanism().stops(), StopState::inactive), repeated);
  std::vector<CoordinateBox> waiting{all_poses(model)};
  for (int boxes = 0; !waiting.empty(); ++boxes) {
    if (boxes >= most_boxes || stopped()) return false;
    CoordinateBox box = std::move(waiting.back());
    waiting.pop_back();
    BoxProver::Verdict verdict;
    {
      const solvers::RoundingUp up;
      verdict = prover.examine_closed_poses(box);
    }
    if (verdict.decision == BoxProver::Decision::empty) continue;
    if (is_decided(box, verdict.decision == BoxProver::Decision::unique)) continue;
    CoordinateBox other = box;
    verdict.cut(box, other);
    waiting.push_back(std::move(other));
    waiting.push_back(std::move(box));
  }
  return true;
}

std::vector<double> middle_of(const CoordinateBox& box) {
  std::vector<double> out;
  for (const Interval& x : box) out.push_back(x.middle());
  return out;
}

}  // namespace

void find_assembly_modes(const StaticModel& model, int repeated, LoopTurns& loops,
                         const std::function<bool()>& stopped) {
  const auto is_decided = [&](const CoordinateBox& box, bool is_regular) {
    const bool is_small = widest(box) <= smallest_width;
    if (!is_small && !is_regular) return false;
    if (loops.passes(lower_corner(box), upper_corner(box))) return true;
    const std::vector<double> middle = middle_of(box);
    const std::vector<double> pose = loops.closed(middle);
    const bool is_inside = !pose.empty() && loops.distance(pose, middle) <= 0.5 * widest(box);
    if (is_inside) loops.add(pose);
    return is_inside || is_small;
  };
  const auto ends = [&] { return !loops.known() || stopped(); };
  if (!search_closed_poses(model, repeated, ends, is_decided)) loops.doubt();
}

RigidPoses find_rigid_poses(const StaticModel& model, int repeated, const LoopTurns& loops,
                            const std::function<bool()>& stopped) {
  RigidPoses out;
  bool all = true;
  const auto is_decided = [&](const CoordinateBox& box, bool is_regular) {
    const double wide = widest(box);
    const bool is_small = wide <= 0.5 * RigidPoses::apart;
    if (!is_small && !is_regular) return false;
    const std::vector<double> middle = middle_of(box);
    const std::vector<double> pose = loops.closed(middle);
    const double away = pose.empty() ? std::numeric_limits<double>::infinity() : loops.distance(pose, middle);
    if (is_regular && away <= 0.5 * wide) {
      // A pose on a face of two boxes is met twice.
      const bool is_new = std::none_of(out.poses.begin(), out.poses.end(), [&](const std::vector<double>& known) {
        return loops.distance(known, pose) < same_assembly;
      });
      if (is_new) out.poses.push_back(pose);
      return true;
    }
    const bool moves =
        !is_regular && away <= RigidPoses::apart && freedoms_of(model, pose, solvers::known_to::singular_point) > 0;
    if (moves) return true;
    all = all && wide > least_rigid;
    return wide <= least_rigid;
  };
  out.are_all = search_closed_poses(model, repeated - 1, stopped, is_decided) && all;
  return out;
}

}  // namespace poise
