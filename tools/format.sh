#!/usr/bin/env bash
# Lays every C++ file of the project out as .clang-format says; with --check only tells which ones are not.
set -euo pipefail
cd "$(dirname "$0")/.."

arguments=(-i)
if [[ "${1:-}" == --check ]]; then arguments=(--dry-run --Werror); fi
find apps bench fuzz include python src tests -name '*.cpp' -o -name '*.h' | sort | xargs clang-format "${arguments[@]}"
