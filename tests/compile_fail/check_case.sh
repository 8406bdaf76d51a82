#!/usr/bin/env bash
# check_case.sh SOURCE COMPILER [FLAG...]: SOURCE compiles; with -DMUST_FAIL it does not, and the
# compiler says what the source's line "// expect: REGEX" wants.
set -euo pipefail
export LC_ALL=C
source_file=$1
shift
expected=$(sed -n 's|^// expect: ||p' "$source_file" | sed -n 1p)
[ -n "$expected" ] || {
  echo "$source_file names no reason"
  exit 1
}
"$@" -fsyntax-only "$source_file" || {
  echo "the allowed variant does not compile"
  exit 1
}
if output=$("$@" -fsyntax-only -DMUST_FAIL "$source_file" 2>&1); then
  echo "the forbidden variant compiles"
  exit 1
fi
grep -qE "$expected" <<<"$output" || {
  printf 'it fails for another reason than /%s/:\n%s\n' "$expected" "$output"
  exit 1
}
