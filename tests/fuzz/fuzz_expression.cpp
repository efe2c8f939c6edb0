// Formulas, one on each line, or in quotes behind "=", so that scene files are examples.
#include <array>
#include <limits>
#include <vector>

#include "model/expression.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using namespace poise;
  static const std::vector<std::string> names = {"a", "b", "m", "L", "share", "weight", "h"};
  std::string_view text = fuzz::text_of(bytes, count);
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (const std::size_t quote = line.find("= \""); quote != std::string_view::npos) {
      line.remove_prefix(quote + 3);
      line = line.substr(0, line.rfind('"'));
    } else if (line.empty() || line.find_first_of("#[=") != std::string_view::npos) {
      continue;
    }
    fuzz::reads([&] {
      const Expression expression(line, names);
      fuzz::expect(expression.text() == line, "another text than was read");
      for (const double at : {0.0, -1.5, 1e300, std::numeric_limits<double>::denorm_min()}) {
        std::array<double, 7> numbers{}, slopes{};
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          numbers[i] = at + 0.25 * static_cast<double>(i);
          slopes[i] = 1.0 - static_cast<double>(i);
        }
        static_cast<void>(expression.value(numbers));
        static_cast<void>(expression.slope(numbers, slopes));
      }
    });
  }
  return 0;
}
