#include "statics/proof/enclosed_reactions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include <Eigen/SparseCore>

#include "solvers/ball_factors.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/regular_set.hpp"
#include "statics/bodies/ball_measures.hpp"
#include "statics/bodies/free_body_equations.hpp"
#include "statics/bodies/minimum_norm.hpp"
#include "statics/model/ball_mechanism.hpp"
#include "statics/proof/private/enclosed_bodies.hpp"

namespace poise {
namespace {

// At least the exact result of a sum of non-negative doubles, or of a few operations on them, that was rounded to v.
double above(double v) { return v == 0.0 ? 0.0 : v * (1.0 + 1e-6) + std::numeric_limits<double>::min(); }

using BallBody = PlacedBody<Ball>;
using BallEquations = FreeBodyEquations<BallBody>;
using Effort = UnitEffortOf<Ball>;

constexpr int most_refinements = 4;
constexpr int dense_reactions_limit = 40;  // unknowns; residuals in balls make up for what sparse factors lose
constexpr std::size_t long_row = 32;       // entries
constexpr int once_only = 2000;            // unknowns beyond which a proof that fails is not tried with more digits

// A double and the greatest distance to a number of the ball.
struct Rounded {
  explicit Rounded(const Ball& ball) : Rounded(ball, ball.middle()) {}
  Rounded(const Ball& ball, double from) : value(from), radius((ball - Ball(from)).greatest()) {}
  bool is_finite() const { return std::isfinite(value) && std::isfinite(radius); }

  double value;
  double radius;
};

struct Entry {
  int column;
  Ball value;
};

class Enclosure {
 public:
  Enclosure(const StaticModel& model, const Certificate& certificate)
      : model_(model),
        scene_(model.scene()),
        certificate_(certificate),
        bodies_(enclosed_bodies(model, certificate)),
        equations_(scene_, bodies_, model.scales().length),
        load_(static_cast<std::size_t>(equations_.rows())) {
    const auto push = [&](int body, const Planar<Ball>& at, const Planar<Ball>& force, const Ball& moment) {
      if (body == 0) return;
      const std::size_t row = 3 * (static_cast<std::size_t>(body) - 1);
      load_[row] += force.x;
      load_[row + 1] += force.y;
      load_[row + 2] += equations_.turning(body, at, force, moment);
    };
    equations_.push_loads(push);
    elements_ = equations_.push_elements(push);
  }

  // With what they are at the middle of the enclosure, where that is wide: there the force is no middle of all that it
  // may be, but belongs to the pose that is shown.
  void report_elements(Check& check, const Enclosure& middle) const {
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const Rounded force(elements_[e], middle.elements_[e].middle());
      if (force.is_finite()) check.element_forces[e] = {force.value, force.radius};
    }
  }

  // False where the way in which teeth act, which `check` has, is not proved: then they may act either way,
  // `either_way`.
  bool report_reactions(Check& check, bool either_way) {
    equations_.add_joints();
    std::vector<int> active = certificate_.active_stops;
    std::sort(active.begin(), active.end());
    for (const int stop : active) equations_.add_stop(stop, 2, sign_of(stop, check, either_way));
    // Where stops share a load the reactions of other stops are among those of `check`: those of joints are compared.
    reported_ = certificate_.sharing_stops.empty() ? equations_.items().size() : scene_.joints.size();
    const bool same_stops = equations_.items().size() == check.reactions.size();
    if ((certificate_.sharing_stops.empty() && !same_stops) || !hold_neutral_coordinates()) return true;
    leave_out_repeated_moments(check);
    make_matrix();
    const std::optional<std::vector<Ball>> f = solve();
    if (!f) return true;
    for (const auto& [unknown, sign] : signs_) {
      const int column = column_[unknown];
      if (!either_way && !(Ball(sign) * (*f)[static_cast<std::size_t>(column)] >= Ball(0))) return false;
    }
    report(*f, check);
    return true;
  }

  // The reactions that have no radius yet, by the set of least norm that `check` has.
  void report_least_norm(Check& check) {
    equations_.add_joints();
    std::vector<int> stops = certificate_.active_stops;
    stops.insert(stops.end(), certificate_.sharing_stops.begin(), certificate_.sharing_stops.end());
    std::sort(stops.begin(), stops.end());
    for (const int stop : stops) {
      if (separates(scene_.stops[static_cast<std::size_t>(stop)])) return;
      equations_.add_stop(stop, 2);
    }
    if (equations_.items().size() != check.reactions.size() || !hold_neutral_coordinates()) return;
    std::vector<int> idle;
    for (std::size_t k = 0; k < check.reactions.size(); ++k) {
      if (is_idle(check.reactions[k])) idle.push_back(static_cast<int>(k));
    }
    of_least_norm_ = true;
    reported_ = equations_.items().size();
    // Stops whose push is not told from none are taken to carry nothing, once.
    for (const bool again : {false, true}) {
      leave_out(idle);
      make_matrix();
      std::vector<int> pushless;
      if (const std::optional<std::vector<Ball>> f = least_norm(pushless)) return report(*f, check);
      if (again || pushless.empty()) return;
      idle.insert(idle.end(), pushless.begin(), pushless.end());
    }
  }

 private:
  // Numbers the unknowns but those of idle items.
  void leave_out(const std::vector<int>& idle) {
    column_.assign(equations_.unknowns().size(), 0);
    columns_ = 0;
    for (std::size_t u = 0; u < column_.size(); ++u) {
      const bool is_idle = std::find(idle.begin(), idle.end(), equations_.unknowns()[u].item) != idle.end();
      column_[u] = is_idle ? -1 : columns_++;
    }
  }

  static bool is_idle(const Reaction& r) { return r.of_stop() && r.force == Vec2{} && r.moment == 0.0; }

  // f of least |f| with A f = -load, where stops that do not carry anything would only make it longer:
  //   f + A^T z = 0,  A f = -load,
  // of rows of A that are independent, which imply the others. Pushes p_s >= 0 of the n stops that carry nothing in f
  // make it longer at the rates r_s. Let g be the set of least norm, A g = A f, and r_s >= -e of all of them:
  //   |g - f|^2 = g . (g - f) - f . (g - f) <= -sum_s r_s p_s <= e sum_s p_s <= e sqrt(n) |g - f|,
  // because g . (f - g) >= 0 (g is nearest to 0 in a convex set that f is in). So |g - f| <= e sqrt(n). There is none
  // where that is not proved. Stops whose push is not told from none are appended to `pushless`.
  std::optional<std::vector<Ball>> least_norm(std::vector<int>& pushless) {
    const auto [rank, order] =
        solvers::pivot_order<double>(Eigen::MatrixXd(middle_).transpose(), solvers::known_to::solution);
    std::vector<solvers::RegularSet::Entry> entries;
    for (int u = 0; u < columns_; ++u) entries.push_back({u, u, Ball(1)});
    std::vector<Ball> b(static_cast<std::size_t>(columns_));
    std::vector<int> place(rows_.size(), -1);
    for (Eigen::Index k = 0; k < rank; ++k) {
      const auto row = static_cast<std::size_t>(order[static_cast<std::size_t>(k)]);
      place[row] = static_cast<int>(b.size());
      for (const Entry& e : rows_[row]) entries.push_back({place[row], e.column, e.value});
      b.push_back(-load_[row]);
    }
    const solvers::RegularSet system(static_cast<int>(b.size()), true, entries);
    if (b.empty() || !system.regular()) return std::nullopt;
    b = system.solve(std::move(b));
    double shortening = 0.0;
    int idle = 0;
    for (std::size_t u = 0; u < column_.size(); ++u) {
      const int item = equations_.unknowns()[u].item;
      const int side = item < 0 ? 2 : side_of(equations_.items()[static_cast<std::size_t>(item)].stop);
      if (side == 2) continue;
      if (column_[u] >= 0) {
        const Ball pull = Ball(side) * b[static_cast<std::size_t>(column_[u])];
        if (pull < Ball(0)) continue;
        if (pull > Ball(0)) return std::nullopt;
        pushless.push_back(item);
        continue;
      }
      Ball longer(0.0);  // rate of |f|^2 / 2 with its push
      equations_.for_each_entry(equations_.unknowns()[u], [&](int row, const Ball& value) {
        const int z = place[static_cast<std::size_t>(row)];
        if (z >= 0) longer -= Ball(side) * value * b[static_cast<std::size_t>(z)];
      });
      ++idle;
      if (longer < Ball(0)) return std::nullopt;
      if (!(longer >= Ball(0))) shortening = std::max(shortening, longer.greatest());
    }
    if (!pushless.empty() || !std::isfinite(shortening)) return std::nullopt;
    b.resize(static_cast<std::size_t>(columns_));
    idle_within_ = above(shortening * std::sqrt(static_cast<double>(idle)));
    for (Ball& value : b) value = value.widened(idle_within_);
    return b;
  }

  // As that of FreeBodyEquations::Item, of an active stop; 2 of a joint.
  int side_of(int index) const {
    if (index < 0) return 2;
    const Stop& stop = scene_.stops[static_cast<std::size_t>(index)];
    if (stop.min == stop.max || (stop.on.kind == Measure::Kind::distance && stop.max <= 0.0)) return 2;
    const double value = value_of(scene_, stop.on, bodies_).middle();
    return std::abs(value - stop.max) < std::abs(value - stop.min) ? 1 : -1;
  }

  // The sign of the effort of teeth that push their wheels apart; notes that it is to be proved.
  Ball sign_of(int index, const Check& check, bool either_way) {
    const Stop& stop = scene_.stops[static_cast<std::size_t>(index)];
    if (!separates(stop)) return Ball(0);
    if (either_way) return Ball(0).widened(1.0);
    const Reaction* const found = reaction_of_stop(check.reactions, static_cast<std::size_t>(index));
    const double sign = found != nullptr && effort_of(stop, *found) < 0 ? -1.0 : 1.0;
    signs_.emplace_back(equations_.unknowns().size(), sign);
    return Ball(sign);
  }

  // The effort on a coordinate; none for the angle of a bar.
  std::optional<Effort> effort_on(int coordinate) const {
    const Layout& layout = model_.layout();
    for (std::size_t j = 0; j < layout.travel.size(); ++j) {
      if (layout.travel[j] != coordinate) continue;
      return unit_efforts(scene_, Measure::travel_of(static_cast<int>(j)), bodies_).front();
    }
    for (const Link& link : layout.links) {
      if (link.body <= 0) continue;
      const Planar<Ball>& origin = bodies_[static_cast<std::size_t>(link.body)].origin;
      if (link.frame == coordinate) return Effort{0, link.body, origin, origin, {}, Ball(1)};
      for (const Arm& arm : link.arms) {  // of a body that no joint ties to the ground
        if (arm.coordinate != coordinate || !layout.is_length(coordinate)) continue;
        return Effort{0, link.body, origin, origin, model_.balls().exact.phasors().coefficient(arm), Ball(0)};
      }
    }
    return std::nullopt;
  }

  bool hold_neutral_coordinates() {
    for (int i = 0; i < model_.layout().kept; ++i) {
      const std::vector<std::string>& neutral = certificate_.neutral_coordinates;
      if (std::find(neutral.begin(), neutral.end(), model_.layout().coordinates[static_cast<std::size_t>(i)].name) ==
          neutral.end()) {
        continue;
      }
      const std::optional<Effort> effort = effort_on(i);
      if (!effort) return false;
      equations_.add_effort(*effort);
    }
    return true;
  }

  int frame_of(int joint) const {
    const std::size_t body = static_cast<std::size_t>(scene_.joints[static_cast<std::size_t>(joint)].a.body);
    return model_.layout().links[body].frame;
  }

  // Of each joint whose angle follows from those of others, the moment is a load as large as `check` has it.
  void leave_out_repeated_moments(const Check& check) {
    column_.assign(equations_.unknowns().size(), 0);
    const Ball size(model_.scales().length);
    for (const int joint : model_.layout().redundant_angle) {
      frames_of_repeated_.insert(frame_of(joint));
      std::size_t last = 0;
      for (std::size_t u = 0; u < column_.size(); ++u) {
        if (equations_.unknowns()[u].item == joint) last = u;
      }
      column_[last] = -1;
      const Ball moment = Ball(check.reactions[static_cast<std::size_t>(joint)].moment) / size;
      equations_.for_each_entry(equations_.unknowns()[last], [&](int row, const Ball& value) {
        load_[static_cast<std::size_t>(row)] += value * moment;
      });
    }
    for (int& c : column_) c = c < 0 ? -1 : columns_++;
  }

  void make_matrix() {
    rows_.assign(load_.size(), {});
    std::vector<Eigen::Triplet<double>> middles;
    for (std::size_t u = 0; u < column_.size(); ++u) {
      if (column_[u] < 0) continue;
      equations_.for_each_entry(equations_.unknowns()[u], [&](int row, const Ball& value) {
        middles.emplace_back(row, column_[u], value.middle());
        rows_[static_cast<std::size_t>(row)].push_back({column_[u], value});
      });
    }
    middle_.resize(equations_.rows(), columns_);
    middle_.setFromTriplets(middles.begin(), middles.end());
  }

  // load + A f
  std::vector<Ball> residual(const std::vector<Ball>& f) const {
    std::vector<Ball> out = load_;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (const Entry& e : rows_[i]) out[i] += e.value * f[static_cast<std::size_t>(e.column)];
    }
    return out;
  }

  std::optional<std::vector<Ball>> solve() const {
    MinimumNorm nearly(middle_, dense_reactions_limit);
    std::vector<Ball> f(static_cast<std::size_t>(columns_));
    std::vector<Ball> left = load_;
    for (int k = 0; k < most_refinements; ++k) {
      Eigen::VectorXd b(equations_.rows());
      double of_middles = 0.0;
      double of_radii = 0.0;
      for (Eigen::Index i = 0; i < b.size(); ++i) {
        b[i] = left[static_cast<std::size_t>(i)].middle();
        of_middles = std::max(of_middles, std::abs(b[i]));
        of_radii = std::max(of_radii, left[static_cast<std::size_t>(i)].radius());
      }
      if (!std::isfinite(of_middles) || !std::isfinite(of_radii)) return std::nullopt;
      if (of_middles <= of_radii) break;
      const Eigen::VectorXd step = nearly.solve(b);
      for (Eigen::Index u = 0; u < step.size(); ++u) f[static_cast<std::size_t>(u)] -= Ball(step[u]);
      left = residual(f);
    }
    double largest = 0.0;
    for (const Ball& r : left) largest = std::max(largest, r.greatest());
    const double singular_value = proved_singular_value(nearly);
    if (!(singular_value > 0.0)) return std::nullopt;
    const double length = largest * std::sqrt(static_cast<double>(left.size()));
    const double away =
        largest == 0.0 ? 0.0 : above(std::max(length / singular_value, std::numeric_limits<double>::min()));
    if (!std::isfinite(away)) return std::nullopt;
    for (Ball& value : f) value = value.widened(away);
    return f;
  }

  // Less than the least singular value of every matrix of the enclosure of A, or 0. Where it may lie is estimated: for
  // random b of mean size one |A^+ b| is about the Frobenius norm of A^+.
  double proved_singular_value(MinimumNorm& nearly) const {
    if (columns_ == 0) return 1.0;
    std::minstd_rand random(1);
    std::uniform_real_distribution<double> uniform(-2.0, 2.0);
    double largest = 0.0;
    for (int probe = 0; probe < 2; ++probe) {
      const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(equations_.rows(), [&] { return uniform(random); });
      largest = std::max(largest, nearly.solve(b).norm());
    }
    double radii = 0.0;
    for (const auto& row : rows_) {
      for (const Entry& e : row) radii += e.value.radius();
    }
    double s = 0.25 / largest;
    if (is_below_singular_values(s)) return s - above(radii);
    if (columns_ > once_only) return 0.0;
    // The estimate was too high, or the balls grew along the elimination until they told nothing.
    const Ball::Precision more(2 * Ball::bits());
    s /= 4;
    return is_below_singular_values(s) ? s - above(radii) : 0.0;
  }

  // Of [I A; A^T s^2 I] short rows of A are eliminated beforehand, s^2 I - A^T A, so that no pivots of two rows arise
  // and balls grow less; products of long ones would fill the matrix.
  bool is_below_singular_values(double s) const {
    std::vector<solvers::BallFactors::Entry> all;
    all.reserve(6 * rows_.size());
    for (int i = 0; i < columns_; ++i) all.push_back({i, i, Ball(s) * Ball(s)});
    int size = columns_;
    for (const auto& row : rows_) {
      if (row.size() > long_row) {
        all.push_back({size, size, Ball(1)});
        for (const Entry& e : row) all.push_back({size, e.column, e.value.midpoint()});
        ++size;
        continue;
      }
      for (const Entry& e : row) {
        for (const Entry& other : row) {
          if (other.column <= e.column)
            all.push_back({e.column, other.column, -(e.value.midpoint() * other.value.midpoint())});
        }
      }
    }
    const solvers::BallFactors factors(size, true, all);
    return factors.regular() && factors.negative() == columns_;
  }

  void report(const std::vector<Ball>& f, Check& check) const {
    struct Part {
      int body;
      Planar<Ball> at, force{};
      Ball moment{};
    };
    struct Sum {
      Planar<Ball> force{};
      Ball moment, pressure;
      std::vector<Part> parts{};  // as those of Reaction
      bool complete = true;
    };
    std::vector<Sum> sums(equations_.items().size());
    for (std::size_t u = 0; u < column_.size(); ++u) {
      const BallEquations::Unknown& unknown = equations_.unknowns()[u];
      if (unknown.item < 0) continue;
      Sum& sum = sums[static_cast<std::size_t>(unknown.item)];
      const bool is_idle = column_[u] < 0 && of_least_norm_;
      if (column_[u] < 0 && !is_idle) {
        sum.complete = false;
        continue;
      }
      const Ball value = is_idle ? Ball(0).widened(idle_within_) : f[static_cast<std::size_t>(column_[u])];
      sum.force += value * unknown.force;
      sum.moment += value * unknown.moment;
      sum.pressure -= value;
      if (unknown.with.empty()) continue;
      equations_.for_each_action(
          unknown, [&](int body, const Planar<Ball>& at, const Planar<Ball>& force, const Ball& moment) {
            auto part = std::find_if(sum.parts.begin(), sum.parts.end(), [&](const Part& one) {
              return one.body == body && one.at.x.middle() == at.x.middle() && one.at.y.middle() == at.y.middle();
            });
            if (part == sum.parts.end()) part = sum.parts.insert(part, Part{.body = body, .at = at});
            part->force += value * force;
            part->moment += value * moment;
          });
    }
    for (std::size_t k = 0; k < reported_; ++k) {
      Reaction& reaction = check.reactions[k];
      const bool is_known = std::isfinite(reaction.radius) && std::isfinite(reaction.moment_radius);
      if (of_least_norm_ ? is_known : !reaction.determined || !sums[k].complete) continue;
      const Rounded x = rounded(sums[k].force.x, reaction.force.x), y = rounded(sums[k].force.y, reaction.force.y),
                    moment = rounded(sums[k].moment, reaction.moment),
                    axial = rounded(sums[k].pressure, reaction.axial);
      const double radius = above(std::hypot(x.radius, y.radius));
      if (!x.is_finite() || !y.is_finite() || !moment.is_finite() || !std::isfinite(radius)) continue;
      reaction.force = {x.value, y.value};
      reaction.radius = radius;
      if (reaction.parts.size() == sums[k].parts.size()) {
        for (std::size_t p = 0; p < reaction.parts.size(); ++p) enclose(sums[k].parts[p], reaction.parts[p]);
      }
      if (equations_.items()[k].axial) {
        reaction.axial = axial.value;
        reaction.radius = std::max(radius, axial.radius);
      }
      if (!of_least_norm_ && shares_moments(static_cast<int>(k))) continue;
      reaction.moment = moment.value;
      reaction.moment_radius = moment.radius;
    }
  }

  // With what it is at the pose that is shown, where the enclosure of the pose is wide.
  Rounded rounded(const Ball& ball, double shown) const {
    return certificate_.rest.empty() ? Rounded(ball, shown) : Rounded(ball);
  }

  template <class Part>
  void enclose(const Part& part, BodyForce& out) const {
    const Rounded x = rounded(part.force.x, out.force.x), y = rounded(part.force.y, out.force.y),
                  moment = rounded(part.moment, out.moment);
    const double radius = above(std::hypot(x.radius, y.radius));
    if (part.body != out.body || !x.is_finite() || !y.is_finite() || !moment.is_finite() || !std::isfinite(radius)) {
      return;
    }
    out.force = {x.value, y.value};
    out.radius = radius;
    out.moment = moment.value;
    out.moment_radius = moment.radius;
  }

  // Of the items joints come first.
  bool shares_moments(int item) const {
    if (item >= static_cast<int>(scene_.joints.size())) return false;
    return scene_.joints[static_cast<std::size_t>(item)].keeps_angle() && frames_of_repeated_.contains(frame_of(item));
  }

  const StaticModel& model_;
  const Scene& scene_;
  const Certificate& certificate_;
  std::vector<BallBody> bodies_;
  BallEquations equations_;
  std::vector<Ball> load_;
  std::vector<Ball> elements_;
  std::vector<std::pair<std::size_t, double>> signs_;  // unknowns of teeth, and the signs that they are taken to have
  std::vector<int> column_;                            // per unknown, or -1
  int columns_ = 0;
  std::size_t reported_ = 0;  // items
  bool of_least_norm_ = false;
  double idle_within_ = 0.0;  // of what idle stops carry in the set of least norm
  std::set<int> frames_of_repeated_;
  std::vector<std::vector<Entry>> rows_;  // of A
  Eigen::SparseMatrix<double> middle_;
};

int unknown_reactions(const Scene& scene) {
  int sum = 0;
  for (const Joint& joint : scene.joints) sum += joint.traits().constraints();
  return sum;
}

}  // namespace

void enclose_reactions(const StaticModel& model, const Certificate& certificate, Check& check) {
  if (!certificate.confirmed()) return;
  const int unknowns = unknown_reactions(model.scene());
  const bool reactions = !certificate.rest.empty() && unknowns <= enclosed_unknowns;
  const bool of_least_norm = unknowns <= least_norm_unknowns;
  if (!reactions && !of_least_norm && model.scene().elements.empty()) return;
  Enclosure enclosure(model, certificate);
  if (certificate.rest.empty()) {
    Certificate pose = certificate;
    pose.radius = pose.gap = 0.0;
    enclosure.report_elements(check, Enclosure(model, pose));
  } else {
    enclosure.report_elements(check, enclosure);
  }
  if (reactions && !enclosure.report_reactions(check, false)) {
    Enclosure(model, certificate).report_reactions(check, true);
  }
  const bool all_known = std::all_of(check.reactions.begin(), check.reactions.end(), [](const Reaction& r) {
    return std::isfinite(r.radius) && std::isfinite(r.moment_radius);
  });
  if (of_least_norm && !all_known) Enclosure(model, certificate).report_least_norm(check);
}

}  // namespace poise
