#include "statics/all_equilibria/private/index_sum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <variant>
#include <vector>

#include "model/phasor_sum.hpp"
#include "statics/all_equilibria/turns.hpp"

namespace poise {
namespace {

constexpr double length_rounding = 1e-9;  // of sums of lengths, relative to all of them
constexpr std::size_t most_edges = 20;    // of which all sets are formed

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<double> lengths_of(const PhasorSum<double>& sum) {
  std::vector<double> out{norm(sum.constant())};
  for (const auto& term : sum.terms()) out.push_back(norm(term.coefficient));
  return out;
}

bool can_vanish(const StaticModel& model, const Measure& distance) {
  const double unit = model.scales().per_length();
  const Scene& scene = model.scene();
  const std::vector<Arm> arms = model.layout().path(distance.a.body, unit * scene.local(distance.a), distance.b.body,
                                                    unit * scene.local(distance.b));
  const std::vector<double> lengths = lengths_of({model.mechanism().phasors(), arms});
  const double longest = *std::max_element(lengths.begin(), lengths.end());
  const double all = sum_of(lengths);
  return longest <= all - longest + length_rounding * all;
}

bool can_vanish_in(const StaticModel& model, const Measure& on) {
  if (on.kind == Measure::Kind::sum) {
    return std::any_of(on.terms.begin(), on.terms.end(),
                       [&](const Measure::Term& term) { return can_vanish_in(model, term.measure); });
  }
  for (std::size_t k = 1; k < on.contacts.size(); ++k) {
    if (can_vanish(model, Measure::distance_between(on.contacts[k - 1].at, on.contacts[k].at))) return true;
  }
  return on.kind == Measure::Kind::distance && can_vanish(model, on);
}

// Whether the force vanishes where two points coincide, so that the direction between them, which is lost, does not
// matter. In a sum of distances it need not.
bool is_continuous(const StaticModel& model, const Measure& on, const Law& law) {
  const auto* spring = std::get_if<LinearSpring>(&law);
  const bool vanishes = on.kind == Measure::Kind::distance && spring != nullptr &&
                        (spring->free_length == 0.0 || spring->acts == LinearSpring::Acts::tension);
  return vanishes || !can_vanish_in(model, on);
}

bool has_smooth_loads(const StaticModel& model) {
  const Scene& scene = model.scene();
  return scene.stops.empty() && !Turns(model).count() &&
         std::all_of(scene.elements.begin(), scene.elements.end(), [&](const Element& element) {
           return !stores_energy(element.law) || is_continuous(model, element.on, element.law);
         });
}

// Of the polygons with these edges, one of which is fixed; empty where some polygon can be stretched to a line.
std::optional<long> polygon_characteristic(std::vector<double> edges) {
  const std::size_t n = edges.size();
  if (n < 3 || n > most_edges) return std::nullopt;
  std::iter_swap(edges.begin(), std::max_element(edges.begin(), edges.end()));
  const double all = sum_of(edges);
  std::vector<long> a(n, 0);  // a_k
  for (std::size_t set = 1; set < (std::size_t{1} << n); set += 2) {
    double length = 0.0;
    std::size_t members = 0;
    for (std::size_t e = 0; e < n; ++e) {
      if ((set >> e & 1U) == 0) continue;
      length += edges[e];
      ++members;
    }
    if (std::abs(2.0 * length - all) <= length_rounding * all) return std::nullopt;
    if (2.0 * length < all) ++a[members - 1];
  }
  long out = 0;
  for (std::size_t k = 0; k <= n - 3; ++k) out += (k % 2 == 0 ? 1 : -1) * (a[k] + a[n - 3 - k]);
  return out;
}

}  // namespace

std::optional<long> index_sum(const StaticModel& model) {
  const Layout& layout = model.layout();
  if (layout.kept > layout.angles || !has_smooth_loads(model)) return std::nullopt;
  std::vector<char> taken(static_cast<std::size_t>(layout.kept), 0);
  long out = 1;
  for (const Closure& closure : layout.closures) {
    const PhasorSum<double> loop(model.mechanism().phasors(), closure.arms);
    for (const auto& term : loop.terms()) {
      if (taken[static_cast<std::size_t>(term.coordinate)]++ != 0) return std::nullopt;
    }
    std::vector<double> edges = lengths_of(loop);
    // Without a fixed edge the whole polygon turns, a circle of poses for each.
    const bool turns = edges.front() <= length_rounding * sum_of(edges);
    if (turns) edges.erase(edges.begin());
    const std::optional<long> polygons = polygon_characteristic(edges);
    if (!polygons) return std::nullopt;
    out *= turns ? 0 : *polygons;
  }
  const bool outside = std::find(taken.begin(), taken.end(), 0) != taken.end();
  return outside ? 0 : out;
}

}  // namespace poise
