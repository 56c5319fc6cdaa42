#pragma once

#include "lockwind/result.h"
#include "lockwind/vector.h"

#include <cstdint>
#include <optional>
#include <string>

namespace lockwind {

/// Decimal text with up to six places, truncated.
std::string text_of(Real value);

/// Collects what is wrong with the definition of one thing, "body 3: field what": the first
/// complaint stays.
class DefinitionChecker {
public:
    DefinitionChecker(const char* thing, std::uint64_t id)
        : subject_(std::string(thing) + " " + std::to_string(id)) {}
    explicit DefinitionChecker(const char* thing) : subject_(thing) {}

    bool failed() const { return error_.has_value(); }
    const Error& error() const { return *error_; }

    void fail(const std::string& field, const std::string& what);
    void require(bool condition, const char* field, const char* what) {
        if (!condition) {
            fail(field, what);
        }
    }
    void range(const char* field, Real value, Real low, Real high, const char* unit);
    void count(const char* field, std::uint32_t value, std::uint32_t low, std::uint32_t high);
    /// Each component within +-limit.
    void vector_range(const char* field, const Vec3& value, Real limit, const char* unit);
    /// The vector's length as well.
    void speed(const char* field, const Vec3& value, Real limit, const char* unit);

private:
    std::string subject_;
    std::optional<Error> error_;
};

} // namespace lockwind
