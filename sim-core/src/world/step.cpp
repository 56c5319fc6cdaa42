#include "dynamics/make_body.h"
#include "dynamics/pairing.h"
#include "world/impl.h"

#include "lockwind/phase_observer.h"
#include "lockwind/slot_input.h"

#include <array>
#include <string>

namespace lockwind {

namespace {

/// One run through the phases. Each reads the arena, and the scratch of earlier phases of this
/// tick; each leaves its results in the arena.
class Step {
public:
    Step(World::Impl& world, std::span<const SlotInput> inputs)
        : world_(world), inputs_(inputs), tables_(world.tables()), tick_(world.globals().tick + 1) {
    }

    StepFault apply_inputs();
    StepFault broad_phase();
    StepFault narrow_phase();
    StepFault wake();
    StepFault solve();
    StepFault restitution();
    StepFault sleep();
    StepFault spawns_despawns();
    StepFault events();
    StepFault next_tick();

private:
    EventType event_of(const ContactChange& change) const;
    BodyId id(BodyRow row) const { return tables_.motion[row].id; }
    std::uint32_t tick_low() const { return static_cast<std::uint32_t>(tick_); }
    void note_changes();
    void report_contacts();
    void score_hits();
    void destroy(BodyRow row);
    void break_joints();
    void despawn();
    StepFault keep_in_bounds();
    void remove_outside(BodyRow row);
    void return_pod(Slot slot, BodyRow row);

    World::Impl& world_;
    std::span<const SlotInput> inputs_;
    DynamicsTables tables_;
    Tick tick_; // being made
};

struct Phase {
    std::string_view name;
    StepFault (Step::*run)();
};

constexpr std::array kPhases{
    Phase{"apply_inputs", &Step::apply_inputs},
    Phase{"broad_phase", &Step::broad_phase},
    Phase{"narrow_phase", &Step::narrow_phase},
    Phase{"wake", &Step::wake},
    Phase{"solve", &Step::solve},
    Phase{"restitution", &Step::restitution},
    Phase{"sleep", &Step::sleep},
    Phase{"spawns_despawns", &Step::spawns_despawns},
    Phase{"events", &Step::events},
    Phase{"next_tick", &Step::next_tick},
};

/// To the opposite side; the broad phase then ends what it touched.
void wrap(Real bounds, BodyMotion& motion) {
    for (std::int64_t& coordinate : motion.position) {
        if (coordinate > bounds.raw()) {
            coordinate -= 2 * bounds.raw();
        } else if (coordinate < -bounds.raw()) {
            coordinate += 2 * bounds.raw();
        }
    }
}

constexpr std::array<std::string_view, kPhases.size()> names_of_phases() {
    std::array<std::string_view, kPhases.size()> names;
    for (std::size_t phase = 0; phase < kPhases.size(); ++phase) {
        names[phase] = kPhases[phase].name;
    }
    return names;
}
constexpr std::array<std::string_view, kPhases.size()> kPhaseNames = names_of_phases();

} // namespace

Status World::step(std::span<const SlotInput> inputs, PhaseObserver* observer) {
    Impl& world = *impl_;
    LOCKWIND_ASSERT(inputs.size() == slot_count());
    if (world.fault != StepFault::none) {
        return world.fault_error();
    }
    world.events.clear();
    world.query_index.drop();
    Step step(world, inputs);
    if (observer != nullptr) {
        world.versions.touch_all(); // it looks at every phase
    }
    for (std::uint32_t phase = 0; phase < kPhases.size(); ++phase) {
        world.fault = (step.*kPhases[phase].run)();
        if (world.fault != StepFault::none) {
            world.versions.touch_all();
            return world.fault_error();
        }
        if (observer != nullptr) {
            observer->after_phase(phase);
            world.versions.touch_all();
        }
    }
    return Success{};
}

std::span<const std::string_view> World::phases() {
    return kPhaseNames;
}

StepFault Step::apply_inputs() {
    world_.pods.apply_inputs(tables_, world_.players(), inputs_);
    return StepFault::none;
}

StepFault Step::broad_phase() {
    return world_.dynamics.broad_phase(tables_);
}

StepFault Step::narrow_phase() {
    return world_.dynamics.narrow_phase(tables_);
}

StepFault Step::wake() {
    world_.dynamics.wake(tables_);
    return StepFault::none;
}

StepFault Step::solve() {
    world_.dynamics.solve(tables_);
    return StepFault::none;
}

StepFault Step::restitution() {
    world_.dynamics.restitution(tables_);
    return StepFault::none;
}

StepFault Step::sleep() {
    world_.dynamics.sleep(tables_);
    world_.dynamics.choose_levels(tables_, world_.pods.rows(tables_, world_.players()));
    return StepFault::none;
}

/// Contacts and hits are told by row, so they are turned into events before rows move.
StepFault Step::spawns_despawns() {
    note_changes();
    report_contacts();
    break_joints();
    score_hits();
    despawn();
    if (const StepFault fault = keep_in_bounds(); fault != StepFault::none) {
        return fault;
    }
    Spawner& spawner = world_.spawner;
    const std::size_t returned = spawner.created().size();
    world_.pods.spawn_balls(tables_, world_.players(), world_.globals().seed, tick_, spawner);
    for (const BodyRecord& ball : spawner.created().subspan(returned)) {
        world_.events.add(EventType::created, ball.motion.id, spawner_of(ball.motion.id), 0);
        ++world_.globals().created_total;
    }
    if (spawner.is_due()) {
        world_.versions.touch_all();
    }
    return spawner.apply(tables_);
}

/// Who is awake, what concerns them, and what all steps change. Later phases change no more, but
/// where bodies come and go.
void Step::note_changes() {
    PageVersions& versions = world_.versions;
    for (const std::uint32_t section :
         {section::kArena, section::kGlobals, section::kBodySleep, section::kPlayer}) {
        versions.touch(section);
    }
    const Dynamics& dynamics = world_.dynamics;
    for (const std::uint32_t slot : dynamics.changed_manifolds()) {
        versions.touch(section::kManifold, slot);
        versions.touch(section::kContactImpulse, slot);
    }
    for (const std::uint32_t index : dynamics.changed_pairs()) {
        versions.touch(section::kPair, index);
    }
    if (dynamics.pairs_moved()) {
        versions.touch(section::kPair);
    }
    if (!dynamics.broken_joints().empty()) {
        versions.touch(section::kJoint);
    }
    if (dynamics.awake_rows().size() > tables_.motion.count() / 2) {
        for (const std::uint32_t section :
             {section::kBody, section::kContactImpulse, section::kJoint}) {
            versions.touch(section);
        }
        return;
    }
    for (const BodyRow row : dynamics.awake_rows()) {
        versions.touch(section::kBody, row);
    }
    for (const Player& player : world_.players().rows()) {
        if (const BodyRow row = row_of(tables_.motion, player.body); row != kNoIndex) {
            versions.touch(section::kBody, row);
        }
    }
    for (const std::uint32_t index : dynamics.active_pairs()) {
        if (tables_.pairs[index].point_count != 0) {
            versions.touch(section::kContactImpulse, tables_.pairs[index].manifold);
        }
    }
    for (const std::uint32_t row : dynamics.active_joints()) {
        versions.touch(section::kJoint, row);
    }
}

EventType Step::event_of(const ContactChange& change) const {
    if (is_sensing(tables_.properties[change.row_a], tables_.properties[change.row_b])) {
        return change.begin ? EventType::sensor_begin : EventType::sensor_end;
    }
    return change.begin ? EventType::contact_begin : EventType::contact_end;
}

void Step::report_contacts() {
    for (const ContactChange& change : world_.dynamics.contact_changes()) {
        const EventType type = event_of(change);
        world_.events.add(type, id(change.row_a), id(change.row_b), 0);
    }
    for (const ContactHit& hit : world_.dynamics.contact_hits()) {
        world_.events.add(EventType::hit, id(hit.row_a), id(hit.row_b), hit.impulse);
    }
    for (const SleepChange& change : world_.dynamics.sleep_changes()) {
        const EventType type = change.asleep ? EventType::fell_asleep : EventType::woke;
        world_.events.add(type, id(change.row), 0, 0);
    }
}

void Step::break_joints() {
    const std::span<const std::uint32_t> broken = world_.dynamics.broken_joints();
    const auto body_id = [&](BodyRow row) { return row == kNoIndex ? 0 : id(row); };
    std::uint32_t kept = 0;
    std::size_t next = 0;
    for (std::uint32_t row = 0; row < tables_.joints.count(); ++row) {
        const Joint joint = tables_.joints[row];
        if (next < broken.size() && broken[next] == row) {
            ++next;
            wake_joined(tables_, joint);
            world_.events.add(EventType::joint_break,
                              body_id(joint.row_a),
                              id(joint.row_b),
                              static_cast<std::int64_t>(joint.id));
        } else {
            tables_.joints[kept++] = joint;
        }
    }
    tables_.joints.set_count(kept);
}

void Step::score_hits() {
    const Table<Player> players = world_.players();
    for (const ContactHit& hit : world_.dynamics.contact_hits()) {
        Goal goal{};
        if (is_goal(tables_, players, hit, goal) && !world_.spawner.is_destroyed(goal.ball)) {
            Player& scorer = players[goal.by];
            ++scorer.score;
            world_.events.add(
                EventType::score, scorer.body, players[goal.victim].body, scorer.score);
            destroy(goal.ball);
        }
    }
}

void Step::destroy(BodyRow row) {
    if (world_.spawner.destroy(row)) {
        world_.events.add(EventType::destroyed, id(row), 0, 0);
        ++world_.globals().destroyed_total;
    }
}

void Step::despawn() {
    if (world_.spawner.is_despawn_due(tables_.lives, tick_low())) {
        for (BodyRow row = 0; row < tables_.motion.count(); ++row) {
            if (tables_.lives[row].despawn_tick == tick_low()) {
                destroy(row);
            }
        }
    }
}

/// Who sleeps has not left.
StepFault Step::keep_in_bounds() {
    const Real bounds = world_.settings.bounds;
    for (const BodyRow row : world_.dynamics.awake_rows()) {
        const bool is_fixed =
            tables_.properties[row].mode == static_cast<std::uint8_t>(BodyMode::fixed);
        if (is_fixed || world_.spawner.is_destroyed(row) ||
            !is_outside(tables_.motion[row], bounds)) {
            continue;
        }
        switch (world_.settings.bounds_policy) {
        case BoundsPolicy::destroy:
            remove_outside(row);
            break;
        case BoundsPolicy::wrap:
            wrap(bounds, tables_.motion[row]);
            break;
        case BoundsPolicy::error:
            world_.fault_body = id(row);
            return StepFault::bounds_left;
        }
    }
    return StepFault::none;
}

void Step::remove_outside(BodyRow row) {
    const Slot slot = slot_of(world_.players(), id(row));
    if (slot == kNoIndex) {
        destroy(row);
    } else {
        return_pod(slot, row);
    }
}

/// Leaves and comes in one merge, so that no pair or bounds of its old place stay.
void Step::return_pod(Slot slot, BodyRow row) {
    world_.spawner.destroy(row);
    BodyRecord pod = world_.pod_starts[slot];
    pod.life.spawn_count = tables_.lives[row].spawn_count;
    world_.spawner.create(pod);
    world_.events.add(EventType::respawned, id(row), 0, 0);
}

StepFault Step::events() {
    Globals& globals = world_.globals();
    world_.events.sort();
    for (const Event& event : world_.events.events()) {
        globals.event_hash = chain_event(globals.event_hash, event);
    }
    globals.events_total += world_.events.events().size();
    return StepFault::none;
}

StepFault Step::next_tick() {
    world_.globals().tick = tick_;
    return StepFault::none;
}

bool is_outside(const BodyMotion& motion, Real bounds) {
    for (const std::int64_t coordinate : motion.position) {
        if (coordinate > bounds.raw() || coordinate < -bounds.raw()) {
            return true;
        }
    }
    return false;
}

Error World::Impl::fault_error() {
    const Tick tick = globals().tick;
    const auto full = [&](const char* setting, std::uint32_t capacity) {
        return Error{"step to tick " + std::to_string(tick + 1) + ": settings." + setting + " of " +
                     std::to_string(capacity) + " is full; raise it in the scene"};
    };
    switch (fault) {
    case StepFault::bodies_full:
        return full("body_capacity", capacities.body_capacity);
    case StepFault::pairs_full:
    case StepFault::events_full:
        return full("pair_capacity", capacities.pair_capacity);
    case StepFault::manifolds_full:
        return full("manifold_capacity", capacities.manifold_capacity);
    case StepFault::bounds_left:
        return Error{"step to tick " + std::to_string(tick + 1) + ": body " +
                     std::to_string(fault_body) + " has left settings.bounds"};
    case StepFault::none:
        break;
    }
    LOCKWIND_ASSERT(false && "no fault");
    return Error{};
}

} // namespace lockwind
