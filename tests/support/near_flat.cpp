#include "tests/support/near_flat.hpp"

#include <array>
#include <cmath>
#include <variant>

#include <fmt/format.h>

#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::test {
namespace near_flat_mechanisms {

using Wide = Planar<Real50>;

Wide wide(double x, double y) { return {Real50(x), Real50(y)}; }

// w and its derivatives by each freedom; second derivatives mix no two.
struct Placed50 {
  Wide value;
  std::vector<Wide> first, second;
};

Placed50 placed(const CrankPoint& point, const std::vector<Real50>& t) {
  Placed50 out{point.constant, std::vector<Wide>(t.size()), std::vector<Wide>(t.size())};
  for (const CrankPoint::Phasor& p : point.phasors) {
    const auto k = static_cast<std::size_t>(p.freedom);
    const Real50 angle = p.sign * t[k];
    const Wide w = p.arm * Wide{cos(angle), sin(angle)};
    out.value += w;
    out.first[k] += Real50(p.sign) * quarter_turn(w);
    out.second[k] -= w;
  }
  return out;
}

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  NearFlat make() {
    const double unit = std::array{1.0, 0.001, 0.0254}[static_cast<std::size_t>(random_.index(3))];
    out_.size = unit * rounded(random_.uniform(0.2, 3.0));
    off_ = std::pow(10.0, random_.uniform(std::log10(3e-4), std::log10(0.05))) * (random_.chance(0.5) ? 1 : -1);
    if (random_.chance(0.4)) off_ += M_PI;
    switch (random_.index(3)) {
      case 0:
        out_.kind = "parallelogram";
        ladder(1);
        break;
      case 1:
        out_.kind = "ladder";
        ladder(2 + random_.index(2));
        break;
      default:
        out_.kind = "scissors";
        scissors();
    }
    balance();
    return out_;
  }

 private:
  // Three digits, as people write numbers.
  static double rounded(double value) { return std::round(1000 * value) / 1000; }

  double length() { return out_.size * rounded(random_.uniform(0.3, 2.0)); }

  // Stages of equal parallel cranks, one upon the other, along a line through the world's origin.
  void ladder(int stages) {
    Scene& scene = out_.scene;
    out_.flat = random_.chance(0.5) ? 0.0 : random_.uniform(-M_PI, M_PI);
    const Vec2 along{std::cos(out_.flat), std::sin(out_.flat)};
    const int cranks = 3 + random_.index(3);
    std::vector<double> places{0.0};
    for (int k = 1; k < cranks; ++k) {
      const double apart = random_.chance(0.3) ? 0.01 : rounded(random_.uniform(0.1, 2.0));
      places.push_back(places.back() + out_.size * apart);
    }
    std::string below = "ground";
    for (int k = 0; k < cranks; ++k) {
      const double d = places[static_cast<std::size_t>(k)];
      scene.add_point(0, fmt::format("P{}", k), {d * along.x, d * along.y});
    }
    CrankPoint middle;
    for (int s = 0; s < stages; ++s) {
      const double reach = s == 0 ? out_.size : length();
      const std::string platform = fmt::format("platform{}", s);
      const double angle =
          out_.flat + off_ * (s == 0 ? 1.0 : random_.uniform(0.3, 2.0)) + (random_.chance(0.3) ? M_PI : 0);
      for (int k = 0; k < cranks; ++k) {
        const std::string crank = fmt::format("crank{}{}", s, k);
        const int body = add_link(scene, crank, reach);
        if (k == 0) {
          out_.cranks.push_back(body);
          at_.push_back(angle);
        }
        scene.start.angle[body] = angle;
        add_pin(scene, fmt::format("{}.P{}", below, k), crank + ".a");
      }
      const int body = scene.add_body(platform);
      scene.start.angle[body] = out_.flat;
      for (int k = 0; k < cranks; ++k) {
        scene.add_point(body, fmt::format("P{}", k), {places[static_cast<std::size_t>(k)], 0.0});
        add_pin(scene, fmt::format("crank{}{}.b", s, k), fmt::format("{}.P{}", platform, k));
      }
      below = platform;
      middle.phasors.push_back({s, 1, wide(reach, 0.0)});
      // The platform turns by nothing: its origin moves.
      carried_.push_back({body, middle});
    }
    // A spring in line with the crank needs no torque.
    in_line_ = stages == 1 && random_.chance(0.4);
  }

  // Two pairs of crossed bars under one platform.
  void scissors() {
    Scene& scene = out_.scene;
    const double apart = length();
    const double reach = out_.size;
    const int platform = scene.add_body("platform");
    scene.start.angle[platform] = 0.0;
    const double angle = off_;
    for (int k = 0; k < 2; ++k) {
      const std::string rise = fmt::format("rise{}", k);
      const std::string fall = fmt::format("fall{}", k);
      const std::string foot = fmt::format("ground.P{}", k);
      const std::string top = fmt::format("platform.P{}", k);
      scene.add_point(0, fmt::format("P{}", k), {k * apart, 0.0});
      scene.add_point(platform, fmt::format("P{}", k), {k * apart, 0.0});
      const int rising = add_link(scene, rise, reach);
      const int falling = add_link(scene, fall, reach);
      if (k == 0) out_.cranks.push_back(rising);
      scene.start.angle[rising] = angle;
      scene.start.angle[falling] = M_PI - angle;
      add_pin(scene, foot, rise + ".a");
      add_pin(scene, rise + ".m", fall + ".m");
      const int slot = add_pin_in_slot(scene, foot, fall + ".a", {1.0, 0.0});
      add_pin(scene, fall + ".b", top);
      const int upper = add_pin_in_slot(scene, top, rise + ".b", {1.0, 0.0});
      scene.start.travel[slot] = reach * std::cos(angle);
      scene.start.travel[upper] = reach * std::cos(angle);
    }
    at_.push_back(angle);
    // y = reach sin t, x of a foot = reach cos t.
    CrankPoint lifted;
    lifted.phasors = {{0, 1, wide(0.5 * reach, 0.0)}, {0, -1, wide(-0.5 * reach, 0.0)}};
    carried_.push_back({platform, lifted});
    CrankPoint sliding;
    sliding.phasors = {{0, 1, wide(0.5 * reach, 0.0)}, {0, -1, wide(0.5 * reach, 0.0)}};
    carried_.push_back({out_.cranks[0] + 1, sliding});
  }

  // Springs to random places, a force, and what torques then balance it; it starts a little aside.
  void balance() {
    Scene& scene = out_.scene;
    const double stiffness = std::pow(10.0, random_.uniform(0.0, 5.0));
    const int springs = in_line_ ? 1 : 1 + random_.index(3);
    for (int k = 0; k < springs; ++k) {
      const Carried& on = carried_[static_cast<std::size_t>(random_.index(carried_.size()))];
      const bool slides = on.body != carried_.front().body && out_.kind == "scissors";
      const std::string name = fmt::format("S{}", k);
      const double k_spring = stiffness * rounded(random_.uniform(0.2, 3.0));
      const double free = out_.size * rounded(random_.uniform(0.0, 1.5));
      Vec2 foot{out_.size * rounded(random_.uniform(-3.0, 3.0)), out_.size * rounded(random_.uniform(-2.0, 2.0))};
      if (in_line_) {
        const double far = out_.size * (1.0 + rounded(random_.uniform(0.3, 2.0)));
        foot = {far * std::cos(at_[0]), far * std::sin(at_[0])};
      }
      const PointRef from = scene.add_point(0, name, foot);
      PointRef to;
      if (slides)
        to = point(scene, "fall0.a");
      else
        to = scene.add_point(on.body, name, {0.0, 0.0});
      CrankPoint way = on.at;
      way.constant -= wide(foot.x, foot.y);
      out_.springs.push_back(way);
      scene.elements.push_back(line_spring(name, from, to, k_spring, free));
    }
    if (!in_line_ && random_.chance(0.5)) {
      const Carried& on = carried_.front();
      const double push = stiffness * out_.size;
      const Vec2 force{push * rounded(random_.uniform(-1.0, 1.0)), push * rounded(random_.uniform(-1.0, 1.0))};
      scene.add_point(on.body, "F", {0.0, 0.0});
      add_force(scene, scene.bodies[static_cast<std::size_t>(on.body)].name + ".F", force, "F");
      out_.push = on.at;
    }
    out_.torques.assign(at_.size(), 0.0);
    const NearFlat::Derivatives now = out_.derivatives({at_.begin(), at_.end()});
    for (std::size_t f = 0; f < at_.size() && !in_line_; ++f) {
      Torque torque;
      torque.name = fmt::format("T{}", f);
      torque.body = out_.cranks[f];
      torque.value = static_cast<double>(now.first[static_cast<Eigen::Index>(f)]);
      out_.torques[f] = torque.value;
      scene.torques.push_back(torque);
    }
    const double aside = random_.uniform(-0.3, 0.3) * std::abs(std::sin(off_));
    for (auto& angle : scene.start.angle) {
      if (angle && *angle != out_.flat) *angle += aside;
    }
  }

  struct Carried {
    int body;
    CrankPoint at;  // its origin
  };
  Random random_;
  NearFlat out_;
  double off_ = 0.0;
  bool in_line_ = false;
  std::vector<double> at_;
  std::vector<Carried> carried_;
};

}  // namespace near_flat_mechanisms

NearFlat::Derivatives NearFlat::derivatives(const std::vector<Real50>& t) const {
  using near_flat_mechanisms::placed;
  const auto n = static_cast<Eigen::Index>(t.size());
  Derivatives out{decltype(out.first)::Zero(n), decltype(out.second)::Zero(n, n)};
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const auto& law = std::get<LinearSpring>(scene.elements[s].law);
    const auto w = placed(springs[s], t);
    const Real50 g = norm(w.value);
    std::vector<Real50> by(t.size());
    for (std::size_t i = 0; i < t.size(); ++i) by[i] = dot(w.value, w.first[i]) / g;
    const Real50 force = law.stiffness * (g - law.free_length);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto a = static_cast<std::size_t>(i);
      out.first[i] += force * by[a];
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto b = static_cast<std::size_t>(j);
        const Real50 second =
            (dot(w.first[a], w.first[b]) + (i == j ? dot(w.value, w.second[a]) : Real50(0))) / g - by[a] * by[b] / g;
        out.second(i, j) += law.stiffness * by[a] * by[b] + force * second;
      }
    }
  }
  for (const Force& load : scene.forces) {
    const Planar<Real50> f{Real50(load.vector.x), Real50(load.vector.y)};
    const auto w = placed(push, t);
    for (Eigen::Index i = 0; i < n; ++i) {
      out.first[i] -= dot(f, w.first[static_cast<std::size_t>(i)]);
      out.second(i, i) -= dot(f, w.second[static_cast<std::size_t>(i)]);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) out.first[i] -= torques[static_cast<std::size_t>(i)];
  return out;
}

Real50 NearFlat::tension(int spring, const std::vector<Real50>& t) const {
  const auto s = static_cast<std::size_t>(spring);
  const auto& law = std::get<LinearSpring>(scene.elements[s].law);
  return law.stiffness * (norm(near_flat_mechanisms::placed(springs[s], t).value) - law.free_length);
}

NearFlat near_flat(std::uint64_t seed) { return near_flat_mechanisms::Maker(seed).make(); }

}  // namespace poise::test
