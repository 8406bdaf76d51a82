#!/usr/bin/env bash
# The layer rule: who may include whom, and which standard headers core may use.
#   check_includes.sh ROOT         fails and lists every include that breaks it
#   check_includes.sh --self-test  proves that bad includes are caught
set -euo pipefail
export LC_ALL=C

readonly CORE_HEADERS=" array bit compare concepts cstddef cstdint cstring limits span type_traits utility algorithm Eigen/Core Eigen/Cholesky Eigen/LU Eigen/Geometry "

# Folder -> the folders it may include from, besides its own.
declare -A ALLOWED=(
  [core/base]=""
  [core/math]="core/base"
  [core/geometry]="core/base core/math"
  [core/robot]="core/base core/math core/geometry"
)
readonly FOUNDATION="core/base core/math core/geometry core/robot hal/api"
ALLOWED[core/actuation]="$FOUNDATION"
ALLOWED[core/estimation]="$FOUNDATION core/actuation"
ALLOWED[core/stereo]="$FOUNDATION"
ALLOWED[core/visual_odometry]="$FOUNDATION core/stereo"
ALLOWED[core/registration]="$FOUNDATION"
ALLOWED[core/mapping]="$FOUNDATION core/stereo core/registration"
ALLOWED[core/terrain]="${ALLOWED[core/mapping]} core/mapping"
ALLOWED[core/obstacles]="${ALLOWED[core/terrain]} core/terrain"
ALLOWED[core/objects]="${ALLOWED[core/terrain]} core/terrain"
ALLOWED[core/navigation]="$FOUNDATION core/objects"
ALLOWED[core/planning]="${ALLOWED[core/obstacles]} core/obstacles"
ALLOWED[core/control]="${ALLOWED[core/planning]} core/planning core/estimation core/actuation"
ALLOWED[core/motions]="$FOUNDATION core/actuation core/estimation core/mapping"
ALLOWED[core/safety]="${ALLOWED[core/control]} core/control"
ALLOWED[core/autonomy]="${ALLOWED[core/safety]} core/safety core/motions core/objects core/navigation core/visual_odometry"
ALLOWED[core/runtime]="core/base core/autonomy hal/api"
ALLOWED[hal/api]="core/base core/geometry"
readonly BACKEND="core/base hal/api"
readonly SIMULATOR="core/base core/math core/geometry core/robot core/actuation hal/api sim_hal"

# Single headers beyond that, each for a reason:
#   runtime's two interfaces are implemented by the operating system's side;
#   replay reads and compares what the executive records.
readonly EXCEPTIONS="
hal/linux core/runtime/executive.h
hal/linux core/runtime/slow_task_runner.h
hal/record core/runtime/tick_record.h
hal/replay core/runtime/tick_record.h
hal/replay hal/record/record_layout.h
hal/replay hal/record/record_reader.h
"

# No process is started for a line: there are thousands.

# Sets `folder`: the one a path counts for, two levels, but sim_hal and apps as a whole.
find_folder() {
  case "$1" in
    sim_hal/*) folder=sim_hal ;;
    apps/*) folder=apps ;;
    */*/*)
      local rest=${1#*/}
      folder=${1%%/*}/${rest%%/*}
      ;;
    *) folder=. ;;
  esac
}

# Sets `permitted`: what a folder may include from, or `unlisted`.
find_permitted() {
  case "$1" in
    sim_hal) permitted=$SIMULATOR ;;
    hal/api) permitted=${ALLOWED[hal/api]} ;;
    hal/*) permitted=$BACKEND ;;
    *) permitted=${ALLOWED[$1]-unlisted} ;;
  esac
}

violations() {
  local file line text name from target folder permitted
  local -r pattern='[<"]([^>"]+)[>"]'
  while IFS=: read -r file line text; do
    file=${file#./}
    find_folder "$file"
    from=$folder
    [ "$from" != apps ] || continue
    find_permitted "$from"
    [ "$permitted" != unlisted ] || {
      echo "$file: folder $from is not in the layer table"
      continue
    }
    [[ $text =~ $pattern ]] || {
      echo "$file:$line: not an include"
      continue
    }
    name=${BASH_REMATCH[1]}
    if [[ $text == *\<* ]]; then
      if [[ $from == core/* || $from == hal/api ]] && [[ $CORE_HEADERS != *" $name "* ]]; then
        echo "$file:$line: <$name> is not on core's list"
      fi
      continue
    fi
    find_folder "$name"
    target=$folder
    if [ "$target" = . ]; then
      echo "$file:$line: \"$name\" is not a path from the root"
    elif [ "$target" != "$from" ] && [[ " $permitted " != *" $target "* ]] &&
      [[ $EXCEPTIONS != *$'\n'"$from $name"$'\n'* ]]; then
      echo "$file:$line: $from may not include \"$name\""
    fi
  done < <(grep -rnE --include='*.h' --include='*.cc' '^[[:space:]]*#[[:space:]]*include' core hal sim_hal apps)
}

self_test() {
  local dir found wanted
  dir=$(mktemp -d)
  scratch=$dir
  trap 'rm -rf "$scratch"' EXIT
  cd "$dir"
  mkdir -p core/math core/mapping core/planning core/new hal/api hal/socketcan sim_hal/world apps/x
  printf '#include "core/base/status.h"\n#include <array>\n#include <vector>\n#include <cmath>\n' >core/math/a.h
  printf '#include "core/planning/p.h"\n#include "sim_hal/world/w.h"\n#include "b.h"\n' >core/mapping/b.cc
  printf '#include "core/mapping/b.h"\n#include "hal/socketcan/s.h"\n' >core/planning/p.h
  printf '#include <array>\n' >core/new/n.h
  printf '#include "core/robot/robot_model.h"\n#include "core/geometry/frames.h"\n' >hal/api/h.h
  printf '#include "core/control/gait.h"\n#include <vector>\n' >hal/socketcan/s.h
  printf '#include "core/autonomy/tick.h"\n#include <cmath>\n' >sim_hal/world/w.h
  printf '#include "hal/socketcan/s.h"\n' >apps/x/main.cc
  found=$(violations | sort)
  wanted=$(sort <<'TEXT'
core/math/a.h:3: <vector> is not on core's list
core/math/a.h:4: <cmath> is not on core's list
core/mapping/b.cc:1: core/mapping may not include "core/planning/p.h"
core/mapping/b.cc:2: core/mapping may not include "sim_hal/world/w.h"
core/mapping/b.cc:3: "b.h" is not a path from the root
core/planning/p.h:2: core/planning may not include "hal/socketcan/s.h"
core/new/n.h: folder core/new is not in the layer table
hal/api/h.h:1: hal/api may not include "core/robot/robot_model.h"
hal/socketcan/s.h:1: hal/socketcan may not include "core/control/gait.h"
sim_hal/world/w.h:1: sim_hal may not include "core/autonomy/tick.h"
TEXT
  )
  diff <(echo "$wanted") <(echo "$found") && echo "caught all $(wc -l <<<"$wanted")"
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
  echo "layers hold"
fi
