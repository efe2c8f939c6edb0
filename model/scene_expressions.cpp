#include "model/scene_expressions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "model/nearest_name.hpp"

namespace poise {
namespace {

constexpr std::size_t most_names = 1000;  // each name of an expression is looked for among all

}  // namespace

Expression SceneExpressions::parsed(const std::string& text, const TomlPlace& place) const {
  return located(place, [&] { return Expression(text, names_); });
}

void SceneExpressions::read_named(const TomlTable& root, Scene& scene) {
  const std::optional<TomlTable> table = root.find_table("numbers");
  if (!table) return;
  names_ = table->keys();
  if (names_.size() > most_names) {
    table->place().fail("expected at most 1000 numbers, found " + std::to_string(names_.size()) +
                        "; write those that nothing shares where they stand");
  }
  for (const std::string& name : names_) {
    if (!parts_.has_parts()) check_number_name(name, *table);
  }
  std::vector<std::optional<Expression>> expressions(names_.size());
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const TomlPlace place = table->place_of(names_[i]);
    if (table->holds_text(names_[i])) {
      expressions[i] = parsed(table->text(names_[i]).value, place);
      values_.push_back(0.0);
    } else {
      values_.push_back(table->number(names_[i], 1.0, Range::finite));
    }
    scene.named_values.push_back({names_[i], values_.back(), place.line_in_document()});
  }
  // Each behind those that it uses. `way`: names that wait for the values of those behind them.
  std::vector<char> is_known(names_.size(), 0);
  std::vector<std::size_t> way, next(names_.size(), 0);
  for (std::size_t first = 0; first < names_.size(); ++first) {
    way.push_back(first);
    while (!way.empty()) {
      const std::size_t i = way.back();
      const TomlPlace place = table->place_of(names_[i]);
      if (!is_known[i] && expressions[i] && next[i] < expressions[i]->uses().size()) {
        const auto used = static_cast<std::size_t>(expressions[i]->uses()[next[i]++]);
        for (std::size_t k = 0; k < way.size(); ++k) {
          if (way[k] != used) continue;
          std::string cycle;
          for (; k < way.size(); ++k) cycle += names_[way[k]] + " -> ";
          place.fail("expected numbers that do not follow from themselves, found " + cycle + names_[used] +
                     "; give one of them as a number");
        }
        way.push_back(used);
        continue;
      }
      way.pop_back();
      if (is_known[i]) continue;
      is_known[i] = 1;
      if (!expressions[i]) continue;
      const double value = expressions[i]->value(values_);
      if (!contains(Range::finite, value)) {
        place.fail(out_of_range(Range::finite, value) + " from \"" + expressions[i]->text() + "\"");
      }
      values_[i] = scene.named_values[i].value = value;
      dependents_.push_back({{DependentPlace::Of::row, {Owner::number, static_cast<int>(i)}},
                             place.item,
                             *std::move(expressions[i]),
                             dimension::none});
      expressions[i].reset();
    }
  }
}

double SceneExpressions::scale(const std::string& text) const {
  const double value = Expression(text, names_).value(values_);
  if (!contains(Range::positive, value))
    throw InputError(out_of_range(Range::positive, value) + " from \"" + text + "\"");
  return value;
}

double SceneExpressions::value(const toml::value<std::string>& node, const TomlPlace& place) {
  Expression expression = parsed(node.get(), place);
  const double value = expression.value(values_);
  written_.insert_or_assign(&node, Written{std::move(expression), place});
  return value;
}

const SceneExpressions::Written* SceneExpressions::find(const toml::node* node) {
  const auto found = written_.find(node);
  if (node == nullptr || found == written_.end()) return nullptr;
  found->second.is_found = true;
  return &found->second;
}

namespace {

/// The path of a number of a part as its file has it.
std::string path_in_file(const ParameterRow& row, const PartUse& use, std::string_view key) {
  ParameterPath path = row.path;
  const std::string prefix = use.name + ".";
  if (path.parts[1].starts_with(prefix)) path.parts[1].remove_prefix(prefix.size());
  path.parts[3] = key;
  return path.text();
}

/// What stands in front of a number of a part's file in the units of the scene: "", "-", "0.001*", "2*(s)*".
std::string factor_of(const PartUse& use, const Dimension& dimension, const Scene& scene, double more = 1.0) {
  const bool has_scale = dimension == dimension::length && !use.scale_text.empty();
  const double factor =
      more * ((has_scale ? dimension.unit(use.units) : use.unit(dimension)) / dimension.unit(scene.units));
  return (factor == 1.0    ? ""
          : factor == -1.0 ? "-"
                           : fmt::format("{}*", factor)) +
         (has_scale ? "(" + use.scale_text + ")*" : "");
}

bool same_text(const toml::node* a, const toml::node* b) {
  return a != nullptr && b != nullptr && a->is_string() && b->is_string() &&
         a->as_string()->get() == b->as_string()->get();
}

}  // namespace

Expression SceneExpressions::in_scene(const Written& written, const Dimension& dimension, const Scene& scene) const {
  if (written.place.part == nullptr) return written.expression;
  const std::string factor = factor_of(static_cast<const PartUse&>(*written.place.part), dimension, scene);
  return factor.empty() ? written.expression : parsed(factor + "(" + written.expression.text() + ")", written.place);
}

Expression SceneExpressions::shared(const PartUse& use, const std::string& path, double value,
                                    const std::string& factor, Scene& scene) {
  const std::string as_name = name_in_expressions(path);
  paths_[use.file].push_back(as_name);
  const auto replaced = use.replaced.find(as_name);
  if (replaced != use.replaced.end()) return {factor + replaced->second, names_};
  std::string name = use.file_stem + "." + as_name;
  // Paths that are told apart by other characters only.
  while (shared_.contains(name) && shared_[name] != path) name += "_";
  if (shared_.emplace(name, path).second) {
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
      throw InputError(scene.file + ":" + std::to_string(use.line) + ": part \"" + use.name +
                       "\": expected numbers of different names, found two called \"" + name +
                       "\"; give parts another name");
    }
    const auto given = parts_.given().find(name);
    names_.push_back(name);
    values_.push_back(given != parts_.given().end() ? given->second.value : value);
    scene.named_values.push_back(
        {name, values_.back(), given != parts_.given().end() ? given->second.place.line : use.line});
  }
  return {factor + name, names_};
}

void SceneExpressions::share_number(const ParameterRow& row, const NumberSpot& spot, Scene& scene) {
  const toml::node* const node = spot.node();
  const PartUse* const use = node != nullptr && node->is_number() ? parts_.use_of(*node) : nullptr;
  if (use == nullptr || row.place.owner == Owner::start || row.place.owner == Owner::number) return;
  const double sign = parts_.is_negated(*node) ? -1.0 : 1.0;
  const std::string path = path_in_file(row, *use, parts_.key_in_file(*node, row.path.parts[3]));
  dependents_.push_back(
      {{DependentPlace::Of::row, row.place},
       row.path.text(),
       shared(*use, path, sign * *node->value<double>(), factor_of(*use, row.dimension, scene, sign), scene),
       row.dimension,
       row.range});
}

// The vector of a force has the direction that it is written with, and as its size the number.
void SceneExpressions::share_force(const ParameterRow& row, const NumberSpot& spot,
                                   std::vector<DependentNumber>& components, Scene& scene) {
  const PartUse* const use = spot.table != nullptr ? parts_.use_of(*spot.table) : nullptr;
  const toml::array* const vector = use != nullptr ? spot.table->get_as<toml::array>("vector") : nullptr;
  if (vector == nullptr || vector->size() != 2) return;
  const std::optional<double> x = (*vector)[0].value<double>(), y = (*vector)[1].value<double>();
  const double size = x && y ? std::hypot(*x, *y) : 0.0;
  if (size == 0.0) return;
  const std::string path = path_in_file(row, *use, row.path.parts[3]);
  for (const int component : {0, 1}) {
    const double share = (component == 0 ? *x : *y) / size;
    components.push_back({{DependentPlace::Of::force, row.place, component},
                          row.path.text(),
                          shared(*use, path, size, factor_of(*use, row.dimension, scene, share), scene),
                          row.dimension});
  }
}

void SceneExpressions::bound_scales(std::vector<DependentNumber>& components) const {
  std::set<std::string> known;
  for (const PartUse& use : parts_.uses()) {
    if (use.scale_text.empty() || !known.insert(use.scale_text).second) continue;
    components.push_back({{DependentPlace::Of::left_out, {Owner::scene, 0}},
                          use.scale_place.item,
                          {use.scale_text, names_},
                          dimension::none,
                          Range::positive});
  }
}

void SceneExpressions::check_replacements() const {
  for (const PartNumber& number : parts_.replacements()) {
    const auto found = paths_.find(number.use->file);
    const std::vector<std::string> paths = found != paths_.end() ? found->second : std::vector<std::string>{};
    if (std::find(paths.begin(), paths.end(), name_in_expressions(number.key)) != paths.end()) continue;
    number.place.fail("expected a name of [numbers] of " + number.use->file + ", or the path of a number there" +
                      did_you_mean_or_list(number.key, paths));
  }
  std::vector<std::string> known;
  for (const auto& [name, path] : shared_) known.push_back(name);
  for (const auto& [name, given] : parts_.given()) {
    if (shared_.contains(name)) continue;
    given.place.fail("expected a number of the file of a part" + did_you_mean_or_list(name, known));
  }
}

void SceneExpressions::find_dependents(Scene& scene) {
  if (!written_.empty() || parts_.has_parts() || !scene.time_functions.empty()) {
    const NumberSpots spots(parts_.document(), scene);
    std::vector<DependentNumber> components;
    const auto add_components = [&](DependentPlace at, const toml::node* list, Dimension dimension) {
      const toml::array* const vector = list != nullptr ? list->as_array() : nullptr;
      for (std::size_t c = 0; vector != nullptr && c < vector->size(); ++c) {
        const toml::table* const term = vector->get(c)->as_table();
        const Written* const written = find(term != nullptr ? term->get("factor") : vector->get(c));
        at.component = static_cast<int>(c);
        if (written) components.push_back({at, written->place.item, in_scene(*written, dimension, scene), dimension});
      }
    };
    for (const ParameterRow& row : parameter_table(scene)) {
      if (const std::string_view name = name_in_formula(row); !name.empty()) {
        dependents_.push_back(
            {{DependentPlace::Of::row, row.place}, row.path.text(), {name, names_}, row.dimension, row.range});
        continue;
      }
      const NumberSpot spot = spots.of(row);
      if (row.place.owner == Owner::force && spot.key == "vector") {
        add_components({DependentPlace::Of::force, row.place}, spot.table->get("vector"), row.dimension);
        if (parts_.has_parts()) share_force(row, spot, components, scene);
        continue;
      }
      // The last point of a cam's curve is its first: the same expression.
      const toml::node* const twin = spot.twin_node();
      const Written* const written = find(spot.node());
      if (written != nullptr && twin != nullptr && (!same_text(twin, spot.node()) || find(twin) == nullptr)) {
        written->place.fail("expected the same expression in the last point of the turn, which is the first again");
      }
      if (written) {
        dependents_.push_back({{DependentPlace::Of::row, row.place},
                               written->place.item,
                               in_scene(*written, row.dimension, scene),
                               row.dimension,
                               row.range});
      } else if (parts_.has_parts()) {
        share_number(row, spot, scene);
      }
    }
    const auto add_all = [&](Owner owner, DependentPlace::Of of, std::string_view key, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        const ParameterPlace place{owner, static_cast<int>(i)};
        const toml::table* const table = spots.item(owner, place.item);
        add_components({of, place}, table != nullptr ? table->get(key) : nullptr, dimension::none);
      }
    };
    add_all(Owner::joint, DependentPlace::Of::axis, "axis", scene.joints.size());
    add_all(Owner::element, DependentPlace::Of::factor, "sum", scene.elements.size());
    add_all(Owner::drive, DependentPlace::Of::factor, "sum", scene.drives.size());
    add_all(Owner::stop, DependentPlace::Of::factor, "sum", scene.stops.size());
    bound_scales(components);
    for (DependentNumber& one : components) dependents_.push_back(std::move(one));
    check_replacements();
    for (const auto& [node, written] : written_) {
      if (!written.is_found) {
        written.place.fail("expected a number, found an expression, which this key does not follow; write its value");
      }
    }
  }
  if (!dependents_.empty()) {
    scene.dependents = std::make_shared<const std::vector<DependentNumber>>(std::move(dependents_));
    // Numbers that a table [[part]] gives have been read as their file has them.
    if (parts_.has_parts()) located({scene.file, 0, ""}, [&] { follow_expressions(scene, true); });
  }
}

}  // namespace poise
