#include "app/terminal/poise_folder.hpp"

#include <system_error>

namespace poise::app {
namespace fs = std::filesystem;

std::optional<fs::path> poise_folder() {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  for (const fs::path& folder :
       {(program.parent_path() / POISE_INSTALLED_FOLDER).lexically_normal(), fs::path(POISE_SOURCE_FOLDER)}) {
    if (folder.is_absolute() && fs::is_directory(folder / "docs", unknown) &&
        fs::is_directory(folder / "datasets", unknown)) {
      return folder;
    }
  }
  return std::nullopt;
}

}  // namespace poise::app
