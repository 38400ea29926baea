// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/run_operation.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "cli/files.hpp"
#include "cli/progress.hpp"
#include "core/error.hpp"
#include "ops/json_value.hpp"
#include "ops/parameters.hpp"
#include "ops/request.hpp"

namespace terrane {
namespace {

/// Inputs that a flag names, as --like does; they leave the parameters.
std::vector<InputPart> take_named_inputs(const Operation& operation,
                                         std::vector<std::pair<std::string, std::string>>& parameters) {
  std::vector<InputPart> parts;
  std::erase_if(parameters, [&](const std::pair<std::string, std::string>& given) {
    const bool named = std::any_of(operation.inputs.begin(), operation.inputs.end(),
                                   [&](const InputSlot& slot) { return slot.name == given.first; });
    if (named) parts.push_back({given.first, given.second, "", ""});
    return named;
  });
  return parts;
}

/// Which input of the operation each word is, those apart that a flag names. Surplus words are an error; missing ones
/// are the plan's to complain about.
std::vector<InputPart> assign_inputs(const Operation& operation, const std::vector<std::string>& words,
                                     const std::vector<InputPart>& named) {
  std::vector<InputPart> parts;
  const auto used_up = [&](const InputSlot& slot) {
    const auto of_slot = [&](const InputPart& part) { return part.slot == slot.name; };
    return slot.max_occurs > 0 &&
           std::count_if(named.begin(), named.end(), of_slot) + std::count_if(parts.begin(), parts.end(), of_slot) >=
               slot.max_occurs;
  };
  auto slot = operation.inputs.begin();
  for (const std::string& word : words) {
    while (slot != operation.inputs.end() && used_up(*slot)) ++slot;
    if (slot == operation.inputs.end())
      throw Error(ErrorKind::usage, "surplus-input",
                  "'" + operation.id + "' takes no input" +
                      (parts.empty() ? "" : " after '" + parts.back().name + "'") + ", but '" + word + "' follows");
    parts.push_back({slot->name, word, "", ""});
  }
  parts.insert(parts.end(), named.begin(), named.end());
  return parts;
}

/// Fills in the bytes; a number stands for itself where a level is taken and no file has that name.
void read_inputs(const Operation& operation, std::vector<InputPart>& parts) {
  bool stream_taken = false;
  for (InputPart& part : parts) {
    const std::string path = part.name;
    const auto slot = std::find_if(operation.inputs.begin(), operation.inputs.end(),
                                   [&](const InputSlot& s) { return s.name == part.slot; });
    const bool stands_for_itself = (slot->takes_number && Length::read(path)) || (!path.empty() && path == slot->word);
    if (stands_for_itself && ::access(path.c_str(), F_OK) != 0) {
      part.bytes = path;
      part.name.clear();
      continue;
    }
    if (path == "-" && std::exchange(stream_taken, true))
      throw Error(ErrorKind::usage, "surplus-input", "standard input ('-') can be one input only");
    read_file(path, part);
    part.name = path == "-" ? "" : file_name(path);
  }
}

/// A parameter that takes vectors may name a file.
void read_vector_files(const Operation& operation, Request& request) {
  for (auto& [name, value] : request.parameters) {
    const auto parameter = std::find_if(operation.parameters.begin(), operation.parameters.end(),
                                        [&name = name](const Parameter& p) { return p.name == name; });
    if (parameter == operation.parameters.end() || parameter->type != Parameter::Type::vectors) continue;
    if (vector_format(value) && ::access(value.c_str(), F_OK) != 0) continue;
    value = read_whole_file(value);
  }
}

void print_warnings(const std::vector<Warning>& warnings) {
  for (const Warning& w : warnings) {
    const auto said = [&](const std::string& what) { return w.message.find(what) != std::string::npos; };
    std::fprintf(stderr, "warning: %s%s%s%s%s\n", said(w.input) ? "" : (w.input + ": ").c_str(), w.message.c_str(),
                 said(w.element) ? "" : (" (" + w.element + ")").c_str(), w.remedy.empty() ? "" : "; ",
                 w.remedy.c_str());
  }
}

/// Has the big arrays of one stage lie where those of the stage before did, whichever thread asks for them: the first
/// touch of memory costs as much as most of what is computed there, and this process gives all of it back soon.
void reuse_memory() {
  ::mallopt(M_MMAP_MAX, 0);
  ::mallopt(M_TRIM_THRESHOLD, -1);
  ::mallopt(M_ARENA_MAX, 1);
}

}  // namespace

void run_operation(const Operation& operation, const CommandLine& line) {
  reuse_memory();
  Request request;
  request.operation = operation.id;
  request.parameters = line.parameters;
  request.format = line.format;
  if (line.output != "-") request.output_name = line.output.empty() ? "" : file_name(line.output);
  request.inputs = assign_inputs(operation, line.inputs, take_named_inputs(operation, request.parameters));
  refuse_existing(line.output, line.force);
  refuse_existing(line.report, line.force);
  read_inputs(operation, request.inputs);
  read_vector_files(operation, request);
  const Plan made = plan(std::move(request));
  const ResultKind kind = operation.kind(made.parameters);
  const bool prints = kind == ResultKind::report || kind == ResultKind::table;
  if (line.output.empty() && !prints)
    throw Error(ErrorKind::usage, "missing-output", "'" + operation.id + "' needs -o OUTPUT (- for standard output)");
  const std::string output = line.output.empty() ? "-" : line.output;
  if (!line.report.empty() && is_same_place(output, line.report))
    throw Error(ErrorKind::usage, "same-output",
                "the result and the certificate would both go to '" + output + "'; give --report another name");

  ProgressLine progress(line.quiet);
  Context context;
  context.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  context.on_progress = [&](std::string_view stage, double fraction) { progress.show(stage, fraction); };
  OutputFile file(output, line.force);
  const auto take = [&](std::string_view piece) {
    progress.clear();
    file.write(piece);
  };
  const Response response = execute(made, context, {take, file.holds_back()});
  progress.clear();
  if (!line.quiet) print_warnings(response.warnings);
  ::malloc_trim(0);  // has to be given back anyway; now the disk is at work meanwhile
  file.keep();
  if (line.report.empty()) return;
  OutputFile report(line.report, line.force);
  report.write(json_text(response.report, 2) + "\n");
  report.keep();
}

}  // namespace terrane
