#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "model/scene.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/tracking/tracked_equilibrium.hpp"

namespace poise::app {

/// Looks for all equilibria of a scene in a thread of its own, so that nobody waits for them.
class OtherEquilibria {
 public:
  struct Found {
    long revision = 0;
    EquilibriumSet set;
    std::vector<BodyPoses> poses;  ///< of each equilibrium of the set
    Scene scene;
    double length = 1.0;  ///< m: of the mechanism
  };

  OtherEquilibria() = default;
  ~OtherEquilibria();
  OtherEquilibria(const OtherEquilibria&) = delete;
  OtherEquilibria& operator=(const OtherEquilibria&) = delete;

  /// Looks for those of this scene; what is being looked for is given up. `revision` is the caller's.
  void look_for(Scene scene, long revision);
  /// Looks for none until it is asked again: the processors are wanted elsewhere. What was found stays.
  void give_up();
  /// What was found last; empty while it is looked for.
  std::optional<Found> found() const;
  bool searching() const;

 private:
  struct Job {
    Scene scene;
    long revision = 0;
  };
  void work();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Job> next_;
  std::optional<Found> found_;
  std::atomic<bool> interrupt_ = false;
  bool works_ = false;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace poise::app
