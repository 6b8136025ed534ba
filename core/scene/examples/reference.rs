//! Prints the reference of the scene file: `cargo run --release -p scene --example reference >
//! docs/scenes/reference.md`.

fn main() {
    print!("{}", scene::reference());
}
