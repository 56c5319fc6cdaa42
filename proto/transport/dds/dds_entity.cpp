#include "transport/dds/dds_entity.h"

#include <dds/dds.h>
#include <type_traits>
#include <utility>

namespace lockwind {

static_assert(std::is_same_v<dds_entity_t, std::int32_t>);

DdsEntity& DdsEntity::operator=(DdsEntity&& other) noexcept {
    if (this != &other) {
        reset();
        handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
}

void DdsEntity::reset() {
    if (handle_ > 0) {
        // Fails only if a parent took this entity with it: then it is gone, which is what is
        // wanted.
        (void)dds_delete(handle_);
        handle_ = 0;
    }
}

} // namespace lockwind
