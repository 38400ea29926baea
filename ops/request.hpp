// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/context.hpp"
#include "io/format.hpp"

// What is asked and what comes back, the same for every door. bytes -> Request -> Plan -> Response.
namespace terrane {

struct Operation;

/// The bytes of an input that are not held, from the first on.
struct InputStream {
  Source::Fill fill;
  std::size_t size = 0;
};

/// One input as it arrived: bytes, or a number ("12.5", a level) where the operation takes one.
struct InputPart {
  std::string slot;        // which input of the operation: "minuend", "tiles"
  std::string name;        // file name without folders, for messages and the certificate
  std::string media_type;  // as declared, or empty
  std::string bytes;
  /// Where an input is read from when its turn comes; `bytes` are then only the first of it, for telling its format.
  /// Null: `bytes` is all. May throw Error{input}.
  std::function<InputStream()> open = nullptr;
  std::string href = {};  // of an input by reference, which its door must have resolved before it is planned
};

/// A request as a door understood it; nothing is checked yet.
struct Request {
  std::string operation;
  std::vector<InputPart> inputs = {};                                // in the order given
  std::vector<std::pair<std::string, std::string>> parameters = {};  // kebab-case name, text; a name may occur once
  std::string format = {};  // `f` / `--format`; empty: let accept, output name or the operation's default decide
  std::vector<std::string> accept = {};  // media types in order of preference; empty: anything
  std::string output_name = {};  // "-o" on the command line, whose extension decides the format when `format` is empty
};

/// A request with every complaint made that can be made before an input is decoded: parameters parsed and in range,
/// number of inputs, input formats known, output format chosen.
struct Plan {
  const Operation* operation = nullptr;
  Request request;
  nlohmann::json parameters;  // name -> parsed value, defaults filled in; of long vectors only their sum
  std::map<std::string, std::string> vectors;  // the bytes of parameters that are vectors
  std::string output_format;  // a word of io/formats, or "json"/"csv"/"png" of an operation whose result is no TIN
};

/// One of several outputs.
struct ResultPart {
  std::string id, media_type, file_name, body;
};

struct Response {
  std::string media_type;
  std::string file_name;  // "merge.obj", for Content-Disposition
  std::string body;       // empty where the bytes went elsewhere
  nlohmann::json report;  // the certificate (or the volume report, ...); the same whatever the door
  std::vector<Warning> warnings;
  /// Of an operation with several outputs those that have a value, each by itself; the body is all of them as one JSON
  /// object.
  std::vector<ResultPart> parts;
};

/// Throws Error{no_such_process | usage | unsupported | not_acceptable}.
Plan plan(Request request);

/// Where the bytes of a result go.
struct Body {
  Sink sink = nullptr;  // null: into the response
  /// Whoever takes them shows nothing of them before execute() returns, and nothing at all when it throws. Then they
  /// may come while the result is still being verified; to any other body they come after everything that could be
  /// complained of.
  bool held_back = false;
};

/// Decodes, brings to a common frame, runs, restores the CRS, verifies, encodes. Throws Error.
Response execute(const Plan& plan, Context& context, const Body& body = {});

}  // namespace terrane
