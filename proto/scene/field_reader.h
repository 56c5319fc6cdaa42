#pragma once

#include "lockwind/vector.h"

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>
#include <string>
#include <string_view>
#include <vector>

namespace lockwind {

/// The first thing found wrong with a scene's text.
class SceneErrors {
public:
    explicit SceneErrors(std::string_view file_name) : file_name_(file_name) {}

    /// Keeps the first call's "file:line:column: what"; line and column count from 0, -1 for none.
    void add(int line, int column, std::string_view what);
    bool any() const { return !message_.empty(); }
    const std::string& message() const { return message_; }

private:
    std::string file_name_;
    std::string message_;
};

/// The number as a message shows it.
std::string text_of(double value, int digits = 7);

/// What a number may be; both ends belong to it.
struct Range {
    double min;
    double max;
    std::string_view unit; // "" for none
};

/// Reads the fields of one message of a scene. What is wrong is reported with the field's path and
/// place, and reads as the fallback. Field names must exist in scene.proto.
class FieldReader {
public:
    FieldReader(const google::protobuf::Message& message,
                const google::protobuf::TextFormat::ParseInfoTree& tree,
                SceneErrors& errors);

    bool has(const std::string& field) const;
    Real real(const std::string& field, Real fallback, const Range& range) const;
    std::uint32_t count(const std::string& field, std::uint32_t fallback, const Range& range) const;
    /// All of a repeated field.
    std::vector<Real> reals(const std::string& field, const Range& range) const;
    /// A message field with x, y and z; each component in `range`.
    Vec3 vector(const std::string& field, const Vec3& fallback, const Range& range) const;
    /// A field that holds one message, or element `index` of one that holds many.
    FieldReader nested(const std::string& field, int index = -1) const;

    /// Whether anything in the scene was found wrong.
    bool failed() const { return errors_->any(); }
    /// Reports that `field` (or this message, for "") is wrong.
    void fail(const std::string& field, std::string_view what) const;

private:
    using Descriptor = google::protobuf::FieldDescriptor;

    FieldReader(const FieldReader& parent, const Descriptor& descriptor, int index);
    const Descriptor& descriptor(const std::string& field) const;
    double number(const std::string& field, double fallback, const Range& range) const;

    const google::protobuf::Message* message_;
    const google::protobuf::TextFormat::ParseInfoTree*
        tree_; // null: the message is not in the text
    SceneErrors* errors_;
    std::string path_; // "" at the root, else "body[3].box"
    int line_ = -1;    // where the message itself begins
    int column_ = -1;
};

} // namespace lockwind
