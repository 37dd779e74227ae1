#include "database.h"
#include "store_fixture.h"
#include "supple/store/maintenance.h"

namespace supple::store {
namespace {

FamilyRecord new_family(const std::string& name, const std::string& owner = "a", const std::string& definition = "{}") {
  return {.id = random_id(),
          .owner = owner,
          .name = name,
          .created = now_milliseconds(),
          .definition = definition,
          .description = "{\"id\":\"" + name + "\"}"};
}

std::vector<std::string> names(const std::vector<FamilyRecord>& families) {
  std::vector<std::string> names;
  for (const auto& family : families) names.push_back(family.name);
  return names;
}

TEST_F(StoreTest, EachOwnerHasItsFamiliesWhichOutliveARestart) {
  {
    LocalStore store(folder_);
    EXPECT_TRUE(store.families().add_family(new_family("one")).second);
    EXPECT_TRUE(store.families().add_family(new_family("two")).second);
    EXPECT_TRUE(store.families().add_family(new_family("one", "b", "[1]")).second);
  }
  LocalStore store(folder_);
  EXPECT_EQ(names(store.families().families("a")), (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(store.families().family("b", "one")->definition, "[1]");
  EXPECT_FALSE(store.families().family("b", "two"));
  EXPECT_FALSE(store.families().remove_family("b", "two"));
  EXPECT_TRUE(store.families().remove_family("a", "one"));
  EXPECT_TRUE(store.families().family("b", "one"));
}

TEST_F(StoreTest, TheNameOfAFamilyIsTakenByAnotherDefinitionOnly) {
  LocalStore store(folder_);
  const auto first = store.families().add_family(new_family("one")).first;
  const auto [again, is_new] = store.families().add_family(new_family("one"));
  EXPECT_FALSE(is_new);
  EXPECT_EQ(again.id, first.id);
  EXPECT_EQ(code_of([&] { store.families().add_family(new_family("one", "a", "[]")); }), "family.exists");
}

TEST_F(StoreTest, AFamilyThatAnUnfinishedJobNeedsStays) {
  LocalStore store(folder_);
  const auto one = store.families().add_family(new_family("one")).first;
  const auto two = store.families().add_family(new_family("two")).first;
  auto job = new_job("j", "a");
  job.families = two.id + "," + one.id;
  ASSERT_TRUE(store.jobs().add_job(job));
  EXPECT_EQ(store.jobs().job("j")->families, job.families);
  EXPECT_EQ(code_of([&] { store.families().remove_family("a", "one"); }), "family.in_use");
  job.state = JobState::failed;
  job.finished = 1;
  store.jobs().finish_job(job, nullptr);
  EXPECT_TRUE(store.families().remove_family("a", "one"));
  auto late = new_job("late", "a");
  late.families = one.id;
  EXPECT_EQ(code_of([&] { store.jobs().add_job(late); }), "tiling.family_not_found");
  EXPECT_FALSE(store.jobs().job("late"));
}

TEST_F(StoreTest, FamiliesCountForTheirOwnerAndForTheStore) {
  const std::string definition(10'000, ' ');
  {
    Quota quota;
    quota.owner_limit = [](const std::string& owner) { return owner == "a" ? 15'000 : 0; };
    LocalStore store(folder_ / "owners", {}, quota);
    store.families().add_family(new_family("one", "a", definition));
    EXPECT_EQ(code_of([&] { store.families().add_family(new_family("two", "a", definition)); }), "store.key_quota");
    EXPECT_TRUE(store.families().add_family(new_family("two", "b", definition)).second);
    EXPECT_TRUE(store.families().remove_family("a", "one"));
    EXPECT_TRUE(store.families().add_family(new_family("two", "a", definition)).second);
  }
  LocalStore store(folder_ / "all", {}, {.bytes = 600'000});
  EXPECT_EQ(code_of([&] { store.families().add_family(new_family("one", "", std::string(600'000, ' '))); }),
            "store.quota");
  EXPECT_TRUE(store.families().families("").empty());
}

TEST_F(StoreTest, AnOwnerHasABoundedNumberOfFamilies) {
  LocalStore store(folder_);
  for (std::int64_t k = 0; k < FamilyStore::max_families; ++k)
    store.families().add_family(new_family("f" + std::to_string(k)));
  const auto problem = thrown_problem([&] { store.families().add_family(new_family("more")); });
  EXPECT_EQ(problem.code, "family.too_many");
  EXPECT_EQ(problem.limit->limit, static_cast<double>(FamilyStore::max_families));
  EXPECT_TRUE(store.families().add_family(new_family("more", "b")).second);
}

TEST_F(StoreTest, ADamagedFamilyIsFoundAndSetAside) {
  {
    LocalStore store(folder_);
    store.families().add_family(new_family("one"));
    store.families().add_family(new_family("two"));
    Database(folder_ / "supple.sqlite").execute("UPDATE families SET definition = 'x' WHERE name = 'one'");
    EXPECT_EQ(code_of([&] { store.families().family("a", "one"); }), "store.corrupted");
    EXPECT_TRUE(store.families().family("a", "two"));
  }
  EXPECT_EQ(check_folder(folder_).families, 2U);
  EXPECT_EQ(check_folder(folder_).faults.size(), 1U);
  repair_folder(folder_, recovery(), [](const std::string& fault) { return fault; });
  EXPECT_EQ(quarantined(), (std::multiset<std::string>{"x"}));
  EXPECT_TRUE(check_folder(folder_).faults.empty());
  EXPECT_EQ(names(LocalStore(folder_).families().families("a")), std::vector<std::string>{"two"});
}

TEST_F(StoreTest, AFolderOfAnEarlierVersionGetsFamilies) {
  { const LocalStore store(folder_); }
  Database(folder_ / "supple.sqlite").execute("DROP TABLE families; ALTER TABLE jobs DROP COLUMN families");
  EXPECT_TRUE(check_folder(folder_).faults.empty()) << "a check changes nothing";
  LocalStore store(folder_);
  EXPECT_TRUE(store.families().add_family(new_family("one")).second);
}

}  // namespace
}  // namespace supple::store
