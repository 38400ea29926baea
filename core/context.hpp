// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace terrane {

/// Something the user should know that does not stop the work.
struct Warning {
  std::string code;     // kebab-case
  std::string input;    // name of the input, or empty
  std::string element;  // "vertex 17", or empty
  std::string message;
  std::string remedy;
};

/// The only thing that travels beside the values: progress, cancellation, warnings, the thread budget.
/// One context belongs to one request and is used by one thread; only `cancelled` may be set by another.
class Context {
 public:
  /// Called with a stage ("overlay") and the fraction of it that is done, 0 to 1.
  std::function<void(std::string_view stage, double fraction)> on_progress;
  std::atomic<bool> cancelled = false;
  int threads = 1;
  std::vector<Warning> warnings;

  /// Reports progress and throws Error{cancelled} when the work is no longer wanted. Cheap enough for every 10,000 faces.
  void progress(std::string_view stage, double fraction);
  /// The same check without the report; any thread of the work may ask.
  void stop_if_cancelled() const;
  void warn(Warning warning) { warnings.push_back(std::move(warning)); }
};

}  // namespace terrane
