// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "ops/operation.hpp"

// What an execution takes of the address space that its process may have (RLIMIT_AS; a worker of the service has one),
// and what is said when that is too little: always Error{limit} "out-of-memory" with the figures.
namespace terrane {

/// Of this process, in bytes; 0 where the system does not say, or sets no limit.
struct AddressSpace {
  std::uint64_t now = 0, peak = 0, limit = 0;
};
AddressSpace address_space();

/// What each of some things takes at the peak, in bytes beside the program and the request.
struct MemoryUse {
  std::uint32_t least = 0;  // whatever the inputs and parameters: who has no more than this cannot succeed
  std::uint32_t most = 0;   // terrain takes no more
};

/// What is published of an operation: for a face of its inputs (of its result where it has none), and for a cell of the
/// raster or picture that it makes. Measured by ./dev memory; a test holds operations to it.
struct MemoryFigures {
  MemoryUse face, cell;
};
/// All zero where there is no geometry.
MemoryFigures memory_figures(std::string_view operation);

/// Throws when so many things cannot fit beside what is in use, `used`, even where each takes the least.
void require_memory(std::uint64_t used, std::uint64_t count, const std::string& things, const MemoryUse& each);

/// After an allocation failed: what the process had, what it may have, then `reckoned`.
Error out_of_memory(const std::string& reckoned = {});

/// What one execution is reckoned to take, from before its inputs are decoded.
class MemoryNeed {
 public:
  explicit MemoryNeed(const Operation& operation)
      : operation_(operation.id), face_(memory_figures(operation.id).face), used_(address_space().now) {}
  /// Counts the faces of the inputs, as far as they are known by now; throws when these cannot fit.
  void count(const std::vector<Surface>& inputs);
  /// After an allocation failed.
  Error exceeded() const;

 private:
  const std::string operation_;
  const MemoryUse face_;
  const std::uint64_t used_;  // by the program and the request
  std::uint64_t faces_ = 0;
};

}  // namespace terrane
