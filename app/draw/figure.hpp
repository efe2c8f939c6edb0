#pragma once

// What a page shows beside its text: pictures of mechanisms that may move, and charts. SVG files are made of the same
// canvases and panels.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/draw/canvas.hpp"
#include "app/draw/chart/plot.hpp"
#include "app/result/tone.hpp"

namespace poise::app {

/// A mechanism in one position, as drawn.
struct Frame {
  Canvas canvas;
  std::string caption{};  ///< one line; empty: none
  Tone tone = Tone::plain;
  bool confirmed = true;  ///< what it shows is proved, or part of a computed motion that is confirmed
};

/// Where the world is on a drawing.
struct FrameView {
  double scale = 1.0;  ///< px per m
  Vec2 origin{};       ///< px: of the world's origin

  Vec2 page(Vec2 world) const { return origin + scale * conj(world); }
  Vec2 world(Vec2 page) const { return (1 / scale) * conj(page - origin); }
};

/// Pictures of one mechanism in one scale, their upper left corner at 0, 0.
struct Drawing {
  double width = 0.0, height = 0.0;  ///< px
  std::string description{};         ///< in words, for readers who do not see it
  std::vector<Frame> frames{};
  Canvas still{};  ///< what all frames show beside the mechanism: legend, scale, gravity
  FrameView view{};
};

/// A point of the mechanism, px in every frame.
struct FollowedPoint {
  std::string name;  ///< "coupler.P"
  std::vector<Vec2> at;
  bool traced = false;  ///< its path is shown at first
};

/// How the frames of a drawing follow each other.
struct Play {
  std::string label, unit{};     ///< of the values: "time", "s"
  std::vector<double> values{};  ///< one for each frame
  double seconds = 8.0;          ///< how long playing takes, snaps not counted
  /// An event, at a frame.
  struct Mark {
    std::size_t frame = 0;
    std::string label, caption;
  };
  std::vector<Mark> marks{};
  /// Frames to be played slowly.
  struct Snap {
    std::size_t first = 0, last = 0;
    std::string caption;
  };
  std::vector<Snap> snaps{};
  std::size_t rest = 0;  ///< the frame shown first
  std::vector<FollowedPoint> points{};
};

/// Where every frame stands in a chart: a point, or, without y, a vertical line. Not a number: nowhere.
struct ChartCursor {
  std::vector<double> x{}, y{};
};

/// Charts, so many side by side.
struct Charts {
  std::vector<Panel> panels{};
  std::vector<ChartCursor> cursors{};  ///< empty, or one for each panel
  int columns = 1;
};

/// One figure of a page: a drawing, with charts beside it whose cursors follow its frames; or charts alone.
struct Figure {
  std::string title{};
  Drawing drawing{};           ///< without frames: charts alone
  std::optional<Play> play{};  ///< of several frames; without it they are shown side by side, as cards
  bool switched = false;       ///< one frame at a time, large, chosen by its caption
  Charts charts{};
};

}  // namespace poise::app
