#include "model/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <variant>

#include "model/controllers.hpp"
#include "model/couplings.hpp"
#include "model/curved_slots.hpp"
#include "model/dependent_number.hpp"
#include "model/gas_struts.hpp"
#include "model/nearest_name.hpp"
#include "model/parameter_values.hpp"

namespace poise {
namespace {

constexpr std::array<Number, 1> angle_guess{[] {
  Number number{"", dimension::angle};
  number.get = [](const void* item) { return *static_cast<const std::optional<double>*>(item); };
  number.set = [](void* item, double value) { *static_cast<std::optional<double>*>(item) = value; };
  number.scale = [](void* item, double factor) {
    auto& guess = *static_cast<std::optional<double>*>(item);
    if (guess) *guess *= factor;
  };
  return number;
}()};

constexpr std::array<Number, 1> travel_guess{[] {
  Number number = angle_guess[0];
  number.dimension = dimension::length;
  return number;
}()};

template <int Component>
constexpr Number place_guess(std::string_view key) {
  Number number{key, dimension::length};
  number.get = [](const void* item) {
    const auto& guess = *static_cast<const std::optional<Vec2>*>(item);
    return guess ? std::optional<double>(Component == 0 ? guess->x : guess->y) : std::nullopt;
  };
  number.set = [](void* item, double value) {
    auto& guess = *static_cast<std::optional<Vec2>*>(item);
    if (!guess) guess.emplace();
    (Component == 0 ? guess->x : guess->y) = value;
  };
  number.scale = [](void* item, double factor) {
    auto& guess = *static_cast<std::optional<Vec2>*>(item);
    if (guess) (Component == 0 ? guess->x : guess->y) *= factor;
  };
  return number;
}

/// What a function of the frame's place is on.
const Measure place_of_frame = Measure::x_of({});

constexpr std::array<Number, 2> place_guesses{place_guess<0>("x"), place_guess<1>("y")};

bool has_gas_struts(const Scene& scene) {
  return std::any_of(scene.elements.begin(), scene.elements.end(),
                     [](const Element& element) { return std::holds_alternative<GasStrut>(element.law); });
}

/// Calls use(prefix of their path, place, item, numbers, measure of the item or null) for the numbers of every item.
template <class AnyScene, class Use>
void visit_items(AnyScene& scene, Use use) {
  using Parts = std::array<std::string_view, 4>;
  const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
  const Measure* const none = nullptr;
  for (int i = 0; i < count(scene.named_values); ++i) {
    auto& named = scene.named_values[i];
    use(Parts{"numbers", named.name}, ParameterPlace{Owner::number, i}, named,
        std::span<const Number>(SceneNumber::numbers), none);
  }
  use(Parts{"gravity"}, ParameterPlace{Owner::scene}, scene, std::span<const Number>(Scene::numbers), none);
  for (int i = 0; i < count(scene.forces); ++i) {
    auto& force = scene.forces[i];
    use(Parts{"load", force.name}, ParameterPlace{Owner::force, i}, force, force.numbers(), none);
  }
  for (int i = 0; i < count(scene.torques); ++i) {
    auto& torque = scene.torques[i];
    use(Parts{"load", torque.name}, ParameterPlace{Owner::torque, i}, torque, std::span<const Number>(Torque::numbers),
        none);
  }
  const std::vector<int> of_tracks = bodies_of_tracks(scene);
  const auto is_of_track = [&](int body) {
    return std::find(of_tracks.begin(), of_tracks.end(), body) != of_tracks.end();
  };
  for (int i = 0; i < count(scene.bodies); ++i) {
    auto& body = scene.bodies[i];
    if (is_of_track(i)) {
      // The guess for the angle of a line of centres has the name of its wheel's contact.
      if (!is_rider(scene, i)) {
        use(Parts{"start", body.name}, ParameterPlace{Owner::start, i, 0}, scene.start.angle.at(i),
            std::span<const Number>(angle_guess), none);
      }
      continue;
    }
    for (int p = 0; p < count(body.points); ++p) {
      use(Parts{"point", body.name, body.points[p].name}, ParameterPlace{Owner::point, i, p}, body.points[p],
          std::span<const Number>(NamedPoint::numbers), none);
    }
    if (i == 0) continue;
    use(Parts{"body", body.name}, ParameterPlace{Owner::body, i}, body, std::span<const Number>(Body::numbers), none);
    if (body.section) {
      use(Parts{"body", body.name, "section"}, ParameterPlace{Owner::section, i}, *body.section,
          std::span<const Number>(CrossSection::numbers), none);
    }
    use(Parts{"start", body.name}, ParameterPlace{Owner::start, i, 0}, scene.start.angle.at(i),
        std::span<const Number>(angle_guess), none);
    use(Parts{"start", body.name}, ParameterPlace{Owner::start, i, 2}, scene.start.position.at(i),
        std::span<const Number>(place_guesses), none);
  }
  for (int i = 0; i < count(scene.flexible_links); ++i) {
    auto& link = scene.flexible_links[i];
    use(Parts{"body", link.name, "section"}, ParameterPlace{Owner::section, i, 1}, link.section,
        std::span<const Number>(CrossSection::numbers), none);
  }
  for (int i = 0; i < count(scene.elements); ++i) {
    auto& element = scene.elements[i];
    std::visit(
        [&](auto& law) {
          use(Parts{element.table, element.name}, ParameterPlace{Owner::element, i}, law, numbers_of_law(law),
              &element.on);
        },
        element.law);
  }
  for (int i = 0; i < count(scene.drives); ++i) {
    auto& drive = scene.drives[i];
    // Its function of time has taken the place of its own numbers.
    const bool follows = std::any_of(scene.time_functions.begin(), scene.time_functions.end(), [i](const auto& one) {
      return one.of == TimeFunction::Of::drive && one.item == i;
    });
    if (follows) continue;
    use(Parts{"drive", drive.name}, ParameterPlace{Owner::drive, i}, drive, std::span<const Number>(Drive::numbers),
        &drive.on);
  }
  for (int i = 0; i < count(scene.joints); ++i) {
    auto& joint = scene.joints[i];
    if (!is_of_track(joint.b.body)) {
      use(Parts{joint.traits().key, joint.name}, ParameterPlace{Owner::joint, i}, joint, joint.numbers(), none);
    }
    if (!joint.has_travel()) continue;
    use(Parts{"start", joint.name}, ParameterPlace{Owner::start, i, 1}, scene.start.travel.at(i),
        std::span<const Number>(travel_guess), none);
  }
  for (int i = 0; i < count(scene.time_functions); ++i) {
    auto& function = scene.time_functions[i];
    const bool drives = function.of == TimeFunction::Of::drive;
    const std::string_view name = name_of(scene, function);
    Parts prefix{drives ? "drive" : "load", name, "time"};
    if (function.of == TimeFunction::Of::frame) prefix = {"frame", name};
    if (function.of == TimeFunction::Of::element) {
      const auto& element = scene.elements[static_cast<std::size_t>(function.item)];
      const Number& number = numbers_of(element.law)[static_cast<std::size_t>(function.part)];
      prefix = {element.table, name, lasting_text("time." + std::string(number.key_on(&element.on)))};
    }
    const bool moves_frame = function.of == TimeFunction::Of::frame;
    const Measure* const on = drives        ? &scene.drives[static_cast<std::size_t>(function.item)].on
                              : moves_frame ? &place_of_frame
                                            : none;
    std::visit(
        [&](auto& law) {
          use(prefix, ParameterPlace{Owner::time, i}, law, function.numbers(), on);
        },
        function.law);
  }
  const bool has_struts = has_gas_struts(scene);
  for (int i = 0; i < count(scene.stops); ++i) {
    auto& stop = scene.stops[i];
    if (has_struts && strut_of(scene, stop) >= 0) continue;
    const CouplingKind* const kind = coupling_kind(stop);
    if (kind != nullptr && kind->row > 0) continue;
    const Owner owner = kind != nullptr ? Owner::coupling : Owner::stop;
    use(Parts{stop.table, stop.name}, ParameterPlace{owner, i}, stop, stop.numbers(), &stop.on);
  }
  for (int i = 0; i < count(scene.blades); ++i) {
    auto& blade = scene.blades[i];
    use(Parts{"blade", blade.name}, ParameterPlace{Owner::blade, i}, blade, std::span<const Number>(Blade::numbers),
        none);
  }
}

/// use(row, item, number) for every number.
template <class AnyScene, class Use>
void visit_numbers(AnyScene& scene, Use use) {
  visit_items(scene, [&](const std::array<std::string_view, 4>& prefix, ParameterPlace place, auto& item,
                         std::span<const Number> numbers, const Measure* on) {
    for (const Number& number : numbers) {
      ParameterRow row{{prefix}, place, number.dimension_on(on), number.range_on(on)};
      if (on == &place_of_frame && number.measure_power == 1) {
        const int order = scene.time_functions[static_cast<std::size_t>(place.item)].order;
        row.dimension = row.dimension * dimension::time.power(order - 2);
      }
      row.path.parts[3] = number.key_on(on);
      use(row, item, number);
      ++place.number;
    }
  });
}

/// Calls use(row, item, number) for the one number that has this path.
template <class AnyScene, class Use>
void at_path(AnyScene& scene, std::string_view path, Use use) {
  int found = 0;
  visit_numbers(scene, [&](const ParameterRow& row, auto&, const Number&) { found += row.path.is(path); });
  // Only a scene built in code can have two of the same name.
  if (found > 1) throw InputError(std::string(path) + ": expected one value, found several; give them different names");
  if (found == 0) {
    // Statics holds what functions of time give at one time.
    if (path.find(".time.") != std::string_view::npos && scene.time_functions.empty()) {
      throw InputError(std::string(path) +
                       ": expected a number that statics knows: loads are those of one time here; vary load.NAME, or "
                       "give numbers of functions of time with --set");
    }
    std::vector<std::string> valid;
    visit_numbers(scene, [&](const ParameterRow& row, auto&, const Number&) { valid.push_back(row.path.text()); });
    throw InputError(std::string(path) + ": expected the path of a number of the scene" +
                     did_you_mean_or_list(path, valid));
  }
  visit_numbers(scene, [&](const ParameterRow& row, auto& item, const Number& number) {
    if (row.path.is(path)) use(row, item, number);
  });
}

/// Radii of pulleys and of circles along outlines; in sums what turns the dimension of a term into that of the sum, and
/// the argument of a profile.
void scale_measure(Measure& measure, const Scales& scales) {
  const double per_length = dimension::length.per_scale(scales);
  for (RopeContact& contact : measure.contacts) contact.radius *= per_length;
  measure.radius *= per_length;
  for (Measure::Term& term : measure.terms) {
    scale_measure(term.measure, scales);
    term.factor *= measure.dimension().per_scale(scales) / term.dimension().per_scale(scales);
    const double per_argument = term.measure.dimension().per_scale(scales);
    term.shift *= per_argument;
    term.span *= per_argument;
  }
}

/// The stops of gas struts have the limits that the numbers of the struts give them.
void let_stops_follow(Scene& scene) {
  if (!has_gas_struts(scene)) return;
  for (Stop& stop : scene.stops) {
    const int strut = strut_of(scene, stop);
    if (strut >= 0) hold_in_stroke(stop, std::get<GasStrut>(scene.elements[static_cast<std::size_t>(strut)].law));
  }
}

/// Sets a number of an item, SI; the springs of a flexible link keep their proportion to the stiffness of its section.
void set_number(Scene& scene, const ParameterPlace& place, void* item, const Number& number, double si) {
  const auto stiffness = [](const CrossSection& section) { return section.modulus * section.second_moment; };
  const bool is_flexible = place.owner == Owner::section && place.part == 1;
  const double before = is_flexible ? stiffness(scene.flexible_links[place.item].section) : 1.0;
  number.set(item, si);
  if (!is_flexible) return;
  const FlexibleLink& link = scene.flexible_links[place.item];
  const double after = stiffness(link.section);
  if (after == before) return;
  for (const int spring : link.springs) {
    std::get<LinearSpring>(scene.elements[spring].law).stiffness *= after / before;
  }
}

/// The same of a number that no other is set with: changes nothing where it throws.
void set_alone(Scene& scene, const ParameterPlace& place, void* item, const Number& number, double si) {
  const auto first = scene.stops.begin() + (place.owner == Owner::coupling ? place.item : 0);
  if (place.owner != Owner::coupling || first->curve.empty()) {
    set_number(scene, place, item, number, si);
    return;
  }
  const auto last = std::find_if(first + 1, scene.stops.end(), [](const Stop& stop) {
    const CouplingKind* const kind = coupling_kind(stop);
    return kind == nullptr || kind->row == 0;
  });
  const std::vector<Stop> before(first, last);
  set_number(scene, place, item, number, si);
  try {
    check_curve(&*first);
  } catch (const InputError&) {
    std::copy(before.begin(), before.end(), first);
    throw;
  }
}

[[noreturn]] void fail(const ParameterRow& row, const std::string& message) {
  throw InputError(row.path.text() + ": " + message);
}

/// A component without a row.
double& component(Scene& scene, const DependentPlace& at) {
  const auto item = static_cast<std::size_t>(at.place.item);
  const auto of = [&](Vec2& vector) -> double& { return at.component == 0 ? vector.x : vector.y; };
  if (at.of == DependentPlace::Of::force) return of(scene.forces[item].vector);
  if (at.of == DependentPlace::Of::axis) return of(scene.joints[item].axis);
  Measure& on = at.place.owner == Owner::element ? scene.elements[item].on
                : at.place.owner == Owner::drive ? scene.drives[item].on
                                                 : scene.stops[item].on;
  return on.terms[static_cast<std::size_t>(at.component)].factor;
}

/// The value that follows from named ones, in the scene's units.
double value_of(const DependentNumber& number, const std::vector<double>& named, const Scene& scene, bool in_range) {
  const double written = number.value(named);
  const double si = written * number.dimension.unit(scene.units);
  const bool is_possible = std::isfinite(si) && (number.range != Range::positive || si > 0.0);
  if (!is_possible || (in_range && !contains(number.range, si))) {
    throw InputError(number.item + " = \"" + number.text() + "\": " + out_of_range(number.range, written));
  }
  return si * number.dimension.per_scale(scene.measured_in);
}

/// Sets a named number and what follows from it, or changes nothing.
void set_named(Scene& scene, int named, double value, bool in_range) {
  if (!scene.dependents) {
    scene.named_values[static_cast<std::size_t>(named)].value = value;
    return;
  }
  Scene changed = scene;
  changed.named_values[static_cast<std::size_t>(named)].value = value;
  follow_expressions(changed, in_range);
  scene = std::move(changed);
}

DependentDerivatives derivatives_along(const Scene& scene, std::vector<double> slopes, std::vector<double> named,
                                       bool has_bends) {
  DependentDerivatives out;
  if (!scene.dependents) return out;
  std::vector<double> bends(named.size(), 0.0);
  for (const DependentNumber& one : *scene.dependents) {
    const double slope = one.slope(named, slopes), bend = has_bends ? one.bend(named, slopes, bends) : 0.0;
    if (one.at.place.owner == Owner::number) {
      const auto item = static_cast<std::size_t>(one.at.place.item);
      slopes[item] = slope;
      bends[item] = bend;
      named[item] = one.value(named);
    }
    const double unit = one.dimension.unit(scene.units) * one.dimension.per_scale(scene.measured_in);
    out.slopes.push_back(slope * unit);
    if (has_bends) out.bends.push_back(bend * unit);
  }
  return out;
}

}  // namespace

const DependentNumber* dependent_number(const Scene& scene, const ParameterPlace& place) {
  if (!scene.dependents) return nullptr;
  const auto found = std::find_if(scene.dependents->begin(), scene.dependents->end(), [&](const DependentNumber& one) {
    return one.at.place == place && (one.at.of == DependentPlace::Of::row || one.at.of == DependentPlace::Of::force);
  });
  return found == scene.dependents->end() ? nullptr : &*found;
}

void check_is_free(const Scene& scene, const ParameterRow& row) {
  const DependentNumber* const dependent = dependent_number(scene, row.place);
  if (dependent == nullptr) return;
  std::string names;
  for (const int used : dependent->uses()) {
    names += (names.empty() ? "numbers." : ", numbers.") + scene.named_values[static_cast<std::size_t>(used)].name;
  }
  fail(row, "expected a number of its own, found the expression \"" + dependent->text() + "\"; " +
                (names.empty() ? "write it as a number in the scene" : "change " + names));
}

std::vector<double> named_values(const Scene& scene) {
  std::vector<double> values;
  for (const SceneNumber& one : scene.named_values) values.push_back(one.value);
  return values;
}

std::vector<double> dependent_values(const Scene& scene, std::vector<double> named, bool in_range) {
  std::vector<double> out;
  if (!scene.dependents) return out;
  for (const DependentNumber& one : *scene.dependents) {
    out.push_back(value_of(one, named, scene, in_range));
    if (one.at.place.owner == Owner::number) named[static_cast<std::size_t>(one.at.place.item)] = out.back();
  }
  return out;
}

std::vector<double> dependents_by(const Scene& scene, int by, std::vector<double> named) {
  std::vector<double> slopes(named.size(), 0.0);
  slopes[static_cast<std::size_t>(by)] = 1.0;
  return derivatives_along(scene, std::move(slopes), std::move(named), false).slopes;
}

std::vector<int> dependent_degrees(const Scene& scene, int named) {
  std::vector<int> out, of_names(scene.named_values.size(), 0);
  of_names[static_cast<std::size_t>(named)] = 1;
  if (!scene.dependents) return out;
  for (const DependentNumber& one : *scene.dependents) {
    int degree = one.expression.degree(of_names);
    if (one.factor && std::any_of(one.factor->numbers.begin(), one.factor->numbers.end(),
                                  [&](const DependentNumber& of) { return of.expression.degree(of_names) > 0; })) {
      degree = 2;
    }
    if (one.at.of == DependentPlace::Of::row && one.at.place.owner == Owner::number) {
      of_names[static_cast<std::size_t>(one.at.place.item)] = degree;
    }
    out.push_back(degree);
  }
  return out;
}

DependentDerivatives dependents_along(const Scene& scene, std::vector<double> slopes, std::vector<double> named) {
  return derivatives_along(scene, std::move(slopes), std::move(named), true);
}

void follow_expressions(Scene& scene, bool in_range) {
  if (!scene.dependents) return;
  const std::vector<DependentNumber>& all = *scene.dependents;
  const std::vector<double> values = dependent_values(scene, named_values(scene), in_range);
  std::size_t next = 0;
  const auto follows = [&](const ParameterRow& row) {
    return next < all.size() && all[next].at.of == DependentPlace::Of::row && all[next].at.place == row.place;
  };
  for (; next < all.size() && all[next].at.place.owner == Owner::number; ++next) {
    scene.named_values[static_cast<std::size_t>(all[next].at.place.item)].value = values[next];
  }
  visit_numbers(scene, [&](const ParameterRow& row, auto& item, const Number& number) {
    if (!follows(row)) return;
    const double value = values[next++];
    if constexpr (std::is_same_v<decltype(item), Stop&>) {
      // Both limits of a stop: one alone might pass the other on the way.
      if (row.place.owner == Owner::stop && row.place.number < 2) {
        (row.place.number == 0 ? item.min : item.max) = value;
        return;
      }
    }
    if (row.place.owner == Owner::time) {  // and both ends of a ramp
      scene.time_functions[static_cast<std::size_t>(row.place.item)].set_among_others(row.place.number, value);
      return;
    }
    set_number(scene, row.place, &item, number, value);
  });
  for (; next < all.size(); ++next) {
    if (all[next].at.of != DependentPlace::Of::left_out) component(scene, all[next].at) = values[next];
  }
  for (const DependentNumber& one : all) {
    const auto item = static_cast<std::size_t>(one.at.place.item);
    if (one.at.of == DependentPlace::Of::axis && scene.joints[item].axis == Vec2{}) {
      throw InputError(one.item + ": expected a direction, found [0, 0]");
    }
    if (one.at.of == DependentPlace::Of::row && one.at.place.owner == Owner::stop &&
        !(scene.stops[item].min <= scene.stops[item].max)) {
      throw InputError(one.item + ": expected min <= max");
    }
    if (one.at.of != DependentPlace::Of::row) continue;
    try {
      if (one.at.place.owner == Owner::time) scene.time_functions[item].check();
      if (one.at.place.owner == Owner::coupling) check_curve(&scene.stops[item]);
    } catch (const InputError& error) {
      throw InputError(one.item + ": " + error.what());
    }
  }
  let_stops_follow(scene);
}

std::string ParameterPath::text() const {
  std::string joined;
  for (const std::string_view part : parts) {
    if (!part.empty()) joined += (joined.empty() ? "" : ".") + std::string(part);
  }
  return joined;
}

bool ParameterPath::is(std::string_view path) const {
  bool first = true;
  for (const std::string_view part : parts) {
    if (part.empty()) continue;
    if (!first) {
      if (!path.starts_with('.')) return false;
      path.remove_prefix(1);
    }
    first = false;
    if (!path.starts_with(part)) return false;
    path.remove_prefix(part.size());
  }
  return path.empty();
}

std::vector<ParameterRow> parameter_table(const Scene& scene) {
  std::vector<ParameterRow> rows;
  visit_numbers(scene, [&](const ParameterRow& row, auto&, const Number&) { rows.push_back(row); });
  return rows;
}

std::optional<ParameterRow> find_parameter(const Scene& scene, std::string_view path) {
  std::optional<ParameterRow> found;
  visit_numbers(scene, [&](const ParameterRow& row, auto&, const Number&) {
    if (!found && row.path.is(path)) found = row;
  });
  return found;
}

ParameterRow parameter(const Scene& scene, std::string_view path) {
  ParameterRow found;
  at_path(scene, path, [&](const ParameterRow& row, auto&, const Number&) { found = row; });
  return found;
}

std::optional<double> value_at(const Scene& scene, const ParameterPlace& place) {
  std::optional<double> value;
  visit_numbers(scene, [&](const ParameterRow& row, auto& item, const Number& number) {
    if (row.place == place) value = number.get(&item);
  });
  return value;
}

std::vector<std::optional<double>> parameter_values(const Scene& scene) {
  std::vector<std::optional<double>> values;
  visit_numbers(scene,
                [&](const ParameterRow&, auto& item, const Number& number) { values.push_back(number.get(&item)); });
  return values;
}

void set_value_at(Scene& scene, const ParameterPlace& place, double si) {
  if (place.owner == Owner::number) return set_named(scene, place.item, si, false);
  visit_numbers(scene, [&](const ParameterRow& row, auto& item, const Number& number) {
    if (row.place == place) set_alone(scene, place, &item, number, si);
  });
  let_stops_follow(scene);
}

void set_value(Scene& scene, std::string_view path, double value) {
  at_path(scene, path, [&](const ParameterRow& row, auto& item, const Number& number) {
    const double si = value * row.dimension.unit(scene.units);
    if (!contains(row.range, si)) fail(row, out_of_range(row.range, value));
    check_is_free(scene, row);
    try {
      if (row.place.owner == Owner::number)
        set_named(scene, row.place.item, value, true);
      else
        set_alone(scene, row.place, &item, number, si);
    } catch (const InputError& error) {
      fail(row, error.what());
    }
  });
  let_stops_follow(scene);
}

double get_value(const Scene& scene, std::string_view path) {
  double value = 0.0;
  at_path(scene, path, [&](const ParameterRow& row, auto& item, const Number& number) {
    const std::optional<double> si = number.get(&item);
    if (!si && row.place.owner == Owner::drive) {
      fail(row, "expected a drive with a start, this one starts from the assembled position; add the key start");
    }
    value = si.value_or(0.0) / row.dimension.unit(scene.units);
  });
  return value;
}

double value_unit(const Scene& scene, std::string_view path) {
  return parameter(scene, path).dimension.unit(scene.units);
}

void scale(Scene& scene, const Scales& scales) {
  visit_numbers(scene, [&](const ParameterRow& row, auto& item, const Number& number) {
    number.scale(&item, row.dimension.per_scale(scales));
  });
  for (Element& element : scene.elements) {
    scale_measure(element.on, scales);
    if (element.feedback) scale_measure(element.feedback->reads, scales);
  }
  for (Drive& drive : scene.drives) scale_measure(drive.on, scales);
  for (Stop& stop : scene.stops) scale_measure(stop.on, scales);
  for (TimeFunction& function : scene.time_functions) {
    const auto item = static_cast<std::size_t>(function.item);
    if (function.of == TimeFunction::Of::drive) {
      Drive& drive = scene.drives[item];
      function.scale_table(drive.on.dimension().per_scale(scales));
      // Its own numbers, which are no rows, are those of the function at the start.
      for (const Number& number : Drive::numbers) {
        number.scale(&drive, number.dimension_on(&drive.on).per_scale(scales));
      }
    } else if (function.of == TimeFunction::Of::frame) {
      function.scale_table(dimension::length.per_scale(scales));
    }
  }
  for (const int body : bodies_of_states(scene)) {
    scene.bodies[static_cast<std::size_t>(body)].inertia *= dimension::inertia.per_scale(scales);
  }
  for (Element& element : scene.elements) {
    std::visit(
        [&]<class L>(L& law) {
          if constexpr (requires { law.rescale(1.0, 1.0); }) {
            const auto& own = element.feedback;
            law.rescale((own ? own->signal : element.on.dimension()).per_scale(scales),
                        (own ? own->output : element.on.effort_dimension()).per_scale(scales));
          }
        },
        element.law);
  }
  let_stops_follow(scene);
  scene.measured_in.length *= scales.length;
  scene.measured_in.force *= scales.force;
}

Scene scaled(const Scene& scene, const Scales& scales) {
  Scene out = scene;
  scale(out, scales);
  return out;
}

}  // namespace poise
