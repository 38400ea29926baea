// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <string>
#include <variant>

#include "core/error.hpp"
#include "io/geodesy.hpp"

// Linked into the fuzzers of readers in the place of Crs::parse (the linker's --wrap): PROJ takes a hundred times what
// a reader does, and mutations of a file mostly leave the text of its CRS alone. That text has a fuzzer of its own, so
// once a few thousand of them have been understood, others are none.
namespace terrane {

Crs parse(std::string_view text) asm("__real_" TERRANE_CRS_PARSE);
Crs remembered(std::string_view text) asm("__wrap_" TERRANE_CRS_PARSE);

Crs remembered(std::string_view text) {
  static std::map<std::string, std::variant<Crs, Error>, std::less<>> known;
  auto found = known.find(text);
  if (found == known.end()) {
    if (known.size() > 3'000) throw Error(ErrorKind::input, "unknown-crs", "one text too many");
    try {
      found = known.emplace(text, parse(text)).first;
    } catch (const Error& error) {
      found = known.emplace(text, error).first;
    }
  }
  if (const Error* error = std::get_if<Error>(&found->second)) throw Error(*error);
  return std::get<Crs>(found->second);
}

}  // namespace terrane
