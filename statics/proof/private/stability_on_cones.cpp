#include "statics/proof/private/stability_on_cones.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"
#include "solvers/nonnegative_least_squares.hpp"
#include "solvers/regular_set.hpp"

namespace poise {
namespace {

using solvers::Ball;
using Form = std::vector<Ball>;

constexpr int most_boxes_of_directions = 20000;
constexpr double shortest_side = 0x1p-40;
constexpr double softest = 1e-8;  // part of the largest curvature that scales a direction at least

Ball product(const Form& a, const std::vector<Ball>& v) {
  Ball out(0.0);
  for (std::size_t i = 0; i < a.size(); ++i) out += a[i] * v[i];
  return out;
}

bool is_all_negative(const std::vector<Form>& forms, const std::vector<Ball>& v) {
  return std::all_of(forms.begin(), forms.end(), [&](const Form& a) { return product(a, v) < Ball(0); });
}

// Expresses cones in rates w of v = W w: curvatures along the new axes are about 1, so that boxes are as long as wide.
// Returns nothing if W is not proved regular.
std::optional<Cones> rescaled(const Cones& cones) {
  const std::size_t d = cones.hessian.size();
  const auto n = static_cast<Eigen::Index>(d);
  Eigen::MatrixXd h(n, n);
  for (std::size_t i = 0; i < d; ++i) {
    for (std::size_t j = 0; j < d; ++j) {
      h(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = cones.hessian[i][j].middle();
    }
  }
  if (!h.allFinite()) return std::nullopt;
  const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(h);
  const double largest = eigen.values.cwiseAbs().maxCoeff();
  std::vector<Form> axes(d, Form(d));  // columns of W
  std::vector<solvers::RegularSet::Entry> entries;
  for (std::size_t j = 0; j < d; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const double curvature = std::max(std::abs(eigen.values[column]), softest * largest);
    for (std::size_t i = 0; i < d; ++i) {
      const double by = curvature > 0.0 ? 1.0 / std::sqrt(curvature) : 1.0;
      axes[j][i] = Ball(by * eigen.vectors(static_cast<Eigen::Index>(i), column));
      entries.push_back({static_cast<int>(i), static_cast<int>(j), axes[j][i]});
    }
  }
  if (!solvers::RegularSet(static_cast<int>(d), false, entries).regular()) return std::nullopt;
  Cones out;
  for (const Form& axis : axes) {
    Form image;
    for (const Form& row : cones.hessian) image.push_back(product(row, axis));
    Form& row = out.hessian.emplace_back();
    for (const Form& other : axes) row.push_back(product(image, other));
  }
  const auto along_axes = [&](const std::vector<Form>& forms, std::vector<Form>& to) {
    for (const Form& a : forms) {
      Form& form = to.emplace_back();
      for (const Form& axis : axes) form.push_back(product(a, axis));
    }
  };
  along_axes(cones.acting, out.acting);
  along_axes(cones.forbidden, out.forbidden);
  return out;
}

// Directions from middle - half to middle + half.
struct Directions {
  std::vector<double> middle, half;

  std::vector<Ball> all() const {
    std::vector<Ball> out;
    for (std::size_t i = 0; i < middle.size(); ++i) out.push_back(Ball(middle[i]).widened(half[i]));
    return out;
  }
  // Into two equal parts across the longest side, whose ends are exact; none where that is too short.
  std::optional<std::pair<Directions, Directions>> parts() const {
    const auto side = std::max_element(half.begin(), half.end());
    if (*side < shortest_side) return std::nullopt;
    const std::ptrdiff_t i = side - half.begin();
    Directions lower = *this;
    lower.half[i] /= 2;
    Directions upper = lower;
    lower.middle[i] -= lower.half[i];
    upper.middle[i] += upper.half[i];
    return std::pair(std::move(lower), std::move(upper));
  }
};

std::vector<Directions> surface_of_cube(std::size_t dimensions) {
  std::vector<Directions> out;
  for (std::size_t i = 0; i < dimensions; ++i) {
    for (const double side : {-1.0, 1.0}) {
      Directions& box =
          out.emplace_back(Directions{std::vector<double>(dimensions, 0.0), std::vector<double>(dimensions, 1.0)});
      box.middle[i] = side;
      box.half[i] = 0.0;
    }
  }
  return out;
}

class Division {
 public:
  explicit Division(const Cones& cones) : cones_(cones) {}

  // Every direction is forbidden.
  bool leaves_none() const {
    if (cones_.forbidden.empty()) return false;
    return divide([&](const Directions& box) { return is_forbidden(box) ? Verdict::done : Verdict::divide; }) ==
           Verdict::done;
  }

  Stability stability() const {
    const Verdict verdict = divide([&](const Directions& box) {
      if (is_forbidden(box) || grows(box)) return Verdict::done;
      return falls(box) ? Verdict::falls : Verdict::divide;
    });
    return verdict == Verdict::done    ? Stability::stable
           : verdict == Verdict::falls ? Stability::unstable
                                       : Stability::unknown;
  }

 private:
  enum class Verdict { done, divide, falls };

  // Done if all boxes are.
  template <class Judge>
  Verdict divide(const Judge& judge) const {
    std::vector<Directions> boxes = surface_of_cube(cones_.hessian.size());
    for (std::size_t next = 0; next < boxes.size(); ++next) {
      const Verdict verdict = judge(boxes[next]);
      if (verdict == Verdict::falls) return verdict;
      if (verdict == Verdict::done) continue;
      auto parts = boxes[next].parts();
      if (!parts || boxes.size() >= most_boxes_of_directions) return Verdict::divide;
      boxes.push_back(std::move(parts->first));
      boxes.push_back(std::move(parts->second));
    }
    return Verdict::done;
  }

  bool is_forbidden(const Directions& box) const {
    const std::vector<Ball> v = box.all();
    return std::any_of(cones_.forbidden.begin(), cones_.forbidden.end(),
                       [&](const Form& b) { return product(b, v) > Ball(0); });
  }

  // q(m + r) >= m.H m - 2 |H m|.|r| - |r|.|H||r| + sum max(0, a.v)^2.
  bool grows(const Directions& box) const {
    const std::vector<Ball> v = box.all();
    const std::vector<Ball> middle(box.middle.begin(), box.middle.end());
    Ball least(0.0);
    for (std::size_t i = 0; i < middle.size(); ++i) {
      const Ball force = product(cones_.hessian[i], middle);
      least += middle[i] * force - Ball(2 * box.half[i]) * abs(force);
      for (std::size_t j = 0; j < middle.size(); ++j) {
        least -= Ball(box.half[i]) * Ball(box.half[j]) * abs(cones_.hessian[i][j]);
      }
    }
    for (const Form& a : cones_.acting) {
      const Ball rate = product(a, v);
      if (rate > Ball(0)) least += rate * rate;
    }
    return least > Ball(0);
  }

  bool falls(const Directions& box) const {
    const std::vector<Ball> middle(box.middle.begin(), box.middle.end());
    if (!is_all_negative(cones_.forbidden, middle)) return false;
    Ball most(0.0);
    for (std::size_t i = 0; i < middle.size(); ++i) most += middle[i] * product(cones_.hessian[i], middle);
    for (const Form& a : cones_.acting) {
      const Ball rate = product(a, middle);
      if (!(rate < Ball(0))) most += rate * rate;
    }
    return most < Ball(0);
  }

  const Cones& cones_;
};

}  // namespace

StabilityOnCones stability_on_cones(const Cones& cones) {
  if (cones.hessian.empty()) return {Stability::stable, true};
  const std::optional<Cones> scaled = rescaled(cones);
  if (!scaled) return {};
  const Division division(*scaled);
  if (division.leaves_none()) return {Stability::stable, true};
  return {division.stability(), false};
}

// The shortest of all sums  sum_s l_s a_s  with l >= 0 and sum l = 1 is opposite to such a v, if there is one (Gordan).
bool is_left_together(const std::vector<std::vector<Ball>>& forms) {
  if (forms.empty()) return true;
  const std::size_t d = forms.front().size();
  const auto rows = static_cast<Eigen::Index>(d), count = static_cast<Eigen::Index>(forms.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Ones(rows + 1, count);
  for (Eigen::Index s = 0; s < count; ++s) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      a(i, s) = forms[static_cast<std::size_t>(s)][static_cast<std::size_t>(i)].middle();
    }
    if (a.col(s).head(rows).norm() > 0.0) a.col(s).head(rows).normalize();
  }
  if (!a.allFinite()) return false;
  const Eigen::VectorXd one = Eigen::VectorXd::Unit(rows + 1, rows);
  const Eigen::VectorXd leaving = one - a * solvers::nonnegative_least_squares(a, one);
  std::vector<Ball> v;
  for (std::size_t i = 0; i < d; ++i) v.emplace_back(leaving[static_cast<Eigen::Index>(i)]);
  return is_all_negative(forms, v);
}

// The other rates follow from the neutral ones, v = (n, o):  H_oo o = -H_on n.
bool goes_on_beside(const Cones& cones, std::size_t neutral) {
  if (neutral == 0) return false;
  const std::size_t d = cones.hessian.size();
  std::vector<solvers::RegularSet::Entry> entries;
  for (std::size_t i = neutral; i < d; ++i) {
    for (std::size_t j = neutral; j < d; ++j) {
      entries.push_back({static_cast<int>(i - neutral), static_cast<int>(j - neutral), cones.hessian[i][j]});
    }
  }
  const solvers::RegularSet others(static_cast<int>(d - neutral), false, entries);
  if (neutral < d && !others.regular()) return false;
  std::vector<std::vector<Ball>> motions;
  for (std::size_t k = 0; k < neutral; ++k) {
    std::vector<Ball>& motion = motions.emplace_back(neutral);
    motion[k] = Ball(1);
    if (neutral == d) continue;
    std::vector<Ball> b;
    for (std::size_t i = neutral; i < d; ++i) b.push_back(-cones.hessian[i][k]);
    b = others.solve(std::move(b));
    motion.insert(motion.end(), b.begin(), b.end());
  }
  std::vector<Form> along;
  for (const std::vector<Form>* forms : {&cones.forbidden, &cones.acting}) {
    for (const Form& a : *forms) {
      Form& form = along.emplace_back();
      for (const std::vector<Ball>& motion : motions) form.push_back(product(a, motion));
    }
  }
  return is_left_together(along);
}

}  // namespace poise
