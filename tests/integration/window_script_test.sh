#!/usr/bin/env bash
# The viewer's window under a script, as a person uses it: it opens, shows the mesh, is dragged,
# zoomed, measured, resized, loses its server and gets it back, and closes. Pictures are compared
# with those drawn without a window. Then wrong scripts, and a flight along a camera path.
# Usage: window_script_test.sh FOLDER-OF-PROGRAMS
source "$(dirname "$0")/programs.sh" "$1"
# Closing a window unloads the GL driver before leaks are counted (see window_viewer_test.sh).
export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"

write_test_mesh "$work/mesh.obj"
mkdir "$work/packs"
"$bin/meshfront-encode" "$work/mesh.obj" --output "$work/packs/mesh.pack" --name mesh >/dev/null
# The same with normals of its own, all upward.
{ echo 'vn 0 1 0'; sed -E '/^f/s#([0-9]+)( |$)#\1//1\2#g' "$work/mesh.obj"; } >"$work/lit.obj"
"$bin/meshfront-encode" "$work/lit.obj" --output "$work/packs/lit.pack" --name lit >/dev/null
start_server service "$bin/meshfront-serve" --packs "$work/packs" --listen 127.0.0.1:0
url=$origin/v1/meshes/mesh

# What the script runs when it takes the server away and brings it back.
cat >"$work/stop" <<END
kill -TERM $server
while kill -0 $server 2>/dev/null; do sleep 0.05; done
END
cat >"$work/start" <<END
"$bin/meshfront-serve" --packs "$work/packs" --listen ${origin#http://} >"$work/again.out" 2>&1 &
echo \$! >"$work/again.pid"
for _ in \$(seq 100); do grep -q 'listening on' "$work/again.out" && exit 0; sleep 0.05; done
exit 1
END
end_second_server() { [ ! -s "$work/again.pid" ] || kill "$(cat "$work/again.pid")" 2>/dev/null || true; }
trap 'end_second_server; end_programs' EXIT

expect_status 0 "$bin/meshfront-view" "$url" --headless --size 640x480 --camera half \
  --screenshot "$work/half.png"
expect_status 0 "$bin/meshfront-view" "$url" --headless --size 500x400 \
  --camera 'azimuth=100;elevation=40' --screenshot "$work/above.png"

play() {  # play NAME ARGUMENTS...: its script is $work/NAME.txt
  local name=$1
  shift
  (cd "$work" && xvfb-run -a -s "-screen 0 1280x720x24 -noreset" \
    "$bin/meshfront-view" "$@" --script "$name.txt" >"$name.out" 2>"$name.err")
}

cat >"$work/visit.txt" <<'END'
size 640 480
wait-state settled 60
expect message == null
expect triangles_shown > 500
expect bytes_down > 1000
expect quality == 1
compare half.png psnr:30
picture first.png
screenshot first-screen.png

# Away and back.
drag 420 240 520 300 left
wait-frames 2
wait-state settled 60
scroll 400 240 3
scroll 400 240 -1.5
drag 400 300 450 320 right
drag 500 240 320 430 left ctrl
key right
key up shift
key +
key ]
wait-frames 2
wait-state settled 60
key R
wait-frames 2
wait-state settled 60
compare first.png psnr:30

# Measuring.
pick 400 300
wait 0.5
pick 420 330
wait-frames 2
expect picks.size == 2
expect picks.0.mesh == mesh
expect picks.0.node contains :
expect pick_distance > 0.001
expect pick_distance < 2
key delete
wait-frames 2
expect picks.size == 0

# What can be switched.
key S
key W
key C
key B
key G
key H
wait-frames 3
expect shading == flat
expect wireframe == true
expect colouring != "own colours"
expect geomorph == false
expect help_shown == true
screenshot help.png
key H
key S
key W
key C shift
key P
wait-frames 3
expect panel_shown == false
picture view.png
screenshot alone.png
key P
key F12
key C ctrl
wait-frames 2

# Another size, another view.
size 500 400
camera "azimuth=100;elevation=40"
wait-frames 2
wait-state settled 60
compare above.png psnr:30
expect picture_size.0 == 500

# The server goes in the middle of its work and comes back.
run "sh ./stop"
camera "azimuth=250;elevation=-30;zoom=5"
wait-state degraded 60
expect message.title contains away
expect message.detail contains "no answer"
expect retry_in >= 0
screenshot away.png
status away.json
run "sh ./start"
wait-state settled 60
expect message == null
status status.json
quit
END
play visit "$url" --camera half || fail "the visit ended with status $?: $(cat "$work/visit.err")"
[ -s "$work/meshfront-0001.png" ] || fail "F12 kept no screenshot"
grep -q -- "^--camera 'eye=" "$work/visit.out" || fail "the camera was not printed"
cmp -s "$work/view.png" "$work/alone.png" || fail "the window without panel is not the view"
cmp -s "$work/first.png" "$work/first-screen.png" && fail "there is no panel"
grep -q '"state":"degraded"' "$work/away.json" || fail "not degraded: $(cat "$work/away.json")"
[ "$(number triangles_shown "$work/status.json")" -gt 500 ] || fail "hardly a triangle"
grep -q '^state      settled' "$work/visit.out" || fail "not settled in the end"

# A window opens without a server too, says so, and closes when asked.
cat >"$work/nobody.txt" <<'END'
wait-until state == connecting 20
wait-until message.title contains "No server" 60
screenshot nobody.png
expect message.advice contains meshfront-serve
END
play nobody http://127.0.0.1:9/v1/meshes/mesh && fail "status 0 without a mesh"
grep -q 'no answer from' "$work/nobody.err" || fail "it says: $(cat "$work/nobody.err")"
[ -s "$work/nobody.png" ] || fail "no window without a server: $(cat "$work/nobody.err")"

# Expectations that fail end with 1, scripts that do not parse with 2, and both say where.
printf 'wait-state settled 60\nexpect triangles_shown < 3\nwait 100\n' >"$work/wrong.txt"
status=0
play wrong "$url" || status=$?
[ "$status" = 1 ] || fail "status $status for an expectation that fails"
grep -q 'wrong.txt:2: expect triangles_shown < 3: it is [0-9]' "$work/wrong.err" ||
  fail "it says: $(cat "$work/wrong.err")"
printf 'wait 1\nwait-state done 3\n' >"$work/typo.txt"
expect_status 2 "$bin/meshfront-view" "$url" --script "$work/typo.txt"
grep -q 'typo.txt:2: .*connecting, refining, settled' "$work/err" || fail "it says: $(cat "$work/err")"

# A flight: twice around; the second time brings nothing new down.
cat >"$work/around.json" <<'END'
{"frames_per_second": 2, "loop": true, "rounds": 2,
 "key_frames": [{"time": 0, "camera": "azimuth=0"}, {"time": 4, "camera": "azimuth=360"}]}
END
expect_status 0 "$bin/meshfront-view" "$url" --headless --size 300x200 --path "$work/around.json" \
  --path-pace settled --frames "$work/frames" --path-log "$work/flight.csv" \
  --reference "$work/mesh.obj" --json
[ "$(find "$work/frames" -name 'frame-000*.png' | wc -l)" = 17 ] || fail "not 17 frames"
[ "$(number frames "$work/out")" = 17 ] || fail "it says: $(cat "$work/out")"
awk -F, 'NR == 1 { if ($0 != "frame,time,bytes_down,bytes_up,splits,triangles,psnr,state,collapses,resplits,memory,final_share") exit 1 }
  NR > 1 { if ($8 != "settled" || $7 < 30 || $3 < down) exit 2; down = $3; at[$1] = $3 }
  END { if (NR != 18) exit 3; if (at[16] != at[8]) exit 4 }' "$work/flight.csv" ||
  fail "the flight's log ($?): $(cat "$work/flight.csv")"
# Its reference is shaded as it is.
expect_status 0 "$bin/meshfront-view" "$origin/v1/meshes/lit" --headless --size 300x200 \
  --path "$work/around.json" --path-pace settled --path-log "$work/lit.csv" \
  --reference "$work/lit.obj"
awk -F, 'NR > 1 && $7 < 30 { exit 1 }' "$work/lit.csv" || fail "lit otherwise: $(cat "$work/lit.csv")"
# By the clock: as many frames, whatever has arrived.
sed 's/"frames_per_second": 2/"frames_per_second": 20/; s/"time": 4/"time": 0.4/' \
  "$work/around.json" >"$work/quick.json"
expect_status 0 "$bin/meshfront-view" "$url" --headless --size 300x200 --path "$work/quick.json" \
  --path-log "$work/real.csv"
[ "$(wc -l <"$work/real.csv")" = 18 ] || fail "not 17 frames by the clock"
echo "ok: $(number pictures_drawn "$work/status.json") pictures in the window"
