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

/// Whether two boxes have a point in common.
bool meet(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}

Box box_round(Vec2 middle, double width, double height) {
  return {{middle.x - width / 2, middle.y - height / 2}, {middle.x + width / 2, middle.y + height / 2}};
}

Box grown(const Box& box, double by) { return {{box.low.x - by, box.low.y - by}, {box.high.x + by, box.high.y + by}}; }

}  // namespace

void LabelSetter::add(Vec2 a, Vec2 b, double half_width) {
  Box box;
  box.include(a);
  box.include(b);
  obstacles_.push_back({a, b, half_width, box});
}

void LabelSetter::avoid(Vec2 a, Vec2 b, double width) { add(a, b, width / 2); }

void LabelSetter::avoid(Vec2 centre, double radius) {
  const Vec2 half{radius / 2, 0};
  add(centre - half, centre + half, radius);
}

void LabelSetter::keep_between(double left, double right) {
  left_ = left;
  right_ = right;
}

double LabelSetter::covered(Vec2 a, Vec2 b, double margin) const {
  constexpr int samples = 12;
  Box line;
  line.include(a);
  line.include(b);
  std::vector<const Obstacle*> near;
  for (const Obstacle& o : obstacles_) {
    if (meet(grown(line, o.half_width + margin), o.box)) near.push_back(&o);
  }
  int hits = 0;
  for (int i = 1; i <= samples; ++i) {
    const Vec2 p = a + (static_cast<double>(i) / samples) * (b - a);
    hits += std::any_of(near.begin(), near.end(),
                        [&](const Obstacle* o) { return distance_to_line(p, o->a, o->b) < o->half_width + margin; });
  }
  return norm(b - a) * hits / samples;
}

double LabelSetter::cost(const Box& box, double limit) const {
  double sum = 3.0 * (std::max(0.0, left_ - box.low.x) + std::max(0.0, box.high.x - right_));
  for (const Box& other : labels_) sum += 4.0 * overlap_area(box, other);
  for (const Obstacle& o : obstacles_) {
    if (sum >= limit) break;
    const Box wide = grown(box, o.half_width);
    if (!meet(wide, o.box)) continue;
    const double inside = length_inside(wide, o.a, o.b);
    if (inside > 0) sum += 20.0 + 3.0 * inside;
  }
  return sum;
}

LabelSetter::Place LabelSetter::best_place(const Label& label, double width, double height) const {
  constexpr int directions = 16;
  constexpr std::array<double, 6> distances = {0.0, 8.0, 18.0, 30.0, 46.0, 66.0};
  const double preferred = std::atan2(label.toward.y, label.toward.x);
  std::array<Vec2, directions> units;
  std::array<double, directions> turned;
  for (int k = 0; k < directions; ++k) {
    const double off = std::remainder(2 * M_PI * k / directions, 2 * M_PI);
    units[k] = unit(preferred + off);
    turned[k] = 5.0 * std::abs(off);
  }
  Place best;
  for (double away : distances) {
    for (int k = 0; k < directions; ++k) {
      // What covers nothing costs this much.
      if (1.3 * away + turned[k] >= best.cost) continue;
      const Vec2 u = units[k];
      // The text's own half extent in that direction, so that its nearest edge keeps the gap.
      const Vec2 middle = label.anchor + (label.gap + away) * u + Vec2{u.x * width / 2, u.y * height / 2};
      const Box box = box_round(middle, width, height);
      const double sum = cost(box, best.cost) + 1.3 * away + turned[k];
      if (sum < best.cost) best = {box, away, sum};
    }
  }
  return best;
}

LabelSetter::Place LabelSetter::kept_place(const Label& label, double width, double height) {
  constexpr double worse = 40.0;   // than when the place was chosen: then another is looked for,
  constexpr double better = 25.0;  // which has to be better by so much
  const std::string key = label.item.name + "#" + std::to_string(labels_of_[label.item.name]++);
  const auto before = places_->find(key);
  Place kept;
  if (before != places_->end()) {
    const LabelPlace& place = before->second;
    const Box box = box_round(label.anchor + place.offset, width, height);
    const Vec2 preferred = (label.gap + place.away) * label.toward;
    const double turned = std::abs(
        std::remainder(std::atan2(place.offset.y, place.offset.x) - std::atan2(preferred.y, preferred.x), 2 * M_PI));
    kept = {box, place.away, cost(box, std::numeric_limits<double>::infinity()) + 1.3 * place.away + 5.0 * turned};
    if (kept.cost < place.cost + worse) return kept;
  }
  Place best = best_place(label, width, height);
  if (best.cost > kept.cost - better) best = kept;
  (*places_)[key] = {best.box.middle() - label.anchor, best.away, best.cost};
  return best;
}

void LabelSetter::set(Canvas& canvas, Label label) {
  const double width = text_width(label.text, label.style.size);
  const double height = 1.15 * label.style.size;
  const Place place = places_ != nullptr ? kept_place(label, width, height) : best_place(label, width, height);
  const Box& best = place.box;
  canvas.item(std::move(label.item.name), std::move(label.item.state));
  if (place.away > 20.0) {
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
