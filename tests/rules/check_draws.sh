#!/usr/bin/env bash
# Two draws from one generator in one argument list, or in one expression, come in an order the
# compiler chooses: g++ goes one way on x86-64 and the other on aarch64. Braces have an order.
#   check_draws.sh ROOT         fails and lists every such pair
#   check_draws.sh --self-test  proves that bad files are caught and good ones are not
set -euo pipefail
export LC_ALL=C

# Follows brackets and statements. A generator is a variable of type Random, or a lambda that draws.
readonly SCAN='
function drop(name) { for (name in generators) delete drawn[depth, name] }
function forget(name) { for (name in generators) delete held[depth, name] }
function draw(name) {
  held[depth, name] = 1
  if (++drawn[depth, name] == 2) print FILENAME ":" FNR ": two draws from " name " in one expression"
}
function open(bracket) {
  ++depth
  kind[depth] = bracket
  if (bracket == "(" && before ~ /^(if|while|for|switch)$/) kind[depth] = "condition"
  if (bracket == "[" && before !~ /[A-Za-z_0-9)\]]/) kind[depth] = "capture"
  is_block[depth] = 0
  lambda[depth] = ""
  drop()
  forget()
}
# What was drawn inside counts once outside, unless a statement has ended there.
function close_bracket(name, count, inside) {
  count = 0
  for (name in generators) if ((depth, name) in held) inside[++count] = name
  if (kind[depth] ~ /^(condition|capture)$/) count = 0
  if (is_block[depth--] && kind[depth] == "{" && lambda[depth] == "") {
    count = 0
    drop()
  }
  for (; count > 0; --count) draw(inside[count])
}
function end_statement(name) {
  if (lambda[depth] != "")
    for (name in generators) if ((depth, name) in drawn) alias[lambda[depth]] = name
  lambda[depth] = ""
  is_block[depth] = 1
  drop()
}
function take(token) {
  if (token ~ /^[({[]$/) {
    if (token == "[" && before == "=" && declared_by == "auto") lambda[depth] = assigned
    open(token)
  } else if (token ~ /^[])}]$/) close_bracket()
  else if (token == ";") end_statement()
  else if (token == "," && kind[depth] == "{" || token ~ /^(=|<<|&&|[|][|]|[?]|:)$/) drop()
  else if (token ~ /^[A-Za-z_]/ && (before == "Random" || before == "&" && earlier == "Random"))
    generators[token] = 1
  else if (token in generators) draw(token)
  else if (token in alias) draw(alias[token])
  if (token == "=") { assigned = before; declared_by = earlier }
  earlier = before
  before = token
}
FNR == 1 {
  split("", generators); split("", alias); split("", drawn); split("", held)
  generators["random"] = generators["random_"] = 1
  depth = 0; kind[0] = "{"; lambda[0] = before = earlier = ""
}
/^[ \t]*#/ { next }
{
  while (match($0, /[A-Za-z_][A-Za-z_0-9]*|[0-9][0-9A-Za-z_.\047]*|"([^"\\]|\\.)*"|\047([^\047\\]|\\.)*\047|\/\/.*|<<|==|<=|>=|!=|&&|[|][|]|::|[^ \t]/)) {
    token = substr($0, RSTART, RLENGTH)
    $0 = substr($0, RSTART + RLENGTH)
    if (token !~ /^\/\//) take(token)
  }
}'

violations() {
  find core hal sim_hal apps tests \( -name '*.h' -o -name '*.cc' \) -print0 | sort -z |
    xargs -0 awk "$SCAN"
}

self_test() {
  local dir found
  dir=$(mktemp -d)
  scratch=$dir
  trap 'rm -rf "$scratch"' EXIT
  cd "$dir"
  mkdir -p core hal sim_hal apps tests
  cat >tests/bad.cc <<'TEXT'
void f(Random& random, Random& other) {
  g(random.uniform(), random.uniform());
  const Vector3 a(random.uniform(-1, 1), 0,
                  random.uniform(-1, 1));
  g(vector(other), 1, vector(other));
  g(Vector3{other.normal(), 0, 0}, other.normal());
  const double b = random.normal() - random.normal();
  const auto draw = [&other] { return other.uniform(-1, 1); };
  g(draw(), draw());
  if (h(random.below(3), random.below(2))) g(1, 2);
}
TEXT
  cat >tests/good.cc <<'TEXT'
#include "random.h"  // g(random.uniform(), random.uniform());
void f(Random& random, Random& other) {
  const Vector3 a{random.uniform(), random.uniform(), random.uniform()};
  g(Vector3{random.uniform(), random.uniform(), 0}, "random random");
  if (random.below(40) != 0) g(1, random.uniform());
  for (int i = 0; i < 3; ++i) { g(random.normal()); }
  for (int i = 0; i < 3; ++i) { g(random.normal()); }
  const auto draw = [&other](double x) { return other.uniform(-x, x); };
  const Vector3 b{draw(1), draw(1), draw(1)};
  g(random.normal(), other.normal());
  values[random.below(3)] = random.normal();
}
TEXT
  found=$(violations | sort -V)
  diff <(printf 'tests/bad.cc:%s: two draws from %s in one expression\n' 2 random 4 random \
    5 other 6 other 7 random 9 other 10 random) <(echo "$found") && echo "caught all seven"
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
  echo "draws are in order"
fi
