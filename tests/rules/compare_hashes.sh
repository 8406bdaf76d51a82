#!/usr/bin/env bash
# Two programs, or one program on two CPUs, must print the same hashes of core's modules.
#   compare_hashes.sh REFERENCE_PROGRAM OTHER_COMMAND [ARGUMENT...]
#   compare_hashes.sh --self-test
set -euo pipefail
export LC_ALL=C

compare() {
  local reference other
  reference=$("$1")
  shift
  other=$("$@")
  if [ -z "$reference" ] || [ "$reference" != "$other" ]; then
    diff <(echo "$reference") <(echo "$other") || true
    echo "the hashes differ"
    return 1
  fi
  echo "identical: $(wc -l <<<"$reference") modules"
}

if [ "$1" = --self-test ]; then
  if compare date echo different >/dev/null; then
    echo "a difference went unnoticed"
    exit 1
  fi
  if compare true true >/dev/null; then
    echo "empty output passed"
    exit 1
  fi
  echo "caught both"
else
  compare "$@"
fi
