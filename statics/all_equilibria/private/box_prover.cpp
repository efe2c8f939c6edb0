#include "statics/all_equilibria/private/box_prover.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "statics/all_equilibria/private/interval_matrix.hpp"

namespace poise {

namespace {

constexpr int most_sweeps = 4;
constexpr double little = 0.05;        // a sweep that narrows no interval by this share is the last one
constexpr double narrow_enough = 0.7;  // rad or sizes: widest box to which Newton's operator is applied
constexpr double too_wide_for_rows = 2.0;
constexpr double narrow_for_elements = 0.3;  // rad or sizes
constexpr int most_dyad_sweeps = 3;
constexpr double enough_for_dyads = 0.8;  // of its width before, to which a sweep narrows a dyad if another follows
constexpr int most_closing_steps = 2;     // of Newton's method
constexpr double narrow_for_dyads = 0.3;  // rad or sizes
constexpr double turning = 0.5;    // of its length by which an element may be longer whose direction a box leaves open
constexpr double stiff = 1.0;      // loads: elements whose force a box leaves open by more
constexpr double open_gap = 1e-9;  // mechanism sizes: what rounding leaves open of loops that others close
constexpr double small_pivot = 0.01;         // below, the rows that remain are taken for dependent
constexpr double narrow_for_crossing = 0.5;  // rad or sizes
constexpr double narrow_for_branch = 1.0;    // rad or sizes
// Loads: joint forces that equilibria at singular poses need which are left out, found by halving boxes, and at change
// points, where halves tell no more.
constexpr double largest_joint_force = 1e6;
constexpr double least_joint_force = 1e4;
constexpr double wide = 0.2;  // rad or sizes: pairs of a loop are solved together, and driving coordinates halved
constexpr double much_narrower = 0.01;
constexpr double much_wider = 4.0;               // the coordinates of a dyad than what they follow from
constexpr double much_narrower_by_steps = 1e-4;  // each step of shooting may widen several times

Interval squared_norm(const Planar<Interval>& a) { return square(a.x) + square(a.y); }

// Narrows the component a of a vector by its squared length and its other component to [-s, s], s the result, which is
// empty if there is no such vector.
std::optional<Interval> meet_circle(Interval& a, const Interval& other, const Interval& square_of_length) {
  const Interval left = square_of_length - square(other);
  if (left < Interval(0)) return std::nullopt;
  const Interval size = sqrt(left);
  if (!a.meet(Interval(-size.upper(), size.upper()))) return std::nullopt;
  return size;
}

// Bounds of all x with |x| <= |b| + E |x|, for a matrix E >= 0 of bounds: with weights w > 0 and E w < w the powers of
// E vanish, so that I - E has an inverse without negative entries, and u with |b| + E u <= u is at least |x|. Solutions
// of (I - E) w = 1 and (I - E) u = |b| are guesses of such vectors, which are found wherever there are any. This holds
// however much rows of E outweigh others, as those of one loop that drives the next.
class Contraction {
 public:
  // False if no weights were found.
  bool set(const Eigen::MatrixXd& e) {
    e_ = e;
    if (e_.size() == 0) return true;
    if (!e_.allFinite()) return false;
    lu_.compute(Eigen::MatrixXd::Identity(e.rows(), e.cols()) - e_);
    return is_bound(Eigen::VectorXd::Ones(e.rows()), lu_.solve(Eigen::VectorXd::Ones(e.rows())), true);
  }

  // u from |b|; false if it was not found.
  bool bound(const Eigen::VectorXd& b, Eigen::VectorXd& u) const {
    if (e_.size() == 0) return true;
    constexpr double more = 1.0 + 1e-9;
    u = more * lu_.solve(b);
    return is_bound(b, u, false);
  }

 private:
  // b + E u <= u, with rounding up; `strictly` positive u and E u < u
  bool is_bound(const Eigen::VectorXd& b, const Eigen::VectorXd& u, bool strictly) const {
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      double sum = strictly ? 0.0 : b[i];
      for (Eigen::Index j = 0; j < u.size(); ++j) sum += e_(i, j) * u[j];
      if (strictly ? !(u[i] > 0 && sum < u[i]) : !(sum <= u[i])) return false;
    }
    return true;
  }

  Eigen::MatrixXd e_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
};

// Narrows coordinates x_p of the box by  0 = sum + sum_p by_p (x_p - x'_p).  False if that has no solution.
bool meet_zero(const Interval& sum, const std::vector<Interval>& by, const std::vector<int>& columns,
               const CoordinateBox& thin, CoordinateBox& box) {
  for (std::size_t p = 0; p < columns.size(); ++p) {
    Interval rest = sum;
    for (std::size_t other = 0; other < columns.size(); ++other) {
      if (other != p) rest += by[other] * (box[columns[other]] - thin[columns[other]]);
    }
    const int own = columns[p];
    if (by[p].excludes_zero()) {
      if (!box[own].meet(thin[own] - rest / by[p])) return false;
    } else {
      rest += by[p] * (box[own] - thin[own]);
      if (rest.excludes_zero()) return false;
    }
  }
  return true;
}

}  // namespace

double widest(const CoordinateBox& box) {
  double most = 0.0;
  for (const Interval& x : box) most = std::max(most, x.width());
  return most;
}

std::vector<double> lower_corner(const CoordinateBox& box) {
  std::vector<double> out;
  for (const Interval& x : box) out.push_back(x.lower());
  return out;
}

std::vector<double> upper_corner(const CoordinateBox& box) {
  std::vector<double> out;
  for (const Interval& x : box) out.push_back(x.upper());
  return out;
}

void BoxProver::Verdict::cut(CoordinateBox& lower, CoordinateBox& upper) const {
  lower[split] = Interval(lower[split].lower(), split_at);
  upper[split] = Interval(split_at, upper[split].upper());
}

BoxProver::BoxProver(const StaticModel& model, std::vector<StopState> stops, int repeated,
                     const NeutralMotions* without_branch_of)
    : model_(model),
      plain_(model.mechanism()),
      mechanism_(model),
      stops_(std::move(stops)),
      equation_(plain_.constraints(), -1),
      n_(plain_.coordinates()),
      angles_(model.layout().angles) {
  const solvers::RoundingUp up;
  for (int r = 0; r < plain_.equalities(); ++r) {
    rows_.push_back(r);
    bounds_.push_back(0.0);
  }
  for (int s = 0; s < plain_.stops(); ++s) {
    if (stops_[s] == StopState::inactive) continue;
    rows_.push_back(plain_.stop_row(s));
    bounds_.push_back(stops_[s] == StopState::at_lower ? plain_.lower()[s] : plain_.upper()[s]);
  }
  m_ = static_cast<int>(rows_.size()) - repeated;
  for (std::size_t k = 0; k < rows_.size(); ++k) equation_[rows_[k]] = static_cast<int>(k);
  for (const ConstraintBlock& block : plain_.blocks()) {
    std::vector<Arm> arms = model.layout().closures[block.closure].arms;
    std::stable_sort(arms.begin(), arms.end(), [](const Arm& l, const Arm& r) { return l.coordinate < r.coordinate; });
    const PhasorSum<Interval> gap(mechanism_.phasors(), arms);
    Loop loop{Group{-1, gap.constant()}};
    if (repeated > 0)
      loop.front().constant += Planar<Interval>{Interval(-open_gap, open_gap), Interval(-open_gap, open_gap)};
    for (const auto& term : gap.terms()) {
      const bool is_angle = term.coordinate < angles_;
      const int frame = is_angle ? term.coordinate : mechanism_.phasors().frame(term.coordinate);
      auto group = std::find_if(loop.begin(), loop.end(), [&](const Group& g) { return g.angle == frame; });
      if (group == loop.end()) group = loop.insert(loop.end(), Group{frame});
      if (is_angle)
        group->constant += term.coefficient;
      else
        group->lengths.push_back({term.coordinate, term.coefficient});
    }
    for (Group& group : loop) group.direction = solvers::angle_of(group.constant.x, group.constant.y, 0.0);
    loops_.push_back(std::move(loop));
  }
  is_free_.assign(n_, 1);
  for (std::size_t e = 0; e < plain_.jacobian_row().size(); ++e) {
    if (equation_[plain_.jacobian_row()[e]] >= 0) is_free_[plain_.jacobian_column()[e]] = 0;
  }
  unit_.resize(angles_);
  pose_.resize(mechanism_.pose_size());
  jacobian_.resize(plain_.jacobian_row().size());
  constraint_.resize(plain_.constraints());
  force_.resize(n_);
  tangent_.resize(plain_.tangent_row().size());
  multipliers_.resize(plain_.constraints());
  dense_.resize(rows_.size() * static_cast<std::size_t>(n_));
  drives_ = driving();
  if (without_branch_of != nullptr) off_branch_.emplace(model, *without_branch_of);
  const bool are_zero = std::all_of(bounds_.begin(), bounds_.end(), [](double b) { return b == 0.0; });
  if (repeated == 0 && are_zero && 0 < m_ && m_ < n_) crossings_.emplace(model, mechanism_, rows_);
  const Scene scene = model.scaled_scene();
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& element = scene.elements[e];
    if (element.on.kind != Measure::Kind::distance || spring_without_free_length(element) != nullptr) continue;
    if (!stores_energy(element.law) || !idle(element.law).empty()) continue;
    const PointRef a = element.on.a;
    const PointRef b = element.on.b;
    distances_.push_back({static_cast<int>(e),
                          element.law,
                          {mechanism_.phasors(), model.layout().path(a.body, scene.local(a), b.body, scene.local(b))}});
  }
}

// Coordinates that all others follow from, two from each loop, and one from each equation of balance of a coordinate
// that is in no closure. Each is the one that the most follow from.
std::vector<char> BoxProver::driving() {
  struct Equation {
    std::vector<int> members;
    int row;  // of balance, or -1 of a loop
    std::size_t loop;
    int gives;                           // so many members follow from the others
    std::vector<std::size_t> entries{};  // of the stiffness
  };
  std::vector<Equation> equations;
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    std::vector<int>& of_loop = equations.emplace_back(Equation{{}, -1, l, 2}).members;
    for (const Group& group : loops_[l]) {
      if (group.angle >= 0) of_loop.push_back(group.angle);
      for (const Group::Along& along : group.lengths) of_loop.push_back(along.length);
    }
  }
  for (int i = 0; i < n_; ++i) {
    if (is_free_[i] == 0) continue;
    Equation& of_row = equations.emplace_back(Equation{{}, i, 0, 1});
    for (std::size_t e = 0; e < tangent_.size(); ++e) {
      const int row = plain_.tangent_row()[e];
      const int column = plain_.tangent_column()[e];
      if (row != i && (column != i || plain_.has_follower_loads())) continue;
      of_row.members.push_back(row == i ? column : row);
      of_row.entries.push_back(e);
    }
  }
  struct Known {
    std::vector<char> is;
    std::vector<Step> steps;
    std::vector<Dyad> dyads;
  };
  const auto follow = [&](Known known, int driver) {
    if (driver >= 0) known.is[driver] = 1;
    for (bool more = true; more;) {
      more = false;
      for (const Equation& equation : equations) {
        const auto is_open = [&](int i) { return known.is[i] == 0; };
        const auto open = std::count_if(equation.members.begin(), equation.members.end(), is_open);
        if (open == 0 || open > equation.gives) continue;
        const auto next = std::find_if(equation.members.begin(), equation.members.end(), is_open);
        if (equation.row < 0) {
          if (open == 2) {
            known.dyads.push_back({equation.loop, *next, *std::find_if(next + 1, equation.members.end(), is_open)});
          }
        } else {
          known.steps.push_back({equation.row, *next, equation.entries[next - equation.members.begin()]});
        }
        for (const int i : equation.members) known.is[i] = 1;
        more = true;
      }
    }
    return known;
  };
  const auto number_of = [](const Known& known) { return std::count(known.is.begin(), known.is.end(), 1); };
  std::vector<char> out(n_, 0);
  Known known = follow({out, {}, {}}, -1);
  while (number_of(known) < n_) {
    Known most = known;
    int driver = -1;
    for (int i = 0; i < n_; ++i) {
      if (known.is[i] != 0) continue;
      Known next = follow(known, i);
      if (driver >= 0 && number_of(next) <= number_of(most)) continue;
      most = std::move(next);
      driver = i;
    }
    out[driver] = 1;
    known = std::move(most);
  }
  steps_ = std::move(known.steps);
  dyads_ = std::move(known.dyads);
  for (int i = 0; i < n_; ++i) {
    if (out[i] != 0) drivers_.push_back(i);
  }
  for (int i = 0; i < n_; ++i) {
    const bool is_given = std::any_of(steps_.begin(), steps_.end(), [&](const Step& step) { return step.gives == i; });
    if (!is_given) parameters_.push_back(i);
    const bool is_step = std::any_of(steps_.begin(), steps_.end(), [&](const Step& step) { return step.row == i; });
    if (is_free_[i] != 0 && !is_step) open_rows_.push_back(i);
  }
  return out;
}

// --- closures -------------------------------------------------------------------------------------------------------

Planar<Interval> BoxProver::arm(const Group& group, const CoordinateBox& box) const {
  Planar<Interval> sum = group.constant;
  for (const Group::Along& along : group.lengths) sum += box[along.length] * along.direction;
  return sum;
}

Planar<Interval> BoxProver::term(const Group& group, const CoordinateBox& box) const {
  const Planar<Interval> sum = arm(group, box);
  return group.angle < 0 ? sum : sum * unit_[group.angle];
}

void BoxProver::turn(int angle, const CoordinateBox& box) { unit_[angle] = unit(box[angle]); }

bool BoxProver::narrow(CoordinateBox& box, int coordinate, const Interval& to) {
  if (coordinate < angles_) return narrow_to_any(box, coordinate, {to});
  return box[coordinate].meet(to);
}

// An angle to any of some, at all turns that the box has.
bool BoxProver::narrow_to_any(CoordinateBox& box, int angle, std::initializer_list<Interval> any) {
  Interval& x = box[angle];
  parts_.clear();
  for (const Interval& to : any) {
    if (!(to.width() < 6.0)) return true;
    const double first = std::floor((x.lower() - to.upper()) / solvers::full_turn.upper()) - 1;
    const double last = std::floor((x.upper() - to.lower()) / solvers::full_turn.upper()) + 2;
    for (double k = first; k <= last; k += 1) {
      Interval part = x;
      if (part.meet(to + Interval(k) * solvers::full_turn)) parts_.push_back(part);
    }
  }
  if (parts_.empty()) return false;
  std::sort(parts_.begin(), parts_.end(), [](const Interval& a, const Interval& b) { return a.lower() < b.lower(); });
  Interval all = parts_.front();
  for (const Interval& part : parts_) {
    if (part.lower() - all.upper() > gap_.to - gap_.from) gap_ = {angle, all.upper(), part.lower()};
    all = hull(all, part);
  }
  x.meet(all);
  turn(angle, box);
  return true;
}

// Every group is the sum of all others, with the sign turned.
bool BoxProver::contract_loop(const Loop& loop, CoordinateBox& box) {
  for (std::size_t g = 0; g < loop.size(); ++g) {
    Planar<Interval> others{};
    for (std::size_t k = 0; k < loop.size(); ++k) {
      if (k != g) others -= term(loop[k], box);
    }
    const Group& group = loop[g];
    const Planar<Interval> along = arm(group, box);
    if (group.angle < 0 && group.lengths.empty()) {
      Planar<Interval> both = others;
      if (!both.x.meet(along.x) || !both.y.meet(along.y)) return false;
      continue;
    }
    const Interval square_of_length = squared_norm(along);
    Interval length = squared_norm(others);
    if (!length.meet(square_of_length)) return false;
    if (!contract_arm(group, along, others, square_of_length, box)) return false;
    const Planar<Interval> frame = group.angle < 0 ? Planar<Interval>{Interval(1), Interval(0)} : unit_[group.angle];
    const Planar<Interval> back = others * conj(frame);
    for (const Group::Along& a : group.lengths) {
      Planar<Interval> rest = back - group.constant;
      for (const Group::Along& b : group.lengths) {
        if (b.length != a.length) rest -= box[b.length] * b.direction;
      }
      if (!narrow(box, a.length, dot(a.direction, rest) / squared_norm(a.direction))) return false;
    }
  }
  return true;
}

// An arm of known length, turned, is the sum of others, of which it leaves a vector on either side of an axis.
bool BoxProver::contract_arm(const Group& group, const Planar<Interval>& along, Planar<Interval>& others,
                             const Interval& square_of_length, CoordinateBox& box) {
  const std::optional<Interval> size_x = meet_circle(others.x, others.y, square_of_length);
  if (!size_x) return false;
  const std::optional<Interval> size_y = meet_circle(others.y, others.x, square_of_length);
  if (!size_y) return false;
  if (group.angle < 0) return true;
  const bool along_x = size_x->lower() > size_y->lower();
  Planar<Interval> sides[] = {others, others};
  bool are[2];
  for (int k = 0; k < 2; ++k) {
    const Interval& size = along_x ? *size_x : *size_y;
    are[k] = (along_x ? sides[k].x : sides[k].y).meet(k == 0 ? size : -size);
  }
  const auto angle_of = [&](const Planar<Interval>& side) {
    const Planar<Interval> turned = side * conj(along);
    return solvers::angle_of(turned.x, turned.y, box[group.angle].middle());
  };
  if (are[0] && are[1]) return narrow_to_any(box, group.angle, {angle_of(sides[0]), angle_of(sides[1])});
  if (!are[0] && !are[1]) return false;
  return narrow(box, group.angle, angle_of(sides[are[0] ? 0 : 1]));
}

// Two arms of a loop make a triangle with the sum S of the rest:  A_i e_i + A_j e_j = S, so that the angle between
// A_i e_i and S has the cosine (|S|^2 + |A_i|^2 - |A_j|^2) / (2 |A_i| |S|).
bool BoxProver::contract_pair(const Loop& loop, std::size_t i, std::size_t j, CoordinateBox& box) {
  Planar<Interval> rest{};
  for (std::size_t k = 0; k < loop.size(); ++k) {
    if (k != i && k != j) rest -= term(loop[k], box);
  }
  return contract_triangle(loop, i, j, rest, box);
}

bool BoxProver::contract_triangle(const Loop& loop, std::size_t i, std::size_t j, const Planar<Interval>& rest,
                                  CoordinateBox& box) {
  const Interval square_s = squared_norm(rest);
  if (!(square_s > Interval(0)) || !square_s.bounded()) return true;
  const Planar<Interval> arm_i = arm(loop[i], box);
  const Planar<Interval> arm_j = arm(loop[j], box);
  const Interval square_i = squared_norm(arm_i);
  const Interval square_j = squared_norm(arm_j);
  if (!(square_i > Interval(0)) || !(square_j > Interval(0))) return true;
  const Interval s = sqrt(square_s);
  const Interval direction = solvers::angle_of(rest.x, rest.y, 0.0);
  if (!direction.bounded()) return true;
  const auto solve = [&](const Group& group, const Planar<Interval>& arm_of, const Interval& square_of,
                         const Interval& square_other) {
    const Interval length = sqrt(square_of);
    Interval cosine = (square_s + square_of - square_other) / (Interval(2) * length * s);
    if (!cosine.meet(Interval(-1, 1))) return false;
    const Interval beta = solvers::arc_cosine(cosine);
    const Interval of_arm = group.lengths.empty() ? group.direction : solvers::angle_of(arm_of.x, arm_of.y, 0.0);
    if (!beta.bounded() || !of_arm.bounded()) return true;
    const Interval base = direction - of_arm;
    return narrow_to_any(box, group.angle, {base + beta, base - beta});
  };
  return solve(loop[i], arm_i, square_i, square_j) && solve(loop[j], arm_j, square_j, square_i);
}

// --- coordinates that follow from the drivers -----------------------------------------------------------------------
//
// Loops in their order give two coordinates u, v each. With m a pose of the box that is nearly closed, and D_k the
// derivatives of a loop over the box,  0 = c(m) + sum_k D_k (x_k - m_k)  by the mean value theorem; where
//   x_k - m_k = r_k + sum_p X_kp (p - m_p)
// is known of the others, p the drivers, Cramer's rule gives the same of u and v.

bool BoxProver::are_drivers_narrow(const CoordinateBox& box) const {
  return std::all_of(drivers_.begin(), drivers_.end(), [&](int i) { return box[i].width() < narrow_for_dyads; });
}

void BoxProver::set_middle(int i, double x, const CoordinateBox& box) {
  middle_[i] = std::clamp(x, box[i].lower(), box[i].upper());
  thin_[i] = Interval(middle_[i]);
  if (i < angles_) thin_unit_[i] = unit(thin_[i]);
}

// The box is all that is known of a coordinate that does not follow the driving ones.
void BoxProver::forget(int i, const CoordinateBox& box) {
  set_middle(i, box[i].middle(), box);
  Interval* by = followed(i);
  std::fill_n(by, drivers_.size(), Interval(0));
  by[drivers_.size()] = box[i] - thin_[i];
}

template <class Take>
void BoxProver::for_each_derivative(const Group& group, const CoordinateBox& box,
                                    const std::vector<Planar<Interval>>& units, const Take& take) {
  const Planar<Interval> frame = group.angle < 0 ? Planar<Interval>{Interval(1), Interval(0)} : units[group.angle];
  if (group.angle >= 0) {
    const Planar<Interval> own = arm(group, box) * frame;
    take(group.angle, Planar<Interval>{-own.y, own.x});
  }
  for (const Group::Along& along : group.lengths) take(along.length, along.direction * frame);
}

// sum_k D_k (x_k - m_k) of a group as a function of the drivers, but for the dyad's own coordinates.
void BoxProver::add_followed(const Group& group, const CoordinateBox& box, DyadEquations& to, const Dyad& dyad) {
  for_each_derivative(group, box, unit_, [&](int k, const Planar<Interval>& by) {
    if (k == dyad.first) {
      to.by_first = by;
    } else if (k == dyad.second) {
      to.by_second = by;
    } else {
      const Interval* of = followed(k);
      for (std::size_t p = 0; p <= drivers_.size(); ++p) {
        if (of[p].magnitude() != 0) to.others[p] += of[p] * by;
      }
    }
  });
}

Planar<Interval> BoxProver::gap_at_middle(const Loop& loop) const {
  Planar<Interval> sum{};
  for (const Group& group : loop) {
    const Planar<Interval> own = arm(group, thin_);
    sum += group.angle < 0 ? own : own * thin_unit_[group.angle];
  }
  return sum;
}

// The middle of u and v moved to where the loop closes, and how far it is open there.
Planar<Interval> BoxProver::close_middle(const Dyad& dyad, const CoordinateBox& box) {
  const Loop& loop = loops_[dyad.loop];
  for (int step = 0;; ++step) {
    const Planar<Interval> gap = gap_at_middle(loop);
    Planar<Interval> by_first{}, by_second{};
    for (const Group& group : loop) {
      for_each_derivative(group, thin_, thin_unit_, [&](int k, const Planar<Interval>& by) {
        if (k == dyad.first) by_first = by;
        if (k == dyad.second) by_second = by;
      });
    }
    const double over = cross(by_first, by_second).middle();
    const double first = -cross(gap, by_second).middle() / over;
    const double second = -cross(by_first, gap).middle() / over;
    constexpr double far = 1.0;
    if (step == most_closing_steps || !(std::abs(first) < far && std::abs(second) < far)) return gap;
    set_middle(dyad.first, middle_[dyad.first] + first, box);
    set_middle(dyad.second, middle_[dyad.second] + second, box);
  }
}

// The two arms of u and v make a triangle with the sum of the rest, which is enclosed by the drivers too.
bool BoxProver::contract_followed_triangle(const Dyad& dyad, CoordinateBox& box) {
  const Loop& loop = loops_[dyad.loop];
  const auto group_of = [&](int angle) {
    const auto at = std::find_if(loop.begin(), loop.end(), [&](const Group& g) { return g.angle == angle; });
    return static_cast<std::size_t>(at - loop.begin());
  };
  const std::size_t i = group_of(dyad.first);
  const std::size_t j = group_of(dyad.second);
  if (i == loop.size() || j == loop.size()) return true;
  const std::size_t d = drivers_.size();
  DyadEquations& sum = dyad_;
  sum.others.assign(d + 1, {});
  Planar<Interval> rest{};
  for (std::size_t k = 0; k < loop.size(); ++k) {
    if (k == i || k == j) continue;
    const Group& group = loop[k];
    rest -= term(group, box);
    const Planar<Interval> own = arm(group, thin_);
    sum.others[d] += group.angle < 0 ? own : own * thin_unit_[group.angle];
    add_followed(group, box, sum, dyad);
  }
  Planar<Interval> centered = -sum.others[d];
  for (std::size_t p = 0; p < d; ++p) centered -= (box[drivers_[p]] - thin_[drivers_[p]]) * sum.others[p];
  if (!rest.x.meet(centered.x) || !rest.y.meet(centered.y)) return false;
  return contract_triangle(loop, i, j, rest, box);
}

// Narrows a coordinate i of the dyad by x_i - m_i = -(by_p / det) (p - m_p) - by / det. The middle remains in the box,
// as the mean value theorem needs.
bool BoxProver::follow(int i, const Interval& det, const std::vector<Interval>& by, CoordinateBox& box) {
  const std::size_t d = drivers_.size();
  Interval* own = followed(i);
  for (std::size_t p = 0; p <= d; ++p) own[p] = -(by[p] / det);
  Interval to = thin_[i] + own[d];
  for (std::size_t p = 0; p < d; ++p) to += own[p] * (box[drivers_[p]] - thin_[drivers_[p]]);
  if (!box[i].meet(to)) return false;
  if (i < angles_) turn(i, box);
  if (middle_[i] >= box[i].lower() && middle_[i] <= box[i].upper()) return true;
  const Interval outside = thin_[i];
  set_middle(i, middle_[i], box);
  own[d] += outside - thin_[i];
  return true;
}

bool BoxProver::contract_dyad(const Dyad& dyad, CoordinateBox& box) {
  if (!contract_followed_triangle(dyad, box)) return false;
  forget(dyad.first, box);
  forget(dyad.second, box);
  const std::size_t d = drivers_.size();
  std::vector<Interval>& by = dyad_by_;
  by.resize(d + 1);
  Planar<Interval> gap = close_middle(dyad, box);
  bool follows = false;
  for (int sweep = 0; sweep < most_dyad_sweeps; ++sweep) {
    dyad_.others.assign(d + 1, {});
    dyad_.others[d] = gap;
    for (const Group& group : loops_[dyad.loop]) add_followed(group, box, dyad_, dyad);
    const Interval det = cross(dyad_.by_first, dyad_.by_second);
    if (!det.excludes_zero()) break;
    follows = true;
    const auto width = [&] { return std::max(box[dyad.first].width(), box[dyad.second].width()); };
    const double before = width();
    for (std::size_t p = 0; p <= d; ++p) by[p] = cross(dyad_.others[p], dyad_.by_second);
    if (!follow(dyad.first, det, by, box)) return false;
    for (std::size_t p = 0; p <= d; ++p) by[p] = cross(dyad_.by_first, dyad_.others[p]);
    if (!follow(dyad.second, det, by, box)) return false;
    if (!(width() < enough_for_dyads * before)) break;
    gap = gap_at_middle(loops_[dyad.loop]);
  }
  if (follows) return true;
  forget(dyad.first, box);
  forget(dyad.second, box);
  if (loose_ >= 0) return true;
  // Halving what it follows from is of no use where it is wide by itself.
  Planar<Interval> rest = dyad_.others[d] - gap;
  for (std::size_t p = 0; p < d; ++p) rest += (box[drivers_[p]] - thin_[drivers_[p]]) * dyad_.others[p];
  const double given = std::max(rest.x.width(), rest.y.width());
  const double first = box[dyad.first].width() * norm(dyad_.by_first).middle();
  const double second = box[dyad.second].width() * norm(dyad_.by_second).middle();
  const int wider = first > second ? dyad.first : dyad.second;
  if (std::max(first, second) > much_wider * given && box[wider].width() > wide) loose_ = wider;
  return true;
}

bool BoxProver::contract_dyads(CoordinateBox& box) {
  const std::size_t d = drivers_.size();
  loose_ = -1;
  follow_.resize(static_cast<std::size_t>(n_) * (d + 1));
  middle_.resize(n_);
  thin_.resize(n_);
  thin_unit_.resize(angles_);
  for (int i = 0; i < n_; ++i) forget(i, box);
  for (std::size_t p = 0; p < d; ++p) {
    followed(drivers_[p])[p] = Interval(1);
    followed(drivers_[p])[d] = Interval(0);
  }
  return std::all_of(dyads_.begin(), dyads_.end(), [&](const Dyad& dyad) { return contract_dyad(dyad, box); });
}

// --- balance of coordinates in no closure ---------------------------------------------------------------------------

bool BoxProver::contract_balance(CoordinateBox& box) {
  mechanism_.place(box.data(), pose_.data());
  mechanism_.negative_force(box.data(), pose_.data(), force_.data());
  for (int i = 0; i < n_; ++i) {
    if (is_free_[i] != 0 && force_[i].excludes_zero()) return false;
  }
  std::fill(multipliers_.begin(), multipliers_.end(), Interval(0));
  mechanism_.tangent(pose_.data(), multipliers_.data(), tangent_.data());
  follows_ = !steps_.empty() && std::all_of(steps_.begin(), steps_.end(),
                                            [&](const Step& step) { return tangent_[step.entry].excludes_zero(); });
  CoordinateBox at = box;
  for (std::size_t e = 0; e < tangent_.size(); ++e) {
    if (!tangent_[e].excludes_zero()) continue;
    const int pair[] = {plain_.tangent_row()[e], plain_.tangent_column()[e]};
    for (int way = 0; way < 2; ++way) {
      const int i = pair[way];
      const int j = pair[1 - way];
      if (is_free_[i] == 0 || (way == 1 && (i == j || plain_.has_follower_loads()))) continue;
      if (!box[j].bounded() || !(box[j].width() > 1e-13)) continue;
      at[j] = Interval(box[j].middle());
      mechanism_.place(at.data(), pose_.data());
      mechanism_.negative_force(at.data(), pose_.data(), force_.data());
      const Interval to = at[j] - force_[i] / tangent_[e];
      if (!box[j].meet(to)) return false;
      at[j] = box[j];
    }
  }
  for (int k = 0; k < angles_; ++k) turn(k, box);
  return true;
}

// Shooting: with x' near the middle, p the coordinates that no step gives, and H the stiffness over the box, row i of
// balance is  0 = F_i(x') + sum_j H_ij (x_j - x'_j)  by the mean value theorem. The steps in their order give
//   x_j - x'_j = a_j + sum_p b_jp (p - p'),
// and rows that are no step are equations in p alone.
bool BoxProver::shoot(CoordinateBox& box) {
  const auto n = static_cast<std::size_t>(n_);
  mechanism_.place(box.data(), pose_.data());
  std::fill(multipliers_.begin(), multipliers_.end(), Interval(0));
  mechanism_.tangent(pose_.data(), multipliers_.data(), tangent_.data());
  stiffness_.assign(n * n, Interval(0));
  for (std::size_t e = 0; e < tangent_.size(); ++e) {
    const auto i = static_cast<std::size_t>(plain_.tangent_row()[e]);
    const auto j = static_cast<std::size_t>(plain_.tangent_column()[e]);
    stiffness_[i * n + j] += tangent_[e];
    if (i != j && !plain_.has_follower_loads()) stiffness_[j * n + i] += tangent_[e];
  }
  std::vector<double>& point = middle_;
  point.resize(n);
  for (std::size_t i = 0; i < n; ++i) point[i] = box[i].middle();
  std::vector<Planar<double>> pose(static_cast<std::size_t>(plain_.pose_size()));
  std::vector<double> force(n);
  for (const Step& step : steps_) {
    plain_.place(point.data(), pose.data());
    plain_.negative_force(point.data(), pose.data(), force.data());
    double& x = point[step.gives];
    const double to = x - force[step.row] / stiffness_[step.row * n + step.gives].middle();
    if (std::isfinite(to)) x = std::clamp(to, box[step.gives].lower(), box[step.gives].upper());
  }
  CoordinateBox thin(n);
  for (std::size_t i = 0; i < n; ++i) thin[i] = Interval(point[i]);
  mechanism_.place(thin.data(), pose_.data());
  mechanism_.negative_force(thin.data(), pose_.data(), force_.data());
  // Columns of motion_: b, and the last a.
  const std::size_t d = parameters_.size();
  motion_.assign(n * (d + 1), Interval(0));
  for (std::size_t p = 0; p < d; ++p) motion_[parameters_[p] * (d + 1) + p] = Interval(1);
  std::vector<Interval> by(d + 1);
  const auto sum_of = [&](std::size_t row, int but) {
    std::fill(by.begin(), by.end(), Interval(0));
    by[d] = force_[row];
    for (int j = 0; j < n_; ++j) {
      const Interval& h = stiffness_[row * n + j];
      if (j == but || (h.lower() == 0 && h.upper() == 0)) continue;
      for (std::size_t p = 0; p <= d; ++p) by[p] += h * motion_[j * (d + 1) + p];
    }
  };
  for (const Step& step : steps_) {
    sum_of(step.row, step.gives);
    const Interval& own = stiffness_[step.row * n + step.gives];
    for (std::size_t p = 0; p <= d; ++p) motion_[step.gives * (d + 1) + p] = -(by[p] / own);
  }
  for (const int row : open_rows_) {
    sum_of(row, -1);
    if (!meet_zero(by[d], by, parameters_, thin, box)) return false;
  }
  for (const Step& step : steps_) {
    const Interval* motion = &motion_[step.gives * (d + 1)];
    Interval to = thin[step.gives] + motion[d];
    for (std::size_t p = 0; p < d; ++p) to += motion[p] * (box[parameters_[p]] - thin[parameters_[p]]);
    if (!box[step.gives].meet(to)) return false;
  }
  return true;
}

bool BoxProver::contract(CoordinateBox& box, bool balance) {
  gap_ = {};
  loose_ = -1;
  follows_ = false;
  for (int k = 0; k < angles_; ++k) turn(k, box);
  const bool any_free = std::any_of(is_free_.begin(), is_free_.end(), [](char f) { return f != 0; });
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const CoordinateBox before = box;
    if (balance && !contract_stops(box)) return false;
    for (const Loop& loop : loops_) {
      if (!contract_loop(loop, box)) return false;
      for (std::size_t i = 1; i < loop.size(); ++i) {
        for (std::size_t j = i + 1; j < loop.size(); ++j) {
          const double both = std::min(box[loop[i].angle].width(), box[loop[j].angle].width());
          if (both > wide && !contract_pair(loop, i, j, box)) return false;
        }
      }
    }
    if (!dyads_.empty() && are_drivers_narrow(box) && !contract_dyads(box)) return false;
    if (balance && any_free && !contract_balance(box)) return false;
    bool more = false;
    for (int i = 0; i < n_; ++i) {
      if (box[i].width() < (1 - little) * before[i].width() && before[i].width() > 1e-12) more = true;
    }
    if (!more) break;
  }
  return true;
}

// Stops that are not active bound their measures, and others are at a limit:  g(x) = g(m) + sum_i G_i (x_i - m_i)  is
// within these. Those that repeat other rows are so to within rounding.
bool BoxProver::contract_stops(CoordinateBox& box) {
  if (plain_.stops() == 0) return true;
  mechanism_.place(box.data(), pose_.data());
  mechanism_.constraint(box.data(), pose_.data(), constraint_.data());
  const bool repeats = rows_.size() > static_cast<std::size_t>(m_);
  const Interval slack = repeats ? Interval(-open_gap, open_gap) : Interval(0);
  const auto limits_of = [&](int s) {
    const double lower = plain_.lower()[s];
    const double upper = plain_.upper()[s];
    if (stops_[s] == StopState::inactive) return Interval(lower, upper) + slack;
    return Interval(stops_[s] == StopState::at_upper ? upper : lower) + slack;
  };
  bool is_cut = false;
  for (int s = 0; s < plain_.stops(); ++s) {
    const Interval& measure = constraint_[plain_.stop_row(s)];
    const Interval limits = limits_of(s);
    Interval both = measure;
    if (!both.meet(limits)) return false;
    is_cut = is_cut || both.lower() > measure.lower() || both.upper() < measure.upper();
  }
  if (!is_cut) return true;
  mechanism_.jacobian(pose_.data(), jacobian_.data());
  CoordinateBox middle(n_);
  for (int i = 0; i < n_; ++i) middle[i] = Interval(box[i].middle());
  mechanism_.place(middle.data(), pose_.data());
  mechanism_.constraint(middle.data(), pose_.data(), constraint_.data());
  for (std::size_t e = 0; e < jacobian_.size(); ++e) {
    const int row = plain_.jacobian_row()[e];
    const int i = plain_.jacobian_column()[e];
    if (row < plain_.equalities() || !jacobian_[e].excludes_zero()) continue;
    Interval own = limits_of(row - plain_.equalities()) - constraint_[row];
    for (std::size_t other = 0; other < jacobian_.size(); ++other) {
      const int j = plain_.jacobian_column()[other];
      if (plain_.jacobian_row()[other] == row && other != e) own -= jacobian_[other] * (box[j] - middle[j]);
    }
    if (!box[i].meet(middle[i] + own / jacobian_[e])) return false;
    if (i < angles_) turn(i, box);
  }
  return true;
}

// --- rows and balance -----------------------------------------------------------------------------------------------

// Jacobian of the rows over the box.
void BoxProver::evaluate(const CoordinateBox& box) {
  mechanism_.place(box.data(), pose_.data());
  mechanism_.jacobian(pose_.data(), jacobian_.data());
  std::fill(dense_.begin(), dense_.end(), Interval(0));
  for (std::size_t e = 0; e < jacobian_.size(); ++e) {
    const int k = equation_[plain_.jacobian_row()[e]];
    if (k >= 0) dense_[static_cast<std::size_t>(k) * n_ + plain_.jacobian_column()[e]] += jacobian_[e];
  }
}

// Dependent coordinates by elimination with full pivoting of the middles of the Jacobian, and the inverse of their
// part. Rows without a pivot come last.
bool BoxProver::choose_dependent() {
  const auto rows = static_cast<int>(rows_.size());
  Eigen::MatrixXd middle(rows, n_);
  for (int k = 0; k < rows; ++k) {
    for (int i = 0; i < n_; ++i) {
      const Interval& entry = dense_[static_cast<std::size_t>(k) * n_ + i];
      if (!entry.bounded()) return false;
      middle(k, i) = entry.middle();
    }
  }
  Eigen::MatrixXd left = middle;
  std::vector<char> row_done(rows, 0);
  std::vector<char> column_done(n_, 0);
  dependent_.assign(rows, -1);
  for (int step = 0; step < m_; ++step) {
    int row = -1;
    int column = -1;
    double most = 1e-9;
    for (int k = 0; k < rows; ++k) {
      if (row_done[k] != 0) continue;
      for (int i = 0; i < n_; ++i) {
        if (column_done[i] == 0 && std::abs(left(k, i)) > most) {
          most = std::abs(left(k, i));
          row = k;
          column = i;
        }
      }
    }
    if (row < 0) return false;
    row_done[row] = column_done[column] = 1;
    dependent_[row] = column;
    least_pivot_ = most;
    for (int k = 0; k < rows; ++k) {
      if (k != row && row_done[k] == 0) left.row(k) -= left(k, column) / left(row, column) * left.row(row);
    }
  }
  for (int k = 0, last = rows - 1; k < m_; ++k) {
    if (row_done[k] != 0) continue;
    while (row_done[last] == 0) --last;
    std::swap(rows_[k], rows_[last]);
    std::swap(bounds_[k], bounds_[last]);
    std::swap(equation_[rows_[k]], equation_[rows_[last]]);
    std::swap(dependent_[k], dependent_[last]);
    std::swap(row_done[k], row_done[last]);
    middle.row(k).swap(middle.row(last));
    const auto at = [&](int row) { return dense_.begin() + static_cast<std::ptrdiff_t>(row) * n_; };
    std::swap_ranges(at(k), at(k + 1), at(last));
  }
  free_columns_.clear();
  for (int i = 0; i < n_; ++i) {
    if (column_done[i] == 0) free_columns_.push_back(i);
  }
  Eigen::MatrixXd part(m_, m_);
  for (int k = 0; k < m_; ++k) part.col(k) = middle.col(dependent_[k]).head(m_);
  const Eigen::MatrixXd inverse = part.partialPivLu().inverse();
  if (!inverse.allFinite()) return false;
  inverse_.assign(inverse.data(), inverse.data() + inverse.size());  // by columns
  product_.assign(static_cast<std::size_t>(m_) * n_, Interval(0));
  for (int k = 0; k < m_; ++k) {
    for (int l = 0; l < m_; ++l) {
      const double factor = inverse(k, l);
      if (factor == 0) continue;
      for (int i = 0; i < n_; ++i) {
        const Interval& entry = dense_[static_cast<std::size_t>(l) * n_ + i];
        add_product(product_[static_cast<std::size_t>(k) * n_ + i], factor, entry);
      }
    }
  }
  return true;
}

// By the mean value theorem  0 = c(middle) + J (x - middle), J in its enclosure: with R the inverse, each dependent
// coordinate has an equation of its own.
bool BoxProver::contract_rows(CoordinateBox& box) {
  CoordinateBox middle(n_);
  for (int i = 0; i < n_; ++i) middle[i] = Interval(box[i].middle());
  mechanism_.place(middle.data(), pose_.data());
  mechanism_.constraint(middle.data(), pose_.data(), constraint_.data());
  for (int k = 0; k < m_; ++k) {
    Interval sum(0);
    for (int l = 0; l < m_; ++l) {
      add_product(sum, inverse_[static_cast<std::size_t>(l) * m_ + k], constraint_[rows_[l]] - Interval(bounds_[l]));
    }
    const Interval* row = &product_[static_cast<std::size_t>(k) * n_];
    const int own = dependent_[k];
    if (!(row[own] > Interval(0))) continue;
    for (int i = 0; i < n_; ++i) {
      if (i != own) sum += row[i] * (box[i] - middle[i]);
    }
    if (!box[own].meet(middle[own] - sum / row[own])) return false;
  }
  return true;
}

// y with J_o^T y = -F_o for all J_o, F_o of the box: with E = J_o R - I,  y = -R^T F_o - E^T y.
bool BoxProver::solve_transposed(std::vector<Interval>& y) const {
  std::vector<Interval> error(static_cast<std::size_t>(m_) * m_, Interval(0));
  std::vector<Interval> right(m_, Interval(0));
  for (int k = 0; k < m_; ++k) {
    for (int l = 0; l < m_; ++l) {
      const double factor = inverse_[static_cast<std::size_t>(l) * m_ + k];  // R(k, l)
      if (factor == 0) continue;
      add_product(right[l], -factor, force_[dependent_[k]]);
      for (int i = 0; i < m_; ++i) {
        add_product(error[static_cast<std::size_t>(i) * m_ + l], factor,
                    dense_[static_cast<std::size_t>(i) * n_ + dependent_[k]]);
      }
    }
  }
  Eigen::MatrixXd bounds(m_, m_);
  Eigen::VectorXd size(m_);
  for (int l = 0; l < m_; ++l) {
    for (int i = 0; i < m_; ++i) {
      Interval& e = error[static_cast<std::size_t>(i) * m_ + l];
      if (i == l) e -= Interval(1);
      bounds(l, i) = e.magnitude();
    }
    size[l] = right[l].magnitude();
  }
  Contraction contraction;
  Eigen::VectorXd u(m_);
  if (!size.allFinite() || !contraction.set(bounds) || !contraction.bound(size, u)) return false;
  y.resize(m_);
  for (int l = 0; l < m_; ++l) y[l] = Interval(-u[l], u[l]);
  for (int sweep = 0; sweep < 3; ++sweep) {
    for (int l = 0; l < m_; ++l) {
      Interval next = right[l];
      for (int i = 0; i < m_; ++i) next -= error[static_cast<std::size_t>(i) * m_ + l] * y[i];
      y[l].meet(next);
    }
  }
  return true;
}

// Motions X = -J_o^-1 J_p that the rows allow, one column per free coordinate, and r = -J_o^-1 c(middle): of every
// closed pose x of the box, x_o - middle_o = X (p - middle_p) + r. With E = R J_o - I:  X = -R J_p - E X, likewise r.
//
// An equilibrium needs F_p + X^T F_o = 0. Sharper for small boxes: with G(x) = F(x) + J(x)^T y_0 and a motion t of the
// middle, t . (G(x) + J(x)^T (y - y_0)) = 0 gives
//   0 = t . G(middle) + t^T H(X, y_0) (x - middle) + (J t) . (y - y_0),
// linear in p - middle_p, which narrows p.
bool BoxProver::motions(CoordinateBox& box) {
  const int d = static_cast<int>(free_columns_.size());
  Eigen::MatrixXd bounds(m_, m_);
  for (int k = 0; k < m_; ++k) {
    for (int l = 0; l < m_; ++l) {
      Interval& e = product_[static_cast<std::size_t>(k) * n_ + dependent_[l]];
      if (k == l) e -= Interval(1);
      bounds(k, l) = e.magnitude();
    }
  }
  Contraction contraction;
  if (!contraction.set(bounds)) return false;
  std::vector<double>& middle = middle_;
  middle.resize(n_);
  for (int i = 0; i < n_; ++i) middle[i] = box[i].middle();
  // The middle moved onto the closures, where it remains in the box.
  std::vector<Planar<double>> pose(plain_.pose_size());
  std::vector<double> constraint(constraint_.size());
  for (int step = 0; step < 2 && m_ > 0; ++step) {
    plain_.place(middle.data(), pose.data());
    plain_.constraint(middle.data(), pose.data(), constraint.data());
    for (int k = 0; k < m_; ++k) {
      double by = 0.0;
      for (int l = 0; l < m_; ++l) {
        by += inverse_[static_cast<std::size_t>(l) * m_ + k] * (constraint[rows_[l]] - bounds_[l]);
      }
      double& x = middle[dependent_[k]];
      x = std::clamp(x - by, box[dependent_[k]].lower(), box[dependent_[k]].upper());
    }
  }
  CoordinateBox thin(n_);
  for (int i = 0; i < n_; ++i) thin[i] = Interval(middle[i]);
  mechanism_.place(thin.data(), pose_.data());
  mechanism_.constraint(thin.data(), pose_.data(), constraint_.data());
  motion_.assign(static_cast<std::size_t>(n_) * (d + 1), Interval(0));
  std::vector<Interval> right(m_);
  std::vector<Interval> x(m_);
  Eigen::VectorXd size(m_);
  Eigen::VectorXd u(m_);
  for (int q = 0; q <= d; ++q) {
    for (int k = 0; k < m_; ++k) {
      if (q < d) {
        right[k] = -product_[static_cast<std::size_t>(k) * n_ + free_columns_[q]];
      } else {
        right[k] = Interval(0);
        for (int l = 0; l < m_; ++l) {
          add_product(right[k], -inverse_[static_cast<std::size_t>(l) * m_ + k],
                      constraint_[rows_[l]] - Interval(bounds_[l]));
        }
      }
      size[k] = right[k].magnitude();
    }
    if (!size.allFinite() || !contraction.bound(size, u)) return false;
    for (int k = 0; k < m_; ++k) x[k] = Interval(-u[k], u[k]);
    for (int sweep = 0; sweep < 3; ++sweep) {
      for (int k = 0; k < m_; ++k) {
        Interval next = right[k];
        for (int l = 0; l < m_; ++l) next -= product_[static_cast<std::size_t>(k) * n_ + dependent_[l]] * x[l];
        x[k].meet(next);
      }
    }
    for (int k = 0; k < m_; ++k) motion_[static_cast<std::size_t>(dependent_[k]) * (d + 1) + q] = x[k];
    if (q == d) break;
    motion_[static_cast<std::size_t>(free_columns_[q]) * (d + 1) + q] = Interval(1);
  }
  return true;
}

// After motions(): some of the rounds may have an equilibrium, which are kept.
bool BoxProver::balance_possible(const Winding& winding, Interval& rounds) const {
  const auto d = static_cast<int>(free_columns_.size());
  for (int q = 0; q < d; ++q) {
    Interval force(0);
    Interval change(0);
    for (int i = 0; i < n_; ++i) {
      const Interval& motion = motion_[static_cast<std::size_t>(i) * (d + 1) + q];
      force += motion * force_[i];
      change += motion * winding.change[i];
    }
    if ((force + rounds * change).excludes_zero()) return false;
    if (change.excludes_zero() && !rounds.meet(-(force / change))) return false;
  }
  rounds = Interval(std::ceil(rounds.lower()), std::floor(rounds.upper()));
  return rounds.lower() <= rounds.upper();
}

bool BoxProver::balance_possible(CoordinateBox& box) {
  const int d = static_cast<int>(free_columns_.size());
  for (int q = 0; q < d; ++q) {
    Interval force(0);
    for (int i = 0; i < n_; ++i) force += motion_[static_cast<std::size_t>(i) * (d + 1) + q] * force_[i];
    if (force.excludes_zero()) return false;
  }
  CoordinateBox thin(n_);
  for (int i = 0; i < n_; ++i) thin[i] = Interval(middle_[i]);
  std::vector<Interval> y;
  if (!solve_transposed(y)) return true;
  // F, J and H at the middle and over the box.
  std::fill(multipliers_.begin(), multipliers_.end(), Interval(0));
  for (int k = 0; k < m_; ++k) multipliers_[rows_[k]] = Interval(y[k].middle());
  // motions() has left the phasors of the middle.
  mechanism_.negative_force(thin.data(), pose_.data(), force_.data());
  mechanism_.jacobian(pose_.data(), jacobian_.data());
  for (std::size_t e = 0; e < jacobian_.size(); ++e) {
    const int k = equation_[plain_.jacobian_row()[e]];
    if (k < 0 || k >= m_) continue;
    force_[plain_.jacobian_column()[e]] += jacobian_[e] * multipliers_[plain_.jacobian_row()[e]];
  }
  mechanism_.place(box.data(), pose_.data());
  mechanism_.tangent(pose_.data(), multipliers_.data(), tangent_.data());
  std::vector<Interval> row(n_);
  std::vector<Interval> by(d);
  for (int q = 0; q < d; ++q) {
    std::fill(row.begin(), row.end(), Interval(0));
    Interval sum(0);
    const auto t = [&](int i) { return motion_[static_cast<std::size_t>(i) * (d + 1) + q].middle(); };
    for (int i = 0; i < n_; ++i) add_product(sum, t(i), force_[i]);
    for (std::size_t e = 0; e < tangent_.size(); ++e) {
      const int i = plain_.tangent_row()[e];
      const int j = plain_.tangent_column()[e];
      add_product(row[j], t(i), tangent_[e]);
      if (i != j && !plain_.has_follower_loads()) add_product(row[i], t(j), tangent_[e]);
    }
    for (int k = 0; k < m_; ++k) {
      Interval slip(0);
      for (int i = 0; i < n_; ++i) add_product(slip, t(i), dense_[static_cast<std::size_t>(k) * n_ + i]);
      sum += slip * (y[k] - Interval(y[k].middle()));
    }
    std::fill(by.begin(), by.end(), Interval(0));
    for (int i = 0; i < n_; ++i) {
      for (int p = 0; p < d; ++p) by[p] += row[i] * motion_[static_cast<std::size_t>(i) * (d + 1) + p];
      sum += row[i] * motion_[static_cast<std::size_t>(i) * (d + 1) + d];
    }
    if (!meet_zero(sum, by, free_columns_, thin, box)) return false;
  }
  // Dependent coordinates follow.
  for (int k = 0; k < m_; ++k) {
    const std::size_t i = static_cast<std::size_t>(dependent_[k]);
    Interval to = thin[i] + motion_[i * (d + 1) + d];
    for (int p = 0; p < d; ++p) {
      to += motion_[i * (d + 1) + p] * (box[free_columns_[p]] - thin[free_columns_[p]]);
    }
    if (!box[i].meet(to)) return false;
  }
  return true;
}

// Where J loses rank or nearly so: elimination with full pivoting leaves, of F + J^T y = 0, for the rows s without a
// pivot and the columns q without one
//   F'_q + sum_s J'_sq y_s = 0,   so that   max_s |y_s| >= |F'_q| / sum_s |J'_sq|.
// A single row gives y_s itself by every q. Nothing is concluded of lost rank where more stops may touch: there more of
// them can be needed than there are freedoms elsewhere, and no case has so many.
BoxProver::Decision BoxProver::near_singular(const CoordinateBox& box) {
  const bool may_touch = may_touch_stops(box);
  const auto n = static_cast<std::size_t>(n_);
  left_.assign(dense_.begin(), dense_.end());
  left_.insert(left_.end(), force_.begin(), force_.end());
  const auto at = [&](int row, int column) -> Interval& { return left_[static_cast<std::size_t>(row) * n + column]; };
  const auto rows = static_cast<int>(rows_.size());
  row_done_.assign(rows_.size(), 0);
  column_done_.assign(n_, 0);
  for (int rank = 0; rank <= m_; ++rank) {
    int row = -1;
    int column = -1;
    double most = 0.0;
    for (int k = 0; k < rows; ++k) {
      for (int i = 0; i < n_ && row_done_[k] == 0; ++i) {
        if (column_done_[i] == 0 && at(k, i).mignitude() > most) {
          most = at(k, i).mignitude();
          row = k;
          column = i;
        }
      }
    }
    if (rank == m_ || (most < small_pivot && !may_touch)) {
      for (int q = 0; q < n_; ++q) {
        if (column_done_[q] != 0) continue;
        double slope = 0.0;
        for (int k = 0; k < rows; ++k) {
          if (row_done_[k] == 0 && rank < m_) slope += at(k, q).magnitude();
        }
        const bool never = largest_joint_force * slope - at(rows, q).mignitude() < 0;
        if (never) return rank < m_ ? Decision::locked : Decision::empty;
      }
      if (rank == rows - 1 && rank < m_) {
        const int last = static_cast<int>(std::find(row_done_.begin(), row_done_.end(), 0) - row_done_.begin());
        Interval single = Interval::entire();
        for (int q = 0; q < n_; ++q) {
          if (column_done_[q] == 0 && !single.meet(-(at(rows, q) / at(last, q)))) return Decision::empty;
        }
      }
    }
    if (row < 0 || rank == m_) break;
    row_done_[row] = column_done_[column] = 1;
    for (int k = 0; k <= rows; ++k) {
      if (k < rows && row_done_[k] != 0) continue;
      const Interval factor = at(k, column) / at(row, column);
      for (int i = 0; i < n_; ++i) {
        if (column_done_[i] == 0) at(k, i) -= factor * at(row, i);
      }
    }
  }
  return Decision::open;
}

// Whether a stop that is not active is reached in the box, whose phasors are placed.
bool BoxProver::may_touch_stops(const CoordinateBox& box) {
  if (plain_.stops() == 0) return false;
  mechanism_.constraint(box.data(), pose_.data(), constraint_.data());
  for (int s = 0; s < plain_.stops(); ++s) {
    const Interval& measure = constraint_[plain_.stop_row(s)];
    const bool is_within = measure < Interval(plain_.upper()[s]) && measure > Interval(plain_.lower()[s]);
    if (stops_[s] == StopState::inactive && !is_within) return true;
  }
  return false;
}

// --- change points --------------------------------------------------------------------------------------------------

// Finds the change point next to the middle of the box, unless one was looked for there.
void BoxProver::look_for_crossing(const CoordinateBox& box) {
  const double size = widest(box);
  if (!crossings_ || !(size < narrow_for_crossing)) return;
  const auto is_near = [&](const std::vector<double>& x) {
    for (int i = 0; i < n_; ++i) {
      if (!(abs(box[i] - Interval(x[i])).lower() < size)) return false;
    }
    return true;
  };
  if (std::any_of(looked_for_crossing_.begin(), looked_for_crossing_.end(), is_near)) return;
  std::vector<double> middle;
  for (const Interval& x : box) middle.push_back(x.middle());
  std::optional<CrossingBranches::Region> region = crossings_->around(middle);
  looked_for_crossing_.push_back(region ? region->at : std::move(middle));
  if (region) regions_.push_back(std::move(*region));
}

// A box next to a change point may have equilibria in the core alone: decides it, or leaves that.
bool BoxProver::is_decided_by_crossing(CoordinateBox& box, Verdict& verdict) {
  const auto region = std::find_if(regions_.begin(), regions_.end(),
                                   [&](const CrossingBranches::Region& one) { return one.contains(box); });
  if (region == regions_.end()) return false;
  verdict.decision = Decision::empty;
  CoordinateBox both = box;
  for (int i = 0; i < n_; ++i) {
    if (!both[i].meet(region->core[i])) return true;
  }
  box = region->core;
  mechanism_.place(box.data(), pose_.data());
  verdict.joint_force = region->joint_force;
  const bool is_locked = region->joint_force > least_joint_force && !may_touch_stops(box);
  verdict.decision = is_locked ? Decision::locked : Decision::crossing;
  return true;
}

// --- elements along distances ---------------------------------------------------------------------------------------

// Where the points of an element do not coincide it pulls with T along e = d / |d|. With motions X of closed poses
// (motions()), D = d' and the force F of everything else, balance is
//   X_p . F + T e . (D X_p) = 0   for all p.
// T of stiff elements is known in tiny boxes only, and so is e of short ones. Two of these equations have no common T
// where
//   (X_p . F) (d . D X_q) - (X_q . F) (d . D X_p)
// has no zero; and they give the vector T e, which has to be the same from any two, and of the size of T.
bool BoxProver::is_refused_by_elements(const CoordinateBox& box) {
  if (free_columns_.empty()) return false;
  for (Distance& on : distances_) {
    mechanism_.place(box.data(), pose_.data());
    const Planar<Interval> d = on.between.at(pose_.data());
    const Interval length = sqrt(squared_norm(d));
    const Interval pull = force_at_rest(on.law, length).value;
    if (!(length.width() > turning * length.lower()) && !(pull.width() > stiff)) continue;
    find_levers(on, box);
    if (free_columns_.size() == 1 ? is_passed(on, length, pull) : !is_balanced_by(on, d, pull)) return true;
  }
  return false;
}

// The levers D X_p and the forces X_p . F.
void BoxProver::find_levers(Distance& on, const CoordinateBox& box) {
  const auto d = free_columns_.size();
  if (on.rest == nullptr) {
    Scene scene = model_.scaled_scene();
    scene.elements[static_cast<std::size_t>(on.element)].law = LinearSpring{};
    on.rest = std::make_unique<Mechanism<Interval>>(scene, model_.layout(), Purpose::statics);
  }
  std::vector<Planar<Interval>> by(static_cast<std::size_t>(on.between.size()));
  on.between.derivative(mechanism_.phasors(), pose_.data(), by.data());
  on.rest->negative_force(box.data(), pose_.data(), force_.data());
  levers_.assign(d, {});
  along_.assign(d, Interval(0));
  for (std::size_t p = 0; p < d; ++p) {
    const auto motion = [&](int i) -> const Interval& { return motion_[static_cast<std::size_t>(i) * (d + 1) + p]; };
    for (int i = 0; i < n_; ++i) along_[p] += motion(i) * force_[i];
    for (int s = 0; s < on.between.size(); ++s) levers_[p] += motion(on.between.support()[s]) * by[s];
  }
}

// Whether the element may balance everything else. If it pushes with more than that where its points coincide, the
// energy has a peak there; if it pulls with more it may rest there.
bool BoxProver::is_balanced_by(const Distance& on, const Planar<Interval>& d, const Interval& pull) {
  const bool is_point = !d.x.excludes_zero() && !d.y.excludes_zero();
  Planar<Interval> needed{Interval::entire(), Interval::entire()};
  for (std::size_t p = 0; p < levers_.size(); ++p) {
    for (std::size_t q = p + 1; q < levers_.size(); ++q) {
      if (!is_point && (along_[p] * dot(d, levers_[q]) - along_[q] * dot(d, levers_[p])).excludes_zero()) return false;
      const Interval det = cross(levers_[p], levers_[q]);
      if (!det.excludes_zero()) continue;
      if (!needed.x.meet((along_[q] * levers_[p].y - along_[p] * levers_[q].y) / det)) return false;
      if (!needed.y.meet((along_[p] * levers_[q].x - along_[q] * levers_[p].x) / det)) return false;
    }
  }
  const Interval size = squared_norm(needed);
  const Interval own = square(pull);
  if (!size.bounded() || !own.bounded()) return true;
  if (size > own || (size < own && !is_point)) return false;
  if (!(size < own) || !(pull < Interval(0))) return true;
  peaks_.exactly.insert(on.element);
  return false;
}

// Tells of one freedom, with the lever v = D X, whether the element is too weak to balance everything else, or its
// points pass each other and it pushes them apart by more than that. If d = 0 anywhere in the box, then d = v' (p -
// p_0) elsewhere, v' of the same enclosure, and |T e . v| >= |T| min (v' . v) / |v'|.
bool BoxProver::is_passed(const Distance& on, const Interval& length, const Interval& pull) {
  const Planar<Interval>& lever = levers_.front();
  const Planar<Interval> other = lever;  // of which all numbers are taken with all of `lever`
  const Interval size = sqrt(squared_norm(lever));
  const Interval rest = abs(along_.front());
  if (rest > abs(pull) * size) return true;
  if (!(length.upper() < ElementPeaks::shortest) || !(pull < Interval(0))) return false;
  if (!(abs(pull) * (dot(lever, other) / size) > rest)) return false;
  peaks_.nearly.insert(on.element);
  return true;
}

// --- Newton's operator ----------------------------------------------------------------------------------------------

BoxProver::Decision BoxProver::newton(const CoordinateBox& box, CoordinateBox& out, std::vector<double>& at) {
  std::vector<double> middle(n_);
  for (int i = 0; i < n_; ++i) middle[i] = box[i].middle();
  if (!newton_) newton_.emplace(plain_, mechanism_, rows_, bounds_, equation_, m_);
  if (!newton_->begin(box, middle, least_multipliers(middle)) || !newton_->apply()) return Decision::open;
  newton_->reach_further();
  out = box;
  for (int i = 0; i < n_; ++i) {
    if (!out[i].meet(newton_->coordinate(i))) return Decision::empty;
  }
  if (!newton_->exists()) return Decision::open;
  CoordinateBox solution(n_);
  for (int i = 0; i < n_; ++i) solution[i] = newton_->coordinate(i);
  if (!satisfies_other_rows(solution) || !may_rest_on_stops(solution)) return Decision::empty;
  at = newton_->x();
  return Decision::unique;
}

// The multipliers y of least residual in the dependent coordinates at x; zeros where the rows alone determine x.
std::vector<double> BoxProver::least_multipliers(const std::vector<double>& x) const {
  std::vector<double> y(m_, 0.0);
  if (m_ == n_ || m_ == 0) return y;
  std::vector<Planar<double>> pose(plain_.pose_size());
  std::vector<double> force(n_);
  plain_.place(x.data(), pose.data());
  plain_.negative_force(x.data(), pose.data(), force.data());
  for (int l = 0; l < m_; ++l) {
    for (int k = 0; k < m_; ++k) y[l] -= inverse_[static_cast<std::size_t>(l) * m_ + k] * force[dependent_[k]];
  }
  return y;
}

// Whether rows that others imply where they repeat them close in a solution too; leaves its constraints.
bool BoxProver::satisfies_other_rows(const CoordinateBox& solution) {
  mechanism_.place(solution.data(), pose_.data());
  mechanism_.constraint(solution.data(), pose_.data(), constraint_.data());
  for (std::size_t k = static_cast<std::size_t>(m_); k < rows_.size(); ++k) {
    const Interval gap = constraint_[rows_[k]] - Interval(bounds_[k]);
    if (gap > Interval(open_gap) || gap < Interval(-open_gap)) return false;
  }
  return true;
}

// Whether active stops may press in the solution that Newton's operator found, and others are not passed for certain.
bool BoxProver::may_rest_on_stops(const CoordinateBox& solution) {
  std::vector<Interval> pushes(m_, Interval::entire());
  for (int k = 0; k < m_ && !newton_->is_square(); ++k) pushes[k] = newton_->multiplier(k);
  if (newton_->is_square() && plain_.stops() > 0) {
    evaluate(solution);
    mechanism_.negative_force(solution.data(), pose_.data(), force_.data());
    std::vector<Interval> found;
    if (choose_dependent() && solve_transposed(found)) pushes = std::move(found);
  }
  for (int s = 0; s < plain_.stops(); ++s) {
    const Interval& measure = constraint_[plain_.stop_row(s)];
    if (stops_[s] == StopState::inactive) {
      if (measure > Interval(plain_.upper()[s]) || measure < Interval(plain_.lower()[s])) return false;
    } else if (stops_[s] != StopState::permanent) {
      const Interval& push = pushes[equation_[plain_.stop_row(s)]];
      if (stops_[s] == StopState::at_upper ? push < Interval(0) : push > Interval(0)) return false;
    }
  }
  return true;
}

// --- one box --------------------------------------------------------------------------------------------------------

// A wide box is split across its widest driving coordinate, unless others are much wider all the same; else across the
// widest. Coordinates that balance could give drive too where it does not.
void BoxProver::split(const CoordinateBox& box, Verdict& verdict) const {
  int most = 0;
  int driver = -1;
  for (int i = 0; i < n_; ++i) {
    if (box[i].width() > box[most].width()) most = i;
    const bool drives = drives_[i] != 0 || (is_free_[i] != 0 && !follows_);
    if (drives && (driver < 0 || box[i].width() > box[driver].width())) driver = i;
  }
  const double narrower = follows_ ? much_narrower_by_steps : much_narrower;
  if (driver >= 0 && box[most].width() > wide && box[driver].width() > narrower * box[most].width()) most = driver;
  if (loose_ >= 0) most = loose_;
  verdict.split = most;
  // It is split off the middle, where symmetric mechanisms have their equilibria.
  verdict.split_at = box[most].lower() + 0.4871 * box[most].width();
  if (gap_.coordinate < 0) return;
  const Interval& other = box[gap_.coordinate];
  const bool inside = gap_.from > other.lower() && gap_.to < other.upper();
  if (inside && other.width() > 0.3 * box[most].width() && gap_.to - gap_.from > 0.02 * other.width()) {
    verdict.split = gap_.coordinate;
    verdict.split_at = 0.5 * (gap_.from + gap_.to);
  }
}

BoxProver::Verdict BoxProver::examine(CoordinateBox& box) {
  Verdict out;
  if (is_decided_by_crossing(box, out)) return out;
  out.decision = Decision::empty;
  bool has_motions = false;
  for (int round = 0; round < 4; ++round) {
    has_motions = false;
    const double before = widest(box);
    if (!contract(box)) return out;
    if (follows_ && !shoot(box)) return out;
    if (off_branch_ && widest(box) < narrow_for_branch && off_branch_->excludes(box, rows_, mechanism_)) return out;
    if (!(widest(box) < too_wide_for_rows)) break;
    bool regular = true;
    if (m_ > 0) {
      evaluate(box);
      regular = choose_dependent();
      if (regular && !contract_rows(box)) return out;
    } else {
      free_columns_.resize(n_);
      for (int i = 0; i < n_; ++i) free_columns_[i] = i;
    }
    if (!regular || m_ < n_) {
      mechanism_.place(box.data(), pose_.data());
      mechanism_.negative_force(box.data(), pose_.data(), force_.data());
      const bool moves = regular && m_ < n_ && motions(box);
      if (moves && !balance_possible(box)) return out;
      has_motions = moves && !distances_.empty() && widest(box) < narrow_for_elements;
      if (!moves || (m_ > 0 && least_pivot_ < small_pivot)) {
        evaluate(box);
        mechanism_.negative_force(box.data(), pose_.data(), force_.data());
        out.decision = near_singular(box);
        out.joint_force = largest_joint_force;
        if (out.decision != Decision::open) return out;
        look_for_crossing(box);
        if (is_decided_by_crossing(box, out)) return out;
        out.decision = Decision::empty;
      }
    }
    if (regular && widest(box) < narrow_enough) {
      CoordinateBox smaller = box;
      const Decision decision = newton(box, smaller, out.at);
      if (decision != Decision::open) {
        out.decision = decision;
        return out;
      }
      box = smaller;
    }
    if (!(widest(box) < 0.6 * before)) break;
  }
  if (has_motions && is_refused_by_elements(box)) return out;
  out.decision = Decision::open;
  split(box, out);
  return out;
}

BoxProver::Verdict BoxProver::examine_closed_poses(CoordinateBox& box) {
  Verdict out;
  out.decision = Decision::empty;
  if (!contract(box, false)) return out;
  bool regular = m_ == 0;
  if (m_ > 0 && widest(box) < too_wide_for_rows) {
    evaluate(box);
    if (choose_dependent()) {
      if (!contract_rows(box)) return out;
      regular = motions(box);
    }
  }
  out.decision = regular ? Decision::unique : Decision::open;
  split(box, out);
  return out;
}

BoxProver::Verdict BoxProver::examine(CoordinateBox& box, const Winding& winding, Interval& rounds) {
  Verdict out;
  out.decision = Decision::empty;
  if (!contract(box, false)) return out;
  if (widest(box) < too_wide_for_rows) {
    evaluate(box);
    if (choose_dependent()) {
      if (!contract_rows(box)) return out;
      mechanism_.place(box.data(), pose_.data());
      mechanism_.negative_force(box.data(), pose_.data(), force_.data());
      if (motions(box) && !balance_possible(winding, rounds)) return out;
    }
  }
  out.decision = Decision::open;
  split(box, out);
  return out;
}

}  // namespace poise
