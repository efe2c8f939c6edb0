#include "tests/judge/rubbing_campaign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "motion/confirmed_motion.hpp"
#include "motion/motion_record.hpp"
#include "tests/judge/chain_of_links.hpp"
#include "tests/judge/courses_in_time.hpp"

namespace poise::judge {
namespace {

using solvers::RandomStream;

/// Blocks that slide along x on the ground, on each other or on a driven belt. q are their travels.
struct Blocks : RubbingMechanism {
  struct Block {
    int on = -1;  // another block, -1 the ground, -2 the belt
    double mass = 1.0, stiffness = 0.0, length = 0.0, damping = 0.0;
    double force = 0.0, coefficient = 0.0;
    Load along{}, down{};
  };
  std::vector<Block> blocks;
  std::vector<int> rubs;      // the block of each contact
  std::vector<Few> carries;   // place of a block by q
  std::vector<bool> on_belt;  // at the bottom of its pile
  DriveCourse belt{};

  FewByFew mass(const Few& q) const override {
    FewByFew out = FewByFew::Zero(q.size(), q.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) out += blocks[k].mass * carries[k] * carries[k].transpose();
    return out;
  }
  Few force(double t, double h, const Few& q, const Few& v) const override {
    Few out = Few::Zero(q.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const Block& b = blocks[k];
      double along = b.along.mean(t, h);
      if (on_belt[k]) along -= b.mass * belt.acceleration_at(t + h / 2);
      out += along * carries[k];
      out[i] -= b.stiffness * (q[i] - b.length) + b.damping * v[i];
    }
    return out;
  }
  Few row(int contact, const Few& q) const override {
    return Few::Unit(q.size(), rubs[static_cast<std::size_t>(contact)]);
  }
  double driven_rate(int, double) const override { return 0.0; }
  double bound(int contact, double t) const override {
    const auto of = static_cast<std::size_t>(rubs[static_cast<std::size_t>(contact)]);
    double normal = 0.0;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const double borne = blocks[k].mass * earth_gravity + blocks[k].down.mean(t, 0.0);
      normal += carries[k][static_cast<Eigen::Index>(of)] * borne;
    }
    return blocks[of].force + blocks[of].coefficient * std::abs(normal);
  }

  explicit Blocks(RandomStream& random) {
    kind = "blocks";
    duration = random.uniform(1.0, 3.0);
    const int n = pick(random, 1, 4);
    const bool has_belt = chance(random, 0.3), grips = chance(random, 0.3);
    if (has_belt) belt = DriveCourse::random(random, duration);
    scene = fmt::format("gravity = [0, {}]\n[ground]\npoints = {{ O = [0, 0] }}\n", -earth_gravity);
    if (has_belt) {
      scene +=
          "[body.belt]\npoints = { C = [0, 0] }\nmass = 1\n[[slide]]\nname = \"sbelt\"\n"
          "points = [\"ground.O\", \"belt.C\"]\naxis = [1, 0]\n";
      if (chance(random, 0.5)) scene += "friction = { force = 0.5 }\n";
      scene += "[[drive]]\nslide = \"sbelt\"\n" + belt.text();
    }
    std::string later;
    for (int k = 0; k < n; ++k) {
      Block b;
      b.on = chance(random, 0.5) ? pick(random, -1, k - 1) : -1;
      if (b.on == -1 && has_belt && chance(random, 0.6)) b.on = -2;
      b.mass = random.uniform(0.5, 2.0);
      if (chance(random, 0.5)) {
        b.stiffness = random.uniform(5.0, 60.0);
        b.length = chance(random, 0.5) ? 0.0 : random.uniform(-0.05, 0.05);
      }
      if (chance(random, 0.3)) b.damping = random.uniform(0.1, 1.0);
      if (chance(random, 0.85)) b.force = random.uniform(0.1, 1.5);
      if (grips && chance(random, 0.7)) b.coefficient = random.uniform(0.02, 0.2);
      if (chance(random, 0.8)) b.along = random_load(random, 4.0, duration);
      if (grips && chance(random, 0.5)) b.down = random_load(random, chance(random, 0.8) ? 5.0 : 25.0, duration);
      const std::string on = b.on == -1 ? "ground.O" : b.on == -2 ? "belt.C" : fmt::format("b{}.C", b.on + 1);
      const std::string name = fmt::format("b{}", k + 1);
      scene += fmt::format("[body.{}]\npoints = {{ C = [0, 0] }}\nmass = {:.17g}\n", name, b.mass);
      later += fmt::format("[[slide]]\nname = \"s{}\"\npoints = [\"{}\", \"{}.C\"]\naxis = [1, 0]\n", k + 1, on, name);
      if (b.coefficient > 0) {
        later += fmt::format("friction = {{ coefficient = {:.17g}, force = {:.17g} }}\n", b.coefficient, b.force);
      } else if (b.force > 0) {
        later += fmt::format("friction = {{ force = {:.17g} }}\n", b.force);
      }
      if (b.stiffness > 0) {
        later += fmt::format("[[spring]]\nslide = \"s{}\"\nstiffness = {:.17g}\nfree_length = {:.17g}\n", k + 1,
                             b.stiffness, b.length);
      }
      if (b.damping > 0) later += fmt::format("[[damper]]\nslide = \"s{}\"\ncoefficient = {:.17g}\n", k + 1, b.damping);
      if (b.along.size != 0) {
        later += fmt::format("[[force]]\nat = \"{}.C\"\nvector = [{:.17g}, 0]\n", name, b.along.size) +
                 b.along.course.text();
      }
      if (b.down.size != 0) {
        later +=
            fmt::format("[[force]]\nat = \"{}.C\"\nvector = [0, {:.17g}]\n", name, -b.down.size) + b.down.course.text();
      }
      Few carried = b.on >= 0 ? carries[static_cast<std::size_t>(b.on)] : Few(Few::Zero(n));
      carried[k] = 1.0;
      carries.push_back(carried);
      on_belt.push_back(b.on == -2 || (b.on >= 0 && on_belt[static_cast<std::size_t>(b.on)]));
      if (b.force > 0 || b.coefficient > 0) rubs.push_back(k);
      names.push_back(fmt::format("s{}", k + 1));
      start.push_back(0.0);
      start_rates.push_back(0.0);
      blocks.push_back(std::move(b));
    }
    contacts = static_cast<int>(rubs.size());
    scene += later;
  }
};

/// Wheels on one axle, with springs and friction between any two of them, perhaps several of one pair, or the ground.
struct Wheels : RubbingMechanism {
  struct Pair {
    int a = -1, b = 0;  // -1: the ground, -2: the driven wheel
    double stiffness = 0.0, torque = 0.0;
  };
  std::vector<double> inertia, damping;
  std::vector<Load> loads;
  std::vector<Pair> springs, rubs;
  bool has_driven = false;
  DriveCourse driven{};

  FewByFew mass(const Few& q) const override {
    FewByFew out = FewByFew::Zero(q.size(), q.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) out(k, k) = inertia[static_cast<std::size_t>(k)];
    return out;
  }
  Few force(double t, double h, const Few& q, const Few& v) const override {
    Few out = Few::Zero(q.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      out[k] = loads[i].mean(t, h) - damping[i] * v[k];
    }
    for (const Pair& one : springs) {
      const double torque = one.stiffness * (q[one.b] - (one.a < 0 ? 0.0 : q[one.a]));
      out[one.b] -= torque;
      if (one.a >= 0) out[one.a] += torque;
    }
    return out;
  }
  Few row(int contact, const Few& q) const override {
    const Pair& one = rubs[static_cast<std::size_t>(contact)];
    Few out = Few::Unit(q.size(), one.b);
    if (one.a >= 0) out[one.a] = -1.0;
    return out;
  }
  double driven_rate(int contact, double t) const override {
    return rubs[static_cast<std::size_t>(contact)].a == -2 ? driven.rate_at(t) : 0.0;
  }
  double bound(int contact, double) const override { return rubs[static_cast<std::size_t>(contact)].torque; }

  explicit Wheels(RandomStream& random) {
    kind = "wheels";
    duration = random.uniform(1.0, 3.0);
    const int n = pick(random, 1, 4);
    has_driven = chance(random, 0.5);
    scene = "[ground]\npoints = { O = [0, 0] }\n";
    std::string later;
    const auto name_of = [](int k) {
      return k == -1 ? std::string("ground") : k == -2 ? std::string("driven") : fmt::format("w{}", k + 1);
    };
    if (has_driven) {
      driven = DriveCourse::random(random, duration);
      scene += "[body.driven]\npoints = { O = [0, 0] }\ninertia = 1\n";
      later +=
          "[[pin]]\nname = \"Pdriven\"\npoints = [\"ground.O\", \"driven.O\"]\n[[drive]]\n"
          "bodies = [\"ground\", \"driven\"]\n" +
          driven.text();
      if (chance(random, 0.3)) later += "[[friction]]\nbodies = [\"ground\", \"driven\"]\ntorque = 0.3\nwidth = 0\n";
    }
    for (int k = 0; k < n; ++k) {
      inertia.push_back(random.uniform(0.3, 2.0));
      damping.push_back(chance(random, 0.3) ? random.uniform(0.05, 0.5) : 0.0);
      loads.push_back(chance(random, 0.8) ? random_load(random, 4.0, duration) : Load{});
      scene += fmt::format("[body.w{}]\npoints = {{ O = [0, 0] }}\ninertia = {:.17g}\n", k + 1, inertia.back());
      later += fmt::format("[[pin]]\nname = \"P{0}\"\npoints = [\"ground.O\", \"w{0}.O\"]\n", k + 1);
      if (chance(random, 0.5)) {
        rubs.push_back({-1, k, 0.0, random.uniform(0.1, 1.2)});
        later += fmt::format("friction = {{ torque = {:.17g} }}\n", rubs.back().torque);
      }
      if (damping.back() > 0) {
        later += fmt::format("[[torsion_damper]]\nbodies = [\"ground\", \"w{}\"]\ncoefficient = {:.17g}\n", k + 1,
                             damping.back());
      }
      if (loads.back().size != 0) {
        later += fmt::format("[[torque]]\non = \"w{}\"\nvalue = {:.17g}\n", k + 1, loads.back().size) +
                 loads.back().course.text();
      }
      names.push_back(name_of(k));
      start.push_back(0.0);
      start_rates.push_back(0.0);
    }
    const auto some_pair = [&](bool with_driven) {
      Pair out;
      out.b = pick(random, 0, n - 1);
      out.a = with_driven && has_driven && chance(random, 0.4) ? -2 : pick(random, -1, n - 1);
      if (out.a == out.b) out.a = -1;
      return out;
    };
    for (int k = pick(random, 0, n); k-- > 0;) {
      Pair one = some_pair(false);
      one.stiffness = random.uniform(3.0, 50.0);
      later += fmt::format("[[torsion_spring]]\nbodies = [\"{}\", \"{}\"]\nstiffness = {:.17g}\n", name_of(one.a),
                           name_of(one.b), one.stiffness);
      springs.push_back(one);
    }
    for (int k = pick(random, rubs.empty() ? 1 : 0, 3); k-- > 0;) {
      Pair one = some_pair(true);
      one.torque = random.uniform(0.1, 1.2);
      later += fmt::format("[[friction]]\nbodies = [\"{}\", \"{}\"]\ntorque = {:.17g}\nwidth = 0\n", name_of(one.a),
                           name_of(one.b), one.torque);
      rubs.push_back(one);
    }
    contacts = static_cast<int>(rubs.size());
    scene += later;
  }
};

/// A chain of links, each with friction in its pin. q are the angles of the links with the ground.
struct Links : RubbingMechanism {
  struct Link {
    double length = 1.0, center = 0.5, mass = 1.0, inertia = 0.1, torque = 0.0, stiffness = 0.0;
    Load turning{};
  };
  std::vector<Link> links;
  std::vector<int> rubs;
  double gravity = 0.0;
  Load pull{};  // at the last tip, along x

  FewByFew mass(const Few& q) const override { return mass_of_chain<FewByFew>(links, q); }
  Few force(double t, double h, const Few& q, const Few& v) const override {
    Few out = Few::Zero(q.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      out[i] += links[k].turning.mean(t, h) - pull.mean(t, h) * links[k].length * std::sin(q[i]) -
                gravity * std::cos(q[i]) * moment_of_chain(links, k);
      const double spring = links[k].stiffness * (q[i] - (i > 0 ? q[i - 1] : 0.0));
      out[i] -= spring;
      if (i > 0) out[i - 1] += spring;
      take_centrifugal(links, i, q, v, out[i]);
    }
    return out;
  }
  Few row(int contact, const Few& q) const override {
    const int k = rubs[static_cast<std::size_t>(contact)];
    Few out = Few::Unit(q.size(), k);
    if (k > 0) out[k - 1] = -1.0;
    return out;
  }
  double driven_rate(int, double) const override { return 0.0; }
  double bound(int contact, double) const override {
    return links[static_cast<std::size_t>(rubs[static_cast<std::size_t>(contact)])].torque;
  }

  explicit Links(RandomStream& random) {
    kind = "links";
    duration = random.uniform(0.8, 2.0);
    const int n = pick(random, 1, 4);
    gravity = chance(random, 0.6) ? earth_gravity : 0.0;
    if (chance(random, 0.5)) pull = random_load(random, 5.0, duration);
    scene = fmt::format("gravity = [0, {}]\n[ground]\npoints = {{ b = [0, 0] }}\n", -gravity);
    std::string later, starts;
    for (int k = 0; k < n; ++k) {
      Link one;
      one.length = random.uniform(0.3, 0.8);
      one.center = random.uniform(0.2, 0.8) * one.length;
      one.mass = random.uniform(0.3, 1.5);
      one.inertia = random.uniform(0.01, 0.1);
      if (chance(random, 0.85)) one.torque = random.uniform(0.05, 1.0) * (gravity > 0 ? 2.0 : 0.7);
      if (chance(random, gravity > 0 ? 0.3 : 0.8)) one.stiffness = random.uniform(2.0, 20.0);
      if (chance(random, 0.6)) one.turning = random_load(random, 4.0, duration);
      if (k == n - 1 && rubs.empty() && one.torque == 0) one.torque = 0.5;
      const double angle = gravity > 0 && chance(random, 0.7) ? -std::numbers::pi / 2 + random.uniform(-0.5, 0.5)
                                                              : random.uniform(-0.5, 0.5);
      const std::string name = fmt::format("l{}", k + 1);
      scene += fmt::format(
          "[body.{}]\npoints = {{ a = [0, 0], b = [{:.17g}, 0] }}\ncenter = [{:.17g}, 0]\nmass = {:.17g}\n"
          "inertia = {:.17g}\n",
          name, one.length, one.center, one.mass, one.inertia);
      starts += fmt::format("{} = {:.17g}\n", name, angle);
      const std::string before = k == 0 ? "ground" : fmt::format("l{}", k);
      later += fmt::format("[[pin]]\nname = \"P{}\"\npoints = [\"{}.b\", \"{}.a\"]\n", k + 1, before, name);
      if (one.torque > 0) {
        later += fmt::format("friction = {{ torque = {:.17g} }}\n", one.torque);
        rubs.push_back(k);
      }
      if (one.stiffness > 0) {
        later += fmt::format("[[torsion_spring]]\nbodies = [\"{}\", \"{}\"]\nstiffness = {:.17g}\n", before, name,
                             one.stiffness);
      }
      if (one.turning.size != 0) {
        later += fmt::format("[[torque]]\non = \"{}\"\nvalue = {:.17g}\n", name, one.turning.size) +
                 one.turning.course.text();
      }
      names.push_back(name);
      start.push_back(angle);
      start_rates.push_back(0.0);
      links.push_back(std::move(one));
    }
    if (pull.size != 0) {
      later += fmt::format("[[force]]\nat = \"l{}.b\"\nvector = [{:.17g}, 0]\n", n, pull.size) + pull.course.text();
    }
    contacts = static_cast<int>(rubs.size());
    scene += later + "[start]\n" + starts;
  }
};

/// A crank, a rod without mass and a slider, with friction of constant size in all joints, which rub at one freedom. q
/// is the angle of the crank.
struct Crank : RubbingMechanism {
  double r = 0.2, l = 0.5, inertia = 0.1, slider = 1.0, stiffness = 0.0, relaxed = 0.0;
  std::array<double, 4> rubbing{};  // pins of the ground, of crank and rod, of rod and slider, the slide
  std::vector<int> rubs;
  Load torque{}, push{};

  // Of the slider's place and of the rod's angle, by the crank's.
  struct Slope {
    double x, x1, x2, rod1;
  };
  Slope slope(double a) const {
    const double s = std::sin(a), c = std::cos(a), root = std::sqrt(l * l - r * r * s * s);
    const double inner1 = -r * r * s * c, inner2 = -r * r * (c * c - s * s);
    return {r * c + root, -r * s + inner1 / root, -r * c + inner2 / root - inner1 * inner1 / (root * root * root),
            -r * c / root};
  }
  FewByFew mass(const Few& q) const override {
    const double x1 = slope(q[0]).x1;
    return FewByFew::Constant(1, 1, inertia + slider * x1 * x1);
  }
  Few force(double t, double h, const Few& q, const Few& v) const override {
    const Slope at = slope(q[0]);
    return Few::Constant(1, torque.mean(t, h) + (push.mean(t, h) - stiffness * (at.x - relaxed)) * at.x1 -
                                slider * at.x1 * at.x2 * v[0] * v[0]);
  }
  Few row(int contact, const Few& q) const override {
    const Slope at = slope(q[0]);
    const std::array<double, 4> rows{1.0, at.rod1 - 1.0, -at.rod1, at.x1};
    return Few::Constant(1, rows[static_cast<std::size_t>(rubs[static_cast<std::size_t>(contact)])]);
  }
  double driven_rate(int, double) const override { return 0.0; }
  double bound(int contact, double) const override {
    return rubbing[static_cast<std::size_t>(rubs[static_cast<std::size_t>(contact)])];
  }

  explicit Crank(RandomStream& random) {
    kind = "slider crank";
    duration = random.uniform(0.8, 2.0);
    r = random.uniform(0.1, 0.3);
    l = r * random.uniform(1.6, 4.0);
    inertia = random.uniform(0.02, 0.2);
    slider = random.uniform(0.5, 2.0);
    const double angle = random.uniform(0.4, 2.6);
    if (chance(random, 0.5)) {
      stiffness = random.uniform(20.0, 200.0);
      relaxed = slope(angle).x + random.uniform(-0.02, 0.02);
    }
    if (chance(random, 0.8)) torque = random_load(random, 1.5, duration);
    if (torque.size == 0 || chance(random, 0.6)) push = random_load(random, 8.0, duration);
    for (int k = 0; k < 4; ++k) {
      if (!chance(random, 0.6)) continue;
      rubbing[static_cast<std::size_t>(k)] = k == 3 ? random.uniform(0.2, 2.0) : random.uniform(0.02, 0.3);
      rubs.push_back(k);
    }
    if (rubs.empty()) {
      rubs.push_back(0);
      rubbing[0] = 0.2;
    }
    const auto friction = [&](int k) {
      const double size = rubbing[static_cast<std::size_t>(k)];
      return size > 0 ? fmt::format("friction = {{ {} = {:.17g} }}\n", k == 3 ? "force" : "torque", size) : "";
    };
    const double rod = std::asin(-r * std::sin(angle) / l);
    scene = fmt::format(
        "gravity = [0, 0]\n[ground]\npoints = {{ O = [0, 0] }}\n"
        "[body.crank]\npoints = {{ O = [0, 0], A = [{:.17g}, 0] }}\ninertia = {:.17g}\n"
        "[body.rod]\npoints = {{ A = [0, 0], B = [{:.17g}, 0] }}\n"
        "[body.slider]\npoints = {{ B = [0, 0] }}\nmass = {:.17g}\n",
        r, inertia, l, slider);
    scene += "[[pin]]\nname = \"O\"\npoints = [\"ground.O\", \"crank.O\"]\n" + friction(0);
    scene += "[[pin]]\nname = \"A\"\npoints = [\"crank.A\", \"rod.A\"]\n" + friction(1);
    scene += "[[pin]]\nname = \"B\"\npoints = [\"rod.B\", \"slider.B\"]\n" + friction(2);
    scene += "[[slide]]\nname = \"way\"\npoints = [\"ground.O\", \"slider.B\"]\naxis = [1, 0]\n" + friction(3);
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
    scene += fmt::format("[start]\ncrank = {:.17g}\nrod = {:.17g}\nway = {:.17g}\n", angle, rod, slope(angle).x);
    names = {"crank"};
    start = {angle};
    start_rates = {0.0};
    contacts = static_cast<int>(rubs.size());
  }
};

Few as_few(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

}  // namespace

std::unique_ptr<RubbingMechanism> rubbing_mechanism(std::uint64_t seed) {
  RandomStream random(seed);
  std::unique_ptr<RubbingMechanism> out;
  do {
    const double which = random.uniform();
    if (which < 0.4)
      out = std::make_unique<Blocks>(random);
    else if (which < 0.65)
      out = std::make_unique<Wheels>(random);
    else if (which < 0.85)
      out = std::make_unique<Links>(random);
    else
      out = std::make_unique<Crank>(random);
  } while (out->contacts == 0);
  if (chance(random, 0.4)) {
    for (double& rate : out->start_rates) {
      if (chance(random, 0.6)) rate = random.uniform(-1.0, 1.0);
    }
  }
  out->accuracy = std::pow(10.0, -pick(random, 6, 12));
  return out;
}

std::vector<Few> small_steps(const RubbingMechanism& mechanism, int steps, int samples) {
  const double h = mechanism.duration / steps;
  const auto contacts = static_cast<std::size_t>(mechanism.contacts);
  Few q = as_few(mechanism.start), v = as_few(mechanism.start_rates);
  std::vector<double> push(contacts, 0.0), stiff(contacts), most(contacts);
  std::vector<Few> row(contacts, q), moves(contacts, q);
  std::vector<Few> out{q};
  for (int step = 0; step < steps; ++step) {
    const double t = step * h;
    q += h / 2 * v;
    const Eigen::LLT<FewByFew> mass(mechanism.mass(q));
    for (std::size_t c = 0; c < contacts; ++c) {
      row[c] = mechanism.row(static_cast<int>(c), q);
      moves[c] = mass.solve(row[c]);
      stiff[c] = row[c].dot(moves[c]);
      most[c] = h * mechanism.bound(static_cast<int>(c), t + h / 2);
    }
    // Forces depend on rates: at the middle ones, which follow from the new ones.
    Few after = v;
    for (int corrected = 0; corrected < 4; ++corrected) {
      Few now = v + mass.solve(Few(h * mechanism.force(t, h, q, Few((v + after) / 2))));
      for (std::size_t c = 0; c < contacts; ++c) now += push[c] * moves[c];
      for (int sweep = 0; sweep < 300; ++sweep) {
        double changed = 0.0;
        for (std::size_t c = 0; c < contacts; ++c) {
          const double slip = row[c].dot(now) - mechanism.driven_rate(static_cast<int>(c), t + h);
          const double next = std::clamp(push[c] - slip / stiff[c], -most[c], most[c]);
          changed = std::max(changed, std::abs(next - push[c]) * stiff[c]);
          now += (next - push[c]) * moves[c];
          push[c] = next;
        }
        if (changed <= 4e-15 * (1 + now.cwiseAbs().maxCoeff())) break;
      }
      const bool is_settled = (now - after).cwiseAbs().maxCoeff() <= 1e-14;
      after = now;
      if (is_settled) break;
    }
    v = after;
    q += h / 2 * v;
    if ((step + 1) % (steps / samples) == 0) out.push_back(q);
  }
  return out;
}

JudgedRubbing judge_rubbing(std::uint64_t seed, int finer) {
  constexpr int samples = 64;
  const std::unique_ptr<RubbingMechanism> mechanism = rubbing_mechanism(seed);
  JudgedRubbing out;
  out.kind = mechanism->kind;
  const MotionModel model(resisted_by_joints(parse_scene(mechanism->scene, fmt::format("rubbing {}", seed))));
  const std::vector<Channel> channels = channels_of(model);
  std::vector<StartValue> wanted;
  std::vector<const Channel*> of;
  for (std::size_t k = 0; k < mechanism->names.size(); ++k) {
    of.push_back(&channel_named("judge", mechanism->names[k], channels));
    if (mechanism->start_rates[k] != 0) wanted.push_back({of.back()->coordinate, true, mechanism->start_rates[k]});
  }
  MotionOptions options;
  options.duration = mechanism->duration;
  options.accuracy = mechanism->accuracy;
  const ConfirmedMotion found = simulate_and_confirm(model, start_motion(model, wanted), options);
  out.confirmed = found.confirmed();
  if (!found.motion.completed())
    out.why = found.motion.why;
  else if (!found.error)
    out.why = "error unknown: " + found.why_unknown;
  else if (!out.confirmed)
    out.why = fmt::format("error {:.2g}, of energy {:.2g}", *found.error, found.motion.energy_error);
  if (!out.confirmed) return out;
  out.error = *found.error;

  // The rates after a step in which friction turns are wrong by up to the step times the change of the acceleration:
  // the numbers of steps have no common factors, so that these errors do not agree by chance.
  std::vector<std::vector<Few>> judged;
  constexpr std::array parts{33, 61, 89, 127, 181, 257};
  for (const int part : parts) judged.push_back(small_steps(*mechanism, samples * finer * part, samples));
  std::vector<int> coordinates;
  for (const Channel* channel : of) coordinates.push_back(channel->coordinate);
  TrajectoryReader reader(found.motion.trajectory, coordinates);
  std::vector<std::vector<double>> read(samples + 1);
  std::vector<double> reach(of.size(), 0.0);
  for (int s = 0; s <= samples; ++s) {
    reader.at(mechanism->duration * s / samples);
    for (std::size_t k = 0; k < of.size(); ++k) {
      read[static_cast<std::size_t>(s)].push_back(reader.q(k) + of[k]->offset);
      reach[k] = std::max(reach[k], std::abs(read[static_cast<std::size_t>(s)][k] - read[0][k]));
    }
  }
  const double far = *std::max_element(reach.begin(), reach.end());
  for (std::size_t s = 0; s <= samples; ++s) {
    for (std::size_t k = 0; k < of.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double judge = judged.back()[s][i];
      const double apart = std::abs(read[s][k] - judge);
      double unknown = 1e-12;
      for (std::size_t coarser = 0; coarser + 1 < parts.size(); ++coarser) {
        const double shorter = static_cast<double>(parts[coarser]) / parts.back();
        unknown = std::max(unknown, 4 * shorter * std::abs(judged[coarser][s][i] - judge));
      }
      const double beyond = apart / (unknown + out.error * std::max(reach[k], 1e-3 * far));
      if (!(beyond > out.beyond)) continue;
      out.beyond = beyond;
      out.apart = apart;
      out.unknown = unknown;
      out.where = fmt::format("{} at {:.4g} s", of[k]->name, mechanism->duration * static_cast<double>(s) / samples);
    }
  }
  return out;
}

}  // namespace poise::judge
