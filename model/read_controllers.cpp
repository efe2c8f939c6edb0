#include "model/read_controllers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/read_curve.hpp"
#include "model/read_elements.hpp"

namespace poise {
namespace {

/// Those of numbers first, in the order of Controller::Id.
constexpr std::array<std::string_view, 17> own_keys_of_controller{
    "proportional", "integral", "derivative", "filter",     "reference", "dead_band", "min",   "max", "tracking_time",
    "period",       "delay",    "reads",      "reads_rate", "transfer",  "follows",   "table", "sets"};

bool names_measure(const TomlTable& table) {
  const MeasureKeys& keys = all_measures();
  return std::any_of(keys.begin(), keys.end(), [&](std::string_view key) { return table.has(key); });
}

/// The measure of one that reads or acts on none.
Measure no_measure() { return Measure::angle_between(0, 0); }

/// What the keys of a table need beside them.
void expect_beside(const TomlTable& table, const Controller& law, const Feedback& feedback) {
  const auto expect = [&](std::string_view key, std::string_view other) {
    if (table.has(key) && !table.has(other)) {
      table.place_of(key).fail("expected the key " + std::string(other) + " beside it; add it");
    }
  };
  expect("filter", "derivative");
  expect("tracking_time", "integral");
  if (table.has("tracking_time") && !table.has("min") && !table.has("max")) {
    table.place_of("tracking_time").fail("expected the key min or max beside it, which limits the effort; add it");
  }
  constexpr std::array<std::string_view, 5> terms{"proportional", "integral", "derivative", "transfer", "table"};
  if (std::none_of(terms.begin(), terms.end(), [&](std::string_view key) { return table.has(key); })) {
    table.place().fail(
        "expected one of the keys proportional, integral, derivative, transfer and table, by which it acts; add one");
  }
  if (table.has("derivative") && feedback.source == Feedback::Source::nothing) {
    table.place_of("derivative").fail("expected something that it reads, of which the rate is taken; leave it out");
  }
  const bool reads_without_rate =
      law.of_rate || feedback.source == Feedback::Source::controller || feedback.source == Feedback::Source::force;
  if (reads_without_rate && table.has("derivative") && !table.has("filter")) {
    table.place_of("derivative")
        .fail(std::string("expected the key filter beside it, because it reads ") +
              (law.of_rate                                  ? "a rate"
               : feedback.source == Feedback::Source::force ? "a force"
                                                            : "what a controller gives") +
              "; add it");
  }
  if (feedback.source != Feedback::Source::measure) {
    if (table.has("reads_rate")) {
      table.place_of("reads_rate").fail("expected it beside a measure that is read; leave it out");
    }
  }
  if (table.has("delay") && table.has("period")) {
    table.place_of("delay").fail(
        "expected delay or period, found both; make two controllers, of which the one with the delay follows the "
        "other");
  }
  if (table.has("filter") && table.has("transfer")) {
    table.place_of("filter").fail("expected filter or transfer, found both; make two controllers");
  }
  if (table.has("time") && table.holds_table("time") && table.find_table("time")->has("reference") &&
      !table.has("reference")) {
    table.place_of("time").fail(
        "expected the key reference beside it, which time.reference multiplies; add "
        "reference = 1");
  }
}

/// The coefficients of a transfer function, ascending: first those of its numerator.
std::array<std::vector<double>, 2> read_transfer(const TomlTable& table, Controller& law) {
  if (!table.holds_table("transfer")) {
    table.place_of("transfer")
        .fail("expected the table of a transfer function, say transfer = { numerator = [2], denominator = [1, 0.1] }");
  }
  const TomlTable transfer = *table.find_table("transfer");
  transfer.allow_keys({"numerator", "denominator"});
  std::array<std::vector<double>, 2> out{transfer.numbers("numerator"), transfer.numbers("denominator")};
  if (out[1].size() != 2 && out[1].size() != 3) {
    transfer.place_of("denominator")
        .fail("expected 2 or 3 coefficients, of a first or second order, ascending in powers of p, found " +
              std::to_string(out[1].size()));
  }
  if (out[0].empty() || out[0].size() > out[1].size()) {
    transfer.place_of("numerator")
        .fail("expected at least 1 coefficient and at most those of the denominator, ascending in powers of p, found " +
              std::to_string(out[0].size()));
  }
  law.order = static_cast<int>(out[1].size()) - 1;
  for (std::size_t k = 0; k < out[0].size(); ++k) law.given |= 1U << (Controller::numerator + static_cast<int>(k));
  for (std::size_t k = 0; k < out[1].size(); ++k) law.given |= 1U << (Controller::denominator + static_cast<int>(k));
  return out;
}

void read_curve_of_controller(const TomlTable& table, Controller& law, double unit_error, double unit_output) {
  if (!table.holds_table("table")) {
    table.place_of("table").fail(
        "expected the table of a curve, say table = { curve = [[-1, -5], [0, 0], [1, 5]] } of points [error, output]");
  }
  const TomlTable curve = *table.find_table("table");
  CurvePoints points = read_table_of_controller(curve, unit_error, unit_output);
  law.numbered_points = curve.has("curve");
  law.curve = std::make_shared<const ForceCurve>(std::move(points.x), std::move(points.y));
}

}  // namespace

Element read_what_controller_acts_on(const TomlTable& table, const MeasureReader& measures) {
  std::vector<std::string_view> allowed{own_keys_of_controller.begin(), own_keys_of_controller.end()};
  allowed.emplace_back("time");
  Element element;
  element.table = "controller";
  element.law = Controller{};
  element.feedback.emplace();
  const bool names_other = table.has("reads") || table.has("follows") || table.has("sets");
  element.feedback->acts = names_measure(table) || !names_other;
  if (element.feedback->acts && table.has("sets")) {
    table.place_of("sets").fail(
        "expected sets, or a measure that it acts on, found both; make two controllers, of which one reads what the "
        "other gives");
  }
  if (element.feedback->acts) {
    element.on = measures.read(table, all_measures(), allowed);
  } else {
    allowed.emplace_back("name");
    const MeasureKeys& keys = all_measures();
    allowed.insert(allowed.end(), keys.begin(), keys.end());
    table.allow_keys(allowed);
    element.on = no_measure();
  }
  return element;
}

void ControllerReader::read() {
  const std::vector<TomlTable> tables = root_.tables("controller");
  std::size_t next = 0;
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    if (scene_.elements[e].feedback) all_.push_back({static_cast<int>(e), tables[next++]});
  }
  for (const One& one : all_) read_sources(one);
  for (const One& one : all_) read_set_number(one);
  refuse_idle();
  find_dimensions();
  for (const One& one : all_) read_law(one);
  for (const One& one : all_) refuse_at_once(one);
  refuse_loops();
  for (const One& one : all_) add_states(one);
}

/// The element of the controller of this name, another one than `one`.
int ControllerReader::other(const One& one, const TomlText& name) const {
  for (const One& candidate : all_) {
    if (scene_.elements[static_cast<std::size_t>(candidate.element)].name != name.value) continue;
    if (candidate.element == one.element) name.place.fail("expected another controller, found its own name");
    return candidate.element;
  }
  std::vector<std::string> names;
  for (const One& candidate : all_) {
    if (candidate.element != one.element)
      names.push_back(scene_.elements[static_cast<std::size_t>(candidate.element)].name);
  }
  name.place.fail(fmt::format("expected the name of another controller, found \"{}\"; they are {}", name.value,
                              names.empty() ? "none" : fmt::format("\"{}\"", fmt::join(names, "\", \""))));
}

void ControllerReader::read_sources(const One& one) {
  const TomlTable& table = one.table;
  Element& own = element(one);
  Feedback& feedback = *own.feedback;
  if (table.has("follows")) feedback.follows = other(one, table.text("follows"));
  feedback.reads = no_measure();
  if (table.has("reads")) {
    if (!table.holds_table("reads")) {
      const std::optional<TomlText> word = table.find_text("reads");
      if (!word || word->value != "nothing") {
        table.place_of("reads").fail(
            "expected the table of a measure, say reads = { bodies = [\"ground\", \"arm\"] }, one with the key "
            "controller, force or reaction, or \"nothing\"");
      }
      feedback.source = Feedback::Source::nothing;
    } else if (const TomlTable reads = *table.find_table("reads"); reads.has("controller")) {
      reads.allow_keys({"controller"});
      feedback.source = Feedback::Source::controller;
      feedback.reads_from = other(one, reads.text("controller"));
    } else if (reads.has("force")) {
      reads.allow_keys({"force"});
      feedback.source = Feedback::Source::force;
      read_force(reads.text("force"), feedback);
    } else if (reads.has("reaction")) {
      reads.allow_keys({"reaction", "along"});
      feedback.source = Feedback::Source::force;
      read_reaction(reads, feedback);
    } else {
      MeasureKeys measures = all_measures();
      std::erase(measures, "sum");
      feedback.reads = measures_.read(reads, measures, {});
    }
  } else if (!feedback.acts) {
    feedback.source = Feedback::Source::nothing;
  } else if (own.on.kind == Measure::Kind::sum) {
    table.place_of("sum").fail("expected the key reads beside it, the measure that is controlled; add it");
  } else {
    feedback.reads = own.on;
  }
  if (feedback.source == Feedback::Source::nothing && feedback.follows < 0) {
    table.place_of(table.has("reads") ? "reads" : "sets")
        .fail("expected the key follows beside it, or something that it reads; add it");
  }
}

/// The element or drive whose force is read.
void ControllerReader::read_force(const TomlText& name, Feedback& feedback) const {
  std::vector<std::string> names, families;
  const auto find = [&](const std::string& candidate, const std::string& family, int& index, std::size_t k) {
    names.push_back(candidate);
    if (candidate != name.value) return;
    families.push_back(family);
    index = static_cast<int>(k);
  };
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    const Element& candidate = scene_.elements[e];
    if (candidate.feedback || sticks(candidate.law)) continue;
    find(candidate.name, candidate.family(), feedback.reads_force, e);
  }
  for (std::size_t d = 0; d < scene_.drives.size(); ++d) find(scene_.drives[d].name, "drive", feedback.reads_drive, d);
  if (families.size() > 1) {
    name.place.fail(fmt::format("expected a name that one element has, found \"{}\", that of a {} and a {}; rename one",
                                name.value, families[0], families[1]));
  }
  if (families.empty()) {
    name.place.fail(fmt::format(
        "expected the name of a spring, a damper or another element whose force follows from places and rates, or of a "
        "drive, found \"{}\"; they are {}",
        name.value, names.empty() ? "none" : fmt::format("\"{}\"", fmt::join(names, "\", \""))));
  }
}

/// The joint whose reaction is read, and along which axis.
void ControllerReader::read_reaction(const TomlTable& reads, Feedback& feedback) const {
  const TomlText name = reads.text("reaction"), along = reads.text("along");
  std::vector<std::string> names;
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    if (scene_.joints[j].keeps_length()) continue;
    names.push_back(scene_.joints[j].name);
    if (scene_.joints[j].name == name.value) feedback.reads_joint = static_cast<int>(j);
  }
  if (feedback.reads_joint < 0) {
    name.place.fail(fmt::format("expected the name of a pin, a slide, a pin in a slot or a weld, found \"{}\"{}",
                                name.value, did_you_mean_or_list(name.value, names)));
  }
  if (along.value != "x" && along.value != "y") {
    along.place.fail(fmt::format("expected \"x\" or \"y\", found \"{}\"", along.value));
  }
  feedback.along = along.value == "x" ? 0 : 1;
}

/// Throws InputError where what a controller gives depends at once on a force that depends on what it gives.
void ControllerReader::refuse_at_once(const One& one) const {
  const Element& own = scene_.elements[static_cast<std::size_t>(one.element)];
  if (!own.feedback->reads_reaction()) return;
  const Controller& law = *controller_of(own.law);
  if (law.is_direct()) {
    one.table.place_of("reads").fail(
        "expected a force that follows from places and rates: that in a joint or of a drive depends at once on what "
        "controllers give; give this one a period, only an integral, or a transfer function with fewer coefficients "
        "above than below");
  }
  for (const std::string_view key : {"delay", "dead_band", "table"}) {
    if (law.has(Controller::period) || !one.table.has(key)) continue;
    one.table.place_of(key).fail(fmt::format(
        "expected {} at a controller that follows or reads this one: beside the force in a joint or of a drive it is "
        "known with a period alone",
        key));
  }
}

/// The number that it adds to.
void ControllerReader::read_set_number(const One& one) {
  if (!one.table.has("sets")) return;
  const TomlText path = one.table.text("sets");
  const ParameterRow row = located(path.place, [&] { return parameter(scene_, path.value); });
  Feedback::Sets sets{.item = row.place.item, .number = row.place.number, .path = path.value};
  const auto item = static_cast<std::size_t>(row.place.item);
  if (row.place.owner == Owner::force && scene_.forces[item].has_direction_of_its_own()) {
    sets.of = TimeFunction::Of::force;
  } else if (row.place.owner == Owner::torque) {
    sets.of = TimeFunction::Of::torque;
  } else if (row.place.owner == Owner::drive) {
    sets.of = TimeFunction::Of::drive;
    if (row.path.parts[3] != "acceleration") {
      path.place.fail(fmt::format(
          "expected \"drive.{}.acceleration\": a drive moves without jumps of its place and its rate, found \"{}\"",
          scene_.drives[item].name, path.value));
    }
    const int other = controller_of_drive(scene_, row.place.item);
    if (other >= 0) {
      path.place.fail(fmt::format(
          "expected a drive that no other controller sets, found that of \"{}\"; let one of them follow the other",
          scene_.elements[static_cast<std::size_t>(other)].name));
    }
  } else if (row.place.owner == Owner::element && varies_in_motion(scene_.elements[item].law)) {
    const Element& target = scene_.elements[item];
    const bool is_length = row.path.parts[3].ends_with("length") || row.path.parts[3].ends_with("angle");
    if (is_length && !borders_of(target.law, false).empty()) {
      path.place.fail(fmt::format("expected another number of {} \"{}\": it acts on one side only, from this length on",
                                  target.family(), target.name));
    }
    const int other = controller_that_sets(scene_, row.place.item);
    if (other >= 0) {
      path.place.fail(fmt::format(
          "expected an element of which no other controller sets a number, found {}, which \"{}\" sets; let one of "
          "them follow the other",
          scene_.elements[static_cast<std::size_t>(other)].feedback->sets->path,
          scene_.elements[static_cast<std::size_t>(other)].name));
    }
  } else {
    path.place.fail(
        "expected a number of a spring, a damper or a constant force, a load that is given by direction and size, a "
        "torque, or the acceleration of a drive");
  }
  element(one).feedback->sets = std::move(sets);
}

/// Throws InputError for one that acts on nothing and that no other one follows or reads.
void ControllerReader::refuse_idle() const {
  for (const One& one : all_) {
    const bool is_used = std::any_of(all_.begin(), all_.end(), [&](const One& user) {
      const Feedback& feedback = *scene_.elements[static_cast<std::size_t>(user.element)].feedback;
      return feedback.follows == one.element || feedback.reads_from == one.element;
    });
    const Element& own = scene_.elements[static_cast<std::size_t>(one.element)];
    if (own.feedback->acts || own.feedback->sets || is_used) continue;
    one.table.place().fail(fmt::format(
        "expected what it acts on or sets, or a controller with follows = \"{}\": without either it does nothing",
        own.name));
  }
}

/// Throws InputError for controllers that depend on each other at once, in a circle.
void ControllerReader::refuse_loops() const {
  const std::vector<int> circle = circle_of_decisions(scene_);
  if (circle.empty()) return;
  std::vector<std::string> names;
  for (const int e : circle) names.push_back(scene_.elements[static_cast<std::size_t>(e)].name);
  throw InputError(fmt::format(
      "{}:{}: controllers \"{}\" are an algebraic loop: each depends at once on what the next one gives, "
      "and the last on the first; give one of them only an integral, a transfer function with fewer "
      "coefficients above than below, or a delay",
      scene_.file, scene_.elements[static_cast<std::size_t>(circle.front())].line, fmt::join(names, "\", \"")));
}

/// What a controller gives has the dimension of what follows or reads it: of those that act, an effort.
void ControllerReader::find_dimensions() {
  const std::size_t count = scene_.elements.size();
  std::vector<std::optional<Dimension>> signal(count), output(count);
  for (const One& one : all_) {
    const auto e = static_cast<std::size_t>(one.element);
    const Feedback& feedback = *scene_.elements[e].feedback;
    if (feedback.source == Feedback::Source::measure) {
      signal[e] = feedback.reads.dimension() * dimension::time.power(one.table.flag("reads_rate", false) ? -1 : 0);
    }
    if (feedback.source == Feedback::Source::force) {
      signal[e] = feedback.reads_drive >= 0
                      ? scene_.drives[static_cast<std::size_t>(feedback.reads_drive)].on.effort_dimension()
                  : feedback.reads_joint >= 0
                      ? dimension::force
                      : scene_.elements[static_cast<std::size_t>(feedback.reads_force)].on.effort_dimension();
    }
    if (feedback.acts) output[e] = scene_.elements[e].on.effort_dimension();
    if (feedback.sets) output[e] = parameter(scene_, feedback.sets->path).dimension;
  }
  for (bool again = true; again;) {
    again = false;
    for (const One& one : all_) {
      const auto e = static_cast<std::size_t>(one.element);
      const Feedback& feedback = *scene_.elements[e].feedback;
      for (const int from : {feedback.follows, feedback.reads_from}) {
        if (from < 0) continue;
        std::optional<Dimension>& given = output[static_cast<std::size_t>(from)];
        if (signal[e] && given && !(*signal[e] == *given)) {
          const std::string &read = signal[e]->unit_name(scene_.units), &by = given->unit_name(scene_.units);
          one.table.place_of(from == feedback.follows ? "follows" : "reads")
              .fail(fmt::format("expected a controller that gives what this one reads, in {}; \"{}\" gives {}", read,
                                scene_.elements[static_cast<std::size_t>(from)].name, by));
        }
        again = again || signal[e].has_value() != given.has_value();
        if (!signal[e]) signal[e] = given;
        if (!given) given = signal[e];
      }
    }
  }
  for (const One& one : all_) {
    const auto e = static_cast<std::size_t>(one.element);
    scene_.elements[e].feedback->signal = signal[e].value_or(dimension::none);
    scene_.elements[e].feedback->output = output[e].value_or(dimension::none);
  }
}

void ControllerReader::read_law(const One& one) {
  const TomlTable& table = one.table;
  Element& own = element(one);
  const Feedback& feedback = *own.feedback;
  Controller law;
  law.of_rate = table.flag("reads_rate", false);
  for (int id = 0; id < Controller::numerator; ++id) {
    if (table.has(own_keys_of_controller[static_cast<std::size_t>(id)])) law.given |= 1U << id;
  }
  expect_beside(table, law, feedback);
  std::array<std::vector<double>, 2> transfer;
  if (table.has("transfer")) transfer = read_transfer(table, law);
  if (table.has("table")) {
    read_curve_of_controller(table, law, table.unit(feedback.signal), table.unit(feedback.output));
  }
  law.declare(feedback.signal, feedback.acts, feedback.output);
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  law.values[Controller::min] = -unlimited;
  law.values[Controller::max] = unlimited;
  const unsigned plain = law.given & ((1U << Controller::numerator) - 1U);
  read_numbers(table, law.all_numbers().first(static_cast<std::size_t>(std::popcount(plain))), &law, &own.on);
  for (const Number& number : law.all_numbers()) {
    const bool is_above = number.key.starts_with("numerator.");
    if (!is_above && !number.key.starts_with("denominator.")) continue;
    const double value = transfer[is_above ? 0 : 1][static_cast<std::size_t>(number.key.back() - '0')];
    located(table.place_of("transfer"), [&] { number.set(&law, value * table.unit(number.dimension_on(&own.on))); });
  }
  own.law = std::move(law);
}

/// The bodies whose rates are its states.
void ControllerReader::add_states(const One& one) {
  const Element own = element(one);
  Feedback feedback = *own.feedback;
  const auto add_state = [&](const char* what) {
    const std::string name = own.name + " " + what;
    for (const Body& body : scene_.bodies) {
      if (body.name == name) {
        throw InputError(scene_.file + ":" + std::to_string(own.line) + ": controller \"" + own.name +
                         "\": expected another name, the body \"" + name + "\" of line " + std::to_string(body.line) +
                         " has that of its state; rename one");
      }
    }
    const int body = scene_.add_body(name);
    scene_.bodies.back().inertia = Body::inertia_of_states;
    scene_.bodies.back().line = own.line;
    return body;
  };
  const Controller& law = std::get<Controller>(own.law);
  const bool has_state = law.has(Controller::filter) || law.order > 0;
  if (law.has(Controller::integral)) feedback.integral = add_state("integral");
  if (has_state) feedback.filter = add_state("state");
  if (law.holds()) feedback.held[0] = add_state("held effort");
  if (law.has(Controller::period)) {
    if (law.has(Controller::integral)) feedback.held[1] = add_state("held error");
    if (has_state) feedback.held[2] = add_state("held input");
  }
  if (feedback.sets && feedback.sets->of == TimeFunction::Of::drive) feedback.course = add_state("course");
  element(one).feedback = std::move(feedback);
}

}  // namespace poise
