// What noise in the readings of inputs does to what sensors read: a member of RunModel.

#include <algorithm>
#include <cmath>
#include <utility>

#include <unsupported/Eigen/MatrixFunctions>

#include "identification/prediction/run_model.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Coordinates (rad or sizes of the mechanism) and their rates are moved by this for a difference.
constexpr double state_step = 1e-6;

/// An input whose readings have noise.
struct NoisyInput {
  std::size_t at;             // index into Run::inputs
  double noise;               // SI
  std::vector<double> times;  // of its readings

  /// The last reading not after t, but not the last of all.
  std::size_t before(double t) const {
    const auto after = std::upper_bound(times.begin(), times.end() - 1, t);
    return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
  }
};

/// Returns the curve with the same value added everywhere.
std::shared_ptr<const TimeCurve> raised(const TimeCurve& curve, double by) {
  std::vector<double> values;
  for (const double t : curve.breaks()) values.push_back(curve.at(t) + by);
  return std::make_shared<const TimeCurve>(TimeCurve::through(curve.breaks(), values));
}

}  // namespace

// The states are errors of the independent coordinates, of their rates, of the inputs, and slopes of the latter:
//   d/dt (z, w, u, s) = (w, alpha_z z + alpha_w w + alpha_u u, s, 0),
// in between two times by the exponential of the mean matrix. At a reading of an input its slope leads to an error of
// the next one that is independent of all before.
std::shared_ptr<const InputErrors> RunModel::input_errors(const double* unknowns, const double* nuisances,
                                                          double accuracy) const {
  std::vector<NoisyInput> noisy;
  for (std::size_t i = 0; i < run_.inputs.size(); ++i) {
    const RunInput& input = run_.inputs[i];
    if (input.noise > 0) noisy.push_back({i, input.noise, input.motion.curve->breaks()});
  }
  if (noisy.empty() || is_at_rest()) return nullptr;

  // The motion at all times that matter.
  const std::vector<Reading> due = this->due(scalings(unknowns), INFINITY);
  const double end = std::max(due.empty() ? 0.0 : due.back().time, 1e-9);
  const Trajectory path = move(unknowns, nuisances, end, accuracy, false).trajectory;
  if (path.nodes() < 2) return nullptr;
  std::vector<double> times = {0.0};
  const auto add = [&](double t) {
    if (t > 0 && t <= end) times.push_back(t);
  };
  std::for_each(path.t.begin(), path.t.end(), add);
  for (const Reading& reading : due) add(reading.time);
  for (const NoisyInput& input : noisy) std::for_each(input.times.begin(), input.times.end(), add);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<int> all(path.q.size() / path.nodes());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  TrajectoryReader along(path, all);
  std::vector<State> states;
  for (const double t : times) {
    along.at(t);
    State& state = states.emplace_back(State{t, {}, {}});
    for (std::size_t i = 0; i < all.size(); ++i) {
      state.q.push_back(along.q(i));
      state.v.push_back(along.v(i));
    }
  }

  // Derivatives of accelerations and readings there: columns of z, w and u.
  const double equilibrium = equilibrium_unknown_ ? nuisances[0] : equilibrium_at();
  const Index f = freedoms_, inputs = std::ssize(noisy), d = 2 * f + 2 * inputs;
  std::vector<double> units;  // of independent coordinates
  const int angles = MotionModel(scene_, scales_, varying_).layout().angles;
  for (const int i : independent_) units.push_back(i < angles ? 1.0 : scales_.length);
  std::vector<MatrixXd> by(static_cast<std::size_t>(2 * f + inputs));
  const auto moved = [&](std::size_t k, double step) {
    std::vector<State> out = states;
    const auto freedom = k % static_cast<std::size_t>(f);
    const auto at = static_cast<std::size_t>(independent_[freedom]);
    for (State& state : out) (k < static_cast<std::size_t>(f) ? state.q : state.v)[at] += step * units[freedom];
    return responses(unknowns, equilibrium, out);
  };
  for (std::size_t k = 0; k < static_cast<std::size_t>(2 * f); ++k) {
    const MatrixXd above = moved(k, state_step), below = moved(k, -state_step);
    if (above.size() == 0 || below.size() == 0) return nullptr;
    by[k] = (above - below) / (2 * state_step * units[k % static_cast<std::size_t>(f)]);
  }
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const auto with = [&](double error) {
      RunModel other = *this;
      other.inputs_[noisy[i].at].curve = raised(*inputs_[noisy[i].at].curve, error);
      return other.responses(unknowns, equilibrium, states);
    };
    const MatrixXd above = with(noisy[i].noise), below = with(-noisy[i].noise);
    if (above.size() == 0 || below.size() == 0) return nullptr;
    by[static_cast<std::size_t>(2 * f) + i] = (above - below) / (2 * noisy[i].noise);
  }
  std::vector<Index> column(times_.size(), -1);  // of a sensor's readings in these
  Index next_column = f;
  for (std::size_t k = 0; k < times_.size(); ++k) {
    if (!times_[k].empty()) column[k] = next_column++;
  }

  const auto rates_at = [&](std::size_t s) {
    MatrixXd out = MatrixXd::Zero(d, d);
    out.block(0, f, f, f).setIdentity();
    out.block(2 * f, 2 * f + inputs, inputs, inputs).setIdentity();
    for (std::size_t c = 0; c < by.size(); ++c) {
      for (Index k = 0; k < f; ++k) {
        out(f + k, static_cast<Index>(c)) = units[static_cast<std::size_t>(k)] * by[c](static_cast<Index>(s), k);
      }
    }
    return out;
  };
  std::vector<InputErrors::Step> steps(times.size());
  MatrixXd rates = rates_at(0);
  auto reading = due.begin();
  for (std::size_t s = 0; s < times.size(); ++s) {
    InputErrors::Step& step = steps[s];
    step.transition.setIdentity(d, d);
    step.kick.setZero(d, s == 0 ? 2 * inputs : inputs);
    if (s > 0) {
      const MatrixXd now = rates_at(s);
      step.transition = ((0.5 * (times[s] - times[s - 1])) * (rates + now)).exp();
      rates = now;
    }
    for (Index i = 0; i < inputs; ++i) {
      const NoisyInput& input = noisy[static_cast<std::size_t>(i)];
      const Index u = 2 * f + i, slope = u + inputs;
      const std::size_t k = input.before(times[s]);
      const double between = input.times[k + 1] - input.times[k];
      if (s == 0) {
        const double part = (times[s] - input.times[k]) / between;
        step.kick(u, 2 * i) = (1 - part) * input.noise;
        step.kick(u, 2 * i + 1) = part * input.noise;
        step.kick(slope, 2 * i) = -input.noise / between;
        step.kick(slope, 2 * i + 1) = input.noise / between;
      } else if (times[s] == input.times[k]) {
        step.transition.row(slope) = -step.transition.row(u) / between;
        step.kick(slope, i) = input.noise / between;
      }
    }
    for (; reading != due.end() && reading->time <= times[s]; ++reading) {
      // Before its start a mechanism that is held stands still, whatever acts on it.
      Eigen::RowVectorXd by_state = Eigen::RowVectorXd::Zero(d);
      for (std::size_t c = 0; c < by.size() && reading->time >= 0; ++c) {
        by_state[static_cast<Index>(c)] = by[c](static_cast<Index>(s), column[reading->sensor]);
      }
      step.readings.push_back({reading->sensor, reading->at, std::move(by_state)});
    }
  }
  return std::make_shared<const InputErrors>(std::move(steps));
}

}  // namespace poise
