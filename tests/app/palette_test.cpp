#include "app/draw/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/draw/mechanism.hpp"
#include "statics/mobility.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app {
namespace {

std::vector<Colour> all_colours() {
  std::vector<Colour> out;
  for (int i = 1; i < static_cast<int>(Colour::count); ++i) out.push_back(static_cast<Colour>(i));
  return out;
}

/// Relative luminance of "#rrggbb" by WCAG 2.
double luminance(std::string_view colour) {
  if (colour == "white") return 1.0;
  constexpr std::array<double, 3> weights = {0.2126, 0.7152, 0.0722};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double c = std::stoi(std::string(colour.substr(1 + 2 * i, 2)), nullptr, 16) / 255.0;
    sum += weights[i] * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return sum;
}

double contrast(std::string_view a, std::string_view b) {
  const auto [low, high] = std::minmax({luminance(a), luminance(b)});
  return (high + 0.05) / (low + 0.05);
}

TEST(Palette, NamesAreDifferentAndValuesAreColours) {
  const std::regex colour("#[0-9a-f]{6}|white");
  std::set<std::string> names;
  for (const Colour c : all_colours()) {
    EXPECT_TRUE(names.insert(std::string(name_of(c))).second) << name_of(c);
    EXPECT_TRUE(std::regex_match(std::string(light_value(c)), colour)) << name_of(c);
    EXPECT_TRUE(std::regex_match(std::string(dark_value(c)), colour)) << name_of(c);
  }
  EXPECT_EQ(body_colour(10), Colour::body_2);
  EXPECT_EQ(curve_colour(7), Colour::curve_1);
}

TEST(Palette, JsonHasLightAndDarkOfEveryColour) {
  const nlohmann::json read = nlohmann::json::parse(palette_json());
  EXPECT_EQ(read.size(), all_colours().size());
  EXPECT_EQ(read["free-stop"], (std::vector<std::string>{"#a9b0b7", "#5e6870"}));
}

TEST(Palette, TextIsLegibleOnBothPapers) {
  constexpr double legible = 4.5;
  for (const Colour c : {ink::text, ink::dark, ink::ground, ink::load, ink::reaction, ink::drive, ink::spring,
                         ink::damper, ink::good, ink::bad, ink::doubtful}) {
    EXPECT_GE(contrast(light_value(c), light_value(ink::paper)), legible) << name_of(c);
    EXPECT_GE(contrast(dark_value(c), dark_value(ink::paper)), legible) << name_of(c);
  }
  // On white remarks, active stops and names of some curves are paler; they stand beside what they name.
  for (const Colour c : {ink::faint, ink::stop, curve_colour(0), curve_colour(1), curve_colour(2), curve_colour(3),
                         curve_colour(4), curve_colour(5), curve_colour(6)}) {
    EXPECT_GE(contrast(dark_value(c), dark_value(ink::paper)), legible) << name_of(c);
    EXPECT_GE(contrast(light_value(c), light_value(ink::paper)), 2.2) << name_of(c);
  }
}

TEST(Palette, HasEveryColourOfEveryDataset) {
  std::set<std::string> known = {"none"};
  for (const Colour c : all_colours()) known.insert(std::string(light_value(c)));
  const std::regex used("(?:fill|stroke)=\"([^\"]*)\"");
  int pictures = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::filesystem::path(app_tests::dataset("zeeman")).parent_path())) {
    if (file.path().extension() != ".toml") continue;
    std::string svg;
    try {
      const StaticModel model(read_scene(file.path()));
      svg = draw_mechanism(model.scene(), {.poses = model.poses(model.start()), .heading = "x", .confirmed = false});
    } catch (const InputError&) {
      continue;  // an experiment or a design
    }
    ++pictures;
    for (std::sregex_iterator it(svg.begin(), svg.end(), used), end; it != end; ++it) {
      EXPECT_TRUE(known.contains((*it)[1].str())) << file.path() << ": " << (*it)[1].str();
    }
  }
  EXPECT_GT(pictures, 20);
}

}  // namespace
}  // namespace poise::app
