#include "statics/tracking/private/proved_segment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "statics/model/interval_mechanism.hpp"

namespace poise {
namespace {

using Intervals = std::vector<Interval>;

constexpr int most_passes = 4;
constexpr double spread = 1.5;          // of the tube over what the last pass found
constexpr double least_radius = 1e-13;  // of the tube: rad or sizes, and in the largest multiplier

// a + t b, 0 <= t <= 1/4.
Interval with_quarter(const Interval& a, const Interval& b) { return a + Interval(0.25) * with_zero(b); }

class ProvedSegment {
 public:
  ProvedSegment(const SegmentEnd& begin, const SegmentEnd& end, const std::vector<int>& rows,
                const std::vector<signed char>& side, const Eigen::MatrixXd& inverse)
      : rows_(rows),
        side_(side),
        inverse_(inverse),
        n_(begin.x.size()),
        size_(n_ + rows.size()),
        ends_{End(begin, size_), End(end, size_)} {
    const Mechanism<double>& m = begin.model.mechanism();
    equation_.assign(static_cast<std::size_t>(m.constraints()), -1);
    for (std::size_t k = 0; k < rows.size(); ++k) equation_[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
    const bool is_symmetric = !m.has_follower_loads();
    const auto add = [&](int row, int column, std::size_t entry, bool of_tangent) {
      entries_.push_back({static_cast<std::size_t>(row), static_cast<std::size_t>(column), entry, of_tangent});
    };
    for (std::size_t e = 0; e < m.tangent_row().size(); ++e) {
      const int i = m.tangent_row()[e], j = m.tangent_column()[e];
      add(i, j, e, true);
      if (is_symmetric && i != j) add(j, i, e, true);
    }
    for (std::size_t e = 0; e < m.jacobian_row().size(); ++e) {
      const int k = equation_[static_cast<std::size_t>(m.jacobian_row()[e])], i = m.jacobian_column()[e];
      if (k < 0) continue;
      add(static_cast<int>(n_) + k, i, e, false);
      add(i, static_cast<int>(n_) + k, e, false);
    }
    radius_.assign(size_, 0.0);
    box_.resize(size_);
    change_.resize(size_);
    product_.resize(size_ * size_);
  }

  // Needs solvers::RoundingUp, as all below.
  bool run() {
    End &a = ends_[0], &b = ends_[1];
    for (std::size_t i = 0; i < size_; ++i) change_[i] = Interval(b.z[i]) - Interval(a.z[i]);
    double heaviest = 1.0;
    for (std::size_t i = n_; i < size_; ++i) heaviest = std::max({heaviest, std::abs(a.z[i]), std::abs(b.z[i])});
    for (End* end : {&a, &b}) {
      for (std::size_t i = 0; i < size_; ++i) box_[i] = Interval(end->z[i]);
      evaluate(*end);
      end->residual = residual_of(*end);
      end->constraint_at_z = end->constraint;
    }
    for (int pass = 0; pass < most_passes; ++pass) {
      for (std::size_t i = 0; i < size_; ++i) {
        box_[i] = hull(Interval(a.z[i]), Interval(b.z[i])) + Interval(-radius_[i], radius_[i]);
      }
      evaluate(a);
      evaluate(b);
      if (!multiply()) return false;
      const std::vector<double> next = mapped();
      bool is_within = pass > 0;
      for (std::size_t i = 0; i < size_; ++i) is_within = is_within && next[i] < radius_[i];
      if (is_within) return keeps_stops();
      for (std::size_t i = 0; i < size_; ++i) {
        const double most = i < n_ ? 1.0 : heaviest;
        if (!(next[i] < most)) return false;
        radius_[i] = std::max(radius_[i], spread * next[i] + least_radius * most);
      }
    }
    return false;
  }

 private:
  struct End {
    End(const SegmentEnd& given, std::size_t size)
        : plain(given.model.mechanism()),
          mechanism([&] {
            const solvers::RoundingUp up;
            return Mechanism<Interval>(given.model.scaled_scene(), given.model.layout(), Purpose::statics);
          }()),
          z(given.x) {
      for (Eigen::Index k = 0; k < given.y.size(); ++k) z.push_back(given.y[k]);
      z.resize(size);
      pose.resize(static_cast<std::size_t>(mechanism.pose_size()));
      force.resize(given.x.size());
      constraint.resize(static_cast<std::size_t>(mechanism.constraints()));
      multipliers.assign(constraint.size(), Interval(0));
      jacobian.resize(mechanism.jacobian_row().size());
      tangent.resize(mechanism.tangent_row().size());
    }

    const Mechanism<double>& plain;
    Mechanism<Interval> mechanism;
    std::vector<double> z;
    Intervals residual, constraint_at_z;
    // Over the box.
    std::vector<Planar<Interval>> pose;
    Intervals force, constraint, multipliers, jacobian, tangent;
  };
  struct Entry {
    std::size_t row, column, at;
    bool of_tangent;
    const Interval& of(const End& end) const { return of_tangent ? end.tangent[at] : end.jacobian[at]; }
  };

  void evaluate(End& end) const {
    const Mechanism<Interval>& m = end.mechanism;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      end.multipliers[static_cast<std::size_t>(rows_[k])] = box_[n_ + k];
    }
    m.place(box_.data(), end.pose.data());
    m.jacobian(end.pose.data(), end.jacobian.data());
    m.negative_force(box_.data(), end.pose.data(), end.force.data());
    m.constraint(box_.data(), end.pose.data(), end.constraint.data());
    m.tangent(end.pose.data(), end.multipliers.data(), end.tangent.data());
  }

  double limit(const Mechanism<double>& m, int row) const {
    const int s = row - m.equalities();
    if (s < 0) return 0.0;
    return side_[static_cast<std::size_t>(s)] < 0 ? m.lower()[s] : m.upper()[s];
  }

  Intervals residual_of(const End& end) const {
    Intervals out(end.force);
    out.resize(size_);
    for (std::size_t e = 0; e < end.jacobian.size(); ++e) {
      const int k = equation_[static_cast<std::size_t>(end.plain.jacobian_row()[e])];
      if (k >= 0) {
        out[static_cast<std::size_t>(end.plain.jacobian_column()[e])] +=
            end.jacobian[e] * box_[n_ + static_cast<std::size_t>(k)];
      }
    }
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      out[n_ + k] = end.constraint[static_cast<std::size_t>(rows_[k])] - Interval(limit(end.plain, rows_[k]));
    }
    return out;
  }

  // I - C D by columns; false where an entry has no bounds.
  bool multiply() {
    std::fill(product_.begin(), product_.end(), Interval(0));
    for (std::size_t i = 0; i < size_; ++i) product_[i * size_ + i] = Interval(1);
    for (const Entry& entry : entries_) {
      const Interval d = hull(entry.of(ends_[0]), entry.of(ends_[1]));
      if (!d.bounded()) return false;
      const double* const c = &inverse_(0, static_cast<Eigen::Index>(entry.row));
      Interval* const out = &product_[entry.column * size_];
      const double low = d.lower(), high = d.upper();
      for (std::size_t i = 0; i < size_; ++i) {
        const double f = -c[i], p = f * low, q = f * high, minus_p = -f * low, minus_q = -f * high;
        out[i] = Interval::from(out[i].minus_lower() + (minus_p > minus_q ? minus_p : minus_q),
                                out[i].upper() + (p > q ? p : q));
      }
    }
    return true;
  }

  // |C r| + |I - C D| e.
  std::vector<double> mapped() const {
    Intervals bend(size_);
    for (const Entry& entry : entries_) {
      bend[entry.row] += (entry.of(ends_[0]) - entry.of(ends_[1])) * change_[entry.column];
    }
    Intervals moved(size_);
    for (std::size_t j = 0; j < size_; ++j) {
      const Interval r = with_quarter(hull(ends_[0].residual[j], ends_[1].residual[j]), bend[j]);
      for (std::size_t i = 0; i < size_; ++i) {
        moved[i] += Interval(inverse_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j))) * r;
      }
    }
    std::vector<double> out(size_);
    for (std::size_t i = 0; i < size_; ++i) out[i] = moved[i].magnitude();
    for (std::size_t j = 0; j < size_; ++j) {
      for (std::size_t i = 0; i < size_; ++i) out[i] += product_[j * size_ + i].magnitude() * radius_[j];
    }
    return out;
  }

  // Those that hold press, and others are free: what they have at both ends, less what the tube may take away.
  bool keeps_stops() const {
    const Mechanism<double>&a = ends_[0].plain, &b = ends_[1].plain;
    Intervals off(side_.size());
    for (std::size_t e = 0; e < ends_[0].jacobian.size(); ++e) {
      const int s = a.jacobian_row()[e] - a.equalities();
      if (s < 0) continue;
      const auto i = static_cast<std::size_t>(a.jacobian_column()[e]);
      const Interval &at_begin = ends_[0].jacobian[e], &at_end = ends_[1].jacobian[e];
      off[static_cast<std::size_t>(s)] +=
          with_quarter(hull(at_begin, at_end) * Interval(-radius_[i], radius_[i]), (at_begin - at_end) * change_[i]);
    }
    for (int s = 0; s < a.stops(); ++s) {
      const auto at = static_cast<std::size_t>(s);
      if (side_[at] == 0) {
        const auto row = static_cast<std::size_t>(a.stop_row(s));
        const Interval &v = ends_[0].constraint_at_z[row], &w = ends_[1].constraint_at_z[row];
        const Interval above = hull(v - Interval(a.lower()[at]), w - Interval(b.lower()[at])) + off[at];
        const Interval below = hull(Interval(a.upper()[at]) - v, Interval(b.upper()[at]) - w) - off[at];
        if (!(above > Interval(0)) || !(below > Interval(0))) return false;
        continue;
      }
      if (a.lower()[at] == a.upper()[at] && b.lower()[at] == b.upper()[at]) continue;
      const auto k = n_ + static_cast<std::size_t>(equation_[static_cast<std::size_t>(a.stop_row(s))]);
      if (!(Interval(static_cast<double>(side_[at])) * box_[k] > Interval(0))) return false;
    }
    return true;
  }

  const std::vector<int>& rows_;
  const std::vector<signed char>& side_;
  const Eigen::MatrixXd& inverse_;
  const std::size_t n_, size_;
  End ends_[2];
  std::vector<int> equation_;  // per constraint row: its place among those that hold, or -1
  std::vector<Entry> entries_;
  std::vector<double> radius_;  // e
  Intervals box_, change_;
  Intervals product_;  // by columns
};

}  // namespace

bool segment_is_proved(const SegmentEnd& begin, const SegmentEnd& end, const std::vector<int>& rows,
                       const std::vector<signed char>& side, const Eigen::MatrixXd& middle) {
  const Eigen::MatrixXd inverse = middle.partialPivLu().inverse();
  if (!inverse.allFinite()) return false;
  ProvedSegment segment(begin, end, rows, side, inverse);
  const solvers::RoundingUp up;
  return segment.run();
}

}  // namespace poise
