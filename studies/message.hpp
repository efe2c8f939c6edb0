#pragma once

// What the ranks of a study tell each other. Private to this folder.

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace poise::studies {

enum class Tag : std::uint8_t {
  hello,   ///< to rank 0: how many chunks the sender wants at first, and the study it was given
  result,  ///< to rank 0: whether the sender wants another chunk, the number of this one and its rows
  failed,  ///< to rank 0: the number of a sample and why it failed
  ended,   ///< to rank 0: the sender computes no more
  chunk,   ///< from rank 0: compute the chunk of this number
  nothing  ///< from rank 0: there is no further chunk
};

/// A message of numbers, one behind the other, and a text or more numbers at its end. All machines of a study have the
/// same byte order.
class Packed {
 public:
  explicit Packed(Tag tag) { put(tag); }
  explicit Packed(std::string received) : bytes_(std::move(received)) {}

  template <class Number>
  Packed& put(Number value) {
    static_assert(std::is_trivially_copyable_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  Packed& put(const std::vector<double>& values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
    return *this;
  }
  Packed& put(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

  template <class Number>
  Number take() {
    Number value{};
    std::memcpy(&value, bytes_.data() + at_, sizeof(value));
    at_ += sizeof(value);
    return value;
  }
  std::vector<double> take_numbers() {
    std::vector<double> values((bytes_.size() - at_) / sizeof(double));
    if (!values.empty()) std::memcpy(values.data(), bytes_.data() + at_, values.size() * sizeof(double));
    return values;
  }
  std::string take_text() { return bytes_.substr(at_); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace poise::studies
