// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ops/operation.hpp"
#include "ops/request.hpp"
#include "server/requests/multipart.hpp"

// From the two kinds of body to the one Request that every door makes.
namespace terrane {

/// What a body asks for: the request, and in which wrapping the result is wanted.
struct OutputAsk {
  std::string id;
  bool by_reference = false;  // OGC "transmissionMode": "reference"
};

struct Ask {
  Request request;
  bool as_document = false;        // OGC "response": "document"
  std::vector<OutputAsk> outputs;  // in the order asked for; empty: all
  nlohmann::json subscriber;       // OGC "subscriber": URIs by event, or null
};

/// Parts are inputs by name, in order; a part that is no input of the operation and has no file name, or that is one of
/// its parameters, is a parameter. `f` and `format` choose the output format.
Ask ask_from_form(const Operation& operation, std::vector<FormPart> parts);

/// An OGC API - Processes execute request. Values of inputs: numbers (levels), text, inline objects (a TIN as Terrane
/// JSON), qualified values {"value", "mediaType", "encoding": "base64", "name"}, references {"href", "type", "name"},
/// arrays of those. Whatever else stands among `inputs` is a parameter; arrays of numbers and text become
/// comma-separated lists, objects their text. Throws Error{usage}; what is not understood is refused, not ignored.
Ask ask_from_json(const Operation& operation, std::string_view body);

}  // namespace terrane
