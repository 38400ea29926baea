// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <set>
#include <utility>

#include "core/context.hpp"

// How much is worked on at the same time.
namespace terrane {

/// A bounded number of executions, and a short line in front of them.
class Admission {
 public:
  /// At most `slots` at work, at most `line` waiting.
  Admission(int slots, int line) : slots_(slots), line_(line) {}

  /// Who waits patiently stands beside the line, is not counted, and lets those in the line go first.
  enum class Manner { in_line, patient };

  /// A place among those at work, given back when destroyed. Its context is told when the service has to stop.
  class Place {
   public:
    /// Waits in the line. Throws Error{busy} when the line is full or the service stops before it is our turn, and
    /// Error{cancelled} when the place `is_unwanted` any more, which is asked now and then.
    Place(Admission& admission, Context& context, Manner manner = Manner::in_line,
          const std::function<bool()>& is_unwanted = {});
    ~Place();
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    Admission& admission_;
    Context& context_;
  };

  /// True when a request that came now would be worked on, at once or after waiting in the line.
  bool has_room() const;
  /// How many are at work, and how many in the line.
  std::pair<std::size_t, std::size_t> load() const;
  /// Nobody new comes in; those at work and in the line go on.
  void close();
  /// Those in the line are sent away, those at work are asked to stop.
  void cancel();

 private:
  const int slots_, line_;
  mutable std::mutex mutex_;
  std::condition_variable freed_;
  int waiting_ = 0;
  bool closed_ = false, cancelled_ = false;
  std::set<Context*> at_work_;
};

}  // namespace terrane
