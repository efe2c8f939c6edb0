#include "tests/judge/drag_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "comparison/random.hpp"
#include "model/dependent_number.hpp"
#include "model/parameters.hpp"
#include "statics/model/mobility.hpp"
#include "tests/judge/small_steps.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/mixed_mechanisms.hpp"
#include "tests/support/random_linkages.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/released_scenes.hpp"

namespace poise::judge {
namespace {

using comparison::Random;
using TransitionKind = Transition::Kind;

constexpr double same = 1e-5;          // rad or mechanism sizes
constexpr double same_place = 3e-4;    // of a dragged point at the end of its way, mechanism sizes
constexpr double nudge = 1e-13;        // the same
constexpr double same_picture = 2e-3;  // a point of a picture, rad or mechanism sizes
constexpr double longest_pose = 0.5;   // between poses of a course, rad or mechanism sizes
constexpr double open_within = 1e-6;   // gap of a joint in a course, mechanism sizes

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Numbers of two scenes of one structure, guesses left out.
bool same_numbers(const Scene& a, const Scene& b) {
  const auto rows = parameter_table(a), others = parameter_table(b);
  if (rows.size() != others.size()) return false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!(rows[i].place == others[i].place)) return false;
    if (rows[i].place.owner == Owner::start) continue;
    if (value_at(a, rows[i].place) != value_at(b, rows[i].place)) return false;
  }
  return true;
}

bool same_structure(const Scene& a, const Scene& b) {
  const auto rows = parameter_table(a), others = parameter_table(b);
  return std::equal(rows.begin(), rows.end(), others.begin(), others.end(),
                    [](const auto& p, const auto& q) { return p.place == q.place && p.path.text() == q.path.text(); });
}

class Run {
 public:
  Run(const Scene& scene, std::uint64_t seed, const DragTrial& trial)
      : base_(scene), random_(seed), trial_(trial), live_(scene) {
    out_.bodies = static_cast<int>(scene.bodies.size()) - 1;
    size_ = live_.model().scales().length;
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
        points_.push_back({static_cast<int>(i), static_cast<int>(p)});
      }
    }
    for (const NamedPoint& point : scene.bodies[0].points) pivots_.push_back(point.at);
    doing_ = "begin";
    judge_rest();
  }

  JudgedDrags go() {
    while (out_.steps < trial_.steps && out_.contradictions.size() < 5) {
      const double what = random_.uniform(0.0, 1.0);
      if (what < 0.5) {
        drags();
      } else if (what < 0.68) {
        numbers(1);
      } else if (what < 0.74) {
        numbers(2 + random_.index(4));
      } else if (what < 0.80) {
        vector();
      } else if (what < 0.86) {
        structure();
      } else if (what < 0.90) {
        change("back", base_);
      } else if (what < 0.94) {
        release();
      } else if (what < 0.96) {
        again();
      } else if (what < 0.98) {
        impossible();
      } else {
        stay();
      }
    }
    return std::move(out_);
  }

 private:
  void contradict(Fault fault, const std::string& what) {
    out_.contradictions.push_back({fault, fmt::format("step {}, {}: {}", out_.steps, doing_, what)});
    if (!trial_.print) return;
    fmt::print("CONTRADICTED: {}\n# The scene before:\n{}# End of the scene\n", out_.contradictions.back().words,
               before_);
  }
  void leave_undecided(const std::string& what) {
    out_.undecided.push_back(fmt::format("step {}, {}: {}", out_.steps, doing_, what));
  }

  // --- actions ------------------------------------------------------------------------------------------------------

  // What the library does, timed; empty where it throws InputError, which must change nothing.
  std::optional<Transition> act(char action, const std::function<Transition()>& call) {
    const Scene scene = live_.scene(), held = live_.scene_with_hand();
    const BodyPoses poses = poses_now();
    const Status status = live_.equilibrium().status;
    if (trial_.print) before_ = test::scene_text(held);
    std::optional<Transition> out;
    std::string error;
    const double begin = processor_time();
    try {
      out = call();
    } catch (const InputError& e) {
      error = e.what();
    } catch (const std::exception& e) {
      error = e.what();
      contradict(Fault::other, fmt::format("threw what is no InputError: {}", e.what()));
    }
    const double seconds = processor_time() - begin;
    ++out_.steps;
    const bool jumps = out && (out->kind == TransitionKind::snapped || out->kind == TransitionKind::settled);
    out_.times.push_back({seconds, action, jumps, fmt::format("step {}, {}", out_.steps, doing_)});
    if (seconds > trial_.slow) contradict(Fault::slow, fmt::format("took {:.2f} s", seconds));
    if (out) {
      ++out_.kinds[static_cast<std::size_t>(out->kind)];
      if (trial_.print) {
        fmt::print("{} {}: {} {}; {}; {} courses; {}; {:.0f} us\n", out_.steps, doing_, to_string(out->kind), out->why,
                   fmt::join(out->passed, ", "), out->courses.size(), to_string(live_.equilibrium().status),
                   1e6 * seconds);
      }
      return out;
    }
    ++out_.errors;
    if (trial_.print) fmt::print("{} {}: {}\n", out_.steps, doing_, error);
    const bool unchanged = same_numbers(scene, live_.scene()) && same_numbers(held, live_.scene_with_hand()) &&
                           apart(poses, poses_now(), size_) == 0.0 && status == live_.equilibrium().status;
    if (!unchanged) contradict(Fault::other, "threw, but something has changed: " + error);
    return out;
  }

  /// What was there before an action.
  struct Before {
    Scene scene, held;
    BodyPoses poses;
    bool found = false;
    Stability stability = Stability::unknown;
    bool is_proved = false;
    std::optional<PointRef> hand;
  };
  // Bars left out, whose angles follow from the points that they join.
  BodyPoses poses_now() const {
    BodyPoses out = live_.poses();
    out.resize(live_.scene().bodies.size());
    return out;
  }

  Before before() const {
    const Equilibrium& e = live_.equilibrium();
    return {live_.scene(), live_.scene_with_hand(), poses_now(),
            e.found(),     e.certificate.stability, e.certificate.outcome == Outcome::proved,
            live_.hand()};
  }

  Vec2 place_of(PointRef point) const {
    return poses_now()[static_cast<std::size_t>(point.body)].world(live_.scene().local(point));
  }

  void drags() {
    if (points_.empty()) return release();
    const PointRef point = points_[static_cast<std::size_t>(random_.index(points_.size()))];
    const Vec2 start = place_of(point);
    const int count = 2 + random_.index(12);
    const double how = random_.uniform(0.0, 1.0);
    const double length = size_ * std::exp(random_.uniform(std::log(0.002), std::log(0.03)));
    double heading = random_.uniform(-M_PI, M_PI);
    const Vec2 pivot = pivots_.empty() ? Vec2{} : pivots_[static_cast<std::size_t>(random_.index(pivots_.size()))];
    Vec2 target = start;
    for (int k = 0; k < count && out_.contradictions.size() < 5; ++k) {
      if (how < 0.4) {  // smoothly, as a pointer
        heading += random_.uniform(-0.4, 0.4);
        target += length * unit(heading);
      } else if (how < 0.55) {  // jerkily
        const Vec2 direction = unit(random_.uniform(-M_PI, M_PI));
        target += (random_.uniform(0.1, 3.0) * length) * direction;
      } else if (how < 0.65) {  // far
        const Vec2 direction = unit(random_.uniform(-M_PI, M_PI));
        target = start + (random_.uniform(0.05, 1.5) * size_) * direction;
      } else if (how < 0.8) {  // straight through a pivot, and dead centres that lie there
        const Vec2 way = pivot - start;
        if (k == 0) heading = std::atan2(way.y, way.x);
        target += (4 * length) * unit(heading);
      } else {  // round a pivot
        const Vec2 arm = target - pivot;
        const double turn = norm(arm) > 0.0 ? std::min(0.3, 3 * length / norm(arm)) : 0.0;
        target = pivot + arm * unit(heading > 0.0 ? turn : -turn);
      }
      drag(point, target);
    }
    if (random_.chance(0.5)) release();
  }

  void drag(PointRef point, Vec2 target) {
    doing_ = fmt::format("drag {} to ({:.17g}, {:.17g})", live_.scene().name_of(point), target.x, target.y);
    const Before was = before();
    const auto way = act('d', [&] { return live_.drag(point, target); });
    if (!way) return;
    judge_rest();
    judge_drag(was, point, target, *way);
  }

  void change(const std::string& what, const Scene& wanted) {
    doing_ = what;
    const Before was = before();
    const bool numbers_only = same_structure(was.scene, wanted);
    const auto way = act(numbers_only ? 'c' : 's', [&] { return live_.change(wanted); });
    if (!way) return;
    if (!same_numbers(wanted, live_.scene())) contradict(Fault::other, "the scene is not the one wanted");
    judge_rest();
    if (numbers_only)
      judge_change(was, *way);
    else
      judge_release(was, *way);
  }

  std::optional<ParameterRow> any_number() {
    const std::vector<ParameterRow> rows = parameter_table(live_.scene());
    for (int k = 0; k < 30; ++k) {
      const ParameterRow& row = rows[static_cast<std::size_t>(random_.index(rows.size()))];
      const Owner owner = row.place.owner;
      if (owner == Owner::start || owner == Owner::drive) continue;
      if (dependent_number(live_.scene(), row.place) != nullptr) continue;
      const auto value = value_at(live_.scene(), row.place);
      if (value && std::isfinite(*value)) return row;
    }
    return std::nullopt;
  }

  double other_value(const ParameterRow& row, double value) {
    const double how = random_.uniform(0.0, 1.0);
    const bool is_length =
        row.place.owner == Owner::point || row.place.owner == Owner::joint || row.place.owner == Owner::stop;
    const double unit_of_it = row.dimension.length == 0 ? 1.0 : size_;
    if (is_length && how < 0.7) return value + random_.uniform(-0.15, 0.15) * unit_of_it;
    if (how < 0.7) return value * random_.uniform(0.5, 1.6);
    if (how < 0.8) return 0.0;
    if (how < 0.9) return -value;
    return value * (random_.chance(0.5) ? 1e3 : 30.0);
  }

  // Numbers swept in steps, or at once.
  void numbers(int count) {
    struct Sweep {
      ParameterPlace place;
      double from, to;
    };
    std::vector<Sweep> sweeps;
    std::string words;
    for (int k = 0; k < count; ++k) {
      const auto row = any_number();
      if (!row) return;
      const double from = *value_at(live_.scene(), row->place), to = other_value(*row, from);
      if (!contains(row->range, to) || from == to) continue;
      sweeps.push_back({row->place, from, to});
      words += fmt::format("{} {:.17g} to {:.17g} SI, ", row->path.text(), from, to);
    }
    if (sweeps.empty()) return;
    const int steps = random_.chance(0.4) ? 1 : 2 + random_.index(8);
    for (int k = 1; k <= steps && out_.contradictions.size() < 5; ++k) {
      Scene wanted = live_.scene();
      try {
        for (const Sweep& s : sweeps) {
          set_value_at(wanted, s.place, k == steps ? s.to : s.from + (s.to - s.from) * k / steps);
        }
      } catch (const InputError&) {
        return;  // limits of a stop that change places, or a force without a direction
      }
      change(fmt::format("{}{}/{}", words, k, steps), wanted);
    }
  }

  void vector() {
    if (live_.scene().forces.empty()) return numbers(1);
    const int f = random_.index(live_.scene().forces.size());
    const int steps = 1 + random_.index(6);
    const Vec2 from = live_.scene().forces[static_cast<std::size_t>(f)].vector;
    const Vec2 turned = from * unit(random_.uniform(-1.5, 1.5));
    const Vec2 to = random_.uniform(-1.0, 2.0) * turned;
    for (int k = 1; k <= steps && out_.contradictions.size() < 5; ++k) {
      Scene wanted = live_.scene();
      const double s = static_cast<double>(k) / steps;
      wanted.forces[static_cast<std::size_t>(f)].vector = (1 - s) * from + s * to;
      change(fmt::format("force {} to ({:.17g}, {:.17g}) {}/{}", wanted.forces[static_cast<std::size_t>(f)].name, to.x,
                         to.y, k, steps),
             wanted);
    }
  }

  // Something is taken away, and put back after some drags.
  void structure() {
    const Scene whole = live_.scene();
    Scene less = whole;
    const double what = random_.uniform(0.0, 1.0);
    std::string name;
    const auto take = [&](auto& items) {
      if (items.empty()) return;
      const auto at = items.begin() + random_.index(items.size());
      name = at->name;
      items.erase(at);
    };
    if (what < 0.6)
      take(less.elements);
    else if (what < 0.8)
      take(less.stops);
    else
      take(less.forces);
    if (name.empty()) return;
    change(fmt::format("without {}", name), less);
    if (!same_numbers(less, live_.scene())) return;
    if (random_.chance(0.5)) drags();
    change(fmt::format("with {} again", name), whole);
  }

  void release() {
    doing_ = "release";
    const Before was = before();
    const auto way = act('r', [&] { return live_.release(); });
    if (!way) return;
    judge_rest();
    if (live_.hand()) contradict(Fault::other, "the hand still holds");
    if (was.hand) judge_release(was, *way);
    const BodyPoses once = poses_now();
    doing_ = "release again";
    const auto twice = act('r', [&] { return live_.release(); });
    if (twice && (twice->kind != TransitionKind::none || apart(once, poses_now(), size_) != 0.0)) {
      contradict(Fault::other, fmt::format("{}, {:.3g} away", to_string(twice->kind), apart(once, poses_now(), size_)));
    }
  }

  // The scene as it is read again gives the same.
  void again() {
    release();
    doing_ = "restore";
    const Before was = before();
    const auto way = act('r', [&] {
      live_.restore(live_.scene());
      return Transition();
    });
    if (!way) return;
    judge_rest();
    const bool is_stable = was.found && was.is_proved && was.stability == Stability::stable;
    if (is_stable && apart(was.poses, poses_now(), size_) > 1e-8) {
      contradict(Fault::other, fmt::format("it is {:.3g} away", apart(was.poses, poses_now(), size_)));
    }
  }

  // The hand holds, say, and something is asked for that cannot be.
  void impossible() {
    Scene wanted = live_.scene();
    std::vector<std::size_t> bodies;
    for (std::size_t i = 1; i < wanted.bodies.size(); ++i) {
      if (!wanted.bodies[i].points.empty()) bodies.push_back(i);
    }
    if (bodies.empty()) return;
    auto& points = wanted.bodies[bodies[static_cast<std::size_t>(random_.index(bodies.size()))]].points;
    NamedPoint& point = points[static_cast<std::size_t>(random_.index(points.size()))];
    point.at = random_.uniform(-20.0, 20.0) * point.at;
    change(fmt::format("{} far away at ({:.17g}, {:.17g})", point.name, point.at.x, point.at.y), wanted);
  }

  void stay() {
    if (places_.empty() || places_.back().size() != poses_now().size()) return;
    doing_ = "stay at a place of before";
    const BodyPoses there = places_[static_cast<std::size_t>(random_.index(places_.size()))];
    const auto way = act('r', [&] {
      live_.stay_at(there);
      return Transition();
    });
    if (way) judge_rest();
  }

  // --- judgements ---------------------------------------------------------------------------------------------------

  void judge_rest() {
    const Equilibrium& e = live_.equilibrium();
    const BodyPoses poses = poses_now();
    for (const auto& p : poses) {
      if (!std::isfinite(p.angle) || !std::isfinite(p.origin.x) || !std::isfinite(p.origin.y)) {
        return contradict(Fault::other, "a body is nowhere");
      }
    }
    if (!e.found()) return;
    ++out_.confirmed;
    if (places_.size() < 20) places_.push_back(poses);
    const StaticModel fresh(started_at(live_.scene_with_hand(), poses));
    const auto x = coordinates_at(fresh, poses);
    if (!x) return contradict(Fault::unconfirmed, "the loops are open there");
    Certificate certificate = certify(fresh, *x);
    if (!certificate.confirmed()) {
      // Whether Newton's method of a certificate converges may depend on the last bits of its start.
      std::vector<double> beside = *x;
      for (double& value : beside) value += random_.uniform(-nudge, nudge);
      certificate = certify(fresh, beside);
    }
    if (!certificate.confirmed()) {
      // On the edge of being proved, as next to a singular pose, one attempt may leave open what another proves.
      if (certificate.outcome != Outcome::no_equilibrium && check(fresh, *x).is_equilibrium()) {
        return leave_undecided("a fresh certificate leaves open: " + certificate.statement);
      }
      return contradict(Fault::unconfirmed, fmt::format("confirmed, but a fresh certificate says: {} ({})",
                                                        certificate.statement, to_string(certificate.outcome)));
    }
    const double allowed = certificate.radius + e.certificate.radius + 1e-9 + 10 * certificate.rounding_effect;
    const double off = apart(poses, fresh.poses(certificate.x), size_) / (1 + static_cast<double>(poses.size()));
    if (certificate.outcome == Outcome::proved && off > allowed) {
      if (e.certificate.outcome == Outcome::proved && off < same) {
        return leave_undecided("another equilibrium side by side, next to a singular pose");
      }
      contradict(Fault::unconfirmed,
                 fmt::format("the equilibrium proved is {:.3g} away, radius {:.3g}", off, certificate.radius));
    }
    if (certificate.stability != e.certificate.stability) {
      contradict(Fault::unconfirmed, fmt::format("said to be {}, and is {}", to_string(e.certificate.stability),
                                                 to_string(certificate.stability)));
    }
    const Check bodies = check(fresh, certificate.x, {}, &certificate.active_stops, certificate.sharing_stops);
    // Where nothing acts the largest force is rounding, of springs too.
    const bool is_rounding =
        bodies.closed && bodies.stops_kept && bodies.imbalance < 1e-13 * std::max(fresh.scales().force, spring_force());
    if (!bodies.is_equilibrium() && !is_rounding) contradict(Fault::unconfirmed, "free bodies: " + bodies.objection);
  }

  // What springs would exert by their whole length, N: their forces are known to the rounding of that.
  double spring_force() const {
    double most = 0.0;
    for (const Element& element : live_.scene().elements) {
      if (const auto* spring = std::get_if<LinearSpring>(&element.law)) {
        most = std::max(most, spring->stiffness * (element.on.is_angle() ? 1.0 / size_ : size_));
      }
    }
    return most;
  }

  // `way` of a drag: a course may come before what the hand does, or after.
  void judge_courses(const Before& was, const Transition& way, bool drag = false) {
    for (Transition::Course course : way.courses) {
      for (BodyPoses& poses : course.poses) poses.resize(live_.scene().bodies.size());
      for (std::size_t k = 0; k < course.poses.size(); ++k) {
        if (k > 0) {
          const double step = apart(course.poses[k - 1], course.poses[k], size_);
          if (step > longest_pose) {
            return contradict(Fault::course, fmt::format("pose {} of {} of a course is {:.3g} from the last", k,
                                                         course.poses.size(), step));
          }
        }
        const double gap = gap_of(course.poses[k]);
        // A snap on the way has the numbers of the way.
        if (way.courses.size() == 1 && way.kind == TransitionKind::settled && way.passed.empty() &&
            gap > open_within * size_) {
          return contradict(Fault::course,
                            fmt::format("pose {} of {} of a course has a gap of {:.3g}", k, course.poses.size(), gap));
        }
      }
      if (course.poses.empty()) return contradict(Fault::course, "a course is empty");
    }
    if (way.courses.empty() || !live_.equilibrium().found()) return;
    // Loops that a change has opened are closed first.
    const Scene& held = live_.scene_with_hand();
    const Readings readings = readings_of(held, was.poses);
    bool keeps_stops = true;
    for (std::size_t s = 0; s < held.stops.size(); ++s) {
      const double by = std::max(held.stops[s].min - readings.stops[s], readings.stops[s] - held.stops[s].max);
      keeps_stops = keeps_stops && by < open_within * (held.stops[s].on.is_angle() ? 1.0 : size_);
    }
    if (way.kind == TransitionKind::settled && !drag && keeps_stops && gap_of(was.poses) < open_within * size_) {
      const double begin = apart(way.courses.front().poses.front(), was.poses, size_);
      if (begin > longest_pose) contradict(Fault::course, fmt::format("a course begins {:.3g} away", begin));
      const double end = apart(way.courses.back().poses.back(), poses_now(), size_);
      if (end > same) contradict(Fault::course, fmt::format("a course ends {:.3g} away", end));
    }
  }

  // The widest gap of a joint of the present scene.
  double gap_of(const BodyPoses& poses) const {
    double gap = 0.0;
    const Scene& scene = live_.scene();
    for (const Joint& joint : scene.joints) {
      const auto world = [&](PointRef p) { return poses[static_cast<std::size_t>(p.body)].world(scene.local(p)); };
      if (!joint.has_travel() && !joint.keeps_length()) gap = std::max(gap, norm(world(joint.a) - world(joint.b)));
    }
    return gap;
  }

  // Neither neutral nor at a limit, nor nearly so.
  static bool is_regular(const Equilibrium& e) {
    return e.found() && e.certificate.outcome == Outcome::proved && e.certificate.strict &&
           e.certificate.radius < 1e-13;
  }

  // Numbers changed: what small steps on the same way find.
  void judge_change(const Before& was, const Transition& way) {
    judge_courses(was, way);
    judge_way(was, was.held, way, false);
  }

  void judge_way(const Before& was, const Scene& held, const Transition& way, bool drag) {
    if (!was.found || was.stability != Stability::stable) return;
    const BodyPoses& from = was.poses;
    const bool moved =
        way.kind == TransitionKind::followed || way.kind == TransitionKind::none || way.kind == TransitionKind::blocked;
    std::optional<VariedScene> varied;
    try {
      varied.emplace(held, live_.scene_with_hand());
    } catch (const InputError& error) {
      if (moved && apart(from, poses_now(), size_) > same) leave_undecided(error.what());
      return;
    }
    SmallSteps steps;
    try {
      steps = follow_numbers(*varied, from);
      // Before it contradicts it takes care.
      const bool agrees = steps.end == SmallSteps::End::arrived && apart(steps.poses, poses_now(), size_) <= same;
      if (!agrees) steps = follow_numbers(*varied, from, true);
    } catch (const InputError& error) {
      return leave_undecided(error.what());
    }
    if (steps.end == SmallSteps::End::undecided) {
      return leave_undecided(fmt::format("{}: {} at {:.6g}", to_string(way.kind), steps.why, steps.part));
    }
    const Equilibrium& now = live_.equilibrium();
    if (steps.end == SmallSteps::End::lost && steps.part > 0.9999 && !is_regular(now)) {
      return leave_undecided("the last of the numbers are singular");
    }
    if (steps.end == SmallSteps::End::arrived && now.status == Status::not_confirmed) {
      return leave_undecided("it is there, and cannot be confirmed");
    }
    ++out_.judged;
    const double far = apart(steps.poses, poses_now(), size_);
    if (!moved && !drag && now.found() && far <= same) {
      return leave_undecided(fmt::format("{} to where small steps arrive", to_string(way.kind)));
    }
    const std::string small = fmt::format("{} at {:.9g}", steps.why, steps.part);
    // Where equilibria branch it goes on beside the one that small steps lose, or stay on.
    const bool says_so = std::any_of(way.passed.begin(), way.passed.end(), [](const std::string& passed) {
      return passed == "branch point" || passed == "fold" || passed.ends_with("not proved");
    });
    if (steps.end == SmallSteps::End::lost) {
      if (!moved || says_so) return;
      // It is lost so near that the pictures are the same.
      if (!now.found() || far <= same_picture) return leave_undecided("lost next to where it is: " + small);
      contradict(Fault::flip,
                 fmt::format("{}, but small steps are lost: {}, {:.3g} away", to_string(way.kind), small, far));
      return;
    }
    if (!live_.equilibrium().found()) {
      contradict(Fault::lost, fmt::format("{}, {}: {}; small steps arrive", to_string(way.kind),
                                          to_string(live_.equilibrium().status), live_.equilibrium().why));
    } else if (moved && far > same && far <= same_picture) {
      leave_undecided(fmt::format("small steps arrive {:.3g} away", far));
    } else if (moved && far > same && !says_so) {
      contradict(Fault::flip, fmt::format("{}, but small steps arrive {:.3g} away", to_string(way.kind), far));
    } else if (!moved && !drag) {
      contradict(Fault::jump,
                 fmt::format("{} ({}), but small steps arrive, {:.3g} away", to_string(way.kind), way.why, far));
    }
    if (way.kind == TransitionKind::none && apart(from, poses_now(), size_) > 1e-8) {
      contradict(Fault::flip, fmt::format("none, but it moved by {:.3g}", apart(from, poses_now(), size_)));
    }
  }

  // Let go, or another structure: where a fresh scene settles.
  void judge_release(const Before& was, const Transition& way) {
    judge_courses(was, way);
    const double moved = apart(was.poses, poses_now(), size_);
    if (way.kind == TransitionKind::none && moved > 1e-8)
      contradict(Fault::flip, fmt::format("none, but it moved by {:.3g}", moved));
    if (way.kind == TransitionKind::snapped || way.kind == TransitionKind::blocked)
      contradict(Fault::other, "it can only settle, but " + to_string(way.kind));
    if (!live_.equilibrium().found()) return;
    Equilibrium e;
    const StaticModel fresh(started_at(live_.scene_with_hand(), was.poses));
    try {
      e = solve(fresh);
    } catch (const InputError& error) {
      return leave_undecided(error.what());
    }
    const bool decides = e.found() && e.certificate.outcome == Outcome::proved && e.settling && !e.settling->in_doubt;
    if (!decides) return leave_undecided(fmt::format("{}: {}", to_string(e.status), e.why));
    ++out_.judged;
    if (e.settling->end == Settling::End::start_unstable) return;
    const double far = apart(fresh.poses(e.x), poses_now(), size_);
    if (far > same)
      contradict(Fault::jump, fmt::format("{}, {:.3g} from where the scene settles", to_string(way.kind), far));
  }

  int freedoms() const {
    try {
      return analyse_mobility(StaticModel(live_.scene_with_hand())).freedoms;
    } catch (const InputError&) {
      return 0;
    }
  }

  static SmallSteps follow_numbers_between(const Scene& from, const Scene& to, const BodyPoses& poses) {
    try {
      return follow_numbers(VariedScene(from, to), poses, true);
    } catch (const InputError&) {
      return {};
    }
  }

  // Held in both directions, on a straight way, small steps come to where it is now.
  bool came_straight(const Before& was, PointRef point, Vec2 start, Vec2 end) const {
    const auto held_at = [&](Vec2 place) {
      Scene scene = started_at(live_.scene(), was.poses);
      scene.stops.push_back({.name = "x of hand", .on = Measure::x_of(point), .min = place.x, .max = place.x});
      scene.stops.push_back({.name = "y of hand", .on = Measure::y_of(point), .min = place.y, .max = place.y});
      return scene;
    };
    const SmallSteps steps = follow_numbers_between(held_at(start), held_at(end), was.poses);
    return steps.end == SmallSteps::End::arrived && apart(steps.poses, poses_now(), size_) <= same;
  }

  void judge_drag(const Before& was, PointRef point, Vec2 target, const Transition& way) {
    judge_courses(was, way, true);
    const Vec2 start = was.poses[static_cast<std::size_t>(point.body)].world(was.scene.local(point));
    const Vec2 end = place_of(point);
    const bool jumped = way.kind == TransitionKind::snapped || way.kind == TransitionKind::settled;
    const double before_it = norm(target - start), now = norm(target - end);
    if (was.found && now > before_it + 1e-5 * size_) {
      contradict(Fault::short_way,
                 fmt::format("{}: {:.6g} from the place, {:.6g} before", to_string(way.kind), now, before_it));
    }
    const int held = static_cast<int>(live_.scene_with_hand().stops.size() - live_.scene().stops.size());
    if (held == 0) return contradict(Fault::other, "nothing holds the point");
    const CurveOfPoses curve(live_.scene_with_hand(), held, was.poses);
    if (curve.is_curve()) {
      if (jumped) {
        if (was.found) contradict(Fault::flip, fmt::format("{} with one freedom", to_string(way.kind)));
        return;
      }
      const Equilibrium& e = live_.equilibrium();
      if (curve.begins_singular()) return leave_undecided("a singular pose at the start");
      if (was.found && !e.found()) contradict(Fault::lost, fmt::format("held, but {}: {}", to_string(e.status), e.why));
      const auto walked = curve.to(poses_now());
      if (!walked.passed && walked.goes_on) return leave_undecided("a long way");
      ++out_.judged;
      if (!walked.passed) {
        contradict(Fault::flip, fmt::format("{} ({}), but the curve of poses does not lead there: {}",
                                            to_string(way.kind), way.why, walked.why));
        return;
      }
      const auto nearest = curve.nearest(point, target);
      if (now > nearest.distance + same_place * size_) {
        const std::string what = fmt::format("{} ({}): it comes to {:.6g} from the place, small steps to {:.6g}{}{}",
                                             to_string(way.kind), way.why, now / size_, nearest.distance / size_,
                                             nearest.ended_by.empty() ? "" : ", ended by ", nearest.ended_by);
        // Rounding decides how near to a singular pose one comes.
        if (nearest.ended_by.starts_with("a singular"))
          leave_undecided(what);
        else
          contradict(Fault::short_way, what);
      }
      return;
    }
    // Several freedoms: the hand on a straight way, the others in equilibrium. On a curve that turns far it is not.
    if (held == 1) {
      const double straight = std::abs(readings_of(live_.scene_with_hand(), poses_now()).stops.back() -
                                       readings_of(live_.scene_with_hand(), was.poses).stops.back());
      if (straight < 0.95 * norm(end - start)) return leave_undecided("a way on a curve that turns");
      // At the end of its reach a point that came there straight is held in one direction.
      if (was.stability == Stability::stable && came_straight(was, point, start, end)) {
        ++out_.judged;
        return;
      }
    }
    const Scene there = live_.scene_with_hand();
    const Readings at_start = readings_of(there, was.poses);
    Scene from = started_at(there, was.poses);
    for (std::size_t k = there.stops.size() - static_cast<std::size_t>(held); k < there.stops.size(); ++k) {
      from.stops[k].min = from.stops[k].max = at_start.stops[k];
    }
    // With as many freedoms as are held it may go round what is in the straight way.
    if (freedoms() == held && follow_numbers_between(from, there, was.poses).end == SmallSteps::End::lost) {
      return leave_undecided("not straight");
    }
    judge_way(was, from, way, true);
    if (held < 2 || now <= same_place * size_ || !was.found) return;
    Scene to = started_at(there, was.poses);
    to.stops[to.stops.size() - 2].min = to.stops[to.stops.size() - 2].max = target.x;
    to.stops.back().min = to.stops.back().max = target.y;
    try {
      const SmallSteps all = follow_numbers(VariedScene(from, to), was.poses, true);
      if (all.end == SmallSteps::End::arrived) {
        contradict(Fault::short_way, fmt::format("{} ({}): {:.6g} from the place, which small steps reach",
                                                 to_string(way.kind), way.why, now / size_));
      }
    } catch (const InputError&) {
    }
  }

  const Scene base_;
  Random random_;
  DragTrial trial_;
  TrackedEquilibrium live_;
  double size_ = 1.0;
  std::vector<PointRef> points_;
  std::vector<Vec2> pivots_;
  std::vector<BodyPoses> places_;
  std::string doing_, before_;
  JudgedDrags out_;
};

// A chain on springs, with weights and loads, some of them between two pivots.
Scene random_chain(std::uint64_t seed) {
  Random random(seed);
  const int count = 2 + random.index(19);
  Scene scene = random.chance(0.5) ? test::chain(count, 0.1, 0.2)
                                   : test::hanging_chain(count, 1.3, 2.0 * count, random.uniform(0.5, 1.1));
  scene.gravity = {0.0, -9.81};
  const double stiffness = random.uniform(0.0, 20.0);
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (random.chance(0.6)) {
      test::add_torsion_spring(scene, static_cast<int>(i) - 1, static_cast<int>(i), stiffness,
                               random.uniform(-0.3, 0.3));
    }
  }
  const auto& last = scene.bodies.back();
  test::add_force(scene, last.name + "." + last.points.back().name,
                  {random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)}, "tip");
  return scene;
}

}  // namespace

std::string to_string(Fault fault) {
  switch (fault) {
    case Fault::flip:
      return "flip";
    case Fault::unconfirmed:
      return "not an equilibrium";
    case Fault::other:
      return "other";
    case Fault::lost:
      return "lost";
    case Fault::jump:
      return "jump";
    case Fault::short_way:
      return "stops short";
    case Fault::course:
      return "course";
    case Fault::slow:
      return "slow";
  }
  return "unknown";
}

JudgedDrags judge_drags(const Scene& scene, std::uint64_t seed, const DragTrial& trial) {
  return Run(scene, seed, trial).go();
}

Scene scene_to_drag(std::uint64_t seed, std::string& kind) {
  Random random(seed);
  switch (seed % 6) {
    case 0: {
      kind = test::linkage_kinds()[seed / 6 % test::linkage_kinds().size()];
      return test::random_linkage(kind, seed, {.springs = 1 + random.index(3), .one_way = 0.3});
    }
    case 1:
    case 2:
      kind = test::mixed_kinds()[seed / 6 % test::mixed_kinds().size()];
      return test::mixed_mechanism(kind, seed);
    case 3: {
      kind = "planted";
      const test::Wish wish{.loops = random.index(4), .followers = random.chance(0.2), .stops = random.chance(0.4)};
      return test::plant_mechanism(seed, wish).in_equilibrium;
    }
    case 4:
      kind = "chain";
      return random_chain(seed);
    default: {
      const std::vector<std::string>& families = test::scene_families();
      kind = families[seed / 6 % families.size()];
      return test::random_scene(kind, seed);
    }
  }
}

}  // namespace poise::judge
