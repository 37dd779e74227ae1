#include "lobby.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <map>
#include <stdexcept>

namespace supple::http {
namespace {

constexpr int max_events = 256;
constexpr std::chrono::milliseconds deadline_period{50};  // time between two checks of the deadlines
constexpr std::chrono::milliseconds idle_wait{500};       // the same while no connection waits
constexpr std::chrono::seconds first_byte_grace{1};  // an idle connection is preferred for eviction after this time

}  // namespace

Lobby::Lobby(Connection::Admit admit, Deliver deliver)
    : admit_(std::move(admit)),
      deliver_(std::move(deliver)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = wake_event_;
  if (epoll_ < 0 || wake_event_ < 0 || ::epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_event_, &event) != 0) {
    throw std::runtime_error("the system gives no epoll or eventfd");
  }
  thread_ = std::thread([this] { run(); });
}

// The descriptors stay open until here, because other threads call `take` even after `stop`: by then the number of a
// closed `wake_event_` could belong to another file.
Lobby::~Lobby() {
  stop();
  ::close(wake_event_);
  ::close(epoll_);
}

void Lobby::take(std::shared_ptr<Connection> connection) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    incoming_.push_back(std::move(connection));
  }
  ::eventfd_write(wake_event_, 1);
}

bool Lobby::evict_one(const std::string& client) {
  std::unique_lock lock(mutex_);
  eviction_request_ = client;
  evicted_one_ = false;
  ::eventfd_write(wake_event_, 1);
  eviction_done_.wait(lock, [this] { return stopping_ || !eviction_request_; });
  return evicted_one_;
}

Connection::Clock::duration Lobby::silence() const {
  return Connection::Clock::now().time_since_epoch() - last_wake_.load();
}

void Lobby::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    incoming_.clear();
  }
  eviction_done_.notify_all();
  ::eventfd_write(wake_event_, 1);
  if (thread_.joinable()) thread_.join();
}

void Lobby::run() {
  std::array<epoll_event, max_events> events{};
  auto next_check = Connection::Clock::now() + deadline_period;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_check - Connection::Clock::now()).count();
    const int wait = waiting_.empty() ? static_cast<int>(idle_wait.count())
                                      : static_cast<int>(std::clamp<std::int64_t>(left, 0, deadline_period.count()));
    const int ready = ::epoll_wait(epoll_, events.data(), max_events, wait);
    last_wake_ = Connection::Clock::now().time_since_epoch();
    for (int i = 0; i < ready; ++i) {
      const int socket = events.at(static_cast<std::size_t>(i)).data.fd;
      if (socket == wake_event_) {
        eventfd_t count = 0;
        ::eventfd_read(wake_event_, &count);
      } else if (const auto found = waiting_.find(socket); found != waiting_.end()) {
        handle_ready(*found->second);
      }
    }
    std::vector<std::shared_ptr<Connection>> incoming;
    std::optional<std::string> requested;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) break;
      incoming.swap(incoming_);
      requested = eviction_request_;
    }
    for (auto& connection : incoming) add(std::move(connection));
    // The eviction follows the additions, since it may choose one of the added connections.
    if (requested) {
      const bool closed = close_one(*requested);
      const std::lock_guard lock(mutex_);
      evicted_one_ = closed;
      eviction_request_.reset();
      eviction_done_.notify_all();
    }
    if (Connection::Clock::now() >= next_check) {
      close_expired();
      next_check = Connection::Clock::now() + deadline_period;
    }
  }
  waiting_.clear();
}

void Lobby::add(std::shared_ptr<Connection> connection) {
  const int socket = connection->socket();
  epoll_event event{};
  event.events = connection->sending() ? EPOLLOUT : EPOLLIN;
  event.data.fd = socket;
  if (::epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &event) != 0) return;
  auto& placed = *waiting_.emplace(socket, std::move(connection)).first->second;
  // epoll reports nothing for bytes that have been received already.
  if (placed.has_input() || !placed.lingering()) handle_ready(placed);
}

bool Lobby::send_more(Connection& connection) {
  const auto sent = connection.send_more();
  if (sent == Connection::Sent::failed) hand_over(connection.socket(), Connection::Arrival::closed);
  if (sent != Connection::Sent::all) return false;
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = connection.socket();
  ::epoll_ctl(epoll_, EPOLL_CTL_MOD, connection.socket(), &event);
  if (connection.sends_last()) {
    connection.linger();
  } else {
    connection.begin_next();
  }
  return true;
}

void Lobby::handle_ready(Connection& connection) {
  if (connection.sending() && !send_more(connection)) return;
  if (connection.lingering()) {
    if (!connection.discard()) hand_over(connection.socket(), Connection::Arrival::closed);
    return;
  }
  const auto arrival = connection.advance(admit_);
  if (arrival != Connection::Arrival::waiting) hand_over(connection.socket(), arrival);
}

void Lobby::hand_over(int socket, Connection::Arrival arrival) {
  ::epoll_ctl(epoll_, EPOLL_CTL_DEL, socket, nullptr);
  const auto found = waiting_.find(socket);
  auto connection = std::move(found->second);
  waiting_.erase(found);
  if (arrival != Connection::Arrival::closed) deliver_(std::move(connection));
}

void Lobby::close_expired() {
  const auto now = Connection::Clock::now();
  std::vector<Connection*> expired;
  for (const auto& [socket, connection] : waiting_) {
    if (now >= connection->deadline()) expired.push_back(connection.get());
  }
  for (auto* const connection : expired) hand_over(connection->socket(), connection->expire());
}

bool Lobby::close_one(const std::string& client) {
  std::map<std::string, int> connections;
  for (const auto& [socket, connection] : waiting_) ++connections[connection->client()];
  const auto now = Connection::Clock::now();
  const auto rank = [now](const Connection& connection) {
    if (connection.lingering() || connection.sending()) return 0;
    return connection.idle() && now - connection.waiting_since() > first_byte_grace ? 1 : 2;
  };
  const auto is_evicted_before = [&](const Connection& a, const Connection& b) {
    if (rank(a) != rank(b)) return rank(a) < rank(b);
    const int count_a = rank(a) < 2 ? 0 : connections[a.client()];
    const int count_b = rank(b) < 2 ? 0 : connections[b.client()];
    return count_a != count_b ? count_a > count_b : a.waiting_since() < b.waiting_since();
  };
  Connection* chosen = nullptr;
  for (const auto& [socket, connection] : waiting_) {
    if (!client.empty() && connection->client() != client) continue;
    if (!chosen || is_evicted_before(*connection, *chosen)) chosen = connection.get();
  }
  if (chosen) hand_over(chosen->socket(), Connection::Arrival::closed);
  return chosen != nullptr;
}

}  // namespace supple::http
