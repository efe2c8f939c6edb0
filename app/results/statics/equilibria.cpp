#include "app/results/statics/equilibria.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/quantities.hpp"
#include "app/results/statics/solve.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_coordinates_shown = 8;  // as text

Tone tone_of_claim(Claim claim) { return claim == Claim::complete ? Tone::good : Tone::doubtful; }

/// "no. 3", as the table counts them.
std::string number_in_list(int index) { return std::to_string(index + 1); }

std::vector<std::string> numbers_in_list(const std::vector<std::size_t>& rows) {
  return each(rows, [](std::size_t k) { return number_in_list(static_cast<int>(k)); });
}

double energy_of(const StaticModel& model, const Answer& answer) {
  return in_unit(or_gap(answer.equilibrium.energy), Quantity::energy, model.scene().units);
}

void add_coordinate_columns(Table& table, const StaticModel& model, const std::vector<Answer>& answers) {
  std::vector<std::vector<double>> shown;
  double radius = 0.0;
  for (const Answer& answer : answers) {
    shown.push_back(shown_coordinates(model, answer.equilibrium.x));
    radius = std::max(radius, radius_of(answer.equilibrium));
  }
  const auto number = static_cast<std::size_t>(model.mechanism().coordinates());
  for (std::size_t i = 0; i < number; ++i) {
    const Coordinate& coordinate = model.layout().coordinates[i];
    const Quantity quantity = quantity_of(coordinate);
    const double whole = quantity == Quantity::angle ? M_PI : model.scales().length;
    const double doubt = quantity == Quantity::angle ? radius : radius * model.scales().length;
    Column& column =
        add_column(table, model, coordinate.name, coordinate.name, quantity,
                   each(shown, [&](const std::vector<double>& q) { return q[i]; }), coordinate_digits, doubt);
    column.format.scale = in_unit(whole, quantity, model.scene().units);
    column.shown = i < most_coordinates_shown;
  }
  if (number > most_coordinates_shown) {
    table.footnotes.push_back(
        fmt::format("the first {} of {} coordinates; --csv and --json have all", most_coordinates_shown, number));
  }
}

/// With the drives that are held.
std::vector<QuantityValue> quantities_of(const StaticModel& model, const Equilibrium& equilibrium,
                                         const EquilibriaView& view) {
  std::vector<int> active;
  for (const int stop : equilibrium.certificate.active_stops) {
    if (view.driven < 0 || stop < view.driven) active.push_back(stop);
  }
  const int stops = static_cast<int>(model.scene().stops.size());
  for (int stop = view.driven; view.driven >= 0 && stop < stops; ++stop) active.push_back(stop);
  return quantity_values(resting_place(model, equilibrium.x, active, view.driven, other_quantity), view.show);
}

/// Whether two equilibria differ by whole turns of bodies alone, so that a mechanism looks the same in both.
bool differ_by_turns(const StaticModel& model, const Answer& a, const Answer& b) {
  constexpr double same = 1e-6;  // rad, mechanism sizes, parts of the energy
  const Certificate &first = a.equilibrium.certificate, &second = b.equilibrium.certificate;
  const double energy = energy_of(model, a), other_energy = energy_of(model, b);
  if (first.stability != second.stability || first.active_stops != second.active_stops) return false;
  if (!(std::abs(energy - other_energy) <= same * std::max(std::abs(energy), std::abs(other_energy)))) return false;
  const std::vector<double> p = shown_coordinates(model, a.equilibrium.x),
                            q = shown_coordinates(model, b.equilibrium.x);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const bool is_angle = quantity_of(model.layout().coordinates[i]) == Quantity::angle;
    const double apart = is_angle ? std::remainder(p[i] - q[i], 2 * M_PI) : (p[i] - q[i]) / model.scales().length;
    if (std::abs(apart) > same) return false;
  }
  return true;
}

/// The rows that text shows: of equilibria that differ by whole turns the first; and how many others look like it.
struct ShownRows {
  std::vector<std::size_t> rows;
  std::vector<int> alike;  ///< of each row
};

ShownRows distinct_rows(const StaticModel& model, const std::vector<Answer>& answers) {
  constexpr std::size_t most = 2000;  // every two are compared
  ShownRows out;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const auto like = [&](std::size_t row) { return differ_by_turns(model, answers[row], answers[k]); };
    const auto shown = k < most ? std::find_if(out.rows.begin(), out.rows.end(), like) : out.rows.end();
    if (shown == out.rows.end()) {
      out.rows.push_back(k);
      out.alike.push_back(0);
    } else {
      ++out.alike[static_cast<std::size_t>(shown - out.rows.begin())];
    }
  }
  return out;
}

/// These rows of all equilibria, as text or, of all, as CSV.
void add_table(Group& content, const StaticModel& model, const EquilibriumSet& set, const std::vector<Answer>& all,
               const ShownRows& chosen, bool is_csv, bool assemblies, const std::vector<SoughtQuantity>& show,
               const std::vector<std::vector<QuantityValue>>& all_shown) {
  Table& table = content.table("", assemblies ? "Assemblies" : "Equilibria", Rows::list,
                               is_csv ? Verbosity::data : Verbosity::normal);
  table.csv = is_csv;
  table.shown = Table::Shown::first;
  const std::vector<std::size_t>& rows = chosen.rows;
  std::vector<Answer> answers;
  std::vector<std::vector<QuantityValue>> shown;
  for (const std::size_t k : rows) {
    answers.push_back(all[k]);
    if (!all_shown.empty()) shown.push_back(all_shown[k]);
  }
  table.numbers("index", "no.", "", each(rows, [](std::size_t k) { return static_cast<double>(k); })).texts =
      numbers_in_list(rows);
  if (!assemblies) {
    Column& energy = table.numbers("energy", "energy", unit_name(Quantity::energy, model.scene().units),
                                   each(answers, [&](const Answer& a) { return energy_of(model, a); }),
                                   format_of_energies(model, answers));
    energy.shown = !model.mechanism().has_follower_loads();
    Column& stability =
        table.words("stability", "stability", each(answers, [](const Answer& a) { return kind_of(a); }));
    stability.tones = each(answers, [](const Answer& a) { return tone_of(a.equilibrium.certificate.stability); });
    stability.texts = each(answers, [](const Answer& a) {
      const int directions = a.equilibrium.certificate.unstable_directions;
      return kind_of(a) + (directions > 1 ? fmt::format(", {} directions", directions) : "");
    });
    table
        .counts("unstable_directions", "",
                each(answers, [](const Answer& a) { return a.equilibrium.certificate.unstable_directions; }))
        .shown = false;
  }
  add_coordinate_columns(table, model, answers);
  if (!shown.empty()) add_quantity_columns(table, show, shown, model.scene().units);
  table.flags("settles_here",
              each(rows, [&](std::size_t k) { return static_cast<int>(k) == set.settles_into ? 1.0 : 0.0; }));
  table.flags("change_point",
              each(answers, [](const Answer& a) { return is_change_point(a.equilibrium) ? 1.0 : 0.0; }));
  table.remarks(each(places(rows.size()), [&](std::size_t row) {
    const std::size_t k = rows[row];
    const Equilibrium& equilibrium = all[k].equilibrium;
    std::vector<std::string> remarks;
    if (static_cast<int>(k) == set.settles_into) {
      remarks.emplace_back(assemblies ? "the start closes this way" : "solve settles here");
    }
    if (is_change_point(equilibrium)) remarks.emplace_back("change point");
    if (!equilibrium.found()) remarks.push_back(in_few_words(equilibrium));
    for (const int stop : equilibrium.certificate.active_stops) {
      const Stop& held = model.scene().stops[static_cast<std::size_t>(stop)];
      if (held.min < held.max) remarks.push_back(fmt::format("on stop \"{}\"", held.name));
    }
    if (!is_csv && chosen.alike[row] > 0) remarks.push_back(fmt::format("{} more by whole turns", chosen.alike[row]));
    return fmt::format("{}", fmt::join(remarks, ", "));
  }));
  if (!assemblies) table.footnotes.push_back(fmt::format("energy: {}", energy_note));
}

void add_barriers(Group& content, const StaticModel& model, const EquilibriumSet& set,
                  const std::vector<Answer>& answers) {
  using Barrier = EquilibriumSet::Barrier;
  Table& table = content.table("barriers", "Lowest barriers between stable equilibria", Rows::list);
  const auto add = [&](const char* key, const char* title, int Barrier::*which) {
    table.counts(key, title, each(set.barriers, [&](const Barrier& b) { return b.*which; })).texts =
        each(set.barriers, [&](const Barrier& b) { return number_in_list(b.*which); });
  };
  add("from", "from no.", &Barrier::from);
  add("to", "to no.", &Barrier::to);
  add("over", "over no.", &Barrier::over);
  const std::vector<double> radii = each(set.barriers, [&](const Barrier& b) {
    const auto radius = [&](int index) { return answers[static_cast<std::size_t>(index)].radii.energy; };
    return radius(b.from) + radius(b.over);
  });
  add_column(table, model, "energy", "energy", Quantity::energy, each(set.barriers, &Barrier::energy), force_digits,
             widest(radii));
}

void add_balanced(Group& content, const StaticModel& model, const EquilibriumSet& set) {
  Branch& branch = content.array("balanced");
  for (const EquilibriumSet::Balanced& balanced : set.balanced) {
    const Quantity quantity = balanced.is_force ? Quantity::force : Quantity::moment;
    Group& one = branch.parts.emplace_back();
    one.list("coordinates", "", balanced.coordinates);
    one.data("exact", balanced.exact);
    one.data("effort", in_unit(balanced.effort, quantity, model.scene().units));
    one.data("unit", unit_name(quantity, model.scene().units));
    one.list("keeping", "", balanced.keeping);
    one.data("gap", in_unit(balanced.gap, Quantity::length, model.scene().units));
  }
}

/// Boxes as text, of those that read alike one.
void add_distinct_boxes(Group& content, const StaticModel& model, const std::vector<UndecidedBox>& all,
                        bool undecided) {
  const auto number = std::min(most_coordinates_shown, static_cast<std::size_t>(model.mechanism().coordinates()));
  const auto range = [&](const UndecidedBox& box, std::size_t i) {
    const Quantity quantity = quantity_of(model.layout().coordinates[i]);
    const auto end = [&](const std::vector<double>& x) {
      return significant(in_unit(shown_coordinates(model, x)[i], quantity, model.scene().units), force_digits);
    };
    return end(box.lower) + " to " + end(box.upper);
  };
  std::vector<UndecidedBox> boxes;
  std::set<std::string> known;
  for (const UndecidedBox& box : all) {
    std::string words = box.why + (box.neutral ? " neutral" : "");
    for (std::size_t i = 0; i < number; ++i) words += "; " + range(box, i);
    if (known.insert(words).second) boxes.push_back(box);
  }
  Table& table = content.table("", undecided ? "Undecided boxes" : "Boxes around singular positions", Rows::list);
  if (undecided) {
    table.words("", "kind", each(boxes, [](const UndecidedBox& box) -> std::string {
                  return box.neutral ? "neutral: a curve of equilibria" : "undecided";
                }));
  }
  for (std::size_t i = 0; i < number; ++i) {
    const Coordinate& coordinate = model.layout().coordinates[i];
    table.words("", fmt::format("{} ({})", coordinate.name, unit_name(quantity_of(coordinate), model.scene().units)),
                each(boxes, [&](const UndecidedBox& box) { return range(box, i); }));
  }
  if (undecided) table.words("", "why", each(boxes, [](const UndecidedBox& box) { return box.why; }));
  if (boxes.size() < all.size()) {
    table.footnotes.push_back(fmt::format("{} that differ by less than is shown here are one line",
                                          count(static_cast<int>(all.size()), "box", "boxes")));
  }
}

void add_boxes(Group& content, const StaticModel& model, const EquilibriumSet& set, bool undecided) {
  const std::vector<UndecidedBox>& boxes = undecided ? set.undecided : set.singular;
  Branch& branch = content.array(undecided ? "undecided" : "singular");
  for (const UndecidedBox& box : boxes) {
    Group& one = branch.parts.emplace_back();
    add_coordinate_data(one, "lower", model, box.lower);
    add_coordinate_data(one, "upper", model, box.upper);
    if (!undecided) {
      one.data("joint_force", box.joint_force);
      continue;
    }
    one.data("neutral", box.neutral);
    one.data("why", box.why);
  }
  if (boxes.empty()) return;
  add_distinct_boxes(content, model, boxes, undecided);
}

/// "balanced in every position", of all coordinates or of those named; empty where nothing is.
std::string balanced_in_words(const StaticModel& model, const EquilibriumSet& set) {
  std::vector<std::string> names;
  for (const EquilibriumSet::Balanced& balanced : set.balanced) {
    if (!balanced.keeping.empty()) return "";
    names.insert(names.end(), balanced.coordinates.begin(), balanced.coordinates.end());
  }
  if (names.empty()) return "";
  const bool is_all = names.size() == static_cast<std::size_t>(model.mechanism().coordinates());
  return "Balanced in every position" + (is_all ? "" : " of " + listed(names)) + ".";
}

/// Says of a complete set what there is, and that there is no more. The statement says in full what is left out.
std::string complete_in_words(const StaticModel& model, const EquilibriumSet& set, bool assemblies) {
  std::string balanced = balanced_in_words(model, set);
  if (!balanced.empty()) return balanced;
  const int number = static_cast<int>(set.equilibria.size());
  const auto stable = std::count_if(set.equilibria.begin(), set.equilibria.end(), [](const Equilibrium& equilibrium) {
    return equilibrium.certificate.stability == Stability::stable;
  });
  std::string text = assemblies ? count(number, "assembly", "assemblies") : count(number, "equilibrium", "equilibria");
  if (!assemblies && number > 0) {
    const std::string of_them = number == 1 ? (stable == 1 ? "stable" : "") : fmt::format("{} of them stable", stable);
    if (!of_them.empty()) text += ", " + of_them;
  }
  text += "; no others";
  if (!set.singular.empty()) return text + ", dead centres excepted.";
  return text + (set.statement.ends_with(", complete, proved") ? "." : ", but for what the claim leaves out.");
}

}  // namespace

Result equilibria_result(const StaticModel& model, const EquilibriumSet& set, const std::vector<Answer>& answers,
                         const AllEquilibriaOptions& options, const EquilibriaView& view,
                         const std::vector<std::string>& settings) {
  Result out = scene_result(model.scene(), settings);
  // What is balanced in part only takes the whole statement to say.
  const bool is_short = set.claim == Claim::complete && !set.interrupted &&
                        (set.balanced.empty() ? !set.equilibria.empty() : !balanced_in_words(model, set).empty());
  out.verdict = {"",
                 set.interrupted ? "Interrupted: " + set.statement + "."
                 : is_short      ? complete_in_words(model, set, options.assemblies)
                                 : sentence_of(set.statement),
                 set.interrupted ? Tone::bad : tone_of_claim(set.claim)};
  warn_of_friction(out, model.scene());
  if (!set.settles_nowhere.empty()) {
    out.warnings.push_back(
        doubtful(fmt::format("From the start it settles in none of these: {}.", set.settles_nowhere)));
  }
  warn_of_shaky(out, "In no.", answers, numbers_in_list(places(answers.size())));
  Group& content = out.content;
  content.data("claim", to_string(set.claim));
  content.data("statement", set.statement);
  if (is_short) {
    const bool is_plain = set.statement.ends_with(", complete, proved");
    content.fact("claim", set.statement, Tone::plain, is_plain ? Verbosity::verbose : Verbosity::normal);
  }
  content.data("interrupted", set.interrupted);
  content.data("assemblies", options.assemblies);
  content.data("settles_into", set.settles_into >= 0 ? std::optional(set.settles_into) : std::nullopt);
  content.data("settles_nowhere", set.settles_nowhere);
  std::vector<std::vector<QuantityValue>> shown;
  if (!view.show.empty()) {
    for (const Answer& answer : answers) shown.push_back(quantities_of(model, answer.equilibrium, view));
  }
  const std::vector<std::size_t> all_rows = places(answers.size());
  add_table(content, model, set, answers, {all_rows, std::vector<int>(answers.size(), 0)}, true, options.assemblies,
            view.show, shown);
  add_table(content, model, set, answers, distinct_rows(model, answers), false, options.assemblies, view.show, shown);
  Branch& equilibria = content.array("equilibria");
  for (std::size_t k = 0; k < answers.size(); ++k) {
    Group& one = equilibria.parts.emplace_back();
    one.data("index", k);
    add_answer_data(one, model, answers[k]);
    if (!shown.empty()) add_quantities(one, view.show, shown[k], model.scene().units);
  }
  add_barriers(content, model, set, answers);
  add_balanced(content, model, set);
  add_boxes(content, model, set, true);
  add_boxes(content, model, set, false);
  content.list("left_out", "Left out of statics", model.layout().dropped);
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.data("starts", set.starts);
  numerics.data("met_once", set.met_once);
  numerics.data("seed", options.seed);
  numerics.data("boxes", set.boxes);
  numerics.data("decided", set.decided);
  std::optional<double> angles_within = set.angles_within;
  if (angles_within) angles_within = in_unit(*angles_within, Quantity::angle, model.scene().units);
  numerics.data("angles_within", angles_within);
  numerics.data("microseconds", set.microseconds);
  if (set.boxes > 0) {
    numerics.fact("proof",
                  fmt::format("{} boxes examined, {:.4g} % of the volume decided", set.boxes, 100.0 * set.decided));
  }
  if (set.starts > 0) {
    numerics.fact("search",
                  fmt::format("{}, seed {}", count(set.starts, "random start", "random starts"), options.seed));
  }
  numerics.fact("time", duration(set.microseconds));
  return out;
}

}  // namespace poise::app
