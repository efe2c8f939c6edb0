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
  /// All that follows from a sought number does so affinely, which is proved, and each number from one of them at most.
  bool is_linear() const { return is_linear_; }
  /// p at parts that are sets of numbers, which contains the numbers at all of their members. Needs is_linear().
  template <class Set>
  std::vector<Set> enclosed(const std::vector<Set>& s) const {
    std::vector<Set> p;
    for (const double value : list_->values()) p.push_back(Set(value));
    for (const std::vector<Row>* rows : {&rows_, &followers_}) {
      for (const Row& row : *rows) {
        p[static_cast<std::size_t>(row.at)] =
            Set(row.from) + (Set(row.to) - Set(row.from)) * s[static_cast<std::size_t>(row.range)];
      }
    }
    return p;
  }

 private:
  void find_followers();
  struct Row {
    int at = 0, range = 0;
    double from = 0.0, to = 0.0;
  };

  std::size_t ranges_;
  Scales scales_;
  std::shared_ptr<const NumberList> list_;
  std::vector<Row> rows_;
  std::vector<Row> followers_;  // where is_linear_
  bool is_linear_ = true;
};

}  // namespace poise
