#include "statics/all_equilibria/private/off_branch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace poise {
namespace {

constexpr double widest_turn = 3.2;          // rad, away from the branch
constexpr double nearest_told_apart = 1e-6;  // rho, where the branch closes and balances to rounding only
constexpr double most_of_direction = 10.0;   // |u|, of which one component is 1
// Scaled: more than the doubles of a scene differ from its numbers as they are written.
constexpr double of_numbers = 1e-14;

}  // namespace

OffBranch::OffBranch(const StaticModel& model, const NeutralMotions& neutral)
    : neutral_(neutral), branch_(*neutral.branch), plain_(model.mechanism()) {
  const auto n = static_cast<std::size_t>(plain_.coordinates());
  place_.assign(n, -1);
  motion_.assign(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (branch_.leader[i] == static_cast<int>(i)) continue;
    place_[i] = static_cast<int>(across_.size());
    across_.push_back(static_cast<int>(i));
  }
  const double by_rho = most_of_direction / nearest_told_apart;
  for (std::size_t k = 0; k < neutral.motions.size(); ++k) {
    const NeutralMotions::Motion& motion = neutral.motions[k];
    for (const int i : motion.coordinates) motion_[static_cast<std::size_t>(i)] = static_cast<int>(k);
    const double unit = model.layout().is_length(motion.fixed) ? model.scales().force : model.scales().energy();
    effort_slack_.push_back(motion.effort / unit * by_rho);
  }
  slack_ = branch_.gap * by_rho;
  loop_of_row_.assign(static_cast<std::size_t>(plain_.constraints()), -1);
  part_.assign(loop_of_row_.size(), 0);
  for (const ConstraintBlock& block : plain_.blocks()) {
    for (int k = 0; k < block.rows; ++k) {
      loop_of_row_[static_cast<std::size_t>(block.first_row + k)] = block.closure;
      part_[static_cast<std::size_t>(block.first_row + k)] = k;
    }
  }
}

// z, m and the columns of A. False if z is too wide.
bool OffBranch::place(const std::vector<Interval>& box) {
  const Interval half(0.5);
  z_.assign(box.size(), Interval(0));
  middle_ = box;
  for (const int i : across_) {
    const auto at = static_cast<std::size_t>(i);
    const int leader = branch_.leader[at];
    Interval on_branch = branch_.apart[at];
    if (leader >= 0) on_branch += box[static_cast<std::size_t>(leader)];
    const double turns = std::round((box[at] - on_branch).middle() / (2 * M_PI));
    on_branch += Interval(turns) * solvers::full_turn;
    z_[at] = box[at] - on_branch;
    if (!(z_[at].magnitude() < widest_turn)) return false;
    middle_[at] = half * (box[at] + on_branch);
  }
  column_.assign(branch_.loops.size() * across_.size(), {Interval(0), Interval(0)});
  for (std::size_t l = 0; l < branch_.loops.size(); ++l) {
    for (const PlaceTerm<Interval>& term : branch_.loops[l]) {
      const int column = term.frame < 0 ? -1 : place_[static_cast<std::size_t>(term.frame)];
      if (column < 0) continue;
      column_[l * across_.size() + static_cast<std::size_t>(column)] +=
          quarter_turn(term.coefficient * unit(middle_[static_cast<std::size_t>(term.frame)]));
    }
  }
  return true;
}

// Finds u, one component 1, by elimination of A with full pivoting. `none`: A u = 0 has no solution but zero.
OffBranch::Direction OffBranch::find_direction() {
  const std::size_t d = across_.size();
  const std::size_t loops = branch_.loops.size();
  IntervalMatrix a(2 * loops, d + 1);
  for (std::size_t l = 0; l < loops; ++l) {
    for (std::size_t k = 0; k < d; ++k) {
      a(2 * l, k) = column_[l * d + k].x;
      a(2 * l + 1, k) = column_[l * d + k].y;
    }
    a(2 * l, d) = a(2 * l + 1, d) = Interval(-slack_, slack_);
  }
  std::vector<char> row_done(a.rows, 0);
  std::vector<char> column_done(d, 0);
  std::vector<std::pair<std::size_t, std::size_t>> pivots;
  while (pivots.size() + 1 < d) {
    double most = 0.0;
    std::pair<std::size_t, std::size_t> pivot;
    for (std::size_t i = 0; i < a.rows; ++i) {
      for (std::size_t k = 0; k < d && row_done[i] == 0; ++k) {
        if (column_done[k] != 0 || !(a(i, k).mignitude() > most)) continue;
        most = a(i, k).mignitude();
        pivot = {i, k};
      }
    }
    if (!(most > 0.0)) return Direction::unknown;
    const auto [row, column] = pivot;
    row_done[row] = column_done[column] = 1;
    for (std::size_t i = 0; i < a.rows; ++i) {
      if (row_done[i] != 0) continue;
      const Interval factor = a(i, column) / a(row, column);
      for (std::size_t k = 0; k <= d; ++k) {
        if (k == d || column_done[k] == 0) a(i, k) -= factor * a(row, k);
      }
    }
    pivots.push_back(pivot);
  }
  const auto last =
      static_cast<std::size_t>(std::find(column_done.begin(), column_done.end(), 0) - column_done.begin());
  u_.assign(d, Interval(0));
  u_[last] = Interval(1);
  std::vector<char> is_known(d, 0);
  is_known[last] = 1;
  for (std::size_t p = pivots.size(); p-- > 0;) {
    const auto [row, column] = pivots[p];
    Interval sum = a(row, d);
    for (std::size_t k = 0; k < d; ++k) {
      if (is_known[k] != 0) sum += a(row, k) * u_[k];
    }
    u_[column] = -(sum / a(row, column));
    is_known[column] = 1;
  }
  const bool is_near =
      std::all_of(u_.begin(), u_.end(), [](const Interval& u) { return u.magnitude() <= most_of_direction; });
  if (slack_ > 0.0 && !is_near) return Direction::unknown;
  for (std::size_t i = 0; i < a.rows; ++i) {
    if (row_done[i] == 0 && (a(i, last) + a(i, d)).excludes_zero()) return Direction::none;
  }
  return Direction::found;
}

// F + J^T y = 0, a row for each coordinate.
void OffBranch::add_balance(const std::vector<int>& rows, const std::vector<Interval>& box,
                            MergedMechanism& mechanism) {
  const Interval open(-of_numbers, of_numbers);
  std::vector<Planar<Interval>> pose(static_cast<std::size_t>(mechanism.pose_size()));
  std::vector<Interval> force(box.size());
  std::vector<Interval> jacobian(plain_.jacobian_row().size());
  mechanism.place(box.data(), pose.data());
  mechanism.negative_force(box.data(), pose.data(), force.data());
  mechanism.jacobian(pose.data(), jacobian.data());
  for (std::size_t i = 0; i < box.size(); ++i) equations_(i, rows.size()) = force[i] + open;
  for (std::size_t e = 0; e < jacobian.size(); ++e) {
    const auto row = std::find(rows.begin(), rows.end(), plain_.jacobian_row()[e]);
    if (row == rows.end()) continue;
    equations_(static_cast<std::size_t>(plain_.jacobian_column()[e]), static_cast<std::size_t>(row - rows.begin())) +=
        jacobian[e] + open;
  }
}

// u . (F + J^T y) = 0, with  A u = 0  taken from J u where loops are.
void OffBranch::add_along_direction(const std::vector<int>& rows, std::size_t to) {
  const std::size_t d = across_.size();
  const Interval one(1);
  for (std::size_t k = 0; k < d; ++k) {
    const auto i = static_cast<std::size_t>(across_[k]);
    equations_(to, rows.size()) += u_[k] * equations_(i, rows.size());
    Planar<Interval> turned = unit(Interval(0.5) * z_[i]);
    turned.x -= one;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto row = static_cast<std::size_t>(rows[r]);
      if (loop_of_row_[row] < 0) {
        equations_(to, r) += u_[k] * equations_(i, r);
        continue;
      }
      const Planar<Interval> by = column_[static_cast<std::size_t>(loop_of_row_[row]) * d + k] * turned;
      equations_(to, r) += u_[k] * (part_[row] == 0 ? by.x : by.y);
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (loop_of_row_[static_cast<std::size_t>(rows[r])] >= 0) equations_(to, r) += Interval(-slack_, slack_);
  }
}

// B u + y . (i A_e u) = 0; nothing where a stop acts on the motion, whose force is not as small as rho.
void OffBranch::add_motion(int motion, const std::vector<int>& rows, const std::vector<Interval>& box, std::size_t to) {
  const std::size_t d = across_.size();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (loop_of_row_[static_cast<std::size_t>(rows[r])] >= 0) continue;
    for (std::size_t i = 0; i < motion_.size(); ++i) {
      if (motion_[i] == motion && !(equations_(i, r) == Interval(0))) return;
    }
  }
  const auto at = [](const auto& of, int i, auto ground) { return i < 0 ? ground : of[static_cast<std::size_t>(i)]; };
  const auto away = [&](int i) { return at(z_, i, Interval(0)); };
  Interval sum(-effort_slack_[static_cast<std::size_t>(motion)], effort_slack_[static_cast<std::size_t>(motion)]);
  for (const auto& p : neutral_.products) {
    const bool of_f = at(motion_, p.f, -1) == motion;
    const bool of_g = at(motion_, p.g, -1) == motion;
    if (of_f == of_g) continue;
    const Interval angle = at(middle_, p.g, Interval(0)) - at(middle_, p.f, Interval(0));
    Interval by = (p.w * unit(angle)).x;
    for (const int length : {p.a, p.b}) {
      if (length >= 0) by *= box[static_cast<std::size_t>(length)];
    }
    if (of_g) by = -by;
    // by (zeta_g cos(z_f / 2) - zeta_f cos(z_g / 2))
    const Interval half(0.5);
    const int g = at(place_, p.g, -1);
    const int f = at(place_, p.f, -1);
    if (g >= 0) sum += by * u_[static_cast<std::size_t>(g)] * unit(half * away(p.f)).x;
    if (f >= 0) sum -= by * u_[static_cast<std::size_t>(f)] * unit(half * away(p.g)).x;
  }
  equations_(to, rows.size()) = sum;
  for (std::size_t k = 0; k < d; ++k) {
    if (motion_[static_cast<std::size_t>(across_[k])] != motion) continue;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto row = static_cast<std::size_t>(rows[r]);
      if (loop_of_row_[row] < 0) continue;
      const Planar<Interval> by = quarter_turn(column_[static_cast<std::size_t>(loop_of_row_[row]) * d + k]);
      equations_(to, r) += u_[k] * (part_[row] == 0 ? by.x : by.y);
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (loop_of_row_[static_cast<std::size_t>(rows[r])] >= 0) equations_(to, r) += Interval(-slack_, slack_);
  }
}

bool OffBranch::excludes(const std::vector<Interval>& box, const std::vector<int>& rows, MergedMechanism& mechanism) {
  if (!place(box)) return false;
  const Direction direction = find_direction();
  if (direction != Direction::found) return direction == Direction::none;
  const std::size_t n = box.size();
  const std::size_t motions = neutral_.motions.size();
  equations_ = IntervalMatrix(n + 1 + motions, rows.size() + 1);
  add_balance(rows, box, mechanism);
  add_along_direction(rows, n);
  for (std::size_t k = 0; k < motions; ++k) add_motion(static_cast<int>(k), rows, box, n + 1 + k);
  std::vector<char> done;
  if (!eliminate(equations_, rows.size(), done)) return false;
  for (std::size_t i = 0; i < equations_.rows; ++i) {
    if (done[i] == 0 && equations_(i, rows.size()).excludes_zero()) return true;
  }
  return false;
}

}  // namespace poise
