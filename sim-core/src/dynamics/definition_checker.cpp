#include "dynamics/definition_checker.h"

#include "lockwind/wide.h"

namespace lockwind {

std::string text_of(Real value) {
    const std::uint64_t raw = raw_magnitude(value.raw());
    std::string digits = std::to_string((raw & 0xffffffffU) * 1000000 >> 32U);
    digits.insert(0, 6 - digits.size(), '0');
    while (digits.size() > 1 && digits.back() == '0') {
        digits.pop_back();
    }
    return (value < 0 ? "-" : "") + std::to_string(raw >> 32U) + "." + digits;
}

void DefinitionChecker::fail(const std::string& field, const std::string& what) {
    if (!error_) {
        error_ = Error{subject_ + ": " + field + " " + what};
    }
}

void DefinitionChecker::range(
    const char* field, Real value, Real low, Real high, const char* unit) {
    if (value < low || value > high) {
        fail(field,
             "is " + text_of(value) + "; it must be within " + text_of(low) + " .. " +
                 text_of(high) + unit);
    }
}

void DefinitionChecker::count(const char* field,
                              std::uint32_t value,
                              std::uint32_t low,
                              std::uint32_t high) {
    if (value < low || value > high) {
        fail(field,
             "is " + std::to_string(value) + "; it must be within " + std::to_string(low) + " .. " +
                 std::to_string(high));
    }
}

void DefinitionChecker::vector_range(const char* field,
                                     const Vec3& value,
                                     Real limit,
                                     const char* unit) {
    const std::string name = field;
    range((name + ".x").c_str(), value.x, -limit, limit, unit);
    range((name + ".y").c_str(), value.y, -limit, limit, unit);
    range((name + ".z").c_str(), value.z, -limit, limit, unit);
}

void DefinitionChecker::speed(const char* field, const Vec3& value, Real limit, const char* unit) {
    vector_range(field, value, limit, unit);
    if (failed()) {
        return;
    }
    const auto square =
        product(value.x, value.x) + product(value.y, value.y) + product(value.z, value.z);
    if (square > product(limit, limit)) {
        fail(field, "is longer than " + text_of(limit) + unit);
    }
}

} // namespace lockwind
