// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/requests/execute_request.hpp"

#include <algorithm>
#include <optional>

#include "core/error.hpp"
#include "ops/base64.hpp"
#include "server/http/message.hpp"
#include "server/requests/json_slices.hpp"

namespace terrane {

namespace {

const InputSlot* slot_named(const Operation& operation, std::string_view name) {
  const auto found = std::find_if(operation.inputs.begin(), operation.inputs.end(),
                                  [&](const InputSlot& slot) { return slot.name == name; });
  return found == operation.inputs.end() ? nullptr : &*found;
}

bool has_parameter(const Operation& operation, std::string_view name) {
  const auto named = [&](const Parameter& parameter) { return parameter.name == name; };
  return std::any_of(operation.parameters.begin(), operation.parameters.end(), named) ||
         std::any_of(common_parameters().begin(), common_parameters().end(), named);
}

[[noreturn]] void fail(const std::string& code, const std::string& message) {
  throw Error(ErrorKind::usage, code, message);
}

void set_format(Request& request, const std::string& word) {
  if (!request.format.empty() && request.format != word) {
    fail("repeated-parameter", "The output format is given twice: " + request.format + " and " + word + ".");
  }
  request.format = word;
}

void add_parameter(Request& request, std::string name, std::string text) {
  if (name == "f" || name == "format") {
    set_format(request, text);
  } else {
    request.parameters.emplace_back(std::move(name), std::move(text));
  }
}

std::string json_string(std::string_view slice, const std::string& what) {
  const nlohmann::json value = parse_json(slice, what);
  if (!value.is_string()) fail("wrong-type", "The value of " + what + " must be a string.");
  return value.get<std::string>();
}

bool is_string(std::string_view slice) { return json_kind(slice) == '"'; }

/// The standard's schema has mediaType and encoding beside the value, its examples have them in a member format.
JsonMembers with_format_opened(JsonMembers members) {
  for (const auto& [key, slice] : JsonMembers(members))
    if (key == "format" && json_kind(slice) == '{')
      for (const auto& inner : json_members(slice)) members.push_back(inner);
  return members;
}

/// The members of {"value": …, "mediaType": …}, or nothing when the object is something else, such as a TIN.
std::optional<JsonMembers> qualified_value(std::string_view slice) {
  if (json_kind(slice) != '{') return std::nullopt;
  JsonMembers members = json_members(slice);
  const bool has_value = std::any_of(members.begin(), members.end(), [](const auto& m) { return m.first == "value"; });
  if (!has_value) return std::nullopt;
  return members;
}

InputPart input_from_qualified(const std::string& slot, const JsonMembers& plain) {
  InputPart part{slot, slot, "", ""};
  std::string_view value;
  std::string encoding;
  for (const auto& [key, slice] : with_format_opened(plain)) {
    const std::string what = "input " + slot + ", " + key;
    if (key == "value")
      value = slice;
    else if (key == "mediaType")
      part.media_type = json_string(slice, what);
    else if (key == "encoding")
      encoding = json_string(slice, what);
    else if (key == "name")
      part.name = base_name(json_string(slice, what));
    else if (key != "schema" && key != "format")
      fail("unknown-member",
           "The value of " + slot + " has an unknown member " + key + "; there are value, mediaType, encoding, name.");
  }
  if (!encoding.empty() && encoding != "base64" && encoding != "binary" && encoding != "utf-8") {
    fail("bad-encoding", "The encoding of " + slot + " is " + encoding + "; there is base64, or none for text.");
  }
  if (encoding == "base64" && !is_string(value))
    fail("wrong-type", "The base64 value of " + slot + " must be a string.");
  part.bytes = is_string(value) ? json_string(value, "input " + slot) : std::string(value);
  if (encoding == "base64") part.bytes = decode_base64(part.bytes, "input " + slot);
  return part;
}

/// {"href": …, "type": …}, an OGC link, perhaps with a format as values have it, or nothing when the object is
/// something else.
std::optional<InputPart> input_by_reference(const std::string& slot, std::string_view slice) {
  if (json_kind(slice) != '{') return std::nullopt;
  const JsonMembers members = with_format_opened(json_members(slice));
  if (std::none_of(members.begin(), members.end(), [](const auto& m) { return m.first == "href"; }))
    return std::nullopt;
  constexpr std::string_view others[] = {"rel", "hreflang", "title", "format", "encoding", "schema"};
  InputPart part{slot, slot, "", ""};
  for (const auto& [key, text] : members) {
    const std::string what = "input " + slot + ", " + key;
    if (key == "href")
      part.href = json_string(text, what);
    else if (key == "type" || key == "mediaType")
      part.media_type = json_string(text, what);
    else if (key == "name")
      part.name = base_name(json_string(text, what));
    else if (std::find(std::begin(others), std::end(others), key) == std::end(others))
      fail("unknown-member",
           "The reference of " + slot + " has an unknown member " + key + "; there are href, type, name.");
  }
  if (part.href.empty()) fail("bad-reference", "The href of " + slot + " is empty.");
  return part;
}

/// A file that nothing but itself tells what it is: base64, as the standard has binary values.
InputPart file_from_value(const std::string& slot, std::string_view slice) {
  if (auto reference = input_by_reference(slot, slice)) return std::move(*reference);
  if (const auto members = qualified_value(slice)) return input_from_qualified(slot, *members);
  if (!is_string(slice))
    fail("wrong-type", "The value of input " + slot + " must be base64, alone or with what it is.");
  return {slot, slot, "", decode_base64(json_string(slice, "input " + slot), "input " + slot)};
}

InputPart input_from_value(const std::string& slot, std::string_view slice) {
  if (auto reference = input_by_reference(slot, slice)) return std::move(*reference);
  if (const auto members = qualified_value(slice)) return input_from_qualified(slot, *members);
  switch (json_kind(slice)) {
    case '{':
      return {slot, slot + ".json", "", std::string(slice)};
    case '"':
      return {slot, slot, "", json_string(slice, "input " + slot)};
    case '[':
      fail("wrong-type", "The value of input " + slot + " is an array inside an array.");
    default:
      break;
  }
  if (!parse_json(slice, "input " + slot).is_number()) {
    fail("wrong-type", "The value of input " + slot + " must be a number, text, an object, or an array of those.");
  }
  return {slot, slot, "", std::string(slice)};
}

/// A parameter as the text that the query or the command line would have.
std::string parameter_text(const std::string& name, std::string_view slice) {
  if (const auto members = qualified_value(slice)) {
    const InputPart part = input_from_qualified(name, *members);
    return part.bytes;
  }
  switch (json_kind(slice)) {
    case '"':
      return json_string(slice, "parameter " + name);
    case '{':
      return parse_json(slice, "parameter " + name).dump();
    case '[': {
      std::string list;
      for (const std::string_view element : json_elements(slice)) {
        const char kind = json_kind(element);
        if (kind == '[' || kind == '{')
          fail("wrong-type", "The list of parameter " + name + " holds more than numbers and text.");
        list += (list.empty() ? "" : ",") + parameter_text(name, element);
      }
      return list;
    }
    default: {
      const nlohmann::json value = parse_json(slice, "parameter " + name);
      if (!value.is_number() && !value.is_boolean())
        fail("wrong-type", "The value of parameter " + name + " is null; leave it out instead.");
      return std::string(slice);
    }
  }
}

bool is_json_parameter(const Operation& operation, std::string_view name) {
  return std::any_of(operation.parameters.begin(), operation.parameters.end(),
                     [&](const Parameter& p) { return p.name == name && p.type == Parameter::Type::json; });
}

/// The value itself, or that of a qualified value: {"value": {…}} or {"value": […]}, with or without a format.
std::string_view json_parameter(std::string_view slice) {
  if (json_kind(slice) != '{') return slice;
  for (const auto& [key, value] : json_members(slice))
    if (key == "value" && (json_kind(value) == '{' || json_kind(value) == '[')) return value;
  return slice;
}

void read_inputs(const Operation& operation, std::string_view slice, Request& request) {
  if (json_kind(slice) != '{') fail("wrong-type", "The member inputs must be an object.");
  for (const auto& [name, value] : json_members(slice)) {
    if (is_json_parameter(operation, name)) {
      request.parameters.emplace_back(name, json_parameter(value));
    } else if (!slot_named(operation, name)) {
      add_parameter(request, name, parameter_text(name, value));
    } else if (operation.run_plain) {
      request.inputs.push_back(file_from_value(name, value));
    } else if (json_kind(value) == '[') {
      for (const std::string_view element : json_elements(value))
        request.inputs.push_back(input_from_value(name, element));
    } else {
      request.inputs.push_back(input_from_value(name, value));
    }
  }
}

std::string media_type_of_format(std::string_view slice, const std::string& name) {
  if (json_kind(slice) == '{')
    for (const auto& [key, value] : json_members(slice))
      if (key == "mediaType") return json_string(value, "output " + name + ", mediaType");
  fail("wrong-type", "The format of output " + name + " must be an object with a mediaType.");
}

bool is_reference(std::string_view slice, const std::string& name) {
  const nlohmann::json mode = parse_json(slice, "output " + name);
  if (mode != "value" && mode != "reference")
    fail("wrong-type", "The transmissionMode of output " + name + " must be value or reference.");
  return mode == "reference";
}

/// An operation has outputs of its own; its certificate may be asked for too.
void read_outputs(const Operation& operation, std::string_view slice, Ask& ask) {
  if (json_kind(slice) != '{') fail("wrong-type", "The member outputs must be an object.");
  const nlohmann::json described = process_description(operation)["outputs"];
  for (const auto& [name, value] : json_members(slice)) {
    if (!described.contains(name) && name != "certificate") {
      std::string names;
      for (const auto& item : described.items()) names += (names.empty() ? "" : ", ") + item.key();
      fail("unknown-output", "There is no output " + name + "; there are " + names + ".");
    }
    if (json_kind(value) != '{') fail("wrong-type", "The output " + name + " must be an object.");
    OutputAsk output{name, false};
    for (const auto& [key, member] : json_members(value)) {
      if (key == "transmissionMode") {
        output.by_reference = is_reference(member, name);
      } else if (key == "format") {
        std::string media_type = media_type_of_format(member, name);
        if (name != "certificate") ask.request.accept = {std::move(media_type)};
      } else {
        fail("unknown-member",
             "The output " + name + " has an unknown member " + key + "; there are format, transmissionMode.");
      }
    }
    ask.outputs.push_back(output);
  }
}

/// The URIs are checked when something is sent there.
nlohmann::json read_subscriber(std::string_view slice) {
  if (json_kind(slice) != '{') fail("wrong-type", "The member subscriber must be an object.");
  nlohmann::json subscriber = nlohmann::json::object();
  for (const auto& [name, uri] : json_members(slice)) {
    if (name != "successUri" && name != "inProgressUri" && name != "failedUri")
      fail("unknown-member",
           "The subscriber has an unknown member " + name + "; there are successUri, inProgressUri, failedUri.");
    subscriber[name] = json_string(uri, "subscriber, " + name);
  }
  return subscriber;
}

}  // namespace

Ask ask_from_form(const Operation& operation, std::vector<FormPart> parts) {
  Ask ask;
  for (FormPart& part : parts) {
    // A browser sends a file field in which nothing was chosen as an empty part with an empty name.
    if (part.has_file_name && part.file_name.empty() && part.content.empty()) continue;
    const bool is_input =
        slot_named(operation, part.name) || (part.has_file_name && !has_parameter(operation, part.name));
    if (is_input) {
      std::string name = part.file_name.empty() ? part.name : std::move(part.file_name);
      // Text fields are text/plain to many clients, which says nothing of what the text is.
      if (!part.has_file_name && part.media_type.starts_with("text/plain")) part.media_type.clear();
      ask.request.inputs.push_back({part.name, std::move(name), std::move(part.media_type), std::move(part.content)});
    } else {
      add_parameter(ask.request, std::move(part.name), std::move(part.content));
    }
  }
  return ask;
}

Ask ask_from_json(const Operation& operation, std::string_view body) {
  Ask ask;
  for (const auto& [name, value] : json_members(body)) {
    if (name == "inputs") {
      read_inputs(operation, value, ask.request);
    } else if (name == "outputs") {
      read_outputs(operation, value, ask);
    } else if (name == "response") {
      const std::string response = json_string(value, "response");
      if (response != "raw" && response != "document")
        fail("wrong-type", "The member response must be raw or document.");
      ask.as_document = response == "document";
    } else if (name == "subscriber") {
      ask.subscriber = read_subscriber(value);
    } else {
      fail("unknown-member",
           "The execute request has an unknown member " + name + "; there are inputs, outputs, response, subscriber.");
    }
  }
  return ask;
}

}  // namespace terrane
