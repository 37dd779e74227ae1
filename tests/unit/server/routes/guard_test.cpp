#include "supple/routes/guard.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <utility>

#include "supple/base/error.h"

namespace supple::routes {
namespace {

struct Asked {
  std::string host = "localhost:8080";
  std::string origin;
  std::string method = "POST";
  std::string fetch_site;
};

std::string verdict(const GuardOptions& options, const Asked& asked) {
  http::Request request;
  request.method = asked.method;
  request.host = asked.host;
  if (!asked.origin.empty()) request.headers.emplace_back("Origin", asked.origin);
  if (!asked.fetch_site.empty()) request.headers.emplace_back("Sec-Fetch-Site", asked.fetch_site);
  try {
    make_guard(options)(request, nullptr);
  } catch (const Error& error) {
    return error.code();
  }
  return "answered";
}

std::string of_host(const std::string& host, const GuardOptions& options = {}) {
  Asked asked;
  asked.host = host;
  return verdict(options, asked);
}

std::string of_origin(const std::string& origin, const GuardOptions& options = {}) {
  Asked asked;
  asked.origin = origin;
  return verdict(options, asked);
}

TEST(Guard, AnswersToTheNamesOfLoopbackAlone) {
  for (const char* host : {"localhost", "localhost:8080", "LOCALHOST.", "a.localhost:1", "127.0.0.1:8080", "127.1.2.3",
                           "[::1]:8080", ""}) {
    EXPECT_EQ(of_host(host), "answered") << host;
  }
  for (const char* host : {"evil.example", "localhost.evil.example", "127.0.0.1.evil.example", "127.evil.example",
                           "192.168.0.7:8080", "[fe80::1]:8080", "x"}) {
    EXPECT_EQ(of_host(host), "http.misdirected_request") << host;
  }
}

TEST(Guard, AnswersToAddressesBeyondLoopbackWhereItListensThere) {
  GuardOptions options;
  options.listens_on = "0.0.0.0";
  EXPECT_EQ(of_host("192.168.0.7:8080", options), "answered");
  EXPECT_EQ(of_host("[2001:db8::1]", options), "answered");
  EXPECT_EQ(of_host("supple.example", options), "http.misdirected_request");
  options.listens_on = "supple.example";
  EXPECT_EQ(of_host("Supple.example:8080", options), "answered");
}

TEST(Guard, AnswersToNamesThatAreAllowed) {
  GuardOptions options;
  options.allowed_hosts = {"Supple.Example"};
  EXPECT_EQ(of_host("supple.example:443", options), "answered");
  EXPECT_EQ(of_host("other.example", options), "http.misdirected_request");
  options.allowed_hosts = {"*"};
  EXPECT_EQ(of_host("other.example", options), "answered");
}

TEST(Guard, RefusesPagesOfOtherSites) {
  for (const char* origin :
       {"http://localhost:8080", "https://localhost:8080", "http://127.0.0.1:5173", "http://[::1]:3000"}) {
    EXPECT_EQ(of_origin(origin), "answered") << origin;
  }
  for (const char* origin : {"https://evil.example", "null", "http://localhost.evil.example", "file://localhost",
                             "http://localhost@evil.example"}) {
    EXPECT_EQ(of_origin(origin), "http.cross_origin") << origin;
  }
  GuardOptions options;
  options.allowed_hosts = {"supple.example"};
  options.allowed_origins = {"https://Supple.example"};
  EXPECT_EQ(verdict(options, {"supple.example", "https://supple.example", "POST", ""}), "answered");
  EXPECT_EQ(of_origin("https://supple.example", options), "answered");
  EXPECT_EQ(of_origin("http://supple.example", options), "http.cross_origin");
}

TEST(Guard, BelievesABrowserThatTellsOfAnotherSite) {
  EXPECT_EQ(verdict({}, {"localhost", "", "POST", "cross-site"}), "http.cross_origin");
  EXPECT_EQ(verdict({}, {"localhost", "", "DELETE", "cross-site"}), "http.cross_origin");
  EXPECT_EQ(verdict({}, {"localhost", "", "GET", "cross-site"}), "answered");  // a link
  EXPECT_EQ(verdict({}, {"localhost", "", "POST", "same-origin"}), "answered");
}

/// A server that has keys.
class GuardOfKeys : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    gate_ = std::make_unique<access::Gate>(file_, access::Rule::where_keys_are);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  access::Token add(const std::string& scopes, int rate = 0) {
    access::NewKey key;
    key.name = access::random_hex(4);
    key.scopes = access::parse_scopes(scopes);
    key.requests_per_minute = rate;
    access::Token token;
    file_.change([&](auto& keys) { token = access::add_key(keys, key, access::Gate::system_time().date); });
    gate_ = std::make_unique<access::Gate>(file_, access::Rule::where_keys_are);
    return token;
  }

  using Headers = std::vector<std::pair<std::string, std::string>>;
  static Headers bearer(const access::Token& token) {
    return {{"Authorization", "Bearer " + access::token_text(token)}};
  }
  static std::string cookie(const std::string& session) {
    return "theme=dark; " + std::string(session_cookie) + "=" + session + "; other=1";
  }

  std::string answer(const std::string& method, Headers headers, const std::string& pattern = "/v1/meshes",
                     bool open = false) {
    request_ = {};
    request_.method = method;
    request_.host = host_;
    request_.client = address_;
    request_.headers = std::move(headers);
    http::Route route;
    route.pattern = pattern;
    route.needs_no_key = open;
    try {
      make_guard({"127.0.0.1", {"supple.example"}, {}, gate_.get()})(request_, &route);
    } catch (const Error& error) {
      return error.code();
    }
    return "answered";
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("guard-" + access::random_hex(8));
  const access::KeyFile file_{folder_ / "keys"};
  std::unique_ptr<access::Gate> gate_;
  http::Request request_;
  std::string host_ = "localhost:8080";
  std::string address_ = "127.0.0.1";
};

TEST_F(GuardOfKeys, AnswersEverybodyWhereThereAreNone) {
  EXPECT_EQ(answer("DELETE", {}), "answered");
  EXPECT_TRUE(request_.is_admin);
  EXPECT_EQ(request_.client, "127.0.0.1");
  EXPECT_EQ(request_.key, "");
}

TEST_F(GuardOfKeys, NamesTheClientByItsKey) {
  const auto token = add("read,compute");
  EXPECT_EQ(answer("POST", bearer(token)), "answered");
  EXPECT_EQ(request_.key, token.id);
  EXPECT_EQ(request_.client, "key " + token.id);
  EXPECT_FALSE(request_.is_admin);
  EXPECT_EQ(answer("POST", bearer(add("admin"))), "answered");
  EXPECT_TRUE(request_.is_admin);
}

TEST_F(GuardOfKeys, AsksForReadWhereNothingChangesAndForComputeElsewhere) {
  const auto reader = add("read");
  const auto computer = add("compute");
  for (const char* method : {"GET", "HEAD"}) {
    EXPECT_EQ(answer(method, bearer(reader)), "answered");
    EXPECT_EQ(answer(method, bearer(computer)), "access.scope");
  }
  for (const char* method : {"POST", "DELETE", "PUT"}) {
    EXPECT_EQ(answer(method, bearer(computer)), "answered");
    EXPECT_EQ(answer(method, bearer(reader)), "access.scope");
    EXPECT_EQ(request_.key, reader.id) << "the log knows who was refused";
  }
}

TEST_F(GuardOfKeys, OpenRoutesAloneNeedNone) {
  add("read");
  EXPECT_EQ(answer("GET", {}), "access.key_required");
  EXPECT_EQ(answer("GET", {{"Authorization", "Bearer nonsense"}}), "access.key_invalid");
  EXPECT_EQ(answer("GET", {}, "/healthz", true), "answered");
  EXPECT_EQ(answer("GET", {{"Authorization", "Bearer nonsense"}}, "/healthz", true), "answered");
}

TEST_F(GuardOfKeys, MetricsNeedNoneOnTheMachineItselfButThroughAProxy) {
  const auto token = add("read");
  EXPECT_EQ(answer("GET", {}, "/metrics"), "answered");
  EXPECT_EQ(answer("GET", {{"X-Forwarded-For", "10.0.0.1"}}, "/metrics"), "access.key_required");
  EXPECT_EQ(answer("GET", {{"Via", "1.1 proxy"}}, "/metrics"), "access.key_required");
  host_ = "supple.example";
  EXPECT_EQ(answer("GET", {}, "/metrics"), "access.key_required");
  EXPECT_EQ(answer("GET", bearer(token), "/metrics"), "answered");
  host_ = "localhost";
  address_ = "10.0.0.1";
  EXPECT_EQ(answer("GET", {}, "/metrics"), "access.key_required");
}

TEST_F(GuardOfKeys, ACookieCountsForPagesOfThisServerAlone) {
  const auto token = add("read,compute");
  const auto session = cookie(gate_->sign_in(access::token_text(token)).token);
  const std::string own = "http://localhost:8080";
  EXPECT_EQ(answer("GET", {{"Cookie", session}}), "answered");
  EXPECT_EQ(request_.key, token.id);
  EXPECT_EQ(answer("POST", {{"Cookie", session}, {"Origin", own}}), "answered");
  EXPECT_EQ(answer("POST", {{"Cookie", session}, {"Sec-Fetch-Site", "same-origin"}}), "answered");
  // A page of another port is somebody else's, and so may be a request without an origin.
  EXPECT_EQ(answer("POST", {{"Cookie", session}, {"Origin", "http://localhost:3000"}}), "access.key_required");
  EXPECT_EQ(answer("POST", {{"Cookie", session}, {"Sec-Fetch-Site", "same-site"}}), "access.key_required");
  EXPECT_EQ(answer("POST", {{"Cookie", session}}), "access.key_required");
  EXPECT_EQ(answer("GET", {{"Cookie", session}, {"Sec-Fetch-Site", "cross-site"}}), "access.key_required");
  EXPECT_EQ(answer("GET", {{"Cookie", cookie("0")}}), "access.key_invalid");
  EXPECT_EQ(answer("GET", {{"Cookie", "xsupple_session=1"}}), "access.key_required");
}

TEST_F(GuardOfKeys, CountsTheRequestsOfAKey) {
  const auto token = add("read", 2);
  EXPECT_EQ(answer("GET", bearer(token)), "answered");
  EXPECT_EQ(answer("POST", bearer(token)), "access.scope");
  EXPECT_EQ(answer("GET", bearer(token)), "access.rate");
}

}  // namespace
}  // namespace supple::routes
