#include "statics/paths/private/path_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "statics/model/curvature.hpp"
#include "statics/paths/private/tracing_steps.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double farthest_turn = 100.0;   // rad, of a mechanism that has not run away
constexpr double farthest_travel = 20.0;  // mechanism sizes, the same
constexpr double taken_apart = 1e-9;      // gap of joints that repeat others

}  // namespace

PathPieces::PathPieces(const VariedScene& varied)
    : varied_(varied), one_way_(VariedMechanism::one_way_springs(varied.scene())) {}

PathPieces::~PathPieces() = default;

int PathPieces::evaluations() const {
  int sum = 0;
  for (const auto& [piece, curve] : curves_) sum += curve->evaluations();
  return sum;
}

double PathPieces::value_at(double p) const {
  const double value = varied_.value_at(p);
  return std::abs(value) <= 0x1p-51 * std::max(std::abs(varied_.from()), std::abs(varied_.to())) ? 0.0 : value;
}

solvers::Curve& PathPieces::curve(const PathPiece& piece) {
  std::unique_ptr<solvers::Curve>& made = curves_[piece];
  if (made) return *made;
  std::unique_ptr<VariedMechanism>& mechanism = mechanisms_[piece.acts];
  if (!mechanism) mechanism = std::make_unique<VariedMechanism>(varied_, piece.acts);
  made = std::make_unique<solvers::Curve>(*mechanism, active_rows(piece, equalities_, mechanism->equalities()));
  return *made;
}

PathSpot PathPieces::guess(const std::vector<double>& x, double p, const std::vector<int>& active_stops) {
  const auto model = varied_.model_at(value_at(p));
  const Mechanism<double>& m = model->mechanism();
  angles_ = m.layout().angles;
  if (equalities_.empty()) equalities_ = independent_closures(m, x);
  has_left_out_ = static_cast<int>(equalities_.size()) < m.equalities();
  PathSpot out;
  out.piece = piece_at(*model, x, active_stops);
  std::vector<int> rows;
  for (const solvers::ActiveRow& active : active_rows(out.piece, equalities_, m.equalities())) {
    rows.push_back(active.row);
  }
  solvers::Curve& system = curve(out.piece);
  VectorXd& z = out.point.z;
  z.resize(system.unknowns());
  z.head(m.coordinates()) = VectorXd::Map(x.data(), m.coordinates());
  if (m.coordinates() <= solvers::Curve::spectrum_limit) {
    const DensePoint<double> point(m, x, rows);
    z.segment(m.coordinates(), static_cast<Index>(rows.size())) = point.multipliers();
  } else {
    z.segment(m.coordinates(), static_cast<Index>(rows.size())).setZero();
  }
  z[z.size() - 1] = p;
  return out;
}

std::optional<PathSpot> PathPieces::spot(const std::vector<double>& x, double p, const std::vector<int>& active_stops,
                                         double direction) {
  PathSpot out = guess(x, p, active_stops);
  solvers::Curve& system = curve(out.piece);
  VectorXd& z = out.point.z;
  const VectorXd along = direction * VectorXd::Unit(z.size(), z.size() - 1);
  // At a fold the parameter cannot be held: the point is there already.
  if (!system.correct(z, along).converged || !system.differentiate_at(out.point, along)) return std::nullopt;
  system.estimate_bend(out.point);
  out.negative = system.negative_directions(z);
  return out;
}

std::optional<std::vector<double>> PathPieces::deflated(const std::vector<double>& x, double p,
                                                        const std::vector<PathSpot>& known, int steps) {
  PathSpot out = guess(x, p, {});
  std::vector<VectorXd> places;
  for (const PathSpot& spot : known) places.push_back(spot.point.z);
  if (!curve(out.piece).deflate(out.point.z, places, steps)) return std::nullopt;
  return report(out).x;
}

PathPoint PathPieces::report(const PathSpot& spot, bool critical) const {
  PathPoint out;
  if (critical) out.proof = PointProof::critical;
  const solvers::Curve& system = *curves_.at(spot.piece);
  out.parameter = value_at(spot.p());
  out.x.assign(spot.point.z.data(), spot.point.z.data() + system.variables());
  out.unstable_directions = std::max(0, spot.negative);
  out.stability = spot.negative > 0 ? Stability::unstable : spot.negative == 0 ? Stability::stable : Stability::unknown;
  // Loads that follow bodies may make it flutter.
  const int freedoms = system.variables() - static_cast<int>(system.active().size());
  if (!system.symmetric() && freedoms > 1 && out.stability == Stability::stable) out.stability = Stability::unknown;
  out.active_stops = active_stops(spot.piece, varied_.is_driven());
  out.slack_springs = slack_springs(spot.piece, one_way_);
  if (varied_.is_driven()) {
    // The last multiplier; a torque scales as work.
    const bool is_angle = varied_.scene().stops.back().on.is_angle();
    const double scale = is_angle ? varied_.scales().energy() : varied_.scales().force;
    out.effort = -spot.point.z[spot.point.z.size() - 2] * scale;
  }
  return out;
}

void PathPieces::watch(const PathSpot& spot, std::vector<Watched>& out) {
  const std::size_t stops = spot.piece.side.size();
  out.assign(2 * stops + one_way_.size(), {});
  if (out.empty()) return;
  solvers::Curve& system = curve(spot.piece);
  std::vector<solvers::Curve::Room> rooms;
  system.rooms(spot.point, rooms);
  // A distance passes its least value in a sharp bend, half its square does not: (g^2 - b^2) / 2 with the gap e = g - b
  // is e (2 g - e) / 2.
  const auto above = [](const solvers::Curve::Room& room, bool is_distance) {
    Watched w{room.lower, room.lower_rate, room.lower, room.lower_rate};
    if (is_distance) {
      w.smooth = 0.5 * room.lower * (2 * room.value - room.lower);
      w.smooth_rate = room.value * room.rate - (room.value - room.lower) * (room.rate - room.lower_rate);
    }
    return w;
  };
  const auto below = [](const solvers::Curve::Room& room, bool is_distance) {
    Watched w{room.upper, room.upper_rate, room.upper, room.upper_rate};
    if (is_distance && std::isfinite(room.upper)) {
      w.smooth = 0.5 * room.upper * (2 * room.value + room.upper);
      w.smooth_rate = (room.value + room.upper) * (room.rate + room.upper_rate) - room.value * room.rate;
    }
    return w;
  };
  Index y = system.variables() + static_cast<Index>(equalities_.size());
  for (std::size_t s = 0; s < stops; ++s) {
    const signed char side = spot.piece.side[s];
    const bool is_distance = varied_.scene().stops[s].on.kind == Measure::Kind::distance;
    if (side != 0) {
      const bool both = rooms[s].lower + rooms[s].upper == 0.0 || (varied_.is_driven() && s + 1 == stops);
      const double push = side * spot.point.z[y], rate = side * spot.point.tangent[y];
      if (!both) out[2 * s + (side > 0 ? 1 : 0)] = {push, rate, push, rate};
      ++y;
      continue;
    }
    out[2 * s] = above(rooms[s], is_distance);
    out[2 * s + 1] = below(rooms[s], is_distance);
  }
  for (std::size_t k = 0; k < one_way_.size(); ++k) {
    const Element& element = varied_.scene().elements[one_way_[k]];
    const auto& spring = std::get<LinearSpring>(element.law);
    const bool is_above = (spring.acts == LinearSpring::Acts::tension) == (spot.piece.acts[k] != 0);
    Watched w = above(rooms[stops + k], element.on.kind == Measure::Kind::distance);
    if (!is_above) w = {-w.value, -w.rate, -w.smooth, -w.smooth_rate};
    out[2 * stops + k] = w;
  }
}

VectorXd PathPieces::mapped(const VectorXd& z, const PathPiece& from_piece, const PathPiece& to_piece) {
  const solvers::Curve& from = curve(from_piece);
  const solvers::Curve& to = curve(to_piece);
  const Index n = from.variables();
  VectorXd out = VectorXd::Zero(to.unknowns());
  out.head(n) = z.head(n);
  out[out.size() - 1] = z[z.size() - 1];
  std::map<int, double> multiplier;
  for (std::size_t k = 0; k < from.active().size(); ++k) {
    multiplier[from.active()[k].row] = z[n + static_cast<Index>(k)];
  }
  for (std::size_t k = 0; k < to.active().size(); ++k) {
    const auto known = multiplier.find(to.active()[k].row);
    if (known != multiplier.end()) out[n + static_cast<Index>(k)] = known->second;
  }
  return out;
}

std::optional<PathSpot> PathPieces::switched(const PathSpot& spot, int watched) {
  const int stops = static_cast<int>(spot.piece.side.size());
  PathSpot out;
  out.piece = spot.piece;
  if (watched < 2 * stops) {
    signed char& side = out.piece.side[watched / 2];
    side = side != 0 ? 0 : watched % 2 == 0 ? -1 : 1;
  } else {
    out.piece.acts[watched - 2 * stops] ^= 1;
  }
  solvers::Curve& to = curve(out.piece);
  out.point.z = mapped(spot.point.z, spot.piece, out.piece);
  VectorXd like = mapped(spot.point.tangent, spot.piece, out.piece);
  if (to.unknowns() <= solvers::Curve::spectrum_limit) {
    const MatrixXd null = to.null_vectors(out.point.z, 1e-9, 1);
    if (null.cols() != 1 || !(to.norm(null.col(0)) > 1e-12)) return std::nullopt;
    like = null.col(0) / to.norm(null.col(0));
  }
  if (!to.differentiate_at(out.point, like)) return std::nullopt;
  to.estimate_bend(out.point);
  std::vector<Watched> beyond;
  // The row that was watched is watched from the other side now.
  watch(out, beyond);
  if (beyond[watched].rate < 0.0) out.reverse();
  out.negative = to.negative_directions(out.point.z);
  return out;
}

std::vector<double> PathPieces::unwound(const std::vector<double>& x, const std::vector<double>& near, Turns turns) {
  if (!somewhere_) somewhere_ = varied_.model_at(value_at(0.5));
  const Mechanism<double>& m = somewhere_->mechanism();
  std::vector<double> out = x;
  for (int k = 0; k < m.layout().angles; ++k) out[k] += 2 * M_PI * std::round((near[k] - x[k]) / (2 * M_PI));
  if (out == x) return out;
  const auto values_at = [&](const std::vector<double>& at) {
    std::vector<Planar<double>> pose(m.pose_size());
    VectorXd values(m.coordinates() + m.constraints());
    m.place(at.data(), pose.data());
    m.negative_force(at.data(), pose.data(), values.data());
    m.constraint(at.data(), pose.data(), values.data() + m.coordinates());
    if (turns == Turns::forces) values.tail(m.stops()).setZero();
    return values;
  };
  return (values_at(out) - values_at(x)).cwiseAbs().maxCoeff() < tracing::same_pose ? out : x;
}

bool PathPieces::depends(const PathSpot& spot) {
  solvers::Curve& system = curve(spot.piece);
  // Beside the spot: a load along a straight column changes nothing on it.
  VectorXd beside = spot.point.z;
  for (int i = 0; i < system.variables(); ++i) beside[i] += 0.1 * std::sin(1.0 + i);
  return system.depends_on_parameter(beside);
}

double PathPieces::heaviest_multiplier(const PathSpot& spot) {
  const solvers::Curve& system = curve(spot.piece);
  return system.active().empty()
             ? 0.0
             : spot.point.z.segment(system.variables(), spot.point.z.size() - system.variables() - 1)
                   .lpNorm<Eigen::Infinity>();
}

bool PathPieces::is_far(const PathSpot& spot) {
  const Index n = curve(spot.piece).variables();
  const auto largest = [](const auto& part) { return part.size() > 0 ? part.cwiseAbs().maxCoeff() : 0.0; };
  return largest(spot.point.z.head(angles_)) > farthest_turn ||
         largest(spot.point.z.segment(angles_, n - angles_)) > farthest_travel;
}

bool PathPieces::is_torn(const PathSpot& spot) {
  return has_left_out_ && curve(spot.piece).largest_left_out(spot.point.z) > taken_apart;
}

std::optional<PathSpot> PathPieces::at_parameter(const PathSpot& spot, double p) {
  solvers::Curve& system = curve(spot.piece);
  PathSpot out = spot;
  VectorXd& z = out.point.z;
  z[z.size() - 1] = p;
  const bool found = system.correct(z, VectorXd::Unit(z.size(), z.size() - 1)).converged &&
                     system.norm(z - spot.point.z) < tracing::same_point;
  return found ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace poise
