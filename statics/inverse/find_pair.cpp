#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "model/input_error.hpp"
#include "statics/inverse/find_numbers.hpp"
#include "statics/inverse/private/sought_numbers.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/linear_response.hpp"

namespace poise {
namespace {

/// Two numbers for two conditions.
class PairFinder {
 public:
  PairFinder(const VariedPair& pair, const std::vector<WantedValue>& wanted, const FindOptions& options)
      : pair_(pair), wanted_(wanted), options_(options) {}

  FoundSet run();

 private:
  struct Slice {
    double second = 0.0;
    std::unique_ptr<VariedScene> varied;
    Path path;
  };
  /// A point of a slice, with the excess of both quantities, SI, and by how much they miss as parts of their spans.
  struct Start {
    std::size_t slice = 0, branch = 0, point = 0;
    std::array<double, 2> excess{};
    double miss = 0.0;
  };

  bool is_interrupted() const { return options_.path.interrupt != nullptr && *options_.path.interrupt; }
  void follow_slices();
  std::vector<Start> find_starts();
  void solve_from(const Start& start);
  std::optional<std::vector<double>> coordinates_at(const std::vector<double>& numbers,
                                                    const std::vector<double>& poses);
  const PathPoint& point_of(const Start& start) const {
    return slices_[start.slice].path.branches[start.branch].points[start.point];
  }

  const VariedPair& pair_;
  const std::vector<WantedValue>& wanted_;
  const FindOptions& options_;
  FoundSet out_;
  std::vector<Slice> slices_;
  std::vector<std::vector<double>> found_poses_;
};

void PairFinder::follow_slices() {
  const VariedScene& second = pair_.second();
  for (int k = 0; k < options_.slices && !is_interrupted(); ++k) {
    Slice slice;
    slice.second = second.value_at((k + 0.5) / options_.slices);
    slice.varied = std::make_unique<VariedScene>(pair_.first_at(slice.second));
    PathOptions options = options_.path;
    options.certify = false;
    options.at.clear();
    ++out_.paths;
    try {
      slice.path = path(*slice.varied, options);
    } catch (const InputError& error) {
      // It cannot be assembled there, or does not depend on the first number there.
      slice.path.status = Path::Status::no_start;
      slice.path.why = error.what();
    }
    if (slice.path.status == Path::Status::no_start) {
      out_.why = slice.path.why;
      continue;
    }
    out_.curves += static_cast<int>(slice.path.branches.size());
    out_.whole = out_.whole && slice.path.status == Path::Status::traced;
    slices_.push_back(std::move(slice));
  }
}

/// Points that are closer to both values than their neighbours, the closest first.
std::vector<PairFinder::Start> PairFinder::find_starts() {
  std::vector<Start> all;
  std::array<double, 2> least{}, most{};
  least.fill(std::numeric_limits<double>::infinity());
  most.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < slices_.size(); ++k) {
    PathReader reader(*slices_[k].varied);
    for (std::size_t b = 0; b < slices_[k].path.branches.size(); ++b) {
      const std::vector<PathPoint>& points = slices_[k].path.branches[b].points;
      for (std::size_t i = 0; i < points.size(); ++i) {
        Start one{k, b, i};
        // Both come from one solve of the efforts.
        const std::vector<QuantityValue> values = reader.values({wanted_[0].of, wanted_[1].of}, points[i]);
        for (std::size_t c = 0; c < 2; ++c) {
          one.excess[c] = values[c].value - wanted_[c].value;
          if (!std::isfinite(one.excess[c])) continue;
          least[c] = std::min(least[c], one.excess[c]);
          most[c] = std::max(most[c], one.excess[c]);
        }
        all.push_back(one);
      }
    }
  }
  for (Start& one : all) {
    one.miss = 0.0;
    for (std::size_t c = 0; c < 2; ++c) {
      const double span = std::max(most[c] - least[c], std::numeric_limits<double>::min());
      one.miss += std::isfinite(one.excess[c]) ? std::abs(one.excess[c]) / span : HUGE_VAL;
    }
  }
  std::vector<Start> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto beats = [&](std::size_t other) {
      return other >= all.size() || all[other].slice != all[i].slice || all[other].branch != all[i].branch ||
             all[i].miss <= all[other].miss;
    };
    if (std::isfinite(all[i].miss) && (i == 0 || beats(i - 1)) && beats(i + 1)) out.push_back(all[i]);
  }
  std::stable_sort(out.begin(), out.end(), [](const Start& a, const Start& b) { return a.miss < b.miss; });
  return out;
}

/// The coordinates of the mechanism with these numbers whose bodies are there: of a point of the curve over the first
/// number.
std::optional<std::vector<double>> PairFinder::coordinates_at(const std::vector<double>& numbers,
                                                              const std::vector<double>& poses) {
  const VariedScene varied = pair_.first_at(numbers[1]);
  PathOptions options = options_.path;
  options.certify = false;
  options.at = {numbers[0]};
  ++out_.paths;
  const Path found = path(varied, options);
  const auto model = varied.model_at(numbers[0]);
  constexpr double near = 1e-5;
  for (const std::vector<PathPoint>& points : found.wanted) {
    for (const PathPoint& point : points) {
      if (apart(poses_of(*model, point.x), poses) < near) return point.x;
    }
  }
  return std::nullopt;
}

void PairFinder::solve_from(const Start& start) {
  const Slice& slice = slices_[start.slice];
  const PathPoint& point = point_of(start);
  const SoughtNumbers sought({slice.varied.get(), &pair_.second()}, wanted_);
  const CurvePoint seen = sought.see(point, *slice.varied->model_at(point.parameter),
                                     {slice.varied->part_at(point.parameter), pair_.second().part_at(slice.second)});
  ConditionedEquilibrium system = sought.equations(seen.stops);
  ConditionedEquilibrium::Point at = system.begin(seen.poses, seen.s);
  if (!system.solve(at) || !within_ranges(at) || !sought.holds(system, at)) return;
  const std::vector<double> poses = poses_at(at, slice.varied->scene());
  const std::vector<double> numbers{sought.range(0).value_at(at.s[0]), sought.range(1).value_at(at.s[1])};
  for (std::size_t k = 0; k < found_poses_.size(); ++k) {
    constexpr double same = 1e-7;
    const FoundNumbers& other = out_.values[k];
    const double first =
        std::abs(other.numbers[0] - numbers[0]) / std::abs(sought.range(0).to() - sought.range(0).from());
    const double second =
        std::abs(other.numbers[1] - numbers[1]) / std::abs(sought.range(1).to() - sought.range(1).from());
    if (std::max({first, second, apart(found_poses_[k], poses)}) < same) return;
  }
  const std::optional<std::vector<double>> x = coordinates_at(numbers, poses);
  // Newton's method may lead to an equilibrium on a curve that was not followed.
  if (!x) return;
  const auto model = pair_.model_at(numbers[0], numbers[1]);
  out_.values.push_back(sought.examine(system, at, *model, *x, options_.path.certificate));
  found_poses_.push_back(poses);
}

FoundSet PairFinder::run() {
  using Status = FoundSet::Status;
  follow_slices();
  const std::vector<Start> starts = find_starts();
  constexpr std::size_t most_starts = 24;
  for (std::size_t k = 0; k < std::min(starts.size(), most_starts) && !is_interrupted(); ++k) solve_from(starts[k]);
  if (out_.values.empty() && !starts.empty()) {
    const Start& best = starts.front();
    constexpr double unknown_radius = std::numeric_limits<double>::infinity();
    out_.nearest = FoundNumbers{{point_of(best).parameter, slices_[best.slice].second},
                                {unknown_radius, unknown_radius},
                                {wanted_[0].value + best.excess[0], wanted_[1].value + best.excess[1]},
                                point_of(best),
                                false};
  }
  std::sort(out_.values.begin(), out_.values.end(),
            [](const FoundNumbers& a, const FoundNumbers& b) { return a.numbers < b.numbers; });
  out_.status = is_interrupted()       ? Status::interrupted
                : !out_.values.empty() ? Status::found
                : slices_.empty()      ? Status::no_start
                : starts.empty()       ? Status::undefined
                                       : Status::none;
  if (out_.status == Status::found) out_.why.clear();
  return out_;
}

}  // namespace

FoundSet find_numbers(const VariedPair& pair, const std::vector<WantedValue>& wanted, const FindOptions& options) {
  return PairFinder(pair, wanted, options).run();
}

}  // namespace poise
