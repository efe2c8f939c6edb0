#include "identification/assessment/private/altered.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "identification/experiment/pieces.hpp"
#include "solvers/quintic_spline.hpp"

namespace poise {

void move_input(RunInput& input, const std::function<double(double)>& time,
                const std::function<double(double)>& value) {
  const bool drives = input.motion.of == MotionInput::Of::drive;
  const std::vector<double>& breaks = input.motion.curve->breaks();
  std::vector<double> times, values;
  const auto add = [&](double t) {
    times.push_back(time(t));
    values.push_back(value(input.motion.curve->at(t)));
  };
  // A spline of few long pieces needs points within them.
  constexpr int within = 7;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    add(breaks[i]);
    for (int k = 1; drives && k <= within; ++k) add(breaks[i] + k * (breaks[i + 1] - breaks[i]) / (within + 1));
  }
  add(breaks.back());
  input.motion.curve =
      std::make_shared<const TimeCurve>(drives ? TimeCurve::along(solvers::interpolating_spline(times, values))
                                               : TimeCurve::through(std::move(times), values));
}

void stretch_clock(Experiment& experiment, std::size_t r, double factor) {
  Run& run = experiment.runs[r];
  run.sample_rate /= factor;
  run.duration *= factor;
  for (RunInput& input : run.inputs) {
    move_input(
        input, [&](double t) { return factor * t; }, [](double v) { return v; });
  }
  if (r >= experiment.records.size()) return;  // of an experiment that is simulated
  std::vector<Series>& read = experiment.records[r].sensors;
  for (std::size_t k = 0; k < read.size(); ++k) {
    for (double& t : read[k].time) t *= factor;
    if (!experiment.sensors[k].reads_impacts()) continue;
    for (double& v : read[k].value) v *= factor;
  }
}

void cut_into_pieces(Experiment& experiment, double length) {
  std::vector<Run> runs;
  std::vector<Record> records;
  for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
    const Run& run = experiment.runs[r];
    double end = 0.0;
    for (const Series& series : experiment.records[r].sensors) {
      if (!series.time.empty()) end = std::max(end, series.time.back());
    }
    const double whole = run.unknown_start ? length : INFINITY;
    for (Piece& piece : pieces_of({0.0, experiment.records[r], {}}, whole, end)) {
      runs.push_back(run);
      records.push_back(std::move(piece.record));
      if (piece.zero == 0.0) continue;
      runs.back().release.clear();
      for (RunInput& input : runs.back().inputs) {
        move_input(
            input, [&](double t) { return t - piece.zero; }, [](double v) { return v; });
      }
    }
  }
  experiment.runs = std::move(runs);
  experiment.records = std::move(records);
}

}  // namespace poise
