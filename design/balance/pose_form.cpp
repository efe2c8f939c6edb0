#include "design/balance/pose_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "model/input_error.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

constexpr double same_length = 1e-12;  // of the size: lengths that differ by rounding only
constexpr double same_pose = 1e-8;     // of the size: vectors that are opposite in the assembled start

const Scene& without_couplings(const Scene& scene) {
  for (const Stop& stop : scene.stops) {
    if (!stop.holds()) continue;
    throw InputError(
        fmt::format("{}:{}: {} \"{}\": balancing in closed form knows pins, slides, welds and bars only, "
                    "found a coupling; leave it out",
                    scene.file, stop.line, stop.family(), stop.name));
  }
  if (!scene.flexible_links.empty()) {
    const FlexibleLink& link = scene.flexible_links.front();
    throw InputError(
        fmt::format("{}:{}: body.{}: balancing needs rigid bodies, found a link that bends; leave out flexible",
                    scene.file, scene.bodies[link.bodies.front()].line, link.name));
  }
  return scene;
}

// The whole scene: every spring must enter the layout, also one whose stiffness is still 0.
Scene with_stiff_springs(Scene scene) {
  for (Element& element : scene.elements) {
    if (auto* spring = std::get_if<LinearSpring>(&element.law); spring && spring->stiffness == 0.0) {
      spring->stiffness = 1.0;
    }
    if (auto* spring = std::get_if<PreloadedSpring>(&element.law); spring && spring->stiffness == 0.0) {
      spring->stiffness = 1.0;
    }
  }
  return scene;
}

// Newton's method with steps of least norm on the closures; false where it does not converge.
bool close_loops(const std::vector<PhasorTerms>& closures, const std::vector<int>& coordinates, double size,
                 std::vector<double>& q) {
  constexpr int most_steps = 60;
  constexpr double longest = 0.5;
  if (closures.empty()) return true;
  const auto rows = static_cast<Eigen::Index>(2 * closures.size());
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < most_steps; ++step) {
    Eigen::VectorXd gap(rows);
    Eigen::MatrixXd by(rows, static_cast<Eigen::Index>(coordinates.size()));
    for (std::size_t c = 0; c < closures.size(); ++c) {
      const auto row = static_cast<Eigen::Index>(2 * c);
      const Vec2 open = PoseForm::value(closures[c], q);
      gap[row] = open.x / size;
      gap[row + 1] = open.y / size;
      for (std::size_t k = 0; k < coordinates.size(); ++k) {
        const Vec2 d = PoseForm::derivative(closures[c], coordinates[k], q);
        by(row, static_cast<Eigen::Index>(k)) = d.x / size;
        by(row + 1, static_cast<Eigen::Index>(k)) = d.y / size;
      }
    }
    const double open = gap.cwiseAbs().maxCoeff();
    if (open < 1e-15 || (open < 1e-13 && open >= last)) return true;
    last = open;
    Eigen::VectorXd move = solvers::minimum_norm_solution<double>(by, -gap, solvers::known_to::solution);
    const double most = move.cwiseAbs().maxCoeff();
    if (!(most < 1e100)) return false;
    if (most > longest) move *= longest / most;
    for (std::size_t k = 0; k < coordinates.size(); ++k) q[coordinates[k]] += move[static_cast<Eigen::Index>(k)];
  }
  return last < 1e-12;
}

}  // namespace

PhasorTerms sum(PhasorTerms a, const PhasorTerms& b, double factor) {
  for (const auto& [phasor, coefficient] : b) a[phasor] += factor * coefficient;
  return a;
}

PoseForm::PoseForm(const Scene& scene)
    : scene_(without_couplings(scene)), layout_(lay_out(with_stiff_springs(scene), Purpose::dynamics)) {
  follows_.resize(layout_.coordinates.size());
  for (const Coordinate& c : layout_.coordinates) start_.push_back(c.start);
  update();
  if (!close_loops(closures_, coordinates_, size(), start_)) {
    throw InputError(scene.file + ": expected loops that close near the start; correct [start]");
  }
  find_parallelograms();
}

void PoseForm::add(PhasorTerms& out, int length, int angle, Vec2 coefficient) const {
  if (angle >= 0 && follows_[angle].follows) {
    coefficient = coefficient * follows_[angle].factor;
    angle = follows_[angle].coordinate;
  }
  out[{length, angle}] += coefficient;
}

PhasorTerms PoseForm::terms_of(const std::vector<Arm>& arms) const {
  PhasorTerms out;
  for (const Arm& arm : arms) {
    const Vec2 turn = unit(layout_.turns[arm.turn].to<double>());
    const bool along = layout_.is_length(arm.coordinate);
    const Vec2 c = (along ? direction<double>(arm.arm) : arm.arm) * turn;
    add(out, along ? arm.coordinate : -1, along ? layout_.coordinates[arm.coordinate].frame : arm.coordinate, c);
  }
  return out;
}

PhasorTerms PoseForm::place(int body, Vec2 local) const {
  PhasorTerms out = terms_of(layout_.path(0, {}, body, {}));
  const Link& link = layout_.links[body];
  add(out, -1, link.frame, local * unit(layout_.turns[link.turn].to<double>()));
  return out;
}

AngleForm PoseForm::angle(int body) const {
  const Link& link = layout_.links[body];
  AngleForm out{link.frame, layout_.turns[link.turn].to<double>()};
  if (out.coordinate >= 0 && follows_[out.coordinate].follows) {
    const Follows& to = follows_[out.coordinate];
    out.constant += to.constant;
    out.coordinate = to.coordinate;
  }
  return out;
}

Vec2 PoseForm::value(const PhasorTerms& terms, const std::vector<double>& q) {
  Vec2 out{};
  for (const auto& [phasor, coefficient] : terms) {
    const Vec2 turned = phasor.angle >= 0 ? coefficient * unit(q[phasor.angle]) : coefficient;
    out += (phasor.length >= 0 ? q[phasor.length] : 1.0) * turned;
  }
  return out;
}

Vec2 PoseForm::derivative(const PhasorTerms& terms, int coordinate, const std::vector<double>& q) {
  Vec2 out{};
  for (const auto& [phasor, coefficient] : terms) {
    if (phasor.angle != coordinate && phasor.length != coordinate) continue;
    const Vec2 turned = phasor.angle >= 0 ? coefficient * unit(q[phasor.angle]) : coefficient;
    if (phasor.length == coordinate) {
      out += turned;
    } else {
      out += (phasor.length >= 0 ? q[phasor.length] : 1.0) * quarter_turn(turned);
    }
  }
  return out;
}

// Closures in the coordinates that are left, without those that are zero.
void PoseForm::update() {
  closures_.clear();
  for (const Closure& closure : layout_.closures) {
    PhasorTerms kept;
    for (const auto& [phasor, coefficient] : terms_of(closure.arms)) {
      if (norm(coefficient) > same_length * (phasor.length >= 0 ? 1.0 : size())) kept[phasor] = coefficient;
    }
    if (!kept.empty()) closures_.push_back(std::move(kept));
  }
  coordinates_.clear();
  for (std::size_t t = 0; t < layout_.coordinates.size(); ++t) {
    if (!follows_[t].follows) coordinates_.push_back(static_cast<int>(t));
  }
}

// exp(i angle) = factor exp(i coordinate) from now on, also for angles that followed this one.
bool PoseForm::follow(int angle, int coordinate, Vec2 factor) {
  if (angle < 0) {
    std::swap(angle, coordinate);
    factor = conj(factor);
  }
  if (angle < 0 || angle == coordinate) return false;
  factor = (1 / norm(factor)) * factor;
  const double constant = start_[angle] - (coordinate >= 0 ? start_[coordinate] : 0.0);
  follows_[angle] = {coordinate, factor, constant, true};
  for (Follows& one : follows_) {
    if (!one.follows || one.coordinate != angle) continue;
    one = {coordinate, one.factor * factor, one.constant + constant, true};
  }
  return true;
}

void PoseForm::find_parallelograms() {
  // Pairs (a, b) of vectors of a loop are sought whose sums vanish in the start; the other two of four are then
  // opposite.
  const auto found_in = [&](const PhasorTerms& closure) {
    std::vector<std::pair<Phasor, Vec2>> terms(closure.begin(), closure.end());
    if (terms.size() != 2 && terms.size() != 4) return false;
    for (const auto& term : terms) {
      if (term.first.length >= 0) return false;
    }
    const auto opposite = [&](std::size_t a, std::size_t b) {
      if (std::abs(norm(terms[a].second) - norm(terms[b].second)) > same_length * size()) return false;
      return norm(value({terms[a], terms[b]}, start_)) < same_pose * size();
    };
    const auto tie = [&](std::size_t a, std::size_t b) {
      // c_a phi_a + c_b phi_b = 0.
      const Vec2 ratio = -1.0 * (terms[a].second * conj(terms[b].second));
      return follow(terms[b].first.angle, terms[a].first.angle, ratio);
    };
    if (terms.size() == 2) return opposite(0, 1) && tie(0, 1);
    constexpr std::array<std::array<std::size_t, 4>, 3> pairings{{{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};
    for (const auto& [a, b, c, d] : pairings) {
      if (!opposite(a, b) || !opposite(c, d)) continue;
      ++parallelograms_;
      tie(a, b);
      tie(c, d);
      return true;
    }
    return false;
  };
  bool is_new = true;
  while (is_new) {
    is_new = false;
    for (const PhasorTerms& closure : closures_) {
      if (!found_in(closure)) continue;
      is_new = true;
      break;
    }
    update();
  }
}

std::vector<double> PoseForm::closed(std::vector<double> q) const {
  if (!close_loops(closures_, coordinates_, size(), q)) return {};
  for (std::size_t t = 0; t < follows_.size(); ++t) {
    const Follows& to = follows_[t];
    if (to.follows) q[t] = to.constant + (to.coordinate >= 0 ? q[to.coordinate] : 0.0);
  }
  return q;
}

std::map<std::string, double> PoseForm::named(const std::vector<double>& q) const {
  std::map<std::string, double> out;
  for (std::size_t t = 0; t < layout_.coordinates.size(); ++t) out[layout_.coordinates[t].name] = q[t];
  return out;
}

}  // namespace poise
