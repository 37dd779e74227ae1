#!/bin/bash
# Installs what the tests need, builds, and runs the tests.
#
#   tests/run.sh                the parts that a change is tried with, less than 20 minutes on two cores
#   tests/run.sh --changed      the parts and test programs that depend on what changed since the last whole run, as continuous
#                               integration runs them; --changed REV: since this commit
#   tests/run.sh --all          every part but those that run by name only. Where all passed and nothing was left to commit,
#                               tests/whole-run.txt then names the commit
#   tests/run.sh unit api       only these parts, in the order below
#   tests/run.sh --list         the parts and what each does
#   tests/run.sh --all --minutes    writes how long each part took into CONTRIBUTING.md
#
# Ends with status 0 only if every part passed. Environment: SUPPLE_JOBS (number of cores), SUPPLE_FUZZ_SECONDS (60, over
# all targets), SUPPLE_TRUTH_CASES (1000, for each wing of tests/truth), SUPPLE_SKIP_PACKAGES=1 (leave apt alone).
set -uo pipefail
cd "$(dirname "$0")/.." || exit

jobs=${SUPPLE_JOBS:-$(nproc)}
fuzz_seconds=${SUPPLE_FUZZ_SECONDS:-60}
truth_cases=${SUPPLE_TRUTH_CASES:-1000}
python=/usr/bin/python3

declare -A about=(
  [changes]="the table of what --changed runs, against this tree, and that tests/truth can fail"
  [arrows]="includes run only along the house plan's arrows, and no class or function is too long (by reading every file)"
  [format]="clang-format has nothing to change"
  [single_files]="each source file compiles by itself and without a warning (missing includes, names that hide others)"
  [build]="the optimized build"
  [unit]="unit tests, optimized"
  [stability]="the named hard cases"
  [python]="the Python package: mypy --strict and its own tests"
  [api]="black box over HTTP: contract, examples, jobs, faults, restart, kill -9, clients"
  [docs]="the pages: links, spelling, and every block of code that can run, against a real server; the engine's reference"
  [deploy]="the image's recipe, compose, the systemd unit and the manifests for Kubernetes, without building or starting them"
  [image]="the image from Debian's packages, and the API tests against the server in it (root, buildah, debootstrap)"
  [packages]="the packages for Debian: what is in them, and that it works from there (npm, cpack)"
  [reproducible]="two builds of the packages from nothing, which have the same bytes"
  [hostile]="hostile requests: deadlines, hang-ups, budgets"
  [bench]="the benchmarks' short runs: that they work, not what they measure"
  [web]="the web editor: layout of its sources, linter, types, unit tests, build"
  [browser]="the web editor in headless Chromium against a real server"
  [tidy]="clang-tidy, beside the parts from api on"
  [asan]="unit tests under the address and undefined-behaviour sanitizers"
  [hostile_asan]="hostile requests to a server under the address and undefined-behaviour sanitizers"
  [pace]="API tests, hostile ones and extreme numbers, to a server that reports work without a look at its token"
  [tsan]="unit tests of rooms with threads under the thread sanitizer"
  [fuzz]="each fuzz target for its share of SUPPLE_FUZZ_SECONDS"
  [truth]="faults that are planted are found; random cases of every wing against independent oracles, over HTTP"
)
order=(changes arrows format single_files build unit stability python api docs deploy hostile web browser bench tidy asan hostile_asan pace tsan fuzz image packages reproducible truth)
usual=(changes arrows format build unit stability python api docs deploy web)
# Up to half an hour each: before a release, and after a change to what takes requests apart, to deploy/ or to what is installed.
by_name_only=(single_files hostile_asan pace image packages reproducible truth)

# Of --changed: what a part has to run, where that is not all of it.
declare -A only

# What one part has configured or installed, others of the same run use.
declare -A done_already
# From nothing, many of a room's files are compiled at a time, so that their headers are read once; a build that is there stays
# as it was configured. CI stops at warnings, which is for those who write the code and not for those who build it.
configure_preset() {
  [ -z "${done_already[$1]:-}" ] || return 0
  local options=()
  [ -f "build/$1/CMakeCache.txt" ] || options=(-DSUPPLE_GROUPED=ON)
  [ -z "${CI:-}" ] || options+=(-DSUPPLE_WARNINGS_AS_ERRORS=ON)
  cmake --preset "$1" "${options[@]}" >"build/configure-$1.log" 2>&1 || { tail -30 "build/configure-$1.log"; return 1; }
  done_already[$1]=1
}
build_preset() { configure_preset "$1" && cmake --build "build/$1" -j "$jobs" "${@:2}"; }

cpp_files() { git ls-files -- 'engine/*.h' 'engine/*.cpp' 'server/*.h' 'server/*.cpp' 'clients/cli/*.h' 'clients/cli/*.cpp' \
  'tests/*.h' 'tests/*.cpp'; }

part_changes() { "$python" -m pytest -q -p no:cacheprovider tests/changes tests/truth/test_truth.py; }
part_arrows() {
  local check status=0
  for check in includes sizes words; do "$python" "tests/arrows/check_$check.py" || status=1; done
  return $status
}
part_format() { cpp_files | xargs -r clang-format --dry-run --Werror; }
part_single_files() {
  cmake --preset release -B build/single-files -DSUPPLE_BUILD_BENCH=ON -DSUPPLE_WARNINGS_AS_ERRORS=ON >build/configure-single-files.log 2>&1 ||
    { tail -30 build/configure-single-files.log; return 1; }
  "$python" tests/single_files.py build/single-files/compile_commands.json "$jobs"
}
part_build() { build_preset release; }
# The test programs of a part, or the target of them all. The tests of arrows call the compiler, and have no program.
programs_of() { if [ -n "${only[$1]:-}" ]; then tr ' ' '\n' <<<"${only[$1]}" | grep -vx arrows; else printf '%s\n' "${@:2}"; fi; }
build_programs() {  # PART PRESET [TARGET OF ALL ...]
  local programs
  mapfile -t programs < <(programs_of "$1" "${@:3}")
  if [ -n "${only[$1]:-}" ] && [ "${#programs[@]}" = 0 ]; then configure_preset "$2"; else build_preset "$2" ${programs:+--target "${programs[@]}"}; fi
}
# Reaching none of the tests of a label is a failure: a suite must not vanish unnoticed.
run_programs() {  # PART PRESET LABEL
  local chosen=()
  [ -z "${only[$1]:-}" ] || chosen=(-R "^($(sed -E 's/\<example_/examples\\./g; s/ /|/g' <<<"${only[$1]}"))(\\.|\$)")
  local status=0
  rm -rf "build/$2/test-times"
  ctest --test-dir "build/$2" -j "$jobs" -L "$3" "${chosen[@]}" --output-on-failure --no-tests=error || status=1
  "$python" tests/slowest.py "build/$2/test-times"
  return $status
}
part_unit() { build_programs unit release && run_programs unit release unit; }
part_stability() { build_programs stability release && run_programs stability release stability; }
# The files of tests of a part: all in its folder, or those chosen.
run_python() {  # PART [options of pytest]
  local files=("tests/$1")
  if [ -n "${only[$1]:-}" ]; then mapfile -t files < <(tr ' ' '\n' <<<"${only[$1]}" | sed "s#^#tests/$1/#"); fi
  "$python" -m pytest -q -p no:cacheprovider "${@:2}" "${files[@]}"
}
part_python() { (cd clients/python && mypy --strict supple examples) && PYTHONPATH=clients/python "$python" -m pytest -q -p no:cacheprovider clients/python/tests; }
part_api() { build_preset release --target supple supple-server make_test_model && run_python api -n "$jobs" --dist loadfile; }
# The reference of the engine, the links and words of all pages, and of the pages that are chosen the blocks that run.
part_docs() {
  local pages=${only[docs]:-} blocks=()
  doxygen docs/Doxyfile || return 1
  if [ "$pages" = - ]; then
    "$python" -m pytest -q -p no:cacheprovider tests/docs/test_links.py tests/docs/test_spelling.py tests/docs/test_reference.py
    return
  fi
  [ -z "$pages" ] || blocks=(-k "not (test_shell_blocks_run or test_python_blocks_run) or ${pages// / or }")
  build_preset release --target supple supple-server engine_examples && "$python" -m pytest -q -p no:cacheprovider -n "$jobs" tests/docs "${blocks[@]}"
}
part_deploy() {
  if [ "${only[deploy]:-}" != test_service_files.py ]; then
    build_preset release --target supple-server && install_modules tests/deploy || return 1
  fi
  run_python deploy
}
part_image() { build_preset release --target supple make_test_model && deploy/build_image.sh --test; }
part_packages() { deploy/build_packages.sh && "$python" -m pytest -q -p no:cacheprovider tests/release; }
part_reproducible() { tests/release/reproducible.sh; }
# That the wings find faults which are planted comes first: figures of wings that find nothing say nothing.
part_truth() {
  build_preset release --target supple-server && "$python" -m pytest -q -p no:cacheprovider tests/truth/test_planted_faults.py &&
    "$python" tests/truth/run.py --cases "$truth_cases"
}
part_hostile() { build_preset release --target supple-server make_test_model && run_python hostile -n "$jobs" --dist loadfile; }
signal_background() { [ -z "$tidy_process" ] || kill "-$1" -- "-$tidy_process" 2>/dev/null || true; }
# The benchmarks join the optimized build, so that its rooms are not compiled twice.
part_bench() { configure_preset release && cmake --preset release -DSUPPLE_BUILD_BENCH=ON >build/configure-bench.log 2>&1 &&
  build_programs bench release && run_programs bench release bench; }
install_modules() { (cd "$1" && npm ci >"$OLDPWD/build/npm-$(basename "$1").log" 2>&1) || { tail -20 "build/npm-$(basename "$1").log"; return 1; }; }
build_web() {
  [ -z "${done_already[web]:-}" ] || return 0
  install_modules clients/web && (cd clients/web && npm run build) && done_already[web]=1
}
part_web() { build_web && (cd clients/web && npm run lint && npm test); }
part_browser() {
  build_preset release --target supple-server && build_web && install_modules tests/browser || return 1
  # shellcheck disable=SC2086  # names of files
  node tests/browser/all.mjs ${only[browser]:-}
}
# What only computes begins with the parts that mostly wait for servers and browsers, and takes what they leave of the cores:
# clang-tidy, and then the builds of the sanitizers that are asked for.
begin_tidy() {
  configure_preset release && configure_preset asan-ubsan || return 1
  local builds=()
  if [[ " ${wanted[*]} " == *" asan "* ]]; then builds+=("asan-ubsan --target ${only[asan]:-unit_tests}"); fi
  if [[ " ${wanted[*]} " == *" tsan "* ]]; then configure_preset tsan && builds+=("tsan --target ${only[tsan]:-threaded_tests}") || return 1; fi
  # In a process group of its own, which ends with this script.
  set -m
  nice -n 19 bash -c '/usr/bin/python3 tests/tidy.py "$0" $1 >build/tidy.log 2>&1 || status=1
    for build in "${@:2}"; do cmake --build build/$build -j "$0" || break; done >build/sanitizers.log 2>&1
    exit ${status:-0}' "$jobs" "${only[tidy]:-}" "${builds[@]}" &
  set +m
  tidy_process=$!
  trap 'signal_background TERM; signal_background CONT' EXIT
}
part_tidy() {
  [ -n "$tidy_process" ] || begin_tidy || return 1
  local status=0
  wait "$tidy_process" || status=1
  cat build/tidy.log
  return $status
}
# These tests run lines that others run too, but so often that a sanitizer takes a quarter of a minute to nine minutes for each. The
# optimized build runs them.
much_repeated=ContactBarrier.HasTheDerivativesOfItsEnergyAtTangledStates:CellMoments.AreTheIntegralsOfTheSquaredDistance
much_repeated+=:Hosts.AShellBulgesBetweenTheSpringsOfATightNetwork:Crossings.BeyondTheLimitAreRefusedByItsName
much_repeated+=:RodEnergies.HaveExactDerivativesInSpaceAtRandomAndExtremeStates:Shell.HasTheDerivativesOfItsEnergy
much_repeated+=:StraightRegions.AgreeWithManySmallTrianglesForRandomImages:CellMoments.HaveTheirDerivativesOnCoarseMeshes
much_repeated+=:DiscretizationError.OfTheDefaultIsBelowHalfAPerCentAndBelowItsEstimate:Simulator.TangentsOfSoftCellsAreDerivativesOfTheStressToo
much_repeated+=:MovingDiagram.TakesMemoryForTheMeshAndForWhatIsCutHoweverManySitesThereAre
much_repeated+=:Homogenize.TakesTheLowerSideOfARidgeWhateverTheSegmentsAndTheLoadSteps
# Derivatives by differences, and distances beside those of other programs: these run in one thread, or in the same parallel
# loops again and again that other tests of their rooms run.
without_races='*Derivatives*:*HasItsGradient:*GeodesicOracle*:CellMoments*'
part_asan() { build_programs asan asan-ubsan unit_tests && UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS="suppressions=$PWD/tests/lsan.supp" \
  GTEST_FILTER="-$much_repeated" run_programs asan asan-ubsan unit; }
# Without the tests of memory: what sanitizers take for themselves is counted with it. A finding ends the server, and the
# test that it ends in fails.
part_hostile_asan() {
  build_preset asan-ubsan --target supple-server supple-helper make_test_model || return 1
  SUPPLE_BUILD="$PWD/build/asan-ubsan" SUPPLE_TEST_SLOWNESS=40 SUPPLE_TEST_SANITIZED=1 ASAN_OPTIONS=allocator_may_return_null=1 \
    UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS="suppressions=$PWD/tests/lsan.supp" \
    "$python" -m pytest -q -p no:cacheprovider tests/hostile --ignore=tests/hostile/test_memory.py
}
# A report is a finding, in which the test of a server ends. Half a second: what takes 50 ms on an idle machine takes several times
# as long where other tests run beside it.
part_pace() {
  build_preset pace --target supple supple-server supple-helper make_test_model || return 1
  local -x SUPPLE_BUILD="$PWD/build/pace" SUPPLE_PACE_SECONDS=${SUPPLE_PACE_SECONDS:-0.5}
  "$python" -m pytest -q -p no:cacheprovider tests/api &&
    "$python" -m pytest -q -p no:cacheprovider tests/hostile --ignore=tests/hostile/test_memory.py &&
    "$python" tests/hostile/extremes.py --requests "${SUPPLE_PACE_REQUESTS:-5000}"
}
# One OpenMP thread: CHOLMOD's OpenMP runtime is not instrumented, so that its own ordering looks like races.
part_tsan() { build_programs tsan tsan threaded_tests && OMP_THREAD_LIMIT=1 TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp second_deadlock_stack=1" \
  GTEST_FILTER="-$much_repeated:$without_races" run_programs tsan tsan threads; }
part_fuzz() {
  build_programs fuzz asan-ubsan fuzz_targets || return 1
  local targets share
  mapfile -t targets < <(find build/asan-ubsan/tests/fuzz -maxdepth 1 -type f -executable -name 'fuzz_*' | sort)
  if [ -n "${only[fuzz]:-}" ]; then mapfile -t targets < <(printf 'build/asan-ubsan/tests/fuzz/%s\n' ${only[fuzz]}); fi
  [ "${#targets[@]}" -gt 0 ] || { echo "no fuzz target was built"; return 1; }
  share=$(( (fuzz_seconds + ${#targets[@]} - 1) / ${#targets[@]} ))
  printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash tests/fuzz/run_target.sh {} "$share"
}

install_packages() {
  local wanted missing
  wanted=$(sed 's/#.*//' deploy/packages.txt tests/packages.txt)
  # Node.js from elsewhere than Debian brings its own npm, with which Debian's does not get along.
  if command -v npm >/dev/null; then wanted=$(grep -vxE 'nodejs|npm' <<<"$wanted"); fi
  missing=$(for p in $wanted; do dpkg-query -W -f '${Status}' "$p" 2>/dev/null | grep -q 'ok installed' || echo "$p"; done | paste -sd " ")
  [ -n "$missing" ] || return 0
  [ "$(id -u)" = 0 ] || { echo "tests/run.sh: these packages are missing and only root can install them: $missing" >&2; return 1; }
  export DEBIAN_FRONTEND=noninteractive
  # shellcheck disable=SC2086  # a list of names
  apt-get update -q && apt-get install -y -q --no-install-recommends $missing
}

in_minutes() { printf '%d.%d' $(($1 / 60)) $(($1 % 60 / 6)); }  # seconds, rounded down

# Puts a table of this run into CONTRIBUTING.md, between its two marks.
write_minutes() {
  local table
  table=$(
    printf 'Measured by `tests/run.sh %s--minutes` on %s cores' "$asked" "$jobs"
    [ -n "$from_nothing" ] && printf ', starting without any build'
    printf ':\n\n| Part | Minutes | What it does |\n|---|--:|---|\n'
    for row in "${minutes[@]}"; do printf '%s\n' "$row"; done
    printf '| all | %s | |\n' "$(in_minutes "$SECONDS")"
  )
  TABLE=$table "$python" - <<'PYTHON'
import os, pathlib, re
page = pathlib.Path("CONTRIBUTING.md")
text, found = re.subn(r"(<!-- minutes -->\n).*?(<!-- /minutes -->)",
                      lambda marks: marks[1] + os.environ["TABLE"] + "\n" + marks[2], page.read_text(), flags=re.S)
if found != 1:
    raise SystemExit("CONTRIBUTING.md has no place for the table of minutes")
page.write_text(text)
PYTHON
}

is_part() { [[ " ${order[*]} " == *" $1 "* ]]; }
want_all() { for part in "${order[@]}"; do [[ " ${by_name_only[*]} " == *" $part "* ]] || wanted+=("$part"); done; }
# The parts that depend on what changed, and of each what has to run.
want_changed() {  # [REV]
  local plan part chosen
  plan=$("$python" tests/changes/plan.py "$@") || exit 2
  sed 's/^/  run: /' <<<"$plan"
  while read -r part chosen; do
    # A part that is also asked for by name runs whole.
    [[ -z $chosen || " ${wanted[*]} " == *" $part "* ]] || only[$part]=$chosen
    wanted+=("$part")
  done <<<"$plan"
}

# The commit, if there is nothing that it does not contain.
commit_if_clean() { [ -z "$(git status --porcelain)" ] && git rev-parse HEAD; }

asked=""
keep_minutes=""
wanted=()
while [ $# -gt 0 ]; do
  case "$1" in
    --list)
      for part in "${order[@]}"; do
        [[ " ${usual[*]} " == *" $part "* ]] && mark="" || mark=" (with --all or by name)"
        printf '%-13s %s%s\n' "$part" "${about[$part]}" "$mark"
      done
      exit 0 ;;
    -h | --help) sed -n '2,14s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --all) want_all; asked+="--all " ;;
    --changed)
      changed_since=()
      if [ $# -gt 1 ] && [[ $2 != --* ]] && ! is_part "$2"; then shift; changed_since=("$1"); fi
      asked+="--changed ${changed_since[*]:+$1 }" ;;
    --minutes) keep_minutes=1 ;;
    *)
      is_part "$1" || { echo "tests/run.sh: no part '$1'; the parts are: ${order[*]}" >&2; exit 2; }
      wanted+=("$1"); asked+="$1 " ;;
  esac
  shift
done
[ -n "$asked" ] || wanted=("${usual[@]}")
from_nothing=1
[ -d build ] && from_nothing=""

mkdir -p build
begun_at=$(commit_if_clean)
if [ -z "${SUPPLE_SKIP_PACKAGES:-}" ]; then
  install_packages >build/packages.log 2>&1 || { tail -20 build/packages.log >&2; exit 1; }
fi

if [[ $asked == *--changed* ]]; then
  printf '=== what changed, and what that makes necessary\n'
  want_changed "${changed_since[@]}"
fi

summary=()
minutes=()
status=0
tidy_process=""
if [ "$SECONDS" -gt 5 ]; then minutes+=("| packages | $(in_minutes "$SECONDS") | installs what is missing |"); fi
for part in "${order[@]}"; do
  [[ " ${wanted[*]} " == *" $part "* ]] || continue
  printf '\n=== %s: %s\n' "$part" "${about[$part]}"
  start=$SECONDS
  if [[ $part == api && " ${wanted[*]} " == *" tidy "* ]]; then begin_tidy; fi
  if "part_$part"; then outcome=passed; else outcome=FAILED; status=1; fi
  took=$((SECONDS - start))
  summary+=("$(printf '%-13s %-7s %5d s' "$part" "$outcome" "$took")")
  minutes+=("| $part | $(in_minutes "$took") | ${about[$part]} |")
done

printf '\n=== summary\n'
printf '%s\n' "${summary[@]}"
if [[ $asked == *"--all "* && $status == 0 && -n $begun_at && $begun_at == "$(commit_if_clean)" ]]; then
  echo "$begun_at" >tests/whole-run.txt
  echo "tests/whole-run.txt names this commit: ${begun_at:0:12}"
fi
if [ -n "$keep_minutes" ]; then write_minutes; fi
exit $status
