# Shared by ./demo and ./check: saying what happens, installing packages, building a preset.

# ccache keeps what includes a precompiled header only if it may overlook the header's own macros and times.
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime

say() { printf '\n== %s\n' "$*"; }

fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# packages GROUP...: the packages of these groups of tools/packages.txt.
packages() {
  local group
  for group in "$@"; do
    sed -n "/^\[$group\]/,/^\[/{/^[a-z]/p}" tools/packages.txt
  done
}

# apt_get ARGUMENT...: as root. Waits up to ten minutes for another package manager: apt-get itself waits for the lock of
# dpkg, but not for those of its own lists and archives.
apt_get() {
  local as_root=() message attempt
  if [[ "$(id -u)" != 0 ]]; then as_root=(sudo); fi
  for ((attempt = 0; attempt < 60; ++attempt)); do
    if { message=$("${as_root[@]}" env LC_ALL=C DEBIAN_FRONTEND=noninteractive \
      apt-get -q -o DPkg::Lock::Timeout=600 "$@" 2>&1 >&3); } 3>&1; then
      printf '%s' "${message:+$message$'\n'}" >&2
      return
    fi
    if [[ "$message" != *"E: Could not get lock"* ]]; then break; fi
    if ((attempt == 0)); then say "Packages: waiting for another package manager"; fi
    sleep 10
  done
  printf '%s\n' "$message" >&2
  return 1
}

# install_packages GROUP...: calls apt-get only when something is missing.
install_packages() {
  local package missing=()
  command -v dpkg-query >/dev/null || fail "this is not a Debian system; install the equivalents of tools/packages.txt \
and build with 'cmake --preset release && cmake --build --preset release'"
  for package in $(packages "$@"); do
    [[ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" == installed ]] || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then
    say "Packages: all there"
    return
  fi
  say "Packages: installing ${missing[*]}"
  if [[ "$(id -u)" != 0 ]]; then
    command -v sudo >/dev/null || fail "these packages are missing and there is neither root nor sudo to install them: \
run 'apt-get install ${missing[*]}' as root, then start again"
  fi
  apt_get update || fail "'apt-get update' failed (no network?)"
  apt_get install -y --no-install-recommends "${missing[@]}" ||
    fail "'apt-get install' failed; its message is above"
}

# configure PRESET [CMAKE ARGUMENT...]
configure() {
  local preset=$1 launcher=()
  shift
  if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  mkdir -p build
  cmake --preset "$preset" "${launcher[@]}" "$@" >"build/configure-$preset.log" 2>&1 || {
    tail -n 40 "build/configure-$preset.log" >&2
    fail "cannot configure the preset '$preset' (the whole log: build/configure-$preset.log)"
  }
}

# build PRESET [ARGUMENT OF cmake --build...]
build() {
  local preset=$1
  shift
  cmake --build --preset "$preset" "$@" || fail "cannot build the preset '$preset'; the compiler's message is above"
}
