#include "tests/design/goal_judge.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "model/csv_table.hpp"
#include "model/input_error.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise::test {
namespace {

using Kind = SoughtQuantity::Kind;
using Course = std::vector<std::pair<double, double>>;  // what is varied and a value, in the units of the scene

constexpr int grid = 181;
constexpr double may_miss = 1e-7;  // of the size of a goal

std::vector<double> numbers_of(const toml::node& node) {
  if (const auto one = node.value<double>()) return {*one};
  std::vector<double> out;
  for (const toml::node& item : *node.as_array()) out.push_back(*item.value<double>());
  return out;
}

std::optional<double> number_of(const toml::table& goal, const char* key) { return goal[key].value<double>(); }

/// The value of an expression of extremes and means over a range, by Simpson's rule and the values of the grid.
double over_range(const SoughtQuantity& of, const std::function<Course(const SoughtQuantity&)>& course) {
  switch (of.kind) {
    case Kind::number:
      return of.constant;
    case Kind::sum:
      return over_range(of.of[0], course) + over_range(of.of[1], course);
    case Kind::difference:
      return over_range(of.of[0], course) - over_range(of.of[1], course);
    case Kind::product:
      return over_range(of.of[0], course) * over_range(of.of[1], course);
    case Kind::quotient:
      return over_range(of.of[0], course) / over_range(of.of[1], course);
    default:
      break;
  }
  const Course values = course(of.of[0]);
  double least = HUGE_VAL, most = -HUGE_VAL, sum = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    least = std::min(least, values[k].second);
    most = std::max(most, values[k].second);
    const bool is_end = k == 0 || k + 1 == values.size();
    sum += values[k].second * (is_end ? 1.0 : k % 2 == 1 ? 4.0 : 2.0);
  }
  if (of.kind == Kind::maximum) return most;
  if (of.kind == Kind::minimum) return least;
  return of.kind == Kind::span ? most - least : sum / (3.0 * (grid - 1));
}

/// A path over all that the goals along one measure or number ask of.
class JudgedSweep {
 public:
  JudgedSweep(const Scene& scene, const std::string& along, double from, double to)
      : varied_(scene, along, from, from == to ? from + 0.01 * std::max(1.0, std::abs(from)) : to), reader_(varied_) {}

  /// Says why not all of these values, in the units of the scene, are reached on one curve.
  std::string follow(const std::vector<double>& at) {
    at_ = at;
    PathOptions options;
    options.certify = false;
    for (const double value : at) options.at.push_back(value * varied_.unit());
    found_ = path(varied_, options);
    if (found_.status == Path::Status::no_start) return found_.why;
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (found_.wanted.size() <= k || found_.wanted[k].empty()) return fmt::format("{} is not reached", at[k]);
      if (found_.wanted[k].size() > 1) return fmt::format("there are several equilibria at {}", at[k]);
    }
    return "";
  }

  SoughtQuantity quantity(const std::string& name) const { return find_quantity(named_scene(varied_), name); }
  double unit_of(const SoughtQuantity& of) const { return of.dimension.unit(varied_.scene().units); }
  /// In the units of the scene.
  Course course(const SoughtQuantity& of) {
    Course out;
    for (std::size_t k = 0; k < at_.size(); ++k) {
      out.emplace_back(at_[k], reader_.value(of, found_.wanted[k][0]) / unit_of(of));
    }
    return out;
  }
  const Scales& scales() const { return varied_.scales(); }

 private:
  VariedScene varied_;
  PathReader reader_;
  Path found_;
  std::vector<double> at_;
};

class GoalsJudge {
 public:
  GoalsJudge(const std::filesystem::path& design, const Scene& scene)
      : folder_(design.parent_path()), document_(toml::parse_file(design.string())), scene_(scene) {
    for (const toml::node& node : *document_["goal"].as_array()) widen(*node.as_table());
  }

  std::vector<JudgedGoal> judge() {
    std::vector<JudgedGoal> out;
    for (const toml::node& node : *document_["goal"].as_array()) {
      const toml::table& goal = *node.as_table();
      JudgedGoal judged;
      try {
        judged = goal.contains("along") ? judge_along(goal) : judge_at_rest(goal);
      } catch (const InputError& error) {
        judged.why = error.what();
      }
      out.push_back(std::move(judged));
    }
    return out;
  }

 private:
  struct Range {
    double least = HUGE_VAL, most = -HUGE_VAL;
    bool falls = true;
  };

  /// Paths begin at the least value that any goal asks of, or at the greatest where all go down.
  void widen(const toml::table& goal) {
    if (!goal.contains("along")) return;
    Range& range = ranges_[*goal["along"].value<std::string>()];
    const bool has_range = goal.contains("over");
    const std::vector<double> at = numbers_of(*goal.get(has_range ? "over" : "at"));
    for (const double value : at) {
      range.least = std::min(range.least, value);
      range.most = std::max(range.most, value);
    }
    range.falls = range.falls && has_range && at[0] > at[1];
  }

  JudgedGoal judge_along(const toml::table& goal) {
    const std::string along = *goal["along"].value<std::string>();
    Range range = ranges_.at(along);
    std::vector<double> at;
    if (goal.contains("over")) {
      const std::vector<double> ends = numbers_of(*goal.get("over"));
      for (int k = 0; k < grid; ++k) at.push_back(ends[0] + (ends[1] - ends[0]) * k / (grid - 1));
      at.back() = ends[1];
    } else {
      at = numbers_of(*goal.get("at"));
    }
    const bool is_one = goal.contains("equilibrium") && !goal.contains("over");
    if (is_one) {
      const double beside = 1e-3 * std::max(std::abs(range.most - range.least), std::abs(at[0]));
      at = {at[0] - beside, at[0], at[0] + beside};
      range.least = std::min(range.least, at[0]);
      range.most = std::max(range.most, at[2]);
    }
    JudgedSweep sweep(scene_, along, range.falls ? range.most : range.least, range.falls ? range.least : range.most);
    JudgedGoal out;
    out.why = sweep.follow(at);
    if (!out.why.empty()) return out;
    if (goal.contains("passes")) return {true, 0.0, ""};
    const SoughtQuantity of =
        sweep.quantity(goal.contains("equilibrium") ? "force.drive" : *goal["of"].value<std::string>());
    const double natural = 1e-3 / of.dimension.per_scale(sweep.scales()) / sweep.unit_of(of);
    if (goal.contains("equilibrium")) return judge_equilibrium(goal, sweep.course(of), natural);
    if (of.is_over_path()) {
      const double value = over_range(of, [&](const SoughtQuantity& one) { return sweep.course(one); });
      // Simpson's rule and values between those of the grid: a little more than rounding.
      return limits(goal, {{0.0, value}}, natural, 1e-4);
    }
    return limits(goal, sweep.course(of), natural, may_miss);
  }

  JudgedGoal judge_equilibrium(const toml::table& goal, const Course& force, double natural) const {
    const std::string wanted = *goal["equilibrium"].value<std::string>();
    JudgedGoal out;
    if (wanted == "none") {
      const bool rises = force[0].second > 0.0;
      out.holds = std::all_of(force.begin(), force.end(), [&](const auto& one) { return (one.second > 0.0) == rises; });
      if (!out.holds) out.why = "the force that holds it changes its sign";
      return out;
    }
    const double slope = force[2].second - force[0].second;
    out.holds = std::abs(force[1].second) <= 1e-5 * natural / 1e-3 && (slope > 0.0) == (wanted == "stable");
    if (!out.holds) out.why = fmt::format("force {:.3g}, which changes by {:.3g}", force[1].second, slope);
    return out;
  }

  JudgedGoal judge_at_rest(const toml::table& goal) {
    const StaticModel model(scene_);
    const SoughtQuantity of = find_quantity(scene_, *goal["of"].value<std::string>());
    double value = std::numeric_limits<double>::quiet_NaN();
    if (of.kind == Kind::load_at_fold) {
      const Sensitivities found = sensitivities(model, {of});
      if (!found.of.empty() && found.of[0].why.empty()) value = found.of[0].value;
    } else if (const Equilibrium rest = solve(model); rest.found()) {
      value = quantities_at(model, rest.x, rest.certificate.active_stops, {of})[0];
    }
    const double unit = of.dimension.unit(scene_.units);
    return limits(goal, {{0.0, value / unit}}, 1e-3 / of.dimension.per_scale(model.scales()) / unit, may_miss);
  }

  JudgedGoal limits(const toml::table& goal, const Course& course, double natural, double miss) const {
    double size = natural, margin = HUGE_VAL;
    const auto least = number_of(goal, "least"), most = number_of(goal, "most"), equals = number_of(goal, "equals"),
               within = number_of(goal, "within");
    for (const auto& limit : {least, most, equals, within}) size = std::max(size, std::abs(limit.value_or(0.0)));
    CsvTable curve;
    std::vector<std::string> header;
    if (const auto file = goal["curve"].value<std::string>()) {
      header = read_csv_header(folder_ / *file);
      curve = read_csv(folder_ / *file, header);
      for (const double wanted : curve.values[1]) size = std::max(size, std::abs(wanted));
    }
    JudgedGoal out{true, 0.0, ""};
    for (const auto& [at, value] : course) {
      if (!std::isfinite(value)) return {false, 0.0, fmt::format("no value at {}", at)};
      if (least) margin = std::min(margin, value - *least);
      if (most) margin = std::min(margin, *most - value);
      if (equals) margin = std::min(margin, within.value_or(0.0) - std::abs(value - *equals));
      if (!header.empty() && within) margin = std::min(margin, *within - std::abs(value - wanted_at(curve, at)));
    }
    if (std::isfinite(margin)) out.margin = margin / size;
    out.holds = out.margin >= -miss;
    if (!out.holds) out.why = fmt::format("missed by {:.3g} of its size {:.6g}", -out.margin, size);
    return out;
  }

  static double wanted_at(const CsvTable& curve, double at) {
    const std::vector<double>&x = curve.values[0], &y = curve.values[1];
    for (std::size_t k = 1; k < x.size(); ++k) {
      if (at < std::min(x[k - 1], x[k]) || at > std::max(x[k - 1], x[k])) continue;
      return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1]);
    }
    return std::abs(at - x.front()) < std::abs(at - x.back()) ? y.front() : y.back();
  }

  std::filesystem::path folder_;
  toml::table document_;
  const Scene& scene_;
  std::map<std::string, Range> ranges_;
};

}  // namespace

std::vector<JudgedGoal> judge_goals(const std::filesystem::path& design, const Scene& scene) {
  return GoalsJudge(design, scene).judge();
}

std::string missed_goals(const std::filesystem::path& design, const Scene& scene) {
  std::string out;
  int number = 0;
  for (const JudgedGoal& one : judge_goals(design, scene)) {
    ++number;
    if (!one.holds) out += fmt::format("goal {}: {}; ", number, one.why);
  }
  return out;
}

}  // namespace poise::test
