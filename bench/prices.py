#!/usr/bin/env python3
"""What rays cost in scenes, measured by kairos calibrate, beside what auto estimates (src/policy/ray_prices.cpp).

    bench/prices.py SCENE... [--kairos build/release/bin/kairos] [--shading whitted] [--size 320x180]

Prints, for each scene, the nanoseconds of a discrete sample and the prices of 1, 4 and 16 time-continuous rays in discrete
samples, measured and estimated, and at the end the median of the ratios of 4 rays. Processor time of one thread: run it on a quiet machine.
"""
import argparse
import json
import os
import statistics
import subprocess
import tempfile


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--kairos", default="build/release/bin/kairos")
    parser.add_argument("--shading", default="whitted")
    parser.add_argument("--size", default="320x180")
    args = parser.parse_args()
    print("scene, ns of a discrete sample, measured prices of 1/4/16 rays, estimated ones, measured over estimated at 4")
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        measured_file, stats_file = os.path.join(folder, "measured.json"), os.path.join(folder, "stats.json")
        for scene in args.scenes:
            common = [scene, "--shading", args.shading, "--size", args.size, "--threads", "1", "--quiet"]
            run(args.kairos, "calibrate", *common, "-o", measured_file)
            run(args.kairos, "render", *common, "--integrator", "auto", "--spp", "4", "--crop", "0,1,0,1", "--stats-file", stats_file,
                "-o", os.path.join(folder, "picture.exr"))
            times = json.load(open(measured_file))["nanoseconds"]
            estimated = json.load(open(stats_file))["auto"]["prices"]["tc_ray"]
            prices = {rays: time / times["discrete_sample"] for rays, time in times["tc_ray"].items()}
            ratios.append(prices["4"] / estimated["4"])
            row = lambda values: " / ".join(f"{values[rays]:.1f}" for rays in ("1", "4", "16"))
            print(f"{scene}, {times['discrete_sample']:.0f}, {row(prices)}, {row(estimated)}, {ratios[-1]:.2f}", flush=True)
    print(f"median of the ratios: {statistics.median(ratios):.2f}")


if __name__ == "__main__":
    main()
