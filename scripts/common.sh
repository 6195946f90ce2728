# shellcheck shell=bash
# What the scripts share: told steps, plain failures, the repository as working directory.
# Sourced, not run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

step_names=()
step_seconds=()

# fail MESSAGE...: says what went wrong and stops.
fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# step NAME COMMAND...: runs the command, and says what it is for and how long it took.
step() {
  local name=$1 start=$SECONDS
  shift
  printf '==> %s\n' "$name"
  "$@" || fail "\"$name\" failed: $*"
  step_names+=("$name")
  step_seconds+=($((SECONDS - start)))
  printf '    done in %d s\n' $((SECONDS - start))
}

# The steps so far and their times.
print_steps() {
  local i
  printf '\n'
  for i in "${!step_names[@]}"; do
    printf '%7d s  %s\n' "${step_seconds[i]}" "${step_names[i]}"
  done
  printf '%7d s  so far\n\n' "$SECONDS"
}

# Compilers to run at once: one a core, but no more than memory holds at 1.5 GB each.
build_jobs() {
  local available_kb jobs
  available_kb=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)
  jobs=$((available_kb / 1500000))
  ((jobs < $(nproc))) || jobs=$(nproc)
  echo $((jobs < 1 ? 1 : jobs))
}
