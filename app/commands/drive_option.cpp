#include "app/commands/drive_option.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace poise::app {
namespace {

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stopped != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

DriveRange read_drive(const std::string& text, const Scene& scene) {
  const std::size_t equals = text.rfind('=');
  const std::string expected = "; expected NAME=FROM..TO, say crank=0..360";
  if (equals == std::string::npos) throw InputError(fmt::format("--drive {}: there is no \"=\"{}", text, expected));
  const std::string_view range = std::string_view(text).substr(equals + 1);
  const std::size_t dots = range.find("..");
  const auto from = number(range.substr(0, dots));
  const auto to = dots == std::string_view::npos ? from : number(range.substr(dots + 2));
  if (!from || !to) throw InputError(fmt::format("--drive {}: \"{}\" is no range of numbers{}", text, range, expected));
  DriveRange out{text.substr(0, equals), 0.0, 0.0};
  const double unit = unit_value(quantity_of(find_drive(scene, out.name).on), scene.units);
  out.from = *from * unit;
  out.to = *to * unit;
  return out;
}

}  // namespace poise::app
