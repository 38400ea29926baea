// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "ops/request.hpp"

namespace terrane {

/// Opens a file, or standard input for "-". A regular file that is not small is read when its turn comes, its first bytes
/// apart; everything else is held. Throws Error{input}.
void read_file(const std::string& path, InputPart& part);

/// All of a file, or of standard input for "-". Throws Error{input}.
std::string read_whole_file(const std::string& path);

/// Throws Error{usage} when the path holds something already and may not be replaced.
void refuse_existing(const std::string& path, bool force);

/// A file that is stored whole or not at all: temporary name beside it, fsync, rename. "-" is standard output; pipes and
/// devices are written as they are. Nothing is touched before the first bytes come, and what was not kept is removed.
/// Throws Error{output}, and Error{limit} when the disk takes no more.
class OutputFile {
 public:
  OutputFile(std::string path, bool force) : path_(std::move(path)), force_(force) {}
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// True when nothing of what is written is to be seen before keep().
  bool holds_back() const;
  void write(std::string_view bytes);
  /// All bytes are written: the file gets its name.
  void keep();

 private:
  void open();

  std::string path_, temporary_;
  bool force_;
  int fd_ = -1;
};

/// True when what is stored under both names ends in one place.
bool is_same_place(const std::string& a, const std::string& b);

/// The last part of a path.
std::string file_name(const std::string& path);

}  // namespace terrane
