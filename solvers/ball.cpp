#include "solvers/ball.hpp"

namespace poise::solvers {
namespace {

constexpr slong double_bits = 53;

class Float {
 public:
  Float() { arf_init(v_); }
  ~Float() { arf_clear(v_); }
  Float(const Float&) = delete;
  Float& operator=(const Float&) = delete;
  arf_struct* get() { return v_; }

 private:
  arf_t v_;
};

}  // namespace

double Ball::greatest() const {
  Float bound;
  arb_get_abs_ubound_arf(bound.get(), v_, double_bits);
  return arf_get_d(bound.get(), ARF_RND_CEIL);
}

double Ball::least() const {
  Float bound;
  arb_get_abs_lbound_arf(bound.get(), v_, double_bits);
  return arf_get_d(bound.get(), ARF_RND_FLOOR);
}

double Ball::radius() const {
  Float bound;
  arf_set_mag(bound.get(), arb_radref(v_));
  return arf_get_d(bound.get(), ARF_RND_CEIL);
}

void Ball::add_half_unit() {
  Float by;
  arf_abs(by.get(), arb_midref(v_));
  arf_mul_2exp_si(by.get(), by.get(), -double_bits);
  arb_add_error_arf(v_, by.get());
}

Ball Ball::widened(double more) const {
  Ball out = *this;
  Float by;
  arf_set_d(by.get(), more);
  arb_add_error_arf(out.v_, by.get());
  return out;
}

}  // namespace poise::solvers
