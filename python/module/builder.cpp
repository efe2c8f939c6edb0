#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "model/input_error.hpp"
#include "model/scene_builder.hpp"
#include "python/module/bindings.hpp"
#include "python/module/conversion.hpp"

namespace poise::python {
namespace {

using Builder = SceneBuilder;
using Keys = std::vector<Builder::Key>;

/// A SceneBuilder, with its title for messages.
struct NamedBuilder {
  std::string title;
  Builder builder;

  [[noreturn]] void fail(const std::string& item, const std::string& expected, const py::handle& found) const {
    throw InputError(fmt::format("{}: {}: expected {}, found {}", title, item, expected, shown(found)));
  }
};

/// Members of a list, a tuple or an array; nothing of anything else.
std::optional<std::vector<py::object>> members_in(const py::handle& value) {
  if (py::isinstance<py::str>(value) || PySequence_Check(value.ptr()) == 0 || PyDict_Check(value.ptr()) != 0) {
    return std::nullopt;
  }
  const py::object list = py::reinterpret_steal<py::object>(PySequence_List(value.ptr()));
  if (!list) {
    clear_failed_conversion();
    return std::nullopt;
  }
  std::vector<py::object> out;
  for (const py::handle member : py::reinterpret_borrow<py::list>(list)) {
    out.push_back(py::reinterpret_borrow<py::object>(member));
  }
  return out;
}

std::optional<Vec2> pair_in(const py::handle& value) {
  const auto members = members_in(value);
  if (!members || members->size() != 2) return std::nullopt;
  const std::optional<double> x = number_in((*members)[0]), y = number_in((*members)[1]);
  if (!x || !y) return std::nullopt;
  return Vec2{*x, *y};
}

/// Texts and numbers, as expressions, of which at least one is a text.
/// One number or more.
std::optional<std::vector<double>> numbers_in(const py::handle& value) {
  const auto members = members_in(value);
  if (!members || members->empty()) return std::nullopt;
  std::vector<double> out;
  for (const py::object& member : *members) {
    const std::optional<double> number = py::isinstance<py::str>(member) ? std::nullopt : number_in(member);
    if (!number) return std::nullopt;
    out.push_back(*number);
  }
  return out;
}

std::optional<std::vector<std::string>> words_in(const py::handle& value) {
  const auto members = members_in(value);
  if (!members) return std::nullopt;
  std::vector<std::string> out;
  bool has_text = false;
  for (const py::object& member : *members) {
    const bool is_text = py::isinstance<py::str>(member);
    const std::optional<double> number = is_text ? std::nullopt : number_in(member);
    if (!is_text && !number) return std::nullopt;
    has_text = has_text || is_text;
    out.push_back(is_text ? utf8(member) : fmt::format("{}", *number));
  }
  if (!has_text) return std::nullopt;
  return out;
}

double number_of(const NamedBuilder& self, const std::string& item, const py::handle& value) {
  const std::optional<double> number = number_in(value);
  if (!number) self.fail(item, "a number", value);
  return *number;
}

std::string word_of(const NamedBuilder& self, const std::string& item, const py::handle& value) {
  if (!py::isinstance<py::str>(value)) self.fail(item, "a text", value);
  return utf8(value);
}

Vec2 pair_of(const NamedBuilder& self, const std::string& item, const py::handle& value) {
  const std::optional<Vec2> pair = pair_in(value);
  if (!pair) self.fail(item, "two numbers", value);
  return *pair;
}

std::vector<Vec2> pairs_of(const NamedBuilder& self, const std::string& item, const py::handle& value) {
  const auto members = members_in(value);
  if (!members) self.fail(item, "pairs of numbers", value);
  std::vector<Vec2> out;
  for (const py::object& member : *members) {
    const std::optional<Vec2> pair = pair_in(member);
    if (!pair) self.fail(item, "pairs of numbers", value);
    out.push_back(*pair);
  }
  return out;
}

std::vector<std::string> words_of(const NamedBuilder& self, const std::string& item, const py::handle& value) {
  const auto members = members_in(value);
  if (!members) self.fail(item, "a list of texts", value);
  std::vector<std::string> out;
  for (const py::object& member : *members) out.push_back(word_of(self, item, member));
  return out;
}

/// The dictionaries of a list; none where it is empty or has something else.
std::optional<std::vector<py::dict>> dicts_in(const py::handle& value) {
  const auto members = members_in(value);
  if (!members || members->empty()) return std::nullopt;
  std::vector<py::dict> out;
  for (const py::object& member : *members) {
    if (PyDict_Check(member.ptr()) == 0) return std::nullopt;
    out.push_back(py::reinterpret_borrow<py::dict>(member));
  }
  return out;
}

/// The keys of a table, of which those of tables in it are in dictionaries of their own.
Keys keys_of(const NamedBuilder& self, const std::string& item, const py::dict& given, const std::string& above = "") {
  Keys out;
  for (const auto& [name, value] : given) {
    const std::string key = above + word_of(self, item, name);
    const std::string place = fmt::format("{}.{}", item, key);
    if (py::isinstance<py::str>(value)) {
      out.emplace_back(key, utf8(value));
    } else if (is_flag(value)) {
      out.emplace_back(key, py::bool_(py::reinterpret_borrow<py::object>(value)).cast<bool>());
    } else if (const std::optional<double> number = number_in(value)) {
      out.emplace_back(key, *number);
    } else if (PyDict_Check(value.ptr()) != 0) {
      const Keys below = keys_of(self, item, py::reinterpret_borrow<py::dict>(value), key + ".");
      out.insert(out.end(), below.begin(), below.end());
    } else if (const std::optional<Vec2> pair = pair_in(value)) {
      out.emplace_back(key, *pair);
    } else if (const auto tables = dicts_in(value)) {
      Builder::Key::Tables all;
      for (const py::dict& one : *tables) all.push_back(keys_of(self, item, one));
      out.emplace_back(key, std::move(all));
    } else if (const auto numbers = numbers_in(value)) {
      out.emplace_back(key, *numbers);
    } else if (const auto words = words_in(value)) {
      out.emplace_back(key, *words);
    } else if (members_in(value)) {
      out.emplace_back(key, pairs_of(self, place, value));
    } else {
      self.fail(place, "a number, a text, True or False, or pairs of numbers", value);
    }
  }
  return out;
}

Builder::BodyData body_of(const NamedBuilder& self, const std::string& name, const py::dict& points,
                          const py::handle& mass, const py::handle& center, const py::handle& inertia) {
  const std::string item = "body." + name;
  Builder::BodyData out;
  for (const auto& [point, at] : points) {
    const std::string known = word_of(self, item + ".points", point);
    out.points.emplace_back(known, pair_of(self, fmt::format("{}.points.{}", item, known), at));
  }
  out.mass = number_of(self, item + ".mass", mass);
  out.center = pair_of(self, item + ".center", center);
  out.inertia = number_of(self, item + ".inertia", inertia);
  return out;
}

std::vector<Builder::CamPart> cam_law_of(const NamedBuilder& self, const py::handle& law) {
  const auto parts = members_in(law);
  if (!parts) self.fail("cam.law", "a list of parts (to, law, lift)", law);
  std::vector<Builder::CamPart> out;
  for (const py::object& part : *parts) {
    const auto members = members_in(part);
    if (!members || members->size() < 2 || members->size() > 3)
      self.fail("cam.law", "(to, law) or (to, law, lift)", part);
    Builder::CamPart& read = out.emplace_back();
    read.to = number_of(self, "cam.law.to", (*members)[0]);
    read.law = word_of(self, "cam.law.law", (*members)[1]);
    if (members->size() == 3 && !(*members)[2].is_none()) read.lift = number_of(self, "cam.law.lift", (*members)[2]);
  }
  return out;
}

std::vector<Builder::RopePoint> rope_of(const NamedBuilder& self, const py::handle& over) {
  const std::string expected = "points \"BODY.POINT\" and pulleys (\"BODY.POINT\", radius, turn)";
  const auto members = members_in(over);
  if (!members) self.fail("rope.over", expected, over);
  std::vector<Builder::RopePoint> out;
  for (const py::object& member : *members) {
    if (py::isinstance<py::str>(member)) {
      out.emplace_back(utf8(member));
      continue;
    }
    const auto pulley = members_in(member);
    if (!pulley || pulley->size() != 3) self.fail("rope.over", expected, member);
    out.emplace_back(word_of(self, "rope.over", (*pulley)[0]), number_of(self, "rope.over.radius", (*pulley)[1]),
                     word_of(self, "rope.over.turn", (*pulley)[2]));
  }
  return out;
}

using Named = NamedBuilder;
using Text = const std::string&;
using Any = const py::object&;

void bind_measures(py::module_& m) {
  py::class_<MeasureByName>(m, "Measure", "A measure by the names of what it is taken between.")
      .def_static("angle", measures::angle)
      .def_static("distance", measures::distance)
      .def_static("travel", measures::travel)
      .def_static("x", measures::x)
      .def_static("y", measures::y)
      .def_static("nothing", measures::nothing)
      .def_static("sum", [](const std::vector<std::pair<double, MeasureByName>>& terms) {
        std::vector<MeasureByName::Term> out;
        for (const auto& [factor, measure] : terms) out.push_back({factor, measure});
        return measures::sum(std::move(out));
      });
}

void bind_items(py::class_<Named>& type) {
  type.def("source", [](Named& b, Text text) { b.builder.source(text); })
      .def("number",
           [](Named& b, Text name, Any value) {
             if (py::isinstance<py::str>(value)) {
               b.builder.number(name, utf8(value));
             } else {
               b.builder.number(name, number_of(b, "numbers." + name, value));
             }
           })
      .def("output", [](Named& b, Text name, Text quantity) { b.builder.output(name, quantity); })
      .def("gravity", [](Named& b, Any acceleration) { b.builder.gravity(pair_of(b, "gravity", acceleration)); })
      .def("frame", [](Named& b, Text axis, const py::dict& keys) { b.builder.frame(axis, keys_of(b, "frame", keys)); })
      .def("ground_point",
           [](Named& b, Text name, Any at) { b.builder.ground_point(name, pair_of(b, "ground.points." + name, at)); })
      .def("body", [](Named& b, Text name, const py::dict& points, Any mass, Any center,
                      Any inertia) { b.builder.body(name, body_of(b, name, points, mass, center, inertia)); })
      .def("section",
           [](Named& b, Text body, Any line, const py::dict& keys) {
             const std::string item = "body." + body + ".section";
             b.builder.section(body, keys_of(b, item, keys), words_of(b, item + ".line", line));
           })
      .def("part", [](Named& b, Text file, const py::dict& keys,
                      Text name) { b.builder.part(file, keys_of(b, "part", keys), name); })
      .def("start", [](Named& b, Text name, Any value) { b.builder.start(name, number_of(b, "start." + name, value)); })
      .def("start_position", [](Named& b, Text body, Any at) {
        b.builder.start_position(body, pair_of(b, "start.position." + body, at));
      });
}

void bind_joints(py::class_<Named>& type) {
  type.def("pin", [](Named& b, Text p, Text q, Text name) { b.builder.pin(p, q, name); })
      .def("slide",
           [](Named& b, Text p, Text q, Any axis, Text name, Any angle) {
             b.builder.slide(p, q, pair_of(b, "slide.axis", axis), name, number_of(b, "slide.angle", angle));
           })
      .def("pin_in_slot", [](Named& b, Text p, Text q, Any axis,
                             Text name) { b.builder.pin_in_slot(p, q, pair_of(b, "pin_in_slot.axis", axis), name); })
      .def("weld", [](Named& b, Text p, Text q, Any angle,
                      Text name) { b.builder.weld(p, q, number_of(b, "weld.angle", angle), name); })
      .def("bar", [](Named& b, Text p, Text q, Any length,
                     Text name) { b.builder.bar(p, q, number_of(b, "bar.length", length), name); })
      .def("friction", [](Named& b, const py::dict& keys) { b.builder.friction(keys_of(b, "friction", keys)); });
}

void bind_elements(py::class_<Named>& type) {
  type.def("element", [](Named& b, Text table, Text name, const MeasureByName& on,
                         const py::dict& keys) { b.builder.element(table, name, on, keys_of(b, table, keys)); })
      .def("drive", [](Named& b, Text name, const MeasureByName& on,
                       const py::dict& keys) { b.builder.drive(name, on, keys_of(b, "drive", keys)); })
      .def("stop", [](Named& b, Text name, const MeasureByName& on,
                      const py::dict& keys) { b.builder.stop(name, on, keys_of(b, "stop", keys)); })
      .def("blade", [](Named& b, Text at, const py::dict& keys, Text name) {
        b.builder.blade(at, keys_of(b, "blade", keys), name);
      });
}

void bind_couplings(py::class_<Named>& type) {
  const auto between = [&type](const char* name, auto method) {
    type.def(name, [name, method](Named& b, Text p, Text q, const py::dict& keys, Text item) {
      (b.builder.*method)(p, q, keys_of(b, name, keys), item);
    });
  };
  between("gear", &Builder::gear);
  between("belt", &Builder::belt);
  between("rack", &Builder::rack);
  between("geneva", &Builder::geneva);
  between("chain", &Builder::chain);
  between("loose_pin", &Builder::loose_pin);
  between("circular_slot", &Builder::circular_slot);
  between("rolling_on_circle", &Builder::rolling_on_circle);
  type.def("coupling", [](Named& b, const MeasureByName& sum, const py::dict& keys,
                          Text name) { b.builder.coupling(sum, keys_of(b, "coupling", keys), name); })
      .def("cam", [](Named& b, Text p, Text q, const MeasureByName& follower, Any law, const py::dict& keys,
                     Text name) { b.builder.cam(p, q, follower, cam_law_of(b, law), keys_of(b, "cam", keys), name); })
      .def("rope", [](Named& b, Any over, const py::dict& keys,
                      Text name) { b.builder.rope(rope_of(b, over), keys_of(b, "rope", keys), name); })
      .def("loose_slot",
           [](Named& b, Text p, Text q, Any axis, const py::dict& keys, Text name) {
             b.builder.loose_slot(p, q, pair_of(b, "loose_slot.axis", axis), keys_of(b, "loose_slot", keys), name);
           })
      .def("contact",
           [](Named& b, Text point, Any way, const py::dict& keys, Text name) {
             b.builder.contact(point, words_of(b, "contact.way", way), keys_of(b, "contact", keys), name);
           })
      .def("contact_of_outlines",
           [](Named& b, Any outline, Any against, const py::dict& keys, Text name) {
             b.builder.contact_of_outlines(words_of(b, "contact.outline", outline),
                                           words_of(b, "contact.against", against), keys_of(b, "contact", keys), name);
           })
      .def("contact_with_arc",
           [](Named& b, Text point, Text center, Text from, Text to, bool hollow, const py::dict& keys, Text name) {
             b.builder.contact_with_arc(point, center, from, to, hollow, keys_of(b, "contact", keys), name);
           })
      .def("curved_slot",
           [](Named& b, Text pin, Text at, Any curve, const py::dict& keys, Text name) {
             b.builder.curved_slot(pin, at, pairs_of(b, "curved_slot.curve", curve), keys_of(b, "curved_slot", keys),
                                   name);
           })
      .def("rolling",
           [](Named& b, Text wheel, Text line, Any axis, const py::dict& keys, Text name) {
             b.builder.rolling(wheel, line, pair_of(b, "rolling.axis", axis), keys_of(b, "rolling", keys), name);
           })
      .def("rolling_profile",
           [](Named& b, Text at, Any curve, Text line, Any axis, const py::dict& keys, Text name) {
             b.builder.rolling_profile(at, pairs_of(b, "rolling_profile.curve", curve), line,
                                       pair_of(b, "rolling_profile.axis", axis), keys_of(b, "rolling_profile", keys),
                                       name);
           })
      .def("rolling_profile_on_circle",
           [](Named& b, Text at, Any curve, Text center, const py::dict& keys, Text name) {
             b.builder.rolling_profile_on_circle(at, pairs_of(b, "rolling_profile_on_circle.curve", curve), center,
                                                 keys_of(b, "rolling_profile_on_circle", keys), name);
           })
      .def("curve_contact",
           [](Named& b, Text at, Any curve, Text against, Any against_curve, const py::dict& keys, Text name) {
             b.builder.curve_contact(at, pairs_of(b, "curve_contact.curve", curve), against,
                                     pairs_of(b, "curve_contact.against_curve", against_curve),
                                     keys_of(b, "curve_contact", keys), name);
           });
}

void bind_loads(py::class_<Named>& type) {
  type.def("force", [](Named& b, Text name, Text at, Any vector,
                       Text follows) { b.builder.force(name, at, pair_of(b, "force.vector", vector), follows); })
      .def("force_along",
           [](Named& b, Text name, Text at, Any direction, Any size, Text follows) {
             b.builder.force_along(name, at, pair_of(b, "force.direction", direction), number_of(b, "force.size", size),
                                   follows);
           })
      .def("distributed_load",
           [](Named& b, Text name, Text p, Text q, Any vector, Text follows) {
             b.builder.distributed_load(name, p, q, pair_of(b, "distributed_load.vector", vector), follows);
           })
      .def("distributed_load_along",
           [](Named& b, Text name, Text p, Text q, Any direction, Any size, Text follows) {
             b.builder.distributed_load_along(name, p, q, pair_of(b, "distributed_load.direction", direction),
                                              number_of(b, "distributed_load.size", size), follows);
           })
      .def("torque", [](Named& b, Text name, Text body, Any value) {
        b.builder.torque(name, body, number_of(b, "torque.value", value));
      });
}

}  // namespace

void bind_builder(py::module_& m) {
  bind_measures(m);
  py::class_<Named> type(m, "SceneBuilder", "Builds a scene, as SceneBuilder of C++ does.");
  type.def(py::init([](const std::string& title, const std::string& length, const std::string& force,
                       const std::string& mass, const std::string& angle) {
    return std::make_unique<Named>(
        Named{title, Builder(title, {.length = length, .force = force, .mass = mass, .angle = angle})});
  }));
  bind_items(type);
  bind_joints(type);
  bind_elements(type);
  bind_couplings(type);
  bind_loads(type);
  type.def("text", [](const Named& b) { return b.builder.text(); }).def("build", [](const Named& b) {
    // Checked in the words of the builder, which has no lines.
    b.builder.build();
    return std::const_pointer_cast<SceneObject>(SceneObject::parse(b.builder.text(), b.title, {}));
  });
}

}  // namespace poise::python
