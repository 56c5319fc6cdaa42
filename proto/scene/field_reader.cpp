#include "scene/field_reader.h"

#include "scene/decimal.h"

#include "lockwind/assert.h"

#include <cstdio>

namespace lockwind {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::TextFormat;

std::string with_unit(const std::string& number, std::string_view unit) {
    return unit.empty() ? number : number + " " + std::string(unit);
}

} // namespace

std::string text_of(double value, int digits) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    return buffer;
}

void SceneErrors::add(int line, int column, std::string_view what) {
    if (any()) {
        return;
    }
    message_ = file_name_ + ":";
    if (line >= 0) {
        message_ += std::to_string(line + 1) + ":" + std::to_string(column + 1) + ":";
    }
    message_ += " " + std::string(what);
}

FieldReader::FieldReader(const google::protobuf::Message& message,
                         const TextFormat::ParseInfoTree& tree,
                         SceneErrors& errors)
    : message_(&message), tree_(&tree), errors_(&errors) {}

FieldReader::FieldReader(const FieldReader& parent, const Descriptor& descriptor, int index)
    : message_(nullptr), tree_(nullptr), errors_(parent.errors_), line_(parent.line_),
      column_(parent.column_) {
    const auto& reflection = *parent.message_->GetReflection();
    path_ = parent.path_.empty() ? descriptor.name() : parent.path_ + "." + descriptor.name();
    if (index >= 0) {
        path_ += "[" + std::to_string(index) + "]";
        message_ = &reflection.GetRepeatedMessage(*parent.message_, &descriptor, index);
    } else {
        message_ = &reflection.GetMessage(*parent.message_, &descriptor);
    }
    if (parent.tree_ == nullptr) {
        return;
    }
    tree_ = parent.tree_->GetTreeForNested(&descriptor, index);
    const TextFormat::ParseLocation place = parent.tree_->GetLocation(&descriptor, index);
    if (place.line >= 0) {
        line_ = place.line;
        column_ = place.column;
    }
}

const FieldReader::Descriptor& FieldReader::descriptor(const std::string& field) const {
    const Descriptor* found = message_->GetDescriptor()->FindFieldByName(field);
    LOCKWIND_ASSERT(found != nullptr);
    return *found;
}

bool FieldReader::has(const std::string& field) const {
    return message_->GetReflection()->HasField(*message_, &descriptor(field));
}

FieldReader FieldReader::nested(const std::string& field, int index) const {
    return {*this, descriptor(field), index};
}

double FieldReader::number(const std::string& field, double fallback, const Range& range) const {
    const Descriptor& what = descriptor(field);
    const auto& reflection = *message_->GetReflection();
    if (what.has_presence() && !reflection.HasField(*message_, &what)) {
        return fallback;
    }
    const double value = what.cpp_type() == Descriptor::CPPTYPE_DOUBLE
                             ? reflection.GetDouble(*message_, &what)
                             : reflection.GetUInt32(*message_, &what);
    // Written so that NaN fails too.
    if (!(value >= range.min && value <= range.max)) {
        fail(field,
             "is " + with_unit(text_of(value), range.unit) + "; give " + text_of(range.min) +
                 " .. " + with_unit(text_of(range.max), range.unit));
        return fallback;
    }
    return value;
}

Real FieldReader::real(const std::string& field, Real fallback, const Range& range) const {
    const Descriptor& what = descriptor(field);
    if (what.has_presence() && !has(field)) {
        return fallback;
    }
    return to_real(number(field, 0, range)).value_or(fallback);
}

std::uint32_t
FieldReader::count(const std::string& field, std::uint32_t fallback, const Range& range) const {
    return static_cast<std::uint32_t>(number(field, fallback, range));
}

std::vector<Real> FieldReader::reals(const std::string& field, const Range& range) const {
    const Descriptor& what = descriptor(field);
    const auto& reflection = *message_->GetReflection();
    std::vector<Real> reals;
    for (int index = 0; index < reflection.FieldSize(*message_, &what); ++index) {
        const double value = reflection.GetRepeatedDouble(*message_, &what, index);
        const bool is_good = value >= range.min && value <= range.max; // NaN fails too
        if (!is_good) {
            fail(field,
                 "[" + std::to_string(index) + "] is " + with_unit(text_of(value), range.unit) +
                     "; give " + text_of(range.min) + " .. " +
                     with_unit(text_of(range.max), range.unit));
        }
        reals.push_back(is_good ? to_real(value).value_or(Real(0)) : Real(0));
    }
    return reals;
}

Vec3 FieldReader::vector(const std::string& field, const Vec3& fallback, const Range& range) const {
    if (!has(field)) {
        return fallback;
    }
    const FieldReader components = nested(field);
    return {components.real("x", 0, range),
            components.real("y", 0, range),
            components.real("z", 0, range)};
}

void FieldReader::fail(const std::string& field, std::string_view what) const {
    int line = line_;
    int column = column_;
    std::string path = path_;
    if (!field.empty()) {
        path += (path.empty() ? "" : ".") + field;
        const Descriptor& wrong = descriptor(field);
        if (tree_ != nullptr && !wrong.is_repeated()) {
            const TextFormat::ParseLocation place = tree_->GetLocation(&wrong, -1);
            line = place.line >= 0 ? place.line : line;
            column = place.line >= 0 ? place.column : column;
        }
    }
    errors_->add(line, column, path + (path.empty() ? "" : " ") + std::string(what));
}

} // namespace lockwind
