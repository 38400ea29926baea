// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

// What a worker process may do: read the system's libraries and data, use one folder of its own, and compute. No
// network, no other program, no other user's rights. Linux: Landlock, seccomp, resource limits.
namespace terrane {

struct WorkerLimits {
  std::uint64_t memory = std::uint64_t{4} << 30;       // bytes of address space
  std::uint64_t cpu_seconds = 3600;                    // of all threads together
  std::uint64_t file_bytes = std::uint64_t{16} << 30;  // of each file it writes
};

/// The user that workers are when the service runs as root: nobody.
inline constexpr unsigned worker_user = 65534;
/// Becomes that user for good; nothing happens to a process that is not root's.
void give_up_root();
/// True when this kernel can confine a process to folders.
bool can_confine_files();
/// The numbers of the system calls that confine() has refused whatever they are asked for.
std::span<const int> refused_calls();
/// From here on this process, for good: only `folder`/out is written, only system folders and `folder` are read, no
/// socket is made and no program started, and the limits hold. Throws Error{internal} when a part of it fails that the
/// kernel has.
void confine(const std::filesystem::path& folder, const WorkerLimits& limits);

}  // namespace terrane
