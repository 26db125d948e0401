#!/usr/bin/env bash
# Builds the Debian packages into build/debian: libkairos0, libkairos-dev, kairos, python3-kairos; lintian reads them. With --try also
# unpacks them into a folder and runs the program and the Python package from there.
set -euo pipefail
cd "$(dirname "$0")/.."
source tools/common.sh
case "$*" in
  "" | --try) ;;
  *) fail "'$*' is not known; give nothing, or --try" ;;
esac
install_packages build python debian

say "Building packages"
version=$(dpkg-parsechangelog -S Version)
if command -v ccache >/dev/null; then CCACHE_DIR=$(ccache -k cache_dir) && export CCACHE_DIR; fi
dpkg-buildpackage -us -uc -b -jauto
mkdir -p build/debian
mv ../{libkairos0,libkairos-dev,kairos,python3-kairos}*_"$version"_*.deb ../kairos_"$version"_*.{buildinfo,changes} build/debian/
debian/rules clean >/dev/null

say "Reading them: lintian"
lintian --fail-on error build/debian/*.changes

if [[ "$*" == --try ]]; then
  say "Trying them"
  prefix=$(mktemp -d)
  trap 'rm -rf "$prefix"' EXIT
  for package in build/debian/*_"$version"_*.deb; do dpkg-deb -x "$package" "$prefix"; done
  LD_LIBRARY_PATH=$(echo "$prefix"/usr/lib/*-linux-gnu*)
  export LD_LIBRARY_PATH
  "$prefix/usr/bin/kairos" --version
  PYTHONPATH=$prefix/usr/lib/python3/dist-packages /usr/bin/python3 -c \
    "import kairos; print(kairos.load('scenes/star/star.json').shot(size=(32, 32)).render(spp=1))"
fi
