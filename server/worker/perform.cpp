// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/worker/perform.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "ops/base64.hpp"
#include "ops/json_value.hpp"
#include "ops/operation.hpp"
#include "ops/request.hpp"
#include "ops/sha256.hpp"
#include "server/data_folder.hpp"
#include "server/http/open_file.hpp"
#include "server/requests/execute_request.hpp"
#include "server/requests/multipart.hpp"

namespace terrane {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t max_field = std::size_t{1} << 20;  // one parameter in a form
constexpr std::size_t block = std::size_t{1} << 20;
constexpr std::string_view json_type = "application/json";

struct Asked {
  Order order;
  Ask ask;
  Plan plan;
  bool has_references() const {
    return std::any_of(ask.outputs.begin(), ask.outputs.end(), [](const OutputAsk& o) { return o.by_reference; });
  }
};

Ask ask_from_body(const Operation& operation, const Order& order, const fs::path& body) {
  const OpenFile file(body);
  if (file.size() == 0) return {};
  if (media_type(order.content_type) != "multipart/form-data") return ask_from_json(operation, file.text());
  MultipartParser form(multipart_boundary(order.content_type), [&](const FormPart& part) {
    const auto& slots = operation.inputs;
    const bool is_input = std::any_of(slots.begin(), slots.end(), [&](const auto& s) { return s.name == part.name; });
    return is_input || part.has_file_name ? static_cast<std::size_t>(file.size()) : max_field;
  });
  std::string piece(block, '\0');
  for (std::uint64_t at = 0; at < file.size(); at += piece.size()) {
    piece.resize(file.read(at, piece.data(), block));
    if (piece.empty()) break;
    form.feed(piece);
  }
  return ask_from_form(operation, form.finish());
}

/// Query parameters join those of the body; `f` of the query is the last word on the format.
void add_query(const Order& order, Request& request) {
  const std::string* format = nullptr;
  for (const auto& [name, text] : order.query) {
    if (name != "f" && name != "format") {
      request.parameters.emplace_back(name, text);
    } else if (format && *format != text) {
      throw HttpError(400, "repeated-parameter", "f and format differ, or are given twice; give one of them.");
    } else {
      format = &text;
    }
  }
  if (format) request.format = *format;
}

void fetch_references(Request& request, const fs::path& folder, const Resolve& resolve) {
  for (InputPart& part : request.inputs) {
    if (part.href.empty()) continue;
    const nlohmann::json found = resolve(part.href);
    part.bytes = OpenFile(folder / found.at("file").get<std::string>()).text();
    if (part.name.empty() || part.name == part.slot) part.name = found.at("name").get<std::string>();
    if (part.media_type.empty()) part.media_type = found.at("media_type").get<std::string>();
  }
}

Asked asked(const fs::path& folder, const Resolve& resolve) {
  Asked result;
  result.order = order_from(nlohmann::json::parse(OpenFile(folder / "call.json").text()));
  const Operation& operation = find_operation(result.order.operation);
  Ask& ask = result.ask;
  ask = ask_from_body(operation, result.order, folder / "body");
  ask.request.operation = operation.id;
  const bool names_media_type = !ask.request.accept.empty();
  add_query(result.order, ask.request);
  const auto accepted = accepted_media_types(result.order.accept);
  // A document is JSON whatever its result is; then Accept is about the document.
  if (ask.as_document && !is_accepted(accepted, json_type))
    throw HttpError(406, "not-acceptable", "A results document is application/json.");
  if (!ask.as_document && !names_media_type && ask.outputs.size() <= 1) ask.request.accept = accepted;
  fetch_references(ask.request, folder, resolve);
  for (const InputPart& part : ask.request.inputs) require_media_type(part.media_type);
  result.plan = plan(std::move(ask.request));
  return result;
}

std::string report_text(const nlohmann::json& report) { return json_text(report, 2) + "\n"; }

bool is_json(std::string_view media_type) {
  const std::string_view plain = media_type.substr(0, media_type.find(';'));
  return plain == json_type || plain.ends_with("+json");
}

/// Counts and names bytes on their way to a file.
class OutputFile {
 public:
  OutputFile(const fs::path& out, std::string name) : name_(std::move(name)), file_(out / name_) {}
  void write(std::string_view piece) {
    hash_.add(piece);
    size_ += piece.size();
    file_.write(piece);
  }
  nlohmann::json keep(const std::string& media_type, const std::string& file_name) {
    file_.keep();
    return {{"file", name_},
            {"media_type", media_type},
            {"file_name", file_name},
            {"size", size_},
            {"sha256", hash_.finish()}};
  }

 private:
  std::string name_;
  NewFile file_;
  Sha256 hash_;
  std::uint64_t size_ = 0;
};

/// The answer put together from the outputs that lie in `out`.
class Answer {
 public:
  Answer(const Asked& asked, const fs::path& out, const nlohmann::json& outputs)
      : asked_(asked), out_(out), outputs_(outputs) {}

  nlohmann::json reply() {
    const std::vector<OutputAsk> wanted = wanted_outputs();
    if (asked_.ask.as_document) return document(wanted);
    const bool all_references =
        std::all_of(wanted.begin(), wanted.end(), [](const OutputAsk& o) { return o.by_reference; });
    if (all_references) return links(wanted);
    if (wanted.size() == 1) return itself(wanted[0].id);
    return multipart(wanted);
  }

 private:
  /// Those asked for, else all there are. The certificate comes with every document, and else when it is asked for.
  std::vector<OutputAsk> wanted_outputs() const {
    std::vector<OutputAsk> wanted = asked_.ask.outputs;
    const auto add = [&](const std::string& id) {
      if (std::none_of(wanted.begin(), wanted.end(), [&](const OutputAsk& o) { return o.id == id; }))
        wanted.push_back({id, false});
    };
    if (wanted.empty())
      for (const auto& item : outputs_.items())
        if (item.key() != "certificate") add(item.key());
    if (asked_.ask.as_document && outputs_.contains("certificate")) add("certificate");
    // Of several outputs some may have no value, which is no fault as long as any is there.
    std::erase_if(wanted, [&](const OutputAsk& o) { return !outputs_.contains(o.id); });
    if (wanted.empty() && !asked_.ask.outputs.empty())
      throw Error(ErrorKind::usage, "no-output",
                  "With these inputs none of the outputs that are asked for has a value.");
    return wanted;
  }

  std::string href(const std::string& id) const {
    return asked_.order.base + "/jobs/" + asked_.order.id + "/results/" + id;
  }

  nlohmann::json itself(const std::string& id) const {
    const nlohmann::json& output = outputs_.at(id);
    return {{"status", 200},
            {"media_type", output["media_type"]},
            {"headers", TextPairs{{"Content-Disposition", disposition(output)}}},
            {"file", output["file"]},
            {"sha256", output["sha256"]}};
  }

  static std::string disposition(const nlohmann::json& output) {
    return "attachment; filename=\"" + header_text(output["file_name"].get<std::string>()) + "\"";
  }

  nlohmann::json links(const std::vector<OutputAsk>& wanted) const {
    TextPairs headers;
    for (const OutputAsk& output : wanted)
      headers.emplace_back("Link", "<" + href(output.id) + ">; rel=\"" + header_text(output.id) + "\"; type=\"" +
                                       header_text(outputs_.at(output.id)["media_type"].get<std::string>()) + "\"");
    return {{"status", 204}, {"media_type", ""}, {"headers", headers}, {"file", ""}};
  }

  void append(OutputFile& to, const std::string& id) const {
    const OpenFile from(out_ / outputs_.at(id)["file"].get<std::string>());
    std::string piece(block, '\0');
    for (std::uint64_t at = 0; at < from.size(); at += piece.size()) {
      piece.resize(block);
      piece.resize(from.read(at, piece.data(), block));
      if (piece.empty()) break;
      to.write(piece);
    }
  }

  nlohmann::json multipart(const std::vector<OutputAsk>& wanted) const {
    const std::string boundary = "part-" + random_id();
    OutputFile file(out_, "multipart");
    for (const OutputAsk& asked : wanted) {
      const nlohmann::json& output = outputs_.at(asked.id);
      file.write("--" + boundary + "\r\nContent-ID: <" + asked.id +
                 ">\r\nContent-Type: " + output["media_type"].get<std::string>() + "\r\n");
      if (asked.by_reference) {
        file.write("Content-Location: " + href(asked.id) + "\r\n\r\n");
      } else {
        file.write("Content-Disposition: " + disposition(output) + "\r\n\r\n");
        append(file, asked.id);
      }
      file.write("\r\n");
    }
    file.write("--" + boundary + "--\r\n");
    return together(file, "multipart/related; boundary=" + boundary);
  }

  /// The values are spliced in as text: a large surface is not parsed again.
  nlohmann::json document(const std::vector<OutputAsk>& wanted) const {
    OutputFile file(out_, "document");
    const char* between = "{";
    for (const OutputAsk& asked : wanted) {
      const nlohmann::json& output = outputs_.at(asked.id);
      file.write(between + nlohmann::json(asked.id).dump() + ":");
      if (asked.by_reference)
        file.write(nlohmann::json{{"href", href(asked.id)}, {"type", output["media_type"]}}.dump());
      else
        value(file, asked.id, output["media_type"].get<std::string>());
      between = ",";
    }
    file.write("}\n");
    return together(file, std::string(json_type));
  }

  static nlohmann::json together(OutputFile& file, const std::string& media_type) {
    nlohmann::json reply = file.keep(media_type, "");
    reply["status"] = 200;
    reply["headers"] = TextPairs{};
    return reply;
  }

  void value(OutputFile& file, const std::string& id, const std::string& media_type) const {
    const std::string type = nlohmann::json(media_type).dump();
    if (is_json(media_type)) {
      file.write("{\"mediaType\":" + type + ",\"value\":");
      append(file, id);
      return file.write("}");
    }
    const std::string bytes = OpenFile(out_ / outputs_.at(id)["file"].get<std::string>()).text();
    // What is not UTF-8 cannot stand in a JSON string; nlohmann checks it while escaping.
    if (bytes.find('\0') == std::string::npos) {
      try {
        return file.write("{\"mediaType\":" + type + ",\"value\":" + nlohmann::json(bytes).dump() + "}");
      } catch (const nlohmann::json::exception&) {
      }
    }
    file.write("{\"mediaType\":" + type + ",\"encoding\":\"base64\",\"value\":\"" + encode_base64(bytes) + "\"}");
  }

  const Asked& asked_;
  const fs::path& out_;
  const nlohmann::json& outputs_;
};

}  // namespace

nlohmann::json to_json(const Order& order) {
  return {{"id", order.id},          {"operation", order.operation},
          {"base", order.base},      {"content_type", order.content_type},
          {"accept", order.accept},  {"query", order.query},
          {"threads", order.threads}};
}

Order order_from(const nlohmann::json& text) {
  return {text.at("id"),     text.at("operation"), text.at("base"),   text.at("content_type"),
          text.at("accept"), text.at("query"),     text.at("threads")};
}

nlohmann::json check_order(const fs::path& folder, const Resolve& resolve) {
  const Asked result = asked(folder, resolve);
  return {{"subscriber", result.ask.subscriber}};
}

nlohmann::json perform(const fs::path& folder, Context& context, const Resolve& resolve) {
  const Asked what = asked(folder, resolve);
  context.threads = what.order.threads;
  const Operation& operation = find_operation(what.order.operation);
  const fs::path out = folder / "out";
  nlohmann::json outputs = nlohmann::json::object();

  Response response;
  if (operation.outputs.empty()) {
    const std::string id = process_description(operation)["outputs"].begin().key();
    OutputFile result(out, id);
    const auto take = [&](std::string_view piece) { result.write(piece); };
    response = execute(what.plan, context, {take, true});
    if (!response.body.empty()) result.write(response.body);
    outputs[id] = result.keep(response.media_type, response.file_name);
  } else {
    response = execute(what.plan, context);
    for (const ResultPart& part : response.parts) {
      OutputFile result(out, part.id);
      result.write(part.body);
      outputs[part.id] = result.keep(part.media_type, part.file_name);
    }
  }
  if (!response.report.is_null()) {
    // A report already holds its certificate.
    const bool holds = response.report.contains("certificate");
    OutputFile certificate(out, "certificate");
    certificate.write(report_text(holds ? response.report["certificate"] : response.report));
    outputs["certificate"] = certificate.keep(std::string(json_type), "certificate.json");
  }
  nlohmann::json outcome = {
      {"outputs", outputs}, {"warnings", response.warnings.size()}, {"references", what.has_references()}};
  outcome["reply"] = Answer(what, out, outputs).reply();
  write_file(out / "outcome.json", json_text(outcome));
  return outcome;
}

}  // namespace terrane
