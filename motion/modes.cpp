#include "motion/modes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "motion/small_motions.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// Reduced masses below this share of the largest count as zero.
constexpr double no_mass = 1e-12;
// Stiffnesses below this share of the largest entry of the tangent are rounding.
constexpr double no_stiffness = 1e-12;
// With follower loads, real parts below this share of |s| are rounding of a purely imaginary pair.
constexpr double no_growth = 1e-7;

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
  Linear(const MotionModel& model, SmallMotions motions) : model_(model), motions_(std::move(motions)) {
    out_.freedoms = motions_.freedoms();
    out_.mobility = motions_.mobility;
    out_.stops = motions_.stops;
    out_.just_touched = motions_.just_touched;
  }

  Modes modes() {
    if (out_.freedoms == 0) {
      out_.why = !out_.stops.empty() ? "it is held by its stops" : "its closures leave no degree of freedom";
      return out_;
    }
    if (out_.mobility.finite == 0 && out_.mobility.by == Freedoms::By::curvature) {
      out_.why = "its closures leave infinitesimal motion only";
      return out_;
    }
    if (!condense()) return out_;
    out_.known = true;
    if (motions_.symmetric)
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
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(motions_.mass);
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
      const solvers::FullyPivotedLu own(l.transpose() * motions_.stiffness * l);
      if (own.largest_pivot() <= no_stiffness * motions_.largest || own.reciprocal_condition() < no_stiffness) {
        out_.why = fmt::format(
            "coordinate \"{}\" has neither inertia nor stiffness, so its motion is undetermined; "
            "expected a mass, a moment of inertia or a spring there",
            main_coordinate(l.col(0)));
        return false;
      }
      if ((motions_.damping * l).cwiseAbs().maxCoeff() > no_mass * motions_.damping.cwiseAbs().maxCoeff()) {
        out_.why = fmt::format(
            "coordinate \"{}\" is damped but has no inertia, so it creeps instead of oscillating; "
            "expected a mass or a moment of inertia there",
            main_coordinate(l.col(0)));
        return false;
      }
      lift_ -= l * own.solve(MatrixXd(l.transpose() * motions_.stiffness * lift_));
    }
    unit_stiffness_ = lift_.transpose() * motions_.stiffness * lift_;
    unit_damping_ = lift_.transpose() * motions_.damping * lift_;
    return true;
  }

  std::string main_coordinate(const VectorXd& direction) const {
    Index largest = 0;
    (motions_.basis * direction).cwiseAbs().maxCoeff(&largest);
    return model_.layout().coordinates[largest].name;
  }

  // Rounding error of a squared frequency along z.
  double zero_square(const VectorXcd& z) const {
    return no_stiffness * motions_.largest * (motions_.basis * (lift_ * z)).squaredNorm();
  }

  std::vector<Complex> shape(const VectorXcd& z) const {
    const VectorXcd x = motions_.basis * (lift_ * z);
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
  SmallMotions motions_;
  MatrixXd lift_, unit_stiffness_, unit_damping_;
  Modes out_;
};

}  // namespace

Modes modes_of(const MotionModel& model, const std::vector<double>& x) {
  return Linear(model, small_motions(model, x)).modes();
}

}  // namespace poise
