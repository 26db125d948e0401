#!/usr/bin/env python3
"""Writes benchmark scenes, each into a folder of its own: DIR/NAME/scene.json and the files it names.

    tools/make_scenes.py NAME...|all -o DIR [--scale F] [--scenes FOLDER]

The same options give the same bytes. Needs Python's standard library only.
"""

import argparse
import importlib
import os
import pathlib
import sys

SCENES = ["foliage", "blades", "wires", "hall", "still", "fan", "glass", "marbles", "bars", "kitchen", "big", "terrain",
          "swarm", "crowd", "garden", "forest", "veils", "hair", "shade", "mirrors"]
# What of the folder of third parties' scenes they need.
NEEDS = {"hall": ["mannequiny"], "fan": ["vintage-fan"], "kitchen": ["bitterli-kitchen"],
         "big": ["bitterli-kitchen", "dutch-ship"]}


def main():
    sys.dont_write_bytecode = True
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", metavar="NAME", help=f"all, or of {', '.join(SCENES)}")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="DIR")
    parser.add_argument("--scale", type=float, default=1.0, help="how many things there are, relative to usual (%(default)s)")
    parser.add_argument("--spans", type=int, default=1, help="key spans of what deforms (%(default)s)")
    parser.add_argument("--motion", type=float, default=10.0, metavar="PIXELS",
                        help="how far things move, in terrain, swarm and garden (%(default)s)")
    parser.add_argument("--meshes", type=int, default=1, help="that the pebbles of swarm are spread over (%(default)s)")
    parser.add_argument("--sets", type=int, default=1,
                        help="of key times that those meshes have, each another; with several key spans (%(default)s)")
    parser.add_argument("--leaves", choices=("whole", "cut", "bare"), default="whole",
                        help="of garden: triangles, cards with a picture of opacity, cards whose picture is not there "
                             "(%(default)s)")
    third_parties = pathlib.Path(os.environ.get("KAIROS_SCENES", "../shared/scenes"))
    parser.add_argument("--scenes", type=pathlib.Path, default=third_parties, metavar="FOLDER",
                        help="third parties' scenes; $KAIROS_SCENES or %(default)s")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in SCENES and name != "all"]
    if unknown:
        parser.error(f"no scene '{unknown[0]}'; there are all, {', '.join(SCENES)}")
    if not 0 < options.scale <= 1000:
        parser.error("--scale: more than 0, at most 1000")
    if not 1 <= options.spans <= 64:
        parser.error("--spans: 1 to 64")
    if not 0 <= options.motion <= 100000:
        parser.error("--motion: 0 to 100000")
    if not 1 <= options.sets <= options.meshes <= 100000:
        parser.error("--sets, --meshes: 1 to 100000, and no more sets than meshes")
    for name in SCENES if "all" in options.names else options.names:
        absent = [part for part in NEEDS.get(name, []) if not (options.scenes / part).is_dir()]
        if absent:
            message = f"{name}: left out; it needs {options.scenes / absent[0]}, see --scenes"
            if name in options.names:
                sys.exit(message)
            print(message)
            continue
        folder = options.output / name
        folder.mkdir(parents=True, exist_ok=True)
        scene = importlib.import_module(f"scenes.{name}").make(folder, options)
        print(f"{scene.write()}: {scene.triangles} triangles of its own")


if __name__ == "__main__":
    main()
