// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/tiff_directory.hpp"

#include <cstdint>
#include <optional>

namespace terrane {

namespace {

class Directory {
 public:
  explicit Directory(std::string_view bytes) : bytes_(bytes), big_endian_(bytes.starts_with("MM")) {}

  bool complete() const {
    const auto magic = number(2, 2);
    if (!magic || (*magic != 42 && *magic != 43)) return false;
    const bool big = *magic == 43;
    const std::size_t word = big ? 8 : 4;  // of counts, offsets and inline values
    const auto at = number(big ? 8 : 4, word);
    const auto entries = at ? number(*at, big ? 8 : 2) : std::nullopt;
    if (!entries || *entries > 65535) return false;
    std::uint64_t entry = *at + (big ? 8 : 2);
    for (std::uint64_t k = 0; k < *entries; ++k, entry += 4 + 2 * word)
      if (!entry_complete(entry, word)) return false;
    return true;
  }

 private:
  std::optional<std::uint64_t> number(std::uint64_t at, std::size_t size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const auto byte = static_cast<unsigned char>(bytes_[at + (big_endian_ ? k : size - 1 - k)]);
      value = value << 8 | byte;
    }
    return value;
  }

  bool entry_complete(std::uint64_t at, std::size_t word) const {
    constexpr std::uint64_t sizes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    const auto type = number(at + 2, 2), count = number(at + 4, word), offset = number(at + 4 + word, word);
    if (!type || !count || !offset) return false;
    const std::uint64_t size = *type < std::size(sizes) ? sizes[*type] : 0;
    if (size == 0) return true;  // a type nobody knows is skipped by everybody
    if (*count > bytes_.size()) return false;
    const std::uint64_t length = *count * size;
    return length <= word || (*offset <= bytes_.size() && bytes_.size() - *offset >= length);
  }

  std::string_view bytes_;
  bool big_endian_;
};

}  // namespace

bool tiff_directory_complete(std::string_view bytes) { return Directory(bytes).complete(); }

}  // namespace terrane
