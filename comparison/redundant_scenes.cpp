#include "comparison/redundant_scenes.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "comparison/random.hpp"
#include "model/read_scene.hpp"

namespace poise::comparison {
namespace {

std::string body(Random& random, const std::string& name, double length, const std::string& more = "") {
  const double mass = random.uniform(0.5, 3), inertia = mass * length * length * random.uniform(0.05, 0.15);
  const double beside = random.uniform(-0.1, 0.1) * length, along = random.uniform(0.3, 0.7) * length;
  return fmt::format(
      "[body.{}]\npoints = {{ a = [0, 0], b = [{:.17g}, 0]{} }}\nmass = {:.17g}\ncenter = [{:.17g}, {:.17g}]\n"
      "inertia = {:.17g}\n",
      name, length, more, mass, along, beside, inertia);
}

std::string pin(const std::string& a, const std::string& b) {
  return fmt::format("[[pin]]\npoints = [\"{}\", \"{}\"]\n", a, b);
}

std::string parallelogram(Random& random) {
  const double crank = random.uniform(0.3, 1.5), width = random.uniform(0.5, 2), middle = random.uniform(0.1, 0.9);
  const double angle = random.uniform(0.3, 2.8);
  std::string out = fmt::format("[ground]\npoints = {{ p1 = [0, 0], p2 = [{:.17g}, 0], p3 = [{:.17g}, 0] }}\n",
                                middle * width, width) +
                    body(random, "table", width, fmt::format(", m = [{:.17g}, 0]", middle * width));
  std::string joints, start = "[start]\ntable = 0\n";
  const std::string ends[] = {"a", "m", "b"};
  for (int k = 1; k <= 3; ++k) {
    out += body(random, fmt::format("c{}", k), crank);
    joints += pin(fmt::format("ground.p{}", k), fmt::format("c{}.a", k)) +
              pin(fmt::format("c{}.b", k), "table." + ends[k - 1]);
    start += fmt::format("c{} = {:.17g}\n", k, angle);
  }
  return out + joints + start;
}

// Columns k = 1, 2 of crossed bars; the left end of the lowest rising bar is pinned, the other slides.
std::string scissors(Random& random) {
  const int stages = 1 + random.index(3);
  const double bar = random.uniform(0.5, 1.5), apart = random.uniform(1, 2) * bar, angle = random.uniform(0.4, 1.1);
  const std::string middle = fmt::format(", m = [{:.17g}, 0]", bar / 2);
  std::string out = fmt::format("[ground]\npoints = {{ p1 = [0, 0], p2 = [{:.17g}, 0] }}\n", apart);
  out += body(random, "table", apart);
  std::string joints, start = "[start]\ntable = 0\n";
  for (int k = 1; k <= 2; ++k) {
    std::string left = fmt::format("ground.p{}", k), right;
    const std::string foot = left, top = k == 1 ? "table.a" : "table.b";
    const auto slot = [&](const std::string& on, const std::string& point, const std::string& name) {
      start += fmt::format("{}{} = {:.17g}\n", name, k, bar * std::cos(angle));
      return fmt::format("[[pin_in_slot]]\nname = \"{}{}\"\npoints = [\"{}\", \"{}\"]\naxis = [1, 0]\n", name, k, on,
                         point);
    };
    for (int stage = 1; stage <= stages; ++stage) {
      const std::string rise = fmt::format("r{}{}", k, stage), fall = fmt::format("f{}{}", k, stage);
      const std::string falling = body(random, fall, bar, middle);
      out += body(random, rise, bar, middle) + falling;
      start += fmt::format("{} = {:.17g}\n{} = {:.17g}\n", rise, angle, fall, M_PI - angle);
      joints += pin(left, rise + ".a") + pin(rise + ".m", fall + ".m") +
                (stage == 1 ? slot(foot, fall + ".a", "foot") : pin(right, fall + ".a"));
      left = fall + ".b";
      right = rise + ".b";
    }
    joints += pin(left, top) + slot(top, right, "top");
  }
  return out + joints + start;
}

std::string four_bar(Random& random) {
  const double crank = random.uniform(0.5, 1.2), coupler = random.uniform(2.6, 3.2), rocker = random.uniform(2, 2.6);
  const double angle = random.uniform(0.3, 2.8), bx = crank * std::cos(angle), by = crank * std::sin(angle);
  const double dx = 3 - bx, dy = -by, d = std::hypot(dx, dy);
  const double along = (d * d + coupler * coupler - rocker * rocker) / (2 * d);
  const double across = (random.chance(0.5) ? 1 : -1) * std::sqrt(coupler * coupler - along * along);
  const double cx = bx + (along * dx - across * dy) / d, cy = by + (along * dy + across * dx) / d;
  const std::string twice[] = {pin("crank.b", "coupler.a"), pin("coupler.b", "rocker.b")};
  const std::string& again = twice[random.index(2)];
  const std::string third = body(random, "rocker", rocker), second = body(random, "coupler", coupler);
  const std::string first = body(random, "crank", crank);
  return "[ground]\npoints = { p1 = [0, 0], p2 = [3, 0] }\n" + first + second + third + pin("ground.p1", "crank.a") +
         twice[0] + twice[1] + pin("ground.p2", "rocker.a") + again +
         fmt::format("[start]\ncrank = {:.17g}\ncoupler = {:.17g}\nrocker = {:.17g}\n", angle,
                     std::atan2(cy - by, cx - bx), std::atan2(cy, cx - 3));
}

}  // namespace

Scene redundant_scene(std::uint64_t seed) {
  Random random(seed);
  const int kind = random.index(3);
  return parse_scene("gravity = [0, -9.81]\n" + (kind == 0   ? parallelogram(random)
                                                 : kind == 1 ? scissors(random)
                                                             : four_bar(random)),
                     fmt::format("redundant {}", seed));
}

}  // namespace poise::comparison
