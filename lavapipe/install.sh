#!/bin/sh
# Brings the Debian packages that Vulkan compute on lavapipe needs. Does nothing where they are there.
set -eu

missing=""
for package in mesa-vulkan-drivers libvulkan1 glslang-tools vulkan-validationlayers spirv-tools python3-venv; do
    # shellcheck disable=SC2016  # ${Status} is dpkg-query's own
    case "$(dpkg-query --show --showformat='${Status}' "$package" 2>/dev/null || true)" in
        *"ok installed") ;;
        *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

if ! command -v apt-get >/dev/null; then
    echo "install.sh: apt-get is not here; install what these Debian packages hold:$missing" >&2
    exit 1
fi
as_root=""
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "install.sh: run as root, or install sudo; missing:$missing" >&2
        exit 1
    fi
    as_root="sudo"
fi
$as_root apt-get update --quiet
# shellcheck disable=SC2086  # one word a package
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install --quiet --yes --no-install-recommends $missing
