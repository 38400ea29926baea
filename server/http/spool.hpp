// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

// Bytes that wait: bodies until they are complete, answers until the client takes them. No thread waits with them.
namespace terrane {

/// How many bytes may wait, of everybody together and of one address. Safe to use from several threads.
class SpoolBudget {
 public:
  /// Files are made in `folder`, and have no name there.
  SpoolBudget(std::string folder, std::size_t all, std::size_t of_one)
      : folder_(std::move(folder)), all_(all), of_one_(of_one) {}

  /// Throws HttpError 429 when the address has too much, Error{busy} when all have.
  void take(const std::string& address, std::size_t count);
  void give_back(const std::string& address, std::size_t count);
  /// Memory is an offer: false when there is none left, then a file has to do.
  bool take_memory(std::size_t count);
  void give_back_memory(std::size_t count);
  const std::string& folder() const { return folder_; }

 private:
  const std::string folder_;
  const std::size_t all_, of_one_;
  std::mutex mutex_;
  std::size_t used_ = 0, memory_used_ = 0;
  std::map<std::string, std::size_t> used_by_;
};

/// Whose bytes they are: the address, of IPv6 the network of 64 bits that one customer gets.
std::string spool_owner(const std::string& address);

/// A sequence of bytes that grows at its end, in memory while it is small, then in a file that has no name.
class Spool {
 public:
  Spool(SpoolBudget& budget, std::string owner) : budget_(&budget), owner_(std::move(owner)) {}
  ~Spool() { clear(); }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  /// Throws what SpoolBudget::take throws, Error{storage_full} when the disk is full, and Error{internal}. Then nothing
  /// was appended.
  void append(std::string_view bytes);
  std::uint64_t size() const { return size_; }
  /// Bytes read from `offset`, as many as there are up to `count`. Throws Error{internal}.
  std::size_t read(std::uint64_t offset, char* to, std::size_t count) const;
  void clear();

 private:
  void move_to_file();
  void write(std::uint64_t offset, std::string_view bytes);

  SpoolBudget* budget_;
  std::string owner_;
  std::string memory_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace terrane
