#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace poise {

/// What noise in the readings of inputs does to the readings of sensors, to first order about one motion: states
///   x <- transition x + kick w,   w independent, of mean 0 and standard deviation 1,
/// from step to step, x = 0 before the first, and a sensor that reads  by_state x  more than it does without that
/// noise.
class InputErrors {
 public:
  struct Reading {
    std::size_t sensor, number;   ///< the number-th reading of the sensor
    Eigen::RowVectorXd by_state;  ///< SI
  };
  struct Step {
    Eigen::MatrixXd transition, kick;  ///< square; one column for each w
    std::vector<Reading> readings;     ///< after it
  };

  explicit InputErrors(std::vector<Step> steps) : steps_(std::make_shared<const std::vector<Step>>(std::move(steps))) {}

  /// Makes the errors of residuals independent, of unit size: each row is less what those before it tell of the states,
  /// over the standard deviation of what is left (the innovations of a Kalman filter, R. E. Kalman, 1960). `rows`: of
  /// residuals over the noise of their sensors, and of derivatives of these; sensor k has the rows from first[k] to
  /// first[k + 1], which may be fewer than its readings. `noise`: of the sensors, SI. Returns the logarithm of the
  /// determinant of the covariance of such residuals.
  double whiten(Eigen::MatrixXd& rows, const std::vector<Eigen::Index>& first, const std::vector<double>& noise) const;

  /// Returns the errors that noise makes which is `factor` times as large.
  InputErrors times(double factor) const;
  /// Returns these errors with an offset of whitened residuals, which has a value for each of all readings of sensor
  /// after sensor, sensor k's from first[k].
  InputErrors with_offset(Eigen::VectorXd offset, std::vector<Eigen::Index> first) const;
  /// Takes that from residuals, which are as for whiten(); nothing where there is none.
  void subtract_offset(Eigen::Ref<Eigen::VectorXd> residuals, const std::vector<Eigen::Index>& first) const;

 private:
  std::shared_ptr<const std::vector<Step>> steps_;  // shared by those with other noise or offsets
  double factor_ = 1.0;                             // of the kicks
  Eigen::VectorXd offset_;
  std::vector<Eigen::Index> first_;  // of the offset
};

}  // namespace poise
