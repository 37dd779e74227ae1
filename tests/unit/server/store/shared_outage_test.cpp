#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "shared_store_fixture.h"
#include "silent_database.h"

namespace supple::store {
namespace {

TEST_F(SharedStoreTest, TellsTheDatabaseOfUsesOnceItIsThereAgain) {
  SharedStore store(options());
  const auto mesh = store.meshes().add_mesh("used", describe).first.id;
  wait_milliseconds(20);
  const auto before = now_milliseconds();
  wait_milliseconds(20);
  store.meshes().note_mesh_use(mesh);
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  EXPECT_EQ(code_of([&] { store.leases()->renew_leases({}); }), "store.unavailable");
  postgres.again();
  EXPECT_EQ(store.meshes().remove_unused_meshes(before).size(), 0U);
}

TEST_F(SharedStoreTest, IsUnavailableWhileTheDatabaseIsAwayAndGoesOnAfterwards) {
  SharedStore store(options());
  store.jobs().add_job(new_job("job"));
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.kill();
  EXPECT_EQ(code_of([&] { store.jobs().job("job"); }), "store.unavailable");
  EXPECT_EQ(code_of([&] { store.meshes().add_mesh("ply", describe); }), "store.unavailable");
  postgres.again();
  EXPECT_TRUE(store.jobs().job("job").has_value());
  EXPECT_TRUE(store.meshes().add_mesh("ply", describe).second);
  postgres.kill();
  postgres.again();
  EXPECT_TRUE(store.jobs().job("job").has_value()) << "a call after the connection was lost makes it again";
}

TEST_F(SharedStoreTest, GivesUpADatabaseThatHangsAndGoesOnAfterwards) {
  auto impatient = options();
  impatient.transaction_timeout = 0.5;
  SharedStore store(impatient);
  store.jobs().add_job(new_job("job"));
  auto& postgres = PrivatePostgres::of_this_process();
  postgres.freeze();
  const auto start = now_milliseconds();
  std::atomic<int> refused{0};
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i)
    callers.emplace_back([&] { refused += code_of([&] { store.jobs().job("job"); }) == "store.unavailable" ? 1 : 0; });
  for (auto& caller : callers) caller.join();
  const auto time = now_milliseconds() - start;
  postgres.thaw();
  EXPECT_EQ(refused, 8);
  EXPECT_LT(time, 10'000) << "those who waited for their turn do not try one after the other";
  EXPECT_TRUE(store.jobs().job("job").has_value());
}

TEST_F(SharedStoreTest, AsksADatabaseAgainForWhoHasNotWaitedLong) {
  const auto socket = folder_ / "socket";
  const auto real = database_.substr(sizeof "host=" - 1, database_.find(' ') - sizeof "host=" + 1);
  const auto leads_to = [&](const fs::path& folder) {
    fs::remove(socket);
    fs::create_directory_symlink(folder, socket);
  };
  leads_to(real);
  auto through = options();
  through.database.replace(sizeof "host=" - 1, real.size(), socket.string());
  SharedStore store(through);
  store.jobs().add_job(new_job("job"));
  const SilentDatabase silent(folder_ / "silent");
  leads_to(folder_ / "silent");
  PrivatePostgres::rows(database_,
                        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND "
                        "pid <> pg_backend_pid()");
  std::string first;
  std::string second;
  std::thread before([&] { first = code_of([&] { store.jobs().job("job"); }); });
  const int connection = silent.accept();
  leads_to(real);
  std::thread after([&] { second = code_of([&] { store.jobs().job("job"); }); });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ::close(connection);
  before.join();
  after.join();
  EXPECT_EQ(first, "store.unavailable");
  EXPECT_EQ(second, "nothing was thrown") << "the database is there again, which the other call could not know";
}

TEST_F(SharedStoreTest, SaysThatNoDatabaseAnswers) {
  auto none = options();
  none.database = "host=" + (folder_ / "nothing").string() + " dbname=none";
  EXPECT_EQ(code_of([&] { const SharedStore store(none); }), "store.unavailable");
}

TEST_F(SharedStoreTest, GivesUpADatabaseWhoseMachineTakesConnectionsAndSaysNothing) {
  const SilentDatabase machine;
  auto silent = options();
  silent.database = "postgresql://supple@127.0.0.1:" + std::to_string(machine.port()) + "/supple";
  EXPECT_EQ(code_of([&] { const SharedStore store(silent); }), "store.unavailable") << "and does not wait for ever";
}

TEST_F(SharedStoreTest, KeepsWhatItsConnectionStringSays) {
  auto quoted = options();
  quoted.database += " application_name='Bob\\'s \\\\ store' connect_timeout=7";
  SharedStore store(quoted);
  EXPECT_TRUE(store.meshes().add_mesh("ply", describe).second);
  EXPECT_EQ(PrivatePostgres::rows(database_,
                                  "SELECT application_name FROM pg_stat_activity WHERE datname = "
                                  "current_database() AND pid <> pg_backend_pid()"),
            "Bob's \\ store");
  auto mistaken = options();
  mistaken.database = "host=/tmp nonsense=1";
  try {
    const SharedStore unknown(mistaken);
    FAIL() << "a setting that does not exist";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace supple::store
