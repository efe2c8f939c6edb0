#include "statics/enclosed_set.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include <Eigen/LU>
#include <fmt/format.h>

#include "solvers/parallel.hpp"
#include "statics/assembly_modes.hpp"
#include "statics/box_prover.hpp"
#include "statics/curvature.hpp"
#include "statics/held_rows.hpp"
#include "statics/interval_mechanism.hpp"
#include "statics/mobility.hpp"
#include "statics/turns.hpp"

namespace poise {
namespace {

constexpr std::size_t most_cases = 729;       // combinations of stops
constexpr std::size_t most_set_aside = 2000;  // boxes at one of the widths
constexpr std::size_t most_chunks = 64;       // of a round of the search
constexpr double most_boxes_of_chunk = 512;   // in a round
constexpr double half_turn = 3.1416;          // a little more
constexpr double narrow_for_rounds = 0.05;    // boxes below are taken round by round
constexpr double longest_travel = 1e6;        // mechanism sizes, where no loop bounds it
// Widths at which boxes are set aside: equilibria that form a curve fill the first of them.
constexpr double widths[] = {1e-3, 1e-6, 1e-10};

struct Task {
  CoordinateBox box;
  double share = 0.0;  // of the volume
  const Winding* winding = nullptr;
  Interval rounds{};
  double joint_force = 0.0;  // that an equilibrium in it needs
};

// The box after N rounds.
CoordinateBox wound(CoordinateBox box, const std::vector<int>& turns, double rounds) {
  const solvers::RoundingUp up;
  for (std::size_t i = 0; i < box.size(); ++i) {
    if (turns[i] != 0) box[i] += Interval(rounds * turns[i]) * solvers::full_turn;
  }
  return box;
}

// What a proof may take: boxes, or seconds where a person asked for them.
class Allowance {
 public:
  explicit Allowance(const StaticModel& model, const AllEquilibriaOptions& options)
      : interrupt_(options.interrupt),
        boxes_(options.seconds ? std::numeric_limits<double>::infinity()
                               : std::floor(options.work / work_of_a_box(model.mechanism().coordinates()))) {
    if (options.seconds) {
      end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(std::min(*options.seconds, 1e9)));
    }
  }

  double boxes() const { return boxes_; }
  void use(long boxes) { boxes_ -= static_cast<double>(boxes); }

  bool interrupted() const { return interrupt_ != nullptr && *interrupt_; }
  bool over() const { return boxes_ <= 0.0 || (end_ && Clock::now() > *end_) || interrupted(); }

 private:
  using Clock = std::chrono::steady_clock;
  const std::atomic<bool>* interrupt_;
  double boxes_;
  std::optional<Clock::time_point> end_{};
};

// All boxes of one case of stops. Threads take them in rounds of chunks, so that what is examined before the allowance
// is over does not depend on how many there are.
class Search {
 public:
  Search(const StaticModel& model, const std::vector<StopState>& stops, int repeated, const EnclosedPart& part,
         const AllEquilibriaOptions& options, Allowance& allowance, double share_before, double share)
      : model_(model),
        stops_(stops),
        repeated_(repeated),
        part_(part),
        options_(options),
        allowance_(allowance),
        share_before_(share_before),
        share_(share) {}

  void run(const std::vector<Task>& parts) {
    waiting_ = parts;
    for (const double width : widths) {
      width_ = width;
      while (!waiting_.empty() && !stopped_) run_round();
      // Around a pose where closures lose rank, and along curves of equilibria, smaller boxes are only more boxes.
      if (stopped_ || left_.size() > most_set_aside) break;
      if (width == widths[std::size(widths) - 1]) break;
      waiting_ = std::move(left_);
      left_.clear();
      if (waiting_.empty()) break;
    }
    for (std::vector<Task>* others : {&waiting_, &crossings_}) {
      std::move(others->begin(), others->end(), std::back_inserter(left_));
    }
  }

  std::vector<std::vector<double>> found;
  ElementPeaks peaks;
  long boxes = 0;

  bool stopped() const { return stopped_; }
  double decided() const { return decided_; }
  const std::vector<Task>& left() const { return left_; }
  const std::vector<Task>& locked() const { return locked_; }

 private:
  // A part of a round, which one thread works on: the boxes that wait, the last first, and what became of them.
  struct Chunk {
    std::vector<Task> waiting{}, left{}, crossings{}, locked{};
    std::vector<std::vector<double>> found{};
    ElementPeaks peaks{};
    long boxes = 0;
    double decided = 0.0;
  };

  void run_round() {
    std::vector<Chunk> chunks(std::min(most_chunks, waiting_.size()));
    for (std::size_t k = 0; k < waiting_.size(); ++k) {
      chunks[k % chunks.size()].waiting.push_back(std::move(waiting_[k]));
    }
    waiting_.clear();
    const double each = std::ceil(allowance_.boxes() / static_cast<double>(chunks.size()));
    const long most = std::max(1L, static_cast<long>(std::min(each, most_boxes_of_chunk)));
    solvers::parallel_for(chunks.size(), {.jobs = options_.jobs}, [&](std::size_t k) { work_on(chunks[k], most); });
    for (Chunk& chunk : chunks) {
      std::move(chunk.found.begin(), chunk.found.end(), std::back_inserter(found));
      std::move(chunk.left.begin(), chunk.left.end(), std::back_inserter(left_));
      std::move(chunk.crossings.begin(), chunk.crossings.end(), std::back_inserter(crossings_));
      std::move(chunk.locked.begin(), chunk.locked.end(), std::back_inserter(locked_));
      std::move(chunk.waiting.begin(), chunk.waiting.end(), std::back_inserter(waiting_));
      peaks.add(chunk.peaks);
      boxes += chunk.boxes;
      decided_ += chunk.decided;
      allowance_.use(chunk.boxes);
    }
    if (!waiting_.empty() && allowance_.over()) stopped_ = true;
  }

  void work_on(Chunk& chunk, long most) {
    BoxProver prover(model_, stops_, repeated_, part_.without_branch_of);
    while (!chunk.waiting.empty() && chunk.boxes < most && !stopped_) {
      Task task = std::move(chunk.waiting.back());
      chunk.waiting.pop_back();
      if (++chunk.boxes % 64 == 0) look_at_clock(chunk.decided);
      BoxProver::Verdict verdict;
      {
        const solvers::RoundingUp up;
        verdict =
            task.winding == nullptr ? prover.examine(task.box) : prover.examine(task.box, *task.winding, task.rounds);
      }
      if (verdict.finding == BoxProver::Finding::unique) chunk.found.push_back(std::move(verdict.at));
      task.joint_force = verdict.joint_force;
      if (verdict.finding == BoxProver::Finding::locked) chunk.locked.push_back(task);
      if (verdict.finding == BoxProver::Finding::crossing) chunk.crossings.push_back(task);
      if (verdict.finding != BoxProver::Finding::open) {
        chunk.decided += task.share;
        continue;
      }
      if (task.winding == nullptr && widest(task.box) < width_) {
        chunk.left.push_back(std::move(task));
        continue;
      }
      if (task.winding != nullptr && task.rounds.lower() == task.rounds.upper()) {
        task.box = wound(std::move(task.box), task.winding->turns, task.rounds.lower());
        task.winding = nullptr;
        chunk.waiting.push_back(std::move(task));
        continue;
      }
      Task other = task;
      if (task.winding != nullptr && widest(task.box) < narrow_for_rounds) {
        const double middle = std::floor(0.5 * (task.rounds.lower() + task.rounds.upper()));
        task.rounds = Interval(task.rounds.lower(), middle);
        other.rounds = Interval(middle + 1, other.rounds.upper());
      } else {
        verdict.cut(task.box, other.box);
      }
      task.share = other.share = 0.5 * task.share;
      chunk.waiting.push_back(std::move(other));
      chunk.waiting.push_back(std::move(task));
    }
    chunk.peaks = prover.peaks();
  }

  // Now and then: time, interrupt and progress, with the share that this chunk has decided.
  void look_at_clock(double decided) {
    if (allowance_.over()) stopped_ = true;
    const std::lock_guard lock(mutex_);
    shown_ = std::max(shown_, decided_ + decided);
    if (options_.progress) options_.progress(share_before_ + share_ * shown_);
  }

  const StaticModel& model_;
  const std::vector<StopState>& stops_;
  const int repeated_;
  const EnclosedPart& part_;
  const AllEquilibriaOptions& options_;
  Allowance& allowance_;
  const double share_before_, share_;
  double width_ = widths[0];
  std::vector<Task> waiting_, left_, crossings_, locked_;
  double decided_ = 0.0, shown_ = 0.0;
  std::mutex mutex_;
  std::atomic<bool> stopped_ = false;
};

// Stops in all combinations of states; empty if there are too many.
std::vector<std::vector<StopState>> cases_of(const Mechanism<double>& mechanism, int freedoms) {
  std::vector<std::vector<StopState>> cases{{}};
  for (int s = 0; s < mechanism.stops(); ++s) {
    const double lower = mechanism.lower()[s];
    const double upper = mechanism.upper()[s];
    std::vector<StopState> states{StopState::inactive};
    if (lower == upper) {
      states = {StopState::held};
    } else {
      if (std::isfinite(lower)) states.push_back(StopState::at_lower);
      if (std::isfinite(upper)) states.push_back(StopState::at_upper);
    }
    std::vector<std::vector<StopState>> more;
    for (const std::vector<StopState>& one : cases) {
      const auto active = std::count_if(one.begin(), one.end(), [](StopState state) {
        return state == StopState::at_lower || state == StopState::at_upper;
      });
      for (const StopState state : states) {
        if (active >= freedoms && (state == StopState::at_lower || state == StopState::at_upper)) continue;
        more.push_back(one);
        more.back().push_back(state);
      }
    }
    cases = std::move(more);
    if (cases.size() > most_cases) return {};
  }
  return cases;
}

// The stiffness of linear springs on angles, K x + K_0 their forces; empty if there are others on angles.
struct AngleSprings {
  std::vector<Interval> at_zero;
  std::vector<int> row, column;  // lower triangle
  std::vector<Interval> stiffness;
};

std::optional<AngleSprings> angle_springs(const StaticModel& model) {
  Scene springs = model.scaled_scene();
  std::erase_if(springs.elements, [](const Element& e) { return !is_sum_of_angles(e.on); });
  for (const Element& e : springs.elements) {
    const auto* spring = std::get_if<LinearSpring>(&e.law);
    if (stores_energy(e.law) && (spring == nullptr || spring->acts != LinearSpring::Acts::both)) return std::nullopt;
  }
  springs.gravity = {};
  springs.forces.clear();
  springs.torques.clear();
  const solvers::RoundingUp up;
  const Mechanism<Interval> mechanism(springs, model.layout(), Purpose::statics);
  const CoordinateBox zero(static_cast<std::size_t>(mechanism.coordinates()));
  std::vector<Planar<Interval>> pose(static_cast<std::size_t>(mechanism.pose_size()));
  const std::vector<Interval> none(static_cast<std::size_t>(mechanism.constraints()));
  AngleSprings out{std::vector<Interval>(zero.size()), mechanism.tangent_row(), mechanism.tangent_column(),
                   std::vector<Interval>(mechanism.tangent_row().size())};
  mechanism.place(zero.data(), pose.data());
  mechanism.negative_force(zero.data(), pose.data(), out.at_zero.data());
  mechanism.tangent(pose.data(), none.data(), out.stiffness.data());
  return out;
}

// What one round of a loop changes in the forces: K times its turns.
Winding winding_of(const AngleSprings& springs, const std::vector<int>& turns) {
  Winding out{turns, std::vector<Interval>(turns.size(), Interval(0))};
  const solvers::RoundingUp up;
  const CoordinateBox by = wound(CoordinateBox(turns.size(), Interval(0)), turns, 1.0);
  for (std::size_t e = 0; e < springs.stiffness.size(); ++e) {
    const auto i = static_cast<std::size_t>(springs.row[e]);
    const auto j = static_cast<std::size_t>(springs.column[e]);
    out.change[i] += springs.stiffness[e] * by[j];
    if (i != j) out.change[j] += springs.stiffness[e] * by[i];
  }
  return out;
}

// Encloses z with A z = b for all A, b of the intervals: with R near A^-1 and E = R A - I, |z - R b| <= |E| / (1 - |E|)
// |R b| in the maximum norm. False if that says nothing. A is row by row.
bool solve_linear(const std::vector<Interval>& a, const std::vector<Interval>& b, std::vector<Interval>& z) {
  const auto size = static_cast<Eigen::Index>(b.size());
  Eigen::MatrixXd middle(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) middle(i, j) = a[static_cast<std::size_t>(i * size + j)].middle();
  }
  const Eigen::MatrixXd inverse = middle.fullPivLu().inverse();
  if (!inverse.allFinite()) return false;
  double norm = 0.0;
  double most = 0.0;
  z.clear();
  for (Eigen::Index i = 0; i < size; ++i) {
    double sum = 0.0;
    Interval right(0);
    for (Eigen::Index j = 0; j < size; ++j) {
      Interval error(i == j ? -1 : 0);
      for (Eigen::Index l = 0; l < size; ++l)
        error += Interval(inverse(i, l)) * a[static_cast<std::size_t>(l * size + j)];
      sum += error.magnitude();
      right += Interval(inverse(i, j)) * b[static_cast<std::size_t>(j)];
    }
    if (!(sum < 1) || !right.bounded()) return false;
    norm = std::max(norm, sum);
    most = std::max(most, right.magnitude());
    z.push_back(right);
  }
  const double slack = (Interval(most) * Interval(norm) / (Interval(1) - Interval(norm))).upper();
  for (Interval& value : z) value += Interval(-slack, slack);
  return true;
}

// Bounds of the angles whose turns count, where no loop closes. One that a stop on nothing else limits on both sides is
// between its limits. Of the others, x, and the forces y of active stops on angles
//
//   K x + A^T y = -(forces of everything else) - (those of springs on angles at zero),   A x = limits of these stops
//
// with K the stiffness of linear springs on angles; the forces of everything else are bounded whatever the angles.
class OpenAngles {
 public:
  OpenAngles(const StaticModel& model, const Turns& turns)
      : model_(model),
        mechanism_(model.scaled_scene(), model.layout(), Purpose::statics),
        springs_(angle_springs(model)) {
    for (int i = 0; i < model.layout().angles; ++i) {
      if (turns.count(i)) told_.push_back(i);
    }
    const solvers::RoundingUp up;
    const CoordinateBox zero(static_cast<std::size_t>(mechanism_.coordinates()));
    std::vector<Planar<Interval>> pose(static_cast<std::size_t>(mechanism_.pose_size()));
    at_zero_.resize(static_cast<std::size_t>(mechanism_.constraints()));
    jacobian_.resize(mechanism_.jacobian_row().size());
    mechanism_.place(zero.data(), pose.data());
    mechanism_.constraint(zero.data(), pose.data(), at_zero_.data());
    mechanism_.jacobian(pose.data(), jacobian_.data());
  }

  // Narrows the box to what these equations leave for any of the cases. False if an angle has no bounds in one.
  bool bound(const std::vector<std::vector<StopState>>& cases, CoordinateBox& box) const {
    const solvers::RoundingUp up;
    CoordinateBox limited = box;
    const std::vector<int> unknown = limit_by_stops(limited);
    if (unknown.empty()) {
      box = std::move(limited);
      return true;
    }
    if (!springs_) return false;
    const std::vector<Interval> force = forces(limited);
    std::optional<CoordinateBox> all;
    for (const std::vector<StopState>& stops : cases) {
      CoordinateBox one = limited;
      if (!solve(stops, unknown, force, one)) return false;
      for (std::size_t i = 0; all && i < one.size(); ++i) one[i] = hull(one[i], (*all)[i]);
      all = std::move(one);
    }
    box = std::move(*all);
    return true;
  }

 private:
  // Row s of the stops: its entries as (coordinate, value).
  std::vector<std::pair<int, Interval>> row_of(int stop) const {
    std::vector<std::pair<int, Interval>> out;
    for (std::size_t e = 0; e < jacobian_.size(); ++e) {
      if (mechanism_.jacobian_row()[e] == mechanism_.stop_row(stop))
        out.emplace_back(mechanism_.jacobian_column()[e], jacobian_[e]);
    }
    return out;
  }
  bool is_on_angle(int stop) const { return is_sum_of_angles(model_.scene().stops[static_cast<std::size_t>(stop)].on); }

  // The angles that remain without bounds.
  std::vector<int> limit_by_stops(CoordinateBox& box) const {
    std::vector<int> unknown = told_;
    for (int s = 0; s < mechanism_.stops(); ++s) {
      const std::vector<std::pair<int, Interval>> row = row_of(s);
      const Interval limits(mechanism_.lower()[s].lower(), mechanism_.upper()[s].upper());
      if (!is_on_angle(s) || row.size() != 1 || !limits.bounded()) continue;
      const auto [i, slope] = row.front();
      box[static_cast<std::size_t>(i)].meet((limits - at_zero_[static_cast<std::size_t>(mechanism_.stop_row(s))]) /
                                            slope);
      std::erase(unknown, i);
    }
    return unknown;
  }

  // Of everything but springs and stops on angles.
  std::vector<Interval> forces(const CoordinateBox& box) const {
    Scene others = model_.scaled_scene();
    std::erase_if(others.elements, [](const Element& e) { return is_sum_of_angles(e.on); });
    const Mechanism<Interval> load(others, model_.layout(), Purpose::statics);
    std::vector<Planar<Interval>> pose(static_cast<std::size_t>(load.pose_size()));
    std::vector<Interval> out(box.size());
    load.place(box.data(), pose.data());
    load.negative_force(box.data(), pose.data(), out.data());
    return out;
  }

  bool solve(const std::vector<StopState>& stops, const std::vector<int>& unknown, const std::vector<Interval>& force,
             CoordinateBox& box) const {
    std::vector<int> active;
    for (int s = 0; s < mechanism_.stops(); ++s) {
      const std::vector<std::pair<int, Interval>> row = row_of(s);
      const bool acts = std::any_of(row.begin(), row.end(), [&](const auto& entry) {
        return std::find(unknown.begin(), unknown.end(), entry.first) != unknown.end();
      });
      if (stops[static_cast<std::size_t>(s)] == StopState::inactive || !acts) continue;
      if (!is_on_angle(s)) return false;
      active.push_back(s);
    }
    const std::size_t angles = unknown.size();
    const std::size_t size = angles + active.size();
    std::vector<Interval> a(size * size, Interval(0));
    std::vector<Interval> b(size, Interval(0));
    const auto place = [&](int i) {
      return static_cast<std::size_t>(std::find(unknown.begin(), unknown.end(), i) - unknown.begin());
    };
    const auto add = [&](std::size_t row, int column, const Interval& value) {
      const std::size_t to = place(column);
      if (to < angles)
        a[row * size + to] += value;
      else
        b[row] -= value * box[static_cast<std::size_t>(column)];
    };
    for (std::size_t i = 0; i < angles; ++i) {
      const auto coordinate = static_cast<std::size_t>(unknown[i]);
      b[i] -= force[coordinate] + springs_->at_zero[coordinate];
    }
    for (std::size_t e = 0; e < springs_->stiffness.size(); ++e) {
      const int i = springs_->row[e];
      const int j = springs_->column[e];
      if (place(i) < angles) add(place(i), j, springs_->stiffness[e]);
      if (i != j && place(j) < angles) add(place(j), i, springs_->stiffness[e]);
    }
    for (std::size_t k = 0; k < active.size(); ++k) {
      const auto stop = static_cast<std::size_t>(active[k]);
      const auto& limit = stops[stop] == StopState::at_lower ? mechanism_.lower() : mechanism_.upper();
      b[angles + k] += limit[stop] - at_zero_[static_cast<std::size_t>(mechanism_.stop_row(active[k]))];
      for (const auto& [column, value] : row_of(active[k])) {
        add(angles + k, column, value);
        if (place(column) < angles) a[place(column) * size + angles + k] += value;
      }
    }
    std::vector<Interval> z;
    if (!solve_linear(a, b, z)) return false;
    for (std::size_t i = 0; i < angles; ++i) box[static_cast<std::size_t>(unknown[i])] = z[i];
    return true;
  }

  const StaticModel& model_;
  Mechanism<Interval> mechanism_;
  std::optional<AngleSprings> springs_;
  std::vector<int> told_;
  std::vector<Interval> at_zero_, jacobian_;
};

UndecidedBox undecided(const CoordinateBox& box) { return {lower_corner(box), upper_corner(box), false, "", 0.0}; }

// One box around all, of which there may be many where the search was stopped.
std::vector<UndecidedBox> around(const std::vector<Task>& tasks) {
  if (tasks.empty()) return {};
  CoordinateBox all = tasks.front().box;
  for (const Task& task : tasks) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = hull(all[i], task.box[i]);
  }
  return {undecided(all)};
}

// Joins boxes that touch, turned fully where turns do not count.
std::vector<UndecidedBox> joined(const StaticModel& model, const Turns& turns, const std::vector<Task>& tasks) {
  constexpr double slack = 1e-3;  // near each other is the same place
  std::vector<UndecidedBox> out;
  for (const Task& task : tasks) {
    UndecidedBox box = undecided(task.box);
    box.joint_force = task.joint_force;
    bool grown = true;
    std::vector<double> by(box.lower.size());
    while (grown) {
      grown = false;
      for (std::size_t k = 0; k < out.size() && !grown; ++k) {
        bool touch = true;
        std::fill(by.begin(), by.end(), 0.0);
        for (std::size_t i = 0; i < box.lower.size() && touch; ++i) {
          const bool is_angle = !model.layout().is_length(static_cast<int>(i));
          if (is_angle && !turns.count(static_cast<int>(i))) {
            const double apart = out[k].lower[i] + out[k].upper[i] - box.lower[i] - box.upper[i];
            by[i] = 2 * M_PI * std::round(apart / (4 * M_PI));
          }
          touch = box.lower[i] + by[i] <= out[k].upper[i] + slack && out[k].lower[i] <= box.upper[i] + by[i] + slack;
        }
        if (!touch) continue;
        for (std::size_t i = 0; i < box.lower.size(); ++i) {
          box.lower[i] = std::min(box.lower[i] + by[i], out[k].lower[i]);
          box.upper[i] = std::max(box.upper[i] + by[i], out[k].upper[i]);
        }
        box.joint_force = std::min(box.joint_force, out[k].joint_force);
        out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
        grown = true;
      }
    }
    out.push_back(std::move(box));
  }
  return out;
}

// That an element may have no length in the box, if one may.
std::string element_without_length(const StaticModel& model, const UndecidedBox& box) {
  CoordinateBox place;
  for (std::size_t i = 0; i < box.lower.size(); ++i) place.emplace_back(box.lower[i], box.upper[i]);
  if (!(widest(place) < narrow_for_rounds)) return "";
  const Scene scene = model.scaled_scene();
  const solvers::RoundingUp up;
  const Mechanism<Interval> mechanism(scene, model.layout(), Purpose::statics);
  std::vector<Planar<Interval>> pose(static_cast<std::size_t>(mechanism.pose_size()));
  mechanism.place(place.data(), pose.data());
  for (const Element& element : scene.elements) {
    if (element.on.kind != Measure::Kind::distance || !stores_energy(element.law)) continue;
    if (spring_without_free_length(element) != nullptr) continue;
    const PointRef a = element.on.a;
    const PointRef b = element.on.b;
    const PhasorSum<Interval> between(mechanism.phasors(),
                                      model.layout().path(a.body, scene.local(a), b.body, scene.local(b)));
    const Planar<Interval> d = between.at(pose.data());
    if (d.x.excludes_zero() || d.y.excludes_zero()) continue;
    return std::string(element.family()) + " \"" + element.name +
           "\" may have no length in it, where its force has no direction";
  }
  return "";
}

// What can be said of a box in which nothing is decided.
void describe(const StaticModel& model, bool stopped, const AllEquilibriaOptions& options, UndecidedBox& box) {
  if (stopped) {
    box.why = options.seconds ? "the time allowed was over" : "the boxes allowed were used up";
    return;
  }
  std::vector<double> middle = box.lower;
  for (std::size_t i = 0; i < middle.size(); ++i) middle[i] += 0.5 * (box.upper[i] - box.lower[i]);
  const Certificate certificate = certify(model, middle);
  box.neutral = certificate.outcome == Outcome::neutral;
  const std::string without = element_without_length(model, box);
  box.why = box.neutral            ? neutral_curve
            : !without.empty()     ? without
            : certificate.singular ? "the closures lose rank in it"
                                   : "equilibria in it are degenerate, or too near to each other";
}

// Whether no stop is passed in the pose; those that are just touched are not.
bool is_between_stops(const Mechanism<double>& mechanism, const std::vector<double>& x) {
  constexpr double touching = 1e-9;
  const DensePoint<double> point(mechanism, x, {});
  for (int s = 0; s < mechanism.stops(); ++s) {
    if (passed_by(mechanism, s, point.constraint) > touching) return false;
  }
  return true;
}

}  // namespace

EnclosedSet enclose_equilibria(const StaticModel& model, LoopTurns& loops, const AllEquilibriaOptions& options,
                               const EnclosedPart& part_of_all) {
  Allowance allowance(model, options);
  const Mechanism<double>& mechanism = model.mechanism();
  EnclosedSet out;
  const int n = mechanism.coordinates();
  const std::vector<double> start = model.start();
  const Mobility mobility = analyse_mobility(model);
  const int repeated = repeated_rows(model, mobility.x);
  // Not fewer than the coordinates that no held row touches: rows may repeat others in ways that are not counted.
  const std::vector<int> held = held_rows(mechanism);
  std::set<int> touched;
  for (std::size_t entry = 0; entry < mechanism.jacobian_row().size(); ++entry) {
    if (std::find(held.begin(), held.end(), mechanism.jacobian_row()[entry]) != held.end())
      touched.insert(mechanism.jacobian_column()[entry]);
  }
  const int freedoms = n - std::min(static_cast<int>(held.size()) - repeated, static_cast<int>(touched.size()));
  for (int s = 0; s < mechanism.stops(); ++s) {
    const Stop& stop = model.scene().stops[s];
    if (stop.on.kind == Measure::Kind::distance && stop.max <= 0.0) {
      out.why_not = fmt::format("stop '{}' is a distance that is held at zero", stop.name);
      return out;
    }
  }
  const std::vector<std::vector<StopState>> cases = cases_of(mechanism, freedoms);
  if (cases.empty()) {
    out.why_not = "its stops can be active in too many combinations";
    return out;
  }
  const Turns turns(model);
  CoordinateBox whole(n);
  const int angles = model.layout().angles;
  const bool is_open = mechanism.closures() == 0;
  // Asked before every box, and so counts them.
  const auto stopped = [&] {
    allowance.use(1);
    return allowance.over();
  };
  if (loops.known()) find_assembly_modes(model, repeated, loops, stopped);
  const std::string repeating = fmt::format("{}", fmt::join(mobility.redundant, ", "));
  bool is_checked = false;
  if (repeated > 0) {
    RigidPoses rigid;
    if (freedoms == 1) rigid = find_rigid_poses(model, repeated, loops, stopped);
    for (const std::vector<double>& pose : rigid.poses) {
      if (loops.known()) loops.add(pose);
    }
    is_checked = rigid.are_all && (rigid.poses.empty() || !turns.count() || loops.known());
    if (!is_checked && (!rigid.poses.empty() || has_stiffer_poses(model, mobility.x, freedoms, stopped))) {
      out.why_not =
          fmt::format("the joints that repeat others at the start ({}) do not repeat them in all poses", repeating);
      return out;
    }
    for (const std::vector<double>& pose : rigid.poses) {
      std::vector<double> turned = loops.at_known_turn(pose);
      if (is_between_stops(mechanism, turned)) out.found.push_back(std::move(turned));
    }
  }
  for (int i = 0; i < n; ++i) {
    whole[i] = i >= angles ? Interval::entire() : Interval(start[i] - half_turn, start[i] + half_turn);
    if (turns.count(i) && is_open) whole[i] = Interval::entire();
  }
  const bool are_known = !turns.count() || (is_open ? OpenAngles(model, turns).bound(cases, whole) : loops.known());
  if (!are_known) {
    out.reach = 2.0 * half_turn;
    for (int i = 0; i < angles; ++i) {
      if (turns.count(i)) whole[i] = Interval(start[i] - *out.reach, start[i] + *out.reach);
    }
  }
  {
    BoxProver prover(model, cases.front(), repeated);
    const solvers::RoundingUp up;
    CoordinateBox first = whole;
    // By closures alone, which hold whichever stops are active.
    if (!prover.contract(first, false)) first = whole;
    for (int i = angles; i < n; ++i) {
      if (!first[i].bounded()) {
        if (out.within.empty()) out.within = fmt::format("with travels of up to {:g} times its size", longest_travel);
        first[i].meet(Interval(-longest_travel, longest_travel));
      }
      whole[i] = first[i];
    }
  }
  const auto limit = [&](const std::string& to) { out.within += (out.within.empty() ? "" : ", ") + to; };
  if (turns.count() && !is_open && !out.reach && loops.winds()) {
    limit(fmt::format("with up to {} rounds of its loops each way", LoopTurns::most_rounds));
  }
  if (out.reach) limit("with angles of bodies on springs, stops or couplings within a full turn of the start");
  if (is_checked) {
    limit(fmt::format("if the joints that repeat others ({}), checked every {:g} rad, do so between", repeating,
                      RigidPoses::apart));
  } else if (repeated > 0) {
    limit(fmt::format("if the joints that repeat others at the start ({}) do so in all poses", repeating));
  }
  // Within a turn of the start all assembly modes are met, and at other turns those that motion leads to. Rounds that
  // wind linear springs up are taken together, others one by one.
  std::vector<Task> parts{{whole}};
  const std::vector<LoopTurns::Range> ranges =
      turns.count() && !is_open && !out.reach ? loops.ranges() : std::vector<LoopTurns::Range>();
  const std::optional<AngleSprings> springs = mechanism.stops() == 0 ? angle_springs(model) : std::nullopt;
  std::vector<Winding> windings;
  for (const LoopTurns::Range& range : ranges) {
    if (springs) windings.push_back(winding_of(*springs, range.turns));
  }
  for (std::size_t r = 0; r < ranges.size(); ++r) {
    const LoopTurns::Range& range = ranges[r];
    CoordinateBox part = whole;
    for (int i = 0; i < angles; ++i) {
      if (turns.count(i)) part[i] = Interval(range.lower[i] - LoopTurns::step, range.upper[i] + LoopTurns::step);
    }
    if (springs && range.rounds > 0) {
      parts.push_back({part, 0.0, &windings[r], Interval(-range.rounds, range.rounds)});
      continue;
    }
    for (int round = -range.rounds; round <= range.rounds; ++round) parts.push_back({wound(part, range.turns, round)});
  }
  for (Task& part : parts) {
    part.share = 1.0 / static_cast<double>(parts.size());
    for (std::size_t i = 0; i < part_of_all.within.size(); ++i) {
      if (part_of_all.within[i].bounded()) part.box[i] = part_of_all.within[i];
    }
  }
  out.applies = true;
  const double share = 1.0 / static_cast<double>(cases.size());
  bool finished = true;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    Search search(model, cases[c], repeated, part_of_all, options, allowance, share * static_cast<double>(c), share);
    search.run(parts);
    out.found.insert(out.found.end(), search.found.begin(), search.found.end());
    out.boxes += search.boxes;
    out.peaks.add(search.peaks);
    out.decided += share * search.decided();
    out.interrupted = out.interrupted || (search.stopped() && allowance.interrupted());
    for (UndecidedBox& box : search.stopped() ? around(search.left()) : joined(model, turns, search.left())) {
      out.undecided.push_back(std::move(box));
      describe(model, search.stopped(), options, out.undecided.back());
    }
    for (UndecidedBox& box : joined(model, turns, search.locked())) {
      box.why = "the closures lose rank in it";
      out.singular.push_back(std::move(box));
    }
    if (search.stopped()) {
      finished = false;
      break;
    }
  }
  if (!finished) {
    out.applies = false;
    out.why_not =
        fmt::format("the proof was not finished {}after {} boxes, with {:.2g} % of the volume decided",
                    options.seconds ? fmt::format("in {:g} s, ", *options.seconds) : "", out.boxes, 100 * out.decided);
  }
  return out;
}

}  // namespace poise
