// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace terrane {

/// What went wrong, independent of the door through which the request came. The doors map it to HTTP statuses and exit
/// codes (ops/errors).
enum class ErrorKind {
  usage,            // the request itself: unknown parameter, wrong type, out of range
  no_such_process,  // unknown operation
  not_acceptable,   // no output format that the client takes
  unsupported,      // an input in a format we do not read
  input,            // the data of an input
  limit,            // larger than the configured limits
  busy,             // nothing free to work on it; later it may be
  cancelled,        // the client asked to stop
  storage_full,     // no room left to keep a request or its result
  output,           // the result cannot be stored where it was asked to go
  internal          // our fault
};

/// The one exception of Terrane. Messages name the input, the element (vertex 17, face 9, line 42) and the remedy.
/// `code` is the kebab-case word a program can react to ("no-overlap", "mixed-crs").
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string code, const std::string& message)
      : std::runtime_error(message), kind(kind), code(std::move(code)) {}
  ErrorKind kind;
  std::string code;
};

}  // namespace terrane
