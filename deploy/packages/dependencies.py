#!/usr/bin/env python3
"""Writes what the programs consist of into a folder: the licences of all crates that are compiled into them
(`third-party-licences.txt`) and a bill of materials (`sbom.cdx.json`, CycloneDX 1.6).

    dependencies.py FOLDER [TARGET]

Everything comes from `cargo metadata` and the sources that cargo has fetched. The same Cargo.lock gives the same files.
"""

import hashlib
import html
import json
import re
import subprocess
import sys
import tomllib
import uuid
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = ("coordinator", "worker")
REGISTRY = "registry+https://github.com/rust-lang/crates.io-index"
LICENCE_FILE = re.compile(r"(licen[cs]e|copying|copyright|notice|unlicense)", re.IGNORECASE)
RULE = "=" * 100 + "\n"


def run(*command):
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def metadata(target):
    """`cargo metadata` for one system: the packages by id, and the nodes of the graph by id.

    Macros and build scripts are compiled for the system that builds.
    """
    host = next(line for line in run("rustc", "-vV").splitlines() if line.startswith("host: "))
    platforms = [word for name in sorted({target, host.removeprefix("host: ")}) for word in ("--filter-platform", name)]
    found = json.loads(run("cargo", "metadata", "--format-version", "1", "--locked", *platforms))
    return {p["id"]: p for p in found["packages"]}, {n["id"]: n for n in found["resolve"]["nodes"]}


def compiled(target):
    """Names with versions of everything that is compiled for the programs, macros and build scripts included.

    `cargo metadata` also has crates of features that are switched off.
    """
    programs = [word for name in PROGRAMS for word in ("-p", name)]
    edges = ("--edges", "normal,build", "--prefix", "none", "--format", "{p}")
    lines = run("cargo", "tree", "--locked", "--target", target, *programs, *edges).splitlines()
    return {tuple(line.split(" ")[:2]) for line in lines if line}


def compiled_in(packages, nodes, target):
    """Ids of everything that is compiled for the programs, with the ids of what each uses."""
    kept = compiled(target)
    own = {i for i, p in packages.items() if (p["name"], f"v{p['version']}") in kept}
    uses = {}
    for one in own:
        used = (d for d in nodes[one]["deps"] if any(k["kind"] != "dev" for k in d["dep_kinds"]))
        uses[one] = sorted({d["pkg"] for d in used} & own)
    if len(uses) != len(kept):
        sys.exit("cargo tree and cargo metadata name different crates")
    return uses


def rules():
    """Licences of crates that state none, from the rules of `cargo deny`."""
    text = (ROOT / "deploy/packages/deny.toml").read_text(encoding="utf-8")
    return {c["crate"]: c["expression"] for c in tomllib.loads(text)["licenses"]["clarify"]}


def expression(package, clarified):
    """The licence of a package as an SPDX expression."""
    stated = package["license"] or clarified.get(package["name"])
    if not stated:
        sys.exit(f"{package['name']} {package['version']}: no licence is stated; see deploy/packages/deny.toml")
    return re.sub(r"\s*/\s*", " OR ", stated.strip())


def texts(package):
    """Licence texts among the sources of a package, by the names of their files."""
    folder = Path(package["manifest_path"]).parent
    files = {f for f in folder.iterdir() if f.is_file() and LICENCE_FILE.match(f.name)}
    if package["license_file"]:
        files.add(folder / package["license_file"])
    return {f.name: f.read_text(encoding="utf-8", errors="replace").strip() + "\n" for f in sorted(files)}


def own_text(title):
    """One of the two texts of the project's own LICENSE."""
    parts = re.split(r"={20,}\n(.+)\n={20,}\n", (ROOT / "LICENSE").read_text(encoding="utf-8"))
    return dict(zip(parts[1::2], parts[2::2]))[title].strip() + "\n"


def standard_text(package, stated):
    """The text of a licence for a package that comes without one: Apache-2.0 if that is a choice, else MIT with the
    authors that its manifest names."""
    if "Apache-2.0" in stated:
        return own_text("Apache License, Version 2.0")
    if stated == "MIT":
        authors = ", ".join(package["authors"]) or f"The authors of {package['name']}"
        return re.sub(r"Copyright \(c\).*", f"Copyright (c) {authors}", own_text("MIT License"), count=1)
    sys.exit(f"{package['name']} {package['version']}: no text of {stated} in its sources")


def rust_library():
    """The notice of Rust's standard library, which every program contains."""
    sysroot = Path(run("rustc", "--print", "sysroot").strip())
    notice = sysroot / "share/doc/rust/COPYRIGHT-library.html"
    if not notice.is_file():
        return f"MIT OR Apache-2.0; notices: COPYRIGHT-library.html of the distribution of {run('rustc', '--version')}"
    text = re.sub(r"<(style|script).*?</\1>|<[^>]+>", "", notice.read_text(encoding="utf-8"), flags=re.DOTALL)
    return re.sub(r"\n\s*\n+", "\n\n", html.unescape(text)).strip() + "\n"


def licences(foreign, clarified):
    """The licences of all crates: a list, and every text once with the crates it belongs to."""
    listed, by_text = [], {}
    for package in foreign:
        stated, label = expression(package, clarified), f"{package['name']} {package['version']}"
        listed.append(f"{label}: {stated}; {package['repository'] or 'https://crates.io/crates/' + package['name']}")
        for text in (texts(package) or {"": standard_text(package, stated)}).values():
            by_text.setdefault(text, []).append(label)
    parts = [
        "Hingewise is licensed under MIT or Apache-2.0 (LICENSE). Its programs contain the following crates and the\n"
        "standard library of Rust; SQLite, in libsqlite3-sys, is in the public domain. Sources: crates.io and the\n"
        "addresses below.\n\n" + "\n".join(listed) + "\n"
    ]
    parts += [f"{', '.join(labels)}\n\n{text}" for text, labels in sorted(by_text.items(), key=lambda t: t[1])]
    parts.append("The standard library of Rust\n\n" + rust_library())
    return RULE.join(parts)


def bill_of_materials(packages, uses, clarified, version):
    """The bill of materials as CycloneDX 1.6."""
    lock = (ROOT / "Cargo.lock").read_text(encoding="utf-8")
    sums = {(p["name"], p["version"]): p.get("checksum") for p in tomllib.loads(lock)["package"]}

    def reference(package):
        return f"pkg:cargo/{package['name']}@{package['version']}"

    def component(package):
        own = package["source"] is None
        entry = {
            "type": "application" if package["name"] in PROGRAMS and own else "library",
            "bom-ref": reference(package),
            "name": package["name"],
            "version": package["version"],
            "description": package["description"] or package["name"],
            "licenses": [{"expression": expression(package, clarified)}],
        }
        if not own:
            if package["source"] != REGISTRY:
                sys.exit(f"{package['name']} {package['version']}: comes from {package['source']}")
            entry["purl"] = reference(package)
            entry["hashes"] = [{"alg": "SHA-256", "content": sums[package["name"], package["version"]]}]
        if package["repository"]:
            entry["externalReferences"] = [{"type": "vcs", "url": package["repository"]}]
        return entry

    whole = f"pkg:generic/hingewise@{version}"
    programs = sorted(reference(p) for i, p in packages.items() if i in uses and p["name"] in PROGRAMS)
    graph = {reference(packages[i]): sorted(reference(packages[d]) for d in used) for i, used in uses.items()}
    graph[whole] = programs
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.UUID(bytes=hashlib.sha256(lock.encode()).digest()[:16], version=4)}",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": whole,
                "name": "hingewise",
                "version": version,
                "licenses": [{"expression": "MIT OR Apache-2.0"}],
            }
        },
        "components": [component(packages[i]) for i in sorted(uses, key=lambda i: reference(packages[i]))],
        "dependencies": [{"ref": ref, "dependsOn": used} for ref, used in sorted(graph.items())],
    }


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: dependencies.py FOLDER [TARGET]")
    folder, target = Path(sys.argv[1]), (sys.argv[2:] or ["x86_64-unknown-linux-gnu"])[0]
    packages, nodes = metadata(target)
    uses, clarified = compiled_in(packages, nodes, target), rules()
    version = next(packages[i]["version"] for i in uses if packages[i]["name"] == "coordinator")
    foreign = [packages[i] for i in uses if packages[i]["source"]]
    foreign.sort(key=lambda package: (package["name"], package["version"]))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "third-party-licences.txt").write_text(licences(foreign, clarified), encoding="utf-8")
    bill = bill_of_materials(packages, uses, clarified, version)
    (folder / "sbom.cdx.json").write_text(json.dumps(bill, indent=1) + "\n", encoding="utf-8")
    print(f"{len(foreign)} crates")


if __name__ == "__main__":
    main()
