// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/http/message.hpp"

// Pages for people: what the JSON says, without any script.
namespace terrane {

std::string escaped(std::string_view text);
std::string anchor(const std::string& href, const std::string& text);

/// Any value: objects as tables, arrays as lists, members `href` and texts that are addresses as links.
std::string value_html(const nlohmann::json& value);
/// Links of the standard, as a list of anchors.
std::string links_html(const nlohmann::json& links);

/// A whole page. Nothing but its own style is allowed on it.
Reply html_reply(const std::string& title, const std::string& body);

// The pages of what is JSON otherwise.
std::string conformance_html(const nlohmann::json& classes);
std::string process_list_html(const nlohmann::json& list);
/// `example` is a command that runs it.
std::string process_html(const nlohmann::json& description, const std::string& example);
std::string job_list_html(const nlohmann::json& job_list);
std::string job_html(const nlohmann::json& status_info);
/// The whole interface, from its OpenAPI document.
std::string docs_html(const nlohmann::json& openapi);

}  // namespace terrane
