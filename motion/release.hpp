#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "motion/motion_record.hpp"
#include "motion/simulate.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise {

/// The pose that a motion leaves.
struct MotionOrigin {
  enum class Kind {
    start,        ///< the start of the scene, its loops closed
    equilibrium,  ///< the equilibrium sought from there
    unloaded,     ///< the start, because no coordinate has a load and each pose is an equilibrium
    not_found     ///< the search for the equilibrium failed
  };
  Kind kind = Kind::start;
  std::string why{};                       ///< not_found: one sentence
  std::optional<Stability> stability{};    ///< equilibrium: what it is
  std::optional<std::vector<double>> q{};  ///< equilibrium: closed coordinates, SI
  bool found() const { return kind != Kind::not_found; }
};

/// The equilibrium that the mechanism settles in from the start of the scene, or another one near it, drives left out.
MotionOrigin equilibrium_origin(const MotionModel& model, Seek seek = Seek::settle,
                                const std::atomic<bool>* interrupt = nullptr);

/// A change of what moves, or a rate.
struct Displacement {
  Channel channel;
  bool is_rate = false;
  double value = 0.0;  ///< SI: counted from the origin, or per second
};

/// The state in which a motion starts: the origin, where the drives begin, and from there displaced; rates not given
/// are zero. Throws InputError where a displacement cannot be had, as start_motion().
MotionState release(const MotionModel& model, const MotionOrigin& origin, const std::vector<Displacement>& displaced);

}  // namespace poise
