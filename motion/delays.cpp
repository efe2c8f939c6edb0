#include "motion/delays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

struct ValueAndSlope {
  double value = 0.0, slope = 0.0;
};

/// This is the sum  sum c_m T_m(x)  with its slope.
ValueAndSlope chebyshev_sum(const std::array<double, points_of_piece>& c, double x) {
  ValueAndSlope out;
  double t_before = 1.0, t = x, u_before = 0.0, u = 1.0;  // T_m-1, T_m, U_m-2, U_m-1
  out.value = c[0];
  for (int m = 1; m < points_of_piece; ++m) {
    const double by = c[static_cast<std::size_t>(m)];
    out.value += by * t;
    out.slope += by * m * u;
    const double t_next = 2 * x * t - t_before, u_next = 2 * x * u - u_before;
    t_before = t;
    t = t_next;
    u_before = u;
    u = u_next;
  }
  return out;
}

template <class P>
ValueAndSlope reading_of(const P& piece, std::size_t which, double s) {
  const double half = (piece.to - piece.from) / 2;
  ValueAndSlope out = chebyshev_sum(piece.coefficients[which], (s - piece.from) / half - 1.0);
  out.slope /= half;
  return out;
}

}  // namespace

Delays::Delays(const MotionModel& model) : model_(model) {
  const Scene& scene = model.scene();
  for (const int e : controllers_of(scene)) {
    const Element& element = scene.elements[static_cast<std::size_t>(e)];
    const Controller& law = *controller_of(element.law);
    if (!law.has(Controller::delay)) continue;
    const auto body = static_cast<std::size_t>(element.feedback->held[0]);
    all_.push_back({e, model.layout().links[body].frame, law.values[Controller::delay],
                    model.scaled_scene().bodies[body].inertia, 0.0});
  }
  pose_.resize(static_cast<std::size_t>(model.mechanism().pose_size()));
}

double Delays::shortest() const {
  double out = std::numeric_limits<double>::infinity();
  for (const Delayed& one : all_) out = std::min(out, one.delay);
  return out;
}

std::vector<double> Delays::delays() const {
  std::vector<double> out;
  for (const Delayed& one : all_) out.push_back(one.delay);
  return out;
}

void Delays::refuse_derivatives() const {
  for (const Delayed& one : all_) {
    const Element& element = model_.scene().elements[static_cast<std::size_t>(one.element)];
    throw InputError(fmt::format(
        "{}:{}: controller \"{}\".delay: derivatives of a motion with a delay are not known; expected a controller "
        "without it",
        model_.scene().file, element.line, element.name));
  }
}

double Delays::decided(const Delayed& one, const ReducedMotion<double>& motion) {
  const Mechanism<double>& m = model_.mechanism();
  m.place(motion.q(), pose_.data());
  const ForcesInTime<double> in_time = motion.forces_in_time();
  const Controller& law = *controller_of(law_in_time(m, in_time, one.element));
  return law.decide(m.signals_of(one.element, pose_.data(), motion.v(), in_time)).effort / law.effort_unit;
}

std::vector<Delays::Given> Delays::begin(const ReducedMotion<double>& motion) {
  std::vector<Given> out;
  for (Delayed& one : all_) {
    one.before = decided(one, motion);
    out.push_back({one.coordinate, one.before});
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
  if (k == 0) pieces_.push_back({from, to, std::vector<std::array<double, points>>(all_.size())});
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double u = decided(all_[i], motion);
    for (int m = 0; m < points; ++m) {
      const double weight = (m == 0 ? 1.0 : 2.0) / points * std::cos(m * angle_of_root(k));
      pieces_.back().coefficients[i][static_cast<std::size_t>(m)] += weight * u;
    }
  }
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
    const double u = piece == nullptr ? all_[i].before : reading_of(*piece, i, std::max(s, piece->from)).value;
    out.push_back({all_[i].coordinate, u});
  }
  return out;
}

const std::vector<TorquesOfPast::One>& Delays::at(double t, double near) const {
  torques_.clear();
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const Delayed& one = all_[i];
    const double s = t - one.delay;
    const Piece* piece = piece_at(s, near - one.delay);
    const double rate = piece == nullptr ? 0.0 : reading_of(*piece, i, s).slope;
    torques_.push_back({one.coordinate, one.inertia * rate});
  }
  return torques_;
}

}  // namespace poise
