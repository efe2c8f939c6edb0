#include "benchmarks/mujoco_model.hpp"

#include <array>
#include <cstring>
#include <memory>
#include <stdexcept>

namespace poise::benchmarks {

mjModel* mujoco_model(const std::string& mjcf) {
  mju_user_warning = [](const char*) {};  // else they go to a file in the directory at hand
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(mjcf.size()));
  std::memcpy(files->filedata[0], mjcf.data(), mjcf.size());
  std::array<char, 500> error{};
  mjModel* const model = mj_loadXML("scene.xml", files.get(), error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::invalid_argument(error.data());
  return model;
}

}  // namespace poise::benchmarks
