#pragma once

#include "codec/rules.h"
#include "messages.pb.h"

namespace lockwind {

/// Session structs to generated messages. The struct keeps the rules.
void to_wire(const Hello& message, wire::Hello& out);
void to_wire(const Welcome& message, wire::Welcome& out);
void to_wire(const Refuse& message, wire::Refuse& out);
void to_wire(const Ready& message, wire::Ready& out);
void to_wire(const InputBatch& message, wire::InputBatch& out);
void to_wire(const Confirmation& message, wire::Confirmation& out);
void to_wire(const HashReport& message, wire::HashReport& out);
void to_wire(const Chunk& message, wire::Chunk& out);
void to_wire(const ChunkAck& message, wire::ChunkAck& out);
void to_wire(const DesyncQuery& message, wire::DesyncQuery& out);
void to_wire(const End& message, wire::End& out);

/// Generated messages to session structs. Checks here what must hold before anything is allocated
/// or narrowed; where a rule is broken `out` is left incomplete. apply_rules() does the rest.
void from_wire(const wire::Hello& message, Rules& rules, Hello& out);
void from_wire(const wire::Welcome& message, Rules& rules, Welcome& out);
void from_wire(const wire::Refuse& message, Rules& rules, Refuse& out);
void from_wire(const wire::Ready& message, Rules& rules, Ready& out);
void from_wire(const wire::InputBatch& message, Rules& rules, InputBatch& out);
void from_wire(const wire::Confirmation& message, Rules& rules, Confirmation& out);
void from_wire(const wire::HashReport& message, Rules& rules, HashReport& out);
void from_wire(const wire::Chunk& message, Rules& rules, Chunk& out);
void from_wire(const wire::ChunkAck& message, Rules& rules, ChunkAck& out);
void from_wire(const wire::DesyncQuery& message, Rules& rules, DesyncQuery& out);
void from_wire(const wire::End& message, Rules& rules, End& out);

} // namespace lockwind
