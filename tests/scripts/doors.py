"""What leads into the library and from room to room: public headers, exported symbols, includes.

Usage: doors.py headers|apps|symbols|rooms PROJECT_ROOT BUILD_DIR COMPILER

headers  each public header compiles alone, and includes the standard library and other public headers only
apps     the command line is compiled with the public headers alone: no folder of src/ is on its path
symbols  the shared library exports what the public headers mark with KAIROS_API, all of it and nothing else
rooms    each folder of src/ is in the table of docs/architecture.md, and includes only those above it
"""

import json
import pathlib
import re
import subprocess
import sys

what, root, build, compiler = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), sys.argv[4]
failures = []


def check(condition, message):
    if not condition:
        failures.append(message)


def includes(path):
    return re.findall(r"^\s*#\s*include\s*([<\"][^>\"]+[>\"])", path.read_text(), re.MULTILINE)


def check_headers():
    headers = sorted((root / "include/kairos").glob("*.h"))
    check(len(headers) > 5, f"only {len(headers)} public headers")
    for header in headers:
        for name in includes(header):
            standard = re.fullmatch(r"<[a-z_]+>|<std(def|int)\.h>", name)
            public = re.fullmatch(r"<kairos/[a-z_]+\.h>", name)
            check(standard or public, f"{header.name} includes {name}")
        # Twice, since each must bear that.
        text = f"#include <kairos/{header.name}>\n" * 2
        done = subprocess.run([compiler, "-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", "-fsyntax-only",
                               f"-I{root}/include", "-x", "c++", "-"], input=text, text=True, capture_output=True)
        check(done.returncode == 0, f"{header.name} does not compile alone:\n{done.stderr}")


def check_apps():
    sources = sorted((root / "apps").rglob("*.cpp"))
    check(len(sources) > 5, f"only {len(sources)} files of the command line")
    for source in sources:
        for name in includes(source):
            local = name.startswith('"')
            check(not local or (source.parent / name.strip('"')).exists(), f"{source.name} includes {name}, which is not its own")
    # Several sources may be compiled as one file of the build tree.
    commands = [entry["command"] for entry in json.loads((build / "compile_commands.json").read_text())
                if " -o apps/kairos/CMakeFiles/kairos_cli.dir/" in entry["command"]]
    check(commands, "the command line is compiled by no command")
    for command in commands:
        folders = re.findall(r"-(?:I|isystem|iquote)\s*(\S+)", command)
        inside = [f for f in folders if pathlib.Path(f).is_relative_to(root) and pathlib.Path(f) != root / "include"]
        check(not inside, f"the command line is compiled with {inside} on its path")
        check(str(root / "include") in folders, "the command line is not compiled with the public headers")


def public_names():
    """Classes and functions that the public headers mark, with their namespaces."""
    classes, functions = set(), set()
    for header in (root / "include/kairos").glob("*.h"):
        text = re.sub(r"//[^\n]*", "", header.read_text())
        if header.name == "export.h":
            continue
        inner = re.search(r"^namespace kairos::(\w+)", text, re.MULTILINE)
        place = f"kairos::{inner[1]}::" if inner else "kairos::"
        if header.name == "kairos.h":  # C
            place, text = "", re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        for match in re.finditer(r"KAIROS_API\s+", text):
            rest = text[match.end():]
            before = text[:match.start()].rstrip()
            if re.search(r"\b(class|struct)$", before):
                classes.add(f"{place}{re.match(r'[A-Za-z_]+', rest)[0]}")
                continue
            name = re.match(r"[^;({]*?(operator\S+?|\w+)\s*\(", rest)[1]
            # A marked member stands behind the last struct that has not ended: of those with two spaces before it.
            line = text[:match.start()].rsplit("\n", 1)[-1]
            owner = re.findall(r"^struct (\w+)[^;]*\{", text[:match.start()], re.MULTILINE)
            functions.add(f"{place}{owner[-1]}::{name}" if line.startswith("  ") and owner else f"{place}{name}")
    return classes, functions


def check_symbols():
    library = build / "lib/libkairos.so"
    shown = subprocess.run(["nm", "-DC", "--defined-only", library], text=True, capture_output=True, check=True).stdout
    classes, functions = public_names()
    check(len(classes) > 3 and len(functions) > 10, f"the headers mark {len(classes)} classes, {len(functions)} functions")
    found = set()
    for line in shown.splitlines():
        symbol = line.split(" ", 2)[2]
        name = re.sub(r"^(typeinfo name for|typeinfo for|vtable for) ", "", symbol)
        name = re.sub(r"(\[abi:\w+\])?\(.*", "", name)
        name = re.sub(r"^.* (?=kairos::)", "", name)  # of templates nm says what they return
        if re.fullmatch(r"kairos::kNames<[\w:]+>", name):  # the tables of names.h, which every program has for itself
            continue
        owner = next((c for c in classes if name == c or name.startswith(c + "::")), None)
        hidden_part = re.search(r"::(Impl|State)\b", name)
        check((owner or name in functions) and not hidden_part, f"exported, but not marked with KAIROS_API: {symbol}")
        found.add(owner or name)
    check(not functions - found, f"marked with KAIROS_API, but not exported: {sorted(functions - found)}")


def check_rooms():
    table = (root / "docs/architecture.md").read_text()
    rooms = re.findall(r"^\| `(\w+)/` \|", table, re.MULTILINE)
    check(len(rooms) > 10, f"the table has {len(rooms)} rooms")
    folders = {path.name for path in (root / "src").iterdir() if path.is_dir()}
    check(folders == set(rooms), f"rooms and folders of src/ differ: {sorted(folders ^ set(rooms))}")
    made = re.findall(r"^kairos_room\((\w+)", (root / "src/CMakeLists.txt").read_text(), re.MULTILINE)
    compiled = [room for room in rooms if any((root / "src" / room).rglob("*.cpp"))]
    check(made == compiled, f"src/CMakeLists.txt has the rooms in another order: {made}, and the table {compiled}")
    count = 0
    for room in folders & set(rooms):
        for source in (root / "src" / room).rglob("*.*"):
            if source.suffix not in (".h", ".cpp"):
                continue
            for name in includes(source):
                other = name.strip('"').split("/")[0]
                if not name.startswith('"') or other not in rooms:
                    continue
                count += 1
                check(rooms.index(other) <= rooms.index(room), f"src/{source.relative_to(root / 'src')} includes {name}: below it")
    check(count > 100, f"only {count} includes")


{"headers": check_headers, "apps": check_apps, "symbols": check_symbols, "rooms": check_rooms}[what]()
if failures:
    sys.exit("\n".join(failures))
