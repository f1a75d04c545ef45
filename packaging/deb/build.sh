#!/usr/bin/env bash
# Builds the Debian packages rtf, rtf-dev and robot-testing-framework-compat.
#
#   packaging/deb/build.sh [DIRECTORY]           default: dist
#   packaging/deb/build.sh DIRECTORY arm64       the package rtf for arm64; the others are for all
#
# Contains the files that tools/install.sh installs. All timestamps are SOURCE_DATE_EPOCH, by
# default the time of the last commit, so the same build results give the same packages.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh

output=${1:-dist}
architecture=${2:-}
need_packages debhelper dpkg-dev
mkdir -p "$output"
output=$(cd "$output" && pwd)
SOURCE_DATE_EPOCH=$(time_of_commit)
export SOURCE_DATE_EPOCH
umask 022

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$architecture" = arm64 ]; then
  need_packages g++-aarch64-linux-gnu libcppunit-dev
  PROGRAMS=$(tools/cross.sh aarch64)
  LIBRARIES=$work/libraries
  CC=aarch64-linux-gnu-gcc CXX=aarch64-linux-gnu-g++ OBJCOPY=aarch64-linux-gnu-objcopy tools/preload.sh "$LIBRARIES"
  settings=$(dpkg-architecture --host-arch arm64 --print-set --force)
  eval "$settings"
  export PROGRAMS LIBRARIES DH_OPTIONS=--package=rtf
elif [ -n "$architecture" ]; then
  die "no architecture \`$architecture\`: arm64"
fi

mkdir "$work/debian"
cp packaging/deb/{control,copyright,rtf.*} "$work/debian"
cat >"$work/debian/changelog" <<CHANGELOG
rtf ($(version_of_rtf)-1) unstable; urgency=medium

  * The changes are in /usr/share/doc/rtf/changelog.gz.

 -- $(sed -n 's/^Maintainer: //p' packaging/deb/control)  $(LC_ALL=C date --utc --rfc-email --date="@$SOURCE_DATE_EPOCH")
CHANGELOG

PREFIX=/usr DESTDIR=$work/all PARTS=$work/parts tools/install.sh
cd "$work"
while read -r part file; do
  case $file in
    share/doc/rtf/LICENSE) continue ;; # debian/copyright
    share/zsh/site-functions/*) placed=share/zsh/vendor-completions/${file##*/} ;;
    *) placed=$file ;;
  esac
  mkdir -p "debian/$part/usr/$(dirname "$placed")"
  mv "all/usr/$file" "debian/$part/usr/$placed"
done <parts
mkdir -p debian/rtf/usr/lib/python3/dist-packages
ln -s ../../../share/rtf/python/rtf debian/rtf/usr/lib/python3/dist-packages/rtf

dh_installdocs
dh_installchangelogs
dh_lintian
dh_compress -X.md # they refer to each other
dh_fixperms
dh_strip --no-automatic-dbgsym
dh_shlibdeps -Xlibrtf- # preloaded only into programs that have their libraries
dh_installdeb
dh_gencontrol
dh_md5sums
dh_builddeb --destdir="$output" -- -z1 # a fifth of the time of the default, 16 % larger
