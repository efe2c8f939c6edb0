#include "app/draw/labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

// Length of the part of the line from a to b that lies inside the box.
double length_inside(const Box& box, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  double enter = 0.0;
  double leave = 1.0;
  const std::array<std::array<double, 4>, 2> axes = {
      {{a.x, d.x, box.low.x, box.high.x}, {a.y, d.y, box.low.y, box.high.y}}};
  for (const auto& [start, step, low, high] : axes) {
    if (step == 0.0) {
      if (start < low || start > high) return 0.0;
      continue;
    }
    const double to_low = (low - start) / step;
    const double to_high = (high - start) / step;
    enter = std::max(enter, std::min(to_low, to_high));
    leave = std::min(leave, std::max(to_low, to_high));
  }
  return enter < leave ? (leave - enter) * norm(d) : 0.0;
}

double overlap_area(const Box& a, const Box& b) {
  const double width = std::min(a.high.x, b.high.x) - std::max(a.low.x, b.low.x);
  const double height = std::min(a.high.y, b.high.y) - std::max(a.low.y, b.low.y);
  return width > 0 && height > 0 ? width * height : 0.0;
}

Box grown(const Box& box, double by) { return {{box.low.x - by, box.low.y - by}, {box.high.x + by, box.high.y + by}}; }

}  // namespace

void LabelSetter::avoid(Vec2 a, Vec2 b, double width) { obstacles_.push_back({a, b, width / 2}); }

void LabelSetter::avoid(Vec2 centre, double radius) {
  const Vec2 half{radius / 2, 0};
  obstacles_.push_back({centre - half, centre + half, radius});
}

void LabelSetter::keep_between(double left, double right) {
  left_ = left;
  right_ = right;
}

double LabelSetter::covered(Vec2 a, Vec2 b, double margin) const {
  constexpr int samples = 12;
  int hits = 0;
  for (int i = 1; i <= samples; ++i) {
    const Vec2 p = a + (static_cast<double>(i) / samples) * (b - a);
    hits += std::any_of(obstacles_.begin(), obstacles_.end(),
                        [&](const Obstacle& o) { return distance_to_line(p, o.a, o.b) < o.half_width + margin; });
  }
  return norm(b - a) * hits / samples;
}

double LabelSetter::cost(const Box& box) const {
  double sum = 3.0 * (std::max(0.0, left_ - box.low.x) + std::max(0.0, box.high.x - right_));
  for (const Box& other : labels_) sum += 4.0 * overlap_area(box, other);
  for (const Obstacle& o : obstacles_) {
    const double inside = length_inside(grown(box, o.half_width), o.a, o.b);
    if (inside > 0) sum += 20.0 + 3.0 * inside;
  }
  return sum;
}

void LabelSetter::set(Canvas& canvas, Label label) {
  constexpr int directions = 16;
  constexpr std::array<double, 6> distances = {0.0, 8.0, 18.0, 30.0, 46.0, 66.0};
  const double width = text_width(label.text, label.style.size);
  const double height = 1.15 * label.style.size;
  const double preferred = std::atan2(label.toward.y, label.toward.x);
  double best_cost = std::numeric_limits<double>::infinity();
  Box best;
  double best_distance = 0.0;
  for (double away : distances) {
    for (int k = 0; k < directions; ++k) {
      const double off = std::remainder(2 * M_PI * k / directions, 2 * M_PI);
      const Vec2 u = unit(preferred + off);
      // The text's own half extent in that direction, so that its nearest edge keeps the gap.
      const Vec2 middle = label.anchor + (label.gap + away) * u + Vec2{u.x * width / 2, u.y * height / 2};
      const Box box{{middle.x - width / 2, middle.y - height / 2}, {middle.x + width / 2, middle.y + height / 2}};
      const double sum = cost(box) + 1.3 * away + 5.0 * std::abs(off);
      if (sum < best_cost) {
        best_cost = sum;
        best = box;
        best_distance = away;
      }
    }
  }
  if (best_distance > 20.0) {
    const Vec2 near{std::clamp(label.anchor.x, best.low.x, best.high.x),
                    std::clamp(label.anchor.y, best.low.y, best.high.y)};
    const double length = norm(near - label.anchor);
    if (length > label.gap) {
      const Vec2 begin = label.anchor + (label.gap / length) * (near - label.anchor);
      canvas.line(begin, near, {.stroke = ink::free_stop, .width = 0.7});
    }
  }
  label.style.align = Align::middle;
  canvas.text({best.middle().x, best.high.y - 0.28 * label.style.size}, label.text, label.style);
  labels_.push_back(grown(best, 1.5));
}

}  // namespace poise::app
