#include "app/results/statics/tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "solvers/not_a_number.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_tolerances = 6;

double part_in_per_cent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

/// One quantity in the units of the scene.
struct View {
  const ToleranceBand& band;
  double unit;
  std::string unit_name;

  View(const ToleranceBand& of, const Units& units)
      : band(of), unit(of.of.dimension.unit(units)), unit_name(of.of.dimension.unit_name(units)) {}

  double in_unit(double si) const { return si / unit; }
  std::string with_unit(double si) const {
    return significant(in_unit(si), digits_of_tolerances) + (unit_name.empty() ? "" : " " + unit_name);
  }
};

/// A row of the table of bands, in the unit.
struct ToleranceRow {
  std::string name;
  double mean = not_a_number, sigma = not_a_number, least = not_a_number, low = not_a_number, high = not_a_number,
         most = not_a_number;
};

ToleranceRow row_of(const std::string& name, const SampleStatistics& of, const View& view) {
  if (of.count == 0) return {name};
  return {name,
          view.in_unit(of.mean),
          of.count > 1 ? view.in_unit(of.sigma) : not_a_number,
          view.in_unit(of.least),
          view.in_unit(of.low),
          view.in_unit(of.high),
          view.in_unit(of.most)};
}

void add_bands(Group& group, const View& view, const ToleranceStudy& study) {
  const ToleranceBand& band = view.band;
  std::vector<ToleranceRow> rows;
  rows.push_back({"first order, worst case", view.in_unit(band.nominal), view.in_unit(band.sigma),
                  view.in_unit(band.nominal - band.worst), not_a_number, not_a_number,
                  view.in_unit(band.nominal + band.worst)});
  if (band.has_second) {
    rows.push_back({"second order", view.in_unit(band.nominal + band.shift), view.in_unit(band.second_sigma),
                    not_a_number, not_a_number, not_a_number, not_a_number});
  }
  if (band.at_least || band.at_most) {
    const auto value = [&](const std::optional<double>& si) { return si ? view.in_unit(*si) : not_a_number; };
    rows.push_back({"solved at the worst ends", not_a_number, not_a_number, value(band.at_least), not_a_number,
                    not_a_number, value(band.at_most)});
  }
  if (band.continued.count > 0) rows.push_back(row_of("samples that continue", band.continued, view));
  if (study.snapped > 0) rows.push_back(row_of("with those that snap", band.all, view));
  Table& table = group.table("", "", Rows::list);
  table.words("", "", each(rows, &ToleranceRow::name));
  const auto column = [&](const std::string& title, double ToleranceRow::*value) {
    table.numbers("", title, view.unit_name, each(rows, value), {.digits = digits_of_tolerances});
  };
  column("mean", &ToleranceRow::mean);
  column("sigma", &ToleranceRow::sigma);
  column("least", &ToleranceRow::least);
  column("2.5 %", &ToleranceRow::low);
  column("97.5 %", &ToleranceRow::high);
  column("most", &ToleranceRow::most);
}

/// Shares of the variance of first order, largest first.
struct Share {
  const Tolerance* of = nullptr;
  double share = 0.0, slope = 0.0;
};

std::vector<Share> shares_of(const ToleranceBand& band, const std::vector<Tolerance>& tolerances) {
  std::vector<Share> out;
  for (std::size_t t = 0; t < band.slopes.size(); ++t) {
    out.push_back({&tolerances[t], band.shares[t], band.slopes[t]});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Share& a, const Share& b) { return to_rank(a.share) > to_rank(b.share); });
  return out;
}

/// The half width of a tolerance, that of the 95 % interval of a fitted number.
double reach_of(const Tolerance& of) {
  constexpr double normal = 1.96;
  return of.distribution == Tolerance::Distribution::fitted ? normal * of.sigma : of.half_width;
}

void add_shares(Group& group, const View& view, const ToleranceStudy& study, const Units& units) {
  std::vector<Share> shares = shares_of(view.band, study.tolerances);
  constexpr std::size_t most = 8;
  const std::size_t all = shares.size();
  if (all > most) shares.resize(most);
  Table& table = group.table("", "Contributions to the variance of " + view.band.of.name, Rows::list);
  table.words("", "number", each(shares, [](const Share& share) { return share.of->number; }));
  table.words("", "tolerance", each(shares, [&](const Share& share) {
                const Dimension& dimension = share.of->dimension;
                using Distribution = Tolerance::Distribution;
                const Distribution is = share.of->distribution;
                return fmt::format("+-{} {}{}", significant(reach_of(*share.of) / dimension.unit(units), 4),
                                   dimension.unit_name(units),
                                   is == Distribution::normal   ? ", normal"
                                   : is == Distribution::fitted ? ", fit"
                                                                : "");
              }));
  table.numbers("", "share", "%", each(shares, [](const Share& share) { return 100 * share.share; }), {.digits = 3});
  table.words("", "", each(shares, [&](const Share& share) {
                return "moves it by +-" + view.with_unit(std::abs(share.slope) * reach_of(*share.of));
              }));
  if (all > shares.size()) {
    const double rest = std::accumulate(shares.begin(), shares.end(), 1.0,
                                        [](double left, const Share& share) { return left - share.share; });
    table.footnotes.push_back(fmt::format("and {} with {} % together",
                                          count(static_cast<int>(all - shares.size()), "number", "numbers"),
                                          significant(100 * std::max(0.0, rest), 2)));
  }
}

std::vector<double> bin_edges(const View& view) {
  const ToleranceBand& band = view.band;
  std::vector<double> out;
  const double width = (band.all.most - band.all.least) / static_cast<double>(band.histogram.size());
  for (std::size_t b = 0; b <= band.histogram.size(); ++b) {
    out.push_back(view.in_unit(band.all.least + static_cast<double>(b) * width));
  }
  return out;
}

/// Two bins a line.
void add_histogram(Group& group, const View& view) {
  const ToleranceBand& band = view.band;
  if (band.histogram.empty() || !(band.all.most > band.all.least)) return;
  const std::vector<double> edges = bin_edges(view);
  std::vector<double> from, counts;
  for (std::size_t b = 0; b + 1 < band.histogram.size(); b += 2) {
    from.push_back(edges[b]);
    counts.push_back(static_cast<double>(band.histogram[b] + band.histogram[b + 1]));
  }
  constexpr double longest = 50.0;
  const double largest = *std::max_element(counts.begin(), counts.end());
  Table& table = group.table("", "Samples of " + band.of.name, Rows::list);
  table.shown = Table::Shown::all;
  table.charted = true;
  table.numbers("", "from", view.unit_name, from, {.digits = 5});
  table.words("", "", each(counts, [&](double number) {
                const auto length = static_cast<std::size_t>(std::ceil(longest * number / largest));
                return std::string(length, '#');
              }));
  table.counts("", "samples", counts);
}

void add_statistics(Group& group, const std::string& key, const SampleStatistics& of, const View& view) {
  Group& out = group.group(key, "", Verbosity::data);
  out.data("count", of.count);
  const auto value = [&](double si) { return of.count > 0 && !std::isnan(si) ? Value(view.in_unit(si)) : Value(); };
  out.data("mean", value(of.mean));
  out.data("sigma", value(of.sigma));
  out.data("least", value(of.least));
  out.data("low", value(of.low));
  out.data("median", value(of.median));
  out.data("high", value(of.high));
  out.data("most", value(of.most));
}

void add_data(Branch& quantities, const View& view, const ToleranceStudy& study, const Units& units) {
  const ToleranceBand& band = view.band;
  Group& group = quantities.parts.emplace_back();
  group.data("name", band.of.name);
  group.data("unit", view.unit_name);
  group.data("why", band.why.empty() ? Value() : Value(band.why));
  if (!band.why.empty()) return;
  group.data("nominal", view.in_unit(band.nominal));
  group.data("sigma", view.in_unit(band.sigma));
  group.data("worst", view.in_unit(band.worst));
  const auto value = [&](const std::optional<double>& si) { return si ? Value(view.in_unit(*si)) : Value(); };
  group.data("at_least", value(band.at_least));
  group.data("at_most", value(band.at_most));
  group.data("second_order_mean", band.has_second ? Value(view.in_unit(band.nominal + band.shift)) : Value());
  group.data("second_order_sigma", band.has_second ? Value(view.in_unit(band.second_sigma)) : Value());
  group.data("linear", band.is_linear);
  add_statistics(group, "continued", band.continued, view);
  add_statistics(group, "all", band.all, view);
  std::vector<std::int64_t> counts;
  for (const std::size_t number : band.histogram) counts.push_back(static_cast<std::int64_t>(number));
  group.data("histogram", counts);
  group.data("histogram_edges", band.histogram.empty() ? std::vector<double>{} : bin_edges(view));
  Branch& shares = group.array("contributions");
  for (const Share& share : shares_of(band, study.tolerances)) {
    Group& one = shares.parts.emplace_back();
    one.data("number", share.of->number);
    const bool is_fitted = share.of->distribution == Tolerance::Distribution::fitted;
    one.data("half_width", is_fitted ? Value() : Value(share.of->half_width / share.of->dimension.unit(units)));
    one.data("standard_error", is_fitted ? Value(share.of->sigma / share.of->dimension.unit(units)) : Value());
    one.data("unit", share.of->dimension.unit_name(units));
    one.data("derivative", share.slope * share.of->dimension.unit(units) / view.unit);
    one.data("share", share.share);
  }
}

void add_csv(Group& content, const ToleranceStudy& study, const Units& units) {
  Table& csv = content.table("", "", Rows::list, Verbosity::data);
  csv.csv = true;
  std::vector<std::string> names;
  std::vector<double> from, to, counts;
  for (const ToleranceBand& band : study.of) {
    if (band.histogram.empty()) continue;
    const std::vector<double> edges = bin_edges({band, units});
    for (std::size_t b = 0; b < band.histogram.size(); ++b) {
      names.push_back(band.of.name);
      from.push_back(edges[b]);
      to.push_back(edges[b + 1]);
      counts.push_back(static_cast<double>(band.histogram[b]));
    }
  }
  csv.words("quantity", "", std::move(names));
  csv.data("from", std::move(from));
  csv.data("to", std::move(to));
  Column& samples = csv.data("samples", std::move(counts));
  samples.kind = Column::Kind::count;
}

Line verdict(const ToleranceStudy& study) {
  if (!study.why.empty()) return bad("No bands: " + study.why + ".");
  const auto without =
      std::count_if(study.of.begin(), study.of.end(), [](const ToleranceBand& b) { return !b.why.empty(); });
  if (without == static_cast<std::ptrdiff_t>(study.of.size())) {
    return bad(fmt::format("No bands; {}: {}.", study.of.front().of.name, study.of.front().why));
  }
  const auto fitted =
      static_cast<int>(std::count_if(study.tolerances.begin(), study.tolerances.end(), [](const Tolerance& one) {
        return one.distribution == Tolerance::Distribution::fitted;
      }));
  const int own = static_cast<int>(study.tolerances.size()) - fitted;
  std::string numbers = own > 0 || fitted == 0 ? count(own, "tolerance", "tolerances") : "";
  if (fitted > 0) numbers += (own > 0 ? " and " : "") + count(fitted, "estimate", "estimates");
  if (study.samples == 0 && study.interrupted) {
    return doubtful(fmt::format("{}, first order; interrupted before the first sample.", numbers));
  }
  if (study.samples == 0) return good(fmt::format("{}, first order.", numbers));
  const std::string samples =
      (study.interrupted ? "interrupted after " : "") + count(static_cast<int>(study.samples), "sample", "samples");
  if (study.continued == study.samples && !study.interrupted) {
    return good(fmt::format("{}, {}: the equilibrium continues to all of them.", numbers, samples));
  }
  std::string text = fmt::format("{}, {}: the equilibrium continues to {} %; {} % lose it and settle elsewhere",
                                 numbers, samples, significant(part_in_per_cent(study.continued, study.samples), 4),
                                 significant(part_in_per_cent(study.snapped, study.samples), 4));
  if (study.nowhere > 0) {
    text += fmt::format("; for {} % none was found", significant(part_in_per_cent(study.nowhere, study.samples), 4));
  }
  if (study.undecided > 0) {
    text += fmt::format("; for {} % rounding leaves open whether it continues",
                        significant(part_in_per_cent(study.undecided, study.samples), 4));
  }
  return study.continued == 0 ? bad(text + ".") : doubtful(text + ".");
}

}  // namespace

Result tolerance_result(const Scene& scene, const ToleranceStudy& study, const std::vector<std::string>& settings) {
  Result out = scene_result(scene, settings);
  out.verdict = verdict(study);
  const Units& units = scene.units;
  for (const ToleranceBand& band : study.of) {
    if (!band.why.empty()) {
      out.warnings.push_back(bad(fmt::format("No band of {}: {}.", band.of.name, band.why)));
    } else if (band.of.kind == SoughtQuantity::Kind::load_at_fold) {
      out.warnings.push_back(
          doubtful(band.of.name + " has first order only: samples of loads at folds are not drawn."));
    } else if (!band.is_linear && study.samples > 0) {
      out.warnings.push_back(doubtful(
          fmt::format("{} is not linear over these tolerances: take the samples, not first order.", band.of.name)));
    }
  }
  if (study.why.empty() && study.equilibrium.certificate.stability == Stability::unknown) {
    out.warnings.push_back(doubtful("The stability of the equilibrium is not known: loads follow bodies."));
  }
  if (study.disagreed > 0) {
    out.warnings.push_back(
        bad(fmt::format("{} of {} samples that were followed besides do not end in the same place: the share that "
                        "continues is in doubt.",
                        study.disagreed, study.rechecked)));
  }
  warn_of_friction(out, scene);
  Group& content = out.content;
  content.data("status", to_string(study.equilibrium.status));
  content.data("why", study.why.empty() ? Value() : Value(study.why));
  content.data("samples", study.samples);
  content.data("continued", study.continued);
  content.data("followed", study.followed);
  content.data("snapped", study.snapped);
  content.data("nowhere", study.nowhere);
  content.data("undecided", study.undecided);
  content.data("rechecked", study.rechecked);
  content.data("disagreed", study.disagreed);
  content.data("interrupted", study.interrupted);
  Branch& quantities = content.array("quantities");
  for (const ToleranceBand& band : study.of) {
    const View view(band, units);
    add_data(quantities, view, study, units);
    if (!band.why.empty()) continue;
    Group& group = content.group("", fmt::format("{} = {}", band.of.name, view.with_unit(band.nominal)));
    add_bands(group, view, study);
    add_shares(group, view, study, units);
    add_histogram(group, view);
  }
  add_csv(content, study, units);
  return out;
}

std::vector<Panel> histogram_panels(const Scene& scene, const ToleranceStudy& study) {
  std::vector<Panel> out;
  for (const ToleranceBand& band : study.of) {
    if (band.histogram.empty() || !(band.all.most > band.all.least)) continue;
    const View view(band, scene.units);
    const std::vector<double> edges = bin_edges(view);
    Panel& panel = out.emplace_back();
    panel.title = scene.title + ": " + band.of.name;
    panel.x_label = band.of.name + (view.unit_name.empty() ? "" : " (" + view.unit_name + ")");
    panel.y_label = "samples";
    Curve bars{.name = "samples", .colour = 0};
    for (std::size_t b = 0; b < band.histogram.size(); ++b) {
      const auto height = static_cast<double>(band.histogram[b]);
      bars.x.insert(bars.x.end(), {edges[b], edges[b], edges[b + 1], edges[b + 1]});
      bars.y.insert(bars.y.end(), {0.0, height, height, 0.0});
    }
    panel.curves.push_back(std::move(bars));
    if (!(band.sigma > 0.0)) continue;
    Curve normal{.name = "first order", .style = Curve::Style::dashed, .colour = 1};
    const double sigma = view.in_unit(band.sigma), mean = view.in_unit(band.nominal);
    const double whole = static_cast<double>(band.all.count) * (edges[1] - edges[0]);
    constexpr int steps = 80;
    constexpr double reach = 4.0;
    for (int k = 0; k <= steps; ++k) {
      const double u = reach * (2.0 * k / steps - 1.0);
      normal.x.push_back(mean + u * sigma);
      normal.y.push_back(whole / (sigma * std::sqrt(2 * std::numbers::pi)) * std::exp(-u * u / 2));
    }
    panel.curves.push_back(std::move(normal));
  }
  return out;
}

}  // namespace poise::app
