#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "supple/json/answers.h"
#include "supple/json/model_answers.h"
#include "supple/problem/problem.h"
#include "supple/routes/routes.h"
#include "supple/store/local_store.h"
#include "support/test_calibration.h"
#include "support/test_model.h"

namespace supple::routes {

using Headers = std::vector<std::pair<std::string, std::string>>;

/// An answer as a client gets it.
struct Answer {
  int status = 0;
  std::string body;
  Headers headers;

  /// The value of a header; empty if there is none.
  std::string header(std::string_view name) const {
    for (const auto& [key, value] : headers)
      if (key == name) return value;
    return {};
  }
  nlohmann::json json() const { return nlohmann::json::parse(body); }
  /// The code of a problem; empty for other answers.
  std::string code() const { return status < 400 ? std::string() : json().value("code", ""); }
  /// The pointers of a problem, each after a blank.
  std::string pointers() const {
    std::string text;
    for (const auto& error : json().value("errors", nlohmann::json::array()))
      text += " " + error.at("pointer").get<std::string>();
    return text;
  }
};

/// All routes over a store in a folder of its own, with the untrained model ih21 and without connections.
class RouterTest : public ::testing::Test {
 protected:
  /// Everything that the routes use, made once for all tests of a program, which leave it as they find it.
  struct Parts {
    Parts() {
      std::string pattern = (std::filesystem::temp_directory_path() / "supple_routes_XXXXXX").string();
      folder = mkdtemp(pattern.data());
      auto model = test::test_model("ih21", 1);
      model.calibration = test::test_calibration(model.network.shape.parameters);
      std::filesystem::create_directories(folder / "models");
      std::filesystem::create_directories(folder / "web" / "assets");
      neural::write_model(folder / "models" / "ih21.h5", model);
      std::ofstream(folder / "web" / "index.html") << "<html>";
      std::ofstream(folder / "web" / ".hidden") << "no";
      std::ofstream(folder / "web" / "assets" / "index-1f.js") << "let a;";
      models = std::make_unique<store::ModelStore>(
          store::ModelStore::Options{.folder = folder / "models",
                                     .describe = json::write_model,
                                     .log = [](store::ModelStore::Level, const std::string&) {}});
      models->wait_until_read();
      store = std::make_unique<store::LocalStore>(folder / "data");
      meshes = std::make_unique<store::MeshCache>(store->meshes(), 1 << 30);
      jobs = std::make_unique<jobs::JobQueue>(*store, jobs::QueueOptions{}, json::write_problem,
                                              [](const store::JobRecord&) {});
      services.version = "0.0.0";
      services.data = (folder / "data").string();
      services.web = (folder / "web").string();
      services.metrics = &metrics;
      services.store = store.get();
      services.meshes = meshes.get();
      services.models = models.get();
      services.jobs = jobs.get();
      services.ready = true;
      router = make_router(services);
    }

    ~Parts() {
      jobs.reset();
      store.reset();
      std::filesystem::remove_all(folder);
    }

    std::filesystem::path folder;
    metrics::Metrics metrics{"0.0.0"};
    std::unique_ptr<store::ModelStore> models;
    std::unique_ptr<store::Store> store;
    std::unique_ptr<store::MeshCache> meshes;
    std::unique_ptr<jobs::JobQueue> jobs;
    Services services;
    http::Router router;
  };
  static Parts& parts() {
    static Parts all;
    return all;
  }

  class Collector final : public http::StreamWriter {
   public:
    bool write(std::string_view text) override {
      collected += text;
      return true;
    }
    bool client_gone() override { return false; }
    std::string collected;
  };

  static void read_target(const std::string& target, http::Request& request) {
    const auto question = std::min(target.find('?'), target.size());
    request.path = target.substr(0, question);
    for (auto begin = question + 1; begin < target.size();) {
      const auto end = std::min(target.find('&', begin), target.size());
      const auto parameter = target.substr(begin, end - begin);
      const auto equals = parameter.find('=');
      request.query[parameter.substr(0, equals)] = parameter.substr(equals + 1);
      begin = end + 1;
    }
  }

  /// A body without a Content-Type is JSON. `key` is the id of the request's key, which is no administrator's; empty:
  /// none is needed.
  static Answer ask(const std::string& method, const std::string& target, const std::string& body = {},
                    const Headers& headers = {}, const std::string& key = {}) {
    auto& [folder, metrics, models, store, meshes, jobs, services, router] = parts();
    http::Request request;
    request.method = method;
    read_target(target, request);
    request.body = body;
    request.headers = headers;
    request.key = key;
    request.is_admin = key.empty();
    if (!body.empty() && request.header("Content-Type").empty())
      request.headers.emplace_back("Content-Type", "application/json");
    http::Response response;
    std::string pattern;
    try {
      auto match = router.find(method, request.path);
      pattern = match.route->pattern;
      request.path_parameters = std::move(match.path_parameters);
      response = match.route->handler(request);
    } catch (...) {
      response = problem_response(problem::problem_of(std::current_exception()));
    }
    metrics.count_request(pattern, method, response.status, 0);
    Answer answer{response.status, response.body, response.headers};
    answer.headers.emplace_back("Content-Type", response.content_type);
    if (response.piecewise_body) {
      answer.body.resize(response.piecewise_body->bytes);
      response.piecewise_body->read(0, answer.body.data(), answer.body.size());
    }
    if (response.stream) {
      Collector collector;
      response.stream(collector);
      answer.body = std::move(collector.collected);
    }
    return answer;
  }

  static Answer post(const std::string& path, const nlohmann::json& body, const Headers& headers = {}) {
    return ask("POST", path, body.dump(), headers);
  }
  static Answer get(const std::string& target, const Headers& headers = {}) { return ask("GET", target, {}, headers); }

  /// The id of a square of two triangles: the vertices 0 to 3 are (0, 0), (1, 0), (1, 1) and (0, 1).
  static std::string square() {
    static const auto id = post("/v1/meshes", nlohmann::json::parse(R"({"vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],
                                                     "faces":[[0,1,2],[0,2,3]]})"))
                               .json()
                               .at("id")
                               .get<std::string>();
    return id;
  }
};

}  // namespace supple::routes
