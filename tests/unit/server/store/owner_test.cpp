#include "store_fixture.h"

namespace supple::store {
namespace {

TEST_F(StoreTest, AMeshThatSeveralOwnGoesWithItsLastOwner) {
  Store store(folder_);
  const auto [mesh, is_new] = store.add_mesh("ply", describe, "a");
  EXPECT_TRUE(is_new);
  EXPECT_FALSE(store.add_mesh("ply", describe, "a").second);
  EXPECT_TRUE(store.is_last_owner_of_mesh(mesh.id, "a"));
  EXPECT_FALSE(store.owns_mesh(mesh.id, "b"));
  EXPECT_FALSE(store.remove_mesh(mesh.id, "b"));
  EXPECT_TRUE(store.add_mesh("ply", describe, "b").second) << "new to its second owner";
  EXPECT_FALSE(store.is_last_owner_of_mesh(mesh.id, "a"));
  EXPECT_TRUE(store.remove_mesh(mesh.id, "a"));
  EXPECT_FALSE(store.remove_mesh(mesh.id, "a"));
  EXPECT_TRUE(store.mesh(mesh.id));
  EXPECT_TRUE(store.remove_mesh(mesh.id, "b"));
  EXPECT_FALSE(store.mesh(mesh.id));
}

TEST_F(StoreTest, OwnersOutliveARestartAndGoWithWhatTheyOwn) {
  std::string id;
  {
    Store store(folder_);
    id = store.add_mesh("ply", describe, "a").first.id;
    store.add_job(new_job("j"));
    store.own_job("j", "a");
  }
  Store store(folder_);
  EXPECT_TRUE(store.owns_mesh(id, "a"));
  EXPECT_TRUE(store.owns_job("j", "a"));
  EXPECT_FALSE(store.owns_job("j", "b"));
  EXPECT_TRUE(store.remove_mesh(id));
  EXPECT_TRUE(store.remove_job("j"));
  store.add_mesh("ply", describe);
  store.add_job(new_job("j"));
  EXPECT_FALSE(store.owns_mesh(id, "a"));
  EXPECT_FALSE(store.owns_job("j", "a"));
}

TEST_F(StoreTest, ListsWhatOneOwnerHasPageByPage) {
  Store store(folder_);
  std::vector<std::string> of_a;
  for (int i = 0; i < 5; ++i) {
    of_a.insert(of_a.begin(), store.add_mesh("a" + std::to_string(i), describe, "a").first.id);
    store.add_mesh("b" + std::to_string(i), describe, "b");
    store.add_mesh("nobody" + std::to_string(i), describe);
    for (const char* owner : {"a", "b"}) {
      const auto job = std::string(owner) + std::to_string(i);
      store.add_job(new_job(job));
      store.own_job(job, owner);
    }
  }
  const auto first = store.meshes(3, "", "a");
  ASSERT_EQ(first.size(), 3U);
  const auto rest = store.meshes(3, first.back().id, "a");
  ASSERT_EQ(rest.size(), 2U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ((i < 3 ? first[i] : rest[i - 3]).id, of_a[i]);
  EXPECT_EQ(store.meshes(100, "").size(), 15U);
  const auto jobs = store.jobs({}, 3, "a3", "a");
  ASSERT_EQ(jobs.size(), 3U);
  EXPECT_EQ(jobs[0].id, "a2");
  EXPECT_TRUE(store.jobs({JobState::failed}, 100, "", "a").empty());
  EXPECT_EQ(store.jobs({}, 100, "").size(), 10U);
}

}  // namespace
}  // namespace supple::store
