#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace poise::app {

/// A JSON document as the commands write it. Braces make objects and arrays:
///
///     Json out = {{"name", "crank"}, {"at", {1.0, 2.0}}};      {"name": "crank", "at": [1.0, 2.0]}
///     out["turns"] = true;
///
/// a list all of whose items are lists of two that begin with a text is an object, any other an array.
class Json {
 public:
  Json();  ///< null
  Json(std::nullptr_t);
  Json(bool value);
  Json(double value);  ///< written with as few digits as tell it apart; null where it is not finite
  Json(const char* text);
  Json(std::string text);
  Json(const std::vector<std::string>& texts);
  Json(const std::vector<double>& values);
  Json(std::initializer_list<Json> items);
  template <std::signed_integral T>
  Json(T value) : Json(Whole<std::int64_t>{value}) {}
  template <std::unsigned_integral T>
  Json(T value) : Json(Whole<std::uint64_t>{value}) {}
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(Json other) noexcept;
  ~Json();

  static Json array();   ///< []
  static Json object();  ///< {}

  /// The member of that name, null where there was none; of an object, or of null, which becomes one.
  Json& operator[](const std::string& name);
  bool contains(const std::string& name) const;
  /// Appends to an array, or to null, which becomes one.
  void push_back(Json item);

  /// The text, members in alphabetical order; `indent` spaces for each level, or all in one line where it is -1. What
  /// is no UTF-8 is replaced.
  std::string dump(int indent) const;

 private:
  template <class T>
  struct Whole {
    T value;
  };
  struct Value;

  explicit Json(Whole<std::int64_t> number);
  explicit Json(Whole<std::uint64_t> number);

  std::unique_ptr<Value> value_;
};

}  // namespace poise::app
