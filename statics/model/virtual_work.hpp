#pragma once

#include <memory>
#include <string>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise {

/// A stop that is taken to be touched.
struct TouchedLimit {
  int stop = 0;  ///< index into Scene::stops
  bool at_max = false;

  friend bool operator==(const TouchedLimit&, const TouchedLimit&) = default;
};

/// One scaled length in the unit of length of the scene.
double length_in_scene_units(const StaticModel& model);
/// Scaled coordinates in rad and the unit of length of the scene, and back.
std::vector<double> in_scene_units(const StaticModel& model, std::vector<double> scaled);
std::vector<double> in_scaled_units(const StaticModel& model, std::vector<double> x);

/// The equations of equilibrium of a mechanism as a square system for a root finder, with derivatives.
///
/// x are the coordinates: angles in rad, lengths in the unit of the scene (`length`). With
///   F(x) = dV/dx = -Q(x)   the generalised forces, reversed,
///   c(x) = 0               the m independent rows that hold: closures, couplings, and limits that are touched, g -
///   limit, J = dc/dx,  K(x, y) = dF/dx + sum_r y_r d2c_r/dx2,
/// and the coordinates parted into m dependent ones u and n - m independent ones v, chosen once, at the assembled
/// start, by pivoting J, the virtual work along the independent directions N = (-J_u^-1 J_v; 1) is
///   N^T F = F_v + J_v^T y,  y = -J_u^-T F_u,
/// so that with e(x) = (N^T F; c) an equilibrium is e(x) = 0, and
///   de/dx = (N^T K(x, y); J).
/// The same with the multipliers y as unknowns is  (F + J^T y; c) = 0  with the derivative  (K, J^T; J, 0).
///
/// Units are those of the scene: `force` length, for the work along angles per rad, `force` for that along lengths.
/// What needs J_u^-1 is not a number where J_u is singular. Matrices are dense, row by row. After construction nothing
/// allocates up to about a hundred coordinates. A workspace: one for each thread.
class VirtualWork {
 public:
  static constexpr int most_coordinates = 2000;  ///< for dense matrices

  /// Throws InputError if the mechanism cannot be assembled, has no degree of freedom, or is too large.
  VirtualWork(std::shared_ptr<const StaticModel> model, std::vector<TouchedLimit> touched);
  ~VirtualWork();

  const StaticModel& model() const { return *model_; }
  const std::vector<TouchedLimit>& touched() const { return touched_; }
  const std::vector<double>& start() const { return start_; }  ///< assembled, x
  int coordinates() const { return n_; }
  int rows() const { return static_cast<int>(rows_.size()); }  ///< m
  int freedoms() const { return n_ - rows(); }
  /// Indices of the independent coordinates, in the order of the equations; and of the dependent ones.
  const std::vector<int>& independent() const { return independent_; }
  const std::vector<int>& dependent() const { return dependent_; }
  /// Closure "A.x", "A.y" or stop of each row that holds.
  const std::vector<std::string>& row_names() const { return row_names_; }
  bool row_is_angle(int row) const { return row_is_angle_[static_cast<std::size_t>(row)] != 0; }
  /// Stops that may be touched or not: indices of Scene::stops.
  const std::vector<int>& stops() const { return stops_; }

  /// Goes to x, n values; all others are at the x given last.
  void place(const double* x);

  double energy();                      ///< V; not a number with follower loads
  void gradient(double* out) const;     ///< F, n
  void closures(double* out) const;     ///< c, m
  void closure_jacobian(double* out);   ///< J, m x n
  void stop_values(double* out) const;  ///< g of stops(), rad or length
  void stop_jacobian(double* out);      ///< stops() x n
  void multipliers(double* out);        ///< y = -J_u^-T F_u, m: force, or force length where the row is an angle
  void directions(double* out);         ///< N, n x (n - m)
  void equations(double* out);          ///< e, n
  void jacobian(double* out);           ///< de/dx, n x n
  /// K(x, y), n x n; without y that of zero multipliers, dF/dx.
  void hessian(const double* y, double* out);
  void equations_with(const double* y, double* out);  ///< (F + J^T y; c), n + m
  void jacobian_with(const double* y, double* out);   ///< (K, J^T; J, 0), (n + m) x (n + m)

 private:
  struct Matrices;
  void choose_rows(const std::vector<double>& scaled);
  void name_rows();
  void factor();
  void find_tangent(const double* scaled_multipliers);

  std::shared_ptr<const StaticModel> model_;
  std::vector<TouchedLimit> touched_;
  int n_ = 0;
  double length_ = 1.0;                           // one scaled length in the unit of the scene
  double work_ = 1.0;                             // the same of energies, in force times length
  std::vector<double> per_coordinate_, per_row_;  // unit of a coordinate, and of a row that holds
  std::vector<double> start_;
  std::vector<int> rows_;       // of the constraint vector
  std::vector<double> limits_;  // subtracted from these, scaled
  std::vector<char> row_is_angle_;
  std::vector<std::string> row_names_;
  std::vector<int> independent_, dependent_, stops_;
  solvers::Evaluation at_;
  std::vector<double> x_;  // as given
  std::vector<double> tangent_values_, all_multipliers_, scaled_y_;
  std::vector<int> place_of_row_, place_of_stop_;  // per constraint row: its place among those that hold, or -1
  bool is_factored_ = false;
  std::unique_ptr<Matrices> matrices_;
};

}  // namespace poise
