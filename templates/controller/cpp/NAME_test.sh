#!/bin/sh
# Runs @NAME@.yaml with the program, twice: ./@NAME@_test.sh build/@NAME@_controller. SANDLOT names the command where it is not in PATH.
set -eu
program=$(realpath "$1")
cd "$(dirname "$0")"
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

run() {
  "${SANDLOT:-sandlot}" run @NAME@.yaml --port 0 --rate max --summary "$folder/$1" >"$folder/out" 2>"$folder/log" &
  server=$!
  until grep -q '^page: ' "$folder/log"; do
    kill -0 $server 2>/dev/null || { cat "$folder/log"; exit 1; }
    sleep 0.05
  done
  SANDLOT_URL=$(sed -n 's|^page: http\(://[^/]*\).*|tcp\1|p' "$folder/log") "$program"
  wait $server
}

run first
run second
grep -q '"count": 1' "$folder/first" || { echo "it did not arrive"; exit 1; }
[ "$(grep '"state_hash"' "$folder/first")" = "$(grep '"state_hash"' "$folder/second")" ] || { echo "the runs differ"; exit 1; }
echo "it arrives, and does so again"
