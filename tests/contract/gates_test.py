#!/usr/bin/env python3
"""Each gate of scripts/check finds what it is there for, and finds nothing in the tree as it is.

Usage: tests/contract/gates_test.py --build DIR --compiler PATH
A plant is made in a temporary copy of the sources, or of the core's libraries.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "scripts"
FOLDERS = ["sim-core", "proto", "server", "client", "tests"]
OPTIONS = None


class Gate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="lockwind-gates-")
        self.addCleanup(folder.cleanup)
        self.copy = pathlib.Path(folder.name)

    def run_gate(self, *command):
        """(exit code, output) of a gate."""
        run = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    def expect_clean(self, *command):
        code, output = self.run_gate(*command)
        self.assertEqual(code, 0, output)

    def expect_caught(self, word, *command):
        code, output = self.run_gate(*command)
        self.assertEqual(code, 1, output)
        self.assertIn(word, output)


class SourceGate(Gate):
    def setUp(self):
        super().setUp()
        for folder in FOLDERS:
            shutil.copytree(ROOT / folder, self.copy / folder,
                            ignore=shutil.ignore_patterns("build", "__pycache__"))
        shutil.copy(ROOT / ".clang-format", self.copy)

    def plant(self, file, text):
        """Appends to a file of the copy, or makes it."""
        with open(self.copy / file, "a", encoding="utf-8") as planted:
            planted.write(text)


class Layers(SourceGate):
    gate = SCRIPTS / "check_layers.py"

    def check(self):
        return (self.gate, "--root", self.copy)

    def test_passes_a_clean_tree(self):
        self.expect_clean(*self.check())

    def test_catches_an_upward_include(self):
        self.plant("sim-core/src/base/planted.cpp", '#include "dynamics/body.h"\n')
        self.expect_caught("planted.cpp:1: base includes dynamics/body.h", *self.check())

    def test_catches_an_upward_include_of_a_public_header(self):
        self.plant("sim-core/src/geometry/planted.h", '#include "lockwind/world.h"\n')
        self.expect_caught("planted.h:1: geometry includes lockwind/world.h", *self.check())

    def test_catches_one_wing_looking_at_the_other(self):
        self.plant("sim-core/src/session/planted.h", '#include "lockwind/world.h"\n')
        self.expect_caught("session includes lockwind/world.h of world", *self.check())

    def test_catches_messages_outside_the_codec(self):
        self.plant("server/match/planted.h", '#include "messages.pb.h"\n')
        self.expect_caught("match includes messages.pb.h", *self.check())

    def test_catches_dds_outside_its_transport(self):
        self.plant("client/bot/planted.h", "#include <dds/dds.h>\n")
        self.expect_caught("bot includes dds/dds.h", *self.check())

    def test_catches_a_command_line_in_a_library(self):
        self.plant("server/match/planted.h", "#include <CLI/CLI.hpp>\n")
        self.expect_caught("match includes CLI/CLI.hpp", *self.check())

    def test_catches_a_public_header_without_a_layer(self):
        self.plant("sim-core/include/lockwind/planted.h", "#pragma once\n")
        self.expect_caught("planted.h:1: belongs to no layer", *self.check())


class Determinism(SourceGate):
    gate = SCRIPTS / "check_determinism.py"

    # Line, word, text.
    PLANTS = [
        (1, "float", "float half(int x) { return x * 0.5F; }"),
        (1, "double", "inline double planted(long double x) { return x; }"),
        (2, "unordered_map", "#include <unordered_map>\nstd::unordered_map<int, int> f();"),
        (1, "std::hash", "auto f(int x) { return std::hash<int>()(x); }"),
        (1, "rand(", "int f() { return rand(); }"),
        (1, "std::mt19937", "int f(std::mt19937& draws);"),
        (1, "<thread>", "#include <thread>"),
        (2, "thread_local", "int f() {\n    thread_local int x = 0;\n    return ++x;\n}"),
        (1, "<chrono>", "#include <chrono>"),
        (1, "__TIME__", "const char* f() { return __TIME__; }"),
        (1, "<iostream>", "#include <iostream>"),
        (1, "<cmath>", "#include <cmath>"),
        (1, "strtod", "auto f(const char* x) { return strtod(x, nullptr); }"),
        (1, "getenv", 'auto f() { return getenv("X"); }'),
        (2, "std::map<Body*", "#include <map>\nint f(std::map<Body*, int>&);"),
        (1, "throw", "void f() { throw 1; }"),
        (2, "mutable", "struct Cache {\n    mutable int hits;\n};"),
        (2, "mutable static", "int f() {\n    static int calls = 0;\n    return ++calls;\n}"),
        (2, "mutable static", "int f() {\n    static const char* last;\n    return 0;\n}"),
        (1, "mutable static", "int planted_count = 0;"),
        (1, "mutable static", "inline std::vector<int> planted_list;"),
    ]

    def check(self):
        return (self.gate, "--root", self.copy)

    def test_passes_a_clean_tree(self):
        self.expect_clean(*self.check())

    def test_catches_each_denied_word(self):
        for number, (_, _, text) in enumerate(self.PLANTS):
            self.plant(f"sim-core/src/dynamics/planted_{number}.cpp", text + "\n")
        code, output = self.run_gate(*self.check())
        self.assertEqual(code, 1, output)
        for number, (line, word, text) in enumerate(self.PLANTS):
            with self.subTest(text):
                self.assertRegex(output, rf"planted_{number}\.cpp:{line}: .*{re.escape(word)}")

    def test_lets_words_pass_that_do_nothing(self):
        self.plant("sim-core/src/dynamics/planted.h",
                   "// A float, std::rand() and <cmath> in a comment.\n"
                   "/* static int x; */\n"
                   "inline const char* f() { return \"double rand() throw\"; }\n"
                   "static constexpr int kOne = 1;\n"
                   "constexpr const char* kName = \"x\";\n"
                   "static int helper(int x);\n"
                   "inline namespace wrapping {\n"
                   "inline int twice(int x) {\n    return 2 * x;\n}\n"
                   "} // namespace wrapping\n"
                   "consteval int g(double x) { return static_cast<int>(x); }\n"
                   "constexpr auto kNext = [](int x) mutable { return ++x; };\n"
                   "inline long seed(long x) {\n"
                   "    return (long)(double)x; // float seed: corrected by the loop below\n}\n")
        self.expect_clean(*self.check())


class Format(SourceGate):
    gate = SCRIPTS / "check_format"

    def check(self):
        return (self.gate, "--root", self.copy)

    def test_catches_an_unformatted_line(self):
        for folder in FOLDERS:
            shutil.rmtree(self.copy / folder)
            (self.copy / folder).mkdir()
        self.plant("sim-core/tidy.h", "#pragma once\n\nint f();\n")
        self.expect_clean(*self.check())
        self.plant("server/planted.cpp", "int  f( ){return 1 ;}\n")
        self.expect_caught("planted.cpp:1", *self.check())


class Setup(unittest.TestCase):
    """The one script that no other test runs: on a machine that has all it does nothing."""

    def test_lists_every_package_with_its_reason(self):
        done = subprocess.run([SCRIPTS / "setup", "--list"], capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        lines = done.stdout.splitlines()
        self.assertGreater(len(lines), 20)
        for line in lines:
            self.assertRegex(line, r"^[a-z0-9][a-z0-9.+-]* *\| \S.*$")


class Symbols(Gate):
    gate = SCRIPTS / "check_symbols"

    PLANTS = [
        ("imports sin of libm", 'extern "C" double sin(double);\ndouble f(double x) { return sin(x); }'),
        ("imports fmaf of libm", 'extern "C" float fmaf(float, float, float);\n'
                                 "float f(float x) { return fmaf(x, x, x); }"),
        ("a clock", "#include <ctime>\nlong f() { return std::time(nullptr); }"),
        ("a clock", "#include <chrono>\nlong f() { return std::chrono::steady_clock::now()"
                    ".time_since_epoch().count(); }"),
        ("single-threaded", "#include <pthread.h>\nvoid f() { pthread_exit(nullptr); }"),
        ("lazy statics", "struct S { S(); int x; };\nint f() { static S s; return s.x; }"),
        ("streams", "#include <iostream>\nvoid f() { std::cout << 1; }"),
        ("random numbers", "#include <cstdlib>\nint f() { return std::rand(); }"),
        ("float conversion", "#include <cstdlib>\ndouble f(const char* x) { return strtod(x, nullptr); }"),
        ("the surroundings", '#include <cstdlib>\nchar* f() { return std::getenv("X"); }'),
        ("planted_count lies in .bss: mutable static", "int planted_count;"),
        ("planted_count lies in .data: mutable static", "int planted_count = 7;"),
        ("mutable static", "int f() { static int calls = 0; return ++calls; }"),
    ]

    def setUp(self):
        super().setUp()
        (self.copy / "sim-core").mkdir()
        for library in (OPTIONS.build / "sim-core").glob("liblockwind_*.a"):
            shutil.copy(library, self.copy / "sim-core")

    def check(self):
        return (self.gate, "--build", self.copy)

    def test_passes_the_core(self):
        self.expect_clean(*self.check())

    def plant(self, name, text, *flags):
        """Compiles the text into the copy of the math library."""
        source = self.copy / f"{name}.cpp"
        source.write_text(text + "\n", encoding="utf-8")
        planted = self.copy / f"{name}.o"
        subprocess.run([OPTIONS.compiler, "-O2", *flags, "-c", source, "-o", planted], check=True)
        library = self.copy / "sim-core/liblockwind_math.a"
        subprocess.run(["ar", "r", library, planted], check=True)

    def test_catches_each_denied_symbol(self):
        for number, (_, text) in enumerate(self.PLANTS):
            self.plant(f"planted_{number}", text)
        code, output = self.run_gate(*self.check())
        self.assertEqual(code, 1, output)
        for number, (word, text) in enumerate(self.PLANTS):
            with self.subTest(text):
                self.assertRegex(output, rf"math\.a\(planted_{number}\.o\): .*{re.escape(word)}")

    def test_lets_constant_tables_pass(self):
        self.plant("tables", 'extern const char* const kNames[];\n'
                             'const char* const kNames[] = {"a", "b"};', "-fPIE")
        self.expect_clean(*self.check())

    def test_catches_what_a_vector_file_shares(self):
        text = ("namespace N_AVX2 { template <class T> [[gnu::noinline]] T own(T x) { return x + 1; } }\n"
                "%sint f(int x) { return N_AVX2::own(x)%s; }")
        self.plant("avx2.cpp", text % ("", ""))
        self.expect_clean(*self.check())
        self.plant("avx2.cpp", text % ("template <class T> [[gnu::noinline]] T planted(T x) { return x * x; }\n",
                                       " + planted(x)"))
        self.expect_caught("(avx2.cpp.o): shares int planted<int>(int)", *self.check())

    def test_refuses_to_pass_without_the_core(self):
        (self.copy / "sim-core/liblockwind_world.a").unlink()
        self.expect_caught("liblockwind_world.a is missing", *self.check())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--compiler", required=True)
    OPTIONS, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest])
