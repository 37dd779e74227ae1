#include "supple/access/gate.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <utility>

#include "supple/problem/problem.h"

namespace supple::access {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(TokenBucket, GivesAMinutesWorthAtOnceAndThenItsRate) {
  const TokenBucket::Clock::time_point start;
  TokenBucket bucket(120, start);
  for (int i = 0; i < 120; ++i) EXPECT_EQ(bucket.take(start), 0) << i;
  EXPECT_DOUBLE_EQ(bucket.take(start), 0.5);
  EXPECT_DOUBLE_EQ(bucket.take(start + milliseconds(250)), 0.25);
  EXPECT_EQ(bucket.take(start + milliseconds(500)), 0);
  EXPECT_GT(bucket.take(start + milliseconds(500)), 0);
  // A pause fills the bucket, but not beyond a minute's requests.
  int taken = 0;
  while (bucket.take(start + hours(5)) == 0) ++taken;
  EXPECT_EQ(taken, 120);
}

TEST(Sessions, EndWithTheirTimeAndWhenTheyAreClosed) {
  Sessions sessions;
  const Sessions::Clock::time_point start;
  const auto hash = hash_secret(new_secret());
  const auto token = sessions.open("a", hash, start);
  ASSERT_TRUE(sessions.find(token, start));
  EXPECT_EQ(sessions.find(token, start)->key, "a");
  EXPECT_TRUE(sessions.find(token, start + Sessions::length - seconds(1)));
  EXPECT_FALSE(sessions.find(token, start + Sessions::length));
  EXPECT_FALSE(sessions.find(new_secret(), start));
  sessions.close(token);
  EXPECT_FALSE(sessions.find(token, start));
}

TEST(Sessions, AKeyHasSoManyAndTheOldestMakesRoom) {
  Sessions sessions;
  const Sessions::Clock::time_point start;
  const auto hash = hash_secret(new_secret());
  const auto other = sessions.open("b", hash, start);
  const auto first = sessions.open("a", hash, start + seconds(1));
  const auto second = sessions.open("a", hash, start + seconds(2));
  for (std::size_t i = 2; i < Sessions::max_per_key; ++i) sessions.open("a", hash, start + seconds(3));
  EXPECT_TRUE(sessions.find(first, start + seconds(4)));
  sessions.open("a", hash, start + seconds(4));
  EXPECT_FALSE(sessions.find(first, start + seconds(4)));
  EXPECT_TRUE(sessions.find(second, start + seconds(4)));
  EXPECT_TRUE(sessions.find(other, start + seconds(4)));
}

class GateTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::unique_ptr<Gate> gate(Rule rule) {
    return std::make_unique<Gate>(
        file_, rule, [this](const std::string& text) { log_.push_back(text); }, [this] { return now_; });
  }
  Token add(const std::string& scopes, std::int64_t expires_in = 0, int rate = 0) const {
    Token token;
    NewKey key;
    key.name = random_hex(4);
    key.scopes = parse_scopes(scopes);
    key.expires_in = expires_in;
    key.requests_per_minute = rate;
    file_.change([&](auto& keys) { token = add_key(keys, key, now_.date); });
    return token;
  }
  void pass(seconds time) {
    now_.date += time.count();
    now_.steady += time;
  }
  /// The id of the key that `identify` returns, or the code of the error; empty if no key is needed.
  static std::string answer(Gate& gate, const std::string& authorization, const std::string& session = {}) {
    try {
      const auto key = gate.identify({authorization, session});
      return key ? key->id : std::string();
    } catch (const Error& error) {
      return error.code();
    }
  }
  static std::string bearer(const Token& token) { return "Bearer " + token_text(token); }

  const fs::path folder_ = fs::path(::testing::TempDir()) / ("gate-" + random_hex(8));
  const KeyFile file_{folder_ / "keys"};
  Gate::Time now_{1'000'000, Gate::Clock::time_point() + hours(1)};
  std::vector<std::string> log_;
};

TEST_F(GateTest, DoesNotStartWhereNobodyCouldUseTheServer) {
  EXPECT_THROW(gate(Rule::always), std::runtime_error);
  EXPECT_FALSE(gate(Rule::where_keys_are)->required());
  EXPECT_FALSE(gate(Rule::never)->required());
  file_.change([](auto&) {});
  EXPECT_THROW(gate(Rule::where_keys_are), std::runtime_error);
  EXPECT_FALSE(gate(Rule::never)->required());
}

TEST_F(GateTest, WithoutKeysEverybodyIsAnsweredWhateverTheySend) {
  const auto open = gate(Rule::where_keys_are);
  EXPECT_EQ(answer(*open, ""), "");
  EXPECT_EQ(answer(*open, "Bearer nonsense", "x"), "");
}

TEST_F(GateTest, KnowsAKeyByItsSecretAlone) {
  const auto token = add("read");
  const auto other = add("read");
  const auto guarded = gate(Rule::where_keys_are);
  EXPECT_EQ(answer(*guarded, bearer(token)), token.id);
  EXPECT_EQ(answer(*guarded, "bearer  " + token_text(token)), token.id);
  EXPECT_EQ(answer(*guarded, ""), "access.key_required");
  for (const auto& wrong :
       {"Bearer " + token_text({token.id, other.secret}), "Bearer " + token_text({token.id, new_secret()}),
        "Bearer " + token_text({new_key_id(), token.secret}), "Basic " + token_text(token), token_text(token),
        std::string("Bearer"), std::string("Bearer "), bearer(token) + "0"})
    EXPECT_EQ(answer(*guarded, wrong), "access.key_invalid") << wrong;
}

TEST_F(GateTest, AKeyExpires) {
  const auto token = add("read", 100);
  const auto guarded = gate(Rule::always);
  pass(seconds(99));
  EXPECT_EQ(answer(*guarded, bearer(token)), token.id);
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, bearer(token)), "access.key_invalid");
}

TEST_F(GateTest, ChangesOfTheFileCountWithinASecondWithoutARestart) {
  const auto token = add("read");
  const auto guarded = gate(Rule::where_keys_are);
  Token rotated;
  file_.change([&](auto& keys) { rotated = rotate_key(keys, token.id, 60, now_.date); });
  EXPECT_EQ(answer(*guarded, bearer(rotated)), "access.key_invalid");
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, bearer(rotated)), token.id);
  EXPECT_EQ(answer(*guarded, bearer(token)), token.id);
  pass(seconds(60));
  EXPECT_EQ(answer(*guarded, bearer(token)), "access.key_invalid");
  file_.change([&](auto& keys) { revoke_key(keys, token.id); });
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, bearer(rotated)), "access.key_invalid");
}

TEST_F(GateTest, TheFirstKeyIsRequiredFromThenOnAndItsFilesLossOpensNothing) {
  const auto guarded = gate(Rule::where_keys_are);
  EXPECT_EQ(answer(*guarded, ""), "");
  const auto token = add("read");
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, ""), "access.key_required");
  EXPECT_EQ(answer(*guarded, bearer(token)), token.id);
  fs::remove(file_.path());
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, ""), "access.key_required");
  EXPECT_EQ(answer(*guarded, bearer(token)), "access.key_invalid");
}

TEST_F(GateTest, AFileThatCannotBeReadChangesNothingAndIsSaidOnce) {
  const auto token = add("read");
  const auto guarded = gate(Rule::always);
  fs::permissions(file_.path(), fs::perms::all);
  for (int i = 0; i < 3; ++i) {
    pass(seconds(1));
    EXPECT_EQ(answer(*guarded, bearer(token)), token.id);
  }
  ASSERT_EQ(log_.size(), 1U);
  EXPECT_NE(log_[0].find("chmod 600"), std::string::npos);
}

TEST_F(GateTest, AKeyDoesWhatItsScopesSay) {
  const auto token = add("read");
  const auto guarded = gate(Rule::always);
  const auto key = guarded->identify({bearer(token), ""});
  EXPECT_NO_THROW(guarded->allow(*key, Scope::read));
  try {
    guarded->allow(*key, Scope::compute);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "access.scope");
    EXPECT_NE(std::string(error.what()).find("needs the scope compute"), std::string::npos) << error.what();
  }
}

TEST_F(GateTest, AKeysRateIsItsOwnAndSaysWhenToAskAgain) {
  const auto slow = add("read", 0, 6);
  const auto quick = add("read", 0, 6);
  const auto guarded = gate(Rule::always);
  const auto key = *guarded->identify({bearer(slow), ""});
  const auto other = *guarded->identify({bearer(quick), ""});
  for (int i = 0; i < 6; ++i) EXPECT_NO_THROW(guarded->allow(key, Scope::read));
  pass(seconds(3));
  try {
    guarded->allow(key, Scope::read);
    FAIL();
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.code(), "access.rate");
    EXPECT_EQ(error.problem().retry_after, 7);
    EXPECT_EQ(error.problem().limit->limit, 6);
  }
  EXPECT_NO_THROW(guarded->allow(other, Scope::read));
  pass(seconds(7));
  EXPECT_NO_THROW(guarded->allow(key, Scope::read));
}

TEST_F(GateTest, SigningInCountsAsARequestOfTheKey) {
  const auto token = add("read", 0, 3);
  const auto guarded = gate(Rule::always);
  for (int i = 0; i < 3; ++i) EXPECT_NO_THROW(guarded->sign_in(token_text(token)));
  try {
    guarded->sign_in(token_text(token));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "access.rate");
  }
}

TEST_F(GateTest, CredentialsAreValidUntilTheKeyEndsAndAskingCountsNoRequest) {
  const auto token = add("read", 100, 2);
  const auto guarded = gate(Rule::always);
  const auto session = guarded->sign_in(token_text(token)).token;
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(guarded->still_valid({bearer(token), ""}));
    EXPECT_TRUE(guarded->still_valid({"", session}));
  }
  EXPECT_NO_THROW(guarded->count(*guarded->identify({bearer(token), ""})));
  guarded->sign_out(session);
  EXPECT_FALSE(guarded->still_valid({"", session}));
  pass(seconds(100));
  EXPECT_FALSE(guarded->still_valid({bearer(token), ""}));
}

TEST_F(GateTest, ASessionStandsForItsKeyUntilTheSecretThatOpenedItEnds) {
  const auto token = add("read,compute");
  const auto guarded = gate(Rule::always);
  EXPECT_THROW(guarded->sign_in("supple_"), Error);
  const auto session = guarded->sign_in(token_text(token));
  EXPECT_EQ(session.key.id, token.id);
  EXPECT_NE(session.token, token.secret);
  EXPECT_EQ(answer(*guarded, "", session.token), token.id);
  EXPECT_EQ(answer(*guarded, "", new_secret()), "access.key_invalid");
  file_.change([&](auto& keys) { rotate_key(keys, token.id, 60, now_.date); });
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, "", session.token), token.id);
  pass(seconds(60));
  EXPECT_EQ(answer(*guarded, "", session.token), "access.key_invalid");
}

TEST_F(GateTest, ALackOfMemoryIsNoFaultOfTheFile) {
  const auto token = add("read");
  bool lacks_memory = true;
  Gate guarded(
      file_, Rule::always,
      [&](const std::string& text) {
        if (std::exchange(lacks_memory, false)) throw std::bad_alloc();
        log_.push_back(text);
      },
      [this] { return now_; });
  add("read");
  pass(seconds(1));
  EXPECT_THROW(guarded.required(), std::bad_alloc);
  EXPECT_TRUE(log_.empty()) << log_.front();
  EXPECT_EQ(answer(guarded, bearer(token)), token.id);
}

TEST_F(GateTest, ASessionEndsWhenItIsClosedOrItsKeyRevoked) {
  const auto token = add("read");
  const auto guarded = gate(Rule::always);
  const auto first = guarded->sign_in(token_text(token)).token;
  const auto second = guarded->sign_in(token_text(token)).token;
  EXPECT_EQ(guarded->sign_out(first), token.id);
  EXPECT_EQ(guarded->sign_out(first), "");
  EXPECT_EQ(answer(*guarded, "", first), "access.key_invalid");
  EXPECT_EQ(answer(*guarded, "", second), token.id);
  file_.change([&](auto& keys) { revoke_key(keys, token.id); });
  pass(seconds(1));
  EXPECT_EQ(answer(*guarded, "", second), "access.key_invalid");
}

}  // namespace
}  // namespace supple::access
