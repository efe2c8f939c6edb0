#include "statics/inverse/unknown_numbers.hpp"

#include <algorithm>

#include "model/dependent_number.hpp"

namespace poise {
namespace {

/// Forces of which a component follows from a sought number, and not their size alone is sought.
std::vector<int> forces_that_turn(const Scene& scene, const std::vector<const VariedScene*>& ranges) {
  std::vector<int> out, sized;
  for (const VariedScene* range : ranges) {
    for (const VariedScene::Course& course : range->courses()) {
      if (course.place.owner == Owner::force) sized.push_back(course.place.item);
      if (course.place.owner != Owner::number || !scene.dependents) continue;
      const std::vector<int> degrees = dependent_degrees(scene, course.place.item);
      for (std::size_t k = 0; k < degrees.size(); ++k) {
        const DependentPlace& of = (*scene.dependents)[k].at;
        if (degrees[k] > 0 && of.of == DependentPlace::Of::force) out.push_back(of.place.item);
      }
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  std::erase_if(out, [&](int force) { return std::find(sized.begin(), sized.end(), force) != sized.end(); });
  return out;
}

}  // namespace

UnknownNumbers::UnknownNumbers(const Scene& scene, const Scales& scales, const std::vector<const VariedScene*>& ranges)
    : ranges_(ranges.size()),
      scales_(scales),
      list_(std::make_shared<const NumberList>(scaled(scene, scales), forces_that_turn(scene, ranges))),
      named_(named_values(list_->scene())) {
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    for (const VariedScene::Course& course : ranges[k]->courses()) {
      const int row = list_->row(course.place);
      const double unit = list_->rows()[static_cast<std::size_t>(row)].dimension.per_scale(scales);
      const int named = course.place.owner == Owner::number ? course.place.item : -1;
      rows_.push_back({row, static_cast<int>(k), unit * course.from, unit * course.to, named});
    }
  }
  is_enclosed_ = may_be_enclosed();
}

bool UnknownNumbers::may_be_enclosed() const {
  const Scene& scene = list_->scene();
  for (const Row& row : rows_) {
    // The springs of a flexible link follow from its section.
    if (row.named < 0 && !list_->followers(row.at, list_->values()).empty()) return false;
    if (row.named < 0 || !scene.dependents) continue;
    const std::vector<int> degrees = dependent_degrees(scene, row.named);
    for (std::size_t k = 0; k < degrees.size(); ++k) {
      const DependentNumber& one = (*scene.dependents)[k];
      if (degrees[k] == 0) continue;
      const bool has_size = one.at.of == DependentPlace::Of::force && !list_->vector_of(one.at.place.item).are_whole;
      if (one.factor || one.at.place.owner == Owner::section || has_size) return false;
    }
  }
  return true;
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
