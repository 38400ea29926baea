// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <string>

#include "server/admission.hpp"
#include "server/execute_request.hpp"
#include "server/message.hpp"
#include "server/report_store.hpp"

// The resources of the service, without sockets: a Call in, a Reply out. Safe to use from several threads.
namespace terrane {

struct ServiceLimits {
  std::size_t max_body =
      std::size_t{1} << 30;  // decoded bytes of one body; all bodies together may hold four times that
  std::size_t max_field = std::size_t{1} << 20;  // one parameter in a form
  std::size_t max_reports = std::size_t{64} << 20;
  int slots = 1, line = 4;  // executions at work, and waiting
};

class Service {
 public:
  explicit Service(const ServiceLimits& limits);

  /// The answer to everything that is decided before a body is read: resources, wrong paths and methods, a body that is
  /// refused by its header. Nothing for an execution that may go on: then `execute` answers it.
  std::optional<Reply> answer_header(const Call& call);

  /// Reads the body, works, answers. `client_is_gone` is asked now and then; when true the work is given up.
  Reply execute(const Call& call, const BodySource& body, const std::function<bool()>& client_is_gone);

  /// New executions are refused, /ready says no.
  void close() { admission_.close(); }
  /// Executions at work are asked to stop.
  void cancel() { admission_.cancel(); }

 private:
  Reply resource(const Call& call, const std::string& path);
  void check_body_header(const Call& call) const;
  Ask read_ask(const Operation& operation, const Call& call, const BodySource& body, Admission::Bytes& held) const;
  Reply reply_of(const Operation& operation, const Ask& ask, Response&& response);

  const ServiceLimits limits_;
  Admission admission_;
  ReportStore reports_;
};

/// The operation in /processes/{id}/execution, or nothing when the path is another.
std::optional<std::string> execution_path(std::string_view path);

/// "http://host" as the client addressed us, so that links work from where it stands; empty when the host is odd.
std::string base_url(const Call& call);

/// GET / for machines and for people.
Reply landing_page(const Call& call);
Reply landing_html(const Call& call);

}  // namespace terrane
