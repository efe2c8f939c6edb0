#include "tests/support/random_scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "model/parameters.hpp"
#include "solvers/real50.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/static_model.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::test {
namespace {

using Acts = LinearSpring::Acts;

// --- numbers
// ----------------------------------------------------------------------------------------------------------

double sign(Random& random) { return random.chance(0.5) ? 1.0 : -1.0; }
double power_of_ten(Random& random, double low, double high) { return std::pow(10.0, random.uniform(low, high)); }
// A number as people write it: with `digits` decimals.
double decimal(Random& random, double low, double high, int digits = 1) {
  const double unit = std::pow(10.0, digits);
  return std::round(random.uniform(low, high) * unit) / unit;
}
// Zero, one unit in the last place of 1, or something between, of either sign.
double hardly_anything(Random& random) {
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.35) return 0.0;
  if (kind < 0.5) return sign(random) * 1.2e-16;
  return sign(random) * power_of_ten(random, -16.0, -6.0);
}

// --- planted mechanisms
// -----------------------------------------------------------------------------------------------

PlantedMechanism plant(Random& random, Wish wish) {
  for (;;) {
    wish.loops = 1 + random.index(4);
    PlantedMechanism out = plant_mechanism(static_cast<std::uint64_t>(random.uniform(0.0, 1e9)), wish);
    if (!out.hangs_on_bars) return out;
  }
}

Scene planted_scene(Random& random, const Wish& wish) {
  const PlantedMechanism out = plant(random, wish);
  return random.chance(0.5) ? out.in_equilibrium : out.scene;
}

Scene planted(Random& random) { return planted_scene(random, {}); }
Scene stops(Random& random) { return planted_scene(random, {.stops = true}); }

// Value of a measure where the scene starts.
double value_at_start(const Scene& scene, const Measure& measure) {
  const StaticModel model(scene);
  return value_of(scene, measure, model.poses(model.start()));
}

PointRef new_point(Random& random, Scene& scene, int body, double size) {
  return scene.add_point(body, fmt::format("r{}", scene.bodies[body].points.size()),
                         {random.uniform(-size, size), random.uniform(-size, size)});
}

Measure random_measure(Random& random, Scene& scene, double size) {
  const int bodies = static_cast<int>(scene.bodies.size());
  const int b = 1 + random.index(static_cast<std::size_t>(bodies - 1));
  const int a = random.index(static_cast<std::size_t>(b));
  switch (random.index(4)) {
    case 0:
      return Measure::angle_between(a, b);
    case 1:
      return random.chance(0.5) ? Measure::x_of(new_point(random, scene, b, size))
                                : Measure::y_of(new_point(random, scene, b, size));
    default: {
      const PointRef end = new_point(random, scene, b, size);
      return Measure::distance_between(new_point(random, scene, a, size), end);
    }
  }
}

// A distance that no motion changes: from a pin to a point of one of its bodies.
std::optional<Measure> constant_measure(Random& random, Scene& scene, double size) {
  for (const Joint& joint : scene.joints) {
    if (joint.kind != Joint::Kind::pin) continue;
    const PointRef a = joint.a;
    const int b = joint.b.body;
    return Measure::distance_between(a, new_point(random, scene, b, size));
  }
  return std::nullopt;
}

// Something to hang stops and springs on, that starts in equilibrium.
Scene in_equilibrium(Random& random) {
  if (random.chance(0.4)) {
    const double mass = decimal(random, 0.5, 3.0), length = decimal(random, 0.3, 2.0);
    Scene scene = chain(1 + random.index(3), length, mass);
    // Upright or hanging, exactly so: gravity along x.
    scene.gravity = {sign(random) * 9.81, 0.0};
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) scene.start.angle[b] = 0.0;
    if (random.chance(0.5)) add_torsion_spring(scene, 0, 1, power_of_ten(random, -1.0, 2.0));
    return scene;
  }
  return plant(random, {.stops = random.chance(0.2)}).in_equilibrium;
}

double size_of(const Scene& scene) { return StaticModel(scene).scales().length; }

Scene touching(Random& random) {
  Scene scene = in_equilibrium(random);
  const double size = size_of(scene);
  const int count = 1 + random.index(2);
  for (int k = 0; k < count; ++k) {
    Stop stop;
    stop.name = fmt::format("touching{}", k);
    stop.on = random_measure(random, scene, 0.7 * size);
    const double g = value_at_start(scene, stop.on);
    const double unit_size = stop.on.is_angle() ? 1.0 : size;
    const double kind = random.uniform(0.0, 1.0);
    const double limit = g + unit_size * hardly_anything(random);
    if (kind < 0.4) {
      stop.min = limit;
    } else if (kind < 0.8) {
      stop.max = limit;
    } else if (kind < 0.9) {
      stop.min = stop.max = limit;
    } else {
      const double other = g + unit_size * hardly_anything(random);
      stop.min = std::min(limit, other);
      stop.max = std::max(limit, other);
    }
    if (stop.on.kind == Measure::Kind::distance && !(stop.min >= 0.0)) stop.min = 0.0;
    scene.stops.push_back(stop);
  }
  return scene;
}

Scene kinks(Random& random) {
  Scene scene = in_equilibrium(random);
  const double size = size_of(scene);
  const double load = StaticModel(scene).scales().force;
  const int count = 1 + random.index(2);
  for (int k = 0; k < count; ++k) {
    std::optional<Measure> on;
    if (random.chance(0.2)) on = constant_measure(random, scene, 0.7 * size);
    if (!on) on = random_measure(random, scene, 0.7 * size);
    const double g = value_at_start(scene, *on);
    const double free = g + (on->is_angle() ? 1.0 : size) * hardly_anything(random);
    const double stiffness = (on->is_angle() ? load * size : load / size) * power_of_ten(random, -1.0, 2.0);
    const Acts acts = random.chance(0.5) ? Acts::tension : Acts::compression;
    scene.elements.push_back(make_element("spring", fmt::format("kink{}", k), *on,
                                          LinearSpring{stiffness, std::max(free, on->is_angle() ? free : 0.0), acts}));
  }
  return scene;
}

// A planted mechanism with one freedom, unstable; a torsion spring without moment makes its curvature small.
Scene curvature(Random& random) {
  for (;;) {
    const PlantedMechanism drawn = plant(random, {});
    if (drawn.freedoms != 1 || drawn.falling() != 1) continue;
    Scene scene = drawn.in_equilibrium;
    const StaticModel model(scene);
    std::vector<int> rows(static_cast<std::size_t>(model.mechanism().equalities()));
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = static_cast<int>(r);
    const ReducedHessian reduced(model.mechanism(), model.start(), rows);
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
      const int frame = model.layout().links[b].frame;
      if (frame < 0 || frame >= model.layout().kept) continue;
      const double turn = reduced.basis(frame, 0);
      if (std::abs(turn) < 0.1) continue;
      const double wanted = sign(random) * power_of_ten(random, -15.0, -2.0);
      const double stiffness = (wanted - reduced.matrix(0, 0)) / (turn * turn);
      add_torsion_spring(scene, 0, static_cast<int>(b), stiffness * model.scales().energy(),
                         model.poses(model.start())[b].angle);
      if (random.chance(0.5)) scene.start = drawn.scene.start;
      return scene;
    }
  }
}

// An inverted chain, gravity along x, with springs that just hold it.
Scene cusps(Random& random) {
  const int count = random.chance(0.7) ? 1 : 2;
  const double length = random.chance(0.5) ? 1.0 : decimal(random, 0.3, 3.0);
  const double mass = random.chance(0.5) ? 2.0 : decimal(random, 0.3, 3.0);
  Scene scene = chain(count, length, mass);
  const double g = random.chance(0.5) ? 10.0 : 9.81;
  scene.gravity = {-g, 0.0};
  const double off = random.chance(0.3) ? 0.0 : sign(random) * power_of_ten(random, -16.0, -1.0);
  // With springs k at both pins of two links of weight W the least curvature vanishes where
  //   (k + k - 3/2 W l) (k - W l / 2) = k^2.
  const double wl = mass * g * length;
  const double critical = count == 1 ? 0.5 * wl : wl * (2.5 + std::sqrt(2.5 * 2.5 - 3.0)) / 2.0;
  for (int i = 0; i < count; ++i) add_torsion_spring(scene, i, i + 1, critical * (1 + off));
  const double lean = random.chance(0.5) ? 0.0 : sign(random) * power_of_ten(random, -12.0, -1.0);
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) scene.start.angle[b] = lean;
  if (random.chance(0.2))
    scene.torques.push_back({"push", count, wl * sign(random) * power_of_ten(random, -15.0, -6.0)});
  return scene;
}

// A chain of torsion springs with a load that follows its tip.
Scene followers(Random& random) {
  if (random.chance(0.5)) return planted_scene(random, {.followers = true});
  const int count = 1 + random.index(10);
  const double mass = random.chance(0.5) ? 0.0 : decimal(random, 0.1, 1.0);
  Scene scene = chain(count, decimal(random, 0.1, 1.0), mass);
  if (random.chance(0.5)) scene.gravity = {0.0, -1.0};
  for (int i = 0; i < count; ++i) add_torsion_spring(scene, i, i + 1, decimal(random, 0.5, 8.0));
  Force force;
  force.name = "P";
  force.at = point(scene, fmt::format("{}.b", count));
  const Vec2 direction = unit(random.chance(0.5) ? M_PI : random.uniform(-M_PI, M_PI));
  force.vector = random.uniform(0.0, 2.0) * direction;
  force.follows = random.chance(0.8) ? count : 1 + random.index(static_cast<std::size_t>(count));
  scene.forces.push_back(force);
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) scene.start.angle[b] = random.uniform(-0.1, 0.1);
  return scene;
}

// --- trusses
// ----------------------------------------------------------------------------------------------------------

// The largest load of a spring of that length and stiffness between the ground and a block guided across, `span` away:
//   P(y) = k (l0 / l - 1) y,  l^2 = span^2 + y^2,  greatest where  l^3 = l0 span^2.
double largest_load(double stiffness, double free_length, double span) {
  const Real50 l0 = free_length;
  const Real50 s = span;
  const Real50 l = pow(Real50(l0 * s * s), Real50(1) / 3);
  const Real50 y = sqrt(Real50(l * l - s * s));
  return static_cast<double>(Real50(stiffness * (l0 / l - 1) * y));
}

Scene trusses(Random& random) {
  const double slope = power_of_ten(random, -4.0, std::log10(0.5));
  const double span = random.chance(0.5) ? 1.0 : decimal(random, 0.3, 3.0);
  const double stiffness = random.chance(0.5) ? 1000.0 : power_of_ten(random, 0.0, 6.0);
  const double free_length = span * std::sqrt(1 + slope * slope);
  const int springs = random.chance(0.5) ? 1 : 2;
  Scene scene;
  scene.add_point(0, "L", {-span, 0.0});
  scene.add_point(0, "R", {span, 0.0});
  scene.add_point(0, "G", {0.0, 0.0});
  const int block = scene.add_body("block");
  const PointRef tip = scene.add_point(block, "P", {0.0, 0.0});
  const int guide = add_slide(scene, "ground.G", "block.P", {0.0, 1.0}, "guide");
  for (int k = 0; k < springs; ++k) {
    scene.elements.push_back(line_spring(fmt::format("bar{}", k), {0, k}, tip, stiffness, free_length));
  }
  const double d = sign(random) * power_of_ten(random, -15.0, -3.0);
  const double load = random.chance(0.1) ? 0.0 : springs * largest_load(stiffness, free_length, span) * (1 + d);
  if (load > 0.0) add_force(scene, "block.P", {0.0, -load}, "P");
  const double height = slope * span;
  scene.start.travel[guide] = random.chance(0.5) ? height : height * random.uniform(0.3, 1.2);
  if (random.chance(0.25)) {
    // For ever at its free length.
    scene.add_point(0, "A", {0.0, 3.0});
    const int link = add_link(scene, "idle", 1.0, 1.0);
    add_pin(scene, "ground.A", "idle.a");
    scene.gravity = {0.0, -1.0};
    scene.start.angle[link] = -1.5;
    scene.elements.push_back(
        line_spring("never", point(scene, "ground.A"), point(scene, "idle.b"), stiffness, 1.0, Acts::tension));
  }
  return scene;
}

// --- pins and loops
// ---------------------------------------------------------------------------------------------------

// Two ways to write nearly, or exactly, one number.
std::pair<double, double> twins(Random& random) {
  static constexpr std::array<std::pair<double, double>, 4> written{
      {{0.3, 0.1 + 0.2}, {0.8, 0.7 + 0.1}, {3.3, 1.1 * 3}, {0.6, 0.2 * 3}}};
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.5) return written[static_cast<std::size_t>(random.index(written.size()))];
  const double v = decimal(random, 0.1, 2.0);
  return {v, kind < 0.75 ? v : std::nextafter(v, 3.0)};
}

Scene pins(Random& random) {
  if (random.chance(0.3)) {
    const int count = 2 + random.index(3);
    Scene scene = windows(count);
    const bool upright = random.chance(0.5);
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
      const bool post = scene.bodies[b].name.starts_with("post");
      scene.start.angle[b] = (post ? (upright ? 1.0 : -1.0) * M_PI / 2 : 0.0) + (post ? 0.02 : 0.0);
    }
    if (upright && random.chance(0.5)) add_torsion_spring(scene, 0, 1, random.uniform(0.5, 10.0), M_PI / 2);
    return scene;
  }
  const auto [first, second] = twins(random);
  Scene scene;
  scene.gravity = {0.0, random.chance(0.5) ? -1.0 : -9.81};
  scene.add_point(0, "A", {first, 0.0});
  scene.add_point(0, "B", {second, 0.0});
  const double mass = decimal(random, 0.5, 2.0);
  const int link = add_link(scene, "link", decimal(random, 2.0, 8.0), mass);
  scene.add_point(link, "A", {first, 0.0});
  scene.add_point(link, "B", {second, 0.0});
  add_pin(scene, "ground.A", "link.A", "one");
  add_pin(scene, "ground.B", "link.B", "two");
  const double up = sign(random) * M_PI / 2;
  scene.start.angle[link] = up + (random.chance(0.5) ? 0.0 : random.uniform(-0.1, 0.1));
  if (random.chance(0.5)) {
    const int next = add_link(scene, "next", decimal(random, 0.5, 2.0), 1.0);
    add_pin(scene, "link.b", "next.a", "three");
    scene.start.angle[next] = sign(random) * M_PI / 2;
  }
  if (random.chance(0.3)) add_torsion_spring(scene, 0, link, decimal(random, 1.0, 20.0), up);
  return scene;
}

// A four-bar that lies flat on the x axis.
Scene change_points(Random& random) {
  const bool parallelogram = random.chance(0.6);
  const int digits = random.chance(0.5) ? 0 : 1;
  const double crank = decimal(random, 1.0, 3.0, digits);
  const double coupler = decimal(random, 1.0, 4.0, digits);
  const double rocker = parallelogram ? crank : decimal(random, 1.0, 3.0, digits);
  const double base = crank + coupler - rocker;
  if (!(base > 0.2)) return change_points(random);
  Scene scene;
  scene.add_point(0, "A", {0.0, 0.0});
  scene.add_point(0, "B", {base, 0.0});
  add_link(scene, "crank", crank);
  add_link(scene, "rocker", rocker);
  add_link(scene, "coupler", coupler);
  add_pin(scene, "ground.A", "crank.a");
  add_pin(scene, "ground.B", "rocker.a");
  add_pin(scene, "crank.b", "coupler.a");
  add_pin(scene, "coupler.b", "rocker.b");
  const int springs = 1 + random.index(3);
  for (int k = 0; k < springs; ++k) add_torsion_spring(scene, 0, 1 + k, decimal(random, 0.1, 3.0));
  if (random.chance(0.6)) {
    const char* places[] = {"crank.b", "coupler.m", "rocker.b"};
    const double load = decimal(random, -2.0, 2.0);
    add_force(scene, places[random.index(3)], {load, 0.0}, "P");
  }
  if (random.chance(0.5)) {
    const double off = sign(random) * power_of_ten(random, -10.0, -2.0);
    const bool crossed = random.chance(0.5);
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) scene.start.angle[b] = b == 3 && !crossed ? 0.0 : off;
  }
  return scene;
}

// --- others
// -----------------------------------------------------------------------------------------------------------

Scene soft(Random& random) {
  const int count = 1 + random.index(4);
  Scene scene = chain(count, 1.0, random.chance(0.5) ? 1.0 : 0.0);
  scene.gravity = {0.0, -random.uniform(0.1, 10.0)};
  for (int i = 0; i < count; ++i) {
    const double free_angle = random.uniform(-1.0, 1.0);
    add_torsion_spring(scene, i, i + 1, power_of_ten(random, -4.0, 5.0), free_angle);
  }
  const PointRef anchor = scene.add_point(0, "S", {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)});
  const double free_length = random.uniform(0.2, 1.5);
  scene.elements.push_back(line_spring("line", anchor, point(scene, fmt::format("{}.b", count)),
                                       power_of_ten(random, -4.0, 5.0), free_length));
  if (random.chance(0.5)) add_force(scene, fmt::format("{}.m", count), {power_of_ten(random, -6.0, 1.0), 0.0}, "P");
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) scene.start.angle[b] = random.uniform(-1.5, 0.5);
  return scene;
}

Scene level_rail(Random& random) {
  Scene scene;
  scene.gravity = {0.0, -9.81};
  scene.add_point(0, "O", {0.0, 0.0});
  const int block = scene.add_body("block");
  const PointRef p = scene.add_point(block, "P", {0.0, 0.0});
  scene.bodies[static_cast<std::size_t>(block)].mass = 1.0;
  add_slide(scene, "ground.O", "block.P", {1.0, 0.0}, "rail");
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.5) add_force(scene, "block.P", {power_of_ten(random, -12.0, -3.0), 0.0}, "push");
  if (kind > 0.3) {
    // Slack where the block starts, or for ever.
    scene.elements.push_back(
        line_spring("s", scene.add_point(0, "S", {-1.0, 0.0}), p, 100.0, 1.0 + hardly_anything(random), Acts::tension));
  }
  scene.start.travel[0] = random.chance(0.5) ? 0.0 : random.uniform(-0.5, 0.5);
  return scene;
}

Scene neutral(Random& random) {
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.3) return level_rail(random);
  const int count = 1 + random.index(4);
  Scene scene;
  scene.gravity = {0.0, -9.81};
  for (int k = 0; k < count; ++k) {
    scene.add_point(0, fmt::format("O{}", k), {2.0 * k, 0.0});
    const std::string name = fmt::format("arm{}", k);
    const int arm = scene.add_body(name);
    scene.add_point(arm, "O", {0.0, 0.0});
    const double factor = decimal(random, 2.0, 4.0, 0);
    const double reach = decimal(random, 0.1, 0.5);
    const double weight = decimal(random, 0.5, 5.0);
    scene.add_point(arm, "near", {reach, 0.0});
    scene.add_point(arm, "far", {random.chance(0.5) ? -reach * factor : -std::round(reach * factor * 10) / 10, 0.0});
    add_pin(scene, fmt::format("ground.O{}", k), name + ".O");
    add_force(scene, name + ".near", {0.0, -weight * factor}, fmt::format("n{}", k));
    add_force(scene, name + ".far", {0.0, -weight}, fmt::format("f{}", k));
    scene.start.angle[static_cast<std::size_t>(arm)] = random.uniform(-1.0, 1.0);
  }
  if (random.chance(0.5)) {
    scene.add_point(0, "P", {-2.0, 0.0});
    const int link = add_link(scene, "pendulum", 1.0, 1.0);
    add_pin(scene, "ground.P", "pendulum.a");
    scene.start.angle[static_cast<std::size_t>(link)] = sign(random) * M_PI / 2 + random.uniform(-0.1, 0.1);
  }
  return scene;
}

Scene locks(Random& random) {
  Scene scene = chain(1 + random.index(2), 1.0, 1.0);
  const double angle = random.chance(0.3) ? M_PI / 2 : decimal(random, 0.1, 3.0);
  scene.gravity = {0.0, -9.81};
  const auto bodies = static_cast<int>(scene.bodies.size());
  for (int b = 1; b < bodies; ++b) scene.start.angle[static_cast<std::size_t>(b)] = angle;
  const auto stop = [&](const std::string& name, Measure on, double min, double max) {
    Stop out;
    out.name = name;
    out.on = std::move(on);
    out.min = min;
    out.max = max;
    scene.stops.push_back(out);
  };
  constexpr double far = std::numeric_limits<double>::infinity();
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.3) {
    stop("held", Measure::angle_between(0, 1), angle, angle);
  } else if (kind < 0.6) {
    const double room = std::abs(hardly_anything(random));
    stop("below", Measure::angle_between(0, 1), angle - room, far);
    stop("above", Measure::angle_between(0, 1), -far, angle + room * (random.chance(0.5) ? 1.0 : 0.0));
  } else {
    // Two strings, taut on both sides.
    const PointRef tip = point(scene, "1.b");
    const PointRef left = scene.add_point(0, "L", {-2.0, decimal(random, -1.0, 1.0)});
    const PointRef right = scene.add_point(0, "R", {2.0, decimal(random, -1.0, 1.0)});
    for (const auto& [name, p] : {std::pair{"left", left}, {"right", right}}) {
      const Measure on = Measure::distance_between(p, tip);
      stop(name, on, 0.0, value_at_start(scene, on) * (random.chance(0.5) ? 1.0 : 1.0 + 1e-9));
    }
  }
  if (bodies > 2 && random.chance(0.5)) add_torsion_spring(scene, 1, 2, decimal(random, 0.5, 20.0));
  return scene;
}

Scene scales(Random& random);

struct Family {
  const char* name;
  Scene (*make)(Random&);
};

constexpr std::array<Family, 14> families{{{"planted", planted},
                                           {"followers", followers},
                                           {"stops", stops},
                                           {"touching", touching},
                                           {"kinks", kinks},
                                           {"curvature", curvature},
                                           {"cusps", cusps},
                                           {"trusses", trusses},
                                           {"pins", pins},
                                           {"change_points", change_points},
                                           {"soft", soft},
                                           {"neutral", neutral},
                                           {"locks", locks},
                                           {"scales", scales}}};

bool uses_world(const Measure& m) {
  return m.kind == Measure::Kind::x || m.kind == Measure::Kind::y ||
         std::any_of(m.terms.begin(), m.terms.end(), [](const Measure::Term& t) { return uses_world(t.measure); });
}

// Moves the origin of the world.
void translate(Scene& scene, Vec2 by) {
  const auto uses = [](const auto& items) {
    return std::any_of(items.begin(), items.end(), [](const auto& item) { return uses_world(item.on); });
  };
  if (uses(scene.elements) || uses(scene.stops)) return;
  for (NamedPoint& p : scene.bodies[0].points) p.at += by;
  for (auto& place : scene.start.position) {
    if (place) *place += by;
  }
}

Scene scales(Random& random) {
  Scene scene = families[static_cast<std::size_t>(random.index(families.size() - 1))].make(random);
  const double length = std::exp2(random.index(41) - 20);
  const double force = std::exp2(random.index(41) - 20);
  scene = scaled(scene, {length, force});
  const double mass = std::exp2(random.index(41) - 20);
  for (Body& body : scene.bodies) {
    body.mass *= mass;
    body.inertia *= mass;
  }
  scene.gravity = (1 / mass) * scene.gravity;
  if (random.chance(0.5)) {
    const double far = size_of(scene) * power_of_ten(random, 0.0, 6.0);
    translate(scene, {far * sign(random), far * random.uniform(-1.0, 1.0)});
  }
  return scene;
}

}  // namespace

const std::vector<std::string>& scene_families() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Family& family : families) out.emplace_back(family.name);
    return out;
  }();
  return names;
}

Scene random_scene(const std::string& family, std::uint64_t seed) {
  const auto found = std::find_if(families.begin(), families.end(), [&](const Family& f) { return f.name == family; });
  if (found == families.end()) throw std::invalid_argument("there is no family \"" + family + "\"");
  // Seeds next to each other are to give unlike streams.
  Random random(seed * 0x9e3779b97f4a7c15U + static_cast<std::uint64_t>(found - families.begin()));
  Scene scene = found->make(random);
  scene.file = scene.title = fmt::format("{} {}", family, seed);
  return scene;
}

}  // namespace poise::test
