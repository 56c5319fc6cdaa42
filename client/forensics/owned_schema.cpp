#include "forensics/owned_schema.h"

#include "base/state_schema.h"
#include "forensics.pb.h"

#include <deque>

namespace lockwind {

namespace {

constexpr int kSectionsMax = 256;
constexpr int kFieldsMax = 1024;
constexpr std::size_t kNameBytesMax = 128;
constexpr std::uint32_t kComponentsMax = 65536;
constexpr std::uint32_t kStrideBytesMax = 1U << 20U;
constexpr std::uint32_t kFractionBitsMax = 59; // what format_decimal takes

Error refuse(const std::string& what) {
    return Error{"schema: " + what};
}

Status check_field(const forensics_format::Schema::Field& field) {
    if (field.name().size() > kNameBytesMax || field.unit().size() > kNameBytesMax ||
        field.components_as().size() > kNameBytesMax) {
        return refuse("a text of a field is longer than " + std::to_string(kNameBytesMax));
    }
    if (field.type() > static_cast<std::uint32_t>(FieldType::i64)) {
        return refuse("unknown field type " + std::to_string(field.type()));
    }
    if (field.components() > kComponentsMax || field.fraction_bits() > kFractionBitsMax) {
        return refuse("field " + field.name() + " has too many components or fraction bits");
    }
    return Success{};
}

Status check_limits(const forensics_format::Schema& message) {
    if (message.sections_size() > kSectionsMax) {
        return refuse("more than " + std::to_string(kSectionsMax) + " sections");
    }
    for (const forensics_format::Schema::Section& section : message.sections()) {
        if (section.name().size() > kNameBytesMax || section.owner().size() > kNameBytesMax ||
            section.entity_field().size() > kNameBytesMax) {
            return refuse("a text of a section is longer than " + std::to_string(kNameBytesMax));
        }
        if (section.fields_size() > kFieldsMax || section.stride_bytes() > kStrideBytesMax ||
            section.stride_bytes() == 0) {
            return refuse("section " + section.name() + " has too many fields or too wide rows");
        }
        for (const forensics_format::Schema::Field& field : section.fields()) {
            if (Status status = check_field(field); !status) {
                return status;
            }
        }
    }
    return Success{};
}

} // namespace

/// Texts lie in a deque, which never moves them.
struct OwnedSchema::Content {
    std::deque<std::string> texts;
    std::deque<std::vector<FieldDescriptor>> fields;
    std::vector<SectionDescriptor> sections;

    std::string_view own(std::string_view text) { return texts.emplace_back(text); }

    FieldDescriptor own(FieldDescriptor field) {
        field.name = own(field.name);
        field.unit = own(field.unit);
        field.components_as = own(field.components_as);
        return field;
    }

    void add(SectionDescriptor section) {
        std::vector<FieldDescriptor>& owned = fields.emplace_back();
        for (const FieldDescriptor& field : section.fields) {
            owned.push_back(own(field));
        }
        section.name = own(section.name);
        section.owner = own(section.owner);
        section.entity_field = own(section.entity_field);
        section.fields = owned;
        sections.push_back(section);
    }
};

OwnedSchema::OwnedSchema(StateSchema schema) {
    auto content = std::make_shared<Content>();
    for (const SectionDescriptor& section : schema) {
        content->add(section);
    }
    content_ = std::move(content);
}

StateSchema OwnedSchema::view() const {
    return content_ == nullptr ? StateSchema{} : StateSchema{content_->sections};
}

bool OwnedSchema::operator==(const OwnedSchema& other) const {
    return describe(view()) == describe(other.view());
}

void OwnedSchema::encode(forensics_format::Schema& out) const {
    for (const SectionDescriptor& section : view()) {
        forensics_format::Schema::Section& added = *out.add_sections();
        added.set_name(std::string(section.name));
        added.set_owner(std::string(section.owner));
        added.set_stride_bytes(section.stride_bytes);
        added.set_derived(section.derived);
        added.set_entity_field(std::string(section.entity_field));
        for (const FieldDescriptor& field : section.fields) {
            forensics_format::Schema::Field& added_field = *added.add_fields();
            added_field.set_name(std::string(field.name));
            added_field.set_type(static_cast<std::uint32_t>(field.type));
            added_field.set_components(field.components);
            added_field.set_offset_bytes(field.offset_bytes);
            added_field.set_fraction_bits(field.fraction_bits);
            added_field.set_unit(std::string(field.unit));
            added_field.set_components_as(std::string(field.components_as));
        }
    }
}

Result<OwnedSchema> OwnedSchema::decode(const forensics_format::Schema& message) {
    if (Status status = check_limits(message); !status) {
        return status.error();
    }
    auto content = std::make_shared<Content>();
    for (const forensics_format::Schema::Section& section : message.sections()) {
        std::vector<FieldDescriptor> fields;
        for (const forensics_format::Schema::Field& field : section.fields()) {
            fields.push_back({field.name(),
                              static_cast<FieldType>(field.type()),
                              field.components(),
                              field.offset_bytes(),
                              field.fraction_bits(),
                              field.unit(),
                              field.components_as()});
        }
        content->add({section.name(),
                      section.owner(),
                      section.stride_bytes(),
                      section.derived(),
                      section.entity_field(),
                      fields});
    }
    if (Status status = check_schema(content->sections); !status) {
        return status.error();
    }
    OwnedSchema schema;
    schema.content_ = std::move(content);
    return schema;
}

} // namespace lockwind
