#!/usr/bin/env bash
# Core archives may call nothing but each other and the four memory functions every compiler assumes:
# so they cannot allocate, throw, lock, read a clock, print or reach libm.
#   check_symbols.sh NM ARCHIVE...              fails and lists what an archive should not need
#   check_symbols.sh --self-test NM CXX SAMPLE  proves that a bad archive is caught
set -euo pipefail
export LC_ALL=C

# Prints "archive: kind: symbol" for every symbol that is not allowed.
forbidden_symbols() {
  local nm=$1 archive
  shift
  for archive in "$@"; do
    "$nm" -uC "$archive" | sed -n 's/^[[:space:]]*[Uw] //p' | sort -u | awk -v archive="${archive##*/}" '
      function kind(s) {
        if (s ~ /^(malloc|calloc|realloc|free|aligned_alloc|posix_memalign|memalign)$/) return "heap"
        if (s ~ /^operator (new|delete)/) return "heap"
        if (s ~ /^(__cxa_|_Unwind_|__gxx_|std::__throw|std::terminate)/) return "exceptions"
        if (s ~ /^(pthread_|sem_|__tls_)/) return "threads"
        if (s ~ /^(clock|time|nanosleep|usleep|sleep|gettimeofday|rand|srand|getenv)/) return "hidden input"
        if (s ~ /printf|^(puts|putchar|fopen|fwrite|fread|open|read|write|exit)$/) return "operating system"
        if (s ~ /^(__)?(sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|hypot|cbrt|fmod|remainder|sqrt|floor|ceil|round|lround|trunc|rint|nearbyint|ldexp|frexp|fma|tgamma|erf)[fl]?$/) return "libm"
        return "not on the list of allowed symbols"
      }
      /^(memcpy|memmove|memset|memcmp)$/ { next }
      /surefoot::/ { next }
      /^(_GLOBAL_OFFSET_TABLE_|__stack_chk_fail)$/ { next }
      { print archive ": " kind($0) ": " $0 }'
  done
}

self_test() {
  local nm=$1 cxx=$2 sample=$3 dir found wanted
  dir=$(mktemp -d)
  scratch=$dir
  trap 'rm -rf "$scratch"' EXIT
  "$cxx" -std=c++20 -O2 -c "$sample" -o "$dir/sample.o"
  found=$(forbidden_symbols "$nm" "$dir/sample.o")
  for wanted in 'heap: malloc' 'heap: operator new' 'exceptions: __cxa_throw' 'libm: sin$' \
    'hidden input: clock' 'operating system: printf' 'allowed symbols: environ'; do
    grep -q "$wanted" <<<"$found" || {
      printf 'not caught: %s\nfound:\n%s\n' "$wanted" "$found"
      return 1
    }
  done
  if grep -qE 'memcpy|surefoot::' <<<"$found"; then
    printf 'an allowed symbol was reported:\n%s\n' "$found"
    return 1
  fi
  echo "caught $(wc -l <<<"$found") forbidden symbols"
}

if [ "$1" = --self-test ]; then
  shift
  self_test "$@"
else
  nm=$1
  shift
  found=$(forbidden_symbols "$nm" "$@")
  [ -z "$found" ] || {
    printf '%s\n' "$found"
    exit 1
  }
  echo "$# archives need nothing from outside"
fi
