#include "supple/http/router.h"

#include <gtest/gtest.h>

namespace supple::http {
namespace {

Router make_router() {
  Router router;
  for (const char* method : {"GET", "DELETE"}) router.add({method, "/v1/meshes/{mesh}", {}, {}});
  router.add({"GET", "/v1/meshes", {}, {}});
  router.add({"GET", "/v1/meshes/{mesh}/content", {}, {}});
  return router;
}

std::string code_of(std::string_view method, std::string_view path) {
  try {
    make_router().find(method, path);
  } catch (const Error& error) {
    return error.code();
  }
  return "found";
}

TEST(Router, ComparesSegmentsAndNamesParameters) {
  const auto router = make_router();
  const auto match = router.find("GET", "/v1/meshes/abc/content");
  EXPECT_EQ(match.route->pattern, "/v1/meshes/{mesh}/content");
  EXPECT_EQ(match.path_parameters.at("mesh"), "abc");
  EXPECT_EQ(router.find("GET", "/v1/meshes").route->pattern, "/v1/meshes");
}

TEST(Router, FindsNothingForPathsThatOnlyResembleOne) {
  for (const char* path :
       {"", "/", "v1/meshes", "/v1", "/v1/meshes/", "/v1/meshes/a/b", "/v1/meshes//content", "/v1/meshesx"}) {
    EXPECT_EQ(code_of("GET", path), "http.not_found") << path;
  }
}

TEST(Router, TellsAWrongMethodFromAWrongPath) {
  EXPECT_EQ(code_of("POST", "/v1/meshes/abc"), "http.method_not_allowed");
  EXPECT_EQ(make_router().allowed("/v1/meshes/abc"), "GET, DELETE");
}

TEST(Router, SaysWhichMethodsAPathTakes) {
  try {
    make_router().find("POST", "/v1/meshes/abc");
    FAIL() << "nothing was thrown";
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.problem().allowed_methods, "GET, DELETE");
    EXPECT_STREQ(error.what(), "/v1/meshes/abc does not take POST; it takes GET, DELETE.");
  }
}

TEST(Router, AnswersHeadWithTheRouteOfGet) { EXPECT_EQ(code_of("HEAD", "/v1/meshes"), "found"); }

}  // namespace
}  // namespace supple::http
