#pragma once

#include "connection.h"
#include "supple/http/server.h"

namespace supple::http {

/// Decides, once the head of a request has arrived, whether the rest of it is read. Any thread may call.
class Admission {
 public:
  /// The router must outlive this object.
  Admission(const Router& router, Server::Guard guard) : router_(router), guard_(std::move(guard)) {}

  /// Sets the route of the connection's request, and all of the request but its body. Throws the error with which the
  /// request is refused.
  void admit(Connection& connection) const;

 private:
  const Router& router_;
  const Server::Guard guard_;
};

}  // namespace supple::http
