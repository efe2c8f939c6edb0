#include "statics/friction/private/friction_problem.hpp"

#include <algorithm>
#include <cmath>
#include <list>
#include <variant>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "statics/bodies/ball_measures.hpp"
#include "statics/bodies/free_body_equations.hpp"
#include "statics/model/ball_mechanism.hpp"
#include "statics/model/check.hpp"

namespace poise {
namespace {

using BallBody = PlacedBody<Ball>;
using BallEquations = FreeBodyEquations<BallBody>;

// Rounding of the closed coordinates, of the mechanism's size and of radians: places of bodies are known to it.
constexpr double closure_rounding = 0x1p-49;
constexpr double basis_tolerance = 1e-11;  // of singular values of A, whose entries are of order one

std::vector<BallBody> placed(const StaticModel& model, const std::vector<double>& x) {
  std::vector<Ball> q;
  for (const double value : x) q.push_back(Ball(value).widened(closure_rounding * std::max(1.0, std::abs(value))));
  std::vector<BodyPose<Ball>> poses = model.balls().exact.poses(q.data(), model.layout().anchor);
  const Ball unit_length(model.scales().length);
  std::vector<BallBody> out;
  for (std::size_t i = 0; i < model.scene().bodies.size(); ++i) {
    poses[i].origin = {unit_length * poses[i].origin.x, unit_length * poses[i].origin.y};
    out.emplace_back(poses[i]);
  }
  return out;
}

Ball dot_of(const std::vector<std::pair<int, Ball>>& entries, const std::vector<Ball>& v) {
  Ball sum;
  for (const auto& [column, factor] : entries) sum += factor * v[static_cast<std::size_t>(column)];
  return sum;
}

// Encloses the solution x of M x = b, M square, near the given one: with Y about the inverse of M,
// |x - x0| <= |Y (b - M x0)| / (1 - |I - Y M|) in the greatest norm (S. M. Rump, "Verification methods", Acta Numerica
// 2010, section 10).
std::optional<std::vector<Ball>> enclosed(const std::vector<std::vector<Ball>>& m, const std::vector<Ball>& b) {
  const auto n = static_cast<Eigen::Index>(b.size());
  Eigen::MatrixXd middle(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right[i] = b[static_cast<std::size_t>(i)].middle();
    for (Eigen::Index j = 0; j < n; ++j) {
      middle(i, j) = m[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].middle();
    }
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(middle);
  if (!factors.isInvertible()) return std::nullopt;
  const Eigen::MatrixXd y = factors.inverse();
  Eigen::VectorXd x = y * right;
  const auto residual = [&](Eigen::Index i) {
    Ball r = b[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < n; ++j) {
      r -= m[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] * Ball(x[j]);
    }
    return r;
  };
  for (int step = 0; step < 2; ++step) {
    Eigen::VectorXd r(n);
    for (Eigen::Index i = 0; i < n; ++i) r[i] = residual(i).middle();
    x += y * r;
  }
  std::vector<Ball> r;
  for (Eigen::Index i = 0; i < n; ++i) r.push_back(residual(i));
  double contraction = 0.0;
  double step = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    double row = 0.0;
    Ball moved;
    for (Eigen::Index j = 0; j < n; ++j) {
      Ball c(i == j ? -1.0 : 0.0);
      for (Eigen::Index k = 0; k < n; ++k) {
        if (y(i, k) != 0.0) c += Ball(y(i, k)) * m[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)];
      }
      row += c.greatest();
      moved += Ball(y(i, j)) * r[static_cast<std::size_t>(j)];
    }
    contraction = std::max(contraction, row * (1.0 + 1e-12));
    step = std::max(step, moved.greatest());
  }
  if (!(contraction < 0.5) || !std::isfinite(step)) return std::nullopt;
  const double radius = step / (1.0 - contraction) * (1.0 + 1e-12);
  std::vector<Ball> out;
  for (Eigen::Index i = 0; i < n; ++i) out.push_back(Ball(x[i]).widened(radius));
  return out;
}

// Columns of M, taken times their weights, with which pivoted QR finds it regular; none where it is not.
std::optional<std::vector<int>> basis_of(Eigen::MatrixXd m, const Eigen::VectorXd& weights) {
  for (Eigen::Index j = 0; j < m.cols(); ++j) m.col(j) *= weights[j];
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(m);
  qr.setThreshold(1e-13);
  if (qr.rank() < m.rows()) return std::nullopt;
  std::vector<int> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i) out.push_back(static_cast<int>(qr.colsPermutation().indices()[i]));
  return out;
}

// The angle of a rope's wrap on a pulley that it lies on.
Ball wrap_of(const Scene& scene, const Measure& rope, int contact, const std::vector<BallBody>& bodies) {
  const auto k = static_cast<std::size_t>(contact);
  const BodyForces at(scene, bodies);
  return rope_wrap(at.rope_part(rope, k - 1).along, at.rope_part(rope, k).along, rope.contacts[k].turn);
}

// Its bound is 0 whatever it carries.
bool is_idle(const Scene& scene, const Rubbing& one) {
  if (one.rope >= 0) {
    const Measure& rope = scene.stops[static_cast<std::size_t>(one.rope)].on;
    return rope.contacts[static_cast<std::size_t>(one.contact)].friction == 0.0;
  }
  if (one.joint < 0)
    return std::get<DryFriction>(scene.elements[static_cast<std::size_t>(one.element)].law).bound() == 0.0;
  const Joint& joint = scene.joints[static_cast<std::size_t>(one.joint)];
  const JointFriction& friction = *joint.friction;
  if (joint.has_travel()) return friction.coefficient == 0.0 && friction.force == 0.0;
  return friction.circle() == 0.0 && friction.torque == 0.0;
}

}  // namespace

// The steps in which the equations are set up.
class FrictionProblem::Assembly {
 public:
  explicit Assembly(FrictionProblem& of)
      : to_(of),
        scene_(of.model_.scene()),
        size_(of.model_.scales().length),
        equations_(scene_, of.bodies_, size_),
        tension_(scene_.stops.size()) {}

  void run() {
    add_joints();
    add_stops();
    const std::vector<Rubbing> all = rubbing(scene_);
    to_.rubbings_ = all.size();
    for (std::size_t r = 0; r < all.size(); ++r) {
      if (is_idle(scene_, all[r])) continue;
      if (all[r].rope >= 0 ? add_rope(all[r]) : add_rubbing(all[r])) to_.of_rubbing_.push_back(r);
    }
    fill();
  }

 private:
  int columns() const { return static_cast<int>(equations_.unknowns().size()); }

  void add_joints() {
    equations_.add_joints();
    first_of_joint_.assign(scene_.joints.size(), -1);
    for (std::size_t u = 0; u < equations_.unknowns().size(); ++u) {
      int& first = first_of_joint_[static_cast<std::size_t>(equations_.unknowns()[u].item)];
      if (first < 0) first = static_cast<int>(u);
    }
  }

  // Adds the stops that are touched in the pose, with the teeth that push their wheels apart.
  void add_stops() {
    const CheckTolerances tolerances;
    const std::vector<BodyPose<double>> poses = to_.model_.poses_from_anchor(to_.x_);
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      const Stop& stop = scene_.stops[s];
      const double near = tolerances.stop * (stop.on.is_angle() ? 1.0 : size_);
      const double g = value_of(scene_, stop.on, poses);
      const bool at_max = g >= stop.max - near, at_min = g <= stop.min + near;
      if (!at_max && !at_min) continue;
      const int before = columns();
      equations_.add_stop(static_cast<int>(s), at_max && at_min ? 2 : at_max ? 1 : -1);
      const int side = equations_.items().back().side;
      if (columns() == before) continue;
      if (side != 2) to_.pressures_.emplace_back(before, -side);
      tension_[s].push_back(before);
      if (!separates(stop)) continue;
      to_.teeth_.push_back({before, columns()});
      equations_.add_separation(static_cast<int>(s));
    }
  }

  // Adds the friction of a rope on a pulley. False where the rope is slack.
  bool add_rope(const Rubbing& one) {
    std::vector<int>& before = tension_[static_cast<std::size_t>(one.rope)];
    if (before.empty()) return false;
    const Stop& rope = scene_.stops[static_cast<std::size_t>(one.rope)];
    Source source;
    source.tension = before;
    source.effort = columns();
    source.wrap = Ball(*rope.on.contacts[static_cast<std::size_t>(one.contact)].friction) *
                  wrap_of(scene_, rope.on, one.contact, to_.bodies_);
    equations_.add_rope_behind(rope, one.contact);
    before.push_back(source.effort);
    to_.sources_.push_back(std::move(source));
    return true;
  }

  // Adds the friction of an element or a joint. False where its measure has no direction in the pose.
  bool add_rubbing(const Rubbing& one) {
    Drive& drive = on_measures_.emplace_back();
    drive.name = one.name;
    drive.on = one.on;
    Source source;
    source.effort = columns();
    equations_.add_drive(drive);
    if (columns() == source.effort) return false;
    source.si = one.on.is_angle() ? size_ : 1.0;
    if (one.joint < 0) {
      const Element& element = scene_.elements[static_cast<std::size_t>(one.element)];
      source.constant = Ball(std::get<DryFriction>(element.law).bound()) / Ball(source.si);
    } else {
      set_bound(source, one.joint);
    }
    to_.sources_.push_back(std::move(source));
    return true;
  }

  // Sets what the bound of a joint's friction depends on.
  void set_bound(Source& source, int of_joint) const {
    const Joint& joint = scene_.joints[static_cast<std::size_t>(of_joint)];
    const JointFriction& friction = *joint.friction;
    const int first = first_of_joint_[static_cast<std::size_t>(of_joint)];
    const Ball mu(friction.coefficient);
    if (!joint.has_travel()) {
      const Ball over(source.si);
      source.constant = Ball(friction.torque) / over;
      source.circle = Ball(friction.radius) * mu / sqrt(Ball(1) + mu * mu) / over;
      if (friction.circle() > 0.0) source.pin = first;
      return;
    }
    source.constant = Ball(friction.force);
    if (friction.coefficient > 0.0) source.pieces.emplace_back(first, mu);
    // The moment is measured over the size.
    if (joint.keeps_angle() && friction.coefficient > 0.0 && friction.length > 0.0) {
      source.pieces.emplace_back(first + 1, mu * Ball(2) * Ball(size_) / Ball(friction.length));
    }
  }

  // Fills the matrix and the forces of a unit of each column.
  void fill() {
    const auto count = static_cast<std::size_t>(columns());
    to_.columns_ = columns();
    to_.a_.assign(static_cast<std::size_t>(equations_.rows()), std::vector<Ball>(count));
    for (std::size_t u = 0; u < count; ++u) {
      const BallEquations::Unknown& unknown = equations_.unknowns()[u];
      equations_.for_each_entry(unknown,
                                [&](int row, const Ball& value) { to_.a_[static_cast<std::size_t>(row)][u] += value; });
      const BallEquations::Item& item = equations_.items()[static_cast<std::size_t>(unknown.item)];
      const std::string kind(item.kind == "drive" ? "friction" : item.kind);
      std::vector<SourcedForce>& actions = to_.actions_.emplace_back();
      equations_.for_each_action(unknown,
                                 [&](int body, const Planar<Ball>& at, const Planar<Ball>& force, const Ball& moment) {
                                   actions.push_back({kind,
                                                      *item.name,
                                                      {.body = body,
                                                       .at = {at.x.middle(), at.y.middle()},
                                                       .force = {force.x.middle(), force.y.middle()},
                                                       .moment = moment.middle()}});
                                 });
    }
  }

  FrictionProblem& to_;
  const Scene& scene_;
  const double size_;
  BallEquations equations_;
  std::vector<int> first_of_joint_;        // column, or -1
  std::vector<std::vector<int>> tension_;  // columns of ropes that are taut
  std::list<Drive> on_measures_;           // the equations keep references to their names
};

FrictionProblem::FrictionProblem(const StaticModel& model, const std::vector<double>& x)
    : model_(model), x_(x), bodies_(placed(model, x)) {
  Assembly(*this).run();
  set_load(load_of(model.scene()));
}

std::vector<Ball> FrictionProblem::load_of(const Scene& scene) const {
  const BallEquations equations(scene, bodies_, model_.scales().length);
  std::vector<Ball> out(static_cast<std::size_t>(equations.rows()));
  const auto push = [&](int body, const Planar<Ball>& at, const Planar<Ball>& force, const Ball& moment) {
    if (body == 0) return;
    const std::size_t row = 3 * (static_cast<std::size_t>(body) - 1);
    out[row] += force.x;
    out[row + 1] += force.y;
    out[row + 2] += equations.turning(body, at, force, moment);
  };
  equations.push_loads(push);
  equations.push_elements(push);
  return out;
}

std::vector<SourcedForce> FrictionProblem::forces_on_bodies(const Eigen::VectorXd& v) const {
  const Scene& scene = model_.scene();
  const std::vector<BodyPose<double>> poses = model_.poses(x_);
  const std::vector<double> element_forces =
      FreeBodyEquations(scene, poses, 1.0).push_elements([](int, Vec2, Vec2, double) {});
  std::vector<SourcedForce> out = poise::forces_on_bodies(scene, poses, element_forces, {});
  for (std::size_t u = 0; u < actions_.size(); ++u) {
    const double effort = unit_ * v[static_cast<Eigen::Index>(u)];
    for (SourcedForce action : actions_[u]) {
      action.on.force = effort * action.on.force;
      action.on.moment *= effort;
      out.push_back(std::move(action));
    }
  }
  return out;
}

void FrictionProblem::set_load(std::vector<Ball> load, bool keep_constants) {
  load_ = std::move(load);
  slope_.clear();
  constants_count_ = keep_constants;
  refresh();
}

void FrictionProblem::set_slope(std::vector<Ball> slope) {
  slope_ = std::move(slope);
  refresh();
}

void FrictionProblem::refresh() {
  const auto rows = static_cast<Eigen::Index>(a_.size());
  const Eigen::Index columns = columns_ + (varies() ? 1 : 0);
  unit_ = 0.0;
  for (const Ball& one : load_) unit_ = std::max(unit_, std::abs(one.middle()));
  if (constants_count_) {
    for (const Source& source : sources_) unit_ = std::max(unit_, source.constant.middle());
  }
  unit_ = unit_ > 0.0 ? std::exp2(std::ceil(std::log2(unit_))) : 1.0;
  double steepest = 0.0;
  for (const Ball& one : slope_) steepest = std::max(steepest, std::abs(one.middle()));
  q_unit_ = steepest > 0.0 ? std::exp2(std::ceil(std::log2(unit_ / steepest))) : 1.0;
  middle_.resize(rows, columns);
  Eigen::VectorXd right(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto& row = a_[static_cast<std::size_t>(i)];
    for (int j = 0; j < columns_; ++j) middle_(i, j) = row[static_cast<std::size_t>(j)].middle();
    if (varies()) middle_(i, columns_) = slope_[static_cast<std::size_t>(i)].middle() * (q_unit_ / unit_);
    right[i] = -load_[static_cast<std::size_t>(i)].middle() / unit_;
  }
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(middle_, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(basis_tolerance);
  solutions_.particular = svd.solve(right);
  solutions_.basis = svd.matrixV().rightCols(columns - svd.rank());
  solutions_.residual = right - middle_ * solutions_.particular;
  solutions_.gap = rows > 0 ? solutions_.residual.cwiseAbs().maxCoeff() : 0.0;
}

std::vector<FrictionProblem::Row> FrictionProblem::rows(const Choice& choice, double factor, Side side) const {
  std::vector<Row> out;
  for (const auto& [column, sign] : pressures_) out.push_back({{{column, Ball(-sign)}}, Ball(0)});
  const Ball k(factor);
  for (std::size_t t = 0; t < teeth_.size(); ++t) add_teeth_rows(teeth_[t], choice[sources_.size() + t].sign, out);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    const Source& source = sources_[s];
    const Part& part = choice[s];
    if (!source.tension.empty()) {
      add_rope_rows(s, k, out);
      continue;
    }
    const bool is_constant = source.pin < 0 && source.pieces.empty();
    if (part.kind == Part::Kind::open && !is_constant) continue;
    std::vector<std::pair<int, Ball>> bound;
    if (part.kind == Part::Kind::piece) {
      const auto& [column, slope] = source.pieces[static_cast<std::size_t>(part.piece)];
      bound.emplace_back(column, -(k * Ball(part.sign) * slope));
    } else if (part.kind == Part::Kind::sector) {
      const Vec2 g = side == Side::inner ? inner_direction(part) : outer_direction(part);
      bound.emplace_back(source.pin, -(k * source.circle * Ball(g.x)));
      bound.emplace_back(source.pin + 1, -(k * source.circle * Ball(g.y)));
      if (side == Side::outer) {
        out.push_back(
            {{{source.pin, Ball(part.first.y)}, {source.pin + 1, Ball(-part.first.x)}}, Ball(0), -1, 0, true});
        out.push_back({{{source.pin, Ball(-part.last.y)}, {source.pin + 1, Ball(part.last.x)}}, Ball(0), -1, 0, true});
      }
    }
    for (const int sign : {1, -1}) {
      Row row;
      row.entries = bound;
      row.entries.emplace_back(source.effort, Ball(sign));
      if (constants_count_) row.bound = k * source.constant / Ball(unit_);
      row.source = static_cast<int>(s);
      row.sign = sign;
      row.has_slack = constants_count_ || !is_constant;
      out.push_back(std::move(row));
    }
  }
  return out;
}

std::vector<FrictionProblem::Choice> FrictionProblem::whole() const {
  std::vector<Choice> out{Choice(sources_.size())};
  for (std::size_t t = 0; t < teeth_.size(); ++t) {
    const std::size_t before = out.size();
    for (std::size_t i = 0; i < before; ++i) {
      Choice other = out[i];
      out[i].push_back({Part::Kind::piece, 0, 1, {}, {}});
      other.push_back({Part::Kind::piece, 0, -1, {}, {}});
      out.push_back(std::move(other));
    }
  }
  return out;
}

// size = sign effort >= 0.
void FrictionProblem::add_teeth_rows(const Teeth& teeth, int sign, std::vector<Row>& out) {
  for (const int side : {1, -1}) {
    Row row;
    row.entries = {{teeth.size, Ball(side)}, {teeth.effort, Ball(-side * sign)}};
    row.has_slack = false;
    row.equation = side;
    out.push_back(std::move(row));
  }
  Row row;
  row.entries = {{teeth.effort, Ball(-sign)}};
  row.has_slack = false;
  out.push_back(std::move(row));
}

void FrictionProblem::add_rope_rows(std::size_t s, const Ball& factor, std::vector<Row>& out) const {
  const Source& source = sources_[s];
  const Ball e = exp(factor * source.wrap);
  for (const int sign : {-1, 1}) {
    Row row;
    for (const int column : source.tension) row.entries.emplace_back(column, e - Ball(1));
    row.entries.emplace_back(source.effort, sign < 0 ? Ball(-1) : e);
    row.source = static_cast<int>(s);
    row.sign = sign;
    out.push_back(std::move(row));
  }
}

// At most 1 long, so that g R <= |R| whatever R is.
Vec2 FrictionProblem::inner_direction(const Part& part) {
  const Vec2 middle = part.first + part.last;
  return ((1.0 - 1e-15) / norm(middle)) * middle;
}

// g R >= |R| for all R = a first + b last, a, b >= 0: it is for both ends, and |R| is convex.
Vec2 FrictionProblem::outer_direction(const Part& part) {
  const Vec2 middle = part.first + part.last;
  const double least = std::min(dot(middle, part.first) / norm(part.first), dot(middle, part.last) / norm(part.last));
  return ((1.0 + 1e-15) / least) * middle;
}

double FrictionProblem::bound_at(std::size_t s, const Eigen::VectorXd& v) const {
  const Source& source = sources_[s];
  if (!source.tension.empty()) {
    double before = 0.0;
    for (const int column : source.tension) before -= v[column];
    return std::expm1(source.wrap.middle()) * std::min(before, before - v[source.effort]);
  }
  double out = 0.0;
  for (const auto& [column, slope] : source.pieces) out = std::max(out, slope.middle() * std::abs(v[column]));
  if (source.pin >= 0) out = source.circle.middle() * std::hypot(v[source.pin], v[source.pin + 1]);
  return constants_count_ ? out + source.constant.middle() / unit_ : out;
}

FrictionProblem::Choice FrictionProblem::choice_at(const Eigen::VectorXd& v) const {
  Choice out(sources_.size());
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    const Source& source = sources_[s];
    if (source.pin >= 0) {
      Vec2 r{v[source.pin], v[source.pin + 1]};
      if (r == Vec2{}) r = {1.0, 0.0};
      r = (1.0 / norm(r)) * r;
      out[s] = {Part::Kind::sector, 0, 1, r, r};
    } else if (!source.pieces.empty()) {
      double largest = -1.0;
      for (std::size_t p = 0; p < source.pieces.size(); ++p) {
        const auto& [column, slope] = source.pieces[p];
        if (slope.middle() * std::abs(v[column]) <= largest) continue;
        largest = slope.middle() * std::abs(v[column]);
        out[s] = {Part::Kind::piece, static_cast<int>(p), v[column] < 0 ? -1 : 1, {}, {}};
      }
    }
  }
  for (const Teeth& teeth : teeth_) out.push_back({Part::Kind::piece, 0, v[teeth.effort] < 0 ? -1 : 1, {}, {}});
  return out;
}

std::vector<FrictionProblem::Part> FrictionProblem::divided(std::size_t s, const Part& part) const {
  const Source& source = sources_[s];
  std::vector<Part> out;
  if (part.kind == Part::Kind::open && source.pin >= 0) {
    const Vec2 at[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    for (int i = 0; i < 4; ++i) out.push_back({Part::Kind::sector, 0, 1, at[i], at[i + 1]});
  } else if (part.kind == Part::Kind::open) {
    for (std::size_t p = 0; p < source.pieces.size(); ++p) {
      for (const int sign : {1, -1}) out.push_back({Part::Kind::piece, static_cast<int>(p), sign, {}, {}});
    }
  } else if (part.kind == Part::Kind::sector && cross(part.first, part.last) > 3e-6) {
    const Vec2 middle = (1.0 / norm(part.first + part.last)) * (part.first + part.last);
    out.push_back({Part::Kind::sector, 0, 1, part.first, middle});
    out.push_back({Part::Kind::sector, 0, 1, middle, part.last});
  }
  return out;
}

bool FrictionProblem::proves_point(const Eigen::VectorXd& v, const std::vector<Row>& rows, bool strictly) const {
  const double largest = columns_ > 0 ? v.head(columns_).cwiseAbs().maxCoeff() : 0.0;
  Eigen::VectorXd weights(columns_);
  for (int j = 0; j < columns_; ++j) weights[j] = largest > 0 ? 1e-3 + std::abs(v[j]) / largest : 1.0;
  std::vector<const Row*> of_teeth;
  for (const Row& row : rows) {
    if (row.equation == 1) of_teeth.push_back(&row);
  }
  const auto balances = static_cast<Eigen::Index>(a_.size());
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(balances + static_cast<Eigen::Index>(of_teeth.size()), columns_);
  equations.topRows(balances) = middle_.leftCols(columns_);
  for (std::size_t t = 0; t < of_teeth.size(); ++t) {
    for (const auto& [column, value] : of_teeth[t]->entries) {
      equations(balances + static_cast<Eigen::Index>(t), column) = value.middle();
    }
  }
  const auto basis = basis_of(equations, weights);
  if (!basis) return false;
  std::vector<Ball> u;
  std::vector<char> is_basic(static_cast<std::size_t>(columns_), 0);
  for (const int j : *basis) is_basic[static_cast<std::size_t>(j)] = 1;
  for (int j = 0; j < columns_; ++j) u.emplace_back(v[j]);
  std::vector<std::vector<Ball>> square(a_.size());
  std::vector<Ball> right;
  for (std::size_t i = 0; i < a_.size(); ++i) {
    for (const int j : *basis) square[i].push_back(a_[i][static_cast<std::size_t>(j)]);
    Ball r = -(load_[i] / Ball(unit_));
    for (int j = 0; j < columns_; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (is_basic[at] == 0) r -= a_[i][at] * u[at];
    }
    right.push_back(r);
  }
  for (const Row* const row : of_teeth) {
    std::vector<Ball> all(static_cast<std::size_t>(columns_));
    for (const auto& [column, value] : row->entries) all[static_cast<std::size_t>(column)] = value;
    std::vector<Ball>& of_basis = square.emplace_back();
    for (const int j : *basis) of_basis.push_back(all[static_cast<std::size_t>(j)]);
    Ball r = row->bound;
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (is_basic[j] == 0) r -= all[j] * u[j];
    }
    right.push_back(r);
  }
  const auto solved = enclosed(square, right);
  if (!solved) return false;
  for (std::size_t k = 0; k < basis->size(); ++k) u[static_cast<std::size_t>((*basis)[k])] = (*solved)[k];
  return std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
    if (row.equation != 0) return true;
    const Ball slack = row.bound - dot_of(row.entries, u);
    return strictly && row.has_slack ? slack > Ball(0) : slack >= Ball(0);
  });
}

Eigen::VectorXd FrictionProblem::load_over_unit() const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(load_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = load_[static_cast<std::size_t>(i)].middle() / unit_;
  return out;
}

// r = target - A^T y - G^T z for the y that leaves least of it, and y load - z bounds.
FrictionProblem::Combined FrictionProblem::combined(const Eigen::VectorXd& target, const Eigen::VectorXd& z,
                                                    const std::vector<Row>& rows) const {
  const auto equations = static_cast<Eigen::Index>(a_.size());
  const Eigen::MatrixXd transposed = matrix().transpose();
  Eigen::VectorXd left = target;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [column, value] : rows[r].entries)
      left[column] -= value.middle() * z[static_cast<Eigen::Index>(r)];
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(transposed);
  Eigen::VectorXd y = factors.solve(left);
  y += factors.solve(left - transposed * y);
  Combined out;
  for (int j = 0; j < columns_; ++j) out.residual.emplace_back(target[j]);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Ball factor(z[static_cast<Eigen::Index>(r)]);
    for (const auto& [column, value] : rows[r].entries)
      out.residual[static_cast<std::size_t>(column)] -= value * factor;
    out.value -= factor * rows[r].bound;
  }
  for (Eigen::Index i = 0; i < equations; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const Ball factor(y[i]);
    for (int j = 0; j < columns_; ++j)
      out.residual[static_cast<std::size_t>(j)] -= a_[row][static_cast<std::size_t>(j)] * factor;
    out.value += factor * load_[row] / Ball(unit_);
  }
  return out;
}

// With r = -(A^T y + G^T z), A u = -load and G u <= bounds:  y load - z bounds <= r u <= most sum |r|.
bool FrictionProblem::proves_none(const Eigen::VectorXd& z, const std::vector<Row>& rows, double most) const {
  if (z.size() != static_cast<Eigen::Index>(rows.size()) || z.size() == 0) return false;
  const double largest = z.maxCoeff();
  if (!(largest > 0.0) || z.minCoeff() < 0.0) return false;
  const Combined sum = combined(Eigen::VectorXd::Zero(columns_), z / largest, rows);
  Ball left;
  for (const Ball& r : sum.residual) left += abs(r);
  return sum.value > Ball(most) * left;
}

// u_j = (e_j - A^T y - G^T z) u + y A u + z G u <= sum |r| + s (z bounds - y load) for s of 0 to 1 / most.
bool FrictionProblem::proves_below_one(int column, double sign, const Eigen::VectorXd& z, const std::vector<Row>& rows,
                                       double most) const {
  if (z.size() > 0 && z.minCoeff() < 0.0) return false;
  const Combined sum = combined(sign * Eigen::VectorXd::Unit(columns_, column), z, rows);
  Ball bound;
  for (const Ball& r : sum.residual) bound += abs(r);
  return bound < Ball(1) && bound - sum.value / Ball(most) < Ball(1);
}

}  // namespace poise
