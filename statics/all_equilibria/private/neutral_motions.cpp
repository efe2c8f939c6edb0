#include "statics/all_equilibria/private/neutral_motions.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "statics/all_equilibria/private/merged_mechanism.hpp"
#include "statics/all_equilibria/private/written_branch.hpp"

namespace poise {
namespace {

constexpr double off_the_branch = 1e-6;  // rad

bool may_vanish(const Planar<Interval>& w) { return !w.x.excludes_zero() && !w.y.excludes_zero(); }
bool is_nothing(const Planar<Interval>& w) { return w.x == Interval(0) && w.y == Interval(0); }

// Coordinates, and the ground behind them, in groups that forces tie together.
class Ties {
 public:
  explicit Ties(int coordinates) : first_(static_cast<std::size_t>(coordinates) + 1) {
    std::iota(first_.begin(), first_.end(), 0);
  }
  int ground() const { return static_cast<int>(first_.size()) - 1; }
  int group(int i) const {
    while (first_[static_cast<std::size_t>(i)] != i) i = first_[static_cast<std::size_t>(i)];
    return i;
  }
  void tie(int i, int j) { first_[static_cast<std::size_t>(group(i))] = group(j); }
  bool is_tied(int i) const { return group(i) == group(ground()); }

 private:
  std::vector<int> first_;
};

// What holds a coordinate; none where no measure is it.
std::optional<Measure> measure_of(const StaticModel& model, int coordinate) {
  const Layout& layout = model.layout();
  for (std::size_t j = 0; j < layout.travel.size(); ++j) {
    if (layout.travel[j] == coordinate) return Measure::travel_of(static_cast<int>(j));
  }
  for (std::size_t b = 1; b < model.scene().bodies.size(); ++b) {
    if (layout.links[b].frame == coordinate && layout.links[b].turn == 0)
      return Measure::angle_between(0, static_cast<int>(b));
  }
  return std::nullopt;
}

// The energy of poses of a branch, by the first coordinates of its groups.
template <class T>
MergedEnergy<T> of_groups(const MergedEnergy<T>& all, const std::vector<int>& leader,
                          const std::vector<Planar<T>>& turn) {
  MergedEnergy<T> out;
  for (auto p : all.products) {
    if (p.f >= 0) {
      p.w = p.w * conj(turn[static_cast<std::size_t>(p.f)]);
      p.f = leader[static_cast<std::size_t>(p.f)];
    }
    if (p.g >= 0) {
      p.w = p.w * turn[static_cast<std::size_t>(p.g)];
      p.g = leader[static_cast<std::size_t>(p.g)];
    }
    out.add(std::move(p));
  }
  return out;
}

// A number of a file rounds once when it is read, its unit and their product in others than SI; expressions round in
// every operation.
double rounding_of(const StaticModel& model) {
  const Units& units = model.scene().units;
  const bool is_si = units.length == 1.0 && units.force == 1.0 && units.mass == 1.0;
  return half_unit * (!is_written_in_numbers(model.scene()) ? 16.0 : is_si ? 1.0 : 4.0);
}

class NeutralSearch {
 public:
  // On a branch, or, where that is null, without what closes loops.
  NeutralSearch(const StaticModel& model, const std::vector<double>& start, const WrittenBranch* branch)
      : model_(model), start_(start), branch_(branch), n_(model.mechanism().coordinates()), ties_(n_) {}

  NeutralMotions run() {
    NeutralMotions out;
    const std::optional<MergedEnergy<Rational>> exact = energy_as_written();
    {
      const solvers::RoundingUp up;
      const IntervalNumbers numbers{model_.layout(), rounding_of(model_)};
      auto merged = EnergyMerger<Interval, IntervalNumbers>(model_.scaled_scene(), model_.layout(), numbers).run();
      if (!merged) return out;
      products_ =
          branch_ ? of_groups(*merged, branch_->branch.leader, branch_->branch.turn).products : merged->products;
      if (branch_) out.products = std::move(merged->products);
      for (std::size_t p = 0; p < products_.size(); ++p) {
        const bool is_zero = exact && exact->products[p].w == Planar<Rational>{0, 0};
        vanishes_.push_back(vanishes(products_[p], is_zero));
        is_exact_.push_back(is_zero);
      }
    }
    tie_groups();
    tie_products();
    tie_everything_else();
    for (int i = 0; i < n_; ++i) {
      if (ties_.is_tied(i) || ties_.group(i) != i) continue;
      if (std::optional<NeutralMotions::Motion> motion = motion_of(i)) out.motions.push_back(std::move(*motion));
    }
    return out;
  }

 private:
  std::optional<MergedEnergy<Rational>> energy_as_written() const {
    if (!is_written_in_numbers(model_.scene()) || (branch_ && !branch_->turn)) return std::nullopt;
    const WrittenNumbers numbers(model_);
    auto out = EnergyMerger<Rational, WrittenNumbers>(model_.scaled_scene(), model_.layout(), numbers).run();
    if (out && branch_) return of_groups(*out, branch_->branch.leader, *branch_->turn);
    return out;
  }

  // Lengths have no bounds, so that of their factors a rounding is no zero.
  static bool vanishes(const MergedEnergy<Interval>::Product& p, bool is_zero) {
    return is_nothing(p.w) || (may_vanish(p.w) && (is_zero || (p.a < 0 && p.b < 0)));
  }

  void tie_groups() {
    for (int i = 0; branch_ && i < n_; ++i) {
      const int leader = branch_->branch.leader[static_cast<std::size_t>(i)];
      ties_.tie(i, leader < 0 ? ties_.ground() : leader);
    }
  }

  void tie_products() {
    const auto node = [&](int frame) { return frame < 0 ? ties_.ground() : frame; };
    for (std::size_t k = 0; k < products_.size(); ++k) {
      const auto& p = products_[k];
      if (vanishes_[k]) continue;
      ties_.tie(node(p.f), node(p.g));
      for (const int length : {p.a, p.b}) {
        if (length >= 0) ties_.tie(length, ties_.ground());
      }
    }
  }

  // Closures, but of loops that are closed all over the branch, stops, torques and the other force elements hold what
  // they act on.
  void tie_everything_else() {
    const Mechanism<double>& m = model_.mechanism();
    const Scene& scene = model_.scene();
    std::vector<int> support_size(static_cast<std::size_t>(m.constraints()));
    for (const int row : m.jacobian_row()) ++support_size[static_cast<std::size_t>(row)];
    for (std::size_t e = 0; e < m.jacobian_row().size(); ++e) {
      const int row = m.jacobian_row()[e];
      const int stop = row - m.equalities();
      if (branch_ && is_of_loop(row)) continue;
      const bool limits_one_angle = stop >= 0 && support_size[static_cast<std::size_t>(row)] == 1 &&
                                    scene.stops[static_cast<std::size_t>(stop)].on.kind == Measure::Kind::angle &&
                                    is_inside(stop);
      if (!limits_one_angle) ties_.tie(m.jacobian_column()[e], ties_.ground());
    }
    for (const Torque& torque : scene.torques) {
      const int frame = model_.layout().links[static_cast<std::size_t>(torque.body)].frame;
      if (torque.value != 0.0 && frame >= 0 && frame < n_) ties_.tie(frame, ties_.ground());
    }
    const Scene scaled = model_.scaled_scene();
    for (const Element& element : scaled.elements) {
      if (!stores_energy(element.law) || !idle(element.law).empty()) continue;
      if (spring_without_free_length(element) != nullptr) continue;
      const CompiledMeasure<double> on(scaled, model_.layout(), m.phasors(), element.on);
      for (const int i : on.support()) ties_.tie(i, ties_.ground());
    }
  }

  bool is_of_loop(int row) const {
    const std::vector<ConstraintBlock>& blocks = model_.mechanism().blocks();
    return std::any_of(blocks.begin(), blocks.end(), [&](const ConstraintBlock& block) {
      return row >= block.first_row && row < block.first_row + block.rows;
    });
  }

  bool is_inside(int stop) const {
    const Mechanism<double>& m = model_.mechanism();
    std::vector<Planar<double>> pose(static_cast<std::size_t>(m.pose_size()));
    std::vector<double> constraint(static_cast<std::size_t>(m.constraints()));
    m.place(start_.data(), pose.data());
    m.constraint(start_.data(), pose.data(), constraint.data());
    const double value = constraint[static_cast<std::size_t>(m.stop_row(stop))];
    return value > m.lower()[static_cast<std::size_t>(stop)] && value < m.upper()[static_cast<std::size_t>(stop)];
  }

  // Finds the motion of the group whose first coordinate is `first`.
  std::optional<NeutralMotions::Motion> motion_of(int first) const {
    NeutralMotions::Motion out;
    for (int i = 0; i < n_; ++i) {
      if (ties_.group(i) == first) out.coordinates.push_back(i);
    }
    const auto can_hold = std::find_if(out.coordinates.begin(), out.coordinates.end(),
                                       [&](int i) { return measure_of(model_, i).has_value(); });
    out.is_fixed_by_body = can_hold != out.coordinates.end();
    if (!out.is_fixed_by_body && branch_ == nullptr) return std::nullopt;
    if (out.is_fixed_by_body) std::iter_swap(out.coordinates.begin(), can_hold);
    out.fixed = out.coordinates.front();
    out.exact = true;
    const solvers::RoundingUp up;
    Interval effort(0);
    for (std::size_t k = 0; k < products_.size(); ++k) {
      const auto& p = products_[k];
      const auto is_in = [&](int i) { return i >= 0 && ties_.group(i) == first; };
      if (is_in(p.f) == is_in(p.g) && !is_in(p.a) && !is_in(p.b)) continue;
      if (is_nothing(p.w) || is_exact_[k]) continue;
      out.exact = false;
      effort += Interval(norm(p.w).upper());
    }
    const double unit = model_.layout().is_length(out.fixed) ? model_.scales().force : model_.scales().energy();
    out.effort = effort.upper() * unit;
    return out;
  }

 private:
  const StaticModel& model_;
  const std::vector<double>& start_;
  const WrittenBranch* const branch_;
  const int n_;
  Ties ties_;
  std::vector<MergedEnergy<Interval>::Product> products_;
  std::vector<char> vanishes_, is_exact_;
};

// Whether every group of the branch belongs to a motion.
bool turns_all_loops(const NeutralMotions& motions) {
  const TurningBranch& branch = *motions.branch;
  std::vector<char> turns(branch.leader.size(), 0);
  for (const NeutralMotions::Motion& motion : motions.motions) {
    for (const int i : motion.coordinates) turns[static_cast<std::size_t>(i)] = 1;
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (branch.is_in_loop[i] != 0 && branch.leader[i] >= 0 && turns[i] == 0) return false;
  }
  return true;
}

bool can_be_held(const NeutralMotions& motions) {
  return std::all_of(motions.motions.begin(), motions.motions.end(),
                     [](const NeutralMotions::Motion& motion) { return motion.is_fixed_by_body; });
}

// Stops that limit one angle, which is free to be anywhere between.
bool limits_alone(const Layout& layout, const Stop& stop, int coordinate) {
  if (stop.on.kind != Measure::Kind::angle || !(stop.min < stop.max)) return false;
  const auto frame = [&](int body) { return layout.links[static_cast<std::size_t>(body)].frame; };
  return frame(stop.on.body_a) == coordinate || frame(stop.on.body_b) == coordinate;
}

}  // namespace

bool NeutralMotions::lead_everywhere(int coordinates) const {
  std::size_t count = 0;
  for (const Motion& motion : motions) count += motion.coordinates.size();
  if (branch) count += static_cast<std::size_t>(std::count(branch->leader.begin(), branch->leader.end(), -1));
  return count == static_cast<std::size_t>(coordinates);
}

bool NeutralMotions::contain(const std::vector<double>& x) const {
  return any() && (!branch || branch->contains(x, off_the_branch));
}

std::vector<double> NeutralMotions::moved_to(const std::vector<double>& at, std::vector<double> x) const {
  if (!contain(x)) return x;
  for (const Motion& motion : motions) {
    const auto fixed = static_cast<std::size_t>(motion.fixed);
    const double by = at[fixed] - x[fixed];
    for (const int i : motion.coordinates) x[static_cast<std::size_t>(i)] += by;
    x[fixed] = at[fixed];
  }
  return x;
}

NeutralMotions neutral_motions(const StaticModel& model, const std::vector<double>& start) {
  const int n = model.mechanism().coordinates();
  if (model.mechanism().has_follower_loads() || n == 0) return {};
  if (std::optional<WrittenBranch> branch = turning_branch(model, start, rounding_of(model))) {
    NeutralMotions out = NeutralSearch(model, start, &*branch).run();
    out.branch = std::move(branch->branch);
    if (turns_all_loops(out) && (can_be_held(out) || out.lead_everywhere(n))) return out;
  }
  return NeutralSearch(model, start, nullptr).run();
}

Scene with_motions_fixed(const StaticModel& model, const NeutralMotions& neutral, const std::vector<double>& x) {
  Scene scene = model.scene();
  const std::vector<double> q = model.to_si(x);
  for (const NeutralMotions::Motion& motion : neutral.motions) {
    std::erase_if(scene.stops, [&](const Stop& stop) {
      return std::any_of(motion.coordinates.begin(), motion.coordinates.end(),
                         [&](int i) { return limits_alone(model.layout(), stop, i); });
    });
    Stop& hold = scene.stops.emplace_back();
    hold.name = model.layout().coordinates[static_cast<std::size_t>(motion.fixed)].name;
    hold.on = *measure_of(model, motion.fixed);
    hold.min = hold.max = q[static_cast<std::size_t>(motion.fixed)];
  }
  return scene;
}

}  // namespace poise
