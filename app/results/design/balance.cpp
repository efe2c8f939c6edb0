#include "app/results/design/balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/result/each.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/dimension.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_balance = 12, digits_of_term = 7;
constexpr double rounding_of_terms = 1e-13;  // of the largest: less is shown as 0

constexpr Dimension dimension_of_moment = dimension::mass * dimension::length;

std::string amount_in_words(double si, const Dimension& of, const Units& units, int digits = digits_of_term) {
  const std::string unit = of.unit_name(units);
  return significant(si / of.unit(units), digits) + (unit.empty() ? "" : " " + unit);
}

/// A bound in words, rounded to so many digits away from what it bounds.
std::string balance_bound_in_words(double si, const Dimension& of, const Units& units, bool is_upper) {
  constexpr int digits = 8;
  const double value = si / of.unit(units);
  if (!(std::abs(value) > 0.0) || !std::isfinite(value)) return amount_in_words(si, of, units, digits);
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) - (digits - 1));
  const double rounded = (is_upper ? std::ceil(value / step) : std::floor(value / step)) * step;
  return amount_in_words(rounded * of.unit(units), of, units, digits);
}

Result balance_result(const BalanceProblem& problem) {
  Result out = scene_result(problem.scene, {});
  out.title = problem.title.empty() ? problem.file : problem.title;
  out.source = problem.source;
  Group& design = out.content.group("design", "", Verbosity::data);
  design.data("file", problem.file);
  design.data("title", problem.title);
  design.data("source", problem.source);
  return out;
}

/// Numbers of the scene that were found, in its units, with the ranges that were asked for.
void add_balance_numbers(Group& group, const BalanceProblem& problem, const std::vector<double>& found) {
  std::vector<FreeNumber> numbers = problem.stiffnesses;
  numbers.insert(numbers.end(), problem.coordinates.begin(), problem.coordinates.end());
  if (found.size() != numbers.size()) return;
  std::vector<std::string> names, units;
  std::vector<double> values, least, most;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const double unit = value_unit(problem.scene, numbers[k].path);
    names.push_back(numbers[k].path);
    values.push_back(found[k] / unit);
    least.push_back(numbers[k].min / unit);
    most.push_back(numbers[k].max / unit);
    units.push_back(parameter(problem.scene, numbers[k].path).dimension.unit_name(problem.scene.units));
  }
  Table& table = group.table("found", "Found", Rows::by_name);
  const Format significant_digits{Format::Style::significant, digits_of_balance};
  table.words("name", "number", std::move(names));
  table.numbers("value", "value", "", std::move(values), significant_digits);
  table.words("unit", "", std::move(units));
  table.numbers("least", "least", "", std::move(least), significant_digits);
  table.numbers("greatest", "greatest", "", std::move(most), significant_digits);
}

double largest_term(const std::vector<EnergyTerm>& terms) {
  double out = 0.0;
  for (const EnergyTerm& term : terms) out = std::max({out, std::abs(term.weights), std::abs(term.springs)});
  return out;
}

void add_energy_terms(Group& group, const WeightBalance& found, const Units& units) {
  const Dimension of = dimension::torque;
  const std::string unit = of.unit_name(units);
  const auto in_units = [&](auto member) {
    std::vector<double> out;
    for (const EnergyTerm& term : found.terms) out.push_back(member(term) / of.unit(units));
    return out;
  };
  const Format format{.digits = digits_of_term,
                      .zero_below = rounding_of_terms * largest_term(found.terms) / of.unit(units)};
  Table& table = group.table("terms", "Terms of the potential energy", Rows::list);
  table.words("name", "term", each(found.terms, &EnergyTerm::name));
  table.numbers("weights", "given", unit, in_units([](const EnergyTerm& t) { return t.weights; }), format);
  if (found.found.empty()) {
    table.numbers("least", "springs from", unit, in_units([](const EnergyTerm& t) { return t.least; }), format);
    table.numbers("most", "to", unit, in_units([](const EnergyTerm& t) { return t.most; }), format);
    table.numbers("factor", "factor", "", each(found.terms, &EnergyTerm::multiplier),
                  {.digits = digits_of_term, .zero_below = rounding_of_terms});
  } else {
    table.numbers("springs", "springs found", unit, in_units([](const EnergyTerm& t) { return t.springs; }), format);
    table.data("left", in_units([](const EnergyTerm& t) { return t.weights + t.springs; }));
  }
  const bool has_lengths = std::any_of(found.terms.begin(), found.terms.end(), [](const EnergyTerm& term) {
    return term.name.find("cos(") != 0 && term.name.find("sin(") != 0;
  });
  if (has_lengths) table.footnotes.emplace_back("Travels are measured in the size of the mechanism.");
}

/// "Cannot be balanced: ..." by the terms that no combination of the springs cancels.
Line refuted_balance(const WeightBalance& found, const Units& units) {
  if (!found.refuted) return bad("No numbers were found; that there are none is not proved.");
  const Dimension of = dimension::torque;
  if (found.row >= 0) {
    const EnergyTerm& term = found.terms[static_cast<std::size_t>(found.row)];
    const double sign = term.multiplier > 0.0 ? 1.0 : -1.0;
    const bool nothing = std::abs(found.most) <= rounding_of_terms * largest_term(found.terms);
    const std::string reach =
        nothing ? "they give none of that sign"
                : fmt::format("they give {} {} within their ranges", sign > 0.0 ? "at most" : "at least",
                              amount_in_words(sign * found.most, of, units));
    return bad(fmt::format(
        "Cannot be balanced: the weights have {} {}, for which springs would have to give {}, and {}.",
        amount_in_words(term.weights, of, units), term.name, amount_in_words(sign * found.demand, of, units), reach));
  }
  return bad(
      fmt::format("Cannot be balanced: no springs within the ranges cancel all terms together. With the factors "
                  "below the terms would have to add up to {}, and springs give at most {}.",
                  amount_in_words(found.demand, of, units), amount_in_words(found.most, of, units)));
}

Line balance_verdict(const WeightBalance& found, const Units& units) {
  if (found.found.empty()) return refuted_balance(found, units);
  if (!found.balanced) return bad("Not confirmed: the numbers found leave forces in random positions.");
  return good(fmt::format("Balanced in every position, exactly: proved by the coefficients of sines and cosines{}.",
                          found.relations > 0 ? " and the closures of the loops" : ""));
}

void add_exact_balance(Result& out, const BalanceProblem& problem, const WeightBalance& found) {
  const Units& units = problem.scene.units;
  Group& content = out.content;
  content.data("balanced", found.balanced);
  content.data("refuted", found.found.empty() && found.refuted && found.complete);
  add_balance_numbers(content, problem, found.found);
  add_energy_terms(content, found, units);
  if (found.found.empty() && !found.complete) {
    out.warnings.push_back(
        doubtful("Loops may relate the terms in more ways than by the products of their closures that "
                 "were used, so that this is not proved."));
  }
  Group& numerics = content.group("check", "Numerics", Verbosity::verbose);
  const int terms = static_cast<int>(found.terms.size());
  numerics.fact(
      "terms",
      fmt::format(
          "{}{}{}", count(terms, "independent function", "independent functions"),
          found.relations > 0
              ? fmt::format(", {} by closures", count(found.relations, "other expressed", "others expressed"))
              : "",
          found.parallelograms > 0 ? ", " + count(found.parallelograms, "parallelogram", "parallelograms") : ""));
  numerics.data("relations", found.relations);
  numerics.data("parallelograms", found.parallelograms);
  numerics.data("complete", found.complete);
  if (found.found.empty()) return;
  numerics.fact("left", small_number(found.residual) + " of the largest term");
  numerics.data("residual", found.residual);
  numerics.data("poses", found.check.poses);
  numerics.data("imbalance", found.check.imbalance / units.force);
  numerics.data("weight", found.check.weight / units.force);
  numerics.fact("statics", fmt::format("free bodies in {}: forces left {} of the weight",
                                       count(found.check.poses, "random position", "random positions"),
                                       small_number(found.check.imbalance / found.check.weight)));
}

void add_near_balance(Result& out, const BalanceProblem& problem, const NearBalance& found) {
  const Units& units = problem.scene.units;
  const Dimension of = found.is_force ? dimension::force : dimension::torque;
  Group& content = out.content;
  if (!found.solved) {
    out.verdict = bad("No stiffnesses were found for the range.");
    content.data("torque", nullptr);
    return;
  }
  const std::string what = found.is_force ? "force" : "torque";
  const std::string between = fmt::format(
      "the least largest {} is between {} and {}, proved", what, balance_bound_in_words(found.lower, of, units, false),
      std::isfinite(found.upper) ? balance_bound_in_words(found.upper, of, units, true) : std::string("no bound"));
  if (out.verdict.text.empty()) {
    out.verdict = doubtful("Not exactly: " + between + ".");
  } else {
    out.verdict.text += " Over the range " + between + ".";
  }
  add_balance_numbers(content, problem, found.found);
  Group& torque = content.group("torque", "Over the range");
  torque.data("is_force", found.is_force);
  torque.entry("lower", "at least", found.lower / of.unit(units), of.unit_name(units),
               {Format::Style::significant, digits_of_balance}, "with any stiffnesses within their ranges");
  torque.entry("upper", "at most", found.upper / of.unit(units), of.unit_name(units),
               {Format::Style::significant, digits_of_balance}, "with those found");
  std::string at;
  Group& pose = torque.group("at", "", Verbosity::data);
  for (std::size_t k = 0; k < found.at.size(); ++k) {
    const bool is_angle = problem.over[k].of.on.is_angle();
    const double shown = found.at[k] / (is_angle ? std::numbers::pi / 180 : units.length);
    pose.data(problem.over[k].of.name, shown);
    at += fmt::format("{}{} = {} {}", at.empty() ? "" : ", ", problem.over[k].of.name,
                      significant(shown, digits_of_term), is_angle ? "deg" : units.length_name);
  }
  torque.fact("reached", at);
  torque.entry("without", "without springs", found.without / of.unit(units), of.unit_name(units));
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("search",
                fmt::format("{}, {} in the program, {} enclosed", count(found.exchanges, "exchange", "exchanges"),
                            count(found.poses, "pose", "poses"), count(found.boxes, "box", "boxes")));
}

void add_counterweights(Group& group, const BalanceProblem& problem, const ShakingBalance& found) {
  const Units& units = problem.scene.units;
  const auto in = [&](const Dimension& of, auto member) {
    std::vector<double> out;
    for (const AddedWeight& weight : found.weights) out.push_back(member(weight) / of.unit(units));
    return out;
  };
  const Format format{Format::Style::significant, digits_of_balance - 2};
  const auto title = [&](const std::string& name, const Dimension& of) {
    return name + " (" + of.unit_name(units) + ")";
  };
  Table& table = group.table("counterweights", "Counterweights, in the bodies' frames", Rows::list);
  table.words("body", "body",
              each(found.weights, [&](const AddedWeight& w) { return problem.scene.bodies[w.body].name; }));
  table.words("about", "about", each(found.weights, [&](const AddedWeight& w) {
                return w.point.empty() ? std::string("its origin") : w.point;
              }));
  table.numbers("first_moment[]", title("first moment x", dimension_of_moment), "",
                in(dimension_of_moment, [](const AddedWeight& w) { return w.first_moment.x; }), format);
  table.numbers("first_moment[]", "y", "",
                in(dimension_of_moment, [](const AddedWeight& w) { return w.first_moment.y; }), format);
  table.numbers("mass", "mass", units.mass_name, in(dimension::mass, [](const AddedWeight& w) { return w.mass; }),
                format);
  table.numbers("place[]", title("at x", dimension::length), "",
                in(dimension::length, [](const AddedWeight& w) { return w.place.x; }), format);
  table.numbers("place[]", "y", "", in(dimension::length, [](const AddedWeight& w) { return w.place.y; }), format);
}

void add_moment_terms(Group& group, const ShakingBalance& found, const Units& units) {
  double largest = 0.0;
  for (const MomentTerm& term : found.terms) largest = std::max({largest, norm(term.before), norm(term.after)});
  const auto cells = [&](auto member) {
    std::vector<double> out;
    for (const MomentTerm& term : found.terms) out.push_back(member(term) / dimension_of_moment.unit(units));
    return out;
  };
  const std::string unit = dimension_of_moment.unit_name(units);
  const Format format{.digits = digits_of_term,
                      .zero_below = rounding_of_terms * largest / dimension_of_moment.unit(units)};
  Table& table = group.table("terms", "Terms of the total first moment (" + unit + ")", Rows::list);
  table.words("name", "term", each(found.terms, &MomentTerm::name));
  table.numbers("before[]", "before x", "", cells([](const MomentTerm& t) { return t.before.x; }), format);
  table.numbers("before[]", "y", "", cells([](const MomentTerm& t) { return t.before.y; }), format);
  table.numbers("left[]", "left x", "", cells([](const MomentTerm& t) { return t.after.x; }), format);
  table.numbers("left[]", "y", "", cells([](const MomentTerm& t) { return t.after.y; }), format);
}

void add_shaking_range(Group& group, const BalanceProblem& problem, const ShakingBalance& found) {
  const Units& units = problem.scene.units;
  const Shaking& before = *found.before;
  const Shaking& after = *found.after;
  const auto in = [&](const Dimension& of, double a, double b) {
    return std::vector<double>{a / of.unit(units), b / of.unit(units)};
  };
  Table& table = group.table("shaking", "Largest over the range of the drive, on the frame", Rows::by_name);
  table.words("name", "", {"before", "after"});
  Format format{.digits = digits_of_term, .zero_below = 1e-12 * before.force / units.force};
  table.numbers("force", "force", units.force_name, in(dimension::force, before.force, after.force), format);
  const bool is_angle = find_measure(problem.scene, problem.drive)->on.is_angle();
  // Where nothing but rounding is left its place says nothing.
  const auto place_of = [&](const Shaking& one) {
    const bool is_rounding = one.force <= 1e-12 * before.force;
    return is_rounding ? std::numeric_limits<double>::quiet_NaN()
                       : one.at_force / (is_angle ? std::numbers::pi / 180 : units.length);
  };
  table.numbers("at", "at " + problem.drive, is_angle ? "deg" : units.length_name, {place_of(before), place_of(after)},
                {.digits = 5});
  format.zero_below = 1e-12 * before.moment / dimension::torque.unit(units);
  table.numbers("moment", "moment about the origin", dimension::torque.unit_name(units),
                in(dimension::torque, before.moment, after.moment), format);
}

}  // namespace

Result weight_balance_result(const BalanceProblem& problem, const std::optional<WeightBalance>& exact,
                             const std::optional<NearBalance>& nearly) {
  Result out = balance_result(problem);
  if (exact) {
    out.verdict = balance_verdict(*exact, problem.scene.units);
    add_exact_balance(out, problem, *exact);
  } else {
    out.content.data("balanced", false);
  }
  if (nearly) add_near_balance(out, problem, *nearly);
  return out;
}

Result shaking_balance_result(const BalanceProblem& problem, const ShakingBalance& found) {
  const Units& units = problem.scene.units;
  Result out = balance_result(problem);
  Group& content = out.content;
  if (found.balanced) {
    std::string rest;
    if (found.after) {
      rest = fmt::format(" A shaking moment of up to {} is left.",
                         amount_in_words(found.after->moment, dimension::torque, units));
    }
    out.verdict = good("Shaking force cancelled exactly: the common centre of mass stays in its place." + rest);
  } else {
    std::vector<std::string> left;
    for (const MomentTerm& term : found.terms) {
      if (term.stays) left.push_back(term.name);
    }
    std::string least;
    if (found.is_least) {
      least = fmt::format(
          " The least largest force is {} of {}; found, not less than {} by the program over the positions.",
          amount_in_words(found.after->force, dimension::force, units, 9),
          amount_in_words(found.before->force, dimension::force, units),
          balance_bound_in_words(found.lower, dimension::force, units, false));
    }
    out.verdict =
        bad(fmt::format("The shaking force cannot be cancelled: no such counterweight acts against what moves "
                        "with the {}.{}",
                        listed(left), least));
  }
  if (!found.balanced && !found.complete) {
    out.warnings.push_back(doubtful("The terms were not found to be independent, so that this is not sure."));
  }
  if (!found.whole_range) out.warnings.push_back(doubtful("The drive ends before its range: " + found.why + "."));
  content.data("balanced", found.balanced);
  add_counterweights(content, problem, found);
  add_moment_terms(content, found, units);
  if (found.after) add_shaking_range(content, problem, found);
  Group& numerics = content.group("check", "Numerics", Verbosity::verbose);
  numerics.data("residual", found.residual);
  numerics.data("complete", found.complete);
  numerics.fact("left", significant(found.residual, 2) + " of the largest term of a body is not cancelled");
  numerics.fact("positions", fmt::format("the common first moment shifts by up to {} in random positions, {} before",
                                         significant(found.moved / dimension_of_moment.unit(units), 2),
                                         amount_in_words(found.moved_before, dimension_of_moment, units)));
  return out;
}

}  // namespace poise::app
