#pragma once

#include <httplib.h>

#include <string>
#include <string_view>

namespace supple::http {

/// httplib's view of a request that has arrived: its head to read, and the socket to write the answer to.
class ConnectionStream final : public httplib::Stream {
 public:
  ConnectionStream(int socket, double write_seconds, std::string_view head)
      : socket_(socket), write_seconds_(write_seconds), head_(head) {}

  bool is_readable() const override { return !head_.empty(); }
  bool is_writable() const override;
  ssize_t read(char* data, std::size_t size) override;
  /// Sends everything or fails (-1). A small answer waits for `flush`, so that it leaves in one packet, and once the
  /// server is done with it.
  ssize_t write(const char* data, std::size_t size) override;
  /// From here on nothing waits: pieces of a streamed answer are sent as they come.
  void send_at_once() { at_once_ = true; }
  /// Sends what waits. False once the client has gone.
  bool flush();
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  /// The library compares this with the limits of select(2), which this stream does not use.
  socket_t socket() const override { return 0; }

 private:
  bool send_all(const char* data, std::size_t size);

  int socket_;
  double write_seconds_;
  std::string_view head_;
  bool at_once_ = false;
  std::string waiting_;
};

}  // namespace supple::http
