#include "design/synthesis/path_curve.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "model/csv_table.hpp"
#include "model/input_error.hpp"
#include "model/text_file.hpp"
#include "model/value_range.hpp"

namespace poise {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::string_view white = " \t\r\n\f";
// A file could ask for millions of curved parts of many chords each.
constexpr std::size_t most_points = 1'000'000;

// Reads the commands of a path one after the other; coordinates as in the file, y downwards.
class SvgPath {
 public:
  SvgPath(std::string_view data, int chords) : data_(data), chords_(chords) {}

  CurveLine read() {
    skip();
    if (at_ == data_.size()) fail("expected a path that begins with M, found nothing");
    if (data_[at_] != 'M' && data_[at_] != 'm') fail("expected a path that begins with M");
    while (true) {
      skip();
      if (at_ == data_.size()) break;
      const char letter = data_[at_];
      const bool first = out_.points.empty();
      if ((letter == 'M' || letter == 'm') && !first) break;
      if (std::string_view("MmLlHhVvCcSsQqTtAaZz").find(letter) == std::string_view::npos) {
        fail("expected one of the commands M, L, H, V, C, S, Q, T, A, Z");
      }
      ++at_;
      if (letter == 'Z' || letter == 'z') {
        out_.closed = true;
        break;
      }
      run(letter);
    }
    if (out_.points.size() > 1 && out_.points.front() == out_.points.back()) {
      out_.closed = true;
      out_.points.pop_back();
    }
    for (Vec2& p : out_.points) p = conj(p);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw InputError(fmt::format("{} at character {} of the path", expected, at_ + 1));
  }

  void skip() {
    while (at_ < data_.size() && white.find(data_[at_]) != std::string_view::npos) ++at_;
  }

  void skip_comma() {
    skip();
    if (at_ < data_.size() && data_[at_] == ',') ++at_;
    skip();
  }

  bool number_follows() {
    std::size_t at = at_;
    while (at < data_.size() && (white.find(data_[at]) != std::string_view::npos || data_[at] == ',')) ++at;
    return at < data_.size() && std::string_view("+-.0123456789").find(data_[at]) != std::string_view::npos;
  }

  double number() {
    skip_comma();
    const char* begin = data_.data() + at_;
    const char* const end = data_.data() + data_.size();
    if (begin != end && *begin == '+') ++begin;
    double value = 0.0;
    const auto [stopped, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || !(std::abs(value) <= largest_value)) fail("expected a number of at most 1e50");
    at_ = static_cast<std::size_t>(stopped - data_.data());
    return value;
  }

  // The flags of an arc may stand together: "0110 5" is 0, 1, 10, 5.
  bool flag() {
    skip_comma();
    if (at_ == data_.size() || (data_[at_] != '0' && data_[at_] != '1')) fail("expected 0 or 1");
    return data_[at_++] == '1';
  }

  Vec2 pair(bool relative) {
    const double x = number();
    const double y = number();
    return relative ? now_ + Vec2{x, y} : Vec2{x, y};
  }

  void add(const Vec2& p) {
    if (out_.points.size() >= most_points) fail("expected a path of at most a million points");
    if (!(std::abs(p.x) <= largest_value && std::abs(p.y) <= largest_value)) fail("expected places of at most 1e50");
    if (out_.points.empty() || !(out_.points.back() == p)) out_.points.push_back(p);
  }

  // All the parts that one letter stands for.
  void run(char letter) {
    const bool relative = letter >= 'a';
    char command = static_cast<char>(relative ? letter - 'a' + 'A' : letter);
    do {
      part(command, relative);
      // A part that is not smooth in the way of S or T has its end as the control point that these mirror.
      if (command != 'C' && command != 'S') cubic_control_ = now_;
      if (command != 'Q' && command != 'T') square_control_ = now_;
      if (command == 'M') command = 'L';
    } while (number_follows());
  }

  void part(char command, bool relative) {
    switch (command) {
      case 'H':
        now_.x = number() + (relative ? now_.x : 0.0);
        return add(now_);
      case 'V':
        now_.y = number() + (relative ? now_.y : 0.0);
        return add(now_);
      case 'C': {
        const Vec2 first = pair(relative), second = pair(relative);
        return cubic(first, second, pair(relative));
      }
      case 'S': {
        const Vec2 first = 2.0 * now_ - cubic_control_, second = pair(relative);
        return cubic(first, second, pair(relative));
      }
      case 'Q': {
        const Vec2 control = pair(relative);
        return square(control, pair(relative));
      }
      case 'T': {
        const Vec2 control = 2.0 * now_ - square_control_;
        return square(control, pair(relative));
      }
      case 'A': {
        const double rx = std::abs(number()), ry = std::abs(number()), turned = number() * pi / 180;
        const bool large = flag(), sweep = flag();
        return arc(rx, ry, turned, large, sweep, pair(relative));
      }
      default:
        now_ = pair(relative);
        return add(now_);
    }
  }

  void cubic(const Vec2& first, const Vec2& second, const Vec2& end) {
    const Vec2 begin = now_;
    for (int k = 1; k < chords_; ++k) {
      const double t = static_cast<double>(k) / chords_, s = 1 - t;
      add(s * s * s * begin + 3 * s * s * t * first + 3 * s * t * t * second + t * t * t * end);
    }
    add(end);
    cubic_control_ = second;
    now_ = end;
  }

  void square(const Vec2& control, const Vec2& end) {
    const Vec2 begin = now_;
    for (int k = 1; k < chords_; ++k) {
      const double t = static_cast<double>(k) / chords_, s = 1 - t;
      add(s * s * begin + 2 * s * t * control + t * t * end);
    }
    add(end);
    square_control_ = control;
    now_ = end;
  }

  // The centre of the ellipse is found first (SVG 2, appendix B.2.4); radii that are too short are stretched, as there.
  void arc(double rx, double ry, double turned, bool large, bool sweep, const Vec2& end) {
    const Vec2 begin = now_;
    now_ = end;
    if (begin == end) return;
    if (rx == 0.0 || ry == 0.0) return add(end);
    const Vec2 axis = unit(turned);
    const Vec2 half = 0.5 * ((begin - end) * conj(axis));
    Vec2 scaled{half.x / rx, half.y / ry};
    const double stretch = std::max(1.0, norm(scaled));
    rx *= stretch;
    ry *= stretch;
    scaled = (1 / stretch) * scaled;
    const double square = dot(scaled, scaled);
    const double aside = std::sqrt(std::max(0.0, 1.0 / square - 1.0)) * (large == sweep ? -1.0 : 1.0);
    const Vec2 centre = aside * Vec2{scaled.y, -scaled.x};
    const Vec2 from = scaled - centre, to = -scaled - centre;
    double turn = std::atan2(cross(from, to), dot(from, to));
    if (sweep && turn < 0.0) turn += 2 * pi;
    if (!sweep && turn > 0.0) turn -= 2 * pi;
    const Vec2 middle = 0.5 * (begin + end) + Vec2{rx * centre.x, ry * centre.y} * axis;
    const double first = std::atan2(from.y, from.x);
    for (int k = 1; k < chords_; ++k) {
      const Vec2 on = unit(first + turn * k / chords_);
      add(middle + Vec2{rx * on.x, ry * on.y} * axis);
    }
    add(end);
  }

  std::string_view data_;
  int chords_;
  std::size_t at_ = 0;
  Vec2 now_{}, cubic_control_{}, square_control_{};
  CurveLine out_;
};

double distance_to_part(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double square = dot(along, along);
  const double share = square > 0.0 ? std::clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return norm(p - a - share * along);
}

std::size_t parts_of(const CurveLine& line) {
  return line.points.size() - (line.closed || line.points.empty() ? 0 : 1);
}

const Vec2& corner(const CurveLine& line, std::size_t k) { return line.points[k < line.points.size() ? k : 0]; }

void expect_curve(const CurveLine& line, const std::string& file) {
  std::vector<Vec2> different;
  for (const Vec2& p : line.points) {
    if (std::find(different.begin(), different.end(), p) == different.end()) different.push_back(p);
    if (different.size() == 3) return;
  }
  throw InputError(
      fmt::format("{}: expected a curve of at least 3 different points, found {}; give more", file, different.size()));
}

}  // namespace

CurveLine svg_curve(std::string_view data, int chords) { return SvgPath(data, chords).read(); }

std::string svg_path_data(std::string_view text) {
  for (std::size_t at = text.find("<path"); at != std::string_view::npos; at = text.find("<path", at + 1)) {
    const std::string_view element = text.substr(at, text.find('>', at) - at);
    for (std::size_t d = element.find('d'); d != std::string_view::npos; d = element.find('d', d + 1)) {
      if (white.find(element[d - 1]) == std::string_view::npos) continue;
      std::size_t next = element.find_first_not_of(white, d + 1);
      if (next == std::string_view::npos || element[next] != '=') continue;
      next = element.find_first_not_of(white, next + 1);
      if (next == std::string_view::npos || (element[next] != '"' && element[next] != '\'')) continue;
      const std::size_t end = element.find(element[next], next + 1);
      if (end == std::string_view::npos) continue;
      return std::string(element.substr(next + 1, end - next - 1));
    }
  }
  throw InputError("expected an element <path d=\"...\">; save the drawing as a path");
}

CurveLine read_curve_file(const std::filesystem::path& file) {
  CurveLine out;
  const std::string name = file.string();
  if (file.extension() == ".svg") {
    expect_regular_file(file);
    const std::string text = read_text_file(file);
    try {
      out = svg_curve(svg_path_data(text));
    } catch (const InputError& error) {
      throw InputError(name + ": " + error.what());
    }
  } else {
    const CsvTable table = read_csv(file, {"x", "y"});
    const std::vector<double>&x = table.column("x"), &y = table.column("y");
    double longest = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Vec2 p{x[k], y[k]};
      if (!out.points.empty() && out.points.back() == p) continue;
      if (!out.points.empty()) longest = std::max(longest, norm(p - out.points.back()));
      out.points.push_back(p);
    }
    constexpr double near = 1.5;
    if (out.points.size() > 3) {
      out.closed = norm(out.points.back() - out.points.front()) <= near * longest;
      if (out.points.back() == out.points.front()) out.points.pop_back();
    }
  }
  expect_curve(out, name);
  return out;
}

std::vector<Vec2> spread_evenly(const CurveLine& line, int count) {
  const std::size_t parts = parts_of(line);
  std::vector<double> ends{0.0};
  for (std::size_t k = 0; k < parts; ++k) {
    ends.push_back(ends.back() + norm(corner(line, k + 1) - corner(line, k)));
  }
  std::vector<Vec2> out;
  std::size_t part = 0;
  for (int i = 0; i < count; ++i) {
    const double at = ends.back() * i / (line.closed ? count : count - 1);
    while (part + 1 < parts && ends[part + 1] < at) ++part;
    const double length = ends[part + 1] - ends[part];
    const double share = length > 0.0 ? std::clamp((at - ends[part]) / length, 0.0, 1.0) : 0.0;
    out.push_back(corner(line, part) + share * (corner(line, part + 1) - corner(line, part)));
  }
  return out;
}

std::vector<double> curve_distances(const CurveLine& from, const CurveLine& to, int count) {
  std::vector<double> out;
  for (const Vec2& p : spread_evenly(from, count)) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < parts_of(to); ++k) {
      least = std::min(least, distance_to_part(p, corner(to, k), corner(to, k + 1)));
    }
    out.push_back(least);
  }
  return out;
}

}  // namespace poise
