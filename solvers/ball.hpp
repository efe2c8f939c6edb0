#pragma once

#include <arb.h>

namespace poise::solvers {

/// A real number known to lie in [midpoint - radius, midpoint + radius]: ball arithmetic of the Arb library, whose
/// operations enclose all results exactly (F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval
/// arithmetic", IEEE Trans. Computers 66, 2017). Doubles convert without rounding. Division by, and the square root of,
/// a ball that contains zero give a ball that is not finite.
class Ball {
 public:
  /// Bits of the midpoints of results, for the current thread while it lives.
  class Precision {
   public:
    explicit Precision(long bits) : before_(working_bits) { working_bits = bits; }
    ~Precision() { working_bits = before_; }
    Precision(const Precision&) = delete;
    Precision& operator=(const Precision&) = delete;

   private:
    long before_;
  };
  static long bits() { return working_bits; }

  /// While one lives, doubles of the current thread become balls of radius half a unit in the last place (relative
  /// 2^-53): all numbers that round to them. Integers remain exact.
  class InputRounding {
   public:
    explicit InputRounding(bool on) : before_(input_is_rounded) { input_is_rounded = on; }
    ~InputRounding() { input_is_rounded = before_; }
    InputRounding(const InputRounding&) = delete;
    InputRounding& operator=(const InputRounding&) = delete;

   private:
    bool before_;
  };

  Ball() { arb_init(v_); }
  // Implicit, as a double is for a double: the templates of the model mix numbers of the scene with their scalar.
  Ball(double x) : Ball() {  // NOLINT(google-explicit-constructor)
    arb_set_d(v_, x);
    if (input_is_rounded) add_half_unit();
  }
  /// While InputRounding lives the ball of that radius, otherwise x.
  static Ball rounded(double x, double radius) {
    Ball out;
    arb_set_d(out.v_, x);
    return input_is_rounded ? out.widened(radius) : out;
  }
  Ball(int x) : Ball() { arb_set_si(v_, x); }  // NOLINT(google-explicit-constructor)
  Ball(const Ball& a) : Ball() { arb_set(v_, a.v_); }
  Ball(Ball&& a) noexcept : Ball() { arb_swap(v_, a.v_); }
  Ball& operator=(const Ball& a) {
    arb_set(v_, a.v_);
    return *this;
  }
  Ball& operator=(Ball&& a) noexcept {
    arb_swap(v_, a.v_);
    return *this;
  }
  ~Ball() { arb_clear(v_); }

  friend Ball operator+(const Ball& a, const Ball& b) { return by(arb_add, a, b); }
  friend Ball operator-(const Ball& a, const Ball& b) { return by(arb_sub, a, b); }
  friend Ball operator*(const Ball& a, const Ball& b) { return by(arb_mul, a, b); }
  friend Ball operator/(const Ball& a, const Ball& b) { return by(arb_div, a, b); }
  friend Ball operator-(const Ball& a) {
    Ball out;
    arb_neg(out.v_, a.v_);
    return out;
  }
  Ball& operator+=(const Ball& a) {
    arb_add(v_, v_, a.v_, working_bits);
    return *this;
  }
  Ball& operator-=(const Ball& a) {
    arb_sub(v_, v_, a.v_, working_bits);
    return *this;
  }
  Ball& operator*=(const Ball& a) {
    arb_mul(v_, v_, a.v_, working_bits);
    return *this;
  }
  /// this -= a b.
  void subtract_product(const Ball& a, const Ball& b) { arb_submul(v_, a.v_, b.v_, working_bits); }

  /// Notes, while one lives, whether some numbers of two balls were in the order that was asked for and others not: for
  /// texts that choose by an order, in scalars made of balls.
  class Undecided {
   public:
    Undecided() : before_(watched) { watched = &any_; }
    ~Undecided() { watched = before_; }
    Undecided(const Undecided&) = delete;
    Undecided& operator=(const Undecided&) = delete;

    bool any() const { return any_; }

   private:
    bool any_ = false;
    bool* before_;
  };

  /// Equality, order: true only where it holds for all numbers of the balls.
  friend bool operator==(const Ball& a, const Ball& b) { return arb_eq(a.v_, b.v_) != 0; }
  friend bool operator<(const Ball& a, const Ball& b) { return decided(arb_lt, arb_ge, a, b); }
  friend bool operator>(const Ball& a, const Ball& b) { return decided(arb_gt, arb_le, a, b); }
  friend bool operator<=(const Ball& a, const Ball& b) { return decided(arb_le, arb_gt, a, b); }
  friend bool operator>=(const Ball& a, const Ball& b) { return decided(arb_ge, arb_lt, a, b); }

  friend Ball sqrt(const Ball& a) {
    Ball out;
    arb_sqrt(out.v_, a.v_, working_bits);
    return out;
  }
  /// sqrt(x^2 + y^2), also where that may be zero.
  friend Ball hypot(const Ball& x, const Ball& y) {
    Ball out;
    arb_hypot(out.v_, x.v_, y.v_, working_bits);
    return out;
  }
  static Ball pi() {
    Ball out;
    arb_const_pi(out.v_, working_bits);
    return out;
  }
  /// All real numbers.
  static Ball entire() {
    Ball out;
    arb_zero_pm_inf(out.v_);
    return out;
  }
  /// The angle of the vectors (x, y) from the x axis, in (-pi, pi]; of such on both sides of the negative x axis all of
  /// that.
  friend Ball angle_of(const Ball& x, const Ball& y) {
    Ball out;
    arb_atan2(out.v_, y.v_, x.v_, working_bits);
    return out;
  }
  friend Ball atan2(const Ball& y, const Ball& x) { return angle_of(x, y); }
  friend Ball abs(const Ball& a) {
    Ball out;
    arb_abs(out.v_, a.v_);
    return out;
  }
  /// |a| with the sign of b; with both signs where b may have either.
  friend Ball copysign(const Ball& a, const Ball& b) {
    Ball size = abs(a);
    if (arb_is_nonnegative(b.v_) != 0) return size;
    return arb_is_negative(b.v_) != 0 ? -size : of_both(-size, size);
  }
  friend void sin_cos(const Ball& a, Ball& sine, Ball& cosine) { arb_sin_cos(sine.v_, cosine.v_, a.v_, working_bits); }
  friend Ball sin(const Ball& a) {
    Ball out;
    arb_sin(out.v_, a.v_, working_bits);
    return out;
  }
  friend Ball cos(const Ball& a) {
    Ball out;
    arb_cos(out.v_, a.v_, working_bits);
    return out;
  }
  friend Ball exp(const Ball& a) {
    Ball out;
    arb_exp(out.v_, a.v_, working_bits);
    return out;
  }
  friend Ball log(const Ball& a) {
    Ball out;
    arb_log(out.v_, a.v_, working_bits);
    return out;
  }
  friend Ball hull(const Ball& a, const Ball& b) { return of_both(a, b); }
  friend Ball middle_of(const Ball& a) { return a.midpoint(); }

  bool is_finite() const { return arb_is_finite(v_) != 0; }
  bool contains_zero() const { return arb_contains_zero(v_) != 0; }
  /// All of `inner` is in this ball.
  bool contains(const Ball& inner) const { return arb_contains(v_, inner.v_) != 0; }
  /// The smallest ball that contains both.
  static Ball of_both(const Ball& a, const Ball& b) {
    Ball out;
    arb_union(out.v_, a.v_, b.v_, working_bits);
    return out;
  }
  /// The double nearest to the midpoint.
  double middle() const { return arf_get_d(arb_midref(v_), ARF_RND_NEAR); }
  /// The midpoint alone.
  Ball midpoint() const {
    Ball out;
    arf_set(arb_midref(out.v_), arb_midref(v_));
    return out;
  }
  /// Greatest amount of a number of the ball, rounded up.
  double greatest() const;
  /// Least amount of a number of the ball, rounded down; 0 if it contains zero.
  double least() const;
  /// The radius, rounded up.
  double radius() const;
  /// The ball with `more` added to its radius.
  Ball widened(double more) const;

 private:
  template <class Operation>
  static Ball by(Operation operation, const Ball& a, const Ball& b) {
    Ball out;
    operation(out.v_, a.v_, b.v_, working_bits);
    return out;
  }

  template <class Order>
  static bool decided(Order order, Order opposite, const Ball& a, const Ball& b) {
    if (order(a.v_, b.v_) != 0) return true;
    if (watched != nullptr && opposite(a.v_, b.v_) == 0) *watched = true;
    return false;
  }

  void add_half_unit();

  inline static thread_local bool* watched = nullptr;
  inline static thread_local long working_bits = 128;
  inline static thread_local bool input_is_rounded = false;
  arb_t v_;
};

}  // namespace poise::solvers
