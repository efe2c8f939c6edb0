#pragma once

#include <optional>
#include <string>

namespace poise::studies {

/// The processes that compute one study together, on one machine or on several, and the messages between them. Used by
/// one thread of each.
class Ranks {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };

  virtual ~Ranks() = default;
  /// 0 .. size() - 1; rank 0 hands out the work and has the result.
  virtual int rank() const = 0;
  virtual int size() const = 0;
  virtual void send(int to, const std::string& bytes) = 0;
  /// A message that has arrived; none if there is none at this moment. Those of one sender arrive in their order.
  virtual std::optional<Message> receive() = 0;
};

}  // namespace poise::studies
