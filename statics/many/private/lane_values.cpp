#include "statics/many/private/lane_values.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

using Kind = SoughtQuantity::Kind;

constexpr double least_effort_pivot = 1e-9;    // of the first, below which efforts are not determined
constexpr double least_part_of_effort = 1e-3;  // of a pivot in the scene as it is
constexpr double largest_part = 0.1;           // of the largest entry, from which on a pivot may be chosen

bool is_known_zero(const Recorded& a) { return a.is_known() && a.value() == 0.0; }

/// Of those that have no pivots of their own.
bool can_be_recorded(const SoughtQuantity& of) {
  switch (of.kind) {
    case Kind::measure:
    case Kind::element_force:
    case Kind::element_rate:
    case Kind::energy:
    case Kind::stop_reaction:
    case Kind::reaction:
    case Kind::shaking:
    case Kind::number:
      return true;
    case Kind::sum:
    case Kind::difference:
    case Kind::product:
    case Kind::quotient:
      return std::all_of(of.of.begin(), of.of.end(), can_be_recorded);
    default:
      return false;
  }
}

bool needs_efforts(const SoughtQuantity& of) {
  return of.has(Kind::stop_reaction) || of.has(Kind::reaction) || of.has(Kind::shaking);
}

}  // namespace

LaneValues::LaneValues(const StaticModel& model, std::shared_ptr<const NumberList> list,
                       const std::vector<Recorded>& numbers, std::vector<ActingStop> acting)
    : model_(model), numbers_(numbers), equations_(std::move(list), std::move(acting)) {}

void LaneValues::place(const Mechanism<Recorded>& mechanism, const std::vector<Recorded>& x) {
  const std::vector<BodyPose<Recorded>> poses = mechanism.poses(x.data());
  z_.clear();
  for (std::size_t i = 1; i < equations_.scene().bodies.size(); ++i) {
    z_.insert(z_.end(), {poses[i].origin.x, poses[i].origin.y, poses[i].angle});
  }
  z_.resize(static_cast<std::size_t>(equations_.unknowns()));
}

void LaneValues::add_poses(std::vector<Recorded>& out) const {
  const Recorded length(model_.scales().length);
  for (int k = 0; k < equations_.poses(); ++k) {
    const Recorded& one = z_[static_cast<std::size_t>(k)];
    out.push_back(k % 3 == 2 ? one : one * length);
  }
}

// The efforts of joints and stops that balance what is applied: as many rows of the balance of bodies as there are
// efforts, the others follow in equilibrium.
bool LaneValues::find_efforts() {
  const auto places = static_cast<std::size_t>(equations_.poses());
  const std::size_t efforts = z_.size() - places;
  const auto& stops = equations_.scene().stops;
  for (const ActingStop& one : equations_.acting()) {
    if (loads_bearings(stops[static_cast<std::size_t>(one.stop)])) return false;
  }
  std::vector<NumberedEquations::Placed<Recorded>> placed;
  equations_.place(z_.data(), placed);
  const auto bodies = equations_.bodies(numbers_.data(), placed);
  std::vector<std::vector<Recorded>> rows(places, std::vector<Recorded>(efforts + 1));
  for (std::size_t k = 0; k < efforts; ++k) {
    const std::vector<Recorded> column = equations_.row_gradient(static_cast<int>(places + k), bodies, placed);
    for (std::size_t i = 0; i < places; ++i) rows[i][k] = column[i];
  }
  std::vector<Recorded> applied(places);
  equations_.push_applied(bodies, placed, applied.data());
  for (std::size_t i = 0; i < places; ++i) rows[i][efforts] = -applied[i];

  std::vector<char> column_used(efforts, 0);
  std::vector<std::size_t> pivot_column;
  double first = 0.0;
  for (std::size_t k = 0; k < efforts; ++k) {
    // The pivot is that of the large entries which has the fewest others in its row and column.
    double largest = 0.0;
    std::vector<int> in_row(places, 0), in_column(efforts, 0);
    for (std::size_t i = k; i < places; ++i) {
      for (std::size_t j = 0; j < efforts; ++j) {
        if (column_used[j] != 0 || is_known_zero(rows[i][j])) continue;
        largest = std::max(largest, std::abs(rows[i][j].value()));
        ++in_row[i];
        ++in_column[j];
      }
    }
    if (k == 0) first = largest;
    if (!(largest > least_effort_pivot * first)) return false;
    std::size_t row = k, column = 0;
    int fewest = -1;
    for (std::size_t i = k; i < places; ++i) {
      for (std::size_t j = 0; j < efforts; ++j) {
        if (column_used[j] != 0 || !(std::abs(rows[i][j].value()) >= largest_part * largest)) continue;
        const int others = (in_row[i] - 1) * (in_column[j] - 1);
        if (fewest >= 0 && others >= fewest) continue;
        fewest = others;
        row = i;
        column = j;
      }
    }
    std::swap(rows[k], rows[row]);
    column_used[column] = 1;
    pivot_column.push_back(column);
    const Recorded pivot = rows[k][column];
    good_ = good_ && abs(pivot) >= Recorded(least_part_of_effort * std::abs(pivot.value()));
    for (std::size_t i = k + 1; i < places; ++i) {
      if (is_known_zero(rows[i][column])) continue;
      const Recorded part = rows[i][column] / pivot;
      for (std::size_t j = 0; j <= efforts; ++j) {
        if (j == efforts || column_used[j] == 0) rows[i][j] -= part * rows[k][j];
      }
    }
  }
  for (std::size_t k = efforts; k-- > 0;) {
    Recorded sum = rows[k][efforts];
    for (std::size_t l = k + 1; l < efforts; ++l) sum -= rows[k][pivot_column[l]] * z_[places + pivot_column[l]];
    z_[places + pivot_column[k]] = sum / rows[k][pivot_column[k]];
  }
  return true;
}

std::vector<char> LaneValues::add(const std::vector<SoughtQuantity>& of, std::vector<Recorded>& out) {
  std::vector<char> has_value;
  std::optional<bool> has_efforts;
  for (const SoughtQuantity& one : of) {
    bool can = can_be_recorded(one);
    if (can && needs_efforts(one)) {
      if (!has_efforts) has_efforts = find_efforts();
      can = *has_efforts;
    }
    if (can) {
      QuantityPlace<Recorded> place(equations_, numbers_.data(), z_.data());
      const Recorded value = place.value(one);
      can = place.why().empty();
      if (can) out.push_back(value / Recorded(one.dimension.per_scale(model_.scales())));
    }
    has_value.push_back(can ? 1 : 0);
  }
  return has_value;
}

}  // namespace poise
