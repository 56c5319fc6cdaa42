#pragma once

#include "lockwind/assert.h"

#include <string>
#include <utility>
#include <variant>

namespace lockwind {

/// What was wrong, where, and what to do, in one or two lines for a person.
struct Error {
    std::string message;
};

/// A value or the Error that kept it from being made. Reading the wrong one asserts.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : content_(std::move(value)) {}
    Result(Error error) : content_(std::move(error)) {}

    bool ok() const { return std::holds_alternative<T>(content_); }
    explicit operator bool() const { return ok(); }

    T& value() & {
        LOCKWIND_ASSERT(ok());
        return *std::get_if<T>(&content_);
    }
    const T& value() const& {
        LOCKWIND_ASSERT(ok());
        return *std::get_if<T>(&content_);
    }
    T&& value() && {
        LOCKWIND_ASSERT(ok());
        return std::move(*std::get_if<T>(&content_));
    }
    const Error& error() const {
        LOCKWIND_ASSERT(!ok());
        return *std::get_if<Error>(&content_);
    }

private:
    std::variant<T, Error> content_;
};

/// Success, or an Error.
struct Success {};
using Status = Result<Success>;

} // namespace lockwind
