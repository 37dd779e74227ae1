#pragma once

#include <httplib.h>

#include <string>
#include <string_view>
#include <utility>

namespace supple::http {

/// Sends, and removes from `text`, what the client takes without waiting. Returns false if it has gone.
bool send_now(int socket, std::string_view& text);

/// The stream from which httplib reads a head that has arrived already, and to which it writes the answer.
class ConnectionStream final : public httplib::Stream {
 public:
  ConnectionStream(int socket, double write_seconds, std::string_view head)
      : socket_(socket), write_seconds_(write_seconds), head_(head) {}

  bool is_readable() const override { return !head_.empty(); }
  bool is_writable() const override;
  ssize_t read(char* data, std::size_t size) override;
  /// Sends everything, or returns -1. A small answer is buffered until `flush`, so that it leaves in one packet and
  /// after the request's slot has been released.
  ssize_t write(const char* data, std::size_t size) override;
  /// From now on `write` and `flush` never wait for the client. What it does not take at once stays in the buffer.
  void never_wait() { never_waits_ = true; }
  /// Moves out what `flush` could not send.
  std::string take_unsent() { return std::move(buffered_); }
  /// From now on whatever is written is discarded, as if it had been sent.
  void drop() { drops_ = true; }
  /// From now on nothing is buffered: the pieces of a streamed answer are sent as they are written.
  void send_at_once() { at_once_ = true; }
  /// Sends what is buffered. Returns false if the client has gone.
  bool flush();
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  /// A number that satisfies the library, which checks the limits of select(2); this stream uses poll(2).
  socket_t socket() const override { return 0; }

 private:
  bool send_all(std::string_view text);

  int socket_;
  double write_seconds_;
  std::string_view head_;
  bool at_once_ = false;
  bool drops_ = false;
  bool never_waits_ = false;
  std::string buffered_;
};

}  // namespace supple::http
