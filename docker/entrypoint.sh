#!/bin/sh
# Puts the kernels compiled at build time where Numba may write beside them (it refuses a cache that it cannot write),
# then becomes the command.
set -eu
mkdir -p "$NUMBA_CACHE_DIR"
if [ -d /opt/mat/kernels ]; then
    cp -R /opt/mat/kernels/. "$NUMBA_CACHE_DIR"
fi
exec "$@"
