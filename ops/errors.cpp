// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/errors.hpp"

#include <cerrno>
#include <new>
#include <system_error>

#include "ops/memory.hpp"

namespace terrane {
namespace {

struct Row {
  ErrorKind kind;
  int status, exit;
  const char* title;
};

constexpr Row table[] = {
    {ErrorKind::usage, 400, 2, "The request is not understood"},
    {ErrorKind::no_such_process, 404, 2, "No such process"},
    {ErrorKind::not_acceptable, 406, 2, "No acceptable output format"},
    {ErrorKind::unsupported, 415, 3, "Unsupported input format"},
    {ErrorKind::input, 422, 3, "The input cannot be worked on"},
    {ErrorKind::limit, 413, 4, "Larger than the limits"},
    {ErrorKind::busy, 503, 4, "Busy"},
    {ErrorKind::cancelled, 499, 4, "Cancelled"},
    {ErrorKind::storage_full, 507, 4, "The storage is full"},
    {ErrorKind::output, 500, 2, "The result cannot be stored"},
    {ErrorKind::internal, 500, 5, "Internal error"},
};

const Row& row(ErrorKind kind) {
  for (const Row& r : table)
    if (r.kind == kind) return r;
  return table[std::size(table) - 1];
}

}  // namespace

int http_status(ErrorKind kind) { return row(kind).status; }

int exit_code(ErrorKind kind) { return row(kind).exit; }

nlohmann::json problem(const Error& error) {
  const Row& r = row(error.kind);
  // OGC API - Processes names this one exception type itself.
  const std::string type = error.kind == ErrorKind::no_such_process
                               ? "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/no-such-process"
                               : "/problems/" + error.code;
  const bool ours = error.kind == ErrorKind::internal;
  return {
      {"type", ours ? "/problems/internal" : type},
      {"title", r.title},
      {"status", r.status},
      {"detail", ours ? "Terrane failed on this request. That is a mistake of ours, not of the input." : error.what()}};
}

Error as_error(const std::exception& exception) {
  if (const auto* ours = dynamic_cast<const Error*>(&exception)) return *ours;
  if (dynamic_cast<const std::bad_alloc*>(&exception)) return out_of_memory();
  if (const auto* system = dynamic_cast<const std::system_error*>(&exception))
    if (system->code() == std::errc::no_space_on_device || system->code().value() == EDQUOT)
      return {ErrorKind::storage_full, "storage-full", "There is no room left for this; send it again when there is."};
  return {ErrorKind::internal, "internal", exception.what()};
}

}  // namespace terrane
