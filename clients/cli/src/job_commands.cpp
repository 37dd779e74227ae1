#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "failure.h"
#include "style.h"

namespace supple::cli {
namespace {

void print_job(const nlohmann::json& job) {
  const auto state = job.at("state").get<std::string>();
  const bool failed = state == "failed";
  const auto shown = fmt::format("{:<10}", state);
  fmt::print("{}  {}  {:>3.0f} %  {:<16}  {}", job.at("id").get<std::string>(),
             failed                  ? styled(shown, Style::error)
             : state == "successful" ? styled(shown, Style::success)
                                     : shown,
             100 * job.at("progress").get<double>(), job.at("kind").get<std::string>(),
             job.at("created").get<std::string>());
  if (const auto error = job.find("error"); error != job.end())
    fmt::print("  {}", error->at("code").get<std::string>());
  fmt::print("\n");
}

void list_jobs(Session& session, const std::string& state) {
  auto entries = nlohmann::json::array();
  session.for_each_entry(state.empty() ? "/v1/jobs" : "/v1/jobs?state=" + state, "jobs",
                         [&](const nlohmann::json& job) { session.json() ? entries.push_back(job) : print_job(job); });
  if (session.json()) print_json(entries);
}

void show_job(Session& session, const std::string& job) {
  const nlohmann::json document = session.http().get("/v1/jobs/" + job).json();
  session.json() ? print_json(document) : print_job(document);
}

void cancel_job(Session& session, const std::string& job) {
  const std::string path = "/v1/jobs/" + job;
  const auto state = session.http().get(path).json().at("state").get<std::string>();
  if (state != "accepted" && state != "running") {
    throw Failure(ExitCode::rejected, fmt::format("job {} is {} already", job, state));
  }
  session.http().erase(path);
}

void print_result(const Answer& answer) {
  if (answer.content_type.starts_with("application/json")) return print_json(answer.json());
  write_file("-", answer.body);
}

}  // namespace

void add_job_commands(CLI::App& program, const GlobalOptions& options) {
  struct JobArguments {
    std::string job;
    std::string state;
  };
  const auto arguments = std::make_shared<JobArguments>();
  CLI::App* family = program.add_subcommand("job", "List, show, follow and cancel jobs, and fetch their results");
  family->require_subcommand(1);

  CLI::App* list = family->add_subcommand("list", "List the jobs, the newest first");
  list->add_option("--state", arguments->state, "Only jobs in this state")
      ->check(CLI::IsMember({"accepted", "running", "successful", "failed", "dismissed"}));
  list->callback([&options, arguments] {
    Session session(options);
    list_jobs(session, arguments->state);
  });

  const auto add = [&](const char* name, const char* description, void (*action)(Session&, const std::string&)) {
    CLI::App* command = family->add_subcommand(name, description);
    command->add_option("job", arguments->job, "Job id")->required();
    command->callback([&options, arguments, action] {
      Session session(options);
      action(session, arguments->job);
    });
  };
  add("show", "Show a job's state and progress", show_job);
  add("cancel", "Cancel a job that has not finished", cancel_job);
  add("remove", "Remove a finished job and its result",
      [](Session& session, const std::string& job) { session.http().erase("/v1/jobs/" + job); });
  add("result", "Print the result of a finished job", [](Session& session, const std::string& job) {
    print_result(session.http().get("/v1/jobs/" + job + "/result", "*/*"));
  });
  add("wait", "Wait for a job, then print its result; Ctrl-C leaves the job running",
      [](Session& session, const std::string& job) {
        print_result(session.follow("/v1/jobs/" + job, "*/*", /*cancel_on_interrupt=*/false));
      });
}

}  // namespace supple::cli
