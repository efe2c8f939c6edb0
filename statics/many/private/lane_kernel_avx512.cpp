// 8 doubles at a time. Only functions of this object, and SLEEF's, which have the instructions in their names, are
// called here.

#include <immintrin.h>
#include <sleef.h>
#include <stddef.h>
#include <stdint.h>

namespace {

constexpr size_t pack_width = 8;
constexpr size_t packs = 2;
typedef double Pack __attribute__((vector_size(8 * pack_width)));
typedef long long Bits __attribute__((vector_size(8 * pack_width)));

Pack fused(Pack a, Pack b, Pack c) { return _mm512_fmadd_pd(a, b, c); }
Pack square_root(Pack a) { return _mm512_mask_sqrt_pd(a, 0xFF, a); }
Pack rounded_down(Pack a) { return _mm512_mask_roundscale_pd(a, 0xFF, a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
bool is_any(Bits a) { return _mm512_movepi64_mask((__m512i)a) != 0; }
void on_each_sine_and_cosine(Pack a, Pack& sine, Pack& cosine) {
  const Sleef___m512d_2 both = Sleef_finz_sincosd8_u10avx512f(a);
  sine = both.x;
  cosine = both.y;
}
Pack on_each_sine(Pack a) { return Sleef_finz_sind8_u10avx512f(a); }
Pack on_each_cosine(Pack a) { return Sleef_finz_cosd8_u10avx512f(a); }
Pack on_each_tangent(Pack a) { return Sleef_finz_tand8_u10avx512f(a); }
Pack on_each_arc_tangent(Pack a) { return Sleef_finz_atand8_u10avx512f(a); }
Pack on_each_exponential(Pack a) { return Sleef_finz_expd8_u10avx512f(a); }
Pack on_each_exponential_less_one(Pack a) { return Sleef_finz_expm1d8_u10avx512f(a); }
Pack on_each_logarithm(Pack a) { return Sleef_finz_logd8_u10avx512f(a); }
Pack on_each_logarithm_of_more(Pack a) { return Sleef_finz_log1pd8_u10avx512f(a); }
Pack on_each_hyperbolic_sine(Pack a) { return Sleef_finz_sinhd8_u10avx512f(a); }
Pack on_each_hyperbolic_cosine(Pack a) { return Sleef_finz_coshd8_u10avx512f(a); }
Pack on_each_hyperbolic_tangent(Pack a) { return Sleef_finz_tanhd8_u10avx512f(a); }
Pack on_each_arc_tangent_of(Pack a, Pack b) { return Sleef_finz_atan2d8_u10avx512f(a, b); }
Pack on_each_power(Pack a, Pack b) { return Sleef_finz_powd8_u10avx512f(a, b); }

}  // namespace

#include "statics/many/private/lane_kernel_impl.hpp"

extern "C" const poise::LaneKernel* poise_lanes_avx512() { return &kernel; }
