// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <set>

#include "core/context.hpp"

// How much is worked on at the same time.
namespace terrane {

/// A bounded number of executions, a short line in front of them, and a bounded number of bytes of request bodies.
class Admission {
 public:
  /// At most `slots` at work, at most `line` waiting, at most `body_bytes` held by bodies of all requests together.
  Admission(int slots, int line, std::size_t body_bytes);

  /// A place among those at work, given back when destroyed. Its context is told when the service has to stop.
  class Place {
   public:
    /// Waits in the line. Throws Error{busy} when the line is full or the service stops before it is our turn.
    Place(Admission& admission, Context& context);
    ~Place();
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    Admission& admission_;
    Context& context_;
  };

  /// Bytes of one request's body, given back when destroyed.
  class Bytes {
   public:
    explicit Bytes(Admission& admission) : admission_(admission) {}
    ~Bytes();
    Bytes(const Bytes&) = delete;
    Bytes& operator=(const Bytes&) = delete;
    /// Throws Error{busy} when all bodies together would be too large.
    void add(std::size_t count);

   private:
    Admission& admission_;
    std::size_t count_ = 0;
  };

  /// True when a request that came now would be worked on, at once or after waiting in the line.
  bool has_room() const;
  /// Nobody new comes in; those at work and in the line go on.
  void close();
  /// Those in the line are sent away, those at work are asked to stop.
  void cancel();

 private:
  const int slots_, line_;
  const std::size_t body_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable freed_;
  int waiting_ = 0;
  std::size_t held_bytes_ = 0;
  bool closed_ = false, cancelled_ = false;
  std::set<Context*> at_work_;
};

}  // namespace terrane
