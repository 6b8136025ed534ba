//! The reference of the scene file is the one that the code generates.

#[test]
fn the_committed_reference_is_the_generated_one() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/reference.md");
    let committed = std::fs::read_to_string(path).unwrap_or_default().replace("\r\n", "\n");
    assert!(
        committed == scene::reference(),
        "docs/scenes/reference.md is not what the keys say; write it anew by\n\
         cargo run --release -p scene --example reference > docs/scenes/reference.md"
    );
}
