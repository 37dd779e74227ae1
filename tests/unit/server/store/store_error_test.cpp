#include "supple/store/store_error.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>
#include <string>

#include "database.h"
#include "file_access.h"
#include "store_fixture.h"

namespace supple::store {
namespace {

TEST(StoreErrors, TellAFullDiskFromOneThatFailsOtherwise) {
  for (const int error : {ENOSPC, EDQUOT, EFBIG})
    EXPECT_THROW(throw_file_error("write", "meshes/a.ply", error), StoreFull) << error;
  EXPECT_THROW(throw_file_error("write", "meshes/a.ply", EIO), StoreUnavailable);
}

TEST(StoreErrors, HaveTheCodesOfTheContract) {
  EXPECT_EQ(StoreFull("No.").code(), "store.full");
  EXPECT_EQ(StoreUnavailable("No.").code(), "store.unavailable");
  EXPECT_EQ(StoreCorrupted("No.").code(), "store.corrupted");
  EXPECT_EQ(DamagedDatabase("No.").code(), "store.corrupted");
  EXPECT_EQ(MeshNotFound("a").code(), "mesh.not_found");
  EXPECT_EQ(JobNotFound("a").code(), "job.not_found");
  EXPECT_EQ(ModelNotFound("a", "no model is loaded.").code(), "model.not_found");
}

TEST(StoreErrors, SayWhatThereIsNot) {
  EXPECT_STREQ(MeshNotFound("a").what(), "There is no mesh a.");
  EXPECT_STREQ(JobNotFound("b").what(), "There is no job b.");
  EXPECT_STREQ(ModelNotFound("c", "known are d.").what(), "There is no model c; known are d.");
}

TEST_F(StoreTest, ThrowsErrorsWhoseTypesSayWhatIsWrong) {
  LocalStore store(folder_);
  EXPECT_THROW(store.meshes().mesh_content("a"), MeshNotFound);
  EXPECT_THROW(store.meshes().open_mesh_content("a"), MeshNotFound);
  EXPECT_THROW(store.blobs().job_result("a"), JobNotFound);
  const auto id = store.meshes().add_mesh("abc", describe).first.id;
  const auto file = folder_ / "meshes" / (id + ".ply");
  std::ofstream(file) << "abd";
  EXPECT_THROW(store.meshes().mesh_content(id), StoreCorrupted);
  EXPECT_THROW(store.meshes().open_mesh_content(id), StoreCorrupted);
  fs::remove(file);
  EXPECT_THROW(store.meshes().mesh_content(id), StoreCorrupted) << "missing";
  EXPECT_THROW(store.meshes().open_mesh_content(id), StoreCorrupted) << "missing";
  EXPECT_THROW(LocalStore{folder_}, StoreUnavailable) << "it is in use";
}

}  // namespace
}  // namespace supple::store
