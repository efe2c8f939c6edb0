#include "identification/prediction/input_errors.hpp"

#include <cmath>

namespace poise {

double InputErrors::whiten(Eigen::MatrixXd& rows, const std::vector<Eigen::Index>& first,
                           const std::vector<double>& noise) const {
  double log_determinant = 0.0;
  if (steps_->empty()) return log_determinant;
  const Eigen::Index states = steps_->front().transition.rows();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(states, states), product(states, states);
  Eigen::MatrixXd told = Eigen::MatrixXd::Zero(states, rows.cols()), next(states, rows.cols());  // of each column
  Eigen::RowVectorXd h(states), surprise(rows.cols());
  Eigen::VectorXd gain(states);
  for (const Step& step : *steps_) {
    next.noalias() = step.transition * told;
    told.swap(next);
    product.noalias() = step.transition * covariance;
    covariance.noalias() = product * step.transition.transpose();
    covariance.noalias() += (factor_ * factor_) * step.kick * step.kick.transpose();
    for (const Reading& reading : step.readings) {
      const Eigen::Index row = first[reading.sensor] + static_cast<Eigen::Index>(reading.number);
      if (row >= first[reading.sensor + 1]) continue;
      h = reading.by_state / noise[reading.sensor];
      gain.noalias() = covariance * h.transpose();
      const double variance = 1.0 + h.dot(gain);
      surprise.noalias() = rows.row(row) - h * told;
      log_determinant += std::log(variance);
      rows.row(row) = surprise / std::sqrt(variance);
      told.noalias() += gain / variance * surprise;
      covariance.noalias() -= gain / variance * gain.transpose();
    }
  }
  return log_determinant;
}

InputErrors InputErrors::times(double factor) const {
  InputErrors out = *this;
  out.factor_ *= factor;
  return out;
}

InputErrors InputErrors::with_offset(Eigen::VectorXd offset, std::vector<Eigen::Index> first) const {
  InputErrors out = *this;
  out.offset_ = std::move(offset);
  out.first_ = std::move(first);
  return out;
}

void InputErrors::subtract_offset(Eigen::Ref<Eigen::VectorXd> residuals, const std::vector<Eigen::Index>& first) const {
  if (offset_.size() == 0) return;
  for (std::size_t k = 0; k + 1 < first.size(); ++k) {
    const Eigen::Index count = first[k + 1] - first[k];
    residuals.segment(first[k], count) -= offset_.segment(first_[k], count);
  }
}

}  // namespace poise
