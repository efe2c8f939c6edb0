#include "statics/sensitivity/tolerance.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"
#include "statics/many/scene_in_lanes.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

using Placed = NumberedEquations::Placed<double>;

constexpr int most_sampled_unknowns = 400;
constexpr double chord_contraction = 0.3;
constexpr double converged_sample = 1e-11;  // rad, mechanism sizes, parts of its force
constexpr double decided_within = 1e-6;     // the same; an equilibrium that rounding moves further is not decided
constexpr int most_chords = 20;
constexpr double farthest_normal = 6.0;         // standard deviations; beyond, a number is drawn again
constexpr std::size_t chunk = 2000;             // samples computed by a thread at a time
constexpr std::size_t followed_besides = 1000;  // one in so many
constexpr std::size_t fewest_in_lanes = 2000;   // samples, for which compiling pays
constexpr std::size_t bins = 40;

/// An equilibrium: the unknowns of equations in which the stops act that act there.
struct State {
  std::shared_ptr<const NumberedEquations> equations;
  std::vector<double> z;
};

/// Largest change of the unknowns.
double size_of(const Eigen::VectorXd& dz) { return dz.size() > 0 ? dz.cwiseAbs().maxCoeff() : 0.0; }

/// Bounds how far a relative error of a unit roundoff in every number and every unknown moves the solution of R = 0:
/// |A^-1| (|A| |z| + |dR/dp| |p|) eps with A = dR/dz; four times that, since terms of R take several operations.
/// Newton's method comes no closer.
double rounding_of(const ResidualDerivatives& at, const Eigen::MatrixXd& inverse, const std::vector<double>& numbers,
                   const std::vector<double>& z) {
  const auto sizes = [](const std::vector<double>& of) {
    Eigen::VectorXd out(static_cast<Eigen::Index>(of.size()));
    for (std::size_t i = 0; i < of.size(); ++i) {
      out[static_cast<Eigen::Index>(i)] =
          std::isfinite(of[i]) ? std::abs(of[i]) : 0.0;  // a stop may have one limit only
    }
    return out;
  };
  const Eigen::VectorXd terms = at.by_unknowns.cwiseAbs() * sizes(z) + at.by_numbers.cwiseAbs() * sizes(numbers);
  return 4 * std::numeric_limits<double>::epsilon() * size_of(inverse.cwiseAbs() * terms);
}

/// The force with which an acting stop pushes, and by how much a stop is overrun: >= 0 and <= 0 where it is kept.
class Stops {
 public:
  Stops(const NumberedEquations& equations, const std::vector<double>& numbers, const std::vector<double>& z)
      : equations_(equations), numbers_(numbers), z_(z) {
    equations.place(z.data(), placed_);
  }

  bool acts(int stop) const {
    return std::any_of(equations_.acting().begin(), equations_.acting().end(),
                       [&](const ActingStop& acting) { return acting.stop == stop; });
  }
  double push(int acting) const {
    const ActingStop& stop = equations_.acting()[acting];
    const Stop& of = equations_.scene().stops[stop.stop];
    if (of.min == of.max) return 1.0;  // either way
    const double effort = z_[equations_.multiplier_of_stop(acting)];
    return stop.upper ? -effort : effort;
  }
  /// The side on which a free stop is overrun, and by how much.
  std::pair<bool, double> overrun(int stop) const {
    const NumberedEquations::Bodies<double> bodies = equations_.bodies(numbers_.data(), placed_);
    const double below = -bodies.overrun(stop, false);
    const double above = bodies.overrun(stop, true);
    return {above > below, std::max(above, below)};
  }
  bool all_kept() const {
    for (int h = 0; h < static_cast<int>(equations_.acting().size()); ++h) {
      if (!(push(h) > 0.0)) return false;
    }
    for (int s = 0; s < static_cast<int>(equations_.scene().stops.size()); ++s) {
      if (!acts(s) && !(overrun(s).second <= 0.0)) return false;
    }
    return true;
  }

 private:
  const NumberedEquations& equations_;
  const std::vector<double>& numbers_;
  const std::vector<double>& z_;
  std::vector<Placed> placed_;
};

/// What becomes of an equilibrium as numbers move: rounding may leave open whether it continues.
enum class Course { continues, lost, undecided };

/// Stable equilibria along a straight line of numbers.
class Continuation {
 public:
  Continuation(const Scene& scene, State start, int sign) : scene_(scene), state_(std::move(start)), sign_(sign) {}

  /// From the numbers `from` to `to`.
  Course follow(const std::vector<double>& from, const std::vector<double>& to) {
    constexpr double least_step = 1.0 / 4096;
    double part = 0.0, step = 0.25;
    std::vector<double> numbers = from;
    const auto move = [&](double at) {
      for (std::size_t i = 0; i < from.size(); ++i) {
        if (from[i] != to[i]) numbers[i] = from[i] + at * (to[i] - from[i]);
      }
    };
    while (part < 1.0) {
      const double next = std::min(1.0, part + step);
      move(next);
      // Events are met in small steps, so that what comes on or off first does so.
      State trial = state_;
      constexpr double event_step = 1.0 / 64;
      const bool found = correct(trial, numbers);
      const bool kept = found && Stops(*trial.equations, numbers, trial.z).all_kept();
      if (kept || (found && step <= event_step && change_stops(trial, numbers))) {
        state_ = std::move(trial);
        part = next;
        step = std::min(0.25, 1.5 * step);
        continue;
      }
      step *= 0.5;
      if (step >= least_step) continue;
      // Beyond what ends the equilibrium anything may be singular; what is known is known of its last place.
      move(part);
      return rounding_at(state_, numbers) < decided_within ? Course::lost : Course::undecided;
    }
    return Course::continues;
  }

  const State& state() const { return state_; }

 private:
  // Newton's method: each step a fraction of the one before, not far, and on the stable side.
  // Where the steps end in what rounding moves, that is an answer if it is small.
  bool correct(State& state, const std::vector<double>& numbers) {
    constexpr int most_steps = 8;
    constexpr double farthest = 0.05;
    const int poses = state.equations->poses();
    double before = std::numeric_limits<double>::infinity(), moved = 0.0;
    for (int k = 0; k < most_steps; ++k) {
      const ResidualDerivatives at = differentiate(*state.equations, numbers, state.z, false);
      const solvers::FullyPivotedLu factors(at.by_unknowns);
      if (factors.determinant_sign() != sign_) return false;
      const Eigen::VectorXd dz = factors.solve(Eigen::VectorXd(-at.residual));
      if (!dz.allFinite()) return false;
      for (Eigen::Index i = 0; i < dz.size(); ++i) state.z[i] += dz[i];
      moved += size_of(dz.head(poses));
      const double size = size_of(dz);
      if (!(moved < farthest)) return false;
      if (size < converged_sample) return true;
      if (k > 1 && !(size < 0.5 * before)) return is_rounding(size, state, numbers);
      before = size;
    }
    return is_rounding(before, state, numbers);
  }

  // Whether a step is one that rounding makes, of a solution that is known nevertheless.
  static bool is_rounding(double size, const State& state, const std::vector<double>& numbers) {
    const double rounding = rounding_at(state, numbers);
    return !(size > rounding) && rounding < decided_within;
  }

  // How far rounding moves the solution.
  static double rounding_at(const State& state, const std::vector<double>& numbers) {
    const ResidualDerivatives at = differentiate(*state.equations, numbers, state.z, true);
    const solvers::FullyPivotedLu factors(at.by_unknowns);
    const Eigen::Index n = at.by_unknowns.rows();
    return rounding_of(at, factors.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))), numbers, state.z);
  }

  // Lets go of stops that pull and holds those that are overrun.
  bool change_stops(State& state, const std::vector<double>& numbers) {
    constexpr int most_changes = 4;
    for (int k = 0; k < most_changes; ++k) {
      const Stops stops(*state.equations, numbers, state.z);
      std::vector<ActingStop> acting;
      for (int h = 0; h < static_cast<int>(state.equations->acting().size()); ++h) {
        if (stops.push(h) > 0.0) acting.push_back(state.equations->acting()[h]);
      }
      for (int s = 0; s < static_cast<int>(scene_.stops.size()); ++s) {
        const auto [upper, by] = stops.overrun(s);
        if (!stops.acts(s) && by > 0.0) acting.push_back({s, upper});
      }
      auto changed = std::make_shared<NumberedEquations>(state.equations->list(), acting);
      std::vector<double> z(changed->unknowns(), 0.0);
      const int shared = changed->unknowns() - static_cast<int>(acting.size());
      std::copy(state.z.begin(), state.z.begin() + shared, z.begin());
      for (std::size_t h = 0; h < acting.size(); ++h) {
        for (std::size_t o = 0; o < state.equations->acting().size(); ++o) {
          if (state.equations->acting()[o].stop != acting[h].stop) continue;
          z[changed->multiplier_of_stop(static_cast<int>(h))] =
              state.z[state.equations->multiplier_of_stop(static_cast<int>(o))];
        }
      }
      changed->count_turns(z.data());
      state = {std::move(changed), std::move(z)};
      if (!correct(state, numbers)) return false;
      if (Stops(*state.equations, numbers, state.z).all_kept()) return true;
    }
    return false;
  }

  const Scene& scene_;
  State state_;
  int sign_;
};

/// What every sample shares.
class Sampler {
 public:
  Sampler(const StaticModel& model, const std::vector<Tolerance>& tolerances, std::vector<SoughtQuantity> of,
          const LinearResponse& response, const ToleranceOptions& options)
      : model_(model),
        tolerances_(tolerances),
        of_(std::move(of)),
        options_(options),
        scene_(response.equations().scene()),
        nominal_{std::make_shared<NumberedEquations>(response.equations()), response.z()} {
    const solvers::FullyPivotedLu factors(response.by_unknowns());
    regular_ = factors.reciprocal_condition() > 1e-12;
    sign_ = factors.determinant_sign();
    const Eigen::Index n = response.equations().unknowns();
    if (regular_) inverse_ = factors.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
    for (const Tolerance& tolerance : tolerances) {
      for (std::size_t k = 0; k < equations().rows().size(); ++k) {
        if (equations().rows()[k].path.is(tolerance.number)) rows_.push_back(static_cast<int>(k));
      }
      per_.push_back(tolerance.dimension.per_scale(model.scales()));
      const std::vector<int>& leaders = equations().list()->leaders();
      leaders_vary_ = leaders_vary_ || std::find(leaders.begin(), leaders.end(), rows_.back()) != leaders.end();
    }
    find_axes();
    if (!regular_) return;
    moves_.resize(n, static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t t = 0; t < rows_.size(); ++t) {
      moves_.col(static_cast<Eigen::Index>(t)) = -inverse_ * response.by_numbers().col(rows_[t]);
    }
    const ResidualDerivatives at{{}, response.by_unknowns(), response.by_numbers()};
    rounding_ = rounding_of(at, inverse_, equations().numbers(), response.z());
    one_way_ = slack_of(equations().numbers(), response.z());
    if (options.samples >= fewest_in_lanes) compile_for_lanes();
  }

  bool is_regular() const { return regular_; }
  const std::vector<SoughtQuantity>& of() const { return of_; }
  const NumberedEquations& equations() const { return *nominal_.equations; }
  std::size_t tolerances() const { return rows_.size(); }
  /// A number of the scaled scene, and its half width.
  int row(std::size_t t) const { return rows_[t]; }
  double half_width(std::size_t t) const { return tolerances_[t].half_width * per_[t]; }

  enum class Fate { taken, continued, snapped, nowhere, undecided };
  /// How a sample ends; its values, SI, one per quantity, are not a number where it has none.
  struct Sample {
    Fate fate = Fate::nowhere;
    bool rechecked = false, disagreed = false;
    bool ended = true;  ///< no interrupt came while it settled
  };

  bool interrupted() const { return options_.solve.interrupt != nullptr && *options_.solve.interrupt; }

  /// Buffers of a thread.
  struct Work {
    std::unique_ptr<SceneInLanes::Work> lanes;
    std::vector<std::vector<double>> columns;  // of each tolerated number those of the samples of a chunk
    std::vector<double> q;
    std::vector<double> numbers, z, r;
    std::vector<Placed> placed;
    Eigen::VectorXd by, dz, residual;
  };
  Work work() const {
    Work out;
    out.numbers = equations().numbers();
    out.z.resize(equations().unknowns());
    out.r.resize(out.z.size());
    out.by.resize(static_cast<Eigen::Index>(rows_.size()));
    out.dz.resize(static_cast<Eigen::Index>(out.z.size()));
    out.residual.resize(static_cast<Eigen::Index>(out.z.size()));
    if (!lanes_) return out;
    out.lanes = lanes_->work(simd_);
    out.columns.resize(rows_.size());
    for (std::vector<double>& column : out.columns) column.resize(chunk);
    out.q.resize(SceneInLanes::block(simd_) * static_cast<std::size_t>(lanes_model_->mechanism().coordinates()));
    return out;
  }

  /// Computes samples first .. first + count - 1 together and marks those that are taken so. Those are left out that
  /// are followed besides, which are taken one by one.
  void sample_in_lanes(std::size_t first, std::size_t count, Work& work, double* values, char* taken) const {
    if (!lanes_) return;
    std::vector<const double*> numbers;
    for (std::size_t k = 0; k < count; ++k) {
      draw(first + k, work);
      for (std::size_t t = 0; t < rows_.size(); ++t) {
        work.columns[t][k] = equations().numbers()[rows_[t]] + work.by[static_cast<Eigen::Index>(t)];
      }
    }
    for (const std::vector<double>& column : work.columns) numbers.push_back(column.data());
    const std::vector<std::size_t> strides(rows_.size(), 1);
    const std::size_t block = SceneInLanes::block(simd_);
    std::vector<SceneInLanes::Lane> lanes(block);
    for (std::size_t at = 0; at < count; at += block) {
      const std::size_t some = std::min(block, count - at);
      lanes_->solve(numbers, strides, at, some, *work.lanes, work.q.data(), values + at * of_.size(), lanes.data());
      for (std::size_t l = 0; l < some; ++l) {
        const bool is_solved = lanes[l] == SceneInLanes::Lane::with_values && (first + at + l) % followed_besides != 0;
        taken[at + l] = is_solved ? 1 : 0;
      }
    }
  }

  /// Draws the numbers of sample k into work.by, scaled.
  void draw(std::size_t k, Work& work) const {
    solvers::RandomStream random(options_.seed, 0, k);
    const auto normal = [&] {
      double out = random.normal();
      while (std::abs(out) > farthest_normal) out = random.normal();
      return out;
    };
    for (std::size_t t = 0; t < own(); ++t) {
      const Tolerance& of = tolerances_[t];
      double& by = work.by[static_cast<Eigen::Index>(t)];
      by = of.distribution == Tolerance::Distribution::uniform ? (2 * random.uniform() - 1) * half_width(t)
                                                               : of.sigma * per_[t] * normal();
    }
    if (options_.fitted == nullptr) return;
    const Eigen::Index fitted = inwards_.rows();
    work.by.tail(fitted).setZero();
    for (Eigen::Index a = 0; a < fitted; ++a)
      work.by.tail(fitted) += normal() * axes_.col(axes_.cols() - fitted + a).tail(fitted);
    for (Eigen::Index a = 0; a < inwards_.cols(); ++a) work.by.tail(fitted) += std::abs(normal()) * inwards_.col(a);
  }

  /// These are the changes of the numbers, one standard deviation along each of their independent axes, scaled: each
  /// tolerance has an axis of its own, fitted numbers have those of their covariance.
  const Eigen::MatrixXd& axes() const { return axes_; }
  /// The tolerances alone, which are the first axes.
  std::size_t own() const {
    return options_.fitted == nullptr ? rows_.size() : rows_.size() - options_.fitted->numbers.size();
  }

  Sample sample(std::size_t k, Work& work, double* values) const {
    draw(k, work);
    Sample out;
    if (!set_numbers(work)) return out;  // an expression has no value
    if (chord(work)) {
      out.fate = Fate::taken;
      read(*nominal_.equations, work.numbers, work.z, values);
      if (k % followed_besides == 0) {
        out.rechecked = true;
        Continuation continuation(scene_, nominal_, sign_);
        out.disagreed = continuation.follow(equations().numbers(), work.numbers) != Course::continues ||
                        !is_same(continuation.state(), work.z);
      }
      return out;
    }
    Continuation continuation(scene_, nominal_, sign_);
    const Course course = continuation.follow(equations().numbers(), work.numbers);
    if (course == Course::undecided) {
      out.fate = Fate::undecided;
      return out;
    }
    if (course == Course::continues) {
      out.fate = Fate::continued;
      read(*continuation.state().equations, work.numbers, continuation.state().z, values);
      return out;
    }
    out.fate = settle(work, values) ? Fate::snapped : Fate::nowhere;
    out.ended = !interrupted();
    return out;
  }

  /// Values at numbers that differ by work.by, scaled units; false where the equilibrium does not continue to there.
  bool continued(Work& work, double* values) const {
    if (!set_numbers(work)) return false;
    if (chord(work)) {
      read(*nominal_.equations, work.numbers, work.z, values);
      return true;
    }
    Continuation continuation(scene_, nominal_, sign_);
    if (continuation.follow(equations().numbers(), work.numbers) != Course::continues) return false;
    read(*continuation.state().equations, work.numbers, continuation.state().z, values);
    return true;
  }

  /// Gives how far a quantity differs where Newton's steps and chords end, SI.
  double rounding_of_value(std::size_t q) const {
    const QuantityGradient gradient = gradient_of(of_[q], equations(), equations().numbers(), nominal_.z);
    return std::max(converged_sample, rounding_) * gradient.by_unknowns.lpNorm<1>() /
           of_[q].dimension.per_scale(model_.scales());
  }

  /// Derivatives of quantities by the tolerated numbers, scaled units, at numbers that differ by work.by, with the
  /// stops of the nominal equilibrium.
  std::optional<Eigen::MatrixXd> slopes(Work& work) const {
    if (!set_numbers(work) || !chord(work)) return std::nullopt;
    const ResidualDerivatives at = differentiate(equations(), work.numbers, work.z, true);
    const solvers::FullyPivotedLu transposed(Eigen::MatrixXd(at.by_unknowns.transpose()));
    Eigen::MatrixXd out(static_cast<Eigen::Index>(of_.size()), static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t q = 0; q < of_.size(); ++q) {
      const QuantityGradient gradient = gradient_of(of_[q], equations(), work.numbers, work.z);
      const Eigen::VectorXd mu = transposed.solve(gradient.by_unknowns);
      for (std::size_t t = 0; t < rows_.size(); ++t) {
        out(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(t)) =
            gradient.by_numbers[rows_[t]] - mu.dot(at.by_numbers.col(rows_[t]));
      }
    }
    return out;
  }

 private:
  void find_axes() {
    const auto all = static_cast<Eigen::Index>(rows_.size());
    const auto alone = static_cast<Eigen::Index>(own());
    axes_ = Eigen::MatrixXd::Zero(all, all);
    for (Eigen::Index t = 0; t < alone; ++t) {
      const auto at = static_cast<std::size_t>(t);
      axes_(t, t) = tolerances_[at].sigma * per_[at];
    }
    if (options_.fitted == nullptr) return;
    const Eigen::VectorXd per = Eigen::Map<const Eigen::VectorXd>(per_.data(), all).tail(all - alone);
    axes_.bottomRightCorner(all - alone, all - alone) = per.asDiagonal() * options_.fitted->root();
    inwards_ = per.asDiagonal() * options_.fitted->inwards();
  }

  // The equilibrium, and all quantities that are sampled, for many samples at once.
  void compile_for_lanes() {
    if (!(rounding_ < decided_within)) return;
    std::vector<ParameterRow> rows;
    std::vector<ParameterPlace> places;
    for (const int row : rows_) {
      rows.push_back(equations().rows()[static_cast<std::size_t>(row)]);
      places.push_back(rows.back().place);
    }
    lanes_model_ =
        std::make_unique<StaticModel>(model_.scene(), model_.scales(), VaryingNumbers(model_.scene(), places));
    const Equilibrium there = solve(*lanes_model_, options_.solve);
    if (!there.found()) return;
    SceneInLanes lanes(*lanes_model_, there, rows, std::vector<double>(rows.size(), 1.0),
                       {.start = LaneStart::equilibrium, .keeps_sides = true, .quantities = of_});
    if (!lanes.why_not().empty() || lanes.values() != of_.size()) return;
    simd_ = simd_to_use();
    lanes_.emplace(std::move(lanes));
  }

  /// One-way springs that do not act.
  std::vector<char> slack_of(const std::vector<double>& numbers, const std::vector<double>& z) const {
    std::vector<Placed> placed;
    equations().place(z.data(), placed);
    const NumberedEquations::Bodies<double> bodies = equations().bodies(numbers.data(), placed);
    std::vector<char> out;
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      const auto* spring = std::get_if<LinearSpring>(&scene_.elements[e].law);
      if (spring == nullptr || spring->acts == LinearSpring::Acts::both) continue;
      out.push_back(bodies.element_force(static_cast<int>(e)) == 0.0);
    }
    return out;
  }

  /// Sets the numbers that differ by work.by, and what follows from them; false where an expression has no value.
  bool set_numbers(Work& work) const {
    if (leaders_vary_) work.numbers = equations().numbers();
    for (std::size_t t = 0; t < rows_.size(); ++t) {
      work.numbers[rows_[t]] = equations().numbers()[rows_[t]] + work.by[static_cast<Eigen::Index>(t)];
    }
    if (!leaders_vary_) return true;
    try {
      equations().list()->follow(work.numbers);
    } catch (const InputError&) {
      return false;
    }
    return true;
  }

  bool chord(Work& work) const {
    work.dz.noalias() = moves_ * work.by;
    double before = size_of(work.dz);
    const double enough = std::max(converged_sample, rounding_);
    if (!(rounding_ < decided_within)) return false;
    for (std::size_t i = 0; i < work.z.size(); ++i) {
      work.z[i] = nominal_.z[i] + work.dz[static_cast<Eigen::Index>(i)];
    }
    for (int k = 0; k < most_chords; ++k) {
      equations().residual(work.numbers.data(), work.z.data(), work.residual.data(), work.placed);
      work.dz.noalias() = inverse_ * work.residual;
      const double size = size_of(work.dz);
      for (std::size_t i = 0; i < work.z.size(); ++i) work.z[i] -= work.dz[static_cast<Eigen::Index>(i)];
      if (size < enough) break;
      if (!(size <= chord_contraction * before) || k + 1 == most_chords) return false;
      before = size;
    }
    if (!scene_.stops.empty() && !Stops(equations(), work.numbers, work.z).all_kept()) return false;
    return one_way_.empty() || slack_of(work.numbers, work.z) == one_way_;
  }

  bool is_same(const State& state, const std::vector<double>& z) const {
    if (state.z.size() != z.size()) return false;
    const double close = std::max(1e-8, 10 * rounding_);
    for (std::size_t i = 0; i < z.size(); ++i) {
      if (!(std::abs(state.z[i] - z[i]) < close)) return false;
    }
    return true;
  }

  void read(const NumberedEquations& equations, const std::vector<double>& numbers, const std::vector<double>& z,
            double* values) const {
    QuantityPlace<double> place(equations, numbers.data(), z.data());
    for (std::size_t q = 0; q < of_.size(); ++q) {
      values[q] = place.value(of_[q]) / of_[q].dimension.per_scale(model_.scales());
    }
  }

  // Where the sample comes to rest when released from the scene's start.
  bool settle(Work& work, double* values) const {
    for (std::size_t q = 0; q < of_.size(); ++q) values[q] = std::numeric_limits<double>::quiet_NaN();
    Scene scene = model_.scene();
    try {
      // Named numbers first: what follows from them may differ by a tolerance of its own.
      for (const bool named : {true, false}) {
        for (std::size_t t = 0; t < rows_.size(); ++t) {
          const ParameterPlace& place = equations().rows()[rows_[t]].place;
          if ((place.owner == Owner::number) != named) continue;
          set_value_at(scene, place, work.numbers[rows_[t]] / per_[t]);
        }
      }
      const StaticModel model(std::move(scene), model_.scales());
      const Equilibrium found = solve(model, options_.solve);
      if (!found.found()) return false;
      const LinearResponse there =
          response_at(model, found.x, found.certificate.active_stops, solvers::known_to::solution);
      if (!there.why().empty()) return false;
      read(there.equations(), there.equations().numbers(), there.z(), values);
      return true;
    } catch (const InputError&) {  // the loops of the sample cannot be closed
      return false;
    }
  }

  const StaticModel& model_;
  const std::vector<Tolerance>& tolerances_;
  std::vector<SoughtQuantity> of_;
  const ToleranceOptions& options_;
  Scene scene_;  // scaled
  State nominal_;
  bool regular_ = false;
  int sign_ = 1;
  double rounding_ = 0.0;            // moves the nominal solution by so much
  Eigen::MatrixXd inverse_, moves_;  // A^-1, dz/dp
  Eigen::MatrixXd axes_, inwards_;   // see axes(); FittedNumbers::inwards(), scaled
  std::vector<int> rows_;
  std::vector<double> per_;
  bool leaders_vary_ = false;
  std::vector<char> one_way_;
  std::unique_ptr<StaticModel> lanes_model_;
  std::optional<SceneInLanes> lanes_;  // where samples can be computed so
  Simd simd_ = Simd::plain;
};

SampleStatistics statistics_of(std::vector<double> values) {
  SampleStatistics out;
  out.count = values.size();
  if (values.empty()) return out;
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  out.mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - out.mean) * (v - out.mean);
  out.sigma = std::sqrt(squares / static_cast<double>(values.size() - 1));  // NaN of one value
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  out.least = *least;
  out.most = *most;
  const auto quantile = [&](double p) {
    const auto at = values.begin() + std::lround(p * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  out.low = quantile(0.025);
  out.median = quantile(0.5);
  out.high = quantile(0.975);
  return out;
}

std::vector<std::size_t> histogram_of(const std::vector<double>& values, const SampleStatistics& all) {
  std::vector<std::size_t> out(bins, 0);
  const double width = (all.most - all.least) / static_cast<double>(bins);
  for (const double v : values) {
    const double bin = width > 0.0 ? (v - all.least) / width : 0.0;
    ++out[std::min(bins - 1, static_cast<std::size_t>(bin))];
  }
  return out;
}

/// First order from exact derivatives; the fitted numbers are the last of the tolerances.
void add_first_order(ToleranceBand& band, const QuantitySensitivity& from, const std::vector<Tolerance>& tolerances,
                     const FittedNumbers* fitted) {
  band.why = from.why;
  band.nominal = from.value;
  if (!band.why.empty()) return;
  double variance = 0.0;
  for (const Tolerance& tolerance : tolerances) {
    if (tolerance.distribution == Tolerance::Distribution::fitted) continue;
    const auto found = std::find_if(from.by.begin(), from.by.end(),
                                    [&](const Sensitivity& one) { return one.number == tolerance.number; });
    if (found == from.by.end() || !found->why.empty()) {
      band.why = fmt::format("no derivative by {}: {}", tolerance.number,
                             found == from.by.end() ? "statics does not use it" : found->why);
      return;
    }
    band.slopes.push_back(found->derivative);
    band.shares.push_back(std::pow(found->derivative * tolerance.sigma, 2));
    variance += band.shares.back();
    band.worst += std::abs(found->derivative) * tolerance.half_width;
  }
  if (fitted != nullptr) {
    const ResultGradient gradient = gradient_by(*fitted, from);
    const PredictedResult predicted = predict(*fitted, from.of.name, from.of.dimension, gradient);
    band.why =
        predicted.undetermined.empty() ? predicted.why : "it is not determined by the fit: " + predicted.undetermined;
    if (!band.why.empty()) return;
    band.slopes.insert(band.slopes.end(), gradient.by.begin(), gradient.by.end());
    const std::size_t own = band.shares.size();
    band.shares.resize(tolerances.size(), 0.0);
    for (const PredictedResult::Share& share : predicted.shares) {
      band.shares[own + share.number] = share.share * predicted.sigma * predicted.sigma;
    }
    variance += predicted.sigma * predicted.sigma;
  }
  band.sigma = std::sqrt(variance);
  for (double& share : band.shares) share = variance > 0.0 ? share / variance : 0.0;
}

/// Second derivatives along the axes of the numbers from differences of first ones, which are exact.
void add_second_order(const Sampler& sampler, const std::vector<Tolerance>& tolerances, const Scales& scales,
                      std::vector<ToleranceBand*>& bands) {
  constexpr double part = 0.01;  // of the half width
  const Eigen::MatrixXd& axes = sampler.axes();
  const Eigen::Index n = axes.cols();
  std::vector<Eigen::MatrixXd> second(bands.size(), Eigen::MatrixXd(n, n));
  Sampler::Work work = sampler.work();
  for (Eigen::Index a = 0; a < n; ++a) {
    const auto t = static_cast<std::size_t>(a);
    const double step = part * (sampler.half_width(t) > 0.0 ? sampler.half_width(t) / axes(a, a) : 1.0);
    std::array<Eigen::MatrixXd, 2> slopes;
    for (const int side : {0, 1}) {
      work.by = (side == 0 ? -step : step) * axes.col(a);
      std::optional<Eigen::MatrixXd> found = sampler.slopes(work);
      if (!found) return;
      slopes[static_cast<std::size_t>(side)] = std::move(*found);
    }
    const Eigen::MatrixXd change = (slopes[1] - slopes[0]) / (2 * step) * axes;
    for (std::size_t q = 0; q < bands.size(); ++q) second[q].col(a) = change.row(static_cast<Eigen::Index>(q));
  }
  for (std::size_t q = 0; q < bands.size(); ++q) {
    ToleranceBand& band = *bands[q];
    double variance = band.sigma * band.sigma;
    const double per = band.of.dimension.per_scale(scales);
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool is_uniform = tolerances[static_cast<std::size_t>(i)].distribution == Tolerance::Distribution::uniform;
      const double own = second[q](i, i) / per;
      band.shift += 0.5 * own;
      variance += 0.25 * own * own * (is_uniform ? 0.8 : 2.0);  // fourth moment over sigma^4, less 1
      for (Eigen::Index j = i + 1; j < n; ++j) {
        variance += std::pow(0.5 * (second[q](i, j) + second[q](j, i)) / per, 2);
      }
    }
    band.second_sigma = std::sqrt(variance);
    band.has_second = true;
  }
}

/// The numbers of a fit behind the tolerances.
std::vector<Tolerance> with_fitted(std::vector<Tolerance> out, const FittedNumbers* fitted) {
  if (fitted == nullptr) return out;
  for (std::size_t i = 0; i < fitted->numbers.size(); ++i) {
    const FittedNumbers::Number& number = fitted->numbers[i];
    for (const Tolerance& other : out) {
      if (other.number != number.path) continue;
      throw InputError(fmt::format("{}: has both a tolerance and an estimate of {}; give it the tolerance 0",
                                   number.path, fitted->file));
    }
    const auto at = static_cast<Eigen::Index>(i);
    out.push_back(
        {number.path, number.dimension, 0.0, Tolerance::Distribution::fitted, std::sqrt(fitted->covariance(at, at))});
  }
  return out;
}

/// At the ends of all tolerances that first order says are worst.
void add_corners(const Sampler& sampler, std::vector<ToleranceBand*>& bands) {
  Sampler::Work work = sampler.work();
  std::vector<double> values(bands.size());
  for (std::size_t q = 0; q < bands.size(); ++q) {
    for (const double side : {-1.0, 1.0}) {
      for (std::size_t t = 0; t < sampler.tolerances(); ++t) {
        const double slope = bands[q]->slopes[t];
        work.by[static_cast<Eigen::Index>(t)] = side * (slope > 0.0 ? 1.0 : -1.0) * sampler.half_width(t);
      }
      if (!sampler.continued(work, values.data())) continue;
      (side < 0.0 ? bands[q]->at_least : bands[q]->at_most) = values[q];
    }
  }
}

/// `rounding`: a change of the quantity that says nothing, SI.
bool is_linear(const ToleranceBand& band, const ToleranceStudy& study, double rounding) {
  const auto far = [&](double mean, double sigma) {
    return std::abs(mean - band.nominal) > ToleranceBand::linear_to * band.sigma + rounding ||
           std::abs(sigma - band.sigma) > ToleranceBand::linear_to * band.sigma + rounding;
  };
  if (band.has_second && far(band.nominal + band.shift, band.second_sigma)) return false;
  if (study.samples == 0) return band.has_second;
  // What so many samples leave open of mean and deviation.
  const double noise = 3.0 / std::sqrt(static_cast<double>(std::max<std::size_t>(1, band.continued.count)));
  return study.snapped + study.nowhere + study.undecided == 0 && band.continued.count > 0 &&
         std::abs(band.continued.mean - band.nominal) <= (ToleranceBand::linear_to + noise) * band.sigma + rounding &&
         (band.continued.count == 1 ||
          std::abs(band.continued.sigma - band.sigma) <= (ToleranceBand::linear_to + noise) * band.sigma + rounding);
}

}  // namespace

ToleranceStudy tolerance_study(const StaticModel& model, const std::vector<Tolerance>& of_numbers,
                               const std::vector<SoughtQuantity>& of, const ToleranceOptions& options) {
  ToleranceStudy out;
  out.tolerances = with_fitted(of_numbers, options.fitted);
  const std::vector<Tolerance>& tolerances = out.tolerances;
  out.asked = options.samples;
  const Sensitivities first = sensitivities(model, of, {options.solve});
  out.equilibrium = first.equilibrium;
  out.why = first.why;
  if (out.why.empty() && first.equilibrium.certificate.stability == Stability::unstable) {
    out.why = "the equilibrium is unstable, and scenes with other numbers do not come to rest near it";
  }
  if (!out.why.empty()) return out;
  const LinearResponse response =
      response_at(model, first.equilibrium.x, first.equilibrium.certificate.active_stops, solvers::known_to::solution);
  if (response.equations().unknowns() > most_sampled_unknowns) {
    throw InputError(fmt::format("{}: expected a mechanism of at most {} places and joint forces, found {}",
                                 model.scene().file, most_sampled_unknowns, response.equations().unknowns()));
  }
  std::vector<SoughtQuantity> sampled;
  std::vector<std::size_t> places;
  for (std::size_t q = 0; q < of.size(); ++q) {
    ToleranceBand& band = out.of.emplace_back();
    band.of = of[q];
    add_first_order(band, first.of[q], tolerances, options.fitted);
    if (!band.why.empty() || of[q].kind == SoughtQuantity::Kind::load_at_fold) continue;
    sampled.push_back(of[q]);
    places.push_back(q);
  }
  const Sampler sampler(model, tolerances, sampled, response, options);
  if (!sampler.is_regular()) {
    out.why =
        "redundant constraints or neutral directions: loops do not close, or places are free, when numbers differ";
    out.of.clear();
    return out;
  }
  std::vector<ToleranceBand*> bands;
  for (const std::size_t q : places) bands.push_back(&out.of[q]);
  if (bands.empty()) return out;
  add_second_order(sampler, tolerances, model.scales(), bands);
  add_corners(sampler, bands);

  const std::size_t quantities = bands.size();
  std::vector<double> values(options.samples * quantities);
  std::vector<Sampler::Fate> fates(options.samples, Sampler::Fate::nowhere);
  std::vector<char> done(options.samples, 0);
  std::atomic<std::size_t> rechecked = 0, disagreed = 0;
  const std::size_t chunks = (options.samples + chunk - 1) / chunk;
  solvers::ParallelOptions parallel{.jobs = options.jobs, .interrupt = options.solve.interrupt};
  if (options.progress) parallel.progress = [&](std::size_t ended) { options.progress(ended * chunk); };
  solvers::parallel_for(chunks, parallel, [&](std::size_t c) {
    Sampler::Work work = sampler.work();
    const std::size_t begin = c * chunk, end = std::min(options.samples, (c + 1) * chunk);
    std::array<char, chunk> taken{};
    sampler.sample_in_lanes(begin, end - begin, work, values.data() + begin * quantities, taken.data());
    for (std::size_t k = begin; k < end; ++k) {
      if (sampler.interrupted()) return;
      if (taken[k - begin] != 0) {
        fates[k] = Sampler::Fate::taken;
        done[k] = 1;
        continue;
      }
      const Sampler::Sample sample = sampler.sample(k, work, values.data() + k * quantities);
      if (!sample.ended) return;
      fates[k] = sample.fate;
      done[k] = 1;
      if (sample.rechecked) ++rechecked;
      if (sample.disagreed) ++disagreed;
    }
  });
  out.rechecked = rechecked;
  out.disagreed = disagreed;
  for (std::size_t k = 0; k < options.samples; ++k) {
    if (!done[k]) continue;
    ++out.samples;
    const bool taken = fates[k] == Sampler::Fate::taken;
    out.continued += taken || fates[k] == Sampler::Fate::continued ? 1 : 0;
    out.followed += fates[k] == Sampler::Fate::continued ? 1 : 0;
    out.snapped += fates[k] == Sampler::Fate::snapped ? 1 : 0;
    out.nowhere += fates[k] == Sampler::Fate::nowhere ? 1 : 0;
    out.undecided += fates[k] == Sampler::Fate::undecided ? 1 : 0;
  }
  out.interrupted = out.samples < options.samples;
  for (std::size_t q = 0; q < quantities; ++q) {
    std::vector<double> continued, all;
    continued.reserve(out.continued);
    all.reserve(out.continued + out.snapped);
    for (std::size_t k = 0; k < options.samples; ++k) {
      if (!done[k] || fates[k] == Sampler::Fate::nowhere || fates[k] == Sampler::Fate::undecided) continue;
      const double value = values[k * quantities + q];
      all.push_back(value);
      if (fates[k] != Sampler::Fate::snapped) continued.push_back(value);
    }
    ToleranceBand& band = *bands[q];
    band.all = statistics_of(all);
    band.continued = statistics_of(std::move(continued));
    if (!all.empty()) band.histogram = histogram_of(all, band.all);
    band.is_linear = is_linear(band, out, sampler.rounding_of_value(q) + 1e-12 * std::abs(band.nominal));
  }
  return out;
}

}  // namespace poise
