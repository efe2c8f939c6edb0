#include "app/results/statics/quantities.hpp"

#include <cstddef>
#include <string>

#include "app/result/numbers.hpp"

namespace poise::app {

void add_quantities(Group& group, const std::vector<SoughtQuantity>& of, const std::vector<double>& values,
                    const Units& units) {
  if (of.empty()) return;
  constexpr int digits = 6;
  std::vector<std::string> names, in_words, of_units;
  std::vector<double> in_units;
  for (std::size_t k = 0; k < of.size(); ++k) {
    names.push_back(of[k].name);
    in_units.push_back(values[k] / of[k].dimension.unit(units));
    in_words.push_back(significant(in_units.back(), digits));
    of_units.push_back(of[k].dimension.unit_name(units));
  }
  Table& table = group.table("quantities", "Quantities", Rows::list);
  table.words("name", "quantity", names);
  table.words("", "value", in_words);
  table.data("value", in_units);
  table.words("unit", "unit", of_units);
}

}  // namespace poise::app
