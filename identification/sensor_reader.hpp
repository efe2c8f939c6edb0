#pragma once

#include <vector>

#include "identification/experiment.hpp"
#include "statics/scaled_model.hpp"

namespace poise {

/// A sensor compiled for one model: reads its quantity and the derivatives off coordinates and rates, all SI.
class SensorReader {
 public:
  SensorReader(const ScaledModel& model, const Sensor& sensor);

  /// Coordinates that the sensor depends on.
  const std::vector<int>& coordinates() const { return coordinates_; }
  /// What it reads where coordinates()[i] = q[i] with the rates v[i]; stiffness and free length are those of its spring
  /// (tension positive). Fills d/dq and d/dv over coordinates().
  double read(const double* q, const double* v, double stiffness, double free_length, double* by_q, double* by_v);
  /// Of a force sensor: length of the spring as last read, and whether it is slack there: without force.
  double length() const { return length_; }
  bool slack() const { return slack_; }

 private:
  struct Term {
    int own = 0, frame = -1;  // places in coordinates_
    bool is_angle = true;
    Planar<double> coefficient{};
  };
  void sum_up(const double* q, const double* v);

  Sensor::Kind kind_;
  bool rate_;
  std::vector<int> coordinates_;
  // angle and travel: sum of sign_ q + constant_
  std::vector<double> sign_;
  double constant_ = 0.0;
  // others: d = constant + sum of phasors; its derivatives over coordinates_
  std::vector<Term> terms_;
  Planar<double> offset_{};
  Planar<double> d_{}, d_rate_{};
  std::vector<Planar<double>> d_q_, d_rate_q_;
  Spring::Acts acts_ = Spring::Acts::both;
  double length_ = 0.0;
  bool slack_ = false;
};

}  // namespace poise
