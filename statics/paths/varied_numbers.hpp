#pragma once

// All numbers of a scene of which one varies, as functions of the part of its range.

#include <cstddef>
#include <utility>
#include <vector>

#include "model/number_list.hpp"
#include "model/numbers.hpp"
#include "statics/model/varied_scene.hpp"

namespace poise {

/// The numbers of a VariedScene in scaled units, in the order of a NumberList, for given states of its one-way springs:
/// they act both ways or not at all, and each has a stop behind all others that its free length is the lower bound of.
class VariedNumbers {
 public:
  /// `acts`: one of each of the springs `one_way`, indices of Scene::elements.
  VariedNumbers(const VariedScene& varied, const std::vector<int>& one_way, const std::vector<char>& acts);

  /// The scene, SI, with these stops and springs.
  const Scene& scene() const { return scene_; }
  /// The list has the numbers of that scene in scaled units.
  const NumberList& list() const { return list_; }
  /// It says which numbers of the list vary.
  const VaryingNumbers& varying() const { return varying_; }

  /// The numbers at the part p of the range; those of `numbers` that do not vary are those of the list from the first
  /// time on. In dual numbers with their derivatives by p, which an expression without a derivative at p has not.
  template <class T>
  void set(const T& p, std::vector<T>& numbers) const;

 private:
  struct Row {
    int at = 0;  // in the list
    double from = 0.0, to = 0.0;
    int named = -1;  // index into Scene::named_values

    VariedScene::Course course() const { return {{}, from, to}; }
  };
  struct Spring {
    int stiffness = 0, free_length = 0, limit = 0;  // places in the list
    bool acts = true;
  };

  VariedNumbers(const VariedScene& varied, Scene scene, const std::vector<int>& one_way, const std::vector<char>& acts);

  Scene scene_;
  VaryingNumbers varying_;
  NumberList list_;
  std::vector<Row> named_, rows_;
  std::vector<Spring> springs_;
};

template <class T>
void VariedNumbers::set(const T& p, std::vector<T>& numbers) const {
  if (numbers.empty()) {
    for (const double value : list_.values()) numbers.push_back(T(value));
  }
  const double part = plain_value(p);
  const T step = p - T(part);
  const auto value_of = [&](const Row& row) { return T(T(row.course().at(part)) + T(row.to - row.from) * step); };
  if (!named_.empty()) {
    std::vector<double> named = named_values(list_.scene()), slopes(named.size(), 0.0);
    for (const Row& row : named_) {
      named[static_cast<std::size_t>(row.named)] = row.course().at(part);
      slopes[static_cast<std::size_t>(row.named)] = row.to - row.from;
      numbers[static_cast<std::size_t>(row.at)] = value_of(row);
    }
    list_.follow_along(std::move(named), slopes, step, numbers.data());
  }
  for (const Row& row : rows_) numbers[static_cast<std::size_t>(row.at)] = value_of(row);
  for (const Spring& spring : springs_) {
    numbers[static_cast<std::size_t>(spring.limit)] = numbers[static_cast<std::size_t>(spring.free_length)];
    if (!spring.acts) numbers[static_cast<std::size_t>(spring.stiffness)] = T(0);
  }
}

}  // namespace poise
