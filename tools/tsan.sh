#!/usr/bin/env bash
# Builds with ThreadSanitizer and runs what threads meet in: parallel loops, kernels, masks, the renderer, and two
# renderers at once. About ten minutes on two cores the first time.
#
# usage: tools/tsan.sh [PROGRAM...]   test programs; default: base_test kernels_test motion_test render_test
set -euo pipefail
cd "$(dirname "$0")/.."
programs=("$@")
[ ${#programs[@]} -gt 0 ] || programs=(base_test kernels_test motion_test render_test)
cmake --preset tsan -DKAIROS_BUILD_TESTS=ON
cmake --build --preset tsan --target "${programs[@]}"
# TBB and Embree are not built with it: calls from inside of them say nothing about us.
export TSAN_OPTIONS="suppressions=$PWD/tools/tsan.supp ignore_noninstrumented_modules=1 halt_on_error=1 exitcode=66 ${TSAN_OPTIONS:-}"
for program in "${programs[@]}"; do
  echo "== $program"
  "build/tsan/bin/$program" --gtest_brief=1
done
