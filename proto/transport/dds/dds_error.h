#pragma once

#include "lockwind/result.h"

#include <cstdint>
#include <string>

namespace lockwind {

/// What DDS answered (a dds_return_t below 0) to `what`.
Error dds_error(const std::string& what, std::int32_t code);

/// Keeps Cyclone's messages off stderr for the life of the process, and collects those of the
/// current scope. One at a time.
class DdsLogCapture {
public:
    DdsLogCapture();
    DdsLogCapture(const DdsLogCapture&) = delete;
    DdsLogCapture& operator=(const DdsLogCapture&) = delete;
    ~DdsLogCapture();

    const std::string& text() const { return text_; }

private:
    std::string text_;
};

} // namespace lockwind
