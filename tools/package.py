#!/usr/bin/env python3
"""Packages of a finished release build: build/packages/sandlot_VERSION_amd64.deb and sandlot-VERSION-RELEASE-amd64.tar.gz.

The .deb depends on Debian's libraries. The .tar.gz carries them in lib/bundled, all but those of glibc and gcc, and runs
without root from any folder. Both hold what `cmake --install` leaves, stripped, with the licences of everything inside.
The same build and commit give the same bytes. docs/installing.md is the users' side of it; ./dev package calls this.
"""
import argparse
import gzip
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# One header of each library that is compiled into libsandlot; the licence of its Debian package goes with it.
COMPILED_IN = ["boost/version.hpp", "CLI/CLI.hpp", "eigen3/Eigen/Core", "Random123/philox.h", "nlohmann/json.hpp"]
# On every Debian, and bound to its kernel interface and compiler: never carried along.
OF_THE_SYSTEM = {"libc6", "libgcc-s1", "libstdc++6"}
# Libraries that others open by name at run time. For the .deb the packages of those others depend on them: libtbb12 on libtbbmalloc2.
OPENED_AT_RUN_TIME = ["libtbbmalloc.so.2"]
MAINTAINER = "Sandlot maintainers <maintainers@sandlot.invalid>"
SUMMARY = "simulator of mobile robots with real sensors and a web page"
DESCRIPTION = """\
 Runs many mobile robots with wheels, legs, arms, cameras, laser scanners and
 other sensors, shows them on a page in the browser, can be stepped from own
 code, and gives the same result twice. Reads SDF worlds and URDF robots and
 records MCAP files.
 .
 This package has the command, the library with its headers and CMake package
 for own controllers, and the models, worlds and scenarios."""


def fail(text):
    sys.exit(f"package: {text}")


def output(*command, **options):
    """Standard output of a command; a failing one ends the program, with what it said."""
    done = subprocess.run([str(each) for each in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)
    if done.returncode != 0:
        fail(f"{command[0]} failed with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def git(*arguments):
    done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


def project_version():
    return re.search(r"^project\(sandlot VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M)[1]


def package_version():
    """0.1.0 at tag v0.1.0, else 0.1.0+git<commits>.<hash>, with .dirty where files differ from the commit; outside git 0.1.0."""
    version = project_version()
    commit = git("rev-parse", "--short=8", "HEAD")
    if not commit:
        return version
    dirty = bool(git("status", "--porcelain", "--untracked-files=no"))
    if git("describe", "--tags", "--exact-match", "HEAD") == f"v{version}" and not dirty:
        return version
    return f"{version}+git{git('rev-list', '--count', 'HEAD')}.{commit}" + (".dirty" if dirty else "")


def os_release():
    values = dict(line.split("=", 1) for line in pathlib.Path("/etc/os-release").read_text().splitlines() if "=" in line)
    return (values.get("ID", "linux") + values.get("VERSION_ID", "")).replace('"', "")


def package_of(file):
    """The installed Debian package that a file belongs to, without its architecture."""
    text = str(file)
    for candidate in (text, text.removeprefix("/usr"), "/usr" + text):
        done = subprocess.run(["dpkg-query", "-S", candidate], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.split(":", 1)[0]
    fail(f"{file} belongs to no Debian package; packages are made on Debian")


def shared_libraries(file):
    """name -> path of all shared libraries that a file needs, directly or through others."""
    found = {}
    for line in output("ldd", file).splitlines():
        name, arrow, rest = line.strip().partition(" => ")
        if not arrow:
            continue
        if not rest.startswith("/"):
            fail(f"{file} needs {name}, which is not there")
        found[name] = rest.split(" ")[0]
    return found


# --- licences ----------------------------------------------------------------------------------------------------------

def copyright_of(package):
    file = pathlib.Path("/usr/share/doc") / package / "copyright"
    if not file.exists():
        fail(f"package {package} has no {file}")
    return file.read_text(errors="replace")


def npm_packages_in_page():
    """name -> version of what esbuild puts into the page, from the bundle's own list of its input files."""
    web = ROOT / "web"
    with tempfile.TemporaryDirectory() as scratch:
        output(web / "node_modules/.bin/esbuild", "src/main.ts", "src/style/style.css", "--bundle", "--format=esm", "--log-level=error",
               f"--outdir={scratch}/out", f"--metafile={scratch}/meta.json", cwd=web)
        inputs = json.loads(pathlib.Path(scratch, "meta.json").read_text())["inputs"]
    names = {match[1] for each in inputs if (match := re.search(r".*node_modules/((?:@[^/]+/)?[^/]+)/", each))}
    return {name: json.loads((web / "node_modules" / name / "package.json").read_text())["version"] for name in sorted(names)}


def add_licences(folder, carried):
    """Writes the licence texts into `folder`/licences. @param carried  Debian packages whose libraries are in the archive"""
    licences = folder / "licences"
    licences.mkdir(parents=True)
    lines = ["Sandlot is under the Apache License 2.0: the file LICENSE in share/sandlot.",
             "This package contains software by others. Their licences are in the files of this folder:", ""]
    for name, version in npm_packages_in_page().items():
        source = ROOT / "web/node_modules" / name
        texts = sorted(each for each in source.iterdir() if re.match(r"(licen[cs]e|copying)", each.name, re.I))
        if not texts:
            fail(f"{source} has no licence file")
        target = name.replace("@", "").replace("/", "-") + ".txt"
        (licences / target).write_text("\n".join(each.read_text() for each in texts))
        lines.append(f"{target}: {name} {version}, part of the page")
    for package in sorted(package_of(f"/usr/include/{header}") for header in COMPILED_IN):
        (licences / f"{package}.txt").write_text(copyright_of(package))
        lines.append(f"{package}.txt: headers compiled into libsandlot")
    for package in carried:
        (licences / f"{package}.txt").write_text(copyright_of(package))
        lines.append(f"{package}.txt: libraries in lib/bundled")
    if carried:
        # Debian's copyright files name the common texts by their path there; the archive has to have them itself.
        shutil.copytree("/usr/share/common-licenses", licences / "common-licenses", symlinks=False)
        lines.append("common-licenses: the texts that these files name as /usr/share/common-licenses")
    (licences / "README").write_text("\n".join(lines) + "\n")


# --- what both packages hold -------------------------------------------------------------------------------------------

def install(build, prefix):
    output("cmake", "--install", build, "--prefix", prefix, "--strip", env={**os.environ, "DESTDIR": ""})
    # Measures against other simulators, which it would bring along; only there when `./dev bench` has built it.
    (prefix / "bin/sandlot-bench").unlink(missing_ok=True)
    library = next((prefix / "lib").glob("libsandlot.so.*.*.*"))
    output("strip", "--strip-unneeded", "--remove-section=.comment", "--remove-section=.note.gnu.gold-version", library)
    doctor = json.loads(output(prefix / "bin/sandlot", "doctor", "--json"))
    if not any(each["name"] == "page" and each["detail"] == "built in" for each in doctor):
        fail("this build has no page; ./dev build installs what it needs")
    documents = prefix / "share/doc/sandlot"
    documents.mkdir(parents=True, exist_ok=True)
    (documents / "reference.md").write_text(output(prefix / "bin/sandlot", "list", "--markdown"))
    (documents / "scenario.schema.json").write_text(output(prefix / "bin/sandlot", "list", "--schema"))
    return library


def settle(folder, epoch):
    """Modes and times that depend on the commit alone."""
    for path in [folder, *folder.rglob("*")]:
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() or path.parent.name == "bin" else 0o644)
        os.utime(path, (epoch, epoch), follow_symlinks=False)


# --- the .deb ----------------------------------------------------------------------------------------------------------

def dependencies(stage, library):
    """What dpkg-shlibdeps computes from the binaries: packages with the versions whose symbols are used."""
    with tempfile.TemporaryDirectory() as scratch:
        debian = pathlib.Path(scratch, "debian")
        debian.mkdir()
        (debian / "control").write_text(f"Source: sandlot\nMaintainer: {MAINTAINER}\n\nPackage: sandlot\nArchitecture: any\n")
        text = output("dpkg-shlibdeps", "-O", f"-l{library.parent}", "--ignore-missing-info", "-xsandlot",
                      f"-e{library}", f"-e{stage}/usr/bin/sandlot", cwd=scratch)
    depends = re.search(r"^shlibs:Depends=(.*)$", text, re.M)
    if not depends:
        fail(f"dpkg-shlibdeps says nothing of dependencies:\n{text}")
    return depends[1]


def library_path(name):
    match = re.search(rf"^\s*{re.escape(name)} \(.*x86-64.*\) => (\S+)$", output("/sbin/ldconfig", "-p"), re.M)
    return match[1] if match else fail(f"{name} is not installed")


def make_deb(build, out, version, epoch, scratch):
    stage = scratch / "deb"
    library = install(build, stage / "usr")
    documents = stage / "usr/share/doc/sandlot"
    add_licences(documents, [])
    (documents / "copyright").write_text(
        "Sandlot is under the Apache License 2.0; see /usr/share/common-licenses/Apache-2.0 and /usr/share/sandlot/LICENSE.\n\n"
        + (documents / "licences/README").read_text().split("\n", 1)[1].replace("in the files of this folder",
                                                                                "in /usr/share/doc/sandlot/licences"))
    size = sum(-(-each.stat().st_size // 1024) if each.is_file() and not each.is_symlink() else 1 for each in stage.rglob("*"))
    architecture = output("dpkg", "--print-architecture").strip()
    control = stage / "DEBIAN"
    control.mkdir()
    (control / "control").write_text(
        f"Package: sandlot\nVersion: {version}\nArchitecture: {architecture}\nMaintainer: {MAINTAINER}\nInstalled-Size: {size}\n"
        f"Depends: {dependencies(stage, library)}\nRecommends: bubblewrap\nSuggests: g++, cmake, pkgconf\nSection: science\nPriority: optional\n"
        f"Description: {SUMMARY}\n{DESCRIPTION}\n")
    (control / "triggers").write_text("activate-noawait ldconfig\n")
    sums = [f"{hashlib.md5(each.read_bytes()).hexdigest()}  {each.relative_to(stage)}\n"
            for each in sorted((stage / "usr").rglob("*")) if each.is_file() and not each.is_symlink()]
    (control / "md5sums").write_text("".join(sums))
    settle(stage, epoch)
    target = out / f"sandlot_{version}_{architecture}.deb"
    output("dpkg-deb", "--root-owner-group", "-Zxz", "-z6", "--threads-max=1", "--build", stage, target)
    return target


# --- the .tar.gz -------------------------------------------------------------------------------------------------------

def carry(prefix, library):
    """Copies the libraries that libsandlot needs into lib/bundled and lets it look there. @return their Debian packages"""
    needed = shared_libraries(library)
    for name in OPENED_AT_RUN_TIME:
        needed[name] = library_path(name)
        needed |= shared_libraries(needed[name])
    bundled = prefix / "lib/bundled"
    bundled.mkdir()
    packages = {}
    for name, path in sorted(needed.items()):
        real = os.path.realpath(path)
        package = package_of(real)
        if package in OF_THE_SYSTEM:
            continue
        shutil.copyfile(real, bundled / name)
        packages.setdefault(package, []).append(name)
    # DT_RPATH, not DT_RUNPATH: it also holds for what the libraries need in turn, so that they stay Debian's files.
    output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/bundled", library)
    output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/../lib:$ORIGIN/../lib/bundled", prefix / "bin/sandlot")
    lines = ["Libraries in lib/bundled, unchanged files of Debian packages: file, package, version, source package, version of it.",
             "The sources are in Debian's archive of source packages, under the last two words of a line.", ""]
    for package, names in sorted(packages.items()):
        about = output("dpkg-query", "-W", "-f", "${Package} ${Version} ${source:Package} ${source:Version}\n", package).splitlines()[0]
        lines += [f"{name} {about}" for name in names]
    (prefix / "share/doc/sandlot/libraries.txt").write_text("\n".join(lines) + "\n")
    return sorted(packages)


def glibc_version(prefix):
    """The newest version of glibc whose symbols anything in the archive uses."""
    newest = (0, 0)
    for file in [*(prefix / "lib").rglob("*.so*"), prefix / "bin/sandlot"]:
        if not file.is_symlink():
            newest = max([newest, *((int(a), int(b)) for a, b in re.findall(r"GLIBC_(\d+)\.(\d+)", output("objdump", "-T", file)))])
    return "%d.%d" % newest


def make_archive(build, out, version, epoch, scratch):
    name = f"sandlot-{version}-{os_release()}-{output('dpkg', '--print-architecture').strip()}"
    prefix = scratch / name
    library = install(build, prefix)
    add_licences(prefix / "share/doc/sandlot", carry(prefix, library))
    shutil.copyfile(ROOT / "LICENSE", prefix / "LICENSE")
    (prefix / "README").write_text(
        f"Sandlot {version}\n\nbin/sandlot demo    then open the address it prints\nbin/sandlot --help  all commands\n\n"
        f"Runs from any folder, on Linux with glibc {glibc_version(prefix)} or later ({os_release()} and later) and a processor with AVX2\n"
        "(x86-64-v3). lib/bundled holds the libraries it needs. share/doc/sandlot has the documentation, the licences of all\n"
        "parts (licences) and where the sources of the libraries are (libraries.txt).\n")
    settle(prefix, epoch)
    target = out / f"{name}.tar.gz"

    def plain(entry):
        entry.uid = entry.gid = 0
        entry.uname = entry.gname = "root"
        entry.mtime = epoch
        return entry

    with open(target, "wb") as file, gzip.GzipFile("", "wb", 6, file, epoch) as packed, \
            tarfile.open(fileobj=packed, mode="w", format=tarfile.GNU_FORMAT) as archive:
        archive.add(prefix, name, recursive=False, filter=plain)
        for path in sorted(prefix.rglob("*")):
            archive.add(path, str(pathlib.PurePath(name) / path.relative_to(prefix)), recursive=False, filter=plain)
    return target


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release", help="Folder of the build")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/packages", help="Folder for the packages")
    parser.add_argument("--only", choices=["deb", "tar.gz"], help="Make only this one")
    arguments = parser.parse_args()
    os.environ["LC_ALL"] = "C.UTF-8"
    epoch = int(os.environ.get("SOURCE_DATE_EPOCH") or git("log", "-1", "--format=%ct") or (ROOT / "CMakeLists.txt").stat().st_mtime)
    os.environ["SOURCE_DATE_EPOCH"] = str(epoch)
    version = package_version()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for old in [*arguments.out.glob("sandlot_*.deb"), *arguments.out.glob("sandlot-*.tar.gz")]:
        old.unlink()
    with tempfile.TemporaryDirectory(prefix="sandlot_package") as folder:
        scratch = pathlib.Path(folder)
        if arguments.only != "tar.gz":
            print(make_deb(arguments.build.resolve(), arguments.out.resolve(), f"{version}~{os_release()}", epoch, scratch))
        if arguments.only != "deb":
            print(make_archive(arguments.build.resolve(), arguments.out.resolve(), version, epoch, scratch))


if __name__ == "__main__":
    main()
