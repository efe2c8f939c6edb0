#include "statics/model/varied_scene.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/named_item.hpp"
#include "model/named_measures.hpp"
#include "model/nearest_name.hpp"
#include "model/parameter_values.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/static_numbers.hpp"

namespace poise {
namespace {

/// Dead and follower loads, weights, most numbers of force laws and limits of stops enter forces, tangent and
/// constraints affinely.
bool enters_affinely(const Scene& scene, const ParameterPlace& place) {
  switch (place.owner) {
    case Owner::scene:
    case Owner::force:
    case Owner::torque:
    case Owner::body:
    case Owner::stop:
      return true;
    case Owner::coupling: {
      // Limits and values that its measures are held at, factors of measures in the sum; not the place of a profile,
      // nor its points.
      const Stop& stop = scene.stops[static_cast<std::size_t>(place.item)];
      const CouplingKind& kind = *coupling_kind(stop);
      return !curve_numbers_of(stop).has(place.number) &&
             std::none_of(kind.parts.begin(), kind.parts.end(), [&](const CouplingPart& part) {
               return part.number == place.number && part.of == CouplingPart::Of::shift;
             });
    }
    case Owner::element:
      return is_affine_in(scene.elements[place.item].law, place.number);
    default:
      return false;
  }
}

/// The measure of a name, or of "drive.NAME"; none of the names of numbers, which come before older spellings.
std::optional<NamedMeasure> driven_measure(const Scene& scene, const std::string& name) {
  if (std::optional<NamedMeasure> found = find_measure(scene, name)) {
    if (found->name == name || !find_parameter(scene, name)) return found;
    return std::nullopt;
  }
  if (find_parameter(scene, name)) return std::nullopt;
  if (const std::string why = why_no_measure(scene, name); !why.empty()) {
    throw InputError(fmt::format("{}: {}", name, why));
  }
  constexpr std::string_view drive = "drive.";
  if (!name.starts_with(drive)) return std::nullopt;
  const std::string item = name.substr(drive.size());
  const NamedItem found = find_item(scene.drives, item);
  if (found) return NamedMeasure{.name = name, .on = scene.drives[found.index].on, .words = "measure of drive " + item};
  throw InputError(fmt::format("{}: expected the name of a drive{}", name, did_you_mean_or_list(item, found.known)));
}

/// Sets a number of `scene` to (1 - s) times what it is there, plus s times what it is in `other`.
void blend(Scene& scene, const Scene& other, const ParameterPlace& place, double s) {
  const auto between = [&](double a, double b) { return s == 0.0 ? a : s == 1.0 ? b : (1.0 - s) * a + s * b; };
  const auto item = static_cast<std::size_t>(place.item);
  if (place.owner == Owner::force) {
    Force& F = scene.forces[item];
    const Force& G = other.forces[item];
    F.vector = {between(F.vector.x, G.vector.x), between(F.vector.y, G.vector.y)};
    if (!(F.along == G.along)) F.along = s == 0.0 ? F.along : s == 1.0 ? G.along : Vec2{};
  } else if (place.owner == Owner::stop) {
    // Both limits at once: one alone might pass the other on the way.
    Stop& stop = scene.stops[item];
    double& limit = place.number == 0 ? stop.min : stop.max;
    limit = between(*poise::value_at(scene, place), *poise::value_at(other, place));
  } else {
    set_value_at(scene, place, between(*poise::value_at(scene, place), *poise::value_at(other, place)));
  }
}

}  // namespace

VariedScene::VariedScene(Scene scene, const std::string& name, double from, double to)
    : scene_(std::move(scene)), name_(name) {
  const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}: {}", name_, what)); };
  refuse_contacts(scene_, "load paths");
  refuse_blades(scene_, "paths of equilibria");
  Range range = Range::finite;
  if (const auto measure = driven_measure(scene_, name_)) {
    driven_ = affine_ = true;
    name_ = measure->name;
    driven_words_ = measure->words;
    dimension_ = measure->on.dimension();
    range = measure->on.range();
    scene_.stops.push_back({.name = name_, .on = measure->on});
  } else if (name_ == "loads") {
    affine_ = true;
    const auto add = [&](Owner owner, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) places_.push_back({owner, static_cast<int>(i)});
    };
    add(Owner::force, scene_.forces.size());
    add(Owner::torque, scene_.torques.size());
    if (places_.empty()) fail("the scene has no loads; expected a force or a torque, or name another number");
  } else {
    const ParameterRow row = parameter(scene_, name_);
    check_is_free(scene_, row);
    if (row.place.owner == Owner::section && row.place.part == 1) {
      fail("it acts through all springs of a flexible link, which paths cannot vary together; expected another number");
    }
    const bool is_idle =
        (row.place.owner == Owner::number || row.place.owner == Owner::joint) && !acts_in_statics(scene_, row.place);
    if (!counts_in_statics(row.place.owner) || is_idle) {
      fail(
          "equilibrium does not depend on it; expected a load, a stiffness, a dimension or a driven measure, say "
          "angle.BODY or length.ELEMENT");
    }
    places_.push_back(row.place);
    affine_ = enters_affinely(scene_, row.place);
    dimension_ = row.dimension;
    // A force may be reversed.
    range = row.place.owner == Owner::force ? Range::finite : row.range;
    if (row.place.owner == Owner::force && scene_.forces[row.place.item].line_of_action() == Vec2{}) {
      fail("expected a force with a direction, its vector is [0, 0]; give it a direction and a size");
    }
  }
  for (const ParameterPlace& place : places_) whole_.push_back(poise::value_at(scene_, place).value_or(0.0));
  unit_ = dimension_.unit(scene_.units);
  from_ = from * unit_;
  to_ = to * unit_;
  for (const double end : {from, to}) {
    if (!contains(range, end * unit_)) fail(out_of_range(range, end));
  }
  if (from == to) fail(fmt::format("the range {}..{} has no length; expected two different values", from, to));
  const bool is_named = !places_.empty() && places_[0].owner == Owner::number;
  for (const double end : {from, to}) {
    Scene there = scene_;
    if (is_named) set_value(there, name_, end);  // with all that follows in its range
  }
  try {
    scene_at(from_);
    scene_at(to_);
  } catch (const InputError& error) {
    fail(error.what());  // limits of a stop that change places, say
  }
  // Units of the scene as it is at some value at which nothing is zero.
  const Scene somewhere = scene_at(generic());
  scales_ = ScaledModel(somewhere, Purpose::statics).scales();
  find_courses();
}

VariedScene::VariedScene(Scene from, Scene to) : scene_(std::move(from)), name_("the change"), from_(0.0), to_(1.0) {
  const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}: {}", name_, what)); };
  scene_.start = to.start;
  scene_.drives = to.drives;
  for (std::size_t i = 0; i < std::min(scene_.bodies.size(), to.bodies.size()); ++i) {
    scene_.bodies[i].section = to.bodies[i].section;
  }
  scene_.flexible_links = to.flexible_links;
  const std::vector<ParameterRow> rows = parameter_table(scene_), others = parameter_table(to);
  const bool alike = rows.size() == others.size() &&
                     std::equal(rows.begin(), rows.end(), others.begin(), [](const auto& a, const auto& b) {
                       return a.place == b.place && a.path.parts == b.path.parts;
                     });
  const auto expressions = [](const Scene& scene) {
    std::vector<std::string> out;
    if (!scene.dependents) return out;
    for (const DependentNumber& one : *scene.dependents) {
      out.push_back(one.item);
      out.push_back(one.expression.text());
    }
    return out;
  };
  if (!alike || expressions(scene_) != expressions(to)) fail("expected two scenes that differ in numbers only");
  const std::vector<std::optional<double>> before = parameter_values(scene_), after = parameter_values(to);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterRow& row = rows[i];
    if (!counts_in_statics(row.place.owner)) continue;
    const std::optional<double>&a = before[i], &b = after[i];
    const bool has_other_vector =
        row.place.owner == Owner::force && !(scene_.forces[row.place.item].vector == to.forces[row.place.item].vector);
    if (a == b && !has_other_vector) continue;
    if (!a || !b || !std::isfinite(*a) || !std::isfinite(*b)) {
      fail(fmt::format("expected {} in both scenes, or in none", row.path.text()));
    }
    places_.push_back(row.place);
  }
  if (places_.empty()) fail("expected a number that differs");
  // Products of two numbers that vary, a mass in a gravity, say, are not affine.
  const auto all_of = [&](std::initializer_list<Owner> owners) {
    return std::all_of(places_.begin(), places_.end(), [&](const ParameterPlace& place) {
      return std::find(owners.begin(), owners.end(), place.owner) != owners.end();
    });
  };
  affine_ = all_of({Owner::force, Owner::torque}) || all_of({Owner::stop}) ||
            (places_.size() == 1 && enters_affinely(scene_, places_[0]));
  other_ = std::make_shared<const Scene>(std::move(to));
  scales_ = ScaledModel(scene_at(generic()), Purpose::statics).scales();
  find_courses();
}

VariedScene VariedScene::in(Scene scene, const VariedScene& like) const {
  VariedScene out = *this;
  if (driven_) scene.stops.push_back(scene_.stops.back());
  out.scene_ = std::move(scene);
  for (std::size_t k = 0; k < places_.size(); ++k)
    out.whole_[k] = poise::value_at(out.scene_, places_[k]).value_or(0.0);
  out.scales_ = like.scales_;
  out.find_courses();
  return out;
}

void VariedScene::find_courses() {
  courses_.clear();
  vector_courses_.clear();
  const int last_stop = static_cast<int>(scene_.stops.size()) - 1;
  if (driven_) courses_ = {{{Owner::stop, last_stop, 0, 0}, from_, to_}, {{Owner::stop, last_stop, 0, 1}, from_, to_}};
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const ParameterPlace& place = places_[k];
    if (other_ && place.owner == Owner::force) {
      vector_courses_.push_back({place.item, scene_.forces[place.item].vector, other_->forces[place.item].vector});
    } else if (other_) {
      courses_.push_back(
          {place, poise::value_at(scene_, place).value_or(0.0), poise::value_at(*other_, place).value_or(0.0)});
    } else {
      const double unit = name_ == "loads" ? whole_[k] : 1.0;
      courses_.push_back({place, from_ * unit, to_ * unit});
    }
  }
  varying_ = VaryingNumbers(scene_, varying_rows());
}

Scene VariedScene::reference_scene() const {
  if (other_) return scene_at(0.0);
  return !places_.empty() && places_[0].owner == Owner::number ? scene_at(generic()) : scene_;
}

std::vector<ParameterPlace> VariedScene::varying_rows() const {
  std::vector<ParameterPlace> out = others_;
  for (const Course& course : courses_) out.push_back(course.place);
  for (const VectorCourse& course : vector_courses_) out.push_back({Owner::force, course.force});
  return out;
}

void VariedScene::vary_with(const VariedScene& other) {
  const std::vector<ParameterPlace> rows = other.varying_rows();
  others_.insert(others_.end(), rows.begin(), rows.end());
  varying_ = VaryingNumbers(scene_, varying_rows());
}

double VariedScene::excess() const {
  if (other_) return 0.0;
  const bool is_load = !places_.empty() && (places_[0].owner == Owner::force || places_[0].owner == Owner::torque);
  if (!is_load || scene_.elements.empty()) return 0.0;
  return scales_.force / ScaledModel(scene_at(0.0), Purpose::statics).scales().force;
}

std::string VariedScene::unit_name() const { return dimension_.unit_name(scene_.units); }

Dimension VariedScene::effort_dimension() const { return scene_.stops.back().on.effort_dimension(); }

Scene VariedScene::scene_at(double value) const {
  Scene scene = scene_;
  if (driven_) {
    scene.stops.back().min = scene.stops.back().max = value;
    return scene;
  }
  if (other_) {
    for (const ParameterPlace& place : places_) blend(scene, *other_, place, value);
    scene.start = scene_.start;  // guesses that follow from named numbers too
    return scene;
  }
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const ParameterPlace& place = places_[k];
    const bool is_factor = name_ == "loads";
    if (place.owner == Owner::force) {
      // Reversed where the value is negative.
      Force& force = scene.forces[place.item];
      if (!is_factor && force.has_direction_of_its_own()) {
        force.vector = value * force.along;
        continue;
      }
      Vec2& F = force.vector;
      const double size = is_factor ? 1.0 : norm(F);
      F = {F.x / size * value, F.y / size * value};
    } else {
      set_value_at(scene, place, is_factor ? value * whole_[k] : value);
    }
  }
  return scene;
}

std::unique_ptr<StaticModel> VariedScene::model_at(double value) const {
  return std::make_unique<StaticModel>(scene_at(value), scales_, varying_);
}

}  // namespace poise
