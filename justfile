# Everything that CI checks.
ci:
    bash .ci/run

# Format, lints and the tests in virtual time, without the longest: before every commit, 2.5 minutes on 2 cores.
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    cargo test --workspace --exclude studies --lib --bins --test virtual --test hard_cases --test recordings -- \
      --skip when_measured --skip at_any_azimuth --skip agree_with_brute_force --skip no_fault --skip whole_scans_of_the_scenes \
      --skip every_lidar_has_a_plan --skip choices_are_refined --skip rmbls_match_the_known

# Every test that needs only the checkout.
test:
    cargo test --workspace

# Lines, import cycles, repeated type names, long comments.
counts:
    cargo test -p architecture -- --ignored --nocapture

# The book, in docs/book.
book:
    mdbook build docs

# A scan with simulated devices.
scan *ARGS:
    cargo run --release -- capture --speed 56.25 {{ARGS}}

# Captures with a drive that misbehaves; --include-ignored for every link, --bless for the table of docs/src/misbehaviours.md.
misbehaviours *ARGS:
    cargo test -p velomotion --test misbehaviours --locked -- {{ARGS}}

# Scans of an independent generator, replayed and measured against their truth; --only GROUP --seeds N (tests/foreign/generator/README.md).
generator *ARGS:
    python3 tests/foreign/generator/run.py --program target/release/velomotion {{ARGS}}

# 200 seeded failure scenarios; --first SEED --captures N for others, --bless for the table of docs/src/chaos.md.
chaos *ARGS:
    cargo test -p velomotion-tests --test chaos --locked -- --captures 200 {{ARGS}}

# 200 kills at random moments on each transport; --bless for the table of docs/src/kills.md.
kills *ARGS:
    cargo test -p velomotion --test kills --locked -- --kills 200 {{ARGS}}

# The unit tests of what runs on Windows, in Wine, and clouds compared with those of Linux.
windows:
    tests/foreign/windows

# A node over DDS behind zenoh-bridge-ros2dds, which is compiled from its published plugin; needs cmake and libclang-dev.
dds:
    tests/foreign/dds/run

# Type-checks what runs on macOS. There is no C compiler for it: nothing is linked.
macos:
    rustup target add aarch64-apple-darwin
    CC_aarch64_apple_darwin=true AR_aarch64_apple_darwin=true cargo check --target aarch64-apple-darwin --no-default-features \
      -p velomotion-cloud -p velomotion-io -p velomotion-engine -p velomotion-daemon -p velomotion -p velomotion-python --locked

# Captures beside 8 busy loops, by the command and by a daemon: each must be complete; --captures N --loops N for others.
load *ARGS:
    cargo test -p velomotion --test load --locked -- --captures 10 {{ARGS}}
