// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "ops/operation.hpp"

// What openapi() is put together from.
namespace terrane::openapi_parts {

/// {"$ref": …} to a schema of the components.
nlohmann::json schema(const std::string& name);
nlohmann::json array_of(const nlohmann::json& items);

/// The responses of an operation: those given, beside the refusals that any operation can answer with and the further
/// ones named by their status.
nlohmann::json responses(nlohmann::json given, std::initializer_list<int> refusals = {});
nlohmann::json query_parameter(const std::string& name, const nlohmann::json& schema, const std::string& description);
/// The same of a GET, which may be about a part, or about what the client has already.
nlohmann::json found(const nlohmann::json& ok, std::initializer_list<int> refusals = {});

/// A response that is JSON of a schema, and a page for people.
nlohmann::json page_response(const std::string& description, const nlohmann::json& schema);

nlohmann::json execution_path(const Operation& operation);
/// /jobs and everything below, and /uploads.
nlohmann::json job_paths();
nlohmann::json schemas();
/// What is sent to a subscriber.
nlohmann::json callbacks();

}  // namespace terrane::openapi_parts
