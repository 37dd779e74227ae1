#include "supple/access/key.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "supple/access/duration.h"

namespace supple::access {
namespace {

TEST(Key, TokensReadBackAndNothingElseIsOne) {
  const Token token{new_key_id(), new_secret()};
  const auto text = token_text(token);
  ASSERT_TRUE(parse_token(text));
  EXPECT_EQ(parse_token(text)->id, token.id);
  EXPECT_EQ(parse_token(text)->secret, token.secret);
  auto upper = text;
  upper.back() = 'A';
  for (const auto& other : {text + "0", text.substr(0, text.size() - 1), upper, "Supple" + text.substr(6),
                            text.substr(0, 19) + "-" + text.substr(20), std::string(), std::string("supple_")})
    EXPECT_FALSE(parse_token(other)) << other;
}

TEST(Key, SecretsAreLongAndNeverTheSame) {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) {
    const auto secret = new_secret();
    EXPECT_EQ(secret.size(), 64U);
    EXPECT_TRUE(seen.insert(secret).second);
  }
}

TEST(Key, HashesAreSaltedAndFitTheirSecretAlone) {
  const auto secret = new_secret();
  const auto hash = hash_secret(secret);
  EXPECT_TRUE(matches(hash, secret));
  EXPECT_FALSE(matches(hash, new_secret()));
  EXPECT_FALSE(matches(hash, ""));
  EXPECT_FALSE(matches({}, secret));
  EXPECT_NE(hash.digest, hash_secret(secret).digest);
  EXPECT_NE(hash.digest, digest_of(secret));
  EXPECT_EQ(hash.digest.find(secret), std::string::npos);
}

TEST(Key, DigestsAreSha256) {
  // Expected is the SHA-256 of "abc", an example of FIPS 180-4.
  EXPECT_EQ(digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Key, TheSecretBeforeARotationCountsUntilItsTimeAndNotAtIt) {
  const auto old = new_secret();
  const auto current = new_secret();
  Key key;
  key.secret = hash_secret(current);
  key.previous = hash_secret(old);
  key.previous_until = 1000;
  EXPECT_EQ(accepted_hash(key, current, 5000), &key.secret);
  EXPECT_EQ(accepted_hash(key, old, 999), &*key.previous);
  EXPECT_EQ(accepted_hash(key, old, 1000), nullptr);
  EXPECT_EQ(accepted_hash(key, new_secret(), 0), nullptr);
}

TEST(Scopes, ReadBackAndAdminHasAllOfThem) {
  EXPECT_EQ(scopes_text(parse_scopes("compute,read")), "read,compute");
  EXPECT_TRUE(parse_scopes("read").allow(Scope::read));
  EXPECT_FALSE(parse_scopes("read").allow(Scope::compute));
  EXPECT_FALSE(parse_scopes("read,compute").allow(Scope::admin));
  for (const auto scope : {Scope::read, Scope::compute, Scope::admin}) EXPECT_TRUE(parse_scopes("admin").allow(scope));
  for (const char* text : {"", "write", "read,", "read, compute", ",read"})
    EXPECT_THROW(parse_scopes(text), std::runtime_error) << text;
}

TEST(Duration, IsANumberWithAUnit) {
  EXPECT_EQ(parse_duration("90d"), 90 * 86400);
  EXPECT_EQ(parse_duration("24h"), 86400);
  EXPECT_EQ(parse_duration("30m"), 1800);
  EXPECT_EQ(parse_duration("1s"), 1);
  for (const char* text : {"", "d", "90", "-1d", "0h", "1.5h", "1w", "99999999999d", "36601d", "1 d"})
    EXPECT_THROW(parse_duration(text), std::runtime_error) << text;
}

TEST(Duration, TimesReadBack) {
  EXPECT_EQ(time_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(parse_time("2026-01-31T23:59:59Z"), 1769903999);
  EXPECT_EQ(time_text(1769903999), "2026-01-31T23:59:59Z");
  for (const char* text : {"", "2026-01-31", "2026-01-31T23:59:59", "2026-01-31T23:59:59Zx"})
    EXPECT_THROW(parse_time(text), std::runtime_error) << text;
}

}  // namespace
}  // namespace supple::access
