#include "identification/experiment/weighting.hpp"

#include <algorithm>
#include <cmath>

namespace poise {
namespace {

constexpr double huber = 1.345;
constexpr double cauchy2 = 2.385 * 2.385;
constexpr double student = 4.0;

}  // namespace

std::string to_string(Loss loss) { return std::string(loss_words[static_cast<std::size_t>(loss)]); }

std::optional<Loss> loss_of(std::string_view word) {
  const auto found = std::find(loss_words.begin(), loss_words.end(), word);
  if (found == loss_words.end()) return std::nullopt;
  return static_cast<Loss>(found - loss_words.begin());
}

double Weighting::cost(double s) const {
  switch (loss) {
    case Loss::squares:
      break;
    case Loss::huber:
      return s <= huber * huber ? s : 2 * huber * std::sqrt(s) - huber * huber;
    case Loss::cauchy:
      return cauchy2 * std::log1p(s / cauchy2);
    case Loss::student:
      return (student + 1) * std::log1p(s / student);
  }
  return s;
}

double Weighting::weight(double s) const {
  switch (loss) {
    case Loss::squares:
      break;
    case Loss::huber:
      return s <= huber * huber ? 1.0 : huber / std::sqrt(s);
    case Loss::cauchy:
      return cauchy2 / (cauchy2 + s);
    case Loss::student:
      return (student + 1) / (student + s);
  }
  return 1.0;
}

double Weighting::psi_slope(double s) const {
  switch (loss) {
    case Loss::squares:
      break;
    case Loss::huber:
      return s <= huber * huber ? 1.0 : 0.0;
    case Loss::cauchy:
      return cauchy2 * (cauchy2 - s) / ((cauchy2 + s) * (cauchy2 + s));
    case Loss::student:
      return (student + 1) * (student - s) / ((student + s) * (student + s));
  }
  return 1.0;
}

}  // namespace poise
