#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "statics/model/virtual_work.hpp"

namespace poise::python {

/// The equations of a scene and their workspace, which is used under its mutex.
class SystemObject {
 public:
  /// Throws InputError as VirtualWork does.
  SystemObject(std::shared_ptr<const StaticModel> model, std::vector<TouchedLimit> touched)
      : work_(std::move(model), std::move(touched)) {}

  int coordinates() const { return work_.coordinates(); }
  int rows() const { return work_.rows(); }
  int stops() const { return static_cast<int>(work_.stops().size()); }
  std::mutex& mutex() { return mutex_; }
  VirtualWork& work() { return work_; }
  const VirtualWork& work() const { return work_; }

 private:
  std::mutex mutex_;
  VirtualWork work_;
};

}  // namespace poise::python
