#include "tests/fuzz/fuzz_target.h"
#include "tests/support/dice.h"

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
using lockwind::testing::Dice;

void mutate(Bytes& bytes, Dice& dice) {
    for (std::size_t edit = 0; edit <= dice.below(4) && !bytes.empty(); ++edit) {
        const std::size_t at = dice.below(bytes.size());
        switch (dice.below(5)) {
        case 0:
            bytes.resize(at);
            break;
        case 1:
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                         1 + dice.below(8),
                         static_cast<std::uint8_t>(dice.below(256)));
            break;
        case 2:
            bytes[at] = static_cast<std::uint8_t>(dice.below(2) * 0xff);
            break;
        default:
            bytes[at] ^= static_cast<std::uint8_t>(1U << dice.below(8));
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
    Dice dice(1);
    const long mutations = std::strtol(argv[2], nullptr, 10);
    for (long mutation = 0; mutation < mutations; ++mutation) {
        Bytes bytes = corpus[dice.below(corpus.size())];
        mutate(bytes, dice);
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
    std::printf("%zu files and %ld mutations of them\n", corpus.size(), mutations);
    return 0;
}
