#!/bin/bash
# A PostgreSQL server for tests. It listens only on a socket in its own folder, and does not wait for the disk unless
# PRIVATE_POSTGRES_OPTIONS says so.
#
#   tests/support/private_postgres.sh start FOLDER     creates FOLDER, prints the connection string
#   tests/support/private_postgres.sh kill FOLDER      ends it as a power failure would
#   tests/support/private_postgres.sh again FOLDER     starts it again with the same data
#   tests/support/private_postgres.sh freeze FOLDER    suspends its processes, whose connections stay open
#   tests/support/private_postgres.sh thaw FOLDER      resumes them
#   tests/support/private_postgres.sh stop FOLDER      ends it
set -euo pipefail
action=$1
folder=$2
programs=/usr/lib/postgresql/15/bin

# PostgreSQL refuses to run as root.
as_its_user() {
  if [ "$(id -u)" = 0 ]; then setpriv --reuid=postgres --regid=postgres --clear-groups "$@"; else "$@"; fi
}

start_it() {
  cd /  # a folder that its user may enter
  as_its_user "$programs/pg_ctl" --pgdata="$folder/data" --log="$folder/log" --wait --silent start \
    --options="-c listen_addresses= -c unix_socket_directories=$folder -c fsync=off -c max_connections=60 -c shared_buffers=16MB ${PRIVATE_POSTGRES_OPTIONS:-}"
}

case $action in
  start)
    mkdir -p "$folder"
    folder=$(realpath "$folder")
    [ "$(id -u)" != 0 ] || chown postgres "$folder"
    cd /
    as_its_user "$programs/initdb" --pgdata="$folder/data" --username=supple --auth=trust --no-sync --no-locale \
      --encoding=UTF8 >/dev/null
    start_it
    echo "host=$folder user=supple dbname=postgres"
    ;;
  again) folder=$(realpath "$folder"); start_it ;;
  kill)
    main=$(head -1 "$folder/data/postmaster.pid")
    kill -STOP "$main"  # so that it starts no other process meanwhile
    mapfile -t all < <(pgrep --parent "$main")
    kill -9 "$main" "${all[@]}" 2>/dev/null || true
    while kill -0 "$main" "${all[@]}" 2>/dev/null; do sleep 0.02; done
    ;;
  freeze | thaw)
    main=$(head -1 "$folder/data/postmaster.pid")
    [ "$action" = freeze ] && signal=STOP || signal=CONT
    kill -STOP "$main"  # so that it starts no other process meanwhile
    mapfile -t all < <(pgrep --parent "$main")
    kill -"$signal" "$main" "${all[@]}"
    ;;
  stop)
    folder=$(realpath "$folder")
    cd /
    as_its_user "$programs/pg_ctl" --pgdata="$folder/data" --mode=immediate --silent stop
    ;;
  *) echo "unknown action $action" >&2; exit 2 ;;
esac
