#!/usr/bin/env bash
# Builds the fuzz targets (clang, AddressSanitizer, UndefinedBehaviorSanitizer) into build/fuzz and
# runs them one after another on the seeds of corpus/ and on what earlier runs have found.
#
#   run.sh [SECONDS [TARGET...]]     default: 600 seconds each, all targets
#
# Prints a line a target: executions, features covered at first and in the end, inputs that crashed,
# hung or took too much memory; those lie in build/fuzz/found/TARGET/. What is found anew is kept in
# build/fuzz/corpus/. The exit status is 1 if anything crashed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:-600}
shift || true
if ! [[ $seconds =~ ^[0-9]+$ ]]; then
  echo "usage: run.sh [SECONDS [TARGET...]]" >&2
  exit 2
fi
targets=("$@")
if ((${#targets[@]} == 0)); then
  for folder in tests/fuzz/corpus/*/; do targets+=("$(basename "$folder")"); done
fi

mkdir -p build/fuzz
{
  cmake --preset fuzz
  cmake --build --preset fuzz --target "${targets[@]/#/fuzz-}"
} >build/fuzz/build.log 2>&1 || {
  tail --lines=40 build/fuzz/build.log >&2
  exit 1
}

crashed=0
for target in "${targets[@]}"; do
  mkdir -p "build/fuzz/corpus/$target" "build/fuzz/found/$target"
  log=build/fuzz/$target.log
  before=$(find "build/fuzz/found/$target" -type f | wc -l)
  TMPDIR=$(mktemp -d)
  export TMPDIR
  "build/fuzz/bin/fuzz-$target" -max_total_time="$seconds" -max_len=4096 -timeout=10 \
    -rss_limit_mb=1024 -print_final_stats=1 -artifact_prefix="build/fuzz/found/$target/" \
    "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" >"$log" 2>&1 || true
  rm -rf "$TMPDIR"
  unset TMPDIR
  found=$(($(find "build/fuzz/found/$target" -type f | wc -l) - before))
  crashed=$((crashed + found))
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  first=$(sed -n 's/.* INITED .* ft: \([0-9]*\) .*/\1/p' "$log")
  last=$(sed -n 's/^#.* ft: \([0-9]*\) .*/\1/p' "$log" | tail --lines=1)
  printf '%-12s %10s executions, features %6s to %6s, %d crashes\n' \
    "$target" "${executions:-?}" "${first:-?}" "${last:-?}" "$found"
done
((crashed == 0))
