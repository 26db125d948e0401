# Shared by ./demo and ./check: saying what happens, installing packages, building a preset.

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

# install_packages GROUP...: calls apt-get only when something is missing.
install_packages() {
  local package missing=() as_root=()
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
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -q || fail "'apt-get update' failed (no network?)"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" ||
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
