#include "supple/store/store.h"

#include "store_fixture.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, NamesAMeshByTheHashOfItsContent) {
  LocalStore store(folder_);
  const auto [record, is_new] = store.meshes().add_mesh("abc", describe);
  EXPECT_TRUE(is_new);
  EXPECT_EQ(record.id, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(store.meshes().mesh_content(record.id), "abc");
}

TEST_F(StoreTest, KeepsAMeshThatIsAddedTwiceOnce) {
  LocalStore store(folder_);
  const auto first = store.meshes().add_mesh("abc", describe).first;
  const auto [second, is_new] = store.meshes().add_mesh("abc", describe);
  EXPECT_FALSE(is_new);
  EXPECT_EQ(second.created, first.created);
  EXPECT_EQ(store.meshes().meshes(10, "").size(), 1U);
}

TEST_F(StoreTest, ListsInPagesTheNewestFirst) {
  LocalStore store(folder_);
  std::vector<std::string> ids;
  for (const char* content : {"a", "b", "c"}) ids.push_back(store.meshes().add_mesh(content, describe).first.id);
  const auto page = store.meshes().meshes(2, "");
  ASSERT_EQ(page.size(), 2U);
  EXPECT_EQ(page[0].id, ids[2]);
  EXPECT_EQ(page[1].id, ids[1]);
  const auto rest = store.meshes().meshes(2, page[1].id);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].id, ids[0]);
}

TEST_F(StoreTest, OpensWhatCanBeReadInPiecesWhateverBecomesOfItsName) {
  LocalStore store(folder_);
  std::string content;
  for (int i = 0; content.size() < 3'000'000; ++i)
    content += std::to_string(i) + "\n";  // several pieces, the last one short
  const auto mesh = store.meshes().add_mesh(content, describe).first.id;
  auto job = new_job("j");
  job.session = std::string(100'000, 's');  // the header of its file is longer than the part that is read at first
  store.jobs().add_job(job);
  job.state = JobState::successful;
  const Result result{"text/plain", {}, content};
  store.jobs().finish_job(job, &result);
  const auto ply = store.meshes().open_mesh_content(mesh);
  const auto body = store.blobs().job_result("j").body;
  store.meshes().remove_mesh(mesh);
  store.jobs().remove_job("j");
  for (const auto& open : {ply, body}) {
    EXPECT_EQ(open.size(), content.size());
    EXPECT_TRUE(open.text() == content);
    std::string piece(10, ' ');
    open.read(2'500'000, piece.data(), piece.size());
    EXPECT_EQ(piece, content.substr(2'500'000, 10));
  }
  EXPECT_EQ(code_of([&] { store.meshes().open_mesh_content(mesh); }), "mesh.not_found");
  EXPECT_EQ(code_of([&] { store.blobs().job_result("j"); }), "job.not_found");
}

TEST_F(StoreTest, FindsAnOpenedFileThatHasChangedInAnyPiece) {
  LocalStore store(folder_);
  const std::string content(3'000'000, 'x');
  const auto id = store.meshes().add_mesh(content, describe).first.id;
  for (const std::size_t at : {0, 1'500'000, 2'999'999}) {
    auto changed = content;
    changed[at] = 'y';
    std::ofstream(folder_ / "meshes" / (id + ".ply"), std::ios::binary) << changed;
    EXPECT_EQ(code_of([&] { store.meshes().open_mesh_content(id); }), "store.corrupted") << at;
  }
  std::ofstream(folder_ / "meshes" / (id + ".ply"), std::ios::binary) << content.substr(1);
  EXPECT_EQ(code_of([&] { store.meshes().open_mesh_content(id); }), "store.corrupted") << "shorter";
  store.meshes().add_mesh(content, describe);
  const auto open = store.meshes().open_mesh_content(id);
  fs::resize_file(folder_ / "meshes" / (id + ".ply"), 1000);
  EXPECT_EQ(code_of([&] { open.text(); }), "store.corrupted") << "while it is read";
}

TEST_F(StoreTest, FindsAChangedFileByItsHash) {
  LocalStore store(folder_);
  const auto id = store.meshes().add_mesh("abc", describe).first.id;
  std::ofstream(folder_ / "meshes" / (id + ".ply")) << "abd";
  EXPECT_EQ(code_of([&] { store.meshes().mesh_content(id); }), "store.corrupted");
  store.meshes().add_mesh("abc", describe);
  EXPECT_EQ(store.meshes().mesh_content(id), "abc") << "uploading again repairs it";
  fs::remove(folder_ / "meshes" / (id + ".ply"));
  EXPECT_EQ(code_of([&] { store.meshes().mesh_content(id); }), "store.corrupted");
}

TEST_F(StoreTest, KeepsMeshesJobsAndResultsOverARestart) {
  std::string mesh;
  {
    LocalStore store(folder_);
    mesh = store.meshes().add_mesh("abc", describe).first.id;
    auto job = new_job("j1");
    job.priority = Priority::background;
    store.jobs().add_job(job);
    store.jobs().add_job(new_job("j2"));
    job.state = JobState::successful;
    job.finished = job.created + 5;
    const Result result{"application/octet-stream", {{"A", "1"}, {"B", "x: y"}}, std::string("\0\n\xFF", 3)};
    store.jobs().finish_job(job, &result);
  }
  LocalStore store(folder_);
  EXPECT_EQ(store.meshes().mesh_content(mesh), "abc");
  const auto job = store.jobs().job("j1");
  ASSERT_TRUE(job);
  EXPECT_EQ(job->state, JobState::successful);
  EXPECT_EQ(job->deadline, 1.5);
  EXPECT_EQ(job->priority, Priority::background);
  EXPECT_EQ(store.jobs().job("j2")->priority, Priority::normal);
  const auto result = store.blobs().job_result("j1");
  EXPECT_EQ(result.body.text(), std::string("\0\n\xFF", 3));
  EXPECT_EQ(result.headers, (std::vector<std::pair<std::string, std::string>>{{"A", "1"}, {"B", "x: y"}}));
}

TEST_F(StoreTest, RefusesAFolderThatIsInUse) {
  LocalStore store(folder_);
  EXPECT_EQ(code_of([&] { LocalStore second(folder_); }), "store.unavailable");
}

TEST_F(StoreTest, SaysThatAFolderCannotBeMade) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_EQ(code_of([&] { LocalStore store(folder_ / "file" / "data"); }), "store.unavailable");
}

TEST_F(StoreTest, LetsOnlyItsUserReadItsFiles) {
  LocalStore store(folder_);
  const auto mesh = store.meshes().add_mesh("abc", describe).first.id;
  for (const auto& path : {folder_ / "supple.sqlite", folder_ / "lock", folder_ / "meshes" / (mesh + ".ply")})
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write) << path;
}

TEST_F(StoreTest, LetsOnlyItsUserEnterItsFolder) {
  const auto data = folder_ / "new" / "data";
  {
    const LocalStore store(data, recovery());
    EXPECT_EQ(fs::status(data).permissions(), fs::perms::owner_all);
    EXPECT_TRUE(warnings_.empty()) << "nothing is said of a folder that the store made";
  }
  fs::permissions(data, fs::perms::owner_all | fs::perms::group_all | fs::perms::others_read);
  {
    const LocalStore store(data, recovery());
    EXPECT_EQ(fs::status(data).permissions(), fs::perms::owner_all);
    ASSERT_EQ(warnings_.size(), 1U);
    EXPECT_NE(warnings_[0].find("0700"), std::string::npos);
  }
  const LocalStore store(data, recovery());
  EXPECT_EQ(warnings_.size(), 1U) << "said once";
}

TEST_F(StoreTest, RemovesExpiredJobsAndTheOldestBeyondTheLimit) {
  LocalStore store(folder_);
  for (int i = 0; i < 5; ++i) {
    auto job = new_job("j" + std::to_string(i));
    store.jobs().add_job(job);
    if (i == 4) continue;
    job.state = JobState::failed;
    job.finished = 1000;
    job.expires = i == 3 ? 1500 : 5000;
    store.jobs().finish_job(job, nullptr);
  }
  EXPECT_EQ(store.jobs().remove_expired_jobs(2000, 3), 2U) << "j3 has expired; j0 is the oldest of four";
  EXPECT_FALSE(store.jobs().job("j0"));
  EXPECT_TRUE(store.jobs().job("j1"));
  EXPECT_FALSE(store.jobs().job("j3"));
  EXPECT_TRUE(store.jobs().job("j4")) << "an unfinished job is never removed";
}

TEST_F(StoreTest, KeepsNoResultOfAJobThatWasRemovedMeanwhile) {
  LocalStore store(folder_);
  auto job = new_job("j");
  store.jobs().add_job(job);
  EXPECT_TRUE(store.jobs().remove_job("j"));
  EXPECT_FALSE(store.jobs().remove_job("j"));
  const Result result{"text/plain", {}, "late"};
  store.jobs().finish_job(job, &result);
  EXPECT_TRUE(fs::is_empty(folder_ / "results"));
}

}  // namespace
}  // namespace supple::store
