#include "statics/inverse/unknown_numbers.hpp"

#include "statics/model/scaled_model.hpp"

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
  for (const Row& row : rows_) is_linear_ = is_linear_ && list_->followers(row.at, list_->values()).empty();
}

std::vector<double> UnknownNumbers::at(const std::vector<double>& s) const {
  std::vector<double> p = list_->values();
  for (const Row& row : rows_) {
    p[static_cast<std::size_t>(row.at)] = row.from + s[static_cast<std::size_t>(row.range)] * (row.to - row.from);
  }
  if (!is_linear_) list_->follow(p);
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
