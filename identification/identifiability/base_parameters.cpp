#include "identification/identifiability/base_parameters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "identification/prediction/random_states.hpp"
#include "motion/simulate.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

constexpr const char* part_names[] = {"m", "m x", "m y", "J"};

BodyInertia<double> unit_part(int which) {
  BodyInertia<double> part;
  if (which == 0) part.mass = 1.0;
  if (which == 1) part.first = {1.0, 0.0};
  if (which == 2) part.first = {0.0, 1.0};
  if (which == 3) part.moment = 1.0;
  return part;
}

/// Y at random states reached from the closed start by random steps.
Eigen::MatrixXd regressor(const MotionModel& model, const std::vector<int>& bodies, int states) {
  const std::vector<double> x = model.from_si(start_motion(model, {}).q);
  ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  reduced.begin(0.0, x.data());
  const int f = reduced.freedoms();
  Eigen::MatrixXd Y =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(states) * f, 4 * static_cast<Eigen::Index>(bodies.size()));
  std::vector<double> force(static_cast<std::size_t>(f));
  Eigen::Index row = 0;
  visit_random_states(reduced, x, states, 0.0, [&](const RandomState& state) {
    reduced.move(state.w.data());
    reduced.accelerate_as(state.alpha.data());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      for (int part = 0; part < 4; ++part) {
        reduced.reduced_inertia(bodies[b], unit_part(part), force.data());
        for (int k = 0; k < f; ++k)
          Y(row + k, 4 * static_cast<Eigen::Index>(b) + part) = force[static_cast<std::size_t>(k)];
      }
    }
    row += f;
  });
  return Y;
}

}  // namespace

BaseParameters base_parameters(const Scene& scene) {
  std::vector<int> bodies;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].mass != 0 || scene.bodies[i].inertia != 0) bodies.push_back(static_cast<int>(i));
  }
  BaseParameters out;
  out.parameters = 4 * static_cast<int>(bodies.size());
  if (bodies.empty()) return out;
  const MotionModel model(scene);
  Eigen::MatrixXd Y = regressor(model, bodies, 8 * out.parameters);
  if (Y.rows() == 0) return out;  // drives leave no freedom
  const auto name = [&](Eigen::Index column) {
    return scene.bodies[static_cast<std::size_t>(bodies[static_cast<std::size_t>(column / 4)])].name + "." +
           part_names[column % 4];
  };
  // Columns of length one, so that kg and kg m^2 can be compared.
  Eigen::VectorXd length = Y.colwise().norm();
  const double longest = length.maxCoeff();
  for (Eigen::Index c = 0; c < Y.cols(); ++c) {
    if (length[c] <= 1e-11 * longest) {
      out.without.push_back(name(c));
      Y.col(c).setZero();
      length[c] = 1.0;
    } else {
      Y.col(c) /= length[c];
    }
  }
  const Eigen::VectorXd s = solvers::singular_values(Y);
  // The rank is taken at the largest drop of the singular values.
  double widest = 1e3;
  out.rank = static_cast<int>(Y.cols());
  for (Eigen::Index i = 1; i < s.size(); ++i) {
    const double fall = s[i - 1] / std::max(s[i], 1e-18 * s[0]);
    if (s[i] < 1e-8 * s[0] && fall > widest) {
      widest = fall;
      out.rank = static_cast<int>(i);
      out.gap = fall;
    }
  }
  const auto [order, shares] = solvers::column_shares(Y, out.rank);
  const double unit[] = {1.0, model.scales().length, model.scales().length,
                         model.scales().length * model.scales().length};
  for (int b = 0; b < out.rank; ++b) {
    const Eigen::Index column = order[static_cast<std::size_t>(b)];
    BaseParameters::Sum sum{name(column),
                            {{bodies[static_cast<std::size_t>(column / 4)], static_cast<int>(column % 4)}}};
    for (Eigen::Index d = 0; d < shares.cols(); ++d) {
      const Eigen::Index other = order[static_cast<std::size_t>(out.rank + d)];
      // Per unit of the other parameter, in SI; both columns were scaled.
      const double share = shares(b, d) * length[other] / length[column] * unit[column % 4] / unit[other % 4];
      if (std::abs(shares(b, d)) <= 1e-7) continue;
      sum.words += fmt::format(" {} {:.6g} {}", share < 0 ? '-' : '+', std::abs(share), name(other));
      sum.terms.push_back({bodies[static_cast<std::size_t>(other / 4)], static_cast<int>(other % 4), share});
    }
    out.sums.push_back(std::move(sum));
  }
  std::sort(out.sums.begin(), out.sums.end(), [](const auto& a, const auto& b) { return a.words < b.words; });
  return out;
}

double value_of(const BaseParameters::Sum& sum, const Scene& scene) {
  double out = 0.0;
  for (const BaseParameters::Term& term : sum.terms) {
    const Body& body = scene.bodies[static_cast<std::size_t>(term.body)];
    const Vec2 first = body.mass * body.center;
    const std::array<double, 4> parts{body.mass, first.x, first.y, body.inertia + dot(first, body.center)};
    out += term.factor * parts[static_cast<std::size_t>(term.part)];
  }
  return out;
}

Dimension dimension_of(const BaseParameters::Sum& sum) {
  const int part = sum.terms.front().part;
  return part == 3 ? dimension::inertia : part == 0 ? dimension::mass : dimension::mass * dimension::length;
}

}  // namespace poise
