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

#include "tests/app/run_poise.hpp"

namespace poise::app::palette_test {
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

constexpr double legible = 4.5;

TEST(Palette, ColoursOfTextAreLegibleOnBothPapers) {
  for (const Colour c : {ink::text, ink::dark, ink::ground, ink::load, ink::reaction, ink::drive, ink::spring,
                         ink::damper, ink::stop, ink::faint, ink::good, ink::bad, ink::doubtful}) {
    EXPECT_GE(contrast(light_value(c), light_value(ink::paper)), legible) << name_of(c);
    EXPECT_GE(contrast(dark_value(c), dark_value(ink::paper)), legible) << name_of(c);
  }
}

TEST(Palette, CurvesAreSeenOnBothPapers) {
  for (std::size_t i = 0; i < curve_colours; ++i) {
    const Colour c = curve_colour(i);
    EXPECT_GE(contrast(dark_value(c), dark_value(ink::paper)), legible) << name_of(c);
    EXPECT_GE(contrast(light_value(c), light_value(ink::paper)), 2.2) << name_of(c);
  }
}

/// What is found of a pattern in a text, without what surrounds its first group.
std::set<std::string> found_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) out.insert((*it)[1].str());
  return out;
}

TEST(Palette, HasEveryColourOfEveryDataset) {
  std::set<std::string> known = {"none"};
  for (const Colour c : all_colours()) known.insert(std::string(light_value(c)));
  const std::regex used("(?:fill|stroke)=\"([^\"]*)\""), of_text("<text[^>]*fill=\"([^\"]*)\"");
  const app_tests::TempFolder folder;
  int pictures = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::filesystem::path(app_tests::dataset("zeeman")).parent_path())) {
    if (file.path().extension() != ".toml") continue;
    const std::filesystem::path picture = folder.path(file.path().stem().string() + ".svg");
    app_tests::run_poise({"solve", file.path().string(), "--svg", picture.string()});
    if (!std::filesystem::exists(picture)) continue;  // an experiment or a design
    ++pictures;
    const std::string svg = app_tests::contents(picture);
    for (const std::string& colour : found_in(svg, used)) {
      EXPECT_TRUE(known.contains(colour)) << file.path() << ": " << colour;
    }
    for (const std::string& colour : found_in(svg, of_text)) {
      EXPECT_GE(contrast(colour, light_value(ink::paper)), legible) << file.path() << ": " << colour;
    }
  }
  EXPECT_GT(pictures, 20);
}

}  // namespace
}  // namespace poise::app::palette_test
