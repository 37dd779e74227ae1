// The documented examples of api/examples, asked of the routes without a connection. api/examples/README.md says what
// their fields mean.

#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <thread>

#include "support/temporary_folder.h"
#include "unit/server/routes/router_fixture.h"

namespace supple::routes {
namespace {

using Document = nlohmann::json;
using Saved = std::map<std::string, std::string>;

/// The text with every {{name}} replaced by what an earlier step saved.
std::string filled(std::string text, const Saved& saved) {
  for (const auto& [name, value] : saved) {
    const auto mark = "{{" + name + "}}";
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
      text.replace(at, mark.size(), value);
  }
  return text;
}

bool has_type(const std::string& type, const Document& actual) {
  if (type == "$any") return true;
  if (type == "$number") return actual.is_number();
  if (type == "$integer") return actual.is_number_integer();
  if (type == "$array") return actual.is_array();
  return actual.is_string();
}

/// Empty if it matches, otherwise where it does not.
std::string difference(const Document& expected, const Document& actual, double tolerance,
                       const std::string& where = {}) {
  const auto fails = [&] { return where + " is " + actual.dump().substr(0, 200) + ", not " + expected.dump(); };
  if (expected.is_string() && expected.get<std::string>().starts_with('$'))
    return has_type(expected, actual) ? "" : fails();
  if (expected.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      if (!actual.is_object() || !actual.contains(key)) return where + "/" + key + " is missing";
      if (auto fault = difference(value, actual.at(key), tolerance, where + "/" + key); !fault.empty()) return fault;
    }
    return {};
  }
  if (expected.is_array()) {
    if (!actual.is_array() || actual.size() != expected.size()) return fails();
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (auto fault = difference(expected[i], actual[i], tolerance, where + "/" + std::to_string(i)); !fault.empty())
        return fault;
    return {};
  }
  if (!expected.is_number()) return actual == expected ? "" : fails();
  const auto wanted = expected.get<double>();
  return actual.is_number() && std::abs(actual.get<double>() - wanted) <= tolerance * std::max(1.0, std::abs(wanted))
             ? ""
             : fails();
}

class Examples : public RouterTest, public ::testing::WithParamInterface<std::string> {
 protected:
  static std::string folder() { return SUPPLE_SOURCE_DIR "/api/examples/"; }

  static std::string body_of(const Document& step, const Saved& saved) {
    if (step.contains("file")) {
      auto body = testing::bytes_of(folder() + step["file"].get<std::string>());
      if (!step.contains("body")) return body;
      auto document = Document::parse(body);
      document.update(Document::parse(filled(step["body"].dump(), saved)));
      return document.dump();
    }
    if (step.contains("text")) return filled(step["text"].get<std::string>(), saved);
    return step.contains("body") ? filled(step["body"].dump(), saved) : std::string();
  }

  /// An object in a step; an empty one where the step has none.
  static const Document& object_of(const Document& step, const char* name) {
    static const Document none = Document::object();
    return step.contains(name) ? step.at(name) : none;
  }

  static Answer send(const Document& step, const Saved& saved) {
    Headers headers;
    for (const auto& [name, value] : object_of(step, "headers").items())
      headers.emplace_back(name, filled(value.get<std::string>(), saved));
    return ask(step["method"], filled(step["path"], saved), body_of(step, saved), headers);
  }

  /// Sends the request again until the answer has the value that the step waits for.
  static Answer send_until_done(const Document& step, const Saved& saved) {
    auto answer = send(step, saved);
    if (!step.contains("repeat_until")) return answer;
    const Document::json_pointer pointer(step["repeat_until"]["pointer"].get<std::string>());
    while (answer.json().at(pointer) != step["repeat_until"]["value"]) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      answer = send(step, saved);
    }
    return answer;
  }

  static void run(const Document& step, Saved& saved) {
    SCOPED_TRACE(step["name"]);
    const auto answer = send_until_done(step, saved);
    const auto& status = step["status"];
    ASSERT_TRUE(status.is_array() ? std::find(status.begin(), status.end(), answer.status) != status.end()
                                  : status == answer.status)
        << answer.status << " " << answer.body.substr(0, 1000);
    if (step.contains("response")) {
      EXPECT_EQ(difference(Document::parse(filled(step["response"].dump(), saved)), answer.json(),
                           step.value("tolerance", 1e-9)),
                "");
    }
    for (const auto& [name, value] : object_of(step, "response_headers").items()) {
      if (name == "Content-Length") continue;  // it is http's
      EXPECT_EQ(difference(filled(value.get<std::string>(), saved), answer.header(name), 0, name), "");
    }
    EXPECT_NE(answer.body.find(filled(step.value("response_text", ""), saved)), std::string::npos);
    for (const auto& [name, pointer] : object_of(step, "save").items())
      saved[name] = answer.json().at(Document::json_pointer(pointer.get<std::string>()));
  }
};

TEST_P(Examples, RunAsDocumented) {
  Saved saved;
  const auto example = Document::parse(testing::bytes_of(folder() + GetParam() + ".json"));
  for (const auto& step : example.at("steps")) run(step, saved);
}

std::vector<std::string> names() {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(SUPPLE_SOURCE_DIR "/api/examples"))
    if (entry.path().extension() == ".json") found.push_back(entry.path().stem().string());
  std::sort(found.begin(), found.end());
  return found;
}

INSTANTIATE_TEST_SUITE_P(OfTheContract, Examples, ::testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  std::erase(name, '-');
  return name;
});

}  // namespace
}  // namespace supple::routes
