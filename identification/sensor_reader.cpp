#include "identification/sensor_reader.hpp"

#include <algorithm>
#include <cmath>

#include "model/mechanism.hpp"

namespace poise {

SensorReader::SensorReader(const ScaledModel& model, const Sensor& sensor) : kind_(sensor.kind), rate_(sensor.rate) {
  const Layout& layout = model.layout();
  const double size = model.scales().length;
  // The layout is measured in the model's scales.
  const auto local = [&](PointRef p) { return model.scales().per_length() * model.scene().local(p); };
  const auto coordinate_at = [&](int i) -> const Coordinate& {
    return layout.coordinates[static_cast<std::size_t>(i)];
  };
  const auto place_of = [&](int coordinate) {
    const auto at = std::find(coordinates_.begin(), coordinates_.end(), coordinate);
    if (at != coordinates_.end()) return static_cast<int>(at - coordinates_.begin());
    coordinates_.push_back(coordinate);
    return static_cast<int>(coordinates_.size()) - 1;
  };
  const auto add = [&](int coordinate, double sign) {
    if (coordinate < 0) return;
    if (coordinate >= layout.kept) {
      const Coordinate& c = coordinate_at(coordinate);
      constant_ += sign * (c.kind == Coordinate::Kind::angle ? 1.0 : size) * c.start;
      return;
    }
    place_of(coordinate);
    sign_.push_back(sign);
  };
  if (kind_ == Sensor::Kind::angle) {
    const Link& a = layout.links[static_cast<std::size_t>(sensor.body_a)];
    const Link& b = layout.links[static_cast<std::size_t>(sensor.body_b)];
    constant_ = b.turn - a.turn;
    if (a.frame == b.frame) return;
    add(b.frame, 1.0);
    add(a.frame, -1.0);
    return;
  }
  if (kind_ == Sensor::Kind::travel) {
    add(layout.travel[static_cast<std::size_t>(sensor.item)], 1.0);
    return;
  }
  PointRef from{};  // the ground's origin
  PointRef to = sensor.b;
  if (kind_ == Sensor::Kind::distance) from = sensor.a;
  if (kind_ == Sensor::Kind::spring_force) {
    const Spring& spring = model.scene().springs[static_cast<std::size_t>(sensor.item)];
    from = spring.a;
    to = spring.b;
    acts_ = spring.acts;
  }
  const bool from_world = kind_ == Sensor::Kind::x || kind_ == Sensor::Kind::y;
  for (const Arm& arm :
       layout.path(from_world ? 0 : from.body, from_world ? Vec2{} : local(from), to.body, local(to))) {
    Planar<double> c = coefficient<double>(arm);
    int frame = arm.coordinate;
    bool slides = false;
    if (arm.coordinate >= 0 && coordinate_at(arm.coordinate).kind == Coordinate::Kind::length) {
      frame = coordinate_at(arm.coordinate).frame;
      slides = arm.coordinate < layout.kept;
      // What the model dropped stays where the scene's start puts it.
      if (!slides) c = coordinate_at(arm.coordinate).start * c;
    }
    if (!slides) c = size * c;
    if (frame >= layout.kept) c = c * unit(coordinate_at(frame).start);
    const bool turns = frame >= 0 && frame < layout.kept;
    if (!slides && !turns) {
      offset_ += c;
      continue;
    }
    Term term;
    term.is_angle = !slides;
    term.coefficient = c;
    term.own = place_of(slides ? arm.coordinate : frame);
    if (slides && turns) term.frame = place_of(frame);
    terms_.push_back(term);
  }
  d_q_.resize(coordinates_.size());
  d_rate_q_.resize(coordinates_.size());
}

// d, dd/dt and their derivatives by the coordinates; d(dd/dt)/dv = dd/dq.
void SensorReader::sum_up(const double* q, const double* v) {
  d_ = offset_;
  d_rate_ = {};
  std::fill(d_q_.begin(), d_q_.end(), Planar<double>{});
  std::fill(d_rate_q_.begin(), d_rate_q_.end(), Planar<double>{});
  for (const Term& t : terms_) {
    const auto own = static_cast<std::size_t>(t.own);
    if (t.is_angle) {
      const Planar<double> p = t.coefficient * unit(q[own]);
      const Planar<double> turned = quarter_turn(p);
      d_ += p;
      d_rate_ += v[own] * turned;
      d_q_[own] += turned;
      d_rate_q_[own] -= v[own] * p;
      continue;
    }
    if (t.frame < 0) {
      d_ += q[own] * t.coefficient;
      d_rate_ += v[own] * t.coefficient;
      d_q_[own] += t.coefficient;
      continue;
    }
    const auto frame = static_cast<std::size_t>(t.frame);
    const Planar<double> along = t.coefficient * unit(q[frame]);
    const Planar<double> across = quarter_turn(along);
    d_ += q[own] * along;
    d_rate_ += v[own] * along + (q[own] * v[frame]) * across;
    d_q_[own] += along;
    d_q_[frame] += q[own] * across;
    d_rate_q_[own] += v[frame] * across;
    d_rate_q_[frame] += v[own] * across - (q[own] * v[frame]) * along;
  }
}

double SensorReader::read(const double* q, const double* v, double stiffness, double free_length, double* by_q,
                          double* by_v) {
  const std::size_t n = coordinates_.size();
  std::fill(by_v, by_v + n, 0.0);
  if (kind_ == Sensor::Kind::angle || kind_ == Sensor::Kind::travel) {
    double value = rate_ ? 0.0 : constant_;
    for (std::size_t i = 0; i < n; ++i) {
      value += sign_[i] * (rate_ ? v[i] : q[i]);
      by_q[i] = rate_ ? 0.0 : sign_[i];
      by_v[i] = rate_ ? sign_[i] : 0.0;
    }
    return value;
  }
  sum_up(q, v);
  if (kind_ == Sensor::Kind::x || kind_ == Sensor::Kind::y) {
    const auto part = [&](const Planar<double>& p) { return kind_ == Sensor::Kind::x ? p.x : p.y; };
    for (std::size_t i = 0; i < n; ++i) {
      by_q[i] = part(rate_ ? d_rate_q_[i] : d_q_[i]);
      if (rate_) by_v[i] = part(d_q_[i]);
    }
    return part(rate_ ? d_rate_ : d_);
  }
  length_ = norm(d_);
  if (length_ == 0) {
    std::fill(by_q, by_q + n, 0.0);
    return 0.0;
  }
  const double r = length_;
  if (kind_ == Sensor::Kind::spring_force) {
    const double excess = r - free_length;
    slack_ = (acts_ == Spring::Acts::tension && excess < 0) || (acts_ == Spring::Acts::compression && excess > 0);
    if (slack_) {
      std::fill(by_q, by_q + n, 0.0);
      return 0.0;
    }
    for (std::size_t i = 0; i < n; ++i) by_q[i] = stiffness * dot(d_, d_q_[i]) / r;
    return stiffness * excess;
  }
  const double r_rate = dot(d_, d_rate_) / r;
  for (std::size_t i = 0; i < n; ++i) {
    const double r_q = dot(d_, d_q_[i]) / r;
    by_q[i] = rate_ ? (dot(d_q_[i], d_rate_) + dot(d_, d_rate_q_[i]) - r_rate * r_q) / r : r_q;
    if (rate_) by_v[i] = r_q;
  }
  return rate_ ? r_rate : r;
}

}  // namespace poise
