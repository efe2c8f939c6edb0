#include "app/results/design/synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_four_bars = 8, digits_of_angles = 5;
constexpr double degree_of_synthesis = std::numbers::pi / 180;

const Format of_lengths{Format::Style::significant, digits_of_four_bars};
const Format of_angles{Format::Style::significant, digits_of_angles};

double as_length(double si, const Units& units) { return in_unit(si, Quantity::length, units); }

std::vector<double> as_place(const Vec2& si, const Units& units) {
  return {as_length(si.x, units), as_length(si.y, units)};
}

/// As text, with the same digits for both.
std::string as_degrees(double si) { return significant(si / degree_of_synthesis, digits_of_angles) + " deg"; }

std::string kind_in_words(GuidingDyad::Kind kind) {
  switch (kind) {
    case GuidingDyad::Kind::link:
      return "link";
    case GuidingDyad::Kind::slide_on_ground:
      return "slide on the ground";
    case GuidingDyad::Kind::slide_on_body:
      return "slide on the body";
  }
  return {};
}

std::vector<double> row_numbers(std::size_t size) {
  std::vector<double> out;
  for (std::size_t k = 0; k < size; ++k) out.push_back(static_cast<double>(k + 1));
  return out;
}

/// The beginning of each result.
Result begun(const SynthesisProblem& problem, const std::string& kind, bool met) {
  Result out;
  out.title = problem.title.empty() ? problem.file : problem.title;
  out.source = problem.source;
  Group& design = out.content.group("design", "", Verbosity::data);
  design.data("file", problem.file);
  design.data("title", problem.title);
  design.data("source", problem.source);
  add_units(out.content, problem.units);
  out.content.data("kind", kind);
  out.content.data("met", met);
  return out;
}

void add_four_bar_data(Group& group, const FourBar& linkage, const Units& units) {
  group.data("input_pivot", as_place(linkage.a, units));
  group.data("output_pivot", as_place(linkage.b, units));
  group.data("ground", as_length(norm(linkage.b - linkage.a), units));
  group.data("input", as_length(linkage.input, units));
  group.data("coupler", as_length(linkage.coupler, units));
  group.data("output", as_length(linkage.output, units));
  group.data("grashof", to_string(grashof_kind(linkage)));
}

void add_passage_data(Group& group, const Passage& passage) {
  const bool passes = passage.defect == Defect::none;
  const auto shown = [&](double angle) { return passes ? Value(angle / degree_of_synthesis) : Value(); };
  group.data("defect", passes ? Value() : Value(to_string(passage.defect)));
  group.data("from", shown(passage.from));
  group.data("to", shown(passage.to));
  group.data("transmission", shown(passage.transmission));
}

Tone tone_of_passage(const Passage& passage) { return passage.defect == Defect::none ? Tone::good : Tone::bad; }

/// Columns of how four-bars move; `of` gives the passage of a row.
template <class Rows, class Of>
void add_passages(Table& table, const Rows& rows, Of of) {
  const auto angle = [&](double Passage::*which) {
    return each(rows, [&](const auto& row) {
      const Passage& p = of(row);
      return p.defect == Defect::none ? p.*which / degree_of_synthesis : std::numeric_limits<double>::quiet_NaN();
    });
  };
  table.words("", "defect", each(rows, [&](const auto& row) { return to_string(of(row).defect); })).tones =
      each(rows, [&](const auto& row) { return tone_of_passage(of(row)); });
  table.numbers("", "input from", "deg", angle(&Passage::from), of_angles);
  table.numbers("", "to", "deg", angle(&Passage::to), of_angles);
  table.numbers("", "transmission", "deg", angle(&Passage::transmission), of_angles);
}

void add_guiding_links(Group& group, const std::string& title, const std::vector<GuidingDyad>& links,
                       const Units& units) {
  if (links.empty()) return;
  const bool any_slide =
      std::any_of(links.begin(), links.end(), [](const GuidingDyad& d) { return d.kind != GuidingDyad::Kind::link; });
  const auto known = [](const GuidingDyad& d, GuidingDyad::Kind without, double si) {
    return d.kind == without ? std::numeric_limits<double>::quiet_NaN() : si;
  };
  const auto numbers = [&](auto of) {
    return each(links, [&](const GuidingDyad& d) { return as_length(of(d), units); });
  };
  using Kind = GuidingDyad::Kind;
  constexpr double rounding = 1e-13;
  double size = 0.0;
  for (const GuidingDyad& d : links) size = std::max({size, norm(d.fixed), norm(d.moving)});
  Format coordinates = of_lengths;
  coordinates.zero_below = rounding * as_length(size, units);
  Table& table = group.table("", fmt::format("{} ({})", title, units.length_name), Rows::list);
  table.counts("", "no.", row_numbers(links.size()));
  if (any_slide) table.words("", "kind", each(links, [](const GuidingDyad& d) { return kind_in_words(d.kind); }));
  table.numbers("", "pivot x", "", numbers([&](auto& d) { return known(d, Kind::slide_on_ground, d.fixed.x); }),
                coordinates);
  table.numbers("", "pivot y", "", numbers([&](auto& d) { return known(d, Kind::slide_on_ground, d.fixed.y); }),
                coordinates);
  table.numbers("", "pin x", "", numbers([&](auto& d) { return known(d, Kind::slide_on_body, d.moving.x); }),
                coordinates);
  table.numbers("", "pin y", "", numbers([&](auto& d) { return known(d, Kind::slide_on_body, d.moving.y); }),
                coordinates);
  table.numbers("", "length", "", numbers([&](auto& d) {
                  return d.kind == Kind::link ? d.length : std::numeric_limits<double>::quiet_NaN();
                }),
                of_lengths);
  if (any_slide) {
    table.numbers("", "line", "deg",
                  each(links,
                       [&](const GuidingDyad& d) {
                         return d.kind == Kind::link ? std::numeric_limits<double>::quiet_NaN()
                                                     : std::atan2(d.axis.y, d.axis.x) / degree_of_synthesis;
                       }),
                  of_angles);
  }
  table.footnotes.emplace_back("pivots in the world, pins in the frame of the body");
}

void add_guiding_link_data(Branch& branch, const std::vector<GuidingDyad>& links, const Units& units) {
  using Kind = GuidingDyad::Kind;
  for (const GuidingDyad& d : links) {
    Group& one = branch.parts.emplace_back();
    one.data("kind", kind_in_words(d.kind));
    one.data("pivot", d.kind == Kind::slide_on_ground ? Value() : Value(as_place(d.fixed, units)));
    one.data("pin", d.kind == Kind::slide_on_body ? Value() : Value(as_place(d.moving, units)));
    one.data("length", d.kind == Kind::link ? Value(as_length(d.length, units)) : Value());
    one.data("axis", d.kind == Kind::link ? Value() : Value(std::vector<double>{d.axis.x, d.axis.y}));
    one.data("proved", d.proved);
    one.data("radius", d.proved ? Value(as_length(d.radius, units)) : Value());
  }
}

void add_guiding_four_bars(Group& group, const Guidance& guidance, const Units& units) {
  const std::vector<GuidingFourBar>& found = guidance.four_bars;
  if (found.empty()) return;
  const auto lengths = [&](auto of) {
    return each(found, [&](const GuidingFourBar& f) { return as_length(of(f.linkage), units); });
  };
  Table& table = group.table("", fmt::format("Four-bars ({})", units.length_name), Rows::list);
  table.counts("", "no.", row_numbers(found.size()));
  table.counts("", "input", each(found, [](const GuidingFourBar& f) { return f.input + 1.0; }));
  table.counts("", "output", each(found, [](const GuidingFourBar& f) { return f.output + 1.0; }));
  table.numbers("", "ground", "", lengths([](const FourBar& f) { return norm(f.b - f.a); }), of_angles);
  table.numbers("", "coupler", "", lengths([](const FourBar& f) { return f.coupler; }), of_angles);
  table.words("", "kind", each(found, [](const GuidingFourBar& f) { return to_string(f.kind); }));
  add_passages(table, found, [](const GuidingFourBar& f) -> const Passage& { return f.passage; });
  table.footnotes.emplace_back(
      "input and output are numbers of links; transmission: least angle on the way from the first "
      "pose to the last");
}

void add_guidance_data(Group& content, const Guidance& guidance, std::size_t poses, const Units& units) {
  add_guiding_link_data(content.array("links"), guidance.links, units);
  Branch& four_bars = content.array("four_bars");
  for (const GuidingFourBar& f : guidance.four_bars) {
    Group& one = four_bars.parts.emplace_back();
    one.data("input_link", f.input + 1);
    one.data("output_link", f.output + 1);
    add_four_bar_data(one, f.linkage, units);
    one.data("point", as_place(f.linkage.point, units));
    one.data("input_angles", each(f.positions, [](const InputPosition& p) { return p.angle / degree_of_synthesis; }));
    std::vector<std::int64_t> closures;
    for (const InputPosition& p : f.positions) closures.push_back(p.closure);
    one.data("closures", std::move(closures));
    one.data("wanted", f.wanted);
    add_passage_data(one, f.passage);
  }
  content.data("best", guidance.best < 0 ? Value() : Value(guidance.best + 1));
  if (poses == 5) {
    content.data("complete", guidance.five.complete);
    content.data("dependent", guidance.five.dependent);
    content.data("complex", guidance.five.complete ? Value(guidance.five.complex) : Value());
  } else if (poses == 4) {
    content.data("complete", guidance.curve.complete);
    content.data("dependent", guidance.curve.dependent);
    content.data("pairs_tried", guidance.pairs);
    add_guiding_link_data(content.array("slides"), guidance.curve.slides, units);
    const auto& points = guidance.curve.links;
    Table& curve = content.table("curve", "", Rows::columns, Verbosity::data);
    curve.counts("arc", "", each(points, [](const CentreCurve::Point& p) { return static_cast<double>(p.arc); }));
    const auto column = [&](const char* key, auto of) {
      curve.data(key, each(points, [&](const CentreCurve::Point& p) { return as_length(of(p.link), units); }));
    };
    column("pivot_x", [](const GuidingDyad& d) { return d.fixed.x; });
    column("pivot_y", [](const GuidingDyad& d) { return d.fixed.y; });
    column("pin_x", [](const GuidingDyad& d) { return d.moving.x; });
    column("pin_y", [](const GuidingDyad& d) { return d.moving.y; });
    column("length", [](const GuidingDyad& d) { return d.length; });
  }
}

std::string wishes_in_words(const FourBarWishes& wishes) {
  return wishes.kind || wishes.within ? ", as asked for" : "";
}

Line verdict_of_five(const PoseTask& task, const Guidance& guidance) {
  const FiveDyads& five = guidance.five;
  if (five.dependent) {
    return bad("The poses do not determine the links: infinitely many may guide the body through them.");
  }
  const int links = static_cast<int>(guidance.links.size());
  const int four_bars = static_cast<int>(guidance.four_bars.size());
  const std::string all = five.complete ? "all that there are: proved" : "not proved to be all";
  if (links == 0 && five.complete) return bad("No link guides the body through the five poses: proved.");
  if (links == 0) return bad("No link was found that guides the body through the five poses; not proved.");
  const std::string found = fmt::format("{} and {} through the five poses, {}. ", count(links, "link", "links"),
                                        count(four_bars, "four-bar", "four-bars"), all);
  if (four_bars == 0) return bad(found + "One link is not enough, and slides make no four-bar.");
  const int good_ones = static_cast<int>(std::count_if(guidance.four_bars.begin(), guidance.four_bars.end(),
                                                       [](const GuidingFourBar& f) { return f.suits(); }));
  const std::string passes = (good_ones > 1 ? "pass" : "passes") + std::string(" them in order without a defect") +
                             wishes_in_words(task.wishes) + ".";
  return good_ones == 0 ? bad(found + "None " + passes) : good(found + std::to_string(good_ones) + " " + passes);
}

std::string defect_in_words(const Guidance& guidance) {
  if (guidance.four_bars.empty()) return "give no four-bar";
  const GuidingFourBar& only = guidance.four_bars.front();
  if (only.passage.defect == Defect::undecided) return "give one at a dead point, where nothing is decided";
  if (only.passage.defect != Defect::none) {
    return fmt::format("give one with a defect: {}", to_string(only.passage.defect));
  }
  return "give one that passes the poses in order without a defect, but not as asked for";
}

Line verdict_of_four(const PoseTask& task, const Guidance& guidance) {
  const CentreCurve& curve = guidance.curve;
  if (curve.dependent) return bad("The poses leave no curve of pivots: infinitely many links may guide the body.");
  const std::string found = fmt::format("The curve of pivots has {}{}. ", count(curve.arcs, "arc", "arcs"),
                                        curve.complete ? ", all of them: proved" : "; not proved to be all");
  const bool any = guidance.best >= 0;
  if (!task.near.empty()) {
    if (any) return good(found + "Its points nearest to those asked for pass the poses in order without a defect.");
    return bad(found + "Its points nearest to those asked for " + defect_in_words(guidance) + ".");
  }
  const std::string tried = fmt::format("of {}{} of its points", guidance.interrupted ? "the first " : "",
                                        count(static_cast<int>(guidance.pairs), "pair", "pairs"));
  const std::string passes = "passes the poses in order without a defect" + wishes_in_words(task.wishes) + ".";
  return any ? good(found + "The best " + tried + " " + passes) : bad(found + "None " + tried + " " + passes);
}

Line verdict_of_three(const Guidance& guidance) {
  if (guidance.links.size() < 2) return bad("A point that was given has its three places on a line: no link to it.");
  if (guidance.best >= 0) return good("The four-bar of the points given passes the poses in order without a defect.");
  return bad("The points given " + defect_in_words(guidance) + ".");
}

void add_chosen(Group& content, int best, const std::optional<ChosenFourBar>& chosen, bool confirmed) {
  if (!chosen) return;
  content.fact("best", fmt::format("no. {}, its input from {} to {}{}", best + 1, as_degrees(chosen->from),
                                   as_degrees(chosen->to), confirmed ? ", confirmed by the general kinematics" : ""));
}

std::string number_of_solutions(const FunctionAnswer& answer) {
  const int number = static_cast<int>(answer.linkages.size());
  const std::string all = answer.found.complete ? "all that there are: proved" : "not proved to be all";
  return fmt::format("{}, {}. ",
                     count(number, "four-bar has the pairs of angles", "four-bars have the pairs of angles"), all);
}

Line verdict_of_function(const FunctionSynthesis& task, const FunctionAnswer& answer) {
  if (answer.found.dependent)
    return bad("The pairs of angles do not determine the four-bar: they depend on each other.");
  if (answer.linkages.empty()) {
    return bad(answer.found.complete ? "No four-bar has the pairs of angles: proved."
                                     : "No four-bar was found that has the pairs of angles; not proved.");
  }
  const std::string found = number_of_solutions(answer);
  if (answer.best < 0) {
    return bad(found + fmt::format("None moves over the range without a defect{}.", task.kind ? ", as asked for" : ""));
  }
  const GeneratedFunction& best = answer.linkages[static_cast<std::size_t>(answer.best)];
  if (!best.error) return good(found + "The best one moves over the range without a defect.");
  // Rounded up, so that it is a bound as it is written.
  const double bound = (best.error->proved ? best.error->bound : best.error->largest) / degree_of_synthesis;
  const double unit = std::pow(10.0, std::floor(std::log10(bound)) + 1 - digits_of_angles);
  return good(found + fmt::format("The best one is wrong by {} deg at most, {}.",
                                  significant(std::ceil(bound / unit) * unit, digits_of_angles),
                                  best.error->proved ? "proved" : "not proved"));
}

void add_function_table(Group& content, const FunctionAnswer& answer, const Units& units) {
  const auto& found = answer.linkages;
  if (found.empty()) return;
  const auto column = [&](auto of) { return each(found, [&](const GeneratedFunction& g) { return of(g.linkage); }); };
  Table& table = content.table("", fmt::format("Four-bars ({})", units.length_name), Rows::list);
  table.counts("", "no.", row_numbers(found.size()));
  const auto angle = [&](double FunctionLinkage::*of) {
    return column([&](const FunctionLinkage& l) { return l.*of / degree_of_synthesis; });
  };
  const auto length = [&](double FunctionLinkage::*of) {
    return column([&](const FunctionLinkage& l) { return as_length(l.*of, units); });
  };
  table.numbers("", "input start", "deg", angle(&FunctionLinkage::input_start), of_lengths);
  table.numbers("", "output start", "deg", angle(&FunctionLinkage::output_start), of_lengths);
  table.numbers("", "input", "", length(&FunctionLinkage::input), of_lengths);
  table.numbers("", "coupler", "",
                column([&](const FunctionLinkage& l) { return as_length(l.linkage.coupler, units); }), of_lengths);
  table.numbers("", "output", "", length(&FunctionLinkage::output), of_lengths);
  table.footnotes.emplace_back("a link of negative length is drawn half a turn on");
  Table& moves = content.table("", "How they move", Rows::list);
  moves.counts("", "no.", row_numbers(found.size()));
  moves.words("", "kind", column([](const FunctionLinkage& l) { return to_string(grashof_kind(l.linkage)); }));
  add_passages(moves, found, [](const GeneratedFunction& g) -> const Passage& { return g.linkage.passage; });
  const bool any_error = std::any_of(found.begin(), found.end(), [](const auto& g) { return g.error.has_value(); });
  if (!any_error) return;
  const auto error = [&](double StructuralError::*of, double unit) {
    return each(found, [&](const GeneratedFunction& g) {
      return g.error ? *g.error.*of / unit : std::numeric_limits<double>::quiet_NaN();
    });
  };
  moves.numbers("", "largest error", "deg", error(&StructuralError::largest, degree_of_synthesis), of_angles);
  moves.numbers("", "at x", "", error(&StructuralError::at, 1.0), of_angles);
}

void add_function_data(Group& content, const FunctionSynthesis& task, const FunctionAnswer& answer,
                       const Units& units) {
  content.data("complete", answer.found.complete);
  content.data("dependent", answer.found.dependent);
  content.data("complex", answer.found.complete ? Value(answer.found.complex) : Value());
  content.data("infinite", answer.found.infinite);
  content.data("points", task.points);
  Table& pairs = content.table("pairs", "", Rows::columns, Verbosity::data);
  pairs.data("input", each(task.task.turns, [](const Vec2& t) { return t.x / degree_of_synthesis; }));
  pairs.data("output", each(task.task.turns, [](const Vec2& t) { return t.y / degree_of_synthesis; }));
  Branch& four_bars = content.array("four_bars");
  for (const GeneratedFunction& g : answer.linkages) {
    Group& one = four_bars.parts.emplace_back();
    one.data("input_start", g.linkage.input_start / degree_of_synthesis);
    one.data("output_start", g.linkage.output_start / degree_of_synthesis);
    one.data("signed_input", as_length(g.linkage.input, units));
    one.data("signed_output", as_length(g.linkage.output, units));
    add_four_bar_data(one, g.linkage.linkage, units);
    one.data("proved", g.linkage.proved);
    one.data("misfit", g.linkage.misfit / degree_of_synthesis);
    one.data("closure", g.linkage.closure == 0 ? Value() : Value(g.linkage.closure));
    one.data("wanted", !task.kind || *task.kind == grashof_kind(g.linkage.linkage));
    add_passage_data(one, g.linkage.passage);
    const auto& error = g.error;
    one.data("largest_error", error ? Value(error->largest / degree_of_synthesis) : Value());
    one.data("largest_error_at", error ? Value(error->at) : Value());
    one.data("error_bound", error && error->proved ? Value(error->bound / degree_of_synthesis) : Value());
  }
  content.data("best", answer.best < 0 ? Value() : Value(answer.best + 1));
}

}  // namespace

FunctionAnswer generate(const FunctionSynthesis& task) {
  FunctionAnswer out;
  out.found = linkages_for(task.task);
  const auto merit = [](const GeneratedFunction& g) {
    return g.error ? -g.error->largest : g.linkage.passage.transmission;
  };
  for (const FunctionLinkage& linkage : out.found.linkages) {
    GeneratedFunction one{linkage, {}, false};
    if (task.wanted) one.error = structural_error(linkage, *task.wanted);
    one.suits = linkage.passage.defect == Defect::none && (!task.kind || *task.kind == grashof_kind(linkage.linkage));
    out.linkages.push_back(one);
    const bool is_best =
        one.suits && (out.best < 0 || merit(one) > merit(out.linkages[static_cast<std::size_t>(out.best)]));
    if (is_best) out.best = static_cast<int>(out.linkages.size()) - 1;
  }
  return out;
}

std::optional<ChosenFourBar> chosen_of(const Guidance& guidance) {
  if (guidance.best < 0) return std::nullopt;
  const GuidingFourBar& best = guidance.four_bars[static_cast<std::size_t>(guidance.best)];
  const auto start = pose_of(best.linkage, best.passage.from, best.positions.front().closure);
  if (!start) return std::nullopt;
  return ChosenFourBar{best.linkage, *start, best.passage.from, best.passage.to};
}

std::optional<ChosenFourBar> chosen_of(const FunctionAnswer& answer) {
  if (answer.best < 0) return std::nullopt;
  const FunctionLinkage& best = answer.linkages[static_cast<std::size_t>(answer.best)].linkage;
  const auto start = pose_of(best.linkage, best.passage.from, best.closure);
  if (!start) return std::nullopt;
  return ChosenFourBar{best.linkage, *start, best.passage.from, best.passage.to};
}

Result guidance_result(const SynthesisProblem& problem, const PoseTask& task, const Guidance& guidance,
                       const std::optional<ChosenFourBar>& chosen, bool confirmed) {
  Result out = begun(problem, "poses", guidance.best >= 0);
  const std::size_t poses = task.positions.size();
  out.verdict = poses == 5   ? verdict_of_five(task, guidance)
                : poses == 4 ? verdict_of_four(task, guidance)
                             : verdict_of_three(guidance);
  if (chosen && !confirmed) {
    out.warnings.push_back(doubtful("The general kinematics did not drive the best four-bar through its poses."));
  }
  add_guidance_data(out.content, guidance, poses, problem.units);
  out.content.data("confirmed", confirmed);
  add_chosen(out.content, guidance.best, chosen, confirmed);
  if (chosen) {
    const double frame =
        std::remainder(task.positions.front().angle - chosen->start.coupler_angle, 2 * std::numbers::pi);
    out.content.fact("frame",
                     fmt::format("the body's x axis is {} from the line of the coupler's pins", as_degrees(frame)));
    out.content.data("frame_angle", frame / degree_of_synthesis);
  }
  add_guiding_links(out.content, "Links", guidance.links, problem.units);
  add_guiding_four_bars(out.content, guidance, problem.units);
  add_guiding_links(out.content, "Slides through the four poses", guidance.curve.slides, problem.units);
  return out;
}

Result function_result(const SynthesisProblem& problem, const FunctionSynthesis& task, const FunctionAnswer& answer,
                       const std::optional<ChosenFourBar>& chosen, bool confirmed) {
  Result out = begun(problem, "function", answer.best >= 0);
  out.verdict = verdict_of_function(task, answer);
  if (chosen && !confirmed) {
    out.warnings.push_back(doubtful("The general kinematics did not drive the best four-bar over its range."));
  }
  add_function_data(out.content, task, answer, problem.units);
  out.content.data("confirmed", confirmed);
  add_chosen(out.content, answer.best, chosen, confirmed);
  if (!task.points.empty()) {
    std::string points;
    for (const double x : task.points) points += (points.empty() ? "" : ", ") + significant(x, digits_of_four_bars);
    out.content.fact("exact at x", points);
  }
  add_function_table(out.content, answer, problem.units);
  return out;
}

std::vector<Panel> guidance_panels(const SynthesisProblem& problem, const Guidance& guidance) {
  if (guidance.curve.links.empty()) return {};
  const std::string unit = " (" + problem.units.length_name + ")";
  Panel panel{.title = "Curve of centres: pivots of links through the four poses",
              .x_label = "x" + unit,
              .y_label = "y" + unit};
  for (const CentreCurve::Point& point : guidance.curve.links) {
    if (static_cast<int>(panel.curves.size()) < point.arc) panel.curves.push_back({.name = "", .colour = 0});
    Curve& arc = panel.curves.back();
    arc.x.push_back(as_length(point.link.fixed.x, problem.units));
    arc.y.push_back(as_length(point.link.fixed.y, problem.units));
  }
  for (std::size_t k = 0; k < guidance.links.size(); ++k) {
    const Vec2& at = guidance.links[k].fixed;
    panel.marks.push_back({as_length(at.x, problem.units), as_length(at.y, problem.units), std::to_string(k + 1)});
  }
  return {panel};
}

std::vector<Panel> function_panels(const FunctionAnswer& answer) {
  if (answer.best < 0) return {};
  const auto& error = answer.linkages[static_cast<std::size_t>(answer.best)].error;
  if (!error) return {};
  Curve curve{.name = ""};
  for (const Vec2& at : error->curve) {
    curve.x.push_back(at.x);
    curve.y.push_back(at.y / degree_of_synthesis);
  }
  return {{.title = "Structural error", .x_label = "x", .y_label = "error (deg)", .curves = {curve}}};
}

}  // namespace poise::app
