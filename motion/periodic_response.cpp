#include "motion/periodic_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/time_function.hpp"
#include "motion/private/golden_section.hpp"
#include "motion/quantities_along.hpp"
#include "motion/simulate.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using End = ResponseBranch::End;
using Event = ResponseEvent::Kind;

constexpr double motion_accuracy = 1e-10;
// The state after a period is as far from that before, over how far each coordinate swings.
constexpr double period_closed_within = 1e-12;
constexpr double period_rounding = 1e-9;
// Steps along a branch: in logarithms of the frequency, and in how far each coordinate swings.
constexpr double first_arc = 0.02, longest_arc = 0.12, shortest_arc = 1e-7;
// Multipliers of undamped motion are on the unit circle to about this.
constexpr double on_circle = 1e-7;

/// One period from a state, with derivatives; SI.
struct Shot {
  std::string why;  ///< empty if it reached the end
  End end = End::failed;
  VectorXd last;      ///< phi
  MatrixXd by_state;  ///< its derivative by the state
  VectorXd by_log_f;  ///< by log f
  VectorXd reach;     ///< how far each coordinate and rate goes
  std::shared_ptr<const MotionModel> model;
  Motion motion;

  bool is_whole() const { return why.empty(); }
};

/// Period after period under the load that swings.
class Shooting {
 public:
  Shooting(const Scene& scene, const MotionModel& model, const std::vector<double>& x, const Excitation& excitation,
           const PeriodicOptions& options)
      : scene_(scene), scales_(model.scales()), rest_(model.to_si(x)), options_(options) {
    const ParameterPlace place = parameter(scene_, excitation.path).place;
    const double steady = value_at(scene_, place).value_or(0.0);
    written_ = steady != 0.0 ? steady : options.amplitude;
    offset_ = steady / written_;
    set_value_at(scene_, place, written_);
    function_.of = place.owner == Owner::force ? TimeFunction::Of::force : TimeFunction::Of::torque;
    function_.item = place.item;
    ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
    reduced.begin(0.0, x.data());
    independent_ = reduced.independent();
    for (const int i : independent_) unit_.push_back(i < model.layout().angles ? 1.0 : model.scales().length);
    from_ = rest_;
  }

  int freedoms() const { return static_cast<int>(independent_.size()); }
  const std::vector<int>& independent() const { return independent_; }
  const std::vector<double>& rest() const { return rest_; }
  int motions() const { return motions_; }
  /// Takes the place of that of the options.
  void set_amplitude(double amplitude) { amplitude_ = amplitude; }

  Shot shoot(const VectorXd& state, double frequency, double accuracy = motion_accuracy) {
    ++motions_;
    Shot out;
    Scene moved = scene_;
    TimeFunction function = function_;
    const double amplitude = amplitude_.value_or(options_.amplitude);
    function.law = SineInTime{amplitude / written_, frequency, M_PI_2, offset_};
    moved.time_functions.push_back(function);
    out.model = std::make_shared<const MotionModel>(std::move(moved), scales_);
    const int f = freedoms();
    std::vector<StartValue> wanted;
    for (int k = 0; k < f; ++k) wanted.push_back({independent_[static_cast<std::size_t>(k)], false, state[k]});
    for (int k = 0; k < f; ++k) wanted.push_back({independent_[static_cast<std::size_t>(k)], true, state[f + k]});
    MotionOptions options;
    options.duration = 1 / frequency;
    options.accuracy = accuracy;
    options.sensitivities = true;
    options.independent = independent_;
    options.interrupt = options_.interrupt;
    options.most_steps = most_steps;
    Influence by_frequency;
    by_frequency.force.of = function.of == TimeFunction::Of::force ? ForceNumber::Of::force : ForceNumber::Of::torque;
    by_frequency.force.item = function.item;
    by_frequency.force.time_number = 1;
    options.influences = {by_frequency};
    try {
      const MotionState start = start_motion(*out.model, wanted, &from_, &independent_);
      out.motion = simulate(*out.model, start, options);
      if (out.motion.completed()) from_ = start.q;
    } catch (const InputError& error) {
      out.why = error.what();
      return out;
    }
    if (!out.motion.completed()) {
      out.end = out.motion.status == MotionStatus::interrupted ? End::interrupted : End::failed;
      out.why = out.motion.why;
    } else if (const ContactEvent* const event = meeting(out.motion)) {
      out.end = End::stop;
      out.why = fmt::format("it meets {} at t = {:.4g} s",
                            out.model->scene().stops[static_cast<std::size_t>(event->at.stop)].title(), event->t);
    } else {
      read_end(frequency, out);
    }
    return out;
  }

  /// The first event that is more than friction across a stop which is touched all the time; null where there is none.
  static const ContactEvent* meeting(const Motion& motion) {
    for (const ContactEvent& event : motion.events) {
      if (event.kind != ContactEvent::Kind::stick && event.kind != ContactEvent::Kind::slide) return &event;
    }
    return nullptr;
  }

  Complex harmonic(const std::vector<double>& value) const {
    Complex sum = 0.0;
    const auto count = static_cast<double>(value.size());
    for (std::size_t k = 0; k < value.size(); ++k) {
      sum += value[k] * std::polar(1.0, -2 * M_PI * static_cast<double>(k) / count);
    }
    return 2.0 / count * sum;
  }

 private:
  static constexpr int most_steps = 100'000;

  // phi(T) with T = 1/f: by log f it has the derivative by the number f at the time T, and its rates times dT/dlog f.
  void read_end(double frequency, Shot& out) const {
    const Trajectory& path = out.motion.trajectory;
    const int f = freedoms();
    const std::size_t last = path.nodes() - 1;
    const auto n = static_cast<std::size_t>(path.coordinates), columns = static_cast<std::size_t>(path.columns);
    out.last.resize(2 * f);
    out.by_state.resize(2 * f, 2 * f);
    out.by_log_f.resize(2 * f);
    out.reach = VectorXd::Zero(2 * f);
    double farthest = 0.0;
    for (int k = 0; k < f; ++k) {
      const auto i = static_cast<std::size_t>(independent_[static_cast<std::size_t>(k)]);
      const std::size_t at = last * n + i;
      out.last[k] = path.q[at];
      out.last[f + k] = path.v[at];
      for (int c = 0; c < 2 * f; ++c) {
        out.by_state(k, c) = path.q_p[at * columns + static_cast<std::size_t>(c)];
        out.by_state(f + k, c) = path.v_p[at * columns + static_cast<std::size_t>(c)];
      }
      const std::size_t by_f = at * columns + 2 * static_cast<std::size_t>(f);
      out.by_log_f[k] = frequency * path.q_p[by_f] - path.v[at] / frequency;
      out.by_log_f[f + k] = frequency * path.v_p[by_f] - path.a[at] / frequency;
      for (std::size_t node = 0; node <= last; ++node) {
        out.reach[k] = std::max(out.reach[k], std::abs(path.q[node * n + i] - rest_[i]));
      }
      farthest = std::max(farthest, out.reach[k] / unit_[static_cast<std::size_t>(k)]);
    }
    constexpr double least_share = 1e-3, least = 1e-12;
    for (int k = 0; k < f; ++k) {
      const double floor = unit_[static_cast<std::size_t>(k)] * std::max(least_share * farthest, least);
      out.reach[k] = std::max(out.reach[k], floor);
      out.reach[f + k] = 2 * M_PI * frequency * out.reach[k];
    }
  }

  Scene scene_;
  Scales scales_;
  std::vector<double> rest_, from_;  // coordinates, SI
  const PeriodicOptions& options_;
  std::optional<double> amplitude_;
  double written_ = 1.0, offset_ = 0.0;
  TimeFunction function_;
  std::vector<int> independent_;
  std::vector<double> unit_;
  int motions_ = 0;
};

/// A point of a branch: u = (state / scale, log f).
struct Point {
  VectorXd scale, u, tangent;  ///< the tangent of unit length in this scale
  double step = 0.0;           ///< along its tangent to the next point
  PeriodicAnswer answer;

  VectorXd state() const { return scale.cwiseProduct(u.head(scale.size())); }
};

VectorXd in_scale(const VectorXd& u, const VectorXd& from, const VectorXd& to) {
  VectorXd out = u;
  out.head(from.size()) = u.head(from.size()).cwiseProduct(from).cwiseQuotient(to);
  return out;
}

VectorXcd multipliers_of(const Shot& shot) {
  const MatrixXd scaled = shot.reach.cwiseInverse().asDiagonal() * shot.by_state * shot.reach.asDiagonal();
  return solvers::eigenpairs(scaled).values;
}

/// Products over all multipliers of 1 - m, and of 1 + m.
double product_at(const PeriodicAnswer& answer, double at) {
  Complex out = 1.0;
  for (const Complex& one : answer.multipliers) out *= at - one;
  return out.real();
}

int outside(const PeriodicAnswer& answer, bool is_complex) {
  return static_cast<int>(std::count_if(answer.multipliers.begin(), answer.multipliers.end(), [&](const Complex& m) {
    return std::abs(m) > 1.0 && (m.imag() != 0.0) == is_complex;
  }));
}

/// The greatest value over a period, from values at evenly spaced times of it, the first at t = 0: summits of these
/// that are almost as high are all looked at.
template <class F>
double greatest_in_period(F f, const std::vector<double>& values) {
  constexpr double almost = 0.02;
  constexpr double width = 1e-6;  // of a spacing
  const std::size_t count = values.size();
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  double out = *greatest;
  for (std::size_t k = 0; k < count; ++k) {
    const double before = values[(k + count - 1) % count], after = values[(k + 1) % count];
    const bool is_high = values[k] >= *greatest - almost * (*greatest - *least);
    if (!is_high || values[k] < before || values[k] < after) continue;
    const auto at = static_cast<double>(k);
    out = std::max(out, -least_between([&](double x) { return -f(x); }, at - 1.0, at + 1.0, width).value);
  }
  return out;
}

/// Follows the branches of one excitation.
class Follower {
 public:
  Follower(const Scene& scene, const MotionModel& model, const std::vector<double>& x, const FrequencyResponse& linear,
           const Excitation& excitation, const SoughtQuantity& of, const PeriodicOptions& options)
      : shooting_(scene, model, x, excitation, options), linear_(linear), of_(of), options_(options) {}

  PeriodicResponse run() {
    const double low = std::log(options_.from), high = std::log(options_.to);
    std::string why;
    follow(low, +1, why);
    const bool reaches = !branches_.empty() && !branches_.back().points.empty() &&
                         branches_.back().points.back().u.tail(1)[0] > high - 1e-12;
    if (!reaches && !interrupted()) follow(high, -1, why);
    for (std::size_t b = 0; b < branches_.size(); ++b) find_events(b);
    find_largest();
    find_answers();
    return result(why);
  }

 private:
  struct Branch {
    std::vector<Point> points;
    End end = End::range;
    std::string why;
  };

  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

  /// Newton's method from u in the plane normal to `row` through it, no farther than `most_way`: beyond are other
  /// branches. Sets `why_` and `end_` where it fails.
  std::optional<Point> correct(const VectorXd& scale, const VectorXd& begin, const VectorXd& row, double most_way) {
    constexpr int most = 12;
    constexpr double eps = std::numeric_limits<double>::epsilon(), many = 1e3;
    const Index size = scale.size();
    Point out{scale, begin, {}, 0.0, {}};
    double before = INFINITY;
    for (int k = 0; k < most; ++k) {
      const double frequency = std::exp(out.u[size]);
      const Shot shot = shooting_.shoot(out.state(), frequency);
      if (!shot.is_whole()) {
        why_ = shot.why;
        end_ = shot.end;
        return std::nullopt;
      }
      const VectorXd residual = (shot.last - out.state()).cwiseQuotient(scale);
      MatrixXd matrix(size + 1, size + 1);
      matrix.topLeftCorner(size, size) =
          scale.cwiseInverse().asDiagonal() * shot.by_state * scale.asDiagonal() - MatrixXd::Identity(size, size);
      matrix.topRightCorner(size, 1) = shot.by_log_f.cwiseQuotient(scale);
      matrix.bottomRows(1) = row.transpose();
      const solvers::FullyPivotedLu lu(matrix);
      const double miss = residual.lpNorm<Eigen::Infinity>();
      // A small swing about a large value is known to the rounding of that.
      const double rounding = eps * out.state().cwiseQuotient(scale).lpNorm<Eigen::Infinity>();
      const bool stays = miss <= period_rounding + many * rounding && miss > before / 2;
      if (miss <= period_closed_within + rounding || stays) {
        finish_point(shot, lu, miss, out);
        return out;
      }
      before = miss;
      VectorXd right = VectorXd::Zero(size + 1);
      right.head(size) = -residual;
      right[size] = row.dot(begin - out.u);
      const VectorXd step = lu.solve(right);
      out.u += step;
      if (!((out.u - begin).norm() <= most_way)) break;
    }
    why_ = "Newton's method finds no periodic motion";
    end_ = End::failed;
    return std::nullopt;
  }

  /// Finishes it in the scale of its own motion; its tangent follows from the factors of its equations.
  void finish_point(const Shot& shot, const solvers::FullyPivotedLu& lu, double residual, Point& point) {
    const Index size = point.scale.size();
    VectorXd right = VectorXd::Zero(size + 1);
    right[size] = 1.0;
    const VectorXd along = in_scale(lu.solve(right), point.scale, shot.reach);
    point.answer = describe(shot, std::exp(point.u[size]), point.state(), residual);
    point.u = in_scale(point.u, point.scale, shot.reach);
    point.scale = shot.reach;
    point.tangent = along / along.norm();
  }

  PeriodicAnswer describe(const Shot& shot, double frequency, const VectorXd& state, double residual) {
    constexpr int samples = 128;
    PeriodicAnswer out;
    out.frequency = frequency;
    out.residual = residual;
    const Index f = state.size() / 2;
    out.place.assign(state.begin(), state.begin() + f);
    out.rate.assign(state.begin() + f, state.end());
    QuantitiesAlong along(shot.model->scene(), *shot.model, shot.motion);
    std::vector<double> values;
    for (int k = 0; k < samples; ++k) values.push_back(along.value(of_, k / (samples * frequency)));
    const auto at = [&](double place) {
      return along.value(of_, (place - samples * std::floor(place / samples)) / (samples * frequency));
    };
    const double greatest = greatest_in_period(at, values);
    std::vector<double> opposite;
    for (const double value : values) opposite.push_back(-value);
    const double least = -greatest_in_period([&](double place) { return -at(place); }, opposite);
    out.amplitude = (greatest - least) / 2;
    out.farthest = std::max(std::abs(greatest - linear_.at_rest()), std::abs(least - linear_.at_rest()));
    out.harmonic = shooting_.harmonic(values);
    const VectorXcd multipliers = multipliers_of(shot);
    out.multipliers.assign(multipliers.begin(), multipliers.end());
    std::sort(out.multipliers.begin(), out.multipliers.end(), [](const Complex& a, const Complex& b) {
      return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
    });
    const double most = linear_.is_undamped() ? 1.0 + on_circle : 1.0;
    out.stable = out.multipliers.empty() || std::abs(out.multipliers.front()) < most;
    return out;
  }

  /// The linear answer, as a state at t = 0.
  VectorXd linear_state(double frequency, double amplitude) const {
    const std::vector<Complex> shape = linear_.shape(frequency);
    const int f = shooting_.freedoms();
    VectorXd out(2 * f);
    for (int k = 0; k < f; ++k) {
      const auto i = static_cast<std::size_t>(shooting_.independent()[static_cast<std::size_t>(k)]);
      out[k] = shooting_.rest()[i] + amplitude * shape[i].real();
      out[f + k] = (Complex(0.0, 2 * M_PI * frequency) * amplitude * shape[i]).real();
    }
    return out;
  }

  /// The first point, at a frequency: from the linear answer, or from that to a small amplitude, which then grows.
  std::optional<Point> first_point(double log_f) {
    constexpr double least = 1e-3, first_way = 3.0;
    const double frequency = std::exp(log_f);
    double share = 1.0, reached = 0.0, step = 1.0;
    std::optional<Point> found;
    while (reached < 1.0 && step > least) {
      share = std::min(1.0, reached + step);
      shooting_.set_amplitude(share * options_.amplitude);
      VectorXd rest(2 * shooting_.freedoms());
      for (int k = 0; k < shooting_.freedoms(); ++k) {
        rest[k] = shooting_.rest()[static_cast<std::size_t>(shooting_.independent()[static_cast<std::size_t>(k)])];
        rest[shooting_.freedoms() + k] = 0.0;
      }
      const VectorXd begin = found ? VectorXd(rest + share / reached * (found->state() - rest))
                                   : linear_state(frequency, share * options_.amplitude);
      if (!begin.allFinite()) break;
      if (std::optional<Point> next = at_frequency(begin, log_f, first_way)) {
        found = std::move(next);
        reached = share;
        step *= 2;
      } else if (end_ == End::interrupted) {
        break;
      } else {
        step /= 4;
      }
    }
    shooting_.set_amplitude(options_.amplitude);
    if (reached < 1.0) return std::nullopt;
    return found;
  }

  std::optional<Point> at_frequency(const VectorXd& state, double log_f, double most_way = longest_arc) {
    const Shot shot = shooting_.shoot(state, std::exp(log_f));
    if (!shot.is_whole()) {
      why_ = shot.why;
      end_ = shot.end;
      return std::nullopt;
    }
    VectorXd u(state.size() + 1);
    u << state.cwiseQuotient(shot.reach), log_f;
    return correct(shot.reach, u, VectorXd::Unit(u.size(), u.size() - 1), most_way);
  }

  /// The point at the distance s along the tangent of another.
  std::optional<Point> at_distance(const Point& from, double s) {
    std::optional<Point> out = correct(from.scale, from.u + s * from.tangent, from.tangent, s + shortest_arc);
    if (out && in_scale(out->tangent, out->scale, from.scale).dot(from.tangent) < 0.0) out->tangent *= -1.0;
    return out;
  }

  void follow(double log_f, int direction, std::string& why) {
    Branch branch;
    std::optional<Point> first = first_point(log_f);
    if (!first) {
      if (why.empty()) why = fmt::format("at {:.6g} Hz: {}", std::exp(log_f), why_);
      return;
    }
    if (first->tangent.tail(1)[0] * direction < 0.0) first->tangent *= -1.0;
    branch.points.push_back(std::move(*first));
    const double low = std::log(options_.from), high = std::log(options_.to);
    double step = first_arc;
    while (true) {
      Point& at = branch.points.back();
      if (options_.progress) options_.progress(at.answer.frequency);
      if (static_cast<int>(branch.points.size()) >= options_.most_points) {
        branch.end = End::limit;
        branch.why = fmt::format("{} points reach only {:.6g} Hz", options_.most_points, at.answer.frequency);
        break;
      }
      std::optional<Point> next = at_distance(at, step);
      const bool turns = next && in_scale(next->tangent, next->scale, at.scale).normalized().dot(at.tangent) < 0.9;
      if (!next || (turns && step > 1e-3)) {
        step /= 2;
        if (step > shortest_arc && end_ != End::interrupted) continue;
        branch.end = end_;
        branch.why = fmt::format("at {:.6g} Hz: {}", at.answer.frequency, why_);
        break;
      }
      const double log_next = next->u.tail(1)[0];
      if (log_next < low || log_next > high) {
        const double border = log_next < low ? low : high;
        const double share = (border - at.u.tail(1)[0]) / (log_next - at.u.tail(1)[0]);
        const VectorXd mixed = (1 - share) * at.state() + share * next->state();
        std::optional<Point> last = at_frequency(mixed, border);
        if (last) {
          if (in_scale(last->tangent, last->scale, at.scale).dot(at.tangent) < 0.0) last->tangent *= -1.0;
          at.step = (in_scale(last->u, last->scale, at.scale) - at.u).dot(at.tangent);
          branch.points.push_back(std::move(*last));
        }
        break;
      }
      at.step = step;
      branch.points.push_back(std::move(*next));
      step = std::min(1.4 * step, longest_arc);
    }
    branches_.push_back(std::move(branch));
  }

  /// The place of a change along the arc from one point to the next, of a function of points with opposite signs; where
  /// branches cross, the nearest place at which Newton's method still converges.
  template <class Of>
  Point located(const Point& from, const Point& to, Of of) {
    const double a = of(from), b = of(to);
    const double size = std::max(std::abs(a), std::abs(b));
    Point last = to;
    solvers::root_by_secants(
        [&](double share) -> std::optional<double> {
          std::optional<Point> found = at_distance(from, share * from.step);
          if (!found) return std::nullopt;
          const double value = of(*found) / size;
          last = std::move(*found);
          return value;
        },
        {0.0, 1.0}, a / size, b / size, 1e-11);
    return last;
  }

  void find_events(std::size_t b) {
    const std::vector<Point>& points = branches_[b].points;
    for (std::size_t k = 1; k < points.size() && !interrupted(); ++k) {
      const Point& from = points[k - 1];
      const Point& to = points[k];
      const auto along_f = [](const Point& point) { return point.tangent.tail(1)[0]; };
      const auto at_one = [](const Point& point) { return product_at(point.answer, 1.0); };
      const auto at_minus_one = [](const Point& point) { return product_at(point.answer, -1.0); };
      const auto changes = [&](const auto& of) { return (of(from) > 0.0) != (of(to) > 0.0); };
      if (changes(along_f))
        add_fold(b, k, located(from, to, along_f));
      else if (changes(at_one))
        events_.push_back({Event::branch, located(from, to, at_one).answer});
      if (linear_.is_undamped()) continue;  // multipliers stay on the unit circle, or leave it in pairs
      const bool pair_leaves = std::abs(outside(from.answer, true) - outside(to.answer, true)) == 2 &&
                               outside(from.answer, false) == outside(to.answer, false);
      if (changes(at_minus_one))
        events_.push_back({Event::doubling, located(from, to, at_minus_one).answer});
      else if (pair_leaves)
        events_.push_back({Event::torus, halved(from, to)});
    }
  }

  /// Where complex multipliers cross the unit circle.
  PeriodicAnswer halved(const Point& from, const Point& to) {
    PeriodicAnswer out = to.answer;
    const int before = outside(from.answer, true);
    solvers::Bracket bracket{0.0, 1.0};
    solvers::bisect_at_most(30, bracket, [&](double share) -> std::optional<bool> {
      const std::optional<Point> found = at_distance(from, share * from.step);
      if (!found) return std::nullopt;
      out = found->answer;
      return outside(found->answer, true) == before;
    });
    return out;
  }

  void add_fold(std::size_t b, std::size_t k, const Point& fold) {
    const std::vector<Point>& points = branches_[b].points;
    ResponseEvent event{Event::fold, fold.answer};
    event.upwards = points[k - 1].tangent.tail(1)[0] > 0.0 || points[k].tangent.tail(1)[0] < 0.0;
    event.jumps = points[k - 1].answer.stable != points[k].answer.stable;
    if (event.jumps) {
      for (const PeriodicAnswer& other : answers_at(fold.answer.frequency, std::pair(b, k))) {
        const double away = std::abs(other.amplitude - fold.answer.amplitude);
        const bool is_fold = away < 1e-6 * fold.answer.amplitude;
        if (!other.stable || is_fold) continue;
        if (event.landing && std::abs(event.landing->amplitude - fold.answer.amplitude) < away) continue;
        event.landing = other;
      }
    }
    events_.push_back(std::move(event));
  }

  /// All answers at a frequency on the branches followed, by amplitude; without those on the arcs beside a point.
  std::vector<PeriodicAnswer> answers_at(double frequency,
                                         std::optional<std::pair<std::size_t, std::size_t>> but = {}) {
    constexpr double same = 1e-7;
    const double log_f = std::log(frequency);
    std::vector<Point> found;
    for (std::size_t b = 0; b < branches_.size(); ++b) {
      const std::vector<Point>& points = branches_[b].points;
      for (std::size_t k = 1; k < points.size(); ++k) {
        const double from = points[k - 1].u.tail(1)[0], to = points[k].u.tail(1)[0];
        if ((from - log_f) * (to - log_f) > 0.0 || interrupted()) continue;
        if (but && but->first == b && k + 1 >= but->second && k <= but->second + 1) continue;
        const double share = to != from ? (log_f - from) / (to - from) : 0.0;
        const VectorXd begin = (1 - share) * points[k - 1].state() + share * points[k].state();
        std::optional<Point> point = at_frequency(begin, log_f);
        if (!point) continue;
        const bool is_known = std::any_of(found.begin(), found.end(), [&](const Point& other) {
          return (in_scale(other.u, other.scale, point->scale) - point->u).norm() < same;
        });
        if (!is_known) found.push_back(std::move(*point));
      }
    }
    std::vector<PeriodicAnswer> out;
    for (Point& point : found) out.push_back(std::move(point.answer));
    std::sort(out.begin(), out.end(),
              [](const PeriodicAnswer& a, const PeriodicAnswer& b) { return a.amplitude < b.amplitude; });
    return out;
  }

  /// Finds the largest amplitude by golden sections over the two arcs at the point of largest amplitude.
  void find_largest() {
    constexpr double narrow = 1e-5;
    const Branch* best = nullptr;
    std::size_t place = 0;
    for (const Branch& branch : branches_) {
      for (std::size_t k = 0; k < branch.points.size(); ++k) {
        if (best != nullptr && branch.points[k].answer.amplitude <= best->points[place].answer.amplitude) continue;
        best = &branch;
        place = k;
      }
    }
    if (best == nullptr) return;
    const std::vector<Point>& points = best->points;
    PeriodicAnswer largest = points[place].answer;
    if (place > 0 && place + 1 < points.size() && !interrupted()) {
      const auto amplitude = [&](double s) {
        const std::optional<Point> found = s < 1.0 ? at_distance(points[place - 1], s * points[place - 1].step)
                                                   : at_distance(points[place], (s - 1.0) * points[place].step);
        if (!found) return -1.0;
        if (found->answer.amplitude > largest.amplitude) largest = found->answer;
        return found->answer.amplitude;
      };
      least_between([&](double s) { return -amplitude(s); }, 0.0, 2.0, narrow);
    }
    events_.push_back({Event::largest, largest});
  }

  void find_answers() {
    for (const double frequency : options_.at) answers_.push_back(answers_at(frequency));
  }

  void compare(const PeriodicAnswer& answer) {
    if (interrupted()) return;
    VectorXd state(2 * static_cast<Index>(answer.place.size()));
    for (std::size_t k = 0; k < answer.place.size(); ++k) {
      state[static_cast<Index>(k)] = answer.place[k];
      state[static_cast<Index>(k + answer.place.size())] = answer.rate[k];
    }
    const Shot a = shooting_.shoot(state, answer.frequency);
    const Shot b = shooting_.shoot(state, answer.frequency, motion_accuracy / 10);
    if (a.is_whole() && b.is_whole()) error_ = std::max(error_, difference(a.motion, b.motion));
  }

  PeriodicResponse result(const std::string& why) {
    PeriodicResponse out;
    for (const ResponseEvent& event : events_) compare(event.at);
    for (const std::vector<PeriodicAnswer>& some : answers_) {
      for (const PeriodicAnswer& answer : some) compare(answer);
    }
    for (Branch& branch : branches_) {
      ResponseBranch& one = out.branches.emplace_back();
      one.end = branch.end;
      one.why = branch.why;
      for (Point& point : branch.points) one.points.push_back(std::move(point.answer));
    }
    out.found = !out.branches.empty();
    if (!out.found) out.why = why;
    out.events = std::move(events_);
    out.answers = std::move(answers_);
    out.error = error_;
    out.motions = shooting_.motions();
    return out;
  }

  Shooting shooting_;
  const FrequencyResponse& linear_;
  const SoughtQuantity& of_;
  const PeriodicOptions& options_;
  std::string why_;
  End end_ = End::failed;
  std::vector<Branch> branches_;
  std::vector<ResponseEvent> events_;
  std::vector<std::vector<PeriodicAnswer>> answers_;
  double error_ = 0.0;
};

}  // namespace

bool PeriodicResponse::is_whole() const {
  return found && std::all_of(branches.begin(), branches.end(),
                              [](const ResponseBranch& branch) { return branch.end == ResponseBranch::End::range; });
}

void refuse_without_periodic_response(const Scene& scene, const FrequencyResponse& linear,
                                      const Excitation& excitation) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(scene.file + ": " + what +
                     "; periodic motions are not followed with it; expected a scene without");
  };
  if (!excitation.is_load()) {
    throw InputError(excitation.path +
                     ": of a finite amplitude only loads swing; expected a load (load.NAME), or no --amplitude");
  }
  if (!scene.drives.empty()) refuse(fmt::format("drive \"{}\" moves what it drives", scene.drives.front().name));
  if (const std::vector<std::string> joints = joints_with_friction(scene); !joints.empty()) {
    refuse(fmt::format("joint {} has friction, which sticks", joints.front()));
  }
  for (const Element& element : scene.elements) {
    if (sticks(element.law)) refuse(fmt::format("{} \"{}\" sticks", element.family(), element.name));
  }
  if (!linear.motions().stops.empty()) {
    const Stop& stop = scene.stops[static_cast<std::size_t>(linear.motions().stops.front().stop)];
    refuse(fmt::format("{} \"{}\" holds the mechanism in the equilibrium", stop.table, stop.name));
  }
}

PeriodicResponse periodic_response(const Scene& scene, const MotionModel& model, const std::vector<double>& x,
                                   const FrequencyResponse& linear, const Excitation& excitation,
                                   const SoughtQuantity& of, const PeriodicOptions& options) {
  return Follower(scene, model, x, linear, excitation, of, options).run();
}

}  // namespace poise
