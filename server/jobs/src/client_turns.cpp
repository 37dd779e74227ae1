#include "client_turns.h"

namespace supple::jobs {

int ClientTurns::running_of(const std::string& client, Priority priority) const {
  const auto found = running_.find({client, priority});
  return found == running_.end() ? 0 : found->second;
}

ClientTurns::Rank ClientTurns::rank_of(const std::string& client, Priority priority) const {
  const bool goes_first =
      priority == Priority::interactive && running_of(client, Priority::interactive) < max_first_of_client_;
  Rank rank{goes_first ? Priority::interactive : std::max(priority, Priority::normal), 0, priority};
  rank.running_of_client = priority == Priority::background
                               ? running_of(client, Priority::background)
                               : running_of(client, Priority::interactive) + running_of(client, Priority::normal);
  return rank;
}

void ClientTurns::begin(const std::string& client, Priority priority, bool others_wait) {
  ++running_[{client, priority}];
  if (priority == Priority::background) return;
  in_succession_ = priority == Priority::interactive && others_wait ? in_succession_ + 1 : 0;
}

void ClientTurns::end(const std::string& client, Priority priority) {
  if (const auto count = running_.find({client, priority}); --count->second == 0) running_.erase(count);
}

}  // namespace supple::jobs
