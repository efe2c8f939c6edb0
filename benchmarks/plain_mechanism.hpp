#pragma once

#include <vector>

// No header of Poise is included here: Simbody 3.7 is no C++20, and Poise is nothing less.

namespace poise::benchmarks {

/// A planar mechanism in plain numbers, of whatever unit. Body 0 is the ground.
struct PlainMechanism {
  struct Vector {
    double x = 0.0, y = 0.0;
  };
  struct Place {  // a point of a body, in its frame
    int body = 0;
    Vector at;
  };
  struct Body {
    double mass = 0.0, inertia = 0.0;
    Vector center;
  };
  struct Joint {
    bool is_slide = false;  ///< else a pin
    Place a, b;
    double axis = 0.0;   ///< slide: direction of the line, rad, in a's body
    double angle = 0.0;  ///< slide: angle(b) - angle(a)
  };
  struct Spring {
    Place a, b;
    double stiffness = 0.0, free_length = 0.0;
    bool pulls = true, pushes = true;
  };
  struct Force {
    Place at;
    Vector force;
  };
  struct Torque {
    int body = 0;
    double torque = 0.0;
  };
  struct Stop {  // of the angle of body b less that of body a, rad
    int a = 0, b = 0;
    double min = 0.0, max = 0.0;
  };
  Vector gravity;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Spring> springs;
  std::vector<Force> forces;
  std::vector<Torque> torques;
  std::vector<Stop> stops;
};

/// Where it stands: absolute angle of each body, rad, unwrapped, and travel of each slide (0 for pins).
struct PlainPose {
  std::vector<double> angle, travel;
};

/// Another program that takes the mechanism as it is, with coordinates of its own.
class PlainSolver {
 public:
  PlainSolver() = default;
  virtual ~PlainSolver() = default;
  PlainSolver(const PlainSolver&) = delete;
  PlainSolver& operator=(const PlainSolver&) = delete;

  virtual void start_from(const PlainPose& pose) = 0;

  struct Result {
    double seconds = 0.0;  ///< per solution
    long evaluations = 0;  ///< configurations at which forces were wanted, per solution
    bool claimed = true;   ///< it reports success
    PlainPose pose;
  };
  /// The equilibrium by one of its methods, counted from 0. Throws what the program throws where it fails.
  virtual Result solve(int method, double accuracy, int times) = 0;
};

}  // namespace poise::benchmarks
