#!/usr/bin/env bash
# No core function has a frame of unknown size or one above the limit (bytes).
#   check_stack.sh BUILD_DIR LIMIT   reads the .su files of -fstack-usage; prints the largest frames
#   check_stack.sh --self-test CXX   proves that unbounded and large frames are caught
set -euo pipefail
export LC_ALL=C

su_files() { find "$1" -name '*.su' -print0; }

violations() {
  su_files "$1" | xargs -0 -r awk -F'\t' -v limit="$2" '
    $3 == "dynamic" { print $1 ": frame of unknown size"; next }
    $2 > limit { print $1 ": frame of " $2 " bytes, limit " limit }'
}

self_test() {
  local dir found
  dir=$(mktemp -d)
  scratch=$dir
  trap 'rm -rf "$scratch"' EXIT
  cat >"$dir/sample.cc" <<'TEXT'
void use(volatile char*);
void small() { volatile char a[64]; use(a); }
void large() { volatile char a[5000]; use(a); }
void unknown(unsigned n) { use(static_cast<volatile char*>(__builtin_alloca(n))); }
TEXT
  "$1" -O2 -fstack-usage -c "$dir/sample.cc" -o "$dir/sample.o"
  found=$(violations "$dir" 4096)
  if [ "$(wc -l <<<"$found")" -ne 2 ] || ! grep -q 'large.*bytes' <<<"$found" ||
    ! grep -q 'unknown.*unknown size' <<<"$found"; then
    printf 'expected two, found:\n%s\n' "$found"
    return 1
  fi
  echo "caught both"
}

if [ "$1" = --self-test ]; then
  self_test "$2"
else
  [ -n "$(su_files "$1" | tr '\0' '\n' | sed -n 1p)" ] || {
    echo "no .su file below $1: nothing was checked"
    exit 1
  }
  found=$(violations "$1" "$2")
  [ -z "$found" ] || {
    printf '%s\n' "$found"
    exit 1
  }
  echo "largest frames, bytes:"
  su_files "$1" | xargs -0 awk -F'\t' '{ print $2 "\t" $1 }' | sort -rn | sed -n 1,5p
fi
