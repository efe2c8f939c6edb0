#pragma once

// The linear programs of friction that holds.

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "model/scene.hpp"
#include "solvers/ball.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/friction/held.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

using solvers::Ball;

/// The equations of bodies cut free with friction, at one pose, in balls:
///
///   A u = -(load + q slope),   u = joint forces, pressures of stops and friction efforts,
///
/// and which of u the bounds of friction depend on. Teeth push their wheels apart by the size of their effort, a column
/// of its own: s = effort or s = -effort, one case each. Forces are measured in unit().
class FrictionProblem {
 public:
  FrictionProblem(const StaticModel& model, const std::vector<double>& x);

  /// What the bound of one that rubs depends on:  |f| <= constant + max over pieces, or, of a pin, + circle |R|.
  struct Source {
    int effort = 0;                            ///< column of f
    std::vector<std::pair<int, Ball>> pieces;  ///< column and factor: each counts with both signs
    int pin = -1;                              ///< first of two columns of R, or -1
    Ball circle, constant;
    /// A rope on a rim has columns whose sum is u, minus the tension before the pulley, and mu times the wrap; behind
    /// it the tension is -(u + f).  (e - 1) u - f <= 0,  (e - 1) u + e f <= 0  with e = exp(k mu w).
    std::vector<int> tension;
    Ball wrap;
    double si = 1.0;  ///< SI value of f = 1
  };

  /// Teeth that push their wheels apart: columns of their effort, and of its size.
  struct Teeth {
    int effort = 0, size = 0;
  };

  /// The part of the set that is looked at, per source, and behind these, by its sign, per teeth().
  struct Part {
    enum class Kind { open, piece, sector } kind = Kind::open;  ///< open: not bounded
    int piece = 0, sign = 1;
    Vec2 first{}, last{};  ///< directions of the force in a pin, turning counter-clockwise by at most a quarter turn
  };
  using Choice = std::vector<Part>;

  /// entries v <= bound. v = u, and q behind it.
  struct Row {
    std::vector<std::pair<int, Ball>> entries;
    Ball bound;
    int source = -1;        ///< of a row of friction
    int sign = 0;           ///< of f in it
    bool is_edge = false;   ///< of a sector
    bool has_slack = true;  ///< it may be satisfied by more: not f = 0
    int equation = 0;       ///< 1 and -1: two rows that are an equation together
  };

  enum class Side { inner, outer };
  /// Inner: rows that only points of the set satisfy. Outer: rows that all of its points in the part satisfy.
  std::vector<Row> rows(const Choice& choice, double factor, Side side) const;

  const std::vector<Source>& sources() const { return sources_; }
  const std::vector<Teeth>& teeth() const { return teeth_; }
  /// Cases that make up the whole set: all sources open, teeth with each sign.
  std::vector<Choice> whole() const;
  int columns() const { return columns_; }
  double unit() const { return unit_; }
  double q_unit() const { return q_unit_; }           ///< what q is measured in
  std::size_t rubbings() const { return rubbings_; }  ///< size of rubbing()
  /// Index of rubbing() of a source. One on a distance of zero, and one without a bound, are no sources.
  std::size_t rubbing_of(std::size_t source) const { return of_rubbing_[source]; }

  /// Load, and its change, from other numbers of the scene at the same places of the bodies, N.
  std::vector<Ball> load_of(const Scene& scene) const;
  /// Replaces the load; `keep_constants` false for directions, in which constants do not count.
  void set_load(std::vector<Ball> load, bool keep_constants = true);
  void set_slope(std::vector<Ball> slope);
  const std::vector<Ball>& load() const { return load_; }
  const std::vector<Ball>& slope() const { return slope_; }
  bool varies() const { return !slope_.empty(); }

  /// All that acts on the bodies, the ground too, at a point v: loads, elements, and the forces of all columns.
  std::vector<SourcedForce> forces_on_bodies(const Eigen::VectorXd& v) const;
  /// The bound of a source at factor 1 and |f|, in unit().
  double bound_at(std::size_t source, const Eigen::VectorXd& v) const;
  /// The part in which a point is: the piece that counts there, or the direction of the force in the pin.
  Choice choice_at(const Eigen::VectorXd& v) const;
  /// The parts that make up a part of a source; none where it cannot be divided.
  std::vector<Part> divided(std::size_t source, const Part& part) const;

  /// v = particular + basis w of the equations, in double, and what they leave, the largest of it `gap`.
  struct Solutions {
    Eigen::VectorXd particular;
    Eigen::MatrixXd basis;
    double gap = 0.0;
    Eigen::VectorXd residual;
  };
  const Solutions& solutions() const { return solutions_; }

  /// Proved: some u near the given one satisfies the equations (without slope) and all rows, where `strictly` those
  /// that have slack with some.
  bool proves_point(const Eigen::VectorXd& u, const std::vector<Row>& rows, bool strictly) const;
  /// Proved: no u with |u_j| <= most satisfies the equations (without slope) and all rows, by multipliers z of the rows
  /// (Farkas).
  bool proves_none(const Eigen::VectorXd& z, const std::vector<Row>& rows, double most) const;
  /// Proved by multipliers z: all u with |u_j| <= 1, A u = -s load, rows u <= s bounds for some s from 0 to 1 / most
  /// have sign u_column < 1.
  bool proves_below_one(int column, double sign, const Eigen::VectorXd& z, const std::vector<Row>& rows,
                        double most) const;
  Eigen::MatrixXd matrix() const { return middle_.leftCols(columns_); }  ///< A
  Eigen::VectorXd load_over_unit() const;

 private:
  class Assembly;
  void refresh();
  void add_rope_rows(std::size_t source, const Ball& factor, std::vector<Row>& out) const;
  static void add_teeth_rows(const Teeth& teeth, int sign, std::vector<Row>& out);
  static Vec2 inner_direction(const Part& part);
  static Vec2 outer_direction(const Part& part);
  struct Combined {
    std::vector<Ball> residual;
    Ball value;
  };
  Combined combined(const Eigen::VectorXd& target, const Eigen::VectorXd& z, const std::vector<Row>& rows) const;

  const StaticModel& model_;
  std::vector<double> x_;
  std::vector<PlacedBody<Ball>> bodies_;
  std::vector<std::vector<Ball>> a_;                // rows of A
  std::vector<std::vector<SourcedForce>> actions_;  // of a unit of each column, N, on all bodies
  int columns_ = 0;
  std::vector<Source> sources_;
  std::vector<Teeth> teeth_;
  std::vector<std::pair<int, int>> pressures_;  // column of a stop and the sign that it may have
  std::vector<Ball> load_, slope_;
  double unit_ = 1.0, q_unit_ = 1.0;
  Eigen::MatrixXd middle_;  ///< of A, and of the slope behind it
  std::vector<std::size_t> of_rubbing_;
  std::size_t rubbings_ = 0;
  bool constants_count_ = true;
  Solutions solutions_;
};

}  // namespace poise
