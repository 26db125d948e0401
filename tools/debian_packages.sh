#!/usr/bin/env bash
# Builds the Debian packages into build/debian: libkairos0, libkairos-dev, kairos, python3-kairos; lintian reads them. With --try also
# unpacks them into a folder and runs the program and the Python package from there. With --chroot (as root) apt installs them, with
# what they depend on, into a fresh Debian that debootstrap makes, and they are run in that.
set -euo pipefail
cd "$(dirname "$0")/.."
source tools/common.sh
case "$*" in
  "" | --try) ;;
  --chroot) [[ $EUID == 0 ]] || fail "--chroot makes a Debian of its own, which only root may" ;;
  *) fail "'$*' is not known; give nothing, --try or --chroot" ;;
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

if [[ "$*" == --chroot ]]; then
  say "Installing them with apt into a Debian of its own"
  command -v debootstrap >/dev/null || DEBIAN_FRONTEND=noninteractive apt-get install -y -q debootstrap
  debian=$(mktemp -d)
  trap 'rm -rf --one-file-system "$debian"' EXIT
  debootstrap --variant=minbase bookworm "$debian" >/dev/null
  mkdir "$debian/packages"
  cp build/debian/*_"$version"_*.deb "$debian/packages/"
  cp -r scenes/star "$debian/star"
  chroot "$debian" sh -ec '
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -q
    apt-get install -y -q --no-install-recommends /packages/*.deb gcc libc6-dev pkg-config
    kairos --version
    kairos render /star/star.json -o /star.png --size 64x64 --quiet
    python3 -c "import kairos; print(kairos.load(\"/star/star.json\").shot(size=(32, 32)).render(spp=1))"
    printf "#include <kairos/kairos.h>\n#include <stdio.h>\nint main(void) { return puts(kairos_version()) < 0; }\n" >/doors.c
    cc /doors.c -o /doors $(pkg-config --cflags --libs kairos)
    /doors'
fi
