#include "statics/all_equilibria/private/enclosed_set.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "solvers/parallel.hpp"
#include "statics/all_equilibria/private/assembly_modes.hpp"
#include "statics/all_equilibria/private/box_prover.hpp"
#include "statics/all_equilibria/private/open_angles.hpp"
#include "statics/all_equilibria/turns.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/interval_mechanism.hpp"
#include "statics/model/mobility.hpp"

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
      if (allowance_.interrupted()) stopped_ = true;  // 64 boxes of a long chain take seconds
      BoxProver::Verdict verdict;
      {
        const solvers::RoundingUp up;
        verdict =
            task.winding == nullptr ? prover.examine(task.box) : prover.examine(task.box, *task.winding, task.rounds);
      }
      if (verdict.decision == BoxProver::Decision::unique) chunk.found.push_back(std::move(verdict.at));
      task.joint_force = verdict.joint_force;
      if (verdict.decision == BoxProver::Decision::locked) chunk.locked.push_back(task);
      if (verdict.decision == BoxProver::Decision::crossing) chunk.crossings.push_back(task);
      if (verdict.decision != BoxProver::Decision::open) {
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
      states = {StopState::permanent};
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

// The words say that an element may have no length in the box; there are none if no element may.
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

// How many freedoms the permanent rows leave: not fewer than the coordinates that none of them touches, since rows may
// repeat others in ways that are not counted.
int freedoms_left(const Mechanism<double>& mechanism, int repeated) {
  const std::vector<int> permanent = permanent_rows(mechanism);
  std::set<int> touched;
  for (std::size_t entry = 0; entry < mechanism.jacobian_row().size(); ++entry) {
    if (std::find(permanent.begin(), permanent.end(), mechanism.jacobian_row()[entry]) != permanent.end())
      touched.insert(mechanism.jacobian_column()[entry]);
  }
  return mechanism.coordinates() -
         std::min(static_cast<int>(permanent.size()) - repeated, static_cast<int>(touched.size()));
}

// The steps of enclose_equilibria(): what the boxes must cover, what the proof says nothing of, and the search.
class Enclosure {
 public:
  Enclosure(const StaticModel& model, LoopTurns& loops, const AllEquilibriaOptions& options,
            const EnclosedPart& part_of_all)
      : allowance_(model, options),
        model_(model),
        mechanism_(model.mechanism()),
        loops_(loops),
        options_(options),
        part_of_all_(part_of_all),
        turns_(model),
        start_(model.start()),
        mobility_(analyse_mobility(model)),
        repeated_(repeated_rows(model, mobility_.x)),
        freedoms_(freedoms_left(mechanism_, repeated_)),
        whole_(static_cast<std::size_t>(mechanism_.coordinates())) {}

  EnclosedSet run() {
    if (!choose_cases()) return std::move(out_);
    if (loops_.known()) find_assembly_modes(model_, repeated_, loops_, stopped_);
    if (repeated_ > 0 && !examine_repeating_joints()) return std::move(out_);
    limit_angles();
    limit_travels();
    describe_limits();
    divide();
    search();
    return std::move(out_);
  }

 private:
  bool refuse(std::string why) {
    out_.why_not = std::move(why);
    return false;
  }

  bool is_open() const { return mechanism_.closures() == 0; }
  int angles() const { return model_.layout().angles; }
  std::string repeating() const { return fmt::format("{}", fmt::join(mobility_.redundant, ", ")); }

  // Finds the combinations of active stops. False where the proof does not treat them.
  bool choose_cases() {
    for (int s = 0; s < mechanism_.stops(); ++s) {
      const Stop& stop = model_.scene().stops[s];
      if (stop.on.kind == Measure::Kind::distance && stop.max <= 0.0) {
        return refuse(fmt::format("stop '{}' is a distance that is held at zero", stop.name));
      }
    }
    cases_ = cases_of(mechanism_, freedoms_);
    return cases_.empty() ? refuse("its stops can be active in too many combinations") : true;
  }

  // Finds the poses in which joints that repeat others at the start hold the mechanism, of which the search knows
  // nothing. False where it cannot be told that these are all.
  bool examine_repeating_joints() {
    RigidPoses rigid;
    if (freedoms_ == 1) rigid = find_rigid_poses(model_, repeated_, loops_, stopped_);
    for (const std::vector<double>& pose : rigid.poses) {
      if (loops_.known()) loops_.add(pose);
    }
    is_checked_ = rigid.are_all && (rigid.poses.empty() || !turns_.count() || loops_.known());
    if (!is_checked_ && (!rigid.poses.empty() || has_stiffer_poses(model_, mobility_.x, freedoms_, stopped_))) {
      return refuse(fmt::format("the joints that repeat others at the start ({}) do not repeat them in all positions",
                                repeating()));
    }
    for (const std::vector<double>& pose : rigid.poses) {
      std::vector<double> turned = loops_.at_known_turn(pose);
      if (is_between_stops(mechanism_, turned)) out_.found.push_back(std::move(turned));
    }
    return true;
  }

  // Sets the angles of the whole box: one turn, and where turns count as far as springs, stops and loops let them go,
  // or as far as nothing is known.
  void limit_angles() {
    for (int i = 0; i < mechanism_.coordinates(); ++i) {
      whole_[i] = i >= angles() ? Interval::entire() : Interval(start_[i] - half_turn, start_[i] + half_turn);
      if (turns_.count(i) && is_open()) whole_[i] = Interval::entire();
    }
    const bool are_known =
        !turns_.count() || (is_open() ? OpenAngles(model_, turns_).bound(cases_, whole_) : loops_.known());
    if (are_known) return;
    out_.reach = 2.0 * half_turn;
    for (int i = 0; i < angles(); ++i) {
      if (turns_.count(i)) whole_[i] = Interval(start_[i] - *out_.reach, start_[i] + *out_.reach);
    }
  }

  // Sets its travels, by closures alone, which hold whichever stops are active.
  void limit_travels() {
    BoxProver prover(model_, cases_.front(), repeated_);
    const solvers::RoundingUp up;
    CoordinateBox first = whole_;
    if (!prover.contract(first, false)) first = whole_;
    for (int i = angles(); i < mechanism_.coordinates(); ++i) {
      if (!first[i].bounded()) {
        if (out_.within.empty()) {
          out_.within = fmt::format("with travels of up to {:g} times its size", longest_travel);
        }
        first[i].meet(Interval(-longest_travel, longest_travel));
      }
      whole_[i] = first[i];
    }
  }

  void describe_limits() {
    const auto limit = [&](const std::string& to) { out_.within += (out_.within.empty() ? "" : ", ") + to; };
    if (turns_.count() && !is_open() && !out_.reach && loops_.winds()) {
      limit(fmt::format("with up to {} rounds of its loops each way", LoopTurns::most_rounds));
    }
    if (out_.reach) limit("with angles of bodies on springs, stops or couplings within a full turn of the start");
    if (is_checked_) {
      limit(fmt::format("if the joints that repeat others ({}), checked every {:g} rad, do so between", repeating(),
                        RigidPoses::apart));
    } else if (repeated_ > 0) {
      limit(fmt::format("if the joints that repeat others at the start ({}) do so in all positions", repeating()));
    }
  }

  // Divides the whole into parts. Within a turn of the start all assembly modes are met, and at other turns those that
  // motion leads to. Rounds that wind linear springs up are taken together, others one by one.
  void divide() {
    parts_.push_back({whole_});
    const std::vector<LoopTurns::Range> ranges =
        turns_.count() && !is_open() && !out_.reach ? loops_.ranges() : std::vector<LoopTurns::Range>();
    const std::optional<AngleSprings> springs = mechanism_.stops() == 0 ? angle_springs(model_) : std::nullopt;
    for (const LoopTurns::Range& range : ranges) {
      if (springs) windings_.push_back(winding_of(*springs, range.turns));
    }
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      const LoopTurns::Range& range = ranges[r];
      CoordinateBox part = whole_;
      for (int i = 0; i < angles(); ++i) {
        if (turns_.count(i)) part[i] = Interval(range.lower[i] - LoopTurns::step, range.upper[i] + LoopTurns::step);
      }
      if (springs && range.rounds > 0) {
        parts_.push_back({part, 0.0, &windings_[r], Interval(-range.rounds, range.rounds)});
        continue;
      }
      for (int round = -range.rounds; round <= range.rounds; ++round) {
        parts_.push_back({wound(part, range.turns, round)});
      }
    }
    for (Task& part : parts_) {
      part.share = 1.0 / static_cast<double>(parts_.size());
      for (std::size_t i = 0; i < part_of_all_.within.size(); ++i) {
        if (part_of_all_.within[i].bounded()) part.box[i] = part_of_all_.within[i];
      }
    }
  }

  // Searches the parts in each case of stops.
  void search() {
    out_.applies = true;
    const double share = 1.0 / static_cast<double>(cases_.size());
    for (std::size_t c = 0; c < cases_.size() && out_.applies; ++c) {
      Search search(model_, cases_[c], repeated_, part_of_all_, options_, allowance_, share * static_cast<double>(c),
                    share);
      search.run(parts_);
      out_.decided += share * search.decided();
      take(search);
    }
    if (out_.applies) return;
    out_.why_not = fmt::format("the proof was not finished {}after {} boxes, with {:.2g} % of the volume decided",
                               options_.seconds ? fmt::format("in {:g} s, ", *options_.seconds) : "", out_.boxes,
                               100 * out_.decided);
  }

  // Takes over what a search found and left; the proof does not apply where it was stopped.
  void take(const Search& search) {
    out_.found.insert(out_.found.end(), search.found.begin(), search.found.end());
    out_.boxes += search.boxes;
    out_.peaks.add(search.peaks);
    out_.interrupted = out_.interrupted || (search.stopped() && allowance_.interrupted());
    for (UndecidedBox& box : search.stopped() ? around(search.left()) : joined(model_, turns_, search.left())) {
      out_.undecided.push_back(std::move(box));
      describe(model_, search.stopped(), options_, out_.undecided.back());
    }
    for (UndecidedBox& box : joined(model_, turns_, search.locked())) {
      box.why = "the closures lose rank in it";
      out_.singular.push_back(std::move(box));
    }
    if (search.stopped()) out_.applies = false;
  }

  Allowance allowance_;
  const StaticModel& model_;
  const Mechanism<double>& mechanism_;
  LoopTurns& loops_;
  const AllEquilibriaOptions& options_;
  const EnclosedPart& part_of_all_;
  const Turns turns_;
  const std::vector<double> start_;
  const Mobility mobility_;
  const int repeated_;
  const int freedoms_;
  // It is asked before every box, and so counts them.
  const std::function<bool()> stopped_ = [this] {
    allowance_.use(1);
    return allowance_.over();
  };
  std::vector<std::vector<StopState>> cases_;
  CoordinateBox whole_;
  bool is_checked_ = false;  // joints that repeat others do so wherever they were looked at
  std::vector<Winding> windings_;
  std::vector<Task> parts_;
  EnclosedSet out_;
};

}  // namespace

EnclosedSet enclose_equilibria(const StaticModel& model, LoopTurns& loops, const AllEquilibriaOptions& options,
                               const EnclosedPart& part_of_all) {
  return Enclosure(model, loops, options, part_of_all).run();
}

}  // namespace poise
