#pragma once

#include <string>

namespace poise {

/// How many variants are computed at a time, and by which instructions of the processor.
enum class Simd {
  plain,  ///< doubles as any processor has them
  avx2,   ///< 4 in a register, with fused multiply-add
  avx512  ///< 8
};

/// "plain", "avx2", "avx512".
std::string to_string(Simd simd);

/// Whether this processor has the instructions, and Poise was built with them.
bool has_simd(Simd simd);

/// The widest that there is, or what the environment variable POISE_SIMD names. Throws InputError where that is no such
/// word, or names what is not there.
Simd simd_to_use();

}  // namespace poise
