#pragma once

#include <string>

#include "supple/http/message.h"

// Entity tags (RFC 9110, 8.8.3) of answers that are named by their content.
namespace supple::routes {

/// A tag in the form of the header ETag.
std::string quoted(const std::string& tag);

/// Whether an If-None-Match header names the tag. Weak comparison, as RFC 9110 (13.1.2) asks for.
bool matches(const std::string& header, const std::string& tag);

/// The response 304 with the tag.
http::Response not_modified(const std::string& tag);

}  // namespace supple::routes
