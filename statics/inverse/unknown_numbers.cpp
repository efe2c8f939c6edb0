#include "statics/inverse/unknown_numbers.hpp"

#include <algorithm>

#include "model/dependent_number.hpp"

namespace poise {

UnknownNumbers::UnknownNumbers(const Scene& scene, const Scales& scales, const std::vector<const VariedScene*>& ranges)
    : ranges_(ranges.size()), scales_(scales), list_(std::make_shared<const NumberList>(scaled(scene, scales))) {
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    for (const VariedScene::Course& course : ranges[k]->courses()) {
      const int row = list_->row(course.place);
      const double unit = list_->rows()[static_cast<std::size_t>(row)].dimension.per_scale(scales);
      rows_.push_back({row, static_cast<int>(k), unit * course.from, unit * course.to});
    }
  }
  find_followers();
}

void UnknownNumbers::find_followers() {
  std::vector<int> led;
  for (const Row& row : rows_) {
    const ParameterPlace& place = list_->rows()[static_cast<std::size_t>(row.at)].place;
    const auto followers = list_->followers(row.at, list_->values());
    if (followers.empty()) continue;
    // A force has its size and its components in p, and the springs of a link follow from two numbers.
    const auto is_affine = [&] {
      if (place.owner != Owner::number) return false;
      const std::vector<int> degrees = dependent_degrees(list_->scene(), place.item);
      for (std::size_t k = 0; k < degrees.size(); ++k) {
        const DependentPlace& of = (*list_->scene().dependents)[k].at;
        const bool is_special = of.of == DependentPlace::Of::force || of.place.owner == Owner::section;
        if (degrees[k] > 1 || (degrees[k] == 1 && is_special)) return false;
      }
      return true;
    };
    is_linear_ = is_linear_ && is_affine();
    if (!is_linear_) return;
    std::vector<double> s(ranges_, 0.0);
    const std::vector<double> from = at(s);
    s[static_cast<std::size_t>(row.range)] = 1.0;
    const std::vector<double> to = at(s);
    for (const auto& follower : followers) {
      const int number = follower.first;
      if (std::find(led.begin(), led.end(), number) != led.end()) is_linear_ = false;
      led.push_back(number);
      followers_.push_back(
          {number, row.range, from[static_cast<std::size_t>(number)], to[static_cast<std::size_t>(number)]});
    }
  }
}

std::vector<double> UnknownNumbers::at(const std::vector<double>& s) const {
  std::vector<double> p = list_->values();
  for (const Row& row : rows_) {
    p[static_cast<std::size_t>(row.at)] = row.from + s[static_cast<std::size_t>(row.range)] * (row.to - row.from);
  }
  list_->follow(p);
  return p;
}

UnknownNumbers::Slopes UnknownNumbers::slopes(const std::vector<double>& p) const {
  Slopes out(ranges_);
  for (const Row& row : rows_) {
    auto& by = out[static_cast<std::size_t>(row.range)];
    by.emplace_back(row.at, row.to - row.from);
    for (const auto& [place, slope] : list_->followers(row.at, p)) by.emplace_back(place, slope * (row.to - row.from));
  }
  return out;
}

}  // namespace poise
