#!/usr/bin/env bash
# Runs the studies that docs/results.md quotes and writes their tables and plots: docs/results/ and docs/pictures/.
#
#   tools/results.sh build/release/bin/kairos OUT
#
# Takes about half an hour of one processor. Interrupted, it goes on where it stopped. Scenes made with those of third parties
# are left out where these are not there (docs/scenes.md).
set -euo pipefail
kairos=$(realpath "$1") out=$(realpath -m "$2")
cd "$(dirname "$0")/.."

tools/make_scenes.py kitchen hall foliage fan still glass -o "$out/scenes"

methods="--methods multi-jitter,owen-sobol,tc,auto --seeds 3 --shading-samples 8"
normal="--size 240x135 --tc-rays 1,2,4,8,16 --budgets 4,8,16,32,64,128,256 --reference-spp 1024"
whitted="--shading whitted --size 160x90 --tc-rays 1,2,4,8 --budgets 4,8,16,32,64 --reference-spp 1024"

study() {
  local folder=$1 scene=$2
  shift 2
  if [[ ! -e $out/scenes/$scene ]]; then
    echo "$scene is not there: left out"
    return
  fi
  # shellcheck disable=SC2086
  "$kairos" study "$out/scenes/$scene" -o "$out/studies/$folder" $methods "$@"
}

# shellcheck disable=SC2086
{
  study kitchen_fast kitchen/fast.pbrt $normal
  study kitchen kitchen/scene.pbrt $normal
  study foliage foliage/scene.json $normal
  study hall hall/scene.json $normal --frame 6
  study fan fan/scene.json $normal
  study still still/scene.json $normal
  study glass_whitted glass/scene.json $whitted
  study foliage_whitted foliage/scene.json $whitted
}

tools/results_page.py "$out/studies" docs
