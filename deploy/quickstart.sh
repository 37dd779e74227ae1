#!/bin/bash
# From a bare Debian 12 with git and root to a running server and its first answers.
#
#   deploy/quickstart.sh           installs packages, builds, starts the server with its web editor, designs a structure
#                                  and proves it by simulation, runs a geodesic, a Karcher mean and an elastic network
#   deploy/quickstart.sh --stop    stops the server that it started (its meshes and finished jobs stay on disk)
#
# May be run again at any time: what is done already is not done twice.
# Environment: SUPPLE_PORT (8080), SUPPLE_HOST (127.0.0.1), SUPPLE_DATA (data/ in the checkout), SUPPLE_MODELS (models/
# in the checkout), SUPPLE_BUILD (build/release).
set -euo pipefail
cd "$(dirname "$0")/.."

host=${SUPPLE_HOST:-127.0.0.1}
port=${SUPPLE_PORT:-8080}
data=$(realpath -m "${SUPPLE_DATA:-data}")
models=$(realpath -m "${SUPPLE_MODELS:-models}")
build=${SUPPLE_BUILD:-build/release}
pid_file=$data/supple-server.pid
log_file=$data/supple-server.log
url=http://$host:$port

if [ -t 1 ]; then bold=$(printf '\033[1m') plain=$(printf '\033[0m'); else bold='' plain=''; fi
say() { printf '\n%s%s%s\n' "$bold" "$*" "$plain"; }
fail() { printf 'quickstart: %s\n' "$*" >&2; exit 1; }

# The process id of the server that this script started and that still runs, or nothing. A recycled id is no server.
running_pid() {
  local pid
  pid=$(cat "$pid_file" 2>/dev/null) || return 0
  if [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = supple-server ]; then echo "$pid"; fi
}

stop_server() {
  local pid
  pid=$(running_pid)
  if [ -z "$pid" ]; then echo "No server of this checkout is running."; rm -f "$pid_file"; return 0; fi
  kill -TERM "$pid"
  for _ in $(seq 150); do
    [ -n "$(running_pid)" ] || { rm -f "$pid_file"; echo "Stopped. Meshes and finished jobs stay in $data."; return 0; }
    sleep 0.2
  done
  fail "server $pid did not stop within 30 s of SIGTERM; see $log_file"
}

install_packages() {
  local wanted missing
  wanted=$(sed 's/#.*//' deploy/packages.txt)
  # Node.js from elsewhere than Debian brings its own npm, with which Debian's does not get along.
  if command -v npm >/dev/null; then wanted=$(grep -vxE 'nodejs|npm' <<<"$wanted"); fi
  missing=$(for p in $wanted; do dpkg-query -W -f '${Status}' "$p" 2>/dev/null | grep -q 'ok installed' || echo "$p"; done | paste -sd " ")
  [ -n "$missing" ] || { echo "All packages are installed."; return 0; }
  [ "$(id -u)" = 0 ] || fail "these packages are missing and only root can install them: $missing"
  command -v apt-get >/dev/null || fail "apt-get is missing: this script is for Debian 12; the packages are listed in deploy/packages.txt"
  export DEBIAN_FRONTEND=noninteractive
  echo "Installing $missing"
  # shellcheck disable=SC2086  # a list of names
  { apt-get update -q && apt-get install -y -q --no-install-recommends $missing; } >"$data/packages.log" 2>&1 ||
    { tail -20 "$data/packages.log" >&2; fail "apt-get could not install the packages; the log is $data/packages.log"; }
}

build_server() {
  local first=()
  # A first build has no tests, and compiles many of a room's files at a time, so that their headers are read once. One that
  # is there stays as it was configured.
  [ -f "$build/CMakeCache.txt" ] || first=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DSUPPLE_BUILD_TESTS=OFF -DSUPPLE_TRAINING=OFF
    -DSUPPLE_GROUPED=ON)
  cmake -S . -B "$build" "${first[@]}" >"$data/configure.log" 2>&1 ||
    { tail -20 "$data/configure.log" >&2; fail "cmake could not configure the build; the log is $data/configure.log"; }
  cmake --build "$build" --target supple supple-server supple-helper
}

# The web editor, from its sources and the npm registry. Without it the server still answers requests.
build_editor() {
  if (cd clients/web && npm ci && npm run build) >"$data/editor.log" 2>&1; then
    echo "The web editor is in clients/web/dist."
  else
    tail -5 "$data/editor.log" >&2
    echo "quickstart: the web editor could not be built and is left out; the log is $data/editor.log" >&2
  fi
}

# Whether something accepts connections on the port.
port_open() { (exec 3<>"/dev/tcp/$host/$port") 2>/dev/null; }

start_server() {
  local pid
  pid=$(running_pid)
  if [ -n "$pid" ]; then
    curl -fsS -o /dev/null "$url/readyz" 2>/dev/null ||
      fail "server $pid of this checkout runs but does not answer on $url: deploy/quickstart.sh --stop ends it"
    echo "The server already runs (process $pid)."
    return 0
  fi
  if port_open; then
    fail "port $port on $host is taken by another program. Choose another: SUPPLE_PORT=$((port + 1)) deploy/quickstart.sh"
  fi
  local web=()
  if [ -f clients/web/dist/index.html ]; then web=(--web clients/web/dist); fi
  nohup "$build/server/supple-server" --host "$host" --port "$port" --data "$data" --models "$models" "${web[@]}" >>"$log_file" 2>&1 </dev/null &
  pid=$!
  echo "$pid" >"$pid_file"
  for _ in $(seq 100); do
    curl -fsS -o /dev/null "$url/readyz" 2>/dev/null && { echo "The server is ready (process $pid)."; return 0; }
    kill -0 "$pid" 2>/dev/null || { tail -20 "$log_file" >&2; rm -f "$pid_file"; fail "the server ended; its log is $log_file"; }
    sleep 0.1
  done
  tail -20 "$log_file" >&2
  fail "the server did not become ready within 10 s; its log is $log_file"
}

# Shows a command as a user would type it, then runs it.
show() { printf '\n$ %s\n' "supple ${*}"; "$build/clients/cli/supple" --server "$url" "$@"; }

case "${1:-}" in
  --stop) stop_server; exit 0 ;;
  -h | --help) sed -n '2,11s/^# \{0,1\}//p' "$0"; exit 0 ;;
  "") ;;
  *) fail "unknown argument '$1'; try --help" ;;
esac

mkdir -p "$data"
say "1/4  Packages"
install_packages
say "2/4  Build (a few minutes the first time)"
build_server
build_editor
say "3/4  Server"
start_server
say "4/4  First answers, over HTTP"
echo "A structure that softens as it is stretched, and a simulation of it:"
show design --task stress_strain --target "0,0;0.1,0.42;0.2,0.66" --verify --plot "$data/design.svg" --svg "$data/structure.svg"
sample=api/examples/meshes/trefoil-knot.obj
show mesh add "$sample"
show geodesic "$sample" v0 v700 --path "$data/geodesic.obj"
show karcher "$sample" v0 v150 v300 v450 v600 --history
show field "$sample" v0 --output "$data/distances.ply"
show relax "$sample" --poisson-disk 0.6 --voronoi-dual --rest-length 0.5 --obj "$data/network.obj"

cat <<END

The server keeps running at $url: open it in a browser for the editor.
  supple:     $build/clients/cli/supple --help
  pictures:   $data/design.svg and $data/structure.svg open in a browser,
              $data/geodesic.obj, $data/distances.ply and $data/network.obj open in MeshLab or Blender
  contract:   curl $url/openapi.yaml
  log:        $log_file
  stop it:    deploy/quickstart.sh --stop
END
