#include "transport/dds/dds_error.h"

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <string_view>

namespace lockwind {
namespace {

void discard(void* /*user*/, const dds_log_data_t* /*data*/) {}

void collect(void* user, const dds_log_data_t* data) {
    std::string& text = *static_cast<std::string*>(user);
    const std::string_view line(data->message, data->size);
    constexpr std::size_t kTextSizeMax = 1'000;
    if (text.size() + line.size() < kTextSizeMax) {
        text += line;
    }
}

} // namespace

Error dds_error(const std::string& what, std::int32_t code) {
    return Error{what + ": " + dds_strretcode(-code)};
}

DdsLogCapture::DdsLogCapture() {
    dds_set_log_sink(collect, &text_);
    dds_set_trace_sink(discard, nullptr);
}

DdsLogCapture::~DdsLogCapture() {
    dds_set_log_sink(discard, nullptr);
}

} // namespace lockwind
