#!/bin/sh
# Brings Debian's Chromium and a font for it: the tests of the page drive it. Does nothing where it is there.
set -eu

command -v chromium >/dev/null && exit 0
if ! command -v apt-get >/dev/null; then
    echo "install-chromium.sh: apt-get is not here; install chromium" >&2
    exit 1
fi
as_root=""
if [ "$(id -u)" -ne 0 ]; then
    as_root="sudo"
fi
$as_root apt-get update --quiet
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install --quiet --yes --no-install-recommends chromium fonts-liberation
