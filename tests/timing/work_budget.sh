#!/usr/bin/env bash
# Instructions of each case of task_work against the committed table, in both directions: more is a
# task that became slower, less is a win to be written down or work that is no longer done.
#   work_budget.sh TASK_WORK TABLE            fails and lists what is off
#   work_budget.sh TASK_WORK TABLE --update   writes the measured counts, keeping each tolerance
#   work_budget.sh --self-test                proves that differences either way are caught
set -euo pipefail
export LC_ALL=C
# The C library picks memcpy by CPU: without these the count would depend on the machine.
export GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-AVX_Fast_Unaligned_Load,-ERMS,-FSRM

readonly DEFAULT_TOLERANCE=2

# Prints "case,instructions" for every case that the program lists.
measure() {
  local program=$1 name count log
  log=$(mktemp)
  while read -r name; do
    valgrind --tool=callgrind --toggle-collect=measured_region --callgrind-out-file=/dev/null \
      "$program" "$name" >"$log" 2>&1 </dev/null || {
      cat "$log" >&2
      rm -f "$log"
      return 1
    }
    count=$(sed -n 's/^==[0-9]*== Collected : \([0-9]*\).*/\1/p' "$log")
    printf '%s,%s\n' "$name" "${count:-0}"
  done < <("$program" | cut -f1)
  rm -f "$log"
}

# compare MEASURED TABLE: one line per case; status 1 when one is off, missing or not in the table.
compare() {
  awk -F, '
    /^#/ || /^case,/ || NF == 0 { next }
    pass == 1 { measured[$1] = $2; next }
    {
      known[$1] = 1
      if (!($1 in measured)) { print $1 ": in the table, but there is no such case"; bad = 1; next }
      change = $2 > 0 ? 100 * (measured[$1] - $2) / $2 : 100
      verdict = change > $3 ? "MORE" : change < -$3 ? "LESS" : "ok"
      if (verdict != "ok" || measured[$1] == 0) bad = 1
      printf "%-22s %12d  budget %12d +-%g %%  %+7.2f %%  %s\n", $1, measured[$1], $2, $3, change, verdict
    }
    END {
      for (name in measured) if (!(name in known)) { print name ": not in the table"; bad = 1 }
      exit bad
    }' pass=1 "$1" pass=2 "$2"
}

# update MEASURED TABLE: the new table on standard output.
update() {
  echo "case,instructions,tolerance_percent"
  awk -F, -v usual="$DEFAULT_TOLERANCE" '
    pass == 1 { tolerance[$1] = $3; next }
    { print $1 "," $2 "," ($1 in tolerance ? tolerance[$1] : usual) }' pass=1 "$2" pass=2 "$1"
}

expect() {
  local wanted=$1 text=$2 status=0 output
  output=$(compare "$dir/measured" "$dir/table") || status=1
  if [ "$status" -ne "$wanted" ] || ! grep -q -- "$text" <<<"$output"; then
    printf 'expected status %s and "%s", got %s:\n%s\n' "$wanted" "$text" "$status" "$output"
    return 1
  fi
}

self_test() {
  dir=$(mktemp -d)
  trap 'rm -rf "$dir"' EXIT
  printf 'case,instructions,tolerance_percent\na,1000000,2\nb,500,2\n' >"$dir/table"
  printf 'a,1000000\nb,500\n' >"$dir/measured"
  expect 0 ok
  printf 'a,1019000\nb,491\n' >"$dir/measured"
  expect 0 ok
  printf 'a,1050000\nb,500\n' >"$dir/measured"
  expect 1 'a .*+5.00 %  MORE'
  printf 'a,950000\nb,500\n' >"$dir/measured"
  expect 1 'a .*-5.00 %  LESS'
  printf 'a,1000000\n' >"$dir/measured"
  expect 1 'b: in the table'
  printf 'a,1000000\nb,500\nc,7\n' >"$dir/measured"
  expect 1 'c: not in the table'
  printf 'a,1000000\nb,0\n' >"$dir/measured"
  expect 1 'b .*LESS'
  : >"$dir/measured"
  expect 1 'a: in the table'
  printf 'a,1000000\nb,0\n' >"$dir/measured"
  update "$dir/measured" "$dir/table" | grep -qx 'b,0,2'
  echo "caught +5 %, -5 %, missing, unknown and empty cases"
}

if [ "$1" = --self-test ]; then
  self_test
  exit
fi
command -v valgrind >/dev/null || {
  echo "valgrind is missing: ./dev test installs it (Debian package valgrind)"
  exit 1
}
counts=$(mktemp)
trap 'rm -f "$counts" "$counts.table"' EXIT
measure "$1" >"$counts"
if [ "${3:-}" = --update ]; then
  update "$counts" "$2" >"$counts.table"
  cat "$counts.table" >"$2"
  cat "$2"
else
  compare "$counts" "$2" || {
    echo "If the change is meant: tests/timing/work_budget.sh $1 tests/timing/budgets.csv --update"
    exit 1
  }
fi
