#!/usr/bin/env bash
# Many simulated receivers against a service behind a proxy: each settles, and the service sends
# hardly more than one of them needs.
# Usage: load_test.sh FOLDER-OF-PROGRAMS
source "$(dirname "$0")/programs.sh" "$1"

write_test_mesh "$work/mesh.obj"
mkdir "$work/packs"
"$bin/meshfront-encode" "$work/mesh.obj" --output "$work/packs/mesh.pack" --name mesh >/dev/null
start_server service "$bin/meshfront-serve" --packs "$work/packs" --listen 127.0.0.1:0
service=$server service_origin=$origin
start_server proxy "$bin/meshfront-proxy" --upstream "$service_origin" --listen 127.0.0.1:0
proxy_origin=$origin
{
  echo "# where receivers look from"
  for view in whole half close; do
    for azimuth in 0 90 180 270; do echo "$view;azimuth=$azimuth"; done
  done
} >"$work/views"

load() { "$bin/meshfront-load" --views "zipf:$work/views" --json "$@" 2>"$work/err"; }
expect_all_settled() {
  python3 - "$1" "$2" <<'CHECK' || { cat "$1" "$work/err" >&2; fail "not all is well with $1"; }
import json, sys
report, receivers = json.load(open(sys.argv[1])), int(sys.argv[2])
assert report["settled"] == report["started"] == receivers, "settled"
assert report["failed"] == report["unfinished"] == report["malformed_answers"] == 0, "failed"
assert report["errors"] == {}, "errors"
assert report["settled_seconds"]["p50"] > 0 and report["latency_seconds"]["max"] > 0, "times"
assert report["requests"] > 2 * receivers and report["record_bytes"] > 0, "requests"
CHECK
}

for fetch in exact chunks; do
  load --url "$proxy_origin/v1/meshes/mesh" --receivers 50 --concurrency 20 --fetch "$fetch" \
    --origin-metrics "$service_origin" --proxy-metrics "$proxy_origin" --verbose \
    >"$work/$fetch.json" || fail "a run with $fetch requests ends with status $?"
  expect_all_settled "$work/$fetch.json" 50
done
# The proxy asked for each record once: 50 receivers share what a few of them would have cost.
for fetch in exact chunks; do
  python3 -c '
import json, sys
report = json.load(open(sys.argv[1]))
assert 0 < report["origin"]["share"] < 0.25, report["origin"]
assert abs(report["proxy"]["record_bytes"] / report["record_bytes"] - 1) < 1e-9, report["proxy"]
' "$work/$fetch.json" || fail "the share of the service is wrong with $fetch requests"
done

# For a time only, and few at once.
load --url "$proxy_origin/v1/meshes/mesh" --receivers 1000000 --concurrency 4 --duration 1 \
  --arrivals 50 >"$work/timed.json" || fail "a run that ends with its time fails"
python3 -c '
import json, sys
report = json.load(open(sys.argv[1]))
assert 1 <= report["started"] <= 1000 and report["failed"] == 0, report
assert report["most_alive"] <= 4, report
' "$work/timed.json" || fail "the run for a second did something else"

# SIGTERM ends a run early, and the report still comes.
timeout --preserve-status -s TERM 2 "$bin/meshfront-load" --url "$proxy_origin/v1/meshes/mesh" \
  --views "zipf:$work/views" --receivers 1000000 --concurrency 4 --json \
  --origin-metrics "$service_origin" >"$work/ended.json" 2>"$work/err" ||
  fail "a run that SIGTERM ends has status $?"
python3 -c '
import json, sys
report = json.load(open(sys.argv[1]))
assert report["failed"] == 0 and report["settled"] + report["unfinished"] == report["started"], report
assert 1 <= report["started"] < 1000000 and "origin" in report, report
' "$work/ended.json" || fail "the report of a run that SIGTERM ended is wrong"

# What goes wrong is said, with the right status, and at once: --patience is a minute.
wrong() { expect_status "$1" timeout 30 "$bin/meshfront-load" --url "$2" --views "zipf:$3"; }
wrong 2 "$proxy_origin/v1/meshes/mesh" "$work/none"
wrong 2 "$proxy_origin" "$work/views"
: >"$work/empty"
wrong 2 "$proxy_origin/v1/meshes/mesh" "$work/empty"
wrong 2 "$proxy_origin/v1/meshes/mesh" "$work/packs/mesh.pack"
wrong 1 "$proxy_origin/v1/meshes/missing" "$work/views"
grep -q "no mesh 'missing'" "$work/err" || fail "no word about the missing mesh"
wrong 1 "$proxy_origin/elsewhere/v1/meshes/mesh" "$work/views"
grep -q "no mesh 'mesh' at $proxy_origin/elsewhere" "$work/err" || fail "no word about the path"
stop_server "$service"
echo "ok: $(grep -o '"share":[0-9.e-]*' "$work/exact.json") of the record bytes came from the service"
