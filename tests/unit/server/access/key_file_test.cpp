#include "supple/access/key_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace supple::access {
namespace {

namespace fs = std::filesystem;

class KeyFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("keys-" + random_hex(8));
    path_ = folder_ / "keys";
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& text) const {
    fs::create_directories(folder_);
    std::ofstream(path_) << text;
  }
  std::string text() const {
    std::ostringstream out;
    out << std::ifstream(path_).rdbuf();
    return out.str();
  }
  mode_t mode() const {
    struct stat status {};
    ::stat(path_.c_str(), &status);
    return status.st_mode & 0777;
  }

  fs::path folder_;
  fs::path path_;
};

NewKey wanted(const std::string& name = "lab") {
  NewKey key;
  key.name = name;
  key.scopes = parse_scopes("read,compute");
  return key;
}

/// Text of the exception that a call throws; empty if it throws none.
template <class Call>
std::string thrown(Call call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST_F(KeyFileTest, APipeInItsPlaceIsRefusedAndNotWaitedFor) {
  fs::create_directories(folder_);
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_NE(thrown([&] { KeyFile(path_).read(); }).find("is no regular file"), std::string::npos);
}

TEST_F(KeyFileTest, KeysReadBackAndNoSecretIsInTheFile) {
  const KeyFile file(path_);
  EXPECT_FALSE(file.exists());
  EXPECT_TRUE(file.read().empty());
  Token token;
  file.change([&](auto& keys) {
    auto key = wanted("a lab # 1");
    key.expires_in = 100;
    key.requests_per_minute = 600;
    key.max_waiting_jobs = 5;
    key.max_stored = 5'000'000'000;
    token = add_key(keys, key, 1000);
  });
  Token rotated;
  file.change([&](auto& keys) { rotated = rotate_key(keys, token.id, 50, 1010); });
  const auto keys = file.read();
  ASSERT_EQ(keys.size(), 1U);
  EXPECT_EQ(keys[0].id, token.id);
  EXPECT_EQ(keys[0].name, "a lab # 1");
  EXPECT_EQ(scopes_text(keys[0].scopes), "read,compute");
  EXPECT_EQ(keys[0].created, 1000);
  EXPECT_EQ(keys[0].expires, 1100);
  EXPECT_EQ(keys[0].requests_per_minute, 600);
  EXPECT_EQ(keys[0].max_waiting_jobs, 5);
  EXPECT_EQ(keys[0].max_stored, 5'000'000'000);
  EXPECT_EQ(keys[0].previous_until, 1060);
  EXPECT_TRUE(matches(keys[0].secret, rotated.secret));
  EXPECT_TRUE(matches(*keys[0].previous, token.secret));
  EXPECT_EQ(text().find(token.secret), std::string::npos);
  EXPECT_EQ(text().find(rotated.secret), std::string::npos);
  EXPECT_EQ(write_keys(keys), text());
}

TEST_F(KeyFileTest, TheFileAndItsFolderAreForTheirUserAlone) {
  const auto before = ::umask(0);
  KeyFile(path_).change([](auto& keys) { add_key(keys, wanted(), 0); });
  ::umask(before);
  EXPECT_EQ(mode(), 0600U);
  EXPECT_EQ(fs::status(folder_).permissions(), fs::perms::owner_all);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "nothing half-written";
}

TEST_F(KeyFileTest, AFileThatOthersMayWriteIsNotBelieved) {
  KeyFile(path_).change([](auto& keys) { add_key(keys, wanted(), 0); });
  ::chmod(path_.c_str(), 0620);
  EXPECT_NE(thrown([&] { KeyFile(path_).read(); }).find("chmod 600"), std::string::npos);
}

TEST_F(KeyFileTest, AChangeThatFailsLeavesTheFileAsItWas) {
  const KeyFile file(path_);
  file.change([](auto& keys) { add_key(keys, wanted(), 0); });
  const auto before = text();
  EXPECT_FALSE(thrown([&] { file.change([](auto& keys) { revoke_key(keys, "0123456789ab"); }); }).empty());
  EXPECT_EQ(text(), before);
}

TEST_F(KeyFileTest, SeveralWhoChangeItAtOnceLoseNoKey) {
  const KeyFile file(path_);
  fs::create_directories(folder_);
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back(
        [&file, i] { file.change([i](auto& keys) { add_key(keys, wanted("key " + std::to_string(i)), 0); }); });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(file.read().size(), 8U);
}

TEST_F(KeyFileTest, AFaultyLineIsNamed) {
  const std::string digest(64, 'a');
  const std::string good = "key 0123456789ab\n  name x\n  scopes read\n  secret 00 " + digest + "\n";
  write(good);
  EXPECT_EQ(KeyFile(path_).read().size(), 1U);
  for (const std::string faulty :
       {"kez 0123456789ab\n", "  name x\n", "key 0123456789ab\n  colour red\n", "key 0123456789ab\n  scopes all\n",
        "key 0123456789ab\n  secret 00 short\n", "key 0123456789ab\n  expires soon\n",
        "key 0123456789ab\n  requests_per_minute -1\n", "key\n"}) {
    write("# a comment\n" + faulty);
    const auto said = thrown([&] { KeyFile(path_).read(); });
    EXPECT_NE(said.find("line "), std::string::npos) << faulty << said;
    EXPECT_NE(said.find(path_.string()), std::string::npos) << said;
  }
  write(good + good);
  EXPECT_NE(thrown([&] { KeyFile(path_).read(); }).find("twice"), std::string::npos);
  write("key 0123456789ab\n  name x\n  scopes read\n");
  EXPECT_NE(thrown([&] { KeyFile(path_).read(); }).find("lacks its secret"), std::string::npos);
}

TEST(Keys, NamesArePlainAndTakenOnce) {
  std::vector<Key> keys;
  add_key(keys, wanted("lab"), 0);
  EXPECT_NE(thrown([&] { add_key(keys, wanted("lab"), 0); }).find(keys[0].id), std::string::npos);
  for (const auto& name : {std::string(), std::string("a\nkey b"), std::string("\xc3\xa9"), std::string(65, 'x')})
    EXPECT_FALSE(thrown([&] { add_key(keys, wanted(name), 0); }).empty()) << name;
  EXPECT_EQ(keys.size(), 1U);
}

TEST(Keys, RotationKeepsTheIdAndEndsTheSecretBeforeTheLast) {
  std::vector<Key> keys;
  const auto first = add_key(keys, wanted(), 0);
  const auto second = rotate_key(keys, first.id, 100, 10);
  const auto third = rotate_key(keys, first.id, 100, 20);
  EXPECT_EQ(third.id, first.id);
  EXPECT_EQ(accepted_hash(keys[0], first.secret, 30), nullptr);
  EXPECT_NE(accepted_hash(keys[0], second.secret, 30), nullptr);
  EXPECT_NE(accepted_hash(keys[0], third.secret, 30), nullptr);
  rotate_key(keys, first.id, 0, 40);
  EXPECT_FALSE(keys[0].previous);
  EXPECT_EQ(accepted_hash(keys[0], third.secret, 40), nullptr);
}

TEST(Keys, WhatDoesNotExistOrHasExpiredIsNotRotated) {
  std::vector<Key> keys;
  EXPECT_NE(thrown([&] { rotate_key(keys, "0123456789ab", 0, 0); }).find("keys list"), std::string::npos);
  auto key = wanted();
  key.expires_in = 10;
  const auto token = add_key(keys, key, 0);
  EXPECT_TRUE(thrown([&] { rotate_key(keys, token.id, 0, 9); }).empty());
  EXPECT_NE(thrown([&] { rotate_key(keys, token.id, 0, 10); }).find("1970-01-01T00:00:10Z"), std::string::npos);
  revoke_key(keys, token.id);
  EXPECT_TRUE(keys.empty());
}

}  // namespace
}  // namespace supple::access
