#include "tests/support/every_measure.hpp"

#include <memory>

#include "tests/support/elements.hpp"

namespace poise::test {

std::vector<NamedMeasure> measures_of(Scene& scene, Random& random, bool with_couplings) {
  std::vector<PointRef> probes;
  for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b) {
    probes.push_back(scene.add_point(b, "probe", {random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7)}));
  }
  const auto body_but = [&](int other) {
    for (;;) {
      const int body = random.index(scene.bodies.size());
      if (body != other) return body;
    }
  };
  const auto angle = [&] {
    const int b = body_but(0);
    return Measure::angle_between(body_but(b), b);
  };
  const auto distance = [&] {
    const int b = body_but(0);
    return Measure::distance_between(probes[body_but(b)], probes[b]);
  };
  const auto x = [&] { return Measure::x_of(probes[body_but(0)]); };
  const auto y = [&] { return Measure::y_of(probes[body_but(0)]); };
  std::vector<NamedMeasure> all{{"angle", angle()}, {"distance", distance()}, {"x", x()}, {"y", y()}};
  std::vector<Measure> lengths{distance(), x(), y()};
  for (int j = 0; j < static_cast<int>(scene.joints.size()); ++j) {
    if (!scene.joints[j].has_travel()) continue;
    all.push_back({"travel of " + scene.joints[j].name, Measure::travel_of(j)});
    lengths.push_back(Measure::travel_of(j));
  }
  std::vector<Measure::Term> terms;
  for (const Measure& length : lengths) terms.push_back({random.uniform(-2.0, 2.0), length});
  all.push_back({"sum of lengths", Measure::sum_of(terms)});
  all.push_back({"sum of angles", Measure::sum_of({{2.0, angle()}, {-3.0, angle()}})});
  all.push_back({"sum of sums", Measure::sum_of({{0.5, Measure::sum_of(terms)}, {-1.5, distance()}})});
  const Measure turn = angle();
  all.push_back({"nothing", Measure::sum_of({{1.0, turn}, {-1.0, turn}})});
  if (!with_couplings) return all;
  const int carrier = body_but(-1);
  const auto component = [&] {
    const int b = body_but(carrier);
    return Measure::component_along(probes[carrier], probes[b], {random.uniform(0.2, 1.0), random.uniform(-1.0, 1.0)});
  };
  all.push_back({"component", component()});
  const auto rope = [&] {
    std::vector<RopeContact> contacts{{probes[body_but(-1)]}};
    for (int k = 0; k < 3; ++k) {
      const int body = body_but(contacts.back().at.body);
      const bool is_end = k == 2;
      contacts.push_back({probes[body], is_end ? 0.0 : random.uniform(0.0, 0.05), random.index(2) == 0 ? 1 : -1});
    }
    return Measure::rope_over(contacts);
  };
  all.push_back({"rope", rope()});
  const auto outline = [&](Outline::Form form, int body) {
    Outline out{form, {}, false};
    const double first = random.uniform(0.0, 6.0), size = random.uniform(0.2, 0.6);
    const Vec2 middle{random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4)};
    const auto add = [&](double at) {
      out.points.push_back(scene.add_point(body, "edge", middle + size * unit(first + at)));
    };
    if (form != Outline::Form::polygon) {
      out.points.push_back(scene.add_point(body, "middle", middle));
      add(0.0);
      add(random.uniform(0.5, 5.5));
      return out;
    }
    out.backed = random.chance(0.5);
    if (out.backed) {
      add(0.0);
      add(-1.0);
    } else {
      for (const double at : {0.0, 1.1, 2.3, 4.0, 5.5}) add(-at);
    }
    return out;
  };
  for (const auto& [name, form] : {std::pair("polygon", Outline::Form::polygon), std::pair("arc", Outline::Form::arc),
                                   std::pair("hollow arc", Outline::Form::hollow_arc)}) {
    const int body = body_but(-1);
    const Measure clearance = Measure::clearance_of(probes[body_but(body)], outline(form, body));
    all.push_back({std::string("clearance from a ") + name, clearance});
    Measure along = Measure::slip_on(clearance, random.uniform(0.05, 0.2));
    all.push_back({std::string("slip along a ") + name, along});
    all.push_back({std::string("way along a ") + name, along.terms.front().measure});
  }
  const auto profile =
      std::make_shared<const Profile>(Profile::spline({0.0, 0.2, 0.45, 0.7, 1.0}, {0.1, 1.0, 0.4, -0.3, 0.1}, true));
  all.push_back(
      {"follower on a cam",
       Measure::sum_of({{1.0, y()}, {random.uniform(-0.5, 0.5), angle(), profile, random.uniform(-1.0, 1.0)}})});
  all.push_back({"profile of a length", Measure::sum_of({{1.0, rope()}, {0.3, component(), profile, 0.1, 2.0}})});
  all.push_back({"rack", Measure::sum_of({{1.0, x()}, {random.uniform(-0.5, 0.5), angle()}})});
  all.push_back({"chain", Measure::sum_of({{1.0, component()}, {-0.3, angle()}, {0.4, angle()}})});
  const auto track =
      std::make_shared<const Profile>(Profile::spline({0.0, 0.3, 0.55, 1.0}, {0.1, 0.9, 0.4, -0.2}, false));
  all.push_back({"pin in a curved slot", Measure::sum_of({{1.0, component()}, {-0.4, x(), track, 0.0, 1.5}})});
  return all;
}

void add_elements_upon_every_measure(Scene& scene, Random& random, bool with_couplings) {
  for (const auto& [name, measure] : measures_of(scene, random, with_couplings)) {
    const double stiffness = random.uniform(0.2, 1.0);
    const double free_length = random.uniform(0.0, 1.0);
    const auto acts = static_cast<LinearSpring::Acts>(random.index(3));
    scene.elements.push_back(
        make_element("spring", "spring " + name, measure, LinearSpring{stiffness, free_length, acts}));
    scene.elements.push_back(
        make_element("constant_force", "weight " + name, measure, ConstantForce{random.uniform(-0.3, 0.3)}));
    scene.elements.push_back(make_element("damper", "damper " + name, measure, Damper{random.uniform(0.0, 0.5)}));
    const double force = random.uniform(0.0, 0.3);
    scene.elements.push_back(
        make_element("friction", "friction " + name, measure, DryFriction{force, random.uniform(0.5, 1.0)}));
  }
}

}  // namespace poise::test
