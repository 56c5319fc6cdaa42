#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lockwind {

/// Whether `text` is well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, <= U+10FFFF).
bool is_utf8(std::string_view text);

/// `text` with a '?' for each byte that is not part of a well-formed character, cut before the
/// first character that ends behind `size_bytes_max`.
std::string clean_text(std::string_view text, std::size_t size_bytes_max);

} // namespace lockwind
