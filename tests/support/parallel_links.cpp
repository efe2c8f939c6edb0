#include "tests/support/parallel_links.hpp"

#include <cmath>

#include <fmt/format.h>

namespace poise::test {

std::string three_links(double shorter, double angle, double push) {
  const auto body = [](const std::string& name, const std::string& points) {
    return fmt::format("[body.{}]\npoints = {{ {} }}\nmass = 1\ncenter = [0.5, 0]\ninertia = 0.5\n", name, points);
  };
  const auto pin = [](int k, const char* name, const std::string& a, const std::string& b) {
    return fmt::format("[[pin]]\nname = \"{}{}\"\npoints = [\"{}{}\", \"{}\"]\n", name, k, a, k, b);
  };
  std::string text =
      fmt::format("gravity = [{}, -9.81]\n[ground]\npoints = {{ P1 = [0, 0], P2 = [1, 0], P3 = [2, 0] }}\n", push) +
      body("bed", fmt::format("T1 = [0, 0], T2 = [{}, {}], T3 = [2, 0]", 1 - shorter * std::cos(angle),
                              -shorter * std::sin(angle)));
  std::string start = "[start]\nbed = 0\n";
  for (int k = 1; k <= 3; ++k) {
    const std::string link = fmt::format("l{}", k);
    text += body(link, fmt::format("A = [0, 0], T = [{}, 0]", k == 2 ? 1 - shorter : 1.0)) +
            pin(k, "A", "ground.P", link + ".A") + pin(k, "B", "bed.T", link + ".T");
    start += fmt::format("{} = {}\n", link, angle);
  }
  return text + start;
}

}  // namespace poise::test
