#!/usr/bin/env bash
# Does what the README says to somebody who has nothing: clones what is committed here into an
# empty folder, with an empty home, and runs the README's two commands there.
#
#   scripts/fresh_machine.sh [--demo-only]
#
# Packages come from where pip gets them; nothing else of this machine's Python is seen.
set -euo pipefail

words=(demo test)
case "${1:-}" in
    "") ;;
    --demo-only) words=(demo) ;;
    *)
        echo "fresh_machine: got '$1'; expected --demo-only or nothing" >&2
        exit 2
        ;;
esac

source="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
git clone --quiet --no-hardlinks "$source" "$folder/clone"
mkdir "$folder/home"

# What pip needs to find packages stays; whatever else was set on this machine goes.
kept=(HOME="$folder/home" PATH="$PATH" LANG=C.UTF-8)
if [ -z "${PIP_CONFIG_FILE:-}" ] && [ -f "${HOME:-}/.config/pip/pip.conf" ]; then
    kept+=(PIP_CONFIG_FILE="$HOME/.config/pip/pip.conf")
fi
for name in $(compgen -e); do
    case "$name" in
        PIP_* | SSL_CERT_* | http_proxy | https_proxy | no_proxy | HTTP_PROXY | HTTPS_PROXY | NO_PROXY)
            kept+=("$name=${!name}")
            ;;
    esac
done

for word in "${words[@]}"; do
    echo "fresh_machine: make $word"
    env -i "${kept[@]}" make -C "$folder/clone" "$word"
done
test -s "$folder/clone/runs/demo.mcap"
test -s "$folder/clone/runs/demo.html"
echo "fresh_machine: ok, $(git -C "$folder/clone" describe --always)"
