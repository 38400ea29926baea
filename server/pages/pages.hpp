// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message.hpp"

// The pages that describe the service, for programs and for people.
namespace terrane {

/// How a resource is wanted: by `f`, else by Accept. JSON where both would do, unless text/html is named first, as
/// browsers do.
enum class Shape { json, html };
/// `others` are query parameters that the resource knows beside `f`; `media_type` is the name of its JSON. Throws
/// HttpError 400 and 406.
Shape shape_wanted(const Call& call, std::vector<std::string_view> others = {},
                   std::string_view media_type = "application/json");

/// Throws HttpError 400 for a query parameter that is not known, and says which are, and `instead`.
void require_known_parameters(const Call& call, const std::vector<std::string_view>& known,
                              const std::string& instead = "");

/// A value in its shape; `page` makes the body of the page.
Reply shaped(Shape shape, const std::string& title, const nlohmann::json& value,
             std::string (*page)(const nlohmann::json&));

nlohmann::json link(const std::string& href, const std::string& rel, const std::string& type, const std::string& title);
/// The address of a call again, with other values of some parameters; an empty value leaves one out.
std::string address_with(const Call& call, const TextPairs& changed);
/// The links to a resource itself and to its other shape.
nlohmann::json shape_links(const Call& call, Shape shape);

/// The landing page, /conformance, /processes, /processes/{id}, /openapi.json, /api and /docs; nothing for other paths.
std::optional<Reply> describe_service(const Call& call);

}  // namespace terrane
