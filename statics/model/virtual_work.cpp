#include "statics/model/virtual_work.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "solvers/linear_algebra.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

constexpr double undefined_work = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double length_in_scene_units(const StaticModel& model) { return model.scales().length / model.scene().units.length; }

std::vector<double> in_scene_units(const StaticModel& model, std::vector<double> scaled) {
  const auto angles = static_cast<std::size_t>(model.layout().angles);
  for (std::size_t i = angles; i < scaled.size(); ++i) scaled[i] *= length_in_scene_units(model);
  return scaled;
}

std::vector<double> in_scaled_units(const StaticModel& model, std::vector<double> x) {
  const auto angles = static_cast<std::size_t>(model.layout().angles);
  for (std::size_t i = angles; i < x.size(); ++i) x[i] /= length_in_scene_units(model);
  return x;
}

struct VirtualWork::Matrices {
  Matrices(Eigen::Index n, Eigen::Index m)
      : jacobian(m, n), dependent(m, m), follow(m, n - m), tangent(n, n), lu(m), ordered(m), y(m) {}

  Eigen::MatrixXd jacobian;   // of the rows that hold, scaled
  Eigen::MatrixXd dependent;  // J_u
  Eigen::MatrixXd follow;     // -J_u^-1 J_v
  Eigen::MatrixXd tangent;    // K, scaled
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  Eigen::VectorXd ordered, y;
};

VirtualWork::VirtualWork(std::shared_ptr<const StaticModel> model, std::vector<TouchedLimit> touched)
    : model_(std::move(model)), touched_(std::move(touched)), n_(model_->mechanism().coordinates()) {
  if (n_ > most_coordinates) {
    throw InputError(fmt::format("{}expected at most {} coordinates for equations with dense matrices, found {}",
                                 where(*model_), most_coordinates, n_));
  }
  refuse_blades(model_->scene(), "systems of equations");
  expect_movable(*model_);
  length_ = length_in_scene_units(*model_);
  work_ = model_->scales().energy() / (model_->scene().units.force * model_->scene().units.length);
  for (int t = 0; t < n_; ++t) per_coordinate_.push_back(t < model_->layout().angles ? 1.0 : length_);
  const std::vector<double> scaled = close_loops(*model_);
  start_ = in_scene_units(*model_, scaled);
  choose_rows(scaled);
  name_rows();
  at_ = model_->problem().make_evaluation();
  tangent_values_.resize(model_->mechanism().tangent_row().size());
  all_multipliers_.resize(static_cast<std::size_t>(model_->mechanism().constraints()));
  scaled_y_.resize(rows_.size());
  matrices_ = std::make_unique<Matrices>(n_, rows());
  place(start_.data());
}

VirtualWork::~VirtualWork() = default;

void VirtualWork::choose_rows(const std::vector<double>& scaled) {
  const Mechanism<double>& m = model_->mechanism();
  std::vector<int> held = permanent_rows(m);
  for (const TouchedLimit& one : touched_) {
    const int row = m.stop_row(one.stop);
    if (std::find(held.begin(), held.end(), row) == held.end()) held.push_back(row);
  }
  const DensePoint<double> point(m, scaled, held);
  const auto independent_rows =
      solvers::pivot_order<double>(point.jacobian.transpose(), solvers::known_to::closed_point);
  for (Eigen::Index k = 0; k < independent_rows.rank; ++k) {
    rows_.push_back(held[static_cast<std::size_t>(independent_rows.columns[static_cast<std::size_t>(k)])]);
  }
  std::sort(rows_.begin(), rows_.end());
  const DensePoint<double> kept(m, scaled, rows_);
  const auto order = solvers::pivot_order<double>(kept.jacobian, solvers::known_to::closed_point);
  dependent_.assign(order.columns.begin(), order.columns.begin() + static_cast<std::ptrdiff_t>(rows_.size()));
  independent_.assign(order.columns.begin() + static_cast<std::ptrdiff_t>(rows_.size()), order.columns.end());
  std::sort(dependent_.begin(), dependent_.end());
  std::sort(independent_.begin(), independent_.end());
  place_of_row_.assign(static_cast<std::size_t>(m.constraints()), -1);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    place_of_row_[static_cast<std::size_t>(rows_[k])] = static_cast<int>(k);
}

void VirtualWork::name_rows() {
  const Mechanism<double>& m = model_->mechanism();
  for (const int row : rows_) {
    if (row < m.equalities()) {
      const auto block = std::find_if(m.blocks().begin(), m.blocks().end(), [&](const ConstraintBlock& one) {
        return row >= one.first_row && row < one.first_row + one.rows;
      });
      const Closure& closure = m.layout().closures[static_cast<std::size_t>(block->closure)];
      row_names_.push_back(closure.name + (row == block->first_row ? ".x" : ".y"));
      row_is_angle_.push_back(0);
      limits_.push_back(0.0);
    } else {
      const auto s = static_cast<std::size_t>(row - m.equalities());
      const Stop& stop = model_->scene().stops[s];
      const auto touched = std::find_if(touched_.begin(), touched_.end(), [&](const TouchedLimit& one) {
        return static_cast<std::size_t>(one.stop) == s;
      });
      const bool at_max = touched != touched_.end() && touched->at_max;
      row_names_.push_back(stop.name);
      row_is_angle_.push_back(stop.on.is_angle() ? 1 : 0);
      limits_.push_back(at_max ? m.upper()[s] : m.lower()[s]);
    }
    per_row_.push_back(row_is_angle_.back() != 0 ? 1.0 : length_);
  }
  place_of_stop_.assign(place_of_row_.size(), -1);
  for (int s = 0; s < m.stops(); ++s) {
    if (m.lower()[static_cast<std::size_t>(s)] == m.upper()[static_cast<std::size_t>(s)]) continue;
    place_of_stop_[static_cast<std::size_t>(m.stop_row(s))] = static_cast<int>(stops_.size());
    stops_.push_back(s);
  }
}

void VirtualWork::place(const double* x) {
  if (!x_.empty() && std::equal(x_.begin(), x_.end(), x)) return;
  x_.assign(x, x + n_);
  for (int i = 0; i < n_; ++i) at_.x[static_cast<std::size_t>(i)] = x[i] / per_coordinate_[static_cast<std::size_t>(i)];
  model_->problem().evaluate(at_);
  const Mechanism<double>& m = model_->mechanism();
  matrices_->jacobian.setZero();
  for (std::size_t e = 0; e < at_.jacobian.size(); ++e) {
    const int row = place_of_row_[static_cast<std::size_t>(m.jacobian_row()[e])];
    if (row >= 0) matrices_->jacobian(row, m.jacobian_column()[e]) += at_.jacobian[e];
  }
  is_factored_ = false;
}

double VirtualWork::energy() {
  if (model_->mechanism().has_follower_loads()) return undefined_work;
  return model_->problem().objective(at_) * work_;
}

void VirtualWork::gradient(double* out) const {
  for (std::size_t i = 0; i < per_coordinate_.size(); ++i) out[i] = at_.gradient[i] * work_ / per_coordinate_[i];
}

void VirtualWork::closures(double* out) const {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    out[k] = (at_.constraint[static_cast<std::size_t>(rows_[k])] - limits_[k]) * per_row_[k];
  }
}

void VirtualWork::closure_jacobian(double* out) {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (std::size_t i = 0; i < per_coordinate_.size(); ++i) {
      *out++ = matrices_->jacobian(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) * per_row_[k] /
               per_coordinate_[i];
    }
  }
}

void VirtualWork::stop_values(double* out) const {
  const Mechanism<double>& m = model_->mechanism();
  for (const int s : stops_) {
    const bool is_angle = model_->scene().stops[static_cast<std::size_t>(s)].on.is_angle();
    *out++ = at_.constraint[static_cast<std::size_t>(m.stop_row(s))] * (is_angle ? 1.0 : length_);
  }
}

void VirtualWork::stop_jacobian(double* out) {
  const Mechanism<double>& m = model_->mechanism();
  std::fill(out, out + stops_.size() * per_coordinate_.size(), 0.0);
  for (std::size_t e = 0; e < at_.jacobian.size(); ++e) {
    const int place = place_of_stop_[static_cast<std::size_t>(m.jacobian_row()[e])];
    if (place < 0) continue;
    const int stop = stops_[static_cast<std::size_t>(place)];
    const bool is_angle = model_->scene().stops[static_cast<std::size_t>(stop)].on.is_angle();
    const int column = m.jacobian_column()[e];
    out[static_cast<std::ptrdiff_t>(place) * n_ + column] +=
        at_.jacobian[e] * (is_angle ? 1.0 : length_) / per_coordinate_[static_cast<std::size_t>(column)];
  }
}

void VirtualWork::factor() {
  if (is_factored_) return;
  is_factored_ = true;
  Matrices& all = *matrices_;
  if (rows_.empty()) return;
  for (int k = 0; k < rows(); ++k) all.dependent.col(k) = all.jacobian.col(dependent_[static_cast<std::size_t>(k)]);
  all.lu.compute(all.dependent);
  const auto pivots = all.lu.matrixLU().diagonal().cwiseAbs();
  const bool is_regular = pivots.minCoeff() > std::numeric_limits<double>::epsilon() * pivots.maxCoeff();
  if (!is_regular) {
    all.follow.setConstant(undefined_work);
    all.y.setConstant(undefined_work);
    return;
  }
  // Permutations are written out because those of Eigen allocate.
  const auto& order = all.lu.permutationP().indices();
  for (int r = 0; r < rows(); ++r) {
    for (int k = 0; k < freedoms(); ++k) {
      all.follow(order[r], k) = -all.jacobian(r, independent_[static_cast<std::size_t>(k)]);
    }
    all.ordered[r] = -at_.gradient[static_cast<std::size_t>(dependent_[static_cast<std::size_t>(r)])];
  }
  all.lu.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(all.follow);
  all.lu.matrixLU().triangularView<Eigen::Upper>().solveInPlace(all.follow);
  all.lu.matrixLU().transpose().triangularView<Eigen::Lower>().solveInPlace(all.ordered);
  all.lu.matrixLU().transpose().triangularView<Eigen::UnitUpper>().solveInPlace(all.ordered);
  for (int r = 0; r < rows(); ++r) all.y[r] = all.ordered[order[r]];
}

void VirtualWork::find_tangent(const double* scaled_multipliers) {
  const Mechanism<double>& m = model_->mechanism();
  std::fill(all_multipliers_.begin(), all_multipliers_.end(), 0.0);
  if (scaled_multipliers != nullptr) {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      all_multipliers_[static_cast<std::size_t>(rows_[k])] = scaled_multipliers[k];
    }
  }
  model_->problem().tangent(at_, all_multipliers_, tangent_values_);
  Eigen::MatrixXd& tangent = matrices_->tangent;
  tangent.setZero();
  for (std::size_t e = 0; e < tangent_values_.size(); ++e) {
    const int i = m.tangent_row()[e], j = m.tangent_column()[e];
    tangent(i, j) += tangent_values_[e];
    if (!m.has_follower_loads() && i != j) tangent(j, i) += tangent_values_[e];
  }
}

void VirtualWork::multipliers(double* out) {
  factor();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    out[k] = matrices_->y[static_cast<Eigen::Index>(k)] * work_ / per_row_[k];
  }
}

void VirtualWork::directions(double* out) {
  factor();
  const std::ptrdiff_t f = freedoms();
  std::fill(out, out + n_ * f, 0.0);
  for (std::ptrdiff_t k = 0; k < f; ++k) {
    const auto v = static_cast<std::size_t>(independent_[static_cast<std::size_t>(k)]);
    out[static_cast<std::ptrdiff_t>(v) * f + k] = 1.0;
    for (std::size_t j = 0; j < dependent_.size(); ++j) {
      const auto u = static_cast<std::size_t>(dependent_[j]);
      out[static_cast<std::ptrdiff_t>(u) * f + k] =
          matrices_->follow(static_cast<Eigen::Index>(j), k) * per_coordinate_[u] / per_coordinate_[v];
    }
  }
}

void VirtualWork::equations(double* out) {
  factor();
  for (std::size_t k = 0; k < independent_.size(); ++k) {
    const auto v = static_cast<std::size_t>(independent_[k]);
    double work = at_.gradient[v];
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      work += matrices_->jacobian(row, independent_[k]) * matrices_->y[row];
    }
    out[k] = work * work_ / per_coordinate_[v];
  }
  closures(out + independent_.size());
}

void VirtualWork::jacobian(double* out) {
  factor();
  find_tangent(matrices_->y.data());
  const Eigen::MatrixXd& tangent = matrices_->tangent;
  for (std::size_t k = 0; k < independent_.size(); ++k) {
    const auto v = static_cast<std::size_t>(independent_[k]);
    for (std::size_t i = 0; i < per_coordinate_.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      double work = tangent(independent_[k], column);
      for (std::size_t j = 0; j < dependent_.size(); ++j) {
        work += matrices_->follow(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) *
                tangent(dependent_[j], column);
      }
      *out++ = work * work_ / (per_coordinate_[v] * per_coordinate_[i]);
    }
  }
  closure_jacobian(out);
}

void VirtualWork::hessian(const double* y, double* out) {
  if (y != nullptr) {
    for (std::size_t k = 0; k < rows_.size(); ++k) scaled_y_[k] = y[k] * per_row_[k] / work_;
  }
  find_tangent(y != nullptr ? scaled_y_.data() : nullptr);
  for (std::size_t i = 0; i < per_coordinate_.size(); ++i) {
    for (std::size_t j = 0; j < per_coordinate_.size(); ++j) {
      *out++ = matrices_->tangent(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * work_ /
               (per_coordinate_[i] * per_coordinate_[j]);
    }
  }
}

void VirtualWork::equations_with(const double* y, double* out) {
  gradient(out);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (std::size_t i = 0; i < per_coordinate_.size(); ++i) {
      out[i] += matrices_->jacobian(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) * per_row_[k] /
                per_coordinate_[i] * y[k];
    }
  }
  closures(out + n_);
}

void VirtualWork::jacobian_with(const double* y, double* out) {
  const std::size_t n = per_coordinate_.size(), size = n + rows_.size();
  for (std::size_t k = 0; k < rows_.size(); ++k) scaled_y_[k] = y[k] * per_row_[k] / work_;
  find_tangent(scaled_y_.data());
  std::fill(out, out + size * size, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      out[i * size + j] = matrices_->tangent(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * work_ /
                          (per_coordinate_[i] * per_coordinate_[j]);
    }
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const double entry = matrices_->jacobian(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) *
                           per_row_[k] / per_coordinate_[i];
      out[i * size + n + k] = entry;
      out[(n + k) * size + i] = entry;
    }
  }
}

}  // namespace poise
