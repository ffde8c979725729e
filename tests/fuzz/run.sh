#!/usr/bin/env bash
# Builds the fuzz targets (clang, AddressSanitizer, UndefinedBehaviorSanitizer) into build/fuzz and
# runs them on the seeds of corpus/ and on what earlier runs have found.
#
#   run.sh [SECONDS [TARGET...]]     default: 600 seconds each, all targets
#
# JOBS in the environment says how many run side by side (default 1). Prints a line a target:
# executions, features covered by the seeds and in the end, inputs that crashed, hung or took too
# much memory; those lie in build/fuzz/found/TARGET/. Inputs that cover something new are kept in
# build/fuzz/corpus/. The exit status is 1 if anything was found.
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

export CCACHE_BASEDIR=$PWD
mkdir -p build/fuzz
{
  cmake --preset fuzz
  cmake --build --preset fuzz --target "${targets[@]/#/fuzz-}"
} >build/fuzz/build.log 2>&1 || {
  tail --lines=40 build/fuzz/build.log >&2
  exit 1
}

# run_target SECONDS TARGET: ends with 1 if anything was found that happens again. What does not, a
# time-out of a machine that stood still say, is forgotten, and fuzzing goes on.
run_target() {
  local target=$2 log=build/fuzz/$2.log found=build/fuzz/found/$2
  local end=$((SECONDS + $1)) crashes=0 executions=0 left first="" last="" input
  local fuzz=("build/fuzz/bin/fuzz-$target" -timeout=10 -rss_limit_mb=1024)
  mkdir -p "build/fuzz/corpus/$target" "$found"
  TMPDIR=$(mktemp -d)
  export TMPDIR
  : >"$log.begin"
  : >"$log"
  while left=$((end - SECONDS)) && ((left > 0 && crashes == 0)); do
    "${fuzz[@]}" -max_total_time="$left" -max_len=4096 -print_final_stats=1 \
      -artifact_prefix="$found/" "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" \
      >"$log.run" 2>&1 || true
    cat "$log.run" >>"$log"
    left=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log.run")
    executions=$((executions + ${left:-0}))
    while read -r -d '' input; do
      if "${fuzz[@]}" "$input" >/dev/null 2>&1; then rm "$input"; else crashes=$((crashes + 1)); fi
    done < <(find "$found" -type f ! -name 'slow-unit-*' -newer "$log.begin" -print0)
  done
  rm -rf "$TMPDIR" "$log.run"
  first=$(sed -n 's/.*INITED .*ft: \([0-9]*\) .*/\1/p' "$log" | head --lines=1)
  last=$(sed -n 's/^#.*ft: \([0-9]*\) .*/\1/p' "$log" | tail --lines=1)
  printf '%-12s %10d executions, features %6s to %6s, %d crashes\n' \
    "$target" "$executions" "${first:-?}" "${last:-?}" "$crashes"
  ((crashes == 0))
}
export -f run_target
printf '%s\0' "${targets[@]}" |
  xargs -0 -I{} -P "${JOBS:-1}" bash -c 'run_target "$@"' run_target "$seconds" {} || exit 1
