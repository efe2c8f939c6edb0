// JSON documents as text.

#include "app/json.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace poise::app {
namespace {

TEST(Json, BracesMakeObjectsAndArrays) {
  const Json document = {{"name", "crank"}, {"at", {1.0, 2.5}}, {"pair", {"a", 1}}, {"none", nullptr}};
  EXPECT_EQ(document.dump(-1), R"({"at":[1.0,2.5],"name":"crank","none":null,"pair":["a",1]})");
  EXPECT_EQ(Json({1, "two", true}).dump(-1), R"([1,"two",true])");
  EXPECT_EQ(Json({{{"k", 1}}, {{"k", 2}}}).dump(-1), R"([{"k":1},{"k":2}])");
  EXPECT_EQ(Json::array().dump(-1), "[]");
  EXPECT_EQ(Json::object().dump(-1), "{}");
}

TEST(Json, NullBecomesWhatItIsUsedAs) {
  Json object, array;
  object["b"]["c"] = 1;
  object["a"] = std::vector<std::string>{"x", "y"};
  array.push_back(std::vector<double>{0.5});
  EXPECT_EQ(object.dump(-1), R"({"a":["x","y"],"b":{"c":1}})");
  EXPECT_EQ(array.dump(-1), "[[0.5]]");
  EXPECT_TRUE(object.contains("a"));
  EXPECT_FALSE(object.contains("c"));
}

TEST(Json, CopiesAreIndependent) {
  Json one = {{"k", 1}};
  Json other = one;
  other["k"] = 2;
  EXPECT_EQ(one.dump(-1), R"({"k":1})");
  EXPECT_EQ(other.dump(-1), R"({"k":2})");
}

TEST(Json, NumbersKeepEveryDigit) {
  EXPECT_EQ(Json(0.1).dump(-1), "0.1");
  EXPECT_EQ(Json(std::nextafter(1.0, 2.0)).dump(-1), "1.0000000000000002");
  EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()).dump(-1), "18446744073709551615");
  EXPECT_EQ(Json(std::numeric_limits<std::int64_t>::min()).dump(-1), "-9223372036854775808");
  EXPECT_EQ(Json(std::nan("")).dump(-1), "null");
  EXPECT_EQ(Json(INFINITY).dump(-1), "null");
}

TEST(Json, IndentsAndReplacesWhatIsNoUtf8) {
  EXPECT_EQ(Json({{"k", {1, 2}}}).dump(2), "{\n  \"k\": [\n    1,\n    2\n  ]\n}");
  EXPECT_EQ(Json("a\"\n\xff").dump(-1), "\"a\\\"\\n\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace poise::app
