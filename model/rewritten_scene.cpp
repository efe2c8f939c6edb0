#include "model/rewritten_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/number_spots.hpp"
#include "model/parameter_values.hpp"
#include "model/parameters.hpp"
#include "model/parts.hpp"
#include "model/scene_text.hpp"
#include "model/toml_edits.hpp"
#include "model/toml_reader.hpp"
#include "model/toml_text.hpp"

namespace poise {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

class Rewriter {
 public:
  Rewriter(std::string_view text, const std::string& file, const Scene& wanted)
      : file_(file),
        wanted_(wanted),
        old_(parse_sketch(text, file)),
        own_(parse_toml(text, file)),
        edits_(text, own_),
        parts_(parse_toml(text, file), {file, 1, ""}),
        spots_(parts_.document(), old_),
        rows_(parameter_table(old_)),
        old_values_(parameter_values(old_)),
        wanted_values_(parameter_values(wanted)) {
    const std::vector<ParameterRow> rows = parameter_table(wanted);
    if (!std::equal(rows.begin(), rows.end(), rows_.begin(), rows_.end(),
                    [](const ParameterRow& a, const ParameterRow& b) { return a.place == b.place; })) {
      fail();
    }
  }

  std::string run() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      // What follows from other numbers follows from those that are written.
      if (dependent_number(old_, rows_[i].place) != nullptr || ends_with_curve(rows_[i].place)) continue;
      if (wanted_values_[i] && wanted_values_[i] != old_values_[i]) write(i);
    }
    for (std::size_t f = 0; f < old_.forces.size(); ++f) write_direction(static_cast<int>(f));
    for (const auto& [place, numbers] : additions_) {
      edits_.add(place.second, place.first, {numbers.begin(), numbers.end()});
    }
    return edits_.made();
  }

  /// That the text has the numbers wanted. Rounding to the unit of the file and back is all that may differ.
  void check() const {
    constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const ParameterRow& row = rows_[i];
      const std::optional<double>&value = wanted_values_[i], &read = old_values_[i];
      if (!value || value == read || (read && std::abs(*value - *read) <= rounding * std::abs(*value))) continue;
      if (const DependentNumber* const dependent = dependent_number(wanted_, row.place)) {
        if (row.place.owner == Owner::start) continue;  // a guess stays one
        throw InputError(fmt::format(
            "{}: {}: expected the value of its expression \"{}\", found {}; write it as a number", file_,
            row.path.text(), dependent->expression.text(), toml_number(*value / row.dimension.unit(wanted_.units))));
      }
      const PartUse* const use = part_of(spots_.of(row));
      throw InputError(fmt::format("{}: {}: expected a number that can be written into this file; write it {} as {}",
                                   file_, row.path.text(), use != nullptr ? "into " + use->file : "there",
                                   toml_number(*value / row.dimension.unit(wanted_.units))));
    }
    // A closed profile that rolls counts the turns of its body from where its first point touches.
    for (std::size_t s = 0; s + 2 < old_.stops.size(); ++s) {
      if (!is_rolling_profile(old_.stops[s]) || !old_.stops[s].closed) continue;
      const auto first_touch = [&](const Scene& scene) {
        const Stop& tangent = scene.stops[s + 2];
        return tangent.min - tangent.on.terms[1].profile->at(0.0).value;
      };
      if (std::abs(first_touch(old_) - first_touch(wanted_)) < 1.0) continue;
      throw InputError(
          fmt::format("{}: {} \"{}\".curve: expected a first point that touches within half a turn of the body, from "
                      "which files count its turns; begin the curve at another point",
                      file_, old_.stops[s].table, old_.stops[s].name));
    }
  }

 private:
  /// The end of a slot, or of a profile that rolls, that is the end of its curve in the scene too that is wanted.
  bool ends_with_curve(const ParameterPlace& place) const {
    if (place.owner != Owner::coupling) return false;
    const auto first = static_cast<std::size_t>(place.item);
    for (std::size_t s = first; s < old_.stops.size(); ++s) {
      const CouplingKind* const kind = coupling_kind(old_.stops[s]);
      if (kind == nullptr || (s > first && kind->row == 0)) break;
      if (!old_.stops[s].to_end || !wanted_.stops[s].to_end) continue;
      for (const CouplingPart& part : kind->parts) {
        if (part.of == CouplingPart::Of::upper && part.number == place.number) return true;
      }
    }
    return false;
  }

  [[noreturn]] void fail() const {
    throw InputError(file_ + ": expected the scene that was read before; leave it unchanged until the end");
  }

  /// In the units of the file, so that reading it gives exactly this number where that is possible, in few digits.
  static std::string in_unit(double si, double unit) {
    const double near = si / unit;
    std::string out;
    for (const double value : {near, std::nextafter(near, -INFINITY), std::nextafter(near, INFINITY)}) {
      const std::string text = toml_number(value);
      if (value * unit == si && (out.empty() || text.size() < out.size())) out = text;
    }
    return out.empty() ? toml_number(near) : out;
  }

  /// The part in whose file the table of a number is; null where that is the text.
  const PartUse* part_of(const NumberSpot& spot) const {
    return spot.table != nullptr ? parts_.use_of(*spot.table) : nullptr;
  }

  /// Whether the text has it, as it has numbers of a table [[part]], which the document has in [numbers].
  bool is_of_text(const toml::node* node) const {
    return node != nullptr && node->source().begin && parts_.use_of(*node) == nullptr;
  }

  /// The spot in the text alone. Numbers that the files of parts have, and guesses there, get their values in [numbers]
  /// and [start].
  NumberSpot in_text(const ParameterRow& row) const {
    NumberSpot spot = spots_.of(row);
    const auto below = [](const toml::table* in, std::string_view key) {
      return in != nullptr ? in->get_as<toml::table>(key) : nullptr;
    };
    if (row.place.owner == Owner::scene) spot.table = &own_;
    if (row.place.owner == Owner::number && !is_of_text(spot.node())) spot.table = below(&own_, "numbers");
    if (row.place.owner == Owner::start) {
      spot.table = row.place.part < 2 ? below(&own_, "start") : below(below(&own_, "start"), "position");
    }
    if (row.place.owner == Owner::body && part_of(spot) == nullptr)
      spot.table = below(below(&own_, "body"), row.path.parts[1]);
    return spot;
  }

  void write(std::size_t place) {
    const ParameterRow& row = rows_[place];
    const NumberSpot spot = in_text(row);
    // None of the text, which check() says.
    if ((spot.table == nullptr && spot.header.empty()) || part_of(spot) != nullptr) return;
    const double unit = row.dimension.unit(wanted_.units);
    const toml::node* const node = spot.table != nullptr ? spot.table->get(spot.key) : nullptr;
    if (node != nullptr && !node->source().begin) return;  // where a repeated part is
    const auto number = [&](const std::optional<double>& si) { return in_unit(si.value_or(0.0), unit); };
    const std::string own = number(wanted_values_[place]);
    if (row.place.owner == Owner::force && spot.key == "vector") {
      const Vec2& vector = wanted_.forces[static_cast<std::size_t>(row.place.item)].vector;
      if (node == nullptr) fail();
      replace(*node, 0, number(vector.x));
      replace(*node, 1, number(vector.y));
    } else if (spot.point >= 0) {
      const toml::array* const points = node != nullptr ? node->as_array() : nullptr;
      const auto point = static_cast<std::size_t>(spot.point);
      if (points == nullptr || point >= points->size()) fail();
      replace(*points->get(point), spot.component, own);
      if (spot.twin >= 0) replace(*points->get(static_cast<std::size_t>(spot.twin)), spot.component, own);
    } else if (node != nullptr) {
      replace(*node, spot.component, own);
    } else if (spot.component < 0) {
      additions_[{spot.header, spot.table}][spot.key] = own;
    } else {
      // The two components of a vector are rows that follow each other.
      const std::size_t first = place - static_cast<std::size_t>(spot.component);
      additions_[{spot.header, spot.table}][spot.key] =
          fmt::format("[{}, {}]", number(wanted_values_.at(first)), number(wanted_values_.at(first + 1)));
    }
  }

  /// That of a force which is given by it, where it is another.
  void write_direction(int force) {
    const Vec2 &was = old_.forces[static_cast<std::size_t>(force)].along,
               &along = wanted_.forces[static_cast<std::size_t>(force)].along;
    if (was == along) return;
    const toml::table* const table = spots_.item(Owner::force, force);
    if (table != nullptr && parts_.use_of(*table) != nullptr) fail();
    const toml::node* const node = table != nullptr ? table->get("direction") : nullptr;
    if (node == nullptr || along == Vec2{}) fail();
    replace(*node, 0, toml_number(along.x));
    replace(*node, 1, toml_number(along.y));
  }

  void replace(const toml::node& node, int component, std::string number) {
    const toml::array* const vector = node.as_array();
    if (component >= 0 && (vector == nullptr || vector->size() != 2)) fail();
    const toml::node& old = component < 0 ? node : *vector->get(static_cast<std::size_t>(component));
    edits_.replace(old, std::move(number));
  }

  using TablePlace = std::pair<std::string, const toml::table*>;  // by its header, to be added in that order
  using Numbers = std::map<std::string, std::string>;

  const std::string& file_;
  const Scene& wanted_;
  Scene old_;
  toml::table own_;  // of the text alone
  TomlEdits edits_;
  PartedDocument parts_;
  NumberSpots spots_;
  std::vector<ParameterRow> rows_;  // of the text, and of the scene that is wanted
  std::vector<std::optional<double>> old_values_, wanted_values_;
  std::map<TablePlace, Numbers> additions_;
};

}  // namespace

std::string rewritten_scene(std::string_view text, const std::string& file, const Scene& wanted) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  // Constants of couplings that the text leaves out follow from the guesses. Where these have changed, reading the text
  // gives other constants, which are then written too.
  const std::string once = Rewriter(text, file, wanted).run();
  std::string twice = Rewriter(once, file, wanted).run();
  Rewriter(twice, file, wanted).check();
  return twice;
}

}  // namespace poise
