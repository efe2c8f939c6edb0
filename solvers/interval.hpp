#pragma once

#include <cfenv>
#include <cmath>
#include <limits>

namespace poise::solvers {

/// While one lives the current thread rounds results of + - x / and the square root upwards, which Interval needs. Code
/// that uses Interval is compiled with -frounding-math (cmake/rounding.cmake), and calls no other code meanwhile that
/// relies on rounding to nearest: Arb, printing, a library's sine where it must be accurate. Compilers do not know that
/// results depend on it, and move operations of the same function across its begin and end if their operands are not in
/// memory that others can see (GCC bug 34678): its scope calls functions of other sources, or works in such memory.
class RoundingUp {
 public:
  RoundingUp() : before_(std::fegetround()) { std::fesetround(FE_UPWARD); }
  ~RoundingUp() { std::fesetround(before_); }
  RoundingUp(const RoundingUp&) = delete;
  RoundingUp& operator=(const RoundingUp&) = delete;

 private:
  int before_;
};

/// All real numbers of [lower, upper]. Operations give intervals that contain all results for numbers of theirs: every
/// bound is one IEEE operation, or the greatest of several, rounded upwards, since the lower bound is kept with its
/// sign turned (R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis", 2009, chapter 2; IEEE
/// 754-2019 section 4.3). Needs RoundingUp. Bounds may be infinite. Where an operation has no bounds (0 times an
/// infinite one, a division by an interval that contains zero) both are NaN or infinite: comparisons with NaN are
/// false, so that nothing is concluded from it.
class Interval {
 public:
  Interval() = default;
  // Implicit, as a double is for a double: the templates of the model mix numbers of the scene with their scalar.
  Interval(double x) : minus_lower_(-x), upper_(x) {}                    // NOLINT(google-explicit-constructor)
  Interval(int x) : minus_lower_(-static_cast<double>(x)), upper_(x) {}  // NOLINT(google-explicit-constructor)
  Interval(double lower, double upper) : minus_lower_(-lower), upper_(upper) {}
  static Interval entire() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  static Interval from(double minus_lower, double upper) {
    Interval out;
    out.minus_lower_ = minus_lower;
    out.upper_ = upper;
    return out;
  }

  double lower() const { return -minus_lower_; }
  double minus_lower() const { return minus_lower_; }
  double upper() const { return upper_; }
  /// Upper bound of upper - lower.
  double width() const { return upper_ + minus_lower_; }
  /// A number of the interval near its middle; of a half infinite one an end.
  double middle() const {
    if (!(upper_ < std::numeric_limits<double>::infinity())) return lower();
    if (!(minus_lower_ < std::numeric_limits<double>::infinity())) return upper_;
    const double m = 0.5 * (upper_ - minus_lower_);
    return m < lower() ? lower() : (m > upper_ ? upper_ : m);
  }
  /// max |x|, NaN where a bound is.
  double magnitude() const { return greater(minus_lower_, upper_); }
  /// min |x|.
  double mignitude() const { return lower() > 0 ? lower() : (upper_ < 0 ? -upper_ : 0.0); }
  bool bounded() const {
    return minus_lower_ < std::numeric_limits<double>::infinity() && upper_ < std::numeric_limits<double>::infinity();
  }
  /// Proved that zero is not in it.
  bool excludes_zero() const { return minus_lower_ < 0 || upper_ < 0; }

  friend Interval operator+(const Interval& a, const Interval& b) {
    return from(a.minus_lower_ + b.minus_lower_, a.upper_ + b.upper_);
  }
  friend Interval operator-(const Interval& a, const Interval& b) {
    return from(a.minus_lower_ + b.upper_, a.upper_ + b.minus_lower_);
  }
  friend Interval operator-(const Interval& a) { return from(a.upper_, a.minus_lower_); }
  /// A product of a number with itself (the same object) is its square. NaN where a bound is NaN. The product of a
  /// bound 0 and an infinite one may be left out (most): its zero is the product of 0 and the other bound, or below an
  /// infinite product.
  friend Interval operator*(const Interval& a, const Interval& b) {
    if (&a == &b) return square(a);
    const double any = (a.minus_lower_ + a.upper_) + (b.minus_lower_ + b.upper_);
    if (std::isnan(any)) return from(any, any);
    const double al = -a.minus_lower_;
    const double bl = -b.minus_lower_;
    return from(most(al * b.minus_lower_, a.minus_lower_ * b.upper_, a.upper_ * b.minus_lower_, -a.upper_ * b.upper_),
                most(a.minus_lower_ * b.minus_lower_, al * b.upper_, a.upper_ * bl, a.upper_ * b.upper_));
  }
  friend Interval square(const Interval& a) {
    const double least = a.mignitude();
    const double greatest = a.magnitude();
    return from(-least * least, greatest * greatest);
  }
  friend Interval operator/(const Interval& a, const Interval& b) {
    if (!b.excludes_zero()) return entire();
    const double bl = -b.minus_lower_;
    const double al = -a.minus_lower_;
    return from(
        greatest(al / b.minus_lower_, a.minus_lower_ / b.upper_, a.upper_ / b.minus_lower_, -a.upper_ / b.upper_),
        greatest(a.minus_lower_ / b.minus_lower_, al / b.upper_, a.upper_ / bl, a.upper_ / b.upper_));
  }
  Interval& operator+=(const Interval& a) { return *this = *this + a; }
  Interval& operator-=(const Interval& a) { return *this = *this - a; }
  Interval& operator*=(const Interval& a) { return *this = *this * a; }

  /// Equality, order: true only where it holds for all numbers of both.
  friend bool operator==(const Interval& a, const Interval& b) {
    return a.minus_lower_ == -a.upper_ && b.minus_lower_ == -b.upper_ && a.upper_ == b.upper_;
  }
  friend bool operator<(const Interval& a, const Interval& b) { return a.upper_ < -b.minus_lower_; }
  friend bool operator>(const Interval& a, const Interval& b) { return b < a; }
  friend bool operator<=(const Interval& a, const Interval& b) { return a.upper_ <= -b.minus_lower_; }
  friend bool operator>=(const Interval& a, const Interval& b) { return b <= a; }

  /// Of its numbers that are not negative. The root of the lower bound, rounded upwards, is lowered by at least one
  /// unit of its last place unless it is exact.
  friend Interval sqrt(const Interval& a) {
    const double l = a.minus_lower_ < 0 ? -a.minus_lower_ : 0.0;
    const double root = std::sqrt(l);
    const double below = root * root > l ? -root + root * std::numeric_limits<double>::epsilon() : -root;
    return from(below, std::sqrt(a.upper_ > 0 ? a.upper_ : (a.upper_ <= 0 ? 0.0 : a.upper_)));
  }
  friend Interval abs(const Interval& a) { return from(-a.mignitude(), a.magnitude()); }

  /// The smallest interval that contains both.
  friend Interval hull(const Interval& a, const Interval& b) {
    return from(greater(a.minus_lower_, b.minus_lower_), greater(a.upper_, b.upper_));
  }
  /// Restricts the interval to numbers of b too; bounds that are NaN restrict nothing. False if proved that there are
  /// none.
  bool meet(const Interval& b) {
    if (b.minus_lower_ < minus_lower_) minus_lower_ = b.minus_lower_;
    if (b.upper_ < upper_) upper_ = b.upper_;
    return !(minus_lower_ + upper_ < 0 || -minus_lower_ > upper_);
  }
  /// max(x, 0).
  friend Interval not_below_zero(const Interval& a) {
    return from(a.minus_lower_ > 0 ? -0.0 : a.minus_lower_, a.upper_ < 0 ? 0.0 : a.upper_);
  }
  friend Interval with_zero(const Interval& a) { return hull(a, Interval(0.0)); }
  friend Interval middle_of(const Interval& a) { return a.middle(); }
  /// Its numbers from `lower` to `upper`, of which there are some.
  friend Interval within(const Interval& a, double lower, double upper) {
    Interval out = a;
    out.meet(Interval(lower, upper));
    return out;
  }

 private:
  // NaN where one of both is.
  static double greater(double a, double b) { return a > b || std::isnan(a) ? a : b; }
  static double greatest(double a, double b, double c, double d) { return greater(greater(a, b), greater(c, d)); }
  // Leaves out those that are NaN, but for the first: a comparison with NaN is false. In this form one instruction
  // each.
  static double most(double a, double b, double c, double d) {
    double out = a;
    out = b > out ? b : out;
    out = c > out ? c : out;
    return d > out ? d : out;
  }

  double minus_lower_ = 0.0;
  double upper_ = 0.0;
};

/// Encloses 2 pi.
inline const Interval full_turn(0x1.921fb54442d18p+2, 0x1.921fb54442d19p+2);

/// Sine and cosine of all numbers of an interval, by their Taylor series of at most pi/4, whose terms alternate in sign
/// and shrink, so that the first one left out bounds the rest. Full range for bounds beyond 1e5.
void sin_cos(const Interval& angle, Interval& sine, Interval& cosine);

/// Exponentials of all numbers of an interval: by the Taylor series of what is left beside a multiple of ln 2, whose
/// tail is bounded by a geometric series.
Interval exp(const Interval& a);

/// Logarithms of its positive numbers. That of a bound is taken from the library and corrected by what the exponential
/// shows is left: t/(1 + t) <= ln(1 + t) <= t.
Interval log(const Interval& a);

/// All angles of the vectors of a box that does not contain zero, those nearest to `near`; entire if it may contain it.
/// A corner is turned back by the nearest angle of a table, to a slope t of at most 1/64, whose arc tangent is its
/// Taylor series with the remainder bounded by the first term left out.
Interval angle_of(const Interval& x, const Interval& y, double near);

/// All angles in [0, pi] whose cosines it has; of those of its numbers that are in [-1, 1], of which there are some.
Interval arc_cosine(const Interval& c);

}  // namespace poise::solvers
