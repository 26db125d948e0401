"""The C interface as compilers and linkers see it, against its description in src/c_interface/kairos.abi.

Usage: abi.py PROJECT_ROOT BUILD_DIR C_COMPILER [--update]

abidiff compares the header's functions, structs and enums: a program that was built with the header of the description must run with this
library. New functions, and new fields at the ends of structs that say their size, are compatible; --update writes the description
anew, which is to be done for those alone until the library gets another SONAME. Without abidw (abigail-tools) this ends with status 77:
skipped.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

root, build, compiler = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
description = root / "src/c_interface/kairos.abi"
if shutil.which("abidw") is None:
    print("skipped: there is no abidw")
    sys.exit(77)


def run(*command):
    return subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


header = re.sub(r"/\*.*?\*/|//[^\n]*", "", (root / "include/kairos/kairos.h").read_text(), flags=re.DOTALL)
declarations = re.findall(r"KAIROS_API\s+([^;{}]*?\b(kairos_\w+)\s*\([^;{}]*\))\s*;", header)
functions = {name for _, name in declarations}

# Every one is there under its name, and nothing else is.
symbols = run("nm", "-D", "--defined-only", build / "lib/libkairos.so").stdout
exported = set(re.findall(r" T (kairos_\w+)", symbols))
if functions != exported or len(functions) < 20:
    sys.exit(f"declared and not exported: {sorted(functions - exported)}; exported and not declared: {sorted(exported - functions)}")

# The library is built without debugging information. What is compiled here has the same declarations, and does nothing.
with tempfile.TemporaryDirectory(prefix="kairos_abi_") as name:
    folder = pathlib.Path(name)
    bodies = "\n".join(f"{declaration} {{ __builtin_trap(); }}" for declaration, _ in declarations)
    # Constants are no part of what abidiff reads, but sizes are.
    constants = {name for body in re.findall(r"enum\s*\w*\s*{([^}]*)}", header) for name in re.findall(r"\b(KAIROS_\w+)\s*=", body)}
    sizes = "\n".join(f"char size_of_{name}[1 + {name}];" for name in sorted(constants))
    (folder / "kairos.c").write_text(f"#include <kairos/kairos.h>\n{bodies}\n{sizes}\n")
    library = folder / "libkairos.so"
    compiled = run(compiler, "-x", "c", "-std=c99", "-g", "-fPIC", "-shared", "-w", f"-fdebug-prefix-map={folder}=.", f"-I{root / 'include'}", folder / "kairos.c", "-o", library)
    if compiled.returncode != 0:
        sys.exit(compiled.stdout)
    if "--update" in sys.argv:
        made = run("abidw", "--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--no-architecture", library, "--out-file", description)
        sys.exit(made.stdout or made.returncode)
    compared = run("abidiff", "--no-show-locs", "--no-architecture", description, library)
    if compared.returncode != 0:
        sys.exit(f"the C interface has changed:\n{compared.stdout}\nWhere old programs still run with it: {' '.join(sys.argv)} --update")
