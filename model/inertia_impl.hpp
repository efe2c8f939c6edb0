#pragma once

#include <algorithm>

#include "model/inertia.hpp"
#include "model/scene_numbers.hpp"

namespace poise {

template <class T>
Inertia<T>::Inertia(const Scene& scene, const Mechanism<T>& mechanism) : Inertia(SceneNumbers<T>(scene), mechanism) {}

template <class T>
template <class NumbersOfScene>
Inertia<T>::Inertia(const NumbersOfScene& numbers, const Mechanism<T>& mechanism)
    : mechanism_(mechanism),
      n_(mechanism.coordinates()),
      moment_(n_, T(0)),
      gravity_(numbers.gravity()),
      origin_(numbers.scene().bodies.size()) {
  const Scene& scene = numbers.scene();
  const Layout& layout = mechanism.layout();
  const Phasors<T>& phasors = mechanism.phasors();
  struct Mass {
    int body;
    std::vector<std::pair<int, Planar<T>>> terms;  // of its centre
  };
  std::vector<Mass> masses;
  std::vector<int> place(static_cast<std::size_t>(n_), -1);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const int index = static_cast<int>(i);
    const int frame = layout.links[i].frame;
    if (frame >= 0 && frame < n_) moment_[frame] += numbers.inertia(index);
    Origin& origin = origin_[i];
    origin.frame = frame < n_ ? frame : -1;
    origin.turn = phasors.turned(layout.links[i].turn);
    for (const Arm& arm : layout.path(0, {0, 0}, static_cast<int>(i), {0, 0})) {
      if (arm.coordinate < 0 || arm.coordinate >= n_) continue;
      if (!origin.coordinate.empty() && origin.coordinate.back() == arm.coordinate) {
        origin.coefficient.back() += phasors.coefficient(arm);
        continue;
      }
      origin.coordinate.push_back(arm.coordinate);
      origin.coefficient.push_back(phasors.coefficient(arm));
    }
    if (body.mass == 0 && !layout.varying.has_mass(index)) continue;
    const bool center_varies = layout.varying.has_center(index);
    std::vector<std::pair<int, Planar<T>>> terms;
    for (const Arm& arm : layout.path(0, {0, 0}, index, center_varies ? Vec2{} : body.center)) {
      if (arm.coordinate >= 0) terms.emplace_back(arm.coordinate, phasors.coefficient(arm));
    }
    if (center_varies && frame >= 0) terms.emplace_back(frame, numbers.center(index) * origin.turn);
    for (const auto& [t, c_t] : terms) place[static_cast<std::size_t>(t)] = 0;
    masses.push_back({index, std::move(terms)});
  }
  for (int t = 0; t < n_; ++t) {
    if (place[static_cast<std::size_t>(t)] < 0) continue;
    place[static_cast<std::size_t>(t)] = static_cast<int>(moved_.size());
    moved_.push_back(static_cast<std::size_t>(t));
  }
  const std::size_t m = moved_.size();
  w_.resize(m * m);
  for (const Mass& mass : masses) {
    for (const auto& [t, c_t] : mass.terms) {
      Planar<T>* row = &w_[static_cast<std::size_t>(place[static_cast<std::size_t>(t)]) * m];
      for (const auto& [u, c_u] : mass.terms) {
        row[place[static_cast<std::size_t>(u)]] += numbers.mass(mass.body) * (conj(c_t) * c_u);
      }
    }
  }
}

template <class T>
std::array<typename Inertia<T>::Partial, 2> Inertia<T>::first(const Planar<T>* pose, int t) const {
  const Coordinate& c = mechanism_.layout().coordinates[t];
  if (c.kind == Coordinate::Kind::angle) return {{{t, quarter_turn(pose[t])}, {}}};
  const Partial along{t, mechanism_.phasors().line_direction(pose, t)};
  if (c.frame < 0) return {{along, {}}};
  return {{along, {c.frame, quarter_turn(pose[t])}}};
}

template <class T>
void Inertia<T>::weigh(const Planar<T>* f, Planar<T>* out) const {
  const std::size_t m = moved_.size();
  const auto weigh_at = [&](auto coordinate) {
    const Planar<T>* w = w_.data();
    for (std::size_t i = 0; i < m; ++i) {
      T x(0), y(0);
      for (std::size_t j = 0; j < m; ++j, ++w) {
        const Planar<T>& moves = f[coordinate(j)];
        x += w->x * moves.x - w->y * moves.y;
        y += w->x * moves.y + w->y * moves.x;
      }
      out[coordinate(i)] = {x, y};
    }
  };
  if (m < static_cast<std::size_t>(n_)) std::fill(out, out + n_, Planar<T>{});
  if (m == 0) return;
  const std::size_t first = moved_.front();
  if (moved_.back() - first + 1 == m) {
    weigh_at([&](std::size_t i) { return first + i; });
  } else {
    weigh_at([&](std::size_t i) { return moved_[i]; });
  }
}

// A point of the body at r from its origin is p + r e, e = exp(i theta): with s = m r and e'' = second of e,
//   m (p'' + r e'' - gravity) . (Dp + r De) = m (p'' - gravity) . Dp + s e'' . Dp + (p'' - gravity) . s De + J theta''
//   Dth.
template <class T>
void Inertia<T>::add_body(int body, const BodyInertia<T>& part, const Planar<T>* pose, const T* a,
                          const Planar<T>* second, T* g, const Planar<T>& frame) const {
  const Origin& origin = origin_[body];
  Planar<T> lift = frame - gravity_;
  for (std::size_t e = 0; e < origin.coordinate.size(); ++e) {
    lift += origin.coefficient[e] * second[origin.coordinate[e]];
  }
  Planar<T> force = part.mass * lift;
  if (origin.frame >= 0) {
    const Planar<T> arm = part.first * origin.turn;
    force += arm * second[origin.frame];
    g[origin.frame] += cross(arm * pose[origin.frame], lift) + part.moment * a[origin.frame];
  }
  for (std::size_t e = 0; e < origin.coordinate.size(); ++e) {
    const int t = origin.coordinate[e];
    const Planar<T> f = conj(origin.coefficient[e]) * force;
    const Coordinate& c = mechanism_.layout().coordinates[t];
    if (c.kind == Coordinate::Kind::angle) {
      g[t] += cross(pose[t], f);
      continue;
    }
    g[t] += dot(mechanism_.phasors().line_direction(pose, t), f);
    if (c.frame >= 0) g[c.frame] += cross(pose[t], f);
  }
}

template <class T>
void Inertia<T>::mass_matrix(const Planar<T>* pose, T* m) const {
  std::fill(m, m + static_cast<std::size_t>(n_) * n_, T(0));
  for (int k = 0; k < n_; ++k) m[k * n_ + k] = moment_[k];
  const Planar<T>* next = w_.data();
  for (const std::size_t t : moved_) {
    const auto left = first(pose, static_cast<int>(t));
    for (const std::size_t u : moved_) {
      const Planar<T>& w = *next++;
      if (all(w.x == 0 && w.y == 0)) continue;
      for (const Partial& a : left) {
        if (a.coordinate < 0) continue;
        for (const Partial& b : first(pose, static_cast<int>(u))) {
          if (b.coordinate >= 0) m[a.coordinate * n_ + b.coordinate] += dot(a.value, w * b.value);
        }
      }
    }
  }
}

}  // namespace poise
