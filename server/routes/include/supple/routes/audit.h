#pragma once

#include <string>

#include "supple/http/server.h"

namespace supple::routes {

/// What the audit log says of an answered request: who made, deleted or was refused what, and signed in or out; empty
/// where it says nothing, as of what only reads or computes. It knows a key by its id; no part of a secret, no query
/// and no body is in it. One line of plain characters, whatever a stranger has sent.
std::string audit_line(const http::Answered& answered);

/// Text of a stranger for a line of a log: at most 200 characters, others than plain ones as question marks; "-" for
/// none.
std::string plain_text(const std::string& text);

}  // namespace supple::routes
