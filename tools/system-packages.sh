#!/bin/sh
# Headless OpenGL: libEGL and libGL with Mesa's software renderer. Installs what is missing where it may.
set -eu

here() {
    "${PYTHON:-python3}" -c '
import ctypes
for name in ("libEGL.so.1", "libGL.so.1"):
    ctypes.CDLL(name)
' 2>/dev/null
}

here && exit 0
install="apt-get install --no-install-recommends --yes libegl1 libgl1"
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing libegl1 and libgl1, to draw without a display"
    export DEBIAN_FRONTEND=noninteractive
    # lists that cannot be renewed may still be good enough
    apt-get update -qq || true
    if $install -qq >/dev/null && here; then
        exit 0
    fi
fi
echo "drawing without a display needs libEGL.so.1 and libGL.so.1; on Debian and Ubuntu: sudo $install" >&2
exit 1
