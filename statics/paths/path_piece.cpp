#include "statics/paths/path_piece.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/readings.hpp"
#include "statics/model/rounding.hpp"
#include "statics/paths/varied_mechanism.hpp"

namespace poise {

PathPiece piece_at(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active_stops) {
  const Mechanism<double>& m = model.mechanism();
  PathPiece out;
  out.side.assign(m.stops(), 0);
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> c(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), c.data());
  for (int s = 0; s < m.stops(); ++s) {
    const double value = c[m.stop_row(s)];
    const bool both = m.lower()[s] == m.upper()[s];
    if (!both && std::find(active_stops.begin(), active_stops.end(), s) == active_stops.end()) continue;
    out.side[s] = both || std::abs(m.upper()[s] - value) < std::abs(value - m.lower()[s]) ? 1 : -1;
  }
  const Readings readings = read_off(model, x);
  for (const int e : VariedMechanism::one_way_springs(model.scene())) {
    out.acts.push_back(readings.elements[e].slack ? 0 : 1);
  }
  return out;
}

std::vector<int> active_stops(const PathPiece& piece, bool is_driven) {
  std::vector<int> out;
  const std::size_t stops = piece.side.size() - (is_driven ? 1 : 0);
  for (std::size_t s = 0; s < stops; ++s) {
    if (piece.side[s] != 0) out.push_back(static_cast<int>(s));
  }
  return out;
}

std::vector<int> slack_springs(const PathPiece& piece, const std::vector<int>& one_way) {
  std::vector<int> out;
  for (std::size_t k = 0; k < one_way.size(); ++k) {
    if (piece.acts[k] == 0) out.push_back(one_way[k]);
  }
  return out;
}

std::vector<int> independent_closures(const Mechanism<double>& m, const std::vector<double>& x) {
  std::vector<int> rows(m.equalities());
  for (int r = 0; r < m.equalities(); ++r) rows[r] = r;
  if (rows.empty() || m.equalities() > solvers::Curve::spectrum_limit) return rows;
  const DensePoint<double> point(m, x, rows);
  if (point.jacobian.size() == 0 || point.jacobian.cwiseAbs().maxCoeff() <= rounding_of_closures) return {};
  const auto [rank, order] = solvers::pivot_order<double>(point.jacobian.transpose(), solvers::known_to::closed_point);
  rows.assign(order.begin(), order.begin() + rank);
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::vector<solvers::ActiveRow> active_rows(const PathPiece& piece, const std::vector<int>& equalities, int closures) {
  std::vector<solvers::ActiveRow> out;
  for (const int row : equalities) out.push_back({.row = row});
  for (std::size_t s = 0; s < piece.side.size(); ++s) {
    if (piece.side[s] != 0) out.push_back({.row = closures + static_cast<int>(s), .upper = piece.side[s] > 0});
  }
  return out;
}

}  // namespace poise
