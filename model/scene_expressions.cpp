#include "model/scene_expressions.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "model/number_spots.hpp"

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
    if (Expression::is_name(name)) continue;
    table->place_of(name).fail(
        "expected a name of letters, digits and underscores that does not begin with a digit and is neither pi nor a "
        "function");
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
    scene.named_values.push_back({names_[i], values_.back(), place.line});
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

bool same_text(const toml::node* a, const toml::node* b) {
  return a != nullptr && b != nullptr && a->is_string() && b->is_string() &&
         a->as_string()->get() == b->as_string()->get();
}

}  // namespace

void SceneExpressions::find_dependents(const toml::table& document, Scene& scene) {
  if (!written_.empty()) {
    const NumberSpots spots(document, scene);
    std::vector<DependentNumber> components;
    const auto add_components = [&](DependentPlace at, const toml::node* list, Dimension dimension) {
      const toml::array* const vector = list != nullptr ? list->as_array() : nullptr;
      for (std::size_t c = 0; vector != nullptr && c < vector->size(); ++c) {
        const toml::table* const term = vector->get(c)->as_table();
        const Written* const written = find(term != nullptr ? term->get("factor") : vector->get(c));
        at.component = static_cast<int>(c);
        if (written) components.push_back({at, written->place.item, written->expression, dimension});
      }
    };
    for (const ParameterRow& row : parameter_table(scene)) {
      const NumberSpot spot = spots.of(row);
      if (row.place.owner == Owner::force && spot.key == "vector") {
        add_components({DependentPlace::Of::force, row.place}, spot.table->get("vector"), row.dimension);
        continue;
      }
      // The last point of a cam's curve is its first: the same expression.
      const toml::node* const twin = spot.twin_node();
      const Written* const written = find(spot.node());
      if (written != nullptr && twin != nullptr && (!same_text(twin, spot.node()) || find(twin) == nullptr)) {
        written->place.fail("expected the same expression in the last point of the turn, which is the first again");
      }
      if (written) {
        dependents_.push_back(
            {{DependentPlace::Of::row, row.place}, written->place.item, written->expression, row.dimension, row.range});
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
    for (DependentNumber& one : components) dependents_.push_back(std::move(one));
    for (const auto& [node, written] : written_) {
      if (!written.is_found) {
        written.place.fail("expected a number, found an expression, which this key does not follow; write its value");
      }
    }
  }
  if (!dependents_.empty()) {
    scene.dependents = std::make_shared<const std::vector<DependentNumber>>(std::move(dependents_));
  }
}

}  // namespace poise
