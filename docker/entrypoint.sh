#!/bin/sh
# Puts the kernels compiled at build time where Numba may write beside them (it refuses a cache that it cannot write),
# then becomes the command.
set -eu
mkdir -p "$NUMBA_CACHE_DIR"
cp -R "$COMPILED_KERNELS/." "$NUMBA_CACHE_DIR"
exec "$@"
