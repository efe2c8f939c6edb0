// Compiled for directed rounding.
#include "design/balance/pose_torques.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "solvers/interval.hpp"

namespace poise {
namespace {

using solvers::Interval;

// A box of the coordinates, for one of the torques.
struct Box {
  std::vector<Interval> q;
  std::size_t torque = 0;
  double upper = 0.0;
  std::size_t split = 0;  // the coordinate that is halved next

  friend bool operator<(const Box& a, const Box& b) { return a.upper < b.upper; }
};

PlacedCoordinates<Interval> placed(const TorqueForm& form, const std::vector<Interval>& q) {
  PlacedCoordinates<Interval> out{q, {}};
  for (std::size_t k = 0; k < q.size(); ++k) {
    Planar<Interval> unit{};
    if (form.is_length[k] == 0) sin_cos(q[k], unit.y, unit.x);
    out.unit.push_back(unit);
  }
  return out;
}

// Bounds the torque over a box, by its values and by its derivatives there; `reached` in the box's middle. The box is
// halved where the torque changes most, so that coordinates that it does not depend on are left alone.
void bound(const TorqueForm& form, const std::vector<double>& k, Box& box, double& reached,
           std::vector<double>& middle) {
  const std::size_t n = box.q.size();
  std::vector<Interval> m;
  middle.clear();
  for (const Interval& side : box.q) {
    middle.push_back(side.middle());
    m.emplace_back(middle.back());
  }
  const Interval here = torques_at(form, k, placed(form, m)).value[box.torque];
  const Torques<Interval> over = torques_at(form, k, placed(form, box.q));
  reached = here.mignitude();
  Interval mean = here;
  double most = -1.0;
  for (std::size_t l = 0; l < n; ++l) {
    const Interval change = over.by[box.torque * n + l] * (box.q[l] - m[l]);
    mean += change;
    const double size = std::isnan(change.magnitude()) ? box.q[l].width() : change.magnitude();
    if (size <= most) continue;
    most = size;
    box.split = l;
  }
  const double by_mean = mean.magnitude(), direct = over.value[box.torque].magnitude();
  box.upper = std::isnan(by_mean) || by_mean > direct ? direct : by_mean;
  if (std::isnan(box.upper)) box.upper = std::numeric_limits<double>::infinity();
}

}  // namespace

LargestTorque largest_torque(const TorqueForm& form, const std::vector<double>& stiffnesses,
                             const std::vector<double>& from, const std::vector<double>& to, double gap,
                             double rounding, int most) {
  const solvers::RoundingUp upwards;
  LargestTorque out;
  std::priority_queue<Box> boxes;
  const auto enter = [&](Box box) {
    double reached = 0.0;
    std::vector<double> middle;
    bound(form, stiffnesses, box, reached, middle);
    ++out.boxes;
    if (reached > out.reached || out.at.empty()) {
      out.reached = reached;
      out.at = middle;
    }
    if (box.upper > out.reached) boxes.push(std::move(box));
  };
  const std::size_t n = from.size();
  for (std::size_t torque = 0; torque < n; ++torque) {
    // The corners of the range are met, since the largest torque is often there.
    for (std::size_t corner = 0; corner < (std::size_t{1} << n); ++corner) {
      Box point;
      point.torque = torque;
      for (std::size_t k = 0; k < n; ++k) point.q.emplace_back((corner >> k & 1) != 0 ? to[k] : from[k]);
      enter(std::move(point));
    }
    Box whole;
    whole.torque = torque;
    for (std::size_t k = 0; k < n; ++k) whole.q.emplace_back(from[k], to[k]);
    enter(std::move(whole));
  }
  out.upper = out.reached;
  while (!boxes.empty()) {
    out.upper = std::max(boxes.top().upper, out.reached);
    if (out.upper <= std::max(out.reached * (1 + gap), rounding) || out.boxes >= most) return out;
    const Box box = boxes.top();
    boxes.pop();
    const Interval side = box.q[box.split];
    const double middle = side.middle();
    for (const Interval& half : {Interval(side.lower(), middle), Interval(middle, side.upper())}) {
      Box part = box;
      part.q[box.split] = half;
      enter(std::move(part));
    }
  }
  out.upper = out.reached;
  return out;
}

double least_largest_torque(const TorqueForm& form, const std::vector<WeighedTorque>& torques,
                            const std::vector<double>& least, const std::vector<double>& greatest) {
  const solvers::RoundingUp rounding;
  const std::size_t sought = least.size();
  Interval sum(0.0), total(0.0);
  std::vector<Interval> slope(sought, Interval(0.0));
  const std::vector<double> none(sought, 0.0);
  for (const WeighedTorque& one : torques) {
    const std::vector<Interval> q(one.q.begin(), one.q.end());
    const PlacedCoordinates<Interval> at = placed(form, q);
    const Interval weight(one.weight);
    total += Interval(std::abs(one.weight));
    sum += weight * torques_at(form, none, at).value[one.coordinate];
    for (const TorqueForm::Spring& spring : form.springs) {
      if (spring.sought < 0) continue;
      // What a unit of stiffness adds to that: the forces that do not depend on it are in the sum already.
      TorqueForm::Spring alone = spring;
      alone.force = 0.0;
      Torques<Interval> by;
      by.value.assign(q.size(), Interval(0.0));
      by.by.assign(q.size() * q.size(), Interval(0.0));
      add_spring(form, alone, 1.0, at, by);
      slope[static_cast<std::size_t>(spring.sought)] += weight * by.value[one.coordinate];
    }
  }
  for (std::size_t i = 0; i < sought; ++i) {
    const Interval low = slope[i] * Interval(least[i]), high = slope[i] * Interval(greatest[i]);
    sum += Interval(std::min(low.lower(), high.lower()), std::min(low.upper(), high.upper()));
  }
  const Interval bound = sum / total;
  return bound.lower() > 0.0 ? bound.lower() : 0.0;
}

}  // namespace poise
