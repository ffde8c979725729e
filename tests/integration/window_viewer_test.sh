#!/usr/bin/env bash
# The viewer in a window on a virtual display: refines what it shows, ends by SIGTERM, and writes
# what was asked for. Usage: window_viewer_test.sh FOLDER-OF-PROGRAMS
source "$(dirname "$0")/programs.sh" "$1"

write_test_mesh "$work/mesh.obj"
mkdir "$work/packs"
"$bin/meshfront-encode" "$work/mesh.obj" --output "$work/packs/mesh.pack" --name mesh >/dev/null
start_server service "$bin/meshfront-serve" --packs "$work/packs" --listen 127.0.0.1:0

# Under AddressSanitizer: closing the window unloads the GL driver before leaks are counted, and what
# it leaves behind can then not be told from ours. The other tests of the viewer count leaks.
export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"

xvfb-run -a -s "-screen 0 1280x720x24 -noreset" bash -c '
  "$1" "$2" --size 400x300 --trace "$3/trace.csv" --screenshot "$3/window.png" \
    --json >"$3/window.json" &
  viewer=$!
  # Settled when no further answer comes.
  last=-1
  for _ in $(seq 120); do
    sleep 0.5
    now=$(wc -l 2>/dev/null <"$3/trace.csv" || echo 0)
    [ "$now" -gt 1 ] && [ "$now" = "$last" ] && break
    last=$now
  done
  kill -TERM $viewer
  wait $viewer' - "$bin/meshfront-view" "$origin/v1/meshes/mesh" "$work" ||
  fail "the viewer ended with status $?"
grep -q '"state":"settled"' "$work/window.json" || fail "not settled: $(cat "$work/window.json")"
[ "$(number records "$work/window.json")" -gt 500 ] || fail "hardly a record"
[ "$(head -c 4 "$work/window.png" | tail -c 3)" = PNG ] || fail "no screenshot"

# Without a display: a message, not a crash.
expect_status 1 env -u DISPLAY -u WAYLAND_DISPLAY "$bin/meshfront-view" "$origin/v1/meshes/mesh"
[ -s "$work/err" ] || fail "no word about the missing display"
echo "ok: $(number records "$work/window.json") records"
