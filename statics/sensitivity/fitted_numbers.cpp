#include "statics/sensitivity/fitted_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double move_size = 0.05;  // standard deviations

double quantile_of(double degrees) {
  return boost::math::quantile(boost::math::students_t(std::clamp(degrees, 1.0, 1e6)), 0.975);
}

std::vector<Index> at_bounds(const FittedNumbers& numbers) {
  std::vector<Index> out;
  for (std::size_t i = 0; i < numbers.numbers.size(); ++i) {
    if (numbers.numbers[i].bound != FittedNumbers::Number::Bound::none) out.push_back(static_cast<Index>(i));
  }
  return out;
}

MatrixXd columns_at(const MatrixXd& v, const std::vector<Index>& which) {
  MatrixXd out(v.rows(), static_cast<Index>(which.size()));
  for (std::size_t k = 0; k < which.size(); ++k) out.col(static_cast<Index>(k)) = v.col(which[k]);
  return out;
}

/// How all numbers follow those that are held: d p / d p_held, one column each, V_ph V_hh^-1.
MatrixXd following(const MatrixXd& v, const std::vector<Index>& held) {
  const MatrixXd columns = columns_at(v, held);
  const MatrixXd own = columns_at(MatrixXd(columns.transpose()), held);
  return solvers::FullyPivotedLu(own).solve(MatrixXd(columns.transpose())).transpose();
}

/// The covariance where some numbers are known.
MatrixXd with_held(const MatrixXd& v, const std::vector<Index>& held) {
  if (held.empty()) return v;
  MatrixXd out = v - following(v, held) * columns_at(v, held).transpose();
  for (const Index i : held) {
    out.row(i).setZero();
    out.col(i).setZero();
  }
  return out;
}

/// L of V = L L^T, one column for each axis of the correlations.
MatrixXd root_of(const MatrixXd& v) {
  if (v.size() == 0) return v;
  const VectorXd sigma = v.diagonal().cwiseMax(0.0).cwiseSqrt();
  const VectorXd over = (sigma.array() > 0).select(sigma.cwiseInverse(), 0.0);
  const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(over.asDiagonal() * v * over.asDiagonal());
  return sigma.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// The least covariance that is at least both, along the axes of one relative to the other: with V = L L^T and V_runs =
/// L B L^T, the eigenvalues of B below 1 become 1.
MatrixXd envelope_of(const FittedNumbers& numbers) {
  if (!numbers.by_runs) return numbers.covariance;
  const MatrixXd root = root_of(numbers.covariance);
  const solvers::LeastSquares<double> inverse(root, solvers::known_to::data);
  const auto solved = [&](const MatrixXd& of) {
    MatrixXd out(root.cols(), of.cols());
    for (Index k = 0; k < of.cols(); ++k) out.col(k) = inverse.solve(VectorXd(of.col(k)));
    return out;
  };
  const MatrixXd relative = solved(solved(*numbers.by_runs).transpose());
  const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(0.5 * (relative + relative.transpose()));
  const MatrixXd axes = root * eigen.vectors;
  return axes * eigen.values.cwiseMax(1.0).asDiagonal() * axes.transpose();
}

double variance_of(const MatrixXd& v, const VectorXd& g) { return std::max(0.0, g.dot(v * g)); }

/// The variances that count for a result, and Student's t of its interval.
struct Spread {
  const MatrixXd* covariance = nullptr;
  double reach = 0.0;
};

Spread spread_of(const FittedNumbers& numbers, const VectorXd& g) {
  if (!numbers.by_runs) return {&numbers.covariance, quantile_of(numbers.degrees)};
  double degrees = numbers.degrees;
  for (Index i = 0; i < g.size(); ++i) {
    if (g[i] == 0) continue;
    const double own = numbers.degrees_by_runs[static_cast<std::size_t>(i)];
    if (std::isnan(own)) return {&numbers.covariance, quantile_of(numbers.degrees)};
    degrees = std::min(degrees, own);
  }
  const bool larger = variance_of(*numbers.by_runs, g) > variance_of(numbers.covariance, g);
  return {larger ? &*numbers.by_runs : &numbers.covariance, quantile_of(degrees)};
}

/// The first direction that moves the result by more than rounding; empty where none does.
std::string what_moves(const FittedNumbers& numbers, const ResultGradient& result) {
  for (const FittedNumbers::Direction& one : numbers.unknown) {
    double moved = 0.0, rounding = 0.0;
    for (Index i = 0; i < one.part.size(); ++i) {
      moved += result.by[i] * one.part[i];
      rounding += std::abs(result.by[i]) * one.error[i];
      if (result.rounding.size() > 0) rounding += result.rounding[i] * std::abs(one.part[i]);
    }
    if (std::abs(moved) > rounding) return one.words;
  }
  return "";
}

/// M of PredictedResult; empty where a result is not known.
std::optional<MatrixXd> second_derivatives(const std::vector<ResultGradient>& moved, const MatrixXd& root) {
  if (moved.size() != static_cast<std::size_t>(2 * root.cols()) || moved.empty()) return std::nullopt;
  MatrixXd out(root.cols(), root.cols());
  for (Index k = 0; k < root.cols(); ++k) {
    const ResultGradient& up = moved[static_cast<std::size_t>(2 * k)];
    const ResultGradient& down = moved[static_cast<std::size_t>(2 * k + 1)];
    if (!up.why.empty() || !down.why.empty()) return std::nullopt;
    out.col(k) = root.transpose() * (up.by - down.by) / (2 * move_size);
  }
  return 0.5 * (out + out.transpose());
}

void add_shares(PredictedResult& out, const MatrixXd& v, const VectorXd& g) {
  const VectorXd vg = v * g;
  for (Index i = 0; i < g.size(); ++i) {
    if (g[i] == 0 || v(i, i) == 0) continue;
    out.shares.push_back(
        {static_cast<std::size_t>(i), out.sigma > 0 ? g[i] * vg[i] / (out.sigma * out.sigma) : 0.0, g[i]});
  }
  std::stable_sort(out.shares.begin(), out.shares.end(),
                   [](const auto& a, const auto& b) { return std::abs(a.share) > std::abs(b.share); });
}

PredictedResult without_derivatives(const SoughtQuantity& of, const std::string& why) {
  PredictedResult out;
  out.name = of.name;
  out.dimension = of.dimension;
  out.value = std::numeric_limits<double>::quiet_NaN();
  out.why = why;
  return out;
}

/// Predictions of quantities whose sensitivities at x are known.
std::vector<PredictedResult> predict_moved(const FittedNumbers& numbers, const StaticModel& model,
                                           const std::vector<double>& x, const std::vector<int>& active,
                                           const std::vector<QuantitySensitivity>& quantities) {
  std::vector<SoughtQuantity> of;
  for (const QuantitySensitivity& one : quantities) of.push_back(one.of);
  std::vector<std::vector<ResultGradient>> moved(of.size());
  for (const VectorXd& by : numbers.moves()) {
    Scene scene = model.scene();
    numbers.put_into(scene, by);
    const std::vector<QuantitySensitivity> there = sensitivities_near(model, x, active, of, &scene);
    for (std::size_t q = 0; q < of.size(); ++q) moved[q].push_back(gradient_by(numbers, there[q]));
  }
  std::vector<PredictedResult> out;
  for (std::size_t q = 0; q < of.size(); ++q) {
    out.push_back(predict(numbers, of[q].name, of[q].dimension, gradient_by(numbers, quantities[q]), moved[q]));
  }
  return out;
}

}  // namespace

FittedNumbers FittedNumbers::of(const Scene& scene) const {
  using Origin = Number::Origin;
  FittedNumbers out = *this;
  for (std::size_t i = out.numbers.size(); i-- > 0;) {
    Number& number = out.numbers[i];
    const std::optional<ParameterRow> row = find_parameter(scene, number.path);
    const std::optional<double> value = row ? value_at(scene, row->place) : std::nullopt;
    const bool is_another =
        number.origin == Origin::taken && !(value && std::abs(*value - number.value) <= 1e-12 * std::abs(number.value));
    if (number.origin == Origin::several) {
      out.notes.insert(
          out.notes.begin(),
          fmt::format("{} keeps the scene's value, which counts as exact: the fit has one for each run.", number.name));
    }
    if (number.origin == Origin::sensor || number.origin == Origin::several || is_another) {
      out.leave_out(i);
      continue;
    }
    if (!row) {
      try {
        parameter(scene, number.path);
      } catch (const InputError& error) {
        throw InputError(
            fmt::format("{}: {} has no number for its estimate {}: {}", file, scene.file, number.name, error.what()));
      }
    }
    number.path = row->path.text();
    number.dimension = row->dimension;
  }
  return out;
}

void FittedNumbers::put_into(Scene& scene, const Eigen::VectorXd& moved) const {
  // What follows from named numbers may have an estimate of its own.
  for (const bool named : {true, false}) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const ParameterPlace place = parameter(scene, numbers[i].path).place;
      if ((place.owner == Owner::number) != named) continue;
      set_value_at(scene, place, numbers[i].value + (moved.size() > 0 ? moved[static_cast<Index>(i)] : 0.0));
    }
  }
}

void FittedNumbers::leave_out(std::size_t number) {
  std::vector<Index> kept(numbers.size());
  std::iota(kept.begin(), kept.end(), 0);
  kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(number));
  const auto reduced = [&](const MatrixXd& v) { return columns_at(MatrixXd(columns_at(v, kept).transpose()), kept); };
  const auto some = [&](const VectorXd& v) { return VectorXd(columns_at(MatrixXd(v.transpose()), kept).transpose()); };
  numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(number));
  covariance = reduced(covariance);
  if (by_runs) {
    by_runs = reduced(*by_runs);
    degrees_by_runs.erase(degrees_by_runs.begin() + static_cast<std::ptrdiff_t>(number));
  }
  for (Direction& one : unknown) {
    one.part = some(one.part);
    one.error = some(one.error);
  }
  std::erase_if(unknown, [](const Direction& one) { return one.part.isZero(0.0); });
}

Eigen::MatrixXd FittedNumbers::root() const { return root_of(with_held(envelope_of(*this), at_bounds(*this))); }

Eigen::MatrixXd FittedNumbers::inwards() const {
  const std::vector<Index> bounds = at_bounds(*this);
  if (bounds.empty()) return MatrixXd(covariance.rows(), 0);
  const MatrixXd v = envelope_of(*this);
  MatrixXd out = following(v, bounds);
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    const bool grows = numbers[static_cast<std::size_t>(bounds[k])].bound == Number::Bound::least;
    out.col(static_cast<Index>(k)) *= (grows ? 1.0 : -1.0) * std::sqrt(v(bounds[k], bounds[k]));
  }
  return out;
}

std::vector<Eigen::VectorXd> FittedNumbers::moves() const {
  const MatrixXd axes = root();
  std::vector<VectorXd> out;
  for (Index k = 0; k < axes.cols(); ++k) {
    out.emplace_back(move_size * axes.col(k));
    out.emplace_back(-move_size * axes.col(k));
  }
  return out;
}

ResultGradient gradient_by(const FittedNumbers& numbers, const QuantitySensitivity& quantity) {
  ResultGradient out{.value = quantity.value, .why = quantity.why, .by = {}};
  const auto count = static_cast<Index>(numbers.numbers.size());
  out.by = VectorXd::Zero(count);
  out.rounding = VectorXd::Zero(count);
  if (!out.why.empty()) return out;
  for (Index i = 0; i < count; ++i) {
    const FittedNumbers::Number& number = numbers.numbers[static_cast<std::size_t>(i)];
    const auto found = std::find_if(quantity.by.begin(), quantity.by.end(),
                                    [&](const Sensitivity& one) { return one.number == number.path; });
    if (found == quantity.by.end()) continue;
    if (!found->why.empty()) out.why = fmt::format("no derivative by {}: {}", number.path, found->why);
    out.by[i] = found->derivative;
    out.rounding[i] = found->rounding;
  }
  return out;
}

PredictedResult predict(const FittedNumbers& numbers, const std::string& name, const Dimension& dimension,
                        const ResultGradient& result, const std::vector<ResultGradient>& moved) {
  PredictedResult out;
  out.name = name;
  out.dimension = dimension;
  out.value = result.value;
  out.why = result.why;
  if (!out.why.empty()) return out;
  out.undetermined = what_moves(numbers, result);
  if (!out.undetermined.empty()) return out;
  const VectorXd& g = result.by;
  const Spread spread = spread_of(numbers, g);
  const MatrixXd& v = *spread.covariance;
  const double u = spread.reach;
  out.sigma = std::sqrt(variance_of(v, g));
  add_shares(out, v, g);

  // Each end is that of numbers at bounds which can move the result towards it.
  const std::vector<Index> bounds = at_bounds(numbers);
  std::vector<Index> upwards, downwards;
  const VectorXd along = numbers.inwards().transpose() * g;
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    if (along[static_cast<Index>(k)] > 0) upwards.push_back(bounds[k]);
    if (along[static_cast<Index>(k)] < 0) downwards.push_back(bounds[k]);
  }
  out.is_one_sided = !upwards.empty() || !downwards.empty();
  out.first_low = out.value - u * std::sqrt(variance_of(with_held(v, upwards), g));
  out.first_high = out.value + u * std::sqrt(variance_of(with_held(v, downwards), g));
  out.low = out.first_low;
  out.high = out.first_high;

  const MatrixXd known = with_held(envelope_of(numbers), bounds);
  const MatrixXd root = root_of(known);
  const std::optional<MatrixXd> second = second_derivatives(moved, root);
  if (!second) return out;
  out.has_second = true;
  // The envelope may be wider than what counts for this result.
  const double own = variance_of(known, g);
  const double all = variance_of(with_held(v, bounds), g);
  const double larger = own > 0 ? all / own : 1.0;
  const MatrixXd m = larger * *second;
  const VectorXd a = std::sqrt(larger) * root.transpose() * g;
  out.shift = 0.5 * m.trace();
  const double variance = all + 0.5 * m.squaredNorm();
  out.second_sigma = std::sqrt(variance);
  const double skewness = variance > 0 ? (3 * a.dot(m * a) + (m * m * m).trace()) / (variance * out.second_sigma) : 0.0;
  const double bend = out.shift + out.second_sigma * (u * u - 1) * skewness / 6;
  const double wider = u * (out.second_sigma - std::sqrt(all));
  out.low += bend - wider;
  out.high += bend + wider;
  const double linear = PredictedResult::linear_to * out.sigma;
  out.is_linear = std::abs(bend - wider) <= linear && std::abs(bend + wider) <= linear;
  return out;
}

std::vector<PredictedResult> predict(const FittedNumbers& numbers, const StaticModel& model,
                                     const Equilibrium& equilibrium, const std::vector<SoughtQuantity>& of,
                                     const SensitivityOptions& options) {
  std::vector<SoughtQuantity> of_place;
  for (const SoughtQuantity& one : of) {
    if (one.kind != SoughtQuantity::Kind::load_at_fold) of_place.push_back(one);
  }
  const Sensitivities here = sensitivities(model, equilibrium, of_place, options);
  std::vector<PredictedResult> places;
  if (here.why.empty()) {
    places = predict_moved(numbers, model, equilibrium.x, equilibrium.certificate.active_stops, here.of);
  } else {
    for (const SoughtQuantity& one : of_place) {
      places.push_back(without_derivatives(one, here.why));
    }
  }
  std::vector<PredictedResult> out;
  auto next = places.begin();
  for (const SoughtQuantity& one : of) {
    if (one.kind != SoughtQuantity::Kind::load_at_fold) {
      out.push_back(*next++);
      continue;
    }
    const FirstFold first = first_fold(model, one.load, options.solve.interrupt);
    if (!first.why.empty()) {
      out.push_back(without_derivatives(one, first.why));
      continue;
    }
    FittedNumbers others = numbers;
    for (std::size_t i = others.numbers.size(); i-- > 0;) {
      if (others.numbers[i].path == one.load) others.leave_out(i);
    }
    PathOptions again;
    again.interrupt = options.solve.interrupt;
    const std::vector<PredictedResult> folds = predict_folds(others, *first.varied, first.path, again);
    const auto place =
        std::count_if(first.path.events.begin(), first.path.events.begin() + static_cast<std::ptrdiff_t>(first.event),
                      [](const PathEvent& event) { return event.kind == PathEvent::Kind::fold; });
    PredictedResult& fold = out.emplace_back(folds[static_cast<std::size_t>(place)]);
    fold.name = one.name;
  }
  return out;
}

std::vector<PredictedResult> predict_near(const FittedNumbers& numbers, const StaticModel& model,
                                          const std::vector<double>& x, const std::vector<int>& active,
                                          const std::vector<SoughtQuantity>& of) {
  return predict_moved(numbers, model, x, active, sensitivities_near(model, x, active, of));
}

std::vector<PredictedResult> predict_folds(const FittedNumbers& numbers, const VariedScene& varied, const Path& found,
                                           const PathOptions& options) {
  std::vector<std::size_t> folds;
  for (std::size_t e = 0; e < found.events.size(); ++e) {
    if (found.events[e].kind == PathEvent::Kind::fold) folds.push_back(e);
  }
  std::vector<QuantitySensitivity> here;
  for (const std::size_t e : folds) here.push_back(sensitivity_of_fold(varied, found, e));
  std::vector<std::vector<ResultGradient>> moved(folds.size());
  PathOptions again = options;
  again.certify = false;
  again.at.clear();
  again.progress = nullptr;
  for (const VectorXd& by : folds.empty() ? std::vector<VectorXd>() : numbers.moves()) {
    Scene scene = varied.scene();
    numbers.put_into(scene, by);
    const VariedScene other = varied.in(std::move(scene), varied);
    const Path there = path(other, again);
    std::vector<std::size_t> same;
    for (std::size_t e = 0; e < there.events.size(); ++e) {
      if (there.events[e].kind == PathEvent::Kind::fold) same.push_back(e);
    }
    for (std::size_t k = 0; k < folds.size(); ++k) {
      moved[k].push_back(same.size() == folds.size()
                             ? gradient_by(numbers, sensitivity_of_fold(other, there, same[k]))
                             : ResultGradient{.why = "with other numbers the path has other folds", .by = {}});
    }
  }
  std::vector<PredictedResult> out;
  for (std::size_t k = 0; k < folds.size(); ++k) {
    out.push_back(predict(numbers, here[k].of.name, here[k].of.dimension, gradient_by(numbers, here[k]), moved[k]));
  }
  return out;
}

}  // namespace poise
