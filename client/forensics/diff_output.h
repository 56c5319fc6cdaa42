#pragma once

#include "forensics/diff.h"

#include <string>

namespace lockwind {

/// For a person: short, aligned, ends with a newline.
std::string diff_text(const DiffResult& result);
/// One JSON object with the fields of the contract: same, first_tick, phase, section, entity,
/// field, a, b, verdict (null where not known), and more.
std::string diff_json(const DiffResult& result);
/// JUnit XML: one test case named after `subject`, failing with diff_text, or passing.
std::string diff_junit(const DiffResult& result, const std::string& subject);

} // namespace lockwind
