#include "tests/support/mixed_mechanisms.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "comparison/random.hpp"
#include "model/scene_builder.hpp"

namespace poise::test {
namespace {

using comparison::Random;
using Keys = std::vector<SceneBuilder::Key>;

constexpr double right_angle = 0.5 * M_PI;

Vec2 at_angle(double angle, double length) { return {length * std::cos(angle), length * std::sin(angle)}; }

class Draw {
 public:
  Draw(const std::string& kind, std::uint64_t seed, std::size_t index)
      : random_(seed * 0x9e3779b97f4a7c15U + 101 + index), builder_(fmt::format("{} {}", kind, seed)) {
    is_round_ = random_.chance(0.5);
    if (!random_.chance(0.15)) builder_.gravity({0.0, is_round_ ? -10.0 : -9.81});
  }

  Scene chain() {
    const int count = 1 + random_.index(3);
    std::string end = "ground.O";
    builder_.ground_point("O", {0.0, 0.0});
    Vec2 at{};
    double before = 0.0;
    for (int i = 1; i <= count; ++i) {
      const std::string name = fmt::format("b{}", i);
      const double length = draw_length();
      const bool slides = random_.chance(0.3);
      const double angle = slides ? before : draw_angle();
      body(name, length, angle, at);
      if (slides) {
        slide(end, name + ".A");
      } else {
        builder_.pin(end, name + ".A");
      }
      joined_.emplace_back(end.substr(0, end.find('.')), name);
      end = name + ".B";
      at += at_angle(angle, length);
      before = angle;
    }
    return finish();
  }

  Scene slider_crank() {
    const Vec2 b = crank();
    const double length = draw_length();
    const double angle = draw_angle();
    const Vec2 c = b + at_angle(angle, length);
    body("coupler", length, angle, b);
    builder_.pin("crank.B", "coupler.A");
    builder_.ground_point("S", c);
    body("block", 0.25, 0.0, c);
    builder_.pin("coupler.B", "block.A");
    slide("ground.S", "block.A");
    joined_.emplace_back("crank", "coupler");
    joined_.emplace_back("coupler", "block");
    return finish();
  }

  Scene slotted_lever() {
    const Vec2 b = crank();
    const Vec2 pivot = draw_pivot(b);
    const double angle = std::atan2(b.y - pivot.y, b.x - pivot.x);
    builder_.ground_point("C", pivot);
    body("lever", draw_length(), angle, pivot);
    builder_.pin("ground.C", "lever.A");
    builder_.pin_in_slot("lever.A", "crank.B", {1.0, 0.0}, "slot");
    const double travel = norm(b - pivot);
    builder_.start("slot", travel);
    travels_.emplace_back("slot", travel);
    joined_.emplace_back("ground", "lever");
    joined_.emplace_back("crank", "lever");
    return finish();
  }

  Scene linkage() {
    const Vec2 b = crank();
    const double length = draw_length();
    const double angle = draw_angle();
    const Vec2 c = b + at_angle(angle, length);
    body("coupler", length, angle, b);
    builder_.pin("crank.B", "coupler.A");
    const Vec2 pivot = draw_pivot(c);
    const Vec2 arm = c - pivot;
    builder_.ground_point("D", pivot);
    body("rocker", norm(arm), std::atan2(arm.y, arm.x), pivot);
    builder_.pin("ground.D", "rocker.A");
    builder_.pin("coupler.B", "rocker.B");
    joined_.emplace_back("crank", "coupler");
    joined_.emplace_back("ground", "rocker");
    return finish();
  }

 private:
  struct Placed {
    std::string name;
    double length = 0.0, angle = 0.0;
    Vec2 at{};
  };

  double draw_length() {
    constexpr double round[] = {0.5, 1.0, 1.0, 1.0, 2.0};
    return is_round_ ? round[random_.index(std::size(round))] : random_.uniform(0.3, 2.0);
  }

  double draw_angle() {
    return is_round_ ? right_angle * (random_.index(4) - 1) + (random_.chance(0.3) ? 0.5 * right_angle : 0.0)
                     : random_.uniform(-M_PI, M_PI);
  }

  double draw_strength() {
    constexpr double round[] = {1.0, 5.0, 10.0, 20.0, 100.0};
    return is_round_ ? round[random_.index(std::size(round))] : std::pow(10.0, random_.uniform(0.0, 2.0));
  }

  // A fixed pivot away from a point.
  Vec2 draw_pivot(Vec2 from) {
    while (true) {
      Vec2 out{random_.uniform(-2.0, 2.0), random_.uniform(-2.0, 2.0)};
      if (is_round_) out = {std::round(out.x), std::round(out.y)};
      if (norm(out - from) > 0.3 && norm(out) > 0.1) return out;
    }
  }

  void body(const std::string& name, double length, double angle, Vec2 at) {
    const double mass = random_.chance(0.85) ? length : 0.0;
    builder_.body(name, {.points = {{"A", {0.0, 0.0}}, {"M", {0.5 * length, 0.0}}, {"B", {length, 0.0}}},
                         .mass = mass,
                         .center = {0.5 * length, 0.0}});
    builder_.start(name, angle);
    bodies_.push_back({name, length, angle, at});
  }

  // On a pivot of the ground; its end.
  Vec2 crank() {
    const double length = draw_length();
    const double angle = draw_angle();
    builder_.ground_point("O", {});
    body("crank", length, angle, {});
    builder_.pin("ground.O", "crank.A");
    joined_.emplace_back("ground", "crank");
    return at_angle(angle, length);
  }

  // A slide that starts without travel, in any direction.
  void slide(const std::string& a, const std::string& b) {
    const std::string name = fmt::format("slide {}", travels_.size());
    builder_.slide(a, b, at_angle(draw_angle(), 1.0), name);
    builder_.start(name, 0.0);
    travels_.emplace_back(name, 0.0);
  }

  // A measure and its value at the start.
  std::pair<MeasureByName, double> draw_measure() {
    const double kind = random_.uniform(0.0, 1.0);
    if (!travels_.empty() && kind < 0.4) {
      const auto& [name, travel] = travels_[static_cast<std::size_t>(random_.index(travels_.size()))];
      return {measures::travel(name), travel};
    }
    if (kind < 0.75) return draw_angle_measure();
    return draw_distance();
  }

  std::pair<MeasureByName, double> draw_angle_measure() {
    const auto& [a, b] = joined_[static_cast<std::size_t>(random_.index(joined_.size()))];
    return {measures::angle(a, b), angle_of(b) - angle_of(a)};
  }

  double angle_of(const std::string& name) const {
    const auto found = std::find_if(bodies_.begin(), bodies_.end(), [&](const Placed& p) { return p.name == name; });
    return found == bodies_.end() ? 0.0 : found->angle;
  }

  // From a point of the ground, or sometimes of another body, to one of a body.
  std::pair<MeasureByName, double> draw_distance() {
    const auto last = static_cast<std::size_t>(random_.index(bodies_.size()));
    const bool is_at_end = random_.chance(0.6);
    const Placed& b = bodies_[last];
    const Vec2 to = b.at + at_angle(b.angle, is_at_end ? b.length : 0.5 * b.length);
    const std::string second = b.name + (is_at_end ? ".B" : ".M");
    if (last >= 2 && random_.chance(0.3)) {
      const Placed& a = bodies_[last - 2];
      return {measures::distance(a.name + ".M", second), norm(to - a.at - at_angle(a.angle, 0.5 * a.length))};
    }
    Vec2 from{random_.uniform(-3.0, 3.0), random_.uniform(-3.0, 3.0)};
    if (is_round_) from = {std::round(from.x), std::round(from.y)};
    const std::string name = fmt::format("F{}", points_++);
    builder_.ground_point(name, from);
    return {measures::distance("ground." + name, second), norm(to - from)};
  }

  std::string draw_acts(double one_way) {
    if (!random_.chance(one_way)) return "both";
    return random_.chance(0.5) ? "tension" : "compression";
  }

  void springs() {
    const int count = random_.index(3);
    for (int k = 0; k < count; ++k) {
      const auto [on, value] = draw_distance();
      const double which = random_.uniform(0.0, 1.0);
      const double free = which < 0.25 ? 0.0 : which < 0.4 ? value : draw_length();
      builder_.element("spring", "", on,
                       {{"stiffness", draw_strength()}, {"free_length", free}, {"acts", draw_acts(0.3)}});
    }
    for (const auto& [name, travel] : travels_) {
      if (!random_.chance(0.6)) continue;
      const double free = random_.chance(0.3) ? travel : random_.uniform(-1.0, 1.0);
      builder_.element("spring", "", measures::travel(name),
                       {{"stiffness", draw_strength()}, {"free_length", free}, {"acts", draw_acts(0.2)}});
    }
    const double some = random_.uniform(0.0, 1.0);
    for (const auto& [a, b] : joined_) {
      if (!random_.chance(some < 0.5 ? 0.0 : some)) continue;
      const double value = angle_of(b) - angle_of(a);
      const double free = random_.chance(0.3) ? value : draw_angle();
      builder_.element("torsion_spring", "", measures::angle(a, b),
                       {{"stiffness", draw_strength()}, {"free_angle", free}, {"acts", draw_acts(0.15)}});
    }
  }

  void stops() {
    const int count = random_.index(4);
    for (int k = 0; k < count; ++k) {
      const auto [on, value] = draw_measure();
      const bool is_distance = on.key == "points";
      const auto away = [&] {
        const double which = random_.uniform(0.0, 1.0);
        return which < 0.15   ? 0.0
               : which < 0.25 ? 1e-3
               : is_round_    ? 0.5 * (1 + random_.index(3))
                              : random_.uniform(0.1, 2.0);
      };
      double min = value - away();
      double max = value + away();
      if (random_.chance(0.05)) min = max = value;
      if (is_distance) {
        min = std::max(min, 0.0);
        max = std::max(max, 1e-3);
      }
      const int limits = random_.index(3);
      Keys keys;
      if (limits != 1 || min == max) keys.emplace_back("min", min);
      if (limits != 2 || min == max) keys.emplace_back("max", max);
      builder_.stop("", on, keys);
    }
  }

  void loads() {
    const int forces = random_.chance(0.35) ? 1 : 0;
    for (int k = 0; k < forces; ++k) {
      const Placed& body = bodies_[static_cast<std::size_t>(random_.index(bodies_.size()))];
      const double strength = draw_strength();
      const Vec2 vector = at_angle(draw_angle(), strength);
      builder_.force("", body.name + ".B", vector, random_.chance(0.25) ? body.name : "");
    }
    if (random_.chance(0.25)) {
      const Placed& body = bodies_[static_cast<std::size_t>(random_.index(bodies_.size()))];
      builder_.torque("", body.name, (random_.chance(0.5) ? 1.0 : -1.0) * (is_round_ ? 5.0 : draw_strength()));
    }
  }

  Scene finish() {
    springs();
    stops();
    loads();
    return builder_.build();
  }

  Random random_;
  SceneBuilder builder_;
  bool is_round_ = false;
  int points_ = 0;
  std::vector<Placed> bodies_;
  std::vector<std::pair<std::string, std::string>> joined_;  // bodies between which angles are measured
  std::vector<std::pair<std::string, double>> travels_;      // joints, and where they start
};

using Make = Scene (Draw::*)();

const std::vector<std::pair<std::string, Make>>& makers() {
  static const std::vector<std::pair<std::string, Make>> all = {{"chain", &Draw::chain},
                                                                {"slider_crank", &Draw::slider_crank},
                                                                {"slotted_lever", &Draw::slotted_lever},
                                                                {"linkage", &Draw::linkage}};
  return all;
}

}  // namespace

const std::vector<std::string>& mixed_kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const auto& maker : makers()) out.push_back(maker.first);
    return out;
  }();
  return names;
}

Scene mixed_mechanism(const std::string& kind, std::uint64_t seed) {
  for (std::size_t k = 0; k < makers().size(); ++k) {
    if (makers()[k].first == kind) return (Draw(kind, seed, k).*makers()[k].second)();
  }
  throw std::invalid_argument("there is no kind of mechanisms \"" + kind + "\"");
}

}  // namespace poise::test
