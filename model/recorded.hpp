#pragma once

// A scalar that records what is computed with it, so that it can be computed again for other numbers.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "model/lane_op.hpp"
#include "model/pack.hpp"
#include "model/profile.hpp"

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

  /// All pieces of a function are recorded, each to be used where it holds, in place of the one in which the inputs
  /// are, with guards.
  bool keeps_all_pieces = false;
  /// While the piece is looked for: what is answered to the first questions, to all others yes, and what was asked.
  struct Search {
    const std::vector<bool>& answers;
    std::vector<Guard> asked{};
  };
  Search* search = nullptr;

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
  /// Null: none.
  static Recording* current();
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

template <>
inline constexpr bool has_lanes<Recorded> = true;

template <>
struct LaneOfScalar<Recorded> {
  using Type = double;
};

/// Whole turns of what repeats itself are counted where they are recorded, not for each lane.
template <>
template <>
inline auto ProfileIn<double>::turns_before<Recorded>(const Recorded& u) {
  return floor(u);
}
template <>
template <>
inline auto ProfileIn<Recorded>::turns_before<Recorded>(const Recorded& u) {
  return floor(u);
}

/// The piece that is found with these answers, and where more is asked the choice between those of either answer.
template <class Find, class Piece>
auto all_recorded_pieces(Recording& recording, Find find, Piece piece, std::vector<bool>& answers) {
  Recording::Search search{answers};
  recording.search = &search;
  const auto in = find([](const auto& x) { return WatchedNumber(x); });
  recording.search = nullptr;
  if (search.asked.size() == answers.size()) return piece(in);
  const Recording::Guard& question = search.asked[answers.size()];
  const RecordedMask condition(question.holds, question.mask);
  answers.push_back(true);
  const auto where_it_holds = all_recorded_pieces(recording, find, piece, answers);
  answers.back() = false;
  const auto elsewhere = all_recorded_pieces(recording, find, piece, answers);
  answers.pop_back();
  return select(condition, where_it_holds, elsewhere);
}

/// in_piece() of what is recorded.
template <class Find, class Piece>
auto in_pieces_of_lanes(const Recorded& /*scalar*/, Find find, Piece piece) {
  Recording* const recording = Recorder::current();
  if (recording == nullptr || !recording->keeps_all_pieces) {
    return piece(find([](const auto& x) { return WatchedNumber(x); }));
  }
  std::vector<bool> answers;
  return all_recorded_pieces(*recording, find, piece, answers);
}

}  // namespace poise

template <>
struct std::numeric_limits<poise::Recorded> : std::numeric_limits<double> {};
