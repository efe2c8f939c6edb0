#include "statics/varied_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "model/mechanism_impl.hpp"

namespace poise {
namespace {

constexpr double stencil_step = 1e-3;      // of the parameter's range, for derivatives of fourth order
constexpr double vanishing_share = 1e-13;  // of the range: from where something vanishes
constexpr std::size_t most_recent = 12;    // compiled pieces kept: of a point and of its stencil, and of a trial point

}  // namespace

std::vector<int> VariedMechanism::one_way_springs(const Scene& scene) {
  std::vector<int> out;
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const auto* spring = std::get_if<LinearSpring>(&scene.elements[e].law);
    if (spring != nullptr && spring->acts != LinearSpring::Acts::both) out.push_back(static_cast<int>(e));
  }
  return out;
}

VariedMechanism::VariedMechanism(const VariedScene& varied, const std::vector<char>& acts)
    : varied_(varied), one_way_(one_way_springs(varied.scene())), acts_(acts), affine_(varied.is_affine()) {
  const auto vanishes = [&](double p) { return varied.value_at(p) == 0.0; };
  first_ = compiled(vanishes(0.0) ? 0.5 : 0.0);
  second_ = compiled(vanishes(1.0) ? 0.5 : 1.0);
  // What is zero at one end only, of several numbers.
  if (!alike(first_, second_)) {
    first_ = compiled(0.25);
    second_ = compiled(0.75);
  }
  const Mechanism<double>& m = first_.model->mechanism();
  n_ = m.coordinates();
  equalities_ = m.equalities();
  rows_ = m.constraints();
  symmetric_ = !m.has_follower_loads();
  jacobian_pattern_ = {rows_, n_, m.jacobian_row(), m.jacobian_column()};
  tangent_pattern_ = {n_, n_, m.tangent_row(), m.tangent_column()};
  if (!alike(first_, second_)) throw std::logic_error("a varied number changes the structure of the mechanism");
  for (auto* v : {&at_first_, &at_second_, &stencil_[0], &stencil_[1], &stencil_[2], &stencil_[3]}) {
    v->resize(ParametricProblem::values());
  }
}

VariedMechanism::Piece VariedMechanism::compiled(double p) const {
  const auto on_this_piece = [&](Scene scene) {
    for (std::size_t k = 0; k < one_way_.size(); ++k) {
      Element& element = scene.elements[one_way_[k]];
      auto& spring = std::get<LinearSpring>(element.law);
      scene.stops.push_back({.name = element.name, .on = element.on, .min = spring.free_length});
      spring.acts = LinearSpring::Acts::both;
      if (!acts_[k]) spring.stiffness = 0.0;
    }
    return scene;
  };
  const Scene also = on_this_piece(varied_.generic_scene());
  Piece piece;
  piece.p = p;
  piece.model = std::make_unique<ScaledModel>(on_this_piece(varied_.scene_at(varied_.value_at(p))), Purpose::statics,
                                              varied_.scales(), &also);
  piece.pose.resize(piece.model->mechanism().pose_size());
  return piece;
}

bool VariedMechanism::alike(const Piece& a, const Piece& b) {
  const Mechanism<double>&m = a.model->mechanism(), &other = b.model->mechanism();
  return other.jacobian_column() == m.jacobian_column() && other.tangent_row() == m.tangent_row();
}

VariedMechanism::Piece& VariedMechanism::at(double p) {
  for (Piece& piece : recent_) {
    if (piece.p == p) return piece;
  }
  if (recent_.size() >= most_recent) recent_.pop_front();
  recent_.push_back(compiled(p));
  if (!alike(first_, recent_.back())) {
    // A number is zero just here.
    recent_.back() = compiled(p + (p < 0.5 ? vanishing_share : -vanishing_share));
    recent_.back().p = p;
  }
  return recent_.back();
}

void VariedMechanism::make_dual(Piece& piece) const {
  if (piece.dual) return;
  piece.dual = std::make_unique<Mechanism<Dual>>(scaled(piece.model->scene(), piece.model->scales()),
                                                 piece.model->layout(), Purpose::statics);
  piece.dual_pose.resize(piece.dual->pose_size());
}

template <class T>
void VariedMechanism::fill(const Mechanism<T>& m, std::vector<Planar<T>>& pose, const T* x, T* values) const {
  m.place(x, pose.data());
  m.negative_force(x, pose.data(), values);
  m.constraint(x, pose.data(), values + first_row());
  m.jacobian(pose.data(), values + first_entry());
  std::copy(m.lower().begin(), m.lower().end(), values + first_lower());
  std::copy(m.upper().begin(), m.upper().end(), values + first_upper());
}

void VariedMechanism::plain(double p, std::span<const double> x, std::vector<double>& values) {
  Piece& piece = at(p);
  fill(piece.model->mechanism(), piece.pose, x.data(), values.data());
}

namespace {

// Infinite bounds do not vary, and have no differences.
bool is_finite(double a) { return std::isfinite(a); }
bool is_finite(const ceres::Jet<double, 1>& a) { return std::isfinite(a.a); }

template <class T>
T blend(const T& a, const T& b, const T& share) {
  return is_finite(a) ? a + share * (b - a) : a;
}

template <class T>
T slope(const T& a, const T& b, double span) {
  return is_finite(a) ? (b - a) / T(span) : T(0);
}

// f'(0) from f at -2h, -h, h, 2h:  (f(-2h) - 8 f(-h) + 8 f(h) - f(2h)) / 12 h.
template <class T>
T central(const T& a, const T& b, const T& c, const T& d, double h) {
  return is_finite(b) ? (a - T(8) * b + T(8) * c - d) / T(12 * h) : T(0);
}

}  // namespace

void VariedMechanism::evaluate(std::span<const double> x, double p, std::span<double> values, std::span<double> by_p) {
  if (affine_) {
    fill(first_.model->mechanism(), first_.pose, x.data(), at_first_.data());
    fill(second_.model->mechanism(), second_.pose, x.data(), at_second_.data());
    const double s = share(p), span = second_.p - first_.p;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = blend(at_first_[i], at_second_[i], s);
    for (std::size_t i = 0; i < by_p.size(); ++i) by_p[i] = slope(at_first_[i], at_second_[i], span);
    return;
  }
  plain(p, x, at_first_);
  std::copy(at_first_.begin(), at_first_.end(), values.begin());
  if (by_p.empty()) return;
  constexpr double h = stencil_step;
  constexpr double at[4] = {-2 * h, -h, h, 2 * h};
  for (int k = 0; k < 4; ++k) plain(p + at[k], x, stencil_[k]);
  for (std::size_t i = 0; i < by_p.size(); ++i) {
    by_p[i] = central(stencil_[0][i], stencil_[1][i], stencil_[2][i], stencil_[3][i], h);
  }
}

void VariedMechanism::tangent(std::span<const double> x, double p, std::span<const double> y,
                              std::span<double> values) {
  const auto of = [&](Piece& piece, double* out) {
    const Mechanism<double>& m = piece.model->mechanism();
    m.place(x.data(), piece.pose.data());
    m.tangent(piece.pose.data(), y.data(), out);
  };
  if (!affine_) {
    of(at(p), values.data());
    return;
  }
  tangents_[0].resize(values.size());
  tangents_[1].resize(values.size());
  of(first_, tangents_[0].data());
  of(second_, tangents_[1].data());
  const double s = share(p);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = blend(tangents_[0][i], tangents_[1][i], s);
}

void VariedMechanism::change(std::span<const double> x, double p, std::span<const double> y, std::span<const double> u,
                             std::span<const double> v, double w, std::span<double> values, std::span<double> by_p,
                             std::span<double> tangent) {
  std::vector<Dual> xs(n_), ys(rows_);
  for (int i = 0; i < n_; ++i) {
    xs[i] = Dual(x[i]);
    xs[i].v[0] = u[i];
  }
  for (int r = 0; r < rows_; ++r) {
    // A zero that changes is none: tangent() leaves out rows whose multiplier is zero.
    ys[r] = Dual(y[r] == 0.0 && v[r] != 0.0 ? std::numeric_limits<double>::min() : y[r]);
    ys[r].v[0] = v[r];
  }
  struct Duals {
    std::vector<Dual> values, tangent;
  };
  const auto of = [&](Piece& piece) {
    make_dual(piece);
    Duals out{std::vector<Dual>(values.size()), std::vector<Dual>(tangent.size())};
    fill(*piece.dual, piece.dual_pose, xs.data(), out.values.data());
    piece.dual->tangent(piece.dual_pose.data(), ys.data(), out.tangent.data());
    return out;
  };
  if (affine_) {
    const Duals a = of(first_), b = of(second_);
    const double span = second_.p - first_.p;
    Dual s(share(p));
    s.v[0] = w / span;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = blend(a.values[i], b.values[i], s).v[0];
      by_p[i] = slope(a.values[i], b.values[i], span).v[0];
    }
    for (std::size_t i = 0; i < tangent.size(); ++i) tangent[i] = blend(a.tangent[i], b.tangent[i], s).v[0];
    return;
  }
  constexpr double h = stencil_step;
  const Duals here = of(at(p));
  const Duals around[4] = {of(at(p - 2 * h)), of(at(p - h)), of(at(p + h)), of(at(p + 2 * h))};
  const auto by = [&](auto member, std::size_t i) {
    return central((around[0].*member)[i], (around[1].*member)[i], (around[2].*member)[i], (around[3].*member)[i], h);
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Dual d = by(&Duals::values, i);
    // f''(0) from f at -2h ... 2h:  (16 (f(-h) + f(h) - 2 f(0)) - (f(-2h) + f(2h) - 2 f(0))) / 12 h^2.
    const double middle = here.values[i].a;
    const auto both_sides = [&](int k) {
      return (around[k].values[i].a - middle) + (around[3 - k].values[i].a - middle);
    };
    const double bend = std::isfinite(middle) ? (16 * both_sides(1) - both_sides(0)) / (12 * h * h) : 0.0;
    values[i] = here.values[i].v[0] + w * d.a;
    by_p[i] = d.v[0] + w * bend;
  }
  for (std::size_t i = 0; i < tangent.size(); ++i) {
    tangent[i] = here.tangent[i].v[0] + w * by(&Duals::tangent, i).a;
  }
}

}  // namespace poise
