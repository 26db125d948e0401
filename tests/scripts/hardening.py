"""How the binaries are linked and guarded.

Usage: hardening.py LIBRARY FOLDER_OF_PROGRAMS [debug]

Every program of the build tree looks for libraries where it lies itself and nowhere else; the library and the command line are
position independent, bound before they start, without an executable stack, with guarded stack frames and checked copies
(the last two only where the compiler optimises).
"""

import pathlib
import re
import subprocess
import sys

library, programs, optimised = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), "debug" not in sys.argv
failures = []


def check(condition, message):
    if not condition:
        failures.append(message)


def readelf(option, path):
    return subprocess.run(["readelf", "-W", option, path], text=True, capture_output=True, check=True).stdout


def is_elf(path):
    with path.open("rb") as file:
        return file.read(4) == b"\x7fELF"


def check_search_path(path):
    for kind, text in re.findall(r"\((RPATH|RUNPATH)\).*\[(.*)\]", readelf("-d", path)):
        for element in text.split(":"):
            check(re.match(r"\$ORIGIN(/|$)", element), f"{path.name}: {kind} is '{text}', and '{element}' is not below $ORIGIN")


def check_guards(path, program):
    header, dynamic, segments = readelf("-h", path), readelf("-d", path), readelf("-l", path)
    symbols = readelf("--dyn-syms", path)
    check(re.search(r"Type:\s+DYN", header), f"{path.name}: not position independent")
    check(not program or "PIE" in dynamic, f"{path.name}: not linked as a position-independent program")
    check("GNU_RELRO" in segments and re.search(r"BIND_NOW|FLAGS.*\bNOW\b", dynamic), f"{path.name}: not bound before it starts")
    stack = re.search(r"GNU_STACK.*", segments)
    check(stack and not re.search(r"\bRWE\b", stack[0]), f"{path.name}: its stack may be executed")
    if optimised:
        check("__stack_chk_fail" in symbols, f"{path.name}: stack frames are not guarded")
    if optimised and not program:
        check(re.search(r"__\w+_chk\b(?<!__stack_chk)", symbols), f"{path.name}: copies of known size are not checked")


elves = [path for path in sorted(programs.iterdir()) if path.is_file() and is_elf(path)]
check(any(path.name == "kairos" for path in elves), f"no program 'kairos' in {programs}")
for elf in [library, *elves]:
    check_search_path(elf)
check_guards(library, program=False)
check_guards(programs / "kairos", program=True)

for failure in failures:
    print(failure, file=sys.stderr)
print(f"{len(elves)} programs, {len(failures)} failures")
sys.exit(1 if failures else 0)
