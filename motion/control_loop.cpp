#include "motion/control_loop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "model/controllers.hpp"
#include "model/input_error.hpp"
#include "motion/blades.hpp"
#include "motion/controller_efforts.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/samples.hpp"
#include "motion/simulate.hpp"
#include "solvers/delayed_system.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Real parts of poles within this share of the size of A are zero: a double pole is known to the root of rounding.
constexpr double no_growth_of_pole = 1e-8;
constexpr int most_steps_to_rest = 100;
// Accelerations left, over the largest that a unit of some state makes, where rounding is reached.
constexpr double at_rest_within = 1e-12;
constexpr double touched_within = 1e-8;

class LoopAtRest {
 public:
  LoopAtRest(const MotionModel& model, const std::vector<double>& from)
      : model_(model),
        scene_(model.scene()),
        reduced_(model.scaled_scene(), model.mechanism(), model.inertia()),
        pose_(static_cast<std::size_t>(model.mechanism().pose_size())) {
    refuse_what_is_not_linear();
    reduced_.set_inputs(model.scaled_scene(), {});
    reduced_.begin(0.0, from.data());
    find_states();
    still_.assign(static_cast<std::size_t>(reduced_.coordinates()), 0.0);
    z_.resize(reduced_.independent().size());
    w_.resize(z_.size());
    for (std::size_t k = 0; k < z_.size(); ++k) z_[k] = from[static_cast<std::size_t>(reduced_.independent()[k])];
  }

  ControlLoop find() {
    out_.period = common_period();
    find_delays();
    const bool holds = out_.period > 0.0 || !out_.delayed.empty();
    out_.known = (holds ? comes_to_rest_with_what_is_held() : comes_to_rest()) && touches_nothing();
    if (!out_.known) return std::move(out_);
    keep_free_rates();
    out_.x.assign(reduced_.q(), reduced_.q() + reduced_.coordinates());
    out_.v.assign(reduced_.v(), reduced_.v() + reduced_.coordinates());
    for (int b = 0; b < reduced_.blades(); ++b) {
      out_.blade_force.push_back(reduced_.blade_force(b) * model_.scales().force);
    }
    model_.mechanism().place(reduced_.q(), pose_.data());
    for (const int e : controllers_of(scene_)) add_controller(e);
    out_.known = is_beside_no_edge();
    if (!out_.known) return std::move(out_);
    close();
    open();
    note_directions();
    if (out_.period > 0.0) discretize();
    out_.open_poles = poles_of(along_edges(out_.open.a));
    if (out_.delayed.empty()) {
      const MatrixXd a = along_edges(out_.closed.a);
      out_.poles = poles_of(a);
      out_.system = {a, MatrixXd(a.rows(), 0), MatrixXd(0, a.rows()), MatrixXd(0, 0), VectorXd(0)};
    } else if (!find_poles_with_delays()) {
      return std::move(out_);
    }
    double zero = no_growth_of_pole * out_.closed.a.cwiseAbs().rowwise().sum().maxCoeff();
    double growth = out_.poles.empty() ? 0.0 : out_.poles.front().real();
    if (out_.period > 0.0) {
      std::stable_sort(out_.poles.begin(), out_.poles.end(),
                       [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
      growth = out_.poles.empty() ? -1.0 : std::abs(out_.poles.front()) - 1.0;
      zero = std::max(zero, no_growth_of_pole);
    }
    add_poles_of_blades();
    using Stability = ControlLoop::Stability;
    out_.stability = growth > zero ? Stability::unstable : growth < -zero ? Stability::stable : Stability::marginal;
    return std::move(out_);
  }

 private:
  /// A state of the linear system: an independent coordinate, or the rate of one.
  struct State {
    std::size_t k;
    bool is_rate;
    double unit;  ///< SI value of it in the scaled scene
    bool of_controller;
  };

  void refuse_what_is_not_linear() const {
    refuse_idle_controllers(model_);
    const auto refuse = [&](int line, std::string_view family, const std::string& name) {
      throw InputError(
          fmt::format("{}:{}: {} \"{}\": the linear system of a mechanism with {} is not known "
                      "with it; expected a scene without it",
                      scene_.file, line, family, name, what_keeps(scene_)));
    };
    for (std::size_t d = 0; d < scene_.drives.size(); ++d) {
      const Drive& drive = scene_.drives[d];
      const bool is_set = controller_of_drive(scene_, static_cast<int>(d)) >= 0;
      if (moves_by_itself(static_cast<int>(d)) || (is_set && !scene_.blades.empty())) {
        refuse(drive.line, "drive", drive.name);
      }
    }
    for (const Element& element : scene_.elements) {
      if (std::holds_alternative<DryFriction>(element.law)) refuse(element.line, element.family(), element.name);
    }
    for (const Joint& joint : scene_.joints) {
      if (joint.friction) refuse(joint.line, joint.traits().key, joint.name);
    }
  }

  /// Whether it has a rate or a function of time.
  bool moves_by_itself(int index) const {
    const Drive& drive = scene_.drives[static_cast<std::size_t>(index)];
    const bool has_function = std::any_of(
        scene_.time_functions.begin(), scene_.time_functions.end(),
        [&](const TimeFunction& function) { return function.of == TimeFunction::Of::drive && function.item == index; });
    return has_function || drive.moved(0.0, 1) != 0.0 || drive.moved(0.0, 2) != 0.0;
  }

  /// Each coordinate of the mechanism, and the course of each drive that a controller sets, with its rate, then the
  /// states of controllers: the rates of their coordinates, of a transfer function of second order these too.
  void find_states() {
    std::vector<int> own = states_of_controllers(scene_, model_.layout());
    std::vector<int> second_order;
    for (const int e : controllers_of(scene_)) {
      const Element& element = scene_.elements[static_cast<std::size_t>(e)];
      const auto coordinate = [&](int body) { return model_.layout().links[static_cast<std::size_t>(body)].frame; };
      if (element.feedback->course >= 0) std::erase(own, coordinate(element.feedback->course));
      if (controller_of(element.law)->order == 2) second_order.push_back(coordinate(element.feedback->filter));
    }
    const auto is_in = [](const std::vector<int>& list, int i) {
      return std::find(list.begin(), list.end(), i) != list.end();
    };
    std::vector<std::size_t> order(reduced_.independent().size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return reduced_.independent()[a] < reduced_.independent()[b]; });
    std::vector<State> of_controllers;
    unknown_is_rate_.assign(order.size(), 0);
    for (const std::size_t k : order) {
      const int i = reduced_.independent()[k];
      const bool is_own = is_in(own, i), has_place = !is_own || is_in(second_order, i);
      std::vector<State>& to = is_own ? of_controllers : states_;
      const double unit = model_.layout().is_length(i) ? model_.scales().length : 1.0;
      if (has_place) to.push_back({k, false, unit, is_own});
      to.push_back({k, true, unit, is_own});
      unknown_is_rate_[k] = has_place ? 0 : 1;
    }
    of_mechanism_ = states_.size();
    states_.insert(states_.end(), of_controllers.begin(), of_controllers.end());
  }

  /// N: the rates w = N u that the edges of blades leave, by independent ones, with a column for each rate; those of
  /// rates that follow from others are zero.
  void find_free_rates() {
    const auto f = static_cast<Index>(z_.size());
    free_rates_ = MatrixXd::Identity(f, f);
    const Index held = reduced_.blades();
    if (held == 0) return;
    const solvers::ColumnShares shares = solvers::column_shares(blade_conditions(reduced_), held);
    for (Index i = 0; i < held; ++i) {
      const int rate = shares.columns[static_cast<std::size_t>(i)];
      free_rates_.row(rate).setZero();
      for (Index k = held; k < f; ++k) {
        free_rates_(rate, shares.columns[static_cast<std::size_t>(k)]) = 0.0 - shares.share(i, k - held);
      }
    }
  }
  bool is_free(std::size_t k) const { return free_rates_(static_cast<Index>(k), static_cast<Index>(k)) != 0.0; }

  /// In the equilibrium: rates that follow from others are no states.
  void keep_free_rates() {
    find_free_rates();
    std::erase_if(states_, [&](const State& state) { return state.is_rate && !is_free(state.k); });
    of_mechanism_ = static_cast<std::size_t>(
        std::count_if(states_.begin(), states_.end(), [](const State& state) { return !state.of_controller; }));
    const Eigen::Map<const MatrixXd> along(reduced_.B(0), reduced_.coordinates(), reduced_.freedoms());
    rates_ = along * free_rates_;
  }

  /// The change of the accelerations.
  VectorXd change_by(const State& state) const {
    const auto f = static_cast<Index>(z_.size());
    if (!state.is_rate) return Eigen::Map<const VectorXd>(reduced_.alpha_z(static_cast<int>(state.k)), f);
    return Eigen::Map<const MatrixXd>(reduced_.alpha_w(0), f, f) * free_rates_.col(static_cast<Index>(state.k));
  }

  /// P of the states x = P y, and which of x are y, where blades take part: of these and of the rates all, and of the
  /// places those whose rates are free. What moves by C z = 0 alone stays so, because C z' = 0.
  std::pair<MatrixXd, std::vector<Index>> states_along_edges(Index count) const {
    std::vector<Index> kept;
    for (Index i = 0; i < count; ++i) {
      const bool is_place = i < static_cast<Index>(of_mechanism_) && !states_[static_cast<std::size_t>(i)].is_rate;
      if (!is_place || is_free(states_[static_cast<std::size_t>(i)].k)) kept.push_back(i);
    }
    MatrixXd by = MatrixXd::Zero(count, static_cast<Index>(kept.size()));
    for (Index j = 0; j < by.cols(); ++j) {
      by(kept[static_cast<std::size_t>(j)], j) = 1.0;
      if (kept[static_cast<std::size_t>(j)] >= static_cast<Index>(of_mechanism_)) continue;
      const State& column = states_[static_cast<std::size_t>(kept[static_cast<std::size_t>(j)])];
      for (std::size_t i = 0; i < of_mechanism_ && !column.is_rate; ++i) {
        const State& row = states_[i];
        if (row.is_rate || is_free(row.k)) continue;
        by(static_cast<Index>(i), j) =
            free_rates_(static_cast<Index>(row.k), static_cast<Index>(column.k)) * row.unit / column.unit;
      }
    }
    return {by, kept};
  }
  MatrixXd along_edges(const MatrixXd& a) const {
    if (reduced_.blades() == 0) return a;
    const auto [by, kept] = states_along_edges(a.rows());
    return a(kept, Eigen::all) * by;
  }

  /// Adds a pole for each component of C z, which no state changes.
  void add_poles_of_blades() {
    const double rests = out_.period > 0.0 ? 1.0 : 0.0;
    for (std::vector<std::complex<double>>* poles : {&out_.poles, &out_.open_poles}) {
      const bool are_listed = poles == &out_.open_poles || out_.delayed.empty() || out_.poles_right_of < 0.0;
      const double value = poles == &out_.poles ? rests : 0.0;
      const auto size = [&](const std::complex<double>& pole) {
        return poles == &out_.poles && out_.period > 0.0 ? std::abs(pole) : pole.real();
      };
      for (int b = 0; b < reduced_.blades() && are_listed; ++b) {
        const auto behind =
            std::find_if(poles->begin(), poles->end(), [&](const auto& pole) { return size(pole) < value; });
        poles->insert(behind, std::complex<double>(value, 0.0));
      }
    }
  }

  /// That of all controllers with one; 0 without any.
  double common_period() const {
    const Element* first = nullptr;
    for (const int e : controllers_of(scene_)) {
      const Element& one = scene_.elements[static_cast<std::size_t>(e)];
      const Controller& law = *controller_of(one.law);
      if (!law.has(Controller::period)) continue;
      if (one.feedback->reads_reaction()) {
        throw InputError(fmt::format(
            "{}:{}: controller \"{}\".reads: the linear system of samples of a force in a joint or of a drive is not "
            "known; expected a controller that reads it without a period",
            scene_.file, one.line, one.name));
      }
      if (first == nullptr) first = &one;
      if (law.values[Controller::period] == controller_of(first->law)->values[Controller::period]) continue;
      throw InputError(fmt::format(
          "{}:{}: controller \"{}\".period: the linear system of samples with several periods is not known; "
          "expected {:g} s, that of \"{}\"",
          scene_.file, one.line, one.name, controller_of(first->law)->values[Controller::period], first->name));
    }
    return first == nullptr ? 0.0 : controller_of(first->law)->values[Controller::period];
  }

  void find_delays() {
    for (const int e : controllers_of(scene_)) {
      const Element& one = scene_.elements[static_cast<std::size_t>(e)];
      const Controller& law = *controller_of(one.law);
      if (!law.has(Controller::delay)) continue;
      (out_.period > 0.0 ? late_ : out_.delayed).push_back({e, law.values[Controller::delay]});
    }
  }

  /// The equilibrium is that of controllers that decide at all times, and act at once.
  bool comes_to_rest_with_what_is_held() {
    Scene scene = scene_;
    for (const int e : controllers_of(scene)) {
      Element& one = scene.elements[static_cast<std::size_t>(e)];
      Controller& law = std::get<Controller>(one.law);
      law.given &= ~(1U << Controller::period | 1U << Controller::delay);
      law.declare(one.feedback->signal, one.feedback->acts, one.feedback->output);
    }
    if (!circle_of_decisions(scene).empty()) return fail("controllers with delays follow each other in a circle");
    const MotionModel model(scene, model_.scales());
    LoopAtRest at_all_times(model, {reduced_.q(), reduced_.q() + reduced_.coordinates()});
    if (!at_all_times.comes_to_rest()) return fail(at_all_times.out_.why);
    z_ = at_all_times.z_;
    w_ = at_all_times.w_;
    reduced_.evaluate(0.0, z_.data(), w_.data());
    Samples samples(model_, {}, {});
    for (const Samples::Held& held : samples.take(reduced_, 0.0, 0.0)) w_[place_of(held.coordinate)] = held.rate;
    for (const std::vector<DelayedControl>* all : {&out_.delayed, &late_}) {
      for (const DelayedControl& one : *all) {
        w_[place_of(held_coordinate(one.element))] =
            at_all_times.effort_of(one.element) / law_of(one.element).effort_unit;
      }
    }
    if (reduced_.evaluate(0.0, z_.data(), w_.data()) != ReducedMotion<double>::Status::ok) {
      return fail("its equations of motion have no solution in its equilibrium");
    }
    reduced_.linearize();
    return true;
  }

  /// What it gives at the place evaluated last.
  double effort_of(int element) {
    model_.mechanism().place(reduced_.q(), pose_.data());
    return model_.mechanism().outputs_of(element, pose_.data(), reduced_.v()).effort;
  }
  int held_coordinate(int element) const {
    return model_.layout().links[static_cast<std::size_t>(feedback_of(element).held[0])].frame;
  }

  std::size_t place_of(int coordinate) const {
    const std::vector<int>& all = reduced_.independent();
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), coordinate) - all.begin());
  }

  /// With e^(A T) of the states x, what is held, h, what delays give, g, and the references r between samples, and at a
  /// sample  h = H x + H_g g + K r.  What is delayed is  d = D h + D_r r,  constant between samples: with
  /// T = (n + p) periods, 0 <= p < 1, g is d(k - n - 1) up to p of the period and d(k - n) from there on. So x and the
  /// last n + 1 of d are the states of the samples.
  void discretize() {
    StateSpace& loop = out_.closed;
    std::vector<Influence> references;
    for (const ControlAtRest& one : out_.controllers) {
      const ControlChange<double> by = along_reference(one.element);
      Influence& reference = references.emplace_back();
      reference.force = {ForceNumber::Of::element, one.element, by.number};
      reference.by = 1.0;
    }
    Samples samples(model_, {}, references);
    std::vector<Index> free, held, given(late_.size());
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const auto is_of = [&](const DelayedControl& one) {
        return held_coordinate(one.element) == reduced_.independent()[states_[i].k];
      };
      const auto late = std::find_if(late_.begin(), late_.end(), is_of);
      const auto at = static_cast<Index>(i);
      if (late != late_.end()) {
        given[static_cast<std::size_t>(late - late_.begin())] = at;
      } else {
        (is_held(states_[i]) ? held : free).push_back(at);
      }
    }
    const auto decided_by = [&](const ControlChange<double>& change, int influence) {
      const auto n = static_cast<std::size_t>(reduced_.coordinates());
      const std::vector<double> dq(change.dq, change.dq + n), dv(change.dv, change.dv + n);
      VectorXd out(static_cast<Index>(held.size()));
      for (const Samples::Held& one : samples.take_by(reduced_, 0.0, 0.0, dq, dv, influence)) {
        for (std::size_t h = 0; h < held.size(); ++h) {
          const State& state = states_[static_cast<std::size_t>(held[h])];
          if (reduced_.independent()[state.k] == one.coordinate) out[static_cast<Index>(h)] = one.rate;
        }
      }
      return out;
    };
    const auto n = static_cast<Index>(states_.size()), m = static_cast<Index>(references.size());
    const auto f = static_cast<Index>(free.size()), k = static_cast<Index>(held.size());
    const auto q = static_cast<Index>(late_.size());
    MatrixXd by_states(k, n), by_references(k, m), late_by_states(q, n), late_by_references(q, m);
    for (Index j = 0; j < n; ++j) {
      const State& column = states_[static_cast<std::size_t>(j)];
      by_states.col(j) = decided_by(along(column), -1) / column.unit;
      for (Index i = 0; i < q; ++i) {
        const int element = late_[static_cast<std::size_t>(i)].element;
        late_by_states(i, j) = decided_along(element, along(column)) / column.unit;
      }
    }
    for (Index r = 0; r < m; ++r) {
      const int by = out_.controllers[static_cast<std::size_t>(r)].element;
      by_references.col(r) =
          decided_by({.dq = still_.data(), .dv = still_.data()}, static_cast<int>(r)) / reading_unit(by);
      for (Index i = 0; i < q; ++i) {
        const int element = late_[static_cast<std::size_t>(i)].element;
        late_by_references(i, r) = decided_along(element, along_reference(by)) / reading_unit(by);
      }
    }
    refuse_late_unless_sampled(late_by_states(Eigen::all, free), late_by_states(Eigen::all, given));

    // All is linear in the states of the samples and the references.
    struct Late {
      Index first, passed;  // of its states; n
      double part;          // p
    };
    std::vector<Late> late;
    Index count = f;
    for (const DelayedControl& one : late_) {
      constexpr double whole_within = 1e-9;  // of a period
      const double periods = one.delay / out_.period;
      const double passed = std::floor(periods + whole_within);
      late.push_back({count, static_cast<Index>(passed), periods - passed > whole_within ? periods - passed : 0.0});
      count += static_cast<Index>(passed) + 1;
    }
    const MatrixXd all = MatrixXd::Identity(count + m, count + m);
    const auto of_references = all.bottomRows(m);
    MatrixXd x = all.topRows(f), before(q, count + m);
    for (Index i = 0; i < q; ++i)
      before.row(i) = all.row(late[static_cast<std::size_t>(i)].first + late[static_cast<std::size_t>(i)].passed);
    const MatrixXd decided =
        by_states(Eigen::all, free) * x + by_states(Eigen::all, given) * before + by_references * of_references;
    const MatrixXd delayed = late_by_states(Eigen::all, held) * decided + late_by_references * of_references;
    const auto given_at = [&](double part) {
      MatrixXd out = before;
      for (Index i = 0; i < q; ++i) {
        const Late& one = late[static_cast<std::size_t>(i)];
        if (part < one.part) continue;
        out.row(i) = one.passed == 0 ? delayed.row(i) : all.row(one.first + one.passed - 1);
      }
      return out;
    };
    const MatrixXd outputs = loop.c(Eigen::all, free) * x + loop.c(Eigen::all, held) * decided +
                             loop.c(Eigen::all, given) * given_at(0.0) + loop.d * of_references;
    std::vector<double> parts{0.0, 1.0};
    for (const Late& one : late) parts.push_back(one.part);
    std::sort(parts.begin(), parts.end());
    MatrixXd rates = MatrixXd::Zero(n + m, n + m);
    rates.topLeftCorner(n, n) = loop.a;
    rates.topRightCorner(n, m) = loop.b;
    const auto last = Eigen::seqN(n, m);
    for (std::size_t p = 0; p + 1 < parts.size(); ++p) {
      if (parts[p] == parts[p + 1]) continue;
      const MatrixXd step = (rates * (out_.period * (parts[p + 1] - parts[p]))).exp();
      x = (step(free, free) * x + step(free, held) * decided + step(free, given) * given_at(parts[p]) +
           step(free, last) * of_references)
              .eval();
    }
    MatrixXd next(count, count + m);
    next.topRows(f) = x;
    std::vector<std::string> names;
    for (const Index i : free) names.push_back(loop.states[static_cast<std::size_t>(i)]);
    for (Index i = 0; i < q; ++i) {
      const Late& one = late[static_cast<std::size_t>(i)];
      next.row(one.first) = delayed.row(i);
      next.middleRows(one.first + 1, one.passed) = all.middleRows(one.first, one.passed);
      for (Index s = 0; s <= one.passed; ++s) {
        names.push_back(fmt::format("{} {} before", name_of(late_[static_cast<std::size_t>(i)].element), s + 1));
      }
    }
    loop.a = next.leftCols(count);
    loop.b = next.rightCols(m);
    loop.c = outputs.leftCols(count);
    loop.d = outputs.rightCols(m);
    loop.states = std::move(names);
  }

  /// Throws InputError where what is delayed changes between samples, by states or by what delays give.
  void refuse_late_unless_sampled(const MatrixXd& by_states, const MatrixXd& by_given) const {
    for (std::size_t i = 0; i < late_.size(); ++i) {
      const auto row = static_cast<Index>(i);
      if (by_states.row(row).isZero(0.0) && by_given.row(row).isZero(0.0)) continue;
      const Element& one = scene_.elements[static_cast<std::size_t>(late_[i].element)];
      throw InputError(fmt::format(
          "{}:{}: controller \"{}\".delay: the linear system of samples beside a delay of what changes between them is "
          "not known; expected one that follows a controller with a period, or a scene without periods",
          scene_.file, one.line, one.name));
    }
  }

  /// What a controller decides along a change, SI.
  double decided_along(int element, const ControlChange<double>& change) {
    const Controller& law = law_of(element);
    const Mechanism<double>& m = model_.mechanism();
    const ControlSignals<double> in = m.signals_of(element, pose_.data(), reduced_.v());
    double out = law.decide_along(in, m.signals_along(element, pose_.data(), reduced_.v(), change)).effort;
    if (change.element == element) out += change.by * law.decide_by(change.number, in).effort;
    return out * effort_unit(element);
  }

  /// What is given after delays is no state of the loop, but an input of it, and what is decided an output.
  bool find_poles_with_delays() {
    StateSpace& loop = out_.closed;
    const auto m = static_cast<Index>(loop.b.cols()), k = static_cast<Index>(out_.delayed.size());
    std::vector<Index> free, held;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (!is_held(states_[i])) free.push_back(static_cast<Index>(i));
    }
    for (const DelayedControl& one : out_.delayed) {
      const auto is_of_it = [&](const State& state) {
        return reduced_.independent()[state.k] == held_coordinate(one.element);
      };
      held.push_back(std::find_if(states_.begin(), states_.end(), is_of_it) - states_.begin());
    }
    MatrixXd decided(k, loop.a.cols()), by_references(k, m);
    for (Index i = 0; i < k; ++i) {
      const int element = out_.delayed[static_cast<std::size_t>(i)].element;
      for (Index j = 0; j < decided.cols(); ++j) {
        const State& column = states_[static_cast<std::size_t>(j)];
        decided(i, j) = decided_along(element, along(column)) / column.unit;
      }
      for (Index r = 0; r < m; ++r) {
        const int by = out_.controllers[static_cast<std::size_t>(r)].element;
        by_references(i, r) = decided_along(element, along_reference(by)) / reading_unit(by);
      }
    }
    const auto f = static_cast<Index>(free.size());
    const solvers::DelayedSystem whole{loop.a(free, free), loop.a(free, held), decided(Eigen::all, free),
                                       decided(Eigen::all, held), Eigen::VectorXd(k)};
    solvers::DelayedSystem system = whole;
    if (reduced_.blades() > 0) {
      const auto [by, kept] = states_along_edges(f);
      system.a = along_edges(whole.a);
      system.b = whole.b(kept, Eigen::all);
      system.c = whole.c * by;
    }
    for (Index i = 0; i < k; ++i) system.delays[i] = out_.delayed[static_cast<std::size_t>(i)].delay;
    StateSpace cut;
    cut.a = whole.a;
    cut.b.resize(f, m + k);
    cut.b << loop.b(free, Eigen::all), whole.b;
    cut.c.resize(loop.c.rows() + k, f);
    cut.c << loop.c(Eigen::all, free), whole.c;
    cut.d.resize(loop.c.rows() + k, m + k);
    cut.d << loop.d, loop.c(Eigen::all, held), by_references, whole.d;
    for (const Index i : free) cut.states.push_back(loop.states[static_cast<std::size_t>(i)]);
    cut.inputs = loop.inputs;
    cut.outputs = loop.outputs;
    for (const DelayedControl& one : out_.delayed) {
      cut.inputs.push_back(name_of(one.element) + ".given");
      cut.outputs.push_back(name_of(one.element) + ".decided");
    }
    loop = std::move(cut);
    // Far poles may be too many for their count: then fewer are listed.
    std::optional<solvers::RightmostPoles> found;
    for (Index least = system.a.rows() + 2 * k; !found && least > 0; --least) {
      found = solvers::rightmost_poles(system, static_cast<int>(least));
    }
    if (!found) {
      out_.known = false;
      return fail("the poles that are found are not as many as are counted");
    }
    out_.poles = found->poles;
    out_.poles_right_of = found->right_of;
    out_.system = std::move(system);
    return true;
  }

  bool is_held(const State& state) const {
    const int coordinate = reduced_.independent()[state.k];
    for (const ControlAtRest& one : out_.controllers) {
      for (const int body : feedback_of(one.element).held) {
        if (body >= 0 && model_.layout().links[static_cast<std::size_t>(body)].frame == coordinate) return true;
      }
    }
    return false;
  }

  double largest_acceleration() const {
    double out = 0.0;
    for (int k = 0; k < reduced_.freedoms(); ++k) out = std::max(out, std::abs(reduced_.alpha()[k]));
    return out;
  }

  bool fail(std::string why) {
    out_.why = std::move(why);
    return false;
  }

  /// Newton's method for alpha = 0 in the places z of the mechanism and the states of controllers; places move along
  /// the edges of blades.
  bool comes_to_rest() {
    if (reduced_.freedoms() == 0) return fail("its closures leave no degree of freedom");
    const auto f = static_cast<Index>(z_.size());
    if (reduced_.evaluate(0.0, z_.data(), w_.data()) != ReducedMotion<double>::Status::ok) {
      return fail("its equations of motion have no solution at the start");
    }
    double left = largest_acceleration();
    for (int step = 0; step < most_steps_to_rest; ++step) {
      reduced_.linearize();
      find_free_rates();
      MatrixXd by_unknowns(f, f);
      std::vector<Index> free;
      for (Index k = 0; k < f; ++k) {
        const double* by = unknown_is_rate_[static_cast<std::size_t>(k)] != 0 ? reduced_.alpha_w(static_cast<int>(k))
                                                                              : reduced_.alpha_z(static_cast<int>(k));
        by_unknowns.col(k) = Eigen::Map<const VectorXd>(by, f);
        if (is_free(static_cast<std::size_t>(k))) free.push_back(k);
      }
      if (free.empty()) return true;  // blades hold all of it
      const MatrixXd moves = free_rates_(Eigen::all, free), jacobian = by_unknowns(free, Eigen::all) * moves;
      const double size = std::max(jacobian.cwiseAbs().maxCoeff(), 1e-300);
      if (left <= at_rest_within * size) return true;
      const VectorXd alpha = Eigen::Map<const VectorXd>(reduced_.alpha(), f)(free);
      VectorXd move = moves * -solvers::minimum_norm_solution<double>(jacobian, alpha);
      const std::vector<double> z = z_, w = w_;
      double now = std::numeric_limits<double>::infinity();
      constexpr int most_halvings = 30;
      for (int halving = 0; halving < most_halvings && !(now < left); ++halving, move /= 2) {
        for (std::size_t k = 0; k < z.size(); ++k) {
          const bool is_rate = unknown_is_rate_[k] != 0;
          (is_rate ? w_[k] : z_[k]) = (is_rate ? w[k] : z[k]) + move[static_cast<Index>(k)];
        }
        const bool is_there = reduced_.evaluate(0.0, z_.data(), w_.data()) == ReducedMotion<double>::Status::ok;
        now = is_there ? largest_acceleration() : std::numeric_limits<double>::infinity();
      }
      if (!(now < left)) {
        z_ = z;
        w_ = w;
        reduced_.evaluate(0.0, z_.data(), w_.data());
        reduced_.linearize();
        constexpr double rounding_of_rest = 1e-9;
        if (left <= rounding_of_rest * size) return true;
        const std::string_view kept_by = what_keeps(scene_);
        return fail(kept_by == "motors" ? "none is found from where it is assembled: its motors may turn it"
                    : kept_by == "blades"
                        ? "none is found from where it is assembled, along the edges of its blades"
                        : "no equilibrium of it with its controllers is found from where it is assembled: an integral "
                          "may have no effort that brings its error to zero, or a limit is in the way");
      }
      left = now;
    }
    return fail(fmt::format("Newton's method for the equilibrium with its {} does not end", what_keeps(scene_)));
  }

  bool touches_nothing() {
    const std::vector<double> values = reduced_.stop_values();
    const Mechanism<double>& m = model_.mechanism();
    for (std::size_t s = 0; s < values.size(); ++s) {
      if (scene_.stops[s].holds()) continue;
      if (values[s] > m.lower()[s] + touched_within && values[s] < m.upper()[s] - touched_within) continue;
      return fail(fmt::format("it is at or beyond a limit of {} in its equilibrium", scene_.stops[s].title()));
    }
    return true;
  }

  /// Whether no error is at the end of a dead band, where a controller acts on one side and does not on the other.
  bool is_beside_no_edge() {
    for (const ControlAtRest& one : out_.controllers) {
      const Controller& law = law_of(one.element);
      if (!law.has(Controller::dead_band)) continue;
      const ControlSignals<double> in =
          model_.mechanism().signals_of(one.element, pose_.data(), reduced_.v(), reduced_.forces_in_time());
      const double error = law.values[Controller::reference] + in.followed - in.value;
      const double band = law.values[Controller::dead_band];
      if (!(std::abs(std::abs(error) - band) <= touched_within * band)) continue;
      return fail(fmt::format(
          "controller \"{}\" is at the end of its dead band in the one that is found, where it acts on one side alone; "
          "{}",
          name_of(one.element),
          law.has(Controller::integral) ? "within the dead band all places are equilibria"
                                        : "no linear system holds on both sides"));
    }
    return true;
  }

  const Controller& law_of(int element) const { return *controller_of(model_.mechanism().law_of(element)); }
  const Feedback& feedback_of(int element) const {
    return *scene_.elements[static_cast<std::size_t>(element)].feedback;
  }
  double effort_unit(int element) const { return 1.0 / feedback_of(element).output.per_scale(model_.scales()); }
  double reading_unit(int element) const { return 1.0 / feedback_of(element).signal.per_scale(model_.scales()); }
  /// Where a state changes.
  ControlChange<double> along(const State& state) const {
    const auto k = static_cast<int>(state.k);
    return {.dq = state.is_rate ? still_.data() : reduced_.B(k),
            .dv = state.is_rate ? rates_.col(k).data() : reduced_.v_z(k)};
  }
  /// Where the reference of a controller changes.
  ControlChange<double> along_reference(int element) const {
    const unsigned below = law_of(element).given & ((1U << Controller::reference) - 1U);
    return {.element = element, .number = std::popcount(below), .by = 1.0};
  }
  double effort_along(int element, const ControlChange<double>& change) {
    return model_.mechanism().outputs_along(element, pose_.data(), reduced_.v(), change).effort;
  }
  VectorXd accelerations_by(const std::vector<double>& slope) {
    VectorXd out(reduced_.freedoms());
    reduced_.push(slope.data(), out.data());
    return out;
  }
  /// The derivatives of the accelerations by the reference of a controller, and by its effort.
  VectorXd by_reference(int element) {
    std::vector<double> slope(still_.size(), 0.0);
    model_.mechanism().add_control_derivative(along_reference(element), pose_.data(), reduced_.v(), {}, slope.data());
    return -accelerations_by(slope);
  }
  VectorXd by_effort(int element) {
    std::vector<double> slope(still_.size(), 0.0);
    model_.mechanism().add_output_derivative(element, pose_.data(), reduced_.v(), slope.data());
    return -accelerations_by(slope);
  }

  void add_controller(int element) {
    const Controller& law = law_of(element);
    const ControlSignals<double> in =
        model_.mechanism().signals_of(element, pose_.data(), reduced_.v(), reduced_.forces_in_time());
    const ControlOutputs<double> out = law.decide(in);
    const double error = law.values[Controller::reference] + in.followed - in.value;
    out_.controllers.push_back({element, in.value * reading_unit(element), out.effort * effort_unit(element),
                                out.effort != out.unlimited,
                                law.has(Controller::dead_band) && std::abs(error) < law.values[Controller::dead_band]});
  }

  /// Places of bodies behind joints whose forces are read have no name of their own in the layout.
  std::string name_of_coordinate(int i) const {
    const Layout& layout = model_.layout();
    for (const Link& link : layout.links) {
      for (const Arm& arm : link.arms) {
        const bool is_it = link.parent == 0 && link.body >= 0 && arm.coordinate == i;
        if (!is_it || !layout.coordinates[static_cast<std::size_t>(i)].name.empty()) continue;
        return scene_.bodies[static_cast<std::size_t>(link.body)].name + (arm.arm.x != 0 ? ".x" : ".y");
      }
    }
    return layout.coordinates[static_cast<std::size_t>(i)].name;
  }

  std::vector<std::string> names_of(std::size_t count) const {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < count; ++k) {
      const State& state = states_[k];
      const int i = reduced_.independent()[state.k];
      const std::string name = name_of_coordinate(i);
      const bool is_rate = state.is_rate && (!state.of_controller || unknown_is_rate_[state.k] == 0);
      out.push_back(is_rate ? "d(" + name + ")/dt" : name);
    }
    return out;
  }

  const std::string& name_of(int element) const { return scene_.elements[static_cast<std::size_t>(element)].name; }

  void close() {
    StateSpace& loop = out_.closed;
    const auto n = static_cast<Index>(states_.size());
    const auto m = static_cast<Index>(out_.controllers.size());
    loop.states = names_of(states_.size());
    loop.a = MatrixXd::Zero(n, n);
    loop.b = MatrixXd::Zero(n, m);
    loop.c = MatrixXd::Zero(2 * m, n);
    loop.d = MatrixXd::Zero(2 * m, m);
    for (Index j = 0; j < n; ++j) {
      const State& column = states_[static_cast<std::size_t>(j)];
      const VectorXd change = change_by(column);
      for (Index i = 0; i < n; ++i) {
        const State& row = states_[static_cast<std::size_t>(i)];
        const auto k = static_cast<Index>(row.k);
        const double by_rate = column.is_rate ? free_rates_(k, static_cast<Index>(column.k)) : 0.0;
        loop.a(i, j) = (row.is_rate ? change[k] : by_rate) * row.unit / column.unit;
      }
    }
    for (Index e = 0; e < m; ++e) {
      const int element = out_.controllers[static_cast<std::size_t>(e)].element;
      const double read = reading_unit(element), effort = effort_unit(element);
      const VectorXd by = by_reference(element);
      loop.inputs.push_back(name_of(element) + ".reference");
      for (Index i = 0; i < n; ++i) {
        const State& row = states_[static_cast<std::size_t>(i)];
        if (row.is_rate) loop.b(i, e) = by[static_cast<Index>(row.k)] * row.unit / read;
      }
      loop.outputs.push_back(name_of(element) + ".reads");
      for (Index j = 0; j < n; ++j) {
        const State& column = states_[static_cast<std::size_t>(j)];
        loop.c(e, j) = reading_along(element, along(column)) * read / column.unit;
        loop.c(m + e, j) = effort_along(element, along(column)) * effort / column.unit;
      }
      for (Index r = 0; r < m; ++r) {
        const int by_that = out_.controllers[static_cast<std::size_t>(r)].element;
        const double of_that = reading_unit(by_that);
        loop.d(e, r) = reading_along(element, along_reference(by_that)) * read / of_that;
        loop.d(m + e, r) = effort_along(element, along_reference(by_that)) * effort / of_that;
      }
    }
    for (const ControlAtRest& one : out_.controllers) loop.outputs.push_back(name_of(one.element) + ".effort");
  }

  void note_directions() {
    const auto n = static_cast<Index>(still_.size());
    std::vector<std::size_t> own;
    int next = 0;
    for (std::size_t i = 0; i < of_mechanism_; ++i) {
      if (!is_free(states_[i].k)) continue;
      (states_[i].is_rate ? out_.rates : out_.places).push_back(next++);
      if (!states_[i].is_rate) own.push_back(i);
    }
    const auto f = static_cast<Index>(own.size());
    out_.along.resize(n, f);
    for (Index k = 0; k < f; ++k) {
      const State& state = states_[own[static_cast<std::size_t>(k)]];
      out_.along.col(k) = rates_.col(static_cast<Index>(state.k)) / state.unit;
    }
    std::vector<const State*> of_system;
    for (const State& state : states_) {
      const bool follows_from_others = !state.of_controller && !is_free(state.k);
      const bool is_input = !out_.delayed.empty() && is_held(state);
      if (!follows_from_others && !is_input) of_system.push_back(&state);
    }
    out_.by_force = MatrixXd::Zero(static_cast<Index>(of_system.size()), n);
    for (Index i = 0; i < n; ++i) {
      std::vector<double> push(still_.size(), 0.0);
      push[static_cast<std::size_t>(i)] = 1.0;
      const VectorXd by = accelerations_by(push);
      for (Index row = 0; row < out_.by_force.rows(); ++row) {
        const State& state = *of_system[static_cast<std::size_t>(row)];
        if (state.is_rate) out_.by_force(row, i) = by[static_cast<Index>(state.k)] * state.unit;
      }
    }
  }

  double reading_along(int element, const ControlChange<double>& change) {
    if (feedback_of(element).reads_reaction() && change.element >= 0) {
      by_reference(change.element);
      return reduced_.reaction_change(element);
    }
    if (feedback_of(element).reads_reaction()) {
      return reduced_.reactions_along(change.dq, change.dv, nullptr)[static_cast<std::size_t>(element)];
    }
    return model_.mechanism().signals_along(element, pose_.data(), reduced_.v(), change).value;
  }

  /// The mechanism alone: that of the closed loop less what the efforts do that follow its states.
  void open() {
    StateSpace& plant = out_.open;
    const auto n = static_cast<Index>(of_mechanism_);
    std::vector<Index> acting, reading;
    for (std::size_t e = 0; e < out_.controllers.size(); ++e) {
      const Feedback& feedback = feedback_of(out_.controllers[e].element);
      if (feedback.acts || feedback.sets) acting.push_back(static_cast<Index>(e));
      if (feedback.source == Feedback::Source::measure) reading.push_back(static_cast<Index>(e));
    }
    const auto inputs = static_cast<Index>(acting.size()), outputs = static_cast<Index>(reading.size());
    plant.states = names_of(of_mechanism_);
    plant.a = out_.closed.a.topLeftCorner(n, n);
    plant.b = MatrixXd::Zero(n, inputs);
    plant.c = MatrixXd::Zero(outputs, n);
    plant.d = MatrixXd::Zero(outputs, inputs);
    const auto m = static_cast<Index>(out_.controllers.size());
    for (Index u = 0; u < inputs; ++u) {
      const Index e = acting[static_cast<std::size_t>(u)];
      const int element = out_.controllers[static_cast<std::size_t>(e)].element;
      const VectorXd push = by_effort(element);
      for (Index i = 0; i < n; ++i) {
        const State& row = states_[static_cast<std::size_t>(i)];
        if (row.is_rate) plant.b(i, u) = push[static_cast<Index>(row.k)] * row.unit / effort_unit(element);
      }
      plant.a -= plant.b.col(u) * out_.closed.c.row(m + e).head(n);
      plant.inputs.push_back(name_of(element) + ".effort");
    }
    for (Index y = 0; y < outputs; ++y) {
      const Index e = reading[static_cast<std::size_t>(y)];
      plant.c.row(y) = out_.closed.c.row(e).head(n);
      plant.outputs.push_back(name_of(out_.controllers[static_cast<std::size_t>(e)].element) + ".reads");
    }
  }

  static std::vector<std::complex<double>> poles_of(const MatrixXd& a) {
    std::vector<std::complex<double>> out;
    if (a.rows() == 0) return out;
    const solvers::Eigenpairs eigen = solvers::eigenpairs(a);
    for (const std::complex<double>& one : eigen.values) out.push_back(one + std::complex<double>(0.0, 0.0));
    std::sort(out.begin(), out.end(), [](const auto& p, const auto& q) {
      return p.real() != q.real() ? p.real() > q.real() : p.imag() > q.imag();
    });
    return out;
  }

  const MotionModel& model_;
  const Scene& scene_;
  ReducedMotion<double> reduced_;
  std::vector<Planar<double>> pose_;
  std::vector<State> states_;  // of the mechanism first
  std::size_t of_mechanism_ = 0;
  std::vector<char> unknown_is_rate_;  // of each independent coordinate: at rest its rate is looked for, not its place
  std::vector<double> z_, w_;
  MatrixXd free_rates_, rates_;       // N of the rates w = N u, and of all coordinates B N
  std::vector<double> still_;         // a direction in which no coordinate moves
  std::vector<DelayedControl> late_;  // beside samples
  ControlLoop out_;
};

}  // namespace

std::string_view what_keeps(const Scene& scene) {
  if (!controllers_of(scene).empty()) return "controllers";
  if (!scene.blades.empty()) return "blades";
  const auto drives = [](const Element& element) { return is_motor(element.law); };
  return std::any_of(scene.elements.begin(), scene.elements.end(), drives) ? "motors" : "";
}

ControlLoop control_loop(const MotionModel& model, const std::vector<double>& from) {
  return LoopAtRest(model, from).find();
}

std::optional<ControlLoop> loop_where_kept(const MotionModel& model) {
  const std::string_view kept_by = what_keeps(model.scene());
  if (kept_by.empty()) return std::nullopt;
  try {
    ControlLoop loop = control_loop(model, model.from_si(start_motion(model, {}).q));
    if (loop.known || kept_by != "motors") return loop;
  } catch (const InputError&) {
    if (kept_by != "motors") throw;  // what the linear system does not know; without motors there is that of statics
  }
  return std::nullopt;
}

}  // namespace poise
