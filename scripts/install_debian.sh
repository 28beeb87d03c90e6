#!/bin/sh
# Install Debian's packages of these programs, in which tests run: `install_debian.sh chromium zsh fish`. Needs root,
# apt-get and a network; status 1 when one of them cannot be had.
# Another apt-get that is at work (a machine that updates itself) is waited for, ten minutes at most.
set -u

missing() {
    for program in "$@"; do
        command -v "$program" >/dev/null || command -v "$program-browser" >/dev/null || printf '%s ' "$program"
    done
}

apt() {
    DEBIAN_FRONTEND=noninteractive timeout 600 apt-get -qq \
        -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o Acquire::https::Timeout=20 "$@" 2>&1
}

[ -z "$(missing "$@")" ] && exit 0
[ "$(id -u)" = 0 ] && command -v apt-get >/dev/null || exit 1
waited=0
while :; do
    # shellcheck disable=SC2046  (a word for each program)
    said=$(apt update && apt install -y --no-install-recommends $(missing "$@")) && [ -z "$(missing "$@")" ] && exit 0
    case $said in
    *"get lock"* | *"lock directory"* | *"held by process"*) ;; # somebody else is installing
    *) printf '%s\n' "$said" | tail -n 3 >&2; exit 1 ;;
    esac
    [ "$waited" -lt 600 ] || exit 1
    [ "$waited" -gt 0 ] || echo "waiting for another apt-get" >&2
    sleep 5
    waited=$((waited + 5))
done
