// Doubles as any processor has them, in pairs that the compiler makes what it can of.

#include <math.h>
#include <stddef.h>
#include <stdint.h>

namespace {

constexpr size_t pack_width = 2;
constexpr size_t packs = 4;
typedef double Pack __attribute__((vector_size(8 * pack_width)));
typedef long long Bits __attribute__((vector_size(8 * pack_width)));

Pack fused(Pack a, Pack b, Pack c) { return a * b + c; }
Pack square_root(Pack a) { return Pack{sqrt(a[0]), sqrt(a[1])}; }
Pack rounded_down(Pack a) { return Pack{floor(a[0]), floor(a[1])}; }
bool is_any(Bits a) { return (a[0] | a[1]) != 0; }
void on_each_sine_and_cosine(Pack a, Pack& sine, Pack& cosine) {
  sine = Pack{sin(a[0]), sin(a[1])};
  cosine = Pack{cos(a[0]), cos(a[1])};
}
Pack on_each_sine(Pack a) { return Pack{sin(a[0]), sin(a[1])}; }
Pack on_each_cosine(Pack a) { return Pack{cos(a[0]), cos(a[1])}; }
Pack on_each_tangent(Pack a) { return Pack{tan(a[0]), tan(a[1])}; }
Pack on_each_arc_tangent(Pack a) { return Pack{atan(a[0]), atan(a[1])}; }
Pack on_each_exponential(Pack a) { return Pack{exp(a[0]), exp(a[1])}; }
Pack on_each_exponential_less_one(Pack a) { return Pack{expm1(a[0]), expm1(a[1])}; }
Pack on_each_logarithm(Pack a) { return Pack{log(a[0]), log(a[1])}; }
Pack on_each_logarithm_of_more(Pack a) { return Pack{log1p(a[0]), log1p(a[1])}; }
Pack on_each_hyperbolic_sine(Pack a) { return Pack{sinh(a[0]), sinh(a[1])}; }
Pack on_each_hyperbolic_cosine(Pack a) { return Pack{cosh(a[0]), cosh(a[1])}; }
Pack on_each_hyperbolic_tangent(Pack a) { return Pack{tanh(a[0]), tanh(a[1])}; }
Pack on_each_arc_tangent_of(Pack a, Pack b) { return Pack{atan2(a[0], b[0]), atan2(a[1], b[1])}; }
Pack on_each_power(Pack a, Pack b) { return Pack{pow(a[0], b[0]), pow(a[1], b[1])}; }

}  // namespace

#include "statics/many/private/lane_kernel_impl.hpp"

extern "C" const poise::LaneKernel* poise_lanes_plain() { return &kernel; }
