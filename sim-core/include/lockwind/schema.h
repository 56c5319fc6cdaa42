#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace lockwind {

enum class FieldType : std::uint8_t { u8, u16, u32, u64, i32, i64 };

/// One stored field of a row. Hash, diff, describe and the canonical form are generated from these.
struct FieldDescriptor {
    std::string_view name;          // as in the C++ struct
    FieldType type;                 // of one component
    std::uint32_t components;       // array length; 1 for a plain field
    std::uint32_t offset_bytes;     // in the row
    std::uint32_t fraction_bits;    // of a fixed-point value; 0 for an integer
    std::string_view unit;          // "m", "m/s", "tick" ...; "" for none
    std::string_view components_as; // one letter a component ("xyz", "xyzw"); "" prints [index]
};

/// A table of the arena. `state` tables are saved, hashed and sent; `derived` ones are only a
/// cache.
struct SectionDescriptor {
    std::string_view name;
    std::string_view owner;     // the layer that writes it
    std::uint32_t stride_bytes; // row size, the same on every architecture, a multiple of 4
    bool derived;
    std::string_view entity_field; // the field that names a row's entity; "" : the row's index does
    std::span<const FieldDescriptor> fields;
};

using StateSchema = std::span<const SectionDescriptor>;

template <class T>
constexpr FieldType field_type_of() {
    if constexpr (sizeof(T) == 1) {
        return FieldType::u8;
    } else if constexpr (sizeof(T) == 2) {
        return FieldType::u16;
    } else if constexpr (sizeof(T) == 4) {
        return static_cast<T>(-1) < static_cast<T>(0) ? FieldType::i32 : FieldType::u32;
    } else {
        return static_cast<T>(-1) < static_cast<T>(0) ? FieldType::i64 : FieldType::u64;
    }
}

template <class T>
struct FieldShape {
    using Component = T;
    static constexpr std::uint32_t kComponents = 1;
};
template <class T, std::size_t N>
struct FieldShape<T[N]> {
    using Component = T;
    static constexpr std::uint32_t kComponents = N;
};

template <class Member>
constexpr FieldDescriptor describe_field(std::string_view name,
                                         std::size_t offset_bytes,
                                         std::uint32_t fraction_bits,
                                         std::string_view unit,
                                         std::string_view components_as) {
    return {name,
            field_type_of<typename FieldShape<Member>::Component>(),
            FieldShape<Member>::kComponents,
            static_cast<std::uint32_t>(offset_bytes),
            fraction_bits,
            unit,
            components_as};
}

} // namespace lockwind

/// Describes `Row::member` (an integer or an array of integers).
#define LOCKWIND_FIELD(Row, member, fraction_bits, unit, components_as)                            \
    ::lockwind::describe_field<decltype(Row::member)>(                                             \
        #member, offsetof(Row, member), fraction_bits, unit, components_as)
