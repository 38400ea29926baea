// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/json_value.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace terrane {
namespace {

using Json = nlohmann::json;

constexpr int max_depth = 64;

std::string shown(const Json& value) {
  const std::string text = json_text(value);
  return text.size() <= 80 ? text : text.substr(0, 77) + "...";
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return value.type_name() == type;
}

/// What is wrong with the value, or nothing.
std::string fault(const Json& value, const Json& schema, const std::string& what);

std::string fault_of_number(const Json& value, const Json& schema, const std::string& what) {
  for (const auto& [word, wrong] : {std::pair{"minimum", "below"}, std::pair{"maximum", "above"}}) {
    const auto bound = schema.find(word);
    if (bound == schema.end()) continue;
    if (word[1] == 'i' ? value < *bound : value > *bound)
      return what + " is " + shown(value) + ", " + wrong + " " + bound->dump();
  }
  return "";
}

std::string fault_of_object(const Json& value, const Json& schema, const std::string& what) {
  for (const Json& name : schema.value("required", Json::array()))
    if (!value.contains(name.get_ref<const std::string&>()))
      return what + " needs the member " + name.get<std::string>();
  const Json properties = schema.value("properties", Json::object());
  for (const auto& [name, inner] : properties.items())
    if (const auto member = value.find(name); member != value.end())
      if (std::string wrong = fault(*member, inner, what + ", " + name); !wrong.empty()) return wrong;
  return "";
}

std::string fault_of_array(const Json& value, const Json& schema, const std::string& what) {
  if (value.size() < schema.value("minItems", std::size_t{0}) || value.size() > schema.value("maxItems", value.size()))
    return what + " has " + std::to_string(value.size()) + " elements";
  if (const auto items = schema.find("items"); items != schema.end())
    for (const Json& element : value)
      if (std::string wrong = fault(element, *items, "an element of " + what); !wrong.empty()) return wrong;
  return "";
}

std::string fault(const Json& value, const Json& schema, const std::string& what) {
  if (const auto type = schema.find("type"); type != schema.end() && !has_type(value, *type))
    return what + " is " + shown(value) + ", which is no " + type->get<std::string>();
  if (const auto words = schema.find("enum"); words != schema.end())
    if (std::find(words->begin(), words->end(), value) == words->end())
      return what + " is " + shown(value) + "; it takes one of " + words->dump();
  if (const auto kinds = schema.find("oneOf"); kinds != schema.end()) {
    std::string wrong;
    for (const Json& kind : *kinds)
      if ((wrong = fault(value, kind, what)).empty()) break;
    if (!wrong.empty()) return wrong;
  }
  if (value.is_number()) return fault_of_number(value, schema, what);
  if (value.is_object()) return fault_of_object(value, schema, what);
  if (value.is_array()) return fault_of_array(value, schema, what);
  return "";
}

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorKind::usage, "bad-parameter", message); }

}  // namespace

nlohmann::json parse_json_value(std::string_view text, const nlohmann::json& schema, const std::string& what) {
  // Deeper trees would overflow the stack where they are copied.
  const auto depth = [&](int level, Json::parse_event_t, Json&) {
    if (level > max_depth) refuse(what + " has brackets nested deeper than " + std::to_string(max_depth));
    return true;
  };
  const Json value = Json::parse(text, depth, false);
  if (value.is_discarded()) refuse(what + " is '" + std::string(text.substr(0, 80)) + "', which is no JSON");
  if (const std::string wrong = fault(value, schema, what); !wrong.empty()) refuse(wrong);
  return value;
}

std::string json_text(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string utf8_text(const std::string& text) { return Json::parse(json_text(text)).get<std::string>(); }

}  // namespace terrane
