#include "statics/many/simd.hpp"

#include <array>
#include <cstdlib>

#include <fmt/format.h>

#include "model/input_error.hpp"

namespace poise {

std::string to_string(Simd simd) {
  switch (simd) {
    case Simd::plain:
      return "plain";
    case Simd::avx2:
      return "avx2";
    case Simd::avx512:
      return "avx512";
  }
  return "unknown";
}

bool has_simd(Simd simd) {
  if (simd == Simd::plain) return true;
#ifdef POISE_VECTOR_KERNELS
  if (simd == Simd::avx2) return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

Simd simd_to_use() {
  constexpr std::array all{Simd::avx512, Simd::avx2, Simd::plain};
  const char* wanted = std::getenv("POISE_SIMD");
  if (wanted != nullptr && *wanted == '\0') wanted = nullptr;
  for (const Simd one : all) {
    if (wanted != nullptr ? to_string(one) != wanted : !has_simd(one)) continue;
    if (has_simd(one)) return one;
    throw InputError(
        fmt::format("POISE_SIMD={}: this processor, or this build of Poise, has no {}; expected a narrower "
                    "one, or none for the widest that there is",
                    wanted, wanted));
  }
  throw InputError(fmt::format("POISE_SIMD={}: expected plain, avx2 or avx512", wanted));
}

}  // namespace poise
