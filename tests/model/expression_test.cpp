// Expressions against closed forms, their derivatives against differences, and hostile text.
#include "model/expression.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace poise::expression_test {
namespace {

const std::vector<std::string> names{"r", "s_2"};

double value(const std::string& text, double r = 3.0, double s = 0.5) {
  return Expression(text, names).value(std::array{r, s});
}

std::string message(const std::string& text) {
  return test::message_of([&] { const Expression expression(text, names); });
}

TEST(Expression, FollowsTheUsualPrecedence) {
  EXPECT_EQ(value("2*pi*r"), 2 * std::numbers::pi * 3.0);
  EXPECT_EQ(value("1 + 2*3 - 4/8"), 6.5);
  EXPECT_EQ(value("3-2-1"), 0.0);
  EXPECT_EQ(value("8/2/2"), 2.0);
  EXPECT_EQ(value("-2^2"), -4.0);
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("2 * -r"), -6.0);
  EXPECT_EQ(value("(r)^(1+1)"), 9.0);
  EXPECT_EQ(value("1.5e3*.5 + 2.5E-1 + 1."), 751.25);
}

TEST(Expression, KnowsFunctions) {
  EXPECT_EQ(value("sqrt(r+1)"), 2.0);
  EXPECT_EQ(value("log(exp(r))"), std::log(std::exp(3.0)));
  EXPECT_EQ(value("sin(r)^2 + cos(r)^2"), std::pow(std::sin(3.0), 2.0) + std::pow(std::cos(3.0), 2.0));
  EXPECT_EQ(value("tan(s_2)"), std::tan(0.5));
  EXPECT_EQ(value("asin(s_2) + acos(s_2)"), std::asin(0.5) + std::acos(0.5));
  EXPECT_EQ(value("atan(r)"), std::atan(3.0));
  EXPECT_EQ(value("atan2(r, s_2)"), std::atan2(3.0, 0.5));
  EXPECT_EQ(value("hypot(r, 4)"), 5.0);
  EXPECT_EQ(value("min(r, s_2) + 10*max(r, s_2)"), 30.5);
  EXPECT_EQ(value("abs(-r)"), 3.0);
}

TEST(Expression, HasTheDerivativeThatDifferencesHave) {
  for (const char* text : {"2*pi*r",        "r^3 - s_2*r",        "r^s_2",
                           "s_2^r",         "1/(r + s_2)",        "sqrt(r*s_2)",
                           "exp(-r*s_2)",   "log(r/s_2)",         "sin(r*s_2)",
                           "cos(r - s_2)",  "tan(s_2)",           "asin(s_2/r)",
                           "acos(s_2/r)",   "atan(r*s_2)",        "atan2(r, s_2)",
                           "hypot(r, s_2)", "min(r, s_2)",        "max(r, s_2)",
                           "abs(s_2 - r)",  "-r^2 + (s_2 - 1)^3", "r^2/(1 + hypot(r, 2)*s_2)"}) {
    const Expression expression(text, names);
    for (const auto& along : {std::array{1.0, 0.0}, std::array{0.0, 1.0}, std::array{0.7, -1.3}}) {
      const double h = 1e-5;
      const auto at = [&](double t) { return expression.value(std::array{3.0 + t * along[0], 0.5 + t * along[1]}); };
      const double difference = (at(-2 * h) - 8 * at(-h) + 8 * at(h) - at(2 * h)) / (12 * h);
      EXPECT_NEAR(expression.slope(std::array{3.0, 0.5}, along), difference, 1e-9 * (1.0 + std::abs(difference)))
          << text;
      // Where the names rise at rates of their own too.
      const std::array bends{-0.4, 0.9};
      const auto on_the_way = [&](double t) {
        return expression.value(std::array{3.0 + t * along[0] + t * t / 2 * bends[0],  //
                                           0.5 + t * along[1] + t * t / 2 * bends[1]});
      };
      const double far = 1e-3;
      const double second = (16 * (on_the_way(-far) + on_the_way(far)) - on_the_way(-2 * far) - on_the_way(2 * far) -
                             30 * on_the_way(0.0)) /
                            (12 * far * far);
      EXPECT_NEAR(expression.bend(std::array{3.0, 0.5}, along, bends), second, 1e-7 * (1.0 + std::abs(second))) << text;
    }
  }
}

TEST(Expression, HasNoDerivativeAtKinks) {
  const auto slope = [](const std::string& text, double r, double by_r) {
    return Expression(text, names).slope(std::array{r, 0.5}, std::array{by_r, 0.0});
  };
  EXPECT_TRUE(std::isnan(slope("abs(r)", 0.0, 1.0)));
  EXPECT_TRUE(std::isnan(slope("max(r, s_2)", 0.5, 1.0)));
  EXPECT_FALSE(std::isfinite(slope("sqrt(r)", 0.0, 1.0)));
  // What does not move has none to take.
  EXPECT_EQ(slope("abs(r)", 0.0, 0.0), 0.0);
  EXPECT_EQ(slope("max(r, r)", 2.0, 1.0), 1.0);
  EXPECT_EQ(slope("r^2", 0.0, 1.0), 0.0);
  EXPECT_EQ(slope("r^1", 0.0, 1.0), 1.0);
  const auto bend = [](const std::string& text, double r) {
    return Expression(text, names).bend(std::array{r, 0.5}, std::array{1.0, 0.0}, std::array{0.0, 0.0});
  };
  EXPECT_TRUE(std::isnan(bend("abs(r)", 0.0)));
  EXPECT_EQ(bend("r^2", 0.0), 2.0);
  EXPECT_EQ(bend("r^1", 0.0), 0.0);
}

TEST(Expression, NamesWhatItUses) {
  EXPECT_EQ(Expression("s_2*(r + s_2)", names).uses(), (std::vector{0, 1}));
  EXPECT_EQ(Expression("2*pi", names).uses(), std::vector<int>{});
}

TEST(Expression, RefusesEachMistakeByItsPlace) {
  EXPECT_EQ(message(""), R"-(expected a number, a name or "(", found its end at character 1 of "")-");
  EXPECT_EQ(message("2*(3+"), R"-(expected a number, a name or "(", found its end at character 6 of "2*(3+")-");
  EXPECT_EQ(message("2 3"), R"-(expected an operator or the end, found "3" at character 3 of "2 3")-");
  EXPECT_EQ(message("(1"), R"-(expected an operator or ")", found its end at character 3 of "(1")-");
  EXPECT_EQ(message("2^3^4"), R"-(expected an operator or the end, found "^" at character 4 of "2^3^4")-");
  EXPECT_EQ(message("r+\xC3\xA9"),
            "expected a number, a name or \"(\", found \"\xC3\xA9\" at character 3 of \"r+\xC3\xA9\"");
  EXPECT_EQ(message("hypot(1)"), R"-(expected two arguments of hypot, found 1 at character 1 of "hypot(1)")-");
  EXPECT_EQ(message("sin r"), R"-(expected "(" behind sin, found none at character 1 of "sin r")-");
  EXPECT_EQ(message("sqr(2)"),
            R"-(expected a function in front of "(", found "sqr" in "sqr(2)"; did you mean "sqrt"?)-");
  EXPECT_EQ(message("s2*2"),
            R"-(expected a name of [numbers], pi or a function, found "s2" in "s2*2"; did you mean "s_2"?)-");
  EXPECT_EQ(message("1e999"), R"-(expected a number that a double can hold, found "1e999" at character 1 of "1e999")-");
}

TEST(Expression, BoundsHostileText) {
  EXPECT_EQ(message(std::string(17, '(') + "1" + std::string(17, ')')),
            "expected at most 16 brackets inside each other; close some");
  EXPECT_EQ(value(std::string(16, '(') + "1" + std::string(16, ')')), 1.0);
  std::string nested = "0";
  for (int k = 0; k < 16; ++k) nested = "1+1*2^max(0," + nested + ")";
  EXPECT_TRUE(std::isinf(value(nested)));  // as deep as values may wait for each other
  std::string sum = "r";
  while (sum.size() < 999) sum += "+r";
  EXPECT_EQ(value(sum.substr(0, 999)), 3.0 * 500);
  EXPECT_NE(message(sum + "+r").find("at most 1000 characters"), std::string::npos);
  EXPECT_EQ(message("------1").substr(0, 8), "expected");
  EXPECT_TRUE(std::isinf(value("(9^999)^999")));
}

TEST(Expression, SaysWhatMayBeAName) {
  for (const char* good : {"r", "_", "L1", "a_b"}) EXPECT_TRUE(Expression::is_name(good)) << good;
  for (const char* bad : {"", "1a", "a.b", "a b", "pi", "sin", "a-b", "\xC3\xA9"})
    EXPECT_FALSE(Expression::is_name(bad)) << bad;
}

}  // namespace
}  // namespace poise::expression_test
