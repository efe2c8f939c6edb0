#include "tests/judge/settling_judge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "solvers/newton.hpp"
#include "statics/equilibrium/settle.hpp"
#include "tests/support/released_scenes.hpp"
#include "tests/support/slow_motion.hpp"

namespace poise::judge {
namespace {

constexpr double run_away = 20.0;
constexpr int most_steps_of_slow_motion = 60'000;

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, std::abs(a[i] - b[i]));
  return out;
}

double elapsed(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - since).count();
}

Settling settle_timed(const StaticModel& model, const std::vector<double>& x, JudgedSettling& out) {
  const SettleOptions options{.run_away = run_away};
  double settling = 1e300, solving = 1e300;
  Settling found;
  solvers::Newton newton(model.problem());
  for (int k = 0; k < 3; ++k) {
    found = settle(model, x, options);
    settling = std::min(settling, found.microseconds);
    const auto begin = std::chrono::steady_clock::now();
    newton.solve(x);
    solving = std::min(solving, elapsed(begin));
  }
  out.solves = settling / solving;
  out.in_doubt = found.in_doubt;
  out.margin = found.margin;
  out.freedoms = found.freedoms;
  return found;
}

bool same_end(const Settling& found, const test::SlowMotion& slow, double within) {
  if (slow.end == test::SlowMotion::End::far) return found.end == Settling::End::runs_away;
  if (slow.end == test::SlowMotion::End::steps) return found.end == Settling::End::step_limit;
  return found.end == Settling::End::settled && distance(found.x, slow.x) <= within;
}

std::string in_words(const Settling& found, const test::SlowMotion& slow) {
  const char* const ends[] = {"rest", "far", "steps"};
  return fmt::format("{} at {:.6g}, slow motion: {} at {:.6g}", to_string(found.end), fmt::join(found.x, " "),
                     ends[static_cast<int>(slow.end)], fmt::join(slow.x, " "));
}

}  // namespace

JudgedSettling judge_settling_of_one_freedom(std::uint64_t seed) {
  const test::ReleasedScene released = test::release_one_freedom(seed);
  const StaticModel model(released.scene);
  JudgedSettling out;
  const Settling found = settle_timed(model, released.x, out);
  for (double step : {2e-3, 2e-4, 2e-5}) {
    const test::SlowMotion slow = test::slow_motion_along_curve(model, released.x, step, run_away);
    // Near a fold the force is so small that the slow motion turns back late or early.
    out.agrees = same_end(found, slow, 3.0 * step);
    out.words = in_words(found, slow);
    if (out.agrees) break;
  }
  return out;
}

JudgedSettling judge_settling_of_several_freedoms(std::uint64_t seed) {
  const test::ReleasedScene released = test::release_several_freedoms(seed);
  const StaticModel model(released.scene);
  JudgedSettling out;
  const Settling found = settle_timed(model, released.x, out);
  for (double part : {0.3, 0.03}) {
    const test::SlowMotion slow =
        test::slow_motion(model, released.x, found.x, part, 3e-3, run_away, most_steps_of_slow_motion);
    // Soft mechanisms creep, and large steps chatter between two stops. What has come this near does not leave any
    // more.
    const bool creeps = slow.end == test::SlowMotion::End::steps && found.end == Settling::End::settled &&
                        distance(found.x, slow.x) < 3e-2;
    out.agrees = creeps || same_end(found, slow, 1e-2);
    out.words = in_words(found, slow);
    if (out.agrees) break;
  }
  return out;
}

}  // namespace poise::judge
