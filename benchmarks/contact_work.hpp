#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

// Simbody's part is compiled as C++17, so this header must be.

namespace poise::benchmarks {

constexpr double gravity = 9.81;

/// A ball of 1 kg that falls from a height onto a floor. Read: its height.
struct BallSizes {
  double height = 1.0, restitution = 0.8;
};
/// A block of 1 kg, uniform, that rocks on its corners without sliding or rebound, released at a part of the angle at
/// which it would stand on a corner (G. W. Housner, 1963). Read: its angle, which is negative on the right corner.
struct BlockSizes {
  double half_width = 0.1, half_height = 0.5, part = 0.5, friction = 2.0;
  /// At which it would stand on a corner, and the distance of that from its center.
  double steepest() const { return std::atan2(half_width, half_height); }
  double arm() const { return std::hypot(half_width, half_height); }
  double inertia() const { return arm() * arm() / 3; }
  /// At the start, on the right corner, which stays where it is as the block stands.
  double angle() const { return -part * steepest(); }
  double x() const { return half_width - arm() * std::sin(steepest() + angle()); }
  double y() const { return arm() * std::cos(steepest() + angle()); }
};
/// Two uniform rods of 1 m and 1 kg, from a fixed pin over an elbow to a ram of 1 kg on a rail through the fixed pin.
/// The elbow falls from above the rail through the dead centre onto a stop below it. Read: the angle of the first rod.
struct ToggleSizes {
  double from = 0.5, stop = -0.2, restitution = 0.5;
  double inertia() const { return 1.0 / 12; }  ///< of a rod, about its center
};

struct ContactState {
  double place = 0.0, rate = 0.0;
};

enum class ContactScene { ball, block, toggle };

struct ContactProblem {
  ContactScene scene = ContactScene::ball;
  std::string name, title;
  /// At which the state is read, s, ascending: multiples of 0.1, so that all fixed steps end there.
  std::vector<double> times;
};

/// The motion of a problem in one program at one of its settings.
class ContactMotion {
 public:
  virtual ~ContactMotion() = default;
  /// Returns to the start; not timed.
  virtual void begin() = 0;
  /// Moves from the start; returns the states at the times of the problem.
  virtual std::vector<ContactState> move() = 0;
  /// What else is to be told of it.
  virtual std::string note() const { return {}; }
};

/// One setting of a program.
struct ContactSetting {
  std::string program, value;
  std::function<std::unique_ptr<ContactMotion>()> make;
};

std::vector<ContactSetting> poise_settings(const ContactProblem& problem);
std::vector<ContactSetting> box2d_settings(const ContactProblem& problem);
std::vector<ContactSetting> mujoco_settings(const ContactProblem& problem);
std::vector<ContactSetting> simbody_settings(const ContactProblem& problem);

}  // namespace poise::benchmarks
