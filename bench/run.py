#!/usr/bin/env python3
"""Measures how fast time-continuous rays are, in all respects that docs/results.md shows, and writes that page.

    bench/run.py BUILD OUT [--quick] [--only PART,...] [--page DOCS]

BUILD: a folder with the programs built, as build/release. OUT: a folder for scenes, studies and numbers; interrupted, the
same command goes on from there. Measures again what was measured with other programs, options or scenes.

rays      time-continuous rays against the best discrete ray, building, bytes (bench_rays)
renders   the same with everything that a picture needs, in parts; one thread and two (bench_renders)
equal     error at equal time (kairos study)
auto      error and time of auto beside those of fixed choices (bench_auto)
light     lit pictures: error and time of auto, mixed and tc beside discrete samples (bench/light.py)
growth    with triangles, resolution, motion, key spans and sets of key times (bench_rays)

Then collects OUT/results/*.csv and, with --page, takes them to DOCS/results/ and writes the tables and plots of
DOCS/results.md. Needs nothing but Python's standard library.
"""

import argparse
import os
import pathlib
import platform
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import light  # noqa: E402
import page  # noqa: E402
import plan  # noqa: E402
from jobs import Jobs, collect, say, write_rows  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PARTS = ["rays", "renders", "equal", "auto", "light", "growth"]


def make_scene(folder, name, arguments, options):
    """Returns whether it is there."""
    done = subprocess.run([sys.executable, ROOT / "tools/make_scenes.py", name, "-o", folder, "--scenes", options.scenes,
                           *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0 and "left out" not in done.stdout:
        sys.exit(f"tools/make_scenes.py {name}: {done.stdout}")
    return done.returncode == 0


class Benchmark:
    def __init__(self, options):
        self.options, self.out = options, options.out.resolve()
        self.effort = plan.TINY if options.tiny else plan.QUICK if options.quick else plan.FULL
        self.jobs = Jobs(options.build.resolve(), self.out)
        self.scenes = {}  # name for make_scenes.py: folder, or None where it is not there

    def scene_file(self, shot):
        """The path, or None."""
        name = shot.maker()
        if name not in self.scenes:
            folder = self.out / "scenes"
            there = make_scene(folder, name, ["--scale", str(self.effort.scale)], self.options)
            self.scenes[name] = folder / name if there else None
        folder = self.scenes[name]
        if folder is None:
            return None
        return folder.parent / shot.scene

    def scene_digest(self, path):
        return self.jobs.digest_of(sorted(file for file in path.parent.rglob("*") if file.is_file()))

    def shots(self, part):
        """Those whose scene is there, with its file."""
        for shot in plan.SHOTS:
            if shot.name in self.effort.left_out or (shot.only_equal and part not in ("equal", "auto")):
                continue
            path = self.scene_file(shot)
            if path is None:
                self.jobs.leave_out(f"{part}: {shot.name}", f"needs third parties' scenes in {self.options.scenes}")
            else:
                yield shot, path

    def size(self, shot):
        if shot.side:
            side = max(1, round(shot.side * self.effort.side_scale))
            return f"{side}x{side}"
        return self.effort.large_size if shot.large else self.effort.shot_size

    def ray_options(self, keys=None, build_rounds=None):
        e = self.effort
        return ["--tiles", e.tiles, "--incoherent", e.incoherent, "--rounds", e.rounds, "--build-rounds",
                e.build_rounds if build_rounds is None else build_rounds, "--keys", keys or e.keys]

    def rays(self):
        results = []
        for shot, path in self.shots("rays"):
            command = ["bench_rays", path, "--size", self.size(shot), *shot.options, *self.ray_options()]
            results.append((shot.name, self.jobs.run("rays", shot.name, command, self.scene_digest(path))))
        collect(results, self.out / "results/rays.csv")

    def renders(self):
        e, results = self.effort, []
        for shot, path in self.shots("renders"):
            command = ["bench_renders", path, "--size", self.size(shot), *shot.options, "--rounds", e.render_rounds, "--bands", e.bands,
                       "--thread-rounds", e.thread_rounds, "--build-rounds", e.build_rounds if shot.builds else 0,
                       "--keys", e.keys]
            results.append((shot.name, self.jobs.run("renders", shot.name, command, self.scene_digest(path))))
        collect(results, self.out / "results/renders.csv")

    def equal(self):
        e, results = self.effort, {"comparisons": [], "curves": [], "references": []}
        for shot, path in self.shots("equal"):
            if shot.large or shot.name == "garden-960":
                continue  # costs differ from those of the smaller picture, hardly the errors
            frame = ["--size", self.size(shot), "--rows", e.study_rows]
            folder = self.out / "studies" / shot.name
            command = ["kairos", "study", path, "-o", folder, *frame, *shot.options, "--methods",
                       "multi-jitter,owen-sobol,tc,auto", "--tc-rays", e.tc_rays, "--shading-samples", "8", "--budgets",
                       e.more_budgets if shot.dear else e.budgets, "--keys", e.keys, "--seeds",
                       self.options.seeds or e.seeds, "--reference-spp", e.reference_spp]
            # A study knows by itself where it was interrupted; another program or scene means another study.
            result, begun = folder / "comparisons.csv", folder.parent / f"{shot.name}.begun"
            stamp = self.jobs.stamp(command, self.scene_digest(path))
            if not self.jobs.is_done(result, stamp):
                result.unlink(missing_ok=True)
                folder.parent.mkdir(parents=True, exist_ok=True)
                same = begun.exists() and begun.read_text() == str(stamp)
                begun.write_text(str(stamp))
                words = [str(self.jobs.bin / "kairos"), *(str(word) for word in command[1:])]
                self.jobs.call(f"equal: {shot.name}", words if same else [*words, "--force"])
                self.jobs.mark_done(result, stamp)
            for kind in results:
                results[kind].append((shot.name, folder / f"{kind}.csv"))
        for kind, files in results.items():
            collect(files, self.out / f"results/equal_{kind}.csv")

    def auto(self):
        results = []
        for shot, path in self.shots("auto"):
            if shot.large or shot.name in ("garden-960", "forest"):
                continue
            width, height = self.size(shot).split("x")
            size = f"{max(1, int(width) // 2)}x{max(1, int(height) // 2)}"
            command = ["bench_auto", path, "--size", size, *shot.options, *self.effort.auto]
            results.append((shot.name, self.jobs.run("auto", shot.name, command, self.scene_digest(path))))
        collect(results, self.out / "results/auto.csv")

    def light(self):
        results = []
        for name, file in light.SCENES.items():
            if name in self.effort.unlit:
                continue
            if file.split("/")[0] not in self.scenes:
                there = make_scene(self.out / "scenes", file.split("/")[0], ["--scale", str(self.effort.scale)], self.options)
                self.scenes[file.split("/")[0]] = self.out / "scenes" if there else None
            if self.scenes[file.split("/")[0]] is None:
                self.jobs.leave_out(f"light: {name}", f"needs third parties' scenes in {self.options.scenes}")
                continue
            program = self.jobs.bin / "kairos"
            command = [ROOT / "bench/light.py", self.out / "scenes", "--kairos", program, "--scenes", name, *self.effort.light]
            results.append((name, self.jobs.run("light", name, command, self.scene_digest(self.out / "scenes" / file))))
        collect(results, self.out / "results/light.csv")

    def growth(self):
        results = []
        for point in plan.growth_points(self.effort):
            made = None
            if point.triangles:
                made = self.out / "growth" / point.name().replace("/", "_")
                arguments = ["--scale", str(point.triangles / plan.TRIANGLES_OF_SCALE_ONE), "--motion",
                             str(point.motion), "--spans", str(point.spans)]
                if point.sets:
                    arguments += ["--meshes", str(max(point.sets, plan.MESHES)), "--sets", str(point.sets)]
                path, scene = made / point.series / "scene.json", " ".join(arguments)
            else:
                shot = next(shot for shot in plan.SHOTS if shot.name == point.series)
                path = self.scene_file(shot)
                if path is None:
                    self.jobs.leave_out(f"growth: {point.name()}", f"needs third parties' scenes in {self.options.scenes}")
                    continue
                scene = self.scene_digest(path)
            special = () if made else (plan.KEYS_OF_KITCHEN, 0)
            if point.triangles > plan.MOST_TRIANGLES_FOR_KEYS:
                special = ("0", 1)
            command = ["bench_rays", path, "--size", point.size, *self.ray_options(*special)]
            result = self.jobs.raw / "growth" / (point.name().replace("/", "_") + ".csv")
            if made and not self.jobs.is_done(result, self.jobs.stamp(command, scene)):
                make_scene(made, point.series, arguments, self.options)
            results.append((point.name(), self.jobs.run("growth", point.name(), command, scene)))
            if made:
                shutil.rmtree(made, ignore_errors=True)  # they are large, and quickly made
        collect(results, self.out / "results/growth.csv")

    def machine(self):
        processor = platform.processor() or platform.machine()
        info = pathlib.Path("/proc/cpuinfo")
        if info.exists():
            names = [line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")]
            processor = names[0] if names else processor
        git = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True)
        effort = "tiny" if self.options.tiny else "quick" if self.options.quick else "full"
        write_rows(self.out / "results/machine.csv",
                   [{"processor": processor, "cores": os.cpu_count(), "commit": git.stdout.strip() or "unknown",
                     "effort": effort}])


def arguments(words, check_build=True):
    """Ends the program where they make no sense."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, metavar="BUILD")
    parser.add_argument("out", type=pathlib.Path, metavar="OUT")
    parser.add_argument("--quick", action="store_true", help="little of everything; about ten minutes")
    parser.add_argument("--tiny", action="store_true", help="scenes of a few triangles: only to see that everything runs")
    parser.add_argument("--only", metavar="PART,...", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--seeds", type=int, help="of the studies")
    parser.add_argument("--page", type=pathlib.Path, metavar="DOCS", help="the folder with results.md")
    parser.add_argument("--scenes", type=pathlib.Path, metavar="FOLDER", help="third parties' scenes (docs/scenes.md)",
                        default=pathlib.Path(os.environ.get("KAIROS_SCENES", ROOT / "../shared/scenes")))
    options = parser.parse_args(words)
    options.only = options.only.split(",") if options.only else PARTS
    unknown = [part for part in options.only if part not in PARTS]
    if unknown:
        parser.error(f"no part '{unknown[0]}'; there are {', '.join(PARTS)}")
    if check_build and not (options.build / "bin/bench_rays").exists():
        parser.error(f"no program {options.build / 'bin/bench_rays'}; configure with -DKAIROS_BUILD_BENCH=ON and build")
    return options


def main():
    options = arguments(sys.argv[1:])
    benchmark = Benchmark(options)
    for part in PARTS:
        if part in options.only:
            getattr(benchmark, part)()
    benchmark.machine()
    if options.page:
        target = options.page / "results"
        target.mkdir(parents=True, exist_ok=True)
        for file in sorted((benchmark.out / "results").glob("*.csv")):
            shutil.copy(file, target / file.name)
        page.write(options.page)
        say(f"wrote {options.page / 'results.md'}")
    for what in benchmark.jobs.left_out:
        say(f"left out: {what}")


if __name__ == "__main__":
    main()
