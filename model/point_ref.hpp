#pragma once

namespace poise {

/// A point of a body: indices into Scene::bodies and Body::points.
struct PointRef {
  int body = 0;
  int point = 0;

  friend bool operator==(const PointRef&, const PointRef&) = default;
};

}  // namespace poise
