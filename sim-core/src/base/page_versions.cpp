#include "base/page_versions.h"

namespace lockwind {

PageVersions::PageVersions(const StateArena& arena) {
    std::size_t pages = 0;
    for (std::uint32_t section = 0; section < arena.section_count(); ++section) {
        const std::size_t stride = arena.schema()[section].stride_bytes;
        places_.push_back({pages, stride, 0});
        pages += stride * arena.capacity(section) / kHashPageBytes + 1;
    }
    pages_.resize(pages);
}

} // namespace lockwind
