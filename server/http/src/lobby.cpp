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
constexpr std::chrono::milliseconds period{50};        // between two looks at the deadlines
constexpr std::chrono::milliseconds idle_period{500};  // and where nobody waits
constexpr std::chrono::seconds moment{1};              // in which the first bytes of a new connection are due

}  // namespace

Lobby::Lobby(Connection::Admit admit, Deliver deliver)
    : admit_(std::move(admit)),
      deliver_(std::move(deliver)),
      poll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = wake_;
  if (poll_ < 0 || wake_ < 0 || ::epoll_ctl(poll_, EPOLL_CTL_ADD, wake_, &event) != 0) {
    throw std::runtime_error("the system gives no epoll or eventfd");
  }
  thread_ = std::thread([this] { run(); });
}

// The descriptors stay open until here, because threads that answer give connections back while the lobby stops. A
// number that is closed earlier may be that of another file by the time such a thread writes to it.
Lobby::~Lobby() {
  stop();
  ::close(wake_);
  ::close(poll_);
}

void Lobby::take(std::shared_ptr<Connection> connection) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    taken_.push_back(std::move(connection));
  }
  ::eventfd_write(wake_, 1);
}

bool Lobby::make_room(const std::string& client) {
  std::unique_lock lock(mutex_);
  room_asked_for_ = client;
  closed_one_ = false;
  ::eventfd_write(wake_, 1);
  room_made_.wait(lock, [this] { return stopping_ || !room_asked_for_; });
  return closed_one_;
}

Connection::Clock::duration Lobby::silence() const {
  return Connection::Clock::now().time_since_epoch() - looked_at_.load();
}

void Lobby::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    taken_.clear();
  }
  room_made_.notify_all();
  ::eventfd_write(wake_, 1);
  if (thread_.joinable()) thread_.join();
}

void Lobby::run() {
  std::array<epoll_event, max_events> events{};
  auto next_look = Connection::Clock::now() + period;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_look - Connection::Clock::now()).count();
    const int wait = waiting_.empty() ? static_cast<int>(idle_period.count())
                                      : static_cast<int>(std::clamp<std::int64_t>(left, 0, period.count()));
    const int ready = ::epoll_wait(poll_, events.data(), max_events, wait);
    looked_at_ = Connection::Clock::now().time_since_epoch();
    for (int i = 0; i < ready; ++i) {
      const int socket = events.at(static_cast<std::size_t>(i)).data.fd;
      if (socket == wake_) {
        eventfd_t count = 0;
        ::eventfd_read(wake_, &count);
      } else if (const auto found = waiting_.find(socket); found != waiting_.end()) {
        look_at(*found->second);
      }
    }
    std::vector<std::shared_ptr<Connection>> taken;
    std::optional<std::string> asked;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) break;
      taken.swap(taken_);
      asked = room_asked_for_;
    }
    for (auto& connection : taken) add(std::move(connection));
    // After those that came before: one of them may be the one to go.
    if (asked) {
      const bool closed = close_one(*asked);
      const std::lock_guard lock(mutex_);
      closed_one_ = closed;
      room_asked_for_.reset();
      room_made_.notify_all();
    }
    if (Connection::Clock::now() >= next_look) {
      close_expired();
      next_look = Connection::Clock::now() + period;
    }
  }
  waiting_.clear();
}

void Lobby::add(std::shared_ptr<Connection> connection) {
  const int socket = connection->socket();
  epoll_event event{};
  event.events = connection->sending() ? EPOLLOUT : EPOLLIN;
  event.data.fd = socket;
  if (::epoll_ctl(poll_, EPOLL_CTL_ADD, socket, &event) != 0) return;
  auto& placed = *waiting_.emplace(socket, std::move(connection)).first->second;
  // Bytes that were read ahead tell the system nothing any more.
  if (placed.has_input() || !placed.lingering()) look_at(placed);
}

bool Lobby::send_more(Connection& connection) {
  const auto sent = connection.send_more();
  if (sent == Connection::Sent::failed) hand_over(connection.socket(), Connection::Arrival::closed);
  if (sent != Connection::Sent::all) return false;
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = connection.socket();
  ::epoll_ctl(poll_, EPOLL_CTL_MOD, connection.socket(), &event);
  if (connection.sends_last()) {
    connection.linger();
  } else {
    connection.begin_next();
  }
  return true;
}

void Lobby::look_at(Connection& connection) {
  if (connection.sending() && !send_more(connection)) return;
  if (connection.lingering()) {
    if (!connection.discard()) hand_over(connection.socket(), Connection::Arrival::closed);
    return;
  }
  const auto arrival = connection.advance(admit_);
  if (arrival != Connection::Arrival::waiting) hand_over(connection.socket(), arrival);
}

void Lobby::hand_over(int socket, Connection::Arrival arrival) {
  ::epoll_ctl(poll_, EPOLL_CTL_DEL, socket, nullptr);
  const auto found = waiting_.find(socket);
  auto connection = std::move(found->second);
  waiting_.erase(found);
  if (arrival != Connection::Arrival::closed) deliver_(std::move(connection), arrival);
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
    return connection.idle() && now - connection.waits_since() > moment ? 1 : 2;
  };
  const auto is_before = [&](const Connection& a, const Connection& b) {
    if (rank(a) != rank(b)) return rank(a) < rank(b);
    const int of_a = rank(a) < 2 ? 0 : connections[a.client()];
    const int of_b = rank(b) < 2 ? 0 : connections[b.client()];
    return of_a != of_b ? of_a > of_b : a.waits_since() < b.waits_since();
  };
  Connection* chosen = nullptr;
  for (const auto& [socket, connection] : waiting_) {
    if (!client.empty() && connection->client() != client) continue;
    if (!chosen || is_before(*connection, *chosen)) chosen = connection.get();
  }
  if (chosen) hand_over(chosen->socket(), Connection::Arrival::closed);
  return chosen != nullptr;
}

}  // namespace supple::http
