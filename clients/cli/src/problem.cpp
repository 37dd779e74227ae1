#include "problem.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

namespace supple::cli {
namespace {

constexpr std::size_t longest_quote = 200;

std::string member_text(const nlohmann::json& object, const char* key) {
  const auto entry = object.find(key);
  return entry != object.end() && entry->is_string() ? entry->get<std::string>() : std::string();
}

}  // namespace

Failure problem_failure(int status, const std::string& body) {
  const ExitCode exit_code = status >= 500 ? ExitCode::server_error : ExitCode::rejected;
  const auto problem = nlohmann::json::parse(body, nullptr, /*allow_exceptions=*/false);
  if (!problem.is_object()) {
    return {exit_code, fmt::format("the server answered with status {}: {}", status, body.substr(0, longest_quote))};
  }
  std::string message = member_text(problem, "detail");
  if (message.empty()) message = member_text(problem, "title");
  message += fmt::format(" [{}, HTTP {}]", member_text(problem, "code"), status);
  const auto errors = problem.find("errors");
  if (errors != problem.end() && errors->is_array()) {
    for (const auto& entry : *errors) {
      if (!entry.is_object()) continue;
      fmt::format_to(std::back_inserter(message), "\n  {}: {}", member_text(entry, "pointer"),
                     member_text(entry, "detail"));
    }
  }
  if (const std::string hint = member_text(problem, "hint"); !hint.empty()) message += "\n" + hint;
  return {exit_code, message};
}

}  // namespace supple::cli
