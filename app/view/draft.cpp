#include "app/view/draft.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/terminal/output_file.hpp"
#include "model/input_error.hpp"

namespace poise::app {

std::vector<std::filesystem::path> Draft::possible_files() const {
  constexpr int most = 9;
  std::vector<std::filesystem::path> out{scene_.string() + ".draft"};
  for (int k = 2; k <= most; ++k) out.emplace_back(fmt::format("{}.draft{}", scene_.string(), k));
  return out;
}

std::vector<std::filesystem::path> Draft::left_behind() const {
  std::error_code unknown;
  std::vector<std::filesystem::path> out;
  for (std::filesystem::path& file : possible_files()) {
    if (std::filesystem::is_regular_file(file, unknown) && !HeldFile::is_held(file)) out.push_back(std::move(file));
  }
  return out;
}

void Draft::take_over(const std::filesystem::path& file, const std::string& text) {
  file_ = file;
  text_ = text;
  held_.hold(file);
  taken_over_ = true;
}

void Draft::keep(const std::string& text) {
  if (text == text_) return;
  if (text_.empty()) {
    std::error_code unknown;
    const std::vector<std::filesystem::path> files = possible_files();
    auto own = std::find_if(files.begin(), files.end(),
                            [&](const auto& file) { return !std::filesystem::exists(file, unknown); });
    if (own == files.end())
      own = std::find_if(files.begin(), files.end(), [](const auto& file) { return !HeldFile::is_held(file); });
    if (own == files.end()) return;
    file_ = *own;
  }
  try {
    OutputFile out(file_, "draft");
    out.prepare(text);
    out.commit();
    text_ = text;
    held_.hold(file_);  // it is another file each time
  } catch (const InputError&) {
    // The page asks before it is closed.
  }
}

void Draft::remove() {
  std::error_code ignored;
  if (!text_.empty()) std::filesystem::remove(file_, ignored);
  held_.let_go();
  text_.clear();
  taken_over_ = false;
}

bool Draft::has_company() {
  if (shown_.is_shared()) return true;
  const std::vector<std::filesystem::path> files = possible_files();
  return std::any_of(files.begin(), files.end(), [&](const std::filesystem::path& file) {
    return !(file == file_ && !text_.empty()) && HeldFile::is_held(file);
  });
}

}  // namespace poise::app
