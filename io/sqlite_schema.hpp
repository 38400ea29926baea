// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace terrane {

/// The SQL that a SQLite database is made of, in the order in which it is stored; none where the file is damaged, or
/// keeps its text as UTF-16. Nothing of it is run: a database is asked this before SQLite sees it.
std::optional<std::vector<std::string>> sqlite_schema(std::string_view bytes);

/// The rows, as the bytes they are stored in, of the tables whose SQL holds a word in small letters; none where they
/// are damaged.
std::optional<std::vector<std::string>> sqlite_rows(std::string_view bytes, std::string_view word);

/// Does a statement of a schema make something that works when its rows are read: a view, a column that is generated, a
/// virtual table other than the index of places that GeoPackages have? Such a thing need not end, and may open files.
bool runs_when_read(std::string_view sql);

}  // namespace terrane
