#!/usr/bin/env bash
# The packages as users get them: unpacks what ./dev package left in build/packages into a temporary folder, looks at the content,
# runs the programs, compares their results with those of the build and fetches the page.
#   tools/package_test.sh [FOLDER OF THE PACKAGES [BUILT PROGRAM]]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
packages=$(realpath "${1:-build/packages}") built=$(realpath "${2:-build/release/sandlot}") source=$PWD
scratch=$(mktemp -d)
server=
trap '[[ -z $server ]] || kill "$server" 2>/dev/null || true; rm -rf "$scratch"' EXIT
say() { printf '   %s\n' "$*"; }
die() { printf 'package_test: %s\n' "$*" >&2; exit 1; }

# hash_of PROGRAM: the state after one simulated second of the yard, the program started elsewhere than in the source tree
hash_of() {
  (cd "$scratch" && "$1" demo yard --headless --duration 1s --json) |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["state_hash"])'
}

# is_elf FILE
is_elf() { [[ $(head -c 4 "$1" | tail -c 3) == ELF ]]; }

# check_content FOLDER: no path of the source tree, nothing unstripped, licences present
check_content() {
  local file found=0
  ! grep -rlF -e "$source" -e "$scratch" "$1" || die "$1 names a folder of the machine it was built on"
  while IFS= read -r file; do
    is_elf "$file" || continue
    found=$((found + 1))
    ! readelf -SW "$file" | grep -qE ' \.(symtab|debug_info) ' || die "$file is not stripped"
  done < <(find "$1" -type f \( -name '*.so*' -o -path '*/bin/*' \))
  ((found >= 2)) || die "$1 has $found programs and libraries"
  for file in three uplot libeigen3-dev; do
    [[ -n $(find "$1" -path "*/licences/$file.txt" -size +0) ]] || die "$1 lacks the licence of $file"
  done
  [[ -z $(find "$1" -xtype l) ]] || die "$1 has links to nowhere: $(find "$1" -xtype l)"
  say "content: $(find "$1" -type f | wc -l) files, $found programs and libraries, all stripped"
}

# check_path FILE TAG PATH: where the loader looks for the libraries of a file
check_path() {
  local found; found=$(readelf -dW "$1" | grep -E 'RPATH|RUNPATH' | sed -E 's/.*\((RPATH|RUNPATH)\).*\[(.*)\]/\1 \2/' || true)
  [[ $found == "${2:+$2 $3}" ]] || die "$1 has '$found' where '${2:+$2 $3}' was expected"
}

# check_program PROGRAM: the same results as the build, a healthy doctor, its own files, and the page
check_program() {
  local hash; hash=$(hash_of "$1")
  [[ $hash == "$expected" ]] || die "$1 gives $hash, the build $expected"
  say "state after 1 s: $hash, as the build"
  "$1" doctor >"$scratch/doctor" || die "doctor: $(cat "$scratch/doctor")"
  grep -q "^ok  *page  *built in" "$scratch/doctor" || die "there is no page: $(cat "$scratch/doctor")"
  grep -qF "$2/share/sandlot/" "$scratch/doctor" || die "uses files of somewhere else: $(cat "$scratch/doctor")"
  : >"$scratch/served"  # there before it is read, whichever of the two comes first
  (cd "$scratch" && exec "$1" demo yard --port 0 >>"$scratch/served" 2>&1) &
  server=$!
  local address=
  for _ in {1..600}; do
    address=$(sed -n 's/^page: *\(http[^ ]*\).*/\1/p' "$scratch/served")
    [[ -z $address ]] || break
    kill -0 "$server" 2>/dev/null || break
    sleep 0.1
  done
  [[ -n $address ]] || die "does not serve within a minute: $(cat "$scratch/served")"
  python3 - "$address" <<'PYTHON'
import re, sys, urllib.parse, urllib.request
def fetch(address):
    with urllib.request.urlopen(address, timeout=30) as answer:
        return answer.read().decode()
page = fetch(sys.argv[1])
files = re.findall(r'(?:src|href)="([^":]+\.(?:js|css))"', page)
assert len(files) >= 2, page
print("   page:", len(page), "bytes,", ", ".join(f"{each} {len(fetch(urllib.parse.urljoin(sys.argv[1], each)))}" for each in files))
PYTHON
  kill -INT "$server"
  wait "$server" || die "ends with exit code $? when interrupted: $(cat "$scratch/served")"
  server=
}

shopt -s nullglob
debs=("$packages"/sandlot_*.deb) archives=("$packages"/sandlot-*.tar.gz)
[[ ${#debs[@]} == 1 && ${#archives[@]} == 1 ]] || die "one .deb and one .tar.gz are expected in $packages; ./dev package makes them"
expected=$(hash_of "$built")

say "${debs[0]}"
dpkg-deb -x "${debs[0]}" "$scratch/deb"
check_content "$scratch/deb"
check_path "$scratch/deb/usr/bin/sandlot" RUNPATH '$ORIGIN/../lib'
check_path "$(echo "$scratch"/deb/usr/lib/libsandlot.so.*.*.*)" ''
depends=$(dpkg-deb -f "${debs[0]}" Depends)
for name in libc6 libode8 libembree libavcodec; do
  [[ $depends == *$name* ]] || die "the .deb does not depend on $name: $depends"
done
# Every library that is not in the package comes from a package that it depends on.
while read -r library; do
  package=$(dpkg-query -S "$library" 2>/dev/null || dpkg-query -S "${library#/usr}" 2>/dev/null ||
    dpkg-query -S "/usr$library") || die "$library is of no package"
  package=${package%%:*}
  # Under its own name, or one that it provides: libspdlog1.10 is asked for as libspdlog1.10-fmt9.
  names=$(dpkg-query -W -f '${Package}, ${Provides}' "$package" | sed -E 's/ *\([^)]*\)//g; s/, *$//; s/, */|/g; s/[.+]/\\&/g')
  [[ ", $depends," =~ ,\ ($names)[\ ,] ]] || die "the .deb does not depend on $package: $depends"
done < <(readelf -dW "$scratch"/deb/usr/lib/libsandlot.so.*.*.* | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -v ld-linux |
  while read -r name; do /sbin/ldconfig -p | awk -v name="$name" '$1 == name && /x86-64|aarch64/ {print $NF; exit}'; done)
check_program "$scratch/deb/usr/bin/sandlot" "$scratch/deb/usr"

say "${archives[0]}"
mkdir "$scratch/some folder"
tar -xzf "${archives[0]}" -C "$scratch/some folder"
prefix=$(echo "$scratch/some folder"/sandlot-*)
check_content "$prefix"
check_path "$prefix/bin/sandlot" RPATH '$ORIGIN/../lib:$ORIGIN/../lib/bundled'
check_path "$(echo "$prefix"/lib/libsandlot.so.*.*.*)" RPATH '$ORIGIN/bundled'
# Nothing but glibc and gcc's libraries from outside of the folder.
outside=$(ldd "$prefix/bin/sandlot" | sed -n 's/.* => \(.*\) (0x.*/\1/p' | grep -vF "$prefix/" |
  grep -vE '/(libc|libm|libdl|librt|libpthread|libresolv|libgcc_s|libstdc\+\+)\.so\.[0-9]+$' || true)
[[ -z $outside ]] || die "the .tar.gz takes libraries of the system: $outside"
! ldd "$prefix/bin/sandlot" | grep 'not found' || die "the .tar.gz lacks libraries"
check_program "$prefix/bin/sandlot" "$prefix"
echo "package_test: ok"
