// The table of all numbers of a scene: each is read, set and scaled at its path.

#include "model/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace poise::parameters_test {
namespace {

constexpr double inch = 0.0254;
constexpr double pound_force = 4.4482216152605;
constexpr double pound = 0.45359237;
constexpr double degree = 3.14159265358979323846 / 180.0;

// One of everything, and every law upon angles and lengths.
Scene everything() {
  return parse_scene(R"(
    gravity = [0.5, -386]
    [units]
    length = "in"
    force = "lbf"
    mass = "lb"
    angle = "deg"
    [ground]
    points = { O = [0, 0], S = [10, 1] }
    [body.crank]
    points = { O = [0, 0], B = [4, 0] }
    mass = 2
    center = [2, 0.25]
    inertia = 6
    [body.block]
    points = { C = [0, 0], D = [1, 1] }
    mass = 3
    [body."arm.1"]
    points = { E = [0, 1] }
    [[pin]]
    points = ["ground.O", "crank.O"]
    [[slide]]
    name = "ram"
    points = ["ground.S", "block.C"]
    axis = [3, 4]
    angle = 90
    [[pin_in_slot]]
    name = "slot"
    points = ["crank.B", "block.D"]
    axis = [0, 1]
    [[weld]]
    name = "joined"
    points = ["crank.B", "arm.1.E"]
    angle = -45
    [[bar]]
    name = "tie"
    points = ["ground.S", "crank.B"]
    length = 6
    [[spring]]
    name = "line"
    points = ["ground.O", "block.D"]
    stiffness = 3
    free_length = 5
    [[spring]]
    name = "turn"
    bodies = ["ground", "crank"]
    stiffness = 3
    free_angle = 20
    acts = "tension"
    [[spring]]
    name = "guide"
    slide = "ram"
    stiffness = 3
    free_length = -5
    [[spring]]
    name = "beside"
    x = "crank.B"
    stiffness = 3
    free_length = 5
    [[spring]]
    name = "gears"
    sum = [{ factor = 2, bodies = ["ground", "crank"] }, { factor = -1, bodies = ["ground", "block"] }]
    stiffness = 3
    free_angle = 5
    [[spring]]
    name = "tackle"
    sum = [{ factor = 2, slide = "ram" }, { factor = 1, y = "crank.B" }]
    stiffness = 3
    free_length = 5
    [[torsion_spring]]
    name = "coil"
    bodies = ["ground", "crank"]
    stiffness = 7
    free_angle = 450
    [[constant_force]]
    name = "weight"
    slide = "ram"
    force = 8
    [[constant_force]]
    name = "clockwork"
    bodies = ["ground", "crank"]
    torque = 9
    [[damper]]
    name = "oil"
    y = "block.D"
    coefficient = 0.5
    [[damper]]
    name = "rotary"
    bodies = ["ground", "crank"]
    coefficient = 0.5
    [[torsion_damper]]
    name = "grease"
    bodies = ["ground", "crank"]
    coefficient = 0.25
    [[friction]]
    name = "dry"
    bodies = ["crank", "arm.1"]
    torque = 3
    width = 2
    [[friction]]
    name = "rub"
    slide = "slot"
    force = 3
    width = 2
    [[drive]]
    name = "motor"
    bodies = ["ground", "crank"]
    start = 30
    [[drive]]
    name = "feed"
    slide = "ram"
    [[force]]
    name = "P"
    at = "crank.B"
    vector = [3, -4]
    [[torque]]
    name = "T"
    on = "crank"
    value = -8
    [[stop]]
    name = "sweep"
    bodies = ["ground", "crank"]
    min = -10
    max = 200
    [[stop]]
    name = "ceiling"
    y = "block.D"
    max = 200
    [start]
    crank = 30
    ram = 2
    position = { block = [10, 1] }
  )",
                     "everything.toml");
}

std::vector<std::string> paths_of(const Scene& scene) {
  std::vector<std::string> paths;
  for (const ParameterRow& row : parameter_table(scene)) paths.push_back(row.path.text());
  return paths;
}

TEST(Dimension, IsTheUnitOfItsName) {
  const Units units{"", "", "", "", inch, pound_force, pound, degree};
  EXPECT_EQ(dimension::none.unit(units), 1.0);
  EXPECT_EQ(dimension::angle.unit(units), degree);
  EXPECT_EQ(dimension::length.unit(units), inch);
  EXPECT_EQ(dimension::force.unit(units), pound_force);
  EXPECT_EQ(dimension::torque.unit(units), pound_force * inch);
  EXPECT_EQ(dimension::mass.unit(units), pound);
  EXPECT_EQ(dimension::inertia.unit(units), pound * inch * inch);
  EXPECT_DOUBLE_EQ((dimension::torque * dimension::angle.power(-1)).unit(units), pound_force * inch / degree);
}

TEST(Dimension, NamesItsUnit) {
  const Units units{"mm", "kN", "g", "deg", 1e-3, 1e3, 1e-3, degree};
  EXPECT_EQ(dimension::none.unit_name(units), "");
  EXPECT_EQ(dimension::inertia.unit_name(units), "g mm²");
  EXPECT_EQ(dimension::acceleration.unit_name(units), "mm/s²");
  EXPECT_EQ(dimension::time.power(-1).unit_name(units), "1/s");
  EXPECT_EQ((dimension::torque * dimension::angle.power(-3)).unit_name(units), "kN mm/deg³");
  const Scene scene = everything();
  const auto name = [&](std::string_view path) { return parameter(scene, path).dimension.unit_name(units); };
  const auto ends = [&](std::string_view table, std::string_view number) {
    for (const ParameterRow& row : parameter_table(scene)) {
      if (row.path.parts[0] == table && row.path.parts[3] == number) return row.dimension.unit_name(units);
    }
    return std::string("none");
  };
  EXPECT_EQ(name("gravity.x"), "mm/s²");
  EXPECT_EQ(ends("spring", "stiffness"), "kN/mm");
  EXPECT_EQ(ends("torsion_spring", "stiffness"), "kN mm/deg");
  EXPECT_EQ(ends("damper", "coefficient"), "kN s/mm");
  EXPECT_EQ(ends("torsion_damper", "coefficient"), "kN mm s/deg");
  EXPECT_EQ(ends("friction", "width"), "deg/s");
}

TEST(Dimension, IsMeasuredInScales) {
  const Scales scales{4.0, 256.0};
  EXPECT_EQ(dimension::angle.per_scale(scales), 1.0);
  EXPECT_EQ(dimension::length.per_scale(scales), 1.0 / 4);
  EXPECT_EQ(dimension::force.per_scale(scales), 1.0 / 256);
  EXPECT_EQ(dimension::torque.per_scale(scales), 1.0 / 1024);
  // A weight, mass times acceleration, is a force; time stays in seconds.
  EXPECT_EQ(dimension::mass.per_scale(scales) * dimension::length.per_scale(scales),
            dimension::force.per_scale(scales));
  EXPECT_EQ(dimension::inertia.per_scale(scales), dimension::torque.per_scale(scales)) << "times rad/s^2";
}

TEST(Parameters, HaveAPathOfTheirOwn) {
  const Scene scene = everything();
  const std::vector<std::string> paths = paths_of(scene);
  EXPECT_EQ(std::set<std::string>(paths.begin(), paths.end()).size(), paths.size());
  for (const ParameterRow& row : parameter_table(scene)) {
    SCOPED_TRACE(row.path.text());
    EXPECT_TRUE(row.path.is(row.path.text()));
    EXPECT_FALSE(row.path.is(row.path.text() + "."));
    EXPECT_FALSE(row.path.is(row.path.text().substr(1)));
    EXPECT_EQ(parameter(scene, row.path.text()).place, row.place);
    EXPECT_EQ(find_parameter(scene, row.path.text()).value().place, row.place);
  }
  EXPECT_FALSE(find_parameter(scene, "spring.line").has_value());
  EXPECT_THROW(parameter(scene, "spring.line"), InputError);
}

// What the documentation of set_value() says, kind by kind.
TEST(Parameters, AreThoseOfTheScene) {
  const double moment = pound_force * inch;
  std::map<std::string, double> expected{
      {"gravity.x", inch},
      {"gravity.y", inch},
      {"load.P", pound_force},
      {"load.T", moment},
      {"spring.line.stiffness", pound_force / inch},
      {"spring.line.free_length", inch},
      {"spring.turn.stiffness", moment / degree},
      {"spring.turn.free_angle", degree},
      {"spring.guide.stiffness", pound_force / inch},
      {"spring.guide.free_length", inch},
      {"spring.beside.stiffness", pound_force / inch},
      {"spring.beside.free_length", inch},
      {"spring.gears.stiffness", moment / degree},
      {"spring.gears.free_angle", degree},
      {"spring.tackle.stiffness", pound_force / inch},
      {"spring.tackle.free_length", inch},
      {"torsion_spring.coil.stiffness", moment / degree},
      {"torsion_spring.coil.free_angle", degree},
      {"constant_force.weight.force", pound_force},
      {"constant_force.clockwork.torque", moment},
      {"damper.oil.coefficient", pound_force / inch},
      {"damper.rotary.coefficient", moment / degree},
      {"torsion_damper.grease.coefficient", moment / degree},
      {"friction.dry.torque", moment},
      {"friction.dry.width", degree},
      {"friction.rub.force", pound_force},
      {"friction.rub.width", inch},
      {"slide.ram.angle", degree},
      {"weld.joined.angle", degree},
      {"bar.tie.length", inch},
      {"stop.sweep.min", degree},
      {"stop.sweep.max", degree},
      {"stop.ceiling.min", inch},
      {"stop.ceiling.max", inch},
      {"start.ram", inch},
      {"start.slot", inch},
  };
  for (const std::string point : {"ground.O", "ground.S", "crank.O", "crank.B", "block.C", "block.D", "arm.1.E"}) {
    for (const std::string axis : {".x", ".y"}) expected["point." + point + axis] = inch;
  }
  for (const std::string body : {"crank", "block", "arm.1"}) {
    expected["body." + body + ".mass"] = pound;
    expected["body." + body + ".inertia"] = pound * inch * inch;
    expected["start." + body] = degree;
    for (const std::string axis : {".x", ".y"}) {
      expected["body." + body + ".center" + axis] = inch;
      expected["start." + body + axis] = inch;
    }
  }
  for (const auto& [drive, unit] : std::map<std::string, double>{{"motor", degree}, {"feed", inch}}) {
    for (const char* key : {"start", "rate", "acceleration", "amplitude"}) {
      expected["drive." + drive + "." + key] = unit;
    }
    expected["drive." + drive + ".frequency"] = 1.0;
    expected["drive." + drive + ".phase"] = degree;
  }
  const Scene scene = everything();
  std::vector<std::string> paths = paths_of(scene);
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> known;
  for (const auto& [path, unit] : expected) {
    known.push_back(path);
    EXPECT_NEAR(value_unit(scene, path), unit, 1e-15 * unit) << path;
  }
  EXPECT_EQ(paths, known);
}

TEST(Parameters, HoldEveryNumberOfEveryElement) {
  const Scene scene = everything();
  const std::vector<ParameterRow> rows = parameter_table(scene);
  for (int i = 0; i < static_cast<int>(scene.elements.size()); ++i) {
    const Element& element = scene.elements[i];
    const int numbers = static_cast<int>(numbers_of(element.law).size());
    ASSERT_GT(numbers, 0);
    for (int k = 0; k < numbers; ++k) {
      EXPECT_EQ(std::count_if(rows.begin(), rows.end(),
                              [&](const ParameterRow& row) {
                                return row.place == ParameterPlace{Owner::element, i, 0, k};
                              }),
                1)
          << element.family() << " \"" << element.name << "\", number " << k;
    }
  }
}

TEST(Parameters, AreReadBackAtTheirPathAndPlace) {
  Scene scene = everything();
  const std::vector<ParameterRow> rows = parameter_table(scene);
  // Grows along the table, so that no limit of a stop passes the other.
  const auto value = [](std::size_t row) { return 0.75 + 0.0625 * static_cast<double>(row); };
  ASSERT_LT(value(rows.size()), 200.0) << "the stops' upper limits";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::string path = rows[r].path.text();
    set_value(scene, path, value(r));
    EXPECT_DOUBLE_EQ(get_value(scene, path), value(r)) << path;
  }
  // None of them shares its place with another.
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::string path = rows[r].path.text();
    EXPECT_DOUBLE_EQ(get_value(scene, path), value(r)) << path;
    EXPECT_DOUBLE_EQ(value_at(scene, rows[r].place).value(), value(r) * value_unit(scene, path)) << path;
    EXPECT_EQ(rows[r].dimension.unit(scene.units), value_unit(scene, path)) << path;
    const double between = value(r) + 0.03125;
    set_value_at(scene, rows[r].place, between * value_unit(scene, path));
    EXPECT_DOUBLE_EQ(get_value(scene, path), between) << path;
    set_value_at(scene, rows[r].place, value(r) * value_unit(scene, path));
  }
}

TEST(Parameters, TakeTheValuesOfTheirRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Scene scene = everything();
  for (const ParameterRow& row : parameter_table(scene)) {
    SCOPED_TRACE(row.path.text());
    const auto is_taken = [&](double value) {
      Scene other = scene;
      try {
        set_value(other, row.path.text(), value);
        return true;
      } catch (const InputError&) {
        return false;
      }
    };
    EXPECT_FALSE(is_taken(nan));
    EXPECT_TRUE(is_taken(0.5));
    EXPECT_EQ(is_taken(0.0), row.range != Range::positive);
    EXPECT_EQ(is_taken(-0.5), row.range == Range::finite);
  }
  // Travels, coordinates, angles and sums of them have either sign; only a distance has not.
  EXPECT_EQ(parameter(scene, "spring.line.free_length").range, Range::not_negative);
  for (const char* path : {"spring.guide.free_length", "spring.beside.free_length", "spring.turn.free_angle",
                           "spring.tackle.free_length", "constant_force.weight.force", "stop.ceiling.max"}) {
    EXPECT_EQ(parameter(scene, path).range, Range::finite) << path;
  }
}

TEST(Parameters, ThatTheSceneLacks) {
  Scene scene = everything();
  EXPECT_FALSE(value_at(scene, parameter(scene, "start.block").place).has_value());
  EXPECT_FALSE(value_at(scene, parameter(scene, "start.crank.x").place).has_value());
  EXPECT_FALSE(value_at(scene, parameter(scene, "drive.feed.start").place).has_value());
  EXPECT_EQ(get_value(scene, "start.crank.x"), 0.0);
  EXPECT_DOUBLE_EQ(get_value(scene, "start.block.x"), 10.0);
  EXPECT_DOUBLE_EQ(get_value(scene, "start.block.y"), 1.0);
  set_value(scene, "start.crank.y", 3.0);
  EXPECT_EQ(scene.start.position[1].value(), (Vec2{0.0, 3.0 * inch}));
}

TEST(Parameters, AreScaledExactly) {
  const Scene scene = everything();
  const Scales scales{0.03125, 4096.0};
  const Scene small = scaled(scene, scales);
  const Scene back = scaled(small, {1 / scales.length, 1 / scales.force});
  for (const ParameterRow& row : parameter_table(scene)) {
    SCOPED_TRACE(row.path.text());
    const std::optional<double> before = value_at(scene, row.place);
    const std::optional<double> after = value_at(small, row.place);
    ASSERT_EQ(before.has_value(), after.has_value());
    EXPECT_EQ(value_at(back, row.place), before);
    if (!before) continue;
    EXPECT_EQ(after.value(), before.value() * row.dimension.per_scale(scales));
    int exponent = 0;
    EXPECT_EQ(std::frexp(row.dimension.per_scale(scales), &exponent), 0.5) << "a power of two";
  }
  // What has no number of its own stays.
  EXPECT_EQ(small.joints[1].axis, scene.joints[1].axis);
  EXPECT_EQ(small.units.length, scene.units.length);
}

TEST(Parameters, OfElementsScaleWithWhatTheyActOn) {
  const Scene scene = everything();
  const Scales scales{4.0, 256.0};
  const Scene small = scaled(scene, scales);
  const auto ratio = [&](const char* path) { return get_value(small, path) / get_value(scene, path); };
  for (const char* name : {"line", "guide", "beside", "tackle"}) {
    EXPECT_EQ(ratio(("spring." + std::string(name) + ".stiffness").c_str()), 4.0 / 256) << name;
    EXPECT_EQ(ratio(("spring." + std::string(name) + ".free_length").c_str()), 1.0 / 4) << name;
  }
  for (const char* name : {"turn", "gears"}) {
    EXPECT_EQ(ratio(("spring." + std::string(name) + ".stiffness").c_str()), 1.0 / 1024) << name;
    EXPECT_EQ(ratio(("spring." + std::string(name) + ".free_angle").c_str()), 1.0) << name;
  }
  EXPECT_EQ(ratio("constant_force.weight.force"), 1.0 / 256);
  EXPECT_EQ(ratio("constant_force.clockwork.torque"), 1.0 / 1024);
  EXPECT_EQ(ratio("damper.oil.coefficient"), 4.0 / 256);
  EXPECT_EQ(ratio("damper.rotary.coefficient"), 1.0 / 1024);
  EXPECT_EQ(ratio("friction.rub.force"), 1.0 / 256);
  EXPECT_EQ(ratio("friction.rub.width"), 1.0 / 4);
  EXPECT_EQ(ratio("friction.dry.torque"), 1.0 / 1024);
  EXPECT_EQ(ratio("friction.dry.width"), 1.0);
}

// Rows of the tables of docs/scene-files.md.
std::vector<std::string> rows_of_docs() {
  std::ifstream file(std::filesystem::path(POISE_SOURCE_DIR) / "docs" / "scene-files.md");
  std::vector<std::string> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| `")) rows.push_back(line);
  }
  return rows;
}

// The row that names the table and the key says the range of the number, and whether a file must give it.
void expect_in_docs(const std::vector<std::string>& rows, const std::string& table, std::string_view key,
                    const Number& number) {
  const auto has = [](const std::string& row, const std::string& text) { return row.find(text) != std::string::npos; };
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const std::string& r) {
    return has(r, "`" + table + ".") && has(r, "." + std::string(key) + "`");
  });
  ASSERT_NE(row, rows.end()) << table << "." << key;
  EXPECT_EQ(has(*row, "| >= 0"), number.range == Range::not_negative || number.range_of_measure) << *row;
  EXPECT_EQ(has(*row, "| > 0"), number.range == Range::positive) << *row;
  if (number.needed == Number::Needed::always) {
    EXPECT_TRUE(has(*row, "required")) << *row;
  }
}

TEST(Parameters, AreInTheDocs) {
  const std::vector<std::string> rows = rows_of_docs();
  const auto expect_law = [&]<class L>(const L&) {
    for (const LawTable& table : L::tables) {
      for (const Number& number : L::numbers) {
        const bool two_keys = !number.angle_key.empty();
        if (!table.angles_only) expect_in_docs(rows, table.key, number.key, number);
        if (two_keys) {
          Number of_angle = number;
          of_angle.range_of_measure = false;
          expect_in_docs(rows, table.key, number.angle_key, of_angle);
        } else if (table.angles_only) {
          expect_in_docs(rows, table.key, number.key, number);
        }
      }
    }
  };
  [&]<class... L>(std::type_identity<std::variant<L...>>) { (expect_law(L{}), ...); }(std::type_identity<Law>{});
  for (const Number& number : Drive::numbers) expect_in_docs(rows, "drive", number.key, number);
  for (const Number& number : Blade::numbers) expect_in_docs(rows, "blade", number.key, number);
}

}  // namespace
}  // namespace poise::parameters_test
