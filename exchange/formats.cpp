#include "exchange/formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "exchange/pmks_text.hpp"
#include "model/nearest_name.hpp"

namespace poise {
namespace {

constexpr std::array all_formats{FileFormat{.name = "pmks-text",
                                            .ending = "txt",
                                            .what = "list of joints, as PMKS has it: links, R, P or RP, x, y",
                                            .read = import_pmks_text}};

std::string lower(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return text;
}

}  // namespace

std::span<const FileFormat> formats() { return all_formats; }

const FileFormat& readable_format(const std::string& file, const std::string& name) {
  const std::string ending = lower(std::filesystem::path(file).extension().string());
  std::vector<std::string> names, endings;
  for (const FileFormat& format : all_formats) {
    if (format.read == nullptr) continue;
    if (name.empty() ? ending == '.' + std::string(format.ending) : name == format.name) return format;
    names.emplace_back(format.name);
    endings.push_back('.' + std::string(format.ending));
  }
  if (!name.empty()) {
    throw InputError(fmt::format("--format: expected one of {}, found \"{}\"{}", fmt::join(names, ", "), name,
                                 did_you_mean(name, names)));
  }
  throw InputError(
      fmt::format("{}: expected a file that ends with {}; say what it is by --format", file, fmt::join(endings, ", ")));
}

}  // namespace poise
