#pragma once

#include <string>
#include <vector>

namespace poise::app {

/// A row of points (x[i], y[i]), in the units that the labels of its panel name. Where a value is not finite (or, on a
/// logarithmic axis, not positive) the line is broken.
struct Curve {
  enum class Style {
    line,
    points,
    dashed,
    dotted,
    crosses,  ///< at each point, in the colour of warnings: what must not be overlooked
    marked    ///< a line with a dot at each point, for short rows
  };
  std::string name;  ///< in the legend; empty: not in it
  std::vector<double> x{}, y{};
  Style style = Style::line;
  int colour = -1;  ///< of the palette, so that curves can share one; -1: the next in turn
};

/// A thin line across the panel at the height y: a limit, a mean.
struct Level {
  double y = 0.0;
  std::string name{};
};

/// A shaded strip low <= y <= high across the panel: where values are to be expected.
struct Band {
  double low = 0.0, high = 0.0;
  std::string name{};
};

/// A place of a chart that a text beside it refers to.
struct Mark {
  double x = 0.0, y = 0.0;
  std::string label{};  ///< a number or a letter or two
};

/// A thin arrow from one place to another.
struct Arrow {
  double from_x = 0.0, from_y = 0.0, to_x = 0.0, to_y = 0.0;
};

/// One chart.
struct Panel {
  std::string title{}, x_label{}, y_label{};
  bool log_x = false, log_y = false;
  bool x_falls = false;  ///< the largest x is at the left
  bool tall = false;     ///< twice as high as usual
  std::vector<Curve> curves{};
  std::vector<Level> levels{};
  std::vector<Band> bands{};
  std::vector<Mark> marks{};
  std::vector<Arrow> arrows{};
};

/// Whether there is a gnuplot to draw with.
bool has_plotter();
/// Throws InputError, naming the remedy, where there is no gnuplot to draw with: to be called before any long work.
void expect_plotter();

/// Line charts by gnuplot as one SVG (UTF-8, no outside resources, below 300 kB), filled row by row with so many
/// charts side by side. The same panels give the same text. Long curves are thinned to what can be seen.
/// Throws InputError without gnuplot, std::runtime_error where gnuplot fails.
std::string draw_plot(const std::vector<Panel>& panels, int columns = 1);

}  // namespace poise::app
