#!/usr/bin/env bash
# No call in core recurses, and no path from a task's entry needs more stack than the limit (bytes).
#   check_stack_path.sh BUILD_DIR LIMIT   reads the .ci files of -fcallgraph-info=su (g++)
#   check_stack_path.sh --self-test CXX   proves that recursion, depth and hidden calls are caught
#
# A path's size is the sum of its frames (return addresses are in them) plus 128 bytes of red zone.
# A function that several files hold counts with its largest frame and with the calls of all of them.
# Calls through pointers and virtual calls are allowed in core/runtime alone, where they are the task
# table and the ports: each counts as the deepest task. What a port needs is its backend's (docs/memory.md).
# Functions from outside core: memcpy and its kin and the handlers of failed assertions count
# OUTSIDE_BYTES, any other is an error.
set -euo pipefail
export LC_ALL=C

readonly TASKS='surefoot::autonomy::Autonomy::run_control(
surefoot::autonomy::Autonomy::begin_mpc(
surefoot::autonomy::Autonomy::begin_stereo(
surefoot::autonomy::Autonomy::begin_localisation(
surefoot::autonomy::Autonomy::begin_mapping(
surefoot::autonomy::Autonomy::begin_terrain(
surefoot::control::ConvexMpc::solve(
surefoot::autonomy::StereoTask::run(
surefoot::autonomy::StereoTask::publish(
surefoot::autonomy::LocalisationTask::run(
surefoot::autonomy::Autonomy::publish_localisation(
surefoot::autonomy::MapTask::run(
surefoot::autonomy::MapTask::publish(
surefoot::autonomy::TerrainTask::run(
surefoot::autonomy::TerrainTask::publish(
surefoot::autonomy::Autonomy::begin_objects(
surefoot::autonomy::ObjectTask::run(
surefoot::autonomy::ObjectTask::publish(
surefoot::autonomy::Autonomy::begin_planning(
surefoot::navigation::Navigator::run(
surefoot::navigation::Navigator::publish('
readonly OTHERS='surefoot::runtime::Executive::run_tick(
surefoot::autonomy::Autonomy::reset(
surefoot::runtime::Executive::start('
readonly OUTSIDE_BYTES=512

# analyse DIR LIMIT TASKS OTHERS: prints the deepest paths; violations go to standard output as well.
analyse() {
  find "$1" -name '*.ci' -print0 | sort -z | xargs -0 -r cat |
    awk -v limit="$2" -v outside="$OUTSIDE_BYTES" -v tasks="$3" -v others="$4" '
    function field(line, key,    at, rest) {
      at = index(line, key ": \"")
      rest = substr(line, at + length(key) + 3)
      return substr(rest, 1, index(rest, "\"") - 1)
    }
    function fail(text) { print text; failures++ }
    # The deepest need of a function; follows[] remembers the callee on the deepest path.
    function depth(f,    i, n, callees, deepest, d) {
      if (state[f] == 2) return need[f]
      if (state[f] == 1) {
        fail("recursion through " name[f])
        return 0
      }
      state[f] = 1
      deepest = 0
      n = split(calls[f], callees, SUBSEP)
      for (i = 1; i <= n; i++) {
        d = depth(resolve(callees[i]))
        if (d > deepest) {
          deepest = d
          follows[f] = resolve(callees[i])
        }
      }
      state[f] = 2
      return need[f] = frame[f] + deepest
    }
    function show(f, total) {
      print total " bytes on the deepest path from " name[f] ":"
      for (; f != ""; f = follows[f]) printf "  %6d  %s\n", frame[f], name[f]
    }
    # A complete object constructor (C1) is often another name of the base one (C2), likewise D1, D2.
    function resolve(f,    at, other) {
      if (f in defined) return f
      for (at = 1; at < length(f) - 1; at++) {
        if (substr(f, at, 3) !~ /^[CD]1[EI]$/) continue
        other = substr(f, 1, at) "2" substr(f, at + 2)
        if (other in defined) return other
      }
      return f
    }
    function entry(text,    f) {
      for (f in defined) if (index(name[f], text)) return f
      fail("no entry " text " in the call graph")
      return ""
    }
    /^node:/ {
      f = field($0, "title")
      label = field($0, "label")
      parts = split(label, part, "\\\\n")
      if (!(f in name) || !(f in defined)) name[f] = part[1]
      if (/shape : ellipse/) next
      bytes = part[3] + 0
      if (part[3] !~ /static/ && part[3] !~ /bounded/) fail(part[1] ": frame of unknown size")
      if (part[2] ~ /core\/runtime\//) in_runtime[f] = 1
      defined[f] = 1
      if (bytes > frame[f]) frame[f] = bytes
    }
    /^edge:/ {
      f = field($0, "sourcename")
      to = field($0, "targetname")
      if ((f, to) in seen) next
      seen[f, to] = 1
      calls[f] = calls[f] (calls[f] == "" ? "" : SUBSEP) to
      called[to] = 1
    }
    END {
      for (f in called) {
        if (resolve(f) in defined || f == "__indirect_call") continue
        frame[f] = outside
        if (f !~ /^mem(cpy|set|cmp|move)$/ && f !~ /assertion_failed|^__assert_fail$/) {
          fail("call to " name[f] " (" f "), whose stack is unknown")
        }
      }
      for (pair in seen) {
        split(pair, ends, SUBSEP)
        if (ends[2] == "__indirect_call" && !(ends[1] in in_runtime)) {
          fail("call through a pointer in " name[ends[1]])
        }
      }
      # The indirect call has no callees yet: tasks may not use it, so their needs are complete.
      count = split(tasks, task, "\n")
      deepest_task = ""
      for (i = 1; i <= count; i++) {
        f = entry(task[i])
        if (f == "") continue
        report[i] = f
        if (deepest_task == "" || depth(f) > depth(deepest_task)) deepest_task = f
      }
      delete state["__indirect_call"]
      name["__indirect_call"] = "(a task or port)"
      calls["__indirect_call"] = deepest_task
      extra = split(others, other, "\n")
      for (i = 1; i <= extra; i++) report[++count] = entry(other[i])
      for (f in defined) depth(f)
      for (i = 1; i <= count; i++) {
        f = report[i]
        if (f == "") continue
        total = depth(f) + 128
        show(f, total)
        if (total > limit) fail(name[f] " needs " total " bytes, limit " limit)
      }
      exit failures > 0
    }'
}

# refused EXPECTED SOURCE CXX: the sample must be refused with the expected text; empty: accepted.
refused() {
  local expected=$1 source=$2 cxx=$3 dir output status=0
  dir=$(mktemp -d)
  printf '%s\n' "$source" >"$dir/sample.cc"
  (cd "$dir" && "$cxx" -O2 -std=c++20 -fcallgraph-info=su -c sample.cc -o sample.cc.o)
  output=$(analyse "$dir" 4096 'entry(' '') || status=1
  rm -rf "$dir"
  if [ -z "$expected" ]; then
    [ "$status" -eq 0 ] && return 0
  elif [ "$status" -ne 0 ] && grep -q "$expected" <<<"$output"; then
    return 0
  fi
  printf 'expected "%s", found:\n%s\n' "${expected:-no complaint}" "$output"
  return 1
}

self_test() {
  local cxx=$1 fill='
    #define STEP __attribute__((noinline, noclone, noipa))
    STEP int fill(int x) { volatile char a[3000]; a[x] = 1; return a[x / 2]; }'
  refused '' "$fill STEP int entry(int x) { return fill(x) + 1; }" "$cxx"
  refused 'needs .* limit 4096' \
    "$fill STEP int entry(int x) { volatile char a[3000]; a[x] = 1; return fill(x) + a[x / 2]; }" "$cxx"
  refused 'recursion through' \
    "$fill int entry(int); STEP int back(int x) { return entry(x - 1) + 1; }
     STEP int entry(int x) { return x > 0 ? back(x) * 2 : fill(x); }" "$cxx"
  refused 'call through a pointer' "int entry(int (*f)(int)) { return f(1) + 1; }" "$cxx"
  refused 'stack is unknown' "int other(int); int entry(int x) { return other(x) + 1; }" "$cxx"
  refused 'unknown size' \
    'void use(char*); int entry(unsigned n) { char* p = (char*)__builtin_alloca(n); p[n / 2] = 1;
     volatile char* q = p; return q[n / 3]; }' "$cxx"
  echo "caught depth, recursion, pointers, unknown functions and frames of unknown size"
}

if [ "$1" = --self-test ]; then
  self_test "$2"
else
  [ -n "$(find "$1" -name '*.ci' -print -quit)" ] || {
    echo "no .ci file below $1: nothing was checked"
    exit 1
  }
  analyse "$1" "$2" "$TASKS" "$OTHERS"
fi
