#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>

namespace supple::store {

/// A socket in place of a database: the system accepts connections to it, but nobody answers them.
class SilentDatabase {
 public:
  /// Listens at a port of this machine.
  SilentDatabase() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    listen_at(address);
    socklen_t size = sizeof address;
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  /// Listens at the socket that PostgreSQL would have in this folder, which is made.
  explicit SilentDatabase(const std::filesystem::path& folder)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    std::filesystem::create_directories(folder);
    const auto path = (folder / ".s.PGSQL.5432").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    EXPECT_LT(path.copy(address.sun_path, sizeof address.sun_path - 1), sizeof address.sun_path - 1);
    listen_at(address);
  }
  ~SilentDatabase() { ::close(socket_); }
  SilentDatabase(const SilentDatabase&) = delete;
  SilentDatabase& operator=(const SilentDatabase&) = delete;

  int port() const { return port_; }
  /// The next connection; the caller has to close it.
  int accept() const { return ::accept(socket_, nullptr, nullptr); }

 private:
  template <class Address>
  void listen_at(const Address& address) const {
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(socket_, 8), 0);
  }

  const int socket_;
  int port_ = 0;
};

}  // namespace supple::store
