#!/usr/bin/env bash
# Builds all packages of the last commit into dist/: Debian packages and wheels for x86-64 and
# aarch64, the source archive, the bill of materials, and SHA256SUMS. Another build of the same
# commit with the same tools gives the same bytes.

. "$(dirname "$0")/../tools/env.sh"

[ -z "$(git status --porcelain)" ] || die "there are changes that are not committed" "git status"
version=$(tools/version.py)
SOURCE_DATE_EPOCH=$(time_of_commit)
export SOURCE_DATE_EPOCH
dist=$ROOT/dist
rm -rf "$dist"
mkdir "$dist"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

git archive --format=tar --prefix="rtf-$version/" HEAD | gzip -9 --no-name >"$dist/rtf-$version.tar.gz"

packaging/deb/build.sh "$dist"
packaging/deb/build.sh "$dist" arm64
for processor in x86_64 aarch64; do
  wheel=$(tools/wheel.sh "$processor")
  cp "$wheel" "$dist"
done

# Bills of materials: of each program, and of the page.
cyclonedx=$(tools/cargo_tool.sh cargo-cyclonedx 0.5.9)
tar -xf "$dist/rtf-$version.tar.gz" -C "$work"
(
  cd "$work/rtf-$version"
  PATH=$cyclonedx:$PATH quietly cargo cyclonedx --format json --spec-version 1.5 --override-filename bom
  cd web
  PATH=$("$ROOT/tools/node.sh"):$PATH npm sbom --sbom-format cyclonedx --package-lock-only >bom.json
)
sources=$work/rtf-$version
packaging/bom.py "$sources" "$sources/web/bom.json" \
  "$sources"/crates/{rtf,rtf-host-native,rtf-host-lua,rtf-frameworks,rtf-host-signals,rtf-host-faults}/bom.json >"$dist/rtf-$version.cdx.json"

cd "$dist"
sha256sum -- * >"$work/SHA256SUMS"
mv "$work/SHA256SUMS" .
say "dist:" "$(ls)"
