#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "support/temporary_folder.h"

namespace supple::testing {

/// A PostgreSQL server that only this process uses, and which ends with it. Since it takes a second to start, the tests
/// of a process share one, and each has its own database.
class PrivatePostgres {
 public:
  PrivatePostgres() : address_(start()) {}
  ~PrivatePostgres() { static_cast<void>(std::system(command("stop").c_str())); }
  PrivatePostgres(const PrivatePostgres&) = delete;
  PrivatePostgres& operator=(const PrivatePostgres&) = delete;

  /// Creates a database and returns its connection string.
  std::string new_database() {
    const auto name = "test" + std::to_string(++databases_);
    psql("CREATE DATABASE " + name);
    return "host=" + (folder_ / "postgres").string() + " user=supple dbname=" + name;
  }
  /// The output of psql for the rows of a statement, which must not contain single quotes.
  static std::string rows(const std::string& database, const std::string& statement) {
    return output_of("psql --no-align --tuples-only --dbname='" + database + "' --command='" + statement + "'");
  }
  void kill() { run("kill"); }
  void again() { run("again"); }
  void freeze() { run("freeze"); }
  void thaw() { run("thaw"); }

  static PrivatePostgres& of_this_process() {
    static PrivatePostgres server;
    return server;
  }

 private:
  std::string command(const std::string& action) const {
    return std::string(SUPPLE_SOURCE_DIR) + "/tests/support/private_postgres.sh " + action + " " +
           (folder_ / "postgres").string();
  }
  std::string run(const std::string& action) const { return output_of(command(action)); }
  std::string start() const {
    // The server has a user of its own, who has to reach its folder within this one.
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::others_exec,
                                 std::filesystem::perm_options::add);
    return run("start");
  }
  void psql(const std::string& statement) const {
    output_of("psql --quiet --dbname='" + address_ + "' --command='" + statement + "'");
  }
  static std::string output_of(const std::string& command) {
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    if (!pipe) throw std::runtime_error("cannot run " + command);
    std::string output;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
      if (c != '\n') output += static_cast<char>(c);
    if (::pclose(pipe) != 0) throw std::runtime_error(command + " failed: " + output);
    return output;
  }

  const TemporaryFolder folder_;
  int databases_ = 0;
  const std::string address_;
};

}  // namespace supple::testing
