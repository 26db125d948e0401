#!/bin/sh
# Do the kernels compile for 64-bit ARM? arm.sh SOURCE_FOLDER; exit status 77 where there is no compiler for it.
compiler=aarch64-linux-gnu-g++
command -v "$compiler" >/dev/null || exit 77
cd "$1" || exit 1
for source in src/kernels/*.cpp; do
  "$compiler" -march=armv8-a+crypto -std=c++20 -O1 -ffp-contract=off -Wall -Wextra -Werror -Iinclude -Isrc -c -o /dev/null "$source" || exit 1
done
