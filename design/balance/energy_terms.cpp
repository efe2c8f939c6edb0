#include "design/balance/energy_terms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "solvers/linear_algebra.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

constexpr double no_pivot = 1e-11;  // of relations whose largest coefficients are of order one

bool has_sine(const PoseFunction& f) { return f.has_angle(); }

PoseFunction ordered(int length_a, int length_b, int up, int down) {
  if (length_a > length_b) std::swap(length_a, length_b);
  return {length_a, length_b, up, down};
}

}  // namespace

void add_product(EnergyTerms& out, double factor, const PhasorTerms& a, const PhasorTerms& b) {
  for (const auto& [p, c] : a) {
    for (const auto& [q, d] : b) {
      // Re(z phi_up conj(phi_down)) = Re z cos(up - down) - Im z sin(up - down), of z = conj(c) d.
      Vec2 z = factor * (conj(c) * d);
      int up = q.angle, down = p.angle;
      if (up == down) {
        up = down = -1;
        z.y = 0.0;
      } else if (up < 0 || (down >= 0 && down < up)) {
        std::swap(up, down);
        z = conj(z);
      }
      out[ordered(p.length, q.length, up, down)] += up >= 0 ? conj(z) : Vec2{z.x, 0.0};
    }
  }
}

EnergyTerms sum(EnergyTerms a, const EnergyTerms& b, double factor) {
  for (const auto& [function, coefficient] : b) a[function] += factor * coefficient;
  return a;
}

EnergyTerms potential(const PhasorTerms& place, Vec2 force) {
  EnergyTerms out;
  add_product(out, -1.0, {{Phasor{}, force}}, place);
  return out;
}

EnergyTerms half_square(const PhasorTerms& a, const PhasorTerms& b) {
  const PhasorTerms d = sum(b, a, -1.0);
  EnergyTerms out;
  add_product(out, 0.5, d, d);
  return out;
}

double value(const EnergyTerms& terms, const std::vector<double>& q) {
  double out = 0.0;
  for (const auto& [f, coefficient] : terms) {
    const double angle = (f.up >= 0 ? q[f.up] : 0.0) - (f.down >= 0 ? q[f.down] : 0.0);
    const double lengths = (f.length_a >= 0 ? q[f.length_a] : 1.0) * (f.length_b >= 0 ? q[f.length_b] : 1.0);
    out += lengths * (coefficient.x * std::cos(angle) + (f.up >= 0 ? coefficient.y * std::sin(angle) : 0.0));
  }
  return out;
}

FunctionSpace::FunctionSpace(const PoseForm& form, const std::vector<EnergyTerms>& of) : form_(form) {
  // Products of the closures with 1 and with all phasors that appear, conjugate or not: their real and imaginary parts.
  std::vector<PhasorTerms> factors;
  const auto add_factor = [&](Phasor phasor) {
    factors.push_back({{phasor, {1.0, 0.0}}});
    factors.push_back({{phasor, {0.0, 1.0}}});
  };
  std::vector<EnergyTerms> relations;
  if (!form.closures().empty()) {
    std::map<Phasor, bool> seen;
    seen[Phasor{}] = true;
    for (const PhasorTerms& closure : form.closures()) {
      for (const auto& [phasor, coefficient] : closure) seen[phasor] = true;
    }
    for (const int t : form.coordinates()) {
      if (!form.is_length(t)) seen[Phasor{-1, t}] = true;
    }
    for (const auto& [phasor, is_seen] : seen) add_factor(phasor);
    for (const PhasorTerms& closure : form.closures()) {
      for (const PhasorTerms& factor : factors)
        add_product(relations.emplace_back(), 1.0 / form.size(), factor, closure);
    }
  }
  const auto enter = [&](const EnergyTerms& terms) {
    for (const auto& [function, coefficient] : terms) {
      if (!first_.emplace(function, static_cast<Eigen::Index>(all_.size())).second) continue;
      all_.push_back({function, false});
      if (has_sine(function)) all_.push_back({function, true});
    }
  };
  enter({{PoseFunction{}, Vec2{}}});
  for (const EnergyTerms& terms : of) enter(terms);
  for (const EnergyTerms& terms : relations) enter(terms);
  eliminate(relations);
  for (std::size_t k = 0; k < all_.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    if (k == 0 || std::find(pivots_.begin(), pivots_.end(), at) != pivots_.end()) continue;
    kept_.push_back(at);
    components_.push_back(all_[k]);
  }
  complete_ = form.closures().empty() || found_independent();
}

Eigen::VectorXd FunctionSpace::in_all(const EnergyTerms& terms) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all_.size()));
  for (const auto& [function, coefficient] : terms) {
    const Eigen::Index at = first_.at(function);
    const double scale = std::pow(form_.size(), function.lengths());
    out[at] = scale * coefficient.x;
    if (has_sine(function)) out[at + 1] = scale * coefficient.y;
  }
  return out;
}

void FunctionSpace::eliminate(const std::vector<EnergyTerms>& relations) {
  const auto columns = static_cast<Eigen::Index>(all_.size());
  rows_.resize(static_cast<Eigen::Index>(relations.size()), columns);
  for (std::size_t r = 0; r < relations.size(); ++r) rows_.row(static_cast<Eigen::Index>(r)) = in_all(relations[r]);
  Eigen::Index done = 0;
  for (; done < rows_.rows(); ++done) {
    // The constant, in the first column, is never expressed by others. Differences of two angles are, where they can
    // be, before angles alone, so that what is left is easier to read.
    Eigen::Index row = 0, column = 0;
    double largest = 0.0;
    for (Eigen::Index i = done; i < rows_.rows(); ++i) {
      for (Eigen::Index j = 1; j < columns; ++j) {
        const PoseFunction& f = all_[static_cast<std::size_t>(j)].function;
        const double preferred = f.lengths() + (f.down >= 0 ? 1 : 0) >= 1 ? 4.0 : 1.0;
        if (preferred * std::abs(rows_(i, j)) <= largest) continue;
        largest = preferred * std::abs(rows_(i, j));
        row = i;
        column = j;
      }
    }
    if (largest <= no_pivot) break;
    rows_.row(row).swap(rows_.row(done));
    rows_.row(done) /= rows_(done, column);
    for (Eigen::Index i = 0; i < rows_.rows(); ++i) {
      if (i != done) rows_.row(i) -= (rows_(i, column) * rows_.row(done)).eval();
    }
    pivots_.push_back(column);
  }
  rows_.conservativeResize(done, columns);
  relations_ = static_cast<int>(done);
}

Eigen::VectorXd FunctionSpace::vector(const EnergyTerms& terms) const {
  Eigen::VectorXd all = in_all(terms);
  for (std::size_t r = 0; r < pivots_.size(); ++r) {
    all -= (all[pivots_[r]] * rows_.row(static_cast<Eigen::Index>(r)).transpose()).eval();
  }
  Eigen::VectorXd out(static_cast<Eigen::Index>(kept_.size()));
  for (std::size_t k = 0; k < kept_.size(); ++k) out[static_cast<Eigen::Index>(k)] = all[kept_[k]];
  return out;
}

bool FunctionSpace::found_independent() const {
  constexpr int tries_for_each = 12;
  constexpr double independent = 1e-8;
  const std::size_t wanted = 2 * components_.size() + 8;
  std::vector<Eigen::VectorXd> rows;
  for (std::uint64_t k = 0; rows.size() < wanted && k < tries_for_each * wanted; ++k) {
    solvers::RandomStream random(17, 0, k);
    std::vector<double> q = form_.start();
    for (const int t : form_.coordinates()) {
      q[t] +=
          form_.is_length(t) ? form_.size() * (random.uniform() - 0.5) : std::numbers::pi * (random.uniform() - 0.5);
    }
    q = form_.closed(std::move(q));
    if (q.empty()) continue;
    Eigen::VectorXd row(static_cast<Eigen::Index>(components_.size() + 1));
    row[0] = 1.0;
    for (std::size_t c = 0; c < components_.size(); ++c) {
      const Vec2 one = components_[c].is_sine ? Vec2{0.0, 1.0} : Vec2{1.0, 0.0};
      row[static_cast<Eigen::Index>(c + 1)] =
          value({{components_[c].function, one}}, q) / std::pow(form_.size(), components_[c].function.lengths());
    }
    rows.push_back(std::move(row));
  }
  if (rows.size() < wanted) return false;
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()), rows.front().size());
  for (std::size_t k = 0; k < rows.size(); ++k) matrix.row(static_cast<Eigen::Index>(k)) = rows[k].transpose();
  const Eigen::VectorXd values = solvers::singular_values(matrix);
  return values[values.size() - 1] > independent * values[0];
}

std::string FunctionSpace::name(const Component& component) const {
  const PoseFunction& f = component.function;
  std::string out;
  const auto times = [&](const std::string& factor) { out += (out.empty() ? "" : " ") + factor; };
  if (f.length_a >= 0 && f.length_a == f.length_b) {
    times(form_.name(f.length_a) + "^2");
  } else {
    if (f.length_a >= 0) times(form_.name(f.length_a));
    if (f.length_b >= 0) times(form_.name(f.length_b));
  }
  if (f.has_angle()) {
    const std::string angle = f.down >= 0 ? form_.name(f.up) + " - " + form_.name(f.down) : form_.name(f.up);
    times((component.is_sine ? "sin(" : "cos(") + angle + ")");
  }
  return out;
}

}  // namespace poise
