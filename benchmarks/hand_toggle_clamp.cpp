#include "benchmarks/hand_toggle_clamp.hpp"

#include <algorithm>
#include <cmath>

namespace poise::benchmarks {
namespace {

constexpr double crank = 24.0, coupler = 36.0;                                                      // mm
constexpr double rear_x = -36.0, rear_y = 4.0;                                                      // B on the arm
constexpr double base_x = -36.0, base_y = -56.0;                                                    // C - A
constexpr double tip_x = 86.0, tip_y = -18.0;                                                       // T on the arm
constexpr double work_x = 86.0, work_y = -30.0;                                                     // W - A
constexpr double free_length = 14.0;                                                                // mm
constexpr double weight_handle = 0.28 * 9.81, weight_link = 0.06 * 9.81, weight_arm = 0.34 * 9.81;  // N
constexpr double over_centre = -6.0 * M_PI / 180.0;
constexpr double clamp_step_tolerance = 1e-9;
constexpr int most_clamp_steps = 50;

// Tip of rubber that presses only: its tension F, N, and its moment -F d' on the arm, with their derivatives.
struct Rubber {
  Rubber(double stiffness, double c, double s) {
    const double turned_x = tip_x * c - tip_y * s, turned_y = tip_x * s + tip_y * c;
    const double x = turned_x - work_x, y = turned_y - work_y;
    const double square = x * x + y * y;
    if (square >= free_length * free_length) return;
    const double length = std::sqrt(square);
    const double slope = (y * turned_x - x * turned_y) / length;
    const double reach = tip_x * tip_x + tip_y * tip_y;
    const double bend = (reach - x * turned_x - y * turned_y - slope * slope) / length;
    tension = stiffness * (length - free_length);
    tension_slope = stiffness * slope;
    moment = -tension * slope;
    moment_slope = -tension_slope * slope - tension * bend;
  }
  double tension = 0.0, tension_slope = 0.0, moment = 0.0, moment_slope = 0.0;
};

}  // namespace

HandToggleClampResult solve_toggle_clamp_by_hand(const std::array<double, 3>& start,
                                                 const HandToggleClampNumbers& numbers) {
  HandToggleClampResult result;
  double h = start[0], l = start[1], a = start[2];
  while (result.iterations < most_clamp_steps && !result.converged) {
    const double ch = std::cos(h), sh = std::sin(h);
    const double cl = std::cos(l), sl = std::sin(l);
    const double ca = std::cos(a), sa = std::sin(a);
    // Rows of the closure Jacobian; each x differentiates to -y, each y to x.
    const double xh = -crank * sh, xl = -coupler * sl, xa = rear_x * sa + rear_y * ca;
    const double yh = crank * ch, yl = coupler * cl, ya = -rear_x * ca + rear_y * sa;
    const double gap_x = yh + yl + ya + base_x;
    const double gap_y = -xh - xl - xa + base_y;
    const double nh = xl * ya - xa * yl, nl = xa * yh - xh * ya, na = xh * yl - xl * yh;

    const Rubber rubber(numbers.stiffness, ca, sa);
    const double lift_x = 40.0 * numbers.pull - 26.0 * weight_handle - crank * weight_link;
    const double lift_y = 118.0 * numbers.pull - 48.0 * weight_handle;
    const double qh = lift_x * ch - lift_y * sh, ql = -18.0 * weight_link * cl;
    const double qa = -weight_arm * (24.0 * ca + sa) + rubber.moment;
    const double work = nh * qh + nl * ql + na * qa;

    const double past = l - h - over_centre;
    const double moment = -work / (nl - nh);
    const bool held = past < 0.0 || (result.held && moment >= 0.0);
    double wh = -1.0, wl = 1.0, wa = 0.0, row = past;
    if (!held) {
      const double mla = xl * xa + yl * ya, mah = xa * xh + ya * yh, mhl = xh * xl + yh * yl;
      wh = ql * mah - qa * mhl - nh * (lift_x * sh + lift_y * ch);
      wl = qa * mhl - qh * mla + nl * 18.0 * weight_link * sl;
      wa = qh * mla - ql * mah + na * (weight_arm * (24.0 * sa - ca) + rubber.moment_slope);
      row = work;
    }

    // Cramer's rule by cross products of the rows.
    const double scale = -1.0 / (nh * wh + nl * wl + na * wa);
    const double dh = scale * (gap_x * (yl * wa - ya * wl) + gap_y * (wl * xa - wa * xl) + row * nh);
    const double dl = scale * (gap_x * (ya * wh - yh * wa) + gap_y * (wa * xh - wh * xa) + row * nl);
    const double da = scale * (gap_x * (yh * wl - yl * wh) + gap_y * (wh * xl - wl * xh) + row * na);
    h += dh;
    l += dl;
    a += da;
    ++result.iterations;
    result.converged =
        std::max({std::abs(dh), std::abs(dl), std::abs(da)}) <= clamp_step_tolerance && (!held || moment >= 0.0);
    result.held = held;
    result.clamping_force = -rubber.tension - rubber.tension_slope * da;
  }
  result.angles = {h, l, a};
  return result;
}

}  // namespace poise::benchmarks
