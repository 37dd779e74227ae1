#include "key.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "failure.h"
#include "session.h"
#include "style.h"

namespace supple::cli {
namespace {

std::string read_key_file(const std::string& path) {
  auto text = read_file(path);
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
  text.erase(std::find_if_not(text.rbegin(), text.rend(), blank).base(), text.end());
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), blank));
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    print_notice(fmt::format("others may read the key in {}; chmod 600 changes that", path));
  return text;
}

}  // namespace

std::string find_key(const std::string& key, const std::string& file) {
  auto found = key.empty() && !file.empty() ? read_key_file(file) : key;
  const auto plain = [](unsigned char c) { return (c < 0x80 && std::isalnum(c)) || c == '_'; };
  if (!std::all_of(found.begin(), found.end(), plain) || (found.empty() && !file.empty()))
    throw Failure(ExitCode::usage, fmt::format("{} holds no key of the form supple_ID_SECRET",
                                               key.empty() ? file : std::string("--key or SUPPLE_KEY")));
  return found;
}

}  // namespace supple::cli
