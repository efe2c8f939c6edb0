#include "identification/experiment/private/same_record.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace poise {
namespace {

std::vector<const Series*> read_in(const Record& record) {
  std::vector<const Series*> out;
  for (const Series& series : record.sensors) {
    if (!series.value.empty()) out.push_back(&series);
  }
  return out;
}

bool same_readings(const Series& a, const Series& b) {
  if (a.value != b.value) return false;
  const double spacing = (a.time.back() - a.time.front()) / static_cast<double>(a.time.size());
  return std::equal(a.time.begin(), a.time.end(), b.time.begin(),
                    [&](double s, double t) { return std::abs(s - t) <= 1e-3 * spacing; });
}

bool changes(const Series& series) {
  return std::adjacent_find(series.value.begin(), series.value.end(), std::not_equal_to<>()) != series.value.end();
}

}  // namespace

bool same_record(const Record& a, const Record& b) {
  const std::vector<const Series*> one = read_in(a);
  const std::vector<const Series*> other = read_in(b);
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](const Series* s, const Series* t) { return same_readings(*s, *t); }) &&
         std::any_of(one.begin(), one.end(), [](const Series* series) { return changes(*series); });
}

}  // namespace poise
