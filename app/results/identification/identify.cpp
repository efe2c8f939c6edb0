#include "app/results/identification/identify.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"
#include "app/results/identification/fitted_numbers.hpp"
#include "app/results/parts.hpp"
#include "identification/assessment/residuals.hpp"
#include "model/one_line.hpp"
#include "solvers/not_a_number.hpp"

namespace poise::app {
namespace {

constexpr int residual_digits = 3;
// An estimate that differs by more standard errors from the truth of a simulation is marked.
constexpr double remarkable_sigmas = 4.0;
int withheld(const Fit& fitted) {
  return static_cast<int>(
      std::count_if(fitted.estimates.begin(), fitted.estimates.end(), [](const Estimate& e) { return e.withheld; }));
}

std::vector<double> in_units(const std::vector<double>& rms, const Experiment& experiment) {
  std::vector<double> out;
  for (std::size_t k = 0; k < rms.size(); ++k) {
    out.push_back(rms[k] / experiment.sensors[k].dimension().unit(experiment.scene.units));
  }
  return out;
}

/// Freedoms where the runs start.
void add_mobilities(Group& content, const FitProblem& problem) {
  Branch& runs = content.array("mobility");
  for (std::size_t r = 0; r < problem.experiment().runs.size(); ++r) {
    Group& one = runs.parts.emplace_back();
    one.data("run", problem.run(r).run().name);
    add_freedoms(one, problem.run(r).mobility());
  }
}

std::string kind_in_words(StandardErrors::Kind kind) {
  switch (kind) {
    case StandardErrors::Kind::white:
      return "readings";
    case StandardErrors::Kind::serial:
      return "series";
    case StandardErrors::Kind::runs:
      return "runs";
  }
  return "";
}

bool all_noise_estimated(const FitProblem& problem, const Fit& fitted) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  return fitted.weighting.loss == Loss::student ||
         std::none_of(sensors.begin(), sensors.end(), [](const Sensor& s) { return s.noise_known; });
}

/// What explains a misfit, or why there is no fit: "; the sensor "phi2" counts the other way (factor = -1 in the sensor
/// "phi2"), 1.01 times the noise then; or ..."
std::string causes_in_words(const Identification& answer) {
  if (answer.has_wrong_records()) return "; the records have faults, which are named below";
  if (answer.causes.empty() && answer.misfit) {
    return answer.sought == Identification::Sought::yes           ? "; none of the usual causes explains it"
           : answer.sought == Identification::Sought::interrupted ? "; the search for its cause was interrupted"
                                                                  : "; its cause was not sought";
  }
  std::string out;
  for (const MisfitCause& cause : answer.causes) {
    out += fmt::format("{}{} ({}), {} times the noise then", out.empty() ? "; " : "; or ", cause.words, cause.cure,
                       significant(cause.over_noise, residual_digits));
  }
  return out;
}

Line verdict(const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  if (answer.misfit && fitted.usable()) {
    return bad(fmt::format("Gross misfit: {}{}.", answer.misfit->words, causes_in_words(answer)));
  }
  if (answer.has_wrong_records() && fitted.usable()) {
    return bad("Converged, but on records with faults, which are named below: what follows is no measurement.");
  }
  const bool independent = std::all_of(fitted.runs.begin(), fitted.runs.end(),
                                       [](const RunFit& run) { return run.is_white() && !run.is_shifted(); });
  switch (fitted.status) {
    case FitStatus::converged:
      if (all_noise_estimated(problem, fitted)) {
        return independent
                   ? good("Converged, with the noise estimated from the residuals.")
                   : doubtful(
                         "Converged, with the noise estimated from the residuals; these are no independent noise.");
      }
      if (std::any_of(fitted.errors.sensors.begin(), fitted.errors.sensors.end(),
                      [](const NoiseTest& test) { return test.size > test.expected() * (1 + test.reach()); })) {
        return doubtful(
            "Converged: residuals are larger than the stated noise makes in 19 of 20 fits; an error of the model or of "
            "a sensor may hide in it.");
      }
      return independent ? good("Converged: residuals agree with the stated noise.")
                         : doubtful("Converged: residuals are as large as the stated noise, but no independent noise.");
    case FitStatus::misfit:
      return doubtful(fmt::format("Converged with a misfit: {}.", fitted.why));
    case FitStatus::ambiguous:
      return bad(fmt::format("Ambiguous: {}.", fitted.why));
    case FitStatus::not_run:
    case FitStatus::failed:
    case FitStatus::interrupted:
      break;
  }
  return bad(fmt::format("No fit: {}{}.", fitted.why,
                         fitted.status == FitStatus::failed ? causes_in_words(answer) : std::string()));
}

/// "Run \"low\" disagrees with the others: without it k changes by +2.3 standard errors.": the number it changes most.
std::string disagreement_in_words(const FitProblem& problem, const Fit& fitted, std::size_t run) {
  std::size_t most = 0;
  double largest = -1.0;
  for (std::size_t p = 0; p < fitted.errors.error.size(); ++p) {
    const double change = std::abs(fitted.errors.without_run[run][p]) / fitted.errors.error[p];
    if (change > largest) {
      largest = change;
      most = p;
    }
  }
  return fmt::format("Run \"{}\" disagrees with the others: without it {} changes by {:+.1f} standard errors.",
                     problem.run(run).run().name, problem.parameters()[most].name,
                     fitted.errors.without_run[run][most] / fitted.errors.error[most]);
}

/// Of a standard error that is mostly due to what a load did between its readings: the estimate where it is so most.
std::optional<std::string> coarse_input_in_words(const Fit& fitted, const KnownEffect& effect) {
  const double from = std::sqrt(0.5);  // of the standard error
  const Estimate* most = nullptr;
  double largest = from;
  for (std::size_t p = 0; p < fitted.estimates.size(); ++p) {
    const Estimate& e = fitted.estimates[p];
    const double part = std::abs(effect.change[p]) / e.standard_error;
    if (e.withheld || !(part > largest)) continue;
    largest = part;
    most = &e;
  }
  if (most == nullptr) return std::nullopt;
  return fmt::format("Input {}: more than half of the variance of {} is due to it; read that input faster.",
                     effect.name, most->name);
}

/// "2 of 6 runs, most in \"low\"", of `size` in each, 0 where it is not remarkable; empty where it is so in none.
std::string runs_in_words(const FitProblem& problem, const std::vector<double>& size) {
  const auto some = std::count_if(size.begin(), size.end(), [](double x) { return x > 0; });
  if (some == 0) return "";
  const auto most = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  std::string name = fmt::format("run \"{}\"", one_line(problem.run(most).run().name));
  if (some == 1) return name;
  return fmt::format("{} of {} runs, most in {}", some, size.size(), name);
}

/// What residuals have that independent noise has not, sensor by sensor.
void add_patterns(std::vector<Line>& out, const FitProblem& problem, const Fit& fitted) {
  const Experiment& experiment = problem.experiment();
  const std::vector<std::string> inputs = exact_inputs(experiment);
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    std::vector<double> correlated, shifted;
    double most = 0.0;  // SI
    for (const RunFit& run : fitted.runs) {
      correlated.push_back(run.correlated[k] ? std::abs(run.autocorrelation[k]) : 0.0);
      shifted.push_back(run.shifted[k] ? std::abs(run.mean[k]) : 0.0);
      if (shifted.back() > std::abs(most)) most = run.mean[k];
    }
    const std::string where = runs_in_words(problem, correlated);
    if (!where.empty()) {
      out.push_back(doubtful(fmt::format(
          "Residuals of {} are correlated from one reading to the next in {}: the model "
          "is incomplete, {}.",
          sensor.name, where,
          inputs.empty()
              ? "or the noise is not white"
              : fmt::format("the noise is not white, or inputs have errors ({})", fmt::join(inputs, ", ")))));
    }
    const std::string off = runs_in_words(problem, shifted);
    if (!off.empty()) {
      out.push_back(
          doubtful(fmt::format("Residuals of {} are off on one side, by {:+.3g} {} on average, in {}: its zero "
                               "may be wrong, or the model is incomplete.",
                               sensor.name, most / sensor.dimension().unit(experiment.scene.units),
                               sensor.dimension().unit_name(experiment.scene.units), off)));
    }
  }
}

std::vector<Line> warnings(const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  std::vector<Line> out;
  if (answer.bootstrap && answer.bootstrap->interrupted) {
    out.push_back(bad(
        fmt::format("The bootstrap was interrupted after {}.", count(answer.bootstrap->samples, "sample", "samples"))));
  }
  for (std::size_t r = 0; r < problem.experiment().runs.size(); ++r) {
    const RunModel& run = problem.run(r);
    if (!run.mobility().is_shaky()) continue;
    out.push_back(
        doubtful(fmt::format("At the start of run \"{}\" {}.", run.run().name, shaky_in_words(run.mobility()))));
  }
  for (const RecordFault& fault : answer.faults) {
    std::string words = fmt::format("{}; {}.", fault.words, fault.cure);
    words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
    out.push_back(fault.is_wrong ? bad(words) : doubtful(words));
  }
  if (!fitted.usable()) return out;
  if (!fitted.unexamined.empty()) {
    out.push_back(doubtful(
        fmt::format("Not all examined, to save time: {}. Intervals may be too short, and other minima exist; {}.",
                    fmt::join(fitted.unexamined, ", "), "--thorough examines all")));
  }
  if (withheld(fitted) > 0) {
    const std::string all = count(static_cast<int>(fitted.estimates.size()), "estimate", "estimates");
    out.push_back(bad(fmt::format("Withheld: {} of {}, see below.", withheld(fitted), all)));
  }
  const auto poorly = std::count_if(fitted.estimates.begin(), fitted.estimates.end(),
                                    [](const Estimate& e) { return !e.withheld && e.poorly_determined; });
  if (poorly > 0) {
    out.push_back(doubtful(fmt::format("Poorly determined: {} of {}.", poorly,
                                       count(static_cast<int>(fitted.estimates.size()), "estimate", "estimates"))));
  }
  add_patterns(out, problem, fitted);
  if (fitted.errors.runs_scatter) {
    out.push_back(
        doubtful("The runs differ by more than their residuals explain, as where the model is incomplete; the standard "
                 "errors contain that scatter."));
  }
  for (std::size_t r = 0; r < fitted.errors.disagreement.size(); ++r) {
    if (fitted.errors.disagreement[r] < disagrees_from) continue;
    out.push_back(doubtful(disagreement_in_words(problem, fitted, r)));
  }
  for (const KnownEffect& effect : answer.inputs) {
    if (const auto words = coarse_input_in_words(fitted, effect)) out.push_back(doubtful(*words));
  }
  if (!fitted.outliers.empty()) {
    std::vector<std::size_t> runs;
    for (const Outlier& outlier : fitted.outliers) {
      if (runs.empty() || runs.back() != outlier.run) runs.push_back(outlier.run);
    }
    out.push_back(doubtful(fmt::format(
        "Outliers: {} in {}, listed below{}.", count(static_cast<int>(fitted.outliers.size()), "reading", "readings"),
        count(static_cast<int>(runs.size()), "run", "runs"),
        fitted.weighting.loss == Loss::squares && noisy_inputs(problem.experiment()).empty()
            ? "; loss = \"huber\", \"cauchy\" or \"student\" limits their effect"
            : "")));
  }
  if (!fitted.identifiability.ok) {
    out.push_back(bad("Standard errors are not known: " + fitted.identifiability.why + "."));
  }
  return out;
}

/// Its ends with the digits of the standard error.
std::string interval_in_words(const Estimate& e) {
  const double error = e.standard_error / e.unit;
  return fmt::format("{} to {}", rounded_to(e.low / e.unit, error), rounded_to(e.high / e.unit, error));
}

const std::vector<double>& errors_of(const StandardErrors& errors, StandardErrors::Kind kind) {
  return kind == StandardErrors::Kind::white    ? errors.white
         : kind == StandardErrors::Kind::serial ? errors.serial
                                                : errors.runs;
}

void add_estimates(Group& group, const FitProblem& problem, const Fit& fitted) {
  const std::vector<Estimate>& rows = fitted.estimates;
  const bool known = fitted.identifiability.ok && fitted.usable();
  const bool any = withheld(fitted) < static_cast<int>(rows.size());
  const bool simulated = problem.experiment().is_simulated();
  // What is withheld has no number, and no text in the columns behind the estimate.
  const auto number = [&](double Estimate::*si, bool there) {
    return each(rows, [&](const Estimate& e) { return e.withheld || !there ? NAN : e.*si / e.unit; });
  };
  const auto text = [&](auto&& of) {
    return each(rows, [&](const Estimate& e) { return e.withheld ? std::string() : of(e); });
  };
  const auto difference_of = [](const Estimate& e) { return (e.value - e.truth) / e.standard_error; };
  Table& table = group.table("estimates", fitted.usable() ? "Estimates" : "Values reached, no estimates", Rows::list);
  table.words("name", "parameter", each(rows, &Estimate::name));
  table.words("path", "", each(places(rows.size()), [&](std::size_t i) { return problem.unknown_of(i).path; })).shown =
      false;
  table.words("unknown", "", each(places(rows.size()), [&](std::size_t i) { return problem.unknown_of(i).name; }))
      .shown = false;
  table.data("unit_si", each(rows, &Estimate::unit));
  table
      .words("", "estimate",
             each(rows,
                  [&](const Estimate& e) {
                    return e.withheld ? "withheld"
                                      : rounded_to(e.value / e.unit, known ? e.standard_error / e.unit : 0.0);
                  }))
      .tones = each(rows, [](const Estimate& e) { return e.withheld ? Tone::bad : Tone::plain; });
  table.data("value", number(&Estimate::value, true));
  table.data("scene_value", each(places(rows.size()), [&](std::size_t i) {
               return rows[i].withheld && !rows[i].at_bound ? not_a_number : fitted.parameters[i] / rows[i].unit;
             }));
  Column& errors = table.numbers("standard_error", "standard error", "", number(&Estimate::standard_error, known));
  errors.texts = text([&](const Estimate& e) { return significant(known ? e.standard_error / e.unit : NAN, 2); });
  errors.shown = any && fitted.usable();
  Column& per_cents = table.numbers("", "per cent", "", {});
  per_cents.texts = text([&](const Estimate& e) {
    return known ? per_cent(e.standard_error, simulated && e.truth == 0 ? 0.0 : e.value) : "-";
  });
  per_cents.shown = any && fitted.usable();
  Column& interval = table.words(
      "", "95 % interval", text([&](const Estimate& e) { return known ? interval_in_words(e) : std::string("-"); }));
  interval.shown = any && known;
  table.data("low", number(&Estimate::low, known));
  table.data("high", number(&Estimate::high, known));
  for (const auto kind : {StandardErrors::Kind::white, StandardErrors::Kind::serial, StandardErrors::Kind::runs}) {
    table.data("standard_error_" + to_string(kind), each(places(rows.size()), [&](std::size_t i) {
                 return rows[i].withheld || !known ? not_a_number : errors_of(fitted.errors, kind)[i] / rows[i].unit;
               }));
  }
  table.words("unit", "unit", rows.empty() ? std::vector<std::string>{} : parameter_units(problem));
  Column& truth = table.numbers("truth", "truth", "", number(&Estimate::truth, simulated));
  truth.texts = text([&](const Estimate& e) { return significant(simulated ? e.truth / e.unit : NAN, 7); });
  truth.shown = any && simulated;
  Column& difference =
      table.words("", "error / sigma",
                  text([&](const Estimate& e) { return known ? fmt::format("{:+.1f}", difference_of(e)) : "-"; }));
  difference.tones = each(rows, [&](const Estimate& e) {
    return !e.withheld && std::abs(difference_of(e)) > remarkable_sigmas ? Tone::bad : Tone::plain;
  });
  difference.shown = any && simulated && fitted.usable();
  table.flags("poorly_determined",
              each(rows, [&](const Estimate& e) -> bool { return !e.withheld && e.poorly_determined; }));
  table.remarks(each(rows,
                     [](const Estimate& e) {
                       if (e.withheld) return e.why;
                       std::string out = e.poorly_determined ? "poorly determined" : e.is_curved ? "curved" : "";
                       if (e.may_be_zero()) out += out.empty() ? "not different from 0" : ", not different from 0";
                       return out;
                     }),
                Tone::bad);
  table.flags("curved", each(rows, [](const Estimate& e) -> bool { return !e.withheld && e.is_curved; }));
  table.flags("may_be_zero", each(rows, [](const Estimate& e) -> bool { return !e.withheld && e.may_be_zero(); }));
  table.flags("at_bound", each(rows, [](const Estimate& e) { return e.at_bound ? 1.0 : 0.0; }));
  Column& why = table.words("withheld", "", each(rows, &Estimate::why));
  why.kind = Column::Kind::word_or_null;
  why.shown = false;
}

/// Where intervals do not follow from the parabola at the minimum.
void add_traces(Group& content, const FitProblem& problem, const Fit& fitted) {
  Branch& array = content.array("traces");
  const auto name = [&](const CostTrace& trace) {
    return problem.parameters()[static_cast<std::size_t>(trace.held)].name;
  };
  for (const CostTrace& trace : fitted.traces) {
    Group& one = array.parts.emplace_back();
    one.data("name", name(trace));
    one.data("slower_low", trace.slow_low);
    one.data("slower_high", trace.slow_high);
    one.data("open_low", trace.open_low);
    one.data("open_high", trace.open_high);
  }
  if (fitted.traces.empty()) return;
  const auto side = [](double slower, bool open) { return significant(slower, 2) + (open ? ", without an end" : ""); };
  Group& section = content.group("", "The cost is no parabola: by how much more slowly it grows");
  section.note("one parameter held, all others fitted anew; the intervals above contain what the estimates do there");
  Table& table = section.table("", "", Rows::list);
  table.words("", "held", each(fitted.traces, name));
  table.words("", "below", each(fitted.traces, [&](const CostTrace& t) { return side(t.slow_low, t.open_low); }));
  table.words("", "above", each(fitted.traces, [&](const CostTrace& t) { return side(t.slow_high, t.open_high); }));
}

/// What later predictions are uncertain by, with the effect of known numbers on the standard errors.
void add_covariance(Group& content, const Fit& fitted) {
  Table& table = content.table("covariance", "", Rows::by_name, Verbosity::data);
  if (fitted.errors.error.empty() || !fitted.usable()) return;
  const std::vector<Estimate>& rows = fitted.estimates;
  const auto larger = [&](std::size_t i) { return rows[i].standard_error / fitted.errors.error[i] / rows[i].unit; };
  table.words("name", "", each(rows, &Estimate::name));
  for (std::size_t j = 0; j < rows.size(); ++j) {
    table.data(rows[j].name, each(places(rows.size()), [&](std::size_t i) {
                 const double covariance =
                     fitted.errors.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
                 if (rows[i].at_bound || rows[j].at_bound) return 0.0;
                 return rows[i].withheld || rows[j].withheld ? not_a_number : covariance * larger(i) * larger(j);
               }));
  }
}

/// The values of every minimum side by side, the best one first.
void add_alternatives(Group& content, const FitProblem& problem, const Fit& fitted) {
  Branch& all = content.array("alternatives");
  for (const Alternative& one : fitted.alternatives) {
    Group& data = all.parts.emplace_back();
    Group& values = data.group("values", "", Verbosity::data);
    for (std::size_t i = 0; i < one.values.size(); ++i) {
      values.data(fitted.estimates[i].name, one.values[i] / fitted.estimates[i].unit);
    }
    data.data("frequencies", one.frequency);
    data.data("more", one.more);
  }
  if (fitted.alternatives.empty()) return;
  constexpr std::size_t most_shown = 6;
  std::vector<std::string> names = each(fitted.estimates, &Estimate::name);
  std::vector<std::string> units = parameter_units(problem);
  std::size_t modes = fitted.alternatives.front().frequency.size();
  for (const Alternative& one : fitted.alternatives) modes = std::min(modes, one.frequency.size());
  for (std::size_t k = 0; k < modes; ++k) {
    names.push_back(modes > 1 ? fmt::format("frequency {} of the first run", k + 1) : "frequency of the first run");
    units.emplace_back("Hz");
  }
  names.emplace_back("sum of squares, more than least");
  units.emplace_back("σ²");
  const std::size_t shown = std::min(most_shown, fitted.alternatives.size());
  Table& table = content.table(
      "", fmt::format("Minima that explain the readings equally well, {} of {}", shown, fitted.alternatives.size()),
      Rows::list);
  table.words("", "parameter", names);
  for (std::size_t a = 0; a < shown; ++a) {
    const Alternative& one = fitted.alternatives[a];
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < one.values.size(); ++i) {
      texts.push_back(significant(one.values[i] / fitted.estimates[i].unit, 5));
    }
    for (std::size_t k = 0; k < modes; ++k) texts.push_back(significant(one.frequency[k], 4));
    texts.push_back(significant(one.more, 3));
    table.numbers("", fmt::format("{}", a + 1), "", {}).texts = std::move(texts);
  }
  table.words("unit", "unit", units);
}

/// The standard errors under each assumption about the residuals, where they are not white.
void add_standard_errors(Group& content, const Fit& fitted) {
  if (fitted.errors.error.empty() || !fitted.usable()) return;
  content.data("standard_errors", to_string(fitted.errors.leading));
  content.data("standard_errors_why", fitted.errors.why);
  if (fitted.errors.leading == StandardErrors::Kind::white) return;
  Group& section = content.group("", "Standard errors by what is taken for independent");
  section.note("shown above: " + kind_in_words(fitted.errors.leading) + ", since " + fitted.errors.why);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < fitted.estimates.size(); ++i) {
    if (!fitted.estimates[i].withheld) rows.push_back(i);
  }
  Table& table = section.table("", "", Rows::list);
  table.words("", "parameter", each(rows, [&](std::size_t i) { return fitted.estimates[i].name; }));
  for (const auto kind : {StandardErrors::Kind::white, StandardErrors::Kind::serial, StandardErrors::Kind::runs}) {
    table.numbers("", kind_in_words(kind), "", {}).texts = each(rows, [&](std::size_t i) {
      return significant(errors_of(fitted.errors, kind)[i] / fitted.estimates[i].unit, 2);
    });
  }
}

/// Those of several origins, one after the other.
std::vector<const KnownEffect*> all_effects(const Identification& answer) {
  std::vector<const KnownEffect*> out;
  for (const KnownEffect& effect : answer.known) out.push_back(&effect);
  for (const KnownEffect& effect : answer.inputs) out.push_back(&effect);
  return out;
}

/// What known numbers and inputs contribute to the standard errors.
void add_known(Group& content, const FitProblem& problem, const Identification& answer) {
  const std::vector<const KnownEffect*> effects = all_effects(answer);
  Branch& array = content.array("known");
  for (const KnownEffect* effect : effects) {
    Group& one = array.parts.emplace_back();
    one.data("name", effect->name);
    Group& change = one.group("change", "", Verbosity::data);
    for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
      change.data(problem.parameters()[p].name, effect->change[p] / problem.unknown_of(p).unit);
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t p = 0; p < answer.fit.estimates.size(); ++p) {
    if (!answer.fit.estimates[p].withheld) rows.push_back(p);
  }
  // What is this much less than the standard error is rounding; of an input it is not worth a column.
  constexpr double rounding = 1e-9;
  constexpr double little = 0.1;
  const auto matters = [&](const KnownEffect& effect) {
    return std::any_of(rows.begin(), rows.end(), [&](std::size_t p) {
      return std::abs(effect.change[p]) >= little * answer.fit.estimates[p].standard_error;
    });
  };
  const std::size_t numbers = answer.known.size();
  std::vector<const KnownEffect*> shown;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (i < numbers || matters(*effects[i])) shown.push_back(effects[i]);
  }
  if (shown.empty()) return;
  const bool inputs = shown.size() > numbers;
  Group& section = content.group(
      "", answer.known.empty() ? "Changes if the readings of an input are joined by a smooth curve, not by lines"
          : inputs ? "Changes by one standard deviation of the numbers taken as known, and with smooth inputs"
                   : "Changes by one standard deviation of the numbers taken as known");
  section.note("contained in the standard errors above");
  Table& table = section.table("", "", Rows::list);
  table.words("", "parameter", each(rows, [&](std::size_t p) { return answer.fit.estimates[p].name; }));
  for (const KnownEffect* effect : shown) {
    table.numbers("", effect->name, "", {}).texts = each(rows, [&](std::size_t p) {
      const Estimate& e = answer.fit.estimates[p];
      const bool none = std::abs(effect->change[p]) < rounding * e.standard_error;
      return significant(none ? 0.0 : effect->change[p] / e.unit, 2);
    });
  }
}

/// Of which residuals a bootstrap is made.
std::string blocks_in_words(const FitProblem& problem, double block) {
  if (problem.all_at_rest()) return "single readings";
  const std::string of_motions = std::isinf(block) ? "whole runs" : fmt::format("blocks of {:.3g} s", block);
  return problem.any_at_rest() ? of_motions + ", and single readings at rest" : of_motions;
}

void add_bootstrap(Group& content, const FitProblem& problem, const Identification& answer) {
  if (!answer.bootstrap || answer.bootstrap->standard_error.empty()) {
    content.data("bootstrap", Value());
    return;
  }
  const Bootstrap& found = *answer.bootstrap;
  const auto of = [&](const std::vector<double>& values, std::size_t p) {
    return answer.fit.estimates[p].withheld ? not_a_number : values[p] / problem.unknown_of(p).unit;
  };
  const std::vector<std::size_t> all = places(problem.parameters().size());
  Group& section = content.group("bootstrap", "Bootstrap of the residuals");
  section.data("samples", found.samples);
  section.data("failed", found.failed);
  section.data("block", std::isinf(found.block) ? Value() : Value(found.block));
  section.note(fmt::format("{} refitted in {}; {} failed", count(found.samples, "sample", "samples"),
                           blocks_in_words(problem, found.block), found.failed));
  Table& table = section.table("estimates", "", Rows::list);
  table.words("name", "parameter", each(all, [&](std::size_t p) { return problem.parameters()[p].name; }));
  const auto add = [&](const std::string& key, const std::string& title, const std::vector<double>& values) {
    table.numbers(key, title, "", each(all, [&](std::size_t p) { return of(values, p); })).texts =
        each(all, [&](std::size_t p) {
          return key == "standard_error" ? significant(of(values, p), 2)
                                         : rounded_to(of(values, p), of(found.standard_error, p));
        });
  };
  add("standard_error", "standard error", found.standard_error);
  add("low", "2.5 %", found.low);
  add("high", "97.5 %", found.high);
}

void add_profiles(Group& content, const FitProblem& problem, const Identification& answer) {
  Branch& array = content.array("profiles");
  for (const LikelihoodProfile& found : answer.profiles) {
    const auto p = static_cast<std::size_t>(found.parameter);
    const double unit = problem.unknown_of(p).unit;
    Group& one = array.parts.emplace_back();
    one.data("name", problem.parameters()[p].name);
    one.data("low", found.low ? Value(*found.low / unit) : Value());
    one.data("high", found.high ? Value(*found.high / unit) : Value());
    one.data("one_sided", found.one_sided);
    one.data("value", each(found.value, [&](double value) { return value / unit; }));
    one.data("growth", found.growth);
  }
  if (answer.profiles.empty()) return;
  Table& table = content.table("", "Profile likelihood: 95 % intervals", Rows::list);
  const auto end = [&](const LikelihoodProfile& found, const std::optional<double>& value) {
    const auto p = static_cast<std::size_t>(found.parameter);
    const Estimate& estimate = answer.fit.estimates[p];
    return value ? rounded_to(*value / estimate.unit, estimate.standard_error / estimate.unit) : std::string("open");
  };
  table.words("", "parameter", each(answer.profiles, [&](const LikelihoodProfile& found) {
                return problem.parameters()[static_cast<std::size_t>(found.parameter)].name;
              }));
  table.words("", "from", each(answer.profiles, [&](const LikelihoodProfile& found) { return end(found, found.low); }));
  table.words("", "to", each(answer.profiles, [&](const LikelihoodProfile& found) { return end(found, found.high); }));
  table.remarks(each(answer.profiles, [](const LikelihoodProfile& found) {
    return std::string(found.one_sided ? "one-sided, the estimate is at its bound" : "");
  }));
}

void add_runs(Group& section, const FitProblem& problem, const Fit& fitted) {
  const Experiment& experiment = problem.experiment();
  constexpr std::size_t most_sensors = 4;
  const std::size_t sensors = std::min(most_sensors, experiment.sensors.size());
  std::vector<RunFit> rows;
  for (const std::size_t r : worst_first(fitted)) rows.push_back(fitted.runs[r]);
  const auto lagged = [](const RunFit& run) {
    const std::vector<double> known = chosen_of(run.autocorrelation, [](double a) { return !std::isnan(a); });
    const auto largest = largest_by_size(known);
    return largest == known.end() ? "-" : fmt::format("{:+.3f}", *largest);
  };
  Table& table = section.table("", "Residuals of the runs: root mean squares, the worst first", Rows::list);
  table.words("", "run", each(rows, [](const RunFit& run) { return one_line(run.name); }));
  table.numbers("", "over noise", "", {}).texts =
      each(rows, [&](const RunFit& run) { return significant(rms_over_noise(fitted, run), residual_digits); });
  for (std::size_t k = 0; k < sensors; ++k) {
    const Sensor& sensor = experiment.sensors[k];
    table.numbers("", sensor.name, sensor.dimension().unit_name(experiment.scene.units), {}).texts =
        each(rows, [&](const RunFit& run) {
          return run.rms.empty() || std::isnan(run.rms[k])
                     ? "-"
                     : significant(in_units(run.rms, experiment)[k], residual_digits);
        });
  }
  table.numbers("", "autocorrelation", "", {}).texts = each(rows, lagged);
  table.words("", "", each(rows, [](const RunFit& run) { return run.is_white() ? "white" : "not white"; })).tones =
      each(rows, [](const RunFit& run) { return run.is_white() ? Tone::plain : Tone::doubtful; });
}

/// "angle 1.02, expected 1 ± 0.031 (95 %)": the tests of the verdict.
std::string over_noise_in_words(const FitProblem& problem, const Fit& fitted) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  std::string out;
  for (std::size_t k = 0; k < fitted.errors.sensors.size(); ++k) {
    const NoiseTest& test = fitted.errors.sensors[k];
    if (std::isnan(test.ratio)) continue;
    const double reach = test.expected() * test.reach();
    out += fmt::format("{}{}{}, expected {} ± {}", out.empty() ? "" : "; ",
                       sensors.size() > 1 ? sensors[k].name + " " : "", significant(test.size, 4),
                       rounded_to(test.expected(), reach), significant(reach, 2));
  }
  return out.empty() ? significant(fitted.residual_over_noise, 4) : out + " (95 %)";
}

/// Run by run and sensor by sensor: how many, the first times, the largest.
void add_outliers(Group& section, const FitProblem& problem, const Fit& fitted) {
  if (fitted.outliers.empty()) return;
  constexpr std::size_t most_times = 4;
  const Experiment& experiment = problem.experiment();
  struct Row {
    std::string run, sensor, times, largest;
    int count = 0;
  };
  std::vector<Row> rows;
  const auto& all = fitted.outliers;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i;
    while (end < all.size() && all[end].run == all[i].run && all[end].sensor == all[i].sensor) ++end;
    const auto worst =
        std::max_element(all.begin() + static_cast<std::ptrdiff_t>(i), all.begin() + static_cast<std::ptrdiff_t>(end),
                         [](const Outlier& a, const Outlier& b) { return a.size < b.size; });
    const Sensor& sensor = experiment.sensors[all[i].sensor];
    Row row{one_line(problem.run(all[i].run).run().name), sensor.name, "",
            fmt::format("{} {} {}{:.6g}{}",
                        significant(worst->residual / sensor.dimension().unit(experiment.scene.units), 3),
                        sensor.dimension().unit_name(experiment.scene.units),
                        problem.run(all[i].run).is_at_rest() ? "in row " : "at ", worst->time,
                        problem.run(all[i].run).is_at_rest() ? "" : " s"),
            static_cast<int>(end - i)};
    for (std::size_t j = i; j < std::min(end, i + most_times); ++j) {
      row.times += fmt::format("{}{:.6g}", j > i ? ", " : "", all[j].time);
    }
    if (end > i + most_times) row.times += ", ...";
    rows.push_back(std::move(row));
    i = end;
  }
  Table& table = section.table("", "Outliers: residuals above 6 times the scale of their sensor's", Rows::list);
  table.words("", "run", each(rows, &Row::run));
  table.words("", "sensor", each(rows, &Row::sensor));
  table.numbers("", "readings", "", {}).texts = each(rows, [](const Row& row) { return fmt::format("{}", row.count); });
  table.words("", "largest", each(rows, &Row::largest));
  table.words("", problem.any_at_rest() ? "times (s) or rows" : "times (s)", each(rows, &Row::times));
}

}  // namespace

void add_residuals(Group& content, const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  if (fitted.runs.empty()) return;
  const Experiment& experiment = problem.experiment();
  Group& section = content.group("", "Residuals");
  const auto white =
      std::count_if(fitted.runs.begin(), fitted.runs.end(), [](const RunFit& r) { return r.is_white(); });
  section.fact("over noise", fmt::format("{}; white in {} of {}", over_noise_in_words(problem, fitted), white,
                                         count(static_cast<int>(fitted.runs.size()), "run", "runs")));
  section.fact("rms", rms_in_words(fitted.rms, experiment));
  if (const std::vector<std::string> inputs = noisy_inputs(experiment); !inputs.empty()) {
    const double shown = fitted.weighting.input_noise;
    const std::string more = shown < 1
                                 ? fmt::format("; {:.2g} times what is stated is taken, as they show no more", shown)
                             : shown > 1 ? fmt::format("; {:.2g} times what is stated would explain them", shown)
                                         : std::string();
    section.fact("inputs",
                 fmt::format("these are less what the noise of {} does to readings{}", fmt::join(inputs, ", "), more));
  }
  if (!answer.rms_from_readings.empty() && !problem.all_at_rest()) {
    section.fact("unfitted", rms_in_words(answer.rms_from_readings, experiment) +
                                 ", with the starts estimated from the runs' first readings");
  }
  add_runs(section, problem, fitted);
  add_outliers(section, problem, fitted);
}

/// What is wrong with the records, and what may explain a misfit.
void add_misfit_data(Group& content, const FitProblem& problem, const Identification& answer) {
  const Experiment& experiment = problem.experiment();
  content.data("believable", answer.is_believable());
  if (answer.misfit) {
    Group& misfit = content.group("gross_misfit", "", Verbosity::data);
    misfit.data("sensor", experiment.sensors[answer.misfit->sensor].name);
    misfit.data("over_noise", answer.misfit->over_noise);
    misfit.data("of_signal", answer.misfit->of_signal);
  } else {
    content.data("gross_misfit", Value());
  }
  Branch& causes = content.array("causes");
  for (const MisfitCause& cause : answer.causes) {
    Group& one = causes.parts.emplace_back();
    one.data("cause", cause.words);
    one.data("cure", cause.cure);
    one.data("over_noise", cause.over_noise);
    one.data("cures", cause.cures);
  }
  Branch& faults = content.array("record_faults");
  for (const RecordFault& fault : answer.faults) {
    Group& one = faults.parts.emplace_back();
    one.data("run", experiment.runs[fault.run].name);
    one.data("sensor", experiment.sensors[fault.sensor].name);
    one.data("fault", fault.words);
    one.data("cure", fault.cure);
    one.data("wrong", fault.is_wrong);
  }
}

void add_fit_data(Group& content, const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  const Experiment& experiment = problem.experiment();
  const Units& units = experiment.scene.units;
  const bool reached = !fitted.runs.empty();
  content.data("status", to_string(fitted.status));
  content.data("why", fitted.why);
  content.data("start", fitted.start);
  content.data("degrees_of_freedom", fitted.degrees_of_freedom);
  content.data("residual_over_noise", reached ? Value(fitted.residual_over_noise) : Value());
  content.data("residual_over_noise_sigma", reached ? Value(fitted.residual_over_noise_sigma) : Value());
  content.data("iterations", fitted.iterations);
  content.data("evaluations", fitted.evaluations);
  content.data("check_evaluations", fitted.check_evaluations);
  content.data("tries", fitted.tries);
  content.data("unexamined", fitted.unexamined);
  content.data("microseconds", fitted.microseconds);
  Group& values = content.group("reached", "", Verbosity::data);
  for (std::size_t p = 0; p < fitted.parameters.size(); ++p) {
    values.data(problem.parameters()[p].name, fitted.parameters[p] / problem.unknown_of(p).unit);
  }
  Table& sensors = content.table("sensors", "", Rows::list, Verbosity::data);
  sensors.words("name", "", each(experiment.sensors, &Sensor::name));
  sensors.words("unit", "", each(experiment.sensors, [&](const Sensor& s) { return s.dimension().unit_name(units); }));
  sensors.data("unit_si", each(experiment.sensors, [&](const Sensor& s) { return s.dimension().unit(units); }));
  sensors.data("noise", each(places(experiment.sensors.size()), [&](std::size_t k) {
                 return fitted.weighting.noise[k] / experiment.sensors[k].dimension().unit(units);
               }));
  sensors.data("noise_estimated", each(experiment.sensors, [&](const Sensor& s) { return s.noise_known ? 0.0 : 1.0; }))
      .kind = Column::Kind::flag;
  const bool tested = !fitted.errors.sensors.empty();
  sensors.data("over_noise", each(places(experiment.sensors.size()), [&](std::size_t k) {
                 return tested ? fitted.errors.sensors[k].size : not_a_number;
               }));
  sensors.data("expected_over_noise", each(places(experiment.sensors.size()), [&](std::size_t k) {
                 return tested ? fitted.errors.sensors[k].expected() : not_a_number;
               }));
  const std::vector<double> compared = compared_noise(experiment, answer.records);
  sensors.data("noise_compared", each(places(experiment.sensors.size()), [&](std::size_t k) {
                 return compared[k] / experiment.sensors[k].dimension().unit(units);
               }));
  content.data("loss", to_string(fitted.weighting.loss));
  Table& outliers = content.table("outliers", "", Rows::list, Verbosity::data);
  outliers.words("run", "", each(fitted.outliers, [&](const Outlier& o) { return problem.run(o.run).run().name; }));
  outliers.words("sensor", "",
                 each(fitted.outliers, [&](const Outlier& o) { return experiment.sensors[o.sensor].name; }));
  outliers.data("time", each(fitted.outliers, [](const Outlier& o) { return o.time; }));
  outliers.data("residual", each(fitted.outliers, [&](const Outlier& o) {
                  return o.residual / experiment.sensors[o.sensor].dimension().unit(units);
                }));
  content.data("rms", in_units(fitted.rms, experiment));
  content.data("rms_from_first_readings",
               answer.rms_from_readings.empty() ? Value() : Value(in_units(answer.rms_from_readings, experiment)));
  Branch& runs = content.array("residuals");
  for (std::size_t r = 0; r < fitted.runs.size(); ++r) {
    const RunFit& run = fitted.runs[r];
    Group& one = runs.parts.emplace_back();
    one.data("name", run.name);
    one.data("rms", in_units(run.rms, experiment));
    one.data("rms_over_noise", rms_over_noise(fitted, run));
    one.data("autocorrelation", run.autocorrelation);
    one.data("white", run.is_white());
    one.data("mean", in_units(run.mean, experiment));
    one.data("shifted", run.is_shifted());
    if (!fitted.errors.disagreement.empty()) {
      one.data("disagreement", fitted.errors.disagreement[r]);
      Group& without = one.group("without_run", "", Verbosity::data);
      for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
        without.data(problem.parameters()[p].name, fitted.errors.without_run[r][p] / problem.unknown_of(p).unit);
      }
    }
    const std::vector<std::string> nuisances = problem.run(r).nuisance_names();
    const std::vector<Dimension> dimensions = problem.run(r).nuisance_dimensions();
    Group& found = one.group("nuisances", "", Verbosity::data);
    for (std::size_t i = 0; i < run.nuisances.size(); ++i) {
      found.data(nuisances[i], run.nuisances[i] / dimensions[i].unit(units));
    }
  }
}

std::string rms_in_words(const std::vector<double>& rms, const Experiment& experiment) {
  const Units& units = experiment.scene.units;
  const std::vector<double> shown = in_units(rms, experiment);
  std::string text;
  double squares = 0.0;
  int angles = 0;
  for (std::size_t k = 0; k < rms.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    text += fmt::format("{}{} {} {}", k > 0 ? ", " : "", sensor.name, significant(shown[k], residual_digits),
                        sensor.dimension().unit_name(units));
    if (!sensor.reads_angle()) continue;
    squares += rms[k] * rms[k];
    ++angles;
  }
  if (angles < 2) return text;
  return text + fmt::format("; all angles {} {}",
                            significant(std::sqrt(squares / angles) / units.angle, residual_digits), units.angle_name);
}

Result identify_result(const FitProblem& problem, const Identification& answer,
                       const std::vector<std::string>& settings) {
  const Fit& fitted = answer.fit;
  Result out = experiment_result(problem, settings);
  out.verdict = verdict(problem, answer);
  out.warnings = warnings(problem, answer);
  Group& content = out.content;
  add_mobilities(content, problem);
  add_estimates(content, problem, fitted);
  add_covariance(content, fitted);
  add_fitted_numbers(content, problem, answer);
  add_standard_errors(content, fitted);
  add_traces(content, problem, fitted);
  add_known(content, problem, answer);
  add_bootstrap(content, problem, answer);
  add_profiles(content, problem, answer);
  add_alternatives(content, problem, fitted);
  add_null_directions(content, fitted.identifiability);
  // Standard errors are those of a minimum.
  if (fitted.usable()) {
    add_combinations(content, problem, fitted.identifiability);
    add_determined_inertia(content, problem, answer);
    add_correlations(content, problem, fitted.identifiability);
  }
  add_identifiability_data(content, problem, fitted.identifiability);
  add_residuals(content, problem, answer);
  add_fit_data(content, problem, answer);
  add_misfit_data(content, problem, answer);
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("data", data_in_words(problem));
  if (!fitted.start.empty()) numerics.fact("start", fitted.start);
  const std::string checks =
      fitted.check_evaluations > 0 ? fmt::format(" and {} more to check the result", fitted.check_evaluations) : "";
  numerics.fact(
      "effort",
      fmt::format("Levenberg-Marquardt from {}: {}, {} of all runs with sensitivities{}, {}",
                  count(fitted.tries, "start", "starts"), count(fitted.iterations, "iteration", "iterations"),
                  count(fitted.evaluations, "evaluation", "evaluations"), checks, duration(fitted.microseconds)));
  return out;
}

void add_readings(Result& result, const FitProblem& problem, const Identification& answer) {
  if (answer.fit.runs.empty()) return;
  const Experiment& experiment = problem.experiment();
  std::vector<std::string> runs;
  std::vector<double> times;
  std::vector<std::vector<double>> columns(3 * experiment.sensors.size());
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const std::vector<Series>& sensors = answer.records[r].sensors;
    std::vector<double> when;
    for (const Series& series : sensors) when.insert(when.end(), series.time.begin(), series.time.end());
    std::sort(when.begin(), when.end());
    when.erase(std::unique(when.begin(), when.end()), when.end());
    runs.insert(runs.end(), when.size(), problem.run(r).run().name);
    times.insert(times.end(), when.begin(), when.end());
    const RunResiduals found = residuals_of(problem, answer.fit, answer.records, r);
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      const double unit = experiment.sensors[k].dimension().unit(experiment.scene.units);
      std::size_t s = 0;
      for (const double time : when) {
        const bool read = s < sensors[k].time.size() && sensors[k].time[s] == time;
        columns[3 * k].push_back(read ? sensors[k].value[s] / unit : not_a_number);
        columns[3 * k + 1].push_back(read ? found.prediction[k][s] / unit : not_a_number);
        columns[3 * k + 2].push_back(read ? found.residual[k][s] / unit : not_a_number);
        if (read) ++s;
      }
    }
  }
  // Not in JSON, for its size.
  Table& table = result.content.table("", "", Rows::columns, Verbosity::data);
  table.csv = true;
  table.words("run", "", std::move(runs));
  table.data("time", std::move(times)).unit = "s";  // of runs at rest the row
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    const std::string& name = experiment.sensors[k].name;
    const std::string unit = experiment.sensors[k].dimension().unit_name(experiment.scene.units);
    table.data(name, std::move(columns[3 * k])).unit = unit;
    table.data(name + ".prediction", std::move(columns[3 * k + 1])).unit = unit;
    table.data(name + ".residual", std::move(columns[3 * k + 2])).unit = unit;
  }
}

}  // namespace poise::app
