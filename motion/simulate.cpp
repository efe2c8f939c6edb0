#include "motion/simulate.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "model/joint_friction.hpp"
#include "motion/motion_error.hpp"
#include "motion/profile_borders.hpp"
#include "motion/reduced_system.hpp"
#include "motion/singular_passage.hpp"
#include "motion/stick_slip.hpp"
#include "solvers/runge_kutta.hpp"
#include "statics/body_measures.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;

/// Relative pivots below this are avoided: ill-conditioned loops amplify rounding by its inverse cube.
constexpr double comfortable_pivot = 1e-3;
/// Other independent coordinates are chosen if the pivot has decreased below this.
constexpr double good_pivot = 0.05;
/// Margin of friction beyond which an event has passed: rounding at its start leaves less.
constexpr double past = 1e-12;
/// Within a step a margin is looked at more closely where it comes so near to zero.
constexpr double close = 0.05;
/// More than that many events of friction in one step are looked for among those that are left after the first.
constexpr int most_events_of_step = 8;
/// A border of a profile is reached at this distance of the argument.
constexpr double just_before = 1e-13;
/// Joints and drives that are open by more, over the mechanism's size or rad, are open.
constexpr double joints_closed_within = 1e-9;
/// Rates that contradict each other from the start differ by more than this share of their terms: more than what the
/// choice of coordinates takes for zero. What differs by less opens later, if at all.
constexpr double contradiction = 1e-6;
/// The poses of the last stages of a step are approximations, which may lie beyond a border that the step ends at,
/// where other formulas hold: an error in proportion to the step. So do those of the stages of Fehlberg's formula at
/// the beginning of a step that begins there. So many steps become shorter towards a border, each by this factor, and
/// longer behind it.
constexpr int steps_at_border = 2;
constexpr double shorter_at_border = 0.01;
/// Errors of sensitivities that count may be larger than those of the state, by this factor.
constexpr double of_sensitivities = 1e4;

class Simulation {
 public:
  Simulation(const MotionModel& model, const MotionState& start, const MotionOptions& options)
      : model_(model),
        options_(options),
        reduced_(model.scaled_scene(), model.mechanism(), model.inertia()),
        friction_(model, options.variations, reduced_),
        borders_(model, options.variations),
        n_(static_cast<std::size_t>(model.mechanism().coordinates())),
        unit_(n_, 1.0),
        q_start_(model.from_si(start.q)),
        reach_(n_, 0.0),
        speed_(n_, 0.0),
        overrun_(model.scene().stops.size(), 0) {
    for (std::size_t i = static_cast<std::size_t>(model.layout().angles); i < n_; ++i) unit_[i] = model.scales().length;
    inputs_ = with_inputs_of(model.scene(), options.inputs);
    reduced_.set_inputs(model.scaled_scene(), scaled(inputs_, model.scene(), model.scales()));
    for (const MotionInput& input : inputs_) {
      const std::vector<double> breaks = input.breaks();
      breaks_.insert(breaks_.end(), breaks.begin(), breaks.end());
      if (input.jumps()) jumps_.insert(jumps_.end(), breaks.begin(), breaks.end());
    }
    std::sort(breaks_.begin(), breaks_.end());
    expect_derivatives();
    reduced_.start_drives(q_start_.data());
    reduced_.choose(0.0, q_start_.data(), false, options.independent.empty() ? nullptr : &options.independent);
    out_.freedoms = reduced_.freedoms();
    out_.independent = reduced_.independent();
    out_.drive_force.resize(model.scene().drives.size());
    columns_ = options.sensitivities ? 2 * out_.freedoms + static_cast<int>(options.influences.size()) : 0;
    out_.trajectory.coordinates = static_cast<int>(n_);
    out_.trajectory.columns = columns_;
    const std::vector<double> v = model.from_si(start.v);
    const int f = reduced_.freedoms();
    y_.assign(static_cast<std::size_t>(2 * f + 1 + 2 * f * columns_), 0.0);
    for (int k = 0; k < f; ++k) {
      y_[static_cast<std::size_t>(k)] = q_start_[static_cast<std::size_t>(reduced_.independent()[k])];
      y_[static_cast<std::size_t>(f + k)] = v[static_cast<std::size_t>(reduced_.independent()[k])];
    }
    for (int c = 0; c < std::min(columns_, 2 * f); ++c) y_[sensitivity(c, c)] = 1.0;
    for (int c = 2 * f; c < columns_; ++c) {
      if (switches_over(options.influences[static_cast<std::size_t>(c - 2 * f)])) switching_.push_back(c);
    }
  }

  Motion run() {
    const auto begun = std::chrono::steady_clock::now();
    move_along();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
    out_.microseconds = took.count();
    if (system_) out_.evaluations += system_->evaluations;
    out_.energy_error = energy_error(out_);
    out_.singular = zero_crossings(out_.trajectory.t, pivot_);
    return std::move(out_);
  }

 private:
  /// Place in y of column c of row k: of z_k, or of w_(k - f).
  std::size_t sensitivity(int k, int c) const {
    return static_cast<std::size_t>(2 * reduced_.freedoms() + 1 + k * columns_ + c);
  }

  /// Dry friction turns with the rate over a width: where its size is small, or even 0, the state tells nothing of
  /// that, but its sensitivities to the size do.
  bool switches_over(const Influence& influence) const {
    if (influence.body >= 0 || influence.moves() || influence.force.of != ForceNumber::Of::element) return false;
    const Element& element = model_.scene().elements[static_cast<std::size_t>(influence.force.item)];
    const auto* const friction = std::get_if<DryFriction>(&element.law);
    return friction != nullptr && friction->width > 0;
  }

  void move_along() {
    reduced_.set_singular_limit(0.0);
    reduced_.expect(q_start_.data());
    reduced_.set_near(next_break(0.0) / 2);
    remake();
    if (!system_->rates(0.0, y_.data(), dydt_.data())) return give_up(system_->status, 0.0);
    limit_ = std::min(comfortable_pivot, 0.1 * reduced_.pivot());
    refuse_contradicting_drives();
    const double accuracy = options_.accuracy / 1000;
    double t = 0.0;
    double h = first_step();
    ahead_ = h;
    add_node(t);
    if (is_torn(t) || (friction_.acts() && !change_friction(t))) return;
    while (t < options_.duration) {
      if (options_.interrupt != nullptr && options_.interrupt->load()) {
        return stop(MotionStatus::interrupted, fmt::format("interrupted at t = {:.6g} s", t));
      }
      if (out_.steps + out_.rejected >= options_.most_steps) {
        return stop(MotionStatus::step_limit, fmt::format("{} steps reached only t = {:.6g} s", out_.steps, t));
      }
      const double end = next_break(t);
      const double left = end - t;
      // A very short last step is shared with the one before.
      const bool last = h >= left * (1 - 1e-12);
      if (last)
        h = left;
      else if (h > 0.5 * left)
        h = 0.5 * left;
      if (!step_from(t, h, accuracy)) {
        if (h > 1e-13 * options_.duration && h > 1e-15 * (1 + t)) continue;
        return give_up(system_->status, t);
      }
      const Border border = borders_.act() ? meets_border(t) : Border{};
      const double to_border = taken_;
      const bool event = friction_.acts() && meets_event(t);
      if (event) friction_.meet(reduced_);
      t = last && taken_ == left ? end : t + taken_;
      ++out_.steps;
      y_.swap(y_new_);
      dydt_.swap(dydt_new_);
      add_node(t);
      if (is_torn(t)) return;
      if (t == end && !cross_break(t)) return;
      if (event && !change_friction(t)) return;
      if (event) approaches_ = 0;
      if (departures_ > 0) {
        h = onward_ * std::pow(shorter_at_border, --departures_);
        if (departures_ == 0) onward_ = 0.0;
      }
      if (border.rest > 0.0) {
        onward_ = std::max(onward_, h);
        h = (1 + shorter_at_border) * border.rest;
      }
      if (border.is_reached && !event && taken_ == to_border) {
        onward_ = std::max(h, onward_);
        departures_ = steps_at_border;
        h = onward_ * std::pow(shorter_at_border, departures_);
        if (!cross_border(t)) return;
      }
      if (options_.progress) options_.progress(t);
      if (has_poor_coordinates()) choose_anew(t);
    }
    out_.status = MotionStatus::completed;
  }

  /// What a row of the closures and drives is of.
  std::string name_of_row(int row) const {
    const Scene& scene = model_.scene();
    for (const ConstraintBlock& block : model_.mechanism().blocks()) {
      if (row < block.first_row || row >= block.first_row + block.rows) continue;
      const Joint& joint = scene.joints[static_cast<std::size_t>(model_.layout().closures[block.closure].joint)];
      return fmt::format("{} \"{}\"", joint.traits().key, joint.name);
    }
    auto drive = static_cast<std::size_t>(row - model_.mechanism().equalities());
    if (drive < scene.drives.size()) return fmt::format("drive \"{}\"", scene.drives[drive].name);
    drive -= scene.drives.size();
    for (const Stop& stop : scene.stops) {
      if (stop.holds() && drive-- == 0) return fmt::format("{} \"{}\"", stop.family(), stop.name);
    }
    return "friction that holds";
  }

  /// Throws InputError where no rates of the coordinates are those that drives ask for and keep the joints closed.
  void refuse_contradicting_drives() {
    const Scene& scene = model_.scene();
    const Reduced::Opening opening = reduced_.fastest_opening();
    if (scene.drives.empty() || opening.row < 0 || !(opening.size > contradiction * opening.terms)) return;
    std::vector<std::string> moving;
    for (const Drive& drive : scene.drives) moving.push_back(fmt::format("\"{}\"", drive.name));
    const std::string open = name_of_row(opening.row);
    throw InputError(fmt::format(
        "{}:{}: drive: the mechanism cannot move at the rates of its {} {}: {} would {}; expected drives that agree "
        "with "
        "the joints and with each other, no more than there are degrees of freedom; leave one out",
        scene.file, scene.drives.back().line, moving.size() == 1 ? "drive" : "drives", fmt::join(moving, ", "), open,
        opening.row < model_.mechanism().equalities() ? "open" : "not be followed"));
  }

  /// Ends the motion where a joint or a drive is open at the last node by more than rounding of the loops: its equation
  /// repeated others at the start, but does not here.
  bool is_torn(double t) {
    const Reduced::Opening gap = reduced_.widest_gap();
    if (gap.row < 0) return false;
    if (gap.size > out_.gap || out_.gap_of.empty()) {
      out_.gap = gap.size;
      out_.gap_of = name_of_row(gap.row);
    }
    if (gap.size <= joints_closed_within + 2e3 * eps / (reduced_.pivot() + eps)) return false;
    drop_node();
    stop(MotionStatus::torn,
         fmt::format("at t = {:.9g} s {} is open by {:.3g} of the mechanism's size, or rad: at the start its equation "
                     "repeats those of other joints and drives, but not beyond; the mechanism is mobile there only "
                     "infinitesimally, or its drives contradict each other",
                     t, out_.gap_of, gap.size));
    return true;
  }

  /// Takes the last node away, at which a joint is open.
  void drop_node() {
    Trajectory& path = out_.trajectory;
    path.t.pop_back();
    for (auto* values : {&path.q, &path.v, &path.a}) values->resize(path.nodes() * n_);
    for (auto* values : {&path.q_p, &path.v_p, &path.a_p}) {
      values->resize(path.nodes() * n_ * static_cast<std::size_t>(columns_));
    }
    for (auto* values : {&pivot_, &out_.kinetic, &out_.potential, &out_.work}) values->pop_back();
    for (std::vector<double>& forces : out_.drive_force) forces.pop_back();
  }

  /// Goes on from a break of the inputs, where the motion's formula changes and its accelerations may jump.
  bool cross_break(double t) {
    smooth_from_ = out_.trajectory.nodes() - 1;
    if (t >= options_.duration) return true;
    reduced_.set_near((t + next_break(t)) / 2);
    const bool jumps = std::find(jumps_.begin(), jumps_.end(), t) != jumps_.end();
    if (!system_->rates(t, y_.data(), dydt_.data())) {
      give_up(system_->status, t);
      return false;
    }
    // What rests may begin to move where a drive or a load begins to change.
    if (friction_.acts()) return change_friction(t, false);
    if (!jumps) return true;
    if (columns_ > 0) {
      follow_jumps(t);
      system_->rates(t, y_.data(), dydt_.data());
    }
    add_node(t);
    smooth_from_ = piece_from_ = out_.trajectory.nodes() - 1;
    return true;
  }

  /// Derivatives by the time at which a load jumps, which is t: rates stay and accelerations jump, so that the
  /// derivative of the rates jumps by  accelerations before - after  of this load alone.
  void follow_jumps(double t) {
    const int f = reduced_.freedoms();
    std::vector<double> by_value(static_cast<std::size_t>(f));
    for (std::size_t p = 0; p < options_.influences.size(); ++p) {
      options_.influences[p].for_each_function(
          model_.scene(), [&](const TimeFunction& function, int number, double by) {
            const auto* const step = std::get_if<StepInTime>(&function.law);
            if (step == nullptr || function.is_smooth_in(number) || step->at != t) return;
            Influence by_to;
            by_to.force.of = function.of == TimeFunction::Of::force ? ForceNumber::Of::force : ForceNumber::Of::torque;
            by_to.force.item = function.item;
            by_to.force.time_number = 2;
            reduced_.influence(by_to, by_value.data());
            const int column = 2 * out_.freedoms + static_cast<int>(p);
            for (int k = 0; k < f; ++k) {
              y_[sensitivity(f + k, column)] += by * (step->from - step->to) * by_value[static_cast<std::size_t>(k)];
            }
          });
    }
  }

  /// Throws InputError for derivatives that are not known.
  void expect_derivatives() const {
    if (!options_.sensitivities || !friction_.acts()) return;
    for (const Influence& influence : options_.influences) {
      influence.for_each_function(model_.scene(), [&](const TimeFunction& function, int number, double) {
        if (function.is_smooth_in(number)) return;
        throw InputError(
            fmt::format("{}: load \"{}\": with friction that sticks the derivative by the time of a step is "
                        "not known; expected another number, or friction of some width",
                        model_.scene().file, name_of(model_.scene(), function)));
      });
    }
  }

  /// Repeats the step just made, from t, with the length h; the margin there, NaN where that fails.
  template <class Margin>
  double shortened_step(double t, double h, const Margin& margin) {
    // From the pose of the node, not from the one that the step ended in.
    reduced_.expect(node_.data());
    if (!system_->rates(t, y_.data(), dydt_new_.data())) return std::numeric_limits<double>::quiet_NaN();
    if (!stepper_->step(t, y_, dydt_, h, y_new_, error_) || !system_->rates(t + h, y_new_.data(), dydt_new_.data())) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    taken_ = h;
    return margin();
  }

  /// Shortens the step just made from t to the first event of friction in it. False if there is none.
  bool meets_event(double t) {
    const auto margin = [this] { return friction_.margin(reduced_); };
    bool met = false;
    // Before an event there may be another one.
    for (int k = 0; k < most_events_of_step; ++k) {
      const double margin_at_end = margin();
      double after = StickSlip::holds(reduced_) ? first_passing(t, margin_at_end) : 0.0;
      if (after == 0.0 && margin_at_end < -past) {
        shorten_to_zero(t, margin_, taken_, margin_at_end, margin);
        met = true;
        continue;
      }
      if (after == 0.0) after = friction_.dip(reduced_, taken_);
      if (after == 0.0) break;
      const double whole = taken_;
      const double margin_after = shortened_step(t, after, margin);
      if (!(margin_after < -past)) {
        shortened_step(t, whole, margin);
        break;
      }
      shorten_to_zero(t, margin_, after, margin_after, margin);
      met = true;
    }
    if (met) margin();
    return met;
  }

  /// Margin of friction a part x of the way through the step just made, at the state of the quintic through places,
  /// rates and accelerations at both ends; NaN where that fails.
  double margin_within(double t, double x) {
    const auto f = static_cast<std::size_t>(reduced_.freedoms());
    const double h = taken_;
    within_.resize(2 * f);
    for (std::size_t k = 0; k < f; ++k) {
      const double v0 = h * y_[f + k], v1 = h * y_new_[f + k];
      const double a0 = h * h * dydt_[f + k] / 2, a1 = h * h * dydt_new_[f + k] / 2;
      const double far = y_new_[k] - y_[k] - v0 - a0, fast = v1 - v0 - 2 * a0, bends = a1 - a0;
      const double c3 = 10 * far - 4 * fast + bends, c4 = -15 * far + 7 * fast - 2 * bends;
      const double c5 = 6 * far - 3 * fast + bends;
      within_[k] = y_[k] + x * (v0 + x * (a0 + x * (c3 + x * (c4 + x * c5))));
      within_[f + k] = (v0 + x * (2 * a0 + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / h;
    }
    if (reduced_.place(t + x * h, within_.data()) != Reduced::Status::ok) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    reduced_.move(within_.data() + f);
    if (reduced_.accelerate() != Reduced::Status::ok) return std::numeric_limits<double>::quiet_NaN();
    return friction_.margin(reduced_);
  }

  /// The time within the step just made at which a margin that is positive at the node has passed zero, 0 if it does
  /// not. Between the places looked at margins are parabolas, of which the lowest point is looked at.
  double first_passing(double t, double margin_at_end) {
    constexpr int places = 5;
    double margins[places + 1] = {margin_};
    double passed = 0.0;
    end_.assign(reduced_.q(), reduced_.q() + n_);
    // From the node, whose rates these are already; those at the end are needed on the way.
    reduced_.expect(node_.data());
    system_->rates(t, y_.data(), dydt_.data());
    for (int k = 1; k <= places && passed == 0.0; ++k) {
      margins[k] = k == places ? margin_at_end : margin_within(t, static_cast<double>(k) / places);
      if (margins[k] < -past && k < places) passed = static_cast<double>(k) / places;
      if (k < 2 || passed > 0.0) continue;
      const double before = margins[k - 2], low = margins[k - 1], after = margins[k];
      const double bend = before - 2 * low + after;
      if (!(low <= before && low <= after && bend > 0)) continue;
      const double x = (k - 1 + (before - after) / (2 * bend)) / places;
      const double least = low - (before - after) * (before - after) / (8 * bend);
      if (least < close && margin_within(t, x) < -past) passed = x;
    }
    reduced_.expect(end_.data());
    system_->rates(t + taken_, y_new_.data(), dydt_new_.data());
    return passed * taken_;
  }

  struct Border {
    bool is_reached = false;
    double rest = 0.0;  // of the way to it, s, where the step ends short of it
  };
  /// Shortens the step just made from t to where it passes a border of a profile, or to short of it.
  Border meets_border(double t) {
    // To just before it, where the formulas of this piece hold.
    const auto margin = [this] { return borders_.margin(reduced_) - just_before; };
    const double margin_after = margin();
    if (!(margin_after < -past)) return {};
    shorten_to_zero(t, border_margin_, taken_, margin_after, margin);
    if (!has_poor_coordinates()) {
      if (approaches_ == steps_at_border) {
        approaches_ = 0;
        return {.is_reached = true};
      }
      ++approaches_;
      const double rest = shorter_at_border * taken_;
      shortened_step(t, taken_ - rest, margin);
      return {.rest = rest};
    }
    // A profile may begin to dwell there, where its own measure is no coordinate any more: others are chosen on the
    // way.
    shortened_step(t, taken_ / 2, margin);
    return {};
  }

  /// Shortens the step just made from t, over which a margin falls from `margin_before` to the negative `margin_after`
  /// at the length `after`, to its zero, to rounding, by regula falsi.
  template <class Margin>
  void shorten_to_zero(double t, double margin_before, double after, double margin_after, const Margin& margin_of) {
    double before = 0.0;
    double margin = margin_after;
    bool was_before = false;
    for (int k = 0; k < 100; ++k) {
      const double crossing = before + (after - before) * margin_before / (margin_before - margin_after);
      const double h = margin_before > past && crossing > before && crossing < after ? crossing : (before + after) / 2;
      if (!(h > before && h < after)) break;
      margin = shortened_step(t, h, margin_of);
      if (std::abs(margin) <= eps) break;
      // An end that stays is given half its weight the next time.
      if (!(margin >= 0)) {
        after = h;
        margin_after = std::isnan(margin) ? -1.0 : margin;
        if (k > 0 && !was_before) margin_before /= 2;
        was_before = false;
      } else {
        before = h;
        margin_before = margin;
        if (k > 0 && was_before) margin_after /= 2;
        was_before = true;
      }
    }
    if (std::isnan(margin)) shortened_step(t, before, margin_of);
  }

  /// Goes on from the last node, at a border of a profile, in the next piece. Rates stay; where accelerations jump, the
  /// derivatives of rates jump by  (accelerations before - after) dT/dp  with the time T(p) at which it is passed.
  bool cross_border(double t) {
    const Trajectory& path = out_.trajectory;
    const std::size_t node = path.nodes() - 1;
    const auto width = static_cast<std::size_t>(columns_);
    std::vector<double> later(width), dq(n_);
    for (std::size_t c = 0; c < width; ++c) {
      read_derivatives(path.q_p, c, dq);
      later[c] = borders_.passing_time_by(reduced_, dq.data(), variation_of_column(c));
    }
    // Beyond the border by less than rounding: there the formulas of the next piece hold.
    const double nudge = std::min(borders_.nudge(reduced_), 1e-10 * options_.duration);
    std::vector<double> beyond = y_;
    for (std::size_t i = 0; i < y_.size(); ++i) beyond[i] += nudge * dydt_[i];
    if (!system_->rates(t + nudge, beyond.data(), dydt_.data())) {
      give_up(system_->status, t);
      return false;
    }
    const int f = reduced_.freedoms();
    for (int k = 0; k < f; ++k) {
      const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
      const double jump = path.a[node * n_ + i] / unit_[i] - reduced_.a()[i];
      for (std::size_t c = 0; c < width; ++c) y_[sensitivity(f + k, static_cast<int>(c))] += jump * later[c];
    }
    if (columns_ > 0 && f > 0) {
      beyond = y_;
      system_->rates(t + nudge, beyond.data(), dydt_.data());
    }
    add_node(t);
    smooth_from_ = piece_from_ = path.nodes() - 1;
    return true;
  }

  /// Goes on from the last node with other friction sliding or held. Rates stay and accelerations jump, so that with
  /// the time T(p) of the event the derivatives of the rates jump by  (accelerations before - after) dT/dp.
  /// The time of an event that is not `of_friction` does not depend on numbers.
  bool change_friction(double t, bool of_friction = true) {
    Trajectory& path = out_.trajectory;
    const std::size_t node = path.nodes() - 1;
    const auto width = static_cast<std::size_t>(columns_);
    const double work = y_[static_cast<std::size_t>(2 * reduced_.freedoms())];
    const bool started = node > 0 && of_friction;
    const StickSlip::Choice choice = friction_.choose(reduced_, t, ahead_);
    if (choice != StickSlip::Choice::made) {
      stop(MotionStatus::stuck, fmt::format("at t = {:.9g} s {}", t, words_of(choice)));
      return false;
    }
    const int f = reduced_.freedoms();
    y_.assign(static_cast<std::size_t>(2 * f + 1 + 2 * f * columns_), 0.0);
    y_[static_cast<std::size_t>(2 * f)] = work;
    for (int k = 0; k < f; ++k) {
      const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
      y_[static_cast<std::size_t>(k)] = reduced_.q()[i];
      y_[static_cast<std::size_t>(f + k)] = reduced_.v()[i];
    }
    held_by_.assign(reduced_.held().size() * width, 0.0);
    std::vector<double> dq(n_), dv(n_);
    for (std::size_t c = 0; c < width; ++c) {
      const int variation = variation_of_column(c);
      read_derivatives(path.q_p, c, dq);
      read_derivatives(path.v_p, c, dv);
      const double later = started ? friction_.event_time_by(dq.data(), dv.data(), variation) : 0.0;
      for (std::size_t i = 0; i < n_; ++i) dv[i] += (path.a[node * n_ + i] / unit_[i] - reduced_.a()[i]) * later;
      for (int k = 0; k < f; ++k) {
        const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
        y_[sensitivity(k, static_cast<int>(c))] = dq[i];
        y_[sensitivity(f + k, static_cast<int>(c))] = dv[i];
      }
      for (std::size_t h = 0; h < reduced_.held().size(); ++h) {
        held_by_[h * width + c] = friction_.held_value_by(reduced_, h, dq.data(), variation);
      }
    }
    out_.evaluations += system_->evaluations;
    remake();
    if (!system_->rates(t, y_.data(), dydt_.data())) {
      give_up(system_->status, t);
      return false;
    }
    limit_ = std::min(comfortable_pivot, 0.1 * reduced_.pivot());
    add_node(t);
    smooth_from_ = piece_from_ = path.nodes() - 1;
    return true;
  }

  /// The end of the motion, or of the smooth part of its inputs, after t. Breaks so near to t that the integrator could
  /// not make a step to them are passed over.
  double next_break(double t) {
    const double shortest = 1e-9 * options_.duration;
    while (next_ < breaks_.size() && breaks_[next_] <= t + shortest) ++next_;
    return next_ < breaks_.size() && breaks_[next_] < options_.duration - shortest ? breaks_[next_] : options_.duration;
  }

  /// Tries a step of h; on failure h is made shorter. On success taken_ is the step and h the next one.
  bool step_from(double t, double& h, double accuracy) {
    if (reduced_.rank() > 0 && out_.trajectory.nodes() > piece_from_ + 2) {
      h = std::min(steered_step(out_.trajectory.t, pivot_, h), next_break(t) - t);
    }
    // Forces of what is held follow loads and drives, whatever moves.
    if (friction_.acts() && StickSlip::holds(reduced_)) h = std::min(h, shortest_period_ / 4);
    double limit = limit_;
    for (int attempt = 0; attempt < 12; ++attempt) {
      reduced_.set_singular_limit(limit);
      const bool evaluated =
          stepper_->step(t, y_, dydt_, h, y_new_, error_) && system_->rates(t + h, y_new_.data(), dydt_new_.data());
      reduced_.set_singular_limit(0.0);
      if (evaluated) {
        const double error = std::max(weigh_error(t, h, accuracy), weigh_reading(t, h) / (1000 * accuracy));
        if (error <= 1.0) {
          taken_ = h;
          h = solvers::next_step(h, error);
          return true;
        }
        ++out_.rejected;
        h = std::isfinite(error) ? solvers::next_step(h, error) : h / 5;
        return false;
      }
      ++out_.rejected;
      const Reduced::Status status = system_->status;
      // The next attempt starts from the node again, not from the pose that failed.
      reduced_.expect(node_.data());
      system_->rates(t, y_.data(), dydt_.data());
      system_->status = status;
      if (status != Reduced::Status::singular) {
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

  /// Uncertainty of accelerations by rounding eps of the loops' closure: eps rate^2 / pivot^3.
  double uncertain_acceleration() const {
    if (reduced_.rank() == 0) return 0.0;
    double fastest = 0.0;
    for (std::size_t i = 0; i < n_; ++i) fastest = std::max(fastest, std::abs(reduced_.v()[i]));
    const double pivot = std::min(pivot_.back(), reduced_.pivot());
    return eps * fastest * fastest / (pivot * pivot * pivot + eps);
  }

  /// Error of the step relative to the tolerance. Rounding errors, which shorter steps do not reduce, are left out.
  double weigh_error(double t, double h, double accuracy) const {
    const int f = reduced_.freedoms();
    double far = 0.0;
    double fast = 0.0;
    for (int k = 0; k < f; ++k) {
      far = std::max(far, reach_of(k, h));
      fast = std::max(fast, speed_of(k, h));
    }
    const double singular = uncertain_acceleration();
    double worst = 0.0;
    if (f == 0) {
      // All is driven. Work alone is integrated, of whose error the method's estimate knows nothing where it depends on
      // time only; the energies at both ends do.
      const double energy = reduced_.kinetic_energy() + reduced_.potential_energy();
      const double unbalanced = std::abs(energy - energy_ - (y_new_[0] - y_[0]));
      // Rounding is that of energies, of places to which loops and drives are closed, and of the times at which power
      // is taken.
      const double rounding = 100 * eps * (std::abs(energy) + std::abs(energy_)) + 10 * eps * reduced_.work_of_gaps() +
                              4 * eps * (t + h) * (std::abs(dydt_[0]) + std::abs(dydt_new_[0]));
      worst =
          std::max(0.0, unbalanced - rounding) / (1000 * accuracy * std::max(exchanged_, std::abs(y_new_[0])) + tiny);
    }
    for (int k = 0; k < f; ++k) {
      // Where forces balance, accelerations are about the rounding of a coordinate times stiffness over inertia.
      const double balanced = eps * fastest_ * fastest_ * (1 + std::abs(y_[static_cast<std::size_t>(k)]));
      const double uncertain = h * (singular + balanced);
      const double z = accuracy * std::max(reach_of(k, h), 1e-3 * far) + h * uncertain;
      const double w = accuracy * std::max(speed_of(k, h), 1e-3 * fast) + uncertain;
      const double e_z = std::abs(error_[static_cast<std::size_t>(k)]);
      const double e_w = std::abs(error_[static_cast<std::size_t>(f + k)]);
      const double rounding = eps * std::abs(y_[static_cast<std::size_t>(k)]) / 100;
      worst = std::max({worst, e_z / (z + rounding + tiny), e_w / (w + tiny)});
    }
    for (const int column : switching_) {
      double largest = 0.0;
      double error = 0.0;
      for (int k = f; k < 2 * f; ++k) {
        const std::size_t at = sensitivity(k, column);
        const double turns = fastest_ * std::abs(y_[sensitivity(k - f, column)]);
        largest = std::max({largest, turns, std::abs(y_[at]), std::abs(y_new_[at])});
        error = std::max(error, std::abs(error_[at]));
      }
      worst = std::max(worst, error / (of_sensitivities * accuracy * largest + tiny));
    }
    return worst;
  }

  /// Interpolation error within the step, relative to the travel of each coordinate. It also covers steps for which the
  /// method's own estimate fails: that may vanish by chance, and always does for coordinates that depend on time only.
  /// It does not shorten steps twentyfold.
  double weigh_reading(double t, double h) const {
    if (h < taken_ / 20) return 0.0;
    const Trajectory& path = out_.trajectory;
    const std::size_t known = std::min<std::size_t>(3, path.nodes() - smooth_from_);
    const std::size_t first = path.nodes() - known;
    double far = 0.0;
    for (std::size_t i = 0; i < n_; ++i) far = std::max({far, reach_[i], std::abs(reduced_.q()[i] - q_start_[i])});
    // Rounding of the nodes, and of the loops that give the dependent coordinates.
    const double pivot = std::min(pivot_.back(), reduced_.pivot());
    const double loops = reduced_.rank() > 0 ? 2e3 * eps / (pivot + eps) + h * h * uncertain_acceleration() : 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      std::array<NodeValues, 4> nodes;
      for (std::size_t k = 0; k < known; ++k) {
        const std::size_t at = (first + k) * n_ + i;
        nodes[k] = {path.t[first + k], path.q[at] / unit_[i], path.v[at] / unit_[i], path.a[at] / unit_[i]};
      }
      nodes[known] = {t + h, reduced_.q()[i], reduced_.v()[i], reduced_.a()[i]};
      const double reach = std::max({reach_[i], std::abs(nodes[known].q - q_start_[i]), 1e-3 * far});
      const double rounding = 1e4 * eps * std::abs(nodes[known].q) + loops;
      worst = std::max(worst, (reading_error({nodes.data(), known + 1}, t + h / 2) - rounding) / (reach + tiny));
    }
    return worst;
  }

  double reach_of(int k, double h) const {
    const int f = reduced_.freedoms();
    const double w = std::abs(y_[static_cast<std::size_t>(f + k)]);
    const double alpha = acceleration_of(k);
    return std::max(reach_[static_cast<std::size_t>(reduced_.independent()[k])], h * (w + h * alpha / 2));
  }

  double speed_of(int k, double h) const {
    const int f = reduced_.freedoms();
    return std::max(speed_[static_cast<std::size_t>(reduced_.independent()[k])],
                    std::abs(y_[static_cast<std::size_t>(f + k)]) + h * acceleration_of(k));
  }

  /// At the start of the step; with inputs and friction also at its end, because they may begin to act on a mechanism
  /// at rest, and let it go.
  double acceleration_of(int k) const {
    const auto i = static_cast<std::size_t>(reduced_.freedoms() + k);
    return inputs_.empty() && !friction_.acts() ? std::abs(dydt_[i])
                                                : std::max(std::abs(dydt_[i]), std::abs(dydt_new_[i]));
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
      const auto* const sine = input.function ? std::get_if<SineInTime>(&input.function->law) : nullptr;
      if (sine != nullptr) follow(sine->frequency);
    }
    fastest_ = fastest;
    const double natural = fastest > 0 ? 0.05 / fastest : 0.01 * options_.duration;
    return std::min(natural, options_.duration);
  }

  void remake() {
    system_ = std::make_unique<ReducedSystem>(model_.scaled_scene(), reduced_, options_.influences, options_.variations,
                                              columns_);
    system_->set_held(held_by_);
    stepper_ = std::make_unique<solvers::RungeKutta78>(*system_);
    dydt_.resize(y_.size());
    dydt_new_.resize(y_.size());
    y_new_.resize(y_.size());
    error_.resize(y_.size());
  }

  /// Others are to be chosen: the loops are ill-conditioned, or coordinates that are far more sensitive follow from
  /// those chosen, as the angle of a cam from its follower near a dwell.
  bool has_poor_coordinates() const {
    return reduced_.rank() > 0 && (reduced_.pivot() < good_pivot || reduced_.steepness() > 1 / good_pivot);
  }

  void choose_anew(double t) {
    const std::vector<int> old = reduced_.independent();
    const std::vector<double> q(reduced_.q(), reduced_.q() + n_);
    const std::vector<double> v(reduced_.v(), reduced_.v() + n_);
    reduced_.choose(t, q.data(), true);
    reduced_.expect(q.data());
    const int f = reduced_.freedoms();
    if (reduced_.independent() != old) {
      const Trajectory& path = out_.trajectory;
      const std::size_t node = path.nodes() - 1;
      for (int k = 0; k < f; ++k) {
        const auto i = static_cast<std::size_t>(reduced_.independent()[k]);
        y_[static_cast<std::size_t>(k)] = q[i];
        y_[static_cast<std::size_t>(f + k)] = v[i];
        for (int c = 0; c < columns_; ++c) {
          const std::size_t from = (node * n_ + i) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
          const double unit = unit_of_column(c) / unit_[i];
          y_[sensitivity(k, c)] = path.q_p[from] * unit;
          y_[sensitivity(f + k, c)] = path.v_p[from] * unit;
        }
      }
      out_.evaluations += system_->evaluations;
      remake();
    }
    system_->rates(t, y_.data(), dydt_.data());
  }

  /// SI value of the initial coordinate that a column refers to; influences are per the caller's own unit.
  double unit_of_column(int c) const {
    const int f = out_.freedoms;  // at the start
    return c < 2 * f ? unit_[static_cast<std::size_t>(out_.independent[c % f])] : 1.0;
  }

  /// Index of the variation that column c is of; -1 of others.
  int variation_of_column(std::size_t c) const {
    const int influence = static_cast<int>(c) - 2 * out_.freedoms;
    return influence >= 0 ? options_.influences[static_cast<std::size_t>(influence)].variation : -1;
  }

  /// Derivatives of the coordinates or of their rates by column c at the last node, in the units of the model.
  void read_derivatives(const std::vector<double>& by, std::size_t c, std::vector<double>& out) const {
    const std::size_t node = out_.trajectory.nodes() - 1;
    const double unit = unit_of_column(static_cast<int>(c));
    for (std::size_t i = 0; i < n_; ++i) {
      out[i] = by[(node * n_ + i) * static_cast<std::size_t>(columns_) + c] * unit / unit_[i];
    }
  }

  void add_node(double t) {
    Trajectory& path = out_.trajectory;
    const double energy = model_.scales().energy();
    path.t.push_back(t);
    for (std::size_t i = 0; i < n_; ++i) {
      path.q.push_back(unit_[i] * reduced_.q()[i]);
      path.v.push_back(unit_[i] * reduced_.v()[i]);
      path.a.push_back(unit_[i] * reduced_.a()[i]);
      reach_[i] = std::max(reach_[i], std::abs(reduced_.q()[i] - q_start_[i]));
      speed_[i] = std::max(speed_[i], std::abs(reduced_.v()[i]));
    }
    node_.assign(reduced_.q(), reduced_.q() + n_);
    pivot_.push_back(reduced_.pivot());
    const int f = reduced_.freedoms();
    const double kinetic = reduced_.kinetic_energy(), potential = reduced_.potential_energy();
    energy_ = kinetic + potential;
    out_.kinetic.push_back(energy * kinetic);
    out_.potential.push_back(energy * potential);
    out_.work.push_back(energy * y_[static_cast<std::size_t>(2 * f)]);
    for (const double one : {out_.kinetic.back(), out_.potential.back() - out_.potential.front(), out_.work.back()}) {
      exchanged_ = std::max(exchanged_, std::abs(one) / energy);
    }
    for (int d = 0; d < static_cast<int>(out_.drive_force.size()); ++d) {
      const bool turns = model_.scene().drives[static_cast<std::size_t>(d)].on.is_angle();
      out_.drive_force[static_cast<std::size_t>(d)].push_back(reduced_.drive_force(d) *
                                                              (turns ? energy : model_.scales().force));
    }
    if (columns_ > 0) add_sensitivities();
    watch_stops(t);
    // At the start nothing is known of what is at rest, which has no friction there; change_friction() adds the same
    // node with it.
    if (reduced_.slides() != nullptr) margin_ = friction_.watch(reduced_);
    if (!borders_.act()) return;
    borders_.watch(reduced_);
    border_margin_ = borders_.margin(reduced_);
  }

  void add_sensitivities() {
    Trajectory& path = out_.trajectory;
    const int f = reduced_.freedoms();
    const auto width = static_cast<std::size_t>(columns_);
    const std::size_t first = path.q_p.size();
    for (auto* part : {&path.q_p, &path.v_p, &path.a_p}) part->resize(first + n_ * width);
    for (int c = 0; c < columns_; ++c) {
      const double per = 1.0 / unit_of_column(c);
      const int influence = c - 2 * out_.freedoms;
      const double* own = influence < 0 ? nullptr : system_->alpha_p(influence);
      const bool moves = own != nullptr && options_.influences[static_cast<std::size_t>(influence)].moves();
      const double* moved = moves ? system_->moved_p(influence) : nullptr;
      for (std::size_t i = 0; i < n_; ++i) {
        double dq = moves ? moved[i] : 0.0;
        double dv = moves ? moved[n_ + i] : 0.0;
        double da = moves ? moved[2 * n_ + i] : 0.0;
        for (int k = 0; k < f; ++k) {
          const double dz = y_[sensitivity(k, c)];
          const double dw = y_[sensitivity(f + k, c)];
          dq += reduced_.B(k)[i] * dz;
          dv += reduced_.v_z(k)[i] * dz + reduced_.B(k)[i] * dw;
          da += reduced_.a_z(k)[i] * dz + reduced_.a_w(k)[i] * dw;
          if (own != nullptr && !moves) da += reduced_.B(k)[i] * own[k];
        }
        for (std::size_t h = 0; h < reduced_.held().size(); ++h) {
          const double* by = system_->moved_held(h);
          const double value = system_->held_by(h)[c];
          dq += by[i] * value;
          dv += by[n_ + i] * value;
          da += by[2 * n_ + i] * value;
        }
        const std::size_t at = first + i * width + static_cast<std::size_t>(c);
        path.q_p[at] = unit_[i] * per * dq;
        path.v_p[at] = unit_[i] * per * dv;
        path.a_p[at] = unit_[i] * per * da;
      }
    }
  }

  void watch_stops(double t) {
    const auto& mechanism = model_.mechanism();
    if (mechanism.stops() == 0) return;
    const std::vector<double> g = reduced_.stop_values();
    for (std::size_t s = 0; s < g.size(); ++s) {
      const double slack = 1e-9;
      if (overrun_[s] != 0 || (g[s] >= mechanism.lower()[s] - slack && g[s] <= mechanism.upper()[s] + slack)) continue;
      overrun_[s] = 1;
      out_.overrun.push_back(fmt::format("{} at t = {:.4g} s", model_.scene().stops[s].name, t));
    }
  }

  void stop(MotionStatus status, std::string why) {
    out_.status = status;
    out_.why = std::move(why);
  }

  static std::string words_of(StickSlip::Choice choice) {
    switch (choice) {
      case StickSlip::Choice::locked:
        return locked_words;
      case StickSlip::Choice::several:
        return "friction of joints may hold or let go, or let go in several ways: more than one motion agrees with its "
               "laws; give less friction";
      case StickSlip::Choice::none:
        return "friction leaves no motion that agrees with its laws (P. Painleve); give less of it";
      default:
        return fmt::format(
            "friction that sticks acts on more than {} places without rate, or in a singular pose; give some of it a "
            "width",
            StickSlip::most_at_once);
    }
  }

  void give_up(Reduced::Status status, double t) {
    if (status == Reduced::Status::locked) {
      return stop(MotionStatus::stuck, fmt::format("at t = {:.9g} s {}", t, locked_words));
    }
    if (status == Reduced::Status::undetermined) return refuse_undetermined(t);
    // Without a length of a rope nothing that it moves is a number.
    if (status != Reduced::Status::singular && status != Reduced::Status::open) {
      const std::vector<double> q(reduced_.q(), reduced_.q() + n_);
      if (const std::string rope = rope_without_length(model_.scene(), model_.poses(q), 1e-3); !rope.empty()) {
        return stop(MotionStatus::stuck, fmt::format("at t = {:.9g} s {}", t, rope));
      }
    }
    if (status == Reduced::Status::no_inertia) {
      return stop(
          MotionStatus::no_inertia,
          "a degree of freedom has no inertia, so its motion is not determined; give the bodies that it moves mass or "
          "moment of inertia, or drive it");
    }
    const char* what = status == Reduced::Status::singular ? "a singular pose"
                       : status == Reduced::Status::open   ? "a pose in which its loops open"
                                                           : "a point where no step is short enough";
    stop(MotionStatus::stuck, fmt::format("at t = {:.9g} s it reached {}", t, what));
  }

  /// The scene is to blame for a force that its joints leave open from the start.
  void refuse_undetermined(double t) {
    if (t > 0 || reduced_.undetermined() < 0) {
      return stop(MotionStatus::stuck,
                  fmt::format("at t = {:.9g} s it reached a pose that leaves forces in its joints open", t));
    }
    const Joint& joint = model_.scene().joints[static_cast<std::size_t>(reduced_.undetermined())];
    throw InputError(fmt::format(
        "{}:{}: {} \"{}\".friction: the mechanism is statically indeterminate, so that the force in this joint, on "
        "which its friction depends, cannot be known; expected joints of which none repeats others, or friction of a "
        "constant torque or force",
        model_.scene().file, joint.line, joint.traits().key, joint.name));
  }

  static constexpr const char* locked_words =
      "friction locks: the friction of joints grows with the forces that it makes, so that these may be several, or "
      "none (P. Painleve); give less friction";
  static constexpr double eps = std::numeric_limits<double>::epsilon();
  static constexpr double tiny = std::numeric_limits<double>::min();

  const MotionModel& model_;
  const MotionOptions& options_;
  Reduced reduced_;
  StickSlip friction_;
  ProfileBorders borders_;
  std::size_t n_;
  std::vector<double> unit_;  // SI value of each coordinate's unit
  std::vector<double> q_start_, reach_, speed_;
  std::vector<char> overrun_;
  int columns_ = 0;
  double limit_ = 0.0, taken_ = 0.0;
  std::vector<int> switching_;       // sensitivities whose errors count too
  std::vector<MotionInput> inputs_;  // of the options and the scene
  std::vector<double> breaks_;       // of the inputs, ascending
  std::vector<double> jumps_;        // those at which one jumps
  std::size_t next_ = 0;             // of these
  std::size_t smooth_from_ = 0;      // node at the last break, or the last event of friction
  std::size_t piece_from_ = 0;       // of the latter alone
  double margin_ = 0.0;              // of friction at the last node
  double energy_ = 0.0;              // kinetic and potential, at the last node
  double exchanged_ = 0.0;           // largest energy yet
  double border_margin_ = 0.0;       // of the borders of profiles, there
  int approaches_ = 0;               // steps that ended short of the border ahead
  int departures_ = 0;               // steps that are short behind the border passed
  double onward_ = 0.0;              // length of steps to go on with behind a border
  std::vector<double> held_by_;      // sensitivities of the values at which friction is held
  double fastest_ = 0.0;             // rate of change at the start, 1/s
  double ahead_ = 0.0;               // time in which choices of friction are told apart
  double shortest_period_ = std::numeric_limits<double>::infinity();  // of drives and inputs, s
  std::vector<double> node_;                                          // coordinates at the last node
  std::vector<double> end_;                                           // and at the end of the step just made
  std::vector<double> pivot_;                                         // per node
  std::vector<double> y_, dydt_, y_new_, dydt_new_, error_, within_;
  std::unique_ptr<ReducedSystem> system_;
  std::unique_ptr<solvers::RungeKutta78> stepper_;
  Motion out_;
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
  }
  return "";
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
}

}  // namespace

Motion simulate(const MotionModel& model, const MotionState& start, const MotionOptions& options) {
  expect_joint_friction(model.scene());
  refuse_rubbing_ropes(model.scene(), "motion");
  return Simulation(model, start, options).run();
}

}  // namespace poise
