#include "supple/routes/audit.h"

#include <gtest/gtest.h>

#include <vector>

namespace supple::routes {
namespace {

http::AnsweredRequest answered(const std::string& method, const std::string& path, int status) {
  http::AnsweredRequest answered;
  answered.id = "00000000000000a1";
  answered.address = "127.0.0.1";
  answered.key = "0123456789ab";
  answered.method = method;
  answered.path = path;
  answered.pattern = path;
  answered.status = status;
  return answered;
}

TEST(Audit, SaysWhoMadeAndDeletedWhat) {
  auto made = answered("POST", "/v1/meshes", 201);
  made.location = "/v1/meshes/abc";
  EXPECT_EQ(audit_line(made),
            "audit 00000000000000a1 key=0123456789ab address=127.0.0.1 action=create method=POST "
            "object=/v1/meshes/abc status=201");
  EXPECT_EQ(audit_line(answered("DELETE", "/v1/jobs/1", 204)),
            "audit 00000000000000a1 key=0123456789ab address=127.0.0.1 action=delete method=DELETE "
            "object=/v1/jobs/1 status=204");
}

TEST(Audit, SaysWhoWasRefusedAndWhoSignedIn) {
  const auto has = [](const http::AnsweredRequest& one, const std::string& text) {
    return audit_line(one).find(text) != std::string::npos;
  };
  EXPECT_TRUE(has(answered("GET", "/v1/meshes", 401), "action=refused"));
  EXPECT_TRUE(has(answered("POST", "/v1/geodesics", 403), "action=refused"));
  EXPECT_TRUE(has(answered("POST", "/v1/session", 200), "action=sign-in "));
  EXPECT_TRUE(has(answered("POST", "/v1/session", 401), "action=sign-in-refused "));
  EXPECT_TRUE(has(answered("DELETE", "/v1/session", 204), "action=sign-out "));
}

TEST(Audit, IsSilentAboutWhatOnlyReadsOrComputes) {
  EXPECT_EQ(audit_line(answered("GET", "/v1/meshes", 200)), "");
  EXPECT_EQ(audit_line(answered("POST", "/v1/geodesics", 200)), "");
  EXPECT_EQ(audit_line(answered("DELETE", "/v1/jobs/1", 404)), "");
  EXPECT_EQ(audit_line(answered("GET", "/v1/meshes/x", 500)), "");
}

TEST(Audit, CountsRefusalsWhereThereAreTooManyForALineEach) {
  std::vector<std::string> lines;
  AuditLog log([&](const std::string& line) { lines.push_back(line); });
  const AuditLog::Clock::time_point start = AuditLog::Clock::now();
  for (int i = 0; i < 1000; ++i) log.note(answered("GET", "/v1/meshes", 401), start);
  EXPECT_EQ(lines.size(), 20U);
  log.note(answered("DELETE", "/v1/jobs/1", 204), start);
  ASSERT_EQ(lines.size(), 21U) << "what was done always has its line";
  log.note(answered("GET", "/v1/meshes", 401), start + std::chrono::seconds(1));
  ASSERT_EQ(lines.size(), 23U);
  EXPECT_EQ(lines[21], "audit 980 refusals more than the lines above say");
}

TEST(Audit, StaysOneLineWhateverTheRequest) {
  auto forged = answered("GET", "/v1/x\naudit key=admin", 401);
  forged.key.clear();
  const auto line = audit_line(forged);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_NE(line.find("object=/v1/x?audit?key=admin "), std::string::npos) << line;
  EXPECT_NE(line.find("key=- "), std::string::npos) << line;
  EXPECT_EQ(plain_text(std::string(1000, 'x')).size(), 200U);
}

}  // namespace
}  // namespace supple::routes
