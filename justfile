# What CI runs, and the shorter ways to parts of it.

# Everything that CI checks.
ci:
    bash .ci/run

# Format, lints, tests: before every commit.
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    cargo test --workspace

# The book, in docs/book.
book:
    mdbook build docs

# A scan with software devices.
scan *ARGS:
    cargo run --release -- capture --speed 56.25 {{ARGS}}

# 200 captures in which something goes wrong, by seeds; --first SEED --captures N for others, --bless for the table of docs/src/chaos.md.
chaos *ARGS:
    cargo test -p velomotion-tests --test chaos --locked -- --captures 200 {{ARGS}}
