#include "motion/states_along.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

#include "motion/motion_input.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {
namespace {

std::vector<int> all_coordinates(const Trajectory& path) {
  std::vector<int> out(static_cast<std::size_t>(path.coordinates));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

/// Whether some friction has forces that are not those of its law.
bool can_stick(const Scene& scene) {
  return std::any_of(scene.elements.begin(), scene.elements.end(), [](const Element& one) {
    const auto* const friction = std::get_if<DryFriction>(&one.law);
    return friction != nullptr && friction->width == 0.0;
  });
}

}  // namespace

/// The equations of motion at single states.
class StatesAlong::Equations {
 public:
  /// `start`: scaled coordinates at which the motion began.
  Equations(const MotionModel& model, const std::vector<double>& start)
      : reduced_(model.scaled_scene(), model.mechanism(), model.inertia()) {
    reduced_.set_inputs(model.scaled_scene(), scaled(inputs_of(model.scene()), model.scene(), model.scales()));
    reduced_.start_drives(start.data());
  }

  /// Sets the accelerations at the coordinates and rates of the state, of which the dependent ones are closed; false
  /// where they are not known.
  bool accelerate(double t, MovingState& state) {
    if (!(is_chosen_ && evaluate(t, state) && reduced_.pivot() > good_pivot)) {
      if (reduced_.choose(t, state.x.data(), true) != Evaluated::ok) return false;
      is_chosen_ = true;
      if (!evaluate(t, state) || reduced_.pivot() < least_pivot) return false;
    }
    state.x.assign(reduced_.q(), reduced_.q() + state.x.size());
    state.v.assign(reduced_.v(), reduced_.v() + state.v.size());
    state.a.assign(reduced_.a(), reduced_.a() + state.a.size());
    return true;
  }

 private:
  using Evaluated = ReducedMotion<double>::Status;
  /// Coordinates are chosen anew below the first; below the second accelerations are not well known.
  static constexpr double good_pivot = 0.05, least_pivot = 1e-3;

  bool evaluate(double t, const MovingState& state) {
    reduced_.expect(state.x.data());
    z_.clear();
    w_.clear();
    for (const int i : reduced_.independent()) {
      z_.push_back(state.x[static_cast<std::size_t>(i)]);
      w_.push_back(state.v[static_cast<std::size_t>(i)]);
    }
    return reduced_.evaluate(t, z_.data(), w_.data()) == Evaluated::ok;
  }

  ReducedMotion<double> reduced_;
  bool is_chosen_ = false;
  std::vector<double> z_, w_;
};

StatesAlong::~StatesAlong() = default;

StatesAlong::StatesAlong(const MotionModel& model, const Motion& motion)
    : model_(model),
      path_(motion.trajectory),
      reader_(path_, all_coordinates(path_)),
      at_(std::numeric_limits<double>::quiet_NaN()) {
  const auto n = static_cast<std::size_t>(path_.coordinates);
  reading_ = {std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t k = 0; k < path_.v.size(); k += n) {
    const auto first = path_.v.begin() + static_cast<std::ptrdiff_t>(k);
    for (const double one : model.from_si({first, first + path_.coordinates})) {
      fastest_ = std::max(fastest_, std::abs(one));
    }
  }
  if (can_stick(model.scene()) || !motion.touched.empty()) return;
  const std::vector<double> start(path_.q.begin(), path_.q.begin() + path_.coordinates);
  equations_ = std::make_unique<Equations>(model, model.from_si(start));
}

const StatesAlong::Reading& StatesAlong::read(double t) {
  if (t == at_) return reading_;
  at_ = t;
  reader_.at(t);
  for (std::size_t i = 0; i < reading_.q.size(); ++i) {
    reading_.q[i] = reader_.q(i);
    reading_.v[i] = reader_.v(i);
  }
  return reading_;
}

const MovingState& StatesAlong::at(double t) {
  read(t);
  std::vector<double> a(reading_.q.size());
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = reader_.a(i);
  state_ = {model_.from_si(reading_.q), model_.from_si(reading_.v), model_.from_si(std::move(a))};
  if (equations_) equations_->accelerate(t, state_);
  return state_;
}

}  // namespace poise
