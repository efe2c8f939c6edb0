#pragma once

#include <memory>
#include <string>
#include <vector>

// Neither Poise nor Simbody is included here: Simbody 3.7 is no C++20, and Poise is nothing less.

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
  Vector gravity;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Spring> springs;
  std::vector<Force> forces;
  std::vector<Torque> torques;
};

/// Where it stands: absolute angle of each body, rad, unwrapped, and travel of each slide (0 for pins).
struct PlainPose {
  std::vector<double> angle, travel;
};

enum class SimbodyMethod {
  minimizer,  ///< LocalEnergyMinimizer
  optimizer   ///< the same program by hand: exact Jacobian of the constraints, and a tolerance for them
};

/// The mechanism as a Simbody system, and its minimum of energy by Simbody.
class SimbodySolver {
 public:
  /// Throws std::invalid_argument where a body is not tied to the ground by pins and slides that lead away from it, or
  /// another joint than a pin closes a loop.
  explicit SimbodySolver(const PlainMechanism& mechanism);
  ~SimbodySolver();

  void start_from(const PlainPose& pose);

  struct Result {
    double seconds = 0.0;  ///< per solution
    long evaluations = 0;  ///< configurations at which forces were wanted, per solution
    PlainPose pose;
  };
  /// Throws what Simbody throws where it fails.
  Result solve(SimbodyMethod method, double tolerance, int times);

 private:
  class System;
  std::unique_ptr<System> system_;
};

}  // namespace poise::benchmarks
