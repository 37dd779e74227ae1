#include "supple/store/records.h"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "hasher.h"

namespace supple::store {
namespace {

constexpr std::array<std::string_view, 5> state_names{"accepted", "running", "successful", "failed", "dismissed"};

}  // namespace

std::string_view state_name(JobState state) { return state_names[static_cast<std::size_t>(state)]; }

std::optional<JobState> state_of(std::string_view name) {
  const auto found = std::find(state_names.begin(), state_names.end(), name);
  if (found == state_names.end()) return std::nullopt;
  return static_cast<JobState>(found - state_names.begin());
}

std::string random_id() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) throw std::runtime_error("no random bytes");
  return hexadecimal_text(bytes);
}

}  // namespace supple::store
