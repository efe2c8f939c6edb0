#include "statics/proof/balance_system.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace poise {
namespace {

constexpr int most_proof_steps = 25;
constexpr int most_follow_steps = 12;
constexpr double most_way = 1e3;  // of other coordinates, for one of those that are fixed

std::vector<solvers::BallFactors::Entry> centers_of(std::vector<solvers::BallFactors::Entry> entries) {
  for (auto& entry : entries) entry.value = entry.value.midpoint();
  return entries;
}

std::vector<Ball> widened(std::vector<Ball> values, const std::vector<double>& by) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[i].widened(by[i]);
  return values;
}

}  // namespace

BalanceSystem::BalanceSystem(const BallMechanism& mechanism, KeptEquations kept, bool rounding)
    : mechanism_(mechanism.of(rounding)),
      kept_(std::move(kept)),
      rounding_(rounding),
      unknown_(mechanism_.coordinates(), 0),
      equation_(mechanism_.constraints(), -1) {
  for (const int i : kept_.fixed) unknown_[i] = -1;
  for (int& u : unknown_) u = u < 0 ? -1 : free_++;
  for (std::size_t k = 0; k < kept_.rows.size(); ++k) equation_[kept_.rows[k]] = free_ + static_cast<int>(k);
}

BalanceSystem::Point BalanceSystem::place(const std::vector<Ball>& x) const {
  Point at;
  at.pose.resize(mechanism_.pose_size());
  at.jacobian.resize(mechanism_.jacobian_row().size());
  mechanism_.place(x.data(), at.pose.data());
  mechanism_.jacobian(at.pose.data(), at.jacobian.data());
  return at;
}

std::vector<Ball> BalanceSystem::forces(const std::vector<Ball>& x, const std::vector<Ball>& y) const {
  const Ball::InputRounding guard(rounding_);
  Point at = place(x);
  std::vector<Ball> out(mechanism_.coordinates());
  mechanism_.negative_force(x.data(), at.pose.data(), out.data());
  for (std::size_t e = 0; e < at.jacobian.size(); ++e) {
    const int row = equation_[mechanism_.jacobian_row()[e]];
    if (row >= 0) out[mechanism_.jacobian_column()[e]] += at.jacobian[e] * y[row - free_];
  }
  return out;
}

std::vector<Ball> BalanceSystem::rates(const std::vector<Ball>& x, const std::vector<Ball>& u) const {
  const Ball::InputRounding guard(rounding_);
  const Point at = place(x);
  std::vector<Ball> out(kept_.rows.size());
  for (std::size_t e = 0; e < at.jacobian.size(); ++e) {
    const int row = equation_[mechanism_.jacobian_row()[e]];
    if (row >= 0) out[row - free_] += at.jacobian[e] * u[mechanism_.jacobian_column()[e]];
  }
  return out;
}

Ball BalanceSystem::measure_rate(int element, const std::vector<Ball>& x, const std::vector<Ball>& u) const {
  const Ball::InputRounding guard(rounding_);
  std::vector<Planar<Ball>> pose(mechanism_.pose_size());
  mechanism_.place(x.data(), pose.data());
  std::vector<Ball> gradient(x.size());
  mechanism_.add_measure_gradient(element, pose.data(), gradient.data());
  Ball out(0.0);
  for (std::size_t i = 0; i < x.size(); ++i) out += gradient[i] * u[i];
  return out;
}

std::vector<Ball> BalanceSystem::constraints(const std::vector<Ball>& x) const {
  const Ball::InputRounding guard(rounding_);
  std::vector<Planar<Ball>> pose(mechanism_.pose_size());
  mechanism_.place(x.data(), pose.data());
  std::vector<Ball> out(mechanism_.constraints());
  mechanism_.constraint(x.data(), pose.data(), out.data());
  return out;
}

std::vector<Ball> BalanceSystem::measures(const std::vector<Ball>& x) const {
  const Ball::InputRounding guard(rounding_);
  std::vector<Planar<Ball>> pose(mechanism_.pose_size());
  mechanism_.place(x.data(), pose.data());
  std::vector<Ball> out;
  for (int e = 0; e < mechanism_.elements(); ++e) out.push_back(mechanism_.measure_of(e, pose.data()));
  return out;
}

Ball BalanceSystem::product(const std::vector<Ball>& x, const std::vector<Ball>& y, const std::vector<Ball>& left,
                            const std::vector<Ball>& right) const {
  Ball sum(0.0);
  for (const auto& [i, j, value] : entries(x, y)) {
    sum += left[i] * value * right[j];
    if (i != j && !mechanism_.has_follower_loads()) sum += left[j] * value * right[i];
  }
  return sum;
}

std::vector<Ball> BalanceSystem::left_of_rows(const std::vector<Ball>& x) const {
  const std::vector<Ball> c = constraints(x);
  std::vector<Ball> out;
  for (std::size_t k = 0; k < kept_.rows.size(); ++k) {
    const int row = kept_.rows[k];
    const int stop = row - mechanism_.equalities();
    out.push_back(c[row]);
    if (stop >= 0) out.back() -= kept_.at_upper[k] != 0 ? mechanism_.upper()[stop] : mechanism_.lower()[stop];
  }
  return out;
}

std::vector<Ball> BalanceSystem::residual(const std::vector<Ball>& x, const std::vector<Ball>& y) const {
  const std::vector<Ball> force = forces(x, y);
  std::vector<Ball> rows = left_of_rows(x);
  std::vector<Ball> out(free_);
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (unknown_[i] >= 0) out[unknown_[i]] = force[i];
  }
  out.insert(out.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
  return out;
}

std::vector<solvers::RegularSet::Entry> BalanceSystem::entries(const std::vector<Ball>& x,
                                                               const std::vector<Ball>& y) const {
  const Ball::InputRounding guard(rounding_);
  Point at = place(x);
  std::vector<Ball> multiplier(mechanism_.constraints());
  for (std::size_t k = 0; k < kept_.rows.size(); ++k) multiplier[kept_.rows[k]] = y[k];
  std::vector<Ball> tangent(mechanism_.tangent_row().size());
  mechanism_.tangent(at.pose.data(), multiplier.data(), tangent.data());
  std::vector<solvers::RegularSet::Entry> out;
  out.reserve(tangent.size() + 2 * at.jacobian.size());
  for (std::size_t e = 0; e < tangent.size(); ++e) {
    const int i = unknown_[mechanism_.tangent_row()[e]];
    const int j = unknown_[mechanism_.tangent_column()[e]];
    if (i >= 0 && j >= 0) out.push_back({i, j, std::move(tangent[e])});
  }
  for (std::size_t e = 0; e < at.jacobian.size(); ++e) {
    const int i = equation_[mechanism_.jacobian_row()[e]];
    const int j = unknown_[mechanism_.jacobian_column()[e]];
    if (i < 0 || j < 0) continue;
    if (mechanism_.has_follower_loads()) out.push_back({j, i, at.jacobian[e]});
    out.push_back({i, j, std::move(at.jacobian[e])});
  }
  return out;
}

std::vector<solvers::RegularSet::Entry> BalanceSystem::derivatives(const std::vector<Ball>& x) const {
  const Ball::InputRounding guard(rounding_);
  Point at = place(x);
  std::vector<solvers::RegularSet::Entry> out;
  for (std::size_t e = 0; e < at.jacobian.size(); ++e) {
    const int i = equation_[mechanism_.jacobian_row()[e]];
    const int j = unknown_[mechanism_.jacobian_column()[e]];
    if (i >= 0 && j >= 0) out.push_back({i, j, std::move(at.jacobian[e])});
  }
  return out;
}

// J_o u_o = -J_f u_f,  of the rates of other and of fixed coordinates.
std::optional<std::vector<std::vector<Ball>>> BalanceSystem::motions(const std::vector<Ball>& x) const {
  if (unknowns() != 2 * free_) return std::nullopt;
  const solvers::RegularSet matrix(unknowns(), true, derivatives(x));
  if (free_ > 0 && !matrix.regular()) return std::nullopt;
  std::vector<std::vector<Ball>> out;
  for (const int i : kept_.fixed) {
    std::vector<Ball>& u = out.emplace_back(x.size());
    u[i] = Ball(1);
    if (free_ == 0) continue;
    std::vector<Ball> b(free_);
    for (const Ball& rate : rates(x, u)) b.push_back(-rate);
    b = matrix.solve(std::move(b));
    for (std::size_t k = 0; k < u.size(); ++k) {
      if (unknown_[k] >= 0) u[k] = b[unknown_[k]];
    }
  }
  return out;
}

std::optional<std::vector<Ball>> BalanceSystem::follow(const std::vector<Ball>& at,
                                                       const std::vector<double>& change) const {
  const std::size_t n = at.size();
  if (unknowns() != 2 * free_) return std::nullopt;
  // J^-1 of what the rows are off, per coordinate.
  const auto by_rows = [&](const auto& solve, std::vector<Ball> rows) {
    std::vector<Ball> b(free_);
    b.insert(b.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
    b = solve(std::move(b));
    std::vector<Ball> out(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (unknown_[i] >= 0) out[i] = b[unknown_[i]];
    }
    return out;
  };
  const auto largest = [](const std::vector<Ball>& by) {
    double out = 0.0;
    for (const Ball& b : by) out = std::max(out, b.is_finite() ? b.greatest() : HUGE_VAL);
    return out;
  };
  std::vector<Ball> from, to;
  double last = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    from.push_back(at[i].midpoint());
    to.push_back((from.back() + Ball(change[i])).midpoint());
    last = std::max(last, most_way * std::abs(change[i]));
  }
  // Newton's method leads to the other end, which only that it is one is proved of.
  for (int k = 0; k < most_follow_steps; ++k) {
    const solvers::BallFactors factors(unknowns(), true, centers_of(derivatives(to)));
    if (!factors.regular()) return std::nullopt;
    const auto solve = [&](std::vector<Ball> b) {
      factors.solve(b);
      return b;
    };
    const std::vector<Ball> by = by_rows(solve, left_of_rows(to));
    const double length = largest(by);
    if (!(length < last)) break;
    for (std::size_t i = 0; i < n; ++i) to[i] = (to[i] - by[i]).midpoint();
    last = 0.5 * length;
  }
  std::vector<Ball> way, line;
  for (std::size_t i = 0; i < n; ++i) {
    way.push_back(to[i] - from[i]);
    line.push_back(Ball::of_both(from[i], to[i]));
  }
  const double reach = 0.5 * largest(way);
  std::vector<Ball> box = line;
  for (std::size_t i = 0; i < n; ++i) {
    if (unknown_[i] >= 0) box[i] = box[i].widened(reach);
  }
  const solvers::RegularSet matrix(unknowns(), true, derivatives(box));
  if (!matrix.regular()) return std::nullopt;
  const auto solve = [&](std::vector<Ball> b) { return matrix.solve(std::move(b)); };
  // c(from + s way) = c(from) + s J way, with J somewhere between, for 0 <= s <= 1.
  std::vector<Ball> off = left_of_rows(from);
  const std::vector<Ball> rate = rates(line, way);
  for (std::size_t k = 0; k < off.size(); ++k) off[k] += Ball(0.5).widened(0.5) * rate[k];
  if (!(largest(by_rows(solve, std::move(off))) < reach)) return std::nullopt;
  const std::vector<Ball> last_step = by_rows(solve, left_of_rows(to));
  for (std::size_t i = 0; i < n; ++i) {
    if (!((at[i] - from[i]).greatest() < reach)) return std::nullopt;
    to[i] -= last_step[i];
  }
  return to;
}

// [I J^T; J 0] [r; y] = [-F; 0]:  r = -(F + J^T y) with J r = 0.
std::optional<std::vector<Ball>> BalanceSystem::multipliers(const std::vector<Ball>& x) const {
  Point at = place(x);
  std::vector<Ball> force(mechanism_.coordinates());
  mechanism_.negative_force(x.data(), at.pose.data(), force.data());
  std::vector<solvers::BallFactors::Entry> parts;
  for (int i = 0; i < free_; ++i) parts.push_back({i, i, Ball(1)});
  for (std::size_t e = 0; e < at.jacobian.size(); ++e) {
    const int i = equation_[mechanism_.jacobian_row()[e]];
    const int j = unknown_[mechanism_.jacobian_column()[e]];
    if (i >= 0 && j >= 0) parts.push_back({i, j, at.jacobian[e].midpoint()});
  }
  const solvers::BallFactors factors(unknowns(), true, parts);
  if (!factors.regular()) return std::nullopt;
  std::vector<Ball> b(unknowns());
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (unknown_[i] >= 0) b[unknown_[i]] = -force[i].midpoint();
  }
  factors.solve(b);
  std::vector<Ball> y(kept_.rows.size());
  for (std::size_t k = 0; k < y.size(); ++k) y[k] = b[free_ + static_cast<int>(k)].midpoint();
  return y;
}

BalanceSystem::Solution BalanceSystem::prove(const std::vector<Ball>& x, const std::vector<Ball>& y, double reach,
                                             double farthest) const {
  Solution out;
  out.q = x;
  out.y = y;
  const std::size_t n = x.size();
  const bool symmetric = !mechanism_.has_follower_loads();
  std::vector<double> x_reach(n), y_reach(y.size());
  double last = 0.0;
  const double narrow =
      std::exp2(-static_cast<double>(Ball::bits()) / 2);  // width of an enclosure that is sharp enough
  for (int step = 0; step < most_proof_steps; ++step) {
    double largest_y = 1.0;
    for (const Ball& v : out.y) largest_y = std::max(largest_y, std::abs(v.middle()));
    std::fill(y_reach.begin(), y_reach.end(), reach * largest_y);
    for (std::size_t i = 0; i < n; ++i) {
      x_reach[i] = unknown_[i] < 0 ? 0.0 : reach * std::max(1.0, std::abs(out.q[i].middle()));
    }
    std::vector<Ball> box = widened(out.q, x_reach);
    const auto matrix =
        std::make_shared<solvers::RegularSet>(unknowns(), symmetric, entries(box, widened(out.y, y_reach)));
    out.matrix = matrix;
    const bool regular = matrix->regular();
    if (!matrix->center().regular()) return out;
    std::vector<Ball> by =
        regular ? matrix->solve(residual(out.q, out.y)) : matrix->solve_center(residual(out.q, out.y));
    double longest = 0.0;
    for (int u = 0; u < free_; ++u) longest = std::max(longest, std::abs(by[u].middle()));
    if (!regular && longest > farthest / 4) {
      for (Ball& change : by) change *= Ball(farthest / 4 / longest);
    }
    double length = 0.0;
    double width = 0.0;
    bool inside = regular;
    std::vector<Ball> next_q = out.q;
    std::vector<Ball> next_y = out.y;
    for (std::size_t i = 0; i < n; ++i) {
      if (unknown_[i] < 0) continue;
      const Ball& change = by[unknown_[i]];
      if (!change.is_finite()) return out;
      length = std::max(length, std::abs(change.middle()));
      inside = inside && change.greatest() < x_reach[i];
      next_q[i] -= change;
      width = std::max(width, next_q[i].radius() / std::max(1.0, std::abs(next_q[i].middle())));
      if (std::abs((next_q[i] - x[i]).middle()) > farthest) return out;
    }
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Ball& change = by[free_ + static_cast<int>(k)];
      if (!change.is_finite()) return out;
      inside = inside && change.greatest() < y_reach[k];
      next_y[k] -= change;
    }
    const bool at_rest = step > 0 && length >= 0.5 * last;
    // Where numbers are uncertain no step makes the enclosure narrower than they leave it.
    const bool sharp = width < narrow || (step > 0 && length < 1e-3 * width);
    if (inside && (sharp || rounding_ || at_rest)) {
      out.q = std::move(next_q);
      out.y = std::move(next_y);
      out.box = std::move(box);
      out.proved = true;
      out.unstable = matrix->negative() - static_cast<int>(kept_.rows.size());
      // det [K J^T; J 0] = (-1)^rows det(J J^T) det(Z^T K Z).
      out.stiffness_sign = matrix->determinant_sign() * (kept_.rows.size() % 2 == 0 ? 1 : -1);
      return out;
    }
    if (!regular && at_rest && length < 1e-3 * reach) return out;
    last = length;
    for (std::size_t i = 0; i < n; ++i) {
      if (unknown_[i] >= 0) out.q[i] = next_q[i].midpoint();
    }
    for (std::size_t k = 0; k < y.size(); ++k) out.y[k] = next_y[k].midpoint();
  }
  return out;
}

}  // namespace poise
