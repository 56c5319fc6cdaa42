#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// Runs a fuzz target without a fuzzer: every file of a corpus, then seeded mutations of them.

namespace {

using Bytes = std::vector<std::uint8_t>;

/// SplitMix64.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}
    std::size_t below(std::size_t bound) {
        state_ += 0x9e3779b97f4a7c15U;
        std::uint64_t value = state_;
        value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
        value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
        return static_cast<std::size_t>((value ^ (value >> 31U)) % bound);
    }

private:
    std::uint64_t state_;
};

void mutate(Bytes& bytes, Draw& draw) {
    for (std::size_t edit = 0; edit <= draw.below(4) && !bytes.empty(); ++edit) {
        const std::size_t at = draw.below(bytes.size());
        switch (draw.below(5)) {
        case 0:
            bytes.resize(at);
            break;
        case 1:
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                         1 + draw.below(8),
                         static_cast<std::uint8_t>(draw.below(256)));
            break;
        case 2:
            bytes[at] = static_cast<std::uint8_t>(draw.below(2) * 0xff);
            break;
        default:
            bytes[at] ^= static_cast<std::uint8_t>(1U << draw.below(8));
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: %s CORPUS MUTATIONS\n", argv[0]);
        return 2;
    }
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::vector<Bytes> corpus;
    for (const std::filesystem::path& path : files) {
        std::ifstream file(path, std::ios::binary);
        corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        LLVMFuzzerTestOneInput(corpus.back().data(), corpus.back().size());
    }
    if (corpus.empty()) {
        std::fprintf(stderr, "%s: no file\n", argv[1]);
        return 1;
    }
    Draw draw(1);
    const long mutations = std::strtol(argv[2], nullptr, 10);
    for (long mutation = 0; mutation < mutations; ++mutation) {
        Bytes bytes = corpus[draw.below(corpus.size())];
        mutate(bytes, draw);
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
    std::printf("%zu files and %ld mutations of them\n", corpus.size(), mutations);
    return 0;
}
