#include "statics/sensitivity/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {
namespace {

constexpr int most_dense_unknowns = 1200;  // whose dense factors are computed in seconds
constexpr double sum_rounding = 1e-13;     // parts of a sum's terms below which it is zero
constexpr double nothing = 1e-9;           // parts of a vector below which it has no component along another

/// A number that may change alone, and its derivative.
struct Column {
  int row = 0;      // of the parameter table
  std::string why;  // it may not
};

/// Whether the force of a curve has no derivative by this number, the force at a point.
bool is_kinked_in(const Law& law, int number) {
  const auto* spring = std::get_if<CurveSpring>(&law);
  return spring != nullptr && number >= 2 && !spring->curve().has_derivatives_by(static_cast<std::size_t>(number - 2));
}

/// Why there is no derivative by a number that is not named; empty where there is one.
std::string why_not_by(const NumberedEquations& equations, const ParameterPlace& place,
                       const std::vector<NumberedEquations::Placed<double>>& placed) {
  const Scene& scene = equations.scene();
  if (place.owner == Owner::force && scene.forces[place.item].line_of_action() == Vec2{}) {
    return "a force with the vector [0, 0] has no direction";
  }
  if (place.owner == Owner::stop && scene.stops[place.item].min == scene.stops[place.item].max) {
    return "min and max of the stop are equal and can only change together";
  }
  if (place.owner == Owner::element && place.number == 1 &&
      scene.elements[place.item].on.kind == Measure::Kind::distance &&
      equations.bodies(equations.numbers().data(), placed).value(scene.elements[place.item].on) == 0.0) {
    return "the points of the spring coincide, where its length has no direction";
  }
  if (place.owner == Owner::element && is_kinked_in(scene.elements[place.item].law, place.number)) {
    return "the curve is flat beside the point, where its slope has no derivative";
  }
  return "";
}

/// The numbers that statics uses, and why some have no derivative.
std::vector<Column> columns_of(const NumberedEquations& equations, const LinearResponse& response, int& without) {
  const Scene& scene = equations.scene();
  std::vector<Column> out;
  std::vector<NumberedEquations::Placed<double>> placed;
  equations.place(response.z().data(), placed);
  without = 0;
  for (std::size_t k = 0; k < equations.rows().size(); ++k) {
    const ParameterPlace& place = equations.rows()[k].place;
    // A named number that is an expression is but a step to those that follow from it.
    if (place.owner == Owner::number && dependent_number(scene, place) != nullptr) continue;
    if (!acts_in_statics(scene, place)) {
      without += value_at(scene, place) ? 1 : 0;
      continue;
    }
    if (!std::isfinite(equations.numbers()[k])) continue;
    Column column{static_cast<int>(k), why_not_by(equations, place, placed)};
    if (place.owner == Owner::number) {
      column.why = equations.list()->why_not_followed(column.row);
      for (const auto& [at, slope] : equations.list()->followers(column.row, equations.numbers())) {
        if (at >= static_cast<int>(equations.rows().size()) || !column.why.empty()) continue;
        const ParameterRow& row = equations.rows()[at];
        const std::string why = why_not_by(equations, row.place, placed);
        if (!why.empty()) column.why = row.path.text() + " follows from it: " + why;
      }
    }
    out.push_back(std::move(column));
  }
  return out;
}

/// Why the equations have no derivatives at a place; empty where they have.
std::string without_direction(const NumberedEquations& equations, const std::vector<double>& z) {
  std::vector<NumberedEquations::Placed<double>> placed;
  equations.place(z.data(), placed);
  const NumberedEquations::Bodies<double> bodies = equations.bodies(equations.numbers().data(), placed);
  const auto is_zero = [&](const Measure& on) { return on.kind == Measure::Kind::distance && bodies.value(on) == 0.0; };
  for (const ActingStop& acting : equations.acting()) {
    const Stop& stop = equations.scene().stops[acting.stop];
    if (is_zero(stop.on))
      return fmt::format("stop \"{}\" holds a distance at zero, where it has no direction", stop.name);
  }
  for (const Element& element : equations.scene().elements) {
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    if (!stores_energy(element.law) || !is_zero(element.on)) continue;
    if (spring != nullptr && spring->free_length == 0.0) continue;
    return fmt::format("the points of {} \"{}\" coincide, where its force has no direction", element.family(),
                       element.name);
  }
  return "";
}

constexpr const char* no_direction = "the size of a force of zero has no derivative";
constexpr double response_rank_tolerance = solvers::known_to::solution;

double factor(const Dimension& of, const Dimension& number, const Scales& scales) {
  return number.per_scale(scales) / of.per_scale(scales);
}

/// Derivatives by all numbers, in scaled units, each known to within `rounding`.
struct KnownDerivatives {
  Eigen::VectorXd values, rounding;
};

/// Fills in one row per column from the derivatives; why(row) says why there is none by a number.
template <class Why>
void fill(QuantitySensitivity& out, const NumberedEquations& equations, const std::vector<Column>& columns,
          const Scales& scales, const KnownDerivatives& by, Why why) {
  for (const Column& column : columns) {
    const ParameterRow& row = equations.rows()[column.row];
    Sensitivity& s = out.by.emplace_back();
    s.number = row.path.text();
    s.dimension = row.dimension;
    s.value = equations.numbers()[column.row] / row.dimension.per_scale(scales);
    s.why = column.why;
    if (s.why.empty()) s.why = why(column.row);
    if (!s.why.empty()) continue;
    const double si = factor(out.of.dimension, row.dimension, scales);
    s.derivative = by.values[column.row] * si;
    s.rounding = by.rounding[column.row] * std::abs(si);
  }
}

/// Derivatives by every number, and the sizes of the terms that they are sums of.
struct SumsOfTerms {
  Eigen::VectorXd sums, sizes;
};

/// by_numbers - mu^T dR/dp
SumsOfTerms derivatives(const Eigen::VectorXd& by_numbers, const Eigen::VectorXd& mu, const Eigen::MatrixXd& residual) {
  return {by_numbers - residual.transpose() * mu,
          by_numbers.cwiseAbs() + mu.norm() * residual.colwise().norm().transpose()};
}

/// A place of the unknowns, with the equations' derivatives there.
struct Place {
  std::vector<double> z;
  ResidualDerivatives residual;
};

/// The equilibrium, and places that rounding does not tell from it: at each of these every unknown is off by a few
/// units in its last place, of either sign, and by the step that Newton's method was still to take.
std::vector<Place> places_of(const LinearResponse& response) {
  constexpr double ulps = 4.0 * std::numeric_limits<double>::epsilon();
  std::vector<Place> out{{response.z(), response.derivatives()}};
  const Eigen::VectorXd step = response.next_step();
  std::minstd_rand signs(1);
  for (const double sense : {1.0, -1.0}) {
    std::vector<double> z = response.z();
    for (std::size_t i = 0; i < z.size(); ++i) {
      z[i] += (signs() % 2 == 0 ? ulps : -ulps) * std::max(1.0, std::abs(z[i])) +
              sense * step[static_cast<Eigen::Index>(i)];
    }
    ResidualDerivatives there = response.at(z);
    out.push_back({std::move(z), std::move(there)});
  }
  return out;
}

/// Derivatives at the first place, by(place), in which those are 0 that are not told from 0: they are rounding of their
/// terms, or differ by their own size at the other places.
template <class By>
KnownDerivatives known_derivatives(const std::vector<Place>& places, By by) {
  constexpr double margin = 4.0;
  const SumsOfTerms at = by(places.front());
  Eigen::VectorXd rounding = sum_rounding * at.sizes;
  for (auto other = places.begin() + 1; other != places.end(); ++other) {
    rounding = rounding.cwiseMax(margin * (by(*other).sums - at.sums).cwiseAbs());
  }
  return {(at.sums.array().abs() > rounding.array()).select(at.sums, 0.0), rounding};
}

/// dm/dp of a quantity whose gradient at z is gradient(z), by the factors of (dR/dz)^T at the equilibrium.
template <class Gradient>
KnownDerivatives derivatives_of(const std::vector<Place>& places, const solvers::LeastSquares<double>& transposed,
                                Gradient gradient) {
  const Eigen::VectorXd mu = transposed.solve(gradient(places.front().z).by_unknowns);
  return known_derivatives(places, [&](const Place& place) {
    const QuantityGradient of = gradient(place.z);
    const Eigen::VectorXd left = of.by_unknowns - place.residual.by_unknowns.transpose() * mu;
    return derivatives(of.by_numbers, mu + transposed.solve(left), place.residual.by_numbers);
  });
}

/// Quantities at one equilibrium.
class AtEquilibrium {
 public:
  AtEquilibrium(const LinearResponse& response, const Scales& scales, std::vector<Column> columns, double tolerance,
                bool is_neutral)
      : response_(response),
        places_(places_of(response)),
        scales_(scales),
        columns_(std::move(columns)),
        transposed_(response.by_unknowns().transpose(), tolerance),
        is_neutral_(is_neutral) {
    left_null_ = transposed_.null_space();
    if (left_null_.cols() > 0) right_null_ = solvers::null_space<double>(response.by_unknowns(), tolerance);
  }

  QuantitySensitivity of(const SoughtQuantity& quantity) const {
    QuantitySensitivity out;
    out.of = quantity;
    const QuantityGradient gradient =
        gradient_of(quantity, response_.equations(), response_.equations().numbers(), response_.z());
    out.value = gradient.value / quantity.dimension.per_scale(scales_);
    out.why = gradient.why;
    if (!out.why.empty()) return out;
    if (!gradient.by_unknowns.allFinite() || !gradient.by_numbers.allFinite()) {
      const bool is_force = quantity.has(SoughtQuantity::Kind::reaction) || quantity.has(SoughtQuantity::Kind::shaking);
      out.why = is_force ? no_direction : "a distance of zero has no derivative";
      return out;
    }
    out.why = without_derivative(quantity);
    if (!out.why.empty()) return out;
    if (right_null_.cols() > 0) {
      const double along = (right_null_.transpose() * gradient.by_unknowns).cwiseAbs().maxCoeff();
      if (along > nothing * gradient.by_unknowns.norm()) {
        out.why = quantity.kind == SoughtQuantity::Kind::measure
                      ? "the equilibrium leaves it free (neutral, or degenerate)"
                      : "it is not determined: redundant constraints share the load in several ways";
        return out;
      }
    }
    // What is the same in all of a curve of equilibria may change with a number by other amounts in each of them, and
    // the number may leave but one of them.
    if (is_neutral_) {
      out.why = "the equilibrium is neutral: how this changes depends on where on its curve of equilibria it stands";
      return out;
    }
    const KnownDerivatives known = derivatives_of(places_, transposed_, [&](const std::vector<double>& z) {
      return gradient_of(quantity, response_.equations(), response_.equations().numbers(), z);
    });
    fill(out, response_.equations(), columns_, scales_, known, [&](int row) -> std::string {
      if (left_null_.cols() == 0) return "";
      const auto by_number = response_.by_numbers().col(row);
      const double opens = (left_null_.transpose() * by_number).cwiseAbs().maxCoeff();
      if (opens <= nothing * std::max(1.0, by_number.norm())) return "";
      return "it cannot change alone: constraints that repeat others would contradict them, or the balance is lost";
    });
    return out;
  }

 private:
  // Why a part of a quantity has a value but no derivative; empty where all have.
  std::string without_derivative(const SoughtQuantity& of) const {
    using Kind = SoughtQuantity::Kind;
    if (of.kind != Kind::ratio) {
      for (const SoughtQuantity& part : of.of) {
        if (std::string why = without_derivative(part); !why.empty()) return why;
      }
    }
    if (of.kind != Kind::reaction && of.kind != Kind::shaking) return "";
    const NumberedEquations& equations = response_.equations();
    double largest = 0.0;
    for (std::size_t i = equations.poses(); i < response_.z().size(); ++i) {
      largest = std::max(largest, std::abs(response_.z()[i]));
    }
    if (of.part == SoughtQuantity::Part::size) {
      QuantityPlace<double> place(equations, equations.numbers().data(), response_.z().data());
      if (place.value(of) <= nothing * largest) return no_direction;
    }
    for (int j = 0; j < static_cast<int>(equations.scene().joints.size()); ++j) {
      const Joint& joint = equations.scene().joints[static_cast<std::size_t>(j)];
      const bool counts = of.kind == Kind::reaction ? j == of.item : joint.a.body == 0 || joint.b.body == 0;
      const Stop* const teeth = counts ? equations.idle_teeth(j, response_.z(), nothing * largest) : nullptr;
      if (teeth == nullptr) continue;
      return fmt::format("{} \"{}\" transmits no force, and its teeth push \"{}\" the same way under either sign",
                         teeth->family(), teeth->name, joint.name);
    }
    return "";
  }

  const LinearResponse& response_;
  std::vector<Place> places_;  // the same for all quantities
  Scales scales_;
  std::vector<Column> columns_;
  solvers::LeastSquares<double> transposed_;
  Eigen::MatrixXd left_null_, right_null_;
  bool is_neutral_;
};

QuantitySensitivity at_first_fold(const StaticModel& model, const SoughtQuantity& quantity,
                                  const std::atomic<bool>* interrupt) {
  const FirstFold found = first_fold(model, quantity.load, interrupt);
  QuantitySensitivity out;
  if (found.why.empty())
    out = sensitivity_of_fold(*found.varied, found.path, found.event);
  else
    out.why = found.why;
  out.of = quantity;
  return out;
}

/// Of a stress or a mode the value, with the reason that there is no derivative.
QuantitySensitivity by_others(const StaticModel& model, const Equilibrium& equilibrium, const SoughtQuantity& quantity,
                              const OtherQuantities& others) {
  QuantitySensitivity out;
  out.of = quantity;
  const RestingPlace place = resting_place(model, equilibrium.x, equilibrium.certificate.active_stops, -1, others);
  const QuantityValue found = quantity_values(place, {quantity}).front();
  out.value = found.value;
  const Units& units = model.scene().units;
  out.why = found.why;
  if (out.why.empty()) {
    const std::string unit = quantity.dimension.unit_name(units);
    out.why = fmt::format("its value is {:.6g}{}{}; derivatives of stresses and modes are not found",
                          found.value / quantity.dimension.unit(units), unit.empty() ? "" : " ", unit);
  }
  return out;
}

/// The response in a scene whose numbers differ a little; empty where Newton's method does not converge to it.
std::optional<LinearResponse> moved_to(const LinearResponse& from, const Scene& scene) {
  constexpr int most_steps = 12;
  constexpr double converged = 1e-10;
  NumberedEquations equations(scene, from.equations().acting());
  std::vector<double> z = from.z();
  equations.count_turns(z.data());
  for (int step = 0; step < most_steps; ++step) {
    const ResidualDerivatives at = differentiate(equations, equations.numbers(), z, false);
    const Eigen::VectorXd dz =
        solvers::minimum_norm_solution<double>(at.by_unknowns, -at.residual, response_rank_tolerance);
    if (!dz.allFinite()) return std::nullopt;
    for (Eigen::Index i = 0; i < dz.size(); ++i) z[static_cast<std::size_t>(i)] += dz[i];
    if (dz.size() > 0 && dz.cwiseAbs().maxCoeff() > converged) continue;
    z.resize(static_cast<std::size_t>(equations.poses()));
    return LinearResponse(std::move(equations), std::move(z), response_rank_tolerance);
  }
  return std::nullopt;
}

void expect_few_unknowns(const StaticModel& model) {
  refuse_blades(model.scene(), "sensitivities of an equilibrium");
  const Scene scene = model.scaled_scene();
  const int unknowns = NumberedEquations(scene, {}).unknowns();
  if (unknowns > most_dense_unknowns) {
    throw InputError(fmt::format("{}: expected a mechanism of at most {} places and joint forces, found {}", scene.file,
                                 most_dense_unknowns, unknowns));
  }
}

}  // namespace

// --- loads at folds -------------------------------------------------------------------------------------------------

FirstFold first_fold(const StaticModel& model, const std::string& load, const std::atomic<bool>* interrupt) {
  FirstFold out;
  const ParameterRow row = parameter(model.scene(), load);
  const double unit = row.dimension.unit(model.scene().units);
  const double from = get_value(model.scene(), load);
  const double least = 1.0 / row.dimension.per_scale(model.scales()) / unit;
  const double size = std::max(std::abs(from), least);
  // Where the scene's forces are small beside its springs, the first fold is at many times these.
  for (const double times : {2.0, 8.0, 32.0, 128.0, 512.0, 2048.0, 0x1p14, 0x1p18, 0x1p22}) {
    PathOptions options;
    options.certify = false;
    options.interrupt = interrupt;
    Path& found = out.path;
    try {
      out.varied =
          std::make_unique<VariedScene>(model.scene(), load, from, from + (from < 0.0 ? -times : times) * size);
      found = path(*out.varied, options);
    } catch (const InputError& error) {
      out.why = error.what();  // equilibrium does not depend on the load
      return out;
    }
    if (found.status == Path::Status::interrupted) {
      out.why = "interrupted";
      return out;
    }
    if (found.branches.empty() || found.status == Path::Status::no_start) {
      out.why = found.why;
      return out;
    }
    for (const int e : found.branches[0].events) {
      const PathEvent& event = found.events[e];
      if (event.kind == PathEvent::Kind::branch) {
        out.why = fmt::format(
            "curves of equilibria cross at {} = {:.6g} {} before the first fold; what disturbs them moves the load "
            "there like a root, without a derivative",
            load, event.at.parameter / unit, out.varied->unit_name());
        return out;
      }
      if (event.kind != PathEvent::Kind::fold) continue;
      out.event = static_cast<std::size_t>(e);
      return out;
    }
  }
  out.why =
      fmt::format("the path has no fold up to {} = {:.4g} {}", load, out.varied->to() / unit, out.varied->unit_name());
  return out;
}

QuantitySensitivity sensitivity_of_fold(const VariedScene& varied, const Path& found, std::size_t event) {
  QuantitySensitivity out;
  const PathEvent& fold = found.events[event];
  out.of.name = varied.name();
  out.of.kind = SoughtQuantity::Kind::load_at_fold;
  out.of.load = varied.name();
  out.value = fold.at.parameter;
  int stop = -1, spring = -1;  // that come on or off at the fold
  for (const PathEvent& other : found.events) {
    const double apart = std::abs(other.at.parameter - fold.at.parameter);
    if (apart > 1e-9 * std::abs(fold.at.parameter)) continue;
    if (other.kind == PathEvent::Kind::stop) stop = other.item;
    if (other.kind == PathEvent::Kind::slack) spring = other.item;
  }
  const std::unique_ptr<StaticModel> there = varied.model_at(fold.at.parameter);
  std::vector<int> active = fold.at.active_stops;
  if (stop >= 0 && std::find(active.begin(), active.end(), stop) == active.end()) active.push_back(stop);
  const bool turns = stop < 0 && spring < 0;  // not a corner
  // Across the fold the matrix is singular, and Newton's steps along its null vector are rounding.
  const LinearResponse response =
      response_at(*there, fold.at.x, active, turns ? solvers::known_to::path : response_rank_tolerance);
  const NumberedEquations& equations = response.equations();
  out.why = response.why().empty() ? without_direction(equations, response.z()) : response.why();
  if (!out.why.empty()) return out;
  int load = -1, without = 0;
  for (std::size_t k = 0; k < equations.rows().size(); ++k) {
    if (equations.rows()[k].path.is(varied.name())) load = static_cast<int>(k);
  }
  if (load < 0) {
    out.why = "what is varied is no number of the scene, and has no derivative by one";
    return out;
  }
  out.of.dimension = equations.rows()[static_cast<std::size_t>(load)].dimension;
  std::vector<Column> columns = columns_of(equations, response, without);
  for (Column& column : columns) {
    if (column.row == load) column.why = "it is the load itself";
  }
  const auto none = [](int) { return std::string(); };
  if (!turns) {
    SoughtQuantity condition;
    if (stop >= 0) {
      condition.kind = SoughtQuantity::Kind::stop_reaction;
      condition.item = stop;
    } else {
      condition.on = equations.scene().elements[spring].on;
    }
    const auto gradient = [&](const std::vector<double>& z) {
      QuantityGradient of = gradient_of(condition, response.equations(), response.equations().numbers(), z);
      for (std::size_t k = 0; k < equations.rows().size(); ++k) {
        const ParameterPlace& place = equations.rows()[k].place;
        if (place.owner == Owner::element && place.item == spring && place.number == 1) {
          of.by_numbers[static_cast<Eigen::Index>(k)] -= 1.0;
        }
      }
      return of;
    };
    const solvers::LeastSquares<double> transposed(response.by_unknowns().transpose(), response_rank_tolerance);
    if (transposed.rank() < equations.unknowns()) {
      out.why = "redundant constraints leave the forces at the fold undetermined";
      return out;
    }
    KnownDerivatives by = derivatives_of(places_of(response), transposed, gradient);
    const double by_load = by.values[load];
    by = {by.values / -by_load, by.rounding / std::abs(by_load)};
    fill(out, equations, columns, there->scales(), by, none);
    return out;
  }
  const solvers::SingularValues values = solvers::singular_value_decomposition(response.by_unknowns());
  const Eigen::Index last = values.values.size() - 1;
  if (last > 0 && values.values[last - 1] < response_rank_tolerance * values.values[0]) {
    out.why = "redundant constraints or neutral directions leave the fold undetermined";
    return out;
  }
  const KnownDerivatives by = known_derivatives(places_of(response), [&](const Place& place) {
    const ResidualDerivatives& residual = place.residual;
    const solvers::SingularValues parts = solvers::singular_value_decomposition(residual.by_unknowns);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(residual.by_numbers.cols());
    const SumsOfTerms moves = derivatives(zero, parts.left.col(last), residual.by_numbers);
    return SumsOfTerms{moves.sums / -moves.sums[load], moves.sizes / std::abs(moves.sums[load])};
  });
  fill(out, equations, columns, there->scales(), by, none);
  return out;
}

// --- quantities -----------------------------------------------------------------------------------------------------

Sensitivities sensitivities(const StaticModel& model, const std::vector<SoughtQuantity>& of,
                            const SensitivityOptions& options) {
  expect_few_unknowns(model);
  return sensitivities(model, options.start ? solve(model, *options.start, options.solve) : solve(model, options.solve),
                       of, options);
}

Sensitivities sensitivities(const StaticModel& model, Equilibrium equilibrium, const std::vector<SoughtQuantity>& of,
                            const SensitivityOptions& options) {
  expect_few_unknowns(model);
  Sensitivities out;
  out.size = model.layout().size * model.scales().length;
  out.equilibrium = std::move(equilibrium);
  const Certificate& proof = out.equilibrium.certificate;
  if (!out.equilibrium.found()) {
    out.why = fmt::format("the equilibrium is {}: {}", to_string(out.equilibrium.status), out.equilibrium.why);
  } else if (proof.outcome == Outcome::degenerate) {
    out.why = "the equilibrium is degenerate, where derivatives do not exist: " + proof.statement;
  } else if (!proof.strict || !proof.sharing_stops.empty()) {
    out.why =
        "a stop is at its limit without pressing, shares its load with another, or a one-way spring is at its free "
        "length: derivatives differ on both sides";
  }
  if (!out.why.empty()) return out;
  // Where an isolated equilibrium is proved, small pivots are those of soft springs.
  const bool is_isolated = proof.outcome == Outcome::proved && proof.redundant == 0;
  const double tolerance = is_isolated ? solvers::known_to::rounding : response_rank_tolerance;
  const LinearResponse response = response_at(model, out.equilibrium.x, proof.active_stops, tolerance);
  out.why = response.why().empty() ? without_direction(response.equations(), response.z()) : response.why();
  if (!out.why.empty()) return out;
  const AtEquilibrium at(response, model.scales(), columns_of(response.equations(), response, out.without), tolerance,
                         proof.outcome == Outcome::neutral);
  for (const SoughtQuantity& quantity : of) {
    if (is_found_by_others(quantity)) {
      out.of.push_back(by_others(model, out.equilibrium, quantity, options.others));
      continue;
    }
    out.of.push_back(quantity.kind == SoughtQuantity::Kind::load_at_fold
                         ? at_first_fold(model, quantity, options.solve.interrupt)
                         : at.of(quantity));
  }
  return out;
}

std::vector<QuantitySensitivity> sensitivities_near(const StaticModel& model, const std::vector<double>& x,
                                                    const std::vector<int>& active,
                                                    const std::vector<SoughtQuantity>& of, const Scene* moved) {
  std::vector<QuantitySensitivity> out;
  std::optional<LinearResponse> response = response_at(model, x, active, response_rank_tolerance);
  if (moved != nullptr && response->why().empty()) response = moved_to(*response, scaled(*moved, model.scales()));
  std::string why =
      !response ? "Newton's method does not lead to an equilibrium of the scene with other numbers" : response->why();
  if (why.empty()) why = without_direction(response->equations(), response->z());
  int without = 0;
  std::optional<AtEquilibrium> at;
  if (why.empty()) {
    at.emplace(*response, model.scales(), columns_of(response->equations(), *response, without),
               response_rank_tolerance, false);
  }
  for (const SoughtQuantity& quantity : of) {
    const bool is_of_place = !is_found_by_others(quantity) && quantity.kind != SoughtQuantity::Kind::load_at_fold;
    QuantitySensitivity& one = out.emplace_back();
    if (at && is_of_place) one = at->of(quantity);
    one.of = quantity;
    if (!why.empty()) one.why = why;
    if (!is_of_place) one.why = "derivatives of stresses, modes and loads at folds are not found here";
  }
  return out;
}

}  // namespace poise
