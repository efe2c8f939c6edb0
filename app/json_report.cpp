#include "app/json_report.hpp"

#include "app/json_parts.hpp"
#include "app/quantity.hpp"
#include "app/shown_values.hpp"
#include "comparison/agreement.hpp"
#include "statics/pose_values.hpp"

namespace poise::app {
namespace {

/// Writes SI values in the units of a scene.
class Writer {
 public:
  explicit Writer(const StaticModel& model) : model_(model), scene_(model.scene()), units_(scene_.units) {}

  Json answer(const Answer& answer) const {
    const Equilibrium& rest = answer.rest;
    Json out;
    out["method"] = to_string(rest.method);
    out["seek"] = rest.seek == Seek::stable ? "stable" : "nearest";
    out["status"] = to_string(rest.status);
    out["why"] = rest.why;
    out["iterations"] = rest.iterations;
    out["evaluations"] = rest.evaluations;
    out["microseconds"] = json_number(rest.microseconds);
    out["error"] = json_number(error_of(answer));
    out["reference"] = reference(answer);
    // A method that refused has no pose, so nothing can be said of one.
    for (const char* key : {"energy", "energy_note", "stability", "stability_note", "descent_directions",
                            "neutral_directions", "modes", "points", "angles", "slides", "places", "springs",
                            "torsion_springs", "stops", "reactions", "redundancy", "residuals"}) {
      out[key] = nullptr;
    }
    if (!answer.readings) return out;
    const Check& check = rest.check;
    if (rest.energy) out["energy"] = json_number(in_unit(*rest.energy, Quantity::energy, units_));
    out["energy_note"] = energy_note;
    out["stability"] = to_string(check.stability);
    out["stability_note"] = check.stability_note;
    out["descent_directions"] = check.descent_directions;
    out["neutral_directions"] = check.neutral_directions;
    out["modes"] = principal_directions(check);
    out["points"] = points(*answer.readings);
    out["angles"] = angles(*answer.readings);
    out["slides"] = slides(*answer.readings);
    out["places"] = places(*answer.readings);
    out["springs"] = springs(*answer.readings);
    out["torsion_springs"] = torsion_springs(*answer.readings);
    out["stops"] = stops(*answer.readings, check);
    out["reactions"] = reactions(check);
    out["redundancy"] = check.redundancy;
    out["residuals"] = residuals(check);
    return out;
  }

 private:
  Json shown(double si, Quantity quantity) const { return json_number(in_unit(si, quantity, units_)); }
  Json shown(Vec2 si, Quantity quantity) const { return {shown(si.x, quantity), shown(si.y, quantity)}; }

  Json reference(const Answer& answer) const {
    if (!answer.reference) return nullptr;
    const Reference& reference = *answer.reference;
    Json out = {{"refined", reference.refined}, {"digits", reference.digits}, {"why", reference.why}};
    out["coordinates"] = Json::array();
    for (std::size_t i = 0; i < reference.decimal.size(); ++i) {
      const Coordinate& c = model_.layout().coordinates[i];
      out["coordinates"].push_back({{"name", c.name},
                                    {"unit", c.kind == Coordinate::Kind::angle ? "rad" : "m"},
                                    {"value", reference.decimal[i]}});
    }
    return out;
  }

  Json principal_directions(const Check& check) const {
    Json out = Json::array();
    for (const CurvatureDirection& direction : check.principal_directions) {
      Json moves = Json::object();
      for (const auto& [name, part] : direction.moves) moves[name] = json_number(part);
      out.push_back({{"curvature", shown(direction.curvature, Quantity::energy)}, {"moves", moves}});
    }
    return out;
  }

  Json points(const Readings& readings) const {
    Json out = Json::object();
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      Json of_body = Json::object();
      for (const NamedPoint& p : scene_.bodies[i].points) {
        of_body[p.name] = shown(readings.poses[i].world(p.at), Quantity::length);
      }
      out[scene_.bodies[i].name] = of_body;
    }
    return out;
  }

  Json angles(const Readings& readings) const {
    Json out = Json::object();
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      out[scene_.bodies[i].name] = shown(readings.poses[i].angle, Quantity::angle);
    }
    return out;
  }

  Json slides(const Readings& readings) const {
    Json out = Json::object();
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      if (scene_.joints[j].has_travel()) out[scene_.joints[j].name] = shown(readings.travel[j], Quantity::length);
    }
    return out;
  }

  Json places(const Readings& readings) const {
    Json out = Json::object();
    for (const std::size_t i : free_bodies(model_.layout())) {
      out[scene_.bodies[i].name] = shown(readings.poses[i].origin, Quantity::length);
    }
    return out;
  }

  /// The name of an element; with its table in front where one of another table has taken the name.
  static std::string key_of(const Element& element, const Json& taken) {
    return taken.contains(element.name) ? element.table + "." + element.name : element.name;
  }

  Json springs(const Readings& readings) const {
    Json out = Json::object();
    for (std::size_t i = 0; i < scene_.elements.size(); ++i) {
      const Element& element = scene_.elements[i];
      if (!stores_energy(element.law) || element.on.is_angle()) continue;
      const ElementReading& reading = readings.elements[i];
      out[key_of(element, out)] = {{"length", shown(reading.value, Quantity::length)},
                                   {"force", shown(reading.force, Quantity::force)},
                                   {"slack", reading.slack}};
    }
    return out;
  }

  Json torsion_springs(const Readings& readings) const {
    Json out = Json::object();
    for (std::size_t i = 0; i < scene_.elements.size(); ++i) {
      const Element& element = scene_.elements[i];
      if (!stores_energy(element.law) || !element.on.is_angle()) continue;
      out[key_of(element, out)] = {{"moment", shown(-readings.elements[i].force, Quantity::moment)}};
    }
    return out;
  }

  Json stops(const Readings& readings, const Check& check) const {
    Json out = Json::object();
    for (std::size_t i = 0; i < scene_.stops.size(); ++i) {
      const Stop& stop = scene_.stops[i];
      out[stop.name] = {{"value", shown(readings.stops[i], quantity_of(stop.on))},
                        {"min", shown(stop.min, quantity_of(stop.on))},
                        {"max", shown(stop.max, quantity_of(stop.on))},
                        {"presses", nullptr}};
      for (const Reaction& reaction : check.reactions) {
        if (reaction.kind == "stop" && reaction.name == stop.name) {
          out[stop.name]["presses"] = pressed_limit(stop, readings.stops[i]).name;
        }
      }
    }
    return out;
  }

  Json reactions(const Check& check) const {
    Json out = Json::array();
    for (const Reaction& r : check.reactions) {
      out.push_back({{"name", r.name},
                     {"kind", r.kind},
                     {"at", shown(r.at, Quantity::length)},
                     {"force", shown(r.force, Quantity::force)},
                     {"moment", shown(r.moment, Quantity::moment)},
                     {"axial", shown(r.axial, Quantity::force)},
                     {"determined", r.determined}});
    }
    return out;
  }

  Json residuals(const Check& check) const {
    return {{"closure_error", shown(check.closure_error, Quantity::length)},
            {"worst_joint", check.worst_joint},
            {"imbalance", shown(check.imbalance, Quantity::force)},
            {"worst_body", check.worst_body},
            {"largest_force", shown(check.largest_force, Quantity::force)},
            {"stop_violation", json_number(check.stop_violation)},
            {"worst_stop", check.worst_stop},
            {"accuracy", json_number(check.accuracy)},
            {"objection", check.objection}};
  }

  const StaticModel& model_;
  const Scene& scene_;
  const Units& units_;
};

}  // namespace

std::string solve_json(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings) {
  const Writer writer(model);
  Json document = writer.answer(answer);
  document["poise"] = POISE_VERSION;
  document["scene"] = json_scene(model.scene(), settings);
  document["units"] = json_units(model.scene().units);
  document["left_out"] = model.layout().dropped;
  return json_text(document, model.scene());
}

std::string compare_json(const StaticModel& model, const std::vector<Answer>& answers,
                         const std::vector<std::string>& settings) {
  const Writer writer(model);
  Json document = {{"poise", POISE_VERSION},
                   {"scene", json_scene(model.scene(), settings)},
                   {"units", json_units(model.scene().units)},
                   {"left_out", model.layout().dropped}};
  document["methods"] = Json::array();
  for (const Answer& answer : answers) document["methods"].push_back(writer.answer(answer));
  const comparison::Agreement agreement = comparison::compare_answers(model, answers);
  if (agreement.confirmed < 2)
    document["agreement"] = nullptr;
  else
    document["agreement"] = {{"same", agreement.same}, {"largest_difference", json_number(agreement.difference)}};
  return json_text(document, model.scene());
}

}  // namespace poise::app
