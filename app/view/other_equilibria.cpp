#include "app/view/other_equilibria.hpp"

#include <utility>

#include <sys/resource.h>

namespace poise::app {
namespace {

std::optional<OtherEquilibria::Found> search(const Scene& scene, long revision, const std::atomic<bool>& interrupt) {
  AllEquilibriaOptions options;
  options.work = 1e6;  // about a second: the mechanism is looked at while it is drawn
  options.starts = 200;
  options.settling = false;
  options.certificate.products = 1e7;
  options.interrupt = &interrupt;
  try {
    const StaticModel model(scene);
    OtherEquilibria::Found out{.revision = revision,
                               .set = all_equilibria(model, options),
                               .poses = {},
                               .scene = scene,
                               .length = model.scales().length};
    if (interrupt) return std::nullopt;
    for (const Equilibrium& equilibrium : out.set.equilibria) out.poses.push_back(model.poses(equilibrium.x));
    return out;
  } catch (const InputError&) {
    return std::nullopt;  // no freedom left: there is no other
  }
}

}  // namespace

OtherEquilibria::~OtherEquilibria() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
    interrupt_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void OtherEquilibria::look_for(Scene scene, long revision) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    interrupt_ = true;
    found_.reset();
    next_ = Job{std::move(scene), revision};
    if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
  }
  changed_.notify_all();
}

void OtherEquilibria::give_up() {
  const std::lock_guard<std::mutex> lock(mutex_);
  interrupt_ = true;
  next_.reset();
}

std::optional<OtherEquilibria::Found> OtherEquilibria::found() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return found_;
}

bool OtherEquilibria::searching() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return next_ || (works_ && !interrupt_);
}

void OtherEquilibria::work() {
  // This thread and those that it starts give way: whoever moves the mechanism meanwhile waits for the others.
  constexpr int lower_priority = 10;
  ::setpriority(PRIO_PROCESS, 0, lower_priority);
  for (;;) {
    Job job;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return ends_ || next_; });
      if (ends_) return;
      job = std::move(*next_);
      next_.reset();
      interrupt_ = false;
      works_ = true;
    }
    std::optional<Found> found = search(job.scene, job.revision, interrupt_);
    const std::lock_guard<std::mutex> lock(mutex_);
    works_ = false;
    if (!interrupt_ && !next_) found_ = std::move(found);
  }
}

}  // namespace poise::app
