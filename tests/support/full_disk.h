#pragma once

#include <csignal>
#include <cstdint>
#include <gtest/gtest.h>
#include <sys/resource.h>

namespace lockwind::testing {

/// While it lives, no file of this process grows beyond a size: writes fail as on a full disk.
class FullDisk {
public:
    explicit FullDisk(std::uint64_t size_bytes) {
        EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before_), 0);
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit full{static_cast<rlim_t>(size_bytes), before_.rlim_max};
        EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
    ~FullDisk() {
        EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &before_), 0);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    void (*handler_)(int) = SIG_DFL;
};

} // namespace lockwind::testing
