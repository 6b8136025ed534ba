//! Pages as a browser shows them.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde::Deserialize;

/// Names that Chromium goes by.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// Chromium of this machine.
static CHROMIUM: LazyLock<PathBuf> = LazyLock::new(|| {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
    let found = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    found.into_iter().find(|path| path.is_file()).unwrap_or_else(|| {
        panic!(
            "pages are tested in Chromium, and none of {} is in PATH: install it by your distribution's packages, such \
             as apt-get install chromium",
            NAMES.join(", ")
        )
    })
});

/// A page in a frame of a width.
#[derive(Debug, Deserialize)]
pub struct Seen {
    /// Width of the frame, px.
    pub width: u32,
    /// Errors on the console or thrown.
    pub errors: Vec<String>,
    /// Figures.
    pub figures: usize,
    /// Figures without a curve, a mark or a map.
    pub undrawn: Vec<String>,
    /// Pixels that the page is wider than the frame.
    pub overflow: u32,
    /// Parts that reach beyond it.
    pub wide: Vec<String>,
    /// Buttons that are taller than a line.
    pub stretched: Vec<String>,
    /// Names of axes that are cut off above their figure.
    pub beyond: Vec<String>,
    /// Figures that nothing describes in words.
    pub nameless: Vec<String>,
    /// Buttons.
    pub buttons: usize,
    /// Buttons that did nothing.
    pub idle: Vec<String>,
}

impl Seen {
    /// Faults of the page, in words.
    pub fn faults(&self) -> Vec<String> {
        let width = self.width;
        let mut faults: Vec<String> = self.errors.iter().map(|error| format!("error: {error}")).collect();
        faults.extend(self.undrawn.iter().map(|figure| format!("figure {figure} is empty")));
        faults.extend(self.idle.iter().map(|button| format!("button {button} does nothing")));
        faults.extend(
            self.stretched
                .iter()
                .map(|button| format!("button {button} is stretched")),
        );
        faults.extend(self.beyond.iter().map(|axis| format!("axis {axis} is cut off")));
        faults.extend(
            self.nameless
                .iter()
                .map(|figure| format!("figure {figure} has no description")),
        );
        if self.overflow > 0 || !self.wide.is_empty() {
            faults.push(format!("wider by {} px: {:?}", self.overflow, self.wide));
        }
        faults.iter().map(|fault| format!("at {width} px: {fault}")).collect()
    }
}

fn chromium(arguments: &[&str], page: &Path) -> Vec<u8> {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(&*CHROMIUM)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--allow-file-access-from-files",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(arguments)
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", CHROMIUM.display()));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Looks at a page at each of these widths (px), and presses its buttons.
pub fn look(html: &str, widths: &[u32]) -> Vec<Seen> {
    let folder = tempfile::tempdir().unwrap();
    let watched = html.replacen(
        "<head>",
        &format!("<head><script>{}</script>", include_str!("catch.js")),
        1,
    );
    assert_ne!(watched, html, "the page has a head");
    std::fs::write(folder.path().join("page.html"), watched).unwrap();
    let probe = include_str!("probe.js").replace("WIDTHS", &format!("{widths:?}"));
    let frame = folder.path().join("frame.html");
    let text =
        format!("<!DOCTYPE html><body><script type=\"text/plain\" id=\"seen\"></script><script>{probe}</script>");
    std::fs::write(&frame, text).unwrap();
    let shown = chromium(
        &["--window-size=1700,1000", "--virtual-time-budget=60000", "--dump-dom"],
        &frame,
    );
    let shown = String::from_utf8(shown).unwrap();
    let seen = shown
        .split("id=\"seen\">")
        .nth(1)
        .and_then(|rest| rest.split("</script>").next());
    let seen = seen.unwrap_or_else(|| panic!("nothing was seen: {shown:.2000}"));
    serde_json::from_str(seen).unwrap_or_else(|error| panic!("{error}: {seen:.500}"))
}

/// Number of pages that a page prints to.
pub fn printed(html: &str) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let [page, pdf] = ["page.html", "page.pdf"].map(|name| folder.path().join(name));
    std::fs::write(&page, html).unwrap();
    let to = format!("--print-to-pdf={}", pdf.display());
    chromium(&["--virtual-time-budget=20000", "--no-pdf-header-footer", &to], &page);
    let pdf = std::fs::read(pdf).unwrap();
    let pdf = String::from_utf8_lossy(&pdf);
    // The dictionary of a page, and not that of the list of all pages.
    pdf.matches("/Type /Page\n").count()
}
