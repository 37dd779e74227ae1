#include "response_maker.h"

#include <algorithm>
#include <optional>

#include "supple/budget/memory.h"
#include "supple/http/router.h"

namespace supple::http {
namespace {

/// The methods of the path where the exception says that the request has another one.
std::optional<std::string> allowed_methods(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const MethodNotAllowed& error) {
    return error.allowed();
  } catch (...) {
    return std::nullopt;
  }
}

}  // namespace

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
  auto response = render_(problem::problem_of(exception));
  if (const auto methods = allowed_methods(exception)) response.set_header("Allow", *methods);
  add_headers(response, request);
  return response;
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
