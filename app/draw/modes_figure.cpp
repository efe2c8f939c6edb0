#include "app/draw/modes_figure.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/draw/followed.hpp"
#include "motion/given_motion.hpp"

namespace poise::app {
namespace {

constexpr std::size_t frames_of_mode = 24;

/// Coordinates, SI, displaced by a part of a shape.
std::vector<double> displaced(std::vector<double> q, const Vibration& mode, std::complex<double> by) {
  for (std::size_t i = 0; i < mode.shape.size(); ++i) q[i] += (by * mode.shape[i]).real();
  return q;
}

/// The factor of a shape at which some point moves by 8 % of the mechanism's size, or some body turns by 0.4 rad.
double amplitude_of(const MotionModel& model, const std::vector<double>& q, const Vibration& mode) {
  constexpr double part = 0.08, largest_turn = 0.4, little = 1e-6;
  const Scene& scene = model.scene();
  const Poses before = model.poses(model.from_si(q));
  Box box;
  double turn = 0.0, way = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < mode.shape.size(); ++i) {
    const bool is_angle = static_cast<int>(i) < model.layout().angles;
    largest = std::max(largest, std::abs(mode.shape[i]) / (is_angle ? 1.0 : model.scales().length));
  }
  if (largest == 0.0) return 0.0;
  const double step = little / largest;
  for (const std::complex<double> phase : {std::complex<double>(1, 0), std::complex<double>(0, 1)}) {
    const Poses after = model.poses(model.from_si(displaced(q, mode, step * phase)));
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      turn = std::max(turn, std::abs(after[i].angle - before[i].angle));
      for (const NamedPoint& p : scene.bodies[i].points) {
        box.include(before[i].world(p.at));
        way = std::max(way, norm(after[i].world(p.at) - before[i].world(p.at)));
      }
    }
  }
  const double size = std::max(box.width(), box.height());
  double factor = way > 0.0 ? part * size / way : 1e300;
  if (turn > 0.0) factor = std::min(factor, largest_turn / turn);
  return factor < 1e300 ? factor * step : 0.0;
}

/// One swing with closed loops; the amplitude is halved where they cannot be closed. Empty where that does not help.
std::vector<std::vector<double>> swing(const MotionModel& model, const std::vector<double>& q, const Vibration& mode) {
  constexpr int attempts = 5;
  double amplitude = amplitude_of(model, q, mode);
  for (int attempt = 0; attempt < attempts && amplitude > 0.0; ++attempt, amplitude /= 2) {
    std::vector<double> time;
    std::vector<SampledCoordinate> samples(static_cast<std::size_t>(model.layout().kept));
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].coordinate = static_cast<int>(i);
    for (std::size_t k = 0; k < frames_of_mode; ++k) {
      const double phase = 2 * M_PI * static_cast<double>(k) / frames_of_mode;
      // From the middle outwards.
      const std::vector<double> there = displaced(q, mode, std::polar(amplitude, phase - M_PI_2));
      time.push_back(static_cast<double>(k));
      for (std::size_t i = 0; i < samples.size(); ++i) samples[i].value.push_back(there[i]);
    }
    try {
      return complete_motion(model, time, samples).x;
    } catch (const InputError&) {
      continue;  // too far from where loops close
    }
  }
  return {};
}

std::string caption_of(std::size_t k, const Vibration& mode) {
  switch (mode.kind) {
    case Vibration::Kind::oscillates:
    case Vibration::Kind::flutters:
    case Vibration::Kind::decays:
      break;
    case Vibration::Kind::neutral:
      return fmt::format("mode {}: neutral", k + 1);
    case Vibration::Kind::diverges:
      return fmt::format("mode {}: diverges", k + 1);
  }
  return fmt::format("mode {}: {} Hz{}", k + 1, significant(mode.frequency, 3),
                     mode.kind == Vibration::Kind::flutters ? ", flutters"
                     : mode.kind == Vibration::Kind::decays ? ", decays without oscillation"
                                                            : "");
}

}  // namespace

Figure modes_figure(const MotionModel& model, const std::vector<double>& x, const Modes& modes, bool confirmed) {
  constexpr std::size_t most = 6;
  constexpr double seconds_of_mode = 2.0;
  if (!modes.known || x.empty()) return {};
  const std::vector<double> q = model.to_si(x);
  const Poses still = model.poses(x);
  Play play{.label = "mode"};
  std::vector<Position> positions;
  std::size_t drawn = 0;
  for (std::size_t k = 0; k < std::min(most, modes.vibrations.size()); ++k) {
    const Vibration& mode = modes.vibrations[k];
    const std::vector<std::vector<double>> poses = swing(model, q, mode);
    if (poses.empty()) continue;
    ++drawn;
    const std::string caption = caption_of(k, mode);
    play.marks.push_back({positions.size(), std::to_string(k + 1), caption});
    for (std::size_t i = 0; i < poses.size(); ++i) {
      Position& position = positions.emplace_back();
      position.scene = &model.scene();
      position.picture = {.poses = model.poses(poses[i]), .heading = caption, .confirmed = confirmed, .loads = false};
      position.picture.others.push_back({"equilibrium", still});
      const bool grows = mode.kind == Vibration::Kind::diverges || mode.kind == Vibration::Kind::flutters;
      position.tone = grows ? Tone::bad : Tone::plain;
      play.values.push_back(static_cast<double>(k + 1) + static_cast<double>(i) / frames_of_mode);
    }
  }
  if (positions.empty()) return {};
  play.seconds = seconds_of_mode * static_cast<double>(drawn);
  Figure figure{.title = "Shapes of the modes, magnified"};
  animate(figure, std::move(positions), std::move(play), "The mechanism as it swings in each mode", {});
  return figure;
}

}  // namespace poise::app
