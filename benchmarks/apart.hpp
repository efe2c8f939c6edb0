#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <type_traits>

#include <sys/types.h>

namespace poise::benchmarks {

/// Peak memory of this process, kB (VmHWM of /proc/self/status).
double peak_memory();

/// Runs `work` in a child process, so that its memory is measured separately and it can be ended after a time limit.
/// `work` fills `size` bytes at its argument. False if the child failed or took more than `seconds`.
bool run_apart(const std::function<void(void*)>& work, void* result, std::size_t size, double seconds);

/// The same for a plain struct; empty if the child failed or took too long.
template <class Result>
std::optional<Result> run_apart(const std::function<Result()>& work, double seconds) {
  static_assert(std::is_trivially_copyable_v<Result>);
  Result result{};
  const auto fill = [&work](void* at) { *static_cast<Result*>(at) = work(); };
  if (!run_apart(fill, &result, sizeof(Result), seconds)) return std::nullopt;
  return result;
}

}  // namespace poise::benchmarks
