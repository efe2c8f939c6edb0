#include "app/commands/drive_option.hpp"

#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "model/named_number.hpp"
#include "model/quantity.hpp"

namespace poise::app {

DriveRange read_drive(const std::string& text, const Scene& scene) {
  const std::string expected = "NAME=FROM..TO, say crank=0..360";
  const NamedText given = read_named_text("--drive", text, expected);
  const std::string_view range = given.text;
  const std::size_t dots = range.find("..");
  const std::optional<double> from = read_number(range.substr(0, dots));
  const std::optional<double> to = dots == std::string_view::npos ? from : read_number(range.substr(dots + 2));
  if (!from || !to || !std::isfinite(*from) || !std::isfinite(*to)) {
    throw InputError(fmt::format("--drive {}: \"{}\" is no range of numbers; expected {}", text, range, expected));
  }
  const double unit = unit_value(quantity_of(find_drive(scene, given.name).on), scene.units);
  return {given.name, *from * unit, *to * unit};
}

}  // namespace poise::app
