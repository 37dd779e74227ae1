#pragma once

#include <httplib.h>

#include <string>
#include <string_view>
#include <utility>

namespace supple::http {

/// Sends as much of the text as the client takes now, and removes it. False once the client has gone.
bool send_now(int socket, std::string_view& text);

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
  /// From here on `write` and `flush` never wait for the client: what it does not take at once is left to
  /// `take_unsent`.
  void never_wait() { never_waits_ = true; }
  /// What `flush` has left. The caller takes it.
  std::string take_unsent() { return std::move(waiting_); }
  /// From here on what is written is dropped, as if it had been sent.
  void drop() { drops_ = true; }
  /// From here on nothing waits: pieces of a streamed answer are sent as they come.
  void send_at_once() { at_once_ = true; }
  /// Sends what waits. False once the client has gone.
  bool flush();
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  /// The library compares this with the limits of select(2), which this stream does not use.
  socket_t socket() const override { return 0; }

 private:
  bool send_all(std::string_view text);

  int socket_;
  double write_seconds_;
  std::string_view head_;
  bool at_once_ = false;
  bool drops_ = false;
  bool never_waits_ = false;
  std::string waiting_;
};

}  // namespace supple::http
