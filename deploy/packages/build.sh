#!/bin/bash
# Packages with both programs, manual pages, completions, the licences of all dependencies and a bill of materials: an
# archive, a package for Debian and a wheel for Python, for the system it runs on.
#
#   deploy/packages/build.sh [--static] OUT [PROGRAMS]
#
# OUT is the folder of the packages. PROGRAMS is a folder with `coordinator` and `worker`; without it, cargo builds them.
# With --static it makes an archive of programs that need no library of the system, by musl, and nothing else; cargo then needs
# Rust's standard library for that target (rustup target add x86_64-unknown-linux-musl) and musl-gcc (Debian: musl-tools).
# Needs binutils, python3 (3.11) and dpkg-deb. The same sources, programs and tools give the same bytes.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
libc=gnu
if [ "${1:-}" = --static ]; then
    libc=musl
    shift
fi
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)
machine=$(uname -m)
target=$machine-unknown-linux-$libc
programs=${2:-}
if [ -z "$programs" ] && [ "$libc" = gnu ]; then
    cargo build --release --locked --manifest-path "$top/Cargo.toml" -p coordinator -p worker
    programs=${CARGO_TARGET_DIR:-$top/target}/release
elif [ -z "$programs" ]; then
    if [ ! -d "$(rustc --print target-libdir --target "$target")" ]; then
        echo "Rust's standard library for $target is not installed: rustup target add $target" >&2
        exit 2
    fi
    if ! command -v musl-gcc >/dev/null; then
        echo "musl-gcc is not installed (Debian: musl-tools)" >&2
        exit 2
    fi
    cargo build --release --locked --target "$target" --manifest-path "$top/Cargo.toml" -p coordinator -p worker
    programs=${CARGO_TARGET_DIR:-$top/target}/$target/release
fi
programs=$(cd "$programs" && pwd)

version=$("$programs/coordinator" --version)
version=${version##* }
case $machine in
    x86_64) debian=amd64 ;;
    aarch64) debian=arm64 ;;
    *) echo "$machine: no package is made for this processor" >&2; exit 2 ;;
esac
needed=$(objdump -p "$programs/coordinator" "$programs/worker" | grep NEEDED || true)
if [ "$libc" = musl ] && [ -n "$needed" ]; then
    echo "the programs in $programs need libraries of the system:" >&2
    echo "$needed" >&2
    exit 2
fi
# The newest symbol of the C library that the programs use is the oldest library they run with.
glibc=$(objdump -T "$programs/coordinator" "$programs/worker" 2>/dev/null | grep -o 'GLIBC_[0-9.]*' | sort -Vu | tail -n 1 || true)
glibc=${glibc#GLIBC_}
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$top" log -1 --format=%ct 2>/dev/null || date +%s)}
export SOURCE_DATE_EPOCH

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
name=hingewise-$version-$machine-linux-$libc
tree=$stage/$name
share=$tree/share
doc=$share/doc/hingewise

# What every package holds.
for program in coordinator worker; do
    install -D "$programs/$program" "$tree/bin/$program"
    strip --strip-unneeded "$tree/bin/$program"
done
completions() { if [ "$1" = coordinator ]; then "$programs/$1" completions "$2"; else "$programs/$1" --completions "$2"; fi; }
mkdir -p "$share/bash-completion/completions" "$share/zsh/site-functions" "$share/fish/vendor_completions.d"
for program in coordinator worker; do
    completions "$program" bash >"$share/bash-completion/completions/$program"
    completions "$program" zsh >"$share/zsh/site-functions/_$program"
    completions "$program" fish >"$share/fish/vendor_completions.d/$program.fish"
done
"$programs/coordinator" man --out "$share/man/man1"
rm "$share"/man/man1/coordinator-help*.1
"$programs/worker" --man >"$share/man/man1/worker.1"
install -D -m 644 -t "$doc" "$top/LICENSE" "$top/README.md" "$top/CHANGELOG.md"
python3 "$here/dependencies.py" "$doc" "$target"
if [ "$libc" = musl ]; then
    # The programs contain this library.
    install -m 644 /usr/share/doc/musl-dev/copyright "$doc/musl-copyright"
fi
for file in README.md certificates.sh ssh-workers.sh slurm; do cp -R "$top/deploy/$file" "$doc/"; done
cp "$top"/deploy/*.json5 "$doc/"
# The manual, where the links of the front page lead.
for folder in coordinator/doc common/scenes; do
    mkdir -p "$doc/$folder"
    cp -R "$top/$folder/." "$doc/$folder"
done
mv "$doc/README.md" "$doc/deployment.md"
install -m 644 "$top/README.md" "$doc/README.md"
chmod -R u=rwX,go=rX "$tree"

# The archive: to be unpacked anywhere.
tar --create --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" --directory "$stage" "$name" |
    gzip -n >"$out/$name.tar.gz"
if [ "$libc" = musl ]; then
    ls -l "$out/$name.tar.gz"
    exit 0
fi

# The wheel.
python3 "$here/wheel.py" "$tree" "$out" "manylinux_${glibc//./_}_$machine"

# The package for Debian: the same files below /usr, the units with their paths, and a user for them.
root=$stage/debian
mkdir -p "$root/DEBIAN" "$root/usr/lib/systemd/system" "$root/usr/lib/sysusers.d"
cp -R "$tree/bin" "$tree/share" "$root/usr/"
gzip -9n "$root"/usr/share/man/man1/*.1
mkdir -p "$root/usr/share/zsh/vendor-completions"
mv "$root"/usr/share/zsh/site-functions/* "$root/usr/share/zsh/vendor-completions/"
rmdir "$root/usr/share/zsh/site-functions"
mv "$root/usr/share/doc/hingewise/LICENSE" "$root/usr/share/doc/hingewise/copyright"
for unit in coordinator worker; do
    sed -e 's|/opt/hingewise/bin/|/usr/bin/|g' -e 's|/opt/hingewise/share/|/usr/share/doc/hingewise/|g' \
        "$top/deploy/hingewise-$unit.service" >"$root/usr/lib/systemd/system/hingewise-$unit.service"
done
echo 'u hingewise - "Hingewise" /var/lib/hingewise' >"$root/usr/lib/sysusers.d/hingewise.conf"
size=$(du --summarize --apparent-size --block-size=1K "$root/usr" | cut -f 1)
cat >"$root/DEBIAN/control" <<END
Package: hingewise
Version: $version-1
Architecture: $debian
Maintainer: The Hingewise authors <authors@hingewise.invalid>
Installed-Size: $size
Depends: libc6 (>= $glibc), libgcc-s1
Conflicts: worker
Section: science
Priority: optional
Description: reliability over life of mechanisms with worn clearance joints
 The programs coordinator and worker, with manual pages, shell completions and systemd units, which are not enabled. The
 file manager "worker" has a program of the same name.
END
cat >"$root/DEBIAN/postinst" <<'END'
#!/bin/sh
set -e
if [ "$1" = configure ] && command -v systemd-sysusers >/dev/null; then systemd-sysusers hingewise.conf; fi
if [ -d /run/systemd/system ]; then systemctl daemon-reload; fi
END
cat >"$root/DEBIAN/prerm" <<'END'
#!/bin/sh
set -e
if [ "$1" = remove ] && [ -d /run/systemd/system ]; then
    systemctl --no-reload disable --now hingewise-coordinator.service hingewise-worker.service
fi
END
chmod 755 "$root/DEBIAN/postinst" "$root/DEBIAN/prerm"
chmod -R u=rwX,go=rX "$root"
find "$root" -exec touch --no-dereference --date="@$SOURCE_DATE_EPOCH" {} +
dpkg-deb --root-owner-group -Zgzip --build "$root" "$out/hingewise_$version-1_$debian.deb" >/dev/null

echo "oldest C library: glibc $glibc"
ls -l "$out"
