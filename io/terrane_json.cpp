// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "io/format_list.hpp"
#include "io/json_reader.hpp"
#include "io/rows.hpp"
#include "io/text.hpp"

// Terrane JSON: one object with type, crs, vertices, triangles.
namespace terrane {

namespace {

void append_json_string(std::string& out, std::string_view text) {
  out += '"';
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  out += '"';
}

constexpr std::size_t row_size = 3 * (number_size + 1) + 3;

char* put_row(char* to, std::size_t i, auto a, auto b, auto c) {
  if (i != 0) *to++ = ',';
  *to++ = '\n';
  *to++ = '[';
  to = put_number(to, a);
  *to++ = ',';
  to = put_number(to, b);
  *to++ = ',';
  to = put_number(to, c);
  *to++ = ']';
  return to;
}

/// Its list of faces has a row for each face of the result with the face of every input; `decided` has the input.
void write_provenance(const Provenance& from, std::size_t faces, RowWriter& rows, const Sink& sink) {
  std::string head = ",\"provenance\":{\"inputs\":[";
  for (std::size_t i = 0; i < from.inputs.size(); ++i) {
    if (i != 0) head += ',';
    append_json_string(head, from.inputs[i]);
  }
  head += "],\"policy\":";
  append_json_string(head, from.policy);
  sink(head + ",\"faces\":[");
  const auto put_index = [](char* to, Index index) {
    return index == none ? std::copy_n("null", 4, to) : put_number(to, index);
  };
  std::vector<Index> decided(faces, none);
  rows.write(faces, 4 + from.inputs.size() * (number_size + 1), [&](char* to, std::size_t i) {
    thread_local std::vector<Index> of_inputs;
    of_inputs.assign(from.inputs.size(), none);
    decided[i] = from.trace(i, of_inputs);
    if (i != 0) *to++ = ',';
    *to++ = '\n';
    *to++ = '[';
    for (std::size_t k = 0; k < of_inputs.size(); ++k) {
      if (k != 0) *to++ = ',';
      to = put_index(to, of_inputs[k]);
    }
    *to++ = ']';
    return to;
  });
  sink("],\"decided\":[");
  rows.write(faces, number_size + 1, [&](char* to, std::size_t i) {
    if (i != 0) *to++ = ',';
    return put_index(to, decided[i]);
  });
  sink("]}");
}

void write_json(const Tin& tin, const Crs& crs, const WriteOptions& options, const Sink& sink, Context& context) {
  std::string head = "{\"type\":\"TIN\",\"crs\":";
  if (crs.known())
    append_json_string(head, crs.id());
  else
    head += "null";
  sink(head + ",\"vertices\":[");
  const std::size_t times = options.provenance ? 3 : 1;
  RowWriter rows(sink, tin.vertices.size() + times * tin.faces.size(), context);
  rows.write(tin.vertices.size(), row_size, [&](char* to, std::size_t i) {
    const Point& p = tin.vertices[i];
    return put_row(to, i, p.x, p.y, p.z);
  });
  sink("],\"triangles\":[");
  rows.write(tin.faces.size(), row_size, [&](char* to, std::size_t i) {
    const Face& f = tin.faces[i];
    return put_row(to, i, f[0], f[1], f[2]);
  });
  sink("]");
  if (options.provenance) write_provenance(*options.provenance, tin.faces.size(), rows, sink);
  if (!options.certificate_json.empty()) sink(",\"certificate\":" + options.certificate_json);
  sink("}\n");
}

bool sniff_json(std::string_view head) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  head = trimmed(head);
  return head.starts_with('{') && head.find("\"type\"") != std::string_view::npos &&
         head.find("\"TIN\"") != std::string_view::npos;
}

}  // namespace

Format json_format() {
  return {"json",
          {".json"},
          "application/json",
          "Terrane JSON: vertices, triangles, CRS and certificate in one document, exact on the round trip.",
          read_terrane_json,
          write_json,
          sniff_json,
          true};
}

}  // namespace terrane
