#include "tests/judge/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <boost/math/constants/constants.hpp>
#include <fmt/format.h>

namespace poise::judge {
namespace {

using Eigen::Index;

// Relative pivots: below the first a row repeats others to the rounding of doubles, above the second it does not.
constexpr double dependent_below = 1e-13;
constexpr double independent_above = 1e-8;
constexpr double candidate_gap = 1e-5;        // of stops and one-way springs that may change their state
constexpr double farthest_from_answer = 0.3;  // of an equilibrium from the answer
constexpr double flat_over = 1e-3;            // along a neutral freedom
constexpr double flat_within = 1e-13;         // force there over force scale
constexpr double condition_limit = 1e10;
// Distances below this are rounding of the answer's own numbers.
constexpr double least_radius = 4e-16;
constexpr std::array ways_aside = {-1e-3, 1e-5, 2e-3};
const Real exact = 1e-30;  // zero, computed in 50 digits, relative
constexpr int most_candidates = 6;

double to_double(const Real& x) { return static_cast<double>(x); }
Real largest(const Matrix& a) { return a.size() > 0 ? Real(a.cwiseAbs().maxCoeff()) : Real(0); }

// The rows of the joints and contacts in one pose, factored: J^T P = Q R.
struct Rows {
  explicit Rows(const Matrix& jacobian, double tolerance) : qr(Matrix(jacobian.transpose())) {
    const Index most = std::min(jacobian.rows(), jacobian.cols());
    const Real first = most > 0 ? abs(Real(qr.matrixR()(0, 0))) : Real(0);
    while (rank < most && abs(Real(qr.matrixR()(rank, rank))) > tolerance * first && first > 0) ++rank;
    least_pivot = rank > 0 ? to_double(abs(Real(qr.matrixR()(rank - 1, rank - 1))) / first) : 1.0;
    dropped_pivot = rank < most && first > 0 ? to_double(abs(Real(qr.matrixR()(rank, rank))) / first) : 0.0;
    for (Index i = 0; i < jacobian.rows(); ++i) order.push_back(qr.colsPermutation().indices()[i]);
  }

  // Columns of Q from `first` on.
  Matrix columns(Index first, Index count) const {
    Matrix out = Matrix::Zero(qr.rows(), count);
    for (Index i = 0; i < count; ++i) out(first + i, i) = 1;
    return qr.householderQ() * out;
  }
  Matrix kernel() const { return columns(rank, qr.rows() - rank); }
  Matrix R() const { return qr.matrixR().topLeftCorner(rank, rank); }
  // Shortest p with J p = c on the independent rows.
  Vector shortest(const Vector& c) const {
    Vector out = Vector::Zero(qr.rows());
    if (rank == 0) return out;
    Vector picked(rank);
    for (Index i = 0; i < rank; ++i) picked[i] = c[order[i]];
    out.head(rank) = R().transpose().triangularView<Eigen::Lower>().solve(picked);
    return qr.householderQ() * out;
  }
  // Multipliers with  J^T y = -f  as nearly as possible, zero on dependent rows.
  Vector multipliers(const Vector& f) const {
    Vector out = Vector::Zero(static_cast<Index>(order.size()));
    if (rank == 0) return out;
    const Vector along = qr.householderQ().adjoint() * f;
    const Vector y = R().triangularView<Eigen::Upper>().solve(Vector(-along.head(rank)));
    for (Index i = 0; i < rank; ++i) out[order[i]] = y[i];
    return out;
  }

  Eigen::ColPivHouseholderQR<Matrix> qr;
  Index rank = 0;
  double least_pivot = 1.0, dropped_pivot = 0.0;  // relative
  std::vector<Index> order;
};

// An additional equation  w . (q - from) = t,  whose multiplier is the force that holds q there.
struct Guide {
  Vector w, from;
  Real t;
};

struct System {
  Forces forces;
  Matrix jacobian;
  Vector gap;
};

System system_at(const ExactMechanics& mechanics, const Vector& q, const Piece& piece, const Guide* guide) {
  System out;
  out.forces = mechanics.at(q, piece);
  const auto count = static_cast<Index>(out.forces.rows.size());
  out.jacobian.resize(count + (guide != nullptr ? 1 : 0), q.size());
  out.gap.resize(out.jacobian.rows());
  for (Index i = 0; i < count; ++i) {
    out.jacobian.row(i) = out.forces.rows[i].grad.transpose();
    out.gap[i] = out.forces.rows[i].value;
  }
  if (guide != nullptr) {
    out.jacobian.row(count) = guide->w.transpose();
    out.gap[count] = guide->w.dot(q - guide->from) - guide->t;
  }
  return out;
}

Matrix tangent(const Forces& forces, const Vector& multipliers) {
  Matrix K = forces.stiffness;
  for (std::size_t i = 0; i < forces.rows.size(); ++i) {
    if (multipliers[static_cast<Index>(i)] != 0) forces.rows[i].add_hessian(multipliers[static_cast<Index>(i)], K);
  }
  return K;
}

// A pose in which the independent rows hold.
struct Closed {
  bool closed = false;
  Vector q;
  std::vector<Index> kept;     // rows
  std::vector<Index> dropped;  // rows that repeat them
  double open = 0.0;           // by which the dropped ones do not hold
  double open_contacts = 0.0;  // those of them that are contacts
  double least_pivot = 1.0;
  double dropped_pivot = 0.0;
};

// Shortest steps onto the constraints. With `places_first` angles are held as nearly as loops permit: they are what an
// answer knows best, where its lengths are rounded far from the origin.
Closed close(const ExactMechanics& mechanics, Vector q, const Piece& piece, const Guide* guide, bool places_first) {
  Closed out;
  const Vector start = q;
  Real last = 1;
  for (int k = 0; k < 60; ++k) {
    System s = system_at(mechanics, q, piece, guide);
    const bool weigh = places_first && k == 0;
    if (weigh) {
      for (Index i = 2; i < q.size(); i += 3) s.jacobian.col(i) *= Real(1e-6);
    }
    // Rows that repeat others do so where they hold.
    const Rows rows(s.jacobian, std::max(last > 1e-14 ? 1e-11 : dependent_below, mechanics.rounding()));
    Vector p = -rows.shortest(s.gap);
    if (weigh) {
      for (Index i = 2; i < q.size(); i += 3) p[i] *= Real(1e-6);
    }
    q += p;
    if (largest(q - start) > farthest_from_answer) return out;
    const bool done = !weigh && largest(p) <= 1e-40 && last <= 1e-14;
    last = largest(p);
    if (!done) continue;
    out.closed = true;
    out.kept.assign(rows.order.begin(), rows.order.begin() + rows.rank);
    out.dropped.assign(rows.order.begin() + rows.rank, rows.order.end());
    for (const Index i : out.dropped) out.open = std::max(out.open, std::abs(to_double(s.gap[i])));
    out.least_pivot = rows.least_pivot;
    out.dropped_pivot = rows.dropped_pivot;
    out.q = q;
    return out;
  }
  return out;
}

Matrix rows_of(const Matrix& a, const std::vector<Index>& rows) {
  Matrix out(static_cast<Index>(rows.size()), a.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(static_cast<Index>(i)) = a.row(rows[i]);
  return out;
}

Vector entries_of(const Vector& a, const std::vector<Index>& rows) {
  Vector out(static_cast<Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) out[static_cast<Index>(i)] = a[rows[i]];
  return out;
}

// Minimum norm, so that neutral freedoms stay where they are: what is below `zero` counts as none.
Vector solve(const Matrix& a, const Vector& b, const Real& zero) {
  const Real most = largest(a);
  if (b.size() == 0 || most <= zero) return Vector::Zero(a.cols());
  Eigen::CompleteOrthogonalDecomposition<Matrix> factors;
  factors.setThreshold(Real(zero / most));
  factors.compute(a);
  return factors.solve(b);
}

struct Solution {
  bool converged = false;
  Closed at;           // the pose and its rows
  Vector multipliers;  // of all rows, the guide last
  Matrix kernel;       // of the kept rows
  Matrix reduced;      // stiffness on it
  Real residual;       // force along the kernel
  bool smooth = true;
};

// Values of a solution in its pose.
void measure(const ExactMechanics& mechanics, const Piece& piece, const Guide* guide, Solution& out) {
  const System s = system_at(mechanics, out.at.q, piece, guide);
  const Rows rows(rows_of(s.jacobian, out.at.kept), 0.0);
  const Vector y = rows.multipliers(s.forces.force);
  out.multipliers = Vector::Zero(s.gap.size());
  for (std::size_t i = 0; i < out.at.kept.size(); ++i) out.multipliers[out.at.kept[i]] = y[static_cast<Index>(i)];
  out.kernel = rows.kernel();
  out.reduced = out.kernel.transpose() * tangent(s.forces, out.multipliers) * out.kernel;
  out.residual = largest(out.kernel.transpose() * s.forces.force);
  out.smooth = s.forces.smooth;
}

// Newton's method on  F + J^T y = 0,  gap = 0  from a pose where the gaps are closed. Curvatures below `zero` are taken
// for none.
Solution newton(const ExactMechanics& mechanics, const Closed& from, const Piece& piece, const Guide* guide,
                const Real& zero) {
  Solution out;
  out.at = from;
  Vector multipliers;
  Vector& q = out.at.q;
  Real last = 1;
  for (int k = 0; k < 40; ++k) {
    const System s = system_at(mechanics, q, piece, guide);
    if (!s.forces.smooth) break;
    const Rows rows(rows_of(s.jacobian, from.kept), 0.0);
    if (k == 0) multipliers = rows.multipliers(s.forces.force);
    Vector all = Vector::Zero(s.gap.size());
    for (std::size_t i = 0; i < from.kept.size(); ++i) all[from.kept[i]] = multipliers[static_cast<Index>(i)];
    const Matrix K = tangent(s.forces, all);
    const Matrix N = rows.kernel();
    Vector p = -rows.shortest(entries_of(s.gap, from.kept));
    const Vector z = solve(N.transpose() * K * N, -(N.transpose() * (s.forces.force + K * p)), zero);
    p += N * z;
    const Real step = largest(p);
    if (step > 0.1) p *= 0.1 / step;
    multipliers = rows.multipliers(s.forces.force + K * p);
    q += p;
    if (largest(q - from.q) > farthest_from_answer) return out;
    if (step < 1e-36 || (step < 1e-30 && step > last / 2)) {
      out.converged = true;
      break;
    }
    last = step;
  }
  if (out.converged) {
    const System s = system_at(mechanics, q, piece, guide);
    out.at.open = out.at.open_contacts = 0.0;
    const auto contacts = static_cast<Index>(piece.contacts.size());
    for (const Index i : from.dropped) {
      const double open = std::abs(to_double(s.gap[i]));
      out.at.open = std::max(out.at.open, open);
      const Index rows = s.gap.size() - (guide != nullptr ? 1 : 0);
      if (i < rows && i >= rows - contacts) out.at.open_contacts = std::max(out.at.open_contacts, open);
    }
    measure(mechanics, piece, guide, out);
  }
  return out;
}

// Eigenvalues of the smaller of 0 and v^T K v over the unit vectors with G v >= 0: the least one, with its vector. The
// least value over the cone is an eigenvalue of K restricted to one of its faces.
struct Least {
  Real value = std::numeric_limits<double>::infinity();
  Vector v;
};

Matrix kernel_of(const Matrix& a, double tolerance) {
  return a.rows() == 0 ? Matrix(Matrix::Identity(a.cols(), a.cols())) : Rows(a, tolerance).kernel();
}

Least least_on_cone(const Matrix& K, const Matrix& G) {
  Least out;
  for (unsigned face = 0; face < (1U << G.rows()); ++face) {
    std::vector<Index> held;
    for (Index i = 0; i < G.rows(); ++i) {
      if ((face >> i & 1U) != 0) held.push_back(i);
    }
    const Matrix N = kernel_of(rows_of(G, held), 1e-25);
    if (N.cols() == 0) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(N.transpose() * (K + K.transpose()) * N / Real(2));
    for (Index k = 0; k < N.cols(); ++k) {
      if (eigen.eigenvalues()[k] >= out.value) break;
      for (const int sign : {1, -1}) {
        const Vector v = N * (sign * eigen.eigenvectors().col(k));
        const Vector along = G * v;
        if (along.size() > 0 && along.minCoeff() < -exact) continue;
        if (eigen.eigenvalues()[k] < out.value) out = {eigen.eigenvalues()[k], v};
      }
    }
  }
  return out;
}

class ClaimSearch {
 public:
  ClaimSearch(const ExactMechanics& mechanics, const Claim& claim)
      : mechanics_(mechanics), scene_(mechanics.scene()), claim_(claim) {
    Vector q(mechanics.coordinates());
    for (std::size_t b = 1; b < scene_.bodies.size(); ++b) {
      const auto i = static_cast<Index>(3 * (b - 1));
      q[i] = Real(claim.origins[b].x) / mechanics.length();
      q[i + 1] = Real(claim.origins[b].y) / mechanics.length();
      q[i + 2] = claim.angles[b];
    }
    claimed_ = q;
    base_ = by_signs(q, {});
    start_ = close(mechanics, q, base_, nullptr, true);
    if (!start_.closed) return;
    scale_ = mechanics.force_scale(start_.q);
    list_candidates();
  }

  const std::vector<Truth>& found() const { return found_; }
  const std::string& trouble() const { return trouble_; }

  // The piece in which the answer seems to be. True if it has an equilibrium.
  bool try_present() {
    if (!start_.closed) return false;
    if (is_singular() && (try_singular() || !start_.dropped.empty())) return !found_.empty();
    Piece piece = base_;
    for (const Contact& c : candidates_) {
      if (abs(gap(c, start_.q)) < 1e-9) piece.contacts.push_back(c);
    }
    return try_piece(piece, true);
  }

  // All pieces that meet near the answer, then searches along soft freedoms.
  void try_all() {
    if (!start_.closed) {
      trouble_ = "the joints do not close near the answer";
      return;
    }
    if (is_singular() && !start_.dropped.empty()) return;
    const std::size_t count = candidates_.size() + kinks_.size();
    if (count > most_candidates) {
      trouble_ = "too many stops and one-way springs near their limits";
      return;
    }
    for (const bool exactly : {true, false}) {
      for (unsigned k = 0; k < (1U << count); ++k) {
        if (const std::optional<Piece> piece = numbered(k)) try_piece(*piece, exactly);
      }
      if (!found_.empty()) break;
    }
  }

  // Beside a pose where joints lose rank Newton's method is tried from displaced starts.
  void try_displaced() {
    if (!start_.closed || !kinks_.empty() || !candidates_.empty()) return;
    if (start_.least_pivot > 1e-5 && largest(start_.q - claimed_) < 1e-6) return;
    const System s = system_at(mechanics_, claimed_, base_, nullptr);
    const Matrix N = Rows(s.jacobian, 1e-5).kernel();
    for (Index k = 0; k < N.cols(); ++k) {
      for (double way = 1e-9; way < 1e-5; way *= 10) {
        for (const int sign : {-1, 1}) {
          const Closed from = close(mechanics_, claimed_ + sign * way * N.col(k), base_, nullptr, false);
          if (!from.closed || from.dropped.size() != start_.dropped.size()) continue;
          const Solution solution = newton(mechanics_, from, base_, nullptr, exact * scale_);
          if (solution.converged && solution.residual <= exact * scale_ && take(solution, base_, true)) return;
        }
      }
    }
    if (found_.empty()) trouble_ = "near a pose where joints lose rank";
  }

  void try_soft() {
    if (!start_.closed || is_singular()) return;
    const std::size_t count = candidates_.size() + kinks_.size();
    if (count > 3) return;
    for (unsigned k = 0; k < (1U << count); ++k) {
      if (const std::optional<Piece> piece = numbered(k)) search_along_soft_freedom(*piece);
    }
  }

 private:
  Real gap(const Contact& c, const Vector& q) const {
    const Stop& stop = scene_.stops[c.stop];
    return c.side * (mechanics_.limit(stop, c.side) - mechanics_.measure(stop.on, q).value);
  }

  static LinearSpring::Acts acts(const Element& element) {
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    return spring == nullptr ? LinearSpring::Acts::both : spring->acts;
  }

  // g - g0, negative if slack.
  Real pull(std::size_t e, const Vector& q) const {
    const Element& element = scene_.elements[e];
    const Real stretch = mechanics_.measure(element.on, q).value - mechanics_.free_length(element);
    return acts(element) == LinearSpring::Acts::tension ? stretch : Real(-stretch);
  }

  // The piece of a pose: springs by their sign, stops that hold their measure always, and `contacts`.
  Piece by_signs(const Vector& q, const std::vector<Contact>& contacts) const {
    Piece piece;
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      piece.slack.push_back(acts(scene_.elements[e]) != LinearSpring::Acts::both && pull(e, q) <= 0);
    }
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      if (scene_.stops[s].min == scene_.stops[s].max) piece.contacts.push_back({static_cast<int>(s), 1});
    }
    piece.contacts.insert(piece.contacts.end(), contacts.begin(), contacts.end());
    return piece;
  }

  void list_candidates() {
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      const Stop& stop = scene_.stops[s];
      if (stop.min == stop.max) continue;
      for (const int side : {-1, 1}) {
        const Contact c{static_cast<int>(s), side};
        if (std::isfinite(side > 0 ? stop.max : stop.min) && abs(gap(c, start_.q)) < candidate_gap) {
          candidates_.push_back(c);
        }
      }
    }
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      const Element& element = scene_.elements[e];
      if (acts(element) == LinearSpring::Acts::both || std::get<LinearSpring>(element.law).stiffness == 0.0) continue;
      if (abs(pull(e, start_.q)) < candidate_gap) kinks_.push_back(e);
    }
    if (start_.dropped.empty()) return;
    const Real rounding = 1e-14;
    const bool open =
        std::any_of(candidates_.begin(), candidates_.end(),
                    [&](const Contact& c) { return abs(gap(c, start_.q)) < rounding; }) ||
        std::any_of(kinks_.begin(), kinks_.end(), [&](std::size_t e) { return abs(pull(e, start_.q)) < rounding; });
    if (open) trouble_ = "redundant joints, which agree to rounding, leave open which stops and springs act";
  }

  // The k-th combination of contacts and of slack springs; empty for both sides of one stop.
  std::optional<Piece> numbered(unsigned k) const {
    Piece piece = base_;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if ((k >> i & 1U) == 0) continue;
      const bool other_side = std::any_of(piece.contacts.begin(), piece.contacts.end(),
                                          [&](const Contact& c) { return c.stop == candidates_[i].stop; });
      if (other_side) return std::nullopt;
      piece.contacts.push_back(candidates_[i]);
    }
    for (std::size_t i = 0; i < kinks_.size(); ++i) {
      piece.slack[kinks_[i]] = (k >> (candidates_.size() + i) & 1U) != 0;
    }
    return piece;
  }

  Closed closed(const Piece& piece) const {
    return piece.contacts == base_.contacts ? start_ : close(mechanics_, start_.q, piece, nullptr, false);
  }

  bool try_piece(const Piece& piece, bool exactly) {
    const auto known = std::find_if(solved_.begin(), solved_.end(), [&](const auto& s) { return s.first == piece; });
    if (known == solved_.end()) {
      solved_.emplace_back(piece, solution_of(piece));
      return solved_.back().second.converged && take(solved_.back().second, piece, exactly);
    }
    return known->second.converged && take(known->second, piece, exactly);
  }

  Solution solution_of(const Piece& piece) const {
    const Closed from = closed(piece);
    if (!from.closed || from.dropped.size() != start_.dropped.size()) return {};
    const auto exactly = [&] {
      Solution solution = newton(mechanics_, from, piece, nullptr, exact * scale_);
      solution.converged = solution.converged && solution.residual <= exact * scale_;
      return solution;
    };
    // Balanced to rounding of the scene's numbers only?
    const auto to_rounding = [&] {
      Solution rounded = newton(mechanics_, from, piece, nullptr, flat_within * scale_);
      rounded.converged = rounded.converged && rounded.residual <= flat_within * scale_ && is_flat(rounded, piece);
      return rounded;
    };
    Solution solution = claim_.neutral ? to_rounding() : exactly();
    if (!solution.converged) solution = claim_.neutral ? exactly() : to_rounding();
    return solution;
  }

  // Whether the force stays within rounding along all freedoms whose curvature is.
  bool is_flat(const Solution& solution, const Piece& piece) const {
    const Matrix sum = solution.reduced + solution.reduced.transpose();
    if (sum.cols() == 0) return true;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(sum / Real(2));
    for (Index k = 0; k < sum.cols(); ++k) {
      if (abs(eigen.eigenvalues()[k]) > flat_within * std::max(scale_, largest(sum))) continue;
      if (!is_flat_along(solution, piece, solution.kernel * eigen.eigenvectors().col(k))) return false;
    }
    return true;
  }

  bool is_flat_along(const Solution& solution, const Piece& piece, const Vector& w) const {
    for (const double t : {-flat_over, flat_over}) {
      const std::optional<Real> force =
          force_along(solution.at, piece, {w, solution.at.q, Real(t)}, flat_within * scale_);
      if (!force || abs(*force) > flat_within * scale_) return false;
    }
    return true;
  }

  // dV/dt where a guide holds the mechanism; empty if it cannot be held there.
  std::optional<Real> force_along(const Closed& near, const Piece& piece, const Guide& guide, const Real& zero,
                                  Closed* reached = nullptr) const {
    const Closed from = close(mechanics_, near.q, piece, &guide, false);
    if (!from.closed) return std::nullopt;
    const Solution held = newton(mechanics_, from, piece, &guide, zero);
    if (!held.converged) return std::nullopt;
    if (reached != nullptr) *reached = held.at;
    return -held.multipliers[held.multipliers.size() - 1];
  }

  // Whether stops and one-way springs are as the piece has them.
  bool holds(const Solution& solution, const Piece& piece, const Real& tolerance) const {
    const Vector& q = solution.at.q;
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      const Stop& stop = scene_.stops[s];
      if (stop.min == stop.max) continue;
      for (const int side : {-1, 1}) {
        if (std::isfinite(side > 0 ? stop.max : stop.min) && gap({static_cast<int>(s), side}, q) < -tolerance) {
          return false;
        }
      }
    }
    for (std::size_t i = 0; i < piece.contacts.size(); ++i) {
      const Contact& c = piece.contacts[i];
      if (scene_.stops[c.stop].min == scene_.stops[c.stop].max) continue;
      if (c.side * push(solution, piece, i) < -tolerance * scale_) return false;
    }
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      if (acts(scene_.elements[e]) == LinearSpring::Acts::both) continue;
      const Real pulled = pull(e, q);
      if (piece.slack[e] ? pulled > tolerance : pulled < -tolerance) return false;
    }
    return true;
  }

  // Multiplier of the i-th contact.
  static Real push(const Solution& solution, const Piece& piece, std::size_t i) {
    const Index rows = solution.multipliers.size();
    return solution.multipliers[rows - static_cast<Index>(piece.contacts.size() - i)];
  }

  bool take(const Solution& solution, const Piece& piece, bool exactly) {
    if (!solution.smooth) {
      trouble_ = "a spring or stop acts on points that coincide";
      return false;
    }
    // Rounding of the numbers moves a place by it over the smallest pivot.
    const Real tolerance =
        exactly ? exact : Real(std::max({1e-14, mechanics_.rounding(), 1e-16 / solution.at.least_pivot}));
    if (solution.at.open > std::max(1e-12, mechanics_.rounding()) || !holds(solution, piece, tolerance)) return false;
    Truth truth;
    truth.distance = distance(solution.at.q);
    truth.allowance = allowance(solution);
    find_kind(solution, piece, tolerance, truth);
    truth.exact = exactly && solution.at.open_contacts <= least_radius;
    if (!exactly) truth.note += "; stops hold to rounding only";
    // A push that is rounding too, of another stop, may be one in exact numbers.
    if (!exactly && !truth.strict) {
      truth.at_free_length = truth.decided && truth.at_free_length;
      truth.decided = false;
    }
    found_.push_back(truth);
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Truth& a, const Truth& b) { return a.distance < b.distance; });
    return true;
  }

  double distance(const Vector& q) const {
    Real most = 0;
    const Real whole = 2 * boost::math::constants::pi<Real>();
    for (const ClaimedCoordinate& c : claim_.coordinates) {
      Real off;
      if (c.of == ClaimedCoordinate::Of::angle) {
        off = c.value - mechanics_.angle(c.item, q);
      } else if (c.of == ClaimedCoordinate::Of::bar) {
        const Joint& bar = scene_.joints[c.item];
        const Planar<Real> along = mechanics_.place(bar.b, q) - mechanics_.place(bar.a, q);
        off = c.value - atan2(along.y, along.x);
        off -= whole * floor(Real(off / whole + 0.5));
      } else if (c.of == ClaimedCoordinate::Of::travel) {
        off = c.value / mechanics_.length() - mechanics_.travel(c.item, q);
      } else {
        off = (Real(c.value) + c.origin) / mechanics_.length() -
              q[3 * (c.item - 1) + (c.of == ClaimedCoordinate::Of::x ? 0 : 1)];
      }
      most = std::max<Real>(most, abs(off));
    }
    return to_double(most);
  }

  // Change of the equilibrium if the dropped rows were held in place of others.
  double allowance(const Solution& solution) const {
    if (solution.at.dropped.empty()) return 0.0;
    const Real open = std::max(solution.at.open, 1e-16);
    double softness = 1.0;
    if (solution.reduced.size() > 0) {
      Real least = -1;
      const Eigen::SelfAdjointEigenSolver<Matrix> eigen(solution.reduced.transpose() * solution.reduced);
      for (Index k = 0; k < solution.reduced.cols(); ++k) {
        const Real sigma = sqrt(abs(Real(eigen.eigenvalues()[k])));
        if (sigma > flat_within * scale_ && (least < 0 || sigma < least)) least = sigma;
      }
      if (least > 0) softness += to_double(std::max(scale_, largest(solution.multipliers)) / least);
    }
    return to_double(open) * softness / solution.at.least_pivot;
  }

  // --- kind of an equilibrium ---------------------------------------------------------------------------------------

  // What an equilibrium is at the limit of: stops in contact without force and springs at their free length, which
  // leave a choice of pieces.
  struct Limits {
    Piece strict;                    // with the contacts that push alone
    std::vector<Contact> weak;       // those that do not
    std::vector<std::size_t> kinks;  // springs
  };

  Limits limits_of(const Solution& solution, const Piece& piece, const Real& tolerance) const {
    const Vector& q = solution.at.q;
    Limits out{piece, {}, {}};
    // The multipliers stand in the order of the piece's contacts, of which those that hold their measure come first.
    out.strict.contacts = base_.contacts;
    for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
      const Stop& stop = scene_.stops[s];
      if (stop.min == stop.max) continue;
      for (const int side : {-1, 1}) {
        const Contact c{static_cast<int>(s), side};
        if (!std::isfinite(side > 0 ? stop.max : stop.min) || abs(gap(c, q)) > tolerance) continue;
        const auto in = std::find(piece.contacts.begin(), piece.contacts.end(), c);
        const bool pushes =
            in != piece.contacts.end() &&
            abs(push(solution, piece, static_cast<std::size_t>(in - piece.contacts.begin()))) > tolerance * scale_;
        (pushes ? out.strict.contacts : out.weak).push_back(c);
      }
    }
    for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
      if (acts(scene_.elements[e]) != LinearSpring::Acts::both && abs(pull(e, q)) <= tolerance &&
          std::get<LinearSpring>(scene_.elements[e].law).stiffness != 0.0) {
        out.kinks.push_back(e);
      }
    }
    return out;
  }

  // Directions that weak stops and kinks tell apart, by freedom: rows of the former, then of the latter.
  Matrix directions_of(const Limits& limits, const Vector& q, const Matrix& N) const {
    const std::vector<Contact>& weak = limits.weak;
    Matrix G(static_cast<Index>(weak.size() + limits.kinks.size()), N.cols());
    for (std::size_t i = 0; i < weak.size(); ++i) {
      G.row(static_cast<Index>(i)) =
          -weak[i].side * (mechanics_.measure(scene_.stops[weak[i].stop].on, q).grad.transpose() * N);
    }
    for (std::size_t i = 0; i < limits.kinks.size(); ++i) {
      G.row(static_cast<Index>(weak.size() + i)) =
          mechanics_.measure(scene_.elements[limits.kinks[i]].on, q).grad.transpose() * N;
    }
    return G;
  }

  // The least curvature over all pieces next to the equilibrium, each on its cone of directions.
  Least least_curvature(const Limits& limits, const Vector& q, const Solution& solution, const Matrix& G) const {
    const Matrix& N = solution.kernel;
    Least least;
    for (unsigned side = 0; side < (1U << limits.kinks.size()); ++side) {
      Piece adjacent = limits.strict;
      Matrix cone = G;
      for (std::size_t i = 0; i < limits.kinks.size(); ++i) {
        const bool slack = (side >> i & 1U) != 0;
        adjacent.slack[limits.kinks[i]] = slack;
        const bool tension = acts(scene_.elements[limits.kinks[i]]) == LinearSpring::Acts::tension;
        if (slack == tension) cone.row(static_cast<Index>(limits.weak.size() + i)) *= Real(-1);
      }
      const Forces forces = mechanics_.at(q, adjacent);
      const Least here = least_on_cone(N.transpose() * tangent(forces, solution.multipliers) * N, cone);
      if (here.value < least.value) least = here;
    }
    return least;
  }

  void find_kind(const Solution& solution, const Piece& piece, const Real& tolerance, Truth& truth) {
    const Vector& q = solution.at.q;
    const Limits limits = limits_of(solution, piece, tolerance);
    const Piece& strict = limits.strict;
    truth.strict = limits.weak.empty() && limits.kinks.empty();
    truth.at_free_length = limits.weak.empty() && !limits.kinks.empty();

    Solution held = solution;
    if (!limits.weak.empty()) {
      held.at = close(mechanics_, q, strict, nullptr, false);
      measure(mechanics_, strict, nullptr, held);
    }
    const Index motions = held.kernel.cols();
    held = without_idle(held);
    truth.also_neutral = held.kernel.cols() < motions;
    const Matrix& N = held.kernel;
    const Real stiffest = std::max(scale_, largest(held.reduced));
    const Real zero = exact * stiffest;
    if (N.cols() == 0) {
      truth.kind = Kind::stable;
      truth.condition = 1.0 / held.at.least_pivot;
      truth.note = "nothing can move";
      return;
    }
    if (mechanics_.has_followers() && N.cols() > 1) {
      judge_followers(held, stiffest, truth);
      return;
    }
    const Matrix G = directions_of(limits, q, N);
    if (G.rows() > most_candidates) {
      truth.decided = false;
      truth.note = "too many stops and springs without force";
      return;
    }
    const Least least = least_curvature(limits, q, held, G);
    const Matrix sum = held.reduced + held.reduced.transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(sum / Real(2));
    Real smallest = abs(Real(eigen.eigenvalues()[0]));
    for (Index k = 0; k < N.cols(); ++k) {
      smallest = std::min<Real>(smallest, abs(Real(eigen.eigenvalues()[k])));
      truth.negative += eigen.eigenvalues()[k] < -zero;
    }
    truth.condition = std::max(to_double(stiffest / std::max<Real>(smallest, zero)), 1.0 / held.at.least_pivot);
    if (least.v.size() == 0) {
      truth.kind = Kind::stable;  // the cone is a point
      return;
    }
    if (!held.at.dropped.empty() && smallest <= flat_within * stiffest) {
      truth.decided = false;
      truth.note = "redundant joints, which agree to rounding, leave the sign of a curvature open";
    }
    if (abs(least.value) > zero) {
      truth.kind = least.value > 0 ? Kind::stable : Kind::unstable;
      if (smallest <= flat_within * stiffest && truth.strict && is_flat(held, strict)) truth.also_neutral = true;
      return;
    }
    judge_degenerate(held, strict, least.v, eigen.eigenvalues(), zero, truth);
  }

  // Without the freedoms on which nothing depends that carries a load: a link that hangs on one pin.
  Solution without_idle(Solution solution) const {
    if (solution.kernel.cols() == 0) return solution;
    const Matrix observed = mechanics_.observed(solution.at.q) * solution.kernel;
    Matrix seen(observed.rows() + solution.reduced.rows(), solution.kernel.cols());
    seen << observed, solution.reduced / std::max(scale_, largest(solution.reduced));
    const Matrix idle = largest(seen) < exact ? Matrix(Matrix::Identity(seen.cols(), seen.cols()))  //
                                              : kernel_of(seen, 1e-20);
    if (idle.cols() == 0) return solution;
    const Matrix rest = kernel_of(idle.transpose(), 1e-20);
    solution.reduced = Matrix(rest.transpose() * solution.reduced * rest);
    solution.kernel = Matrix(solution.kernel * rest);
    return solution;
  }

  void judge_followers(const Solution& held, const Real& stiffest, Truth& truth) {
    if (!truth.strict) {
      truth.decided = false;
      truth.note = "follower loads at a stop or spring without force";
      return;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> squares(held.reduced.transpose() * held.reduced);
    const Real smallest = sqrt(abs(Real(squares.eigenvalues()[0])));
    truth.condition =
        std::max(to_double(stiffest / std::max<Real>(smallest, exact * stiffest)), 1.0 / held.at.least_pivot);
    const Real determinant = Eigen::FullPivLU<Matrix>(held.reduced).determinant();
    if (smallest <= exact * stiffest) {
      truth.kind = Kind::neutral;
      truth.decided = false;
      truth.note = "follower loads with a singular stiffness";
      return;
    }
    truth.kind = determinant < 0 ? Kind::unstable : Kind::unknown;
    truth.negative = determinant < 0 ? 1 : 0;
    truth.also_neutral = smallest <= flat_within * stiffest;
  }

  // No negative curvature, and a zero one.
  void judge_degenerate(const Solution& held, const Piece& strict, const Vector& v, const Vector& curvatures,
                        const Real& zero, Truth& truth) {
    truth.condition = std::numeric_limits<double>::infinity();
    const auto zeros = (curvatures.array().abs() <= zero).count();
    if (is_flat(held, strict)) {
      truth.kind = Kind::neutral;
      return;
    }
    if (!truth.strict || zeros > 1 || mechanics_.has_followers()) {
      truth.decided = false;
      truth.note = "degenerate in several directions, or at a stop or spring without force";
      return;
    }
    const double way = 1e-5;
    const Vector w = held.kernel * v;
    truth.kind = Kind::stable;
    truth.note = "curvature zero, judged by the force beside it";
    for (const double t : {-way, way}) {
      const std::optional<Real> force = force_along(held.at, strict, {w, held.at.q, Real(t)}, exact * scale_);
      if (!force) {
        truth.decided = false;
        truth.note = "degenerate";
        return;
      }
      if (*force * t <= 0) truth.kind = Kind::unstable;
    }
  }

  // --- where Newton's method finds nothing --------------------------------------------------------------------------

  // The force along the softest freedom as a function of the way t along it, all else balanced: its zeros.
  void search_along_soft_freedom(const Piece& piece) {
    const Closed from = closed(piece);
    if (!from.closed || from.dropped.size() != start_.dropped.size()) return;
    Solution here;
    here.at = from;
    measure(mechanics_, piece, nullptr, here);
    if (!here.smooth) trouble_ = "a spring or stop acts on points that coincide";
    here = without_idle(here);
    if (here.kernel.cols() == 0) return;
    const Matrix sum = here.reduced + here.reduced.transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(sum / Real(2));
    const Vector q0 = from.q;
    Index softest = 0;
    for (Index k = 1; k < sum.cols(); ++k) {
      if (abs(eigen.eigenvalues()[k]) < abs(eigen.eigenvalues()[softest])) softest = k;
    }
    std::vector<Index> soft;
    for (Index k = 0; k < sum.cols(); ++k) {
      const Real stiffest = std::max(scale_, largest(sum));
      if (k == softest || abs(eigen.eigenvalues()[k]) < 1e-8 * stiffest) soft.push_back(k);
    }
    // Along some of several soft freedoms there may be no force anywhere.
    if (soft.size() > 1) {
      std::erase_if(soft, [&](Index k) {
        const Vector along = here.kernel * eigen.eigenvectors().col(k);
        return std::all_of(ways_aside.begin(), ways_aside.end(), [&](double t) {
          const std::optional<Real> f = force_along(from, piece, {along, q0, Real(t)}, exact * scale_);
          return f && abs(*f) <= exact * scale_;
        });
      });
    }
    if (soft.empty()) return;
    if (soft.size() > 1) {
      trouble_ = "soft in several directions";
      return;
    }
    const Vector w = here.kernel * eigen.eigenvectors().col(soft.front());
    const auto force = [&](const Real& t) { return force_along(from, piece, {w, q0, t}, exact * scale_); };

    struct Sample {
      Real t, force;
    };
    std::vector<Sample> samples;
    for (const int side : {-1, 1}) {
      for (int k = 0; k <= 24; ++k) {
        const Real t = side * 1e-16 * std::pow(4.0, k);
        const std::optional<Real> f = force(t);
        if (!f) break;
        samples.push_back({t, *f});
      }
    }
    if (const std::optional<Real> f = force(Real(0))) samples.push_back({Real(0), *f});
    std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.t < b.t; });
    if (samples.size() < 20) trouble_ = "the softest freedom cannot be followed";

    // Where the force comes near zero between two samples and turns back it may reach it.
    const auto slope = [&](const Real& t, const Real& h) -> std::optional<Real> {
      const std::optional<Real> after = force(t + h);
      const std::optional<Real> before = force(t - h);
      if (!after || !before) return std::nullopt;
      return Real(*after - *before);
    };
    for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
      const Sample &a = samples[i - 1], &b = samples[i], &c = samples[i + 1];
      if (a.force * b.force <= 0 || b.force * c.force <= 0) continue;
      if (abs(b.force) > abs(a.force) || abs(b.force) > abs(c.force)) continue;
      const Real h = (c.t - a.t) * 1e-9;
      const std::optional<Real> turn = zero_between(a.t, c.t, [&](const Real& t) { return slope(t, h); });
      if (!turn) continue;
      if (const std::optional<Real> f = force(*turn)) {
        samples.insert(samples.begin() + static_cast<std::ptrdiff_t>(*turn < b.t ? i : i + 1), {*turn, *f});
        ++i;
      }
    }
    for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
      if (samples[i].force * samples[i + 1].force > 0) continue;
      const std::optional<Real> t = zero_between(samples[i].t, samples[i + 1].t, force);
      if (!t) continue;
      Closed reached;
      if (!force_along(from, piece, {w, q0, *t}, exact * scale_, &reached)) continue;
      const Closed begin = close(mechanics_, reached.q, piece, nullptr, false);
      const Solution solution = newton(mechanics_, begin, piece, nullptr, exact * scale_);
      if (solution.converged && solution.residual <= exact * scale_) take(solution, piece, true);
    }
  }

  // Regula falsi (Illinois), to 1e-14 of the interval.
  template <class F>
  static std::optional<Real> zero_between(Real a, Real b, F f) {
    std::optional<Real> fa = f(a);
    std::optional<Real> fb = f(b);
    if (!fa || !fb) return std::nullopt;
    if (*fa == 0) return a;
    if (*fb == 0) return b;
    if (*fa * *fb > 0) return std::nullopt;
    const Real within = 1e-14 * (b - a);
    int last = 0;
    for (int k = 0; k < 80; ++k) {
      const Real c = b - *fb * (b - a) / (*fb - *fa);
      const std::optional<Real> fc = f(c);
      if (!fc) return std::nullopt;
      const bool left = *fc * *fb > 0;
      const Real moved = left ? Real(b - c) : Real(c - a);
      if (left) {
        b = c;
        fb = fc;
        if (last == 1) fa = *fa / 2;
        last = 1;
      } else {
        a = c;
        fa = fc;
        if (last == -1) fb = *fb / 2;
        last = -1;
      }
      if (*fc == 0 || moved < within || b - a < within) return c;
    }
    return (a + b) / 2;
  }

  // --- change points ------------------------------------------------------------------------------------------------

  // Whether fewer joint equations are independent at the answer than beside it.
  bool is_singular() {
    if (!singular_) singular_ = start_.dropped_pivot > 0.0 || !start_.dropped.empty() ? loses_rank() : false;
    if (!*singular_ && start_.least_pivot < independent_above) singular_ = true;
    return *singular_;
  }

  bool loses_rank() const {
    const System s = system_at(mechanics_, start_.q, base_, nullptr);
    const Matrix N = Rows(s.jacobian, std::max(dependent_below, mechanics_.rounding())).kernel();
    for (int k = 0; k < 3; ++k) {
      Vector z(N.cols());
      for (Index i = 0; i < z.size(); ++i) z[i] = std::sin(1.0 + 2.7 * static_cast<double>(i) + 1.3 * k);
      Vector q = start_.q + 1e-3 * (N * z);
      for (int step = 0; step < 40; ++step) {
        const System beside = system_at(mechanics_, q, base_, nullptr);
        const Rows rows(beside.jacobian, 1e-7);
        const Vector p = rows.shortest(beside.gap);
        q -= p;
        if (largest(p) > 1e-25) continue;
        return rows.rank > static_cast<Index>(start_.kept.size());
      }
    }
    return !start_.dropped.empty();
  }

  // q and u of  gap = 0,  J^T u = 0,  u . u = 1  nearest to the answer, by Gauss and Newton.
  bool try_singular() {
    Vector q = start_.q;
    System s = system_at(mechanics_, q, base_, nullptr);
    const Index m = s.gap.size();
    const Index n = q.size();
    // The smallest left singular vector.
    const Eigen::SelfAdjointEigenSolver<Matrix> squares(s.jacobian * s.jacobian.transpose());
    Vector u = squares.eigenvectors().col(0);
    if (m > 1 && sqrt(abs(Real(squares.eigenvalues()[1]))) < independent_above) {
      trouble_ = "joints lose rank more than once";
      return false;
    }
    bool converged = false;
    for (int k = 0; k < 30 && !converged; ++k) {
      s = system_at(mechanics_, q, base_, nullptr);
      Matrix H = Matrix::Zero(n, n);
      for (Index i = 0; i < m; ++i) s.forces.rows[i].add_hessian(u[i], H);
      Matrix D = Matrix::Zero(m + n + 1, n + m);
      D.topLeftCorner(m, n) = s.jacobian;
      D.block(m, 0, n, n) = H;
      D.block(m, n, n, m) = s.jacobian.transpose();
      D.bottomRightCorner(1, m) = 2 * u.transpose();
      Vector r(m + n + 1);
      r << s.gap, s.jacobian.transpose() * u, Vector::Constant(1, u.dot(u) - 1);
      const Vector p = solve(D, -r, 1e-12 * largest(D));
      q += p.head(n);
      u += p.tail(m);
      if (largest(q - start_.q) > farthest_from_answer) break;
      // Equations that agree to rounding of doubles only leave a rest.
      converged = largest(p) < 1e-20 && largest(r) < 1e-13;
    }
    if (!converged) {
      trouble_ = "near a pose where joints lose rank";
      return false;
    }
    s = system_at(mechanics_, q, base_, nullptr);
    const Rows rows(s.jacobian, 1e-12);
    const Matrix N = rows.kernel();
    Truth truth;
    truth.distance = distance(q);
    truth.strict = candidates_.empty() && kinks_.empty();
    truth.allowance = 1e-15;
    truth.note = "change point";
    if (largest(N.transpose() * s.forces.force) > flat_within * scale_) {
      // No finite joint forces.
      if (truth.distance > least_radius) trouble_ = "near a pose where joints lose rank";
      return false;
    }
    Matrix H = Matrix::Zero(n, n);
    for (Index i = 0; i < m; ++i) s.forces.rows[i].add_hessian(u[i], H);
    const Matrix Q = N.transpose() * H * N;
    const Matrix K = N.transpose() * tangent(s.forces, rows.multipliers(s.forces.force)) * N;
    truth.decided = truth.strict && !mechanics_.has_followers() && N.cols() == 2 && s.forces.smooth;
    if (truth.decided) judge_branches(Q, K, truth);
    found_.push_back(truth);
    return true;
  }

  // Branches leave along v with  Q(v, v) = 0;  the energy on them has the curvature K(v, v).
  void judge_branches(const Matrix& Q, const Matrix& K, Truth& truth) const {
    const Real scale = largest(Q);
    const Real determinant = Q(0, 0) * Q(1, 1) - Q(0, 1) * Q(1, 0);
    if (scale < 1e-9 || abs(determinant) < 1e-9 * scale * scale) {
      truth.decided = false;
      truth.note = "change point whose branches touch";
      return;
    }
    truth.kind = Kind::stable;
    if (determinant > 0) return;  // no branch: nothing can move
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Q);
    const Real a = sqrt(abs(Real(eigen.eigenvalues()[0])));
    const Real b = sqrt(abs(Real(eigen.eigenvalues()[1])));
    for (const int sign : {1, -1}) {
      Vector v = b * eigen.eigenvectors().col(0) + sign * a * eigen.eigenvectors().col(1);
      v.normalize();
      const Real curvature = v.dot(K * v);
      if (abs(curvature) < flat_within * scale_) {
        truth.decided = false;
        truth.note = "change point, neutral along a branch";
        return;
      }
      if (curvature < 0) truth.kind = Kind::unstable;
    }
  }

  const ExactMechanics& mechanics_;
  const Scene& scene_;
  const Claim& claim_;
  Piece base_;      // by the signs at the answer, without contacts
  Vector claimed_;  // the answer
  Closed start_;    // with its joints closed
  Real scale_;      // force scale
  std::vector<Contact> candidates_;
  std::vector<std::size_t> kinks_;
  std::optional<bool> singular_;
  std::vector<std::pair<Piece, Solution>> solved_;
  std::vector<Truth> found_;
  std::string trouble_;
};

double radius_of(const Claim& claim) { return claim.radius.value_or(Judge::near); }

bool agrees(const Truth& truth, const Claim& claim) {
  if (!truth.decided || claim.kind == Kind::unknown || claim.kind == truth.kind) return true;
  if (truth.kind == Kind::unknown && claim.kind == Kind::stable) return false;
  return claim.kind == Kind::neutral && truth.also_neutral;
}

bool is_inside(const Truth& truth, const Claim& claim) {
  return truth.distance <= std::max(radius_of(claim), least_radius) + truth.allowance;
}

Judgement judge_confirmed(const Claim& claim, const std::vector<Truth>& truths, const std::string& trouble) {
  if (truths.empty() || truths.front().distance > Judge::near) {
    if (!trouble.empty()) return {Verdict::undecided, std::nullopt, trouble};
    if (truths.empty()) return {Verdict::no_equilibrium, std::nullopt, "no equilibrium near"};
    const bool inside = is_inside(truths.front(), claim);
    const std::string why = fmt::format("the nearest equilibrium is {:.2g} away", truths.front().distance);
    if (!inside) return {Verdict::no_equilibrium, truths.front(), why};
  }
  if (!is_inside(truths.front(), claim)) {
    if (!trouble.empty()) return {Verdict::undecided, truths.front(), trouble};
    return {Verdict::outside_radius, truths.front(),
            fmt::format("{:.2g} away, claimed within {:.2g}", truths.front().distance, radius_of(claim))};
  }
  bool undecided = false;
  for (const Truth& truth : truths) {
    if (!is_inside(truth, claim)) break;
    if (!truth.decided && !(truth.at_free_length && claim.kind == truth.kind)) {
      undecided = true;
      continue;
    }
    if (agrees(truth, claim)) return {Verdict::right, truth, truth.note};
  }
  const Truth& truth = truths.front();
  if (undecided || !trouble.empty()) return {Verdict::undecided, truth, undecided ? truth.note : trouble};
  return {Verdict::wrong_kind, truth,
          fmt::format("claimed {}, is {} {}", to_string(claim.kind), to_string(truth.kind), truth.note)};
}

Judgement judge_unconfirmed(const Claim& claim, const std::vector<Truth>& truths) {
  for (const Truth& truth : truths) {
    if (truth.distance > Judge::near || !truth.decided || !truth.exact || truth.also_neutral) continue;
    if (!(truth.condition < condition_limit)) continue;
    if (claim.minimum_sought && truth.kind == Kind::unstable) continue;
    // Redundant joints, which agree to rounding, leave the sign of a curvature open that changes over such a way.
    if (truth.allowance * truth.condition > 1.0) continue;
    return {Verdict::lost, truth,
            fmt::format("a {} equilibrium of condition {:.1g} is {:.2g} away", to_string(truth.kind), truth.condition,
                        truth.distance)};
  }
  return {Verdict::right, std::nullopt, "not confirmed"};
}

}  // namespace

std::string to_string(Kind kind) {
  static constexpr const char* names[] = {"unknown", "stable", "unstable", "neutral"};
  return names[static_cast<int>(kind)];
}

std::string to_string(Verdict verdict) {
  static constexpr const char* names[] = {"right",      "no equilibrium", "outside radius",
                                          "wrong kind", "lost",           "undecided"};
  return names[static_cast<int>(verdict)];
}

bool is_false(Verdict verdict) {
  return verdict == Verdict::no_equilibrium || verdict == Verdict::outside_radius || verdict == Verdict::wrong_kind;
}

std::vector<Truth> Judge::equilibria(const Claim& claim, std::string& trouble) const {
  ClaimSearch search(mechanics_, claim);
  search.try_present();
  search.try_all();
  search.try_displaced();
  search.try_soft();
  trouble = search.trouble();
  return search.found();
}

Judgement Judge::judge(const Claim& claim) const {
  ClaimSearch search(mechanics_, claim);
  const auto verdict = [&] {
    return claim.confirmed ? judge_confirmed(claim, search.found(), search.trouble())
                           : judge_unconfirmed(claim, search.found());
  };
  search.try_present();
  Judgement out = verdict();
  if (claim.confirmed ? out.verdict == Verdict::right : out.verdict == Verdict::lost && out.truth->allowance == 0.0) {
    return out;
  }
  search.try_all();
  out = verdict();
  if (out.verdict == Verdict::right) return out;
  search.try_displaced();
  search.try_soft();
  return verdict();
}

}  // namespace poise::judge
