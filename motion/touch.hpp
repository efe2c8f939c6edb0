#pragma once

namespace poise {

/// A limit of a stop that is reached and kept: its max if `upper`, else its min.
struct Touch {
  int stop = 0;  ///< index into Scene::stops
  bool upper = false;

  bool operator==(const Touch&) const = default;
};

}  // namespace poise
