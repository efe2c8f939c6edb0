#include "statics/all_equilibria/private/turning_branch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include "statics/all_equilibria/private/merged_mechanism.hpp"
#include "statics/all_equilibria/private/written_branch.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

constexpr double same_rate = 1e-7;     // of coordinates that are taken to turn together
constexpr double same_turn = 1e-6;     // rad, of the start from the branch
constexpr double of_angles = 0x1p-49;  // relative rounding of angles of a closed pose

using Ratio = Planar<Rational>;

Interval enclosing(const Rational& r) {
  const auto near = static_cast<double>(r);
  if (Rational(near) == r) return {near};
  const double infinity = std::numeric_limits<double>::infinity();
  return {std::nextafter(std::nextafter(near, -infinity), -infinity),
          std::nextafter(std::nextafter(near, infinity), infinity)};
}

template <class T>
Planar<T> over(const Planar<T>& a, const Planar<T>& b) {
  const T square = dot(b, b);
  const Planar<T> c = a * conj(b);
  return {c.x / square, c.y / square};
}

// The gaps of all loops; null where T cannot hold them, or a travel changes one.
template <class T, class Numbers>
std::optional<std::vector<std::vector<PlaceTerm<T>>>> gaps_in(const Scene& scene, const Layout& layout,
                                                              const Numbers& numbers) {
  EnergyMerger<T, Numbers> merger(scene, layout, numbers);
  std::vector<std::vector<PlaceTerm<T>>> out;
  for (const Closure& closure : layout.closures) {
    auto gap = merger.gap(closure);
    if (!gap || std::any_of(gap->begin(), gap->end(), [](const auto& term) { return term.length >= 0; })) {
      return std::nullopt;
    }
    out.push_back(std::move(*gap));
  }
  return out;
}

class BranchSearch {
 public:
  BranchSearch(const StaticModel& model, const std::vector<double>& x, double part)
      : model_(model), x_(x), part_(part), n_(static_cast<std::size_t>(model.mechanism().coordinates())) {}

  std::optional<WrittenBranch> run() {
    if (!are_pins() || !group()) return std::nullopt;
    const Scene scaled = model_.scaled_scene();
    if (is_written_in_numbers(model_.scene())) {
      const WrittenNumbers numbers(model_);
      if (const auto loops = gaps_in<Rational>(scaled, model_.layout(), numbers)) find_turns(*loops);
    }
    TurningBranch& branch = out_.branch;
    const solvers::RoundingUp up;
    enclose_turns();
    auto loops = gaps_in<Interval>(scaled, model_.layout(), IntervalNumbers{model_.layout(), part_});
    if (!loops) return std::nullopt;
    branch.loops = std::move(*loops);
    if (!out_.turn && !bound_gaps()) return std::nullopt;
    return std::move(out_);
  }

 private:
  bool are_pins() const {
    const Mechanism<double>& m = model_.mechanism();
    return m.closures() > 0 && std::all_of(m.blocks().begin(), m.blocks().end(), [&](const ConstraintBlock& block) {
             const Closure& closure = model_.layout().closures[static_cast<std::size_t>(block.closure)];
             return block.rows == 2 && !model_.scene().joints[static_cast<std::size_t>(closure.joint)].has_travel();
           });
  }

  // By the motions that the closures leave. False if none turns a group of a loop, or more coordinates than groups do.
  bool group() {
    const Mechanism<double>& m = model_.mechanism();
    std::vector<int> rows;
    for (const ConstraintBlock& block : m.blocks()) {
      for (int k = 0; k < block.rows; ++k) rows.push_back(block.first_row + k);
    }
    const DensePoint<double> point(m, x_, rows);
    TurningBranch& branch = out_.branch;
    branch.is_in_loop.assign(n_, 0);
    for (std::size_t e = 0; e < m.jacobian_row().size(); ++e) {
      if (std::find(rows.begin(), rows.end(), m.jacobian_row()[e]) != rows.end())
        branch.is_in_loop[static_cast<std::size_t>(m.jacobian_column()[e])] = 1;
    }
    Eigen::FullPivLU<Eigen::MatrixXd> lu(point.jacobian);
    lu.setThreshold(same_rate);
    if (lu.dimensionOfKernel() == 0) return false;
    const Eigen::MatrixXd motions = lu.kernel();
    const auto rate = [&](std::size_t i) { return motions.row(static_cast<Eigen::Index>(i)); };
    branch.leader.resize(n_);
    Eigen::Index groups = 0;
    Eigen::Index others = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      branch.leader[i] = static_cast<int>(i);
      if (branch.is_in_loop[i] == 0) {
        ++others;
        continue;
      }
      if (model_.layout().is_length(static_cast<int>(i))) return false;
      if (rate(i).norm() < same_rate) {
        branch.leader[i] = -1;
        continue;
      }
      for (std::size_t j = 0; j < i && branch.leader[i] == static_cast<int>(i); ++j) {
        if (branch.is_in_loop[j] != 0 && (rate(i) - rate(j)).norm() < same_rate) branch.leader[i] = branch.leader[j];
      }
      if (branch.leader[i] == static_cast<int>(i)) ++groups;
    }
    return groups > 0 && groups + others == motions.cols();
  }

  int leader(int frame) const { return frame < 0 ? -1 : out_.branch.leader[static_cast<std::size_t>(frame)]; }

  // How far it is from its leader at x.
  double apart(std::size_t i) const {
    const int first = out_.branch.leader[i];
    return first < 0 ? x_[i] : x_[i] - x_[static_cast<std::size_t>(first)];
  }

  // In rational numbers: of two of a group in a loop the one gives the other. Nothing is known where a group is open.
  void find_turns(const std::vector<std::vector<PlaceTerm<Rational>>>& loops) {
    std::vector<std::optional<Ratio>> turn(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      if (out_.branch.leader[i] == static_cast<int>(i)) turn[i] = Ratio{1, 0};
    }
    const auto of = [&](int frame) {
      return frame < 0 ? std::optional<Ratio>(Ratio{1, 0}) : turn[static_cast<std::size_t>(frame)];
    };
    // Those that are known leave of a group of a loop one, or none, which then has to be closed.
    const auto close = [&](const std::vector<PlaceTerm<Rational>>& loop, int group, bool& more) {
      Ratio known{0, 0};
      const PlaceTerm<Rational>* open = nullptr;
      for (const PlaceTerm<Rational>& term : loop) {
        if (leader(term.frame) != group || term.coefficient == Ratio{0, 0}) continue;
        if (const auto own = of(term.frame)) {
          known += term.coefficient * *own;
        } else if (open != nullptr) {
          return true;
        } else {
          open = &term;
        }
      }
      if (open == nullptr) return known == Ratio{0, 0};
      const Ratio own = over(-known, open->coefficient);
      if (dot(own, own) != 1) return false;
      turn[static_cast<std::size_t>(open->frame)] = own;
      more = true;
      return true;
    };
    for (bool more = true; more;) {
      more = false;
      for (const auto& loop : loops) {
        for (const PlaceTerm<Rational>& term : loop) {
          if (!close(loop, leader(term.frame), more)) return;
        }
      }
      // By right angles where several are open.
      for (std::size_t i = 0; i < n_ && !more; ++i) {
        const double quarters = std::round(apart(i) / (M_PI / 2));
        if (turn[i] || std::abs(apart(i) - quarters * (M_PI / 2)) > same_turn) continue;
        const int quarter = static_cast<int>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
        turn[i] = quarter == 0 ? Ratio{1, 0} : quarter == 1 ? Ratio{0, 1} : quarter == 2 ? Ratio{-1, 0} : Ratio{0, -1};
        more = true;
      }
    }
    std::vector<Ratio> all;
    for (std::size_t i = 0; i < n_; ++i) {
      if (!turn[i]) return;
      const auto x = static_cast<double>(turn[i]->x);
      const auto y = static_cast<double>(turn[i]->y);
      if (!(std::abs(std::remainder(std::atan2(y, x) - apart(i), 2 * M_PI)) < same_turn)) return;
      all.push_back(*turn[i]);
    }
    out_.turn = std::move(all);
  }

  void enclose_turns() {
    TurningBranch& branch = out_.branch;
    branch.apart.assign(n_, Interval(0));
    branch.turn.assign(n_, {Interval(1), Interval(0)});
    for (std::size_t i = 0; i < n_; ++i) {
      const int first = branch.leader[i];
      if (first == static_cast<int>(i)) continue;
      if (out_.turn) {
        const Ratio& exact = (*out_.turn)[i];
        branch.turn[i] = {enclosing(exact.x), enclosing(exact.y)};
        branch.apart[i] = solvers::angle_of(branch.turn[i].x, branch.turn[i].y, apart(i));
      } else {
        const Interval relative(-of_angles, of_angles);
        const Interval other = first < 0 ? Interval(0) : Interval(x_[static_cast<std::size_t>(first)]);
        branch.apart[i] = Interval(x_[i]) - other + relative * (Interval(1) + abs(Interval(x_[i])) + abs(other));
        branch.turn[i] = unit(branch.apart[i]);
      }
    }
  }

  // False if the gap of a group is further from zero than rounding.
  bool bound_gaps() {
    TurningBranch& branch = out_.branch;
    for (const TurningBranch::Loop& loop : branch.loops) {
      std::vector<Planar<Interval>> sum(n_ + 1, {Interval(0), Interval(0)});
      for (const PlaceTerm<Interval>& term : loop) {
        const Planar<Interval> turned =
            term.frame < 0 ? term.coefficient : term.coefficient * branch.turn[static_cast<std::size_t>(term.frame)];
        sum[static_cast<std::size_t>(leader(term.frame) + 1)] += turned;
      }
      Interval gap(0);
      for (const Planar<Interval>& one : sum) {
        if (one.x.excludes_zero() || one.y.excludes_zero()) return false;
        gap += Interval(norm(one).upper());
      }
      branch.gap = std::max(branch.gap, gap.upper());
    }
    return true;
  }

  const StaticModel& model_;
  const std::vector<double>& x_;
  const double part_;
  const std::size_t n_;
  WrittenBranch out_;
};

}  // namespace

bool TurningBranch::contains(const std::vector<double>& x, double by) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int first = leader[i];
    if (first == static_cast<int>(i)) continue;
    const double from = first < 0 ? 0.0 : x[static_cast<std::size_t>(first)];
    if (!(std::abs(std::remainder(x[i] - from - apart[i].middle(), 2 * M_PI)) <= by)) return false;
  }
  return true;
}

std::optional<WrittenBranch> turning_branch(const StaticModel& model, const std::vector<double>& x, double part) {
  return BranchSearch(model, x, part).run();
}

}  // namespace poise
