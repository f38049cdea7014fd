#!/usr/bin/env bash
# Builds everything and runs every check and test. Works on a fresh Debian 12 as root, or as a user with sudo; installs
# what tests/packages.txt lists and is missing. A second run builds and checks only what changed.
#
# With --packages the Debian packages are built and taken through install, calibration, upgrade, reboot and purge in a
# virtual machine too, and the archive is tried on a bare Debian, which takes some half an hour more.
#
# With --long, tests that take minutes each run too: more robots and recordings than are needed to see a fault.
#
# Environment: ODOMCALIB_SHARED  folder with the real recordings and captures (default ../shared); tests that need it
#                                are skipped loudly without it
#              JOBS              parallel jobs (default: number of processors)
set -euo pipefail
cd "$(dirname "$0")"
jobs=${JOBS:-$(nproc)} packages=OFF
unset ODOMCALIB_LONG
for argument in "$@"; do
  case $argument in
    --packages) packages=ON ;;
    --long) export ODOMCALIB_LONG=1 ;;
    *) echo "usage: ./test.sh [--packages] [--long]" >&2; exit 2 ;;
  esac
done
export DEBIAN_FRONTEND=noninteractive CTEST_PARALLEL_LEVEL=$jobs

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }

install_packages() {
  local missing=()
  while read -r package; do
    case $package in ''|\#*) continue ;; esac
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done < tests/packages.txt
  [ ${#missing[@]} -eq 0 ] && return
  echo "installing: ${missing[*]}"
  as_root apt-get update -q
  as_root apt-get install -q -y --no-install-recommends "${missing[@]}"
}

build() {
  local launcher=()
  if command -v ccache >/dev/null; then
    launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  cmake --preset release -DODOMCALIB_TESTS=ON -DODOMCALIB_PACKAGE_TESTS=$packages "${launcher[@]}"
  cmake --build build/release -j "$jobs"
}

install_packages
failed=()
build
tests/lint || failed+=("tests/lint")
[ -d "${ODOMCALIB_SHARED:-../shared}" ] ||
  echo "WARNING: no real recordings at ${ODOMCALIB_SHARED:-../shared}; tests that need them are skipped"
ctest --preset release -j 2 --output-junit tests.xml || failed+=("ctest")

count() { tr -s '[:space:]' ' ' < build/release/tests.xml | grep -o '<testsuite [^>]*' | grep -o " $1=\"[0-9]*" | tr -dc 0-9; }
tests/build_times build/release --tests build/release/tests.xml --jobs "$jobs" || failed+=("tests/build_times")
[ $packages = ON ] || echo "not tested: archive, packages, and the system that they are installed in (./test.sh --packages)"
[ -n "${ODOMCALIB_LONG:-}" ] || echo "not tested: what takes minutes a test (./test.sh --long)"
echo "tests run: $(count tests), failed: $(count failures), skipped: $(count skipped)"
if [ ${#failed[@]} -gt 0 ]; then
  echo "FAILED: ${failed[*]}"
  exit 1
fi
echo "all checks passed"
