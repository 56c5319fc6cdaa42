#pragma once

#include "lockwind/world_definition.h"

#include <cstdint>
#include <memory>

namespace lockwind::bench {

/// A world definition run by Bullet as peers were measured: 10 iterations, split impulse, no sleep.
/// Bodies that no player drives; the definition must have no pods.
class BulletWorld {
public:
    explicit BulletWorld(const WorldDefinition& definition);
    ~BulletWorld();
    BulletWorld(const BulletWorld&) = delete;
    BulletWorld& operator=(const BulletWorld&) = delete;

    void step();
    std::uint32_t contact_count() const;
    double penetration_mm() const; // deepest of all contact points
    std::uint32_t awake_count() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace lockwind::bench
