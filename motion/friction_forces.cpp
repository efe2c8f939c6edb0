#include "motion/friction_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/LU>

#include "solvers/linear_program.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_corners = 4096;  // combinations of corners whose determinants is_unique() looks at
constexpr std::size_t finest_polygon = 32;  // corners around the circle of a pin
constexpr double regular = 1e-10;           // a determinant as small as this part of its terms may have either sign
constexpr double feasible_within = 1e-12;   // of the largest force
constexpr double agrees_within = 1e-10;     // the same, of the equations
constexpr double same_within = 1e-8;        // of two solutions
constexpr double narrowest_arc = 1e-8;      // rad
constexpr int most_cells = 20000;
constexpr int most_friction_steps = 60;

Planar<double> at_angle(double angle) { return {std::cos(angle), std::sin(angle)}; }

constexpr std::array<Planar<double>, 4> corners{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Of the set K of a joint that is no pin.
std::span<const Planar<double>> corners_of(FrictionForces::Size size) {
  return std::span(corners).first(size == FrictionForces::Size::normal ? 2 : 4);
}

}  // namespace

FrictionForces::FrictionForces(std::vector<Size> sizes)
    : sizes_(std::move(sizes)),
      force_(joints()),
      response_(joints() * joints()),
      corners_(joints() * finest_polygon),
      first_corner_(joints() + 1),
      corner_(joints()),
      matrix_(joints() * joints()) {
  active_.reserve(joints());
}

// Pivots of I - (reach_ij), reach_ij the size of response_ij.
bool FrictionForces::contracts() {
  const std::size_t k = active_.size();
  for (std::size_t p = 0; p < k; ++p) {
    for (std::size_t q = 0; q < k; ++q) {
      const Planar<double>& by = response(active_[p], active_[q]);
      const double reach = sizes_[active_[p]] == Size::pin ? norm(by) : std::max(std::abs(by.x), std::abs(by.y));
      matrix_[p * k + q] = (p == q ? 1.0 : 0.0) - reach;
    }
  }
  for (std::size_t p = 0; p < k; ++p) {
    if (!(matrix_[p * k + p] > 1e-3)) return false;
    for (std::size_t i = p + 1; i < k; ++i) {
      const double l = matrix_[i * k + p] / matrix_[p * k + p];
      for (std::size_t j = p; j < k; ++j) matrix_[i * k + j] -= l * matrix_[p * k + j];
    }
  }
  return true;
}

// Of I - (w_i . response_ij) for the active joints at the corners chosen, over the product of the lengths of its rows.
double FrictionForces::determinant() {
  const std::size_t k = active_.size();
  double out = 1.0;
  for (std::size_t p = 0; p < k; ++p) {
    const Planar<double>& w = corners_[first_corner_[p] + corner_[p]];
    double length = 0.0;
    for (std::size_t q = 0; q < k; ++q) {
      double& entry = matrix_[p * k + q];
      entry = (p == q ? 1.0 : 0.0) - dot(w, response(active_[p], active_[q]));
      length = std::max(length, std::abs(entry));
    }
    if (length == 0.0) return 0.0;
    for (std::size_t q = 0; q < k; ++q) matrix_[p * k + q] /= length;
  }
  for (std::size_t p = 0; p < k; ++p) {
    std::size_t largest = p;
    for (std::size_t i = p + 1; i < k; ++i) {
      if (std::abs(matrix_[i * k + p]) > std::abs(matrix_[largest * k + p])) largest = i;
    }
    if (matrix_[largest * k + p] == 0.0) return 0.0;
    if (largest != p) {
      for (std::size_t j = p; j < k; ++j) std::swap(matrix_[p * k + j], matrix_[largest * k + j]);
      out = -out;
    }
    out *= matrix_[p * k + p];
    for (std::size_t i = p + 1; i < k; ++i) {
      const double l = matrix_[i * k + p] / matrix_[p * k + p];
      for (std::size_t j = p; j < k; ++j) matrix_[i * k + j] -= l * matrix_[p * k + j];
    }
  }
  return out;
}

// 1 or -1 where the determinants at all corners have this sign, else 0.
int FrictionForces::sign_at_corners() {
  std::fill(corner_.begin(), corner_.end(), std::size_t{0});
  int sign = 0;
  for (;;) {
    const double value = determinant();
    const int here = value > regular ? 1 : value < -regular ? -1 : 0;
    if (here == 0 || (sign != 0 && here != sign)) return 0;
    sign = here;
    std::size_t p = 0;
    while (p < active_.size() && ++corner_[p] == first_corner_[p + 1] - first_corner_[p]) corner_[p++] = 0;
    if (p == active_.size()) return sign;
  }
}

void FrictionForces::find_active() {
  active_.clear();
  for (std::size_t j = 0; j < joints(); ++j) {
    for (std::size_t i = 0; i < joints(); ++i) {
      if (response(i, j) == Planar<double>{}) continue;
      active_.push_back(j);
      break;
    }
  }
}

bool FrictionForces::is_unique() {
  find_active();
  if (contracts()) return true;
  std::size_t pins = 0, others = 1;
  for (const std::size_t i : active_) {
    if (sizes_[i] == Size::pin)
      ++pins;
    else if ((others *= corners_of(sizes_[i]).size()) > most_corners)
      return false;
  }
  std::size_t around = finest_polygon;
  const auto combinations = [&] {
    double all = static_cast<double>(others);
    for (std::size_t p = 0; p < pins; ++p) all *= static_cast<double>(around);
    return all;
  };
  while (around >= 4 && combinations() > static_cast<double>(most_corners)) --around;
  if (around < 4) return false;
  const double angle = 2 * std::numbers::pi / static_cast<double>(around);
  std::size_t next = 0;
  for (std::size_t p = 0; p < active_.size(); ++p) {
    first_corner_[p] = next;
    const Size size = sizes_[active_[p]];
    if (size == Size::pin) {
      for (std::size_t c = 0; c < around; ++c) {
        corners_[next++] = 1.0 / std::cos(angle / 2) * at_angle(angle * static_cast<double>(c));
      }
      continue;
    }
    for (const Planar<double>& corner : corners_of(size)) corners_[next++] = corner;
  }
  first_corner_[active_.size()] = next;
  return sign_at_corners() == 1;
}

// Which w of a joint leads: a corner of K, or one in an arc of directions.
struct FrictionForces::Part {
  bool is_arc = false;
  Planar<double> corner{};
  double from = 0.0, to = 0.0;  // rad

  double middle() const { return (from + to) / 2; }
  double half() const { return (to - from) / 2; }
};

struct FrictionForces::Search {
  FrictionForces& of;
  All out{};
  int cells = 0;
  double scale = 0.0;
  std::vector<Part> parts{};
  VectorXd inside{};  // of the last room that was found

  std::size_t count() const { return of.active_.size(); }

  Planar<double> force_at(std::size_t p, const VectorXd& g) const {
    const std::size_t i = of.active_[p];
    Planar<double> sum = of.force(i);
    for (std::size_t q = 0; q < count(); ++q) sum += g[static_cast<Index>(q)] * of.response(i, of.active_[q]);
    return sum;
  }

  void run() {
    of.find_active();
    inside = VectorXd::Zero(static_cast<Index>(count()));
    for (const std::size_t i : of.active_) scale = std::max(scale, norm(of.force(i)));
    if (scale == 0.0) scale = 1.0;
    assign();
  }

  // Gives the next joint each of its parts.
  void assign() {
    if (parts.size() == count()) return look();
    const Size size = of.sizes_[of.active_[parts.size()]];
    if (size != Size::pin) {
      for (const Planar<double>& corner : corners_of(size)) try_part({false, corner});
      return;
    }
    constexpr double quarter = std::numbers::pi / 2;
    for (int k = 0; k < 4; ++k) try_part({true, {}, k * quarter, (k + 1) * quarter});
  }

  void try_part(const Part& part) {
    parts.push_back(part);
    if (has_room()) assign();
    parts.pop_back();
  }

  // Whether some g satisfies, in each part given, linear conditions that follow from the equations: `inside` is one.
  bool has_room() {
    if (++cells > most_cells) out.complete = false;
    if (!out.complete) return false;
    std::vector<VectorXd> rows;
    std::vector<double> bounds;
    const auto n = static_cast<Index>(count());
    // sign g_p + w . R_p <= 0
    const auto below = [&](std::size_t p, double sign, const Planar<double>& w) {
      VectorXd row(n);
      for (std::size_t q = 0; q < count(); ++q) {
        row[static_cast<Index>(q)] = dot(w, of.response(of.active_[p], of.active_[q]));
      }
      row[static_cast<Index>(p)] += sign;
      rows.push_back(std::move(row));
      bounds.push_back((feasible_within * scale - dot(w, of.force(of.active_[p]))) / scale);
    };
    for (std::size_t p = 0; p < count(); ++p) below(p, -1.0, {});
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Part& part = parts[p];
      if (!part.is_arc) {
        below(p, 1.0, -part.corner);
        for (const Planar<double>& other : corners_of(of.sizes_[of.active_[p]])) below(p, -1.0, other);
        continue;
      }
      below(p, 0.0, -quarter_turn(at_angle(part.from)));
      below(p, 0.0, quarter_turn(at_angle(part.to)));
      for (const double angle : {part.from, part.middle(), part.to}) below(p, -1.0, at_angle(angle));
      below(p, 1.0, -1.0 / std::cos(part.half()) * at_angle(part.middle()));
    }
    solvers::LinearProgram program{MatrixXd(static_cast<Index>(rows.size()), n),
                                   VectorXd(static_cast<Index>(rows.size())), VectorXd::Zero(n)};
    for (std::size_t r = 0; r < rows.size(); ++r) {
      program.rows.row(static_cast<Index>(r)) = rows[r].transpose();
      program.bounds[static_cast<Index>(r)] = bounds[r];
    }
    const solvers::LinearProgramResult found = solve(program);
    if (found.status == solvers::LinearProgramResult::Status::infeasible) return false;
    if (found.x.size() == n)
      inside = scale * found.x;
    else
      inside.setZero();
    return true;
  }

  // With a part of every joint, in which there is room.
  void look() {
    const bool is_injective = injective();
    if (is_injective) {
      const std::optional<VectorXd> g = newton(inside);
      if (g && is_here(*g)) return keep(*g);
    }
    std::size_t widest = count();
    for (std::size_t p = 0; p < count(); ++p) {
      if (parts[p].is_arc && (widest == count() || parts[p].half() > parts[widest].half())) widest = p;
    }
    if (widest == count() ? !is_injective : parts[widest].half() < narrowest_arc) out.complete = false;
    if (widest == count() || !out.complete) return;
    const Part whole = parts[widest];
    for (const bool second : {false, true}) {
      parts[widest] = {true, {}, second ? whole.middle() : whole.from, second ? whole.to : whole.middle()};
      if (has_room()) look();
    }
    parts[widest] = whole;
  }

  // The determinant has one sign for all w of the parts: the equations have at most one solution there.
  bool injective() {
    std::size_t next = 0;
    for (std::size_t p = 0; p < count(); ++p) {
      of.first_corner_[p] = next;
      const Part& part = parts[p];
      if (!part.is_arc) {
        of.corners_[next++] = part.corner;
        continue;
      }
      of.corners_[next++] = at_angle(part.from);
      of.corners_[next++] = at_angle(part.to);
      of.corners_[next++] = 1.0 / std::cos(part.half()) * at_angle(part.middle());
    }
    of.first_corner_[count()] = next;
    return of.sign_at_corners() != 0;
  }

  std::optional<VectorXd> newton(VectorXd g) const {
    const auto n = static_cast<Index>(count());
    for (int step = 0; step < most_friction_steps; ++step) {
      VectorXd miss(n);
      MatrixXd by(n, n);
      for (std::size_t p = 0; p < count(); ++p) {
        const Planar<double> force = force_at(p, g);
        Planar<double> w = parts[p].corner;
        if (parts[p].is_arc) {
          const double size = norm(force);
          w = size > 0.0 ? 1.0 / size * force : at_angle(parts[p].middle());
        }
        miss[static_cast<Index>(p)] = g[static_cast<Index>(p)] - dot(w, force);
        for (std::size_t q = 0; q < count(); ++q) {
          by(static_cast<Index>(p), static_cast<Index>(q)) =
              (p == q ? 1.0 : 0.0) - dot(w, of.response(of.active_[p], of.active_[q]));
        }
      }
      const VectorXd change = by.partialPivLu().solve(miss);
      if (!change.allFinite()) return std::nullopt;
      g -= change;
      if (change.norm() <= 1e-14 * g.norm() || change.norm() == 0.0) return g;
    }
    return g;
  }

  // Whether g solves the equations, in these parts.
  bool is_here(const VectorXd& g) const {
    const double least = -agrees_within * std::max(scale, g.norm());
    for (std::size_t p = 0; p < count(); ++p) {
      const double own = g[static_cast<Index>(p)];
      const Planar<double> force = force_at(p, g);
      if (own < least || std::abs(own - size_of(of.sizes_[of.active_[p]], force)) > -least) return false;
      const Part& part = parts[p];
      if (!part.is_arc) {
        if (std::abs(own - dot(part.corner, force)) > -least) return false;
        continue;
      }
      const Planar<double> from = at_angle(part.from), to = at_angle(part.to);
      if (dot(quarter_turn(from), force) < least || dot(quarter_turn(to), force) > -least) return false;
    }
    return true;
  }

  // Of all joints.
  void keep(const VectorXd& g) {
    std::vector<double> sizes(of.joints());
    double largest = scale, apart = 0.0;
    for (std::size_t i = 0; i < of.joints(); ++i) {
      Planar<double> force = of.force(i);
      for (std::size_t q = 0; q < count(); ++q) force += g[static_cast<Index>(q)] * of.response(i, of.active_[q]);
      sizes[i] = size_of(of.sizes_[i], force);
      largest = std::max(largest, sizes[i]);
    }
    for (const std::vector<double>& known : out.sizes) {
      apart = 0.0;
      for (std::size_t i = 0; i < of.joints(); ++i) apart = std::max(apart, std::abs(sizes[i] - known[i]));
      if (apart <= same_within * largest) return;
    }
    out.sizes.push_back(std::move(sizes));
  }
};

double FrictionForces::size_of(Size size, const Planar<double>& force) {
  return size == Size::pin ? norm(force) : std::max(std::abs(force.x), std::abs(force.y));
}

FrictionForces::All FrictionForces::all() {
  Search search{*this};
  search.run();
  return std::move(search.out);
}

}  // namespace poise
