#include "benchmarks/contact_truth.hpp"

#include <cmath>
#include <functional>

#include <boost/math/quadrature/gauss.hpp>

namespace poise::benchmarks {
namespace {

/// One freedom q >= limit that gravity pulls towards its limit, where impacts multiply its speed by the same factor.
struct Falling {
  double from = 0.0, limit = 0.0, kept = 0.0;
  bool changes_sides = false;                  ///< each impact leads to the other side of a symmetric mechanism
  std::function<double(double)> mass;          ///< twice the kinetic energy over the square of the rate, at q
  std::function<double(double, double)> work;  ///< of gravity from q down to q less the second number
  std::function<double(double)> apex;          ///< q up to which a kinetic energy at the limit lifts it
};

Falling ball() {
  const BallSizes sizes;
  return {.from = sizes.height,
          .limit = 0.0,
          .kept = sizes.restitution,
          .mass = [](double) { return 1.0; },
          .work = [](double, double down) { return gravity * down; },
          .apex = [](double energy) { return energy / gravity; }};
}

// Angular momentum about the corner that is hit keeps 1 - 1.5 sin^2 alpha of the rate.
Falling block() {
  const BlockSizes sizes;
  const double alpha = sizes.steepest(), arm = sizes.arm();
  return {.from = sizes.part * alpha,
          .limit = 0.0,
          .kept = 1 - 1.5 * std::sin(alpha) * std::sin(alpha),
          .changes_sides = true,
          .mass = [arm](double) { return 4.0 / 3.0 * arm * arm; },
          .work = [=](double q,
                      double down) { return 2 * gravity * arm * std::sin(alpha - q + down / 2) * std::sin(down / 2); },
          .apex = [=](double energy) { return alpha - std::acos(std::cos(alpha) + energy / (gravity * arm)); }};
}

// The second rod is the mirror image of the first one, the ram twice as far as the elbow.
Falling toggle() {
  const ToggleSizes sizes;
  return {.from = sizes.from,
          .limit = sizes.stop,
          .kept = sizes.restitution,
          .mass = [](double q) { return 2.0 / 3.0 + 6.0 * std::sin(q) * std::sin(q); },
          .work = [](double q, double down) { return 2 * gravity * std::cos(q - down / 2) * std::sin(down / 2); },
          .apex = [=](double energy) { return std::asin(std::sin(sizes.stop) + energy / gravity); }};
}

// A flight as it leaves its apex at rest, in s with q = apex - s^2: in s the time is smooth at the apex.
class Flight {
 public:
  Flight(const Falling& of, double apex) : of_(of), apex_(apex) {}

  double to_limit() const { return std::sqrt(apex_ - of_.limit); }
  double time(double s) const {
    return boost::math::quadrature::gauss<double, 30>::integrate([&](double at) { return slowness(at); }, 0.0, s);
  }
  double speed(double s) const { return std::sqrt(2 * of_.work(apex_, s * s) / of_.mass(apex_ - s * s)); }
  ContactState state(double after) const {
    double s = to_limit() * std::abs(after) / time(to_limit());
    if (s > 0.0) {
      constexpr int enough = 20;
      for (int k = 0; k < enough; ++k) s -= (time(s) - std::abs(after)) / slowness(s);
    }
    return {apex_ - s * s, s > 0.0 ? -std::copysign(speed(s), after) : 0.0};
  }

 private:
  double slowness(double s) const { return 2 * s / speed(s); }

  const Falling& of_;
  double apex_;
};

// The state at a time; counts the impacts until then.
ContactState state_at(const Falling& falling, double time, int& impacts) {
  constexpr double at_rest = 1e-12;  // of the first speed
  const Flight first(falling, falling.from);
  double passed = first.time(first.to_limit());
  impacts = 0;
  if (time < passed) return first.state(time);
  const double mass = falling.mass(falling.limit), fastest = first.speed(first.to_limit());
  double side = 1.0;
  for (double rate = falling.kept * fastest; rate > at_rest * fastest; rate *= falling.kept) {
    ++impacts;
    if (falling.changes_sides) side = -side;
    const Flight flight(falling, falling.apex(mass * rate * rate / 2));
    const double half = flight.time(flight.to_limit());
    if (time < passed + 2 * half) {
      const ContactState there = flight.state(time - passed - half);
      return {side * there.place, side * there.rate};
    }
    passed += 2 * half;
  }
  return {falling.limit, 0.0};
}

}  // namespace

ContactTruth truth_of(const ContactProblem& problem) {
  const Falling falling = problem.scene == ContactScene::ball    ? ball()
                          : problem.scene == ContactScene::block ? block()
                                                                 : toggle();
  ContactTruth out;
  // The block begins on its right corner, where its angle is negative.
  const double side = falling.changes_sides ? -1.0 : 1.0;
  for (double time : problem.times) {
    const ContactState there = state_at(falling, time, out.impacts);
    out.states.push_back({side * there.place, side * there.rate});
  }
  const Flight first(falling, falling.from);
  out.travel = falling.from - falling.limit;
  out.speed = first.speed(first.to_limit());
  return out;
}

}  // namespace poise::benchmarks
