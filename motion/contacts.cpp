#include "motion/contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/blades.hpp"
#include "motion/private/quintic.hpp"
#include "statics/model/crossing_outlines.hpp"

namespace poise {
namespace {

using Reduced = ReducedMotion<double>;
using Dual = VariedModel::Dual;

constexpr double tiny = std::numeric_limits<double>::min();
/// Gaps below this, in sizes of the mechanism or rad, are zero: events are located more closely, and what rests against
/// a stop at the start less.
constexpr double no_gap = 1e-11, no_gap_at_start = 1e-9;
/// Rates below this part of the largest yet are zero, and below this part of the fastest coordinate's rounding.
constexpr double no_rate_of_gap = 1e-11, rounding_of_gap_rate = 1e-13;
/// Forces and accelerations below this part of the largest, or of their terms, may have either sign.
constexpr double sure = 1e-6;
/// Nothing moves a gap where freedoms change it by less than this part of the terms.
constexpr double unmoved = 1e-9;
/// So many sides may have no gap and no rate at a time.
constexpr std::size_t most_sides = 10;
/// Choices that agree are told apart after these parts of the time ahead.
constexpr double parts_of_time_ahead[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2};

constexpr int looked_at = 16;

/// Whether a gap is zero at this time.
bool is_closed(double gap, double t) { return gap < (t > 0.0 ? no_gap : no_gap_at_start); }

/// The first x at which it falls through zero by more than `past`; 0 if it does not.
double first_fall(const Quintic& p, double past) {
  if (p.is_positive()) return 0.0;
  const auto slope = [&](double x) { return p.slope(x); };
  double left = 0.0;
  for (int k = 1; k <= looked_at; ++k) {
    const double right = static_cast<double>(k) / looked_at;
    // Its lowest place between both may be the one that is below.
    double low = right;
    if (p.slope(left) < 0 && p.slope(right) > 0) low = Quintic::zero(slope, left, right);
    if (p.at(low) < -past) {
      double from = left;
      if (p.at(left) <= past && p.slope(left) > 0) from = Quintic::zero(slope, left, low);
      if (p.at(from) <= 0) return std::max(from, tiny);
      return Quintic::zero([&](double x) { return p.at(x); }, from, low);
    }
    left = right;
  }
  return 0.0;
}

/// Whether a measure is no polynomial of lengths.
bool is_curved(const Measure& on) {
  using Kind = Measure::Kind;
  return on.kind == Kind::distance || on.kind == Kind::rope || on.kind == Kind::clearance ||
         std::any_of(on.terms.begin(), on.terms.end(), [](const auto& term) { return is_curved(term.measure); });
}

/// What a place may pass by within a step: the shortest edge of an outline, or how thin it is, with the circle around
/// the point; the radius of an arc; the circle outside of which a distance is. Inside of a circle there is nothing.
double feature_of(const Scene& scene, const Stop& stop, const Touch& at) {
  double out = std::numeric_limits<double>::infinity();
  std::vector<Vec2> points;
  for (const PointRef& point : stop.on.outline.points) points.push_back(scene.local(point));
  if (points.size() < 2) return !at.upper && stop.min > 0.0 ? stop.min : out;
  const bool is_polygon = stop.on.outline.form == Outline::Form::polygon;
  for (std::size_t k = 0; k + 1 < points.size() && (is_polygon || k == 0); ++k) {
    out = std::min(out, norm(points[k + 1] - points[k]));
  }
  for (std::size_t k = 0; is_polygon && !stop.on.outline.backed && k < points.size(); ++k) {
    const Vec2 edge = points[(k + 1) % points.size()] - points[k];
    double farthest = 0.0;
    for (const Vec2& point : points) farthest = std::max(farthest, std::abs(cross(edge, point - points[k])));
    out = std::min(out, farthest / norm(edge));
  }
  return out + stop.min;
}

}  // namespace

Contacts::Contacts(const MotionModel& model, const std::vector<Variation>& variations)
    : model_(model), variations_(variations) {
  const Scene& scene = model.scaled_scene();
  const Phasors<double>& phasors = model.mechanism().phasors();
  int scratch = 0;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (stop.holds()) continue;
    for (const bool upper : {false, true}) {
      const double limit = upper ? stop.max : stop.min;
      if (!std::isfinite(limit)) continue;
      Side side{.at = {static_cast<int>(s), upper}, .on = {}, .varied = {}, .limit = limit};
      side.on = {scene, model.layout(), phasors, stop.on};
      scratch = std::max(scratch, side.on.scratch_size());
      for (const int i : side.on.support()) {
        if (i < model.layout().angles) angles_.push_back(i);
      }
      side.curved = is_curved(stop.on);
      side.feature = feature_of(scene, stop, side.at);
      are_curved_ = are_curved_ || side.curved;
      if (const int element = stop_friction_element(scene, side.at.stop); element >= 0) {
        const auto place = static_cast<std::size_t>(element);
        side.slip = {scene, model.layout(), phasors, scene.elements[place].on};
        scratch = std::max(scratch, side.slip->scratch_size());
        rubs_ = true;
        for (const Variation& variation : variations) {
          const VariedModel& varied = variation.compiled();
          side.varied_slip.push_back(varied.measure(varied.scene().elements[place].on));
        }
      }
      for (const Variation& variation : variations) {
        side.varied.push_back(variation.compiled().measure(variation.compiled().scene().stops[s].on, side.at.stop));
      }
      sides_.push_back(std::move(side));
      if (stop.impact_law) law_ = *stop.impact_law;
    }
  }
  std::sort(angles_.begin(), angles_.end());
  angles_.erase(std::unique(angles_.begin(), angles_.end()), angles_.end());
  pose_.resize(static_cast<std::size_t>(phasors.pose_size() + scratch));
}

const Stop& Contacts::stop_of(const Side& side) const {
  return model_.scaled_scene().stops[static_cast<std::size_t>(side.at.stop)];
}

std::string Contacts::name_of(const Touch& at) const {
  const Stop& stop = model_.scene().stops[static_cast<std::size_t>(at.stop)];
  const bool has_two = std::isfinite(stop.min) && std::isfinite(stop.max);
  return stop.title() + (!has_two ? "" : at.upper ? " (max)" : " (min)");
}

Configuration<double> Contacts::place(const double* q) {
  const Phasors<double>& phasors = model_.mechanism().phasors();
  phasors.place(q, pose_.data());
  return {phasors, pose_.data(), pose_.data() + phasors.pose_size()};
}

double Contacts::still(const Side& side, const std::vector<double>& v) {
  double fastest = 0.0;
  for (const double one : v) fastest = std::max(fastest, std::abs(one));
  return std::max(no_rate_of_gap * side.speed, rounding_of_gap_rate * fastest);
}

void Contacts::read_slope(const Side& side, const Configuration<double>& here, std::vector<double>& slope) {
  slope.clear();
  side.on.gradient(here, [&](int, double by) { slope.push_back(by); });
}

double Contacts::gap(const Side& side, const Configuration<double>& at) {
  return sign(side) * (side.on.value(at) - side.limit);
}

double Contacts::rate(const Side& side, const Configuration<double>& at, const double* v) {
  return sign(side) * side.on.along(at, v);
}

Contacts::Gap Contacts::gap_of(const Side& side, const Configuration<double>& here, const Reduced& motion) {
  const double second = side.on.along(here, motion.a()) + side.on.second(here, motion.v(), motion.v());
  return {gap(side, here), rate(side, here, motion.v()), sign(side) * second};
}

double Contacts::acceleration(std::size_t side, const Reduced& motion) {
  return gap_of(sides_[side], place(motion.q()), motion).acceleration;
}

void Contacts::refuse_start(const double* q, double within) {
  const Configuration<double> here = place(q);
  for (Side& side : sides_) {
    side.gap = gap(side, here);
    if (side.gap >= -std::max(within, no_gap_at_start)) continue;
    const Stop& stop = model_.scene().stops[static_cast<std::size_t>(side.at.stop)];
    const double unit = stop.on.is_angle() ? 1.0 : model_.scales().length;
    throw InputError(
        fmt::format("{}:{}: {}: the motion would begin {:.3g} {} beyond its {}; expected a start within "
                    "its limits, give another start or limit",
                    model_.scene().file, stop.line, name_of(side.at), -side.gap * unit,
                    stop.on.is_angle() ? "rad" : "m", side.at.upper ? "max" : "min"));
  }
  const std::vector<BodyPose<double>> poses = model_.poses({q, q + model_.mechanism().coordinates()});
  const double deep = std::max(within, no_gap_at_start) * model_.scales().length;
  if (const Stop* const crossed = crossing_outlines(model_.scene(), poses, deep)) {
    throw InputError(
        fmt::format("{}:{}: {}: the motion would begin where its outlines cross each other; expected a start in which "
                    "they are apart",
                    model_.scene().file, crossed->line, crossed->title()));
  }
}

void Contacts::watch(const Reduced& motion) {
  const Configuration<double> here = place(motion.q());
  for (Side& side : sides_) {
    const Gap now = gap_of(side, here, motion);
    side.gap = now.value;
    side.rate = now.rate;
    side.acceleration = now.acceleration;
    side.place = side.on.place(here);
    if (side.curved && side.touched) read_slope(side, here, side.slope);
    side.speed = std::max(side.speed, std::abs(now.rate));
  }
  for (std::size_t k = 0; k < motion.touching().size(); ++k) {
    strongest_ = std::max(strongest_, std::abs(motion.pushing_force(k)));
  }
}

double Contacts::force_margin(const Reduced& motion) {
  double least = std::numeric_limits<double>::infinity();
  least_ = none;
  for (std::size_t k = 0; k < motion.touching().size(); ++k) {
    const double force = motion.pushing_force(k);
    const double own = force / (std::max(strongest_, std::abs(force)) + tiny);
    if (!(own < least)) continue;
    least = own;
    least_ = static_cast<std::size_t>(
        std::find_if(sides_.begin(), sides_.end(), [&](const Side& side) { return side.at == motion.touching()[k]; }) -
        sides_.begin());
  }
  return least;
}

std::optional<Touch> Contacts::least() const {
  if (least_ == none) return std::nullopt;
  return sides_[least_].at;
}

double Contacts::first_hit(const Reduced& motion, double h) {
  double first = std::numeric_limits<double>::infinity();
  hit_ = none;
  constexpr double past = 1e-14;
  const Configuration<double> here = place(motion.q());
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    const Side& side = sides_[k];
    if (side.touched || side.idle) continue;
    const Gap end = gap_of(side, here, motion);
    const double x =
        first_fall({h, side.gap, side.rate, side.acceleration, end.value, end.rate, end.acceleration}, past);
    if (x == 0.0 || !(x < first)) continue;
    first = x;
    hit_ = k;
  }
  return hit_ == none ? 0.0 : first * h;
}

std::vector<Contacts::End> Contacts::ends(const Reduced& motion) {
  std::vector<End> out;
  const Configuration<double> here = place(motion.q());
  for (const Side& side : sides_) {
    const Gap now = gap_of(side, here, motion);
    out.push_back({now.value, now.rate, now.acceleration, side.on.place(here)});
    if (!side.curved || !side.touched || side.slope.empty()) continue;
    std::vector<double> slope;
    read_slope(side, here, slope);
    const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
      return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    };
    out.back().turned = product(slope, side.slope) / std::sqrt(product(slope, slope) * product(side.slope, side.slope));
  }
  return out;
}

bool Contacts::are_followed(const Reduced& motion, double h, const std::vector<End>& ends, bool turns) {
  constexpr double well = 1e-6, far = 30.0;
  // A way is longer than two chords of it.
  constexpr double longer = 1.5, part_of_feature = 0.25, least_turned = 0.9;
  const Configuration<double> here = place(motion.q());
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    const Side& side = sides_[k];
    const End& end = ends[k];
    if (side.touched && end.turned < least_turned) return false;
    if (side.touched || side.idle || !(side.curved || turns)) continue;
    if (side.place && end.place) {
      const Planar<double> middle = *side.on.place(here);
      const double way = longer * (norm(middle - *side.place) + norm(*end.place - middle));
      if (side.gap + end.gap > way) continue;
      if (way > part_of_feature * side.feature) return false;
    }
    const Quintic p{h, side.gap, side.rate, side.acceleration, end.gap, end.rate, end.acceleration};
    const double now = gap(side, here), off = std::abs(now - p.at(0.5));
    if (off > well && std::min({now, p.at(0.5), p.at(0.25), p.at(0.75)}) < far * off) return false;
  }
  return true;
}

Contacts::Miss Contacts::miss(const Reduced& motion) {
  const Gap now = gap_of(sides_[hit_], place(motion.q()), motion);
  return {now.value, -now.value / now.rate};
}

std::optional<Touch> Contacts::grazed(const Reduced& motion, double h, double within) {
  const Configuration<double> here = place(motion.q());
  for (const Side& side : sides_) {
    // What has just been hit, or has lifted off, leaves it with a rate of rounding.
    if (side.touched || side.idle || side.gap < no_gap) continue;
    const Gap end = gap_of(side, here, motion);
    if (!(side.rate < 0 && end.rate > 0)) continue;
    const Quintic p{h, side.gap, side.rate, side.acceleration, end.value, end.rate, end.acceleration};
    const double low = Quintic::zero([&](double x) { return p.slope(x); }, 0.0, 1.0);
    if (p.at(low) < within) return side.at;
  }
  return std::nullopt;
}

bool Contacts::is_moved(const Side& side, const Configuration<double>& here, const Reduced& motion) {
  std::vector<double> slope(static_cast<std::size_t>(motion.coordinates()), 0.0);
  side.on.add_gradient(here, 1.0, slope.data());
  if (motion.blades() > 0) {
    const Eigen::Map<const Eigen::VectorXd> whole(slope.data(), motion.coordinates());
    Eigen::VectorXd row(motion.freedoms());
    double terms = 0.0;
    for (int k = 0; k < motion.freedoms(); ++k) {
      const Eigen::Map<const Eigen::VectorXd> column(motion.B(k), motion.coordinates());
      row[k] = whole.dot(column);
      terms += whole.cwiseProduct(column).lpNorm<1>();
    }
    return left_by(blade_conditions(motion), row).norm() > unmoved * terms;
  }
  for (int k = 0; k < motion.freedoms(); ++k) {
    double change = 0.0, terms = 0.0;
    for (std::size_t i = 0; i < slope.size(); ++i) {
      change += slope[i] * motion.B(k)[i];
      terms += std::abs(slope[i] * motion.B(k)[i]);
    }
    if (std::abs(change) > unmoved * terms) return true;
  }
  return false;
}

/// Touches these sides, with nothing held by friction, at the coordinates q and rates v.
Reduced::Status Contacts::set(Reduced& motion, StickSlip* friction, double t, const std::vector<double>& q,
                              const std::vector<double>& v, const std::vector<std::size_t>& touched) {
  std::vector<Touch> touching;
  for (const std::size_t k : touched) touching.push_back(sides_[k].at);
  motion.set_touching(model_.scaled_scene(), std::move(touching));
  if (motion.sliding() != nullptr || (friction != nullptr && friction->acts())) {
    motion.set_sliding(model_.scaled_scene(), std::vector<int>(model_.scaled_scene().elements.size(), 1), q.data());
    motion.free_branches();
  }
  motion.choose(t, q.data(), false);
  motion.expect(q.data());
  std::vector<double> z, w;
  for (const int i : motion.independent()) {
    z.push_back(q[static_cast<std::size_t>(i)]);
    w.push_back(v[static_cast<std::size_t>(i)]);
  }
  return motion.evaluate(t, z.data(), w.data());
}

std::vector<double> Contacts::slopes_of(const std::vector<std::size_t>& sides,
                                        const Configuration<double>& here) const {
  const std::size_t m = sides.size(), n = static_cast<std::size_t>(model_.mechanism().phasors().coordinates());
  std::vector<double> out((rubs_ ? 2 * m : m) * n, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    const Side& side = sides_[sides[i]];
    side.on.add_gradient(here, sign(side), &out[i * n]);
    if (side.slip) side.slip->add_gradient(here, 1.0, &out[(m + i) * n]);
  }
  return out;
}

Contacts::Hit Contacts::hit(Reduced& motion, double t, const std::vector<double>& q, const std::vector<double>& v,
                            const std::vector<char>& plastic) {
  Hit out;
  const Reduced::Status status = set(motion, nullptr, t, q, v, {});
  const Configuration<double> here = place(motion.q());
  bool closes = false;
  double fastest = 0.0;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    const Side& side = sides_[k];
    if (!is_closed(gap(side, here), t)) continue;
    const double before = rate(side, here, v.data());
    if (before < -still(side, v) && (!closes || before < fastest)) {
      closes = true;
      fastest = before;
      out.first = k;
    }
    out.sides.push_back(k);
    const bool is_plastic = !plastic.empty() && plastic[k] != 0;
    out.before.push_back({before, is_plastic ? 0.0 : stop_of(side).rebound()});
    if (!side.slip) continue;
    out.before.back().friction = *stop_of(side).friction;
    out.before.back().slip = side.slip->along(here, v.data());
  }
  if (!closes) return out;
  if (status == Reduced::Status::blades) {
    out.outcome = Hit::Outcome::pushed;
    return out;
  }
  const std::size_t m = out.sides.size(), n = static_cast<std::size_t>(motion.coordinates());
  const auto f = static_cast<std::size_t>(motion.freedoms());
  for (std::size_t i = 0; i < m; ++i) {
    if (!(out.before[i].rate < 0.0) || is_moved(sides_[out.sides[i]], here, motion)) continue;
    out.first = out.sides[i];
    out.outcome = Hit::Outcome::pushed;
    return out;
  }
  const std::vector<double> slopes = slopes_of(out.sides, here);
  const std::size_t rows = slopes.size() / n;
  std::vector<double> along(rows * f), response(rows * f);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < f; ++j) {
      along[i * f + j] = std::inner_product(&slopes[i * n], &slopes[i * n] + n, motion.B(static_cast<int>(j)), 0.0);
    }
    motion.respond(&slopes[i * n], &response[i * f]);
  }
  Eigen::MatrixXd D(rows, rows);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < rows; ++j) {
      D(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          std::inner_product(&along[i * f], &along[i * f] + f, &response[j * f], 0.0);
    }
  }
  D = (D + D.transpose().eval()) / 2;
  out.impact = impact(D, out.before, law_);
  if (!out.impact.found) {
    out.outcome = Hit::Outcome::pushed;
    return out;
  }
  if (out.impact.gains) {
    out.outcome = Hit::Outcome::gains;
    return out;
  }
  // Made once more with the gaps that are pushed as rows, the jump gives all impulses.
  std::vector<std::size_t> active;
  std::vector<double> steps, rubbing(n, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; rubs_ && j < n; ++j) rubbing[j] += out.impact.rub[i] * slopes[(m + i) * n + j];
    if (!(out.impact.impulse[i] > 0.0)) continue;
    active.push_back(out.sides[i]);
    steps.push_back(sign(sides_[out.sides[i]]) * (out.impact.rate[i] - out.before[i].rate));
  }
  // A blade may hold what stops hold.
  if (set(motion, nullptr, t, q, v, active) == Reduced::Status::blades) {
    out.outcome = Hit::Outcome::pushed;
    return out;
  }
  motion.jump(steps.data(), rubbing.data());
  out.jump.assign(motion.a(), motion.a() + n);
  out.work = -out.impact.energy_lost + motion.drive_power();
  out.outcome = Hit::Outcome::done;
  return out;
}

// With the jumps a_j by unit impulses along the slopes w_j of gaps and slips the jump is  sum P_j a_j,  and
// D_ij = w_i a_j.  Both change with the slopes and with the a_j.
void Contacts::change_jump(Reduced& motion, const Hit& hit, double t, const std::vector<double>& q,
                           const std::vector<double>& v, const std::vector<JumpChange>& changes) {
  set(motion, nullptr, t, q, v, {});
  motion.set_variations(variations_);
  const Configuration<double> here = place(motion.q());
  const std::vector<double> slopes = slopes_of(hit.sides, here);
  const std::size_t m = hit.sides.size(), n = q.size(), rows = slopes.size() / n;
  const auto sum = [&](const double* w, const double* a) { return std::inner_product(w, w + n, a, 0.0); };
  // dw are the changes of slopes and da those of the jumps by unit impulses, by change and row.
  std::vector<std::vector<double>> dw, da(changes.size(), std::vector<double>(rows * n, 0.0));
  for (const JumpChange& change : changes) dw.push_back(slope_changes(hit.sides, here, motion.q(), change));
  std::vector<double> a(rows * n);
  for (std::size_t j = 0; j < rows; ++j) {
    motion.jump(nullptr, &slopes[j * n]);
    std::copy(motion.a(), motion.a() + n, &a[j * n]);
    motion.linearize();
    for (std::size_t c = 0; c < changes.size(); ++c) {
      motion.jump_change(changes[c].dq, nullptr, changes[c].influence, &da[c][j * n], &dw[c][j * n]);
    }
  }
  const auto r = static_cast<Eigen::Index>(rows);
  Eigen::MatrixXd D(r, r), change_of_d(r, r);
  for (std::size_t c = 0; c < changes.size(); ++c) {
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < rows; ++j) {
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        D(row, column) = sum(&slopes[i * n], &a[j * n]);
        change_of_d(row, column) = sum(&dw[c][i * n], &a[j * n]) + sum(&slopes[i * n], &da[c][j * n]);
      }
    }
    std::vector<ImpactSide> by(m);
    for (std::size_t i = 0; i < m; ++i) {
      const auto rate_by = [&](std::size_t row) {
        return sum(&dw[c][row * n], v.data()) + sum(&slopes[row * n], changes[c].dv);
      };
      by[i].rate = rate_by(i);
      if (rubs_) by[i].slip = rate_by(m + i);
      if (changes[c].influence == nullptr || changes[c].influence->variation < 0) continue;
      const auto& numbers = variations_[static_cast<std::size_t>(changes[c].influence->variation)].compiled().numbers();
      const int stop = sides_[hit.sides[i]].at.stop;
      if (hit.before[i].restitution > 0.0) by[i].restitution = numbers.restitution(stop).v[0];
      if (sides_[hit.sides[i]].slip) by[i].friction = numbers.stop_friction(stop).v[0];
    }
    const ImpulseChange impulses = impulse_change(D, change_of_d, hit.before, by, law_);
    std::fill(changes[c].jump, changes[c].jump + n, 0.0);
    const auto add = [&](std::size_t j, double impulse, double change) {
      for (std::size_t k = 0; k < n; ++k) changes[c].jump[k] += impulse * da[c][j * n + k] + change * a[j * n + k];
    };
    for (std::size_t i = 0; i < m; ++i) {
      add(i, hit.impact.impulse[i], impulses.impulse[i]);
      if (rubs_) add(m + i, hit.impact.rub[i], impulses.rub[i]);
    }
  }
}

std::vector<double> Contacts::slope_changes(const std::vector<std::size_t>& sides, const Configuration<double>& here,
                                            const double* q, const JumpChange& change) const {
  const std::size_t m = sides.size(), n = static_cast<std::size_t>(model_.mechanism().phasors().coordinates());
  std::vector<double> out((rubs_ ? 2 * m : m) * n, 0.0);
  const int variation = change.influence != nullptr ? change.influence->variation : -1;
  const auto add = [&](const CompiledMeasure<double>& on, const std::vector<CompiledMeasure<Dual>>& varied, double of,
                       double* to) {
    on.add_bend(here, change.dq, of, to);
    if (variation < 0) return;
    const auto which = static_cast<std::size_t>(variation);
    std::vector<Dual> unit(n, Dual(0));
    for (const int i : varied[which].support()) {
      const auto k = static_cast<std::size_t>(i);
      unit[k] = Dual(1);
      to[k] += of * variations_[which].compiled().derivative(
                        varied[which], q, [&](const auto& at) { return varied[which].along(at, unit.data()); });
      unit[k] = Dual(0);
    }
  };
  for (std::size_t i = 0; i < m; ++i) {
    const Side& side = sides_[sides[i]];
    add(side.on, side.varied, sign(side), &out[i * n]);
    if (side.slip) add(*side.slip, side.varied_slip, 1.0, &out[(m + i) * n]);
  }
  return out;
}

bool Contacts::is_near() const {
  return std::any_of(sides_.begin(), sides_.end(), [](const Side& side) { return side.gap < no_gap_at_start; });
}

double Contacts::hit_time_by(const Reduced& motion, std::size_t side_index, const double* v, const double* dq,
                             int variation) {
  const Side& side = sides_[side_index];
  const Configuration<double> here = place(motion.q());
  double change = side.on.along(here, dq);
  const double rate = side.on.along(here, v);
  if (variation >= 0) {
    const auto which = static_cast<std::size_t>(variation);
    const VariedModel& compiled = variations_[which].compiled();
    const CompiledMeasure<Dual>& on = side.varied[which];
    change += compiled.derivative(on, motion.q(), [&](const auto& at) { return on.value(at); });
    change -= compiled.numbers().limit(side.at.stop, side.at.upper).v[0];
  }
  return rate == 0.0 ? 0.0 : -change / rate;
}

/// The acceleration that a unit force on the gap of a side gives it, as `motion` is set.
double Contacts::mobility(const Side& side, const Configuration<double>& here, const Reduced& motion) {
  const auto n = static_cast<std::size_t>(motion.coordinates()), f = static_cast<std::size_t>(motion.freedoms());
  std::vector<double> slope(n, 0.0), dw(f);
  side.on.add_gradient(here, 1.0, slope.data());
  motion.respond(slope.data(), dw.data());
  double out = 0.0;
  for (std::size_t k = 0; k < f; ++k) {
    out += dw[k] * std::inner_product(slope.begin(), slope.end(), motion.B(static_cast<int>(k)), 0.0);
  }
  return out;
}

/// By how much forces of the touched ones, and accelerations of the gaps of the others, have the wrong sign, over the
/// largest force, and over what that would give and the terms of these; negative where all are right.
double Contacts::violation_of(const std::vector<std::size_t>& candidates, const std::vector<std::size_t>& touched,
                              const Reduced& motion) {
  double strongest = strongest_;
  for (std::size_t k = 0; k < touched.size(); ++k) strongest = std::max(strongest, std::abs(motion.pushing_force(k)));
  double worst = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < touched.size(); ++k) {
    worst = std::max(worst, -motion.pushing_force(k) / (strongest + tiny));
  }
  const Configuration<double> here = place(motion.q());
  for (const std::size_t k : candidates) {
    if (std::find(touched.begin(), touched.end(), k) != touched.end()) continue;
    const Side& side = sides_[k];
    double sum = side.on.second(here, motion.v(), motion.v()), terms = std::abs(sum);
    side.on.gradient(here, [&](int i, double by) {
      const double term = by * motion.a()[side.on.support()[static_cast<std::size_t>(i)]];
      sum += term;
      terms += std::abs(term);
    });
    worst = std::max(worst, -sign(side) * sum / (terms + strongest * mobility(side, here, motion) + tiny));
  }
  return worst;
}

StickSlip::Choice Contacts::choose(Reduced& motion, StickSlip& friction, double t, double ahead,
                                   const std::vector<double>& q, const std::vector<double>& v,
                                   std::optional<Touch> left) {
  if (!act()) return friction.choose(motion, t, ahead);
  std::vector<std::size_t> candidates;
  const Configuration<double> at = place(q.data());
  std::uint32_t first = 0;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    Side& side = sides_[k];
    side.idle = false;
    if (!is_closed(gap(side, at), t) || !(std::abs(rate(side, at, v.data())) <= still(side, v))) continue;
    if (!(left && *left == side.at)) first |= std::uint32_t{1} << candidates.size();
    candidates.push_back(k);
    if (candidates.size() > most_sides) return StickSlip::Choice::failed;
  }
  struct Trial {
    std::vector<std::size_t> touched;
    double violation;
    std::vector<double> acceleration;
  };
  const auto touched_of = [&](std::uint32_t mask) {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if ((mask >> i & 1U) != 0) out.push_back(candidates[i]);
    }
    return out;
  };
  // Whether those that surely agree have different accelerations.
  const auto differ = [](const std::vector<Trial>& all) {
    const Trial* one = nullptr;
    for (const Trial& trial : all) {
      if (!(trial.violation < -sure)) continue;
      if (one == nullptr) one = &trial;
      double apart = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < trial.acceleration.size(); ++i) {
        apart = std::max(apart, std::abs(trial.acceleration[i] - one->acceleration[i]));
        largest = std::max({largest, std::abs(trial.acceleration[i]), std::abs(one->acceleration[i])});
      }
      if (apart > sure * largest) return true;
    }
    return false;
  };
  StickSlip::Choice failure = StickSlip::Choice::none;
  const std::vector<int> branches = motion.branches();
  const auto attempt = [&](const std::vector<std::size_t>& touched) {
    const Reduced::Status status = set(motion, &friction, t, q, v, touched);
    motion.set_branches(branches);  // of which friction may let one turn
    if (!friction.acts()) return status == Reduced::Status::ok ? StickSlip::Choice::made : StickSlip::Choice::failed;
    return friction.choose(motion, t, ahead);
  };
  std::vector<Trial> trials;
  bool locks = false;
  const Trial* best = nullptr;
  const std::uint32_t count = std::uint32_t{1} << candidates.size();
  // With friction that grows with the forces of stops accelerations need not be unique: all choices are looked at.
  for (std::uint32_t k = 0; k < count && (best == nullptr || rubs_); ++k) {
    const std::uint32_t mask = k == 0 ? first : (k <= first ? k - 1 : k);
    std::vector<std::size_t> touched = touched_of(mask);
    const StickSlip::Choice made = attempt(touched);
    if (made != StickSlip::Choice::made) {
      failure = made;
      locks = locks || made == StickSlip::Choice::locked || made == StickSlip::Choice::several;
      continue;
    }
    const double violation = candidates.empty() ? -1.0 : violation_of(candidates, touched, motion);
    if (!(violation < sure)) continue;
    trials.push_back({std::move(touched), violation, {motion.a(), motion.a() + motion.coordinates()}});
    if (violation < -sure && !rubs_) best = &trials.back();
  }
  if (trials.empty()) return failure;
  // Forces that are not unique go on in another way than what else agrees.
  if (rubs_ && (locks || differ(trials))) return StickSlip::Choice::several;
  if (best == nullptr) {
    // Where several agree the one is taken that goes on agreeing.
    std::vector<const Trial*> agreeing;
    for (const Trial& trial : trials) agreeing.push_back(&trial);
    for (const double part : parts_of_time_ahead) {
      if (agreeing.size() == 1) break;
      std::vector<const Trial*> next;
      const Trial* least_wrong = agreeing.front();
      double least = std::numeric_limits<double>::infinity();
      for (const Trial* trial : agreeing) {
        if (attempt(trial->touched) != StickSlip::Choice::made) continue;
        if (friction.advance(motion, t, part * ahead) != Reduced::Status::ok) continue;
        const double worst = violation_of(candidates, trial->touched, motion);
        if (worst < no_rate_of_gap) next.push_back(trial);
        if (worst < least) {
          least = worst;
          least_wrong = trial;
        }
      }
      if (next.empty()) next.push_back(least_wrong);
      agreeing = std::move(next);
    }
    best = agreeing.front();
  }
  if (attempt(best->touched) != StickSlip::Choice::made) return StickSlip::Choice::failed;
  for (Side& side : sides_) side.touched = false;
  for (const std::size_t k : best->touched) sides_[k].touched = true;
  const Configuration<double> here = place(motion.q());
  for (const std::size_t k : candidates) {
    sides_[k].idle = !sides_[k].touched && !is_moved(sides_[k], here, motion);
  }
  return StickSlip::Choice::made;
}

}  // namespace poise
