#include "studies/fingerprint.hpp"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>

#include <boost/crc.hpp>
#include <fmt/format.h>

#include "model/input_error.hpp"

namespace poise::studies {

std::string fingerprint(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& words) {
  constexpr std::uint64_t all = std::numeric_limits<std::uint64_t>::max();
  boost::crc_optimal<64, 0x42F0E1EBA9EA3693, all, all, true, true> crc;
  const auto add = [&](const std::string& text) { crc.process_bytes(text.c_str(), text.size() + 1); };
  for (const std::filesystem::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    add({std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()});
    if (!in) throw InputError(fmt::format("{}: expected a file that can be read", file.string()));
  }
  for (const std::string& word : words) add(word);
  return fmt::format("{:016x}", crc.checksum());
}

}  // namespace poise::studies
