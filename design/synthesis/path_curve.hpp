#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "model/planar.hpp"

namespace poise {

/// A line of points that are joined by straight parts.
struct CurveLine {
  std::vector<Vec2> points{};
  bool closed = false;  ///< the last point is joined to the first
};

/// The curve of the data of an SVG path (SVG 2, section 9.3): M, L, H, V, C, S, Q, T, A and Z, absolute and relative,
/// as points that lie on it, each curved part as so many chords; y upwards, so that what is drawn up is up. Only the
/// first part, up to the next M, is read; it is closed by Z, or where it ends at its begin. Throws InputError, without
/// a place, of what is wrong and at which character.
CurveLine svg_curve(std::string_view data, int chords = 256);

/// The data of the first <path> with an attribute d of an SVG text. Throws InputError where there is none.
std::string svg_path_data(std::string_view text);

/// A curve from a file: columns x and y of a CSV file, or the first path of an SVG file (named *.svg); in the units of
/// the file. A CSV curve is closed where its last point is its first, or nearer to it than 1.5 of the largest distance
/// of neighbours. Throws InputError, also of curves of fewer than three different points.
CurveLine read_curve_file(const std::filesystem::path& file);

/// Points spread evenly along a line by its length: of a closed one without the begin once more at the end.
std::vector<Vec2> spread_evenly(const CurveLine& line, int count);

/// The distances from points of one line, spread evenly over so many, to the nearest place of another.
std::vector<double> curve_distances(const CurveLine& from, const CurveLine& to, int count);

}  // namespace poise
