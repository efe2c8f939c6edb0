#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace poise::app {

/// JSON text, written piece by piece: commas are set where they are needed.
class JsonWriter {
 public:
  /// What was written so far.
  std::string take() { return std::move(text_); }

  void begin(char bracket);
  void end(char bracket) { text_ += bracket; }
  void key(std::string_view name);
  void word(std::string_view word);
  void flag(bool is);
  void integer(long long number);
  /// To six significant digits; null where it is not finite.
  void number(double value);
  /// To so many decimals, 3 at most, without zeros at the end.
  void rounded(double value, int decimals);
  /// A value that is JSON already.
  void json(std::string_view value);

  void add(std::string_view name, std::string_view value);
  void add(std::string_view name, const std::vector<double>& numbers);

 private:
  /// A comma, unless something begins here.
  void separate();

  std::string text_;
};

}  // namespace poise::app
