// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace terrane {

/// A file open for reading, which may be renamed or removed meanwhile. Safe to use from several threads.
class OpenFile {
 public:
  /// Throws Error{internal} when it cannot be opened or is no plain file. Follows no link at its end.
  explicit OpenFile(const std::string& path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  std::uint64_t size() const { return size_; }
  /// Bytes read from `offset`, as many as there are up to `count`. Throws Error{internal}.
  std::size_t read(std::uint64_t offset, char* to, std::size_t count) const;
  /// The whole of it. Throws Error{internal} when it is larger than `most`.
  std::string text(std::uint64_t most = ~std::uint64_t{0}) const;

 private:
  int file_;
  std::uint64_t size_;
};

}  // namespace terrane
