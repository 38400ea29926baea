// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

// Requests that we send because a client named a place. libcurl, because it shows every address before it connects.
namespace terrane {

class Outbound {
 public:
  /// `hosts`: "example.org" or "example.org:8443", the only ones that are spoken to; DEFAULT none. An address that is
  /// loopback, link-local, private or multicast is refused even then, unless the entry is that address itself.
  explicit Outbound(std::vector<std::string> hosts) : hosts_(std::move(hosts)) {}

  struct Fetched {
    std::string media_type, name;  // as declared; the last part of the path
  };
  /// GET to a new file of at most `most` bytes. No redirects. Throws Error{usage} "reference-not-allowed", Error{input}
  /// "reference-failed", Error{limit}, Error{storage_full}.
  Fetched fetch(const std::string& uri, const std::filesystem::path& to, std::uint64_t most) const;

  enum class Answer {
    taken,    // 2xx
    refused,  // 4xx, or the place is not allowed: the same would be refused again
    none      // within ten seconds, or any other
  };
  Answer post(const std::string& uri, const std::string& media_type, const std::string& body) const;

  /// Whatever goes on ends soon, and nothing is begun any more.
  void stop() const { stopping_ = true; }

  /// Whether the place is on the list, before its name is resolved.
  bool is_allowed(const std::string& uri) const;

 private:
  std::vector<std::string> hosts_;
  mutable std::atomic<bool> stopping_ = false;
};

}  // namespace terrane
