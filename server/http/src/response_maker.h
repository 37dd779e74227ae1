#pragma once

#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "connection.h"
#include "supple/http/server.h"

namespace supple::http {

/// Makes the responses of a server: those of handlers, and those that tell a problem. Any thread may call.
class ResponseMaker {
 public:
  /// `headers` are added to every response that does not set them itself.
  ResponseMaker(Server::Render render, Server::Report report, std::vector<std::pair<std::string, std::string>> headers)
      : render_(std::move(render)), report_(std::move(report)), headers_(std::move(headers)) {}

  /// The handler's response or, if the request is refused or the handler throws, one that describes the problem.
  Response answer(Connection& connection) const;
  /// The response that describes an exception. An exception that becomes "server.internal" is also reported.
  Response of_exception(const std::exception_ptr& exception, const Request& request) const;
  Response of_problem(const problem::Problem& problem, const Request& request) const;
  /// Reports the text of an exception, which the client does not get, with the request's method and path.
  void report(const std::exception_ptr& exception, const Request& request) const;

 private:
  void add_headers(Response& response, const Request& request) const;

  const Server::Render render_;
  const Server::Report report_;
  const std::vector<std::pair<std::string, std::string>> headers_;
};

}  // namespace supple::http
