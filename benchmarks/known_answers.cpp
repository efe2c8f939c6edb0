#include "benchmarks/known_answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "comparison/series.hpp"

namespace poise::benchmarks {
namespace {

struct KnownChain {
  int links;
  double pull;  // N
  double sag;   // m
};

constexpr std::array<KnownChain, 5> known_chains = {
    {{10, 0.1629119729685783623960772, 0.3655450362994185025602987},
     {100, 0.1631656429074987037590671, 0.3628087826013003851987068},
     {1000, 0.1631682477742961852678593, 0.3627824511279572329733901},
     {10000, 0.1631682738247173534456845, 0.3627821879004040961014348},
     {100000, 0.163168274085221740463588, 0.3627821852681372700107796}}};

constexpr std::array<double, 3> four_bar_equilibrium = {1.18098097986277511, 0.31112579393843272, 5.3708134990460867};
constexpr std::array<double, 3> toggle_clamp_equilibrium = {1.6337822873154150442, 1.5290625321957552696,
                                                            0.0021924364015421862839};

double largest_difference(const double* angles, const std::array<double, 3>& known) {
  double worst = 0.0;
  for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(angles[k] - known[k]));
  return worst;
}

const KnownChain& known_chain(int links) {
  const auto* found = std::find_if(known_chains.begin(), known_chains.end(),
                                   [&](const KnownChain& chain) { return chain.links == links; });
  if (found == known_chains.end()) throw std::invalid_argument("no reference for a chain of " + std::to_string(links));
  return *found;
}

}  // namespace

double four_bar_error(const double* angles) { return largest_difference(angles, four_bar_equilibrium); }

double toggle_clamp_error(const double* angles) { return largest_difference(angles, toggle_clamp_equilibrium); }

double chain_error(const std::vector<double>& angles) {
  const KnownChain& known = known_chain(static_cast<int>(angles.size()));
  const double length = 1.0 / known.links;
  double reach = 0.0, height = 0.0, lowest = 0.0;
  for (double t : angles) {
    reach += length * std::cos(t);
    height += length * std::sin(t);
    lowest = std::min(lowest, height);
  }
  const double pull = 0.5 * (1.0 - length) / std::tan(std::abs(angles.front()));
  return std::max({std::abs(-lowest - known.sag), std::abs(pull - known.pull), std::abs(reach - comparison::chain_span),
                   std::abs(height)});
}

}  // namespace poise::benchmarks
