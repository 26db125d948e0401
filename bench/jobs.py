"""Runs one program after the other and keeps what they have measured, so that an interrupted benchmark goes on."""

import csv
import hashlib
import json
import pathlib
import resource
import shlex
import subprocess
import sys
import time


def say(text):
    print(text, file=sys.stderr, flush=True)


def processor_seconds():
    """Of all programs run so far."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Jobs:
    """build: folder of the build; out: where everything goes."""

    def __init__(self, build, out):
        self.bin, self.out = build / "bin", out
        self.raw = out / "raw"
        self.digest = {}
        self.libraries = sorted((build / "lib").glob("libkairos.*"))
        self.left_out = []

    def digest_of(self, paths):
        """Of their contents: what was measured with other programs or scenes does not count."""
        sum_of_all = hashlib.sha256()
        for path in paths:
            if path not in self.digest:
                self.digest[path] = hashlib.sha256(path.read_bytes()).hexdigest()
            sum_of_all.update(self.digest[path].encode())
        return sum_of_all.hexdigest()[:16]

    def stamp(self, command, scene):
        return {"command": " ".join(str(word) for word in command), "scene": scene,
                "program": self.digest_of([*self.libraries, self.bin / command[0]])}

    def is_done(self, result, stamp):
        path = result.with_suffix(".json")
        return result.exists() and path.exists() and json.loads(path.read_text()) == stamp

    def mark_done(self, result, stamp):
        result.with_suffix(".json").write_text(json.dumps(stamp, indent=1) + "\n")

    def run(self, part, name, command, scene):
        """command: with the program's name first; `--csv FILE` is added. scene: what stands for the scene's contents.
        Returns the file of numbers."""
        result = self.raw / part / (name.replace("/", "_") + ".csv")
        stamp = self.stamp(command, scene)
        if self.is_done(result, stamp):
            return result
        result.parent.mkdir(parents=True, exist_ok=True)
        unfinished = result.with_suffix(".part")
        words = [str(self.bin / command[0]), *(str(word) for word in command[1:]), "--csv", str(unfinished)]
        self.call(f"{part}: {name}", words)
        unfinished.replace(result)
        self.mark_done(result, stamp)
        return result

    def call(self, what, words):
        start, processor = time.monotonic(), processor_seconds()
        done = subprocess.run(words, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(f"{what}: status {done.returncode} from {shlex.join(words)}\n{done.stderr}")
        say(f"{what}: {time.monotonic() - start:.1f} s ({processor_seconds() - processor:.1f} of the processor's)")

    def leave_out(self, what, why):
        self.left_out.append(f"{what} ({why})")


def read_rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def write_rows(path, rows):
    """All rows have the fields of the first."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def collect(results, path):
    """results: list of (name of a point, file). One file, with the name in front of each line."""
    rows = [{"point": name, **row} for name, result in results for row in read_rows(result)]
    if rows:
        write_rows(pathlib.Path(path), rows)
