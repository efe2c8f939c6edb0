#include "model/flexible_link.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace poise {
namespace {

using beam_element::gauss_place;
using beam_element::gauss_weight;
using beam_element::lagrange_slope;
using beam_element::nodes;

/// Where in its element a node's mass is while the element is straight, on 0 .. 1.
double mass_place(int node) {
  double before = 0.0;
  for (int j = 0; j < node; ++j) before += beam_element::weight[j];
  return 2.0 * before + beam_element::weight[node] - beam_element::place[node];
}

/// What a moment of inertia of these masses lacks of that of a bar that turns, over its mass and the square of its
/// length.
double missing_inertia() {
  double out = 1.0 / 3.0;
  for (int k = 0; k < nodes; ++k) out -= beam_element::weight[k] * mass_place(k) * mass_place(k);
  return out;
}

/// A straight element of the line.
struct BeamElement {
  double length = 0.0;
  Vec2 direction{};
  int begins_at = -1, ends_at = -1;  ///< points of the body, -1 between them
};

std::vector<BeamElement> elements_of(const Body& body, const std::vector<int>& line, int count) {
  const auto step = [&](std::size_t j) { return body.points[line[j + 1]].at - body.points[line[j]].at; };
  double length = 0.0;
  for (std::size_t j = 0; j + 1 < line.size(); ++j) length += norm(step(j));
  std::vector<BeamElement> out;
  for (std::size_t j = 0; j + 1 < line.size(); ++j) {
    const double stretch = norm(step(j));
    const int parts = std::max(1, static_cast<int>(std::lround(count * stretch / length)));
    for (int k = 0; k < parts; ++k) {
      out.push_back(
          {stretch / parts, (1 / stretch) * step(j), k == 0 ? line[j] : -1, k + 1 == parts ? line[j + 1] : -1});
    }
  }
  return out;
}

/// A name that no point of the body has.
std::string free_name(const Body& body, std::string name) {
  const auto is_taken = [&] {
    return std::any_of(body.points.begin(), body.points.end(), [&](const NamedPoint& p) { return p.name == name; });
  };
  while (is_taken()) name += "_";
  return name;
}

class ChainMaker {
 public:
  ChainMaker(Scene& scene, int body, int elements)
      : scene_(scene),
        first_(body),
        whole_(scene.bodies[body]),
        section_(whole_.section.value()),
        elements_(elements_of(whole_, section_.line, elements)),
        start_(free_name(whole_, "start")),
        end_(free_name(whole_, "end")) {
    for (const BeamElement& element : elements_) length_ += element.length;
  }

  FlexibleChain run() {
    out_.points.resize(whole_.points.size());
    out_.link.name = whole_.name;
    out_.link.section = section_;
    out_.link.section.line.clear();
    const int last = 3 * static_cast<int>(elements_.size());
    for (int node = 0; node <= last; ++node) add_body(node, node == last);
    for (int e = 0; e < static_cast<int>(elements_.size()); ++e) add_springs(e);
    return std::move(out_);
  }

 private:
  /// A body has the weights of its node in the element that ends there and in the one that begins there.
  void add_body(int node, bool is_last) {
    const std::string name = whole_.name + "." + std::to_string(node + 1);
    const int index = node == 0 ? first_ : scene_.add_body(name);
    Body body;
    body.name = name;
    body.line = whole_.line;
    const int in_element = node % 3;
    const BeamElement* const before = in_element == 0 && node > 0 ? &elements_[node / 3 - 1] : nullptr;
    const BeamElement* const after = is_last ? nullptr : &elements_[node / 3];
    const double by_length = whole_.mass / length_;
    Vec2 end{};
    Vec2 moment{};        // of mass
    double second = 0.0;  // moment of mass, about the beginning of the body
    if (before != nullptr) {
      // Its centre of mass is where it begins.
      const double mass = by_length * before->length * beam_element::weight[3];
      body.mass += mass;
      second += mass * before->length * before->length * missing_inertia();
      end += (before->length * beam_element::weight[3]) * before->direction;
    }
    const Vec2 middle = end;
    if (after != nullptr) {
      double behind = 0.0;
      for (int j = in_element + 1; j < nodes; ++j) behind += beam_element::weight[j];
      const double mass = by_length * after->length * beam_element::weight[in_element];
      const double centre = after->length * (1.0 - beam_element::place[in_element] - behind);
      body.mass += mass;
      const Vec2 at = middle + centre * after->direction;
      moment = mass * at;
      second += mass * (dot(at, at) + after->length * after->length * missing_inertia());
      end += (after->length * beam_element::weight[in_element]) * after->direction;
    }
    if (body.mass > 0.0) {
      body.center = (1 / body.mass) * moment;
      body.inertia = second - dot(moment, body.center);
    }
    const auto add_point = [&](const std::string& point, Vec2 at) {
      body.points.push_back({point, at});
      return PointRef{index, static_cast<int>(body.points.size()) - 1};
    };
    if (node > 0) {
      Joint& joint = out_.joints.emplace_back();
      joint.kind = Joint::Kind::pin;
      joint.line = whole_.line;
      joint.a = previous_end_;
      joint.b = add_point(start_, {});
    }
    const int named = before != nullptr ? before->ends_at : node == 0 ? after->begins_at : -1;
    if (named >= 0) out_.points[named] = add_point(whole_.points[named].name, middle);
    if (!is_last) previous_end_ = add_point(end_, end);
    scene_.bodies[index] = std::move(body);
    out_.link.bodies.push_back(index);
  }

  /// sum_k l_k' phi_k, in angles between neighbours: the sum of all l_k' is zero.
  void add_springs(int element) {
    const double stiffness = section_.modulus * section_.second_moment / elements_[element].length;
    for (std::size_t g = 0; g < gauss_place.size(); ++g) {
      Element spring;
      spring.table = "spring";
      spring.name = whole_.name + " " + std::to_string(element + 1) + "." + std::to_string(g + 1);
      spring.line = whole_.line;
      std::vector<Measure::Term> terms;
      double factor = 0.0;
      for (int k = 0; k + 1 < nodes; ++k) {
        factor -= lagrange_slope(k, gauss_place[g]);
        const int node = 3 * element + k;
        terms.push_back({factor, Measure::angle_between(out_.link.bodies[node], out_.link.bodies[node + 1])});
      }
      spring.on = Measure::sum_of(std::move(terms));
      spring.law = LinearSpring{.stiffness = stiffness * gauss_weight[g]};
      out_.springs.push_back(std::move(spring));
    }
  }

  Scene& scene_;
  int first_;
  Body whole_;
  CrossSection section_;
  std::vector<BeamElement> elements_;
  std::string start_, end_;
  double length_ = 0.0;
  PointRef previous_end_{};
  FlexibleChain out_;
};

}  // namespace

double beam_element::lagrange(int k, double x) {
  double product = 1.0;
  for (int j = 0; j < nodes; ++j) {
    if (j != k) product *= (x - beam_element::place[j]) / (beam_element::place[k] - beam_element::place[j]);
  }
  return product;
}

double beam_element::lagrange_slope(int k, double x) {
  double below = 1.0, sum = 0.0;
  for (int j = 0; j < nodes; ++j) {
    if (j == k) continue;
    below *= beam_element::place[k] - beam_element::place[j];
    double product = 1.0;
    for (int m = 0; m < nodes; ++m) {
      if (m != k && m != j) product *= x - beam_element::place[m];
    }
    sum += product;
  }
  return sum / below;
}

FlexibleChain make_flexible(Scene& scene, int body, int elements) { return ChainMaker(scene, body, elements).run(); }

}  // namespace poise
