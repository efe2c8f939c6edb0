#include "design/balance/shaking_balance.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "design/balance/pose_form.hpp"
#include "model/input_error.hpp"
#include "motion/kinematics.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/linear_program.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

using Eigen::Index;

constexpr int positions = 720;  // over the range of the drive

[[noreturn]] void refuse_body(const BalanceProblem& problem, int body, const std::string& why) {
  throw InputError(fmt::format("{}:{}: balance.counterweights.{}: {}", problem.file, problem.line,
                               problem.scene.bodies[body].name, why));
}

// Where the first moments are counted from.
AddedWeight placed_weight(const BalanceProblem& problem, const Counterweight& weight) {
  const Scene& scene = problem.scene;
  AddedWeight out;
  out.body = weight.body;
  if (weight.mass) {
    out.mass = *weight.mass;
    return out;
  }
  for (const Joint& joint : scene.joints) {
    if (joint.kind != Joint::Kind::pin) continue;
    for (const auto& [ground, own] : {std::pair{joint.a, joint.b}, {joint.b, joint.a}}) {
      if (ground.body != 0 || own.body != weight.body) continue;
      out.about = scene.local(own);
      out.point = scene.name_of(own);
      return out;
    }
  }
  refuse_body(problem, weight.body,
              "expected a body with a pin to the ground, about which the radius is; give {mass = M}");
}

// The total first moment, kg m, with the masses that are given in place.
PhasorTerms total_moment(const PoseForm& form, const std::vector<AddedWeight>& weights) {
  const Scene& scene = form.scene();
  PhasorTerms out;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.mass != 0.0) out = sum(std::move(out), form.place(static_cast<int>(b), body.center), body.mass);
  }
  for (const AddedWeight& weight : weights) {
    if (weight.mass != 0.0) out = sum(std::move(out), form.place(weight.body, weight.about), weight.mass);
  }
  return out;
}

// The size of what the total is a sum of, and of which 1e-12 is rounding, kg m.
double size_of_moments(const PoseForm& form, const std::vector<AddedWeight>& weights) {
  double out = 0.0;
  const auto add = [&](int body, const Vec2& at, double mass) {
    for (const auto& [phasor, c] : form.place(body, at)) {
      if (!(phasor == Phasor{})) out = std::max(out, mass * norm(c) * (phasor.length >= 0 ? form.size() : 1.0));
    }
  };
  const Scene& scene = form.scene();
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    add(static_cast<int>(b), scene.bodies[b].center, scene.bodies[b].mass);
  }
  for (const AddedWeight& weight : weights) add(weight.body, weight.about, weight.mass);
  return out;
}

// What a first moment [1, 0] in the frame of a body adds: a phasor and its coefficient.
std::pair<Phasor, Vec2> carried(const PoseForm& form, int body) {
  PhasorTerms along = sum(form.place(body, {1.0, 0.0}), form.place(body, {}), -1.0);
  const AngleForm angle = form.angle(body);
  const Phasor phasor{-1, angle.coordinate};
  return {phasor, along[phasor]};
}

// Phasors as the coefficients of vectors; closures express some of them by others.
class MomentSpace {
 public:
  MomentSpace(const PoseForm& form, const PhasorTerms& total, const std::vector<AddedWeight>& weights) : form_(form) {
    std::map<Phasor, bool> seen;  // whether a counterweight turns with it
    for (const auto& [phasor, c] : total) seen[phasor] = false;
    for (const PhasorTerms& closure : form.closures()) {
      for (const auto& [phasor, c] : closure) seen[phasor] = false;
    }
    for (const AddedWeight& weight : weights) seen[carried(form, weight.body).first] = true;
    seen.erase(Phasor{});
    for (const auto& [phasor, carries] : seen) {
      place_[phasor] = static_cast<Index>(all_.size());
      all_.push_back(phasor);
      carries_.push_back(carries ? 1 : 0);
    }
    eliminate();
  }

  const std::vector<Phasor>& kept() const { return kept_; }
  Eigen::VectorXcd vector(const PhasorTerms& terms) const {
    Eigen::VectorXcd all = in_all(terms);
    for (std::size_t r = 0; r < pivots_.size(); ++r) {
      all -= (all[pivots_[r]] * rows_.row(static_cast<Index>(r)).transpose()).eval();
    }
    Eigen::VectorXcd out(static_cast<Index>(kept_.size()));
    for (std::size_t k = 0; k < kept_.size(); ++k) out[static_cast<Index>(k)] = all[place_.at(kept_[k])];
    return out;
  }

  // Whether those that are kept, and the constant, are independent on random poses.
  bool found_independent() const {
    constexpr double independent = 1e-8;
    if (form_.closures().empty()) return true;
    const std::size_t wanted = 2 * kept_.size() + 6;
    std::vector<Eigen::VectorXcd> rows;
    for (std::uint64_t k = 0; rows.size() < wanted && k < 12 * wanted; ++k) {
      const std::vector<double> q = random_pose(form_, k);
      if (q.empty()) continue;
      Eigen::VectorXcd row(static_cast<Index>(kept_.size() + 1));
      row[0] = 1.0;
      for (std::size_t c = 0; c < kept_.size(); ++c) {
        const Vec2 value = PoseForm::value({{kept_[c], {1.0, 0.0}}}, q);
        const double size = kept_[c].length >= 0 ? form_.size() : 1.0;
        row[static_cast<Index>(c + 1)] = std::complex<double>(value.x, value.y) / size;
      }
      rows.push_back(std::move(row));
    }
    if (rows.size() < wanted) return false;
    const auto m = static_cast<Index>(rows.size()), n = rows.front().size();
    Eigen::MatrixXd real(2 * m, 2 * n);
    for (Index r = 0; r < m; ++r) {
      for (Index c = 0; c < n; ++c) {
        const std::complex<double> z = rows[static_cast<std::size_t>(r)][c];
        real.block<2, 2>(2 * r, 2 * c) << z.real(), -z.imag(), z.imag(), z.real();
      }
    }
    const Eigen::VectorXd values = solvers::singular_values(real);
    return values[values.size() - 1] > independent * values[0];
  }

  static std::vector<double> random_pose(const PoseForm& form, std::uint64_t index) {
    solvers::RandomStream random(29, 0, index);
    std::vector<double> q = form.start();
    for (const int t : form.coordinates()) {
      q[t] += form.is_length(t) ? form.size() * random.uniform(-0.5, 0.5)
                                : random.uniform(-std::numbers::pi, std::numbers::pi);
    }
    return form.closed(std::move(q));
  }

 private:
  Eigen::VectorXcd in_all(const PhasorTerms& terms) const {
    Eigen::VectorXcd out = Eigen::VectorXcd::Zero(static_cast<Index>(all_.size()));
    for (const auto& [phasor, c] : terms) {
      if (!(phasor == Phasor{})) out[place_.at(phasor)] = {c.x, c.y};
    }
    return out;
  }
  void eliminate() {
    constexpr double least_pivot = 1e-11, rather = 8.0;
    const auto columns = static_cast<Index>(all_.size());
    rows_.resize(static_cast<Index>(form_.closures().size()), columns);
    for (Index r = 0; r < rows_.rows(); ++r) {
      rows_.row(r) = in_all(form_.closures()[static_cast<std::size_t>(r)]).transpose() / form_.size();
    }
    Index done = 0;
    for (; done < rows_.rows(); ++done) {
      // Rather phasors with which no counterweight turns, so that the equations are those of the counterweights.
      Index row = 0, column = 0;
      double largest = 0.0;
      for (Index i = done; i < rows_.rows(); ++i) {
        for (Index j = 0; j < columns; ++j) {
          const double size = (carries_[static_cast<std::size_t>(j)] != 0 ? 1.0 : rather) * std::abs(rows_(i, j));
          if (size <= largest) continue;
          largest = size;
          row = i;
          column = j;
        }
      }
      if (largest <= least_pivot) break;
      rows_.row(row).swap(rows_.row(done));
      rows_.row(done) /= rows_(done, column);
      for (Index i = 0; i < rows_.rows(); ++i) {
        if (i != done) rows_.row(i) -= (rows_(i, column) * rows_.row(done)).eval();
      }
      pivots_.push_back(column);
    }
    rows_.conservativeResize(done, columns);
    for (Index j = 0; j < columns; ++j) {
      if (std::find(pivots_.begin(), pivots_.end(), j) == pivots_.end())
        kept_.push_back(all_[static_cast<std::size_t>(j)]);
    }
  }

  const PoseForm& form_;
  std::map<Phasor, Index> place_;
  std::vector<Phasor> all_, kept_;
  std::vector<char> carries_;
  Eigen::MatrixXcd rows_;
  std::vector<Index> pivots_;
};

// Puts the first moments found into the weights, and these into the bodies of the scene.
void put_into_scene(const BalanceProblem& problem, const std::vector<Vec2>& moments, ShakingBalance& out) {
  out.scene = problem.scene;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    AddedWeight& weight = out.weights[k];
    weight.first_moment = moments[k];
    const double size = norm(moments[k]);
    const Counterweight& asked = problem.counterweights[k];
    if (asked.radius) weight.mass = size / *asked.radius;
    weight.place = weight.about;
    if (weight.mass > 0.0) weight.place += (1 / weight.mass) * moments[k];
    Body& body = out.scene.bodies[weight.body];
    const double mass = body.mass + weight.mass;
    if (mass == 0.0) continue;
    const Vec2 center = (1 / mass) * (body.mass * body.center + weight.mass * weight.place);
    const Vec2 from_body = body.center - center, from_weight = weight.place - center;
    body.inertia += body.mass * dot(from_body, from_body) + weight.mass * dot(from_weight, from_weight);
    body.mass = mass;
    body.center = center;
  }
}

// Largest shift of the total first moment of a scene between random poses.
double largest_shift(const Scene& scene) {
  constexpr int poses = 60;
  const PoseForm form(scene);
  const PhasorTerms total = total_moment(form, {});
  const Vec2 first = PoseForm::value(total, form.start());
  double out = 0.0;
  for (std::uint64_t k = 0; k < poses; ++k) {
    const std::vector<double> q = MomentSpace::random_pose(form, k);
    if (!q.empty()) out = std::max(out, norm(PoseForm::value(total, q) - first));
  }
  return out;
}

KinematicsResult driven(const BalanceProblem& problem, const Scene& scene) {
  SweepOptions options;
  options.steps = positions;
  options.rate = problem.rate;
  return sweep(scene, {{problem.drive, problem.range_from, problem.range_to}}, options);
}

Vec2 force_at(const Scene& scene, const KinematicSample& at) {
  Vec2 out{};
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    out -= body.mass * at.bodies[b].acceleration_of(body.center);
  }
  return out;
}

double moment_at(const Scene& scene, const KinematicSample& at) {
  double out = 0.0;
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    const BodyMotion& motion = at.bodies[b];
    const Vec2 place = motion.pose.origin + body.center * unit(motion.pose.angle);
    out -= cross(place, body.mass * motion.acceleration_of(body.center)) + body.inertia * motion.angular_acceleration;
  }
  return out;
}

// Rows of numbers at evenly spaced places, and between them by the polynomial through the six nearest.
class Interpolated {
 public:
  explicit Interpolated(Eigen::MatrixXd rows) : rows_(std::move(rows)) {}
  Index size() const { return rows_.rows(); }
  Eigen::VectorXd at(double place) const {
    constexpr int points = 6;
    if (size() < points) return rows_.row(static_cast<Index>(std::lround(place))).transpose();
    const auto first = std::clamp<Index>(static_cast<Index>(std::floor(place)) - 2, 0, size() - points);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rows_.cols());
    for (int i = 0; i < points; ++i) {
      double weight = 1.0;
      for (int j = 0; j < points; ++j) {
        if (j != i) weight *= (place - static_cast<double>(first + j)) / (i - j);
      }
      out += weight * rows_.row(first + i).transpose();
    }
    return out;
  }

 private:
  Eigen::MatrixXd rows_;
};

// The place near a sample where f is largest, by golden sections.
template <class F>
double peak_near(double sample, double last, F f) {
  constexpr double section = 0.6180339887498949;
  double a = std::max(0.0, sample - 1), b = std::min(last, sample + 1);
  for (int k = 0; k < 60; ++k) {
    const double left = b - section * (b - a), right = a + section * (b - a);
    (f(left) > f(right) ? b : a) = f(left) > f(right) ? right : left;
  }
  return 0.5 * (a + b);
}

// The places of the largest values of f among all samples: those that no neighbour exceeds and that are near the
// largest.
template <class F>
std::vector<double> peaks(Index samples, F f, double near_largest) {
  std::vector<double> values;
  for (Index i = 0; i < samples; ++i) values.push_back(f(static_cast<double>(i)));
  const double largest = *std::max_element(values.begin(), values.end());
  std::vector<double> out;
  for (Index i = 0; i < samples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const bool is_peak = (i == 0 || values[at] >= values[at - 1]) && (i + 1 == samples || values[at] >= values[at + 1]);
    if (!is_peak || values[at] < near_largest * largest) continue;
    out.push_back(peak_near(static_cast<double>(i), static_cast<double>(samples - 1), f));
  }
  return out;
}

// The force over the range, linear in the first moments: F = F0 + A u, at each sample F0 and then the columns of A.
Interpolated forces_over(const BalanceProblem& problem, const KinematicsResult& motion,
                         const std::vector<AddedWeight>& weights) {
  const auto n = static_cast<Index>(2 * weights.size());
  Eigen::MatrixXd rows(static_cast<Index>(motion.samples.size()), 2 + 2 * n);
  for (std::size_t s = 0; s < motion.samples.size(); ++s) {
    const KinematicSample& at = motion.samples[s];
    const auto row = static_cast<Index>(s);
    Vec2 given = force_at(problem.scene, at);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const AddedWeight& weight = weights[k];
      const BodyMotion& body = at.bodies[weight.body];
      given -= weight.mass * body.acceleration_of(weight.about);
      const Vec2 turning{-body.rate * body.rate, body.angular_acceleration};
      const Vec2 by_x = -1.0 * (turning * unit(body.pose.angle));
      const Vec2 by_y = quarter_turn(by_x);
      const auto column = static_cast<Index>(2 + 4 * k);
      rows(row, column) = by_x.x;
      rows(row, column + 1) = by_x.y;
      rows(row, column + 2) = by_y.x;
      rows(row, column + 3) = by_y.y;
    }
    rows(row, 0) = given.x;
    rows(row, 1) = given.y;
  }
  return Interpolated(std::move(rows));
}

Vec2 force_of(const Eigen::VectorXd& row, const Eigen::VectorXd& u) {
  Vec2 out{row[0], row[1]};
  for (Index j = 0; j < u.size(); ++j) out += u[j] * Vec2{row[2 + 2 * j], row[3 + 2 * j]};
  return out;
}

// First moments for which the largest force is least.
struct LeastForce {
  Eigen::VectorXd u;
  double lower = 0.0, upper = 0.0;
};

LeastForce least_force(const Interpolated& forces, Eigen::VectorXd u, const std::atomic<bool>* interrupt) {
  constexpr int most_rounds = 200;
  constexpr double enough = 1e-10, near_largest = 0.5;
  const Index n = u.size();
  LeastForce out{u, 0.0, std::numeric_limits<double>::infinity()};
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> bounds;
  const auto add_cut = [&](const Eigen::VectorXd& at, const Vec2& along) {
    Eigen::VectorXd row(n + 1);
    for (Index j = 0; j < n; ++j) row[j] = dot(along, {at[2 + 2 * j], at[3 + 2 * j]});
    row[n] = -1.0;
    rows.push_back(row);
    bounds.push_back(-dot(along, {at[0], at[1]}));
  };
  // In four directions at some places, so that the program is bounded from the first.
  for (Index i = 0; i < forces.size(); i += std::max<Index>(1, forces.size() / 12)) {
    const Eigen::VectorXd at = forces.at(static_cast<double>(i));
    for (const Vec2& along : {Vec2{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) add_cut(at, along);
  }
  for (int round = 0; round < most_rounds; ++round) {
    if (interrupt != nullptr && *interrupt) break;
    const auto size = [&](double place) { return norm(force_of(forces.at(place), u)); };
    double largest = 0.0;
    for (const double place : peaks(forces.size(), size, near_largest)) {
      const Eigen::VectorXd at = forces.at(place);
      const Vec2 force = force_of(at, u);
      const double here = norm(force);
      largest = std::max(largest, here);
      if (here > 0.0) add_cut(at, (1 / here) * force);
    }
    if (largest < out.upper) {
      out.upper = largest;
      out.u = u;
    }
    if (out.upper - out.lower <= enough * out.upper) break;
    solvers::LinearProgram program;
    program.rows.resize(static_cast<Index>(rows.size()), n + 1);
    program.bounds.resize(static_cast<Index>(rows.size()));
    program.objective = Eigen::VectorXd::Zero(n + 1);
    program.objective[n] = -1.0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      program.rows.row(static_cast<Index>(r)) = rows[r].transpose();
      program.bounds[static_cast<Index>(r)] = bounds[r];
    }
    const solvers::LinearProgramResult best = solvers::solve(program);
    if (best.status != solvers::LinearProgramResult::Status::optimal) break;
    out.lower = std::max(out.lower, best.x[n]);
    u = best.x.head(n);
  }
  return out;
}

std::vector<Vec2> as_vectors(const Eigen::VectorXd& u) {
  std::vector<Vec2> out;
  for (Index j = 0; j + 1 < u.size(); j += 2) out.push_back({u[j], u[j + 1]});
  return out;
}

// The first moments that leave least of the terms, and what is left.
Eigen::VectorXd least_terms(const PoseForm& form, const MomentSpace& space, const PhasorTerms& total,
                            const BalanceProblem& problem, ShakingBalance& out) {
  const Eigen::VectorXcd before = space.vector(total);
  const auto rows = before.size();
  const auto unknowns = static_cast<Index>(out.weights.size());
  Eigen::MatrixXd a(2 * rows, 2 * unknowns);
  Eigen::VectorXd b(2 * rows);
  for (Index r = 0; r < rows; ++r) {
    b[2 * r] = -before[r].real();
    b[2 * r + 1] = -before[r].imag();
  }
  for (Index k = 0; k < unknowns; ++k) {
    const int body = out.weights[static_cast<std::size_t>(k)].body;
    const auto [phasor, coefficient] = carried(form, body);
    if (phasor.angle < 0)
      refuse_body(problem, body, "does not turn, so that a counterweight changes nothing; leave it out");
    const Eigen::VectorXcd by = space.vector({{phasor, coefficient}});
    for (Index r = 0; r < rows; ++r) {
      a.block<2, 2>(2 * r, 2 * k) << by[r].real(), -by[r].imag(), by[r].imag(), by[r].real();
    }
  }
  Eigen::VectorXd u = solvers::minimum_norm_solution<double>(a, b, 1e-11);
  const Eigen::VectorXd left = a * u - b;
  const double size = std::max(size_of_moments(form, out.weights), 1e-300);
  out.residual = b.size() > 0 ? left.cwiseAbs().maxCoeff() / size : 0.0;
  for (Index r = 0; r < rows; ++r) {
    const Phasor& phasor = space.kept()[static_cast<std::size_t>(r)];
    const std::string name =
        phasor.length >= 0 ? "travel of " + form.name(phasor.length) : "direction of " + form.name(phasor.angle);
    const Vec2 after{left[2 * r], left[2 * r + 1]};
    out.terms.push_back({name, {before[r].real(), before[r].imag()}, after, norm(after) > 1e-12 * size});
  }
  return u;
}

}  // namespace

Shaking shaking_of(const BalanceProblem& problem, const Scene& scene, std::string& why) {
  const KinematicsResult motion = driven(problem, scene);
  why = motion.complete ? "" : motion.why;
  Eigen::MatrixXd rows(static_cast<Index>(motion.samples.size()), 4);
  for (std::size_t s = 0; s < motion.samples.size(); ++s) {
    const Vec2 force = force_at(scene, motion.samples[s]);
    rows.row(static_cast<Index>(s)) << force.x, force.y, moment_at(scene, motion.samples[s]),
        motion.samples[s].drive[0];
  }
  const Interpolated over(rows);
  Shaking out;
  const auto find = [&](auto size, double& largest, double& at) {
    for (const double place : peaks(over.size(), size, 0.9)) {
      if (size(place) < largest) continue;
      largest = size(place);
      at = over.at(place)[3];
    }
  };
  find([&](double place) { return norm(Vec2{over.at(place)[0], over.at(place)[1]}); }, out.force, out.at_force);
  find([&](double place) { return std::abs(over.at(place)[2]); }, out.moment, out.at_moment);
  return out;
}

ShakingBalance balance_shaking(const BalanceProblem& problem, const std::atomic<bool>* interrupt) {
  constexpr double exact = 1e-12;
  ShakingBalance out;
  for (const Counterweight& weight : problem.counterweights) out.weights.push_back(placed_weight(problem, weight));
  const PoseForm form(problem.scene);
  const PhasorTerms total = total_moment(form, out.weights);
  const MomentSpace space(form, total, out.weights);
  if (form.coordinates().empty())
    throw InputError(problem.scene.file + ": expected bodies that can move; all are held");
  out.closures = static_cast<int>(form.closures().size());
  out.complete = space.found_independent();
  const Eigen::VectorXd u = least_terms(form, space, total, problem, out);
  out.moved_before = largest_shift(problem.scene);
  put_into_scene(problem, as_vectors(u), out);
  out.moved = largest_shift(out.scene);
  out.balanced =
      out.residual <= exact && out.moved <= 1e-9 * std::max(out.moved_before, size_of_moments(form, out.weights));
  if (problem.drive.empty()) return out;
  out.before = shaking_of(problem, problem.scene, out.why);
  out.whole_range = out.why.empty();
  if (!out.balanced) {
    const LeastForce least =
        least_force(forces_over(problem, driven(problem, problem.scene), out.weights), u, interrupt);
    out.lower = least.lower;
    out.is_least = std::isfinite(least.upper);
    put_into_scene(problem, as_vectors(least.u), out);
    out.moved = largest_shift(out.scene);
    const Eigen::VectorXcd left = space.vector(total_moment(PoseForm(out.scene), {}));
    for (std::size_t k = 0; k < out.terms.size(); ++k) {
      out.terms[k].after = {left[static_cast<Index>(k)].real(), left[static_cast<Index>(k)].imag()};
    }
  }
  out.after = shaking_of(problem, out.scene, out.why);
  return out;
}

}  // namespace poise
