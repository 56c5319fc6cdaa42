#include "systems/spawn.h"

#include <algorithm>

namespace lockwind {

namespace {

void move_body(const DynamicsTables& tables, BodyRow from, BodyRow to) {
    tables.motion[to] = tables.motion[from];
    tables.lives[to] = tables.lives[from];
    tables.sleep[to] = tables.sleep[from];
}

void set_body_count(const DynamicsTables& tables, std::uint32_t count) {
    tables.motion.set_count(count);
    tables.lives.set_count(count);
    tables.sleep.set_count(count);
}

} // namespace

BodyRow row_of(const Table<BodyMotion>& motion, BodyId id) {
    const std::span<BodyMotion> rows = motion.rows();
    const auto found =
        std::lower_bound(rows.begin(), rows.end(), id, [](const BodyMotion& row, BodyId wanted) {
            return row.id < wanted;
        });
    return found != rows.end() && found->id == id ? static_cast<BodyRow>(found - rows.begin())
                                                  : kNoIndex;
}

Spawner::Spawner(std::uint32_t body_capacity, std::uint32_t create_capacity)
    : destroyed_(body_capacity, 0), kinds_(body_capacity) {
    created_.reserve(create_capacity);
    new_row_of_.reserve(body_capacity);
}

void Spawner::create(const BodyRecord& body) {
    LOCKWIND_ASSERT(created_.size() < created_.capacity());
    created_.push_back(body);
}

bool Spawner::destroy(BodyRow row) {
    if (destroyed_[row] != 0) {
        return false;
    }
    destroyed_[row] = 1;
    ++destroyed_count_;
    return true;
}

void Spawner::forget() {
    despawn_known_ = false;
    kinds_.forget();
    drop_queues();
}

void Spawner::drop_queues() {
    created_.clear();
    if (destroyed_count_ != 0) {
        std::fill(destroyed_.begin(), destroyed_.end(), std::uint8_t{0});
        destroyed_count_ = 0;
    }
}

void Spawner::sort_created() {
    std::sort(created_.begin(), created_.end(), [](const BodyRecord& a, const BodyRecord& b) {
        return a.motion.id < b.motion.id;
    });
}

void Spawner::number_rows(const Table<BodyMotion>& motion) {
    new_row_of_.clear();
    BodyRow next = 0;
    std::size_t created = 0;
    for (BodyRow row = 0; row < motion.count(); ++row) {
        if (destroyed_[row] != 0) {
            new_row_of_.push_back(kNoIndex);
            continue;
        }
        while (created < created_.size() && created_[created].motion.id < motion[row].id) {
            ++created;
            ++next;
        }
        new_row_of_.push_back(next);
        ++next;
    }
}

void Spawner::give_kind(const DynamicsTables& tables,
                        BodyRow row,
                        const BodyProperties& properties) {
    tables.lives[row].body_kind = kinds_.take(tables.kinds, properties);
}

void Spawner::redefine(const DynamicsTables& tables,
                       BodyRow row,
                       const BodyProperties& properties) {
    kinds_.know(tables.kinds, tables.lives);
    kinds_.release(tables.kinds, tables.lives[row].body_kind);
    give_kind(tables, row, properties);
}

/// Of the bodies that go.
void Spawner::release_kinds(const DynamicsTables& tables) {
    kinds_.know(tables.kinds, tables.lives);
    for (BodyRow row = 0; row < tables.motion.count() && destroyed_count_ != 0; ++row) {
        if (destroyed_[row] != 0) {
            kinds_.release(tables.kinds, tables.lives[row].body_kind);
        }
    }
}

/// Of the bodies that came.
void Spawner::take_kinds(const DynamicsTables& tables) {
    for (const BodyRecord& body : created_) {
        give_kind(tables, row_of(tables.motion, body.motion.id), body.properties);
    }
}

bool Spawner::is_despawn_due(const Table<BodyLife>& lives, std::uint32_t tick) {
    if (!despawn_known_) {
        despawn_known_ = true;
        despawn_tick_ = 0;
        for (const BodyLife& body : lives.rows()) {
            // Ticks wrap: the nearest one ahead counts.
            const bool is_next =
                despawn_tick_ == 0 || body.despawn_tick - tick < despawn_tick_ - tick;
            if (body.despawn_tick != 0 && is_next) {
                despawn_tick_ = body.despawn_tick;
            }
        }
    }
    return despawn_tick_ != 0 && despawn_tick_ == tick;
}

StepFault Spawner::apply(const DynamicsTables& tables) {
    if (created_.empty() && destroyed_count_ == 0) {
        return StepFault::none;
    }
    despawn_known_ = false;
    sort_created();
    const std::uint32_t old_count = tables.motion.count();
    const std::uint32_t kept = old_count - destroyed_count_;
    const auto count = static_cast<std::uint32_t>(kept + created_.size());
    const bool fits = count <= tables.motion.capacity();
    if (fits) {
        release_kinds(tables);
        number_rows(tables.motion);
        remap_rows(tables, new_row_of_);
        BodyRow packed = 0;
        for (BodyRow row = 0; row < old_count; ++row) {
            if (destroyed_[row] == 0) {
                move_body(tables, row, packed);
                ++packed;
            }
        }
        set_body_count(tables, kept); // zeroes what is left behind
        set_body_count(tables, count);
        // From the back, so that a row moves up before its place is taken.
        BodyRow target = count;
        BodyRow old = kept;
        for (std::size_t created = created_.size(); created > 0; --created) {
            const BodyRecord& body = created_[created - 1];
            while (old > 0 && tables.motion[old - 1].id > body.motion.id) {
                --target;
                --old;
                move_body(tables, old, target);
            }
            --target;
            tables.motion[target] = body.motion;
            tables.lives[target] = body.life;
            tables.sleep[target] = BodySleep{};
        }
        take_kinds(tables);
    }
    drop_queues();
    return fits ? StepFault::none : StepFault::bodies_full;
}

} // namespace lockwind
