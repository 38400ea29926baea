// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>

// Certificates that a result's Link points to, kept for a while.
namespace terrane {

/// Texts by the hash of their content; the one not asked for longest goes first when there are too many bytes. Safe to
/// use from several threads.
class ReportStore {
 public:
  explicit ReportStore(std::size_t capacity) : capacity_(capacity) {}

  /// The id of the text, 32 hexadecimal digits; empty when it is too large to be kept (a quarter of the whole).
  std::string put(std::string text);
  /// The text, or nothing when it was never there or is gone.
  std::optional<std::string> get(const std::string& id);

 private:
  struct Entry {
    std::string id, text;
  };
  const std::size_t capacity_;
  std::mutex mutex_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  // the latest first
  std::map<std::string, std::list<Entry>::iterator> by_id_;
};

}  // namespace terrane
