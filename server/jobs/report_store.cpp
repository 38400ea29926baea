// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/jobs/report_store.hpp"

#include "ops/sha256.hpp"

namespace terrane {

std::string ReportStore::put(std::string text) {
  if (text.size() > capacity_ / 4) return "";
  const std::string id = sha256(text).substr(0, 32);
  const std::lock_guard lock(mutex_);
  if (const auto found = by_id_.find(id); found != by_id_.end()) {
    entries_.splice(entries_.begin(), entries_, found->second);
    return id;
  }
  bytes_ += text.size();
  entries_.push_front({id, std::move(text)});
  by_id_[id] = entries_.begin();
  while (bytes_ > capacity_) {
    bytes_ -= entries_.back().text.size();
    by_id_.erase(entries_.back().id);
    entries_.pop_back();
  }
  return id;
}

std::optional<std::string> ReportStore::get(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = by_id_.find(id);
  if (found == by_id_.end()) return std::nullopt;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->text;
}

}  // namespace terrane
