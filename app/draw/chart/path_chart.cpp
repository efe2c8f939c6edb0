#include "app/draw/chart/path_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "model/quantity.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::app {
namespace {

bool same_place(const PathPoint& a, const PathPoint& b, double range) {
  constexpr double apart = 1e-6;  // parts of the range, rad, mechanism sizes
  if (std::abs(a.parameter - b.parameter) > apart * range || a.x.size() != b.x.size()) return false;
  return std::equal(a.x.begin(), a.x.end(), b.x.begin(), [](double p, double q) { return std::abs(p - q) <= apart; });
}

/// "fold", "stop \"open\"".
std::string event_in_words(const Scene& scene, const PathEvent& event) {
  if (event.kind == PathEvent::Kind::branch) return "branch point";
  if (event.item < 0) return to_string(event.kind);
  const auto item = static_cast<std::size_t>(event.item);
  if (event.kind == PathEvent::Kind::stop) return fmt::format("stop \"{}\"", scene.stops[item].name);
  return fmt::format("\"{}\" {}", scene.elements[item].name, event.on ? "acts" : "slack");
}

std::string label_with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

/// One axis of a chart.
struct Ordinate {
  std::string label;
  std::function<double(const PathPoint&)> of;  ///< in the units of the label
};

Ordinate parameter_of(const VariedScene& varied) {
  return {label_with_unit(varied.name(), varied.unit_name()),
          [unit = varied.unit()](const PathPoint& point) { return point.parameter / unit; }};
}

Ordinate effort_of(const VariedScene& varied) {
  const Dimension dimension = varied.effort_dimension();
  const Units& units = varied.scene().units;
  return {label_with_unit(effort_name(varied) + " needed", dimension.unit_name(units)),
          [unit = dimension.unit(units), rounding = rounding_of_effort(varied)](const PathPoint& point) {
            return std::abs(point.effort) < rounding ? 0.0 : point.effort / unit;
          }};
}

Ordinate measure_of(const VariedScene& varied, PathReader& reader, const SoughtQuantity& measure,
                    const std::string& remark) {
  const Units& units = varied.scene().units;
  return {label_with_unit(measure.name, measure.dimension.unit_name(units)) + remark,
          [&reader, measure, unit = measure.dimension.unit(units)](const PathPoint& point) {
            return reader.value(measure, point) / unit;
          }};
}

/// Those of one panel.
struct Axes {
  Ordinate across, up;
};

/// Those of all panels; they refer to the reader.
std::vector<Axes> axes_of(const VariedScene& varied, PathReader& reader, const std::vector<SoughtQuantity>& measures,
                          const std::string& remark) {
  std::vector<Axes> out;
  const Ordinate parameter = parameter_of(varied);
  if (varied.is_driven()) out.push_back({parameter, effort_of(varied)});
  for (const SoughtQuantity& measure : measures) {
    const Ordinate read = measure_of(varied, reader, measure, out.empty() ? remark : "");
    out.push_back(varied.is_driven() ? Axes{parameter, read} : Axes{read, parameter});
  }
  return out;
}

/// Of the piece of curve between two points: a fold, at which one of them is, is neither stable nor unstable.
Stability between(const PathPoint& a, const PathPoint& b) {
  const auto is_known = [](Stability s) { return s == Stability::stable || s == Stability::unstable; };
  return is_known(a.stability) || !is_known(b.stability) ? a.stability : b.stability;
}

struct Look {
  Stability stability;
  const char* name;
  Curve::Style style;
};
constexpr std::array<Look, 4> looks = {{{Stability::stable, "stable", Curve::Style::line},
                                        {Stability::unstable, "unstable", Curve::Style::dashed},
                                        {Stability::neutral, "neutral", Curve::Style::dotted},
                                        {Stability::unknown, "stability unknown", Curve::Style::dashed}}};

/// The pieces of all branches that look the same.
Curve curve_of(const Path& path, const Look& look, const std::function<void(Curve&, const PathPoint&)>& add) {
  Curve curve{.name = look.name, .style = look.style, .colour = static_cast<int>(&look - looks.data())};
  constexpr double gap = std::numeric_limits<double>::quiet_NaN();
  for (const PathBranch& branch : path.branches) {
    bool joined = false;
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const PathPoint& from = branch.points[i - 1];
      const PathPoint& to = branch.points[i];
      if (between(from, to) != look.stability) {
        joined = false;
        continue;
      }
      if (!joined && !curve.x.empty()) {
        curve.x.push_back(gap);
        curve.y.push_back(gap);
      }
      if (!joined) add(curve, from);
      add(curve, to);
      joined = true;
    }
  }
  return curve;
}

Panel panel_of(const Path& path, const std::vector<PathMark>& marks, const Ordinate& across, const Ordinate& up) {
  Panel panel{.x_label = across.label, .y_label = up.label, .tall = true};
  const auto add = [&](Curve& curve, const PathPoint& point) {
    curve.x.push_back(across.of(point));
    curve.y.push_back(up.of(point));
  };
  for (const Look& look : looks) {
    Curve curve = curve_of(path, look, add);
    if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
  }
  Curve unproved{.name = "not proved", .style = Curve::Style::crosses};
  for (const PathBranch& branch : path.branches) {
    for (const PathPoint& point : branch.points) {
      if (point.proof == PointProof::failed) add(unproved, point);
    }
  }
  if (!unproved.x.empty()) panel.curves.push_back(std::move(unproved));
  for (const PathMark& mark : marks) panel.marks.push_back({across.of(*mark.point), up.of(*mark.point), mark.label});
  for (const PathEvent& event : path.events) {
    if (!event.landing) continue;
    panel.arrows.push_back({across.of(event.at), up.of(event.at), across.of(*event.landing), up.of(*event.landing)});
  }
  return panel;
}

}  // namespace

std::vector<PathMark> path_marks(const VariedScene& varied, const Path& path) {
  const double range = std::abs(varied.to() - varied.from());
  std::vector<PathMark> marks;
  const auto add = [&](const std::string& label, const std::string& what, const PathPoint& point, bool turns) {
    for (PathMark& mark : marks) {
      if (!same_place(*mark.point, point, range)) continue;
      mark.label += ", " + label;
      if (!mark.caption.ends_with(what)) mark.caption += ", " + what;
      mark.turns = mark.turns || turns;
      return;
    }
    marks.push_back({label, what, &point, turns});
  };
  const auto has_points = [](const PathBranch& branch) { return !branch.points.empty(); };
  const auto first = std::find_if(path.branches.begin(), path.branches.end(), has_points);
  if (first == path.branches.end()) return marks;
  add("start", "start", first->points.front(), false);
  for (std::size_t e = 0; e < path.events.size(); ++e) {
    const PathEvent& event = path.events[e];
    const bool turns = event.kind != PathEvent::Kind::stop && event.kind != PathEvent::Kind::slack;
    add(std::to_string(e + 1), event_in_words(varied.scene(), event), event.at, turns);
    if (event.landing) add(std::to_string(e + 1) + "′", "landing", *event.landing, turns);
  }
  std::vector<std::size_t> ends;
  for (std::size_t b = 0; b < path.branches.size(); ++b) {
    const PathBranch::End end = path.branches[b].end;
    const bool goes_on = end == PathBranch::End::snapped || end == PathBranch::End::closed;
    if (has_points(path.branches[b]) && !goes_on) ends.push_back(b);
  }
  for (std::size_t k = 0; k < ends.size(); ++k) {
    constexpr std::size_t letters = 26;
    const std::string label = ends.size() == 1 ? "end"
                              : k < letters    ? std::string(1, static_cast<char>('a' + k))
                                               : fmt::format("a{}", k);
    const std::string what = path.branches.size() == 1 ? "end" : fmt::format("end of branch {}", ends[k] + 1);
    add(label, what, path.branches[ends[k]].points.back(), false);
  }
  // Blanks at which no line is broken.
  const std::string unit = varied.unit_name().empty() ? "" : "\u00a0" + varied.unit_name();
  for (PathMark& mark : marks) {
    mark.caption += fmt::format(" at {}\u00a0=\u00a0{}{}", varied.name(),
                                significant(mark.point->parameter / varied.unit(), 4), unit);
  }
  return marks;
}

std::vector<Panel> path_panels(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures,
                               const std::vector<PathMark>& marks, const std::string& remark) {
  PathReader reader(varied);
  std::vector<Panel> panels;
  for (const Axes& axes : axes_of(varied, reader, measures, remark)) {
    panels.push_back(panel_of(path, marks, axes.across, axes.up));
  }
  return panels;
}

PathCharts charts_of(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures) {
  PathCharts charts{.marks = path_marks(varied, path), .measures = measures};
  std::string remark;
  if (measures.empty() && !varied.is_driven()) {
    charts.measures = {most_changing(varied, path)};
    remark = ", which changes most";
  }
  charts.panels = path_panels(varied, path, charts.measures, charts.marks, remark);
  return charts;
}

std::vector<ChartCursor> path_cursors(const VariedScene& varied, const std::vector<SoughtQuantity>& measures,
                                      const std::vector<PathPoint>& points) {
  PathReader reader(varied);
  std::vector<ChartCursor> cursors;
  for (const Axes& axes : axes_of(varied, reader, measures, "")) {
    ChartCursor& cursor = cursors.emplace_back();
    for (const PathPoint& point : points) {
      cursor.x.push_back(axes.across.of(point));
      cursor.y.push_back(axes.up.of(point));
    }
  }
  return cursors;
}

}  // namespace poise::app
