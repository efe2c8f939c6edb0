#include "statics/all_equilibria/turns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <variant>

namespace poise {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

// A constant torque is the same at every turn; dampers and friction are no part of statics.
bool tells_turns(const Element& element) {
  return counts_turns(element.on) && stores_energy(element.law) && idle(element.law).empty() &&
         !std::holds_alternative<ConstantForce>(element.law);
}

// factor[coordinate] += of the angles in g, those in profiles left out.
void add_angles(const Layout& layout, const Measure& g, double by, std::vector<double>& factor) {
  for (const Measure::Term& term : g.terms) {
    if (!term.profile) add_angles(layout, term.measure, by * term.factor, factor);
  }
  if (g.kind != Measure::Kind::angle) return;
  const auto add = [&](int body, double sign) {
    const int frame = layout.links[static_cast<std::size_t>(body)].frame;
    if (frame >= 0 && frame < static_cast<int>(factor.size())) factor[static_cast<std::size_t>(frame)] += sign * by;
  };
  add(g.body_b, 1.0);
  add(g.body_a, -1.0);
}

// Calls use(measure) for the measures in profiles, of which turns count by themselves.
template <class Use>
void in_profiles(const Measure& g, const Use& use) {
  for (const Measure::Term& term : g.terms) {
    if (term.profile && term.profile->counts_periods()) use(term.measure);
    in_profiles(term.measure, use);
  }
}

}  // namespace

bool counts_turns(const Measure& measure) {
  return measure.kind == Measure::Kind::angle ||
         std::any_of(measure.terms.begin(), measure.terms.end(), [](const Measure::Term& term) {
           return !(term.profile && !term.profile->counts_periods()) && counts_turns(term.measure);
         });
}

bool is_sum_of_angles(const Measure& measure) {
  return measure.kind == Measure::Kind::angle ||
         (measure.kind == Measure::Kind::sum &&
          std::all_of(measure.terms.begin(), measure.terms.end(),
                      [](const Measure::Term& term) { return !term.profile && is_sum_of_angles(term.measure); }));
}

Turns::Turns(const StaticModel& model) {
  const Layout& layout = model.layout();
  angles_ = std::min(layout.angles, layout.kept);
  const auto tell = [&](const Measure& g) {
    std::vector<double> factor(static_cast<std::size_t>(angles_), 0.0);
    add_angles(layout, g, 1.0, factor);
    Angle angle;
    for (int i = 0; i < angles_; ++i) {
      if (const double c = factor[static_cast<std::size_t>(i)]; c != 0.0) angle.push_back({i, c});
    }
    if (!angle.empty()) told_.push_back(std::move(angle));
  };
  for (const Element& element : model.scene().elements) {
    if (tells_turns(element)) tell(element.on);
  }
  for (const Stop& stop : model.scene().stops) {
    tell(stop.on);
    in_profiles(stop.on, tell);
  }
  // Angles of one told sum turn together, and that sum stays if its factors add up to zero.
  group_.resize(static_cast<std::size_t>(angles_));
  std::iota(group_.begin(), group_.end(), 0);
  const auto join = [&](int from, int to) { std::replace(group_.begin(), group_.end(), from, to); };
  for (const Angle& angle : told_) {
    for (const Term& term : angle) {
      const int a = group_[static_cast<std::size_t>(angle.front().coordinate)];
      const int b = group_[static_cast<std::size_t>(term.coordinate)];
      join(std::max(a, b), std::min(a, b));
    }
    const double sum =
        std::accumulate(angle.begin(), angle.end(), 0.0, [](double s, const Term& t) { return s + t.factor; });
    if (sum != 0.0) join(group_[static_cast<std::size_t>(angle.front().coordinate)], -1);
  }
}

bool Turns::count(int coordinate) const {
  return std::any_of(told_.begin(), told_.end(), [&](const Angle& angle) {
    return std::any_of(angle.begin(), angle.end(), [&](const Term& term) { return term.coordinate == coordinate; });
  });
}

double Turns::distance(const std::vector<double>& a, const std::vector<double>& b) const {
  double far = 0.0;
  std::vector<double> turned(static_cast<std::size_t>(angles_), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    double apart = a[i] - b[i];
    if (i < turned.size()) {
      turned[i] = std::round(apart / full_turn);
      apart -= full_turn * turned[i];
    }
    far = std::max(far, std::abs(apart));
  }
  for (const Angle& angle : told_) {
    double change = 0.0;
    for (const Term& term : angle) change += term.factor * turned[static_cast<std::size_t>(term.coordinate)];
    if (std::abs(change) > 1e-9) return std::numeric_limits<double>::infinity();
  }
  return far;
}

std::vector<double> Turns::reduced(std::vector<double> x) const {
  const std::vector<double> given = x;
  for (std::size_t i = 0; i < group_.size(); ++i) {
    if (group_[i] < 0) continue;
    const double leader = given[static_cast<std::size_t>(group_[i])];
    x[i] = given[i] - full_turn * std::round(leader / full_turn);
  }
  return x;
}

}  // namespace poise
