#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "model/number_list.hpp"
#include "model/scales.hpp"
#include "statics/model/varied_scene.hpp"

namespace poise {

/// The numbers p of a scene, in scaled units, some of which are sought: each of these is  from + s (to - from)  at the
/// part s of its range.
class UnknownNumbers {
 public:
  /// `scene` has all other numbers; each range is of a VariedScene of it, or of one that differs in the other sought
  /// numbers only.
  UnknownNumbers(const Scene& scene, const Scales& scales, const std::vector<const VariedScene*>& ranges);

  int count() const { return static_cast<int>(ranges_); }
  const Scales& scales() const { return scales_; }
  const std::shared_ptr<const NumberList>& list() const { return list_; }
  /// p at the parts s, with all that follows from the numbers.
  std::vector<double> at(const std::vector<double>& s) const;
  /// dp / ds of each part where p is at(s): places in p, and derivatives.
  using Slopes = std::vector<std::vector<std::pair<int, double>>>;
  Slopes slopes(const std::vector<double>& p) const;
  /// All that statics uses and that follows from a sought number does so by expressions of named numbers.
  bool is_enclosed() const { return is_enclosed_; }
  /// p at parts that are sets of numbers, which contains the numbers at all of their members. Needs is_enclosed().
  template <class Set>
  std::vector<Set> enclosed(const std::vector<Set>& s) const {
    std::vector<Set> p, named;
    for (const double value : list_->values()) p.push_back(Set(value));
    for (const double value : named_) named.push_back(Set(value));
    const auto value_of = [&](const Row& row) {
      return Set(row.from) + (Set(row.to) - Set(row.from)) * s[static_cast<std::size_t>(row.range)];
    };
    for (const Row& row : rows_) {
      if (row.named >= 0) named[static_cast<std::size_t>(row.named)] = value_of(row);
    }
    list_->follow_in(std::move(named), p.data());
    for (const Row& row : rows_) p[static_cast<std::size_t>(row.at)] = value_of(row);
    return p;
  }

 private:
  struct Row {
    int at = 0, range = 0;
    double from = 0.0, to = 0.0;
    int named = -1;  // index of Scene::named_values
  };
  bool may_be_enclosed() const;

  std::size_t ranges_;
  Scales scales_;
  std::shared_ptr<const NumberList> list_;
  std::vector<Row> rows_;
  std::vector<double> named_;
  bool is_enclosed_ = true;
};

}  // namespace poise
