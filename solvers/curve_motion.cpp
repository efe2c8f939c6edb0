#include "solvers/curve_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/cubic.hpp"
#include "solvers/curve_points.hpp"
#include "solvers/root.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double roundoff = std::numeric_limits<double>::epsilon();
constexpr double shortest_step = 1e-10;
constexpr double mid_error_part = 0.25;  // of the error in the middle that is allowed for each half, which has 1/16
constexpr int most_bracketings = 60;

}  // namespace

class CurveMotion::Tracer {
 public:
  Tracer(const DampedProblem& problem, const DampedOptions& options)
      : problem_(problem), options_(options), n_(problem.variables()), curve_(problem) {
    for (Point& p : points_) p = curve_.make();
    left_ = &points_[0];
    result.x.resize(n_);
    error_.resize(curve_.functions());
    bend_.resize(n_);
  }

  void run(std::span<const double> x) {
    result.arrival = Arrival::step_limit;
    result.active = curve_.active;
    result.rounding_decides = false;
    result.margin = std::numeric_limits<double>::infinity();
    result.steps = 0;
    start_.assign(x.begin(), x.end());
    std::fill(bend_.begin(), bend_.end(), 0.0);
    forget_right();
    if (!curve_.begin(start_, *left_)) return arrive(*left_, Arrival::singular);
    if (left_->slope[0] > 0) result.margin = left_->value[0] / left_->slope[0];
    if (left_->value[0] <= left_->noise) return arrive(*left_, Arrival::rest);
    for (std::size_t b = 0; b < curve_.bounds().size(); ++b) {
      if (left_->value[1 + b] <= options_.touching && left_->slope[1 + b] < 0) return rest_on_stop(*left_, b);
    }
    follow();
  }

  DampedResult result;

 private:
  using Point = CurvePoints::Point;

  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

  // --- points of an interval

  // The right end of an interval of length h.
  bool reach(double h) {
    right_ = unused();
    for (int i = 0; i < n_; ++i) right_->at.x[i] = left_->at.x[i] + h * (left_->t[i] + 0.5 * h * bend_[i]);
    if (curve_.reach(*left_, h, *right_)) return true;
    forget_right();
    return false;
  }

  // A point that is none of those in use.
  Point* unused(const Point* but = nullptr, const Point* nor = nullptr) {
    for (Point& p : points_) {
      if (&p != left_ && &p != mid_ && &p != right_ && &p != beyond_ && &p != but && &p != nor) return &p;
    }
    return nullptr;
  }

  void forget_right() {
    mid_ = right_ = beyond_ = nullptr;
    met_ = -1;
  }

  // Makes a point of the interval its left end.
  void advance(Point& to) {
    for (int i = 0; i < n_; ++i) bend_[i] = (to.t[i] - left_->t[i]) / to.sigma;
    left_ = &to;
    left_->sigma = 0.0;
    if (options_.passed) options_.passed(left_->at.x);
    curve_.choose_rows_at(*left_);
    for (Point* p : {right_, beyond_}) {
      if (p == nullptr || p == left_) continue;
      p->sigma = 0.0;
      for (int i = 0; i < n_; ++i) p->sigma += left_->t[i] * (p->at.x[i] - left_->at.x[i]);
    }
  }

  // --- what functions do

  // What a function does from a to b, known to `error`.
  enum class Course { positive, falls, touches, unclear };
  Course course(const Point& a, const Point& b, int f, double error) const {
    const Cubic v = CurvePoints::cubic(*left_, a, b, f);
    const double h = b.sigma - a.sigma;
    const double noise = std::max(curve_.noise_of(a, f), curve_.noise_of(b, f));
    const double doubt = std::max(error, noise);
    const double least = v.least();
    if (least > doubt) return Course::positive;
    // Leaves a bound or a switch.
    if (f > 0 && a.value[f] <= options_.touching && b.value[f] > 0 && v.least_rise() > doubt) return Course::positive;
    const bool is_constant = f > 0 && std::abs(a.slope[f]) + std::abs(b.slope[f]) <= 1e-9 &&
                             std::abs(a.value[f] - b.value[f]) <= 1e-9 * h + 2 * noise;
    if (is_constant) return Course::positive;
    if (a.value[f] > 0 && b.value[f] <= 0 && v.largest_slope() < -4 * error) return Course::falls;
    if (b.value[f] <= noise && b.slope[f] < 0 && v.largest_slope() < -4 * error) return Course::falls;
    // The latter dips below zero between the ends.
    if ((error > noise || least < -doubt) && h > 1e-7) return Course::unclear;
    // Halving tells no more.
    return b.value[f] <= 0 ? Course::falls : Course::touches;
  }

  struct Courses {
    bool clear = true;   // all stay positive
    int event = -1;      // a bound or switch that is met
    bool rests = false;  // r vanishes, and no event is met
    bool unclear = false;
  };
  Courses courses(const Point& a, const Point& b, bool at_left) {
    Courses out;
    for (int f = curve_.functions() - 1; f >= 0; --f) {
      if (f == met_) continue;
      const Course found = course(a, b, f, mid_error_part * error_[f]);
      if (found == Course::positive) continue;
      if (found == Course::touches) {
        result.rounding_decides = result.rounding_decides || f == 0;
        continue;
      }
      out.clear = false;
      if (found == Course::unclear) {
        // Beyond a switch r is another function.
        if (f > 0 || out.event < 0) out.unclear = true;
      } else if (f > 0) {
        if (out.event >= 0 && at_left) out.unclear = true;
        out.event = f;
      } else if (f == 0) {
        out.rests = out.event < 0;
      }
    }
    return out;
  }

  // --- the motion

  void follow() {
    double h = 0.4 * options_.longest_step;
    for (; result.steps < options_.steps; ++result.steps) {
      if (interrupted()) return arrive(*left_, Arrival::interrupted);
      if (right_ == nullptr) h = std::min(h, to_predicted_rest());
      if ((right_ == nullptr && !reach(h)) || !reach_middle()) {
        h *= 0.5;
        forget_right();
        if (h < shortest_step) return arrive(*left_, Arrival::singular);
        continue;
      }
      h = right_->sigma;
      measure_errors();
      const Courses first = courses(*left_, *mid_, true);
      if (!first.clear) {
        if (first.event >= 0 && !first.unclear && locate(*left_, *mid_, first.event)) {
          if (right_->sigma > shortest_step) continue;
          if (cross()) return;
          forget_right();
          h = 0.1 * options_.longest_step;
          continue;
        }
        if (first.rests && !first.unclear && rest_between(*left_, *mid_)) return;
        h *= 0.5;
        shorten_to_middle();
        if (h < shortest_step) return end_within_rounding();
        continue;
      }
      const Courses second = courses(*mid_, *right_, false);
      if (!second.clear) {
        if (second.event < 0 && second.rests && !second.unclear && rest_between(*mid_, *right_)) return;
        advance(*mid_);
        mid_ = nullptr;
        h = right_->sigma;
        if (h < shortest_step) return end_within_rounding();
        continue;
      }
      const double closeness = error_[0] / std::min(mid_->value[0], right_->value[0]);
      advance(*right_);
      if (met_ >= 0) {
        if (cross()) return;
        h = 0.1 * options_.longest_step;
      } else {
        h = std::min(options_.longest_step, h * (closeness < 0.01 ? 2.0 : closeness < 0.1 ? 1.4 : 1.0));
      }
      forget_right();
      if (farthest() > options_.run_away) return arrive(*left_, Arrival::runs_away);
    }
    arrive(*left_, Arrival::step_limit);
  }

  double farthest() const {
    double far = 0.0;
    for (int i = 0; i < n_; ++i) far = std::max(far, std::abs(left_->at.x[i] - start_[i]));
    return far;
  }

  // A little beyond where r is expected to vanish.
  double to_predicted_rest() const {
    if (!(left_->slope[0] < 0)) return options_.longest_step;
    return std::max(1.6 * left_->value[0] / -left_->slope[0], 1e-6);
  }

  bool reach_middle() {
    mid_ = nullptr;
    Point* const trial = unused();
    if (!curve_.reach_between(*left_, *left_, *right_, 0.5 * right_->sigma, *trial)) return false;
    mid_ = trial;
    return true;
  }

  // Measures the errors of the interpolants between the ends, in the middle.
  void measure_errors() {
    const double h = right_->sigma;
    for (int f = 0; f < curve_.functions(); ++f) {
      const Cubic whole = CurvePoints::cubic(*left_, *left_, *right_, f);
      const double slope = h * mid_->slope[f] / dot(left_->t, mid_->t);
      error_[f] = std::max(std::abs(whole.at(0.5) - mid_->value[f]), 0.1 * std::abs(whole.slope(0.5) - slope));
    }
  }

  void shorten_to_middle() {
    right_ = mid_;
    mid_ = beyond_ = nullptr;
    met_ = -1;
  }

  // Brackets the zero of a function that falls between a and b: a point before it and one at or beyond it.
  struct Bracket {
    Point *before, *beyond;
  };
  std::optional<Bracket> bracket(Point& a, Point& b, int f, double width) {
    Bracket out{&a, &b};
    for (int k = 0; k < most_bracketings; ++k) {
      const double from = out.before->sigma, to = out.beyond->sigma;
      if (to - from <= width || out.beyond->value[f] == 0.0) break;
      const double tau = k % 4 == 3 ? 0.5 : root_of(CurvePoints::cubic(*left_, *out.before, *out.beyond, f));
      // Alternately on both sides of where the zero is expected.
      const double aside = (k % 2 == 0 ? 0.4 : -0.4) * width;
      const double sigma = std::clamp(from + tau * (to - from) + aside, from + 0.1 * width, to - 0.1 * width);
      Point* const trial = unused(out.before, out.beyond);
      if (!curve_.reach_between(*left_, *out.before, *out.beyond, sigma, *trial)) return std::nullopt;
      (trial->value[f] > 0 ? out.before : out.beyond) = trial;
    }
    return out;
  }

  bool rest_between(Point& a, Point& b) {
    const std::optional<Bracket> found = bracket(a, b, 0, roundoff * (1.0 + largest(b.at.x)));
    if (!found) return false;
    const bool nearer = found->before->value[0] < -found->beyond->value[0];
    arrive(nearer ? *found->before : *found->beyond, Arrival::rest);
    return true;
  }

  // Ends the interval just before a bound or switch.
  bool locate(Point& a, Point& b, int f) {
    const std::optional<Bracket> found = bracket(a, b, f, 1e-12 * (1.0 + largest(b.at.x)));
    if (!found) return false;
    mid_ = nullptr;
    met_ = f;
    beyond_ = found->beyond;
    right_ = found->before;
    return true;
  }

  // From the point just before a bound or switch: rests there, or passes it. True if the motion ends.
  bool cross() {
    if (met_ < curve_.first_switch()) {
      rest_on_stop(*beyond_, static_cast<std::size_t>(met_ - 1));
      return true;
    }
    if (beyond_->value[0] <= 0) {
      arrive(*beyond_, Arrival::rest);
      return true;
    }
    left_ = beyond_;
    left_->sigma = 0.0;
    curve_.turn_switches(*left_);
    return false;
  }

  static double root_of(const Cubic& v) {
    const auto at = [&](double tau) -> std::optional<ValueAndSlope> { return ValueAndSlope{v.at(tau), v.slope(tau)}; };
    return *root_by_newton(at, {0.0, 1.0}, v.a[0] / (v.a[0] - v.at(1.0)), true);
  }

  // Where an interval has become as short as rounding allows.
  void end_within_rounding() {
    result.rounding_decides = true;
    arrive(*left_, Arrival::rest);
  }

  void rest_on_stop(Point& p, std::size_t bound) {
    arrive(p, Arrival::rest);
    result.active[problem_.equalities() + curve_.bounds()[bound].inequality] = 1;
  }
  void arrive(const Point& p, Arrival arrival) {
    result.arrival = arrival;
    result.evaluations = curve_.evaluations;
    result.x = p.at.x;
  }

  const DampedProblem& problem_;
  DampedOptions options_;
  int n_;
  CurvePoints curve_;
  std::vector<double> start_;
  std::vector<double> bend_;   // of the curve at the left end
  std::vector<double> error_;  // of the functions' interpolants, in the middle
  Point points_[7];
  Point* left_;
  Point *mid_ = nullptr, *right_ = nullptr;  // of the interval; null where not known
  Point* beyond_ = nullptr;                  // next to right_, at or beyond the event that ends the interval
  int met_ = -1;                             // that event: a function
};

CurveMotion::CurveMotion(const DampedProblem& problem, const DampedOptions& options)
    : tracer_(std::make_unique<Tracer>(problem, options)) {}
CurveMotion::~CurveMotion() = default;

const DampedResult& CurveMotion::run(std::span<const double> x) {
  tracer_->run(x);
  return tracer_->result;
}

}  // namespace poise::solvers
