#!/usr/bin/env python3
"""Words that have no place in sim-core: they could make two machines disagree (sim-core/README.md).

Usage: scripts/check_determinism.py [--root DIR]
Prints file:line, the word and why; exits 1 if there is any. Comments and strings do not count.
A double may be the seed of an exact integer correction: end such a line with "// float seed: why".
"""

import argparse
import pathlib
import re
import sys

SEED_MARK = "// float seed:"

DENIED = [
    (r"\b(?:float|double)\b", "floating point rounds as compilers and machines like"),
    (r"\bunordered_\w+", "iterates in an order that the library chooses"),
    (r"\bstd::hash\b", "differs between libraries"),
    (r"\b(?:std::)?(?:rand|srand|random|rand_r|drand48)\s*\(|\bstd::(?:random_device|mt19937\w*|"
     r"\w+_distribution)\b|<random>", "draw with lockwind/rng.h: counter-based, in the state"),
    (r"<(?:thread|mutex|atomic|future|condition_variable|shared_mutex|semaphore|barrier|latch|"
     r"stop_token|execution)>|\bstd::(?:j?thread|mutex|atomic\w*|async|future)\b|\bthread_local\b|"
     r"\bpthread_\w+", "the core is single-threaded: schedules differ"),
    (r"<(?:chrono|ctime|time\.h|sys/time\.h)>|\bstd::chrono\b|\bclock_gettime\b|"
     r"\bgettimeofday\b|\b__(?:DATE|TIME|TIMESTAMP)__\b", "Tick is the only time"),
    (r"<(?:iostream|fstream|sstream|istream|ostream|iomanip|locale|filesystem)>|"
     r"\bstd::(?:cout|cerr|clog|cin)\b", "the core does no input or output"),
    (r"<(?:cmath|math\.h|complex|valarray|cfenv|fenv\.h|cfloat)>|"
     r"\bstd::(?:sqrt|sin|cos|tan|atan2?|pow|exp|log|floor|ceil|round|fma|fabs|hypot)\s*\(\s*[a-z_]*"
     r"(?:double|float)", "libm differs between machines; use lockwind/fixed.h and trig.h"),
    (r"\b(?:strto[df]|strtold|atof|stod|stof|stold)\b", "the core reads no decimal text"),
    (r"\bgetenv\b|\bsetlocale\b", "the surroundings must not matter"),
    (r"\buintptr_t\b|\bintptr_t\b|\bstd::(?:map|set|less|greater)<(?:const )?[\w:]+ ?\*",
     "an order of addresses differs between runs"),
    (r"\b(?:throw|try|catch)\b", "the core has no exceptions: return a Result"),
    (r"(?<!\))\s\bmutable\b", "hidden state; what the next tick reads lies in the arena"),
]
DENIED = [(re.compile(pattern), why) for pattern, why in DENIED]

STATIC = re.compile(r"\bstatic\b(?P<type>[^;={(\[]*)(?P<end>[;={(\[])")
GLOBAL = re.compile(
    r"^(?!(?:using|namespace|inline namespace|struct|class|enum|union|template|typedef|friend|"
    r"static_assert|return|public|private|protected|case|__extension__|extern \"C\")\b|[}#])"
    r"(?P<type>[A-Za-z_][\w:<>,*& ]*\s[*&]?)\w+\s*(?:=[^=;]*|\{[^;]*|\[[^;]*)?;", re.MULTILINE)
MUTABLE_WHY = "mutable static: state outside the arena, shared by all worlds"

COMMENT_OR_STRING = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<tag>\w*)\(.*?\)(?P=tag)"|"(?:\\.|[^"\\\n])*"|'
    r"(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'", re.DOTALL)


def blank(text):
    """The text without comments and literals; every character keeps its place."""
    def spaces(match):
        return re.sub(r"[^\n]", " ", match.group(0))
    return COMMENT_OR_STRING.sub(spaces, text)


def is_immutable(declaration):
    """Whether what is declared (up to its name) is constant itself, not only what it points to."""
    if re.search(r"\bconstexpr\b", declaration):
        return True
    return re.search(r"\bconst\b", declaration.split("*")[-1]) is not None


def consteval_spans(code):
    """Character ranges of consteval functions: their doubles exist at compile time only."""
    spans = []
    for match in re.finditer(r"\bconsteval\b", code):
        depth = 0
        for index in range(match.end(), len(code)):
            if code[index] == "{":
                depth += 1
            elif code[index] == "}":
                depth -= 1
                if depth == 0:
                    spans.append((match.start(), index))
                    break
            elif code[index] == ";" and depth == 0:
                spans.append((match.start(), index))
                break
    return spans


def complaints_of(text):
    """(offset, word, why) for all that is denied in the text of one file."""
    code = blank(text)
    spans = consteval_spans(code)
    lines = text.split("\n")
    for pattern, why in DENIED:
        for match in pattern.finditer(code):
            if match.group(0) in ("float", "double"):
                line = lines[code.count("\n", 0, match.start())]
                inside = any(begin <= match.start() <= end for begin, end in spans)
                if inside or SEED_MARK in line:
                    continue
            yield match.start(), match.group(0).strip(), why
    for match in STATIC.finditer(code):
        if match.group("end") != "(" and not is_immutable(match.group("type")):
            yield match.start(), "static", MUTABLE_WHY
    for match in GLOBAL.finditer(code):
        if not is_immutable(match.group("type")) and "static" not in match.group("type"):
            yield match.start(), match.group(0).split("\n")[0].strip(), MUTABLE_WHY


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--root", type=pathlib.Path, default=default)
    root = parser.parse_args().root.resolve()
    files = [path for path in sorted((root / "sim-core").rglob("*"))
             if path.suffix in (".h", ".cpp")]
    if not files:
        sys.exit(f"check_determinism: no sources under {root}/sim-core")
    count = 0
    for path in files:
        text = path.read_text(encoding="utf-8")
        for offset, word, why in sorted(complaints_of(text)):
            line = text.count("\n", 0, offset) + 1
            print(f"{path.relative_to(root)}:{line}: {word}: {why}")
            count += 1
    print(f"check_determinism: {len(files)} files, {count} wrong")
    sys.exit(1 if count else 0)


if __name__ == "__main__":
    main()
