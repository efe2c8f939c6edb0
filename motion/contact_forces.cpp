#include "motion/contact_forces.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "statics/bodies/contact_loads.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/static_model.hpp"

namespace poise {
namespace {

constexpr double no_press = std::numeric_limits<double>::quiet_NaN();
constexpr double never = std::numeric_limits<double>::infinity();
/// Share of the largest force below which p is rounding.
constexpr double nothing_presses = 1e-9;
/// Parts into which an interval is cut in each round of a search: a round is one run through the range.
constexpr int parts_of_round = 16;
constexpr int most_rounds = 20;
/// Extremes are found within this part of the range, as closely as rounding of p lets them be told apart.
constexpr double extreme_within = 1e-9;

/// Values at shares of the range, which ascend; fewer where the range ends early.
using Over = std::function<std::vector<double>(const std::vector<double>&)>;

std::vector<double> parts_between(double from, double to, int parts) {
  std::vector<double> out;
  for (int k = 0; k <= parts; ++k) out.push_back(from + (to - from) * k / parts);
  return out;
}

/// Where a sign that is `before` at `from` and not at `to` changes.
double change_between(const Over& of, const std::function<bool(double)>& before, double from, double to) {
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<double> places = parts_between(from, to, parts_of_round);
    const std::vector<double> values = of(places);
    std::size_t k = 1;
    while (k + 1 < values.size() && before(values[k])) ++k;
    if (k >= values.size()) break;
    if (places[k] == to && places[k - 1] == from) break;
    from = places[k - 1];
    to = places[k];
    if (to - from <= 2 * std::numeric_limits<double>::epsilon() * std::max(std::abs(from), std::abs(to))) break;
  }
  return (from + to) / 2;
}

struct Extreme {
  double place = 0.0, value = 0.0;
};

/// The least value between two places, where there is one minimum.
Extreme least_within(const Over& of, double from, double to) {
  Extreme out{from, never};
  for (int round = 0; round < most_rounds && to - from > extreme_within; ++round) {
    const std::vector<double> places = parts_between(from, to, parts_of_round);
    const std::vector<double> values = of(places);
    std::size_t best = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] < values[best] || std::isnan(values[best])) best = k;
    }
    if (values.empty() || std::isnan(values[best])) break;
    if (values[best] < out.value) out = {places[best], values[best]};
    from = places[best == 0 ? 0 : best - 1];
    to = places[std::min(best + 1, values.size() - 1)];
  }
  return out;
}

/// Whether a parabola may dip far below a value that is no more than its neighbours.
bool may_dip(double before, double here, double after) {
  if (!(here <= before) || !(here <= after)) return false;
  return here - (std::max(before, after) - here) < 0.0;
}

double press_of(const Scene& scene, const Contact& contact, const Forces& forces) {
  if (forces.friction.has_no_forces()) return no_press;
  const Reaction* const reaction = reaction_of_stop(forces.reactions, contact.stop);
  if (reaction == nullptr) return no_press;
  return (contact.at_max ? -1.0 : 1.0) * effort_of(scene.stops[contact.stop], *reaction);
}

double largest_of(const std::vector<Forces>& poses) {
  double out = 0.0;
  for (const Forces& forces : poses) out = std::max(out, forces.largest_force);
  return out;
}

/// What counts as rounding of p: of a moment that of the largest force at the size of the mechanism.
double rounding_of(const MotionModel& model, const Contact& contact, double largest_force) {
  const bool is_moment = model.scene().stops[contact.stop].on.is_angle();
  return nothing_presses * largest_force * (is_moment ? model.scales().length : 1.0);
}

/// Poses of a range, and forces there at any rate.
class DrivenContacts {
 public:
  DrivenContacts(const MotionModel& model, const std::vector<DriveRange>& ranges, const SweepOptions& options)
      : model_(model), ranges_(ranges), options_(options) {
    options_.rate = 1.0;
  }

  struct Place {
    double drive = 0.0;
    std::vector<double> x, v, a;  ///< scaled; at the rate 1
  };

  std::vector<Place> at(const std::vector<double>& shares) const {
    SweepOptions options = options_;
    options.at = shares;
    std::vector<Place> out;
    const std::size_t first = first_moving(ranges_);
    const KinematicsResult path = sweep(model_.scene(), ranges_, options);
    for (const KinematicSample& sample : path.samples) {
      if (out.size() == shares.size()) break;
      out.push_back({sample.drive[first], model_.from_si(sample.q), model_.from_si(sample.rate),
                     model_.from_si(sample.acceleration)});
    }
    return out;
  }

  Forces forces(const Place& place, double rate) const {
    std::vector<double> v = place.v, a = place.a;
    for (double& one : v) one *= rate;
    for (double& one : a) one *= rate * rate;
    return forces_of(model_, place.x, v, a, model_.scene().drives);
  }

  double press(const Contact& contact, const Place& place, double rate) const {
    return press_of(model_.scene(), contact, forces(place, rate));
  }

  /// The least rate at which a contact would have to pull at this place: 0 where it does at rest.
  double lift_off_rate(const Contact& contact, const Place& place, double guess) const {
    constexpr int most_steps = 40;
    constexpr double near_enough = 1e-7;  // where parabolas fit, the next is exact to rounding
    double rate = guess;
    for (int step = 0; step < most_steps; ++step) {
      // The parabola through p at rate/2, rate and 3/2 rate.
      const Forces middle = forces(place, rate);
      const double low = press(contact, place, rate / 2), high = press(contact, place, 3 * rate / 2);
      const double here = press_of(model_.scene(), contact, middle);
      if (std::isnan(low + here + high)) return never;
      const double c = 2 * (low - 2 * here + high), b = high - low - 2 * c, a = here - b - c;  // over rate
      const double rounding = rounding_of(model_, contact, middle.largest_force);
      if (a < -rounding) return 0.0;
      const double root = least_root(std::max(a, 0.0), b, c);
      if (!std::isfinite(root) || root == 0.0) return root;
      if (std::abs(root - 1) <= near_enough) return rate * root;
      rate *= root;
    }
    return rate;
  }

 private:
  /// Least positive root of a + b s + c s^2 with a >= 0; none: infinite.
  static double least_root(double a, double b, double c) {
    if (c == 0.0) return b < 0.0 ? -a / b : never;
    const double inner = b * b - 4 * a * c;
    if (inner < 0.0) return never;
    const double q = -(b + std::copysign(std::sqrt(inner), b)) / 2;
    double out = never;
    for (const double root : {q / c, q == 0.0 ? never : a / q}) {
      if (root > 0.0 && root < out) out = root;
    }
    // Without force at rest it lifts off at once where p falls.
    if (a == 0.0 && (b < 0.0 || (b == 0.0 && c < 0.0))) return 0.0;
    return out;
  }

  const MotionModel& model_;
  const std::vector<DriveRange>& ranges_;
  SweepOptions options_;
};

/// Changes of sign of sampled values, which are refined by `of`, and the least value; places are shares.
struct PressCourse {
  Extreme least{0.0, no_press};
  std::vector<std::pair<double, bool>> changes;  ///< and whether p is positive from there on
};

PressCourse course_of(const Over& of, const std::vector<double>& shares, const std::vector<double>& values,
                      double rounding) {
  PressCourse out;
  std::vector<std::pair<double, double>> known;  // shares and values, with extremes between
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isnan(values[k])) continue;
    const bool has_neighbours = k > 0 && k + 1 < values.size();
    for (const double sign : {1.0, -1.0}) {
      if (!has_neighbours || sign * values[k] <= 0.0) continue;
      if (!may_dip(sign * values[k - 1], sign * values[k], sign * values[k + 1])) continue;
      const Over turned = [&](const std::vector<double>& at) {
        std::vector<double> found = of(at);
        for (double& one : found) one *= sign;
        return found;
      };
      const Extreme dip = least_within(turned, shares[k - 1], shares[k + 1]);
      if (dip.value >= -rounding) continue;
      known.emplace_back(dip.place, sign * dip.value);
    }
    known.emplace_back(shares[k], values[k]);
  }
  std::sort(known.begin(), known.end());
  int sign = 0;
  std::size_t last = 0;
  for (std::size_t k = 0; k < known.size(); ++k) {
    const double value = known[k].second;
    const int now = value > rounding ? 1 : value < -rounding ? -1 : 0;
    if (now == 0) continue;
    if (sign != 0 && now != sign) {
      // Where p is zero for a while its sign there is rounding.
      const double from = k == last + 1 ? 0.0 : -rounding;
      const auto before = [&](double p) { return sign * p > from; };
      out.changes.emplace_back(change_between(of, before, known[last].first, known[k].first), now > 0);
    }
    sign = now;
    last = k;
  }
  std::size_t best = values.size();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isnan(values[k]) && (best == values.size() || values[k] < values[best])) best = k;
  }
  if (best == values.size()) return out;
  out.least = {shares[best], values[best]};
  if (values.size() > 1) {
    const Extreme refined =
        least_within(of, shares[best == 0 ? 0 : best - 1], shares[std::min(best + 1, values.size() - 1)]);
    if (refined.value < out.least.value) out.least = refined;
  }
  return out;
}

/// The course of a contact whose places are from + share * length.
ContactCourse in_places(const Contact& contact, const PressCourse& course, double rounding, double from,
                        double length) {
  ContactCourse out;
  out.contact = contact;
  out.least = course.least.value;
  out.least_at = from + course.least.place * length;
  out.pulls = out.least < -rounding;
  for (const auto& [share, presses] : course.changes) out.changes.push_back({from + share * length, presses});
  return out;
}

/// The polynomial through six values around, or all where there are fewer, at `t`; `interval` begins at that index.
double between_samples(const std::vector<double>& time, const std::vector<double>& value, std::size_t interval,
                       double t) {
  const std::size_t wide = std::min<std::size_t>(6, time.size());
  const std::size_t first = std::min(interval - std::min<std::size_t>(interval, 2), time.size() - wide);
  double out = 0.0;
  for (std::size_t i = first; i < first + wide; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + wide; ++j) {
      if (j != i) weight *= (t - time[j]) / (time[i] - time[j]);
    }
    out += weight * value[i];
  }
  return out;
}

}  // namespace

std::vector<Contact> contacts_to_hold(const Scene& scene) {
  std::vector<Contact> out;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    const bool may_open = stop.table == "cam" || stop.table == "rope" || stop.table == "chain";
    if (may_open && !stop.holds()) out.push_back({s, false, std::isinf(stop.min)});
  }
  if (out.empty()) return out;
  Scene undriven = scene;
  undriven.drives.clear();
  forget_functions_of_drives(undriven);
  const Mobility mobility = analyse_mobility(StaticModel(undriven));
  const int left = mobility.freedoms - static_cast<int>(scene.drives.size());
  if (left < static_cast<int>(out.size())) out.clear();
  return out;
}

Scene held_in_contact(Scene scene, const std::vector<Contact>& contacts) {
  for (const Contact& contact : contacts) {
    Stop& stop = scene.stops[contact.stop];
    (contact.at_max ? stop.min : stop.max) = contact.at_max ? stop.max : stop.min;
  }
  return scene;
}

std::vector<Contact> contacts_along(const Scene& scene, const std::vector<Contact>& held) {
  std::vector<Contact> out = held;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const bool is_held = std::any_of(held.begin(), held.end(), [s](const Contact& one) { return one.stop == s; });
    if (scene.stops[s].table == "cam" && scene.stops[s].holds() && !is_held) out.push_back({s, true, false});
  }
  std::sort(out.begin(), out.end(), [](const Contact& a, const Contact& b) { return a.stop < b.stop; });
  return out;
}

std::vector<ContactCourse> contact_courses(const MotionModel& model, const std::vector<DriveRange>& ranges,
                                           const SweepOptions& options, bool moving,
                                           const std::vector<Contact>& contacts, const ForcesAlong& found) {
  if (found.at.empty()) return contact_courses(model.scene(), contacts, found);
  const DrivenContacts driven(model, ranges, options);
  const DriveRange& range = ranges[first_moving(ranges)];
  const double rate = moving ? options.rate : 0.0;
  std::vector<double> shares;
  for (const double at : found.at) shares.push_back((at - range.from) / (range.to - range.from));
  std::vector<ContactCourse> out;
  for (const Contact& contact : contacts) {
    const Over of = [&](const std::vector<double>& at) {
      std::vector<double> values;
      for (const DrivenContacts::Place& place : driven.at(at)) values.push_back(driven.press(contact, place, rate));
      return values;
    };
    std::vector<double> values;
    for (const Forces& forces : found.poses) values.push_back(press_of(model.scene(), contact, forces));
    const double rounding = rounding_of(model, contact, largest_of(found.poses));
    out.push_back(
        in_places(contact, course_of(of, shares, values, rounding), rounding, range.from, range.to - range.from));
  }
  return out;
}

std::vector<ContactCourse> contact_courses(const Scene& scene, const std::vector<Contact>& contacts,
                                           const ForcesAlong& found) {
  std::vector<Contact> all = contacts;
  for (const Forces& forces : found.poses) {
    for (const auto& [stop, at_max] : forces.pulling) {
      const auto is_it = [index = stop](const Contact& one) { return one.stop == index; };
      if (std::none_of(all.begin(), all.end(), is_it)) all.push_back({stop, false, at_max});
    }
  }
  std::vector<ContactCourse> out;
  for (const Contact& contact : all) {
    std::vector<double> at, values;
    for (std::size_t k = 0; k < found.poses.size(); ++k) {
      const double press = press_of(scene, contact, found.poses[k]);
      if (std::isnan(press)) continue;
      at.push_back(found.at.empty() ? 0.0 : found.at[k]);
      values.push_back(press);
    }
    const double rounding = found.tolerance * largest_of(found.poses);
    const Over of = [&](const std::vector<double>& times) {
      std::vector<double> between;
      for (const double t : times) {
        const auto after = std::upper_bound(at.begin(), at.end(), t);
        const auto interval = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - at.begin() - 1, 0));
        between.push_back(between_samples(at, values, std::min(interval, at.size() - 1), t));
      }
      return between;
    };
    out.push_back(in_places(contact, course_of(of, at, values, rounding), rounding, 0.0, 1.0));
  }
  return out;
}

std::vector<LiftOff> lift_offs(const MotionModel& model, const std::vector<DriveRange>& ranges,
                               const SweepOptions& options, const std::vector<Contact>& contacts) {
  const DrivenContacts driven(model, ranges, options);
  const DriveRange& range = ranges[first_moving(ranges)];
  const std::vector<double> shares = parts_between(0.0, 1.0, options.steps);
  std::vector<LiftOff> out;
  for (const Contact& contact : contacts) {
    const Over of = [&](const std::vector<double>& at) {
      std::vector<double> rates;
      for (const DrivenContacts::Place& place : driven.at(at)) {
        rates.push_back(driven.lift_off_rate(contact, place, options.rate));
      }
      return rates;
    };
    const std::vector<double> rates = of(shares);
    Extreme best{0.0, never};
    for (std::size_t k = 0; k < rates.size(); ++k) {
      if (rates[k] < best.value) best = {shares[k], rates[k]};
    }
    for (std::size_t k = 0; k < rates.size() && best.value > 0.0; ++k) {
      if (!std::isfinite(rates[k])) continue;
      const double before = k == 0 ? never : rates[k - 1], after = k + 1 < rates.size() ? rates[k + 1] : never;
      if (rates[k] > before || rates[k] > after) continue;
      const Extreme refined = least_within(of, shares[k == 0 ? 0 : k - 1], shares[std::min(k + 1, rates.size() - 1)]);
      if (refined.value < best.value) best = refined;
    }
    LiftOff& one = out.emplace_back();
    one.contact = contact;
    one.at = range.from + best.place * (range.to - range.from);
    if (std::isfinite(best.value)) one.rate = best.value;
  }
  return out;
}

}  // namespace poise
