// 4 doubles at a time. Only functions of this object, and SLEEF's, which have the instructions in their names, are
// called here.

#include <immintrin.h>
#include <sleef.h>
#include <stddef.h>
#include <stdint.h>

namespace {

constexpr size_t pack_width = 4;
constexpr size_t packs = 4;
typedef double Pack __attribute__((vector_size(8 * pack_width)));
typedef long long Bits __attribute__((vector_size(8 * pack_width)));

Pack fused(Pack a, Pack b, Pack c) { return _mm256_fmadd_pd(a, b, c); }
Pack square_root(Pack a) { return _mm256_sqrt_pd(a); }
Pack rounded_down(Pack a) { return _mm256_floor_pd(a); }
bool is_any(Bits a) { return _mm256_movemask_pd((__m256d)a) != 0; }
void on_each_sine_and_cosine(Pack a, Pack& sine, Pack& cosine) {
  const Sleef___m256d_2 both = Sleef_finz_sincosd4_u10avx2(a);
  sine = both.x;
  cosine = both.y;
}
Pack on_each_sine(Pack a) { return Sleef_finz_sind4_u10avx2(a); }
Pack on_each_cosine(Pack a) { return Sleef_finz_cosd4_u10avx2(a); }
Pack on_each_tangent(Pack a) { return Sleef_finz_tand4_u10avx2(a); }
Pack on_each_arc_tangent(Pack a) { return Sleef_finz_atand4_u10avx2(a); }
Pack on_each_exponential(Pack a) { return Sleef_finz_expd4_u10avx2(a); }
Pack on_each_exponential_less_one(Pack a) { return Sleef_finz_expm1d4_u10avx2(a); }
Pack on_each_logarithm(Pack a) { return Sleef_finz_logd4_u10avx2(a); }
Pack on_each_logarithm_of_more(Pack a) { return Sleef_finz_log1pd4_u10avx2(a); }
Pack on_each_hyperbolic_sine(Pack a) { return Sleef_finz_sinhd4_u10avx2(a); }
Pack on_each_hyperbolic_cosine(Pack a) { return Sleef_finz_coshd4_u10avx2(a); }
Pack on_each_hyperbolic_tangent(Pack a) { return Sleef_finz_tanhd4_u10avx2(a); }
Pack on_each_arc_tangent_of(Pack a, Pack b) { return Sleef_finz_atan2d4_u10avx2(a, b); }
Pack on_each_power(Pack a, Pack b) { return Sleef_finz_powd4_u10avx2(a, b); }

}  // namespace

#include "statics/many/private/lane_kernel_impl.hpp"

extern "C" const poise::LaneKernel* poise_lanes_avx2() { return &kernel; }
