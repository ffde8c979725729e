#!/usr/bin/env bash
# A decoder written from shared/codec/README.md alone gets the input's triangles out of what the
# service sends, in the order of the chunks and in a random one.
# Usage: second_decoder_test.sh FOLDER-OF-PROGRAMS
source "$(dirname "$0")/programs.sh" "$1"
tests=$(dirname "$0")/..

mkdir "$work/packs"
write_test_mesh "$work/shapes.obj"
xz --decompress --stdout "$tests/data/bunny.ply.xz" >"$work/bunny.ply"
"$bin/meshfront-encode" "$work/shapes.obj" --output "$work/packs/shapes.pack" >/dev/null
"$bin/meshfront-encode" "$work/bunny.ply" --output "$work/packs/bunny.pack" >/dev/null
start_server service "$bin/meshfront-serve" --packs "$work/packs" --listen 127.0.0.1:0
service=$server

# decode MESH INPUT [SEED]: the triangles are those of the input, and of the pack.
decode() {
  python3 "$tests/format/decode_mesh.py" "$origin/v1/meshes/$1" "$work/decoded.ply" "${@:3}"
  expect_status 0 "$bin/meshfront-pack" compare "$2" "$work/decoded.ply"
  expect_status 0 "$bin/meshfront-pack" compare "$work/packs/$1.pack" "$work/decoded.ply"
}
decode shapes "$work/shapes.obj"
decode shapes "$work/shapes.obj" 1
decode bunny "$work/bunny.ply" 2
stop_server "$service"
