#!/usr/bin/env bash
# install_packages of tools/common.sh against a made-up dpkg, apt-get, sudo and id: when does it install what, and as whom?
# Usage: packages.sh PROJECT_ROOT
set -euo pipefail
cd "$1"

fake=$(mktemp -d)
trap 'rm -rf "$fake"' EXIT

# fake_command NAME: reads the body of a script from standard input.
fake_command() {
  { echo '#!/bin/sh'; cat; } >"$fake/$1"
  chmod +x "$fake/$1"
}

for tool in bash basename sed env dirname grep; do ln -s "$(command -v "$tool")" "$fake/$tool"; done
fake_command dpkg-query <<<'case " $MISSING " in *" $4 "*) exit 1 ;; esac; printf installed'
fake_command apt-get <<<'echo "apt-get $*" >>"$CALLS"'

fake_command sleep <<<'echo sleep >>"$CALLS"'

# expect NAME OUTPUT STATUS CALLS MISSING: runs install_packages with only the fake commands in reach.
expect() {
  local name=$1 output=$2 status=$3 calls=$4 missing=$5 got_output got_status=0 got_calls
  : >"$fake/calls"
  got_output=$(env -i PATH="$fake" CALLS="$fake/calls" MISSING="$missing" \
    bash -c 'set -euo pipefail; source tools/common.sh; install_packages build test' 2>&1) || got_status=$?
  got_calls=$(cat "$fake/calls")
  if [[ "$got_output" != *"$output"* || "$got_status" != "$status" || "$got_calls" != $calls ]]; then
    printf '%s:\nexpected status %s, calls "%s", output "%s"\ngot status %s, calls "%s", output "%s"\n' \
      "$name" "$status" "$calls" "$output" "$got_status" "$got_calls" "$got_output" >&2
    exit 1
  fi
}

fake_command id <<<'echo 0'
expect "nothing missing" "all there" 0 "" ""
expect "root" "installing cmake libgtest-dev" 0 \
  $'apt-get * update\napt-get * install*cmake libgtest-dev' "libgtest-dev cmake"
# Another package manager holds the lock of the lists, once.
fake_command apt-get <<'END'
echo "apt-get $*" >>"$CALLS"
[ "$(grep -c ' update' "$CALLS")" != 1 ] && exit
echo "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (apt-get)" >&2
exit 100
END
expect "a lock" "waiting for another package manager" 0 \
  $'apt-get * update\nsleep\napt-get * update\napt-get * install*cmake' "cmake"
fake_command apt-get <<<'echo "apt-get $*" >>"$CALLS"'
fake_command id <<<'echo 1000'
expect "neither root nor sudo" "neither root nor sudo" 1 "" "cmake"
fake_command sudo <<<'echo sudo >>"$CALLS"; exec "$@"'
expect "sudo" "installing cmake" 0 $'sudo\napt-get * update\nsudo\napt-get * install*cmake' "cmake"
fake_command apt-get <<<'exit 100'
expect "apt-get fails" "'apt-get update' failed" 1 $'sudo' "cmake"
rm "$fake/dpkg-query"
expect "not Debian" "not a Debian system" 1 "" ""
