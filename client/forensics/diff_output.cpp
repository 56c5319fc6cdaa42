#include "forensics/diff_output.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace lockwind {

namespace {

using Json = nlohmann::ordered_json;

/// "0.25 m/s (raw 262144)"
std::string value_text(const FieldDiff& field, const FieldValue& value) {
    if (value.raw.empty()) {
        return "(no such row)";
    }
    std::string text = value.decimal;
    text += field.unit.empty() ? "" : " " + field.unit;
    if (value.raw != value.decimal || !field.unit.empty()) {
        text += " (raw " + value.raw + ")";
    }
    return text;
}

/// "body 17 position.x"
std::string place_text(const FieldDiff& field) {
    std::string text;
    for (const std::string* part : {&field.section, &field.entity, &field.field}) {
        text += part->empty() || text.empty() ? "" : " ";
        text += *part;
    }
    return text;
}

void add_line(std::string& text, const std::string& name, const std::string& value) {
    constexpr std::size_t kNameWidth = 12;
    if (!value.empty()) {
        text += "  " + name + std::string(kNameWidth - std::min(kNameWidth - 1, name.size()), ' ') +
                value + "\n";
    }
}

void add_more_fields(const DiffResult& result, std::string& text) {
    if (result.field_count < 2) {
        return;
    }
    text += "  " + std::to_string(result.field_count - 1) + " more:\n";
    std::size_t width = 0;
    for (std::size_t index = 1; index < result.fields.size(); ++index) {
        width = std::max(width, place_text(result.fields[index]).size());
    }
    for (std::size_t index = 1; index < result.fields.size(); ++index) {
        const FieldDiff& field = result.fields[index];
        const std::string place = place_text(field);
        text += "    " + place + std::string(width - place.size() + 2, ' ') +
                value_text(field, field.a) + "  |  " + value_text(field, field.b) + "\n";
    }
    if (result.field_count > result.fields.size()) {
        text += "    ...\n";
    }
}

/// A number where it is one, so that no reader has to parse it; else text.
Json raw_json(const std::string& raw) {
    const std::string digits = raw.substr(raw.starts_with('-') ? 1 : 0);
    const bool number = !digits.empty() && digits.size() <= 20 &&
                        digits.find_first_not_of("0123456789") == std::string::npos;
    Json value = number ? Json::parse(raw, nullptr, false) : Json(raw);
    return value.is_number_integer() ? value : Json(raw);
}

Json value_json(const FieldDiff& field, const FieldValue& value) {
    if (value.raw.empty()) {
        return nullptr;
    }
    return {{"raw", raw_json(value.raw)}, {"decimal", value.decimal}, {"unit", field.unit}};
}

Json text_or_null(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

Json field_json(const FieldDiff& field) {
    return {{"section", text_or_null(field.section)},
            {"entity", text_or_null(field.entity)},
            {"field", field.field},
            {"a", value_json(field, field.a)},
            {"b", value_json(field, field.b)}};
}

/// What XML 1.0 cannot hold even escaped becomes '?'.
std::string escape_xml(const std::string& text) {
    std::string escaped;
    for (const char letter : text) {
        const auto code = static_cast<unsigned char>(letter);
        switch (letter) {
        case '&':
            escaped += "&amp;";
            break;
        case '<':
            escaped += "&lt;";
            break;
        case '>':
            escaped += "&gt;";
            break;
        case '"':
            escaped += "&quot;";
            break;
        default:
            escaped += code < 0x20 && letter != '\n' && letter != '\t' ? '?' : letter;
        }
    }
    return escaped;
}

std::string headline(const DiffResult& result) {
    if (result.same) {
        return "same";
    }
    std::string text = "diverged";
    text += result.first_tick ? " at tick " + std::to_string(*result.first_tick) : "";
    text += result.phase.empty() ? "" : ", phase " + result.phase;
    return text;
}

} // namespace

std::string diff_text(const DiffResult& result) {
    std::string text = headline(result) + "\n";
    add_line(text, "verdict", result.verdict ? std::string(to_text(*result.verdict)) : "");
    if (result.fields.empty()) {
        add_line(text, "section", result.section);
    } else {
        const FieldDiff& first = result.fields.front();
        add_line(text, "section", first.section);
        add_line(text, "entity", first.entity);
        add_line(text, "field", first.field);
        add_line(text, result.name_a.empty() ? "a" : result.name_a, value_text(first, first.a));
        add_line(text, result.name_b.empty() ? "b" : result.name_b, value_text(first, first.b));
    }
    add_line(text, "because", result.reason);
    add_more_fields(result, text);
    return text;
}

std::string diff_json(const DiffResult& result) {
    Json json;
    json["same"] = result.same;
    json["first_tick"] = nullptr;
    if (result.first_tick) {
        json["first_tick"] = *result.first_tick;
    }
    json["phase"] = text_or_null(result.phase);
    json["section"] = text_or_null(result.section);
    for (const char* name : {"entity", "field", "a", "b"}) {
        json[name] = nullptr;
    }
    if (!result.fields.empty()) {
        const FieldDiff& first = result.fields.front();
        json["entity"] = text_or_null(first.entity);
        json["field"] = first.field;
        json["a"] = value_json(first, first.a);
        json["b"] = value_json(first, first.b);
    }
    json["verdict"] = result.verdict ? Json(to_text(*result.verdict)) : Json(nullptr);
    json["reason"] = text_or_null(result.reason);
    json["slot"] = result.slot ? Json(*result.slot) : Json(nullptr);
    json["name_a"] = text_or_null(result.name_a);
    json["name_b"] = text_or_null(result.name_b);
    json["field_count"] = result.field_count;
    json["fields"] = Json::array();
    for (const FieldDiff& field : result.fields) {
        json["fields"].push_back(field_json(field));
    }
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string diff_junit(const DiffResult& result, const std::string& subject) {
    const std::string failures = result.same ? "0" : "1";
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    xml += "<testsuites tests=\"1\" failures=\"" + failures + "\">\n";
    xml += "  <testsuite name=\"lockwind diff\" tests=\"1\" failures=\"" + failures +
           "\" errors=\"0\" skipped=\"0\">\n";
    xml += "    <testcase classname=\"lockwind.diff\" name=\"" + escape_xml(subject) + "\"";
    if (result.same) {
        xml += "/>\n";
    } else {
        xml += ">\n      <failure type=\"" +
               std::string(result.verdict ? to_text(*result.verdict) : "divergence") +
               "\" message=\"" + escape_xml(headline(result)) + "\">" +
               escape_xml(diff_text(result)) + "</failure>\n    </testcase>\n";
    }
    return xml + "  </testsuite>\n</testsuites>\n";
}

} // namespace lockwind
