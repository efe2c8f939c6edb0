#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "solvers/newton.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/static_model.hpp"
#include "statics/tracking/tracked_equilibrium.hpp"

namespace poise {

/// A mechanism that moves so that one of its points comes close to a place T, whatever acts on it: by steps along
///   minimise |P(x) - T|^2 / 2  on  c(x) = 0,  stops kept,
/// so short that none leads to another branch of the way.
class DraggedPoint {
 public:
  /// From where the scene starts, loops closed.
  DraggedPoint(Scene scene, PointRef point, const std::atomic<bool>* interrupt = nullptr);

  /// Counts the freedoms of the mechanism without its stops.
  int freedoms() const { return static_cast<int>(motions({}).basis.cols()); }
  /// The directions in which the point can move, m in the world: none, that of its way, or both axes.
  std::vector<Vec2> directions() const;
  BodyPoses poses() const { return model_.poses(x_); }
  Vec2 place() const { return model_.scales().length * place_; }
  /// The stop that it is held up by, or "".
  const std::string& held_up_by() const { return held_up_by_; }
  /// It can go no further, though no stop holds it up.
  bool locked() const { return locked_; }

  /// Throws InputError where it is interrupted. `is_held`: no farther than a force on the point holds the mechanism,
  /// which it does not at the end of the reach of a point that moves in an area.
  void go_to(Vec2 target, bool is_held = true);
  /// Moves off stops that it touches by next to nothing: where the hand alone holds the mechanism they would share the
  /// load with it in ways that nothing determines.
  void clear_stops();
  /// Where each step has led, m.
  const std::vector<Vec2>& passed() const { return passed_; }

 private:
  /// The motions that closures and some stops leave, orthonormal columns, and how the point moves in them.
  struct Motions {
    Eigen::MatrixXd basis;
    Eigen::MatrixXd rates;  ///< dP/dx basis
    Eigen::MatrixXd along;  ///< columns: the directions in the plane in which it moves most and least
    Vec2 rate{};            ///< of it in these
    double size() const { return rate.x; }
    bool runs_on_a_curve() const;
  };

  // Gives the rate in the direction in which the point moves least, of those in which it moves.
  double least_rate(const Motions& there) const { return moves_in_an_area_ ? there.rate.y : there.rate.x; }
  bool holds_at(const Motions& there) const;
  bool go_straight(Vec2 target);
  bool reach(Vec2 goal);
  double largest_gap() const;
  void expect_no_interrupt() const;
  void approach(Vec2 target, bool holds);
  int stops() const { return model_.mechanism().stops() - 2; }
  void look();
  Motions motions(const std::vector<int>& blocking) const;
  Eigen::VectorXd step_to(Vec2 target, bool strongly);
  Eigen::VectorXd newton_step(const Motions& left, const std::vector<int>& blocking,
                              const Eigen::VectorXd& missing) const;
  int first_blocked(const Eigen::VectorXd& step, const std::vector<int>& blocking) const;
  bool overruns(const std::vector<double>& x, const std::vector<double>& before) const;
  bool leap(Vec2 target, bool holds);
  /// Which way round two motions move the point in the plane.
  struct Sense {
    Eigen::MatrixXd basis;  ///< of the motions where it was found last, turned the same way all along
    int sign = 0;           ///< 0: not known, as with other than two freedoms
  };
  Sense sense_at(const Motions& there) const;
  bool goes_to(const Motions& there);
  bool advance(const Eigen::VectorXd& step, double part, Vec2 target, bool holds, double shortest);

  const std::atomic<bool>* interrupt_;
  StaticModel model_;  // with the point's coordinates as two stops without limits, the last
  solvers::Newton closing_;
  std::vector<double> x_;
  std::optional<DensePoint<double>> here_;  // all rows
  std::vector<double> values_;              // of stops, the point's coordinates last
  Vec2 place_{};                            // mechanism sizes
  std::vector<Vec2> passed_;
  Sense sense_;  // where it has come to
  struct {
    std::vector<double> x;
    std::size_t passed = 0;
    Sense sense;
  } last_balanced_;  // where a force on the point balanced the mechanism last
  std::string held_up_by_;
  bool locked_ = false;
  bool moves_in_an_area_ = false;
  double extent_ = 1.0;  // of the body dragged, some mechanism sizes, at most 1
};

}  // namespace poise
