#include "response_maker.h"

#include <algorithm>

#include "supple/budget/memory.h"

namespace supple::http {
Response ResponseMaker::answer(Connection& connection) const {
  Response response;
  try {
    if (connection.refusal()) std::rethrow_exception(connection.refusal());
    const budget::RequestMemory memory(connection.memory());
    response = connection.route->handler(connection.request);
  } catch (...) {
    return of_exception(std::current_exception(), connection.request);
  }
  add_headers(response, connection.request);
  return response;
}

Response ResponseMaker::of_exception(const std::exception_ptr& exception, const Request& request) const {
  if (problem::is_unexpected(exception)) report(exception, request);
  return of_problem(problem::problem_of(exception), request);
}

Response ResponseMaker::of_problem(const problem::Problem& problem, const Request& request) const {
  auto response = render_(problem);
  add_headers(response, request);
  return response;
}

void ResponseMaker::report(const std::exception_ptr& exception, const Request& request) const {
  std::string text = "an exception of unknown type";
  try {
    std::rethrow_exception(exception);
  } catch (const std::exception& error) {
    text = error.what();
  } catch (...) {
  }
  report_(request.method + " " + request.path + ": " + text);
}

void ResponseMaker::add_headers(Response& response, const Request& request) const {
  for (const auto& [name, value] : headers_) {
    const bool is_set = std::any_of(response.headers.begin(), response.headers.end(),
                                    [&, name = &name](const auto& header) { return header.first == *name; });
    if (!is_set) response.set_header(name, value);
  }
  if (!request.id.empty()) response.set_header("Supple-Request-Id", request.id);
}

}  // namespace supple::http
