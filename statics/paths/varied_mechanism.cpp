#include "statics/paths/varied_mechanism.hpp"

#include <algorithm>
#include <optional>

#include "model/mechanism_impl.hpp"

namespace poise {

template <class T>
struct VariedMechanism::Evaluation {
  Evaluation(const VariedNumbers& of, const Layout& layout)
      : numbers(of), mechanism(of.list().scene(), layout, Purpose::statics), pose(mechanism.pose_size()) {}

  // Plain numbers, which many evaluations share, are set where they change only.
  void set(const T& p) {
    if constexpr (!has_derivatives<T>) {
      if (set_at == p) return;
      set_at = p;
    }
    numbers.set(p, values);
    mechanism.set_numbers(Numbers<T>(numbers.list(), values.data()));
  }

  const VariedNumbers& numbers;
  Mechanism<T> mechanism;
  std::vector<T> values;  // of the numbers
  std::optional<T> set_at;
  std::vector<Planar<T>> pose;
  std::vector<T> x, y, out, tangent;
};

std::vector<int> VariedMechanism::one_way_springs(const Scene& scene) {
  std::vector<int> out;
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const auto* spring = std::get_if<LinearSpring>(&scene.elements[e].law);
    if (spring != nullptr && spring->acts != LinearSpring::Acts::both) out.push_back(static_cast<int>(e));
  }
  return out;
}

VariedMechanism::VariedMechanism(const VariedScene& varied, const std::vector<char>& acts)
    : numbers_(varied, one_way_springs(varied.scene()), acts),
      layout_(lay_out(numbers_.scene(), Purpose::statics, numbers_.varying())) {
  layout_.scale_lengths(varied.scales().per_length());
  const Mechanism<double>& m = in(plain_).mechanism;
  n_ = m.coordinates();
  equalities_ = m.equalities();
  rows_ = m.constraints();
  symmetric_ = !m.has_follower_loads();
  jacobian_pattern_ = {rows_, n_, m.jacobian_row(), m.jacobian_column()};
  tangent_pattern_ = {n_, n_, m.tangent_row(), m.tangent_column()};
}

VariedMechanism::~VariedMechanism() = default;

template <class T>
VariedMechanism::Evaluation<T>& VariedMechanism::in(std::unique_ptr<Evaluation<T>>& evaluation) const {
  if (!evaluation) {
    evaluation = std::make_unique<Evaluation<T>>(numbers_, layout_);
    evaluation->x.resize(static_cast<std::size_t>(evaluation->mechanism.coordinates()));
    evaluation->y.resize(static_cast<std::size_t>(evaluation->mechanism.constraints()));
  }
  return *evaluation;
}

// The values are those at the coordinates `at.x`.
template <class T>
void VariedMechanism::fill(Evaluation<T>& at, const T& p, T* values) const {
  at.set(p);
  const Mechanism<T>& m = at.mechanism;
  m.place(at.x.data(), at.pose.data());
  m.negative_force(at.x.data(), at.pose.data(), values);
  m.constraint(at.x.data(), at.pose.data(), values + first_row());
  m.jacobian(at.pose.data(), values + first_entry());
  std::copy(m.lower().begin(), m.lower().end(), values + first_lower());
  std::copy(m.upper().begin(), m.upper().end(), values + first_upper());
}

void VariedMechanism::evaluate(std::span<const double> x, double p, std::span<double> values, std::span<double> by_p) {
  if (by_p.empty()) {
    Evaluation<double>& at = in(plain_);
    std::copy(x.begin(), x.end(), at.x.begin());
    fill(at, p, values.data());
    return;
  }
  Evaluation<Dual>& at = in(by_p_);
  for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i] = Dual(x[i]);
  at.out.resize(values.size());
  fill(at, Dual(p, 0), at.out.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = at.out[i].a;
    by_p[i] = at.out[i].v[0];
  }
}

void VariedMechanism::tangent(std::span<const double> x, double p, std::span<const double> y,
                              std::span<double> values) {
  Evaluation<double>& at = in(plain_);
  at.set(p);
  at.mechanism.place(x.data(), at.pose.data());
  at.mechanism.tangent(at.pose.data(), y.data(), values.data());
}

// The two variables are the way along (u, v, w), and p.
void VariedMechanism::change(std::span<const double> x, double p, std::span<const double> y, std::span<const double> u,
                             std::span<const double> v, double w, std::span<double> values, std::span<double> by_p,
                             std::span<double> tangent) {
  Evaluation<SecondDual>& at = in(changes_);
  for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i] = second_dual(x[i], u[i], 0.0);
  for (std::size_t r = 0; r < at.y.size(); ++r) at.y[r] = second_dual(y[r], v[r], 0.0);
  at.out.resize(values.size());
  at.tangent.resize(tangent.size());
  fill(at, second_dual(p, w, 1.0), at.out.data());
  at.mechanism.tangent(at.pose.data(), at.y.data(), at.tangent.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = at.out[i].derivative(1, 0);
    by_p[i] = at.out[i].derivative(1, 1);
  }
  for (std::size_t i = 0; i < tangent.size(); ++i) tangent[i] = at.tangent[i].derivative(1, 0);
}

}  // namespace poise
