#!/usr/bin/env bash
# The whole way: a mesh file is encoded, served, proxied and viewed until it is there again exactly.
# Usage: stream_end_to_end_test.sh FOLDER-OF-PROGRAMS
source "$(dirname "$0")/programs.sh" "$1"

mesh=$work/mesh.obj
write_test_mesh "$mesh"
mkdir "$work/packs"
"$bin/meshfront-encode" "$mesh" --output "$work/packs/mesh.pack" --name mesh >/dev/null
start_server service "$bin/meshfront-serve" --packs "$work/packs" --listen 127.0.0.1:0
service=$server service_origin=$origin
start_server proxy "$bin/meshfront-proxy" --upstream "$service_origin" --listen 127.0.0.1:0
proxy=$server proxy_origin=$origin

view() { "$bin/meshfront-view" "$@" --headless --size 200x150 --timeout 120 --json; }
through_proxy=$proxy_origin/v1/meshes/mesh
upstream_requests='meshfront_upstream_requests_total{kind="splits"}'

# A view settles; a second viewer of it costs the service nothing.
view "$through_proxy" --camera zoom=2 --screenshot "$work/first.png" \
  --trace "$work/trace.csv" --reference "$mesh" >"$work/first.json"
grep -q '"state":"settled"' "$work/first.json" || fail "the view does not settle"
share=$(number share "$work/first.json")
awk -v s="$share" 'BEGIN { exit !(s > 0.05 && s < 0.95) }' ||
  fail "a close view needs some of the mesh, not $share of it"
awk -v p="$(number psnr "$work/first.json")" 'BEGIN { exit !(p > 30) }' ||
  fail "the settled picture is far from the reference"
before=$(counter "$proxy_origin" "$upstream_requests")
[ "$before" -ge 1 ] || fail "the first viewer asked the service for nothing"
view "$through_proxy" --camera zoom=2 --screenshot "$work/second.png" >"$work/second.json"
[ "$(counter "$proxy_origin" "$upstream_requests")" = "$before" ] ||
  fail "the second viewer of a view causes upstream requests for records"
cmp "$work/first.png" "$work/second.png" || fail "two viewers see different pictures"
[ "$(number records "$work/first.json")" = "$(number records "$work/second.json")" ] ||
  fail "two viewers of a view get different records"

# The trace: a line for each answer, totals that grow, ending at what the summary says.
awk -F, -v wanted="$(number records "$work/first.json")" '
  NR == 1 { if ($0 != "seconds,requests,records,bytes_up,bytes_down,triangles,visible_candidates,psnr") exit 1; next }
  { if ($3 < last || NF != 8 || $8 == "") exit 1; last = $3 }
  END { exit last != wanted }' "$work/trace.csv" || fail "the trace is wrong"

# Everything, through the proxy and without it, in both orders: exactly the input.
view "$through_proxy" --until complete --export "$work/proxied.ply" >"$work/complete.json"
grep -q '"state":"complete"' "$work/complete.json" || fail "not complete"
[ "$(number share "$work/complete.json")" = 1.0 ] || fail "complete without all records"
view "$service_origin/v1/meshes/mesh" --until complete --rank pixels --batch 300 --window 1 \
  --camera azimuth=200 --export "$work/direct.ply" >/dev/null
for export in proxied direct; do
  expect_status 0 "$bin/meshfront-pack" compare "$mesh" "$work/$export.ply"
  expect_status 0 "$bin/meshfront-pack" compare "$work/packs/mesh.pack" "$work/$export.ply"
done
view "$through_proxy" --until records:400 --export "$work/coarse.ply" >"$work/coarse.json"
[ "$(number records "$work/coarse.json")" = 400 ] || fail "records:400 gives another number"
expect_status 1 "$bin/meshfront-pack" compare "$mesh" "$work/coarse.ply"

# By whole chunks: a view settles, another viewer sees the same and asks for the same; everything is
# exactly the input, and no chunk is asked for twice.
for n in 1 2; do
  view "$through_proxy" --fetch chunks --camera zoom=2 --screenshot "$work/chunks$n.png" \
    >"$work/chunks$n.json"
  grep -q '"state":"settled"' "$work/chunks$n.json" || fail "the view does not settle by chunks"
done
cmp "$work/chunks1.png" "$work/chunks2.png" || fail "two viewers by chunks see different pictures"
[ "$(number bytes_down "$work/chunks1.json")" = "$(number bytes_down "$work/chunks2.json")" ] ||
  fail "two viewers by chunks get different bytes"
view "$service_origin/v1/meshes/mesh" --fetch chunks --until complete \
  --export "$work/chunks.ply" >"$work/chunks.json"
expect_status 0 "$bin/meshfront-pack" compare "$mesh" "$work/chunks.ply"
[ "$(number requests "$work/chunks.json")" = "$(curl -fsS "$through_proxy" |
  sed -n 's/.*"chunkCount": *\([0-9]*\).*/\1/p')" ] || fail "not one request for each chunk"

# Other ends of a run.
view "$through_proxy" --until 6kB >"$work/bytes.json"
down=$(number bytes_down "$work/bytes.json")
[ "$down" -gt 5000 ] && [ "$down" -le 6100 ] || fail "--until 6kB took $down bytes"
view "$through_proxy" --until psnr:25 --reference "$mesh" --batch 50 >"$work/psnr.json"
grep -q '"state":"target reached"' "$work/psnr.json" || fail "25 dB not reached"
view "$through_proxy" --until complete --reference "$mesh" --count-on-cpu >"$work/full.json"
awk -v p="$(number psnr "$work/full.json")" 'BEGIN { exit !(p > 45) }' ||
  fail "the full mesh does not look like its reference"

# What goes wrong is said, with the right status.
expect_status 2 view "$service_origin/v2/meshes/mesh"
grep -q "v1" "$work/err" || fail "no word about the version"
expect_status 2 "$bin/meshfront-view" "$through_proxy" --headless --until soon
expect_status 1 view "$service_origin/v1/meshes/missing"
grep -q "no mesh 'missing'" "$work/err" || fail "no word about the missing mesh"
stop_server "$proxy"
stop_server "$service"
expect_status 1 view "$through_proxy"
grep -q "is the service running" "$work/err" || fail "no word about the refused connection"
echo "ok: $(number records_of_mesh "$work/complete.json") records, settled with share $share"
