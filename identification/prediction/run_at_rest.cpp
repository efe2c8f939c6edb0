// What a run model says of readings at rest: members of RunModel.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "identification/prediction/random_states.hpp"
#include "identification/prediction/run_model.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

void RunModel::rest(const Experiment& experiment, std::size_t run) {
  start_unknown_ = false;
  const StaticModel as_written(scene_);
  scales_ = as_written.scales();
  size_ = as_written.layout().size * scales_.length;
  at_rest_ = std::make_shared<const StaticRun>(experiment, run, scene_);
  mobility_ = freedoms_at(as_written, close_loops(as_written));
  take_times(run);
}

void RunModel::predict_at_rest(const double* unknowns, double until, bool jacobian, Prediction& out,
                               const std::atomic<bool>* interrupt) const {
  Scene scene = scene_;
  if (!sets_numbers(unknowns, scene, out.why)) return;
  const double last = std::clamp(std::floor(until), 0.0, static_cast<double>(run_.rows));
  const std::vector<StaticRun::Row> rows = at_rest_->read(scene, numbers_, static_cast<std::size_t>(last), interrupt);
  if (!rows.empty() && !rows.back().ok()) {
    out.why = rows.back().why;
    return;
  }
  out.reading.clear();
  out.jacobian.clear();
  const std::vector<Scaling> scaling = scalings(unknowns);
  const std::vector<std::size_t> count = counts(until);
  const auto width = static_cast<std::size_t>(columns());
  std::vector<double> by(numbers_.size());
  for (std::size_t i = 0; i < at_rest_->sensors().size(); ++i) {
    const std::size_t k = at_rest_->sensors()[i];
    const auto of = static_cast<Eigen::Index>(i);
    const Scaling& own = scaling[k];
    const double gain = experiment_.sensors[k].unit / own.factor;
    for (std::size_t s = 0; s < count[k]; ++s) {
      const StaticRun::Row& row = rows[static_cast<std::size_t>(times_[k][s]) - 1];
      out.reading.push_back(gain * row.value[of] + (experiment_.sensors[k].zero - gain * own.zero));
      if (!jacobian) continue;
      Eigen::Map<Eigen::VectorXd>(by.data(), static_cast<Eigen::Index>(by.size())) = row.by.row(of).transpose();
      out.jacobian.resize(out.jacobian.size() + width);
      fill_row({}, k, own, gain, row.value[of], 0.0, by, out.jacobian.data() + out.jacobian.size() - width);
    }
  }
  out.ok = true;
}

RunModel::Actions RunModel::actions_at_rest(const double* unknowns, int loads) const {
  Actions out;
  std::string why;
  Scene scene = scene_;
  if (!sets_numbers(unknowns, scene, why)) return out;
  const Scene near = disturbed(scene);
  const std::vector<Scaling> scaling = scalings(unknowns);
  const std::vector<std::size_t>& sensors = at_rest_->sensors();
  out.rows_per_state = static_cast<int>(sensors.size());
  out.scene = scene;
  std::vector<std::vector<double>> inputs;
  for (std::size_t row = 0; row < run_.rows; ++row) inputs.push_back(at_rest_->inputs(row));
  for (int i = 0; i < loads && !run_.row_inputs.empty(); ++i) {
    inputs.push_back(at_rest_->random_inputs(static_cast<std::uint64_t>(i)));
  }
  std::sort(inputs.begin(), inputs.end());
  inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
  const auto append = [&](const StaticRun::Row& row, Eigen::MatrixXd& to) {
    const Eigen::Index before = to.rows();
    to.conservativeResize(before + out.rows_per_state, columns());
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const auto of = static_cast<Eigen::Index>(i);
      const Scaling& own = scaling[sensors[i]];
      const std::vector<double> by(row.by.row(of).begin(), row.by.row(of).end());
      std::vector<double> filled(static_cast<std::size_t>(columns()));
      fill_row({}, sensors[i], own, 1.0, row.value[of], 0.0, by, filled.data());
      to.row(before + of) = Eigen::Map<const Eigen::RowVectorXd>(filled.data(), columns());
    }
  };
  for (const std::vector<double>& at : inputs) {
    const StaticRun::Row own = at_rest_->read(scene, at, numbers_, nullptr);
    if (!own.ok()) continue;
    const StaticRun::Row other = at_rest_->read(near, at, numbers_, nullptr);
    if (!other.ok()) continue;
    append(own, out.rows);
    append(other, out.again);
    const Eigen::Index before = out.error.rows();
    out.error.conservativeResizeLike(Eigen::MatrixXd::Zero(out.rows.rows(), out.rows.cols()));
    out.error.block(before, 0, own.error.rows(), own.error.cols()) = own.error;
  }
  return out;
}

}  // namespace poise
