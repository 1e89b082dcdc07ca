#!/bin/sh
# Headless OpenGL: libEGL and libGL with Mesa's software renderer. Installs what is missing where it may.
set -eu

here() {
    python3 - "$@" <<'PY'
import ctypes, sys
try:
    for name in sys.argv[1:]:
        ctypes.CDLL(name)
except OSError:
    sys.exit(1)
PY
}

if here libEGL.so.1 libGL.so.1; then
    exit 0
fi
command="apt-get install --no-install-recommends --yes libegl1 libgl1"
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing libegl1 and libgl1, to draw without a display"
    apt-get update --quiet --quiet
    DEBIAN_FRONTEND=noninteractive $command --quiet --quiet >/dev/null
    here libEGL.so.1 libGL.so.1 && exit 0
fi
echo "libEGL.so.1 and libGL.so.1 are missing, which drawing without a display needs; run: sudo $command" >&2
exit 1
