#include "supple/base/faults.h"

#include <utility>

namespace supple {

void Faults::add(std::string where, std::string message) {
  ++total_;
  if (details_.size() < max_details) details_.push_back({std::move(where), std::move(message)});
}

std::string Faults::sentence(const std::string& whole) const {
  const Error::Detail& first = details_.front();
  std::string sentence = (first.where.empty() ? whole : first.where) + ": " + first.message;
  if (total_ > 1) sentence += " (and " + std::to_string(total_ - 1) + " more)";
  return sentence;
}

}  // namespace supple
