#include "motion/modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "motion/body_motion.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// Distance within which a stop is touched, rad or mechanism sizes.
constexpr double touching_within = 1e-8;
// Reduced masses below this share of the largest count as zero.
constexpr double no_mass = 1e-12;
// Stiffnesses below this share of the largest entry of the tangent are rounding.
constexpr double no_stiffness = 1e-12;
// With follower loads, real parts below this share of |s| are rounding of a purely imaginary pair.
constexpr double no_growth = 1e-7;

// Closure rows and the stops active at x.
std::vector<int> holding_rows(const Mechanism<double>& m, const std::vector<double>& x) {
  const int closures = m.equalities();
  std::vector<int> rows(closures);
  std::iota(rows.begin(), rows.end(), 0);
  const DensePoint<double> at(m, x, rows);
  for (int s = 0; s < m.stops(); ++s) {
    const double g = at.constraint[closures + s];
    if (g >= m.upper()[s] - touching_within || g <= m.lower()[s] + touching_within) rows.push_back(closures + s);
  }
  // Stops whose reaction has the wrong sign or is zero are released, the largest wrong one first; those whose limits
  // are equal hold whatever they carry.
  while (static_cast<int>(rows.size()) > closures) {
    const DensePoint<double> point(m, x, rows);
    const VectorXd push = point.multipliers();
    const double zero = 1e-10 * std::max(1.0, push.cwiseAbs().maxCoeff());
    Index worst = -1;
    double hardest = zero;
    for (Index k = closures; k < push.size(); ++k) {
      const int s = rows[k] - closures;
      if (m.upper()[s] == m.lower()[s]) continue;
      const bool both = m.upper()[s] - m.lower()[s] <= 2 * touching_within;
      const double pressure = both                                                          ? std::abs(push[k])
                              : point.constraint[rows[k]] >= m.upper()[s] - touching_within ? push[k]
                                                                                            : -push[k];
      if (pressure >= hardest) continue;
      hardest = pressure;
      worst = k;
    }
    if (worst < 0) break;
    rows.erase(rows.begin() + worst);
  }
  return rows;
}

// C = sum of dT/dw r r^T over all elements that damp small motions, with r the rates of their measures along the
// columns of the basis.
MatrixXd reduced_damping(const MotionModel& model, const std::vector<double>& x, const MatrixXd& basis) {
  const Scene& scene = model.scene();
  MatrixXd c = MatrixXd::Zero(basis.cols(), basis.cols());
  const auto damps = [](const Element& e) { return damps_small_motion(e.law); };
  if (std::none_of(scene.elements.begin(), scene.elements.end(), damps)) return c;
  std::vector<std::vector<BodyMotion>> motions;
  const std::vector<double> none(x.size(), 0.0);
  for (Index k = 0; k < basis.cols(); ++k) {
    motions.push_back(body_motions(model, x, {basis.col(k).begin(), basis.col(k).end()}, none));
  }
  const std::vector<BodyPose<double>> poses = model.poses(x);
  for (const Element& e : scene.elements) {
    if (!damps(e)) continue;
    VectorXd r(basis.cols());
    for (Index k = 0; k < r.size(); ++k) r[k] = rate_of(scene, motions[k], e.on);
    const double coefficient = force_of_motion(e.law, value_of(scene, e.on, poses), 0.0).by_rate;
    c += coefficient / model.scales().energy() * r * r.transpose();
  }
  return c;
}

MatrixXd reduced_mass(const MotionModel& model, const std::vector<double>& x, const MatrixXd& basis) {
  const Mechanism<double>& m = model.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  m.place(x.data(), pose.data());
  MatrixXd full(m.coordinates(), m.coordinates());
  model.inertia().mass_matrix(pose.data(), full.data());
  return basis.transpose() * full * basis;
}

// One solution of (s^2 + s C + K) u = 0.
struct Root {
  Complex s;
  VectorXcd u;
};

// All 2f of them. Without damping they are +-sqrt(-k) of the eigenvalues k of K, which keeps oscillations on the
// imaginary axis; with it, eigenvalues of [0 w; -K/w -C], w near the frequencies so that the blocks have comparable
// size.
std::vector<Root> roots_of(const MatrixXd& k, const MatrixXd& c) {
  const Index f = k.rows();
  std::vector<Root> roots;
  if (c.isZero(0.0)) {
    const solvers::Eigenpairs eigen = solvers::eigenpairs(k);
    for (Index i = 0; i < f; ++i) {
      const Complex s = std::sqrt(-eigen.values[i]);
      roots.push_back({s, eigen.vectors.col(i)});
      roots.push_back({-s, eigen.vectors.col(i)});
    }
    return roots;
  }
  const double w = std::max(std::sqrt(k.cwiseAbs().maxCoeff()), 1e-3 * c.cwiseAbs().maxCoeff());
  MatrixXd linear = MatrixXd::Zero(2 * f, 2 * f);
  linear.topRightCorner(f, f).diagonal().setConstant(w);
  linear.bottomLeftCorner(f, f) = -k / w;
  linear.bottomRightCorner(f, f) = -c;
  const solvers::Eigenpairs eigen = solvers::eigenpairs(linear);
  for (Index i = 0; i < 2 * f; ++i) roots.push_back({eigen.values[i], eigen.vectors.col(i).head(f)});
  return roots;
}

// Fills in the quantities that follow from both roots.
void describe_roots(Vibration& vibration, Complex a, Complex b) {
  const Complex plus_zero{0.0, 0.0};  // avoids -0
  vibration.roots = {a + plus_zero, b + plus_zero};
  vibration.growth = std::max(a.real(), b.real());
  vibration.damped_frequency = std::abs(a.imag()) / (2 * M_PI);
  const bool comes_back = vibration.kind != Vibration::Kind::neutral && vibration.kind != Vibration::Kind::diverges;
  if (comes_back) vibration.damping_ratio = -(a + b).real() / (2 * std::sqrt(std::abs(a * b)));
}

// The reduced system in coordinates z of unit mass, y = lift z.
class Linear {
 public:
  Linear(const MotionModel& model, const std::vector<double>& x) : model_(model) {
    const Mechanism<double>& m = model.mechanism();
    const std::vector<int> rows = holding_rows(m, x);
    const ReducedHessian reduced(m, x, rows);
    largest_ = reduced.largest;
    basis_ = reduced.basis;
    stiffness_ = reduced.matrix;
    symmetric_ = !m.has_follower_loads();
    if (symmetric_) stiffness_ = (stiffness_ + stiffness_.transpose()).eval() / 2;
    mass_ = reduced_mass(model, x, basis_);
    damping_ = reduced_damping(model, x, basis_);
    out_.freedoms = static_cast<int>(basis_.cols());
    const bool is_regular = basis_.cols() == m.coordinates() - static_cast<Index>(rows.size());
    out_.mobility = freedoms_at(model, x, is_regular ? std::optional(0) : std::nullopt);
    out_.active_stops = static_cast<int>(std::count_if(rows.begin(), rows.end(), [&](int row) {
      return row >= m.equalities() && !model.scene().stops[static_cast<std::size_t>(row - m.equalities())].couples();
    }));
  }

  Modes modes() {
    if (out_.freedoms == 0) {
      out_.why = out_.active_stops > 0 ? "it is held by its stops" : "its closures leave no degree of freedom";
      return out_;
    }
    if (out_.mobility.finite == 0 && out_.mobility.by == Freedoms::By::curvature) {
      out_.why = "its closures leave infinitesimal motion only";
      return out_;
    }
    if (!condense()) return out_;
    out_.known = true;
    if (symmetric_)
      find_natural_modes();
    else
      find_follower_modes();
    std::stable_sort(out_.vibrations.begin(), out_.vibrations.end(), [](const Vibration& a, const Vibration& b) {
      return rank(a) != rank(b) ? rank(a) < rank(b) : rank(a) == 0 ? a.growth > b.growth : a.frequency < b.frequency;
    });
    return out_;
  }

 private:
  static int rank(const Vibration& v) {
    const bool leaves = v.kind == Vibration::Kind::diverges || v.kind == Vibration::Kind::flutters;
    return leaves ? 0 : v.kind == Vibration::Kind::neutral ? 1 : 2;
  }

  // Static condensation: directions L without inertia follow those with inertia, H:  y_L = -K_LL^-1 K_LH y_H. Also
  // scales the masses of H to 1.
  bool condense() {
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(mass_);
    const VectorXd& m = eigen.values;
    const double heaviest = m[m.size() - 1];
    const Index light = (m.array() <= no_mass * heaviest).count();
    out_.massless = static_cast<int>(light);
    if (heaviest <= 0.0) {
      out_.why = "no body that can move has inertia; expected a mass or moment of inertia on some body";
      return false;
    }
    const MatrixXd l = eigen.vectors.leftCols(light);
    lift_ =
        eigen.vectors.rightCols(m.size() - light) * m.tail(m.size() - light).cwiseSqrt().cwiseInverse().asDiagonal();
    if (light > 0) {
      const solvers::FullyPivotedLu own(l.transpose() * stiffness_ * l);
      if (own.largest_pivot() <= no_stiffness * largest_ || own.reciprocal_condition() < no_stiffness) {
        out_.why = fmt::format(
            "coordinate \"{}\" has neither inertia nor stiffness, so its motion is undetermined; "
            "expected a mass, a moment of inertia or a spring there",
            main_coordinate(l.col(0)));
        return false;
      }
      if ((damping_ * l).cwiseAbs().maxCoeff() > no_mass * damping_.cwiseAbs().maxCoeff()) {
        out_.why = fmt::format(
            "coordinate \"{}\" is damped but has no inertia, so it creeps instead of oscillating; "
            "expected a mass or a moment of inertia there",
            main_coordinate(l.col(0)));
        return false;
      }
      lift_ -= l * own.solve(MatrixXd(l.transpose() * stiffness_ * lift_));
    }
    unit_stiffness_ = lift_.transpose() * stiffness_ * lift_;
    unit_damping_ = lift_.transpose() * damping_ * lift_;
    return true;
  }

  std::string main_coordinate(const VectorXd& direction) const {
    Index largest = 0;
    (basis_ * direction).cwiseAbs().maxCoeff(&largest);
    return model_.layout().coordinates[largest].name;
  }

  // Rounding error of a squared frequency along z.
  double zero_square(const VectorXcd& z) const {
    return no_stiffness * largest_ * (basis_ * (lift_ * z)).squaredNorm();
  }

  std::vector<Complex> shape(const VectorXcd& z) const {
    const VectorXcd x = basis_ * (lift_ * z);
    Index largest = 0;
    x.cwiseAbs().maxCoeff(&largest);
    const Complex phase = std::abs(x[largest]) > 0 ? std::conj(x[largest]) / std::abs(x[largest]) : Complex(1.0);
    const double norm = z.norm() * std::sqrt(model_.scales().energy());
    std::vector<Complex> out;
    for (Index i = 0; i < x.size(); ++i) {
      const double unit = i < model_.layout().angles ? 1.0 : model_.scales().length;
      out.push_back(unit / norm * phase * x[i]);
    }
    return out;
  }

  // K symmetric: real natural modes, each with two of the damped motion's exponents.
  void find_natural_modes() {
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen((unit_stiffness_ + unit_stiffness_.transpose()) / 2);
    const VectorXd& square = eigen.values;
    const MatrixXd& z = eigen.vectors;
    VectorXd clean = square;
    for (Index k = 0; k < square.size(); ++k) {
      if (std::abs(square[k]) <= zero_square(z.col(k))) clean[k] = 0.0;
      Vibration vibration;
      vibration.kind = clean[k] > 0   ? Vibration::Kind::oscillates
                       : clean[k] < 0 ? Vibration::Kind::diverges
                                      : Vibration::Kind::neutral;
      vibration.frequency = std::sqrt(std::max(clean[k], 0.0)) / (2 * M_PI);
      vibration.shape = shape(z.col(k));
      out_.vibrations.push_back(std::move(vibration));
    }
    const MatrixXd modal_damping = z.transpose() * unit_damping_ * z;
    share_out(roots_of(clean.asDiagonal(), modal_damping));
  }

  // Conjugate pairs first, each to the free mode that moves most in it; then single roots, two to each mode left.
  void share_out(std::vector<Root> roots) {
    std::stable_partition(roots.begin(), roots.end(), [](const Root& r) { return r.s.imag() != 0.0; });
    std::vector<std::vector<Complex>> taken(out_.vibrations.size());
    const auto best = [&](const Root& root) {
      std::size_t found = taken.size();
      for (std::size_t k = 0; k < taken.size(); ++k) {
        const bool room = taken[k].empty() || (root.s.imag() == 0.0 && taken[k].size() < 2);
        const auto part = [&](std::size_t i) { return std::abs(root.u[static_cast<Index>(i)]); };
        if (room && (found == taken.size() || part(k) > part(found))) found = k;
      }
      return found;
    };
    for (const Root& root : roots) {
      if (root.s.imag() < 0.0) continue;
      std::vector<Complex>& mode = taken[best(root)];
      mode.push_back(root.s);
      if (root.s.imag() > 0.0) mode.push_back(std::conj(root.s));
    }
    for (std::size_t k = 0; k < taken.size(); ++k) {
      Vibration& vibration = out_.vibrations[k];
      if (vibration.kind == Vibration::Kind::oscillates && taken[k][0].imag() == 0.0) {
        vibration.kind = Vibration::Kind::decays;
      }
      describe_roots(vibration, taken[k][0], taken[k][1]);
    }
  }

  // K unsymmetric: each pair of exponents is a separate motion.
  void find_follower_modes() {
    std::vector<Root> roots = roots_of(unit_stiffness_, unit_damping_);
    std::erase_if(roots, [](const Root& r) { return r.s.imag() < 0.0; });
    std::stable_sort(roots.begin(), roots.end(), [](const Root& a, const Root& b) {
      const bool real_a = a.s.imag() == 0.0;
      const bool real_b = b.s.imag() == 0.0;
      return real_a != real_b ? real_b : std::abs(a.s) < std::abs(b.s);
    });
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const Root& root = roots[i];
      const bool pair = root.s.imag() > 0.0;
      const Complex partner = pair ? std::conj(root.s) : roots[++i].s;
      const Root& grows = pair || root.s.real() >= partner.real() ? root : roots[i];
      add_follower_mode(grows, root.s, partner);
    }
  }

  void add_follower_mode(const Root& root, Complex a, Complex b) {
    Vibration vibration;
    const double size = std::abs(root.s);
    const bool is_complex = root.s.imag() != 0.0;
    if (size * size <= zero_square(root.u / root.u.norm()))
      vibration.kind = Vibration::Kind::neutral;
    else if (root.s.real() > no_growth * size)
      vibration.kind = is_complex ? Vibration::Kind::flutters : Vibration::Kind::diverges;
    else
      vibration.kind = is_complex ? Vibration::Kind::oscillates : Vibration::Kind::decays;
    if (vibration.kind != Vibration::Kind::neutral && vibration.kind != Vibration::Kind::diverges) {
      vibration.frequency = std::sqrt(std::abs(a * b)) / (2 * M_PI);
    }
    describe_roots(vibration, a, b);
    vibration.shape = shape(root.u);
    out_.vibrations.push_back(std::move(vibration));
  }

  const MotionModel& model_;
  bool symmetric_ = true;
  double largest_ = 0.0;
  MatrixXd basis_, stiffness_, mass_, damping_;
  MatrixXd lift_, unit_stiffness_, unit_damping_;
  Modes out_;
};

}  // namespace

Modes modes_of(const MotionModel& model, const std::vector<double>& x) { return Linear(model, x).modes(); }

}  // namespace poise
