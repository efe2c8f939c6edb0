#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "motion/periodic_response.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::app {

/// What `poise response` was asked, and found.
struct ResponseAnswer {
  Excitation excitation;
  SoughtQuantity of;
  Equilibrium equilibrium;                          ///< of statics; not looked for with controllers
  std::optional<ControlLoop> loop;                  ///< of a scene with controllers or blades
  std::unique_ptr<const FrequencyResponse> linear;  ///< null without an equilibrium
  double from = 0.0, to = 0.0;                      ///< Hz
  std::vector<double> frequency;
  std::vector<std::complex<double>> value;  ///< per SI unit of the excitation; not a number where unbounded
  std::vector<Resonance> resonances;
  std::complex<double> at_rest;  ///< at f = 0
  double amplitude = 0.0;        ///< of the excitation, SI
  std::vector<double> at;        ///< frequencies at which all periodic motions are wanted
  std::optional<PeriodicResponse> periodic;

  bool has_equilibrium() const { return loop ? loop->known : equilibrium.found(); }
  bool is_stable() const;
  bool is_answered() const;
};

/// What `poise response` shows. `scene` is the one with its functions of time.
Result response_result(const Scene& scene, const ResponseAnswer& answer, const std::vector<std::string>& settings);

/// Amplitude and phase over the frequency.
std::vector<Panel> response_panels(const Units& units, const ResponseAnswer& answer);

}  // namespace poise::app
