#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <type_traits>

#include <sys/types.h>

namespace poise::benchmarks {

/// Most memory that this process has ever held, kB (VmHWM of /proc/self/status).
double peak_memory();

/// Runs `work` in a child process of its own, so that memory is counted from nothing and whatever runs too long can be
/// ended. `work` fills `size` bytes at its argument. False where the child failed or took more than `seconds`.
bool run_apart(const std::function<void(void*)>& work, void* result, std::size_t size, double seconds);

/// The same for a plain struct; nothing where the child failed or took too long.
template <class Result>
std::optional<Result> run_apart(const std::function<Result()>& work, double seconds) {
  static_assert(std::is_trivially_copyable_v<Result>);
  Result result{};
  const auto fill = [&work](void* at) { *static_cast<Result*>(at) = work(); };
  if (!run_apart(fill, &result, sizeof(Result), seconds)) return std::nullopt;
  return result;
}

}  // namespace poise::benchmarks
