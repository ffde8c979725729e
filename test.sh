#!/usr/bin/env bash
# Installs what is needed, builds everything and runs every check:
#
#   1. build without warnings; all unit and integration tests
#   2. the same under AddressSanitizer and UndefinedBehaviorSanitizer
#   3. the tests with threads under ThreadSanitizer
#   4. the layout of the sources (clang-format), likely defects in them (clang-tidy)
#
# Takes no arguments. Logs lie in build/logs/. The last line is "N passed, N failed"; the exit
# status is 0 if nothing failed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
exec </dev/null

export CCACHE_BASEDIR=$PWD  # clones in other folders find what this one compiled
export CCACHE_SLOPPINESS=pch_defines,time_macros  # as precompiled headers need
jobs=$(nproc)
logs=build/logs
passed=0
failed=0
skipped=0
summary=()

# record NAME SECONDS PASSED FAILED [SKIPPED]
record() {
  passed=$((passed + $3))
  failed=$((failed + $4))
  skipped=$((skipped + ${5:-0}))
  summary+=("$(printf '%-46s %5d passed %4d failed %6d s' "$1" "$3" "$4" "$2")")
}

# check NAME LOG COMMAND...: counts as one test; shows the log's end if it fails.
check() {
  local name=$1 log=$logs/$2 begin=$SECONDS
  shift 2
  echo "== $name"
  if "$@" >"$log" 2>&1; then
    record "$name" $((SECONDS - begin)) 1 0
    return 0
  fi
  tail --lines=60 "$log"
  echo "FAILED: $name; the whole log is $log"
  record "$name" $((SECONDS - begin)) 0 1
  return 1
}

configure_and_build() {
  local preset=$1
  shift
  cmake --preset "$preset" && cmake --build --preset "$preset" --parallel "$jobs" "$@"
}

# tests NAME PRESET BUILD [WRAPPER...]: runs ctest and counts each test.
tests() {
  local name=$1 preset=$2 build=$3 begin=$SECONDS status=0
  shift 3
  local report=$PWD/$logs/$preset-tests.xml counts
  echo "== $name"
  rm -rf "$report" "$build/unit-shards"
  # One more than there are cores, since some tests mostly wait.
  "$@" ctest --preset "$preset" --parallel $((jobs + 1)) --output-junit "$report" || status=$?
  read -ra counts < <(python3 tests/count_tests.py "$report" "$build/unit-shards" || echo 0 0 0)
  # ctest failed, but no test did: no tests, or a crash of ctest.
  if ((status != 0 && counts[1] == 0)); then counts[1]=1; fi
  record "$name" $((SECONDS - begin)) "${counts[@]}"
}

sources() {
  find encoder load proxy service shared tests viewer \( -name '*.cpp' -o -name '*.h' \) -print0 | sort -z
}
formatted() {
  sources | xargs -0 clang-format --dry-run -Werror
}
tidy() {
  # Several files at a time, since most of the work goes into the system's headers.
  cmake --preset tidy >/dev/null && run-clang-tidy -p build/tidy -quiet -j "$jobs"
}

# ThreadSanitizer cannot start where the kernel scatters addresses too widely.
fixed_addresses=()
if setarch --addr-no-randomize true 2>/dev/null; then fixed_addresses=(setarch --addr-no-randomize); fi

./install-packages.sh
mkdir -p "$logs"

if check "build" ci-build.log configure_and_build ci; then
  tests "tests" ci build
fi
if check "build with address and undefined sanitizers" asan-build.log configure_and_build asan; then
  tests "tests with address and undefined sanitizers" asan build/asan
fi
if check "build with thread sanitizer" tsan-build.log configure_and_build tsan --target unit-tests; then
  tests "tests with thread sanitizer" tsan build/tsan "${fixed_addresses[@]}"
fi
check "clang-format" clang-format.log formatted || true
check "clang-tidy" clang-tidy.log tidy || true

echo
printf '%s\n' "${summary[@]}"
echo "took $((SECONDS / 60)) min $((SECONDS % 60)) s"
if ((skipped > 0)); then
  echo "$passed passed, $failed failed, $skipped skipped"
else
  echo "$passed passed, $failed failed"
fi
((failed == 0))
