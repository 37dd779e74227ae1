#include "supple/routes/guard.h"

#include <gtest/gtest.h>

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
    make_guard(options)(request);
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

}  // namespace
}  // namespace supple::routes
