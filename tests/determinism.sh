#!/usr/bin/env bash
# Compiles the tests of determinism for other processors and with other optimisation, and runs them.
#
#     tests/determinism.sh short   packings and queries, one build: as far from that of `cargo test` as flags go
#     tests/determinism.sh core    packings and queries: generic, x86-64-v3 and this processor, optimisation levels 1 to 3
#     tests/determinism.sh pile    the pile with feature enhanced-determinism: four builds of everything, compared
#
# Builds go to target/determinism. Extra arguments go to cargo, for example `--offline`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export CARGO_INCREMENTAL=0 CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}/determinism

which=${1:-short}
shift || true
arguments=("$@")

# The processors that binaries can be compiled for here.
processors() {
    echo generic
    grep -qw avx2 /proc/cpuinfo 2>/dev/null && grep -qw bmi2 /proc/cpuinfo && echo x86-64-v3
    echo native
}

# Runs the tests that cargo is given, compiled for processor $1 at optimisation level $2.
with() {
    local processor=$1 level=$2
    shift 2
    printf '\n== target-cpu %s, opt-level %s\n' "$processor" "$level"
    RUSTFLAGS="-C target-cpu=$processor" CARGO_PROFILE_RELEASE_OPT_LEVEL=$level CARGO_PROFILE_RELEASE_DEBUG=0 \
        cargo test --quiet --release "${arguments[@]}" "$@"
}

core=(-p rapier-ist-packer --no-default-features --test determinism)
pile=(-p rapier-ist-tests --features enhanced-determinism --test determinism -- --nocapture)

case $which in
    short)
        with native 3 "${core[@]}"
        ;;
    core)
        for processor in $(processors); do
            for level in 1 2 3; do
                with "$processor" "$level" "${core[@]}"
            done
        done
        ;;
    pile)
        log=$(mktemp)
        trap 'rm -f "$log"' EXIT
        for build in "generic 1" "generic 3" "x86-64-v3 2" "native 3"; do
            read -r processor level <<<"$build"
            with "$processor" "$level" "${pile[@]}" | tee -a "$log"
        done
        checksums=$(grep -o 'checksum of the pile 0x[0-9a-f]*' "$log" | sort -u)
        if [[ $(wc -l <<<"$checksums") != 1 ]]; then
            echo "the builds differ: $checksums" >&2
            exit 1
        fi
        ;;
    *)
        echo "unknown part '$which'; short, core or pile" >&2
        exit 2
        ;;
esac
