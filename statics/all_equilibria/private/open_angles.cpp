#include "statics/all_equilibria/private/open_angles.hpp"

#include <algorithm>
#include <variant>

#include <Eigen/LU>

namespace poise {
namespace {

// Encloses z with A z = b for all A, b of the intervals: with R near A^-1 and E = R A - I, |z - R b| <= |E| / (1 - |E|)
// |R b| in the maximum norm. False if that says nothing. A is row by row.
bool solve_linear(const std::vector<Interval>& a, const std::vector<Interval>& b, std::vector<Interval>& z) {
  const auto size = static_cast<Eigen::Index>(b.size());
  Eigen::MatrixXd middle(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) middle(i, j) = a[static_cast<std::size_t>(i * size + j)].middle();
  }
  const Eigen::MatrixXd inverse = middle.fullPivLu().inverse();
  if (!inverse.allFinite()) return false;
  double norm = 0.0;
  double most = 0.0;
  z.clear();
  for (Eigen::Index i = 0; i < size; ++i) {
    double sum = 0.0;
    Interval right(0);
    for (Eigen::Index j = 0; j < size; ++j) {
      Interval error(i == j ? -1 : 0);
      for (Eigen::Index l = 0; l < size; ++l)
        error += Interval(inverse(i, l)) * a[static_cast<std::size_t>(l * size + j)];
      sum += error.magnitude();
      right += Interval(inverse(i, j)) * b[static_cast<std::size_t>(j)];
    }
    if (!(sum < 1) || !right.bounded()) return false;
    norm = std::max(norm, sum);
    most = std::max(most, right.magnitude());
    z.push_back(right);
  }
  const double slack = (Interval(most) * Interval(norm) / (Interval(1) - Interval(norm))).upper();
  for (Interval& value : z) value += Interval(-slack, slack);
  return true;
}

}  // namespace

std::optional<AngleSprings> angle_springs(const StaticModel& model) {
  Scene springs = model.scaled_scene();
  std::erase_if(springs.elements, [](const Element& e) { return !is_sum_of_angles(e.on); });
  for (const Element& e : springs.elements) {
    const auto* spring = std::get_if<LinearSpring>(&e.law);
    if (stores_energy(e.law) && (spring == nullptr || spring->acts != LinearSpring::Acts::both)) return std::nullopt;
  }
  springs.gravity = {};
  springs.forces.clear();
  springs.torques.clear();
  const solvers::RoundingUp up;
  const Mechanism<Interval> mechanism(springs, model.layout(), Purpose::statics);
  const CoordinateBox zero(static_cast<std::size_t>(mechanism.coordinates()));
  std::vector<Planar<Interval>> pose(static_cast<std::size_t>(mechanism.pose_size()));
  const std::vector<Interval> none(static_cast<std::size_t>(mechanism.constraints()));
  AngleSprings out{std::vector<Interval>(zero.size()), mechanism.tangent_row(), mechanism.tangent_column(),
                   std::vector<Interval>(mechanism.tangent_row().size())};
  mechanism.place(zero.data(), pose.data());
  mechanism.negative_force(zero.data(), pose.data(), out.at_zero.data());
  mechanism.tangent(pose.data(), none.data(), out.stiffness.data());
  return out;
}

OpenAngles::OpenAngles(const StaticModel& model, const Turns& turns)
    : model_(model),
      mechanism_(model.scaled_scene(), model.layout(), Purpose::statics),
      springs_(angle_springs(model)) {
  for (int i = 0; i < model.layout().angles; ++i) {
    if (turns.count(i)) told_.push_back(i);
  }
  const solvers::RoundingUp up;
  const CoordinateBox zero(static_cast<std::size_t>(mechanism_.coordinates()));
  std::vector<Planar<Interval>> pose(static_cast<std::size_t>(mechanism_.pose_size()));
  at_zero_.resize(static_cast<std::size_t>(mechanism_.constraints()));
  jacobian_.resize(mechanism_.jacobian_row().size());
  mechanism_.place(zero.data(), pose.data());
  mechanism_.constraint(zero.data(), pose.data(), at_zero_.data());
  mechanism_.jacobian(pose.data(), jacobian_.data());
}

bool OpenAngles::bound(const std::vector<std::vector<StopState>>& cases, CoordinateBox& box) const {
  const solvers::RoundingUp up;
  CoordinateBox limited = box;
  const std::vector<int> unknown = limit_by_stops(limited);
  if (unknown.empty()) {
    box = std::move(limited);
    return true;
  }
  if (!springs_) return false;
  const std::vector<Interval> force = forces(limited);
  std::optional<CoordinateBox> all;
  for (const std::vector<StopState>& stops : cases) {
    CoordinateBox one = limited;
    if (!solve(stops, unknown, force, one)) return false;
    for (std::size_t i = 0; all && i < one.size(); ++i) one[i] = hull(one[i], (*all)[i]);
    all = std::move(one);
  }
  box = std::move(*all);
  return true;
}

std::vector<std::pair<int, Interval>> OpenAngles::row_of(int stop) const {
  std::vector<std::pair<int, Interval>> out;
  for (std::size_t e = 0; e < jacobian_.size(); ++e) {
    if (mechanism_.jacobian_row()[e] == mechanism_.stop_row(stop))
      out.emplace_back(mechanism_.jacobian_column()[e], jacobian_[e]);
  }
  return out;
}

std::vector<int> OpenAngles::limit_by_stops(CoordinateBox& box) const {
  std::vector<int> unknown = told_;
  for (int s = 0; s < mechanism_.stops(); ++s) {
    const std::vector<std::pair<int, Interval>> row = row_of(s);
    const Interval limits(mechanism_.lower()[s].lower(), mechanism_.upper()[s].upper());
    if (!is_on_angle(s) || row.size() != 1 || !limits.bounded()) continue;
    const auto [i, slope] = row.front();
    box[static_cast<std::size_t>(i)].meet((limits - at_zero_[static_cast<std::size_t>(mechanism_.stop_row(s))]) /
                                          slope);
    std::erase(unknown, i);
  }
  return unknown;
}

std::vector<Interval> OpenAngles::forces(const CoordinateBox& box) const {
  Scene others = model_.scaled_scene();
  std::erase_if(others.elements, [](const Element& e) { return is_sum_of_angles(e.on); });
  const Mechanism<Interval> load(others, model_.layout(), Purpose::statics);
  std::vector<Planar<Interval>> pose(static_cast<std::size_t>(load.pose_size()));
  std::vector<Interval> out(box.size());
  load.place(box.data(), pose.data());
  load.negative_force(box.data(), pose.data(), out.data());
  return out;
}

bool OpenAngles::solve(const std::vector<StopState>& stops, const std::vector<int>& unknown,
                       const std::vector<Interval>& force, CoordinateBox& box) const {
  std::vector<int> active;
  for (int s = 0; s < mechanism_.stops(); ++s) {
    const std::vector<std::pair<int, Interval>> row = row_of(s);
    const bool acts = std::any_of(row.begin(), row.end(), [&](const auto& entry) {
      return std::find(unknown.begin(), unknown.end(), entry.first) != unknown.end();
    });
    if (stops[static_cast<std::size_t>(s)] == StopState::inactive || !acts) continue;
    if (!is_on_angle(s)) return false;
    active.push_back(s);
  }
  const std::size_t angles = unknown.size();
  const std::size_t size = angles + active.size();
  std::vector<Interval> a(size * size, Interval(0));
  std::vector<Interval> b(size, Interval(0));
  const auto place = [&](int i) {
    return static_cast<std::size_t>(std::find(unknown.begin(), unknown.end(), i) - unknown.begin());
  };
  const auto add = [&](std::size_t row, int column, const Interval& value) {
    const std::size_t to = place(column);
    if (to < angles)
      a[row * size + to] += value;
    else
      b[row] -= value * box[static_cast<std::size_t>(column)];
  };
  for (std::size_t i = 0; i < angles; ++i) {
    const auto coordinate = static_cast<std::size_t>(unknown[i]);
    b[i] -= force[coordinate] + springs_->at_zero[coordinate];
  }
  for (std::size_t e = 0; e < springs_->stiffness.size(); ++e) {
    const int i = springs_->row[e];
    const int j = springs_->column[e];
    if (place(i) < angles) add(place(i), j, springs_->stiffness[e]);
    if (i != j && place(j) < angles) add(place(j), i, springs_->stiffness[e]);
  }
  for (std::size_t k = 0; k < active.size(); ++k) {
    const auto stop = static_cast<std::size_t>(active[k]);
    const auto& limit = stops[stop] == StopState::at_lower ? mechanism_.lower() : mechanism_.upper();
    b[angles + k] += limit[stop] - at_zero_[static_cast<std::size_t>(mechanism_.stop_row(active[k]))];
    for (const auto& [column, value] : row_of(active[k])) {
      add(angles + k, column, value);
      if (place(column) < angles) a[place(column) * size + angles + k] += value;
    }
  }
  std::vector<Interval> z;
  if (!solve_linear(a, b, z)) return false;
  for (std::size_t i = 0; i < angles; ++i) box[static_cast<std::size_t>(unknown[i])] = z[i];
  return true;
}

}  // namespace poise
