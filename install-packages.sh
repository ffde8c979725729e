#!/usr/bin/env bash
# Installs the Debian 12 packages that meshfront is built, run and tested with.
#
#   ./install-packages.sh                all of them
#   ./install-packages.sh build run      only the named groups
#
# Run it as root or as a user who may use sudo. Packages that are there are left alone; when none
# is missing nothing is asked of the network.
set -euo pipefail

# The tools and libraries that CMake looks for.
build=(
  g++ cmake ninja-build pkg-config ccache
  libopenmesh-dev                      # encoder: connectivity while simplifying
  liblmdb-dev                          # packs
  libssl-dev                           # digests: revisions and entity tags
  libcurl4-openssl-dev                 # HTTP client of proxy and viewer
  nlohmann-json3-dev                   # metadata, reports
  libcli11-dev                         # command lines
  libfmt-dev libspdlog-dev             # text and logs
  libexpected-dev                      # Result<T>
  libegl-dev libgl-dev libepoxy-dev    # drawing without a display
  libglfw3-dev libimgui-dev            # the window and its panel
  libglm-dev                           # vectors and matrices of the viewer
  libpng-dev                           # pictures
  zlib1g-dev liblzma-dev libzstd-dev   # compressed mesh files
)
# What the programs, the demo and the examples of the README need beside the libraries.
run=(libegl-mesa0 libgl1-mesa-dri fonts-dejavu-core curl xz-utils python3)
# What test.sh needs on top.
test=(
  libgtest-dev libbenchmark-dev
  clang clang-format clang-tidy libclang-rt-14-dev
  xvfb xauth
  nginx-light varnish squid haproxy    # the caches that deploy/ has configurations for
  openssl                              # certificates for their tests
  systemd                              # systemd-analyze: the units of deploy/
  python3-yaml python3-jsonschema      # the description of the interface
  python3-matplotlib                   # plots of tests/evaluation
)
# What tests/bench compares with; whatever of these is missing is left out there.
bench=(
  libmeshoptimizer-dev                 # meshopt_simplify
  draco                                # draco_encoder
  wrk                                  # requests over HTTP, beside nginx
)

usage() {
  sed -n '2,8s/^# \{0,1\}//p' "$0"
  echo
  echo "Groups: build (${#build[@]} packages), run (${#run[@]}), test (${#test[@]}),"
  echo "bench (${#bench[@]})."
}

packages=()
for group in "${@:-all}"; do
  case "$group" in
    all) packages+=("${build[@]}" "${run[@]}" "${test[@]}" "${bench[@]}") ;;
    build) packages+=("${build[@]}") ;;
    run) packages+=("${run[@]}") ;;
    test) packages+=("${test[@]}") ;;
    bench) packages+=("${bench[@]}") ;;
    -h | --help) usage; exit 0 ;;
    *)
      echo "install-packages: no group '$group'" >&2
      usage >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "packages: all ${#packages[@]} are installed"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "install-packages: neither root nor sudo; have someone install: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
# sudo drops the environment, so it is set behind it.
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get
  -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3)

echo "packages: ${#missing[@]} of ${#packages[@]} are missing; installing: ${missing[*]}"
"${apt[@]}" update --quiet=2
"${apt[@]}" install --yes --quiet --no-install-recommends "${missing[@]}" </dev/null
echo "packages: all ${#packages[@]} are installed"
