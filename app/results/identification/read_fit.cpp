#include "app/results/identification/read_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "model/input_error.hpp"
#include "model/text_file.hpp"

namespace poise::app {
namespace {

using nlohmann::json;

/// Withheld numbers are null.
double number(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

FittedModel model_of(const json& fit) {
  FittedModel out;
  const json& estimates = fit.at("estimates");
  const auto count = static_cast<Eigen::Index>(estimates.size());
  out.covariance = Eigen::MatrixXd::Constant(count, count, std::numeric_limits<double>::quiet_NaN());
  const json& covariance = fit.at("covariance");
  for (const json& one : estimates) {
    FittedModel::Parameter parameter;
    parameter.name = one.at("name").get<std::string>();
    parameter.path = one.at("path").get<std::string>();
    const double unit = one.at("unit_si");
    parameter.value = number(one.at("scene_value")) * unit;
    if (!one.at("withheld").is_null() && !one.at("at_bound").get<bool>())
      parameter.withheld = one.at("withheld").get<std::string>();
    const auto row = static_cast<Eigen::Index>(out.parameters.size());
    for (Eigen::Index column = 0; column < count && covariance.contains(parameter.name); ++column) {
      const json& other = estimates.at(static_cast<std::size_t>(column));
      out.covariance(row, column) = number(covariance.at(parameter.name).at(other.at("name").get<std::string>())) *
                                    unit * other.at("unit_si").get<double>();
    }
    out.parameters.push_back(std::move(parameter));
  }
  const json& sensors = fit.at("sensors");
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const double unit = sensors[k].at("unit_si");
    out.sensors.push_back(
        {sensors[k].at("name").get<std::string>(), number(sensors[k].at("noise")) * unit,
         k < fit.at("rms").size() ? number(fit.at("rms").at(k)) * unit : std::numeric_limits<double>::quiet_NaN()});
  }
  return out;
}

/// What `read` makes of the result of a fit that a file has.
template <class Read>
auto read_result(const std::string& file, const Read& read) {
  const std::string expected = ": expected the result of poise identify with --json ";
  const std::string text = read_text_file(file);
  const json fit = json::parse(text, nullptr, false);
  if (!fit.is_object() || !fit.contains("estimates") || !fit.contains("status")) {
    throw InputError(file + expected + "FILE, found another text");
  }
  try {
    return read(fit, file + expected);
  } catch (const json::exception&) {
    throw InputError(file + expected + "FILE of this version, found one that lacks keys; fit again");
  }
}

/// The nuisances of a run of this name; none where they are not all there.
std::vector<double> nuisances_in(const json& runs, const RunModel& run, const Units& units) {
  const std::vector<std::string> names = run.nuisance_names();
  const std::vector<Dimension> dimensions = run.nuisance_dimensions();
  for (const json& one : runs) {
    if (one.at("name").get<std::string>() != run.run().name) continue;
    std::vector<double> out;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!one.at("nuisances").contains(names[i])) return {};
      out.push_back(number(one.at("nuisances").at(names[i])) * dimensions[i].unit(units));
    }
    return out;
  }
  return {};
}

}  // namespace

FittedModel read_fit(const std::string& file) {
  return read_result(file, [&](const json& fit, const std::string& expected) {
    const std::string status = fit.at("status");
    if (status != "converged" && status != "misfit" && status != "interrupted") {
      throw InputError(fmt::format("{}FILE that converged, found status \"{}\"", expected, status));
    }
    FittedModel out = model_of(fit);
    out.file = file;
    out.is_unfinished = status == "interrupted";
    return out;
  });
}

Fit read_reached(const std::string& file, const FitProblem& problem) {
  return read_result(file, [&](const json& fit, const std::string&) {
    Fit out;
    const json& reached = fit.at("reached");
    for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
      const Parameter& parameter = problem.parameters()[p];
      if (!reached.contains(parameter.name)) {
        throw InputError(
            fmt::format("{}: expected the unknowns of {}, found no \"{}\"; give the result of a fit of this "
                        "experiment",
                        file, problem.experiment().file, parameter.name));
      }
      const double value = number(reached.at(parameter.name)) * problem.unknown_of(p).unit;
      out.parameters.push_back(std::clamp(value, parameter.min, parameter.max));
    }
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      const RunModel& run = problem.run(r);
      RunFit& own = out.runs.emplace_back();
      own.nuisances = nuisances_in(fit.at("residuals"), run, problem.experiment().scene.units);
      if (std::ssize(own.nuisances) == run.nuisances()) continue;
      out.runs.clear();  // they begin as guesses
      break;
    }
    for (const Sensor& sensor : problem.experiment().sensors) {
      double noise = 0.0;
      for (const json& one : fit.at("sensors")) {
        if (one.at("name").get<std::string>() == sensor.name)
          noise = number(one.at("noise")) * one.at("unit_si").get<double>();
      }
      out.weighting.noise.push_back(noise);
    }
    return out;
  });
}

}  // namespace poise::app
