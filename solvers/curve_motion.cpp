#include "solvers/curve_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "solvers/cubic.hpp"
#include "solvers/kkt.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/root.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon();
constexpr double shortest_step = 1e-10;
constexpr double least_tangent_cosine = 0.9;  // between the tangents of a step's ends
constexpr double mid_error_part = 0.25;  // of the error in the middle that is allowed for each half, which has 1/16
constexpr int largest_dense_curve = 48;  // variables up to which factors are dense and gaps between branches detected
constexpr int corrections = 12;
constexpr int most_bracketings = 60;

}  // namespace

class CurveMotion::Method {
 public:
  Method(const DampedProblem& problem, const DampedOptions& options)
      : problem_(problem),
        options_(options),
        n_(problem.variables()),
        equalities_(problem.equalities()),
        dense_(!problem.has_objective() || n_ <= largest_dense_curve),
        kkt_(dense_ ? make_null_space(problem) : make_sparse_kkt(problem)),
        active_(problem.constraints(), 0),
        bounds_(problem.limits()),
        gap_(problem.constraints()),
        step_(n_),
        field_(n_),
        y_(problem.constraints()),
        tangent_(problem.tangent_pattern().size()),
        measures_(problem.switches().size()),
        side_(problem.switches().size(), 1.0) {
    std::fill(active_.begin(), active_.begin() + equalities_, 1);
    functions_ = first_switch() + static_cast<int>(problem.switches().size());
    for (Point& p : points_) {
      p.at = problem.make_evaluation();
      p.t.resize(n_);
      p.value.resize(functions_);
      p.slope.resize(functions_);
    }
    left_ = &points_[0];
    std::vector<std::vector<std::size_t>> bounds_of(problem.constraints() - equalities_);
    for (std::size_t b = 0; b < bounds_.size(); ++b) bounds_of[bounds_[b].inequality].push_back(b);
    const Pattern& pattern = problem.jacobian_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      if (pattern.row[e] < equalities_) continue;
      for (const std::size_t b : bounds_of[pattern.row[e] - equalities_]) bound_entries_.emplace_back(e, b);
    }
    result.x.resize(n_);
    error_.resize(functions_);
    bend_.resize(n_);
  }

  void run(std::span<const double> x) {
    result.arrival = Arrival::step_limit;
    result.active = active_;
    result.rounding_decides = false;
    result.margin = std::numeric_limits<double>::infinity();
    result.steps = result.evaluations = 0;
    start_.assign(x.begin(), x.end());
    std::fill(side_.begin(), side_.end(), 1.0);
    std::fill(bend_.begin(), bend_.end(), 0.0);
    scale_ = 0.0;
    forget_right();
    if (!begin()) return arrive(*left_, Arrival::singular);
    if (left_->slope[0] > 0) result.margin = left_->value[0] / left_->slope[0];
    if (left_->value[0] <= left_->noise) return arrive(*left_, Arrival::rest);
    for (std::size_t b = 0; b < bounds_.size(); ++b) {
      if (left_->value[1 + b] <= options_.touching && left_->slope[1 + b] < 0) return rest_on_stop(*left_, b);
    }
    follow();
  }

  DampedResult result;

 private:
  struct Point {
    Evaluation at;
    std::vector<double> t;             // unit tangent, along the motion
    std::vector<double> value, slope;  // r, of bounds, of switches times their side; by arclength
    double noise = 0.0;                // of r
    double sigma = 0.0;                // in the frame of the left end
  };

  bool interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }
  int first_switch() const { return 1 + static_cast<int>(bounds_.size()); }

  void evaluate(Point& p) {
    problem_.evaluate(p.at);
    ++result.evaluations;
  }

  bool factor(Point& p) {
    return kkt_->set_jacobian(p.at, active_) && kkt_->factor_identity() != Kkt::Factors::singular;
  }

  // t = the projection of `along` on the tangent, normalized; false if it vanishes.
  bool set_tangent(Point& p, std::span<const double> along) {
    for (int i = 0; i < n_; ++i) field_[i] = -along[i];
    kkt_->solve(field_, {}, p.t);
    const double length = std::sqrt(dot(p.t, p.t));
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    for (double& t : p.t) t /= length;
    return true;
  }

  // r and its slope, distances and switches; after factor() and set_tangent().
  void set_functions(Point& p) {
    kkt_->solve(p.at.gradient, {}, step_);
    kkt_->solved_multipliers(p.at.gradient, y_);
    problem_.tangent(p.at, y_, tangent_);
    const Pattern& pattern = problem_.tangent_pattern();
    const bool symmetric = problem_.has_objective();
    double bend = 0.0, stiffest = 0.0;
    for (int e = 0; e < pattern.size(); ++e) {
      const int i = pattern.row[e], j = pattern.column[e];
      const double part = tangent_[e] * p.t[i] * p.t[j];
      bend += symmetric && i != j ? 2 * part : part;
      stiffest = std::max(stiffest, std::abs(tangent_[e]));
    }
    p.value[0] = -dot(p.t, p.at.gradient);
    p.slope[0] = -bend;
    scale_ = std::max({scale_, largest(p.at.gradient), largest(y_)});
    p.noise = 4 * unit_roundoff * (scale_ + stiffest * std::max(1.0, largest(p.at.x)));
    set_distances(p);
    set_switches(p);
  }

  void set_distances(Point& p) {
    if (bounds_.empty()) return;
    for (std::size_t b = 0; b < bounds_.size(); ++b) {
      const double g = p.at.constraint[equalities_ + bounds_[b].inequality];
      p.value[1 + b] = bounds_[b].sign * bounds_[b].threshold.past(g);
      p.slope[1 + b] = 0.0;
    }
    const Pattern& pattern = problem_.jacobian_pattern();
    for (const auto& [e, b] : bound_entries_) {
      const double by = bounds_[b].sign * bounds_[b].threshold.slope(p.at.constraint[pattern.row[e]]);
      p.slope[1 + b] += by * p.at.jacobian[e] * p.t[pattern.column[e]];
    }
  }

  void set_switches(Point& p) {
    if (measures_.empty()) return;
    problem_.switch_measures(p.at, measures_);
    for (std::size_t k = 0; k < measures_.size(); ++k) {
      const Threshold& threshold = problem_.switches()[k];
      p.value[first_switch() + k] = side_[k] * threshold.past(measures_[k]);
      problem_.switch_gradient(p.at, static_cast<int>(k), field_);
      p.slope[first_switch() + k] = side_[k] * threshold.slope(measures_[k]) * dot(field_, p.t);
    }
  }

  bool begin() {
    Point& p = *left_;
    std::copy(start_.begin(), start_.end(), p.at.x.begin());
    evaluate(p);
    if (!factor(p)) return false;
    // Any direction within the tangent.
    for (int i = 0; i < n_; ++i) step_[i] = 1.0 + 0.37 * std::sin(1.0 + 2.0 * i);
    if (!set_tangent(p, step_)) return false;
    if (std::abs(dot(p.t, p.at.gradient)) > 1e-6 * largest(p.at.gradient)) {
      for (int i = 0; i < n_; ++i) step_[i] = -p.at.gradient[i];
      if (!set_tangent(p, step_)) return false;
    } else if (dot(p.t, p.at.gradient) > 0) {
      for (double& t : p.t) t = -t;
    }
    choose_rows(p, rows_);
    set_functions(p);
    turn_switches(p);
    return true;
  }

  // From here on switches count positive on the side that the motion is on, or turns to.
  void turn_switches(Point& p) {
    for (std::size_t k = 0; k < side_.size(); ++k) {
      double& value = p.value[first_switch() + k];
      double& slope = p.slope[first_switch() + k];
      const bool touches = std::abs(value) <= 4 * unit_roundoff;
      if (touches ? slope < 0 : value < 0) {
        side_[k] = -side_[k];
        value = -value;
        slope = -slope;
      }
    }
  }

  // --- branches -----------------------------------------------------------------------------------------------------

  void dense_jacobian(const Point& p) {
    full_.setZero(equalities_, n_);
    const Pattern& pattern = problem_.jacobian_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      if (pattern.row[e] < equalities_) full_(pattern.row[e], pattern.column[e]) += p.at.jacobian[e];
    }
  }

  // n - 1 independent rows of J.
  void choose_rows(const Point& p, std::vector<int>& rows) {
    rows.resize(equalities_);
    std::iota(rows.begin(), rows.end(), 0);
    if (!dense_ || equalities_ == n_ - 1) return;
    dense_jacobian(p);
    const PivotOrder order = pivot_order<double>(full_.transpose(), known_to::rounding);
    const std::size_t kept = std::min<std::size_t>(order.columns.size(), static_cast<std::size_t>(n_ - 1));
    rows.assign(order.columns.begin(), order.columns.begin() + static_cast<std::ptrdiff_t>(kept));
    std::sort(rows.begin(), rows.end());
  }

  double orientation(const Point& p, const std::vector<int>& rows) {
    if (static_cast<int>(rows.size()) != n_ - 1) return 1.0;
    dense_jacobian(p);
    square_.resize(n_, n_);
    for (int k = 0; k < n_ - 1; ++k) square_.row(k) = full_.row(rows[k]);
    for (int i = 0; i < n_; ++i) square_(n_ - 1, i) = p.t[i];
    return square_.partialPivLu().determinant();
  }

  // Whether the curve leads from one point to the other without a change of branch between.
  bool same_branch(const Point& from, const Point& to) {
    if (!dense_ || n_ == 1 || equalities_ == 0) return true;
    if (orientation(from, rows_) * orientation(to, rows_) > 0) return true;
    if (equalities_ == n_ - 1) return false;
    choose_rows(to, other_rows_);
    return orientation(from, other_rows_) * orientation(to, other_rows_) > 0;
  }

  // --- points of the curve
  // --------------------------------------------------------------------------------------------

  // p at t_left . (x - x_left) = sigma; p.at.x is where the correction begins.
  bool correct(double sigma, Point& p) {
    const Point& left = *left_;
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < corrections; ++k) {
      evaluate(p);
      double along = sigma;
      for (int i = 0; i < n_; ++i) along -= left.t[i] * (p.at.x[i] - left.at.x[i]);
      for (int r = 0; r < equalities_; ++r) gap_[r] = p.at.constraint[r];
      const double off = std::max(equalities_ > 0 ? largest(std::span(gap_).first(equalities_)) : 0.0, std::abs(along));
      if (!std::isfinite(off) || off > 4.0) return false;
      if (!factor(p)) return false;
      if (!set_tangent(p, left.t)) return false;
      if (off <= unit_roundoff * (1.0 + largest(p.at.x)) || (k > 1 && off > 0.25 * last && last < 1e-11)) {
        p.sigma = sigma;
        return true;
      }
      if (k > 4 && off > last) return false;
      last = off;
      kkt_->solve({}, gap_, step_);
      const double turned = dot(left.t, p.t);
      if (!(turned > 0.3)) return false;
      const double by = (along - dot(left.t, step_)) / turned;
      for (int i = 0; i < n_; ++i) p.at.x[i] += step_[i] + by * p.t[i];
    }
    return false;
  }

  // The right end of an interval of length h.
  bool reach(double h) {
    right_ = unused();
    for (int i = 0; i < n_; ++i) right_->at.x[i] = left_->at.x[i] + h * (left_->t[i] + 0.5 * h * bend_[i]);
    if (correct(h, *right_) && continues(*right_)) return true;
    forget_right();
    return false;
  }

  // On the curve between two points of it, from the cubic through both.
  bool reach_between(const Point& a, const Point& b, double sigma, Point& p) {
    const double tau = (sigma - a.sigma) / (b.sigma - a.sigma);
    const double turned_a = dot(left_->t, a.t), turned_b = dot(left_->t, b.t);
    for (int i = 0; i < n_; ++i) {
      const Cubic x(a.at.x[i], a.t[i] / turned_a, b.at.x[i], b.t[i] / turned_b, b.sigma - a.sigma);
      p.at.x[i] = x.at(tau);
    }
    return correct(sigma, p) && continues(p);
  }

  bool continues(Point& p) {
    if (!(dot(left_->t, p.t) > least_tangent_cosine) || !same_branch(*left_, p)) return false;
    set_functions(p);
    return true;
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
    if (dense_ && equalities_ > n_ - 1) choose_rows(*left_, rows_);
    for (Point* p : {right_, beyond_}) {
      if (p == nullptr || p == left_) continue;
      p->sigma = 0.0;
      for (int i = 0; i < n_; ++i) p->sigma += left_->t[i] * (p->at.x[i] - left_->at.x[i]);
    }
  }

  // --- what functions do
  // ------------------------------------------------------------------------------------------------

  Cubic cubic(const Point& a, const Point& b, int f) const {
    return {a.value[f], a.slope[f] / dot(left_->t, a.t), b.value[f], b.slope[f] / dot(left_->t, b.t),
            b.sigma - a.sigma};
  }

  double noise_of(const Point& p, int f) const {
    return f == 0 ? p.noise : 4 * unit_roundoff * (1.0 + largest(p.at.x));
  }

  // From a to b, where the function is known to `error`.
  enum class Course { positive, falls, touches, unclear };
  Course course(const Point& a, const Point& b, int f, double error) const {
    const Cubic v = cubic(a, b, f);
    const double h = b.sigma - a.sigma;
    const double noise = std::max(noise_of(a, f), noise_of(b, f));
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
    for (int f = functions_ - 1; f >= 0; --f) {
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
  // -------------------------------------------------------------------------------------------------------

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
    if (!reach_between(*left_, *right_, 0.5 * right_->sigma, *trial)) return false;
    mid_ = trial;
    return true;
  }

  // Of the interpolants between the ends, in the middle.
  void measure_errors() {
    const double h = right_->sigma;
    for (int f = 0; f < functions_; ++f) {
      const Cubic whole = cubic(*left_, *right_, f);
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
      const double tau = k % 4 == 3 ? 0.5 : root_of(cubic(*out.before, *out.beyond, f));
      // Alternately on both sides of where the zero is expected.
      const double aside = (k % 2 == 0 ? 0.4 : -0.4) * width;
      const double sigma = std::clamp(from + tau * (to - from) + aside, from + 0.1 * width, to - 0.1 * width);
      Point* const trial = unused(out.before, out.beyond);
      if (!reach_between(*out.before, *out.beyond, sigma, *trial)) return std::nullopt;
      (trial->value[f] > 0 ? out.before : out.beyond) = trial;
    }
    return out;
  }

  bool rest_between(Point& a, Point& b) {
    const std::optional<Bracket> found = bracket(a, b, 0, unit_roundoff * (1.0 + largest(b.at.x)));
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
    if (met_ < first_switch()) {
      rest_on_stop(*beyond_, static_cast<std::size_t>(met_ - 1));
      return true;
    }
    if (beyond_->value[0] <= 0) {
      arrive(*beyond_, Arrival::rest);
      return true;
    }
    left_ = beyond_;
    left_->sigma = 0.0;
    turn_switches(*left_);
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
    result.active[equalities_ + bounds_[bound].inequality] = 1;
  }
  void arrive(const Point& p, Arrival arrival) {
    result.arrival = arrival;
    result.x = p.at.x;
  }

  const DampedProblem& problem_;
  DampedOptions options_;
  int n_, equalities_;
  bool dense_;
  std::unique_ptr<Kkt> kkt_;
  std::vector<char> active_;
  std::vector<Limit> bounds_;
  std::vector<std::pair<int, std::size_t>> bound_entries_;  // entries of the Jacobian, each with a bound of its row
  std::vector<double> gap_, step_, field_, y_, tangent_, measures_, side_, start_, bend_, error_;
  int functions_ = 1;
  Point points_[7];
  Point* left_;
  Point *mid_ = nullptr, *right_ = nullptr;  // of the interval; null where not known
  Point* beyond_ = nullptr;                  // next to right_, at or beyond the event that ends the interval
  int met_ = -1;                             // that event: a function
  std::vector<int> rows_, other_rows_;
  Eigen::MatrixXd full_, square_;
  double scale_ = 0.0;
};

CurveMotion::CurveMotion(const DampedProblem& problem, const DampedOptions& options)
    : method_(std::make_unique<Method>(problem, options)) {}
CurveMotion::~CurveMotion() = default;

const DampedResult& CurveMotion::run(std::span<const double> x) {
  method_->run(x);
  return method_->result;
}

}  // namespace poise::solvers
