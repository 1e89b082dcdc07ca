#!/bin/sh
# What Python's packages do not bring: venv, and libEGL and libGL with Mesa's software renderer to draw without a
# display. Installs what is missing where it may; otherwise names the one command.
set -eu

python=${PYTHON:-python3}

venv_here() {
    "$python" -c 'import venv, ensurepip' 2>/dev/null
}

gl_here() {
    "$python" -c '
import ctypes
for name in ("libEGL.so.1", "libGL.so.1"):
    ctypes.CDLL(name)
' 2>/dev/null
}

missing() {
    gl_here || echo libegl1 libgl1
    venv_here || "$python" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])'
}

packages=$(missing | tr '\n' ' ')
[ -n "$packages" ] || exit 0
install="apt-get install --no-install-recommends --yes ${packages% }"
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing ${packages% }"
    export DEBIAN_FRONTEND=noninteractive
    # lists that cannot be renewed may still be good enough
    apt-get update -qq || true
    if $install -qq >/dev/null && gl_here && venv_here; then
        exit 0
    fi
fi
echo "miburi needs ${packages% }; on Debian and Ubuntu: sudo $install" >&2
exit 1
