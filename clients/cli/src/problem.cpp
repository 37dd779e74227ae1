#include "problem.h"

#include <fmt/format.h>

namespace supple::cli {
namespace {

constexpr std::size_t longest_quote = 200;

}  // namespace

std::string member_text(const nlohmann::json& object, const char* key) {
  const auto entry = object.find(key);
  return entry != object.end() && entry->is_string() ? entry->get<std::string>() : std::string();
}

void throw_problem(int status, const std::string& body) {
  const ExitCode exit_code = status >= 500 ? ExitCode::server_error : ExitCode::rejected;
  auto problem = nlohmann::json::parse(body, nullptr, /*allow_exceptions=*/false);
  if (!problem.is_object()) {
    throw Failure(exit_code,
                  fmt::format("the server answered with status {}: {}", status, body.substr(0, longest_quote)));
  }
  std::string message = member_text(problem, "detail");
  if (message.empty()) message = member_text(problem, "title");
  throw Problem(exit_code, status, message, std::move(problem));
}

}  // namespace supple::cli
