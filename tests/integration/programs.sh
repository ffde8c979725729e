# Shared by the integration tests: sourced with the folder of the programs as $1. Sets $bin and a
# scratch folder $work; ends every program it started.
set -euo pipefail
bin=$1
work=$(mktemp -d)
started=()
end_programs() {
  for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${started[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap end_programs EXIT

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# start_server NAME COMMAND...: waits until it listens; its address comes in $origin, its process
# in $server.
start_server() {
  local name=$1
  shift
  : >"$work/$name.out"  # there before the server's shell makes it
  "$@" >>"$work/$name.out" 2>"$work/$name.log" &
  server=$!
  started+=("$server")
  for _ in $(seq 200); do
    origin=$(sed -n 's/^listening on //p' "$work/$name.out")
    [ -n "$origin" ] && return 0
    kill -0 "$server" 2>/dev/null || break
    sleep 0.05
  done
  cat "$work/$name.log" >&2
  fail "$name does not listen"
}

# stop_server PID: SIGTERM, and it must end well.
stop_server() {
  local status=0
  kill -TERM "$1"
  wait "$1" || status=$?
  [ "$status" = 0 ] || fail "a server ended with status $status"
}

# number KEY FILE: a number at the top of a JSON object.
number() { sed -n "s/.*\"$1\":\([0-9.]*\).*/\1/p" "$2"; }

# counter ORIGIN NAME-WITH-LABELS: its value in /metrics.
counter() { curl -fsS "$1/metrics" | awk -v name="$2" '$1 == name { print $2 }'; }

# expect_status STATUS COMMAND...
expect_status() {
  local wanted=$1 status=0
  shift
  "$@" >"$work/out" 2>"$work/err" || status=$?
  if [ "$status" != "$wanted" ]; then
    cat "$work/out" "$work/err" >&2
    fail "status $status instead of $wanted: $*"
  fi
}

# write_test_mesh FILE: a bumpy torus (closed) and a wavy sheet (with a boundary), about 5,000
# triangles.
write_test_mesh() {
  awk 'BEGIN {
    n = 48; m = 36; pi = atan2(0, -1);
    for (i = 0; i < n; ++i) for (j = 0; j < m; ++j) {
      a = 2 * pi * i / n; b = 2 * pi * j / m; t = 0.4 + 0.04 * sin(9 * a) * cos(4 * b);
      printf "v %.6f %.6f %.6f\n", (1 + t * cos(b)) * cos(a), (1 + t * cos(b)) * sin(a), t * sin(b);
    }
    for (i = 0; i < n; ++i) for (j = 0; j < m; ++j) {
      p = i * m + j + 1; q = (i + 1) % n * m + j + 1;
      r = (i + 1) % n * m + (j + 1) % m + 1; s = i * m + (j + 1) % m + 1;
      print "f", p, q, r; print "f", p, r, s;
    }
    base = n * m; k = 30;
    for (i = 0; i <= k; ++i) for (j = 0; j <= k; ++j)
      printf "v %.6f %.6f %.6f\n", i / k - 0.5, j / k - 0.5, 0.1 * sin(7 * i / k) * cos(5 * j / k);
    for (i = 0; i < k; ++i) for (j = 0; j < k; ++j) {
      p = base + i * (k + 1) + j + 1; q = p + k + 1;
      print "f", p, q, q + 1; print "f", p, q + 1, p + 1;
    }
  }' >"$1"
}
