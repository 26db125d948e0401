"""What README.md and docs/ say, tried out.

Usage: docs.py commands|programs|python|options|references PROJECT_ROOT BUILD_DIR COMPILER

commands    every line of a ```sh block runs, in an empty folder that holds the demo scene and the program where the page says
            they are; and, where there is numpy, every ```python block without Kairos, on what the others have written
programs    every ```cpp and ```c block compiles, runs, and prints the ```text block that follows
python      every ```python block that imports kairos runs in such a folder, and prints the ```text block that follows
options     docs/command-line.md describes every subcommand and option that --help shows, and no other
references  links between pages lead somewhere, and so do the sections of docs/method.md that source files name
"""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

what, root, build, compiler = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), sys.argv[4]
pages = [root / "README.md", root / "CONTRIBUTING.md", root / "CHANGELOG.md", *sorted((root / "docs").glob("*.md"))]
failures = []


def check(condition, message):
    if not condition:
        failures.append(message)


def blocks(page, language):
    """(text, position of its end) of each fenced block of a language."""
    text = page.read_text()
    for match in re.finditer(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
        yield match[1], match.end()


def workshop():
    """A folder as a user has it who has run ./demo."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="kairos_docs_"))
    (folder / "build/release").mkdir(parents=True)
    (folder / "build/release/bin").symlink_to(build / "bin")
    for name in ("scenes", "tools"):
        (folder / name).symlink_to(root / name)
    (folder / "out").mkdir()
    shutil.copy(build / "demo.glb", folder / "out/demo.glb")
    shutil.copy(build / "demo.glb", folder / "demo.glb")
    return folder


def run(command, folder, **options):
    return subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300,
                          **options)


def check_commands():
    count = 0
    for page in pages:
        folder = workshop()
        for script, _ in blocks(page, "sh"):
            done = run(["bash", "-euo", "pipefail", "-c", script], folder)
            check(done.returncode == 0, f"{page.name}: status {done.returncode} from\n{script}\n{done.stdout}")
            for written in re.findall(r"(?:-o|--side-by-side|--stats-file) (\S+)", script):
                pattern = re.sub(r"%\d*d", "*", written)  # a sequence's name
                check(any(folder.glob(pattern)), f"{page.name}: nobody wrote {written}")
            count += 1
        for program, _ in blocks(page, "python"):
            if "import kairos" not in program and importlib.util.find_spec("numpy"):
                done = run([sys.executable, "-c", program], folder)
                check(done.returncode == 0, f"{page.name}: status {done.returncode} from\n{program}\n{done.stdout}")
        shutil.rmtree(folder)
    check(count >= 5, f"only {count} blocks of commands")


def check_programs():
    count = 0
    for page in pages:
        text = page.read_text()
        c = ["cc", "-std=c99"]
        for program, end, with_compiler in [(*block, [compiler, "-std=c++20"]) for block in blocks(page, "cpp")] + \
                                           [(*block, c) for block in blocks(page, "c")]:
            expected = re.search(r"```text\n(.*?)```", text[end:], re.DOTALL)
            if not expected:
                check(False, f"{page.name}: a program without the output it prints")
                continue
            folder = workshop()
            source = f"program.{'c' if with_compiler is c else 'cpp'}"
            (folder / source).write_text(program)
            done = run([*with_compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", source, "-o", "program",
                        f"-I{root}/include", f"-L{build}/lib", "-lkairos", f"-Wl,-rpath,{build}/lib"], folder)
            if done.returncode == 0:
                done = run(["./program"], folder)
            check(done.returncode == 0, f"{page.name}: status {done.returncode} from\n{program}\n{done.stdout}")
            check(done.stdout == expected[1], f"{page.name}: expected\n{expected[1]}got\n{done.stdout}")
            shutil.rmtree(folder)
            count += 1
    check(count >= 2, f"only {count} programs")


def check_python():
    count = 0
    environment = {**os.environ, "PYTHONPATH": str(build / "lib/python3/dist-packages")}
    for page in pages:
        text = page.read_text()
        for program, end in blocks(page, "python"):
            if "import kairos" not in program:
                continue
            expected = re.match(r"(?:\s*prints\s*|\s*)```text\n(.*?)```", text[end:], re.DOTALL)
            folder = workshop()
            done = run([sys.executable, "-W", "error", "-c", program], folder, env=environment)
            check(done.returncode == 0, f"{page.name}: status {done.returncode} from\n{program}\n{done.stdout}")
            check(expected is None or done.stdout == expected[1], f"{page.name}: expected\n{expected and expected[1]}got\n{done.stdout}")
            shutil.rmtree(folder)
            count += 1
    check(count >= 3, f"only {count} Python programs")
    examples = sorted((root / "examples").glob("*.py"))
    check(len(examples) >= 3, f"only {len(examples)} examples")
    for example in examples:
        folder = workshop()
        done = run([sys.executable, "-W", "error", example], folder, env=environment)
        check(done.returncode == 0, f"{example.name}: status {done.returncode}\n{done.stdout}")
        check((folder / f"{example.stem}.png").exists(), f"{example.name}: wrote no {example.stem}.png")
        shutil.rmtree(folder)


def check_options():
    kairos = build / "bin/kairos"
    page = (root / "docs/command-line.md").read_text()
    overview = run([kairos, "--help"], root).stdout
    commands = re.findall(r"^  ([a-z][a-z-]*)\b", overview.split("ubcommands:")[-1], re.MULTILINE)
    check(len(commands) >= 4, f"--help shows the subcommands {commands}")
    sections = dict(re.findall(r"^## kairos ([a-z-]+)\n(.*?)(?=^## |\Z)", page, re.DOTALL | re.MULTILINE))
    check(sorted(sections) == sorted(commands), f"sections {sorted(sections)} of the page, subcommands {sorted(commands)}")
    shared = re.search(r"^## Choosing the shot\n(.*?)(?=^## |\Z)", page, re.DOTALL | re.MULTILINE)[1]
    for command in commands:
        shown = set(re.findall(r"(--[a-z][a-z-]*)", run([kairos, command, "--help"], root).stdout)) - {"--help"}
        described = set(re.findall(r"^\| `(?:-\w, )?(--[a-z-]+)", sections.get(command, ""), re.MULTILINE))
        if "Choosing the shot" in sections.get(command, ""):
            described |= set(re.findall(r"^\| `(--[a-z-]+)", shared, re.MULTILINE))
        for listed in re.findall(r"takes the options of `render`[^(]*\(([^)]*)\)", sections.get(command, "")):
            described |= set(re.findall(r"`(--[a-z-]+)`", listed))
        check(len(shown) > 2 or command in ("check", "completion", "convert", "jobs"), f"kairos {command} --help shows {shown}")  # these have few options
        check(not shown - described, f"kairos {command}: not described: {sorted(shown - described)}")
        check(not described - shown, f"kairos {command}: described, but not in --help: {sorted(described - shown)}")


def anchors(page):
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def check_references():
    for page in pages:
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
            if "://" in target:
                continue
            path, _, anchor = target.partition("#")
            file = page.parent / path if path else page
            check(file.exists(), f"{page.name}: {target} leads nowhere")
            if anchor and file.exists():
                check(anchor in anchors(file), f"{page.name}: {target} names no heading")
    headings = set(re.findall(r"^#+ (.*)$", (root / "docs/method.md").read_text(), re.MULTILINE))
    count = 0
    for source in [path for folder in ("include", "src", "apps", "cmake", "bench") for path in (root / folder).rglob("*.*")]:
        text = re.sub(r"\s*\n\s*(//|#)\s*", " ", source.read_text())  # comments run over lines
        for section in re.findall(r'docs/method\.md, "([^"]+)"', text):
            check(section in headings, f"{source.relative_to(root)}: docs/method.md has no section \"{section}\"")
            count += 1
    check(count >= 3, f"only {count} references to the method")
    for path in re.findall(r"`((?:src|include|tools|docs|fuzz|tests)/[\w./-]+)`", "\n".join(p.read_text() for p in pages)):
        of_many = "NAME" in path or "FORMAT" in path  # what the page calls any of them
        check(of_many or (root / path).exists(), f"{path} is named but not there")


checks = {"commands": check_commands, "programs": check_programs, "python": check_python, "options": check_options, "references": check_references}
checks[what]()
if failures:
    sys.exit("\n\n".join(failures))
