#pragma once

#include "log/record_file.h"

#include "lockwind/result.h"

#include <string>

namespace lockwind {

/// What a file that the tools wrote holds.
struct FileInfo {
    FileKind kind = FileKind::log;
    std::string json; // one object; of a log: with the fields of the contract
    std::string text; // for a person; ends with a newline
    bool damaged = false;
};

/// An Error where the file cannot be read at all.
Result<FileInfo> inspect_file(const std::string& path);

/// Writes the file's content to `to` as one plain protobuf message (log.proto's Log,
/// forensics.proto's Trace, Bundle, Snapshot), states unpacked. `to` must not exist.
Status export_file(const std::string& path, const std::string& to);

} // namespace lockwind
