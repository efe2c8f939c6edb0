#include "statics/all_equilibria/all_equilibria.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "solvers/newton.hpp"
#include "solvers/parallel.hpp"
#include "solvers/random_stream.hpp"
#include "statics/all_equilibria/private/enclosed_set.hpp"
#include "statics/all_equilibria/private/loop_turns.hpp"
#include "statics/all_equilibria/private/neutral_motions.hpp"
#include "statics/all_equilibria/private/set_words.hpp"
#include "statics/all_equilibria/private/start_sampler.hpp"
#include "statics/all_equilibria/turns.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/equilibrium/settle.hpp"
#include "statics/model/held_rows.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

// Distances of coordinates, rad or mechanism sizes.
constexpr double same_search = 1e-6;               // between ends of searches that count as one
constexpr double same_equilibrium = 1e-9;          // between equilibria, besides what their proofs leave open
constexpr double told_apart = 1e-8;                // equilibria that are nearer to each other may count as one,
constexpr double most_apart = 1e-6;                // or at singular poses, where boxes remain larger, than up to this
constexpr std::size_t most_boxes_searched = 1000;  // undecided ones, for equilibria
constexpr int assembly_searches = 24;              // for curves of poses, where turns of loops are told apart
constexpr double same_energy = 1e-9;               // of the mechanism's energy: neutral equilibria of one curve

using Clock = std::chrono::steady_clock;

class Finder {
 public:
  Finder(const StaticModel& model, const AllEquilibriaOptions& options, const Enclosing& enclose)
      : model_(model), options_(options), enclose_(enclose), turns_(model) {}

  EquilibriumSet run() {
    const auto begin = Clock::now();
    start_ = options_.assemblies ? locked_start() : assemble(model_);
    if (wants_proof() && !options_.assemblies) find_neutral_motions();
    loops_.emplace(searched(), turns_, start_);
    if (wants_proof()) prove();
    if (!proof_.applies || !out_.undecided.empty()) sample();
    const std::vector<Release> releases = settle_all();
    contradicted_ = is_contradicted();
    order(releases);
    conclude();
    out_.interrupted = is_interrupted() || proof_.interrupted;
    out_.microseconds = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
    return std::move(out_);
  }

 private:
  // An unstable equilibrium with one unstable direction, where its two sides settle (-1: nowhere), and the energies
  // from there up to it, J.
  struct Release {
    int over = -1;
    int ends[2] = {-1, -1};
    double heights[2] = {};
  };

  bool wants_proof() const { return !options_.seconds || *options_.seconds > 0.0; }

  bool is_interrupted() const { return options_.interrupt != nullptr && options_.interrupt->load(); }

  solvers::ParallelOptions parallel() const { return {.jobs = options_.jobs, .interrupt = options_.interrupt}; }

  // The closed start of a mechanism that cannot move.
  std::vector<double> locked_start() const {
    const Mechanism<double>& m = model_.mechanism();
    if (m.coordinates() == 0) {
      throw InputError(where(model_) + "nothing can move; expected loops that can be closed in several ways");
    }
    const Mobility mobility = analyse_mobility(model_);
    expect_closed(model_, mobility);
    if (const int freedoms = freedoms_of(model_, mobility.x); freedoms > 0) {
      throw InputError(fmt::format(
          "{}{} left; expected none where assemblies are sought: drive or hold the mechanism", where(model_),
          number_of(static_cast<std::size_t>(freedoms), "degree of freedom is", "degrees of freedom are")));
    }
    return mobility.x;
  }

  // Along these every pose is an equilibrium if one is: one is sought with them fixed where they start.
  void find_neutral_motions() {
    neutral_ = neutral_motions(model_, start_);
    if (!neutral_.any()) return;
    if (!neutral_.branch || !neutral_.lead_everywhere(model_.mechanism().coordinates())) {
      fixed_.emplace(with_motions_fixed(model_, neutral_, start_), model_.scales());
    }
    for (const NeutralMotions::Motion& motion : neutral_.motions) {
      EquilibriumSet::Balanced& out = out_.balanced.emplace_back();
      for (const int i : motion.coordinates) {
        out.coordinates.push_back(model_.layout().coordinates[static_cast<std::size_t>(i)].name);
      }
      out.exact = motion.exact;
      out.effort = motion.effort;
      out.is_force = model_.layout().is_length(motion.fixed);
      if (!neutral_.branch) continue;
      out.gap = neutral_.branch->gap * model_.scales().length;
      for (std::size_t i = 0; i < neutral_.branch->leader.size(); ++i) {
        if (neutral_.branch->leader[i] < 0) out.keeping.push_back(model_.layout().coordinates[i].name);
      }
    }
  }

  // The mechanism of which the set is proved, but for poses of a neutral branch.
  const StaticModel& searched() const { return fixed_ && !neutral_.branch ? *fixed_ : model_; }

  // --- places ----------------------------------------------------------------------------------------------

  // The curves of poses of a mechanism with one freedom, in all assembly modes that random poses lead to.
  void find_curves() {
    solvers::Newton closing(model_.problem());
    for (int k = 0; k < assembly_searches && !options_.assemblies && !is_interrupted(); ++k) {
      const auto x = random_closed_pose(closing, start_, M_PI,
                                        solvers::RandomStream(options_.seed, 1, static_cast<std::uint64_t>(k)));
      if (x) loops_->add(*x);
    }
  }

  // Takes over what is proved; a place whose equilibrium has no certificate remains undecided.
  void prove() {
    // An assembly mode that is met first here has turns of its own, which the boxes did not cover.
    AllEquilibriaOptions left = options_;
    for (bool more = true; more;) {
      const auto begin = Clock::now();
      proof_ = enclose_(searched(), *loops_, left, {neutral_.branch ? &neutral_ : nullptr});
      const std::size_t before = loops_->curves();
      if (loops_->known()) {
        for (const std::vector<double>& x : proof_.found) loops_->add(x);
      }
      if (left.seconds) *left.seconds -= std::chrono::duration<double>(Clock::now() - begin).count();
      left.work -= static_cast<double>(proof_.boxes) * work_of_a_box(model_.mechanism().coordinates());
      more = proof_.applies && !proof_.interrupted && loops_->curves() > before;
    }
    if (neutral_.branch) add_branch(left);
    out_.singular = std::move(proof_.singular);
    out_.decided = proof_.decided;
    out_.boxes = proof_.boxes;
    if (!proof_.applies) {
      // What an unfinished proof has found is there all the same.
      out_.undecided = std::move(proof_.undecided);
      for (const std::vector<double>& x : proof_.found) {
        if (loops_->reaches(x)) add(examine_at(x));
      }
      by_proof_ = !out_.equilibria.empty();
      return;
    }
    out_.angles_within = proof_.reach;
    for (const std::vector<double>& x : proof_.found) {
      if (!loops_->reaches(x)) {
        unreached_ = true;
        continue;
      }
      Equilibrium equilibrium = examine(turns_.reduced(x));
      const bool is_there = turns_.distance(equilibrium.x, x) <= same_search;
      const std::string why = equilibrium.found() ? "the search from there left it" : equilibrium.certificate.statement;
      if (!is_there || add(std::move(equilibrium)) < 0) {
        out_.undecided.push_back({x, x, false, "one equilibrium, of which nothing more is proved: " + why});
      }
    }
    for (std::size_t k = 0; k < proof_.undecided.size(); ++k) {
      UndecidedBox& box = proof_.undecided[k];
      if (k < most_boxes_searched && is_one_place(box)) {
        ++close_;
      } else {
        out_.undecided.push_back(std::move(box));
      }
    }
    enclosed_ = out_.equilibria.size();
  }

  // Equilibria on the neutral branch: with its motions fixed where they start, and what is in loops there.
  void add_branch(const AllEquilibriaOptions& left) {
    if (!fixed_) {
      proof_.found.push_back(start_);
      return;
    }
    const Turns turns(*fixed_);
    LoopTurns loops(*fixed_, turns, start_);
    EnclosedPart part;
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const bool is_in_loop = neutral_.branch->is_in_loop[i] != 0;
      part.within.push_back(is_in_loop ? Interval(start_[i] - same_search, start_[i] + same_search)
                                       : Interval::entire());
    }
    EnclosedSet on_branch = enclose_(*fixed_, loops, left, part);
    const auto append = [](auto& to, auto& from) { std::move(from.begin(), from.end(), std::back_inserter(to)); };
    append(proof_.found, on_branch.found);
    append(proof_.undecided, on_branch.undecided);
    append(proof_.singular, on_branch.singular);
    proof_.peaks.add(on_branch.peaks);
    proof_.decided = 0.5 * (proof_.decided + on_branch.decided);
    proof_.boxes += on_branch.boxes;
    proof_.interrupted = proof_.interrupted || on_branch.interrupted;
    if (proof_.within.empty()) proof_.within = on_branch.within;
    if (proof_.applies && !on_branch.applies) {
      proof_.applies = false;
      proof_.why_not = on_branch.why_not;
    }
  }

  // Adds the equilibrium in the box that a search from its middle leads to. Whether that is all that can be told of
  // it: equilibria at the limit of a stop or spring, folds and the like are in boxes that no proof makes any smaller.
  bool is_one_place(UndecidedBox& box) {
    std::vector<double> middle = box.lower;
    double widest = 0.0;
    for (std::size_t i = 0; i < middle.size(); ++i) {
      middle[i] += 0.5 * (box.upper[i] - box.lower[i]);
      widest = std::max(widest, box.upper[i] - box.lower[i]);
    }
    Equilibrium equilibrium = examine(turns_.reduced(middle));
    const bool is_confirmed = equilibrium.certificate.confirmed() && !is_neutral(equilibrium.certificate);
    if (is_neutral(equilibrium.certificate) && is_in(box, equilibrium.x)) {
      box.neutral = true;
      box.why = neutral_curve;
    }
    if (!is_in(box, equilibrium.x) || add(std::move(equilibrium)) < 0 || !is_confirmed) return false;
    if (!(widest < most_apart)) return false;
    while (close_within_ < widest) close_within_ *= 10.0;
    return true;
  }

  // Whether some full turns bring x into the box.
  bool is_in(const UndecidedBox& box, const std::vector<double>& at) const {
    const std::vector<double> x = neutral_.moved_to(start_, at);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double half = 0.5 * (box.upper[i] - box.lower[i]);
      double apart = x[i] - (box.lower[i] + half);
      if (!model_.layout().is_length(static_cast<int>(i))) apart = std::remainder(apart, 2.0 * M_PI);
      if (!(std::abs(apart) <= half + same_search)) return false;
    }
    return true;
  }

  // Whether an equilibrium was found where the proof leaves none.
  bool is_contradicted() const {
    if (!proof_.applies) return false;
    return std::any_of(out_.equilibria.begin() + static_cast<std::ptrdiff_t>(enclosed_), out_.equilibria.end(),
                       [&](const Equilibrium& equilibrium) {
                         const auto holds_it = [&](const UndecidedBox& box) { return is_in(box, equilibrium.x); };
                         return is_within_reach(equilibrium.x) &&
                                std::none_of(out_.undecided.begin(), out_.undecided.end(), holds_it) &&
                                std::none_of(out_.singular.begin(), out_.singular.end(), holds_it);
                       });
  }

  // Whether the proof speaks of it: not after more rounds of its loops, for example.
  bool is_within_reach(const std::vector<double>& x) const {
    if (!loops_->reaches(x)) return false;
    for (std::size_t i = 0; proof_.reach && i < x.size(); ++i) {
      if (turns_.count(static_cast<int>(i)) && std::abs(x[i] - start_[i]) > *proof_.reach) return false;
    }
    return true;
  }

  void sample() {
    if (loops_->is_followed() && options_.starts > 0) {
      loops_->add(start_);
      find_curves();
    }
    const StartSampler sampler(model_, turns_, *loops_, options_);
    std::vector<std::vector<double>> ends(static_cast<std::size_t>(std::max(0, options_.starts)));
    solvers::ParallelOptions settings = parallel();
    if (options_.searched) settings.progress = [&](std::size_t done) { options_.searched(static_cast<int>(done)); };
    out_.starts = static_cast<int>(
        solvers::parallel_for(ends.size(), settings, [&](std::size_t k) { ends[k] = sampler.run(k); }));
    const std::size_t by_chance = ends.size();
    if (loops_->known()) {
      for (const std::vector<double>& end : ends) {
        if (!end.empty()) loops_->add(end);
      }
    }
    if (options_.starts > 0) {
      for (const std::vector<double>& x : loops_->changes_of_force()) ends.push_back(sampler.from(x, false));
    }
    add_all(ends, by_chance);
  }

  // Certifies the places, each once, and adds those that are new. Empty ones are left out. The first `by_chance` are
  // ends of random starts.
  void add_all(const std::vector<std::vector<double>>& ends, std::size_t by_chance) {
    std::vector<std::vector<double>> places;
    std::vector<int> hits;
    for (std::size_t e = 0; e < ends.size(); ++e) {
      const std::vector<double>& end = ends[e];
      if (end.empty() || !loops_->reaches(end)) continue;
      auto known = static_cast<std::size_t>(
          std::find_if(places.begin(), places.end(),
                       [&](const std::vector<double>& place) { return turns_.distance(place, end) <= same_search; }) -
          places.begin());
      if (known == places.size()) {
        places.push_back(turns_.reduced(end));
        hits.push_back(0);
      }
      // What a search along a curve meets is not met once by chance.
      hits[known] += e < by_chance ? 1 : 2;
    }
    // After an interrupt too: what was found is kept.
    std::vector<Equilibrium> found(places.size());
    solvers::parallel_for(places.size(), {.jobs = options_.jobs},
                          [&](std::size_t k) { found[k] = examine(places[k]); });
    std::vector<int> met;  // of each equilibrium, the starts that led to it
    for (std::size_t k = 0; k < found.size(); ++k) {
      const int place = add(std::move(found[k]));
      met.resize(out_.equilibria.size(), 0);
      (place < 0 ? unproved_ : met[static_cast<std::size_t>(place)]) += hits[k];
    }
    out_.met_once = static_cast<int>(std::count(met.begin(), met.end(), 1));
  }

  // The equilibrium at x, certified.
  Equilibrium examine(const std::vector<double>& x) const {
    SolveOptions solving;
    solving.seek = Seek::any;
    solving.certificate = options_.certificate;
    solving.safeguards.restarts = solving.safeguards.load_stepping = false;
    return solve(model_, x, solving);
  }

  // Examines x; there is none where the search from x leaves it, as it can near singular poses.
  Equilibrium examine_at(const std::vector<double>& x) const {
    Equilibrium out = examine(turns_.reduced(x));
    return turns_.distance(out.x, x) <= same_search ? out : Equilibrium();
  }

  // The place of the equilibrium among those found, or -1.
  int place_of(const Equilibrium& equilibrium) const {
    const auto found = std::find_if(out_.equilibria.begin(), out_.equilibria.end(),
                                    [&](const Equilibrium& known) { return is_same(known, equilibrium); });
    return found == out_.equilibria.end() ? -1 : static_cast<int>(found - out_.equilibria.begin());
  }

  // Its place, with those found if it is new; -1 of what is none.
  int add(Equilibrium equilibrium) {
    if (!equilibrium.found() && equilibrium.status != Status::checked) return -1;
    if (const int known = place_of(equilibrium); known >= 0) return known;
    out_.equilibria.push_back(std::move(equilibrium));
    return static_cast<int>(out_.equilibria.size()) - 1;
  }

  bool is_same(const Equilibrium& a, const Equilibrium& b) const {
    const Certificate &p = a.certificate, &q = b.certificate;
    const auto place = [&](const Equilibrium& e) { return neutral_.moved_to(start_, e.x); };
    if (turns_.distance(place(a), place(b)) <= std::max(same_equilibrium, p.radius + q.radius)) return true;
    if (neutral_.contain(a.x) || neutral_.contain(b.x)) return false;
    // Of a curve or more of them the coordinates that are called arbitrary differ from place to place, and the stops.
    if (!is_neutral(p) || !is_neutral(q)) return false;
    const double apart = std::abs(a.energy.value_or(0.0) - b.energy.value_or(0.0));
    return p.neutral_directions == q.neutral_directions && p.unstable_directions == q.unstable_directions &&
           apart <= same_energy * model_.scales().energy();
  }

  // --- settling --------------------------------------------------------------------------------------------

  std::vector<Release> settle_all() {
    std::vector<Release> out;
    if (options_.assemblies) {
      out_.settles_into = add(examine(turns_.reduced(start_)));
      if (out_.settles_into < 0) out_.settles_nowhere = "nothing is proved of the way in which the start closes";
      return out;
    }
    if (is_interrupted()) return out;
    if (!options_.settling) return out;
    settle_start();
    if (!model_.mechanism().has_follower_loads()) out = release_all();
    return out;
  }

  void settle_start() {
    SolveOptions solving;
    solving.certificate = options_.certificate;
    solving.interrupt = options_.interrupt;
    const Equilibrium settled = solve(model_, start_, solving);
    if (settled.found()) {
      // Most often it is one of those found, and certified, before.
      out_.settles_into = place_of(settled);
      if (out_.settles_into < 0) out_.settles_into = add(examine_at(settled.x));
    } else {
      out_.settles_nowhere = settled.why;
    }
  }

  std::vector<Release> release_all() {
    std::vector<Release> out;
    for (std::size_t k = 0; k < out_.equilibria.size(); ++k) {
      const Certificate& certificate = out_.equilibria[k].certificate;
      if (certificate.stability == Stability::unstable && certificate.unstable_directions == 1) {
        out.push_back({.over = static_cast<int>(k)});
      }
    }
    struct Side {
      std::optional<Equilibrium> end;
      double height = 0.0;
    };
    std::vector<std::vector<Side>> sides(out.size());
    solvers::parallel_for(out.size(), parallel(), [&](std::size_t k) {
      const std::vector<double>& top = out_.equilibria[static_cast<std::size_t>(out[k].over)].x;
      const Settling settling = settle(model_, top, {.interrupt = options_.interrupt});
      if (settling.end != Settling::End::start_unstable) return;
      for (const Settling::Side& side : settling.sides) {
        Side& one = sides[k].emplace_back();
        if (side.end != Settling::End::settled) continue;
        // Before the angles are turned back: a torque's energy counts turns.
        one.height = energy_at(model_, top).value_or(0.0) - energy_at(model_, side.x).value_or(0.0);
        one.end = examine_at(side.x);
      }
    });
    for (std::size_t k = 0; k < out.size(); ++k) {
      for (std::size_t s = 0; s < std::min<std::size_t>(2, sides[k].size()); ++s) {
        if (!sides[k][s].end) continue;
        out[k].ends[s] = add(std::move(*sides[k][s].end));
        out[k].heights[s] = sides[k][s].height;
      }
    }
    return out;
  }

  // --- the answer ------------------------------------------------------------------------------------------

  // Orders equilibria by energy, those of one energy by their coordinates, and the indices with them.
  void order(const std::vector<Release>& releases) {
    std::vector<Equilibrium>& all = out_.equilibria;
    const auto rank = [&](int k) {
      const std::optional<double>& energy = all[static_cast<std::size_t>(k)].energy;
      return std::llround(energy.value_or(0.0) / (same_energy * model_.scales().energy()));
    };
    std::vector<int> old(all.size());
    std::iota(old.begin(), old.end(), 0);
    std::sort(old.begin(), old.end(), [&](int a, int b) {
      const auto rank_a = rank(a), rank_b = rank(b);
      return rank_a != rank_b ? rank_a < rank_b
                              : all[static_cast<std::size_t>(a)].x < all[static_cast<std::size_t>(b)].x;
    });
    std::vector<Equilibrium> ordered;
    std::vector<int> place(all.size());
    for (const int k : old) {
      place[static_cast<std::size_t>(k)] = static_cast<int>(ordered.size());
      ordered.push_back(std::move(all[static_cast<std::size_t>(k)]));
    }
    all = std::move(ordered);
    const auto now = [&](int k) { return k < 0 ? -1 : place[static_cast<std::size_t>(k)]; };
    out_.settles_into = now(out_.settles_into);
    for (const Release& release : releases) {
      const int ends[] = {now(release.ends[0]), now(release.ends[1])};
      if (ends[0] < 0 || ends[1] < 0 || ends[0] == ends[1]) continue;
      for (const int s : {0, 1}) keep_lowest({ends[s], ends[1 - s], now(release.over), release.heights[s]});
    }
    std::sort(out_.barriers.begin(), out_.barriers.end(),
              [](const auto& a, const auto& b) { return std::pair(a.from, a.to) < std::pair(b.from, b.to); });
  }

  void keep_lowest(const EquilibriumSet::Barrier& barrier) {
    const auto known = std::find_if(out_.barriers.begin(), out_.barriers.end(), [&](const EquilibriumSet::Barrier& b) {
      return b.from == barrier.from && b.to == barrier.to;
    });
    if (known == out_.barriers.end()) {
      out_.barriers.push_back(barrier);
    } else if (barrier.energy < known->energy) {
      *known = barrier;
    }
  }

  void conclude() {
    const bool is_proved = proof_.applies && !contradicted_;
    out_.claim = !is_proved ? Claim::sampled : out_.undecided.empty() ? Claim::complete : Claim::incomplete;
    out_.statement = statement_of(out_, {.model = model_,
                                         .options = options_,
                                         .neutral = neutral_,
                                         .proof = proof_,
                                         .loops = *loops_,
                                         .wants_proof = wants_proof(),
                                         .fixes_motions = fixed_.has_value(),
                                         .contradicted = contradicted_,
                                         .by_proof = by_proof_,
                                         .unreached = unreached_,
                                         .unproved = unproved_,
                                         .close = close_,
                                         .close_within = close_within_});
  }

  const StaticModel& model_;
  const AllEquilibriaOptions& options_;
  const Enclosing& enclose_;
  Turns turns_;
  NeutralMotions neutral_;
  std::optional<StaticModel> fixed_;  // with these fixed
  std::optional<LoopTurns> loops_;
  std::vector<double> start_;
  EnclosedSet proof_;
  EquilibriumSet out_;
  std::size_t enclosed_ = 0;  // equilibria that the proof led to
  bool contradicted_ = false;
  int close_ = 0;  // boxes that hold an equilibrium, and perhaps others next to it
  double close_within_ = told_apart;
  bool by_proof_ = false;   // whether a proof that was not finished found some
  bool unreached_ = false;  // whether the proof found some that motion does not reach
  int unproved_ = 0;        // searches
};

}  // namespace

std::string to_string(Claim claim) {
  switch (claim) {
    case Claim::complete:
      return "complete";
    case Claim::incomplete:
      return "incomplete";
    case Claim::sampled:
      return "sampled";
  }
  return "unknown";
}

bool is_change_point(const Equilibrium& equilibrium) {
  return equilibrium.found() && equilibrium.certificate.outcome == Outcome::degenerate &&
         equilibrium.certificate.singular;
}

Scene positions_alone(Scene scene) {
  scene.gravity = {};
  scene.elements.clear();
  scene.forces.clear();
  scene.torques.clear();
  return scene;
}

EquilibriumSet all_equilibria(const StaticModel& model, const AllEquilibriaOptions& options) {
  return all_equilibria(model, options, enclose_equilibria);
}

EquilibriumSet all_equilibria(const StaticModel& model, const AllEquilibriaOptions& options, const Enclosing& enclose) {
  refuse_contacts(model.scene(), "sets of equilibria");
  refuse_blades(model.scene(), "sets of equilibria");
  return Finder(model, options, enclose).run();
}

}  // namespace poise
