#include "motion/delays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/input_error.hpp"

namespace poise {
namespace {

// Times that differ by less, over the later one, are one.
constexpr double one_time = 1e-12;

constexpr int points_of_piece = Delays::points;

/// The angle of a root of the Chebyshev polynomial.
double angle_of_root(int k) { return M_PI * (2 * k + 1) / (2.0 * points_of_piece); }

struct Reading {
  double value = 0.0, slope = 0.0, bend = 0.0;  // the last one is the second derivative
};

using Coefficients = std::array<double, points_of_piece>;

/// This is the sum  sum c_m T_m(x)  with its derivatives.
Reading chebyshev_sum(const Coefficients& c, double x) {
  Reading out, before{1.0, 0.0, 0.0}, t{x, 1.0, 0.0};  // T_m-1, T_m
  out.value = c[0];
  for (int m = 1; m < points_of_piece; ++m) {
    const double by = c[static_cast<std::size_t>(m)];
    out.value += by * t.value;
    out.slope += by * t.slope;
    out.bend += by * t.bend;
    const Reading next{2 * x * t.value - before.value, 2 * (t.value + x * t.slope) - before.slope,
                       2 * (2 * t.slope + x * t.bend) - before.bend};
    before = t;
    t = next;
  }
  return out;
}

/// This is the same over the times `from` to `to`.
Reading reading_of(const Coefficients& c, double from, double to, double s) {
  const double half = (to - from) / 2;
  Reading out = chebyshev_sum(c, (s - from) / half - 1.0);
  out.slope /= half;
  out.bend /= half * half;
  return out;
}

/// Whether what a controller decides depends on what one with a delay gives.
bool is_behind_delay(const Scene& scene, int controller, std::set<int>& seen) {
  if (!seen.insert(controller).second) return false;
  const Feedback& feedback = *scene.elements[static_cast<std::size_t>(controller)].feedback;
  const int setting = feedback.reads_force < 0 ? -1 : controller_that_sets(scene, feedback.reads_force);
  const std::array<int, 3> all{feedback.follows, feedback.reads_from, setting};
  return std::any_of(all.begin(), all.end(), [&](int before) {
    return before >= 0 &&
           (controller_of(scene.elements[static_cast<std::size_t>(before)].law)->has(Controller::delay) ||
            is_behind_delay(scene, before, seen));
  });
}

/// Adds the value at the k-th root.
void add_value(Coefficients& c, int k, double value) {
  for (int m = 0; m < points_of_piece; ++m) {
    const double weight = (m == 0 ? 1.0 : 2.0) / points_of_piece * std::cos(m * angle_of_root(k));
    c[static_cast<std::size_t>(m)] += weight * value;
  }
}

}  // namespace

Delays::Delays(const MotionModel& model, const MotionOptions& options)
    : model_(model), options_(options), decisions_(model, options.variations, options.influences) {
  const Scene& scene = model.scene();
  for (const int e : controllers_of(scene)) {
    const Element& element = scene.elements[static_cast<std::size_t>(e)];
    const Controller& law = *controller_of(element.law);
    if (!law.has(Controller::delay)) continue;
    const auto body = static_cast<std::size_t>(element.feedback->held[0]);
    all_.push_back({.element = e,
                    .coordinate = model.layout().links[body].frame,
                    .delay = law.values[Controller::delay],
                    .inertia = model.scaled_scene().bodies[body].inertia});
    elements_.push_back(e);
    std::set<int> seen;
    are_chained_ = are_chained_ || is_behind_delay(scene, e, seen);
  }
  pose_.resize(static_cast<std::size_t>(model.mechanism().pose_size()));
}

double Delays::shortest() const {
  double out = std::numeric_limits<double>::infinity();
  for (const Delayed& one : all_) out = std::min(out, one.delay);
  return out;
}

bool Delays::gives(int coordinate) const {
  return std::any_of(all_.begin(), all_.end(), [&](const Delayed& one) { return one.coordinate == coordinate; });
}

std::vector<double> Delays::delays() const {
  std::vector<double> out;
  for (const Delayed& one : all_) out.push_back(one.delay);
  return out;
}

void Delays::refuse_mixed(std::size_t k) const {
  const Scene& scene = model_.scene();
  const Element& element = scene.elements[static_cast<std::size_t>(elements_[k])];
  throw InputError(fmt::format(
      "{}:{}: controller \"{}\".delay: the derivative of a motion by delays is not known where what comes back behind "
      "several of them meets; expected another number, or another delay",
      scene.file, element.line, element.name));
}

double Delays::delay_by(std::size_t k, std::size_t column) const {
  if (influence_of_[column] < 0) return 0.0;
  const Influence& influence = options_.influences[static_cast<std::size_t>(influence_of_[column])];
  const int element = all_[k].element;
  if (influence.variation >= 0) {
    const VariedModel& varied = options_.variations[static_cast<std::size_t>(influence.variation)].compiled();
    return controller_of(varied.mechanism().law_of(element))->values[Controller::delay].v[0];
  }
  const ForceNumber& number = influence.force;
  if (influence.moves() || influence.body >= 0 || number.of != ForceNumber::Of::element || number.item != element) {
    return 0.0;
  }
  const std::span<const Number> all = numbers_of(model_.scene().elements[static_cast<std::size_t>(element)].law);
  return all[static_cast<std::size_t>(number.number)].key == "delay" ? influence.by : 0.0;
}

void Delays::refuse_derivatives(bool has_events) const {
  if (!act()) return;
  const Scene& scene = model_.scene();
  const Element& element = scene.elements[static_cast<std::size_t>(elements_.front())];
  const auto refuse = [&](std::string_view what, std::string_view expected) {
    throw InputError(
        fmt::format("{}:{}: controller \"{}\".delay: derivatives of a motion with a delay {} are not "
                    "known; expected {}",
                    scene.file, element.line, element.name, what, expected));
  };
  if (has_events) {
    refuse("and with stops or friction that sticks", "a scene without one of them, or friction of some width");
  }
  for (const Influence& influence : options_.influences) {
    const auto refuse_times = [&](const TimeFunction& function, int number, double) {
      if (!function.is_smooth_in(number)) refuse("by the time of a step", "another number");
    };
    influence.for_each_function(scene, refuse_times);
    influence.for_each_function_of_drives(scene, refuse_times);
  }
}

double Delays::decided(const Delayed& one, const ReducedMotion<double>& motion) {
  const Mechanism<double>& m = model_.mechanism();
  m.place(motion.q(), pose_.data());
  const ForcesInTime<double> in_time = motion.forces_in_time();
  const Controller& law = *controller_of(law_in_time(m, in_time, one.element));
  return law.decide(m.signals_of(one.element, pose_.data(), motion.v(), in_time)).effort / law.effort_unit;
}

std::vector<double> Delays::decided_by(ReducedMotion<double>& motion, double t, const Column& column) {
  std::vector<double> out(all_.size());
  decisions_.change(motion, t, elements_, column.dq, column.dv, influence_of_[column.index],
                    [&](std::size_t k, const Decisions::Decided& decided, std::vector<double>&, std::vector<double>&) {
                      out[k] = decided.by[0];
                    });
  return out;
}

std::vector<Delays::Given> Delays::begin(const ReducedMotion<double>& motion) {
  std::vector<Given> out;
  for (Delayed& one : all_) {
    one.before = decided(one, motion);
    out.push_back({one.coordinate, one.before});
  }
  return out;
}

std::vector<Delays::Given> Delays::begin_by(ReducedMotion<double>& motion, const Column& column) {
  const std::vector<double> decided = decided_by(motion, 0.0, column);
  std::vector<Given> out;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    all_[i].before_by.resize(columns());
    all_[i].before_by[column.index] = decided[i];
    out.push_back({all_[i].coordinate, decided[i]});
  }
  return out;
}

std::array<double, Delays::points> Delays::times_within(double from, double to) {
  std::array<double, points> out{};
  for (int k = 0; k < points; ++k) {
    out[static_cast<std::size_t>(k)] = (from + to) / 2 + (to - from) / 2 * std::cos(angle_of_root(k));
  }
  return out;
}

void Delays::keep(double from, double to, int k, const ReducedMotion<double>& motion) {
  if (k == 0) {
    pieces_.push_back(
        {from, to, std::vector<Coefficients>(all_.size()), std::vector<Coefficients>(all_.size() * columns())});
  }
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double u = decided(all_[i], motion);
    all_[i].largest = std::max(all_[i].largest, std::abs(u));
    add_value(pieces_.back().coefficients[i], k, u);
  }
}

void Delays::keep_by(int k, ReducedMotion<double>& motion, const Column& column) {
  Piece& piece = pieces_.back();
  const double t = times_within(piece.from, piece.to)[static_cast<std::size_t>(k)];
  const std::vector<double> decided = decided_by(motion, t, column);
  for (std::size_t i = 0; i < all_.size(); ++i) add_value(piece.by[place_of(i, column.index)], k, decided[i]);
}

// Between two pieces the side counts on which `near` is.
const Delays::Piece* Delays::piece_at(double s, double near) const {
  if (pieces_.empty()) return nullptr;
  const auto later = [](double time, const Piece& piece) { return time < piece.from; };
  const auto above = std::upper_bound(pieces_.begin(), pieces_.end(), s, later);
  const double apart = one_time * pieces_.back().to;
  const Piece* next = above == pieces_.end() ? nullptr : &*above;
  const Piece* here = above == pieces_.begin() ? nullptr : &*(above - 1);
  if (here != nullptr && s - here->from <= apart && near < here->from) {
    return above - 1 == pieces_.begin() ? nullptr : &*(above - 2);
  }
  if (next != nullptr && next->from - s <= apart && near > next->from) return next;
  return here;
}

std::vector<Delays::Given> Delays::just_behind(double t, double apart) const {
  std::vector<Given> out;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double s = t - all_[i].delay;
    const Piece* piece = piece_at(s, s + apart);
    const double u = piece == nullptr
                         ? all_[i].before
                         : reading_of(piece->coefficients[i], piece->from, piece->to, std::max(s, piece->from)).value;
    out.push_back({all_[i].coordinate, u});
  }
  return out;
}

bool Delays::jump_at(double t, double apart) const {
  constexpr double value_within = 1e-9, slope_within = 1e-6;  // of u, over a delay
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double s = t - all_[i].delay;
    const auto read = [&](double near) {
      const Piece* piece = piece_at(s, near);
      if (piece == nullptr) return Reading{all_[i].before, 0.0, 0.0};
      return reading_of(piece->coefficients[i], piece->from, piece->to, std::clamp(s, piece->from, piece->to));
    };
    const Reading before = read(s - apart), behind = read(s + apart);
    if (std::abs(behind.value - before.value) > value_within * all_[i].largest ||
        std::abs(behind.slope - before.slope) * all_[i].delay > slope_within * all_[i].largest) {
      return true;
    }
  }
  return false;
}

std::vector<Delays::Given> Delays::just_behind_by(double t, double apart, std::size_t column) const {
  std::vector<Given> out;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double s = t - all_[i].delay;
    const Piece* piece = piece_at(s, s + apart);
    double by = piece == nullptr ? all_[i].before_by[column] : 0.0;
    if (piece != nullptr) {
      const auto read = [&](const Coefficients& c) {
        return reading_of(c, piece->from, piece->to, std::max(s, piece->from));
      };
      by = read(piece->by[place_of(i, column)]).value - read(piece->coefficients[i]).slope * delay_by(i, column);
    }
    out.push_back({all_[i].coordinate, by});
  }
  return out;
}

const std::vector<TorquesOfPast::One>& Delays::at(double t, double near) const {
  torques_.clear();
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const Delayed& one = all_[i];
    const double s = t - one.delay;
    const Piece* piece = piece_at(s, near - one.delay);
    const double rate = piece == nullptr ? 0.0 : reading_of(piece->coefficients[i], piece->from, piece->to, s).slope;
    torques_.push_back({one.coordinate, one.inertia * rate});
  }
  return torques_;
}

const std::vector<TorquesOfPast::Change>& Delays::changes_at(double t, double near) const {
  changes_.resize(all_.size());
  for (std::size_t i = 0; i < all_.size(); ++i) {
    Change& change = changes_[i];
    change.coordinate = all_[i].coordinate;
    change.by.assign(columns(), 0.0);
    const double s = t - all_[i].delay;
    const Piece* piece = piece_at(s, near - all_[i].delay);
    if (piece == nullptr) continue;
    const double bend = reading_of(piece->coefficients[i], piece->from, piece->to, s).bend;
    for (std::size_t c = 0; c < columns(); ++c) {
      const Coefficients& by = piece->by[place_of(i, c)];
      change.by[c] = reading_of(by, piece->from, piece->to, s).slope - bend * delay_by(i, c);
    }
  }
  return changes_;
}

}  // namespace poise
