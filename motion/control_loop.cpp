#include "motion/control_loop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "motion/reduced_motion.hpp"
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
    z_.resize(reduced_.independent().size());
    w_.resize(z_.size());
    for (std::size_t k = 0; k < z_.size(); ++k) z_[k] = from[static_cast<std::size_t>(reduced_.independent()[k])];
  }

  ControlLoop find() {
    out_.known = comes_to_rest() && touches_nothing();
    if (!out_.known) return std::move(out_);
    out_.x.assign(reduced_.q(), reduced_.q() + reduced_.coordinates());
    model_.mechanism().place(reduced_.q(), pose_.data());
    for (const int e : controllers_of(scene_)) add_controller(e);
    close();
    open();
    out_.poles = poles_of(out_.closed.a);
    out_.open_poles = poles_of(out_.open.a);
    const double zero = no_growth_of_pole * out_.closed.a.cwiseAbs().rowwise().sum().maxCoeff();
    const double growth = out_.poles.empty() ? 0.0 : out_.poles.front().real();
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
    const auto refuse = [&](int line, std::string_view family, const std::string& name) {
      throw InputError(
          fmt::format("{}:{}: {} \"{}\": the linear system of a mechanism with controllers is not known "
                      "with it; expected a scene without it",
                      scene_.file, line, family, name));
    };
    for (const Drive& drive : scene_.drives) refuse(drive.line, "drive", drive.name);
    for (const Element& element : scene_.elements) {
      if (std::holds_alternative<DryFriction>(element.law)) refuse(element.line, element.family(), element.name);
    }
    for (const Joint& joint : scene_.joints) {
      if (joint.friction) refuse(joint.line, joint.traits().key, joint.name);
    }
  }

  /// Each coordinate of the mechanism with its rate, then the states of controllers: the rates of their coordinates,
  /// of a transfer function of second order these too.
  void find_states() {
    const std::vector<int> own = states_of_controllers(scene_, model_.layout());
    std::vector<int> second_order;
    for (const int e : controllers_of(scene_)) {
      const Element& element = scene_.elements[static_cast<std::size_t>(e)];
      if (controller_of(element.law)->order < 2) continue;
      second_order.push_back(model_.layout().links[static_cast<std::size_t>(element.feedback->filter)].frame);
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

  const double* change_by(const State& state) const {
    const auto k = static_cast<int>(state.k);
    return state.is_rate ? reduced_.alpha_w(k) : reduced_.alpha_z(k);
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

  /// Newton's method for alpha = 0 in the places z of the mechanism and the states of controllers.
  bool comes_to_rest() {
    if (reduced_.freedoms() == 0) return fail("its closures leave no degree of freedom");
    const auto f = static_cast<Index>(z_.size());
    if (reduced_.evaluate(0.0, z_.data(), w_.data()) != ReducedMotion<double>::Status::ok) {
      return fail("its equations of motion have no solution at the start");
    }
    double left = largest_acceleration();
    for (int step = 0; step < most_steps_to_rest; ++step) {
      reduced_.linearize();
      MatrixXd jacobian(f, f);
      for (Index k = 0; k < f; ++k) {
        const State unknown{static_cast<std::size_t>(k), unknown_is_rate_[static_cast<std::size_t>(k)] != 0, 1.0,
                            false};
        jacobian.col(k) = Eigen::Map<const VectorXd>(change_by(unknown), f);
      }
      const double size = std::max(jacobian.cwiseAbs().maxCoeff(), 1e-300);
      if (left <= at_rest_within * size) return true;
      const VectorXd alpha = Eigen::Map<const VectorXd>(reduced_.alpha(), f);
      VectorXd move = -solvers::minimum_norm_solution<double>(jacobian, alpha);
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
        return fail(
            "no equilibrium of it with its controllers is found from where it is assembled: an integral may have no "
            "effort that brings its error to zero, or a limit is in the way");
      }
      left = now;
    }
    return fail("Newton's method for the equilibrium with its controllers does not end");
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

  const Controller& law_of(int element) const { return *controller_of(model_.mechanism().law_of(element)); }
  double effort_unit(int element) const {
    const bool turns = scene_.elements[static_cast<std::size_t>(element)].on.is_angle();
    return turns ? model_.scales().energy() : model_.scales().force;
  }
  double reading_unit(int element) const {
    const bool turns = scene_.elements[static_cast<std::size_t>(element)].feedback->reads.is_angle();
    return turns ? 1.0 : model_.scales().length;
  }
  ControlSignals<double> signals(int element) {
    return model_.mechanism().signals_of(element, pose_.data(), reduced_.v());
  }
  ControlSignals<double> signals_by(int element, const State& state) {
    const auto k = static_cast<int>(state.k);
    const std::vector<double> none(static_cast<std::size_t>(reduced_.coordinates()), 0.0);
    const double* const dq = state.is_rate ? none.data() : reduced_.B(k);
    const double* const dv = state.is_rate ? reduced_.B(k) : reduced_.v_z(k);
    return model_.mechanism().signals_along(element, pose_.data(), reduced_.v(), dq, dv);
  }
  /// The derivatives of what a controller does by its reference, or of the mechanism's accelerations by its effort.
  ControlOutputs<double> by_reference(int element) {
    const Controller& law = law_of(element);
    const unsigned below = law.given & ((1U << Controller::reference) - 1U);
    return law.respond_by(std::popcount(below), signals(element));
  }
  VectorXd by_effort(int element) {
    std::vector<double> slope(static_cast<std::size_t>(reduced_.coordinates()), 0.0);
    model_.mechanism().add_measure_gradient(element, pose_.data(), slope.data());
    VectorXd out(reduced_.freedoms());
    reduced_.respond(slope.data(), out.data());
    return out;
  }

  void add_controller(int element) {
    const Controller& law = law_of(element);
    const ControlSignals<double> in = signals(element);
    const ControlOutputs<double> out = law.respond(in);
    const double error = law.values[Controller::reference] - in.value;
    out_.controllers.push_back({element, in.value * reading_unit(element), out.effort * effort_unit(element),
                                out.effort != out.unlimited,
                                law.has(Controller::dead_band) && std::abs(error) < law.values[Controller::dead_band]});
  }

  std::vector<std::string> names_of(std::size_t count) const {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < count; ++k) {
      const State& state = states_[k];
      const int i = reduced_.independent()[state.k];
      const std::string& name = model_.layout().coordinates[static_cast<std::size_t>(i)].name;
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
    for (Index i = 0; i < n; ++i) {
      const State& row = states_[static_cast<std::size_t>(i)];
      for (Index j = 0; j < n; ++j) {
        const State& column = states_[static_cast<std::size_t>(j)];
        if (!row.is_rate) {
          loop.a(i, j) = column.is_rate && column.k == row.k ? 1.0 : 0.0;
        } else {
          loop.a(i, j) = change_by(column)[row.k] * row.unit / column.unit;
        }
      }
    }
    for (Index e = 0; e < m; ++e) {
      const int element = out_.controllers[static_cast<std::size_t>(e)].element;
      const double read = reading_unit(element), effort = effort_unit(element);
      const ControlOutputs<double> by = by_reference(element);
      const VectorXd push = by_effort(element);
      const Feedback& feedback = *scene_.elements[static_cast<std::size_t>(element)].feedback;
      loop.inputs.push_back(name_of(element) + ".reference");
      for (Index i = 0; i < n; ++i) {
        const State& row = states_[static_cast<std::size_t>(i)];
        if (!row.is_rate) continue;
        const int coordinate = reduced_.independent()[row.k];
        double change = push[static_cast<Index>(row.k)] * by.effort;
        if (is_state(feedback.integral, coordinate)) change += by.integral;
        if (is_state(feedback.filter, coordinate)) change += by.filtered;
        loop.b(i, e) = change * row.unit / read;
      }
      loop.outputs.push_back(name_of(element) + ".reads");
      for (Index j = 0; j < n; ++j) {
        const State& column = states_[static_cast<std::size_t>(j)];
        const ControlSignals<double> change = signals_by(element, column);
        loop.c(e, j) = change.value * read / column.unit;
        loop.c(m + e, j) = law_of(element).respond_along(signals(element), change).effort * effort / column.unit;
      }
      loop.d(m + e, e) = by.effort * effort / read;
    }
    for (const ControlAtRest& one : out_.controllers) loop.outputs.push_back(name_of(one.element) + ".effort");
  }

  bool is_state(int body, int coordinate) const {
    return body >= 0 && model_.layout().links[static_cast<std::size_t>(body)].frame == coordinate;
  }

  /// The mechanism alone: that of the closed loop less what the efforts do that follow its states.
  void open() {
    StateSpace& plant = out_.open;
    const auto n = static_cast<Index>(of_mechanism_);
    const auto m = static_cast<Index>(out_.controllers.size());
    plant.states = names_of(of_mechanism_);
    plant.a = out_.closed.a.topLeftCorner(n, n);
    plant.b = MatrixXd::Zero(n, m);
    plant.c = out_.closed.c.topLeftCorner(m, n);
    plant.d = MatrixXd::Zero(m, m);
    for (Index e = 0; e < m; ++e) {
      const int element = out_.controllers[static_cast<std::size_t>(e)].element;
      const VectorXd push = by_effort(element);
      for (Index i = 0; i < n; ++i) {
        const State& row = states_[static_cast<std::size_t>(i)];
        if (row.is_rate) plant.b(i, e) = push[static_cast<Index>(row.k)] * row.unit / effort_unit(element);
      }
      plant.a -= plant.b.col(e) * out_.closed.c.row(m + e).head(n);
      plant.inputs.push_back(name_of(element) + ".effort");
      plant.outputs.push_back(name_of(element) + ".reads");
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
  ControlLoop out_;
};

}  // namespace

ControlLoop control_loop(const MotionModel& model, const std::vector<double>& from) {
  return LoopAtRest(model, from).find();
}

}  // namespace poise
