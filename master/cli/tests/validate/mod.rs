//! A reference model that takes a moment.

use std::path::Path;

/// Keys of a short line on a coarse mesh.
const SHORT: [(&str, &str); 5] = [
    ("spans = 10", "spans = 4"),
    ("duration = 7.0", "duration = 2.0"),
    ("evaluate = { spans = [5, 6] }", "evaluate = { time = [0.8, 1.5] }"),
    ("elements_per_interval = 8", "elements_per_interval = 1"),
    ("corrections = \"auto\"", "corrections = \"none\""),
];

/// Writes a short scene and a model with this range of its mean force (N) into `folder`; path of the model.
pub fn model(folder: &Path, (low, high): (f64, f64)) -> String {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut text = std::fs::read_to_string(scenes.join("en50318-250.toml")).unwrap();
    for (from, to) in SHORT {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    std::fs::write(folder.join("short.toml"), text).unwrap();
    let path = folder.join("model.toml");
    let model = format!(
        "standard = \"own\"\nsource = \"a test\"\n[[case]]\nname = \"short\"\nscene = \"short.toml\"\n\
         [case.ranges]\nmean = [{low:?}, {high:?}]\nloss_percent = [0.0, 100.0]\n"
    );
    std::fs::write(&path, model).unwrap();
    path.display().to_string()
}
