#pragma once

// A scalar that records what is computed with it, so that it can be computed again for other numbers.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "model/pack.hpp"
#include "statics/many/private/lane_op.hpp"

namespace poise {

/// What is computed, as nodes that refer to earlier ones; the same of the same operands is one node. Beside it each has
/// a value: that for one set of inputs, by which those who record decide.
class Recording {
 public:
  struct Node {
    LaneOp op = LaneOp::constant;
    std::array<int, 3> of{-1, -1, -1};
    double value = 0.0;  ///< of a mask 1 or 0
  };
  /// A mask that has to be as it is for what was recorded to hold.
  struct Guard {
    int mask = -1;
    bool holds = true;
  };

  const std::vector<Node>& nodes() const { return nodes_; }
  int input(double value);
  int constant(double value);
  int node(LaneOp op, std::array<int, 3> of, double value);

  std::vector<Guard> guards;
  /// Every comparison that was made, with what it was.
  std::vector<Guard> comparisons;

 private:
  struct Key {
    LaneOp op;
    std::array<int, 3> of;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };

  std::vector<Node> nodes_;
  std::unordered_map<Key, int, Hash> known_;
  std::unordered_map<std::uint64_t, int> constants_;
};

/// The recording that this thread's scalars go to, while an object of this class exists.
class Recorder {
 public:
  explicit Recorder(Recording& to);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder();
};

/// A condition on recorded numbers: in some lanes true, in others not.
template <>
class Mask<0> {
 public:
  Mask() = default;
  /// All lanes have this value.
  explicit Mask(bool value) : value_(value) {}
  Mask(bool value, int node) : value_(value), node_(node) {}

  bool value() const { return value_; }
  /// -1: the same in all lanes.
  int node() const { return node_; }
  bool is_known() const { return node_ < 0; }
  /// What is decided by it is watched: what is recorded holds in lanes that would decide the same, which a guard of the
  /// recording requires.
  explicit operator bool() const;

  friend Mask operator!(const Mask& a);
  friend Mask operator&&(const Mask& a, const Mask& b);
  friend Mask operator||(const Mask& a, const Mask& b);
  friend bool all(const Mask& a) { return a.is_known() && a.value_; }
  friend bool any(const Mask& a) { return !a.is_known() || a.value_; }

 private:
  bool value_ = false;
  int node_ = -1;
};
using RecordedMask = Mask<0>;

class WatchedNumber;

/// A number that is recorded. One that depends on no input is a number like any other.
class Recorded {
 public:
  Recorded() = default;
  Recorded(double value) : value_(value) {}
  Recorded(double value, int node) : value_(value), node_(node) {}
  static Recorded input(double value);

  double value() const { return value_; }
  /// -1: it depends on no input.
  int node() const { return node_; }
  bool is_known() const { return node_ < 0; }
  explicit operator double() const { return value_; }
  /// As of a Pack. What is decided by it is watched.
  WatchedNumber operator[](int lane) const;
  template <class F>
  static Recorded of_each(F f) {
    return Recorded(static_cast<double>(f(0)));
  }

  friend Recorded operator+(const Recorded& a, const Recorded& b);
  friend Recorded operator-(const Recorded& a, const Recorded& b);
  friend Recorded operator*(const Recorded& a, const Recorded& b);
  friend Recorded operator/(const Recorded& a, const Recorded& b);
  friend Recorded operator-(const Recorded& a);
  Recorded& operator+=(const Recorded& b) { return *this = *this + b; }
  Recorded& operator-=(const Recorded& b) { return *this = *this - b; }
  Recorded& operator*=(const Recorded& b) { return *this = *this * b; }
  Recorded& operator/=(const Recorded& b) { return *this = *this / b; }

  friend RecordedMask operator==(const Recorded& a, const Recorded& b);
  friend RecordedMask operator!=(const Recorded& a, const Recorded& b) { return !(a == b); }
  friend RecordedMask operator<(const Recorded& a, const Recorded& b);
  friend RecordedMask operator>(const Recorded& a, const Recorded& b) { return b < a; }
  friend RecordedMask operator<=(const Recorded& a, const Recorded& b);
  friend RecordedMask operator>=(const Recorded& a, const Recorded& b) { return b <= a; }

  friend Recorded sqrt(const Recorded& a);
  friend Recorded abs(const Recorded& a);
  friend Recorded floor(const Recorded& a);
  friend Recorded sin(const Recorded& a);
  friend Recorded cos(const Recorded& a);
  friend Recorded tan(const Recorded& a);
  friend Recorded atan(const Recorded& a);
  friend Recorded atan2(const Recorded& a, const Recorded& b);
  friend Recorded exp(const Recorded& a);
  friend Recorded expm1(const Recorded& a);
  friend Recorded log(const Recorded& a);
  friend Recorded log1p(const Recorded& a);
  friend Recorded pow(const Recorded& a, const Recorded& b);
  friend Recorded sinh(const Recorded& a);
  friend Recorded cosh(const Recorded& a);
  friend Recorded tanh(const Recorded& a);
  friend Recorded min(const Recorded& a, const Recorded& b);
  friend Recorded max(const Recorded& a, const Recorded& b);
  friend Recorded select(const RecordedMask& condition, const Recorded& a, const Recorded& b);
  friend Recorded zero_where(const RecordedMask& condition, const Recorded& x) {
    return select(condition, Recorded(), x);
  }

 private:
  double value_ = 0.0;
  int node_ = -1;
};

/// A recorded number by whose value a piece of a function is chosen: comparisons are decided, and watched.
class WatchedNumber {
 public:
  WatchedNumber(double value) : number_(value) {}
  WatchedNumber(const Recorded& number) : number_(number) {}

  friend bool operator<(const WatchedNumber& a, const WatchedNumber& b) {
    return static_cast<bool>(a.number_ < b.number_);
  }
  friend bool operator>(const WatchedNumber& a, const WatchedNumber& b) {
    return static_cast<bool>(b.number_ < a.number_);
  }
  friend bool operator<=(const WatchedNumber& a, const WatchedNumber& b) {
    return static_cast<bool>(a.number_ <= b.number_);
  }
  friend bool operator>=(const WatchedNumber& a, const WatchedNumber& b) {
    return static_cast<bool>(b.number_ <= a.number_);
  }

 private:
  Recorded number_;
};

inline WatchedNumber Recorded::operator[](int /*lane*/) const { return {*this}; }

template <>
inline constexpr bool has_lanes<Recorded> = true;

template <>
struct LaneOfScalar<Recorded> {
  using Type = double;
};

/// in_piece() of what is recorded: the piece that its value is in.
template <class Find, class Piece>
auto in_pieces_of_lanes(const Recorded& /*scalar*/, Find find, Piece piece) {
  return piece(find([](const auto& x) { return WatchedNumber(x); }));
}

}  // namespace poise

template <>
struct std::numeric_limits<poise::Recorded> : std::numeric_limits<double> {};
