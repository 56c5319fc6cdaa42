#pragma once

#include <cstdint>

namespace lockwind {

/// Owns one DDS entity (a dds_entity_t: positive handle, or 0 for none) and deletes it. What was
/// created under it in DDS's own tree is deleted with it.
class DdsEntity {
public:
    DdsEntity() = default;
    explicit DdsEntity(std::int32_t handle) : handle_(handle > 0 ? handle : 0) {}
    DdsEntity(DdsEntity&& other) noexcept : handle_(other.handle_) { other.handle_ = 0; }
    DdsEntity& operator=(DdsEntity&& other) noexcept;
    ~DdsEntity() { reset(); }

    std::int32_t get() const { return handle_; }
    void reset();

private:
    std::int32_t handle_ = 0;
};

} // namespace lockwind
