#!/usr/bin/env bash
# Sources stay readable: at most 500 lines of 100 columns, no tabs, no blanks at line ends.
#   check_text.sh ROOT         fails and lists what is not
#   check_text.sh --self-test  proves that bad files are caught
set -euo pipefail
export LC_ALL=C.UTF-8  # columns, not bytes

readonly MAX_LINES=500
readonly MAX_COLUMNS=100

violations() {
  local file lines
  while IFS= read -r file; do
    lines=$(wc -l <"$file")
    [ "$lines" -le "$MAX_LINES" ] || echo "$file: $lines lines"
    grep -nE "^.{$((MAX_COLUMNS + 1)),}" "$file" | sed "s|^\([0-9]*\):.*|$file:\1: over $MAX_COLUMNS columns|" || true
    grep -nP '\t' "$file" | sed "s|^\([0-9]*\):.*|$file:\1: tab|" || true
    grep -nE '[[:blank:]]$' "$file" | sed "s|^\([0-9]*\):.*|$file:\1: blank at the end|" || true
  done < <(find core hal sim_hal apps tests \( -name '*.h' -o -name '*.cc' \) | sort)
}

self_test() {
  local dir found
  dir=$(mktemp -d)
  scratch=$dir
  trap 'rm -rf "$scratch"' EXIT
  cd "$dir"
  mkdir -p core hal sim_hal apps tests
  seq 500 >core/fits.h
  seq 501 >core/long.h
  printf 'a\n%s\nb \n\tc\n' "$(printf 'x%.0s' {1..101})" >hal/wide.cc
  printf '%s\n' "$(printf 'ü%.0s' {1..100})" >hal/wide_enough.cc
  found=$(violations)
  diff <(printf '%s\n' 'core/long.h: 501 lines' 'hal/wide.cc:2: over 100 columns' \
    'hal/wide.cc:4: tab' 'hal/wide.cc:3: blank at the end') <(echo "$found") && echo "caught all four"
}

if [ "$1" = --self-test ]; then
  self_test
else
  cd "$1"
  found=$(violations)
  [ -z "$found" ] || {
    printf '%s\n' "$found"
    exit 1
  }
  echo "text is in shape"
fi
