#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "entity_tag.h"
#include "handlers.h"
#include "supple/store/store.h"

namespace supple::routes {
namespace {

constexpr const char* index_name = "index.html";
/// The folder of files whose names change with their content.
constexpr std::string_view hashed_folder = "/assets/";

struct MediaType {
  std::string_view extension;
  std::string_view type;
};
constexpr std::array media_types{
    MediaType{".html", "text/html; charset=utf-8"},
    MediaType{".js", "text/javascript; charset=utf-8"},
    MediaType{".css", "text/css; charset=utf-8"},
    MediaType{".json", "application/json"},
    MediaType{".svg", "image/svg+xml"},
    MediaType{".png", "image/png"},
    MediaType{".ico", "image/x-icon"},
    MediaType{".woff2", "font/woff2"},
    MediaType{".txt", "text/plain; charset=utf-8"},
    MediaType{".obj", "model/obj"},
};

/// Scripts, styles and fonts come from this server only, and so do answers. Pictures may also be made by the page
/// itself. Styles are set by its scripts, never by attributes.
constexpr const char* content_security_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A file of the editor.
struct WebFile {
  std::string path;  ///< "/assets/index-4f2a.js"
  std::string media_type;
  std::string content;
  std::string tag;
  bool hashed = false;
};

std::string media_type_of(const std::filesystem::path& file) {
  for (const auto& entry : media_types) {
    if (file.extension() == entry.extension) return std::string(entry.type);
  }
  return "application/octet-stream";
}

std::string read_content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return content;
}

/// Every regular file below the folder, except names that begin with a dot, which are private, or with a brace, which
/// would be a pattern of a route.
std::vector<WebFile> read_folder(const std::filesystem::path& folder) {
  std::vector<WebFile> files;
  auto entries = std::filesystem::recursive_directory_iterator(folder);
  for (const auto& entry : entries) {
    const auto name = entry.path().filename().string();
    if (name.starts_with('.') || name.starts_with('{')) {
      entries.disable_recursion_pending();
      continue;
    }
    if (!entry.is_regular_file()) continue;
    WebFile file;
    file.path = "/" + entry.path().lexically_relative(folder).generic_string();
    file.media_type = media_type_of(entry.path());
    file.content = read_content(entry.path());
    file.tag = store::sha256(file.content).substr(0, 32);
    file.hashed = file.path.starts_with(hashed_folder);
    files.push_back(std::move(file));
  }
  return files;
}

http::Response send(const WebFile& file, const http::Request& request) {
  if (!request.query.empty()) {
    throw Error("request.invalid_parameter", "There is no query parameter " + request.query.begin()->first + " here.");
  }
  http::Response response;
  if (matches(request.header("If-None-Match"), file.tag)) {
    response = not_modified(file.tag);
  } else {
    response.content_type = file.media_type;
    response.body = file.content;
    response.set_header("ETag", quoted(file.tag));
  }
  response.set_header("Cache-Control", file.hashed ? "public, max-age=31536000, immutable" : "no-cache");
  response.set_header("Content-Security-Policy", content_security_policy);
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Referrer-Policy", "no-referrer");
  return response;
}

}  // namespace

void add_web_routes(http::Router& router, const std::string& folder) {
  bool has_index = false;
  for (auto& content : read_folder(folder)) {
    const auto file = std::make_shared<const WebFile>(std::move(content));
    const auto add = [&](const std::string& path) {
      router.add({.method = "GET",
                  .pattern = path,
                  .handler = [file](const http::Request& request) { return send(*file, request); },
                  .body = {},
                  .needs_no_key = true});
    };
    add(file->path);
    if (file->path.substr(1) != index_name) continue;
    add("/");
    has_index = true;
  }
  if (!has_index) throw std::runtime_error("the folder " + folder + " of --web has no " + index_name);
}

}  // namespace supple::routes
