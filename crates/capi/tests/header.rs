//! The C header is what the library's source says.

use std::path::Path;

/// The variable that makes this test write the header instead: `cargo xtask header` sets it.
const WRITE: &str = "AMBERFIELD_WRITE_HEADER";

#[test]
fn committed_header_is_that_of_the_source() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("a good configuration");
    let bindings = cbindgen::Builder::new()
        .with_config(config)
        .with_src(root.join("src/field_side.rs"))
        .with_src(root.join("src/field_flow.rs"))
        .with_src(root.join("src/host_side.rs"))
        .generate()
        .expect("a good source");
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).expect("UTF-8");
    let path = root.join("include/amberfield.h");
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(&path, &text).expect("the header can be written");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == text, "include/amberfield.h is stale: run `cargo xtask header`");
}
