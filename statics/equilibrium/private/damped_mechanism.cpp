#include "statics/equilibrium/private/damped_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

constexpr int most_judged = 200;        // coordinates up to which the dampers are considered
constexpr double least_damping = 1e-8;  // relative: of the freedom that dampers resist least

struct DampedPose final : PhasorPose {
  std::vector<Planar<double>> measure;  // scratch of dampers and one-way springs
  std::vector<double> slopes;           // of one damper
};

DampedPose& damped_pose_of(solvers::Evaluation& at) { return static_cast<DampedPose&>(*at.scratch); }

}  // namespace

DampedMechanism::DampedMechanism(const StaticModel& model, const std::vector<double>& x)
    : scene_(model.scene()),
      mechanism_(model.mechanism()),
      problem_(model.problem()),
      tangent_pattern_(problem_.tangent_pattern()) {
  compile_one_way_springs(model);
  compile_dampers(model);
  if (!dampers_.empty() && !dampers_resist_all(x)) dampers_.clear();
  if (!dampers_.empty()) extend_pattern();
}

void DampedMechanism::compile_one_way_springs(const StaticModel& model) {
  const auto acts_one_way = [](const Element& element) {
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    return spring != nullptr && spring->acts != LinearSpring::Acts::both && spring->stiffness != 0.0;
  };
  if (std::none_of(scene_.elements.begin(), scene_.elements.end(), acts_one_way)) return;
  const Scene scaled_scene = model.scaled_scene();
  for (const Element& element : scaled_scene.elements) {
    if (!acts_one_way(element)) continue;
    const double free_length = std::get<LinearSpring>(element.law).free_length;
    const bool is_distance = element.on.kind == Measure::Kind::distance;
    if (is_distance && free_length <= 0.0) continue;  // no distance is shorter
    CompiledMeasure<double> on(scaled_scene, model.layout(), mechanism_.phasors(), element.on);
    if (on.support().empty()) continue;
    measure_scratch_ = std::max(measure_scratch_, on.scratch_size());
    switches_.push_back({free_length, is_distance});
    one_way_.push_back(std::move(on));
  }
}

void DampedMechanism::compile_dampers(const StaticModel& model) {
  if (mechanism_.coordinates() > most_judged) return;
  const Scene& scene = model.scene();
  const bool any = std::any_of(scene.elements.begin(), scene.elements.end(),
                               [](const Element& e) { return std::holds_alternative<Damper>(e.law); });
  if (!any) return;
  for (const Element& element : model.scaled_scene().elements) {
    const auto* damper = std::get_if<Damper>(&element.law);
    if (damper == nullptr || damper->coefficient == 0.0 || damper->acts != Damper::Acts::both) continue;
    ViscousElement viscous{
        {model.scaled_scene(), model.layout(), mechanism_.phasors(), element.on}, damper->coefficient, {}};
    if (viscous.on.support().empty()) continue;
    measure_scratch_ = std::max(measure_scratch_, viscous.on.scratch_size());
    dampers_.push_back(std::move(viscous));
  }
}

bool DampedMechanism::dampers_resist_all(const std::vector<double>& x) const {
  std::vector<int> rows(mechanism_.equalities());
  std::iota(rows.begin(), rows.end(), 0);
  const DensePoint<double> point(mechanism_, x, rows);
  const Eigen::MatrixXd basis = solvers::null_space<double>(point.jacobian, solvers::known_to::closed_point);
  const auto pose = make_scratch();
  auto& buffers = static_cast<DampedPose&>(*pose);
  mechanism_.place(x.data(), buffers.phasors.data());
  Eigen::MatrixXd slopes(static_cast<Eigen::Index>(dampers_.size()), basis.cols());
  for (std::size_t d = 0; d < dampers_.size(); ++d) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(mechanism_.coordinates());
    dampers_[d].on.add_gradient({mechanism_.phasors(), buffers.phasors.data(), buffers.measure.data()},
                                std::sqrt(dampers_[d].coefficient), slope.data());
    slopes.row(static_cast<Eigen::Index>(d)) = slope.transpose() * basis;
  }
  if (slopes.rows() < slopes.cols() || slopes.cols() == 0) return false;
  const Eigen::VectorXd damping = solvers::singular_value_decomposition(slopes).values;
  return damping[slopes.cols() - 1] > std::sqrt(least_damping) * damping[0];
}

void DampedMechanism::extend_pattern() {
  std::map<std::pair<int, int>, int> known;
  for (int e = 0; e < tangent_pattern_.size(); ++e) known[{tangent_pattern_.row[e], tangent_pattern_.column[e]}] = e;
  for (ViscousElement& damper : dampers_) {
    for (const int i : damper.on.support()) {
      for (const int j : damper.on.support()) {
        if (has_objective() && j > i) {
          damper.entry.push_back(-1);
          continue;
        }
        const auto [at, fresh] = known.try_emplace({i, j}, tangent_pattern_.size());
        if (fresh) {
          tangent_pattern_.row.push_back(i);
          tangent_pattern_.column.push_back(j);
        }
        damper.entry.push_back(at->second);
      }
    }
  }
}

std::unique_ptr<solvers::Scratch> DampedMechanism::make_scratch() const {
  auto pose = std::make_unique<DampedPose>();
  pose->phasors.resize(mechanism_.pose_size());
  pose->measure.resize(measure_scratch_);
  pose->slopes.resize(dampers_.empty() ? 0 : mechanism_.coordinates());
  return pose;
}

void DampedMechanism::tangent(solvers::Evaluation& at, std::span<const double> multipliers,
                              std::span<double> values) const {
  problem_.tangent(at, multipliers, values);
  std::fill(values.begin() + problem_.tangent_pattern().size(), values.end(), 0.0);
}

Configuration<double> DampedMechanism::configuration(solvers::Evaluation& at) const {
  DampedPose& pose = damped_pose_of(at);
  return {mechanism_.phasors(), pose.phasors.data(), pose.measure.data()};
}

void DampedMechanism::switch_measures(solvers::Evaluation& at, std::span<double> values) const {
  for (std::size_t k = 0; k < one_way_.size(); ++k) {
    values[k] = one_way_[k].value(configuration(at));
  }
}

void DampedMechanism::switch_gradient(solvers::Evaluation& at, int which, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  one_way_[which].add_gradient(configuration(at), 1.0, out.data());
}

void DampedMechanism::resistance(solvers::Evaluation& at, std::span<double> values) const {
  std::fill(values.begin(), values.end(), 0.0);
  if (dampers_.empty()) {
    std::fill(values.begin(), values.begin() + variables(), 1.0);
    return;
  }
  DampedPose& pose = damped_pose_of(at);
  for (const ViscousElement& damper : dampers_) {
    const std::vector<int>& support = damper.on.support();
    std::vector<double>& slopes = pose.slopes;
    std::fill(slopes.begin(), slopes.end(), 0.0);
    damper.on.gradient(configuration(at), [&](int i, double by) { slopes[i] = by; });
    std::size_t e = 0;
    for (std::size_t i = 0; i < support.size(); ++i) {
      for (std::size_t j = 0; j < support.size(); ++j, ++e) {
        if (damper.entry[e] >= 0) values[damper.entry[e]] += damper.coefficient * slopes[i] * slopes[j];
      }
    }
  }
}

}  // namespace poise
