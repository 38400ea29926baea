// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/operation.hpp"

// From OpenAPI 3.1, whose schemas are JSON Schema, to 3.0, which has words of its own.
namespace terrane {
namespace {

using Json = nlohmann::json;

/// Below `properties`, `schemas` and the like the names are the document's own, not words of a schema.
bool holds_names(const std::string& key) {
  for (const char* word : {"properties", "schemas", "responses", "callbacks", "paths", "content", "headers",
                           "securitySchemes", "patternProperties"})
    if (key == word) return true;
  return false;
}

void to_30(Json& value, bool names) {
  if (value.is_array())
    for (Json& element : value) to_30(element, false);
  if (!value.is_object()) return;
  for (auto& [key, child] : value.items())
    if (names || (key != "example" && key != "default" && key != "enum")) to_30(child, !names && holds_names(key));
  if (names) return;
  // A reference stands alone.
  if (value.contains("$ref") && value.size() > 1) value = {{"allOf", {{{"$ref", value["$ref"]}}}}};
  if (const auto only = value.find("const"); only != value.end()) {
    value["enum"] = {*only};
    value.erase("const");
  }
  if (const auto encoding = value.find("contentEncoding"); encoding != value.end()) {
    value["format"] = *encoding == "base64" ? "byte" : "binary";
    value.erase("contentEncoding");
  }
  if (value.contains("contentMediaType")) {
    value["x-contentMediaType"] = value["contentMediaType"];
    value.erase("contentMediaType");
  }
  for (const auto& [bound, exclusive] :
       {std::pair{"minimum", "exclusiveMinimum"}, std::pair{"maximum", "exclusiveMaximum"}})
    if (const auto it = value.find(exclusive); it != value.end() && it->is_number()) {
      value[bound] = *it;
      value[exclusive] = true;
    }
}

}  // namespace

nlohmann::json openapi_30() {
  Json document = openapi();
  to_30(document, false);
  document["openapi"] = "3.0.3";
  // 3.0 knows licences by their address alone.
  Json& license = document["info"]["license"];
  license["url"] = "https://spdx.org/licenses/" + license["identifier"].get<std::string>() + ".html";
  license.erase("identifier");
  return document;
}

}  // namespace terrane
