#pragma once

#include <optional>
#include <vector>

#include "identification/experiment/experiment.hpp"
#include "model/measures/measures.hpp"
#include "motion/variation.hpp"
#include "motion/varied_model.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise {

/// What a sensor reads of a moving pose, compiled in the scalar T:  g, its rate Dg[v], or its acceleration
///   Dg[a] + D2g[v, v],
/// and of an accelerometer  e . ((x'', y'') - gravity)  with its axis e.
template <class T>
class ReadMeasures {
 public:
  /// `layout` in SI; gravity is that of `numbers`, Numbers or SceneNumbers.
  template <class NumbersOfScene>
  ReadMeasures(const Layout& layout, Phasors<T> phasors, const NumbersOfScene& numbers, const Sensor& sensor);

  int coordinates() const { return phasors_.coordinates(); }
  const std::vector<int>& support() const { return support_; }
  /// A reading is linear in coordinates, rates and accelerations.
  bool is_linear() const { return on_.is_linear(); }
  /// Moves to where support()[i] = q[i] with these rates and accelerations.
  void place(const double* q, const double* v, const double* a);
  T value();
  /// The measure itself, of a force that of its element.
  T measure() { return on_.value(here()); }
  CompiledMeasure<T>& on() { return on_; }

  /// Adds the derivatives of value(), after it, to these of all coordinates.
  void add_derivatives(T* by_q, T* by_v, T* by_a);

 private:
  Configuration<T> here() { return {phasors_, pose_.data(), pose_.data() + phasors_.pose_size()}; }
  T acceleration(const CompiledMeasure<T>& of) {
    return of.along(here(), a_.data()) + of.second(here(), v_.data(), v_.data());
  }
  void add_acceleration(const CompiledMeasure<T>& of, const T& factor, T* by_q, T* by_v, T* by_a);

  Phasors<T> phasors_;
  int by_time_;
  CompiledMeasure<T> on_;                   // of an accelerometer the y of its point
  std::optional<CompiledMeasure<T>> x_;     // of its point
  std::optional<CompiledMeasure<T>> turn_;  // of its body
  T direction_;
  Planar<T> gravity_, axis_, felt_;  // as last read: e, and (x'', y'') - gravity
  std::vector<int> support_;
  std::vector<T> q_, v_, a_, unit_;  // of all coordinates
  std::vector<Planar<T>> pose_;
};

/// A sensor compiled for one model: its reading and derivatives as functions of coordinates, rates and accelerations,
/// all SI.
class SensorReader {
 public:
  SensorReader(const ScaledModel& model, const Sensor& sensor);

  /// Coordinates that the sensor depends on.
  const std::vector<int>& coordinates() const { return read_.support(); }
  /// Over coordinates().
  struct Derivatives {
    std::vector<double> by_q, by_v, by_a;
  };
  /// Its reading where coordinates()[i] = q[i] with the rates v[i] and accelerations a[i], and its derivatives, which
  /// are valid until the next call. 0 of a sensor of impacts.
  double read(const double* q, const double* v, const double* a);
  const Derivatives& derivatives() const { return by_; }
  /// The measure as last read: of a force sensor that of its element.
  double measure() const { return measure_; }

 private:
  ReadMeasures<double> read_;
  bool impacts_;            // their times, which no state tells
  std::optional<Law> law_;  // of the element whose force it reads
  double measure_ = 0.0;
  Derivatives by_;
  std::vector<double> by_q_, by_v_, by_a_;  // over all coordinates
};

/// The derivative of a sensor's reading by a number of the scene, at fixed coordinates, rates and accelerations, SI.
class SensorVariation {
 public:
  SensorVariation(const Variation& variation, const Sensor& sensor);

  /// Whether it may be other than zero.
  bool acts() const { return acts_; }
  /// Coordinates that the sensor depends on.
  const std::vector<int>& coordinates() const { return read_.support(); }
  /// Where coordinates()[i] = q[i] with the rates v[i] and accelerations a[i].
  double read(const double* q, const double* v, const double* a);

 private:
  using Dual = VariedModel::Dual;

  NumbersAlong along_;
  ReadMeasures<Dual> read_;
  std::optional<LawIn<Dual>> law_;  // of the element whose force it reads
  bool acts_ = true;
};

}  // namespace poise
