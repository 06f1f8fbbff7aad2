//! Tools that a test needs and a machine may lack.

/// Names of the tools that must be there, separated by commas: `gpu`, `qemu`, `chromium`. Continuous integration sets it.
const REQUIRE: &str = "SLIMKD_REQUIRE";

/// For tests: says that a test is skipped because a tool is missing, and how to install it.
///
/// # Panics
/// Where the environment's `SLIMKD_REQUIRE` names the tool: there the test must not be skipped.
pub fn missing(tool: &str, how_to_install: &str) {
    let required = std::env::var(REQUIRE).unwrap_or_default();
    assert!(
        required.split(',').all(|name| name.trim() != tool),
        "{tool} is missing and {REQUIRE} names it; {how_to_install}"
    );
    println!("skipped: no {tool}; {how_to_install}");
}
