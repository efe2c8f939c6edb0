#include "motion/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace poise {

double reading_error(std::span<const NodeValues> nodes, double t) {
  const std::size_t count = nodes.size();
  const double scale = nodes[count - 1].t - nodes[0].t;
  std::array<double, 12> s{}, row{};
  for (std::size_t m = 0; m < 3 * count; ++m) {
    s[m] = (nodes[m / 3].t - nodes[0].t) / scale;
    row[m] = nodes[m / 3].q - nodes[0].q;
  }
  for (std::size_t order = 1; order < 3 * count; ++order) {
    for (std::size_t m = 3 * count - 1; m >= order; --m) {
      const NodeValues& node = nodes[m / 3];
      const double apart = s[m] - s[m - order];
      if (apart != 0.0)
        row[m] = (row[m] - row[m - 1]) / apart;
      else
        row[m] = order == 1 ? scale * node.v : scale * scale * node.a / 2;
    }
  }
  const double at = (t - nodes[0].t) / scale;
  const std::size_t last = 3 * count - 1;
  double others = 1.0;
  for (std::size_t m = 0; m + 1 < last; ++m) others *= at - s[m];
  return std::abs(others) * (std::abs(row[last - 1]) + std::abs(row[last] * (at - s[last - 1])));
}

TrajectoryReader::TrajectoryReader(const Trajectory& trajectory, std::vector<int> coordinates, int derivatives)
    : trajectory_(trajectory),
      coordinates_(std::move(coordinates)),
      stride_(1 + static_cast<std::size_t>(trajectory.columns)),
      derivatives_(derivatives),
      value_(coordinates_.size() * stride_),
      rate_(value_.size()),
      acceleration_(value_.size()) {}

TrajectoryReader::Nodes TrajectoryReader::best_nodes(std::size_t interval) const {
  const std::size_t n = static_cast<std::size_t>(trajectory_.coordinates);
  const double middle = (trajectory_.t[interval] + trajectory_.t[interval + 1]) / 2;
  Nodes best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t count = 4; count >= 2; --count) {
    for (std::size_t first = interval + 2 > count ? interval + 2 - count : 0; first <= interval; ++first) {
      if (first + count > trajectory_.nodes()) break;
      const auto from = trajectory_.t.begin() + static_cast<std::ptrdiff_t>(first);
      const auto to = from + static_cast<std::ptrdiff_t>(count);
      if (count > 2 && std::adjacent_find(from, to) != to) continue;
      double error = 0.0;
      for (const int i : coordinates_) {
        std::array<NodeValues, 4> values;
        for (std::size_t k = 0; k < count; ++k) {
          const std::size_t at = (first + k) * n + static_cast<std::size_t>(i);
          values[k] = {trajectory_.t[first + k], trajectory_.q[at], trajectory_.v[at], trajectory_.a[at]};
        }
        error += reading_error({values.data(), count}, middle);
      }
      if (error < least) {
        least = error;
        best = {first, count};
      }
    }
  }
  return best;
}

// Newton's divided differences with every node used three times: value, rate, half the acceleration.
void TrajectoryReader::enter(std::size_t interval) {
  interval_ = interval;
  const auto [first, nodes] = best_nodes(interval);
  origin_ = trajectory_.t[interval];
  scale_ = trajectory_.t[interval + 1] - origin_;
  const std::size_t conditions = 3 * nodes;
  const std::size_t width = value_.size();
  node_.resize(conditions);
  newton_.resize(conditions * width);
  const std::size_t n = static_cast<std::size_t>(trajectory_.coordinates);
  const std::size_t columns = stride_ - 1;
  // Initially the rows hold, for every condition, the value of its node.
  const auto fill = [&](const std::vector<double>& main, const std::vector<double>& by, std::size_t k, double factor,
                        double* row) {
    for (const int i : coordinates_) {
      *row++ = factor * main[k * n + i];
      for (std::size_t c = 0; c < columns; ++c) *row++ = factor * by[(k * n + i) * columns + c];
    }
  };
  for (std::size_t m = 0; m < conditions; ++m) {
    const std::size_t k = first + m / 3;
    node_[m] = (trajectory_.t[k] - origin_) / scale_;
    fill(trajectory_.q, trajectory_.q_p, k, 1.0, &newton_[m * width]);
  }
  for (std::size_t order = 1; order < conditions; ++order) {
    for (std::size_t m = conditions - 1; m >= order; --m) {
      double* row = &newton_[m * width];
      const double apart = node_[m] - node_[m - order];
      if (apart != 0.0) {
        const double* before = row - width;
        const double inverse = 1.0 / apart;
        for (std::size_t i = 0; i < width; ++i) row[i] = (row[i] - before[i]) * inverse;
      } else if (order == 1) {
        fill(trajectory_.v, trajectory_.v_p, first + m / 3, scale_, row);
      } else {
        fill(trajectory_.a, trajectory_.a_p, first + m / 3, scale_ * scale_ / 2, row);
      }
    }
  }
}

void TrajectoryReader::at(double t) {
  const std::vector<double>& times = trajectory_.t;
  const std::size_t last = times.size() - 2;
  std::size_t interval = interval_ <= last && t >= times[interval_] ? interval_ : 0;
  if (interval + 1 < times.size() && t > times[interval + 1]) {
    const auto after = std::upper_bound(times.begin() + static_cast<std::ptrdiff_t>(interval), times.end(), t);
    interval = std::min(last, static_cast<std::size_t>(after - times.begin()) - 1);
  }
  while (interval < last && times[interval + 1] == times[interval]) ++interval;
  if (interval != interval_) enter(interval);
  const double s = (t - origin_) / scale_;
  s_ = s;
  const std::size_t width = value_.size();
  const std::size_t conditions = node_.size();
  // Horner's scheme for the polynomial and its derivative.
  const double* top = &newton_[(conditions - 1) * width];
  std::copy(top, top + width, value_.begin());
  if (derivatives_ == 0) {
    for (std::size_t m = conditions - 1; m-- > 0;) {
      const double* row = &newton_[m * width];
      const double from = s - node_[m];
      for (std::size_t i = 0; i < width; ++i) value_[i] = value_[i] * from + row[i];
    }
    return;
  }
  std::fill(rate_.begin(), rate_.end(), 0.0);
  std::fill(acceleration_.begin(), acceleration_.end(), 0.0);
  for (std::size_t m = conditions - 1; m-- > 0;) {
    const double* row = &newton_[m * width];
    const double from = s - node_[m];
    for (std::size_t i = 0; derivatives_ == 2 && i < width; ++i)
      acceleration_[i] = acceleration_[i] * from + 2 * rate_[i];
    for (std::size_t i = 0; i < width; ++i) {
      rate_[i] = rate_[i] * from + value_[i];
      value_[i] = value_[i] * from + row[i];
    }
  }
  for (double& r : rate_) r /= scale_;
  for (double& a : acceleration_) a /= scale_ * scale_;
}

// Horner's scheme for the polynomial and its Taylor coefficients at s.
double TrajectoryReader::derivative(std::size_t i, std::size_t order) const {
  const std::size_t width = value_.size();
  std::array<double, 4> taylor{newton_[(node_.size() - 1) * width + i * stride_]};
  for (std::size_t m = node_.size() - 1; m-- > 0;) {
    const double from = s_ - node_[m];
    for (std::size_t k = order; k > 0; --k) taylor[k] = taylor[k] * from + taylor[k - 1];
    taylor[0] = taylor[0] * from + newton_[m * width + i * stride_];
  }
  double out = taylor[order];
  for (std::size_t k = 1; k <= order; ++k) out *= static_cast<double>(k) / scale_;
  return out;
}

}  // namespace poise
