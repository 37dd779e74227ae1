#pragma once

#include <httplib.h>

#include <array>
#include <chrono>
#include <string>

namespace supple::http {

/// httplib's view of one accepted connection, for all of its requests.
///
/// Differs from the library's own stream: bytes read ahead survive to the next request (pipelining), the time that a
/// request may take to arrive is bounded as a whole and not for each read, and so is the size of its head, which the
/// library reads without end.
class ConnectionStream final : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t max_head_bytes = 64 * 1024;

  ConnectionStream(int socket, double write_seconds) : socket_(socket), write_seconds_(write_seconds) {}

  /// Starts a request: its bytes must arrive before `deadline`.
  void begin_request(Clock::time_point deadline);
  /// The head has been read; what follows is bounded by the route's body limit.
  void head_is_complete() { reading_head_ = false; }
  bool has_buffered_input() const { return begin_ < end_; }
  /// Reads and discards what the client still sends, so that closing does not destroy the answer on its way.
  void linger(double seconds);

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* data, std::size_t size) override;
  /// Sends everything or fails (-1). The first piece of an answer, its head, waits for the second so that small answers
  /// leave in one packet.
  ssize_t write(const char* data, std::size_t size) override;
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
  Clock::time_point deadline_{};
  bool reading_head_ = true;
  std::size_t head_bytes_ = 0;
  std::array<char, 16 * 1024> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool answer_has_begun_ = false;
  std::string waiting_;
};

}  // namespace supple::http
