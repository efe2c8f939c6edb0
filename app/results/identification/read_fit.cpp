#include "app/results/identification/read_fit.hpp"

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
    out.sensors.push_back({sensors[k].at("name").get<std::string>(), number(sensors[k].at("noise")) * unit,
                           number(fit.at("rms").at(k)) * unit});
  }
  return out;
}

}  // namespace

FittedModel read_fit(const std::string& file) {
  const std::string expected = ": expected the result of poise identify with --json ";
  const std::string text = read_text_file(file);
  const json fit = json::parse(text, nullptr, false);
  if (!fit.is_object() || !fit.contains("estimates") || !fit.contains("status")) {
    throw InputError(file + expected + "FILE, found another text");
  }
  try {
    const std::string status = fit.at("status");
    if (status != "converged" && status != "misfit") {
      throw InputError(fmt::format("{}{}FILE that converged, found status \"{}\"", file, expected, status));
    }
    FittedModel out = model_of(fit);
    out.file = file;
    return out;
  } catch (const json::exception&) {
    throw InputError(file + expected + "FILE of this version, found one that lacks keys; fit again");
  }
}

}  // namespace poise::app
