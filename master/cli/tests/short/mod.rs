//! A line that is run at once, for tests of what does not depend on its accuracy.

/// A line of three spans on a coarse mesh, for a fraction of a second.
pub const SHORT: [&str; 5] = [
    "catenary.spans=3",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=0.2",
    "run.evaluate={ time = [0.1, 0.2] }",
    "run.output_step=0.001",
];
