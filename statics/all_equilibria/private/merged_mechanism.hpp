#pragma once

#include <optional>
#include <vector>

#include "statics/all_equilibria/private/merged_energy.hpp"
#include "statics/model/interval_mechanism.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Numbers of a scene in intervals: as they are, or each anywhere within a part of itself.
struct IntervalNumbers {
  const Layout& layout;
  double part = 0.0;

  Interval length(double x) const { return wide(x); }
  Interval force(double x) const { return wide(x); }
  Interval force_per_length(double x) const { return wide(x); }
  Interval mass(double x) const { return wide(x); }
  Interval acceleration(double x) const { return wide(x); }
  std::optional<Interval> share_at_points(const Scene& scene, const Force& on) const {
    return wide(scene.share_at_points<Interval>(on));
  }
  std::optional<Planar<Interval>> turned(int turn) const;
  std::optional<Planar<Interval>> direction(const Vec2& along) const;

 private:
  Interval wide(const Interval& x) const { return part > 0.0 ? x * Interval(1.0 - part, 1.0 + part) : x; }
};

/// Mechanism<Interval> of a scaled scene, with the forces of weights, dead loads and springs of free length zero from
/// their merged energy where there are such springs. Needs solvers::RoundingUp; each thread has its own.
class MergedMechanism {
 public:
  explicit MergedMechanism(const StaticModel& model);

  const Phasors<Interval>& phasors() const { return all_.phasors(); }
  int pose_size() const { return all_.pose_size(); }
  void place(const Interval* q, Planar<Interval>* pose) const { all_.place(q, pose); }
  void constraint(const Interval* q, Planar<Interval>* pose, Interval* c) const { all_.constraint(q, pose, c); }
  void jacobian(Planar<Interval>* pose, Interval* values) const { all_.jacobian(pose, values); }
  /// As of Mechanism, with its sparsity.
  void negative_force(const Interval* q, Planar<Interval>* pose, Interval* g);
  void tangent(Planar<Interval>* pose, const Interval* multiplier, Interval* values);

 private:
  using Product = MergedEnergy<Interval>::Product;
  Interval length(const Planar<Interval>* pose, int coordinate) const;
  Planar<Interval> turning(const Planar<Interval>* pose, const Product& p) const;

  Mechanism<Interval> all_;
  std::optional<Mechanism<Interval>> rest_;  // without what is merged
  std::vector<Product> products_;
  std::vector<int> entry_;       // of the tangent, n x n, or -1
  std::vector<int> rest_entry_;  // places of its entries in the whole tangent
  std::vector<Interval> rest_tangent_;
};

}  // namespace poise
