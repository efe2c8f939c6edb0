#include "model/dimension.hpp"

#include <cstdlib>

namespace poise {

std::string Dimension::unit_name(const Units& u) const {
  std::string above, below;
  const auto add = [&](const std::string& name, int power) {
    if (power == 0) return;
    const std::string factor = name + (std::abs(power) == 2   ? "²"
                                       : std::abs(power) == 3 ? "³"
                                       : std::abs(power) == 4 ? "⁴"
                                                              : "");
    if (power > 0)
      above += (above.empty() ? "" : " ") + factor;
    else
      below += "/" + factor;
  };
  add(u.mass_name, mass);
  add(u.force_name, force);
  add(u.length_name, length);
  add(u.angle_name, angle);
  add("s", time);
  return above.empty() && !below.empty() ? "1" + below : above + below;
}

}  // namespace poise
