#!/bin/bash
# Installs the packages in fresh places and works with them: the wheel in a new virtual environment, in which a notebook is
# run to its end; the archive in an empty folder; the static archive, if there is one, in an otherwise empty root; the package for Debian in a new system made by debootstrap (as root),
# where it is installed by dpkg, runs a study, and is removed. Checks the bill of materials against the schema of CycloneDX.
#
#   deploy/packages/try.sh PACKAGES [NOTEBOOK]
#
# PACKAGES is the folder that build.sh filled. The notebook, with its results, is written to NOTEBOOK. Needs the registries of
# Python and Debian.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
packages=$(cd "$1" && pwd)
notebook=$(realpath "${2:-/dev/null}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

study=(run four-bar --accuracy draft --samples 2000 --initial 12 --max-evaluations 16 --workers 2 --quiet)

echo "== wheel"
python3 -m venv venv
venv/bin/pip install --quiet "$(echo "$packages"/*.whl)[pandas]" nbclient ipykernel 'cyclonedx-python-lib[json-validation]'
venv/bin/coordinator --version
venv/bin/worker --version
mkdir notebook
cat >run.py <<'END'
import sys
import nbclient
import nbformat

book = nbformat.read(sys.argv[1], as_version=4)
nbclient.NotebookClient(book, timeout=600, kernel_name="python3", resources={"metadata": {"path": "notebook"}}).execute()
errors = [out for cell in book.cells for out in cell.get("outputs", []) if out.output_type == "error"]
assert not errors, errors
with open(sys.argv[2], "w") as file:
    nbformat.write(book, file)
print(f"notebook: {sum(cell.cell_type == 'code' for cell in book.cells)} cells run")
END
# The kernel finds the programs of its own environment; no other path leads to them.
env --unset=HINGEWISE_COORDINATOR venv/bin/python run.py "$here/../python/four-bar.ipynb" "$notebook"

echo "== bill of materials"
cat >bill.py <<'END'
import sys
from pathlib import Path
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

(file,) = Path("venv/lib").glob("python*/site-packages/hingewise-*.dist-info/sboms/sbom.cdx.json")
error = JsonStrictValidator(SchemaVersion.V1_6).validate_str(file.read_text())
sys.exit(error and str(error))
END
venv/bin/python bill.py
echo "valid CycloneDX 1.6"

echo "== archive"
mkdir archive
tar -xzf "$packages"/*-linux-gnu.tar.gz -C archive --strip-components 1
env --ignore-environment archive/bin/coordinator "${study[@]}" --out archive-study >/dev/null
grep -c . archive-study/reliability.csv

echo "== static archive"
static=$(echo "$packages"/*-linux-musl.tar.gz)
if [ ! -e "$static" ]; then
    echo "not tried: there is none"
elif [ "$(id -u)" -ne 0 ]; then
    echo "not tried: chroot needs root"
else
    # A root without any file but those of the archive.
    mkdir static
    tar -xzf "$static" -C static --strip-components 1
    mkdir static/tmp
    chroot static /bin/worker --version
    env --ignore-environment "$(command -v chroot)" static /bin/coordinator "${study[@]}" --out /tmp/study >/dev/null
    grep -c . static/tmp/study/reliability.csv
    # Its elementary functions are those of another library.
    if cmp static/tmp/study/reliability.csv archive-study/reliability.csv; then
        echo "the same bytes as with the other archive"
    fi
fi

echo "== Debian"
if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
    echo "not tried: needs root and debootstrap"
    exit 0
fi
release=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
debootstrap --variant=minbase "$release" root >debootstrap.log 2>&1 || { tail -n 20 debootstrap.log >&2; exit 1; }
find root -xdev | sort >before
dpkg --root="$work/root" --install "$packages"/*.deb
chroot root coordinator --version
chroot root env HOME=/root coordinator "${study[@]}" --out /tmp/study >/dev/null
cmp root/tmp/study/reliability.csv archive-study/reliability.csv
echo "the same study as with the archive"
rm -r root/tmp/study
dpkg --root="$work/root" --purge hingewise
find root -xdev | sort >after
echo "left by the package: $(comm -13 before after | grep -cvE '^root/var/lib/dpkg/|^root/var/log/' || true) files"
