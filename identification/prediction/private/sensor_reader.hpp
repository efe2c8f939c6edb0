#pragma once

#include <optional>
#include <vector>

#include "identification/experiment/experiment.hpp"
#include "model/measures/measures.hpp"
#include "motion/variation.hpp"
#include "motion/varied_model.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise {

/// A sensor compiled for one model: its reading and derivatives as functions of coordinates and rates, all SI.
class SensorReader {
 public:
  SensorReader(const ScaledModel& model, const Sensor& sensor);

  /// Coordinates that the sensor depends on.
  const std::vector<int>& coordinates() const { return on_.support(); }
  /// Its reading where coordinates()[i] = q[i] with the rates v[i]. Fills d/dq and d/dv over coordinates(). 0 of a
  /// sensor of impacts.
  double read(const double* q, const double* v, double* by_q, double* by_v);
  /// The measure as last read: of a force sensor that of its element.
  double measure() const { return measure_; }

 private:
  Phasors<double> phasors_;
  CompiledMeasure<double> on_;
  bool rate_;
  bool impacts_;            // their times, which no state tells
  std::optional<Law> law_;  // of the element whose force it reads
  double measure_ = 0.0;
  std::vector<double> q_, v_, bent_;  // of all coordinates
  std::vector<Planar<double>> pose_;
};

/// The derivative of a sensor's reading by a number of the scene, at fixed coordinates and rates, SI.
class SensorVariation {
 public:
  SensorVariation(const Variation& variation, const Sensor& sensor);

  /// Whether it may be other than zero.
  bool acts() const { return acts_; }
  /// Coordinates that the sensor depends on.
  const std::vector<int>& coordinates() const { return on_.support(); }
  /// Where coordinates()[i] = q[i] with the rates v[i].
  double read(const double* q, const double* v);

 private:
  using Dual = VariedModel::Dual;

  NumbersAlong along_;
  Phasors<Dual> phasors_;
  CompiledMeasure<Dual> on_;
  bool rate_;
  std::optional<LawIn<Dual>> law_;  // of the element whose force it reads
  std::vector<Dual> q_, v_;         // of all coordinates
  std::vector<Planar<Dual>> pose_;
  bool acts_ = true;
};

}  // namespace poise
