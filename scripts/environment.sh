# Make the virtual environment .venv and keep it up to date. The scripts beside this file source it.
#
#   prepare KIND      KIND is "run", or an extra: "dev" for the tools of development too, "docs" for those of the site;
#                     $python is then the interpreter
#
# The environment is made when it is missing. It is installed again when pyproject.toml has changed, or the
# directory has moved. The package is then compiled: Python's files, and the solver by solving the built-in case. PYTHON
# chooses the interpreter that makes it. ENVIRONMENT chooses another directory than .venv.

root=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
environment=${ENVIRONMENT:-$root/.venv}
python=$environment/bin/python

fail() {
    printf 'fastpin: %s\n' "$*" >&2
    exit 1
}

say() {
    printf 'fastpin: %s\n' "$*" >&2
}

is_recent() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1
}

find_python() {
    local candidate
    if [[ -n ${PYTHON:-} ]]; then
        is_recent "$PYTHON" || fail "PYTHON=$PYTHON is not a Python of version 3.11 or later."
        printf '%s\n' "$PYTHON"
        return
    fi
    for candidate in python3.11 python3; do
        if is_recent "$candidate"; then
            printf '%s\n' "$candidate"
            return
        fi
    done
    fail "Python 3.11 or later is needed: apt-get install python3 python3-venv, or set PYTHON."
}

# Debian has a separate package for ensurepip and venv, which make environments.
need_ensurepip() {
    "$1" -c 'import ensurepip, venv' >/dev/null 2>&1 && return
    local package log
    package=$("$1" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
    if [[ ${EUID:-$(id -u)} -eq 0 ]] && command -v apt-get >/dev/null; then
        say "installing $package"
        log=$({ apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$package"; } 2>&1) ||
            { printf '%s\n' "$log" >&2; fail "installing $package failed (above)."; }
        "$1" -c 'import ensurepip, venv' >/dev/null 2>&1 && return
    fi
    fail "Python can't make virtual environments here: apt-get install python3-venv (or $package)."
}

make_environment() {
    if [[ -x $python ]] && "$python" -c '' >/dev/null 2>&1; then
        is_recent "$python" || fail "$environment has a Python older than 3.11: remove it and start again."
        "$python" -m pip --version >/dev/null 2>&1 && return
        "$python" -m ensurepip >/dev/null 2>&1 && return
    fi
    local base log
    base=$(find_python)
    need_ensurepip "$base"
    say "making $environment, once; this takes a minute"
    log=$("$base" -m venv --clear "$environment" 2>&1) ||
        { printf '%s\n' "$log" >&2; fail "making the virtual environment failed (above)."; }
}

fingerprint() {
    { cat -- "$root/pyproject.toml"; printf '%s\n' "$root"; } | cksum
}

is_current() {
    [[ -x $python && -f $environment/fastpin-$1.stamp && $(<"$environment/fastpin-$1.stamp") == "$(fingerprint)" ]]
}

prepare() {
    local kind=${1:-run} what=$root log stamp
    is_current "$kind" && return
    # One at a time: the lock is on the directory itself, so nothing is left behind.
    exec 9<"$root"
    ! command -v flock >/dev/null || flock 9 || true
    if ! is_current "$kind"; then # another process may have done it during the wait
        make_environment
        [[ $kind != run ]] && what="$root[$kind]"
        say "installing the dependencies; this takes up to a minute"
        # Python compiles the files of the dependencies that are used, when they are used.
        log=$("$python" -m pip install --quiet --disable-pip-version-check --no-input --no-compile --editable "$what" 2>&1) ||
            { printf '%s\n' "$log" >&2; fail "installing the dependencies failed (above)."; }
        stamp=$(fingerprint)
        printf '%s\n' "$stamp" >"$environment/fastpin-run.stamp"
        # An installation without the tools of an extra leaves the stamp of the tools as it is.
        if [[ $kind != run ]]; then printf '%s\n' "$stamp" >"$environment/fastpin-$kind.stamp"; fi
        say "compiling the solver; this takes some ten seconds"
        "$python" -m compileall -q "$root/fastpin" >/dev/null 2>&1 || true
        env -u PYTHONDONTWRITEBYTECODE "$python" -P -m fastpin run >/dev/null 2>&1 || true # if it fails, the command that follows says why
    fi
    exec 9<&-
}
