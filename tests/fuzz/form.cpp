// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "fuzz/plan_check.hpp"

namespace {

using namespace terrane;

/// What a form ends in: its parts, or why it is none.
struct Ending {
  std::vector<FormPart> parts;
  std::string complaint;
};

Ending parsed(const std::string& boundary, std::string_view body, std::size_t piece) {
  MultipartParser parser(boundary, [](const FormPart& part) { return part.has_file_name ? 1000 : 100; });
  try {
    for (; !body.empty(); body.remove_prefix(std::min(piece, body.size()))) parser.feed(body.substr(0, piece));
    return {parser.finish(), ""};
  } catch (const Error& error) {
    return {{}, error.what()};
  }
}

bool same(const FormPart& p, const FormPart& q) {
  const auto all = [](const FormPart& f) {
    return std::tie(f.name, f.has_file_name, f.file_name, f.media_type, f.content);
  };
  return all(p) == all(q);
}

}  // namespace

// libFuzzer on forms: a line with the content type, then the body. It is the same in pieces of any size, and what it
// asks for becomes a plan or is refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::check_plan(data, size, [&](const Operation& operation, std::string_view text) {
    const std::size_t line = std::min(text.find('\n'), text.size());
    const std::string boundary = multipart_boundary(text.substr(0, line));
    text.remove_prefix(std::min(line + 1, text.size()));
    Ending whole = parsed(boundary, text, text.size() + 1);
    const Ending pieces = parsed(boundary, text, 1 + size % 13);
    fuzz::require(whole.complaint == pieces.complaint, "the same complaint for any pieces");
    fuzz::require(std::equal(whole.parts.begin(), whole.parts.end(), pieces.parts.begin(), pieces.parts.end(), same),
                  "the same parts for any pieces");
    return ask_from_form(operation, std::move(whole.parts)).request;
  });
  return 0;
}
