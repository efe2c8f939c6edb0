#include "app/draw/chart/plot.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/draw/canvas.hpp"
#include "app/draw/chart/axis.hpp"
#include "app/draw/chart/gnuplot.hpp"
#include "app/draw/chart/mark_labels.hpp"
#include "app/draw/chart/thinned.hpp"
#include "app/draw/palette.hpp"
#include "app/draw/sheet.hpp"
#include "app/result/numbers.hpp"
#include "model/scene.hpp"

namespace poise::app {
namespace {

// Sizes of the page, px.
constexpr double title_size = 13.0;
constexpr double digit_width = 0.56 * sheet::text_size;
constexpr double edge = 14.0;
constexpr double above_graph = 34.0;
constexpr double above_untitled_graph = 12.0;
constexpr double below_graph = 46.0;
constexpr double graph_height = 180.0;
constexpr double between_columns = 26.0;
constexpr double legend_gap = 14.0;
constexpr double legend_sample = 34.0;
constexpr double legend_row = 17.0;
constexpr double widest_name_beside = 190.0;
constexpr double widest_name_below = 330.0;
constexpr std::size_t most_legend_names = 24;

// What one point takes in the text of gnuplot's SVG, bytes, and how much all points together may.
constexpr std::size_t bytes_of_vertex = 16;
constexpr std::size_t bytes_of_dot = 2 * bytes_of_vertex;
constexpr std::size_t bytes_of_all = 220000;
constexpr std::size_t most_points = 4000;
constexpr std::size_t least_points = 40;
// A dot is a line of this length, px, with round ends: a tenth of the text that gnuplot's own markers take.
constexpr double dot_length = 0.1;

// Placeholders in gnuplot's output, replaced afterwards.
constexpr const char* font_name = "poise-chart";
constexpr const char* fonts = "system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif";

// Lines that coincide share this length, about px, of which each later one covers half of what the one before shows.
constexpr double shared_dash = 24.0;

/// A panel with what is computed before it is placed.
struct Chart {
  const Panel* panel = nullptr;
  Axis x{}, y{};
  std::vector<std::string> names{};  // of curves, levels and bands, cut to what fits; empty: not in the legend
  std::string left_out{};            // the last line of a legend that is too long
  double left = 0.0;                 // from the cell's edge to the graph
  double legend = 0.0;               // width, 0 without one
  double legend_height = 0.0;
  double height = graph_height;
  std::vector<int> beneath{};  // per curve, how many earlier ones it coincides with
};

/// Where a graph is on the page, px from its upper left corner.
struct PlotFrame {
  double left, right, top, bottom;
};

std::string shortened(const std::string& name, double widest) {
  if (text_width(name, sheet::text_size) <= widest) return name;
  std::string text;
  for (std::size_t i = 0; i < name.size();) {
    std::size_t end = i + 1;
    while (end < name.size() && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) ++end;
    const std::string longer = text + name.substr(i, end - i);
    if (text_width(longer + "…", sheet::text_size) > widest) break;
    text = longer;
    i = end;
  }
  return text + "…";
}

void write_legend(Chart& chart, double widest) {
  const auto room = [&](const std::string& name) {
    chart.legend = std::max(chart.legend, legend_gap + legend_sample + text_width(name, sheet::text_size));
  };
  std::size_t named = 0;
  const auto add = [&](const std::string& name) {
    const bool shown = !name.empty() && named < most_legend_names;
    named += name.empty() ? 0 : 1;
    chart.names.push_back(shown ? shortened(name, widest) : "");
    if (shown) room(chart.names.back());
  };
  for (const Curve& curve : chart.panel->curves) add(curve.name);
  for (const Level& level : chart.panel->levels) add(level.name);
  for (const Band& band : chart.panel->bands) add(band.name);
  if (named > most_legend_names) {
    chart.left_out = fmt::format("… and {} more", named - most_legend_names);
    room(chart.left_out);
  }
  chart.legend_height = legend_row * static_cast<double>(std::min(named, most_legend_names + 1));
  chart.height = chart.panel->tall ? 2 * graph_height : graph_height;
}

/// Whether two lines coincide: the same points to a pixel.
bool coincide(const Curve& a, const Curve& b, const Chart& chart) {
  constexpr double pixel = 1.2;
  if (a.style != Curve::Style::line || b.style != Curve::Style::line || a.x != b.x) return false;
  const auto height = [&](double y) {
    const Axis& axis = chart.y;
    return chart.height * (chart.panel->log_y ? std::log(y / axis.low) / std::log(axis.high / axis.low)
                                              : (y - axis.low) / (axis.high - axis.low));
  };
  bool any = false;
  for (std::size_t i = 0; i < a.y.size(); ++i) {
    const double apart = std::abs(height(a.y[i]) - height(b.y[i]));
    if (apart > pixel) return false;
    any = any || std::isfinite(apart);
  }
  return any;
}

void find_coinciding(Chart& chart) {
  const std::vector<Curve>& curves = chart.panel->curves;
  for (auto curve = curves.begin(); curve != curves.end(); ++curve) {
    chart.beneath.push_back(static_cast<int>(
        std::count_if(curves.begin(), curve, [&](const Curve& earlier) { return coincide(earlier, *curve, chart); })));
  }
}

/// The panels of one column that go on to the same label of x share its axis: a label may stand at the last one only.
std::vector<const Panel*> sharing_x(const std::vector<Panel>& panels, std::size_t panel, std::size_t columns) {
  const auto label = [&](std::size_t i) {
    while (panels[i].x_label.empty() && i + columns < panels.size()) i += columns;
    return panels[i].x_label;
  };
  std::vector<const Panel*> sharing;
  for (std::size_t i = panel % columns; i < panels.size(); i += columns) {
    if (panels[i].log_x == panels[panel].log_x && label(i) == label(panel)) sharing.push_back(&panels[i]);
  }
  return sharing;
}

Chart prepare(const Panel& panel, const std::vector<const Panel*>& sharing, int columns) {
  Chart chart{.panel = &panel};
  std::vector<double> x, y;
  bool marked = false;
  for (const Panel* other : sharing) {
    for (const Curve& curve : other->curves) {
      x.insert(x.end(), curve.x.begin(), curve.x.end());
      marked = marked || curve.style == Curve::Style::points || curve.style == Curve::Style::crosses;
    }
    for (const Mark& mark : other->marks) x.push_back(mark.x);
    for (const Arrow& arrow : other->arrows) x.insert(x.end(), {arrow.from_x, arrow.to_x});
    marked = marked || !other->marks.empty();
  }
  for (const Curve& curve : panel.curves) y.insert(y.end(), curve.y.begin(), curve.y.end());
  for (const Level& level : panel.levels) y.push_back(level.y);
  for (const Band& band : panel.bands) y.insert(y.end(), {band.low, band.high});
  for (const Mark& mark : panel.marks) y.push_back(mark.y);
  for (const Arrow& arrow : panel.arrows) y.insert(y.end(), {arrow.from_y, arrow.to_y});
  chart.x = panel.log_x ? log_axis(x, 7) : linear_axis(x, marked ? 0.03 : 0.0, columns > 1 ? 6 : 8);
  chart.y = panel.log_y ? log_axis(y, 6) : linear_axis(y, 0.06, 5);
  double labels = 0.0;
  for (const Tick& tick : chart.y.ticks)
    labels = std::max(labels, digit_width * static_cast<double>(screen_width(tick.label)));
  chart.left = labels + 10 + (panel.y_label.empty() ? 0.0 : 1.7 * sheet::text_size);
  write_legend(chart, columns > 1 ? widest_name_below : widest_name_beside);
  find_coinciding(chart);
  return chart;
}

/// Writes the script of one figure.
class Script {
 public:
  Script(std::vector<Chart> charts, int columns) : charts_(std::move(charts)), columns_(columns) { lay_out(); }

  std::string write() {
    std::size_t curves = 1;
    for (const Chart& chart : charts_) curves += chart.panel->curves.size();
    bytes_of_curve_ = bytes_of_all / curves;
    text_ = fmt::format(
        "set encoding utf8\n"
        "set terminal svg size {:.0f},{:.0f} noenhanced rounded background 'white' font '{},{}'\n"
        "set multiplot\nset border 3 lc rgb '{}' lw 1\n"
        "set tics nomirror out scale 0.5 textcolor rgb '{}'\nset xtics offset 0,0.3\nset grid lt 1 lc rgb '{}' lw 1\n"
        "set xzeroaxis lt 1 lc rgb '{}' lw 1\n",
        width_, height_, font_name, sheet::text_size, light_value(ink::zero), light_value(ink::dark),
        light_value(ink::grid), light_value(ink::zero));
    for (std::size_t i = 0; i < charts_.size(); ++i) draw(charts_[i], frames_[i]);
    return text_ + "unset multiplot\n";
  }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), form, std::forward<Values>(values)...);
  }

  // Graphs of one column stand below each other with the same edges, those of one row have the same height. Legends
  // stand beside the graphs of a single column, and below those of several.
  void lay_out() {
    const double cell = columns_ == 1 ? sheet::width : (sheet::width - between_columns) / 2;
    const auto columns = static_cast<std::size_t>(columns_);
    std::vector<double> left(columns, 0.0), right(columns, edge);
    for (std::size_t i = 0; i < charts_.size(); ++i) {
      left[i % columns] = std::max(left[i % columns], edge + charts_[i].left);
      if (columns == 1) right[0] = std::max(right[0], charts_[i].legend + edge);
    }
    width_ = columns_ * cell + (columns_ - 1) * between_columns;
    double y = 0.0;
    for (std::size_t row = 0; row < charts_.size(); row += columns) {
      double above = above_untitled_graph;
      double height = 0.0;
      double legend = 0.0;
      const std::size_t end = std::min(row + columns, charts_.size());
      for (std::size_t i = row; i < end; ++i) {
        if (!charts_[i].panel->title.empty()) above = above_graph;
        height = std::max({height, charts_[i].height, columns == 1 ? charts_[i].legend_height : 0.0});
        if (columns > 1) legend = std::max(legend, charts_[i].legend_height + edge);
      }
      for (std::size_t i = row; i < end; ++i) {
        const double x = static_cast<double>(i - row) * (cell + between_columns);
        frames_.push_back({x + left[i - row], x + cell - right[i - row], y + above, y + above + height});
      }
      y += above + height + below_graph + legend;
    }
    height_ = std::max(y, below_graph);
  }

  // gnuplot counts from the lower left corner, 0 .. 1.
  double across(double x) const { return x / width_; }
  double up(double y) const { return 1.0 - y / height_; }

  void label(const std::string& text, double x, double y, const std::string& how) {
    if (text.empty()) return;
    add("set label {} at screen {:.6f},{:.6f} {}\n", gnuplot_string(text), across(x), up(y), how);
  }

  void set_axis(char name, const Axis& axis, bool logarithmic, bool falls) {
    // Room for rounding, or marks at the ends are left out.
    const double room = logarithmic ? 0.0 : 1e-9 * (axis.high - axis.low);
    const double factor = logarithmic ? 1 + 1e-6 : 1.0;
    double first = axis.low / factor - room, last = axis.high * factor + room;
    if (falls) std::swap(first, last);
    add("{} logscale {}\nset {}range [{}:{}]\nset {}tics (", logarithmic ? "set" : "unset", name, name, first, last,
        name);
    for (const Tick& tick : axis.ticks) {
      add("{}{} {}", &tick == &axis.ticks.front() ? "" : ",", gnuplot_string(tick.label), tick.at);
    }
    add(")\n");
  }

  void draw(const Chart& chart, const PlotFrame& frame) {
    const Panel& panel = *chart.panel;
    add("unset label\nunset arrow\nset lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n"
        "set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n",
        across(frame.left), across(frame.right), up(frame.top), up(frame.bottom));
    set_axis('x', chart.x, panel.log_x, panel.x_falls);
    set_axis('y', chart.y, panel.log_y, false);
    add("set key at screen {:.6f},{:.6f} left top vertical Left reverse samplen 1.5 spacing 1.0 textcolor rgb '{}'\n",
        across(columns_ == 1 ? frame.right + legend_gap - 10 : frame.left),
        up(columns_ == 1 ? frame.top : frame.bottom + below_graph - 4), light_value(ink::dark));
    label(panel.title, frame.left, frame.top - 16,
          fmt::format("left font '{}:Bold,{}' textcolor rgb '{}'", font_name, title_size, light_value(ink::dark)));
    const std::string remark = fmt::format("textcolor rgb '{}'", light_value(ink::ground));
    label(panel.x_label, (frame.left + frame.right) / 2, frame.bottom + 33, "center " + remark);
    label(panel.y_label, frame.left - chart.left + 3, (frame.top + frame.bottom) / 2, "center rotate by 90 " + remark);
    for (const Arrow& arrow : panel.arrows) {
      add("set arrow from {},{} to {},{} size screen 0.008,20 filled front lt 1 lw 1 lc rgb '{}'\n", arrow.from_x,
          arrow.from_y, arrow.to_x, arrow.to_y, light_value(ink::ground));
    }
    draw_marks(chart, frame);
    draw_curves(chart, frame);
  }

  void draw_marks(const Chart& chart, const PlotFrame& frame) {
    const Panel& panel = *chart.panel;
    const auto share = [](double value, const Axis& axis, bool is_log) {
      return is_log ? std::log(value / axis.low) / std::log(axis.high / axis.low)
                    : (value - axis.low) / (axis.high - axis.low);
    };
    std::vector<PlacedMark> placed;
    for (const Mark& mark : panel.marks) {
      add("set label '' at {},{} front point pt 7 ps 0.5 lc rgb '{}'\n", mark.x, mark.y, light_value(ink::dark));
      const double x = share(mark.x, chart.x, panel.log_x);
      placed.push_back({frame.left + (panel.x_falls ? 1.0 - x : x) * (frame.right - frame.left),
                        frame.bottom - share(mark.y, chart.y, panel.log_y) * (frame.bottom - frame.top), mark.label});
    }
    const PageBox graph{frame.left, frame.right, frame.top, frame.bottom};
    for (const MarkLabel& text : mark_labels(placed, graph, sheet::text_size)) {
      label(text.text, (text.box.left + text.box.right) / 2, (text.box.top + text.box.bottom) / 2,
            fmt::format("center front font '{}:Bold,{}' textcolor rgb '{}'", font_name, sheet::text_size,
                        light_value(ink::dark)));
    }
  }

  static std::string dashes(double on, double off) { return fmt::format("dt ({},{})", on, off); }

  // Of gnuplot's: disc, square, triangle, diamond, triangle on its tip.
  static int marker(std::size_t i) {
    static constexpr std::array<int, 5> markers = {7, 5, 9, 13, 11};
    return markers[i % markers.size()];
  }

  static std::string titled(const std::string& name) {
    return name.empty() ? "notitle" : "title " + gnuplot_string(name);
  }

  // Bands first, so that everything else lies over them; the legend has curves first.
  void draw_curves(const Chart& chart, const PlotFrame& frame) {
    const Panel& panel = *chart.panel;
    std::vector<std::string> shapes, legend;
    auto name = chart.names.begin();
    std::size_t turn = 0;
    for (const Curve& curve : panel.curves) {
      const std::size_t number = curve.colour >= 0 ? static_cast<std::size_t>(curve.colour) : turn++;
      const bool crosses = curve.style == Curve::Style::crosses;
      const std::string_view colour = light_value(crosses ? ink::load : curve_colour(number));
      const bool dots = curve.style == Curve::Style::points;
      const bool marked = curve.style == Curve::Style::marked;
      const auto drawn = [&](const std::string& dash) {
        if (crosses) return fmt::format("with points pt 2 ps 0.6 lw 1.5 lc rgb '{}'", colour);
        return fmt::format("with {} lt 1 lw {} {} lc rgb '{}'",
                           marked ? fmt::format("linespoints pt {} ps 0.55", marker(number)) : std::string("lines"),
                           dots ? 2.8 : 1.7, dash, colour);
      };
      const std::string own = curve.style == Curve::Style::dashed   ? dashes(5, 4)
                              : curve.style == Curve::Style::dotted ? dashes(1, 3)
                              : number >= curve_colours             ? dashes(9, 3)
                                                                    : "";
      const int beneath = chart.beneath[static_cast<std::size_t>(&curve - panel.curves.data())];
      const double shown = shared_dash / std::pow(2.0, beneath);
      const std::string line = drawn(beneath > 0 ? dashes(shown, shared_dash - shown) : own);
      const std::string sample = dots ? fmt::format("with points pt 7 ps 0.35 lc rgb '{}'", colour) : drawn(own);
      legend.push_back(fmt::format("keyentry {} {}", sample, titled(*name++)));
      if (add_data(curve, chart, frame)) shapes.push_back(fmt::format("$data{} using 1:2 {} notitle", data_++, line));
    }
    for (const Level& level : panel.levels) {
      const std::string line = fmt::format("with lines lt 1 lw 1.2 dt (2,3) lc rgb '{}'", light_value(ink::ground));
      legend.push_back(fmt::format("keyentry {} {}", line, titled(*name++)));
      if (chart.y.contains(level.y)) shapes.push_back(fmt::format("{} {} notitle", level.y, line));
    }
    for (const Band& band : panel.bands) {
      legend.push_back(
          fmt::format("keyentry with boxes fs solid noborder fc rgb '{}' {}", light_value(ink::band), titled(*name++)));
      if (!chart.y.contains(band.low) || !chart.y.contains(band.high)) continue;
      add("$data{} << END\n{} {} {}\n{} {} {}\nEND\n", data_, chart.x.low, band.low, band.high, chart.x.high, band.low,
          band.high);
      shapes.insert(shapes.begin(),
                    fmt::format("$data{} using 1:2:3 with filledcurves fs solid noborder fc rgb '{}' notitle", data_++,
                                light_value(ink::band)));
    }
    if (!chart.left_out.empty()) legend.push_back("keyentry with lines lc rgb 'white' " + titled(chart.left_out));
    // A graph without anything in it still has its axes.
    if (shapes.empty()) shapes.emplace_back("NaN notitle");
    shapes.insert(shapes.end(), legend.begin(), legend.end());
    add("plot {}\n", fmt::join(shapes, ", "));
  }

  // What is drawn of a curve as a block of lines "x y"; false where nothing of it can be seen.
  bool add_data(const Curve& curve, const Chart& chart, const PlotFrame& frame) {
    const bool dots = curve.style == Curve::Style::points;
    const std::size_t most =
        std::clamp(bytes_of_curve_ / (dots ? bytes_of_dot : bytes_of_vertex), least_points, most_points);
    const double dot = dot_length / (frame.right - frame.left);
    const double wider = dot * (chart.x.high - chart.x.low);
    const double longer = std::pow(chart.x.high / chart.x.low, dot);
    std::string block = fmt::format("$data{} << END\n", data_);
    bool seen = false;
    for (std::size_t i : dots ? every_kth(curve.x.size(), most) : thinned(curve.x, curve.y, most)) {
      const double x = curve.x[i];
      const double y = curve.y[i];
      const bool here = chart.x.contains(x) && chart.y.contains(y);
      seen = seen || here;
      block += here ? fmt::format("{} {}\n", x, y) : "NaN NaN\n";
      if (dots && here) block += fmt::format("{} {}\n\n", chart.panel->log_x ? x * longer : x + wider, y);
    }
    if (seen) text_ += block + "END\n";
    return seen;
  }

  std::vector<Chart> charts_;
  std::vector<PlotFrame> frames_;
  int columns_;
  double width_ = 0.0, height_ = 0.0;
  std::size_t bytes_of_curve_ = 0;
  std::size_t data_ = 0;
  std::string text_;
};

/// Replaces each stretch from `begin` to the next `end`, both included.
void replace_all(std::string& text, std::string_view begin, std::string_view end, std::string_view with) {
  std::string out;
  std::size_t from = 0;
  while (true) {
    const std::size_t first = text.find(begin, from);
    const std::size_t last = first == std::string::npos ? first : text.find(end, first + begin.size());
    if (last == std::string::npos) break;
    out.append(text, from, first - from).append(with);
    from = last + end.size();
  }
  text = out.append(text, from);
}

/// Gives the figure its name and the fonts of our pictures, and takes away what only gnuplot's viewer needs.
std::string finished(std::string svg, const std::vector<Panel>& panels) {
  std::string title;
  for (const Panel& panel : panels) {
    if (!panel.title.empty()) title += (title.empty() ? "" : "; ") + escape_xml(panel.title);
  }
  replace_all(svg, "<title>gnuplot_plot_", "</title>", "");
  replace_all(svg, "<title>Gnuplot<", "</desc>", "<title>" + title + "</title>");
  replace_all(svg, fmt::format("font-family=\"{}:Bold", font_name), "\"", "font-weight=\"bold\"");
  replace_all(svg, fmt::format("font-family=\"{}", font_name), "\"", "");
  replace_all(svg, " xmlns=\"http:", "svg\"",
              fmt::format(" xmlns=\"http://www.w3.org/2000/svg\"\n font-family=\"{}\"", fonts));
  return svg;
}

}  // namespace

bool has_plotter() { return has_gnuplot(); }

void expect_plotter() {
  if (has_plotter()) return;
  throw InputError("--svg: gnuplot was not found; install it (Debian: apt-get install gnuplot-nox)");
}

std::string draw_plot(const std::vector<Panel>& panels, int columns) {
  expect_plotter();
  std::vector<Chart> charts;
  columns = std::max(1, columns);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    charts.push_back(prepare(panels[i], sharing_x(panels, i, static_cast<std::size_t>(columns)), columns));
  }
  return finished(run_gnuplot(Script(std::move(charts), columns).write()), panels);
}

}  // namespace poise::app
