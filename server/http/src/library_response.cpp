#include "library_response.h"

#include <algorithm>
#include <string>
#include <utility>

#include "supple/base/cancellation.h"

namespace supple::http {
namespace {

class ChunkWriter final : public StreamWriter {
 public:
  ChunkWriter(httplib::DataSink& sink, Peer peer) : sink_(sink), peer_(peer) {}
  bool write(std::string_view text) override {
    return gone_ ? false : !(gone_ = peer_.hung_up() || !sink_.write(text.data(), text.size()));
  }
  bool client_gone() override { return gone_ || (gone_ = peer_.hung_up()); }

 private:
  httplib::DataSink& sink_;
  Peer peer_;
  bool gone_ = false;
};

/// Sends all pieces in one call, because between two calls the library would cut the answer off if the server stops.
/// Returns false if a piece cannot be sent.
bool send_piecewise(const PiecewiseBody& body, std::size_t offset, std::size_t count, httplib::DataSink& sink) {
  constexpr std::size_t piece = 256 * 1024;
  std::string buffer(std::min(piece, count), '\0');
  for (const auto end = offset + count; offset < end;) {
    const auto bytes = std::min(piece, end - offset);
    body.read(offset, buffer.data(), bytes);
    if (!sink.write(buffer.data(), bytes)) return false;
    offset += bytes;
  }
  return true;
}

/// Returns false, which cuts the answer off, if `send` does or if it throws.
template <class Send>
bool send_or_cut_off(const std::function<void(const std::exception_ptr&)>& report, const Send& send) {
  try {
    return send();
  } catch (const Cancelled&) {
    return false;
  } catch (...) {
    report(std::current_exception());
    return false;
  }
}

}  // namespace

void fill_response(httplib::Response& target, Response response, ConnectionStream& stream, Peer peer,
                   std::function<void(const std::exception_ptr&)> report) {
  target.status = response.status;
  for (auto& [name, value] : response.headers) target.set_header(name, value);
  if (response.stream) {
    stream.send_at_once();
    target.set_chunked_content_provider(
        response.content_type,
        [send = std::move(response.stream), peer, report = std::move(report)](std::size_t, httplib::DataSink& sink) {
          return send_or_cut_off(report, [&] {
            ChunkWriter writer(sink, peer);
            send(writer);
            sink.done();
            return !writer.client_gone();
          });
        });
  } else if (response.piecewise_body && response.piecewise_body->bytes > 0) {
    target.set_content_provider(static_cast<std::size_t>(response.piecewise_body->bytes), response.content_type,
                                [body = *std::move(response.piecewise_body), report = std::move(report)](
                                    std::size_t offset, std::size_t count, httplib::DataSink& sink) {
                                  return send_or_cut_off(report,
                                                         [&] { return send_piecewise(body, offset, count, sink); });
                                });
  } else {
    target.body = std::move(response.body);
    if (!response.content_type.empty()) target.set_header("Content-Type", response.content_type);
  }
}

}  // namespace supple::http
