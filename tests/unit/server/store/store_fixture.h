#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/store/local_store.h"
#include "support/temporary_folder.h"
#include "unit/server/thrown_problem.h"

namespace supple::store {

namespace fs = std::filesystem;

/// Gives each test a folder of its own.
class StoreTest : public ::testing::Test {
 protected:
  static std::string describe(const std::string& id, std::int64_t) { return "{\"id\":\"" + id + "\"}"; }

  static JobRecord new_job(const std::string& id, const std::string& owner = {}) {
    JobRecord job;
    job.id = id;
    job.owner = owner;
    job.kind = "geodesics";
    job.mesh = "m";
    job.created = now_milliseconds();
    job.deadline = 1.5;
    return job;
  }

  template <typename Call>
  static std::string code_of(Call&& call) {
    return thrown_problem(std::forward<Call>(call)).code;
  }

  /// Callbacks of a recovery that takes any content for a mesh, except "no mesh".
  LocalStore::Recovery recovery() {
    return {[](const std::string& ply, const std::string& id, std::int64_t created) {
              if (ply == "no mesh") throw Error("mesh.malformed", "This is no mesh.");
              return describe(id, created);
            },
            [this](const std::string& text) { warnings_.push_back(text); }};
  }
  /// The contents of the files in quarantine.
  std::multiset<std::string> quarantined() const { return quarantined_in(folder_ / "quarantine"); }
  static std::multiset<std::string> quarantined_in(const fs::path& folder) {
    std::multiset<std::string> contents;
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      contents.emplace(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    return contents;
  }

  const testing::TemporaryFolder temporary_folder_;
  const fs::path folder_ = temporary_folder_.path();
  std::vector<std::string> warnings_;
};

}  // namespace supple::store
