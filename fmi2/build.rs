//! Compiles the variadic logger of the importer, which Rust cannot define.

fn main() {
    println!("cargo::rerun-if-changed=src/import/logger.c");
    cc::Build::new()
        .file("src/import/logger.c")
        .warnings(true)
        .compile("fmi2_import_logger");
}
