#include "tests/judge/small_steps.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/model/curvature.hpp"

namespace poise::judge {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double shortest = 1e-11;        // part of the way
constexpr double shortest_change = 1e-7;  // the same, of a step in which stops come on or off
constexpr int most_small_steps = 3000;
constexpr double kept_to = 1e-9;         // of stops, rad or mechanism sizes; of pushes, the model's unit of force
constexpr double flat = 1e-8;            // curvature over the largest entry of the tangent; soft springs may have less
constexpr double faster = 30.0;          // at a fold than in the last of the steps that are not next to it
constexpr double next_to_a_fold = 1e-5;  // part of the way
constexpr double longest = 0.02, shorter = 0.004;  // steps, rad or mechanism sizes
constexpr double invisible = 2e-3;                 // of a snap, rad or mechanism sizes
constexpr double little = 0.7;                     // change of the equations in a step that is taken with care

double largest_of(const VectorXd& v) { return v.size() == 0 ? 0.0 : v.cwiseAbs().maxCoeff(); }

/// An equilibrium with given stops at their limits.
struct Rest {
  std::vector<double> x;
  VectorXd y;
  std::vector<signed char> side;  ///< per stop: -1 at min, 1 at max, 0 free
  double least = 0.0;             ///< curvature, over the largest entry of the tangent
  double weakest = 1.0;           ///< singular value of the rows, over the largest
  MatrixXd equations;             ///< those that decide; empty where rows repeat others
  int sign = 0;                   ///< of their determinant
};

struct Values {
  std::vector<double> c;
  double lower(const Mechanism<double>& m, int s) const { return c[m.stop_row(s)] - m.lower()[s]; }
  double upper(const Mechanism<double>& m, int s) const { return m.upper()[s] - c[m.stop_row(s)]; }
};

Values values_at(const Mechanism<double>& m, const std::vector<double>& x) {
  Values out;
  std::vector<Planar<double>> pose(m.pose_size());
  out.c.resize(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), out.c.data());
  return out;
}

// Of these rows some that are independent at x.
std::vector<int> independent(const Mechanism<double>& m, const std::vector<double>& x, const std::vector<int>& rows) {
  if (rows.empty()) return rows;
  const DensePoint<double> point(m, x, rows);
  const auto order = solvers::pivot_order<double>(point.jacobian.transpose(), solvers::known_to::closed_point);
  std::vector<int> out;
  for (int k = 0; k < order.rank; ++k) out.push_back(rows[order.columns[k]]);
  return out;
}

std::vector<int> independent_closures(const Mechanism<double>& m, const std::vector<double>& x) {
  std::vector<int> all(m.equalities());
  std::iota(all.begin(), all.end(), 0);
  return independent(m, x, all);
}

std::vector<int> rows_of(const Mechanism<double>& m, std::vector<int> closures, const std::vector<signed char>& side) {
  for (int s = 0; s < m.stops(); ++s) {
    if (side[s] != 0) closures.push_back(m.stop_row(s));
  }
  return closures;
}

// Newton's method on F + J^T y = 0, c = 0, stops of `side` at their limits.
std::optional<Rest> newton(const StaticModel& model, std::vector<double> x, const std::vector<int>& closures,
                           const std::vector<signed char>& side) {
  const Mechanism<double>& m = model.mechanism();
  const std::vector<int> rows = rows_of(m, closures, side);
  const auto n = static_cast<Index>(x.size()), k = static_cast<Index>(rows.size());
  Rest out;
  out.side = side;
  double last = 1e300;
  for (int i = 0; i < 12; ++i) {
    DensePoint<double> point(m, x, rows);
    if (i == 0) out.y = point.multipliers();
    MatrixXd all = MatrixXd::Zero(n + k, n + k);
    const MatrixXd tangent = point.tangent(out.y);
    all.topLeftCorner(n, n) = tangent;
    all.topRightCorner(n, k) = point.jacobian.transpose();
    all.bottomLeftCorner(k, n) = point.jacobian;
    VectorXd right(n + k);
    right.head(n) = -point.force;
    for (Index r = 0; r < k; ++r) {
      double bound = 0.0;
      if (rows[r] >= m.equalities()) {
        const int s = rows[r] - m.equalities();
        bound = side[s] < 0 ? m.lower()[s] : m.upper()[s];
      }
      right[n + r] = bound - point.constraint[rows[r]];
    }
    const VectorXd step = solvers::minimum_norm_solution<double>(all, right, 1e-13);
    if (!step.allFinite()) return std::nullopt;
    out.y = step.tail(k);
    const double size = largest_of(step.head(n));
    const bool is_last = size < 1e-12 || (size < 1e-8 && size >= 0.3 * last);
    for (Index j = 0; j < n; ++j) x[j] += step[j];
    if (size > 3.0 || (i > 3 && size > last && size > 1e-8)) return std::nullopt;
    last = size;
    if (!is_last) continue;
    // The equations hold, which a least-squares solution alone does not say.
    const VectorXd left = all * step - right;
    if (largest_of(left) > 1e-8 * std::max(1.0, largest_of(right))) return std::nullopt;
    const Values reached = values_at(m, x);
    for (int r = 0; r < m.equalities(); ++r) {
      if (std::abs(reached.c[r]) > 1e-8) return std::nullopt;  // one that repeated others no longer does
    }
    out.x = std::move(x);
    const MatrixXd basis = k == 0 ? MatrixXd(MatrixXd::Identity(n, n))
                                  : solvers::null_space<double>(point.jacobian, solvers::known_to::closed_point);
    const double scale = std::max(1e-300, tangent.size() == 0 ? 0.0 : tangent.cwiseAbs().maxCoeff());
    if (basis.cols() > 0) {
      const MatrixXd reduced = basis.transpose() * tangent * basis;
      out.least = solvers::symmetric_eigenvalues<double>(0.5 * (reduced + reduced.transpose()))[0] / scale;
    } else {
      out.least = 1.0;
    }
    const bool repeats = basis.cols() + k != n;
    if (k > 0) {
      const VectorXd values = solvers::singular_values(point.jacobian);
      const Index independent = n - basis.cols();
      out.weakest = independent > 0 ? values[independent - 1] / values[0] : 1.0;
    }
    // Where nothing is free the equations of balance follow from those of the rows, and change no sign.
    const MatrixXd& square = k == n ? point.jacobian : all;
    if (!repeats) {
      out.sign = Eigen::PartialPivLU<MatrixXd>(square).determinant() >= 0.0 ? 1 : -1;
      out.equations = square;
    }
    return out;
  }
  return std::nullopt;
}

// The equations change so little that none between them is singular: with A from one to the other, all eigenvalues of
// A0^-1 A1 are near 1. Near a cusp two regular points may be close, and on different sheets.
bool change_little(const MatrixXd& from, const MatrixXd& to) {
  if (from.rows() == 0 || from.rows() != to.rows()) return true;
  const MatrixXd change = Eigen::PartialPivLU<MatrixXd>(from).solve(to - from);
  return change.allFinite() && change.eigenvalues().cwiseAbs().maxCoeff() < little;
}

// A stop that is overrun, or one that would have to pull; -1 if there is none.
int broken_stop(const StaticModel& model, const Rest& rest) {
  const Mechanism<double>& m = model.mechanism();
  const Values values = values_at(m, rest.x);
  Index y = rest.y.size() - std::count_if(rest.side.begin(), rest.side.end(), [](signed char s) { return s != 0; });
  int worst = -1;
  double by = 1.0;
  const double heavy = std::max(1.0, largest_of(rest.y));
  for (int s = 0; s < m.stops(); ++s) {
    double excess = 0.0;
    if (rest.side[s] == 0) {
      excess = std::max(-values.lower(m, s), -values.upper(m, s)) / kept_to;
    } else {
      if (m.lower()[s] != m.upper()[s]) excess = -rest.side[s] * rest.y[y] / (kept_to * heavy);
      ++y;
    }
    if (excess > by) {
      by = excess;
      worst = s;
    }
  }
  return worst;
}

}  // namespace

double apart(const BodyPoses& a, const BodyPoses& b, double size) {
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    most = std::max({most, std::abs(a[i].angle - b[i].angle), norm(a[i].origin - b[i].origin) / size});
  }
  return most;
}

std::optional<std::vector<double>> coordinates_at(const StaticModel& model, const BodyPoses& poses) {
  const StaticModel there(started_at(model.scene(), poses), model.scales());
  std::vector<double> x = there.start();
  if (x.size() != static_cast<std::size_t>(model.mechanism().coordinates())) return std::nullopt;
  const Mechanism<double>& m = model.mechanism();
  std::vector<int> rows(m.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  for (int i = 0; i < 6 && !rows.empty(); ++i) {
    const DensePoint<double> point(m, x, rows);
    const VectorXd gaps = VectorXd::Map(point.constraint.data(), m.equalities());
    if (largest_of(gaps) > 1e-3) return std::nullopt;
    if (largest_of(gaps) < 1e-14) break;  // pins that nearly coincide turn far for the rounding of a gap
    const VectorXd step = solvers::minimum_norm_solution<double>(point.jacobian, -gaps, 1e-12);
    for (std::size_t j = 0; j < x.size(); ++j) x[j] += step[static_cast<Index>(j)];
    if (largest_of(step) < 1e-14) break;
  }
  if (apart(poses, model.poses(x), model.scales().length) > 1e-6) return std::nullopt;
  return x;
}

namespace {

// Follows an equilibrium while a number of the scene goes from 0 to 1, in steps of which each is looked at.
class NumberSteps {
 public:
  NumberSteps(const VariedScene& varied, const BodyPoses& poses, bool with_care)
      : varied_(varied), step_size_(with_care ? shorter : longest), with_care_(with_care) {
    out_.poses = poses;
  }

  SmallSteps run() {
    out_.why = find_start();
    if (!out_.why.empty()) return out_;
    for (int k = 0; s_ < 1.0; ++k) {
      if (k == most_small_steps) {
        out_.why = fmt::format("{} steps came to {:.6g}", most_small_steps, s_);
        return out_;
      }
      const double to = std::min(1.0, s_ + h_);
      const auto model = varied_.model_at(to);
      next_ = newton(*model, here_->x, closures_, here_->side);
      if (is_good() && !set_stops(*model)) {
        h_ *= 0.5;
        continue;
      }
      if (why_.empty()) {
        go_on(to);
      } else if (h_ > shortest) {
        h_ *= 0.5;
      } else if (!passes_invisible_snap()) {
        return lost();
      }
    }
    out_.end = SmallSteps::End::arrived;
    out_.part = 1.0;
    out_.poses = varied_.model_at(1.0)->poses(here_->x);
    return out_;
  }

 private:
  static double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double far = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) far = std::max(far, std::abs(a[i] - b[i]));
    return far;
  }

  // Finds the equilibrium at the start; says why not where there is none to be followed.
  std::string find_start() {
    begin_ = varied_.model_at(0.0);
    const StaticModel* const begin = begin_.get();
    const Mechanism<double>& m = begin->mechanism();
    if (m.has_follower_loads()) return "loads follow bodies";
    const auto start = coordinates_at(*begin, out_.poses);
    if (!start) return "the loops do not close at the start";
    closures_ = independent_closures(m, *start);
    std::vector<signed char> side = stops_in_contact(m, *start);
    for (int k = 0; k <= m.stops(); ++k) {
      here_ = newton(*begin, *start, closures_, side);
      if (!here_) return "no equilibrium at the start";
      const int broken = broken_stop(*begin, *here_);
      if (broken < 0) break;
      if (side[broken] == 0) return "a stop is overrun at the start";
      side[broken] = 0;
    }
    if (apart(begin->poses(here_->x), out_.poses, begin->scales().length) > 1e-6) return "it does not rest there";
    if (here_->least < flat) return "not stable at the start";
    if (here_->sign == 0 || here_->weakest < 1e-6) return "singular at the start";
    return "";
  }

  // Stops in contact, but for those that would share their force with others, which carry it alone.
  std::vector<signed char> stops_in_contact(const Mechanism<double>& m, const std::vector<double>& x) const {
    std::vector<signed char> side(m.stops(), 0);
    const Values values = values_at(m, x);
    for (int s = 0; s < m.stops(); ++s) {
      if (values.lower(m, s) < 1e-8) side[s] = -1;
      if (values.upper(m, s) < 1e-8) side[s] = 1;
    }
    for (int s = 0; s < m.stops(); ++s) {
      if (side[s] == 0 || m.lower()[s] == m.upper()[s]) continue;
      const std::vector<int> rows = rows_of(m, closures_, side);
      if (independent(m, x, rows).size() < rows.size()) side[s] = 0;
    }
    return side;
  }

  // Judges the step in hand.
  bool is_good() {
    why_.clear();
    is_singular_ = false;
    if (!next_) {
      why_ = "no equilibrium near";
    } else if (distance(next_->x, here_->x) > step_size_) {
      why_ = "it moves too far";
    } else if (with_care_ && next_->side == here_->side && !change_little(here_->equations, next_->equations)) {
      why_ = "the equations change too far";
    } else if (next_->least < -flat) {
      why_ = "it turns unstable";
      is_singular_ = true;
    } else if (next_->sign * here_->sign < 0 && next_->side == here_->side) {
      why_ = "the equations turn singular";
      is_singular_ = true;
    }
    return why_.empty();
  }

  // Finds the stops that act at the end of a good step. False where a shorter step should be made first.
  bool set_stops(const StaticModel& model) {
    const Mechanism<double>& m = begin_->mechanism();
    int broken = broken_stop(model, *next_);
    if (broken >= 0 && h_ > shortest_change) return false;
    for (int turn = 0; broken >= 0 && turn < 2 * m.stops(); ++turn) {
      std::vector<signed char> other = next_->side;
      const Values at = values_at(m, next_->x);
      other[broken] = other[broken] != 0 ? 0 : at.c[m.stop_row(broken)] < model.mechanism().lower()[broken] ? -1 : 1;
      next_ = newton(model, here_->x, closures_, other);
      if (!is_good()) break;
      broken = broken_stop(model, *next_);
    }
    if (why_.empty() && broken >= 0) why_ = "no set of stops is consistent";
    return true;
  }

  void go_on(double to) {
    const double moved = distance(next_->x, here_->x);
    rate_ = moved / (to - s_);
    if (to - s_ > next_to_a_fold) rate_before_ = rate_;
    here_ = std::move(next_);
    s_ = to;
    h_ *= moved < 0.3 * step_size_ ? 2.0 : 1.0;
  }

  // Whether a snap that nobody can see leads on.
  bool passes_invisible_snap() {
    for (double beyond = 1e-9; beyond < 1e-4 && s_ + beyond < 1.0; beyond *= 10.0) {
      const auto there = varied_.model_at(s_ + beyond);
      const Settling rest = settle(*there, here_->x);
      if (rest.end != Settling::End::settled || distance(rest.x, here_->x) > invisible) continue;
      next_ = newton(*there, rest.x, closures_, here_->side);
      if (!next_ || !(distance(next_->x, here_->x) < invisible) || !(next_->least >= flat)) continue;
      if (broken_stop(*there, *next_) >= 0) continue;
      s_ += beyond;
      here_ = std::move(next_);
      return true;
    }
    return false;
  }

  SmallSteps lost() {
    out_.part = s_;
    out_.why = why_;
    out_.poses = varied_.model_at(s_)->poses(here_->x);
    // Towards a fold it moves faster and faster, as one over the square root of the way to it; otherwise rounding has
    // ended the steps.
    const bool is_lost = is_singular_ || rate_ > faster * rate_before_;
    out_.end = is_lost ? SmallSteps::End::lost : SmallSteps::End::undecided;
    return out_;
  }

  const VariedScene& varied_;
  const double step_size_;
  const bool with_care_;
  SmallSteps out_;
  std::unique_ptr<const StaticModel> begin_;
  std::vector<int> closures_;
  std::optional<Rest> here_, next_;
  double s_ = 0.0, h_ = 0.02;
  double rate_ = 0.0, rate_before_ = 1e300;  // of motion, in the last step, and in the last of some length
  std::string why_;                          // the step in hand is no good
  bool is_singular_ = false;
};

}  // namespace

SmallSteps follow_numbers(const VariedScene& varied, const BodyPoses& poses, bool with_care) {
  return NumberSteps(varied, poses, with_care).run();
}

// --- one freedom ----------------------------------------------------------------------------------------------------

CurveOfPoses::CurveOfPoses(Scene scene, int held, const BodyPoses& poses)
    : model_(std::move(scene)), stops_(model_.mechanism().stops() - held) {
  const Mechanism<double>& m = model_.mechanism();
  const auto x = coordinates_at(model_, poses);
  if (!x) return;
  x_ = *x;
  rows_ = independent_closures(m, x_);
  is_curve_ = static_cast<int>(rows_.size()) + 1 == m.coordinates();
}

std::optional<CurveOfPoses::Spot> CurveOfPoses::spot(std::vector<double> x, const VectorXd* like) const {
  const Mechanism<double>& m = model_.mechanism();
  Spot out;
  const auto n = static_cast<Index>(x.size());
  for (int i = 0;; ++i) {
    if (i == 8) return std::nullopt;
    const DensePoint<double> point(m, x, rows_);
    VectorXd gaps(static_cast<Index>(rows_.size()));
    for (std::size_t r = 0; r < rows_.size(); ++r) gaps[static_cast<Index>(r)] = point.constraint[rows_[r]];
    const VectorXd step = rows_.empty() ? VectorXd(VectorXd::Zero(n))
                                        : solvers::minimum_norm_solution<double>(point.jacobian, -gaps, 1e-13);
    for (Index j = 0; j < n; ++j) x[j] += step[j];
    if (largest_of(step) > 1e-12) continue;
    const MatrixXd basis =
        rows_.empty() ? MatrixXd(MatrixXd::Identity(n, n)) : solvers::null_space<double>(point.jacobian, 1e-12);
    if (basis.cols() != 1) return std::nullopt;
    out.tangent = basis.col(0) / largest_of(basis.col(0));
    if (like != nullptr && like->dot(out.tangent) < 0.0) out.tangent = -out.tangent;
    MatrixXd square(n, n);
    square.topRows(n - 1) = point.jacobian;
    square.row(n - 1) = out.tangent.transpose();
    out.sign = Eigen::PartialPivLU<MatrixXd>(square).determinant() >= 0.0 ? 1.0 : -1.0;
    out.weakest = 1.0;
    if (!rows_.empty()) {
      const VectorXd values = solvers::singular_values(point.jacobian);
      out.weakest = values[values.size() - 1] / values[0];
    }
    out.x = std::move(x);
    return out;
  }
}

bool CurveOfPoses::begins_singular() const {
  const std::optional<Spot> here = spot(x_, nullptr);
  return !here || here->weakest < 1e-5;
}

// A step of about h along the curve; none where a stop or a singular pose is in the way.
std::optional<CurveOfPoses::Spot> CurveOfPoses::next(const Spot& here, double h, std::string& why) const {
  const Mechanism<double>& m = model_.mechanism();
  for (; h > 1e-9; h *= 0.5) {
    std::vector<double> x = here.x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += h * here.tangent[static_cast<Index>(i)];
    const std::vector<double> predicted = x;
    std::optional<Spot> there = spot(std::move(x), &here.tangent);
    why = "a singular pose";
    if (!there) continue;
    double off = 0.0;
    for (std::size_t i = 0; i < predicted.size(); ++i) off = std::max(off, std::abs(predicted[i] - there->x[i]));
    if (off > 0.1 * h || largest_of(there->tangent - here.tangent) > 0.3) continue;
    // Where curves cross, straight on.
    if (there->sign != here.sign && (off > 0.01 * h || largest_of(there->tangent - here.tangent) > 0.05)) continue;
    const Values values = values_at(m, there->x);
    bool keeps = true;
    for (int s = 0; s < stops_; ++s) {
      if (std::min(values.lower(m, s), values.upper(m, s)) > -kept_to) continue;
      keeps = false;
      why = fmt::format("stop \"{}\"", model_.scene().stops[static_cast<std::size_t>(s)].name);
    }
    if (keeps) return there;
  }
  return std::nullopt;
}

CurveOfPoses::Walked CurveOfPoses::to(const BodyPoses& poses) const {
  constexpr double step = 0.01, farthest = 25.0;
  Walked out;
  const auto goal = coordinates_at(model_, poses);
  if (!goal) {
    out.why = "the loops do not close there";
    return out;
  }
  const VectorXd target = VectorXd::Map(goal->data(), static_cast<Index>(goal->size()));
  // Whole turns of bars do not count.
  std::vector<char> is_bar(goal->size(), 0);
  for (const Link& link : model_.layout().links) {
    if (link.body < 0 && link.frame >= 0) is_bar[static_cast<std::size_t>(link.frame)] = 1;
  }
  const auto missing = [&](const Spot& at) -> VectorXd {
    VectorXd left = target - VectorXd::Map(at.x.data(), static_cast<Index>(at.x.size()));
    for (Index i = 0; i < left.size(); ++i) {
      if (is_bar[static_cast<std::size_t>(i)] != 0) left[i] = std::remainder(left[i], 2 * M_PI);
    }
    return left;
  };
  for (const double turn : {1.0, -1.0}) {
    std::optional<Spot> here = spot(x_, nullptr);
    if (!here) {
      out.why = "a singular pose at the start";
      return out;
    }
    if (largest_of(missing(*here)) < 1e-7) {
      out.passed = true;
      return out;
    }
    const double first = missing(*here).dot(here->tangent) >= 0.0 ? turn : -turn;
    here->tangent *= first;
    here->sign *= first;
    double walked = 0.0;
    while (walked < farthest) {
      // A last step that ends beside the goal.
      const VectorXd left = missing(*here);
      const double along = left.dot(here->tangent) / here->tangent.squaredNorm();
      if (along >= 0.0 && along <= 1.5 * step && largest_of(left - along * here->tangent) < step) {
        std::string why;
        const auto there = next(*here, std::max(along, 2e-9), why);
        for (std::optional<Spot> at = there; at;) {
          const VectorXd rest = missing(*at);
          if (largest_of(rest) < 3e-7) {
            out.passed = true;
            return out;
          }
          const double by = rest.dot(at->tangent) / at->tangent.squaredNorm();
          std::vector<double> x = at->x;
          for (std::size_t i = 0; i < x.size(); ++i) x[i] += by * at->tangent[static_cast<Index>(i)];
          const VectorXd before = rest;
          at = spot(std::move(x), &at->tangent);
          if (at && largest_of(missing(*at)) > 0.5 * largest_of(before)) break;
        }
      }
      std::string why;
      std::optional<Spot> there = next(*here, step, why);
      if (!there) {
        out.why += fmt::format("{} after {:.4g}; ", why, walked);
        break;
      }
      double moved = 0.0;
      for (std::size_t i = 0; i < there->x.size(); ++i) moved = std::max(moved, std::abs(there->x[i] - here->x[i]));
      walked += moved;
      here = std::move(there);
    }
    out.goes_on = out.goes_on || walked >= farthest;
  }
  if (out.why.empty()) out.why = "it is on another curve";
  return out;
}

Vec2 CurveOfPoses::place_of(const Spot& spot, PointRef point) const {
  return model_.poses(spot.x)[static_cast<std::size_t>(point.body)].world(model_.scene().local(point));
}

CurveOfPoses::Nearest CurveOfPoses::nearest(PointRef point, Vec2 place) const {
  constexpr double farthest = 25.0;
  Nearest out;
  std::optional<Spot> here = spot(x_, nullptr);
  if (!here || here->weakest < 1e-6) {
    out.ended_by = "a singular pose at the start";
    return out;
  }
  const auto distance = [&](const Spot& at) { return norm(place - place_of(at, point)); };
  out.distance = distance(*here);
  std::string why;
  const auto beside = next(*here, 1e-6, why);
  if (!beside || distance(*beside) > out.distance) {
    here->tangent = -here->tangent;
    here->sign = -here->sign;
  }
  double walked = 0.0;
  for (double h = 0.01; h > 1e-8 && walked < farthest;) {
    const auto there = next(*here, h, why);
    if (!there) {
      out.ended_by = why;
      return out;
    }
    if (distance(*there) >= out.distance) {
      h *= 0.5;
      continue;
    }
    out.distance = distance(*there);
    walked += h;
    here = there;
  }
  return out;
}

}  // namespace poise::judge
