#!/usr/bin/env bash
# Encodes a mesh, serves it, and streams it through a caching proxy, all on this machine. Then
# shows what happened on one page, demo-out/index.html.
#
# Takes no arguments. Installs what is missing and builds the programs first.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
exec </dev/null

export CCACHE_BASEDIR=$PWD  # clones in other folders find what this one compiled

out=demo-out
bin=build/bin
mesh=bunny
view=(--headless --size 500x500 --json --timeout 300)

servers=()
end_servers() {
  for server in "${servers[@]}"; do kill "$server" 2>/dev/null || true; done
  for server in "${servers[@]}"; do wait "$server" 2>/dev/null || true; done
}
trap end_servers EXIT

step() { echo "== $*"; }

# start NAME COMMAND...: runs a server on a free port; sets `address` once it listens.
start() {
  local name=$1
  shift
  : >"$out/$name.out"  # there before the server's shell makes it
  "$@" --listen 127.0.0.1:0 >>"$out/$name.out" 2>"$out/$name.log" &
  servers+=($!)
  for _ in {1..200}; do
    address=$(sed -n 's/^listening on //p' "$out/$name.out")
    if [[ -n $address ]]; then return; fi
    if ! kill -0 "${servers[-1]}" 2>/dev/null; then break; fi
    sleep 0.1
  done
  echo "demo: $name did not start:" >&2
  cat "$out/$name.out" "$out/$name.log" >&2
  exit 1
}

step "packages and programs"
./install-packages.sh build run
mkdir -p build/logs
if ! { cmake --preset release -DMESHFRONT_TESTS=OFF && cmake --build build --parallel "$(nproc)"; } \
  >build/logs/demo-build.log 2>&1; then
  tail --lines=60 build/logs/demo-build.log
  echo "demo: the build failed; the whole log is build/logs/demo-build.log" >&2
  exit 1
fi

rm -rf "$out"
mkdir -p "$out/packs"

step "encode"
xz --decompress --stdout "tests/data/$mesh.ply.xz" >"$out/$mesh.ply"
"$bin/meshfront-encode" "$out/$mesh.ply" --output "$out/packs/$mesh.pack" --json >"$out/encode.json"
records=$("$bin/meshfront-pack" info "$out/packs/$mesh.pack" --json |
  python3 -c 'import json, sys; print(json.load(sys.stdin)["metadata"]["splitCount"])')

step "serve, and a proxy in front"
start service "$bin/meshfront-serve" --packs "$out/packs"
start proxy "$bin/meshfront-proxy" --upstream "$address"
url=$address/v1/meshes/$mesh

# look NAME ARGUMENT...: streams the mesh; leaves NAME.json, NAME.png and the proxy's counters.
look() {
  local name=$1
  shift
  "$bin/meshfront-view" "$url" "${view[@]}" --screenshot "$out/$name.png" "$@" >"$out/$name.json"
  curl --silent --show-error --fail "$address/metrics" >"$out/$name.metrics"
}

step "stream: a first viewer, then a second one with the same view"
look settled --until settled --reference "$out/$mesh.ply" --trace "$out/settled.csv"
look second --until settled
step "stream: stops on the way, and the published ranking for comparison"
look base --until records:0 --reference "$out/$mesh.ply"
look five-percent --until "records:$((records / 20))" --reference "$out/$mesh.ply"
look 35-db --until psnr:35 --reference "$out/$mesh.ply"
look pixels --until settled --rank pixels --reference "$out/$mesh.ply" --trace "$out/pixels.csv"

step "what happened"
python3 deploy/demo/write_page.py "$out"
