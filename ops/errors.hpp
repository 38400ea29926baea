// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "core/error.hpp"

// ErrorKind -> HTTP status and exit code: the one table.
namespace terrane {

int http_status(ErrorKind kind);  // 400 404 406 413 415 422 499 500 503 507
int exit_code(ErrorKind kind);  // 2 usage or parameter, 3 input data, 4 limit, 5 our fault

/// RFC 7807: type (".../problems/no-overlap"), title, status, detail. What is our fault says nothing of its inside.
nlohmann::json problem(const Error& error);

/// Any exception as an Error: ours as they are, bad_alloc as a limit, a full disk as such, everything else internal.
Error as_error(const std::exception& exception);

}  // namespace terrane
