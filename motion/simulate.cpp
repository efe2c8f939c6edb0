#include "motion/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/joint_friction.hpp"
#include "motion/blades.hpp"
#include "motion/contacts.hpp"
#include "motion/controller_efforts.hpp"
#include "motion/delays.hpp"
#include "motion/motion_error.hpp"
#include "motion/motion_step.hpp"
#include "motion/motion_writer.hpp"
#include "motion/private/quintic.hpp"
#include "motion/profile_borders.hpp"
#include "motion/rolling_forces.hpp"
#include "motion/samples.hpp"
#include "motion/sensitivity_columns.hpp"
#include "motion/simulation_words.hpp"
#include "motion/singular_passage.hpp"
#include "motion/singular_state.hpp"
#include "motion/step_ends.hpp"
#include "motion/step_error.hpp"
#include "motion/stick_slip.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;
using stepping::eps;

/// Relative pivots below this are avoided: ill-conditioned loops amplify rounding by its inverse cube.
constexpr double comfortable_pivot = 1e-3;
/// Closures and drives whose singular values differ by less than this ratio have nearly lost rank.
constexpr double nearly_singular = 1e-2;
/// Part of the duration within which a dead centre is looked for where no step succeeds.
constexpr double looked_ahead = 0.01;
/// Bounces that rise less, in sizes of the mechanism or rad, are over; so are those with rates within the accuracy.
constexpr double least_bounce = 1e-13;
/// A gap that comes so near to zero, in accuracies of the motion, or would only just pass it, may close or not.
constexpr double grazing = 10.0;
/// More changes of what is touched or held at one time never end.
constexpr int most_events_here = 100;
/// So do as many that are apart by a millionth of the duration at most: hops in a corner whose heights do not fall.
constexpr int most_events_in_row = 20'000;
/// Rates after impacts, over those before, up to which they are rounding.
constexpr double no_rebound = 1e-12;
/// Joints and drives that are open by more, over the mechanism's size or rad, are open.
constexpr double joints_closed_within = 1e-9;

/// A jump of what a controller decides, or of one of its derivatives, comes back after the delay as one of a derivative
/// that is higher by two, or by one: beyond this many times the integrator is of no higher order.
constexpr int most_echoes = 8;
/// Steps between which delayed efforts are read have a reading error that is less by this.
constexpr double read_by_delays = 100.0;

/// The slope of the Quintic over a step of h, at its part x. Where the places differ from the integral of the cubic
/// through rates and accelerations by rounding alone that cubic is it: over short steps the slope of places is
/// rounding.
double rate_within(double h, double x, double z0, double w0, double a0, double z1, double w1, double a1) {
  constexpr double rounding = 16 * eps;
  const double defect = z1 - z0 - h * ((w0 + w1) / 2 + h * (a0 - a1) / 12), y = 1 - x;
  const double cubic = y * y * ((1 + 2 * x) * w0 + h * x * a0) + x * x * ((1 + 2 * y) * w1 - h * y * a1);
  return std::abs(defect) <= rounding * (std::abs(z0) + std::abs(z1)) ? cubic : cubic + 30 * defect / h * x * x * y * y;
}

/// The coordinates of a mechanism with controllers, without the states of these; none of another.
std::vector<int> coordinates_of_controlled(const MotionModel& model) {
  const std::vector<int> states = states_of_controllers(model.scene(), model.layout());
  const auto controls = [](const Element& element) { return element.feedback.has_value(); };
  const std::vector<Element>& elements = model.scene().elements;
  if (std::none_of(elements.begin(), elements.end(), controls)) return {};
  std::vector<int> out;
  for (int i = 0; i < model.layout().kept; ++i) {
    if (std::find(states.begin(), states.end(), i) == states.end()) out.push_back(i);
  }
  return out;
}

/// The times at which the formulas of loads and drives change, and at which controllers decide.
class InputBreaks {
 public:
  InputBreaks(const std::vector<MotionInput>& inputs, const Samples& samples, double duration)
      : samples_(samples), duration_(duration) {
    for (const MotionInput& input : inputs) {
      const std::vector<double> breaks = input.breaks();
      all_.insert(all_.end(), breaks.begin(), breaks.end());
      if (input.jumps()) jumps_.insert(jumps_.end(), breaks.begin(), breaks.end());
    }
    std::sort(all_.begin(), all_.end());
  }

  /// The end of the motion, or of the smooth part of its inputs, after t. Breaks so near to t that the integrator could
  /// not make a step to them are passed over.
  double next(double t) {
    const double shortest = apart();
    while (next_ < all_.size() && all_[next_] <= t + shortest) ++next_;
    double in_list = next_ < all_.size() && all_[next_] < duration_ - shortest ? all_[next_] : duration_;
    const auto echo = echoes_.upper_bound(t + shortest);
    if (echo != echoes_.end() && echo->first < in_list - shortest) in_list = echo->first;
    const double sample = samples_.next(t, shortest);
    return sample < in_list - shortest ? sample : in_list;
  }
  /// What delays bring back.
  struct Echo {
    int order = 0;  ///< passes through the mechanism since what jumped, each of which makes it smoother
    /// Each entry says, by the index of the delay behind which it comes back, how often it has passed each delay.
    std::map<std::size_t, std::vector<int>> passes{};
    /// Whether what jumps there has passed delays in several ways.
    bool is_mixed = false;

    bool comes_back() const { return !passes.empty(); }
  };
  /// What controllers decide with these delays is not smooth at t: nor is what they give later. Behind a new cause, and
  /// where what comes back `is_rough`, which jumps or has a slope that does, it is as behind the first. Where they
  /// `are_chained` what comes back makes what is decided jump at once.
  void add_echoes(double t, const std::vector<double>& delays, bool is_new_cause, bool is_rough, bool are_chained) {
    const Echo behind = echo(t);
    const bool is_first = is_new_cause || !behind.comes_back();
    const int order = is_first || is_rough ? 0 : behind.order + 1;
    if (order >= most_echoes) return;
    const std::vector<int> before = is_first ? std::vector<int>(delays.size()) : behind.passes.begin()->second;
    const bool differ = std::any_of(behind.passes.begin(), behind.passes.end(),
                                    [&](const auto& other) { return other.second != before; });
    const bool is_mixed = are_chained && is_rough && behind.comes_back() && (is_new_cause || behind.is_mixed || differ);
    for (std::size_t d = 0; d < delays.size(); ++d) {
      // Sums of delays that are equal differ by rounding.
      const double later = t + delays[d];
      auto place = echoes_.lower_bound(later - apart());
      const bool is_new = place == echoes_.end() || place->first > later + apart();
      if (is_new) place = echoes_.emplace(later, Echo{order}).first;
      if (order < place->second.order) place->second = Echo{order};
      if (order > place->second.order) continue;
      std::vector<int>& passes = place->second.passes[d];
      passes = before;
      ++passes[d];
      place->second.is_mixed = place->second.is_mixed || is_mixed;
    }
    echoes_.erase(echoes_.begin(), echoes_.lower_bound(t - apart()));
  }
  Echo echo(double t) const {
    const auto at = echoes_.lower_bound(t - apart());
    return at != echoes_.end() && at->first <= t + apart() ? at->second : Echo();
  }
  /// Whether a formula changes at t, or controllers decide.
  bool are_at(double t) const {
    const auto at = std::lower_bound(all_.begin(), all_.end(), t - apart());
    return samples_.are_at(t, apart()) || (at != all_.end() && *at <= t + apart());
  }
  /// Times that are so near to each other are one.
  double apart() const { return 1e-9 * duration_; }

  /// Whether a load or drive jumps at t.
  bool jumps(double t) const { return std::find(jumps_.begin(), jumps_.end(), t) != jumps_.end(); }

 private:
  const Samples& samples_;
  double duration_;
  std::vector<double> all_;  // ascending
  std::vector<double> jumps_;
  std::size_t next_ = 0;           // of all_
  std::map<double, Echo> echoes_;  // by the times that delays make
};

/// Integrates one motion: makes steps, and goes on in other formulas where inputs, friction or profiles change.
class Simulation {
 public:
  Simulation(const MotionModel& model, const MotionState& start, const MotionOptions& options)
      : model_(model),
        options_(options),
        reduced_(model.scaled_scene(), model.mechanism(), model.inertia()),
        friction_(model, options.variations, options.influences, reduced_),
        contacts_(model, options.variations),
        rolling_(model),
        borders_(model, options.variations, options.influences),
        samples_(model, options.variations, options.influences),
        delays_(model, options),
        inputs_(with_inputs_of(model.scene(), options.inputs)),
        breaks_(inputs_, samples_, options.duration),
        q_start_(model.from_si(start.q)),
        columns_(model, options, first_choice()),
        step_(model, options, reduced_, columns_.count()),
        nodes_(model, columns_, q_start_, out_),
        error_(reduced_, step_, nodes_, columns_, q_start_,
               !inputs_.empty() || friction_.acts() || !controllers_of(model.scene()).empty()),
        ends_(reduced_, step_, friction_, contacts_, borders_) {
    out_.freedoms = columns_.freedoms();
    out_.independent = columns_.independent();
    out_.states = states_of_controllers(model.scene(), model.layout());
    controlled_ = coordinates_of_controlled(model);
    std::vector<int> influences;
    for (int c = 0; c < columns_.count(); ++c) influences.push_back(columns_.influence_of(c));
    delays_.set_columns(std::move(influences));
    const std::vector<double> v = model.from_si(start.v);
    set_state(q_start_.data(), v.data(), 0.0);
    const int f = reduced_.freedoms();
    for (int c = 0; c < std::min(columns_.count(), 2 * f); ++c) step_.y[step_.sensitivity(c, c)] = 1.0;
  }

  Motion run() {
    const auto begun = std::chrono::steady_clock::now();
    move_along();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
    out_.microseconds = took.count();
    out_.evaluations = step_.evaluations();
    out_.energy_error = energy_error(out_);
    out_.singular = zero_crossings(out_.trajectory.t, nodes_.pivots());
    for (const Passed& passed : passed_) {
      // Steps of uneven length beside it are no poses of their own.
      constexpr double beside = 10.0;
      std::erase_if(out_.singular, [&](double t) { return std::abs(t - passed.time) < beside * passed.length; });
      out_.singular.push_back(passed.time);
    }
    std::sort(out_.singular.begin(), out_.singular.end());
    return std::move(out_);
  }

 private:
  /// Prepares the equations and chooses the first independent coordinates.
  std::vector<int> first_choice() {
    reduced_.set_inputs(model_.scaled_scene(), scaled(inputs_, model_.scene(), model_.scales()));
    if (delays_.act()) reduced_.set_past(&delays_);
    refuse_reading_of_impacts();
    refuse_unknown_derivatives();
    refuse_idle_controllers(model_);
    contacts_.refuse_start(q_start_.data());
    reduced_.begin(0.0, q_start_.data(), options_.independent.empty() ? nullptr : &options_.independent);
    refuse_idle_blades();
    return reduced_.independent();
  }

  void refuse_idle_blades() {
    if (reduced_.blades() == 0) return;
    std::vector<double> z;
    for (const int i : reduced_.independent()) z.push_back(q_start_[static_cast<std::size_t>(i)]);
    if (reduced_.place(0.0, z.data()) == Reduced::Status::ok) poise::refuse_idle_blades(model_, reduced_);
    reduced_.expect(q_start_.data());
  }

  /// Throws InputError where a controller integrates a force that impacts make infinite.
  void refuse_reading_of_impacts() const {
    const Scene& scene = model_.scene();
    if (std::all_of(scene.stops.begin(), scene.stops.end(), [](const Stop& one) { return one.holds(); })) return;
    for (const Element& one : scene.elements) {
      if (!one.feedback || !one.feedback->reads_reaction() || controller_of(one.law)->has(Controller::period)) continue;
      throw InputError(fmt::format(
          "{}:{}: controller \"{}\".reads: an impact makes the force in a joint or of a drive infinite for an instant; "
          "expected a period beside it, with which it is read at samples, or a scene without stops and contacts",
          scene.file, one.line, one.name));
    }
  }

  /// Throws InputError for derivatives that are not known.
  void refuse_unknown_derivatives() const {
    refuse_periods();
    if (options_.sensitivities) delays_.refuse_derivatives(contacts_.act() || friction_.acts());
    if (!options_.sensitivities || !friction_.acts()) return;
    const auto refuse = [&](const TimeFunction& function, int number, double) {
      if (function.is_smooth_in(number)) return;
      throw InputError(
          fmt::format("{}: {} \"{}\": with friction that sticks the derivative by the time of a step is "
                      "not known; expected another number, or friction of some width",
                      model_.scene().file, function.of == TimeFunction::Of::drive ? "drive" : "load",
                      name_of(model_.scene(), function)));
    };
    for (const Influence& influence : options_.influences) {
      influence.for_each_function(model_.scene(), refuse);
      influence.for_each_function_of_drives(model_.scene(), refuse);
    }
  }

  /// Throws InputError for derivatives by the period of a controller, with which the times of its samples move.
  void refuse_periods() const {
    const auto refuse = [&](std::size_t e) {
      const Element& element = model_.scene().elements[e];
      throw InputError(fmt::format(
          "{}:{}: controller \"{}\".period: the derivative of a motion by it is not known; expected another number",
          model_.scene().file, element.line, element.name));
    };
    for (const Influence& influence : options_.influences) {
      const ForceNumber& number = influence.force;
      if (influence.moves() || influence.body >= 0 || number.of != ForceNumber::Of::element) continue;
      const auto e = static_cast<std::size_t>(number.item);
      const Element& element = model_.scene().elements[e];
      const std::span<const Number> all = numbers_of(element.law);
      if (element.feedback && all[static_cast<std::size_t>(number.number)].key == "period") refuse(e);
    }
    for (const Variation& variation : options_.variations) {
      for (const int e : controllers_of(model_.scene())) {
        const auto& law = *controller_of(variation.compiled().mechanism().law_of(e));
        if (law.values[Controller::period].v[0] != 0.0) refuse(static_cast<std::size_t>(e));
      }
    }
  }

  /// Sets the state to these coordinates and rates, without sensitivities.
  void set_state(const double* q, const double* v, double work) {
    const int f = reduced_.freedoms();
    step_.y.assign(step_.size(), 0.0);
    step_.y[static_cast<std::size_t>(2 * f)] = work;
    for (int k = 0; k < f; ++k) {
      const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
      step_.y[static_cast<std::size_t>(k)] = q[i];
      step_.y[static_cast<std::size_t>(f + k)] = v[i];
    }
  }

  // --- steps --------------------------------------------------------------------------------------------------------

  void move_along() {
    double h = 0.0;
    if (!begin(h)) return;
    for (double t = 0.0; t < options_.duration;) {
      if (!may_go_on(t)) return;
      if (rolling_.act()) {
        rolling_margin_ = rolling_.margin(reduced_);
        if (rolling_margin_ < -stepping::past) return lift_off(t);
      }
      const double end = breaks_.next(t);
      const double left = end - t;
      // A very short last step is shared with the one before.
      const bool last = h >= left * (1 - 1e-12);
      if (last)
        h = left;
      else if (h > 0.5 * left)
        h = 0.5 * left;
      if (!make_step(t, h)) {
        if (h > 1e-13 * options_.duration && h > 1e-15 * (1 + t)) continue;
        if (passes_singular_pose(t, h)) continue;
        return give_up(t);
      }
      const StepEnds::Border border = borders_.act() ? ends_.meets_border(t) : StepEnds::Border{};
      const double to_border = step_.length;
      Event event;
      event.hits = contacts_.act() && ends_.meets_hit(t);
      const double to_hit = step_.length;
      // Gaps that could not be followed over more will not be over the next step.
      if (!event.hits && to_hit < to_border) h = std::min(h, 2 * to_hit);
      const bool switches = can_switch() && ends_.meets_event(t);
      if (switches) meet(event, to_hit);
      if (contacts_.act() && !event.hits) note_grazing(t);
      const bool lifts = rolling_.act() && meets_lift_off(t);
      const bool changes = switches || event.hits;
      t = last && step_.length == left ? end : t + step_.length;
      ++out_.steps;
      step_.accept();
      if (delays_.act() && !keep_decided(t)) return;
      if (reduced_.blades() > 0 && !hold_blades(t)) return;
      add_node(t);
      if (is_torn(t) || runs_away(t)) return;
      if (lifts) return lift_off(t);
      if (t == end && !cross_break(t)) return;
      if (changes && !change_mode(t, event)) return;
      if (changes) ends_.forget_approach();
      const bool crosses = border.is_reached && !changes && step_.length == to_border;
      h = length_near_border(h, border, crosses);
      if (crosses && !cross_border(t)) return;
      if (delays_.act() && (t == end || changes || crosses) && !hear_of_it(t, changes || crosses)) return;
      if (options_.progress) options_.progress(t);
      if (step_.has_poor_coordinates()) choose_anew(t);
    }
    out_.status = MotionStatus::completed;
  }

  /// Shortens the step just made from t to where a wheel that rolls would have to be pulled from there on.
  bool meets_lift_off(double t) {
    const auto margin = [this] { return rolling_.margin(reduced_); };
    const double at_end = margin();
    if (!(at_end < -stepping::past)) return false;
    step_.shorten_to_zero(t, rolling_margin_, step_.length, at_end, margin);
    return true;
  }

  void lift_off(double t) {
    stop(MotionStatus::lifted_off,
         fmt::format("at t = {:.9g} s the {} lifts off: it would have to be pulled from there on; give a [[contact]] "
                     "with friction, which may lift off and touch again",
                     t, model_.scene().stops[static_cast<std::size_t>(rolling_.least())].title()));
  }

  /// Takes from the rates across blades what is rounding and the error of the last step, so that it does not grow.
  bool hold_blades(double t) {
    reduced_.hold_blades(&step_.y[static_cast<std::size_t>(reduced_.freedoms())]);
    if (step_.evaluate(t)) return true;
    give_up(t);
    return false;
  }

  /// Evaluates the start and finds the length of the first step. False if the motion ends there.
  bool begin(double& h) {
    reduced_.set_singular_limit(0.0);
    reduced_.expect(q_start_.data());
    reduced_.set_near(breaks_.next(0.0) / 2);
    step_.remake();
    if (!step_.evaluate(0.0)) {
      give_up(0.0);
      return false;
    }
    avoid_singular_poses();
    refuse_contradicting_drives(model_, reduced_);
    refuse_rates_across_blades(model_, reduced_);
    if (reduced_.blades() > 0 && !hold_blades(0.0)) return false;
    h = ahead_ = first_step();
    add_node(0.0);
    if (is_torn(0.0)) return false;
    if (samples_.act() && !take_samples(0.0)) return false;
    if (delays_.act() && !begin_delays()) return false;
    const bool touches = contacts_.act() && contacts_.is_near();
    return (!friction_.acts() && !touches) || change_mode(0.0, {.hits = touches});
  }

  /// What happens at the end of a step besides breaks and borders.
  struct Event {
    bool hits = false;            ///< the gap of a stop closes
    bool of_friction = false;     ///< something begins to slide or is held
    std::optional<Touch> left{};  ///< the force at a limit of a stop that is touched falls to zero
    double nudge = 0.0;           ///< time by which the formulas that hold from here on are those of later
  };

  bool can_switch() const { return friction_.acts() || !reduced_.touching().empty(); }

  /// Notes what the event is that ends the step just made, which passed a length `to_hit` at which a gap closes.
  void meet(Event& event, double to_hit) {
    event.hits = event.hits && step_.length == to_hit;
    event.of_friction = friction_.acts() && ends_.is_of_friction();
    if (event.of_friction)
      friction_.meet(reduced_);
    else
      event.left = contacts_.least();
    // A force may fall to zero at a border, where accelerations jump: from here on the next piece holds.
    if (borders_.act()) event.nudge = std::min(borders_.nudge_at_border(reduced_), 1e-10 * options_.duration);
  }

  void note_grazing(double t) {
    const std::optional<Touch> near = contacts_.grazed(reduced_, step_.length, grazing * options_.accuracy);
    if (near)
      out_.events.push_back({.t = t + step_.length, .kind = ContactEvent::Kind::graze, .at = *near, .unique = false});
  }

  bool may_go_on(double t) {
    if (options_.interrupt != nullptr && options_.interrupt->load()) {
      stop(MotionStatus::interrupted, fmt::format("interrupted at t = {:.6g} s", t));
      return false;
    }
    if (out_.steps + out_.rejected >= options_.most_steps) {
      stop(MotionStatus::step_limit, fmt::format("{} steps reached only t = {:.6g} s", out_.steps, t));
      return false;
    }
    return true;
  }

  double first_step() {
    double fastest = 0.0;
    if (reduced_.freedoms() > 0) {
      reduced_.linearize();
      for (int k = 0; k < reduced_.freedoms(); ++k) {
        for (int j = 0; j < reduced_.freedoms(); ++j) {
          fastest = std::max({fastest, std::sqrt(std::abs(reduced_.alpha_z(k)[j])), std::abs(reduced_.alpha_w(k)[j])});
        }
      }
    }
    const auto follow = [&](double frequency) {
      fastest = std::max(fastest, 6.3 * frequency);
      shortest_period_ = std::min(shortest_period_, 1 / frequency);
    };
    for (const Drive& d : model_.scaled_scene().drives) {
      follow(d.frequency);
      fastest = std::max({fastest, std::abs(d.rate), std::sqrt(std::abs(d.acceleration))});
    }
    for (const MotionInput& input : inputs_) {
      const double frequency = input.function ? input.function->law.frequency() : 0.0;
      if (frequency > 0.0) follow(frequency);
    }
    error_.set_fastest(fastest);
    const double natural = fastest > 0 ? 0.05 / fastest : 0.01 * options_.duration;
    return std::min(natural, options_.duration);
  }

  void avoid_singular_poses() { limit_ = std::min(comfortable_pivot, 0.1 * reduced_.pivot()); }

  /// Tries a step of h from t; on failure h is made shorter, on success it is the next one.
  bool make_step(double t, double& h) {
    const double accuracy = options_.accuracy / 1000;
    if (reduced_.rank() > 0 && nodes_.nodes() > nodes_.piece_from() + 2) {
      h = std::min(steered_step(nodes_.times(), nodes_.pivots(), h), breaks_.next(t) - t);
    }
    // Forces of what is held follow loads and drives, whatever moves.
    if (can_switch() && (StickSlip::holds(reduced_) || !reduced_.touching().empty())) {
      h = std::min(h, shortest_period_ / 4);
    }
    if (delays_.act()) h = std::min(h, delays_.shortest());
    double limit = limit_;
    for (int attempt = 0; attempt < 12; ++attempt) {
      reduced_.set_singular_limit(limit);
      const bool evaluated = step_.make(t, h);
      reduced_.set_singular_limit(0.0);
      if (evaluated) {
        const double read_within = 1000 * accuracy / (delays_.act() ? read_by_delays : 1.0);
        const double error = std::max(error_.of_state(t, h, accuracy), error_.of_reading(t, h) / read_within);
        if (error <= 1.0) {
          step_.length = h;
          h = solvers::next_step(h, error);
          return true;
        }
        ++out_.rejected;
        h = std::isfinite(error) ? solvers::next_step(h, error) : h / 5;
        // Without independent coordinates the pose alone says on which branch of the loops the motion is, and from a
        // pose far away what touches could be found to touch elsewhere.
        if (reduced_.freedoms() == 0 || !reduced_.touching().empty()) step_.return_to_node(t);
        return false;
      }
      ++out_.rejected;
      step_.return_to_node(t);
      if (step_.status() != Reduced::Status::singular) {
        h /= 4;
        return false;
      }
      // Steps that avoid the singular pose are about as long; a mechanism that stays near one must be allowed to reach
      // it.
      h *= attempt % 2 == 0 ? 0.83 : 1.1;
      if (attempt >= 5) limit *= 0.1;
    }
    h /= 4;
    return false;
  }

  /// The length of the next step, which would be h: shorter towards a border and behind one that is crossed.
  double length_near_border(double h, const StepEnds::Border& border, bool crosses) {
    if (departures_ > 0) {
      h = onward_ * std::pow(stepping::shorter_at_border, --departures_);
      if (departures_ == 0) onward_ = 0.0;
    }
    if (border.rest > 0.0) {
      onward_ = std::max(onward_, h);
      h = (1 + stepping::shorter_at_border) * border.rest;
    }
    if (crosses) {
      onward_ = std::max(h, onward_);
      departures_ = stepping::steps_at_border;
      h = onward_ * std::pow(stepping::shorter_at_border, departures_);
    }
    return h;
  }

  void add_node(double t) {
    step_.node.assign(reduced_.q(), reduced_.q() + q_start_.size());
    nodes_.add(t, reduced_, step_);
    ends_.watch();
  }

  /// Ends the motion where a joint or a drive is open at the last node by more than rounding of the loops: its equation
  /// repeated others at the start, but does not here.
  bool is_torn(double t) {
    const Reduced::Opening gap = reduced_.widest_gap();
    if (gap.row < 0) return false;
    if (gap.size > out_.gap || out_.gap_of.empty()) {
      out_.gap = gap.size;
      out_.gap_of = name_of_row(model_, gap.row, reduced_.touching());
    }
    if (gap.size <= joints_closed_within + 2e3 * eps / (reduced_.pivot() + eps)) return false;
    nodes_.drop();
    stop(MotionStatus::torn,
         fmt::format("at t = {:.9g} s {} is open by {:.3g} of the mechanism's size, or rad: at the start its equation "
                     "repeats those of other joints and drives, but not beyond; the mechanism is mobile there only "
                     "infinitesimally, or its drives contradict each other",
                     t, out_.gap_of, gap.size));
    return true;
  }

  /// Ends the motion of a controlled mechanism that becomes faster without end.
  bool runs_away(double t) {
    if (controlled_.empty()) return false;
    int fastest = -1;
    for (const int i : controlled_) {
      const double speed = std::abs(reduced_.v()[i]);
      if (speed > fastest_controlled && (fastest < 0 || speed > std::abs(reduced_.v()[fastest]))) fastest = i;
    }
    if (fastest < 0) return false;
    const bool turns = !model_.layout().is_length(fastest);
    stop(MotionStatus::ran_away,
         fmt::format("at t = {:.9g} s \"{}\" is faster than {:g} {}: its controllers let it run away, or ask for "
                     "such a rate",
                     t, model_.layout().coordinates[static_cast<std::size_t>(fastest)].name, fastest_controlled,
                     turns ? "rad/s" : "sizes of the mechanism per second"));
    return true;
  }

  /// Where everything is driven and steps cannot end near a singular pose: goes on behind it, at t, if rates go on
  /// there as they were: h is as long as that took. Towards a dead centre they grow without bound, and there is no pose
  /// behind.
  bool passes_singular_pose(double& t, double& h) {
    constexpr double wider = 2.0, stays_within = 0.05;
    const std::vector<double>& pivots = nodes_.pivots();
    if (reduced_.freedoms() > 0 || reduced_.rank() == 0 || can_switch() || columns_.count() > 0) return false;
    std::size_t from = nodes_.nodes() - 1;
    while (from > nodes_.piece_from() && pivots[from] < wider * pivots.back()) --from;
    const double since = t - nodes_.times()[from];
    if (!(pivots[from] > pivots.back()) || !(since > 0.0)) return false;
    // With finite rates pivots fall in proportion to the time.
    const double ahead = pivots.back() * since / (pivots[from] - pivots.back()), later = t + 2 * ahead;
    if (later >= breaks_.next(t) || later <= t) return false;
    const double way = since + 2 * ahead;
    std::vector<double> q, v;
    double fastest = 0.0;
    for (std::size_t i = 0; i < q_start_.size(); ++i) {
      const NodeValues at = nodes_.at(from, i);
      q.push_back(at.q + way * (at.v + way / 2 * at.a));
      v.push_back(at.v + way * at.a);
      fastest = std::max({fastest, std::abs(at.v), std::abs(v.back())});
    }
    const double before = step_.dydt[0], work = step_.work();
    if (reduced_.choose(later, q.data(), true) != Reduced::Status::ok) return false;
    reduced_.expect(q.data());
    if (reduced_.evaluate(later, nullptr, nullptr) != Reduced::Status::ok) return false;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (!(std::abs(reduced_.q()[i] - q[i]) <= stays_within * way * fastest)) return false;
      if (!(std::abs(reduced_.v()[i] - v[i]) <= stays_within * fastest)) return false;
    }
    set_state(reduced_.q(), reduced_.v(), work);
    step_.remake();
    if (!step_.evaluate(later)) return false;
    step_.y[0] = work + ahead * (before + step_.dydt[0]);
    h = later - t;
    t = later;
    add_node(t);
    nodes_.begin_smooth();
    passed_.push_back({t - h / 2, h});
    return true;
  }

  // --- other formulas, from the last node on ------------------------------------------------------------------------

  /// Goes on from a break of the inputs, where the motion's formula changes and its accelerations may jump.
  bool cross_break(double t) {
    nodes_.begin_smooth();
    if (t >= options_.duration) return true;
    reduced_.set_near((t + breaks_.next(t)) / 2);
    if (!step_.evaluate(t)) {
      give_up(t);
      return false;
    }
    if (samples_.are_at(t, breaks_.apart()) && !take_samples(t)) return false;
    // What rests may begin to move where a drive or a load begins to change.
    if (can_switch()) return change_mode(t, {});
    if (!breaks_.jumps(t)) return true;
    if (columns_.count() > 0) {
      follow_jumps(t);
      step_.evaluate(t);
    }
    add_node(t);
    nodes_.begin_piece();
    return true;
  }

  /// Goes on from the last node, at t, with what controllers decide there, and hold until their next samples.
  bool take_samples(double t) {
    const std::vector<Samples::Held> held = samples_.take(reduced_, t, breaks_.apart());
    std::vector<double> dq(q_start_.size()), dv(q_start_.size());
    for (int c = 0; c < columns_.count(); ++c) {
      nodes_.read_places_by(static_cast<std::size_t>(c), dq);
      nodes_.read_rates_by(static_cast<std::size_t>(c), dv);
      for (const Samples::Held& one :
           samples_.take_by(reduced_, t, breaks_.apart(), dq, dv, columns_.influence_of(c))) {
        step_.y[step_.sensitivity(row_of_rate(one.coordinate), c)] = one.rate;
      }
    }
    return go_on_with(t, held);
  }

  /// Goes on from the last node, at t, with these rates of coordinates that are states of controllers.
  template <class Given>
  bool go_on_with(double t, const std::vector<Given>& given) {
    set_rates(given);
    return go_on_from(t);
  }
  /// Goes on from the last node, at t, with the state as it is.
  bool go_on_from(double t) {
    if (!step_.evaluate(t)) {
      give_up(t);
      return false;
    }
    add_node(t);
    nodes_.begin_piece();
    return true;
  }
  template <class Given>
  void set_rates(const std::vector<Given>& given) {
    for (const Given& one : given) step_.y[static_cast<std::size_t>(row_of_rate(one.coordinate))] = one.rate;
  }
  int row_of_rate(int coordinate) const {
    const std::vector<int>& all = reduced_.independent();
    return reduced_.freedoms() + static_cast<int>(std::find(all.begin(), all.end(), coordinate) - all.begin());
  }

  /// At the start controllers with delays give what they decide there.
  bool begin_delays() {
    constexpr int most_rounds = 300;
    constexpr double agreed_within = 1e-15;
    for (int round = 0;; ++round) {
      for (const Delays::Column& column : delay_columns(step_.y)) {
        set_rates_by(column.index, delays_.begin_by(reduced_, column));
      }
      double largest = 0.0, change = 0.0;
      for (const Delays::Given& one : delays_.begin(reduced_)) {
        double& rate = step_.y[static_cast<std::size_t>(row_of_rate(one.coordinate))];
        change = std::max(change, std::abs(one.rate - rate));
        largest = std::max(largest, std::abs(one.rate));
        rate = one.rate;
      }
      if (!step_.evaluate(0.0)) {
        give_up(0.0);
        return false;
      }
      if (round > delays_.rounds() && change <= agreed_within * largest) break;
      if (round < most_rounds) continue;
      stop(MotionStatus::stuck,
           "controllers with delays that follow each other do not agree on what they give at the start");
      return false;
    }
    if (!go_on_from(0.0)) return false;
    echo(0.0, true, false);
    return true;
  }
  /// How places and rates of a state, to which the equations are evaluated, change by the columns.
  std::vector<Delays::Column> delay_columns(const std::vector<double>& state) const {
    std::vector<Delays::Column> out;
    MotionStep::Changes changes;
    for (int c = 0; c < columns_.count(); ++c) {
      step_.changes_by(c, state, columns_.influence_of(c), changes);
      out.push_back({static_cast<std::size_t>(c), changes.q, changes.v});
    }
    return out;
  }
  void set_rates_by(std::size_t column, const std::vector<Delays::Given>& given) {
    for (const Delays::Given& one : given) {
      step_.y[step_.sensitivity(row_of_rate(one.coordinate), static_cast<int>(column))] = one.rate;
    }
  }
  void echo(double t, bool is_new_cause, bool is_rough) {
    breaks_.add_echoes(t, delays_.delays(), is_new_cause, is_rough, delays_.are_chained());
    reduced_.set_near((t + breaks_.next(t)) / 2);
  }

  /// Keeps what controllers with delays decided over the step just made, to t, and evaluates its end again.
  bool keep_decided(double t) {
    const int f = reduced_.freedoms();
    const double from = t - step_.length;
    if (!(from < t)) return true;  // events at once behind each other
    const std::vector<double>&y0 = step_.y_new, &dy0 = step_.dydt_new, &y1 = step_.y, &dy1 = step_.dydt;
    const std::array<double, Delays::points> times = Delays::times_within(from, t);
    std::vector<double> within = y1;
    const auto read = [&](std::size_t place, std::size_t rate, double x) {
      const double h = t - from;
      within[place] = Quintic(h, y0[place], y0[rate], dy0[rate], y1[place], y1[rate], dy1[rate]).at(x);
      within[rate] = rate_within(h, x, y0[place], y0[rate], dy0[rate], y1[place], y1[rate], dy1[rate]);
    };
    const std::vector<double> at_end = dy1;
    for (int p = 0; p < Delays::points; ++p) {
      const double at = times[static_cast<std::size_t>(p)], x = (at - from) / (t - from);
      for (int k = 0; k < f; ++k) {
        read(static_cast<std::size_t>(k), static_cast<std::size_t>(f + k), x);
        for (int c = 0; c < columns_.count(); ++c) read(step_.sensitivity(k, c), step_.sensitivity(f + k, c), x);
      }
      if (!step_.evaluate_at(at, within)) {
        give_up(at);
        return false;
      }
      delays_.keep(from, t, p, reduced_);
      for (const Delays::Column& column : delay_columns(within)) delays_.keep_by(p, reduced_, column);
      step_.dydt = at_end;
    }
    if (step_.evaluate(t)) return true;
    give_up(t);
    return false;
  }

  /// Goes on behind an instant t at which what controllers decide or give need not be smooth.
  bool hear_of_it(double t, bool is_event) {
    const InputBreaks::Echo heard = breaks_.echo(t);
    const bool comes_back = heard.comes_back();
    echo(t, is_event || breaks_.are_at(t), comes_back && delays_.jump_at(t, breaks_.apart()));
    if (t >= options_.duration || !comes_back) return true;
    const std::vector<Delays::Given> given = delays_.just_behind(t, breaks_.apart());
    if (columns_.count() == 0) {
      set_rates(given);
      return go_on_from(t);
    }
    for (std::size_t c = 0; c < static_cast<std::size_t>(columns_.count()); ++c) {
      set_rates_by(c, delays_.just_behind_by(t, breaks_.apart(), c));
    }
    return follow_echo(t, heard, given) && go_on_from(t);
  }

  /// Sets what controllers with delays give behind t, one after the other. Where an echo moves with the delays that it
  /// has passed, accelerations that jump by one of them make derivatives of rates jump by
  /// (accelerations before - after) dt/dp.
  bool follow_echo(double t, const InputBreaks::Echo& heard, const std::vector<Delays::Given>& given) {
    const int f = reduced_.freedoms();
    const auto evaluate = [&] {
      if (step_.evaluate(t)) return true;
      give_up(t);
      return false;
    };
    for (std::size_t d = 0; d < given.size(); ++d) {
      if (!evaluate()) return false;
      const std::vector<double> before(reduced_.a(), reduced_.a() + reduced_.coordinates());
      set_rates(std::vector{given[d]});
      if (!evaluate()) return false;
      const auto passes = heard.passes.find(d);
      if (passes == heard.passes.end()) continue;
      for (int c = 0; c < columns_.count(); ++c) {
        double later = 0.0;
        for (std::size_t e = 0; e < given.size(); ++e) {
          later += passes->second[e] * delays_.delay_by(e, static_cast<std::size_t>(c));
        }
        for (int k = 0; k < f && later != 0.0; ++k) {
          const int i = reduced_.independent()[static_cast<std::size_t>(k)];
          if (delays_.gives(i)) continue;
          const double jump = before[static_cast<std::size_t>(i)] - reduced_.a()[i];
          if (heard.is_mixed) delays_.refuse_mixed(d);
          step_.y[step_.sensitivity(f + k, c)] += jump * later;
        }
      }
    }
    return true;
  }

  /// Adds to derivatives by the time at which a load jumps, which is t: rates stay and accelerations jump, so that the
  /// derivative of the rates jumps by  accelerations before - after  of this load alone.
  void follow_jumps(double t) {
    const int f = reduced_.freedoms();
    std::vector<double> by_value(static_cast<std::size_t>(f));
    for (std::size_t p = 0; p < options_.influences.size(); ++p) {
      options_.influences[p].for_each_function(
          model_.scene(), [&](const TimeFunction& function, int number, double by) {
            const std::optional<JumpInTime> jump = function.law.jump_by(number);
            if (!jump || jump->at != t) return;
            if (function.of == TimeFunction::Of::element) {
              follow_jump_of_element(t, function, by * jump->by, columns_.column_of(p));
              return;
            }
            Influence by_to;
            by_to.force = force_number(function.of, function.item, function.part, TimeFunction::whole);
            reduced_.influence(by_to, by_value.data());
            for (int k = 0; k < f; ++k) {
              step_.y[step_.sensitivity(f + k, columns_.column_of(p))] +=
                  -by * jump->by * by_value[static_cast<std::size_t>(k)];
            }
          });
      follow_jumps_of_drives(t, p);
    }
  }

  /// Does the same for a number of an element, on which forces need not depend linearly: the jump may reach a limit.
  /// `by` is the jump of the function times the derivative of the time.
  void follow_jump_of_element(double t, const TimeFunction& function, double by, int column) {
    const double before = std::nextafter(t, -1.0),
                 jump = function.at(t, 0, reduced_.near()) - function.at(t, 0, before);
    if (jump == 0.0) return;
    const auto f = static_cast<std::size_t>(reduced_.freedoms());
    const std::vector<MotionInput> inputs = reduced_.inputs();
    const std::vector<double> after(reduced_.alpha(), reduced_.alpha() + f);
    std::vector<MotionInput> without = inputs;
    for (MotionInput& one : without) {
      if (one.function && one.of == function.of && one.item == function.item && one.function->part == function.part) {
        one.own_near = before;
      }
    }
    reduced_.set_inputs(model_.scaled_scene(), std::move(without));
    const bool is_known = reduced_.evaluate(t, step_.y.data(), step_.y.data() + f) == Reduced::Status::ok;
    for (std::size_t k = 0; is_known && k < f; ++k) {
      step_.y[step_.sensitivity(static_cast<int>(f + k), column)] += (reduced_.alpha()[k] - after[k]) * by / jump;
    }
    reduced_.set_inputs(model_.scaled_scene(), inputs);
    step_.evaluate(t);
  }

  /// Adds to derivatives by a time at which the acceleration g'' of a drive jumps: where that time moves, the
  /// derivative of the rate g' jumps, and with it that of the others by  d alpha/dg'' times as much.
  void follow_jumps_of_drives(double t, std::size_t p) {
    const int f = reduced_.freedoms();
    std::vector<double> by_acceleration(static_cast<std::size_t>(f));
    const double before = std::nextafter(t, -1.0), after = reduced_.near();
    options_.influences[p].for_each_function_of_drives(
        model_.scene(), [&](const TimeFunction& function, int number, double by) {
          const double jump = function.by(number, t, 1, after) - function.by(number, t, 1, before);
          if (jump == 0.0 || function.is_smooth_in(number)) return;
          const auto input =
              std::find_if(reduced_.inputs().begin(), reduced_.inputs().end(),
                           [&](const MotionInput& one) { return one.of == function.of && one.item == function.item; });
          Influence acceleration;
          acceleration.drive = function.item;
          acceleration.drive_number = TimeFunction::whole;
          reduced_.influence(acceleration, by_acceleration.data());
          for (int k = 0; k < f; ++k) {
            step_.y[step_.sensitivity(f + k, columns_.column_of(p))] +=
                by * jump * input->unit * by_acceleration[static_cast<std::size_t>(k)];
          }
        });
  }

  /// Goes on from the last node, at a border of a profile, in the next piece. Rates stay; where accelerations jump, the
  /// derivatives of rates jump by  (accelerations before - after) dT/dp  with the time T(p) at which it is passed.
  bool cross_border(double t) {
    const auto width = static_cast<std::size_t>(columns_.count());
    std::vector<double> later(width), dq(q_start_.size()), dv(q_start_.size());
    for (std::size_t c = 0; c < width; ++c) {
      nodes_.read_places_by(c, dq);
      nodes_.read_rates_by(c, dv);
      later[c] = borders_.passing_time_by(reduced_, dq.data(), dv.data(), columns_.influence_of(static_cast<int>(c)));
    }
    // Beyond the border by less than rounding the formulas of the next piece hold.
    const double nudge = std::min(borders_.nudge(reduced_), 1e-10 * options_.duration);
    std::vector<double> beyond = step_.y;
    for (std::size_t i = 0; i < beyond.size(); ++i) beyond[i] += nudge * step_.dydt[i];
    if (!step_.evaluate_at(t + nudge, beyond)) {
      give_up(t);
      return false;
    }
    const int f = reduced_.freedoms();
    for (int k = 0; k < f; ++k) {
      const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
      const double jump = nodes_.acceleration(i) - reduced_.a()[i];
      for (std::size_t c = 0; c < width; ++c) {
        step_.y[step_.sensitivity(f + k, static_cast<int>(c))] += jump * later[c];
      }
    }
    if (width > 0 && f > 0) step_.evaluate_at(t + nudge, step_.y);
    add_node(t);
    nodes_.begin_piece();
    if (!can_switch() || !ends_.is_past()) return true;
    Event event;
    if (!friction_.acts() || !ends_.is_of_friction()) event.left = contacts_.least();
    event.nudge = nudge;
    return change_mode(t, event);
  }

  /// Goes on from the last node in another mode: with other friction sliding or held, other limits touched, and other
  /// rates where gaps close. With the time T(p) of the event, accelerations a, and the jump j of the rates,
  ///   q_p after = q_p - j T_p,   v_p after = v_p + a_before T_p + d(j) - a_after T_p,
  /// d(j) along the changes of places and rates at the event.
  bool change_mode(double t, const Event& event) {
    events_here_ = t > last_event_ + 1e-14 * options_.duration ? 0 : events_here_ + 1;
    events_in_row_ = t > last_event_ + 1e-6 * options_.duration ? 0 : events_in_row_ + 1;
    last_event_ = t;
    if (events_here_ > most_events_here || events_in_row_ > most_events_in_row) {
      stop(MotionStatus::stuck,
           fmt::format("at t = {:.9g} s what friction holds, or touches a stop, changes without end", t));
      return false;
    }
    const std::size_t n = q_start_.size();
    std::vector<double> q(reduced_.q(), reduced_.q() + n);
    const std::vector<double> before(reduced_.v(), reduced_.v() + n);
    for (std::size_t i = 0; i < n; ++i) q[i] += event.nudge * before[i];
    std::vector<double> v = before;
    double work = step_.work();
    read_changes();
    const std::vector<Touch> touched = reduced_.touching();
    const std::vector<int> held = reduced_.held();
    if (event.of_friction && !changes_.empty()) friction_.begin_to_slide(reduced_, t, ahead_);
    if (event.left && !event.hits)
      out_.events.push_back({.t = t, .kind = ContactEvent::Kind::lift_off, .at = *event.left});
    if (!(event.hits ? rebound(t, q, v, work, event.left) : choose_mode(t + event.nudge, q, v, event.left)))
      return false;
    if (event.of_friction && !event.hits && nodes_.nodes() > 1) {
      for (Change& one : changes_) {
        one.later = friction_.event_time_by(reduced_, one.dq.data(), one.dv.data(), one.influence_index);
      }
    }
    friction_.forget_event();
    write_rubbing(t, touched, held);
    set_state(reduced_.q(), reduced_.v(), work);
    for (Change& one : changes_) {
      for (std::size_t i = 0; i < n; ++i) {
        one.dq[i] += (before[i] - v[i]) * one.later;
        one.dv[i] += one.jump[i] + (nodes_.acceleration(i) - reduced_.a()[i]) * one.later;
      }
    }
    write_changes();
    step_.remake();
    if (!step_.evaluate(t + event.nudge)) {
      give_up(t);
      return false;
    }
    avoid_singular_poses();
    add_node(t);
    nodes_.begin_piece();
    if (out_.touched.empty() ? !reduced_.touching().empty() : out_.touched.back().touching != reduced_.touching()) {
      out_.touched.push_back({t, reduced_.touching()});
    }
    return true;
  }

  bool choose_mode(double t, const std::vector<double>& q, const std::vector<double>& v, std::optional<Touch> left) {
    const StickSlip::Choice choice = contacts_.choose(reduced_, friction_, t, ahead_, q, v, left);
    if (choice == StickSlip::Choice::made) return true;
    stop(MotionStatus::stuck, fmt::format("at t = {:.9g} s {}", t, words_of(choice, friction_.acts())));
    return false;
  }

  /// Lets the gaps rebound that close at the coordinates q and rates v, which become those after it, and chooses the
  /// mode there.
  bool rebound(double t, const std::vector<double>& q, std::vector<double>& v, double& work,
               std::optional<Touch> left) {
    const std::size_t n = q.size();
    const std::vector<double> before = v;
    std::vector<char> plastic(contacts_.sides().size(), 0);
    std::vector<double> rests(contacts_.sides().size(), -1.0);  // times at which bounces end
    const double least = std::max(least_bounce, options_.accuracy * options_.accuracy);
    // Each side may turn out to have bounced for the last time.
    for (;;) {
      const Contacts::Hit hit = contacts_.hit(reduced_, t, q, before, plastic);
      if (hit.outcome == Contacts::Hit::Outcome::none) return choose_mode(t, q, v, left);
      if (hit.outcome != Contacts::Hit::Outcome::done) {
        const std::string name = contacts_.name_of(contacts_.sides()[hit.first].at);
        stop(MotionStatus::jammed, fmt::format("at t = {:.9g} s {}", t,
                                               hit.outcome == Contacts::Hit::Outcome::gains
                                                   ? gaining_impact(name)
                                                   : pushing_drive(name, !model_.scene().drives.empty())));
        return false;
      }
      for (std::size_t i = 0; i < n; ++i) v[i] = before[i] + hit.jump[i];
      if (t > 0.0) differentiate(hit, t, q, before);
      if (!choose_mode(t, q, v, {})) return false;
      bool again = false;
      for (std::size_t i = 0; i < hit.sides.size(); ++i) {
        const std::size_t k = hit.sides[i];
        const double rate = hit.impact.rate[i], falls = contacts_.acceleration(k, reduced_);
        const double loss = 1 - contacts_.rebound(k);
        if (!(hit.before[i].rate < 0.0 && rate > -no_rebound * hit.before[i].rate && falls < 0.0) || plastic[k] != 0)
          continue;
        if (!(rate * rate < -2 * falls * least)) continue;
        plastic[k] = 1;
        // With restitution 1 it is what it hits besides that has taken the energy.
        rests[k] = loss > 0.0 ? t + 2 * rate / (-falls * loss) : t;
        again = true;
      }
      if (again) continue;
      work += hit.work;
      write_events(t, hit, rests);
      return true;
    }
  }

  /// Notes where friction across a stop that is touched begins to hold or to slide; `touched` and `held` are what was
  /// so before.
  void write_rubbing(double t, const std::vector<Touch>& touched, const std::vector<int>& held) {
    const auto is_in = [](const auto& list, const auto& one) {
      return std::find(list.begin(), list.end(), one) != list.end();
    };
    for (const Touch& touch : reduced_.touching()) {
      const int element = stop_friction_element(model_.scene(), touch.stop);
      if (element < 0) continue;
      const bool sticks = is_in(reduced_.held(), element), stuck = is_in(held, element);
      // What is touched anew slides as it did; at the start nothing was before.
      if (sticks == stuck || (!is_in(touched, touch) && (!sticks || t == 0.0))) continue;
      out_.events.push_back(
          {.t = t, .kind = sticks ? ContactEvent::Kind::stick : ContactEvent::Kind::slide, .at = touch});
    }
  }

  void write_events(double t, const Contacts::Hit& hit, const std::vector<double>& rests) {
    for (std::size_t i = 0; i < hit.sides.size(); ++i) {
      if (!(hit.impact.impulse[i] > 0.0)) continue;
      const Contacts::Side& side = contacts_.sides()[hit.sides[i]];
      const Scales& scales = model_.scales();
      const bool turns = model_.scene().stops[static_cast<std::size_t>(side.at.stop)].on.is_angle();
      const double unit = turns ? 1.0 : scales.length;
      const double impulse = hit.impact.impulse[i], before = hit.before[i].rate;
      const double rubbed = hit.impact.rub[i] * (hit.before[i].slip + hit.impact.slip[i]) / 2;
      const double after = std::abs(hit.impact.rate[i]) > no_rebound * std::abs(before) ? hit.impact.rate[i] : 0.0;
      // It would have turned round just behind the limit, or not have come so far.
      const bool grazes =
          side.acceleration > 0.0 && before * before < 2 * side.acceleration * grazing * options_.accuracy;
      out_.events.push_back({.t = t,
                             .kind = ContactEvent::Kind::impact,
                             .at = side.at,
                             .rate_before = before * unit,
                             .rate_after = after * unit,
                             .impulse = impulse * (turns ? scales.energy() : scales.force),
                             .energy_lost = 0.0 - (impulse * (before + after) / 2 + rubbed) * scales.energy(),
                             .t_p = hit_time_by(),
                             .unique = hit.impact.unique && !grazes});
      if (rests[hit.sides[i]] >= 0.0) {
        out_.events.push_back({.t = rests[hit.sides[i]], .kind = ContactEvent::Kind::rest, .at = side.at});
      }
    }
  }

  /// What becomes of the derivatives by one column at an event.
  struct Change {
    int variation = -1;
    int influence_index = -1;  // negative of initial values
    const Influence* influence = nullptr;
    std::vector<double> dq, dv;  // at the time of the event
    std::vector<double> jump;    // derivative of the jump of the rates
    double later = 0.0;          // T_p
  };

  void read_changes() {
    const std::size_t n = q_start_.size();
    changes_.resize(static_cast<std::size_t>(columns_.count()));
    for (std::size_t c = 0; c < changes_.size(); ++c) {
      Change& one = changes_[c];
      one.variation = columns_.variation_of(c);
      one.influence_index = columns_.influence_of(static_cast<int>(c));
      one.influence =
          one.influence_index < 0 ? nullptr : &options_.influences[static_cast<std::size_t>(one.influence_index)];
      for (std::vector<double>* part : {&one.dq, &one.dv, &one.jump}) part->assign(n, 0.0);
      one.later = 0.0;
      nodes_.read_places_by(c, one.dq);
      nodes_.read_rates_by(c, one.dv);
    }
  }

  /// The derivatives of the time of the event by the parameters, SI.
  std::vector<double> hit_time_by() const {
    std::vector<double> out;
    for (std::size_t c = 0; c < changes_.size(); ++c) {
      out.push_back(changes_[c].later / columns_.unit_of(static_cast<int>(c)));
    }
    return out;
  }

  /// Finds the derivatives of the jump that the equations have just made from the rates v, and of its time.
  void differentiate(const Contacts::Hit& hit, double t, const std::vector<double>& q, const std::vector<double>& v) {
    if (changes_.empty()) return;
    const std::size_t n = v.size();
    std::vector<std::vector<double>> dq, dv;
    std::vector<Contacts::JumpChange> jumps;
    for (Change& one : changes_) {
      one.later = contacts_.hit_time_by(reduced_, hit.first, v.data(), one.dq.data(), one.variation);
      std::vector<double>& places = dq.emplace_back(one.dq);
      std::vector<double>& rates = dv.emplace_back(one.dv);
      for (std::size_t i = 0; i < n; ++i) {
        places[i] += v[i] * one.later;
        rates[i] += nodes_.acceleration(i) * one.later;
      }
      jumps.push_back({places.data(), rates.data(), one.influence, one.jump.data()});
    }
    contacts_.change_jump(reduced_, hit, t, q, v, jumps);
  }

  /// Sets the sensitivities behind an event.
  void write_changes() {
    const int f = reduced_.freedoms();
    const std::size_t width = changes_.size();
    step_.held_by.assign(reduced_.held().size() * width, 0.0);
    for (std::size_t c = 0; c < width; ++c) {
      const Change& one = changes_[c];
      for (int k = 0; k < f; ++k) {
        const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
        step_.y[step_.sensitivity(k, static_cast<int>(c))] = one.dq[i];
        step_.y[step_.sensitivity(f + k, static_cast<int>(c))] = one.dv[i];
      }
      for (std::size_t h = 0; h < reduced_.held().size(); ++h) {
        step_.held_by[h * width + c] =
            friction_.held_value_by(reduced_, reduced_.held()[h], one.dq.data(), one.variation);
      }
    }
  }

  /// Goes on with independent coordinates that are better conditioned.
  void choose_anew(double t) {
    const std::size_t n = q_start_.size();
    const std::vector<int> old = reduced_.independent();
    const std::vector<double> q(reduced_.q(), reduced_.q() + n);
    const std::vector<double> v(reduced_.v(), reduced_.v() + n);
    reduced_.choose(t, q.data(), true);
    reduced_.expect(q.data());
    if (reduced_.independent() != old) {
      set_state(q.data(), v.data(), step_.work());
      nodes_.read_sensitivities(reduced_, step_);
      step_.remake();
    }
    step_.evaluate(t);
  }

  // --- ends ---------------------------------------------------------------------------------------------------------

  void stop(MotionStatus status, std::string why) {
    out_.status = status;
    out_.why = std::move(why);
  }

  /// Ends the motion where its equations fail.
  void give_up(double t) {
    if (step_.status() == Reduced::Status::undetermined) {
      // The scene is to blame for a force that its joints leave open from the start.
      if (!(t > 0) && reduced_.undetermined() >= 0) {
        refuse_undetermined_joint(model_.scene(), reduced_.undetermined());
      }
      stop(MotionStatus::stuck,
           fmt::format("at t = {:.9g} s it reached a position that leaves forces in its joints open", t));
      return;
    }
    if (const TimeFunction* const none = without_value(inputs_, t, 1e-9 * options_.duration)) {
      stop(MotionStatus::stuck, fmt::format("at t = {:.9g} s the function of time of \"{}\" has no value", t,
                                            name_of(model_.scene(), *none)));
      return;
    }
    MotionEnd end = end_of_motion(model_, step_.status(), t, {reduced_.q(), reduced_.q() + q_start_.size()});
    stop(end.status, std::move(end.why));
    if (end.status == MotionStatus::stuck && reduced_.held().empty() && nodes_.nodes() > 0) name_dead_centre(t);
  }

  /// Says where the motion ended, if the closures and drives lose rank there.
  void name_dead_centre(double t) {
    LastState last{.time = t, .x = {}, .v = {}, .a = {}};
    for (std::size_t i = 0; i < q_start_.size(); ++i) {
      const NodeValues at = nodes_.at(nodes_.nodes() - 1, i);
      last.x.push_back(at.q);
      last.v.push_back(at.v);
      last.a.push_back(at.a);
    }
    if (reduced_.freedoms() == 0 && reduced_.touching().empty()) {
      out_.dead_centre = dead_centre_beyond(model_, last, looked_ahead * options_.duration);
    }
    if (!out_.dead_centre) {
      const SingularState there = singular_state(model_, last.x, reduced_.rank());
      if (!(there.closeness < nearly_singular)) return;
      const bool is_driven = !model_.scene().drives.empty();
      out_.dead_centre = SingularPlace{
          t, (is_driven ? "dead centre" : "singular position") + there.text, position_in_words(model_, last.x), {}};
    }
    out_.why = fmt::format("at t = {:.9g} s it meets a {}; there {}", out_.dead_centre->time, out_.dead_centre->text,
                           out_.dead_centre->position);
  }

  const MotionModel& model_;
  const MotionOptions& options_;
  Motion out_;
  Reduced reduced_;
  StickSlip friction_;
  Contacts contacts_;
  RollingForces rolling_;
  double rolling_margin_ = 0.0;  // at the last node
  ProfileBorders borders_;
  Samples samples_;
  Delays delays_;
  std::vector<MotionInput> inputs_;  // of the options and the scene
  InputBreaks breaks_;
  std::vector<double> q_start_;
  SensitivityColumns columns_;
  MotionStep step_;
  MotionWriter nodes_;
  StepError error_;
  StepEnds ends_;
  struct Passed {
    double time, length;
  };
  std::vector<int> controlled_;  // coordinates of the mechanism where it has controllers
  std::vector<Change> changes_;  // by column, at the last event
  std::vector<Passed> passed_;   // singular poses that were stepped over, and by what length
  double limit_ = 0.0;           // of pivots: steps avoid those below
  double ahead_ = 0.0;           // time in which choices of friction are told apart
  double last_event_ = -1.0;     // time of the last change of mode
  int events_here_ = 0;          // and how many there were at this time
  int events_in_row_ = 0;        // and one soon after the other
  double shortest_period_ = std::numeric_limits<double>::infinity();  // of drives and inputs, s
  int departures_ = 0;                                                // steps that are short behind the border passed
  double onward_ = 0.0;                                               // length of steps to go on with behind a border
};

}  // namespace

std::string to_string(MotionStatus status) {
  switch (status) {
    case MotionStatus::not_started:
      return "not started";
    case MotionStatus::completed:
      return "completed";
    case MotionStatus::interrupted:
      return "interrupted";
    case MotionStatus::stuck:
      return "stuck";
    case MotionStatus::torn:
      return "torn";
    case MotionStatus::no_inertia:
      return "no inertia";
    case MotionStatus::step_limit:
      return "step limit";
    case MotionStatus::lifted_off:
      return "lifted off";
    case MotionStatus::ran_away:
      return "ran away";
    case MotionStatus::jammed:
      return "jammed";
  }
  return "";
}

std::string to_string(ContactEvent::Kind kind) {
  constexpr const char* words[] = {"impact", "rest", "lift-off", "graze", "stick", "slide"};
  return words[static_cast<std::size_t>(kind)];
}

namespace {

/// Throws InputError where the model was made without the friction of its joints.
void expect_joint_friction(const Scene& scene) {
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    if (!joint.friction || friction_element(scene, static_cast<int>(j)) >= 0) continue;
    throw InputError(fmt::format(
        "{}:{}: {} \"{}\".friction: friction of joints is not treated here; expected friction of a constant "
        "torque or force, give it in a table [[friction]] instead",
        scene.file, joint.line, joint.traits().key, joint.name));
  }
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (!stop.friction || stop_friction_element(scene, static_cast<int>(s)) >= 0) continue;
    throw InputError(
        fmt::format("{}:{}: {} \"{}\".friction: friction across a stop is not treated here; expected a stop "
                    "without it",
                    scene.file, stop.line, stop.family(), stop.name));
  }
}

}  // namespace

Motion simulate(const MotionModel& model, const MotionState& start, const MotionOptions& options) {
  expect_joint_friction(model.scene());
  refuse_rubbing_ropes(model.scene(), "motion");
  return Simulation(model, start, options).run();
}

}  // namespace poise
