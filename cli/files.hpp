// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace terrane {

/// The bytes of a file, or of standard input for "-". Throws Error{input}.
std::string read_file(const std::string& path);

/// Throws Error{usage} when the path holds something already and may not be replaced.
void refuse_existing(const std::string& path, bool force);

/// Stores bytes whole or not at all: temporary name beside it, fsync, rename. "-" is standard output; pipes and
/// devices are
/// written as they are. Throws Error{output}, and Error{limit} when the disk takes no more.
void store_file(const std::string& path, std::string_view bytes, bool force);

/// True when what is stored under both names ends in one place.
bool is_same_place(const std::string& a, const std::string& b);

/// The last part of a path.
std::string file_name(const std::string& path);

}  // namespace terrane
