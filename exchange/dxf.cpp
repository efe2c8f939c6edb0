#include "exchange/dxf.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/drawn_scene.hpp"
#include "exchange/private/dxf_entities.hpp"
#include "exchange/private/posed_links.hpp"
#include "exchange/private/reading.hpp"
#include "model/one_line.hpp"

namespace poise {
namespace {

// Reading.

struct UnitOfDrawing {
  std::string length;
  double factor = 1.0;  // units of the scene in one of the drawing
};

UnitOfDrawing unit_of_drawing(const DxfDrawing& drawing, const std::string& file, const ImportOptions& options,
                              std::vector<std::string>& notes) {
  if (!drawing.units) return {length_unit(options, "mm", notes), 1.0};
  switch (*drawing.units) {
    case 1:
      return {"in", 1.0};
    case 2:
      return {"ft", 1.0};
    case 4:
      return {"mm", 1.0};
    case 5:
      notes.emplace_back("Lengths are cm in the drawing and mm here.");
      return {"mm", 10.0};
    case 6:
      return {"m", 1.0};
    default:
      fail_at(file, 0, "$INSUNITS",
              fmt::format("expected 1 (in), 2 (ft), 4 (mm), 5 (cm) or 6 (m), found {}", *drawing.units));
  }
}

double size_of(const std::vector<DxfDrawing::Point>& points) {
  Vec2 low = points.front().at, high = low;
  for (const DxfDrawing::Point& point : points) {
    low = {std::min(low.x, point.at.x), std::min(low.y, point.at.y)};
    high = {std::max(high.x, point.at.x), std::max(high.y, point.at.y)};
  }
  return norm(high - low);
}

/// Which points are one: for each the first of those that it is one with.
class Clusters {
 public:
  Clusters(const std::vector<DxfDrawing::Point>& points, double tolerance) : points_(points), first_(points.size()) {
    std::iota(first_.begin(), first_.end(), 0U);
    for_pairs(tolerance, [&](std::size_t i, std::size_t k) {
      const std::size_t a = of(i), b = of(k);
      first_[std::max(a, b)] = std::min(a, b);
    });
  }

  std::size_t of(std::size_t point) {
    while (first_[point] != point) point = first_[point] = first_[first_[point]];
    return point;
  }

  /// visit(i, k) for all pairs of points that are no farther apart.
  template <class Visit>
  void for_pairs(double distance, Visit visit) const {
    std::vector<std::size_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t k) { return points_[i].at.x < points_[k].at.x; });
    for (auto i = order.begin(); i != order.end(); ++i) {
      for (auto k = i + 1; k != order.end() && points_[*k].at.x - points_[*i].at.x <= distance; ++k) {
        if (norm(points_[*k].at - points_[*i].at) <= distance) visit(*i, *k);
      }
    }
  }

 private:
  const std::vector<DxfDrawing::Point>& points_;
  std::vector<std::size_t> first_;
};

class DxfImport {
 public:
  DxfImport(const DxfDrawing& drawing, const std::string& file, const ImportOptions& options)
      : points_(drawing.points), tolerance_(tolerance_of(drawing, file, options)), clusters_(points_, tolerance_) {
    std::vector<std::string> notes;
    const UnitOfDrawing unit = unit_of_drawing(drawing, file, options, notes);
    factor_ = unit.factor;
    scene_.emplace(file, UnitNames{.length = unit.length});
    for (std::string& note : notes) scene_->add_note(std::move(note));
    if (drawing.labels > 0)
      note_count(drawing.labels, "text, dimension or hatch is", "texts, dimensions or hatches are");
    if (drawing.on_paper > 0) note_count(drawing.on_paper, "entity of a sheet is", "entities of sheets are");
  }

  Imported scene() {
    name_layers();
    add_points();
    add_pins();
    note_near_misses();
    scene_->add_note("Only geometry is taken: no link has a mass.");
    return scene_->finish();
  }

 private:
  struct Place {
    std::string name;
    Vec2 at{};
    std::vector<std::string> links{};  // once each
  };

  static double tolerance_of(const DxfDrawing& drawing, const std::string& file, const ImportOptions& options) {
    if (drawing.points.empty()) fail_at(file, 0, "ENTITIES", "expected lines, circles or points, found none");
    constexpr double of_size = 1e-6;
    return options.tolerance.value_or(of_size * size_of(drawing.points));
  }

  void note_count(int number, const std::string& singular, const std::string& plural) {
    scene_->add_note(fmt::format("{} {} left out.", number, number == 1 ? singular : plural));
  }

  void name_layers() {
    std::unordered_set<std::string> taken = {"ground"};
    for (const DxfDrawing::Point& point : points_) {
      if (names_.count(point.layer) != 0) continue;
      const bool is_ground = in_small_letters(point.layer) == "ground";
      names_[point.layer] = is_ground ? "ground" : name_beside(point.layer, taken);
    }
  }

  /// One point of each link at each place, which is that of the ground's point, or of the first that was drawn.
  void add_points() {
    std::map<std::size_t, std::size_t> place_of_cluster;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::string& link = names_.at(points_[i].layer);
      const auto [index, is_new] = place_of_cluster.emplace(clusters_.of(i), places_.size());
      if (is_new) places_.push_back({point_name(places_.size()), points_[i].at});
      Place& place = places_[index->second];
      if (std::find(place.links.begin(), place.links.end(), link) != place.links.end()) continue;
      if (link == "ground") {
        place.at = points_[i].at;
        place.links.insert(place.links.begin(), link);
      } else {
        place.links.push_back(link);
      }
    }
    for (const Place& place : places_) {
      for (const std::string& link : place.links) scene_->add_point(link, place.name, factor_ * place.at);
    }
  }

  void add_pins() {
    int pins = 0;
    std::map<std::pair<std::string, std::string>, int> between;
    std::set<std::string> pinned;
    for (const Place& place : places_) {
      for (std::size_t k = 1; k < place.links.size(); ++k) {
        scene_->add_joint({Joint::Kind::pin, {place.links[0], place.name}, {place.links[k], place.name}});
        ++between[std::minmax(place.links[0], place.links[k])];
        pinned.insert({place.links[0], place.links[k]});
        ++pins;
      }
    }
    scene_->add_note(fmt::format("Each layer is a link, and {} where points of layers are within {:.3g}.",
                                 pins == 1 ? "1 pin is" : fmt::format("{} pins are", pins), tolerance_));
    for (const auto& [links, number] : between) {
      if (number > 1) {
        scene_->add_note(fmt::format("{} and {} have {} pins: they do not turn against each other.", links.first,
                                     links.second, number));
      }
    }
    for (const auto& [layer, link] : names_) {
      if (link != "ground" && pinned.count(link) == 0) {
        scene_->add_note(fmt::format("{} meets no other layer: it is free.", link));
      }
    }
  }

  /// Points of two links that were perhaps meant to be one.
  void note_near_misses() {
    constexpr double times = 1000.0;
    constexpr int most_notes = 5;
    std::set<std::pair<std::size_t, std::size_t>> seen;
    clusters_.for_pairs(times * tolerance_, [&](std::size_t i, std::size_t k) {
      const std::size_t a = clusters_.of(i), b = clusters_.of(k);
      const std::string &one = names_.at(points_[i].layer), &other = names_.at(points_[k].layer);
      if (a == b || one == other || seen.size() >= most_notes || !seen.insert(std::minmax(a, b)).second) return;
      scene_->add_note(fmt::format("Points of {} and {} are {:.3g} apart, which is no pin; --tolerance makes it one.",
                                   one, other, norm(points_[i].at - points_[k].at)));
    });
  }

  const std::vector<DxfDrawing::Point>& points_;
  double tolerance_;
  Clusters clusters_;
  double factor_ = 1.0;
  std::optional<DrawnScene> scene_;
  std::map<std::string, std::string> names_;  // of links, by layers
  std::vector<Place> places_;
};

// Writing.

/// A layer name that old and new programs take.
std::string layer_name(const std::string& name, std::unordered_set<std::string>& taken) {
  constexpr std::size_t longest = 31;
  std::string base;
  for (const char c : name.substr(0, longest)) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    base += is_plain ? c : '_';
  }
  std::string out = base;
  for (int k = 2; !taken.insert(in_small_letters(out)).second; ++k) out = fmt::format("{}_{}", base, k);
  return out;
}

class DxfExport {
 public:
  DxfExport(const Scene& scene, const std::vector<BodyPose<double>>& poses) : scene_(scene), links_(scene, poses) {}

  Exported text() {
    for (const PosedLinks::Link& link : links_.links()) {
      layers_.push_back(layers_.empty() ? "GROUND" : layer_name(link.name, taken_));
      is_renamed_ = is_renamed_ || (layers_.size() > 1 && layers_.back() != link.name);
    }
    write_head();
    for (std::size_t l = 0; l < layers_.size(); ++l) write_link(links_, l, l);
    for (const PosedLinks::Node& node : links_.nodes()) {
      if (node.links.size() < 2) continue;
      for (const std::size_t link : node.links) write_circle(link, node.at);
    }
    write_end();
    return {out_, notes()};
  }

  /// This position, then the others, each on its layer.
  Exported text(const std::vector<NamedPosition>& positions) {
    layers_.emplace_back("GROUND");
    for (const NamedPosition& one : positions) layers_.push_back(layer_name(one.name, taken_));
    write_head();
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const PosedLinks links(positions[k].scene, positions[k].poses);
      if (k == 0) write_link(links, 0, 0);
      for (std::size_t l = 1; l < links.links().size(); ++l) write_link(links, l, k + 1);
      for (const PosedLinks::Node& node : links.nodes()) {
        if (node.links.size() > 1) write_circle(k + 1, node.at);
      }
    }
    write_end();
    return {out_,
            {fmt::format("The {} positions are layers, on which links cannot be told apart when the file is read.",
                         positions.size()),
             "Slides, springs, masses, loads and all else but links and pins are left out."}};
  }

 private:
  void group(int code, std::string_view value) { out_ += fmt::format("{:3}\n{}\n", code, value); }
  void number(int code, double value) { group(code, fmt::format("{}", value)); }
  void begin(std::string_view kind, std::size_t layer) {
    group(0, kind);
    group(8, layers_[layer]);
  }
  void at(int code, Vec2 place) {
    number(code, place.x);
    number(code + 10, place.y);
  }

  void write_head() {
    const std::string& length = scene_.units.length_name;
    const int units = length == "in" ? 1 : length == "ft" ? 2 : length == "mm" ? 4 : 6;
    group(0, "SECTION");
    group(2, "HEADER");
    group(9, "$ACADVER");
    group(1, "AC1009");
    group(9, "$INSUNITS");
    group(70, std::to_string(units));
    group(0, "ENDSEC");
    group(0, "SECTION");
    group(2, "TABLES");
    group(0, "TABLE");
    group(2, "LAYER");
    group(70, std::to_string(layers_.size()));
    constexpr std::size_t colours = 6;  // red to magenta
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      group(0, "LAYER");
      group(2, layers_[l]);
      group(70, "0");
      group(62, l == 0 ? "7" : std::to_string(1 + (l - 1) % colours));
      group(6, "CONTINUOUS");
    }
    group(0, "ENDTAB");
    group(0, "ENDSEC");
    group(0, "SECTION");
    group(2, "ENTITIES");
  }

  void write_end() {
    group(0, "ENDSEC");
    group(0, "EOF");
  }

  /// Lines through its points in their order; points alone, and those of the ground, as such.
  void write_link(const PosedLinks& links, std::size_t l, std::size_t layer) {
    std::vector<Vec2> places;
    for (const Vec2& place : links.links()[l].places) {
      size_ = std::max({size_, std::abs(place.x), std::abs(place.y)});
      if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    }
    if (l == 0 || places.size() < 2) {
      for (const Vec2& place : places) {
        begin("POINT", layer);
        at(10, place);
      }
      return;
    }
    const std::size_t lines = places.size() == 2 ? 1 : places.size();
    for (std::size_t p = 0; p < lines; ++p) {
      begin("LINE", layer);
      at(10, places[p]);
      at(11, places[(p + 1) % places.size()]);
    }
  }

  void write_circle(std::size_t layer, Vec2 centre) {
    constexpr double of_size = 0.01;
    begin("CIRCLE", layer);
    at(10, centre);
    number(40, short_number(size_ > 0.0 ? of_size * size_ : 1.0));
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> out = links_.welds();
    if (is_renamed_) out.emplace_back("Layers are named by letters, digits, - and _, links that are not have others.");
    for (const Joint& joint : scene_.joints) {
      if (joint.has_travel()) {
        out.push_back(fmt::format("The {} {} is left out: of a drawing pins alone are read.",
                                  words_of_key(joint.traits().key), joint.name));
      }
    }
    note_coincidences(out);
    const std::vector<std::string> more = links_.left_out();
    out.insert(out.end(), more.begin(), more.end());
    out.emplace_back("Masses and loads are left out.");
    return out;
  }

  /// Points that are at one place here without a pin, which a reader would take for one.
  void note_coincidences(std::vector<std::string>& out) const {
    constexpr double of_size = 1e-6;
    std::vector<const PosedLinks::Node*> order;
    for (const PosedLinks::Node& node : links_.nodes()) order.push_back(&node);
    std::sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->at.x < b->at.x; });
    for (auto i = order.begin(); i != order.end(); ++i) {
      for (auto k = i + 1; k != order.end() && (*k)->at.x - (*i)->at.x <= of_size * size_; ++k) {
        if (norm((*k)->at - (*i)->at) > of_size * size_) continue;
        const std::string &one = links_.links()[(*i)->links.front()].name,
                          &other = links_.links()[(*k)->links.front()].name;
        if (one == other) continue;
        out.push_back(
            fmt::format("Points of {} and {} coincide here without a pin, which a reader takes for one.", one, other));
      }
    }
  }

  const Scene& scene_;
  PosedLinks links_;
  std::vector<std::string> layers_;
  std::unordered_set<std::string> taken_ = {"ground"};
  bool is_renamed_ = false;
  double size_ = 0.0;
  std::string out_;
};

}  // namespace

Imported import_dxf(std::string_view text, const std::string& file, const ImportOptions& options) {
  const DxfDrawing drawing = read_dxf(text, file);
  return DxfImport(drawing, file, options).scene();
}

Exported export_dxf(const Scene& scene, const std::vector<BodyPose<double>>& poses) {
  return DxfExport(scene, poses).text();
}

Exported export_dxf_positions(const std::vector<NamedPosition>& positions) {
  return DxfExport(positions.front().scene, positions.front().poses).text(positions);
}

}  // namespace poise
