#pragma once

#include <string>

#include <fmt/format.h>

namespace poise::test {

/// Links of 100 mm that hang between two points, each with its weight, on a circular arc at first.
inline std::string hanging_chain(int links) {
  constexpr double half_turn = 1.1311;  // rad: sin(t) / t is 0.8, the span over the length
  std::string out = fmt::format(
      "title = \"Chain\"\ngravity = [0, -9810]\n[units]\nlength = \"mm\"\nangle = \"rad\"\n[ground]\n"
      "points = {{ L = [0, 0], R = [{}, 0] }}\n",
      80 * links);
  std::string start = "[start]\n";
  for (int k = 0; k < links; ++k) {
    out += fmt::format("[body.link{}]\npoints = {{ a = [0, 0], b = [100, 0] }}\nmass = 1\ncenter = [50, 0]\n", k);
    start += fmt::format("link{} = {:.5f}\n", k, half_turn * ((2.0 * k + 1) / links - 1));
  }
  for (int k = 0; k <= links; ++k) {
    out += fmt::format("[[pin]]\npoints = [\"{}\", \"{}\"]\n", k == 0 ? "ground.L" : fmt::format("link{}.b", k - 1),
                       k == links ? "ground.R" : fmt::format("link{}.a", k));
  }
  return out + start;
}

}  // namespace poise::test
