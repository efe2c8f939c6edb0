#include "statics/all_equilibria/private/loop_turns.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/held_rows.hpp"

namespace poise {
namespace {

using Eigen::VectorXd;

constexpr int most_followed_coordinates = 16;   // of mechanisms whose curves are followed
constexpr int most_curve_steps = 3000;          // of one curve, each way
constexpr std::size_t most_sign_changes = 200;  // of the sign of the force: more are rounding
constexpr double shortest_curve_step = 3e-5;    // where the closures need shorter ones, curves cross
constexpr double no_force = 1e-10;              // in the mechanism's units of force and size
constexpr double turn_closed_within = 1e-11;
constexpr double stiffness_of_stops = 1e6;   // in these units, much more than that of springs
constexpr double stiffness_to_start = 1e-6;  // much less

VectorXd vector_of(const std::vector<double>& x) {
  return Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

std::vector<double> list_of(const VectorXd& x) { return {x.data(), x.data() + x.size()}; }

// An angle less full turns, at most half of one from another.
double turned_next_to(double angle, double other) { return other + std::remainder(angle - other, 2.0 * M_PI); }

}  // namespace

// The energy of springs on angles, of stops on angles as if they were springs, and of very soft springs that draw all
// angles to the start: of turns that wind and pass nothing those next to it count. Torques do not count: they are the
// same at every turn, and their energy has no least value.
class LoopTurns::WoundSprings {
 public:
  WoundSprings(const StaticModel& model, const Turns& turns, const std::vector<double>& start)
      : turns_(turns),
        start_(start),
        scene_(springs_of(model)),
        mechanism_(scene_, model.layout(), Purpose::statics),
        pose_(static_cast<std::size_t>(mechanism_.pose_size())),
        constraint_(static_cast<std::size_t>(mechanism_.constraints())) {}

  double energy(const std::vector<double>& x) {
    mechanism_.place(x.data(), pose_.data());
    mechanism_.constraint(x.data(), pose_.data(), constraint_.data());
    double out = mechanism_.energy(x.data(), pose_.data());
    for (int s = 0; s < mechanism_.stops(); ++s) {
      if (!counts_turns(scene_.stops[static_cast<std::size_t>(s)].on)) continue;
      const double passed = passed_by(mechanism_, s, constraint_);
      out += stiffness_of_stops * passed * passed;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (turns_.count(static_cast<int>(i))) out += stiffness_to_start * (x[i] - start_[i]) * (x[i] - start_[i]);
    }
    return out;
  }

 private:
  static Scene springs_of(const StaticModel& model) {
    Scene springs = model.scaled_scene();
    std::erase_if(springs.elements, [](const Element& element) {
      return !counts_turns(element.on) || std::holds_alternative<ConstantForce>(element.law);
    });
    springs.dependents.reset();  // which refer to places in these lists
    springs.gravity = {};
    springs.forces.clear();
    springs.torques.clear();
    return springs;
  }

  const Turns& turns_;
  const std::vector<double>& start_;
  Scene scene_;
  Mechanism<double> mechanism_;
  std::vector<Planar<double>> pose_;
  std::vector<double> constraint_;
};

LoopTurns::LoopTurns(const StaticModel& model, const Turns& turns, const std::vector<double>& start)
    : model_(model), turns_(turns), start_(start), rows_(permanent_rows(model.mechanism())) {
  const Mechanism<double>& m = model.mechanism();
  if (m.closures() == 0 || m.coordinates() > most_followed_coordinates) return;
  const auto& columns = m.jacobian_column();
  const auto& rows = m.jacobian_row();
  for (std::size_t e = 0; e < columns.size(); ++e) {
    const bool is_angle = !model.layout().is_length(columns[e]);
    matter_ = matter_ || (rows[e] < m.equalities() && is_angle && turns.count(columns[e]));
  }
  freedoms_ = freedoms_of(model, start);
  is_followed_ = freedoms_ == 1;
  if (known()) courses_.push_back(follow(start));
}

bool LoopTurns::passes(const std::vector<double>& lower, const std::vector<double>& upper) const {
  const auto is_between = [&](const std::vector<double>& pose) {
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const double half = 0.5 * (upper[i] - lower[i]);
      const double apart = pose[i] - (lower[i] + half);
      const bool is_length = model_.layout().is_length(static_cast<int>(i));
      if (std::abs(is_length ? apart : std::remainder(apart, 2.0 * M_PI)) > half) return false;
    }
    return true;
  };
  return std::any_of(courses_.begin(), courses_.end(), [&](const Course& course) {
    return std::any_of(course.poses.begin(), course.poses.end(), is_between);
  });
}

void LoopTurns::add(const std::vector<double>& x) {
  std::vector<double> lower = x, upper = x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    lower[i] -= step;
    upper[i] += step;
  }
  if (passes(lower, upper)) return;
  Course course = follow(x);
  // Of all turns of all its poses those with least wound springs, so that it does not matter which pose was met.
  WoundSprings wound(model_, turns_, start_);
  double least_energy = std::numeric_limits<double>::infinity();
  std::vector<double> shift(x.size(), 0.0);
  for (const std::vector<double>& pose : course.poses) {
    const auto [least, energy] = least_wound(pose, wound);
    if (!(energy < least_energy)) continue;
    least_energy = energy;
    for (std::size_t i = 0; i < x.size(); ++i) shift[i] = least[i] - pose[i];
  }
  for (std::vector<double>& pose : course.poses) {
    for (std::size_t i = 0; i < x.size(); ++i) pose[i] += shift[i];
  }
  courses_.push_back(std::move(course));
}

// Gives the pose with its angles turned fully, one or two at a time, as long as that winds springs less, or passes
// stops less: of two bodies with a spring between them one alone can wind it up where both together unwind another. A
// law whose energy has no least value ends at `most_rounds`.
std::pair<std::vector<double>, double> LoopTurns::least_wound(std::vector<double> x, WoundSprings& wound) const {
  std::vector<std::size_t> told;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!turns_.count(static_cast<int>(i))) continue;
    told.push_back(i);
    x[i] = turned_next_to(x[i], start_[i]);
  }
  double energy = wound.energy(x);
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::size_t i : told) {
      for (const std::size_t j : told) {
        for (const double by : {2.0 * M_PI, -2.0 * M_PI}) {
          std::vector<double> other = x;
          other[i] += by;
          if (j != i) other[j] += by;
          const double farthest = 2.0 * M_PI * (most_rounds + 0.5);
          if (std::abs(other[i] - start_[i]) > farthest || std::abs(other[j] - start_[j]) > farthest) continue;
          const double less = wound.energy(other);
          if (!(less < energy)) continue;
          x = std::move(other);
          energy = less;
          changed = true;
        }
      }
    }
  }
  return {std::move(x), energy};
}

std::vector<double> LoopTurns::at_known_turn(std::vector<double> x) const {
  for (const Course& course : courses_) {
    for (const std::vector<double>& pose : course.poses) {
      if (distance(pose, x) > step) continue;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const bool is_length = model_.layout().is_length(static_cast<int>(i));
        if (!is_length) x[i] = turned_next_to(x[i], pose[i]);
      }
      return x;
    }
  }
  return x;
}

bool LoopTurns::reaches(const std::vector<double>& x) const {
  if (!known()) return true;
  bool met = false;
  for (const Course& course : courses_) {
    for (std::size_t k = 0; k < course.poses.size(); ++k) {
      if (distance(course.poses[k], x) > step) continue;
      met = true;
      for (int rounds = -most_rounds; rounds <= most_rounds; ++rounds) {
        if (std::isfinite(turns_.distance(x, turned(course, k, rounds)))) return true;
      }
    }
  }
  return !met;
}

std::vector<double> LoopTurns::pose(solvers::RandomStream& random) const {
  const auto one_of = [&](std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
  };
  const Course& course = courses_[one_of(courses_.size())];
  const std::size_t place = one_of(course.poses.size());
  return turned(course, place, static_cast<int>(one_of(3)) - 1);
}

std::vector<double> LoopTurns::turned(const Course& course, std::size_t pose, int rounds) const {
  std::vector<double> x = course.poses[pose];
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += rounds * course.period[i];
  return x;
}

std::vector<std::vector<double>> LoopTurns::changes_of_force() const {
  std::vector<std::vector<double>> out;
  if (!is_followed_) return out;
  for (const Course& course : courses_) {
    const int rounds = matter_ && winds(course) ? most_rounds : 0;
    std::vector<std::vector<double>> here;
    for (int round = -rounds; round <= rounds; ++round) {
      for (std::size_t k = 1; k < course.poses.size() && here.size() <= most_sign_changes; ++k) {
        std::vector<double> a = turned(course, k - 1, round), b = turned(course, k, round);
        std::vector<double> way = a;
        for (std::size_t i = 0; i < way.size(); ++i) way[i] = b[i] - a[i];
        const double before = force_along(a, way), after = force_along(b, way);
        // Where a mechanism rests everywhere rounding has any sign.
        if (before * after > 0.0 || std::max(std::abs(before), std::abs(after)) < no_force) continue;
        here.push_back(change_between(std::move(a), std::move(b), way));
      }
    }
    if (here.size() <= most_sign_changes) out.insert(out.end(), here.begin(), here.end());
  }
  return out;
}

bool LoopTurns::winds(const Course& course) {
  return std::any_of(course.period.begin(), course.period.end(), [](double p) { return p != 0; });
}

bool LoopTurns::winds() const {
  return std::any_of(courses_.begin(), courses_.end(), [](const Course& course) { return winds(course); });
}

std::vector<LoopTurns::Range> LoopTurns::ranges() const {
  std::vector<Range> out;
  for (const Course& course : courses_) {
    Range range{course.poses.front(), course.poses.front(), {}, winds(course) ? most_rounds : 0};
    for (const std::vector<double>& pose : course.poses) {
      for (std::size_t i = 0; i < pose.size(); ++i) {
        range.lower[i] = std::min(range.lower[i], pose[i]);
        range.upper[i] = std::max(range.upper[i], pose[i]);
      }
    }
    for (const double period : course.period) range.turns.push_back(static_cast<int>(std::lround(period / (2 * M_PI))));
    out.push_back(std::move(range));
  }
  return out;
}

// Finds the change by bisection, as long as the loops close between.
std::vector<double> LoopTurns::change_between(std::vector<double> a, std::vector<double> b,
                                              const std::vector<double>& way) const {
  const double before = force_along(a, way);
  for (int k = 0; k < 30; ++k) {
    std::vector<double> middle = a;
    for (std::size_t i = 0; i < middle.size(); ++i) middle[i] += 0.5 * (b[i] - a[i]);
    middle = closed(std::move(middle));
    if (middle.empty()) break;
    (before * force_along(middle, way) > 0.0 ? a : b) = std::move(middle);
  }
  return a;
}

// -Q . t, t the tangent that points like `way`.
double LoopTurns::force_along(const std::vector<double>& x, const std::vector<double>& way) const {
  const DensePoint<double> point(model_.mechanism(), x, rows_);
  return point.force.dot(vector_of(tangent(x, way)));
}

double LoopTurns::distance(const std::vector<double>& a, const std::vector<double>& b) const {
  double far = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double apart = a[i] - b[i];
    const bool is_length = model_.layout().is_length(static_cast<int>(i));
    far = std::max(far, std::abs(is_length ? apart : std::remainder(apart, 2.0 * M_PI)));
  }
  return far;
}

// Both ways from x, or once round.
LoopTurns::Course LoopTurns::follow(const std::vector<double>& x) {
  Course out{{x}, std::vector<double>(x.size(), 0.0)};
  const std::vector<double> direction = tangent(x, {});
  if (direction.empty()) {
    // Where rows that others imply along the curve of the start are independent, as those of parallel bars in crossed
    // poses, nothing moves. Where they nearly depend on each other, that is not certain.
    is_certain_ = is_certain_ && freedoms_of(model_, x) == 0;
    return out;
  }
  for (const bool forwards : {true, false}) {
    std::vector<double> at = x;
    std::vector<double> along = direction;
    if (!forwards) {
      for (double& part : along) part = -part;
      std::reverse(out.poses.begin(), out.poses.end());
    }
    bool ends = false;
    for (int k = 0; k < most_curve_steps && !ends; ++k) {
      const std::optional<Step> next = step_from(at, along);
      if (!next) break;
      at = next->to;
      along = next->along;
      out.poses.push_back(at);
      const VectorXd way = vector_of(at) - vector_of(x);
      // Another curve is farther away than a step is long.
      const bool is_round = k > 4 && distance(at, x) <= 0.6 * next->length;
      if (is_round) {
        for (std::size_t i = 0; i < x.size(); ++i) {
          const bool is_length = model_.layout().is_length(static_cast<int>(i));
          if (!is_length) out.period[i] = 2.0 * M_PI * std::round((at[i] - x[i]) / (2.0 * M_PI));
        }
        return out;
      }
      ends = way.tail(way.size() - model_.layout().angles).norm() > far_away;
    }
    is_certain_ = is_certain_ && ends;
  }
  return out;
}

// Steps are as short as the closures are near to losing rank, where curves cross or bend sharply: so none leads from
// one curve to another. Nothing where they would have to be too short.
std::optional<LoopTurns::Step> LoopTurns::step_from(const std::vector<double>& at,
                                                    const std::vector<double>& along) const {
  for (double h = step; h >= shortest_curve_step; h *= 0.5) {
    if (is_singular(at, 2.0 * h)) continue;
    std::vector<double> ahead = at;
    for (std::size_t i = 0; i < at.size(); ++i) ahead[i] += h * along[i];
    Step out{closed(ahead), {}, h};
    if (out.to.empty() || (vector_of(out.to) - vector_of(ahead)).norm() > 0.3 * h) continue;
    out.along = tangent(out.to, along);
    constexpr double least_cosine = 0.8;
    if (vector_of(out.along).dot(vector_of(along)) >= least_cosine) return out;
  }
  return std::nullopt;
}

// Whether the closures have a pivot below `pivot` of the largest.
bool LoopTurns::is_singular(const std::vector<double>& x, double pivot) const {
  const DensePoint<double> point(model_.mechanism(), x, rows_);
  return solvers::rank<double>(point.jacobian.transpose(), pivot) < model_.mechanism().coordinates() - freedoms_;
}

std::vector<double> LoopTurns::closed(std::vector<double> x) const {
  const Mechanism<double>& m = model_.mechanism();
  for (int k = 0; k < 8; ++k) {
    const DensePoint<double> point(m, x, rows_);
    const VectorXd gap = gaps_of(m, rows_, point.constraint);
    if (gap.lpNorm<Eigen::Infinity>() <= turn_closed_within) return x;
    const VectorXd change =
        solvers::minimum_norm_solution<double>(point.jacobian, gap, solvers::known_to::closed_point);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= change[static_cast<Eigen::Index>(i)];
  }
  return {};
}

// Gives the tangent of length 1, forwards as seen from `like`; empty where nothing moves and nothing is forwards.
std::vector<double> LoopTurns::tangent(const std::vector<double>& x, const std::vector<double>& like) const {
  const DensePoint<double> point(model_.mechanism(), x, rows_);
  const solvers::DenseMatrix<double> basis =
      solvers::null_space<double>(point.jacobian, solvers::known_to::closed_point);
  if (like.empty()) return basis.cols() == 0 ? std::vector<double>() : list_of(basis.col(0));
  // In a singular pose straight on.
  const VectorXd ahead = basis * (basis.transpose() * vector_of(like));
  return list_of(ahead.normalized());
}

}  // namespace poise
