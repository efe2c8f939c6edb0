#include "tests/judge/contact_campaign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/judge/chain_of_links.hpp"
#include "tests/judge/courses_in_time.hpp"

namespace poise::judge {
namespace {

using nlohmann::json;
using solvers::RandomStream;

/// A load of which the mechanism knows when it jumps.
Load noted_load(ContactMechanism& mechanism, RandomStream& random, double size) {
  Load out = random_load(random, size, mechanism.duration);
  if (out.course.kind == Course::Kind::step) mechanism.jumps.push_back(out.course.a[2]);
  return out;
}

double some_restitution(RandomStream& random) {
  constexpr std::array choices{0.0, 0.3, 0.8, 1.0};
  return choices[static_cast<std::size_t>(pick(random, 0, 3))];
}

std::string impact_text(const OneSidedContact& contact) {
  std::string out = fmt::format("name = \"{}\"\n", contact.name);
  if (contact.restitution > 0) out += fmt::format("restitution = {:.17g}\n", contact.restitution);
  if (contact.friction > 0) out += fmt::format("friction = {:.17g}\n", contact.friction);
  return out;
}

/// Blocks on a rail, which strike walls and each other. q are their travels.
struct BlocksOnRail : ContactMechanism {
  struct Block {
    double mass = 1.0, stiffness = 0.0, length = 0.0, damping = 0.0;
    Load along{};
  };
  std::vector<Block> blocks;
  struct Between {
    int left = -1, right = -1;  // -1: a wall
    double limit = 0.0;
  };
  std::vector<Between> between;
  std::vector<int> rubbing;

  SmallSquare mass(const Small& q) const override {
    SmallSquare out = SmallSquare::Zero(q.size(), q.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) out(k, k) = blocks[static_cast<std::size_t>(k)].mass;
    return out;
  }
  Small force(double t, double h, const Small& q, const Small& v) const override {
    Small out(q.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const Block& b = blocks[static_cast<std::size_t>(k)];
      out[k] = b.along.mean(t, h) - b.stiffness * (q[k] - b.length) - b.damping * v[k];
    }
    return out;
  }
  double gap(std::size_t contact, double, const Small& q) const override {
    const Between& one = between[contact];
    return (one.right >= 0 ? q[one.right] : 0.0) - (one.left >= 0 ? q[one.left] : 0.0) - one.limit;
  }
  Small row(std::size_t contact, double, const Small& q) const override {
    Small out = Small::Zero(q.size());
    const Between& one = between[contact];
    if (one.right >= 0) out[one.right] = 1.0;
    if (one.left >= 0) out[one.left] = -1.0;
    return out;
  }
  Small rub_row(std::size_t rub, const Small& q) const override { return Small::Unit(q.size(), rubbing[rub]); }

  explicit BlocksOnRail(RandomStream& random) {
    kind = "blocks";
    duration = random.uniform(0.8, 2.0);
    const int n = pick(random, 1, 4);
    scene = "gravity = [0, 0]\n[ground]\npoints = { O = [0, 0] }\n";
    std::string later, starts = "[start]\n";
    for (int k = 0; k < n; ++k) {
      Block b;
      b.mass = random.uniform(0.5, 2.0);
      start.push_back(0.5 * k + random.uniform(-0.1, 0.1));
      start_rates.push_back(chance(random, 0.7) ? random.uniform(-1.0, 1.0) : 0.0);
      if (chance(random, 0.5)) {
        b.stiffness = random.uniform(5.0, 60.0);
        b.length = start.back() + random.uniform(-0.4, 0.4);
      }
      if (chance(random, 0.3)) b.damping = random.uniform(0.1, 1.0);
      if (chance(random, 0.7)) b.along = noted_load(*this, random, 4.0);
      const std::string name = fmt::format("s{}", k + 1);
      scene += fmt::format("[body.b{}]\npoints = {{ C = [0, 0] }}\nmass = {:.17g}\n", k + 1, b.mass);
      later +=
          fmt::format("[[slide]]\nname = \"{}\"\npoints = [\"ground.O\", \"b{}.C\"]\naxis = [1, 0]\n", name, k + 1);
      if (chance(random, 0.3)) {
        rubs.push_back({random.uniform(0.1, 1.5)});
        rubbing.push_back(k);
        later += fmt::format("friction = {{ force = {:.17g} }}\n", rubs.back().bound);
      }
      if (b.stiffness > 0) {
        later += fmt::format("[[spring]]\nslide = \"{}\"\nstiffness = {:.17g}\nfree_length = {:.17g}\n", name,
                             b.stiffness, b.length);
      }
      if (b.damping > 0) later += fmt::format("[[damper]]\nslide = \"{}\"\ncoefficient = {:.17g}\n", name, b.damping);
      if (b.along.size != 0) {
        later += fmt::format("[[force]]\nat = \"b{}.C\"\nvector = [{:.17g}, 0]\n", k + 1, b.along.size) +
                 b.along.course.text();
      }
      starts += fmt::format("{} = {:.17g}\n", name, start.back());
      names.push_back(name);
      blocks.push_back(std::move(b));
    }
    for (int k = 0; k <= n; ++k) {
      if (!chance(random, 0.7) && !(k == n && contacts.empty())) continue;
      OneSidedContact contact{fmt::format("contact {}", k), some_restitution(random), 0.0};
      Between one{k - 1, k < n ? k : -1, 0.0};
      if (k == 0) {
        one.limit = start.front() - random.uniform(0.05, 0.4);
        later += fmt::format("[[stop]]\nslide = \"s1\"\nmin = {:.17g}\n", one.limit);
      } else if (k == n) {
        one.limit = -(start.back() + random.uniform(0.05, 0.4));
        later += fmt::format("[[stop]]\nslide = \"s{}\"\nmax = {:.17g}\n", n, -one.limit);
      } else {
        one.limit = random.uniform(0.05, 0.25);
        later += fmt::format(
            "[[stop]]\nsum = [{{ factor = 1, slide = \"s{}\" }}, {{ factor = -1, slide = \"s{}\" }}]\nmin = {:.17g}\n",
            k + 1, k, one.limit);
      }
      later += impact_text(contact);
      contacts.push_back(std::move(contact));
      between.push_back(one);
    }
    scene += later + starts;
  }
};

/// A chain of links that strikes a floor, a wall, or stops of its pins. q are the angles of the links with the ground.
struct StrikingLinks : ContactMechanism {
  struct Link {
    double length = 1.0, center = 0.5, mass = 1.0, inertia = 0.1, stiffness = 0.0, damping = 0.0, relaxed = 0.0;
    Load turning{};
  };
  struct Limit {
    enum class Of { turn, x, y } of = Of::turn;
    int link = 0;       // angle against the one before
    double sign = 1.0;  // 1: a min
    double value = 0.0;
  };
  std::vector<Link> links;
  std::vector<Limit> limits;
  std::vector<int> rubbing;
  double gravity = 0.0;

  SmallSquare mass(const Small& q) const override { return mass_of_chain<SmallSquare>(links, q); }
  Small force(double t, double h, const Small& q, const Small& v) const override {
    Small out = Small::Zero(q.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      out[i] += links[k].turning.mean(t, h) - gravity * std::cos(q[i]) * moment_of_chain(links, k);
      const double turn = q[i] - (i > 0 ? q[i - 1] : 0.0), turns = v[i] - (i > 0 ? v[i - 1] : 0.0);
      const double torque = links[k].stiffness * (turn - links[k].relaxed) + links[k].damping * turns;
      out[i] -= torque;
      if (i > 0) out[i - 1] += torque;
      take_centrifugal(links, i, q, v, out[i]);
    }
    return out;
  }
  double measured(const Limit& limit, const Small& q) const {
    if (limit.of == Limit::Of::turn) return q[limit.link] - (limit.link > 0 ? q[limit.link - 1] : 0.0);
    double out = 0.0;
    for (int k = 0; k <= limit.link; ++k) {
      const double length = links[static_cast<std::size_t>(k)].length;
      out += length * (limit.of == Limit::Of::x ? std::cos(q[k]) : std::sin(q[k]));
    }
    return out;
  }
  double gap(std::size_t contact, double, const Small& q) const override {
    const Limit& limit = limits[contact];
    return limit.sign * (measured(limit, q) - limit.value);
  }
  Small row(std::size_t contact, double, const Small& q) const override {
    const Limit& limit = limits[contact];
    Small out = Small::Zero(q.size());
    if (limit.of == Limit::Of::turn) {
      out[limit.link] = 1.0;
      if (limit.link > 0) out[limit.link - 1] = -1.0;
    } else {
      for (int k = 0; k <= limit.link; ++k) {
        const double length = links[static_cast<std::size_t>(k)].length;
        out[k] = length * (limit.of == Limit::Of::x ? -std::sin(q[k]) : std::cos(q[k]));
      }
    }
    return limit.sign * out;
  }
  Small rub_row(std::size_t rub, const Small& q) const override {
    const int k = rubbing[rub];
    Small out = Small::Unit(q.size(), k);
    if (k > 0) out[k - 1] = -1.0;
    return out;
  }

  explicit StrikingLinks(RandomStream& random) {
    kind = "links";
    duration = random.uniform(0.8, 1.8);
    const int n = chance(random, 0.45) ? 1 : chance(random, 0.8) ? 2 : 3;
    gravity = chance(random, 0.7) ? earth_gravity : 0.0;
    scene = fmt::format("gravity = [0, {}]\n[ground]\npoints = {{ b = [0, 0] }}\n", -gravity);
    std::string later, starts = "[start]\n";
    Small q(n);
    for (int k = 0; k < n; ++k) {
      Link one;
      one.length = random.uniform(0.3, 0.8);
      one.center = random.uniform(0.2, 0.8) * one.length;
      one.mass = random.uniform(0.3, 1.5);
      one.inertia = random.uniform(0.01, 0.1);
      const double angle = gravity > 0 ? -std::numbers::pi / 2 + random.uniform(-1.0, 1.0) : random.uniform(-0.5, 0.5);
      if (chance(random, gravity > 0 ? 0.3 : 0.8)) {
        one.stiffness = random.uniform(2.0, 20.0);
        one.relaxed = angle - (k > 0 ? q[k - 1] : 0.0) + random.uniform(-0.5, 0.5);
      }
      if (chance(random, 0.3)) one.damping = random.uniform(0.02, 0.2);
      if (chance(random, 0.5)) one.turning = noted_load(*this, random, 4.0);
      q[k] = angle;
      const std::string name = fmt::format("l{}", k + 1), before = k == 0 ? "ground" : fmt::format("l{}", k);
      scene += fmt::format(
          "[body.{}]\npoints = {{ a = [0, 0], b = [{:.17g}, 0] }}\ncenter = [{:.17g}, 0]\nmass = {:.17g}\n"
          "inertia = {:.17g}\n",
          name, one.length, one.center, one.mass, one.inertia);
      starts += fmt::format("{} = {:.17g}\n", name, angle);
      later += fmt::format("[[pin]]\nname = \"P{}\"\npoints = [\"{}.b\", \"{}.a\"]\n", k + 1, before, name);
      if (chance(random, 0.3)) {
        rubs.push_back({random.uniform(0.05, 0.6)});
        rubbing.push_back(k);
        later += fmt::format("friction = {{ torque = {:.17g} }}\n", rubs.back().bound);
      }
      if (one.stiffness > 0) {
        later +=
            fmt::format("[[torsion_spring]]\nbodies = [\"{}\", \"{}\"]\nstiffness = {:.17g}\nfree_angle = {:.17g}\n",
                        before, name, one.stiffness, one.relaxed);
      }
      if (one.damping > 0) {
        later += fmt::format("[[torsion_damper]]\nbodies = [\"{}\", \"{}\"]\ncoefficient = {:.17g}\n", before, name,
                             one.damping);
      }
      if (one.turning.size != 0) {
        later += fmt::format("[[torque]]\non = \"{}\"\nvalue = {:.17g}\n", name, one.turning.size) +
                 one.turning.course.text();
      }
      names.push_back(name);
      start.push_back(angle);
      start_rates.push_back(chance(random, 0.6) ? random.uniform(-2.0, 2.0) : 0.0);
      links.push_back(std::move(one));
    }
    for (int k = pick(random, 1, 2); k-- > 0;) {
      Limit limit;
      limit.of = static_cast<Limit::Of>(pick(random, 0, 2));
      limit.link = limit.of == Limit::Of::turn ? pick(random, 0, n - 1) : n - 1;
      limit.sign = chance(random, 0.5) ? 1.0 : -1.0;
      const bool is_there = std::any_of(limits.begin(), limits.end(), [&](const Limit& other) {
        return other.of == limit.of && other.link == limit.link;
      });
      if (is_there) continue;
      const double far = limit.of == Limit::Of::turn ? random.uniform(0.05, 0.6) : random.uniform(0.01, 0.15);
      limit.value = measured(limit, q) - limit.sign * far;
      OneSidedContact contact{fmt::format("contact {}", k), some_restitution(random), 0.0};
      const std::string of =
          limit.of == Limit::Of::turn
              ? fmt::format("bodies = [\"{}\", \"l{}\"]", limit.link == 0 ? "ground" : fmt::format("l{}", limit.link),
                            limit.link + 1)
              : fmt::format("{} = \"l{}.b\"", limit.of == Limit::Of::x ? "x" : "y", limit.link + 1);
      later += fmt::format("[[stop]]\n{}\n{} = {:.17g}\n", of, limit.sign > 0 ? "min" : "max", limit.value) +
               impact_text(contact);
      contacts.push_back(std::move(contact));
      limits.push_back(limit);
    }
    scene += later + starts;
  }
};

/// A crank, a rod without mass and a slider that strikes a stop. q is the angle of the crank.
struct StrikingCrank : ContactMechanism {
  double r = 0.2, l = 0.5, inertia = 0.1, slider = 1.0, stiffness = 0.0, relaxed = 0.0;
  Load torque{}, push{};
  struct Limit {
    bool is_turn = false;
    double sign = 1.0, value = 0.0;
  };
  std::vector<Limit> limits;

  struct Slope {
    double x, x1, x2;
  };
  Slope slope(double a) const {
    const double s = std::sin(a), c = std::cos(a), root = std::sqrt(l * l - r * r * s * s);
    const double inner1 = -r * r * s * c, inner2 = -r * r * (c * c - s * s);
    return {r * c + root, -r * s + inner1 / root, -r * c + inner2 / root - inner1 * inner1 / (root * root * root)};
  }
  SmallSquare mass(const Small& q) const override {
    const double x1 = slope(q[0]).x1;
    return SmallSquare::Constant(1, 1, inertia + slider * x1 * x1);
  }
  Small force(double t, double h, const Small& q, const Small& v) const override {
    const Slope at = slope(q[0]);
    return Small::Constant(1, torque.mean(t, h) + (push.mean(t, h) - stiffness * (at.x - relaxed)) * at.x1 -
                                  slider * at.x1 * at.x2 * v[0] * v[0]);
  }
  double gap(std::size_t contact, double, const Small& q) const override {
    const Limit& limit = limits[contact];
    return limit.sign * ((limit.is_turn ? q[0] : slope(q[0]).x) - limit.value);
  }
  Small row(std::size_t contact, double, const Small& q) const override {
    const Limit& limit = limits[contact];
    return Small::Constant(1, limit.sign * (limit.is_turn ? 1.0 : slope(q[0]).x1));
  }
  Small rub_row(std::size_t, const Small&) const override { return Small::Constant(1, 1.0); }

  explicit StrikingCrank(RandomStream& random) {
    kind = "slider crank";
    duration = random.uniform(0.8, 2.0);
    r = random.uniform(0.1, 0.3);
    l = r * random.uniform(1.6, 4.0);
    inertia = random.uniform(0.02, 0.2);
    slider = random.uniform(0.5, 2.0);
    const double angle = random.uniform(0.8, 2.2);
    if (chance(random, 0.5)) {
      stiffness = random.uniform(20.0, 200.0);
      relaxed = slope(angle).x + random.uniform(-0.05, 0.05);
    }
    if (chance(random, 0.8)) torque = noted_load(*this, random, 1.5);
    if (torque.size == 0 || chance(random, 0.6)) push = noted_load(*this, random, 8.0);
    scene = fmt::format(
        "gravity = [0, 0]\n[ground]\npoints = {{ O = [0, 0] }}\n"
        "[body.crank]\npoints = {{ O = [0, 0], A = [{:.17g}, 0] }}\ninertia = {:.17g}\n"
        "[body.rod]\npoints = {{ A = [0, 0], B = [{:.17g}, 0] }}\n"
        "[body.slider]\npoints = {{ B = [0, 0] }}\nmass = {:.17g}\n",
        r, inertia, l, slider);
    scene += "[[pin]]\nname = \"O\"\npoints = [\"ground.O\", \"crank.O\"]\n";
    if (chance(random, 0.3)) {
      rubs.push_back({random.uniform(0.02, 0.3)});
      scene += fmt::format("friction = {{ torque = {:.17g} }}\n", rubs.back().bound);
    }
    scene += "[[pin]]\nname = \"A\"\npoints = [\"crank.A\", \"rod.A\"]\n";
    scene += "[[pin]]\nname = \"B\"\npoints = [\"rod.B\", \"slider.B\"]\n";
    scene += "[[slide]]\nname = \"way\"\npoints = [\"ground.O\", \"slider.B\"]\naxis = [1, 0]\n";
    if (stiffness > 0) {
      scene +=
          fmt::format("[[spring]]\nslide = \"way\"\nstiffness = {:.17g}\nfree_length = {:.17g}\n", stiffness, relaxed);
    }
    if (torque.size != 0) {
      scene += fmt::format("[[torque]]\non = \"crank\"\nvalue = {:.17g}\n", torque.size) + torque.course.text();
    }
    if (push.size != 0) {
      scene += fmt::format("[[force]]\nat = \"slider.B\"\nvector = [{:.17g}, 0]\n", push.size) + push.course.text();
    }
    for (int k = pick(random, 1, 2); k-- > 0;) {
      Limit limit;
      limit.is_turn = k == 1;
      limit.sign = chance(random, 0.5) ? 1.0 : -1.0;
      const double far = limit.is_turn ? random.uniform(0.1, 0.7) : random.uniform(0.1, 0.6) * r;
      limit.value = (limit.is_turn ? angle : slope(angle).x) - limit.sign * far;
      OneSidedContact contact{fmt::format("contact {}", k), some_restitution(random), 0.0};
      scene += fmt::format("[[stop]]\n{}\n{} = {:.17g}\n",
                           limit.is_turn ? "bodies = [\"ground\", \"crank\"]" : "slide = \"way\"",
                           limit.sign > 0 ? "min" : "max", limit.value) +
               impact_text(contact);
      contacts.push_back(std::move(contact));
      limits.push_back(limit);
    }
    const double rod = std::asin(-r * std::sin(angle) / l);
    scene += fmt::format("[start]\ncrank = {:.17g}\nrod = {:.17g}\nway = {:.17g}\n", angle, rod, slope(angle).x);
    names = {"crank"};
    start = {angle};
    start_rates = {chance(random, 0.6) ? random.uniform(-3.0, 3.0) : 0.0};
  }
};

/// A point in the plane between a floor, walls and perhaps a rope, on which floor and walls rub. q are x and y.
struct FlyingPoint : ContactMechanism {
  struct Limit {
    enum class Of { x, y, rope } of = Of::y;
    double sign = 1.0, value = 0.0;
  };
  std::vector<Limit> limits;
  double cart = 0.1, ball = 1.0, gravity = earth_gravity, stiffness = 0.0, relaxed = 0.0;
  Load along{}, up{};

  SmallSquare mass(const Small&) const override {
    SmallSquare out = SmallSquare::Zero(2, 2);
    out(0, 0) = cart + ball;
    out(1, 1) = ball;
    return out;
  }
  Small force(double t, double h, const Small& q, const Small&) const override {
    Small out(2);
    out << along.mean(t, h) - stiffness * (q[0] - relaxed), up.mean(t, h) - gravity * ball;
    return out;
  }
  double gap(std::size_t contact, double, const Small& q) const override {
    const Limit& limit = limits[contact];
    if (limit.of == Limit::Of::rope) return limit.value - std::hypot(q[0], q[1]);
    return limit.sign * (q[limit.of == Limit::Of::x ? 0 : 1] - limit.value);
  }
  Small row(std::size_t contact, double, const Small& q) const override {
    const Limit& limit = limits[contact];
    if (limit.of == Limit::Of::rope) return -q / q.norm();
    return limit.sign * Small::Unit(2, limit.of == Limit::Of::x ? 0 : 1);
  }
  Small tangent(std::size_t contact, const Small&) const override {
    return Small::Unit(2, limits[contact].of == Limit::Of::x ? 1 : 0);
  }

  explicit FlyingPoint(RandomStream& random) {
    kind = "point";
    duration = random.uniform(0.8, 2.0);
    cart = random.uniform(0.05, 1.0);
    ball = random.uniform(0.3, 2.0);
    gravity = chance(random, 0.8) ? earth_gravity : 0.0;
    const double x = random.uniform(-0.3, 0.3), y = -random.uniform(0.3, 0.8);
    if (chance(random, 0.4)) {
      stiffness = random.uniform(5.0, 50.0);
      relaxed = x + random.uniform(-0.3, 0.3);
    }
    if (chance(random, 0.6)) along = noted_load(*this, random, 5.0);
    if (chance(random, 0.4)) up = noted_load(*this, random, gravity > 0 ? 8.0 : 4.0);
    scene = fmt::format(
        "gravity = [0, {}]\n[ground]\npoints = {{ O = [0, 0] }}\n[body.cart]\npoints = {{ C = [0, 0] }}\n"
        "mass = {:.17g}\n[body.ball]\npoints = {{ C = [0, 0] }}\nmass = {:.17g}\n"
        "[[slide]]\nname = \"sx\"\npoints = [\"ground.O\", \"cart.C\"]\naxis = [1, 0]\n"
        "[[slide]]\nname = \"sy\"\npoints = [\"cart.C\", \"ball.C\"]\naxis = [0, 1]\n",
        -gravity, cart, ball);
    // The weight of the cart is borne by its slide.
    if (stiffness > 0) {
      scene +=
          fmt::format("[[spring]]\nslide = \"sx\"\nstiffness = {:.17g}\nfree_length = {:.17g}\n", stiffness, relaxed);
    }
    if (along.size != 0) {
      scene += fmt::format("[[force]]\nat = \"ball.C\"\nvector = [{:.17g}, 0]\n", along.size) + along.course.text();
    }
    if (up.size != 0) {
      scene += fmt::format("[[force]]\nat = \"ball.C\"\nvector = [0, {:.17g}]\n", up.size) + up.course.text();
    }
    const bool hangs = chance(random, 0.35);
    if (hangs) {
      Limit rope{Limit::Of::rope, 1.0, std::hypot(x, y) * (chance(random, 0.5) ? 1.0 : random.uniform(1.02, 1.3))};
      OneSidedContact contact{"rope", some_restitution(random), 0.0};
      scene += fmt::format("[[rope]]\nover = [\"ground.O\", \"ball.C\"]\nlength = {:.17g}\n", rope.value) +
               impact_text(contact);
      contacts.push_back(std::move(contact));
      limits.push_back(rope);
    }
    for (int side = 0; side < 3; ++side) {
      if (!chance(random, hangs ? 0.25 : side == 0 ? 0.8 : 0.5) && !(side == 2 && contacts.empty())) continue;
      Limit limit;
      limit.of = side == 0 ? Limit::Of::y : Limit::Of::x;
      limit.sign = side == 2 ? -1.0 : 1.0;
      const double at = side == 0 ? y : x;
      const bool rests = side == 0 && chance(random, 0.3);
      limit.value = at - limit.sign * (rests ? 0.0 : random.uniform(0.02, 0.4));
      OneSidedContact contact{side == 0   ? "floor"
                              : side == 1 ? "left"
                                          : "right",
                              some_restitution(random), chance(random, 0.6) ? random.uniform(0.05, 0.8) : 0.0};
      scene += fmt::format("[[stop]]\n{} = \"ball.C\"\n{} = {:.17g}\n", side == 0 ? "y" : "x",
                           limit.sign > 0 ? "min" : "max", limit.value) +
               impact_text(contact);
      contacts.push_back(std::move(contact));
      limits.push_back(limit);
    }
    scene += fmt::format("[start]\nsx = {:.17g}\nsy = {:.17g}\n", x, y);
    names = {"sx", "sy"};
    start = {x, y};
    start_rates = {chance(random, 0.7) ? random.uniform(-1.5, 1.5) : 0.0, 0.0};
    const bool is_taut = hangs && gap(0, 0.0, Eigen::Vector2d(x, y)) < 1e-9;
    if (is_taut) {
      start_rates[1] = -start_rates[0] * x / y;  // along the circle
      // The length of the file is that of the start but for rounding.
    } else if (chance(random, 0.5) && limits.front().value != y) {
      start_rates[1] = random.uniform(-1.5, 1.5);
    }
  }
};

/// A follower on a cam that it may leave. q is its travel, and before it the angle of a cam that is not driven.
struct LiftingCam : ContactMechanism {
  double base = 0.05, lift = 0.02, rise = 1.0, top = 2.0, fall = 3.0;  // ends of the parts, rad
  double follower = 0.5, inertia = 0.01, gravity = earth_gravity, stiffness = 0.0, relaxed = 0.0, damping = 0.0;
  bool is_driven = true, is_harmonic = false;
  DriveCourse drive{};
  Load turning{};

  struct Share {
    double value, slope;
  };
  Share part(double s) const {
    if (is_harmonic) {
      return {(1 - std::cos(std::numbers::pi * s)) / 2, std::numbers::pi / 2 * std::sin(std::numbers::pi * s)};
    }
    return {s - std::sin(full_turn * s) / full_turn, 1 - std::cos(full_turn * s)};
  }
  Share profile(double angle) const {
    const double a = angle - full_turn * std::floor(angle / full_turn);
    if (a < rise) {
      const Share at = part(a / rise);
      return {at.value, at.slope / rise};
    }
    if (a < top) return {1.0, 0.0};
    if (a < fall) {
      const Share at = part((a - top) / (fall - top));
      return {1 - at.value, -at.slope / (fall - top)};
    }
    return {0.0, 0.0};
  }
  double angle(double t, const Small& q) const { return is_driven ? drive.value_at(t) : q[0]; }
  Eigen::Index travel() const { return is_driven ? 0 : 1; }

  SmallSquare mass(const Small& q) const override {
    SmallSquare out = SmallSquare::Zero(q.size(), q.size());
    if (!is_driven) out(0, 0) = inertia;
    out(travel(), travel()) = follower;
    return out;
  }
  Small force(double t, double h, const Small& q, const Small& v) const override {
    Small out(q.size());
    if (!is_driven) out[0] = turning.mean(t, h);
    const Eigen::Index y = travel();
    out[y] = -gravity * follower - stiffness * (q[y] - relaxed) - damping * v[y];
    return out;
  }
  double gap(std::size_t, double t, const Small& q) const override {
    return q[travel()] - base - lift * profile(angle(t, q)).value;
  }
  Small row(std::size_t, double t, const Small& q) const override {
    Small out = Small::Unit(q.size(), travel());
    if (!is_driven) out[0] = -lift * profile(angle(t, q)).slope;
    return out;
  }
  // The edge of a follower slips on a cam that is not driven along the tangent (-1, -m) of the profile, with the slope
  // m = s' / s of its normal: by 1 / cos of the angle between normal and guide more than along a unit vector, because
  // the force along the guide is less than the normal force by that.
  Small tangent(std::size_t, const Small& q) const override {
    Small out(2);
    out << -q[1], -lift * profile(q[0]).slope / q[1];
    return out;
  }
  double driven_rate(std::size_t, double t, const Small& q) const override {
    return is_driven ? -lift * profile(angle(t, q)).slope * drive.rate_at(t) : 0.0;
  }

  explicit LiftingCam(RandomStream& random) {
    kind = "cam";
    duration = random.uniform(0.3, 1.0);
    lift = random.uniform(0.005, 0.03);
    rise = random.uniform(0.8, 2.0);
    top = rise + (chance(random, 0.5) ? random.uniform(0.1, 0.8) : 0.3);
    fall = top + random.uniform(0.8, 2.0);
    is_harmonic = chance(random, 0.2);
    follower = random.uniform(0.2, 1.0);
    inertia = random.uniform(0.002, 0.02);
    gravity = chance(random, 0.7) ? earth_gravity : 0.0;
    if (gravity == 0.0 || chance(random, 0.7)) {
      stiffness = random.uniform(100.0, 1500.0);
      relaxed = base - random.uniform(0.01, 0.05);
    }
    if (chance(random, 0.4)) damping = random.uniform(0.5, 5.0);
    is_driven = chance(random, 0.7);
    if (is_driven) {
      drive.rate = random.uniform(5.0, 60.0);
      if (chance(random, 0.4)) {
        drive.amplitude = random.uniform(0.1, 0.8);
        drive.frequency = random.uniform(0.5, 3.0);
        drive.phase = random.uniform(-3.0, 3.0);
      }
    } else if (chance(random, 0.7)) {
      turning = noted_load(*this, random, 0.5);
    }
    const double turn = full_turn;
    const char* const law = is_harmonic ? "harmonic" : "cycloidal";
    scene = fmt::format(
        "gravity = [0, {}]\n[ground]\npoints = {{ O = [0, 0] }}\n[body.cam]\npoints = {{ O = [0, 0] }}\n"
        "inertia = {:.17g}\n[body.follower]\npoints = {{ T = [0, 0] }}\nmass = {:.17g}\n"
        "[[pin]]\nname = \"shaft\"\npoints = [\"ground.O\", \"cam.O\"]\n"
        "[[slide]]\nname = \"guide\"\npoints = [\"ground.O\", \"follower.T\"]\naxis = [0, 1]\n",
        -gravity, inertia, follower);
    OneSidedContact contact{"lobe", some_restitution(random), 0.0};
    scene += fmt::format(
        "[[cam]]\nbodies = [\"ground\", \"cam\"]\nfollower = {{ slide = \"guide\" }}\nbase = {:.17g}\nlift = {:.17g}\n"
        "law = [\n  {{ to = {:.17g}, lift = 1, law = \"{}\" }},\n  {{ to = {:.17g}, law = \"dwell\" }},\n"
        "  {{ to = {:.17g}, lift = 0, law = \"{}\" }},\n  {{ to = {:.17g}, law = \"dwell\" }},\n]\n",
        base, lift, rise, law, top, fall, law, turn);
    scene += impact_text(contact);
    contacts.push_back(std::move(contact));
    if (stiffness > 0) {
      scene += fmt::format("[[spring]]\nslide = \"guide\"\nstiffness = {:.17g}\nfree_length = {:.17g}\n", stiffness,
                           relaxed);
    }
    if (damping > 0) scene += fmt::format("[[damper]]\nslide = \"guide\"\ncoefficient = {:.17g}\n", damping);
    if (is_driven) scene += "[[drive]]\nbodies = [\"ground\", \"cam\"]\n" + drive.text();
    if (turning.size != 0) {
      scene += fmt::format("[[torque]]\non = \"cam\"\nvalue = {:.17g}\n", turning.size) + turning.course.text();
    }
    const double above = chance(random, 0.3) ? random.uniform(0.002, 0.02) : 0.0;
    if (!is_driven && chance(random, 0.6)) {
      contacts.back().friction = random.uniform(0.02, 0.4);
      // The small steps have Newton's law, from which others differ where the slip ends within an impact. A stop that
      // is never reached gives it.
      scene += "[[stop]]\nslide = \"guide\"\nmax = 1000\nlaw = \"newton\"\n";
      const std::string key = "[[cam]]\n";
      scene.insert(scene.find(key) + key.size(),
                   fmt::format("roller = \"follower.T\"\nfriction = {:.17g}\n", contacts.back().friction));
    }
    scene += fmt::format("[start]\ncam = 0\nguide = {:.17g}\n", base + above);
    if (is_driven) {
      names = {"guide"};
      start = {base + above};
      start_rates = {0.0};
    } else {
      names = {"cam", "guide"};
      start = {0.0, base + above};
      start_rates = {random.uniform(5.0, 50.0), 0.0};
    }
  }
};

/// A disc that is thrown into a room of four walls, on which it slides and rolls. Its centre of mass may be beside its
/// middle, where nothing rubs. q are the place of its middle and its angle.
struct DiscInRoom : ContactMechanism {
  struct Wall {
    Eigen::Vector2d along, inward;
    double distance = 0.0;  // inward times a point of it
  };
  std::vector<Wall> walls;
  double body = 1.0, radius = 0.1, offset = 0.0, inertia = 0.01, gravity = earth_gravity;
  Load push{}, turning{};

  SmallSquare mass(const Small& q) const override {
    SmallSquare out = SmallSquare::Zero(3, 3);
    out(0, 0) = out(1, 1) = body;
    out(0, 2) = out(2, 0) = -body * offset * std::sin(q[2]);
    out(1, 2) = out(2, 1) = body * offset * std::cos(q[2]);
    out(2, 2) = inertia + body * offset * offset;
    return out;
  }
  Small force(double t, double h, const Small& q, const Small& v) const override {
    Small out(3);
    const double away = body * offset * v[2] * v[2];
    out << push.mean(t, h) + away * std::cos(q[2]), -gravity * body + away * std::sin(q[2]),
        turning.mean(t, h) - gravity * body * offset * std::cos(q[2]);
    return out;
  }
  double gap(std::size_t contact, double, const Small& q) const override {
    const Wall& wall = walls[contact];
    return wall.inward.dot(q.head<2>()) - wall.distance - radius;
  }
  Small row(std::size_t contact, double, const Small&) const override {
    Small out = Small::Zero(3);
    out.head<2>() = walls[contact].inward;
    return out;
  }
  Small tangent(std::size_t contact, const Small&) const override {
    Small out(3);
    out << walls[contact].along, radius;
    return out;
  }

  explicit DiscInRoom(RandomStream& random) {
    kind = "disc";
    duration = random.uniform(0.6, 1.5);
    body = random.uniform(0.3, 2.0);
    radius = random.uniform(0.05, 0.2);
    const double friction = chance(random, 0.6) ? random.uniform(0.05, 0.8) : 0.0;
    if (friction == 0.0) offset = random.uniform(0.0, 0.8) * radius;
    inertia = body * radius * radius * random.uniform(0.3, 0.8);
    gravity = chance(random, 0.8) ? earth_gravity : 0.0;
    if (chance(random, 0.4)) push = noted_load(*this, random, 5.0);
    if (chance(random, 0.4)) turning = noted_load(*this, random, 0.3);
    const std::array<double, 4> x{random.uniform(-0.8, -0.5), random.uniform(0.5, 0.8), random.uniform(0.5, 0.8),
                                  random.uniform(-0.8, -0.5)};
    const std::array<double, 4> y{random.uniform(-0.6, -0.4), random.uniform(-0.6, -0.4), random.uniform(0.4, 0.6),
                                  random.uniform(0.4, 0.6)};
    OneSidedContact contact{"room", some_restitution(random), friction};
    std::string corners;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d from(x[k], y[k]), to(x[(k + 1) % 4], y[(k + 1) % 4]);
      Wall wall;
      wall.along = (to - from).normalized();
      wall.inward = Eigen::Vector2d(-wall.along.y(), wall.along.x());
      wall.distance = wall.inward.dot(from);
      walls.push_back(wall);
      contacts.push_back(contact);
      corners += fmt::format("{}P{} = [{:.17g}, {:.17g}]", k > 0 ? ", " : "", k, x[k], y[k]);
    }
    scene = fmt::format(
        "gravity = [0, {}]\n[ground]\npoints = {{ {} }}\n[body.disc]\npoints = {{ C = [0, 0] }}\nmass = {:.17g}\n"
        "center = [{:.17g}, 0]\ninertia = {:.17g}\n[[contact]]\npoint = \"disc.C\"\nradius = {:.17g}\n"
        "outline = [\"ground.P0\", \"ground.P1\", \"ground.P2\", \"ground.P3\"]\nclosed = true\n",
        -gravity, corners, body, offset, inertia, radius);
    scene += impact_text(contact);
    if (push.size != 0) {
      scene += fmt::format("[[force]]\nat = \"disc.C\"\nvector = [{:.17g}, 0]\n", push.size) + push.course.text();
    }
    if (turning.size != 0) {
      scene += fmt::format("[[torque]]\non = \"disc\"\nvalue = {:.17g}\n", turning.size) + turning.course.text();
    }
    start = {random.uniform(-0.2, 0.2), random.uniform(-0.15, 0.15), random.uniform(-3.0, 3.0)};
    start_rates = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-6.0, 6.0)};
    scene += fmt::format("[start]\nposition = {{ disc = [{:.17g}, {:.17g}] }}\ndisc = {:.17g}\n", start[0], start[1],
                         start[2]);
    names = {"disc.x", "disc.y", "disc"};
  }
};

Small as_small(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

/// Steps of one mechanism.
class Stepper {
 public:
  explicit Stepper(const ContactMechanism& mechanism)
      : m_(mechanism),
        q_(as_small(mechanism.start)),
        v_(as_small(mechanism.start_rates)),
        states_(mechanism.contacts.size() * 2 + mechanism.rubs.size(), 0) {
    for (std::size_t c = 0; c < m_.contacts.size(); ++c) {
      const double rate = m_.row(c, 0.0, q_).dot(v_) + m_.driven_rate(c, 0.0, q_);
      states_[c] = m_.gap(c, 0.0, q_) <= closed_within && std::abs(rate) <= closed_within ? 1 : 0;
    }
  }

  double t() const { return t_; }
  const Small& q() const { return q_; }
  const Small& v() const { return v_; }
  const std::vector<double>& impacts() const { return impacts_; }

  /// Takes a step unless other contacts press or rub in it than in the last one, or one closes, and `is_shortest` is
  /// false.
  bool take(double h, bool is_shortest) {
    const std::size_t n = m_.contacts.size(), rubs = m_.rubs.size();
    const double end = t_ + h, middle = t_ + h / 2;
    const Small half = q_ + h / 2 * v_;
    const Eigen::LLT<SmallSquare> mass(m_.mass(half));
    struct Row {
      enum class Of { normal, tangent, rub } of = Of::normal;
      std::size_t state = 0;    // index of what becomes of it
      std::size_t pressed = 0;  // of a tangent: row of its normal
      Small row{};
      double most = 0.0;
      Small moves{};
      double stiff = 0.0, driven = 0.0, wanted = 0.0, push = 0.0;
    };
    std::vector<Row> rows;
    double struck = 0.0;
    const auto add = [&](Row row) {
      row.moves = mass.solve(row.row);
      row.stiff = row.row.dot(row.moves);
      if (row.stiff > 0) rows.push_back(std::move(row));
    };
    for (std::size_t c = 0; c < n; ++c) {
      const double gap = m_.gap(c, middle, half);
      const bool was_closed = states_[c] != 0;
      if (gap > (was_closed ? kept_within : touched_within)) continue;
      Row normal{.of = Row::Of::normal, .state = c, .row = m_.row(c, middle, half)};
      normal.driven = m_.driven_rate(c, end, half);
      const double before = normal.row.dot(v_) + m_.driven_rate(c, t_, half);
      if (!was_closed && before < 0) {
        normal.wanted = -m_.contacts[c].restitution * before;
        struck = std::max(struck, -before);
      }
      add(std::move(normal));
      if (m_.contacts[c].friction == 0 || rows.empty() || rows.back().state != c) continue;
      add({.of = Row::Of::tangent, .state = n + c, .pressed = rows.size() - 1, .row = m_.tangent(c, half)});
    }
    for (std::size_t k = 0; k < rubs; ++k) {
      add({.of = Row::Of::rub, .state = 2 * n + k, .row = m_.rub_row(k, half), .most = h * m_.rubs[k].bound});
    }
    Small after = v_;
    for (int corrected = 0; corrected < 6; ++corrected) {
      Small now = v_ + mass.solve(Small(h * m_.force(t_, h, half, Small((v_ + after) / 2))));
      for (const Row& row : rows) now += row.push * row.moves;
      for (int sweep = 0; sweep < 500; ++sweep) {
        double changed = 0.0;
        for (Row& row : rows) {
          const double off = row.row.dot(now) + row.driven - row.wanted;
          double push = row.push - off / row.stiff;
          if (row.of == Row::Of::normal) {
            push = std::max(0.0, push);
          } else {
            if (row.of == Row::Of::tangent) row.most = m_.contacts[row.state - n].friction * rows[row.pressed].push;
            push = std::clamp(push, -row.most, row.most);
          }
          changed = std::max(changed, std::abs(push - row.push) * row.stiff);
          now += (push - row.push) * row.moves;
          row.push = push;
        }
        if (changed <= 4e-16 * (1 + now.cwiseAbs().maxCoeff())) break;
      }
      const bool is_settled = (now - after).cwiseAbs().maxCoeff() <= 1e-15 * (1 + now.cwiseAbs().maxCoeff());
      after = now;
      if (is_settled) break;
    }
    std::vector<int> states(states_.size(), 0);
    for (const Row& row : rows) {
      const double rate = row.push * row.stiff;
      if (row.of == Row::Of::normal) {
        states[row.state] = rate > 1e-14 ? 1 : 0;
        continue;
      }
      states[row.state] = row.most <= 0 ? 0 : row.push >= row.most ? 1 : row.push <= -row.most ? -1 : 0;
    }
    const Small next = half + h / 2 * after;
    if (!is_shortest) {
      if (states != states_) return false;
      for (std::size_t c = 0; c < n; ++c) {
        const bool is_row = std::any_of(rows.begin(), rows.end(), [c](const Row& row) { return row.state == c; });
        if (!is_row && m_.gap(c, end, next) < 0) return false;
      }
    }
    q_ = next;
    v_ = after;
    t_ = end;
    // What curvature opens or closes of contacts that last is taken back.
    for (std::size_t c = 0; c < n; ++c) {
      if (states[c] == 0 || states_[c] == 0) continue;
      const Small row = m_.row(c, t_, q_);
      const Small moves = mass.solve(row);
      if (row.dot(moves) > 0) q_ -= m_.gap(c, t_, q_) / row.dot(moves) * moves;
    }
    states_ = std::move(states);
    if (struck > least_impact) impacts_.push_back(t_);
    return true;
  }

 private:
  static constexpr double closed_within = 1e-12;   // at the start, m or rad, and per second
  static constexpr double touched_within = 1e-14;  // rounding: flights that low would have no end
  static constexpr double kept_within = 1e-6;      // of a contact that was closed

  const ContactMechanism& m_;
  double t_ = 0.0;
  Small q_, v_;
  std::vector<int> states_;  // contacts that press; directions in which contacts, and then rubs, slide
  std::vector<double> impacts_;
};

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> split_row(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string one; std::getline(in, one, ',');) out.push_back(one);
  return out;
}

}  // namespace

std::unique_ptr<ContactMechanism> contact_mechanism(std::uint64_t seed) {
  RandomStream random(seed);
  std::unique_ptr<ContactMechanism> out;
  const double which = random.uniform();
  if (which < 0.25)
    out = std::make_unique<BlocksOnRail>(random);
  else if (which < 0.5)
    out = std::make_unique<StrikingLinks>(random);
  else if (which < 0.62)
    out = std::make_unique<StrikingCrank>(random);
  else if (which < 0.85)
    out = std::make_unique<FlyingPoint>(random);
  else if (which < 0.93)
    out = std::make_unique<LiftingCam>(random);
  else
    out = std::make_unique<DiscInRoom>(random);
  out->accuracy = std::pow(10.0, -pick(random, 7, 11));
  return out;
}

SteppedMotion step_motion(const ContactMechanism& mechanism, const StepLengths& lengths,
                          const std::vector<double>& times) {
  SteppedMotion out;
  Stepper stepper(mechanism);
  double h = lengths.longest;
  for (const double time : times) {
    while (time - stepper.t() > lengths.shortest / 2) {
      if (++out.steps > most_steps) {
        out.complete = false;
        return out;
      }
      double until = time;
      for (const double jump : mechanism.jumps) {
        if (jump - stepper.t() > lengths.shortest / 2) until = std::min(until, jump);
      }
      const double left = until - stepper.t();
      const bool ends = h >= left;
      const double now = ends ? left : h;
      if (stepper.take(now, now <= lengths.shortest)) {
        if (!ends) h = std::min(2 * h, lengths.longest);
      } else {
        h = std::max(now / 4, lengths.shortest);
      }
    }
    out.q.push_back(stepper.q());
    out.v.push_back(stepper.v());
  }
  out.impacts = stepper.impacts();
  return out;
}

namespace {

/// What the program writes of a motion.
struct WrittenMotion {
  int exit_code = -1;
  std::string why;  ///< it is not confirmed
  json said;        ///< none where it was refused
  std::vector<double> times;
  std::vector<std::vector<double>> read;  ///< of the coordinates, per time
};

WrittenMotion run_program(const ContactMechanism& mechanism, const std::string& program, const std::string& stem,
                          double duration, int samples) {
  WrittenMotion out;
  std::ofstream(stem + ".toml") << mechanism.scene;
  std::string command = fmt::format(
      "timeout 60 '{0}' motion '{1}.toml' --from start --duration {2:.17g} --rate {3:.17g} "
      "--accuracy {4:g} --csv '{1}.csv' --json '{1}.json'",
      program, stem, duration, samples / duration, mechanism.accuracy);
  for (std::size_t k = 0; k < mechanism.names.size(); ++k) {
    if (mechanism.start_rates[k] == 0) continue;
    command += fmt::format(" --release-rate {}={:.17g}", mechanism.names[k], mechanism.start_rates[k]);
  }
  const int status = std::system((command + fmt::format(" > '{0}.out' 2> '{0}.err'", stem)).c_str());
  out.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (out.exit_code != 0 && out.exit_code != 1) {
    out.why = text_of(stem + ".err");
    return out;
  }
  out.said = json::parse(text_of(stem + ".json"));
  if (!out.said.at("confirmed").get<bool>()) {
    out.why = fmt::format("{}; {}; error {}, of energy {}", out.said.at("status").dump(), out.said.at("why").dump(),
                          out.said.at("error").dump(), out.said.at("energy_error").dump());
  }
  std::istringstream csv(text_of(stem + ".csv"));
  std::string line;
  std::getline(csv, line);
  const std::vector<std::string> header = split_row(line);
  std::vector<std::size_t> columns;
  for (const std::string& name : mechanism.names) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) throw std::runtime_error("no column " + name + " in " + stem + ".csv");
    columns.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  while (std::getline(csv, line)) {
    const std::vector<std::string> row = split_row(line);
    out.times.push_back(std::stod(row.at(0)));
    std::vector<double>& values = out.read.emplace_back();
    for (const std::size_t column : columns) values.push_back(std::stod(row.at(column)));
  }
  return out;
}

/// How far each coordinate moves.
std::vector<double> travels(const std::vector<std::vector<double>>& read) {
  std::vector<double> least = read.front(), most = least;
  for (const std::vector<double>& row : read) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      least[k] = std::min(least[k], row[k]);
      most[k] = std::max(most[k], row[k]);
    }
  }
  for (std::size_t k = 0; k < most.size(); ++k) most[k] -= least[k];
  return most;
}

}  // namespace

WatchedEvents watch_events(std::uint64_t seed, const std::string& program, const std::string& folder, double longer) {
  constexpr int samples = 20'000;
  const std::unique_ptr<ContactMechanism> mechanism = contact_mechanism(seed);
  const WrittenMotion motion = run_program(*mechanism, program, fmt::format("{}/events_{}", folder, seed),
                                           longer * mechanism->duration, samples);
  WatchedEvents out;
  out.kind = mechanism->kind;
  out.exit_code = motion.exit_code;
  out.why = motion.why;
  out.confirmed = motion.exit_code == 0;
  if (!out.confirmed) return out;
  // One side may be given what another has lost where several are hit at a time.
  struct Exchanged {
    double lost = 0.0, size = 0.0;
  };
  std::map<double, Exchanged> exchanged;
  if (motion.said.contains("events")) {
    for (const json& event : motion.said.at("events")) {
      ++out.events;
      if (event.at("what") != "impact") continue;
      ++out.impacts;
      const double before = event.at("rate_before"), after = event.at("rate_after"), impulse = event.at("impulse");
      Exchanged& all = exchanged[event.at("t").get<double>()];
      all.lost += event.at("energy_lost").get<double>();
      all.size += impulse * (std::abs(before) + std::abs(after)) / 2;
    }
  }
  for (const auto& [t, all] : exchanged) {
    if (all.size > 0.0) out.gained = std::max(out.gained, -all.lost / all.size);
  }
  const double error = motion.said.at("error");
  const std::vector<double> travel = travels(motion.read);
  for (std::size_t s = 0; s < motion.times.size(); ++s) {
    const Small q = as_small(motion.read[s]);
    for (std::size_t c = 0; c < mechanism->contacts.size(); ++c) {
      const double gap = mechanism->gap(c, motion.times[s], q);
      if (gap >= 0.0) continue;
      const Small row = mechanism->row(c, motion.times[s], q);
      // The error is an estimate, and rounding of many turns of a cam is in it.
      double allowed = 1e-11;
      for (std::size_t k = 0; k < travel.size(); ++k) {
        allowed += error * travel[k] * std::abs(row[static_cast<Eigen::Index>(k)]);
      }
      if (!(-gap / allowed > out.passed)) continue;
      out.passed = -gap / allowed;
      out.depth = -gap;
      out.where = fmt::format("{} at {:.6g} s", mechanism->contacts[c].name, motion.times[s]);
    }
  }
  return out;
}

JudgedContacts judge_contacts(std::uint64_t seed, const std::string& program, const std::string& folder, double finer) {
  constexpr int samples = 64;
  const std::unique_ptr<ContactMechanism> mechanism = contact_mechanism(seed);
  const WrittenMotion motion =
      run_program(*mechanism, program, fmt::format("{}/contacts_{}", folder, seed), mechanism->duration, samples);
  JudgedContacts out;
  out.kind = mechanism->kind;
  out.exit_code = motion.exit_code;
  out.why = motion.why;
  out.confirmed = !motion.said.is_null() && motion.why.empty();
  if (!out.confirmed) return out;
  out.error = motion.said.at("error").get<double>();
  if (motion.said.contains("events")) {
    for (const json& event : motion.said.at("events")) {
      if (event.value("unique", true)) continue;
      out.until = std::min(out.until.value_or(mechanism->duration), event.at("t").get<double>());
    }
  }
  const std::vector<double>& times = motion.times;
  const std::vector<std::vector<double>>& read = motion.read;
  std::vector<SteppedMotion> judged;
  const double duration = mechanism->duration;
  for (const double shorter : {1.0, 2.0, 4.0}) {
    judged.push_back(step_motion(*mechanism,
                                 {.longest = duration / (2000 * shorter * finer),
                                  .shortest = duration / (1e7 * shorter * shorter * shorter * finer)},
                                 times));
    if (!judged.back().complete) {
      out.why = "the judge took too many steps";
      return out;
    }
  }
  out.judged = true;
  out.impacts = static_cast<int>(judged.back().impacts.size());
  const std::vector<double> travel = travels(read);
  for (std::size_t k = 0; k < travel.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    for (std::size_t s = 0; s < times.size(); ++s) {
      if (out.until && times[s] >= *out.until) break;
      const double finest = judged[2].q[s][i];
      const double apart = std::abs(read[s][k] - finest);
      // Steps in which something changes leave errors that differ in sign from length to length.
      const double unknown =
          std::max({4 * std::abs(finest - judged[1].q[s][i]), std::abs(finest - judged[0].q[s][i]), 1e-10});
      const double beyond = apart / (unknown + out.error * travel[k]);
      if (!(beyond > out.beyond)) continue;
      out.beyond = beyond;
      out.apart = apart;
      out.unknown = unknown;
      out.where = fmt::format("{} at {:.4g} s", mechanism->names[k], times[s]);
    }
  }
  return out;
}

}  // namespace poise::judge
