#!/usr/bin/env bash
# Every source of ours is compiled with the flags that make its arithmetic the same everywhere.
#   check_flags.sh COMPILE_COMMANDS_JSON ROOT   fails and lists the sources that escaped
#   check_flags.sh --self-test                  proves that an escaped source is caught
set -euo pipefail
export LC_ALL=C

readonly REQUIRED="-ffp-contract=off -fsigned-char -fno-math-errno -DEIGEN_DONT_VECTORIZE -DEIGEN_CACHEFRIENDLY_PRODUCT_THRESHOLD=64"
readonly FORBIDDEN="-ffast-math -Ofast -march=native -mtune=native -funsafe-math-optimizations -mfma -mavx -mavx2 -ffp-contract=fast -ffp-contract=on -funsigned-char"

# One line per source: its path relative to ROOT, a tab, what is wrong.
violations() {
  awk -v root="$2/" -v required="$REQUIRED" -v forbidden="$FORBIDDEN" '
    BEGIN { needed = split(required, need, " "); banned = split(forbidden, ban, " ") }
    /^ *"command": / { command = " " $0 " " }
    /^ *"file": / {
      file = $0
      sub(/^ *"file": "/, "", file); sub(/",?$/, "", file)
      if (index(file, root) != 1) next  # googletest and other foreign sources
      file = substr(file, length(root) + 1)
      if (file !~ /^(core|hal|sim_hal|apps|tests)\//) next
      ++seen
      for (i = 1; i <= needed; ++i)
        if (index(command, " " need[i] " ") == 0) print file "\tlacks " need[i]
      for (i = 1; i <= banned; ++i)
        if (index(command, " " ban[i] " ") != 0) print file "\thas " ban[i]
    }
    END { if (seen == 0) print "no source of ours is listed" }' "$1"
}

self_test() {
  local file good found
  file=$(mktemp)
  scratch=$file
  trap 'rm -f "$scratch"' EXIT
  good=$REQUIRED
  cat >"$file" <<TEXT
[
{
  "directory": "/r/build",
  "command": "g++ $good -o a.o -c /r/core/math/good.cc",
  "file": "/r/core/math/good.cc"
},
{
  "directory": "/r/build",
  "command": "g++ ${good/-fsigned-char /} -o b.o -c /r/core/math/lacking.cc",
  "file": "/r/core/math/lacking.cc"
},
{
  "directory": "/r/build",
  "command": "g++ $good -march=native -o c.o -c /r/apps/native.cc",
  "file": "/r/apps/native.cc"
},
{
  "directory": "/r/build",
  "command": "g++ -o d.o -c /usr/src/googletest/gtest.cc",
  "file": "/usr/src/googletest/gtest.cc"
}
]
TEXT
  found=$(violations "$file" /r)
  diff <(printf 'core/math/lacking.cc\tlacks -fsigned-char\napps/native.cc\thas -march=native\n') \
    <(echo "$found") && echo "caught both"
}

if [ "$1" = --self-test ]; then
  self_test
else
  found=$(violations "$1" "$2")
  [ -z "$found" ] || {
    printf '%s\n' "$found"
    exit 1
  }
  echo "every source has the flags"
fi
