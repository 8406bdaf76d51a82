#!/usr/bin/env bash
# Sources stay readable: at most 500 lines of 100 columns, no tabs, no blanks at line ends.
#   check_text.sh ROOT         fails and lists what is not
#   check_text.sh --self-test  proves that bad files are caught
set -euo pipefail
export LC_ALL=C.UTF-8  # columns, not bytes

readonly MAX_LINES=500
readonly MAX_COLUMNS=100

# One pass over all files; columns are counted in characters.
violations() {
  local -a files
  mapfile -t files < <(find core hal sim_hal apps tests \( -name '*.h' -o -name '*.cc' \) | sort)
  perl -CSD -Mutf8 -e '
    my ($lines, $columns) = splice(@ARGV, 0, 2);
    for my $file (@ARGV) {
      open(my $text, "<", $file) or die "$file: $!\n";
      my @lines = <$text>;
      print "$file: ", scalar(@lines), " lines\n" if @lines > $lines;
      for my $i (0 .. $#lines) {
        chomp(my $line = $lines[$i]);
        my $at = "$file:" . ($i + 1);
        print "$at: over $columns columns\n" if length($line) > $columns;
        print "$at: tab\n" if $line =~ /\t/;
        print "$at: blank at the end\n" if $line =~ /[ \t]$/;
      }
    }' "$MAX_LINES" "$MAX_COLUMNS" "${files[@]}"
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
    'hal/wide.cc:3: blank at the end' 'hal/wide.cc:4: tab') <(echo "$found") && echo "caught all four"
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
