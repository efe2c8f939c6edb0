#include "motion/given_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "motion/driven_path.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double rank_tolerance = solvers::known_to::closed_point;
constexpr double motion_closed_within = 1e-13;
constexpr double motion_open_beyond = 1e-9;
// Samples that have to change by more than this, rad or mechanism sizes, do not belong to this mechanism.
constexpr double not_ours = 0.1;
constexpr int closing_steps = 50;

// Rate and second derivative at t[at] of the polynomial through the values, and the rates if there are any, of the
// samples first .. last-1: Newton's divided differences, each sample with a rate counted twice.
std::array<double, 2> derivatives(const std::vector<double>& t, const SampledCoordinate& samples, std::size_t first,
                                  std::size_t last, std::size_t at) {
  const double width = t[last - 1] - t[first];
  const bool twice = !samples.rate.empty();
  std::vector<double> node, difference, slope;
  for (std::size_t k = first; k < last; ++k) {
    for (int copy = 0; copy < (twice ? 2 : 1); ++copy) {
      node.push_back((t[k] - t[at]) / width);
      difference.push_back(samples.value[k]);
      slope.push_back(twice ? samples.rate[k] * width : 0.0);
    }
  }
  const std::size_t count = node.size();
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t k = count - 1; k >= order; --k) {
      const double step = node[k] - node[k - order];
      difference[k] = step == 0.0 ? slope[k] : (difference[k] - difference[k - 1]) / step;
    }
  }
  double value = 0.0, rate = 0.0, second = 0.0;
  for (std::size_t k = count; k-- > 0;) {
    second = 2 * rate - node[k] * second;
    rate = value - node[k] * rate;
    value = difference[k] - node[k] * value;
  }
  return {rate / width, second / (width * width)};
}

class Completion {
 public:
  Completion(const MotionModel& model, const std::vector<SampledCoordinate>& samples)
      : model_(model), closure_(model, sampled(samples)) {}

  // Closes the loops by Gauss-Newton steps, of the coordinates not sampled and then of all.
  void close(VectorXd& x, GivenMotion& out) const {
    const VectorXd before = x;
    for (const bool all : {false, true}) {
      for (int k = 0; k < closing_steps && gap(x) > motion_closed_within; ++k) {
        const VectorXd step = change(x, closure_.gap(x), all);
        x += step;
        if (step.cwiseAbs().maxCoeff() <= motion_closed_within) break;
      }
    }
    for (int i : closure_.driven()) out.closing = std::max(out.closing, std::abs(x[i] - before[i]));
  }

  double gap(const VectorXd& x) const {
    const VectorXd c = closure_.gap(x);
    return c.size() > 0 ? c.cwiseAbs().maxCoeff() : 0.0;
  }

  // `derivative` changed so that J derivative + rest = 0.
  void fit(const VectorXd& x, const VectorXd& rest, VectorXd& derivative) const {
    const MatrixXd jacobian = closure_.jacobian(x);
    for (const bool all : {false, true}) derivative += change(x, jacobian * derivative + rest, all);
  }

  VectorXd curvature(const VectorXd& x, const VectorXd& v) const { return closure_.curvature(x, v); }

  // Throws InputError if some coordinate is undetermined.
  void expect_decided(const VectorXd& x) const {
    if (closure_.free().empty()) return;
    const auto [rank, order] = solvers::pivot_order(closure_.free_columns(closure_.jacobian(x)), rank_tolerance);
    const auto decided = static_cast<std::size_t>(rank);
    if (decided == order.size()) return;
    const int open = closure_.free()[static_cast<std::size_t>(order[decided])];
    throw InputError(fmt::format("{}: motion: the motion of \"{}\" is undetermined; expected a column of that name",
                                 model_.scene().file,
                                 model_.layout().coordinates[static_cast<std::size_t>(open)].name));
  }

 private:
  static std::vector<int> sampled(const std::vector<SampledCoordinate>& samples) {
    std::vector<int> out;
    for (const SampledCoordinate& s : samples) out.push_back(s.coordinate);
    return out;
  }

  // The least change of all coordinates, or of those not sampled, that closes the gap `open` to first order.
  VectorXd change(const VectorXd& x, const VectorXd& open, bool all) const {
    VectorXd out = VectorXd::Zero(x.size());
    const MatrixXd jacobian = closure_.jacobian(x);
    if (jacobian.rows() == 0) return out;
    if (all) return -solvers::minimum_norm_solution(jacobian, open, rank_tolerance);
    if (closure_.free().empty()) return out;
    const VectorXd step = solvers::minimum_norm_solution(closure_.free_columns(jacobian), open, rank_tolerance);
    for (Index k = 0; k < step.size(); ++k) out[closure_.free()[static_cast<std::size_t>(k)]] = -step[k];
    return out;
  }

  const MotionModel& model_;
  SplitClosure closure_;
};

}  // namespace

GivenMotion complete_motion(const MotionModel& model, const std::vector<double>& time,
                            const std::vector<SampledCoordinate>& samples) {
  refuse_states_of_controllers(model.scene(), "motions that are given");
  const Completion completion(model, samples);
  const auto n = static_cast<Index>(model.start().size());
  const auto unit = [&](int coordinate) { return coordinate < model.layout().angles ? 1.0 : model.scales().length; };
  const std::vector<double> start = model.start();
  VectorXd x = VectorXd::Map(start.data(), n);
  GivenMotion out;
  for (std::size_t k = 0; k < time.size(); ++k) {
    VectorXd v = VectorXd::Zero(n);
    VectorXd a = VectorXd::Zero(n);
    for (const SampledCoordinate& s : samples) {
      const std::size_t window = std::min<std::size_t>(s.rate.empty() ? 7 : 5, time.size());
      const std::size_t first = std::min(k - std::min(k, window / 2), time.size() - window);
      const auto [rate, second] = derivatives(time, s, first, first + window, k);
      x[s.coordinate] = s.value[k] / unit(s.coordinate);
      v[s.coordinate] = (s.rate.empty() ? rate : s.rate[k]) / unit(s.coordinate);
      a[s.coordinate] = second / unit(s.coordinate);
    }
    const double gap = completion.gap(x);
    completion.close(x, out);
    if (completion.gap(x) > motion_open_beyond || out.closing > not_ours) {
      throw InputError(
          fmt::format("{}: motion: at {} s its samples do not close the loops, which are open by {:.3g} of the "
                      "mechanism's size; expected a motion of this scene",
                      model.scene().file, time[k], gap));
    }
    if (k == 0) completion.expect_decided(x);
    completion.fit(x, VectorXd::Zero(completion.curvature(x, v).size()), v);
    completion.fit(x, completion.curvature(x, v), a);
    out.x.emplace_back(x.begin(), x.end());
    out.v.emplace_back(v.begin(), v.end());
    out.a.emplace_back(a.begin(), a.end());
  }
  return out;
}

}  // namespace poise
