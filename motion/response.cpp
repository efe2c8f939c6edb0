#include "motion/response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/input_error.hpp"
#include "model/time_function.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using Kind = SoughtQuantity::Kind;

constexpr double infinite = std::numeric_limits<double>::infinity();
// Damping ratios below this are rounding of none.
constexpr double no_damping = 1e-12;
// Work of a force in a mode, or motion of a quantity, below this share of what it could be is none.
constexpr double no_part = 1e-9;
// Amplitudes below this share of those around are rounding of zero.
constexpr double no_amplitude = 1e-9;

/// A quantity in an equilibrium, with its derivatives by the small motions y, by their rates and by the number that
/// swings alone; SI.
struct Slope {
  double value = 0.0;
  VectorXd by_place, by_rate;
  double direct = 0.0;
};

class SlopeReader {
 public:
  SlopeReader(const MotionModel& model, const std::vector<double>& x, const SmallMotions& motions,
              const Excitation& excitation)
      : scene_(model.scene()),
        poses_(model.poses(x)),
        along_(motions_along(model, x, motions.basis)),
        excitation_(excitation) {}

  Slope read(const SoughtQuantity& of) const {
    Slope out{0.0, VectorXd::Zero(freedoms()), VectorXd::Zero(freedoms()), 0.0};
    switch (of.kind) {
      case Kind::measure:
        out.value = value_of(scene_, of.on, poses_);
        out.by_place = rates_of(of.on);
        return out;
      case Kind::element_force:
        return force_of(of.item);
      case Kind::number:
        out.value = of.constant;
        return out;
      case Kind::by_time: {
        Slope inner = read(of.of[0]);
        out.by_rate = std::move(inner.by_place);
        return out;
      }
      case Kind::sum:
        return combined(read(of.of[0]), 1.0, read(of.of[1]), 1.0, out);
      case Kind::difference:
        return combined(read(of.of[0]), 1.0, read(of.of[1]), -1.0, out);
      case Kind::product: {
        const Slope a = read(of.of[0]), b = read(of.of[1]);
        out = combined(a, b.value, b, a.value, std::move(out));
        out.value = a.value * b.value;
        return out;
      }
      case Kind::quotient: {
        const Slope a = read(of.of[0]), b = read(of.of[1]);
        if (b.value == 0.0) {
          throw InputError(of.name + ": it is divided by zero in the equilibrium; expected another quantity");
        }
        out = combined(a, 1 / b.value, b, -a.value / (b.value * b.value), std::move(out));
        out.value = a.value / b.value;
        return out;
      }
      default:
        throw InputError(of.name + ": its response is not known; expected another quantity");
    }
  }

 private:
  Index freedoms() const { return static_cast<Index>(along_.size()); }

  VectorXd rates_of(const Measure& on) const {
    VectorXd out(freedoms());
    for (Index k = 0; k < out.size(); ++k) out[k] = rate_of(scene_, along_[static_cast<std::size_t>(k)], on);
    return out;
  }

  Slope force_of(int item) const {
    const Element& element = scene_.elements[static_cast<std::size_t>(item)];
    if (const int setting = controller_that_sets(scene_, item); setting >= 0) {
      throw InputError(fmt::format(
          "force.{}: its response is not known, because controller \"{}\" sets a number of it; expected another "
          "quantity",
          element.name, scene_.elements[static_cast<std::size_t>(setting)].name));
    }
    const double g = value_of(scene_, element.on, poses_);
    const LawForce<double> at_rest = force_at_rest(element.law, g);
    const VectorXd rates = rates_of(element.on);
    Slope out{at_rest.value, at_rest.by_measure * rates, VectorXd::Zero(freedoms()), 0.0};
    if (damps_small_motion(element.law)) out.by_rate = force_of_motion(element.law, g, 0.0).by_rate * rates;
    if (!excitation_.is_load() && excitation_.number.item == item) {
      out.direct = force_by_number(element.law, excitation_.number.number, g, 0.0);
    }
    return out;
  }

  static Slope combined(const Slope& a, double by_a, const Slope& b, double by_b, Slope out) {
    out.value = by_a * a.value + by_b * b.value;
    out.by_place = by_a * a.by_place + by_b * b.by_place;
    out.by_rate = by_a * a.by_rate + by_b * b.by_rate;
    out.direct = by_a * a.direct + by_b * b.direct;
    return out;
  }

  const Scene& scene_;
  std::vector<BodyPose<double>> poses_;
  std::vector<std::vector<BodyMotion>> along_;
  const Excitation& excitation_;
};

bool has_response(const Scene& scene, const SoughtQuantity& of) {
  switch (of.kind) {
    case Kind::measure:
    case Kind::number:
      return true;
    case Kind::element_force: {
      const Law& law = scene.elements[static_cast<std::size_t>(of.item)].law;
      return stores_energy(law) || damps_small_motion(law);
    }
    case Kind::by_time:
      return of.of[0].kind != Kind::element_force && of.of[0].kind != Kind::by_time && has_response(scene, of.of[0]);
    case Kind::sum:
    case Kind::difference:
    case Kind::product:
    case Kind::quotient:
      return has_response(scene, of.of[0]) && has_response(scene, of.of[1]);
    default:
      return false;
  }
}

/// Each real pole and each pair is a mode, without its shape; as many poles as there are blades are theirs.
Modes modes_of_poles(std::vector<Complex> poles, std::size_t blades) {
  for (std::size_t b = 0; b < blades; ++b) {
    const auto own = std::find(poles.begin(), poles.end(), Complex{});
    if (own != poles.end()) poles.erase(own);
  }
  double largest = 0.0;
  for (const Complex& p : poles) largest = std::max(largest, std::abs(p));
  Modes out;
  out.known = true;
  for (const Complex& p : poles) {
    if (p.imag() < 0.0) continue;
    constexpr double no_growth = 1e-8;
    const bool grows = p.real() > no_growth * largest, turns = p.imag() > 0.0;
    const bool rests = std::abs(p) <= no_growth * largest;
    Vibration& mode = out.vibrations.emplace_back();
    mode.roots = {p, std::conj(p)};
    mode.growth = p.real();
    if (rests) {
      mode.kind = Vibration::Kind::neutral;
    } else if (turns) {
      mode.kind = grows ? Vibration::Kind::flutters : Vibration::Kind::oscillates;
      mode.frequency = std::abs(p) / (2 * M_PI);
      mode.damping_ratio = -p.real() / std::abs(p);
      mode.damped_frequency = p.imag() / (2 * M_PI);
    } else {
      mode.kind = grows ? Vibration::Kind::diverges : Vibration::Kind::decays;
    }
  }
  return out;
}

bool is_undamped_oscillation(const Vibration& mode) {
  return mode.kind == Vibration::Kind::oscillates && std::abs(mode.damping_ratio) <= no_damping;
}

}  // namespace

Excitation excitation_of(const Scene& scene, const std::string& path) {
  const ParameterRow row = parameter(scene, path);
  Excitation out{path, row.dimension, {}};
  out.number.item = row.place.item;
  out.number.number = row.place.number;
  const auto item = static_cast<std::size_t>(row.place.item);
  if (row.place.owner == Owner::force) {
    out.number.of = ForceNumber::Of::force;
    if (scene.forces[item].line_of_action() == Vec2{}) {
      throw InputError(fmt::format(
          "{}: a force of zero has no direction in which it could swing; expected one with direction and size", path));
    }
    return out;
  }
  if (row.place.owner == Owner::torque) {
    out.number.of = ForceNumber::Of::torque;
    return out;
  }
  if (row.place.owner == Owner::element && stores_energy(scene.elements[item].law)) return out;
  const bool is_reference = row.place.owner == Owner::element && scene.elements[item].feedback.has_value() &&
                            row.path.parts[3] == "reference";
  if (is_reference) return out;
  throw InputError(
      fmt::format("{}: nothing swings with it; expected a load (load.NAME), a number of a spring, say its free_length, "
                  "or the reference of a controller",
                  path));
}

Scene scene_at_rest(Scene scene) {
  for (Force& force : scene.forces) {
    const bool in_time =
        std::any_of(scene.time_functions.begin(), scene.time_functions.end(), [&](const TimeFunction& function) {
          return function.of == TimeFunction::Of::force &&
                 &scene.forces[static_cast<std::size_t>(function.item)] == &force;
        });
    if (in_time && !force.has_direction_of_its_own()) force.along = force.unit_or_zero();
  }
  return at_time(std::move(scene), 0.0);
}

void refuse_without_response(const Scene& scene, const SoughtQuantity& of) {
  if (has_response(scene, of)) return;
  throw InputError(of.name +
                   ": its response is not known; expected a place, an angle, a travel or a length, the force of a "
                   "spring or damper, the rate d(Q)/dt of such a place, or what is made of these");
}

FrequencyResponse::FrequencyResponse(const MotionModel& model, const std::vector<double>& x,
                                     const Excitation& excitation, const SoughtQuantity& of)
    : model_(model), motions_(small_motions(model, x)), modes_(modes_of(model, x)) {
  refuse_controllers(model.scene(), "frequency responses about an equilibrium of statics");
  force_ = -motions_.basis.transpose() * read(x, excitation, of);
  undamped_ = motions_.damping.isZero(0.0) && by_rate_.isZero(0.0);
}

FrequencyResponse::FrequencyResponse(const MotionModel& model, ControlLoop loop, const Excitation& excitation,
                                     const SoughtQuantity& of)
    : model_(model), loop_(std::move(loop)), modes_(modes_of_poles(loop_->poles, loop_->blade_force.size())) {
  const Scene& scene = model.scene();
  for (const int e : controllers_of(scene)) {
    const Element& one = scene.elements[static_cast<std::size_t>(e)];
    if (!controller_of(one.law)->has(Controller::period)) continue;
    throw InputError(fmt::format(
        "{}:{}: controller \"{}\".period: frequency responses of samples are not known; expected a scene without it",
        scene.file, one.line, one.name));
  }
  motions_.basis = loop_->along;
  motions_.symmetric = false;
  push_ = -loop_->by_force * read(loop_->x, excitation, of);
  decided_ = decided_by(excitation);
  reads_ = VectorXd::Zero(loop_->system.a.rows());
  for (std::size_t k = 0; k < loop_->places.size(); ++k) {
    const auto at = static_cast<Index>(k);
    reads_[loop_->places[k]] = by_place_[at];
    reads_[loop_->rates[k]] = by_rate_[at];
  }
}

/// What controllers with delays decide at once, per unit of the number, SI.
VectorXd FrequencyResponse::decided_by(const Excitation& excitation) const {
  const Mechanism<double>& m = model_.mechanism();
  VectorXd out = VectorXd::Zero(static_cast<Index>(loop_->delayed.size()));
  if (excitation.is_load()) return out;
  std::vector<Planar<double>> pose(static_cast<std::size_t>(m.pose_size()));
  m.place(loop_->x.data(), pose.data());
  const ControlChange<double> change{.element = excitation.number.item,
                                     .number = excitation.number.number,
                                     .by = excitation.dimension.per_scale(model_.scales())};
  for (Index i = 0; i < out.size(); ++i) {
    const int element = loop_->delayed[static_cast<std::size_t>(i)].element;
    const Controller& law = *controller_of(m.law_of(element));
    const ControlSignals<double> in = m.signals_of(element, pose.data(), loop_->v.data());
    double effort = law.decide_along(in, m.signals_along(element, pose.data(), loop_->v.data(), change)).effort;
    if (change.element == element) effort += change.by * law.decide_by(change.number, in).effort;
    const Feedback& feedback = *model_.scene().elements[static_cast<std::size_t>(element)].feedback;
    out[i] = effort / feedback.output.per_scale(model_.scales());
  }
  return out;
}

/// Sets what is read of the quantity; the generalized force per unit of the number, against it, scaled.
VectorXd FrequencyResponse::read(const std::vector<double>& x, const Excitation& excitation, const SoughtQuantity& of) {
  Slope slope = SlopeReader(model_, x, motions_, excitation).read(of);
  at_rest_ = slope.value;
  by_place_ = std::move(slope.by_place);
  by_rate_ = std::move(slope.by_rate);
  direct_ = slope.direct;
  const Mechanism<double>& m = model_.mechanism();
  std::vector<Planar<double>> pose(static_cast<std::size_t>(m.pose_size()));
  m.place(x.data(), pose.data());
  const std::vector<double> v = loop_ ? loop_->v : std::vector<double>(x.size(), 0.0);
  VectorXd against = VectorXd::Zero(static_cast<Index>(x.size()));
  m.add_force_derivative(excitation.number, excitation.dimension.per_scale(model_.scales()), pose.data(), v.data(),
                         nullptr, against.data());
  return against;
}

VectorXcd FrequencyResponse::solve(double omega, const VectorXcd& right) const {
  const Index f = motions_.stiffness.rows();
  if (f == 0) return right;
  const MatrixXd real = motions_.stiffness - omega * omega * motions_.mass;
  if (motions_.damping.isZero(0.0)) {
    const solvers::FullyPivotedLu lu(real);
    VectorXcd out(f);
    out.real() = lu.solve(VectorXd(right.real()));
    out.imag() = lu.solve(VectorXd(right.imag()));
    return out;
  }
  MatrixXd both(2 * f, 2 * f);
  both << real, -omega * motions_.damping, omega * motions_.damping, real;
  VectorXd parts(2 * f);
  parts << right.real(), right.imag();
  const VectorXd found = solvers::FullyPivotedLu(both).solve(parts);
  VectorXcd out(f);
  out.real() = found.head(f);
  out.imag() = found.tail(f);
  return out;
}

// With z = s^2 M + s C + K and g, h as above:  y = z^-1 b,  y' = -z^-1 z' y,  by the angular frequency w, s = i w.
FrequencyResponse::ValueAndSlope FrequencyResponse::at_and_slope(double frequency) const {
  const double w = 2 * M_PI * frequency;
  const Complex s(0.0, w), i(0.0, 1.0);
  if (loop_) {
    const solvers::ForcedAnswer answer = solvers::forced_answer(loop_->system, s, push_, decided_);
    const Complex value = direct_ + answer.x.cwiseProduct(reads_.cast<Complex>()).sum();
    const Complex slope = i * answer.by_s.cwiseProduct(reads_.cast<Complex>()).sum();
    return {value, 4 * M_PI * (std::conj(value) * slope).real()};
  }
  const VectorXcd y = solve(w, force_.cast<Complex>());
  const VectorXcd change = (i * motions_.damping.cast<Complex>() - 2 * w * motions_.mass.cast<Complex>()) * y;
  const VectorXcd y_w = -solve(w, change);
  const VectorXcd reads = by_place_.cast<Complex>() + s * by_rate_.cast<Complex>();
  const Complex value = direct_ + reads.cwiseProduct(y).sum();
  const Complex slope = reads.cwiseProduct(y_w).sum() + i * by_rate_.cast<Complex>().cwiseProduct(y).sum();
  return {value, 4 * M_PI * (std::conj(value) * slope).real()};
}

Complex FrequencyResponse::at(double frequency) const {
  const bool drifts = std::any_of(modes_.vibrations.begin(), modes_.vibrations.end(),
                                  [](const Vibration& mode) { return mode.kind == Vibration::Kind::neutral; });
  if (frequency == 0.0 && drifts) return {std::numeric_limits<double>::quiet_NaN(), 0.0};
  return at_and_slope(frequency).value;
}

std::vector<Complex> FrequencyResponse::shape(double frequency) const {
  VectorXcd y;
  if (loop_) {
    const Complex s(0.0, 2 * M_PI * frequency);
    y = solvers::forced_answer(loop_->system, s, push_, decided_).x(loop_->places);
  } else {
    y = solve(2 * M_PI * frequency, force_.cast<Complex>());
  }
  const VectorXcd x = motions_.basis * y;
  std::vector<Complex> out(x.begin(), x.end());
  for (auto k = static_cast<std::size_t>(model_.layout().angles); k < out.size(); ++k) {
    out[k] *= model_.scales().length;
  }
  return out;
}

VectorXd FrequencyResponse::reduced_shape(const Vibration& mode) const {
  VectorXd x(static_cast<Index>(mode.shape.size()));
  for (Index k = 0; k < x.size(); ++k) {
    x[k] = mode.shape[static_cast<std::size_t>(k)].real() / (k < model_.layout().angles ? 1.0 : model_.scales().length);
  }
  return motions_.basis.transpose() * x;
}

FrequencyResponse::ModePart FrequencyResponse::part_of(const Vibration& mode) const {
  const VectorXd phi = reduced_shape(mode);
  const VectorXcd reads =
      by_place_.cast<Complex>() + Complex(0.0, 2 * M_PI * mode.frequency) * by_rate_.cast<Complex>();
  const double driven = phi.dot(force_), most_driven = phi.norm() * force_.norm();
  const Complex seen = reads.cwiseProduct(phi.cast<Complex>()).sum();
  const double most_seen = phi.norm() * reads.norm();
  return {driven * seen, most_driven * most_seen, std::abs(driven) > no_part * most_driven,
          std::abs(seen) > no_part * most_seen};
}

std::vector<SilentMode> FrequencyResponse::silent_modes() const {
  std::vector<SilentMode> out;
  if (!motions_.symmetric || !modes_.known) return out;
  std::vector<VectorXd> shapes;
  for (const Vibration& mode : modes_.vibrations) shapes.push_back(reduced_shape(mode));
  const double damping = motions_.damping.size() > 0 ? motions_.damping.cwiseAbs().maxCoeff() : 0.0;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    // Damping that couples it to others may drive and show it by them.
    const VectorXd damped = motions_.damping * shapes[k];
    const bool is_apart = std::all_of(shapes.begin(), shapes.end(), [&](const VectorXd& other) {
      return &other == &shapes[k] || std::abs(other.dot(damped)) <= no_part * damping * other.norm() * shapes[k].norm();
    });
    if (!is_apart) continue;
    const ModePart part = part_of(modes_.vibrations[k]);
    if (!part.is_driven || !part.is_seen) out.push_back({static_cast<int>(k), part.is_driven, part.is_seen});
  }
  return out;
}

// Undamped modes of one frequency count together: their residues may cancel.
std::vector<Resonance> FrequencyResponse::unbounded(double from, double to) const {
  std::vector<Resonance> out;
  if (!modes_.known) return out;
  const std::vector<Vibration>& all = modes_.vibrations;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!is_undamped_oscillation(all[k]) || !(all[k].frequency >= from && all[k].frequency <= to)) continue;
    if (!out.empty() && all[k].frequency - out.back().frequency < no_part * all[k].frequency) continue;
    Complex residue = 0.0;
    double size = 0.0;
    for (const Vibration& other : all) {
      if (loop_ || !is_undamped_oscillation(other)) continue;
      if (std::abs(other.frequency - all[k].frequency) > no_part * all[k].frequency) continue;
      const ModePart part = part_of(other);
      residue += part.residue;
      size += part.size;
    }
    const bool is_bounded = motions_.symmetric && std::abs(residue) <= no_part * size;
    if (is_bounded) continue;
    out.push_back({Resonance::Kind::unbounded, all[k].frequency, {infinite, 0.0}, static_cast<int>(k)});
  }
  return out;
}

std::vector<double> FrequencyResponse::frequencies(double from, double to, int count) {
  std::vector<double> out;
  for (int k = 0; k < count; ++k) out.push_back(from * std::pow(to / from, static_cast<double>(k) / (count - 1)));
  out.back() = to;
  return out;
}

// Close enough that every extreme has its own interval: a damped mode moves the response within a few widths
// 2 zeta f of its peak.
std::vector<double> FrequencyResponse::looked_at(double from, double to) const {
  constexpr int evenly = 400;
  constexpr double narrowest = 1e-6;
  std::vector<double> out = frequencies(from, to, evenly);
  for (const Vibration& mode : modes_.vibrations) {
    for (const double centre : {mode.frequency, mode.damped_frequency}) {
      if (!(centre > 0.0)) continue;
      out.push_back(centre);
      for (double away = std::max(mode.damping_ratio / 8, narrowest); away < 1.0; away *= 1.5) {
        out.push_back(centre * (1 - away));
        out.push_back(centre * (1 + away));
      }
    }
  }
  std::sort(out.begin(), out.end());
  std::erase_if(out, [&](double f) { return !(f >= from && f <= to); });
  return out;
}

// Roots of d|H|^2/df between neighbours; where H is real, also of H itself, at which the slope may round to nothing.
void FrequencyResponse::add_extremes(const std::vector<double>& frequencies, std::vector<Resonance>& out) const {
  constexpr double width = 1e-15;
  ValueAndSlope before = at_and_slope(frequencies.front());
  for (std::size_t k = 1; k < frequencies.size(); ++k) {
    const double low = frequencies[k - 1], high = frequencies[k];
    const ValueAndSlope after = at_and_slope(high);
    const ValueAndSlope start = std::exchange(before, after);
    const bool falls = start.slope > 0.0 && after.slope <= 0.0, rises = start.slope < 0.0 && after.slope >= 0.0;
    if (!falls && !rises) continue;
    const bool crosses = undamped_ && (start.value.real() > 0.0) != (after.value.real() > 0.0);
    const auto wanted = [&](const ValueAndSlope& at) { return crosses ? at.value.real() : at.slope; };
    const double size = std::max(std::abs(wanted(start)), std::abs(wanted(after)));
    const std::optional<double> root = solvers::root_by_secants(
        [&](double place) { return std::optional(wanted(at_and_slope(low + place * (high - low))) / size); },
        {0.0, 1.0}, wanted(start) / size, wanted(after) / size, width);
    if (!root) continue;
    Resonance found{falls ? Resonance::Kind::peak : Resonance::Kind::least, low + *root * (high - low)};
    found.value = at(found.frequency);
    const double around = std::max(std::abs(start.value), std::abs(after.value));
    if (rises && std::abs(found.value) <= no_amplitude * around) found.kind = Resonance::Kind::rest;
    if (falls) found.mode = nearest_mode(found.frequency);
    out.push_back(found);
  }
}

int FrequencyResponse::nearest_mode(double frequency) const {
  int out = -1;
  double least = infinite;
  for (std::size_t k = 0; k < modes_.vibrations.size(); ++k) {
    const Vibration& mode = modes_.vibrations[k];
    const bool vibrates = mode.kind == Vibration::Kind::oscillates || mode.kind == Vibration::Kind::flutters;
    const double away = std::abs(mode.damped_frequency - frequency);
    if (!vibrates || away >= least) continue;
    least = away;
    out = static_cast<int>(k);
  }
  return out;
}

std::vector<Resonance> FrequencyResponse::resonances(double from, double to) const {
  // Beside an undamped frequency by this share the response is as it is on this side.
  constexpr double beside = 1e-7;
  std::vector<Resonance> out = unbounded(from, to);
  const std::vector<Resonance> poles = out;
  double low = from;
  for (std::size_t k = 0; k <= poles.size(); ++k) {
    const double high = k < poles.size() ? poles[k].frequency * (1 - beside) : to;
    if (high > low) add_extremes(looked_at(low, high), out);
    if (k < poles.size()) low = poles[k].frequency * (1 + beside);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Resonance& a, const Resonance& b) { return a.frequency < b.frequency; });
  return out;
}

std::optional<solvers::Bracket> FrequencyResponse::usual_range() const {
  double lowest = infinite, highest = 0.0;
  for (const Vibration& mode : modes_.vibrations) {
    if (!(mode.frequency > 0.0)) continue;
    lowest = std::min(lowest, mode.frequency);
    highest = std::max(highest, mode.frequency);
  }
  if (highest == 0.0) return std::nullopt;
  return solvers::Bracket{lowest / 10, 3 * highest};
}

}  // namespace poise
