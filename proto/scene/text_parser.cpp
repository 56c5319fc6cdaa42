#include "scene/text_parser.h"

#include "scene/scene.h"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <string>
#include <vector>

namespace lockwind {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::DescriptorPool;
using google::protobuf::TextFormat;

struct Place {
    int line;
    int column;
};

std::vector<std::string> quoted_words(const std::string& message) {
    std::vector<std::string> words;
    std::size_t begin = message.find('"');
    while (begin != std::string::npos) {
        const std::size_t end = message.find('"', begin + 1);
        if (end == std::string::npos) {
            break;
        }
        words.push_back(message.substr(begin + 1, end - begin - 1));
        begin = message.find('"', end + 1);
    }
    return words;
}

bool begins_with(const std::string& text, std::string_view prefix) {
    return text.compare(0, prefix.size(), prefix) == 0;
}

std::string fields_of(const std::string& type) {
    const Descriptor* message = DescriptorPool::generated_pool()->FindMessageTypeByName(type);
    std::string names;
    for (int index = 0; message != nullptr && index < message->field_count(); ++index) {
        names += (index == 0 ? "" : ", ") + message->field(index)->name();
    }
    return names;
}

/// The values of the field, which has the same enumeration in all messages that have it.
std::string values_of(const std::string& field) {
    const google::protobuf::FileDescriptor& file = *scene_text::Scene::descriptor()->file();
    std::string names;
    for (int index = 0; index < file.message_type_count() && names.empty(); ++index) {
        const auto* found = file.message_type(index)->FindFieldByName(field);
        const auto* type = found != nullptr ? found->enum_type() : nullptr;
        for (int value = 0; type != nullptr && value < type->value_count(); ++value) {
            names += (value == 0 ? "" : ", ") + type->value(value)->name();
        }
    }
    return names;
}

/// The parser's complaints in this project's words. The parser reports an unknown name when it
/// already stands behind it, perhaps on another line, so those are looked up again in the text.
class ParserErrors : public google::protobuf::io::ErrorCollector {
public:
    ParserErrors(std::string_view text, SceneErrors& errors) : text_(text), errors_(errors) {}

    void AddError(int line,
                  google::protobuf::io::ColumnNumber column,
                  const std::string& what) override {
        const std::vector<std::string> words = quoted_words(what);
        if (begins_with(what, "Message type") && words.size() == 2) {
            const std::string type = words[0].substr(words[0].rfind('.') + 1);
            const Place place = place_before({line, column}, words[1]);
            errors_.add(place.line,
                        place.column,
                        type + " has no field \"" + words[1] +
                            "\"; it has: " + fields_of(words[0]));
        } else if (begins_with(what, "Unknown enumeration value") && words.size() == 2) {
            const Place place = place_before({line, column}, words[0]);
            errors_.add(place.line,
                        place.column,
                        words[1] + " cannot be \"" + words[0] +
                            "\"; it is one of: " + values_of(words[1]));
        } else {
            errors_.add(line, column, what);
        }
    }

private:
    /// Where `word` last begins before `place`; `place` itself where it does not.
    Place place_before(Place place, const std::string& word) const {
        std::size_t at = 0;
        for (int line = 0; line < place.line && at != std::string_view::npos; ++line) {
            at = text_.find('\n', at);
            at = at == std::string_view::npos ? at : at + 1;
        }
        if (at == std::string_view::npos) {
            return place;
        }
        // The parser counts a tab to the next multiple of eight: a limit a little far is harmless.
        const std::size_t limit = at + static_cast<std::size_t>(place.column);
        const std::size_t found =
            limit < word.size() ? std::string_view::npos : text_.rfind(word, limit - word.size());
        if (found == std::string_view::npos) {
            return place;
        }
        Place result{0, 0};
        for (const char c : text_.substr(0, found)) {
            result = c == '\n' ? Place{result.line + 1, 0} : Place{result.line, result.column + 1};
        }
        return result;
    }

    std::string_view text_;
    SceneErrors& errors_;
};

} // namespace

bool parse_scene_text(std::string_view text,
                      scene_text::Scene& scene,
                      TextFormat::ParseInfoTree& tree,
                      SceneErrors& errors) {
    if (text.size() > kSceneTextSizeBytesMax) {
        errors.add(-1,
                   -1,
                   "the text is longer than " + std::to_string(kSceneTextSizeBytesMax) +
                       " bytes; use arrangements instead of single bodies");
        return false;
    }
    ParserErrors parser_errors(text, errors);
    TextFormat::Parser parser;
    parser.RecordErrorsTo(&parser_errors);
    parser.WriteLocationsTo(&tree);
    parser.SetRecursionLimit(16);
    google::protobuf::io::ArrayInputStream input(text.data(), static_cast<int>(text.size()));
    return parser.Parse(&input, &scene) && !errors.any();
}

} // namespace lockwind
