#include "model/recorded.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace poise {
namespace {

thread_local Recording* recording_of_thread = nullptr;

int node_of(const Recorded& a) { return a.is_known() ? recording_of_thread->constant(a.value()) : a.node(); }

Recorded recorded(LaneOp op, double value, const Recorded& a) {
  if (a.is_known()) return {value};
  return {value, recording_of_thread->node(op, {a.node(), -1, -1}, value)};
}

Recorded recorded(LaneOp op, double value, const Recorded& a, const Recorded& b, bool commutes = false) {
  if (a.is_known() && b.is_known()) return {value};
  std::array<int, 3> of{node_of(a), node_of(b), -1};
  if (commutes && of[1] < of[0]) std::swap(of[0], of[1]);
  return {value, recording_of_thread->node(op, of, value)};
}

RecordedMask compared(LaneOp op, bool value, const Recorded& a, const Recorded& b) {
  if (a.is_known() && b.is_known()) return RecordedMask(value);
  const int node = recording_of_thread->node(op, {node_of(a), node_of(b), -1}, value ? 1.0 : 0.0);
  recording_of_thread->comparisons.push_back({node, value});
  return {value, node};
}

bool is(const Recorded& a, double value) { return a.is_known() && a.value() == value; }

/// The number of which this one is the opposite, or none.
const Recording::Node* opposite_of(const Recorded& a) {
  if (a.is_known()) return nullptr;
  const Recording::Node& node = recording_of_thread->nodes()[static_cast<std::size_t>(a.node())];
  return node.op == LaneOp::negate ? &node : nullptr;
}

Recorded without_sign(const Recording::Node& negated) { return {-negated.value, negated.of[0]}; }

}  // namespace

Recorder::Recorder(Recording& to) { recording_of_thread = &to; }
Recorder::~Recorder() { recording_of_thread = nullptr; }
Recording* Recorder::current() { return recording_of_thread; }

std::size_t Recording::Hash::operator()(const Key& key) const {
  std::uint64_t h = static_cast<std::uint64_t>(key.op);
  for (const int one : key.of) h = (h ^ static_cast<std::uint64_t>(one + 1)) * 0x9E3779B97F4A7C15U;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

int Recording::input(double value) {
  nodes_.push_back({LaneOp::input, {-1, -1, -1}, value});
  return static_cast<int>(nodes_.size()) - 1;
}

int Recording::constant(double value) {
  const auto [at, is_new] =
      constants_.try_emplace(std::bit_cast<std::uint64_t>(value), static_cast<int>(nodes_.size()));
  if (is_new) nodes_.push_back({LaneOp::constant, {-1, -1, -1}, value});
  return at->second;
}

int Recording::node(LaneOp op, std::array<int, 3> of, double value) {
  const auto [at, is_new] = known_.try_emplace({op, of}, static_cast<int>(nodes_.size()));
  if (is_new) nodes_.push_back({op, of, value});
  return at->second;
}

Mask<0>::operator bool() const {
  if (is_known()) return value_;
  if (Recording::Search* const search = recording_of_thread->search; search != nullptr) {
    const std::size_t question = search->asked.size();
    search->asked.push_back({node_, value_});
    return question >= search->answers.size() || search->answers[question];
  }
  recording_of_thread->guards.push_back({node_, value_});
  return value_;
}

RecordedMask operator!(const RecordedMask& a) {
  if (a.is_known()) return RecordedMask(!a.value());
  return {!a.value(), recording_of_thread->node(LaneOp::opposite, {a.node(), -1, -1}, a.value() ? 0.0 : 1.0)};
}

RecordedMask operator&&(const RecordedMask& a, const RecordedMask& b) {
  if (a.is_known()) return a.value() ? b : a;
  if (b.is_known()) return b.value() ? a : b;
  const bool value = a.value() && b.value();
  return {value, recording_of_thread->node(LaneOp::both, {a.node(), b.node(), -1}, value ? 1.0 : 0.0)};
}

RecordedMask operator||(const RecordedMask& a, const RecordedMask& b) {
  if (a.is_known()) return a.value() ? a : b;
  if (b.is_known()) return b.value() ? b : a;
  const bool value = a.value() || b.value();
  return {value, recording_of_thread->node(LaneOp::either, {a.node(), b.node(), -1}, value ? 1.0 : 0.0)};
}

Recorded Recorded::input(double value) { return {value, recording_of_thread->input(value)}; }

Recorded operator+(const Recorded& a, const Recorded& b) {
  if (is(a, 0.0)) return b;
  if (is(b, 0.0)) return a;
  if (const auto* negated = opposite_of(b)) return a - without_sign(*negated);
  if (const auto* negated = opposite_of(a)) return b - without_sign(*negated);
  return recorded(LaneOp::add, a.value() + b.value(), a, b, true);
}

Recorded operator-(const Recorded& a, const Recorded& b) {
  if (is(b, 0.0)) return a;
  if (is(a, 0.0)) return -b;
  if (!a.is_known() && a.node() == b.node()) return {0.0};
  if (const auto* negated = opposite_of(b)) return a + without_sign(*negated);
  return recorded(LaneOp::subtract, a.value() - b.value(), a, b);
}

Recorded operator*(const Recorded& a, const Recorded& b) {
  if (is(a, 0.0) || is(b, 0.0)) return {0.0};
  if (is(a, 1.0)) return b;
  if (is(b, 1.0)) return a;
  if (is(a, -1.0)) return -b;
  if (is(b, -1.0)) return -a;
  if (const auto* negated = opposite_of(a)) return -(without_sign(*negated) * b);
  if (const auto* negated = opposite_of(b)) return -(a * without_sign(*negated));
  return recorded(LaneOp::multiply, a.value() * b.value(), a, b, true);
}

Recorded operator/(const Recorded& a, const Recorded& b) {
  if (is(a, 0.0)) return {0.0};
  int exponent = 0;
  if (b.is_known() && std::abs(std::frexp(b.value(), &exponent)) == 0.5) return a * Recorded(1.0 / b.value());
  if (const auto* negated = opposite_of(a)) return -(without_sign(*negated) / b);
  if (const auto* negated = opposite_of(b)) return -(a / without_sign(*negated));
  return recorded(LaneOp::divide, a.value() / b.value(), a, b);
}

Recorded operator-(const Recorded& a) {
  if (const auto* negated = opposite_of(a)) return without_sign(*negated);
  return recorded(LaneOp::negate, -a.value(), a);
}

RecordedMask operator==(const Recorded& a, const Recorded& b) {
  return compared(LaneOp::equal, a.value() == b.value(), a, b);
}
RecordedMask operator<(const Recorded& a, const Recorded& b) {
  return compared(LaneOp::less, a.value() < b.value(), a, b);
}
RecordedMask operator<=(const Recorded& a, const Recorded& b) {
  return compared(LaneOp::less_or_equal, a.value() <= b.value(), a, b);
}

Recorded sqrt(const Recorded& a) { return recorded(LaneOp::square_root, std::sqrt(a.value()), a); }
Recorded abs(const Recorded& a) { return recorded(LaneOp::absolute, std::abs(a.value()), a); }
Recorded floor(const Recorded& a) { return recorded(LaneOp::floor, std::floor(a.value()), a); }
Recorded sin(const Recorded& a) { return recorded(LaneOp::sine, std::sin(a.value()), a); }
Recorded cos(const Recorded& a) { return recorded(LaneOp::cosine, std::cos(a.value()), a); }
Recorded tan(const Recorded& a) { return recorded(LaneOp::tangent, std::tan(a.value()), a); }
Recorded atan(const Recorded& a) { return recorded(LaneOp::arc_tangent, std::atan(a.value()), a); }
Recorded atan2(const Recorded& a, const Recorded& b) {
  return recorded(LaneOp::arc_tangent_of, std::atan2(a.value(), b.value()), a, b);
}
Recorded exp(const Recorded& a) { return recorded(LaneOp::exponential, std::exp(a.value()), a); }
Recorded expm1(const Recorded& a) { return recorded(LaneOp::exponential_less_one, std::expm1(a.value()), a); }
Recorded log(const Recorded& a) { return recorded(LaneOp::logarithm, std::log(a.value()), a); }
Recorded log1p(const Recorded& a) { return recorded(LaneOp::logarithm_of_more, std::log1p(a.value()), a); }
Recorded pow(const Recorded& a, const Recorded& b) {
  return recorded(LaneOp::power, std::pow(a.value(), b.value()), a, b);
}
Recorded sinh(const Recorded& a) { return recorded(LaneOp::hyperbolic_sine, std::sinh(a.value()), a); }
Recorded cosh(const Recorded& a) { return recorded(LaneOp::hyperbolic_cosine, std::cosh(a.value()), a); }
Recorded tanh(const Recorded& a) { return recorded(LaneOp::hyperbolic_tangent, std::tanh(a.value()), a); }
Recorded min(const Recorded& a, const Recorded& b) {
  return recorded(LaneOp::least, b.value() < a.value() ? b.value() : a.value(), a, b);
}
Recorded max(const Recorded& a, const Recorded& b) {
  return recorded(LaneOp::greatest, a.value() < b.value() ? b.value() : a.value(), a, b);
}

Recorded select(const RecordedMask& condition, const Recorded& a, const Recorded& b) {
  if (condition.is_known()) return condition.value() ? a : b;
  const double value = condition.value() ? a.value() : b.value();
  return {value, recording_of_thread->node(LaneOp::choice, {condition.node(), node_of(a), node_of(b)}, value)};
}

}  // namespace poise
