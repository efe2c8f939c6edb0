#include "motion/stick_slip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "model/joint_friction.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// Rates below this part of the largest yet are zero: events are located more closely.
constexpr double no_rate_of_friction = 1e-11;
/// Accelerations below this part of the largest of any choice are zero.
constexpr double no_acceleration = 1e-9;
/// And what rounding may leave of the terms of one, as many times what it may be off.
constexpr double rounded_acceleration = 1e-8;
/// A choice is consistent if forces and accelerations have the right sign but for this part.
constexpr double consistent = 1e-6;
/// What rounding may leave of a rate, as a part of the largest yet.
constexpr double slip_rounding = 1e-12;
/// And of the change of a rate in a short time, as a part of the fastest coordinate's.
constexpr double rounding_of_rate = 20 * std::numeric_limits<double>::epsilon();
/// A margin within this is not known by its sign: rounding of a state leaves less.
constexpr double unsure = 1e-11;
/// Choices are told apart after these parts of the time ahead: the shortest that shows a difference, before other
/// events can.
constexpr double parts_ahead[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2};
constexpr double tiny = std::numeric_limits<double>::min();

}  // namespace

StickSlip::StickSlip(const MotionModel& model, const std::vector<Variation>& variations,
                     const std::vector<Influence>& influences, const Reduced& motion)
    : model_(model), variations_(variations), influences_(influences) {
  const Scene& scene = model.scaled_scene();
  const Phasors<double>& phasors = model.mechanism().phasors();
  int scratch = 0;
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    if (!sticks(scene.elements[e].law)) continue;
    const Measure& on = scene.elements[e].on;
    const auto& law = std::get<DryFriction>(scene.elements[e].law);
    Contact contact{static_cast<int>(e), law.bound(), law.falls == DryFriction::Falls::drop, {}, {}};
    contact.on = {scene, model.layout(), phasors, on};
    contact.stop = stop_rubbed_by(scene, static_cast<int>(e));
    grows_ = grows_ || contact.stop >= 0;
    scratch = std::max(scratch, contact.on.scratch_size());
    for (const Variation& variation : variations) {
      contact.varied.push_back(variation.compiled().measure(variation.compiled().scene().elements[e].on));
    }
    contacts_.push_back(std::move(contact));
  }
  bool some_grip = false;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) some_grip = some_grip || grips(scene, static_cast<int>(j));
  grows_ = grows_ || some_grip;
  if (some_grip) {
    for (const Contact& contact : contacts_) {
      if (contact.stop < 0) branched_.push_back({contact.element, false});
    }
    for (int k = 0; k < motion.separating_teeth(); ++k) {
      branched_.push_back({static_cast<int>(scene.elements.size()) + k, true});
    }
  }
  pose_.resize(static_cast<std::size_t>(phasors.pose_size() + scratch));
}

Configuration<double> StickSlip::place(const CompiledMeasure<double>& on, const double* q) {
  const Phasors<double>& phasors = model_.mechanism().phasors();
  if (!on.is_linear()) phasors.place(q, pose_.data());
  return {phasors, pose_.data(), pose_.data() + phasors.pose_size()};
}

bool StickSlip::is_open(const Contact& contact, const Reduced& motion) {
  return contact.stop >= 0 && std::none_of(motion.touching().begin(), motion.touching().end(),
                                           [&](const Touch& touch) { return touch.stop == contact.stop; });
}

double StickSlip::rate(const Contact& contact, const Reduced& motion) {
  return contact.on.along(place(contact.on, motion.q()), motion.v());
}

double StickSlip::size_of_acceleration(const Contact& contact, const Reduced& motion) {
  const Configuration<double> here = place(contact.on, motion.q());
  double sum = std::abs(contact.on.second(here, motion.v(), motion.v()));
  contact.on.gradient(here, [&](int i, double by) {
    sum += std::abs(by * motion.a()[contact.on.support()[static_cast<std::size_t>(i)]]);
  });
  return sum;
}

double StickSlip::acceleration(const Contact& contact, const Reduced& motion) {
  const Configuration<double> here = place(contact.on, motion.q());
  return contact.on.along(here, motion.a()) + contact.on.second(here, motion.v(), motion.v());
}

std::vector<int> StickSlip::directions(const Reduced& motion) {
  std::vector<int> sliding(model_.scaled_scene().elements.size(), 1);
  for (const Contact& contact : contacts_) {
    sliding[static_cast<std::size_t>(contact.element)] = rate(contact, motion) < 0 ? -1 : 1;
  }
  return sliding;
}

double StickSlip::watch(const Reduced& motion) {
  for (Contact& contact : contacts_) {
    contact.rate = rate(contact, motion);
    contact.acceleration = acceleration(contact, motion);
    contact.speed = std::max(contact.speed, std::abs(contact.rate));
  }
  for (Branched& one : branched_) {
    one.load = std::max(one.load, std::abs(motion.load_bound(one.element)));
    one.turn = motion.branch_margin(one.element);
  }
  return margin(motion);
}

double StickSlip::dip(const Reduced& motion, double h) {
  for (const Contact& contact : contacts_) {
    const int s = motion.sliding()[contact.element];
    if (s == 0 || contact.idle || is_open(contact, motion)) continue;
    const double from = s * contact.rate, to = s * rate(contact, motion);
    const double falls = s * contact.acceleration * h, rises = s * acceleration(contact, motion) * h;
    if (!(falls < 0 && rises > 0)) continue;
    // from + falls x + b x^2 + a x^3,  0 < x < 1
    const double a = 2 * (from - to) + falls + rises;
    const double b = 3 * (to - from) - 2 * falls - rises;
    const double x = -falls / (b + std::sqrt(std::max(0.0, b * b - 3 * a * falls)));
    const double least = from + x * (falls + x * (b + x * a));
    if (x > 0 && x < 1 && least < -slip_rounding * std::max(contact.speed, std::abs(to))) return x * h;
  }
  return 0.0;
}

double StickSlip::margin_of(const Contact& contact, const Reduced& motion) {
  const int sliding = motion.sliding()[contact.element];
  if (sliding != 0) {
    const double now = rate(contact, motion);
    return sliding * now / (std::max(contact.speed, std::abs(now)) + tiny);
  }
  const auto h = std::find(motion.held().begin(), motion.held().end(), contact.element) - motion.held().begin();
  const double force = std::abs(motion.holding_force(static_cast<int>(h)));
  const double bound = contact.force + motion.load_bound(contact.element);
  return (bound - force) / (std::max(bound, force) + tiny);
}

double StickSlip::margin(const Reduced& motion) {
  double least = std::numeric_limits<double>::infinity();
  least_ = turning_ = none;
  for (std::size_t b = 0; b < branched_.size(); ++b) {
    const double turn = turn_margin_of(branched_[b], motion);
    if (turn < least) {
      least = turn;
      turning_ = b;
    }
  }
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (contacts_[c].idle || is_open(contacts_[c], motion)) continue;
    const double own = margin_of(contacts_[c], motion);
    if (!(own < least)) continue;
    least = own;
    least_ = c;
    turning_ = none;
  }
  return least;
}

double StickSlip::turn_margin_of(const Branched& branched, const Reduced& motion) {
  if (!branched.is_teeth && motion.sliding()[branched.element] == 0) return std::numeric_limits<double>::infinity();
  const double load = std::max(branched.load, std::abs(motion.load_bound(branched.element)));
  const double turn = motion.branch_margin(branched.element) / (load + tiny);
  // Without a force at the last node and here nothing turns.
  return turn == 0.0 && branched.turn == 0.0 ? std::numeric_limits<double>::infinity() : turn;
}

void StickSlip::meet(const Reduced& motion) {
  turned_ = turning_;
  met_ = turned_ == none ? least_ : none;
  met_slope_ = 0.0;
  others_.clear();
  if (met_ == none) {
    by_force_ = true;
    return;
  }
  const Contact& contact = contacts_[met_];
  by_force_ = motion.sliding()[contact.element] == 0;
  if (by_force_) return;
  const auto n = static_cast<std::size_t>(motion.coordinates());
  const Configuration<double> here = place(contact.on, motion.q());
  slope_.assign(n, 0.0);
  bend_.assign(n, 0.0);
  contact.on.add_gradient(here, 1.0, slope_.data());
  contact.on.add_bend(here, motion.v(), 1.0, bend_.data());
  direct_.clear();
  for (const Influence& influence : influences_) {
    const bool moves = influence.variation >= 0;
    direct_.push_back(moves ? rate_by(contact, motion, static_cast<std::size_t>(influence.variation)) : 0.0);
  }
  met_slope_ = acceleration(contact, motion);
}

/// Finds the derivatives of the acceleration with F_s in place of being held, of which the one by the time is a
/// difference.
void StickSlip::begin_to_slide(Reduced& motion, double t, double ahead) {
  if (met_ == none || !by_force_ || !contacts_[met_].drops) return;
  const Contact& contact = contacts_[met_];
  const auto n = static_cast<std::size_t>(motion.coordinates());
  const std::vector<double> q(motion.q(), motion.q() + n), v(motion.v(), motion.v() + n);
  const std::vector<int> held(motion.sliding(), motion.sliding() + model_.scaled_scene().elements.size());
  const auto row = std::find(motion.held().begin(), motion.held().end(), contact.element) - motion.held().begin();
  std::vector<int> begins = held;
  begins[static_cast<std::size_t>(contact.element)] = motion.holding_force(static_cast<int>(row)) < 0 ? -2 : 2;
  const std::vector<int> branches = motion.branches();
  const double h = ahead / 10;
  const std::pair<double, double> parts[] = {{-2.0, 1.0 / 12}, {-1.0, -2.0 / 3}, {1.0, 2.0 / 3}, {2.0, -1.0 / 12}};
  for (const auto& [steps, share] : parts) {
    if (set(motion, t, q, v, held) != Reduced::Status::ok) break;
    if (advance(motion, t, steps * h) != Reduced::Status::ok) break;
    const std::vector<double> q_there(motion.q(), motion.q() + n), v_there(motion.v(), motion.v() + n);
    if (set(motion, t + steps * h, q_there, v_there, begins) != Reduced::Status::ok) break;
    met_slope_ += share * acceleration(contact, motion) / h;
  }
  if (set(motion, t, q, v, begins) == Reduced::Status::ok) {
    motion.set_variations(variations_);
    motion.linearize();
    take_derivatives(motion, contact);
  } else {
    met_slope_ = 0.0;
  }
  set(motion, t, q, v, held);
  motion.set_branches(branches);
}

/// Finds the derivatives of  Dg[a] + D2g[v, v]  along changes of q and v, by influences, and by the values at which
/// others are held.
void StickSlip::take_derivatives(Reduced& motion, const Contact& contact) {
  const auto n = static_cast<std::size_t>(motion.coordinates());
  const Configuration<double> here = place(contact.on, motion.q());
  slope_.assign(n, 0.0);
  bend_.assign(n, 0.0);
  contact.on.add_bend(here, motion.v(), 2.0, slope_.data());
  contact.on.add_bend(here, motion.a(), 1.0, bend_.data());
  std::vector<double> unit(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    unit[i] = 1.0;
    bend_[i] += contact.on.third(here, motion.v(), motion.v(), unit.data());
    unit[i] = 0.0;
  }
  for (int k = 0; k < motion.freedoms(); ++k) {
    const auto i = static_cast<std::size_t>(motion.independent()[static_cast<std::size_t>(k)]);
    bend_[i] += contact.on.along(here, motion.a_z(k));
    slope_[i] += contact.on.along(here, motion.a_w(k));
  }
  std::vector<double> alpha(static_cast<std::size_t>(motion.freedoms())), a(n);
  const auto along_influence = [&](const Influence& influence) {
    motion.influence(influence, alpha.data());
    if (influence.moves()) return contact.on.along(here, motion.a_p());
    std::fill(a.begin(), a.end(), 0.0);
    for (std::size_t k = 0; k < alpha.size(); ++k) {
      for (std::size_t i = 0; i < n; ++i) a[i] += alpha[k] * motion.B(static_cast<int>(k))[i];
    }
    return contact.on.along(here, a.data());
  };
  direct_.clear();
  for (const Influence& influence : influences_) {
    double change = along_influence(influence);
    if (influence.variation >= 0) {
      const auto variation = static_cast<std::size_t>(influence.variation);
      const CompiledMeasure<VariedModel::Dual>& on = contact.varied[variation];
      const std::vector<VariedModel::Dual> rates(motion.v(), motion.v() + n), accelerations(motion.a(), motion.a() + n);
      change += variations_[variation].compiled().derivative(on, motion.q(), [&](const auto& there) {
        return on.along(there, accelerations.data()) + on.second(there, rates.data(), rates.data());
      });
    }
    direct_.push_back(change);
  }
  for (std::size_t h = 0; h < motion.held().size(); ++h) {
    Influence value;
    value.drive = motion.drives() - static_cast<int>(motion.held().size() - h);
    others_.push_back({motion.held()[h], along_influence(value)});
  }
}

double StickSlip::event_time_by(const Reduced& motion, const double* dq, const double* dv, int influence) {
  if (met_slope_ == 0.0) return 0.0;
  double change = influence >= 0 ? direct_[static_cast<std::size_t>(influence)] : 0.0;
  for (std::size_t i = 0; i < slope_.size(); ++i) change += slope_[i] * dv[i] + bend_[i] * dq[i];
  const int variation = influence >= 0 ? influences_[static_cast<std::size_t>(influence)].variation : -1;
  for (const OtherHeld& other : others_) change += other.by * held_value_by(motion, other.element, dq, variation);
  return -change / met_slope_;
}

Reduced::Status StickSlip::set(Reduced& motion, double t, const std::vector<double>& q, const std::vector<double>& v,
                               const std::vector<int>& sliding) const {
  motion.set_sliding(model_.scaled_scene(), sliding, q.data());
  motion.free_branches();
  motion.choose(t, q.data(), false);
  motion.expect(q.data());
  std::vector<double> z, w;
  for (const int i : motion.independent()) {
    z.push_back(q[static_cast<std::size_t>(i)]);
    w.push_back(v[static_cast<std::size_t>(i)]);
  }
  return motion.evaluate(t, z.data(), w.data());
}

Reduced::Status StickSlip::advance(Reduced& motion, double t, double h) {
  const std::size_t f = motion.independent().size();
  std::vector<double> start, sum(2 * f, 0.0), y(2 * f), slope(2 * f);
  for (const int i : motion.independent()) start.push_back(motion.q()[i]);
  for (const int i : motion.independent()) start.push_back(motion.v()[i]);
  constexpr double reach[] = {0.5, 0.5, 1.0, 1.0}, share[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  y = start;
  for (int stage = 0; stage < 4; ++stage) {
    std::copy(y.begin() + static_cast<std::ptrdiff_t>(f), y.end(), slope.begin());
    std::copy(motion.alpha(), motion.alpha() + f, slope.begin() + static_cast<std::ptrdiff_t>(f));
    for (std::size_t k = 0; k < 2 * f; ++k) sum[k] += share[stage] * slope[k];
    const std::vector<double>& along = stage < 3 ? slope : sum;
    for (std::size_t k = 0; k < 2 * f; ++k) y[k] = start[k] + reach[stage] * h * along[k];
    const Reduced::Status status = motion.evaluate(t + reach[stage] * h, y.data(), y.data() + f);
    if (status != Reduced::Status::ok) return status;
  }
  return Reduced::Status::ok;
}

/// The least margin of the contacts without rate a time h after the node: with the change of dg/dt over h times their
/// largest acceleration, s times that, and of those held minus its size and the margin of their force. Negative
/// infinity where what is held contradicts what is driven, NaN where the state cannot be had.
double StickSlip::worst_after(Reduced& motion, const Node& node, const std::vector<int>& sliding, double h) {
  if (set(motion, node.t, node.q, node.v, sliding) != Reduced::Status::ok) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Reduced::Status status = advance(motion, node.t, h);
  if (status == Reduced::Status::open) return -std::numeric_limits<double>::infinity();
  if (status != Reduced::Status::ok) return std::numeric_limits<double>::quiet_NaN();
  const Reduced::Opening opening = motion.fastest_opening();
  if (opening.size > std::max(consistent * opening.terms, rounding_of_rate * node.fastest)) {
    return -std::numeric_limits<double>::infinity();
  }
  double worst = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < node.still.size(); ++k) {
    const Contact& contact = contacts_[node.still[k]];
    const int s = sliding[static_cast<std::size_t>(contact.element)];
    const double gained = gain(contact, motion, node, k) / (h * node.largest[k]);
    worst = std::min(worst, s == 0 ? std::min(margin_of(contact, motion), -std::abs(gained)) : s * gained);
  }
  return worst;
}

/// Finds among choices that agree at the node the one that does shortly after.
const StickSlip::Trial* StickSlip::tell_apart(Reduced& motion, const Node& node, std::vector<const Trial*> trials,
                                              double ahead) {
  for (const double part : parts_ahead) {
    std::vector<const Trial*> left;
    const Trial* least_wrong = trials.front();
    double least = -std::numeric_limits<double>::infinity();
    for (const Trial* trial : trials) {
      const double worst = worst_after(motion, node, trial->sliding, part * ahead);
      if (!(worst < -unsure)) left.push_back(trial);
      if (!(worst > least)) continue;
      least = worst;
      least_wrong = trial;
    }
    if (left.empty()) return least_wrong;
    trials = std::move(left);
    if (trials.size() == 1) return trials.front();
  }
  // What has just reached its bound slides on.
  for (const Trial* trial : trials) {
    const bool holds_on =
        met_ != none && by_force_ && trial->sliding[static_cast<std::size_t>(contacts_[met_].element)] == 0;
    if (!holds_on) return trial;
  }
  return trials.front();
}

std::vector<const StickSlip::Trial*> StickSlip::that_hold(std::vector<const Trial*> trials,
                                                          const std::vector<std::size_t>& still) const {
  const auto held = [&](const Trial* trial) {
    return std::count_if(still.begin(), still.end(), [&](std::size_t c) {
      return contacts_[c].drops && trial->sliding[static_cast<std::size_t>(contacts_[c].element)] == 0;
    });
  };
  // What has just reached its bound slides.
  if (met_ != none && by_force_ && contacts_[met_].drops) {
    const auto holds_on = [&](const Trial* trial) {
      return trial->sliding[static_cast<std::size_t>(contacts_[met_].element)] == 0;
    };
    if (!std::all_of(trials.begin(), trials.end(), holds_on)) std::erase_if(trials, holds_on);
  }
  std::ptrdiff_t most = 0;
  for (const Trial* trial : trials) most = std::max(most, held(trial));
  std::erase_if(trials, [&](const Trial* trial) { return held(trial) < most; });
  return trials;
}

/// Gives the change since the node of the rate of the k-th contact without rate, 0 where that is rounding.
double StickSlip::gain(const Contact& contact, const Reduced& motion, const Node& node, std::size_t k) {
  const double out = rate(contact, motion) - node.rate[k];
  return std::abs(out) > rounding_of_rate * node.fastest ? out : 0.0;
}

/// Whether no motion of the freedoms left changes the measure.
bool StickSlip::is_carried(const Contact& contact, const Reduced& motion) {
  std::vector<double> slope(static_cast<std::size_t>(motion.coordinates()), 0.0);
  contact.on.add_gradient(place(contact.on, motion.q()), 1.0, slope.data());
  for (int k = 0; k < motion.freedoms(); ++k) {
    double change = 0.0, terms = 0.0;
    for (std::size_t i = 0; i < slope.size(); ++i) {
      change += slope[i] * motion.B(k)[i];
      terms += std::abs(slope[i] * motion.B(k)[i]);
    }
    if (std::abs(change) > no_acceleration * terms) return false;
  }
  return true;
}

StickSlip::Choice StickSlip::choose(Reduced& motion, double t, double ahead) {
  const auto n = static_cast<std::size_t>(motion.coordinates());
  Node node{t, {motion.q(), motion.q() + n}, {motion.v(), motion.v() + n}, {}, {}, {}};
  for (const double one : node.v) node.fastest = std::max(node.fastest, std::abs(one));
  const std::vector<int> before = motion.branches();
  std::vector<int> sliding = directions(motion);
  std::vector<std::size_t>& still = node.still;
  std::size_t choices = 1;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    contacts_[c].idle = false;
    if (is_open(contacts_[c], motion)) continue;
    const bool moves = c != met_ && std::abs(rate(contacts_[c], motion)) > no_rate_of_friction * contacts_[c].speed;
    if (moves) continue;
    still.push_back(c);
    if (still.size() > most_at_once) return Choice::failed;
    choices *= 3;
  }
  std::vector<Trial> trials;
  std::vector<double>& largest = node.largest;
  for (const std::size_t c : still) {
    node.rate.push_back(rate(contacts_[c], motion));
    largest.push_back(unsure * contacts_[c].speed / ahead + tiny);
  }
  bool no_forces = false;
  for (std::size_t choice = 0; choice < choices; ++choice) {
    std::size_t rest = choice;
    for (const std::size_t c : still) {
      constexpr int options[] = {0, 1, -1};
      sliding[static_cast<std::size_t>(contacts_[c].element)] = options[rest % 3];
      rest /= 3;
    }
    const Reduced::Status status = set(motion, t, node.q, node.v, sliding);
    const auto add_trial = [&](bool is_locked) {
      Trial trial{sliding, {}, {}, is_locked};
      for (std::size_t k = 0; k < still.size(); ++k) {
        const Contact& contact = contacts_[still[k]];
        trial.acceleration.push_back(acceleration(contact, motion));
        if (!is_locked) {
          largest[k] = std::max({largest[k], std::abs(trial.acceleration.back()),
                                 rounded_acceleration * size_of_acceleration(contact, motion)});
        }
        const bool is_held = sliding[static_cast<std::size_t>(contact.element)] == 0;
        trial.force.push_back(is_held ? margin_of(contact, motion) : 0.0);
      }
      trials.push_back(std::move(trial));
    };
    if (status == Reduced::Status::ok) add_trial(false);
    if (status != Reduced::Status::locked) continue;
    const FrictionForces::All all = motion.friction_forces().all();
    if (!all.complete) return Choice::locked;
    no_forces = no_forces || all.sizes.empty();
    for (const std::vector<double>& sizes : all.sizes) {
      if (motion.accelerate(&sizes) != Reduced::Status::ok) return Choice::locked;
      add_trial(true);
    }
  }
  if (trials.empty()) return no_forces ? Choice::locked : Choice::failed;
  std::vector<const Trial*> agreeing;
  for (Trial& trial : trials) {
    for (std::size_t k = 0; k < still.size(); ++k) {
      const int s = trial.sliding[static_cast<std::size_t>(contacts_[still[k]].element)];
      const double scale = trial.is_locked ? std::max(largest[k], std::abs(trial.acceleration[k])) : largest[k];
      // What repeats other rows here may not be held all the same.
      const double of_held = std::max(-trial.force[k], std::abs(trial.acceleration[k]) / scale);
      trial.violation = std::max(trial.violation, s == 0 ? of_held : -s * trial.acceleration[k] / scale);
    }
    if (!trial.is_locked && trial.violation < consistent) agreeing.push_back(&trial);
  }
  if (agreeing.empty()) {
    const bool locks = std::any_of(trials.begin(), trials.end(),
                                   [](const Trial& trial) { return trial.is_locked && trial.violation < consistent; });
    return locks ? Choice::locked : Choice::none;
  }
  agreeing = that_hold(std::move(agreeing), still);
  const std::vector<const Trial*> possible = agreeing;
  const Trial* const best =
      agreeing.size() == 1 ? agreeing.front() : tell_apart(motion, node, std::move(agreeing), ahead);
  for (const Trial& trial : trials) {
    if (!grows_ || trial.violation > no_acceleration) continue;
    // Some that agree may have been left out: they slide where others hold.
    if (!trial.is_locked && std::find(possible.begin(), possible.end(), &trial) == possible.end()) continue;
    for (std::size_t k = 0; k < still.size(); ++k) {
      const double apart = std::abs(trial.acceleration[k] - best->acceleration[k]);
      if (apart > consistent * largest[k]) return Choice::several;
    }
  }
  // Those whose rates stay zero are carried by what is held or driven.
  std::vector<char> rests(still.size(), 0);
  if (std::any_of(still.begin(), still.end(),
                  [&](std::size_t c) { return best->sliding[static_cast<std::size_t>(contacts_[c].element)] != 0; }) &&
      !std::isnan(worst_after(motion, node, best->sliding, ahead / 100))) {
    for (std::size_t k = 0; k < still.size(); ++k) {
      const Contact& contact = contacts_[still[k]];
      rests[k] = best->sliding[static_cast<std::size_t>(contact.element)] != 0 && is_carried(contact, motion) &&
                 std::abs(gain(contact, motion, node, k)) <= no_acceleration * ahead / 100 * largest[k];
    }
  }
  if (set(motion, t, node.q, node.v, best->sliding) != Reduced::Status::ok) return Choice::failed;
  for (std::size_t k = 0; k < still.size(); ++k) contacts_[still[k]].idle = rests[k] != 0;
  motion.follow_branches();
  // At the turn itself both branches agree but for rounding.
  if (turned_ != none) motion.turn_branch(branched_[turned_].element, before);
  return Choice::made;
}

double StickSlip::held_value_by(const Reduced& motion, int element, const double* dq, int variation) {
  const Contact& contact =
      *std::find_if(contacts_.begin(), contacts_.end(), [&](const Contact& one) { return one.element == element; });
  const Phasors<double>& phasors = model_.mechanism().phasors();
  phasors.place(motion.q(), pose_.data());
  const Configuration<double> here{phasors, pose_.data(), pose_.data() + phasors.pose_size()};
  double sum = contact.on.along(here, dq);
  if (variation < 0) return sum;
  return sum + value_by(contact, motion, static_cast<std::size_t>(variation));
}

double StickSlip::value_by(const Contact& contact, const Reduced& motion, std::size_t variation) const {
  const CompiledMeasure<VariedModel::Dual>& on = contact.varied[variation];
  return variations_[variation].compiled().derivative(on, motion.q(), [&](const auto& here) { return on.value(here); });
}

double StickSlip::rate_by(const Contact& contact, const Reduced& motion, std::size_t variation) const {
  const CompiledMeasure<VariedModel::Dual>& on = contact.varied[variation];
  const std::vector<VariedModel::Dual> v(motion.v(), motion.v() + motion.coordinates());
  return variations_[variation].compiled().derivative(on, motion.q(),
                                                      [&](const auto& here) { return on.along(here, v.data()); });
}

}  // namespace poise
