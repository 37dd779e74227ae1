#pragma once

#include <httplib.h>

#include <exception>
#include <functional>

#include "connection_stream.h"
#include "supple/http/message.h"

namespace supple::http {

/// Makes the library's response of ours. What sends an answer piece by piece may throw: then the answer is cut off,
/// because its head has been sent, and `report` gets the exception unless it is a stop request.
void fill_response(httplib::Response& target, Response response, ConnectionStream& stream, Peer peer,
                   std::function<void(const std::exception_ptr&)> report);

}  // namespace supple::http
