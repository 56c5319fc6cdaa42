#pragma once

#include "lockwind/result.h"
#include "lockwind/schema.h"

#include <memory>
#include <string>
#include <vector>

namespace lockwind {

namespace forensics_format {
class Schema;
}

/// A state schema that owns its strings, so that files describe their own states and tools read
/// those of any simulation and version. Cheap to copy; a view stays valid as long as any copy
/// lives.
class OwnedSchema {
public:
    OwnedSchema() = default;
    explicit OwnedSchema(StateSchema schema);

    StateSchema view() const;
    bool operator==(const OwnedSchema& other) const;

    void encode(forensics_format::Schema& out) const;
    /// Of a file or a peer: an Error where it breaks a limit or check_schema's rules.
    static Result<OwnedSchema> decode(const forensics_format::Schema& message);

private:
    struct Content;
    std::shared_ptr<const Content> content_;
};

} // namespace lockwind
