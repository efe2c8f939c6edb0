#include "model/layout.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "model/controllers.hpp"
#include "model/joint_friction.hpp"

namespace poise {
namespace {

// Two links connected by a joint; a bar makes two connections.
struct Connection {
  int joint;
  int link_a, link_b;
  LinkPoint a, b;
};

// A sum of the angles that joints keep: all of it, the part that does not vary, and the joints whose angles do, as
// those of a Turn.
struct AngleSum {
  ExactSum all, fixed;
  std::vector<int> varying;

  void add(const AngleSum& other, double sign = 1.0) {
    all.add(other.all, sign);
    fixed.add(other.fixed, sign);
    for (const int joint : std::vector<int>(other.varying)) add_varying(sign > 0.0 ? joint : -joint);
  }
  // The angle of a joint, whose index and 1 is `varies` where it varies, else 0.
  void add(double angle, int varies) {
    all.add(angle);
    if (varies == 0)
      fixed.add(angle);
    else
      add_varying(varies);
  }

 private:
  void add_varying(int joint) {
    const auto opposite = std::find(varying.begin(), varying.end(), -joint);
    if (opposite != varying.end())
      varying.erase(opposite);
    else
      varying.insert(std::upper_bound(varying.begin(), varying.end(), joint), joint);
  }
};

// Bodies kept parallel by welds and slides, with their constant angle to the representative.
class Frames {
 public:
  explicit Frames(int count) : parent_(count), turn_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  // Representative of link i; turn(i) is then angle(i) - angle(representative).
  int find(int i) {
    std::vector<int> trail;
    while (parent_[i] != i) {
      trail.push_back(i);
      i = parent_[i];
    }
    for (auto it = trail.rbegin(); it != trail.rend(); ++it) {
      const int above = parent_[*it];
      if (above != i) turn_[*it].add(turn_[above]);
      parent_[*it] = i;
    }
    return i;
  }
  const AngleSum& turn(int i) const { return turn_[i]; }

  // Sets angle(b) - angle(a) = angle, of a joint whose index and 1 is `varies` where its angle varies, else 0. Returns
  // false if both are parallel already.
  bool merge(int a, int b, double angle, int varies) {
    const int ra = find(a);
    const int rb = find(b);
    if (ra == rb) return false;
    // The smaller index is the representative, so that the ground represents its own frame.
    const bool forward = ra < rb;
    const int child = forward ? rb : ra;
    const double sign = forward ? 1.0 : -1.0;
    parent_[child] = forward ? ra : rb;
    AngleSum turn;
    turn.add(turn_[a], sign);
    turn.add(sign * angle, forward ? varies : -varies);
    turn.add(turn_[b], -sign);
    turn_[child] = turn;
    return true;
  }

 private:
  std::vector<int> parent_;
  std::vector<AngleSum> turn_;
};

// What is left of an angle without whole turns.
double within_a_turn(ExactSum angle) {
  const double turns = std::round(angle.to<double>() / (2 * M_PI));
  for (const double part : {2 * M_PI, 2.4492935982947064e-16}) {  // together 2 pi
    const double product = turns * part;
    angle.add(-product);
    angle.add(-std::fma(turns, part, -product));
  }
  return angle.to<double>();
}

bool is_zero(Vec2 v) { return v.x == 0.0 && v.y == 0.0; }
bool is_zero(const LinkPoint& p) { return p.vector == 0 && is_zero(p.at); }

// The index and 1 of a vector among those that vary, or 0.
int index_of(const std::vector<VaryingVector>& vectors, const VaryingVector& one) {
  const auto found = std::find(vectors.begin(), vectors.end(), one);
  return found == vectors.end() ? 0 : static_cast<int>(found - vectors.begin()) + 1;
}

// Why a coordinate is kept, as bits.
struct Reason {
  enum Bit : unsigned {
    closes_loop = 1,
    weight = 2,
    load = 4,
    spring = 8,
    stop = 16,
    inertia = 32,
    guides = 64,
    damper = 128,
    drive = 256,
    blade = 512
  };
};

// Builds a Layout in named steps; coordinates keep their provisional numbers until number_coordinates().
class Builder {
 public:
  Builder(const Scene& scene, Purpose purpose, VaryingNumbers varying) : scene_(scene), purpose_(purpose) {
    out_.varying = std::move(varying);
  }

  Layout build() {
    find_vectors();
    find_cuts();
    connect_links();
    find_what_matters();
    guess_bars();
    if (any_cut_) guess_what_is_cut();
    number_coordinates();
    if (!any_cut_) measure_size();
    return std::move(out_);
  }

 private:
  const VaryingNumbers& varying() const { return out_.varying; }

  void find_vectors() {
    if (varying().empty()) return;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      for (std::size_t k = 0; k < scene_.bodies[i].points.size(); ++k) {
        const PointRef point{static_cast<int>(i), static_cast<int>(k)};
        if (varying().has_point(point)) out_.vectors.push_back({VaryingVector::Of::point, point});
      }
    }
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const int joint = static_cast<int>(j);
      if (varying().has_length(scene_, joint)) out_.vectors.push_back({VaryingVector::Of::bar, {}, joint});
      if (varying().has_axis(joint)) out_.vectors.push_back({VaryingVector::Of::axis, {}, joint});
      if (varying().has_carriage(scene_, joint)) out_.vectors.push_back({VaryingVector::Of::carriage, {}, joint});
    }
  }

  LinkPoint end_of_bar(int joint) const {
    return {{scene_.joints[static_cast<std::size_t>(joint)].length, 0},
            index_of(out_.vectors, {VaryingVector::Of::bar, {}, joint})};
  }

  Arm along_line(int coordinate, int joint, int turn, bool forward) const {
    const Vec2& axis = scene_.joints[static_cast<std::size_t>(joint)].axis;
    const int vector = index_of(out_.vectors, {VaryingVector::Of::axis, {}, joint});
    return forward ? Arm{coordinate, axis, turn, vector} : Arm{coordinate, -axis, turn, -vector};
  }

  // In motion the force in a joint has to be known where its friction depends on it, or a controller reads it: such
  // joints close loops, so that their forces are multipliers of closures. The couple in a slide is that of a second
  // closure, at an end of its carriage.
  void find_cuts() {
    cut_.assign(scene_.joints.size(), false);
    carriage_.assign(scene_.joints.size(), -1);
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const int index = static_cast<int>(j);
      const bool may_grip = varying().has_friction(scene_, index) && friction_element(scene_, index) >= 0;
      cut_[j] = purpose_ == Purpose::dynamics && (grips(scene_, index) || may_grip || is_read(index));
      any_cut_ = any_cut_ || cut_[j];
    }
  }

  /// Whether a controller reads its force.
  bool is_read(int joint) const {
    return std::any_of(scene_.elements.begin(), scene_.elements.end(),
                       [&](const Element& one) { return one.feedback && one.feedback->reads_joint == joint; });
  }

  bool has_carriage(std::size_t joint) const {
    const Joint& of = scene_.joints[joint];
    return cut_[joint] && of.keeps_angle() && of.friction && of.friction->length > 0;
  }

  void connect_links() {
    make_links();
    find_points();
    choose_anchor();
    merge_frames();
    make_angles();
    connect();
    grow_tree();
    close_loops();
  }

  void make_links() {
    out_.links.resize(scene_.bodies.size());
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) out_.links[i].body = static_cast<int>(i);
    bar_link_.assign(scene_.joints.size(), -1);
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      if (!scene_.joints[j].keeps_length()) continue;
      bar_link_[j] = static_cast<int>(out_.links.size());
      Link link;
      link.joint = static_cast<int>(j);
      out_.links.push_back(link);
    }
  }

  // Of the ground only the points that something uses count, of a body all its points and its centre of mass.
  void find_points() {
    points_.resize(out_.links.size());
    const auto use = [&](PointRef p) {
      if (p.body != 0) return;
      points_[0].push_back(scene_.local(p));
      if (!anchor_ && !varying().has_point(p)) anchor_ = scene_.local(p);
    };
    const auto use_measure = [&](const Measure& measure, const auto& self) -> void {
      if (measure.kind == Measure::Kind::distance || measure.kind == Measure::Kind::component) {
        use(measure.a);
        use(measure.b);
      }
      for (const RopeContact& contact : measure.contacts) use(contact.at);
      if (!measure.outline.points.empty()) use(measure.b);
      for (const PointRef& point : measure.outline.points) use(point);
      for (const Measure::Term& term : measure.terms) self(term.measure, self);
    };
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      use(scene_.joints[j].a);
      use(scene_.joints[j].b);
      if (bar_link_[j] >= 0) points_[bar_link_[j]] = {{0, 0}, {scene_.joints[j].length, 0}};
    }
    for (const Element& e : scene_.elements) {
      use_measure(e.on, use_measure);
      if (e.feedback) use_measure(e.feedback->reads, use_measure);
    }
    for (const Stop& s : scene_.stops) use_measure(s.on, use_measure);
    for (const Drive& d : scene_.drives) use_measure(d.on, use_measure);
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      for (const NamedPoint& p : body.points) points_[i].push_back(p.at);
      if (body.mass != 0) points_[i].push_back(body.center);
    }
  }

  // A mechanism on no ground point is measured from its first body. In motion, where coordinates are compared over the
  // values of numbers, the anchor is no point that varies.
  void choose_anchor() {
    if (!points_[0].empty()) {
      out_.anchor = purpose_ == Purpose::dynamics ? anchor_.value_or(Vec2{}) : points_[0].front();
    } else if (scene_.bodies.size() > 1) {
      out_.anchor = scene_.start.position[1].value_or(Vec2{});
    }
  }

  // Angles that others imply are left out. By how much they differ from those is by how much the angles of all bodies
  // of their frame may be others, depending on which are left out.
  void merge_frames() {
    frames_.emplace(static_cast<int>(out_.links.size()));
    std::vector<double> open(scene_.joints.size(), 0.0);
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const Joint& joint = scene_.joints[j];
      if (!joint.keeps_angle() || has_carriage(j)) continue;
      const int varies = varying().has_angle(scene_, static_cast<int>(j)) ? static_cast<int>(j) + 1 : 0;
      if (frames_->merge(joint.a.body, joint.b.body, joint.angle, varies)) continue;
      ExactSum difference = frames_->turn(joint.b.body).all;
      difference.add(frames_->turn(joint.a.body).all, -1.0);
      const double kept = difference.to<double>();
      difference.add(-joint.angle);
      open[j] = std::abs(within_a_turn(difference));
      if (open[j] > 1e-9) {
        throw InputError(fmt::format(
            "{}:{}: {} \"{}\": keeps the angle from {} to {} at {:.6g} rad, but other welds and slides keep it at "
            "{:.6g} rad; expected angles that agree, or a pin where the body may turn",
            scene_.file, joint.line, joint.traits().key, joint.name, scene_.bodies[joint.a.body].name,
            scene_.bodies[joint.b.body].name, joint.angle, kept));
      }
      out_.redundant_angle.push_back(static_cast<int>(j));
    }
    frame_open_.assign(out_.links.size(), 0.0);
    for (const int j : out_.redundant_angle) frame_open_[frames_->find(scene_.joints[j].a.body)] += open[j];
  }

  void make_angles() {
    std::vector<int> coordinate_of(out_.links.size(), -1);
    std::map<std::tuple<std::vector<double>, double, std::vector<int>, std::vector<double>>, int> known;
    const auto place_of = [&](const AngleSum& turn, double open) {
      const bool varies = !turn.varying.empty();
      const ExactSum fixed = varies ? turn.fixed : ExactSum{};
      const auto [at, fresh] =
          known.try_emplace({turn.all.parts(), open, turn.varying, fixed.parts()}, static_cast<int>(out_.turns.size()));
      if (fresh) out_.turns.push_back({turn.all, open, turn.varying, fixed});
      return at->second;
    };
    place_of({}, 0.0);
    for (std::size_t i = 0; i < out_.links.size(); ++i) {
      Link& link = out_.links[i];
      const int lead = frames_->find(static_cast<int>(i));
      link.turn = place_of(frames_->turn(static_cast<int>(i)), i == 0 ? 0.0 : frame_open_[lead]);
      if (lead != 0 && coordinate_of[lead] < 0) {
        coordinate_of[lead] = static_cast<int>(out_.coordinates.size());
        Coordinate c;
        c.name = name(lead);
        out_.coordinates.push_back(c);
      }
      link.frame = coordinate_of[lead];
      if (link.body > 0 && link.frame >= 0 && scene_.start.angle[link.body]) {
        out_.coordinates[link.frame].start = *scene_.start.angle[link.body] - turn_of(link);
      }
    }
  }

  double turn_of(const Link& link) const { return out_.turns[link.turn].to<double>(); }

  std::string name(int link) const {
    const Link& l = out_.links[link];
    return l.body >= 0 ? scene_.bodies[l.body].name : scene_.joints[l.joint].name;
  }

  void connect() {
    around_.resize(out_.links.size());
    const auto add = [&](const Connection& c) {
      around_[c.link_a].push_back(static_cast<int>(connections_.size()));
      around_[c.link_b].push_back(static_cast<int>(connections_.size()));
      connections_.push_back(c);
    };
    out_.travel.assign(scene_.joints.size(), -1);
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const Joint& joint = scene_.joints[j];
      const int index = static_cast<int>(j);
      const LinkPoint a = out_.place_of(scene_, joint.a), b = out_.place_of(scene_, joint.b);
      if (joint.keeps_length()) {
        add({index, joint.a.body, bar_link_[j], a, {}});
        add({index, bar_link_[j], joint.b.body, end_of_bar(index), b});
        continue;
      }
      if (joint.has_travel()) {
        out_.travel[j] = static_cast<int>(out_.coordinates.size());
        Coordinate c;
        c.kind = Coordinate::Kind::length;
        c.name = joint.name;
        c.frame = out_.links[joint.a.body].frame;
        c.start = scene_.start.travel[j].value_or(0.0);
        out_.coordinates.push_back(c);
        if (has_carriage(j)) {
          carriage_[j] = static_cast<int>(out_.coordinates.size());
          c.name.clear();
          out_.coordinates.push_back(c);
        }
      }
      add({index, joint.a.body, joint.b.body, a, b});
    }
  }

  // p_b - p_a of the connected points, without the contribution of their links' origins.
  std::vector<Arm> local_arms(const Connection& c) const {
    const Link& a = out_.links[c.link_a];
    const Link& b = out_.links[c.link_b];
    std::vector<Arm> arms;
    if (!is_zero(c.a)) arms.push_back({a.frame, c.a.at, a.turn, c.a.vector});
    if (out_.travel[c.joint] >= 0) arms.push_back(along_line(out_.travel[c.joint], c.joint, a.turn, true));
    if (!is_zero(c.b)) arms.push_back({b.frame, -c.b.at, b.turn, -c.b.vector});
    return arms;
  }

  // Breadth first from the ground, bars last: a bar then closes a loop instead of connecting bodies in the tree. A body
  // that is not connected to the ground gets the two coordinates of its origin, from the anchor.
  void grow_tree() {
    in_tree_.assign(connections_.size(), false);
    hops_.resize(out_.links.size());
    std::vector<bool> reached(out_.links.size(), false);
    std::deque<int> front, bars;
    const auto reach = [&](int link) {
      reached[link] = true;
      out_.tree_order.push_back(link);
      for (int c : around_[link]) (scene_.joints[connections_[c].joint].keeps_length() ? bars : front).push_back(c);
    };
    const auto cross = [&](int index) {
      const Connection& c = connections_[index];
      if (reached[c.link_a] == reached[c.link_b] || cut_[c.joint]) return;
      in_tree_[index] = true;
      const bool forward = reached[c.link_a];
      const int child = forward ? c.link_b : c.link_a;
      Link& link = out_.links[child];
      link.parent = forward ? c.link_a : c.link_b;
      link.depth = out_.links[link.parent].depth + 1;
      link.arms = local_arms(c);
      hops_[child] = {forward ? c.a.at : c.b.at, forward ? c.b.at : c.a.at, c.joint};
      // The parent's arm comes first: poses() then subtracts what it measures from before it adds small arms.
      if (!forward) {
        for (Arm& arm : link.arms) {
          arm.arm = -arm.arm;
          arm.vector = -arm.vector;
        }
        std::reverse(link.arms.begin(), link.arms.end());
      }
      reach(child);
    };
    const auto spread = [&] {
      while (!front.empty() || !bars.empty()) {
        auto& queue = front.empty() ? bars : front;
        const int next = queue.front();
        queue.pop_front();
        cross(next);
      }
    };
    reach(0);
    spread();
    std::vector<bool> tied = tied_to(0, std::vector<bool>(out_.links.size(), false));
    for (std::size_t i = 1; i < out_.links.size(); ++i) {
      if (reached[i]) continue;
      Link& link = out_.links[i];
      link.parent = 0;
      link.depth = 1;
      const Vec2 guess = link.body >= 0 ? scene_.start.position[link.body].value_or(Vec2{}) : Vec2{};
      hops_[i].from = guess;
      if (!is_zero(out_.anchor)) link.arms.push_back({-1, out_.anchor, 0});
      for (const bool is_x : {true, false}) {
        Coordinate c;
        c.kind = Coordinate::Kind::length;
        // Of a body that joints tie, some of which are cut, this is not a coordinate that anyone would ask for.
        if (!tied[i]) c.name = name(static_cast<int>(i)) + (is_x ? ".x" : ".y");
        c.origin = is_x ? out_.anchor.x : out_.anchor.y;
        c.start = (is_x ? guess.x : guess.y) - c.origin;
        link.arms.push_back({static_cast<int>(out_.coordinates.size()), is_x ? Vec2{1, 0} : Vec2{0, 1}, 0});
        out_.coordinates.push_back(c);
      }
      if (!tied[i]) tied = tied_to(static_cast<int>(i), std::move(tied));
      reach(static_cast<int>(i));
      spread();
    }
  }

  // Adds the links that joints, cut or not, tie to one.
  std::vector<bool> tied_to(int link, std::vector<bool> tied) const {
    std::vector<int> front{link};
    tied[static_cast<std::size_t>(link)] = true;
    while (!front.empty()) {
      const int from = front.back();
      front.pop_back();
      for (const int index : around_[from]) {
        for (const int to : {connections_[index].link_a, connections_[index].link_b}) {
          if (tied[static_cast<std::size_t>(to)]) continue;
          tied[static_cast<std::size_t>(to)] = true;
          front.push_back(to);
        }
      }
    }
    return tied;
  }

  void close_loops() {
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      if (in_tree_[i]) continue;
      const Connection& c = connections_[i];
      Closure closure;
      closure.joint = c.joint;
      closure.link_a = c.link_a;
      closure.link_b = c.link_b;
      closure.name = scene_.joints[c.joint].name;
      closure.arms = out_.path_between(c.link_a, c.a, c.link_b, c.b);
      // path() gives p_b - p_a, which equals the travel along the axis.
      if (out_.travel[c.joint] >= 0) {
        closure.arms.push_back(along_line(out_.travel[c.joint], c.joint, out_.links[c.link_a].turn, false));
      }
      out_.closures.push_back(closure);
      const int carriage = carriage_[static_cast<std::size_t>(c.joint)];
      if (carriage < 0) continue;
      const Vec2 end = end_of_carriage(c.joint);
      if (const int vector = index_of(out_.vectors, {VaryingVector::Of::carriage, {}, c.joint});
          vector != 0 || c.b.vector != 0) {
        const Link& b = out_.links[c.link_b];
        closure.arms.back() = {b.frame, end, b.turn, vector};
      } else {
        closure.arms = out_.path_between(c.link_a, c.a, c.link_b, {c.b.at + end});
      }
      closure.arms.push_back(along_line(carriage, c.joint, out_.links[c.link_a].turn, false));
      out_.closures.push_back(std::move(closure));
    }
  }

  // From the second point of a slide, in that point's body.
  Vec2 end_of_carriage(int joint) const {
    const Joint& of = scene_.joints[static_cast<std::size_t>(joint)];
    return (of.friction->length / 2) * (of.direction() * unit(-of.angle));
  }

  void mark(int coordinate, unsigned reason) {
    if (coordinate < 0) return;
    reasons_[coordinate] |= reason;
    const Coordinate& c = out_.coordinates[coordinate];
    if (c.kind == Coordinate::Kind::length && c.frame >= 0) reasons_[c.frame] |= Reason::guides;
  }

  void mark_path(const std::vector<Arm>& arms, unsigned reason) {
    for (const Arm& arm : arms) mark(arm.coordinate, reason);
  }

  // A coordinate is kept if something that dissipates or stores energy, closes a loop or has a stop moves with it.
  void find_what_matters() {
    reasons_.assign(out_.coordinates.size(), 0);
    for (const Closure& closure : out_.closures) mark_path(closure.arms, Reason::closes_loop);

    std::vector<unsigned> bears(out_.links.size(), 0);
    const auto bear_at = [&](int body, bool apart, unsigned reason) {
      bears[body] |= reason;
      if (apart) mark(out_.links[body].frame, reason);
    };
    const bool heavy = !is_zero(scene_.gravity) || varying().has_gravity();
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      const int index = static_cast<int>(i);
      const bool has_mass = body.mass != 0 || varying().has_mass(index);
      const bool apart = !is_zero(body.center) || varying().has_center(index);
      if (heavy && has_mass) bear_at(index, apart, Reason::weight);
      if (purpose_ != Purpose::dynamics) continue;
      if (has_mass) bear_at(index, apart, Reason::inertia);
      if (body.inertia != 0 || varying().has_inertia(index)) mark(out_.links[i].frame, Reason::inertia);
    }
    for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
      const Force& force = scene_.forces[f];
      if (!acts(f)) continue;
      force.for_each_point(
          [&](PointRef point) { bear_at(point.body, !is_zero(out_.place_of(scene_, point)), Reason::load); });
      if (force.follows >= 0) mark(out_.links[force.follows].frame, Reason::load);
    }
    for (std::size_t t = 0; t < scene_.torques.size(); ++t) {
      if (turns(t)) mark(out_.links[scene_.torques[t].body].frame, Reason::load);
    }
    for (auto it = out_.tree_order.rbegin(); it != out_.tree_order.rend(); ++it) {
      const Link& link = out_.links[*it];
      if (bears[*it] == 0 || link.parent < 0) continue;
      mark_path(link.arms, bears[*it]);
      bears[link.parent] |= bears[*it];
    }
    for (std::size_t k = 0; k < scene_.elements.size(); ++k) {
      const Element& e = scene_.elements[k];
      if (stores_energy(e.law)) {
        // A number that identification varies may initially be zero.
        if (purpose_ == Purpose::dynamics || why_idle(k).empty()) mark_measure(e.on, Reason::spring);
      } else if (purpose_ == Purpose::dynamics) {
        mark_measure(e.on, Reason::damper);
        if (e.feedback) mark_measure(e.feedback->reads, Reason::damper);
      }
    }
    for (const Stop& s : scene_.stops) mark_measure(s.on, Reason::stop);
    if (purpose_ == Purpose::dynamics) {
      for (const Drive& d : scene_.drives) mark_measure(d.on, Reason::drive);
      for (const Blade& b : scene_.blades) {
        for (const Measure& on : {b.turn(), b.x(), b.y()}) mark_measure(on, Reason::blade);
      }
    }
    note_what_never_enters(heavy);
  }

  // Whether a load, or an element, has no effect that numbers could give it.
  bool acts(std::size_t force) const {
    return !is_zero(scene_.forces[force].vector) || varying().has_any(Owner::force, static_cast<int>(force));
  }
  bool turns(std::size_t torque) const {
    return scene_.torques[torque].value != 0 || varying().has_any(Owner::torque, static_cast<int>(torque));
  }
  std::string_view why_idle(std::size_t element) const {
    const bool varies = varying().has_any(Owner::element, static_cast<int>(element));
    return varies ? std::string_view{} : idle(scene_.elements[element].law);
  }

  // Of a measure of points.
  std::vector<Arm> arms_of(const Measure& measure) const {
    switch (measure.kind) {
      case Measure::Kind::distance:
      case Measure::Kind::component:
      case Measure::Kind::clearance:
      case Measure::Kind::along_outline:
      case Measure::Kind::slip_on_cam:
        return out_.path(scene_, measure.a, measure.b);
      case Measure::Kind::rope: {
        std::vector<Arm> arms;
        for (std::size_t k = 1; k < measure.contacts.size(); ++k) {
          const std::vector<Arm> part = out_.path(scene_, measure.contacts[k - 1].at, measure.contacts[k].at);
          arms.insert(arms.end(), part.begin(), part.end());
        }
        return arms;
      }
      default:
        return out_.path_to(scene_, measure.b);
    }
  }

  // A measure in directions that turn with the body of its point a.
  static bool has_direction(const Measure& measure) {
    return measure.kind == Measure::Kind::component || measure.kind == Measure::Kind::clearance ||
           measure.kind == Measure::Kind::along_outline || measure.kind == Measure::Kind::slip_on_cam;
  }

  // False for a measure that is constant: an angle between parallel bodies, a distance on one body.
  bool changes(const Measure& measure) const {
    switch (measure.kind) {
      case Measure::Kind::angle:
        return out_.links[measure.body_a].frame != out_.links[measure.body_b].frame;
      case Measure::Kind::travel:
        return true;
      case Measure::Kind::sum:
        return std::any_of(measure.terms.begin(), measure.terms.end(),
                           [this](const Measure::Term& term) { return changes(term.measure); });
      default: {
        // A direction may turn under a vector that does not.
        const std::vector<Arm> arms = arms_of(measure);
        const bool turns = has_direction(measure) && out_.links[measure.a.body].frame >= 0;
        return (turns && !arms.empty()) ||
               std::any_of(arms.begin(), arms.end(), [](const Arm& arm) { return arm.coordinate >= 0; });
      }
    }
  }

  void mark_measure(const Measure& measure, unsigned reason) {
    switch (measure.kind) {
      case Measure::Kind::angle:
        // Bodies of one frame have no relative rotation.
        if (out_.links[measure.body_a].frame == out_.links[measure.body_b].frame && reason != Reason::stop) break;
        mark(out_.links[measure.body_a].frame, reason);
        mark(out_.links[measure.body_b].frame, reason);
        break;
      case Measure::Kind::travel:
        mark(out_.travel[measure.joint], reason);
        break;
      case Measure::Kind::component:
      case Measure::Kind::clearance:
      case Measure::Kind::along_outline:
      case Measure::Kind::slip_on_cam:
        mark(out_.links[measure.a.body].frame, reason);
        mark_path(arms_of(measure), reason);
        break;
      case Measure::Kind::distance:
      case Measure::Kind::rope:
      case Measure::Kind::x:
      case Measure::Kind::y:
        mark_path(arms_of(measure), reason);
        break;
      case Measure::Kind::sum:
        for (const Measure::Term& term : measure.terms) mark_measure(term.measure, reason);
        break;
    }
  }

  void note_what_never_enters(bool heavy) {
    const auto bodies = [](int count) { return fmt::format("{} {}", count, count == 1 ? "body" : "bodies"); };
    if (purpose_ == Purpose::statics) {
      int masses = 0;
      for (std::size_t i = 1; i < scene_.bodies.size(); ++i) masses += scene_.bodies[i].mass != 0;
      if (masses > 0 && !heavy) out_.dropped.push_back(fmt::format("mass of {}: there is no gravity", bodies(masses)));
      int inertias = 0;
      for (std::size_t i = 1; i < scene_.bodies.size(); ++i) inertias += scene_.bodies[i].inertia > 0;
      inertias -= static_cast<int>(bodies_of_states(scene_).size());
      if (inertias > 0) {
        out_.dropped.push_back(fmt::format("moment of inertia of {}: nothing moves in statics", bodies(inertias)));
      }
      for (const Element& e : scene_.elements) {
        const std::string_view why = left_out_of_statics(e.law);
        if (!why.empty()) out_.dropped.push_back(fmt::format("{} \"{}\": {}", e.family(), e.name, why));
      }
      for (const Drive& drive : scene_.drives) {
        out_.dropped.push_back(
            fmt::format("drive \"{}\": statics leaves drives out, its coordinate is free", drive.name));
      }
      for (const Blade& blade : scene_.blades) {
        out_.dropped.push_back(fmt::format(
            "blade \"{}\": it keeps no position from being reached, and its force at rest is left out", blade.name));
      }
    }
    for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
      if (!acts(f)) out_.dropped.push_back(fmt::format("force \"{}\": it is zero", scene_.forces[f].name));
    }
    for (std::size_t t = 0; t < scene_.torques.size(); ++t) {
      const Torque& torque = scene_.torques[t];
      if (out_.links[torque.body].frame < 0) {
        out_.dropped.push_back(fmt::format("torque \"{}\": its body does not turn", torque.name));
      } else if (!turns(t)) {
        out_.dropped.push_back(fmt::format("torque \"{}\": it is zero", torque.name));
      }
    }
    for (std::size_t k = 0; k < scene_.elements.size(); ++k) {
      const Element& e = scene_.elements[k];
      if (purpose_ != Purpose::statics || !stores_energy(e.law)) continue;
      const std::string_view why = !why_idle(k).empty() ? why_idle(k)
                                   : changes(e.on)      ? ""
                                                        : "nothing changes its measure";
      if (!why.empty()) out_.dropped.push_back(fmt::format("{} \"{}\": {}", e.family(), e.name, why));
    }
  }

  // Of a link at the start of the coordinates, in the world, from that of its parent.
  static Vec2 origin_at_start(const Layout& layout, const std::vector<Vec2>& origin, int i) {
    const Link& link = layout.links[i];
    Vec2 p = link.parent < 0 ? Vec2{} : origin[link.parent];
    for (const Arm& arm : link.arms) {
      Vec2 term = layout.is_length(arm.coordinate) ? direction<double>(arm.arm) : arm.arm;
      if (arm.turn != 0) term = term * unit(layout.turns[arm.turn].to<double>());
      if (arm.coordinate >= 0) {
        const Coordinate& c = layout.coordinates[arm.coordinate];
        if (c.kind == Coordinate::Kind::angle)
          term = term * unit(c.start);
        else
          term = c.start * (c.frame < 0 ? term : term * unit(layout.coordinates[c.frame].start));
      }
      p += term;
    }
    return p;
  }

  static std::vector<Vec2> origins_at_start(const Layout& layout) {
    std::vector<Vec2> origin(layout.links.size());
    for (const int i : layout.tree_order) origin[i] = origin_at_start(layout, origin, i);
    return origin;
  }

  // A bar points from one of its end points to the other. A body connected by bars alone has the position of the
  // scene's start.
  void guess_bars() {
    std::vector<Vec2> origin = origins_at_start(out_);
    const auto angle = [&](const Link& link) {
      return (link.frame < 0 ? 0.0 : out_.coordinates[link.frame].start) + turn_of(link);
    };
    const auto place = [&](int i) { origin[i] = origin_at_start(out_, origin, i); };
    for (int i : out_.tree_order) {
      Link& link = out_.links[i];
      place(i);
      if (link.body >= 0) continue;
      const Joint& joint = scene_.joints[link.joint];
      const auto world = [&](PointRef p) {
        return scene_.start.position[p.body].value_or(origin[p.body]) +
               scene_.local(p) * unit(angle(out_.links[p.body]));
      };
      const Vec2 along = world(joint.b) - world(joint.a);
      if (!is_zero(along)) out_.coordinates[link.frame].start = std::atan2(along.y, along.x);
      place(i);
    }
  }

  // Coordinates of which the scene says nothing, because joints are cut, as the scene starts without that.
  void guess_what_is_cut() {
    Scene whole = scene_;
    for (Joint& joint : whole.joints) joint.friction.reset();
    for (Element& element : whole.elements) {
      if (element.feedback) element.feedback->reads_joint = -1;
    }
    const Layout of_whole = Builder(whole, purpose_, {}).build();
    const auto start_of = [](const Layout& layout, int coordinate) {
      return coordinate < 0 ? 0.0 : layout.coordinates[static_cast<std::size_t>(coordinate)].start;
    };
    const std::vector<Vec2> origin = origins_at_start(of_whole);
    out_.anchor = of_whole.anchor;
    out_.size = of_whole.size;
    for (std::size_t i = 0; i < out_.links.size(); ++i) {
      const Link& link = out_.links[i];
      const Link& same = of_whole.links[i];
      if (link.frame >= 0) {
        out_.coordinates[link.frame].start =
            start_of(of_whole, same.frame) + of_whole.turns[same.turn].to<double>() - turn_of(link);
      }
      if (link.parent != 0) continue;
      for (const Arm& arm : link.arms) {
        if (!out_.is_length(arm.coordinate)) continue;
        Coordinate& c = out_.coordinates[arm.coordinate];
        if (std::find(out_.travel.begin(), out_.travel.end(), arm.coordinate) != out_.travel.end()) continue;
        c.start = (arm.arm.x != 0 ? origin[i].x : origin[i].y) - c.origin;
      }
    }
    for (std::size_t j = 0; j < carriage_.size(); ++j) {
      if (carriage_[j] < 0) continue;
      out_.coordinates[carriage_[j]].start = start_of(out_, out_.travel[j]) + scene_.joints[j].friction->length / 2;
    }
  }

  // Kept angles, kept lengths, then everything dropped.
  void number_coordinates() {
    const std::size_t count = out_.coordinates.size();
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    const auto rank = [&](int i) {
      if (reasons_[i] == 0) return 2;
      return out_.coordinates[i].kind == Coordinate::Kind::angle ? 0 : 1;
    };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return rank(a) < rank(b); });
    std::vector<int> number(count);
    std::vector<Coordinate> sorted(count);
    for (std::size_t k = 0; k < count; ++k) {
      number[order[k]] = static_cast<int>(k);
      sorted[k] = std::move(out_.coordinates[order[k]]);
      sorted[k].reasons = reasons_[order[k]];
      out_.angles += rank(order[k]) == 0;
      out_.kept += rank(order[k]) < 2;
    }
    const auto renumber = [&](int& i) {
      if (i >= 0) i = number[i];
    };
    out_.coordinates = std::move(sorted);
    for (Coordinate& c : out_.coordinates) renumber(c.frame);
    for (int& t : out_.travel) renumber(t);
    for (Link& link : out_.links) {
      renumber(link.frame);
      for (Arm& arm : link.arms) renumber(arm.coordinate);
    }
    for (Closure& closure : out_.closures) {
      for (Arm& arm : closure.arms) renumber(arm.coordinate);
    }
  }

  void measure_size() {
    hops_[0].to = out_.anchor;
    std::vector<double> reach(out_.links.size(), 0.0);
    double size = 0.0;
    for (int i : out_.tree_order) {
      const Hop& hop = hops_[i];
      if (i != 0) reach[i] = reach[out_.links[i].parent] + norm(hop.from - hops_[out_.links[i].parent].to);
      const int travel = hop.joint < 0 ? -1 : out_.travel[hop.joint];
      if (travel >= 0) reach[i] += std::abs(out_.coordinates[travel].start);
      for (const Vec2& p : points_[i]) size = std::max(size, reach[i] + norm(p - hop.to));
    }
    if (size > 0) out_.size = size;
  }

  // How the tree reaches a link: from a point of its parent to a point of its own by a joint. A body that is not
  // connected is reached at its origin.
  struct Hop {
    Vec2 from{}, to{};
    int joint = -1;
  };

  const Scene& scene_;
  Purpose purpose_;
  Layout out_;
  std::vector<bool> cut_;  // per joint: closes a loop
  bool any_cut_ = false;
  std::optional<Vec2> anchor_;  // the first point of the ground that something uses and that does not vary
  std::vector<int> carriage_;   // per joint: coordinate of the travel of its carriage's end, or -1
  std::optional<Frames> frames_;
  std::vector<double> frame_open_;  // per representative: by how much the angles of its frame may be others, rad
  std::vector<int> bar_link_;
  std::vector<Connection> connections_;
  std::vector<std::vector<int>> around_;
  std::vector<bool> in_tree_;
  std::vector<Hop> hops_;
  std::vector<std::vector<Vec2>> points_;
  std::vector<unsigned> reasons_;
};

}  // namespace

Layout::Layout() = default;
Layout::Layout(const Layout&) = default;
Layout::Layout(Layout&&) noexcept = default;
Layout& Layout::operator=(const Layout&) = default;
Layout& Layout::operator=(Layout&&) noexcept = default;
Layout::~Layout() = default;

std::string Coordinate::why() const {
  if (reasons == 0) return "carries no load, closes no loop, moves no spring or stop";
  std::string words;
  const auto add = [&](Reason::Bit r, const char* text) {
    if (reasons & r) words += (words.empty() ? "" : ", ") + std::string(text);
  };
  add(Reason::closes_loop, "closes a loop");
  add(Reason::weight, "carries weight");
  add(Reason::load, "carries a load");
  add(Reason::spring, "moves a spring");
  add(Reason::stop, "has a stop");
  add(Reason::inertia, "has inertia");
  add(Reason::damper, "is damped");
  add(Reason::drive, "is driven");
  add(Reason::blade, "bears a blade");
  add(Reason::guides, "guides a slide");
  return words;
}

void Layout::scale_lengths(double factor) {
  const auto scale = [&](std::vector<Arm>& arms) {
    for (Arm& arm : arms) {
      if (is_length(arm.coordinate)) continue;  // a direction
      arm.arm = factor * arm.arm;
      arm.rounding = factor * arm.rounding;
      arm.open = factor * arm.open;
    }
  };
  for (Link& link : links) scale(link.arms);
  for (Closure& closure : closures) scale(closure.arms);
  for (Coordinate& c : coordinates) {
    if (c.kind == Coordinate::Kind::length) c.start *= factor;
    c.origin *= factor;
  }
  anchor = factor * anchor;
  size *= factor;
}

namespace {

// A component of an arm.
struct Component {
  double value;
  double open;
};

// The exact sum of numbers, and the sums of their roundings and of what they leave open. Pairs of equal numbers of
// opposite sign are the same number, with the same rounding; gaps of joints they do not share.
struct RoundedSum {
  explicit RoundedSum(std::vector<Component>& terms) {
    std::sort(terms.begin(), terms.end(),
              [](const Component& a, const Component& b) { return std::abs(a.value) < std::abs(b.value); });
    for (const Component& term : terms) open += term.open;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      if (k + 1 < terms.size() && terms[k].value == -terms[k + 1].value) {
        ++k;
        continue;
      }
      sum.add(terms[k].value);
      rounding += half_unit * std::abs(terms[k].value);
    }
  }

  ExactSum sum;
  double rounding = 0.0;
  double open = 0.0;
};

// Calls visit(link, sign) for the links from a and from b up to the nearest that both hang on, that one aside: -1 on
// the side of a, 1 on that of b.
template <class Visit>
void for_links_between(const std::vector<Link>& links, int a, int b, Visit visit) {
  while (a != b) {
    const bool from_a = links[a].depth > links[b].depth;
    int& link = from_a ? a : b;
    visit(link, from_a ? -1.0 : 1.0);
    link = links[link].parent;
  }
}

}  // namespace

void Layout::loosen(const std::vector<double>& by) {
  const auto loosen_arms = [](std::vector<Arm>& arms, double amount) {
    if (amount == 0.0) return;
    for (Arm& arm : arms) arm.open = {amount, amount};
  };
  std::vector<double> of_link(links.size(), 0.0);
  for (std::size_t c = 0; c < closures.size(); ++c) {
    for_links_between(links, closures[c].link_a, closures[c].link_b,
                      [&](int link, double) { of_link[link] = std::max(of_link[link], by[c]); });
  }
  // A link whose joint is at the origins of both bodies has no arm.
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (of_link[i] > 0.0) links[i].arms.push_back({});
    loosen_arms(links[i].arms, of_link[i]);
  }
  for (std::size_t c = 0; c < closures.size(); ++c) {
    double amount = by[c];
    for_links_between(links, closures[c].link_a, closures[c].link_b,
                      [&](int link, double) { amount = std::max(amount, of_link[link]); });
    if (amount > 0.0) closures[c].arms.push_back({});
    loosen_arms(closures[c].arms, amount);
  }
}

std::vector<Arm> Layout::paths_to(const Scene& scene, const Force& force) const {
  std::vector<Arm> out;
  force.for_each_point([&](PointRef point) {
    const std::vector<Arm> arms = path_to(scene, point);
    out.insert(out.end(), arms.begin(), arms.end());
  });
  std::stable_sort(out.begin(), out.end(), [](const Arm& l, const Arm& r) { return l.coordinate < r.coordinate; });
  return out;
}

LinkPoint Layout::place_of(const Scene& scene, PointRef p) const {
  return {scene.local(p), index_of(vectors, {VaryingVector::Of::point, p})};
}

namespace {

// Arms are sorted by coordinate and turn; those that vary come behind the others, the arms of each vector together.
bool comes_before(const Arm& l, const Arm& r) {
  if (l.coordinate != r.coordinate) return l.coordinate < r.coordinate;
  if (l.turn != r.turn) return l.turn < r.turn;
  return std::abs(l.vector) < std::abs(r.vector);
}

}  // namespace

std::vector<Arm> Layout::path_between(int link_a, const LinkPoint& a, int link_b, const LinkPoint& b) const {
  std::vector<Arm> arms;
  if (!is_zero(a)) arms.push_back({links[link_a].frame, -a.at, links[link_a].turn, -a.vector});
  if (!is_zero(b)) arms.push_back({links[link_b].frame, b.at, links[link_b].turn, b.vector});
  for_links_between(links, link_a, link_b, [&](int link, double sign) {
    for (Arm arm : links[link].arms) {
      arm.arm = sign * arm.arm;
      if (sign < 0.0) arm.vector = -arm.vector;
      arms.push_back(arm);
    }
  });
  std::stable_sort(arms.begin(), arms.end(), comes_before);
  std::vector<Arm> merged;
  std::vector<Component> xs, ys;
  for (auto arm = arms.begin(); arm != arms.end();) {
    const Arm& first = *arm;
    if (first.vector != 0) {
      const auto begin = arm;
      int times = 0;
      for (; arm != arms.end() && !comes_before(first, *arm); ++arm) times += arm->vector > 0 ? 1 : -1;
      const bool is_forward = times > 0;
      const auto one_of = std::find_if(begin, arm, [&](const Arm& one) { return (one.vector > 0) == is_forward; });
      for (; times != 0; times += is_forward ? -1 : 1) merged.push_back(*one_of);
      continue;
    }
    xs.clear();
    ys.clear();
    for (; arm != arms.end() && !comes_before(first, *arm); ++arm) {
      xs.push_back({arm->arm.x, arm->open.x});
      ys.push_back({arm->arm.y, arm->open.y});
    }
    const RoundedSum x(xs), y(ys);
    const bool is_open = x.open > 0.0 || y.open > 0.0;
    const std::size_t count = std::max({x.sum.parts().size(), y.sum.parts().size(), std::size_t{is_open ? 1U : 0U}});
    const auto part = [&](const ExactSum& sum, std::size_t k) {
      const std::size_t missing = count - sum.parts().size();
      return k < missing ? 0.0 : sum.parts()[k - missing];
    };
    for (std::size_t k = 0; k < count; ++k) {
      merged.push_back({first.coordinate, {part(x.sum, k), part(y.sum, k)}, first.turn, 0, {}});
    }
    if (count > 0) {
      merged.back().rounding = {x.rounding, y.rounding};
      merged.back().open = {x.open, y.open};
    }
  }
  return merged;
}

Layout lay_out(const Scene& scene, Purpose purpose, VaryingNumbers varying) {
  return Builder(scene, purpose, std::move(varying)).build();
}

}  // namespace poise
