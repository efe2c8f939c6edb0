// poise_predictions: how many intervals of a snap load, carried from simulated fits, hold the true load.
//
//   poise_predictions FIRST COUNT
//
// One fit for each of the seeds FIRST ... (prediction_campaign.hpp). Prints every hundredth state and a summary; ends
// with 1 where fewer than 93 or more than 97 per cent of the intervals hold the load, or a fit has no interval.

#include <cstdint>
#include <exception>
#include <iostream>
#include <string>

#include <fmt/format.h>

#include "tests/judge/prediction_campaign.hpp"
#include "tests/support/toggle_rig.hpp"

int main(int count, char** words) {
  using namespace poise::judge;
  try {
    if (count != 3) {
      std::cerr << "poise_predictions: expected the first seed and a number of seeds\n";
      return 2;
    }
    const std::uint64_t first = std::stoull(words[1]), seeds = std::stoull(words[2]);
    const double truth = poise::test::rig_snap_load();
    std::uint64_t held = 0, held_first = 0, none = 0, bent = 0;
    double width = 0.0;
    for (std::uint64_t k = 0; k < seeds; ++k) {
      const CarriedFit one = carried_fit(first + k);
      if (!one.why.empty()) {
        ++none;
        std::cout << fmt::format("seed {}: no interval: {}\n", first + k, one.why);
        continue;
      }
      held += one.low <= truth && truth <= one.high ? 1 : 0;
      held_first += one.first_low <= truth && truth <= one.first_high ? 1 : 0;
      bent += one.is_linear ? 0 : 1;
      width += one.high - one.low;
      if ((k + 1) % 100 == 0 || k + 1 == seeds) {
        const auto all = static_cast<double>(k + 1 - none);
        std::cout << fmt::format(
                         "{} fits: {:.2f} % of the intervals hold {:.6g} N, {:.2f} % of those of first order; mean "
                         "width {:.4g} N; "
                         "{} not linear, {} without an interval\n",
                         k + 1, 100.0 * static_cast<double>(held) / all, truth,
                         100.0 * static_cast<double>(held_first) / all, width / all, bent, none)
                  << std::flush;
      }
    }
    const double part = static_cast<double>(held) / static_cast<double>(seeds);
    return none == 0 && part >= 0.93 && part <= 0.97 ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "poise_predictions: " << error.what() << '\n';
    return 2;
  }
}
