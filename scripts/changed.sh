# shellcheck shell=bash
# Which lines of C++ changed, for scripts/lint. Sourced, not run.

# The commit that changes are counted from; a shallow clone fetches it.
default_base() {
  local base upstream
  upstream=$(git rev-parse --verify --quiet '@{upstream}' 2>/dev/null ||
    git rev-parse --verify --quiet origin/HEAD || git rev-parse HEAD)
  base=$(git merge-base HEAD "$upstream" || true)
  if [[ -z $base || $base == "$(git rev-parse HEAD)" ]]; then
    git rev-parse --verify --quiet 'HEAD^1' >/dev/null ||
      [[ $(git rev-parse --is-shallow-repository) == false ]] || git fetch --quiet --deepen 1 || true
    base=$(git rev-parse --verify --quiet 'HEAD^1') || return
  fi
  echo "$base"
}

# "FILE FIRST LAST" of every run of lines that $1 has not, in sources and headers.
changed_lines() {
  local file
  git diff --unified=0 --find-renames --diff-filter=AMR "$1" -- '*.cpp' '*.h' | awk '
    /^\+\+\+ b\// { file = substr($0, 7) }
    /^@@ / {
      lines = split(substr($3, 2), run, ",") > 1 ? run[2] : 1
      if (lines > 0) print file, run[1], run[1] + lines - 1
    }'
  git ls-files --others --exclude-standard -- '*.cpp' '*.h' | while read -r file; do
    echo "$file 1 $(wc -l <"$file")"
  done
}

# The lines on stdin as clang-tidy takes them: it keeps to itself what is wrong with others.
line_filter() {
  awk '{ runs[$1] = runs[$1] (runs[$1] ? "," : "") "[" $2 "," $3 "]" }
    END {
      for (file in runs) {
        printf "%s{\"name\":\"%s\",\"lines\":[%s]}", (some++ ? "," : "["), file, runs[file]
      }
      print "]"
    }'
}
